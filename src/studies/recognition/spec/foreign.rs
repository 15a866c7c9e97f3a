//! Classifiers and features in a study file: those of this program, and those from outside.

use crate::files::FilePath;
use crate::inputs::content_hash::short_hash;
use crate::inputs::params::{Described, named};
use crate::learning::classifiers::classifier;
use crate::learning::classifiers::foreign::Foreign;
use crate::learning::command_classifier::CommandClassifier;
use crate::studies::prelude::*;
use crate::studies::recognition::spec::RecognitionSpec;
use bubbletouch_sim::features::{Features, ImageFeature, foreign};
use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserializer, Serializer};
use serde_json::{Value, json};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Allowed letters of a name and a version, with the character between them.
const FOREIGN: &str = r"^[A-Za-z0-9_.-]+@[A-Za-z0-9_.-]+$";

/// Number of hexadecimal digits of the hash of a command and its files. With fewer digits, two versions of a file may have the same hash.
const DIGITS: usize = 16;

/// Classifier of a study file: the name of a kind, `name@version` of a classifier that the running program provides, or a command.
#[derive(Clone, Debug, PartialEq)]
pub enum ClassifierChoice {
    /// Kind of classifier of this program, or a classifier that the running program provides.
    Kind(ClassifierKind),
    /// Command that trains a classifier and predicts labels.
    Command(CommandSpec),
}

/// Command that trains a classifier and predicts labels, such as `{ command = ["python", "mine.py"] }`.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandSpec {
    /// Keys of the study file; paths of files are absolute.
    pub keys: CommandKeys,
    /// Identity of the classifier. Its version contains a hash of the command and its files.
    pub foreign: Foreign,
}

params! {
    /// Keys of a classifier that is a command.
    pub struct CommandKeys {
        /// Program and its arguments. Paths of files are relative to the study file. `{alpha}` is a parameter with the value of `parameters.NAME.alpha`. The program gets three further arguments: the paths of `train.npz`
        /// (`features`, `labels`, `seed`), of `test.npz` (`features`) and of `labels.npy`, which the program writes. A change of a file among the arguments is
        /// another version.
        command: Vec<String>;
        /// Name of the classifier in tables and charts. Default: the name of the first file among the arguments, without its ending.
        name: Option<String>;
        /// Version of what the command runs beside its files, such as a library. Another version is computed again.
        version: Option<String>;
        /// Maximum time of one call of the command, s. Default: no limit.
        time_limit_s: Option<f64>;
    }
}

impl TryFrom<CommandKeys> for CommandSpec {
    type Error = Error;

    fn try_from(mut keys: CommandKeys) -> Result<Self> {
        let place = "key recognition.classifier";
        if keys.command.first().is_none_or(String::is_empty) {
            let allowed = "a program and its arguments: [\"python\", \"mine.py\"]";
            return Err(Error::input(place, "an empty command", allowed));
        }
        if let Some(limit) = keys.time_limit_s
            && !(limit > 0.0 && limit <= 1e9)
        {
            return Err(Error::input(
                place,
                format!("time_limit_s = {limit}"),
                "above 0, at most 1e9",
            ));
        }
        let mut content = Vec::new();
        let mut name = None;
        for (number, word) in keys.command.iter_mut().enumerate() {
            match file(word, number == 0) {
                None => content.push(word.clone()),
                Some(path) => {
                    let bytes = std::fs::read(&path).map_err(|e| Error::io(&path, "read", e))?;
                    content.push(short_hash(bytes, DIGITS));
                    if name.is_none() || number == 1 {
                        name = path
                            .file_stem()
                            .map(|stem| stem.to_string_lossy().into_owned());
                    }
                    *word = path.display().to_string();
                }
            }
        }
        let program = Path::new(&keys.command[0]).file_stem();
        let usual = name.or_else(|| program.map(|stem| stem.to_string_lossy().into_owned()));
        let name = keys.name.clone().or(usual).unwrap_or_default();
        let hash = short_hash(content.join("\n"), DIGITS);
        let version = match &keys.version {
            Some(given) => format!("{given}-{hash}"),
            None => hash,
        };
        let foreign = Foreign::new(&name, &version)
            .map_err(|error| Error::from(error).under(format!("{place}, ")))?;
        Ok(Self { keys, foreign })
    }
}

/// Returns the path of a file among the words of a command; `None` for other words. The name of a program is a file only if it contains a slash.
fn file(word: &str, is_program: bool) -> Option<PathBuf> {
    let path = Path::new(word);
    let may_be_file = word.contains('/') || (!is_program && path.extension().is_some());
    if !may_be_file {
        return None;
    }
    let resolved = FilePath::deserialize(StrDeserializer::<de::value::Error>::new(word)).ok()?;
    let found = resolved
        .is_file()
        .then(|| std::path::absolute(&*resolved).ok());
    found.flatten()
}

impl ClassifierChoice {
    /// Returns the kind of classifier.
    pub fn kind(&self) -> ClassifierKind {
        match self {
            Self::Kind(kind) => *kind,
            Self::Command(command) => ClassifierKind::Foreign(command.foreign),
        }
    }
}

impl Serialize for ClassifierChoice {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Kind(kind) => classifier::with_version(kind, serializer),
            Self::Command(command) => command.keys.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for ClassifierChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(ChoiceVisitor)
    }
}

