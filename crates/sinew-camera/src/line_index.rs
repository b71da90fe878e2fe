//! Index of all lines seen so far, for counting whole graduations.
//!
//! The lines of a new frame are compared with the index at every offset; the best offset is the number of whole
//! graduations by which the scale has moved, independent of earlier frames.

use super::marks::{Code, Line, VALUES_PER_LINE};

/// Minimum overlap for the evaluation of an offset: share of the visible lines, and number of lines.
const MIN_OVERLAP_SHARE: f64 = 0.5;
const MIN_OVERLAP_LINES: usize = 6;
/// Maximum difference of the code, in units of its spread, at which an offset is a candidate; noise and dirt add a
/// multiple of the best difference. In drawn scales the correct offset differs by 0.001 to 0.03, one with wrong numbers
/// by 0.03 to 0.06, one with wrong lengths by 0.2 to 1.
const MAX_CANDIDATE_DIFFERENCE: f64 = 0.1;
const CANDIDATE_NOISE_RATIO: f64 = 1.2;
/// Maximum difference between the lines of a frame and those of the index at the best offset; above it, the lines are
/// not part of the index.
const MAX_INDEXED_DIFFERENCE: f64 = 0.4;
/// Maximum step, graduations, for which the nearest candidate is used, because lines of different lengths distinguish
/// it from its neighbours. Exception: another multiple of 10 mm whose difference is less than the second share.
const MAX_NEAREST_STEP: f64 = 5.0;
const MAX_OTHER_RATIO: f64 = 0.45;
/// For longer steps: maximum ratio of the best difference to that of any other candidate …
const MAX_BEST_RATIO: f64 = 0.6;
/// … except candidates whose step is longer by this factor.
const STEP_LENGTH_RATIO: f64 = 4.0;
/// Increase of the difference, divided by the number of lines: few lines give less evidence.
const LINE_COUNT_PENALTY: f64 = 0.15;
/// Maximum difference of a line from the index for an update; a larger one indicates an occlusion.
const MAX_UPDATE_DIFFERENCE: f32 = 0.3;
/// Minimum spread of the lines about their mean, relative darkness; below it all lines are identical. The longer lines
/// of a faint print have 0.05.
const MIN_SPREAD: f64 = 0.01;
/// Minimum repetition of the code at a period.
const MIN_REPETITION: f64 = 0.5;
/// Maximum step without a code, graduations; half a graduation with a margin.
pub(crate) const MAX_STEP: f64 = 0.4;
/// Number of frames over which a line is averaged.
const FRAMES_AVERAGED: f32 = 20.0;

/// Number of whole graduations, and whether the code was needed: the step was longer than half a graduation, or too
/// long to count without it. Error: the steps, graduations, to the nearest candidate and to the next, if two candidates
/// fit equally, or there is no code and the step is too long.
pub(crate) type Counted = Result<(i64, bool), [f64; 2]>;

/// Index of all lines seen so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct LineIndex {
    first: i64,
    lines: Vec<Option<(Line, f32)>>,
}

