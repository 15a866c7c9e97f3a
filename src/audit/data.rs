//! Data set that an audit examines: frames, labels, groups and sessions.

use crate::error::{Error, Result};
use crate::note::note;
use ndarray::{Array2, Axis};

/// Recorded frames with optional labels, groups and sessions. Rows are touches in the order of recording.
#[derive(Clone, Debug, Default)]
pub struct AuditData {
    /// Frames of all touches, shape (n_touches · n_frames, n_taxels). NaN and infinite numbers are missing readings.
    pub frames: Array2<f64>,
    /// Number of frames of each touch; at least 1.
    pub n_frames: usize,
    /// Numbers of rows and columns of the taxels; `None` if the taxels form no grid.
    pub grid: Option<(usize, usize)>,
    /// Class number of each touch, from 0; `None` without labels.
    pub labels: Option<Vec<usize>>,
    /// Name of each class.
    pub classes: Vec<String>,
    /// Group of each touch, such as its grasp or day; `None` without groups.
    pub groups: Option<Vec<usize>>,
    /// Session or file of each touch; `None` without sessions.
    pub sessions: Option<Vec<usize>>,
    /// Whether each touch belongs to a given test set; `None` without such a set.
    pub is_test: Option<Vec<bool>>,
    /// Reading at full scale; `None` if unknown.
    pub full_scale: Option<f64>,
    /// Whether the touches are known to be in the order of their times.
    pub is_in_order_of_time: bool,
    /// Number of each touch in its file, if the touches were sorted; otherwise `None`.
    pub numbers: Option<Vec<usize>>,
}

impl AuditData {
    /// Returns the number of touches.
    pub fn n_touches(&self) -> usize {
        self.frames.nrows() / self.n_frames.max(1)
    }

    /// Sorts the touches by their times, and marks their order as the order of recording. Tables still contain the numbers of the touches in the file.
    ///
    /// # Panics
    /// If there are fewer times than touches.
    pub fn sort_by_time(&mut self, times: &[f64]) {
        let continued = unwrapped(times);
        if let Some((_, period)) = &continued {
            note(format_args!(
                "times: the clock wraps around at {period}; the times are read as if they continued"
            ));
        }
        let times = continued.as_ref().map_or(times, |(times, _)| times);
        let mut order: Vec<usize> = (0..self.n_touches()).collect();
        order.sort_by(|&a, &b| times[a].total_cmp(&times[b]).then(a.cmp(&b)));
        let frames_of = |touch: &usize| touch * self.n_frames..(touch + 1) * self.n_frames;
        let frames: Vec<usize> = order.iter().flat_map(frames_of).collect();
        self.frames = self.frames.select(Axis(0), &frames);
        for list in [&mut self.labels, &mut self.groups, &mut self.sessions] {
            if let Some(list) = list.as_mut().filter(|list| list.len() == order.len()) {
                *list = order.iter().map(|&touch| list[touch]).collect();
            }
        }
        if let Some(is_test) = &mut self.is_test {
            *is_test = order.iter().map(|&touch| is_test[touch]).collect();
        }
        let in_file = order.iter().map(|&touch| self.number_in_file(touch));
        self.numbers = Some(in_file.collect());
        self.is_in_order_of_time = true;
    }

    /// Returns the number of a touch in its file, from 0.
    pub fn number_in_file(&self, touch: usize) -> usize {
        let numbers = self.numbers.as_ref();
        numbers.map_or(touch, |numbers| numbers[touch])
    }

    /// Checks that frames, labels, groups and sessions belong together.
    ///
    /// # Errors
    /// If there are no frames, or a list has another length than the number of touches.
    pub fn check(&self) -> Result<()> {
        let n = self.n_touches();
        if self.n_frames == 0 || n < MIN_TOUCHES || self.frames.ncols() == 0 {
            let given = format!("{n} touches of {} taxels", self.frames.ncols());
            let allowed = format!("at least {MIN_TOUCHES} touches of one taxel");
            return Err(Error::input("frames", given, allowed));
        }
        let length = |list: &Option<Vec<usize>>| list.as_ref().map(Vec::len);
        let lists = [
            ("labels", length(&self.labels)),
            ("groups", length(&self.groups)),
            ("sessions", length(&self.sessions)),
            ("is_test", self.is_test.as_ref().map(Vec::len)),
        ];
        for (name, length) in lists {
            if let Some(length) = length.filter(|&length| length != n) {
                let allowed = format!("{n}, one for each touch");
                return Err(Error::input(name, format!("{length} numbers"), allowed));
            }
        }
        let n_classes = self.classes.len();
        let is_wrong = |label: &&usize| **label >= n_classes;
        match self.labels.iter().flatten().find(is_wrong) {
            Some(label) => {
                let allowed = format!("0 to {}", n_classes.saturating_sub(1));
                Err(Error::input("labels", label, allowed))
            }
            None => Ok(()),
        }
    }
}

/// Longest step over the end of a clock's range, in multiples of the longest other step, and shortest range, in the same unit. With a larger step or a shorter
/// range, times of touches that are sorted by class may count as wrapped; with a smaller step, a pause at the end of the range hides it.
const MAX_STEP: f64 = 3.0;
const MIN_STEPS: f64 = 20.0;

/// Returns times that continue where a clock has wrapped around, and the period of the clock. Returns `None` if the times never fall back, or not always by the
/// period of a clock.
fn unwrapped(times: &[f64]) -> Option<(Vec<f64>, f64)> {
    let steps = || times.windows(2).map(|pair| pair[1] - pair[0]);
    let longest = steps().fold(0.0, f64::max);
    if longest == 0.0 || steps().all(|step| step >= 0.0) {
        return None;
    }
    // Counts at which clocks wrap around: 16 to 32 bits, and a minute, an hour and a day in microseconds; factors by which recordings convert them to other
    // units.
    let bits = [16, 24, 31, 32].map(|bits| 2.0_f64.powi(bits));
    let counts = [&bits[..], &[60e6, 3600e6, 86_400e6]].concat();
    let factors = [1.0, 1e-3, 1e-6].into_iter();
    let mut periods = factors.flat_map(|factor| counts.iter().map(move |count| factor * count));
    let is_explained = |period: &f64| {
        let mut back = steps().filter(|&step| step < 0.0);
        let ends = 0.0..=MAX_STEP * longest;
        *period > MIN_STEPS * longest && back.all(|step| ends.contains(&(step + period)))
    };
    let period = periods.find(is_explained)?;
    let mut n_wraps = 0.0;
    let mut continued = times.to_vec();
    for touch in 1..times.len() {
        n_wraps += f64::from(u8::from(times[touch] < times[touch - 1]));
        continued[touch] += n_wraps * period;
    }
    Some((continued, period))
}

/// Minimum number of touches of an audit. With fewer touches, the tests have too little power to find a fault.
const MIN_TOUCHES: usize = 20;
