//! Tables of recorded frames as pandas, spreadsheets and loggers write them: each reader finds the same readings, or refuses the table with one sentence.

use super::{LABELS, SKIN, has_errors, of_file};
use crate::command::{Case, contains, filled, says};
use bubbletouch::Result;
use bubbletouch::audit::{AuditData, AuditFiles};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::TrialScore;
use bubbletouch::study::{RecordedSkinFiles, RecordedSpec, UntouchedFrames};
use ndarray::{Array1, Array2, Array3, s};
use ndarray_npy::NpzWriter;
use serde::Deserialize;
use std::fmt::Display;
use std::fs::File;
use std::ops::Range;

const N: usize = 30;
const TAXELS: usize = 4;

/// Returns the readings of all touches, shape (30, 4); the third taxel reads 0 and 1 only.
fn expected() -> Array2<f64> {
    Array2::from_shape_fn((N, TAXELS), |(touch, taxel)| {
        let noise = |k: usize| ((touch * touch * 31 + k * 17 * (touch + 1)) % 97) as f64 / 97.0;
        let class = label(touch) as f64;
        match taxel {
            0 => class + noise(1),
            1 => 2.5 - class - noise(2),
            2 => (touch % 2) as f64,
            _ => 0.25 + noise(3),
        }
    })
}

fn label(touch: usize) -> usize {
    touch * 7 % 3
}

/// Tables of the file `recorded_tables.toml`.
#[derive(Deserialize)]
struct Layouts {
    frames: Vec<TableLayout>,
    labels: Vec<TableLayout>,
}

#[derive(Deserialize)]
struct TableLayout {
    what: String,
    header: String,
    line: String,
}

fn layouts() -> Layouts {
    toml::from_str(include_str!("../../fixtures/texts/recorded_tables.toml")).unwrap()
}

/// Returns the lines of a table: the header, unless it is empty, and a line for each touch.
fn table(header: &str, line: &str) -> String {
    let mut text = match header {
        "" => String::new(),
        header => format!("{header}\n"),
    };
    for (touch, readings) in expected().outer_iter().enumerate() {
        let cells = super::line(readings).trim_end().to_owned();
        let (first, others) = cells.split_once(',').unwrap();
        let unequal = match touch {
            0..12 => touch % 4,
            _ => (touch - 12) % 6,
        };
        let values: [(&str, &dyn Display); 16] = [
            ("cells", &cells),
            ("first", &first),
            ("others", &others),
            ("touch", &touch),
            ("from_1", &(touch + 1)),
            ("from_70", &(touch + 70)),
            ("chosen", &(3 * touch + 5)),
            ("uneven", &(3 * touch + touch % 2)),
            ("shuffled", &(touch * 7 % N)),
            ("reversed", &(N - 1 - touch)),
            ("again", &(touch % 5)),
            ("fourth", &(touch % 4)),
            ("unequal", &unequal),
            ("label", &label(touch)),
            ("one_hot", &["1,0,0", "0,1,0", "0,0,1"][label(touch)]),
            ("word", &["cup", "ball", "pen"][label(touch)]),
        ];
        text += &filled(line, &values);
        text.push('\n');
    }
    text
}

/// Reads a table as an audit does, with keys of `[recorded]`.
fn audited_with(case: &Case, name: &str, given: RecordedSpec) -> Result<AuditData> {
    let files = AuditFiles {
        data: case.path(name),
        given,
        ..AuditFiles::default()
    };
    files.read()
}

fn audited(case: &Case, name: &str, columns: Option<&str>) -> Result<AuditData> {
    let columns = columns.map(str::to_owned);
    let given = RecordedSpec {
        columns,
        ..RecordedSpec::default()
    };
    audited_with(case, name, given)
}

fn calibrated(case: &Case, name: &str, columns: Option<&str>) -> Result<Array2<f64>> {
    let files = skin_files(case, name, columns);
    files.read().map(|skin| skin.0.touched)
}

fn skin_files(case: &Case, name: &str, columns: Option<&str>) -> RecordedSkinFiles {
    RecordedSkinFiles {
        frames: case.path(name),
        order: None,
        columns: columns.map(str::to_owned),
        grid: Some([1, TAXELS]),
        untouched: UntouchedFrames::None,
        forces: None,
        zero: Some(0.0),
        full_scale: Some(1.0),
        stroke_mm: None,
    }
}

fn studied(case: &Case, keys: &str) -> Result<Vec<TrialScore>> {
    let skin = SKIN.replace("5.0", "1.0");
    let rest = format!("{skin}[recognition]\nclassifier = \"linear_svm\"\n");
    let rows = case.recorded(keys, &rest)?.run(&Silent).unwrap().accuracy;
    Ok(rows.into_iter().map(|(_, score)| score).collect())
}

