//! Every line ever seen, and how many whole graduations a frame is away from them.
//!
//! A new frame's lines are held against the index at every offset; where they fit best is
//! how many whole graduations the scale has moved, whatever happened between the frames.

use super::marks::{Code, Line, VALUES};

/// Share of the lines in sight that must overlap for an offset to be judged, and their number.
const OVERLAP: f64 = 0.5;
const OVERLAP_LEAST: usize = 6;
/// An offset at which the code differs by less, in units of its spread, may be the right one; noise
/// and dirt add what they add to the best. In
/// drawn scales the right one differs by 0.001 to 0.03, one with wrong numbers by 0.03 to 0.06, one
/// with wrong lengths by 0.2 to 1.
const FITS: f64 = 0.1;
const FITS_NOISE: f64 = 1.2;
/// A code that differs by more at the best offset is not the one that is remembered.
const KNOWN: f64 = 0.4;
/// Up to this step, graduations, the nearest offset that fits is taken, for lines of different
/// lengths tell it from its neighbours: unless the numbers say clearly that it is a multiple of
/// 10 mm elsewhere, where the difference is less than this share.
const STEP_SURE: f64 = 5.0;
const ELSEWHERE: f64 = 0.45;
/// Otherwise the best offset must differ by less than this share of any other's difference...
const CLEARLY: f64 = 0.6;
/// ...unless that step is this many times as long...
const FARTHER: f64 = 4.0;
/// ...and few lines make a small difference less sure.
const FEW_LINES: f64 = 0.15;
/// A line that differs by more from what is remembered is not learned: something covers it.
const STRANGE: f32 = 0.3;
/// Spread of the lines about their mean, relative darkness, below which all lines look alike: the
/// longer lines of a faint print have 0.05.
const SPREAD_LEAST: f64 = 0.01;
/// A period at which half of the code repeats.
const REPEATS: f64 = 0.5;
/// Without a code a step must stay this far within half a graduation, graduations.
pub(crate) const STEP_MOST: f64 = 0.4;
/// Frames a line's value is averaged over.
const FRAMES_AVERAGED: f32 = 20.0;

/// Whole graduations, and whether the code was needed: the step was longer than half a graduation,
/// or too long to count without. Else the steps, graduations, to the nearest candidate and to the
/// next: two numbers fit as well, or there is no code and the step is too long.
pub(crate) type Counted = Result<(i64, bool), [f64; 2]>;

/// Every line seen so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct LineIndex {
    first: i64,
    lines: Vec<Option<(Line, f32)>>,
}

impl LineIndex {
    /// Adds a frame's lines, `whole` graduations on.
    pub(crate) fn learn(&mut self, code: &Code, whole: i64) {
        if code.lines.is_empty() {
            return;
        }
        let first = code.first + whole;
        if self.lines.is_empty() {
            self.first = first;
        }
        let before = (self.first - first).max(0) as usize;
        if before > 0 {
            self.lines.splice(0..0, std::iter::repeat_n(None, before));
            self.first = first;
        }
        let offset = (first - self.first) as usize;
        if self.lines.len() < offset + code.lines.len() {
            self.lines.resize(offset + code.lines.len(), None);
        }
        let spread = self.spread();
        let strange = self.differences(code, whole, spread.max(SPREAD_LEAST * SPREAD_LEAST));
        for (i, (line, held)) in code.lines.iter().zip(&mut self.lines[offset..]).enumerate() {
            let Some(line) = line else { continue };
            if strange.as_ref().is_some_and(|d| d[i] > STRANGE) {
                continue;
            }
            match held {
                None => *held = Some((*line, 1.0)),
                Some((mean, count)) => {
                    *count = (*count + 1.0).min(FRAMES_AVERAGED);
                    for (mean, value) in mean.iter_mut().zip(line) {
                        if mean.is_nan() {
                            *mean = *value;
                        } else if value.is_finite() {
                            *mean += (value - *mean) / *count;
                        }
                    }
                }
            }
        }
    }

    /// How much each line differs from the remembered one, `whole` graduations on: mean square in
    /// units of `spread`, at most 1; NaN where there is nothing to compare. `None` where too few
    /// lines overlap.
    fn differences(&self, code: &Code, whole: i64, spread: f64) -> Option<Vec<f32>> {
        let scale = 1.0 / spread as f32;
        let difference = |(number, line): (i64, &Option<Line>)| {
            let held = usize::try_from(number + whole - self.first).ok()?;
            let (line, (held, _)) = (line.as_ref()?, self.lines.get(held)?.as_ref()?);
            let (mut sum, mut count) = (0.0_f32, 0.0_f32);
            for (a, b) in line.iter().zip(held) {
                let d = a - b;
                // NaN compares false.
                let both = d.abs() <= f32::MAX;
                sum += if both { d * d } else { 0.0 };
                count += if both { 1.0 } else { 0.0 };
            }
            (count >= VALUES as f32 / 2.0).then(|| (scale * sum / count).min(1.0))
        };
        let lines = (code.first..).zip(&code.lines);
        let out: Vec<f32> = lines
            .map(|line| difference(line).unwrap_or(f32::NAN))
            .collect();
        let seen = code.lines.iter().flatten().count();
        let compared = out.iter().filter(|d| d.is_finite()).count();
        (compared >= ((OVERLAP * seen as f64) as usize).max(OVERLAP_LEAST)).then_some(out)
    }