struct ChoiceVisitor;

impl<'de> Visitor<'de> for ChoiceVisitor {
    type Value = ClassifierChoice;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of a classifier, or a table with a command")
    }

    fn visit_str<E: de::Error>(self, text: &str) -> std::result::Result<ClassifierChoice, E> {
        let kind = match Foreign::named(text) {
            Some(foreign) => ClassifierKind::Foreign(foreign),
            None => ClassifierKind::deserialize(StrDeserializer::<E>::new(text))?,
        };
        Ok(ClassifierChoice::Kind(kind))
    }

    fn visit_map<A: MapAccess<'de>>(
        self,
        map: A,
    ) -> std::result::Result<ClassifierChoice, A::Error> {
        let keys = CommandKeys::deserialize(MapAccessDeserializer::new(map))?;
        let command = CommandSpec::try_from(keys).map_err(de::Error::custom)?;
        Ok(ClassifierChoice::Command(command))
    }
}

impl Described for ClassifierChoice {
    fn schema() -> Value {
        let provided = json!({ "title": "`name@version` of a classifier that the running program provides", "type": "string", "pattern": FOREIGN });
        json!({ "anyOf": [ClassifierKind::schema(), provided, CommandKeys::schema()] })
    }
}

named!(ClassifierKind);

/// Features in a study file: their name, or `name@version` of features that the running program provides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureChoice(pub Features);

impl Serialize for FeatureChoice {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        with_version(&self.0, serializer)
    }
}

/// Writes features as in a study file: their name, with the version of features from outside of this program.
///
/// # Errors
/// If the serialiser fails.
pub fn with_version<S: Serializer>(
    features: &Features,
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    serializer.serialize_str(&features.text())
}

impl<'de> Deserialize<'de> for FeatureChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let features = match foreign::Foreign::named(&text) {
            Some(foreign) => Ok(Features::Foreign(foreign)),
            None => Features::try_from(text),
        };
        features.map(Self).map_err(de::Error::custom)
    }
}

impl Described for FeatureChoice {
    fn schema() -> Value {
        let of_measurements = [
            Features::Raw,
            Features::Centred,
            Features::UnitNorm,
            Features::CentredUnitNorm,
        ];
        let of_images: Vec<&str> = ImageFeature::ALL.iter().map(|one| one.name()).collect();
        let one = of_images.join("|");
        let names = of_measurements.map(String::from).into_iter();
        let names: Vec<String> = names
            .chain(of_images.into_iter().map(str::to_owned))
            .collect();
        json!({ "anyOf": [
            { "anyOf": [
                { "type": "string", "enum": names },
                { "title": "several image features joined by `+`", "type": "string", "pattern": format!(r"^\s*({one})\s*(\+\s*({one})\s*)+$") },
            ] },
            { "title": "`name@version` of features that the running program provides", "type": "string", "pattern": FOREIGN },
        ] })
    }
}

impl RecognitionSpec {
    /// Returns the kinds of classifiers of the study.
    pub fn kinds(&self) -> Vec<ClassifierKind> {
        let choices = self.classifier.values();
        let kind = |choice: &ClassifierChoice| match choice.kind() {
            ClassifierKind::Foreign(foreign) => {
                ClassifierKind::Foreign(foreign.with(&self.parameters_of(foreign.name())))
            }
            kind => kind,
        };
        choices.iter().map(kind).collect()
    }

    /// Returns the features of the study.
    pub fn all_features(&self) -> Vec<Features> {
        let choices = self.features.values().into_iter();
        let features = |FeatureChoice(features)| match features {
            Features::Foreign(foreign) => {
                Features::Foreign(foreign.with(&self.parameters_of(foreign.name())))
            }
            features => features,
        };
        choices.map(features).collect()
    }

    /// Returns the values that the study gives to parameters of a classifier or of features from outside of this program.
    fn parameters_of(&self, name: &str) -> serde_json::Map<String, Value> {
        let values = self.parameters.get(name).into_iter().flatten();
        let value = |value| serde_json::to_value(value).expect("every TOML value has a JSON form");
        values
            .map(|(name, one)| (name.clone(), value(one)))
            .collect()
    }

    /// Adds the classifiers and features that this thread provides and the study does not name.
    pub(crate) fn add_given(&mut self) {
        let mut kinds = self.classifier.values();
        for foreign in Foreign::given() {
            let given = ClassifierKind::Foreign(foreign);
            if !kinds.iter().any(|choice| choice.kind() == given) {
                kinds.push(ClassifierChoice::Kind(given));
                self.classifier = Axis::Many(kinds.clone());
            }
        }
        let mut features = self.features.values();
        for foreign in foreign::Foreign::given() {
            let given = FeatureChoice(Features::Foreign(foreign));
            if !features.contains(&given) {
                features.push(given);
                self.features = Axis::Many(features.clone());
            }
        }
    }

    /// Provides the code of the classifiers that are commands.
    pub(crate) fn install_commands(&self) {
        for choice in self.classifier.values() {
            if let ClassifierChoice::Command(CommandSpec { keys, foreign }) = choice {
                foreign.install(Arc::new(CommandClassifier {
                    name: foreign.name(),
                    command: keys.command,
                    time_limit: keys.time_limit_s.map(Duration::from_secs_f64),
                }));
            }
        }
    }
}
