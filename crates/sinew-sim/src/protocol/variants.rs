//! Variants of the protocol for conditions of practical use: each is one of its scenarios with a few edits.

use super::Plan;
use super::PlanError;
use super::texts::{merged, set};
use toml::{Table, Value};

/// One of the protocol's scenarios, edited.
struct Variant {
    name: &'static str,
    /// Description for the table.
    about: &'static str,
    /// The scenario it starts from.
    of: &'static str,
    edits: &'static [Edit],
}

/// Edit of a scenario. Sessions B and C begin at 60 and 120 s.
#[derive(Debug, Clone, Copy)]
enum Edit {
    /// The motor torque is not recorded.
    NoMotorTorque,
    /// The recorded motor torque is too large by this share.
    MotorTorqueScale(f64),
    /// The temperature is not recorded.
    NoTemperature,
    /// Temperature rise from B on, K.
    Warmer(f64),
    /// External force at the tool, N in the base frame, between these times, s.
    Force([f64; 3], [f64; 2]),
    /// Every tendon elongates from B on at this rate, rad per minute.
    Creep(f64),
    /// The elbow's tendon elongates by this amount, rad, evenly between these times, s.
    SlowSlip(f64, [f64; 2]),
    /// Offsets of pitch and elbow from B on, rad.
    Offset(f64),
    /// Offset of every motor encoder from the beginning, normal, rad.
    EncoderZeroOffset(f64),
    /// The payload's centre of mass lies so far out along the hand, m.
    PayloadOut(f64),
    /// Mass of the payload, kg.
    PayloadOf(f64),
    /// The gripper is empty, but this is not specified.
    EmptyUnstated,
    /// Stiffness ratio of shoulder pitch and elbow from session B on.
    StiffnessLeft(f64),
    /// Stiffness is described wrong by up to this share.
    StiffnessWithin(f64),
    /// Relative error of the masses, uniform within this bound.
    MassWithin(f64),
    /// Coulomb friction of the joints, times the description's largest.
    Friction(f64),
    /// Bits of the joint encoders.
    JointBits(i64),
    /// Frames a second.
    SampleRate(i64),
    /// Every session is at rest in one pose.
    AtRest,
    /// Only the elbow moves.
    OnlyElbow,
    /// Moves and rests are longer by this factor.
    Slower(f64),
}

const END_OF_B_S: f64 = 120.0;
/// Beyond the end of C.
const END_S: f64 = 200.0;

