//! Truth file of a recording.

use super::faults::FaultCounts;
use super::sampled::SampledOffset;
use super::scenario::{Contact, OffsetKind, Session};
use super::simulation::Simulation;
use serde::Serialize;
use std::collections::BTreeMap;

/// By joint, or by tendon or motor where these have names of their own.
type ByName<T> = BTreeMap<String, T>;

/// True values of a simulated recording: `NAME.truth.json`.
///
/// Scenario, seed, `offset_rad`, `step_rad`, `stiffness_nm_per_rad`, `payload_kg` and `temperature_change_k` are
/// needed for scoring; the other fields document the remaining draws.
///
/// Values of a tendon are listed under its name, values of a motor under that of the motor; both are the name of the
/// joint if the robot has no `[[tendons]]`. Values of a tendon are in the coordinate of the joint that it is paired
/// with, those of a motor at its shaft.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Truth {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Frames per second.
    pub sample_rate_hz: f64,
    /// Length of the recording, s.
    pub duration_s: f64,
    /// Time stamp of time 0, ns since 1970.
    pub start_time_ns: i64,
    /// First session, s: `[from, to]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub baseline_s: Option<[f64; 2]>,
    /// Sessions by name, s.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub sessions_s: BTreeMap<String, [f64; 2]>,
    /// Tendons, where they cross several joints or have names of their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tendons: Vec<TrueTendon>,
    /// Offset just before the end of the second session, or of the recording where there are no
    /// sessions, rad.
    pub offset_rad: ByName<f64>,
    /// Offset over time: `[time, offset]`, s and rad; straight lines between.
    pub offset_trajectory_s_rad: ByName<Vec<[f64; 2]>>,
    /// Names of the tendons whose offsets are injected into the recording and do not act on the spring.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub injected: Vec<String>,
    /// Steps of all offsets.
    pub steps: Vec<Step>,
    /// Stiffness, N·m/rad, at the reference temperature.
    pub stiffness_nm_per_rad: ByName<f64>,
    /// Cubic stiffening coefficient of the spring, rad⁻².
    pub spring_cubic_per_rad2: ByName<f64>,
    /// Share of delayed elasticity.
    pub viscoelastic_fraction: ByName<f64>,
    /// Motor inertia, kg·m².
    pub motor_inertia_kg_m2: ByName<f64>,
    /// Mass of the body each joint carries, kg.
    pub mass_kg: ByName<f64>,
    /// Coulomb friction at the joint, N·m.
    pub joint_coulomb_nm: ByName<f64>,
    /// Viscous friction at the joint, N·m·s/rad.
    pub joint_viscous_nm_s_per_rad: ByName<f64>,
    /// Coulomb friction of the drive, N·m.
    pub motor_coulomb_nm: ByName<f64>,
    /// All loads together, kg.
    pub payload_kg: f64,
    /// Loads carried during the recording.
    pub payloads: Vec<Load>,
    /// Share of the time in contact.
    pub contact_fraction: f64,
    /// Contacts during the recording.
    pub contacts: Vec<Touch>,
    /// Drawn temperature change, K.
    pub temperature_change_k: f64,
    /// Frames lost, repeated and delayed on their way into the file.
    pub frames: Frames,
}

/// Tendon that crosses several joints or has its own name.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrueTendon {
    /// Name of the tendon.
    pub name: String,
    /// Joint that it is paired with, in whose rad its values are.
    pub joint: String,
    /// Name of its motor.
    pub motor: String,
    /// Ratio of the position in the tendon's coordinate to the position of the motor shaft.
    pub drive_ratio: f64,
    /// Change of the tendon coordinate per rad of every joint that the tendon crosses; for variable moment arms at `q
    /// = 0`.
    pub moment_arms: ByName<f64>,
    /// Pretension torque of a unidirectional strand with motor and joints at 0, N·m in the tendon coordinate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pretension_nm: Option<f64>,
}

/// Step of an offset.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Step {
    /// Name of the joint or tendon.
    pub joint: String,
    /// Time of the slip, s.
    pub at_s: f64,
    /// Size of the step, rad.
    pub size_rad: f64,
}

/// Load carried by a link.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Load {
    /// Name of the link that carries it.
    pub link: String,
    /// Mass of the load, kg.
    pub mass_kg: f64,
    /// Centre of mass, link frame, m.
    pub com_m: [f64; 3],
    /// Held from, s.
    pub attach_s: f64,
    /// Held until, s; none: to the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub release_s: Option<f64>,
}

