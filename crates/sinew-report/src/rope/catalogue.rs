//! The catalogue, and a rope of it, as text.

use super::spoken;
use super::words::range;
use crate::text::{self, Told, paragraph, plain};
use sinew_figure::rounded;
use sinew_rope::law::entry::{Uncertainty, Value};
use sinew_rope::{Catalogue, CatalogueRope};

/// All ropes, a line each.
pub fn catalogue_table(catalogue: &Catalogue) -> String {
    let head = ["name", "fibre", "d\nmm", "load\nN", "g/m", "guesses"];
    let row = |rope: &CatalogueRope| {
        let e = &rope.entry;
        vec![
            plain(&e.name),
            plain(&e.fibre),
            published(&e.diameter_mm, 3),
            published(&e.breaking_load_n, 4),
            published(&e.weight_g_per_m, 3),
            format!("{}/{}", e.guesses(), e.law.len()),
        ]
    };
    let rows = catalogue.ropes().iter().map(row).collect();
    let mut out = text::table(&head, rows, 2);
    let own = catalogue
        .ropes()
        .iter()
        .filter(|r| r.file.is_some())
        .count();
    if own > 0 {
        out += &paragraph(&format!("{own} of them from your folders"), 0);
    }
    out
}

/// A published value; a dash where there is none.
fn published(value: &Option<Value>, digits: u8) -> String {
    value
        .as_ref()
        .map_or_else(|| "–".into(), |v| rounded(v.value, digits))
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
        ("discard_strain_percent", &e.discard_strain_percent),
    ];
    let known = published
        .iter()
        .filter_map(|(name, v)| v.as_ref().map(|v| row(name, v)));
    out.add("\npublished\n");
    out.add(text::table(&head, known.collect(), 3));
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
    let law = e.law.iter().map(|(p, v)| row(p.name(), v)).collect();
    out.add(text::table(&head, law, 3));
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
        let values = class.endurance.iter();
        let rows = values.map(|(k, v)| row(k.name(), v)).collect();
        out.add(text::table(&head, rows, 3));
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
