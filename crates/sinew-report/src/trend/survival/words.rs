//! How long ropes last, in words.

use crate::trend::words::format_span;
use sinew_figure::rounded;
use sinew_files::date::{DAY_S, day_of};
use sinew_trend::survival::{
    AgeUnit, FittedWeibull, LifeQuantile, SurvivalGroup, SurvivalNote, Wear,
};

/// What ages are shown in, and how many of it make one of the document's.
pub(super) fn shown(unit: AgeUnit) -> (&'static str, f64) {
    match unit {
        AgeUnit::Seconds => ("days", 1.0 / DAY_S),
        AgeUnit::Cycles => ("cycles", 1.0),
    }
}

/// An age with its unit.
pub(super) fn format_age(age: f64, unit: AgeUnit) -> String {
    match unit {
        AgeUnit::Seconds => format_span(age),
        AgeUnit::Cycles => format!("{} cycles", rounded(age, 3)),
    }
}

/// `120 (60 to 200)`, ends that are open as dots; a dash where nothing is known.
pub(super) fn format_quantile(quantile: &LifeQuantile, factor: f64) -> String {
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

/// Name of a group.
pub(super) fn group_name(group: &SurvivalGroup) -> &str {
    group.name.as_deref().unwrap_or("all ropes")
}

/// A group, and what age says of breaking there.
pub(super) fn format_wear(group: &SurvivalGroup, unit: AgeUnit) -> String {
    format!("{}: {}", group_name(group), wear(group, unit))
}

/// What age says of breaking, in a sentence.
pub(super) fn wear(group: &SurvivalGroup, unit: AgeUnit) -> String {
    let of = |law: &FittedWeibull, share: f64| {
        let found = law.broken_by.iter().find(|q| q.broken_ratio == share);
        let age = found.and_then(|q| q.age);
        age.map_or("…".into(), |age| format_age(age, unit))
    };
    match (group.wear, &group.weibull) {
        (Wear::WearsOut, Some(law)) => format!(
            "old ropes break sooner: replacing in time helps. 5 % have broken by {}, 10 % by {}",
            of(law, 0.05),
            of(law, 0.1)
        ),
        (Wear::BreaksEarly, Some(_)) => "those that break do so early: a rope that has lasted is better than a new one. \
             Replacing it by its age does harm; look at how ropes are put in"
            .into(),
        (Wear::AgeSaysNothing, Some(_)) => {
            "an old rope may be as good as a new one: these data don't show that replacing by age helps".into()
        }
        _ if group.broke > 1 => format!(
            "{} of {} broke, all at nearly one age: no law is fitted",
            group.broke, group.ropes
        ),
        _ => format!(
            "{} of {} broke: too few to say how they age",
            group.broke, group.ropes
        ),
    }
}

/// A law and its numbers in a line.
pub(super) fn format_law(law: &FittedWeibull, unit: AgeUnit) -> String {
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

/// Where a law leaves the curve's band; `None` where it doesn't.
pub(super) fn format_misfit(group: &SurvivalGroup) -> Option<String> {
    let law = group.weibull.as_ref().filter(|law| law.outside_band > 0)?;
    Some(format!(
        "the law leaves the curve's band at {} of {} ages: no Weibull law, or ropes of several kinds",
        law.outside_band,
        group.curve.len()
    ))
}

/// What was left out or supposed, in a sentence.
pub fn format_note(note: &SurvivalNote) -> String {
    let ropes = |n: usize| match n {
        1 => "1 rope".to_string(),
        n => format!("{n} ropes"),
    };
    match note {
        SurvivalNote::AgeUnknown { breaks } => format!(
            "{breaks} first breaks at their place: nobody says when those ropes were put in ('installed'), so their lives \
             are left out. Places where nothing ever broke are not in the table at all. Both make ropes look weaker or \
             stronger than they are"
        ),
        SurvivalNote::NoNewRope { places } => format!(
            "{} out of observation since the rope there broke: nobody says that another was put in ('installed'). Where one was, \
             ropes look weaker than they are; --repaired says that every place got one the same day",
            match places {
                1 => "1 place is".to_string(),
                n => format!("{n} places are"),
            }
        ),
        SurvivalNote::WithoutPlace { events } => {
            format!("{events} events name no place and are left out")
        }
        SurvivalNote::TakenForBroken { events, words } => format!(
            "{events} events are taken for a rope that broke: {}. Reword those where something else did",
            words.join("; ")
        ),
        SurvivalNote::NoEnd { events, words } => {
            format!("{events} events end no rope's life: {}", words.join("; "))
        }
        SurvivalNote::SameDay { ropes: n } => format!(
            "{} broke on the day of the one before: taken as half a day",
            ropes(*n)
        ),
        SurvivalNote::WatchEnds { utc_s, by } => match by {
            None => format!(
                "ropes that didn't break were watched until {} (--until says otherwise)",
                day_of(*utc_s)
            ),
            Some(by) => format!(
                "ropes that didn't break were watched until the last event with the same {by}, {} at the latest",
                day_of(*utc_s)
            ),
        },
    }
}
