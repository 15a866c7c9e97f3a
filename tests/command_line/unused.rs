//! An option or key without effect is an error that names what would use it.

use crate::bad_input::refused;
use crate::command::Case;

/// Four triangles of a right-angled corner of 20 mm.
const TETRAHEDRON: &str =
    "v 0 0 0\nv 0.02 0 0\nv 0 0.02 0\nv 0 0 0.02\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn an_option_that_cannot_act_is_refused_and_names_what_would_use_it() {
    let case = Case::new();
    case.file("solid.obj", TETRAHEDRON);
    case.file("spheres.csv", "x,y,z,r\n0,0,0,0.01\n");
    case.file("objects.toml", "[[object]]\nname = \"a\"\nsource = \"b\"\npart = [{ shape = \"ball\", diameter_mm = 20 }]\n");
    let before = case.names();
    let knn = "classify . --classifier k_nearest";
    let linear = "classify . --classifier linear_svm";
    for (arguments, words) in [
        (format!("{knn} --c 2"), ["--c:", "linear_svm"]),
        (format!("{knn} --c-grid 1,10"), ["--c-grid", "linear_svm"]),
        (format!("{knn} --c-grid 1 --gamma-grid 1"), ["--c-grid", "svm"]),
        (format!("{knn} --solver smo"), ["--solver", "rbf_svm"]),
        (format!("{knn} --multiclass one_vs_rest"), ["--multiclass", "rbf_svm"]),
        (format!("{knn} --tolerance 0.1"), ["--tolerance", "logistic_regression"]),
        (format!("{linear} --gamma 0.1"), ["--gamma", "rbf_svm"]),
        (format!("{linear} --degree 2"), ["--degree", "polynomial_svm"]),
        (format!("{linear} --coef0 2"), ["--coef0", "polynomial_svm"]),
        (format!("{linear} --cv-folds 3"), ["--cv-folds", "--c-grid"]),
        ("classify . --classifier rbf_svm --c 1 --gamma-grid 1".to_owned(), ["--gamma-grid", "--c-grid"]),
        ("press --mesh solid.obj --objects objects.toml".to_owned(), ["--objects", "--mesh"]),
        ("press --spheres spheres.csv --objects objects.toml".to_owned(), ["--objects", "--spheres"]),
        ("press --mesh solid.obj --model vertex_spheres --surface-error-mm 1".to_owned(), ["--surface-error-mm", "packed"]),
        ("press --mesh solid.obj --model mesh --surface-error-mm 1".to_owned(), ["--surface-error-mm", "packed"]),
        ("press --spheres spheres.csv --surface-error-mm 1".to_owned(), ["--surface-error-mm", "--object"]),
        ("press --object golf --stiffness-n-per-m 50".to_owned(), ["--stiffness-n-per-m", "--force-n"]),
        ("press --object golf --yaw-deg 5 --json".to_owned(), ["--json", "--poses"]),
        ("press --object golf --yaw-deg 5 --repeat 3".to_owned(), ["--repeat", "--poses"]),
        ("objects pack mug --unit mm --surface-error-mm 2 --out o.csv".to_owned(), ["--unit", "mesh"]),
        ("objects pack mug --as-sheet --surface-error-mm 2 --out o.csv".to_owned(), ["--as-sheet", "mesh"]),
        ("objects pack mug --close-holes-mm 2 --surface-error-mm 2 --out o.csv".to_owned(), ["--close-holes-mm", "mesh"]),
        ("objects pack a --objects objects.toml --close-holes-mm 2 --surface-error-mm 2 --out o.csv".to_owned(), ["--close-holes-mm", "mesh"]),
        ("objects show mug --spheres-unit mm --surface-error-mm 2 --out o.png".to_owned(), ["--spheres-unit", "--spheres"]),
        ("objects mug --unit mm".to_owned(), ["--unit", "NAMES"]),
        ("objects --unit mm".to_owned(), ["--unit", "--mesh"]),
        ("objects --mesh solid.obj --surface-error-mm 1".to_owned(), ["--surface-error-mm", "--mesh"]),
        ("recording a.npz --fps 3".to_owned(), ["--fps", "--animate"]),
        ("recording a.npz --speed 3".to_owned(), ["--speed", "--animate"]),
        ("recording a.npz --quantity force".to_owned(), ["--quantity", "--frame"]),
        ("recording a.npz --patch palm".to_owned(), ["--patch", "--frame"]),
        ("recording a.npz --animate a.png --out b.png".to_owned(), ["--out", "--frame"]),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        refused(&case.run(&arguments), 2, &words);
    }
    assert_eq!(case.names(), before, "nothing is written");
}

