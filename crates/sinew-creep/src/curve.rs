//! Record in the form used by a fit: strain over time and the load history.

/// Number of points above which measurements are averaged; more points only cost time.
const POINTS: usize = 240;

/// Strain over time under a load history.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// Name of the specimen.
    pub name: String,
    /// Increasing times, s; 0 is the first load step.
    pub time_s: Vec<f64>,
    /// Strain at these times, m/m.
    pub strain: Vec<f64>,
    /// Number of measurements averaged into each point.
    pub count: Vec<f64>,
    /// Start time, s, and load of each step, as a multiple of the reference load.
    pub steps: Vec<(f64, f64)>,
    /// Windows of steps at an unknown time between two measurements.
    pub windows: Vec<StepWindow>,
    /// Temperature, °C, if known.
    pub temperature_c: Option<f64>,
    /// Tension scale of the steps, N, if the force is recorded.
    pub tension: Option<Tension>,
    /// Number of measurements before the load whose mean is strain zero; 0 if the zero is unknown.
    pub zero_count: f64,
}

/// Interval between two measurements that contains a step of a [`Curve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepWindow {
    /// Index of the load step.
    pub step: usize,
    /// Time of the last measurement before the step, s.
    pub from_s: f64,
    /// Time of the first measurement after the step, s.
    pub to_s: f64,
}

/// Tension scale of the steps of a [`Curve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tension {
    /// Tension before the first step, N; the strain counts from there.
    pub preload_n: f64,
    /// Tension added by a step of 1, N.
    pub per_step_n: f64,
    /// Recorded duration of the preload before the first step, s.
    pub preloaded_s: f64,
}

impl Tension {
    /// Tension at a step, N; negative values, from a zero error of the load cell, become 0.
    pub fn at(&self, step: f64) -> f64 {
        (self.preload_n + step * self.per_step_n).max(0.0)
    }
}

