//! What a trend finds, in words.

use crate::text::capitalised;
use crate::words::plus_minus;
use sinew_figure::{Columns, rounded};
use sinew_files::date::{DAY_S, day_of};
use sinew_model::{Gaussian, Z95};
use sinew_trend::survival::LifeForecast;
use sinew_trend::{
    JointTrend, JumpCause, LifeNotUsed, Limit, LimitForecast, LimitState, MissingFromRobot,
    PriorBasis, TrendEvent, TrendEventKind, TrendNote, TrendReport, TrendVerdict,
};

/// The same, or a dash.
pub(super) fn plus_minus_or_dash(value: Option<Gaussian>, factor: f64) -> String {
    value.map_or("–".into(), |v| plus_minus(v, factor))
}

/// Mean length of a month as the table has it, s.
pub(super) const MONTH_S: f64 = 30.0 * DAY_S;

/// Where every tendon stands and how fast it creeps.
pub(super) fn now(report: &TrendReport) -> Columns<&JointTrend> {
    Columns::of(&report.joints)
        .words("tendon", |j| &j.name)
        .column("offset\nmrad", |j| plus_minus(j.offset_rad, 1e3))
        .column("stretch\nmm", |j| plus_minus_or_dash(j.elongation_m, 1e3))
        .column("creep\nmrad/month", |j| {
            plus_minus(j.rate_rad_per_s, 1e3 * MONTH_S)
        })
}

/// Shorter times are told in hours, s.
const HOURS_BELOW_S: f64 = 2.0 * DAY_S;

/// A span of time: `83 days`, `5.2 hours`.
pub(super) fn format_span(time_s: f64) -> String {
    if time_s.abs() < HOURS_BELOW_S && time_s != 0.0 {
        return format!("{} hours", rounded(time_s / 3600.0, 2));
    }
    format!("{:.0} days", (time_s / DAY_S).round())
}

/// The day of a time, or the machine's cycle where sessions have no dates.
pub(super) fn format_when(joint: &JointTrend, utc_s: f64) -> String {
    match (joint.is_dated(), joint.cycles) {
        (false, Some(cycles)) => {
            let since = cycles.per_s.unwrap_or(0.0) * (utc_s - joint.last_utc_s);
            format!("cycle {:.0}", (cycles.last + since).round())
        }
        _ => day_of(utc_s),
    }
}

/// A time from the last session on: in days and its date, in cycles where the machine counts them.
pub(super) fn format_after(joint: &JointTrend, time_s: f64) -> String {
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

pub(super) fn limit_name(limit: Limit) -> &'static str {
    match limit {
        Limit::Retension { .. } => "re-tension",
        Limit::Replace { .. } => "replace",
    }
}

/// The limit in the unit of robot.toml.
pub(super) fn format_limit(limit: Limit) -> String {
    match limit {
        Limit::Retension { elongation_m } => format!("{} mm", rounded(1e3 * elongation_m, 3)),
        Limit::Replace { strain_ratio } => format!("{} % strain", rounded(100.0 * strain_ratio, 3)),
    }
}

/// When a limit is passed, from the last session on, and on which date.
fn format_passage(limit: &LimitForecast, joint: &JointTrend) -> String {
    let days = |time_s: f64| format_after(joint, time_s);
    let after = |time_s: Option<f64>| days(time_s.unwrap_or(0.0));
    match limit.state {
        LimitState::TooFewSessions => "when is unknown: too few sessions".into(),
        LimitState::NotWithinHorizon => "not as far as the forecast reaches".into(),
        LimitState::NotBefore => format!(
            "not before {}, perhaps never; when is unknown",
            after(limit.after_low_s)
        ),
        LimitState::Passed => {
            let percent = 100.0 * limit.passed_probability;
            if percent > 99.0 {
                "passed (over 99 % sure)".into()
            } else {
                format!("passed ({percent:.0} % sure)")
            }
        }
        LimitState::Forecast => {
            let (middle, low) = (after(limit.after_s), after(limit.after_low_s));
            match limit.after_high_s {
                Some(high) => format!("in {middle}; 95 %: in {low} to {}", days(high)),
                None => format!("in {middle}; 95 %: in {low} at the earliest, perhaps never"),
            }
        }
    }
}

pub(super) fn event_name(kind: TrendEventKind) -> &'static str {
    match kind {
        TrendEventKind::Jump { .. } => "jump",
        TrendEventKind::Tensioned { .. } => "tensioned",
    }
}