/// Reconstruction study; the tests add keys to its tables.
const RECONSTRUCTION: &str = r#"
question = "What comes back?"
[objects]
sets = ["cans"]
[skin]
pitch_mm = 8.0
taxels = 8
stroke_mm = 5.0
[touches]
per_object = 4
offset_x_mm = { uniform = [-6.0, 6.0] }
depth_mm = 3.0
[signal]
noise_std_full_scale = 0.1
[sensing]
ratio = 4
[reconstruction]
solver = "lmmse"
dictionary = "dct"
"#;

/// Returns an object-detail study with another key in a table.
fn detail(table: &str, key: &str) -> String {
    let study = "question = \"q\"\n[objects]\nmeshes = \"meshes\"\n[skin]\npitch_mm = 2.0\ntaxels = 16\nstroke_mm = 5.0\n\
                 [touches]\nper_object = 6\ndepth_mm = 3.0\n[object_detail]\ntolerances_mm = [2.0]\nmethods = [\"packing\"]\n";
    study.replace(table, &format!("{table}\n{key}"))
}

/// Returns a recognition study with the given classifiers.
fn recognition(classifier: &str, more: &str) -> String {
    format!(
        "question = \"q\"\n[objects]\nsets = [\"cans\"]\n[skin]\npitch_mm = 8.0\ntaxels = 8\nstroke_mm = 5.0\n\
         [touches]\nper_object = 8\ndepth_mm = {{ uniform = [2.0, 3.0] }}\n[sensing]\nratio = 4\n[recognition]\nclassifier = {classifier}\n{more}\n"
    )
}

#[test]
fn a_key_that_cannot_act_is_refused_with_its_line_by_plan_and_by_run() {
    let case = Case::new();
    let with = |table: &str, key: &str| RECONSTRUCTION.replace(table, &format!("{table}\n{key}"));
    let unused = "no classifier of the study uses it";
    for (study, words) in [
        (
            with("[touches]", "frames = 3"),
            ["x.toml:10, key touches.frames", "recognition"],
        ),
        (
            with("[touches]", "slide_deg = 3.0"),
            ["key touches.slide_deg", "recognition"],
        ),
        (
            with("[skin]", "stiffness_n_per_m = 50.0"),
            ["x.toml:6, key skin.stiffness_n_per_m: 50, but no force", "\"force\" among signal.steps"],
        ),
        (
            with("[skin]", "damping_n_s_per_m = 0.5"),
            ["key skin.damping_n_s_per_m: 0.5, but no force", "\"force\" among signal.steps"],
        ),
        (
            with("[touches]", "speed_mm_per_s = 5.0"),
            ["key touches.speed_mm_per_s: 5, but no force", "\"force\" among signal.steps"],
        ),
        (
            with("[signal]", "steps = [\"force\", \"noise\"]")
                .replace("[skin]", "[skin]\ndamping_n_s_per_m = 0.5"),
            ["key skin.damping_n_s_per_m: 0.5, but every touch is read at rest", "touches.speed_mm_per_s"],
        ),
        (
            with("[signal]", "steps = [\"force\", \"noise\"]")
                .replace("[touches]", "[touches]\nspeed_mm_per_s = 5.0"),
            ["key touches.speed_mm_per_s: 5, but the skin has no damper", "skin.damping_n_s_per_m"],
        ),
        (
            detail("[skin]", "stiffness_n_per_m = 50.0"),
            ["key skin.stiffness_n_per_m: 50, but no force", "no such key"],
        ),
        (
            detail("[skin]", "damping_n_s_per_m = 0.5"),
            ["key skin.damping_n_s_per_m: 0.5, but no force", "no such key"],
        ),
        (
            detail("[touches]", "speed_mm_per_s = 5.0"),
            ["key touches.speed_mm_per_s: 5, but no force", "no such key"],
        ),
        (
            with("[signal]", "test_sensor = \"another_skin\""),
            ["key signal.test_sensor", "recognition"],
        ),
        (
            with("[signal]", "combine = \"one_at_a_time\""),
            ["key signal.combine", "noise"],
        ),
        (
            recognition("\"linear_svm\"", "")
                .replace("[touches]", "damping_n_s_per_m = 0.5\n[touches]"),
            ["key skin.damping_n_s_per_m: 0.5", "\"force\" among signal.steps"],
        ),
        (
            recognition("\"linear_svm\"", "")
                .replace("[touches]", "sensed = \"force\"\ndamping_n_s_per_m = 0.5\n[touches]"),
            ["key skin.damping_n_s_per_m: 0.5", "touches.speed_mm_per_s above 0"],
        ),
        (
            recognition("\"linear_svm\"", "").replace(
                "[sensing]",
                "[signal]\nnoise_std_full_scale = [0.0, 0.1]\ncombine = \"one_at_a_time\"\n[sensing]",
            ),
            ["key signal.combine: one_at_a_time", "two axes"],
        ),
        (
            recognition(
                "\"linear_svm\"",
                "touches_per_decision = 2\nnext_touch = \"farthest\"\ncv_folds = 3",
            ),
            ["key recognition.cv_folds: 3", "most_informative"],
        ),
        (
            recognition("\"linear_svm\"", "degree = 2"),
            ["x.toml:15, key recognition.degree", "polynomial_svm"],
        ),
        (
            recognition("\"linear_svm\"", "coef0 = 2.0"),
            [unused, "polynomial_svm"],
        ),
        (
            recognition("\"linear_svm\"", "gamma = 0.5"),
            [unused, "rbf_svm"],
        ),
        (
            recognition("\"linear_svm\"", "n_trees = 5"),
            [unused, "random_forest"],
        ),
        (
            recognition("\"k_nearest\"", "multiclass = \"one_vs_rest\""),
            [unused, "linear_svm"],
        ),
        (
            recognition("\"k_nearest\"", "solver = \"coordinate_descent\""),
            [unused, "linear_svm"],
        ),
        (
            recognition("\"k_nearest\"", "solver_memory_gib = 1.0"),
            [unused, "linear_svm"],
        ),
        (
            recognition("\"rbf_svm\"", "solver = \"coordinate_descent\""),
            ["recognition.solver", "linear_svm"],
        ),
    ] {
        case.file("x.toml", study);
        for command in ["plan", "run"] {
            refused(&case.run(&[command, "x.toml"]), 2, &words);
        }
    }
    // One of the classifiers uses the parameter.
    let all = "[\"linear_svm\", \"polynomial_svm\", \"k_nearest\"]";
    case.file(
        "x.toml",
        recognition(all, "degree = 2\nn_neighbours = 1\nc = 2.0"),
    );
    case.succeeds(&["plan", "x.toml"]);
    assert_eq!(case.names(), ["x.toml"], "nothing is written");
}

