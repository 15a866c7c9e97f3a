//! `bubbletouch layout`: description, picture and conversion of layout files.

use crate::command::{Case, says};

const TABLE: &str = "x_mm,y_mm,z_mm,nx,ny,nz,radius_mm,row,column\n0,0,1,0,0,1,0.5,0,0\n2,0,1,0,0,1,0.5,0,1\n0,3,1,0,0,1,0.5,1,0\n2,3,1,0,0,1,0.5,1,1\n";

#[test]
fn a_layout_is_described_drawn_and_converted() {
    let case = Case::new();
    case.file("palm.csv", TABLE);
    let (said, _) = case.succeeds(&["layout", "palm.csv"]);
    assert_eq!(
        said,
        "4 taxels within 2.0 × 3.0 × 0.0 mm\nradius 0.500 mm\nimage of 2 × 2 pixels\n"
    );
    case.succeeds(&["layout", "palm.csv", "--out", "palm.svg"]);
    case.succeeds(&["layout", "palm.csv", "--out", "palm.png"]);
    let (_, notes) = case.succeeds(&["layout", "palm.csv", "--out", "palm.txt"]);
    says(&notes, &["the format has no radii", "no image"]);
    let (said, _) = case.succeeds(&["layout", "palm.txt", "--out", "again.csv"]);
    let by_default = "no radii; by default 1.000 mm, half the distance between neighbours";
    assert!(said.contains(by_default), "{said}");
    case.succeeds(&[
        "layout", "palm.csv", "--out", "dex.npz", "--format", "dex-01",
    ]);
    case.succeeds(&["layout", "dex.npz", "--out", "copy.csv"]);
    assert_eq!(
        std::fs::read_to_string(case.path("copy.csv")).unwrap(),
        TABLE
    );
    let names = [
        "again.csv",
        "copy.csv",
        "dex.npz",
        "palm.csv",
        "palm.png",
        "palm.svg",
        "palm.txt",
    ];
    assert_eq!(case.names(), names);
}
