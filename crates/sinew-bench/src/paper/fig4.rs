//! Fig. 4: a rope over guiding pulleys.

use super::PaperError;
use super::assessment::{SEED, laws};
use super::bending::{ROPE, bench, drawn, end, runs};
use super::data::{FigureName, PaperFigure, given, not_assessed};
use super::sentence::{Basis, Sentence, Unit, Verdict};
use sinew_figure::Table;
use sinew_figure::plot::{Band, Colour};
use sinew_model::QUANTILE_975;
use sinew_rope::Catalogue;
use sinew_rope::bench::alternatives::{
    COSTS, DRIVERS, Explored, ROUTINGS, SCATTER, Specimens, explore, specimens,
};
use sinew_rope::bench::{Driver, Simulated};
use sinew_rope::law::routing::portions;

/// Number of alternatives drawn; a share of 6 % has a standard error of 0.5 %.
const ALTERNATIVES: usize = 2000;
/// Readings of the curves drawn, s.
const INTERVAL_S: f64 = 60.0;
/// Scatter of one specimen in the bands, share of its elongation; the middle of [`SCATTER`].
const BAND_SCATTER: f64 = SCATTER[1];
/// Share of the orders of four routings that one of them is.
const CHANCE: f64 = 1.0 / 24.0;

/// Fig. 4: the four routings.
///
/// # Errors
/// [`PaperError`].
pub fn fig4(catalogue: &Catalogue) -> Result<PaperFigure, PaperError> {
    let laws = laws(catalogue, ROPE)?;
    let all = explore(catalogue.find(ROPE)?, ALTERNATIVES, SEED)?;
    let curves = ROUTINGS
        .iter()
        .map(|name| runs(&laws[..1], name, INTERVAL_S))
        .collect::<Result<Vec<_>, _>>()?;
    let ends: Vec<String> = ROUTINGS
        .iter()
        .zip(&curves)
        .map(|(n, r)| format!("({n}) {:.3} %", end(&r[0])))
        .collect();
    let titles = [
        "(A) no guiding pulley",
        "(B) three, wide apart",
        "(C) three, one wrapped more than 180°",
        "(D) three, close",
    ];
    let title = "Fig. 4: elongation over guiding pulleys";
    let mut out = drawn(FigureName::Fig4, title, &titles, &curves);
    draw_bands(&mut out, &curves);
    let ordered = Share::of(&all, Explored::is_ordered);
    let b_highest = Share::of(&all, Explored::is_b_highest);
    out.sentences = sentences(&all, &curves, ordered, b_highest);
    out.tables = vec![
        explanation(b_highest),
        orders(&all),
        scatter(&all),
        passes()?,
    ];
    out.not_assessed = not_assessed(&[
        [
            "The elongation is measured at the carriage, by camera on a half-millimetre scale.",
            "A procedure. The virtual bench measures without error; the scale does not resolve differences below 0.1 mm (0.017 % of a strand). `sinew bench read-camera` reads such pictures.",
        ],
        [
            "In (C) distinct portions of the rope are stressed.",
            "Geometry, not a result: fig4 lists the length by its number of passes.",
        ],
        [
            "Each case was run twice.",
            "A procedure. The bands and the table of specimens assume a scatter between ropes; whether the two curves of a routing lie apart from the others would show more than the order.",
        ],
    ]);
    out.given = given(&[
        "The final elongations are in the order A < C < D < B; no size is given.",
        "200 N on the carriage, about 100 mm of rope unrolled, 240 min, each routing twice; one pulley of (C) is wrapped more than 180°.",
    ]);
    out.assumptions.extend([
        format!("Each of the {} draws has its own geometry, friction of rope on guide (log-uniform, 0.02 to 0.2), cost of a pass, tension that drives the bedding-in and exponent q (uniform, 0.2 to 1.2), besides the rope's parameters; the catalogue's q was chosen to reproduce the order, so it cannot serve here. One or both strands are guided with equal probability. The share of draws in an order describes these assumptions and is no evidence for the order.", all.len()),
        format!("Bands: 95 % of single specimens with an assumed scatter of {:.0} % of the elongation. No scatter of these ropes is published.", 100.0 * BAND_SCATTER),
        "Rope heated by friction and flattening on the pulleys are not modelled. If the paper's elongation is in millimetres, the longer rope of (C) outweighs the differences between the routings.".into(),
    ]);
    out.about = vec![
        format!(
            "Virtual bench: a motor on a carriage pulled with 200 N unrolls 100 mm of rope back and forth for 240 min. Final strains at the catalogue's values: {}.",
            ends.join(", ")
        ),
        format!(
            "The paper found A < C < D < B. In this model the order appears in {ordered} of the draws, and B is highest in {b_highest}; chance alone gives {:.0} %. The order needs pulleys with a friction above about 0.06, a cost of a pass that hardly depends on the wrap, and guides on both strands. Friction heat or scatter between ropes could cause it as well. The cause is not determined.",
            100.0 * CHANCE
        ),
    ];
    Ok(out)
}

