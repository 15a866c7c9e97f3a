//! Axis order of recorded frames: touches, time, and positions on the skin.
//!
//! An order is a string with one letter per axis of the file: `n` touches, `t` frames of a touch, `y` rows, and `x` columns. If the order contains `y` and
//! `x`, `c` is the axis of a taxel's values; each kind of value has its own rows and columns. Otherwise `c` is the axis of the taxels of a skin without
//! rows and columns. Several axes `c` without `y` and `x` are combined to one axis of taxels.

use crate::error::{Error, Result};
use crate::inputs::units::{MAX_FRAMES, MAX_SIDE};
use bubbletouch_sim::text::spelling::counted;
use ndarray::{Array2, ArrayD};

/// Maximum ratio of the last two axis lengths for which these two axes are interpreted as rows and columns of a grid. With a larger value, time may be mistaken
/// for taxels; with a smaller value, the order must be given for more arrays.
const MAX_ASPECT: usize = 6;
/// Maximum length at which an array's last axis is assumed to contain the values of one taxel (three force components).
const MAX_VALUES: usize = 3;

/// Order of the axes in an array of recorded frames, as given in a study.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameAxes<'a> {
    /// Letters of the axes in their order in the file, such as `ntyx`; `None` for the default order.
    pub order: Option<&'a str>,
    /// Numbers of rows and columns of the taxel grid, if one array axis `c` contains all taxels.
    pub grid: Option<[usize; 2]>,
    /// Number of values that are recorded per taxel: 1, or the number of force components.
    pub n_values: usize,
    /// Name of the key or option that sets the axis order, for error messages.
    pub key: &'a str,
}

/// Axis lengths of an array of recorded frames, and the order of the axes in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameShape {
    /// Number of touches in the array.
    pub n_touches: usize,
    /// Number of frames in each touch.
    pub n_frames: usize,
    /// Number of taxels.
    pub n_taxels: usize,
    /// Numbers of rows and columns of the positions on the skin; `None` if the positions form no grid.
    pub sides: Option<[usize; 2]>,
    /// Number of recorded values per taxel.
    n_values: usize,
    /// Number of positions on the skin. Several values may be recorded at each position, such as events of two signs; they count as taxels.
    pub n_places: usize,
    /// Indices of the file's axes in the order touch, frame, taxel, y, x.
    axes: Vec<usize>,
    /// Letters of the axes in their order in the file.
    order: String,
    /// Lengths of the axes in their order in the file.
    lengths: Vec<usize>,
}

impl FrameShape {
    /// Returns the number of values in each frame: number of taxels times number of values per taxel.
    pub fn n_frame_values(&self) -> usize {
        self.n_values * self.n_taxels
    }

    /// Returns the numbers of rows and columns if the taxels form a grid with one kind of values.
    pub fn grid(&self) -> Option<[usize; 2]> {
        self.sides.filter(|_| self.n_places == self.n_taxels)
    }

    /// Returns whether several axes `c` count the taxels of a skin without rows and columns.
    pub fn has_several_taxel_axes(&self) -> bool {
        self.grid().is_none() && self.n_values == 1 && self.order.matches('c').count() > 1
    }

    /// Returns the shape in which one of several axes `c`, of length `n_places`, counts the positions on the skin. This axis becomes the last one, so values of
    /// one kind are together. Without such an axis, the result is unchanged.
    pub fn with_places(mut self, n_places: usize) -> Self {
        if !self.has_several_taxel_axes() || self.n_taxels == n_places {
            return self;
        }
        let letters = self.order.as_bytes();
        let is_of_places = |axis: &usize| letters[*axis] == b'c' && self.lengths[*axis] == n_places;
        let found = self.axes.iter().position(is_of_places);
        if let (Some(found), None) = (found, self.sides) {
            // The axes c are the last ones of a skin without rows and columns.
            let axis = self.axes.remove(found);
            self.axes.push(axis);
            self.n_places = n_places;
        }
        self
    }