/// All variants, in the order of the table.
const VARIANTS: [Variant; 26] = [
    variant("no-torque", "S7", "no motor torque", &[Edit::NoMotorTorque]),
    variant(
        "no-torque-stress",
        "S8b",
        "S8b without motor torque",
        &[Edit::NoMotorTorque],
    ),
    variant(
        "force-lateral",
        "S6",
        "1 N across the base from B on",
        &[Edit::Force([0.0, 1.0, 0.0], [60.0, END_S])],
    ),
    variant(
        "force-radial",
        "S6",
        "1 N along the base from B on",
        &[Edit::Force([1.0, 0.0, 0.0], [60.0, END_S])],
    ),
    variant(
        "force-down",
        "S5",
        "2 N down from B on, no payload specified",
        &[Edit::Force([0.0, 0.0, -2.0], [60.0, END_S])],
    ),
    variant(
        "leaned-on",
        "S6",
        "10 N for 25 s, beyond the end of B",
        &[Edit::Force(
            [6.0, 8.0, 0.0],
            [END_OF_B_S - 20.0, END_OF_B_S + 5.0],
        )],
    ),
    variant(
        "creep-1",
        "S6",
        "every tendon creeps by 1 mrad/min",
        &[Edit::Creep(0.001)],
    ),
    variant(
        "creep-3",
        "S6",
        "every tendon creeps by 3 mrad/min",
        &[Edit::Creep(0.003)],
    ),
    variant(
        "slow-slip",
        "S6",
        "elbow slips by 5 mrad over 20 s of B",
        &[Edit::SlowSlip(0.005, [85.0, 105.0])],
    ),
    variant(
        "offset-40",
        "S6",
        "offsets of 40 mrad",
        &[Edit::Offset(0.040)],
    ),
    variant(
        "retensioned",
        "S6",
        "offsets of −10 mrad",
        &[Edit::Offset(-0.010)],
    ),
    variant(
        "encoder-zero-offset",
        "S6",
        "encoder zero offsets of 10 mrad, zero_mrad = 0",
        &[Edit::EncoderZeroOffset(0.010)],
    ),
    variant(
        "payload-out",
        "S6",
        "payload held 25 cm out",
        &[Edit::PayloadOut(0.25)],
    ),
    variant(
        "payload-heavy",
        "S6",
        "payload of 1 kg",
        &[Edit::PayloadOf(1.0)],
    ),
    variant(
        "empty-unstated",
        "S5",
        "gripper empty, not specified",
        &[Edit::EmptyUnstated],
    ),
    variant(
        "stiffness-97",
        "S6",
        "3 % of stiffness lost at two joints",
        &[Edit::StiffnessLeft(0.97)],
    ),
    variant(
        "stiffness-40",
        "S6",
        "stiffness error of up to 40 %",
        &[Edit::StiffnessWithin(0.4)],
    ),
    variant(
        "mass-25",
        "S6",
        "mass error of up to 25 %",
        &[Edit::MassWithin(0.25)],
    ),
    variant(
        "friction-3",
        "S6",
        "joint friction three times as described",
        &[Edit::Friction(3.0)],
    ),
    variant(
        "torque-wrong",
        "S6",
        "motor torque 30 % too large",
        &[Edit::MotorTorqueScale(0.3)],
    ),
    variant(
        "warmer-25",
        "S8",
        "25 K warmer, temperature not recorded",
        &[Edit::Warmer(25.0), Edit::NoTemperature],
    ),
    variant(
        "bits-11",
        "S6",
        "joint encoders of 11 bits",
        &[Edit::JointBits(11)],
    ),
    variant(
        "rate-50",
        "S6",
        "50 frames per second",
        &[Edit::SampleRate(50)],
    ),
    variant("standing", "S6", "arm at rest", &[Edit::AtRest]),
    variant(
        "only-elbow",
        "S6",
        "only the elbow moves",
        &[Edit::OnlyElbow],
    ),
    variant(
        "slower",
        "S6",
        "moves and rests three times longer",
        &[Edit::Slower(3.0)],
    ),
];

const fn variant(
    name: &'static str,
    of: &'static str,
    about: &'static str,
    edits: &'static [Edit],
) -> Variant {
    Variant {
        name,
        about,
        of,
        edits,
    }
}

/// Names of the variants, in the order of their table.
pub fn variants() -> impl Iterator<Item = &'static str> {
    VARIANTS.iter().map(|v| v.name)
}

/// The variant of that name, ready to be recorded; `None`: there is none.
///
/// # Errors
/// [`PlanError::Text`] where its edits make no scenario.
pub(super) fn plan(name: &str) -> Option<Result<Plan, PlanError>> {
    let variant = VARIANTS.iter().find(|v| v.name == name)?;
    Some(variant.plan())
}

impl Variant {
    fn plan(&self) -> Result<Plan, PlanError> {
        let mut table = merged(self.of)?;
        table.insert("name".into(), self.name.into());
        for edit in self.edits {
            edit.apply(&mut table);
        }
        let plan = Plan::shipped(&table, self.name)?;
        let unstated = self.edits.iter().any(|e| matches!(e, Edit::EmptyUnstated));
        Ok(Plan {
            about: Some(self.about.into()),
            // The texts of the catalogue do not contain the edits.
            based_on: plan.text.clone(),
            payload_unknown: plan.payload_unknown || unstated,
            ..plan
        })
    }
}

