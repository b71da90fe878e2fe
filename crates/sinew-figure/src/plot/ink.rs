//! SVG text and dash attributes.

use super::label::markup;
use super::{Colour, Dash};
use std::fmt::Write as _;

/// Colour of secondary text.
pub(super) const MUTED: &str = "#5a606b";
pub(super) const GROUND: &str = "#ffffff";
pub(super) const INK: &str = "#1d1f24";
pub(super) const AXIS: &str = "#80858f";
pub(super) const GRID: &str = "#e7e9ee";
pub(super) const REFERENCE: &str = "#6c727d";

/// Returns CSS rules that map the colours of figures to the colour variables of a page.
pub(crate) fn page_colours() -> String {
    let inks = [
        (GROUND, "ground"),
        (INK, "ink"),
        (MUTED, "muted"),
        (AXIS, "axis"),
        (GRID, "grid"),
        (REFERENCE, "reference"),
        (Colour::Blue.hex(), "blue"),
        (Colour::Orange.hex(), "orange"),
        (Colour::Green.hex(), "green"),
        (Colour::Purple.hex(), "purple"),
        (Colour::Sky.hex(), "sky"),
        (Colour::Amber.hex(), "amber"),
        (Colour::Grey.hex(), "grey"),
    ];
    let rules = inks.map(|(hex, name)| {
        format!(
            "[fill=\"{hex}\"]{{fill:var(--{name})}}[stroke=\"{hex}\"]{{stroke:var(--{name})}}\n"
        )
    });
    rules.concat()
}

/// Writes a text at a position, with attributes.
pub(super) fn text(out: &mut String, x: f64, y: f64, size: f64, style: &str, words: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" {style}>{}</text>",
        markup(words, size)
    );
}

/// Returns the attribute of a dashed stroke; empty for a solid one.
pub(super) fn dash(dash: Dash, width_px: f64) -> String {
    let lengths: &[f64] = match dash {
        Dash::Solid => return String::new(),
        Dash::Dashed => &[4.0, 2.5],
        Dash::Dotted => &[1.0, 2.0],
        Dash::DashDotted => &[4.0, 2.0, 1.0, 2.0],
        Dash::LongDashed => &[6.5, 1.5],
        Dash::DashDotDotted => &[4.0, 2.0, 1.0, 2.0, 1.0, 2.0],
    };
    let lengths = lengths.iter().map(|l| format!("{:.1}", l * width_px));
    let lengths: Vec<String> = lengths.collect();
    format!(" stroke-dasharray=\"{}\"", lengths.join(" "))
}
