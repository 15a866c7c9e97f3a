//! Recorded frames in every format that NumPy and spreadsheets write: each gives the same study, and an invalid file gives one clear sentence.

use crate::command::{Case, says};
use crate::study::laid_out;
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::TrialScore;
use bubbletouch::study::{write_integers, write_npy};
use bubbletouch::world::ImageShape;
use ndarray::{Array, Array3, Array4, ArrayD, Axis, Dimension};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

const N: usize = 60;
const NAMES: [&str; 3] = ["cup", "ball", "pen"];

/// Returns frames of three classes, 8 × 8, of which a linear SVM misclassifies some.
fn frames() -> Array3<f64> {
    Array3::from_shape_fn((N, 8, 8), |(touch, row, column)| {
        let (class, k) = (label(touch), touch * 64 + row * 8 + column);
        let noise = ((k * k * 31 + k * 17) % 997) as f64 / 997.0;
        let away = (row as f64 - 3.5).powi(2) + (column as f64 - 2.0 - 0.5 * class as f64).powi(2);
        // Multiples of 1/128, which float16 also represents.
        (64.0 * ((-away / 4.0).exp() + 0.9 * noise)).round() / 128.0
    })
}

fn label(touch: usize) -> usize {
    touch / 20
}

fn labels() -> Vec<usize> {
    (0..N).map(label).collect()
}

const REST: &str = "[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\n[signal]\nsteps = [\"noise\"]\nnoise_std_full_scale = 0.05\n[sensing]\nmeasurements = 8\n[recognition]\nclassifier = \"linear_svm\"\n";

fn study(keys: &str) -> bubbletouch::Result<RecognitionStudy> {
    laid_out(&format!(
        "question = \"?\"\ntrials = 2\n[recorded]\n{keys}\n{REST}"
    ))
}

fn scores(keys: &str) -> Vec<TrialScore> {
    let study = study(keys).unwrap_or_else(|error| panic!("{keys}\n{error}"));
    let rows = study.run(&Silent).unwrap().accuracy.into_iter();
    rows.map(|(_, score)| score).collect()
}

fn error(keys: &str) -> String {
    study(keys).err().expect(keys).to_string()
}

/// Returns the line `key = "file"` for a file in a folder.
fn key(folder: &Path, key: &str, name: &str) -> String {
    format!("{key} = {:?}\n", folder.join(name).display().to_string())
}

fn keys(folder: &Path, frames: &str, labels: &str) -> String {
    key(folder, "frames", frames) + &key(folder, "labels", labels)
}

/// Returns the bytes of a `.npy` file with the given elements.
fn npy(descr: &str, is_fortran: bool, shape: &[usize], bytes: &[u8]) -> Vec<u8> {
    let order = if is_fortran { "True" } else { "False" };
    let shape: String = shape.iter().fold(String::new(), |mut text, n| {
        write!(text, "{n}, ").unwrap();
        text
    });
    let header =
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({shape}), }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), bytes].concat()
}

fn texts(texts: &[&str]) -> Vec<u8> {
    let n = texts.iter().map(|text| text.len()).max().unwrap();
    let letters = texts.iter().flat_map(|text| {
        let letters = text.chars().chain(std::iter::repeat('\0')).take(n);
        letters.flat_map(|letter| u32::from(letter).to_be_bytes())
    });
    npy(
        &format!(">U{n}"),
        false,
        &[texts.len()],
        &letters.collect::<Vec<u8>>(),
    )
}

fn half(number: f64) -> u16 {
    // Positive multiples of 1/128 below 2: the fraction has ten bits after the leading one.
    if number == 0.0 {
        return 0;
    }
    let exponent = number.log2().floor();
    let fraction = (number / exponent.exp2() - 1.0) * 1024.0;
    ((exponent + 15.0) as u16) << 10 | fraction as u16
}

fn written() -> Case {
    let case = Case::new();
    write_npy(&case.path("frames.npy"), &frames()).unwrap();
    write_integers(&case.path("labels.npy"), labels()).unwrap();
    case
}

