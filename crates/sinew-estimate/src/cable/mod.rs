//! Tendons with friction along their path: cables in a shaft or a sheath, ropes over several guides.
//!
//! The torque of the drive falls along the path by friction, so that the elongation depends on the direction of the
//! motion before, and not on the torque at the joint alone. With `y = θ̂ − q` and the torque `τ` at the joint,
//!
//! ```text
//! y = δ + y₀ + γ q + h(q, direction) + c∞ τ + c_t s(τ) + (a₀ + a₁ |τ|) z
//! s(τ) = τ_t (1 − exp(−|τ|/τ_t)) sgn τ        toe: a cable is softer at a low load
//! z ← clip(z + Δθ/w, −1, 1)                   friction along the path, which winds up over 2w of motor travel
//! ```
//!
//! The map `h` is a Gaussian process for each direction. `τ_t`, `w` and the scales of `h` and of the noise maximise the
//! evidence of the baseline on a grid. Given these, all other parameters are those of one linear Gaussian regression:
//! the posterior of the baseline (mean and covariance) is the prior of each session, in which an offset, a map and a
//! change of `a₀` are unknown in addition.
//!
//! Reading order: `samples`, `blocks` (state `z`), `model` (priors, columns, covariance), `regression`, `learn`
//! (baseline), `session` (offset and step).

mod blocks;
mod learn;
mod model;
mod regression;
mod samples;
mod session;

pub use learn::{CableBaseline, CableLoad};
pub(crate) use learn::{MIN_REVERSALS, motor_ratio, reversals};
pub use model::CablePrior;
pub use samples::{CableSample, CableSamples};
pub use session::{CableEstimate, CableLimit, CableStep, CableTrace};

#[cfg(test)]
mod tests {
    use super::blocks::{Shape, Stop};
    use super::*;
    use sinew_model::Gaussian;

    const PRIOR: CablePrior = CablePrior {
        compliance_rad_per_nm: 1.25,
        drive_friction_nm: 0.065,
    };

    /// Shape of the simulated cable: one of the grid.
    fn shape() -> Shape {
        PRIOR.shapes()[6]
    }

    /// Cable by the equation above without a map, driven by a sinusoid of 0.3 Hz for 20 s at a constant load; its offset
    /// is `offset_rad`, and `step_rad` more from 10 s on.
    fn simulated(load_nm: f64, offset_rad: f64, step_rad: f64) -> Vec<CableSample> {
        let shape = shape();
        let mut stop = Stop::new(shape.width_rad);
        let mut z = 0.0_f64;
        let mut before_rad = 0.0;
        let mut out = CableSamples::default();
        for k in 0..4000 {
            let time_s = 5e-3 * f64::from(k);
            let theta_rad = 0.5 * (std::f64::consts::TAU * 0.3 * time_s).sin();
            let motion_rad = theta_rad - before_rad;
            before_rad = theta_rad;
            z = (z + motion_rad / shape.width_rad).clamp(-1.0, 1.0);
            // Where the estimator knows the state, it is this one.
            let state = stop.step(motion_rad);
            assert!(state.is_none_or(|state| (state - z).abs() < 1e-9));
            let spring_rad = 1.1 * load_nm + 0.8 * shape.toe(load_nm);
            let friction_rad = (0.02 + 0.15 * load_nm) * z;
            let offset_rad = offset_rad + if time_s < 10.0 { 0.0 } else { step_rad };
            let y_rad = 0.1 + offset_rad + spring_rad + friction_rad;
            out.push(CableSample {
                time_s,
                theta_rad: theta_rad + offset_rad,
                q_rad: theta_rad + offset_rad - y_rad,
                torque_nm: load_nm,
            });
        }
        out.finish();
        out.samples
    }

    fn baseline(loads_nm: &[f64]) -> CableBaseline {
        let runs: Vec<_> = loads_nm.iter().map(|l| simulated(*l, 0.0, 0.0)).collect();
        let runs: Vec<&[CableSample]> = runs.iter().map(Vec::as_slice).collect();
        CableBaseline::learn("jaw", PRIOR, &runs).expect("a posterior")
    }