impl Edit {
    fn apply(self, table: &mut Table) {
        let all = |value: Value| value;
        match self {
            Self::NoMotorTorque => set(table, "record", "tau_m", false.into()),
            Self::MotorTorqueScale(share) => {
                set(table, "motor_torque", "scale_error", share.into());
            }
            Self::NoTemperature => set(table, "record", "temperature", false.into()),
            Self::Warmer(kelvin) => set(table, "temperature", "change_k", kelvin.into()),
            Self::Force(force_n, [from_s, to_s]) => push(
                table,
                "contacts",
                Table::from_iter([
                    ("link".to_string(), "tool".into()),
                    ("start_s".to_string(), from_s.into()),
                    ("duration_s".to_string(), (to_s - from_s).into()),
                    (
                        "force_n".to_string(),
                        Value::Array(force_n.map(Value::from).to_vec()),
                    ),
                    ("rise_s".to_string(), 0.05.into()),
                ]),
            ),
            Self::Creep(rad_per_minute) => {
                for joint in joints(table) {
                    let minutes = (END_S - 60.0) / 60.0;
                    ramp(table, &joint, rad_per_minute * minutes, [60.0, END_S]);
                }
            }
            Self::SlowSlip(rad, times_s) => ramp(table, "elbow", rad, times_s),
            Self::Offset(rad) => {
                let fixed = |o: &&mut Table| {
                    o.get("at_s").and_then(Value::as_float) == Some(60.0)
                        && o.get("rad").is_some_and(Value::is_float)
                };
                for offset in entries(table, "offsets").filter(fixed) {
                    offset.insert("rad".into(), rad.into());
                }
            }
            Self::EncoderZeroOffset(rad) => {
                for joint in joints(table) {
                    let entry = Table::from_iter([
                        ("joint".to_string(), joint.as_str().into()),
                        ("kind".to_string(), "motor-encoder".into()),
                        ("shape".to_string(), "constant".into()),
                        ("rad".to_string(), normal(rad)),
                    ]);
                    push(table, "offsets", entry);
                }
            }
            Self::PayloadOut(out_m) => {
                let com = [0.0, 0.0, out_m].map(Value::from).to_vec();
                for payload in entries(table, "payloads") {
                    payload.insert("com_m".into(), Value::Array(com.clone()));
                }
            }
            Self::PayloadOf(kg) => {
                for payload in entries(table, "payloads") {
                    payload.insert("mass_kg".into(), kg.into());
                }
            }
            // This edit changes the estimator's input, not the scenario.
            Self::EmptyUnstated => {}
            Self::StiffnessLeft(left) => {
                let factors = ["shoulder_pitch", "elbow"].map(|j| (j.to_string(), left.into()));
                let factors = Value::Table(Table::from_iter(factors));
                set(table, "truth", "stiffness_later_factor", factors);
                set(table, "truth", "stiffness_later_from_s", 60.0.into());
            }
            Self::StiffnessWithin(share) => {
                let drawn = between(1.0 - share, 1.0 + share);
                set(table, "truth", "stiffness_factor", drawn);
            }
            Self::MassWithin(share) => {
                let drawn = between(1.0 - share, 1.0 + share);
                set(table, "truth", "mass_factor", drawn);
            }
            Self::Friction(factor) => {
                let of = table
                    .get_mut("joint_friction")
                    .and_then(|f| f.get_mut("coulomb_nm"));
                for (_, drawn) in of.and_then(Value::as_table_mut).into_iter().flatten() {
                    let middle = |d: &Value| {
                        let [lo, hi] = ["min", "max"].map(|k| d.get(k)?.as_float());
                        Some(0.5 * (lo? + hi?))
                    };
                    if let Some(middle) = middle(drawn) {
                        *drawn = (factor * middle).into();
                    }
                }
            }
            Self::JointBits(bits) => set(table, "encoder", "joint_bits", bits.into()),
            Self::SampleRate(hz) => {
                table.insert("sample_rate_hz".into(), hz.into());
            }
            Self::AtRest => {
                let pose = [("shoulder_pitch", 0.9), ("elbow", 0.7)];
                let pose = pose.map(|(joint, rad)| (joint.to_string(), rad.into()));
                let motion = Table::from_iter([
                    ("kind".to_string(), "hold".into()),
                    ("pose_rad".to_string(), Value::Table(Table::from_iter(pose))),
                ]);
                table.insert("motion".into(), all(Value::Table(motion)));
            }
            Self::OnlyElbow => {
                let range = table.get_mut("motion").and_then(|m| m.get_mut("range_rad"));
                for (joint, drawn) in range.and_then(Value::as_table_mut).into_iter().flatten() {
                    if joint != "elbow" {
                        *drawn = 0.6.into();
                    }
                }
            }
            Self::Slower(factor) => {
                set(
                    table,
                    "motion",
                    "move_s",
                    between(0.9 * factor, 1.6 * factor),
                );
                set(
                    table,
                    "motion",
                    "pause_s",
                    between(0.5 * factor, 1.2 * factor),
                );
            }
        }
    }
}

