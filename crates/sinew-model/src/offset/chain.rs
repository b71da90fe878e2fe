//! From one recording to the next: what is forgotten, what is put together, what it is called.

use super::prior::{
    Belief, Entry, JointParameter, PAYLOAD, PER_JOINT, Payload, Prior, UNKNOWN_OFFSET_RAD,
};
use crate::arm::PARAMETERS_PER_BODY;

impl Prior {
    /// What changes from one day to the next is believed a little less: friction by a tenth of
    /// its tolerance, everything else but offsets and payload by a hundredth. A stiffness that fell
    /// by more is found as a change.
    ///
    /// Variances add and stop at the prior's: a chain of recordings can't become surer of
    /// friction than friction is constant.
    pub fn age(&self, belief: &mut Belief) {
        use JointParameter as P;
        const FRICTION: f64 = 0.1;
        const OTHER: f64 = 0.01;
        let d = self.dimension();
        if belief.covariance.len() != d * d {
            return;
        }
        let fresh = self.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
        for k in 0..self.payload_place() {
            let within = k % PER_JOINT;
            let in_joint = k < self.body_start();
            // The zero is what it was when the ropes were tensioned: what comes later is an offset.
            let of_recording = [P::Offset, P::Slack, P::Stuck, P::Zero];
            if in_joint && of_recording.iter().any(|p| within == *p as usize) {
                continue;
            }
            let friction = in_joint
                && (within == P::Coulomb as usize
                    || within == P::Viscous as usize
                    || within == P::LoadFriction as usize
                    || (P::MotorBias as usize..P::Slack as usize).contains(&within));
            let share = if friction { FRICTION } else { OTHER };
            let prior = fresh.covariance[k * d + k];
            let room = (prior - belief.covariance[k * d + k]).max(0.0);
            belief.covariance[k * d + k] += (share * share * prior).min(room);
        }
    }

    /// What entry `k` of the state is.
    pub fn describe(&self, k: usize) -> Option<Entry> {
        const JOINT: [(&str, &str); PER_JOINT] = [
            ("offset", "rad"),
            ("compliance over nominal", ""),
            ("stiffening", "1/rad²"),
            ("Coulomb friction", "N·m"),
            ("viscous friction", "N·m·s/rad"),
            ("load-dependent friction", ""),
            ("zero drift", "rad/K"),
            ("compliance per kelvin", "1/K"),
            ("encoder error, sine once", "rad"),
            ("encoder error, cosine once", "rad"),
            ("encoder error, sine twice", "rad"),
            ("encoder error, cosine twice", "rad"),
            ("motor torque scale", ""),
            ("motor torque zero", "N·m"),
            ("drive Coulomb friction", "N·m"),
            ("drive viscous friction", "N·m·s/rad"),
            ("drive load-dependent friction", ""),
            ("slack, half the dead zone", "rad"),
            ("friction at the start, −1…1", ""),
            ("viscoelastic share", ""),
            ("gear ratio error", ""),
            ("encoders' zero", "rad"),
        ];
        const BODY: [(&str, &str); PARAMETERS_PER_BODY] = [
            ("mass error", "kg"),
            ("first moment error x", "kg·m"),
            ("first moment error y", "kg·m"),
            ("first moment error z", "kg·m"),
            ("inertia error xx", "kg·m²"),
            ("inertia error xy", "kg·m²"),
            ("inertia error xz", "kg·m²"),
            ("inertia error yy", "kg·m²"),
            ("inertia error yz", "kg·m²"),
            ("inertia error zz", "kg·m²"),
        ];
        const LOAD: [(&str, &str); PAYLOAD] = [
            ("payload mass", "kg"),
            ("payload moment x", "kg·m"),
            ("payload moment y", "kg·m"),
            ("payload moment z", "kg·m"),
        ];
        let entry =
            |joint, (name, unit): (&'static str, &'static str)| Some(Entry { joint, name, unit });
        if k < self.body_start() {
            entry(Some(k / PER_JOINT), JOINT[k % PER_JOINT])
        } else if k < self.payload_place() {
            let b = k - self.body_start();
            entry(Some(b / PARAMETERS_PER_BODY), BODY[b % PARAMETERS_PER_BODY])
        } else {
            LOAD.get(k - self.payload_place())
                .and_then(|e| entry(None, *e))
        }
    }

    /// What `a` and `b` learned apart from `common`, which both started from, put together.
    ///
    /// In information form, `Λ = Λ_a + Λ_b − Λ_common`, so what both already knew counts once.
    /// Offsets and payload belong to a recording, the encoders' zero to a tensioning, not to the
    /// robot: they are opened in the result, as in `common`.
    ///
    /// # Errors
    /// [`super::MapError`] when lengths or covariances are no beliefs of this robot.
    pub fn merge(
        &self,
        common: &Belief,
        a: &Belief,
        b: &Belief,
    ) -> Result<Belief, super::MapError> {
        let d = self.dimension();
        let mut inputs = [common.clone(), a.clone(), b.clone()];
        for belief in &mut inputs {
            if belief.mean.len() != d || belief.covariance.len() != d * d {
                return Err(super::MapError::Dimension {
                    expected: d,
                    found: belief.mean.len(),
                });
            }
            self.open_offsets(belief, UNKNOWN_OFFSET_RAD);
            self.open_zero(belief);
            self.open_payload(belief, Payload::Unknown);
        }
        let (mut information, mut vector) = (alloc::vec![0.0; d * d], alloc::vec![0.0; d]);
        for (belief, sign) in inputs.iter().zip([-1.0, 1.0, 1.0]) {
            let part =
                crate::cholesky::inverse(&belief.covariance, d).map_err(super::MapError::Prior)?;
            for i in 0..d {
                for k in 0..d {
                    information[i * d + k] += sign * part[i * d + k];
                    vector[i] += sign * part[i * d + k] * (belief.mean[k] - inputs[0].mean[k]);
                }
            }
        }
        let covariance =
            crate::cholesky::inverse(&information, d).map_err(super::MapError::Prior)?;
        let mut mean = inputs[0].mean.clone();
        for i in 0..d {
            for k in 0..d {
                mean[i] += covariance[i * d + k] * vector[k];
            }
        }
        Ok(Belief {
            mean,
            covariance,
            temperature_c: common.temperature_c,
        })
    }
}
