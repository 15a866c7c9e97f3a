//! A program with an own sensor error, ensemble, classifier, feature and kind of study. It runs itself as the command line of studies that use them.

mod transmission;

use bubbletouch::contact::{Press, Until, Workspace};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::Catalogue;
use bubbletouch::recognition::classifiers::foreign::{Foreign, ForeignClassifier, ForeignModel};
use bubbletouch::recognition::data::dataset::Dataset;
use bubbletouch::recognition::features::foreign as features;
use bubbletouch::recognition::svm;
use bubbletouch::sensing::{Ensemble, EnsembleAbout, Operator};
use bubbletouch::signal::{Effect, ErrorAbout, SensorError, Strength, TouchRead};
use bubbletouch::world::{Grid, Patch, Taxel};
use bubbletouch::{command, kinds};
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis};
use std::error::Error;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;

/// Every taxel reads too much by a fraction.
#[derive(Debug)]
struct TooMuch(f64);

impl Effect for TooMuch {
    fn apply(&self, frames: &mut [f64], _: &TouchRead, _: &mut [f64]) {
        frames.iter_mut().for_each(|value| *value *= 1.0 + self.0);
    }
}

const EXCESS: &[Strength] = &[Strength::fraction("too_much_share", "excess")];
const TOO_MUCH: ErrorAbout = ErrorAbout::new("too_much", EXCESS, |&[share, _], _| {
    Ok(Box::new(TooMuch(share)))
});

/// Sums over m stripes of n consecutive taxels.
#[derive(Debug)]
struct Stripes {
    m: usize,
    n_taxels: usize,
}

impl Stripes {
    fn of(&self, taxel: usize) -> usize {
        taxel * self.m / self.n_taxels
    }
}

impl Operator for Stripes {
    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        out.fill(0.0);
        for ((frame, taxel), value) in frames.indexed_iter() {
            out[[frame, self.of(taxel)]] += value;
        }
    }

    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        (0..self.n_taxels).for_each(|taxel| visit(self.of(taxel), taxel, 1.0));
    }

    fn row_norm(&self) -> f64 {
        (self.n_taxels as f64 / self.m as f64).sqrt()
    }
}

const STRIPES: EnsembleAbout = EnsembleAbout {
    is_prefix_nested: false,
    ..EnsembleAbout::new("stripes", |shape, m, _| {
        let n_taxels = shape.n_values();
        Box::new(Stripes { m, n_taxels })
    })
};

/// The nearest mean of a class.
struct Nearest;

struct Means(Vec<(usize, Vec<f64>)>);

impl ForeignClassifier for Nearest {
    fn fit(&self, rows: &Dataset, _: u32) -> Result<Box<dyn ForeignModel>, svm::Error> {
        let mut classes = rows.targets.to_vec();
        classes.sort_unstable();
        classes.dedup();
        let mean = |class: usize| {
            let rows_of: Vec<usize> = (0..rows.targets.len())
                .filter(|&row| rows.targets[row] == class)
                .collect();
            let rows_of = rows.records.select(Axis(0), &rows_of);
            let mean = rows_of.mean_axis(Axis(0));
            let mean = mean.ok_or_else(|| svm::Error::input("class", class, "a row"))?;
            Ok((class, mean.to_vec()))
        };
        let means: Result<_, svm::Error> = classes.into_iter().map(mean).collect();
        Ok(Box::new(Means(means?)))
    }
}

impl ForeignModel for Means {
    fn predict(&self, rows: ArrayView2<f64>) -> Result<Vec<usize>, svm::Error> {
        let label = |row: ndarray::ArrayView1<f64>| {
            let distance = |mean: &[f64]| -> f64 {
                let terms = row.iter().zip(mean).map(|(x, y)| (x - y).powi(2));
                terms.sum()
            };
            let nearest = self
                .0
                .iter()
                .min_by(|a, b| distance(&a.1).total_cmp(&distance(&b.1)));
            nearest.map_or(0, |(class, _)| *class)
        };
        Ok(rows.outer_iter().map(label).collect())
    }
}

/// Features that are the measurements.
struct Copy;

impl features::ForeignFeatures for Copy {
    fn compute(&self, frames: ArrayView2<f64>) -> bubbletouch::Result<Array2<f64>> {
        Ok(frames.to_owned())
    }
}

/// Variable that sets the version of the ensemble; `none` for a program without parts of its own.
const VERSION: &str = "OUTSIDE_VERSION";

