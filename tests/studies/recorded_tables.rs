//! Tables of recorded frames as pandas, spreadsheets and loggers write them: each reader finds the same readings, or refuses the table with one sentence.

use crate::command::{Case, says};
use crate::study::laid_out;
use bubbletouch::audit::{AuditData, AuditFiles};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::TrialScore;
use bubbletouch::study::{RecordedSkinFiles, RecordedSpec, UntouchedFrames, write_integers};
use ndarray::{Array1, Array2, Array3};
use std::path::Path;

const N: usize = 30;
const TAXELS: usize = 4;

/// Returns the readings of a touch; the third taxel reads 0 and 1 only.
fn readings(touch: usize) -> [f64; TAXELS] {
    let noise = |k: usize| ((touch * touch * 31 + k * 17 * (touch + 1)) % 97) as f64 / 97.0;
    let class = label(touch) as f64;
    let contact = (touch % 2) as f64;
    [
        class + noise(1),
        2.5 - class - noise(2),
        contact,
        0.25 + noise(3),
    ]
}

fn label(touch: usize) -> usize {
    touch * 7 % 3
}

/// Returns the lines of a table: the header, unless it is empty, and a line for each touch that is made of its number and its readings.
fn table(header: &str, line: impl Fn(usize, &str) -> String) -> String {
    let mut text = String::new();
    if !header.is_empty() {
        text += &format!("{header}\n");
    }
    for touch in 0..N {
        let cells = readings(touch).map(|reading| reading.to_string());
        text += &format!("{}\n", line(touch, &cells.join(",")));
    }
    text
}

/// Reads a table as an audit does, with keys of `[recorded]`.
fn audited_with(case: &Case, name: &str, given: RecordedSpec) -> bubbletouch::Result<AuditData> {
    let files = AuditFiles {
        data: case.path(name),
        given,
        ..AuditFiles::default()
    };
    files.read()
}

fn audited(case: &Case, name: &str, columns: Option<&str>) -> bubbletouch::Result<AuditData> {
    let given = RecordedSpec {
        columns: columns.map(str::to_owned),
        ..RecordedSpec::default()
    };
    audited_with(case, name, given)
}

