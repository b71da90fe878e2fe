//! Roles of the topics: by a specified name, otherwise the usual one, otherwise the only one.

use super::names::Names;
use super::survey::{Survey, Topic};
use crate::decode::MessageKind;
use crate::error::{Ambiguity, LogError};
use crate::mapping::{JointEffort, Mapping, McapMap};
use crate::options::OpenOptions;
use crate::sources::TopicUse;
use sinew_files::names::{hint, list};
use sinew_files::{Fault, Located};
use std::collections::BTreeSet;

/// Default topic of the joint side.
const JOINT_TOPIC: &str = "/joint_states";
/// Default topic of the motor side.
const MOTOR_TOPIC: &str = "/dynamic_joint_states";

/// Checks that no term names a column: in an MCAP recording a term converts a field.
pub(crate) fn check_mapping(mapping: &Mapping) -> Result<(), Located> {
    let of_joints = mapping.joints.iter();
    let of_joints = of_joints.flat_map(|joint| joint.sources.iter().flatten());
    let of_tendons = mapping.tendons.iter().flat_map(|tendon| &tendon.tension);
    for source in of_joints.chain(of_tendons) {
        for term in &source.terms {
            if let Some(column) = &term.column {
                let problem = "an MCAP recording has topics, not columns";
                return Err(Located::new(&mapping.file, Fault::NotAllowed, problem)
                    .line(term.line)
                    .column(column.to_string().replace('\'', ""))
                    .cure("omit column and sum; the term then converts the value of the topic"));
            }
        }
    }
    Ok(())
}

/// Requests of options and mapping; the options take precedence.
#[derive(Debug, Clone)]
pub(crate) struct Wishes {
    pub(crate) joint: Option<String>,
    pub(crate) motor: Option<String>,
    pub(crate) external: String,
    /// The mapping's alone.
    pub(crate) tension: Option<String>,
    motor_interface: String,
    motor_effort_interface: String,
    temperature_interface: String,
    joint_effort: JointEffort,
    /// Whether the motor interface is not the default one.
    requests_interface: bool,
    /// Namespace of the default names; empty: any.
    pub(crate) namespace: String,
}

impl Wishes {
    /// `namespace` is empty, or a name that begins with `/`: usual names are looked for in it.
    pub(crate) fn of(options: &OpenOptions, namespace: &str) -> Self {
        let full = |name: String| match name.starts_with('/') {
            true => name,
            false => format!("{namespace}/{name}"),
        };
        let defaults = OpenOptions::default();
        let none = McapMap::default();
        let mapped = options
            .mapping
            .as_ref()
            .map_or(&none, |mapping| &mapping.mcap);
        let name = |given: &String, default: &String, mapped: &Option<String>| {
            let mapped = mapped.as_ref().filter(|_| given == default);
            mapped.unwrap_or(given).clone()
        };
        let topic = |given: &Option<String>, mapped: &Option<String>| {
            given.as_ref().or(mapped.as_ref()).cloned().map(full)
        };
        let external = name(
            &options.external_torque_topic,
            &defaults.external_torque_topic,
            &mapped.external_torque_topic,
        );
        let motor_interface = name(
            &options.motor_interface,
            &defaults.motor_interface,
            &mapped.motor_interface,
        );
        Wishes {
            joint: topic(&options.joint_state_topic, &mapped.joint_state_topic),
            motor: topic(&options.motor_topic, &mapped.motor_topic),
            external: match external == defaults.external_torque_topic {
                true => format!("{namespace}{external}"),
                false => full(external),
            },
            tension: topic(&None, &mapped.tension_topic),
            requests_interface: motor_interface != defaults.motor_interface,
            namespace: namespace.to_owned(),
            motor_interface,
            motor_effort_interface: name(
                &options.motor_effort_interface,
                &defaults.motor_effort_interface,
                &mapped.motor_effort_interface,
            ),
            temperature_interface: name(
                &options.temperature_interface,
                &defaults.temperature_interface,
                &mapped.temperature_interface,
            ),
            joint_effort: match mapped.joint_effort {
                Some(effort) if options.joint_effort == JointEffort::default() => effort,
                _ => options.joint_effort,
            },
        }
    }

