//! What the estimators say of five recordings of one arm, number by number.
//!
//! Other tests hold against closed forms, truths and identities, with tolerances of some standard deviations.

use crate::answers::Answers;
use sinew_model::Gaussian;
use sinew_model::arm::{Arm, ArmWorkspace, BodyInertia};
use sinew_model::correction::{JointCorrection, SetPoint};
use sinew_model::offset::alike::{learn_type, pool_bodies};
use sinew_model::offset::misfit::tempered;
use sinew_model::offset::{
    Belief, Block, ExternalForce, FeatureConfig, FeatureObserver, MapEstimate, MapEstimator,
    Payload, Prior, RecursiveOffsets, SearchScope, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD,
    beliefs, shared_errors,
};
use sinew_model::robot::{Robot, RobotFile};

/// Joints of the arm.
const N: usize = 4;
const DT_S: f64 = 0.004;
const LASTS_S: f64 = 72.0;
/// Encoders of 16 bits.
const STEP_RAD: f64 = core::f64::consts::TAU / 65_536.0;

/// What is true of a recording.
#[derive(Clone, Copy)]
struct Truth {
    seed: u64,
    offset_rad: [f64; N],
    stiffness_factor: [f64; N],
    /// Joint, time and size of a slip.
    slip: Option<(usize, f64, f64)>,
    /// Joint and time of a failed strand, and what stiffness is left.
    strand: Option<(usize, f64, f64)>,
    /// Mass in the gripper from a time on, kg.
    load: Option<(f64, f64)>,
    /// Force at the tool, N.
    force_n: [f64; 3],
    /// A push of 20 N sideways for a second.
    push_at_s: Option<f64>,
    creep_rad_per_s: f64,
    motor_torque: bool,
    temperature_c: [f64; 2],
}

