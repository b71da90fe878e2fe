//! The Bayesian Cramér–Rao bound of the offset: a lower bound of the mean error of any estimator.
//!
//! The model of the estimator is linearised at the true parameters of a recording, with respect to all random
//! parameters. The information of sessions A and B is added to the prior information:
//!
//! ```text
//! J = P₀⁻¹ + Σ_(joint, session) Hᵀ C⁻¹ H,     bound of an offset = √(J⁻¹)_(offset, offset)
//! y = delta_e + d − η d³ + (α_T + c_T d) ΔT + encoder(q) + noise,     d = τ/K
//! τ = Φ π + F_c z + F_v dq + μ z |τ|
//! ```
//!
//! * `P₀`: variances of the random parameters of the protocol (for a uniform draw, its variance). The offsets of B
//!   have a standard deviation of 30 mrad, and those of A are zero. The harmonics of the encoder error, the payload
//!   mass and the uncertain part of `ΔT` are parameters, too.
//! * `C`: covariance of the filtered sensor errors: the difference of the features with and without quantisation and
//!   noise, at the true parameters. It includes the effect of quantised positions on velocities and on the friction
//!   state. The errors are assumed stationary, with their autocovariance over A and B. The motor torque is not used.
//!
//! The following are assumed exact, which makes the bound lower than any estimator's error: the forms of friction and
//! spring, the pre-sliding trajectory except for the effect of quantisation, the grip position of the payload, and
//! the contact times (excluded, with the one second that the filters remember). The following makes it higher than
//! the attainable minimum: quantisation is white in motion and one number at rest, so that an estimator that modelled
//! this would give motion more weight; with that, and with regressors free of error, the sensors alone would allow
//! 0.01 mrad.

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
/// Number of random parameters of a body: mass, shift of the centre of mass along one axis and across two, inertia.
const PER_BODY: usize = 5;
/// Entries of a body in the regressor.
const COLUMNS: usize = 10;
/// Prior half-range of an offset, rad.
const OPEN_RAD: f64 = 0.03;
/// The filters remember a contact for about three of their time constants, s.
const MEMORY_S: f64 = 1.0;

/// Receiver of the error-free sensor values.
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

    /// Receives the truth of the latest frame of session `k`; sessions after B are ignored.
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

    /// Returns the bound of every joint's offset in B, rad; `None` if the information matrix is singular.
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
    let stds = draws::stds(plan, &truth, robot);
    let total = stds.len();
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
                    for (x, s) in row.iter_mut().zip(&stds) {
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
            .map(|i| stds[at + i] * covariance[at + i].sqrt())
            .collect(),
    )
}
