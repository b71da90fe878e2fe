//! The session's estimate: sentences, tables, figures, and its sections of the report.

use crate::text::{Told, or_dash, yes_no};
use crate::units::{in_units, in_units_of, name_in_table, of_heads, of_joint};
use crate::warnings::session_warnings;
use crate::words::{newtons, plus_minus, plus_minus_cells};
use sinew_estimate::session::{
    AnchorReading, AnchoredOffset, BlockEstimate, LimitState, LiveCourse, MotorTorque,
    SessionEstimate, TendonChange, TendonChangeKind, TendonEstimate, Verdict,
};
use sinew_estimate::{Cause, NuisanceChange, UnknownCause};
use sinew_figure::plot::{Band, Colour, Figure, Line, Panel};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded, with_interval};
use sinew_files::names;
use sinew_model::offset::ForceEstimate;
use sinew_model::transmission::AnchorKind;
use sinew_model::{Gaussian, Interval95};

/// Offset and stretch of every tendon.
fn tendons(session: &SessionEstimate) -> Columns<&TendonEstimate> {
    let heads = of_heads(session.joints.iter().map(|j| j.slides));
    Columns::of(&session.joints)
        .words("joint", |j| name_in_table(&j.name, j.slides, heads))
        .columns(["offset\nmrad", "± (95 %)\nmrad"], |j| {
            plus_minus_cells(Some(j.offset_rad), 1e3)
        })
        .columns(["stretch\nmm", "± (95 %)\nmm"], |j| {
            plus_minus_cells(j.elongation_m, 1e3)
        })
}

/// What was estimated along: what was believed before and after, under four heads.
pub(crate) fn estimated_along<'a>(
    changes: impl IntoIterator<Item = &'a NuisanceChange>,
    [of, parameter, before, after]: [&str; 4],
) -> Columns<&'a NuisanceChange> {
    Columns::of(changes)
        .words(of, |n| n.joint.clone().unwrap_or_default())
        .words(parameter, |n| {
            format!("{} {}", n.name, n.unit).trim_end().to_owned()
        })
        .column(before, |n| plus_minus(n.prior, 1.0))
        .column(after, |n| plus_minus(n.posterior, 1.0))
}

fn nuisance(session: &SessionEstimate) -> Table {
    let heads = ["joint", "parameter", "before\n± 95 %", "after\n± 95 %"];
    let table = estimated_along(&session.nuisance, heads);
    table.column("moved", |n| yes_no(n.moved)).table()
}

/// The session's estimate for a terminal; with everything estimated along where `along` asks for it.
pub(crate) fn told(out: &mut Told, session: &SessionEstimate, along: bool) {
    let since = match &session.baseline {
        Some(first) => format!("since {first}"),
        None => "against the encoders' zero".into(),
    };
    out.say(format!("offsets {since}, with 95 % intervals"));
    let table = tendons(session)
        .column("strain\n%", |j| {
            let [strain, _] = plus_minus_cells(j.strain_ratio, 100.0);
            strain
        })
        .column("verdict", |j| verdict(j.verdict));
    out.table(in_units_of(
        table.table(),
        of_heads(session.joints.iter().map(|j| j.slides)),
    ));
    out.add("\n");
    for line in session_sentences(session) {
        out.say(line);
    }
    if let Some(course) = &session.live {
        out.add("\n");
        live(out, course, session);
    }
    if along {
        out.add("\n");
        out.table(nuisance(session));
    }
}

