//! Layouts of taxels as an axis. The grid gives the results of a study without the axis. Other layouts are pressed, read and measured at the positions of their
//! taxels.

use crate::command::Case;
use crate::study::{changed, laid_out, run, scores, scores_of_variant};
use bubbletouch::contact::{Press, Until, Workspace};
use bubbletouch::random::Seed;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::{draw_touches, load_objects, simulate_array};
use ndarray::Array2;
use std::slice::from_ref;

const STUDY: &str = include_str!("../fixtures/texts/layouts.toml");

/// Returns the study with further keys of its skin.
fn with(keys: &str) -> String {
    changed(STUDY, &[("stroke_mm", &format!("{keys}\nstroke_mm"))])
}

#[test]
fn a_layout_is_an_axis_and_its_grid_is_the_grid() {
    let axes =
        "[axes]\n\"skin.layout\" = [\"cap\", \"grid\", \"hexagonal\", \"disc\", \"cylinder\"]\n";
    let text = with("curvature_radius_mm = 30.0") + axes;
    let layouts = run(&text);
    let of_layout = |number: usize| scores_of_variant(&layouts.accuracy, number);
    let expected = scores(&run(STUDY));
    assert_eq!(of_layout(1), expected);
    let summary = layouts.summary.iter();
    let sides: Vec<_> = summary.map(|(of, _)| (of.nx, of.ny)).collect();
    assert_eq!(sides[1..3], [(8, 8), (7, 9)]);
    assert_eq!(sides[4], (8, 8));
    for (nx, ny) in [sides[0], sides[3]] {
        assert!(ny == 1 && nx.abs_diff(64) < 8, "{nx} × {ny}");
    }
    for number in [0, 2, 3, 4] {
        assert_ne!(of_layout(number), expected, "layout {number}");
    }
}

#[test]
fn frames_are_those_of_the_skin_pressed_by_hand() {
    let text = with("layout = \"cap\"\ncurvature_radius_mm = 30.0");
    let study = laid_out(&text).unwrap();
    let part = study.first();
    let array = &part.plan.array;
    let skin = array.patch();
    let frames = simulate_array(part.touched.as_ref(), array, 2, &Silent);
    let frames = frames.to_array();
    assert_eq!(frames.ncols(), skin.n_taxels());
    let seed = Seed::new(part.plan.spec.seed);
    let objects = load_objects(&part.plan.spec.objects, None).unwrap();
    let touched = draw_touches(objects, &part.plan.placement, &seed);
    let mut workspace = Workspace::new();
    let mut row = 0;
    for object in touched.unwrap() {
        for touch in &object.touches {
            let pose = touch.patch_from_object(&object.rests[touch.rest]);
            for depth in [0.5 * touch.depth, touch.depth] {
                let model = [object.object.model.clone()];
                let press = Press::new(skin, &model, from_ref(&pose), Until::Depth(depth));
                press.with_contacts().run(&mut workspace).unwrap();
                let expected = workspace.deflections().iter().map(|&d| f64::from(d as f32));
                assert!(frames.row(row).iter().copied().eq(expected), "row {row}");
                row += 1;
            }
        }
    }
    assert_eq!(row, frames.nrows());
}

#[test]
fn the_command_writes_where_the_taxels_are() {
    let case = Case::new();
    let text = with("layout = \"disc\"");
    case.file("study.toml", &text);
    case.succeeds("touches study.toml --out touches");
    let taxels: Array2<f64> = case.read_array("touches/taxels.npy");
    let study = laid_out(&text).unwrap();
    let skin = study.first().plan.array.patch();
    assert_eq!(taxels.dim(), (skin.n_taxels(), 6));
    for (row, center) in taxels.outer_iter().zip(skin.layout().centers()) {
        assert_eq!(row.to_vec()[..3], center.to_array());
        assert_eq!(row.to_vec()[3..], [0.0, 0.0, 1.0]);
    }
    case.succeeds("run study.toml --out results");
}
