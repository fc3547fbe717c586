//! Turns TOML values into numbers, vectors and words, or says what was expected.

use std::{
    fmt::Display,
    ops::{Bound, RangeBounds},
};

use glam::DVec3;
use toml::de::DeValue;

use super::report::{Complaint, advice};

/// Any finite number.
pub(super) const ANY: (Bound<f64>, Bound<f64>) = (Bound::Unbounded, Bound::Unbounded);
/// Greater than zero.
pub(super) const POSITIVE: (Bound<f64>, Bound<f64>) = (Bound::Excluded(0.0), Bound::Unbounded);

fn expected(what: &str, found: &DeValue<'_>) -> Complaint {
    Complaint::new(format!("expected {what}, found {}", found.type_str()))
}

/// What a value outside `range` is told.
fn check<T: PartialOrd + Display>(value: T, range: &impl RangeBounds<T>) -> Result<T, Complaint> {
    if range.contains(&value) {
        return Ok(value);
    }
    let low = match range.start_bound() {
        Bound::Included(low) => Some(format!("at least {low}")),
        Bound::Excluded(low) => Some(format!("greater than {low}")),
        Bound::Unbounded => None,
    };
    let high = match range.end_bound() {
        Bound::Included(high) => Some(format!("at most {high}")),
        Bound::Excluded(high) => Some(format!("less than {high}")),
        Bound::Unbounded => None,
    };
    let range = low.into_iter().chain(high).collect::<Vec<_>>().join(" and ");
    Err(Complaint::new(format!("must be {range}, is {value}")))
}

/// The number a value holds, of any size.
fn raw_number(value: &DeValue<'_>) -> Result<f64, Complaint> {
    match value {
        DeValue::Integer(_) => Ok(raw_integer(value)? as f64),
        DeValue::Float(float) => float.as_str().parse().map_err(|_| expected("a number", value)),
        _ => Err(expected("a number", value)),
    }
}

fn raw_integer(value: &DeValue<'_>) -> Result<i64, Complaint> {
    let DeValue::Integer(integer) = value else { return Err(expected("a whole number", value)) };
    i64::from_str_radix(integer.as_str(), integer.radix())
        .map_err(|_| Complaint::new(format!("{integer} is too large")))
}

/// A finite number in `range`.
pub(super) fn number(range: impl RangeBounds<f64>) -> impl FnOnce(&DeValue<'_>) -> Result<f64, Complaint> {
    move |value| finite(raw_number(value)?, &range)
}

/// Numbers are kept as `f32` in the scene: none may become infinite there.
fn finite(value: f64, range: &impl RangeBounds<f64>) -> Result<f64, Complaint> {
    if !value.is_finite() {
        Err(Complaint::new(format!("must be finite, is {value}")))
    } else if !(value as f32).is_finite() {
        Err(Complaint::new(format!("is too large: {value:e}")))
    } else {
        check(value, range)
    }
}

/// A number greater than zero, or infinity.
pub(super) fn distance_or_infinity(value: &DeValue<'_>) -> Result<f64, Complaint> {
    check(raw_number(value)?, &POSITIVE)
}

/// A whole number in `range`.
pub(super) fn whole(range: impl RangeBounds<i64>) -> impl FnOnce(&DeValue<'_>) -> Result<i64, Complaint> {
    move |value| check(raw_integer(value)?, &range)
}

/// `N` finite numbers, each in `range`.
pub(super) fn numbers<const N: usize>(
    range: impl RangeBounds<f64>,
) -> impl FnOnce(&DeValue<'_>) -> Result<[f64; N], Complaint> {
    move |value| {
        let what = format!("a list of {N} numbers");
        let DeValue::Array(items) = value else { return Err(expected(&what, value)) };
        let values: Vec<f64> =
            items.iter().map(|item| finite(raw_number(item.get_ref())?, &range)).collect::<Result<_, _>>()?;
        let len = values.len();
        values.try_into().map_err(|_| Complaint::new(format!("expected {what}, found {len}")))
    }
}

/// Three finite numbers.
pub(super) fn vector(value: &DeValue<'_>) -> Result<DVec3, Complaint> {
    numbers(ANY)(value).map(DVec3::from_array)
}

/// `true` or `false`.
pub(super) fn flag(value: &DeValue<'_>) -> Result<bool, Complaint> {
    value.as_bool().ok_or_else(|| expected("true or false", value))
}

/// A string that is not empty.
pub(super) fn text(value: &DeValue<'_>) -> Result<String, Complaint> {
    match value.as_str() {
        Some("") => Err(Complaint::new("must not be empty")),
        Some(text) => Ok(text.to_owned()),
        None => Err(expected("a string", value)),
    }
}

/// A list of strings.
pub(super) fn texts(value: &DeValue<'_>) -> Result<Vec<String>, Complaint> {
    let DeValue::Array(items) = value else { return Err(expected("a list of strings", value)) };
    items.iter().map(|item| text(item.get_ref())).collect()
}

/// One of several words.
pub(super) fn choice<T: Copy, const N: usize>(
    words: [(&'static str, T); N],
) -> impl FnOnce(&DeValue<'_>) -> Result<T, Complaint> {
    move |value| {
        let word = text(value)?;
        words.iter().find(|(name, _)| *name == word).map(|&(_, meaning)| meaning).ok_or_else(|| {
            Complaint::new(format!("\"{}\" is not known here", word.escape_debug()))
                .hint(advice(&word, words.map(|(name, _)| name)))
        })
    }
}

/// A quantity with its unit as a string, or as a bare number that means the same as the number in a string.
pub(super) fn quantity<T>(
    parse: fn(&str) -> Result<T, String>,
) -> impl FnOnce(&DeValue<'_>) -> Result<T, Complaint> {
    move |value| {
        let written = match value {
            DeValue::String(text) => text.to_string(),
            _ => raw_number(value)?.to_string(),
        };
        parse(&written).map_err(Complaint::new)
    }
}