    /// Returns the axis order and the axis lengths that an additional array with `n_values` values per taxel must have. The additional axis c comes before the
    /// axes of position.
    pub fn beside(&self, n_values: usize) -> (String, Vec<usize>) {
        let (mut order, mut shape) = (self.order.clone(), self.lengths.clone());
        let has_rows = order.contains('y');
        match order.find('c').filter(|_| has_rows) {
            Some(axis) => shape[axis] = n_values,
            None => {
                let place = order.find(['c', 'y', 'x']).unwrap_or(order.len());
                order.insert(place, 'c');
                shape.insert(place, n_values);
            }
        }
        (order, shape)
    }

    /// Arranges an array with one number per taxel row by row, as a list. The input has the taxel axes of the file of frames, or the shape rows × columns, or is a
    /// list.
    ///
    /// # Errors
    /// If the numbers do not fill a frame; the error contains the expected shape.
    pub fn arrange_taxels(
        &self,
        numbers: ArrayD<f64>,
    ) -> std::result::Result<Vec<f64>, Vec<usize>> {
        // If the order contains y, one axis c of the file counts the values of a taxel.
        let is_value = self.sides.is_none() || self.grid().is_some();
        let of_values = match self.order.contains('y') && is_value {
            true => self
                .order
                .match_indices('c')
                .map(|(axis, _)| axis)
                .collect(),
            false if self.n_values > 1 => self.order.find('c').into_iter().collect(),
            false => Vec::new(),
        };
        let is_of_taxels = |axis: &usize| {
            let letter = self.order.as_bytes()[*axis];
            !matches!(letter, b'n' | b't') && !of_values.contains(axis)
        };
        let of_taxels: Vec<usize> = (0..self.lengths.len()).filter(is_of_taxels).collect();
        let expected: Vec<usize> = of_taxels.iter().map(|&axis| self.lengths[axis]).collect();
        if numbers.shape() == expected {
            let place = |axis: &usize| of_taxels.iter().position(|own| own == axis);
            let axes: Vec<usize> = self.axes.iter().filter_map(place).collect();
            return Ok(numbers.permuted_axes(axes).iter().copied().collect());
        }
        let is_list = numbers.len() == self.n_taxels
            && numbers.shape().iter().filter(|&&length| length > 1).count() <= 1;
        let is_grid = self.grid().is_some_and(|grid| numbers.shape() == grid);
        match is_list || is_grid {
            true => Ok(numbers.iter().copied().collect()),
            false => Err(expected),
        }
    }

    /// Checks that the touches have the frames and taxels of the touches of another file. `place` and `first_place` are the names of the files.
    ///
    /// # Errors
    /// If the numbers of frames, rows, columns or values differ.
    pub fn check_alike(&self, place: &str, (first, first_place): (&Self, &str)) -> Result<()> {
        let axes = |shape: &Self| {
            let [rows, columns] = shape.sides.unwrap_or([1, shape.n_places]);
            let n_values = shape.n_taxels / shape.n_places;
            [shape.n_frames, rows, columns, n_values]
        };
        let words = |[n_frames, rows, columns, n_values]: [usize; 4]| {
            let values = match n_values {
                1 => String::new(),
                n => format!(" of {n} values"),
            };
            let frames = counted(n_frames, "frame");
            format!("touches of {frames} of {rows} × {columns} taxels{values}")
        };
        let (own, wanted) = (axes(self), axes(first));
        if own == wanted {
            return Ok(());
        }
        let allowed = format!("{}, as {first_place} has", words(wanted));
        Err(Error::input(place, words(own), allowed))
    }

