//! Creep tests made here, with known truth: intervals cover, criteria choose right, faults are
//! found.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_lab::creep::*;
use sinew_log::{Specimen, TestOptions, TestQuantity, read_test, read_test_bytes};

fn times(count: usize, last_s: f64) -> Vec<f64> {
    // Even in the logarithm, from 5 s on.
    (0..count)
        .map(|i| 5.0 * (last_s / 5.0).powf(i as f64 / (count - 1) as f64))
        .collect()
}

fn noisy(truth: impl Fn(f64) -> f64, time: &[f64], sigma: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    time.iter()
        .map(|t| {
            let z: f64 = StandardNormal.sample(&mut random);
            truth(*t) + sigma * z
        })
        .collect()
}

/// Runs `work` for seeds on all processors.
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

/// Share of 300 draws whose 95 % interval holds the truth; between 92 and 98 % (the binomial
/// error of 300 draws is 1.3 %).
fn coverage(law: Law, truth: impl Fn(f64) -> f64 + Sync, named: &[(&str, f64)]) {
    const DRAWS: u64 = 300;
    let time = times(40, 5100.0);
    let inside = for_seeds(DRAWS, |seed| {
        let strain = noisy(&truth, &time, 2e-5, seed);
        let curve = Curve::constant_load("made", time.clone(), strain);
        let options = FitOptions {
            noise: NoiseKind::White,
            seed,
            ..FitOptions::default()
        };
        let fit = fit(law, &[curve], &options).unwrap();
        named
            .iter()
            .map(|(name, value)| {
                let p = fit.parameter(name).unwrap();
                u32::from(p.low <= *value && *value <= p.high)
            })
            .collect::<Vec<_>>()
    });
    for (i, (name, _)) in named.iter().enumerate() {
        let share = inside.iter().map(|row| row[i]).sum::<u32>() as f64 / DRAWS as f64;
        println!("{} {name}: {:.1} %", law.name(), 100.0 * share);
        assert!(
            (0.92..=0.98).contains(&share),
            "{} {name}: {share}",
            law.name()
        );
    }
}

#[test]
fn intervals_cover_log_time() {
    coverage(
        Law::LogTime,
        |t| 2e-3 + 3e-4 * (1.0 + t / 60.0).ln(),
        &[("tau", 60.0), ("b", 0.03), ("epsilon_0", 0.2)],
    );
}

#[test]
fn intervals_cover_findley() {
    coverage(
        Law::Findley,
        |t| 2e-3 + 1e-3 * (t / 3600.0).powf(0.2),
        &[("n", 0.2), ("m", 0.1), ("epsilon_0", 0.2)],
    );
}

#[test]
fn intervals_cover_burgers() {
    coverage(
        Law::Burgers,
        |t| 2e-3 + 3e-4 * t / 3600.0 + 8e-4 * (1.0 - (-t / 300.0_f64).exp()),
        &[("tau", 300.0), ("s", 0.03), ("c", 0.08), ("epsilon_0", 0.2)],
    );
}

