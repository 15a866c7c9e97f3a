//! Generator of random small studies: keys and values come from the descriptors of sensor errors, ensembles, features and classifiers.

use crate::study::laid_out;
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::features::ImageFeature;
use bubbletouch::sensing::Ensemble;
use bubbletouch::study::all_strengths;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::LazyLock;
use toml::{Table, Value};

/// Maximum number of attempts to draw a study that the program accepts; the limit ends a broken generator.
const MAX_DRAWS: usize = 200;

/// Returns the number of studies for each law: `BUBBLETOUCH_GENERATED_STUDIES`, or a number that takes a few seconds.
pub fn n_studies() -> u64 {
    let given = std::env::var("BUBBLETOUCH_GENERATED_STUDIES");
    given.map_or(SAMPLE, |n| n.parse().expect("a number of studies"))
}

/// Returns whether laws are checked on a small sample, in which not every kind of study needs to occur.
pub fn is_sample() -> bool {
    n_studies() <= SAMPLE
}

/// Number of studies per law in `cargo test`. With a larger value, the tests take longer than a few seconds.
const SAMPLE: u64 = 3;

/// Values of keys that no descriptor has.
static VALUES: LazyLock<GeneratedStudy> = LazyLock::new(|| GeneratedStudy {
    table: toml::from_str(include_str!("values.toml")).unwrap(),
});

/// Returns the keys that a generated study may have, without the strengths of sensor errors.
pub fn keys() -> Vec<String> {
    let mut keys: Vec<String> = [
        "sensing.ensemble",
        "recognition.features",
        "recognition.classifier",
    ]
    .map(str::to_owned)
    .to_vec();
    for (name, value) in &VALUES.table {
        match value {
            Value::Table(table) => keys.extend(table.keys().map(|key| format!("{name}.{key}"))),
            _ => keys.push(name.clone()),
        }
    }
    keys
}

/// Generated study: the TOML text of each key's value, by key path.
#[derive(Clone, Debug)]
pub struct GeneratedStudy {
    pub table: Table,
}

impl GeneratedStudy {
    /// Returns the value of a key; `None` if the study does not have it.
    pub fn get(&self, key: &str) -> Option<&Value> {
        let (table, key) = key.split_once('.').unwrap_or(("", key));
        match table {
            "" => self.table.get(key),
            table => self.table.get(table)?.get(key),
        }
    }

    /// Returns the study with this value of a key.
    pub fn with(&self, key: &str, value: impl Into<Value>) -> Self {
        let mut changed = self.clone();
        let (table, key) = key.split_once('.').unwrap_or(("", key));
        let inner = match table {
            "" => &mut changed.table,
            table => {
                let inner = changed.table.entry(table);
                let inner = inner.or_insert_with(|| Table::new().into());
                inner.as_table_mut().expect("a table")
            }
        };
        inner.insert(key.to_owned(), value.into());
        changed
    }

    /// Returns the study without this key.
    pub fn without(&self, key: &str) -> Self {
        let mut changed = self.clone();
        let (table, key) = key.split_once('.').unwrap_or(("", key));
        match table {
            "" => changed.table.remove(key),
            table => {
                let inner = changed.table.get_mut(table).and_then(Value::as_table_mut);
                inner.and_then(|inner| inner.remove(key))
            }
        };
        changed
    }

    /// Returns the study without these keys, which are separated by spaces.
    pub fn without_all(&self, keys: &str) -> Self {
        let keys = keys.split_whitespace();
        keys.fold(self.clone(), |study, key| study.without(key))
    }

    /// Returns the study with `values` of `key` as an axis.
    pub fn swept(&self, key: &str, values: Vec<Value>) -> Self {
        let mut changed = self.without(key);
        let axes = changed.table.entry("axes");
        let axes = axes.or_insert_with(|| Table::new().into());
        let axes = axes.as_table_mut().expect("a table");
        axes.insert(key.to_owned(), values.into());
        changed
    }

    /// Returns the study with another classifier, without the keys of the previous classifier.
    pub fn classified_by(&self, classifier: impl Into<Value>) -> Self {
        let plain = self.without_all(
            "recognition.c recognition.gamma recognition.c_grid recognition.cv_folds \
             recognition.n_neighbours recognition.n_trees",
        );
        plain.with("recognition.classifier", classifier)
    }

    pub fn text(&self) -> String {
        toml::to_string(&self.table).expect("a table has a TOML form")
    }

    /// Plans the study as the command does; returns an error if it is refused.
    pub fn load(&self) -> bubbletouch::Result<RecognitionStudy> {
        laid_out(&self.text())
    }
}

