//! A study of speed against accuracy that can run: every key checked, every unit SI.

use super::spec::{
    ContactSpec, RecognitionSweepSpec, ResolutionSpec, ScansSpec, SpeedAccuracyStudySpec,
};
use crate::error::Result;
use crate::study::axis::Axis;
use crate::study::check::{Check, not_negative, positive};
use crate::study::plan::MM;
use crate::study::spec::SkinSpec;
use crate::world::{Patch, Placement};
use std::path::{Path, PathBuf};

/// Settings of such a study, ready to run.
#[derive(Clone, Debug)]
pub struct SpeedAccuracyPlan {
    /// As it was written.
    pub spec: SpeedAccuracyStudySpec,
    /// The study's file, for errors.
    pub place: String,
    /// The array of the part on contact.
    pub patch: Patch,
    /// How touches are drawn, as many an object as a part asks for.
    pub placement: Placement,
    /// Levels of detail, coarsest first.
    pub levels: Vec<Tolerance>,
    /// The part on contact.
    pub contact: Option<ContactPlan>,
    /// The part on recognition.
    pub recognition: Option<RecognitionSweep>,
    /// The part on what studies resolve.
    pub resolution: Option<ResolutionPlan>,
}

/// How far spheres may be from a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// As it was written.
    pub mm: f64,
    /// Metres.
    pub metres: f64,
}

/// The part on contact.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPlan {
    /// As it was written.
    pub spec: ContactSpec,
    /// Time steps, seconds.
    pub dts: Vec<f64>,
    /// Where the rows of other programs are.
    pub peers: Option<PathBuf>,
}

/// The part on recognition.
#[derive(Clone, Debug)]
pub struct RecognitionSweep {
    /// As it was written.
    pub spec: RecognitionSweepSpec,
    /// An array a pitch.
    pub patches: Vec<Patch>,
    /// Levels of detail, coarsest first.
    pub levels: Vec<Tolerance>,
}

/// The part on what studies resolve.
#[derive(Clone, Debug)]
pub struct ResolutionPlan {
    /// As it was written.
    pub spec: ResolutionSpec,
}

impl SpeedAccuracyPlan {
    /// What is touched beside the objects in the part on contact, if anything is.
    pub fn scans(&self) -> Option<&ScansSpec> {
        self.contact.as_ref()?.spec.scans.as_ref()
    }

    /// Checks a study that lies in `folder`; the error names `place` (the file) and the first key that is out of its range.
    pub fn new(place: &str, folder: &Path, mut spec: SpeedAccuracyStudySpec) -> Result<Self> {
        let check = Check { place };
        check.objects(&spec.objects)?;
        if spec.objects.model.is_some() || spec.objects.surface_error_mm.is_some() {
            let allowed = "no such key: speed_accuracy.tolerances_mm says how detailed objects are";
            return Err(check.error(
                "objects.model or objects.surface_error_mm",
                "a value",
                allowed,
            ));
        }
        let patch = check.one_array(&spec.skin, "one pitch and one size")?;
        spec.objects.settle_sizes(&[patch]);
        let placement = check.placement(&spec.touches)?;
        let wanted = &spec.speed_accuracy;
        let levels = tolerances(
            &check,
            "speed_accuracy.tolerances_mm",
            &wanted.tolerances_mm,
        )?;
        let contact = wanted.contact.as_ref();
        let contact = contact.map(|contact| check_contact(&check, folder, contact));
        let sweep = wanted.recognition.as_ref();
        let sweep = sweep.map(|sweep| check_recognition(&check, &spec.skin, &levels, sweep));
        let resolution = wanted.resolution.as_ref();
        let resolution = resolution.map(|resolution| check_resolution(&check, resolution));
        let contact = contact.transpose()?;
        let recognition = sweep.transpose()?;
        let resolution = resolution.transpose()?;
        if contact.is_none() && recognition.is_none() && resolution.is_none() {
            let allowed = "at least one of the tables contact, recognition, resolution";
            return Err(check.error("speed_accuracy", "no part", allowed));
        }
        Ok(Self {
            place: place.to_owned(),
            patch,
            placement,
            levels,
            contact,
            recognition,
            resolution,
            spec,
        })
    }
}

fn tolerances(check: &Check, key: &str, written: &[f64]) -> Result<Vec<Tolerance>> {
    let mut written = check.list(key, written.to_vec())?;
    for &mm in &written {
        check.value(key, mm, positive, "positive numbers of millimetres")?;
    }
    written.sort_by(|a, b| b.total_cmp(a));
    let metres = |mm: f64| Tolerance {
        mm,
        metres: mm * MM,
    };
    Ok(written.into_iter().map(metres).collect())
}

