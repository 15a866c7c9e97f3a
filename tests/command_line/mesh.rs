//! Meshes on the command line: their descriptions, and presses and studies of exact meshes.

use crate::command::{Case, says, words};
use bubbletouch::mesh::LengthUnit;
use bubbletouch::study::{ModelSpec, ObjectsSpec, load_objects};

/// Returns a cube of 40 mm in millimetres that stands on z = 0.
fn cube() -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let at = |bit: u32| if corner & bit == 0 { -20 } else { 20 };
        text += &format!("v {} {} {}\n", at(1), at(2), at(4) + 20);
    }
    for quad in [
        "1 5 7 3", "2 4 8 6", "1 2 6 5", "3 7 8 4", "1 3 4 2", "5 6 8 7",
    ] {
        text += &format!("f {quad}\n");
    }
    text
}

/// Returns the cube with a triangular hole in the middle of its top, 0.9 mm wide.
fn cube_with_hole() -> String {
    let top = "v 0 0 40\nv 0.6364 0 40\nv 0 0.6364 40\n\
               f 5 6 10 9\nf 6 8 10\nf 8 11 10\nf 8 7 11\nf 7 5 9\nf 7 9 11\n";
    cube().replace("f 5 6 8 7\n", top)
}

#[test]
fn a_mesh_is_described() {
    let case = Case::new();
    case.file("cube.obj", cube());
    let (said, _) = case.succeeds(&["objects", "mesh", "cube.obj", "--unit", "mm"]);
    assert!(
        said.starts_with("size        40.0 × 40.0 × 40.0 mm\n"),
        "{said}"
    );
    says(&said, &["\nvolume      64.00 cm³\n"]);
    assert!(said.ends_with("\nfaults      none\n"), "{said}");
}

#[test]
fn a_pressed_cube_is_flat_under_its_face_and_not_inflated() {
    let case = Case::new();
    case.file("cube.obj", cube());
    let press = "press --mesh cube.obj --unit mm --model mesh --taxels 32x32 --pitch-mm 2.1 --depth-mm 2 --out frame.csv";
    let (_, error) = case.succeeds(&press.split(' ').collect::<Vec<_>>());
    // 20 taxels with a pitch of 2 mm are under 40 mm; the nearest taxels beside them are 1 mm (one radius) away.
    assert!(
        error.starts_with("400 of 1024 taxels touched, 0 saturated; deepest 2.000 mm"),
        "{error}"
    );
    let frame = std::fs::read_to_string(case.path("frame.csv")).unwrap();
    let deflections: Vec<f64> = frame
        .split([',', '\n'])
        .filter_map(|n| n.parse().ok())
        .collect();
    let under = deflections.iter().filter(|&&d| (d - 2e-3).abs() < 1e-9);
    assert_eq!(under.count(), 400);
}