/// Runs the command line with the parts of this program, and returns the exit code.
fn command_line(arguments: &[String]) -> bubbletouch::Result<u8> {
    let version = match std::env::var(VERSION).as_deref() {
        Ok("none") => return Ok(command::run(arguments)),
        Ok("2") => "2",
        _ => "1",
    };
    SensorError::register("1", TOO_MUCH)?;
    Ensemble::register("stripes", version, STRIPES)?;
    kinds::register::<transmission::TransmissionStudy>()?;
    let is_transmission = arguments.iter().any(|word| word.contains("transmission"));
    if is_transmission {
        return Ok(command::run(arguments));
    }
    let _classifier = Foreign::new("nearest", "1")?.provide(Arc::new(Nearest));
    let _features = features::Foreign::new("copy", "1")?.provide(Arc::new(Copy));
    Ok(command::run(arguments))
}

const TRANSMISSION: &str = r#"
question = "Which deflections are measured?"
[objects]
sets = ["household"]
names = ["tennis_ball"]
surface_error_mm = 1.0
[skin]
pitch_mm = 4.0
taxels = 16
stroke_mm = 5.0
[touches]
offset_x_mm = [0.0, 4.0]
depth_mm = 3.0
[signal]
steps = ["too_much"]
too_much_share = 0.5
[transmission]
ensemble = ["stripes", "identity"]
measurements = 8
"#;

const RECOGNITION: &str = r#"
question = "Do own parts and built-in parts agree?"
trials = 2
[objects]
sets = ["cans"]
surface_error_mm = 1.0
[skin]
pitch_mm = 8.0
size_mm = 64.0
stroke_mm = 5.0
[touches]
per_object = 8
offset_x_mm = { uniform = [-8.0, 8.0] }
depth_mm = 3.0
[signal]
steps = ["too_much"]
too_much_share = [0.0, 1.0]
[sensing]
ensemble = "stripes"
measurements = 8
[recognition]
classifier = ["nearest_centroid", "nearest"]
features = ["raw", "copy"]
"#;

/// Program in a folder, which it runs as a command line.
struct Program<'a>(&'a Path);

impl Program<'_> {
    /// Runs the program with a version of its ensemble.
    fn run(&self, version: &str, arguments: &[&str]) -> std::io::Result<Output> {
        let mut command = Command::new(std::env::current_exe()?);
        let command = command.current_dir(self.0).env(VERSION, version);
        command.args(arguments).output()
    }

    /// Runs the program; returns its standard output.
    fn says(&self, arguments: &[&str]) -> Result<String, Box<dyn Error>> {
        let output = self.run("1", arguments)?;
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {errors}");
        Ok(String::from_utf8(output.stdout)?)
    }

    /// Runs the program, which refuses the command line; returns its error.
    fn refuses(&self, version: &str, arguments: &[&str]) -> Result<String, Box<dyn Error>> {
        let output = self.run(version, arguments)?;
        let errors = String::from_utf8(output.stderr)?;
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {errors}");
        Ok(errors)
    }

    /// Returns the rows of a table, without the names of the columns.
    fn rows(&self, file: &str) -> Result<Vec<Vec<String>>, Box<dyn Error>> {
        let text = std::fs::read_to_string(self.0.join(file))?;
        let rows = text.lines().skip(1);
        Ok(rows
            .map(|row| row.split(',').map(str::to_owned).collect())
            .collect())
    }

    /// Returns the places of columns in a table.
    fn columns<const N: usize>(
        &self,
        file: &str,
        names: [&str; N],
    ) -> Result<[usize; N], Box<dyn Error>> {
        let text = std::fs::read_to_string(self.0.join(file))?;
        let header: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
        let place = |name| header.iter().position(|column| *column == name);
        Ok(names.map(|name| place(name).unwrap_or_else(|| panic!("{name}: {header:?}"))))
    }
}