/// The online estimate of it.
fn live(out: &mut Told, course: &LiveCourse, session: &SessionEstimate) {
    out.say("Online estimate at the end of the recording");
    let heads = of_heads(session.joints.iter().map(|j| j.slides));
    let pairs = || course.joints.iter().zip(&session.joints);
    let table = Columns::of(pairs())
        .words("joint", |(_, joint)| {
            name_in_table(&joint.name, joint.slides, heads)
        })
        .columns(["offset\nmrad", "± (95 %)\nmrad"], |(now, _)| {
            plus_minus_cells(Some(now.offset_rad), 1e3)
        })
        .column("stiffness changed\nprobability, %", |(now, _)| {
            or_dash(now.stiffness_changed_probability, |p| rounded(100.0 * p, 2))
        });
    out.table(in_units_of(table.table(), heads));
    out.add("\n");
    out.say(doubts(course));
    let force = course.external_force.as_ref();
    if let Some(force) = force.filter(|f| f.is_worth_a_word()) {
        let what = match force.is_stated {
            true => "The constant force from outside, which was stated, is".into(),
            false => {
                let percent = 100.0 * force.probability;
                format!("A constant force from outside acts ({percent:.0} % likely):")
            }
        };
        let newtons = newtons(force.force_n);
        out.say(format!("{what} {newtons} N along x, y and z of the base"));
    }
    let apart = pairs().filter(|(now, joint)| {
        // By motion alone, as it reads no stop and no mark.
        let batch = (joint.anchored.as_ref()).map_or(joint.offset_rad, |a| a.by_motion_rad);
        let off = Gaussian::new(
            now.offset_rad.mean - batch.mean,
            now.offset_rad.deviation.hypot(batch.deviation),
        );
        off.is_nonzero_95()
    });
    let apart: Vec<String> = apart.map(|(now, _)| now.name.clone()).collect();
    if !apart.is_empty() {
        let joints = names::list(&apart);
        out.say(format!(
            "At {joints} the online estimate contradicts the estimate above, which uses the whole recording: use that one"
        ));
    }
}

/// When the online estimate was provisional, in a sentence.
pub fn doubts(course: &LiveCourse) -> String {
    let spans = course.doubts.iter().map(|d| {
        let [from, to] = [d.from_s, d.to_s].map(|s| rounded(s, 3));
        format!("{from} to {to} s")
    });
    let spans: Vec<String> = spans.collect();
    match (&spans[..], course.in_doubt) {
        ([], _) => "The online estimate was never provisional".into(),
        (_, true) => format!(
            "The online estimate was provisional from {}, which includes the end: use the estimate above",
            spans.join(", ")
        ),
        (_, false) => format!(
            "The online estimate was provisional from {}",
            spans.join(", ")
        ),
    }
}

/// A verdict in a word or two.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Longer => "longer",
        Verdict::Shorter => "shorter",
        Verdict::Unchanged => "unchanged",
        Verdict::CannotTell => "can't tell",
    }
}

/// Adds what the joint estimate says.
pub(super) fn sections(page: Page, session: &SessionEstimate) -> Page {
    let since = match &session.baseline {
        Some(baseline) => format!("Since the baseline ({baseline})"),
        None => "Against the encoders' zero, without a baseline".into(),
    };
    let mut opening = vec![
        Block::Headlines(session.joints.iter().map(headline).collect()),
        Block::Paragraph(
            "All joints estimated together with stiffness, masses, friction, encoder errors, temperature and payload; times that fit nothing are left out as contact. ± is half a 95 % interval, on the whole page.".into(),
        ),
        Block::Table(numbers(session)),
    ];
    opening.push(Block::List(session_sentences(session)));
    if !session.warnings.is_empty() {
        opening.push(Block::List(session_warnings(session)));
    }
    let mut page = page.section(since, opening);
    for (i, joint) in session.joints.iter().enumerate() {
        page = page.section(
            format!("Joint {} over the recording", joint.name),
            vec![Block::Figure(
                Box::new(course(session, i)),
                "Thin line: what each block of 0.2 s says once everything else is taken off. Grey: left out as contact or disturbance.".into(),
            )],
        );
    }
    let moved = session.nuisance.iter().filter(|n| n.moved).count();
    page.section(
        "Estimated along",
        vec![
            Block::Paragraph(
                "What was believed before and after; ± is half the 95 % interval. What the data did not move rests on the tolerance alone.".into(),
            ),
            Block::Folded(
                format!("{} parameters, {} of them moved by the data", session.nuisance.len(), moved),
                vec![nuisance(session).into()],
            ),
        ],
    )
}

