//! Contacts with end stops and passes of index marks in a recording, as references for the encoders and the tendon.
//!
//! An elongated rope and a slipped encoder are indistinguishable in any motion, because the only observation is
//! `theta_measured − q_measured`. A joint at a reference position separates them.
//!
//! ```text
//! at a stop or joint mark   e = q_measured − q_s                               error of the joint's encoder
//! at a motor mark           m = theta_measured − theta_s                       error of the motor's encoder
//! tendon                    delta_e = (offset by motion) + e − m
//! pushed against a stop     LP[theta_measured − q_measured] + e − m = delta_e + κ (LP[u] − J LP[ddtheta]) − κ F LP[z] − κ μ LP[z |τ|]
//! ```
//!
//! The last line requires the motor torque `u`. Unlike the offset by motion, it does not depend on masses, payload and
//! contacts, nor on the joint encoder. A push that is applied and released separates spring and drive friction from the
//! offset; a push in one direction only leaves the friction in the offset.
//!
//! Assumptions: the stop does not move, its deflection is less than its standard deviation, and the joint was pushed
//! against the stop rather than an obstacle.

use super::late_step::is_encoder;
use super::recorder::Recorded;
use super::result::{LimitState, RetensionLimit, SessionEstimate, TendonEstimate, Verdict};
use super::segments::Segments;
use super::warning::Warning;
use crate::anchored::{ReferenceMeasurement, ReferenceOffset};
use crate::baseline::Baseline;
use crate::touch::{NEAR_RAD, nearest};
use sinew_model::Gaussian;
use sinew_model::offset::{Block, JointParameter, MapEstimator, Prior, StateEstimate};
use sinew_model::robot::Robot;
use sinew_model::transmission::{Anchor, AnchorKind, Transmission};

/// Maximum range of the position of a joint at rest, rad.
const MAX_REST_RANGE_RAD: f64 = 1.5e-3;
/// Minimum deflection of the spring by a push, relative to that by gravity and motion, rad.
const MIN_PUSH_RAD: f64 = 4e-3;
/// Minimum deflection by a push in multiples of the deflection that stiction can hold in a free joint.
const MIN_PUSH_TO_STICTION_RATIO: f64 = 2.0;
/// Number of correlated blocks of 0.2 s (filter memory `1/K_I`) that have the information of one independent block.
const CORRELATED_BLOCKS: f64 = 2.5;
/// Number of unknowns of a push: offset, compliance, Coulomb friction, and friction proportional to the load.
const UNKNOWNS: usize = 4;
/// Minimum standard deviation of a filtered position, rad.
const NOISE_RAD: f64 = 0.2e-3;

/// Reference measurements of a recording: contacts with end stops, from the estimated spring and friction, and passes
/// of index marks.
pub(super) fn readings(
    robot: &Robot,
    recorded: &Recorded,
    estimator: &MapEstimator,
    segments: &Segments,
) -> Vec<ReferenceMeasurement> {
    let (prior, state_estimate) = (estimator.prior(), &segments.state_estimate);
    let mut out = Vec::new();
    let stops = robot.transmissions.iter().flatten();
    let mut stops = stops.flat_map(|t| &t.anchors);
    let unexplained_rad = match stops.any(|a| a.kind == AnchorKind::Stop) {
        true => segments.residuals(estimator, &recorded.blocks),
        false => Vec::new(),
    };
    for (i, transmission) in robot.transmissions.iter().enumerate() {
        let Some(t) = transmission else { continue };
        let name = robot.tendon_name(i);
        for anchor in &t.anchors {
            let touched = (recorded.touches.iter())
                .filter(|x| x.joint == *name && nearest(t, x) == Some(anchor));
            match anchor.kind {
                AnchorKind::Stop => {
                    let joint = Pushed {
                        joint: i,
                        name,
                        transmission: t,
                        anchor,
                        encoder_rad: robot.tolerances.encoder_rad,
                    };
                    let all = unexplained_rad.iter().skip(i);
                    let own: Vec<f64> = all.step_by(robot.axes()).copied().collect();
                    out.extend(joint.reading(&recorded.blocks, &own, prior, state_estimate));
                }
                AnchorKind::JointMark | AnchorKind::MotorMark => {
                    let own = anchor.kind == AnchorKind::JointMark;
                    out.extend(touched.map(|x| {
                        let read = if own { x.q } else { x.theta_measured };
                        let encoder = if own {
                            robot.tolerances.encoder_rad
                        } else {
                            NOISE_RAD
                        };
                        ReferenceMeasurement {
                            joint: name.to_owned(),
                            kind: anchor.kind,
                            position_rad: anchor.position_rad,
                            time_s: x.time_s,
                            encoder_error_rad: Gaussian::new(
                                read - anchor.position_rad,
                                anchor.std_rad.hypot(encoder),
                            ),
                            offset_rad: None,
                        }
                    }));
                }
            }
        }
    }
    out
}

