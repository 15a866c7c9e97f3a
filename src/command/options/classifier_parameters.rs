//! Command-line options of `bubbletouch classify` for the parameters that classifiers declare, such as `--n-trees` and `--gamma`.

use bubbletouch::Result;
use bubbletouch::recognition::classifiers::classifier::Classifier;
use bubbletouch::recognition::classifiers::parameters::{DefaultValue, Parameter, declared};
use std::sync::LazyLock;

/// Values of the command-line options that are given, in the order of their declaration.
pub struct ParameterOptions(Vec<(&'static Parameter, GivenValue)>);

/// Value of a command-line option: a number, or `None` for the classifier's default rule.
type GivenValue = Option<f64>;

/// Parameters of all classifiers, each with the name of its command-line option.
static OPTIONS: LazyLock<Vec<(String, &Parameter)>> = LazyLock::new(|| {
    let option = |one: &'static Parameter| (one.key.replace('_', "-"), one);
    declared().map(option).collect()
});

impl ParameterOptions {
    /// Returns whether the command-line option of a parameter is given.
    pub fn has(&self, key: &str) -> bool {
        self.0.iter().any(|(parameter, _)| parameter.key == key)
    }

    /// Returns a copy of the classifier in which the options' values are set.
    ///
    /// # Errors
    /// If the classifier has no such parameter, or if a value is out of its range.
    pub fn applied_to(&self, classifier: Classifier) -> Result<Classifier> {
        let numbers = self
            .0
            .iter()
            .filter_map(|(one, value)| Some((one, (*value)?)));
        numbers
            .map(|(one, value)| (one.key, value))
            .try_fold(classifier, |classifier, (key, value)| {
                Ok(classifier.with(key, value)?)
            })
    }
}

/// Parses a parameter value: a number, or the name of the default rule, which gives `None`.
fn value(parameter: &Parameter, text: &str) -> std::result::Result<GivenValue, String> {
    let kind = match parameter.is_integer {
        true => "a whole number",
        false => "a number",
    };
    let number = || match parameter.is_integer {
        true => text.parse::<u64>().map(|n| n as f64).ok(),
        false => text.parse().ok(),
    };
    match (parameter.default, number()) {
        (_, Some(number)) => Ok(Some(number)),
        (DefaultValue::Rule(rule, _), _) if text == rule => Ok(None),
        (DefaultValue::Rule(rule, _), _) => Err(format!("expected {kind}, or {rule}")),
        (DefaultValue::Number(_), _) => Err(format!("expected {kind}")),
    }
}

impl clap::Args for ParameterOptions {
    fn augment_args(command: clap::Command) -> clap::Command {
        let arg = |(option, one): &'static (String, &'static Parameter)| {
            let default = match one.default {
                DefaultValue::Number(number) => number.to_string(),
                DefaultValue::Rule(rule, _) => rule.to_owned(),
            };
            let help = format!("Set the {} [default: {default}]", one.words);
            let long_help = match one.default {
                DefaultValue::Number(_) => help.clone(),
                DefaultValue::Rule(rule, meaning) => format!("{help}\n\n{rule}: {meaning}."),
            };
            let arg = clap::Arg::new(one.key).long(option.as_str());
            arg.value_name(if one.is_integer { "N" } else { "X" })
                .help(help)
                .long_help(long_help)
                .help_heading("Classifier")
                .value_parser(move |text: &str| value(one, text))
        };
        command.args(OPTIONS.iter().map(arg))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for ParameterOptions {
    fn from_arg_matches(matches: &clap::ArgMatches) -> std::result::Result<Self, clap::Error> {
        let given = |one: &'static Parameter| {
            let value = matches.get_one::<GivenValue>(one.key)?;
            Some((one, *value))
        };
        Ok(Self(declared().filter_map(given).collect()))
    }

    fn update_from_arg_matches(
        &mut self,
        matches: &clap::ArgMatches,
    ) -> std::result::Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
