//! A recording and its robot, opened together.

use crate::error::EstimateError;
use crate::one_signal::OneSignal;
use crate::request::{Progress, Request};
use crate::robot_dir;
use crate::robot_dir::LoadedRobot;
use crate::warmth;
use crate::warning::RecordingWarning;
use sinew_files::names::nearest;
use sinew_log::{Channels, Frame, Quantity, Recording};
use sinew_model::transmission::Transmission;
use std::fmt::Write as _;
use std::ops::ControlFlow;

/// A recording and its robot, whose joints are those of the frames.
pub(crate) struct Opened {
    pub(crate) recording: Recording,
    pub(crate) loaded: LoadedRobot,
    pub(crate) warnings: Vec<RecordingWarning>,
    /// Joints with a tendon of which the recording holds the motor's position alone: it stands in for the joint's, and the
    /// joint is taken as rigid.
    pub(crate) without_encoder: Vec<usize>,
}

impl Opened {
    /// Opens what a request names.
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
        warmth::look_up(&mut loaded.robot, &loaded.file)?;
        let words = loaded.robot.warnings.iter().cloned();
        let mut warnings: Vec<_> = words.map(|text| RecordingWarning::Robot { text }).collect();
        let names = loaded.robot.joint_names();
        let motors = loaded.robot.motor_names();
        let unknown = match_joints(&request.name(), (names, &motors), &recording)?;
        if !unknown.is_empty() {
            warnings.push(RecordingWarning::UnknownJoints { joints: unknown });
        }
        check_motors(request, &loaded)?;
        check_injections(request, &loaded)?;
        check_touches(request, &loaded)?;
        fn all(names: &[String]) -> Vec<&str> {
            names.iter().map(String::as_str).collect()
        }
        recording.select_driven(&all(names), &loaded.robot.motors_at_shaft())?;
        // A position under a name that the robot does not have may be that of the joint.
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

    /// Hands every frame to `take` until it breaks, read ahead on another thread. `progress` is called
    /// every few thousand frames. A recording whose two sides are one signal is refused.
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
        one_signal.judge(&self.loaded.robot, self.recording.name())
    }
}

/// Joints with a tendon of their own whose position is not recorded, though that of their motor is.
///
/// # Errors
/// There is no other joint with a tendon: a motor's position alone does not show how long its tendon is.
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
            why: "holds motor positions and no joint position. An elongation is what motor and joint differ by, so motor positions alone do not show it. Record the joints' encoders. Name them in a mapping file (--mapping) if they have other names".into(),
        });
    }
    Ok(without.into_iter().map(|(joint, _)| joint).collect())
}

/// Every moving joint needs a position; others of the recording are left alone: their names.
fn match_joints(
    file: &str,
    (names, motors): (&[String], &[String]),
    recording: &Recording,
) -> Result<Vec<String>, EstimateError> {
    let known = recording.joints();
    let missing: Vec<&str> = names
        .iter()
        .filter(|n| !known.contains(n))
        .map(String::as_str)
        .collect();
    if !missing.is_empty() {
        return Err(EstimateError::Mismatch {
            file: file.into(),
            why: format!(
                "has no position of joint {}, which the robot has; it has {}{}. Name it in a mapping file (--mapping), or hold it with locked_at_rad in robot.toml",
                quoted(&missing),
                quoted(&known.iter().map(String::as_str).collect::<Vec<_>>()),
                sources(recording),
            ),
        });
    }
    let unknown = known
        .iter()
        .filter(|k| !names.contains(k) && !motors.contains(k));
    Ok(unknown.cloned().collect())
}

/// Which topics or columns positions were looked for in.
fn sources(recording: &Recording) -> String {
    let positions = [Quantity::Q, Quantity::Theta];
    let all = recording.sources().into_iter();
    let own = all.filter(|s| positions.contains(&s.quantity));
    let told = own.map(|s| format!("{} from {}", s.quantity.symbol(), s.source));
    match Vec::from_iter(told).join(", ") {
        none if none.is_empty() => none,
        told => format!(" ({told})"),
    }
}

/// A motor of a tendon that crosses several joints is read as its encoder measures it: a sum would take out the other joints twice.
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
                why: format!(
                    "makes the position of motor '{}' a sum, and robot.toml describes the joints that its tendon '{}' crosses: they would be taken out twice. Name the column of the motor alone",
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
        if loaded.robot.transmissions[i].is_none() {
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

/// Marks that are said to be passed are marks of robot.toml.
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
                "{} states no mark of joint '{}'; write one as [[joints.{}.anchors]] with kind = \"joint-mark\" or \"motor-mark\", position_rad and deviation_rad",
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
        "the robot has no {of} '{joint}'; it has {}{hint}",
        names.join(", ")
    )
}

fn quoted(names: &[&str]) -> String {
    const SHOWN: usize = 12;
    let mut text = names
        .iter()
        .take(SHOWN)
        .map(|n| format!("'{n}'"))
        .collect::<Vec<_>>()
        .join(", ");
    if names.len() > SHOWN {
        let _ = write!(text, " and {} more", names.len() - SHOWN);
    }
    if names.is_empty() {
        text.push_str("none");
    }
    text
}