/// Joint that may have been pushed against its stop.
struct Pushed<'a> {
    joint: usize,
    name: &'a str,
    transmission: &'a Transmission,
    anchor: &'a Anchor,
    encoder_rad: f64,
}

impl Pushed<'_> {
    /// Measurement by the strongest push against the stop; `None` if there is no push.
    fn reading(
        &self,
        blocks: &[Block],
        unexplained_rad: &[f64],
        prior: &Prior,
        state_estimate: &StateEstimate,
    ) -> Option<ReferenceMeasurement> {
        let parameter = |p: JointParameter| state_estimate.entry(prior.place(self.joint, p));
        let (from, to) = self.strongest(blocks, unexplained_rad, &parameter)?;
        let push = &blocks[from..to];
        let n = push.len() as f64;
        let q = push.iter().map(|b| b.q[self.joint]).sum::<f64>() / n;
        let scatter = NOISE_RAD * (CORRELATED_BLOCKS / n).sqrt();
        let std = self.anchor.std_rad.hypot(self.encoder_rad).hypot(scatter);
        Some(ReferenceMeasurement {
            joint: self.name.into(),
            kind: AnchorKind::Stop,
            position_rad: self.anchor.position_rad,
            time_s: push[0].time_s,
            encoder_error_rad: Gaussian::new(q - self.anchor.position_rad, std),
            offset_rad: self.by_push(push, q - self.anchor.position_rad, &parameter),
        })
    }

    /// Range of the blocks of the strongest push: the joint is at rest near its stop, and the residual of its spring
    /// exceeds the deflection that stiction can hold in a free joint.
    fn strongest(
        &self,
        blocks: &[Block],
        unexplained_rad: &[f64],
        parameter: &impl Fn(JointParameter) -> Gaussian,
    ) -> Option<(usize, usize)> {
        let i = self.joint;
        let largest = |p: JointParameter| parameter(p).mean.abs() + 2.0 * parameter(p).std;
        let stiffness = self.transmission.stiffness_nm_per_rad;
        let (coulomb, load) = (
            largest(JointParameter::Coulomb),
            largest(JointParameter::LoadFriction),
        );
        let near = |b: &Block| (b.q[i] - self.anchor.position_rad).abs() < NEAR_RAD;
        let mut best: Option<(f64, usize, usize)> = None;
        let mut from = 0;
        while from < blocks.len() {
            let mut to = from;
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            while let Some(b) = blocks.get(to).filter(|b| near(b)) {
                let (a, z) = (low.min(b.q[i]), high.max(b.q[i]));
                let is_consecutive = to == from || b.time_s - blocks[to - 1].time_s < 0.5;
                if z - a > MAX_REST_RANGE_RAD || !is_consecutive {
                    break;
                }
                (low, high, to) = (a, z, to + 1);
            }
            let at_rest = &blocks[from..to];
            let most =
                |f: &dyn Fn(&Block) -> f64| at_rest.iter().map(f).fold(f64::NEG_INFINITY, f64::max);
            let sizes = unexplained_rad[from..to].iter().map(|r| r.abs());
            let push = sizes.fold(0.0, f64::max);
            // Stiction acts in either direction, in proportion to the load.
            let held = coulomb / stiffness + load * most(&|b| b.y[i].abs());
            let min_push = f64::max(MIN_PUSH_RAD, MIN_PUSH_TO_STICTION_RATIO * held);
            if push >= min_push && best.is_none_or(|(strongest, ..)| push > strongest) {
                best = Some((push, from, to));
            }
            from = to.max(from + 1);
        }
        best.map(|(_, from, to)| (from, to))
    }

    /// Offset by the push alone, with compliance and friction estimated jointly; `None` without a motor torque.
    fn by_push(
        &self,
        push: &[Block],
        encoder_error_rad: f64,
        parameter: &impl Fn(JointParameter) -> Gaussian,
    ) -> Option<Gaussian> {
        let i = self.joint;
        let t = self.transmission;
        let inertia = t.motor_inertia_kg_m2?;
        let compliance = parameter(JointParameter::Compliance);
        let kappa = (1.0 + compliance.mean) / t.stiffness_nm_per_rad;
        let scale = parameter(JointParameter::MotorScale);
        let coulomb = parameter(JointParameter::MotorCoulomb);
        let load = parameter(JointParameter::MotorLoadFriction);
        // A stiffening spring deflects less than in proportion to the torque, by this cubic term.
        let cubic = parameter(JointParameter::Stiffening);
        // Offset, compliance and both frictions divided by stiffness; the scale of the torque is part of the
        // compliance.
        let mut mean = [0.0, kappa, kappa * coulomb.mean, kappa * load.mean];
        let spread = [
            1.0,
            kappa * (compliance.std / (1.0 + compliance.mean)).hypot(scale.std),
            kappa * coulomb.std,
            kappa * load.std,
        ];
        let mut covariance = [[0.0; UNKNOWNS]; UNKNOWNS];
        for k in 0..UNKNOWNS {
            covariance[k][k] = spread[k] * spread[k];
        }
        let rows: Vec<([f64; UNKNOWNS], f64)> = (push.iter())
            .map(|b| {
                let friction_load = t.stiffness_nm_per_rad * b.motor_z_load[i];
                let torque =
                    b.motor_torque[i] / (1.0 + scale.mean) - inertia * b.motor_acceleration[i];
                // At rest, the joint position minus the encoder error is the position of the stop.
                let measured = b.y[i] + encoder_error_rad + cubic.mean * b.y_cube[i];
                ([1.0, torque, -b.motor_z[i], -friction_load], measured)
            })
            .filter(|(row, measured)| row.iter().all(|x| x.is_finite()) && measured.is_finite())
            .collect();
        if rows.len() < 5 {
            return None;
        }
        let variance = CORRELATED_BLOCKS * NOISE_RAD * NOISE_RAD;
        for (row, measured) in &rows {
            update(&mut mean, &mut covariance, row, *measured, variance);
        }
        let residual = |(row, measured): &([f64; UNKNOWNS], f64)| measured - dot(row, &mean);
        let mean_square = rows.iter().map(|r| residual(r).powi(2)).sum::<f64>() / rows.len() as f64;
        // The residual and the position error of the stop contribute in full.
        let std = covariance[0][0].max(0.0).sqrt().hypot(mean_square.sqrt());
        Some(Gaussian::new(mean[0], std.hypot(self.anchor.std_rad)))
    }
}

