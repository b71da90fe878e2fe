//! Pages: content, content security policy, text alternatives and icons.

use sinew_figure::plot::{Band, Colour, Figure, Line, Panel, Points};
use sinew_figure::{Block, Headline, Level, Page, Table};

fn figure() -> Figure {
    let x: Vec<f64> = (0..=10).map(f64::from).collect();
    let y: Vec<f64> = x.iter().map(|x| x * x).collect();
    let above = y.iter().map(|y| y + 2.0).collect();
    let panel = Panel::new("", "time (s)", "offset δ_{e} (mrad)")
        .band(Band::new("95 %", x.clone(), y.clone(), above))
        .line(Line::new("estimate", x, y))
        .points(
            Points::new("session", vec![2.0, 3.0], vec![4.5, 8.5])
                .intervals(vec![4.0, 8.0], vec![5.0, 9.0])
                .labels(vec!["Monday".into(), "Tuesday".into()]),
        )
        .event(4.0, "slip")
        .x_range(0.0, 10.0);
    Figure::new("elbow").seen("The elbow grows").panel(panel)
}

fn page(blocks: Vec<Block>) -> String {
    Page::new("a page").section("", blocks).html()
}

fn drawn() -> String {
    page(vec![Block::Figure(Box::new(figure()), String::new())])
}

/// Text between two markers.
fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let start = text.find(from).unwrap_or_else(|| panic!("no {from}")) + from.len();
    &text[start..start + text[start..].find(to).unwrap_or_else(|| panic!("no {to}"))]
}

#[test]
fn page_policy_permits_only_own_script() {
    use sha2::Digest;
    let page = drawn();
    assert_eq!(page.matches("<script").count(), 1);
    let script = between(&page, "<script>", "</script>");
    assert!(script.starts_with("\"use strict\""), "comments are removed");
    let allowed = between(&page, "script-src 'sha256-", "'");
    // Six bits per letter.
    const LETTERS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bits: String = (allowed.trim_end_matches('=').chars())
        .map(|c| format!("{:06b}", LETTERS.find(c).expect("a letter of base 64")))
        .collect();
    let digest = sha2::Sha256::digest(script);
    let expected: String = digest.iter().map(|byte| format!("{byte:08b}")).collect();
    assert_eq!(bits[..256], expected);
    assert!(page.contains("default-src 'none'"));
    assert!(!script.contains("http") && !script.contains("eval("));
    // A page without figures needs no script.
    assert!(!page_of_words().contains("<script"));
}

fn page_of_words() -> String {
    page(vec![Block::Paragraph("words".into())])
}

#[test]
fn narrow_figure_reuses_curves_of_wide_figure() {
    let page = drawn();
    let narrow = between(&page, "<div class=\"scroll narrow\">", "</div>");
    assert!(narrow.contains("viewBox=\"0 0 340 "), "{narrow}");
    let id = between(narrow, "<use href=\"#", "\"");
    assert_eq!(page.matches(&format!(" id=\"{id}\"")).count(), 1);
    assert!(!narrow.contains("class=\"line\""), "{narrow}");
    let heights = |svg: &str| -> Vec<String> {
        let boxes = svg.split("data-box=\"").skip(1);
        let last = |text: &str| text.split(' ').nth(3).unwrap_or("").to_owned();
        boxes.map(|rest| last(between(rest, "", "\""))).collect()
    };
    let wide = between(&page, "<div class=\"scroll wide\">", "</div>");
    assert_eq!(heights(wide), heights(narrow));
    // Panels below one another repeat the label that they shared with the panel below.
    let panel =
        |label| Panel::new("", label, "y").line(Line::new("", vec![0.0, 1.0], vec![0.0, 1.0]));
    let labels = ["", "", "time (s)", "time (h)"];
    let grid = labels.into_iter().map(panel);
    let grid = grid.fold(Figure::new("").columns(2), Figure::panel);
    let page = self::page(vec![Block::Figure(Box::new(grid), String::new())]);
    let narrow = between(&page, "<div class=\"scroll narrow\">", "</div>");
    for label in [">time (s)<", ">time (h)<"] {
        assert_eq!(narrow.matches(label).count(), 2, "{label}");
    }
}

