//! Rope catalogue and catalogue entries as text.

use super::messages::range;
use super::spoken;
use crate::text::{TerminalText, or_dash};
use sinew_figure::{Columns, Table, rounded};
use sinew_rope::law::entry::{DEFAULT_SOURCE, Uncertainty, Value};
use sinew_rope::{Catalogue, CatalogueRope};

/// Renders the catalogue, one line per rope.
pub fn catalogue_table(catalogue: &Catalogue) -> String {
    let published =
        |value: &Option<Value>, digits| or_dash(value.as_ref(), |v| rounded(v.value, digits));
    let mut out = TerminalText::default();
    out.table(
        Columns::of(catalogue.ropes().iter().map(|rope| &rope.entry))
            .words("name", |e| &e.name)
            .words("fibre", |e| &e.fibre)
            .column("d\n(mm)", |e| published(&e.diameter_mm, 3))
            .column("breaking load\n(N)", |e| published(&e.breaking_load_n, 4))
            .column("weight\n(g/m)", |e| published(&e.weight_g_per_m, 3))
            .column("assumed", |e| format!("{}/{}", e.assumed(), e.law.len()))
            .table(),
    );
    let own = catalogue
        .ropes()
        .iter()
        .filter(|r| r.file.is_some())
        .count();
    if own > 0 {
        out.flat(format!("{own} of them from additional catalogues"));
    }
    out.0
}

/// Renders all properties of a rope.
pub fn rope_table(rope: &CatalogueRope) -> String {
    let e = &rope.entry;
    let plait = e.plait.as_ref().map(|p| format!(", {p}"));
    let mut out = TerminalText::default();
    out.paragraph(format!(
        "{}: {} {}, {} ({}){}",
        e.name,
        e.manufacturer,
        e.product,
        e.fibre,
        e.material.name(),
        plait.unwrap_or_default()
    ));
    if let Some(note) = &e.note {
        out.paragraph(note);
    }
    let published = [
        ("diameter_mm", &e.diameter_mm),
        ("breaking_load_n", &e.breaking_load_n),
        ("weight_g_per_m", &e.weight_g_per_m),
        ("discard_strain_percent", &e.discard_strain_percent),
    ];
    let given = published.iter();
    let given = given.filter_map(|(name, v)| Some((*name, v.as_ref()?)));
    out.add("\npublished\n");
    out.table(values(given));
    let missing: Vec<&str> = published
        .iter()
        .filter(|(_, v)| v.is_none())
        .map(|(name, _)| *name)
        .collect();
    if !missing.is_empty() {
        out.paragraph(format!("not published: {}", missing.join(", ")));
    }
    let tested_range = rope.tested_range();
    out.add("\ncreep law\n");
    out.paragraph(format!(
        "tested range: {} of the breaking load, {}, {}{}",
        range(tested_range.load_share.map(|s| 100.0 * s), "%"),
        range(tested_range.temperature_c, "°C"),
        spoken(tested_range.duration_s),
        match e.tested_range {
            Some(_) => "; intervals are widened beyond it",
            None => " (not specified in the entry, default)",
        }
    ));
    let law = e.law_with_defaults();
    out.table(values(law.iter().map(|(p, v)| (p.name(), v))));
    if let Err(missing) = e.parameters() {
        out.paragraph(format!(
            "no prediction possible, missing parameters: {}",
            missing.join(", ")
        ));
    }
    if let Some(c) = &e.correlation {
        let names: Vec<&str> = c.parameters.iter().map(|p| p.name()).collect();
        out.paragraph(format!("correlated errors: {}", names.join(", ")));
    }
    // Fibre files are part of the program; a test reads each of them.
    let class = rope.endurance().ok();
    if let Some(class) = &class {
        out.add("\nendurance (of the rope, else of its fibre)\n");
        out.table(values(class.endurance.iter().map(|(k, v)| (k.name(), v))));
    }
    out.add("\nsources\n");
    for (key, source) in &e.sources {
        out.item(format!("{key}: {source}"));
    }
    if law.len() > e.law.len() {
        let [key, source] = DEFAULT_SOURCE;
        out.item(format!("{key}: {source}"));
    }
    let of_fibre = class.iter().flat_map(|c| &c.sources);
    for (key, source) in of_fibre {
        out.item(format!("{key} (endurance): {source}"));
    }
    out.0
}

/// Tabulates values with origin, source and uncertainty.
fn values<'a>(named: impl Iterator<Item = (&'a str, &'a Value)>) -> Table {
    Columns::of(named)
        .words("parameter", |(name, _)| *name)
        .words("origin", |(_, v)| {
            let date = v.date.as_ref().map(|d| format!(" {d}"));
            format!("{}{}", v.origin.name(), date.unwrap_or_default())
        })
        .words("source", |(_, v)| &v.source)
        .column("value", |(_, v)| number(v.value))
        .column("95 % interval", |(_, v)| interval(v))
        .table()
}

/// Formats four significant digits, in scientific notation if very small or large.
fn number(v: f64) -> String {
    if v != 0.0 && !(1e-3..1e5).contains(&v.abs()) {
        format!("{v:e}").replace('-', "−")
    } else {
        rounded(v, 4)
    }
}

/// Formats the 95 % interval of a value.
fn interval(value: &Value) -> String {
    match value.uncertainty {
        Uncertainty::NotSpecified => "not specified".into(),
        Uncertainty::Factor(f) => format!("factor {f}"),
        Uncertainty::PlusMinus(d) => format!("± {}", number(d)),
    }
}
