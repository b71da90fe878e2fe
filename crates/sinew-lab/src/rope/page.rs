//! Predictions, choices and plans as HTML pages.

use super::draws::Interval;
use super::predict::{DAY_S, HOUR_S, MONTH_S, Prediction, YEAR_S};
use super::pretension::{Plan, Schedule};
use super::select::{Constraints, Selection};
use crate::plot::{Band, Colour, Dash, Figure, Line, Panel};
use crate::report::{Block, Page, Table, rounded};

/// A duration as a person says it.
pub fn spoken(s: f64) -> String {
    let whole = |v: f64, unit: &str| {
        let rounded = (10.0 * v).round() / 10.0;
        // Abbreviations have no plural.
        let plural = if rounded == 1.0 || ["s", "min", "h"].contains(&unit) {
            ""
        } else {
            "s"
        };
        format!("{rounded} {unit}{plural}")
    };
    if s < 90.0 {
        whole(s, "s")
    } else if s < 0.99 * HOUR_S {
        whole(s / 60.0, "min")
    } else if s < 0.99 * DAY_S {
        whole(s / HOUR_S, "h")
    } else if s < 0.99 * MONTH_S {
        whole(s / DAY_S, "day")
    } else if s < 0.99 * YEAR_S {
        whole(s / MONTH_S, "month")
    } else {
        whole(s / YEAR_S, "year")
    }
}

/// `0.42 (0.31 to 0.58)`
pub fn bracketed(i: Interval, digits: u8) -> String {
    format!(
        "{} ({} to {})",
        rounded(i.value, digits),
        rounded(i.low, digits),
        rounded(i.high, digits)
    )
}

fn table(head: &[&str], rows: Vec<Vec<String>>) -> Block {
    Block::Table(Table {
        head: head.iter().map(|h| (*h).to_owned()).collect(),
        rows,
        ..Table::default()
    })
}

fn facts<const N: usize>(rows: [(&str, String); N]) -> Block {
    let rows = rows.into_iter().map(|(k, v)| vec![k.to_owned(), v]);
    Block::Table(Table {
        rows: rows.collect(),
        ..Table::default()
    })
}

fn notices(warnings: &[String]) -> impl Iterator<Item = Block> + '_ {
    warnings.iter().map(|w| Block::Notice(format!("{w}.")))
}

fn page(title: String, subtitle: String) -> Page {
    Page {
        subtitle,
        footer: format!("Sinew {}", env!("CARGO_PKG_VERSION")),
        ..Page::new(title)
    }
}

/// Powers of ten of an hour: the axis of what goes with the logarithm of time.
const LOG_HOURS: &str = "log_{10} of the time in hours";

fn log_hours(time_s: f64) -> f64 {
    (time_s / HOUR_S).log10()
}

