//! Synthetic arm of four joints: its true parameters, its motion, and its measured values.

use sinew_model::Gaussian;
use sinew_model::arm::{Arm, ArmWorkspace, BodyInertia};
use sinew_model::correction::{JointCorrection, SetPoint};
use sinew_model::robot::{Robot, RobotFile};

/// Joints of the arm.
pub(crate) const N: usize = 4;
pub(crate) const DT_S: f64 = 0.004;
pub(crate) const LASTS_S: f64 = 72.0;
/// Encoders of 16 bits.
const STEP_RAD: f64 = core::f64::consts::TAU / 65_536.0;

/// True parameters of a recording.
#[derive(Clone, Copy)]
pub(crate) struct Truth {
    pub(crate) seed: u64,
    /// Amplitude of the moves relative to the usual one.
    pub(crate) reach: f64,
    pub(crate) offset_rad: [f64; N],
    pub(crate) stiffness_factor: [f64; N],
    /// Joint, time and size of a slip.
    pub(crate) slip: Option<(usize, f64, f64)>,
    /// Joint and time of a failed strand, and what stiffness is left.
    pub(crate) strand: Option<(usize, f64, f64)>,
    /// Mass in the gripper from a time on, kg.
    pub(crate) load: Option<(f64, f64)>,
    /// Force at the tool, N.
    pub(crate) force_n: [f64; 3],
    /// A push of 20 N sideways for a second.
    pub(crate) push_at_s: Option<f64>,
    pub(crate) creep_rad_per_s: f64,
    pub(crate) motor_torque: bool,
    pub(crate) temperature_c: [f64; 2],
}

pub(crate) const CALM: Truth = Truth {
    seed: 1,
    reach: 1.0,
    offset_rad: [0.0; N],
    stiffness_factor: [1.06, 0.93, 1.02, 0.9],
    slip: None,
    strand: None,
    load: None,
    force_n: [0.0; 3],
    push_at_s: None,
    creep_rad_per_s: 0.0,
    motor_torque: true,
    temperature_c: [21.0, 22.0],
};

pub(crate) const STRETCHED_RAD: [f64; N] = [4e-3, -3e-3, 5e-3, 1.5e-3];

/// Numbers without a pattern in −1..1, the same on every machine.
fn random(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

pub(crate) fn robot() -> Robot {
    let text = include_str!("../../robots/biorob-like/robot.toml");
    let urdf = include_str!("../../robots/biorob-like/biorob-like.urdf");
    let file = RobotFile::parse(text, "robot.toml").expect("a robot file");
    file.build(urdf).expect("a robot")
}

/// From pose to pose, each move 1.4 s without jerk at its ends, then 0.8 s of rest: position, speed and acceleration.
pub(crate) struct Motion(Vec<[f64; N]>);

impl Motion {
    const MOVE_S: f64 = 1.4;
    const EACH_S: f64 = 2.2;

    pub(crate) fn new(mut seed: u64, share: f64) -> Self {
        let poses = (LASTS_S / Self::EACH_S) as usize + 2;
        let middle = [0.0, 0.8, 1.0, 0.0];
        let reach = [1.6, 0.8, 0.9, 1.0].map(|rad| rad * share);
        let pose = |_| core::array::from_fn(|i| middle[i] + reach[i] * random(&mut seed));
        Self((0..poses).map(pose).collect())
    }

    fn at(&self, time_s: f64) -> [[f64; N]; 3] {
        let k = (time_s / Self::EACH_S) as usize;
        let s = ((time_s - k as f64 * Self::EACH_S) / Self::MOVE_S).min(1.0);
        let (from, to) = (self.0[k], self.0[k + 1]);
        let way = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        let speed = 30.0 * s * s * (1.0 - s) * (1.0 - s) / Self::MOVE_S;
        let faster = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (Self::MOVE_S * Self::MOVE_S);
        let of = |share: f64, from: &[f64; N], to: &[f64; N], base: f64| {
            core::array::from_fn(|i| base * from[i] + share * (to[i] - from[i]))
        };
        [
            of(way, &from, &to, 1.0),
            of(speed, &from, &to, 0.0),
            of(faster, &from, &to, 0.0),
        ]
    }
}

/// A sample: positions in counts of the encoders, torques of motors and springs, and external forces.
pub(crate) struct Measured {
    pub(crate) q: [f64; N],
    pub(crate) dq: [f64; N],
    pub(crate) theta: [f64; N],
    pub(crate) tau_m: [f64; N],
    pub(crate) tau_el: [f64; N],
    pub(crate) pushed: [f64; N],
}

/// An arm as it truly is, with nothing in its gripper or something.
pub(crate) struct Plant<'a> {
    robot: &'a Robot,
    truth: Truth,
    hands: [SetPoint; 2],
    ws: ArmWorkspace,
    /// Motor positions less offsets of the last two samples, rad.
    before: [[f64; N]; 2],
    noise: u64,
}