/// How many sessions there are, and of how many nothing could be learned.
pub(super) fn sessions(joint: &JointTrend) -> String {
    match joint.without_information {
        0 => format!("{} sessions", joint.sessions),
        n => format!("{} sessions, of which {n} couldn't tell", joint.sessions),
    }
}

/// What an event may be.
fn format_meaning(event: &TrendEvent) -> String {
    let change = event
        .stiffness_change_ratio
        .map_or(String::new(), |c| format!(" ({} %)", plus_minus(c, 100.0)));
    match event.kind {
        TrendEventKind::Tensioned { stated: true } => "tensioned".into(),
        TrendEventKind::Tensioned { stated: false } => {
            "the offset fell: was it tensioned, and nobody wrote it down?".into()
        }
        TrendEventKind::Jump { .. } if event.size_rad.is_some_and(|size| size.mean < 0.0) => {
            "the reading fell: has the rope broken or come off, or an encoder moved?".into()
        }
        TrendEventKind::Jump { cause } => match cause {
            JumpCause::StrandFailure => {
                format!("it is softer too{change}: has a strand failed?")
            }
            JumpCause::Slip => {
                format!("it is as stiff as before{change}: did rope, clamp or encoder slip?")
            }
            JumpCause::Unknown => {
                "a strand failed, or rope, clamp or encoder slipped: the stiffness doesn't tell"
                    .into()
            }
        },
    }
}

/// How sure an event is.
fn format_sureness(event: &TrendEvent) -> Option<&'static str> {
    let at_once = event.is_jump() && event.sessions == 1;
    at_once.then_some("no error explains it; the next session will bear it out or take it back")
}

/// An event, and what it may be.
pub(super) fn event_line(event: &TrendEvent, joint: &JointTrend) -> String {
    let by = by_mrad(event);
    let (day, name) = (format_when(joint, event.time_utc_s), event_name(event.kind));
    let sure = format_sureness(event).map_or(String::new(), |sure| format!("; {sure}"));
    format!("{day}: {name}{by}; {}{sure}", format_meaning(event))
}

/// How large an event is, where that is known.
fn by_mrad(event: &TrendEvent) -> String {
    let size = event.size_rad.map(|size| plus_minus(size, 1e3));
    size.map_or(String::new(), |size| format!(" by {size} mrad"))
}

/// A limit and when it is passed.
pub(super) fn limit_line(limit: &LimitForecast, joint: &JointTrend) -> String {
    let (name, value) = (limit_name(limit.limit), format_limit(limit.limit));
    format!("{name} at {value}: {}", format_passage(limit, joint))
}

/// When to replace a rope by its age.
pub(super) fn format_life(life: &LifeForecast, joint: &JointTrend) -> String {
    let percent = |share: f64| rounded(100.0 * share, 2);
    let day = |after_s: f64| day_of(joint.last_utc_s + after_s);
    let [low, high] = [life.after_low_s, life.after_high_s].map(day);
    let when = match life.is_passed() {
        true => format!(
            "passed on {} ({:.0} % sure)",
            day(life.after_s),
            100.0 * life.passed_probability
        ),
        false => format!("in {}", format_after(joint, life.after_s)),
    };
    format!(
        "by its age: the day by which {} % of such ropes have broken is {when}; 95 %: {low} to {high}. It is {} since it \
         was put in or tensioned, by which {} % have. It rests on {} ropes of {}, of which {} broke",
        percent(life.broken_ratio),
        format_span(life.age_s),
        percent(life.broken_by_now_ratio),
        life.ropes,
        life.source,
        life.broke
    )
}

/// What of an interval no further session takes off, where that is much of it.
pub(super) fn format_shared(joint: &JointTrend) -> Option<String> {
    /// Less of the deviation isn't worth a word.
    const MUCH: f64 = 0.5;
    let shared_rad = joint.baseline_error_rad.deviation;
    (shared_rad > MUCH * joint.offset_rad.deviation).then(|| {
        format!(
            "its ± holds {} mrad that all sessions since the baseline share: more sessions don't take it off, a better \
             baseline does",
            rounded(1e3 * Z95 * shared_rad, 2)
        )
    })
}

