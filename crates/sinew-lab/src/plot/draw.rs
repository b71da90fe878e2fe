//! Writes a figure as SVG.

use super::label::{escape_xml, markup, shorten, width};
use super::layout::{
    Entry, LABEL_PX, LEGEND_PX, Layout, MARGIN, PANEL_TITLE_PX, Placed, Rect, SAMPLE, SUBTITLE_PX,
    Sample, TICK_PX, TITLE_PX, arrange,
};
use super::{Band, Colour, Dash, Figure, Line, Mark, Series};
use std::fmt::Write as _;

/// The carried font first, so that SVG and PNG agree where it is installed.
const FAMILY: &str = "Roboto, 'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', sans-serif";
const INK: &str = "#1d1f24";
const MUTED: &str = "#5a606b";
const AXIS: &str = "#80858f";
const GRID: &str = "#e7e9ee";
const REFERENCE: &str = "#6c727d";
const MARK_PX: f64 = 11.5;
/// A line with more points than this per px keeps the first, last, smallest and largest of each.
const POINTS_PER_PX: usize = 4;

pub(super) fn svg(figure: &Figure) -> String {
    let layout = arrange(figure);
    let Layout {
        width: w,
        height: h,
        ..
    } = layout;
    let mut out = String::new();
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" \
         height=\"{h}\" role=\"img\" aria-label=\"{}\" font-family=\"{FAMILY}\" fill=\"{INK}\">\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
        escape_xml(&description(figure))
    );
    let mut y = MARGIN;
    for line in &layout.title {
        y += TITLE_PX + 5.0;
        text(
            &mut out,
            MARGIN,
            y - 6.0,
            TITLE_PX,
            "font-weight=\"600\"",
            line,
        );
    }
    for line in &layout.subtitle {
        y += SUBTITLE_PX + 4.0;
        let style = format!("fill=\"{MUTED}\"");
        text(&mut out, MARGIN, y - 5.0, SUBTITLE_PX, &style, line);
    }
    for placed in &layout.panels {
        draw_panel(&mut out, placed);
    }
    out.push_str("</svg>\n");
    out
}

fn description(figure: &Figure) -> String {
    let titles = figure.panels.iter().map(|p| p.title.as_str());
    let words: Vec<&str> = std::iter::once(figure.title.as_str())
        .chain(titles)
        .filter(|t| !t.is_empty())
        .collect();
    words.join("; ")
}

fn text(out: &mut String, x: f64, y: f64, size: f64, style: &str, words: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" {style}>{}</text>",
        markup(words)
    );
}

fn draw_panel(out: &mut String, placed: &Placed<'_>) {
    let panel = placed.panel;
    draw_axes(out, placed);
    if let Some((x, y)) = placed.title {
        text(
            out,
            x,
            y,
            PANEL_TITLE_PX,
            "font-weight=\"600\"",
            &panel.title,
        );
    }
    for entry in &placed.legend {
        draw_entry(out, entry);
    }
    // A nested picture cuts its content off at its own border, without a clip path's id.
    let Rect { x, y, w, h } = placed.plot;
    let _ = writeln!(
        out,
        "<svg x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" overflow=\"hidden\">"
    );
    for mark in &panel.marks {
        draw_mark(out, placed, mark);
    }
    for series in &panel.series {
        match series {
            Series::Band(band) => draw_band(out, placed, band),
            Series::Line(line) => draw_line(out, placed, line),
        }
    }
    draw_words(out, placed);
    out.push_str("</svg>\n");
}

