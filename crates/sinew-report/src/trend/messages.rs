//! Sentences about the trend of a tendon: limits, forecasts, events, notes.

use crate::format::{counted, plus_minus};
use crate::message::Message;
use sinew_figure::{Columns, probability, rounded};
use sinew_files::date::{DAY_S, day_of};
use sinew_model::{Gaussian, Z95};
use sinew_trend::survival::LifeForecast;
use sinew_trend::{
    JointTrend, LifeNotUsed, Limit, LimitForecast, LimitState, MissingFromRobot, PriorBasis,
    StepCause, TrendEvent, TrendEventKind, TrendNote, TrendReport, TrendVerdict,
};

/// Formats a value with its 95 % interval; a dash if it is missing.
pub(crate) fn plus_minus_or_dash(value: Option<Gaussian>, factor: f64) -> String {
    value.map_or("–".into(), |v| plus_minus(v, factor))
}

/// Length of a month in tables, s.
pub(crate) const MONTH_S: f64 = 30.0 * DAY_S;

/// Builds the columns with offset, elongation and creep rate of every tendon.
pub(crate) fn now(report: &TrendReport) -> Columns<&JointTrend> {
    Columns::of(&report.joints)
        .words("tendon", |j| &j.name)
        .column("offset\n(mrad)", |j| plus_minus(j.offset_rad, 1e3))
        .column("elongation\n(mm)", |j| {
            plus_minus_or_dash(j.elongation_m, 1e3)
        })
        .column("creep rate\n(mrad/month)", |j| {
            plus_minus(j.rate_rad_per_s, 1e3 * MONTH_S)
        })
}

/// Shortest time that is formatted in days, s; shorter ones are formatted in hours.
const MIN_DAYS_S: f64 = 2.0 * DAY_S;

/// Formats a time span, `83 days` or `5.2 hours`.
pub(crate) fn format_span(time_s: f64) -> String {
    if time_s.abs() < MIN_DAYS_S && time_s != 0.0 {
        return format!("{} hours", rounded(time_s / 3600.0, 2));
    }
    format!("{:.0} days", (time_s / DAY_S).round())
}

/// Formats a time as date, or as machine cycle if sessions have no dates.
pub(crate) fn format_when(joint: &JointTrend, utc_s: f64) -> String {
    match (joint.is_dated(), joint.cycles) {
        (false, Some(cycles)) => {
            let since = cycles.per_s.unwrap_or(0.0) * (utc_s - joint.last_utc_s);
            format!("cycle {:.0}", (cycles.last + since).round())
        }
        _ => day_of(utc_s),
    }
}

/// Formats a time after the last session as span with its date, and in cycles if the machine counts them.
pub(crate) fn format_after(joint: &JointTrend, time_s: f64) -> String {
    let span = format_span(time_s);
    let cycles = joint
        .cycles
        .and_then(|c| c.per_s)
        .map(|per_s| per_s * time_s);
    let date = day_of(joint.last_utc_s + time_s);
    match (joint.is_dated(), cycles) {
        (true, None) => format!("{span} ({date})"),
        (true, Some(cycles)) => format!("{span} ({date}, {cycles:.0} cycles)"),
        (false, Some(cycles)) => format!("{cycles:.0} cycles ({span})"),
        (false, None) => span,
    }
}

/// Names a limit.
pub(crate) fn limit_name(limit: Limit) -> &'static str {
    match limit {
        Limit::Retension { .. } => "re-tensioning",
        Limit::Replace { .. } => "replacement",
    }
}

/// Formats a limit in the unit of robot.toml.
pub(crate) fn format_limit(limit: Limit) -> String {
    match limit {
        Limit::Retension { elongation_m } => format!("{} mm", rounded(1e3 * elongation_m, 3)),
        Limit::Replace { strain_ratio } => format!("{} % strain", rounded(100.0 * strain_ratio, 3)),
    }
}

/// States when a limit is exceeded, counted from the last session.
fn format_exceedance(limit: &LimitForecast, joint: &JointTrend) -> String {
    let days = |time_s: f64| format_after(joint, time_s);
    let after = |time_s: Option<f64>| days(time_s.unwrap_or(0.0));
    match limit.state {
        LimitState::TooFewSessions => {
            format!("not predictable, too few sessions ({})", joint.sessions)
        }
        LimitState::NotWithinHorizon => "not within the forecast horizon".into(),
        LimitState::NotBefore => format!(
            "not before {} (95 %); date not predictable yet ({})",
            after(limit.after_low_s),
            counted(joint.sessions as u64, "session")
        ),
        LimitState::Passed => format!(
            "exceeded (probability {})",
            probability(limit.passed_probability)
        ),
        LimitState::Forecast => {
            let (middle, low) = (after(limit.after_s), after(limit.after_low_s));
            match limit.after_high_s {
                Some(high) => format!("in {middle}, 95 % interval {low} to {}", days(high)),
                None => {
                    format!("in {middle}, 95 % interval from {low} to beyond the forecast horizon")
                }
            }
        }
    }
}

