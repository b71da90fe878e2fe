//! Trend of a tendon against closed forms, dense linear algebra and its own prior.

use crate::random::Random;
use crate::score::Scores;
use sinew_model::Gaussian;
use sinew_model::offset::SharedError;
use sinew_trend::filter::{
    Curve, Noise, Paths, Prior, Record, Trend, TrendConfig, TrendError, TrendNow, TrendState,
    first_passage, generic_curves, node_times_s,
};

const DAY_S: f64 = 86_400.0;

/// `ln(t / 100 s)` from 100 s on: a straight line over the logarithm of time.
fn log_curve(amplitude: f64, std: f64) -> Curve {
    Curve {
        values: node_times_s().iter().map(|t| (t / 100.0).ln()).collect(),
        retensioned: None,
        amplitude,
        amplitude_std: std,
        log_weight: 0.0,
    }
}

fn noise(slow: f64, days: f64, scale: f64) -> Noise {
    Noise {
        slow_std_rad: slow,
        slow_time_s: days * DAY_S,
        white_scale: scale,
        creep_rate_rel_error: 0.0,
        log_weight: 0.0,
    }
}

fn only(curve: Curve, noise: Noise) -> Prior {
    let mut prior = Prior::new(vec![curve]);
    prior.noises = vec![noise];
    prior.step_rad = 0.0;
    prior
}

fn record(days: f64, offset_rad: f64, std_rad: f64, temperature_c: f64) -> Record {
    Record {
        time_s: days * DAY_S,
        offset_rad: Some(Gaussian::new(offset_rad, std_rad)),
        temperature_c: Some(temperature_c),
        ..Record::default()
    }
}

/// Adds to a record a part of its error that is common to all sessions since the baseline.
fn shared(record: Record, baseline_rad: f64) -> Record {
    Record {
        shared: Some(SharedError {
            baseline_rad,
            drift_rad: 0.0,
        }),
        ..record
    }
}

#[test]
fn log_creep_and_temperature_drift_are_recovered() {
    let mut prior = only(log_curve(0.0, 0.1), noise(0.0, 4.0, 1.0));
    prior.level_std_rad = 0.1;
    let baseline = prior.baseline_s;
    let mut trend = Trend::new(prior, TrendConfig::default()).expect("a prior");
    let (level, amplitude, drift) = (0.4e-3, 1.1e-3, 0.13e-3);
    for i in 1..=40 {
        let days = 0.5 * f64::from(i * i) / 8.0;
        let celsius = 23.0 + 8.0 * f64::from(i).sin();
        let creep = amplitude * (days * DAY_S / baseline).ln();
        let y = level + creep + drift * (celsius - 23.0);
        trend.add(record(days, y, 1e-9, celsius)).expect("in order");
    }
    let state = trend.components()[0].mean;
    // Forty measurements with 1e-9 rad and priors a hundred million times as wide.
    let creep = amplitude * (trend.time_s() / baseline).ln();
    assert!((state[0] - level - creep).abs() < 1e-8, "{state:?}");
    assert!((state[1] - amplitude).abs() < 1e-9, "{state:?}");
    assert!((state[2] - drift).abs() < 1e-9, "{state:?}");
    // limit = level + amplitude ln(t/t_b)
    let limit = 9e-3;
    let expected = baseline * ((limit - level) / amplitude).exp();
    let times: Vec<f64> = (0..400)
        .map(|i| trend.time_s() * 1.02_f64.powi(i))
        .collect();
    let mut random = Random(1);
    let paths = Paths::draw(&trend, &times, 20, &mut || random.normal());
    for t in first_passage(&paths.times_s, &paths.offset_rad, limit) {
        // Linear interpolation between times 2 % apart: at most half of 1e-4 of the time.
        assert!((t / expected - 1.0).abs() < 1e-4, "{t} {expected}");
    }
}

