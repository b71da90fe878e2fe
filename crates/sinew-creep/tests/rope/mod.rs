//! The rope law as a law of creep fits: what is put in comes out, intervals cover, and what a
//! record can't tell is held or said.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_creep::*;
use sinew_model::rope::{Law as RopeLaw, Parameter as P, Parameters, RopeLoad, State};
use sinew_rope::Catalogue;
use std::sync::Arc;

mod entry;

/// One bench test: preload 2 N for a minute, a load, then 2 N again.
#[derive(Clone, Copy)]
struct Test {
    load_n: f64,
    celsius: f64,
    loaded_s: f64,
    after_s: f64,
}

const PRELOAD_N: f64 = 2.0;
const PRELOADED_S: f64 = 60.0;
/// Standard deviation of a reading: 0.002 %, 7 µm over 350 mm.
const SIGMA: f64 = 2e-5;

fn base() -> RopeBase {
    let catalogue = Catalogue::shipped().unwrap();
    RopeBase::new(catalogue.find("liros-dc000-0301").unwrap().entry.clone()).unwrap()
}

/// The catalogue's rope, elsewhere within its intervals.
fn truth() -> Parameters {
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

fn even_in_log(count: usize, last_s: f64) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| 5.0 * (last_s / 5.0).powf(i as f64 / (count - 1) as f64))
}

