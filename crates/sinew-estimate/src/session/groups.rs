//! Groups of tendons with one equation per joint: joint offsets, unobservable combinations, and slack strands.

use super::changes;
use super::context::Context;
use super::result::{
    JointOffset, Remedy, TendonWeight, UnattributedChange, UnobservableCombination,
};
use sinew_model::Gaussian;
use sinew_model::offset::excess_residual::excess_residual_rad;
use sinew_model::offset::{
    GroupPosterior, JointParameter, UnobservableDirection, group_posteriors,
};
use sinew_model::robot::Robot;
use sinew_model::tendons::TendonKind;
use std::collections::BTreeSet;

/// Maximum share of a recording in which a strand may be slack for its offset to be estimated; above it there is only a
/// bound.
const MAX_SLACK_SHARE: f64 = 0.9;
/// Minimum mean extension of a taut strand over the memory of the low-pass filter, in standard deviations of the
/// extension: ratio of the amplitude of a sine to its standard deviation.
const MIN_TAUT_STDS: f64 = std::f64::consts::SQRT_2;
/// Standard deviation of a bound due to the stiffness, relative to the extension by the pretension: the nominal
/// tolerance of a stiffness.
const STIFFNESS_STD_RATIO: f64 = 0.12;

/// Results of the groups of a robot other than the offsets of single tendons.
#[derive(Debug, Clone, Default)]
pub(super) struct Groups {
    pub(super) joint_offsets: Vec<JointOffset>,
    pub(super) unobservable: Vec<UnobservableCombination>,
    /// Axes of tendons in an unobservable combination.
    pub(super) held_out: BTreeSet<usize>,
    /// Axes of tendons whose sudden changes are indistinguishable from those of another one: both have parallel moment
    /// arms.
    pub(super) unattributed: BTreeSet<usize>,
    /// Strands that were slack in part of the recording.
    pub(super) slack: Vec<SlackStrand>,
}

/// Result of a slack strand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SlackStrand {
    pub(super) axis: usize,
    /// Share of the recording in which it was slack, 0 to 1.
    pub(super) share: f64,
    /// Lower bound of the offset, rad; `None` if the strand was slack for a small part only.
    pub(super) lower_bound_rad: Option<f64>,
}

/// Tautness of a strand in a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Tautness {
    Taut,
    /// Strand with some blocks near slack.
    Touches,
    /// Strand with some slack blocks.
    Slack(SlackStrand),
}

impl Groups {
    pub(super) fn of(context: &Context<'_>) -> Self {
        let (robot, segments) = (context.robot, context.segments);
        let prior = context.estimator.prior();
        let mut out = Self::default();
        if !robot.has_joint_equations() {
            return out;
        }
        let stiffness: Vec<f64> = (0..robot.axes()).map(|i| tangent(context, i)).collect();
        for group in group_posteriors(
            prior,
            &segments.before,
            &segments.state_estimate,
            &stiffness,
        ) {
            let tautness = group.tendons.iter().map(|i| tautness(context, *i));
            let tautness: Vec<Tautness> = tautness.collect();
            for tautness in &tautness {
                if let Tautness::Slack(strand) = tautness {
                    out.slack.push(*strand);
                }
            }
            let members = group
                .unobservable
                .iter()
                .flat_map(|direction| &direction.weights);
            out.held_out.extend(members.map(|(i, _)| *i));
            let directions = group.unobservable.iter();
            out.unattributed
                .extend(directions.flat_map(|direction| indistinguishable(robot, direction)));
            let is_taut = tautness.iter().all(|t| *t == Tautness::Taut);
            out.joint_offsets
                .extend(joint_offsets(context, &group, is_taut));
            let remedies = remedies(context, &group);
            let named = group.unobservable.iter();
            out.unobservable
                .extend(named.map(|direction| UnobservableCombination {
                    remedies: remedies.clone(),
                    changes: changes_of(context, &indistinguishable(robot, direction)),
                    ..named_direction(robot, direction)
                }));
        }
        out
    }
}

