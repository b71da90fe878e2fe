//! Figs. 1 and 2: tensile creep of the ropes at 23 and at 60 °C.

use super::PaperError;
use super::assessment::{assumptions, claimed, curve, laws, slope};
use super::data::{FigureName, PanelData, PaperFigure, SeriesData, given, not_assessed};
use super::sentence::Sentence;
use rayon::prelude::*;
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel};
use sinew_rope::Catalogue;
use sinew_rope::law::{Law, RopeLoad, State};

/// Load of the tests, N.
pub(super) const LOAD_N: f64 = 60.0;
/// Free length of the specimens, mm.
pub(super) const LENGTH_MM: f64 = 350.0;
/// Length of the tests, min.
pub(super) const MINUTES: usize = 85;
/// The straight line `m_E` begins here, min.
pub(super) const SLOPE_FROM_MIN: f64 = 20.0;

const ULTRA: &str = "gottifredi-maffioli-sk99-ultra";
const CORD: &str = "liros-aramid-braided-cord";
const SK99: &str = "liros-dc000-0301";
const CLIMAX: &str = "ockert-climax-combat";
const DM20: &str = "teufelberger-fl-32-ng";
const TECHNORA: &str = "tu-chemnitz-technora-black";
const VECTRAN: &str = "tu-chemnitz-vectran";
/// Ropes under 2 mm.
const THIN: [&str; 5] = [SK99, CLIMAX, DM20, TECHNORA, VECTRAN];
/// HMPE ropes under 2 mm; their breaking loads differ by a factor of two.
const THIN_HMPE: [&str; 3] = [SK99, CLIMAX, DM20];
/// HMPE ropes of 2 mm, braided differently; their breaking loads are within a quarter of each other.
const THICK_HMPE: [&str; 3] = [ULTRA, "liros-dc000-0701", "teufelberger-fl-9-ng"];
/// Ropes of Fig. 2.
const HOT: [&str; 4] = [DM20, SK99, TECHNORA, VECTRAN];

/// A rope's tests: by draw, nominal first.
pub(super) struct Test {
    pub(super) name: String,
    pub(super) product: String,
    pub(super) curves: Vec<Vec<f64>>,
    /// Strain at the end, %.
    pub(super) end: Vec<f64>,
    /// Creep rate at the end `m_E`, %/h.
    pub(super) slope: Vec<f64>,
    /// Ratio of the slope in the last 20 min to the slope from 20 to 40 min.
    pub(super) slope_left: Vec<f64>,
}

pub(super) fn minutes() -> Vec<f64> {
    (0..=MINUTES).map(|m| m as f64).collect()
}

/// Strain at every minute of a test, %. The first reading is right after loading.
fn strain(law: &Law, load: RopeLoad) -> Result<Vec<f64>, PaperError> {
    let mut state = State::default();
    let rates = law.rates(load)?;
    let mut out = Vec::with_capacity(MINUTES + 1);
    for minute in 0..=MINUTES {
        if minute > 0 {
            law.advance(&mut state, &rates, 60.0)?;
        }
        // The specimen is measured and zeroed at the temperature of its test.
        let strain = law.strain(&state, load)?;
        out.push(strain.total_percent() - strain.thermal_percent);
    }
    Ok(out)
}

pub(super) fn test(
    catalogue: &Catalogue,
    name: &str,
    temperature_c: f64,
) -> Result<Test, PaperError> {
    let load = RopeLoad::celsius(LOAD_N, temperature_c);
    let laws = laws(catalogue, name)?;
    let curves = laws
        .par_iter()
        .map(|law| strain(law, load))
        .collect::<Vec<_>>()
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    let minutes = minutes();
    const END: f64 = MINUTES as f64;
    let entry = &catalogue.find(name)?.entry;
    Ok(Test {
        name: name.into(),
        product: format!("{} {}", entry.manufacturer, entry.product),
        end: curves.iter().map(|c| c[MINUTES]).collect(),
        slope: curves
            .iter()
            .map(|c| 60.0 * slope(&minutes, c, SLOPE_FROM_MIN..=END))
            .collect(),
        slope_left: curves
            .iter()
            .map(|c| {
                let early = slope(&minutes, c, SLOPE_FROM_MIN..=SLOPE_FROM_MIN + 20.0);
                slope(&minutes, c, END - 20.0..=END) / early
            })
            .collect(),
        curves,
    })
}

