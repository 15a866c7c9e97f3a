//! Checks of `[sensing]` and `[recognition]`: compression, features, classifiers and splits.

use crate::learning::classifiers::classifier::Classifier;
use crate::learning::data::temporal_features::TemporalFeatures;
use crate::learning::evaluation::next_touch::NextTouch;
use crate::studies::prelude::*;
use crate::studies::recognition::plan::KeepTogether;
use crate::studies::recognition::spec::{
    DEFAULT_C, DEFAULT_CV_FOLDS, DEFAULT_TEST_FRACTION, DEFAULT_TILT_DEG, RecognitionSpec,
    SensingSpec,
};

impl Check<'_> {
    /// Checks that `[sensing]` contains either a compression ratio or a number of measurements. The number may not exceed the number of taxels of the array.
    pub(crate) fn sensing(&self, sensing: &SensingSpec, array: &TaxelArray) -> Result<()> {
        self.table("sensing", sensing)?;
        let ratios = sensing.ratio.iter().flat_map(Axis::values);
        let ratios = ratios.map(|ratio| ("sensing.ratio", ratio));
        let counts = sensing.measurements.iter().flat_map(Axis::values);
        let counts = counts.map(|m| ("sensing.measurements", m as f64));
        let n_values = array.n_values();
        if let Some((key, given)) = ratios.chain(counts).find(|(_, n)| *n > n_values as f64) {
            let allowed = format!("at most {n_values}, the numbers of the smallest frame");
            return Err(self.error(key, given, allowed));
        }
        let mut ensembles = sensing.ensemble.values().into_iter();
        let of_rows = ensembles.find(|ensemble| ensemble.about().needs_rows);
        if let Some(ensemble) = of_rows
            && array.equal_images().is_none()
        {
            let given = format!("{} of {}", ensemble.about().words, array.layout_words());
            let mut allowed = "ensembles that need no rows and columns".to_owned();
            if array.image_shapes().len() > 1 {
                allowed += ", or sensors of equal rows and columns";
            }
            return Err(self.error("sensing.ensemble", given, allowed));
        }
        if let Some(ensemble) = of_rows {
            let (n_images, _) = array.measured_images(ensemble);
            let counts = sensing.measurements_on(n_values);
            if let Some(m) = counts.into_iter().find(|&m| m < n_images) {
                let given = format!("{m} measurements of {n_images} images");
                let allowed = format!("at least {n_images}, one for each kind of value");
                return Err(self.error(sensing.count_key(), given, allowed));
            }
        }
        Ok(())
    }

    /// Returns an error if an ensemble must be learned from frames but the study has no training frames.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn drawn(&self, key: &str, ensembles: impl IntoIterator<Item = Ensemble>) -> Result<()> {
        let mut ensembles = ensembles.into_iter();
        match ensembles.find(|ensemble| !ensemble.is_drawn()) {
            None => Ok(()),
            Some(learned) => {
                let given = learned.about().words;
                let allowed = "ensembles that are drawn: studies that recognise objects from touches alone learn one";
                Err(self.error(key, given, allowed))
            }
        }
    }

    /// Checks `[recognition]`: keys must be in range, and the solver must be able to train every SVM.
    pub(crate) fn recognition(&self, recognition: &RecognitionSpec) -> Result<()> {
        self.table("recognition", recognition)?;
        let kinds = recognition.kinds();
        self.list(
            "recognition.classifier",
            kinds.iter().map(|kind| kind.about().words).collect(),
        )?;
        let features = recognition.all_features();
        let of_classifiers = kinds.iter().filter_map(|kind| match kind {
            ClassifierKind::Foreign(own) => {
                Some((own.name(), own.check_parameters().map_err(Error::from)))
            }
            _ => None,
        });
        let of_features = features.iter().filter_map(|features| features.foreign());
        let of_features = of_features.map(|own| (own.name(), own.check_parameters()));
        let own: Vec<_> = of_classifiers.chain(of_features).collect();
        for name in recognition.parameters.keys() {
            if !own.iter().any(|(own, _)| own == name) {
                let key = format!("recognition.parameters.{name}");
                let given =
                    "given, but the study has no classifier or features of your own with this name";
                let allowed =
                    "names of your own; parameters of other classifiers are keys of [recognition]";
                return Err(self.error(&key, given, allowed));
            }
        }
        for (name, checked) in own {
            let key = format!("{}, key recognition.parameters.{name}: ", self.place);
            checked.map_err(|error| error.under(key))?;
        }
        for kind in kinds {
            let classifier = Classifier {
                solver: recognition.solver,
                multiclass: recognition.multiclass,
                ..Classifier::new(kind)
            };
            let place = format!("{}, key recognition.", self.place);
            classifier
                .check_solver()
                .map_err(|error| Error::from(error).under(place))?;
        }
        Ok(())
    }

    /// Checks that each taxel reads a single value if a study uses image features.
    pub(crate) fn images(&self, recognition: &RecognitionSpec, array: &TaxelArray) -> Result<()> {
        let mut features = recognition.all_features().into_iter();
        let Some(features) = features.find(|features| features.of_image().is_some()) else {
            return Ok(());
        };
        if !array.is_placed() {
            let given = format!("{} of taxels without a layout", String::from(features));
            let allowed = "features of measurements (raw, centred, unit_norm, centred_unit_norm): \
                           those of images need positions (recorded.layout, or rows and columns by recorded.grid or recorded.order)";
            return Err(self.error("recognition.features", given, allowed));
        }
        if array.image_shapes().len() > 1 && recognition.has_copies() {
            let given = format!("tilted copies of {}", array.layout_words());
            let allowed = "no such key: each sensor has a tilt of its own";
            return Err(self.error("recognition.tilt_augmentation", given, allowed));
        }
        match array.sensed().n_channels() {
            ..=1 => Ok(()),
            _ => {
                let given = format!("{} of shear", String::from(features));
                let allowed = "features of measurements (raw, centred, unit_norm, centred_unit_norm): \
                               those of images need one value a taxel";
                Err(self.error("recognition.features", given, allowed))
            }
        }
    }

    /// Checks the key `temporal_features`; it is not allowed if it requires more frames than a touch has.
    pub(crate) fn over_time(&self, recognition: &RecognitionSpec, frames: &[usize]) -> Result<()> {
        let fewest = frames.iter().copied().min().unwrap_or(0);
        for value in recognition.temporal_features.iter().flat_map(Axis::values) {
            if let TemporalFeatures::Stacked(k) = value
                && k > fewest
            {
                let allowed = format!("at most {fewest}, the frames of a touch");
                return Err(self.error(
                    "recognition.temporal_features",
                    String::from(value),
                    allowed,
                ));
            }
        }
        Ok(())
    }
}

