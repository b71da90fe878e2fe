//! Preparation of records with artefacts.

use super::{for_seeds, noisy};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_creep::*;
use sinew_creep::{Specimen, TestOptions, TestQuantity, read_test_bytes};

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
    assert!(prepared.artefacts.is_empty(), "{:?}", prepared.artefacts);
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
    // The zero has an error of 5e-6/√20, a measurement far less: four of them, in %.
    assert!(
        (100.0 * one_hour.strain_ratio - truth).abs() < 4.0 * 1.2e-4 + 1e-4,
        "{one_hour:?} {truth}"
    );
    assert_eq!(analysis.recovery.len(), 1);
    let recovery = analysis.recovery[0];
    assert!(
        (100.0 * recovery.immediate_strain_ratio - 0.41).abs() < 0.02,
        "{recovery:?}"
    );
    assert!(recovery.delayed_strain_ratio > 5e-4 && recovery.residual_strain_ratio > 0.0);
    let slope = analysis.slope_per_s.unwrap().scaled(PERCENT_PER_H);
    // Mean slope of the law over the same segment; a curved truth widens the interval.
    let mean = 100.0 * 2e-4 * ((4020.0_f64 / 1220.0).ln()) / (2800.0 / 3600.0);
    assert!(slope.low < mean && mean < slope.high, "{slope:?} {mean}");
}