/// Returns the mesh with all faces reversed.
fn inside_out(text: &str) -> String {
    let turned = text.lines().map(|line| match line.strip_prefix("f ") {
        None => line.to_owned(),
        Some(face) => {
            let mut corners: Vec<&str> = face.split(' ').collect();
            corners[1..].reverse();
            format!("f {}", corners.join(" "))
        }
    });
    turned.collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn a_closed_mesh_that_faces_inwards_is_turned_with_a_note() {
    let case = Case::new();
    case.file("cube.obj", cube());
    case.file("turned.obj", inside_out(&cube()));
    case.file(
        "mirrored.obj",
        cube().replace("v ", "v -").replace("--", ""),
    );
    for model in ["mesh", "packed --surface-error-mm 3"] {
        for (file, has_note) in [("cube", false), ("turned", true), ("mirrored", true)] {
            let press = format!(
                "press --mesh {file}.obj --unit mm --model {model} --taxels 32x32 --pitch-mm 2.1 --depth-mm 2 --out {file}.csv"
            );
            let (_, said) = case.succeeds(&words(&press));
            let note = format!(
                "note: {file}.obj: 12 of 12 triangles faced inwards and were turned outwards\n"
            );
            assert_eq!(said.contains(&note), has_note, "{said}");
            let is_exact = model == "mesh";
            assert!(
                !is_exact || said.contains("400 of 1024 taxels touched"),
                "{said}"
            );
        }
    }
    case.succeeds(&words(
        "objects pack turned.obj --unit mm --surface-error-mm 3 --out turned.csv",
    ));
    // The description of the file itself is unchanged.
    let (said, _) = case.succeeds(&words("objects mesh turned.obj --unit mm"));
    says(&said, &["faces that face inwards"]);
}

#[test]
fn skin_over_a_mesh_points_outwards_whichever_way_the_file_faces() {
    let case = Case::new();
    case.file("cube.obj", cube());
    case.file("turned.obj", inside_out(&cube()));
    let open = |text: String| {
        text.lines()
            .filter(|line| !line.contains("f 5 "))
            .map(|l| format!("{l}\n"))
            .collect::<String>()
    };
    case.file("open.obj", open(inside_out(&cube())));
    let scene = "title = \"A cube of skin\"\ndt_ms = 10.0\noutput_hz = 100.0\nduration_s = 0.05\n[[patches]]\nname = \"pad\"\n\
                 layout = { draped = { mesh = \"FILE\", unit = \"mm\", pitch_mm = 5.0 } }\nstroke_mm = 5.0\nstiffness_n_per_m = 100.0\n\
                 [[objects]]\nname = \"ball\"\nobject = \"tennis\"\nat = { position_mm = [0.0, 0.0, 38.0] }\n";
    for (file, has_note) in [("cube", false), ("turned", true)] {
        let content = std::fs::read(case.path(&format!("{file}.obj"))).unwrap();
        case.file("skin.obj", content);
        case.file("scene.toml", scene.replace("FILE", "skin.obj"));
        let (_, said) = case.succeeds(&words(&format!("simulate scene.toml --out {file}")));
        assert_eq!(
            said.contains("12 of 12 triangles faced inwards"),
            has_note,
            "{said}"
        );
        // Reversed triangles give other taxel positions; if the axes pointed inwards, all touched taxels would be saturated.
        let wrenches = case.path(file).join("wrenches.csv");
        let text = std::fs::read_to_string(wrenches).unwrap();
        let row: Vec<&str> = text.lines().nth(1).unwrap().split(',').collect();
        let number = |column: usize| row[column].parse::<f64>().unwrap();
        let (n_touched, n_saturated, force) = (number(2), number(3), number(6));
        assert!((30.0..50.0).contains(&n_touched), "{text}");
        assert!(n_saturated < 0.2 * n_touched, "{text}");
        assert!((-16.0..-8.0).contains(&force), "{text}");
    }
    case.file("scene.toml", scene.replace("FILE", "open.obj"));
    let said = case.refuses(&words("simulate scene.toml --out open"));
    says(
        &said,
        &["open.obj: an open mesh whose faces face inwards; "],
    );
}

#[test]
fn a_mesh_is_touched_as_it_is_unless_vertex_spheres_are_named() {
    let case = Case::new();
    case.file("cube.obj", cube());
    let press = |model: &str| {
        let press = format!(
            "press --mesh cube.obj --unit mm{model} --taxels 48x48 --pitch-mm 2.1 --depth-mm 2 --out frame.csv"
        );
        case.succeeds(&words(&press)).1
    };
    for model in ["", " --model mesh"] {
        let said = press(model);
        assert!(
            said.starts_with("400 of 2304 taxels touched"),
            "{model}: {said}"
        );
    }
    let said = press(" --model vertex_spheres");
    says(&said, &["note: vertex spheres are up to "]);
    says(&said, &["more than half the pitch of 2.1 mm"]);
    assert!(!said.contains("\n400 of"), "{said}");
}

#[test]
fn a_study_touches_meshes_as_they_are_and_writes_that_down() {
    let case = Case::new();
    std::fs::create_dir(case.path("meshes")).unwrap();
    case.file("meshes/cube.obj", cube());
    case.file("meshes/flat.obj", cube().replace(" 40\n", " 12\n"));
    let study = "question = \"Which?\"\n[objects]\nmeshes = \"meshes\"\nunit = \"mm\"\nMODEL\n[skin]\npitch_mm = 2.0\ntaxels = 16\nstroke_mm = 5.0\n\
                 [touches]\nper_object = 8\nyaw_deg = { uniform = [0.0, 90.0] }\ndepth_mm = 2.0\n[sensing]\nensemble = \"gaussian\"\nratio = 16\n\
                 [recognition]\nclassifier = \"linear_svm\"\nc = 1.0\n";
    let mut frames = Vec::new();
    for (name, model) in [
        ("default", ""),
        ("mesh", "model = \"mesh\""),
        ("vertex", "model = \"vertex_spheres\""),
    ] {
        case.file("study.toml", study.replace("MODEL", model));
        let (_, said) = case.succeeds(&words(&format!("touches study.toml --out {name}")));
        let note = "in 2 of 2 meshes; model = \"mesh\" touches meshes exactly";
        assert_eq!(said.contains(note), name == "vertex", "{said}");
        frames.push(std::fs::read(case.path(name).join("frames.npy")).unwrap());
    }
    assert_eq!(frames[0], frames[1]);
    assert_ne!(frames[0], frames[2]);
    case.file("study.toml", study.replace("MODEL", ""));
    case.succeeds(&words("run study.toml --out results"));
    let resolved = std::fs::read_to_string(case.path("results/study.toml")).unwrap();
    says(&resolved, &["model = \"mesh\""]);
}

#[test]
fn a_free_object_of_a_mesh_is_packed() {
    let case = Case::new();
    case.file("cube.obj", cube());
    case.file("open.obj", cube().replace("f 5 6 8 7\n", ""));
    let scene = "title = \"A cube that falls\"\ndt_ms = 10.0\noutput_hz = 100.0\nduration_s = 0.05\n[[patches]]\nname = \"pad\"\n\
                 layout = { grid = { nx = 8, ny = 8, pitch_mm = 4.0 } }\nstroke_mm = 5.0\nstiffness_n_per_m = 100.0\n\
                 [[objects]]\nname = \"cube\"\nmesh = \"FILE\"\nunit = \"mm\"\nsurface_error_mm = 3.0\nfree = { mass_kg = 0.1 }\nat = { position_mm = [0.0, 0.0, 3.0] }\n";
    case.file("scene.toml", scene.replace("FILE", "cube.obj"));
    case.succeeds(&words("simulate scene.toml --out simulated"));
    case.file("scene.toml", scene.replace("FILE", "open.obj"));
    let said = case.refuses(&words("simulate scene.toml --out open"));
    says(&said, &["open.obj: a hole", "vertex_spheres"]);
}

#[test]
fn what_takes_minutes_says_so_before_it_begins() {
    let case = Case::new();
    case.file("cube.obj", cube());
    let pack = "objects pack cube.obj --unit mm --surface-error-mm 0.002 --out cube.csv";
    let mut command = case.command(&words(pack));
    let mut child = command
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = String::new();
    let mut lines = std::io::BufReader::new(child.stderr.take().unwrap());
    std::io::BufRead::read_line(&mut lines, &mut first).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(
        first.starts_with("note: cube.obj: a surface error of 2e-3 mm takes about "),
        "{first}"
    );
    says(&first, &["min of one processor"]);
}

#[test]
fn packed_spheres_are_written_and_shown_beside_the_mesh() {
    let case = Case::new();
    case.file("cube.obj", cube());
    let succeeds = |arguments: &str| case.succeeds(&arguments.split(' ').collect::<Vec<_>>());
    let (said, _) = succeeds("objects pack cube.obj --unit mm --surface-error-mm 3 --out cube.csv");
    let spheres = std::fs::read_to_string(case.path("cube.csv")).unwrap();
    let n_spheres = spheres.lines().count() - 1;
    assert!(
        said.starts_with(&format!("spheres     {n_spheres}\n")),
        "{said}"
    );
    succeeds("objects show cube.obj --unit mm --spheres cube.csv --panel-px 200 --out kept.png");
    succeeds("objects show cube.obj --unit mm --surface-error-mm 3 --panel-px 200 --out made.png");
    let [kept, made] = ["kept.png", "made.png"].map(|name| std::fs::read(case.path(name)).unwrap());
    assert!(kept.starts_with(b"\x89PNG"));
    assert_eq!(kept, made, "the same spheres, read or made");
    succeeds("objects show mug --surface-error-mm 2 --panel-px 200 --out mug.png");
    for wrong in [
        "objects show mug --out mug.jpg",
        "objects show mug --panel-px 10 --out other.png",
        "objects show cube.obj --spheres none.csv --out other.png",
    ] {
        case.refuses(&wrong.split(' ').collect::<Vec<_>>());
    }
    assert!(!case.path("other.png").exists());
}

#[test]
fn a_hole_is_named_with_its_file_and_what_can_be_done() {
    let case = Case::new();
    case.file("cube.obj", cube_with_hole());
    let pack = "objects pack cube.obj --unit mm --surface-error-mm 3 --out cube.csv";
    let pack: Vec<&str> = pack.split(' ').collect();
    let with = |more: &[&str]| case.run(&[&pack[..], more].concat());
    let output = with(&[]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    for word in [
        "cube.obj: a hole 0.90 mm wide",
        "--close-holes-mm",
        "--as-sheet",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert!(!case.path("cube.csv").exists());
    assert_eq!(with(&["--close-holes-mm", "0.8"]).status.code(), Some(2));
    let output = with(&["--close-holes-mm", "2"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    says(&said, &["cube.obj: closed 1 hole, 0.90 mm wide"]);
    assert!(with(&["--as-sheet"]).status.success());
    let both = with(&["--as-sheet", "--close-holes-mm", "1"]);
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn a_study_closes_holes_only_where_it_is_told_to() {
    let case = Case::new();
    std::fs::create_dir(case.path("meshes")).unwrap();
    case.file("meshes/cube.obj", cube_with_hole());
    let load = |model, close_holes_mm| {
        let spec = ObjectsSpec {
            meshes: Some(case.path("meshes").into()),
            model: Some(model),
            unit: Some(LengthUnit::Millimetre),
            surface_error_mm: Some(1.0),
            close_holes_mm,
            ..ObjectsSpec::default()
        };
        load_objects(&spec, None).map(|objects| objects[0].model.clone())
    };
    let closed = load(ModelSpec::Packed, Some(1.0)).unwrap();
    assert!(closed.n_spheres() > 10);
    assert_eq!(load(ModelSpec::Mesh, Some(1.0)).unwrap().n_triangles(), 20);
    assert_eq!(load(ModelSpec::Mesh, None).unwrap().n_triangles(), 17);
    for too_narrow in [None, Some(0.8)] {
        let error = load(ModelSpec::Packed, too_narrow).unwrap_err().to_string();
        says(&error, &["cube.obj: a hole 0.90 mm wide"]);
        says(&error, &["objects.close_holes_mm"]);
    }
    let error = load(ModelSpec::VertexSpheres, Some(1.0)).unwrap_err();
    assert!(error.to_string().contains("close_holes_mm"), "{error}");
}

/// Returns a die of 17 mm in millimetres.
fn die() -> String {
    cube().replace("20", "8.5").replace("40", "17")
}

#[test]
fn a_die_of_seventeen_metres_is_refused_everywhere_unless_its_unit_is_given() {
    let case = Case::new();
    case.file("die.obj", die());
    case.file("die.csv", "x,y,z,r\n0,0,20,8.5\n");
    std::fs::create_dir(case.path("meshes")).unwrap();
    case.file("meshes/die.obj", die());
    case.file("meshes/flat.obj", die().replace(" 8.5\n", " 4\n"));
    let study = "question = \"Which?\"\n[objects]\nmeshes = \"meshes\"\nUNIT\n[skin]\npitch_mm = 2.0\ntaxels = 16\nstroke_mm = 5.0\n\
                 [touches]\nper_object = 8\nyaw_deg = { uniform = [0.0, 90.0] }\ndepth_mm = 2.0\n[sensing]\nensemble = \"gaussian\"\nratio = 16\n\
                 [recognition]\nclassifier = \"linear_svm\"\nc = 1.0\n";
    case.file("without.toml", study.replace("UNIT", ""));
    case.file("with.toml", study.replace("UNIT", "unit = \"mm\""));
    let scene = "title = \"A pad\"\ndt_ms = 10.0\noutput_hz = 100.0\nduration_s = 0.1\n[[patches]]\nname = \"pad\"\nlayout = { grid = { nx = 8, ny = 8, pitch_mm = 2.0 } }\n\
                 stroke_mm = 5.0\nstiffness_n_per_m = 100.0\n[[objects]]\nname = \"die\"\nFILE\nUNIT\nat = { position_mm = [0.0, 0.0, -1.0] }\n";
    for (name, file) in [
        ("mesh", "mesh = \"die.obj\""),
        ("csv", "spheres = \"die.csv\""),
    ] {
        let scene = scene.replace("FILE", file);
        case.file(&format!("{name}_without.toml"), scene.replace("UNIT", ""));
        case.file(
            &format!("{name}_with.toml"),
            scene.replace("UNIT", "unit = \"mm\""),
        );
    }
    for (without, with) in [
        ("press --mesh die.obj", " --unit mm"),
        ("press --spheres die.csv --stroke-mm 50", " --unit mm"),
        ("objects mesh die.obj", " --unit mm"),
        ("objects --mesh die.obj", " --unit mm"),
        (
            "objects pack die.obj --surface-error-mm 1 --out spheres.csv",
            " --unit mm",
        ),
        (
            "objects show die.obj --surface-error-mm 1 --panel-px 200 --out die.png",
            " --unit mm",
        ),
        (
            "objects show die.obj --unit mm --spheres die.csv --panel-px 200 --out die.png",
            " --spheres-unit mm",
        ),
        ("run without.toml --out results", ""),
        ("simulate mesh_without.toml --out simulated_mesh", ""),
        ("simulate csv_without.toml --out simulated_csv", ""),
    ] {
        let said = case.refuses(&words(without));
        assert!(
            said.contains("17 m wide, if its unit is the metre; "),
            "{without}: {said}"
        );
        let advice = "in mm it would be 17 mm: give unit = \"mm\" (--unit mm)";
        assert!(said.contains(advice), "{without}: {said}");
        case.succeeds(&words(&(without.replace("without", "with") + with)));
    }
}

const HARDWARE: &str = include_str!("../../guide/objects.md");

#[test]
fn own_objects_are_named_by_the_same_option_everywhere() {
    let case = Case::new();
    let example = HARDWARE.split("```toml\n").nth(1).unwrap();
    let example = example.split("```").next().unwrap();
    case.file("hardware.toml", example);
    let (said, _) = case.succeeds(&words("objects --objects hardware.toml"));
    says(&said, &[" nut ", " bolt "]);
    assert!(!said.contains("mug"), "{said}");
    case.succeeds(&words(
        "objects nut bolt --objects hardware.toml --out both.png",
    ));
    case.succeeds(&words(
        "objects show nut --objects hardware.toml --panel-px 200 --out nut.png",
    ));
    let pack = "objects pack nut --objects hardware.toml --surface-error-mm 0.1 --out nut.csv";
    let (said, _) = case.succeeds(&words(pack));
    says(&said, &["gap         max 0.0"]);
    // A ring of taxels touches the nut; taxels over its hole touch nothing.
    let press = "press --objects hardware.toml --object nut --taxels 17x17 --pitch-mm 1 --depth-mm 1 --out nut.npz";
    let (_, said) = case.succeeds(&words(press));
    assert!(!said.starts_with("0 of"), "{said}");
    let press = press.replace("nut.npz", "frame.csv");
    case.succeeds(&words(&press));
    let frame = std::fs::read_to_string(case.path("frame.csv")).unwrap();
    let rows: Vec<Vec<f64>> = frame
        .lines()
        .map(|row| row.split(',').filter_map(|n| n.parse().ok()).collect())
        .collect();
    let rows = &rows[rows.len() - 17..];
    assert_eq!(rows[8][8], 0.0, "over the hole");
    assert!((rows[8][8 + 5] - 1e-3).abs() < 0.3e-3, "{}", rows[8][13]);
    let scene = "title = \"A pad\"\ndt_ms = 10.0\noutput_hz = 100.0\nduration_s = 0.1\n[[patches]]\nname = \"pad\"\nlayout = { grid = { nx = 8, ny = 8, pitch_mm = 2.0 } }\n\
                 stroke_mm = 5.0\nstiffness_n_per_m = 100.0\n[[objects]]\nname = \"it\"\nobject = \"nut\"\nobjects = \"hardware.toml\"\n";
    case.file("scene.toml", scene);
    case.succeeds(&words("simulate scene.toml --out simulated"));
    let study = "question = \"Which?\"\n[objects]\nsets = [\"balls\"]\n[skin]\npitch_mm = 1.0\ntaxels = 16\nstroke_mm = 5.0\n\
                 [touches]\nper_object = 8\nyaw_deg = { uniform = [0.0, 90.0] }\ndepth_mm = 2.0\n[sensing]\nensemble = \"gaussian\"\nratio = 16\n\
                 [recognition]\nclassifier = \"linear_svm\"\nc = 1.0\n";
    case.file("study.toml", study);
    let (said, _) = case.succeeds(&words("plan study.toml --objects hardware.toml"));
    assert!(said.contains('2'), "{said}");
    case.succeeds(&words(
        "run study.toml --objects hardware.toml --out results",
    ));
    let confusion = std::fs::read_to_string(case.path("results/confusion.csv")).unwrap();
    assert!(
        confusion.contains("bolt") && !confusion.contains("golf"),
        "{confusion}"
    );
    case.file(
        "wrong.toml",
        example.replacen("height_mm = 6.8", "height_mm = -2", 1),
    );
    for wrong in [
        "objects --objects wrong.toml",
        "objects show nut --objects wrong.toml --out wrong.png",
        "press --object nut --objects wrong.toml",
        "run study.toml --objects wrong.toml --out other",
    ] {
        let said = case.refuses(&words(wrong));
        let expected = "wrong.toml, line 8, object `nut`, part 1 (hexagonal_prism): height_mm = -2; a finite positive length";
        assert!(said.contains(expected), "{wrong}: {said}");
    }
}
