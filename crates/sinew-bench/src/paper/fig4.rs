//! Fig. 4: a rope over guiding pulleys.

use super::PaperError;
use super::assessment::{assessed, claimed, laws};
use super::bending::{ROPE, bench, drawn, end, runs};
use super::data::{FigureName, PaperFigure, given, not_assessed};
use super::sentence::{Sentence, Verdict};
use sinew_figure::Table;
use sinew_rope::Catalogue;
use sinew_rope::bench::Simulated;
use sinew_rope::law::routing::portions;
use sinew_rope::law::{Law, Parameter};

const NAMES: [&str; 4] = ["A", "B", "C", "D"];
/// Readings of the curves drawn, s.
const INTERVAL_S: f64 = 60.0;
/// Sampling interval of the draws over four hours, s; the end and the slope of the last hour are assessed.
const SAMPLING_INTERVAL_S: f64 = 1200.0;

/// Fig. 4: the four routings.
///
/// # Errors
/// [`PaperError`].
pub fn fig4(catalogue: &Catalogue) -> Result<PaperFigure, PaperError> {
    let laws = laws(catalogue, ROPE)?;
    let cases = Cases::of(&laws)?;
    let ends: Vec<String> = NAMES
        .iter()
        .zip(&cases.0)
        .map(|(n, r)| format!("({n}) {:.3} %", end(&r[0])))
        .collect();
    let titles = [
        "(A) no guiding pulley",
        "(B) three, wide apart",
        "(C) one, more than 180°",
        "(D) three, close",
    ];
    let curves = NAMES
        .iter()
        .map(|name| runs(&laws[..1], name, INTERVAL_S))
        .collect::<Result<Vec<_>, _>>()?;
    let title = "Fig. 4: elongation over guiding pulleys";
    let mut out = drawn(FigureName::Fig4, title, &titles, &curves);
    out.sentences = cases.sentences();
    out.tables = vec![choices(&laws, &cases)?, passes()?];
    out.not_assessed = not_assessed(&[
        [
            "The elongation is measured at the carriage, by camera on a half-millimetre scale.",
            "A procedure. The virtual bench measures without error; the scale does not resolve differences below 0.1 mm (0.017 % of a strand). `sinew bench read-camera` reads such pictures.",
        ],
        [
            "In (C) distinct portions of the rope are stressed.",
            "Geometry, not a result: fig4 lists the length that passes each number of pulleys.",
        ],
        [
            "Each case was run twice.",
            "The creep law has no scatter between specimens.",
        ],
    ]);
    out.given = given(&[
        "The final elongations are in the order A < C < D < B; no size is given.",
        "200 N on the carriage, about 100 mm of rope unrolled, 240 min; (C) is wrapped more than 180°.",
    ]);
    out.about = vec![format!(
        "Virtual bench: a motor on a carriage pulled with 200 N unrolls 100 mm of rope back and forth for 240 min. Final strains at the catalogue's values: {}.",
        ends.join(", ")
    )];
    Ok(out)
}

/// Every law's run of the four routings.
#[derive(Clone)]
struct Cases([Vec<Simulated>; 4]);

impl Cases {
    fn of(laws: &[Law]) -> Result<Self, PaperError> {
        let run = |name| runs(laws, name, SAMPLING_INTERVAL_S);
        Ok(Self([run("A")?, run("B")?, run("C")?, run("D")?]))
    }

    fn end(&self, case: usize, i: usize) -> f64 {
        end(&self.0[case][i])
    }

    fn a_below_c(&self, i: usize) -> bool {
        self.end(0, i) < self.end(2, i)
    }

    fn c_below_d(&self, i: usize) -> bool {
        self.end(2, i) < self.end(3, i)
    }

    fn d_below_b(&self, i: usize) -> bool {
        self.end(3, i) < self.end(1, i)
    }

    fn ordered(&self, i: usize) -> bool {
        self.a_below_c(i) && self.c_below_d(i) && self.d_below_b(i)
    }

    fn saturates(&self, i: usize) -> bool {
        self.0.iter().all(|runs| saturates(&runs[i]))
    }

    fn verdicts(&self) -> Vec<Verdict> {
        let sentences = self.sentences();
        sentences.iter().map(|s| s.verdict).collect()
    }

