//! Detection of changes since the last posterior: a forward filter over the hypotheses "no change", "contact", "step of
//! the offset of joint j at block k" and "steady contact at joint j since block k", on the innovations of the link and
//! motor equations.
//!
//! The search for change points accepts no change within the last seconds. The innovation of the link equation of joint
//! `i` in block `b` is modelled as
//!
//! ```text
//! e_i(b) = m_i(b) + s_i (1 − e^(−K_I t)) [b ≥ k, i = j] + n_i(b),   n_i(b) = ρ n_i(b−1) + ε_i(b)
//! z_i(b) = e_i(b) − ρ e_i(b−1)
//! ```
//!
//! * `m_i`: uncertainty of the posterior, `H P Hᵀ`, and model error of a pose; it is renewed as the arm travels.
//! * `s_i ~ N(0, (8 mrad)²)`: the step, tracked by a Kalman filter. Block `b` shows `1 − e^(−K_I t)` of it, where `t`
//!   is the time since its onset; the remainder has a standard deviation of half its size.
//! * `ε_i`: noise with a Student's t distribution of six degrees of freedom.
//! * contact: `e ~ N(0, c²)` at all joints, or with probability 0.3 at one joint alone; `c` is 1, 3, 10 or 30 mrad. Of
//!   the contacts at one joint 3 % are steady, such as an object that leans on the arm: in the link equations such a
//!   contact looks like a step until it ends.
//! * motor equation, if its torque is recorded: the torque of a contact is also in its innovation `e_m`, that of a step
//!   is not. In the unit of the link equation, `e_m ~ t(0, s²)` without a contact at the joint and `e_m ~ t(e_i, s²)`
//!   with one.
//!
//! Without a motor torque a step and a steady contact differ only in their duration.
//!
//! Hazards: a contact every 20 s that lasts 1.5 s, a step every 10 h of motion at each tendon.

use sinew_model::offset::FeatureConfig;

/// Prior standard deviation of a step of an offset, rad: smaller than `UNKNOWN_OFFSET_RAD`, as a rope or an encoder
/// slips by less.
const STEP_STD_RAD: f64 = 8e-3;
/// Standard deviation of the part of a step that a block does not show yet, relative to that part: the step occurs at
/// any time within its first block, and the joint moves against friction.
const HIDDEN_STEP_STD_RATIO: f64 = 0.5;
/// Standard deviations of an innovation in a contact, rad, of equal probability: from a light touch to a push of about
/// 15 N at the tool.
const CONTACT_STDS_RAD: [f64; 4] = [1e-3, 3e-3, 10e-3, 30e-3];
/// Probability that a contact is visible at one joint alone.
const SINGLE_JOINT_PROBABILITY: f64 = 0.3;
/// Probability that a contact at one joint is steady: with [`CONTACT_INTERVAL_S`], one in 40 minutes of motion.
/// Engineering estimate.
const STEADY_PROBABILITY: f64 = 0.03;
/// Mean time between contacts, s.
const CONTACT_INTERVAL_S: f64 = 20.0;
/// Mean duration of a contact, s.
const CONTACT_DURATION_S: f64 = 1.5;
/// Mean time between steps of the offset of one tendon, s of motion.
const STEP_INTERVAL_S: f64 = 36_000.0;
/// Maximum number of onsets that are tracked per joint; the most probable ones are kept.
const MAX_ONSETS: usize = 10;
/// Degrees of freedom of the noise distribution.
const DEGREES_OF_FREEDOM: f64 = 6.0;
/// Minimum probability of an onset; onsets of smaller probability are discarded.
const MIN_ONSET_PROBABILITY: f64 = 1e-12;

/// Noise of the link equations, from the residuals of the last solution.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Noise {
    /// Autocorrelation of consecutive blocks.
    pub(super) rho: f64,
    /// Standard deviation of `ε`, rad, per joint.
    pub(super) white_rad: Vec<f64>,
    /// Variance of the error that is constant while the arm does not travel, rad², per joint: `m` without the part of
    /// the posterior.
    pub(super) slow_rad2: Vec<f64>,
}

