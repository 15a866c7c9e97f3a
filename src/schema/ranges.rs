//! Bounds of numbers in generated JSON schemas.

use serde_json::{Map, Value};

/// Smallest positive number that a key may have. A smaller lower bound is written as `exclusiveMinimum: 0`.
const LEAST_POSITIVE: f64 = 1e-12;

/// Adds the bounds of allowed numbers to the schema of a key: to single numbers, list elements, and axis values.
pub(super) fn bound(schema: &mut Value, path: &str, is_allowed: impl Fn(f64) -> bool) {
    let bounds = bounds(is_allowed);
    for key in at(schema, path) {
        bound_numbers(key, &bounds);
    }
}

/// Returns all schemas of a key; a table with variants has several.
fn at<'s>(schema: &'s mut Value, path: &str) -> Vec<&'s mut Value> {
    let (name, rest) = path
        .split_once('.')
        .map_or((path, None), |(name, rest)| (name, Some(rest)));
    let mut found = Vec::new();
    for table in tables(schema) {
        let Some(key) = table
            .get_mut("properties")
            .and_then(|keys| keys.get_mut(name))
        else {
            continue;
        };
        match rest {
            None => found.push(key),
            Some(rest) => found.extend(at(key, rest)),
        }
    }
    found
}

/// Returns the tables that a value may have according to its schema: the value itself, list entries, or variants.
fn tables(schema: &mut Value) -> Vec<&mut Value> {
    if schema["type"] == "array" {
        return tables(&mut schema["items"]);
    }
    match schema.get("oneOf").is_some() {
        true => schema["oneOf"]
            .as_array_mut()
            .into_iter()
            .flatten()
            .collect(),
        false => vec![schema],
    }
}

fn bound_numbers(schema: &mut Value, bounds: &Map<String, Value>) {
    match schema["type"].as_str() {
        Some("number" | "integer") => {
            if let Some(keywords) = schema.as_object_mut() {
                keywords.extend(bounds.clone());
            }
        }
        Some("array") if schema.get("items").is_some() => {
            bound_numbers(&mut schema["items"], bounds)
        }
        _ => {
            let choices = schema.get_mut("anyOf").and_then(Value::as_array_mut);
            for choice in choices.into_iter().flatten() {
                bound_numbers(choice, bounds);
            }
        }
    }
}

/// Returns the schema keywords for the interval of allowed numbers around 0 or 1; no keywords if neither is allowed.
fn bounds(is_allowed: impl Fn(f64) -> bool) -> Map<String, Value> {
    let mut keywords = Map::new();
    let Some(low) = [0.0, 1.0, 2.0, 0.5]
        .into_iter()
        .find(|&number| is_allowed(number))
    else {
        return keywords;
    };
    let high = if is_allowed(1.0) { 1.0 } else { low };
    let mut add = |inclusive: &str, exclusive: &str, bound: f64, beyond: f64| {
        // A bound that is excluded has fewer digits than its neighbour.
        let is_excluded = beyond.to_string().len() < bound.to_string().len();
        let (name, bound) = match is_excluded {
            _ if bound == LEAST_POSITIVE => (exclusive, 0.0),
            true => (exclusive, beyond),
            false => (inclusive, bound),
        };
        keywords.insert(name.to_owned(), number(bound));
    };
    if !is_allowed(-f64::MAX) {
        let bound = last_allowed(low, -f64::MAX, &is_allowed);
        add("minimum", "exclusiveMinimum", bound, bound.next_down());
    }
    if !is_allowed(f64::MAX) {
        let bound = last_allowed(high, f64::MAX, &is_allowed);
        add("maximum", "exclusiveMaximum", bound, bound.next_up());
    }
    keywords
}

/// Returns a number without a fraction as an integer.
fn number(value: f64) -> Value {
    match value.fract() == 0.0 && value.abs() < 1e15 {
        true => (value as i64).into(),
        false => value.into(),
    }
}