    fn sentences(&self) -> Vec<Sentence> {
        vec![
            claimed(
                "Order of the final elongation: A < C < D < B.",
                "final strains of the same rope on the four routings are in this order",
                |i| self.ordered(i),
            ),
            assessed(
                "Of the order, A < C.",
                "final strains. In the creep law every guiding pulley adds elongation, so that this part cannot fail",
                |i| self.a_below_c(i),
            ),
            assessed(
                "Of the order, C < D.",
                "final strains: one long contact compared with a section that passes three pulleys",
                |i| self.c_below_d(i),
            ),
            assessed(
                "Of the order, D < B.",
                "final strains: a short section that passes three pulleys compared with three that pass one each",
                |i| self.d_below_b(i),
            ),
            claimed(
                "All of A to D saturate.",
                "each gains in the last of four hours at most 3 % of its final strain, and at most a third of what it gained in the second hour (0.42 would be creep with the logarithm of time, which never ends)",
                |i| self.saturates(i),
            ),
        ]
    }
}

/// Whether the elongation of a run of four hours saturates.
fn saturates(run: &Simulated) -> bool {
    let at = |hours: f64| {
        let last = run.time_s.partition_point(|t| *t <= 3600.0 * hours + 1e-6);
        run.strain_percent[last.saturating_sub(1)]
    };
    let (second, fourth) = (at(2.0) - at(1.0), at(4.0) - at(3.0));
    fourth <= 0.03 * at(4.0) && fourth <= second / 3.0
}

/// Effect of the choice of `q` and of friction on the verdicts: shares of the draws in which they hold, with one
/// value fixed in all of them.
fn choices(laws: &[Law], cases: &Cases) -> Result<Table, PaperError> {
    let mut rows = vec![row("as in the catalogue", cases)];
    for q in [0.4, 0.6, 0.8, 1.0, 1.2] {
        let held = held(laws, Parameter::PassExponent, q)?;
        let mut varied = cases.clone();
        // One pass counts once whatever q is: only (D) has portions with more.
        varied.0[3] = runs(&held, "D", SAMPLING_INTERVAL_S)?;
        rows.push(row(&format!("q = {q} in all draws"), &varied));
    }
    let frictionless = Cases::of(&held(laws, Parameter::Friction, 0.0)?)?;
    rows.push(row("μ = 0 in all draws", &frictionless));
    let friction = match frictionless.verdicts() == cases.verdicts() {
        true => "Friction of the rope on its guides changes no verdict",
        false => "Friction of the rope on its guides changes a verdict",
    };
    let head = [
        "with",
        "A < C < D < B, %",
        "A < C, %",
        "C < D, %",
        "D < B, %",
        "all saturate, %",
    ];
    Ok(Table::new(&head, rows).captioned(format!(
        "Choices and their effect: the share of the draws in which the statement holds. q, the exponent for several pulleys over one section, was chosen to reproduce the order; it was not measured. {friction}"
    )))
}

/// The laws with one parameter at a value.
fn held(laws: &[Law], parameter: Parameter, value: f64) -> Result<Vec<Law>, PaperError> {
    laws.iter()
        .map(|law| {
            let mut parameters = *law.parameters();
            parameters.set(parameter, value);
            Law::new(parameters).map_err(|e| PaperError::Rope(e.to_string()))
        })
        .collect()
}

fn row(name: &str, cases: &Cases) -> Vec<String> {
    let share = |holds: &dyn Fn(usize) -> bool| {
        let draws = 1..cases.0[0].len();
        let held = draws.clone().filter(|i| holds(*i)).count();
        format!("{:.0}", 100.0 * held as f64 / draws.len().max(1) as f64)
    };
    vec![
        name.into(),
        share(&|i| cases.ordered(i)),
        share(&|i| cases.a_below_c(i)),
        share(&|i| cases.c_below_d(i)),
        share(&|i| cases.d_below_b(i)),
        share(&|i| cases.saturates(i)),
    ]
}

/// Returns the length of the guided strand that passes each number of pulleys.
fn passes() -> Result<Table, PaperError> {
    let mut rows = Vec::new();
    for name in NAMES {
        let bench = bench(name)?;
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
