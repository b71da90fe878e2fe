//! Simulated creep tests with known truth: coverage of intervals, selection by criteria, detection
//! of artefacts.

use crate::support::laws::{KNOWN, noisy, times};
use sinew_creep::*;

mod records;
mod shifts;

/// Runs `work` for all seeds on all processors.
fn for_seeds<T: Send>(count: u64, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let workers = std::thread::available_parallelism().map_or(1, |w| w.get() as u64);
    std::thread::scope(|scope| {
        let handles: Vec<_> = (0..workers)
            .map(|w| {
                let work = &work;
                scope.spawn(move || {
                    (w..count)
                        .step_by(workers as usize)
                        .map(work)
                        .collect::<Vec<_>>()
                })
            })
            .collect();
        handles
            .into_iter()
            .flat_map(|h| h.join().unwrap())
            .collect()
    })
}

#[test]
fn law_intervals_are_calibrated() {
    for known in &KNOWN {
        for (scores, (name, _)) in known.scores(150).iter().zip(known.numbers) {
            scores.hold(&format!("{} {name}", known.law.name()));
        }
    }
}

#[test]
fn criteria_select_generating_law_and_forecast_covers() {
    type Truth = fn(f64) -> f64;
    let makers: [(Law, Truth); 3] = [
        (Law::LogTime, |t| 2e-3 + 3e-4 * (1.0 + t / 60.0).ln()),
        (Law::Findley, |t| 2e-3 + 2e-3 * (t / 3600.0).powf(0.35)),
        (Law::Burgers, |t| {
            2e-3 + 3e-4 * t / 3600.0 + 8e-4 * (1.0 - (-t / 300.0_f64).exp())
        }),
    ];
    const DRAWS: u64 = 100;
    let time = times(60, 5100.0);
    let later: Vec<f64> = (1..=10).map(|i| 5100.0 * f64::from(i)).collect();
    for (maker, truth) in makers {
        let outcome = for_seeds(DRAWS, |seed| {
            let strain = noisy(truth, &time, 1e-5, 1000 + seed);
            let curve = Curve::constant_load("made", time.clone(), strain);
            let options = FitOptions {
                noise: NoiseKind::White,
                intervals: false,
                seed,
                ..FitOptions::default()
            };
            let best = Law::ALL
                .into_iter()
                .map(|law| fit(law, std::slice::from_ref(&curve), &options).unwrap())
                .min_by(|a, b| a.aicc.total_cmp(&b.aicc))
                .unwrap();
            let own = fit(
                maker,
                &[curve],
                &FitOptions {
                    intervals: true,
                    ..options
                },
            )
            .unwrap();
            let forecast = Forecast::of(&own, 0, &later);
            let covered = (0..later.len())
                .filter(|&i| {
                    forecast.low_strain_ratio[i] <= truth(later[i])
                        && truth(later[i]) <= forecast.high_strain_ratio[i]
                })
                .count();
            (best.law == maker, covered as f64 / later.len() as f64)
        });
        let chosen = outcome.iter().filter(|o| o.0).count();
        let covered = outcome.iter().map(|o| o.1).sum::<f64>() / DRAWS as f64;
        println!(
            "{}: chosen {chosen}/{DRAWS}, next decade covered {:.1} %",
            maker.name(),
            100.0 * covered
        );
        // AICc keeps a superfluous parameter in about one case of ten.
        assert!(
            chosen * 10 >= DRAWS as usize * 8,
            "{} chosen {chosen}",
            maker.name()
        );
        // Points of one forecast are fully correlated: the error of 100 draws is 2.2 %.
        assert!(covered >= 0.885, "{} covered {covered}", maker.name());
    }
}

#[test]
fn unidentifiable_parameters_are_reported() {
    // Far beyond the record's end: only the slope c/τ is identifiable.
    let time = times(40, 5100.0);
    let strain = noisy(
        |t| 1e-3 + 0.05 * (1.0 - (-t / 1e6_f64).exp()),
        &time,
        1e-5,
        5,
    );
    let curve = Curve::constant_load("made", time, strain);
    let fit = fit(Law::Stretched, &[curve], &FitOptions::default()).unwrap();
    assert!(fit.parameter("tau").unwrap().not_identifiable.is_some());
    assert!(
        fit.parameter("epsilon_0")
            .unwrap()
            .not_identifiable
            .is_none()
    );
}

#[test]
fn loads_temperatures_and_unloading_are_fitted_jointly() {
    // ε = (F/60)^1.3 (J₀ + b ln(1 + t a_T/τ)), unloaded after 4000 s, two loads, two temperatures.
    let (j0, b, tau, p, energy) = (4e-3, 3e-4, 40.0, 1.3, 60.0);
    let shift = |c: f64| (energy * 1e3 / 8.314_462_618 * (1.0 / 296.15 - 1.0 / (c + 273.15))).exp();
    let mut curves = Vec::new();
    for (i, (load, celsius)) in [(1.0, 23.0), (0.5, 23.0), (1.0, 45.0)]
        .into_iter()
        .enumerate()
    {
        let mut time = times(60, 3990.0);
        time.extend(times(40, 3000.0).iter().map(|t| 4000.0 + t));
        let f = |t: f64| {
            let grow = |t: f64| {
                if t > 0.0 {
                    j0 + b * (1.0 + t * shift(celsius) / tau).ln()
                } else {
                    0.0
                }
            };
            f64::powf(load, p) * (grow(t) - grow(t - 4000.0))
        };
        let strain = noisy(f, &time, 1e-5, 50 + i as u64);
        let mut curve = Curve::constant_load(format!("specimen {i}"), time, strain);
        curve.steps = vec![(0.0, load), (4000.0, 0.0)];
        curve.temperature_c = Some(celsius);
        curves.push(curve);
    }
    let fit = fit(Law::LogTime, &curves, &FitOptions::default()).unwrap();
    // One draw each: within four standard errors, probability 6e-5.
    for (name, truth) in [
        ("tau", tau),
        ("p", p),
        ("E", energy),
        ("b", 100.0 * b),
        ("J_0", 100.0 * j0),
    ] {
        let found = fit.parameter(name).unwrap();
        assert!(
            (found.value - truth).abs() < 4.0 * found.std_error,
            "{name}: {found:?}"
        );
        assert!(found.std_error < 0.2 * truth.abs(), "{name}: {found:?}");
    }
}