/// Tangent stiffness of the tendon on an axis, `K (1 + 3 η x²) / (1 + compliance)`, averaged over the recording,
/// N·m/rad.
fn tangent(context: &Context<'_>, axis: usize) -> f64 {
    let prior = context.estimator.prior();
    let at = |p| {
        context
            .segments
            .state_estimate
            .entry(prior.place(axis, p))
            .mean
    };
    let Some(transmission) = context.robot.transmissions[axis].as_ref() else {
        return 0.0;
    };
    let zero = at(JointParameter::Offset) + at(JointParameter::Zero);
    let blocks = &context.recorded.blocks;
    let squares = blocks
        .iter()
        .map(|b| b.y_square[axis] - zero * (2.0 * b.y[axis] - zero));
    let square = squares.sum::<f64>() / blocks.len().max(1) as f64;
    let soft = 1.0 + at(JointParameter::Compliance);
    transmission.stiffness_nm_per_rad / soft * (1.0 + 3.0 * at(JointParameter::Stiffening) * square)
}

fn named_direction(robot: &Robot, direction: &UnobservableDirection) -> UnobservableCombination {
    let first = direction.weights.iter().find(|(_, weight)| *weight == 1.0);
    let metres = |axis: usize| {
        let tendon = robot.transmissions.get(axis)?.as_ref()?.tendon.as_ref()?;
        Some(tendon.joint_pulley_radius_m)
    };
    let weights = direction.weights.iter();
    let largest_m = weights
        .clone()
        .filter_map(|(axis, weight)| Some(weight.abs() * metres(*axis)?))
        .fold(0.0, f64::max);
    UnobservableCombination {
        tendons: weights
            .map(|(axis, weight)| TendonWeight {
                name: robot.tendon_name(*axis).to_owned(),
                weight: match metres(*axis) {
                    Some(metres) if largest_m > 0.0 => weight * metres / largest_m,
                    _ => *weight,
                },
            })
            .collect(),
        std_rad: direction.std_rad,
        std_m: first.and_then(|(axis, _)| Some(direction.std_rad * metres(*axis)?)),
        remedies: Vec::new(),
        changes: Vec::new(),
    }
}

/// Axes of the tendons in an unobservable combination whose moment arms are parallel to those of another one, such as
/// flexor and extensor of one joint. A change of one rotates the joints in the same way as a change of the other.
fn indistinguishable(robot: &Robot, direction: &UnobservableDirection) -> Vec<usize> {
    /// Maximum sine of the angle between the moment-arm rows of two parallel tendons.
    const MAX_PARALLEL_SINE: f64 = 1e-3;
    let arms = |axis: usize| {
        let routing = robot.transmissions.get(axis)?.as_ref()?.routing.as_ref()?;
        Some(routing.moment_arms.as_slice())
    };
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let is_parallel = |a: &[f64], b: &[f64]| {
        let lengths = product(a, a) * product(b, b);
        lengths - product(a, b).powi(2) < MAX_PARALLEL_SINE * MAX_PARALLEL_SINE * lengths
    };
    let members: Vec<usize> = direction.weights.iter().map(|(axis, _)| *axis).collect();
    let has_parallel = |axis: &usize| {
        let others = members.iter().filter(|other| *other != axis);
        let pairs = others.filter_map(|other| Some((arms(*axis)?, arms(*other)?)));
        pairs.into_iter().any(|(a, b)| is_parallel(a, b))
    };
    members.iter().copied().filter(has_parallel).collect()
}

/// Changes of the tendons on the given axes, in the order of time.
fn changes_of(context: &Context<'_>, tendons: &[usize]) -> Vec<UnattributedChange> {
    let all = tendons
        .iter()
        .flat_map(|axis| changes::changes(context, *axis));
    let mut all: Vec<UnattributedChange> = all
        .map(|change| UnattributedChange {
            time_s: change.time_s,
            interval_s: change.interval_s,
            probability: change.probability,
        })
        .collect();
    all.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    all
}

