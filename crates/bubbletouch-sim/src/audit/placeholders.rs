//! Placeholders: values that a recording contains in place of missing readings, such as −1, 0 or 65535, and repeated frames.
//!
//! Noise makes equal readings rare. A value is a placeholder if readings of several taxels equal it exactly, and one of two conditions holds. First, the value
//! lies far outside all other readings, by a gap that is larger than a tenth of their range and larger than five times all other gaps. Second, the value lies
//! between other readings that are as near as readings are to each other, while readings hardly ever equal each other elsewhere. Clipping, rounding and
//! thresholds do not fulfil these conditions: clipped readings are at an end of the range without a gap, and readings below a threshold leave a gap on both sides.

use ndarray::ArrayView2;

/// Minimum gap between a placeholder outside the readings and the other readings, relative to their range.
const MIN_GAP: f64 = 0.1;
/// Minimum gap, relative to the largest gap between other readings.
const MIN_GAPS: f64 = 5.0;
/// Maximum fraction of readings at rest; a value with more readings is the reading at rest, not a placeholder.
const MAX_SHARE: f64 = 0.5;
/// Minimum number of equal readings.
const MIN_READINGS: usize = 3;
/// Maximum fraction of readings that equal another reading, apart from a placeholder, in recordings with continuous readings.
const MAX_EQUAL: f64 = 0.01;
/// Maximum distance of the next readings on both sides of a placeholder between readings, relative to the range.
const MAX_STEP: f64 = 1e-3;
/// Maximum fraction of frames that equal the frame before, apart from repeated frames, in recordings with noise.
const MAX_STILL: f64 = 0.1;

/// Value in place of missing readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placeholder {
    /// The value.
    pub value: f64,
    /// Number of readings that equal the value.
    pub n_readings: usize,
}

/// Finds a placeholder. Taxels for which `is_counted` is false, such as constant taxels, are omitted.
pub fn placeholder(frames: ArrayView2<f64>, is_counted: &[bool]) -> Option<Placeholder> {
    let counted: Vec<usize> = (0..frames.ncols())
        .filter(|&taxel| is_counted[taxel])
        .collect();
    let mut all: Vec<f64> = Vec::with_capacity(counted.len() * frames.nrows());
    for frame in frames.rows() {
        all.extend(counted.iter().map(|&taxel| frame[taxel]));
    }
    all.sort_by(f64::total_cmp);
    let mut values: Vec<(f64, usize)> = Vec::new();
    for reading in all.iter().copied() {
        match values.last_mut() {
            Some((value, n)) if *value == reading => *n += 1,
            _ => values.push((reading, 1)),
        }
    }
    if values.len() < 8 {
        return None;
    }
    let n = all.len();
    let is_possible =
        |&(_, count): &(f64, usize)| count >= MIN_READINGS && (count as f64) < MAX_SHARE * n as f64;
    let taxels = |value: f64| {
        let of = |&&taxel: &&usize| frames.column(taxel).iter().any(|&x| x == value);
        counted.iter().filter(of).take(2).count()
    };
    let found = outside(&values)
        .into_iter()
        .chain(between(&values, n))
        .find(|value| is_possible(value) && taxels(value.0) > 1);
    found.map(|(value, n_readings)| Placeholder { value, n_readings })
}

/// Returns the ends of the values that lie far outside the others.
fn outside(values: &[(f64, usize)]) -> Vec<(f64, usize)> {
    let gap = |pair: &[(f64, usize)]| pair[1].0 - pair[0].0;
    let last = values.len() - 1;
    let inner = &values[1..last];
    let range = inner[inner.len() - 1].0 - inner[0].0;
    let largest = inner.windows(2).map(gap).fold(0.0, f64::max);
    let is_far = |gap: f64| gap > MIN_GAP * range && gap > MIN_GAPS * largest;
    let mut found = Vec::new();
    if is_far(gap(&values[..2])) {
        found.push(values[0]);
    }
    if is_far(gap(&values[last - 1..])) {
        found.push(values[last]);
    }
    found
}

