//! Fig. 6: the estimate in simulation, without and with model errors.
//!
//! Reading order: this file (plant and estimates), `errors` (the three panels), `sources` (other torques than the observer's),
//! `forces` (external forces that are unknown to the estimator), `draw`.

mod draw;
mod errors;
mod forces;
mod sources;

use super::PaperError;
use super::analytic::Analytic;
use super::data::{FigureName, PaperFigure, given, not_assessed};
use super::staircase::{GAIN_PER_S, LENGTH_S, MOVE_S, PAUSE_S, STEPS, TO_RAD, controller, motion};
use super::trial::{Estimator, Trial, joint};
use sinew_model::offset::{Comparison, OffsetConfig, TorqueSource, VelocityFilter};
use sinew_model::robot::Robot;
use sinew_sim::Scenario;
use sinew_sim::scenario::{FrictionSpec, Record};

const JOINT: &str = "shoulder_pitch";
/// The paper's artificial offsets, rad.
const OFFSETS: [f64; 3] = [0.0, 0.010, 0.015];
/// The paper's errors of the model: factors on stiffness and masses.
const STIFFNESS_FACTOR: f64 = 1.2;
const MASS_FACTOR: f64 = 0.9;

/// Wrong model parameters of the estimator.
const BELIEFS: [(&str, f64, f64); 3] = [
    ("No model error", 1.0, 1.0),
    ("K +20 %", STIFFNESS_FACTOR, 1.0),
    ("M, C, g −10 %", 1.0, MASS_FACTOR),
];

/// The arm without friction, with perfect sensors, recorded at 1 kHz.
fn scenario(robot: &Robot) -> Scenario {
    Scenario {
        name: "fig6".into(),
        duration_s: Some(LENGTH_S),
        sample_rate_hz: 1000.0,
        controller: controller(robot.joint_names()),
        motion: motion(JOINT),
        joint_friction: FrictionSpec::none(),
        motor_friction: FrictionSpec::none(),
        record: Record {
            dq: true,
            tau_el: true,
            tau_m: true,
            ..Record::default()
        },
        ..Scenario::default()
    }
}

/// Observer, the paper's comparison, exact velocities.
fn config() -> OffsetConfig {
    OffsetConfig {
        source: TorqueSource::Observer,
        comparison: Comparison::Paper,
        gain_per_s: GAIN_PER_S,
        velocity: VelocityFilter::Recorded,
    }
}

/// Estimates with one assumed model.
struct Case {
    title: &'static str,
    /// By offset, the paper's comparison.
    paper: Vec<Vec<f64>>,
    /// By offset, matched.
    matched: Vec<Vec<f64>>,
}

/// The three assumed models of the paper.
fn cases(robot: &Robot, trial: &Trial, shoulder: usize) -> Result<[Case; 3], PaperError> {
    let case = |(title, stiffness, mass): (&'static str, f64, f64)| {
        let estimator = Estimator::of(robot, config())
            .with_stiffness_factor(stiffness)
            .with_mass_factor(mass)?;
        let all = |e: &Estimator| {
            OFFSETS
                .iter()
                .map(|&offset| e.estimate(trial, shoulder, offset))
                .collect::<Result<Vec<_>, _>>()
        };
        Ok::<_, PaperError>(Case {
            title,
            paper: all(&estimator)?,
            matched: all(&estimator.clone().comparing(Comparison::Matched))?,
        })
    };
    let [right, stiff, light] = BELIEFS;
    Ok([case(right)?, case(stiff)?, case(light)?])
}

