//! A page at a glance, inside another page such as a notebook.

use crate::page::{Block, Page, fill};
use crate::plot::Figure;
use minijinja::context;
use minijinja::value::Serde;
use std::cmp::Reverse;

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
    let figure = figures.get(place).or(figures.first());
    let (title, answers) = (&page.title, Serde(answers));
    let figure = figure.map(|figure| figure.svg());
    fill("glance.html", context! { title, answers, figure })
}
