//! Robust maximum-a-posteriori estimate of offsets and of what disguises itself as them.
//!
//! All joints are estimated together: a wrong mass shows at several joints, a stretched rope at
//! one. Every nuisance parameter has a prior from a data sheet's tolerance; a baseline recording,
//! taken right after tensioning, turns the prior into a posterior that later recordings start
//! from.
//!
//! ```text
//! y = delta_e + d − η d³ + encoder(q) + noise,     d = τ (1 + δκ + c_K ΔT) / K
//! τ = Φ (π₀ + δπ) + payload + F_c z + F_v dq + μ z |τ|
//! ```
//!
//! Gauss–Newton on the whole posterior with a redescending weight on the joint normalised
//! residual of each block (all joints of a block share one weight: a contact shows at several),
//! annealed from a wide scale so that the start doesn't matter.

use super::features::{Block, ENCODER, FeatureConfig};
use crate::arm::{Arm, PARAMETERS_PER_BODY};
use crate::cholesky;
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// Tolerances of a data sheet, as standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Stiffness, relative.
    pub stiffness: f64,
    /// Link mass, relative.
    pub mass: f64,
    /// First mass moment, relative to its size, along itself.
    pub first_moment: f64,
    /// First mass moment across, relative to its size.
    pub first_moment_across: f64,
    /// Inertia, relative.
    pub inertia: f64,
    /// Friction, relative to its nominal value.
    pub friction: f64,
    /// Torque-proportional friction: mean and standard deviation.
    pub load_friction: [f64; 2],
    /// Cubic stiffening `η`, 1/rad²: mean and standard deviation.
    pub stiffening_per_rad2: [f64; 2],
    /// Encoder error, once and twice per turn, rad per component.
    pub encoder_rad: f64,
    /// Drift of the zero with temperature, rad/K.
    pub drift_rad_per_k: f64,
    /// Stiffness change with temperature, 1/K: mean and standard deviation.
    pub stiffness_per_k: [f64; 2],
    /// Payload mass: mean and standard deviation, kg.
    pub payload_kg: [f64; 2],
    /// How far the payload's centre may be from where it is expected, m.
    pub payload_reach_m: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self {
            stiffness: 0.12,
            mass: 0.06,
            first_moment: 0.065,
            first_moment_across: 0.03,
            inertia: 0.15,
            friction: 0.5,
            load_friction: [0.02, 0.01],
            stiffening_per_rad2: [1.0, 0.7],
            encoder_rad: 0.25e-3,
            drift_rad_per_k: 0.1e-3,
            stiffness_per_k: [0.002, 0.001],
            payload_kg: [0.25, 0.25],
            payload_reach_m: 0.05,
        }
    }
}

/// Nominal values of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointPrior {
    /// Nominal stiffness, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Nominal Coulomb friction, N·m.
    pub coulomb_nm: f64,
    /// Nominal viscous friction, N·m·s/rad.
    pub viscous_nm_s_per_rad: f64,
}

/// Entries of the nuisance vector per joint, before the bodies'.
const PER_JOINT: usize = 7 + ENCODER;
const STIFFNESS: usize = 0;
const STIFFENING: usize = 1;
const COULOMB: usize = 2;
const VISCOUS: usize = 3;
const LOAD: usize = 4;
const DRIFT: usize = 5;
const THERMAL: usize = 6;
const HARMONICS: usize = 7;
/// Payload: mass, and three first moments beside where it is expected.
const PAYLOAD: usize = 4;

/// What the nuisance parameters are believed to be: mean and covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct Nuisance {
    /// Means, `d`.
    pub mean: Vec<f64>,
    /// Covariance, row-major `d × d`.
    pub covariance: Vec<f64>,
    /// Temperature the offsets refer to, °C; NaN where unknown.
    pub temperature_c: f64,
}

/// The model whose parameters are estimated, with its priors.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    joints: Vec<Option<JointPrior>>,
    /// Nominal inertial parameters, `10 n`.
    inertial: Vec<f64>,
    /// Body the payload hangs on, and where in its frame it is expected, m.
    payload_body: usize,
    payload_at: [f64; 3],
    tolerances: Tolerances,
}

