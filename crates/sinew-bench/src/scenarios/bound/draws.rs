//! Standard deviations of the draws.

use super::OPEN_RAD;
use super::truth::Truth;
use sinew_model::robot::Robot;
use sinew_sim::protocol::Plan;
use sinew_sim::scenario::{Draw, PerJoint};

/// Standard deviations of the protocol's draws, in the order of a row.
pub(super) fn stds(plan: &Plan, truth: &Truth, robot: &Robot) -> Vec<f64> {
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
    out.push(s.payloads.first().map_or(0.0, |p| std(p.mass_kg)));
    out.push(std(s.temperature.reading_error_k));
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
    own.map(|(_, _, d)| *d).or(per.all).map_or(0.0, std)
}

fn std(draw: Draw) -> f64 {
    match draw {
        Draw::Fixed(_) => 0.0,
        Draw::Uniform { min, max } => (max - min) / 12f64.sqrt(),
        Draw::Normal { std, .. } => std,
    }
}
