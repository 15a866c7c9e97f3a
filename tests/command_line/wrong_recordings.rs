//! Recordings with a fault, in each format of arrays: the error names the file and the array, and nothing is written.

use crate::arrays::{npy, npz};
use crate::command::{Case, filled, says};
use ndarray::{Array1, Array2, ArrayView1};
use std::collections::BTreeMap;

const N: usize = 30;

/// Arrays of a recording by their keys: rows of numbers, or one text for each touch.
type Arrays = BTreeMap<&'static str, Content>;

#[derive(Clone)]
enum Content {
    Numbers(Array2<f64>),
    Texts(Vec<&'static str>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    Npy,
    Npz,
    Csv,
}

fn column(numbers: impl Iterator<Item = f64>) -> Content {
    let numbers: Vec<f64> = numbers.collect();
    Content::Numbers(Array2::from_shape_vec((numbers.len(), 1), numbers).unwrap())
}

fn classes(n: usize) -> impl Iterator<Item = f64> {
    (0..n).map(|touch| (touch * 3 / N) as f64)
}

fn frames(n: usize, n_taxels: usize) -> Array2<f64> {
    Array2::from_shape_fn((n, n_taxels), |(touch, taxel)| {
        (touch * 3 / N) as f64 + ((touch * 7 + taxel * 5) % 11) as f64 / 11.0
    })
}

fn whole() -> Arrays {
    BTreeMap::from([
        ("frames", Content::Numbers(frames(N, 6))),
        ("labels", column(classes(N))),
        ("groups", column((0..N).map(|touch| (touch / 3) as f64))),
    ])
}

/// Returns a recording with a test set, without groups.
fn with_test() -> Arrays {
    let mut arrays = whole();
    arrays.remove("groups");
    arrays.insert("frames_test", Content::Numbers(frames(N, 6)));
    arrays.insert("labels_test", column(classes(N)));
    arrays
}

/// Writes the arrays and a study of them; returns the name of the file of each array.
fn write(case: &Case, format: Format, arrays: &Arrays) -> BTreeMap<&'static str, String> {
    let file = |key: &str, content: &Content| match (format, content) {
        // Texts are tables in every case.
        (Format::Csv, _) | (_, Content::Texts(_)) => format!("{key}.csv"),
        (Format::Npz, _) => "a.npz".to_owned(),
        (Format::Npy, _) => format!("{key}.npy"),
    };
    let archive = npz(|archive| {
        for (key, content) in arrays {
            let name = file(key, content);
            match content {
                Content::Texts(texts) => drop(case.file(&name, texts.join("\n"))),
                Content::Numbers(numbers) if format == Format::Npy => {
                    case.file(&name, npy(numbers));
                }
                Content::Numbers(numbers) if format == Format::Npz => {
                    archive.add_array(*key, numbers).unwrap();
                }
                Content::Numbers(numbers) => {
                    let line =
                        |row: ArrayView1<f64>| row.mapv(|x| x.to_string()).to_vec().join(",");
                    let lines: Vec<String> = numbers.outer_iter().map(line).collect();
                    case.file(&name, lines.join("\n") + "\n");
                }
            }
        }
    });
    case.file("a.npz", archive);
    let files = arrays
        .iter()
        .map(|(key, content)| (*key, file(key, content)));
    let files: BTreeMap<&str, String> = files.collect();
    let keys = files
        .iter()
        .map(|(key, file)| format!("{key} = {file:?}\n"));
    let study = include_str!("../fixtures/texts/wrong_recordings.toml");
    case.file(
        "study.toml",
        filled(study, &[("keys", &keys.collect::<String>())]),
    );
    files
}

/// Asserts that the study is refused with the name of the file of the array `key`, and with these words.
fn is_refused(case: &Case, file: &str, words: &str) {
    let before = case.names();
    says(&case.refuses("run study.toml --out out"), &[file, words]);
    assert_eq!(case.names(), before, "{words}");
}

fn changed(mut arrays: Arrays, key: &'static str, content: Content) -> Arrays {
    arrays.insert(key, content);
    arrays
}

fn with_reading(reading: f64) -> Content {
    let mut own = frames(N, 6);
    own[[3, 2]] = reading;
    Content::Numbers(own)
}

/// Returns the classes, with another number at touch 4.
fn with_number(number: f64) -> Content {
    let classes = classes(N).enumerate();
    column(classes.map(|(touch, class)| if touch == 4 { number } else { class }))
}

fn texts(last: &'static str) -> Content {
    Content::Texts((0..N).map(|touch| ["a", "b", last][touch / 10]).collect())
}