impl Prior {
    /// Priors for a robot; `payload_at` in the re-based frame of the last body.
    pub fn new(
        arm: &Arm,
        transmissions: &[Option<Transmission>],
        payload_body: usize,
        payload_at: [f64; 3],
        tolerances: Tolerances,
    ) -> Self {
        Self {
            joints: transmissions
                .iter()
                .map(|t| {
                    t.as_ref().map(|t| JointPrior {
                        stiffness_nm_per_rad: t.stiffness_nm_per_rad,
                        coulomb_nm: t.joint_friction.coulomb_nm,
                        viscous_nm_s_per_rad: t.joint_friction.viscous_nm_s_per_rad,
                    })
                })
                .collect(),
            inertial: arm.inertial_parameters(),
            payload_body: payload_body.min(arm.dof().saturating_sub(1)),
            payload_at,
            tolerances,
        }
    }

    fn n(&self) -> usize {
        self.joints.len()
    }

    /// Length of the nuisance vector.
    pub fn dimension(&self) -> usize {
        self.n() * (PER_JOINT + PARAMETERS_PER_BODY) + PAYLOAD
    }

    fn body_start(&self) -> usize {
        self.n() * PER_JOINT
    }

    fn payload_start(&self) -> usize {
        self.n() * (PER_JOINT + PARAMETERS_PER_BODY)
    }

    /// What is believed before any recording; `payload`: whether there may be one.
    pub fn nuisance(&self, payload: bool) -> Nuisance {
        let d = self.dimension();
        let (mut mean, mut deviation) = (alloc::vec![0.0; d], alloc::vec![0.0; d]);
        let t = &self.tolerances;
        for (i, joint) in self.joints.iter().enumerate() {
            let at = i * PER_JOINT;
            let joint = joint.unwrap_or(JointPrior {
                stiffness_nm_per_rad: 1.0,
                coulomb_nm: 0.0,
                viscous_nm_s_per_rad: 0.0,
            });
            let mut set = |k: usize, m: f64, s: f64| {
                mean[at + k] = m;
                deviation[at + k] = s.max(1e-9);
            };
            set(STIFFNESS, 0.0, t.stiffness);
            set(
                STIFFENING,
                t.stiffening_per_rad2[0],
                t.stiffening_per_rad2[1],
            );
            set(COULOMB, joint.coulomb_nm, t.friction * joint.coulomb_nm);
            set(
                VISCOUS,
                joint.viscous_nm_s_per_rad,
                t.friction * joint.viscous_nm_s_per_rad,
            );
            set(LOAD, t.load_friction[0], t.load_friction[1]);
            set(DRIFT, 0.0, t.drift_rad_per_k);
            set(THERMAL, t.stiffness_per_k[0], t.stiffness_per_k[1]);
            for k in 0..ENCODER {
                set(HARMONICS + k, 0.0, t.encoder_rad);
            }
        }
        for b in 0..self.n() {
            let at = self.body_start() + b * PARAMETERS_PER_BODY;
            let pi = &self.inertial[b * PARAMETERS_PER_BODY..(b + 1) * PARAMETERS_PER_BODY];
            let h = libm::sqrt(pi[1] * pi[1] + pi[2] * pi[2] + pi[3] * pi[3]);
            // A body whose centre sits on its joint still may sit 1 cm off.
            let across = (t.first_moment_across * h).max(0.01 * t.mass * pi[0]);
            let trace = pi[4] + pi[7] + pi[9];
            deviation[at] = t.mass * pi[0];
            for k in 1..4 {
                deviation[at + k] = libm::hypot(t.first_moment * pi[k], across);
            }
            for k in 4..PARAMETERS_PER_BODY {
                let diagonal = matches!(k, 4 | 7 | 9);
                deviation[at + k] = if diagonal {
                    t.inertia * pi[k] + 0.01 * t.inertia * trace
                } else {
                    0.2 * t.inertia * trace
                };
            }
            for x in &mut deviation[at..at + PARAMETERS_PER_BODY] {
                *x = x.max(1e-12);
            }
        }
        let at = self.payload_start();
        if payload {
            mean[at] = t.payload_kg[0];
            deviation[at] = t.payload_kg[1];
            for k in 1..PAYLOAD {
                deviation[at + k] = t.payload_kg[1] * t.payload_reach_m;
            }
        } else {
            for x in &mut deviation[at..] {
                *x = 1e-9;
            }
        }
        let mut covariance = alloc::vec![0.0; d * d];
        for (k, s) in deviation.iter().enumerate() {
            covariance[k * d + k] = s * s;
        }
        Nuisance {
            mean,
            covariance,
            temperature_c: f64::NAN,
        }
    }

