//! Calibration of forecasts: simulated data with known truth, one decade of time ahead.

use crate::skipped::skipped;
use crate::support;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_creep::*;
use support::outside::{END_S as RECORD_S, Family, forecast_and_truth};
use support::seeds;

const END_S: f64 = 5100.0;

fn times(count: usize) -> Vec<f64> {
    (0..count)
        .map(|i| 5.0 * (END_S / 5.0).powf(i as f64 / (count - 1) as f64))
        .collect()
}

/// Generator of creep strain.
#[derive(Clone, Copy)]
enum Maker {
    LogTime,
    Findley,
    Burgers,
    KelvinVoigt,
    Stretched,
    /// Schapery's law with Findley's kernel at a stress ratio.
    Schapery(f64),
    /// Schapery's law with three Kelvin elements.
    SchaperyProny(f64),
}

/// Load-dependent factors of Schapery's law at a stress ratio `x` (1: the reference stress), of
/// the form found for thermoplastics: each 1 at small stress, `g₁ g₂` rising, `a_σ` falling.
fn factors(x: f64) -> [f64; 4] {
    [
        1.0 + 0.1 * x,
        1.0 + 0.15 * x,
        1.0 + 0.25 * x * x,
        (-0.8 * x).exp(),
    ]
}

impl Maker {
    /// Strain `t` after a step of load; Schapery: `g₀ D₀ σ + g₁ g₂ σ ΔD(t/a_σ)`, which is his
    /// integral under a constant stress.
    fn strain(self, t: f64) -> f64 {
        let power = |t: f64| 2e-3 * (t / 3600.0).powf(0.35);
        let prony = |t: f64| {
            [(4e-4, 60.0), (5e-4, 900.0), (8e-4, 14_000.0_f64)]
                .iter()
                .map(|(c, tau)| -c * (-t / tau).exp_m1())
                .sum::<f64>()
        };
        let schapery = |x: f64, kernel: &dyn Fn(f64) -> f64| {
            let [g0, g1, g2, a] = factors(x);
            g0 * 2e-3 * x + g1 * g2 * x * kernel(t / a)
        };
        match self {
            Maker::LogTime => 2e-3 + 3e-4 * (t / 60.0).ln_1p(),
            Maker::Findley => 2e-3 + power(t),
            Maker::Burgers => 2e-3 + 3e-4 * t / 3600.0 - 8e-4 * (-t / 300.0).exp_m1(),
            Maker::KelvinVoigt => {
                2e-3 - 6e-4 * (-t / 120.0).exp_m1() - 9e-4 * (-t / 3000.0).exp_m1()
            }
            Maker::Stretched => 2e-3 - 1.5e-3 * (-(t / 2000.0).powf(0.45)).exp_m1(),
            Maker::Schapery(x) => schapery(x, &power),
            Maker::SchaperyProny(x) => schapery(x, &prony),
        }
    }

    fn curve(self, seed: u64) -> Curve {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let time = times(60);
        let strain = time
            .iter()
            .map(|t| {
                let z: f64 = StandardNormal.sample(&mut random);
                self.strain(*t) + 1e-5 * z
            })
            .collect();
        Curve::constant_load("made", time, strain)
    }
}

/// Fits and forecasts of one record.
struct Outcome {
    chosen: Law,
    /// Shares of ten later times inside: the generating law without and with back-tests, all laws
    /// combined.
    bare: Option<f64>,
    own: Option<f64>,
    all: f64,
    end: bool,
    half_width: f64,
}

fn forecast(maker: Maker, own: Option<Law>, seed: u64) -> Outcome {
    let later: Vec<f64> = (1..=10).map(|i| END_S * f64::from(i)).collect();
    let curve = maker.curve(seed);
    let options = FitOptions {
        noise: NoiseKind::Correlated,
        seed,
        ..FitOptions::default()
    };
    let fits: Vec<Fit> = Law::ALL
        .into_iter()
        .filter_map(|law| fit(law, std::slice::from_ref(&curve), &options).ok())
        .collect();
    let best = fits
        .iter()
        .min_by(|a, b| a.aicc.total_cmp(&b.aicc))
        .unwrap();
    let outlook = ForecastSet::of(&fits, std::slice::from_ref(&curve), 0, &options, &later);
    let inside = |f: &Forecast, i: usize| {
        let truth = maker.strain(later[i]);
        f.low_strain_ratio[i] <= truth && truth <= f.high_strain_ratio[i]
    };
    let share = |f: &Forecast| (0..10).filter(|i| inside(f, *i)).count() as f64 / 10.0;
    let all = outlook.combined.unwrap();
    let creep = maker.strain(END_S) - maker.strain(5.0);
    Outcome {
        chosen: best.law,
        bare: own.map(|law| {
            let fit = fits.iter().find(|f| f.law == law).unwrap();
            share(&Forecast::of(fit, 0, &later))
        }),
        own: own.map(|law| {
            let found = outlook.laws.iter().find(|l| l.0 == law).unwrap();
            share(found.1.as_ref().unwrap())
        }),
        all: share(&all),
        end: inside(&all, 9),
        half_width: 0.5 * (all.high_strain_ratio[9] - all.low_strain_ratio[9]) / creep,
    }
}