    /// Arranges all recorded values with one row per frame: shape (touches · frames, values · taxels).
    ///
    /// # Panics
    /// If the axes of the numbers differ from the shape.
    pub fn arrange(&self, numbers: ArrayD<f64>) -> Array2<f64> {
        let numbers = numbers.permuted_axes(self.axes.clone());
        let numbers = match numbers.is_standard_layout() {
            true => numbers,
            false => numbers.as_standard_layout().into_owned(),
        };
        let shape = (self.n_touches * self.n_frames, self.n_frame_values());
        let rows = numbers.into_shape_with_order(shape);
        rows.expect("as many numbers as the axes say")
    }
}

/// Determines which axes of an array belong to touches, frames, taxels, rows and columns.
///
/// # Errors
/// If the order does not fit the array, or no order is given and two orders are possible.
pub fn frame_shape(place: &str, shape: &[usize], axes: FrameAxes) -> Result<FrameShape> {
    let given = format!("an array of shape {shape:?}");
    let key = axes.key;
    if shape.contains(&0) {
        let given = format!("no readings, shape {shape:?}");
        return Err(Error::input(place, given, "at least one reading"));
    }
    let order = match axes.order {
        Some(order) => checked_order(order, key)?,
        None => {
            let usual = match (shape.len(), axes.n_values, axes.grid) {
                (2, 1, _) => "nc",
                (3, 1, Some(_)) => "ntc",
                (3, 1, None) => "nyx",
                (4, 1, None) => "ntyx",
                (4, 2.., None) => "ncyx",
                (5, 2.., None) => "ntcyx",
                _ => {
                    let allowed = format!(
                        "n × rows × columns, n × F × rows × columns or n × taxels, or {key} with a letter for each axis: \
                         n touches, t frames of a touch, y rows, x columns, c values of a taxel or taxels without rows and columns"
                    );
                    return Err(Error::input(place, given, allowed));
                }
            };
            if axes.n_values == 1
                && axes.grid.is_none()
                && let Some(other) = other_order(shape)
            {
                let read = |order: &str| format!("{} (\"{}\")", words(shape, order), spaced(order));
                let given = format!("{given}, which may be {} or {}", read(usual), read(other));
                return Err(Error::input(
                    place,
                    given,
                    format!("{key}, which says which"),
                ));
            }
            usual.to_owned()
        }
    };
    if order.len() != shape.len() {
        let allowed = format!("{} axes, as {key} = \"{order}\" names", order.len());
        return Err(Error::input(place, given, allowed));
    }
    let axes_of = |letter: char| {
        let all = order.chars().enumerate();
        all.filter_map(move |(axis, own)| (own == letter).then_some(axis))
    };
    let length = |letter: char| axes_of(letter).map(|axis| shape[axis]).product::<usize>();
    let has_rows = order.contains('y');
    let of_values = match has_rows {
        true => length('c'),
        false if axes.n_values == 1 => 1,
        false => axes_of('c').next().map_or(1, |axis| shape[axis]),
    };
    // Several values of a taxel that reads no shear are kinds, each with rows and columns of its own.
    let has_kinds = has_rows && axes.n_values == 1 && of_values > 1;
    if of_values != axes.n_values && !has_kinds {
        let given = format!("{given} with {of_values} values a taxel");
        let allowed = format!("{}, as skin.sensed says", axes.n_values);
        return Err(Error::input(place, given, allowed));
    }
    let n_taxels = match has_rows {
        true => length('c') * length('y') * length('x') / axes.n_values,
        false => length('c') / of_values,
    };
    let several = axes_of('c').count() > 1 && axes.n_values == 1;
    let is_of_positions = |n| several && axes_of('c').any(|axis| shape[axis] == n);
    let fits = |n| n == n_taxels || is_of_positions(n);
    let sides = match (has_rows, axes.grid) {
        (true, None) => Some([length('y'), length('x')]),
        (false, None) => None,
        (false, Some([rows, columns])) if fits(rows.saturating_mul(columns)) => axes.grid,
        (_, Some([rows, columns])) => {
            let given = format!("{rows} × {columns} taxels");
            let allowed = match has_rows {
                true => "no such key: the frames have rows and columns of their own".to_owned(),
                false => format!("rows and columns of the {n_taxels} taxels of {place}"),
            };
            return Err(Error::input(key.replace("order", "grid"), given, allowed));
        }
    };
    // One of several axes c counts the positions of the grid.
    let n_places = sides.map_or(n_taxels, |[rows, columns]| rows * columns);
    let found = FrameShape {
        n_touches: length('n'),
        n_frames: length('t'),
        n_taxels,
        sides: None,
        n_values: axes.n_values,
        n_places: n_taxels,
        axes: "ntcyx".chars().flat_map(axes_of).collect(),
        order: order.clone(),
        lengths: shape.to_owned(),
    };
    let found = FrameShape {
        sides,
        n_places,
        ..found.with_places(n_places)
    };
    let is_side = |side| (1..=MAX_SIDE).contains(&side);
    let is_allowed = found.n_touches > 0
        && (1..=MAX_FRAMES).contains(&found.n_frames)
        && sides.is_none_or(|sides| sides.into_iter().all(is_side))
        && (1..=MAX_SIDE * MAX_SIDE).contains(&n_taxels);
    if is_allowed {
        return Ok(found);
    }
    let allowed = format!(
        "n × rows × columns or n × F × rows × columns, 1 to {MAX_FRAMES} frames of 1 to {MAX_SIDE} rows and columns"
    );
    Err(Error::input(place, given, allowed))
}

