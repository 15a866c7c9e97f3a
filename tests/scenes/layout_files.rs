//! Layouts from files: each format gives the taxels that its file describes, and an invalid file is refused with the number of its row.

use crate::command::says;
use bubbletouch::inputs::layout_file::{LayoutFile, LayoutOptions};
use bubbletouch::mesh::{LengthUnit, TriangleMesh};
use bubbletouch::scene::ScenePlan;
use glam::DVec3;
use ndarray::{Array1, Array2, Array3, array};
use ndarray_npy::NpzWriter;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// Position file in the layout of iCub's, with two channels without a taxel.
const ICUB: &str = "name palm\nspatial_sampling taxel\ntaxel2Repr ( 0 0 1 -2 )\n\n[calibration]\n0 0 0 0 0 0\n\
                    -0.016 0.0034 -0.0123 0.0000 0.0001 -1.0000\n-0.016 0.0067 -0.0119 -0.0872 0.0 -0.9962\n0.0 0.0 0.0 0.0 0.0 0.0\n";

const URDF: &str = "<robot name='pad'><link name='base'/><sensor name='pad_tactile'><parent link='base'/>\
                    <origin xyz='0 0 0.01' rpy='0 0 0'/><tactile channel='pad'>TAXELS</tactile></sensor></robot>";

/// Three prismatic joints for each of two taxels, as in XELA's files.
const XELA: &str = "<robot name='u'><link name='finger'/><link name='ax'/><link name='ay'/><link name='az'/><link name='bx'/><link name='by'/><link name='bz'/>\
    <joint name='j0' type='prismatic'><parent link='finger'/><child link='ax'/><origin xyz='0.001 0 0.002'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\
    <joint name='j1' type='prismatic'><parent link='ax'/><child link='ay'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\
    <joint name='j2' type='prismatic'><parent link='ay'/><child link='az'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\
    <joint name='k0' type='prismatic'><parent link='finger'/><child link='bx'/><origin xyz='0.005 0 0.002' rpy='0 1.5707963267948966 0'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\
    <joint name='k1' type='prismatic'><parent link='bx'/><child link='by'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\
    <joint name='k2' type='prismatic'><parent link='by'/><child link='bz'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, text).unwrap();
        path
    }

    fn npz(&self, name: &str, write: impl FnOnce(&mut NpzWriter<File>)) -> PathBuf {
        let path = self.0.path().join(name);
        let mut npz = NpzWriter::new(File::create(&path).unwrap());
        write(&mut npz);
        npz.finish().unwrap();
        path
    }
}

fn read(path: &Path) -> LayoutFile {
    LayoutFile::read(path, LayoutOptions::default()).unwrap()
}

fn refused(path: &Path, wanted: &str) {
    let error = LayoutFile::read(path, LayoutOptions::default()).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    let name = path.file_name().unwrap().to_str().unwrap();
    assert!(error.to_string().contains(name), "{error}");
    assert!(
        error.to_string().contains(wanted),
        "no `{wanted}` in: {error}"
    );
}

#[track_caller]
fn near(one: DVec3, other: DVec3) {
    assert!((one - other).length() < 1e-9, "{one} is not {other}");
}

#[test]
fn a_csv_file_is_read_with_radii_and_image_and_written_back_as_the_same_layout() {
    let folder = Folder::new();
    let text = "nx,ny,nz,x_mm,y_mm,z_mm,radius_mm,row,column\n0,0,2,1.5,0,3,0.7,0,1\n0.6,0,0.8,-4,0.1,3.25,0.8,2,5\n";
    let path = folder.file("palm.csv", text);
    let file = read(&path);
    near(file.layout.centers()[0], DVec3::new(1.5e-3, 0.0, 3e-3));
    assert_eq!(file.layout.axes()[0], DVec3::Z);
    assert_eq!(file.radii.as_deref(), Some(&[0.7e-3, 0.8e-3][..]));
    assert_eq!(file.pixels.as_deref(), Some(&[[0, 1], [2, 5]][..]));
    let copy = folder.0.path().join("copy.csv");
    assert!(file.write(&copy, None).unwrap().is_empty());
    let again = read(&copy);
    assert_eq!(again.layout, file.layout);
    assert_eq!((again.radii, again.pixels), (file.radii, file.pixels));
}