fn draw_axes(out: &mut String, placed: &Placed<'_>) {
    let Rect { x, y, w, h } = placed.plot;
    let (right, bottom) = (x + w, y + h);
    let panel = placed.panel;
    let mut grid = String::new();
    let mut ticks = format!("M{x:.1} {y:.1}V{bottom:.1}H{right:.1}");
    let mut numbers = String::new();
    for &t in &placed.x.ticks {
        let at = x + w * placed.x.position(t);
        let _ = write!(grid, "M{at:.1} {y:.1}V{bottom:.1}");
        let _ = write!(ticks, "M{at:.1} {bottom:.1}v4");
        if !panel.x_label.is_empty() {
            let style = "text-anchor=\"middle\"";
            text(
                &mut numbers,
                at,
                bottom + 6.0 + 0.8 * TICK_PX,
                TICK_PX,
                style,
                &placed.x.number(t),
            );
        }
    }
    for &t in &placed.y.ticks {
        let at = bottom - h * placed.y.position(t);
        let _ = write!(grid, "M{x:.1} {at:.1}H{right:.1}");
        let _ = write!(ticks, "M{x:.1} {at:.1}h-4");
        text(
            &mut numbers,
            x - 7.0,
            at + 0.36 * TICK_PX,
            TICK_PX,
            "text-anchor=\"end\"",
            &placed.y.number(t),
        );
    }
    if let Some(axis) = &placed.right {
        let _ = write!(ticks, "M{right:.1} {y:.1}V{bottom:.1}");
        for &t in &axis.ticks {
            let at = bottom - h * axis.position(t);
            let _ = write!(ticks, "M{right:.1} {at:.1}h4");
            text(
                &mut numbers,
                right + 7.0,
                at + 0.36 * TICK_PX,
                TICK_PX,
                "",
                &axis.number(t),
            );
        }
    }
    let _ = writeln!(
        out,
        "<path d=\"{grid}\" stroke=\"{GRID}\" fill=\"none\"/>\n\
         <path d=\"{ticks}\" stroke=\"{AXIS}\" fill=\"none\"/>\n\
         <g fill=\"{MUTED}\">\n{numbers}</g>"
    );
    if !panel.x_label.is_empty() {
        let at = bottom + 6.0 + TICK_PX + 5.0 + 0.8 * LABEL_PX;
        let label = placed.x.label(&panel.x_label);
        text(
            out,
            x + w / 2.0,
            at,
            LABEL_PX,
            "text-anchor=\"middle\"",
            &label,
        );
    }
    let upright = |out: &mut String, at: f64, label: &str| {
        let middle = y + h / 2.0;
        let style = format!("text-anchor=\"middle\" transform=\"rotate(-90 {at:.1} {middle:.1})\"");
        let label = shorten(label, LABEL_PX, h + 30.0).unwrap_or_default();
        text(out, at, middle, LABEL_PX, &style, &label);
    };
    if !panel.y_label.is_empty() {
        upright(
            out,
            placed.label_x + 0.85 * LABEL_PX,
            &placed.y.label(&panel.y_label),
        );
    }
    if let (Some(axis), Some(right)) = (&placed.right, &panel.y_right) {
        upright(out, placed.right_label_x - 2.0, &axis.label(&right.label));
    }
}

fn dash(dash: Dash, width_px: f64) -> String {
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

fn draw_entry(out: &mut String, entry: &Entry) {
    let Entry { x, y, colour, .. } = *entry;
    let middle = y - 0.35 * LEGEND_PX;
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
    };
    text(out, x + SAMPLE + 5.0, y, LEGEND_PX, "", &entry.name);
}

fn band_opacity(colour: Colour) -> f64 {
    match colour {
        Colour::Sky | Colour::Amber => 0.38,
        _ => 0.22,
    }
}

/// A place of the data in tenths of a px inside the plot.
///
/// Clamped to 1000 px outside, where it is cut off anyhow, so that no renderer sees huge numbers.
fn place(placed: &Placed<'_>, x: f64, y: f64) -> Option<Point> {
    let Rect { w, h, .. } = placed.plot;
    let px = w * placed.x.position(x);
    let py = h * (1.0 - placed.y.position(y));
    (px.is_finite() && py.is_finite()).then(|| {
        let tenth = |v: f64, size: f64| (10.0 * v.clamp(-1000.0, size + 1000.0)).round() as i64;
        (tenth(px, w), tenth(py, h))
    })
}

/// Adds one stretch without gaps to path data, as differences, which are short to write.
fn push_path(path: &mut String, points: impl Iterator<Item = Point>) {
    let mut last: Option<Point> = None;
    for (x, y) in points {
        match last {
            None => {
                let _ = write!(path, "M{} {}", Tenths(x), Tenths(y));
            }
            Some(old) if old == (x, y) => continue,
            Some((old_x, old_y)) => {
                let _ = write!(path, "l{} {}", Tenths(x - old_x), Tenths(y - old_y));
            }
        }
        last = Some((x, y));
    }
}

/// Tenths of a px.
type Point = (i64, i64);

struct Tenths(i64);

impl std::fmt::Display for Tenths {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sign = if self.0 < 0 { "-" } else { "" };
        let (whole, tenth) = (self.0.abs() / 10, self.0.abs() % 10);
        match tenth {
            0 => write!(f, "{sign}{whole}"),
            _ => write!(f, "{sign}{whole}.{tenth}"),
        }
    }
}

