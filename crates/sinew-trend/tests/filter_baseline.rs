//! Common error of all sessions since one baseline: no number of sessions averages it out.

use sinew_model::Gaussian;
use sinew_model::offset::SharedError;
use sinew_trend::filter::{
    Curve, Noise, Prior, Record, Trend, TrendConfig, TrendError, TrendNow, generic_curves,
    node_times_s,
};

const DAY_S: f64 = 86_400.0;

/// Uniform and normal random numbers, identical on every machine (splitmix64, Box and Muller).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// Session with a reported standard deviation, part of which is common.
fn session(days: f64, offset_rad: f64, own_rad: f64, baseline_rad: f64) -> Record {
    Record {
        time_s: days * DAY_S,
        offset_rad: Some(Gaussian::new(offset_rad, own_rad.hypot(baseline_rad))),
        shared: Some(SharedError {
            baseline_rad,
            drift_rad: 0.0,
        }),
        temperature_c: Some(23.0),
        ..Record::default()
    }
}

fn trend() -> Trend {
    Trend::new(Prior::new(generic_curves(0.03)), TrendConfig::default()).expect("a prior")
}

#[test]
fn common_error_does_not_average_out() {
    for (stated, least) in [(true, 0.28e-3), (false, 0.29e-3)] {
        let mut random = Random(5);
        let mut trend = trend();
        let wrong = 0.3e-3;
        for day in 1..=100 {
            let t = f64::from(day);
            let y = 1e-3 * (24.0 * t).ln() + wrong + 0.06e-3 * random.normal();
            let mut record = session(t, y, 0.1e-3, 0.3e-3);
            if !stated {
                record.shared = None;
            }
            trend.add(record).expect("in order");
        }
        let now = TrendNow::of(&trend);
        let truth = 1e-3 * 2400.0_f64.ln();
        assert!(now.offset_rad.std > least, "{stated}: {now:?}");
        assert!(now.offset_rad.std < 0.4e-3, "{stated}: {now:?}");
        assert!((now.offset_rad.mean - truth).abs() < now.offset_rad.half_width_95());
        assert!(
            now.baseline_error_rad.std > 0.8 * least,
            "{stated}: {now:?}"
        );
    }
}

#[test]
fn independent_error_without_report_averages_out() {
    // The common part is not reported, and the scatter equals the whole reported error: nothing
    // remains common.
    let mut random = Random(6);
    let mut trend = trend();
    for day in 1..=100 {
        let t = f64::from(day);
        let y = 1e-3 * (24.0 * t).ln() + 0.3e-3 * random.normal();
        let record = Record {
            shared: None,
            ..session(t, y, 0.3e-3, 0.0)
        };
        trend.add(record).expect("in order");
    }
    let now = TrendNow::of(&trend).offset_rad;
    assert!(now.std < 0.17e-3, "{now:?}");
    assert!((now.mean - 1e-3 * 2400.0_f64.ln()).abs() < now.half_width_95());
}

#[test]
fn less_accurate_sessions_have_additional_common_error() {
    // One accurate check a month, work every day; both have a constant error.
    let mut random = Random(7);
    let mut inside = 0;
    const ROBOTS: u64 = 40;
    for _ in 0..ROBOTS {
        let mut trend = trend();
        let good = 0.3e-3 * random.normal();
        let poor = good + 1.5e-3 * random.normal();
        for day in 0..90 {
            let t = f64::from(day + 1);
            let is_check = day % 30 == 0;
            let (wrong, shared) = match is_check {
                true => (good, 0.3e-3),
                false => (poor, 1.53e-3),
            };
            let y = 1e-3 * (24.0 * t).ln() + wrong + 0.1e-3 * random.normal();
            trend.add(session(t, y, 0.1e-3, shared)).expect("in order");
        }
        let now = TrendNow::of(&trend).offset_rad;
        let error = now.mean - 1e-3 * 2160.0_f64.ln();
        inside += u64::from(error.abs() < now.half_width_95());
        // The information of the checks is kept over the work between.
        assert!((0.2e-3..0.9e-3).contains(&now.std), "{now:?}");
    }
    assert!(inside >= ROBOTS - 4, "{inside} of {ROBOTS}");
}

