//! Modification of the recorded motion in the demonstration: the motors turn further as the ropes creep.

use super::arms::SimulatedTendon;
use sinew_log::decode::{Field, MessageKind, rewrite};
use sinew_transport::replay::Alter;
use std::collections::HashMap;

/// Additional encoder noise of a motor, rad, so that no two repetitions are identical.
const NOISE_RAD: f64 = 1.0e-4;
/// Encoder error of an arm that is constant for a day, rad.
const DAILY_RAD: f64 = 0.8e-4;

/// Modifier of the messages of one arm.
pub(super) struct Crept {
    tendons: Vec<SimulatedTendon>,
    rate: f64,
    q: HashMap<Vec<u8>, f64>,
    random: Random,
    /// Present day and its errors.
    day: i64,
    daily: Vec<f64>,
}

impl Crept {
    /// Creates the modifier of an arm with these tendons; `rate` is the speed of its civil clock.
    pub(super) fn new(tendons: Vec<SimulatedTendon>, rate: f64, seed: u64) -> Self {
        let daily = vec![0.0; tendons.len()];
        Self {
            tendons,
            rate,
            q: HashMap::new(),
            random: Random(seed),
            day: i64::MIN,
            daily,
        }
    }
}

impl Alter for Crept {
    fn alter(&mut self, _topic: &str, schema: &str, since_start_s: f64, cdr: &mut [u8]) {
        let Some(kind) = MessageKind::of_schema(schema) else {
            return;
        };
        let time_s = self.rate * since_start_s;
        let day = (time_s / 86_400.0).floor() as i64;
        if day != std::mem::replace(&mut self.day, day) {
            self.daily.fill_with(|| DAILY_RAD * self.random.normal());
        }
        // A message that cannot be decoded is played unchanged.
        let _as_it_is = rewrite(kind, cdr, |entry, value| match entry.field {
            Field::Position if kind == MessageKind::JointState => {
                self.q.insert(entry.joint.to_vec(), value);
                value
            }
            Field::Interface(b"motor_position") => {
                let mut joints = self.tendons.iter().map(|life| life.joint.as_bytes());
                let at = joints.position(|joint| joint == entry.joint);
                let (Some(at), Some(q)) = (at, self.q.get(entry.joint)) else {
                    return value;
                };
                let life = &self.tendons[at];
                let deflection = (value - q) / life.stiffness_factor(time_s);
                let noise = NOISE_RAD * self.random.normal() + self.daily[at];
                q + deflection + life.offset_rad(time_s) + noise
            }
            _ => value,
        });
    }
}

/// Pseudo-random generator SplitMix64 (Steele, Lea, Flood 2014).
pub(super) struct Random(pub(super) u64);

impl Random {
    /// Returns a uniform value between 0 and 1.
    pub(super) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a standard normal value (sum of twelve uniform values, sufficient for an encoder).
    pub(super) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