    /// Compliance of joint `i` over nominal, less one: mean and standard deviation.
    pub fn compliance(&self, nuisance: &Nuisance, i: usize) -> [f64; 2] {
        self.entry(nuisance, i * PER_JOINT + STIFFNESS)
    }

    /// Payload mass: mean and standard deviation, kg.
    pub fn payload_kg(&self, nuisance: &Nuisance) -> [f64; 2] {
        self.entry(nuisance, self.payload_start())
    }

    fn entry(&self, nuisance: &Nuisance, k: usize) -> [f64; 2] {
        let d = self.dimension();
        let at = |x: &[f64], k: usize| x.get(k).copied().unwrap_or(f64::NAN);
        [
            at(&nuisance.mean, k),
            libm::sqrt(at(&nuisance.covariance, k * d + k)),
        ]
    }

    /// A later recording's prior from an earlier one's posterior: the payload is opened again.
    pub fn reopen_payload(&self, nuisance: &mut Nuisance, payload: bool) {
        let fresh = self.nuisance(payload);
        let d = self.dimension();
        for k in self.payload_start()..d {
            nuisance.mean[k] = fresh.mean[k];
            for m in 0..d {
                nuisance.covariance[k * d + m] = 0.0;
                nuisance.covariance[m * d + k] = 0.0;
            }
            nuisance.covariance[k * d + k] = fresh.covariance[k * d + k];
        }
    }
}

/// A stretch of time over which one joint's offset is constant. Where spans of a joint overlap,
/// their offsets add up: a span from a moment to the end is a step at that moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffsetSpan {
    /// Joint.
    pub joint: usize,
    /// From this time on, s.
    pub from_s: f64,
    /// Up to this time, s.
    pub to_s: f64,
    /// Believed before, rad.
    pub mean_rad: f64,
    /// Standard deviation of that belief, rad.
    pub deviation_rad: f64,
}

/// Why there is no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// Nothing to estimate from.
    #[error("the recording has no complete block of data")]
    NoData,
    /// The prior's covariance is not one.
    #[error("the prior's covariance is not positive definite at entry {0}")]
    Prior(usize),
    /// Prior and robot don't go together.
    #[error("the prior has {found} entries, this robot needs {expected}")]
    Dimension {
        /// Entries needed.
        expected: usize,
        /// Entries given.
        found: usize,
    },
}

/// The posterior.
#[derive(Debug, Clone, PartialEq)]
pub struct MapEstimate {
    /// Nuisance parameters.
    pub nuisance: Nuisance,
    /// One offset per span, rad.
    pub offsets_rad: Vec<f64>,
    /// Their standard deviations, rad.
    pub deviations_rad: Vec<f64>,
    /// Robust noise of each joint's blocks, rad.
    pub noise_rad: Vec<f64>,
    /// Weight of each block, 0 (left out) to 1.
    pub weights: Vec<f64>,
    /// Residuals, row-major blocks × n, rad.
    pub residuals_rad: Vec<f64>,
}

/// Solves for offsets and nuisance parameters together.
#[derive(Debug, Clone)]
pub struct MapEstimator {
    prior: Prior,
    /// Correlation time of the noise over the length of a block.
    inflation: f64,
    /// No joint is trusted to better than this, rad.
    noise_floor_rad: f64,
}

