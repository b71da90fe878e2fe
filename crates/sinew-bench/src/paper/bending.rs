//! Common part of figs. 4 and 5: the rope on the virtual bench, in every draw.

use super::PaperError;
use super::assessment::{assumptions, curve};
use super::data::{FigureName, PanelData, PaperFigure};
use rayon::prelude::*;
use sinew_figure::plot::{Colour, Figure, Panel};
use sinew_rope::bench::routings::{self, Geometry};
use sinew_rope::bench::{Bench, Simulated, simulate};
use sinew_rope::law::Law;

/// The rope of the paper's bending tests.
pub(super) const ROPE: &str = "liros-dc000-0301";
/// Diameter of the rope, m.
pub(super) const ROPE_M: Option<f64> = Some(1.5e-3);

/// Bending case of the paper.
pub(super) fn bench(name: &str) -> Result<Bench, PaperError> {
    routings::paper(name).ok_or_else(|| PaperError::Rope(name.to_string()))
}

/// Every law's run of one case.
pub(super) fn runs(laws: &[Law], name: &str, every_s: f64) -> Result<Vec<Simulated>, PaperError> {
    let bench = bench(name)?;
    laws.par_iter()
        .map(|law| simulate(law, &bench, ROPE_M, every_s))
        .collect::<Vec<_>>()
        .into_iter()
        .map(|r| r.map_err(PaperError::from))
        .collect()
}

/// Final strain, %.
pub(super) fn end(run: &Simulated) -> f64 {
    run.strain_percent.last().copied().unwrap_or(f64::NAN)
}

pub(super) fn geometry() -> Vec<String> {
    let wraps = |i: usize| {
        Geometry::AS_READ.wraps_deg[i]
            .map(|deg| format!("{deg:.0}"))
            .join("/")
    };
    vec![
        "\"Liros SK99\" is assumed to be DC000-0301 (1.5 mm): the paper names two ropes of that fibre.".into(),
        format!(
            "The drawing of Fig. 3 was not available. Geometry as we read the words: strands of {:.0} mm, three guiding pulleys of {:.0} mm radius on both, wraps of {} ° in (B), {} ° in (C) and {} ° in (D); one sinusoid takes {} s. `fig3` draws it with its ranges, and a bench file replaces it.",
            1e3 * routings::STRAND_M,
            1e3 * routings::RADIUS_M,
            wraps(0),
            wraps(1),
            wraps(2),
            routings::PERIOD_S
        ),
        "The camera's half-millimetre scale is not modelled: it does not resolve differences below 0.1 mm (0.017 % of a strand).".into(),
    ]
}

/// Curves of all cases.
pub(super) fn drawn(
    name: FigureName,
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
        // The same rope is drawn for all: bands would hide the correlation of the routings.
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
        panels: vec![PanelData {
            title: title.into(),
            series,
        }],
        assumptions,
        ..PaperFigure::new(
            name,
            title,
            Figure::new(title)
                .subtitle(format!("simulated: Liros DC000-0301 at 23 °C{band}"))
                .size(900.0, 460.0)
                .panel(panel.x_range(0.0, last)),
        )
    }
}
