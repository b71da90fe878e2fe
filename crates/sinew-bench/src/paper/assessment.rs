//! Assessment of statements on ropes, with the catalogue's values and in every draw of them.

use super::PaperError;
use super::data::{Curve, SeriesData};
use super::sentence::{Sentence, Unit};
use crate::numbers::line;
use sinew_figure::plot::{Band, Colour, Dash, Line};
use sinew_model::statistics::quantile;
use sinew_rope::law::Law;
use sinew_rope::{Catalogue, Draws};

/// Number of posterior draws for each share and band; [`Unit::ShareOfDraws`] prints it.
pub(super) const DRAWS: usize = 400;
/// Seed of the draws.
pub(super) const SEED: u64 = 1;

/// Returns the assumptions common to all rope figures.
pub(super) fn assumptions() -> Vec<String> {
    vec![
        "The parameters of the ropes are assumed values, tuned by hand to the paper's text. A statement that holds at the catalogue's values shows that the creep law can reproduce it, not that the ropes do.".into(),
        format!("The value found is the share of {DRAWS} draws (seed {SEED}) of the parameters in which the statement holds; it shows the influence of the assumed values. The verdict is \"holds\" if this is the case at the catalogue's values and in 95 % of the draws, \"does not hold\" if it is not the case there and in at most 5 % of the draws, and \"open\" otherwise. Parameters are drawn independently within their specified intervals, so that statements on the similarity of two ropes hold in fewer draws than statements on their difference."),
        "Strain is measured from the new, slack rope and includes the immediate elastic part.".into(),
    ]
}

/// The law of a rope of the catalogue, nominal first, then drawn.
pub(super) fn laws(catalogue: &Catalogue, name: &str) -> Result<Vec<Law>, PaperError> {
    let draws = Draws::new(catalogue.find(name)?, DRAWS, SEED)?;
    let mut all = vec![draws.nominal];
    all.extend(draws.laws);
    Ok(all)
}

/// Assesses a statement; `holds` is called with 0 for the catalogue's values and 1… for the draws.
pub(super) fn assessed(text: &str, rule: &str, holds: impl Fn(usize) -> bool) -> Sentence {
    let held = (1..=DRAWS).filter(|&i| holds(i)).count();
    let percent = 100.0 * held as f64 / DRAWS as f64;
    Sentence::added(text, rule, percent, Unit::ShareOfDraws, holds(0))
}

/// Assesses a statement of the paper.
pub(super) fn claimed(text: &str, rule: &str, holds: impl Fn(usize) -> bool) -> Sentence {
    assessed(text, rule, holds).of_paper()
}

/// Slope of the least-squares line through the points in a range of `x`, per unit of `x`.
pub(super) fn slope(x: &[f64], y: &[f64], range: std::ops::RangeInclusive<f64>) -> f64 {
    let points = x.iter().zip(y).filter(|(x, _)| range.contains(*x));
    line(&points.map(|(x, y)| (*x, *y)).collect::<Vec<_>>()).1
}

/// Returns a curve with its 95 % band, from nominal and drawn curves over the same minutes. Each colour has its dash.
pub(super) fn curve(
    name: &str,
    minutes: &[f64],
    curves: &[Vec<f64>],
    colour: Colour,
) -> (Line, Band, SeriesData) {
    let column = |i: usize| {
        let mut all: Vec<f64> = curves[1..].iter().map(|c| c[i]).collect();
        all.sort_unstable_by(f64::total_cmp);
        all
    };
    let (low, high) = (0..minutes.len())
        .map(|i| {
            let all = column(i);
            let at = |share| quantile(&all, share);
            (at(0.025), at(0.975))
        })
        .unzip();
    let place = Colour::CYCLE.iter().position(|c| *c == colour);
    let line = Line::new(name, minutes.to_vec(), curves[0].clone())
        .colour(colour)
        .dash(Dash::CYCLE[place.unwrap_or(0)])
        .width(1.8);
    let band = Band::new("", minutes.to_vec(), low, high).colour(colour);
    let series = SeriesData {
        name: name.into(),
        time_s: minutes.iter().map(|m| 60.0 * m).collect(),
        curve: Curve::StrainRatio(curves[0].iter().map(|percent| 0.01 * percent).collect()),
    };
    (line, band, series)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assessment_slope_of_line_matches_analytic() {
        let x: Vec<f64> = (0..86).map(f64::from).collect();
        let y: Vec<f64> = x
            .iter()
            .map(|x| if *x < 20.0 { 9.0 } else { 0.3 + 0.02 * x })
            .collect();
        assert!((slope(&x, &y, 20.0..=85.0) - 0.02).abs() < 1e-12);
    }
}
