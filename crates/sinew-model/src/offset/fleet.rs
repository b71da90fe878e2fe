//! What robots of one type teach about each other, and beliefs at another temperature.

use super::map::MapError;
use super::prior::{Belief, JointParameter, Payload, Prior, UNKNOWN_OFFSET_RAD};
use crate::arm::PARAMETERS_PER_BODY;
use crate::cholesky;

impl Prior {
    /// The same belief with offsets and stiffness referred to another temperature.
    ///
    /// Compliance and zero are linear in temperature, so this is the exact linear map
    /// `δκ ← δκ + c_K Δ`, `delta_e ← delta_e + α_T Δ` on mean and covariance. A belief without a
    /// temperature, or a temperature that isn't one, stays as it is.
    pub fn refer_to(&self, belief: &mut Belief, temperature_c: f64) {
        let d = self.dimension();
        let warmer = temperature_c - belief.temperature_c;
        if !warmer.is_finite() || belief.mean.len() != d || belief.covariance.len() != d * d {
            return;
        }
        use JointParameter as P;
        for i in (0..self.joints()).filter(|&i| self.is_elastic(i)) {
            for (to, from) in [(P::Compliance, P::Thermal), (P::Offset, P::Drift)] {
                let (to, from) = (self.place(i, to), self.place(i, from));
                belief.mean[to] += warmer * belief.mean[from];
                for k in 0..d {
                    belief.covariance[to * d + k] += warmer * belief.covariance[from * d + k];
                }
                for k in 0..d {
                    belief.covariance[k * d + to] += warmer * belief.covariance[k * d + from];
                }
            }
        }
        belief.temperature_c = temperature_c;
    }

    /// What is believed of a further robot of a type after `parts` have each taught something about
    /// theirs: `(before, after)` per robot.
    ///
    /// Only the bodies' inertial parameters are shared. Robot `k` has `π_k = π + e_k` with
    /// `e_k ~ N(0, S)`, `S` the square of `alike` times the data sheet's deviation; everything else
    /// (offsets, stiffness, friction, encoders, motors) is each robot's own and stays as before any
    /// recording. With the marginal information `L_k = C_after⁻¹ − C_before⁻¹` of a robot's bodies
    /// about `π_k`, that about `π` is `L_k − L_k (L_k + S⁻¹)⁻¹ L_k`; it adds to the prior's, and the
    /// further robot's own difference adds `S` to the covariance.
    ///
    /// # Errors
    /// [`MapError`] when a belief is of another robot or no covariance.
    pub fn pool_bodies(&self, parts: &[[Belief; 2]], alike: f64) -> Result<Belief, MapError> {
        // Nothing is alike to more than a thousandth of its tolerance.
        let alike = alike.max(1e-3);
        let (d, from) = (self.dimension(), self.body_start());
        let m = self.joints() * PARAMETERS_PER_BODY;
        let fresh = self.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
        let bodies = |belief: &Belief| {
            let mut block = alloc::vec![0.0; m * m];
            for i in 0..m {
                let line = &belief.covariance[(from + i) * d + from..][..m];
                block[i * m..(i + 1) * m].copy_from_slice(line);
            }
            block
        };
        let times = |a: &[f64], x: &[f64]| -> alloc::vec::Vec<f64> {
            a.chunks_exact(m)
                .map(|line| line.iter().zip(x).map(|(a, x)| a * x).sum())
                .collect()
        };
        let inverse = |a: &[f64]| cholesky::inverse(a, m).map_err(MapError::Prior);
        let prior = bodies(&fresh);
        let scatter: alloc::vec::Vec<f64> =
            (0..m).map(|i| alike * alike * prior[i * m + i]).collect();
        let mut information = inverse(&prior)?;
        let mut vector = alloc::vec![0.0; m];
        for [before, after] in parts {
            for belief in [before, after] {
                if belief.mean.len() != d || belief.covariance.len() != d * d {
                    return Err(MapError::Dimension {
                        expected: d,
                        found: belief.mean.len(),
                    });
                }
            }
            let (then, now) = (inverse(&bodies(before))?, inverse(&bodies(after))?);
            let learned: alloc::vec::Vec<f64> = now.iter().zip(&then).map(|(a, b)| a - b).collect();
            let mut pull = times(&now, &after.mean[from..from + m]);
            for (p, t) in pull
                .iter_mut()
                .zip(times(&then, &before.mean[from..from + m]))
            {
                *p -= t;
            }
            let mut widened = learned.clone();
            for i in 0..m {
                widened[i * m + i] += 1.0 / scatter[i];
            }
            let widened = inverse(&widened)?;
            // L (L + S⁻¹)⁻¹, row by row: all three are symmetric.
            for i in 0..m {
                let share = times(&widened, &learned[i * m..(i + 1) * m]);
                vector[i] += pull[i] - share.iter().zip(&pull).map(|(s, p)| s * p).sum::<f64>();
                for (k, taken) in times(&learned, &share).iter().enumerate() {
                    information[i * m + k] += learned[i * m + k] - taken;
                }
            }
        }
        let covariance = inverse(&information)?;
        let mean = times(&covariance, &vector);
        let mut out = fresh;
        for i in 0..m {
            out.mean[from + i] = mean[i];
            for k in 0..m {
                let own = if i == k { scatter[i] } else { 0.0 };
                // What rounding leaves unsymmetric is no information.
                let both = 0.5 * (covariance[i * m + k] + covariance[k * m + i]);
                out.covariance[(from + i) * d + from + k] = both + own;
            }
        }
        Ok(out)
    }
}