/// Returns the most frequent value if it lies between other readings, and other readings hardly ever equal each other.
fn between(values: &[(f64, usize)], n: usize) -> Option<(f64, usize)> {
    let last = values.len() - 1;
    let place = (0..=last).max_by_key(|&place| values[place].1)?;
    if place == 0 || place == last {
        return None;
    }
    let count = values[place].1;
    let n_equal: usize = values
        .iter()
        .filter(|value| value.1 > 1)
        .map(|value| value.1)
        .sum();
    let range = values[last].0 - values[0].0;
    let [below, above] = [values[place - 1].0, values[place + 1].0];
    let is_near = above - below <= 2.0 * MAX_STEP * range;
    ((n_equal - count) as f64 <= MAX_EQUAL * n as f64 && is_near).then_some(values[place])
}

/// Counts frames that equal the frame before in the same touch, if the recording has noise. Frames of equal readings are omitted. Returns 0 if frames often
/// repeat most of their readings, as frames without noise do. Frames of padding, of which `n_padded` are at the end of each touch, are omitted.
pub fn count_repeated(
    frames: ArrayView2<f64>,
    (n_frames, n_padded): (usize, &[usize]),
    is_counted: &[bool],
) -> usize {
    let counted: Vec<usize> = (0..frames.ncols())
        .filter(|&taxel| is_counted[taxel])
        .collect();
    let (mut n_repeated, mut n_still, mut n_pairs) = (0, 0, 0);
    let is_recorded = |row: &usize| {
        let frame = row % n_frames;
        frame != 0 && frame + n_padded[row / n_frames] < n_frames
    };
    for row in (1..frames.nrows()).filter(is_recorded) {
        let (before, frame) = (frames.row(row - 1), frames.row(row));
        let n_equal = counted
            .iter()
            .filter(|&&taxel| before[taxel] == frame[taxel])
            .count();
        let is_constant = || {
            counted
                .iter()
                .all(|&taxel| frame[taxel] == frame[counted[0]])
        };
        n_pairs += 1;
        if n_equal == counted.len() && n_equal > 0 {
            n_repeated += usize::from(!is_constant());
            n_still += usize::from(is_constant());
        } else if 2 * n_equal > counted.len() {
            n_still += 1;
        }
    }
    match n_still as f64 > MAX_STILL * f64::from(n_pairs) {
        true => 0,
        false => n_repeated,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use ndarray::Array2;
    use rand::Rng;
    use rand_distr::StandardNormal;

    fn noise() -> Array2<f64> {
        let mut rng = Seed::new(6).named("noise").rng();
        Array2::from_shape_simple_fn((100, 20), || rng.sample::<f64, _>(StandardNormal))
    }

    #[test]
    fn placeholders_are_found_and_clipping_rounding_and_thresholds_are_none() {
        let all = [true; 20];
        let of = |frames: &Array2<f64>| placeholder(frames.view(), &all).map(|found| found.value);
        let with = |value: f64, every: usize| {
            let mut frames = noise();
            frames.iter_mut().step_by(every).for_each(|x| *x = value);
            frames
        };
        assert_eq!(of(&noise()), None);
        for (value, every) in [(-9.0, 301), (0.0, 151), (65535.0, 7), (0.01, 13)] {
            assert_eq!(of(&with(value, every)), Some(value), "{value}");
        }
        assert_eq!(of(&noise().mapv(|x| x.max(0.0))), None);
        assert_eq!(of(&noise().mapv(|x| x.clamp(-1.5, 1.5))), None);
        assert_eq!(of(&noise().mapv(|x| (3.0 * x).round())), None);
        assert_eq!(
            of(&noise().mapv(|x| if x.abs() < 0.3 { 0.0 } else { x })),
            None
        );
        assert_eq!(
            of(&with(-9.0, 301).mapv(|x| (100.0 * x).round())),
            Some(-900.0)
        );
    }

    #[test]
    fn repeated_frames_are_counted_only_in_recordings_with_noise() {
        let mut frames = noise();
        for row in [5, 6, 31] {
            let before = frames.row(row - 1).to_owned();
            frames.row_mut(row).assign(&before);
        }
        let all = [true; 20];
        let mut whole = vec![0; frames.nrows() / 5];
        // Row 5 begins a touch.
        assert_eq!(count_repeated(frames.view(), (5, &whole), &all), 2);
        assert_eq!(
            count_repeated(frames.mapv(|x| x.max(3.0)).view(), (5, &whole), &all),
            0
        );
        // The last four frames of the second touch are padding, among them the repeated row 6.
        whole[1] = 4;
        assert_eq!(count_repeated(frames.view(), (5, &whole), &all), 1);
    }
}