    /// Whether a topic is in the namespace of the default names.
    pub(crate) fn encloses(&self, topic: &str) -> bool {
        let inner = topic.strip_prefix(&self.namespace);
        inner.is_some_and(|inner| self.namespace.is_empty() || inner.starts_with('/'))
    }

    fn usual(&self, topic: &str) -> String {
        format!("{}{topic}", self.namespace)
    }

    fn is_motor_name(&self, topic: &str) -> bool {
        let inner = topic.strip_prefix(&self.namespace).unwrap_or(topic);
        inner.to_ascii_lowercase().contains("motor")
    }

    /// Whether a topic has a requested name, or the default one if none is requested.
    pub(crate) fn is_named(&self, topic: &str) -> bool {
        let is = |wanted: &Option<String>, usual: &str| match wanted {
            Some(wanted) => wanted == topic,
            None => self.usual(usual) == topic,
        };
        let is_other = topic == self.external || self.tension.as_deref() == Some(topic);
        is(&self.joint, JOINT_TOPIC) || is(&self.motor, MOTOR_TOPIC) || is_other
    }

    /// Whether a topic may become one of the sides, by its name and type only.
    pub(crate) fn may_use(&self, topic: &str, kind: MessageKind) -> bool {
        let is = |wanted: &Option<String>| wanted.as_deref() == Some(topic);
        if is(&self.joint) || is(&self.motor) || is(&self.tension) || topic == self.external {
            return true;
        }
        let is_state = kind == MessageKind::JointState;
        let is_open = self.motor.is_none() || self.joint.is_none() && is_state;
        is_open && self.encloses(topic)
    }

    /// The names with these topics in their roles.
    pub(crate) fn names(
        &self,
        joint: Option<&Topic>,
        motor: Option<&Topic>,
        external: Option<&Topic>,
        tension: Option<&Topic>,
    ) -> Names {
        Names {
            joint_topic: joint.map(|topic| topic.name.clone()),
            motor_topic: motor.map(|topic| topic.name.clone()),
            motor_is_plain: motor.is_some_and(|motor| {
                MessageKind::of_schema(&motor.schema) == Some(MessageKind::JointState)
            }),
            external_topic: external.map(|topic| topic.name.clone()),
            tension_topic: tension.map(|topic| topic.name.clone()),
            motor_interface: self.motor_interface.clone(),
            motor_effort_interface: self.motor_effort_interface.clone(),
            temperature_interface: self.temperature_interface.clone(),
            joint_effort: self.joint_effort,
        }
    }
}

/// Chooses the topics.
pub(crate) fn choose(
    survey: &Survey,
    options: &OpenOptions,
    file: &str,
) -> Result<Names, LogError> {
    let wishes = Wishes::of(options, "");
    let topics = Topics::of(survey, file);
    let joint = match &wishes.joint {
        Some(wanted) => topics.named(wanted, "joint side", &[MessageKind::JointState])?,
        None => {
            let found = topics.joint_side(&wishes)?;
            found.ok_or_else(|| topics.no_joint_side(survey))?
        }
    };
    if !joint.is_decoded() {
        return Err(LogError::request(
            file,
            format!(
                "topic '{}' is encoded as '{}'; supported are cdr (ROS 2) and ros1; convert the recording with rosbags-convert or ros2 bag convert",
                joint.name, joint.encoding
            ),
        ));
    }
    let motor = match &wishes.motor {
        Some(wanted) => Some(topics.named(wanted, "motor side", &MOTOR_KINDS)?),
        None => topics.motor_side(&wishes, Some(joint))?,
    };
    if motor.is_some_and(|motor| motor.name == joint.name) {
        return Err(LogError::request(
            file,
            format!(
                "joint side and motor side are the same topic, '{}'; specify the motor topic (--motor-topic); topics are {}",
                joint.name,
                list(&topics.labels())
            ),
        ));
    }
    let tension = topics.tension(&wishes).transpose()?;
    for (side, other) in [("joint side", Some(joint)), ("motor side", motor)] {
        if let Some(topic) = tension.filter(|t| other.is_some_and(|other| other.name == t.name)) {
            let (topic, there) = (&topic.name, list(&topics.labels()));
            let reason = format!(
                "{side} and tensions are the same topic, '{topic}'; name the topic of the tensions as tension_topic in [mcap] of the mapping, topics are {there}"
            );
            return Err(LogError::request(file, reason));
        }
    }
    let names = wishes.names(Some(joint), motor, topics.external(&wishes), tension);
    let interfaces = motor.map_or(Vec::new(), Topic::interfaces);
    let wanted = &names.motor_interface;
    if wishes.requests_interface && !interfaces.is_empty() && !interfaces.contains(wanted) {
        let hint = hint(wanted, &interfaces);
        let there = list(&interfaces);
        let reason =
            format!("no interface '{wanted}' on the motor side{hint} interfaces are {there}");
        return Err(LogError::request(file, reason));
    }
    Ok(names)
}

