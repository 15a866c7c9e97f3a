//! Layouts from files: each format gives the taxels that its file describes, in all its spellings. `tests/refusals/layout_files.toml` has the files that are
//! refused.

use crate::arrays::npz;
use crate::command::{Case, says};
use bubbletouch::Result;
use bubbletouch::inputs::layout_file::{LayoutFile, LayoutOptions};
use bubbletouch::mesh::{LengthUnit, TriangleMesh};
use bubbletouch::scene::ScenePlan;
use bubbletouch::world::Robot;
use glam::DVec3;
use ndarray::{Array1, Array2, Axis, array};
use std::path::Path;

/// Position file in the layout of iCub's, with two channels without a taxel.
pub const ICUB: &str = include_str!("../fixtures/texts/icub.txt");
/// Three prismatic joints for each of two taxels, as in XELA's files.
pub const XELA: &str = include_str!("../fixtures/texts/uskin.urdf");

/// Returns a robot with one tactile sensor, 10 mm above its link.
pub fn robot(tactile: &str) -> String {
    format!(
        "<robot name='pad'><link name='base'/><sensor name='pad_tactile'><parent link='base'/>\
         <origin xyz='0 0 0.01' rpy='0 0 0'/><tactile channel='pad'>{tactile}</tactile></sensor></robot>"
    )
}

pub fn read(path: &Path) -> Result<LayoutFile> {
    LayoutFile::read(path, LayoutOptions::default())
}

/// Reads a file with this name and content.
fn layout(name: &str, content: impl AsRef<[u8]>) -> LayoutFile {
    read(&Case::new().file(name, content)).unwrap()
}

/// Reads a file whose points take the normals of a mesh.
fn on_mesh(name: &str, content: impl AsRef<[u8]>, mesh: &TriangleMesh) -> Result<LayoutFile> {
    let options = LayoutOptions {
        mesh: Some(mesh),
        ..LayoutOptions::default()
    };
    LayoutFile::read(&Case::new().file(name, content), options)
}

/// Reads a file in a unit.
fn in_unit(name: &str, content: impl AsRef<[u8]>, unit: LengthUnit) -> Result<LayoutFile> {
    let options = LayoutOptions {
        unit: Some(unit),
        ..LayoutOptions::default()
    };
    LayoutFile::read(&Case::new().file(name, content), options)
}

#[track_caller]
fn near(one: DVec3, other: impl Into<DVec3>) {
    let other = other.into();
    assert!((one - other).length() < 1e-9, "{one} is not {other}");
}

#[test]
fn a_csv_file_is_read_with_radii_and_image_and_written_back_as_the_same_layout() {
    let text = "nx,ny,nz,x_mm,y_mm,z_mm,radius_mm,row,column\n0,0,2,1.5,0,3,0.7,0,1\n0.6,0,0.8,-4,0.1,3.25,0.8,2,5\n";
    let file = layout("palm.csv", text);
    near(file.layout.centers()[0], [1.5e-3, 0.0, 3e-3]);
    assert_eq!(file.layout.axes()[0], DVec3::Z);
    assert_eq!(file.radii.as_deref(), Some(&[0.7e-3, 0.8e-3][..]));
    assert_eq!(file.pixels.as_deref(), Some(&[[0, 1], [2, 5]][..]));
    let case = Case::new();
    let copy = case.path("copy.csv");
    assert!(file.write(&copy, None).unwrap().is_empty());
    let again = read(&copy).unwrap();
    assert_eq!(again.layout, file.layout);
    assert_eq!((again.radii, again.pixels), (file.radii, file.pixels));
}

#[test]
fn a_position_file_of_icub_is_read_without_its_unused_rows() {
    let file = layout("palm.txt", ICUB);
    assert_eq!(file.layout.n_taxels(), 2);
    near(file.layout.centers()[1], [-0.016, 0.0067, -0.0119]);
    assert!((file.layout.axes()[1].length() - 1.0).abs() < 1e-15);
    says(&file.notes[0], &["2 rows of zeros"]);
    assert!((file.default_radius() - 0.5 * 0.0033f64.hypot(0.0004)).abs() < 1e-12);
    // Comments, brackets, and no section at all.
    let rows = "(0.001 0.002 0.003 0 0 1)\n0 0 0 0 0 0\n-0.004 0.005 0.006 0 1.2 1.6\n";
    for head in [
        "name palm // left\n[ Calibration ]\n// x y z\n",
        "name palm\ntaxel2Repr (0 1 2)\n",
    ] {
        let file = layout("p.txt", format!("{head}{rows}"));
        near(file.layout.centers()[1], [-4e-3, 5e-3, 6e-3]);
        near(file.layout.axes()[1], [0.0, 0.6, 0.8]);
    }
}