/// Share of draws; never printed as 0 or 100 %.
#[derive(Clone, Copy)]
struct Share(f64);

impl Share {
    fn of<'a>(
        draws: impl IntoIterator<Item = &'a Explored>,
        holds: impl Fn(&Explored) -> bool,
    ) -> Self {
        let (mut count, mut held) = (0usize, 0usize);
        for draw in draws {
            count += 1;
            held += usize::from(holds(draw));
        }
        Self(held as f64 / count.max(1) as f64)
    }
}

impl std::fmt::Display for Share {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match 100.0 * self.0 {
            p if p < 1.0 => f.write_str("< 1 %"),
            p if p > 99.0 => f.write_str("> 99 %"),
            p => write!(f, "{p:.0} %"),
        }
    }
}

/// Adds the 95 % band of single specimens to each curve.
fn draw_bands(figure: &mut PaperFigure, curves: &[Vec<Simulated>]) {
    let half = QUANTILE_975 * BAND_SCATTER;
    let Some(mut panel) = figure.figure.panels.pop() else {
        return;
    };
    let lines = std::mem::take(&mut panel.series);
    for (i, runs) in curves.iter().enumerate() {
        let minutes: Vec<f64> = runs[0].time_s.iter().map(|t| t / 60.0).collect();
        let times = |factor: f64| {
            let strains = runs[0].strain_percent.iter();
            strains.map(|e| factor * e).collect::<Vec<f64>>()
        };
        let (low, high) = (times(1.0 - half), times(1.0 + half));
        panel = panel.band(Band::new("", minutes, low, high).colour(Colour::CYCLE[i]));
    }
    panel.series.extend(lines);
    figure.figure.panels.push(panel);
    figure.figure.subtitle += &format!(
        "; bands: 95 % of single specimens at an assumed scatter of {:.0} %",
        100.0 * BAND_SCATTER
    );
}

fn sentences(
    all: &[Explored],
    curves: &[Vec<Simulated>],
    ordered: Share,
    b_highest: Share,
) -> Vec<Sentence> {
    let shared = |text: &str, criterion: String, share: Share, holds: bool, verdict| Sentence {
        verdict,
        basis: Basis::AssumedParameters,
        ..Sentence::added(text, criterion, 100.0 * share.0, Unit::ShareOfCases, holds)
    };
    let ends = [0, 1, 2, 3].map(|i| end(&curves[i][0]));
    let [a, b, c, d] = ends;
    let cases = all.len();
    let order = shared(
        "Order of the final elongation: A < C < D < B.",
        format!(
            "final strains in this order; {cases} draws of what the paper leaves open. The share describes these assumptions and supports nothing: chance alone gives 4 %, and 17 % if every guided routing costs the same"
        ),
        ordered,
        a < c && c < d && d < b,
        Verdict::Open,
    );
    let highest = shared(
        "Therefore the elongation of (B) is the highest.",
        format!(
            "final strains; {cases} draws of what the paper leaves open. Chance alone gives 25 %"
        ),
        b_highest,
        b > a && b > c && b > d,
        Verdict::Open,
    );
    let saturating = Share::of(all, |draw| draw.percent.iter().all(|p| saturates(p)));
    let at_catalogue = curves.iter().all(|runs| saturates(&hourly(&runs[0])));
    let saturate = shared(
        "All of A to D saturate.",
        format!(
            "each gains in the last of four hours at most 3 % of its final strain, and at most a third of what it gained in the second hour (0.42 would be creep with the logarithm of time, which never ends); {cases} draws of what the paper leaves open"
        ),
        saturating,
        at_catalogue,
        match (at_catalogue, saturating.0 >= 0.95) {
            (true, true) => Verdict::Holds,
            (false, _) if saturating.0 <= 0.05 => Verdict::Fails,
            _ => Verdict::Open,
        },
    );
    vec![order.of_paper(), saturate.of_paper(), highest.of_paper()]
}

