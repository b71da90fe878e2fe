//! The Bayesian Cramér–Rao bound of the offset: what no estimator can beat on average.
//!
//! At the truth of a recording the model of the estimator is differentiated by everything that is
//! drawn, and the information of sessions A and B is added to that of the draws:
//!
//! ```text
//! J = P₀⁻¹ + Σ_(joint, session) Hᵀ C⁻¹ H,     bound of an offset = √(J⁻¹)_(offset, offset)
//! y = delta_e + d − η d³ + (α_T + c_T d) ΔT + encoder(q) + noise,     d = τ/K
//! τ = Φ π + F_c z + F_v dq + μ z |τ|
//! ```
//!
//! * `P₀`: variances of the protocol's own draws (a uniform draw counts with its variance);
//!   offsets of B open to 30 mrad, those of A zero. The encoder's once- and twice-per-turn errors
//!   are parameters like the others, so are the payload's mass and what is not known of `ΔT`.
//! * `C`: the sensors' own errors as they come through the filters: this recording's features with
//!   quantisation and noise less those without, at the true parameters, so that what quantised
//!   positions do to speeds and to the friction state is in. They are taken as stationary, with
//!   the autocovariance they have over A and B; the motor torque is not used.
//!
//! Taken as known, which makes the bound lower than any estimator's error: the forms of friction
//! and spring, the course of pre-sliding but for what quantisation spoils, where the payload is
//! held, when contacts are (left out, with the second that the filters remember). What makes it
//! higher than the very least: quantisation is white in motion and one number at rest, so that an
//! estimator that knew this would trust motion more; with that, and with regressors free of error,
//! the sensors alone would allow 0.01 mrad.

mod draws;
mod linear;
mod noise;
mod truth;

use super::estimator;
use sinew_estimate::session::{Recorded, Recorder};
use sinew_log::Frame;
use sinew_model::offset::Block;
use sinew_sim::Simulation;
use sinew_sim::protocol::Plan;
use truth::Truth;

/// Parameters of a joint: compliance, stiffening, Coulomb, viscous, load, drift, thermal, and four
/// harmonics of the encoder.
const PER_JOINT: usize = 11;
/// Draws of a body: mass, centre along and twice across, inertia.
const PER_BODY: usize = 5;
/// Entries of a body in the regressor.
const COLUMNS: usize = 10;
/// What an offset may be, rad.
const OPEN_RAD: f64 = 0.03;
/// The filters remember a contact for about three of their time constants, s.
const MEMORY_S: f64 = 1.0;

/// Takes what the sensors would show without error.
pub(super) struct BoundRecorder {
    recorders: Vec<Recorder>,
    frame: Frame,
}

impl BoundRecorder {
    pub(super) fn new(plan: &Plan) -> Self {
        Self {
            recorders: vec![estimator::recorder(&plan.robot); 2],
            frame: Frame::new(plan.robot.arm.dof()),
        }
    }

    /// Takes what is behind the latest frame of session `k`; sessions after B don't count.
    pub(super) fn push(&mut self, k: usize, simulation: &Simulation, time_ns: i64) {
        let Some(recorder) = self.recorders.get_mut(k) else {
            return;
        };
        self.frame.time_ns = time_ns;
        for i in 0..self.frame.q.len() {
            (self.frame.q[i], self.frame.theta[i]) = simulation.shown_without_noise(i);
        }
        recorder.push(&self.frame, simulation.true_state().time_s);
    }

    /// Bound of every joint's offset in B, rad; `None` where the information can't be inverted.
    /// `noisy`: sessions A and B as recorded.
    pub(super) fn finish(
        self,
        plan: &Plan,
        simulation: &Simulation,
        noisy: &[Recorded],
    ) -> Option<Vec<f64>> {
        let clean: Vec<Recorded> = self.recorders.into_iter().map(Recorder::finish).collect();
        bound(plan, simulation, &clean, noisy)
    }
}

fn bound(
    plan: &Plan,
    simulation: &Simulation,
    clean: &[Recorded],
    noisy: &[Recorded],
) -> Option<Vec<f64>> {
    let robot = &plan.robot;
    let n = robot.arm.dof();
    let truth = Truth::of(plan, simulation)?;
    let deviations = draws::deviations(plan, &truth, robot);
    let total = deviations.len();
    // Scaled by the draws: the information of a draw is one.
    let mut information = vec![0.0; total * total];
    for k in 0..total {
        information[k * total + k] = 1.0;
    }
    let errors = truth.errors(clean, noisy, n);
    let contacts: Vec<(f64, f64)> = simulation
        .contacts()
        .begun
        .iter()
        .map(|c| (c.start_s, c.start_s + c.duration_s + MEMORY_S))
        .collect();
    for (session, recorded) in clean.iter().enumerate() {
        let blocks: Vec<&Block> = recorded
            .blocks
            .iter()
            .filter(|b| contacts.iter().all(|c| !(c.0..c.1).contains(&b.time_s)))
            .collect();
        if blocks.is_empty() {
            continue;
        }
        let times: Vec<f64> = blocks.iter().map(|b| b.time_s).collect();
        for i in 0..n {
            let rows: Vec<f64> = blocks
                .iter()
                .flat_map(|block| {
                    let mut row = truth.row(block, i, session, n, total);
                    for (x, s) in row.iter_mut().zip(&deviations) {
                        *x *= s;
                    }
                    row
                })
                .collect();
            let covariance = errors[i].matrix(&times);
            linear::add_information(&covariance, &rows, total, &mut information)?;
        }
    }
    let covariance = linear::inverse_diagonal(&information, total)?;
    let at = total - n;
    Some(
        (0..n)
            .map(|i| deviations[at + i] * covariance[at + i].sqrt())
            .collect(),
    )
}