/// Gaussian level: a slowly renewed innovation, or a step.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Level {
    mean: f64,
    variance: f64,
}

/// Logarithm of the density of `x` with Student's t of [`DEGREES_OF_FREEDOM`] degrees and a scale of variance
/// `variance`.
pub(super) fn ln_student(x: f64, variance: f64) -> f64 {
    /// `ln Γ(3.5) − ln Γ(3) − ½ ln(6 π)`.
    const LN_SCALE: f64 = -0.960_435_170_8;
    LN_SCALE
        - 0.5 * variance.ln()
        - 0.5 * (DEGREES_OF_FREEDOM + 1.0) * (1.0 + x * x / (DEGREES_OF_FREEDOM * variance)).ln()
}

pub(super) fn ln_normal(x: f64, variance: f64) -> f64 {
    -0.5 * (x * x / variance + (std::f64::consts::TAU * variance).ln())
}

impl Level {
    /// Log density of `z`, which is `gain` times the level plus noise.
    fn ln_density(&self, z: f64, gain: f64, noise_rad2: f64) -> f64 {
        let variance = gain * gain * self.variance + noise_rad2;
        ln_student(z - gain * self.mean, variance)
    }

    /// Updates the level with `z`, weighted by `share`, the probability that it applies to this level, and by the
    /// Student weight.
    fn update(&mut self, z: f64, gain: f64, noise_rad2: f64, share: f64) {
        let innovation = z - gain * self.mean;
        let spread = gain * gain * self.variance + noise_rad2;
        let student =
            (DEGREES_OF_FREEDOM + 1.0) / (DEGREES_OF_FREEDOM + innovation * innovation / spread);
        let information = share * student.min(1.0) * gain * gain / noise_rad2;
        let kalman_gain = self.variance * information / (1.0 + self.variance * information);
        self.mean += kalman_gain * innovation / gain;
        self.variance *= 1.0 - kalman_gain;
    }

    /// Mean square of the level.
    fn square(&self) -> f64 {
        self.mean * self.mean + self.variance
    }

    /// Replaces a share of the level by a sample of `N(0, variance)`.
    fn renew(&mut self, share: f64, variance: f64) {
        let kept = 1.0 - share;
        self.mean *= kept;
        self.variance = kept * kept * self.variance + (1.0 - kept * kept) * variance;
    }
}

/// Hypothesis of a step or a steady contact that began at a block.
#[derive(Debug, Clone, Copy)]
struct Onset {
    joint: usize,
    since_s: f64,
    /// Number of blocks since the onset.
    age: u32,
    level: Level,
    /// Log probability of a step, without and with a contact now.
    ln: [f64; 2],
    /// Log probability of a steady contact, without and with another contact now.
    ln_steady: [f64; 2],
}

impl Onset {
    /// Share of the step in the low-pass filtered mean of the latest block; `per_block` is the block length in time
    /// constants.
    fn share(&self, per_block: f64) -> f64 {
        1.0 - (-per_block * (f64::from(self.age) + 0.5)).exp()
    }

    /// Share of the step in the previous block.
    fn share_before(&self, per_block: f64) -> f64 {
        let before = self.age.checked_sub(1);
        before.map_or(0.0, |age| Self { age, ..*self }.share(per_block))
    }

    /// Log probability of a step or a steady contact.
    fn ln_any(&self) -> f64 {
        ln_sum(self.ln.into_iter().chain(self.ln_steady))
    }
}

/// Suspected step of the offset of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SuspectedStep {
    /// Posterior probability of a step.
    pub(crate) probability: f64,
    /// Posterior probability of a steady contact at the joint instead, which has the same innovations.
    pub(crate) steady_contact_probability: f64,
    /// Most probable time of the step, s.
    pub(crate) since_s: f64,
    /// Size of the step if there is one, rad.
    pub(crate) mean_rad: f64,
    pub(crate) std_rad: f64,
}

