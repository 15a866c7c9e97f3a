//! Detection of saturation: a largest reading that many frames share, for example because a converter clips below the full scale.

/// Minimum number of frames in which a plateau (a largest reading that many frames share) occurs; `MIN_SHARE` is the minimum fraction of all frames.
const MIN_FRAMES: usize = 3;
const MIN_SHARE: f64 = 0.01;
/// Minimum ratio between the frequencies of the plateau value and of the next smaller reading. If readings have few levels, many frames share the largest
/// level by chance.
const MIN_EXCESS: usize = 3;

/// Returns the largest reading if it is a plateau, that is, shared by many frames. A plateau occurs on at least two taxels, and in at least 3 frames and 1 %
/// of all frames. A plateau is also at least three times as frequent as the next smaller reading. The function `frames` yields the readings of each frame in
/// the order of taxels; NaN is omitted.
pub fn plateau<F: Iterator<Item = f64>, I: Iterator<Item = F>>(
    frames: impl Fn() -> I,
) -> Option<f64> {
    let (mut largest, mut n_largest) = (f64::NEG_INFINITY, 0);
    let (mut next, mut n_next) = (f64::NEG_INFINITY, 0);
    for reading in frames().flatten() {
        if reading > largest {
            (next, n_next) = (largest, n_largest);
            (largest, n_largest) = (reading, 1);
        } else if reading == largest {
            n_largest += 1;
        } else if reading > next {
            (next, n_next) = (reading, 1);
        } else if reading == next {
            n_next += 1;
        }
    }
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
        && n_largest >= MIN_EXCESS * n_next;
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
