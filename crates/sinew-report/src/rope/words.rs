//! Cautions and rejections in words.

use super::{life, spoken};
use sinew_figure::rounded;
use sinew_rope::law::CELSIUS_ZERO_K;
use sinew_rope::law::validity::{HMPE_HOT_K, Outside};
use sinew_rope::select::Rejection;
use sinew_rope::{Caution, Namesake};

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
        Caution::Extrapolated { tests_s } => format!(
            "its parameters are starting guesses, held against tests of {}: beyond a day \
             this is an extrapolation, by a law that knows nothing slower than a day",
            spoken(tests_s)
        ),
        Caution::CreepsApart { time_s } => format!(
            "it creeps until it breaks, after some {}; there is no elongation from then on",
            spoken(time_s)
        ),
        Caution::WornOut { time_s } => format!(
            "bending wears it out after some {}; there is no elongation from then on",
            spoken(time_s)
        ),
        Caution::Replace {
            strain_ratio,
            time_s,
            share,
        } => {
            let limit = format!(
                "the {} % at which its maker says to replace it",
                stated(100.0 * strain_ratio)
            );
            let share = rounded(100.0 * share, 2);
            match time_s {
                Some(time_s) => format!(
                    "after {} its strain is above {limit}, and in {share} % of the draws at the last time",
                    spoken(time_s)
                ),
                None => format!(
                    "its strain is above {limit} in {share} % of the draws at the last time"
                ),
            }
        }
        Caution::TightBend {
            bend_ratio,
            least_ratio,
        } => format!(
            "a pulley bends it to {} times its own diameter; makers advise {} at least, because its \
             fibres rub and break inside the bend: take a larger pulley or a thinner rope",
            short(bend_ratio),
            stated(least_ratio)
        ),
        Caution::LoadShare {
            load_share,
            most_share,
        } => format!(
            "the largest tension is {} % of its breaking load; makers advise {} % at most, because creep, \
             bending and abrasion speed up above: take a stronger rope",
            short(100.0 * load_share),
            stated(100.0 * most_share)
        ),
        Caution::EndsNotStated {
            splice_share,
            knot_share,
        } => format!(
            "its ends are taken to be as strong as the rope; a splice keeps some {} %, a knot some {} %: \
             say --ends",
            rounded(100.0 * splice_share, 2),
            rounded(100.0 * knot_share, 2)
        ),
        Caution::BeyondData {
            holds,
            load_share,
            temperature_c,
            duration_s,
            factor,
        } => {
            let percent = |share: [f64; 2]| range(share.map(|s| 100.0 * s), "%");
            format!(
                "the data behind its values lie at {} of its breaking load, at {}, for {}; you ask for {}, {}, {}, so the \
                 intervals reach up to {} times as far",
                percent(holds.load_share),
                range(holds.temperature_c, "°C"),
                spoken(holds.duration_s),
                percent(load_share),
                range(temperature_c, "°C"),
                spoken(duration_s),
                short(factor)
            )
        }
        Caution::StartingGuesses {
            guesses,
            parameters,
        } => format!(
            "{guesses} of {parameters} parameters are starting guesses: check the plan on one \
             rope before it is used on many"
        ),
    }
}

/// A file that names its rope as another one.
pub fn namesake(n: &Namesake) -> String {
    let (file, name) = (n.file.display(), &n.name);
    if n.replaces {
        format!(
            "{file} replaces the rope '{name}' that is there already; another rope needs another name"
        )
    } else {
        format!("{file} is a copy of '{name}' and still has that name; give it one of its own")
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
        Rejection::Breaks { after_s, cause } => format!(
            "breaks after some {}, of {}",
            spoken(*after_s),
            life::cause(*cause)
        ),
        Rejection::Hot => format!(
            "temperature is above the {:.0} °C that HMPE may have",
            HMPE_HOT_K - CELSIUS_ZERO_K
        ),
        Rejection::NotPredicted { reason } => reason.clone(),
    }
}

/// `1.3 to 2.3 %`; one number where both are the same.
pub(super) fn range([low, high]: [f64; 2], unit: &str) -> String {
    match (rounded(low, 2), rounded(high, 2)) {
        (low, high) if low == high => format!("{low} {unit}"),
        (low, high) => format!("{low} to {high} {unit}"),
    }
}

/// How many of a law's parameters are guesses, where some are: the end of a headline.
pub(super) fn guessed(guesses: usize, parameters: usize) -> String {
    match guesses {
        0 => String::new(),
        _ => format!(" {guesses} of the {parameters} parameters behind this are starting guesses."),
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
