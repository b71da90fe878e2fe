//! Fig. 7: the estimate on a robot, here a simulated "real" elbow.
//!
//! Reading order: `plant` (the elbow as it truly is), this file (the trials), `sentences`, `tendency` (why the estimate
//! decreases), `draw`.

mod draw;
mod plant;
mod sentences;
mod tendency;

use super::PaperError;
use super::analytic::Analytic;
use super::data::{FigureName, PaperFigure, given, not_assessed};
use super::sentence::Basis;
use super::staircase::{MOVE_S, PAUSE_S, STEPS};
use super::trial::{Estimator, Trial, joint};
use plant::{Day, scenario};
use sinew_model::offset::{Comparison, OffsetConfig};
use sinew_model::robot::Robot;
use tendency::Tendency;

const TITLE: &str = "Fig. 7: offset estimate of a simulated “real” elbow";
const JOINT: &str = "elbow";
/// The paper's artificial offset, rad.
const ADDED_RAD: f64 = 0.010;
/// Length by which the tensioner relaxes the rope, m.
const RELAXED_M: f64 = 0.5e-3;
/// Position error of the rope after re-tensioning, m.
const RETENSION_ERROR_M: f64 = 0.01e-3;
/// Pulley at the elbow of a robot whose description has no tendon, m.
const FALLBACK_RADIUS_M: f64 = 0.025;

/// Estimates of the four runs.
struct Runs {
    first: Vec<f64>,
    added: Vec<f64>,
    relaxed: Vec<f64>,
    again: Vec<f64>,
}

/// The four runs, recorded.
struct Trials {
    first: Trial,
    second: Trial,
    relaxed: Trial,
    again: Trial,
}

impl Trials {
    fn run(robot: &Robot, radius_m: f64) -> Result<Self, PaperError> {
        let trial = |seed, friction_factor, temperature_difference_k, relaxed_m: f64| {
            let day = Day {
                seed,
                friction_factor,
                temperature_difference_k,
                relaxed_rad: relaxed_m / radius_m,
                ..Day::default()
            };
            Trial::run(robot, &scenario(robot, &day))
        };
        Ok(Self {
            first: trial(1, 1.0, 0.0, 0.0)?,
            second: trial(2, 1.05, 0.5, 0.0)?,
            relaxed: trial(3, 0.95, -0.5, RELAXED_M)?,
            again: trial(4, 1.03, 1.0, RETENSION_ERROR_M)?,
        })
    }

    fn estimate(&self, by: &Estimator, elbow: usize) -> Result<Runs, PaperError> {
        Ok(Runs {
            first: by.estimate(&self.first, elbow, 0.0)?,
            added: by.estimate(&self.second, elbow, ADDED_RAD)?,
            relaxed: by.estimate(&self.relaxed, elbow, 0.0)?,
            again: by.estimate(&self.again, elbow, 0.0)?,
        })
    }
}

/// Reproduces Fig. 7 on `robot`, which needs a joint `elbow`.
///
/// # Errors
/// Returns a [`PaperError`] if the robot cannot be simulated, lacks the joint, or has it rigid.
pub fn fig7(robot: &Robot) -> Result<PaperFigure, PaperError> {
    let elbow = joint(robot, JOINT, "fig7")?;
    let analytic = Analytic::new(robot, elbow)?;
    let radius_m = robot.transmissions[elbow]
        .as_ref()
        .and_then(|t| t.tendon.as_ref())
        .map_or(FALLBACK_RADIUS_M, |t| t.joint_pulley_radius_m);
    // The paper's comparison, with the velocity filter that quantised positions need.
    let config = OffsetConfig {
        comparison: Comparison::Paper,
        ..OffsetConfig::default()
    };
    let estimator = Estimator::of(robot, config);
    let trials = Trials::run(robot, radius_m)?;
    let paper = trials.estimate(&estimator, elbow)?;
    let matching = estimator.clone().comparing(Comparison::Matched);
    let matched = trials.estimate(&matching, elbow)?;
    let tendency = Tendency::run(robot, elbow, &estimator)?;
    let mut sentences = sentences::sentences(&trials.first, &paper, &matched, radius_m);
    sentences.extend(tendency.sentences(&analytic)?);
    let sentences = sentences
        .into_iter()
        .map(|s| s.based_on(Basis::NoisySimulation))
        .collect();
    let panels = draw::panels(&trials.first, &paper, &matched, &tendency);
    let figure = draw::figure(&panels, RELAXED_M / radius_m);
    Ok(PaperFigure {
        about: about(robot, radius_m),
        panels,
        sentences,
        not_assessed: not_assessed(&[[
            "The oscillation of the estimate grows on the robot.",
            "Not testable without the recordings: it depends on friction and control of the BioRob. The friction assumed here damps it below that of an elbow without friction.",
        ]]),
        given: given(&[
            "0.01 rad added; the rope relaxed by about 0.5 mm. The paper contains no values of the estimate; it only describes the decrease and its cause.",
        ]),
        assumptions: assumptions(),
        ..PaperFigure::new(FigureName::Fig7, TITLE, figure)
    })
}

fn about(robot: &Robot, radius_m: f64) -> Vec<String> {
    vec![
        format!(
            "The elbow of the {} arm rises from 0 to 90° in {STEPS} moves of {MOVE_S} s with rests of {PAUSE_S} s, four times: unchanged; with {:.0} mrad added to the recorded motor position; with the rope relaxed by {:.1} mm at the tensioner ({:.0} mrad on a pulley of {:.0} mm); and re-tensioned.",
            robot.name,
            1e3 * ADDED_RAD,
            1e3 * RELAXED_M,
            1e3 * RELAXED_M / radius_m,
            1e3 * radius_m
        ),
        "The plant differs from the model. The model errors have the direction given in the paper and the size of those in Fig. 6: the described stiffness is a sixth too small, the described masses, and with them the joint torque, a ninth too large. In addition, the plant has a stiffening spring, 3 % of delayed elasticity, friction at joint and drive, 13-bit joint encoders with eccentricity, noisy motor angles. The estimator uses only the description, with joint friction set to zero.".into(),
        "The last panel, added by Sinew, shows each explanation alone, and the errors with opposite sign.".into(),
    ]
}

fn assumptions() -> Vec<String> {
    vec![
        "The paper's robot is replaced by a simulation: the result is that the method tolerates these errors and that the paper's explanation yields the reported tendency, not that they are the errors of the BioRob.".into(),
        "Observer at 20 1/s, velocities and positions through the state-variable filter at 40 rad/s: the paper does not specify how velocities were computed.".into(),
        "From run to run joint friction differs by 5 %, temperature by up to 1 K (which moves stiffness by 0.2 %/K and the motor's zero by 0.05 mrad/K); the tensioner brings the rope back to within 0.01 mm.".into(),
        "Relaxing the rope is physical: it acts on the spring and the joint sags. An offset added to the recording has no effect on the robot.".into(),
    ]
}
