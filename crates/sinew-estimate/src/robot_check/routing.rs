//! Routing of tendons between motors and joints, and the observability of their elongations.

use serde::Serialize;
use sinew_model::arm::urdf::JointLimits;
use sinew_model::tendons::{
    Coordinate, Coupling, CouplingState, Equations, Group, Sensors, TendonKind,
};

/// Evaluated range of a joint without limits, to each side, rad.
const CONTINUOUS_RAD: f64 = 1.5;

/// Tendons between motors and joints, where `robot.toml` has `[[tendons]]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RoutingCheck {
    /// Joints in the order of the moment arms.
    pub joints: Vec<String>,
    /// Motors in the order of the drums.
    pub motors: Vec<String>,
    /// Tendons in the order of `robot.toml`, those of the shorthand first.
    pub tendons: Vec<TendonRouting>,
    /// Joints and tendons that are connected with each other, and with no others.
    pub groups: Vec<GroupCheck>,
    /// Combinations of elongations that are unobservable from the motion of the joints within their limits, with every
    /// strand taut.
    pub unobservable: Vec<Combination>,
}

/// Routing of one tendon.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonRouting {
    /// Name of the tendon.
    pub name: String,
    /// Way in which the tendon pulls.
    pub kind: TendonForm,
    /// Unit of the tendon's path.
    pub path: PathUnit,
    /// Path that each motor takes in per rad, m/rad or rad/rad; 0 of a motor that does not drive it.
    pub drums: Vec<f64>,
    /// Moment arm at each joint at `q = 0`, m/rad or rad/rad; 0 of a joint that it does not cross.
    pub moment_arms: Vec<f64>,
    /// Stiffness, N/m or N·m/rad.
    pub stiffness: f64,
}

/// Way in which a tendon pulls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TendonForm {
    /// Both ways, as a closed loop.
    Loop,
    /// One way, as a single strand.
    Strand,
}

/// Unit of a tendon's path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum PathUnit {
    /// Metres of rope.
    #[serde(rename = "m")]
    Metres,
    /// Radians of the motor.
    #[serde(rename = "rad")]
    MotorRadians,
}

/// Joints and tendons that are connected with each other, and with no others.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GroupCheck {
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Names of the tendons.
    pub tendons: Vec<String>,
    /// Equations that estimate the elongations.
    pub equations: GroupEquations,
    /// Condition number of the moment arms; none without an equation per tendon.
    pub condition: Option<f64>,
}

/// Equations that estimate the elongations of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum GroupEquations {
    /// One per tendon.
    Tendon,
    /// One per joint.
    Joint,
}

/// Combination of elongations.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Combination {
    /// Names and weights of the tendons; the weights have unit norm.
    pub weights: Vec<(String, f64)>,
    /// Whether the combination is observable with the torque of every motor; with tension sensors it always is.
    pub shown_by_motor_torque: bool,
}

impl RoutingCheck {
    /// Whether the elongation of one of these tendons is unobservable from the motion of the joints.
    pub fn hides_any(&self, tendons: &[String]) -> bool {
        let mut hidden = self.unobservable.iter().flat_map(|c| &c.weights);
        hidden.any(|(name, _)| tendons.contains(name))
    }

    /// Describes the routing of a robot's joints, motors and tendons.
    ///
    /// * `limits`: one entry per joint.
    pub(super) fn of(coupling: &Coupling, limits: &[JointLimits]) -> Self {
        let joints: Vec<String> = coupling.joints().iter().map(|j| j.name.clone()).collect();
        let motors = coupling.motor_names().to_vec();
        let names: Vec<&str> = coupling.tendon_names().collect();
        let (n, m) = (joints.len(), motors.len());
        let mut state = CouplingState::new(coupling);
        let zeros = |length| vec![0.0; length];
        // Every coupling accepts positions of the right length. With ropes shortened by one unit, strands without
        // pretension are taut as well.
        let short = vec![-1.0; names.len()];
        let _ = coupling.evaluate(&mut state, &zeros(m), &zeros(n), &short);
        let mut states = vec![state.clone()];
        for (j, limit) in limits.iter().enumerate().take(n) {
            for end in [limit.lower, limit.upper] {
                let mut q = zeros(n);
                q[j] = end.clamp(-CONTINUOUS_RAD, CONTINUOUS_RAD);
                let mut there = CouplingState::new(coupling);
                let _ = coupling.evaluate(&mut there, &zeros(m), &q, &short);
                if there.moment_arms() != state.moment_arms() {
                    states.push(there);
                }
            }
        }
        let states: Vec<&CouplingState> = states.iter().collect();
        let tendon = |(i, name): (usize, &&str)| TendonRouting {
            name: (*name).to_owned(),
            kind: match coupling.kind(i) {
                Some(TendonKind::Strand) => TendonForm::Strand,
                _ => TendonForm::Loop,
            },
            path: match coupling.coordinate(i) {
                Some(Coordinate::MotorRadians { .. }) => PathUnit::MotorRadians,
                _ => PathUnit::Metres,
            },
            drums: coupling.drums()[i * m..(i + 1) * m].to_vec(),
            moment_arms: state.moment_arms()[i * n..(i + 1) * n].to_vec(),
            stiffness: coupling.stiffness(i).unwrap_or(f64::NAN),
        };
        let group = |group: &Group| GroupCheck {
            joints: group.joints().iter().map(|j| joints[*j].clone()).collect(),
            tendons: (group.tendons().iter())
                .map(|i| names[*i].to_owned())
                .collect(),
            equations: match group.equations() {
                Equations::Joint(_) => GroupEquations::Joint,
                Equations::Diagonal | Equations::Tendon { .. } => GroupEquations::Tendon,
            },
            condition: match group.equations() {
                Equations::Tendon { condition } => Some(condition),
                Equations::Diagonal => Some(1.0),
                Equations::Joint(_) => None,
            },
        };
        let unobservable = |motor_torque: &[usize]| {
            let sensors = Sensors {
                motor_torque,
                ..Sensors::default()
            };
            let found = coupling.observability_over(&states, sensors);
            found.map_or_else(|_| Vec::new(), |found| found.unobservable)
        };
        let with_torque = unobservable(&Vec::from_iter(0..m));
        let hides = |i: usize| with_torque.iter().any(|weights| weights[i].abs() > 1e-9);
        let combination = |weights: Vec<f64>| Combination {
            shown_by_motor_torque: !(weights.iter().enumerate())
                .any(|(i, weight)| weight.abs() > 1e-9 && hides(i)),
            weights: (names.iter().zip(weights))
                .filter(|(_, weight)| weight.abs() > 1e-9)
                .map(|(name, weight)| ((*name).to_owned(), weight))
                .collect(),
        };
        Self {
            tendons: names.iter().enumerate().map(tendon).collect(),
            groups: coupling.groups().iter().map(group).collect(),
            unobservable: unobservable(&[]).into_iter().map(combination).collect(),
            joints,
            motors,
        }
    }
}
