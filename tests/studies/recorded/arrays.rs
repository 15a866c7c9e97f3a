//! Recorded frames in every format that NumPy and spreadsheets write: each gives the same study.

use super::{LABELS, N, frames, has_errors, label, line, n_correct, of_file, permuted, recordings};
use crate::command::{Case, says};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::TrialScore;
use bubbletouch::world::ImageShape;
use ndarray::{Array, Array1, Array3, Array4, Axis, s};
use std::io::Write as _;

const NAMES: [&str; 3] = ["cup", "ball", "pen"];

const REST: &str = "[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\n[signal]\nsteps = [\"noise\"]\nnoise_std_full_scale = 0.05\n[sensing]\nmeasurements = 8\n[recognition]\nclassifier = \"linear_svm\"\n";

fn scores(case: &Case, keys: &str) -> Vec<TrialScore> {
    case.scores(keys, REST)
}

fn error(case: &Case, keys: &str) -> String {
    let study = case.recorded(keys, REST);
    study.err().expect(keys).to_string()
}

/// Returns the bytes of a `.npy` file with the given elements; in Fortran order, the first index changes fastest.
fn npy(descr: &str, is_fortran: bool, shape: &[usize], bytes: &[u8]) -> Vec<u8> {
    let order = if is_fortran { "True" } else { "False" };
    let shape: String = shape.iter().map(|n| format!("{n}, ")).collect();
    let header =
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({shape}), }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), bytes].concat()
}

/// Returns the bytes of a `.npy` file of texts in big-endian order.
fn texts(texts: &[&str]) -> Vec<u8> {
    let n = texts.iter().map(|text| text.len()).max().unwrap();
    let letters = texts.iter().flat_map(|text| {
        let letters = text.chars().chain(std::iter::repeat('\0')).take(n);
        letters.flat_map(|letter| u32::from(letter).to_be_bytes())
    });
    let letters: Vec<u8> = letters.collect();
    npy(&format!(">U{n}"), false, &[texts.len()], &letters)
}

/// Returns the bits of a number in float16. The number is zero or a multiple of 1/128 below 2: the fraction has ten bits after the leading one.
fn half(number: f64) -> u16 {
    if number == 0.0 {
        return 0;
    }
    let exponent = number.log2().floor();
    let fraction = (number / exponent.exp2() - 1.0) * 1024.0;
    ((exponent + 15.0) as u16) << 10 | fraction as u16
}

#[test]
fn frames_of_every_type_and_file_are_the_same_touches() {
    let case = recordings();
    let usual = scores(&case, &of_file("frames.npy"));
    assert!(has_errors(&usual));
    let frames = frames();
    let counts = frames.mapv(|reading| 128.0 * reading);
    assert!(counts.iter().all(|&count| count < 128.0));
    let write = |name: &str, descr: &str, bytes: Vec<u8>| {
        let is_fortran = name == "fortran.npy";
        case.file(name, npy(descr, is_fortran, &[N, 8, 8], &bytes));
    };
    let halves = frames.iter().flat_map(|&n| half(n).to_le_bytes());
    write("half.npy", "<f2", halves.collect());
    let big = frames.iter().flat_map(|n| n.to_be_bytes());
    write("big.npy", ">f8", big.collect());
    let big = counts.iter().flat_map(|&n| (n as u16).to_be_bytes());
    write("big_u2.npy", ">u2", big.collect());
    let little = counts.iter().flat_map(|&n| (n as u64).to_le_bytes());
    write("u8.npy", "<u8", little.collect());
    write("i1.npy", "|i1", counts.iter().map(|&n| n as u8).collect());
    let fortran = frames.t();
    let fortran = fortran.iter().flat_map(|n| n.to_le_bytes());
    write("fortran.npy", "<f8", fortran.collect());
    let table: String = frames.outer_iter().map(line).collect();
    case.file("frames.csv", format!("# a comment\n{table}"));
    let names: Vec<String> = (0..64).map(|taxel| format!("taxel {taxel}")).collect();
    case.file("named.csv", names.join(",") + "\n" + &table);
    case.write_array("last.npy", &frames.clone().insert_axis(Axis(3)));
    case.write_array("moved.npy", &permuted(&frames, [1, 2, 0]));
    let binary = "half.npy big.npy big_u2.npy u8.npy i1.npy fortran.npy".split(' ');
    let ordered = [
        ("frames.csv", "grid = [8, 8]"),
        ("named.csv", "grid = [8, 8]"),
        ("frames.csv", ""),
        ("last.npy", "order = \"n y x c\""),
        ("moved.npy", "order = \"y x n\""),
    ];
    for (name, more) in binary.map(|name| (name, "")).chain(ordered) {
        let found = scores(&case, &(of_file(name) + more));
        assert_eq!(n_correct(&found), n_correct(&usual), "{name} {more}");
    }
}

