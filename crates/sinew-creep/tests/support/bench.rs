//! Tests of a rope on a bench, made by the rope law itself.

use super::score::Scores;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_creep::*;
use sinew_creep::{Specimen, TestQuantity};
use sinew_rope::Catalogue;
use sinew_rope::law::entry::Uncertainty;
use sinew_rope::law::{Law as RopeLaw, Parameter as P, Parameters, RopeLoad, State};
use std::sync::Arc;

/// Bench test: preload 2 N for a minute, a load, then 2 N again.
#[derive(Clone, Copy)]
pub(crate) struct Test {
    pub(crate) load_n: f64,
    pub(crate) celsius: f64,
    pub(crate) loaded_s: f64,
    pub(crate) after_s: f64,
}

const PRELOAD_N: f64 = 2.0;
const PRELOADED_S: f64 = 60.0;
/// Standard deviation of a measurement's strain: 0.002 %, 7 µm over 350 mm.
pub(crate) const SIGMA: f64 = 2e-5;

pub(crate) fn base() -> RopeBase {
    let catalogue = Catalogue::shipped().unwrap();
    RopeBase::new(catalogue.find("liros-dc000-0301").unwrap().entry.clone()).unwrap()
}

/// Parameters of the catalogue's rope, moved within its intervals.
pub(crate) fn truth() -> Parameters {
    let mut p = base().entry.parameters().unwrap();
    p.set(P::Bedding, 0.50);
    p.set(P::BeddingTime, 180.0);
    p.set(P::Jamming, 2.4);
    p.set(P::BeddingLoadRatio, 0.024);
    p.set(P::Delayed, 1.7);
    p.set(P::ElasticK, 50.0);
    p.set(P::Toe, 0.17);
    p
}

/// The same, with the toe load ratio anywhere within the catalogue's interval: it is fixed in fits
/// of these tests.
pub(crate) fn truth_of(seed: u64) -> Parameters {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x70e);
    let z: f64 = StandardNormal.sample(&mut random);
    let mut p = truth();
    p.set(P::ToeLoadRatio, base().entry.law[&P::ToeLoadRatio].at(z));
    p
}

/// The same, with all parameters that one load does not determine anywhere within the catalogue's
/// intervals.
pub(crate) fn truth_of_one_load(seed: u64) -> Parameters {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x10ad);
    let mut p = truth();
    for q in [P::Toe, P::ToeLoadRatio, P::BeddingLoadRatio, P::FlowRate] {
        let z: f64 = StandardNormal.sample(&mut random);
        p.set(q, base().entry.law[&q].at(z));
    }
    p
}

fn even_in_log(count: usize, last_s: f64) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| 5.0 * (last_s / 5.0).powf(i as f64 / (count - 1) as f64))
}

/// Record simulated by the law, with noise; the zero is a mean of 20 measurements.
pub(crate) fn record(p: Parameters, test: Test, sigma: f64, random: &mut ChaCha8Rng) -> Curve {
    let law = RopeLaw::new(p).unwrap();
    let load = |n: f64| RopeLoad::celsius(n, test.celsius);
    let strain = |s: &State, n: f64| 0.01 * law.strain(s, load(n)).unwrap().total_percent();
    // The measurements of the zero are distributed over the preload.
    let mut middle = State::default();
    law.hold(&mut middle, load(PRELOAD_N), 0.5 * PRELOADED_S)
        .unwrap();
    let mut start = middle;
    law.hold(&mut start, load(PRELOAD_N), 0.5 * PRELOADED_S)
        .unwrap();
    let mut noise = |scale: f64| -> f64 {
        let z: f64 = StandardNormal.sample(random);
        scale * z
    };
    let zero = strain(&middle, PRELOAD_N) + noise(sigma / 20.0_f64.sqrt());
    let mut time: Vec<f64> = even_in_log(60, test.loaded_s - 1.0).collect();
    if test.after_s > 0.0 {
        time.extend(even_in_log(40, test.after_s).map(|t| test.loaded_s + t));
    }
    let values = time
        .iter()
        .map(|&t| {
            let mut s = start;
            law.hold(&mut s, load(test.load_n), t.min(test.loaded_s))
                .unwrap();
            let mut tension = test.load_n;
            if t > test.loaded_s {
                tension = PRELOAD_N;
                law.hold(&mut s, load(tension), t - test.loaded_s).unwrap();
            }
            strain(&s, tension) - zero + noise(sigma)
        })
        .collect();
    let mut curve = Curve::constant_load(format!("{} N", test.load_n), time, values);
    curve.steps = vec![(0.0, 1.0), (test.loaded_s, 0.0)];
    curve.temperature_c = Some(test.celsius);
    curve.zero_count = 20.0;
    curve.tension = Some(Tension {
        preload_n: PRELOAD_N,
        per_step_n: test.load_n - PRELOAD_N,
        preloaded_s: PRELOADED_S,
    });
    curve
}

