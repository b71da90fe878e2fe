//! Labels of the annotations, placed where they cover the least data.

use super::Annotation;
use super::data::place;
use super::ink::{GROUND, MUTED, text};
use super::label::width;
use super::layout::{Placed, Rect};

const MARK_PX: f64 = 11.5;

/// Draws the labels of the annotations over the data, each at its first free position.
pub(super) fn draw_labels(out: &mut String, placed: &Placed<'_>) {
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
        // Position of the label's target, used by the script to move the label on zooming.
        let (label_text, corners, target): (&str, Vec<(f64, f64)>, _) = match mark {
            Annotation::Note { x, y, text } => {
                let Some((px, py)) = at(*x, *y) else { continue };
                let tw = width(text, MARK_PX);
                let rows = [0.0, -line, line].map(|dy| py - line / 2.0 + dy);
                (
                    text,
                    rows.iter().flat_map(|&y| [(px, y), (px - tw, y)]).collect(),
                    (Some(px), Some(py)),
                )
            }
            Annotation::Reference { y, label } => {
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
                    (None, Some(py)),
                )
            }
            Annotation::Event { x: from, label } | Annotation::Span { from, label, .. } => {
                let to = match mark {
                    Annotation::Span { to, .. } => to,
                    _ => from,
                };
                let Some((px, _)) = at(from.min(*to), placed.y.low) else {
                    continue;
                };
                let corners = label_positions(px, width(label, MARK_PX), line);
                (label, corners, (Some(px), None))
            }
        };
        if label_text.is_empty() {
            continue;
        }
        let tw = width(label_text, MARK_PX);
        let boxes = corners.into_iter().map(|(x, y)| Rect {
            x,
            y,
            w: tw,
            h: line,
        });
        let free = |b: &Rect| frame.contains(b) && !taken.iter().any(|t| t.overlaps(b));
        // The first of the free positions that cover the least data.
        let spot = boxes.filter(free).min_by_key(|b| covered(&data, b));
        if let Some(spot) = spot {
            let mut style = format!(
                "fill=\"{MUTED}\" stroke=\"{GROUND}\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\""
            );
            for (axis, px) in [("x", target.0), ("y", target.1)] {
                if let Some(px) = px {
                    style += &format!(" data-{axis}=\"{px:.1}\"");
                }
            }
            let baseline = spot.y + 0.85 * MARK_PX + 1.0;
            text(out, spot.x, baseline, MARK_PX, &style, label_text);
            taken.push(spot);
        }
    }
}

/// Positions for a label at the top of a vertical line: right, left, up to three rows down.
fn label_positions(px: f64, tw: f64, line: f64) -> Vec<(f64, f64)> {
    (0..3)
        .flat_map(|row| {
            let y = 2.0 + f64::from(row) * line;
            [(px + 4.0, y), (px - tw - 4.0, y)]
        })
        .collect()
}

/// Returns all data points, px.
fn points(placed: &Placed<'_>) -> Vec<(f64, f64)> {
    let mut all = Vec::new();
    for series in &placed.panel.series {
        for ys in series.ys() {
            let places = series.x().iter().zip(ys);
            let places = places.filter_map(|(&x, &y)| place(placed, x, y));
            all.extend(places.map(|(x, y)| (x as f64 / 10.0, y as f64 / 10.0)));
        }
    }
    all
}

fn covered(data: &[(f64, f64)], area: &Rect) -> usize {
    let inside = |&&(x, y): &&(f64, f64)| {
        (area.x..=area.x + area.w).contains(&x) && (area.y..=area.y + area.h).contains(&y)
    };
    data.iter().filter(inside).count()
}
