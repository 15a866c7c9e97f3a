//! Generation of an object's touches from placement rules.

use super::placement::{Placement, Spread, Touch, TouchAxis};
use super::rest::RestPose;
use crate::error::{Error, Result};
use crate::random::Seed;
use rand::Rng;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

/// Maximum number of touches of one object, far above any study. The limit stops a mistyped list before memory runs out.
pub const MAX_TOUCHES: usize = 10_000_000;

/// Touches of one object, chosen by the rules of a [`Placement`]. Touches are created one at a time, so even millions need no memory.
#[derive(Clone, Debug)]
pub struct TouchSource<'a> {
    spreads: [(TouchAxis, &'a Spread); 6],
    rests: &'a [RestPose],
    seed: Seed,
    order: Order,
}

/// Rule that maps the index of a touch to its coordinates.
#[derive(Clone, Debug)]
enum Order {
    /// Total of `n` touches, each drawn randomly from its own index.
    Drawn(usize),
    /// All `n` combinations of listed values, in order.
    Product(usize),
    /// Randomly chosen combinations of listed values, by their indices.
    Chosen(Vec<usize>),
}

impl<'a> TouchSource<'a> {
    /// Prepares the touches of an object with the given resting poses, and checks the placement; `seed` is the object's seed.
    ///
    /// # Errors
    /// - If there is no resting pose, or the probabilities are invalid.
    /// - If a spread is empty, repeats a value or leaves its range, or is uniform without `per_object`.
    /// - If the number of touches is zero, above ten million, or above the number of combinations.
    pub fn new(placement: &'a Placement, rests: &'a [RestPose], seed: &Seed) -> Result<Self> {
        check_rests(rests)?;
        let spreads = placement.spreads();
        for (axis, spread) in spreads {
            check_spread(axis, spread)?;
        }
        Ok(Self {
            spreads,
            rests,
            seed: *seed,
            order: order(&spreads, rests.len(), placement.per_object, seed)?,
        })
    }

    /// Returns the number of touches of the object.
    pub fn n_touches(&self) -> usize {
        match &self.order {
            Order::Drawn(n) | Order::Product(n) => *n,
            Order::Chosen(combinations) => combinations.len(),
        }
    }

    /// Returns the touch with the given index, which must be below `n_touches`.
    ///
    /// # Panics
    /// If combinations are chosen and the index is not below `n_touches`.
    pub fn touch(&self, number: usize) -> Touch {
        match &self.order {
            Order::Drawn(_) => {
                let seed = self.seed.numbered(number as u64);
                drawn(&self.spreads, self.rests, &seed)
            }
            Order::Product(_) => combined(&values(&self.spreads), number),
            Order::Chosen(combinations) => combined(&values(&self.spreads), combinations[number]),
        }
    }
}

/// Returns all touches of one object.
///
/// # Errors
/// If the placement is invalid.
pub fn touches(placement: &Placement, rests: &[RestPose], seed: &Seed) -> Result<Vec<Touch>> {
    let source = TouchSource::new(placement, rests, seed)?;
    Ok((0..source.n_touches()).map(|n| source.touch(n)).collect())
}

fn order(
    spreads: &[(TouchAxis, &Spread); 6],
    n_rests: usize,
    count: Option<usize>,
    seed: &Seed,
) -> Result<Order> {
    let is_uniform = |(_, spread): &&(_, &Spread)| matches!(spread, Spread::Uniform { .. });
    if let Some((axis, _)) = spreads.iter().find(is_uniform) {
        return match count {
            Some(count @ 1..=MAX_TOUCHES) => Ok(Order::Drawn(count)),
            Some(count) => Err(count_error(count, MAX_TOUCHES, "")),
            None => {
                let given = format!("no number, with {} spread uniformly", axis.name());
                Err(count_error(given, MAX_TOUCHES, ""))
            }
        };
    }
    let sizes = values(spreads).map(<[f64]>::len).into_iter();
    let n_combinations = sizes.fold(n_rests, usize::saturating_mul);
    let most = n_combinations.min(MAX_TOUCHES);
    match count {
        None if n_combinations <= MAX_TOUCHES => Ok(Order::Product(n_combinations)),
        Some(count) if (1..=most).contains(&count) => Ok(Order::Chosen(without_replacement(
            n_combinations,
            count,
            seed,
        ))),
        given => {
            let reason = match most {
                MAX_TOUCHES => "",
                1 => ", the only pose: no value of it varies (a list or a uniform range would)",
                _ => ", the combinations of the listed values (a uniform range gives more)",
            };
            Err(count_error(given.unwrap_or(n_combinations), most, reason))
        }
    }
}

/// Returns the listed values of each axis; an empty list for an axis with a uniform range.
fn values<'a>(spreads: &[(TouchAxis, &'a Spread); 6]) -> [&'a [f64]; 6] {
    spreads.map(|(_, spread)| match spread {
        Spread::Values(values) => values.as_slice(),
        Spread::Uniform { .. } => &[],
    })
}