    /// Mean square spread of the remembered lines about the mean of each band.
    fn spread(&self) -> f64 {
        let variance = |k: usize| {
            let values = self
                .lines
                .iter()
                .flatten()
                .map(|(line, _)| f64::from(line[k]));
            let (n, sum, squares) = values
                .filter(|v| v.is_finite())
                .fold((0.0, 0.0, 0.0), |(n, s, q), v| (n + 1.0, s + v, q + v * v));
            (n > 0.0).then(|| squares / n - (sum / n).powi(2))
        };
        let variances: Vec<f64> = (0..VALUES).filter_map(variance).collect();
        variances.iter().sum::<f64>() / variances.len().max(1) as f64
    }

    /// Counts whole graduations. `fraction` is the phase's part of the position, `last` the last
    /// position, both in graduations; `missed` frames lie between.
    pub(crate) fn count(&self, code: &Code, fraction: f64, last: f64, missed: usize) -> Counted {
        let nearest = (last - fraction).round() as i64;
        let step = |whole: i64| fraction + whole as f64 - last;
        let next = nearest + if step(nearest) < 0.0 { 1 } else { -1 };
        match self.choose(code, fraction, last) {
            None if step(nearest).abs() <= STEP_MOST / (1.0 + missed as f64) => {
                Ok((nearest, false))
            }
            None => Err([step(nearest), step(next)]),
            Some((first, Some(rival))) => Err([step(first), step(rival)]),
            Some((first, None)) => Ok((first, first != nearest)),
        }
    }

    /// The offset the code speaks for, and one it can't be told from; `None` where it says nothing.
    fn choose(&self, code: &Code, fraction: f64, last: f64) -> Option<(i64, Option<i64>)> {
        let spread = self.spread();
        if spread < SPREAD_LEAST * SPREAD_LEAST {
            return None;
        }
        let step = |whole: i64| (fraction + whole as f64 - last).abs();
        let nearest = (last - fraction).round() as i64;
        let reach = (code.lines.len() + self.lines.len()) as i64;
        // Difference of each offset that fits; infinite where lines in common are missing.
        let mut open: Vec<(i64, f64, f64)> = (nearest - reach..=nearest + reach)
            .map(|whole| match self.differences(code, whole, spread) {
                None => (whole, f64::INFINITY, f64::INFINITY),
                Some(d) => {
                    let (mean, count) = mean(&d);
                    (whole, mean, mean + FEW_LINES / count)
                }
            })
            .collect();
        let best = open.iter().map(|o| o.2).fold(f64::INFINITY, f64::min);
        if best > KNOWN {
            return None;
        }
        open.retain(|o| o.1 < FITS + FITS_NOISE * best || o.1.is_infinite());
        open.sort_by(|a, b| step(a.0).total_cmp(&step(b.0)));
        let first = *open.iter().find(|o| o.1.is_finite())?;
        let near = |of: i64| {
            open.iter()
                .find(|o| o.0 != of && step(o.0) < step(of) + 2.0 * STEP_MOST)
                .map(|o| o.0)
        };
        let best = *open.iter().min_by(|a, b| a.2.total_cmp(&b.2))?;
        let elsewhere = if step(first.0) <= STEP_SURE {
            best.2 < ELSEWHERE * first.1
        } else if step(first.0) <= 2.0 * STEP_SURE {
            best.2 < CLEARLY * first.2
        } else {
            best.0 != first.0
        };
        if !elsewhere {
            return Some((first.0, near(first.0)));
        }
        let equal = open
            .iter()
            .filter(|o| o.0 != best.0 && o.1.is_finite())
            .filter(|o| step(o.0) < FARTHER * step(best.0))
            .find(|o| best.2 > CLEARLY * o.2);
        Some((best.0, equal.map(|o| o.0)))
    }

    /// Distance of the longer lines in graduations: the smallest of 2, 4, 5, 10, 20 at which the
    /// code repeats. `None` where all lines look alike.
    pub(crate) fn longer_every(&self) -> Option<usize> {
        let code = Code {
            first: self.first,
            lines: self.lines.iter().map(|l| l.map(|(line, _)| line)).collect(),
        };
        let spread = self.spread();
        if spread < SPREAD_LEAST * SPREAD_LEAST {
            return None;
        }
        let at = |lag: usize| Some(1.0 - mean(&self.differences(&code, lag as i64, spread)?).0);
        let periods: Vec<(usize, f64)> = [2, 4, 5, 10, 20]
            .into_iter()
            .filter_map(|lag| Some((lag, at(lag)?)))
            .collect();
        let best = periods.iter().map(|p| p.1).fold(f64::MIN, f64::max);
        if best < REPEATS {
            return None;
        }
        // On a scale with lines of 1, 5 and 10 mm every second line is longer, though the fifth is
        // longer still: half of the best is enough.
        periods.into_iter().find(|p| p.1 >= 0.5 * best).map(|p| p.0)
    }
}

/// Mean and number of the lines compared.
fn mean(differences: &[f32]) -> (f64, f64) {
    let compared = differences.iter().filter(|d| d.is_finite());
    let (sum, count) = compared.fold((0.0, 0.0), |(s, n), d| (s + f64::from(*d), n + 1.0));
    (sum / count, count)
}
