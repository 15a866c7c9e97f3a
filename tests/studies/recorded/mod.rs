//! Studies of recorded frames: files of every form, several sensors and values, and laws that compare recordings with simulated touches.

pub mod arrays;
pub mod law;
pub mod sensors;
pub mod simulated;
mod subsets;
mod tables;
pub mod values;

use crate::command::Case;
use bubbletouch::Result;
use bubbletouch::kinds::Source;
use bubbletouch::kinds::recognition::{RecognitionStudy, load_study};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::{Configuration, TrialScore};
use bubbletouch::study::{write_integers, write_npy};
use ndarray::{Array, Array2, Array3, Dimension, IntoDimension, s};
use ndarray_npy::{NpzWriter, ReadableElement, WriteNpyExt, read_npy};
use std::fmt::Write;
use std::fs::File;

/// Number of recorded touches.
pub const N: usize = 60;

/// Returns frames of three classes, 8 × 8, of which a linear SVM misclassifies some.
pub fn frames() -> Array3<f64> {
    Array3::from_shape_fn((N, 8, 8), |(touch, row, column)| {
        let (class, k) = (label(touch), touch * 64 + row * 8 + column);
        let noise = ((k * k * 31 + k * 17) % 997) as f64 / 997.0;
        let away = (row as f64 - 3.5).powi(2) + (column as f64 - 2.0 - 0.5 * class as f64).powi(2);
        // Multiples of 1/128, which float16 also represents.
        (64.0 * ((-away / 4.0).exp() + 0.9 * noise)).round() / 128.0
    })
}

/// Returns the class of a recorded touch.
pub fn label(touch: usize) -> usize {
    touch / 20
}

/// Returns the frames as a list of taxels, shape (N, 64).
pub fn list() -> Array2<f64> {
    frames().into_shape_with_order((N, 64)).unwrap()
}

/// Creates a folder with the frames on a grid (`frames.npy`), as a list (`list.npy`), and of the taxels of two sensors (`left.npy`, `right.npy`).
pub fn recordings() -> Case {
    let case = Case::new();
    let list = list();
    case.write_array("frames.npy", &frames());
    case.write_array("list.npy", &list);
    case.write_array("left.npy", &list.slice(s![.., ..24]));
    case.write_array("right.npy", &list.slice(s![.., 24..]));
    case.write_integers("labels.npy", (0..N).map(label));
    let grid = (0..64).map(|k| (4.0 * (k % 8) as f64, 4.0 * (k / 8) as f64));
    case.file("grid.csv", layout(grid));
    case
}

/// Returns the text of a layout file of taxels in a plane, at positions in millimetres.
pub fn layout(places: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut text = String::from("x_mm,y_mm,z_mm,nx,ny,nz\n");
    for (x, y) in places {
        writeln!(text, "{x},{y},0,0,0,1").unwrap();
    }
    text
}

/// Returns a line of a CSV file.
pub fn line<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> String {
    let texts = numbers.into_iter().map(f64::to_string);
    texts.collect::<Vec<_>>().join(",") + "\n"
}

/// Returns an array in another order of its axes.
pub fn permuted<D: Dimension>(
    array: &Array<f64, D>,
    axes: impl IntoDimension<Dim = D>,
) -> Array<f64, D> {
    let moved = array.view().permuted_axes(axes);
    moved.as_standard_layout().into_owned()
}

pub const LABELS: &str = "labels = \"labels.npy\"\n";
pub const SKIN: &str = "[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\n";
pub const NOISE: &str =
    "[signal]\nsteps = [\"gain\", \"noise\"]\ngain_std = 0.1\nnoise_std_full_scale = 0.05\n";
pub const COUPLED: &str = "[signal]\nsteps = [\"crosstalk\", \"noise\", \"smoothing\"]\ncrosstalk = 0.2\nnoise_std_full_scale = 0.05\nsmoothing_mm = 3.0\n";
pub const RAW: &str = "[sensing]\nmeasurements = 8\n[recognition]\nclassifier = \"linear_svm\"\n";
pub const IMAGES: &str = "[sensing]\nensemble = \"identity\"\n[recognition]\nclassifier = \"linear_svm\"\nfeatures = [\"fourier_magnitude\", \"descriptors\"]\n";

/// Returns the keys of `[recorded]` for a file of frames, with the labels of [`recordings`].
pub fn of_file(frames: &str) -> String {
    format!("{LABELS}frames = {frames:?}\n")
}

/// Returns the keys of `[recorded]` for the sensors left and right, each with further keys.
pub fn sensors(left: &str, right: &str) -> String {
    let sensor = |name: &str, keys: &str| {
        format!("[[recorded.sensors]]\nname = \"{name}\"\nframes = \"{name}.npy\"\n{keys}\n")
    };
    format!("{LABELS}{}{}", sensor("left", left), sensor("right", right))
}

/// Returns the number of correct decisions of each score.
pub fn n_correct(scores: &[TrialScore]) -> Vec<usize> {
    scores.iter().map(|score| score.n_correct).collect()
}

/// Returns whether some decisions are wrong; otherwise, a comparison of scores would be trivial.
pub fn has_errors(scores: &[TrialScore]) -> bool {
    scores.iter().any(|score| score.n_correct < score.n_test)
}

/// Recordings in the folder of a case, and studies that read them by their names.
impl Case {
    pub fn write_array(&self, name: &str, array: &impl WriteNpyExt) {
        write_npy(&self.path(name), array).unwrap();
    }

    pub fn write_integers(&self, name: &str, numbers: impl IntoIterator<Item = usize>) {
        write_integers(&self.path(name), numbers).unwrap();
    }

    pub fn read_array<T: ReadableElement, D: Dimension>(&self, name: &str) -> Array<T, D> {
        read_npy(self.path(name)).unwrap()
    }

    /// Creates a `.npz` archive, to which arrays are added.
    pub fn archive(&self, name: &str) -> NpzWriter<File> {
        NpzWriter::new(File::create(self.path(name)).unwrap())
    }

    /// Loads the study with these keys of `[recorded]` and these other tables.
    pub fn recorded(&self, recorded: &str, rest: &str) -> Result<RecognitionStudy> {
        let text = format!("question = \"?\"\ntrials = 2\n[recorded]\n{recorded}\n{rest}");
        self.load_study(&text)
    }

    /// Loads a recognition study whose files are in the folder.
    pub fn load_study(&self, text: &str) -> Result<RecognitionStudy> {
        load_study(&Source {
            folder: self.folder().to_owned(),
            ..Source::of_text("study.toml", text)
        })
    }

    pub fn scored_rows(&self, recorded: &str, rest: &str) -> Vec<(Configuration, TrialScore)> {
        let study = self.recorded(recorded, rest);
        let study = study.unwrap_or_else(|error| panic!("{recorded}\n{error}"));
        study.run(&Silent).unwrap().accuracy
    }

    pub fn scores(&self, recorded: &str, rest: &str) -> Vec<TrialScore> {
        let rows = self.scored_rows(recorded, rest).into_iter();
        rows.map(|(_, score)| score).collect()
    }
}