const CALM: Truth = Truth {
    seed: 1,
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

const STRETCHED_RAD: [f64; N] = [4e-3, -3e-3, 5e-3, 1.5e-3];

/// Numbers without a pattern in −1..1, the same on every machine.
fn random(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn robot() -> Robot {
    let text = include_str!("../../../../robots/biorob-like/robot.toml");
    let urdf = include_str!("../../../../robots/biorob-like/biorob-like.urdf");
    let file = RobotFile::parse(text, "robot.toml").expect("a robot file");
    file.build(urdf).expect("a robot")
}

/// From pose to pose, each move 1.4 s without jerk at its ends, then 0.8 s of rest: position, speed and acceleration.
struct Motion(Vec<[f64; N]>);

impl Motion {
    const MOVE_S: f64 = 1.4;
    const EACH_S: f64 = 2.2;

    fn new(mut seed: u64) -> Self {
        let poses = (LASTS_S / Self::EACH_S) as usize + 2;
        let middle = [0.0, 0.8, 1.0, 0.0];
        let reach = [1.6, 0.8, 0.9, 1.0];
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

/// An arm as it truly is, with nothing in its gripper or something.
struct Plant<'a> {
    robot: &'a Robot,
    truth: Truth,
    hands: [SetPoint; 2],
    ws: ArmWorkspace,
    /// Motor positions less offsets of the last two samples, rad.
    before: [[f64; N]; 2],
    noise: u64,
}

impl<'a> Plant<'a> {
    fn new(robot: &'a Robot, truth: Truth) -> Self {
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

    /// Joint positions, motor positions and motor torques as they are measured.
    fn sample(&mut self, time_s: f64, motion: &Motion) -> [[f64; N]; 3] {
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
        let offset = self.offset_rad(time_s);
        let motor = core::array::from_fn(|i| self.motor_nm(i, factor[i], theta[i], q[i]));
        self.before = [theta, self.before[0]];
        let counts = |rad: f64| (rad / STEP_RAD).round() * STEP_RAD;
        [
            q.map(counts),
            core::array::from_fn(|i| counts(theta[i] + offset[i])),
            motor,
        ]
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

fn record(robot: &Robot, truth: Truth) -> Vec<Block> {
    let mut features = FeatureObserver::new(&robot.arm, FeatureConfig::default());
    let motion = Motion::new(truth.seed);
    let mut plant = Plant::new(robot, truth);
    let mut blocks = Vec::new();
    let [from_c, to_c] = truth.temperature_c;
    for k in 0..(LASTS_S / DT_S) as usize {
        let time_s = k as f64 * DT_S;
        let [q, theta, motor] = plant.sample(time_s, &motion);
        let celsius = from_c + (to_c - from_c) * time_s / LASTS_S;
        if features.step(DT_S, &q, &theta, &motor, celsius) == Ok(true) {
            blocks.push(features.block().clone());
        }
    }
    blocks
}

fn estimator(robot: &Robot, force_n: f64) -> MapEstimator {
    let at = robot.arm.body(N - 1).expect("a hand").com.map(|c| 1.5 * c);
    let prior = Prior::new(
        &robot.arm,
        &robot.transmissions,
        N - 1,
        at,
        robot.tolerances,
    );
    MapEstimator::new(prior, &FeatureConfig::default())
        .with_external_force(&robot.arm, ExternalForce::possible(force_n))
}

impl Answers {
    fn belief(&mut self, prior: &Prior, belief: &Belief) {
        for k in 0..prior.dimension() {
            self.gaussian(&format!("entry {k}"), belief.entry(k));
        }
        // What goes together: the first entry with all others.
        let d = prior.dimension();
        let row: f64 = belief.covariance[..d].iter().map(|c| c.abs()).sum();
        self.number("first row", row);
    }

    fn map(&mut self, prior: &Prior, map: &MapEstimate) {
        for i in 0..N {
            self.gaussian(&format!("offset {i}"), map.offset(prior, i));
            self.gaussian(
                &format!("offset {i} at 20 s"),
                map.offset_at(prior, i, 20.0),
            );
            self.number(&format!("noise {i}"), map.noise_rad[i]);
            self.number(&format!("motor noise {i}"), map.motor_noise_nm[i]);
            if let Some(change) = map.stiffness_changes.get(i).copied().flatten() {
                self.probability(&format!("stiffness changed {i}"), change.probability);
                self.gaussian(&format!("softening {i}"), change.softening);
            }
            if let Some(creep) = map.creep.get(i).copied().flatten() {
                self.probability(&format!("creeps {i}"), creep.probability);
                self.gaussian(&format!("rate {i}"), creep.rate_rad_per_s);
            }
        }
        for (k, change) in map.changes.iter().enumerate() {
            let name = format!("{:?}", change.kind);
            self.number(&format!("{name} at"), change.at_s);
            self.gaussian(&name, map.change(prior, k));
            if let Some(found) = map.posterior(change) {
                self.number(&format!("{name} happened at"), found.time_s);
                self.number(&format!("{name} from"), found.interval_s.low);
                self.number(&format!("{name} to"), found.interval_s.high);
                self.probability(&format!("{name} happened"), found.probability);
                self.probability(&format!("{name} no noise"), found.probability_not_noise);
            }
        }
        if let Some(force) = &map.force {
            self.probability("force acts", force.probability);
            for (axis, n) in ["x", "y", "z"].iter().zip(force.force_n) {
                self.gaussian(&format!("force {axis}"), n);
            }
        }
        self.number("weights", map.weights.iter().sum());
        self.number("cost", map.convergence.cost);
        self.number("steps", map.convergence.iterations as f64);
    }

    fn filter(&mut self, filter: &RecursiveOffsets) {
        for i in 0..N {
            self.gaussian(&format!("offset {i}"), filter.offset(i));
            self.probability(
                &format!("stiffness changed {i}"),
                filter.stiffness_changed(i),
            );
            let [link, motor] = filter.noise();
            self.number(&format!("noise {i}"), link[i]);
            self.number(&format!("motor noise {i}"), motor[i]);
        }
        if let Some(force) = filter.external_force() {
            self.probability("force acts", force.probability);
            for (axis, n) in ["x", "y", "z"].iter().zip(force.force_n) {
                self.gaussian(&format!("force {axis}"), n);
            }
        }
        self.probability("in doubt", f64::from(u8::from(filter.is_provisional())));
    }
}

/// What a recording right after tensioning leaves for the next, ten days later.
fn learned(robot: &Robot, answers: &mut Answers) -> Belief {
    let estimator = estimator(robot, 1.0);
    let prior = estimator.prior();
    let start = prior.belief(Payload::Empty, TENSIONED_OFFSET_RAD);
    let scope = SearchScope {
        offsets: false,
        payload: false,
        continues: false,
    };
    let blocks = record(robot, CALM);
    let map = estimator.search(&start, &blocks, Payload::Empty, scope);
    let map = map.expect("an estimate");
    answers.about("baseline");
    answers.map(prior, &map);
    let mut belief = tempered(prior, &start, map.belief(prior), &map.noise_rad);
    answers.belief(prior, &belief);
    beliefs::age_by(prior, &mut belief, 10.0);
    prior.open_offsets(&mut belief, UNKNOWN_OFFSET_RAD);
    belief
}

/// A recording estimated at once and block by block, from what was learned before.
fn estimated(
    name: &str,
    truth: Truth,
    (payload, force_n): (Payload, f64),
    (before, answers): (&Belief, &mut Answers),
) -> Belief {
    let robot = robot();
    let estimator = estimator(&robot, force_n);
    let prior = estimator.prior();
    let mut start = before.clone();
    prior.open_payload(&mut start, payload);
    let scope = SearchScope {
        offsets: true,
        payload: true,
        continues: false,
    };
    let blocks = record(&robot, truth);
    let map = estimator.search(&start, &blocks, payload, scope);
    let map = map.expect("an estimate");
    answers.about(&format!("{name}, at once,"));
    answers.map(prior, &map);
    let after = map.belief(prior);
    answers.belief(prior, &after);
    let shared = shared_errors(prior, before, &start, &after, false).expect("shared");
    for (i, shared) in shared.iter().enumerate() {
        answers.number(&format!("shared {i}"), shared.baseline_rad);
        answers.number(&format!("shared drift {i}"), shared.drift_rad);
    }
    let mut filter = RecursiveOffsets::new(estimator.clone(), start).expect("a filter");
    for (k, block) in blocks.iter().enumerate() {
        filter.step(block).expect("a block");
        if k % 30 == 29 {
            answers.about(&format!("{name}, after {} blocks,", k + 1));
            answers.filter(&filter);
        }
    }
    answers.about(&format!("{name}, block by block,"));
    answers.belief(prior, &filter.belief().expect("a belief"));
    after
}

#[test]
fn what_is_known_of_five_recordings_is_what_it_was() {
    let robot = robot();
    let mut answers = Answers::default();
    let before = learned(&robot, &mut answers);
    let stretched = Truth {
        offset_rad: STRETCHED_RAD,
        ..CALM
    };
    let slipped = Truth {
        seed: 2,
        slip: Some((2, 41.0, 5e-3)),
        push_at_s: Some(25.0),
        temperature_c: [24.0, 27.0],
        ..stretched
    };
    let strand = Truth {
        seed: 3,
        strand: Some((1, 45.0, 0.88)),
        motor_torque: false,
        ..stretched
    };
    let pulled = Truth {
        seed: 4,
        force_n: [0.0, 1.5, -1.0],
        ..stretched
    };
    let loaded = Truth {
        seed: 5,
        load: Some((30.0, 0.5)),
        stiffness_factor: [1.06, 0.93, 0.92, 0.9],
        ..stretched
    };
    let creeping = Truth {
        seed: 6,
        creep_rad_per_s: 3e-3 / 60.0,
        temperature_c: [f64::NAN; 2],
        ..stretched
    };
    let all = &mut answers;
    let a = estimated("slip", slipped, (Payload::Unknown, 0.0), (&before, all));
    let b = estimated("strand", strand, (Payload::Empty, 1.0), (&before, all));
    estimated("force", pulled, (Payload::Unknown, 1.0), (&before, all));
    let load = Payload::Unknown;
    estimated("load", loaded, (load, 1.0), (&before, all));
    estimated("creep", creeping, (Payload::Empty, 1.0), (&before, all));

    let estimator = estimator(&robot, 1.0);
    let prior = estimator.prior();
    let mut both = beliefs::merge(prior, &before, &a, &b).expect("merged");
    all.about("merged");
    all.belief(prior, &both);
    beliefs::refer_to(prior, &mut both, 30.0);
    all.about("merged, warmer");
    all.belief(prior, &both);
    for (i, rad) in beliefs::unknown_temperature(prior, &mut both, 5.0)
        .iter()
        .enumerate()
    {
        all.number(&format!("unknown warmth {i}"), *rad);
    }
    let start = prior.belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let parts = [[start.clone(), a], [start, b]];
    let (kind, alike) = learn_type(prior, &parts).expect("a type");
    all.about("type");
    all.belief(prior, &kind);
    for (k, alike) in alike.iter().enumerate() {
        all.number(&format!("alike {k}"), alike.ratio);
    }
    all.about("bodies");
    all.belief(prior, &pool_bodies(prior, &parts, 0.5).expect("pooled"));
    answers.hold("known_offsets.csv");
}
