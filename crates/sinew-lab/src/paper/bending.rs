//! Figs. 4 and 5: a rope on the bench, over guiding pulleys and under changing force.

use super::judge::{assumptions, curve, judged, laws, slope};
use super::{PanelData, PaperError, PaperFigure};
use crate::bench::{Simulated, routings, simulate};
use crate::plot::{Colour, Figure, Panel};
use crate::rope::Catalogue;
use crate::rope::predict::in_parallel;

/// The rope of the paper's bending tests.
const ROPE: &str = "liros-dc000-0301";
/// Readings of the curves drawn, s.
const INTERVAL_S: f64 = 300.0;
/// Readings of the draws over four hours, s: the end and the slope of the last hour are judged.
const JUDGED_INTERVAL_S: f64 = 1200.0;
/// Readings under changing force, s.
const SHORT_INTERVAL_S: f64 = 60.0;

/// Every draw's run of one case, nominal first.
fn runs(catalogue: &Catalogue, name: &str, every_s: f64) -> Result<Vec<Simulated>, PaperError> {
    let bench = routings::paper(name).ok_or_else(|| PaperError::Rope(name.to_string()))?;
    let laws = laws(catalogue, ROPE)?;
    in_parallel(&laws, |law| simulate(law, &bench, every_s))
        .into_iter()
        .map(|r| r.map_err(PaperError::from))
        .collect()
}

fn end(run: &Simulated) -> f64 {
    run.strain_percent.last().copied().unwrap_or(f64::NAN)
}

fn geometry() -> Vec<String> {
    vec![
        "\"Liros SK99\" is taken to be DC000-0301 (1.5 mm): the paper names two ropes of that fibre.".into(),
        format!(
            "Geometry the paper doesn't state: strands of {:.0} mm, guiding pulleys of {:.0} mm radius on one of them, small wrap {} °, wrap of (C) {} °, pulleys {:.0} mm apart in (B) and {:.0} mm in (D); one sinusoid takes {} s.",
            1e3 * routings::STRAND_M,
            1e3 * routings::RADIUS_M,
            routings::SMALL_WRAP_DEG,
            routings::LARGE_WRAP_DEG,
            1e3 * routings::WIDE_M,
            1e3 * routings::CLOSE_M,
            routings::PERIOD_S
        ),
        "The camera's half-millimetre scale is not in this: differences below 0.1 mm (0.017 % of a strand) would not be seen with it.".into(),
    ]
}

/// Fig. 4: the four routings.
///
/// # Errors
/// [`PaperError`].
pub fn fig4(catalogue: &Catalogue) -> Result<PaperFigure, PaperError> {
    const NAMES: [&str; 4] = ["A", "B", "C", "D"];
    let cases = NAMES
        .into_iter()
        .map(|name| runs(catalogue, name, JUDGED_INTERVAL_S))
        .collect::<Result<Vec<_>, _>>()?;
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| &cases[i]);
    let saturates = |run: &Simulated| {
        let minutes: Vec<f64> = run.time_s.iter().map(|t| t / 60.0).collect();
        let per_hour = 60.0 * slope(&minutes, &run.strain_percent, 180.0);
        per_hour <= 0.03 * end(run)
    };
    let sentences = vec![
        judged(
            "order of final elongation: A < C < D < B",
            "final strains of the same rope on the four routings are in this order",
            |i| {
                let e = |runs: &[Simulated]| end(&runs[i]);
                e(a) < e(c) && e(c) < e(d) && e(d) < e(b)
            },
        ),
        judged(
            "every guiding pulley costs elongation: A is the least",
            "the final strain of A is below that of B, C and D",
            |i| [b, c, d].iter().all(|r| end(&a[i]) < end(&r[i])),
        ),
        judged(
            "all saturate",
            "in the last of four hours each gains at most 3 % of its final strain",
            |i| [a, b, c, d].iter().all(|r| saturates(&r[i])),
        ),
    ];
    let titles = [
        "(A) no guiding pulley",
        "(B) three, wide apart",
        "(C) one, more than 180°",
        "(D) three, close",
    ];
    let ends: Vec<String> = NAMES
        .iter()
        .zip(&cases)
        .map(|(n, r)| format!("({n}) {:.3} %", end(&r[0])))
        .collect();
    let nominal = laws(catalogue, ROPE)?[0];
    let mut curves = Vec::with_capacity(NAMES.len());
    for name in NAMES {
        let bench = routings::paper(name).ok_or_else(|| PaperError::Rope(name.to_string()))?;
        curves.push(vec![simulate(&nominal, &bench, INTERVAL_S)?]);
    }
    let title = "Fig. 4: elongation over guiding pulleys";
    let mut out = drawn("fig4", title, &titles, &curves);
    out.sentences = sentences;
    out.about = vec![format!(
        "Virtual bench: a motor on a carriage pulled with 200 N unrolls 100 mm of rope back and forth for 240 min. Final strains at the catalogue's values: {}.",
        ends.join(", ")
    )];
    Ok(out)
}

