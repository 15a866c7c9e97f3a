//! The commands that make a folder's page again from its tables, and compare two folders on a page.

use crate::command::{Case, says};
use std::fs;
use std::path::Path;

/// Study that takes a second.
const STUDY: &str = include_str!("../fixtures/texts/report.toml");

#[test]
fn touches_beyond_the_stroke_and_listed_values_that_are_mixed_are_said_once() {
    let case = Case::new();
    let listed = STUDY.replace(
        "depth_mm = 3.0",
        "depth_mm = [1, 2, 3, 30]\nyaw_deg = [0.0]",
    );
    case.file(
        "listed.toml",
        listed.replace(
            "per_object = 16\noffset_x_mm = { uniform = [-8.0, 8.0] }\n",
            "offset_x_mm = { grid = [-8.0, 8.0, 4] }\n",
        ),
    );
    let note = "note: each configuration mixes touches of depth_mm = [1.0, 2.0, 3.0, 30.0]: a list in [touches] is spread over";
    let (plan, _) = case.succeeds(&["plan", "listed.toml"]);
    assert_eq!(plan.matches(note).count(), 1, "{plan}");
    let (_, said) = case.succeeds(&["run", "listed.toml", "--out", "listed"]);
    assert_eq!(said.matches(note).count(), 1, "{said}");
    let limits = fs::read_to_string(case.path("listed/limits.csv")).unwrap();
    says(&limits, &["touches that met nothing,0,48,"]);
    says(&limits, &["touches deeper than the stroke,12,48,"]);
    let page = fs::read_to_string(case.path("listed/report.html")).unwrap();
    assert!(page.contains("12 of 48 touches deeper than the stroke"));
    // Nothing is printed about a study that has neither.
    case.file("asked.toml", STUDY);
    let (plan, _) = case.succeeds(&["plan", "asked.toml"]);
    let (_, said) = case.succeeds(&["run", "asked.toml", "--out", "asked"]);
    let limits = fs::read_to_string(case.path("asked/limits.csv")).unwrap();
    assert!(!plan.contains("mixes") && !said.contains("mixes") && !limits.contains("deeper"));
}

/// Returns a page without the line on the duration of the run, because a manifest contains whole seconds.
fn but_for_seconds(page: &str) -> String {
    let lines = page.lines().filter(|line| !line.contains("The run took"));
    lines.collect::<Vec<_>>().join("\n")
}

/// Returns the chart files in a folder, sorted.
fn chart_files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names
        .filter(|name| name.starts_with("accuracy_by"))
        .collect();
    names.sort();
    names
}

