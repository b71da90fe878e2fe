//! Figs. 4 and 5: a rope on the bench, over guiding pulleys and under changing force.

use super::PaperError;
use super::data::{FigureName, PanelData, PaperFigure};
use super::judge::{assumptions, curve, judged, laws};
use rayon::prelude::*;
use sinew_figure::Table;
use sinew_figure::plot::{Colour, Figure, Panel};
use sinew_model::rope::routing::portions;
use sinew_rope::Catalogue;
use sinew_rope::bench::{Simulated, routings, simulate};

/// The rope of the paper's bending tests.
const ROPE: &str = "liros-dc000-0301";
/// Readings of the curves drawn, s.
const INTERVAL_S: f64 = 60.0;
/// Readings of the draws over four hours, s: the end and the slope of the last hour are judged.
const JUDGED_INTERVAL_S: f64 = 1200.0;
/// Readings under changing force, s.
const SHORT_INTERVAL_S: f64 = 60.0;

/// Every draw's run of one case, nominal first.
fn runs(catalogue: &Catalogue, name: &str, every_s: f64) -> Result<Vec<Simulated>, PaperError> {
    let bench = routings::paper(name).ok_or_else(|| PaperError::Rope(name.to_string()))?;
    let laws = laws(catalogue, ROPE)?;
    laws.par_iter()
        .map(|law| simulate(law, &bench, every_s))
        .collect::<Vec<_>>()
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
    let cases = &cases;
    let of = |name: usize| move |i: usize| end(&cases[name][i]);
    let (a, b, c, d) = (of(0), of(1), of(2), of(3));
    let sentences = vec![
        judged(
            "order of final elongation: A < C < D < B",
            "final strains of the same rope on the four routings are in this order",
            |i| a(i) < c(i) && c(i) < d(i) && d(i) < b(i),
        ),
        judged(
            "(of that) A < C",
            "final strains. The law has every guiding pulley cost elongation, so that this link can't fail",
            |i| a(i) < c(i),
        ),
        judged(
            "(of that) C < D",
            "final strains: one long contact against a portion that passes three pulleys",
            |i| c(i) < d(i),
        ),
        judged(
            "(of that) D < B",
            "final strains: a short portion that passes three pulleys against three that pass one each",
            |i| d(i) < b(i),
        ),
        judged(
            "all saturate",
            "each gains in the last of four hours at most 3 % of its final strain, and at most a third of what it gained in the second hour (0.42 would be creep with the logarithm of time, which never ends)",
            |i| cases.iter().all(|runs| saturates(&runs[i])),
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
        .zip(cases)
        .map(|(n, r)| format!("({n}) {:.3} %", end(&r[0])))
        .collect();
    let nominal = laws(catalogue, ROPE)?[0];
    let mut curves = Vec::with_capacity(NAMES.len());
    for name in NAMES {
        let bench = routings::paper(name).ok_or_else(|| PaperError::Rope(name.to_string()))?;
        curves.push(vec![simulate(&nominal, &bench, INTERVAL_S)?]);
    }
    let title = "Fig. 4: elongation over guiding pulleys";
    let mut out = drawn(FigureName::Fig4, title, &titles, &curves);
    out.sentences = sentences;
    out.tables.push(passes()?);
    out.not_judged.push("Each case was run twice: the law has no scatter from specimen to specimen, so that nothing can be said of repeatability.".into());
    out.not_judged.push(
        "That the stressed portions of (C) are distinct is geometry, not a result: see the table."
            .into(),
    );
    out.about = vec![format!(
        "Virtual bench: a motor on a carriage pulled with 200 N unrolls 100 mm of rope back and forth for 240 min. Final strains at the catalogue's values: {}.",
        ends.join(", ")
    )];
    Ok(out)
}

/// Whether a run over four hours has come to rest.
fn saturates(run: &Simulated) -> bool {
    let at = |hours: f64| {
        let last = run.time_s.partition_point(|t| *t <= 3600.0 * hours + 1e-6);
        run.strain_percent[last.saturating_sub(1)]
    };
    let (second, fourth) = (at(2.0) - at(1.0), at(4.0) - at(3.0));
    fourth <= 0.03 * at(4.0) && fourth <= second / 3.0
}

/// Which length of the guided strand passes how many pulleys.
fn passes() -> Result<Table, PaperError> {
    let mut rows = Vec::new();
    for name in ["A", "B", "C", "D"] {
        let bench = routings::paper(name).ok_or_else(|| PaperError::Rope(name.into()))?;
        let pulleys = &bench.strands[0].pulleys;
        let mut length_mm = [0.0; 4];
        let portions = portions(bench.strand_m, bench.stroke_m, pulleys)
            .map_err(|e| PaperError::Rope(format!("{name}: {e}")))?;
        for p in portions {
            length_mm[p.guides.min(3)] += 1e3 * p.length_m;
        }
        let mut row = vec![format!("({name})")];
        row.push(pulleys.len().to_string());
        row.push(
            pulleys
                .first()
                .map_or_else(|| "–".into(), |p| format!("{:.0}", p.wrap_rad.to_degrees())),
        );
        row.extend(length_mm.iter().map(|mm| format!("{mm:.0}")));
        rows.push(row);
    }
    let head = [
        "case",
        "pulleys",
        "wrap, °",
        "mm over none",
        "over one",
        "over two",
        "over three",
    ];
    Ok(Table::new(&head, rows).captioned(
        "Length of the guided strand by the number of pulleys that a stroke takes it over",
    ))
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
    let kept = kept(catalogue)?;
    // Minutes from the change until 90 % of what changes has changed.
    let slow = |run: &Simulated| {
        let (from, to) = (at(run, after - 1), end(run));
        let there = |k: &usize| (at(run, *k) - from) / (to - from) >= 0.9;
        let k = (after..run.time_s.len()).find(there).unwrap_or(after);
        (run.time_s[k] - run.time_s[after]) / 60.0
    };
    let sentences = vec![
        judged(
            "(E) 200 N, then 120 N: the elongation drops",
            "strain falls at the change and is lower still at the end",
            |i| at(&e[i], after) < at(&e[i], after - 1) && end(&e[i]) < at(&e[i], after),
        ),
        judged(
            "(E) a part of the elongation is irreversible",
            "left at 120 N for 115 days, until everything delayed has come back, it stays above a rope that never felt more, by at least a tenth of what it lost in the 80 min after the change",
            |i| kept[i] >= 0.1 * (at(&e[i], after - 1) - end(&e[i])),
        ),
        judged(
            "(F) 120 N, then 200 N: the elongation rises over a longer time",
            "it rises, and 90 % of the rise take at least twice as long as 90 % of the drop of (E), and a minute at least",
            |i| {
                let rises = end(&f[i]) > at(&f[i], after - 1);
                rises && slow(&f[i]) >= (2.0 * slow(&e[i])).max(1.0)
            },
        ),
    ];
    let titles = ["(E) 200 N, then 120 N", "(F) 120 N, then 200 N"];
    let mut out = drawn(
        FigureName::Fig5,
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

/// Strain that (E) keeps over a rope that was at 120 N all the time, 115 days on, in every draw.
fn kept(catalogue: &Catalogue) -> Result<Vec<f64>, PaperError> {
    const LONG_S: f64 = 1e7;
    let mut high = routings::paper("E").ok_or_else(|| PaperError::Rope("E".into()))?;
    let last = high.phases.len() - 1;
    high.phases[last].duration_s = LONG_S;
    let mut low = high.clone();
    for phase in &mut low.phases {
        phase.force_n = high.phases[last].force_n;
    }
    laws(catalogue, ROPE)?
        .par_iter()
        .map(|law| {
            let end_of = |bench| simulate(law, bench, LONG_S).map(|run| end(&run));
            Ok(end_of(&high)? - end_of(&low)?)
        })
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}

fn drawn(name: FigureName, title: &str, titles: &[&str], cases: &[Vec<Simulated>]) -> PaperFigure {
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
