//! The settings of a cell: every axis of a study at one value. The first columns of a row of results.

use crate::engine::axes::AxisValues;
use crate::inputs::sensor_errors::{Strengths, TestedOn, strength_columns};
use crate::learning::classifiers::ClassifierKind;
use crate::learning::data::over_time::OverTime;
use crate::learning::evaluation::next_touch::NextTouch;
use crate::sensing::Ensemble;
use crate::signal::NoiseUnit;
use crate::studies::recognition::rows::image_features::FeaturesOfImages;
use crate::studies::recognition::rows::row_inputs::RowInputs;
use crate::table::{Column, Columns, Role, Scale};
use bubbletouch_sim::features::Features;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use std::borrow::Cow;

const OVER_TIME: &[(&str, &str)] = &[
    ("", "all frames"),
    ("deepest", "deepest frame"),
    ("summarised", "moments and course"),
];
const CHOSEN: &[(&str, &str)] = &[("", "chosen")];

/// The settings of one cell of a sweep: every axis at one value.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Number of the cell, from 0, in sweep order.
    pub cell: usize,
    /// Millimetres between taxels.
    pub pitch_mm: f64,
    /// Taxel columns.
    pub nx: usize,
    /// Taxel rows.
    pub ny: usize,
    /// Rows and columns of its images.
    pub image_shape: (usize, usize),
    /// Side length of the array along x: nx × pitch.
    pub size_mm: f64,
    /// Noise standard deviation, in `noise_unit`.
    pub noise_std: f64,
    /// What `noise_std` is measured in.
    pub noise_unit: NoiseUnit,
    /// Standard deviation of the Gaussian smoothing, millimetres; 0 for none.
    pub smoothing_mm: f64,
    /// How strong each sensor error is: a column for each strength that the study has.
    pub strengths: Strengths,
    /// The skin that test touches are made with; only if the study has the key.
    pub tested_on: Option<TestedOn>,
    /// How measurements are made.
    pub ensemble: Ensemble,
    /// Measurements a frame, m.
    pub measurements: usize,
    /// Compression ratio n / m.
    pub ratio: f64,
    /// Frames a touch, F: a row of features has F · m values.
    pub frames: usize,
    /// What is made of the frames, if not all of them one after the other; only if the study has the key.
    pub over_time: Option<OverTime>,
    /// What is made of the measurements.
    pub features: Features,
    /// How far behind the foremost point features of images see, as a fraction of the full scale, 1 of all others; only if the study
    /// has the key.
    pub foremost_full_scale: Option<f64>,
    /// Copies of each training touch, tilted at random; only if the study has the key.
    pub tilted_copies: Option<usize>,
    /// Which classifier.
    pub classifier: ClassifierKind,
    /// Soft-margin penalty C; empty when it is chosen by cross-validation, or when the classifier has none.
    pub c: Option<f64>,
    /// Training touches an object, at most.
    pub train_touches: usize,
    /// Fraction of them with another object's label; only if the study has the key.
    pub mislabelled_fraction: Option<f64>,
    /// How many times as many the most frequent object has as the rarest; only if the study has the key.
    pub class_imbalance: Option<f64>,
    /// Test touches of an object that are decided on together, by the sum of their scores.
    pub fused_touches: usize,
    /// How the touches after the first of these are chosen; only if the study has the key.
    pub next_touch: Option<NextTouch>,
    /// Where it is on the study's own axes: a column for each.
    pub variant: AxisValues,
}

/// In the order of its columns; what a study does not have is left out.
impl Serialize for Cell {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let n_fields = Self::columns().len() + self.variant.values.len();
        let mut row = serializer.serialize_struct("Cell", n_fields)?;
        macro_rules! put {
            ($($field:ident),*) => {$(
                row.serialize_field(stringify!($field), &self.$field)?;
            )*};
        }
        macro_rules! put_if_there {
            ($($field:ident),*) => {$(
                if let Some(value) = &self.$field {
                    row.serialize_field(stringify!($field), value)?;
                }
            )*};
        }
        put!(cell, pitch_mm, nx, ny, size_mm);
        put!(noise_std, noise_unit, smoothing_mm);
        for (_, strength, value) in self.strengths.given() {
            match strength.is_whole {
                true => row.serialize_field(strength.key, &(value as u64))?,
                false => row.serialize_field(strength.key, &value)?,
            }
        }
        put_if_there!(tested_on);
        put!(ensemble, measurements, ratio, frames);
        put_if_there!(over_time);
        put!(features);
        put_if_there!(foremost_full_scale, tilted_copies);
        put!(classifier, c, train_touches);
        put_if_there!(mislabelled_fraction, class_imbalance);
        put!(fused_touches);
        put_if_there!(next_touch);
        for axis in self.variant.values.iter() {
            if let Cow::Borrowed(name) = axis.column.name {
                row.serialize_field(name, &axis.value)?;
            }
        }
        row.end()
    }
}

