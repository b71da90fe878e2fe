//! Tensions, torques, energies and their derivatives at one position.

use super::coupling::Coupling;
use super::error::{EvaluationError, check_length};
use crate::error::is_input;
use crate::moment_arm::TendonKind;
use alloc::vec::Vec;

/// Condition of a tendon at one position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TendonStatus {
    /// A strand carries tension, or both strands of a loop do as far as its pretension is specified.
    Taut,
    /// A strand carries no tension.
    Slack,
    /// A loop carries more than twice its pretension, so that one of its strands is slack: the loop is
    /// half as stiff there, which `f = k x` does not describe.
    BeyondPretension,
}

/// Quantity that a Jacobian differentiates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Output {
    /// Tension `f`, length `T`.
    Tension,
    /// Torque `tau_el = Rᵀ f` of the tendons at the joints, length `n`.
    JointTorque,
    /// Torque `tau_motor = Sᵀ f` of the tendons at the motors, length `m`.
    MotorTorque,
}

/// Quantity by which a Jacobian differentiates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Input {
    /// Motor position `theta`, length `m`.
    MotorPosition,
    /// Joint position `q`, length `n`.
    JointPosition,
    /// Elongation `delta`, length `T`.
    Elongation,
}

/// Everything that follows from motor positions, joint positions and elongations; zero until
/// [`Coupling::evaluate`] fills it. Lengths and units are those of the coupling.
#[derive(Debug, Clone, PartialEq)]
pub struct CouplingState {
    moment_arms: Vec<f64>,
    moment_arm_slopes: Vec<f64>,
    extension: Vec<f64>,
    tension: Vec<f64>,
    /// `∂f/∂x`: the stiffness, or 0 of a slack strand.
    pub(super) stiffness: Vec<f64>,
    energy_j: Vec<f64>,
    status: Vec<TendonStatus>,
    tau_el: Vec<f64>,
    tau_spring: Vec<f64>,
    tau_motor: Vec<f64>,
    spring_energy_j: f64,
}

impl CouplingState {
    /// Storage for a coupling; allocates here only.
    pub fn new(coupling: &Coupling) -> Self {
        let zeros = |length| alloc::vec![0.0; length];
        let (n, tendons) = (coupling.joints.len(), coupling.tendons.len());
        Self {
            moment_arms: zeros(tendons * n),
            moment_arm_slopes: zeros(tendons * n),
            extension: zeros(tendons),
            tension: zeros(tendons),
            stiffness: zeros(tendons),
            energy_j: zeros(tendons),
            status: alloc::vec![TendonStatus::Slack; tendons],
            tau_el: zeros(n),
            tau_spring: zeros(n),
            tau_motor: zeros(coupling.motor_names().len()),
            spring_energy_j: 0.0,
        }
    }

    /// Moment arms `R`, row-major `T × n`, in the tendon's coordinate per rad.
    pub fn moment_arms(&self) -> &[f64] {
        &self.moment_arms
    }

    /// Slopes of the moment arms `∂R_ij/∂q_j`, row-major `T × n`; 0 of constant arms.
    pub fn moment_arm_slopes(&self) -> &[f64] {
        &self.moment_arm_slopes
    }

    /// Extension `x = S theta − delta − l(q)` beyond the reference state, in the tendon's coordinate.
    pub fn extension(&self) -> &[f64] {
        &self.extension
    }

    /// Tension `f`, N (N·m where the coordinate is the radian); negative where a loop pulls the other way.
    pub fn tension(&self) -> &[f64] {
        &self.tension
    }

    /// Condition of every tendon.
    pub fn status(&self) -> &[TendonStatus] {
        &self.status
    }

    /// Elastic energy of every tendon, J.
    pub fn energy_j(&self) -> &[f64] {
        &self.energy_j
    }

    /// Elastic energy of the joint springs together, J.
    pub fn spring_energy_j(&self) -> f64 {
        self.spring_energy_j
    }

    /// Elastic torque `tau_el = Rᵀ f` at every joint, N·m, positive where it drives the joint. Joint springs are not in it.
    pub fn tau_el(&self) -> &[f64] {
        &self.tau_el
    }

    /// Torque `tau_spring = k_s (q − q_rest)` of every joint spring, N·m, positive where it pulls back; 0 without a spring.
    pub fn tau_spring(&self) -> &[f64] {
        &self.tau_spring
    }

    /// Torque `tau_motor = Sᵀ f` by which the tendons load every motor, N·m, positive where it brakes positive motion.
    pub fn tau_motor(&self) -> &[f64] {
        &self.tau_motor
    }
}