/// How far a rope will stretch.
pub fn predicted(p: &Prediction) -> Page {
    let mut first = Vec::new();
    if let Some(last) = p.readings.last() {
        first.push(Block::Headlines(vec![format!(
            "{} after {}: {} mm longer than a minute after tensioning (95 % interval in brackets).",
            p.rope,
            spoken(last.time_s),
            bracketed(last.since_tensioned_mm, 2)
        )]));
    }
    first.extend(notices(&p.warnings));
    if p.readings.len() > 1 {
        let x: Vec<f64> = p.readings.iter().map(|r| log_hours(r.time_s)).collect();
        let of = |f: &dyn Fn(&Interval) -> f64| -> Vec<f64> {
            let all = p.readings.iter().map(|r| &r.since_tensioned_mm);
            all.map(f).collect()
        };
        let mut panel = Panel::new("", LOG_HOURS, "elongation since tensioned (mm)")
            .band(Band::new(
                "95 % of the draws",
                x.clone(),
                of(&|i| i.low),
                of(&|i| i.high),
            ))
            .line(Line::new("catalogue's values", x.clone(), of(&|i| i.value)));
        for (r, x) in p.readings.iter().zip(x) {
            panel = panel.note(x, r.since_tensioned_mm.value, spoken(r.time_s));
        }
        let figure = Figure::new("").size(820.0, 360.0).panel(panel);
        first.push(Block::Figure(Box::new(figure), String::new()));
    }
    let rows = p.readings.iter().map(|r| {
        vec![
            spoken(r.time_s),
            bracketed(r.since_tensioned_mm, 2),
            bracketed(r.elongation_mm, 2),
            bracketed(r.strain_percent, 2),
            bracketed(r.irreversible_mm, 2),
        ]
    });
    let head = [
        "after",
        "since tensioned, mm",
        "from new and slack, mm",
        "from new and slack, %",
        "of that unloading leaves, mm",
    ];
    let s = &p.summary;
    let mut basis = vec![facts([
        ("duty", p.duty.clone()),
        ("one cycle", spoken(s.duration_s)),
        (
            "tension",
            format!(
                "{} to {} N, mean {} N",
                rounded(s.tension_min_n, 3),
                rounded(s.tension_max_n, 3),
                rounded(s.tension_mean_n, 3)
            ),
        ),
        (
            "temperature",
            format!(
                "{} to {} °C, mean {} °C",
                rounded(s.temperature_min_c, 3),
                rounded(s.temperature_max_c, 3),
                rounded(s.temperature_mean_c, 3)
            ),
        ),
        ("strand", format!("{} mm", rounded(p.length_mm, 4))),
        (
            "read at",
            format!(
                "{} N, {} °C",
                rounded(p.read_at_n, 3),
                rounded(p.read_at_c, 3)
            ),
        ),
        (
            "parameters",
            format!(
                "{} of {} are starting guesses; {} draws (seed {})",
                p.starting_guesses, p.parameters, p.draws, p.seed
            ),
        ),
        (
            "strength left after bending",
            p.strength_left.map_or_else(
                || "not asked for".into(),
                |i| format!("{} % of new", bracketed(i.scaled(100.0), 2)),
            ),
        ),
    ])];
    if p.broken_share > 0.0 {
        basis.push(Block::Notice(format!(
            "The rope breaks in {} % of the draws, which are left out above.",
            rounded(100.0 * p.broken_share, 2)
        )));
    }
    page(format!("Elongation of {}", p.rope), p.duty.clone())
        .section("", first)
        .section("Readings", vec![table(&head, rows.collect())])
        .section("What it rests on", basis)
}

