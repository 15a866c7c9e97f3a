//! Configuration of a recognition study: one value for every axis. The parameters of a configuration are the first columns of a row of results.
//!
//! [`RowInputs`] are those parameters that determine the features of its touches; [`by_condition`] groups configurations by their external settings.

use crate::doc_of;
use crate::inputs::sensor_errors::{Strengths, strength_columns};
use crate::learning::data::temporal_features::TemporalFeatures;
use crate::learning::evaluation::next_touch::NextTouch;
use crate::studies::prelude::*;
use crate::studies::recognition::spec::{key, with_version};
use crate::table::{Column, Columns, Role, Scale};
use bubbletouch_sim::features::{Features, Join};
use serde::Serializer;
use serde::ser::SerializeStruct;

/// Declares a configuration: each parameter has a type, the form of its column, and the key or the words that describe it. The struct, its columns and its
/// format in files are generated from this list, in its order.
///
/// | form | columns |
/// |---|---|
/// | `always` | one in the tables of every study |
/// | `if_given` | one if the study sets the key |
/// | `each` | one for each of the strengths that the study sets |
/// | `each_axis` | one for each axis of `[axes]`, which the study describes |
/// | `hidden` | none, because the parameter is derived from others |
macro_rules! configuration {
    ($(#[$of_cell:meta])* pub struct $configuration:ident {
        $($(#[$($of_field:tt)*])* $field:ident: $type:ty => $form:ident $(($($words:tt)*))? $(of $key:literal)?;)*
    }) => {
        $(#[$of_cell])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $configuration {
            $($(#[$($of_field)*])* pub $field: $type,)*
        }

        impl Serialize for $configuration {
            fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
                let n_fields = [$(stringify!($field)),*].len() + self.variant.values.len();
                let mut row = serializer.serialize_struct("Configuration", n_fields)?;
                $(configuration!(@write $form, row, stringify!($field), &self.$field);)*
                row.end()
            }
        }

        impl $configuration {
            /// Returns whether a column of its own shows the values of a key.
            pub(crate) fn shows(key: &str) -> bool {
                // The number of taxels is shown along x and y.
                [$($($key,)?)* "skin.taxels"].contains(&key)
            }
        }

        /// Returns the columns of the result tables that describe a configuration, except the columns of axes declared in `[axes]`.
        impl Columns for $configuration {
            fn columns() -> Vec<Column> {
                let mut columns = Vec::new();
                $(
                    let of_field = configuration!(@columns $form, stringify!($field) $(, ($($words)*))? $(, $key)?);
                    let meaning = doc_of!($(#[$($of_field)*])*);
                    columns.extend(of_field.into_iter().map(|column: Column| match column.meaning.is_empty() {
                        true => column.meaning(meaning),
                        false => column,
                    }));
                )*
                columns
            }
        }
    };
    (@write always, $row:ident, $name:expr, $value:expr) => {
        $row.serialize_field($name, $value)?
    };
    (@write if_given, $row:ident, $name:expr, $value:expr) => {
        if let Some(value) = $value {
            $row.serialize_field($name, value)?;
        }
    };
    (@write hidden, $row:ident, $name:expr, $value:expr) => {};
    (@write $each:ident, $row:ident, $name:expr, $value:expr) => {
        for (name, value) in $value.cells() {
            $row.serialize_field(name, &value)?;
        }
    };
    (@columns always, $name:expr, $how:tt) => { [configuration!(@column $name, $how)] };
    (@columns if_given, $name:expr, $how:tt) => { [configuration!(@column $name, $how).optional()] };
    (@columns each, $name:expr) => { strength_columns().to_vec() };
    (@columns $none:ident, $name:expr) => { None };
    (@column $name:expr, ($role:ident, $words:literal, $unit:literal, $scale:ident)) => {
        Column::new($name, Role::$role, $words, $unit, Scale::$scale)
    };
    (@column $name:expr, $key:literal) => { key($key).column($name) };
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
    strengths: Strengths => each;
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
            n_copies: self.n_copies(),
        }
    }

    /// Returns the number of tilted copies of each training touch.
    pub fn n_copies(&self) -> usize {
        self.tilt_augmentation.unwrap_or(0)
    }

    /// Returns an error if the running program does not provide the features of the configuration.
    pub(crate) fn check_features(&self) -> Result<()> {
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

/// Inputs that determine how features are computed from the measurements of a touch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RowInputs {
    /// Numbers of rows and columns of the images that represent frames, one for each sensor.
    pub image_shapes: Vec<ImageShape>,
    /// Number of values of a measured frame: m measurements, or one value per taxel if the ensemble gives frames.
    pub measurements: usize,
    /// Number F of frames per touch.
    pub frames: usize,
    /// Method that combines the frames of a touch into features; `None` if the frames are concatenated.
    pub temporal_features: Option<TemporalFeatures>,
    /// Features that are computed from the measurements of a frame.
    #[serde(serialize_with = "with_version")]
    pub features: Features,
    /// Depth window of image features, as a fraction of the full scale; `None` for no window. Image features use only deflections that are within the window
    /// below the largest deflection of a frame.
    pub depth_window_full_scale: Option<f64>,
    /// Number of tilted copies that are added for each training touch.
    pub n_copies: usize,
}

impl RowInputs {
    /// Returns the description of the image features; `None` if the features are computed from measurements.
    pub fn of_images(&self) -> Option<FeaturesOfImages> {
        Some(FeaturesOfImages {
            join: self.features.of_image()?,
            foremost: self.depth_window_full_scale,
            measurements: self.measurements,
        })
    }

    /// Returns the number of features per frame.
    pub fn n_frame_features(&self) -> usize {
        match self.features.of_image() {
            Some(join) => join_values(join, &self.image_shapes),
            None => self
                .features
                .n_values(self.measurements, ImageShape::row(1)),
        }
    }

    /// Returns the number of features per touch.
    pub fn n_features(&self) -> usize {
        let (n_frames, m) = (self.frames, self.n_frame_features());
        self.temporal_features
            .map_or(n_frames * m, |kind| kind.n_features(n_frames, m))
    }
}

/// Image features that the configurations of a group need.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FeaturesOfImages {
    /// Kinds of image features whose values are concatenated into one feature vector.
    pub join: Join,
    /// Depth window of the features, as a fraction of the full scale; `None` for the whole image. The features use only deflections that are within the window
    /// below the largest deflection of a frame.
    pub foremost: Option<f64>,
    /// Number of measurements from which the images of frames are estimated.
    pub measurements: usize,
}

/// Returns the number of values of a combination of image features for a frame. The frame has one image for each sensor, given as numbers of rows and
/// columns.
pub fn join_values(join: Join, shapes: &[ImageShape]) -> usize {
    shapes.iter().map(|&shape| join.n_values(shape)).sum()
}

/// Returns a table with the settings of the given configurations, without scores.
///
/// # Errors
/// If a configuration cannot be written as a row of a table.
pub fn settings_of(configurations: &[&Configuration]) -> Result<Table> {
    let axes = configurations
        .first()
        .map(|configuration| configuration.variant.values.iter());
    let axes = axes.into_iter().flatten();
    let axes = axes.map(|axis| axis.column.clone().optional());
    let columns = Configuration::columns().into_iter().chain(axes).collect();
    File::<Configuration>::new("configurations.csv", "Configurations", "")
        .of_columns(columns, configurations)
}

/// Returns the indices of the configurations under each condition, which is a combination of external settings such as noise. The conditions are in the order
/// of first occurrence.
///
/// # Errors
/// If [`settings_of`] fails.
pub fn by_condition<'a>(
    configurations: impl IntoIterator<Item = &'a Configuration>,
) -> Result<Vec<Vec<usize>>> {
    let configurations = settings_of(&configurations.into_iter().collect::<Vec<_>>())?;
    Ok(configurations.groups(
        &configurations.of_role(Role::Condition),
        0..configurations.n_rows,
    ))
}

/// Returns the index of the highest accuracy; if several are equal, the first index. Returns `None` if there are no accuracies.
pub fn most_accurate(accuracies: impl IntoIterator<Item = (usize, f64)>) -> Option<usize> {
    let better = |best: (usize, f64), other: (usize, f64)| match other.1 > best.1 {
        true => other,
        false => best,
    };
    let best = accuracies.into_iter().reduce(better);
    best.map(|(place, _)| place)
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

    #[test]
    fn cells_that_differ_in_choices_alone_share_a_condition() {
        let mut configurations = vec![configuration(); 6];
        configurations[1].measurements = 16;
        configurations[2].noise_std = 0.0;
        configurations[3].smoothing_mm = 4.0;
        for configuration in &mut configurations {
            configuration.test_sensor = Some(TestSensor::SameSkin);
        }
        configurations[4].test_sensor = Some(TestSensor::AnotherSkin);
        let alike = by_condition(&configurations).unwrap();
        assert_eq!(alike, [vec![0, 1, 3, 5], vec![2], vec![4]]);
    }
}
