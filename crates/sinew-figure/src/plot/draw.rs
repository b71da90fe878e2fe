//! SVG output of a figure.

use super::annotation_labels::draw_labels;
use super::axis::Axis;
use super::data::{Tenths, band_opacity, draw_band, draw_line, draw_points, place};
use super::description::description;
use super::ink::{AXIS, GRID, GROUND, INK, MUTED, REFERENCE, dash, text};
use super::label::{escape_xml, plain, shorten};
use super::layout::{
    Entry, LABEL_PX, LEGEND_PX, Layout, MARGIN, PANEL_TITLE_PX, Placed, Rect, SAMPLE, SUBTITLE_PX,
    Sample, TICK_PX, TITLE_PX, arrange, narrow,
};
use super::{Annotation, Figure, Series, XValues};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;

const BOLD: &str = "font-weight=\"600\"";
const MIDDLE: &str = "text-anchor=\"middle\"";
const END: &str = "text-anchor=\"end\"";
/// Font families; the embedded font comes first, so that SVG and PNG agree if it is installed.
const FAMILY: &str = "Roboto, 'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', sans-serif";

/// Source of the curves of a drawing.
enum Curves<'a> {
    /// Drawn in place, without ids.
    Plain,
    /// Drawn in place, each panel with an id that starts with this name.
    Named(&'a str),
    /// References to the curves of a drawing with these ids and panels, scaled to the panels of this one.
    Reused(&'a str, &'a [Placed<'a>]),
}

pub(super) fn svg(figure: &Figure) -> String {
    drawn(figure, &arrange(figure), &Curves::Plain)
}

/// Renders a figure at full size, and for narrow windows with references to the curves of the first.
pub(super) fn wide_and_narrow(figure: &Figure) -> [String; 2] {
    // Identical figures of a page have identical ids.
    let digest = Sha256::digest(svg(figure));
    let digits = digest.iter().take(4).map(|byte| format!("{byte:02x}"));
    let name = format!("f{}", digits.collect::<String>());
    let layout = arrange(figure);
    let narrow = narrow(figure, &layout);
    [
        drawn(figure, &layout, &Curves::Named(&name)),
        drawn(
            &narrow,
            &arrange(&narrow),
            &Curves::Reused(&name, &layout.panels),
        ),
    ]
}

fn drawn(figure: &Figure, layout: &Layout<'_>, curves: &Curves<'_>) -> String {
    let (w, h) = (layout.width, layout.height);
    let mut out = String::new();
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" \
         height=\"{h}\" role=\"img\" aria-label=\"{}\" font-family=\"{FAMILY}\" fill=\"{INK}\">\n\
         <desc>{}</desc>\n<rect width=\"{w}\" height=\"{h}\" fill=\"{GROUND}\"/>\n",
        escape_xml(&name(figure)),
        escape_xml(&description(figure)),
    );
    let mut y = MARGIN;
    for line in &layout.title {
        y += TITLE_PX + 5.0;
        text(&mut out, MARGIN, y - 6.0, TITLE_PX, BOLD, line);
    }
    for line in &layout.subtitle {
        y += SUBTITLE_PX + 4.0;
        let style = format!("fill=\"{MUTED}\"");
        text(&mut out, MARGIN, y - 5.0, SUBTITLE_PX, &style, line);
    }
    for (i, placed) in layout.panels.iter().enumerate() {
        draw_panel(&mut out, placed, i, curves);
    }
    out.push_str("</svg>\n");
    out
}

/// Returns the short name: the title, otherwise the titles of the panels, otherwise their axis labels.
fn name(figure: &Figure) -> String {
    let titles = figure.panels.iter().map(|p| p.title.as_str());
    let all: Vec<&str> = std::iter::once(figure.title.as_str())
        .chain(titles)
        .filter(|t| !t.is_empty())
        .collect();
    if !all.is_empty() {
        return plain(&all.join("; "));
    }
    let labels = figure.panels.iter().map(|p| plain(&p.y_label));
    labels.collect::<Vec<_>>().join("; ")
}

/// Returns the axes as attributes, from which the page script converts px into values.
fn axes_data(placed: &Placed<'_>) -> String {
    let (panel, Rect { x, y, w, h }) = (placed.panel, placed.plot);
    let mut out = format!(
        "data-box=\"{x:.1} {y:.1} {w:.1} {h:.1}\" data-x=\"{} {}\" data-y=\"{} {}\"",
        placed.x.low, placed.x.high, placed.y.low, placed.y.high
    );
    let mut add = |key: &str, value: &str| {
        if !value.is_empty() {
            let _ = write!(out, " data-{key}=\"{}\"", escape_xml(value));
        }
    };
    let exponent = |axis: &Axis| match axis.exponent {
        0 => String::new(),
        e => e.to_string(),
    };
    add("x-label", &plain(&panel.x_label));
    add("y-label", &plain(&panel.y_label));
    add("x-exponent", &exponent(&placed.x));
    add("y-exponent", &exponent(&placed.y));
    if let (Some(axis), Some(right)) = (&placed.right, &panel.y_right) {
        add("right", &right.factor.to_string());
        add("right-label", &plain(&right.label));
        add("right-exponent", &exponent(axis));
    }
    match panel.x_values {
        XValues::Plain => {}
        XValues::LogSeconds => add("log", "s"),
        XValues::DaysSince { utc_s } => add("since", &utc_s.to_string()),
    }
    if !panel.y_names.is_empty() {
        add("rows", "named");
    }
    out
}

fn draw_panel(out: &mut String, placed: &Placed<'_>, index: usize, curves: &Curves<'_>) {
    let panel = placed.panel;
    let _ = writeln!(out, "<g class=\"panel\" {}>", axes_data(placed));
    draw_axes(out, placed);
    if let Some((x, y)) = placed.title {
        text(out, x, y, PANEL_TITLE_PX, BOLD, &panel.title);
    }
    for entry in &placed.legend {
        draw_entry(out, entry);
    }
    // A nested SVG clips its content at its border without the id of a clip path.
    let Rect { x, y, w, h } = placed.plot;
    let _ = writeln!(
        out,
        "<svg x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" overflow=\"hidden\">"
    );
    match curves {
        Curves::Plain => draw_curves(out, placed, ""),
        Curves::Named(name) => draw_curves(out, placed, &format!(" id=\"{name}-{index}\"")),
        Curves::Reused(name, panels) => {
            let of = panels[index].plot;
            let _ = writeln!(
                out,
                "<g class=\"data\"><use href=\"#{name}-{index}\" transform=\"scale({:.5} {:.5})\"/></g>",
                w / of.w,
                h / of.h
            );
        }
    }
    draw_labels(out, placed);
    out.push_str("</svg>\n</g>\n");
}

/// Draws the annotations and series of a panel as a group with the attribute `id`.
fn draw_curves(out: &mut String, placed: &Placed<'_>, id: &str) {
    let panel = placed.panel;
    let _ = writeln!(out, "<g class=\"data\"{id}>");
    for mark in &panel.marks {
        draw_mark(out, placed, mark);
    }
    for series in &panel.series {
        let name = escape_xml(&plain(series.name()));
        let (class, labels) = match series {
            Series::Band(_) => ("band", String::new()),
            Series::Line(_) => ("line", String::new()),
            Series::Points(points) => {
                let labels = escape_xml(&points.labels.join("|"));
                ("points", format!(" data-labels=\"{labels}\""))
            }
        };
        let _ = writeln!(out, "<g class=\"{class}\" data-name=\"{name}\"{labels}>");
        match series {
            Series::Band(band) => draw_band(out, placed, band),
            Series::Line(line) => draw_line(out, placed, line),
            Series::Points(points) => draw_points(out, placed, points),
        }
        out.push_str("</g>\n");
    }
    out.push_str("</g>\n");
}

fn draw_axes(out: &mut String, placed: &Placed<'_>) {
    let Rect { x, y, w, h } = placed.plot;
    let (right, bottom) = (x + w, y + h);
    let panel = placed.panel;
    let mut grid = String::new();
    let mut ticks = format!("M{x:.1} {y:.1}V{bottom:.1}H{right:.1}");
    let mut numbers = String::new();
    let mut number = |x: f64, y: f64, anchor: &str, words: &str| {
        text(&mut numbers, x, y, TICK_PX, anchor, words);
    };
    for &t in &placed.x.ticks {
        let at = x + w * placed.x.position(t);
        let _ = write!(grid, "M{at:.1} {y:.1}V{bottom:.1}");
        let _ = write!(ticks, "M{at:.1} {bottom:.1}v4");
        if !panel.x_label.is_empty() {
            let below = bottom + 6.0 + 0.8 * TICK_PX;
            number(at, below, MIDDLE, &placed.x.number(t));
        }
    }
    for &t in &placed.y.ticks {
        let at = bottom - h * placed.y.position(t);
        let _ = write!(grid, "M{x:.1} {at:.1}H{right:.1}");
        let _ = write!(ticks, "M{x:.1} {at:.1}h-4");
        number(x - 7.0, at + 0.36 * TICK_PX, END, &placed.y.number(t));
    }
    if let Some(axis) = &placed.right {
        let _ = write!(ticks, "M{right:.1} {y:.1}V{bottom:.1}");
        for &t in &axis.ticks {
            let at = bottom - h * axis.position(t);
            let _ = write!(ticks, "M{right:.1} {at:.1}h4");
            number(right + 7.0, at + 0.36 * TICK_PX, "", &axis.number(t));
        }
    }
    let _ = writeln!(
        out,
        "<g class=\"axes\">\n<path d=\"{grid}\" stroke=\"{GRID}\" fill=\"none\"/>\n\
         <path d=\"{ticks}\" stroke=\"{AXIS}\" fill=\"none\"/>\n\
         <g fill=\"{MUTED}\">\n{numbers}</g>\n</g>"
    );
    if !panel.x_label.is_empty() {
        let at = bottom + 6.0 + TICK_PX + 5.0 + 0.8 * LABEL_PX;
        let label = placed.x.label(&panel.x_label);
        text(out, x + w / 2.0, at, LABEL_PX, MIDDLE, &label);
    }
    let upright = |out: &mut String, at: f64, label: &str| {
        let middle = y + h / 2.0;
        let style = format!("{MIDDLE} transform=\"rotate(-90 {at:.1} {middle:.1})\"");
        let label = shorten(label, LABEL_PX, h + 30.0).unwrap_or_default();
        text(out, at, middle, LABEL_PX, &style, &label);
    };
    if !panel.y_label.is_empty() {
        let at = placed.label_x + 0.85 * LABEL_PX;
        upright(out, at, &placed.y.label(&panel.y_label));
    }
    if let (Some(axis), Some(right)) = (&placed.right, &panel.y_right) {
        upright(out, placed.right_label_x - 2.0, &axis.label(&right.label));
    }
}

fn draw_entry(out: &mut String, entry: &Entry) {
    let Entry { x, y, colour, .. } = *entry;
    let middle = y - 0.35 * LEGEND_PX;
    let _ = writeln!(out, "<g class=\"key\" data-series=\"{}\">", entry.series);
    let _ = match &entry.sample {
        Sample::Line(style, width_px) => writeln!(
            out,
            "<path d=\"M{x:.1} {middle:.1}h{SAMPLE}\" stroke=\"{}\" stroke-width=\"{}\"{} fill=\"none\"/>",
            colour.hex(),
            width_px.clamp(1.0, 3.0),
            dash(*style, width_px.clamp(1.0, 3.0)),
        ),
        Sample::Band => writeln!(
            out,
            "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"{SAMPLE}\" height=\"9\" fill=\"{}\" fill-opacity=\"{}\"/>",
            middle - 4.5,
            colour.hex(),
            band_opacity(colour),
        ),
        Sample::Points(size_px) => writeln!(
            out,
            "<path d=\"M{:.1} {middle:.1}h0\" stroke=\"{}\" stroke-width=\"{size_px}\" stroke-linecap=\"round\" fill=\"none\"/>",
            x + 0.5 * SAMPLE,
            colour.hex(),
        ),
    };
    text(out, x + SAMPLE + 5.0, y, LEGEND_PX, "", &entry.name);
    out.push_str("</g>\n");
}

fn draw_mark(out: &mut String, placed: &Placed<'_>, mark: &Annotation) {
    let Rect { w, h, .. } = placed.plot;
    let line = |d: String, dashes: &str| {
        format!(
            "<path d=\"{d}\" stroke-dasharray=\"{dashes}\" stroke=\"{REFERENCE}\" fill=\"none\"/>\n"
        )
    };
    let across = |x: f64| place(placed, x, placed.y.low).map(|p| p.0);
    let drawn = match mark {
        Annotation::Reference { y, .. } => place(placed, placed.x.low, *y)
            .map(|(_, y)| line(format!("M0 {}H{w:.1}", Tenths(y)), "5 3")),
        Annotation::Event { x, .. } => {
            across(*x).map(|x| line(format!("M{} 0V{h:.1}", Tenths(x)), "2 2"))
        }
        Annotation::Span { from, to, .. } => across(*from).zip(across(*to)).map(|(a, b)| {
            let (left, width) = (Tenths(a.min(b)), Tenths((b - a).abs()));
            format!("<rect x=\"{left}\" y=\"0\" width=\"{width}\" height=\"{h:.1}\" fill=\"{AXIS}\" fill-opacity=\"0.16\"/>\n")
        }),
        Annotation::Note { .. } => None,
    };
    out.push_str(&drawn.unwrap_or_default());
}