/// Reproduces Fig. 6 on `robot`, which needs a joint `shoulder_pitch` and a link `tool` for payload and pushes.
///
/// # Errors
/// Returns a [`PaperError`] if the robot cannot be simulated, lacks the joint, or has it rigid.
pub fn fig6(robot: &Robot) -> Result<PaperFigure, PaperError> {
    let shoulder = joint(robot, JOINT, "fig6")?;
    let analytic = Analytic::new(robot, shoulder)?;
    let trial = Trial::run(robot, &scenario(robot))?;
    let cases = cases(robot, &trial, shoulder)?;
    let forces = forces::Forces::run(robot, shoulder, &analytic)?;
    let mut sentences = errors::of_the_model(&trial, &cases, &analytic)?;
    sentences.extend(sources::sentences(robot, &trial, shoulder, &analytic)?);
    sentences.extend(errors::of_motion(&trial, shoulder, &cases[0], &analytic)?);
    sentences.extend(forces.sentences());
    let panels = draw::panels(&trial, shoulder, &cases);
    let figure = draw::figure(&panels);
    Ok(PaperFigure {
        about: about(robot, &analytic)?,
        panels,
        sentences,
        tables: vec![forces.table()],
        not_assessed: not_assessed(&[
            [
                "A stretched rope shifts the measured motor position by delta_e = theta_measured − q − tau_el/K (eq. 4 to 6).",
                "A definition. Plant and estimator are both based on it, so that no simulation can contradict it.",
            ],
            [
                "The elastic torque follows from the generalised momentum (eq. 7), without accelerations.",
                "Assessed by its consequence: without model error the estimate shows the added offset (fig6).",
            ],
            [
                "The offset is added to the motor position where that is larger than the offset, else nothing is added.",
                "A procedure. Interpretation: nothing is added where the motor position is not larger than the offset.",
            ],
        ]),
        given: given(&[
            "0 to 90° in four steps; offsets of 0.01 and 0.015 rad; K +20 %; M, C and g −10 %. No size of an error is given.",
        ]),
        assumptions: assumptions(),
        ..PaperFigure::new(
            FigureName::Fig6,
            "Fig. 6: offset estimate in simulation, with model errors",
            figure,
        )
    })
}

fn about(robot: &Robot, analytic: &Analytic<'_>) -> Result<Vec<String>, PaperError> {
    Ok(vec![
        format!(
            "The shoulder of the {} arm (K = {} N·m/rad, {:.2} N·m of gravity at 90°) rises from 0 to {:.0}° in {STEPS} moves of {MOVE_S} s with rests of {PAUSE_S} s. An offset of 0, 10 or 15 mrad is added to the recorded motor position where that is larger than the offset. The observer (K_I = {GAIN_PER_S} 1/s) estimates it with an exact model, with a stiffness 20 % too high, and with masses 10 % too low.",
            robot.name,
            analytic.stiffness_nm_per_rad,
            analytic.last_gravity_nm()?,
            TO_RAD.to_degrees()
        ),
        "First row, as in the paper: a lagging torque against an unfiltered theta − q, in which every move shows. Second row, added by Sinew: the matched comparison, both sides with the same lag. Third row, as in the paper: the difference of the estimates for 15 and 10 mrad, which cancels every model error. (While the motor passes from 10 to 15 mrad only the smaller offset is added; there the difference is undefined, and the line has a gap.)".into(),
    ])
}

fn assumptions() -> Vec<String> {
    vec![
        "The robot is BioRob-like, not the BioRob: its parameters are not published in full.".into(),
        format!("Moves of {MOVE_S} s, rests of {PAUSE_S} s and a gain of {GAIN_PER_S} 1/s are assumed: the paper specifies none. The size of the error in motion depends on them."),
        "“At rest” is the mean over the last 0.5 s of a rest, about one oscillation period of the arm on its springs.".into(),
        "“Where it is larger than the offset, else zero” is interpreted as: nothing is added where the motor position is not larger than the offset.".into(),
        "Neither the offset (it is added to the recording) nor friction acts on the arm; velocities are those of the simulation.".into(),
        "Payload and forces are Sinew's: the paper specifies no force. The payload is attached to the tool, and a force acts there in a constant direction.".into(),
    ]
}
