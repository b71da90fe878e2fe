//! A choice as a page.

use super::choice::figure;
use super::{bracketed, notices, page, spoken, table};
use sinew_figure::{Block, Page, Table, rounded};
use sinew_rope::select::{Constraints, Selection};

const LEGEND: &str = "Least in: share of the draws in which it stretches least of these. Safety \
    factor: published breaking load over the largest tension. Beaten by none: no rope is thinner \
    and stretches less.";

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
        first.push(Block::Figure(Box::new(figure(s, &time)), String::new()));
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
        "safety factor",
        "beaten by none",
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
    let rows_or = |rows: Vec<Vec<String>>, none: &str| {
        if rows.is_empty() {
            Block::Paragraph(none.into())
        } else {
            Block::Table(Table {
                rows,
                ..Table::default()
            })
        }
    };
    let limits = rows_or(asked(constraints), "No constraint.");
    let fell = rows_or(rejected.collect(), "None.");
    page("Which rope".into(), format!("{}, for {time}", s.duty))
        .section("", first)
        .section(
            "Ropes that meet every constraint",
            vec![
                table(&head, rows.collect()),
                Block::Paragraph(LEGEND.into()),
            ],
        )
        .section("Ropes that fell out, and why", vec![fell])
        .section("What was asked", vec![limits])
        .section("Cautions", notices(&warnings).collect())
}