/// The law's own record, with noise; the zero is a mean of 20 readings.
fn record(p: Parameters, test: Test, sigma: f64, random: &mut ChaCha8Rng) -> Curve {
    let law = RopeLaw::new(p).unwrap();
    let load = |n: f64| RopeLoad::celsius(n, test.celsius);
    let strain = |s: &State, n: f64| 0.01 * law.strain(s, load(n)).unwrap().total_percent();
    let mut start = State::default();
    law.hold(&mut start, load(PRELOAD_N), PRELOADED_S).unwrap();
    let mut noise = |scale: f64| -> f64 {
        let z: f64 = StandardNormal.sample(random);
        scale * z
    };
    let zero = strain(&start, PRELOAD_N) + noise(sigma / 20.0_f64.sqrt());
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

const COLD: [Test; 2] = [
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

fn options(seed: u64) -> FitOptions {
    FitOptions {
        noise: NoiseKind::White,
        seed,
        rope: Some(Arc::new(base())),
        ..FitOptions::default()
    }
}

fn records(tests: &[Test], sigma: f64, seed: u64) -> Vec<Curve> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    tests
        .iter()
        .map(|t| record(truth(), *t, sigma, &mut random))
        .collect()
}

#[test]
fn two_loads_and_their_recovery_give_the_rope_back() {
    let started = std::time::Instant::now();
    let found = fit(Law::Rope, &records(&COLD, SIGMA, 1), &options(1)).unwrap();
    println!("{:?}", started.elapsed());
    let true_values = truth();
    let own = found.parameters.iter().filter(|p| p.name != "epsilon_0");
    for p in own {
        println!(
            "{:22} {:10.5} ± {:8.5}  {:10.5} … {:10.5}",
            p.name, p.value, p.std_error, p.low, p.high
        );
        let parameter = P::ALL.iter().find(|q| q.name() == p.name).unwrap();
        let value = true_values.get(*parameter);
        // One draw: four standard errors, 6e-5 by chance; and known to a twentieth.
        assert!((p.value - value).abs() < 4.0 * p.std_error, "{p:?} {value}");
        assert!(
            p.std_error < 0.05 * value && p.not_identifiable.is_none(),
            "{p:?}"
        );
    }
    assert_eq!(found.parameters.len(), 9);
    for h in &found.fixed {
        println!("fixed {}: {:?}", h.name, h.why);
    }
}

/// How many draws: some by default, `SINEW_SEEDS` for the figures of docs/src/science/creep.md.
fn seeds(default: u64) -> u64 {
    std::env::var("SINEW_SEEDS")
        .ok()
        .and_then(|s| s.parse().ok())
        .unwrap_or(default)
}

#[test]
fn intervals_of_the_rope_law_cover() {
    let count = seeds(12);
    let numbers: Vec<u64> = (0..count).collect();
    let p = truth();
    let rows = each(
        &numbers,
        |&seed| {
            let found = fit(
                Law::Rope,
                &records(&COLD, SIGMA, 100 + seed),
                &options(seed),
            )
            .unwrap();
            let all = P::ALL.iter();
            all.filter_map(|q| {
                let own = found.parameter(q.name())?;
                Some((q.name(), (own.low..=own.high).contains(&p.get(*q))))
            })
            .collect::<Vec<_>>()
        },
        |_| {},
    );
    for (i, (name, _)) in rows[0].iter().enumerate() {
        let share = rows.iter().filter(|r| r[i].1).count() as f64 / count as f64;
        println!("{name}: {:.1} % of {count}", 100.0 * share);
        let (least, most) = if count >= 200 {
            (0.92, 0.98)
        } else {
            (0.6, 1.0)
        };
        assert!((least..=most).contains(&share), "{name}: {share}");
    }
}

#[test]
fn what_one_load_does_not_tell_is_held_or_said() {
    let alone = [Test {
        after_s: 0.0,
        ..COLD[0]
    }];
    let found = fit(Law::Rope, &records(&alone, SIGMA, 7), &options(7)).unwrap();
    let fixed: Vec<&str> = found.fixed.iter().map(|h| h.name.as_str()).collect();
    for name in [
        "bedding_load_ratio",
        "delayed_energy_j_per_mol",
        "retraction_percent",
    ] {
        assert!(fixed.contains(&name), "{fixed:?}");
        assert!(found.parameter(name).is_none());
    }
    // Without unloading, what never recovers and what does look alike.
    let untold: Vec<&str> = found
        .parameters
        .iter()
        .filter(|p| p.not_identifiable.is_some())
        .map(|p| p.name.as_str())
        .collect();
    println!("{untold:?}");
    let wide = found.parameter("bedding_percent").unwrap();
    let both = fit(Law::Rope, &records(&COLD, SIGMA, 7), &options(7)).unwrap();
    let sharp = both.parameter("bedding_percent").unwrap();
    assert!(
        wide.high - wide.low > 3.0 * (sharp.high - sharp.low),
        "{wide:?} {sharp:?}"
    );
}

#[test]
fn a_hot_record_tells_the_retraction_and_the_energies() {
    let hot = Test {
        celsius: 60.0,
        ..COLD[0]
    };
    let tests = [COLD[0], COLD[1], hot];
    let found = fit(Law::Rope, &records(&tests, SIGMA, 11), &options(11)).unwrap();
    let p = truth();
    for q in [
        P::BeddingEnergy,
        P::DelayedEnergy,
        P::Retraction,
        P::RetractionTime,
    ] {
        let own = found.parameter(q.name()).unwrap();
        println!(
            "{:26} {:.4} … {:.4}, true {:.4}",
            q.name(),
            own.low,
            own.high,
            p.get(q)
        );
        // Four standard errors: one draw.
        assert!(
            (own.value - p.get(q)).abs() < 4.0 * own.std_error.max(1e-3 * p.get(q)),
            "{own:?}"
        );
    }
}

#[test]
fn criteria_choose_the_rope_law_for_its_own_data() {
    let curves = records(&COLD, SIGMA, 31);
    let options = FitOptions {
        intervals: false,
        ..options(31)
    };
    let mut fits: Vec<Fit> = Law::ALL
        .into_iter()
        .chain([Law::Rope])
        .map(|law| fit(law, &curves, &options).unwrap())
        .collect();
    fits.sort_by(|a, b| a.aicc.total_cmp(&b.aicc));
    assert_eq!(fits[0].law, Law::Rope);
    // What never recovers is in no other law.
    assert!(
        fits[1].aicc > fits[0].aicc + 100.0,
        "{}",
        fits[1].aicc - fits[0].aicc
    );
}

#[test]
fn the_rope_law_refuses_what_it_can_not_use() {
    let curves = records(&COLD[..1], SIGMA, 1);
    let refused = |curve: Curve, options: &FitOptions| {
        fit(Law::Rope, &[curve], options).unwrap_err().to_string()
    };
    let text = refused(curves[0].clone(), &FitOptions::default());
    assert!(text.contains("--rope NAME"), "{text}");
    let mut forceless = curves[0].clone();
    forceless.tension = None;
    let text = refused(forceless, &options(1));
    assert!(text.contains("newtons"), "{text}");
    let mut heavy = curves[0].clone();
    heavy.tension.as_mut().unwrap().per_step_n = 5000.0;
    let text = refused(heavy, &options(1));
    assert!(text.contains("breaks a rope of 4450 N"), "{text}");
    let mut hot = curves[0].clone();
    hot.temperature_c = Some(400.0);
    let text = refused(hot, &options(1));
    assert!(text.contains("200 °C"), "{text}");
}

#[test]
fn profile_and_bootstrap_intervals_agree_with_the_draws() {
    let curves = records(&COLD, SIGMA, 21);
    let of = |kind: IntervalKind| {
        let options = FitOptions {
            kind,
            ..options(21)
        };
        fit(Law::Rope, &curves, &options).unwrap()
    };
    let draws = of(IntervalKind::Draws);
    for kind in [IntervalKind::Profile, IntervalKind::Bootstrap] {
        let other = of(kind);
        for (a, b) in draws.parameters.iter().zip(&other.parameters) {
            assert_eq!(b.interval, kind);
            let ratio = (b.high - b.low) / (a.high - a.low);
            println!("{:24} {:?}: width {ratio:.2} of the draws'", a.name, kind);
            // 300 replicates know a 2.5 % quantile to a tenth of the width.
            assert!((0.7..1.4).contains(&ratio), "{a:?} {b:?}");
            assert!(b.low <= b.value && b.value <= b.high, "{b:?}");
        }
    }
}