/// Posterior mean and variance of the true offset at `at`, and the evidence, from the joint normal
/// distribution of all records, without recursion.
fn dense(prior: &Prior, records: &[Record], at_s: f64) -> [f64; 3] {
    let (curve, noise) = (&prior.curves[0], &prior.noises[0]);
    let creep = |t: f64| curve.at(t) - curve.at(prior.baseline_s);
    let square = |v: f64| v * v;
    let (dj, da, dd) = (
        prior.level_std_rad,
        curve.amplitude_std,
        prior.temperature_std_rad_per_k,
    );
    let n = records.len();
    let warm = |r: &Record| r.temperature_c.expect("known") - prior.temperature_ref_c;
    let mut k = vec![vec![0.0; n]; n];
    for (i, a) in records.iter().enumerate() {
        for (j, b) in records.iter().enumerate() {
            let slow = (-(a.time_s - b.time_s).abs() / noise.slow_time_s).exp();
            k[i][j] = square(dj)
                + square(da) * creep(a.time_s) * creep(b.time_s)
                + square(dd) * warm(a) * warm(b)
                + square(noise.slow_std_rad) * slow;
            // The error of the more accurate session is in both; its correlation decays over ten
            // years.
            let part = |r: &Record| square(r.shared.expect("stated").baseline_rad);
            let ages = (-(a.time_s - b.time_s).abs() / 3.2e8).exp();
            k[i][j] += part(a).min(part(b)) * ages;
            if i == j {
                let left = square(a.offset_rad.expect("known").std) - part(a);
                k[i][j] += square(noise.white_scale / 0.6) * left;
            }
        }
    }
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|m| l[i][m] * l[j][m]).sum();
            l[i][j] = if i == j {
                (k[i][i] - dot).sqrt()
            } else {
                (k[i][j] - dot) / l[j][j]
            };
        }
    }
    let forward = |b: &[f64]| {
        let mut x = b.to_vec();
        for i in 0..n {
            for j in 0..i {
                x[i] -= l[i][j] * x[j];
            }
            x[i] /= l[i][i];
        }
        x
    };
    let residual: Vec<f64> = records
        .iter()
        .map(|r| r.offset_rad.expect("known").mean - curve.amplitude * creep(r.time_s))
        .collect();
    let cross: Vec<f64> = records
        .iter()
        .map(|r| square(dj) + square(da) * creep(at_s) * creep(r.time_s))
        .collect();
    let (z, w) = (forward(&residual), forward(&cross));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let log_det: f64 = (0..n).map(|i| l[i][i].ln()).sum();
    let evidence = -0.5 * (dot(&z, &z) + n as f64 * std::f64::consts::TAU.ln()) - log_det;
    let mean = curve.amplitude * creep(at_s) + dot(&w, &z);
    let variance = square(dj) + square(da * creep(at_s)) - dot(&w, &w);
    [mean, variance, evidence]
}

#[test]
fn record_by_record_agrees_with_dense_linear_algebra() {
    // Without outliers and step changes, so that the posterior is one normal distribution.
    let config = TrendConfig {
        off_share: 1e-300,
        jumps_per_day: 1e-200,
        falls_per_day: 1e-200,
        ..TrendConfig::default()
    };
    let mut random = Random(3);
    let priors = [
        only(log_curve(1e-3, 0.5e-3), noise(0.4e-3, 6.0, 0.5)),
        only(log_curve(1e-3, 0.5e-3), noise(0.5e-3, 10.0, 0.4)),
    ];
    let mut records = Vec::new();
    for i in 0..60 {
        let days = 1.0 + f64::from(i) * 1.3 + random.uniform();
        let celsius = 23.0 + 6.0 * random.normal();
        let y = 1e-3 * (days * 24.0).ln() + 0.1e-3 * (celsius - 23.0) + 0.6e-3 * random.normal();
        let std = (0.95 + random.uniform()) * 1e-3;
        // Less accurate sessions come first, accurate ones between.
        let part = if i % 3 == 1 { 0.25e-3 } else { 0.9e-3 };
        records.push(shared(record(days, y, std, celsius), part));
    }
    let end_s = records[59].time_s;
    let mut evidence = Vec::new();
    for prior in &priors {
        let mut trend = Trend::new(prior.clone(), config).expect("a prior");
        for r in &records {
            trend.add(*r).expect("in order");
        }
        let c = trend.components()[0];
        let (mean, variance) = (c.mean[0], c.covariance[0]);
        let [expected, expected_variance, log_evidence] = dense(prior, &records, end_s);
        assert!((mean - expected).abs() < 1e-12, "{mean} {expected}");
        assert!((variance / expected_variance - 1.0).abs() < 1e-7);
        evidence.push(log_evidence);
    }
    // Both noises in one bank: their weights are their evidences.
    let mut both = priors[0].clone();
    both.noises.push(priors[1].noises[0]);
    let mut trend = Trend::new(both, config).expect("a prior");
    for r in &records {
        trend.add(*r).expect("in order");
    }
    let c = trend.components();
    let odds = c[1].log_weight - c[0].log_weight;
    assert!(
        (odds - (evidence[1] - evidence[0])).abs() < 1e-6,
        "{odds} {evidence:?}"
    );
}

