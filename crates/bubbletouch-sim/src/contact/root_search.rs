//! Search for the argument at which a function reaches a value: Newton steps inside a bracket.

/// Value and derivative of a function at one argument.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub value: f64,
    /// Derivative of the function, possibly approximate; an inexact derivative costs steps but does not change the result.
    pub slope: f64,
}

/// Number of Newton steps after which the bracketing interval is halved once. If larger, a function with kinks may converge slowly; if smaller, a smooth
/// function needs more steps.
const HALVED_EACH: usize = 3;

/// Returns the argument at which a function reaches the value `wanted`. The function must be smaller than `wanted` at `low`, and not smaller at `high`. The
/// search ends within `tolerance` of the value, or when rounding prevents a further step of the argument. With a negative tolerance, only the second
/// condition ends the search.
///
/// If the function jumps past the value, the side of the jump with the larger function value is returned.
pub(crate) fn crossing(
    [mut low, mut high]: [f64; 2],
    (wanted, tolerance): (f64, f64),
    mut sample: impl FnMut(f64) -> Sample,
) -> f64 {
    let mut at = high;
    for step in 1.. {
        let Sample { value, slope } = sample(at);
        let value = value - wanted;
        if value.abs() <= tolerance {
            break;
        }
        if value < 0.0 {
            low = at;
        } else {
            high = at;
        }
        let middle = 0.5 * low + 0.5 * high;
        if middle <= low || middle >= high {
            return high;
        }
        let newton = match at - value / slope {
            // The step is below the last bit; the neighbouring number closes the bracket.
            same if same == at && value < 0.0 => at.next_up(),
            same if same == at => at.next_down(),
            other => other,
        };
        let is_inside = newton > low && newton < high;
        at = if is_inside && step % HALVED_EACH != 0 {
            newton
        } else {
            middle
        };
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinks_and_flats_are_crossed_to_the_last_bit() {
        for root in [1e-9, 0.1, 0.3, 0.5, 0.77] {
            let f = |x: f64| (x - 0.2).max(0.0) + 3.0 * (x - 0.4).max(0.0) + (x.min(0.1) - 0.1);
            let slope = |x: f64| f64::from(x > 0.2) + 3.0 * f64::from(x > 0.4) + f64::from(x < 0.1);
            let found = crossing([0.0, 1.0], (f(root), 0.0), |x| Sample {
                value: f(x),
                slope: slope(x),
            });
            assert!((f(found) - f(root)).abs() < 1e-15, "{root}: {found}");
        }
    }

    #[test]
    fn a_wrong_slope_finds_the_same() {
        let mut n_samples = 0;
        for slope in [0.0, -1.0, f64::NAN, 1e9, 1e-9] {
            let found = crossing([0.0, 3.0], (2.0, 0.0), |x| {
                n_samples += 1;
                Sample {
                    value: x * x,
                    slope,
                }
            });
            assert!((found - 2f64.sqrt()).abs() < 1e-15, "{slope}: {found}");
        }
        assert!(n_samples < 5 * 200, "{n_samples}");
    }

    #[test]
    fn a_jump_is_crossed_at_its_upper_side() {
        let step = |x: f64| Sample {
            value: if x < 0.25 { -1.0 } else { 2.0 },
            slope: 0.0,
        };
        assert_eq!(crossing([0.0, 1.0], (0.0, 1e-12), step), 0.25);
    }
}
