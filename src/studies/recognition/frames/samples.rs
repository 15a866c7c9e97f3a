//! Sample pictures, which show noisy readings of an array for a few objects.

use crate::engine::axes::CombineSpec;
use crate::inputs::sensor_errors::strength_columns;
use crate::report::pictures::snapshots::Snapshots;
use crate::signal::{Chain, SensorError, SignalStep, Strength};
use crate::studies::prelude::*;
use crate::studies::recognition::frames::{
    ReadSkin, Reading, Samples, TouchSet, measure, simulate_array, touches_to_read,
};
use crate::studies::recognition::plan::skin;
use ndarray::{Array2, ArrayView1};

/// Default number of objects that a sample picture shows.
const N_SAMPLES: usize = 4;

/// Returns the sample pictures of a study. The first picture shows the first touch of the objects that the study lists, by default of four spread over the
/// list. The array reads them at the highest noise, without smoothing. In a study of one sensor error at a time, the picture shows the first touch
/// of the first object with each error at its last value. On a skin with memory, each touch follows the touch of the last object. A second picture shows
/// the first touch of every object at the highest noise.
///
/// # Errors
/// If a signal step is invalid.
pub fn sample_frames(
    plan: &Plan,
    groups: &[MeasurementGroup],
    touched: &[TouchedObject],
) -> Result<Samples> {
    let group = loudest_group(groups)
        .ok_or_else(|| Error::input("study", "no configurations", "at least one value an axis"))?;
    let on = &plan.array;
    let names: Vec<&str> = touched.iter().map(|t| t.object.name.as_str()).collect();
    let chosen = spread_samples(plan, &names)?;
    let before = chosen.last().copied().unwrap_or(0);
    let name = |label: usize| names[label].replace('_', " ");
    let array = on.describe_taxels();
    let quantity = chains(plan, group)?[0].quantity();
    let noise = match group.condition.noise {
        0.0 => "no noise".to_owned(),
        level => format!("noise of {}", plan.describe_noise(level)),
    };
    let each = read(plan, group, (touched, before))?;
    let set = |frames, caption| Snapshots {
        frames,
        pitch_mm: on.picture_pitch_mm(),
        quantity,
        caption,
    };
    let each = set(
        (0..names.len()).map(name).zip(each).collect(),
        format!("One touch each on {array}, {noise}"),
    );
    let groups = imperfect_groups(plan, groups);
    let shown = match chosen.first() {
        Some(&first) if !groups.is_empty() => {
            // The full scale limits the colours, because one taxel with a large gain would dominate them.
            let full_scale = quantity.full_scale(on.taxel());
            let shown = groups.into_iter().map(|(words, group)| {
                let frame = read(plan, group, (touched, before))?.swap_remove(first);
                Ok((words, frame.mapv_into(|value| value.min(full_scale))))
            });
            let remembers =
                |step: &StepSpec| matches!(step, StepSpec::Error(error) if error.about().remembers);
            let after = match plan.spec.signal.steps.iter().any(remembers) {
                true => format!(", after one of the {},", name(before)),
                false => String::new(),
            };
            let first = name(first);
            let caption =
                format!("A touch of the {first}{after} on {array}; colours end at the full scale");
            set(shown.collect::<Result<_>>()?, caption)
        }
        _ => {
            let frames = chosen.iter().map(|&label| each.frames[label].clone());
            set(frames.collect(), each.caption.clone())
        }
    };
    let each = Some(each);
    Ok(Samples { shown, each })
}

