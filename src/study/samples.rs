//! Sample touches for the eye: what the array feels of a few objects, noise included.

use super::measurement::rates_of;
use super::measurement::signal_steps;
use super::plan::{Plan, millimetres};
use super::sensor_errors::{skin, strength_columns};
use super::simulation::TouchedObject;
use super::spec::{CombineSpec, StepSpec};
use super::sweep::{Group, Sweep};
use crate::contact::{Workspace, press_to_depth};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::signal::{Chain, Quantity, Recording, Scratch, SensorError, SignalStep, Strength};
use crate::world::{Patch, Scene};
use ndarray::Array2;

/// How many objects a picture of samples shows when the study names none.
const N_SAMPLES: usize = 4;

/// Frames of the first touch of some objects.
#[derive(Clone, Debug)]
pub struct Samples {
    /// Object names and frames (ny × nx), metres or newtons.
    pub frames: Vec<(String, Array2<f64>)>,
    /// Millimetres between taxels.
    pub pitch_mm: f64,
    /// Whether the frames are forces.
    pub quantity: Quantity,
    /// What they show.
    pub caption: String,
    /// One touch of each object, if `frames` show some objects only; empty if they show something else.
    pub each: Vec<(String, Array2<f64>)>,
    /// What those show.
    pub each_caption: String,
}

/// The first touch of the objects that the study names for its picture (else of four spread over its list), read with its
/// finest array at its highest noise, before smoothing; in a study of one imperfection at a time, the first touch of the first
/// of them, read with each imperfection at its last value. A skin that remembers was touched by the last of them before. Beside them the
/// first touch of every object, at the highest noise.
pub fn sample_frames(plan: &Plan, sweep: &Sweep, touched: &[TouchedObject]) -> Result<Samples> {
    let group = loudest_group(plan, sweep)
        .ok_or_else(|| Error::input("study", "no cells", "at least one value an axis"))?;
    let patch = &plan.arrays[group.array];
    let objects = chosen(plan, touched)?;
    let before = objects.last().copied().unwrap_or(&touched[0]);
    let grid = &patch.grid;
    let pitch_mm = millimetres(grid.pitch);
    let array = format!("{} × {} taxels at {pitch_mm} mm", grid.nx, grid.ny);
    let name = |object: &TouchedObject| object.object.name.replace('_', " ");
    let quantity = Chain::new(&steps(plan, group), patch)?.quantity();
    let mut frames = Vec::new();
    let groups = imperfect_groups(plan, sweep, group.array);
    let noise = match group.condition.noise {
        0.0 => "no noise".to_owned(),
        level => format!("noise of {}", plan.describe_noise(level)),
    };
    let each_caption = format!("One touch each on {array}, {noise}");
    let caption = match objects.first() {
        Some(first) if !groups.is_empty() => {
            // One taxel of a large gain would take the colours of all others.
            let full_scale = quantity.full_scale(&patch.taxel);
            for (words, group) in groups {
                let mut frame = read(plan, group, first, before)?;
                frame.mapv_inplace(|value| value.min(full_scale));
                frames.push((words, frame));
            }
            let remembers =
                |step: &StepSpec| matches!(step, StepSpec::Error(error) if error.about().remembers);
            let after = match plan.spec.signal.steps.iter().any(remembers) {
                true => format!(", after one of the {},", name(before)),
                false => String::new(),
            };
            let first = name(first);
            format!("A touch of the {first}{after} on {array}; colours end at the full scale")
        }
        _ => {
            for object in objects {
                frames.push((name(object), read(plan, group, object, before)?));
            }
            each_caption.clone()
        }
    };
    let each = touched.iter();
    let each = each.map(|object| Ok((name(object), read(plan, group, object, before)?)));
    let each = each.collect::<Result<_>>()?;
    Ok(Samples {
        frames,
        pitch_mm,
        quantity,
        caption,
        each,
        each_caption,
    })
}