#[test]
fn an_archive_has_positions_and_normals_or_poses_and_pixels() {
    let own = npz(|npz| {
        let positions = array![[0.0, 0.0, 1e-3], [2e-3, 0.0, 1e-3]];
        npz.add_array("positions", &positions).unwrap();
        let normals = array![[0.0f32, 0.0, 1.0], [0.0, 1.0, 0.0]];
        npz.add_array("normals", &normals).unwrap();
        npz.add_array("radii", &array![1e-3, 2e-3]).unwrap();
    });
    let file = layout("own.npz", own);
    assert_eq!(file.layout.axes(), [DVec3::Z, DVec3::Y]);
    assert_eq!(file.radii.as_deref(), Some(&[1e-3, 2e-3][..]));
    // A rotation by 90° about x takes z to −y.
    let pose = array![
        [1.0f32, 0.0, 0.0, 0.01],
        [0.0, 0.0, -1.0, 0.02],
        [0.0, 1.0, 0.0, 0.03]
    ];
    let dex = npz(|npz| {
        npz.add_array("poses", &pose.insert_axis(Axis(0))).unwrap();
        npz.add_array("taxel2pixel", &array![[25i64, 15]]).unwrap();
    });
    let file = layout("dex.npz", dex);
    near(file.layout.axes()[0], DVec3::NEG_Y);
    assert!(file.layout.centers()[0].distance(DVec3::new(0.01, 0.02, 0.03)) < 1e-8);
    assert_eq!(file.pixels.as_deref(), Some(&[[25, 15]][..]));
}

#[test]
fn arrays_of_an_archive_may_have_other_usual_names() {
    let positions = Array2::from_shape_fn((6, 3), |(row, axis)| 1e-3 * (row * (2 - axis)) as f64);
    let normals = Array2::from_shape_fn((6, 3), |(_, axis)| f64::from(axis == 2));
    let archive = |names: &[&str], normal: &str| {
        let bytes = npz(|npz| {
            for name in names {
                npz.add_array(*name, &positions).unwrap();
            }
            npz.add_array(normal, &normals).unwrap();
        });
        read(&Case::new().file("skin.npz", bytes))
    };
    let expected = archive(&["positions"], "normals").unwrap();
    for (one, other) in [
        ("centers", "axes"),
        ("points", "normals"),
        ("xyz", "normal"),
    ] {
        let again = archive(&[one], other).unwrap();
        assert_eq!(again.layout, expected.layout, "{one} {other}");
    }
    let error = archive(&["points", "xyz"], "normals").unwrap_err();
    says(
        &error.to_string(),
        &["the arrays points and xyz; one of them"],
    );
}

#[test]
fn a_robots_file_has_arrays_taxels_or_prismatic_joints() {
    let array = "<array rows='2' cols='3' order='row-major' size='0.003 0.004' offset='0.001 0'/>";
    let file = layout("pad.urdf", robot(array));
    for (taxel, center) in [
        (0, [-0.001, 0.0, 0.01]),
        (1, [-0.001, 0.004, 0.01]),
        (3, [0.002, 0.0, 0.01]),
    ] {
        near(file.layout.centers()[taxel], center);
    }
    assert_eq!(file.layout.n_taxels(), 6);
    assert_eq!(file.link.as_deref(), Some("base"));
    let listed = "<taxel idx='1' xyz='0.02 0.01 0' rpy='0 0 0'/><taxel idx='0' xyz='0.01 0.01 0' rpy='1.5707963267948966 0 0'/>";
    let file = layout("list.urdf", robot(listed));
    near(file.layout.centers()[0], [0.01, 0.01, 0.01]);
    near(file.layout.axes()[0], DVec3::NEG_Y);
    let file = layout("uskin.urdf", XELA);
    near(file.layout.centers()[0], [0.001, 0.0, 0.002]);
    near(file.layout.axes()[1], DVec3::X);
    assert_eq!(file.link.as_deref(), Some("finger"));
}

