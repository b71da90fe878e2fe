//! Summary of a page for another page, such as a notebook.

use crate::page::{Block, Page, fill};
use crate::plot::{Annotation, Figure};
use minijinja::context;
use minijinja::value::Serde;
use std::cmp::Reverse;

/// Renders an HTML fragment with the first results of the page and the figure of the most urgent one; among equally urgent
/// ones that with the most events. It has no script and only inline styles.
pub fn glance(page: &Page) -> String {
    let blocks = || page.sections.iter().flat_map(|s| &s.blocks);
    let answers = blocks().find_map(|block| match block {
        Block::Headlines(lines) => Some(&lines[..]),
        _ => None,
    });
    let answers = answers.unwrap_or_default();
    // Each with the heading of its section, which names its joint.
    let of_sections = page.sections.iter().flat_map(|section| {
        section.blocks.iter().filter_map(move |block| match block {
            Block::Figure(figure, _) => Some((section.heading.as_str(), &**figure)),
            _ => None,
        })
    });
    let figures: Vec<(&str, &Figure)> = of_sections.collect();
    // In pages with one figure per result, results and figures have the same order.
    let all = answers.iter().enumerate();
    let events = |i: usize| {
        let panels = figures.get(i).map_or(&[][..], |(_, figure)| &figure.panels);
        let marks = panels.iter().flat_map(|panel| &panel.marks);
        marks
            .filter(|mark| matches!(mark, Annotation::Event { .. }))
            .count()
    };
    let most = all.max_by_key(|(i, answer)| (answer.level, events(*i), Reverse(*i)));
    let index = most.map_or(0, |(i, _)| i);
    let figure = figures.get(index).or(figures.first());
    let (title, answers) = (&page.title, Serde(answers));
    let heading = figure.map(|(heading, _)| *heading);
    let figure = figure.map(|(_, figure)| figure.svg());
    fill("glance.html", context! { title, answers, heading, figure })
}