fn with_labels() -> Case {
    let case = Case::new();
    case.write_integers("labels.npy", (0..N).map(label));
    case.file("plain.csv", table("", "{cells}"));
    case
}

#[test]
fn every_reader_finds_the_readings_of_tables_of_pandas_and_of_loggers() {
    let case = with_labels();
    let usual = studied(&case, &of_file("plain.csv")).unwrap();
    assert!(has_errors(&usual));
    for TableLayout { what, header, line } in layouts().frames {
        let text = table(&header, &line);
        for (separator, name) in [(",", "it.csv"), (";", "it.txt"), ("\t", "it.tsv")] {
            case.file(name, text.replace(',', separator));
            let data = audited(&case, name, None).unwrap_or_else(|error| panic!("{what}: {error}"));
            assert_eq!(data.frames, expected(), "{what}");
            assert_eq!(calibrated(&case, name, None).unwrap(), expected(), "{what}");
        }
        let found = studied(&case, &of_file("it.csv")).unwrap();
        assert_eq!(found, usual, "{what}");
    }
    // Whole readings: consecutive numbers in any order are an index, other distinct numbers are readings.
    let whole = |index: fn(usize) -> usize| {
        let line = |touch: usize| format!("{},{},7\n", index(touch), touch * touch % 11);
        case.file("whole.csv", (0..N).map(line).collect::<String>());
        audited(&case, "whole.csv", None).unwrap().frames.ncols()
    };
    assert_eq!(whole(|touch| 5 + touch * 7 % N), 2);
    assert_eq!(whole(|touch| 5 + touch * 14 % (2 * N)), 3);
    // What was left out is noted once by each command.
    case.file("indexed.csv", table(",0,1,2,3", "{touch},{cells},"));
    for command in [
        "calibrate indexed.csv --grid 2,2",
        "audit indexed.csv --labels labels.npy --permutations 399",
    ] {
        let (_, notes) = case.succeeds(command);
        for words in [
            "note: indexed.csv: column 1 has no name; it is left out\n",
            "note: indexed.csv: the lines end with a separator",
        ] {
            assert_eq!(notes.matches(words).count(), 1, "{notes}");
        }
    }
}

#[test]
fn a_named_last_column_without_readings_is_a_taxel() {
    let case = Case::with("named.csv", table("s0,s1,s2,s3,s4", "{cells},"));
    let data = audited(&case, "named.csv", None).unwrap();
    assert_eq!(data.frames.ncols(), TAXELS + 1);
    let last = data.frames.column(TAXELS);
    assert!(last.iter().all(|reading| reading.is_nan()));
}

#[test]
fn labels_of_pandas_are_the_same_classes_and_a_number_for_each_touch_is_no_index() {
    let case = with_labels();
    let read = |labels: &str, groups: Option<&str>| {
        let given = RecordedSpec {
            labels: case.path(labels),
            groups: groups.map(|groups| case.path(groups)),
            ..RecordedSpec::default()
        };
        audited_with(&case, "plain.csv", given)
    };
    let expected: Vec<usize> = (0..N).map(label).collect();
    for TableLayout { what, header, line } in layouts().labels {
        case.file("it.csv", table(&header, &line));
        let data = read("it.csv", None).unwrap_or_else(|error| panic!("{what}: {error}"));
        let labels = data.labels.unwrap();
        match line.contains("{word}") {
            false => assert_eq!(labels, expected, "{what}"),
            true => {
                let name = |touch: usize| ["cup", "ball", "pen"][expected[touch]];
                let is_named = |touch: usize| data.classes[labels[touch]] == name(touch);
                assert!((0..N).all(is_named), "{what}");
            }
        }
    }
    case.file("touches.csv", table("", "{touch}"));
    let groups = read("labels.npy", Some("touches.csv")).unwrap().groups;
    assert_eq!(groups, Some((0..N).collect()));
    // A wrong number of labels is not made right by a header.
    let few = table("object", "{label}").replacen("\n0\n", "\n", 1);
    case.file("few.csv", few);
    let said = read("few.csv", None).err().unwrap().to_string();
    says(&said, &["few.csv: 29 values; 30, one a touch of"]);
}