/// Returns the touch for the combination of listed values with the given index; the last axis varies fastest.
fn combined(values: &[&[f64]; 6], mut combination: usize) -> Touch {
    let mut indices = [0; 7];
    for (axis, values) in values.iter().enumerate().rev() {
        indices[axis + 1] = combination % values.len();
        combination /= values.len();
    }
    indices[0] = combination;
    let coordinates = std::array::from_fn(|axis| values[axis][indices[axis + 1]]);
    touch_at(coordinates, indices.map(Some))
}

/// Returns `count` different numbers below `n` in random order. The function shuffles and stores only the moved entries. The result for a smaller count is a
/// prefix of the result for a larger count.
fn without_replacement(n: usize, count: usize, seed: &Seed) -> Vec<usize> {
    let mut rng = seed.named("combinations").rng();
    let mut moved = HashMap::new();
    (0..count)
        .map(|place| {
            let other = rng.gen_range(place as u64..n as u64) as usize;
            let here = moved.get(&place).copied().unwrap_or(place);
            moved.insert(other, here).unwrap_or(other)
        })
        .collect()
}

/// Draws one touch with a random stream for each axis, so that changing one range does not change the values of other axes.
fn drawn(spreads: &[(TouchAxis, &Spread); 6], rests: &[RestPose], touch: &Seed) -> Touch {
    let draw = |axis: TouchAxis| touch.named(axis.name()).rng();
    let mut indices = [None; 7];
    indices[0] = Some(drawn_rest(rests, draw(TouchAxis::Rest).r#gen()));
    let mut coordinates = [0.0; 6];
    for (place, (axis, spread)) in spreads.iter().enumerate() {
        let mut rng = draw(*axis);
        coordinates[place] = match spread {
            Spread::Uniform { low, high } => low + (high - low) * rng.r#gen::<f64>(),
            Spread::Values(values) => {
                let index = rng.gen_range(0..values.len() as u64) as usize;
                indices[place + 1] = Some(index);
                values[index]
            }
        };
    }
    touch_at(coordinates, indices)
}

/// Returns the index of the resting pose whose part of the interval [0, 1) contains `position`.
fn drawn_rest(rests: &[RestPose], position: f64) -> usize {
    let total: f64 = rests.iter().map(|rest| rest.probability).sum();
    let mut left = position * total;
    for (index, rest) in rests.iter().enumerate() {
        left -= rest.probability;
        if left < 0.0 {
            return index;
        }
    }
    rests.len() - 1
}

/// Creates a touch from six coordinates (in the order of [`TouchAxis`], without the resting pose) and the indices of their values.
fn touch_at(coordinates: [f64; 6], indices: [Option<usize>; 7]) -> Touch {
    let [offset_x, offset_y, yaw, tilt_x, tilt_y, depth] = coordinates;
    Touch {
        rest: indices[0].unwrap_or(0),
        offset: [offset_x, offset_y],
        yaw,
        tilt: [tilt_x, tilt_y],
        depth,
        indices,
    }
}

fn check_rests(rests: &[RestPose]) -> Result<()> {
    let valid = |p: f64| p.is_finite() && p > 0.0;
    match rests.iter().find(|rest| !valid(rest.probability)) {
        None if rests.is_empty() => Err(Error::input("resting poses", "none", "at least one")),
        None => Ok(()),
        Some(rest) => Err(Error::input(
            "resting poses",
            format!("probability {}", rest.probability),
            "positive numbers",
        )),
    }
}

fn check_spread(axis: TouchAxis, spread: &Spread) -> Result<()> {
    let refuse = |given: String, allowed: &str| Err(Error::input(axis.name(), given, allowed));
    let ends: &[f64] = match spread {
        Spread::Values(values) => values,
        Spread::Uniform { low, high } if low > high => {
            return refuse(format!("from {low} to {high}"), "a low end below the high");
        }
        Spread::Uniform { low, high } => &[*low, *high],
    };
    if ends.is_empty() {
        return refuse("no values".into(), "at least one value");
    }
    let same = axis.same_poses(ends);
    if let (Spread::Values(_), Some(&(one, other))) = (spread, same.first()) {
        let given = match (ends[one], ends[other]) {
            (one, other) if one == other => format!("{one} twice"),
            (one, other) => format!("{one} and {other}, which are the same pose"),
        };
        return refuse(given, "different values");
    }
    let is_allowed = |value: f64| match axis {
        TouchAxis::Depth => value.is_finite() && value >= 0.0,
        TouchAxis::TiltX | TouchAxis::TiltY => value.abs() < FRAC_PI_2,
        _ => value.is_finite(),
    };
    let allowed = match axis {
        TouchAxis::Depth => "zero or a positive number of metres",
        TouchAxis::TiltX | TouchAxis::TiltY => "less than a quarter turn either way",
        _ => "finite numbers",
    };
    match ends.iter().find(|value| !is_allowed(**value)) {
        Some(value) => refuse(value.to_string(), allowed),
        None => Ok(()),
    }
}

/// Returns the error of a number of touches per object that is not between 1 and `most`; `reason` explains the bound.
fn count_error(given: impl ToString, most: usize, reason: &str) -> Error {
    let allowed = match most {
        1 => format!("1{reason}"),
        _ => format!("a number from 1 to {most}{reason}"),
    };
    Error::input("key touches.per_object", given, allowed)
}