/// Generator of studies; equal laws and numbers give equal studies.
pub struct Generator {
    pub rng: ChaCha8Rng,
}

impl Generator {
    pub fn new(law: &str, number: u64) -> Self {
        let law = law.bytes().fold(0, |hash: u64, byte| {
            hash.wrapping_mul(0x100_0000_01b3) ^ u64::from(byte)
        });
        Self {
            rng: ChaCha8Rng::seed_from_u64(law ^ number),
        }
    }

    /// Returns a study that the program accepts and `is_wanted` allows.
    pub fn study(&mut self, is_wanted: impl Fn(&GeneratedStudy) -> bool) -> GeneratedStudy {
        let mut refused = Vec::new();
        for _ in 0..MAX_DRAWS {
            let study = self.draw();
            if !is_wanted(&study) {
                continue;
            }
            match study.load() {
                Ok(_) => return study,
                Err(error) => refused.push(error.to_string()),
            }
        }
        panic!("no study of {MAX_DRAWS} was accepted: {refused:#?}");
    }

    fn one<T: Clone>(&mut self, values: &[T]) -> T {
        values.choose(&mut self.rng).expect("values").clone()
    }

    fn happens(&mut self, chance: f64) -> bool {
        self.rng.gen_bool(chance)
    }

    /// Returns values of a key that a study may have, in random order; none for a key that this generator does not support.
    pub fn values(&mut self, key: &str) -> Vec<Value> {
        let names = |names: &[(&'static str, &str)]| -> Vec<&str> {
            names.iter().map(|(name, _)| *name).collect()
        };
        let mut values = match key {
            "sensing.ensemble" => words(&names(Ensemble::NAMES)),
            "recognition.features" => {
                let plain = ["raw", "centred", "unit_norm", "centred_unit_norm"];
                words(&[&plain[..], &names(ImageFeature::NAMES)].concat())
            }
            "recognition.classifier" => words(&names(ClassifierKind::NAMES)),
            key => match VALUES.get(key).and_then(Value::as_array) {
                Some(values) => values.clone(),
                None => strength_values(key.strip_prefix("signal.").unwrap_or_default()),
            },
        };
        values.shuffle(&mut self.rng);
        values
    }

    fn draw(&mut self) -> GeneratedStudy {
        let mut study = GeneratedStudy {
            table: Table::new(),
        }
        .with("question", "Does the law hold?")
        .with("seed", self.rng.gen_range(1..1000))
        .with("trials", 2);
        let balls = ["golf", "tennis", "baseball", "squash"];
        let solids = ["mug", "banana", "apple", "bowl"];
        let (set, all) = self.one(&[("balls", balls), ("balls", balls), ("household", solids)]);
        let n = self.rng.gen_range(2..=4);
        let names = all.choose_multiple(&mut self.rng, n).copied();
        let names: Vec<Value> = names.map(Value::from).collect();
        study = study
            .with("objects.sets", words(&[set]))
            .with("objects.names", names);
        if set == "household" {
            study = study.with("objects.surface_error_mm", 2.0);
        }
        let always = "skin.pitch_mm skin.taxels skin.stroke_mm touches.per_object touches.depth_mm \
                      sensing.ensemble recognition.classifier";
        for key in always.split_whitespace() {
            study = self.with_any(study, key);
        }
        for key in ["touches.offset_x_mm", "touches.offset_y_mm"] {
            study = study.with(key, uniform(-6.0, 6.0));
        }
        if self.happens(0.5) {
            study = study.with("touches.yaw_deg", uniform(0.0, 90.0));
        }
        if study.get("sensing.ensemble").and_then(Value::as_str) != Some("identity") {
            study = self.with_any(study, "sensing.ratio");
        }
        let sometimes = [
            ("skin.layout", 0.2),
            ("touches.frames", 0.4),
            ("recognition.features", 0.5),
            ("recognition.scaling", 0.3),
            ("recognition.train_touches", 0.3),
            ("recognition.mislabelled_fraction", 0.2),
            ("recognition.class_imbalance", 0.2),
            ("recognition.touches_per_decision", 0.2),
            ("recognition.readings_per_touch", 0.3),
            ("recognition.test_fraction", 0.3),
        ];
        for (key, chance) in sometimes {
            if self.happens(chance) {
                study = self.with_any(study, key);
            }
        }
        study = self.with_dependent_keys(study);
        let study = self.with_signal(study);
        self.with_classifier_options(study)
    }

    /// Adds keys that have an effect only together with other keys.
    fn with_dependent_keys(&mut self, mut study: GeneratedStudy) -> GeneratedStudy {
        let n_frames = study.get("touches.frames").and_then(Value::as_integer);
        if n_frames.is_some_and(|n| n > 1) {
            if self.happens(0.3) {
                study = self.with_any(study, "touches.speed_mm_per_s");
                study = self.with_any(study, "skin.damping_n_s_per_m");
            }
            if self.happens(0.3) {
                study = self.with_any(study, "recognition.temporal_features");
            }
        }
        if self.happens(0.1) {
            study = study.with("skin.sensed", "shear");
            if self.happens(0.7) {
                study = self.with_any(study, "skin.friction");
                study = self.with_any(study, "touches.slide_mm");
            }
        }
        let features = study.get("recognition.features").and_then(Value::as_str);
        let mut names = ImageFeature::NAMES.iter();
        if features.is_some_and(|features| names.any(|(name, _)| *name == features)) {
            for key in [
                "recognition.tilt_augmentation",
                "recognition.depth_window_full_scale",
            ] {
                if self.happens(0.3) {
                    study = self.with_any(study, key);
                }
            }
        }
        // One fold per trial.
        if study.get("recognition.test_fraction").is_none() && self.happens(0.15) {
            study = study.with("recognition.folds", 2);
        }
        study
    }

    fn with_any(&mut self, study: GeneratedStudy, key: &str) -> GeneratedStudy {
        let value = self.values(key).swap_remove(0);
        study.with(key, value)
    }

    /// Adds the steps of a signal chain in their documented order.
    fn with_signal(&mut self, mut study: GeneratedStudy) -> GeneratedStudy {
        let mut steps = Vec::new();
        if self.happens(0.2) || study.get("skin.damping_n_s_per_m").is_some() {
            steps.push("force");
            if self.happens(0.5) {
                study = self.with_any(study, "skin.stiffness_n_per_m");
            }
        }
        for (error, strength) in all_strengths() {
            let step = error.about().step;
            if steps.last() != Some(&step) && !self.happens(0.15) {
                continue;
            }
            let key = format!("signal.{}", strength.key);
            let values = self.values(&key);
            if let Some(value) = values.into_iter().next() {
                study = study.with(&key, value);
                if steps.last() != Some(&step) {
                    steps.push(step);
                }
            }
        }
        for (step, key) in [
            ("noise", "signal.noise_std_full_scale"),
            ("smoothing", "signal.smoothing_mm"),
        ] {
            if self.happens(0.5) {
                steps.push(step);
                study = self.with_any(study, key);
            }
        }
        // Scan order has an effect only if the press continues during the reading.
        if steps.contains(&"scan") {
            study = self.with_any(study.with("touches.frames", 3), "touches.speed_mm_per_s");
        }
        study.with("signal.steps", words(&steps))
    }

    fn with_classifier_options(&mut self, study: GeneratedStudy) -> GeneratedStudy {
        let classifier = study.get("recognition.classifier").and_then(Value::as_str);
        let key = match classifier {
            Some("k_nearest") => "recognition.n_neighbours",
            Some("random_forest") => "recognition.n_trees",
            Some(name) if name.ends_with("svm") => {
                let study = match name == "rbf_svm" && self.happens(0.3) {
                    true => self.with_any(study, "recognition.gamma"),
                    false => study,
                };
                if self.happens(0.2) {
                    let candidates = vec![Value::from(0.1), Value::from(10.0)];
                    let study = study.with("recognition.c_grid", candidates);
                    return study.with("recognition.cv_folds", 2);
                }
                return self.with_any(study, "recognition.c");
            }
            _ => return study,
        };
        self.with_any(study, key)
    }
}

fn words(words: &[&str]) -> Vec<Value> {
    words.iter().map(|&word| word.into()).collect()
}

/// Returns the value `{ uniform = [low, high] }`.
pub fn uniform(low: f64, high: f64) -> Value {
    let range: Vec<Value> = vec![low.into(), high.into()];
    Table::from_iter([("uniform".to_owned(), range.into())]).into()
}

/// Returns positive values that the strength of a sensor error may have, in any unit.
fn strength_values(key: &str) -> Vec<Value> {
    let found = all_strengths().find(|(_, strength)| strength.key == key);
    let Some((_, strength)) = found else {
        return Vec::new();
    };
    let all = [0.05, 0.1, 0.3, 0.5, 2.0, 6.0, 10.0];
    let allowed = all.into_iter().filter(|&value| strength.is_allowed(value));
    // Fractions of one whole sum to at most 1, and large fractions leave no signal.
    let is_share = strength.unit == "%";
    let allowed = allowed.filter(|&value| !is_share || value < 0.4);
    allowed.map(Value::from).collect()
}