/// What an answer asks for: a rope that failed or a limit that is passed, a change, nothing, or more data.
fn level(joint: &TendonEstimate) -> Level {
    let failures = [
        TendonChangeKind::StrandFailure,
        TendonChangeKind::SlipOrStrandFailure,
    ];
    let failed = |c: &TendonChange| failures.contains(&c.kind);
    if passed_mm(joint).is_some() || joint.changes.iter().any(failed) {
        return Level::Alarm;
    }
    match joint.verdict {
        Verdict::Longer | Verdict::Shorter => Level::Watch,
        _ if !joint.changes.is_empty() => Level::Watch,
        Verdict::Unchanged => Level::Good,
        Verdict::CannotTell => Level::Open,
    }
}

/// The limit of elongation that a tendon has passed, mm.
pub(crate) fn passed_mm(joint: &TendonEstimate) -> Option<String> {
    let passed = joint.retension.filter(|r| r.state == LimitState::Passed)?;
    Some(rounded(1e3 * passed.elongation_m, 2))
}

fn beyond(joint: &TendonEstimate) -> Option<String> {
    let mm = passed_mm(joint)?;
    Some(format!("beyond its limit of {mm} mm: tension it again"))
}

fn headline(joint: &TendonEstimate) -> Headline {
    let (name, unit) = (&joint.name, of_joint(joint.slides).offset);
    let size = |x: Gaussian| with_interval(1e3 * x.mean.abs(), 1e3 * x.deviation);
    let size = match joint.elongation_m {
        Some(m) => format!("{} mm", size(m)),
        None => format!("{} {unit} at the joint", size(joint.offset_rad)),
    };
    let slip = |c: &TendonChange| {
        let (kind, mrad) = (change_kind(c.kind), plus_minus(c.size_rad?, 1e3));
        Some(format!("; {kind} of {mrad} {unit} at {:.1} s", c.time_s))
    };
    let slip: String = joint.changes.iter().filter_map(slip).collect();
    let limit = beyond(joint).map_or(String::new(), |beyond| format!("; {beyond}")) + &slip;
    let text = match joint.verdict {
        Verdict::Longer => format!("{name}: the tendon is longer by {size}{limit}"),
        Verdict::Shorter => format!("{name}: the tendon is shorter by {size}{slip}"),
        Verdict::Unchanged => format!("{name}: no stretch seen ({size}){slip}"),
        Verdict::CannotTell => format!("{name}: can't tell from this recording ({size}){slip}"),
    };
    Headline::new(level(joint), text)
}

/// The tendons' numbers for the page.
fn numbers(session: &SessionEstimate) -> Table {
    let torques = |j: &&TendonEstimate| {
        let [low, high] = [j.torque_nm.min, j.torque_nm.max].map(|t| rounded(t, 2));
        format!("{low} to {high}")
    };
    let table = tendons(session)
        .columns(["stiffness against robot.toml\n%", "± (95 %)\n%"], |j| {
            plus_minus_cells(Some(j.stiffness_change_ratio), 100.0)
        })
        .column("torque\nN·m", torques);
    in_units_of(
        table.table(),
        of_heads(session.joints.iter().map(|j| j.slides)),
    )
}