/// Coverage of forecasts by the generating law and by all laws, over many records of one generator.
/// A record needs fifteen fits, so that ordinary runs test three of the generators.
fn judge(name: &str, maker: Maker, own: Option<Law>, always: bool) {
    let count = seeds(if always { 4 } else { 0 });
    if count == 0 {
        skipped(format_args!("{name}; SINEW_SEEDS=60 measures it"));
        return;
    }
    let numbers: Vec<u64> = (1000..1000 + count).collect();
    let rows = each(&numbers, |&seed| forecast(maker, own, seed), |_| {});
    let percent = |sum: f64| 100.0 * sum / count as f64;
    let chosen = own.map(|law| percent(rows.iter().filter(|r| r.chosen == law).count() as f64));
    let by_bare = percent(rows.iter().filter_map(|r| r.bare).sum());
    let by_own = percent(rows.iter().filter_map(|r| r.own).sum());
    let by_all = percent(rows.iter().map(|r| r.all).sum());
    let ends = percent(rows.iter().filter(|r| r.end).count() as f64);
    let width = percent(rows.iter().map(|r| r.half_width).sum());
    println!(
        "{name}: chosen {chosen:.0?} %, own law {by_bare:.1} %, back-tested {by_own:.1} %, all {by_all:.1} %, ends {ends:.1} %, half width {width:.0} % of creep ({count})"
    );
    // A dozen draws: two or three misses are within chance.
    let (least, right) = if count >= 100 {
        (91.0, 70.0)
    } else {
        (70.0, 50.0)
    };
    assert!(by_all >= least, "{name}: {by_all}");
    assert!(chosen.is_none_or(|c| c >= right), "{name}: {chosen:?}");
}

#[test]
fn log_time() {
    judge("log-time", Maker::LogTime, Some(Law::LogTime), true);
}

#[test]
fn findley() {
    judge("findley", Maker::Findley, Some(Law::Findley), false);
}

#[test]
fn burgers() {
    judge("burgers", Maker::Burgers, Some(Law::Burgers), false);
}

#[test]
fn kelvin_voigt() {
    judge(
        "kelvin-voigt",
        Maker::KelvinVoigt,
        Some(Law::KelvinVoigt),
        false,
    );
}

#[test]
fn stretched() {
    judge("stretched", Maker::Stretched, Some(Law::Stretched), false);
}

#[test]
fn schapery_with_findley_kernel_is_findley() {
    for x in [0.3, 0.6, 1.0] {
        let name = format!("schapery {x}");
        judge(&name, Maker::Schapery(x), Some(Law::Findley), x == 1.0);
    }
}

#[test]
fn schapery_with_three_elements() {
    for x in [0.3, 1.0] {
        let name = format!("schapery-prony {x}");
        judge(&name, Maker::SchaperyProny(x), None, x == 1.0);
    }
}

// A year from 85 min, of materials that no law of the set generated. The laws' own intervals cover
// half to two thirds of them.
#[test]
fn year_ahead_of_other_materials_is_covered() {
    const YEAR_S: f64 = 365.25 * 86_400.0;
    let later = [10.0 * RECORD_S, YEAR_S];
    let cases: Vec<(Family, u64)> = (Family::ALL.into_iter())
        .flat_map(|family| (500..500 + seeds(5)).map(move |seed| (family, seed)))
        .collect();
    let held = each(
        &cases,
        |&(family, seed)| {
            let (all, truth) = forecast_and_truth(family, seed, &later).unwrap();
            let inside = |i: usize| {
                all.low_strain_ratio[i] <= truth[i] && truth[i] <= all.high_strain_ratio[i]
            };
            [inside(0), inside(1)]
        },
        |_| {},
    );
    for (family, own) in Family::ALL
        .iter()
        .zip(held.chunks(held.len() / Family::ALL.len()))
    {
        println!("{}: {own:?}", family.name());
    }
    for (i, time) in ["ten times as long", "a year"].into_iter().enumerate() {
        let inside = held.iter().filter(|h| h[i]).count();
        println!("{time}: {inside} of {} inside", held.len());
        // 95 % less two and a half standard errors of 20.
        assert!(
            inside as f64 >= 0.82 * held.len() as f64,
            "{time}: {inside}"
        );
    }
}