#[test]
fn an_array_of_a_robots_file_is_an_image_and_listed_taxels_may_have_radii() {
    let pad = |tactile: &str| layout("pad.urdf", robot(tactile));
    let file = pad("<array rows='2' cols='3' size='0.003 0.003'/>");
    assert_eq!(file.layout.sides(), Some([2, 3]));
    assert_eq!(file.pixels.unwrap()[4], [1, 1]);
    let file = pad("<array rows='2' cols='3' order='col-major' size='0.003 0.003'/>");
    assert_eq!(file.layout.sides(), None);
    assert_eq!(file.pixels.unwrap()[..3], [[0, 0], [1, 0], [0, 1]]);
    let taxel = |index: usize, shape: &str| {
        format!("<taxel idx='{index}' xyz='0.00{index} 0 0'><geometry>{shape}</geometry></taxel>")
    };
    let [small, large] = ["0.001", "0.002"].map(|radius| format!("<sphere radius='{radius}'/>"));
    let file = pad(&(taxel(1, &large) + &taxel(0, &small)));
    assert_eq!(file.radii, Some(vec![1e-3, 2e-3]));
    // Taxels are read, and an array beside them is not, as urdf_tactile does.
    let array = "<array rows='2' cols='3' size='1 1'/>";
    let file = pad(&(taxel(0, &small) + &taxel(3, "<box size='1 1 1'/>") + array));
    assert_eq!(file.layout.n_taxels(), 2);
    assert_eq!((file.radii, file.pixels), (None, None));
    says(&file.notes[0], &["2 taxels for 4 channels"]);
    says(&file.notes[1], &["<array> beside <taxel>s"]);
}

/// Spellings of one table in CSV files, as spreadsheets and other programs write them.
#[test]
fn spellings_of_a_csv_file_are_read_as_the_same_layout() {
    let header = "x_mm,y_mm,z_mm,nx,ny,nz,radius_mm";
    let rows = "1.5,-2,30,0,0.6,0.8,0.7\n4,5e-1,6,0,0,1,0.7\n";
    let plain = format!("{header}\n{rows}");
    let expected = layout("plain.csv", &plain);
    let metres = "0.0015,-0.002,0.03,0,0.6,0.8,0.0007\n0.004,0.0005,0.006,0,0,1,0.0007\n";
    let centimetres = "0.15,-0.2,3,0,0.6,0.8,0.07\n0.4,0.05,0.6,0,0,1,0.07\n";
    let semicolons = plain.replace(',', ";");
    let tabs = plain.replace(',', "\t");
    let crlf = format!("\u{feff}{}", plain.replace('\n', "\r\n"));
    let in_metres = format!("x_m,y_m,z_m,nx,ny,nz,radius_m\n{metres}");
    let in_centimetres = format!("x (cm),y (cm),z (cm),nx,ny,nz,radius [cm]\n{centimetres}");
    let brackets = format!("x [mm], Y (mm), z_mm, Normal_x, n_y, nz, Radius (mm)\n{rows}");
    let comments = format!("# a fingertip\n\n{header}\n# first row\n{rows}\n");
    for (name, text) in [
        ("decimal_commas.csv", semicolons.replace('.', ",")),
        ("decimal_tabs.csv", tabs.replace('.', ",")),
        ("semicolons.csv", semicolons),
        ("tabs.tsv", tabs),
        ("comments.csv", comments),
        ("capitals.csv", plain.to_uppercase().replace("E-1", "e-1")),
        ("bom_crlf.csv", crlf),
        ("metres.csv", in_metres),
        ("centimetres.csv", in_centimetres),
        ("brackets.csv", brackets),
    ] {
        let again = layout(name, &text);
        assert_eq!(again.layout, expected.layout, "{name}");
        assert_eq!(again.radii, expected.radii, "{name}");
        assert!(again.notes.is_empty(), "{name}: {:?}", again.notes);
    }
    let named = plain.replace("x_mm", "id,x_mm").replace("1.5,", "a,1.5,");
    let named = layout("named.csv", named.replace("\n4,", "\nb,4,"));
    assert_eq!(named.layout, expected.layout);
    let unused = "named.csv: columns that are not used: `id`";
    says(&named.notes[0], &[unused]);
    let error = read(&Case::new().file("latin.csv", b"x_mm\xe9\n")).unwrap_err();
    let words = "latin.csv: cannot be read (stream did not contain valid UTF-8); a layout in .csv";
    says(&error.to_string(), &[words]);
}