fn draw_line(out: &mut String, placed: &Placed<'_>, line: &Line) {
    let mut path = String::new();
    let mut dots = String::new();
    let points: Vec<Option<Point>> = line
        .x
        .iter()
        .zip(&line.y)
        .map(|(&x, &y)| place(placed, x, y))
        .collect();
    for stretch in points.split(Option::is_none) {
        let stretch: Vec<Point> = stretch.iter().flatten().copied().collect();
        match stretch.as_slice() {
            [] => {}
            [(x, y)] => {
                let _ = write!(dots, "M{} {}h0", Tenths(*x), Tenths(*y));
            }
            _ if line.step => {
                let corners = stretch.windows(2).flat_map(|p| [p[0], (p[1].0, p[0].1)]);
                push_path(&mut path, corners.chain(stretch.last().copied()));
            }
            _ => push_path(&mut path, thinned(&stretch, placed.plot.w).into_iter()),
        }
    }
    let (colour, width_px) = (line.colour.hex(), line.width_px);
    if !path.is_empty() {
        let _ = writeln!(
            out,
            "<path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"{width_px}\" \
             stroke-linejoin=\"round\" fill=\"none\"{}/>",
            dash(line.dash, width_px)
        );
    }
    if !dots.is_empty() {
        let _ = writeln!(
            out,
            "<path d=\"{dots}\" stroke=\"{colour}\" stroke-width=\"{}\" stroke-linecap=\"round\" fill=\"none\"/>",
            1.6 * width_px
        );
    }
}

/// Keeps first, lowest, highest and last point of every px column when there are very many.
fn thinned(points: &[Point], width_px: f64) -> Vec<Point> {
    if points.len() <= POINTS_PER_PX * width_px.max(1.0) as usize {
        return points.to_vec();
    }
    let mut kept = Vec::new();
    for column in points.chunk_by(|a, b| a.0.div_euclid(10) == b.0.div_euclid(10)) {
        let indices = 0..column.len();
        let highest = indices.clone().min_by_key(|&i| column[i].1).unwrap_or(0);
        let lowest = indices.max_by_key(|&i| column[i].1).unwrap_or(0);
        let mut four = [0, highest, lowest, column.len() - 1];
        four.sort_unstable();
        kept.extend(four.map(|i| column[i]));
    }
    kept
}

fn draw_band(out: &mut String, placed: &Placed<'_>, band: &Band) {
    let edges: Vec<Option<(Point, Point)>> = band
        .x
        .iter()
        .zip(band.low.iter().zip(&band.high))
        .map(|(&x, (&low, &high))| Some((place(placed, x, low)?, place(placed, x, high)?)))
        .collect();
    let mut path = String::new();
    for stretch in edges.split(Option::is_none) {
        if stretch.is_empty() {
            continue;
        }
        let mut upper: Vec<Point> = stretch.iter().flatten().map(|e| e.1).collect();
        let mut lower: Vec<Point> = stretch.iter().flatten().map(|e| e.0).collect();
        if let ([(x, high)], [(_, low)]) = (&upper[..], &lower[..]) {
            // A single interval is shown one px wide rather than not at all.
            (upper, lower) = (
                vec![(x - 5, *high), (x + 5, *high)],
                vec![(x - 5, *low), (x + 5, *low)],
            );
        }
        push_path(&mut path, upper.into_iter().chain(lower.into_iter().rev()));
        path.push('Z');
    }
    if !path.is_empty() {
        let _ = writeln!(
            out,
            "<path d=\"{path}\" fill=\"{}\" fill-opacity=\"{}\"/>",
            band.colour.hex(),
            band_opacity(band.colour)
        );
    }
}

fn draw_mark(out: &mut String, placed: &Placed<'_>, mark: &Mark) {
    let Rect { w, h, .. } = placed.plot;
    let style = format!("stroke=\"{REFERENCE}\" fill=\"none\"");
    match mark {
        Mark::Reference { y, .. } => {
            if let Some((_, py)) = place(placed, placed.x.low, *y) {
                let _ = writeln!(
                    out,
                    "<path d=\"M0 {}H{w:.1}\" stroke-dasharray=\"5 3\" {style}/>",
                    Tenths(py)
                );
            }
        }
        Mark::Event { x, .. } => {
            if let Some((px, _)) = place(placed, *x, placed.y.low) {
                let _ = writeln!(
                    out,
                    "<path d=\"M{} 0V{h:.1}\" stroke-dasharray=\"2 2\" {style}/>",
                    Tenths(px)
                );
            }
        }
        Mark::Span { from, to, .. } => {
            let ends = (
                place(placed, *from, placed.y.low),
                place(placed, *to, placed.y.low),
            );
            if let (Some((a, _)), Some((b, _))) = ends {
                let _ = writeln!(
                    out,
                    "<rect x=\"{}\" y=\"0\" width=\"{}\" height=\"{h:.1}\" fill=\"{AXIS}\" fill-opacity=\"0.16\"/>",
                    Tenths(a.min(b)),
                    Tenths((b - a).abs())
                );
            }
        }
        Mark::Note { .. } => {}
    }
}