#[test]
fn each_fault_of_a_recording_is_refused_in_each_format() {
    let mut faults = Vec::new();
    let mut fault = |base: Arrays, key, content: Content, words: &str| {
        faults.push((changed(base, key, content), key, words.to_owned()));
    };
    for (key, what) in [("labels", "class"), ("groups", "group")] {
        let few = "29 values; 30, one a touch of ";
        fault(whole(), key, column(classes(N - 1)), few);
        for number in [f64::NAN, 0.5] {
            let words = format!("position 4: {number}; one {what} for each touch");
            fault(whole(), key, with_number(number), &words);
        }
    }
    for reading in [f64::NAN, f64::INFINITY] {
        let words = format!("frame 3, taxel 2: {reading}; a finite number");
        fault(whole(), "frames", with_reading(reading), &words);
    }
    let nan = Content::Numbers(frames(N, 6) * f64::NAN);
    fault(whole(), "frames", nan, "no taxel with readings");
    let few = column(classes(20));
    fault(
        with_test(),
        "labels_test",
        few,
        "20 values; 30, one a touch of ",
    );
    let forms = "numbers in one array of labels and texts in the other";
    fault(with_test(), "labels_test", texts("c"), forms);
    let shapes = "touches of 1 frame of 1 × 5 taxels; touches of 1 frame of 1 × 6 taxels";
    let narrow = Content::Numbers(frames(N, 5));
    fault(with_test(), "frames_test", narrow, shapes);
    // Classes of which no touch trains are a fault of the study.
    let shifted = column(classes(N).map(|class| class + 1.0));
    let both = changed(with_test(), "labels", texts("c"));
    for (base, content, class) in [(with_test(), shifted, "class 3"), (both, texts("d"), "d")] {
        let arrays = changed(base, "labels_test", content);
        let words = format!(
            "key recorded.labels_test: {class}, of which no touch trains; classes of recorded.labels"
        );
        faults.push((arrays, "study", words));
    }
    for format in [Format::Npy, Format::Npz, Format::Csv] {
        let case = Case::new();
        write(&case, format, &whole());
        case.succeeds("run study.toml --out good --quiet");
        write(&case, format, &with_test());
        case.succeeds("run study.toml --out test --quiet");
        for (arrays, key, words) in &faults {
            let files = write(&case, format, arrays);
            let file = files.get(key).map_or("study.toml", String::as_str);
            is_refused(&case, file, words);
            // In an archive, the error names the array.
            if file == "a.npz" {
                is_refused(&case, &format!("a.npz, array `{key}`"), words);
            }
        }
    }
}

#[test]
fn truncated_and_empty_files_are_refused_by_their_name() {
    for format in [Format::Npy, Format::Npz, Format::Csv] {
        let case = Case::new();
        let files = write(&case, format, &whole());
        for file in files.values() {
            let bytes = case.bytes(file);
            let empty = match format {
                Format::Csv => "an empty file",
                _ => "begins neither as a .npy nor as a .npz file",
            };
            // Half of a table of one column is a whole table of fewer touches.
            for (length, words) in [(bytes.len() / 2, ""), (0, empty)] {
                case.file(file, &bytes[..length]);
                is_refused(&case, file, words);
            }
            case.file(file, &bytes);
        }
    }
    let case = Case::new();
    write(&case, Format::Npz, &whole());
    let archive = npz(|archive| {
        archive.add_array("frame", &frames(N, 6)).unwrap();
        archive.add_array("label", &frames(N, 1)).unwrap();
    });
    case.file("a.npz", archive);
    is_refused(&case, "a.npz", "frame, label");
    // Without labels, the key is named.
    let mut arrays = whole();
    arrays.remove("labels");
    for format in [Format::Npy, Format::Npz, Format::Csv] {
        write(&case, format, &arrays);
        let words = "key recorded.labels: no such key; labels = \"FILE\"";
        is_refused(&case, "study.toml", words);
    }
    case.file("labels.npy", npy(&Array1::<i64>::zeros(N)));
    let text = case.read("study.toml");
    for (n, words) in [(2, "duplicate key"), (1, "key recorded.labels: 1 class;")] {
        let labels = "labels = \"labels.npy\"\n".repeat(n);
        let recorded = format!("[recorded]\n{labels}");
        case.file("study.toml", text.replace("[recorded]\n", &recorded));
        is_refused(&case, "study.toml", words);
    }
}

#[test]
fn classes_in_two_forms_of_unicode_and_columns_that_may_be_no_taxels_are_noted() {
    let case = Case::new();
    let line = |touch: usize| {
        let [first, second] = [7, 5].map(|k| (touch * k % 11) as f64 / 11.0 + 0.01);
        format!(
            "{}.5,{first},{second},{}\n",
            10 + touch * touch,
            touch * 2 % 3
        )
    };
    case.file("frames.csv", (0..N).map(line).collect::<String>());
    let word = |touch: usize| ["caf\u{e9}\n", "cafe\u{301}\n", "pen\n"][touch % 3];
    case.file("labels.csv", (0..N).map(word).collect::<String>());
    let group = |touch: usize| ["s7\n", "S7\n", "8\n", "08\n", "9\n"][touch % 5];
    case.file("groups.csv", (0..N).map(group).collect::<String>());
    let audit = "audit frames.csv --labels labels.csv --groups groups.csv";
    let (_, said) = case.succeeds(&audit);
    let spellings = "note: the labels \"cafe\\u{301}\", \"café\" differ only by case, spaces, leading zeros or forms of Unicode, and count as 2 labels";
    let groups = "note: the groups \"08\", \"8\" differ only by case, spaces, leading zeros";
    let few = "note: frames.csv: column 4 has few whole numbers and counts as a taxel; remove it if it is the class of each row";
    let time = "note: frames.csv: column 1 ascends from row to row and counts as a taxel; remove it if it is the time of each row";
    says(&said, &[spellings, groups, few, time]);
}

#[test]
fn a_missing_label_is_no_class() {
    let case = Case::new();
    let line = |touch: usize| format!("{},{}\n", touch % 7, touch % 5);
    case.file("frames.csv", (0..N).map(line).collect::<String>());
    for missing in ["nan", "\"\"", "NaN"] {
        let word = |touch: usize| match touch % 10 {
            3 => missing.to_owned() + "\n",
            k => ["mug\n", "pen\n"][k % 2].to_owned(),
        };
        case.file("labels.csv", (0..N).map(word).collect::<String>());
        let said = case.refuses("audit frames.csv --labels labels.csv");
        let given = format!(
            "labels.csv, position 3: \"{}\"; one class for each touch",
            missing.trim_matches('"')
        );
        says(&said, &[given]);
    }
}