#[test]
fn points_of_paxini_have_units_and_names_of_coordinates() {
    let normals = "\"normals\": [[0, 0, 1], [0, 0.6, 0.8]]";
    let named = "[{\"x\": 1, \"y\": 2, \"z\": 3}, {\"z\": 6, \"y\": 5, \"x\": 4}]";
    for (unit, factor) in [("mm", 1e-3), ("MM", 1e-3), ("cm", 1e-2), ("m", 1.0)] {
        for points in ["[[1, 2, 3], [4, 5, 6]]", named] {
            let text =
                format!("\u{feff}{{\"units\": \"{unit}\", \"points\": {points}, {normals}}}");
            let file = layout("p.json", text);
            near(file.layout.centers()[1], factor * DVec3::new(4.0, 5.0, 6.0));
            near(file.layout.axes()[1], [0.0, 0.6, 0.8]);
        }
    }
}

/// Law: positions without normals take them from a mesh in every format, and positions of x and y alone are a flat skin.
#[test]
fn positions_alone_are_read() {
    let cube = TriangleMesh::cuboid("cube", DVec3::splat(0.01)).unwrap();
    let published = r#"{"units": "millimeters", "points": [{"id": 1, "x_mm": 1, "y_mm": 0, "z_mm": 5.0}, {"id": 2, "x_mm": 5.1, "y_mm": 0, "z_mm": 0}]}"#;
    let paxini = r#"{"model": "S", "units": "mm", "taxels_mm": [[1, 0, 5], [5.1, 0, 0]]}"#;
    let icub = "[calibration]\n0 0 0 0 0 0\n0.001 0 0.005 0 0 0\n0.0051 0 0 0 0 0\n";
    for (name, text) in [
        ("p.csv", "x_mm,y_mm,z_mm\n1,0,5\n5.1,0,0\n"),
        ("p.json", paxini),
        ("published.json", published),
        ("p.txt", icub),
    ] {
        let file = on_mesh(name, text, &cube).unwrap();
        assert_eq!(file.layout.axes(), [DVec3::Z, DVec3::X], "{name}");
        let centers = [DVec3::new(1e-3, 0.0, 5e-3), DVec3::new(5.1e-3, 0.0, 0.0)];
        assert_eq!(file.layout.centers(), centers, "{name}");
        let has_note = file.notes.iter().any(|note| note.contains("not used: id"));
        assert_eq!(has_note, name == "published.json", "{:?}", file.notes);
    }
    let places = array![[0.0, 1e-3], [2e-3, 3e-3]];
    let archive = npz(|npz| npz.add_array("positions", &places).unwrap());
    for (name, content) in [
        ("flat.npz", archive),
        ("flat.csv", b"x_mm,y_mm\n0,1\n2,3\n".to_vec()),
    ] {
        let file = layout(name, content);
        let centers = [DVec3::new(0.0, 1e-3, 0.0), DVec3::new(2e-3, 3e-3, 0.0)];
        assert_eq!(file.layout.centers(), centers);
        assert_eq!(file.layout.axes(), [DVec3::Z; 2]);
        says(&file.notes[0], &["flat skin"]);
    }
}

/// Returns the table of taxels around a cylinder with the axis y, whose radius is 10 mm, as on a forearm.
fn arm(normal: impl Fn(f64) -> DVec3) -> String {
    let row = |k: i32| {
        let (angle, y) = (0.3 * f64::from(k % 10), 4e-3 * f64::from(k / 10));
        let (x, z, n) = (1e-2 * angle.sin(), 1e-2 * angle.cos(), normal(angle));
        format!("{x},{y},{z},{},{},{}\n", n.x, n.y, n.z)
    };
    "x_m,y_m,z_m,nx,ny,nz\n".to_owned() + &(0..40).map(row).collect::<String>()
}

/// Returns the side of a fine cylinder around y, of triangles.
fn cylinder(radius: f64, length: f64) -> TriangleMesh {
    let n = 720;
    let vertex = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k / 2) / f64::from(n);
        let y = length * (f64::from(k % 2) - 0.5);
        DVec3::new(radius * angle.sin(), y, radius * angle.cos())
    };
    let triangles = (0..n).flat_map(|k| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|corner| (2 * k + corner) % (2 * n));
        [[a, c, b], [b, c, d]]
    });
    let vertices = (0..2 * n).map(vertex).collect();
    TriangleMesh::new("cylinder", vertices, triangles.collect()).unwrap()
}

