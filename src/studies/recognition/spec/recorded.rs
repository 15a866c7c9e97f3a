//! Recorded frames as they are written: `[recorded]`, in place of `[objects]` and `[touches]`.

use crate::error::{Error, Result};
use crate::files::{file_path, optional_file_path};
use crate::inputs::arrays::axis_order::{FrameAxes, FrameShape, frame_shape};
use crate::inputs::arrays::file_array::FileArray;
use crate::inputs::arrays::is_member;
use serde::de::{IntoDeserializer, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::path::{Path, PathBuf};

/// `[recorded]`: what a skin has read, in files of NumPy (`.npy`, `.npz`) or tables (`.csv`). `[skin]` says how far apart its taxels are and what their
/// full scale is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedSpec {
    /// n × rows × columns, n × F × rows × columns of touches of F frames, or n × taxels of a skin without rows and columns; any type of number of up to
    /// 64 bits. The other files may be left out where this is an archive that contains their arrays.
    #[serde(deserialize_with = "file_path")]
    pub frames: PathBuf,
    /// The two forces across the axis of each taxel, newtons, of a skin that reads shear: the axes of `frames`, and before those of the place the axis c of
    /// two values. Without it all three values of a taxel are in `frames`.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub shear: Option<PathBuf>,
    /// n: the class of every touch: whole numbers, texts, or n × classes of 0 and 1.
    #[serde(
        default,
        skip_serializing_if = "is_empty",
        deserialize_with = "file_path"
    )]
    pub labels: PathBuf,
    /// n: touches that share a number or a text are never on both sides of a split, those of a grasp or of a day, say.
    #[serde(default, deserialize_with = "optional_file_path")]
    pub groups: Option<PathBuf>,
    /// A letter for each axis of the frames: n touches, t frames of a touch, y rows, x columns, c values of a taxel, or taxels without rows and
    /// columns; `n y x`, `n t y x` or `n c` when left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<String>,
    /// Rows and columns of the axis `c`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<[usize; 2]>,
    /// Frames of the given test set, with the axes of `frames`; all touches of `frames` then train.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub frames_test: Option<PathBuf>,
    /// Forces across of the given test set, as in `shear`.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub shear_test: Option<PathBuf>,
    /// Their classes, as in `labels`.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub labels_test: Option<PathBuf>,
    /// Their groups, from which the interval of an accuracy comes.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub groups_test: Option<PathBuf>,
    /// What the classes are called, by their labels.
    pub names: Option<Vec<String>>,
    /// The reading of a taxel that nothing touches: one number, or a file with the number of each taxel; 0 when left out.
    #[serde(default)]
    pub zero: ZeroSpec,
    /// The reading of a taxel at its full scale, which is its stroke; the largest of the frames when left out.
    pub full_scale: Option<f64>,
    /// n: how far each touch was pressed, metres; with `speed_mm_per_s` this is the time between its frames.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub depths: Option<PathBuf>,
    /// Approach speed at the moment of reading, mm/s: what the damper feels.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub speed_mm_per_s: f64,
    /// Seconds between the frames of a touch, for sensor errors that take time; instead of `speed_mm_per_s`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_interval_s: Option<f64>,
    /// Which touch came before each, for sensor errors that remember it.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub previous_touch: PreviousTouch,
    /// Values of a taxel: a plan knows what its skin reads. 0: one.
    #[serde(skip)]
    pub n_values: usize,
}

/// `zero = 100.0` or `zero = "zero.npy"`: what taxels read that nothing touches.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ZeroSpec {
    /// All taxels read the same.
    One(f64),
    /// A file with one number for each taxel: an array with the axes that taxels have in `frames`, or a list, row by row.
    Each(PathBuf),
}

impl Default for ZeroSpec {
    fn default() -> Self {
        Self::One(0.0)
    }
}

impl<'de> Deserialize<'de> for ZeroSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        /// Tells a number from a path.
        struct NumberOrPath;
        impl Visitor<'_> for NumberOrPath {
            type Value = ZeroSpec;

            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("a number, or the path of a file with a number for each taxel")
            }

            fn visit_f64<E: serde::de::Error>(
                self,
                number: f64,
            ) -> std::result::Result<ZeroSpec, E> {
                Ok(ZeroSpec::One(number))
            }

            fn visit_i64<E: serde::de::Error>(
                self,
                number: i64,
            ) -> std::result::Result<ZeroSpec, E> {
                Ok(ZeroSpec::One(number as f64))
            }

            fn visit_u64<E: serde::de::Error>(
                self,
                number: u64,
            ) -> std::result::Result<ZeroSpec, E> {
                Ok(ZeroSpec::One(number as f64))
            }

            fn visit_str<E: serde::de::Error>(
                self,
                path: &str,
            ) -> std::result::Result<ZeroSpec, E> {
                file_path(path.into_deserializer()).map(ZeroSpec::Each)
            }
        }
        deserializer.deserialize_any(NumberOrPath)
    }
}

