//! Robots of the control study and the corrections specified for them.

use super::super::PaperError;
use super::super::row::{Knowledge, Range, RobotCase, Row, RowJoint};
use super::super::staircase::controller;
use super::super::trial::{mean, std};
use super::Effort;
use sinew_creep::each;
use sinew_model::Gaussian;
use sinew_model::robot::Robot;
use sinew_sim::control::{ContactScore, JointScore, Outcome, noise_nm, run_with_detectors};
use sinew_sim::scenario::{
    Bound, ContactDetection, Correction, Draw, Encoder, FrictionSpec, Motion, Offset, OffsetKind,
    PerJoint, RandomContacts, Scenario, SetPointKind, Shape, SpecifiedOffset, Truth,
};

/// Joints with stretched ropes.
pub(super) const STRETCHED: [&str; 2] = ["shoulder_pitch", "elbow"];
/// Offset of their ropes, rad.
pub(super) const OFFSET_RAD: f64 = 0.010;
/// Error of an estimated offset, rad (standard deviation): above the 0.30 and 0.32 mrad that
/// `sinew estimate --baseline` reached in sixty work sessions.
pub(super) const ESTIMATE_RAD: f64 = 0.000_35;
/// Standard deviation of the offset that the detector assumes, rad; it is larger than the error, as in `sinew
/// estimate`, whose intervals are conservative.
pub(super) const DETECTOR_DEVIATION_RAD: f64 = 0.000_5;
/// Error of an estimated stiffness, share.
pub(super) const STIFFNESS_ERROR: f64 = 0.02;
/// Factors on the detection threshold, from the most sensitive to the least sensitive.
pub(super) const FACTORS: [f64; 14] = [
    0.25, 0.35, 0.5, 0.7, 0.85, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0,
];

/// Every row of the table, in order.
pub(super) const CASES: [(RobotCase, Knowledge); 20] = {
    use Knowledge::*;
    use RobotCase::*;
    [
        (NewRopes, Nothing),
        (Stretched, Nothing),
        (Stretched, True),
        (Stretched, TrueAndDynamics),
        (Stretched, Estimate),
        (Softer, Nothing),
        (Softer, Estimate),
        (Softer, EstimateAndStiffness),
        (Softer, EstimateAndTolerances),
        (Stiffer, Nothing),
        (Stiffer, Estimate),
        (Stiffer, EstimateAndStiffness),
        (Lighter, Nothing),
        (Lighter, Estimate),
        (Lighter, EstimateAndTolerances),
        (Heavier, Nothing),
        (Heavier, Estimate),
        (Heavier, EstimateAndTolerances),
        (DriveFriction, Nothing),
        (DriveFriction, Estimate),
    ]
};

/// One minute of work: random poses, contacts, realistic sensors.
pub(super) fn session(
    robot: &Robot,
    case: RobotCase,
    knowledge: Knowledge,
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
            stiffness_factor: PerJoint::fixed(case.stiffness_factor()),
            mass_factor: PerJoint::fixed(case.mass_factor()),
            ..Truth::default()
        },
        motor_friction: if case == RobotCase::DriveFriction {
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
            // Behind the wrist: it acts only on joints with stretched ropes (and the yaw).
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
            .filter(|_| case != RobotCase::NewRopes)
            .map(|joint| stretch(joint))
            .collect(),
        correction: correction(case, knowledge),
        contact_detection: detection(knowledge),
        ..Scenario::default()
    }
}

/// Offset of [`OFFSET_RAD`] from the start.
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

/// Independent draw for every joint and seed.
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

fn detection(knowledge: Knowledge) -> ContactDetection {
    let mut detection = ContactDetection::default();
    if knowledge == Knowledge::EstimateAndTolerances {
        detection.mass_std = 0.05;
    }
    detection
}