/// Tendon drawn from the prior itself: daily records, and its true offset at later times.
struct Drawn {
    records: Vec<Record>,
    later_rad: Vec<f64>,
}

fn drawn(prior: &Prior, days: usize, later_s: &[f64], random: &mut Random) -> Drawn {
    let curve = (random.uniform() * prior.curves.len() as f64) as usize;
    let noise = prior.noises[(random.uniform() * prior.noises.len() as f64) as usize];
    let c = &prior.curves[curve];
    let mut amplitude = loop {
        let a = c.amplitude + c.amplitude_std * random.normal();
        if a > 0.0 {
            break a;
        }
    };
    let mut level = prior.level_std_rad * random.normal();
    let mut at_s = prior.baseline_s;
    let mut creep_to = |t: f64, level: &mut f64, random: &mut Random| {
        let folds = (t / at_s).ln().max(0.0);
        // In small steps, independent of the step size of the filter.
        let pieces = (folds / 0.02).ceil().max(1.0);
        let (from_s, ratio) = (at_s, (t / at_s).powf(1.0 / pieces));
        let variance = noise.creep_rate_rel_error.powi(2) * folds / pieces;
        for i in 0..pieces as i32 {
            let step = c.at(from_s * ratio.powi(i + 1)) - c.at(from_s * ratio.powi(i));
            let factor = (variance.sqrt() * random.normal() - 0.5 * variance).exp();
            *level += 0.5 * (1.0 + factor) * amplitude * step;
            amplitude *= factor;
        }
        at_s = t;
    };
    let drift = prior.temperature_std_rad_per_k * random.normal();
    let mut slow = noise.slow_std_rad * random.normal();
    let phi = (-DAY_S / noise.slow_time_s).exp();
    let mut records = Vec::new();
    for day in 1..=days {
        creep_to(day as f64 * DAY_S, &mut level, random);
        slow = phi * slow + noise.slow_std_rad * (1.0 - phi * phi).sqrt() * random.normal();
        let warm = 6.0 * random.normal();
        let stated = 0.3e-3;
        let own = noise.white_scale * stated * random.normal();
        let y = level + drift * warm + slow + own;
        records.push(record(
            day as f64,
            y,
            stated,
            prior.temperature_ref_c + warm,
        ));
    }
    let later_rad = later_s
        .iter()
        .map(|&t| {
            creep_to(t, &mut level, random);
            level
        })
        .collect();
    Drawn { records, later_rad }
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[(share * (values.len() - 1) as f64).round() as usize]
}

/// Errors match the intervals; intervals 0.7 or 1.4 times as wide fail.
#[test]
fn forecast_coverage_matches_prior_draws() {
    let asked = std::env::var("SINEW_SEEDS").ok();
    let draws: usize = asked.and_then(|s| s.parse().ok()).unwrap_or(500);
    // Tendons with smooth creep.
    let mut prior = Prior::new(generic_curves(0.03));
    prior.step_rad = 0.0;
    let mut random = Random(11);
    // Tendons of this prior have no step changes, and records are never outliers.
    let config = TrendConfig {
        off_share: 1e-300,
        jumps_per_day: 1e-200,
        falls_per_day: 1e-200,
        ..TrendConfig::default()
    };
    // From the last record to a century.
    let times: Vec<f64> = (0..75).map(|i| 30.0 * DAY_S * 1.1_f64.powi(i)).collect();
    // The offset at four times the length of the record.
    let at = times.partition_point(|t| *t <= 120.0 * DAY_S);
    let mut now = Scores::default();
    let mut later = Scores::default();
    let mut passages = Scores::default();
    for _ in 0..draws {
        let truth = drawn(&prior, 30, &times, &mut random);
        let mut trend = Trend::new(prior.clone(), config).expect("a prior");
        for r in &truth.records {
            trend.add(*r).expect("in order");
        }
        let found = TrendNow::of(&trend).offset_rad;
        now.add_error(found.mean - truth.later_rad[0], found.std);
        let paths = Paths::draw(&trend, &times, 400, &mut || random.normal());
        let mut there: Vec<f64> = paths.offset_rad.iter().map(|p| p[at]).collect();
        let [low, middle, high] = [0.025, 0.5, 0.975].map(|q| quantile(&mut there, q));
        later.add(middle, low, high, truth.later_rad[at]);
        // First passage of the median forecast; a passage beyond the horizon counts as the last
        // day.
        let last_s = times[times.len() - 1];
        let day = |paths: &[Vec<f64>]| {
            let days = first_passage(&times, paths, middle).into_iter();
            days.map(|t| t.min(last_s).ln()).collect::<Vec<f64>>()
        };
        let true_day = day(std::slice::from_ref(&truth.later_rad))[0];
        let mut found = day(&paths.offset_rad);
        let [low, middle, high] = [0.025, 0.5, 0.975].map(|q| quantile(&mut found, q));
        passages.add(middle, low, high, true_day);
    }
    now.hold("offset now");
    later.hold("offset in three months");
    // Passage days are skewed, so that shares inside are counted: 95 % of 500 scatter by 1 %.
    println!("{}", passages.row("day of a limit"));
    let right = |times: f64| (0.91..=0.99).contains(&passages.inside(times));
    assert!(right(1.0) && !right(0.7) && !right(1.4));
}

