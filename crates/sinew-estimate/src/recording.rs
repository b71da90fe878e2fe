//! Opening of a recording together with its robot.

use crate::error::EstimateError;
use crate::one_signal::OneSignal;
use crate::request::{Progress, Request};
use crate::robot_dir;
use crate::robot_dir::LoadedRobot;
use crate::thermal;
use crate::warning::RecordingWarning;
use sinew_files::names::nearest;
use sinew_log::{Axis, Channels, Frame, Quantity, Recording};
use sinew_model::robot::Robot;
use sinew_model::transmission::Transmission;
use std::fmt::Write as _;
use std::ops::ControlFlow;

/// Recording and its robot, with the joints of the frames in the robot's order.
pub(crate) struct Opened {
    pub(crate) recording: Recording,
    pub(crate) loaded: LoadedRobot,
    pub(crate) warnings: Vec<RecordingWarning>,
    /// Joints with a tendon of which only the motor position is recorded. The motor position replaces the joint
    /// position, and the joint is treated as rigid.
    pub(crate) without_encoder: Vec<usize>,
}

impl Opened {
    /// Opens the recording and the robot of a request.
    pub(crate) fn new(request: &Request) -> Result<Self, EstimateError> {
        let given = &request.given;
        let mut recording = given.open(&request.log, &request.open)?;
        let mut loaded = match (&given.robot, &request.robot) {
            (Some(robot), _) => LoadedRobot::clone(robot),
            (None, Some(place)) => robot_dir::load(place, recording.robot_description())?,
            (None, None) => {
                let place = robot_dir::find(&request.log)?;
                robot_dir::load(&place, recording.robot_description())?
            }
        };
        thermal::look_up(&mut loaded.robot, &loaded.file)?;
        let texts = loaded.robot.warnings.iter().cloned();
        let mut warnings: Vec<_> = texts.map(|text| RecordingWarning::Robot { text }).collect();
        let names = loaded.robot.joint_names();
        let motors = loaded.robot.motor_names();
        let unknown = match_joints(&request.name(), (names, &motors), &recording)?;
        if !unknown.is_empty() {
            warnings.push(RecordingWarning::UnknownJoints { joints: unknown });
        }
        let pulling: Vec<&str> = (0..loaded.robot.axes())
            .filter_map(|axis| loaded.robot.pulling_tendon(axis))
            .collect();
        let unused = recording.tendons().iter();
        let unused = unused.filter(|name| !pulling.contains(&name.as_str()));
        let tendons: Vec<String> = unused.cloned().collect();
        if !tendons.is_empty() {
            warnings.push(RecordingWarning::UnusedTensions { tendons });
        }
        check_motors(request, &loaded)?;
        check_injections(request, &loaded)?;
        check_touches(request, &loaded)?;
        recording.select_axes(&axes(&loaded.robot))?;
        // A position under an unknown name may belong to a joint without a position.
        let has_strangers = warnings
            .iter()
            .any(|warning| matches!(warning, RecordingWarning::UnknownJoints { .. }));
        let without_encoder = match has_strangers {
            true => Vec::new(),
            false => without_encoder(&request.name(), &loaded, recording.channels())?,
        };
        for joint in &without_encoder {
            loaded.robot.transmissions[*joint] = None;
        }
        Ok(Self {
            recording,
            loaded,
            warnings,
            without_encoder,
        })
    }

