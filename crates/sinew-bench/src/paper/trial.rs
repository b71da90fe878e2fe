//! Simulate once, estimate often.

use super::PaperError;
use super::data::{Curve, SeriesData};
use super::staircase::{REST_WINDOW_S, rest_end_s};
use sinew_model::arm::Arm;
use sinew_model::offset::{Comparison, OffsetConfig, OffsetObserver, Sample};
use sinew_model::robot::Robot;
use sinew_model::transmission::{Friction, Transmission};
use sinew_sim::{Scenario, Simulation, injected};

/// A recording held in memory. Rows have one entry per joint.
#[derive(Debug, Clone)]
pub(super) struct Trial {
    /// Sampling period, s.
    pub(super) dt_s: f64,
    pub(super) q: Vec<Vec<f64>>,
    pub(super) theta: Vec<Vec<f64>>,
    pub(super) dq: Vec<Vec<f64>>,
    /// NaN if the scenario does not record it.
    tau_el: Vec<Vec<f64>>,
    tau_m: Vec<Vec<f64>>,
}

impl Trial {
    /// Runs a scenario to its end.
    pub(super) fn run(robot: &Robot, scenario: &Scenario) -> Result<Self, PaperError> {
        let mut simulation = Simulation::new(robot, scenario)?;
        let mut trial = Self {
            dt_s: 1.0 / scenario.sample_rate_hz,
            q: Vec::new(),
            theta: Vec::new(),
            dq: Vec::new(),
            tau_el: Vec::new(),
            tau_m: Vec::new(),
        };
        while let Some(frame) = simulation.next_frame()? {
            trial.q.push(frame.q.clone());
            trial.theta.push(frame.theta.clone());
            trial.dq.push(frame.dq.clone());
            trial.tau_el.push(frame.tau_el.clone());
            trial.tau_m.push(frame.tau_m.clone());
        }
        Ok(trial)
    }

    /// Time of sample `k`, s.
    pub(super) fn time_s(&self, k: usize) -> f64 {
        k as f64 * self.dt_s
    }

    fn index(&self, t: f64) -> usize {
        ((t / self.dt_s).round() as usize).min(self.q.len())
    }

    /// Mean of a curve over the last part of rest `k`.
    pub(super) fn at_rest(&self, curve: &[f64], k: usize) -> f64 {
        let end = rest_end_s(k);
        mean(self.between(curve, end - REST_WINDOW_S, end))
    }

    /// True elastic torque of a joint, N·m.
    pub(super) fn torque(&self, joint: usize) -> Vec<f64> {
        self.tau_el.iter().map(|tau| tau[joint]).collect()
    }

    /// Mean pose over the last part of rest `k`.
    pub(super) fn pose_at_rest(&self, k: usize) -> Vec<f64> {
        let joints = self.q.first().map_or(0, Vec::len);
        (0..joints)
            .map(|j| {
                let curve: Vec<f64> = self.q.iter().map(|q| q[j]).collect();
                self.at_rest(&curve, k)
            })
            .collect()
    }

    /// The part of a curve between two times, s.
    pub(super) fn between<'c>(&self, curve: &'c [f64], from_s: f64, to_s: f64) -> &'c [f64] {
        &curve[self.index(from_s)..self.index(to_s).min(curve.len())]
    }

    /// A curve for a drawing: every hundredth of a second is finer than a pixel.
    pub(super) fn series(&self, name: &str, curve: &[f64]) -> SeriesData {
        let every = ((0.01 / self.dt_s).round() as usize).max(1);
        let picked = (0..curve.len()).step_by(every);
        SeriesData {
            name: name.into(),
            time_s: picked.clone().map(|k| self.time_s(k)).collect(),
            curve: Curve::AngleRad(picked.map(|k| curve[k]).collect()),
        }
    }
}

/// Model and settings of the estimator.
#[derive(Debug, Clone)]
pub(super) struct Estimator {
    pub(super) arm: Arm,
    pub(super) transmissions: Vec<Option<Transmission>>,
    pub(super) config: OffsetConfig,
}

impl Estimator {
    /// Knows the robot as described, with joint friction set to zero as the paper does.
    pub(super) fn of(robot: &Robot, config: OffsetConfig) -> Self {
        let mut transmissions = robot.transmissions.clone();
        for t in transmissions.iter_mut().flatten() {
            t.joint_friction = Friction::default();
        }
        Self {
            arm: robot.arm.clone(),
            transmissions,
            config,
        }
    }

    /// Multiplies the stiffness of the estimator's model by this factor.
    pub(super) fn with_stiffness_factor(mut self, factor: f64) -> Self {
        for t in self.transmissions.iter_mut().flatten() {
            t.stiffness_nm_per_rad *= factor;
        }
        self
    }

    /// Multiplies `M`, `C` and `g` of the estimator's model by this factor.
    pub(super) fn with_mass_factor(mut self, factor: f64) -> Result<Self, PaperError> {
        self.arm = self.arm.with_scaled_masses(factor)?;
        Ok(self)
    }

    /// Selects the paper's comparison or the matched one.
    pub(super) fn comparing(mut self, comparison: Comparison) -> Self {
        self.config.comparison = comparison;
        self
    }

    /// Offset of `joint` over a trial, rad, with the paper's artificial offset in its recorded
    /// motor position.
    pub(super) fn estimate(
        &self,
        trial: &Trial,
        joint: usize,
        offset_rad: f64,
    ) -> Result<Vec<f64>, PaperError> {
        let mut observer = OffsetObserver::new(&self.arm, &self.transmissions, self.config)?;
        let mut theta = vec![0.0; self.arm.dof()];
        let mut out = Vec::with_capacity(trial.q.len());
        for k in 0..trial.q.len() {
            let recorded = &trial.theta[k];
            theta.copy_from_slice(recorded);
            theta[joint] = injected(recorded[joint], offset_rad);
            let sample = Sample {
                q: &trial.q[k],
                theta_measured: &theta,
                dq: Some(&trial.dq[k]),
                tau_el: Some(&trial.tau_el[k]),
                tau_m: Some(&trial.tau_m[k]),
                tau_ext: None,
            };
            observer.step(trial.dt_s, &sample)?;
            out.push(observer.delta_e()[joint]);
        }
        Ok(out)
    }
}

/// Index of a joint the figure is about.
pub(super) fn joint(
    robot: &Robot,
    name: &'static str,
    figure: &'static str,
) -> Result<usize, PaperError> {
    robot
        .arm
        .joint_index(name)
        .ok_or_else(|| PaperError::Joint {
            robot: robot.name.clone(),
            joint: name,
            figure,
            available: robot.joint_names().join(", "),
        })
}

/// 0 of nothing.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

pub(super) fn std(values: &[f64]) -> f64 {
    let m = mean(values);
    let sum: f64 = values.iter().map(|v| (v - m) * (v - m)).sum();
    (sum / values.len().max(1) as f64).sqrt()
}

/// Returns the largest absolute value.
pub(super) fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, v| v.abs().max(a))
}

/// `a − b`.
pub(super) fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
