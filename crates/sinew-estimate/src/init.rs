//! Initial robot.toml of a robot from a recording and a URDF.

use crate::robot_check::JointMotion;
use crate::robot_check::loads::loads;
use serde::Serialize;
use sinew_files::{Fault, JsonDocument, Located, names};
use sinew_log::{Ambiguity, FrameCounter, JointInfo, LogError, Quantity, Recording, SignalSource};
use sinew_model::arm::JointKind;
use sinew_model::arm::urdf::{self, UrdfOptions};
use sinew_model::transmission_map::{MappedTendon, Relation, TransmissionMap};
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Number of frames that determine the frame rate.
const FRAMES: u64 = 4096;

/// Initial description of a robot: values from the files, and values that the files do not contain.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Init {
    /// Recording or URDF from which the description was made.
    pub source: String,
    /// Name of the robot; `None` without a URDF.
    pub robot: Option<String>,
    /// URDF file in the folder of robot.toml, to which robot.toml refers.
    pub urdf: Option<String>,
    /// Joints in the order of the URDF, then joints that only the recording contains.
    pub joints: Vec<InitJoint>,
    /// Motors that pull the tendons.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub motors: Vec<InitMotor>,
    /// Tendons of a description of couplings, except those of one motor that turns one joint 1 to 1.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tendons: Vec<InitTendon>,
    /// Content of the recording; `None` without a recording.
    pub recording: Option<InitRecording>,
    /// Choice that a mapping file must make before the recording can be read.
    pub choice: Option<InitChoice>,
    /// Warnings about the URDF.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Options that the recording was read with, as every command needs them.
    pub options: Vec<String>,
    /// Values that an estimate requires and that are still missing.
    pub missing: Vec<InitGap>,
    /// Names of the files that were written.
    pub written: Vec<String>,
    /// Names of the written files that replaced existing ones.
    pub replaced: Vec<String>,
}

impl JsonDocument for Init {
    const SCHEMA: &'static str = "sinew/init/2";
}

/// Joint of an initial robot.toml. For a prismatic joint, values in rad are in m and values in N·m in N.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitJoint {
    /// Name of the joint.
    pub name: String,
    /// Content of robot.toml for the joint.
    pub plan: InitPlan,
    /// Content of the URDF for the joint.
    pub described: Option<InitDescribed>,
    /// Recorded quantities of the joint.
    pub recorded: Vec<Quantity>,
    /// Motor that drives the joint with a ratio of 1, by the description of couplings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motor: Option<String>,
}

/// Motor of an initial robot.toml.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitMotor {
    /// Name of the motor.
    pub name: String,
    /// Quantities that are recorded under this name.
    pub recorded: Vec<Quantity>,
}

/// Tendon of an initial robot.toml.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitTendon {
    /// Name of the tendon.
    pub name: String,
    /// Motors that drive the tendon; empty if the description names none.
    pub motors: Vec<String>,
    /// Joints that the tendon crosses.
    pub joints: Vec<String>,
    /// Relation of the motor and joint positions.
    #[serde(skip)]
    pub relation: Relation,
}

/// Transmission of a joint in robot.toml.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum InitPlan {
    /// Driven by a spring whose stiffness is still missing.
    Elastic,
    /// Driven by the tendons that cross the joint.
    Coupled,
    /// Rigid, because its motor position is not recorded and its spring is therefore not observable.
    Rigid,
    /// Locked at a position that is still missing, because the joint is not recorded.
    Locked,
    /// Excluded, because the joint is missing in the URDF.
    Excluded,
}

/// Content of a URDF for a joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitDescribed {
    /// Whether the joint is revolute or prismatic.
    pub motion: JointMotion,
    /// Axis of the joint in the frame of its parent link.
    pub axis: [f64; 3],
    /// Lower limit of the joint, rad; `None` for a continuous joint.
    pub lower_rad: Option<f64>,
    /// Upper limit of the joint, rad; `None` for a continuous joint.
    pub upper_rad: Option<f64>,
    /// Mass that the joint carries, kg.
    pub carried_mass_kg: f64,
    /// Whether the URDF specifies friction.
    pub friction_specified: bool,
    /// Stiffnesses at which the arm oscillates at 1 Hz and at 20 Hz, N·m/rad: the usual range of such springs.
    pub stiffness_usual_nm_per_rad: Option<[f64; 2]>,
}

/// Content of a recording that robot.toml requires.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitRecording {
    /// Frame rate at the start of the recording, Hz.
    pub rate_hz: Option<f64>,
    /// Source of each quantity.
    pub sources: Vec<SignalSource>,
}

