//! Simulated events of the demonstration's arms by their civil clock; times are in s since the start of the
//! demonstration.

use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_rope::Catalogue;
use sinew_rope::law::{Law, RopeLoad, State};

/// Name of an arm, whether it is switched on, days of records before the demonstration; for each tendon the joint,
/// the days before the demonstration on which it was tensioned, and its creep relative to the rope of the catalogue.
/// New ropes are re-tensioned after bedding-in, and then whenever their limit is exceeded.
type ArmSpec = (
    &'static str,
    bool,
    u32,
    [(&'static str, &'static [f64], f64); 4],
);

#[rustfmt::skip]
const ARMS: [ArmSpec; 3] = [
    ("demo-1", true, 200, [
        ("shoulder_yaw", &[200.0, 188.0, 75.0], 0.9), ("shoulder_pitch", &[200.0, 188.0, 90.0], 1.1),
        ("elbow", &[200.0, 188.0, 42.0], 1.0), ("wrist", &[200.0, 188.0, 60.0], 0.9),
    ]),
    ("demo-2", true, 120, [
        ("shoulder_yaw", &[120.0, 110.0], 0.6), ("shoulder_pitch", &[120.0, 110.0, 31.0], 0.8),
        ("elbow", &[120.0, 110.0], 0.7), ("wrist", &[120.0, 110.0], 0.6),
    ]),
    ("demo-3", false, 60, [
        ("shoulder_yaw", &[60.0, 50.0], 0.9), ("shoulder_pitch", &[60.0, 50.0], 0.9),
        ("elbow", &[60.0, 50.0], 0.8), ("wrist", &[60.0, 50.0], 0.8),
    ]),
];

/// Simulated step changes: a strand failure after three minutes, which are 7.5 simulated days, and a slip one month
/// before. Arm, joint, time (s), increase of the offset (rad), relative loss of stiffness.
const STEP_CHANGES: [(&str, &str, f64, f64, f64); 2] = [
    ("demo-1", "elbow", 180.0 * super::RATE, 3.5e-3, 0.12),
    ("demo-1", "wrist", -30.3 * DAY_S, 2.4e-3, 0.0),
];

/// Duration of a step change, s of the civil clock: the motor moves on the rope with finite acceleration, within about a
/// quarter of the period 2π√(0.06 kg m²/20 Nm/rad) = 0.34 s.
const STEP_S: f64 = 0.1 * super::RATE;

/// Mean load of the ropes relative to their pretension.
const MEAN_LOAD_RATIO: f64 = 2.0;
/// Temperature of the ropes near the motors, °C.
const ROPE_TEMPERATURE_C: f64 = 28.0;
/// Points per decade of time in the table of creep.
const POINTS_PER_DECADE: usize = 24;
/// First time of the table, s: earlier creep precedes the baseline.
const FIRST_S: f64 = 3600.0;
/// Decades of time in the table, up to about 30 years.
const DECADES: usize = 6;

/// Simulated arm with its tendons.
#[derive(Debug, Clone)]
pub(super) struct Arm {
    pub(super) name: &'static str,
    /// Whether the arm is switched on.
    pub(super) on: bool,
    /// Days of records before the demonstration.
    pub(super) days: u32,
    /// Tendons in the order of the robot's joints.
    pub(super) tendons: Vec<SimulatedTendon>,
}

/// Simulated tendon with its events.
#[derive(Debug, Clone)]
pub(super) struct SimulatedTendon {
    pub(super) joint: &'static str,
    pub(super) tendon: Tendon,
    /// Times of tensioning, s, negative; the first with a new rope.
    pub(super) tensioned_s: Vec<f64>,
    /// Step changes: time (s), increase of the offset (rad), relative loss of stiffness.
    step_changes: Vec<(f64, f64, f64)>,
    /// Creep of this rope relative to that of the catalogue.
    creep_factor: f64,
    /// Offset by creep, rad, at geometrically spaced times since the rope was new.
    creep_rad: Vec<f64>,
}

