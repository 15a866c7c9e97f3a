//! Detection of saturation: a largest reading that many frames share, for example because a converter clips below the full scale.

use statrs::distribution::{Binomial, DiscreteCDF};

/// Largest reading that certainly is not clipped, as a fraction of the full scale; a taxel above it may be at the end of its stroke. If larger, clipped readings
/// bias estimates; if smaller, estimates use fewer readings.
pub(super) const CLIPPED: f64 = 0.97;

/// Minimum number of frames in which a plateau (a largest reading that many frames share) occurs; `MIN_SHARE` is the minimum fraction of all frames.
const MIN_FRAMES: usize = 3;
const MIN_SHARE: f64 = 0.01;
/// Minimum ratio between the frequencies of the plateau value and of the next smaller reading. If readings have few levels, many frames share the largest
/// level by chance.
const MIN_EXCESS: usize = 3;
/// Number of the largest levels whose frequencies are compared, and the probability of reporting a plateau in readings with few levels.
const N_LEVELS: usize = 10;
const CHANCE: f64 = 0.001;

/// Returns the largest reading if it is a plateau, that is, shared by many frames. A plateau occurs on at least two taxels, and in at least 3 frames and 1 %
/// of all frames. A plateau is also at least three times as frequent as the next smaller reading. If readings below the largest one are shared as well, as with few
/// levels, chance must not explain its frequency: readings become rarer above, so that the largest level is at most as frequent as the next one. The function `frames` yields the readings of each frame in
/// the order of taxels; NaN is omitted.
pub fn plateau<F: Iterator<Item = f64>, I: Iterator<Item = F>>(
    frames: impl Fn() -> I,
) -> Option<f64> {
    // The largest readings and their frequencies, descending.
    let mut levels: Vec<(f64, usize)> = Vec::with_capacity(N_LEVELS + 1);
    for reading in frames().flatten() {
        let is_full = levels.len() == N_LEVELS;
        if reading.is_nan() || (is_full && reading < levels[N_LEVELS - 1].0) {
            continue;
        }
        let place = levels.partition_point(|&(level, _)| level > reading);
        match levels.get_mut(place) {
            Some((level, n)) if *level == reading => *n += 1,
            _ => {
                levels.insert(place, (reading, 1));
                levels.truncate(N_LEVELS);
            }
        }
    }
    let &(largest, n_largest) = levels.first()?;
    let n_next = levels.get(1).map_or(0, |&(_, n)| n);
    let are_shared = levels[1..].iter().any(|&(_, n)| n > 1);
    let is_chance = || {
        let binomial = Binomial::new(0.5, (n_largest + n_next) as u64);
        binomial.is_ok_and(|binomial| binomial.sf(n_largest as u64 - 1) > CHANCE)
    };
    let (mut n_frames, mut n_shared) = (0, 0);
    // A single taxel at a constant level is stuck.
    let (mut first, mut are_several) = (None, false);
    for frame in frames() {
        n_frames += 1;
        let mut taxels = frame.enumerate().filter(|(_, reading)| *reading == largest);
        let Some((taxel, _)) = taxels.next() else {
            continue;
        };
        n_shared += 1;
        are_several |= *first.get_or_insert(taxel) != taxel || taxels.next().is_some();
    }
    let is_plateau = are_several
        && n_shared >= MIN_FRAMES
        && n_shared as f64 >= MIN_SHARE * f64::from(n_frames)
        && n_largest >= MIN_EXCESS * n_next
        && !(are_shared && is_chance());
    is_plateau.then_some(largest)
}

#[cfg(test)]
mod tests {
    use super::plateau;

    #[test]
    fn clipped_readings_are_a_plateau_and_levels_that_frames_share_are_none() {
        let wave = |k: usize| (k as f64 * 0.7).sin();
        let of = |level: &dyn Fn(f64) -> f64| {
            let frames: Vec<Vec<f64>> = (0..60)
                .map(|frame| {
                    (0..16)
                        .map(|taxel| level(wave(frame * 17 + taxel)))
                        .collect()
                })
                .collect();
            plateau(|| frames.iter().map(|frame| frame.iter().copied()))
        };
        assert_eq!(of(&|reading| reading), None);
        assert_eq!(of(&|reading| reading.min(0.6)), Some(0.6));
        assert_eq!(of(&|reading| (4.0 * reading.asin()).round()), None);
        assert_eq!(of(&|_| 0.0), Some(0.0));
    }
}
