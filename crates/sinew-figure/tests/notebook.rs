//! Summary of a page in a notebook.

use sinew_figure::plot::{Annotation, Figure, Line, Panel};
use sinew_figure::{Block, Headline, Level, Page, glance};

fn figure(name: &str) -> Block {
    let panel = Panel::new(name, "", "").line(Line::new("", vec![0.0, 1.0], vec![0.0, 1.0]));
    Block::Figure(Box::new(Figure::new(name).panel(panel)), String::new())
}

fn page(levels: &[Level]) -> Page {
    let answer = |(i, level): (usize, &Level)| Headline::new(*level, format!("answer <{i}>"));
    let answers = levels.iter().enumerate().map(answer).collect();
    let mut page = Page::new("a & b").section("", vec![Block::Headlines(answers)]);
    for i in 0..levels.len() {
        page = page.section(format!("joint {i}"), vec![figure(&format!("figure {i}"))]);
    }
    page
}

#[test]
fn glance_has_all_results_and_most_urgent_figure() {
    let text = glance(&page(&[
        Level::Good,
        Level::Watch,
        Level::Watch,
        Level::Open,
    ]));
    for word in [
        "a &amp; b",
        "answer &lt;0&gt;",
        "answer &lt;3&gt;",
        "figure 1",
        "joint 1",
    ] {
        assert!(text.contains(word), "{word}");
    }
    assert!(!text.contains("<script") && !text.contains("figure 2") && !text.contains("joint 2"));
}

#[test]
fn glance_of_equal_urgency_shows_figure_with_change() {
    let mut page = page(&[Level::Watch, Level::Watch, Level::Good]);
    for (section, events) in page.sections[1..].iter_mut().zip([0, 1, 2]) {
        let Block::Figure(figure, _) = &mut section.blocks[0] else {
            panic!("no figure");
        };
        let (x, label) = (0.5, "change".to_owned());
        figure.panels[0].marks = vec![Annotation::Event { x, label }; events];
    }
    let text = glance(&page);
    assert!(text.contains("joint 1") && !text.contains("joint 0") && !text.contains("joint 2"));
}

#[test]
fn glance_without_results_shows_first_figure() {
    let pictures = Page::new("a").section("", vec![figure("one"), figure("two")]);
    let text = glance(&pictures);
    assert!(text.contains("one") && !text.contains("two"));
    assert!(!glance(&Page::new("a")).contains("<svg"));
}
