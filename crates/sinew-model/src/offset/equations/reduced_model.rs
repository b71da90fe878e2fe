//! The model with the bodies' parameters in base form: those that blocks carry information about.
//!
//! A block's equations depend on the bodies through `Φ π = Φ_c z` only, `z = B π` the base
//! parameters ([`BaseParameters`]): half as many as there are masses, moments and inertias. The
//! prior of `π` gives that of `z`, the data moves `z`, and the posterior of `π` follows:
//!
//! ```text
//! x = T s,   s: joints, π, payload;   x: joints, z, payload
//! E[s | data] = m + G (E[x | data] − T m),   G = C Tᵀ (T C Tᵀ)⁻¹
//! cov = C − G (T C Tᵀ − cov x) Gᵀ
//! ```
//!
//! with `m`, `C` the prior of `s`. Nothing is lost or approximated; joints and payload come out
//! as they went in.

use crate::arm::{BaseParameters, PARAMETERS_PER_BODY};
use crate::cholesky::{self, Factor};
use crate::offset::block::Block;
use crate::offset::change::Appearance;
use crate::offset::effects::JointParameter;
use crate::offset::effects::payload::furthest_m;
use crate::offset::error::MapError;
use crate::offset::joint_prior::JointPrior;
use crate::offset::layout::Layout;
use crate::offset::prior::Prior;
use crate::offset::state_estimate::StateEstimate;
use crate::routings::Routings;
use alloc::vec::Vec;

/// The model whose parameters blocks can identify.
#[derive(Debug, Clone)]
pub(crate) struct ReducedModel {
    pub(crate) layout: Layout,
    pub(crate) joints: Vec<Option<JointPrior>>,
    /// How sudden changes appear in blocks.
    pub(crate) appears: Appearance,
    /// Nominal base parameters.
    pub(crate) inertial: Vec<f64>,
    /// Expected point of the payload in its frame, m.
    pub(crate) payload_at: [f64; 3],
    /// Standard deviation of the payload's distance from that point, m.
    pub(crate) payload_furthest_m: f64,
    /// Columns of the body that carries the payload: those of `Φ_c` each is made of, and how much.
    payload_columns: Vec<(usize, usize, f64)>,
    /// Routings of tendons that cross several joints.
    pub(crate) routes: Option<Routings>,
    base: BaseParameters,
    /// Number of inertial parameters of all bodies.
    all_inertial: usize,
}

impl ReducedModel {
    pub(crate) fn new(prior: &Prior, appears: Appearance) -> Self {
        let base = prior.base.clone();
        let all = prior.inertial.len();
        let first = prior.payload_body * PARAMETERS_PER_BODY;
        let rows = base.combination.chunks_exact(all.max(1)).enumerate();
        let payload_columns = rows
            .flat_map(|(i, row)| {
                let own = row.iter().skip(first).take(PARAMETERS_PER_BODY);
                own.enumerate().map(move |(k, b)| (i, k, *b))
            })
            .filter(|(.., b)| *b != 0.0)
            .collect();
        Self {
            layout: Layout {
                bodies: base.count(),
                ..prior.layout()
            },
            joints: prior.joints.clone(),
            appears,
            inertial: base.of(&prior.inertial),
            payload_at: prior.payload_at,
            payload_furthest_m: furthest_m(prior.reach_m()),
            payload_columns,
            routes: prior.routes.clone(),
            base,
            all_inertial: all,
        }
    }

    /// Whether axis `i` has a tendon.
    pub(crate) fn is_elastic(&self, i: usize) -> bool {
        let joint = self.joints.get(i).and_then(Option::as_ref);
        joint.is_some_and(|joint| joint.has_tendon)
    }