fn calibrated(case: &Case, name: &str, columns: Option<&str>) -> bubbletouch::Result<Array2<f64>> {
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

fn studied(keys: &str) -> bubbletouch::Result<Vec<TrialScore>> {
    let rest =
        "[skin]\npitch_mm = 4.0\nstroke_mm = 1.0\n[recognition]\nclassifier = \"linear_svm\"\n";
    let study = laid_out(&format!(
        "question = \"?\"\ntrials = 2\n[recorded]\n{keys}\n{rest}"
    ))?;
    let rows = study.run(&Silent).unwrap().accuracy.into_iter();
    Ok(rows.map(|(_, score)| score).collect())
}

/// Returns the line `key = "path"` for a file in the folder of a case.
fn key(case: &Case, key: &str, name: &str) -> String {
    format!("{key} = {:?}\n", case.path(name).display().to_string())
}

fn expected() -> Array2<f64> {
    Array2::from_shape_fn((N, TAXELS), |(touch, taxel)| readings(touch)[taxel])
}

fn with_labels() -> Case {
    let case = Case::new();
    write_integers(&case.path("labels.npy"), (0..N).map(label)).unwrap();
    case.file("plain.csv", table("", |_, cells| cells.to_owned()));
    case
}

#[test]
fn every_reader_finds_the_readings_of_tables_of_pandas_and_of_loggers() {
    let case = with_labels();
    let of_study =
        |name: &str| studied(&(key(&case, "frames", name) + &key(&case, "labels", "labels.npy")));
    let usual = of_study("plain.csv").unwrap();
    assert!(usual.iter().any(|score| score.n_correct < score.n_test));
    let plain = |_: usize, cells: &str| cells.to_owned();
    let indexed = |touch: usize, cells: &str| format!("{touch},{cells}");
    let ended = |_: usize, cells: &str| format!("{cells},");
    for (what, text) in [
        ("numbers of columns", table("0,1,2,3", plain)),
        (
            "numbers of columns as floats",
            table("0.0,1.0,2.0,3.0", plain),
        ),
        ("numbers of columns from 1", table("1,2,3,4", plain)),
        ("an index", table(",0,1,2,3", indexed)),
        (
            "an index of pandas that was written again",
            table("Unnamed: 0.1,Unnamed: 0,0,1,2,3", |touch, cells| {
                format!("{touch},{touch},{cells}")
            }),
        ),
        ("numbers of chosen columns", table("3,5,6,12", plain)),
        (
            "an index of adjacent rows without a header",
            table("", |touch, cells| format!("{},{cells}", touch + 70)),
        ),
        (
            "an index of chosen rows",
            table(",0,1,2,3", |touch, cells| {
                format!("{},{cells}", 3 * touch + 5)
            }),
        ),
        (
            "an index of chosen rows without a header",
            table("", |touch, cells| {
                format!("{},{cells}", 3 * touch + touch % 2)
            }),
        ),
        (
            "an index of shuffled rows without a header",
            table("", |touch, cells| format!("{},{cells}", touch * 7 % N)),
        ),
        (
            "an index of reversed rows, named",
            table("row,s0,s1,s2,s3", |touch, cells| {
                format!("{},{cells}", N - 1 - touch)
            }),
        ),
        (
            "an index of texts",
            table(",s0,s1,s2,s3", |touch, cells| {
                format!("touch {touch},{cells}")
            }),
        ),
        ("a named index", table("touch,s0,s1,s2,s3", indexed)),
        ("an index without a header", table("", indexed)),
        (
            "an index as a float",
            table("", |touch, cells| format!("{touch}.0,{cells}")),
        ),
        (
            "an index from 1",
            table("", |touch, cells| format!("{},{cells}", touch + 1)),
        ),
        (
            "an index behind the readings",
            table("", |touch, cells| format!("{cells},{touch}")),
        ),
        (
            "an index between the readings",
            table("", |touch, cells| {
                cells.replacen(',', &format!(",{touch},"), 1)
            }),
        ),
        (
            "an index that begins again with each touch",
            table("frame,s0,s1,s2,s3", |touch, cells| {
                format!("{},{cells}", touch % 5)
            }),
        ),
        (
            "an index that begins again, touches of unequal length",
            table("", |touch, cells| {
                format!(
                    "{},{cells}",
                    if touch < 12 {
                        touch % 4
                    } else {
                        (touch - 12) % 6
                    }
                )
            }),
        ),
        (
            "names with two numbers",
            table("s0_0,s0_1,s1_0,s1_1", plain),
        ),
        ("a comma at the end of each line", table("", ended)),
        (
            "a comma at the end of each line, and of the header",
            table("s0,s1,s2,s3,", ended),
        ),
        (
            "a comma at the end of each line but of the header",
            table("s0,s1,s2,s3", ended),
        ),
        (
            "two commas at the end of each line",
            table("", |_, cells| format!("{cells},,")),
        ),
        (
            "two commas at the end of each line, and of the header",
            table("s0,s1,s2,s3,,", |_, cells| format!("{cells},,")),
        ),
        (
            "two commas at the end of each line but of the header",
            table("s0,s1,s2,s3", |_, cells| format!("{cells},,")),
        ),
        (
            "a comma at the end of the header",
            table("s0,s1,s2,s3,", plain),
        ),
        (
            "an index, and a comma at the end of each line",
            table(",0,1,2,3,", |touch, cells| format!("{touch},{cells},")),
        ),
    ] {
        for (separator, name) in [(",", "it.csv"), (";", "it.txt"), ("\t", "it.tsv")] {
            case.file(name, text.replace(',', separator));
            let data = audited(&case, name, None).unwrap_or_else(|error| panic!("{what}: {error}"));
            assert_eq!(data.frames, expected(), "{what}");
            assert_eq!(calibrated(&case, name, None).unwrap(), expected(), "{what}");
        }
        assert_eq!(of_study("it.csv").unwrap(), usual, "{what}");
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
    case.file(
        "indexed.csv",
        table(",0,1,2,3", |touch, cells| format!("{touch},{cells},")),
    );
    for arguments in [
        &["calibrate", "indexed.csv", "--grid", "2,2"][..],
        &[
            "audit",
            "indexed.csv",
            "--labels",
            "labels.npy",
            "--permutations",
            "399",
        ],
    ] {
        let (_, notes) = case.succeeds(arguments);
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
    let case = Case::new();
    case.file(
        "named.csv",
        table("s0,s1,s2,s3,s4", |_, cells| format!("{cells},")),
    );
    let data = audited(&case, "named.csv", None).unwrap();
    assert_eq!(data.frames.ncols(), TAXELS + 1);
    assert!(
        data.frames
            .column(TAXELS)
            .iter()
            .all(|reading| reading.is_nan())
    );
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
        audited_with(&case, "plain.csv", given).unwrap_or_else(|error| panic!("{labels}: {error}"))
    };
    let rows =
        |line: &dyn Fn(usize) -> String| (0..N).map(|touch| line(touch) + "\n").collect::<String>();
    let labels: Vec<usize> = (0..N).map(label).collect();
    let one_hot = |touch: usize| ["1,0,0", "0,1,0", "0,0,1"][label(touch)].to_owned();
    for (what, text) in [
        ("a column", rows(&|touch| label(touch).to_string())),
        (
            "a series with its index",
            ",0\n".to_owned() + &rows(&|touch| format!("{touch},{}", label(touch))),
        ),
        (
            "a series without its index",
            "0\n".to_owned() + &rows(&|touch| label(touch).to_string()),
        ),
        (
            "a named series",
            ",object\n".to_owned() + &rows(&|touch| format!("{touch},{}", label(touch))),
        ),
        (
            "a column for each class",
            "0,1,2\n".to_owned() + &rows(&one_hot),
        ),
        ("a column for each class without a header", rows(&one_hot)),
        (
            "an index and a column for each class",
            ",0,1,2\n".to_owned() + &rows(&|touch| format!("{touch},{}", one_hot(touch))),
        ),
    ] {
        case.file("it.csv", text);
        assert_eq!(read("it.csv", None).labels, Some(labels.clone()), "{what}");
    }
    let word = |touch: usize| ["cup", "ball", "pen"][label(touch)];
    for (what, text) in [
        ("texts", rows(&|touch| word(touch).to_owned())),
        (
            "texts below a name",
            "object\n".to_owned() + &rows(&|touch| word(touch).to_owned()),
        ),
        (
            "a series of texts",
            ",0\n".to_owned() + &rows(&|touch| format!("{touch},{}", word(touch))),
        ),
        (
            "a named series of texts",
            ",object\n".to_owned() + &rows(&|touch| format!("{touch},{}", word(touch))),
        ),
        (
            "a named series of texts of shuffled rows",
            ",object\n".to_owned() + &rows(&|touch| format!("{},{}", touch * 7 % N, word(touch))),
        ),
        (
            "a series of texts without a header",
            rows(&|touch| format!("{touch},{}", word(touch))),
        ),
    ] {
        case.file("it.csv", text);
        let data = read("it.csv", None);
        let found = data.labels.unwrap();
        let words: Vec<&str> = found
            .iter()
            .map(|&label| &data.classes[label][..])
            .collect();
        assert_eq!(words, (0..N).map(word).collect::<Vec<_>>(), "{what}");
    }
    case.file("touches.csv", rows(&|touch| touch.to_string()));
    assert_eq!(
        read("labels.npy", Some("touches.csv")).groups,
        Some((0..N).collect())
    );
    // A wrong number of labels is not made right by a header.
    case.file(
        "few.csv",
        "object\n".to_owned() + &rows(&|touch| label(touch).to_string()).replacen("0\n", "", 1),
    );
    let given = RecordedSpec {
        labels: case.path("few.csv"),
        ..RecordedSpec::default()
    };
    let said = audited_with(&case, "plain.csv", given).unwrap_err();
    let said = said.to_string();
    says(&said, &["few.csv: 29 values; 30, one a touch of"]);
}

#[test]
fn columns_of_several_kinds_are_refused_with_the_choice() {
    let case = with_labels();
    let line = |touch: usize, cells: &str| {
        format!("{},{cells},{},-0.5", 1.7e9 + 0.04 * touch as f64, touch % 4)
    };
    case.file("log.csv", table("time_s,s0,s1,s2,s3,acc_x,acc_y", line));
    let words = "log.csv: columns of several kinds: `time_s`, `s*` (4), `acc_x`, `acc_y`; those that are readings, such as ";
    for said in [
        audited(&case, "log.csv", None).err().unwrap(),
        calibrated(&case, "log.csv", None).err().unwrap(),
    ] {
        let said = said.to_string();
        says(
            &said,
            &[&format!(
                "{words}--columns \"s*\", or --columns \"*\" for all"
            )],
        );
    }
    let labels = key(&case, "labels", "labels.npy");
    let frames = key(&case, "frames", "log.csv");
    let said = studied(&(frames.clone() + &labels))
        .unwrap_err()
        .to_string();
    says(
        &said,
        &[&format!(
            "{words}recorded.columns = \"s*\", or recorded.columns = \"*\" for all"
        )],
    );
    for columns in ["s*", "s#", "s0,s1,s2,s3", "s0, s1, s2, s3", "*s*[0-9]"] {
        let found = audited(&case, "log.csv", Some(columns));
        if columns.contains('[') {
            let said = found.err().unwrap().to_string();
            says(
                &said,
                &["no column `*s*[0-9]`; patterns of `time_s`, `s*` (4)"],
            );
            continue;
        }
        assert_eq!(found.unwrap().frames, expected(), "{columns}");
        assert_eq!(
            calibrated(&case, "log.csv", Some(columns)).unwrap(),
            expected(),
            "{columns}"
        );
    }
    assert_eq!(
        audited(&case, "log.csv", Some("*")).unwrap().frames.ncols(),
        TAXELS + 3
    );
    let usual = studied(&(key(&case, "frames", "plain.csv") + &labels)).unwrap();
    assert_eq!(
        studied(&(frames + &labels + "columns = \"s*\"")).unwrap(),
        usual
    );
    // Columns of one table are the sensors of a study.
    let sensors = |one: &str, other: &str| {
        let sensor = |name: &str, keys: &str| {
            format!("[[recorded.sensors]]\nname = {name:?}\nfull_scale = 4.0\n{keys}\n")
        };
        studied(&(labels.clone() + &sensor("a", one) + &sensor("b", other))).unwrap()
    };
    let of_log =
        |columns: &str| key(&case, "frames", "log.csv") + &format!("columns = {columns:?}");
    let alone = |name: &str, taxels: std::ops::Range<usize>| {
        let text = table("", |touch, _| {
            readings(touch)[taxels.clone()]
                .iter()
                .map(f64::to_string)
                .collect::<Vec<_>>()
                .join(",")
        });
        case.file(name, text);
        key(&case, "frames", name)
    };
    let expected = sensors(&alone("a.csv", 0..1), &alone("b.csv", 1..4));
    assert_eq!(sensors(&of_log("s0"), &of_log("s1,s2,s3")), expected);
    // Names that are numbers, beside another column.
    case.file(
        "numbered.csv",
        table("0,1,2,3,object", |_, cells| format!("{cells},cup")),
    );
    let said = audited(&case, "numbered.csv", None)
        .err()
        .unwrap()
        .to_string();
    says(
        &said,
        &["`#` (4), `object`; those that are readings, such as --columns \"#\""],
    );
    assert_eq!(
        audited(&case, "numbered.csv", Some("#")).unwrap().frames,
        self::expected()
    );
    // An array has no names of columns.
    let said = audited(&case, "labels.npy", Some("s*"))
        .err()
        .unwrap()
        .to_string();
    says(
        &said,
        &["--columns \"s*\" beside an array without names of columns; a table"],
    );
    let said = audited(&case, "plain.csv", Some("s*"))
        .err()
        .unwrap()
        .to_string();
    says(
        &said,
        &["--columns \"s*\" for a table without names of columns; a first line"],
    );
}

#[test]
fn exports_and_decimal_commas_are_named_with_their_line_and_their_conversion() {
    let case = with_labels();
    let block = "Frame 1,0.000,,12:00:00\n0,1\n2,3\n\n";
    case.file("mat.csv", format!("DATA_TYPE MOVIE\nVERSION I-Scan 5.10\nROWS 2\nCOLS 2\nASCII_DATA @@\n\n{block}{block}@@\n"));
    let comma = |text: String| text.replace(',', ";").replace('.', ",");
    case.file("comma.csv", comma(table("", |_, cells| cells.to_owned())));
    case.file(
        "named.csv",
        comma(table("s0,s1,s2,s3", |_, cells| cells.to_owned())),
    );
    let fixed = |touch: usize, sign: &str| {
        let cells = readings(touch).map(|reading| format!("{sign}{:.3}", reading.abs()));
        cells.join(",").replace('.', ",") + "\n"
    };
    let lines = |sign: &str| (0..N).map(|touch| fixed(touch, sign)).collect::<String>();
    case.file("fixed.csv", lines(""));
    case.file("signed.csv", lines("-"));
    case.file("headed.csv", "s0,s1,s2,s3\n".to_owned() + &lines(""));
    case.file(
        "broken.csv",
        table("", |touch, cells| {
            if touch == 7 {
                cells.replacen('1', "l", 1)
            } else {
                cells.to_owned()
            }
        }),
    );
    for (name, words) in [
        (
            "mat.csv",
            "mat.csv, line 1: `DATA_TYPE MOVIE`, an I-Scan (Tekscan) export with a block of lines for each frame; an array of frames: numpy.save(",
        ),
        ("mat.csv", "reshape(-1, 2, 2))"),
        ("comma.csv", "comma.csv, line 1: `0,"),
        (
            "comma.csv",
            "a table with semicolons and decimal commas; decimal points: pandas.read_csv(",
        ),
        (
            "named.csv",
            "sep=';', decimal=\",\").to_csv(\"points.csv\", index=False)",
        ),
        (
            "fixed.csv",
            ", commas between numbers and in numbers; decimal points, or semicolons between the columns",
        ),
        ("signed.csv", "`-1,0"),
        ("headed.csv", "headed.csv, line "),
        ("headed.csv", "commas between numbers and in numbers"),
        ("broken.csv", "broken.csv, line 8: `"),
    ] {
        let of_study = studied(&(key(&case, "frames", name) + &key(&case, "labels", "labels.npy")));
        for said in [
            audited(&case, name, None).err(),
            calibrated(&case, name, None).err(),
            of_study.err(),
        ] {
            let said = said.expect(name).to_string();
            assert!(said.contains(words), "{said}");
        }
    }
}

/// Writes a `.npz` archive of frames, labels and groups, whose names have the ending `end`.
fn add(
    archive: &mut ndarray_npy::NpzWriter<std::fs::File>,
    end: &str,
    touches: std::ops::Range<usize>,
) {
    let frames = Array3::from_shape_fn((touches.len(), 2, 2), |(k, row, column)| {
        readings(touches.start + k)[2 * row + column]
    });
    archive.add_array(format!("frames{end}"), &frames).unwrap();
    let numbers = |of: &dyn Fn(usize) -> usize| {
        Array1::from_iter(touches.clone().map(|touch| of(touch) as i64))
    };
    archive
        .add_array(format!("labels{end}"), &numbers(&label))
        .unwrap();
    archive
        .add_array(format!("groups{end}"), &numbers(&|touch| touch / 3))
        .unwrap();
}

fn archive(path: &Path) -> ndarray_npy::NpzWriter<std::fs::File> {
    ndarray_npy::NpzWriter::new(std::fs::File::create(path).unwrap())
}

#[test]
fn a_test_set_in_the_archive_of_the_frames_has_its_own_labels_and_groups() {
    let case = Case::new();
    let mut both = archive(&case.path("both.npz"));
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
        let mut one = archive(&case.path(&format!("days/day{day}.npz")));
        add(&mut one, "", 15 * day..15 * day + 15);
        one.finish().unwrap();
    }
    let before = audited(&case, "days", None).unwrap();
    case.file("days/._day0.npz", b"Mac OS X");
    case.file("days/.DS_Store", b"Bud1");
    let after = audited(&case, "days", None).unwrap();
    assert_eq!(
        (after.frames, after.sessions),
        (before.frames, before.sessions)
    );
}

#[test]
fn columns_in_another_order_than_those_of_the_frames_are_refused() {
    let case = with_labels();
    case.file(
        "named.csv",
        table("s0,s1,s2,s3", |_, cells| cells.to_owned()),
    );
    let turned = |_: usize, cells: &str| cells.split(',').rev().collect::<Vec<_>>().join(",");
    case.file("turned.csv", table("s3,s2,s1,s0", turned));
    case.file(
        "numbered.csv",
        table("0,1,2,3", |_, cells| cells.to_owned()),
    );
    case.file("zero.csv", "s3,s2,s1,s0\n0,0,0,0.1\n");
    let frames = key(&case, "frames", "named.csv") + &key(&case, "labels", "labels.npy");
    let of_study = |test: &str| {
        let labels = key(&case, "labels_test", "labels.npy");
        studied(&(frames.clone() + &key(&case, "frames_test", test) + &labels))
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
        let files = RecordedSkinFiles {
            untouched: UntouchedFrames::File {
                path: case.path(untouched),
                times: vec![0.0..1.0],
            },
            ..skin_files(&case, "named.csv", None)
        };
        files.read()
    };
    // Numbers of columns are positions.
    assert!(of_study("numbered.csv").is_ok() && of_audit("numbered.csv").is_ok());
    assert!(of_skin("numbered.csv").is_ok());
    let refusals = [
        of_study("turned.csv").err(),
        of_audit("turned.csv").err(),
        of_skin("turned.csv").err(),
        studied(&(frames + &key(&case, "zero", "zero.csv"))).err(),
    ];
    for said in refusals {
        let said = said.unwrap().to_string();
        let words = "csv: column `s3` in the place of `s0`; the columns of ";
        assert!(
            said.contains(words) && said.ends_with("named.csv, in their order"),
            "{said}"
        );
    }
}