/// What a skin that remembers was touched by before each touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PreviousTouch {
    /// Another touch of the study that is drawn at random in each trial, as in studies of pressed objects.
    #[default]
    Random,
    /// None.
    None,
}

#[expect(clippy::ptr_arg, reason = "serde hands over the field")]
fn is_empty(path: &PathBuf) -> bool {
    path.as_os_str().is_empty()
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde hands over the field"
)]
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde hands over the field"
)]
fn is_usual(touch: &PreviousTouch) -> bool {
    *touch == PreviousTouch::default()
}

impl RecordedSpec {
    /// Returns frames without labels, for what reads frames alone.
    pub fn of_frames(frames: &Path, order: Option<&str>, grid: Option<[usize; 2]>) -> Self {
        Self {
            frames: frames.to_owned(),
            order: order.map(str::to_owned),
            grid,
            ..Self::default()
        }
    }

    /// All files that are named, to be found in another folder.
    pub fn files_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let labels = Some(&mut self.labels).filter(|path| !is_empty(path));
        let zero = match &mut self.zero {
            ZeroSpec::One(_) => None,
            ZeroSpec::Each(path) => Some(path),
        };
        let files = [Some(&mut self.frames), labels, zero].into_iter().flatten();
        let others = [
            &mut self.shear,
            &mut self.shear_test,
            &mut self.groups,
            &mut self.frames_test,
            &mut self.labels_test,
            &mut self.groups_test,
            &mut self.depths,
        ];
        files.chain(others.into_iter().flatten())
    }

    /// All files that are read.
    pub fn files(&self) -> Vec<&Path> {
        let labels = Some(self.labels.as_path()).filter(|path| !path.as_os_str().is_empty());
        let others = [
            &self.shear,
            &self.shear_test,
            &self.groups,
            &self.frames_test,
            &self.labels_test,
            &self.groups_test,
            &self.depths,
        ];
        let others = others.into_iter().flatten().map(PathBuf::as_path);
        let zero = match &self.zero {
            ZeroSpec::One(_) => None,
            ZeroSpec::Each(path) => Some(path.as_path()),
        };
        let files = [Some(self.frames.as_path()), labels, zero];
        files.into_iter().flatten().chain(others).collect()
    }

    /// The file of the array `name`: the one that is given, or the archive of the frames if it contains the array.
    pub fn file_of(&self, name: &str) -> Option<&Path> {
        let given = match name {
            "frames" => Some(self.frames.as_path()),
            "labels" => Some(self.labels.as_path()).filter(|path| !path.as_os_str().is_empty()),
            "groups" => self.groups.as_deref(),
            "frames_test" => self.frames_test.as_deref(),
            "labels_test" => self.labels_test.as_deref(),
            "groups_test" => self.groups_test.as_deref(),
            _ => self.depths.as_deref(),
        };
        given.or_else(|| Some(self.frames.as_path()).filter(|path| is_member(path, name)))
    }

    /// Whether some touches are the test set.
    pub fn has_test_set(&self) -> bool {
        self.file_of("frames_test").is_some()
    }

    /// The axes of `frames` or `frames_test`.
    ///
    /// # Errors
    /// If there is no such file, or its axes are not those of frames.
    pub fn shape_of(&self, name: &str) -> Result<FrameShape> {
        let path = self.file_of(name).unwrap_or(&self.frames);
        let shape = FileArray::shape_of(path, name)?;
        let n_values = match self.shear {
            Some(_) => 1,
            None => self.n_values.max(1),
        };
        let axes = self.axes(self.order.as_deref(), n_values);
        frame_shape(&path.display().to_string(), &shape, axes)
    }

    /// What each taxel reads that nothing touches, shape (rows · columns), row by row.
    ///
    /// # Errors
    /// If the file cannot be read or does not have one number for each taxel of `shape`, the axes of `frames`.
    pub fn zeros(&self, shape: &FrameShape) -> Result<Vec<f64>> {
        let path = match &self.zero {
            ZeroSpec::One(number) => return Ok(vec![*number; shape.rows * shape.columns]),
            ZeroSpec::Each(path) => path,
        };
        let array = FileArray::read(path, "zero")?;
        let (place, given) = (array.place.clone(), array.shape.clone());
        let frames = FileArray::shape_of(&self.frames, "frames")?;
        shape
            .arrange_taxels(array.into_numbers()?, &frames)
            .map_err(|expected| {
                let allowed = format!(
                    "shape {expected:?}, one number for each taxel of {}",
                    self.frames.display()
                );
                Error::input(place, format!("an array of shape {given:?}"), allowed)
            })
    }

    fn axes<'a>(&self, order: Option<&'a str>, n_values: usize) -> FrameAxes<'a> {
        FrameAxes {
            order,
            grid: self.grid,
            n_values,
            key: "recorded.order",
        }
    }

    /// The file of the forces across that belong to `frames` or `frames_test`, and the name of its array.
    pub fn shear_of(&self, name: &str) -> Option<(&Path, &'static str)> {
        let (path, name) = match name {
            "frames" => (&self.shear, "shear"),
            _ => (&self.shear_test, "shear_test"),
        };
        Some((path.as_deref()?, name))
    }

    /// The axes of the forces across that belong to `frames` or `frames_test`, whose axes are given; `None` if there is no such file.
    ///
    /// # Errors
    /// If its axes are not those of the frames with two values of each taxel.
    pub fn shear_shape(&self, name: &str, frames: &FrameShape) -> Result<Option<FrameShape>> {
        let Some((path, array)) = self.shear_of(name) else {
            return Ok(None);
        };
        let of_frames = self.file_of(name).unwrap_or(&self.frames);
        let (order, expected) = frames.beside(&FileArray::shape_of(of_frames, name)?, 2);
        let shape = FileArray::shape_of(path, array)?;
        let place = path.display().to_string();
        if shape != expected {
            let given = format!("an array of shape {shape:?}");
            let letters: Vec<String> = order.chars().map(String::from).collect();
            let allowed = format!(
                "shape {expected:?} (\"{}\"): the axes of {}, and two forces of each taxel",
                letters.join(" "),
                of_frames.display()
            );
            return Err(Error::input(place, given, allowed));
        }
        frame_shape(&place, &shape, self.axes(Some(&order), 2)).map(Some)
    }

    /// Refuses what is missing or stands alone.
    ///
    /// # Errors
    /// No labels; a test set without labels or frames; forces across of a skin that does not read them, or of one of two sets.
    pub fn check_files(&self) -> Result<()> {
        if self.file_of("labels").is_none() {
            let allowed = "labels = \"FILE\", the class of every touch (or an array `labels` in the archive of the frames)";
            return Err(Error::input("key recorded.labels", "no such key", allowed));
        }
        let has = |name| self.file_of(name).is_some();
        let (frames, labels) = (has("frames_test"), has("labels_test"));
        let both = [("shear", &self.shear), ("shear_test", &self.shear_test)];
        for (key, path) in both {
            let key = format!("key recorded.{key}");
            if let (Some(path), ..=1) = (path, self.n_values) {
                let allowed = "no such key without skin.sensed = \"shear\"";
                return Err(Error::input(key, path.display(), allowed));
            }
        }
        match (frames, &self.shear, &self.shear_test) {
            (true, Some(_), None) => {
                let allowed =
                    "the forces across of frames_test, as recorded.shear has those of frames";
                return Err(Error::input(
                    "key recorded.shear_test",
                    "no such key beside shear and frames_test",
                    allowed,
                ));
            }
            (_, None, Some(path)) | (false, _, Some(path)) => {
                let allowed = "no such key without recorded.shear and recorded.frames_test";
                return Err(Error::input(
                    "key recorded.shear_test",
                    path.display(),
                    allowed,
                ));
            }
            _ => {}
        }
        match (frames, labels, has("groups_test")) {
            (true, false, _) => Err(Error::input(
                "key recorded.labels_test",
                "no such key beside frames_test",
                "the class of every touch of the test set",
            )),
            (false, true, _) | (false, _, true) => Err(Error::input(
                "key recorded.frames_test",
                "no such key beside labels_test or groups_test",
                "the frames of the test set",
            )),
            _ => Ok(()),
        }
    }
}