/// Contact with a link.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Touch {
    /// Start of the contact, s.
    pub start_s: f64,
    /// Duration of the contact, s.
    pub duration_s: f64,
    /// Name of the link.
    pub link: String,
    /// Contact point on the link, link frame, m.
    pub point_m: [f64; 3],
    /// Force in the base frame, N.
    pub force_n: [f64; 3],
}

/// Frames on their way into the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Frames {
    /// Written, repetitions included.
    pub written: u64,
    /// Frames that were lost.
    pub lost: u64,
    /// Number of duplicate frames.
    pub duplicated: u64,
    /// Written after their successor.
    pub late: u64,
}

impl From<FaultCounts> for Frames {
    fn from(c: FaultCounts) -> Self {
        Self {
            written: c.written,
            lost: c.lost,
            duplicated: c.duplicated,
            late: c.late,
        }
    }
}

/// Maximum number of points of an offset profile in the truth file, in addition to its corners.
const PROFILE_POINTS: u32 = 240;

impl Truth {
    /// The truth of a simulation that has run to its end.
    pub fn of(simulation: &Simulation, counts: FaultCounts) -> Self {
        let scenario = simulation.scenario();
        let names = simulation.joint_names();
        let duration_s = simulation.duration_s();
        let (tendons, motors) = (simulation.tendon_names(), simulation.motor_names());
        let by = |names: &[String], f: &dyn Fn(usize) -> f64| -> ByName<f64> {
            names.iter().cloned().zip((0..names.len()).map(f)).collect()
        };
        // Of tendons and their motors; of a motor with several tendons by the first.
        let by_motor = |f: &dyn Fn(usize) -> f64| -> ByName<f64> {
            let driven = (0..motors.len()).filter(|i| simulation.has_tendon(*i));
            let value = |i: usize| (motors[i].clone(), f(simulation.motor_axis(i)));
            driven.map(value).collect()
        };
        let of_tendons = |f: &dyn Fn(usize) -> f64| -> ByName<f64> {
            let driven = (0..tendons.len()).filter(|i| simulation.has_tendon(*i));
            driven.map(|i| (tendons[i].clone(), f(i))).collect()
        };
        let ratio = |i: usize| simulation.drive_ratio(i);
        let drives = simulation.drives();
        let sum = |i: usize, t: f64| simulation.offset_at(i, t).sum();
        let frame_s = 1.0 / scenario.sample_rate_hz;
        // Just before the end of B: a step at the start of the next session is not part of it.
        let end_s = scenario
            .sessions
            .get(1)
            .map_or(duration_s, |s| s.to_s.min(duration_s))
            - frame_s;
        let span = |s: &Session| [s.from_s, s.to_s];
        let contacts = &simulation.contacts().begun;
        let touched: f64 = contacts
            .iter()
            .map(|c| c.duration_s.min(duration_s - c.start_s))
            .sum();
        Self {
            scenario: scenario.name.clone(),
            seed: scenario.seed,
            sample_rate_hz: scenario.sample_rate_hz,
            duration_s,
            start_time_ns: scenario.start_time_ns,
            baseline_s: scenario.sessions.first().map(span),
            sessions_s: scenario
                .sessions
                .iter()
                .map(|s| (s.name.clone(), span(s)))
                .collect(),
            tendons: true_tendons(simulation),
            offset_rad: of_tendons(&|i| sum(i, end_s)),
            offset_trajectory_s_rad: (0..tendons.len())
                .filter(|&i| {
                    let mut offsets = simulation.offsets().iter();
                    offsets.any(|o| simulation.weight(o, i) != 0.0)
                })
                .map(|i| (tendons[i].clone(), profile(simulation, i, duration_s)))
                .collect(),
            injected: tendons
                .iter()
                .enumerate()
                .filter(|(i, _)| {
                    let injected =
                        |o: &&SampledOffset| o.joint == *i && o.kind == OffsetKind::Injected;
                    simulation.offsets().iter().any(|o| injected(&o))
                })
                .map(|(_, name)| name.clone())
                .collect(),
            steps: simulation
                .offsets()
                .iter()
                .filter_map(|o| {
                    Some(Step {
                        joint: match o.kind {
                            OffsetKind::JointEncoder => names[o.joint].clone(),
                            _ => tendons[o.joint].clone(),
                        },
                        at_s: o.shape.step_s()?,
                        size_rad: o.size_rad,
                    })
                })
                .collect(),
            stiffness_nm_per_rad: of_tendons(&|i| drives[i].stiffness_nm_per_rad),
            spring_cubic_per_rad2: of_tendons(&|i| drives[i].cubic_per_rad2),
            viscoelastic_fraction: of_tendons(&|i| drives[i].viscoelastic_fraction),
            motor_inertia_kg_m2: by_motor(&|i| {
                let inertia = drives[i].motor_inertia_kg_m2;
                ratio(i).map_or(inertia, |ratio| inertia * ratio * ratio)
            }),
            mass_kg: by(names, &|i| {
                simulation.true_empty_arm().body(i).map_or(0.0, |b| b.mass)
            }),
            joint_coulomb_nm: by(names, &|i| drives[i].joint_friction.coulomb_nm),
            joint_viscous_nm_s_per_rad: by(names, &|i| {
                drives[i].joint_friction.viscous_nm_s_per_rad
            }),
            motor_coulomb_nm: by_motor(&|i| {
                let coulomb = drives[i].motor_friction.coulomb_nm;
                ratio(i).map_or(coulomb, |ratio| coulomb * ratio.abs())
            }),
            payload_kg: simulation.payloads().iter().map(|p| p.mass_kg).sum(),
            payloads: simulation
                .payloads()
                .iter()
                .map(|p| Load {
                    link: p.link.clone(),
                    mass_kg: p.mass_kg,
                    com_m: p.com_m,
                    attach_s: p.attach_s,
                    release_s: p.release_s.is_finite().then_some(p.release_s),
                })
                .collect(),
            contact_fraction: touched / duration_s,
            contacts: contacts.iter().map(touch).collect(),
            temperature_change_k: simulation.temperature().change_k,
            frames: counts.into(),
        }
    }
}

