//! `sinew rope show`.

use super::{Ropes, find};
use crate::terminal::{Failure, Finish, answer};
use crate::text::{indented, paragraph, plain, table};
use clap::Args;
use sinew_figure::rounded;
use sinew_files::JsonDocument;
use sinew_model::rope::entry::{Uncertainty, Value};
use sinew_rope::CatalogueRope;

/// Everything known about a rope, with origin and uncertainty
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew rope show liros-dc000-0301")]
pub(crate) struct Show {
    /// Rope; `sinew rope list` names them
    name: String,
    #[command(flatten)]
    ropes: Ropes,
    /// Print one JSON document instead of the tables
    #[arg(long, conflicts_with = "toml")]
    json: bool,
    /// Print the catalogue entry, to start your own rope from
    #[arg(long)]
    toml: bool,
}

impl Show {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let catalogue = self.ropes.catalogue()?;
        let rope = find(&catalogue, &self.name)?;
        if self.toml {
            answer(&rope.entry.to_toml())?;
        } else if self.json {
            answer(&rope.describe().to_json()?)?;
        } else {
            answer(&text(rope))?;
        }
        Ok(Finish::Complete)
    }
}

/// Four digits, with a power of ten where a rate or a lifetime needs one.
fn number(v: f64) -> String {
    if v != 0.0 && !(1e-3..1e5).contains(&v.abs()) {
        format!("{v:e}").replace('-', "−")
    } else {
        rounded(v, 4)
    }
}

fn interval(value: &Value) -> String {
    match value.uncertainty {
        Uncertainty::NotStated => "not stated".into(),
        Uncertainty::Factor(f) => format!("times or over {f}"),
        Uncertainty::PlusMinus(d) => format!("± {}", number(d)),
    }
}

fn text(rope: &CatalogueRope) -> String {
    let e = &rope.entry;
    let plait = e.plait.as_ref().map(|p| format!(", {p}"));
    let mut out = paragraph(
        &plain(&format!(
            "{}: {} {}, {} ({}){}",
            e.name,
            e.manufacturer,
            e.product,
            e.fibre,
            e.material.name(),
            plait.unwrap_or_default()
        )),
        2,
    );
    if let Some(note) = &e.note {
        out.push_str(&paragraph(&plain(note), 2));
    }
    let row = |name: &str, value: &Value| {
        let date = value.date.as_ref().map(|d| format!(" {d}"));
        vec![
            name.to_string(),
            plain(&format!(
                "{}{}",
                value.origin.name(),
                date.unwrap_or_default()
            )),
            plain(&value.source),
            number(value.value),
            interval(value),
        ]
    };
    let head = ["", "origin", "source", "value", "95 % interval"];
    let published = [
        ("diameter_mm", &e.diameter_mm),
        ("breaking_load_n", &e.breaking_load_n),
        ("weight_g_per_m", &e.weight_g_per_m),
    ];
    let known = published
        .iter()
        .filter_map(|(name, v)| v.as_ref().map(|v| row(name, v)));
    out.push_str("\npublished\n");
    out.push_str(&table(&head, known.collect(), 3));
    let missing: Vec<&str> = published
        .iter()
        .filter(|(_, v)| v.is_none())
        .map(|(name, _)| *name)
        .collect();
    if !missing.is_empty() {
        out.push_str(&paragraph(
            &format!("not published: {}", missing.join(", ")),
            2,
        ));
    }
    out.push_str("\nlaw\n");
    let law = e.law.iter().map(|(p, v)| row(p.name(), v)).collect();
    out.push_str(&table(&head, law, 3));
    if let Err(missing) = e.parameters() {
        let text = format!(
            "missing, so nothing can be predicted with this rope: {}",
            missing.join(", ")
        );
        out.push_str(&paragraph(&text, 2));
    }
    if let Some(c) = &e.correlation {
        let names: Vec<&str> = c.parameters.iter().map(|p| p.name()).collect();
        let text = format!("errors correlated among {}", names.join(", "));
        out.push_str(&paragraph(&text, 2));
    }
    out.push_str("\nsources\n");
    for (key, source) in &e.sources {
        out.push_str(&indented(&plain(&format!("{key}: {source}")), 2, 4));
    }
    out
}
