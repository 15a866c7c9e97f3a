//! The part on recognition in pieces: which chains there are, and the touches that they share.

use super::cost;
use super::plan::{RecognitionSweep, SpeedAccuracyPlan, Tolerance};
use super::recognition::{Bench, one_thread};
use super::subject::{Subject, spread_evenly};
use super::table::SpeedAccuracyTables;
use crate::error::{Error, Result};
use crate::objects::{Model, Object};
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::sensing::Ensemble;
use crate::study::pieces::{NamedPiece, PiecesLeft};
use crate::study::plan::millimetres;
use crate::study::progress::{Progress, Silent};
use crate::study::simulation::{TouchedObject, draw_touches, simulate_array};
use crate::study::time_left::Piece;
use crate::world::Placement;
use rayon::prelude::*;
use std::path::Path;

/// Objects of one detail: what is touched, in places that all details share.
type Details = Vec<Model>;

/// Every chain from touch to answer, on some of the objects.
pub(super) struct RecognitionPart<'a> {
    plan: &'a SpeedAccuracyPlan,
    sweep: &'a RecognitionSweep,
    chosen: Vec<&'a Subject>,
    packings: Option<&'a Path>,
}

/// The objects of a sweep, exact and of each level that is needed.
struct Built {
    exact: Vec<TouchedObject>,
    levels: Vec<Option<Details>>,
}

impl<'a> RecognitionPart<'a> {
    pub fn new(
        plan: &'a SpeedAccuracyPlan,
        sweep: &'a RecognitionSweep,
        (subjects, packings): (&'a [Subject], Option<&'a Path>),
    ) -> Self {
        Self {
            plan,
            sweep,
            chosen: spread_evenly(subjects, sweep.spec.objects),
            packings,
        }
    }

    /// Chains on the same array and detail share their touches.
    pub fn pieces(&self) -> Vec<NamedPiece> {
        let mut pieces = Vec::new();
        for (group, bench) in self.benches().into_iter().enumerate() {
            let named = self.chains(bench).into_iter();
            pieces.extend(named.map(|(name, work)| NamedPiece::new(name, group, work)));
        }
        pieces
    }

    /// Numbers of arrays and levels.
    fn benches(&self) -> Vec<(usize, usize)> {
        let levels = 0..self.sweep.levels.len();
        let arrays = 0..self.sweep.patches.len();
        arrays
            .flat_map(|array| levels.clone().map(move |level| (array, level)))
            .collect()
    }

    fn names(&self, bench: (usize, usize)) -> Vec<String> {
        let chains = self.chains(bench).into_iter();
        chains.map(|(name, _)| name).collect()
    }

    /// Ensembles and ratios.
    fn fronts(&self) -> impl Iterator<Item = (Ensemble, f64)> {
        let spec = &self.sweep.spec;
        let ratios = |&ensemble: &Ensemble| spec.ratio.iter().map(move |&ratio| (ensemble, ratio));
        spec.ensemble.iter().flat_map(ratios)
    }

    /// The chains of a bench, and what each is planned to take.
    fn chains(&self, bench: (usize, usize)) -> Vec<(String, Piece)> {
        let n_taxels = self.n_taxels(bench) as f64;
        let mut chains = Vec::new();
        for front in self.fronts() {
            let kinds = self.sweep.spec.classifier.iter();
            chains.extend(kinds.map(|&kind| {
                let work = cost::chain(kind, n_taxels / front.1);
                (self.chain_name(bench, front, kind), work)
            }));
        }
        chains
    }

    /// What chains of a bench that are left need first: ensembles and ratios, and the classifiers that wait for each.
    pub fn fronts_left(
        &self,
        bench: (usize, usize),
        left: &PiecesLeft<SpeedAccuracyTables>,
    ) -> Vec<((Ensemble, f64), Vec<ClassifierKind>)> {
        let kinds_left = |front| {
            let kinds = self.sweep.spec.classifier.iter().copied();
            let kinds = left.of(kinds, |&kind| self.chain_name(bench, front, kind));
            (!kinds.is_empty()).then_some((front, kinds))
        };
        self.fronts().filter_map(kinds_left).collect()
    }

    /// What the chains that are left share.
    pub fn shared_work(&self, left: &PiecesLeft<SpeedAccuracyTables>) -> Vec<Piece> {
        let mut work = Vec::new();
        for bench in self.benches() {
            let fronts = self.fronts_left(bench, left);
            if !fronts.is_empty() {
                work.push(cost::bench());
            }
            let fronts = fronts.into_iter();
            work.extend(fronts.map(|(front, _)| self.front_work(bench, front)));
        }
        work
    }

    /// What comes before every classifier.
    pub fn front_work(&self, bench: (usize, usize), (ensemble, ratio): (Ensemble, f64)) -> Piece {
        let n_taxels = self.n_taxels(bench);
        let n_touches = self.chosen.len() * self.touches_per_object();
        let n_timed = self.sweep.spec.timed_touches.min(n_touches);
        let projection = (ensemble, n_taxels as f64 / ratio);
        cost::front(projection, n_taxels, (n_touches, n_timed))
    }

