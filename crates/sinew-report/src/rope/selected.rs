//! Selection of a rope as text and HTML report.

use super::choice::figure;
use super::messages::{assumed_note, caution_message};
use super::{bracketed, page, rejection, spoken};
use crate::message::Message;
use crate::text::{self, TerminalText, or_dash, plain};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded};
use sinew_model::Bounded;
use sinew_rope::Caution;
use sinew_rope::predict::YEAR_S;
use sinew_rope::select::{Candidate, Constraints, Rejected, Selection};

const LEGEND: &str = "* Pareto-optimal in diameter, elongation and lifetime. smallest: share of the draws in which its elongation is the smallest. d: diameter. safety: breaking load over the largest tension. life: predicted lifetime, – above 300 years. Order: ropes within the recommended load and bending ratio, ropes outside, ropes that fail within the time in more than 2.5 % of the draws.";

/// Builds the columns of the candidates; a star marks Pareto-optimal ropes.
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
        .column("elongation\n(mm)", |c| {
            bracketed(c.elongation_m.scaled(1e3), 2).replace(" to ", "–")
        })
        .column("smallest", |c| format!("{:.0} %", 100.0 * c.min_share))
        .column("stiffness\n(N/mm)", |c| {
            number(c.stiffness_n_per_m.scaled(1e-3))
        })
        .column("d\n(mm)", |c| thousandfold(c.diameter_m))
        .column("weight\n(g/m)", |c| thousandfold(c.weight_kg_per_m))
        .column("safety", |c| {
            or_dash(c.safety_factor_ratio, |v| rounded(v, 2))
        })
}

/// Lists the specified constraints.
fn constraint_rows(c: &Constraints) -> Vec<(&'static str, String)> {
    let all = [
        ("maximum diameter", c.diameter_max_mm, "mm"),
        ("minimum diameter", c.diameter_min_mm, "mm"),
        ("smallest pulley diameter", c.pulley_diameter_mm, "mm"),
        ("minimum bending ratio D/d", c.bend_ratio_min, ""),
        ("minimum safety factor", c.safety_factor_min, ""),
        (
            "maximum elongation (upper 95 % bound)",
            c.elongation_max_mm,
            "mm",
        ),
        ("minimum stiffness", c.stiffness_min_n_per_mm, "N/mm"),
        ("maximum weight", c.weight_max_g_per_m, "g/m"),
    ];
    let all = all.into_iter();
    let specified =
        |(what, limit, unit): (_, Option<f64>, _)| Some((what, format!("{} {unit}", limit?)));
    all.filter_map(specified).collect()
}

/// Lists the rejected ropes with their reasons.
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

/// Lists the warnings, each once, with the names of the candidates unless it applies to all.
fn cautions(s: &Selection) -> Vec<Message> {
    let mut shared: Vec<(Caution, Vec<&str>)> = Vec::new();
    for c in &s.candidates {
        for caution in &c.cautions {
            match shared.iter_mut().find(|(listed, _)| listed == caution) {
                Some((_, ropes)) => ropes.push(&c.rope),
                None => shared.push((*caution, vec![&c.rope])),
            }
        }
    }
    let format = |(what, ropes): (Caution, Vec<&str>)| {
        let mut message = caution_message(what);
        if ropes.len() != s.candidates.len() {
            message.text = format!("{}: {}", ropes.join(", "), message.text);
        }
        message
    };
    shared.into_iter().map(format).collect()
}

/// Builds the report of a selection.
pub fn selected(s: &Selection, constraints: &Constraints) -> Page {
    let time = spoken(s.time_s);
    let headline = match s.candidates.first() {
        None => Headline::new(Level::Alarm, "No catalogue rope meets every constraint."),
        Some(best) => Headline::from(format!(
            "{}: smallest elongation in {:.0} % of the draws, {} mm in {time} (95 % interval in brackets).{}",
            best.rope,
            100.0 * best.min_share,
            bracketed(best.elongation_m.scaled(1e3), 2),
            assumed_note(best.assumed_parameters, best.parameters)
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
        .column("assumed parameters", |c| {
            format!("{} of {}", c.assumed_parameters, c.parameters)
        })
        .table();
    let facts_or = |rows: Vec<(&str, String)>, none: &str| match rows.is_empty() {
        true => Block::Paragraph(none.into()),
        false => Table::facts(rows).into(),
    };
    let limits = facts_or(constraint_rows(constraints), "No constraints.");
    let rejected = facts_or(rejected(s), "None.");
    let cautions = cautions(s)
        .into_iter()
        .map(|c| Block::Notice(format!("{c}.")));
    page("Rope selection".into(), format!("{}, for {time}", s.duty))
        .section("", first)
        .section(
            "Ropes that meet all constraints",
            vec![table.into(), Block::Paragraph(LEGEND.into())],
        )
        .section("Rejected ropes", vec![rejected])
        .section("Constraints", vec![limits])
        .section("Warnings", cautions.collect())
}

/// Renders a selection for a terminal.
pub fn selection_table(s: &Selection) -> String {
    let mut out = TerminalText::default();
    out.paragraph(format!(
        "{}; elongation from 1 min after pretensioning to {}",
        s.duty,
        spoken(s.time_s)
    ));
    out.add("\n");
    if s.candidates.is_empty() {
        out.add("no rope meets all constraints\n");
    } else {
        let name = |name: String| in_two(&name, text::columns());
        let table = candidates(s, name, |v| rounded(v.value, 2)).column("life\n(years)", |c| {
            or_dash(c.life_s, |l| rounded(l.value / YEAR_S, 2))
        });
        out.table(table.table());
        out.paragraph(LEGEND);
    }
    for c in s.candidates.iter().filter(|c| c.assumed_parameters > 0) {
        let (assumed, all) = (c.assumed_parameters, c.parameters);
        let rope = &c.rope;
        out.item(format!("{rope}: {assumed} of {all} parameters assumed"));
    }
    if !s.rejected.is_empty() {
        out.add("\nrejected ropes\n");
    }
    for (rope, reasons) in rejected(s) {
        out.item(format!("{rope}: {reasons}"));
    }
    let cautions = cautions(s);
    if !cautions.is_empty() {
        out.add("\n");
    }
    for caution in cautions {
        out.item(format!("warning{}", caution.tag()));
    }
    out.0
}

/// Splits a name that is too long for the table at a hyphen.
fn in_two(name: &str, columns: usize) -> String {
    /// Width of the numeric columns.
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
    fn long_name_is_split_at_hyphen() {
        let name = "teufelberger-fl-32-ng *";
        assert_eq!(in_two(name, 100), name);
        assert_eq!(in_two(name, 80), "teufelberger-fl-32-\nng *");
        assert_eq!(in_two(name, 75), "teufelberger-\nfl-32-ng *");
        assert_eq!(in_two("liros", 80), "liros");
    }
}
