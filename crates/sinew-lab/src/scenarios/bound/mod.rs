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

mod linear;
mod noise;

use super::{Plan, estimator};
use crate::absolute::{Recorded, Recorder};
use crate::simulate::Simulation;
use crate::simulate::scenario::{Draw, PerJoint};
use noise::Autocovariance;
use sinew_log::Frame;
use sinew_model::arm::{Arm, BodyInertia};
use sinew_model::offset::{Block, FeatureConfig};
use sinew_model::robot::Robot;

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

/// True values of a joint.
struct Joint {
    stiffness: f64,
    cubic: f64,
    coulomb: f64,
    viscous: f64,
    load: f64,
    drift: f64,
    thermal: f64,
}

/// Where the model is differentiated.
struct Truth {
    joints: Vec<Joint>,
    /// Inertial parameters per session, `10 n`, payload included.
    inertial: [Vec<f64>; 2],
    /// Change of `inertial` per draw of each body: `n × 5 × 10`.
    per_draw: Vec<[f64; COLUMNS]>,
    /// Change of `inertial` per kg of payload, `10 n`.
    per_kg: Vec<f64>,
    change_k: f64,
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
    let deviations = deviations(plan, &truth, robot);
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

impl Truth {
    fn of(plan: &Plan, simulation: &Simulation) -> Option<Self> {
        let n = plan.robot.arm.dof();
        let arm = simulation.true_empty_arm();
        let temperature = simulation.temperature();
        let joints = simulation
            .drives()
            .iter()
            .enumerate()
            .map(|(i, drive)| Joint {
                stiffness: drive.stiffness_nm_per_rad,
                cubic: drive.cubic_per_rad2,
                coulomb: drive.joint_friction.coulomb_nm,
                viscous: drive.joint_friction.viscous_nm_s_per_rad,
                load: drive.joint_friction.torque_fraction,
                drift: temperature.drift_rad_per_k[i],
                thermal: -temperature.stiffness_per_k[i],
            })
            .collect();
        let empty = arm.inertial_parameters();
        let (mut loaded, mut per_kg) = (empty.clone(), vec![0.0; n * COLUMNS]);
        let begin_s = plan.scenario.sessions[1].from_s;
        for p in simulation
            .payloads()
            .iter()
            .filter(|p| p.attach_s <= begin_s)
        {
            let unit = arm
                .with_payload(&p.link, BodyInertia::point(1.0, p.com_m))
                .ok()??;
            for ((kg, with), without) in per_kg
                .iter_mut()
                .zip(unit.inertial_parameters())
                .zip(&empty)
            {
                *kg = with - without;
            }
            for (x, kg) in loaded.iter_mut().zip(&per_kg) {
                *x += p.mass_kg * kg;
            }
        }
        Some(Self {
            joints,
            inertial: [empty, loaded],
            per_draw: (0..n)
                .map(|b| per_draw(arm, b))
                .collect::<Option<Vec<_>>>()?
                .concat(),
            per_kg,
            change_k: temperature.change_k,
        })
    }

    /// Elastic torque over stiffness of joint `i` in a block, rad.
    fn deflection(&self, block: &Block, i: usize, session: usize, n: usize) -> f64 {
        let joint = &self.joints[i];
        let phi = &block.phi[i * n * COLUMNS..(i + 1) * n * COLUMNS];
        let tau = dot(phi, &self.inertial[session])
            + joint.coulomb * block.z[i]
            + joint.viscous * block.dq[i]
            + joint.load * block.z_load[i] * joint.stiffness;
        tau / joint.stiffness
    }

    /// What the sensors' errors do to the residual of each joint, block by block.
    fn errors(&self, clean: &[Recorded], noisy: &[Recorded], n: usize) -> Vec<Autocovariance> {
        let residual = |block: &Block, i: usize, session: usize| {
            let d = self.deflection(block, i, session, n);
            block.y[i] - d + self.joints[i].cubic * d * d * d
        };
        (0..n)
            .map(|i| {
                let series: Vec<Vec<f64>> = clean
                    .iter()
                    .zip(noisy)
                    .enumerate()
                    .map(|(session, (clean, noisy))| {
                        clean
                            .blocks
                            .iter()
                            .zip(&noisy.blocks)
                            .map(|(c, m)| residual(m, i, session) - residual(c, i, session))
                            .collect()
                    })
                    .collect();
                Autocovariance::of(&series, FeatureConfig::default().block_s)
            })
            .collect()
    }