impl MapEstimator {
    /// An estimator for the priors of a robot and blocks made with `features`.
    pub fn new(prior: Prior, features: &FeatureConfig) -> Self {
        /// Friction stays for a stroke.
        const STROKE_S: f64 = 0.3;
        // Two time constants of the low-pass every signal has gone through, and a stroke.
        let correlation_s = 2.0 / features.gain_per_s + STROKE_S;
        Self {
            prior,
            inflation: (correlation_s / features.block_s).max(1.0),
            noise_floor_rad: 0.12e-3,
        }
    }

    /// The priors.
    pub fn prior(&self) -> &Prior {
        &self.prior
    }

    /// The estimate from `blocks`, for offsets constant over `spans`.
    ///
    /// # Errors
    /// [`MapError`].
    pub fn solve(
        &self,
        start: &Nuisance,
        spans: &[OffsetSpan],
        blocks: &[Block],
    ) -> Result<MapEstimate, MapError> {
        /// Scales of the redescending weight, in standard deviations.
        const SCALES: [f64; 8] = [40.0, 20.0, 10.0, 6.0, 4.0, 3.5, 3.0, 3.0];
        const ITERATIONS: usize = 2;
        let d = self.prior.dimension();
        if start.mean.len() != d || start.covariance.len() != d * d {
            return Err(MapError::Dimension {
                expected: d,
                found: start.mean.len(),
            });
        }
        if blocks.is_empty() {
            return Err(MapError::NoData);
        }
        let n = self.prior.n();
        let total = d + spans.len();
        let prior_information = inverse(&start.covariance, d).map_err(MapError::Prior)?;
        let mut x = start.mean.clone();
        x.extend(spans.iter().map(|s| s.mean_rad));
        let mut noise: Vec<f64> = alloc::vec![1e-3; n];
        let mut weights = alloc::vec![1.0; blocks.len()];
        let mut residuals = alloc::vec![0.0; blocks.len() * n];
        let mut work = Work::new(total);
        let runs = pose_runs(blocks);
        for (stage, scale) in SCALES.into_iter().enumerate() {
            for _ in 0..ITERATIONS {
                work.clear();
                for i in 0..d {
                    for k in 0..d {
                        work.information[i * total + k] = prior_information[i * d + k];
                        work.gradient[i] += prior_information[i * d + k] * (start.mean[k] - x[k]);
                    }
                }
                for (k, span) in spans.iter().enumerate() {
                    let information = 1.0 / (span.deviation_rad * span.deviation_rad);
                    let at = d + k;
                    work.information[at * total + at] += information;
                    work.gradient[at] += information * (span.mean_rad - x[at]);
                }
                for (b, block) in blocks.iter().enumerate() {
                    self.add_block(
                        block,
                        start.temperature_c,
                        spans,
                        &x,
                        &noise,
                        scale,
                        self.inflation.max(runs[b]),
                        &mut weights[b],
                        &mut residuals[b * n..(b + 1) * n],
                        &mut work,
                    );
                }
                cholesky::factorise(&work.information, &mut work.factor, total)
                    .map_err(MapError::Prior)?;
                cholesky::solve(&work.factor, total, &mut work.gradient);
                for (x, step) in x.iter_mut().zip(&work.gradient) {
                    *x += step;
                }
            }
            // Noise from the residuals, once they mean something.
            if stage >= 1 {
                for (i, noise) in noise.iter_mut().enumerate() {
                    let sizes: Vec<f64> = residuals
                        .iter()
                        .skip(i)
                        .step_by(n)
                        .map(|r| r.abs())
                        .collect();
                    *noise = (1.4826 * median(sizes)).max(self.noise_floor_rad);
                }
            }
        }
        let covariance = inverse(&work.information, total).map_err(MapError::Prior)?;
        let mut nuisance = Nuisance {
            mean: x[..d].to_vec(),
            covariance: alloc::vec![0.0; d * d],
            temperature_c: start.temperature_c,
        };
        for i in 0..d {
            nuisance.covariance[i * d..(i + 1) * d]
                .copy_from_slice(&covariance[i * total..i * total + d]);
        }
        Ok(MapEstimate {
            nuisance,
            offsets_rad: x[d..].to_vec(),
            deviations_rad: (d..total)
                .map(|k| libm::sqrt(covariance[k * total + k]))
                .collect(),
            noise_rad: noise,
            weights,
            residuals_rad: residuals,
        })
    }