/// The words of the marks, over the data, each at the first of its places that is free.
fn draw_words(out: &mut String, placed: &Placed<'_>) {
    let Rect { w, h, .. } = placed.plot;
    let frame = Rect {
        x: 0.0,
        y: 0.0,
        w,
        h,
    };
    let line = MARK_PX + 3.0;
    let mut taken: Vec<Rect> = Vec::new();
    let data = points(placed);
    for mark in &placed.panel.marks {
        let at =
            |x: f64, y: f64| place(placed, x, y).map(|(x, y)| (x as f64 / 10.0, y as f64 / 10.0));
        let (words, corners): (&str, Vec<(f64, f64)>) = match mark {
            Mark::Note { x, y, text } => {
                let Some((px, py)) = at(*x, *y) else { continue };
                let tw = width(text, MARK_PX);
                let rows = [0.0, -line, line].map(|dy| py - line / 2.0 + dy);
                (
                    text,
                    rows.iter().flat_map(|&y| [(px, y), (px - tw, y)]).collect(),
                )
            }
            Mark::Reference { y, label } => {
                let Some((_, py)) = at(placed.x.low, *y) else {
                    continue;
                };
                let right = w - width(label, MARK_PX) - 4.0;
                let rows = [py - line - 1.0, py + 1.0];
                (
                    label,
                    [right, 4.0]
                        .iter()
                        .flat_map(|&x| rows.map(|y| (x, y)))
                        .collect(),
                )
            }
            Mark::Event { x, label } => {
                let Some((px, _)) = at(*x, placed.y.low) else {
                    continue;
                };
                (label, beside(px, width(label, MARK_PX), line))
            }
            Mark::Span { from, to, label } => {
                let Some((px, _)) = at(from.min(*to), placed.y.low) else {
                    continue;
                };
                (label, beside(px, width(label, MARK_PX), line))
            }
        };
        if words.is_empty() {
            continue;
        }
        let tw = width(words, MARK_PX);
        let boxes = corners.into_iter().map(|(x, y)| Rect {
            x,
            y,
            w: tw,
            h: line,
        });
        let free = |b: &Rect| frame.contains(b) && !taken.iter().any(|t| t.overlaps(b));
        // Of the free places, the first of those that hide the least data.
        let spot = boxes.filter(free).min_by_key(|b| hidden(&data, b));
        if let Some(spot) = spot {
            let style = format!(
                "fill=\"{MUTED}\" stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\""
            );
            text(
                out,
                spot.x,
                spot.y + 0.85 * MARK_PX + 1.0,
                MARK_PX,
                &style,
                words,
            );
            taken.push(spot);
        }
    }
}

/// Places for a word at the top of a vertical line: right of it, left of it, up to three rows down.
fn beside(px: f64, tw: f64, line: f64) -> Vec<(f64, f64)> {
    (0..3)
        .flat_map(|row| {
            let y = 2.0 + f64::from(row) * line;
            [(px + 4.0, y), (px - tw - 4.0, y)]
        })
        .collect()
}

/// Every point of the data, px.
fn points(placed: &Placed<'_>) -> Vec<(f64, f64)> {
    let mut all = Vec::new();
    let mut add = |xs: &[f64], ys: &[f64]| {
        let places = xs.iter().zip(ys).filter_map(|(&x, &y)| place(placed, x, y));
        all.extend(places.map(|(x, y)| (x as f64 / 10.0, y as f64 / 10.0)));
    };
    for series in &placed.panel.series {
        match series {
            Series::Line(line) => add(&line.x, &line.y),
            Series::Band(band) => {
                add(&band.x, &band.low);
                add(&band.x, &band.high);
            }
        }
    }
    all
}

fn hidden(data: &[(f64, f64)], area: &Rect) -> usize {
    let inside = |&&(x, y): &&(f64, f64)| {
        (area.x..=area.x + area.w).contains(&x) && (area.y..=area.y + area.h).contains(&y)
    };
    data.iter().filter(inside).count()
}