/// All but those of the axes that a study names itself.
impl Columns for Cell {
    fn columns() -> Vec<Column> {
        use Role::{Choice, Condition, Note};
        use Scale::{Linear, Log, Share, Words};
        let mut columns = vec![
            Column::new("cell", Note, "cell", "", Linear),
            Column::new("pitch_mm", Choice, "pitch", "mm", Linear),
            // The pitch and the size say them.
            Column::new("nx", Note, "taxels along x", "", Linear),
            Column::new("ny", Note, "taxels along y", "", Linear),
            Column::new("size_mm", Choice, "array size", "mm", Linear),
            Column::new("noise_std", Condition, "noise", "%", Share),
            Column::new("noise_unit", Note, "noise unit", "", Words),
            Column::new("smoothing_mm", Choice, "smoothing", "mm", Linear),
        ];
        columns.extend_from_slice(strength_columns());
        columns.extend([
            Column::new("tested_on", Condition, "tested on", "", Words).optional(),
            Column::new("ensemble", Choice, "ensemble", "", Words).named(Ensemble::NAMES),
            Column::new("measurements", Choice, "m", "", Log),
            Column::new("ratio", Choice, "compression", ":1", Log),
            Column::new("frames", Choice, "frames a touch", "", Log),
            Column::new("over_time", Choice, "over time", "", Words)
                .named(OVER_TIME)
                .optional(),
            Column::new("features", Choice, "features", "", Words).named(Features::NAMES),
            Column::new("foremost_full_scale", Choice, "foremost", "%", Share).optional(),
            Column::new("tilted_copies", Choice, "tilted copies", "", Linear).optional(),
            Column::new("classifier", Choice, "classifier", "", Words).named(ClassifierKind::NAMES),
            Column::new("c", Choice, "C", "", Log).named(CHOSEN),
            Column::new("train_touches", Choice, "training touches", "", Log),
            Column::new("mislabelled_fraction", Condition, "mislabelled", "%", Share).optional(),
            Column::new("class_imbalance", Condition, "class imbalance", ":1", Log).optional(),
            Column::new("fused_touches", Choice, "touches fused", "", Log),
            Column::new("next_touch", Choice, "next touch", "", Words).optional(),
        ]);
        columns
    }
}

impl Cell {
    /// Returns the inputs of its features.
    pub fn rows(&self) -> RowInputs {
        let is_of_images = self.features.of_image().is_some();
        RowInputs {
            image_shape: self.image_shape,
            measurements: self.measurements,
            frames: self.frames,
            over_time: self.over_time,
            features: self.features,
            foremost_full_scale: self.foremost_full_scale.filter(|_| is_of_images),
            n_copies: self.tilted_copies.unwrap_or(0),
        }
    }

    /// What it learns from, where that is made of images.
    pub(crate) fn of_images(&self) -> Option<FeaturesOfImages> {
        self.rows().of_images()
    }

    /// Numbers that a touch is told by.
    pub fn n_features(&self) -> usize {
        self.rows().n_features()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A cell for tests to start from: 32 × 32 taxels at 2 mm, 16:1.
    pub(crate) fn cell() -> Cell {
        Cell {
            cell: 0,
            pitch_mm: 2.0,
            nx: 32,
            ny: 32,
            image_shape: (32, 32),
            size_mm: 64.0,
            noise_std: 0.1,
            noise_unit: NoiseUnit::FullScale,
            smoothing_mm: 0.0,
            strengths: Strengths::default(),
            tested_on: None,
            ensemble: Ensemble::Gaussian,
            measurements: 64,
            ratio: 16.0,
            frames: 1,
            over_time: None,
            features: Features::Raw,
            foremost_full_scale: None,
            tilted_copies: None,
            classifier: ClassifierKind::LinearSvm,
            c: Some(1.0),
            train_touches: 75,
            mislabelled_fraction: None,
            class_imbalance: None,
            fused_touches: 1,
            next_touch: None,
            variant: AxisValues::default(),
        }
    }
}
