//! How a touch goes in time: from state to state, each movement of least jerk.

/// What changes during a touch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct State {
    /// Of the hand above first contact, metres; negative while it presses.
    pub height: f64,
    /// Slid along the skin, metres.
    pub slid: f64,
    /// How far the fingers have closed, 0 to 1.
    pub closed: f64,
}

/// States one after the other.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Course {
    start: State,
    /// Seconds (not negative), and the state at their end.
    phases: Vec<(f64, State)>,
}

impl Course {
    pub fn from(start: State) -> Self {
        Self {
            start,
            phases: Vec::new(),
        }
    }

    /// The state that it ends in so far.
    pub fn end(&self) -> State {
        self.phases.last().map_or(self.start, |phase| phase.1)
    }

    /// Goes on to a state.
    pub fn go(&mut self, seconds: f64, to: State) {
        self.phases.push((seconds, to));
    }

    /// Stays.
    pub fn wait(&mut self, seconds: f64) {
        self.go(seconds, self.end());
    }

    /// Goes down to `-depth`, of which the last `rise` seconds are below the height 0.
    pub fn press(&mut self, depth: f64, rise: f64) {
        let from = self.end();
        let above = time_of_share(from.height / (from.height + depth));
        let to = State {
            height: -depth,
            ..from
        };
        self.go(rise / (1.0 - above), to);
    }

    /// Goes up to a height, of which the first `fall` seconds are below the height 0.
    pub fn lift(&mut self, height: f64, fall: f64) {
        let from = self.end();
        let below = time_of_share(-from.height / (height - from.height));
        self.go(fall / below, State { height, ..from });
    }

    /// Seconds.
    pub fn duration(&self) -> f64 {
        self.phases.iter().map(|phase| phase.0).sum()
    }

    /// The state at a time in seconds; before the start and after the end it stays.
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

/// Share of the way after a share of the time, both 0 to 1 \[FH\].
fn least_jerk(t: f64) -> f64 {
    t * t * t * (10.0 - t * (15.0 - 6.0 * t))
}

/// Share of the time after which a share of the way is gone.
fn time_of_share(way: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    // Each halving gains a bit of the 53.
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