/// Checks that a text is a valid order of array axes; returns its letters without separators.
fn checked_order(order: &str, key: &str) -> Result<String> {
    let parts = [' ', ',', '×', '-', '*'];
    let letters: String = order
        .chars()
        .filter(|letter| !parts.contains(letter))
        .collect();
    let count = |letter: char| letters.matches(letter).count();
    let has_rows = [count('y'), count('x')] == [1, 1];
    let is_order = letters.chars().all(|letter| "ntcyx".contains(letter))
        && count('n') == 1
        && count('t') <= 1
        && match has_rows {
            true => count('c') <= 1,
            false => count('y') + count('x') == 0 && count('c') >= 1,
        };
    match is_order {
        true => Ok(letters),
        false => {
            let allowed = "a letter for each axis: n touches (once), t frames of a touch, and y rows with x columns (beside them c: the values of a \
                           taxel) or c taxels without rows and columns";
            Err(Error::input(key, format!("{order:?}"), allowed))
        }
    }
}

/// Returns another plausible axis order of the array; `None` if only the default order is plausible.
fn other_order(shape: &[usize]) -> Option<&'static str> {
    let is_strip = |a: usize, b: usize| a.max(b) > MAX_ASPECT * a.min(b);
    match *shape {
        [_, a, b] if a.min(b) > 1 && is_strip(a, b) => Some(if a > b { "ntc" } else { "nct" }),
        [_, 1, _, _] => None,
        [_, a, b, c] if c <= MAX_VALUES && c < a.min(b) => Some("nyxc"),
        [_, a, b, c] if a == b && b != c || is_strip(b, c) => Some("nyxt"),
        _ => None,
    }
}

/// Returns the letters of an axis order with spaces between them.
pub fn spaced(order: &str) -> String {
    let letters: Vec<String> = order.chars().map(String::from).collect();
    letters.join(" ")
}

