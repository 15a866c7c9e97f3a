//! Classifiers and features of a study, including those from outside of this program.

use crate::engine::axis::Axis;
use crate::learning::classifiers::ClassifierKind;
use crate::learning::classifiers::foreign::Foreign;
use crate::learning::command_classifier::CommandClassifier;
use crate::studies::recognition::spec::foreign::{ClassifierChoice, CommandSpec, FeatureChoice};
use crate::studies::recognition::spec::study::RecognitionSpec;
use bubbletouch_sim::features::{Features, foreign};
use serde_json::Value;
use std::sync::Arc;
use std::time::Duration;

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
