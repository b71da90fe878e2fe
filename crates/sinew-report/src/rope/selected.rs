//! A choice as a page.

use super::choice::figure;
use super::words::guessed;
use super::{bracketed, caution, page, rejection, spoken};
use crate::text::{self, Told, or_dash, plain};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded};
use sinew_model::Bounded;
use sinew_rope::Caution;
use sinew_rope::predict::YEAR_S;
use sinew_rope::select::{Candidate, Constraints, Rejected, Selection};

const LEGEND: &str = "* no other rope of known diameter is as thin, stretches as little and lasts as long. least: in how many of the draws it stretches least. N/mm: stiffness. load: breaking load over the largest tension. life: until it breaks, – beyond 300 years. Ropes loaded or bent more than makers advise come after the others; those that break within the time in more than 2.5 % of the draws come last.";

/// The candidates under their names; a star marks those that nothing beats.
fn candidates(
    s: &Selection,
    name: impl Fn(String) -> String,
    number: fn(Bounded) -> String,
) -> Columns<&Candidate> {
    let marked = |c: &&Candidate| {
        let mark = if c.pareto { " *" } else { "" };
        name(plain(&c.rope) + mark)
    };
    let thousandfold = |v: Option<f64>| or_dash(v, |v| rounded(1e3 * v, 3));
    Columns::of(&s.candidates)
        .lines("rope", marked)
        .left()
        .column("elongation\nmm", |c| {
            bracketed(c.elongation_m.scaled(1e3), 2).replace(" to ", "–")
        })
        .column("least", |c| format!("{:.0} %", 100.0 * c.least_share))
        .column("N/mm", |c| number(c.stiffness_n_per_m.scaled(1e-3)))
        .column("d\nmm", |c| thousandfold(c.diameter_m))
        .column("g/m", |c| thousandfold(c.weight_kg_per_m))
        .column("load", |c| {
            or_dash(c.safety_factor_ratio, |v| rounded(v, 2))
        })
}

fn asked(c: &Constraints) -> Vec<(&'static str, String)> {
    let all = [
        ("diameter at most", c.diameter_max_mm, "mm"),
        ("diameter at least", c.diameter_min_mm, "mm"),
        ("smallest pulley", c.pulley_diameter_mm, "mm"),
        ("pulley over rope diameter at least", c.bend_ratio_min, ""),
        (
            "breaking load over largest tension at least",
            c.safety_factor_min,
            "",
        ),
        (
            "elongation at most (upper end of the interval)",
            c.elongation_max_mm,
            "mm",
        ),
        ("stiffness at least", c.stiffness_min_n_per_mm, "N/mm"),
        ("weight at most", c.weight_max_g_per_m, "g/m"),
    ];
    let all = all.into_iter();
    let stated =
        |(what, limit, unit): (_, Option<f64>, _)| Some((what, format!("{} {unit}", limit?)));
    all.filter_map(stated).collect()
}

/// Ropes that fell out, and everything each fails.
fn rejected(s: &Selection) -> Vec<(&str, String)> {
    let reasons = |r: &Rejected| {
        let all: Vec<String> = r.reasons.iter().map(rejection).collect();
        all.join("; ")
    };
    s.rejected
        .iter()
        .map(|r| (r.rope.as_str(), reasons(r)))
        .collect()
}

/// Cautions with the candidates they are for, where they aren't for all: the same for several ropes is one caution.
fn cautions(s: &Selection) -> Vec<String> {
    let mut shared: Vec<(Caution, Vec<&str>)> = Vec::new();
    for c in &s.candidates {
        for caution in &c.cautions {
            match shared.iter_mut().find(|(known, _)| known == caution) {
                Some((_, ropes)) => ropes.push(&c.rope),
                None => shared.push((*caution, vec![&c.rope])),
            }
        }
    }
    let said = |(what, ropes): (Caution, Vec<&str>)| match ropes.len() == s.candidates.len() {
        true => caution(what),
        false => format!("{}: {}", ropes.join(", "), caution(what)),
    };
    shared.into_iter().map(said).collect()
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
    let table = candidates(s, |name| name, |v| bracketed(v, 2))
        .column("life", |c| {
            or_dash(c.life_s, |l| {
                let [value, low, high] = [l.value, l.low, l.high].map(spoken);
                format!("{value} ({low} to {high})")
            })
        })
        .column("guessed parameters", |c| {
            format!("{} of {}", c.starting_guesses, c.parameters)
        })
        .table();
    let facts_or = |rows: Vec<(&str, String)>, none: &str| match rows.is_empty() {
        true => Block::Paragraph(none.into()),
        false => Table::facts(rows).into(),
    };
    let limits = facts_or(asked(constraints), "No constraint.");
    let fell = facts_or(rejected(s), "None.");
    let cautions = cautions(s).into_iter().map(|c| Block::Notice(c + "."));
    page("Which rope".into(), format!("{}, for {time}", s.duty))
        .section("", first)
        .section(
            "Ropes that meet every constraint",
            vec![table.into(), Block::Paragraph(LEGEND.into())],
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
    if s.candidates.is_empty() {
        out.add("no rope meets every constraint\n");
    } else {
        let name = |name: String| in_two(&name, text::columns());
        let table = candidates(s, name, |v| rounded(v.value, 2)).column("life\nyears", |c| {
            or_dash(c.life_s, |l| rounded(l.value / YEAR_S, 2))
        });
        out.table(table.table());
        out.say(LEGEND);
    }
    for c in s.candidates.iter().filter(|c| c.starting_guesses > 0) {
        let (guesses, all) = (c.starting_guesses, c.parameters);
        let rope = &c.rope;
        out.item(format!(
            "{rope}: {guesses} of {all} parameters are starting guesses"
        ));
    }
    if !s.rejected.is_empty() {
        out.add("\nfell out\n");
    }
    for (rope, reasons) in rejected(s) {
        out.item(format!("{rope}: {reasons}"));
    }
    let cautions = cautions(s);
    if !cautions.is_empty() {
        out.add("\n");
    }
    for caution in cautions {
        out.item(format!("warning: {caution}"));
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
