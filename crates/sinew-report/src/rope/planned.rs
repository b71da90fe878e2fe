//! A plan of pretension as a page.

use super::words::guessed;
use super::{bracketed, caution, notices, page, spoken};
use crate::text::{self, Told};
use crate::units::of_joint;
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel, Points};
use sinew_figure::{Block, Headline, Level, Page, Table, rounded};
use sinew_rope::pretension::{Plan, Schedule};

/// How to bed a rope in, and when to tension it again.
pub fn planned(p: &Plan) -> Page {
    let percent = rounded(100.0 * p.remove_share, 2);
    let headline = match p.chosen.map(|i| &p.procedures[i]) {
        Some(c) => Headline::new(
            Level::Good,
            format!(
                "Hold it at {} N for {}, then tension it anew at {} N: that takes {} % of the later elongation away ({percent} % was asked for).",
                rounded(c.tension_n, 3),
                spoken(c.duration_s),
                rounded(p.tension_n, 3),
                bracketed(c.removed_share.scaled(100.0), 2),
            ),
        ),
        None => Headline::new(
            Level::Watch,
            format!("No procedure tried takes {percent} % of the later elongation away."),
        ),
    };
    let mut first = vec![Block::Headlines(vec![
        Headline::from(format!(
            "At a constant {} N, {} grows by {} mm in {}, counted from a minute after tensioning.{}",
            rounded(p.tension_n, 3),
            p.rope,
            bracketed(p.without_m.scaled(1e3), 2),
            spoken(p.horizon_s),
            guessed(p.starting_guesses, p.parameters)
        )),
        headline,
    ])];
    first.extend(notices(&p.cautions));
    first.push(Block::Figure(
        Box::new(plan_figure(p)),
        "Left: elongation at working tension that is still to come after a bedding-in at the tension and of the length shown. Right: the rope strung at working tension and left at its length, at the catalogue's values; with two ropes, the mean of both.".into(),
    ));
    let rows = p.procedures.iter().enumerate().map(|(i, q)| {
        vec![
            format!("{} N for {}", rounded(q.tension_n, 3), spoken(q.duration_s)),
            bracketed(q.still_to_come_m.scaled(1e3), 2),
            bracketed(q.removed_share.scaled(100.0), 2),
            if p.chosen == Some(i) {
                "✓ the gentlest that does"
            } else {
                ""
            }
            .into(),
        ]
    });
    let head = ["hold at", "still to come, mm", "taken away, %", ""];
    page(
        format!("Pretension and bedding-in of {}", p.rope),
        format!(
            "{} N at {} °C, strand of {} mm, for {}",
            rounded(p.tension_n, 3),
            rounded(p.temperature_c, 3),
            rounded(1e3 * p.length_m, 4),
            spoken(p.horizon_s)
        ),
    )
    .section("", first)
    .section("Bedding-in", vec![Table::new(&head, rows).into()])
    .section(
        "Re-tensioning at constant length",
        vec![
            Block::Paragraph(format!(
                "The rope is strung at {} N, has a minute to settle and is left at the length it then has; {}. It is tensioned again when it has fallen below {} N.",
                rounded(p.tension_n, 3),
                mounting(p),
                rounded(p.lowest_n, 3)
            )),
            schedules(p),
        ],
    )
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

/// Both schedules side by side.
fn schedules(p: &Plan) -> Block {
    let both = [&p.schedule_new, &p.schedule_bedded];
    let row = |what: &str, of: &dyn Fn(&Schedule) -> String| {
        let mut row = vec![what.to_owned()];
        row.extend(both.map(of));
        row
    };
    let times = |s: &Schedule| {
        let all: Vec<String> = s.times_s.iter().take(SHOWN).map(|t| spoken(*t)).collect();
        match s.times_s.len() {
            0 => "never".to_owned(),
            n if n > SHOWN => format!("{} and {} more", all.join(", "), n - SHOWN),
            _ => all.join(", "),
        }
    };
    let start = |s: &Schedule| {
        s.start_n
            .map_or_else(|| "no tension does".into(), |i| bracketed(i, 2))
    };
    let mut rows = vec![
        row("re-tension after", &times),
        row("times", &|s| bracketed(s.count, 2)),
        row("none needed, % of the draws", &|s| {
            format!("{:.0}", 100.0 * s.never_share)
        }),
        row("left alone it ends at, N", &|s| {
            bracketed(s.tension_at_end_n, 2)
        }),
        row("string it at, N, and none is needed", &start),
    ];
    if p.joint.is_some() {
        rows.push(row(&format!("joint sags by, {}", sag_unit(p)), &|s| {
            let sag = s.left_alone.sag_rad.last();
            sag.map_or_else(|| "–".into(), |v| rounded(1e3 * v, 2))
        }));
    }
    Table::new(&["", "as it comes", "bedded in"], rows).into()
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

/// The plan as text for a terminal.
pub fn plan_table(p: &Plan) -> String {
    let mut out = Told::default();
    out.say(format!(
        "{}: {} N at {} °C, strand of {} mm, for {}",
        p.rope,
        rounded(p.tension_n, 3),
        rounded(p.temperature_c, 3),
        rounded(1e3 * p.length_m, 4),
        spoken(p.horizon_s)
    ));
    out.say(format!(
        "at constant tension it grows by {} mm from a minute after tensioning",
        bracketed(p.without_m.scaled(1e3), 2)
    ));
    out.add("\nbedding-in: hold the rope at a tension for a time, then go back\n");
    let head = [
        "",
        "for",
        "hold at\nN",
        "still to come\nmm",
        "taken away\n%",
    ];
    let rows = p
        .procedures
        .iter()
        .enumerate()
        .map(|(i, q)| {
            let mark = if p.chosen == Some(i) { "*" } else { "" };
            vec![
                mark.into(),
                spoken(q.duration_s),
                rounded(q.tension_n, 3),
                bracketed(q.still_to_come_m.scaled(1e3), 2),
                bracketed(q.removed_share.scaled(100.0), 2),
            ]
        })
        .collect();
    out.add(text::table(&head, rows, 2));
    let percent = rounded(100.0 * p.remove_share, 2);
    out.say(match p.chosen {
        Some(i) => format!(
            "* the gentlest that does: {} N for {} takes {percent} % or more away",
            rounded(p.procedures[i].tension_n, 3),
            spoken(p.procedures[i].duration_s)
        ),
        None => format!("none of these takes {percent} % away; the best one is used below"),
    });
    out.add("\n");
    out.say(format!(
        "strung at working tension, a minute to settle, then at constant length; {}; tensioned again at {} N",
        mounting(p),
        rounded(p.lowest_n, 3)
    ));
    for (word, s) in [
        ("as it comes", &p.schedule_new),
        ("bedded in", &p.schedule_bedded),
    ] {
        out.item(schedule_text(word, s, p));
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

/// One schedule as text.
fn schedule_text(word: &str, s: &Schedule, p: &Plan) -> String {
    let mut text = if s.times_s.is_empty() {
        format!("{word}: never to be tensioned again")
    } else {
        let times: Vec<String> = s.times_s.iter().take(SHOWN).map(|t| spoken(*t)).collect();
        let more = s.times_s.len().saturating_sub(SHOWN);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        format!("{word}: tension it again after {}{more}", times.join(", "))
    };
    let (low, high) = (rounded(s.count.low, 2), rounded(s.count.high, 2));
    let times = match s.times_s.len() {
        0 => format!("; 95 %: {low} to {high} times"),
        1 => format!("; once ({low} to {high} times)"),
        n => format!("; {n} times ({low} to {high})"),
    };
    text += &format!(
        "{times} in {}, never in {:.0} % of the draws. Left alone it falls to {} N",
        spoken(p.horizon_s),
        100.0 * s.never_share,
        bracketed(s.tension_at_end_n, 2),
    );
    if let Some(sag) = s.left_alone.sag_rad.last() {
        text += &format!(
            ", the joint {} {} lower",
            rounded(1e3 * sag, 2),
            sag_unit(p)
        );
    }
    match s.start_n {
        Some(start) => {
            text += &format!(
                ". Strung at {} N it never falls below {} N",
                bracketed(start, 3),
                rounded(p.lowest_n, 3)
            );
        }
        None => text += ". No pretension up to 40 % of the breaking load would hold it",
    }
    text
}
