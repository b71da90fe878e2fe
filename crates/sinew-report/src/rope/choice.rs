//! Figure of a rope selection.

use super::bracketed;
use sinew_figure::plot::{Colour, Figure, Panel, Points};
use sinew_rope::select::{Candidate, Selection, is_pareto};

/// Plots elongation over diameter and over weight, with the Pareto-optimal ropes in change of length and lifetime.
pub fn figure(selection: &Selection, time: &str) -> Figure {
    let panel = |label: &str, x: &dyn Fn(&Candidate) -> Option<f64>| {
        let mut panel = Panel::new("", label, format!("elongation after {time} (mm)"));
        let candidates = selection.candidates.iter();
        let points: Vec<_> = candidates.map(|c| (x(c), c.objectives())).collect();
        let positions = || points.iter().filter_map(|p| p.0);
        let low = positions().reduce(f64::min)?;
        let high = positions().reduce(f64::max)?;
        let room = (0.15 * (high - low)).max(0.1 * high);
        let (left, right) = (low - room, high + 2.5 * room);
        let tick = 0.008 * (right - left);
        let mut best = Points::new("Pareto-optimal", Vec::new(), Vec::new());
        let mut dominated = Points::new("dominated", Vec::new(), Vec::new()).colour(Colour::Grey);
        for (i, c) in selection.candidates.iter().enumerate() {
            let Some(at) = x(c) else { continue };
            // Ropes of equal size are drawn side by side.
            let before = points[..i].iter().filter(|p| p.0 == Some(at)).count();
            let at = at + 3.0 * tick * before as f64;
            let e = c.elongation_m.scaled(1e3);
            panel = panel.note(at + 1.5 * tick, e.value, c.rope.clone());
            let own = match is_pareto(&points, i) {
                true => &mut best,
                false => &mut dominated,
            };
            own.x.push(at);
            own.y.push(e.value);
            own.low.push(e.low);
            own.high.push(e.high);
            own.labels.push(c.rope.clone());
        }
        panel = panel.points(best.size(8.0)).points(dominated.size(6.0));
        Some(panel.x_range(left, right))
    };
    let mut figure = Figure::new("Ropes for this duty")
        .subtitle(format!("{}; bars: 95 % intervals", selection.duty))
        .seen(seen(selection, time))
        .size(820.0, 860.0);
    for panel in [
        panel("rope diameter (mm)", &|c| c.diameter_m.map(|m| 1e3 * m)),
        panel("weight (g/m), where published", &|c| {
            c.weight_kg_per_m.map(|kg| 1e3 * kg)
        }),
    ]
    .into_iter()
    .flatten()
    {
        figure = figure.panel(panel);
    }
    figure
}

/// Describes the figure for screen readers.
fn seen(selection: &Selection, time: &str) -> String {
    let of = |c: &Candidate| {
        let mm = bracketed(c.elongation_m.scaled(1e3), 2);
        format!("{} by {mm} mm", c.rope)
    };
    let all: Vec<String> = selection.candidates.iter().map(of).collect();
    format!(
        "Elongation after {time}, with 95 % intervals: {}",
        all.join(", ")
    )
}
