//! The robots and what is known of them.

use super::super::PaperError;
use super::super::staircase::controller;
use super::super::trial::{mean, std};
use super::Effort;
use crate::control::{ContactScore, Outcome, noise_nm, run_watched};
use serde::Serialize;
use sinew_creep::each;
use sinew_model::robot::Robot;
use sinew_sim::scenario::{
    Bound, ContactDetection, Correction, Draw, Encoder, FrictionSpec, KnownOffset, Motion, Offset,
    OffsetKind, PerJoint, RandomContacts, Scenario, SetPointKind, Shape, Truth,
};

/// Joints whose ropes have stretched.
pub(super) const STRETCHED: [&str; 2] = ["shoulder_pitch", "elbow"];
/// By how much, rad.
pub(super) const OFFSET_RAD: f64 = 0.010;
/// Error of an estimated offset, rad (standard deviation): above the 0.30 and 0.32 mrad that
/// `sinew estimate --baseline` reached in sixty work sessions.
pub(super) const ESTIMATE_RAD: f64 = 0.000_35;
/// What the detector is told of it: intervals of `sinew estimate` are on the wide side.
pub(super) const TOLD_RAD: f64 = 0.000_5;
/// Error of an estimated stiffness, share.
pub(super) const STIFFNESS_ERROR: f64 = 0.02;
/// Factors on the detection threshold, from nervous to deaf.
pub(super) const FACTORS: [f64; 14] = [
    0.25, 0.35, 0.5, 0.7, 0.85, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0,
];

/// A robot as it truly is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct World {
    pub(super) name: &'static str,
    pub(super) stiffness: f64,
    pub(super) mass: f64,
    pub(super) stretched: bool,
    pub(super) drive_friction: bool,
}

/// What controller and detector know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Knows {
    Nothing,
    True,
    TrueAndDynamics,
    Estimate,
    EstimateAndStiffness,
    /// As `Estimate`, and the detector is told the tolerances of stiffness and masses.
    EstimateAndTolerances,
}

impl Knows {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::True => "true",
            Self::TrueAndDynamics => "dynamic",
            Self::Estimate => "estimate",
            Self::EstimateAndStiffness => "+ stiffness",
            Self::EstimateAndTolerances => "+ tolerance",
        }
    }
}

const RIGHT: World = World {
    name: "stretched",
    stiffness: 1.0,
    mass: 1.0,
    stretched: true,
    drive_friction: false,
};

/// Every row of the table, in order.
pub(super) const CASES: [(World, Knows); 20] = {
    use Knows::*;
    const NEW: World = World {
        name: "new ropes",
        stretched: false,
        ..RIGHT
    };
    const SOFT: World = World {
        name: "K −20 %",
        stiffness: 0.8,
        ..RIGHT
    };
    const STIFF: World = World {
        name: "K +20 %",
        stiffness: 1.2,
        ..RIGHT
    };
    const LIGHT: World = World {
        name: "M −10 %",
        mass: 0.9,
        ..RIGHT
    };
    const HEAVY: World = World {
        name: "M +10 %",
        mass: 1.1,
        ..RIGHT
    };
    const STICKY: World = World {
        name: "friction",
        drive_friction: true,
        ..RIGHT
    };
    [
        (NEW, Nothing),
        (RIGHT, Nothing),
        (RIGHT, True),
        (RIGHT, TrueAndDynamics),
        (RIGHT, Estimate),
        (SOFT, Nothing),
        (SOFT, Estimate),
        (SOFT, EstimateAndStiffness),
        (SOFT, EstimateAndTolerances),
        (STIFF, Nothing),
        (STIFF, Estimate),
        (STIFF, EstimateAndStiffness),
        (LIGHT, Nothing),
        (LIGHT, Estimate),
        (LIGHT, EstimateAndTolerances),
        (HEAVY, Nothing),
        (HEAVY, Estimate),
        (HEAVY, EstimateAndTolerances),
        (STICKY, Nothing),
        (STICKY, Estimate),
    ]
};