/// Chooses among the topics discovered so far: a side that is missing or ambiguous has none.
pub(crate) fn choose_so_far(survey: &Survey, wishes: &Wishes) -> (Names, Vec<Ambiguity>) {
    let topics = Topics::of(survey, "");
    let mut ambiguous = Vec::new();
    let mut settle = |found: Result<Option<&'_ Topic>, LogError>| match found {
        Ok(found) => found.map(|topic| topic.name.clone()),
        Err(LogError::Ambiguous(what)) => {
            ambiguous.push(what);
            None
        }
        // Named, and not there yet or of another type.
        Err(_) => None,
    };
    let joint = settle(match &wishes.joint {
        Some(wanted) => {
            let named = topics.named(wanted, "joint side", &[MessageKind::JointState]);
            named.map(Some)
        }
        None => topics.joint_side(wishes),
    });
    let joint = joint.and_then(|name| topics.by_name(&name));
    let motor = settle(match &wishes.motor {
        Some(wanted) => topics.named(wanted, "motor side", &MOTOR_KINDS).map(Some),
        None => topics.motor_side(wishes, joint),
    });
    let motor = motor.and_then(|name| topics.by_name(&name));
    let motor = motor.filter(|motor| joint.is_none_or(|joint| joint.name != motor.name));
    // Named, and not there yet or of another type.
    let tension = topics.tension(wishes).and_then(Result::ok);
    let tension = tension.filter(|tension| {
        let taken = [joint, motor].into_iter().flatten();
        taken.into_iter().all(|side| side.name != tension.name)
    });
    (
        wishes.names(joint, motor, topics.external(wishes), tension),
        ambiguous,
    )
}

/// Message types of the motor side.
const MOTOR_KINDS: [MessageKind; 2] = [MessageKind::DynamicJointState, MessageKind::JointState];

/// Topics of a recording, to choose from.
struct Topics<'a> {
    all: Vec<&'a Topic>,
    file: &'a str,
}

impl<'a> Topics<'a> {
    fn of(survey: &'a Survey, file: &'a str) -> Self {
        let mut all: Vec<&Topic> = survey.topics.values().collect();
        // A topic may have several channels.
        let mut seen = BTreeSet::new();
        all.retain(|topic| seen.insert(&topic.name));
        Topics { all, file }
    }

