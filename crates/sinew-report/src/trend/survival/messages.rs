//! Sentences about rope lifetimes.

use crate::format::counted;
use crate::message::Message;
use crate::trend::messages::format_span;
use sinew_figure::{probability, rounded};
use sinew_files::date::{DAY_S, day_of};
use sinew_trend::survival::{
    AgeReplacement, AgeUnit, FittedWeibull, LifeQuantile, ReplacementVerdict, SurvivalGroup,
    SurvivalNote,
};

/// Returns the display unit of ages, and the factor from the unit of the document.
pub(crate) fn shown(unit: AgeUnit) -> (&'static str, f64) {
    match unit {
        AgeUnit::Seconds => ("days", 1.0 / DAY_S),
        AgeUnit::Cycles => ("cycles", 1.0),
    }
}

/// Formats an age with its unit.
pub(crate) fn format_age(age: f64, unit: AgeUnit) -> String {
    match unit {
        AgeUnit::Seconds => format_span(age),
        AgeUnit::Cycles => format!("{} cycles", rounded(age, 3)),
    }
}

/// Formats a quantile with its interval, `120 (60 to 200)`; missing bounds are `…`, a missing quantile is a dash.
pub(crate) fn format_quantile(quantile: &LifeQuantile, factor: f64) -> String {
    if [quantile.age, quantile.age_low, quantile.age_high] == [None; 3] {
        return "–".into();
    }
    let number = |age: Option<f64>| age.map_or("…".into(), |age| rounded(factor * age, 3));
    format!(
        "{} ({} to {})",
        number(quantile.age),
        number(quantile.age_low),
        number(quantile.age_high)
    )
}

/// Name of a group of ropes.
pub(crate) fn group_name(group: &SurvivalGroup) -> &str {
    group.name.as_deref().unwrap_or("all ropes")
}

/// States the effect of age on failures in a group, with the name of the group.
pub(crate) fn format_wear(group: &SurvivalGroup, unit: AgeUnit) -> String {
    format!("{}: {}", group_name(group), wear(group, unit))
}

/// States the effect of age on failures in a group.
pub(crate) fn wear(group: &SurvivalGroup, unit: AgeUnit) -> String {
    let AgeReplacement {
        verdict,
        wear_probability,
        required_probability,
        shape_prior_95: [low, high],
        further_failures,
        age,
    } = &group.replacement;
    let Some(wears) = *wear_probability else {
        return format!(
            "0 of {} failed: too few failures to estimate the effect of age",
            group.ropes
        );
    };
    let required = rounded(100.0 * required_probability, 2);
    match verdict {
        ReplacementVerdict::Helps => {
            let (name, factor) = shown(unit);
            let at = age.as_ref().map_or(String::new(), |age| {
                let share = rounded(100.0 * age.broken_ratio, 2);
                format!(
                    "; {share} % failed by {} {name}",
                    format_quantile(age, factor)
                )
            });
            format!(
                "failure rate increases with age (probability {}): preventive replacement reduces failures{at}",
                probability(wears)
            )
        }
        ReplacementVerdict::DoesNotHelp => format!(
            "failure rate decreases with age (probability {}): preventive replacement does not help; inspect the installation procedure",
            probability(1.0 - wears)
        ),
        ReplacementVerdict::Inconclusive => {
            let more = match further_failures {
                Some(n) => format!(
                    "about {} would decide it if the shape remains as estimated",
                    counted(*n as u64, "further failure")
                ),
                None => "more than 1000 further failures would be needed".into(),
            };
            format!(
                "effect of age inconclusive: the failure rate increases with age with a probability of {}, a verdict needs {required} % \
                 (prior of the Weibull shape: 95 % within {low} to {high}, median 1); no age of replacement; {more}",
                probability(wears)
            )
        }
    }
}

/// Formats the parameters of a Weibull law with their 95 % intervals.
pub(crate) fn format_law(law: &FittedWeibull, unit: AgeUnit) -> String {
    let (name, factor) = shown(unit);
    let ends = |[low, high]: [Option<f64>; 2], factor: f64| {
        let end = |x: Option<f64>| x.map_or("…".into(), |x| rounded(factor * x, 3));
        format!("{} to {}", end(low), end(high))
    };
    format!(
        "Weibull: shape {} ({}), scale {} {name} ({})",
        rounded(law.shape, 3),
        ends(law.shape_interval_95, 1.0),
        rounded(factor * law.scale, 3),
        ends(law.scale_interval_95, factor)
    )
}

/// States at how many ages a law lies outside the band of the survival function; `None` if at none.
pub(crate) fn format_misfit(group: &SurvivalGroup) -> Option<String> {
    let law = group.weibull.as_ref().filter(|law| law.outside_band > 0)?;
    Some(format!(
        "Weibull law outside the 95 % band of the survival function at {} of {} ages: not Weibull-distributed, or several rope types",
        law.outside_band,
        group.curve.len()
    ))
}

/// Returns a note about excluded events or assumptions with its code.
pub fn note_message(note: &SurvivalNote) -> Message {
    Message::of(note, format_note(note))
}

/// Formats a note about excluded events or assumptions.
pub fn format_note(note: &SurvivalNote) -> String {
    let ropes = |n: usize| match n {
        1 => "1 rope".to_string(),
        n => format!("{n} ropes"),
    };
    match note {
        SurvivalNote::AgeUnknown { breaks } => format!(
            "{} excluded: installation date unknown (no 'installed' event at that place); places without failure are not in the table; \
             the lifetimes may be biased; add 'installed' events",
            counted(*breaks as u64, "first failure")
        ),
        SurvivalNote::NoNewRope { places } => format!(
            "{} out of observation after a failure: no 'installed' event follows; lifetimes are underestimated if a rope was \
             installed; add the events, or use --repaired if every failed rope was replaced the same day",
            match places {
                1 => "1 place".to_string(),
                n => format!("{n} places"),
            }
        ),
        SurvivalNote::WithoutPlace { events } => {
            format!(
                "{} without a place excluded",
                counted(*events as u64, "event")
            )
        }
        SurvivalNote::TakenForBroken { events, words } => format!(
            "{} interpreted as rope failure: {}; reword events of other failures",
            counted(*events as u64, "event"),
            words.join("; ")
        ),
        SurvivalNote::NoEnd { events, words } => {
            let (verb, words) = (if *events == 1 { "is" } else { "are" }, words.join("; "));
            format!(
                "{} {verb} not the end of a rope's life; ignored: {words}",
                counted(*events as u64, "event")
            )
        }
        SurvivalNote::SameDay { ropes: n } => format!(
            "{} failed on the day of installation: lifetime of half a day assumed",
            ropes(*n)
        ),
        SurvivalNote::ObservationEnd { utc_s, by } => match by {
            None => format!(
                "ropes without failure: observed until {} (change with --until)",
                day_of(*utc_s)
            ),
            Some(by) => format!(
                "ropes without failure: observed until the last event with the same {by}, at the latest {}",
                day_of(*utc_s)
            ),
        },
    }
}
