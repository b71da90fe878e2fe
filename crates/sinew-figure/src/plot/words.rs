//! The words of marks, each where it hides least.

use super::Mark;
use super::data::place;
use super::ink::{GROUND, MUTED, text};
use super::label::width;
use super::layout::{Placed, Rect};

const MARK_PX: f64 = 11.5;

/// The words of the marks, over the data, each at the first of its places that is free.
pub(super) fn draw_words(out: &mut String, placed: &Placed<'_>) {
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
        // What the words stand at, for the script that moves them when a reader zooms.
        let (words, corners, held): (&str, Vec<(f64, f64)>, _) = match mark {
            Mark::Note { x, y, text } => {
                let Some((px, py)) = at(*x, *y) else { continue };
                let tw = width(text, MARK_PX);
                let rows = [0.0, -line, line].map(|dy| py - line / 2.0 + dy);
                (
                    text,
                    rows.iter().flat_map(|&y| [(px, y), (px - tw, y)]).collect(),
                    (Some(px), Some(py)),
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
                    (None, Some(py)),
                )
            }
            Mark::Event { x: from, label } | Mark::Span { from, label, .. } => {
                let to = match mark {
                    Mark::Span { to, .. } => to,
                    _ => from,
                };
                let Some((px, _)) = at(from.min(*to), placed.y.low) else {
                    continue;
                };
                let corners = beside(px, width(label, MARK_PX), line);
                (label, corners, (Some(px), None))
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
            let mut style = format!(
                "fill=\"{MUTED}\" stroke=\"{GROUND}\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\""
            );
            for (axis, px) in [("x", held.0), ("y", held.1)] {
                if let Some(px) = px {
                    style += &format!(" data-{axis}=\"{px:.1}\"");
                }
            }
            let baseline = spot.y + 0.85 * MARK_PX + 1.0;
            text(out, spot.x, baseline, MARK_PX, &style, words);
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
    for series in &placed.panel.series {
        for ys in series.ys() {
            let places = series.x().iter().zip(ys);
            let places = places.filter_map(|(&x, &y)| place(placed, x, y));
            all.extend(places.map(|(x, y)| (x as f64 / 10.0, y as f64 / 10.0)));
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