/// Fig. 5: the force changes after 80 min.
///
/// # Errors
/// [`PaperError`].
pub fn fig5(catalogue: &Catalogue) -> Result<PaperFigure, PaperError> {
    let cases = ["E", "F"]
        .into_iter()
        .map(|name| runs(catalogue, name, SHORT_INTERVAL_S))
        .collect::<Result<Vec<_>, _>>()?;
    let (e, f) = (&cases[0], &cases[1]);
    // Both are read at the same times; the change is read before and after.
    let after = e[0]
        .force_n
        .iter()
        .position(|n| *n != e[0].force_n[0])
        .unwrap_or(1);
    let at = |run: &Simulated, k: usize| run.strain_percent[k];
    let sentences = vec![
        judged(
            "(E) 200 N, then 120 N: the elongation drops",
            "strain falls at the change and is lower still at the end",
            |i| at(&e[i], after) < at(&e[i], after - 1) && end(&e[i]) < at(&e[i], after),
        ),
        judged(
            "(E) a part of the elongation is irreversible",
            "after 80 min at 120 N it is still above what (F), never loaded higher, has after 80 min at 120 N",
            |i| end(&e[i]) > at(&f[i], after - 1),
        ),
        judged(
            "(F) 120 N, then 200 N: the elongation rises over a longer time",
            "of the rise after the change at least a fifth comes later than a minute after it",
            |i| {
                let rise = end(&f[i]) - at(&f[i], after - 1);
                let late = end(&f[i]) - at(&f[i], after + 1);
                rise > 0.0 && late >= 0.2 * rise
            },
        ),
    ];
    let titles = ["(E) 200 N, then 120 N", "(F) 120 N, then 200 N"];
    let mut out = drawn(
        "fig5",
        "Fig. 5: elongation under changing force",
        &titles,
        &cases,
    );
    out.sentences = sentences;
    out.about = vec![
        "Virtual bench without guiding pulleys; the force on the carriage changes after 80 min."
            .into(),
    ];
    out.assumptions
        .push("(E) and (F) have no guiding pulley, and the motor moves all the time.".into());
    Ok(out)
}

fn drawn(
    name: &'static str,
    title: &str,
    titles: &[&str],
    cases: &[Vec<Simulated>],
) -> PaperFigure {
    let mut panel = Panel::new("", "time (min)", "strain of the strands (%)");
    let mut series = Vec::new();
    let mut lines = Vec::new();
    for (i, (label, runs)) in titles.iter().zip(cases).enumerate() {
        let minutes: Vec<f64> = runs[0].time_s.iter().map(|t| t / 60.0).collect();
        let curves: Vec<Vec<f64>> = runs.iter().map(|r| r.strain_percent.clone()).collect();
        let (line, band, data) = curve(label, &minutes, &curves, Colour::CYCLE[i]);
        // The same rope is drawn for all: bands would hide that the routings move together.
        if cases.len() <= 2 {
            panel = panel.band(band);
        }
        lines.push(line);
        series.push(data);
    }
    for line in lines {
        panel = panel.line(line);
    }
    let last = cases[0][0].time_s.last().copied().unwrap_or(0.0) / 60.0;
    let band = if cases.len() <= 2 {
        "; bands: 95 % of the draws"
    } else {
        ""
    };
    let mut assumptions = assumptions();
    assumptions.extend(geometry());
    PaperFigure {
        name,
        title: title.into(),
        about: Vec::new(),
        figure: Figure::new(title)
            .subtitle(format!("simulated: Liros DC000-0301 at 23 °C{band}"))
            .size(900.0, 460.0)
            .panel(panel.x_range(0.0, last)),
        panels: vec![PanelData {
            title: title.into(),
            series,
        }],
        sentences: Vec::new(),
        assumptions,
    }
}