fn correction(case: RobotCase, knowledge: Knowledge) -> Correction {
    // Without an estimate the ropes are assumed to be nominal.
    let mut out = Correction {
        offset_std_rad: PerJoint::fixed(DETECTOR_DEVIATION_RAD),
        ..Correction::default()
    };
    match knowledge {
        Knowledge::Nothing => return out,
        Knowledge::True => {
            out.offset = SpecifiedOffset::True;
            out.offset_std_rad = PerJoint::fixed(0.0);
            return out;
        }
        Knowledge::TrueAndDynamics => {
            out.offset = SpecifiedOffset::True;
            out.offset_std_rad = PerJoint::fixed(0.0);
            out.set_point = SetPointKind::Dynamic;
            return out;
        }
        Knowledge::Estimate
        | Knowledge::EstimateAndStiffness
        | Knowledge::EstimateAndTolerances => {}
    }
    out.offset = SpecifiedOffset::True;
    out.offset_error_rad = spread(ESTIMATE_RAD);
    if knowledge == Knowledge::EstimateAndStiffness {
        out.stiffness_factor = PerJoint {
            all: Some(Draw::Normal {
                mean: case.stiffness_factor(),
                std: STIFFNESS_ERROR * case.stiffness_factor(),
                bound: Bound::Positive,
            }),
            by_joint: Vec::new(),
        };
        out.stiffness_std = PerJoint::fixed(STIFFNESS_ERROR * case.stiffness_factor());
    }
    if knowledge == Knowledge::EstimateAndTolerances {
        out.stiffness_std = PerJoint::fixed(0.1);
    }
    out
}

/// Runs every case with every seed, on all processors.
pub(super) fn rows(robot: &Robot, effort: &Effort) -> Result<Vec<Row>, PaperError> {
    let joints = super::stretched_joints(robot)?;
    let quiet = session(
        robot,
        RobotCase::Stretched,
        Knowledge::Nothing,
        1,
        effort.seconds,
    );
    let noise = noise_nm(robot, &quiet)?;
    let jobs: Vec<(usize, u64)> = (0..CASES.len())
        .flat_map(|case| (1..=effort.seeds).map(move |seed| (case, seed)))
        .collect();
    let outcomes = each(
        &jobs,
        |&(case, seed)| {
            let (robot_case, knowledge) = CASES[case];
            let scenario = session(robot, robot_case, knowledge, seed, effort.seconds);
            run_with_detectors(robot, &scenario, &noise, &FACTORS, &mut |_, _| {})
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
        .map(|(outcomes, &(case, knowledge))| row(case, knowledge, outcomes, joints))
        .collect())
}

fn row(robot: RobotCase, knowledge: Knowledge, outcomes: &[Outcome], joints: [usize; 2]) -> Row {
    let over_sessions = |of: &dyn Fn(&JointScore) -> f64, i: usize| {
        let all: Vec<f64> = outcomes.iter().map(|o| of(&o.score.joints[i])).collect();
        Gaussian {
            mean: mean(&all),
            std: sample_std(&all),
        }
    };
    let mut contacts = outcomes[0].score.contacts.clone();
    let mut sensitivities = outcomes[0].sensitivities.clone();
    for o in &outcomes[1..] {
        contacts.add(&o.score.contacts);
        for (sum, s) in sensitivities.iter_mut().zip(&o.sensitivities) {
            sum.contacts.add(&s.contacts);
        }
    }
    let range = |of: &dyn Fn(&ContactScore) -> f64| {
        let all = outcomes.iter().map(|o| of(&o.score.contacts));
        Range {
            lowest: all.clone().fold(f64::INFINITY, f64::min),
            highest: all.fold(f64::NEG_INFINITY, f64::max),
        }
    };
    Row {
        robot,
        knowledge,
        joints: joints.map(|i| RowJoint {
            rest_rad: over_sessions(&|j| j.rest_rms_rad, i),
            overall_rad: over_sessions(&|j| j.rms_rad, i),
            false_torque_nm: over_sessions(&|j| j.false_torque_nm, i).mean,
            threshold_nm: over_sessions(&|j| j.threshold_nm, i).mean,
        }),
        missed_share: range(&ContactScore::missed_share),
        false_share: range(&ContactScore::false_share),
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