/// The limit a tendon's verdict is about: one that is passed, else the first.
pub(super) fn limit_of_verdict(joint: &JointTrend) -> Option<&LimitForecast> {
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

/// The tendon in one sentence.
pub(super) fn format_verdict(joint: &JointTrend) -> String {
    let passed = |what: &str| {
        limit_of_verdict(joint).map(|l| {
            let passage = format_passage(l, joint);
            let limit = format_limit(l.limit);
            format!("{what}: the limit of {limit} is {passage}")
        })
    };
    let said = match joint.verdict {
        TrendVerdict::Replace => passed("replace the rope"),
        TrendVerdict::Retension => passed("tension it again"),
        TrendVerdict::Inspect => joint.events.iter().rfind(|e| e.is_jump()).map(|jump| {
            let size = by_mrad(jump);
            let (day, meaning) = (format_when(joint, jump.time_utc_s), format_meaning(jump));
            let (now, sure) = match format_sureness(jump) {
                Some(sure) => ("look at it now", format!(". {}", capitalised(sure))),
                None => ("look at it", String::new()),
            };
            format!("{now}. It jumped{size} by {day}; {meaning}{sure}")
        }),
        TrendVerdict::Watch => joint.suspicion.map(|s| {
            let (day, percent) = (format_when(joint, s.time_utc_s), 100.0 * s.probability);
            format!("watch it: it jumped by {day} with {percent:.0} %; the next session will tell")
        }),
        TrendVerdict::Wait if joint.limits.is_empty() => {
            joint.life.as_ref().map(|life| format_life(life, joint))
        }
        TrendVerdict::Wait => limit_of_verdict(joint).map(|l| {
            let what = match l.limit {
                Limit::Retension { .. } => "tension it again",
                Limit::Replace { .. } => "replace the rope",
            };
            format!("{what} {}", format_passage(l, joint))
        }),
        TrendVerdict::ReplaceByAge => (joint.life.as_ref()).map(|life| {
            format!(
                "replace the rope before it breaks: {}",
                format_life(life, joint)
            )
        }),
        TrendVerdict::NoLimit => None,
    };
    said.unwrap_or_else(|| "no limit in robot.toml".into())
}

/// What a forecast rests on.
pub(super) fn format_basis(basis: &PriorBasis) -> String {
    match basis {
        PriorBasis::Unknown { missing, ropes } => {
            let all = format!("the laws of all {ropes} ropes of the catalogue");
            let (laws, lacks, what) = match missing {
                MissingFromRobot::Tendon => (all, "no tendon", "which rope it is"),
                MissingFromRobot::Rope => (all, "no rope's name", "which rope it is"),
                MissingFromRobot::Pretension => (
                    "the law of its rope under 1 to 8 % of the breaking load".into(),
                    "no pretension_n",
                    "its pretension",
                ),
            };
            format!("{laws}, as the robot file has {lacks} here: {what} would narrow the forecast")
        }
        PriorBasis::Rope {
            rope,
            parameters,
            guesses,
            draws,
            duty,
        } => {
            let duty = match duty {
                Some(duty) => format!("under the duty of {duty}"),
                None => "under work whose peaks nobody recorded".into(),
            };
            format!(
                "the law of {rope} {duty}: {draws} draws, and a fifth as many generic curves; {guesses} of \
                 its {parameters} parameters are starting guesses"
            )
        }
    }
}

/// What was dropped or assumed, in a sentence.
pub fn format_note(note: &TrendNote) -> String {
    let places = |source: &str, more: usize| match more {
        0 => source.to_string(),
        more => format!("{source} and {more} more"),
    };
    match note {
        TrendNote::Repeated { source, more } => {
            format!(
                "{}: the same session again, counted once",
                places(source, *more)
            )
        }
        TrendNote::Overlapping { source, more } => {
            let places = places(source, *more);
            format!("{places}: overlaps the session before it, left out")
        }
        TrendNote::TensioningNotStated { joint } => format!(
            "{joint}: nobody said when it was tensioned (--tensioned DATE), nor when its baseline was; the clock of its \
             creep begins with the first session"
        ),
        TrendNote::LongBefore {
            joint,
            time_utc_s,
            days,
        } => format!(
            "{joint}: its first session is {days:.0} days after the tensioning on {}; is the year right? What it crept until then is not known",
            day_of(*time_utc_s)
        ),
        TrendNote::LifeNotUsed { joint, why } => match why {
            LifeNotUsed::AgeUnknown => format!(
                "{joint}: --life says nothing of it, as nobody said when its rope was put in; state --replaced {joint}=DATE"
            ),
            LifeNotUsed::StrainLimit => format!(
                "{joint}: --life says nothing of it: its rope is replaced by its strain, replace_at_strain_percent"
            ),
        },
        TrendNote::OtherBaseline { joint, time_utc_s } => format!(
            "{joint}: another baseline from {} on; taken as a tensioning",
            day_of(*time_utc_s)
        ),
    }
}