fn check_contact(check: &Check, folder: &Path, spec: &ContactSpec) -> Result<ContactPlan> {
    let key = |name: &str| format!("speed_accuracy.contact.{name}");
    for (name, count) in [
        ("objects", spec.objects),
        ("touches", spec.touches),
        ("stepped_objects", spec.stepped_objects),
        ("stepped_touches", spec.stepped_touches),
    ] {
        check.positive_count(&key(name), count)?;
    }
    if let Some(scans) = &spec.scans {
        check.list(&key("scans.names"), scans.names.clone())?;
    }
    let dts = Axis::Many(spec.dt_ms.clone());
    let dts = check.axis(&key("dt_ms"), &dts, positive, "positive numbers")?;
    Ok(ContactPlan {
        dts: dts.iter().map(|ms| 1e-3 * ms).collect(),
        peers: spec.peers.as_ref().map(|path| folder.join(path)),
        spec: spec.clone(),
    })
}

fn check_recognition(
    check: &Check,
    skin: &SkinSpec,
    all_levels: &[Tolerance],
    spec: &RecognitionSweepSpec,
) -> Result<RecognitionSweep> {
    let key = |name: &str| format!("speed_accuracy.recognition.{name}");
    for (name, count) in [
        ("training_touches", spec.training_touches),
        ("test_touches", spec.test_touches),
        ("timed_touches", spec.timed_touches),
    ] {
        check.positive_count(&key(name), count)?;
    }
    if spec.objects < 2 {
        return Err(check.error(&key("objects"), spec.objects, "at least 2 to tell apart"));
    }
    let levels = tolerances(check, &key("tolerances_mm"), &spec.tolerances_mm)?;
    if let Some(level) = levels.iter().find(|level| !all_levels.contains(level)) {
        let allowed = "values of speed_accuracy.tolerances_mm";
        return Err(check.error(&key("tolerances_mm"), level.mm, allowed));
    }
    check.list(&key("ensemble"), spec.ensemble.clone())?;
    check.list(&key("classifier"), spec.classifier.clone())?;
    let noise = spec.noise_std_full_scale;
    check.value(
        &key("noise_std_full_scale"),
        noise,
        not_negative,
        "0 or more",
    )?;
    let arrays = SkinSpec {
        pitch_mm: Axis::Many(spec.pitch_mm.clone()),
        size_mm: Some(Axis::One(spec.size_mm)),
        taxels: None,
        taxel_radius_mm: None,
        ..skin.clone()
    };
    let patches = check.arrays(&arrays)?;
    let fewest = patches.iter().map(|patch| patch.grid.n_taxels()).min();
    let fewest = fewest.unwrap_or(1) as f64;
    let ratios = check.list(&key("ratio"), spec.ratio.clone())?;
    if let Some(ratio) = ratios.iter().find(|&&r| !(1.0..=fewest).contains(&r)) {
        let allowed = format!("1 to {fewest}, the taxels of the coarsest array");
        return Err(check.error(&key("ratio"), ratio, allowed));
    }
    Ok(RecognitionSweep {
        spec: spec.clone(),
        patches,
        levels,
    })
}

fn check_resolution(check: &Check, spec: &ResolutionSpec) -> Result<ResolutionPlan> {
    let key = |name: &str| format!("speed_accuracy.resolution.{name}");
    let touches = Axis::Many(spec.touches.clone());
    let trials = Axis::Many(spec.trials.clone());
    // Fewer leave no test touch in a quarter of them.
    if let Some(few) = check
        .counts(&key("touches"), &touches)?
        .iter()
        .find(|&&n| n < 4)
    {
        return Err(check.error(&key("touches"), few, "at least 4: a quarter of them test"));
    }
    if let Some(few) = check
        .counts(&key("trials"), &trials)?
        .iter()
        .find(|&&n| n < 2)
    {
        return Err(check.error(&key("trials"), few, "at least 2: one trial has no spread"));
    }
    let [a, b] = spec.ratio;
    if !(a >= 1.0 && b >= 1.0 && a.is_finite() && b.is_finite()) || a == b {
        return Err(check.error(
            &key("ratio"),
            format!("{a}, {b}"),
            "two different ratios from 1 on",
        ));
    }
    Ok(ResolutionPlan { spec: spec.clone() })
}
