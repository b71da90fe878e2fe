//! Blocks of samples: the state that winds up along the path, and the spring's features.

use super::samples::CableSample;

/// Length of a block, s: half the correlation time of the residual.
const BLOCK_S: f64 = 0.2;
/// Maximum number of blocks of a recording; the blocks of longer recordings are longer. It bounds the time and memory of
/// the factorisation of a recording's covariance (0.1 s, 3 MB).
const MAX_BLOCKS: f64 = 600.0;
/// Maximum time between two samples, s. The motor's position in a longer gap is unknown, and so is the state after it.
const MAX_GAP_S: f64 = 0.5;

/// Nonlinear parameters of the model, chosen from a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    /// Torque at which the toe of the cable has decayed to 1/e, N·m.
    pub(super) toe_nm: f64,
    /// Motor travel that changes the state by one, rad.
    pub(super) width_rad: f64,
}

impl Shape {
    /// Toe `s(τ) = τ_t (1 − exp(−|τ|/τ_t)) sgn τ`, N·m.
    pub(super) fn toe(self, torque_nm: f64) -> f64 {
        let share = 1.0 - (-torque_nm.abs() / self.toe_nm).exp();
        self.toe_nm * share * torque_nm.signum()
    }
}

/// Stop operator `z ← clip(z + Δθ/w, −1, 1)`: friction along the path in units of its limit.
///
/// The state at the start is unknown: it is bounded by the states that start at both limits, which meet once the motor
/// has moved by `2w` in one direction. The first stroke after a rest begins with another distribution of friction along the path
/// than each later one, so the state counts as unknown until it has been at both limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stop {
    width_rad: f64,
    bounds: [f64; 2],
    /// Whether the state was certainly at the lower and at the upper limit.
    touched: [bool; 2],
}

impl Stop {
    pub(super) fn new(width_rad: f64) -> Self {
        Self {
            width_rad,
            bounds: [-1.0, 1.0],
            touched: [false; 2],
        }
    }

    /// Moves the motor by `motion_rad`, and returns the state; `None` while it is unknown.
    pub(super) fn step(&mut self, motion_rad: f64) -> Option<f64> {
        let motion = motion_rad / self.width_rad;
        self.bounds = self.bounds.map(|z| (z + motion).clamp(-1.0, 1.0));
        let [low, high] = self.bounds;
        self.touched[0] |= high <= -1.0;
        self.touched[1] |= low >= 1.0;
        self.touched.iter().all(|touched| *touched).then_some(low)
    }
}

/// Means over one block.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct CableBlock {
    /// Middle of the block, s since the start of the recording.
    pub(super) time_s: f64,
    /// Motor minus joint position, rad.
    pub(super) y_rad: f64,
    pub(super) theta_rad: f64,
    pub(super) q_rad: f64,
    pub(super) torque_nm: f64,
    /// Toe of the torque, N·m.
    pub(super) toe_nm: f64,
    /// State along the path, −1…1.
    pub(super) z: f64,
    /// State times absolute torque, N·m.
    pub(super) torque_z_nm: f64,
}

impl CableBlock {
    fn add(&mut self, other: &Self) {
        self.time_s += other.time_s;
        self.y_rad += other.y_rad;
        self.theta_rad += other.theta_rad;
        self.q_rad += other.q_rad;
        self.torque_nm += other.torque_nm;
        self.toe_nm += other.toe_nm;
        self.z += other.z;
        self.torque_z_nm += other.torque_z_nm;
    }

    fn scaled(self, by: f64) -> Self {
        Self {
            time_s: by * self.time_s,
            y_rad: by * self.y_rad,
            theta_rad: by * self.theta_rad,
            q_rad: by * self.q_rad,
            torque_nm: by * self.torque_nm,
            toe_nm: by * self.toe_nm,
            z: by * self.z,
            torque_z_nm: by * self.torque_z_nm,
        }
    }
}

