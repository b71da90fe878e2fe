//! Rope law as a law of creep fits: parameters are recovered, intervals cover, and parameters that
//! are not identifiable are fixed or reported.

use crate::support::bench::{
    COLD, SIGMA, Test, by_name, certain, options, records, records_of, sampled, scores, truth,
    truth_of, truth_of_one_load,
};
use crate::support::score::Scores;
use crate::support::seeds;
use sinew_creep::*;
use sinew_rope::law::{Parameter as P, Parameters};

mod entry;

#[test]
fn two_loads_with_recovery_determine_rope() {
    let started = std::time::Instant::now();
    let found = fit(Law::Rope, &records(&COLD, SIGMA, 1), &certain(1)).unwrap();
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
        // One draw: four standard errors, probability 6e-5; standard error below one twentieth.
        assert!((p.value - value).abs() < 4.0 * p.std_error, "{p:?} {value}");
        assert!(
            p.std_error < 0.05 * value && p.not_identifiable.is_none(),
            "{p:?}"
        );
    }
    assert_eq!(found.parameters.len(), 9);
    // Fixed parameters leave only the elasticity uncertain: two changes of load determine two of
    // its three numbers.
    let open = fit(Law::Rope, &records(&COLD, SIGMA, 1), &options(1)).unwrap();
    for (own, open) in found.parameters.iter().zip(&open.parameters) {
        let wider = open.std_error / own.std_error;
        let elastic = ["elastic_k", "toe_percent"].contains(&own.name.as_str());
        if own.name != "epsilon_0" {
            assert_eq!(wider > 3.0, elastic, "{}: {wider}", own.name);
        }
    }
}

/// Scores over a number of records of a set of tests.
fn over_seeds(
    count: u64,
    truth: impl Fn(u64) -> Parameters + Sync,
    curves: impl Fn(u64) -> Vec<Curve> + Sync,
) -> Vec<(&'static str, Scores)> {
    let numbers: Vec<u64> = (0..count).collect();
    let rows = each(
        &numbers,
        |&seed| {
            let found = fit(Law::Rope, &curves(seed), &options(seed)).unwrap();
            scores(&found, &truth(seed))
        },
        |_| {},
    );
    by_name(rows)
}

/// Scores of all parameters combined.
fn together(rows: &[(&str, Scores)]) -> Scores {
    let mut all = Scores::default();
    for (name, own) in rows {
        println!("{}", own.row(name));
        all.append(own.clone());
    }
    all
}

#[test]
fn rope_law_intervals_are_calibrated() {
    let rows = over_seeds(seeds(40), truth_of, |seed| {
        records_of(truth_of(seed), &COLD, SIGMA, 100 + seed)
    });
    assert_eq!(rows.len(), 7);
    together(&rows).hold("rope, two loads and recovery");
}

#[test]
fn load_step_between_measurements_is_no_ramp() {
    // One measurement every 30 s; the load changes anywhere between two of them.
    let rows = over_seeds(seeds(12), truth_of, |seed| {
        let test = |(i, t): (u64, &Test)| {
            sampled(truth_of(seed), *t, 30.0, SIGMA, 700 + 10 * seed + i).curve
        };
        (0..).zip(&COLD).map(test).collect()
    });
    let all = together(&rows);
    for (name, own) in &rows {
        assert!(own.inside(1.0) >= 0.7, "{name}: {}", own.inside(1.0));
    }
    assert!(all.right(1.0), "{}", all.mean_square(1.0));
}

#[test]
fn one_load_with_recovery_fixes_bedding_load_ratio() {
    let rows = over_seeds(seeds(24), truth_of_one_load, |seed| {
        records_of(truth_of_one_load(seed), &COLD[..1], SIGMA, 900 + seed)
    });
    let names: Vec<&str> = rows.iter().map(|r| r.0).collect();
    assert!(!names.contains(&"bedding_load_ratio"), "{names:?}");
    // The true λ_b is anywhere within the base rope's interval, and B depends on it.
    together(&rows).hold("rope, one load and recovery");
}

#[test]
fn unidentifiable_parameters_are_fixed_or_reported() {
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
    // Without unloading, recoverable and permanent strain are indistinguishable.
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
fn hot_record_determines_retraction_and_energies() {
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
        // One draw: four standard errors.
        assert!(
            (own.value - p.get(q)).abs() < 4.0 * own.std_error.max(1e-3 * p.get(q)),
            "{own:?}"
        );
    }
}

#[test]
fn criteria_select_rope_law_for_its_own_records() {
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
    // No other law has permanent strain.
    assert!(
        fits[1].aicc > fits[0].aicc + 100.0,
        "{}",
        fits[1].aicc - fits[0].aicc
    );
}

#[test]
fn rope_law_rejects_unsuitable_records() {
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
    assert!(
        text.contains("exceeds the breaking load of 4450 N"),
        "{text}"
    );
    let mut hot = curves[0].clone();
    hot.temperature_c = Some(400.0);
    let text = refused(hot, &options(1));
    assert!(text.contains("200 °C"), "{text}");
}

#[test]
fn profile_and_bootstrap_intervals_agree_with_draws() {
    // One load determines much less: fixed parameters contribute most of an interval there.
    for tests in [&COLD[..], &COLD[..1]] {
        let curves = records_of(truth(), tests, SIGMA, 21);
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
                // With one load the rope may be rigid: a profile ends at the bound.
                if tests.len() == 1 && a.name == "elastic_k" {
                    continue;
                }
                let ratio = (b.high - b.low) / (a.high - a.low);
                println!("{:24} {:?}: width {ratio:.2} of the draws'", a.name, kind);
                // The 2.5 % quantile of 300 replicates has an error of a tenth of the width.
                assert!((0.7..1.4).contains(&ratio), "{a:?} {b:?}");
                assert!(b.low <= b.value && b.value <= b.high, "{b:?}");
            }
        }
    }
}