/// Offset of a joint over the recording.
fn course(session: &SessionEstimate, i: usize) -> Figure {
    let joint = &session.joints[i];
    let blocks = &session.blocks;
    let times: Vec<f64> = blocks.iter().map(|b| b.time_s).collect();
    let of_blocks = |f: &dyn Fn(&BlockEstimate) -> f64| -> Vec<f64> {
        blocks.iter().map(|b| 1e3 * f(b)).collect()
    };
    let seen = of_blocks(&|b| match b.is_left_out() {
        true => f64::NAN,
        false => b.block_rad[i],
    });
    let estimate = of_blocks(&|b| b.offset_rad[i].mean);
    let low = of_blocks(&|b| b.offset_rad[i].interval_95().low);
    let high = of_blocks(&|b| b.offset_rad[i].interval_95().high);
    let unit = of_joint(joint.slides).offset;
    let blocks = Line::new("blocks", times.clone(), seen);
    let label = in_units("offset δ_{e} (mrad)", of_joint(joint.slides));
    let mut panel = Panel::new("", "time (s)", label)
        .band(Band::new("95 %", times.clone(), low, high))
        .line(blocks.colour(Colour::Black).width(0.7))
        .line(Line::new("estimate", times, estimate).step());
    for left in &session.left_out {
        panel = panel.span(left.from_s, left.to_s, "left out");
    }
    for change in &joint.changes {
        let size = change.size_rad.map_or(0.0, |size| 1e3 * size.mean);
        let label = format!("{} {} {unit}", change_kind(change.kind), rounded(size, 2));
        panel = panel.event(change.time_s, label);
    }
    for change in &session.payload_changes {
        let label = format!("payload {} kg", rounded(change.change_kg.mean, 2));
        panel = panel.event(change.time_s, label);
    }
    if let Some(elongation) = joint.elongation_m {
        let per_mrad = elongation.mean / joint.offset_rad.mean;
        if per_mrad.is_finite() {
            panel = panel.y_right("elongation (mm)", per_mrad);
        }
    }
    Figure::new("")
        .size(820.0, 300.0)
        .seen(headline(joint).text)
        .panel(panel)
}

/// What happened, a sentence each.
pub fn session_sentences(session: &SessionEstimate) -> Vec<String> {
    let mut out: Vec<String> = session.joints.iter().flat_map(of_tendon).collect();
    out.extend(session.payload_changes.iter().map(|change| {
        format!(
            "payload changed by {} kg {}",
            plus_minus(change.change_kg, 1.0),
            when(change.time_s, change.interval_s, change.probability)
        )
    }));
    let changes = session.joints.iter().flat_map(|j| &j.changes);
    let mut stated = (changes.map(|c| c.probability))
        .chain(session.payload_changes.iter().map(|c| c.probability));
    if stated.any(|p| p.is_some()) {
        out.push(
            "the probabilities count this recording and a guess at how often such changes happen"
                .into(),
        );
    }
    // One that nobody stated is a warning.
    let stated = session.external_force.as_ref().filter(|f| f.is_stated);
    out.extend(stated.map(of_stated_force));
    out.push(format!(
        "payload {} kg{}; {:.0} % of the time left out as contact or disturbance; {} poses{}",
        plus_minus(session.payload_kg, 1.0),
        if session.payload_changes.is_empty() {
            ""
        } else {
            " at the end"
        },
        100.0 * session.left_out_share,
        session.poses,
        match session.motor_torque {
            MotorTorque::FromCurrent => "; motor current used",
            MotorTorque::Measured => "; motor torque used",
            MotorTorque::Unused => "",
        }
    ));
    out
}

/// What the recording made of a force that was stated: whoever stated another one sees it here.
fn of_stated_force(force: &ForceEstimate) -> String {
    format!(
        "force from outside, as stated and as the recording shows it: {} N along x, y and z of the base",
        newtons(force.force_n)
    )
}

/// What happened to a tendon.
fn of_tendon(joint: &TendonEstimate) -> Vec<String> {
    let mut out = Vec::from_iter(beyond(joint));
    let unit = of_joint(joint.slides).offset;
    out.extend(joint.changes.iter().map(|c| of_change(c, unit)));
    out.extend(joint.anchored.iter().map(|a| of_anchors(a, unit)));
    out.extend(joint.slack_rad.map(|slack| of_play(slack, unit)));
    let out = out.into_iter();
    out.map(|text| format!("{}: {text}", joint.name)).collect()
}

/// The play of a pair of ropes. One that may be none is no play that was seen.
fn of_play(slack: Gaussian, unit: &str) -> String {
    let at_most = slack.mean + slack.half_width_95();
    if slack.mean > slack.half_width_95() {
        format!(
            "play of {} {unit} to either side: the pair of ropes is slack, and near zero torque the position is unknown by that",
            plus_minus(slack, 1e3)
        )
    } else if at_most > 0.0 {
        let most = rounded(1e3 * at_most, 2);
        format!(
            "no play of the pair of ropes is seen; up to {most} {unit} to either side could not be told"
        )
    } else {
        "no play of the pair of ropes is seen".into()
    }
}