/// Returns the mean sum of the deflections of the touches of [`TRANSMISSION`], metres.
fn deflections() -> bubbletouch::Result<f64> {
    let ball = [Catalogue::builtin()?
        .object("tennis_ball")?
        .build(1e-3)?
        .model];
    let taxel = Taxel {
        radius: 2e-3,
        stiffness: 100.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    let grid = Grid {
        nx: 16,
        ny: 16,
        pitch: 4e-3,
    };
    let patch = Patch::grid(grid, taxel)?;
    let mut workspace = Workspace::new();
    let mut sum = 0.0;
    for x in [0.0, 4e-3] {
        let pose = Pose::from_translation([x, 0.0, 0.0].into());
        Press::new(&patch, &ball, &[pose], Until::Depth(3e-3)).run(&mut workspace);
        sum += workspace.deflections().iter().sum::<f64>() / 2.0;
    }
    Ok(sum)
}

/// Checks the parts, or runs the command line if there are arguments.
pub fn check() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    if arguments.len() > 1 {
        std::process::exit(i32::from(command_line(&arguments)?));
    }
    let folder = std::env::temp_dir().join(format!("bubbletouch-outside-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let program = Program(&folder);
    std::fs::write(folder.join("transmission.toml"), TRANSMISSION)?;
    std::fs::write(folder.join("recognition.toml"), RECOGNITION)?;
    own_kind(&program)?;
    own_parts_of_recognition(&program)?;
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}

/// Runs, continues, verifies and reports a study of an own kind with an own error and an own ensemble.
fn own_kind(program: &Program) -> Result<(), Box<dyn Error>> {
    let run = ["run", "transmission.toml"];
    let said = program.says(&["plan", "transmission.toml"])?;
    assert!(said.contains("items    2, of 2 configurations"), "{said}");
    program.says(&run)?;
    let results = "results/transmission";
    let table = &format!("{results}/transmission.csv");
    let rows = program.rows(table)?;
    let named: Vec<[&str; 2]> = rows.iter().map(|row| [&row[0][..], &row[1]]).collect();
    assert_eq!(
        named,
        [["tennis_ball", "stripes@1"], ["tennis_ball", "identity"]]
    );
    let expected = 1.5 * deflections()?;
    for row in &rows {
        let found: f64 = row[2].parse()?;
        let error = (found / expected - 1.0).abs();
        assert!(error < 1e-12, "{found}, expected {expected}");
    }
    println!("own kind, error and ensemble: {} m", rows[0][2]);

    let said = program.says(&["run", "transmission.toml", "--json"])?;
    assert!(said.contains("\"finished_before\":2"), "{said}");
    let said = program.says(&["verify", results])?;
    assert!(said.contains("2 of 2 work items ran again"), "{said}");
    program.says(&["report", results])?;
    let said = program.refuses("none", &run)?;
    assert!(said.contains("unknown variant `too_much`"), "{said}");
    // Another version of the ensemble: its work item is computed again.
    let json = ["run", "transmission.toml", "--json"];
    let output = program.run("2", &json)?;
    let said = String::from_utf8(output.stdout)?;
    assert!(said.contains("\"finished_before\":1"), "{said}");
    let said = program.refuses("1", &["verify", results])?;
    assert!(said.contains("unknown variant `stripes@2`"), "{said}");
    Ok(())
}

/// Compares own parts of a recognition study with equal built-in parts, and checks that another version is not continued.
fn own_parts_of_recognition(program: &Program) -> Result<(), Box<dyn Error>> {
    let run = ["run", "recognition.toml"];
    program.says(&run)?;
    let file = "results/recognition/summary.csv";
    let names = [
        "too_much_share",
        "ensemble",
        "features",
        "classifier",
        "accuracy",
    ];
    let [share, ensemble, features, classifier, accuracy] = program.columns(file, names)?;
    let rows = program.rows(file)?;
    let mut parts: Vec<[&str; 3]> = rows
        .iter()
        .map(|row| [&row[share][..], &row[features], &row[classifier]])
        .collect();
    parts.sort_unstable();
    parts.dedup();
    assert_eq!((rows.len(), parts.len()), (8, 8), "{rows:?}");
    assert!(rows.iter().all(|row| row[ensemble] == "stripes@1"));
    // Readings of twice the size are equal after scaling.
    assert!(
        rows.iter().all(|row| row[accuracy] == rows[0][accuracy]),
        "{rows:?}"
    );
    let found: f64 = rows[0][accuracy].parse()?;
    println!("own error, ensemble, classifier and features: accuracy {found}");
    assert!(found > 0.4 && found < 1.0, "{found}");

    let said = program.says(&["run", "recognition.toml", "--json"])?;
    // One work item for each of the configurations in each trial, and one for the touches.
    let before = format!("\"finished_before\":{}", 2 * rows.len() + 1);
    assert!(said.contains(&before), "{said}");
    program.says(&["verify", "results/recognition"])?;
    let said = program.refuses("2", &run)?;
    assert!(said.contains("stripes@1"), "{said}");
    let said = program.refuses("none", &run)?;
    assert!(said.contains("unknown variant `nearest`"), "{said}");
    Ok(())
}
