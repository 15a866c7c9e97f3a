//! An object on its way over a body: where it touches first, and what the steps of its path do and cost.

use super::path::Path;
use super::recognition::Compression;
use super::rows::{BodyCount, BodyTime, Stage};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::SphereUnion;
use crate::quantile::quantile;
use crate::study::millimetres;
use crate::whole_body::{BodyContact, BodyState, SphereClusters, WholeBody};
use glam::DVec3;
use ndarray::ArrayView2;
use std::time::Instant;

/// Steps before it counts: memory grows, and comes near the processor.
const WARM_UP: usize = 20;
/// What a damped taxel has forgotten after, seconds.
const FORGOTTEN: f64 = 1e9;
/// Of the search for the first contact, metres: steps, and how near it comes.
const SEARCH_STEP: f64 = 1e-3;
const SEARCH_END: f64 = 1e-7;
/// How far outside of a first touch the search begins, metres.
const SEARCH_START: f64 = 0.05;

/// A body and where its patches are.
pub(super) struct PosedBody<'a> {
    pub body: &'a WholeBody,
    pub poses: Vec<Pose>,
}

/// An object on its way.
pub(super) struct Drive<'a> {
    body: &'a WholeBody,
    state: BodyState,
    object: [SphereClusters; 1],
    pub path: Path,
}

/// What came of the steps of a path.
pub(super) struct Driven {
    pub count: BodyCount,
    pub times: Vec<BodyTime>,
    /// Of each compression: the sum of all measurements' sizes, millimetres, and how often each label was decided on.
    pub sensed: Vec<(f64, Vec<usize>)>,
}

impl<'a> Drive<'a> {
    pub fn new(posed: &PosedBody<'a>, object: &SphereUnion, path: Path) -> Self {
        let mut state = BodyState::at_rest(posed.body);
        state.place(posed.body, &posed.poses);
        Self {
            body: posed.body,
            state,
            object: [SphereClusters::new(object)],
            path,
        }
    }

    pub fn n_spheres(&self) -> usize {
        self.object[0].n_spheres()
    }

    /// Touches at the start of a path, as if nothing had been before.
    pub fn probe(&mut self, path: &Path) -> BodyContact {
        let pose = [path.at(0.0)];
        self.state.press(self.body, &self.object, &pose, FORGOTTEN)
    }

    /// The touched taxels of the last press: number, and metres.
    pub fn touched(&self) -> impl Iterator<Item = (usize, f64)> {
        self.state.touched(self.body)
    }

    /// Moves the start of the path along `from` (unit, out of the skin) to `depth` metres past the first contact on the way in.
    pub fn approach(&mut self, from: DVec3, depth: f64) -> Result<()> {
        let reach = self.object[0].ball().radius + self.object[0].ball().center.length();
        let path = self.path;
        let mut is_touched = |away: f64| self.probe(&path.shifted(away * from)).n_touched > 0;
        let mut outside = reach + SEARCH_START;
        while !is_touched(outside - SEARCH_STEP) {
            outside -= SEARCH_STEP;
            if outside < -reach {
                let allowed = "a place and a direction from which the object meets the skin";
                return Err(Error::input("approach", "no contact", allowed));
            }
        }
        let mut inside = outside - SEARCH_STEP;
        while outside - inside > SEARCH_END {
            let middle = 0.5 * (outside + inside);
            match is_touched(middle) {
                true => inside = middle,
                false => outside = middle,
            }
        }
        self.path = path.shifted((inside - depth) * from);
        Ok(())
    }

    /// Goes along the path, after some steps that do not count; where there are threads, also once more with one alone.
    pub fn run(&mut self, n_steps: usize, dt: f64, compressions: &[Compression]) -> Result<Driven> {
        // Within the pool, as otherwise each step would have to be handed over to it.
        let mut driven = rayon::scope(|_| self.walk(n_steps, dt, compressions))?;
        if rayon::current_num_threads() > 1 {
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
            let alone = alone.expect("a thread can be had");
            // With all that comes between two steps, as it fills the caches.
            let alone = alone.install(|| self.walk(n_steps, dt, compressions))?;
            let presses = alone.times.into_iter();
            let presses = presses.filter(|time| time.stage == Stage::Press);
            driven.times.extend(presses);
        }
        Ok(driven)
    }

    fn walk(&mut self, n_steps: usize, dt: f64, compressions: &[Compression]) -> Result<Driven> {
        let away = [Pose::from_translation(DVec3::splat(1e6))];
        self.state.press(self.body, &self.object, &away, FORGOTTEN);
        let n_bytes = self.body.n_bytes() + self.state.n_bytes();
        let mut tally = Tally::new(n_steps, compressions);
        for step in 0..WARM_UP + n_steps {
            if step == WARM_UP {
                tally = Tally::new(n_steps, compressions);
            }
            let pose = [self.path.at(step as f64 * dt)];
            let start = Instant::now();
            let contact = self.state.press(self.body, &self.object, &pose, dt);
            let pressed = start.elapsed().as_secs_f64();
            tally.add(contact, self.state.n_visited(), self.touched(), pressed);
            for (compression, sense) in compressions.iter().zip(&mut tally.senses) {
                sense.step(compression, self.state.touched(self.body), pressed)?;
            }
        }
        Ok(tally.finish(n_bytes as f64 / self.body.n_taxels() as f64))
    }
}