#[test]
fn frames_of_every_type_and_file_are_the_same_touches() {
    let case = written();
    let folder = case.folder();
    let usual = scores(&keys(folder, "frames.npy", "labels.npy"));
    assert!(usual.iter().any(|score| score.n_correct < score.n_test));
    let frames = frames();
    let numbers: Vec<f64> = frames.iter().copied().collect();
    let bytes =
        |of: &dyn Fn(f64) -> Vec<u8>| numbers.iter().flat_map(|&n| of(n)).collect::<Vec<u8>>();
    let counts = frames.mapv(|number| 128.0 * number);
    let shape = [N, 8, 8];
    case.file(
        "half.npy",
        npy(
            "<f2",
            false,
            &shape,
            &bytes(&|n| half(n).to_le_bytes().to_vec()),
        ),
    );
    case.file(
        "big.npy",
        npy(">f8", false, &shape, &bytes(&|n| n.to_be_bytes().to_vec())),
    );
    case.file(
        "big_u2.npy",
        npy(
            ">u2",
            false,
            &shape,
            &bytes(&|n| ((128.0 * n) as u16).to_be_bytes().to_vec()),
        ),
    );
    case.file(
        "u8.npy",
        npy(
            "<u8",
            false,
            &shape,
            &bytes(&|n| ((128.0 * n) as u64).to_le_bytes().to_vec()),
        ),
    );
    case.file(
        "i1.npy",
        npy("|i1", false, &shape, &bytes(&|n| vec![(128.0 * n) as u8])),
    );
    assert!(counts.iter().all(|&count| count < 128.0));
    // The first index changes fastest.
    let fortran: Vec<u8> = frames.t().iter().flat_map(|n| n.to_le_bytes()).collect();
    case.file("fortran.npy", npy("<f8", true, &shape, &fortran));
    let mut table = String::from("# a comment\n");
    for frame in frames.outer_iter() {
        let configurations: Vec<String> = frame.iter().map(f64::to_string).collect();
        table += &(configurations.join(",") + "\n");
    }
    case.file("frames.csv", &table);
    let names: Vec<String> = (0..64).map(|taxel| format!("taxel {taxel}")).collect();
    case.file("named.csv", names.join(",") + "\n" + &table);
    let last = frames.clone().insert_axis(Axis(3));
    write_npy(&case.path("last.npy"), &last).unwrap();
    let moved = frames
        .view()
        .permuted_axes([1, 2, 0])
        .as_standard_layout()
        .into_owned();
    write_npy(&case.path("moved.npy"), &moved).unwrap();
    for (name, more) in [
        ("half.npy", ""),
        ("big.npy", ""),
        ("big_u2.npy", ""),
        ("u8.npy", ""),
        ("i1.npy", ""),
        ("fortran.npy", ""),
        ("frames.csv", "grid = [8, 8]"),
        ("named.csv", "grid = [8, 8]"),
        ("frames.csv", ""),
        ("last.npy", "order = \"n y x c\""),
        ("last.npy", "order = \"n t y x\"\ngrid = [2, 2]"),
        ("moved.npy", "order = \"y x n\""),
    ] {
        let keys = keys(folder, name, "labels.npy") + more;
        if more.contains("[2, 2]") {
            assert!(error(&keys).contains("no such key"), "{}", error(&keys));
            continue;
        }
        let found = scores(&keys);
        let counts = |scores: &[TrialScore]| scores.iter().map(|s| s.n_correct).collect::<Vec<_>>();
        assert_eq!(counts(&found), counts(&usual), "{name} {more}");
    }
}