#[test]
fn a_position_file_of_icub_is_read_without_its_unused_rows() {
    let folder = Folder::new();
    let file = read(&folder.file("palm.txt", ICUB));
    assert_eq!(file.layout.n_taxels(), 2);
    near(
        file.layout.centers()[1],
        DVec3::new(-0.016, 0.0067, -0.0119),
    );
    assert!((file.layout.axes()[1].length() - 1.0).abs() < 1e-15);
    assert!(
        file.notes[0].contains("2 rows of zeros"),
        "{:?}",
        file.notes
    );
    assert!((file.default_radius() - 0.5 * 0.0033f64.hypot(0.0004)).abs() < 1e-12);
}

#[test]
fn an_archive_has_positions_and_normals_or_poses_and_pixels() {
    let folder = Folder::new();
    let path = folder.npz("own.npz", |npz| {
        npz.add_array("positions", &array![[0.0, 0.0, 1e-3], [2e-3, 0.0, 1e-3]])
            .unwrap();
        npz.add_array("normals", &array![[0.0f32, 0.0, 1.0], [0.0, 1.0, 0.0]])
            .unwrap();
        npz.add_array("radii", &array![1e-3, 2e-3]).unwrap();
    });
    let file = read(&path);
    assert_eq!(file.layout.axes(), [DVec3::Z, DVec3::Y]);
    assert_eq!(file.radii.as_deref(), Some(&[1e-3, 2e-3][..]));
    // A rotation by 90° about x takes z to −y.
    let poses = Array3::from_shape_vec(
        (1, 3, 4),
        vec![
            1.0f32, 0.0, 0.0, 0.01, 0.0, 0.0, -1.0, 0.02, 0.0, 1.0, 0.0, 0.03,
        ],
    );
    let poses = poses.unwrap();
    let path = folder.npz("dex.npz", |npz| {
        npz.add_array("poses", &poses).unwrap();
        npz.add_array("taxel2pixel", &array![[25i64, 15]]).unwrap();
    });
    let file = read(&path);
    near(file.layout.axes()[0], DVec3::NEG_Y);
    assert!((file.layout.centers()[0] - DVec3::new(0.01, 0.02, 0.03)).length() < 1e-8);
    assert_eq!(file.pixels.as_deref(), Some(&[[25, 15]][..]));
    let mirrored = folder.npz("left.npz", |npz| {
        npz.add_array("poses", &poses.mapv(|x| -x)).unwrap()
    });
    refused(&mirrored, "row 1: a left-handed frame");
    let wrong = folder.npz("counts.npz", |npz| {
        npz.add_array("positions", &Array2::<f64>::zeros((3, 3)))
            .unwrap();
        npz.add_array("normals", &Array2::<f64>::ones((2, 3)))
            .unwrap();
    });
    refused(&wrong, "normals: an array of shape [2, 3]; 3 × 3");
    let flat = folder.npz("flat.npz", |npz| {
        npz.add_array("other", &Array1::<f64>::zeros(3)).unwrap()
    });
    refused(&flat, "positions and normals, or poses");
}