/// What adds up over steps.
struct Tally<'a> {
    touched: Vec<usize>,
    /// Of all steps.
    contact: BodyContact,
    n_visited: usize,
    deflection_sum: f64,
    press: Vec<f64>,
    senses: Vec<Sense<'a>>,
}

/// The same of a compression; times in seconds.
struct Sense<'a> {
    name: &'a str,
    measurements: Vec<f64>,
    measurement_sum: f64,
    decisions: Vec<usize>,
    compress: Vec<f64>,
    classify: Vec<f64>,
    whole: Vec<f64>,
}

impl<'a> Tally<'a> {
    fn new(n_steps: usize, compressions: &'a [Compression]) -> Self {
        let room = || Vec::with_capacity(n_steps.max(WARM_UP));
        let sense = |compression: &'a Compression| Sense {
            name: &compression.score.compression,
            measurements: vec![0.0; compression.columns.n_measurements()],
            measurement_sum: 0.0,
            decisions: vec![0; compression.score.n_objects],
            compress: room(),
            classify: room(),
            whole: room(),
        };
        Self {
            touched: Vec::with_capacity(n_steps.max(WARM_UP)),
            contact: BodyContact::default(),
            n_visited: 0,
            deflection_sum: 0.0,
            press: room(),
            senses: compressions.iter().map(sense).collect(),
        }
    }

    fn add(
        &mut self,
        contact: BodyContact,
        n_visited: usize,
        touched: impl Iterator<Item = (usize, f64)>,
        pressed: f64,
    ) {
        self.touched.push(contact.n_touched);
        self.contact.n_saturated += contact.n_saturated;
        self.contact.n_patches += contact.n_patches;
        self.contact.n_evaluated += contact.n_evaluated;
        self.contact.n_rejected += contact.n_rejected;
        self.n_visited += n_visited;
        self.deflection_sum += touched.map(|(_, deflection)| deflection).sum::<f64>();
        self.press.push(pressed);
    }

    fn finish(mut self, bytes_per_taxel: f64) -> Driven {
        let n_steps = self.touched.len();
        let mean = |sum: usize| sum as f64 / n_steps as f64;
        let mut times = vec![time(Stage::Press, "", &mut self.press)];
        for sense in &mut self.senses {
            times.push(time(Stage::Compress, sense.name, &mut sense.compress));
            times.push(time(Stage::Classify, sense.name, &mut sense.classify));
            times.push(time(Stage::Whole, sense.name, &mut sense.whole));
        }
        Driven {
            count: BodyCount {
                n_steps,
                touched_mean: mean(self.touched.iter().sum()),
                touched_min: self.touched.iter().copied().min().unwrap_or(0),
                touched_max: self.touched.iter().copied().max().unwrap_or(0),
                saturated_mean: mean(self.contact.n_saturated),
                patches_visited_mean: mean(self.n_visited),
                patches_touched_mean: mean(self.contact.n_patches),
                spheres_evaluated_mean: mean(self.contact.n_evaluated),
                spheres_rejected_mean: mean(self.contact.n_rejected),
                deflection_sum_mm: millimetres(self.deflection_sum),
                bytes_per_taxel,
            },
            times,
            sensed: self
                .senses
                .into_iter()
                .map(|sense| (millimetres(sense.measurement_sum), sense.decisions))
                .collect(),
        }
    }
}

impl Sense<'_> {
    fn step(
        &mut self,
        compression: &Compression,
        touched: impl Iterator<Item = (usize, f64)>,
        pressed: f64,
    ) -> Result<()> {
        let start = Instant::now();
        compression
            .columns
            .measure_touched(touched, &mut self.measurements);
        let compressed = start.elapsed().as_secs_f64();
        let row = ArrayView2::from_shape((1, self.measurements.len()), &self.measurements)
            .expect("one row");
        let label = compression.classifier.labels(row)?[0];
        let both = start.elapsed().as_secs_f64();
        self.decisions[label] += 1;
        self.measurement_sum += self.measurements.iter().map(|y| y.abs()).sum::<f64>();
        self.compress.push(compressed);
        self.classify.push(both - compressed);
        self.whole.push(pressed + both);
        Ok(())
    }
}

fn time(stage: Stage, compression: &str, seconds: &mut [f64]) -> BodyTime {
    let us_median = 1e6 * quantile(seconds, 0.5);
    BodyTime {
        stage,
        compression: compression.to_owned(),
        n_threads: rayon::current_num_threads(),
        us_median,
        us_p05: 1e6 * quantile(seconds, 0.05),
        us_p95: 1e6 * quantile(seconds, 0.95),
        steps_per_s: 1e6 / us_median,
    }
}
