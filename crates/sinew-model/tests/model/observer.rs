//! The observer against the exact continuous filter, and its manners.

use sinew_model::StepError;
use sinew_model::arm::{Arm, ArmWorkspace, urdf};
use sinew_model::observer::{
    DoublePole, ExactPole, FirstOrder, MomentumObserver, StateVariableFilter,
};

fn biorob_like() -> Arm {
    let text = include_str!("../../robots/biorob-like/biorob-like.urdf");
    urdf::parse(text, &urdf::UrdfOptions::default())
        .unwrap()
        .arm
}

/// A motion of all joints at working speeds, with its first two derivatives.
fn motion(t: f64) -> ([f64; 4], [f64; 4], [f64; 4]) {
    // amplitude rad, frequency rad/s, phase
    let joints = [
        (0.8, 1.9, 0.3),
        (0.7, 2.3, 1.1),
        (0.9, 2.9, 2.0),
        (0.5, 3.7, 0.0),
    ];
    let (mut q, mut dq, mut ddq) = ([0.0; 4], [0.0; 4], [0.0; 4]);
    for (i, (a, w, phase)) in joints.into_iter().enumerate() {
        let (s, c) = (w * t + phase).sin_cos();
        q[i] = 0.5 + a * s;
        dq[i] = a * w * c;
        ddq[i] = -a * w * w * s;
    }
    (q, dq, ddq)
}

/// Elastic torque of the motion: inverse dynamics, by another route than the observer's.
fn torque(arm: &Arm, ws: &mut ArmWorkspace, t: f64) -> [f64; 4] {
    let (q, dq, ddq) = motion(t);
    arm.inverse_dynamics(ws, &q, &dq, &ddq)
        .unwrap()
        .try_into()
        .unwrap()
}

/// Steps of 1 ms with ±60 % of jitter from a small generator; also one of 20 ms now and then.
struct Jitter(u64);
impl Jitter {
    fn next(&mut self, nominal: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let u = (self.0 >> 11) as f64 / (1u64 << 53) as f64;
        nominal * (0.4 + 1.2 * u)
    }
}

/// RMS of `r − exact` over RMS-relevant joints, relative to the peak torque.
fn error_against_continuous_filter(gain: f64, nominal_dt: f64, irregular: bool) -> f64 {
    let arm = biorob_like();
    let (mut ws, mut ws_truth) = (ArmWorkspace::new(&arm), ArmWorkspace::new(&arm));
    let mut observer = MomentumObserver::new(&[gain; 4]).unwrap();
    let mut jitter = Jitter(7);
    // The exact filter, by exact steps over a linear input at a hundredth of the sample time:
    // its own error is 1e-4 of the observer's.
    let mut exact = [FirstOrder::default(); 4];
    let mut is_first = true;
    let (mut t, mut sum, mut count, mut peak) = (0.0, 0.0, 0u32, 0.0f64);
    while t < 6.0 {
        let dt = if irregular {
            jitter.next(nominal_dt)
        } else {
            nominal_dt
        };
        if std::mem::take(&mut is_first) {
            let tau = torque(&arm, &mut ws_truth, t);
            for (e, tau) in exact.iter_mut().zip(tau) {
                *e = FirstOrder::settled_at(tau);
            }
        } else {
            let fine = 100;
            let pole = ExactPole::new(gain, dt / fine as f64);
            for k in 1..=fine {
                let tau = torque(&arm, &mut ws_truth, t + dt * k as f64 / fine as f64);
                for (e, tau) in exact.iter_mut().zip(tau) {
                    e.step(&pole, tau);
                    peak = peak.max(tau.abs());
                }
            }
            t += dt;
        }
        let (q, dq, _) = motion(t);
        let terms = arm.momentum(&mut ws, &q, &dq).unwrap();
        let alpha: Vec<f64> = terms
            .ct_dq
            .iter()
            .zip(terms.g)
            .map(|(c, g)| c - g)
            .collect();
        observer.step(dt, terms.p, &alpha, None).unwrap();
        // The initial state assumes rest; results are compared after it has decayed.
        if t > 10.0 / gain {
            for (r, e) in observer.torque().iter().zip(&exact) {
                sum += (r - e.output()).powi(2);
                count += 1;
            }
        }
    }
    (sum / f64::from(count)).sqrt() / peak
}

#[test]
fn follows_the_continuous_filter_at_every_gain() {
    for gain in [20.0, 100.0, 500.0, 1000.0, 2500.0] {
        for irregular in [false, true] {
            let error = error_against_continuous_filter(gain, 1e-3, irregular);
            println!("K_I {gain:6} 1/s, irregular {irregular:5}: RMS {error:.1e} of peak torque");
            assert!(error < 1e-3, "K_I {gain}: {error:e}");
        }
    }
}

#[test]
fn low_gain_error_is_quadratic_in_step() {
    let coarse = error_against_continuous_filter(20.0, 4e-3, false);
    let fine = error_against_continuous_filter(20.0, 1e-3, false);
    let order = (coarse / fine).log2() / 2.0;
    assert!((1.7..2.3).contains(&order), "order {order}");
}