impl SuspectedStep {
    /// Probability of a step, or of a steady contact, that is larger than `size_rad` in magnitude.
    pub(crate) fn probability_beyond(&self, size_rad: f64) -> f64 {
        let tail = |distance_rad: f64| {
            0.5 * libm::erfc(distance_rad / (self.std_rad * std::f64::consts::SQRT_2))
        };
        let either = self.probability + self.steady_contact_probability;
        either * (tail(size_rad - self.mean_rad) + tail(size_rad + self.mean_rad))
    }
}

/// Innovations of one block, the input of the detector.
#[derive(Debug, Clone, Copy)]
pub(super) struct Innovations<'a> {
    pub(super) time_s: f64,
    /// Innovation of the link equation of each joint, rad.
    pub(super) residual_rad: &'a [f64],
    /// Variance of the innovation from the posterior, and from stiction in a rest phase, rad².
    pub(super) unknown_rad2: &'a [f64],
    /// Innovations of the motor equations in the unit of the link equations, rad, with variances, rad².
    pub(super) motor: &'a [Option<(f64, f64)>],
    /// Share of the pose-dependent model error that is renewed, 0 to 1.
    pub(super) renewed: f64,
    /// Whether the previous block is missing.
    pub(super) after_gap: bool,
}

/// Forward filter over the hypotheses.
#[derive(Debug, Clone)]
pub(super) struct ChangeDetector {
    noise: Noise,
    block_s: f64,
    /// Pole of the low-pass filter of the blocks, 1/s.
    gain_per_s: f64,
    /// Innovations of the previous block, rad.
    before_rad: Vec<f64>,
    levels: Vec<Level>,
    /// Variances of the renewal of the levels, rad².
    slow_rad2: Vec<f64>,
    /// Log probability of no change, without and with a contact now that is not steady.
    ln_nothing: [f64; 2],
    onsets: Vec<Onset>,
    started: bool,
    /// Whether the last block was rejected because of non-finite values.
    is_broken: bool,
}

/// `ln Σ exp`.
pub(super) fn ln_sum(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let most = values.clone().fold(f64::NEG_INFINITY, f64::max);
    match most.is_finite() {
        true => most + values.map(|x| (x - most).exp()).sum::<f64>().ln(),
        false => most,
    }
}

/// Propagates the log probabilities without and with a contact that is not steady through one block.
///
/// `free` has the log densities of a block without a contact, after a block without and with one; `contact` is that of
/// a block with a contact.
fn propagate(ln: [f64; 2], free: [f64; 2], contact: f64, block_s: f64) -> [f64; 2] {
    let (begins, ends) = (block_s / CONTACT_INTERVAL_S, block_s / CONTACT_DURATION_S);
    let varies = begins * (1.0 - SINGLE_JOINT_PROBABILITY * STEADY_PROBABILITY);
    let sum = |a: f64, b: f64| ln_sum([a, b].into_iter());
    [
        sum(
            ln[0] + (1.0 - begins).ln() + free[0],
            ln[1] + ends.ln() + free[1],
        ),
        contact + sum(ln[0] + varies.ln(), ln[1] + (1.0 - ends).ln()),
    ]
}

impl ChangeDetector {
    pub(super) fn new(noise: Noise, features: &FeatureConfig) -> Self {
        let n = noise.white_rad.len();
        let nothing = Level {
            mean: 0.0,
            variance: 0.0,
        };
        Self {
            noise,
            block_s: features.block_s,
            gain_per_s: features.gain_per_s,
            before_rad: vec![0.0; n],
            levels: vec![nothing; n],
            slow_rad2: vec![0.0; n],
            ln_nothing: [0.0, f64::NEG_INFINITY],
            onsets: Vec::new(),
            started: false,
            is_broken: false,
        }
    }

