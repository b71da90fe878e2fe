//! An end stop or a mark touched in a recording: what it says of the encoders and of the tendon.
//!
//! A rope that got longer and an encoder that slipped look the same in every motion: all that is ever seen is
//! `theta_measured − q_measured`. A joint that stands where it is known to stand tells them apart.
//!
//! ```text
//! at a stop or joint mark   e = q_measured − q_s                               error of the joint's encoder
//! at a motor mark           m = theta_measured − theta_s                       error of the motor's encoder
//! tendon                    delta_e = (offset seen by motion) + e − m
//! pushed against a stop     LP[theta_measured − q_measured] + e − m = delta_e + κ (LP[u] − J LP[ddtheta]) − κ F LP[z] − κ μ LP[z |τ|]
//! ```
//!
//! The last line needs the motor's torque `u`. It knows nothing of masses, payload and contacts, which the
//! offset seen by motion rests on, and nothing of the joint's encoder. Pushed in and let go again, it tells its
//! spring and its drive's friction from the offset by itself; pushed one way only, friction stays in it.
//!
//! What it rests on: the stop doesn't move, gives less than its deviation, and what the joint pushed against
//! was the stop.

use super::recorder::Recorded;
use super::result::{LimitState, RetensionLimit, SessionEstimate, TendonEstimate, Verdict};
use super::segments::Segments;
use super::warning::Warning;
use crate::anchored::{AnchorReading, AnchoredOffset};
use crate::baseline::Baseline;
use crate::touch::{NEAR_RAD, nearest};
use sinew_model::Gaussian;
use sinew_model::offset::{Belief, Block, JointParameter, MapEstimator, Prior};
use sinew_model::robot::Robot;
use sinew_model::transmission::{Anchor, AnchorKind, Transmission};

/// A joint stands while its reading stays within this, rad.
const STANDS_RAD: f64 = 1.5e-3;
/// A push holds the spring at least this far from where gravity and motion would, rad, and this many times as far as friction
/// may hold a free joint.
const PUSH_RAD: f64 = 4e-3;
const PUSH_OVER_FRICTION: f64 = 2.0;
/// Blocks of a fifth of a second that the filters' memory (`1/K_I`) makes one of.
const CORRELATED_BLOCKS: f64 = 2.5;
/// What a push alone tells: offset, compliance, friction, and friction that grows with the load.
const UNKNOWN: usize = 4;
/// What a filtered position scatters by at least, rad.
const NOISE_RAD: f64 = 0.2e-3;

