//! A study of speed against accuracy that can run: every key checked, every unit SI.

use super::spec::{RecognitionSweepSpec, ScansSpec, SpeedAccuracySpec, SpeedAccuracyStudySpec};
use crate::error::Result;
use crate::study::axis::Axis;
use crate::study::check::{Check, NOISE, Range, SURFACE_ERROR, TOUCHES};
use crate::study::spec::{ObjectsSpec, SkinSpec};
use crate::study::taxel_array::TaxelArray;
use crate::world::{MOST_TOUCHES, Placement};
use std::path::{Path, PathBuf};

/// Settings of such a study, ready to run.
#[derive(Clone, Debug)]
pub struct SpeedAccuracyPlan {
    /// As it was written.
    pub spec: SpeedAccuracyStudySpec,
    /// The array of the part on contact.
    pub array: TaxelArray,
    /// How touches are drawn, as many an object as a part asks for.
    pub placement: Placement,
    /// Levels of detail, mm, coarsest first.
    pub levels: Vec<f64>,
    /// Where the rows of other programs on contact are.
    pub peers: Option<PathBuf>,
    /// The arrays of the part on recognition, one a pitch.
    pub arrays: Vec<TaxelArray>,
}

/// What the numbers of `[speed_accuracy]` may be.
const KEYS: [(&str, Range); 16] = [
    ("tolerances_mm", SURFACE_ERROR),
    ("contact.objects", TOUCHES),
    ("contact.touches", TOUCHES),
    ("contact.stepped_objects", TOUCHES),
    ("contact.stepped_touches", TOUCHES),
    ("contact.scans.names", Range::Any),
    ("contact.dt_ms", Range::Positive),
    ("recognition.training_touches", TOUCHES),
    ("recognition.test_touches", TOUCHES),
    ("recognition.timed_touches", TOUCHES),
    ("recognition.objects", Range::Count(2, MOST_TOUCHES)),
    ("recognition.tolerances_mm", SURFACE_ERROR),
    ("recognition.ensemble", Range::Any),
    ("recognition.classifier", Range::Any),
    ("recognition.noise_std_full_scale", NOISE),
    ("recognition.ratio", Range::AtLeastOne),
];

impl SpeedAccuracyPlan {
    /// What is swept.
    pub fn parts(&self) -> &SpeedAccuracySpec {
        &self.spec.speed_accuracy
    }

    /// What is touched beside the objects in the part on contact, if anything is.
    pub fn scans(&self) -> Option<&ScansSpec> {
        self.parts().contact.as_ref()?.scans.as_ref()
    }

    /// So many touches of each object.
    pub(super) fn placement_of(&self, per_object: usize) -> Placement {
        Placement {
            per_object: Some(per_object),
            ..self.placement.clone()
        }
    }

    /// The finest level of detail, mm.
    pub(super) fn finest(&self) -> f64 {
        self.levels[self.levels.len() - 1]
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

    /// Checks a study that lies in `folder`.
    ///
    /// # Errors
    /// The error names `place` (the file) and the first key that is out of its range.
    pub fn new(place: &str, folder: &Path, mut spec: SpeedAccuracyStudySpec) -> Result<Self> {
        let check = Check { place };
        check.objects(&spec.objects)?;
        if spec.objects.model.is_some() || spec.objects.surface_error_mm.is_some() {
            let keys = "objects.model or objects.surface_error_mm";
            let allowed = "no such key: speed_accuracy.tolerances_mm says how detailed objects are";
            return Err(check.error(keys, "a value", allowed));
        }
        let array = check.one_array(&spec.skin, "one pitch and one size")?;
        spec.objects.settle_sizes(std::slice::from_ref(&array));
        let placement = check.placement(&spec.touches)?;
        let wanted = &spec.speed_accuracy;
        check.keys("speed_accuracy", wanted, KEYS)?;
        let levels = coarsest_first(&wanted.tolerances_mm);
        let contact = wanted.contact.as_ref();
        let arrays = match &wanted.recognition {
            Some(sweep) => check_recognition(&check, &spec.skin, &levels, sweep)?,
            None => Vec::new(),
        };
        if contact.is_none() && arrays.is_empty() {
            let allowed = "at least one of the tables contact and recognition";
            return Err(check.error("speed_accuracy", "no part", allowed));
        }
        let peers = contact.and_then(|contact| contact.peers.as_ref());
        Ok(Self {
            array,
            placement,
            peers: peers.map(|path| path.within(folder)),
            arrays,
            levels,
            spec,
        })
    }
}

/// Levels of detail, coarsest first.
pub(super) fn coarsest_first(levels: &[f64]) -> Vec<f64> {
    let mut levels = levels.to_vec();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels
}

/// Checks what the part on recognition sweeps, and makes its arrays.
fn check_recognition(
    check: &Check,
    skin: &SkinSpec,
    all_levels: &[f64],
    spec: &RecognitionSweepSpec,
) -> Result<Vec<TaxelArray>> {
    let key = |name: &str| format!("speed_accuracy.recognition.{name}");
    let mut levels = spec.tolerances_mm.iter();
    if let Some(level) = levels.find(|level| !all_levels.contains(level)) {
        let allowed = "values of speed_accuracy.tolerances_mm";
        return Err(check.error(&key("tolerances_mm"), level, allowed));
    }
    check.drawn(&key("ensemble"), spec.ensemble.iter().copied())?;
    let arrays = check.grids(&SkinSpec {
        pitch_mm: Axis::Many(spec.pitch_mm.clone()),
        size_mm: Some(Axis::One(spec.size_mm)),
        taxels: None,
        taxel_radius_mm: None,
        ..skin.clone()
    })?;
    let fewest = arrays.iter().map(TaxelArray::n_taxels).min();
    let fewest = fewest.unwrap_or(1) as f64;
    if let Some(ratio) = spec.ratio.iter().find(|&&ratio| ratio > fewest) {
        let allowed = format!("1 to {fewest}, the taxels of the coarsest array");
        return Err(check.error(&key("ratio"), ratio, allowed));
    }
    let axes = [
        arrays.len(),
        spec.tolerances_mm.len(),
        spec.ensemble.len(),
        spec.ratio.len(),
        spec.classifier.len(),
    ];
    check.configurations(axes.iter().map(|&n| n as f64).product())?;
    // Of two objects, the fewest, as they are and in one detail, before they are compressed; with more it takes more.
    let n_touches = spec.n_touches();
    let bytes = 4.0 * n_touches as f64 * fewest;
    let what = "the frames of all touches";
    check.memory(&key("training_touches"), n_touches, bytes, what)?;
    Ok(arrays)
}