fn of_change(change: &TendonChange, unit: &str) -> String {
    let stiffness = match change.stiffness_change_ratio {
        Some(ratio) => format!("stiffness {} %", plus_minus(ratio, 100.0)),
        None => "no loss of stiffness seen".into(),
    };
    let when = when(change.time_s, change.interval_s, change.probability);
    let kind = change_kind(change.kind);
    match (change.kind, change.size_rad) {
        // It has no time in this recording.
        (TendonChangeKind::SofterSinceBefore | TendonChangeKind::StifferSinceBefore, _) => {
            format!("{kind}: {stiffness}")
        }
        (_, None) => format!("{kind} {when} without a slip: {stiffness}"),
        (_, Some(size)) => {
            let by = format!("by {} {unit} {when}", plus_minus(size, 1e3));
            match (change.kind, change.cause) {
                (TendonChangeKind::StrandFailure, _) => {
                    format!("a strand has failed and let the rope go {by}; {stiffness}")
                }
                (TendonChangeKind::SlipOrStrandFailure, _) => format!(
                    "the rope slipped or a strand failed {by}; which of the two can't be told; {stiffness}"
                ),
                (TendonChangeKind::Retensioned, _) => format!(
                    "it was tensioned again {by}: most of the offset is gone; make a new baseline"
                ),
                (_, Some(cause)) => slipped(cause, &by, &stiffness),
                (_, None) => format!("{kind} {by}; {stiffness}"),
            }
        }
    }
}

/// What was touched, and what that did to the offset.
fn of_anchors(anchored: &AnchoredOffset, unit: &str) -> String {
    let what = |r: &AnchorReading| {
        let kind = match r.kind {
            AnchorKind::Stop => "pushed against its stop",
            AnchorKind::JointMark => "passed its mark",
            AnchorKind::MotorMark => "its motor passed its mark",
        };
        format!("{kind} at {:.1} s", r.time_s)
    };
    let touched: Vec<String> = anchored.readings.iter().map(what).collect();
    let since = match anchored.since_baseline {
        true => "since the baseline touched it",
        false => "against where it is said to be",
    };
    let shown = |x: Gaussian| plus_minus(x, 1e3);
    let push = anchored.by_push_rad.map_or(String::new(), |push| {
        format!("; the push alone shows {} {unit}", shown(push))
    });
    format!(
        "{}: its encoders are off by {} {unit} {since}, which the offset is corrected for; by motion alone it was {} {unit}{push}",
        touched.join(", "),
        shown(anchored.correction_rad),
        shown(anchored.by_motion_rad)
    )
}

/// What slipped, by how much, and how that is known.
fn slipped(cause: Cause, by: &str, stiffness: &str) -> String {
    let encoder = |side: &str| {
        format!(
            "the {side} encoder slipped {by}, not the rope: its reading jumped between two samples"
        )
    };
    let open = |why: &str| format!("rope or encoder slipped {by}; which can't be told: {why}");
    match cause {
        Cause::MotorEncoder => encoder("motor"),
        Cause::JointEncoder => encoder("joint"),
        Cause::Rope => format!(
            "the rope slipped {by}; {stiffness}. Motor or joint moved, and no reading jumped"
        ),
        Cause::Unknown(UnknownCause::Missing) => open("samples are missing around it"),
        Cause::Unknown(UnknownCause::Noise) => open("it is too small for the encoders' noise"),
        Cause::Unknown(UnknownCause::Rate) => open("the recording's rate is too low"),
        Cause::Unknown(UnknownCause::Both) => open("both readings jumped"),
    }
}