/// Equal normals of all taxels are normals of a flat pad, and placeholders of other skins.
#[test]
fn equal_normals_that_do_not_stand_across_the_taxels_are_placeholders() {
    let refused = |name: &str, text: &str, wanted: &str| {
        let error = read(&Case::new().file(name, text)).unwrap_err().to_string();
        says(
            &error,
            &[
                name,
                wanted,
                "is not perpendicular to their surface; ",
                ", or a mesh beside it",
            ],
        );
    };
    // 4 × 6 taxels of a pad across n, and a column of them.
    let pad = |n: DVec3, n_columns: usize, normal: DVec3| -> String {
        let (u, v) = n.any_orthonormal_pair();
        let place = |k: usize| 4e-3 * ((k % n_columns) as f64 * u + (k / n_columns) as f64 * v);
        let row = |k: usize| {
            let numbers = [place(k).to_array(), normal.to_array()].concat();
            let numbers = numbers.iter().map(|number| format!("{number:.4}"));
            numbers.collect::<Vec<_>>().join(" ") + "\n"
        };
        "[calibration]\n".to_owned() + &(0..6 * n_columns).map(row).collect::<String>()
    };
    let tilted = DVec3::new(1.0, -2.0, 0.5).normalize();
    for n in [DVec3::X, DVec3::Z, tilted] {
        for n_columns in [1, 4] {
            let file = layout("pad.txt", pad(n, n_columns, n));
            assert!((file.layout.axes()[0] - n).length() < 1e-3);
            // Normals along the pad, or along the column.
            let (u, v) = n.any_orthonormal_pair();
            for along in if n_columns == 1 { vec![v] } else { vec![u, v] } {
                let wanted = format!("of all {} taxels", 6 * n_columns);
                refused("sole.txt", &pad(n, n_columns, along), &wanted);
            }
        }
    }
    let outwards = |angle: f64| DVec3::new(angle.sin(), 0.0, angle.cos());
    refused("shin.csv", &arm(|_| outwards(1.35)), "of all 40 taxels");
    refused(
        "arm_x.csv",
        &arm(|_| DVec3::Y),
        "the normal [0, 1, 0] of all 40 taxels",
    );
    // A fine cylinder of triangles gives the normals.
    let cylinder = cylinder(1e-2, 0.1);
    let from_mesh = on_mesh("arm_x.csv", arm(|_| DVec3::Y), &cylinder).unwrap();
    says(
        &from_mesh.notes[0],
        &["is not perpendicular to their surface; the mesh gives the normals"],
    );
    let true_normals = layout("arm.csv", arm(outwards));
    let mut pairs = from_mesh
        .layout
        .axes()
        .iter()
        .zip(true_normals.layout.axes());
    assert!(pairs.all(|(one, other)| one.distance(*other) < 5e-3));
    let given = on_mesh("arm.csv", arm(outwards), &cylinder).unwrap_err();
    says(&given.to_string(), &["a mesh for normals; none"]);
}

