//! Sentences about ropes: warnings, rejections, name conflicts.

use super::{bracketed, life, share_of_draws, spoken};
use crate::message::Message;
use sinew_figure::rounded;
use sinew_rope::law::CELSIUS_ZERO_K;
use sinew_rope::law::validity::{HMPE_HOT_K, LimitViolation};
use sinew_rope::select::{PossibleViolation, Rejection};
use sinew_rope::{Caution, Namesake, UnreadableRope};

/// Returns a warning about a rope with its code.
pub(crate) fn caution_message(c: Caution) -> Message {
    Message::of(&c, caution(c))
}

/// Formats a warning about a rope or its duty.
pub fn caution(caution: Caution) -> String {
    let outside = |low_load, high_load, hot| {
        let outside = LimitViolation {
            low_load,
            high_load,
            hot,
        };
        outside.to_string()
    };
    match caution {
        Caution::LowLoad => outside(true, false, false),
        Caution::HighLoad => outside(false, true, false),
        Caution::Hot => outside(false, false, true),
        Caution::BreakingLoadAssumed { breaking_load_n } => {
            format!("breaking load not published: {breaking_load_n} N assumed; test the rope")
        }
        Caution::Extrapolated { tests_s } => format!(
            "extrapolates beyond the longest test ({}): parameters assumed, and the model has no process slower than \
             one day; test longer",
            spoken(tests_s)
        ),
        Caution::CreepsApart { time_s } => format!(
            "creep rupture predicted after about {}; no elongation from then on; reduce the load",
            spoken(time_s)
        ),
        Caution::WornOut { time_s } => format!(
            "bending fatigue failure predicted after about {}; no elongation from then on; use larger or fewer pulleys",
            spoken(time_s)
        ),
        Caution::Replace {
            strain_ratio,
            time_s,
            share,
        } => {
            let limit = format!(
                "the manufacturer's replacement limit of {} %",
                specified(100.0 * strain_ratio)
            );
            let share = share_of_draws(share);
            match time_s {
                Some(time_s) => format!(
                    "strain exceeds {limit} after {}, in {share} of the draws at the last time; replace the rope then",
                    spoken(time_s)
                ),
                None => {
                    format!("strain exceeds {limit} in {share} of the draws at the last time")
                }
            }
        }
        Caution::TightBend {
            bend_ratio,
            min_ratio,
        } => format!(
            "bending ratio D/d of {} is below the recommended minimum of {}: internal abrasion and fibre breakage; use a \
             larger pulley or a thinner rope",
            short(bend_ratio),
            specified(min_ratio)
        ),
        Caution::LoadShare {
            load_share,
            max_share,
        } => format!(
            "largest tension is {} % of the breaking load (recommended maximum {} %): creep, bending fatigue and abrasion \
             accelerate above; use a stronger rope",
            short(100.0 * load_share),
            specified(100.0 * max_share)
        ),
        Caution::TerminationNotSpecified {
            splice_share,
            knot_share,
        } => format!(
            "termination not specified: assumed as strong as the rope (a splice retains about {} %, a knot {} %); \
             specify --termination",
            rounded(100.0 * splice_share, 2),
            rounded(100.0 * knot_share, 2)
        ),
        Caution::BeyondData {
            tested_range,
            load_share,
            temperature_c,
            duration_s,
            factor,
        } => {
            let percent = |share: [f64; 2]| range(share.map(|s| 100.0 * s), "%");
            format!(
                "extrapolates beyond the tested range ({} of the breaking load, {}, {}): requested {}, {}, {}; intervals \
                 widened by a factor of up to {}",
                percent(tested_range.load_share),
                range(tested_range.temperature_c, "°C"),
                spoken(tested_range.duration_s),
                percent(load_share),
                range(temperature_c, "°C"),
                spoken(duration_s),
                short(factor)
            )
        }
        Caution::AssumedParameters {
            assumed,
            parameters,
        } => format!(
            "{assumed} of {parameters} parameters assumed, not measured; validate the plan on one rope before using it on \
             several"
        ),
    }
}

/// States that a file uses the name of another rope.
pub fn namesake(n: &Namesake) -> String {
    let (file, name) = (n.file.display(), &n.name);
    if n.replaces {
        format!("{file} replaces the catalogue rope '{name}'; use another name for another rope")
    } else {
        format!("{file} is a copy of '{name}' with the same name; rename it")
    }
}

/// States that a file of the catalogue is not used.
pub fn unreadable(rope: &UnreadableRope) -> String {
    format!("{}; the rope is not in the catalogue", rope.error)
}

/// States why a rope was rejected.
pub fn rejection(reason: &Rejection) -> String {
    match rejection_parts(reason) {
        (what, None) => what,
        (what, Some(value)) => format!("{what} ({value})"),
    }
}