    /// Returns the joints whose compliance has a relative prior standard deviation below `std`.
    pub(crate) fn stiffness_with_prior(
        &self,
        state_estimate: &StateEstimate,
        std: f64,
    ) -> Vec<usize> {
        let place = |i| self.layout.place(i, JointParameter::Compliance);
        let has_prior = |i| state_estimate.entry(place(i)).std < std;
        let elastic = (0..self.layout.joints).filter(|&i| self.is_elastic(i));
        elastic.filter(|&i| has_prior(i)).collect()
    }

    /// Returns the regressor `Φ` of a joint in a block.
    pub(crate) fn phi<'b>(&self, block: &'b Block, joint: usize) -> Option<&'b [f64]> {
        let r = self.layout.bodies;
        block.phi.get(joint * r..(joint + 1) * r)
    }

    /// The ten columns of the payload's body from those of `Φ`.
    pub(crate) fn payload_phi(&self, phi: &[f64]) -> [f64; PARAMETERS_PER_BODY] {
        let mut out = [0.0; PARAMETERS_PER_BODY];
        for &(i, k, b) in &self.payload_columns {
            if let (Some(to), Some(phi)) = (out.get_mut(k), phi.get(i)) {
                *to += b * phi;
            }
        }
        out
    }

    /// `T s`, changes after it as they are.
    pub(crate) fn reduced(&self, state: &[f64]) -> Vec<f64> {
        let from = self.layout.body_start();
        let to = from + self.all_inertial;
        let mut out = Vec::with_capacity(state.len());
        out.extend_from_slice(&state[..from]);
        out.extend(self.base.of(&state[from..to]));
        out.extend_from_slice(&state[to..]);
        out
    }

    /// Transforms a posterior to this model's parameters: `T m`, `T C Tᵀ`.
    pub(crate) fn reduced_estimate(&self, state_estimate: &StateEstimate) -> StateEstimate {
        StateEstimate {
            mean: self.reduced(&state_estimate.mean),
            covariance: self
                .reduced_covariance(&state_estimate.covariance, state_estimate.mean.len()),
            temperature_c: state_estimate.temperature_c,
        }
    }

    /// Returns `T C Tᵀ` of a covariance with `total` rows; entries of changes are unchanged.
    pub(crate) fn reduced_covariance(&self, covariance: &[f64], total: usize) -> Vec<f64> {
        // T C, then T (T C)ᵀ.
        let half = self.reduced_rows(covariance, total);
        let rows = half.len() / total.max(1);
        self.reduced_rows(&transposed(&half, total), rows)
    }

    /// Returns `T` times the rows of a matrix with `columns` columns.
    fn reduced_rows(&self, rows: &[f64], columns: usize) -> Vec<f64> {
        let from = self.layout.body_start();
        let all = self.all_inertial;
        let bodies = &rows[from * columns..(from + all) * columns];
        let mut out = rows[..from * columns].to_vec();
        for combination in self.base.combination.chunks_exact(all.max(1)) {
            let mut sum = alloc::vec![0.0; columns];
            for (b, row) in combination.iter().zip(bodies.chunks_exact(columns.max(1))) {
                if *b != 0.0 {
                    for (to, x) in sum.iter_mut().zip(row) {
                        *to += b * x;
                    }
                }
            }
            out.extend(sum);
        }
        out.extend_from_slice(&rows[(from + all) * columns..]);
        out
    }

    /// A state of this model and its covariance, estimated from `before`, in terms of all bodies'
    /// parameters; changes after it as they are.
    pub(crate) fn completed(
        &self,
        before: &StateEstimate,
        state: &[f64],
        covariance: &[f64],
    ) -> Result<(Vec<f64>, Vec<f64>), MapError> {
        let (d, r) = (before.mean.len(), self.layout.dimension());
        let from = self.layout.body_start();
        let all = self.all_inertial;
        let total = state.len();
        let start = self.reduced_estimate(before);
        let factor = Factor::of(&start.covariance, r).map_err(MapError::Prior)?;
        // Rows of G of the bodies, and (C Tᵀ) they are made of.
        let shared = transposed(&self.reduced_rows(&before.covariance, d), d);
        let shared = &shared[from * r..(from + all) * r];
        let mut gain = shared.to_vec();
        for row in gain.chunks_exact_mut(r) {
            factor.solve(row);
        }
        // cov(body, x and changes).
        let mut along = alloc::vec![0.0; all * total];
        for (to, gain) in along.chunks_exact_mut(total).zip(gain.chunks_exact(r)) {
            for (g, row) in gain.iter().zip(covariance.chunks_exact(total)) {
                for (to, x) in to.iter_mut().zip(row) {
                    *to += g * x;
                }
            }
        }
        // Where entry k of x, or of the changes after it, is in s.
        let bodies = from..self.layout.payload_place();
        let more = d - r;
        let place = |k: usize| if k < from { k } else { k + more };
        let whole = total + more;
        let (mut mean, mut out) = (alloc::vec![0.0; whole], alloc::vec![0.0; whole * whole]);
        let others: Vec<usize> = (0..total).filter(|k| !bodies.contains(k)).collect();
        for &i in &others {
            mean[place(i)] = state[i];
            for &k in &others {
                out[place(i) * whole + place(k)] = covariance[i * total + k];
            }
        }
        for (b, gain) in gain.chunks_exact(r).enumerate() {
            let moved = state.iter().zip(&start.mean).zip(gain);
            let step: f64 = moved.map(|((x, m), g)| g * (x - m)).sum();
            mean[from + b] = before.mean[from + b] + step;
            let own = &along[b * total..(b + 1) * total];
            for &k in &others {
                out[(from + b) * whole + place(k)] = own[k];
                out[place(k) * whole + from + b] = own[k];
            }
        }
        for (b, own) in along.chunks_exact(total).enumerate() {
            // C − G (T C Tᵀ) Gᵀ + G cov Gᵀ, of bodies b and c.
            let shared_b = &shared[b * r..(b + 1) * r];
            for (c, gain_c) in gain.chunks_exact(r).enumerate().take(b + 1) {
                let conditional =
                    before.covariance[(from + b) * d + from + c] - cholesky::dot(shared_b, gain_c);
                let x = conditional + cholesky::dot(&own[..r], gain_c);
                out[(from + b) * whole + from + c] = x;
                out[(from + c) * whole + from + b] = x;
            }
        }
        Ok((mean, out))
    }
}