#[test]
fn labels_of_every_form_are_the_same_classes() {
    let case = recordings();
    let keys = |labels: &str| format!("frames = \"frames.npy\"\nlabels = {labels:?}\n");
    let usual = scores(&case, &keys("labels.npy"));
    let numbers =
        |of: fn(f64) -> f64| Array1::from_iter((0..N).map(|touch| of(label(touch) as f64)));
    case.write_array("float.npy", &numbers(|label| label));
    case.write_array("from_1.npy", &numbers(|label| label + 1.0));
    case.write_array("any.npy", &numbers(|label| 100.0 * label - 70.0));
    let column = numbers(|label| label).insert_axis(Axis(1));
    case.write_array("column.npy", &column);
    let one_hot = Array::from_shape_fn((N, 3), |(touch, class)| {
        f64::from(u8::from(label(touch) == class))
    });
    case.write_array("one_hot.npy", &one_hot);
    for name in ["float", "from_1", "any", "column", "one_hot"] {
        let found = scores(&case, &keys(&format!("{name}.npy")));
        assert_eq!(found, usual, "{name}");
    }
    let words: Vec<&str> = (0..N).map(|touch| NAMES[label(touch)]).collect();
    case.file("texts.npy", texts(&words));
    let padded: String = words.iter().map(|word| format!("{word:\0<6}")).collect();
    let padded = npy("|S6", false, &[N], padded.as_bytes());
    case.file("bytes.npy", padded);
    case.file("texts.csv", format!("object\n{}\n", words.join("\n")));
    let class_names = |name: &str| -> Vec<String> {
        let found = case.recorded(&keys(name), REST).unwrap();
        let names = found.first().touched.class_names();
        names.into_iter().map(str::to_owned).collect()
    };
    let named = "names = [\"cup\", \"ball\", \"pen\"]";
    let usual = scores(&case, &(keys("labels.npy") + named));
    for name in ["texts.npy", "bytes.npy", "texts.csv"] {
        let keys = keys(name);
        assert_eq!(scores(&case, &keys), usual, "{name}");
        assert_eq!(scores(&case, &(keys.clone() + named)), usual, "{name}");
        assert_eq!(class_names(name), NAMES, "{name}");
        // A name that no touch has does not rename a class.
        let said = error(&case, &(keys + &named.replace("ball", "bal")));
        let words = "key recorded.names: no name \"ball\"; each text of ";
        says(&said, &[words]);
    }
    let classes = class_names("any.npy").join(", ");
    assert_eq!(classes, "class -70, class 30, class 130");
    let lines = |texts: [&[u8]; 3]| {
        let lines = (0..N).map(|touch| [texts[label(touch)], b"\n"].concat());
        lines.collect::<Vec<_>>().concat()
    };
    case.file("latin1.csv", lines([b"caf\xe9", b"th\xe9", b"ma\xdf"]));
    assert_eq!(class_names("latin1.csv"), ["café", "thé", "maß"]);
    let words = (0..N).map(|touch| ["café", "thé", "maß"][label(touch)]);
    let words = words.fold("\u{feff}".to_owned(), |all, word| all + word + "\r\n");
    for to_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        let units = words.encode_utf16().flat_map(to_bytes);
        case.file("utf16.csv", units.collect::<Vec<u8>>());
        assert_eq!(class_names("utf16.csv"), ["café", "thé", "maß"]);
    }
    case.file("padded.csv", lines([b"007", b"7", b"8"]));
    assert_eq!(class_names("padded.csv"), ["007", "7", "8"]);
    // 2⁵³ + 1 is no number of f64, and would be the class 2⁵³.
    case.file("large.csv", lines([b"1", b"9007199254740993", b"2"]));
    case.write_integers("large.npy", (0..N).map(|touch| (1 << 53) + label(touch)));
    for (name, position) in [("large.csv", 20), ("large.npy", 0)] {
        let said = error(&case, &keys(name));
        let place = format!("{name}, position {position}: 9007199254740992; one class");
        says(&said, &[&place[..], "below 2^53"]);
    }
}