fn dot(a: &[f64; UNKNOWNS], b: &[f64; UNKNOWNS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Updates mean and covariance `p` with one measurement `measured = row · x` of the given variance.
fn update(
    mean: &mut [f64; UNKNOWNS],
    p: &mut [[f64; UNKNOWNS]; UNKNOWNS],
    row: &[f64; UNKNOWNS],
    measured: f64,
    variance: f64,
) {
    let gain: [f64; UNKNOWNS] = core::array::from_fn(|k| dot(&p[k], row));
    let innovation_variance = dot(row, &gain) + variance;
    let innovation = measured - dot(row, mean);
    for k in 0..UNKNOWNS {
        mean[k] += gain[k] / innovation_variance * innovation;
    }
    let before = *p;
    for (k, line) in p.iter_mut().enumerate() {
        for (m, x) in line.iter_mut().enumerate() {
            *x = before[k][m] - gain[k] * gain[m] / innovation_variance;
        }
    }
}

/// Corrects the offsets of a session by its reference measurements, relative to those of the baseline.
pub(super) fn apply(
    robot: &Robot,
    touched: &[ReferenceMeasurement],
    baseline: Option<&Baseline>,
    estimate: &mut SessionEstimate,
) {
    let zero_rad = robot.tolerances.zero_rad;
    for k in 0..estimate.joints.len() {
        let own: Vec<&ReferenceMeasurement> = (touched.iter())
            .filter(|r| r.joint == estimate.joints[k].name)
            .collect();
        if own.is_empty() {
            continue;
        }
        let before = |r: &ReferenceMeasurement| {
            let all = baseline.map_or(&[][..], |b| &b.anchors);
            all.iter().find(|b| b.is_of(r))
        };
        let difference = |now: Gaussian, then: Option<Gaussian>| match then {
            Some(then) => Gaussian::new(now.mean - then.mean, now.std.hypot(then.std)),
            None => Gaussian::new(now.mean, now.std.hypot(zero_rad)),
        };
        // Each reference measures the error of its encoder; repeated measurements at one reference are not independent.
        let error = |is_motor: bool| {
            let of_it = |r: &&&ReferenceMeasurement| (r.kind == AnchorKind::MotorMark) == is_motor;
            let mut each: Vec<Vec<&ReferenceMeasurement>> = Vec::new();
            for r in own.iter().filter(of_it) {
                match each.iter_mut().find(|same| same[0].is_of(r)) {
                    Some(same) => same.push(r),
                    None => each.push(vec![r]),
                }
            }
            // References that the baseline touched too do not depend on the zero; all others share its error.
            let has_baseline = each.iter().any(|same| before(same[0]).is_some());
            each.retain(|same| !has_baseline || before(same[0]).is_some());
            let read = each.iter().map(|same| {
                let now = mean_of(same.iter().map(|r| r.encoder_error_rad));
                let then = before(same[0]).map(|b| b.encoder_error_rad);
                then.map_or(now, |then| {
                    Gaussian::new(now.mean - then.mean, now.std.hypot(then.std))
                })
            });
            let fused = read.reduce(fused)?;
            let zero_rad = if has_baseline { 0.0 } else { zero_rad };
            Some(Gaussian::new(fused.mean, fused.std.hypot(zero_rad)))
        };
        let (joint, motor) = (error(false), error(true));
        let none = Gaussian::new(0.0, 0.0);
        let (e, m) = (joint.unwrap_or(none), motor.unwrap_or(none));
        let correction_rad = Gaussian::new(e.mean - m.mean, e.std.hypot(m.std));
        // A push is measured by the motor encoder and contains its error.
        let pushes = own.iter().filter_map(|r| {
            let then = before(r).and_then(|b| b.offset_rad);
            let push = difference(r.offset_rad?, then);
            Some(Gaussian::new(push.mean - m.mean, push.std))
        });
        let push_alone = pushes.reduce(fused);
        let by_push_rad = push_alone.map(|p| Gaussian::new(p.mean, p.std.hypot(m.std)));
        // The errors of the encoders at the contact include their earlier slips, which the offset excludes.
        let touched_s = own.iter().map(|r| r.time_s).fold(f64::INFINITY, f64::min);
        let slips = estimate.joints[k].changes.iter();
        let slips = slips.filter(|c| is_encoder(c) && c.time_s < touched_s);
        let slips = slips.filter_map(|c| c.size_rad);
        let by_motion_rad = slips.fold(estimate.joints[k].offset_rad, Gaussian::plus);
        let corrected = Gaussian::new(
            by_motion_rad.mean + correction_rad.mean,
            by_motion_rad.std.hypot(correction_rad.std),
        );
        // Both contain the error of the motor encoder, which is added only once.
        let own_alone = Gaussian::new(corrected.mean, by_motion_rad.std.hypot(e.std));
        let offset_rad = push_alone.map_or(corrected, |push| {
            let both = fused(own_alone, push);
            Gaussian::new(both.mean, both.std.hypot(m.std))
        });
        if let Some(push) = by_push_rad.filter(|push| disagree(corrected, *push)) {
            estimate.warnings.push(Warning::ReferenceInconsistent {
                joint: estimate.joints[k].name.clone(),
                by_push_rad: push,
                by_motion_rad: corrected,
            });
        }
        let anchored = ReferenceOffset {
            since_baseline: own.iter().all(|r| before(r).is_some()),
            readings: own.into_iter().cloned().collect(),
            correction_rad,
            by_motion_rad,
            by_push_rad,
        };
        shift(
            estimate,
            k,
            offset_rad.mean - by_motion_rad.mean,
            correction_rad.std,
        );
        let verdict = match estimate.joints[k].verdict {
            Verdict::TransmissionLost => continue,
            _ => Verdict::of(offset_rad, estimate.is_elongation()),
        };
        correct(robot, &mut estimate.joints[k], offset_rad, verdict);
        estimate.joints[k].anchored = Some(anchored);
    }
}

/// Whether two estimates of one quantity differ by more than three standard deviations.
fn disagree(a: Gaussian, b: Gaussian) -> bool {
    (a.mean - b.mean).abs() > 3.0 * a.std.hypot(b.std)
}

/// Mean of the measurements at one reference, with the standard deviation of a single one, because they share their
/// error.
fn mean_of(readings: impl Iterator<Item = Gaussian> + Clone) -> Gaussian {
    let count = readings.clone().count() as f64;
    let mean = readings.clone().map(|r| r.mean).sum::<f64>() / count;
    let apart = readings.map(|r| r.std.max((r.mean - mean).abs()));
    Gaussian::new(mean, apart.fold(0.0, f64::max))
}

/// Weighted mean of two estimates of one quantity; if they are inconsistent, the standard deviation covers their
/// difference.
fn fused(a: Gaussian, b: Gaussian) -> Gaussian {
    let [wa, wb] = [a, b].map(|x| 1.0 / (x.std * x.std).max(1e-18));
    let mean = (wa * a.mean + wb * b.mean) / (wa + wb);
    let std = match disagree(a, b) {
        true => a.std.max(b.std).max(0.5 * (a.mean - b.mean).abs()),
        false => (wa + wb).sqrt().recip(),
    };
    Gaussian::new(mean, std)
}

/// Shifts all estimates of a joint in a recording, which share the encoder error, by `by_rad` with standard deviation
/// `std_rad`.
fn shift(estimate: &mut SessionEstimate, joint: usize, by_rad: f64, std_rad: f64) {
    let segments = estimate.segments.iter_mut().map(|s| &mut s.offset_rad);
    let blocks = estimate.blocks.iter_mut().map(|b| &mut b.offset_rad);
    for offsets in segments.chain(blocks) {
        if let Some(x) = offsets.get_mut(joint) {
            *x = Gaussian::new(x.mean + by_rad, x.std.hypot(std_rad));
        }
    }
}

/// Sets the offset of a tendon, and updates all results that depend on it.
fn correct(robot: &Robot, joint: &mut TendonEstimate, offset_rad: Gaussian, verdict: Verdict) {
    let transmission = robot.tendon_index(&joint.name);
    let transmission = transmission.and_then(|i| robot.transmissions[i].as_ref());
    joint.offset_rad = offset_rad;
    joint.verdict = verdict;
    if let Some(tendon) = transmission.and_then(|t| t.tendon.as_ref()) {
        let of = |f: &dyn Fn(f64) -> f64| Gaussian::new(f(offset_rad.mean), f(offset_rad.std));
        joint.elongation_m = Some(of(&|x| tendon.elongation_m(x)));
        joint.strain_ratio = Some(of(&|x| tendon.strain(x)));
        let interval = offset_rad.interval_95();
        let [least, most] = [interval.low, interval.high].map(|x| tendon.elongation_m(x));
        joint.retension = joint.retension.map(|limit| RetensionLimit {
            state: match limit.elongation_m {
                at if least > at => LimitState::Passed,
                at if most < at => LimitState::NotPassed,
                _ => LimitState::Inconclusive,
            },
            ..limit
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fused_consistent_narrows_inconsistent_widens() {
        let both = fused(Gaussian::new(1.0, 1.0), Gaussian::new(2.0, 1.0));
        assert!((both.mean - 1.5).abs() < 1e-12 && (both.std - 0.5_f64.sqrt()).abs() < 1e-12);
        let apart = fused(Gaussian::new(0.0, 1.0), Gaussian::new(10.0, 1.0));
        assert!(apart.std >= 5.0, "{apart:?}");
    }

    // A push that is applied and released, with friction in both directions, determines offset, compliance and
    // friction.
    #[test]
    fn update_push_and_release_separates_offset_and_friction() {
        let (offset, kappa, friction, load) = (7e-3, 0.06, 12e-3, 3e-3);
        let mut mean = [0.0, 0.05, 10e-3, 5e-3];
        let mut p = [[0.0; UNKNOWNS]; UNKNOWNS];
        for (k, variance) in [1.0, 36e-6, 25e-6, 4e-6].into_iter().enumerate() {
            p[k][k] = variance;
        }
        for k in 0..40 {
            let z = if k < 20 { 1.0 } else { -1.0 };
            let torque = if k < 20 {
                0.02 * f64::from(k)
            } else {
                0.02 * f64::from(40 - k)
            };
            let row = [1.0, torque, -z, -z * torque];
            let measured = offset + kappa * torque - friction * z - load * z * torque;
            update(
                &mut mean,
                &mut p,
                &row,
                measured,
                2.5 * NOISE_RAD * NOISE_RAD,
            );
        }
        let error = (mean[0] - offset).abs();
        assert!(
            error < 2.0 * p[0][0].sqrt() && p[0][0].sqrt() < 0.3e-3,
            "{error} {}",
            p[0][0].sqrt()
        );
        assert!((mean[1] / kappa - 1.0).abs() < 0.05 && (mean[2] / friction - 1.0).abs() < 0.05);
        assert!((mean[3] - load).abs() < 0.5e-3, "{mean:?}");
    }
}