#[test]
fn new_baseline_is_zero_with_independent_error() {
    let mut random = Random(8);
    let mut trend = trend();
    let creep = |t: f64| 1e-3 * (24.0 * t).ln();
    for day in 1..=60 {
        let t = f64::from(day);
        let (since, wrong) = match day > 30 {
            true => (creep(30.5), -0.5e-3),
            false => (0.0, 0.5e-3),
        };
        if day == 31 {
            trend.rebased(30.5 * DAY_S, 1e-5).expect("in order");
            let now = TrendNow::of(&trend);
            assert!(now.offset_rad.mean.abs() < 1e-9, "{now:?}");
            assert!((now.offset_rad.std - 1e-5).abs() < 1e-9, "{now:?}");
            assert!(now.baseline_error_rad.std < 1e-9, "{now:?}");
        }
        let y = creep(t) - since + wrong + 0.05e-3 * random.normal();
        trend.add(session(t, y, 0.1e-3, 0.5e-3)).expect("in order");
    }
    let now = TrendNow::of(&trend);
    let truth = creep(60.0) - creep(30.5);
    assert!(
        (now.offset_rad.mean - truth).abs() < now.offset_rad.half_width_95(),
        "{now:?}"
    );
    // The creep of a month has a smaller error than a baseline: a contradiction is attributed to
    // the baseline.
    assert!(now.offset_rad.std < 0.5e-3, "{now:?}");
    // The history of the rope continues.
    assert!((now.whole_rad.mean - creep(60.0)).abs() < 1.5e-3, "{now:?}");
    let [event] = trend.events() else {
        panic!("{:?}", trend.events());
    };
    assert!(event.tensioned && event.size_rad.mean.is_nan());
    // Re-tensioning specified just before: one event.
    trend.tensioned(60.5 * DAY_S).expect("in order");
    trend.rebased(60.6 * DAY_S, 0.03).expect("in order");
    assert_eq!(trend.events().len(), 2);
    assert_eq!(
        trend.rebased(61.0 * DAY_S, f64::NAN),
        Err(TrendError::NotFinite)
    );
    assert!(matches!(
        trend.rebased(DAY_S, 0.0),
        Err(TrendError::OutOfOrder { .. })
    ));
}

#[test]
fn reference_temperatures_of_baselines_are_distinguished() {
    // A drift of 0.2 mrad/K since 15 °C, then since 27 °C.
    let mut trend = trend();
    for day in 1..=60 {
        let t = f64::from(day);
        let celsius = 21.0 + 7.0 * t.sin();
        let (since, reference_c) = match day > 30 {
            true => (30.5_f64, 27.0),
            false => (1.0 / 24.0, 15.0),
        };
        if day == 31 {
            trend.rebased(30.5 * DAY_S, 1e-5).expect("in order");
        }
        let y = 1e-3 * (t / since).ln() + 0.2e-3 * (celsius - reference_c);
        let record = Record {
            temperature_c: Some(celsius),
            reference_c: Some(reference_c),
            ..session(t, y, 0.1e-3, 0.1e-3)
        };
        trend.add(record).expect("in order");
    }
    let now = TrendNow::of(&trend);
    assert!(
        (now.drift_rad_per_k.mean - 0.2e-3).abs() < 0.02e-3,
        "{now:?}"
    );
    let truth = 1e-3 * (60.0_f64 / 30.5).ln();
    assert!((now.offset_rad.mean - truth).abs() < 0.2e-3, "{now:?}");
}

#[test]
fn sessions_at_one_time_and_of_impossible_parts() {
    let mut trend = trend();
    trend.add(session(1.0, 1e-3, 0.1e-3, 0.1e-3)).expect("good");
    trend
        .add(session(1.0, 1.1e-3, 0.1e-3, 0.1e-3))
        .expect("at the same time");
    for bad in [-1e-3, f64::NAN, f64::INFINITY] {
        let record = session(2.0, 1e-3, 0.1e-3, 0.1e-3);
        let shared = Some(SharedError {
            baseline_rad: bad,
            drift_rad: 0.0,
        });
        assert_eq!(
            trend.add(Record { shared, ..record }),
            Err(TrendError::NotFinite)
        );
    }
    // The whole error is common: the record is not treated as exact.
    trend.add(session(3.0, 1.2e-3, 0.0, 0.3e-3)).expect("good");
    assert!(TrendNow::of(&trend).offset_rad.std > 0.05e-3);
}

/// `ln(t / 100 s)` from 100 s on.
fn log_curve() -> Curve {
    Curve {
        retensioned: None,
        values: node_times_s().iter().map(|t| (t / 100.0).ln()).collect(),
        amplitude: 1e-3,
        amplitude_std: 0.4e-3,
        log_weight: 0.0,
    }
}