#[test]
fn artefacts_are_detected_or_tolerated() {
    let artefact = |p: &Prepared| match p.artefacts[..] {
        [artefact] => artefact,
        _ => panic!("{:?}", p.artefacts),
    };
    let options = PrepareOptions::default();
    // Grip slip: removed, so that the slope is unchanged.
    let (time, force, strain) = bench_record(2);
    let clean = prepare(
        &specimen(time.clone(), force.clone(), strain.clone()),
        &options,
    )
    .unwrap();
    let mut slipped = strain.clone();
    slipped[2000..].iter_mut().for_each(|e| *e += 3e-4);
    let prepared = prepare(&specimen(time.clone(), force.clone(), slipped), &options).unwrap();
    assert!(matches!(
        artefact(&prepared),
        Artefact::Slip { kept: false, .. }
    ));
    let end = |p: &Prepared| {
        let analysis = analyze(p, &AnalyzeOptions::default()).unwrap();
        analysis.end_strain_ratio
    };
    assert!((end(&prepared) - end(&clean)).abs() < 1e-5);
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
    let drifts = |f: &Artefact| matches!(f, Artefact::LoadDrift { .. });
    assert!(
        prepared.artefacts.iter().any(drifts),
        "{:?}",
        prepared.artefacts
    );
    // Duplicate and decreasing time stamps.
    let mut clock = time.clone();
    clock[100] = clock[99];
    clock[200] = clock[198];
    let prepared = prepare(&specimen(clock, force.clone(), strain.clone()), &options).unwrap();
    let clock = [
        Artefact::NonMonotonicTime { readings: 1 },
        Artefact::DuplicateTimestamps { readings: 1 },
    ];
    assert_eq!(prepared.artefacts, clock);
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
    assert_eq!(artefact(&prepared), Artefact::NoRamp);
    // Swapped columns.
    let swapped = prepare(
        &specimen(time.clone(), strain.clone(), force.clone()),
        &options,
    );
    let text = swapped.unwrap_err().to_string();
    assert!(text.contains("swapped") || text.contains("m/m"), "{text}");
    // Percent interpreted as a ratio.
    let percent = strain.iter().map(|e| 1000.0 * e).collect();
    let text = prepare(&specimen(time.clone(), force.clone(), percent), &options)
        .unwrap_err()
        .to_string();
    assert!(text.contains("strain=COLUMN:%"), "{text}");
    // Only NaN, and constant strain.
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
fn file_is_read_from_bytes_to_numbers() {
    let (time, force, strain) = bench_record(3);
    let mut text = String::from("L0 (mm),350\nArea (mm2),2.0\ntime_s,force_N,elongation_mm\n");
    for ((t, f), e) in time.iter().zip(&force).zip(&strain) {
        text.push_str(&format!("{t},{f:.4},{:.6}\n", 350.0 * e));
    }
    let file = read_test_bytes(text.into_bytes(), "bench.csv", &TestOptions::default()).unwrap();
    let prepared = prepare(&file.specimens[0], &PrepareOptions::default()).unwrap();
    let analysis = analyze(&prepared, &AnalyzeOptions::default()).unwrap();
    assert!((1e-6 * analysis.stress_pa.unwrap() - 30.0).abs() < 1e-6);
    let reading = analysis.readings[0];
    let modulus = 1e-6 * reading.modulus_pa.unwrap();
    assert!((modulus - 30.0 / reading.strain_ratio).abs() < 1e-6 * modulus);
}

// A straight line with an error that lasts 300 s, as from a room's climate: assumed independent,
// measurements every 20 s would make the slope's interval five times too narrow and its coverage
// one quarter.
#[test]
fn slope_interval_accounts_for_correlated_errors() {
    const RECORDS: u64 = 40;
    const PER_S: f64 = 3e-8;
    let decay = (-20.0_f64 / 300.0).exp();
    let inside = for_seeds(RECORDS, |seed| {
        let time: Vec<f64> = (-3..=255).map(|i| 20.0 * f64::from(i)).collect();
        let mut random = ChaCha8Rng::seed_from_u64(900 + seed);
        let mut slow = 0.0;
        let strain = time
            .iter()
            .map(|t| {
                let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
                slow = decay * slow + 2e-5 * (1.0 - decay * decay).sqrt() * normal();
                let creep = if *t > 0.0 { 4e-3 + PER_S * t } else { 0.0 };
                creep + slow + 5e-6 * normal()
            })
            .collect();
        let force = time.iter().map(|t| if *t > 0.0 { 60.0 } else { 2.0 });
        let record = specimen(time.clone(), force.collect(), strain);
        let prepared = prepare(&record, &PrepareOptions::default()).unwrap();
        let found = analyze(&prepared, &AnalyzeOptions::default()).unwrap();
        let slope = found.slope_per_s.unwrap();
        (slope.low..=slope.high).contains(&PER_S)
    });
    let share = inside.iter().filter(|i| **i).count() as f64 / RECORDS as f64;
    println!(
        "{:.0} % of {RECORDS} intervals hold the slope",
        100.0 * share
    );
    // Three standard errors below 95 %.
    assert!(share >= 0.85, "{share}");
}

/// A file of few readings, interpolated by a program to one row per second.
#[test]
fn interpolated_readings_are_excluded_with_warning() {
    let strain = |t: f64| 0.4 + 0.02 * (1.0 + t / 20.0).ln();
    let readings = [0, 10, 20, 60, 180, 360, 720, 1800, 3600, 5400, 7200, 9000];
    let rows = |values: &dyn Fn(u32) -> f64| -> String {
        let row = |t: u32| format!("{t},60,{:.9}\n", values(t));
        (0..=9000).map(row).collect()
    };
    let line = |t: u32| {
        let after = readings
            .partition_point(|r| *r <= t)
            .min(readings.len() - 1);
        let [from, to] = [readings[after - 1], readings[after]].map(f64::from);
        let share = (f64::from(t) - from) / (to - from);
        strain(from) + share * (strain(to) - strain(from))
    };
    let prepared = |rows: &str, options: &PrepareOptions| {
        let text = format!("time_s,force_N,strain_percent\n{rows}");
        let file = read_test_bytes(text.into_bytes(), "made", &TestOptions::default()).unwrap();
        prepare(&file.specimens[0], options).unwrap()
    };
    let lines = rows(&line);
    let found = prepared(&lines, &PrepareOptions::default());
    let times: Vec<f64> = readings.map(f64::from).to_vec();
    assert_eq!(found.curve.time_s, times);
    let is_reported = |p: &Prepared, is_kept: bool| {
        p.artefacts.contains(&Artefact::Interpolated {
            readings: 9001 - readings.len(),
            recorded: readings.len(),
            kept: is_kept,
        })
    };
    assert!(is_reported(&found, false), "{:?}", found.artefacts);
    let options = PrepareOptions {
        keep_artefacts: true,
        ..PrepareOptions::default()
    };
    let kept = prepared(&lines, &options);
    assert_eq!(kept.curve.time_s.len(), 9001);
    assert!(is_reported(&kept, true), "{:?}", kept.artefacts);
    // The curve itself, recorded every second, is complete.
    let smooth = rows(&|t| strain(f64::from(t)));
    let smooth = prepared(&smooth, &PrepareOptions::default());
    assert_eq!(smooth.curve.time_s.len(), 9001);
    assert_eq!(smooth.artefacts, [Artefact::NoRamp]);
}

/// Two rows at the time of a change of the load stay in the order of the file.
#[test]
fn load_change_at_one_time_keeps_the_order() {
    for start_s in [0.0, 1.7e9] {
        let mut time: Vec<f64> = (0..=80).map(|i| start_s + 60.0 * f64::from(i)).collect();
        time.extend((80..=160).map(|i| start_s + 60.0 * f64::from(i)));
        let force: Vec<f64> = (0..162)
            .map(|i| if i <= 80 { 100.0 } else { 60.0 })
            .collect();
        let strain: Vec<f64> = (0..162)
            .map(|i| {
                let age = f64::from(if i <= 80 { i } else { i - 81 });
                let creep = 1e-4 * (1.0 + age).ln();
                if i <= 80 {
                    5e-3 + creep
                } else {
                    4.5e-3 - creep
                }
            })
            .collect();
        let test = specimen(time, force, strain.clone());
        let prepared = prepare(&test, &PrepareOptions::default()).unwrap();
        assert_eq!(prepared.artefacts, [Artefact::NoRamp]);
        assert_eq!(prepared.curve.strain, strain);
        assert!(prepared.curve.windows.is_empty());
        let analysis = analyze(&prepared, &AnalyzeOptions::default()).unwrap();
        assert_eq!(analysis.end_strain_ratio, strain[80]);
        let recovery = analysis.recovery[0];
        assert_eq!(recovery.immediate_strain_ratio, strain[80] - strain[81]);
        fit(Law::LogTime, &[prepared.curve], &FitOptions::default()).unwrap();
    }
}
