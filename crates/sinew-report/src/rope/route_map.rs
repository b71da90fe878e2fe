//! Drawing of the wear along the route of a rope.

use sinew_figure::plot::{Colour, Figure, Line, Panel};
use sinew_figure::rounded;
use sinew_rope::predict::{Prediction, PulleyPlace};
use sinew_rope::{DamageSite, Place};

/// Width of the drawing, CSS px.
const WIDTH_PX: f64 = 820.0;
/// Width and height of the axes, CSS px.
const AXES_PX: [f64; 2] = [80.0, 90.0];
/// Minimum and maximum height, CSS px.
const HEIGHT_PX: (f64, f64) = (190.0, 520.0);
/// Classes of wear: lower bound as share of the largest wear, label, colour, line width.
const CLASSES: [(f64, &str, Colour, f64); 4] = [
    (0.0, "< 10 % of the maximum wear", Colour::Grey, 2.5),
    (0.1, "10 to 33 %", Colour::Sky, 3.5),
    (1.0 / 3.0, "33 to 80 %", Colour::Amber, 5.0),
    (0.8, "80 to 100 %", Colour::Orange, 7.0),
];

/// Point of the path, mm, with its heading, rad.
#[derive(Clone, Copy)]
struct Pose {
    x: f64,
    y: f64,
    heading: f64,
}

impl Pose {
    fn along(self, length: f64) -> Self {
        Self {
            x: self.x + length * self.heading.cos(),
            y: self.y + length * self.heading.sin(),
            ..self
        }
    }

    /// Moves along a circular arc with its centre to the left (`side` 1) or right (−1).
    fn around(self, radius: f64, angle: f64, side: f64) -> Self {
        let centre = self.centre(radius, side);
        let heading = self.heading + side * angle;
        Self {
            x: centre[0] + side * radius * heading.sin(),
            y: centre[1] - side * radius * heading.cos(),
            heading,
        }
    }

    fn centre(self, radius: f64, side: f64) -> [f64; 2] {
        [
            self.x - side * radius * self.heading.sin(),
            self.y + side * radius * self.heading.cos(),
        ]
    }
}

/// Schematic route: pulleys turn the rope alternately left and right, because the direction is not specified.
struct Route<'a> {
    pulleys: &'a [PulleyPlace],
}

fn side(i: usize) -> f64 {
    if i.is_multiple_of(2) { 1.0 } else { -1.0 }
}

impl Route<'_> {
    /// Returns the pose of the rope at a distance from the drive, mm.
    fn at(&self, at_mm: f64) -> Pose {
        let mut pose = Pose {
            x: 0.0,
            y: 0.0,
            heading: 0.0,
        };
        let mut passed = 0.0;
        for (i, p) in self.pulleys.iter().enumerate() {
            let (from, contact) = (1e3 * p.at_m, 1e3 * p.radius_m * p.wrap_rad);
            if at_mm <= from {
                break;
            }
            pose = pose.along((from - passed).max(0.0));
            let on = (at_mm - from).min(contact);
            pose = pose.around(1e3 * p.radius_m, on / (1e3 * p.radius_m), side(i));
            passed = from + on;
            if on < contact {
                return pose;
            }
        }
        pose.along((at_mm - passed).max(0.0))
    }

    /// Returns points of a section, mm.
    fn section(&self, from_mm: f64, to_mm: f64) -> (Vec<f64>, Vec<f64>) {
        let parts = (((to_mm - from_mm) / 1.5).ceil() as usize).clamp(2, 400);
        let at = |k: usize| self.at(from_mm + (to_mm - from_mm) * k as f64 / parts as f64);
        (0..=parts).map(at).map(|p| (p.x, p.y)).unzip()
    }

    /// Returns the outline of a pulley, mm.
    fn outline(&self, i: usize) -> (Vec<f64>, Vec<f64>) {
        let p = &self.pulleys[i];
        let radius = 1e3 * p.radius_m;
        let [x, y] = self.at(1e3 * p.at_m).centre(radius, side(i));
        let angle = |k: i32| std::f64::consts::TAU * f64::from(k) / 48.0;
        (0..=48)
            .map(|k| (x + radius * angle(k).cos(), y + radius * angle(k).sin()))
            .unzip()
    }
}

/// Whether the route is drawn: it has pulleys and significant wear.
pub(super) fn is_drawn(p: &Prediction) -> bool {
    !p.pulleys.is_empty() && super::life::is_significant(&p.lifetime)
}