/// Returns a text that describes the axes of an array and their lengths, given the axis order.
fn words(shape: &[usize], order: &str) -> String {
    let length = |letter: char| order.find(letter).map(|axis| shape[axis]);
    let of = |letter: char| length(letter).unwrap_or(1);
    let taxels = match length('y') {
        Some(rows) => format!("{rows} × {} taxels", of('x')),
        None => format!("{} taxels", of('c')),
    };
    let values = match (length('y'), length('c')) {
        (Some(_), Some(n)) => format!(" of {n} values"),
        _ => String::new(),
    };
    let frames = length('t').map_or(String::new(), |n| format!("{} of ", counted(n, "frame")));
    format!("{} touches of {frames}{taxels}{values}", of('n'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(shape: &[usize], order: Option<&str>) -> std::result::Result<[usize; 4], String> {
        let axes = FrameAxes {
            order,
            n_values: 1,
            key: "key recorded.order",
            ..FrameAxes::default()
        };
        let found = frame_shape("frames.npy", shape, axes);
        let found = found.map_err(|error| error.to_string())?;
        let [rows, columns] = found.grid().unwrap_or([1, found.n_taxels]);
        Ok([found.n_touches, found.n_frames, rows, columns])
    }

    #[test]
    fn usual_orders_are_read_and_arrays_that_may_be_two_things_are_not() {
        assert_eq!(read(&[160, 8, 8], None), Ok([160, 1, 8, 8]));
        assert_eq!(read(&[1100, 28, 50], None), Ok([1100, 1, 28, 50]));
        assert_eq!(read(&[36, 2, 8, 8], None), Ok([36, 2, 8, 8]));
        assert_eq!(read(&[36, 49, 32, 32], None), Ok([36, 49, 32, 32]));
        assert_eq!(read(&[36, 1, 8, 8], None), Ok([36, 1, 8, 8]));
        assert_eq!(read(&[36, 1, 64], None), Ok([36, 1, 1, 64]));
        assert_eq!(read(&[36, 24], None), Ok([36, 1, 1, 24]));
        for (shape, both) in [
            (
                &[160, 8, 8, 1][..],
                [
                    "160 touches of 8 frames of 8 × 1 taxels (\"n t y x\")",
                    "8 × 8 taxels of 1 values (\"n y x c\")",
                ],
            ),
            (&[50, 64, 32, 1], ["64 frames of 32 × 1", "64 × 32 taxels"]),
            (
                &[50, 39, 2, 250],
                ["39 frames of 2 × 250", "250 frames of 39 × 2"],
            ),
            (
                &[50, 16, 16, 40],
                ["16 frames of 16 × 40", "40 frames of 16 × 16"],
            ),
            (
                &[50, 16, 12, 3],
                ["16 frames of 12 × 3", "16 × 12 taxels of 3"],
            ),
            (
                &[50, 24, 250],
                ["24 × 250 taxels", "250 frames of 24 taxels (\"n c t\")"],
            ),
        ] {
            let said = read(shape, None).unwrap_err();
            for one in both.iter().chain(&["key recorded.order"]) {
                assert!(said.contains(one), "{said} does not say {one}");
            }
        }
    }

    #[test]
    fn named_axes_are_moved_to_where_they_belong() {
        assert_eq!(read(&[160, 8, 9, 1], Some("n y x c")), Ok([160, 1, 8, 9]));
        assert_eq!(
            read(&[39, 2, 250, 50], Some("c c t n")),
            Ok([50, 250, 1, 78])
        );
        assert_eq!(read(&[8, 9, 160], Some("yxn")), Ok([160, 1, 8, 9]));
        for wrong in ["n y", "y x", "n q", "n t t c", "n y x y", ""] {
            assert!(
                read(&[160, 8, 8], Some(wrong))
                    .unwrap_err()
                    .contains("key recorded.order")
            );
        }
        assert!(
            read(&[160, 8, 8], Some("n t y x"))
                .unwrap_err()
                .contains("4 axes")
        );
        let axes = FrameAxes {
            order: Some("x n y"),
            n_values: 1,
            ..FrameAxes::default()
        };
        let numbers =
            ArrayD::from_shape_fn(vec![2, 4, 3], |i| (100 * i[1] + 10 * i[2] + i[0]) as f64);
        let rows = frame_shape("", &[2, 4, 3], axes).unwrap().arrange(numbers);
        assert_eq!(rows.dim(), (4, 6));
        assert_eq!(
            rows.row(3).to_vec(),
            [300.0, 301.0, 310.0, 311.0, 320.0, 321.0]
        );
    }
}