    /// Updates the hypotheses with the innovations of the next block.
    pub(super) fn step(&mut self, block: &Innovations<'_>) {
        let values = block.residual_rad.iter().chain(block.unknown_rad2);
        if !values.into_iter().all(|x| x.is_finite()) {
            // Such a block has no prediction, and the next one is not its successor.
            self.is_broken = true;
            return;
        }
        let n = self.levels.len();
        let rho = self.noise.rho;
        let gain = 1.0 - rho;
        for (i, level) in self.levels.iter_mut().enumerate() {
            let renewed = if self.started { block.renewed } else { 1.0 };
            let slow_rad2 = block.unknown_rad2[i] + self.noise.slow_rad2[i];
            level.renew(renewed, slow_rad2);
            // An increase of the uncertainty takes effect immediately.
            level.variance += (slow_rad2 - self.slow_rad2[i]).max(0.0) * (1.0 - renewed);
            self.slow_rad2[i] = slow_rad2;
        }
        let e = block.residual_rad;
        let z: Vec<f64> = e
            .iter()
            .zip(&self.before_rad)
            .map(|(e, b)| e - rho * b)
            .collect();
        let white: Vec<f64> = self.noise.white_rad.iter().map(|w| w.powi(2)).collect();
        let white = |i: usize| white[i];
        let stationary = |i: usize| white(i) / (1.0 - rho * rho);
        // Without a contact: conditional on the last block, and independent of it after a contact or a gap.
        let fresh = !self.started || block.after_gap || self.is_broken;
        let of = |level: &Level, i: usize| {
            let alone = level.ln_density(e[i], 1.0, stationary(i));
            match fresh {
                true => [alone, alone],
                false => [level.ln_density(z[i], gain, white(i)), alone],
            }
        };
        let free: Vec<[f64; 2]> = (0..n).map(|i| of(&self.levels[i], i)).collect();
        let all_free = [0, 1].map(|k| free.iter().map(|f| f[k]).sum::<f64>());
        // Log likelihood ratio of the motor torque for a contact at a joint. Its noise is as correlated as that of the
        // link equation.
        let independent = (1.0 - rho) / (1.0 + rho);
        let motor: Vec<f64> = (0..n)
            .map(|i| match block.motor[i] {
                Some((motor, variance)) => {
                    let of = |x: f64| ln_student(x, variance + stationary(i));
                    independent * (of(motor - e[i]) - of(motor))
                }
                None => 0.0,
            })
            .collect();
        let contacts = CONTACT_STDS_RAD.map(|size| {
            let touched = |i: usize| motor[i] + ln_normal(e[i], size * size + stationary(i));
            let alone = (0..n).map(|i| all_free[1] - free[i][1] + touched(i) - (n as f64).ln());
            let every = (0..n).map(touched).sum::<f64>();
            let alone_share = SINGLE_JOINT_PROBABILITY * (1.0 - STEADY_PROBABILITY);
            ln_sum(
                [
                    (1.0 - SINGLE_JOINT_PROBABILITY).ln() + every,
                    alone_share.ln() + ln_sum(alone),
                ]
                .into_iter(),
            )
        });
        let contact = ln_sum(contacts.into_iter())
            - (CONTACT_STDS_RAD.len() as f64).ln()
            - (1.0 - SINGLE_JOINT_PROBABILITY * STEADY_PROBABILITY).ln();
        let was_nothing = self.ln_nothing;
        let hazard = self.block_s / STEP_INTERVAL_S;
        let per_block = self.gain_per_s * self.block_s;
        let steady_begins =
            SINGLE_JOINT_PROBABILITY * STEADY_PROBABILITY * self.block_s / CONTACT_INTERVAL_S;
        self.ln_nothing = propagate(was_nothing, all_free, contact, self.block_s)
            .map(|ln| ln + (1.0 - hazard * n as f64).ln());
        let ends = self.block_s / CONTACT_DURATION_S;
        let steady = self.onsets.iter().flat_map(|onset| onset.ln_steady);
        let ended = ln_sum(steady) + ends.ln() + all_free[1];
        self.ln_nothing[0] = ln_sum([self.ln_nothing[0], ended].into_iter());
        for onset in &mut self.onsets {
            onset.age += 1;
        }
        for (i, base) in self.levels.iter().enumerate() {
            let steady_begins = steady_begins / n as f64 / (1.0 - ends);
            self.onsets.push(Onset {
                joint: i,
                since_s: block.time_s - 0.5 * self.block_s,
                age: 0,
                level: Level {
                    mean: base.mean,
                    variance: base.variance + STEP_STD_RAD.powi(2),
                },
                ln: was_nothing.map(|ln| ln + hazard.ln()),
                ln_steady: was_nothing.map(|ln| ln + steady_begins.ln()),
            });
        }
        for onset in &mut self.onsets {
            let i = onset.joint;
            let (shown, before) = (onset.share(per_block), onset.share_before(per_block));
            let appearing = onset.level.square() * (HIDDEN_STEP_STD_RATIO * (1.0 - shown)).powi(2);
            let (z_gain, z_rad2) = (shown - rho * before, white(i) + appearing);
            let e_rad2 = stationary(i) + appearing;
            let alone = onset.level.ln_density(e[i], shown, e_rad2);
            let own = match fresh {
                true => [alone, alone],
                false => [onset.level.ln_density(z[i], z_gain, z_rad2), alone],
            };
            let others = [0, 1].map(|k| all_free[k] - free[i][k] + own[k]);
            onset.ln = propagate(onset.ln, others, contact, self.block_s);
            let others = others.map(|ln| ln + motor[i]);
            onset.ln_steady = propagate(onset.ln_steady, others, contact, self.block_s)
                .map(|ln| ln + (1.0 - ends).ln());
            let free_now = (-onset.ln_any()).exp() * (onset.ln[0].exp() + onset.ln_steady[0].exp());
            match fresh {
                true => onset.level.update(e[i], shown, e_rad2, free_now),
                false => onset.level.update(z[i], z_gain, z_rad2, free_now),
            }
        }
        self.normalise();
        // Each level is weighted by the probability that nothing changed at its joint.
        let own = self.probabilities();
        let free_now = self.free();
        for (i, level) in self.levels.iter_mut().enumerate() {
            let share = (free_now * (1.0 - own[i])).max(0.0);
            match fresh {
                true => level.update(e[i], 1.0, stationary(i), share),
                false => level.update(z[i], gain, white(i), share),
            }
        }
        self.before_rad.copy_from_slice(e);
        (self.started, self.is_broken) = (true, false);
    }