#[test]
fn criteria_choose_the_law_that_made_the_data_and_its_forecast_covers_the_next_decade() {
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
            let forecast = own.forecast(0, &later);
            let covered = (0..later.len())
                .filter(|&i| {
                    forecast.low[i] <= truth(later[i]) && truth(later[i]) <= forecast.high[i]
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
        // AICc keeps a needless parameter in about one case of ten.
        assert!(
            chosen * 10 >= DRAWS as usize * 8,
            "{} chosen {chosen}",
            maker.name()
        );
        // Points of one forecast stand and fall together: the error of 100 draws is 2.2 %.
        assert!(covered >= 0.885, "{} covered {covered}", maker.name());
    }
}

#[test]
fn what_a_record_does_not_tell_is_said_per_parameter() {
    // Far beyond the record's end: only the slope c/τ is told.
    let time = times(40, 5100.0);
    let strain = noisy(
        |t| 1e-3 + 0.05 * (1.0 - (-t / 1e6_f64).exp()),
        &time,
        1e-5,
        5,
    );
    let curve = Curve::constant_load("made", time, strain);
    let fit = fit(Law::Stretched, &[curve], &FitOptions::default()).unwrap();
    let why = fit
        .parameter("tau")
        .unwrap()
        .not_identifiable
        .clone()
        .unwrap();
    assert!(why.contains("fits"), "{why}");
    assert!(
        fit.parameter("epsilon_0")
            .unwrap()
            .not_identifiable
            .is_none()
    );
}

#[test]
fn unloading_loads_and_temperatures_are_fitted_together() {
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
    // Each is one draw: within four standard errors, 6e-5 by chance.
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

fn specimen(time: Vec<f64>, force: Vec<f64>, strain: Vec<f64>) -> Specimen {
    let mut s = Specimen::default();
    s.name = "made".into();
    s.lines = (0..time.len() as u64).collect();
    s.set_column(TestQuantity::Time, time);
    s.set_column(TestQuantity::Force, force);
    s.set_column(TestQuantity::Strain, strain);
    s
}

/// 2 N preload, ramp of 3 s at 30 s, 60 N for 4000 s, then 0.5 N for 1000 s; every second.
fn bench_record(seed: u64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let time: Vec<f64> = (0..=5030).map(f64::from).collect();
    let load = |t: f64| match t {
        t if t < 30.0 => 2.0,
        t if t < 33.0 => 2.0 + 58.0 * (t - 30.0) / 3.0,
        t if t < 4030.0 => 60.0,
        _ => 0.5,
    };
    let force = time.iter().map(|t| load(*t)).collect();
    let strain = noisy(
        |t| {
            let e = |t: f64| {
                if t > 0.0 {
                    2e-4 * (1.0 + t / 20.0).ln()
                } else {
                    0.0
                }
            };
            4e-3 * (load(t) - 2.0) / 58.0 + e(t - 31.5) - e(t - 4029.5) + 7e-4
        },
        &time,
        5e-6,
        seed,
    );
    (time, force, strain)
}

#[test]
fn zero_preload_ramp_stages_and_recovery_are_found() {
    let (time, force, strain) = bench_record(1);
    let prepared = prepare(&specimen(time, force, strain), &PrepareOptions::default()).unwrap();
    assert!((prepared.preload_n.unwrap() - 2.0).abs() < 1e-9);
    assert!((prepared.force_n.unwrap() - 60.0).abs() < 1e-9);
    assert_eq!(prepared.stages.len(), 2);
    assert!(
        (prepared.load_start_s - 30.0).abs() <= 1.0,
        "{}",
        prepared.load_start_s
    );
    assert!(prepared.stages[0].ramp_s <= 5.0, "{:?}", prepared.stages);
    assert!(prepared.faults.is_empty(), "{:?}", prepared.faults);
    let analysis = analyze(
        &prepared,
        &AnalyzeOptions {
            ..Default::default()
        },
    )
    .unwrap();
    let one_hour = analysis
        .readings
        .iter()
        .find(|r| r.time_s == 3600.0)
        .unwrap();
    let truth = 100.0 * (4e-3 + 2e-4 * (1.0 + 3600.0 / 20.0_f64).ln());
    // The zero's own error is 5e-6/√20, the reading's far less: 4 of them, in %.
    assert!(
        (one_hour.strain_percent - truth).abs() < 4.0 * 1.2e-4 + 1e-4,
        "{one_hour:?} {truth}"
    );
    assert_eq!(analysis.recovery.len(), 1);
    let recovery = analysis.recovery[0];
    assert!(
        (recovery.at_once_percent - 0.41).abs() < 0.02,
        "{recovery:?}"
    );
    assert!(recovery.delayed_percent > 0.05 && recovery.residual_percent > 0.0);
    let slope = analysis.slope_percent_per_h.unwrap();
    // Mean slope of the law over the same stretch; a curved truth widens the interval.
    let mean = 100.0 * 2e-4 * ((4020.0_f64 / 1220.0).ln()) / (2800.0 / 3600.0);
    assert!(slope.low < mean && mean < slope.high, "{slope:?} {mean}");
}

#[test]
fn faults_are_caught_or_survived() {
    let kinds = |p: &Prepared| p.faults.iter().map(|f| f.kind).collect::<Vec<_>>();
    let options = PrepareOptions::default();
    // Grip slip: taken out, so that the slope stays.
    let (time, force, strain) = bench_record(2);
    let clean = prepare(
        &specimen(time.clone(), force.clone(), strain.clone()),
        &options,
    )
    .unwrap();
    let mut slipped = strain.clone();
    slipped[2000..].iter_mut().for_each(|e| *e += 3e-4);
    let prepared = prepare(&specimen(time.clone(), force.clone(), slipped), &options).unwrap();
    assert_eq!(kinds(&prepared), [FaultKind::Slip]);
    let end = |p: &Prepared| analyze(p, &AnalyzeOptions::default()).unwrap().end_percent;
    assert!((end(&prepared) - end(&clean)).abs() < 1e-3);
    // Load drift of 3 %.
    let drifting: Vec<f64> = time
        .iter()
        .zip(&force)
        .map(|(t, f)| {
            if *f > 59.0 {
                f * (1.0 - 0.03 * (t - 33.0) / 4000.0)
            } else {
                *f
            }
        })
        .collect();
    let prepared = prepare(&specimen(time.clone(), drifting, strain.clone()), &options).unwrap();
    assert!(
        kinds(&prepared).contains(&FaultKind::LoadDrift),
        "{:?}",
        prepared.faults
    );
    // Repeated and falling stamps.
    let mut clock = time.clone();
    clock[100] = clock[99];
    clock[200] = clock[198];
    let prepared = prepare(&specimen(clock, force.clone(), strain.clone()), &options).unwrap();
    assert_eq!(kinds(&prepared), [FaultKind::Clock, FaultKind::Clock]);
    fit(Law::LogTime, &[prepared.curve], &FitOptions::default()).unwrap();
    // No ramp.
    let from = 40;
    let prepared = prepare(
        &specimen(
            time[from..4000].to_vec(),
            force[from..4000].to_vec(),
            strain[from..4000].to_vec(),
        ),
        &options,
    )
    .unwrap();
    assert_eq!(kinds(&prepared), [FaultKind::NoRamp]);
    // Swapped columns.
    let swapped = prepare(
        &specimen(time.clone(), strain.clone(), force.clone()),
        &options,
    );
    let text = swapped.unwrap_err().to_string();
    assert!(text.contains("swapped") || text.contains("m/m"), "{text}");
    // Percent taken as a ratio.
    let percent = strain.iter().map(|e| 1000.0 * e).collect();
    let text = prepare(&specimen(time.clone(), force.clone(), percent), &options)
        .unwrap_err()
        .to_string();
    assert!(text.contains("strain=COLUMN:%"), "{text}");
    // Nothing but NaN, and no change.
    let nan = vec![f64::NAN; time.len()];
    assert!(prepare(&specimen(time.clone(), force.clone(), nan), &options).is_err());
    let flat = prepare(
        &specimen(time.clone(), force.clone(), vec![1e-3; time.len()]),
        &options,
    );
    assert!(
        flat.and_then(|p| fit(Law::Findley, &[p.curve], &FitOptions::default()))
            .is_err()
    );
    let negative = force.iter().map(|f| -f).collect();
    assert!(prepare(&specimen(time, negative, strain), &options).is_err());
}

#[test]
fn shift_factors_of_a_made_material_come_back() {
    // A power law with an Arrhenius shift of 80 kJ/mol.
    let a_t = |c: f64| (80e3 / 8.314_462_618 * (1.0 / (c + 273.15) - 1.0 / 296.15)).exp();
    let isotherms: Vec<Isotherm> = [5.0, 14.0, 23.0, 32.0, 41.0]
        .into_iter()
        .map(|c| {
            let time_s = times(30, 5e4);
            Isotherm {
                temperature_c: c,
                value: time_s
                    .iter()
                    .map(|t| 1e-3 * (t / a_t(c)).powf(0.1))
                    .collect(),
                time_s,
            }
        })
        .collect();
    let found = superpose(&isotherms, 23.0).unwrap();
    assert_eq!(found.reference_c, 23.0);
    let (energy, rms) = found.arrhenius.unwrap();
    // A power law is a straight line on double logarithmic axes: exact but for rounding.
    assert!((energy - 80.0).abs() < 1e-6 && rms < 1e-9, "{energy} {rms}");
}

#[test]
fn published_shift_factors_are_met() {
    let shared = std::env::var_os("SINEW_SHARED").map_or_else(
        || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        Into::into,
    );
    let folder = shared.join("data/creep/pyvisco");
    if !folder.exists() {
        eprintln!("SKIPPED: {} is not there", folder.display());
        return;
    }
    let file = read_test(&folder.join("time_user_raw.csv"), &TestOptions::default()).unwrap();
    let isotherms: Vec<Isotherm> = file
        .specimens
        .iter()
        .map(|s| {
            let warm = s.column(TestQuantity::Temperature).unwrap();
            Isotherm {
                temperature_c: warm.iter().sum::<f64>() / warm.len() as f64,
                time_s: s.column(TestQuantity::Time).unwrap().to_vec(),
                value: s.column(TestQuantity::Modulus).unwrap().to_vec(),
            }
        })
        .collect();
    let found = superpose(&isotherms, 3.0).unwrap();
    let text = std::fs::read_to_string(folder.join("time_user_raw__shift_factors.csv")).unwrap();
    let published: Vec<(f64, f64)> = text
        .lines()
        .skip(2)
        .filter_map(|l| l.split_once(','))
        .map(|(t, a)| (t.parse().unwrap(), a.parse().unwrap()))
        .collect();
    assert_eq!(found.shifts.len(), published.len());
    let mut worst: f64 = 0.0;
    for shift in &found.shifts {
        let near = published.iter().min_by(|a, b| {
            (a.0 - shift.temperature_c)
                .abs()
                .total_cmp(&(b.0 - shift.temperature_c).abs())
        });
        let apart = shift.log10_a_t - near.unwrap().1;
        println!(
            "{:7.1} °C  {:8.3} ± {:.3}  published {:8.3}  apart {apart:+.3}  overlap {:.2}",
            shift.temperature_c,
            shift.log10_a_t,
            shift.std_error,
            near.unwrap().1,
            shift.overlap
        );
        // In the glass below −45 °C the modulus changes by a hundredth per decade and a shift is
        // hardly told: there its own error, 0.3 decades, is the measure.
        if shift.temperature_c > -45.0 {
            worst = worst.max(apart.abs());
        } else {
            assert!(apart.abs() < 4.0 * shift.std_error, "{shift:?}");
        }
    }
    // Of 28.6 decades: half a decade over the 20 links of a chain that the other program joined
    // by another criterion (power laws over the overlap).
    assert!(worst < 0.5, "{worst}");
}

#[test]
fn a_file_goes_from_bytes_to_numbers() {
    let (time, force, strain) = bench_record(3);
    let mut text = String::from("L0 (mm),350\nArea (mm2),2.0\ntime_s,force_N,elongation_mm\n");
    for ((t, f), e) in time.iter().zip(&force).zip(&strain) {
        text.push_str(&format!("{t},{f:.4},{:.6}\n", 350.0 * e));
    }
    let file = read_test_bytes(text.into_bytes(), "bench.csv", &TestOptions::default()).unwrap();
    let prepared = prepare(&file.specimens[0], &PrepareOptions::default()).unwrap();
    let analysis = analyze(&prepared, &AnalyzeOptions::default()).unwrap();
    assert!((analysis.stress_mpa.unwrap() - 30.0).abs() < 1e-6);
    let reading = analysis.readings[0];
    let modulus = reading.modulus_mpa.unwrap();
    assert!((modulus - 30.0 / (reading.strain_percent / 100.0)).abs() < 1e-6 * modulus);
}