/// Strain at the start and after each hour, %.
fn hourly(run: &Simulated) -> Vec<f64> {
    let at = |hour: u32| {
        let last = run
            .time_s
            .partition_point(|t| *t <= 3600.0 * f64::from(hour) + 1e-6);
        run.strain_percent[last.saturating_sub(1)]
    };
    (0..=4).map(at).collect()
}

/// Whether the elongation of a run of four hours saturates, from its hourly strains.
fn saturates(percent: &[f64]) -> bool {
    match percent {
        [_, first, second, third, fourth] => {
            let (early, late) = (second - first, fourth - third);
            late <= 0.03 * fourth && late <= early / 3.0
        }
        _ => false,
    }
}

/// The paper's explanation of the order, step by step.
fn explanation(b_highest: Share) -> Table {
    /// Mean tension at the joint pulley with both strands guided, N: `100/cosh μΦ`.
    fn far_n(wrap_deg: f64, friction: f64) -> f64 {
        100.0 / (friction * wrap_deg.to_radians()).cosh()
    }
    let row = |cells: [&str; 3]| cells.map(String::from).to_vec();
    let rows = vec![
        row([
            "Friction lowers the forces behind large wraps",
            "true, closed form",
            &format!(
                "365° a strand, both strands guided: {:.0} of 100 N at μ = 0.05, {:.0} N at 0.1. With one strand guided both ends keep 100 N",
                far_n(365.0, 0.05),
                far_n(365.0, 0.1)
            ),
        ]),
        row([
            "Friction keeps the forces almost unchanged at small wraps",
            "true, closed form",
            &format!(
                "60° a strand, μ = 0.05: {:.2} N less",
                100.0 - far_n(60.0, 0.05)
            ),
        ]),
        row([
            "More passes cause more elongation",
            "true by construction",
            "in this model every pass adds to the bedding-in",
        ]),
        row([
            "Therefore (B) is highest",
            "open",
            &format!("in {b_highest} of the draws"),
        ]),
    ];
    let head = ["step of the explanation", "result", "reason"];
    Table::new(&head, rows)
        .worded(&["result", "reason"])
        .captioned("The paper's explanation of the order, step by step")
}