/// A kind of change in a word or two.
pub(crate) fn change_kind(kind: TendonChangeKind) -> &'static str {
    match kind {
        TendonChangeKind::Slip => "slip",
        TendonChangeKind::StrandFailure => "strand failure",
        TendonChangeKind::SlipOrStrandFailure => "slip or strand failure",
        TendonChangeKind::Stiffer => "stiffer",
        TendonChangeKind::Retensioned => "re-tensioned",
        TendonChangeKind::SofterSinceBefore => "softer since before",
        TendonChangeKind::StifferSinceBefore => "stiffer since before",
    }
}

/// When a change happened, and how sure it is.
fn when(time_s: f64, interval_s: Option<Interval95>, probability: Option<f64>) -> String {
    const SURE: f64 = 0.999;
    let (Some(Interval95 { low, high }), Some(probability)) = (interval_s, probability) else {
        return format!("at {time_s:.1} s");
    };
    let sure = if probability > SURE {
        format!("> {SURE}")
    } else {
        format!("{probability:.2}")
    };
    format!("at {time_s:.1} s ({low:.1} to {high:.1} s; probability {sure})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stated_force_is_told_as_it_was_found() {
        let force = ForceEstimate {
            is_stated: true,
            probability: 1.0,
            force_n: [0.0, -0.12, 4.9].map(|mean| Gaussian::new(mean, 0.2)),
        };
        assert_eq!(
            of_stated_force(&force),
            "force from outside, as stated and as the recording shows it: 0.00 ± 0.39, −0.12 ± 0.39, 4.90 ± 0.39 N along x, y and z of the base"
        );
    }

    #[test]
    fn what_happened_is_said_with_its_moment_size_and_how_sure_it_is() {
        let slip = TendonChange {
            kind: TendonChangeKind::Slip,
            time_s: 34.2,
            interval_s: Some(Interval95::new(33.9, 34.6)),
            probability: Some(0.95),
            size_rad: Some(Gaussian::new(5.125e-3, 0.41e-3 / 1.96)),
            stiffness_change_ratio: None,
            cause: Some(Cause::Rope),
        };
        let lost = Gaussian::new(-0.04, 0.015 / 1.96);
        let of_kind = |kind| TendonChange {
            kind,
            stiffness_change_ratio: Some(lost),
            ..slip.clone()
        };
        let cases = [
            (
                slip.clone(),
                "the rope slipped by 5.12 ± 0.41 mrad at 34.2 s (33.9 to 34.6 s; probability 0.95); no loss of stiffness seen. Motor or joint moved, and no reading jumped",
            ),
            (
                of_kind(TendonChangeKind::StrandFailure),
                "a strand has failed and let the rope go by 5.12 ± 0.41 mrad at 34.2 s (33.9 to 34.6 s; probability 0.95); stiffness −4.0 ± 1.5 %",
            ),
            (
                of_kind(TendonChangeKind::SofterSinceBefore),
                "softer since before: stiffness −4.0 ± 1.5 %",
            ),
            (
                TendonChange {
                    size_rad: None,
                    probability: Some(0.99999),
                    ..of_kind(TendonChangeKind::StrandFailure)
                },
                "strand failure at 34.2 s (33.9 to 34.6 s; probability > 0.999) without a slip: stiffness −4.0 ± 1.5 %",
            ),
        ];
        for (change, text) in cases {
            assert_eq!(of_change(&change, "mrad"), text);
        }
        assert_eq!(when(3.04, None, None), "at 3.0 s");
    }

    #[test]
    fn a_play_that_may_be_none_is_not_called_slack() {
        let of =
            |mrad: f64, deviation: f64| of_play(Gaussian::new(1e-3 * mrad, 1e-3 * deviation), "mm");
        assert!(
            of(5.0, 1.0)
                .starts_with("play of 5.0 ± 2.0 mm to either side: the pair of ropes is slack")
        );
        assert_eq!(
            of(-0.8, 1.7),
            "no play of the pair of ropes is seen; up to 2.5 mm to either side could not be told"
        );
        assert_eq!(of(-3.0, 1.0), "no play of the pair of ropes is seen");
    }
}