#[test]
fn columns_of_several_kinds_are_refused_with_the_choice() {
    let case = with_labels();
    let log = table(
        "time_s,s0,s1,s2,s3,acc_x,acc_y",
        "{uneven}.5,{cells},{fourth},-0.5",
    );
    case.file("log.csv", log);
    let given = "log.csv: columns of several kinds: `time_s`, `s*` (4), `acc_x`, `acc_y`; those that are readings, such as ";
    let options = format!("{given}--columns \"s*\", or --columns \"*\" for all");
    let refused = |name: &str, columns: Option<&str>, words: &str| {
        let said = audited(&case, name, columns).expect_err(name);
        says(&said.to_string(), &[words]);
    };
    refused("log.csv", None, &options);
    let said = calibrated(&case, "log.csv", None).unwrap_err().to_string();
    says(&said, &[&options]);
    let said = studied(&case, &of_file("log.csv")).unwrap_err().to_string();
    let keys = format!("{given}recorded.columns = \"s*\", or recorded.columns = \"*\" for all");
    says(&said, &[keys]);
    for columns in ["s*", "s#", "s0,s1,s2,s3", "s0, s1, s2, s3"] {
        let found = audited(&case, "log.csv", Some(columns)).unwrap();
        assert_eq!(found.frames, expected(), "{columns}");
        let found = calibrated(&case, "log.csv", Some(columns)).unwrap();
        assert_eq!(found, expected(), "{columns}");
    }
    let patterns = "no column `*s*[0-9]`; patterns of `time_s`, `s*` (4)";
    refused("log.csv", Some("*s*[0-9]"), patterns);
    let all = audited(&case, "log.csv", Some("*")).unwrap();
    assert_eq!(all.frames.ncols(), TAXELS + 3);
    let plain = studied(&case, &of_file("plain.csv")).unwrap();
    let chosen = studied(&case, &(of_file("log.csv") + "columns = \"s*\""));
    assert_eq!(chosen.unwrap(), plain);
    // Columns of one table are the sensors of a study.
    let alone = |name: &str, taxels: Range<usize>| {
        let readings = expected();
        let own = readings.slice(s![.., taxels]);
        let lines = own.outer_iter().map(super::line);
        case.file(name, lines.collect::<String>());
    };
    alone("a.csv", 0..1);
    alone("b.csv", 1..4);
    let sensors = |a: &str, b: &str| {
        let sensor = |name: &str, keys: &str| {
            format!("[[recorded.sensors]]\nname = {name:?}\nfull_scale = 4.0\n{keys}\n")
        };
        let keys = format!("{LABELS}{}{}", sensor("a", a), sensor("b", b));
        studied(&case, &keys).unwrap()
    };
    let of_log =
        ["s0", "s1,s2,s3"].map(|columns| format!("frames = \"log.csv\"\ncolumns = {columns:?}"));
    let of_files = sensors("frames = \"a.csv\"", "frames = \"b.csv\"");
    assert_eq!(sensors(&of_log[0], &of_log[1]), of_files);
    // Names that are numbers, beside another column.
    case.file("numbered.csv", table("0,1,2,3,object", "{cells},cup"));
    let numbers = "`#` (4), `object`; those that are readings, such as --columns \"#\"";
    refused("numbered.csv", None, numbers);
    let found = audited(&case, "numbered.csv", Some("#")).unwrap();
    assert_eq!(found.frames, expected());
    // An array has no names of columns.
    let array = "--columns \"s*\" beside an array without names of columns; a table";
    refused("labels.npy", Some("s*"), array);
    let headless = "--columns \"s*\" for a table without names of columns; a first line";
    refused("plain.csv", Some("s*"), headless);
}

#[test]
fn exports_and_decimal_commas_are_named_with_their_line_and_their_conversion() {
    let case = with_labels();
    let block = "Frame 1,0.000,,12:00:00\n0,1\n2,3\n\n";
    case.file("mat.csv", format!("DATA_TYPE MOVIE\nVERSION I-Scan 5.10\nROWS 2\nCOLS 2\nASCII_DATA @@\n\n{block}{block}@@\n"));
    let comma = |text: String| text.replace(',', ";").replace('.', ",");
    case.file("comma.csv", comma(table("", "{cells}")));
    case.file("named.csv", comma(table("s0,s1,s2,s3", "{cells}")));
    let lines = |sign: &str| {
        let fixed = |reading: &f64| format!("{sign}{:.3}", reading.abs()).replace('.', ",");
        let line = |touch: usize| expected().row(touch).iter().map(fixed).collect::<Vec<_>>();
        let lines = (0..N).map(|touch| line(touch).join(",") + "\n");
        lines.collect::<String>()
    };
    case.file("fixed.csv", lines(""));
    case.file("signed.csv", lines("-"));
    case.file("headed.csv", format!("s0,s1,s2,s3\n{}", lines("")));
    let plain = table("", "{cells}");
    let broken = plain.lines().enumerate().map(|(touch, line)| match touch {
        7 => line.replacen('1', "l", 1) + "\n",
        _ => format!("{line}\n"),
    });
    case.file("broken.csv", broken.collect::<String>());
    let export = "mat.csv, line 1: `DATA_TYPE MOVIE`, an I-Scan (Tekscan) export with a block of lines for each frame; an array of frames: numpy.save(";
    let decimal = "a table with semicolons and decimal commas; decimal points: pandas.read_csv(";
    let both = ", commas between numbers and in numbers; decimal points, or semicolons between the columns";
    let conversion = "sep=';', decimal=\",\").to_csv(\"points.csv\", index=False)";
    let headed = "headed.csv, line … commas between numbers and in numbers";
    for (name, wanted) in [
        ("mat.csv", &format!("{export} … reshape(-1, 2, 2))")[..]),
        ("comma.csv", &format!("comma.csv, line 1: `0, … {decimal}")),
        ("named.csv", conversion),
        ("fixed.csv", both),
        ("signed.csv", "`-1,0"),
        ("headed.csv", headed),
        ("broken.csv", "broken.csv, line 8: `"),
    ] {
        for said in [
            audited(&case, name, None).err(),
            calibrated(&case, name, None).err(),
            studied(&case, &of_file(name)).err(),
        ] {
            let said = said.expect(name).to_string();
            assert!(contains(&said, wanted), "no {wanted:?} in {said}");
        }
    }
}

