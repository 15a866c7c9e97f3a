//! A study of speed against accuracy that can run: every key checked, every unit SI.

use super::spec::{
    ContactSpec, RecognitionSweepSpec, ResolutionSpec, ScansSpec, SpeedAccuracySpec,
    SpeedAccuracyStudySpec,
};
use crate::error::Result;
use crate::study::axis::Axis;
use crate::study::check::{Check, not_negative, positive};
use crate::study::plan::MOST_TRIALS;
use crate::study::spec::{ObjectsSpec, SkinSpec};
use crate::world::{MOST_TOUCHES, Patch, Placement};
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
    /// Levels of detail, mm, coarsest first.
    pub levels: Vec<f64>,
    /// Where the rows of other programs on contact are.
    pub peers: Option<PathBuf>,
    /// The part on recognition.
    pub recognition: Option<RecognitionSweep>,
}

/// The part on recognition.
#[derive(Clone, Debug)]
pub struct RecognitionSweep {
    /// As it was written.
    pub spec: RecognitionSweepSpec,
    /// An array a pitch.
    pub patches: Vec<Patch>,
    /// Levels of detail, mm, coarsest first.
    pub levels: Vec<f64>,
}

impl SpeedAccuracyPlan {
    /// What is swept.
    pub fn parts(&self) -> &SpeedAccuracySpec {
        &self.spec.speed_accuracy
    }

    /// What is touched beside the objects in the part on contact, if anything is.
    pub fn scans(&self) -> Option<&ScansSpec> {
        self.parts().contact.as_ref()?.scans.as_ref()
    }

    /// The same as objects; none where their folder is not.
    pub fn scanned(&self) -> Option<ObjectsSpec> {
        let scans = self.scans().filter(|scans| scans.meshes.is_dir())?;
        Some(ObjectsSpec {
            meshes: Some(scans.meshes.clone()),
            names: Some(scans.names.clone()),
            unit: self.spec.objects.unit,
            sizes: self.spec.objects.sizes,
            ..ObjectsSpec::default()
        })
    }

    /// Checks a study that lies in `folder`; the error names `place` (the file) and the first key that is out of its range.
    pub fn new(place: &str, folder: &Path, mut spec: SpeedAccuracyStudySpec) -> Result<Self> {
        let check = Check { place };
        check.objects(&spec.objects)?;
        if spec.objects.model.is_some() || spec.objects.surface_error_mm.is_some() {
            let keys = "objects.model or objects.surface_error_mm";
            let allowed = "no such key: speed_accuracy.tolerances_mm says how detailed objects are";
            return Err(check.error(keys, "a value", allowed));
        }
        let patch = check.one_array(&spec.skin, "one pitch and one size")?;
        spec.objects.settle_sizes(&[patch]);
        let placement = check.placement(&spec.touches)?;
        let wanted = &spec.speed_accuracy;
        let key = "speed_accuracy.tolerances_mm";
        let levels = tolerances(&check, key, &wanted.tolerances_mm)?;
        let contact = wanted.contact.as_ref();
        contact.map_or(Ok(()), |contact| check_contact(&check, contact))?;
        let sweep = wanted.recognition.as_ref();
        let sweep = sweep.map(|sweep| check_recognition(&check, &spec.skin, &levels, sweep));
        let resolution = wanted.resolution.as_ref();
        resolution.map_or(Ok(()), |resolution| check_resolution(&check, resolution))?;
        if contact.is_none() && sweep.is_none() && resolution.is_none() {
            let allowed = "at least one of the tables contact, recognition, resolution";
            return Err(check.error("speed_accuracy", "no part", allowed));
        }
        let peers = contact.and_then(|contact| contact.peers.as_ref());
        Ok(Self {
            place: place.to_owned(),
            patch,
            placement,
            peers: peers.map(|path| folder.join(path)),
            recognition: sweep.transpose()?,
            levels,
            spec,
        })
    }
}

/// Levels of detail, coarsest first.
fn tolerances(check: &Check, key: &str, written: &[f64]) -> Result<Vec<f64>> {
    let axis = Axis::Many(written.to_vec());
    let mut levels = check.axis(key, &axis, positive, "positive numbers of millimetres")?;
    levels.sort_by(|a, b| b.total_cmp(a));
    Ok(levels)
}