/// A working day's minute: random poses, contacts, real sensors.
pub(super) fn session(
    robot: &Robot,
    world: &World,
    knows: Knows,
    seed: u64,
    seconds: f64,
) -> Scenario {
    let ranges = [
        ("shoulder_yaw", -1.2, 1.2),
        ("shoulder_pitch", 0.0, 1.7),
        ("elbow", 0.0, 1.8),
        ("wrist", -1.0, 1.0),
    ];
    Scenario {
        name: "control".into(),
        duration_s: Some(seconds),
        seed,
        // The gains of the work sessions of SCENARIOS, whose estimates are quoted.
        controller: controller(robot.joint_names()),
        motion: Motion::Random {
            range_rad: PerJoint {
                all: None,
                by_joint: ranges
                    .map(|(n, min, max)| (n.into(), 0, Draw::Uniform { min, max }))
                    .into_iter()
                    .filter(|(n, _, _): &(String, _, _)| robot.arm.joint_index(n).is_some())
                    .collect(),
            },
            move_s: Draw::Uniform { min: 0.9, max: 1.6 },
            pause_s: Draw::Uniform { min: 1.2, max: 1.8 },
        },
        truth: Truth {
            stiffness_factor: PerJoint::fixed(world.stiffness),
            mass_factor: PerJoint::fixed(world.mass),
            ..Truth::default()
        },
        motor_friction: if world.drive_friction {
            FrictionSpec::default()
        } else {
            FrictionSpec::none()
        },
        encoder: Encoder {
            joint_bits: Some(13),
            once_per_turn_rad: spread(0.0003),
            twice_per_turn_rad: spread(0.0003),
            motor_resolution_rad: 0.000_06,
            motor_noise_rad: 0.0002,
            ..Encoder::default()
        },
        random_contacts: Some(RandomContacts {
            fraction: 0.15,
            // Behind the wrist: only joints with stretched ropes (and the yaw) can feel it.
            link: "forearm".into(),
            line: 0,
            point_m: [0.0, 0.0, -0.31],
            force_n: Draw::Uniform { min: 0.3, max: 3.0 },
            duration_s: Draw::Uniform { min: 0.3, max: 0.9 },
            rise_s: 0.05,
            from_to_s: (1.0, f64::INFINITY),
        }),
        offsets: STRETCHED
            .iter()
            .filter(|_| world.stretched)
            .map(|joint| stretch(joint))
            .collect(),
        correction: correction(world, knows),
        contact_detection: detection(knows),
        ..Scenario::default()
    }
}

/// A rope that is longer by [`OFFSET_RAD`] from the start.
pub(super) fn stretch(joint: &str) -> Offset {
    Offset {
        joint: joint.into(),
        line: 0,
        kind: OffsetKind::Physical,
        size_rad: Draw::Fixed(OFFSET_RAD),
        shape: Shape::Constant,
        later_s: Draw::Fixed(0.0),
    }
}

/// Drawn anew for every joint and seed.
fn spread(std: f64) -> PerJoint {
    PerJoint {
        all: Some(Draw::Normal {
            mean: 0.0,
            std,
            bound: Bound::Any,
        }),
        by_joint: Vec::new(),
    }
}

fn detection(knows: Knows) -> ContactDetection {
    let mut detection = ContactDetection::default();
    if knows == Knows::EstimateAndTolerances {
        detection.mass_deviation = 0.05;
    }
    detection
}

fn correction(world: &World, knows: Knows) -> Correction {
    // Without an estimate the ropes are believed to be as they were.
    let mut out = Correction {
        offset_deviation_rad: PerJoint::fixed(TOLD_RAD),
        ..Correction::default()
    };
    match knows {
        Knows::Nothing => return out,
        Knows::True => {
            out.offset = KnownOffset::True;
            out.offset_deviation_rad = PerJoint::fixed(0.0);
            return out;
        }
        Knows::TrueAndDynamics => {
            out.offset = KnownOffset::True;
            out.offset_deviation_rad = PerJoint::fixed(0.0);
            out.set_point = SetPointKind::Dynamic;
            return out;
        }
        Knows::Estimate | Knows::EstimateAndStiffness | Knows::EstimateAndTolerances => {}
    }
    out.offset = KnownOffset::True;
    out.offset_error_rad = spread(ESTIMATE_RAD);
    if knows == Knows::EstimateAndStiffness {
        out.stiffness_factor = PerJoint {
            all: Some(Draw::Normal {
                mean: world.stiffness,
                std: STIFFNESS_ERROR * world.stiffness,
                bound: Bound::Positive,
            }),
            by_joint: Vec::new(),
        };
        out.stiffness_deviation = PerJoint::fixed(STIFFNESS_ERROR * world.stiffness);
    }
    if knows == Knows::EstimateAndTolerances {
        out.stiffness_deviation = PerJoint::fixed(0.1);
    }
    out
}