/// Constraint that rejected a rope, and the value of the rope.
pub(crate) fn rejection_parts(reason: &Rejection) -> (String, Option<String>) {
    match reason {
        Rejection::TooThick {
            diameter_m,
            limit_m,
        } => (
            format!(
                "diameter above the limit of {} mm",
                specified(1e3 * limit_m)
            ),
            Some(format!("{} mm", short(1e3 * diameter_m))),
        ),
        Rejection::TooThin {
            diameter_m,
            limit_m,
        } => (
            format!(
                "diameter below the limit of {} mm",
                specified(1e3 * limit_m)
            ),
            Some(format!("{} mm", short(1e3 * diameter_m))),
        ),
        Rejection::TooHeavy {
            weight_kg_per_m,
            limit_kg_per_m,
        } => (
            format!(
                "weight above the limit of {} g/m",
                specified(1e3 * limit_kg_per_m)
            ),
            Some(format!("{} g/m", short(1e3 * weight_kg_per_m))),
        ),
        Rejection::BendRatio { ratio, limit_ratio } => (
            format!("bending ratio D/d below the limit of {limit_ratio}"),
            Some(short(*ratio)),
        ),
        Rejection::SafetyFactor { ratio, limit_ratio } => (
            format!("safety factor below the limit of {limit_ratio}"),
            Some(short(*ratio)),
        ),
        Rejection::Elongation {
            elongation_m,
            limit_m,
        } => (
            format!(
                "elongation or shortening above the limit of {} mm",
                specified(1e3 * limit_m)
            ),
            Some(format!("{} mm", bracketed(elongation_m.scaled(1e3), 2))),
        ),
        Rejection::Stiffness {
            stiffness_n_per_m,
            limit_n_per_m,
        } => (
            format!(
                "stiffness below the limit of {} N/mm",
                specified(1e-3 * limit_n_per_m)
            ),
            Some(format!(
                "{} N/mm",
                bracketed(stiffness_n_per_m.scaled(1e-3), 2)
            )),
        ),
        Rejection::DiameterNotPublished => ("diameter not published".into(), None),
        Rejection::WeightNotPublished => ("weight not published".into(), None),
        Rejection::BendRatioUnknown => ("bending ratio D/d unknown".into(), None),
        Rejection::BreakingLoadNotPublished => (
            "breaking load not published, safety factor unknown".into(),
            None,
        ),
        Rejection::Breaks {
            life_s,
            broken_share,
            cause,
        } => {
            let share = share_of_draws(*broken_share);
            let value = match life_s {
                Some(life) => {
                    let [value, low, high] = [life.value, life.low, life.high].map(spoken);
                    format!("{share}, after about {value}, {low} to {high}")
                }
                None => share,
            };
            let cause = life::cause(*cause);
            (
                format!("predicted failure by {cause} in more than half of the draws"),
                Some(value),
            )
        }
        Rejection::Hot => (
            format!(
                "temperature exceeds the HMPE limit of {:.0} °C",
                HMPE_HOT_K - CELSIUS_ZERO_K
            ),
            None,
        ),
        Rejection::NotDetermined => ("elongation or stiffness not determined".into(), None),
        Rejection::NotPredicted { reason } => ("no prediction".into(), Some(reason.clone())),
    }
}

/// Constraint that a candidate may violate, and the share of the draws that violate it.
pub(crate) fn possible_violation(violation: &PossibleViolation) -> (String, String) {
    match *violation {
        PossibleViolation::Elongation { limit_m, share } => (
            format!(
                "may exceed the elongation limit of {} mm",
                specified(1e3 * limit_m)
            ),
            share_of_draws(share),
        ),
        PossibleViolation::Stiffness {
            limit_n_per_m,
            share,
        } => (
            format!(
                "may be below the stiffness limit of {} N/mm",
                specified(1e-3 * limit_n_per_m)
            ),
            share_of_draws(share),
        ),
    }
}

/// Formats a warning without the values that differ from rope to rope.
pub(crate) fn shared_caution(c: Caution) -> String {
    match c {
        Caution::LowLoad
        | Caution::HighLoad
        | Caution::Hot
        | Caution::TerminationNotSpecified { .. } => caution(c),
        Caution::BreakingLoadAssumed { .. } => {
            "breaking load not published but assumed; test the rope".into()
        }
        Caution::Extrapolated { .. } => {
            "extrapolates beyond the longest test with assumed parameters; test longer".into()
        }
        Caution::CreepsApart { .. } => "creep rupture predicted; reduce the load".into(),
        Caution::WornOut { .. } => {
            "bending fatigue failure predicted; use larger or fewer pulleys".into()
        }
        Caution::Replace { .. } => {
            "strain may exceed the replacement limit of the manufacturer".into()
        }
        Caution::TightBend { .. } => {
            "bending ratio D/d below the recommended minimum; use a larger pulley or a thinner rope"
                .into()
        }
        Caution::LoadShare { .. } => {
            "largest tension above the recommended share of the breaking load; use a stronger rope"
                .into()
        }
        Caution::BeyondData { .. } => {
            "extrapolates beyond the tested range; intervals are widened".into()
        }
        Caution::AssumedParameters { .. } => "parameters assumed, not measured".into(),
    }
}

/// Formats a range, `1.3 to 2.3 %`; one number if both ends are equal.
pub(crate) fn range([low, high]: [f64; 2], unit: &str) -> String {
    match (rounded(low, 2), rounded(high, 2)) {
        (low, high) if low == high => format!("{low} {unit}"),
        (low, high) => format!("{low} to {high} {unit}"),
    }
}

/// States how many parameters are assumed, as the end of a headline; empty if none.
pub(crate) fn assumed_note(assumed: usize, parameters: usize) -> String {
    match assumed {
        0 => String::new(),
        _ => format!(" {assumed} of {parameters} parameters assumed."),
    }
}

/// Formats a number with three significant digits.
fn short(v: f64) -> String {
    if !v.is_finite() {
        return "–".into();
    }
    let digits = 2 - v.abs().max(1e-12).log10().floor() as i32;
    format!("{v:.*}", digits.clamp(0, 6) as usize)
}

/// Formats a limit as specified, without rounding errors of the unit conversion.
fn specified(v: f64) -> String {
    ((1e9 * v).round() / 1e9).to_string()
}
