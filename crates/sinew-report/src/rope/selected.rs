//! A choice as a page.

use super::choice::figure;
use super::words::guessed;
use super::{bracketed, caution, page, rejection, spoken};
use crate::text::{self, Told, plain};
use sinew_figure::{Block, Headline, Level, Page, Table, rounded};
use sinew_rope::Caution;
use sinew_rope::predict::YEAR_S;
use sinew_rope::select::{Constraints, Rejected, Selection};

const LEGEND: &str = "Least in: share of the draws in which it stretches least of these. Safety \
    factor: published breaking load over the largest tension. Beaten by none: no rope of known \
    diameter is as thin, stretches as little and lasts as long, by the values before the brackets. \
    Breaks after: – beyond 300 years. Ropes that are loaded or bent more than makers advise come after \
    the others; those that break within the time in more than 2.5 % of the draws come last.";

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

/// Everything a rope fails, in one line.
fn reasons(r: &Rejected) -> String {
    let all: Vec<String> = r.reasons.iter().map(rejection).collect();
    all.join("; ")
}

/// Cautions with the candidates they are for: the same for several ropes is one caution.
fn shared_cautions(s: &Selection) -> Vec<(Caution, Vec<&str>)> {
    let mut shared: Vec<(Caution, Vec<&str>)> = Vec::new();
    for c in &s.candidates {
        for caution in &c.cautions {
            match shared.iter_mut().find(|(known, _)| known == caution) {
                Some((_, ropes)) => ropes.push(&c.rope),
                None => shared.push((*caution, vec![&c.rope])),
            }
        }
    }
    shared
}

/// Which rope to take.
pub fn selected(s: &Selection, constraints: &Constraints) -> Page {
    let time = spoken(s.time_s);
    let headline = match s.candidates.first() {
        None => Headline::new(
            Level::Alarm,
            "No rope of the catalogue meets every constraint.",
        ),
        Some(best) => Headline::from(format!(
            "{} stretches least in {:.0} % of the draws: {} mm in {time} (95 % interval in brackets).{}",
            best.rope,
            100.0 * best.least_share,
            bracketed(best.elongation_m.scaled(1e3), 2),
            guessed(best.starting_guesses, best.parameters)
        )),
    };
    let mut first = vec![Block::Headlines(vec![headline])];
    if !s.candidates.is_empty() {
        first.push(Block::Figure(Box::new(figure(s, &time)), String::new()));
    }
    let none = || "–".to_owned();
    let optional = |v: Option<f64>| v.map_or_else(none, |v| rounded(v, 3));
    let rows = s.candidates.iter().map(|c| {
        vec![
            c.rope.clone(),
            bracketed(c.elongation_m.scaled(1e3), 2),
            format!("{:.0} %", 100.0 * c.least_share),
            bracketed(c.stiffness_n_per_m.scaled(1e-3), 2),
            optional(c.diameter_m.map(|m| 1e3 * m)),
            optional(c.weight_kg_per_m.map(|kg| 1e3 * kg)),
            optional(c.safety_factor_ratio),
            c.life_s.map_or_else(none, |l| {
                format!(
                    "{} ({} to {})",
                    spoken(l.value),
                    spoken(l.low),
                    spoken(l.high)
                )
            }),
            if c.pareto { "yes" } else { "no" }.into(),
            format!("{} of {}", c.starting_guesses, c.parameters),
        ]
    });
    let head = [
        "rope",
        "elongation, mm",
        "least in",
        "stiffness, N/mm",
        "diameter, mm",
        "weight, g/m",
        "safety factor",
        "breaks after",
        "beaten by none",
        "guessed parameters",
    ];
    let rejected = s.rejected.iter().map(|r| vec![r.rope.clone(), reasons(r)]);
    let cautions = shared_cautions(s).into_iter().map(|(what, mut ropes)| {
        ropes.reverse();
        Block::Notice(format!("{}: {}.", ropes.join(", "), caution(what)))
    });
    let rows_or = |rows: Vec<Vec<String>>, none: &str| {
        if rows.is_empty() {
            Block::Paragraph(none.into())
        } else {
            Block::Table(Table::new(&[], rows))
        }
    };
    let limits = rows_or(asked(constraints), "No constraint.");
    let fell = rows_or(rejected.collect(), "None.");
    page("Which rope".into(), format!("{}, for {time}", s.duty))
        .section("", first)
        .section(
            "Ropes that meet every constraint",
            vec![
                Table::new(&head, rows).into(),
                Block::Paragraph(LEGEND.into()),
            ],
        )
        .section("Ropes that fell out, and why", vec![fell])
        .section("What was asked", vec![limits])
        .section("Cautions", cautions.collect())
}