impl Coupling {
    /// Computes tensions, torques and energies.
    ///
    /// ```text
    /// x = S theta − delta − l(q),   f = k x (loop),   f = max(0, f0 + k x) (strand)
    /// tau_el = R(q)ᵀ f,   tau_motor = Sᵀ f,   tau_spring = k_s (q − q_rest)
    /// V = Σ ½ k x² (loop) + Σ ½ f²/k (strand),   tau_el = −∂V/∂q,   tau_motor = ∂V/∂theta
    /// ```
    ///
    /// For a [diagonal](super::CouplingDescription::diagonal) robot `tau_el` is `K (theta − delta_e − q)`, evaluated in this order.
    ///
    /// * `theta`: motor positions as their encoders measure them, rad, length `m`. `q`: joint positions, rad, length `n`.
    ///   `delta`: elongations in the tendons' coordinates, length `T`.
    ///
    /// # Errors
    /// Returns [`EvaluationError::Length`] and [`EvaluationError::NotFinite`] name the argument; the state is unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(T (n + m)).
    ///
    /// # Source
    /// Virtual work, `tau_elᵀ dq = fᵀ dl`; R. M. Murray, Z. Li and S. S. Sastry, *A Mathematical Introduction to Robotic
    /// Manipulation*, section 6.4 (elastic tendons).
    pub fn evaluate(
        &self,
        state: &mut CouplingState,
        theta: &[f64],
        q: &[f64],
        delta: &[f64],
    ) -> Result<(), EvaluationError> {
        let (n, m) = (self.joints.len(), self.motor_names().len());
        self.check_state(state)?;
        for (input, values, expected) in [
            ("theta", theta, m),
            ("q", q, n),
            ("delta", delta, self.tendons.len()),
        ] {
            check_length(input, values.len(), expected)?;
            if !values.iter().all(|value| is_input(*value)) {
                return Err(EvaluationError::NotFinite { input });
            }
        }
        state.tau_el.fill(0.0);
        state.tau_motor.fill(0.0);
        let drums = rows(&self.drums, m);
        let arms = (state.moment_arms.chunks_exact_mut(n.max(1)))
            .zip(state.moment_arm_slopes.chunks_exact_mut(n.max(1)));
        let elastic = (state.extension.iter_mut().zip(&mut state.tension))
            .zip(state.stiffness.iter_mut().zip(&mut state.energy_j))
            .zip(&mut state.status);
        let tendons = self.tendons.iter().zip(delta).zip(drums);
        for (((tendon, delta), s), ((r, slopes), (((x, f), (k, energy)), status))) in
            tendons.zip(arms.zip(elastic))
        {
            // Shortening of the path and its derivatives.
            let mut l = 0.0;
            for (joint, arm) in &tendon.arms {
                if let (Some(q), Some(r), Some(slope)) =
                    (q.get(*joint), r.get_mut(*joint), slopes.get_mut(*joint))
                {
                    let [shortening, arm, arm_slope] = arm.evaluate(*q);
                    l += shortening;
                    (*r, *slope) = (arm, arm_slope);
                }
            }
            // Extension, tension and energy.
            *x = product(s, theta) - delta - l;
            let stiffness = tendon.stiffness;
            (*f, *k, *energy, *status) = match tendon.kind {
                TendonKind::Loop => {
                    let f = stiffness * *x;
                    let status = match tendon.pretension {
                        Some(f0) if f.abs() > 2.0 * f0 => TendonStatus::BeyondPretension,
                        _ => TendonStatus::Taut,
                    };
                    (f, stiffness, 0.5 * f * *x, status)
                }
                TendonKind::Strand => {
                    let f = tendon.pretension.unwrap_or(0.0) + stiffness * *x;
                    if f > 0.0 {
                        (f, stiffness, 0.5 * f * f / stiffness, TendonStatus::Taut)
                    } else {
                        (0.0, 0.0, 0.0, TendonStatus::Slack)
                    }
                }
            };
            // Torques on both sides.
            add_scaled(&mut state.tau_el, r, *f);
            add_scaled(&mut state.tau_motor, s, *f);
        }
        state.spring_energy_j = 0.0;
        for ((joint, q), tau) in self.joints.iter().zip(q).zip(&mut state.tau_spring) {
            if let Some(spring) = joint.spring {
                *tau = spring.stiffness_nm_per_rad * (q - spring.rest_rad);
                state.spring_energy_j += 0.5 * *tau * (q - spring.rest_rad);
            }
        }
        Ok(())
    }

