//! `sinew rope list`.

use super::Ropes;
use crate::terminal::{Failure, Finish, answer};
use crate::text::{paragraph, plain, table};
use clap::Args;
use sinew_figure::rounded;
use sinew_model::rope::entry::Value;
use sinew_rope::{Catalogue, CatalogueRope};

/// All ropes of the catalogue
///
/// d: diameter; load: breaking load; g/m: weight; a dash is a value that is not published.
/// guesses: parameters of the rope's law that are starting guesses, of all.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew rope list --ropes my-ropes")]
pub(crate) struct List {
    #[command(flatten)]
    ropes: Ropes,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

fn number(value: &Option<Value>, digits: u8) -> String {
    value
        .as_ref()
        .map_or_else(|| "–".into(), |v| rounded(v.value, digits))
}

impl List {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let catalogue = self.ropes.catalogue()?;
        if self.json {
            answer(&(serde_json::to_string_pretty(&json(&catalogue))? + "\n"))?;
        } else {
            answer(&told(&catalogue))?;
        }
        Ok(Finish::Complete)
    }
}

fn told(catalogue: &Catalogue) -> String {
    let head = [
        "name", "fibre", "d
mm", "load
N", "g/m", "guesses",
    ];
    let row = |rope: &CatalogueRope| {
        let e = &rope.entry;
        vec![
            plain(&e.name),
            plain(&e.fibre),
            number(&e.diameter_mm, 3),
            number(&e.breaking_load_n, 4),
            number(&e.weight_g_per_m, 3),
            format!("{}/{}", e.guesses(), e.law.len()),
        ]
    };
    let rows = catalogue.ropes().iter().map(row).collect();
    let mut out = table(&head, rows, 2);
    let own = catalogue
        .ropes()
        .iter()
        .filter(|r| r.file.is_some())
        .count();
    if own > 0 {
        out.push_str(&paragraph(&format!("{own} of them from your folders"), 0));
    }
    out
}

fn json(catalogue: &Catalogue) -> serde_json::Value {
    let value = |v: &Option<Value>| v.as_ref().map(|v| v.value);
    catalogue
        .ropes()
        .iter()
        .map(|rope| {
            let e = &rope.entry;
            serde_json::json!({
                "name": e.name,
                "manufacturer": e.manufacturer,
                "product": e.product,
                "fibre": e.fibre,
                "material": e.material.name(),
                "plait": e.plait,
                "diameter_mm": value(&e.diameter_mm),
                "breaking_load_n": value(&e.breaking_load_n),
                "weight_g_per_m": value(&e.weight_g_per_m),
                "starting_guesses": e.guesses(),
                "parameters": e.law.len(),
                "file": rope.file.as_ref().map(|f| f.display().to_string()),
            })
        })
        .collect()
}
