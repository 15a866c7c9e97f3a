//! Sample touches for the eye: what the array feels of a few objects, noise included.

use super::measurement::rates_of;
use super::plan::{Plan, millimetres};
use super::runner::signal_steps;
use super::simulation::TouchedObject;
use super::sweep::{Group, Sweep};
use crate::contact::{Workspace, press_to_depth};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::signal::{Chain, Quantity, Scratch, SignalStep};
use crate::world::Scene;
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
}

/// The first touch of the objects that the study names for its picture (else of four spread over its list), read with its
/// finest array at its highest noise, before smoothing.
pub fn sample_frames(plan: &Plan, sweep: &Sweep, touched: &[TouchedObject]) -> Result<Samples> {
    let group = loudest_group(plan, sweep)
        .ok_or_else(|| Error::input("study", "no cells", "at least one value an axis"))?;
    let patch = plan.arrays[group.array];
    let steps: Vec<SignalStep> = signal_steps(plan, group)
        .into_iter()
        .filter(|step| !matches!(step, SignalStep::Smoothing { .. }))
        .collect();
    let chain = Chain::new(&steps, &patch)?;
    let seed = Seed::new(plan.spec.seed).named("signal").numbered(0);
    let (mut workspace, mut scratch) = (Workspace::new(), Scratch::default());
    let (mut frames, mut rates) = (Vec::new(), Vec::new());
    for object in chosen(plan, touched)? {
        let touch = &object.touches[0];
        let scene = Scene::of_one(&patch, &object.object.model);
        let pose = touch.patch_from_object(&object.rests[touch.rest]);
        press_to_depth(&scene, &[pose], touch.depth, &mut workspace);
        let mut frame = workspace.deflections().to_vec();
        let touch_seed = seed.named(&object.object.name).numbered(0);
        let rate = rates_of(&frame, &patch.taxel, plan.speed, &mut rates);
        chain.apply(&mut frame, rate, &touch_seed, &mut scratch);
        let frame = Array2::from_shape_vec((patch.grid.ny, patch.grid.nx), frame)
            .expect("one value a taxel");
        frames.push((object.object.name.replace('_', " "), frame));
    }
    let pitch_mm = millimetres(patch.grid.pitch);
    let noise = match group.noise {
        0.0 => "no noise".to_owned(),
        level => format!("noise of {}", plan.describe_noise(level)),
    };
    Ok(Samples {
        frames,
        pitch_mm,
        quantity: chain.quantity(),
        caption: format!(
            "One touch each on {} × {} taxels at {pitch_mm} mm, {noise}",
            patch.grid.nx, patch.grid.ny
        ),
    })
}

/// The group with the most taxels and, among those, the most noise.
fn loudest_group<'a>(plan: &Plan, sweep: &'a Sweep) -> Option<&'a Group> {
    sweep.groups.iter().max_by(|a, b| {
        let key = |g: &Group| (plan.arrays[g.array].grid.n_taxels() as f64, g.noise);
        key(a)
            .partial_cmp(&key(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    })
}

fn chosen<'a>(plan: &Plan, touched: &'a [TouchedObject]) -> Result<Vec<&'a TouchedObject>> {
    if let Some(names) = &plan.spec.report.samples {
        return names
            .iter()
            .map(|name| {
                touched
                    .iter()
                    .find(|t| t.object.name == *name)
                    .ok_or_else(|| {
                        Error::input("key report.samples", name, "names of the study's objects")
                    })
            })
            .collect();
    }
    let n = N_SAMPLES.min(touched.len());
    Ok((0..n).map(|k| &touched[k * touched.len() / n]).collect())
}
