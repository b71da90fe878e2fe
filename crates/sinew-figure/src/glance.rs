//! A page at a glance, inside another page such as a notebook.

use crate::page::{Block, Headline, Level, Page};
use crate::plot::{Figure, escape_xml};
use std::cmp::Reverse;
use std::fmt::Write as _;

/// A piece of HTML: the page's first answers, and the figure of the one that asks most of its reader. It has no
/// script, and no style but its own.
pub fn glance(page: &Page) -> String {
    let blocks = || page.sections.iter().flat_map(|s| &s.blocks);
    let answers = blocks().find_map(|block| match block {
        Block::Headlines(lines) => Some(&lines[..]),
        _ => None,
    });
    let answers = answers.unwrap_or_default();
    let figures: Vec<&Figure> = blocks()
        .filter_map(|block| match block {
            Block::Figure(figure, _) => Some(&**figure),
            _ => None,
        })
        .collect();
    // Pages with an answer a figure have both in one order.
    let all = answers.iter().enumerate();
    let most = all.max_by_key(|(i, answer)| (answer.level, Reverse(*i)));
    let place = most.map_or(0, |(i, _)| i);
    let mut out = format!("<div><p><b>{}</b></p>\n", escape_xml(&page.title));
    for Headline { level, text } in answers {
        let (colour, text) = (colour(*level), escape_xml(text));
        let _ = writeln!(
            out,
            "<p style=\"margin:.2em 0;padding-left:.6em;border-left:4px solid {colour}\">{text}</p>"
        );
    }
    if let Some(figure) = figures.get(place).or(figures.first()) {
        out += &figure.svg();
    }
    out + "</div>\n"
}

/// The colours of `page.css` on white.
fn colour(level: Level) -> &'static str {
    match level {
        Level::Plain => "#0072b2",
        Level::Good => "#00704f",
        Level::Open => "#6f5800",
        Level::Watch => "#a34700",
        Level::Alarm => "#b3261e",
    }
}