/// Blocks of a recording in which the state is known throughout: the noise of part of a block is that of no block.
pub(super) fn blocks(samples: &[CableSample], shape: Shape) -> Vec<CableBlock> {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return Vec::new();
    };
    let block_s = BLOCK_S.max((last.time_s - first.time_s) / MAX_BLOCKS);
    let mut out = Vec::new();
    let mut stop = Stop::new(shape.width_rad);
    let mut open: Option<(i64, f64, CableBlock)> = None;
    let mut before = *first;
    // Last block with a sample of an unknown state.
    let mut unknown_until = None;
    for sample in samples {
        if sample.time_s - before.time_s > MAX_GAP_S {
            stop = Stop::new(shape.width_rad);
        }
        let state = stop.step(sample.theta_rad - before.theta_rad);
        before = *sample;
        let index = ((sample.time_s - first.time_s) / block_s).floor() as i64;
        let Some(z) = state else {
            unknown_until = Some(index);
            continue;
        };
        if unknown_until == Some(index) {
            continue;
        }
        let value = CableBlock {
            time_s: sample.time_s,
            y_rad: sample.theta_rad - sample.q_rad,
            theta_rad: sample.theta_rad,
            q_rad: sample.q_rad,
            torque_nm: sample.torque_nm,
            toe_nm: shape.toe(sample.torque_nm),
            z,
            torque_z_nm: sample.torque_nm.abs() * z,
        };
        match &mut open {
            Some((at, count, sum)) if *at == index => {
                *count += 1.0;
                sum.add(&value);
            }
            _ => {
                out.extend(open.map(|(_, count, sum)| sum.scaled(1.0 / count)));
                open = Some((index, 1.0, value));
            }
        }
    }
    out.extend(open.map(|(_, count, sum)| sum.scaled(1.0 / count)));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    // A triangle wave of 4w: z is its own closed form, clipped at ±1.
    #[test]
    fn stop_operator_follows_closed_form() {
        let width = 0.02;
        let mut stop = Stop::new(width);
        let step = 0.1 * width;
        // Upwards by 3w: the lower bound reaches 1 after 2w, but the lower limit was not touched.
        for _ in 0..30 {
            assert_eq!(stop.step(step), None);
        }
        // Downwards: unknown until 2w, then at the limit.
        for k in 1..=25 {
            let z = stop.step(-step);
            match k {
                0..=19 => assert_eq!(z, None, "{k}"),
                20 => {}
                _ => assert_eq!(z, Some(-1.0), "{k}"),
            }
        }
        // Upwards again: −1 + x/w.
        for k in 1..=25 {
            let z = stop.step(step).expect("known");
            let expected = (0.1 * f64::from(k) - 1.0).min(1.0);
            assert!((z - expected).abs() < 1e-12, "{k}: {z} {expected}");
        }
    }

    #[test]
    fn toe_has_unit_slope_at_zero_and_saturates() {
        let shape = Shape {
            toe_nm: 0.02,
            width_rad: 0.02,
        };
        assert!((shape.toe(1e-6) / 1e-6 - 1.0).abs() < 1e-4);
        assert!((shape.toe(-10.0) + 0.02).abs() < 1e-12);
        assert!((shape.toe(0.02) - 0.02 * (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
    }

    #[test]
    fn gap_makes_state_unknown() {
        let shape = Shape {
            toe_nm: 1.0,
            width_rad: 0.01,
        };
        let sample = |time_s: f64, theta_rad: f64| CableSample {
            time_s,
            theta_rad,
            q_rad: 0.0,
            torque_nm: 0.0,
        };
        let mut samples = Vec::new();
        for k in 0..200 {
            let t = 0.02 * f64::from(k);
            samples.push(sample(t, 0.1 * (2.0 * t).sin()));
        }
        let whole = blocks(&samples, shape);
        assert!(whole.last().is_some_and(|b| b.time_s > 3.8));
        // The same after a gap of a second, without a reversal since.
        let last = samples.len() - 10;
        for sample in &mut samples[last..] {
            sample.time_s += 1.0;
        }
        let gap_s = samples[last].time_s;
        assert!(blocks(&samples, shape).iter().all(|b| b.time_s < gap_s));
    }
}
