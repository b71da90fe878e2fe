//! Plan of pretension and preconditioning as text and HTML report.

use super::messages::assumed_note;
use super::{bracketed, caution_message, notices, page, share_of_draws, spoken};
use crate::text::{TerminalText, sentence};
use crate::units::of_joint;
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel, Points};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded};
use sinew_rope::pretension::{Plan, Procedure, Schedule};

/// Formats the requested conditions.
fn conditions(p: &Plan) -> String {
    let [tension, celsius] = [p.tension_n, p.temperature_c].map(|v| rounded(v, 3));
    let (length, time) = (rounded(1e3 * p.length_m, 4), spoken(p.horizon_s));
    format!("{tension} N at {celsius} °C, strand of {length} mm, for {time}")
}

/// Tabulates remaining and removed elongation per procedure; a star marks the selected one, in the report in the last column.
fn procedures(p: &Plan, on_page: bool) -> Table {
    type Row<'a> = (usize, &'a Procedure);
    let star = |(i, _): &Row<'_>| if p.chosen == Some(*i) { "*" } else { "" };
    let mut table = Columns::of(p.procedures.iter().enumerate());
    if !on_page {
        table = table.words("", star);
    }
    table = table
        .words("duration", |(_, q)| spoken(q.duration_s))
        .column("tension\n(N)", |(_, q)| rounded(q.tension_n, 3))
        .column("remaining\n(mm)", |(_, q)| {
            bracketed(q.remaining_m.scaled(1e3), 2)
        })
        .column("removed\n(%)", |(_, q)| {
            bracketed(q.removed_share.scaled(100.0), 2)
        });
    if on_page {
        table = table.words("selected", star);
    }
    table.table()
}

/// States the selected procedure.
fn mildest(p: &Plan) -> String {
    let percent = rounded(100.0 * p.remove_share, 2);
    match p.chosen.map(|i| &p.procedures[i]) {
        Some(q) => {
            let (tension, time) = (rounded(q.tension_n, 3), spoken(q.duration_s));
            format!(
                "* mildest sufficient procedure: {tension} N for {time} removes at least {percent} %"
            )
        }
        None => format!("no procedure removes {percent} %; the best one is used below"),
    }
}

/// States the share of draws in which the rope fails at constant tension, as the end of a sentence; empty if in none.
fn broken(p: &Plan) -> String {
    match p.broken_share {
        0.0 => String::new(),
        share => format!("; failure in {} of the draws", share_of_draws(share)),
    }
}

/// States how the rope is mounted, and when it is re-tensioned.
fn mounted(p: &Plan) -> String {
    let (mounting, lowest) = (mounting(p), rounded(p.lowest_n, 3));
    format!(
        "mounted at working tension, 1 min settling, then constant length; {mounting}; re-tensioned at {lowest} N"
    )
}

/// Formats the schedules as delivered and preconditioned.
fn schedules(p: &Plan) -> Vec<String> {
    let both = [
        ("as delivered", &p.schedule_as_delivered),
        ("preconditioned", &p.schedule_preconditioned),
    ];
    both.map(|(word, s)| schedule(word, s, p)).to_vec()
}

/// Builds the report of a plan.
pub fn planned(p: &Plan) -> Page {
    let percent = rounded(100.0 * p.remove_share, 2);
    let tension = rounded(p.tension_n, 3);
    let headline = match p.chosen.map(|i| &p.procedures[i]) {
        Some(c) => Headline::new(
            Level::Good,
            format!(
                "Hold {} N for {}, then re-tension to {tension} N: removes {} % of the later elongation (requested {percent} %).",
                rounded(c.tension_n, 3),
                spoken(c.duration_s),
                bracketed(c.removed_share.scaled(100.0), 2),
            ),
        ),
        None => Headline::new(
            Level::Watch,
            format!("No evaluated procedure removes {percent} % of the later elongation."),
        ),
    };
    let elongation = Headline::from(format!(
        "At a constant {tension} N, the elongation of {} is {} mm in {} (from 1 min after pretensioning){}.{}",
        p.rope,
        bracketed(p.without_m.scaled(1e3), 2),
        spoken(p.horizon_s),
        broken(p),
        assumed_note(p.assumed_parameters, p.parameters)
    ));
    let mut first = vec![Block::Headlines(vec![elongation, headline])];
    first.extend(notices(&p.cautions));
    first.push(Block::Figure(
        Box::new(plan_figure(p)),
        "Left: remaining elongation at working tension after preconditioning at the given tension and duration. Right: tension of the rope mounted at working tension at constant length, catalogue values; mean of both ropes of a pair.".into(),
    ));
    let preconditioning = vec![
        procedures(p, true).into(),
        Block::Paragraph(sentence(&mildest(p))),
    ];
    let retension = vec![
        Block::Paragraph(sentence(&mounted(p))),
        Block::List(schedules(p).iter().map(|s| sentence(s)).collect()),
    ];
    page(
        format!("Pretension and preconditioning of {}", p.rope),
        conditions(p),
    )
    .section("", first)
    .section("Preconditioning", preconditioning)
    .section("Re-tensioning at constant length", retension)
}

