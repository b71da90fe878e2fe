//! What happens to the demonstration's arms, by their civil clock.

use super::creep::Creep;
use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_rope::Catalogue;

/// An event of a tendon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sudden {
    /// When, s after the demonstration began; negative: before.
    pub time_s: f64,
    /// By how much its offset grows, rad.
    pub offset_rad: f64,
    /// By what share its stiffness falls.
    pub stiffness_lost: f64,
}

/// A tendon's life.
#[derive(Debug, Clone)]
pub struct Life {
    /// Joint.
    pub joint: String,
    /// When it was tensioned, s after the demonstration began: negative; the first with a new rope.
    pub tensioned_s: Vec<f64>,
    /// Sudden changes.
    pub sudden: Vec<Sudden>,
    /// Creep of this rope over that of the catalogue's: no two are alike.
    pub pace: f64,
    creep: Creep,
}

/// An arm's life.
#[derive(Debug, Clone)]
pub struct Arm {
    /// Name.
    pub name: &'static str,
    /// Whether it is heard; else it is switched off.
    pub on: bool,
    /// Days of records before the demonstration.
    pub days: u32,
    /// Tendons, by the robot's joints.
    pub lives: Vec<Life>,
}

/// The arms.
pub fn arms(robot: &Robot, catalogue: &Catalogue) -> Vec<Arm> {
    let life = |joint: &str, days: &[f64], pace: f64, sudden: &[Sudden]| {
        let i = robot.arm.joint_index(joint)?;
        let tendon = robot.transmissions.get(i)?.as_ref()?.tendon.as_ref()?;
        Some(Life {
            joint: joint.into(),
            tensioned_s: days.iter().map(|day| -DAY_S * day).collect(),
            sudden: sudden.to_vec(),
            pace,
            creep: Creep::of(tendon, catalogue)?,
        })
    };
    let sudden = |time_s, offset_rad, stiffness_lost| Sudden {
        time_s,
        offset_rad,
        stiffness_lost,
    };
    // A strand fails after three minutes, which are seven and a half of its days.
    let fails = [sudden(180.0 * super::RATE, 3.5e-3, 0.12)];
    let slipped = [sudden(-30.3 * DAY_S, 2.4e-3, 0.0)];
    let arm = |name, on, days, lives: [Option<Life>; 4]| Arm {
        name,
        on,
        days,
        lives: lives.into_iter().flatten().collect(),
    };
    // New ropes are tensioned again once they have bedded in, and then whenever their limit is passed.
    vec![
        arm(
            "demo-1",
            true,
            200,
            [
                life("shoulder_yaw", &[200.0, 188.0, 75.0], 0.9, &[]),
                life("shoulder_pitch", &[200.0, 188.0, 90.0], 1.1, &[]),
                life("elbow", &[200.0, 188.0, 42.0], 1.0, &fails),
                life("wrist", &[200.0, 188.0, 60.0], 0.9, &slipped),
            ],
        ),
        arm(
            "demo-2",
            true,
            120,
            [
                life("shoulder_yaw", &[120.0, 110.0], 0.6, &[]),
                life("shoulder_pitch", &[120.0, 110.0, 31.0], 0.8, &[]),
                life("elbow", &[120.0, 110.0], 0.7, &[]),
                life("wrist", &[120.0, 110.0], 0.6, &[]),
            ],
        ),
        arm(
            "demo-3",
            false,
            60,
            [
                life("shoulder_yaw", &[60.0, 50.0], 0.9, &[]),
                life("shoulder_pitch", &[60.0, 50.0], 0.9, &[]),
                life("elbow", &[60.0, 50.0], 0.8, &[]),
                life("wrist", &[60.0, 50.0], 0.8, &[]),
            ],
        ),
    ]
}

impl Life {
    /// When it was last tensioned by then, s after the demonstration began.
    pub fn since_s(&self, time_s: f64) -> f64 {
        let before = self.tensioned_s.iter().copied().filter(|t| *t <= time_s);
        before.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Offset since the last tensioning, rad. Tensioning takes it away; the rope creeps on as old as it is.
    pub fn offset_rad(&self, time_s: f64) -> f64 {
        let new_s = self.tensioned_s.first().copied().unwrap_or(0.0);
        let since_s = self.since_s(time_s);
        let crept = self.creep.offset_rad(time_s - new_s) - self.creep.offset_rad(since_s - new_s);
        let sudden = self
            .sudden
            .iter()
            .filter(|s| s.time_s > since_s && s.time_s <= time_s);
        self.pace * crept + sudden.map(|s| s.offset_rad).sum::<f64>()
    }

    /// What earlier tensionings took away, since the rope was new, rad.
    pub fn before_rad(&self, time_s: f64) -> f64 {
        let new_s = self.tensioned_s.first().copied().unwrap_or(0.0);
        let since_s = self.since_s(time_s);
        let sudden = self.sudden.iter().filter(|s| s.time_s <= since_s);
        self.pace * self.creep.offset_rad(since_s - new_s)
            + sudden.map(|s| s.offset_rad).sum::<f64>()
    }

    /// Stiffness over that of the whole rope.
    pub fn stiffness_factor(&self, time_s: f64) -> f64 {
        let lost = self.sudden.iter().filter(|s| s.time_s <= time_s);
        lost.map(|s| 1.0 - s.stiffness_lost).product()
    }
}