pub(crate) const COLD: [Test; 2] = [
    Test {
        load_n: 60.0,
        celsius: 23.0,
        loaded_s: 5100.0,
        after_s: 3000.0,
    },
    Test {
        load_n: 240.0,
        celsius: 23.0,
        loaded_s: 5100.0,
        after_s: 3000.0,
    },
];

pub(crate) fn options(seed: u64) -> FitOptions {
    FitOptions {
        noise: NoiseKind::White,
        seed,
        rope: Some(Arc::new(base())),
        ..FitOptions::default()
    }
}

/// The same with a base rope whose fixed parameters are exact.
pub(crate) fn certain(seed: u64) -> FitOptions {
    let mut entry = base().entry;
    let toe = entry.law.get_mut(&P::ToeLoadRatio).unwrap();
    toe.uncertainty = Uncertainty::NotSpecified;
    FitOptions {
        rope: Some(Arc::new(RopeBase::new(entry).unwrap())),
        ..options(seed)
    }
}

pub(crate) fn records(tests: &[Test], sigma: f64, seed: u64) -> Vec<Curve> {
    records_of(truth(), tests, sigma, seed)
}

pub(crate) fn records_of(p: Parameters, tests: &[Test], sigma: f64, seed: u64) -> Vec<Curve> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    tests
        .iter()
        .map(|t| record(p, *t, sigma, &mut random))
        .collect()
}

/// The same test as recorded by a testing machine: a measurement every `every_s`, the load changes
/// anywhere between two of them.
pub(crate) fn sampled(p: Parameters, test: Test, every_s: f64, sigma: f64, seed: u64) -> Prepared {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let law = RopeLaw::new(p).unwrap();
    let load = |n: f64| RopeLoad::celsius(n, test.celsius);
    let before = PRELOADED_S.max(4.0 * every_s);
    let (on, off): (f64, f64) = (random.random(), random.random());
    let start = before + every_s * on;
    let end = start.div_euclid(every_s) * every_s + test.loaded_s + every_s * off;
    let count = ((before + test.loaded_s + test.after_s) / every_s) as usize;
    let mut state = State::default();
    let (mut now, mut held) = (0.0, PRELOAD_N);
    let (mut time, mut force, mut strain) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=count {
        let t = every_s * i as f64;
        for (change, n) in [(start, test.load_n), (end, PRELOAD_N)] {
            if now < change && change <= t {
                law.hold(&mut state, load(held), change - now).unwrap();
                (now, held) = (change, n);
            }
        }
        law.hold(&mut state, load(held), t - now).unwrap();
        now = t;
        let z: f64 = StandardNormal.sample(&mut random);
        time.push(t);
        force.push(held);
        strain.push(0.01 * law.strain(&state, load(held)).unwrap().total_percent() + sigma * z);
    }
    let mut specimen = Specimen::default();
    specimen.name = format!("{} N", test.load_n);
    specimen.lines = (0..time.len() as u64).collect();
    specimen.set_column(TestQuantity::Temperature, vec![test.celsius; time.len()]);
    specimen.set_column(TestQuantity::Time, time);
    specimen.set_column(TestQuantity::Force, force);
    specimen.set_column(TestQuantity::Strain, strain);
    prepare(&specimen, &PrepareOptions::default()).unwrap()
}

/// Scores of a fitted rope's parameters against the truth, by name.
pub(crate) fn scores(found: &Fit, p: &Parameters) -> Vec<(&'static str, Scores)> {
    P::ALL
        .iter()
        .filter_map(|q| {
            let own = found.parameter(q.name())?;
            let mut scores = Scores::default();
            scores.add(own.value, own.low, own.high, p.get(*q));
            Some((q.name(), scores))
        })
        .collect()
}

/// Scores combined by name.
pub(crate) fn by_name(rows: Vec<Vec<(&'static str, Scores)>>) -> Vec<(&'static str, Scores)> {
    let mut all: Vec<(&'static str, Scores)> = Vec::new();
    for (name, own) in rows.into_iter().flatten() {
        match all.iter_mut().find(|(n, _)| *n == name) {
            Some((_, scores)) => scores.append(own),
            None => all.push((name, own)),
        }
    }
    all
}