    /// Adds a block's rows to the normal equations.
    #[expect(clippy::too_many_arguments, reason = "one pass over a block's data")]
    fn add_block(
        &self,
        block: &Block,
        reference_c: f64,
        spans: &[OffsetSpan],
        x: &[f64],
        noise: &[f64],
        scale: f64,
        inflation: f64,
        weight: &mut f64,
        residuals: &mut [f64],
        work: &mut Work,
    ) {
        let prior = &self.prior;
        let n = prior.n();
        let d = prior.dimension();
        let columns = n * PARAMETERS_PER_BODY;
        let warmer = if block.temperature_c.is_finite() && reference_c.is_finite() {
            block.temperature_c - reference_c
        } else {
            0.0
        };
        work.rows.clear();
        work.ends.clear();
        let (mut chi, mut count) = (0.0, 0.0);
        for i in 0..n {
            let Some(joint) = &prior.joints[i] else {
                work.ends.push(work.rows.len());
                continue;
            };
            let at = i * PER_JOINT;
            let kappa = 1.0 / joint.stiffness_nm_per_rad;
            let phi = &block.phi[i * columns..(i + 1) * columns];
            let bodies = prior.body_start();
            let mut tau = 0.0;
            for (k, phi) in phi.iter().enumerate() {
                tau += phi * (prior.inertial[k] + x[bodies + k]);
            }
            // A point mass where the payload is expected, and its moments beside.
            let load = &phi[prior.payload_body * PARAMETERS_PER_BODY..][..PARAMETERS_PER_BODY];
            let load_columns = payload_columns(load, prior.payload_at);
            let payload = &x[prior.payload_start()..d];
            for (c, p) in load_columns.iter().zip(payload) {
                tau += c * p;
            }
            let z_load = block.z_load[i] * joint.stiffness_nm_per_rad;
            tau += x[at + COULOMB] * block.z[i]
                + x[at + VISCOUS] * block.dq[i]
                + x[at + LOAD] * z_load;
            let soft = 1.0 + x[at + STIFFNESS] + x[at + THERMAL] * warmer;
            let linear = kappa * soft * tau;
            let cubic = x[at + STIFFENING];
            let encoder = &block.encoder[i * ENCODER..(i + 1) * ENCODER];
            let mut expected = linear - cubic * linear * linear * linear + x[at + DRIFT] * warmer;
            for (k, e) in encoder.iter().enumerate() {
                expected += x[at + HARMONICS + k] * e;
            }
            let start = work.rows.len();
            for (k, span) in spans.iter().enumerate() {
                if span.joint == i && (span.from_s..span.to_s).contains(&block.time_s) {
                    expected += x[d + k];
                    work.rows.push((d + k, 1.0));
                }
            }
            let slope = 1.0 - 3.0 * cubic * linear * linear;
            let per_torque = slope * kappa * soft;
            work.rows.push((at + STIFFNESS, slope * kappa * tau));
            work.rows.push((at + STIFFENING, -linear * linear * linear));
            work.rows.push((at + COULOMB, per_torque * block.z[i]));
            work.rows.push((at + VISCOUS, per_torque * block.dq[i]));
            work.rows.push((at + LOAD, per_torque * z_load));
            if warmer != 0.0 {
                work.rows.push((at + DRIFT, warmer));
                work.rows.push((at + THERMAL, slope * kappa * tau * warmer));
            }
            for (k, e) in encoder.iter().enumerate() {
                work.rows.push((at + HARMONICS + k, *e));
            }
            for (k, phi) in phi.iter().enumerate() {
                if *phi != 0.0 {
                    work.rows.push((bodies + k, per_torque * phi));
                }
            }
            for (k, c) in load_columns.iter().enumerate() {
                work.rows.push((prior.payload_start() + k, per_torque * c));
            }
            debug_assert!(work.rows.len() > start);
            work.ends.push(work.rows.len());
            residuals[i] = block.y[i] - expected;
            let r = residuals[i] / noise[i];
            chi += r * r;
            count += 1.0;
        }
        let chi = chi / f64::max(count, 1.0);
        let w = scale * scale / (scale * scale + chi);
        *weight = w * w;
        let mut from = 0;
        for (i, &end) in work.ends.iter().enumerate() {
            let information = *weight / (noise[i] * noise[i] * inflation);
            for a in from..end {
                let (ia, va) = work.rows[a];
                work.gradient[ia] += information * va * residuals[i];
                for b in from..end {
                    let (ib, vb) = work.rows[b];
                    work.information[ia * work.total + ib] += information * va * vb;
                }
            }
            from = end;
        }
    }
}

