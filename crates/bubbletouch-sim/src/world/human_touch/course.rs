//! Time course of a touch: states of the hand, connected by minimum-jerk movements.

/// State of a hand relative to the touched point of the arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct State {
    /// Height of the hand above its position at first contact, metres; negative while the hand presses.
    pub height: f64,
    /// Displacement of the hand along the skin, metres.
    pub slid: f64,
    /// Fraction to which the fingers are closed, 0 (open) to 1.
    pub closed: f64,
}

/// Time course of a touch by a hand: a start state, and phases that each end in a further state.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Course {
    start: State,
    /// Duration of each phase, seconds (not negative), and the state at its end.
    phases: Vec<(f64, State)>,
}

impl Course {
    pub fn from(start: State) -> Self {
        Self {
            start,
            phases: Vec::new(),
        }
    }

    /// Returns the state of the hand at the end of the course.
    pub fn end(&self) -> State {
        self.phases.last().map_or(self.start, |phase| phase.1)
    }

    /// Appends a movement of `seconds` to the state `to`.
    pub fn go(&mut self, seconds: f64, to: State) {
        self.phases.push((seconds, to));
    }

    /// Appends a pause of `seconds` in the present state.
    pub fn wait(&mut self, seconds: f64) {
        self.go(seconds, self.end());
    }

    /// Appends a descent of the hand to `depth` metres below first contact. The hand is in contact with the skin during the last `rise` seconds.
    pub fn press(&mut self, depth: f64, rise: f64) {
        let from = self.end();
        let above = time_of_share(from.height / (from.height + depth));
        let to = State {
            height: -depth,
            ..from
        };
        self.go(rise / (1.0 - above), to);
    }

    /// Appends an ascent of the hand to `height` metres above first contact. The hand is in contact with the skin during the first `fall` seconds.
    pub fn lift(&mut self, height: f64, fall: f64) {
        let from = self.end();
        let below = time_of_share(-from.height / (height - from.height));
        self.go(fall / below, State { height, ..from });
    }

    /// Returns the duration of the course, seconds.
    pub fn duration(&self) -> f64 {
        self.phases.iter().map(|phase| phase.0).sum()
    }

    /// Returns the state of the hand at a time in seconds; constant before the start and after the end.
    pub fn at(&self, time: f64) -> State {
        let (mut begin, mut from) = (0.0, self.start);
        for &(seconds, to) in &self.phases {
            if time < begin + seconds {
                let share = least_jerk(((time - begin) / seconds).max(0.0));
                let between = |a: f64, b: f64| a + share * (b - a);
                return State {
                    height: between(from.height, to.height),
                    slid: between(from.slid, to.slid),
                    closed: between(from.closed, to.closed),
                };
            }
            begin += seconds;
            from = to;
        }
        from
    }
}

/// Returns the completed fraction of a minimum-jerk movement after the fraction `t` of its duration, both 0 to 1 \[FH\].
fn least_jerk(t: f64) -> f64 {
    t * t * t * (10.0 - t * (15.0 - 6.0 * t))
}

/// Returns the fraction of the duration after which the fraction `way` of a minimum-jerk movement is completed, both 0 to 1.
fn time_of_share(way: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    // Each bisection determines one of the 53 bits.
    for _ in 0..53 {
        let middle = 0.5 * (low + high);
        match least_jerk(middle) < way {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_movement_of_least_jerk_starts_and_ends_at_rest_and_is_undone_by_its_inverse() {
        assert_eq!((least_jerk(0.0), least_jerk(1.0)), (0.0, 1.0));
        let step = 1e-4;
        assert!(least_jerk(step) < 1e-10 && 1.0 - least_jerk(1.0 - step) < 1e-10);
        for k in 1..100 {
            let time = f64::from(k) / 100.0;
            assert!((time_of_share(least_jerk(time)) - time).abs() < 1e-9);
        }
    }

    #[test]
    fn a_press_is_below_the_skin_for_exactly_its_rise_and_fall() {
        let mut course = Course::from(State {
            height: 0.02,
            ..State::default()
        });
        course.press(2e-3, 0.05);
        let deepest = course.duration();
        course.wait(0.3);
        let leaves = course.duration();
        course.lift(0.01, 0.08);
        assert!(course.at(deepest - 0.0501).height > 0.0);
        assert!(course.at(deepest - 0.0499).height < 0.0);
        assert_eq!(course.at(0.5 * (deepest + leaves)).height, -2e-3);
        assert!(course.at(leaves + 0.0799).height < 0.0);
        assert!(course.at(leaves + 0.0801).height > 0.0);
        assert_eq!(course.at(1e9).height, 0.01);
        assert_eq!(course.at(-1.0).height, 0.02);
    }
}