/// Returns the readings along the taxel axes in the first touch of each object: one array of shape (ny, nx) per object. If the skin has memory, the touch
/// of another object precedes each touch.
fn read(
    plan: &Plan,
    group: &MeasurementGroup,
    (touched, before): (&[TouchedObject], usize),
) -> Result<Vec<Array2<f64>>> {
    let array = &plan.array;
    let seed = Seed::new(plan.spec.seed);
    let first = |t: &TouchedObject| TouchedObject {
        touches: t.touches[..1].to_vec(),
        ..t.clone()
    };
    let firsts: Vec<TouchedObject> = touched.iter().map(first).collect();
    let frames = simulate_array(&firsts, array, 1, &Silent);
    let mut touches = touches_to_read(firsts.classes(), &seed.named("signal").numbered(0));
    for touch in &mut touches {
        touch.before = Some(before);
    }
    let skin = ReadSkin {
        chains: chains(plan, group)?,
        array,
        speed: plan.speed,
        frames: &frames,
    };
    let reading = Reading {
        skins: &[skin],
        projection: &Projection::new(
            Ensemble::Identity,
            array.frame_shape(),
            array.n_values(),
            &seed,
        )?,
    };
    let (values, _) = measure(reading, &touches)?;
    let configurations = array.picture_cells();
    let frame =
        |row: ArrayView1<f64>| configurations.mapv(|taxel| taxel.map_or(0.0, |taxel| row[taxel]));
    Ok(values.outer_iter().map(frame).collect())
}

/// Returns a signal chain for each channel, without the smoothing step. Smoothing would hide the effect of the other steps.
fn chains(plan: &Plan, group: &MeasurementGroup) -> Result<Vec<Chain>> {
    let array = &plan.array;
    let skin = skin(&Seed::new(plan.spec.seed), array);
    array.chains(&skin, |skin| {
        let mut steps = group.signal(plan).steps(skin);
        steps.retain(|step| !matches!(step, SignalStep::Smoothing { .. }));
        steps
    })
}

/// Returns the groups of configurations to show, each with a title, for a study that varies one sensor error at a time. The first group has the first value of
/// each error. For each error, the group with its last value follows. Scan errors are omitted, because they do not change a touch that is read once.
fn imperfect_groups<'a>(
    plan: &Plan,
    groups: &'a [MeasurementGroup],
) -> Vec<(String, &'a MeasurementGroup)> {
    let signal = &plan.spec.signal;
    if signal.combine != CombineSpec::OneAtATime {
        return Vec::new();
    }
    let mut chosen = Vec::new();
    for (key, _, axis) in signal.axes.given() {
        let Some(column) = strength_columns().iter().find(|c| c.name == *key) else {
            continue;
        };
        let values = axis.values();
        let last = *values.last().unwrap_or(&0.0);
        let shows = |(error, own, value): (SensorError, &Strength, f64)| {
            own.key == *key && value == last && !error.about().needs_motion
        };
        let has_it = |group: &&MeasurementGroup| group.condition.strengths.given().any(shows);
        if let Some(group) = groups.iter().find(has_it)
            && values.len() > 1
        {
            chosen.push((column.phrase(&last.into()), group));
        }
    }
    if let (Some(first), false) = (groups.first(), chosen.is_empty()) {
        let condition = &first.condition;
        let is_ideal = condition.noise == 0.0 && condition.strengths.present().count() == 0;
        let words = if is_ideal { "ideal" } else { "first values" };
        chosen.insert(0, (words.to_owned(), first));
    }
    chosen
}

/// Returns the group of configurations with the largest noise.
fn loudest_group(groups: &[MeasurementGroup]) -> Option<&MeasurementGroup> {
    let groups = groups.iter();
    groups.max_by(|a, b| a.condition.noise.total_cmp(&b.condition.noise))
}

/// Returns the class labels that the sample picture shows: the classes listed in the study, or four classes spread over all classes.
///
/// # Errors
/// If [`named_samples`] fails.
pub(crate) fn spread_samples(plan: &Plan, classes: &[&str]) -> Result<Vec<usize>> {
    let n = N_SAMPLES.min(classes.len());
    let spread = || (0..n).map(|k| k * classes.len() / n).collect();
    Ok(named_samples(plan, classes)?.unwrap_or_else(spread))
}

/// Returns the class labels that the study lists for its sample picture; `None` if it lists none.
///
/// # Errors
/// If a listed name is not a class.
pub(crate) fn named_samples(plan: &Plan, classes: &[&str]) -> Result<Option<Vec<usize>>> {
    let label = |name: &String| {
        let found = classes.iter().position(|class| class == name);
        found.ok_or_else(|| {
            let allowed = format!("of what the study tells apart: {}", classes.join(", "));
            Error::input("key report.samples", name, allowed)
        })
    };
    let names = plan.spec.report.samples.as_ref();
    names
        .map(|names| names.iter().map(label).collect())
        .transpose()
}