#[test]
fn points_of_paxini_take_the_normals_of_a_mesh() {
    let folder = Folder::new();
    let path = folder.file(
        "s.json",
        r#"{"model": "S", "units": "mm", "taxels_mm": [[0, 0, 5.01], [5, 0.2, 1]]}"#,
    );
    refused(&path, "points without normals");
    let cube = TriangleMesh::cuboid("cube", DVec3::splat(0.01)).unwrap();
    let options = LayoutOptions {
        mesh: Some(&cube),
        ..LayoutOptions::default()
    };
    let file = LayoutFile::read(&path, options).unwrap();
    assert_eq!(file.layout.axes(), [DVec3::Z, DVec3::X]);
    let far = folder.file("far.json", "[[0, 0, 50]]");
    let error = LayoutFile::read(&far, options).unwrap_err().to_string();
    says(&error, &["far.json, row 1: a point 45.0 mm from the mesh"]);
    refused(
        &folder.file("m.json", r#"{"units": "in", "points": []}"#),
        "units \"in\"; \"mm\"",
    );
    refused(
        &folder.file("two.json", "[[0, 0]]"),
        "row 1: `[0,0]`; three numbers",
    );
    refused(&folder.file("cut.json", r#"{"taxels_mm": [[0, 0"#), "EOF");
}

#[test]
fn a_robots_file_has_arrays_taxels_or_prismatic_joints() {
    let folder = Folder::new();
    let array = "<array rows='2' cols='3' order='row-major' size='0.003 0.004' offset='0.001 0'/>";
    let file = read(&folder.file("pad.urdf", &URDF.replace("TAXELS", array)));
    let centers = file.layout.centers();
    near(centers[0], DVec3::new(-0.001, 0.0, 0.01));
    near(centers[1], DVec3::new(-0.001, 0.004, 0.01));
    near(centers[3], DVec3::new(0.002, 0.0, 0.01));
    assert_eq!(
        (file.layout.n_taxels(), file.link.as_deref()),
        (6, Some("base"))
    );
    let listed = "<taxel idx='1' xyz='0.02 0.01 0' rpy='0 0 0'/><taxel idx='0' xyz='0.01 0.01 0' rpy='1.5707963267948966 0 0'/>";
    let file = read(&folder.file("list.urdf", &URDF.replace("TAXELS", listed)));
    near(file.layout.centers()[0], DVec3::new(0.01, 0.01, 0.01));
    near(file.layout.axes()[0], DVec3::NEG_Y);
    let file = read(&folder.file("uskin.urdf", XELA));
    near(file.layout.centers()[0], DVec3::new(0.001, 0.0, 0.002));
    near(file.layout.axes()[1], DVec3::X);
    assert_eq!(file.link.as_deref(), Some("finger"));
    refused(
        &folder.file("none.urdf", "<robot name='r'><link name='a'/></robot>"),
        "no tactile sensor",
    );
}

/// Spellings of one table in CSV files, as spreadsheets and other programs write them.
#[test]
fn spellings_of_a_csv_file_are_read_as_the_same_layout() {
    let folder = Folder::new();
    let header = "x_mm,y_mm,z_mm,nx,ny,nz,radius_mm";
    let rows = "1.5,-2,30,0,0.6,0.8,0.7\n4,5e-1,6,0,0,1,0.7\n";
    let plain = format!("{header}\n{rows}");
    let expected = read(&folder.file("plain.csv", &plain));
    let metres = "0.0015,-0.002,0.03,0,0.6,0.8,0.0007\n0.004,0.0005,0.006,0,0,1,0.0007\n";
    let centimetres = "0.15,-0.2,3,0,0.6,0.8,0.07\n0.4,0.05,0.6,0,0,1,0.07\n";
    for (name, text) in [
        ("semicolons.csv", plain.replace(',', ";")),
        ("tabs.tsv", plain.replace(',', "\t")),
        (
            "decimal_commas.csv",
            plain.replace(',', ";").replace('.', ","),
        ),
        (
            "decimal_tabs.csv",
            plain.replace(',', "\t").replace('.', ","),
        ),
        (
            "comments.csv",
            format!("# a fingertip\n\n{header}\n# first row\n{rows}\n"),
        ),
        ("capitals.csv", plain.to_uppercase().replace("E-1", "e-1")),
        (
            "bom_crlf.csv",
            format!("\u{feff}{}", plain.replace('\n', "\r\n")),
        ),
        (
            "metres.csv",
            format!("x_m,y_m,z_m,nx,ny,nz,radius_m\n{metres}"),
        ),
        (
            "centimetres.csv",
            format!("x (cm),y (cm),z (cm),nx,ny,nz,radius [cm]\n{centimetres}"),
        ),
        (
            "brackets.csv",
            format!("x [mm], Y (mm), z_mm, Normal_x, n_y, nz, Radius (mm)\n{rows}"),
        ),
    ] {
        let again = read(&folder.file(name, &text));
        assert_eq!(again.layout, expected.layout, "{name}");
        assert_eq!(again.radii, expected.radii, "{name}");
        assert!(again.notes.is_empty(), "{name}: {:?}", again.notes);
    }
    let named = plain
        .replace("x_mm", "id,x_mm")
        .replace("1.5,", "a,1.5,")
        .replace("\n4,", "\nb,4,");
    let named = read(&folder.file("named.csv", &named));
    assert_eq!(named.layout, expected.layout);
    assert!(
        named.notes[0].ends_with("named.csv: columns that are not used: `id`"),
        "{:?}",
        named.notes
    );
    for (name, text, wanted) in [
        (
            "unit.csv",
            plain.replace("x_mm", "x_in"),
            "line 1: column `x_in`; x_mm, ",
        ),
        (
            "radius.csv",
            plain.replace("radius_mm", "radius"),
            "column `radius`; ",
        ),
        (
            "points.csv",
            rows.to_owned(),
            "line 1: a header of numbers; a table with the columns x_mm",
        ),
        (
            "decimal.csv",
            plain.replace(',', ";").replace("1.5", "1,5,0"),
            "line 2, column x_mm: `1,5,0`; a finite number",
        ),
        (
            "commented.csv",
            format!("# one\n{header}\n1,2,3,0,0,1,x\n"),
            "line 3, column radius_mm: `x`",
        ),
    ] {
        refused(&folder.file(name, &text), wanted);
    }
    std::fs::write(folder.0.path().join("latin.csv"), b"x_mm\xe9\n").unwrap();
    refused(
        &folder.0.path().join("latin.csv"),
        "latin.csv: cannot be read (stream did not contain valid UTF-8); a layout in .csv",
    );
}

#[test]
fn other_spellings_of_icub_paxini_and_archives_are_read_or_refused_with_the_reason() {
    let folder = Folder::new();
    let icub = "name palm // left\n[ Calibration ]\n// x y z\n(0.001 0.002 0.003 0 0 1)\n0 0 0 0 0 0\n0.004 0.005 0.006 0 0.6 0.8\n";
    let taxels = read(&folder.file("p.txt", icub));
    near(taxels.layout.centers()[1], DVec3::new(4e-3, 5e-3, 6e-3));
    refused(
        &folder.file("z.txt", "[calibration]\n0 0 0 0 0 0\n0 0 0 0 0 0\n"),
        "z.txt: no taxel, but 2 rows of zeros",
    );
    let rows = "[[1, 2, 3], [4, 5, 6]]";
    let normals = "\"normals\": [[0, 0, 1], [0, 0.6, 0.8]]";
    for (unit, factor) in [("mm", 1e-3), ("MM", 1e-3), ("cm", 1e-2), ("m", 1.0)] {
        let text = format!("\u{feff}{{\"units\": \"{unit}\", \"points\": {rows}, {normals}}}");
        let read = read(&folder.file("p.json", &text));
        near(read.layout.centers()[1], factor * DVec3::new(4.0, 5.0, 6.0));
        near(read.layout.axes()[1], DVec3::new(0.0, 0.6, 0.8));
    }
    for (text, wanted) in [
        (
            format!("{{\"units\": \"m\", \"taxels_mm\": {rows}, {normals}}}"),
            "units \"m\"; \"mm\"",
        ),
        (
            format!("{{\"units\": \"in\", \"points\": {rows}, {normals}}}"),
            "units \"in\"",
        ),
        (
            format!("{{\"points\": {rows}, \"normals\": [[0, 0, 1]]}}"),
            "normals: 1 normals for 2 taxels",
        ),
        (
            format!("{{\"points\": {rows}, \"normals\": [[0, 0, 1], [0, 1]]}}"),
            "normals, row 2: `[0,1]`",
        ),
        (
            format!("{{\"points\": {rows}, \"normals\": [[0, 0, 1], [0, 0, 0]]}}"),
            "row 2: normal",
        ),
        ("{\"points\": []}".to_owned(), "no taxel"),
    ] {
        refused(&folder.file("w.json", &text), wanted);
    }
    // An archive with a single array: the positions are not taken for the normals.
    let path = folder.npz("p.npz", |npz| {
        npz.add_array("positions", &Array2::<f64>::ones((2, 3)))
            .unwrap()
    });
    refused(
        &path,
        "no array normals (the arrays positions); positions and normals, or poses",
    );
}

/// Equal normals of all taxels are normals of a flat pad, and placeholders of other skins.
#[test]
fn equal_normals_that_do_not_stand_across_the_taxels_are_placeholders() {
    let folder = Folder::new();
    // 4 × 6 taxels of a pad across n, and a column of them.
    let rows = |n: DVec3, n_columns: usize, normal: DVec3| -> String {
        let (u, v) = n.any_orthonormal_pair();
        let place = |k: usize| 4e-3 * ((k % n_columns) as f64 * u + (k / n_columns) as f64 * v);
        let row = |k: usize| {
            let numbers = [place(k).to_array(), normal.to_array()].concat();
            let numbers = numbers.iter().map(|number| format!("{number:.4}"));
            numbers.collect::<Vec<_>>().join(" ") + "\n"
        };
        (0..6 * n_columns).map(row).collect()
    };
    let tilted = DVec3::new(1.0, -2.0, 0.5).normalize();
    for n in [DVec3::X, DVec3::Z, tilted] {
        for n_columns in [1, 4] {
            let file = folder.file(
                "pad.txt",
                &format!("[calibration]\n{}", rows(n, n_columns, n)),
            );
            assert!((read(&file).layout.axes()[0] - n).length() < 1e-3);
            // Normals along the pad, or along the column.
            let (u, v) = n.any_orthonormal_pair();
            for along in if n_columns == 1 { vec![v] } else { vec![u, v] } {
                let text = format!("[calibration]\n{}", rows(n, n_columns, along));
                let file = folder.file("sole.txt", &text);
                let wanted = format!(
                    "of all {} taxels is not perpendicular to their surface; rows with normals, or a mesh beside it",
                    6 * n_columns
                );
                refused(&file, &wanted);
            }
        }
    }
    // Taxels around a cylinder with the axis y, whose radius is 10 mm, as on a forearm.
    let angles = (0..40).map(|k| (0.3 * f64::from(k % 10), 4e-3 * f64::from(k / 10)));
    let arm = |normal: &dyn Fn(f64) -> DVec3| -> String {
        let row = |(angle, y): (f64, f64)| {
            let n = normal(angle);
            format!(
                "{},{y},{},{},{},{}\n",
                1e-2 * angle.sin(),
                1e-2 * angle.cos(),
                n.x,
                n.y,
                n.z
            )
        };
        "x_m,y_m,z_m,nx,ny,nz\n".to_owned() + &angles.clone().map(row).collect::<String>()
    };
    let outwards = |angle: f64| DVec3::new(angle.sin(), 0.0, angle.cos());
    let true_normals = read(&folder.file("arm.csv", &arm(&outwards)));
    let shin = folder.file("shin.csv", &arm(&|_| outwards(1.35)));
    refused(
        &shin,
        "of all 40 taxels is not perpendicular to their surface",
    );
    let placeholders = folder.file("arm_x.csv", &arm(&|_| DVec3::Y));
    refused(
        &placeholders,
        "the normal [0, 1, 0] of all 40 taxels is not perpendicular",
    );
    // A fine cylinder of triangles gives the normals.
    let cylinder = Cylinder::mesh(1e-2, 0.1, 720);
    let options = LayoutOptions {
        mesh: Some(&cylinder),
        ..LayoutOptions::default()
    };
    let from_mesh = LayoutFile::read(&placeholders, options).unwrap();
    assert!(
        from_mesh.notes[0]
            .contains("is not perpendicular to their surface; the mesh gives the normals")
    );
    let pairs = from_mesh
        .layout
        .axes()
        .iter()
        .zip(true_normals.layout.axes());
    assert!(
        pairs
            .into_iter()
            .all(|(one, other)| (*one - *other).length() < 5e-3)
    );
    let given = LayoutFile::read(&folder.file("arm.csv", &arm(&outwards)), options).unwrap_err();
    assert!(
        given.to_string().contains("a mesh for normals; none"),
        "{given}"
    );
}

/// Side of a cylinder around y, of triangles.
struct Cylinder;

impl Cylinder {
    fn mesh(radius: f64, length: f64, n: u32) -> TriangleMesh {
        let vertex = |k: u32| {
            let angle = std::f64::consts::TAU * f64::from(k / 2) / f64::from(n);
            let y = length * (f64::from(k % 2) - 0.5);
            DVec3::new(radius * angle.sin(), y, radius * angle.cos())
        };
        let around = |k: u32| k % (2 * n);
        let triangles = (0..n).flat_map(|k| {
            let [a, b, c, d] = [2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 3].map(around);
            [[a, c, b], [b, c, d]]
        });
        let vertices = (0..2 * n).map(vertex).collect();
        TriangleMesh::new("cylinder", vertices, triangles.collect()).unwrap()
    }
}

#[test]
fn a_layout_of_another_unit_is_noted_and_read_with_its_unit() {
    let folder = Folder::new();
    let points = |scale: f64| {
        let place = |k: usize| [scale * (k % 4) as f64, scale * (k / 4) as f64, 0.0];
        let places: Vec<[f64; 3]> = (0..16).map(place).collect();
        format!(
            "{{\"points\": {places:?}, \"normals\": {:?}}}",
            vec![[0.0, 0.0, 1.0]; 16]
        )
    };
    let expected = read(&folder.file("mm.json", &points(4.0)));
    assert!(expected.notes.is_empty());
    let metres = folder.file("m.json", &points(4e-3));
    let file = read(&metres);
    let note = "m.json: the layout is 0.012 mm long; 1 mm to 1 m is usual: if the file is in another unit, give it (--unit, or unit= in Python)";
    assert!(
        file.notes.len() == 1 && file.notes[0].ends_with(note),
        "{:?}",
        file.notes
    );
    let unit = |unit| LayoutOptions {
        unit: Some(unit),
        ..LayoutOptions::default()
    };
    let file = LayoutFile::read(&metres, unit(LengthUnit::Metre)).unwrap();
    let same = |file: &LayoutFile| {
        assert!(file.notes.is_empty(), "{:?}", file.notes);
        for (one, other) in file.layout.centers().iter().zip(expected.layout.centers()) {
            near(*one, *other);
        }
    };
    same(&file);
    let archive = folder.npz("mm.npz", |npz| {
        let place =
            |(k, axis): (usize, usize)| [4.0 * (k % 4) as f64, 4.0 * (k / 4) as f64, 0.0][axis];
        let normals = Array2::from_shape_fn((16, 3), |(_, axis)| f64::from(axis == 2));
        npz.add_array("positions", &Array2::from_shape_fn((16, 3), place))
            .unwrap();
        npz.add_array("normals", &normals).unwrap();
        npz.add_array("radii", &Array1::from_elem(16, 1.5)).unwrap();
    });
    assert!(read(&archive).notes[0].contains("the layout is 12000 mm long"));
    let file = LayoutFile::read(&archive, unit(LengthUnit::Millimetre)).unwrap();
    same(&file);
    assert_eq!(file.radii, Some(vec![1.5e-3; 16]));
    // The unit of a file that states it is not replaced.
    let stated = folder.file(
        "s.json",
        &points(4.0).replacen('{', "{\"units\": \"mm\", ", 1),
    );
    let table = folder.file("t.csv", "x_mm,y_mm\n0,0\n4,0\n");
    for path in [stated, table] {
        let error = LayoutFile::read(&path, unit(LengthUnit::Millimetre)).unwrap_err();
        assert!(error.to_string().contains("a unit; none: "), "{error}");
    }
    let large = folder.file("large.csv", "x_m,y_m\n0,0\n4,0\n");
    assert!(
        read(&large)
            .notes
            .iter()
            .any(|note| note.contains("4000 mm long"))
    );
}

/// Three sensors of one channel name, as in public files: one has two taxels on one channel, and one has no taxels.
#[test]
fn every_sensor_of_a_robots_file_is_listed_and_has_its_own_fault() {
    let folder = Folder::new();
    let sensor = |name: &str, inside: &str| {
        format!(
            "<sensor name='{name}'><parent link='a'/><tactile channel='c'>{inside}</tactile></sensor>\n"
        )
    };
    let robot = |sensors: &str| format!("<robot name='r'><link name='a'/>\n{sensors}</robot>");
    let good = "<taxel idx='2' xyz='0 0 0'/><taxel idx='7' xyz='0.01 0 0'/>";
    let text = robot(
        &(sensor(
            "palm",
            "<taxel idx='2' xyz='0 0 0'/><taxel idx='2' xyz='0 0.01 0'/>",
        ) + &sensor("thumb", good)
            + &sensor("empty", "")),
    );
    let path = folder.file("shared.urdf", &text);
    refused(
        &path,
        "3 tactile sensors; the name of one: empty, palm, thumb",
    );
    for (name, wanted) in [
        ("palm", "line 2: a second taxel with `idx` 2"),
        ("empty", "line 4: <tactile> without taxels"),
        ("index", "no sensor `index`; one of empty, palm, thumb"),
    ] {
        let options = LayoutOptions {
            sensor: Some(name),
            ..LayoutOptions::default()
        };
        let error = LayoutFile::read(&path, options).unwrap_err().to_string();
        assert!(error.contains(wanted), "{name}: {error}");
    }
    let options = LayoutOptions {
        sensor: Some("thumb"),
        ..LayoutOptions::default()
    };
    assert_eq!(
        LayoutFile::read(&path, options).unwrap().layout.n_taxels(),
        2
    );
    // The only sensor is the one with a fault, or a name has two sensors.
    let one = folder.file("one.urdf", &robot(&sensor("empty", "")));
    refused(&one, "one.urdf, line 2: <tactile> without taxels");
    let two = robot(&(sensor("palm", good) + &sensor("palm", good)));
    let two = folder.file("two.urdf", &two);
    refused(
        &two,
        "line 3: a second sensor `palm` (the first is on line 2); a name of its own",
    );
    let robot = bubbletouch::world::Robot::read(&two).unwrap();
    assert_eq!(robot.tactile_sensors().len(), 1);
    let left_out = "tactile sensor `palm` on link `a` is not read";
    assert!(robot.notes().iter().any(|note| note.ends_with(left_out)));
}

#[test]
fn a_patch_of_a_scene_has_the_taxels_of_a_file_or_of_its_robots_sensor() {
    let folder = Folder::new();
    folder.file("palm.txt", ICUB);
    let array = "<array rows='4' cols='6' size='0.003 0.003' spacing='0.004 0.004'/>";
    folder.file("pad.urdf", &URDF.replace("TAXELS", array));
    let scene = |patch: &str| {
        let text = format!(
            "title = \"A pad\"\nrobots = [{{ name = \"r\", urdf = \"pad.urdf\" }}]\n\
             [[patches]]\nname = \"p\"\nrobot = \"r\"\nstroke_mm = 5.0\nlayout = {patch}\n"
        );
        ScenePlan::read(&folder.file("s.toml", &text))
    };
    let plan = scene("{ sensor = \"pad_tactile\" }").unwrap();
    assert_eq!(plan.patches[0].skin.n_taxels(), 24);
    near(
        plan.patches[0].skin.layout().centers()[0],
        DVec3::new(0.0, 0.0, 0.01),
    );
    assert!((plan.patches[0].skin.taxels().at(0).radius - 2e-3).abs() < 1e-12);
    assert_eq!(plan.notes().count(), 0);
    folder.file("large.csv", "x_m,y_m\n0,0\n4,0\n");
    let plan = scene("{ file = \"large.csv\" }").unwrap();
    let notes: Vec<String> = plan.notes().collect();
    assert!(
        notes
            .iter()
            .any(|note| note.starts_with("patches.p: ") && note.contains("4000 mm long")),
        "{notes:?}"
    );
    let plan = scene("{ file = \"palm.txt\" }").unwrap();
    assert_eq!(plan.patches[0].skin.n_taxels(), 2);
    let notes: Vec<String> = plan.notes().collect();
    assert!(
        notes[0].contains("`pad_tactile` on link `base` is not read: layout = { sensor"),
        "{notes:?}"
    );
    for (patch, wanted) in [
        ("{ sensor = \"pad\" }", "layout.sensor: `pad`"),
        ("{ file = \"none.csv\" }", "none.csv"),
        (
            "{ file = { path = \"palm.txt\", sensor = \"a\" } }",
            "layout.file: ",
        ),
    ] {
        let error = scene(patch).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(
            error.to_string().contains(wanted),
            "no `{wanted}` in: {error}"
        );
    }
}