/// Columns of the payload's mass (as a point where it is expected) and of its moments beside.
fn payload_columns(body: &[f64], at: [f64; 3]) -> [f64; PAYLOAD] {
    let [x, y, z] = at;
    [
        body[0] + x * body[1] + y * body[2] + z * body[3] + (y * y + z * z) * body[4]
            - x * y * body[5]
            - x * z * body[6]
            + (x * x + z * z) * body[7]
            - y * z * body[8]
            + (x * x + y * y) * body[9],
        body[1],
        body[2],
        body[3],
    ]
}

/// For each block, how many blocks the arm stood at the same pose around it.
///
/// What is wrong at a pose (quantisation, stuck friction, an encoder's error) is the same for as
/// long as the arm stands there: a stand counts as one block, however long.
fn pose_runs(blocks: &[Block]) -> Vec<f64> {
    /// Motion below this is a stand, rad: well above an encoder's step and friction's stroke.
    const STAND_RAD: f64 = 0.01;
    let mut runs = alloc::vec![1.0; blocks.len()];
    let mut from = 0;
    for b in 0..=blocks.len() {
        let moved = match (blocks.get(from), blocks.get(b)) {
            (Some(first), Some(now)) => first
                .q
                .iter()
                .zip(&now.q)
                .any(|(a, b)| (a - b).abs() > STAND_RAD),
            _ => true,
        };
        if moved {
            let length = (b - from) as f64;
            for run in &mut runs[from..b] {
                *run = length;
            }
            from = b;
        }
    }
    runs
}

/// Normal equations under construction.
#[derive(Debug, Clone)]
struct Work {
    total: usize,
    information: Vec<f64>,
    factor: Vec<f64>,
    gradient: Vec<f64>,
    /// Rows of a block, as (column, value), one joint after the other.
    rows: Vec<(usize, f64)>,
    ends: Vec<usize>,
}

impl Work {
    fn new(total: usize) -> Self {
        Self {
            total,
            information: alloc::vec![0.0; total * total],
            factor: alloc::vec![0.0; total * total],
            gradient: alloc::vec![0.0; total],
            rows: Vec::with_capacity(4 * total),
            ends: Vec::with_capacity(total),
        }
    }

    fn clear(&mut self) {
        self.information.fill(0.0);
        self.gradient.fill(0.0);
    }
}

/// Inverse of a symmetric positive definite matrix, scaled to unit diagonal first: the
/// parameters' units span fifteen orders of magnitude.
fn inverse(a: &[f64], n: usize) -> Result<Vec<f64>, usize> {
    let mut scale = alloc::vec![0.0; n];
    for i in 0..n {
        let diagonal = a[i * n + i];
        if !(diagonal > 0.0 && diagonal.is_finite()) {
            return Err(i);
        }
        scale[i] = 1.0 / libm::sqrt(diagonal);
    }
    let mut scaled = alloc::vec![0.0; n * n];
    for i in 0..n {
        for k in 0..n {
            scaled[i * n + k] = a[i * n + k] * scale[i] * scale[k];
        }
    }
    let mut l = alloc::vec![0.0; n * n];
    cholesky::factorise(&scaled, &mut l, n)?;
    let mut out = alloc::vec![0.0; n * n];
    let mut column = alloc::vec![0.0; n];
    for k in 0..n {
        column.fill(0.0);
        column[k] = 1.0;
        cholesky::solve(&l, n, &mut column);
        for i in 0..n {
            out[i * n + k] = column[i] * scale[i] * scale[k];
        }
    }
    Ok(out)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
