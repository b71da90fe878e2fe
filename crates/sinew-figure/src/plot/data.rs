//! SVG paths of curves, bands and points.

use super::ink::dash;
use super::layout::{Placed, Rect};
use super::{Band, Colour, Line, Points};
use std::fmt::Write as _;

/// Number of points per px above which a line keeps only the first, smallest, largest and last of each px.
const POINTS_PER_PX: usize = 4;

pub(super) fn band_opacity(colour: Colour) -> f64 {
    match colour {
        Colour::Sky | Colour::Amber => 0.38,
        _ => 0.22,
    }
}

/// Returns the position of a data point in tenths of a px inside the plot.
///
/// Clamped to 1000 px outside the visible area, so that no renderer receives huge numbers.
pub(super) fn place(placed: &Placed<'_>, x: f64, y: f64) -> Option<Point> {
    let Rect { w, h, .. } = placed.plot;
    let px = w * placed.x.position(x);
    let py = h * (1.0 - placed.y.position(y));
    (px.is_finite() && py.is_finite()).then(|| {
        let tenth = |v: f64, size: f64| (10.0 * v.clamp(-1000.0, size + 1000.0)).round() as i64;
        (tenth(px, w), tenth(py, h))
    })
}

/// Adds a section without gaps to path data, as differences to keep it short.
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

/// Length in tenths of a px.
pub(super) type Point = (i64, i64);

pub(super) struct Tenths(pub(super) i64);

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

pub(super) fn draw_line(out: &mut String, placed: &Placed<'_>, line: &Line) {
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

/// Reduces very long curves to the first, lowest, highest and last point of every px column.
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

pub(super) fn draw_band(out: &mut String, placed: &Placed<'_>, band: &Band) {
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
            // A single interval is drawn one px wide.
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

/// Bars are drawn before the dots, both in the order of the points.
pub(super) fn draw_points(out: &mut String, placed: &Placed<'_>, points: &Points) {
    let (mut bars, mut dots) = (String::new(), String::new());
    for (i, (&x, &y)) in points.x.iter().zip(&points.y).enumerate() {
        let Some((px, py)) = place(placed, x, y) else {
            continue;
        };
        let _ = write!(dots, "M{} {}h0", Tenths(px), Tenths(py));
        let end = |ends: &[f64]| ends.get(i).and_then(|&end| place(placed, x, end));
        if let (Some((_, low)), Some((_, high))) = (end(&points.low), end(&points.high)) {
            let _ = write!(bars, "M{} {}V{}", Tenths(px), Tenths(low), Tenths(high));
        }
    }
    let colour = points.colour.hex();
    if !bars.is_empty() {
        let _ = writeln!(
            out,
            "<path class=\"bars\" d=\"{bars}\" stroke=\"{colour}\" fill=\"none\"/>"
        );
    }
    if !dots.is_empty() {
        let _ = writeln!(
            out,
            "<path d=\"{dots}\" stroke=\"{colour}\" stroke-width=\"{}\" stroke-linecap=\"round\" fill=\"none\"/>",
            points.size_px
        );
    }
}