#[test]
fn figure_text_alternative_describes_curves() {
    assert_eq!(
        between(&figure().svg(), "<desc>", "</desc>"),
        "The elbow grows. offset δe (mrad), time (s) from 0.00 to 10.0: \
         95 % spans 0.00 to 102; estimate goes from 0.00 to 100; session: 2 measurements, 4.00 to 9.00. \
         Marked: slip at 4.00."
    );
    let falls_between = Figure::new("").panel(Panel::new("", "x", "y").line(Line::new(
        "",
        vec![0.0, 1.0, 2.0],
        vec![5.0, -3.0, 5.0],
    )));
    assert!(
        falls_between
            .svg()
            .contains("the curve goes from 5.00 to 5.00, lowest −3.00, highest 5.00.")
    );
    let nothing = Figure::new("").panel(Panel::new("", "x", "y")).svg();
    assert!(between(&nothing, "<desc>", "</desc>").ends_with("no data."));
}

#[test]
fn figure_colours_follow_page_theme() {
    let all = [Colour::Grey, Colour::Black]
        .into_iter()
        .chain(Colour::CYCLE);
    let lines = all.map(|c| Line::new("line", vec![0.0, 1.0], vec![0.0, 1.0]).colour(c));
    let panel = lines.fold(Panel::new("title", "x", "y"), Panel::line);
    let panel = panel
        .reference(0.5, "here")
        .span(0.1, 0.2, "there")
        .y_right("z", 2.0);
    let svg = Figure::new("title").subtitle("more").panel(panel).svg();
    let page = page_of_words();
    let mut colours = 0;
    for key in ["fill=\"#", "stroke=\"#"] {
        for piece in svg.split(key).skip(1) {
            let hex = &piece[..6];
            let rule = format!(
                "[{key}{hex}\"]{{{}:var(--",
                key.split('=').next().unwrap_or("")
            );
            let variable = between(&page, &rule, ")");
            // One value in the light theme, another in the dark theme.
            let values: Vec<&str> = (page.split(&format!("--{variable}: ")).skip(1))
                .map(|rest| rest.split(';').next().unwrap_or(""))
                .collect();
            assert_eq!(values.len(), 2, "{hex} is {variable}: {values:?}");
            assert_ne!(values[0], values[1], "{variable}");
            colours += 1;
        }
    }
    assert!(colours > 20, "{colours}");
}

#[test]
fn headline_level_has_icon_besides_colour() {
    let all = [Level::Good, Level::Open, Level::Watch, Level::Alarm];
    let lines = all.map(|level| Headline::new(level, "elbow: <longer>"));
    let page = page(vec![Block::Headlines(lines.to_vec())]);
    let mut signs: Vec<&str> = page.split("class=\"sign\"").skip(1).collect();
    assert_eq!(signs.len(), all.len());
    assert_eq!(page.matches("elbow: &lt;longer&gt;").count(), all.len());
    signs.sort_by_key(|s| between(s, "d=\"", "\""));
    signs.dedup_by_key(|s| between(s, "d=\"", "\"").to_owned());
    assert_eq!(signs.len(), all.len(), "each level has a different icon");
}

#[test]
fn table_text_is_left_aligned_numbers_right_aligned() {
    let row = vec!["Fig. 1".into(), "a long sentence".into(), "1.5".into()];
    let table = Table::new(&["where", "sentence", "found"], vec![row]);
    let page = page(vec![table.worded(&["sentence", "verdict"]).into()]);
    for words in [
        "<th scope=\"col\" class=\"words\">sentence</th><th scope=\"col\">found</th>",
        "<td data-label=\"sentence\" class=\"words\">a long sentence</td><td data-label=\"found\">1.5</td>",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn folded_block_contains_complete_content() {
    let table =
        Table::new(&["a", "b"], vec![vec!["x".into(), "1".into()]]).captioned("all of them");
    let page = page(vec![Block::Folded(
        "2 parameters".into(),
        vec![table.into()],
    )]);
    let folded = between(&page, "<details>", "</details>");
    for words in [
        "<summary>2 parameters</summary>",
        "all of them",
        "<td data-label=\"b\">1</td>",
    ] {
        assert!(folded.contains(words), "{words}: {folded}");
    }
    // Details are expanded for printing.
    assert!(page.contains("beforeprint") && page.contains("details-content"));
}

#[test]
fn page_script_reads_figure_attributes() {
    let svg = figure().svg();
    for words in [
        "data-x=\"0 10\"",
        "data-y-label=\"offset δe (mrad)\"",
        "class=\"key\" data-series=\"1\"",
        "class=\"line\" data-name=\"estimate\"",
        "data-labels=\"Monday|Tuesday\"",
        "class=\"bars\"",
    ] {
        assert!(svg.contains(words), "{words}");
    }
    let script = include_str!("../src/page/page.js");
    for name in [
        "xLabel", "yLabel", "box", "series", "labels", "right", "since", "log", "rows",
    ] {
        assert!(script.contains(name), "{name}");
    }
}
