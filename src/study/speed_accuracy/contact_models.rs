//! An object in the part on contact: its models, the time of a touch of each, and how wrong it is.

use super::engines::Stepper;
use super::plan::{ContactPlan, SpeedAccuracyPlan, Tolerance};
use super::single_contact::{FlatRows, Precision};
use super::solid_contact::press_solid;
use super::subject::Subject;
use super::table::{
    ContactCell, ContactScore, ContactTime, ContactWay, SpeedAccuracyTables, Touched,
};
use crate::error::Result;
use crate::objects::Model;
use crate::quantile::quantile;
use crate::random::Seed;
use crate::study::object_detail::Truth;
use crate::world::Placement;
use std::path::Path;
use std::time::Instant;

/// Millimetres in a metre.
const MM: f64 = 1e3;
/// How often each touch by rows is timed.
const N_REPEATS: usize = 5;

/// An object with its models and what exact contact says.
pub(super) struct Ready<'a> {
    touched: Touched,
    subject: &'a Subject,
    truth: Truth,
    models: Vec<(ContactWay, Option<Tolerance>, Model)>,
}

/// Makes the models of an object or a scan, and the touches that judge them.
pub(super) fn prepare<'a>(
    plan: &SpeedAccuracyPlan,
    contact: &ContactPlan,
    (touched, subject): (Touched, &'a Subject),
    packings: Option<&Path>,
) -> Result<Ready<'a>> {
    let placement = Placement {
        per_object: Some(contact.spec.touches),
        ..plan.placement.clone()
    };
    let finest = plan.levels[plan.levels.len() - 1];
    let seed = Seed::new(plan.spec.seed);
    let mut models = Vec::new();
    for &level in &plan.levels {
        let packed = subject.packed(level, packings)?;
        models.push((ContactWay::PackedSpheres, Some(level), packed));
    }
    let vertices = subject.vertex_spheres()?;
    models.extend(vertices.map(|model| (ContactWay::VertexSpheres, None, model)));
    let mesh = subject.mesh();
    models.extend(mesh.map(|model| (ContactWay::ExactMesh, None, model)));
    Ok(Ready {
        truth: subject.truth(&plan.patch, &placement, (finest, &seed))?,
        touched,
        subject,
        models,
    })
}

/// Every model at rest, where the pose is given.
pub(super) fn measure_models(
    plan: &SpeedAccuracyPlan,
    object: &Ready,
    tables: &mut SpeedAccuracyTables,
) {
    for (way, tolerance, model) in &object.models {
        let error = object.truth.error(model, 0.0);
        let cell = ContactCell {
            way: *way,
            tolerance_mm: tolerance.map(|tolerance| tolerance.mm),
            ..cell(object, model)
        };
        let score = ContactScore {
            n_touches: object.truth.readings().len(),
            error_mm: Some(MM * error.mean),
            error_p95_mm: Some(MM * error.p95),
            n_steps: None,
        };
        let us_per_touch = 1e6 * object.truth.seconds_per_touch(model);
        push(tables, cell, score, us_per_touch);
    }
    measure_precision(plan, object, tables);
    let Some(solid) = object.subject.solid() else {
        return;
    };
    let timed = object.truth.readings().iter().map(|reading| {
        let start = Instant::now();
        press_solid(&plan.patch, solid, &reading.pressed());
        start.elapsed().as_secs_f64()
    });
    let mut seconds: Vec<f64> = timed.collect();
    let cell = ContactCell {
        way: ContactWay::SolidMarching,
        tolerance_mm: None,
        dt_ms: None,
        touched: object.touched,
        object: object.subject.name().to_owned(),
        n_spheres: 0,
    };
    // It is what says what is right.
    let score = ContactScore {
        n_touches: seconds.len(),
        error_mm: Some(0.0),
        error_p95_mm: Some(0.0),
        n_steps: None,
    };
    let us_per_touch = 1e6 * quantile(&mut seconds, 0.5);
    push(tables, cell, score, us_per_touch);
}