impl SensingSpec {
    /// Returns the key that gives the numbers of measurements.
    pub fn count_key(&self) -> &'static str {
        match self.measurements {
            Some(_) => "sensing.measurements",
            None => "sensing.ratio",
        }
    }

    /// Returns the methods of selection for an ensemble; the single value `None` if the ensemble selects no taxels.
    pub fn selections(&self, ensemble: Ensemble) -> Vec<Option<Selection>> {
        match (ensemble, &self.selection) {
            (Ensemble::Selected, None) => vec![Some(Selection::default())],
            (Ensemble::Selected, axis) => Axis::optional_values(axis),
            _ => vec![None],
        }
    }

    /// Returns whether an ensemble of the study selects taxels.
    pub(crate) fn selects_taxels(&self) -> bool {
        self.ensemble.values().contains(&Ensemble::Selected)
    }

    /// Returns the numbers m of measurements for an array of `n_taxels`, each at least 1. If neither a ratio nor a number is given, the only number is
    /// `n_taxels`.
    pub fn measurements_on(&self, n_taxels: usize) -> Vec<usize> {
        let of_ratio = |ratio: f64| ((n_taxels as f64 / ratio).round() as usize).max(1);
        match (&self.ratio, &self.measurements) {
            (Some(ratios), _) => ratios.values().into_iter().map(of_ratio).collect(),
            (None, Some(counts)) => counts.values(),
            (None, None) => vec![n_taxels],
        }
    }
}

impl RecognitionSpec {
    /// Returns whether some features are of images.
    pub(crate) fn has_images(&self) -> bool {
        let mut features = self.all_features().into_iter();
        features.any(|features| features.of_image().is_some())
    }

    /// Returns whether some features combine the frames of a touch in another way than by the deepest one.
    pub(crate) fn combines_frames(&self) -> bool {
        let values = Axis::optional_values(&self.temporal_features);
        values != [Some(TemporalFeatures::Deepest)]
    }

    /// Returns whether training touches have tilted copies for some value of the key `tilt_augmentation`.
    pub fn has_copies(&self) -> bool {
        let numbers = self.tilt_augmentation.iter().flat_map(Axis::values);
        numbers.into_iter().any(|n| n > 0)
    }

    /// Returns the fraction of the touches that is held out for testing if the study has no folds; the default is 0.25.
    pub fn test_share(&self) -> f64 {
        self.test_fraction.unwrap_or(DEFAULT_TEST_FRACTION)
    }

    /// Returns the rules for the next touch that do not choose it at random.
    pub fn chosen_next(&self) -> impl Iterator<Item = NextTouch> {
        let all = self.next_touch.iter().flat_map(Axis::values);
        all.filter(|next| *next != NextTouch::Random)
    }

    /// Returns whether C or γ is chosen by cross-validation.
    pub fn is_open(&self) -> bool {
        self.c_grid.is_some() || self.gamma_grid.is_some()
    }

    /// Returns whether a rule for the next touch uses the classifier's decisions on training touches.
    pub fn is_informed(&self) -> bool {
        let mut chosen = self.chosen_next();
        chosen.any(|next| next == NextTouch::MostInformative)
    }

    /// Returns the maximum tilt of a tilted copy of a touch about each axis, radians.
    pub fn copies_tilt(&self) -> f64 {
        self.tilt_augmentation_deg
            .unwrap_or(DEFAULT_TILT_DEG)
            .to_radians()
    }

    /// Returns the number of folds of the inner cross-validation, which selects C and γ; the default is 5.
    pub fn n_choice_folds(&self) -> usize {
        self.cv_folds.unwrap_or(DEFAULT_CV_FOLDS as usize)
    }

    /// Returns the rule that forms groups of touches; all touches of a group are on one side of a split (training or test).
    pub fn kept_together(&self) -> Option<KeepTogether> {
        Some(KeepTogether {
            kind: self.group_by.or(self.split.group())?,
            metres: self.group_by_mm.map(|mm| MM * mm),
            radians: self.group_by_deg.map(f64::to_radians),
        })
    }

    /// Returns the values of C for classifiers that have a penalty C. A value of `None` means that C is chosen by cross-validation.
    pub fn penalties(&self) -> Vec<Option<f64>> {
        match (&self.c, &self.c_grid) {
            (_, Some(_)) => vec![None],
            (None, None) => vec![Some(DEFAULT_C)],
            (axis, None) => Axis::optional_values(axis),
        }
    }
}
