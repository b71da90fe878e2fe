//! Effect of elongation on control and collision detection, before and after correction.
//!
//! Reading order: `row` (a row of the table), `cases` (robots, sessions), `climb` (the paper's motion, closed
//! forms), `sentences`, `draw`, `page`.

mod cases;
mod climb;
mod draw;
mod page;
mod sentences;

pub use super::row::{Knowledge, RobotCase, Row};
pub(super) use page::csv;
pub use page::table;

use super::PaperError;
use super::analytic::Analytic;
use super::data::{FigureName, PaperFigure, given};
use super::sentence::{Basis, Sentence};
use super::trial::joint;
use cases::{DETECTOR_DEVIATION_RAD, ESTIMATE_RAD, OFFSET_RAD, STIFFNESS_ERROR};
use sinew_model::robot::Robot;

/// Amount of simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Sessions per row of the table.
    pub seeds: u64,
    /// Length of a session, s.
    pub seconds: f64,
}

impl Default for Effort {
    /// Six minutes per row, which contain about eighty contacts; the computation takes one to two minutes in total.
    fn default() -> Self {
        Self {
            seeds: 6,
            seconds: 60.0,
        }
    }
}

/// Runs the arm with stretched ropes, uncorrected and corrected.
///
/// # Errors
/// Returns a [`PaperError`] if the robot cannot be simulated or lacks the joints `shoulder_pitch` and
/// `elbow`, or the link `forearm`.
pub fn control(robot: &Robot, effort: Effort) -> Result<PaperFigure, PaperError> {
    let joints = stretched_joints(robot)?;
    let climbs = climb::climbs(robot, joints)?;
    let rows = cases::rows(robot, &effort)?;
    let figure = draw::figure(&climbs, &rows);
    let analytic = joints.map(|joint| Analytic::new(robot, joint));
    let [shoulder, elbow] = analytic;
    let (shoulder, elbow) = (shoulder?, elbow?);
    let stiffness = [shoulder.stiffness_nm_per_rad, elbow.stiffness_nm_per_rad];
    let mut sentences = sentences::climbing(&climbs, stiffness);
    let deflection_rad = shoulder.last_gravity_nm()? / shoulder.stiffness_nm_per_rad;
    let working = sentences::working(&rows, deflection_rad).into_iter();
    sentences.extend(working.map(|s| s.based_on(Basis::NoisySimulation)));
    Ok(PaperFigure {
        about: about(robot, &effort),
        panels: draw::panels(&climbs),
        sentences,
        tables: vec![page::full_table(&rows, effort.seeds)],
        given: given(&[
            "The paper describes the effect of elongation on position and torque without numbers. All numbers here are Sinew's.",
        ]),
        assumptions: assumptions(),
        rows,
        ..PaperFigure::new(
            FigureName::Control,
            "Control and collision detection with stretched ropes, before and after correction",
            figure,
        )
    })
}

/// Assesses the paper's two statements on errors due to elongation, which [`control()`] contains too.
///
/// # Errors
/// Returns the errors of [`control()`].
pub fn elongation_errors(robot: &Robot) -> Result<[Sentence; 2], PaperError> {
    let joints = stretched_joints(robot)?;
    let [_, blind, _] = climb::climbs(robot, joints)?;
    let [shoulder, elbow] = joints.map(|joint| Analytic::new(robot, joint));
    let stiffness = [shoulder?.stiffness_nm_per_rad, elbow?.stiffness_nm_per_rad];
    Ok(sentences::elongation_errors(&blind, stiffness))
}

/// Indices of the two joints with stretched ropes.
fn stretched_joints(robot: &Robot) -> Result<[usize; 2], PaperError> {
    Ok([
        joint(robot, "shoulder_pitch", "control")?,
        joint(robot, "elbow", "control")?,
    ])
}

fn about(robot: &Robot, effort: &Effort) -> Vec<String> {
    vec![
        format!(
            "The ropes of shoulder pitch and elbow of the {} arm are {} mrad longer than its encoders indicate; the elongation acts on the springs. The paper names two effects: an error of the joint position, because the controller sets the motor position, and an error of the sensed torque, because it is derived from the springs. Sinew commands no robot. It gives the controller a motor set-point theta_set = q_d + x(tau_d) + delta_e and the corrected torque; the simulated controller here uses them.",
            robot.name,
            1e3 * OFFSET_RAD
        ),
        "First row: the paper's motion with dynamic set-points, without friction and with perfect sensors, so that closed forms apply. Left: the joint's error. Right: the external torque of the momentum observer, with its threshold and a contact of 0.5 N from below at the end of the forearm (shaded). Without correction the contact cancels the false torque, and the alarm ends.".into(),
        format!(
            "Second row and table: {} sessions of {} s each per row of the table, random poses, 13-bit joint encoders with errors of one and two periods per revolution, motor noise of 0.2 mrad, joint friction, contacts of 0.3 to 3 N at the end of the forearm in any direction for 15 % of the time. All rows have the same seeds and thus the same motion, sensors and contacts. σ is the standard deviation over the sessions, other brackets are their lowest and highest.",
            effort.seeds, effort.seconds
        ),
    ]
}

fn assumptions() -> Vec<String> {
    vec![
        "The robot is BioRob-like, not the BioRob. The paper states that elongation affects control and torque; it gives no numbers, so that the numbers here are those of the model.".into(),
        format!("An estimated offset is the true one plus a normally distributed error of {} mrad, and the detector assumes a standard deviation of {} mrad. sinew estimate --baseline reached 0.30 and 0.32 mrad in sixty simulated work sessions, with conservative intervals. An estimated stiffness has an error of {} %.", 1e3 * ESTIMATE_RAD, 1e3 * DETECTOR_DEVIATION_RAD, 100.0 * STIFFNESS_ERROR),
        "Without correction, the detector has the same thresholds, because it assumes nominal ropes. “Raised until there are no false alarms” multiplies them by the factor at which the uncorrected detector has no more false alarms than the corrected one.".into(),
        "Threshold: 4 standard deviations of offset, sensors (measured in a run without contacts) and the other uncertainties of the row, plus the joint's Coulomb friction. A contact counts after 10 ms and ends below 70 % of the threshold.".into(),
        "A contact is missed if no alarm begins during it (or up to 0.3 s after); an earlier alarm does not count as a detection. False alarm is the time with an alarm and no contact.".into(),
        "“At rest” begins 0.7 s after the commanded motion has ended; positions count only 1 s after a contact. There is no payload: an unknown payload has the effect of a contact.".into(),
        "Rows: “stretched” is a robot as described except for its ropes; the rows below it also differ from the description. K −20 %: the true stiffness is 20 % below the described one; M: the masses. Correction “dynamic”: the true offset and the dynamic set-point; “estimate”: the estimated offset; “+ stiffness”: with the estimated stiffness; “+ tolerance”: the estimate, with tolerances of 10 % for stiffness and 5 % for masses in the detector.".into(),
        "The drive has friction only in the row “friction”. Friction makes a controller without integral part stop some milliradians short of its set-point, with or without elongation.".into(),
    ]
}
