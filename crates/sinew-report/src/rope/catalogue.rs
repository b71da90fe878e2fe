//! The catalogue, and a rope of it, as text.

use super::spoken;
use super::words::range;
use crate::text::{Told, or_dash};
use sinew_figure::{Columns, Table, rounded};
use sinew_rope::law::entry::{Uncertainty, Value};
use sinew_rope::{Catalogue, CatalogueRope};

/// All ropes, a line each.
pub fn catalogue_table(catalogue: &Catalogue) -> String {
    let published =
        |value: &Option<Value>, digits| or_dash(value.as_ref(), |v| rounded(v.value, digits));
    let mut out = Told::default();
    out.table(
        Columns::of(catalogue.ropes().iter().map(|rope| &rope.entry))
            .words("name", |e| &e.name)
            .words("fibre", |e| &e.fibre)
            .column("d\nmm", |e| published(&e.diameter_mm, 3))
            .column("load\nN", |e| published(&e.breaking_load_n, 4))
            .column("g/m", |e| published(&e.weight_g_per_m, 3))
            .column("guesses", |e| format!("{}/{}", e.guesses(), e.law.len()))
            .table(),
    );
    let own = catalogue
        .ropes()
        .iter()
        .filter(|r| r.file.is_some())
        .count();
    if own > 0 {
        out.flat(format!("{own} of them from your folders"));
    }
    out.0
}

/// Everything known about a rope.
pub fn rope_table(rope: &CatalogueRope) -> String {
    let e = &rope.entry;
    let plait = e.plait.as_ref().map(|p| format!(", {p}"));
    let mut out = Told::default();
    out.say(format!(
        "{}: {} {}, {} ({}){}",
        e.name,
        e.manufacturer,
        e.product,
        e.fibre,
        e.material.name(),
        plait.unwrap_or_default()
    ));
    if let Some(note) = &e.note {
        out.say(note);
    }
    let published = [
        ("diameter_mm", &e.diameter_mm),
        ("breaking_load_n", &e.breaking_load_n),
        ("weight_g_per_m", &e.weight_g_per_m),
        ("discard_strain_percent", &e.discard_strain_percent),
    ];
    let known = published.iter();
    let known = known.filter_map(|(name, v)| Some((*name, v.as_ref()?)));
    out.add("\npublished\n");
    out.table(values(known));
    let missing: Vec<&str> = published
        .iter()
        .filter(|(_, v)| v.is_none())
        .map(|(name, _)| *name)
        .collect();
    if !missing.is_empty() {
        out.say(format!("not published: {}", missing.join(", ")));
    }
    let holds = rope.holds();
    out.add("\nlaw\n");
    out.say(format!(
        "data behind it: {} of the breaking load, {}, {}{}",
        range(holds.load_share.map(|s| 100.0 * s), "%"),
        range(holds.temperature_c, "°C"),
        spoken(holds.duration_s),
        match e.holds {
            Some(_) => "; beyond, predictions widen",
            None => " (not stated by the entry: taken for any rope)",
        }
    ));
    out.table(values(e.law.iter().map(|(p, v)| (p.name(), v))));
    if let Err(missing) = e.parameters() {
        out.say(format!(
            "missing, so nothing can be predicted with this rope: {}",
            missing.join(", ")
        ));
    }
    if let Some(c) = &e.correlation {
        let names: Vec<&str> = c.parameters.iter().map(|p| p.name()).collect();
        out.say(format!("errors correlated among {}", names.join(", ")));
    }
    // The fibres' files ship with the program; a test reads each of them.
    let class = rope.endurance().ok();
    if let Some(class) = &class {
        out.add("\nendurance: its own values, else those of its fibre\n");
        out.table(values(class.endurance.iter().map(|(k, v)| (k.name(), v))));
    }
    out.add("\nsources\n");
    for (key, source) in &e.sources {
        out.item(format!("{key}: {source}"));
    }
    let of_fibre = class.iter().flat_map(|c| &c.sources);
    for (key, source) in of_fibre {
        out.item(format!("{key} (endurance): {source}"));
    }
    out.0
}

/// Values with their source and uncertainty.
fn values<'a>(named: impl Iterator<Item = (&'a str, &'a Value)>) -> Table {
    Columns::of(named)
        .words("", |(name, _)| *name)
        .words("origin", |(_, v)| {
            let date = v.date.as_ref().map(|d| format!(" {d}"));
            format!("{}{}", v.origin.name(), date.unwrap_or_default())
        })
        .words("source", |(_, v)| &v.source)
        .column("value", |(_, v)| number(v.value))
        .column("95 % interval", |(_, v)| interval(v))
        .table()
}

/// Four digits, with a power of ten where a rate or a lifetime needs one.
fn number(v: f64) -> String {
    if v != 0.0 && !(1e-3..1e5).contains(&v.abs()) {
        format!("{v:e}").replace('-', "−")
    } else {
        rounded(v, 4)
    }
}

/// The 95 % interval of a value.
fn interval(value: &Value) -> String {
    match value.uncertainty {
        Uncertainty::NotStated => "not stated".into(),
        Uncertainty::Factor(f) => format!("times or over {f}"),
        Uncertainty::PlusMinus(d) => format!("± {}", number(d)),
    }
}
