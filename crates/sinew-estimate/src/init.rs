//! What a recording and a URDF say of a robot, for a first robot.toml.

use crate::robot_check::JointMotion;
use crate::robot_check::loads::loads;
use serde::Serialize;
use sinew_files::{Fault, JsonDocument, Located, names};
use sinew_log::{Ambiguity, JointInfo, LogError, Pace, Quantity, Recording, SignalSource};
use sinew_model::arm::JointKind;
use sinew_model::arm::urdf::{self, UrdfOptions};
use sinew_model::transmission_map::{MappedTendon, Relation, TransmissionMap};
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Frames read for the rate.
const FRAMES: u64 = 4096;

/// A first description of a robot: what the files say, and what they can't.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Init {
    /// The recording or URDF it was made from.
    pub source: String,
    /// Name of the robot; none without a URDF.
    pub robot: Option<String>,
    /// The URDF that robot.toml names, beside it.
    pub urdf: Option<String>,
    /// Its joints in Sinew's order, then those that only the recording has.
    pub joints: Vec<InitJoint>,
    /// Motors that pull the tendons.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub motors: Vec<InitMotor>,
    /// Tendons of a description of couplings, except those of one motor that turns one joint 1 to 1.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tendons: Vec<InitTendon>,
    /// What the recording holds, where there is one.
    pub recording: Option<InitRecording>,
    /// What a mapping file must choose before the recording can be read.
    pub choice: Option<InitChoice>,
    /// Options that the recording was read with, as every command needs them.
    pub options: Vec<String>,
    /// What an estimate still needs.
    pub missing: Vec<InitGap>,
    /// Files written.
    pub written: Vec<String>,
    /// Those of them that were there before.
    pub replaced: Vec<String>,
}

impl JsonDocument for Init {
    const SCHEMA: &'static str = "sinew/init/1";
}

/// A joint of a first robot.toml. Of a prismatic one, rad is m and N·m is N.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitJoint {
    /// Its name.
    pub name: String,
    /// What robot.toml says of it.
    pub plan: InitPlan,
    /// What the URDF says of it.
    pub described: Option<InitDescribed>,
    /// What is recorded of it.
    pub recorded: Vec<Quantity>,
    /// Motor that turns it 1 to 1, by the description of couplings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motor: Option<String>,
}

/// A motor of a first robot.toml.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitMotor {
    /// Name of the motor.
    pub name: String,
    /// Quantities that are recorded under this name.
    pub recorded: Vec<Quantity>,
}

/// A tendon of a first robot.toml.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitTendon {
    /// Name of the tendon.
    pub name: String,
    /// Motors that pull it; empty where the description names none.
    pub motors: Vec<String>,
    /// Joints that it crosses.
    pub joints: Vec<String>,
    /// Relation of their positions.
    #[serde(skip)]
    pub relation: Relation,
}

/// How robot.toml has a joint driven.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum InitPlan {
    /// By a spring whose stiffness is still to be filled in.
    Elastic,
    /// By the tendons that cross it.
    Coupled,
    /// Rigid: no motor position of it is recorded, so that a spring would not show.
    Rigid,
    /// Locked where it stood, still to be filled in: it is not recorded.
    Locked,
    /// Left out: the URDF hasn't got it.
    LeftOut,
}

/// What a URDF says of a joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitDescribed {
    /// Whether it turns or slides.
    pub motion: JointMotion,
    /// Its axis in the link it hangs on.
    pub axis: [f64; 3],
    /// Lower end of its range, rad; none where it turns without end.
    pub lower_rad: Option<f64>,
    /// Upper end of its range, rad; none where it turns without end.
    pub upper_rad: Option<f64>,
    /// Mass it carries, kg.
    pub carried_kg: f64,
    /// Whether the URDF states friction.
    pub friction_stated: bool,
    /// Stiffness at which the arm swings at 1 Hz and at 20 Hz, N·m/rad: where such springs lie.
    pub stiffness_usual_nm_per_rad: Option<[f64; 2]>,
}

/// What a recording holds, as far as robot.toml needs it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InitRecording {
    /// Frames per second at its start.
    pub rate_hz: Option<f64>,
    /// Where each quantity is read from.
    pub sources: Vec<SignalSource>,
}

/// What must be chosen before a recording can be read.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum InitChoice {
    /// One of several topics.
    Topic(Ambiguity),
    /// Which of a table's columns is what.
    Columns(Vec<String>),
}

/// What an estimate still needs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum InitGap {
    /// A URDF: the recording holds none.
    Urdf,
    /// A motor side: the recording holds none.
    MotorSide,
    /// `stiffness_nm_per_rad` of a joint.
    Stiffness(String),
    /// `locked_at_rad` of a joint.
    LockedAt(String),
    /// Stiffness of a tendon.
    TendonStiffness(String),
    /// `drums_mm` of a tendon.
    Drums(String),
    /// A choice in the mapping file.
    Choice,
}

/// Why a recording could not be looked into: a choice to make, or a refusal.
#[derive(Debug, thiserror::Error)]
pub enum InitError {
    /// The recording.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The URDF.
    #[error(transparent)]
    Urdf(#[from] Located),
}

impl Init {
    /// Of a recording that needs a mapping first; gives any other error back.
    ///
    /// # Errors
    /// What is no choice.
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
            options: Vec::new(),
            missing: Vec::new(),
            written: Vec::new(),
            replaced: Vec::new(),
        }
    }

    /// Of a URDF's text and a recording, of which at least one should be there. `urdf` is the name of
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

    /// Of a URDF's text and of joints that are heard on a network. `urdf` is the name it will have beside robot.toml.
    ///
    /// # Errors
    /// The URDF's.
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
        let refused = |error: urdf::UrdfError| error.located(name, text);
        let outline = urdf::outline(text).map_err(refused)?;
        let parsed = urdf::parse(text, &UrdfOptions::default()).map_err(refused)?;
        let loads = loads(&parsed.arm, &parsed.limits);
        self.robot = Some(parsed.name.clone());
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
                    carried_kg: parsed.arm.subtree_mass(i).unwrap_or(0.0),
                    friction_stated: parsed.coulomb_nm[i] > 0.0
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

    /// Joins what is recorded of each joint.
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
                        false => InitPlan::LeftOut,
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
    /// A row of one joint with the ratio 1 and no offset stays the joint's own spring, unless its name would be
    /// ambiguous. A joint that a recording lacks stays locked.
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
            InitPlan::Coupled | InitPlan::Rigid | InitPlan::LeftOut => None,
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

/// Joint and motor of the rows that stay a joint's own spring, and the other tendons.
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
    let mut pace = Pace::default();
    while pace.frames() < FRAMES {
        let Some(frame) = recording.next_frame()? else {
            break;
        };
        let (time_ns, segment) = (frame.time_ns, frame.segment);
        pace.frame(time_ns, segment);
    }
    Ok(pace.rate_hz())
}