    /// Passes every frame to `take` until it breaks; frames are read ahead on another thread. `progress` is called
    /// every 8192 frames. Returns an error if motor and joint side are the same signal.
    pub(crate) fn each_frame(
        &mut self,
        is_reference: bool,
        progress: &mut dyn FnMut(Progress),
        mut take: impl FnMut(&Frame) -> Result<ControlFlow<()>, EstimateError>,
    ) -> Result<(), EstimateError> {
        let mut frames = 0u64;
        let mut one_signal = OneSignal::new(&self.loaded.robot);
        let mut completed = Frame::default();
        let stopped = self.recording.each_frame(|frame, at| {
            frames += 1;
            let frame = match self.without_encoder.is_empty() {
                true => frame,
                false => {
                    completed.clone_from(frame);
                    for joint in &self.without_encoder {
                        completed.q[*joint] = completed.theta[*joint];
                    }
                    &completed
                }
            };
            one_signal.frame(frame);
            if frames.is_multiple_of(8192) {
                progress(Progress {
                    bytes_done: at.bytes_done,
                    bytes_total: at.bytes_total,
                    frames,
                    reference: is_reference,
                });
            }
            match take(frame) {
                Ok(ControlFlow::Continue(())) => ControlFlow::Continue(()),
                Ok(ControlFlow::Break(())) => ControlFlow::Break(Ok(())),
                Err(error) => ControlFlow::Break(Err(error)),
            }
        });
        stopped?.unwrap_or(Ok(()))?;
        one_signal.check(&self.loaded.robot, self.recording.name())
    }
}

/// Returns the axes of the frames for the estimate of a robot: its joints, then the remaining tendons.
pub fn axes(robot: &Robot) -> Vec<Axis<'_>> {
    let motors = robot.motors_at_shaft().into_iter().enumerate();
    let axes = motors.map(|(i, motor)| Axis {
        joint: robot.joint_names().get(i).map(String::as_str),
        motor: motor.filter(|_| !robot.shares_motor(i)),
        tendon: robot.pulling_tendon(i),
    });
    axes.collect()
}

/// Returns the joints with a separate tendon whose motor position is recorded but whose joint position is not.
///
/// # Errors
/// Returns [`EstimateError::Mismatch`] if no other joint with a tendon remains: the elongation of a tendon is not
/// observable from motor positions alone.
fn without_encoder(
    file: &str,
    loaded: &LoadedRobot,
    channels: &Channels,
) -> Result<Vec<usize>, EstimateError> {
    let tendons = loaded.robot.transmissions.iter().zip(&channels.joints);
    let tendons = tendons.enumerate().filter(|(_, (t, _))| t.is_some());
    let has_own = |t: &Option<Transmission>| t.as_ref().is_some_and(|t| t.routing.is_none());
    let (without, with): (Vec<_>, Vec<_>) =
        tendons.partition(|(_, (t, channel))| has_own(t) && !channel.q && channel.theta);
    if with.is_empty() && !without.is_empty() {
        return Err(EstimateError::Mismatch {
            file: file.into(),
            reason: "contains motor positions but no joint position; an elongation is the difference of both, so it is not observable from motor positions alone; record the joint encoders, or map their names in a mapping file (--mapping)".into(),
        });
    }
    Ok(without.into_iter().map(|(joint, _)| joint).collect())
}

/// Checks that every moving joint has a position; returns the names of unknown joints of the recording.
fn match_joints(
    file: &str,
    (names, motors): (&[String], &[String]),
    recording: &Recording,
) -> Result<Vec<String>, EstimateError> {
    let recorded = recording.joints();
    let missing: Vec<&str> = names
        .iter()
        .filter(|n| !recorded.contains(n))
        .map(String::as_str)
        .collect();
    if !missing.is_empty() {
        return Err(EstimateError::Mismatch {
            file: file.into(),
            reason: format!(
                "position of joint {} is missing; recorded: {}{}; map its name in a mapping file (--mapping), or fix the joint with locked_at_rad in robot.toml",
                quoted(&missing),
                quoted(&recorded.iter().map(String::as_str).collect::<Vec<_>>()),
                sources(recording),
            ),
        });
    }
    let unknown = recorded
        .iter()
        .filter(|name| !names.contains(name) && !motors.contains(name));
    Ok(unknown.cloned().collect())
}

/// Lists the topics or columns from which positions are read.
fn sources(recording: &Recording) -> String {
    let positions = [Quantity::Q, Quantity::Theta];
    let all = recording.sources().into_iter();
    let of_positions = all.filter(|s| positions.contains(&s.quantity));
    let texts = of_positions.map(|s| format!("{} from {}", s.quantity.symbol(), s.source));
    match Vec::from_iter(texts).join(", ") {
        none if none.is_empty() => none,
        list => format!(" ({list})"),
    }
}

