//! How words and dashes become SVG.

use super::Dash;
use super::label::markup;
use std::fmt::Write as _;

/// Colour of what stands back.
pub(super) const MUTED: &str = "#5a606b";

/// Words at a place, with their attributes.
pub(super) fn text(out: &mut String, x: f64, y: f64, size: f64, style: &str, words: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" {style}>{}</text>",
        markup(words)
    );
}

/// Attribute of a dashed stroke; empty for a solid one.
pub(super) fn dash(dash: Dash, width_px: f64) -> String {
    match dash {
        Dash::Solid => String::new(),
        Dash::Dashed => format!(
            " stroke-dasharray=\"{:.1} {:.1}\"",
            4.0 * width_px,
            2.5 * width_px
        ),
        Dash::Dotted => format!(
            " stroke-dasharray=\"{:.1} {:.1}\"",
            width_px,
            2.0 * width_px
        ),
    }
}