/// Returns the last allowed number between an allowed and a refused number, by bisection over the ordered numbers. If the neighbours of the allowed number are
/// not allowed, only whole numbers are.
fn last_allowed(allowed: f64, refused: f64, is_allowed: impl Fn(f64) -> bool) -> f64 {
    const NEAR: f64 = 1e-9;
    if !is_allowed(allowed + NEAR) && !is_allowed(allowed - NEAR) {
        let most = refused.clamp(-MAX_WHOLE, MAX_WHOLE) as i128;
        let number = |number: i128| number as f64;
        return number(bisect(allowed as i128, most, |whole| {
            is_allowed(number(whole))
        }));
    }
    // Consecutive floating-point numbers have consecutive keys.
    let key = |number: f64| {
        let bits = number.to_bits() as i64;
        i128::from(if bits < 0 { i64::MIN - bits } else { bits })
    };
    let number = |key: i128| {
        let key = key as i64;
        f64::from_bits(if key < 0 {
            (i64::MIN - key) as u64
        } else {
            key as u64
        })
    };
    number(bisect(key(allowed), key(refused), |key| {
        is_allowed(number(key))
    }))
}

/// Largest number below which every integer is an exact f64.
const MAX_WHOLE: f64 = 9_007_199_254_740_992.0;

/// Returns the last integer for which `is_inside` is true between `inside` (true) and `outside` (false), by bisection.
fn bisect(mut inside: i128, mut outside: i128, is_inside: impl Fn(i128) -> bool) -> i128 {
    while (outside - inside).abs() > 1 {
        let middle = inside + (outside - inside) / 2;
        match is_inside(middle) {
            true => inside = middle,
            false => outside = middle,
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn bounds_are_those_of_the_predicate() {
        let positive = |number: f64| number.is_finite() && number >= 1e-12;
        for (found, expected) in [
            (bounds(positive), json!({ "exclusiveMinimum": 0 })),
            (bounds(|n| n == 0.0 || positive(n)), json!({ "minimum": 0 })),
            (
                bounds(|n| n > 0.0 && n < 1.0),
                json!({ "exclusiveMinimum": 0, "exclusiveMaximum": 1 }),
            ),
            (
                bounds(|n| (0.0..=0.25).contains(&n)),
                json!({ "minimum": 0, "maximum": 0.25 }),
            ),
            (
                bounds(|n| (2.0..=1e8).contains(&n)),
                json!({ "minimum": 2, "maximum": 100_000_000 }),
            ),
            (
                bounds(|n| n.fract() == 0.0 && (0.0..=24.0).contains(&n)),
                json!({ "minimum": 0, "maximum": 24 }),
            ),
            (
                bounds(|n| n.fract() == 0.0 && (1.0..=1e8).contains(&n)),
                json!({ "minimum": 1, "maximum": 100_000_000 }),
            ),
            (bounds(f64::is_finite), json!({})),
            (
                bounds(|n| n > -90.0 && n <= 45.5),
                json!({ "exclusiveMinimum": -90, "maximum": 45.5 }),
            ),
        ] {
            assert_eq!(Value::from(found), expected);
        }
    }

    #[test]
    fn a_bound_reaches_lists_axes_and_variants() {
        let number = json!({ "type": "number" });
        let axis = json!({ "anyOf": [number, { "type": "array", "items": number }, { "type": "string" }] });
        let mut schema = json!({ "properties": { "a": { "type": "array", "items": {
            "oneOf": [{ "properties": { "b": { "properties": { "c": axis } } } }]
        } } } });
        bound(&mut schema, "a.b.c", |number| number >= 2.0);
        let c =
            &schema["properties"]["a"]["items"]["oneOf"][0]["properties"]["b"]["properties"]["c"];
        let bounded = json!({ "type": "number", "minimum": 2 });
        let expected = json!({ "anyOf": [bounded, { "type": "array", "items": bounded }, { "type": "string" }] });
        assert_eq!(*c, expected);
    }
}