/// Writes a `.npz` archive of `.npy` files, each given by the name of its array and its own name.
fn archive(case: &Case, name: &str, members: &[(&str, &str)]) {
    let mut archive = zip::ZipWriter::new(std::fs::File::create(case.path(name)).unwrap());
    let method = match name {
        "stored.npz" => zip::CompressionMethod::Stored,
        _ => zip::CompressionMethod::Deflated,
    };
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for (member, file) in members {
        let bytes = case.bytes(file);
        archive
            .start_file(format!("{member}.npy"), options)
            .unwrap();
        archive.write_all(&bytes).unwrap();
    }
    archive.finish().unwrap();
}

#[test]
fn archives_and_groups_of_texts_are_read_by_the_names_of_their_arrays() {
    let case = recordings();
    let groups: Vec<String> = (0..N).map(|touch| format!("day {}", touch % 5)).collect();
    let groups: Vec<&str> = groups.iter().map(String::as_str).collect();
    case.file("groups.npy", texts(&groups));
    case.write_integers("numbers.npy", (0..N).map(|touch| touch % 5));
    let both = of_file("frames.npy");
    let usual = scores(&case, &both);
    let grouped = |groups: &str| scores(&case, &format!("{both}groups = {groups:?}\n"));
    let by_number = grouped("numbers.npy");
    assert_eq!(grouped("groups.npy"), by_number);
    assert_ne!(usual, by_number);
    let two = [("frames", "frames.npy"), ("labels", "labels.npy")];
    archive(&case, "stored.npz", &two);
    archive(&case, "compressed.npz", &two);
    let all = [two[0], two[1], ("groups", "groups.npy")];
    archive(&case, "all.npz", &all);
    archive(&case, "one.npz", &[("arr_0", "frames.npy")]);
    for name in ["stored.npz", "compressed.npz"] {
        let alone = format!("frames = {name:?}\n");
        assert_eq!(scores(&case, &alone), usual, "{name}");
        let labelled = format!("{alone}labels = {name:?}\n");
        assert_eq!(scores(&case, &labelled), usual, "{name}");
    }
    assert_eq!(scores(&case, "frames = \"all.npz\"\n"), by_number);
    assert_eq!(scores(&case, &of_file("one.npz")), usual);
}

#[test]
fn an_offset_is_subtracted_before_it_costs_digits() {
    let case = recordings();
    let usual = scores(&case, &(of_file("frames.npy") + "full_scale = 1.5"));
    case.write_array("offset.npy", &(frames() + 1e8));
    let keys = of_file("offset.npy") + "full_scale = 100000001.5\n";
    assert_eq!(scores(&case, &format!("{keys}zero = 1e8")), usual);
    // Frames are kept in single precision, whose numbers are 8 apart here.
    let words = "far from recorded.zero: single precision would round their changes off; recorded.zero = the reading of an untouched taxel";
    says(&error(&case, &keys), &[words]);
}