fn asked(c: &Constraints) -> Vec<Vec<String>> {
    let row = |what: &str, limit: Option<f64>, unit: &str| {
        limit.map(|v| vec![what.to_owned(), format!("{v} {unit}")])
    };
    [
        row("diameter at most", c.diameter_max_mm, "mm"),
        row("diameter at least", c.diameter_min_mm, "mm"),
        row("smallest pulley", c.pulley_diameter_mm, "mm"),
        row("pulley over rope diameter at least", c.bend_ratio_min, ""),
        row(
            "breaking load over largest tension at least",
            c.safety_factor_min,
            "",
        ),
        row(
            "elongation at most (upper end of the interval)",
            c.elongation_max_mm,
            "mm",
        ),
        row("stiffness at least", c.stiffness_min_n_per_mm, "N/mm"),
        row("weight at most", c.weight_max_g_per_m, "g/m"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Which rope to take.
pub fn selected(s: &Selection, constraints: &Constraints) -> Page {
    let time = spoken(s.time_s);
    let headline = match s.candidates.first() {
        None => "No rope of the catalogue meets every constraint.".to_owned(),
        Some(best) => format!(
            "{} stretches least: {} mm in {time} (95 % interval in brackets), and least of all in {:.0} % of the draws.",
            best.rope,
            bracketed(best.elongation_mm, 2),
            100.0 * best.least_share
        ),
    };
    let mut first = vec![Block::Headlines(vec![headline])];
    if !s.candidates.is_empty() {
        first.push(Block::Figure(Box::new(s.figure(&time)), String::new()));
    }
    let none = || "–".to_owned();
    let optional = |v: Option<f64>| v.map_or_else(none, |v| rounded(v, 3));
    let rows = s.candidates.iter().map(|c| {
        vec![
            c.rope.clone(),
            bracketed(c.elongation_mm, 2),
            format!("{:.0} %", 100.0 * c.least_share),
            bracketed(c.stiffness_n_per_mm, 2),
            optional(c.diameter_mm),
            optional(c.weight_g_per_m),
            optional(c.safety_factor),
            if c.pareto { "yes" } else { "no" }.into(),
        ]
    });
    let head = [
        "rope",
        "elongation, mm",
        "least in",
        "stiffness, N/mm",
        "diameter, mm",
        "weight, g/m",
        "breaking load over tension",
        "nothing is thinner and stretches less",
    ];
    let rejected = s
        .rejected
        .iter()
        .map(|r| vec![r.rope.clone(), r.reasons.join("; ")]);
    let mut warnings: Vec<String> = Vec::new();
    for c in &s.candidates {
        for w in &c.warnings {
            let text = format!("{}: {w}", c.rope);
            match warnings.iter_mut().find(|held| held.ends_with(w.as_str())) {
                // The same caution for several ropes is one caution.
                Some(held) => *held = format!("{}, {held}", c.rope),
                None => warnings.push(text),
            }
        }
    }
    let limits = Block::Table(Table {
        rows: asked(constraints),
        ..Table::default()
    });
    let fell = Block::Table(Table {
        rows: rejected.collect(),
        ..Table::default()
    });
    page("Which rope".into(), format!("{}, for {time}", s.duty))
        .section("", first)
        .section(
            "Ropes that meet every constraint",
            vec![table(&head, rows.collect())],
        )
        .section("Ropes that fell out, and why", vec![fell])
        .section("What was asked", vec![limits])
        .section("Cautions", notices(&warnings).collect())
}

/// How to bed a rope in, and when to tension it again.
pub fn planned(p: &Plan, remove: f64) -> Page {
    let percent = rounded(100.0 * remove, 2);
    let headline = match p.chosen.map(|i| &p.procedures[i]) {
        Some(c) => format!(
            "Hold it at {} N for {}, then go to {} N: that takes {} % of the later elongation away ({} % was asked for).",
            rounded(c.tension_n, 3),
            spoken(c.duration_s),
            rounded(p.tension_n, 3),
            bracketed(c.removed.scaled(100.0), 2),
            percent
        ),
        None => format!("No procedure tried takes {percent} % of the later elongation away."),
    };
    let mut first = vec![Block::Headlines(vec![
        format!(
            "At a constant {} N, {} grows by {} mm in {}, counted from a minute after tensioning.",
            rounded(p.tension_n, 3),
            p.rope,
            bracketed(p.without_mm, 2),
            spoken(p.horizon_s)
        ),
        headline,
    ])];
    first.extend(notices(&p.warnings));
    first.push(Block::Figure(
        Box::new(plan_figure(p)),
        "Left: elongation at working tension that is still to come after a bedding-in at the tension and of the length shown. Right: the rope strung at working tension and left at its length, at the catalogue's values.".into(),
    ));
    let rows = p.procedures.iter().enumerate().map(|(i, q)| {
        vec![
            format!("{} N for {}", rounded(q.tension_n, 3), spoken(q.duration_s)),
            bracketed(q.still_to_come_mm, 2),
            bracketed(q.removed.scaled(100.0), 2),
            if p.chosen == Some(i) { "taken" } else { "" }.into(),
        ]
    });
    let head = ["hold at", "still to come, mm", "taken away, %", ""];
    let head_schedule = [
        "",
        "re-tension after",
        "times",
        "none needed in",
        "ends at, left alone, N",
        "string at, to need none, N",
    ];
    let schedules = vec![
        schedule_row("as it comes", &p.schedule_new),
        schedule_row("bedded in", &p.schedule_bedded),
    ];
    page(
        format!("Pretension and bedding-in of {}", p.rope),
        format!(
            "{} N at {} °C, strand of {} mm, for {}",
            rounded(p.tension_n, 3),
            rounded(p.temperature_c, 3),
            rounded(p.length_mm, 4),
            spoken(p.horizon_s)
        ),
    )
    .section("", first)
    .section("Bedding-in", vec![table(&head, rows.collect())])
    .section(
        "Re-tensioning at constant length",
        vec![
            Block::Paragraph(format!(
                "The rope is strung at {} N, has a minute to settle and is left at the length it then has; nothing else in the machine gives. It is tensioned again when it has fallen below {} N.",
                rounded(p.tension_n, 3),
                rounded(p.lowest_n, 3)
            )),
            table(&head_schedule, schedules),
        ],
    )
}

fn schedule_row(word: &str, s: &Schedule) -> Vec<String> {
    let times: Vec<String> = s.times_s.iter().map(|t| spoken(*t)).collect();
    vec![
        word.into(),
        if times.is_empty() {
            "never".into()
        } else {
            times.join(", ")
        },
        bracketed(s.count, 2),
        format!("{:.0} %", 100.0 * s.never_share),
        bracketed(s.tension_at_end_n, 2),
        s.start_n
            .map_or_else(|| "none does".into(), |i| bracketed(i, 2)),
    ]
}

fn plan_figure(p: &Plan) -> Figure {
    let mut bedding = Panel::new("", LOG_HOURS, "still to come (mm)");
    let mut tensions: Vec<f64> = p.procedures.iter().map(|q| q.tension_n).collect();
    tensions.dedup();
    for (n, colour) in tensions.iter().zip(Colour::CYCLE) {
        let (x, y) = p
            .procedures
            .iter()
            .filter(|q| q.tension_n == *n)
            .map(|q| (log_hours(q.duration_s), q.still_to_come_mm.value))
            .unzip();
        let line = Line::new(format!("{} N", rounded(*n, 3)), x, y).colour(colour);
        bedding = bedding.line(line);
    }
    let mut strung = Panel::new("", LOG_HOURS, "tension (N)").reference(p.lowest_n, "lowest");
    for (word, s, colour) in [
        ("as it comes", &p.schedule_new, Colour::Orange),
        ("bedded in", &p.schedule_bedded, Colour::Blue),
    ] {
        let x = s.left_alone.time_s.iter().map(|t| log_hours(*t)).collect();
        let line = Line::new(word, x, s.left_alone.tension_n.clone());
        strung = strung.line(line.colour(colour).dash(Dash::Solid));
    }
    Figure::new("")
        .size(960.0, 360.0)
        .columns(2)
        .panel(bedding)
        .panel(strung)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rope::predict::{Request, Route, TIMES_DEFAULT_S, predict};
    use crate::rope::{Catalogue, Duty, pretension, select};

    fn request() -> Request {
        Request {
            duty: Duty::constant(60.0, 23.0),
            route: Route::straight(0.7),
            times_s: TIMES_DEFAULT_S.to_vec(),
            read_at: None,
            draws: 20,
            seed: 1,
        }
    }

    #[test]
    fn pages_say_what_the_tables_say() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let p = predict(rope, &request()).expect("a prediction");
        let text = predicted(&p).html();
        let last = p.readings.last().expect("readings").since_tensioned_mm;
        for words in [
            bracketed(last, 2).as_str(),
            "after 1 year",
            "<svg",
            "starting guesses",
        ] {
            assert!(text.contains(words), "{words}");
        }
        let limits = Constraints {
            diameter_max_mm: Some(1.9),
            ..Constraints::default()
        };
        let s = select::select(&catalogue, &request(), &limits).expect("a choice");
        let text = selected(&s, &limits).html();
        for words in [
            "diameter at most",
            "1.9 mm",
            "diameter 2.00 mm is above 1.9 mm",
            "<svg",
        ] {
            assert!(text.contains(words), "{words}");
        }
        let asked = pretension::Request {
            tension_n: 60.0,
            temperature_c: 23.0,
            length_m: 0.7,
            horizon_s: YEAR_S,
            lowest_n: 48.0,
            remove: 0.8,
            draws: 20,
            seed: 1,
        };
        let plan = pretension::plan(rope, &asked).expect("a plan");
        let text = planned(&plan, 0.8).html();
        for words in [
            "Hold it at 60.0 N for 1 h",
            "as it comes",
            "bedded in",
            "<svg",
        ] {
            assert!(text.contains(words), "{words}");
        }
    }
}