#[test]
fn charts_are_svg_files_unless_another_format_is_given() {
    let case = Case::new();
    case.file("asked.toml", STUDY);
    case.succeeds(&["run", "asked.toml", "--out", "svg"]);
    case.succeeds(&["run", "asked.toml", "--out", "png", "--chart-format", "png"]);
    let [svg, png] = ["svg", "png"].map(|name| chart_files(&case.path(name)));
    assert!(!svg.is_empty() && svg.iter().all(|name| name.ends_with(".svg")));
    let as_svg: Vec<String> = png
        .iter()
        .map(|name| name.replace(".png", ".svg"))
        .collect();
    assert_eq!(as_svg, svg);
    // Pictures of touches are always PNG files.
    assert!(case.path("svg/snapshots.png").exists());
    case.succeeds(&["report", "svg", "--chart-format", "both"]);
    assert_eq!(chart_files(&case.path("svg")).len(), 2 * svg.len());
    case.succeeds(&["verify", "svg", "--configurations", "1"]);
    // A missing chart causes a note, because it is not a result; an edited chart is an error.
    fs::remove_file(case.path("png").join(&png[0])).unwrap();
    let (said, _) = case.succeeds(&["verify", "png", "--configurations", "1"]);
    let note = "missing charts, pictures or page: 1 files; bubbletouch report png draws them";
    assert!(said.contains(note), "{said}");
    case.file(&format!("svg/{}", svg[0]), "<svg/>");
    case.refuses(&["verify", "svg", "--configurations", "1"]);
    let refused = case.run(&["run", "asked.toml", "--out", "new", "--chart-format", "pdf"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).unwrap();
    says(&said, &["`svg`, `png`, `both`"]);
    // A shard draws no charts.
    let shard = ["run", "asked.toml", "--shard", "1/2", "--out", "new"];
    case.refuses(&[&shard[..], &["--chart-format", "png"]].concat());
    assert!(!case.path("new").exists());
}

#[test]
fn confusion_matrices_of_the_best_cells_alone_leave_the_other_tables_as_they_are() {
    let case = Case::new();
    let fused = STUDY.replace(
        "classifier =",
        "touches_per_decision = [1, 4]\nclassifier =",
    );
    // With this noise, objects are confused, and the confusions have a chart.
    let fused = fused.replace("full_scale = 0.05", "full_scale = 0.5");
    case.file("all.toml", &fused);
    case.file(
        "best.toml",
        format!("{fused}\n[report]\nconfusion = \"best\"\n"),
    );
    for name in ["all", "best"] {
        case.succeeds(&["run", &format!("{name}.toml"), "--out", name]);
    }
    let read = |folder: &str, name: &str| fs::read_to_string(case.path(folder).join(name)).unwrap();
    for name in [
        "accuracy.csv",
        "summary.csv",
        "confused.csv",
        "comparison.csv",
    ] {
        assert_eq!(read("all", name), read("best", name), "{name}");
    }
    let (all, best) = (read("all", "confusion.csv"), read("best", "confusion.csv"));
    let cells = |text: &str| -> Vec<String> {
        let cells = text.lines().skip(1);
        let mut cells: Vec<String> = cells
            .map(|line| line.split(',').next().unwrap().to_owned())
            .collect();
        cells.dedup();
        cells
    };
    let kept = cells(&best);
    assert!(
        !kept.is_empty() && kept.len() <= 3 && cells(&all).len() == 8,
        "{kept:?}"
    );
    let of_kept = |line: &&str| {
        kept.iter()
            .any(|cell| line.starts_with(&format!("{cell},")))
    };
    let expected: Vec<&str> = all.lines().skip(1).filter(of_kept).collect();
    assert_eq!(best.lines().skip(1).collect::<Vec<_>>(), expected);
    // The chart shows the same matrix, and the line at chance level is drawn.
    let tiles = |folder: &str| {
        let svg = read(folder, "confusion.svg");
        // The caption below the tiles counts the rows of other configurations.
        svg.split_once("Rows: touched").unwrap().0.to_owned()
    };
    assert_eq!(tiles("all"), tiles("best"));
    let chart = &chart_files(&case.path("best"))[0];
    assert!(read("best", chart).contains("chance (1 in 3)"));
    assert_eq!(read("best", chart), read("all", chart));
    case.succeeds(&["report", "best"]);
    case.succeeds(&["verify", "best", "--configurations", "2"]);
    case.succeeds(&["verify", "best", "--configurations", "1000"]);
    case.succeeds(&["advise", "best", "--accuracy", "0.1"]);
    // If the number of objects is an axis, the matrices of all configurations are needed.
    let axes = "[axes]\n\"objects.names\" = [[\"mug\", \"banana\"], [\"mug\", \"banana\", \"scissors\"]]\n";
    let text = format!("{fused}\n[report]\nconfusion = \"best\"\n{axes}");
    case.file(
        "sizes.toml",
        text.replace("names = [\"mug\", \"banana\", \"scissors\"]\n", ""),
    );
    for command in [
        &["plan", "sizes.toml"][..],
        &["run", "sizes.toml", "--out", "sizes"],
    ] {
        let said = case.refuses(command);
        says(&said, &["confusion", "differ"]);
    }
    assert!(!case.path("sizes").exists());
}

/// The columns of groups and of repeated splits exist if any row has them; the rows of a few work items may lack them.
#[test]
fn verify_takes_a_few_work_items_of_a_study_with_groups_and_repeated_splits() {
    let case = Case::new();
    let text = STUDY.replace("trials = 2", "trials = 4").replace(
        "depth_mm = 3.0",
        "depth_mm = 3.0\nyaw_deg = [0.0, 30.0, 60.0, 90.0]",
    );
    let axes = "[axes]\n\"recognition.split\" = [\"random\", \"half_of_yaws\"]\n";
    case.file("splits.toml", text + axes);
    case.succeeds(&["run", "splits.toml", "--out", "found"]);
    let accuracy = fs::read_to_string(case.path("found/accuracy.csv")).unwrap();
    let header = accuracy.lines().next().unwrap();
    assert!(header.contains("distinct_split") && header.contains("n_groups"));
    for draw in 0..8 {
        let draw = draw.to_string();
        case.succeeds(&["verify", "found", "--configurations", "1", "--draw", &draw]);
    }
    // A differing row is also found in a table with fewer columns. The manifest is edited with the table, so that its hash is valid.
    let n_correct = header.split(',').position(|name| name == "n_correct");
    let edited: Vec<String> = accuracy
        .lines()
        .enumerate()
        .map(|(number, line)| {
            let mut fields: Vec<&str> = line.split(',').collect();
            if number > 0 {
                fields[n_correct.unwrap()] = "1";
            }
            fields.join(",")
        })
        .collect();
    let edited = edited.join("\n") + "\n";
    let manifest = fs::read_to_string(case.path("found/manifest.json")).unwrap();
    let hash = |text: &str| bubbletouch::study::sha256(text.as_bytes());
    let manifest = manifest.replace(&hash(&accuracy), &hash(&edited));
    case.file("found/manifest.json", manifest);
    case.file("found/accuracy.csv", edited);
    for draw in 0..8 {
        let draw = draw.to_string();
        let said = case.refuses(&["verify", "found", "--configurations", "1", "--draw", &draw]);
        says(&said, &["found/accuracy.csv:"]);
    }
}

#[test]
fn the_page_comes_again_from_the_tables() {
    let case = Case::new();
    case.file("asked.toml", STUDY);
    case.succeeds(&["run", "asked.toml", "--out", "found"]);
    let file = case.path("found/report.html");
    let written = fs::read_to_string(&file).unwrap();
    for part in [
        "What does the page say?",
        "<h1>asked</h1>",
        "bubbletouch run asked.toml",
        "<section id=\"limits\"",
        "alt=\"One touch each on",
        "SHA-256 of study.toml",
    ] {
        assert!(written.contains(part), "the page has {part}");
    }
    fs::remove_file(&file).unwrap();
    let (said, remarks) = case.succeeds(&["report", "found"]);
    assert_eq!((&said[..], &remarks[..]), ("Wrote found/report.html\n", ""));
    let again = fs::read_to_string(&file).unwrap();
    assert_eq!(but_for_seconds(&again), but_for_seconds(&written));
    // Without a manifest, the command prints that the origin of the tables is unknown.
    fs::remove_file(case.path("found/manifest.json")).unwrap();
    let (_, remarks) = case.succeeds(&["report", "found"]);
    says(&remarks, &["there is no found/manifest.json"]);
    let page = fs::read_to_string(&file).unwrap();
    says(&page, &["<h1>found</h1>"]);
    // The error names a missing table.
    for name in ["limits.csv", "summary.csv"] {
        fs::remove_file(case.path("found").join(name)).unwrap();
        let said = case.refuses(&["report", "found"]);
        says(&said, &[&format!("found/{name}: is missing")]);
    }
}

#[test]
fn the_page_is_not_drawn_over_from_tables_that_were_changed_or_are_gone() {
    let case = Case::new();
    case.file("asked.toml", STUDY);
    case.succeeds(&["run", "asked.toml", "--out", "found"]);
    let page = fs::read_to_string(case.path("found/report.html")).unwrap();
    for name in [
        "summary.csv",
        "accuracy.csv",
        "pareto.csv",
        "timing.csv",
        "limits.csv",
        "failures.csv",
        "study.toml",
    ] {
        let path = case.path("found").join(name);
        let content = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = content.lines().collect();
        let cut = lines[..lines.len() / 2].join("\n");
        let edited = format!("{content} ");
        for damaged in [Some(cut), Some(edited), None] {
            let said = match &damaged {
                Some(text) => {
                    fs::write(&path, text).unwrap();
                    "was changed after its run"
                }
                None => {
                    fs::remove_file(&path).unwrap();
                    "is missing"
                }
            };
            for command in ["report", "verify"] {
                let output = case.run(&[command, "found"]);
                let error = String::from_utf8(output.stderr).unwrap();
                let is_named = error.contains(name) && error.contains(said);
                // Without its study, the kind of a folder is unknown to `verify`; the folder is still refused.
                assert!(is_named, "{command}, {name}: {error}");
                assert_eq!(output.status.code(), Some(2), "{command}, {name}: {error}");
            }
            let again = fs::read_to_string(case.path("found/report.html")).unwrap();
            assert!(again == page, "{name}");
        }
        fs::write(&path, content).unwrap();
    }
    case.succeeds(&["report", "found"]);
}

#[test]
fn a_run_removes_the_results_that_it_no_longer_makes() {
    let case = Case::new();
    let swept = STUDY.replace("= 0.05", "= [0.0, 0.05, 0.4, 1.0]");
    let run = |folder: &str, text: &str| {
        case.file("edited.toml", text);
        case.succeeds(&["run", "edited.toml", "--out", folder]);
    };
    run("found", &swept);
    run("kept", &swept);
    let robustness = case.path("kept/robustness.csv");
    let changed = fs::read_to_string(&robustness).unwrap() + "a note of the user\n";
    fs::write(&robustness, &changed).unwrap();
    let made = chart_files(&case.path("found"));
    run("found", STUDY);
    run("kept", STUDY);
    run("fresh", STUDY);
    // No table and no chart of the first version is left, and no command reads the table that the user changed.
    assert!(!case.path("found/robustness.csv").exists());
    let left = chart_files(&case.path("found"));
    assert!(left != made && left == chart_files(&case.path("fresh")));
    assert_eq!(fs::read_to_string(&robustness).unwrap(), changed);
    for folder in ["found", "kept"] {
        case.succeeds(&["verify", folder]);
        case.succeeds(&["report", folder]);
        let page = fs::read_to_string(case.path(folder).join("report.html")).unwrap();
        assert!(!page.contains("half-way at"), "{folder}");
        let (said, _) = case.succeeds(&["compare", folder, "fresh"]);
        assert!(!said.contains("robustness.csv"), "{said}");
    }
    // A command does not replace the file of the user.
    case.file("edited.toml", &swept);
    case.refuses(&["run", "edited.toml", "--out", "kept"]);
    assert_eq!(fs::read_to_string(&robustness).unwrap(), changed);
}

#[test]
fn objects_that_changed_after_the_run_are_refused() {
    let case = Case::new();
    let tetrahedron = |size: f64| {
        format!(
            "v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        )
    };
    fs::create_dir(case.path("meshes")).unwrap();
    case.file("meshes/large.obj", tetrahedron(0.06));
    case.file("meshes/small.obj", tetrahedron(0.03));
    let sets = "sets = [\"household\"]\nnames = [\"mug\", \"banana\", \"scissors\"]";
    case.file("meshes.toml", STUDY.replace(sets, "meshes = \"meshes\""));
    case.succeeds(&["run", "meshes.toml", "--out", "found"]);
    case.succeeds(&["verify", "found"]);
    let page = fs::read(case.path("found/report.html")).unwrap();
    let refused = |wanted: &str| {
        for command in ["verify", "report"] {
            let output = case.run(&[command, "found"]);
            let said = String::from_utf8(output.stderr).unwrap();
            assert!(
                output.status.code() == Some(2) && said.contains(wanted),
                "{said}"
            );
        }
        assert!(fs::read(case.path("found/report.html")).unwrap() == page);
    };
    case.file("meshes/small.obj", tetrahedron(0.031));
    refused("found: object small: was changed after the run");
    // The file is compared with the run of another version of the program, too.
    let manifest = fs::read_to_string(case.path("found/manifest.json")).unwrap();
    let source = manifest.lines().find(|line| line.contains("\"source\": "));
    let other = manifest.replace(source.unwrap(), "  \"source\": \"other\",");
    fs::write(case.path("found/manifest.json"), &other).unwrap();
    refused("found: object small: was changed after the run");
    fs::write(case.path("found/manifest.json"), manifest).unwrap();
    case.file("meshes/small.obj", tetrahedron(0.03));
    case.file("meshes/third.obj", tetrahedron(0.05));
    refused("found: object third: is not in the run");
    fs::remove_file(case.path("meshes/third.obj")).unwrap();
    case.succeeds(&["report", "found"]);
}

#[test]
fn built_in_objects_that_another_version_described_otherwise_are_named() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.succeeds(&["run", "study.toml", "--out", "found"]);
    let path = case.path("found/manifest.json");
    let mut manifest: serde_json::Value =
        serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let write = |manifest: &serde_json::Value| fs::write(&path, manifest.to_string()).unwrap();
    manifest["source"] = "other".into();
    write(&manifest);
    let words =
        "note: found: built-in objects that this version describes otherwise than the run: ";
    let (_, said) = case.succeeds(&["verify", "found"]);
    assert!(!said.contains(words), "{said}");
    manifest["objects_sha256"]["mug"] = "0".into();
    manifest["objects_sha256"]
        .as_object_mut()
        .unwrap()
        .remove("banana");
    write(&manifest);
    for command in ["verify", "report"] {
        let (_, said) = case.succeeds(&[command, "found"]);
        assert!(said.contains(&format!("{words}banana, mug\n")), "{said}");
    }
}

#[test]
fn noise_in_mm_is_not_noise_in_full_scale() {
    let case = Case::new();
    let study = include_str!("../fixtures/kinds/reconstruction.toml");
    for (name, key) in [("share", "noise_std_full_scale"), ("mm", "noise_std_mm")] {
        let file = format!("{name}.toml");
        case.file(&file, study.replace("noise_std_full_scale", key));
        case.succeeds(&["run", &file, "--out", name]);
    }
    let (said, _) = case.succeeds(&["compare", "share", "mm"]);
    let said = said.replace('\n', " ");
    says(&said, &["reconstruction.csv: 0 rows are in both runs"]);
    let (said, _) = case.succeeds(&["compare", "mm", "mm"]);
    assert!(!said.contains("0 rows are in both runs"), "{said}");
}

#[test]
fn with_too_few_trials_there_is_no_p_value_and_with_enough_there_is() {
    let case = Case::new();
    for (name, trials, status) in [("few", 2, "too_few_trials"), ("many", 4, "tested")] {
        let study = STUDY.replace("trials = 2", &format!("trials = {trials}"));
        case.file(&format!("{name}.toml"), &study);
        case.succeeds(&["run", &format!("{name}.toml"), "--out", name]);
        let mut table = csv::Reader::from_path(case.path(name).join("comparison.csv")).unwrap();
        let heads = table.headers().unwrap().clone();
        let place = |column: &str| heads.iter().position(|head| head == column).unwrap();
        let (p, p_status) = (place("p_value"), place("p_status"));
        let needed = place("n_trials_needed");
        for row in table.records() {
            let row = row.unwrap();
            assert_eq!((&row[p_status], &row[needed]), (status, "4"));
            assert_eq!(row[p].is_empty(), status == "too_few_trials", "{row:?}");
        }
    }
    case.file(
        "other.toml",
        STUDY.replace("uniform = [-8.0, 8.0]", "uniform = [-9.0, 9.0]"),
    );
    case.succeeds(&["run", "other.toml", "--out", "other"]);
    let (said, _) = case.succeeds(&["compare", "few", "other"]);
    assert!(said.contains("not tested: 4 trials are needed"), "{said}");
    assert!(!said.contains("One trial"), "{said}");
}

#[test]
fn two_folders_stand_side_by_side_in_a_page() {
    let case = Case::new();
    case.file("asked.toml", STUDY);
    case.file("noisy.toml", STUDY.replace("0.05", "0.4"));
    for name in ["asked", "noisy"] {
        let study = format!("{name}.toml");
        case.succeeds(&["run", &study, "--out", name]);
    }
    case.file("same.toml", STUDY);
    case.succeeds(&["run", "same.toml", "--out", "same"]);
    case.succeeds(&["compare", "asked", "same", "--html", "moved.html"]);
    let page = fs::read_to_string(case.path("moved.html")).unwrap();
    for part in [
        "accuracy.csv: 4 settings are in both runs",
        "accuracy: 4 the same",
        "Accuracy in both runs",
        "p (Holm)",
        "First: asked; second: same.",
    ] {
        assert!(page.contains(part), "the page has {part}");
    }
    // Values and costs of both folders.
    assert!(page.matches("<tr").count() > 2 * (1 + 4));
    case.refuses(&["compare", "asked", "same", "--html", "moved.txt"]);
    let apart = case.run(&["compare", "asked", "noisy", "--html", "apart.html"]);
    assert_eq!(apart.status.code(), Some(2), "no cell has the same noise");
    assert!(!case.path("apart.html").exists());
}

/// Edited outcomes and numbers are reported, and no row is dropped because it has no number.
#[test]
fn results_of_stability_that_are_edited_differ_from_what_they_were() {
    let case = Case::new();
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/stability");
    if !results.exists() {
        return;
    }
    for folder in ["kept", "edited"] {
        fs::create_dir(case.path(folder)).unwrap();
        for name in [
            "study.toml",
            "stability.csv",
            "stability_summary.csv",
            "timing.csv",
            "joints.csv",
            "peers.csv",
        ] {
            fs::copy(results.join(name), case.path(folder).join(name)).unwrap();
        }
    }
    let path = case.path("edited").join("stability.csv");
    let text = fs::read_to_string(&path).unwrap();
    let mut n_edited = 0;
    let lines = text
        .lines()
        .map(|line| match line.contains(",right,") && n_edited < 226 {
            true => {
                n_edited += 1;
                line.replace(",right,", ",not_finite,")
            }
            false => line.to_owned(),
        });
    fs::write(&path, lines.collect::<Vec<_>>().join("\n") + "\n").unwrap();
    let compared = |second: &str| {
        let (said, _) = case.succeeds(&["compare", "kept", second]);
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let said = compared("kept");
    assert!(said.contains("stability.csv: 1505 settings are in both runs, 0 in the first alone"));
    assert!(!said.contains("changed"), "{said}");
    let said = compared("edited");
    let changed =
        "stability.csv: outcome: 1279 the same, 226 changed (226 from right to not finite).";
    assert!(said.contains(changed), "{said}");
    // A number of one row is deleted.
    let text = fs::read_to_string(&path).unwrap();
    let number = "9.725768772680234e-15";
    assert!(text.contains(number));
    fs::write(&path, text.replacen(number, "", 1)).unwrap();
    let said = compared("edited");
    let lost = "force imbalance: 1 row has a number in the first run alone, 0 in the second alone.";
    assert!(said.contains(lost), "{said}");
}