/// Plots the rope along its pulleys; line width and colour show the share of the life used.
pub(super) fn figure(p: &Prediction) -> Figure {
    let route = Route {
        pulleys: &p.pulleys,
    };
    let spots = p.lifetime.spots.iter().filter(|s| s.place == Place::Rope);
    let spots: Vec<&DamageSite> = spots.collect();
    let max = spots.iter().map(|s| s.damage()).fold(0.0, f64::max);
    let class_of = |s: &DamageSite| {
        let share = s.damage() / max;
        CLASSES.iter().rposition(|c| share >= c.0).unwrap_or(0)
    };
    // NaN separates the parts.
    let line = |name: &str, parts: Vec<(Vec<f64>, Vec<f64>)>| {
        let points =
            |(x, y): (Vec<f64>, Vec<f64>)| x.into_iter().zip(y).chain([(f64::NAN, f64::NAN)]);
        let (x, y) = parts.into_iter().flat_map(points).unzip();
        Line::new(name, x, y)
    };
    let outlines = (0..p.pulleys.len()).map(|i| route.outline(i)).collect();
    let pulleys = line("pulleys", outlines);
    let mut lines = vec![pulleys.colour(Colour::Black).width(1.0)];
    for (k, (_, name, colour, width)) in CLASSES.iter().enumerate() {
        let own = spots.iter().filter(|s| class_of(s) == k);
        let own = own.map(|s| route.section(1e3 * s.from_m, 1e3 * s.to_m));
        let line = line(name, own.collect());
        if !line.x.is_empty() {
            lines.push(line.colour(*colour).width(*width));
        }
    }
    let x = bounds(lines.iter().flat_map(|l| &l.x));
    let y = bounds(lines.iter().flat_map(|l| &l.y));
    // Both axes have the same scale.
    let scale = (x.1 - x.0) / (WIDTH_PX - AXES_PX[0]);
    let height = ((y.1 - y.0) / scale + AXES_PX[1]).clamp(HEIGHT_PX.0, HEIGHT_PX.1);
    let scale = f64::max(scale, (y.1 - y.0) / (height - AXES_PX[1]));
    let around = |(low, high): (f64, f64), px: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * px * scale);
        (middle - half, middle + half)
    };
    let x = around(x, WIDTH_PX - AXES_PX[0]);
    let y = around(y, height - AXES_PX[1]);
    let worst = spots
        .iter()
        .max_by(|a, b| a.damage().total_cmp(&b.damage()));
    let description = worst.map_or_else(String::new, |s| {
        format!(
            "The section from {} to {} mm wears out first; number of pulleys passing over it: {}.",
            rounded(1e3 * s.from_m, 4),
            rounded(1e3 * s.to_m, 4),
            s.guides
        )
    });
    let empty = Panel::new("", "x (mm)", "y (mm)");
    let panel = lines.into_iter().fold(empty, Panel::line);
    Figure::new("")
        .size(WIDTH_PX, height)
        .seen(description)
        .panel(panel.x_range(x.0, x.1).y_range(y.0, y.1))
}

/// Returns minimum and maximum with a margin of 5 %; NaN is ignored.
fn bounds<'a>(values: impl Iterator<Item = &'a f64> + Clone) -> (f64, f64) {
    let low = values.clone().copied().fold(f64::INFINITY, f64::min);
    let high = values.copied().fold(f64::NEG_INFINITY, f64::max);
    let margin = 0.05 * (high - low).max(1.0);
    (low - margin, high + margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    // Straight, quarter turn left, straight, quarter turn right, straight.
    #[test]
    fn path_keeps_length_and_turns_by_wraps() {
        let pulley = |at_m| PulleyPlace {
            at_m,
            radius_m: 0.01,
            wrap_rad: std::f64::consts::FRAC_PI_2,
            bend_ratio: None,
        };
        let pulleys = [pulley(0.1), pulley(0.2)];
        let route = Route { pulleys: &pulleys };
        let end = route.at(300.0);
        let arc = 10.0 * std::f64::consts::FRAC_PI_2;
        assert!(end.heading.abs() < 1e-12);
        assert!(
            (end.x - (100.0 + 20.0 + (300.0 - 200.0 - arc))).abs() < 1e-9,
            "{}",
            end.x
        );
        assert!((end.y - (20.0 + (100.0 - arc))).abs() < 1e-9, "{}", end.y);
        // Path length equals rope length.
        for at in [50.0, 105.0, 150.0, 207.0, 290.0] {
            let (a, b) = (route.at(at), route.at(at + 0.01));
            assert!(
                ((a.x - b.x).hypot(a.y - b.y) / 0.01 - 1.0).abs() < 1e-6,
                "{at}"
            );
        }
    }
}