impl Curve {
    /// Creates a curve under the reference load from time 0 on.
    pub fn constant_load(name: impl Into<String>, time_s: Vec<f64>, strain: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            count: vec![1.0; time_s.len()],
            time_s,
            strain,
            steps: vec![(0.0, 1.0)],
            windows: Vec::new(),
            temperature_c: None,
            tension: None,
            zero_count: 0.0,
        }
    }

    /// Keeps the measurements for which `is_kept` returns true.
    pub(super) fn select(&mut self, is_kept: impl Fn(usize) -> bool) {
        for column in [&mut self.time_s, &mut self.strain, &mut self.count] {
            let mut i = 0;
            column.retain(|_| {
                i += 1;
                is_kept(i - 1)
            });
        }
    }

    /// Rescales the steps to another reference load; `factor` is the ratio of the present to the new reference load.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.steps.iter_mut().for_each(|step| step.1 *= factor);
        if let Some(tension) = &mut self.tension {
            tension.per_step_n /= factor;
        }
        self
    }

    /// Whether the load decreases at any time.
    pub fn unloads(&self) -> bool {
        self.steps.windows(2).any(|pair| pair[1].1 < pair[0].1)
    }

    /// Stages of the load: start and last level of each. Small steps follow a drift of the load and
    /// start no stage.
    fn stages(&self) -> Vec<(f64, f64)> {
        let mut stages: Vec<(f64, f64)> = Vec::new();
        let mut level = 0.0;
        for &(start, load) in &self.steps {
            match stages.last_mut() {
                Some(stage) if (load - level).abs() <= 0.05 => stage.1 = load,
                None if load.abs() <= 0.05 => {}
                _ => {
                    stages.push((start, load));
                    level = load;
                }
            }
        }
        stages
    }

    /// Load held longest, and the start of the next stage after it.
    pub(super) fn held(&self) -> Option<(f64, Option<f64>)> {
        let stages = self.stages();
        let last = self.time_s.last().copied().unwrap_or(0.0);
        let next = |i: usize| stages.get(i + 1).map(|stage| stage.0);
        let length = |i: usize| next(i).unwrap_or(last) - stages[i].0;
        let loaded = (0..stages.len()).filter(|&i| stages[i].1 > 0.05);
        // The first of equal durations.
        let longest = loaded
            .rev()
            .max_by(|&a, &b| length(a).total_cmp(&length(b)))?;
        Some((stages[longest].1, next(longest)))
    }

    /// Record up to the end of its longest stage under load, with that load continued.
    #[must_use]
    pub(super) fn held_on(&self) -> Curve {
        let Some((_, Some(end))) = self.held() else {
            return self.clone();
        };
        let at = self.time_s.partition_point(|t| *t < end);
        let mut held = self.clone();
        held.time_s.truncate(at);
        held.strain.truncate(at);
        held.count.truncate(at);
        held.steps.retain(|step| step.0 < end);
        held.windows.retain(|window| window.step < held.steps.len());
        held
    }

    /// The same specimen, new, under another load and temperature from the first step on; without
    /// measurements.
    #[must_use]
    pub(super) fn instead(&self, level: f64, temperature_c: Option<f64>) -> Curve {
        let start = self.steps.first().map_or(0.0, |step| step.0);
        Curve {
            time_s: Vec::new(),
            strain: Vec::new(),
            count: Vec::new(),
            steps: vec![(start, level)],
            windows: Vec::new(),
            temperature_c,
            ..self.clone()
        }
    }

    /// Splits the record at `time_s` into two parts, both under the whole load history.
    #[must_use]
    pub fn split(&self, time_s: f64) -> (Curve, Curve) {
        let at = self.time_s.partition_point(|t| *t <= time_s);
        let part = |range: std::ops::Range<usize>| Curve {
            time_s: self.time_s[range.clone()].to_vec(),
            strain: self.strain[range.clone()].to_vec(),
            count: self.count[range].to_vec(),
            ..self.clone()
        };
        (part(0..at), part(at..self.time_s.len()))
    }

    /// Shift of the measurements by the unknown time of a step, all together, in their standard
    /// deviations. The later creep is proportional to the logarithm of time.
    pub(super) fn moved_by(&self, window: &StepWindow) -> f64 {
        let middle = 0.5 * (window.from_s + window.to_s);
        let steps = self.steps.get(window.step + 1);
        let end = steps.map_or(f64::INFINITY, |step| step.0);
        let after: Vec<usize> = (0..self.time_s.len())
            .filter(|&i| self.time_s[i] >= window.to_s && self.time_s[i] < end)
            .collect();
        let (Some(&first), Some(&last)) = (after.first(), after.last()) else {
            return 0.0;
        };
        let age = |i: usize| self.time_s[i] - middle;
        let folds = (age(last) / age(first)).ln();
        if !(folds > 0.0) {
            return 0.0;
        }
        let per_fold = (self.strain[last] - self.strain[first]) / folds;
        // Residual of a measurement between two others, linear in the logarithm of time: its
        // scatter is √1.5 of one measurement.
        let place: Vec<f64> = after.iter().map(|&i| age(i).ln()).collect();
        let left: Vec<f64> = (1..after.len().saturating_sub(1))
            .map(|k| {
                let share = (place[k] - place[k - 1]) / (place[k + 1] - place[k - 1]);
                let [before, here, next] = [k - 1, k, k + 1].map(|k| self.strain[after[k]]);
                let scale = self.count[after[k]].sqrt() / 1.5_f64.sqrt();
                scale * (here - before - share * (next - before)).abs()
            })
            .filter(|apart| apart.is_finite())
            .collect();
        if left.is_empty() {
            return 0.0;
        }
        // The factor 1.4826 converts the median deviation to a standard deviation of a normal
        // distribution.
        let sigma = 1.482_6 * super::artefacts::median(&left);
        // Uniform in the window: standard deviation of its length over √12.
        let moment = (window.to_s - window.from_s) / 12.0_f64.sqrt();
        let squares: f64 = after
            .iter()
            .map(|&i| self.count[i] * (moment * per_fold / age(i)).powi(2))
            .sum();
        squares.sqrt() / sigma.max(f64::MIN_POSITIVE)
    }

    /// Reduces the curve to at most a few hundred points: means over bins that are uniform in the
    /// logarithm of the time since the last load step.
    #[must_use]
    pub fn thinned(&self) -> Curve {
        if self.time_s.len() <= POINTS {
            return self.clone();
        }
        let stages: Vec<f64> = self.stages().iter().map(|stage| stage.0).collect();
        let stage = |t: f64| stages.iter().rposition(|start| *start <= t).unwrap_or(0);
        let count = self
            .time_s
            .iter()
            .map(|t| stage(*t))
            .collect::<std::collections::BTreeSet<_>>()
            .len()
            .max(1);
        let per_stage = (POINTS / count).max(20) as f64;
        let mut thin = Curve {
            time_s: Vec::new(),
            strain: Vec::new(),
            count: Vec::new(),
            ..self.clone()
        };
        let mut from = 0;
        while from < self.time_s.len() {
            let here = stage(self.time_s[from]);
            let start = stages.get(here).copied().unwrap_or(0.0);
            let to = from + self.time_s[from..].partition_point(|t| stage(*t) == here);
            let end = self.time_s[to - 1];
            // Uniform in ln(t + d): bins near the step contain single measurements.
            let d = (end - start) / per_stage;
            let place = |t: f64| ((t - start) / d).ln_1p();
            let width = place(end) / per_stage;
            let mut i = from;
            while i < to {
                let bin = (place(self.time_s[i]) / width).floor();
                let mut j = i;
                let (mut t, mut e, mut c) = (0.0, 0.0, 0.0);
                while j < to && (j == i || (place(self.time_s[j]) / width).floor() <= bin) {
                    t += self.count[j] * self.time_s[j];
                    e += self.count[j] * self.strain[j];
                    c += self.count[j];
                    j += 1;
                }
                thin.time_s.push(t / c);
                thin.strain.push(e / c);
                thin.count.push(c);
                i = j;
            }
            from = to;
        }
        thin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loaded() -> Curve {
        Curve {
            steps: vec![(-1.0, 1.0), (5.0, 0.5)],
            temperature_c: Some(23.0),
            ..Curve::constant_load("a", vec![1.0, 2.0, 4.0, 8.0], vec![0.1, 0.2, 0.3, 0.4])
        }
    }

    #[test]
    fn split_keeps_measurements_and_loads() {
        let whole = Curve {
            count: vec![1.0, 2.0, 3.0, 4.0],
            ..loaded()
        };
        let (before, after) = whole.split(2.0);
        assert_eq!(
            (before.time_s, after.time_s),
            (vec![1.0, 2.0], vec![4.0, 8.0])
        );
        assert_eq!(
            (before.strain, after.strain),
            (vec![0.1, 0.2], vec![0.3, 0.4])
        );
        assert_eq!(
            (before.count, after.count),
            (vec![1.0, 2.0], vec![3.0, 4.0])
        );
        for steps in [before.steps, after.steps] {
            assert_eq!(steps, whole.steps);
        }
    }

    #[test]
    fn new_specimen_has_one_step_and_no_measurements() {
        let mut other = loaded();
        other.windows.push(StepWindow {
            step: 1,
            from_s: 4.0,
            to_s: 8.0,
        });
        let other = other.instead(0.7, Some(40.0));
        assert!(other.time_s.is_empty() && other.strain.is_empty() && other.count.is_empty());
        assert!(other.windows.is_empty());
        assert_eq!(other.steps, [(-1.0, 0.7)]);
        assert_eq!(
            (other.temperature_c, other.name.as_str()),
            (Some(40.0), "a")
        );
    }

    // Analytic value: `b ln t` with an error of alternating sign, uniform in the logarithm of time.
    #[test]
    fn unknown_step_time_shift_matches_analytic_value() {
        const CREEP: f64 = 2e-4;
        const ERROR: f64 = 1e-6;
        const READINGS: f64 = 4.0;
        let ages: Vec<f64> = (0..9).map(|k| 6.0 * 1.5_f64.powi(k)).collect();
        let read =
            |(k, age): (usize, &f64)| CREEP * age.ln() + if k % 2 == 0 { ERROR } else { -ERROR };
        let mut curve = Curve::constant_load(
            "by hand",
            ages.iter().map(|age| 10.0 + age).collect(),
            ages.iter().enumerate().map(read).collect(),
        );
        curve.count.fill(READINGS);
        let window = StepWindow {
            step: 0,
            from_s: 5.0,
            to_s: 15.0,
        };
        // Each measurement deviates by two errors from its neighbours' mean; means of four have
        // half the error of one.
        let std = 1.482_6 * 2.0 * ERROR / 1.5_f64.sqrt();
        let squares: f64 = ages
            .iter()
            .map(|age| (CREEP / age * 10.0 / 12.0_f64.sqrt()).powi(2))
            .sum();
        let by_hand = squares.sqrt() / std;
        let found = curve.moved_by(&window);
        assert!((found / by_hand - 1.0).abs() < 1e-9, "{found} {by_hand}");
        // Measurements after the next step do not count.
        curve.steps = vec![(10.0, 1.0), (10.0 + 6.0 * 1.5_f64.powi(7), 2.0)];
        assert!(curve.moved_by(&window) < found);
    }
}