/// Names an event.
pub(crate) fn event_name(kind: TrendEventKind) -> &'static str {
    match kind {
        TrendEventKind::StepChange { .. } => "step change",
        TrendEventKind::Tensioned { .. } => "re-tensioning",
    }
}

/// Formats the number of sessions, and of those without information.
pub(crate) fn sessions(joint: &JointTrend) -> String {
    match joint.without_information {
        0 => counted(joint.sessions as u64, "session"),
        n => format!(
            "{}, {n} inconclusive",
            counted(joint.sessions as u64, "session")
        ),
    }
}

/// States the probable cause of an event and the action.
fn format_meaning(event: &TrendEvent) -> String {
    let change = event
        .stiffness_change_ratio
        .map_or(String::new(), |c| format!(" of {} %", plus_minus(c, 100.0)));
    match event.kind {
        TrendEventKind::Tensioned { stated: true } => "date specified".into(),
        TrendEventKind::Tensioned { stated: false } => {
            "offset dropped: possible unrecorded re-tensioning; confirm with --tensioned DATE"
                .into()
        }
        TrendEventKind::StepChange { .. } if event.size_rad.is_some_and(|size| size.mean < 0.0) => {
            "offset dropped: rope broken or detached, or encoder slip; inspect rope and encoder"
                .into()
        }
        TrendEventKind::StepChange { cause } => match cause {
            StepCause::StrandFailure => {
                format!(
                    "stiffness change{change} at the same time: probable strand failure; inspect the rope"
                )
            }
            StepCause::Slip => {
                format!(
                    "no stiffness loss (change{change}): probable slip of rope, clamp or encoder; inspect all three"
                )
            }
            StepCause::Unknown => {
                "cause ambiguous: strand failure, or slip of rope, clamp or encoder; inspect all"
                    .into()
            }
        },
    }
}

/// States that an event is provisional; `None` if it is confirmed.
fn format_provisional(event: &TrendEvent) -> Option<&'static str> {
    let provisional = event.is_jump() && event.sessions == 1;
    provisional.then_some("exceeds every modelled error; the next session confirms or withdraws it")
}

/// Formats an event with its date, size and probable cause.
pub(crate) fn event_line(event: &TrendEvent, joint: &JointTrend) -> String {
    let by = by_mrad(event);
    let (day, name) = (format_when(joint, event.time_utc_s), event_name(event.kind));
    let provisional = format_provisional(event).map_or(String::new(), |text| format!("; {text}"));
    format!("{day}: {name}{by}; {}{provisional}", format_meaning(event))
}

/// Formats the size of an event; empty if it is unknown.
fn by_mrad(event: &TrendEvent) -> String {
    let size = event.size_rad.map(|size| plus_minus(size, 1e3));
    size.map_or(String::new(), |size| format!(" of {size} mrad"))
}

/// Formats a limit, and when it is exceeded.
pub(crate) fn limit_line(limit: &LimitForecast, joint: &JointTrend) -> String {
    let (name, value) = (limit_name(limit.limit), format_limit(limit.limit));
    format!(
        "{name} limit of {value}: {}",
        format_exceedance(limit, joint)
    )
}

/// States when to replace a rope by its age.
pub(crate) fn format_life(life: &LifeForecast, joint: &JointTrend) -> String {
    let percent = |share: f64| rounded(100.0 * share, 2);
    let day = |after_s: f64| day_of(joint.last_utc_s + after_s);
    let [low, high] = [life.after_low_s, life.after_high_s].map(day);
    let when = match life.is_passed() {
        true => format!(
            "exceeded since {} (probability {})",
            day(life.after_s),
            probability(life.passed_probability)
        ),
        false => format!("in {}", format_after(joint, life.after_s)),
    };
    format!(
        "age limit (age at which {} % of such ropes have failed): {when}, 95 % interval {low} to {high}; present age {}, at \
         which {} % have failed; based on {} ropes of {}, {} failures",
        percent(life.broken_ratio),
        format_span(life.age_s),
        percent(life.broken_by_now_ratio),
        life.ropes,
        life.source,
        life.broke
    )
}

/// States the systematic part of an interval, if it is a large part.
pub(crate) fn format_systematic(joint: &JointTrend) -> Option<String> {
    /// Minimum share of the standard deviation that is reported.
    const MIN_SHARE: f64 = 0.5;
    let shared_rad = joint.baseline_error_rad.std;
    (shared_rad > MIN_SHARE * joint.offset_rad.std).then(|| {
        format!(
            "systematic part of the interval: ± {} mrad from the baseline; record a longer baseline to reduce it",
            rounded(1e3 * Z95 * shared_rad, 2)
        )
    })
}

/// Returns the limit on which the verdict of a tendon depends: an exceeded one, else the first.
pub(crate) fn limit_of_verdict(joint: &JointTrend) -> Option<&LimitForecast> {
    match joint.verdict {
        TrendVerdict::Retension | TrendVerdict::Replace => {
            (joint.limits.iter()).find(|l| l.state == LimitState::Passed)
        }
        TrendVerdict::Wait => joint.limits.first(),
        TrendVerdict::Inspect
        | TrendVerdict::Watch
        | TrendVerdict::ReplaceByAge
        | TrendVerdict::NoLimit => None,
    }
}