/// What an array of a group reads of an object's first touch, ny × nx; a skin that remembers was touched by another before.
fn read(
    plan: &Plan,
    group: &Group,
    object: &TouchedObject,
    before: &TouchedObject,
) -> Result<Array2<f64>> {
    let patch = plan.arrays[group.array];
    let chain = Chain::new(&steps(plan, group), &patch)?;
    let n_taxels = patch.grid.n_taxels();
    let mut frames = Vec::new();
    if chain.remembers() {
        frames.extend(press(&patch, before));
        frames.resize(2 * n_taxels, 0.0);
    }
    let n_before = frames.len() / n_taxels;
    frames.extend(press(&patch, object));
    let seed = Seed::new(plan.spec.seed).named("signal").numbered(0);
    let seed = seed.named(&object.object.name).numbered(0);
    let mut rates = Vec::new();
    let rates = rates_of(&frames, &patch.taxel, plan.speed, &mut rates);
    let recording = Recording {
        frames: &mut frames,
        rates,
        n_before,
        interval: None,
    };
    chain.apply_recording(recording, &seed, &mut Scratch::default());
    let frame = frames.split_off(n_before * n_taxels);
    let frame =
        Array2::from_shape_vec((patch.grid.ny, patch.grid.nx), frame).expect("one value a taxel");
    Ok(frame)
}

/// The deflections of an object's first touch.
fn press(patch: &Patch, object: &TouchedObject) -> Vec<f64> {
    let touch = &object.touches[0];
    let scene = Scene::of_one(patch, &object.object.model);
    let pose = touch.patch_from_object(&object.rests[touch.rest]);
    let mut workspace = Workspace::new();
    press_to_depth(&scene, &[pose], touch.depth, &mut workspace);
    workspace.deflections().to_vec()
}

/// The signal's steps but for smoothing, which hides what it is there to hide.
fn steps(plan: &Plan, group: &Group) -> Vec<SignalStep> {
    let skin = skin(&Seed::new(plan.spec.seed), &plan.arrays[group.array].grid);
    let mut steps = signal_steps(plan, group, &skin);
    steps.retain(|step| !matches!(step, SignalStep::Smoothing { .. }));
    steps
}

/// In a study of one sensor error at a time: the first group of an array, then for each error the group that has it at
/// its last value, with what to call them. A scan is left out: it does not change a touch that is read once.
fn imperfect_groups<'a>(plan: &Plan, sweep: &'a Sweep, array: usize) -> Vec<(String, &'a Group)> {
    let signal = &plan.spec.signal;
    if signal.combine != CombineSpec::OneAtATime {
        return Vec::new();
    }
    let groups = || sweep.groups.iter().filter(|group| group.array == array);
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
        let has_it = |group: &&Group| group.condition.strengths.given().any(shows);
        if let Some(group) = groups().find(has_it)
            && values.len() > 1
        {
            chosen.push((column.phrase(&last.into()), group));
        }
    }
    if let (Some(first), false) = (groups().next(), chosen.is_empty()) {
        let condition = &first.condition;
        let is_ideal = condition.noise == 0.0 && condition.strengths.present().count() == 0;
        let words = if is_ideal { "ideal" } else { "first values" };
        chosen.insert(0, (words.to_owned(), first));
    }
    chosen
}

/// The group with the most taxels and, among those, the most noise.
fn loudest_group<'a>(plan: &Plan, sweep: &'a Sweep) -> Option<&'a Group> {
    sweep.groups.iter().max_by(|a, b| {
        let key = |g: &Group| {
            (
                plan.arrays[g.array].grid.n_taxels() as f64,
                g.condition.noise,
            )
        };
        key(a)
            .partial_cmp(&key(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    })
}

/// Labels of those that the study names for its picture; `None` where it names none.
///
/// # Errors
/// A name of none of these classes.
pub(super) fn named_samples(plan: &Plan, classes: &[&str]) -> Result<Option<Vec<usize>>> {
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

fn chosen<'a>(plan: &Plan, touched: &'a [TouchedObject]) -> Result<Vec<&'a TouchedObject>> {
    let names: Vec<&str> = touched.iter().map(|t| t.object.name.as_str()).collect();
    if let Some(labels) = named_samples(plan, &names)? {
        return Ok(labels.into_iter().map(|label| &touched[label]).collect());
    }
    let n = N_SAMPLES.min(touched.len());
    Ok((0..n).map(|k| &touched[k * touched.len() / n]).collect())
}
