//! Selection of a rope as text and HTML report.

use super::choice::figure;
use super::messages::{
    assumed_note, caution_message, possible_violation, rejection_parts, shared_caution,
};
use super::{bracketed, life, page, rejection, share_of_draws, spoken};
use crate::message::Message;
use crate::text::{self, TerminalText, or_dash, plain};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded};
use sinew_model::Bounded;
use sinew_rope::Caution;
use sinew_rope::life::LIFE_MOST_S;
use sinew_rope::predict::YEAR_S;
use sinew_rope::select::{Candidate, Constraints, MAY_BREAK_SHARE, Rank, Rejected, Selection};

/// Rows of the table in a terminal: with its legend and a line per reason they fill one screen.
const ROWS: usize = 12;
/// Names in a line of a terminal.
const NAMES: usize = 6;

const LEGEND: &str = "* Pareto-optimal in diameter, change and lifetime. change: magnitude of the elongation that 95 % of the draws do not exceed. least: share of the draws in which it changes least. d: diameter. safety: breaking load over the largest tension. life: predicted lifetime, – above 300 years. Order: within the recommended load and bending ratio, outside, possible violations of a constraint, failures within the time in more than 2.5 % of the draws; each by change.";

/// Width from which a terminal shows all columns of the candidates.
const MIN_WIDTH_ALL_COLUMNS: usize = 100;

/// Builds the columns of the first candidates; a star marks Pareto-optimal ropes.
///
/// * `all`: whether to include those that a narrow terminal has no room for.
fn candidates(
    candidates: &[Candidate],
    all: bool,
    name: impl Fn(String) -> String,
    number: fn(Bounded) -> String,
) -> Columns<&Candidate> {
    let marked = |c: &&Candidate| {
        let mark = if c.pareto { " *" } else { "" };
        name(plain(&c.rope) + mark)
    };
    let table = Columns::of(candidates)
        .lines("rope", marked)
        .left()
        .column("elongation\n(mm)", |c| {
            bracketed(c.elongation_m.scaled(1e3), 2).replace(" to ", "–")
        })
        .column("change\n(mm)", |c| rounded(1e3 * c.change_m, 2));
    let table = match all {
        true => table.column("least", |c| share_of_draws(c.min_share)),
        false => table,
    };
    let table = table.column("stiffness\n(N/mm)", |c| {
        number(c.stiffness_n_per_m.scaled(1e-3))
    });
    let table = match all {
        true => table.column("d\n(mm)", |c| {
            or_dash(c.diameter_m, |v| rounded(1e3 * v, 3))
        }),
        false => table,
    };
    table.column("safety", |c| {
        or_dash(c.safety_factor_ratio, |v| rounded(v, 2))
    })
}

/// Names of ropes by what they have in common.
#[derive(Debug, Default)]
struct Groups(Vec<(String, Vec<String>)>);

impl Groups {
    fn add(&mut self, what: String, rope: &str, value: Option<String>) {
        let rope = match value {
            Some(value) => format!("{rope} ({value})"),
            None => rope.to_owned(),
        };
        match self.0.iter_mut().find(|(listed, _)| *listed == what) {
            Some((_, ropes)) => ropes.push(rope),
            None => self.0.push((what, vec![rope])),
        }
    }

    /// One line per group.
    fn lines(self) -> impl Iterator<Item = String> {
        let line = |(what, ropes): (String, Vec<String>)| format!("{what}: {}", names(&ropes));
        self.0.into_iter().map(line)
    }
}