/// Offsets of the joints of a group, with the excess residual of each joint in the interval.
fn joint_offsets(context: &Context<'_>, group: &GroupPosterior, is_taut: bool) -> Vec<JointOffset> {
    let names = group.joints.iter().map(|j| context.robot.axis_name(*j));
    let taut = group.joint_offsets_rad.as_ref().filter(|_| is_taut);
    let offsets = taut.into_iter().flatten();
    names
        .zip(&group.joints)
        .zip(offsets)
        .map(|((name, j), offset)| {
            let maps = context.segments.estimates.iter();
            let noise = maps.map(|(_, map)| map.noise_rad[*j]).fold(0.0, f64::max);
            let std = offset.std.hypot(excess_residual_rad(noise));
            JointOffset {
                name: name.to_owned(),
                offset_rad: Gaussian::new(offset.mean, std),
            }
        })
        .collect()
}

/// Measurements that would make the unobservable combinations of a group observable.
fn remedies(context: &Context<'_>, group: &GroupPosterior) -> Vec<Remedy> {
    let routing = |i: &usize| context.robot.transmissions[*i].as_ref()?.routing.as_ref();
    let motors: BTreeSet<&str> = (group.tendons.iter())
        .filter_map(|i| Some(routing(i)?.motor.as_str()))
        .collect();
    let mut blocks = context.recorded.blocks.iter();
    let has_torque = context.estimator.uses_motor_torque()
        && blocks.any(|b| group.tendons.iter().all(|i| b.motor_torque[*i].is_finite()));
    let has_own_motors = motors.len() == group.tendons.len();
    let mut blocks = context.recorded.blocks.iter();
    let has_tension = blocks.any(|b| {
        let tension = |i: &usize| b.tension_nm.get(*i).is_some_and(|t| t.is_finite());
        group.tendons.iter().all(tension)
    });
    let torque = (has_own_motors && !has_torque).then_some(Remedy::MotorTorque);
    let tension = (!has_tension).then_some(Remedy::TensionSensors);
    torque.into_iter().chain(tension).collect()
}

/// Tautness of the tendon on an axis.
fn tautness(context: &Context<'_>, axis: usize) -> Tautness {
    let transmission = context.robot.transmissions[axis].as_ref();
    let pull = transmission.and_then(|t| Some((t, t.routing.as_ref()?.pull.as_ref()?)));
    let Some((transmission, pull)) = pull.filter(|(_, pull)| pull.kind == TendonKind::Strand)
    else {
        return Tautness::Taut;
    };
    let prior = context.estimator.prior();
    let at = |p| context.segments.state_estimate.entry(prior.place(axis, p));
    let stretched_rad = pull.pretension_nm / transmission.stiffness_nm_per_rad;
    // Prior of the zero: a slack strand has no information on its own tension.
    let zero = context
        .segments
        .before
        .entry(prior.place(axis, JointParameter::Zero));
    let offset = at(JointParameter::Offset).mean + at(JointParameter::Zero).mean;
    let soft = 1.0 + at(JointParameter::Compliance).mean;
    let (mut slack, mut near, mut counted) = (0_usize, 0_usize, 0_usize);
    let mut furthest_rad = f64::NEG_INFINITY;
    for block in &context.recorded.blocks {
        let y = block.y[axis];
        let varies_rad = (block.y_square[axis] - y * y).max(0.0).sqrt();
        let pulled_rad = soft * stretched_rad + y - offset;
        counted += 1;
        slack += usize::from(pulled_rad <= 0.0);
        near += usize::from(pulled_rad < MIN_TAUT_STDS * varies_rad);
        if pulled_rad <= 0.0 {
            furthest_rad = furthest_rad.max(y);
        }
    }
    if slack > 0 {
        let share = slack as f64 / counted.max(1) as f64;
        // Slack even at the largest pull of the motor among the slack blocks.
        let least = furthest_rad + stretched_rad - zero.mean;
        let std = zero.std.hypot(STIFFNESS_STD_RATIO * stretched_rad);
        let least = Gaussian::new(least, std).interval_95().low;
        Tautness::Slack(SlackStrand {
            axis,
            share,
            lower_bound_rad: (share > MAX_SLACK_SHARE).then_some(least),
        })
    } else if near > 0 {
        Tautness::Touches
    } else {
        Tautness::Taut
    }
}