fn find<'a>(tests: &'a [Test], name: &str) -> Result<&'a Test, PaperError> {
    tests
        .iter()
        .find(|t| t.name == name)
        .ok_or_else(|| PaperError::Rope(name.to_string()))
}

/// Fig. 1: all nine ropes at 23 °C.
///
/// # Errors
/// [`PaperError`] when the catalogue lacks a rope of Table I or its law.
pub fn fig1(catalogue: &Catalogue) -> Result<PaperFigure, PaperError> {
    let tests = Catalogue::paper()?
        .names()
        .iter()
        .map(|name| test(catalogue, name, 23.0))
        .collect::<Result<Vec<_>, _>>()?;
    let at = |name| find(&tests, name);
    let (ultra, cord, climax) = (at(ULTRA)?, at(CORD)?, at(CLIMAX)?);
    let technora = at(TECHNORA)?;
    let thin = THIN.into_iter().map(at).collect::<Result<Vec<_>, _>>()?;
    let hmpe = |names: [&'static str; 3]| names.into_iter().map(at).collect::<Result<Vec<_>, _>>();
    let (thin_hmpe, thick_hmpe) = (hmpe(THIN_HMPE)?, hmpe(THICK_HMPE)?);
    let spread = |of: &[&Test], d: usize| {
        let ends = || of.iter().map(|t| t.end[d]);
        ends().fold(f64::MIN, f64::max) - ends().fold(f64::MAX, f64::min)
    };
    let total = |of: &[&Test], d: usize| of.iter().map(|t| t.end[d]).sum::<f64>();
    // Both groups have three ropes, so that ratios of sums are ratios of means.
    let expected =
        breaking_loads_n(catalogue, THIN_HMPE)? / breaking_loads_n(catalogue, THICK_HMPE)?;
    let rest_h = (MINUTES as f64 - SLOPE_FROM_MIN) / 60.0;
    let highest = |d: usize| thin.iter().map(|t| t.end[d]).fold(f64::MIN, f64::max);
    let lowest = |d: usize| thin.iter().map(|t| t.end[d]).fold(f64::MAX, f64::min);
    let sentences = vec![
        claimed(
            "Every rope saturates with a small remaining slope.",
            "for every rope the slope of the last 20 min is at most a third of that from 20 to 40 min (0.39 would be creep with the logarithm of time, which never ends), and the slope m_E, which is above 0, carries at most 15 % of the final strain through the last 65 min",
            |d| {
                tests.iter().all(|t| {
                    t.slope_left[d] <= 1.0 / 3.0
                        && t.slope[d] > 0.0
                        && t.slope[d] * rest_h <= 0.15 * t.end[d]
                })
            },
        ),
        claimed(
            "A larger diameter or breaking load does not mean less elongation: SK99 Ultra at 2 mm is worse than thinner ropes.",
            "SK99 Ultra ends above every rope under 2 mm, all of which have a lower published breaking load or none",
            |d| ultra.end[d] > highest(d),
        ),
        claimed(
            "Ropes under 2 mm end within almost 0.2 % of each other.",
            "highest minus lowest final strain of the five ropes under 2 mm is at most 0.2 %",
            |d| highest(d) - lowest(d) <= 0.2,
        ),
        claimed(
            "The aramid cord and Climax Combat have almost the same slope, although the cord ends far higher.",
            "their slopes m_E differ by at most a quarter of their mean, and the final strain of the cord is at least 1.5 times as large",
            |d| {
                let (a, b) = (cord.slope[d], climax.slope[d]);
                (a - b).abs() <= 0.25 * 0.5 * (a + b) && cord.end[d] >= 1.5 * climax.end[d]
            },
        ),
        claimed(
            "Technora and Vectran have the smallest slopes.",
            "both slopes m_E are below that of each of the other seven ropes",
            |d| {
                let theirs = at_most(&tests, d, |t| t.name == TECHNORA || t.name == VECTRAN);
                let others = at_least(&tests, d, |t| t.name != TECHNORA && t.name != VECTRAN);
                theirs < others
            },
        ),
        claimed(
            "Braiding changes the elongation more than the breaking load does.",
            "the final strains of three differently braided HMPE ropes of 2 mm, with breaking loads from 5600 to 7000 N, differ by more than those of the three HMPE ropes under 2 mm, with breaking loads from 2100 to 4450 N",
            |d| spread(&thick_hmpe, d) > spread(&thin_hmpe, d),
        ),
        claimed(
            "The two aramids differ remarkably.",
            "the final strain of the aramid cord is at least twice that of Technora",
            |d| cord.end[d] >= 2.0 * technora.end[d],
        ),
        claimed(
            "Ropes of 2 mm do not outperform thinner ones as expected.",
            &format!(
                "the mean final strain of the three HMPE ropes of 2 mm, relative to that of the three thinner ones, is at least 1.25 times the inverse ratio of their breaking loads ({expected:.2})"
            ),
            |d| total(&thick_hmpe, d) >= 1.25 * expected * total(&thin_hmpe, d),
        ),
    ];
    let title = "Fig. 1: tensile creep of nine ropes at 23 °C";
    let thick = tests.iter().filter(|t| !THIN.contains(&t.name.as_str()));
    let groups = [("under 2 mm", thin), ("2 mm", thick.collect())];
    let mut out = figure(FigureName::Fig1, title, &groups, None, sentences);
    out.not_assessed = not_assessed(&[[
        "Tensile creep after ISO 899-1: 60 N, 350 mm, 85 min, standard atmosphere 23/50.",
        "A procedure. Load, length and time are those of fig1; the creep law does not model humidity.",
    ]]);
    out.given = given(&[
        "60 N, 350 mm, 85 min, 23 °C and 50 % humidity; m_E from 20 min on.",
        "Almost 0.2 %: range of the final strains of the ropes under 2 mm.",
    ]);
    Ok(out)
}

/// Sum of the breaking loads of some ropes, N.
fn breaking_loads_n(catalogue: &Catalogue, names: [&str; 3]) -> Result<f64, PaperError> {
    let mut sum = 0.0;
    for name in names {
        let load = catalogue.find(name)?.entry.breaking_load_n.as_ref();
        sum += load
            .ok_or_else(|| PaperError::Rope(name.to_string()))?
            .value;
    }
    Ok(sum)
}

fn at_most(tests: &[Test], d: usize, which: impl Fn(&Test) -> bool) -> f64 {
    let slopes = tests.iter().filter(|t| which(t)).map(|t| t.slope[d]);
    slopes.fold(f64::MIN, f64::max)
}

fn at_least(tests: &[Test], d: usize, which: impl Fn(&Test) -> bool) -> f64 {
    let slopes = tests.iter().filter(|t| which(t)).map(|t| t.slope[d]);
    slopes.fold(f64::MAX, f64::min)
}

/// Fig. 2: DM20, SK99, Technora and Vectran at 60 °C.
///
/// # Errors
/// Returns the errors of [`fig1`].
pub fn fig2(catalogue: &Catalogue) -> Result<PaperFigure, PaperError> {
    let all = |celsius: f64| {
        HOT.into_iter()
            .map(|name| test(catalogue, name, celsius))
            .collect::<Result<Vec<_>, _>>()
    };
    let (cold, hot) = (all(23.0)?, all(60.0)?);
    let pair = |name| Ok::<_, PaperError>((find(&cold, name)?, find(&hot, name)?));
    let (dm20, sk99) = (pair(DM20)?, pair(SK99)?);
    let (technora, vectran) = (pair(TECHNORA)?, pair(VECTRAN)?);
    let end = |p: &(&Test, &Test), d: usize| p.1.end[d] / p.0.end[d];
    let slope = |p: &(&Test, &Test), d: usize| p.1.slope[d] / p.0.slope[d];
    let sentences = vec![
        claimed(
            "At 60 °C all except Liros SK99 reach an elongation similar to that at 23 °C.",
            "the final strain of DM20, Technora and Vectran at 60 °C is within 15 % of that at 23 °C",
            |d| {
                [&dm20, &technora, &vectran]
                    .iter()
                    .all(|p| (end(p, d) - 1.0).abs() <= 0.15)
            },
        ),
        claimed(
            "The slopes of Technora and Vectran increase only slightly.",
            "both slopes m_E at 60 °C are 1 to 1.5 times those at 23 °C",
            |d| {
                [&technora, &vectran]
                    .iter()
                    .all(|p| (1.0..=1.5).contains(&slope(p, d)))
            },
        ),
        claimed(
            "The slopes of SK99 and DM20 decrease strongly.",
            "both slopes m_E at 60 °C are at most half of those at 23 °C",
            |d| [&sk99, &dm20].iter().all(|p| slope(p, d) <= 0.5),
        ),
        claimed(
            "Liros SK99 ends at about half its value at 23 °C.",
            "its final strain at 60 °C is 0.4 to 0.6 of that at 23 °C",
            |d| (0.4..=0.6).contains(&end(&sk99, d)),
        ),
    ];
    let mut out = figure(
        FigureName::Fig2,
        "Fig. 2: tensile creep of four ropes at 60 °C",
        &[("", hot.iter().collect())],
        Some(&cold),
        sentences,
    );
    out.given = given(&[
        "60 °C; otherwise as Fig. 1.",
        "About half: Liros SK99 against its own end at 23 °C.",
    ]);
    out.assumptions.push("\"Liros SK99\" is assumed to be DC000-0301 (1.5 mm): the paper names two ropes of that fibre.".into());
    out.assumptions
        .push("The rope is warm from the start of the test.".into());
    Ok(out)
}

/// Draws each group of tests as a panel: curves with their 95 % bands; thin, the same ropes at 23 °C if `cold` has
/// them.
fn figure(
    name: FigureName,
    title: &str,
    groups: &[(&str, Vec<&Test>)],
    cold: Option<&[Test]>,
    sentences: Vec<Sentence>,
) -> PaperFigure {
    let minutes = minutes();
    let place = |i: usize| i % Colour::CYCLE.len();
    let (mut panels, mut data, mut highest) = (Vec::new(), Vec::new(), 0.0_f64);
    for (group, tests) in groups {
        let x_end = MINUTES as f64;
        let mut panel = Panel::new(*group, "time (min)", "strain (%)").x_range(0.0, x_end);
        let (mut lines, mut series) = (Vec::new(), Vec::new());
        for (i, t) in tests.iter().enumerate() {
            let label = format!("{}: m_{{E}} = {:.3} %/h", t.product, t.slope[0]);
            let (line, band, own) = curve(&label, &minutes, &t.curves, Colour::CYCLE[place(i)]);
            highest = band.high.iter().copied().fold(highest, f64::max);
            panel = panel.band(band);
            lines.push(line);
            series.push(SeriesData {
                name: t.name.clone(),
                ..own
            });
        }
        for (i, t) in cold.into_iter().flatten().enumerate() {
            let line = Line::new("", minutes.clone(), t.curves[0].clone());
            let line = line.colour(Colour::CYCLE[place(i)]);
            lines.push(line.dash(Dash::CYCLE[place(i)]).width(0.8));
        }
        panels.push(lines.into_iter().fold(panel, Panel::line));
        let own = if group.is_empty() { title } else { *group };
        data.push(PanelData {
            title: own.into(),
            series,
        });
    }
    let celsius = if cold.is_some() { 60.0 } else { 23.0 };
    let thin = if cold.is_some() {
        "; thin: the same at 23 °C"
    } else {
        ""
    };
    let mut assumptions = assumptions();
    assumptions.push(format!(
        "Free length {LENGTH_MM} mm; the load is applied immediately."
    ));
    let drawing = Figure::new(title)
        .subtitle(format!(
            "simulated: {LOAD_N} N, {celsius} °C{thin}; bands: 95 % of the draws"
        ))
        .size(if panels.len() > 1 { 1120.0 } else { 900.0 }, 520.0)
        .columns(panels.len());
    let drawing = panels.into_iter().fold(drawing, |figure, panel| {
        figure.panel(panel.y_range(0.0, 1.05 * highest))
    });
    PaperFigure {
        about: vec![format!(
            "Virtual creep tests at {LOAD_N} N and {celsius} °C over {MINUTES} min with the catalogue's ropes. m_E is the slope of a straight line fitted from {SLOPE_FROM_MIN} min on."
        )],
        panels: data,
        sentences,
        assumptions,
        ..PaperFigure::new(name, title, drawing)
    }
}