/// Lists the first names and the number of the others.
fn names(ropes: &[impl AsRef<str>]) -> String {
    let shown: Vec<&str> = ropes.iter().take(NAMES).map(AsRef::as_ref).collect();
    match ropes.len().saturating_sub(NAMES) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// Groups what candidates may violate, and possible failures.
fn possible(s: &Selection) -> Groups {
    let mut groups = Groups::default();
    for c in &s.candidates {
        if c.broken_share > MAY_BREAK_SHARE {
            let what = format!("may fail within {}", spoken(s.time_s));
            groups.add(what, &c.rope, Some(share_of_draws(c.broken_share)));
        }
        for violation in &c.possible_violations {
            let (what, share) = possible_violation(violation);
            groups.add(what, &c.rope, Some(share));
        }
    }
    groups
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
            "maximum elongation or shortening",
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

/// Lists the warnings, each kind once, with the names of the candidates unless it applies to all.
fn cautions(s: &Selection) -> Vec<Message> {
    let mut shared: Vec<(Message, Caution, Vec<&str>)> = Vec::new();
    for c in &s.candidates {
        for caution in &c.cautions {
            let message = caution_message(*caution);
            match shared.iter_mut().find(|(m, ..)| m.code == message.code) {
                Some((listed, first, ropes)) => {
                    if *first != *caution {
                        listed.text = shared_caution(*first);
                    }
                    ropes.push(&c.rope);
                }
                None => shared.push((message, *caution, vec![&c.rope])),
            }
        }
    }
    let format = |(mut message, _, ropes): (Message, Caution, Vec<&str>)| {
        if ropes.len() != s.candidates.len() {
            message.text = format!("{}: {}", names(&ropes), message.text);
        }
        message
    };
    shared.into_iter().map(format).collect()
}

/// States the first rope of a selection.
fn headline(s: &Selection) -> Headline {
    let time = spoken(s.time_s);
    let Some(best) = s.candidates.first() else {
        return Headline::new(Level::Alarm, "No catalogue rope meets every constraint.");
    };
    let text = format!(
        "{}: length changes by at most {} mm in {time} in 95 % of the draws; elongation {} mm (95 % interval in brackets).{}",
        best.rope,
        rounded(1e3 * best.change_m, 2),
        bracketed(best.elongation_m.scaled(1e3), 2),
        assumed_note(best.assumed_parameters, best.parameters)
    );
    match best.rank() {
        Rank::Sound | Rank::BeyondAdvice => text.into(),
        Rank::MayViolate | Rank::MayBreak => {
            Headline::new(Level::Watch, format!("{NO_ROPE_MEETS_ALL}. {text}"))
        }
    }
}

const NO_ROPE_MEETS_ALL: &str =
    "No rope lasts and meets every constraint with a probability of at least 97.5 %";

/// Builds the report of a selection.
pub fn selected(s: &Selection, constraints: &Constraints) -> Page {
    let time = spoken(s.time_s);
    let mut first = vec![Block::Headlines(vec![headline(s)])];
    if !s.candidates.is_empty() {
        first.push(Block::Figure(Box::new(figure(s, &time)), String::new()));
    }
    let table = candidates(&s.candidates, true, |name| name, |v| bracketed(v, 2))
        .column("weight\n(g/m)", |c| {
            or_dash(c.weight_kg_per_m, |v| rounded(1e3 * v, 3))
        })
        .column("life", |c| {
            or_dash(c.life_s, |l| {
                let [value, low, high] = [l.value, l.low, l.high].map(life::limited);
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
    let mut listed: Vec<Block> = vec![table.into(), Block::Paragraph(LEGEND.into())];
    let possible = possible(s).lines();
    listed.extend(possible.map(|line| Block::Notice(crate::text::sentence(&line))));
    page("Rope selection".into(), format!("{}, for {time}", s.duty))
        .section("", first)
        .section("Candidates", listed)
        .section("Rejected ropes", vec![rejected])
        .section("Constraints", vec![limits])
        .section("Warnings", cautions.collect())
}

/// Renders a selection for a terminal, in about one screen.
pub fn selection_table(s: &Selection) -> String {
    let mut out = TerminalText::default();
    out.paragraph(format!(
        "{}; elongation from 1 min after pretensioning to {}",
        s.duty,
        spoken(s.time_s)
    ));
    out.add("\n");
    match s.candidates.first().map(Candidate::rank) {
        None => out.add("no rope meets all constraints\n"),
        Some(Rank::MayViolate | Rank::MayBreak) => out.flat(NO_ROPE_MEETS_ALL),
        Some(Rank::Sound | Rank::BeyondAdvice) => {}
    }
    let shown = &s.candidates[..s.candidates.len().min(ROWS)];
    if !shown.is_empty() {
        let all = text::columns() >= MIN_WIDTH_ALL_COLUMNS;
        let name = |name: String| in_two(&name, text::columns(), all);
        let table =
            candidates(shown, all, name, |v| rounded(v.value, 2)).column("life\n(years)", |c| {
                or_dash(c.life_s, |l| match l.value < LIFE_MOST_S {
                    true => rounded(l.value / YEAR_S, 2),
                    false => "> 300".into(),
                })
            });
        out.table(table.table());
        match s.candidates.len() - shown.len() {
            0 => {}
            more => out.item(format!("{more} more: --report or --json")),
        }
        out.paragraph(LEGEND);
    }
    let mut assumed = Groups::default();
    for c in s.candidates.iter().filter(|c| c.assumed_parameters > 0) {
        let what = format!("of {} parameters assumed", c.parameters);
        assumed.add(what, &c.rope, Some(c.assumed_parameters.to_string()));
    }
    for line in possible(s).lines().chain(assumed.lines()) {
        out.item(line);
    }
    if !s.rejected.is_empty() {
        out.add("\nrejected ropes\n");
    }
    let mut rejected = Groups::default();
    for r in &s.rejected {
        for reason in &r.reasons {
            let (what, value) = rejection_parts(reason);
            rejected.add(what, &r.rope, value);
        }
    }
    for line in rejected.lines() {
        out.item(line);
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
fn in_two(name: &str, columns: usize, all: bool) -> String {
    // Width of the numeric columns with their gaps.
    let numbers = if all { 73 } else { 58 };
    let room = columns.saturating_sub(numbers).max(13);
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
        assert_eq!(in_two(name, 100, true), name);
        assert_eq!(in_two(name, 80, false), "teufelberger-fl-32-\nng *");
        assert_eq!(in_two(name, 70, false), "teufelberger-\nfl-32-ng *");
        assert_eq!(in_two("liros", 80, false), "liros");
    }
}