#[test]
fn a_number_out_of_range_is_refused_when_the_file_is_read() {
    let case = Case::new();
    let svm = |more: &str| recognition("\"rbf_svm\"", more);
    let usual = svm("");
    let components = usual.replace(
        "[sensing]\n",
        "[sensing]\nensemble = \"principal_components\"\n",
    );
    let signal = |key: &str| usual.replace("[sensing]\n", &format!("[signal]\n{key}\n[sensing]\n"));
    let mut studies = vec![
        (
            svm("gamma = nan"),
            ["x.toml:15, key recognition.gamma", "finite"],
        ),
        (
            svm("gamma = inf"),
            ["x.toml:15, key recognition.gamma", "finite"],
        ),
        (
            svm("gamma = 0"),
            ["x.toml:15, key recognition.gamma: 0", "1e-12 to 1e9"],
        ),
        (
            svm("gamma = -1.0"),
            ["x.toml:15, key recognition.gamma: -1", "1e-12 to 1e9"],
        ),
        (
            svm("c = 1e300"),
            ["x.toml:15, key recognition.c: 1e300", "at most"],
        ),
        (
            signal("smoothing_mm = 1e15"),
            ["x.toml:12, key signal.smoothing_mm: 1e15", "at most 1e7 mm"],
        ),
        (
            signal("noise_std_full_scale = 1e308"),
            ["x.toml:12, key signal.noise", "at most"],
        ),
        (
            usual.replace("stroke_mm = 5.0", "stroke_mm = 1e308"),
            ["x.toml:7, key skin.stroke_mm: 1e308", "at most 1e7 mm"],
        ),
        (
            components.replace("per_object = 8", "per_object = 2"),
            [
                "x.toml:13, key sensing.ratio: 16 principal components",
                "at most 8",
            ],
        ),
        (
            RECONSTRUCTION.replace("solver", "atoms = 1\nsolver"),
            ["key reconstruction.atoms: 1", "at least 2"],
        ),
        (
            RECONSTRUCTION.replace("[objects]", "[objects]\nsurface_error_mm = 1e-9"),
            ["key objects.surface_error_mm", "at least 1e-6 mm"],
        ),
    ];
    let grouped = svm("folds = 4\ngroup_by = \"yaw\"");
    let grouped = grouped.replace("per_object = 8", "yaw_deg = [0, 90, 180]\nper_object = 9");
    studies.push((
        grouped.replace("question", "trials = 4\nquestion"),
        [
            "key recognition.folds: folds: 4",
            "at most 2 with these groups",
        ],
    ));
    for (study, words) in studies {
        case.file("x.toml", study);
        for command in ["plan", "run"] {
            refused(&case.run(&[command, "x.toml"]), 2, &words);
        }
    }
    assert_eq!(case.names(), ["x.toml"], "nothing is written");
}