/// Creates the arms of the demonstration.
pub(super) fn arms(robot: &Robot, catalogue: &Catalogue) -> Vec<Arm> {
    let arm = |(name, on, days, tendons): ArmSpec| {
        let life = |(joint, days, creep_factor): (&'static str, &[f64], f64)| {
            let i = robot.arm.joint_index(joint)?;
            let tendon = robot.transmissions.get(i)?.as_ref()?.tendon.clone()?;
            let own = STEP_CHANGES.iter().filter(|s| (s.0, s.1) == (name, joint));
            Some(SimulatedTendon {
                joint,
                tensioned_s: days.iter().map(|day| -DAY_S * day).collect(),
                step_changes: own.map(|s| (s.2, s.3, s.4)).collect(),
                creep_factor,
                creep_rad: creep(&tendon, catalogue)?,
                tendon,
            })
        };
        Arm {
            name,
            on,
            days,
            tendons: tendons.into_iter().filter_map(life).collect(),
        }
    };
    ARMS.map(arm).into()
}

/// Computes the offset of a tendon by the creep law under its mean load; `None`: the rope is not in the catalogue.
fn creep(tendon: &Tendon, catalogue: &Catalogue) -> Option<Vec<f64>> {
    let rope = catalogue.find(tendon.rope.as_deref()?).ok()?;
    let law = Law::new(rope.entry.parameters().ok()?).ok()?;
    let load = RopeLoad::celsius(MEAN_LOAD_RATIO * tendon.pretension_n?, ROPE_TEMPERATURE_C);
    let mut state = State::default();
    let (mut time_s, mut first) = (0.0, None);
    let points = (0..=DECADES * POINTS_PER_DECADE).map(|i| {
        let next_s = FIRST_S * 10_f64.powf(i as f64 / POINTS_PER_DECADE as f64);
        law.hold(&mut state, load, next_s - time_s).ok()?;
        time_s = next_s;
        let percent = law.strain(&state, load).ok()?.total_percent();
        let since = percent - *first.get_or_insert(percent);
        Some(0.01 * since * tendon.length_m / tendon.joint_pulley_radius_m)
    });
    points.collect()
}

impl SimulatedTendon {
    /// Offset by creep at a time, rad, since the rope was new.
    fn crept_rad(&self, time_s: f64) -> f64 {
        let age_s = time_s - self.tensioned_s.first().copied().unwrap_or(0.0);
        let at = POINTS_PER_DECADE as f64 * (age_s / FIRST_S).max(1.0).log10();
        let below = (at.floor() as usize).min(self.creep_rad.len().saturating_sub(2));
        let [a, b] = [self.creep_rad[below], self.creep_rad[below + 1]];
        self.creep_factor * (a + (b - a) * (at - below as f64).clamp(0.0, 1.0))
    }

    /// Time of the last tensioning before `time_s`, s.
    pub(super) fn since_s(&self, time_s: f64) -> f64 {
        let before = self.tensioned_s.iter().copied().filter(|t| *t <= time_s);
        before.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Increase of the offset by step changes after `from_s` and up to `to_s`, rad.
    fn step_rad(&self, from_s: f64, to_s: f64) -> f64 {
        let within = (self.step_changes.iter()).filter(|s| s.0 > from_s && s.0 <= to_s);
        within.map(|s| s.1 * completed(to_s - s.0)).sum()
    }

    /// Offset since the last tensioning, rad. Tensioning removes it; the rope continues to creep at its age.
    pub(super) fn offset_rad(&self, time_s: f64) -> f64 {
        let since_s = self.since_s(time_s);
        self.crept_rad(time_s) - self.crept_rad(since_s) + self.step_rad(since_s, time_s)
    }

    /// Offset removed by earlier tensionings since the rope was new, rad.
    pub(super) fn before_rad(&self, time_s: f64) -> f64 {
        let since_s = self.since_s(time_s);
        self.crept_rad(since_s) + self.step_rad(f64::NEG_INFINITY, since_s)
    }

    /// Stiffness relative to that of the intact rope.
    pub(super) fn stiffness_factor(&self, time_s: f64) -> f64 {
        let lost = self.step_changes.iter().filter(|s| s.0 <= time_s);
        let factor = |s: &(f64, f64, f64)| 1.0 - s.2 * completed(time_s - s.0);
        lost.map(factor).product()
    }
}

/// Completed share of a step change `since_s` after its start, with continuous velocity.
fn completed(since_s: f64) -> f64 {
    let x = (since_s / STEP_S).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