/// Adds frames, labels and groups of touches to an archive, whose names have the ending `end`.
fn add(archive: &mut NpzWriter<File>, end: &str, touches: Range<usize>) {
    let frames = expected().slice(s![touches.clone(), ..]).to_owned();
    let frames: Array3<f64> = frames.into_shape_with_order((touches.len(), 2, 2)).unwrap();
    archive.add_array(format!("frames{end}"), &frames).unwrap();
    let mut numbers = |name: &str, of: fn(usize) -> usize| {
        let numbers: Array1<i64> = touches.clone().map(|touch| of(touch) as i64).collect();
        archive.add_array(format!("{name}{end}"), &numbers).unwrap();
    };
    numbers("labels", label);
    numbers("groups", |touch| touch / 3);
}

#[test]
fn a_test_set_in_the_archive_of_the_frames_has_its_own_labels_and_groups() {
    let case = Case::new();
    let mut both = case.archive("both.npz");
    // The test set has as many touches as the training set, and others.
    add(&mut both, "", 0..15);
    add(&mut both, "_test", 15..30);
    both.finish().unwrap();
    let data = audited(&case, "both.npz", None).unwrap();
    assert_eq!(data.labels, Some((0..30).map(label).collect()));
    assert_eq!(data.groups, Some((0..30).map(|touch| touch / 3).collect()));
}

#[test]
fn hidden_files_of_a_folder_are_no_sessions() {
    let case = Case::new();
    std::fs::create_dir(case.path("days")).unwrap();
    for day in 0..2 {
        let mut one = case.archive(&format!("days/day{day}.npz"));
        add(&mut one, "", 15 * day..15 * day + 15);
        one.finish().unwrap();
    }
    let before = audited(&case, "days", None).unwrap();
    case.file("days/._day0.npz", b"Mac OS X");
    case.file("days/.DS_Store", b"Bud1");
    let after = audited(&case, "days", None).unwrap();
    assert_eq!(after.frames, before.frames);
    assert_eq!(after.sessions, before.sessions);
}

#[test]
fn columns_in_another_order_than_those_of_the_frames_are_refused() {
    let case = with_labels();
    case.file("named.csv", table("s0,s1,s2,s3", "{cells}"));
    // The order of the names matters, not the order of the readings.
    case.file("turned.csv", table("s3,s2,s1,s0", "{cells}"));
    case.file("numbered.csv", table("0,1,2,3", "{cells}"));
    case.file("zero.csv", "s3,s2,s1,s0\n0,0,0,0.1\n");
    let of_study = |test: &str| {
        let test = format!("frames_test = {test:?}\nlabels_test = \"labels.npy\"\n");
        studied(&case, &(of_file("named.csv") + &test))
    };
    let of_audit = |test: &str| {
        let given = RecordedSpec {
            labels: case.path("labels.npy"),
            frames_test: Some(case.path(test)),
            labels_test: Some(case.path("labels.npy")),
            ..RecordedSpec::default()
        };
        audited_with(&case, "named.csv", given)
    };
    let of_skin = |untouched: &str| {
        let (path, times) = (case.path(untouched), vec![0.0..1.0]);
        let mut files = skin_files(&case, "named.csv", None);
        files.untouched = UntouchedFrames::File { path, times };
        files.read()
    };
    // Numbers of columns are positions.
    assert!(of_study("numbered.csv").is_ok() && of_audit("numbered.csv").is_ok());
    assert!(of_skin("numbered.csv").is_ok());
    for said in [
        of_study("turned.csv").err(),
        of_audit("turned.csv").err(),
        of_skin("turned.csv").err(),
        studied(&case, &(of_file("named.csv") + "zero = \"zero.csv\"\n")).err(),
    ] {
        let said = said.unwrap().to_string();
        let words =
            "csv: column `s3` in the place of `s0`; the columns of … named.csv, in their order";
        assert!(contains(&said, words), "{said}");
    }
}
