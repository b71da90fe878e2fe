//! What happens to the demonstration's arms, by their civil clock: times are s after the demonstration began.

use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_rope::Catalogue;
use sinew_rope::law::{Law, RopeLoad, State};

/// Name of an arm, whether it is heard (else it is switched off), days of records before the demonstration; and of each
/// tendon the joint, the days before the demonstration on which it was tensioned, and its creep over that of the
/// catalogue's rope. New ropes are tensioned again once they have bedded in, and then whenever their limit is passed.
type Told = (
    &'static str,
    bool,
    u32,
    [(&'static str, &'static [f64], f64); 4],
);

#[rustfmt::skip]
const ARMS: [Told; 3] = [
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

/// Sudden changes: a strand that fails after three minutes, which are seven and a half days, and a slip of a month before.
/// Arm, joint, time (s), growth of the offset (rad), share of the stiffness that is lost.
const SUDDEN: [(&str, &str, f64, f64, f64); 2] = [
    ("demo-1", "elbow", 180.0 * super::RATE, 3.5e-3, 0.12),
    ("demo-1", "wrist", -30.3 * DAY_S, 2.4e-3, 0.0),
];

/// What the ropes carry on average, over their pretension.
const WORK: f64 = 2.0;
/// Temperature of the ropes beside the motors, °C.
const CELSIUS: f64 = 28.0;
/// Creep is looked up in a table with so many points to a decade of time.
const PER_DECADE: usize = 24;
/// From an hour on: what is younger has crept before the baseline.
const FIRST_S: f64 = 3600.0;
/// Up to some thirty years.
const DECADES: usize = 6;

/// An arm's life.
#[derive(Debug, Clone)]
pub(super) struct Arm {
    pub(super) name: &'static str,
    /// Whether it is heard; else it is switched off.
    pub(super) on: bool,
    /// Days of records before the demonstration.
    pub(super) days: u32,
    /// Its tendons, in the order of the robot's joints.
    pub(super) lives: Vec<Life>,
}

/// A tendon's life.
#[derive(Debug, Clone)]
pub(super) struct Life {
    pub(super) joint: &'static str,
    pub(super) tendon: Tendon,
    /// When it was tensioned, s: negative; the first with a new rope.
    pub(super) tensioned_s: Vec<f64>,
    /// Sudden changes: time (s), growth of the offset (rad), share of the stiffness that is lost.
    sudden: Vec<(f64, f64, f64)>,
    /// Creep of this rope over that of the catalogue's: no two are alike.
    pace: f64,
    /// Offset by creep at times since the rope was new that rise by a constant factor, rad.
    creep_rad: Vec<f64>,
}

/// Makes the demonstration's arms.
pub(super) fn arms(robot: &Robot, catalogue: &Catalogue) -> Vec<Arm> {
    let arm = |(name, on, days, tendons): Told| {
        let life = |(joint, days, pace): (&'static str, &[f64], f64)| {
            let i = robot.arm.joint_index(joint)?;
            let tendon = robot.transmissions.get(i)?.as_ref()?.tendon.clone()?;
            let own = SUDDEN.iter().filter(|s| (s.0, s.1) == (name, joint));
            Some(Life {
                joint,
                tensioned_s: days.iter().map(|day| -DAY_S * day).collect(),
                sudden: own.map(|s| (s.2, s.3, s.4)).collect(),
                pace,
                creep_rad: creep(&tendon, catalogue)?,
                tendon,
            })
        };
        Arm {
            name,
            on,
            days,
            lives: tendons.into_iter().filter_map(life).collect(),
        }
    };
    ARMS.map(arm).into()
}

/// Offset of a tendon by the rope law, under what its rope carries; `None`: the rope isn't in the catalogue.
fn creep(tendon: &Tendon, catalogue: &Catalogue) -> Option<Vec<f64>> {
    let rope = catalogue.find(tendon.rope.as_deref()?).ok()?;
    let law = Law::new(rope.entry.parameters().ok()?).ok()?;
    let load = RopeLoad::celsius(WORK * tendon.pretension_n?, CELSIUS);
    let mut state = State::default();
    let (mut time_s, mut first) = (0.0, None);
    let points = (0..=DECADES * PER_DECADE).map(|i| {
        let next_s = FIRST_S * 10_f64.powf(i as f64 / PER_DECADE as f64);
        law.hold(&mut state, load, next_s - time_s).ok()?;
        time_s = next_s;
        let percent = law.strain(&state, load).ok()?.total_percent();
        let since = percent - *first.get_or_insert(percent);
        Some(0.01 * since * tendon.length_m / tendon.joint_pulley_radius_m)
    });
    points.collect()
}

impl Life {
    /// Offset by creep at a time, rad, since the rope was new.
    fn crept_rad(&self, time_s: f64) -> f64 {
        let age_s = time_s - self.tensioned_s.first().copied().unwrap_or(0.0);
        let at = PER_DECADE as f64 * (age_s / FIRST_S).max(1.0).log10();
        let below = (at.floor() as usize).min(self.creep_rad.len().saturating_sub(2));
        let [a, b] = [self.creep_rad[below], self.creep_rad[below + 1]];
        self.pace * (a + (b - a) * (at - below as f64).clamp(0.0, 1.0))
    }

    /// When it was last tensioned by then, s.
    pub(super) fn since_s(&self, time_s: f64) -> f64 {
        let before = self.tensioned_s.iter().copied().filter(|t| *t <= time_s);
        before.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Growth by sudden changes after `from_s` and up to `to_s`, rad.
    fn jumped_rad(&self, from_s: f64, to_s: f64) -> f64 {
        let within = (self.sudden.iter()).filter(|s| s.0 > from_s && s.0 <= to_s);
        within.map(|s| s.1).sum()
    }

    /// Offset since the last tensioning, rad. Tensioning takes it away; the rope creeps on as old as it is.
    pub(super) fn offset_rad(&self, time_s: f64) -> f64 {
        let since_s = self.since_s(time_s);
        self.crept_rad(time_s) - self.crept_rad(since_s) + self.jumped_rad(since_s, time_s)
    }

    /// What earlier tensionings took away, since the rope was new, rad.
    pub(super) fn before_rad(&self, time_s: f64) -> f64 {
        let since_s = self.since_s(time_s);
        self.crept_rad(since_s) + self.jumped_rad(f64::NEG_INFINITY, since_s)
    }

    /// Stiffness over that of the whole rope.
    pub(super) fn stiffness_factor(&self, time_s: f64) -> f64 {
        let lost = self.sudden.iter().filter(|s| s.0 <= time_s);
        lost.map(|s| 1.0 - s.2).product()
    }
}