#[test]
fn each_taxel_may_rest_at_a_reading_of_its_own() {
    let case = recordings();
    let usual = scores(&case, &(of_file("frames.npy") + "full_scale = 2.0"));
    // The taxels have the zeros 62, 60, 56, 48, 32 and read 64 at full scale: the fractions of full scale are bitwise equal.
    let range = |row: usize, column: usize| 2f64.powi(1 + ((row * 3 + column) % 5) as i32);
    let zeros = Array::from_shape_fn((8, 8), |(row, column)| 64.0 - range(row, column));
    let frames = frames();
    let own = Array3::from_shape_fn((N, 8, 8), |(touch, row, column)| {
        zeros[[row, column]] + 0.5 * range(row, column) * frames[[touch, row, column]]
    });
    case.write_array("own.npy", &own);
    case.write_array("zero.npy", &zeros);
    // The zeros as a list, and as a table of rows and columns.
    let list: Array1<f64> = zeros.iter().copied().collect();
    case.write_array("zero_list.npy", &list);
    let rows: String = zeros.outer_iter().map(line).collect();
    case.file("zero.csv", rows);
    let own_keys = of_file("own.npy") + "full_scale = 64.0\n";
    for zero in ["zero.npy", "zero_list.npy", "zero.csv"] {
        let found = scores(&case, &format!("{own_keys}zero = {zero:?}"));
        assert_eq!(found, usual, "{zero}");
    }
    // A single zero for all taxels is wrong here.
    assert_ne!(scores(&case, &format!("{own_keys}zero = 32.0")), usual);
    // Axes in another order are the axes of the frames.
    case.write_array("turned.npy", &permuted(&own, [0, 2, 1]));
    case.write_array("turned_zero.npy", &permuted(&zeros, [1, 0]));
    let turned = "full_scale = 64.0\norder = \"n x y\"\nzero = \"turned_zero.npy\"\n";
    assert_eq!(scores(&case, &(of_file("turned.npy") + turned)), usual);
}

#[test]
fn clipped_readings_are_saturated_and_others_are_not() {
    let case = recordings();
    let saturated = |name: &str, more: &str| {
        let study = case.recorded(&(of_file(name) + more), REST).unwrap();
        let limits = study.run(&Silent).unwrap().limits;
        assert_eq!(limits[1].limit, "touches with a saturated taxel");
        assert_eq!(limits[1].total, N as u64);
        limits[1].count
    };
    let frames = frames();
    let reaches = |level: f64| {
        let touches = frames.outer_iter();
        let all = touches.filter(|frame| frame.iter().any(|&reading| reading >= level));
        all.count() as u64
    };
    let level = 0.796875;
    assert!(reaches(level) > 5 && reaches(level) < N as u64);
    let clipped = frames.mapv(|reading| reading.min(level));
    case.write_array("clipped.npy", &clipped);
    // Single precision rounds the full scale.
    let single = frames.mapv(|reading| reading.min(0.7) as f32);
    case.write_array("single.npy", &single);
    // A single taxel with a constant value is stuck; this is not a saturation level of the skin.
    let mut stuck = frames.clone();
    stuck.slice_mut(s![.., 2, 5]).fill(3.0);
    case.write_array("stuck.npy", &stuck);
    for (name, keys, expected) in [
        ("frames.npy", "", 0),
        ("frames.npy", "full_scale = 9.0", 0),
        ("frames.npy", "full_scale = 0.796875", reaches(level)),
        ("clipped.npy", "", reaches(level)),
        ("clipped.npy", "full_scale = 0.796875", reaches(level)),
        ("clipped.npy", "full_scale = 1.0", reaches(level)),
        ("single.npy", "full_scale = 0.7", reaches(0.7)),
        ("stuck.npy", "", 0),
    ] {
        assert_eq!(saturated(name, keys), expected, "{name} {keys}");
    }
}