/// States the recommended action for a tendon, with its reason.
pub(crate) fn format_verdict(joint: &JointTrend) -> String {
    let passed = |what: &str| {
        limit_of_verdict(joint).map(|l| {
            let passage = format_exceedance(l, joint);
            let limit = format_limit(l.limit);
            format!("{what}: limit of {limit} {passage}")
        })
    };
    let text = match joint.verdict {
        TrendVerdict::Replace => passed("replace the rope"),
        TrendVerdict::Retension => passed("re-tension"),
        TrendVerdict::Inspect => joint.events.iter().rfind(|e| e.is_jump()).map(|jump| {
            let size = by_mrad(jump);
            let (day, meaning) = (format_when(joint, jump.time_utc_s), format_meaning(jump));
            let (action, state) = match format_provisional(jump) {
                Some(state) => ("inspect now", format!("; {state}")),
                None => ("inspect", String::new()),
            };
            format!("{action}: step change{size} on {day}; {meaning}{state}")
        }),
        TrendVerdict::Watch => joint.suspected_step.map(|s| {
            let (day, p) = (format_when(joint, s.time_utc_s), probability(s.probability));
            format!(
                "watch: step change suspected on {day} (probability {p}); the next session confirms or withdraws it"
            )
        }),
        TrendVerdict::Wait if joint.limits.is_empty() => {
            joint.life.as_ref().map(|life| format_life(life, joint))
        }
        TrendVerdict::Wait => limit_of_verdict(joint).map(|l| {
            let what = match l.limit {
                Limit::Retension { .. } => "re-tensioning",
                Limit::Replace { .. } => "rope replacement",
            };
            format!("{what}: {}", format_exceedance(l, joint))
        }),
        TrendVerdict::ReplaceByAge => (joint.life.as_ref()).map(|life| {
            format!(
                "replace the rope: {}",
                format_life(life, joint)
            )
        }),
        TrendVerdict::NoLimit => None,
    };
    text.unwrap_or_else(|| "no limit configured in robot.toml".into())
}

/// States the creep law, load and parameters on which a forecast is based.
pub(crate) fn format_basis(basis: &PriorBasis) -> String {
    match basis {
        PriorBasis::Unknown { missing, ropes } => {
            let all = format!("the creep laws of all {ropes} catalogue ropes");
            let (laws, lacks, what) = match missing {
                MissingFromRobot::Tendon => (all, "no tendon", "specify the rope"),
                MissingFromRobot::Rope => (all, "no rope", "specify the rope"),
                MissingFromRobot::Pretension => (
                    "the creep law of its rope at 1 to 8 % of the breaking load".into(),
                    "no pretension_n",
                    "specify it",
                ),
            };
            format!("{laws}: robot.toml has {lacks} for this joint; {what} to narrow the forecast")
        }
        PriorBasis::Rope {
            rope,
            parameters,
            assumed,
            draws,
            duty,
        } => {
            let duty = match duty {
                Some(duty) => format!("under the duty {duty}"),
                None => "with unknown peak loads".into(),
            };
            format!(
                "the creep law of {rope} {duty}; {draws} draws of the rope model, and generic creep curves with a prior \
                 probability of 20 %; {assumed} of {parameters} rope parameters assumed"
            )
        }
    }
}

/// Returns a note about excluded sessions or assumptions with its code.
pub fn note_message(note: &TrendNote) -> Message {
    Message::of(note, format_note(note))
}

/// Formats a note about excluded sessions or assumptions.
pub fn format_note(note: &TrendNote) -> String {
    let places = |source: &str, more: usize| match more {
        0 => source.to_string(),
        more => format!("{source} and {more} more"),
    };
    match note {
        TrendNote::Repeated { source, more } => {
            format!("{}: duplicate session, counted once", places(source, *more))
        }
        TrendNote::Overlapping { source, more } => {
            let places = places(source, *more);
            format!("{places}: overlaps the previous session; excluded")
        }
        TrendNote::TensioningNotSpecified { joint } => format!(
            "{joint}: tensioning date not specified; creep assumed to start at the first session; specify --tensioned DATE"
        ),
        TrendNote::LongBefore {
            joint,
            time_utc_s,
            days,
        } => format!(
            "{joint}: first session is {days:.0} days after the tensioning on {}; earlier creep unknown; check the year of the date",
            day_of(*time_utc_s)
        ),
        TrendNote::LifeNotUsed { joint, reason } => match reason {
            LifeNotUsed::AgeUnknown => format!(
                "{joint}: --life not used: installation date of the rope not specified; specify --replaced {joint}=DATE"
            ),
            LifeNotUsed::StrainLimit => format!(
                "{joint}: --life not used: replace_at_strain_percent in robot.toml limits the rope by its strain"
            ),
        },
        TrendNote::OtherBaseline { joint, time_utc_s } => format!(
            "{joint}: baseline changed on {}; treated as a re-tensioning",
            day_of(*time_utc_s)
        ),
    }
}