#[test]
fn resumed_state_is_bitwise_identical() {
    let prior = Prior::new(generic_curves(0.03));
    let config = TrendConfig::default();
    let mut random = Random(21);
    let truth = drawn(&prior, 40, &[], &mut random);
    let mut whole = Trend::new(prior.clone(), config).expect("a prior");
    let mut cut = whole.clone();
    for (i, r) in truth.records.iter().enumerate() {
        let mut r = *r;
        // A strand fails.
        r.offset_rad = r
            .offset_rad
            .map(|y| Gaussian::new(y.mean + if i > 25 { 3e-3 } else { 0.0 }, y.std));
        // An inconclusive session at intervals.
        if i % 9 == 4 {
            r.offset_rad = None;
        }
        let lost = if i > 25 { 0.05 } else { 0.0 };
        r.stiffness =
            (i % 5 != 2).then(|| Gaussian::new(0.1 - lost + 0.002 * random.normal(), 0.01));
        whole.add(r).expect("in order");
        cut = Trend::resume(prior.clone(), config, cut.state()).expect("its own state");
        cut.add(r).expect("in order");
    }
    assert_eq!(whole, cut);
    let mut other = prior.clone();
    other.baseline_s *= 2.0;
    assert_eq!(
        Trend::resume(other, config, whole.state()),
        Err(TrendError::State)
    );
}

#[test]
fn invalid_state_is_rejected() {
    let prior = Prior::new(generic_curves(0.03));
    let config = TrendConfig::default();
    let mut random = Random(22);
    let mut trend = Trend::new(prior.clone(), config).expect("a prior");
    for record in drawn(&prior, 6, &[], &mut random).records {
        trend.add(record).expect("in order");
    }
    let state = trend.state();
    let last = state.components.len() - 1;
    let broken: [fn(&mut TrendState, usize); 9] = [
        |s, _| s.fingerprint ^= 1,
        |s, _| s.time_s = f64::NAN,
        |s, _| s.components.clear(),
        |s, i| s.components[i].curve = u32::MAX,
        |s, i| s.components[i].noise = u32::MAX,
        |s, i| s.components[i].log_weight = f64::NAN,
        |s, i| s.components[i].log_weight = f64::INFINITY,
        |s, i| s.components[i].mean[2] = f64::NAN,
        |s, i| s.components[i].covariance[5] = f64::INFINITY,
    ];
    for (k, broken) in broken.into_iter().enumerate() {
        let mut state = state.clone();
        broken(&mut state, last);
        let resumed = Trend::resume(prior.clone(), config, state);
        assert_eq!(resumed, Err(TrendError::State), "the {k}. break");
    }
    assert_eq!(Trend::resume(prior, config, state), Ok(trend));
}

#[test]
fn repeated_slips_keep_memory_bounded() {
    let prior = Prior::new(generic_curves(30e-3));
    let most = prior.curves.len() * prior.noises.len();
    let mut trend = Trend::new(prior, TrendConfig::default()).expect("a prior");
    let mut random = Random(5);
    for day in 1..=40 {
        // A strand fails every three days: 8 mrad each time.
        let strands = f64::from((day / 3).min(8));
        let offset = 2e-3 + 8e-3 * strands + 0.1e-3 * random.normal();
        let own = record(f64::from(day), offset, 0.15e-3, 21.0);
        trend.add(own).expect("in order");
        let filters = trend.components().len();
        assert!(filters <= most, "day {day}: {filters} of {most}");
    }
    let found = trend.events().len();
    assert!(found >= 5, "{found} of 8 jumps");
    let offset = trend.components()[0].mean[0];
    assert!((offset - 66e-3).abs() < 1e-3, "{offset}");
}