#[test]
fn stable_at_any_gain_and_step() {
    let drive = [3.0, -2.0];
    for gain in [1e-6, 1.0, 1e3, 1e6, 1e12] {
        for dt in [1e-9, 1e-3, 1.0, 1e6] {
            let mut observer = MomentumObserver::new(&[gain; 2]).unwrap();
            for k in 0..200 {
                // Momentum swings; the drive is constant.
                let p = [0.1 * f64::from(k % 2), 0.0];
                observer.step(dt, &p, &drive, None).unwrap();
                let r = observer.torque();
                // Swing of p over dt is the largest torque there is to see.
                assert!(r[0].abs() <= 3.0 + 0.1 / dt * 1.0001, "{gain} {dt}: {r:?}");
                assert!((r[1] - 2.0).abs() < 1e-9, "{gain} {dt}: {r:?}");
            }
        }
    }
}

#[test]
fn weights_are_convex_and_exact_on_ramps() {
    for x in [1e-15, 1e-9, 1e-3, 0.5, 1.0, 30.0, 1e4] {
        let pole = ExactPole::new(x, 1.0);
        for w in [pole.a, pole.w0, pole.w1] {
            assert!((0.0..=1.0).contains(&w), "x {x}: {pole:?}");
        }
        assert!((pole.a + pole.w0 + pole.w1 - 1.0).abs() < 4.0 * f64::EPSILON);
    }
    // A ramp through ẏ = k (u − y): y = t − 1/k after the start has faded.
    let (k, dt) = (5.0, 0.1);
    let pole = ExactPole::new(k, dt);
    let mut y = FirstOrder::default();
    let mut t = 0.0;
    for _ in 0..200 {
        t += dt;
        y.step(&pole, t);
    }
    assert!((y.output() - (t - 1.0 / k)).abs() < 1e-12);
}

#[test]
fn gain_change_is_continuous() {
    let mut observer = MomentumObserver::new(&[10.0]).unwrap();
    for _ in 0..50 {
        observer.step(1e-3, &[0.0], &[-4.0], None).unwrap();
    }
    observer.step(1e-3, &[0.0], &[-6.0], None).unwrap();
    let before = observer.torque()[0];
    observer.set_gain(0, 400.0).unwrap();
    assert_eq!(observer.torque()[0], before);
    observer.step(1e-9, &[0.0], &[-6.0], None).unwrap();
    assert!((observer.torque()[0] - before).abs() < 1e-5);
}

#[test]
fn specified_external_torque_is_subtracted() {
    // p constant: tau_el = −α − tau_ext.
    let mut observer = MomentumObserver::new(&[50.0]).unwrap();
    for _ in 0..1000 {
        observer.step(1e-3, &[0.2], &[-3.0], Some(&[1.25])).unwrap();
    }
    assert!((observer.torque()[0] - 1.75).abs() < 1e-12);
}

#[test]
fn bad_samples_leave_the_state_as_it_was() {
    let mut observer = MomentumObserver::new(&[50.0; 2]).unwrap();
    observer
        .step(1e-3, &[0.1, 0.2], &[-1.0, -2.0], None)
        .unwrap();
    observer
        .step(1e-3, &[0.1, 0.2], &[-1.0, -2.0], None)
        .unwrap();
    let before = observer.clone();
    let nan = [f64::NAN, 0.0];
    let inf = [f64::INFINITY, 0.0];
    let ok = [0.1, 0.2];
    let refused = [
        (observer.step(1e-3, &nan, &ok, None), StepError::NotFinite),
        (observer.step(1e-3, &ok, &inf, None), StepError::NotFinite),
        (
            observer.step(1e-3, &ok, &ok, Some(&nan)),
            StepError::NotFinite,
        ),
        (observer.step(1e-3, &ok[..1], &ok, None), StepError::Length),
        (observer.step(0.0, &ok, &ok, None), StepError::TimeStep),
        (observer.step(-1e-3, &ok, &ok, None), StepError::TimeStep),
        (observer.step(f64::NAN, &ok, &ok, None), StepError::TimeStep),
        (
            observer.step(f64::INFINITY, &ok, &ok, None),
            StepError::TimeStep,
        ),
    ];
    for (got, expected) in refused {
        assert_eq!(got, Err(expected));
    }
    assert_eq!(observer, before);
    for gain in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(observer.set_gain(0, gain).is_err());
        assert!(MomentumObserver::new(&[1.0, gain]).is_err());
    }
    assert_eq!(observer, before);
}

#[test]
fn state_variable_filter_exact_on_ramps() {
    let (w, dt) = (40.0, 1e-3);
    let pole = DoublePole::new(w, dt);
    let mut filter = StateVariableFilter::settled_at(0.0);
    let mut t = 0.0;
    for _ in 0..2000 {
        t += dt;
        filter.step(&pole, 3.0 * t);
    }
    // Ramp: unit slope, delay 2/w.
    assert!((filter.rate() - 3.0).abs() < 1e-12);
    assert!((filter.value() - 3.0 * (t - 2.0 / w)).abs() < 1e-12);
    // Against the closed form for a unit step held (first-order hold of a step is a ramp over
    // one sample, so compare after it): x = 1 − (1 + w t) e^{−w t} up to half a sample.
    let mut filter = StateVariableFilter::settled_at(0.0);
    for k in 1..=100 {
        filter.step(&pole, 1.0);
        let t = f64::from(k) * dt - 0.5 * dt;
        let x = 1.0 - (1.0 + w * t) * (-w * t).exp();
        // A ramp over Δt against a step in its middle: (wΔt)²/24.
        assert!((filter.value() - x).abs() < (w * dt).powi(2) / 12.0, "{k}");
    }
}