/// The choice as text for a terminal.
pub fn selection_table(s: &Selection) -> String {
    let mut out = Told::default();
    out.say(format!(
        "{}; elongation from a minute after tensioning to {}",
        s.duty,
        spoken(s.time_s)
    ));
    out.add("\n");
    let none = || "–".to_string();
    let head = [
        "rope",
        "elongation\nmm",
        "least",
        "N/mm",
        "d\nmm",
        "g/m",
        "load",
        "life\nyears",
    ];
    let rows = s
        .candidates
        .iter()
        .map(|c| {
            let mark = if c.pareto { " *" } else { "" };
            vec![
                in_two(&(plain(&c.rope) + mark), text::columns()),
                bracketed(c.elongation_m.scaled(1e3), 2).replace(" to ", "–"),
                format!("{:.0} %", 100.0 * c.least_share),
                rounded(1e-3 * c.stiffness_n_per_m.value, 2),
                c.diameter_m.map_or_else(none, |v| rounded(1e3 * v, 3)),
                c.weight_kg_per_m.map_or_else(none, |v| rounded(1e3 * v, 3)),
                c.safety_factor_ratio.map_or_else(none, |v| rounded(v, 2)),
                c.life_s.map_or_else(none, |l| rounded(l.value / YEAR_S, 2)),
            ]
        })
        .collect();
    if s.candidates.is_empty() {
        out.add("no rope meets every constraint\n");
    } else {
        out.add(text::table(&head, rows, 1));
        out.say(
            "* no other rope of known diameter is as thin, stretches as little and lasts as long. least: in how \
             many of the draws it stretches least. N/mm: stiffness. load: breaking load over the largest \
             tension. life: until it breaks, – beyond 300 years. Ropes loaded or bent more than makers advise \
             come after the others; those that break within the time in more than 2.5 % of the draws come last.",
        );
    }
    for c in &s.candidates {
        if c.starting_guesses > 0 {
            let (guesses, all) = (c.starting_guesses, c.parameters);
            out.item(format!(
                "{}: {guesses} of {all} parameters are starting guesses",
                c.rope
            ));
        }
    }
    if !s.rejected.is_empty() {
        out.add("\nfell out\n");
        for r in &s.rejected {
            out.item(format!("{}: {}", r.rope, reasons(r)));
        }
    }
    let warnings = shared_cautions(s);
    if !warnings.is_empty() {
        out.add("\n");
    }
    for (what, ropes) in warnings {
        let text = caution(what);
        let text = if ropes.len() == s.candidates.len() {
            format!("warning: {text}")
        } else {
            format!("warning: {}: {text}", ropes.join(", "))
        };
        out.item(text);
    }
    out.0
}

/// A name that is longer than the numbers leave of so many columns on two lines, cut at a hyphen.
fn in_two(name: &str, columns: usize) -> String {
    /// What the numbers take.
    const NUMBERS: usize = 61;
    let room = columns.saturating_sub(NUMBERS).max(13);
    let cut = name
        .char_indices()
        .filter(|(_, c)| *c == '-')
        .map(|(at, _)| at + 1)
        .rfind(|at| name[..*at].chars().count() <= room);
    match cut {
        Some(at) if name.chars().count() > room => format!("{}\n{}", &name[..at], &name[at..]),
        _ => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::in_two;

    #[test]
    fn a_name_is_cut_at_a_hyphen_where_there_is_no_room() {
        let name = "teufelberger-fl-32-ng *";
        assert_eq!(in_two(name, 100), name);
        assert_eq!(in_two(name, 80), "teufelberger-fl-32-\nng *");
        assert_eq!(in_two(name, 75), "teufelberger-\nfl-32-ng *");
        assert_eq!(in_two("liros", 80), "liros");
    }
}
