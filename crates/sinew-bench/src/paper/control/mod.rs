//! What elongation does to control and to collision detection, before and after correcting for it.
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
use super::by_hand::ByHand;
use super::data::{FigureName, PaperFigure, given};
use super::trial::joint;
use cases::{DETECTOR_DEVIATION_RAD, ESTIMATE_RAD, OFFSET_RAD, STIFFNESS_ERROR};
use sinew_model::robot::Robot;

/// How much is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Sessions per row of the table.
    pub seeds: u64,
    /// Length of a session, s.
    pub seconds: f64,
}

impl Default for Effort {
    /// Six minutes per row: enough for some eighty contacts; a minute or two in all.
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
/// [`PaperError`] when the robot can't be simulated or hasn't the joints `shoulder_pitch` and
/// `elbow`, or the link `forearm`.
pub fn control(robot: &Robot, effort: Effort) -> Result<PaperFigure, PaperError> {
    let joints = stretched_joints(robot)?;
    let climbs = climb::climbs(robot, joints)?;
    let rows = cases::rows(robot, &effort)?;
    let figure = draw::figure(&climbs, &rows);
    let by_hand = joints.map(|joint| ByHand::new(robot, joint));
    let [shoulder, elbow] = by_hand;
    let (shoulder, elbow) = (shoulder?, elbow?);
    let stiffness = [shoulder.stiffness_nm_per_rad, elbow.stiffness_nm_per_rad];
    let mut sentences = sentences::climbing(&climbs, stiffness);
    let deflection_rad = shoulder.last_gravity_nm()? / shoulder.stiffness_nm_per_rad;
    sentences.extend(sentences::working(&rows, deflection_rad));
    Ok(PaperFigure {
        about: about(robot, &effort),
        panels: draw::panels(&climbs),
        sentences,
        tables: vec![page::full_table(&rows, effort.seeds)],
        given: given(&[
            "That elongation spoils position and torque is said in words. All numbers here are Sinew's.",
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
            "The ropes of shoulder pitch and elbow of the {} arm are {} mrad longer than its encoders know; the springs feel it. The paper names two things that this spoils: the position of the joint, because the controller sets the motor, and the torque the robot feels, because it is read from the springs. Sinew commands no robot. It gives the controller a motor set-point theta_set = q_d + x(tau_d) + delta_e and the corrected torque; the simulated controller here uses them.",
            robot.name,
            1e3 * OFFSET_RAD
        ),
        "First row: the paper's motion with dynamic set-points, without friction and with perfect sensors, so that closed forms hold. Left the joint's error, right the external torque of the momentum observer, with its threshold and a touch of 0.5 N from below at the end of the forearm (shaded): uncorrected it lifts the false torque out of the alarm.".into(),
        format!(
            "Second row and table: {} sessions of {} s each per row of the table, random poses, 13-bit joint encoders with once- and twice-per-turn errors, motor noise of 0.2 mrad, joint friction, contacts of 0.3 to 3 N at the end of the forearm in any direction for 15 % of the time. The same seeds in every row: the same motion, sensors and contacts. σ is the standard deviation over the sessions, other brackets are their lowest and highest.",
            effort.seeds, effort.seconds
        ),
    ]
}

fn assumptions() -> Vec<String> {
    vec![
        "The robot is BioRob-like, not the BioRob. The paper states that elongation spoils control and torque; it gives no figures for it, so the numbers here are the model's own.".into(),
        format!("An estimated offset is the true one plus a normal error of {} mrad, and the detector is told a standard deviation of {} mrad. sinew estimate --baseline reached 0.30 and 0.32 mrad in sixty simulated work sessions, with intervals on the wide side. An estimated stiffness is wrong by {} %.", 1e3 * ESTIMATE_RAD, 1e3 * DETECTOR_DEVIATION_RAD, 100.0 * STIFFNESS_ERROR),
        "Uncorrected, the detector has the same thresholds: it believes its ropes to be as they were. “Opened until it is quiet” multiplies them by the factor at which the uncorrected detector alarms no more than the corrected one.".into(),
        "Threshold: 4 standard deviations of offset, sensors (measured in a run without contacts) and what else the row says is unsure, plus the joint's Coulomb friction. A contact counts after 10 ms and ends below 70 % of the threshold.".into(),
        "A contact is missed when no alarm begins while it lasts (or 0.3 s after): an alarm that was on before has seen nothing. A false alarm is time with an alarm and no contact.".into(),
        "“At rest” is where the arm has been asked to stand for 0.7 s; positions count only 1 s after a contact. Payload is known (there is none): an unknown one looks like a contact.".into(),
        "Rows: “stretched” is a robot as described but for its ropes; the rows below it differ from the description as well, and are stretched too. K −20 %: the true stiffness is 20 % below the described one; M: the masses. Known “dynamic”: the true offset and the dynamic set-point; “estimate”: the offset as estimated; “+ stiffness”: with the stiffness; “+ tolerance”: the estimate, and the detector is told 10 % for stiffness and 5 % for masses.".into(),
        "The drive has no friction except where the row says so: a controller without integral part stops some milliradians short of its set-point because of it, stretched or not.".into(),
    ]
}