/// The packing of the middle detail by rows of a flat patch, in doubles and in singles.
fn measure_precision(plan: &SpeedAccuracyPlan, object: &Ready, tables: &mut SpeedAccuracyTables) {
    let (_, tolerance, model) = middle_packing(object);
    let (Some(mut rows), Some(spheres)) = (FlatRows::new(&plan.patch), model.spheres()) else {
        return;
    };
    let spheres = spheres.spheres();
    let readings = object.truth.readings();
    for (way, precision) in [
        (ContactWay::RowsInDoubles, Precision::Doubles),
        (ContactWay::RowsInSingles, Precision::Singles),
    ] {
        let mut errors: Vec<f64> = Vec::new();
        for reading in readings {
            rows.press(precision, spheres, &reading.pressed());
            let felt = rows.deflections(precision);
            reading.each_difference(&felt, &mut |difference: f64| errors.push(difference.abs()));
        }
        // Every touch was made once before it counts.
        let timed = (0..N_REPEATS).flat_map(|_| readings).map(|reading| {
            let start = Instant::now();
            rows.press(precision, spheres, &reading.pressed());
            start.elapsed().as_secs_f64()
        });
        let mut seconds: Vec<f64> = timed.collect();
        let cell = ContactCell {
            way,
            tolerance_mm: tolerance.map(|tolerance| tolerance.mm),
            ..cell(object, model)
        };
        let score = ContactScore {
            n_touches: readings.len(),
            error_mm: Some(MM * errors.iter().sum::<f64>() / errors.len().max(1) as f64),
            error_p95_mm: Some(MM * quantile(&mut errors, 0.95)),
            n_steps: None,
        };
        push(tables, cell, score, 1e6 * quantile(&mut seconds, 0.5));
    }
}

/// Touches of one object by one method with one time step.
pub(super) fn measure_stepped(
    cell: ContactCell,
    stepper: &Stepper,
    object: &Ready,
    n_touches: usize,
    tables: &mut SpeedAccuracyTables,
) -> Result<()> {
    let (mut errors, mut seconds, mut n_steps) = (Vec::new(), Vec::new(), 0);
    let mut is_finite = true;
    let readings = object.truth.readings();
    let chosen = &readings[..n_touches.min(readings.len())];
    for reading in chosen {
        let start = Instant::now();
        let stepped = stepper.touch(reading)?;
        seconds.push(start.elapsed().as_secs_f64());
        n_steps = stepped.n_steps;
        match stepped.deflections {
            Some(felt) => reading.each_difference(&felt, &mut |difference: f64| {
                errors.push(difference.abs());
            }),
            None => is_finite = false,
        }
    }
    is_finite &= errors.iter().all(|error: &f64| error.is_finite());
    let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    let score = ContactScore {
        n_touches: chosen.len(),
        error_mm: is_finite.then_some(MM * mean),
        error_p95_mm: is_finite.then(|| MM * quantile(&mut errors, 0.95)),
        n_steps: Some(n_steps),
    };
    push(tables, cell, score, 1e6 * quantile(&mut seconds, 0.5));
    Ok(())
}

/// The packing in the middle of the levels: fine enough not to hide what steps do, and not the dearest.
pub(super) fn middle_packing<'a>(object: &'a Ready) -> &'a (ContactWay, Option<Tolerance>, Model) {
    let is_packing =
        |(way, ..): &&(ContactWay, Option<Tolerance>, Model)| *way == ContactWay::PackedSpheres;
    let packings: Vec<_> = object.models.iter().filter(is_packing).collect();
    packings[packings.len() / 2]
}

/// A row's beginning, but for the way that it is touched.
pub(super) fn cell(object: &Ready, model: &Model) -> ContactCell {
    ContactCell {
        way: ContactWay::PackedSpheres,
        tolerance_mm: None,
        dt_ms: None,
        touched: object.touched,
        object: object.subject.name().to_owned(),
        n_spheres: model.n_spheres(),
    }
}

fn push(
    tables: &mut SpeedAccuracyTables,
    cell: ContactCell,
    score: ContactScore,
    us_per_touch: f64,
) {
    tables.contact.push((cell.clone(), score));
    let time = ContactTime { us_per_touch };
    tables.contact_timing.push((cell, time));
}
