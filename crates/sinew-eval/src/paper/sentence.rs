//! Sentences that hold when one number is where it should be.

use super::Sentence;

/// Holds when `value` is within `share` of `expected`.
pub(super) fn near(
    text: impl Into<String>,
    derivation: &str,
    value: f64,
    expected: f64,
    share: f64,
    unit: &str,
) -> Sentence {
    Sentence {
        text: text.into(),
        criterion: format!(
            "within {:.0} % of {expected} {unit}; {derivation}",
            100.0 * share
        ),
        value,
        unit: unit.into(),
        holds: (value - expected).abs() <= share * expected.abs(),
    }
}

/// Holds when `value` is at most `limit` in size.
pub(super) fn below(
    text: impl Into<String>,
    derivation: &str,
    value: f64,
    limit: f64,
    unit: &str,
) -> Sentence {
    Sentence {
        text: text.into(),
        criterion: format!("at most {limit} {unit}; {derivation}"),
        value,
        unit: unit.into(),
        holds: value.abs() <= limit,
    }
}