/// Orders by what the paper leaves open.
fn orders(all: &[Explored]) -> Table {
    let row = |name: &str, given: &dyn Fn(&Explored) -> bool| {
        let of: Vec<&Explored> = all.iter().filter(|draw| given(draw)).collect();
        let share =
            |holds: &dyn Fn(&Explored) -> bool| Share::of(of.iter().copied(), holds).to_string();
        vec![
            name.to_string(),
            of.len().to_string(),
            share(&Explored::is_ordered),
            share(&Explored::is_b_highest),
        ]
    };
    let mut rows = vec![row("all", &|_| true)];
    let costs = [
        "cost per pass",
        "cost by pressure",
        "cost by the root of the wrap",
        "cost per wrap",
    ];
    for (name, cost) in costs.into_iter().zip(COSTS) {
        let of = move |draw: &Explored| {
            let mechanism = draw.mechanism;
            mechanism.wrap_exponent == Some(cost[0]) && mechanism.tension_exponent == cost[1]
        };
        rows.push(row(name, &of));
    }
    for driver in DRIVERS {
        let name = match driver {
            Driver::Cycle => "driven through the cycle",
            Driver::Mean => "driven by the mean tension",
            Driver::Rms => "driven by the RMS tension",
            Driver::Peak => "driven by the highest tension",
        };
        rows.push(row(name, &|draw| draw.mechanism.driver == driver));
    }
    rows.push(row("both strands guided", &|d| {
        d.geometry.is_on_both_strands
    }));
    rows.push(row("one strand guided", &|d| {
        !d.geometry.is_on_both_strands
    }));
    for [low, high] in [[0.02, 0.04], [0.04, 0.06], [0.06, 0.1], [0.1, 0.2]] {
        let name = format!("μ {low} to {high}");
        let of = |draw: &Explored| {
            draw.geometry
                .friction
                .is_some_and(|mu| (low..high).contains(&mu))
        };
        rows.push(row(&name, &of));
    }
    for [low, high] in [[0.2, 0.6], [0.6, 1.0], [1.0, 1.2]] {
        let name = format!("q {low} to {high}");
        rows.push(row(&name, &|draw| {
            (low..high).contains(&draw.pass_exponent)
        }));
    }
    Table::new(
        &["of the draws with", "draws", "A < C < D < B", "B highest"],
        rows,
    )
    .captioned("Orders by what the paper leaves open. Chance alone: 4 % and 25 %")
}

/// Orders that two specimens of each routing show.
fn scatter(all: &[Explored]) -> Table {
    let ordered = all.iter().filter(|draw| draw.is_ordered());
    let ordered: Vec<[f64; 4]> = ordered.map(Explored::ends).collect();
    // (A) lowest, the guided routings equal: the median of what guides add.
    let equal: Vec<[f64; 4]> = ordered
        .iter()
        .map(|[a, _, c, _]| [*a, *c, *c, *c])
        .collect();
    let mut rows = Vec::new();
    for s in SCATTER {
        let [true_order, none] = [&ordered, &equal].map(|ends| specimens(ends, s, SEED));
        let shares = |s: Specimens| [s.means_ordered, s.pairs_apart].map(|v| Share(v).to_string());
        let mut row = vec![format!("{:.0} %", 100.0 * s)];
        row.extend(shares(true_order));
        row.extend(shares(none));
        rows.push(row);
    }
    Table::new(
        &[
            "scatter of a specimen",
            "order true: means of two in order",
            "pairs apart",
            "B, C, D equal: means of two in order",
            "pairs apart too",
        ],
        rows,
    )
    .captioned("Two specimens of each routing, by the scatter between ropes")
}

/// Returns the length of a guided strand by its number of passes.
fn passes() -> Result<Table, PaperError> {
    let mut rows = Vec::new();
    for name in ROUTINGS {
        let bench = bench(name)?;
        let pulleys = &bench.strands[0].pulleys;
        let mut length_mm = [0.0; 4];
        let portions = portions(bench.strand_m, bench.stroke_m, pulleys)
            .map_err(|e| PaperError::Rope(format!("{name}: {e}")))?;
        for p in portions {
            let column = match p.passes {
                n if n <= 0.0 => 0,
                n if n < 1.0 => 1,
                n if n <= 1.0 => 2,
                _ => 3,
            };
            length_mm[column] += 1e3 * p.length_m;
        }
        let wraps: Vec<String> = pulleys
            .iter()
            .map(|p| format!("{:.0}", p.wrap_rad.to_degrees()))
            .collect();
        let mut row = vec![format!("({name})"), wraps.join("/")];
        row.extend(length_mm.iter().map(|mm| format!("{mm:.0}")));
        rows.push(row);
    }
    let head = [
        "case",
        "wraps, °",
        "mm without a pass",
        "half a pass",
        "one",
        "more than one",
    ];
    Ok(Table::new(&head, rows).captioned(
        "Length of a guided strand by its passes over pulleys; crossing the entry or the exit line counts half",
    ))
}
