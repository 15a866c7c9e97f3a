//! Recorded frames: the checks of `[recorded]`, and the array that read them.

use super::check::Check;
use super::npy::npy_shape;
use super::plan::{MM, MOST_FRAMES};
use super::plan_scene::MOST_SIDE;
use super::spec::{ObjectsSpec, RecordedSpec, SkinSpec, StudySpec, TouchesSpec};
use super::taxel_array::TaxelArray;
use crate::error::Result;
use crate::world::{ArrayLayout, Grid};

impl RecordedSpec {
    /// n, F, rows and columns of the frames.
    ///
    /// # Errors
    /// No such file; one of another number of dimensions, or without frames.
    pub fn shape(&self) -> Result<[usize; 4]> {
        let given = npy_shape(&self.frames)?;
        let shape = match given[..] {
            [n, rows, columns] => [n, 1, rows, columns],
            [n, frames, rows, columns] => [n, frames, rows, columns],
            _ => [0; 4],
        };
        let [n, frames, rows, columns] = shape;
        let is_array = |side| (1..=MOST_SIDE).contains(&side);
        if n > 0 && (1..=MOST_FRAMES).contains(&frames) && is_array(rows) && is_array(columns) {
            return Ok(shape);
        }
        let allowed = format!(
            "n × rows × columns or n × F × rows × columns, 1 to {MOST_FRAMES} frames of 1 to {MOST_SIDE} rows and columns"
        );
        let given = format!("an array of shape {given:?}");
        Err(crate::Error::input(self.frames.display(), given, allowed))
    }
}

impl Check<'_> {
    /// The array that read what a study has recorded; it has nothing beside it that makes touches.
    pub fn recorded(&self, recorded: &RecordedSpec, spec: &StudySpec) -> Result<Vec<TaxelArray>> {
        let StudySpec {
            objects, touches, ..
        } = spec;
        if *objects != ObjectsSpec::default()
            || *touches != TouchesSpec::default()
            || spec.human_touch.is_some()
        {
            let given = "beside [objects], [touches] or [human_touch]";
            let allowed = "it alone: it is what the skin has read";
            return Err(self.error("recorded", given, allowed));
        }
        if spec.recognition.keep_together.is_some() {
            let allowed = "no such key: recorded.groups says what stays together";
            return Err(self.error("recognition.keep_together", "given", allowed));
        }
        self.value(
            "recorded.zero",
            recorded.zero,
            f64::is_finite,
            "a finite number",
        )?;
        if let Some(full_scale) = recorded.full_scale
            && !(full_scale.is_finite() && full_scale > recorded.zero)
        {
            let allowed = format!("a number above recorded.zero, {}", recorded.zero);
            return Err(self.error("recorded.full_scale", full_scale, allowed));
        }
        Ok(vec![self.array_of(recorded, &spec.skin)?])
    }

    fn array_of(&self, recorded: &RecordedSpec, skin: &SkinSpec) -> Result<TaxelArray> {
        self.table("skin", skin)?;
        let given = [
            ("skin.taxels", skin.taxels.is_some()),
            ("skin.size_mm", skin.size_mm.is_some()),
            ("skin.layout", skin.layout.is_some()),
            ("skin.sensed", skin.sensed.is_some()),
            ("skin.friction", skin.friction.is_some()),
        ];
        if let Some((key, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
            let allowed = "no such key: recorded frames are grids that read one number a taxel";
            return Err(self.error(key, "given", allowed));
        }
        let pitches = skin.pitch_mm.values();
        let [pitch_mm] = pitches[..] else {
            let given = format!("{} pitches", pitches.len());
            return Err(self.error("skin.pitch_mm", given, "one, of the skin that read them"));
        };
        let [_, _, rows, columns] = recorded.shape()?;
        let grid = Grid {
            nx: columns,
            ny: rows,
            pitch: pitch_mm * MM,
        };
        let taxel = skin.taxel(pitch_mm);
        grid.check()?;
        taxel.check()?;
        TaxelArray::new(ArrayLayout::Grid, (grid, taxel), 0.0)
    }
}