/// Returns the transpose of a matrix with `columns` columns.
fn transposed(rows: &[f64], columns: usize) -> Vec<f64> {
    let count = rows.len() / columns.max(1);
    let mut out = alloc::vec![0.0; rows.len()];
    for (i, row) in rows.chunks_exact(columns.max(1)).enumerate() {
        for (k, x) in row.iter().enumerate() {
            out[k * count + i] = *x;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{ArmBuilder, BodyInertia, BodySpec, JointKind, Pose};
    use crate::offset::fixtures::random;
    use crate::offset::state_estimate::{Payload, UNKNOWN_OFFSET_RAD};
    use crate::tolerances::Tolerances;
    use alloc::string::String;
    use alloc::vec;

    /// Two joints across each other.
    fn prior() -> Prior {
        let body = |parent: Option<usize>, x: f64, roll: f64| BodySpec {
            name: String::from(if parent.is_none() { "one" } else { "two" }),
            parent,
            kind: JointKind::Revolute,
            axis: [0.0, 0.0, 1.0],
            placement: Pose::from_xyz_rpy([x, 0.02, 0.1], [roll, 0.3, 0.0]),
            body: BodyInertia::point(1.2, [0.1, 0.05, 0.02]),
        };
        let arm = ArmBuilder::new()
            .body(body(None, 0.0, 0.4))
            .body(body(Some(0), 0.3, 1.5))
            .build()
            .unwrap();
        Prior::new(&arm, &[None, None], 1, [0.0; 3], Tolerances::default())
    }

    /// Creates a posterior after measurements of all entries, which correlate all of them.
    fn learned(prior: &Prior, seed: &mut u64) -> StateEstimate {
        let mut state_estimate = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
        let d = state_estimate.mean.len();
        let std: Vec<f64> = (0..d).map(|k| state_estimate.entry(k).std).collect();
        for _ in 0..2 * d {
            let row: Vec<f64> = std.iter().map(|s| random(seed) / s).collect();
            update(
                &mut state_estimate.mean,
                &mut state_estimate.covariance,
                &row,
                random(seed),
                1.0,
            );
        }
        state_estimate
    }

    /// Updates with a measurement of `row · x`, given as its deviation `value` from the prediction and a standard
    /// deviation.
    fn update(mean: &mut [f64], covariance: &mut [f64], row: &[f64], value: f64, std: f64) {
        let d = mean.len();
        let along: Vec<f64> = covariance
            .chunks_exact(d)
            .map(|line| cholesky::dot(line, row))
            .collect();
        let spread = cholesky::dot(&along, row) + std * std;
        for i in 0..d {
            mean[i] += along[i] * value / spread;
            for k in 0..d {
                covariance[i * d + k] -= along[i] * along[k] / spread;
            }
        }
    }

    #[test]
    fn base_parameter_information_equals_body_information() {
        let mut seed = 3;
        let prior = prior();
        let model = ReducedModel::new(&prior, Appearance::AT_ONCE);
        assert!(model.layout.bodies < 20, "{}", model.layout.bodies);
        let before = learned(&prior, &mut seed);
        let d = before.mean.len();
        let start = model.reduced_estimate(&before);
        // The same data on both, and on a change that comes after them.
        let more = |state_estimate: &StateEstimate| {
            let d = state_estimate.mean.len();
            let mut mean = state_estimate.mean.clone();
            mean.push(0.0);
            let mut covariance = vec![0.0; (d + 1) * (d + 1)];
            for (to, from) in covariance
                .chunks_exact_mut(d + 1)
                .zip(state_estimate.covariance.chunks_exact(d))
            {
                to[..d].copy_from_slice(from);
            }
            covariance[(d + 1) * (d + 1) - 1] = 0.3;
            (mean, covariance)
        };
        let (mut whole, mut whole_covariance) = more(&before);
        let (mut part, mut part_covariance) = more(&start);
        for _ in 0..60 {
            let row: Vec<f64> = (0..part.len())
                .map(|k| random(&mut seed) / part_covariance[k * (part.len() + 1)].sqrt())
                .collect();
            let (value, std) = (random(&mut seed), 0.7);
            update(&mut part, &mut part_covariance, &row, value, std);
            // rowᵀ T of all bodies' parameters.
            let from = model.layout.body_start();
            let mut full = row[..from].to_vec();
            for column in 0..20 {
                let bodies = model.base.combination.chunks_exact(20);
                full.push(bodies.zip(&row[from..]).map(|(b, r)| b[column] * r).sum());
            }
            full.extend(&row[model.layout.payload_place()..]);
            update(&mut whole, &mut whole_covariance, &full, value, std);
        }
        let (mean, covariance) = model.completed(&before, &part, &part_covariance).unwrap();
        let std: Vec<f64> = (0..=d)
            .map(|k| whole_covariance[k * (d + 2)].sqrt())
            .collect();
        let mut learned = 0.0_f64;
        for i in 0..=d {
            let off = (mean[i] - whole[i]).abs();
            assert!(off < 1e-6 * std[i], "{i}: {off} of {}", std[i]);
            for k in 0..=d {
                let at = i * (d + 1) + k;
                let off = (covariance[at] - whole_covariance[at]).abs();
                assert!(off < 1e-6 * std[i] * std[k], "{i}, {k}: {off}");
            }
            if i < d {
                learned = learned.max(1.0 - std[i] / before.entry(i).std);
            }
        }
        assert!(learned > 0.3, "{learned}: the data said nothing");
    }
}