/// Choice that is required before a recording can be read.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum InitChoice {
    /// Choice of one of several topics.
    Topic(Ambiguity),
    /// Assignment of the columns of a table.
    Columns(Vec<String>),
}

/// Value that an estimate requires and that is still missing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum InitGap {
    /// URDF, which the recording does not contain.
    Urdf,
    /// Motor positions, which the recording does not contain.
    MotorSide,
    /// Value of `stiffness_nm_per_rad` of a joint.
    Stiffness(String),
    /// Value of `locked_at_rad` of a joint.
    LockedAt(String),
    /// Stiffness of a tendon.
    TendonStiffness(String),
    /// Values of `drums_mm` of a tendon.
    Drums(String),
    /// Choice that the mapping file must make.
    Choice,
}

/// Reason why a recording cannot be inspected.
#[derive(Debug, thiserror::Error)]
pub enum InitError {
    /// Error of the recording.
    #[error(transparent)]
    Log(#[from] LogError),
    /// Error of the URDF.
    #[error(transparent)]
    Urdf(#[from] Located),
}

impl Init {
    /// Creates the description of a recording that requires a mapping file first.
    ///
    /// # Errors
    /// Returns `error` if it does not state a choice.
    pub fn undecided(source: &str, error: LogError) -> Result<Self, LogError> {
        let choice = match error {
            LogError::Ambiguous(choice) => InitChoice::Topic(choice),
            LogError::NotARecording { columns, .. } if columns.len() > 1 => {
                InitChoice::Columns(columns)
            }
            other => return Err(other),
        };
        Ok(Self {
            choice: Some(choice),
            missing: vec![InitGap::Choice],
            ..Self::empty(source)
        })
    }

    fn empty(source: &str) -> Self {
        Self {
            source: source.to_owned(),
            robot: None,
            urdf: None,
            joints: Vec::new(),
            motors: Vec::new(),
            tendons: Vec::new(),
            recording: None,
            choice: None,
            warnings: Vec::new(),
            options: Vec::new(),
            missing: Vec::new(),
            written: Vec::new(),
            replaced: Vec::new(),
        }
    }

    /// Creates a description from the text of a URDF and a recording, at least one of which is required. `urdf` is the
    /// name of
    /// the URDF beside robot.toml, and its text.
    ///
    /// # Errors
    /// [`InitError`].
    pub fn of(
        source: &str,
        urdf: Option<(&str, &str)>,
        mut recording: Option<&mut Recording>,
    ) -> Result<Self, InitError> {
        let mut out = Self::empty(source);
        if let Some((name, text)) = urdf {
            out.urdf = Some(name.to_owned());
            out.describe(name, text)?;
        }
        if let Some(recording) = recording.as_deref_mut() {
            let channels = &recording.channels().joints;
            let joints = recording.joints().iter().zip(channels);
            let joints: Vec<JointInfo> = joints
                .map(|(name, has)| JointInfo {
                    name: name.clone(),
                    channels: has.iter().collect(),
                })
                .collect();
            out.record(&joints);
            out.recording = Some(InitRecording {
                rate_hz: rate_hz(recording)?,
                sources: recording.sources(),
            });
        }
        out.missing = out.gaps(recording.is_some());
        Ok(out)
    }

    /// Creates the description from the text of a URDF and the joints that a network publishes. `urdf` is the file name of the
    /// URDF in the folder of robot.toml.
    ///
    /// # Errors
    /// Returns an error of the URDF.
    pub fn of_network(
        source: &str,
        urdf: Option<(&str, &str)>,
        joints: &[JointInfo],
        rate_hz: Option<f64>,
    ) -> Result<Self, Located> {
        let mut out = Self::empty(source);
        if let Some((name, text)) = urdf {
            out.urdf = Some(name.to_owned());
            out.describe(name, text)?;
        }
        out.record(joints);
        out.recording = Some(InitRecording {
            rate_hz,
            sources: Vec::new(),
        });
        out.missing = out.gaps(true);
        Ok(out)
    }

    /// Joints of a URDF.
    fn describe(&mut self, name: &str, text: &str) -> Result<(), Located> {
        let located = |error: urdf::UrdfError| error.located(name, text);
        let outline = urdf::outline(text).map_err(located)?;
        let parsed = urdf::parse(text, &UrdfOptions::default()).map_err(located)?;
        let loads = loads(&parsed.arm, &parsed.limits);
        self.robot = Some(parsed.name.clone());
        let warnings = parsed.warnings.iter();
        self.warnings = warnings.map(|text| format!("{name}: {text}")).collect();
        for (i, (joint, load)) in parsed.arm.joint_names().iter().zip(loads).enumerate() {
            let limits = &parsed.limits[i];
            let end = |v: f64| Some(v).filter(|v| v.is_finite());
            let swings = |hz: f64| load.inertia_kg_m2 * (TAU * hz) * (TAU * hz);
            let in_urdf = outline.joints.iter().find(|j| j.name == *joint);
            self.joints.push(InitJoint {
                name: joint.clone(),
                plan: InitPlan::Elastic,
                described: Some(InitDescribed {
                    motion: match parsed.arm.joint_kind(i) {
                        Some(JointKind::Prismatic) => JointMotion::Prismatic,
                        _ => JointMotion::Revolute,
                    },
                    axis: in_urdf.map_or([0.0; 3], |j| j.axis),
                    lower_rad: end(limits.lower),
                    upper_rad: end(limits.upper),
                    carried_mass_kg: parsed.arm.subtree_mass(i).unwrap_or(0.0),
                    friction_specified: parsed.coulomb_nm[i] > 0.0
                        || parsed.viscous_nm_s_per_rad[i] > 0.0,
                    stiffness_usual_nm_per_rad: (load.inertia_kg_m2 > 0.0)
                        .then(|| [swings(1.0), swings(20.0)]),
                }),
                recorded: Vec::new(),
                motor: None,
            });
        }
        Ok(())
    }

    /// Adds the recorded quantities of each joint.
    fn record(&mut self, joints: &[JointInfo]) {
        let no_urdf = self.joints.is_empty();
        for JointInfo { name, channels } in joints {
            let recorded: Vec<Quantity> = channels.clone();
            match self.joints.iter_mut().find(|joint| joint.name == *name) {
                Some(joint) => joint.recorded = recorded,
                None => self.joints.push(InitJoint {
                    name: name.clone(),
                    plan: match no_urdf {
                        true => InitPlan::Elastic,
                        false => InitPlan::Excluded,
                    },
                    described: None,
                    recorded,
                    motor: None,
                }),
            }
        }
        for joint in self.joints.iter_mut() {
            joint.plan = match (joint.plan, joint.recorded.as_slice()) {
                (InitPlan::Elastic, []) => InitPlan::Locked,
                (InitPlan::Elastic, has) if !has.contains(&Quantity::Theta) => InitPlan::Rigid,
                (plan, _) => plan,
            };
        }
        // Without any motor side nothing is known of single joints.
        if self.joints.iter().all(|j| j.plan != InitPlan::Elastic) {
            let rigid = self.joints.iter_mut();
            for joint in rigid.filter(|j| j.plan == InitPlan::Rigid) {
                joint.plan = InitPlan::Elastic;
            }
        }
    }

    /// Adds the couplings of a description. `file` is its name for messages.
    ///
    /// A row with one joint, the ratio 1 and no offset remains the spring of that joint, unless its name would be
    /// ambiguous. A joint that is missing in the recording remains locked.
    ///
    /// # Errors
    /// [`Fault::UnknownName`] for a joint that the URDF does not have; nothing is changed then.
    pub fn couple(&mut self, map: TransmissionMap, file: &str) -> Result<(), Located> {
        if self.urdf.is_some() {
            let described = self.joints.iter().filter(|j| j.described.is_some());
            let described: Vec<&str> = described.map(|j| j.name.as_str()).collect();
            for tendon in &map.tendons {
                let unknown = |(name, _): &&(String, f64)| !described.contains(&name.as_str());
                if let Some((joint, _)) = tendon.joints().iter().find(unknown) {
                    let hint = names::did_you_mean(joint, &described);
                    let problem =
                        format!("joint '{joint}' is not a moving joint of the URDF{hint}");
                    let located = Located::new(file, Fault::UnknownName, problem);
                    return Err(located
                        .line(tendon.line)
                        .element(format!("tendon '{}'", tendon.name))
                        .cure("name the URDF that has it, or remove its transmission"));
                }
            }
        }
        let (direct, coupled) = direct(map.tendons);
        let joints = coupled.iter().flat_map(MappedTendon::joints);
        let mut joints: BTreeSet<&str> = joints.map(|(name, _)| name.as_str()).collect();
        joints.extend(direct.iter().map(|(name, _)| name.as_str()));
        for name in coupled.iter().flat_map(MappedTendon::motors) {
            // Recorded under its own name, a motor is no joint.
            let is_motor = |j: &InitJoint| j.described.is_none() && !joints.contains(name);
            let place = self.joints.iter().position(|j| j.name == name);
            let recorded = match place {
                Some(at) if is_motor(&self.joints[at]) => self.joints.remove(at).recorded,
                Some(at) => self.joints[at].recorded.clone(),
                None => Vec::new(),
            };
            self.motors.push(InitMotor {
                name: name.to_owned(),
                recorded,
            });
        }
        let crossed = coupled.iter().flat_map(MappedTendon::joints);
        let driven = direct.iter().map(|(joint, _)| (joint, InitPlan::Elastic));
        let crossed = crossed.map(|(joint, _)| (joint, InitPlan::Coupled));
        for (name, plan) in driven.chain(crossed) {
            match self.joints.iter_mut().find(|j| j.name == *name) {
                Some(joint) if direct.iter().any(|(own, _)| own == name) => {
                    joint.plan = match joint.plan {
                        InitPlan::Rigid => InitPlan::Elastic,
                        plan => plan,
                    };
                }
                Some(joint) if joint.plan != InitPlan::Locked => joint.plan = plan,
                Some(_) => {}
                None => self.joints.push(InitJoint {
                    name: name.clone(),
                    plan,
                    described: None,
                    recorded: Vec::new(),
                    motor: None,
                }),
            }
        }
        for (name, motor) in direct {
            let mut joints = self.joints.iter_mut();
            if let Some(joint) = joints.find(|j| j.name == name) {
                joint.motor = Some(motor);
            }
        }
        self.tendons = coupled
            .into_iter()
            .map(|tendon| InitTendon {
                motors: tendon.motors().into_iter().map(str::to_owned).collect(),
                joints: tendon.joints().iter().map(|(j, _)| j.clone()).collect(),
                name: tendon.name,
                relation: tendon.relation,
            })
            .collect();
        self.missing = self.gaps(self.recording.is_some());
        Ok(())
    }

    fn gaps(&self, recorded: bool) -> Vec<InitGap> {
        let has_motor = |recorded: &Vec<Quantity>| recorded.contains(&Quantity::Theta);
        let mut out = Vec::new();
        if self.urdf.is_none() {
            out.push(InitGap::Urdf);
        }
        let joints = self.joints.iter().map(|j| &j.recorded);
        let mut sources = joints.chain(self.motors.iter().map(|m| &m.recorded));
        if recorded && !sources.any(has_motor) {
            out.push(InitGap::MotorSide);
        }
        out.extend(self.joints.iter().filter_map(|joint| match joint.plan {
            InitPlan::Elastic => Some(InitGap::Stiffness(joint.name.clone())),
            InitPlan::Locked => Some(InitGap::LockedAt(joint.name.clone())),
            InitPlan::Coupled | InitPlan::Rigid | InitPlan::Excluded => None,
        }));
        for tendon in &self.tendons {
            if matches!(tendon.relation, Relation::MomentArms { .. }) {
                out.push(InitGap::Drums(tendon.name.clone()));
            }
            out.push(InitGap::TendonStiffness(tendon.name.clone()));
        }
        out
    }
}

/// Separates the rows that remain the spring of one joint, as joint and motor, from the other tendons.
///
/// Such a spring has a motor and a tendon of the joint's name, so that no other may have it.
fn direct(tendons: Vec<MappedTendon>) -> (Vec<(String, String)>, Vec<MappedTendon>) {
    let own = |tendon: &MappedTendon| match &tendon.relation {
        Relation::Ratios {
            motor,
            ratios,
            motor_at_zero_rad: 0.0,
        } => match &ratios[..] {
            [(joint, 1.0)] => Some((joint.clone(), motor.clone())),
            _ => None,
        },
        _ => None,
    };
    let is_taken = |at: usize, joint: &str| {
        let others = tendons.iter().enumerate().filter(|(i, _)| *i != at);
        others.into_iter().any(|(_, t)| {
            t.name == joint
                || t.motors().contains(&joint)
                || own(t).is_some_and(|(j, _)| j == joint)
        })
    };
    let is_direct: Vec<bool> = tendons
        .iter()
        .enumerate()
        .map(|(at, t)| own(t).is_some_and(|(joint, _)| !is_taken(at, &joint)))
        .collect();
    let (mut direct, mut coupled) = (Vec::new(), Vec::new());
    for (tendon, is_direct) in tendons.into_iter().zip(is_direct) {
        match own(&tendon).filter(|_| is_direct) {
            Some(pair) => direct.push(pair),
            None => coupled.push(tendon),
        }
    }
    (direct, coupled)
}

/// Frames per second at the start of a recording.
fn rate_hz(recording: &mut Recording) -> Result<Option<f64>, LogError> {
    let mut counter = FrameCounter::default();
    while counter.frames() < FRAMES {
        let Some(frame) = recording.next_frame()? else {
            break;
        };
        let (time_ns, segment) = (frame.time_ns, frame.segment);
        counter.frame(time_ns, segment);
    }
    Ok(counter.rate_hz())
}