/// The tables of a list.
fn entries<'a>(table: &'a mut Table, list: &str) -> impl Iterator<Item = &'a mut Table> + use<'a> {
    let list = table.get_mut(list).and_then(Value::as_array_mut);
    list.into_iter().flatten().filter_map(Value::as_table_mut)
}

fn push(table: &mut Table, list: &str, entry: Table) {
    let list = table
        .entry(list)
        .or_insert_with(|| Value::Array(Vec::new()));
    if let Value::Array(list) = list {
        list.push(Value::Table(entry));
    }
}

/// The joints that have tendons.
fn joints(table: &mut Table) -> Vec<String> {
    let mut names: Vec<String> = entries(table, "offsets")
        .filter_map(|o| Some(o.get("joint")?.as_str()?.to_string()))
        .collect();
    names.sort();
    names.dedup();
    names
}

fn ramp(table: &mut Table, joint: &str, rad: f64, [from_s, to_s]: [f64; 2]) {
    let entry = Table::from_iter([
        ("joint".to_string(), joint.into()),
        ("kind".to_string(), "physical".into()),
        ("shape".to_string(), "ramp".into()),
        ("from_s".to_string(), from_s.into()),
        ("to_s".to_string(), to_s.into()),
        ("rad".to_string(), rad.into()),
    ]);
    push(table, "offsets", entry);
}

fn between(min: f64, max: f64) -> Value {
    let ends = [("min", min), ("max", max)].map(|(k, v)| (k.to_string(), v.into()));
    Value::Table(Table::from_iter(ends))
}

fn normal(std: f64) -> Value {
    Value::Table(Table::from_iter([("std".to_string(), std.into())]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Draw;

    fn named(name: &str) -> Plan {
        crate::protocol::plan_named(name).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    #[test]
    fn variants_differ_from_base_and_keep_sessions() {
        for variant in &VARIANTS {
            let (plan, base) = (named(variant.name), named(variant.of));
            assert_eq!(plan.scenario.name, variant.name);
            assert_eq!(plan.scenario.sessions, base.scenario.sessions);
            assert_eq!(plan.about.as_deref(), Some(variant.about));
            let renamed = crate::Scenario {
                name: base.scenario.name.clone(),
                file: base.scenario.file.clone(),
                ..plan.scenario.clone()
            };
            let told = plan.payload_unknown != base.payload_unknown;
            assert!(renamed != base.scenario || told, "{}", variant.name);
        }
    }

    #[test]
    fn edits_match_names() {
        assert!(!named("no-torque").scenario.record.tau_m);
        let empty = named("empty-unstated");
        assert!(empty.payload_unknown && empty.scenario.payloads.is_empty());
        // 1 mrad a minute: a milliradian at the end of B.
        let creep = named("creep-1").scenario;
        let ramps = creep.offsets.iter().filter(|o| o.shape.step_s().is_none());
        let at_end_of_b: Vec<f64> = ramps
            .map(|o| match o.size_rad {
                Draw::Fixed(rad) => 1e3 * rad * o.shape.at(END_OF_B_S),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(at_end_of_b.len(), 4);
        assert!(at_end_of_b.iter().all(|mrad| (mrad - 1.0).abs() < 1e-12));
        // Only the offsets of pitch and elbow: yaw's and wrist's are drawn, the slips of C stay.
        let far = named("offset-40").scenario.offsets;
        let fixed = |rad| {
            far.iter()
                .filter(|o| o.size_rad == Draw::Fixed(rad))
                .count()
        };
        assert_eq!((fixed(0.040), fixed(0.005), fixed(0.010)), (2, 2, 0));
        let rubs = named("friction-3").scenario.joint_friction.coulomb_nm;
        let elbow = rubs.by_joint.iter().find(|(name, _, _)| name == "elbow");
        let Some((_, _, Draw::Fixed(nm))) = elbow else {
            panic!("{elbow:?}");
        };
        assert!((nm - 0.15).abs() < 1e-12);
    }
}