#[test]
fn a_taxel_that_is_often_nan_is_masked_and_another_is_refused_with_the_rule() {
    let case = recordings();
    for n_missing in [N, N / 10] {
        let mut frames = frames();
        frames.slice_mut(s![..n_missing, 3, 4]).fill(f64::NAN);
        case.write_array("nan.npy", &frames);
        let found = case.recorded(&of_file("nan.npy"), REST).unwrap();
        let touched = &found.first().touched;
        assert_eq!(touched.n_masked(), (1, 64));
        let settings = touched.settings();
        let row = settings.iter().find(|(name, _)| name.starts_with("Masked"));
        assert_eq!(row.unwrap().1, "1 of 64: 28");
        let limits = found.run(&Silent).unwrap().limits;
        let last = limits.last().unwrap();
        assert_eq!(last.limit, "taxels that are masked");
        assert_eq!((last.count, last.total), (1, 64));
        // Masked taxels are counted over all values of an axis.
        let axis = "[axes]\nrecorded.frames = [\"frames.npy\", \"nan.npy\"]\n";
        let swept = case.recorded(LABELS, &format!("{REST}\n{axis}"));
        let limits = swept.unwrap().run(&Silent).unwrap().limits;
        let last = limits.last().unwrap();
        assert_eq!((last.count, last.total), (1, 128));
        // With zeros at these taxels, the touches are the same.
        frames.slice_mut(s![.., 3, 4]).fill(0.0);
        case.write_array("zero.npy", &frames);
        let [missing, zero] = ["nan.npy", "zero.npy"].map(|name| scores(&case, &of_file(name)));
        assert_eq!(missing, zero);
    }
}

/// Creates a folder of arrays that are wrong, beside right ones.
pub fn wrong_arrays() -> Case {
    let case = recordings();
    let write = |name: &str, descr: &str, shape: &[usize], n_bytes: usize| {
        case.file(name, npy(descr, false, shape, &vec![0; n_bytes]));
    };
    write("object.npy", "|O", &[N], 8 * N);
    write("complex.npy", "<c16", &[N, 8, 8], 16 * N * 64);
    write("times.npy", "<M8[s]", &[N], 8 * N);
    write("long.npy", "<f16", &[N, 8, 8], 16 * N * 64);
    write("empty.npy", "<f8", &[0, 8, 8], 0);
    write("short.npy", "<f8", &[N, 8, 8], 8 * 100);
    write("huge.npy", "<f8", &[1 << 40, 1 << 20, 8], 8);
    write("half.npy", "<f8", &[N], 8 * N - 4);
    case.file("text.npy", "0,1,2\n");
    case.file("damaged.npz", b"PK\x03\x04 and then nothing");
    case.file("ragged.csv", "1,2,3\n4,5\n");
    case.file("blank.csv", "\n\n");
    case.write_array("half_labels.npy", &Array::from_elem(N, 0.5));
    case.write_array("two_hot.npy", &Array::from_elem((N, 3), 1.0));
    let with = |name: &str, place: [usize; 3], reading: f64| {
        let mut broken = frames();
        broken[place] = reading;
        case.write_array(name, &broken);
    };
    with("infinite.npy", [3, 1, 2], f64::INFINITY);
    with("one_nan.npy", [7, 3, 4], f64::NAN);
    archive(
        &case,
        "other.npz",
        &[("x", "frames.npy"), ("y", "labels.npy")],
    );
    case.write_array("last.npy", &frames().insert_axis(Axis(3)));
    case.write_array("over_time.npy", &Array4::<f64>::ones((N, 8, 8, 3)));
    case.write_array("flat.npy", &without_layout());
    // Zeros of taxels.
    let mut zeros = Array::from_elem((8, 8), 0.0);
    zeros[[2, 3]] = f64::NAN;
    case.write_array("nan_zero.npy", &zeros);
    zeros[[2, 3]] = 64.0;
    case.write_array("high_zero.npy", &zeros);
    case.write_array("small_zero.npy", &Array::from_elem((4, 4), 0.0));
    write_divided(&case);
    case
}

