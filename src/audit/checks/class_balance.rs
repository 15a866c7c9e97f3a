//! Numbers of touches of the classes, and classes that differ in their spelling alone.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result};
use crate::audit::finding::percent;
use crate::audit::splits::touches_of_classes;
use crate::inputs::arrays::whole_numbers::spellings;
use crate::table::short_number;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

/// Minimum relevant ratio between the numbers of touches of the largest and the smallest class.
const RELEVANT: f64 = 1.5;
/// Significance level of the test against classes of equal frequency.
const SIGNIFICANT: f64 = 0.01;
/// Minimum number of touches of a class for training and tests in five folds.
const MIN_TOUCHES: usize = 10;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "class_balance",
    title: "Class balance",
    run,
};

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let classes = touches_of_classes(&context.labels);
    let name = |class: usize| context.data.classes[class].clone();
    let sizes: Vec<(usize, String)> = classes
        .iter()
        .map(|(&class, touches)| (touches.len(), name(class)))
        .collect();
    let expected = context.labels.len() as f64 / sizes.len() as f64;
    let statistic: f64 = sizes
        .iter()
        .map(|(size, _)| (*size as f64 - expected).powi(2) / expected)
        .sum();
    let (Some(least), Some(largest)) = (sizes.iter().min(), sizes.iter().max()) else {
        return Ok(Vec::new());
    };
    let n_classes = sizes.len() as f64;
    let n = context.labels.len() as u64;
    let chi_squared = ChiSquared::new(n_classes - 1.0).map_or(1.0, |of| of.sf(statistic));
    // The size of a single small or large class has more power than the χ² test of all classes.
    let tails = Binomial::new(1.0 / n_classes, n).map_or([1.0; 2], |of| {
        [of.cdf(least.0 as u64), of.sf(largest.0 as u64 - 1)]
    });
    let tails = n_classes * tails[0].min(tails[1]);
    let p_value = (2.0 * chi_squared.min(tails)).min(1.0);
    let ratio = largest.0 as f64 / least.0 as f64;
    let sentence = format!(
        "The largest class ({}) has {} touches, the smallest ({}) {}: {} times fewer. Always naming the largest class gives {}.",
        largest.1,
        largest.0,
        least.1,
        least.0,
        short_number(ratio),
        percent(context.chance())
    );
    // The imbalance of these data is a fact. The test only excludes differences that random labels of equal frequency would have.
    let spelled = spellings(context.data.classes.iter().map(String::as_str));
    // Classes of several spellings are not classes that were recorded.
    let is_fault = ratio >= RELEVANT && p_value <= SIGNIFICANT && spelled.is_none();
    let balance = Finding::counted("", ratio, sentence, is_fault)
        .about("ratio")
        .against(1.0)
        .advice("Report the mean accuracy over classes, or draw as many touches of each class.")
        .shown_in("classes");
    let few: Vec<&str> = sizes
        .iter()
        .filter(|(size, _)| *size < MIN_TOUCHES)
        .map(|(_, name)| &name[..])
        .collect();
    let sentence = match few.is_empty() {
        true => format!("Each class has at least {MIN_TOUCHES} touches."),
        false => format!(
            "{} of {} classes have fewer than {MIN_TOUCHES} touches, such as {}.",
            few.len(),
            sizes.len(),
            few[0]
        ),
    };
    let few = Finding::counted("", few.len() as f64, sentence, !few.is_empty())
        .about("small classes")
        .against(0.0)
        .advice("Record more touches of these classes, or leave the classes out.")
        .shown_in("classes");
    let spelled = spelled.map(|names| {
        let quoted: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
        let sentence = format!(
            "The labels {} differ only by case or spaces, and count as {} classes.",
            quoted.join(", "),
            names.len()
        );
        Finding::counted("", names.len() as f64, sentence, true)
            .about("spellings")
            .against(1.0)
            .advice("Give all touches of a class one label.")
            .shown_in("classes")
    });
    Ok([balance, few].into_iter().chain(spelled).collect())
}