/// A row of the table over all seeds.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// How the robot truly is.
    pub robot: &'static str,
    /// What controller and detector know.
    pub knows: &'static str,
    /// RMS of `q − q_d` at rest of shoulder pitch and elbow, mrad: mean over the seeds.
    pub rest_mrad: [f64; 2],
    /// Its standard deviation over the seeds.
    pub rest_spread_mrad: [f64; 2],
    /// RMS of `q − q_d` over everything, mrad.
    pub motion_mrad: [f64; 2],
    /// Its standard deviation over the seeds.
    pub motion_spread_mrad: [f64; 2],
    /// Mean external torque seen while nothing touches, N·m.
    pub false_torque_nm: [f64; 2],
    /// Mean threshold, N·m.
    pub threshold_nm: [f64; 2],
    /// Contacts of all seeds together.
    pub contacts: ContactScore,
    /// Share of the contacts missed, %: lowest and highest seed.
    pub missed_percent_range: [f64; 2],
    /// Share of the free time with a false alarm, %: lowest and highest seed.
    pub false_percent_range: [f64; 2],
    /// Contacts with other sensitivities: factor on the threshold and what was seen.
    pub sensitivities: Vec<(f64, ContactScore)>,
}

/// Runs every case with every seed, on all processors.
pub(super) fn rows(robot: &Robot, effort: &Effort) -> Result<Vec<Row>, PaperError> {
    let joints = super::stretched_joints(robot)?;
    let quiet = session(robot, &RIGHT, Knows::Nothing, 1, effort.seconds);
    let noise = noise_nm(robot, &quiet)?;
    let jobs: Vec<(usize, u64)> = (0..CASES.len())
        .flat_map(|case| (1..=effort.seeds).map(move |seed| (case, seed)))
        .collect();
    let outcomes = each(
        &jobs,
        |&(case, seed)| {
            let (world, knows) = &CASES[case];
            let scenario = session(robot, world, *knows, seed, effort.seconds);
            run_watched(robot, &scenario, &noise, &FACTORS, &mut |_, _| {})
        },
        |_| {},
    );
    let mut by_case: Vec<Vec<Outcome>> = vec![Vec::new(); CASES.len()];
    for ((case, _), outcome) in jobs.iter().zip(outcomes) {
        by_case[*case].push(outcome?);
    }
    Ok(by_case
        .iter()
        .zip(&CASES)
        .map(|(outcomes, (world, knows))| row(world, *knows, outcomes, joints))
        .collect())
}

fn row(world: &World, knows: Knows, outcomes: &[Outcome], joints: [usize; 2]) -> Row {
    let values = |of: &dyn Fn(&Outcome, usize) -> f64| {
        joints.map(|i| {
            let all: Vec<f64> = outcomes.iter().map(|o| of(o, i)).collect();
            (mean(&all), sample_std(&all))
        })
    };
    let rest = values(&|o, i| o.score.joints[i].rest_rms_mrad);
    let motion = values(&|o, i| o.score.joints[i].rms_mrad);
    let mut contacts = outcomes[0].score.contacts.clone();
    let mut sensitivities: Vec<(f64, ContactScore)> = outcomes[0]
        .sensitivities
        .iter()
        .map(|s| (s.threshold_factor, s.contacts.clone()))
        .collect();
    for o in &outcomes[1..] {
        contacts.add(&o.score.contacts);
        for ((_, sum), s) in sensitivities.iter_mut().zip(&o.sensitivities) {
            sum.add(&s.contacts);
        }
    }
    let range = |of: &dyn Fn(&ContactScore) -> f64| {
        let all = outcomes.iter().map(|o| of(&o.score.contacts));
        [
            all.clone().fold(f64::INFINITY, f64::min),
            all.fold(f64::NEG_INFINITY, f64::max),
        ]
    };
    Row {
        robot: world.name,
        knows: knows.name(),
        rest_mrad: rest.map(|v| v.0),
        rest_spread_mrad: rest.map(|v| v.1),
        motion_mrad: motion.map(|v| v.0),
        motion_spread_mrad: motion.map(|v| v.1),
        false_torque_nm: values(&|o, i| o.score.joints[i].false_torque_nm).map(|v| v.0),
        threshold_nm: values(&|o, i| o.score.joints[i].threshold_nm).map(|v| v.0),
        missed_percent_range: range(&ContactScore::missed_percent),
        false_percent_range: range(&ContactScore::false_percent),
        contacts,
        sensitivities,
    }
}

/// Standard deviation of a sample; 0 of one value.
fn sample_std(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    if n < 2.0 {
        return 0.0;
    }
    std(values) * (n / (n - 1.0)).sqrt()
}