    /// Probability that there is no contact in the last block.
    pub(super) fn free(&self) -> f64 {
        let free = self.onsets.iter().map(|o| o.ln[0].exp());
        self.ln_nothing[0].exp() + free.sum::<f64>()
    }

    /// Probability of a step or a steady contact, per joint.
    fn probabilities(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.levels.len()];
        for onset in &self.onsets {
            out[onset.joint] += onset.ln_any().exp();
        }
        out
    }

    fn normalise(&mut self) {
        let own = self.onsets.iter().map(Onset::ln_any);
        let total = ln_sum(self.ln_nothing.into_iter().chain(own));
        if !total.is_finite() {
            // Values that no hypothesis explains carry no information.
            self.ln_nothing = [0.0, f64::NEG_INFINITY];
            self.onsets.clear();
            return;
        }
        self.ln_nothing = self.ln_nothing.map(|ln| ln - total);
        for onset in &mut self.onsets {
            onset.ln = onset.ln.map(|ln| ln - total);
            onset.ln_steady = onset.ln_steady.map(|ln| ln - total);
        }
        self.onsets
            .retain(|o| o.ln_any() > MIN_ONSET_PROBABILITY.ln());
        for i in 0..self.levels.len() {
            let mut own: Vec<f64> = (self.onsets.iter())
                .filter(|o| o.joint == i)
                .map(Onset::ln_any)
                .collect();
            if own.len() > MAX_ONSETS {
                own.sort_by(|a, b| b.total_cmp(a));
                let least = own[MAX_ONSETS - 1];
                self.onsets.retain(|o| o.joint != i || o.ln_any() >= least);
            }
        }
    }

    /// Returns the suspected step of a joint; `None` if there is no onset.
    pub(super) fn suspected(&self, joint: usize) -> Option<SuspectedStep> {
        let own = || self.onsets.iter().filter(|o| o.joint == joint);
        let either: f64 = own().map(|o| o.ln_any().exp()).sum();
        let steady: f64 = own().map(|o| ln_sum(o.ln_steady.into_iter()).exp()).sum();
        let most_probable = own().max_by(|a, b| a.ln_any().total_cmp(&b.ln_any()))?;
        let (mut mean, mut square) = (0.0, 0.0);
        for onset in own() {
            let share = onset.ln_any().exp() / either;
            let level = onset.level;
            mean += share * level.mean;
            square += share * (level.mean * level.mean + level.variance);
        }
        // The model error of a pose is not part of the step.
        let pose = self.noise.slow_rad2[joint];
        Some(SuspectedStep {
            probability: (either - steady).clamp(0.0, 1.0),
            steady_contact_probability: steady,
            since_s: most_probable.since_s,
            mean_rad: mean,
            std_rad: (square - mean * mean + pose).max(0.0).sqrt(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK_S: f64 = 0.2;
    const NOISE_RAD: f64 = 0.2e-3;
    const RHO: f64 = 0.66;

    /// Detector after each block, for two joints with the expected noise plus `more` (joint, block), rad.
    fn run(blocks: u32, seed: u64, more: impl Fn(usize, u32) -> f64) -> Vec<ChangeDetector> {
        run_with_motor(blocks, seed, more, |_| [None; 2])
    }

    /// Detector after each block, with innovations of the motor equations.
    fn run_with_motor(
        blocks: u32,
        seed: u64,
        more: impl Fn(usize, u32) -> f64,
        motor: impl Fn(u32) -> [Option<(f64, f64)>; 2],
    ) -> Vec<ChangeDetector> {
        let mut state = seed;
        let mut random = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let noise = Noise {
            rho: RHO,
            white_rad: vec![NOISE_RAD; 2],
            slow_rad2: vec![(0.1e-3_f64).powi(2); 2],
        };
        let mut detector = ChangeDetector::new(noise, &FeatureConfig::default());
        let mut noise_rad = [0.0; 2];
        let mut out = Vec::new();
        for b in 0..blocks {
            let residual_rad: Vec<f64> = (0..2)
                .map(|i| {
                    // A sum of twelve evenly spread numbers is nearly normal.
                    let normal = (0..12).map(|_| random()).sum::<f64>() - 6.0;
                    noise_rad[i] = RHO * noise_rad[i] + NOISE_RAD * normal;
                    noise_rad[i] + more(i, b)
                })
                .collect();
            detector.step(&Innovations {
                time_s: BLOCK_S * f64::from(b),
                residual_rad: &residual_rad,
                unknown_rad2: &[1e-8, 1e-8],
                motor: &motor(b),
                renewed: 0.1,
                after_gap: false,
            });
            out.push(detector.clone());
        }
        out
    }

    fn probability(detector: &ChangeDetector, joint: usize) -> f64 {
        let beyond = |step: SuspectedStep| step.probability_beyond(0.5e-3);
        detector.suspected(joint).map_or(0.0, beyond)
    }

    #[test]
    fn probabilities_sum_to_one() {
        for detector in run(60, 1, |i, b| if i == 0 && b > 30 { 4e-3 } else { 0.0 }) {
            let steps: f64 = detector.probabilities().iter().sum();
            let nothing: f64 = detector.ln_nothing.iter().map(|ln| ln.exp()).sum();
            let sum = steps + nothing;
            // Discarded onsets are negligible.
            assert!((sum - 1.0).abs() < 1e-6, "{sum}");
            assert!((0.0..=1.0 + 1e-9).contains(&detector.free()));
        }
    }

    // A step that appears over three blocks is detected within five, at its joint, with its size.
    #[test]
    fn detector_step_is_located_and_sized() {
        const AT: u32 = 50;
        for (seed, size_rad) in [(2, 5e-3), (3, -3e-3), (4, 15e-3)] {
            let shown = |b: u32| match b.checked_sub(AT) {
                None => 0.0,
                Some(k) => size_rad * [0.2, 0.55, 0.8, 1.0][k.min(3) as usize],
            };
            let all = run(80, seed, |i, b| if i == 1 { shown(b) } else { 0.0 });
            let before = &all[AT as usize - 1];
            assert!(probability(before, 1) < 0.01);
            let soon = &all[AT as usize + 5];
            assert!(probability(soon, 1) > 0.9, "{}", probability(soon, 1));
            let last = all.last().unwrap();
            let step = last.suspected(1).unwrap();
            assert!(probability(last, 1) > 0.99 && probability(last, 0) < 0.01);
            // Without a motor torque only its end distinguishes a steady contact: its odds decrease with every block.
            let odds = |step: SuspectedStep| step.steady_contact_probability / step.probability;
            let earlier = all[69].suspected(1).unwrap();
            let ends = 1.0 - BLOCK_S / CONTACT_DURATION_S;
            let ratio = odds(step) / odds(earlier) / ends.powi(10);
            assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
            let error_rad = (step.mean_rad - size_rad).abs();
            assert!(error_rad < 3.0 * step.std_rad, "{step:?}");
            assert!(
                (step.since_s - BLOCK_S * f64::from(AT)).abs() < 1.0,
                "{step:?}"
            );
        }
    }

    // A push of about a second at both joints is a contact, neither during nor after it a step.
    #[test]
    fn detector_temporary_contact_is_not_step() {
        let push = |i: usize, b: u32| match (50..56).contains(&b) {
            true => [12e-3, -7e-3][i] * (1.0 + 0.3 * f64::from(b % 3)),
            false => 0.0,
        };
        let all = run(80, 5, push);
        let during = &all[53];
        assert!(during.free() < 0.1, "{}", during.free());
        let last = all.last().unwrap();
        assert!(last.free() > 0.9);
        for joint in 0..2 {
            assert!(
                probability(last, joint) < 0.05,
                "{}",
                probability(last, joint)
            );
        }
    }

    /// Innovation of the link of the second joint for a permanent change at block 50, rad.
    fn lasting(i: usize, b: u32) -> f64 {
        match b.checked_sub(50) {
            Some(k) if i == 1 => 5e-3 * [0.2, 0.55, 0.8, 1.0][k.min(3) as usize],
            _ => 0.0,
        }
    }

    // The motor torque distinguishes a steady contact from a step.
    #[test]
    fn detector_motor_torque_separates_steady_contact() {
        const UNKNOWN_RAD2: f64 = 1e-6;
        for seed in 30..40 {
            let of_contact = |b: u32| Some((lasting(1, b), UNKNOWN_RAD2));
            let of_step = |_: u32| Some((0.0, UNKNOWN_RAD2));
            let contact = run_with_motor(80, seed, lasting, |b| [of_step(b), of_contact(b)]);
            let of = |d: &ChangeDetector| d.suspected(1).map_or(0.0, |step| step.probability);
            let step = run_with_motor(80, seed, lasting, |b| [of_step(b), of_step(b)]);
            let (of_contact, of_step) = (of(&contact[79]), of(&step[65]));
            assert!(
                of_contact < 0.05 && of_step > 0.95,
                "{of_contact} {of_step}"
            );
            // The interval covers both hypotheses.
            assert!(contact[56..].iter().all(|d| probability(d, 1) > 0.05));
        }
    }

    // Without a change, fewer than 1 % of the estimates are widened.
    #[test]
    fn detector_no_change_false_positive_rate() {
        let mut suspected = 0;
        for seed in 10..20 {
            let all = run(300, seed, |_, _| 0.0);
            suspected += all.iter().filter(|d| probability(d, 0) > 0.05).count();
        }
        assert!(suspected < 30, "{suspected}");
    }
}
