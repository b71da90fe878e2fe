//! A plan of pretension, as a page and for a terminal.

use super::words::guessed;
use super::{bracketed, caution, notices, page, spoken};
use crate::text::{Told, sentence};
use crate::units::of_joint;
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel, Points};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded};
use sinew_rope::pretension::{Plan, Procedure, Schedule};

/// What was asked for.
fn asked(p: &Plan) -> String {
    let [tension, celsius] = [p.tension_n, p.temperature_c].map(|v| rounded(v, 3));
    let (length, time) = (rounded(1e3 * p.length_m, 4), spoken(p.horizon_s));
    format!("{tension} N at {celsius} °C, strand of {length} mm, for {time}")
}

/// What each procedure leaves and takes away; a star marks the chosen one, on a page behind its row.
fn procedures(p: &Plan, on_page: bool) -> Table {
    type Row<'a> = (usize, &'a Procedure);
    let star = |(i, _): &Row<'_>| if p.chosen == Some(*i) { "*" } else { "" };
    let mut table = Columns::of(p.procedures.iter().enumerate());
    if !on_page {
        table = table.words("", star);
    }
    table = table
        .words("for", |(_, q)| spoken(q.duration_s))
        .column("hold at\nN", |(_, q)| rounded(q.tension_n, 3))
        .column("still to come\nmm", |(_, q)| {
            bracketed(q.still_to_come_m.scaled(1e3), 2)
        })
        .column("taken away\n%", |(_, q)| {
            bracketed(q.removed_share.scaled(100.0), 2)
        });
    if on_page {
        table = table.words("gentlest", star);
    }
    table.table()
}

/// Which procedure is the star's.
fn gentlest(p: &Plan) -> String {
    let percent = rounded(100.0 * p.remove_share, 2);
    match p.chosen.map(|i| &p.procedures[i]) {
        Some(q) => {
            let (tension, time) = (rounded(q.tension_n, 3), spoken(q.duration_s));
            format!(
                "* the gentlest that does: {tension} N for {time} takes {percent} % or more away"
            )
        }
        None => format!("none of these takes {percent} % away; the best one is used below"),
    }
}

/// How it is strung and when it is tensioned again.
fn strung(p: &Plan) -> String {
    let (mounting, lowest) = (mounting(p), rounded(p.lowest_n, 3));
    format!(
        "strung at working tension, a minute to settle, then at constant length; {mounting}; tensioned again at {lowest} N"
    )
}

/// Both schedules, a sentence or two each.
fn schedules(p: &Plan) -> Vec<String> {
    let both = [
        ("as it comes", &p.schedule_new),
        ("bedded in", &p.schedule_bedded),
    ];
    both.map(|(word, s)| schedule(word, s, p)).to_vec()
}

/// How to bed a rope in, and when to tension it again.
pub fn planned(p: &Plan) -> Page {
    let percent = rounded(100.0 * p.remove_share, 2);
    let tension = rounded(p.tension_n, 3);
    let headline = match p.chosen.map(|i| &p.procedures[i]) {
        Some(c) => Headline::new(
            Level::Good,
            format!(
                "Hold it at {} N for {}, then tension it anew at {tension} N: that takes {} % of the later elongation away ({percent} % was asked for).",
                rounded(c.tension_n, 3),
                spoken(c.duration_s),
                bracketed(c.removed_share.scaled(100.0), 2),
            ),
        ),
        None => Headline::new(
            Level::Watch,
            format!("No procedure tried takes {percent} % of the later elongation away."),
        ),
    };
    let grows = Headline::from(format!(
        "At a constant {tension} N, {} grows by {} mm in {}, counted from a minute after tensioning.{}",
        p.rope,
        bracketed(p.without_m.scaled(1e3), 2),
        spoken(p.horizon_s),
        guessed(p.starting_guesses, p.parameters)
    ));
    let mut first = vec![Block::Headlines(vec![grows, headline])];
    first.extend(notices(&p.cautions));
    first.push(Block::Figure(
        Box::new(plan_figure(p)),
        "Left: elongation at working tension that is still to come after a bedding-in at the tension and of the length shown. Right: the rope strung at working tension and left at its length, at the catalogue's values; with two ropes, the mean of both.".into(),
    ));
    let bedding = vec![
        procedures(p, true).into(),
        Block::Paragraph(sentence(&gentlest(p))),
    ];
    let retension = vec![
        Block::Paragraph(sentence(&strung(p))),
        Block::List(schedules(p).iter().map(|s| sentence(s)).collect()),
    ];
    page(format!("Pretension and bedding-in of {}", p.rope), asked(p))
        .section("", first)
        .section("Bedding-in", bedding)
        .section("Re-tensioning at constant length", retension)
}