#[test]
fn interval_coverage_is_calibrated() {
    const ROBOTS: usize = 500;
    let mut prior = Prior::new(vec![log_curve()]);
    prior.step_rad = 0.0;
    prior.noises = [0.33, 0.83]
        .map(|scale| Noise {
            slow_std_rad: 0.1e-3,
            slow_time_s: 10.0 * DAY_S,
            white_scale: 0.6 * scale,
            creep_rate_rel_error: 0.0,
            log_weight: 0.0,
        })
        .to_vec();
    let config = TrendConfig {
        off_share: 1e-300,
        jumps_per_day: 1e-200,
        falls_per_day: 1e-200,
        ..TrendConfig::default()
    };
    let (own_rad, shared_rad) = (0.2e-3, 0.4e-3);
    let mut random = Random(12);
    let mut counts = [0_usize; 3];
    for _ in 0..ROBOTS {
        let noise = prior.noises[usize::from(random.uniform() < 0.5)];
        let amplitude = loop {
            let a = 1e-3 + 0.4e-3 * random.normal();
            if a > 0.0 {
                break a;
            }
        };
        let drift = prior.temperature_std_rad_per_k * random.normal();
        let wrong = shared_rad * random.normal();
        let mut slow = noise.slow_std_rad * random.normal();
        let mut trend = Trend::new(prior.clone(), config).expect("a prior");
        let creep = |t: f64| amplitude * (t * DAY_S / prior.baseline_s).ln();
        let mut last = 0.0;
        for day in 1..=40 {
            let t = f64::from(day) + 0.5 * random.uniform();
            let phi = ((last - t) / 10.0_f64).exp();
            last = t;
            slow = phi * slow + noise.slow_std_rad * (1.0 - phi * phi).sqrt() * random.normal();
            let warm = 6.0 * random.normal();
            let own = noise.white_scale / 0.6 * own_rad * random.normal();
            let y = creep(t) + wrong + slow + own + drift * warm;
            let record = Record {
                temperature_c: Some(prior.temperature_ref_c + warm),
                ..session(t, y, own_rad, shared_rad)
            };
            trend.add(record).expect("in order");
        }
        let now = TrendNow::of(&trend).offset_rad;
        let error = (now.mean - creep(last)).abs();
        for (count, factor) in counts.iter_mut().zip([1.0, 0.7, 1.4]) {
            *count += usize::from(error < factor * now.half_width_95());
        }
    }
    println!("{counts:?} of {ROBOTS} inside at 1, 0.7 and 1.4 times the interval");
    // Three standard deviations of a share of 0.95 among `ROBOTS`.
    let most = 3.0 * (0.95 * 0.05 / ROBOTS as f64).sqrt();
    let right = counts.map(|count| (count as f64 / ROBOTS as f64 - 0.95).abs() < most);
    assert_eq!(right, [true, false, false], "{counts:?}");
}

#[test]
fn stiffness_loss_error_is_common_to_later_sessions() {
    const ROBOTS: usize = 300;
    let mut prior = Prior::new(vec![log_curve()]);
    prior.step_rad = 0.0;
    prior.noises = vec![Noise {
        slow_std_rad: 0.02e-3,
        slow_time_s: 10.0 * DAY_S,
        white_scale: 0.6,
        creep_rate_rel_error: 0.0,
        log_weight: 0.0,
    }];
    let (own_rad, shared_rad) = (0.1e-3, 0.3e-3);
    let mut random = Random(31);
    let mut counts = [0_usize; 2];
    for _ in 0..ROBOTS {
        let amplitude = (1e-3 + 0.4e-3 * random.normal()).max(0.1e-3);
        let creep = |t: f64| amplitude * (t * DAY_S / prior.baseline_s).ln();
        let mut trend = Trend::new(prior.clone(), TrendConfig::default()).expect("a prior");
        let (mut jumped, mut softened) = (0.0, 0.0_f64);
        let mut wrong = shared_rad * random.normal();
        for day in 1..=50 {
            let t = f64::from(day);
            // Two strands fail in succession; each stiffness error equals the increase that later
            // sessions report.
            if day == 15 || day == 32 {
                jumped += 3e-3 + 2e-3 * random.uniform();
                let more = 0.2e-3 + 0.4e-3 * random.uniform();
                softened = softened.hypot(more);
                wrong += more * random.normal();
            }
            let y = creep(t) + jumped + wrong + own_rad * random.normal();
            let record = session(t, y, own_rad, shared_rad.hypot(softened));
            trend.add(record).expect("in order");
        }
        let now = TrendNow::of(&trend).offset_rad;
        let error = (now.mean - creep(50.0) - jumped).abs();
        for (count, factor) in counts.iter_mut().zip([1.0, 0.7]) {
            *count += usize::from(error < factor * now.half_width_95());
        }
    }
    println!("{counts:?} of {ROBOTS} inside at 1 and 0.7 times the interval");
    // Three standard deviations of a share of 0.95 among `ROBOTS`.
    let most = 3.0 * (0.95 * 0.05 / ROBOTS as f64).sqrt();
    let right = counts.map(|count| (count as f64 / ROBOTS as f64 - 0.95).abs() < most);
    assert_eq!(right, [true, false], "{counts:?}");
}