#[test]
fn a_layout_of_another_unit_is_noted_and_read_with_its_unit() {
    let points = |scale: f64| {
        let place = |k: usize| [scale * (k % 4) as f64, scale * (k / 4) as f64, 0.0];
        let places: Vec<[f64; 3]> = (0..16).map(place).collect();
        format!(
            "{{\"points\": {places:?}, \"normals\": {:?}}}",
            vec![[0.0, 0.0, 1.0]; 16]
        )
    };
    let expected = layout("mm.json", points(4.0));
    assert!(expected.notes.is_empty());
    let file = layout("m.json", points(4e-3));
    let note = "m.json: the layout is 0.012 mm long; 1 mm to 1 m is usual: if the file is in another unit, give it (--unit, or unit= in Python)";
    assert_eq!(file.notes.len(), 1);
    assert!(file.notes[0].ends_with(note), "{:?}", file.notes);
    let place = |(k, axis): (usize, usize)| [4.0 * (k % 4) as f64, 4.0 * (k / 4) as f64, 0.0][axis];
    let positions = Array2::from_shape_fn((16, 3), place);
    let normals = Array2::from_shape_fn((16, 3), |(_, axis)| f64::from(axis == 2));
    let archive = npz(|npz| {
        npz.add_array("positions", &positions).unwrap();
        npz.add_array("normals", &normals).unwrap();
        npz.add_array("radii", &Array1::from_elem(16, 1.5)).unwrap();
    });
    let notes = layout("mm.npz", &archive).notes;
    says(&notes[0], &["the layout is 12000 mm long"]);
    let in_metres = in_unit("m.json", points(4e-3), LengthUnit::Metre).unwrap();
    let in_millimetres = in_unit("mm.npz", archive, LengthUnit::Millimetre).unwrap();
    assert_eq!(in_millimetres.radii, Some(vec![1.5e-3; 16]));
    for file in [in_metres, in_millimetres] {
        assert!(file.notes.is_empty(), "{:?}", file.notes);
        for (one, other) in file.layout.centers().iter().zip(expected.layout.centers()) {
            near(*one, *other);
        }
    }
    // The unit of a file that states it is not replaced.
    let stated = points(4.0).replacen('{', "{\"units\": \"mm\", ", 1);
    for (name, text) in [("s.json", &stated[..]), ("t.csv", "x_mm,y_mm\n0,0\n4,0\n")] {
        let error = in_unit(name, text, LengthUnit::Millimetre).unwrap_err();
        says(&error.to_string(), &["a unit; none: "]);
    }
    let large = layout("large.csv", "x_m,y_m\n0,0\n4,0\n");
    says(&large.notes.concat(), &["4000 mm long"]);
}

#[test]
fn every_sensor_of_a_robots_file_has_its_own_fault() {
    let sensor = "<sensor name='palm'><parent link='a'/><tactile channel='c'><taxel idx='2' xyz='0 0 0'/></tactile></sensor>\n";
    let text = format!("<robot name='r'><link name='a'/>\n{sensor}{sensor}</robot>");
    let case = Case::new();
    let path = case.file("two.urdf", text);
    let error = read(&path).unwrap_err().to_string();
    let second = "line 3: a second sensor `palm` (the first is on line 2); a name of its own";
    says(&error, &[second]);
    let robot = Robot::read(&path).unwrap();
    assert_eq!(robot.tactile_sensors().len(), 1);
    let unread = "tactile sensor `palm` on link `a` is not read";
    says(&robot.notes().concat(), &[unread]);
}

#[test]
fn a_patch_of_a_scene_has_the_taxels_of_a_file_or_of_its_robots_sensor() {
    let case = Case::with("palm.txt", ICUB);
    let array = "<array rows='4' cols='6' size='0.003 0.003' spacing='0.004 0.004'/>";
    case.file("pad.urdf", robot(array));
    case.file("large.csv", "x_m,y_m\n0,0\n4,0\n");
    let scene = |layout: &str| {
        let text = format!(
            "title = \"A pad\"\nrobots = [{{ name = \"r\", urdf = \"pad.urdf\" }}]\n\
             [[patches]]\nname = \"p\"\nrobot = \"r\"\nstroke_mm = 5.0\nlayout = {layout}\n"
        );
        ScenePlan::read(&case.file("s.toml", &text))
    };
    let plan = scene("{ sensor = \"pad_tactile\" }").unwrap();
    let skin = &plan.patches[0].skin;
    assert_eq!(skin.n_taxels(), 24);
    near(skin.layout().centers()[0], [0.0, 0.0, 0.01]);
    assert!((skin.taxels().at(0).radius - 2e-3).abs() < 1e-12);
    assert_eq!(plan.notes().count(), 0);
    let notes = |layout: &str| scene(layout).unwrap().notes().collect::<String>();
    let large = notes("{ file = \"large.csv\" }");
    says(&large, &["patches.p: ", "4000 mm long"]);
    let left_out = "`pad_tactile` on link `base` is not read: layout = { sensor";
    says(&notes("{ file = \"palm.txt\" }"), &[left_out]);
    let palm = scene("{ file = \"palm.txt\" }").unwrap();
    assert_eq!(palm.patches[0].skin.n_taxels(), 2);
    for (layout, wanted) in [
        ("{ sensor = \"pad\" }", "layout.sensor: `pad`"),
        ("{ file = \"none.csv\" }", "none.csv"),
    ] {
        let error = scene(layout).unwrap_err();
        says(&error.to_string(), &[wanted]);
        assert_eq!(error.exit_code(), 2);
    }
}
