//! Configuration of a recognition study: one value for every axis. The parameters of a configuration are the first columns of a row of results.

use crate::doc_of;
use crate::engine::axes::AxisValues;
use crate::inputs::sensor_errors::{Strengths, TestSensor, strength_columns};
use crate::learning::classifiers::ClassifierKind;
use crate::learning::data::temporal_features::TemporalFeatures;
use crate::learning::evaluation::next_touch::NextTouch;
use crate::sensing::{Ensemble, Selection};
use crate::signal::NoiseUnit;
use crate::studies::recognition::rows::{FeaturesOfImages, RowInputs};
use crate::studies::recognition::spec::key;
use crate::table::{Column, Columns, Role, Scale};
use crate::world::ImageShape;
use bubbletouch_sim::features::Features;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// Declares a configuration: each parameter has a type, a condition for the existence of its column, and the key or column that describes it. The struct, the
/// columns and the file format are generated from this list, in its order.
macro_rules! configuration {
    ($(#[$of_cell:meta])* pub struct $configuration:ident {
        $($(#[$($of_field:tt)*])* $field:ident: $type:ty => $how:ident $(($role:ident, $words:literal, $unit:literal, $scale:ident))? $(of $key:literal)?;)*
    }) => {
        $(#[$of_cell])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $configuration {
            $($(#[$($of_field)*])* pub $field: $type,)*
        }

        impl Serialize for $configuration {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let n_fields = [$(stringify!($field)),*].len() + self.variant.values.len();
                let mut row = serializer.serialize_struct("Configuration", n_fields)?;
                $($how::write(&self.$field, stringify!($field), &mut row)?;)*
                row.end()
            }
        }

        /// Returns the columns of the result tables that describe a configuration, except the columns of axes declared in `[axes]`.
        impl Columns for $configuration {
            fn columns() -> Vec<Column> {
                let mut columns = Vec::new();
                $(
                    #[allow(unused_mut, unused_assignments)]
                    let mut column: Option<Column> = None;
                    $(column = Some(Column::new(stringify!($field), Role::$role, $words, $unit, Scale::$scale));)?
                    $(column = Some(key($key).column(stringify!($field)));)?
                    let column = column.map(|column| column.meaning(doc_of!($(#[$($of_field)*])*)));
                    $how::columns(column, &mut columns);
                )*
                columns
            }
        }
    };
}

configuration! {
/// Configuration of a study, which has one value for every axis.
pub struct Configuration {
    /// Number of the configuration in sweep order, from 0.
    configuration: usize => always (Note, "configuration", "", Linear);
    /// Pitch of the taxels, mm: side of the square area per taxel.
    pitch_mm: f64 => always of "skin.pitch_mm";
    /// Number of columns of taxels in the array (along x).
    nx: usize => always (Note, "taxels along x", "", Linear);
    /// Number of rows of taxels in the array (along y).
    ny: usize => always (Note, "taxels along y", "", Linear);
    /// Number n of values of a frame.
    frame_values: usize => hidden;
    /// Numbers of rows and columns of the images that represent frames of the array, one for each sensor.
    image_shapes: Vec<ImageShape> => hidden;
    /// Side length of the array along x, mm: number of columns times the pitch. For a layout other than a grid, the side length of the square grid with the same
    /// pitch that defines its size.
    size_mm: f64 => always of "skin.size_mm";
    /// Noise standard deviation of a taxel's reading, in `noise_unit`.
    noise_std: f64 => always of "signal.noise_std_full_scale";
    /// Unit of `noise_std`: fraction of full scale, mm or N.
    noise_unit: NoiseUnit => always (Note, "noise unit", "", Words);
    /// Standard deviation of the Gaussian filter that smooths the readings over the array, mm; 0 without smoothing.
    smoothing_mm: f64 => always of "signal.smoothing_mm";
    /// Strength of each sensor error, such as the gain error. The study has one column for each strength that it sets.
    strengths: Strengths => each_strength;
    /// Skin on which the test touches are simulated: the training skin or another one. The column is present only if the study has the key.
    test_sensor: Option<TestSensor> => if_given of "signal.test_sensor";
    /// Ensemble from which the measurement matrix is drawn, such as `gaussian`.
    ensemble: Ensemble => always of "sensing.ensemble";
    /// Method that selects the taxels to read; empty for ensembles that select no taxels. The column is present only if the study has the key.
    selection: Option<Option<Selection>> => if_given of "sensing.selection";
    /// Number m of measurements per frame. An adaptive ensemble reads at most m blocks.
    measurements: usize => always of "sensing.measurements";
    /// Compression ratio n / m, where n is the number of values of a frame and m the number of measurements.
    ratio: f64 => always of "sensing.ratio";
    /// Time to read the m measurements of a frame one after the other, ms. The column is present only if the study has the key `sensing.readings_per_s`.
    readout_ms: Option<f64> => if_given (Cost, "time to read a frame", "ms", Log);
    /// Number F of frames per touch. If the frames are concatenated, a touch has F times the features of a frame.
    frames: usize => always of "touches.frames";
    /// Method that combines the frames of a touch into features, such as `deepest`. The column is present only if the study has the key; without the key,
    /// frames are concatenated.
    temporal_features: Option<TemporalFeatures> => if_given of "recognition.temporal_features";
    /// Features that are computed from the measurements of a touch, such as `raw`.
    features: Features => always of "recognition.features";
    /// Depth window of image features, as a fraction of the full scale. Image features use only deflections within this window below the largest deflection
    /// of a frame. The value is 1 for features of measurements, which have no window. The column is present only if the study has the key.
    depth_window_full_scale: Option<f64> => if_given of "recognition.depth_window_full_scale";
    /// Number of randomly tilted copies that are added for each training touch. The column is present only if the study has the key.
    tilt_augmentation: Option<usize> => if_given of "recognition.tilt_augmentation";
    /// Kind of classifier, such as `linear_svm`.
    classifier: ClassifierKind => always of "recognition.classifier";
    /// Penalty C of the classifier; empty if C is chosen by cross-validation or the classifier has no C.
    c: Option<f64> => always of "recognition.c";
    /// Maximum number of training touches per object in the configuration. Without the key, the smallest number of training touches of an object in any trial;
    /// all training touches are then used.
    train_touches: usize => always of "recognition.train_touches";
    /// Fraction of the training touches that are labelled as another object, 0 to 1. The column is present only if the study has the key.
    mislabelled_fraction: Option<f64> => if_given of "recognition.mislabelled_fraction";
    /// Number of training touches of the most frequent object divided by that of the least frequent object, at least 1. The column is present only if the study
    /// has the key.
    class_imbalance: Option<f64> => if_given of "recognition.class_imbalance";
    /// Number of test touches of an object that are combined into one decision. The scores of the combined touches are added.
    touches_per_decision: usize => always of "recognition.touches_per_decision";
    /// Rule that chooses the touches of a decision after the first touch, such as `random`. The column is present only if the study has the key.
    next_touch: Option<NextTouch> => if_given of "recognition.next_touch";
    /// Values of the further axes in the table `[axes]`, one column per axis.
    variant: AxisValues => each_axis;
} }

impl Configuration {
    /// Returns the inputs that determine the feature rows of the configuration.
    pub fn rows(&self) -> RowInputs {
        let is_of_images = self.features.of_image().is_some();
        RowInputs {
            image_shapes: self.image_shapes.clone(),
            measurements: self
                .ensemble
                .n_measurements(self.measurements, self.frame_values),
            frames: self.frames,
            temporal_features: self.temporal_features,
            features: self.features,
            depth_window_full_scale: self.depth_window_full_scale.filter(|_| is_of_images),
            n_copies: self.tilt_augmentation.unwrap_or(0),
        }
    }

    /// Returns an error if the running program does not provide the features of the configuration.
    pub(crate) fn check_features(&self) -> crate::error::Result<()> {
        match self.features.foreign() {
            Some(foreign) => foreign.n_values(self.measurements).map(drop),
            None => Ok(()),
        }
    }

    /// Returns the image features of the configuration; `None` if its features are not computed from images.
    pub(crate) fn of_images(&self) -> Option<FeaturesOfImages> {
        self.rows().of_images()
    }

    /// Returns the number of features per touch.
    pub fn n_features(&self) -> usize {
        self.rows().n_features()
    }
}

/// Parameters of a configuration with a column in the tables of every study.
mod always {
    use super::*;

    pub fn columns(column: Option<Column>, columns: &mut Vec<Column>) {
        columns.extend(column);
    }

    pub fn write<R: SerializeStruct>(
        value: &impl Serialize,
        name: &'static str,
        row: &mut R,
    ) -> Result<(), R::Error> {
        row.serialize_field(name, value)
    }
}

/// Parameters of a configuration that have a column only if the study sets their key.
mod if_given {
    use super::*;

    pub fn columns(column: Option<Column>, columns: &mut Vec<Column>) {
        columns.extend(column.map(Column::optional));
    }

    pub fn write<R: SerializeStruct>(
        value: &Option<impl Serialize>,
        name: &'static str,
        row: &mut R,
    ) -> Result<(), R::Error> {
        match value {
            Some(value) => row.serialize_field(name, value),
            None => Ok(()),
        }
    }
}

/// Parameters of a configuration that are derived from others and have no column.
mod hidden {
    use super::*;

    pub fn columns(_: Option<Column>, _: &mut Vec<Column>) {}

    pub fn write<T, R: SerializeStruct>(_: &T, _: &str, _: &mut R) -> Result<(), R::Error> {
        Ok(())
    }
}

/// Strengths of sensor errors, with one column for each strength that the study sets.
mod each_strength {
    use super::*;

    pub fn columns(_: Option<Column>, columns: &mut Vec<Column>) {
        columns.extend_from_slice(strength_columns());
    }

    pub fn write<R: SerializeStruct>(
        strengths: &Strengths,
        _: &str,
        row: &mut R,
    ) -> Result<(), R::Error> {
        for (_, strength, value) in strengths.given() {
            match strength.is_whole {
                true => row.serialize_field(strength.key, &(value as u64))?,
                false => row.serialize_field(strength.key, &value)?,
            }
        }
        Ok(())
    }
}

/// Values of the further axes in the table `[axes]`: one column per axis.
mod each_axis {
    use super::*;

    pub fn columns(_: Option<Column>, _: &mut Vec<Column>) {}

    pub fn write<R: SerializeStruct>(
        axes: &AxisValues,
        _: &str,
        row: &mut R,
    ) -> Result<(), R::Error> {
        for axis in axes.values.iter() {
            if let Cow::Borrowed(name) = axis.column.name {
                row.serialize_field(name, &axis.value)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Returns an example configuration for tests: 32 × 32 taxels at 2 mm, compression ratio 16:1.
    pub(crate) fn configuration() -> Configuration {
        Configuration {
            configuration: 0,
            pitch_mm: 2.0,
            nx: 32,
            ny: 32,
            frame_values: 1024,
            image_shapes: vec![ImageShape { ny: 32, nx: 32 }],
            size_mm: 64.0,
            noise_std: 0.1,
            noise_unit: NoiseUnit::FullScale,
            smoothing_mm: 0.0,
            strengths: Strengths::default(),
            test_sensor: None,
            ensemble: Ensemble::Gaussian,
            selection: None,
            measurements: 64,
            ratio: 16.0,
            readout_ms: None,
            frames: 1,
            temporal_features: None,
            features: Features::Raw,
            depth_window_full_scale: None,
            tilt_augmentation: None,
            classifier: ClassifierKind::LinearSvm,
            c: Some(1.0),
            train_touches: 75,
            mislabelled_fraction: None,
            class_imbalance: None,
            touches_per_decision: 1,
            next_touch: None,
            variant: AxisValues::default(),
        }
    }
}