    fn of_kind(&self, kind: MessageKind) -> Vec<&'a Topic> {
        let all = self.all.iter().copied();
        all.filter(|topic| MessageKind::of_schema(&topic.schema) == Some(kind))
            .collect()
    }

    fn by_name(&self, name: &str) -> Option<&'a Topic> {
        self.all.iter().copied().find(|topic| topic.name == name)
    }

    /// Topic of the joint side if none is specified.
    fn joint_side(&self, wishes: &Wishes) -> Result<Option<&'a Topic>, LogError> {
        let could_be = |topic: &&Topic| {
            Some(&topic.name) != wishes.motor.as_ref()
                && Some(&topic.name) != wishes.tension.as_ref()
                && topic.name != wishes.external
                && (wishes.motor.is_some() || !wishes.is_motor_name(&topic.name))
        };
        let states = self.of_kind(MessageKind::JointState);
        let candidates: Vec<&Topic> = states.into_iter().filter(could_be).collect();
        self.one_of(&candidates, &wishes.usual(JOINT_TOPIC), TopicUse::JointSide)
    }

    /// Topic of the motor side if none is specified.
    fn motor_side(
        &self,
        wishes: &Wishes,
        joint: Option<&Topic>,
    ) -> Result<Option<&'a Topic>, LogError> {
        let mut candidates = self.of_kind(MessageKind::DynamicJointState);
        if candidates.is_empty() {
            let motors = self.of_kind(MessageKind::JointState).into_iter();
            let is_joint = |topic: &Topic| joint.is_some_and(|joint| joint.name == topic.name);
            let is_free =
                |topic: &Topic| !is_joint(topic) && Some(&topic.name) != wishes.tension.as_ref();
            let motors = motors.filter(|topic| is_free(topic) && wishes.is_motor_name(&topic.name));
            candidates = motors.collect();
        }
        self.one_of(&candidates, &wishes.usual(MOTOR_TOPIC), TopicUse::MotorSide)
    }

    fn external(&self, wishes: &Wishes) -> Option<&'a Topic> {
        let mut all = self.all.iter().copied();
        all.find(|topic| topic.name == wishes.external && topic.schema.ends_with("JointState"))
    }

    /// Requested topic of the tensions.
    fn tension(&self, wishes: &Wishes) -> Option<Result<&'a Topic, LogError>> {
        let wanted = wishes.tension.as_ref()?;
        Some(self.named(wanted, "topic of the tensions", &[MessageKind::JointState]))
    }

    /// Names with their types.
    fn labels(&self) -> Vec<String> {
        let label = |topic: &&Topic| format!("{} ({})", topic.name, topic.schema);
        self.all.iter().map(label).collect()
    }

    /// Requested topic of a side.
    fn named(
        &self,
        wanted: &str,
        side: &str,
        kinds: &[MessageKind],
    ) -> Result<&'a Topic, LogError> {
        let Some(topic) = self.all.iter().find(|topic| topic.name == wanted) else {
            let names: Vec<&str> = self.all.iter().map(|topic| topic.name.as_str()).collect();
            let (hint, there) = (hint(wanted, &names), list(&names));
            let reason = format!("no topic '{wanted}'{hint} topics are {there}");
            return Err(LogError::request(self.file, reason));
        };
        match MessageKind::of_schema(&topic.schema) {
            Some(kind) if kinds.contains(&kind) => Ok(topic),
            _ => {
                let types: Vec<&str> = kinds.iter().map(|kind| kind.schema()).collect();
                let (holds, types) = (&topic.schema, types.join(" or "));
                let reason =
                    format!("topic '{wanted}' has type '{holds}'; the {side} requires {types}");
                Err(LogError::request(self.file, reason))
            }
        }
    }

    /// Topic of the default name, or the only one; several candidates are an error.
    fn one_of(
        &self,
        candidates: &[&'a Topic],
        usual: &str,
        side: TopicUse,
    ) -> Result<Option<&'a Topic>, LogError> {
        let usual = candidates.iter().find(|topic| topic.name == usual);
        match (usual, candidates) {
            (Some(topic), _) | (None, [topic]) => Ok(Some(topic)),
            (None, []) => Ok(None),
            (None, several) => Err(LogError::Ambiguous(Ambiguity {
                file: self.file.to_owned(),
                side,
                candidates: several.iter().map(|t| t.name.clone()).collect(),
            })),
        }
    }

    fn no_joint_side(&self, survey: &Survey) -> LogError {
        let damage = survey.health.damage.first();
        let damage = damage.map_or(String::new(), |damage| {
            format!(" before byte {}: {}", damage.offset, damage.reason)
        });
        LogError::not_a_recording(
            self.file,
            format!(
                "no sensor_msgs/msg/JointState topic for the joint side{damage}; topics are {}",
                list(&self.labels())
            ),
        )
    }
}