#[test]
fn labels_of_every_form_are_the_same_classes() {
    let case = written();
    let folder = case.folder();
    let usual = scores(&keys(folder, "frames.npy", "labels.npy"));
    let labels = labels();
    let write = |name: &str, array: &ArrayD<f64>| write_npy(&case.path(name), array).unwrap();
    let of = |number: &dyn Fn(usize) -> f64| {
        Array::from_iter(labels.iter().map(|&label| number(label))).into_dyn()
    };
    write("float.npy", &of(&|label| label as f64));
    write("from_1.npy", &of(&|label| label as f64 + 1.0));
    write("any.npy", &of(&|label| 100.0 * label as f64 - 70.0));
    write(
        "column.npy",
        &of(&|label| label as f64).insert_axis(Axis(1)),
    );
    let one_hot = Array::from_shape_fn((N, 3), |(touch, class)| {
        f64::from(u8::from(labels[touch] == class))
    });
    write("one_hot.npy", &one_hot.into_dyn());
    let words: Vec<&str> = labels.iter().map(|&label| NAMES[label]).collect();
    case.file("texts.npy", texts(&words));
    let padded: Vec<u8> = words
        .iter()
        .flat_map(|word| format!("{word:\0<6}").into_bytes())
        .collect();
    case.file("bytes.npy", npy("|S6", false, &[N], &padded));
    case.file("texts.csv", format!("object\n{}\n", words.join("\n")));
    for name in [
        "float.npy",
        "from_1.npy",
        "any.npy",
        "column.npy",
        "one_hot.npy",
    ] {
        assert_eq!(scores(&keys(folder, "frames.npy", name)), usual, "{name}");
    }
    let named = "names = [\"cup\", \"ball\", \"pen\"]";
    let usual = scores(&(keys(folder, "frames.npy", "labels.npy") + named));
    for name in ["texts.npy", "bytes.npy", "texts.csv"] {
        let keys = keys(folder, "frames.npy", name);
        assert_eq!(scores(&keys), usual, "{name}");
        assert_eq!(scores(&(keys.clone() + named)), usual, "{name}");
        let found = study(&keys).unwrap();
        assert_eq!(found.first().touched.class_names(), NAMES, "{name}");
        // A name that no touch has does not rename a class.
        let said = error(&(keys + &named.replace("ball", "bal")));
        let words = "key recorded.names: no name \"ball\"; each text of ";
        assert!(said.contains(words), "{said}");
    }
    let class_names = |name: &str| {
        let found = study(&keys(folder, "frames.npy", name)).unwrap();
        let names = found.first().touched.class_names();
        names.into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let expected = ["class -70", "class 30", "class 130"];
    assert_eq!(class_names("any.npy"), expected);
    let lines = |texts: [&[u8]; 3]| {
        let lines = labels.iter().map(|&label| [texts[label], b"\n"].concat());
        lines.collect::<Vec<_>>().concat()
    };
    case.file("latin1.csv", lines([b"caf\xe9", b"th\xe9", b"ma\xdf"]));
    assert_eq!(class_names("latin1.csv"), ["café", "thé", "maß"]);
    let words = labels.iter().map(|&label| ["café", "thé", "maß"][label]);
    let words = words.fold("\u{feff}".to_owned(), |all, word| all + word + "\r\n");
    let units: Vec<u16> = words.encode_utf16().collect();
    let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    for bytes in [little, big] {
        case.file("utf16.csv", bytes);
        assert_eq!(class_names("utf16.csv"), ["café", "thé", "maß"]);
    }
    case.file("padded.csv", lines([b"007", b"7", b"8"]));
    assert_eq!(class_names("padded.csv"), ["007", "7", "8"]);
    // 2⁵³ + 1 is no number of f64, and would be the class 2⁵³.
    case.file("large.csv", lines([b"1", b"9007199254740993", b"2"]));
    let large = labels.iter().map(|&label| (1 << 53) + label);
    write_integers(&case.path("large.npy"), large).unwrap();
    for (name, position) in [("large.csv", 20), ("large.npy", 0)] {
        let said = error(&keys(folder, "frames.npy", name));
        let place = format!("{name}, position {position}: 9007199254740992; one class");
        assert!(
            said.contains(&place) && said.contains("below 2^53"),
            "{said}"
        );
    }
}

/// Writes a `.npz` archive of `.npy` files, stored or compressed.
fn archive(case: &Case, name: &str, members: &[(&str, &str)], is_compressed: bool) {
    let mut archive = zip::ZipWriter::new(std::fs::File::create(case.path(name)).unwrap());
    let method = match is_compressed {
        true => zip::CompressionMethod::Deflated,
        false => zip::CompressionMethod::Stored,
    };
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for (member, file) in members {
        archive
            .start_file(format!("{member}.npy"), options)
            .unwrap();
        archive
            .write_all(&std::fs::read(case.path(file)).unwrap())
            .unwrap();
    }
    archive.finish().unwrap();
}

#[test]
fn archives_and_groups_of_texts_are_read_by_the_names_of_their_arrays() {
    let case = written();
    let folder = case.folder();
    let groups: Vec<String> = (0..N).map(|touch| format!("day {}", touch % 5)).collect();
    let words: Vec<&str> = groups.iter().map(String::as_str).collect();
    case.file("groups.npy", texts(&words));
    write_integers(&case.path("numbers.npy"), (0..N).map(|touch| touch % 5)).unwrap();
    let both = keys(folder, "frames.npy", "labels.npy");
    let usual = scores(&both);
    let grouped = scores(&(both.clone() + &key(folder, "groups", "numbers.npy")));
    assert_eq!(
        scores(&(both + &key(folder, "groups", "groups.npy"))),
        grouped
    );
    assert_ne!(usual, grouped);
    let two = [("frames", "frames.npy"), ("labels", "labels.npy")];
    archive(&case, "stored.npz", &two, false);
    archive(&case, "compressed.npz", &two, true);
    archive(
        &case,
        "all.npz",
        &[&two[..], &[("groups", "groups.npy")]].concat(),
        true,
    );
    archive(&case, "one.npz", &[("arr_0", "frames.npy")], false);
    for name in ["stored.npz", "compressed.npz"] {
        assert_eq!(scores(&key(folder, "frames", name)), usual, "{name}");
        assert_eq!(scores(&keys(folder, name, name)), usual, "{name}");
    }
    assert_eq!(scores(&key(folder, "frames", "all.npz")), grouped);
    assert_eq!(scores(&keys(folder, "one.npz", "labels.npy")), usual);
    archive(
        &case,
        "other.npz",
        &[("x", "frames.npy"), ("y", "labels.npy")],
        false,
    );
    let said = error(&keys(folder, "other.npz", "labels.npy"));
    says(&said, &["arrays x, y; an array `frames`"]);
}

#[test]
fn an_offset_is_subtracted_before_it_costs_digits() {
    let case = written();
    let folder = case.folder();
    let usual = scores(&(keys(folder, "frames.npy", "labels.npy") + "full_scale = 1.5"));
    write_npy(
        &case.path("offset.npy"),
        &frames().mapv(|reading| reading + 1e8),
    )
    .unwrap();
    let offset = keys(folder, "offset.npy", "labels.npy");
    let keys = offset.clone() + "zero = 1e8\nfull_scale = 100000001.5";
    assert_eq!(scores(&keys), usual);
    // Frames are kept in single precision, whose numbers are 8 apart here.
    let said = error(&(offset + "full_scale = 100000001.5"));
    let words = "far from recorded.zero: single precision would round their changes off; recorded.zero = the reading of an untouched taxel";
    assert!(said.contains(words), "{said}");
}

#[test]
fn each_taxel_may_rest_at_a_reading_of_its_own() {
    let case = written();
    let folder = case.folder();
    let usual = scores(&(keys(folder, "frames.npy", "labels.npy") + "full_scale = 2.0"));
    // The taxels have the zeros 62, 60, 56, 48, 32 and read 64 at full scale: the fractions of full scale are bitwise equal.
    let range = |row: usize, column: usize| 2f64.powi(1 + ((row * 3 + column) % 5) as i32);
    let zeros = Array::from_shape_fn((8, 8), |(row, column)| 64.0 - range(row, column));
    let own = Array3::from_shape_fn((N, 8, 8), |(touch, row, column)| {
        let reading = frames()[[touch, row, column]];
        zeros[[row, column]] + 0.5 * range(row, column) * reading
    });
    write_npy(&case.path("own.npy"), &own).unwrap();
    write_npy(&case.path("zero.npy"), &zeros).unwrap();
    let own_keys = keys(folder, "own.npy", "labels.npy") + "full_scale = 64.0\n";
    let with = |zero: &str| own_keys.clone() + &key(folder, "zero", zero);
    assert_eq!(scores(&with("zero.npy")), usual);
    // A single zero for all taxels is wrong here.
    assert_ne!(scores(&(own_keys.clone() + "zero = 32.0")), usual);
    // The zeros as a list, and as a table of rows and columns.
    let list = zeros.iter().copied().collect::<ndarray::Array1<f64>>();
    write_npy(&case.path("list.npy"), &list).unwrap();
    let rows = zeros.outer_iter().map(|row| {
        let configurations: Vec<String> = row.iter().map(f64::to_string).collect();
        configurations.join(",") + "\n"
    });
    std::fs::write(case.path("zero.csv"), rows.collect::<String>()).unwrap();
    assert_eq!(scores(&with("list.npy")), usual);
    assert_eq!(scores(&with("zero.csv")), usual);
    // Axes in another order are the axes of the frames.
    let turned = own
        .permuted_axes([0, 2, 1])
        .as_standard_layout()
        .into_owned();
    write_npy(&case.path("turned.npy"), &turned).unwrap();
    let turned = zeros.t().as_standard_layout().into_owned();
    write_npy(&case.path("turned_zero.npy"), &turned).unwrap();
    let keys_turned =
        keys(folder, "turned.npy", "labels.npy") + "full_scale = 64.0\norder = \"n x y\"\n";
    assert_eq!(
        scores(&(keys_turned + &key(folder, "zero", "turned_zero.npy"))),
        usual
    );
    // Each invalid file gives one sentence.
    let refused = |name: &str, zeros: &ArrayD<f64>, expected: &str| {
        write_npy(&case.path(name), zeros).unwrap();
        let said = error(&with(name));
        says(&said, &[&format!("{name}{expected}")]);
        assert_eq!(said.lines().count(), 1, "{said}");
    };
    let mut wrong = zeros.clone().into_dyn();
    wrong[[2, 3]] = f64::NAN;
    refused("nan.npy", &wrong, ", taxel 19: NaN; a finite number");
    wrong[[2, 3]] = 64.0;
    refused(
        "high.npy",
        &wrong,
        ", taxel 19: 64; below recorded.full_scale, 64",
    );
    let small = ArrayD::zeros(vec![4, 4]);
    refused(
        "small.npy",
        &small,
        ": an array of shape [4, 4]; shape [8, 8], one number for each taxel",
    );
    assert!(error(&with("absent.npy")).contains("absent.npy: cannot be read"));
    let said = error(&(own_keys.clone() + "zero = [1.0]"));
    says(
        &said,
        &["a number, or the path of a file with a number for each taxel"],
    );
}

#[test]
fn clipped_readings_are_saturated_and_others_are_not() {
    let case = written();
    let folder = case.folder();
    let saturated = |name: &str, more: &str| {
        let study = study(&(keys(folder, name, "labels.npy") + more)).unwrap();
        let limits = study.run(&Silent).unwrap().limits;
        assert_eq!(limits[1].limit, "touches with a saturated taxel");
        (limits[1].count, limits[1].total)
    };
    let reaches = |level: f64| {
        let frames = frames();
        let touches = frames.outer_iter();
        let all = touches.filter(|frame| frame.iter().any(|&reading| reading >= level));
        all.count() as u64
    };
    assert_eq!(saturated("frames.npy", ""), (0, N as u64));
    assert_eq!(saturated("frames.npy", "full_scale = 9.0"), (0, N as u64));
    assert!(reaches(0.796875) > 5 && reaches(0.796875) < N as u64);
    assert_eq!(
        saturated("frames.npy", "full_scale = 0.796875").0,
        reaches(0.796875)
    );
    write_npy(
        &case.path("clipped.npy"),
        &frames().mapv(|reading| reading.min(0.796875)),
    )
    .unwrap();
    assert_eq!(saturated("clipped.npy", "").0, reaches(0.796875));
    assert_eq!(
        saturated("clipped.npy", "full_scale = 0.796875").0,
        reaches(0.796875)
    );
    assert_eq!(
        saturated("clipped.npy", "full_scale = 1.0").0,
        reaches(0.796875)
    );
    // Single precision rounds the full scale.
    let single = frames().mapv(|reading| reading.min(0.7) as f32);
    write_npy(&case.path("single.npy"), &single).unwrap();
    assert_eq!(saturated("single.npy", "full_scale = 0.7").0, reaches(0.7));
    // A single taxel with a constant value is stuck; this is not a saturation level of the skin.
    let mut stuck = frames();
    stuck.slice_mut(ndarray::s![.., 2, 5]).fill(3.0);
    write_npy(&case.path("stuck.npy"), &stuck).unwrap();
    assert_eq!(saturated("stuck.npy", "").0, 0);
}

#[test]
fn a_taxel_that_is_often_nan_is_masked_and_another_is_refused_with_the_rule() {
    let case = written();
    let folder = case.folder();
    for n_missing in [N, N / 10] {
        let mut frames = frames();
        frames
            .slice_mut(ndarray::s![..n_missing, 3, 4])
            .fill(f64::NAN);
        write_npy(&case.path("nan.npy"), &frames).unwrap();
        let found = study(&keys(folder, "nan.npy", "labels.npy")).unwrap();
        let touched = &found.first().touched;
        assert_eq!(touched.n_masked(), (1, 64));
        let settings = touched.settings();
        let row = settings.iter().find(|(name, _)| name.starts_with("Masked"));
        assert_eq!(row.unwrap().1, "1 of 64: 28");
        let limits = found.run(&Silent).unwrap().limits;
        let last = limits.last().unwrap();
        assert_eq!(
            (&last.limit[..], last.count, last.total),
            ("taxels that are masked", 1, 64)
        );
        // Masked taxels are counted over all values of an axis.
        write_npy(&case.path("whole.npy"), &self::frames()).unwrap();
        let files = ["whole.npy", "nan.npy"].map(|name| folder.join(name).display().to_string());
        let axis = format!("[axes]\nrecorded.frames = {files:?}\n");
        let keys_of_axis = key(folder, "labels", "labels.npy");
        let swept = laid_out(&format!(
            "question = \"?\"\ntrials = 2\n[recorded]\n{keys_of_axis}\n{REST}\n{axis}"
        ));
        let limits = swept.unwrap().run(&Silent).unwrap().limits;
        let last = limits.last().unwrap();
        assert_eq!((last.count, last.total), (1, 128));
        // With zeros at these taxels, the touches are the same.
        frames.slice_mut(ndarray::s![.., 3, 4]).fill(0.0);
        write_npy(&case.path("zero.npy"), &frames).unwrap();
        assert_eq!(
            scores(&keys(folder, "nan.npy", "labels.npy")),
            scores(&keys(folder, "zero.npy", "labels.npy"))
        );
    }
    let mut frames = frames();
    frames[[7, 3, 4]] = f64::NAN;
    write_npy(&case.path("nan.npy"), &frames).unwrap();
    let said = error(&keys(folder, "nan.npy", "labels.npy"));
    says(&said, &["nan.npy, frame 7, taxel 28: NaN; a finite number"]);
    says(
        &said,
        &["at least 10 % of the frames is masked; this one is in 1 of 60"],
    );
}

/// Creates a folder of arrays that are wrong, beside right ones.
pub fn wrong_arrays() -> Case {
    let case = written();
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
    write_npy(&case.path("half_labels.npy"), &Array::from_elem(N, 0.5)).unwrap();
    write_npy(&case.path("two_hot.npy"), &Array::from_elem((N, 3), 1.0)).unwrap();
    let mut broken = frames();
    broken[[3, 1, 2]] = f64::INFINITY;
    write_npy(&case.path("infinite.npy"), &broken).unwrap();
    case
}

#[test]
fn taxels_without_a_layout_have_no_images_and_no_neighbours() {
    let case = Case::new();
    let frames = frames().slice(ndarray::s![.., .., ..3]).to_owned();
    let flat = frames
        .as_standard_layout()
        .into_owned()
        .into_shape_with_order((N, 24))
        .unwrap();
    write_npy(&case.path("frames.npy"), &flat).unwrap();
    write_integers(&case.path("labels.npy"), labels()).unwrap();
    let keys = keys(case.folder(), "frames.npy", "labels.npy");
    let found = study(&keys).unwrap();
    let array = &found.first().plan.arrays[0];
    assert_eq!((array.n_taxels(), array.sides()), (24, None));
    assert_eq!(array.describe_taxels(), "24 taxels without a layout");
    found.run(&Silent).unwrap();
    let said = |rest: &str| {
        let text = format!("question = \"?\"\n[recorded]\n{keys}\n{rest}");
        laid_out(&text).err().expect(rest).to_string()
    };
    let rest = |signal: &str, sensing: &str, recognition: &str| {
        format!(
            "[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\n[signal]\n{signal}\n[sensing]\n{sensing}\n[recognition]\nclassifier = \"linear_svm\"\n{recognition}\n"
        )
    };
    for (text, words) in [
        (
            rest("", "measurements = 8", "features = \"fourier_magnitude\""),
            "fourier_magnitude of taxels without a layout",
        ),
        (
            rest("", "measurements = 6\nensemble = \"block_average\"", ""),
            "of taxels without a layout",
        ),
        (
            rest(
                "steps = [\"smoothing\"]\nsmoothing_mm = 4.0",
                "measurements = 8",
                "",
            ),
            "\"smoothing\" of taxels without a layout",
        ),
        (
            rest(
                "steps = [\"crosstalk\"]\ncrosstalk = 0.1",
                "measurements = 8",
                "",
            ),
            "\"crosstalk\" of taxels without a layout",
        ),
    ] {
        let said = said(&text);
        assert!(said.contains(words), "{said}\ndoes not say {words}");
    }
}

#[test]
fn a_given_test_set_is_the_split_of_every_trial() {
    let case = written();
    let folder = case.folder();
    let all = frames();
    let is_test = |touch: usize| touch % 20 >= 14;
    let part = |of: bool| {
        (0..N)
            .filter(|&touch| is_test(touch) == of)
            .collect::<Vec<_>>()
    };
    let write = |name: &str, touches: &[usize]| {
        let own: Array3<f64> = all.select(Axis(0), touches);
        write_npy(&case.path(&format!("frames_{name}.npy")), &own).unwrap();
        write_integers(
            &case.path(&format!("labels_{name}.npy")),
            touches.iter().map(|&touch| label(touch)),
        )
        .unwrap();
        let groups = touches
            .iter()
            .map(|&touch| 10 * usize::from(is_test(touch)) + touch % 3);
        write_integers(&case.path(&format!("groups_{name}.npy")), groups).unwrap();
    };
    write("a", &part(false));
    write("b", &part(true));
    let both = keys(folder, "frames_a.npy", "labels_a.npy")
        + &key(folder, "frames_test", "frames_b.npy")
        + &key(folder, "labels_test", "labels_b.npy");
    let found = study(&both).unwrap();
    let sweep = &found.first().sweep;
    assert_eq!(sweep.splits[0], sweep.splits[1]);
    // Class by class, training touches first.
    let expected: Vec<usize> = (0..N).filter(|touch| touch % 20 >= 14).collect();
    assert_eq!(sweep.splits[0].test, expected);
    let rows = scores(&both);
    assert!(
        rows.iter()
            .all(|row| row.n_test == 18 && row.n_train == 42 && row.n_groups.is_none())
    );
    let grouped = both.clone() + &key(folder, "groups_test", "groups_b.npy");
    assert!(scores(&grouped).iter().all(|row| row.n_groups == Some(3)));
    let grouped = grouped + &key(folder, "groups", "groups_a.npy");
    assert!(scores(&grouped).iter().all(|row| row.n_groups == Some(3)));
    for (text, words) in [
        (
            both.clone() + &key(folder, "groups", "groups_a.npy"),
            "key recorded.groups_test: no such key",
        ),
        (
            both.clone()
                + &key(folder, "groups", "groups_a.npy")
                + &key(folder, "groups_test", "labels_b.npy"),
            "in both sets",
        ),
        (
            keys(folder, "frames_a.npy", "labels_a.npy")
                + &key(folder, "frames_test", "frames_b.npy"),
            "key recorded.labels_test: no such key",
        ),
        (
            keys(folder, "frames_a.npy", "labels_a.npy")
                + &key(folder, "labels_test", "labels_b.npy"),
            "key recorded.frames_test: no such key",
        ),
        (
            keys(folder, "frames_a.npy", "labels_a.npy")
                + &key(folder, "frames_test", "frames_b.npy")
                + &key(folder, "labels_test", "labels_a.npy"),
            "labels_a.npy: 42 values; 18, one a touch",
        ),
    ] {
        let said = error(&text);
        assert!(said.contains(words), "{said}\ndoes not say {words}");
    }
    let text = format!("question = \"?\"\n[recorded]\n{both}\n{REST}folds = 5\n");
    let said = laid_out(&text).err().unwrap().to_string();
    says(&said, &["key recognition.folds: given; no such key"]);
    // The page states the split.
    case.file(
        "study.toml",
        format!("question = \"?\"\n[recorded]\n{both}\n{REST}"),
    );
    case.succeeds(&["run", "study.toml", "--out", "out"]);
    let page = std::fs::read_to_string(case.path("out/report.html")).unwrap();
    assert!(page.contains("given test set"));
}

#[test]
fn recordings_over_time_stay_as_they_were() {
    let case = Case::new();
    let frames = Array4::from_shape_fn((N, 3, 8, 8), |(touch, frame, row, column)| {
        frames()[[touch, row, column]] * (frame + 1) as f64
    });
    write_npy(&case.path("frames.npy"), &frames).unwrap();
    write_integers(&case.path("labels.npy"), labels()).unwrap();
    let usual = scores(&keys(case.folder(), "frames.npy", "labels.npy"));
    let last = frames
        .permuted_axes([0, 2, 3, 1])
        .as_standard_layout()
        .into_owned();
    write_npy(&case.path("last.npy"), &last).unwrap();
    let keys = keys(case.folder(), "last.npy", "labels.npy");
    assert_eq!(scores(&(keys.clone() + "order = \"n y x t\"")), usual);
    let said = error(&keys);
    for words in [
        "60 touches of 8 frames of 8 × 3 taxels",
        "60 touches of 8 × 8 taxels of 3 values",
        "recorded.order",
    ] {
        assert!(said.contains(words), "{said}\ndoes not say {words}");
    }
    let one: Array<f64, _> = crate::recorded_arrays::frames();
    shape_is(&one.insert_axis(Axis(1)));
}

fn shape_is<D: Dimension>(frames: &Array<f64, D>) {
    let case = Case::new();
    write_npy(&case.path("frames.npy"), frames).unwrap();
    write_integers(&case.path("labels.npy"), labels()).unwrap();
    let found = study(&keys(case.folder(), "frames.npy", "labels.npy")).unwrap();
    assert_eq!(
        found.first().plan.arrays[0].shape(),
        ImageShape { ny: 8, nx: 8 }
    );
}
