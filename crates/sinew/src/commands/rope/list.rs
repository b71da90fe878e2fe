//! `sinew rope list`.

use super::Ropes;
use crate::terminal::{Failure, Finish, answer};
use crate::text::{paragraph, plain, table};
use clap::Args;
use sinew_figure::rounded;
use sinew_files::JsonDocument;
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
            answer(&catalogue.list().to_json()?)?;
        } else {
            answer(&text(&catalogue))?;
        }
        Ok(Finish::Complete)
    }
}

fn text(catalogue: &Catalogue) -> String {
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