fn check_contact(check: &Check, spec: &ContactSpec) -> Result<()> {
    let key = |name: &str| format!("speed_accuracy.contact.{name}");
    for (name, count) in [
        ("objects", spec.objects),
        ("touches", spec.touches),
        ("stepped_objects", spec.stepped_objects),
        ("stepped_touches", spec.stepped_touches),
    ] {
        check.count(&key(name), count, MOST_TOUCHES)?;
    }
    if let Some(scans) = &spec.scans {
        check.list(&key("scans.names"), scans.names.clone())?;
    }
    let dts = Axis::Many(spec.dt_ms.clone());
    check.axis(&key("dt_ms"), &dts, positive, "positive numbers")?;
    Ok(())
}

fn check_recognition(
    check: &Check,
    skin: &SkinSpec,
    all_levels: &[f64],
    spec: &RecognitionSweepSpec,
) -> Result<RecognitionSweep> {
    let key = |name: &str| format!("speed_accuracy.recognition.{name}");
    for (name, count) in [
        ("training_touches", spec.training_touches),
        ("test_touches", spec.test_touches),
        ("timed_touches", spec.timed_touches),
    ] {
        check.count(&key(name), count, MOST_TOUCHES)?;
    }
    if spec.objects < 2 {
        return Err(check.error(&key("objects"), spec.objects, "at least 2 to tell apart"));
    }
    let levels = tolerances(check, &key("tolerances_mm"), &spec.tolerances_mm)?;
    if let Some(level) = levels.iter().find(|level| !all_levels.contains(level)) {
        let allowed = "values of speed_accuracy.tolerances_mm";
        return Err(check.error(&key("tolerances_mm"), level, allowed));
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
    let patches = check.arrays(&SkinSpec {
        pitch_mm: Axis::Many(spec.pitch_mm.clone()),
        size_mm: Some(Axis::One(spec.size_mm)),
        taxels: None,
        taxel_radius_mm: None,
        ..skin.clone()
    })?;
    let fewest = patches.iter().map(|patch| patch.grid.n_taxels()).min();
    let fewest = fewest.unwrap_or(1) as f64;
    let ratios = check.list(&key("ratio"), spec.ratio.clone())?;
    if let Some(ratio) = ratios.iter().find(|&&r| !(1.0..=fewest).contains(&r)) {
        let allowed = format!("1 to {fewest}, the taxels of the coarsest array");
        return Err(check.error(&key("ratio"), ratio, allowed));
    }
    let axes = [
        patches.len(),
        levels.len(),
        spec.ensemble.len(),
        ratios.len(),
        spec.classifier.len(),
    ];
    check.configurations(axes.iter().map(|&n| n as f64).product())?;
    // Of two objects, the fewest, as they are and in one detail, before they are compressed; with more it takes more.
    let n_touches = spec.training_touches + spec.test_touches;
    let bytes = 4.0 * n_touches as f64 * fewest;
    let what = "the frames of all touches";
    check.memory(&key("training_touches"), n_touches, bytes, what)?;
    Ok(RecognitionSweep {
        spec: spec.clone(),
        patches,
        levels,
    })
}

fn check_resolution(check: &Check, spec: &ResolutionSpec) -> Result<()> {
    let key = |name: &str| format!("speed_accuracy.resolution.{name}");
    for (name, counts, (least, why), most) in [
        // Fewer leave no test touch in a quarter of them.
        (
            "touches",
            &spec.touches,
            (4, "a quarter of them test"),
            MOST_TOUCHES,
        ),
        (
            "trials",
            &spec.trials,
            (2, "one trial has no spread"),
            MOST_TRIALS,
        ),
    ] {
        for count in check.list(&key(name), counts.clone())? {
            check.count(&key(name), count, most)?;
            if count < least {
                return Err(check.error(&key(name), count, format!("at least {least}: {why}")));
            }
        }
    }
    let [a, b] = spec.ratio;
    let is_ratio = |ratio: f64| ratio >= 1.0 && ratio.is_finite();
    if !(is_ratio(a) && is_ratio(b)) || a == b {
        let allowed = "two different ratios from 1 on";
        return Err(check.error(&key("ratio"), format!("{a}, {b}"), allowed));
    }
    Ok(())
}
