//! The part on contact: what an evaluation of each model costs, and how wrong it is.

use super::engines::METHODS;
use super::models::Models;
use super::rows::{ContactWay, Touched};
use super::study::{SpeedAccuracyRows, SpeedAccuracyStudy};
use super::subject::{Subject, spread_evenly};
use crate::error::Result;
use crate::kinds::grouped;
use crate::study::pieces::{NamedPiece, PiecesLeft};
use crate::study::sweep::nested;
use crate::study::time_left::Piece;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A work item: all models of an object at rest, or its touches stepped through time by a method, with its step in ms.
#[derive(Clone, Copy)]
struct Item<'a> {
    /// Its number among objects and scans.
    object: usize,
    touched: Touched,
    subject: &'a Subject,
    stepped: Option<(ContactWay, f64)>,
}

/// Seconds for the models of an object, of a scan (which is packed), and for a step of those that are stepped through time, about.
const OBJECT_S: f64 = 0.2;
const SCAN_S: f64 = 30.0;
const STEP_S: f64 = 1e-4;

impl Item<'_> {
    /// What is done with an object shares its models.
    fn piece(&self) -> NamedPiece {
        let name = self.subject.name();
        let at_rest = |name, planned_s| (name, Piece::of_stage(0, planned_s));
        let (name, work) = match (self.stepped, self.touched) {
            (Some((method, dt_ms)), _) => {
                let name = format!("{method:?} of {dt_ms} ms with {name}");
                (name, Piece::one_by_one(1, 1e3 * STEP_S / dt_ms))
            }
            (None, Touched::Object) => at_rest(format!("contact with {name}"), OBJECT_S),
            (None, Touched::Scan) => at_rest(format!("contact with scan {name}"), SCAN_S),
        };
        NamedPiece::new(name, self.object, work)
    }
}

impl SpeedAccuracyStudy {
    /// The models of every object of the study, and of every scan; then methods and steps outside, so that the tables go by them. Scans are
    /// not stepped.
    fn contact_items(&self) -> Vec<Item<'_>> {
        let Some(spec) = &self.plan.parts().contact else {
            return Vec::new();
        };
        let objects = spread_evenly(&self.subjects, spec.objects).into_iter();
        let objects = objects.map(|subject| (Touched::Object, subject));
        let scans = self.scans.iter().map(|scan| (Touched::Scan, scan));
        let at_rest = objects.chain(scans).enumerate();
        let at_rest = at_rest.map(|(object, (touched, subject))| Item {
            object,
            touched,
            subject,
            stepped: None,
        });
        let mut items: Vec<Item> = at_rest.collect();
        let is_object = |item: &&Item| item.touched == Touched::Object;
        let objects: Vec<Item> = items.iter().filter(is_object).copied().collect();
        nested! {
            &method in METHODS;
            &dt_ms in &spec.dt_ms;
            &object in spread_evenly(&objects, spec.stepped_objects);
            items.push(Item { stepped: Some((method, dt_ms)), ..object })
        }
        items
    }

    /// Its work items.
    pub(super) fn contact_pieces(&self) -> Vec<NamedPiece> {
        self.contact_items().iter().map(Item::piece).collect()
    }

    /// Models on all threads, times on one.
    pub(super) fn measure_contact(&self, left: &PiecesLeft<SpeedAccuracyRows>) -> Result<()> {
        let items = left.of(0, self.contact_items());
        let (Some(spec), false) = (&self.plan.parts().contact, items.is_empty()) else {
            return Ok(());
        };
        let objects = grouped(&items, |(_, item)| item.object);
        left.progress.stage("models", objects.len() as u64);
        // One at a time: to pack a mesh takes from seconds to a minute.
        let made = objects.par_iter().with_max_len(1).map(|(object, items)| {
            let numbers: Vec<usize> = items.iter().map(|(number, _)| *number).collect();
            let (_, first) = items[0];
            let of = (first.touched, first.subject);
            let make = || Models::new(&self.plan, spec, of, self.packings.as_deref());
            let made = left.prepare(&numbers, make)?;
            left.progress.advance(1);
            Ok(made.map(|made| (*object, made)))
        });
        let made = made.collect::<Result<Vec<_>>>()?;
        let made: BTreeMap<usize, Models> = made.into_iter().flatten().collect();
        left.progress.stage("time touches", items.len() as u64);
        for (number, item) in &items {
            let Some(models) = made.get(&item.object) else {
                continue;
            };
            left.finish(*number, || {
                let contact = match item.stepped {
                    None => models.at_rest(),
                    Some((method, dt_ms)) => {
                        vec![models.stepped(method, dt_ms, spec.stepped_touches)?]
                    }
                };
                Ok((contact, Vec::new()))
            })?;
        }
        Ok(())
    }
}