    #[test]
    fn simulated_cable_has_its_shape_and_offset() {
        let baseline = baseline(&[0.01, 0.05]);
        assert_eq!(baseline.width_rad, shape().width_rad);
        // Without a map and with less noise than any, the smallest scales are the most probable.
        assert_eq!((baseline.map_scale, baseline.noise_scale), (1.0, 1.0));
        for offset_rad in [0.0, 12e-3, -12e-3] {
            let found = baseline
                .estimate(&simulated(0.03, offset_rad, 0.0))
                .expect("found");
            let error = Gaussian::new(found.offset_rad.mean - offset_rad, found.offset_rad.std);
            assert!(
                !error.is_nonzero_95() && error.half_width_95() < 9e-3,
                "{error:?}"
            );
            assert!(found.shared_std_rad <= found.offset_rad.std);
            assert_eq!((found.step, &found.limits[..]), (None, &[][..]));
        }
        let found = baseline
            .estimate(&simulated(0.03, 0.0, 10e-3))
            .expect("found");
        let step = found.step.expect("a step");
        assert!(
            (step.time_s - 10.0).abs() < 0.3 && step.detected_s < 12.0,
            "{step:?}"
        );
        assert!((step.size_rad.mean - 10e-3).abs() < 1.5e-3, "{step:?}");
        assert!((found.offset_rad.mean - 10e-3).abs() < 4e-3, "{found:?}");
    }

    #[test]
    fn unlearned_conditions_are_named() {
        let one = baseline(&[0.01]);
        let found = one.estimate(&simulated(0.05, 0.0, 0.0)).expect("found");
        assert!(
            matches!(found.limits[..], [CableLimit::OneLoad { load_nm, .. }] if load_nm > 0.049)
        );
        // The load of the baseline itself needs no compliance.
        let found = one.estimate(&simulated(0.01, 0.0, 0.0)).expect("found");
        assert_eq!(found.limits, []);
        let two = baseline(&[0.01, 0.05]);
        let found = two.estimate(&simulated(0.07, 0.0, 0.0)).expect("found");
        assert!(matches!(found.limits[..], [CableLimit::Load { .. }]));
        let mut shifted = simulated(0.03, 0.0, 0.0);
        shifted.iter_mut().for_each(|s| {
            s.q_rad += 0.2;
            s.theta_rad += 0.2;
        });
        let found = two.estimate(&shifted).expect("found");
        assert!(matches!(found.limits[..], [CableLimit::Range { .. }]));
        // A single stroke: no block has a known state, and the prior of the offset is left.
        let stroke = &simulated(0.03, 0.0, 0.0)[..40];
        let found = two.estimate(stroke).expect("found");
        assert_eq!(found.limits, [CableLimit::Reversals { reversals: 0 }]);
        assert!(found.trace.is_empty() && found.offset_rad.mean == 0.0);
    }

    #[test]
    fn wrong_sign_or_gear_ratio_of_motor_is_found() {
        let slope = |factor: f64| {
            let mut samples = simulated(0.03, 0.0, 0.0);
            samples.iter_mut().for_each(|s| s.theta_rad *= factor);
            motor_ratio("jaw", &samples).map(|ratio| ratio.slope)
        };
        assert_eq!(slope(1.0), None);
        for factor in [-1.0, 35.0] {
            let found = slope(factor).expect("a ratio");
            assert!((found / factor - 1.0).abs() < 0.05, "{found}");
        }
    }

    #[test]
    fn baseline_round_trips_through_json() {
        let baseline = baseline(&[0.01, 0.05]);
        let text = serde_json::to_string(&baseline).expect("text");
        let read: CableBaseline = serde_json::from_str(&text).expect("a baseline");
        assert_eq!(read, baseline);
        // Another number of nodes.
        let mut other = baseline;
        other.loads[0].range_rad[1] += 1.0;
        assert!(other.estimate(&simulated(0.03, 0.0, 0.0)).is_none());
    }
}