    fn n_taxels(&self, bench: (usize, usize)) -> usize {
        self.sweep.patches[bench.0].grid.n_taxels()
    }

    /// To learn from and to test.
    fn touches_per_object(&self) -> usize {
        self.sweep.spec.training_touches + self.sweep.spec.test_touches
    }

    /// What a chain is called as a piece.
    pub fn chain_name(
        &self,
        (array, level): (usize, usize),
        (ensemble, ratio): (Ensemble, f64),
        classifier: ClassifierKind,
    ) -> String {
        let pitch_mm = millimetres(self.sweep.patches[array].grid.pitch);
        let tolerance_mm = self.sweep.levels[level].mm;
        format!(
            "{classifier:?} after {ensemble:?} {ratio}:1 at {pitch_mm} mm, objects within {tolerance_mm} mm"
        )
    }

    /// Touches are made on all threads; fits and decisions are timed on one.
    pub fn measure(&self, left: &PiecesLeft<SpeedAccuracyTables>) -> Result<()> {
        let is_left = |&bench: &(usize, usize)| self.names(bench).iter().any(|name| left.has(name));
        let benches: Vec<_> = self.benches().into_iter().filter(is_left).collect();
        if benches.is_empty() {
            return Ok(());
        }
        if self.chosen.len() < 2 {
            let given = format!("{} objects", self.chosen.len());
            let allowed = "at least 2 to tell apart";
            return Err(Error::input(&self.plan.place, given, allowed));
        }
        let names: Vec<String> = benches.iter().flat_map(|&b| self.names(b)).collect();
        let Some(built) = left.prepare(&names, || self.build(&benches, left.progress))? else {
            return Ok(());
        };
        let n_left = left.of(names, String::clone).len();
        left.progress.stage("recognise", n_left as u64);
        let one_thread = one_thread()?;
        for array in 0..self.sweep.patches.len() {
            let patch = &self.sweep.patches[array];
            let of_array = benches.iter().filter(|bench| bench.0 == array);
            let mut tested = None;
            for &(_, level) in of_array {
                let Some(models) = &built.levels[level] else {
                    continue;
                };
                let mut touched = built.exact.clone();
                for (touched, object) in touched.iter_mut().zip(self.objects(models)) {
                    touched.object = object;
                }
                let simulate = |touched| simulate_array(touched, patch, 1, &Silent);
                let (tested, learned) = left.during(&cost::bench(), || {
                    let tested = tested.get_or_insert_with(|| simulate(&built.exact));
                    (tested, simulate(&touched).kept)
                });
                let bench = Bench {
                    part: self,
                    number: (array, level),
                    sweep: self.sweep,
                    patch,
                    level: self.sweep.levels[level],
                    touched: &touched,
                    learned: &learned,
                    tested: &tested.kept,
                    seed: Seed::new(self.plan.spec.seed),
                    one_thread: &one_thread,
                };
                bench.run(left)?;
            }
        }
        Ok(())
    }

    fn build(&self, benches: &[(usize, usize)], progress: &dyn Progress) -> Result<Built> {
        let n_levels = self.sweep.levels.len();
        let needed = (0..n_levels).map(|level| benches.iter().any(|bench| bench.1 == level));
        let needed: Vec<bool> = needed.collect();
        let n_needed = needed.iter().filter(|&&is_needed| is_needed).count();
        progress.stage("objects", (1 + n_needed) as u64);
        let build = |make: &(dyn Fn(&Subject) -> Result<Model> + Sync)| -> Result<Details> {
            let chosen = self.chosen.par_iter().with_max_len(1);
            let models = chosen.map(|subject| make(subject)).collect();
            progress.advance(1);
            models
        };
        let finest = self.plan.levels[self.plan.levels.len() - 1];
        let exact = build(&|subject| subject.exact(finest))?;
        let packed = |(&level, is_needed): (&Tolerance, bool)| -> Result<Option<Details>> {
            let build = || build(&|subject| subject.packed(level, self.packings));
            is_needed.then(build).transpose()
        };
        let levels = self.sweep.levels.iter().zip(needed).map(packed);
        let levels = levels.collect::<Result<_>>()?;
        let placement = Placement {
            per_object: Some(self.touches_per_object()),
            ..self.plan.placement.clone()
        };
        let seed = Seed::new(self.plan.spec.seed);
        Ok(Built {
            exact: draw_touches(self.objects(&exact), &placement, &seed)?,
            levels,
        })
    }

    fn objects(&self, models: &Details) -> Vec<Object> {
        let pairs = self.chosen.iter().zip(models);
        pairs
            .map(|(subject, model)| Object::of_one_part(subject.name(), model.clone()))
            .collect()
    }
}