/// The plan as text for a terminal.
pub fn plan_table(p: &Plan) -> String {
    let mut out = Told::default();
    out.say(format!("{}: {}", p.rope, asked(p)));
    let grows = bracketed(p.without_m.scaled(1e3), 2);
    out.say(format!(
        "at constant tension it grows by {grows} mm from a minute after tensioning"
    ));
    out.add("\nbedding-in: hold the rope at a tension for a time, then go back\n");
    out.table(procedures(p, false));
    out.say(gentlest(p));
    out.add("\n");
    out.say(strung(p));
    for schedule in schedules(p) {
        out.item(schedule);
    }
    out.add("\n");
    out.say(format!(
        "{} of {} parameters are starting guesses; brackets are 95 % intervals",
        p.starting_guesses, p.parameters
    ));
    for what in &p.cautions {
        out.say(format!("warning: {}", caution(*what)));
    }
    out.0
}

/// Unit of the joint's sag.
fn sag_unit(p: &Plan) -> &'static str {
    of_joint(p.joint.is_some_and(|j| j.slides)).offset
}

/// What else there is at constant length.
fn mounting(p: &Plan) -> String {
    let gives = match p.give_m_per_n {
        0.0 => "nothing else in the machine gives".to_owned(),
        c => format!(
            "beside each strand the machine gives {} µm per N",
            rounded(1e6 * c, 3)
        ),
    };
    match p.joint {
        None => gives,
        Some(j) => format!(
            "{gives}; a second rope pulls the other way over {} mm, and the joint holds {} {}",
            rounded(1e3 * j.radius_m, 3),
            rounded(j.torque_nm, 3),
            of_joint(j.slides).torque
        ),
    }
}

/// Times of re-tensioning that are listed.
const SHOWN: usize = 8;

/// One schedule in words.
fn schedule(word: &str, s: &Schedule, p: &Plan) -> String {
    let all = s.times_s.len();
    let (low, high) = (rounded(s.count.low, 2), rounded(s.count.high, 2));
    let times: Vec<String> = s.times_s.iter().take(SHOWN).map(|t| spoken(*t)).collect();
    let more = match all.saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let after = format!("tension it again after {}{more}", times.join(", "));
    let times = match all {
        0 => format!("never to be tensioned again; 95 %: {low} to {high} times"),
        1 => format!("{after}; once ({low} to {high} times)"),
        n => format!("{after}; {n} times ({low} to {high})"),
    };
    let sag = s.left_alone.sag_rad.last().map_or(String::new(), |sag| {
        format!(
            ", the joint {} {} lower",
            rounded(1e3 * sag, 2),
            sag_unit(p)
        )
    });
    let start = match s.start_n {
        Some(start) => format!(
            "Strung at {} N it never falls below {} N",
            bracketed(start, 3),
            rounded(p.lowest_n, 3)
        ),
        None => "No pretension up to 40 % of the breaking load would hold it".into(),
    };
    let (time, never) = (spoken(p.horizon_s), 100.0 * s.never_share);
    let end = bracketed(s.tension_at_end_n, 2);
    format!(
        "{word}: {times} in {time}, never in {never:.0} % of the draws. Left alone it falls to {end} N{sag}. {start}"
    )
}

fn plan_figure(p: &Plan) -> Figure {
    let mut bedding = Panel::new("", "held for", "still to come (mm)").x_times();
    let mut tensions: Vec<f64> = p.procedures.iter().map(|q| q.tension_n).collect();
    tensions.dedup();
    for (n, colour) in tensions.iter().zip(Colour::CYCLE) {
        let (x, y): (Vec<f64>, Vec<f64>) = p
            .procedures
            .iter()
            .filter(|q| q.tension_n == *n)
            .map(|q| (q.duration_s.log10(), 1e3 * q.still_to_come_m.value))
            .unzip();
        let dots = Points::new("", x.clone(), y.clone()).colour(colour);
        let line = Line::new(format!("{} N", rounded(*n, 3)), x, y).colour(colour);
        bedding = bedding.line(line).points(dots);
    }
    let mut strung = Panel::new("", "time since it was strung", "tension (N)")
        .x_times()
        .reference(p.lowest_n, "lowest");
    for (word, s, colour) in [
        ("as it comes", &p.schedule_new, Colour::Orange),
        ("bedded in", &p.schedule_bedded, Colour::Blue),
    ] {
        let x = s.left_alone.time_s.iter().map(|t| t.log10()).collect();
        let line = Line::new(word, x, s.left_alone.tension_n.clone());
        strung = strung.line(line.colour(colour).dash(Dash::Solid));
    }
    let told = |s: &Schedule| bracketed(s.tension_at_end_n, 2);
    Figure::new("")
        .seen(format!(
            "Left alone, the rope ends at {} N as it comes and at {} N bedded in (95 % intervals); the lowest wanted is {} N",
            told(&p.schedule_new),
            told(&p.schedule_bedded),
            rounded(p.lowest_n, 3)
        ))
        .size(960.0, 360.0)
        .columns(2)
        .panel(bedding)
        .panel(strung)
}