fn touch(c: &Contact) -> Touch {
    Touch {
        start_s: c.start_s,
        duration_s: c.duration_s,
        link: c.link.clone(),
        point_m: c.point_m,
        force_n: c.force_n,
    }
}

/// Tendons of a robot with routings.
fn true_tendons(simulation: &Simulation) -> Vec<TrueTendon> {
    let Some(routings) = simulation.routings() else {
        return Vec::new();
    };
    let joints = simulation.joint_names();
    let tendons = (0..simulation.axes()).filter(|i| simulation.has_tendon(*i));
    let of = |i: usize| TrueTendon {
        name: simulation.tendon_names()[i].clone(),
        joint: joints[routings.joint(i)].clone(),
        motor: simulation.motor_names()[i].clone(),
        drive_ratio: routings.drive_ratio(i),
        moment_arms: (joints.iter().cloned())
            .zip(routings.moment_arms(i).iter().copied())
            .filter(|(_, arm)| *arm != 0.0)
            .collect(),
        pretension_nm: (simulation.paths())
            .is_some_and(|paths| paths.is_strand(i))
            .then(|| simulation.drives()[i].pretension_nm),
    };
    tendons.map(of).collect()
}

/// Offset of tendon `i` over time: an even grid and both sides of every corner, without the points
/// that lie on a straight line anyway.
fn profile(simulation: &Simulation, i: usize, duration_s: f64) -> Vec<[f64; 2]> {
    let value = |t: f64| simulation.offset_at(i, t).sum();
    // Just before a step; far below a sample.
    const BEFORE_S: f64 = 1e-6;
    let mut times: Vec<f64> = (0..=PROFILE_POINTS)
        .map(|k| duration_s * f64::from(k) / f64::from(PROFILE_POINTS))
        .collect();
    let moving = |o: &&SampledOffset| simulation.weight(o, i) != 0.0;
    for o in simulation.offsets().iter().filter(moving) {
        for corner in o.shape.corners() {
            times.extend([corner - BEFORE_S, corner]);
        }
    }
    times.retain(|t| (0.0..=duration_s).contains(t));
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut points: Vec<[f64; 2]> = Vec::new();
    for t in times {
        let point = [t, value(t)];
        if let [.., a, b] = points[..] {
            let straight = a[1] + (point[1] - a[1]) * (b[0] - a[0]) / (t - a[0]);
            // A nanoradian is negligible.
            if (straight - b[1]).abs() < 1e-9 {
                points.pop();
            }
        }
        points.push(point);
    }
    points
}