/// Checks that the motor position of a tendon across several joints is that of its encoder: a sum would subtract the
/// motion of the other joints twice.
fn check_motors(request: &Request, loaded: &LoadedRobot) -> Result<(), EstimateError> {
    let Some(mapping) = &request.open.mapping else {
        return Ok(());
    };
    let coupled = loaded.robot.transmissions.iter().enumerate();
    let coupled = coupled.filter_map(|(i, t)| Some((i, t.as_ref()?.routing.as_ref()?)));
    for (joint, routing) in coupled {
        let others = routing.moment_arms.iter().enumerate();
        let crosses_others = others.clone().any(|(j, arm)| j != joint && *arm != 0.0);
        if crosses_others && mapping.sums(&routing.motor, Quantity::Theta) {
            return Err(EstimateError::Mismatch {
                file: mapping.file().into(),
                reason: format!(
                    "the position of motor '{}' is a sum, and robot.toml describes the joints that its tendon '{}' crosses: their motion would be subtracted twice; map the column of the motor alone",
                    routing.motor, routing.tendon
                ),
            });
        }
    }
    Ok(())
}

fn check_injections(request: &Request, loaded: &LoadedRobot) -> Result<(), EstimateError> {
    for injection in &request.injections {
        let place = loaded.robot.tendon_index(&injection.joint);
        let Some(i) = place else {
            return Err(EstimateError::Injection(no_joint(&injection.joint, loaded)));
        };
        if loaded.robot.transmissions[i].is_none() && loaded.robot.cable(i).is_none() {
            return Err(EstimateError::Injection(format!(
                "joint '{}' is rigid",
                injection.joint
            )));
        }
        if !injection.offset_rad.is_finite() || injection.from_s.is_some_and(|t| !t.is_finite()) {
            return Err(EstimateError::Injection(format!(
                "offset {} rad at '{}' must be a finite number",
                injection.offset_rad, injection.joint
            )));
        }
    }
    Ok(())
}

/// Checks that the specified index marks are marks of robot.toml.
fn check_touches(request: &Request, loaded: &LoadedRobot) -> Result<(), EstimateError> {
    for touch in &request.touches {
        let Some(i) = loaded.robot.tendon_index(&touch.joint) else {
            return Err(EstimateError::Touch(no_joint(&touch.joint, loaded)));
        };
        let anchors = loaded.robot.transmissions[i]
            .iter()
            .flat_map(|t| &t.anchors);
        if !anchors.clone().any(|a| a.kind.is_mark()) {
            return Err(EstimateError::Touch(format!(
                "{} specifies no index mark of joint '{}'; add [[joints.{}.anchors]] with kind = \"joint-mark\" or \"motor-mark\", position_rad and std_rad",
                loaded.file.display(),
                touch.joint,
                touch.joint
            )));
        }
        if !touch.time_s.is_finite() {
            return Err(EstimateError::Touch(format!(
                "the time of the mark of '{}', {} s, must be a finite number",
                touch.joint, touch.time_s
            )));
        }
    }
    Ok(())
}

fn no_joint(joint: &str, loaded: &LoadedRobot) -> String {
    let names = loaded.robot.tendon_names();
    let hint = nearest(joint, &names);
    let hint = hint.map_or(String::new(), |name| format!("; did you mean '{name}'?"));
    let of = if loaded.robot.coupling.is_some() {
        "tendon"
    } else {
        "joint"
    };
    format!(
        "{of} '{joint}' not found in the robot; available: {}{hint}",
        names.join(", ")
    )
}

fn quoted(names: &[&str]) -> String {
    const MAX_NAMES: usize = 12;
    let mut text = names
        .iter()
        .take(MAX_NAMES)
        .map(|n| format!("'{n}'"))
        .collect::<Vec<_>>()
        .join(", ");
    if names.len() > MAX_NAMES {
        let _ = write!(text, " and {} more", names.len() - MAX_NAMES);
    }
    if names.is_empty() {
        text.push_str("none");
    }
    text
}