/// Returns a recognition study with further lines at the end of some tables.
fn with_lines(lines: &[(&str, &str)]) -> String {
    let mut study = recognition("\"linear_svm\"", "[signal]\nsteps = [\"noise\"]\n[axes]");
    for (table, line) in lines {
        study = study.replace(&format!("[{table}]\n"), &format!("[{table}]\n{line}\n"));
    }
    study.replace("[axes]\n\n", "")
}

/// Keys that have an effect only with other keys. Each entry contains refused lines, words of the error, and further lines that make the study valid.
#[test]
fn a_key_that_has_an_effect_only_beside_others_is_refused_without_them() {
    let case = Case::new();
    let noise = ("signal", "noise_std_full_scale = 0.1");
    let drawn = (
        "touches",
        "yaw_deg = { uniform = [0.0, 90.0] }\noffset_x_mm = { uniform = [0.0, 9.0] }",
    );
    let pose = ("recognition", "group_by = \"pose\"");
    let image = ("recognition", "features = \"polar_harmonics\"");
    let force = ("skin", "sensed = \"force\"");
    for (lines, words, beside) in [
        (
            vec![("skin", "stiffness_n_per_m = 50.0")],
            [
                "key skin.stiffness_n_per_m: 50, but no force is read",
                "\"force\" among signal.steps",
            ],
            vec![force],
        ),
        (
            vec![("axes", "\"skin.stiffness_n_per_m\" = [100.0, 200.0]")],
            [
                "200, but no force is read",
                "axes.\"skin.stiffness_n_per_m\"",
            ],
            vec![force],
        ),
        (
            vec![("touches", "speed_mm_per_s = 5.0")],
            [
                "key touches.speed_mm_per_s: 5, but",
                "skin.damping_n_s_per_m above 0",
            ],
            vec![force, ("skin", "damping_n_s_per_m = 0.1")],
        ),
        (
            vec![("recognition", "readings_per_touch = 2")],
            [
                "key recognition.readings_per_touch: 2, but",
                "signal.noise_std_full_scale above 0",
            ],
            vec![noise],
        ),
        (
            vec![("sensing", "ensemble = \"identity\"")],
            ["key sensing.ratio: 4, but", "another sensing.ensemble"],
            vec![("sensing", "")],
        ),
        (
            vec![
                (
                    "recognition",
                    "tilt_augmentation_deg = 3.0\ntilt_augmentation = 0",
                ),
                image,
            ],
            [
                "key recognition.tilt_augmentation_deg: 3, but",
                "tilt_augmentation above 0",
            ],
            vec![],
        ),
        (
            vec![
                ("recognition", "group_by_mm = 3.0"),
                pose,
                ("touches", "yaw_deg = [0.0, 90.0]"),
            ],
            ["key recognition.group_by_mm: 3, but", "uniform"],
            vec![],
        ),
        (
            vec![
                ("recognition", "group_by_deg = 3.0"),
                pose,
                ("touches", "yaw_deg = [0.0, 90.0]"),
            ],
            ["key recognition.group_by_deg: 3, but", "uniform"],
            vec![],
        ),
    ] {
        case.file("x.toml", with_lines(&lines));
        for command in ["plan", "run"] {
            refused(&case.run(&[command, "x.toml"]), 2, &words);
        }
        if !beside.is_empty() {
            let study = with_lines(&[&lines[..], &beside].concat());
            let ensembles = study.replace("\"identity\"", "[\"identity\", \"gaussian\"]");
            case.file("x.toml", ensembles);
            case.succeeds(&["plan", "x.toml"]);
        }
    }
    // The values of one axis decide whether the key has an effect.
    for lines in [
        vec![
            (
                "recognition",
                "tilt_augmentation_deg = 3.0\ntilt_augmentation = [0, 2]",
            ),
            image,
        ],
        vec![
            ("recognition", "group_by_mm = 3.0\ngroup_by_deg = 9.0"),
            pose,
            drawn,
        ],
        vec![
            ("skin", "stiffness_n_per_m = 50.0"),
            ("axes", "\"skin.sensed\" = [\"deflection\", \"force\"]"),
        ],
        vec![
            ("recognition", "readings_per_touch = 2"),
            ("signal", "noise_std_full_scale = [0.0, 0.1]"),
        ],
    ] {
        case.file("x.toml", with_lines(&lines));
        case.succeeds(&["plan", "x.toml"]);
    }
    assert_eq!(case.names(), ["x.toml"], "nothing is written");
}