impl<'a> Plant<'a> {
    pub(crate) fn new(robot: &'a Robot, truth: Truth) -> Self {
        let held = BodyInertia::point(truth.load.map_or(0.0, |(_, kg)| kg), [0.01, 0.02, 0.03]);
        let loaded = robot.arm.with_payload("tool", held);
        let loaded = loaded.expect("a body").expect("a tool");
        let corrections = Self::corrections(truth.stiffness_factor);
        let hand = |arm: &Arm| {
            SetPoint::new(arm, &robot.transmissions, &corrections).expect("as described")
        };
        Self {
            hands: [hand(&robot.arm), hand(&loaded)],
            ws: ArmWorkspace::new(&robot.arm),
            before: [[f64::NAN; N]; 2],
            noise: truth.seed,
            robot,
            truth,
        }
    }

    fn corrections(factor: [f64; N]) -> Vec<JointCorrection> {
        let of = |factor: f64| JointCorrection {
            stiffness_factor: Gaussian::new(factor, 0.0),
            ..JointCorrection::default()
        };
        factor.map(of).to_vec()
    }

    fn factor(&self, time_s: f64) -> [f64; N] {
        let mut factor = self.truth.stiffness_factor;
        if let Some((joint, at_s, left)) = self.truth.strand
            && time_s >= at_s
        {
            factor[joint] *= left;
        }
        factor
    }

    fn offset_rad(&self, time_s: f64) -> [f64; N] {
        let mut offset = self.truth.offset_rad;
        if let Some((joint, at_s, rad)) = self.truth.slip
            && time_s >= at_s
        {
            offset[joint] += rad;
        }
        offset.map(|rad| rad + self.truth.creep_rad_per_s * time_s)
    }

    fn pushed_nm(&mut self, time_s: f64, q: &[f64; N]) -> [f64; N] {
        let mut tau = [0.0; N];
        let mut force_n = self.truth.force_n;
        if let Some(at_s) = self.truth.push_at_s
            && (at_s..at_s + 1.0).contains(&time_s)
        {
            force_n[1] += 20.0;
        }
        self.robot
            .arm
            .add_point_force(&mut self.ws, q, "tool", [0.0; 3], force_n, &mut tau)
            .expect("a tool");
        tau
    }

    /// Returns the measured values at a time.
    pub(crate) fn sample(&mut self, time_s: f64, motion: &Motion) -> Measured {
        let [q, dq, ddq] = motion.at(time_s);
        let pushed = self.pushed_nm(time_s, &q);
        let factor = self.factor(time_s);
        let is_loaded = self.truth.load.is_some_and(|(at_s, _)| time_s >= at_s);
        let hand = &mut self.hands[usize::from(is_loaded)];
        for (i, correction) in Self::corrections(factor).iter().enumerate() {
            hand.set(i, correction).expect("a stiffness");
        }
        let theta = hand.follow(&q, &dq, &ddq, Some(&pushed)).expect("a pose");
        let theta: [f64; N] = core::array::from_fn(|i| theta[i]);
        let tau_el = core::array::from_fn(|i| hand.tau_el()[i]);
        let offset = self.offset_rad(time_s);
        let motor = core::array::from_fn(|i| self.motor_nm(i, factor[i], theta[i], q[i]));
        self.before = [theta, self.before[0]];
        let counts = |rad: f64| (rad / STEP_RAD).round() * STEP_RAD;
        Measured {
            q: q.map(counts),
            dq,
            theta: core::array::from_fn(|i| counts(theta[i] + offset[i])),
            tau_m: motor,
            tau_el,
            pushed,
        }
    }

    /// Torque of a motor: that of the spring, of its own inertia, of its friction, and noise.
    fn motor_nm(&mut self, i: usize, factor: f64, theta: f64, q: f64) -> f64 {
        let transmission = self.robot.transmissions[i].as_ref().expect("a tendon");
        let [last, before] = [self.before[0][i], self.before[1][i]];
        if !(self.truth.motor_torque && before.is_finite()) {
            return f64::NAN;
        }
        let speed = (theta - last) / DT_S;
        let faster = (theta - 2.0 * last + before) / (DT_S * DT_S);
        let friction = transmission.motor_friction;
        let rubs = match speed.abs() {
            stands if stands < 1e-6 => 0.0,
            _ => friction.coulomb_nm * speed.signum() + friction.viscous_nm_s_per_rad * speed,
        };
        factor * transmission.stiffness_nm_per_rad * (theta - q)
            + transmission.motor_inertia_kg_m2.unwrap_or_default() * faster
            + rubs
            + 0.02 * random(&mut self.noise)
    }
}