/// Returns frames of 24 taxels whose places are unknown.
fn without_layout() -> ndarray::Array2<f64> {
    let frames = frames().slice(s![.., .., ..3]).to_owned();
    frames.into_shape_with_order((N, 24)).unwrap()
}

#[test]
fn taxels_without_a_layout_are_measured() {
    let case = recordings();
    case.write_array("flat.npy", &without_layout());
    let found = case.recorded(&of_file("flat.npy"), REST).unwrap();
    let array = &found.first().plan.array;
    assert_eq!((array.n_taxels(), array.sides()), (24, None));
    assert_eq!(array.describe_taxels(), "24 taxels without a layout");
    found.run(&Silent).unwrap();
}

/// Writes frames, labels and groups of training touches (`_a`) and test touches (`_b`).
fn write_divided(case: &Case) {
    for (end, is_test) in [("a", false), ("b", true)] {
        let touches = (0..N).filter(|touch| (touch % 20 >= 14) == is_test);
        let touches: Vec<usize> = touches.collect();
        let own = frames().select(Axis(0), &touches);
        case.write_array(&format!("frames_{end}.npy"), &own);
        let labels = touches.iter().map(|&touch| label(touch));
        case.write_integers(&format!("labels_{end}.npy"), labels);
        let groups = touches
            .iter()
            .map(|touch| 10 * usize::from(is_test) + touch % 3);
        case.write_integers(&format!("groups_{end}.npy"), groups);
    }
}

#[test]
fn a_given_test_set_is_the_split_of_every_trial() {
    let case = recordings();
    write_divided(&case);
    let both = "frames = \"frames_a.npy\"\nlabels = \"labels_a.npy\"\nframes_test = \"frames_b.npy\"\nlabels_test = \"labels_b.npy\"\n";
    let found = case.recorded(both, REST).unwrap();
    let sweep = &found.first().sweep;
    assert_eq!(sweep.splits[0], sweep.splits[1]);
    // Class by class, training touches first.
    let expected: Vec<usize> = (0..N).filter(|touch| touch % 20 >= 14).collect();
    assert_eq!(sweep.splits[0].test, expected);
    for row in scores(&case, both) {
        assert_eq!((row.n_test, row.n_train, row.n_groups), (18, 42, None));
    }
    let mut grouped = both.to_owned();
    for key in [
        "groups_test = \"groups_b.npy\"\n",
        "groups = \"groups_a.npy\"\n",
    ] {
        grouped += key;
        let rows = scores(&case, &grouped);
        assert!(rows.iter().all(|row| row.n_groups == Some(3)));
    }
    // The page states the split.
    let study = format!("question = \"?\"\n[recorded]\n{both}\n{REST}");
    case.file("study.toml", study);
    case.succeeds("run study.toml --out out");
    let page = case.read("out/report.html");
    says(&page, &["given test set"]);
}

#[test]
fn recordings_over_time_stay_as_they_were() {
    let case = recordings();
    let one = frames().insert_axis(Axis(1));
    case.write_array("one.npy", &one);
    let found = case.recorded(&of_file("one.npy"), REST).unwrap();
    let shape = found.first().plan.array.shape();
    assert_eq!(shape, ImageShape { ny: 8, nx: 8 });
    let frames = Array4::from_shape_fn((N, 3, 8, 8), |(touch, frame, row, column)| {
        one[[touch, 0, row, column]] * (frame + 1) as f64
    });
    case.write_array("frames.npy", &frames);
    case.write_array("last.npy", &permuted(&frames, [0, 2, 3, 1]));
    let usual = scores(&case, &of_file("frames.npy"));
    let ordered = of_file("last.npy") + "order = \"n y x t\"";
    assert_eq!(scores(&case, &ordered), usual);
}