/// Renders a plan for a terminal.
pub fn plan_table(p: &Plan) -> String {
    let mut out = TerminalText::default();
    out.paragraph(format!("{}: {}", p.rope, conditions(p)));
    let elongation = bracketed(p.without_m.scaled(1e3), 2);
    out.paragraph(format!(
        "elongation at constant tension: {elongation} mm from 1 min after pretensioning{}",
        broken(p)
    ));
    out.add("\npreconditioning: hold a tension for a duration, then return to working tension\n");
    out.table(procedures(p, false));
    out.paragraph(mildest(p));
    out.add("\n");
    out.paragraph(mounted(p));
    for schedule in schedules(p) {
        out.item(schedule);
    }
    out.add("\n");
    out.paragraph(format!(
        "{} of {} parameters assumed; 95 % intervals in brackets",
        p.assumed_parameters, p.parameters
    ));
    for what in &p.cautions {
        out.paragraph(format!("warning{}", caution_message(*what).tag()));
    }
    out.0
}

/// Unit of the sag of the joint.
fn sag_unit(p: &Plan) -> &'static str {
    of_joint(p.joint.is_some_and(|j| j.slides)).offset
}

/// Describes the mounting: compliance in series, second rope, and torque.
fn mounting(p: &Plan) -> String {
    let compliance = match p.series_compliance_m_per_n {
        0.0 => "rigid mounting".to_owned(),
        c => format!("series compliance {} µm/N per strand", rounded(1e6 * c, 3)),
    };
    match p.joint {
        None => compliance,
        Some(j) => format!(
            "{compliance}; antagonistic rope on a pulley of radius {} mm, joint torque {} {}",
            rounded(1e3 * j.radius_m, 3),
            rounded(j.torque_nm, 3),
            of_joint(j.slides).torque
        ),
    }
}

/// Maximum number of listed re-tensioning times.
const MAX_LISTED: usize = 8;

/// Formats a schedule.
fn schedule(word: &str, s: &Schedule, p: &Plan) -> String {
    let all = s.times_s.len();
    let (low, high) = (rounded(s.count.low, 2), rounded(s.count.high, 2));
    let times: Vec<String> = s
        .times_s
        .iter()
        .take(MAX_LISTED)
        .map(|t| spoken(*t))
        .collect();
    let more = match all.saturating_sub(MAX_LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let after = format!("re-tension after {}{more}", times.join(", "));
    let times = match all {
        0 => format!("no re-tensioning (95 % interval {low} to {high} times)"),
        1 => format!("{after}; 1 time (95 % interval {low} to {high})"),
        n => format!("{after}; {n} times (95 % interval {low} to {high})"),
    };
    let sag = s.unattended.sag_rad.last().map_or(String::new(), |sag| {
        format!(
            ", sag of the joint {} {}",
            rounded(1e3 * sag, 2),
            sag_unit(p)
        )
    });
    let start = match s.start_n {
        Some(start) => format!(
            "An initial tension of {} N keeps it above {} N",
            bracketed(start, 3),
            rounded(p.lowest_n, 3)
        ),
        None => "No pretension up to 40 % of the breaking load is sufficient".into(),
    };
    let (time, never) = (spoken(p.horizon_s), share_of_draws(s.never_share));
    let end = bracketed(s.tension_at_end_n, 2);
    format!(
        "{word}: {times} within {time}, none in {never} of the draws. Without re-tensioning the tension falls to {end} N{sag}. {start}"
    )
}

fn plan_figure(p: &Plan) -> Figure {
    let mut preconditioning = Panel::new("", "duration", "remaining elongation (mm)").x_times();
    let mut tensions: Vec<f64> = p.procedures.iter().map(|q| q.tension_n).collect();
    tensions.dedup();
    for (n, colour) in tensions.iter().zip(Colour::CYCLE) {
        let (x, y): (Vec<f64>, Vec<f64>) = p
            .procedures
            .iter()
            .filter(|q| q.tension_n == *n)
            .map(|q| (q.duration_s.log10(), 1e3 * q.remaining_m.value))
            .unzip();
        let dots = Points::new("", x.clone(), y.clone()).colour(colour);
        let line = Line::new(format!("{} N", rounded(*n, 3)), x, y).colour(colour);
        preconditioning = preconditioning.line(line).points(dots);
    }
    let mut mounted = Panel::new("", "time since mounting", "tension (N)")
        .x_times()
        .reference(p.lowest_n, "minimum");
    for (word, s, colour) in [
        ("as delivered", &p.schedule_as_delivered, Colour::Orange),
        ("preconditioned", &p.schedule_preconditioned, Colour::Blue),
    ] {
        let x = s.unattended.time_s.iter().map(|t| t.log10()).collect();
        let line = Line::new(word, x, s.unattended.tension_n.clone());
        mounted = mounted.line(line.colour(colour).dash(Dash::Solid));
    }
    let end = |s: &Schedule| bracketed(s.tension_at_end_n, 2);
    Figure::new("")
        .seen(format!(
            "Final tension without re-tensioning: {} N as delivered, {} N preconditioned (95 % intervals); minimum {} N",
            end(&p.schedule_as_delivered),
            end(&p.schedule_preconditioned),
            rounded(p.lowest_n, 3)
        ))
        .size(960.0, 360.0)
        .columns(2)
        .panel(preconditioning)
        .panel(mounted)
}
