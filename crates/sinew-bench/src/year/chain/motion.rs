//! Motion of a robot while it is recorded: a check, or a minute of its work.

use super::ChainError;
use serde::{Deserialize, Serialize};
use sinew_model::robot::Robot;
use sinew_sim::scenario::{Bound, Draw, Motion, PerJoint, Waypoint};
use sinew_sim::{Scenario, SimulateError};

const WORK: &str = include_str!("../../../../../examples/scenarios/work-session.toml");
/// Length of a session of work, s.
const WORK_S: f64 = 60.0;
/// Step of the simulation, s.
const STEP_S: f64 = 1e-3;
/// Poses of a check.
const POSES: usize = 24;
/// Duration of move and rest of a check, s.
const MOVE_S: f64 = 1.25;
const PAUSE_S: f64 = 0.85;

/// Motion of a robot while it is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SessionKind {
    /// The same 24 poses every day, with an empty gripper and without contact.
    Check,
    /// Random poses for a minute, an unknown payload of up to 0.5 kg that is another every day,
    /// contacts a tenth of the time.
    Work,
}

impl SessionKind {
    /// Returns the name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            Self::Check => "check",
            Self::Work => "work",
        }
    }
}

/// Returns the work session of `examples/scenarios`, or the check within the same limits, for any robot: values of
/// joints that the robot does not have are removed.
pub(super) fn scenario(robot: &Robot, kind: SessionKind) -> Result<Scenario, ChainError> {
    let mut out = Scenario::from_toml(WORK, "work-session.toml").map_err(SimulateError::from)?;
    out.duration_s = Some(WORK_S);
    out.integration_step_s = STEP_S;
    out.offsets.clear();
    out.sessions.clear();
    keep_existing(&mut out, robot);
    for payload in &mut out.payloads {
        payload.attach_s = 0.0;
    }
    if let Some(contacts) = &mut out.random_contacts {
        contacts.from_to_s.0 = 0.0;
    }
    out.temperature.zero_drift_rad_per_k.all = Some(Draw::Normal {
        mean: 0.0,
        std: 1e-4,
        bound: Bound::Any,
    });
    out.temperature.stiffness_per_k.all = Some(Draw::Uniform {
        min: -0.003,
        max: -0.001,
    });
    if kind == SessionKind::Check {
        out.payloads.clear();
        out.random_contacts = None;
        if let Motion::Random { range_rad, .. } = &out.motion {
            let waypoints = poses(&ranges(robot, range_rad));
            out.duration_s = Some((MOVE_S + PAUSE_S) * POSES as f64);
            out.motion = check(robot, &waypoints);
        }
    }
    Ok(out)
}

/// Removes joints and links that the robot does not have.
fn keep_existing(scenario: &mut Scenario, robot: &Robot) {
    let exists = |joint: &str| robot.arm.joint_index(joint).is_some();
    let (joint, motor) = (&mut scenario.joint_friction, &mut scenario.motor_friction);
    let lists = [
        &mut scenario.controller.stiffness_nm_per_rad,
        &mut scenario.controller.damping_nm_s_per_rad,
        &mut joint.coulomb_nm,
        &mut joint.viscous_nm_s_per_rad,
        &mut motor.coulomb_nm,
        &mut motor.viscous_nm_s_per_rad,
    ];
    for list in lists {
        list.by_joint.retain(|(name, _, _)| exists(name));
    }
    if let Motion::Random { range_rad, .. } = &mut scenario.motion {
        range_rad.by_joint.retain(|(name, _, _)| exists(name));
    }
    let last = robot.arm.link_names().last().map(str::to_string);
    let links = scenario.payloads.iter_mut().map(|p| &mut p.link);
    let links = links.chain(scenario.random_contacts.as_mut().map(|c| &mut c.link));
    for link in links {
        if let (false, Some(last)) = (robot.arm.link_names().any(|l| l == link), &last) {
            link.clone_from(last);
        }
    }
}

/// Returns the range of each joint, rad: as specified, otherwise 80 % of its limits, or half a revolution without
/// limits.
fn ranges(robot: &Robot, stated: &PerJoint) -> Vec<[f64; 2]> {
    let own = |i: usize| {
        let [low, high] = [robot.limits[i].lower, robot.limits[i].upper];
        if low.is_finite() && high.is_finite() {
            let (middle, half) = (0.5 * (low + high), 0.4 * (high - low));
            [middle - half, middle + half]
        } else {
            [-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2]
        }
    };
    (robot.joint_names().iter().enumerate())
        .map(|(i, name)| {
            let stated = stated.by_joint.iter().find(|(n, _, _)| n == name);
            match stated.map(|(_, _, draw)| *draw) {
                Some(Draw::Uniform { min, max }) => [min, max],
                _ => own(i),
            }
        })
        .collect()
}

/// Poses spread evenly over the ranges: multiples of the powers of `1/g`, `g^(n+1) = g + 1`, less their
/// whole parts (Roberts' generalised golden ratio).
fn poses(ranges: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let n = ranges.len() as f64;
    let mut g: f64 = 1.5;
    for _ in 0..60 {
        g = (1.0 + g).powf(1.0 / (n + 1.0));
    }
    (1..=POSES)
        .map(|k| {
            let mut step = 1.0;
            ranges
                .iter()
                .map(|[low, high]| {
                    step /= g;
                    low + (high - low) * (0.5 + k as f64 * step).fract()
                })
                .collect()
        })
        .collect()
}

fn check(robot: &Robot, poses: &[Vec<f64>]) -> Motion {
    let pose = |values: &[f64]| PerJoint {
        all: None,
        by_joint: (robot.joint_names().iter().zip(values))
            .map(|(name, v)| (name.clone(), 0, Draw::Fixed(*v)))
            .collect(),
    };
    Motion::Waypoints {
        start_rad: pose(&poses[poses.len() - 1]),
        waypoints: poses
            .iter()
            .map(|values| Waypoint {
                pose_rad: pose(values),
                move_s: Draw::Fixed(MOVE_S),
                pause_s: Draw::Fixed(PAUSE_S),
            })
            .collect(),
        repeat: true,
    }
}