impl LineIndex {
    /// Adds the lines of a frame, shifted by `whole` graduations.
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
        let strange = self.differences(code, whole, spread.max(MIN_SPREAD * MIN_SPREAD));
        for (i, (line, held)) in code.lines.iter().zip(&mut self.lines[offset..]).enumerate() {
            let Some(line) = line else { continue };
            if strange
                .as_ref()
                .is_some_and(|d| d[i] > MAX_UPDATE_DIFFERENCE)
            {
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

    /// Returns the difference of each line from the index, shifted by `whole` graduations: mean square in units of
    /// `spread`, at most 1; NaN without a counterpart. `None` if too few lines overlap.
    fn differences(&self, code: &Code, whole: i64, spread: f64) -> Option<Vec<f32>> {
        let scale = 1.0 / spread as f32;
        let difference = |(number, line): (i64, &Option<Line>)| {
            let held = usize::try_from(number + whole - self.first).ok()?;
            let (line, (held, _)) = (line.as_ref()?, self.lines.get(held)?.as_ref()?);
            let (mut sum, mut count) = (0.0_f32, 0.0_f32);
            for (a, b) in line.iter().zip(held) {
                let d = a - b;
                // Comparisons with NaN are false.
                let both = d.abs() <= f32::MAX;
                sum += if both { d * d } else { 0.0 };
                count += if both { 1.0 } else { 0.0 };
            }
            (count >= VALUES_PER_LINE as f32 / 2.0).then(|| (scale * sum / count).min(1.0))
        };
        let lines = (code.first..).zip(&code.lines);
        let out: Vec<f32> = lines
            .map(|line| difference(line).unwrap_or(f32::NAN))
            .collect();
        let seen = code.lines.iter().flatten().count();
        let compared = out.iter().filter(|d| d.is_finite()).count();
        (compared >= ((MIN_OVERLAP_SHARE * seen as f64) as usize).max(MIN_OVERLAP_LINES))
            .then_some(out)
    }

    /// Returns the mean square spread of the indexed lines about the mean of each band.
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
        let variances: Vec<f64> = (0..VALUES_PER_LINE).filter_map(variance).collect();
        variances.iter().sum::<f64>() / variances.len().max(1) as f64
    }

    /// Counts whole graduations. `fraction` is the part of the position from the phase, `last` the last position, both
    /// in graduations; `missed` is the number of frames in between.
    pub(crate) fn count(&self, code: &Code, fraction: f64, last: f64, missed: usize) -> Counted {
        let nearest = (last - fraction).round() as i64;
        let step = |whole: i64| fraction + whole as f64 - last;
        let next = nearest + if step(nearest) < 0.0 { 1 } else { -1 };
        match self.choose(code, fraction, last) {
            None if step(nearest).abs() <= MAX_STEP / (1.0 + missed as f64) => Ok((nearest, false)),
            None => Err([step(nearest), step(next)]),
            Some((first, Some(rival))) => Err([step(first), step(rival)]),
            Some((first, None)) => Ok((first, first != nearest)),
        }
    }

    /// Returns the offset that the code supports, and an equally supported one, if any; `None` if the code is not
    /// conclusive.
    fn choose(&self, code: &Code, fraction: f64, last: f64) -> Option<(i64, Option<i64>)> {
        let spread = self.spread();
        if spread < MIN_SPREAD * MIN_SPREAD {
            return None;
        }
        let step = |whole: i64| (fraction + whole as f64 - last).abs();
        let nearest = (last - fraction).round() as i64;
        let reach = (code.lines.len() + self.lines.len()) as i64;
        // Difference of each candidate; infinite without common lines.
        let mut candidates: Vec<(i64, f64, f64)> = (nearest - reach..=nearest + reach)
            .map(|whole| match self.differences(code, whole, spread) {
                None => (whole, f64::INFINITY, f64::INFINITY),
                Some(d) => {
                    let (mean, count) = mean(&d);
                    (whole, mean, mean + LINE_COUNT_PENALTY / count)
                }
            })
            .collect();
        let best = candidates.iter().map(|o| o.2).fold(f64::INFINITY, f64::min);
        if best > MAX_INDEXED_DIFFERENCE {
            return None;
        }
        candidates.retain(|o| {
            o.1 < MAX_CANDIDATE_DIFFERENCE + CANDIDATE_NOISE_RATIO * best || o.1.is_infinite()
        });
        candidates.sort_by(|a, b| step(a.0).total_cmp(&step(b.0)));
        let first = *candidates.iter().find(|o| o.1.is_finite())?;
        let near = |of: i64| {
            candidates
                .iter()
                .find(|o| o.0 != of && step(o.0) < step(of) + 2.0 * MAX_STEP)
                .map(|o| o.0)
        };
        let best = *candidates.iter().min_by(|a, b| a.2.total_cmp(&b.2))?;
        let elsewhere = if step(first.0) <= MAX_NEAREST_STEP {
            best.2 < MAX_OTHER_RATIO * first.1
        } else if step(first.0) <= 2.0 * MAX_NEAREST_STEP {
            best.2 < MAX_BEST_RATIO * first.2
        } else {
            best.0 != first.0
        };
        if !elsewhere {
            return Some((first.0, near(first.0)));
        }
        let equal = candidates
            .iter()
            .filter(|o| o.0 != best.0 && o.1.is_finite())
            .filter(|o| step(o.0) < STEP_LENGTH_RATIO * step(best.0))
            .find(|o| best.2 > MAX_BEST_RATIO * o.2);
        Some((best.0, equal.map(|o| o.0)))
    }

    /// Returns the distance of the longer lines in graduations: the smallest of 2, 4, 5, 10, 20 at which the code
    /// repeats. `None` if all lines are identical.
    pub(crate) fn longer_every(&self) -> Option<usize> {
        let code = Code {
            first: self.first,
            lines: self.lines.iter().map(|l| l.map(|(line, _)| line)).collect(),
        };
        let spread = self.spread();
        if spread < MIN_SPREAD * MIN_SPREAD {
            return None;
        }
        let at = |lag: usize| Some(1.0 - mean(&self.differences(&code, lag as i64, spread)?).0);
        let periods: Vec<(usize, f64)> = [2, 4, 5, 10, 20]
            .into_iter()
            .filter_map(|lag| Some((lag, at(lag)?)))
            .collect();
        let best = periods.iter().map(|p| p.1).fold(f64::MIN, f64::max);
        if best < MIN_REPETITION {
            return None;
        }
        // On a scale with lines of 1, 5 and 10 mm every second line is longer, and the fifth longer still: half of the
        // best repetition is sufficient.
        periods.into_iter().find(|p| p.1 >= 0.5 * best).map(|p| p.0)
    }
}

/// Returns mean and number of the compared lines.
fn mean(differences: &[f32]) -> (f64, f64) {
    let compared = differences.iter().filter(|d| d.is_finite());
    let (sum, count) = compared.fold((0.0, 0.0), |(s, n), d| (s + f64::from(*d), n + 1.0));
    (sum / count, count)
}