    /// Derivatives of `y` of joint `i` in a block, rad per unit of each parameter.
    fn row(&self, block: &Block, i: usize, session: usize, n: usize, total: usize) -> Vec<f64> {
        let mut row = vec![0.0; total];
        let joint = &self.joints[i];
        let phi = &block.phi[i * n * COLUMNS..(i + 1) * n * COLUMNS];
        let d = self.deflection(block, i, session, n);
        let slope = 1.0 - 3.0 * joint.cubic * d * d;
        let per_torque = slope / joint.stiffness;
        let warmer = if session == 0 { 0.0 } else { self.change_k };
        let own = [
            slope * d,
            -d * d * d,
            per_torque * block.z[i],
            per_torque * block.dq[i],
            slope * block.z_load[i],
            warmer,
            slope * d * warmer,
        ];
        let at = i * PER_JOINT;
        row[at..at + own.len()].copy_from_slice(&own);
        row[at + own.len()..at + PER_JOINT].copy_from_slice(&block.encoder[i * 4..(i + 1) * 4]);
        let bodies = n * PER_JOINT;
        for (k, change) in self.per_draw.iter().enumerate() {
            let body = k / PER_BODY;
            let columns = &phi[body * COLUMNS..(body + 1) * COLUMNS];
            row[bodies + k] = per_torque * dot(columns, change);
        }
        let rest = bodies + n * PER_BODY;
        if session == 1 {
            row[rest] = per_torque * dot(phi, &self.per_kg);
            row[rest + 1] = joint.drift + slope * d * joint.thermal;
            row[rest + 2 + i] = 1.0;
        }
        row
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// How the inertial parameters of body `b` change per draw, by central differences: they are at
/// most quadratic in each, so that the step doesn't matter.
fn per_draw(arm: &Arm, b: usize) -> Option<Vec<[f64; COLUMNS]>> {
    const STEP: f64 = 1e-2;
    let body = arm.body(b)?;
    let [x, y, z] = body.com;
    let length = (x * x + y * y + z * z).sqrt();
    // Two directions across the centre of mass's own.
    let least = (0..3).min_by(|&a, &c| body.com[a].abs().total_cmp(&body.com[c].abs()))?;
    let across = |turn: usize| -> [f64; 3] {
        let (p, q) = ((least + 1) % 3, (least + 2) % 3);
        let mut v = [0.0; 3];
        (v[p], v[q]) = (body.com[q], -body.com[p]);
        let w = [
            y * v[2] - z * v[1],
            z * v[0] - x * v[2],
            x * v[1] - y * v[0],
        ];
        let v = if turn == 0 { v } else { w };
        let norm = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|c| if norm > 0.0 { c / norm } else { 0.0 })
    };
    let drawn = |k: usize, step: f64| -> Option<Vec<f64>> {
        let mut changed = body;
        match k {
            0 => {
                changed.mass *= 1.0 + step;
                changed.inertia = changed.inertia.map(|r| r.map(|v| v * (1.0 + step)));
            }
            1 => changed.com = changed.com.map(|c| c * (1.0 + step)),
            2 | 3 => {
                let v = across(k - 2);
                changed.com = std::array::from_fn(|m| body.com[m] + step * length * v[m]);
            }
            _ => changed.inertia = changed.inertia.map(|r| r.map(|v| v * (1.0 + step))),
        }
        Some(arm.with_body(b, changed).ok()?.inertial_parameters())
    };
    (0..PER_BODY)
        .map(|k| {
            let (up, down) = (drawn(k, STEP)?, drawn(k, -STEP)?);
            let own = b * COLUMNS;
            Some(std::array::from_fn(|m| {
                (up[own + m] - down[own + m]) / (2.0 * STEP)
            }))
        })
        .collect()
}

/// Standard deviations of the protocol's draws, in the order of a row.
fn deviations(plan: &Plan, truth: &Truth, robot: &Robot) -> Vec<f64> {
    let s = &plan.scenario;
    let names = robot.joint_names();
    let mut out = Vec::new();
    for (name, joint) in names.iter().zip(&truth.joints) {
        let of = |per: &PerJoint| spread(per, name);
        let encoder = &s.encoder;
        // An amplitude at a random phase: half its variance in sine and cosine each.
        let once = of(&encoder.once_per_turn_rad) * std::f64::consts::FRAC_1_SQRT_2;
        let twice = of(&encoder.twice_per_turn_rad) * std::f64::consts::FRAC_1_SQRT_2;
        out.extend([
            // Relative, of the stiffness that is: the compliance as far.
            of(&s.truth.stiffness_factor) * nominal(robot, name) / joint.stiffness,
            of(&s.truth.spring_cubic_per_rad2),
            of(&s.joint_friction.coulomb_nm),
            of(&s.joint_friction.viscous_nm_s_per_rad),
            of(&s.joint_friction.torque_fraction),
            of(&s.temperature.zero_drift_rad_per_k),
            of(&s.temperature.stiffness_per_k),
            once,
            once,
            twice,
            twice,
        ]);
    }
    for name in names {
        let of = |per: &PerJoint| spread(per, name);
        let across = of(&s.truth.com_across_fraction) * std::f64::consts::FRAC_1_SQRT_2;
        out.extend([
            of(&s.truth.mass_factor),
            of(&s.truth.com_factor),
            across,
            across,
            of(&s.truth.inertia_factor),
        ]);
    }
    out.push(s.payloads.first().map_or(0.0, |p| deviation(p.mass_kg)));
    out.push(deviation(s.temperature.reading_error_k));
    out.extend(names.iter().map(|_| OPEN_RAD));
    out
}

fn nominal(robot: &Robot, name: &str) -> f64 {
    let joint = robot.arm.joint_index(name);
    joint
        .and_then(|i| robot.transmissions[i].as_ref())
        .map_or(0.0, |t| t.stiffness_nm_per_rad)
}

fn spread(per: &PerJoint, name: &str) -> f64 {
    let own = per.by_joint.iter().find(|(n, _, _)| n == name);
    own.map(|(_, _, d)| *d).or(per.all).map_or(0.0, deviation)
}

fn deviation(draw: Draw) -> f64 {
    match draw {
        Draw::Fixed(_) => 0.0,
        Draw::Uniform { min, max } => (max - min) / 12f64.sqrt(),
        Draw::Normal { std, .. } => std,
    }
}
