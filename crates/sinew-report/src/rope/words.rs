//! Cautions and rejections in words.

use sinew_model::rope::CELSIUS_ZERO_K;
use sinew_model::rope::validity::{HMPE_HOT_K, Outside};
use sinew_rope::Caution;
use sinew_rope::select::Rejection;

/// What to be careful about.
pub fn caution(caution: Caution) -> String {
    let outside = |low_load, high_load, hot| {
        let outside = Outside {
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
        Caution::BreakingLoadGuessed { breaking_load_n } => {
            format!("the breaking load is not published; {breaking_load_n} N is a starting guess")
        }
        Caution::Extrapolated => "starting guesses made for tests of 85 min: beyond a day this is \
             an extrapolation, and the law has no delayed part slower than a day"
            .into(),
        Caution::StartingGuesses {
            guesses,
            parameters,
        } => format!(
            "{guesses} of {parameters} parameters are starting guesses: check the plan on one \
             rope before it is used on many"
        ),
    }
}

/// Why a rope fell out.
pub fn rejection(why: &Rejection) -> String {
    match why {
        Rejection::TooThick {
            diameter_m,
            limit_m,
        } => format!(
            "diameter {} mm is above {} mm",
            short(1e3 * diameter_m),
            stated(1e3 * limit_m)
        ),
        Rejection::TooThin {
            diameter_m,
            limit_m,
        } => format!(
            "diameter in mm {} is below {}",
            short(1e3 * diameter_m),
            stated(1e3 * limit_m)
        ),
        Rejection::TooHeavy {
            weight_kg_per_m,
            limit_kg_per_m,
        } => format!(
            "weight {} g/m is above {} g/m",
            short(1e3 * weight_kg_per_m),
            stated(1e3 * limit_kg_per_m)
        ),
        Rejection::BendRatio { ratio, limit_ratio } => format!(
            "pulley over rope diameter {} is below {limit_ratio}",
            short(*ratio)
        ),
        Rejection::SafetyFactor { ratio, limit_ratio } => {
            format!("safety factor {} is below {limit_ratio}", short(*ratio))
        }
        Rejection::Elongation { high_m, limit_m } => format!(
            "elongation may reach {} mm (95 %), above {} mm",
            short(1e3 * high_m),
            stated(1e3 * limit_m)
        ),
        Rejection::Stiffness {
            stiffness_n_per_m,
            limit_n_per_m,
        } => format!(
            "stiffness {} N/mm is below {} N/mm",
            short(1e-3 * stiffness_n_per_m),
            stated(1e-3 * limit_n_per_m)
        ),
        Rejection::DiameterNotPublished => "diameter is not published".into(),
        Rejection::WeightNotPublished => "weight is not published".into(),
        Rejection::BendRatioNotKnown => "pulley over rope diameter is not known".into(),
        Rejection::BreakingLoadNotPublished => {
            "breaking load is not published, so no safety factor can be shown".into()
        }
        Rejection::Hot => format!(
            "temperature is above the {:.0} °C that HMPE may have",
            HMPE_HOT_K - CELSIUS_ZERO_K
        ),
        Rejection::NotPredicted { reason } => reason.clone(),
    }
}

/// Three significant digits.
fn short(v: f64) -> String {
    let digits = 2 - v.abs().max(1e-12).log10().floor() as i32;
    format!("{v:.*}", digits.clamp(0, 6) as usize)
}

/// A limit as it was stated: without what a change of units leaves behind the ninth decimal.
fn stated(v: f64) -> String {
    ((1e9 * v).round() / 1e9).to_string()
}