/// Everything that was touched in a recording; its estimate tells spring and friction, and what pushes.
pub(super) fn readings(
    robot: &Robot,
    recorded: &Recorded,
    estimator: &MapEstimator,
    segments: &Segments,
) -> Vec<AnchorReading> {
    let (prior, belief) = (estimator.prior(), &segments.belief);
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
                    let own: Vec<f64> = all.step_by(robot.arm.dof()).copied().collect();
                    out.extend(joint.reading(&recorded.blocks, &own, prior, belief));
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
                        AnchorReading {
                            joint: name.to_owned(),
                            kind: anchor.kind,
                            position_rad: anchor.position_rad,
                            time_s: x.time_s,
                            encoder_error_rad: Gaussian::new(
                                read - anchor.position_rad,
                                anchor.deviation_rad.hypot(encoder),
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

/// Keeps what an earlier part of the same recording touched and this one didn't.
pub(super) fn keep(readings: &mut Vec<AnchorReading>, before: &[AnchorReading]) {
    for r in before {
        if !readings.iter().any(|own| own.is_of(r)) {
            readings.push(r.clone());
        }
    }
}

/// A joint that may have been pushed against its stop.
struct Pushed<'a> {
    joint: usize,
    name: &'a str,
    transmission: &'a Transmission,
    anchor: &'a Anchor,
    encoder_rad: f64,
}

impl Pushed<'_> {
    /// The hardest push against the stop, and what it says.
    fn reading(
        &self,
        blocks: &[Block],
        unexplained_rad: &[f64],
        prior: &Prior,
        belief: &Belief,
    ) -> Option<AnchorReading> {
        let known = |p: JointParameter| belief.entry(prior.place(self.joint, p));
        let (from, to) = self.hardest(blocks, unexplained_rad, &known)?;
        let push = &blocks[from..to];
        let n = push.len() as f64;
        let q = push.iter().map(|b| b.q[self.joint]).sum::<f64>() / n;
        let scatter = NOISE_RAD * (CORRELATED_BLOCKS / n).sqrt();
        let deviation = self
            .anchor
            .deviation_rad
            .hypot(self.encoder_rad)
            .hypot(scatter);
        Some(AnchorReading {
            joint: self.name.into(),
            kind: AnchorKind::Stop,
            position_rad: self.anchor.position_rad,
            time_s: push[0].time_s,
            encoder_error_rad: Gaussian::new(q - self.anchor.position_rad, deviation),
            offset_rad: self.by_push(push, q - self.anchor.position_rad, &known),
        })
    }

    /// Blocks of the hardest push: the joint stands near its stop, and its spring is further from where gravity and motion would
    /// have it than friction could hold a free joint.
    fn hardest(
        &self,
        blocks: &[Block],
        unexplained_rad: &[f64],
        known: &impl Fn(JointParameter) -> Gaussian,
    ) -> Option<(usize, usize)> {
        let i = self.joint;
        let most = |p: JointParameter| known(p).mean.abs() + 2.0 * known(p).deviation;
        let stiffness = self.transmission.stiffness_nm_per_rad;
        let (coulomb, load) = (
            most(JointParameter::Coulomb),
            most(JointParameter::LoadFriction),
        );
        let near = |b: &Block| (b.q[i] - self.anchor.position_rad).abs() < NEAR_RAD;
        let mut best: Option<(f64, usize, usize)> = None;
        let mut from = 0;
        while from < blocks.len() {
            let mut to = from;
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            while let Some(b) = blocks.get(to).filter(|b| near(b)) {
                let (a, z) = (low.min(b.q[i]), high.max(b.q[i]));
                let goes_on = to == from || b.time_s - blocks[to - 1].time_s < 0.5;
                if z - a > STANDS_RAD || !goes_on {
                    break;
                }
                (low, high, to) = (a, z, to + 1);
            }
            let stands = &blocks[from..to];
            let most =
                |f: &dyn Fn(&Block) -> f64| stands.iter().map(f).fold(f64::NEG_INFINITY, f64::max);
            let sizes = unexplained_rad[from..to].iter().map(|r| r.abs());
            let push = sizes.fold(0.0, f64::max);
            // Friction holds it either way, by what it carries.
            let held = coulomb / stiffness + load * most(&|b| b.y[i].abs());
            let least = f64::max(PUSH_RAD, PUSH_OVER_FRICTION * held);
            if push >= least && best.is_none_or(|(hardest, ..)| push > hardest) {
                best = Some((push, from, to));
            }
            from = to.max(from + 1);
        }
        best.map(|(_, from, to)| (from, to))
    }

    /// Offset by the push alone: spring and friction are told from it as far as the push does.
    fn by_push(
        &self,
        push: &[Block],
        encoder_error_rad: f64,
        known: &impl Fn(JointParameter) -> Gaussian,
    ) -> Option<Gaussian> {
        let i = self.joint;
        let t = self.transmission;
        let inertia = t.motor_inertia_kg_m2?;
        let soft = known(JointParameter::Compliance);
        let kappa = (1.0 + soft.mean) / t.stiffness_nm_per_rad;
        let scale = known(JointParameter::MotorScale);
        let coulomb = known(JointParameter::MotorCoulomb);
        let load = known(JointParameter::MotorLoadFriction);
        // The spring stiffens: what the motor turned is less than the torque's share by that.
        let cubic = known(JointParameter::Stiffening);
        // Offset, compliance and both frictions over stiffness; the torque's scale is the compliance's.
        let mut mean = [0.0, kappa, kappa * coulomb.mean, kappa * load.mean];
        let spread = [
            1.0,
            kappa * (soft.deviation / (1.0 + soft.mean)).hypot(scale.deviation),
            kappa * coulomb.deviation,
            kappa * load.deviation,
        ];
        let mut covariance = [[0.0; UNKNOWN]; UNKNOWN];
        for k in 0..UNKNOWN {
            covariance[k][k] = spread[k] * spread[k];
        }
        let rows: Vec<([f64; UNKNOWN], f64)> = (push.iter())
            .map(|b| {
                let rubs = t.stiffness_nm_per_rad * b.motor_z_load[i];
                let torque =
                    b.motor_torque[i] / (1.0 + scale.mean) - inertia * b.motor_acceleration[i];
                // The joint's reading less its error there is the stop, once the filters have come to rest.
                let reads = b.y[i] + encoder_error_rad + cubic.mean * b.y_cube[i];
                ([1.0, torque, -b.motor_z[i], -rubs], reads)
            })
            .filter(|(row, reads)| row.iter().all(|x| x.is_finite()) && reads.is_finite())
            .collect();
        if rows.len() < 5 {
            return None;
        }
        let variance = CORRELATED_BLOCKS * NOISE_RAD * NOISE_RAD;
        for (row, reads) in &rows {
            update(&mut mean, &mut covariance, row, *reads, variance);
        }
        let left = |(row, reads): &([f64; UNKNOWN], f64)| reads - dot(row, &mean);
        let misfit = rows.iter().map(|r| left(r).powi(2)).sum::<f64>() / rows.len() as f64;
        // What the line doesn't explain counts in full, as does the place of the stop.
        let deviation = covariance[0][0].max(0.0).sqrt().hypot(misfit.sqrt());
        Some(Gaussian::new(
            mean[0],
            deviation.hypot(self.anchor.deviation_rad),
        ))
    }
}

fn dot(a: &[f64; UNKNOWN], b: &[f64; UNKNOWN]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Takes one measurement `reads = row · x` of a variance into mean and covariance.
fn update(
    mean: &mut [f64; UNKNOWN],
    p: &mut [[f64; UNKNOWN]; UNKNOWN],
    row: &[f64; UNKNOWN],
    reads: f64,
    variance: f64,
) {
    let gain: [f64; UNKNOWN] = core::array::from_fn(|k| dot(&p[k], row));
    let size = dot(row, &gain) + variance;
    let off = reads - dot(row, mean);
    for k in 0..UNKNOWN {
        mean[k] += gain[k] / size * off;
    }
    let before = *p;
    for (k, line) in p.iter_mut().enumerate() {
        for (m, x) in line.iter_mut().enumerate() {
            *x = before[k][m] - gain[k] * gain[m] / size;
        }
    }
}

/// Corrects a session's offsets by what was touched, against what the baseline had touched.
pub(super) fn apply(
    robot: &Robot,
    touched: &[AnchorReading],
    baseline: Option<&Baseline>,
    estimate: &mut SessionEstimate,
) {
    let zero_rad = robot.tolerances.zero_rad;
    for k in 0..estimate.joints.len() {
        let own: Vec<&AnchorReading> = (touched.iter())
            .filter(|r| r.joint == estimate.joints[k].name)
            .collect();
        if own.is_empty() {
            continue;
        }
        let before = |r: &AnchorReading| {
            let all = baseline.map_or(&[][..], |b| &b.anchors);
            all.iter().find(|b| b.is_of(r))
        };
        let difference = |now: Gaussian, then: Option<Gaussian>| match then {
            Some(then) => Gaussian::new(now.mean - then.mean, now.deviation.hypot(then.deviation)),
            None => Gaussian::new(now.mean, now.deviation.hypot(zero_rad)),
        };
        // Every anchor is a look at its encoder's error; a reading of it taken again is no new look.
        let error = |is_motor: bool| {
            let of_it = |r: &&&AnchorReading| (r.kind == AnchorKind::MotorMark) == is_motor;
            let mut each: Vec<Vec<&AnchorReading>> = Vec::new();
            for r in own.iter().filter(of_it) {
                match each.iter_mut().find(|same| same[0].is_of(r)) {
                    Some(same) => same.push(r),
                    None => each.push(vec![r]),
                }
            }
            // Those that the baseline touched too need no zero; of the others all share it.
            let known = each.iter().any(|same| before(same[0]).is_some());
            each.retain(|same| !known || before(same[0]).is_some());
            let read = each.iter().map(|same| {
                let now = mean_of(same.iter().map(|r| r.encoder_error_rad));
                let then = before(same[0]).map(|b| b.encoder_error_rad);
                then.map_or(now, |then| {
                    Gaussian::new(now.mean - then.mean, now.deviation.hypot(then.deviation))
                })
            });
            let fused = read.reduce(fused)?;
            let zero_rad = if known { 0.0 } else { zero_rad };
            Some(Gaussian::new(fused.mean, fused.deviation.hypot(zero_rad)))
        };
        let (joint, motor) = (error(false), error(true));
        let none = Gaussian::new(0.0, 0.0);
        let (e, m) = (joint.unwrap_or(none), motor.unwrap_or(none));
        let correction_rad = Gaussian::new(e.mean - m.mean, e.deviation.hypot(m.deviation));
        // A push is read by the motor's encoder: what that is off by is in it.
        let pushes = own.iter().filter_map(|r| {
            let then = before(r).and_then(|b| b.offset_rad);
            let push = difference(r.offset_rad?, then);
            Some(Gaussian::new(push.mean - m.mean, push.deviation))
        });
        let push_alone = pushes.reduce(fused);
        let by_push_rad = push_alone.map(|p| Gaussian::new(p.mean, p.deviation.hypot(m.deviation)));
        let by_motion_rad = estimate.joints[k].offset_rad;
        let corrected = Gaussian::new(
            by_motion_rad.mean + correction_rad.mean,
            by_motion_rad.deviation.hypot(correction_rad.deviation),
        );
        // The motor's encoder is in both: it is no second look.
        let own_alone = Gaussian::new(corrected.mean, by_motion_rad.deviation.hypot(e.deviation));
        let offset_rad = push_alone.map_or(corrected, |push| {
            let both = fused(own_alone, push);
            Gaussian::new(both.mean, both.deviation.hypot(m.deviation))
        });
        if let Some(push) = by_push_rad.filter(|push| disagree(corrected, *push)) {
            estimate.warnings.push(Warning::AnchorDisagrees {
                joint: estimate.joints[k].name.clone(),
                by_push_rad: push,
                by_motion_rad: corrected,
            });
        }
        let anchored = AnchoredOffset {
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
            correction_rad.deviation,
        );
        correct(robot, &mut estimate.joints[k], offset_rad);
        estimate.joints[k].anchored = Some(anchored);
    }
}

/// Whether two readings of one thing lie further apart than three deviations.
fn disagree(a: Gaussian, b: Gaussian) -> bool {
    (a.mean - b.mean).abs() > 3.0 * a.deviation.hypot(b.deviation)
}

/// Readings of one anchor: their mean, and as sure as one of them, for what is wrong with it is in all.
fn mean_of(readings: impl Iterator<Item = Gaussian> + Clone) -> Gaussian {
    let count = readings.clone().count() as f64;
    let mean = readings.clone().map(|r| r.mean).sum::<f64>() / count;
    let apart = readings.map(|r| r.deviation.max((r.mean - mean).abs()));
    Gaussian::new(mean, apart.fold(0.0, f64::max))
}

/// Two readings of one thing: by their weights, and where they contradict each other as wide as they lie apart.
fn fused(a: Gaussian, b: Gaussian) -> Gaussian {
    let [wa, wb] = [a, b].map(|x| 1.0 / (x.deviation * x.deviation).max(1e-18));
    let mean = (wa * a.mean + wb * b.mean) / (wa + wb);
    let deviation = match disagree(a, b) {
        true => a
            .deviation
            .max(b.deviation)
            .max(0.5 * (a.mean - b.mean).abs()),
        false => (wa + wb).sqrt().recip(),
    };
    Gaussian::new(mean, deviation)
}

/// An encoder's error is one for all of a recording: every estimate in it moves alike.
fn shift(estimate: &mut SessionEstimate, joint: usize, by_rad: f64, deviation_rad: f64) {
    let segments = estimate.segments.iter_mut().map(|s| &mut s.offset_rad);
    let blocks = estimate.blocks.iter_mut().map(|b| &mut b.offset_rad);
    for offsets in segments.chain(blocks) {
        if let Some(x) = offsets.get_mut(joint) {
            *x = Gaussian::new(x.mean + by_rad, x.deviation.hypot(deviation_rad));
        }
    }
}

/// A tendon's estimate with another offset, and everything that follows from it.
fn correct(robot: &Robot, joint: &mut TendonEstimate, offset_rad: Gaussian) {
    let transmission = robot.tendon_index(&joint.name);
    let transmission = transmission.and_then(|i| robot.transmissions[i].as_ref());
    joint.offset_rad = offset_rad;
    joint.verdict = Verdict::of(offset_rad);
    if let Some(tendon) = transmission.and_then(|t| t.tendon.as_ref()) {
        let of =
            |f: &dyn Fn(f64) -> f64| Gaussian::new(f(offset_rad.mean), f(offset_rad.deviation));
        joint.elongation_m = Some(of(&|x| tendon.elongation_m(x)));
        joint.strain_ratio = Some(of(&|x| tendon.strain(x)));
        let interval = offset_rad.interval_95();
        let [least, most] = [interval.low, interval.high].map(|x| tendon.elongation_m(x));
        joint.retension = joint.retension.map(|limit| RetensionLimit {
            state: match limit.elongation_m {
                at if least > at => LimitState::Passed,
                at if most < at => LimitState::NotPassed,
                _ => LimitState::CannotTell,
            },
            ..limit
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_that_agree_narrow_and_those_that_dont_widen() {
        let both = fused(Gaussian::new(1.0, 1.0), Gaussian::new(2.0, 1.0));
        assert!((both.mean - 1.5).abs() < 1e-12 && (both.deviation - 0.5_f64.sqrt()).abs() < 1e-12);
        let apart = fused(Gaussian::new(0.0, 1.0), Gaussian::new(10.0, 1.0));
        assert!(apart.deviation >= 5.0, "{apart:?}");
    }

    /// A push in and out with a spring of its own and friction both ways: the offset by itself.
    #[test]
    fn a_line_of_pushes_has_its_offset_spring_and_friction() {
        let (offset, kappa, friction, load) = (7e-3, 0.06, 12e-3, 3e-3);
        let mut mean = [0.0, 0.05, 10e-3, 5e-3];
        let mut p = [[0.0; UNKNOWN]; UNKNOWN];
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
            let reads = offset + kappa * torque - friction * z - load * z * torque;
            update(&mut mean, &mut p, &row, reads, 2.5 * NOISE_RAD * NOISE_RAD);
        }
        let off = (mean[0] - offset).abs();
        assert!(
            off < 2.0 * p[0][0].sqrt() && p[0][0].sqrt() < 0.3e-3,
            "{off} {}",
            p[0][0].sqrt()
        );
        assert!((mean[1] / kappa - 1.0).abs() < 0.05 && (mean[2] / friction - 1.0).abs() < 0.05);
        assert!((mean[3] - load).abs() < 0.5e-3, "{mean:?}");
    }
}