    /// Writes the Jacobian of an output with respect to an input, row-major, to `out`.
    ///
    /// With `A` the identity, `R` or `S` of the output and `B` the identity, `R` or `S` of the input, `K` the stiffness of taut
    /// tendons (0 of slack ones):
    ///
    /// ```text
    /// ∂/∂theta = Aᵀ K S,   ∂/∂q = −Aᵀ K R,   ∂/∂delta = −Aᵀ K;   of tau_el by q also + diag(Σ_i f_i ∂R_ij/∂q_j)
    /// ```
    ///
    /// * `state`: as [`evaluate`](Self::evaluate) left it. `out`: length of the output times length of the input.
    ///
    /// # Errors
    /// Returns [`EvaluationError::Length`] of `state` or `out`; `out` is unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(T) times the length of `out`.
    pub fn jacobian(
        &self,
        state: &CouplingState,
        output: Output,
        input: Input,
        out: &mut [f64],
    ) -> Result<(), EvaluationError> {
        self.check_state(state)?;
        let (n, m, tendons) = (
            self.joints.len(),
            self.motor_names().len(),
            self.tendons.len(),
        );
        let (side_a, height) = match output {
            Output::Tension => (None, tendons),
            Output::JointTorque => (Some((&state.moment_arms, n)), n),
            Output::MotorTorque => (Some((&self.drums, m)), m),
        };
        let (side_b, width, sign) = match input {
            Input::MotorPosition => (Some((&self.drums, m)), m, 1.0),
            Input::JointPosition => (Some((&state.moment_arms, n)), n, -1.0),
            Input::Elongation => (None, tendons, -1.0),
        };
        check_length("out", out.len(), height * width)?;
        out.fill(0.0);
        for (i, k) in state.stiffness.iter().enumerate() {
            let (first_a, a) = row(side_a, i);
            let (first_b, b) = row(side_b, i);
            for (line, a) in out.chunks_exact_mut(width.max(1)).skip(first_a).zip(a) {
                let scale = sign * k * a;
                for (to, b) in line.iter_mut().skip(first_b).zip(b) {
                    *to += scale * b;
                }
            }
        }
        if (output, input) == (Output::JointTorque, Input::JointPosition) {
            for (slopes, f) in rows(&state.moment_arm_slopes, n).zip(&state.tension) {
                for (to, slope) in out.iter_mut().step_by(n + 1).zip(slopes) {
                    *to += f * slope;
                }
            }
        }
        Ok(())
    }

    /// Writes the joint stiffness `∂(tau_spring − tau_el)/∂q = Rᵀ K R − diag(Σ_i f_i ∂R_ij/∂q_j) + diag(k_s)`, N·m/rad, row-major
    /// `n × n`, to `out`. Motors are at rest.
    ///
    /// # Errors
    /// Returns the errors of [`jacobian`](Self::jacobian).
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(T n²).
    pub fn joint_stiffness(
        &self,
        state: &CouplingState,
        out: &mut [f64],
    ) -> Result<(), EvaluationError> {
        self.jacobian(state, Output::JointTorque, Input::JointPosition, out)?;
        out.iter_mut().for_each(|to| *to = -*to);
        let diagonal = out.iter_mut().step_by(self.joints.len() + 1);
        for (to, joint) in diagonal.zip(&self.joints) {
            *to += joint
                .spring
                .map_or(0.0, |spring| spring.stiffness_nm_per_rad);
        }
        Ok(())
    }

    /// Checks that a state has the lengths of this coupling.
    pub(super) fn check_state(&self, state: &CouplingState) -> Result<(), EvaluationError> {
        check_length("state.tension", state.tension.len(), self.tendons.len())?;
        check_length("state.tau_el", state.tau_el.len(), self.joints.len())?;
        check_length(
            "state.tau_motor",
            state.tau_motor.len(),
            self.motor_names().len(),
        )
    }
}

/// Rows of a row-major matrix; endless empty rows where it has no columns.
fn rows(matrix: &[f64], width: usize) -> impl Iterator<Item = &[f64]> {
    let empty: &[f64] = &[];
    let filler = core::iter::repeat_n(empty, if width == 0 { usize::MAX } else { 0 });
    matrix.chunks_exact(width.max(1)).chain(filler)
}

/// First column and values of row `i` of a matrix, or of the identity.
fn row(matrix: Option<(&Vec<f64>, usize)>, i: usize) -> (usize, &[f64]) {
    match matrix {
        None => (i, &[1.0]),
        Some((values, width)) => (0, rows(values, width).nth(i).unwrap_or(&[])),
    }
}

/// Scalar product; one term alone is exact.
fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

/// Adds `scale · values` to `to`.
pub(super) fn add_scaled(to: &mut [f64], values: &[f64], scale: f64) {
    for (to, value) in to.iter_mut().zip(values) {
        *to += scale * value;
    }
}
