//! Lifetimes against published data, SciPy's likelihoods and their own coverage.

use sinew_rope::survival::{
    Lifetime, ShapePosterior, Weibull, WeibullFit, kaplan_meier, survival_quantile,
};

/// Weeks in remission under 6-mercaptopurine (Freireich et al. 1963), the usual example of censored lifetimes.
fn remissions() -> Vec<Lifetime> {
    let broke = [6, 6, 6, 7, 10, 13, 16, 22, 23];
    let censored = [6, 9, 10, 11, 17, 19, 20, 25, 32, 32, 34, 35];
    let life = |broke: bool| {
        move |age: i32| Lifetime {
            age: f64::from(age),
            broke,
        }
    };
    let broken = broke.into_iter().map(life(true));
    broken
        .chain(censored.into_iter().map(life(false)))
        .collect()
}

#[test]
fn kaplan_meier_matches_published_example() {
    // lifelines 0.30 and R's survfit(conf.type = "log-log").
    let expected = [
        (6.0, 21, 3, 0.857_143, 0.619_718, 0.951_552),
        (7.0, 17, 1, 0.806_723, 0.563_147, 0.922_809),
        (10.0, 15, 1, 0.752_941, 0.503_200, 0.889_362),
        (13.0, 12, 1, 0.690_196, 0.431_610, 0.849_066),
        (16.0, 11, 1, 0.627_451, 0.367_511, 0.804_912),
        (22.0, 7, 1, 0.537_815, 0.267_779, 0.746_791),
        (23.0, 6, 1, 0.448_179, 0.188_052, 0.680_143),
    ];
    let found = kaplan_meier(&remissions());
    assert_eq!(found.len(), expected.len());
    for (p, (age, at_risk, broke, survival, low, high)) in found.iter().zip(expected) {
        assert_eq!((p.age, p.at_risk, p.broke), (age, at_risk, broke));
        assert!((p.survival - survival).abs() < 1e-6, "{p:?}");
        // 1.96 here, 1.95996 there.
        assert!((p.interval_95.low - low).abs() < 2e-5, "{p:?} {low}");
        assert!((p.interval_95.high - high).abs() < 2e-5, "{p:?} {high}");
    }
    assert_eq!(
        survival_quantile(&found, 0.5),
        [Some(13.0), Some(23.0), None]
    );
    assert_eq!(survival_quantile(&found, 0.9), [None, None, None]);
}

#[test]
fn kaplan_meier_ignores_order_and_ends_at_zero() {
    let mut reversed = remissions();
    reversed.reverse();
    assert_eq!(kaplan_meier(&reversed), kaplan_meier(&remissions()));
    let all = |broke| [2.0, 3.0, 3.0].map(|age| Lifetime { age, broke });
    let points = kaplan_meier(&all(true));
    let last = points.last().unwrap();
    assert_eq!((last.survival, last.interval_95.low), (0.0, 0.0));
    assert_eq!(last.interval_95.high, points[0].interval_95.high);
    assert!(kaplan_meier(&all(false)).is_empty());
    let nonsense = [0.0, -1.0, f64::NAN, f64::INFINITY].map(|age| Lifetime { age, broke: true });
    assert!(kaplan_meier(&nonsense).is_empty() && WeibullFit::new(&nonsense).is_none());
}

#[test]
fn weibull_fit_and_intervals_match_scipy() {
    // benches/peers/survival.py prints these.
    let fit = WeibullFit::new(&remissions()).unwrap();
    let close = |found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 2e-6, "{found} {expected}");
    };
    close(fit.law.shape, 1.353_734_5);
    close(fit.law.scale, 33.765_151);
    close(fit.log_likelihood, -41.658_678_477);
    let both = |found: [Option<f64>; 2], expected: [f64; 2]| {
        for (found, expected) in found.into_iter().zip(expected) {
            close(found.unwrap(), expected);
        }
    };
    both(fit.shape_interval_95, [0.723_665_422, 2.203_694_205]);
    both(
        fit.quantile_interval_95(0.1),
        [1.907_334_533, 12.273_337_936],
    );
    both(fit.quantile_interval_95(0.5), [16.246_950_037, 51.403_391]);
    let scale = 1.0 - (-1.0_f64).exp();
    both(
        fit.quantile_interval_95(scale),
        [21.847_682_947, 76.865_529_143],
    );
    for (age, low, high) in [
        (5.0, 0.796_308_916, 0.982_945_571),
        (20.0, 0.410_413_904, 0.790_112_065),
        (60.0, 0.002_930_530_7, 0.448_897_854),
    ] {
        let interval = fit.survival_interval_95(age);
        close(interval.low, low);
        close(interval.high, high);
    }
}

#[test]
fn weibull_fit_does_not_depend_on_unit() {
    let lives = remissions();
    let seconds: Vec<Lifetime> = (lives.iter())
        .map(|l| Lifetime {
            age: 604_800.0 * l.age,
            ..*l
        })
        .collect();
    let [a, b] =
        [&lives, &seconds].map(|lives| ShapePosterior::new(lives).unwrap().wear_probability());
    assert!((a - b).abs() < 1e-9, "{a} {b}");
    let (weeks, seconds) = (
        WeibullFit::new(&lives).unwrap(),
        WeibullFit::new(&seconds).unwrap(),
    );
    let same = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    same(weeks.law.shape, seconds.law.shape);
    same(604_800.0 * weeks.law.scale, seconds.law.scale);
    let [a, b] = [
        weeks.quantile_interval_95(0.1),
        seconds.quantile_interval_95(0.1),
    ];
    same(604_800.0 * a[0].unwrap(), b[0].unwrap());
}

#[test]
fn unidentifiable_lifetimes_return_no_fit() {
    let life = |age: f64, broke: bool| Lifetime { age, broke };
    assert!(WeibullFit::new(&[]).is_none());
    assert!(WeibullFit::new(&[life(5.0, true), life(7.0, false)]).is_none());
    // All at one age: the likelihood grows with the shape without end.
    assert!(WeibullFit::new(&[life(5.0, true); 4]).is_none());
    // Two broken ropes and many censored ones: the median has no upper bound.
    let mut lives = vec![life(10.0, true), life(11.0, true)];
    lives.extend([life(12.0, false); 30]);
    let fit = WeibullFit::new(&lives).unwrap();
    let [low, _] = fit.quantile_interval_95(0.5);
    assert!(low.unwrap() > 12.0);
    assert!(fit.quantile_interval_95(0.5)[1].is_none_or(|high| high > 50.0));
}

#[test]
fn remaining_lifetime_is_conditional_on_age() {
    let law = Weibull {
        shape: 2.0,
        scale: 100.0,
    };
    for share in [0.1, 0.5, 0.9] {
        let fresh = law.quantile(share);
        assert!((law.survival(fresh) - (1.0 - share)).abs() < 1e-12);
        let old = law.quantile_beyond(80.0, share);
        let left = law.survival(old) / law.survival(80.0);
        assert!(
            old > 80.0 && (left - (1.0 - share)).abs() < 1e-12,
            "{old} {left}"
        );
    }
    // Without wear the remaining lifetime does not depend on the age.
    let ageless = Weibull { shape: 1.0, ..law };
    let apart = ageless.quantile_beyond(80.0, 0.5) - 80.0;
    assert!((apart - ageless.quantile(0.5)).abs() < 1e-9);
}

/// Uniform numbers in 0..1, the same on every machine (splitmix64).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (((z ^ (z >> 31)) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
}

/// Intervals widened around their value on a logarithmic scale, and the number of `of` that cover the truth.
fn inside(of: &[([Option<f64>; 2], f64)], truth: f64, factor: f64) -> usize {
    let stretched = |([low, high], best): &([Option<f64>; 2], f64)| {
        let end = |end: &Option<f64>| end.map(|x| best * (x / best).powf(factor));
        end(low).is_none_or(|x| x <= truth) && end(high).is_none_or(|x| truth <= x)
    };
    of.iter().filter(|x| stretched(x)).count()
}

#[test]
fn weibull_interval_coverage() {
    const DRAWS: usize = 1200;
    let law = Weibull {
        shape: 1.6,
        scale: 300.0,
    };
    let mut seed = 7;
    let (mut shapes, mut lifetimes) = (Vec::new(), Vec::new());
    let mut curves = [0, 0, 0];
    for _ in 0..DRAWS {
        // 30 ropes, each observed for its own time: about a third is censored.
        let lives: Vec<Lifetime> = (0..30)
            .map(|_| {
                let age = law.quantile(uniform(&mut seed));
                let watched = 900.0 * uniform(&mut seed);
                Lifetime {
                    age: age.min(watched).max(0.5),
                    broke: age <= watched,
                }
            })
            .collect();
        let fit = WeibullFit::new(&lives).unwrap();
        shapes.push((fit.shape_interval_95, fit.law.shape));
        lifetimes.push((fit.quantile_interval_95(0.1), fit.law.quantile(0.1)));
        // The curve's band at an age, with the deviation stretched on its own scale.
        let at = 250.0;
        let points = kaplan_meier(&lives);
        let Some(p) = points.iter().rev().find(|p| p.age <= at) else {
            continue;
        };
        let scale = |s: f64| (-s.ln()).ln();
        let (best, truth) = (scale(p.survival), scale(law.survival(at)));
        for (count, factor) in curves.iter_mut().zip([1.0, 0.7, 1.4]) {
            let [low, high] = [p.interval_95.high, p.interval_95.low].map(scale);
            let holds =
                best + factor * (low - best) <= truth && truth <= best + factor * (high - best);
            *count += usize::from(holds);
        }
    }
    // Three standard deviations of a share of 0.95 among so many, and what a likelihood of 20 broken ropes is off by.
    let most = 3.0 * (0.95 * 0.05 / DRAWS as f64).sqrt() + 0.01;
    let right = |count: usize| (count as f64 / DRAWS as f64 - 0.95).abs() < most;
    for (what, of, truth) in [
        ("shape", &shapes, law.shape),
        ("age of 10 %", &lifetimes, law.quantile(0.1)),
    ] {
        let counts = [1.0, 0.7, 1.4].map(|factor| inside(of, truth, factor));
        println!("{what}: {counts:?} of {DRAWS} inside at 1, 0.7, 1.4 times the interval");
        assert!(right(counts[0]), "{what}: {counts:?}");
        assert!(!right(counts[1]) && !right(counts[2]), "{what}: {counts:?}");
    }
    println!("curve: {curves:?} of {DRAWS} inside at 1, 0.7, 1.4 times the band");
    assert!(
        right(curves[0]) && !right(curves[1]) && !right(curves[2]),
        "{curves:?}"
    );
}

/// Ages of 1, 2, 3 and 4 of which two broke: Σ t² is 30, independent of the unit of the sums.
#[test]
fn scale_posterior_is_gamma_with_sum_of_powers() {
    let lives = [(1.0, true), (2.0, false), (3.0, true), (4.0, false)];
    let fit = ShapePosterior::new(&lives.map(|(age, broke)| Lifetime { age, broke })).unwrap();
    for (shape, sum) in [(1.0, 10.0_f64), (2.0, 30.0), (3.0, 100.0)] {
        let (log, broke) = fit.rate(shape);
        assert!(
            (log - sum.ln()).abs() < 1e-12 && broke == 2.0,
            "{log} {broke}"
        );
    }
}

#[test]
fn shape_likelihood_matches_closed_form() {
    let lives = remissions();
    let fit = ShapePosterior::new(&lives).unwrap();
    // Straight from the lives, per logarithm of the shape, the scale integrated out.
    let of = |k: f64| {
        let broken = lives.iter().filter(|life| life.broke);
        let d = broken.clone().count() as f64;
        let ages: f64 = broken.map(|life| (k - 1.0) * life.age.ln()).sum();
        let powers: f64 = lives.iter().map(|life| life.age.powf(k)).sum();
        (d - 1.0) * k.ln() + ages - d * powers.ln()
    };
    for k in [0.3, 0.8, 1.35, 2.5, 5.0] {
        let (is, should) = (
            fit.log_likelihood(k) - fit.log_likelihood(1.0),
            of(k) - of(1.0),
        );
        assert!((is - should).abs() < 1e-10, "{k}: {is} {should}");
    }
}

/// Double sum over `ln k` and `k ln λ`, 600 by 1200 values in Python, with the prior of the shape and a flat one of the
/// scale: `p([300, 310], [250, 305])` and so on.
#[test]
fn wear_probability_matches_double_integral() {
    let of = |broke: &[f64], censored: &[f64]| {
        let broken = broke.iter().map(|&age| Lifetime { age, broke: true });
        let whole = censored.iter().map(|&age| Lifetime { age, broke: false });
        ShapePosterior::new(&broken.chain(whole).collect::<Vec<_>>())
    };
    for (broke, censored, expected) in [
        (&[300.0, 310.0][..], &[250.0, 305.0][..], 0.820_26),
        (&[300.0, 340.0], &[250.0, 305.0], 0.826_95),
        (&[100.0, 300.0], &[250.0, 305.0], 0.512_97),
        (&[9.0], &[4.0, 5.0, 7.0], 0.607_43),
    ] {
        let found = of(broke, censored).unwrap().wear_probability();
        assert!(
            (found - expected).abs() < 2e-4,
            "{broke:?}: {found} {expected}"
        );
    }
    let found = ShapePosterior::new(&remissions())
        .unwrap()
        .wear_probability();
    assert!((found - 0.707_83).abs() < 2e-4, "{found}");
    // Two at one age: Φ(σ) of a prior of σ = ln 5/1.96.
    let found = of(&[5.0, 5.0], &[]).unwrap().wear_probability();
    assert!((found - 0.794_22).abs() < 2e-4, "{found}");
    assert!(of(&[], &[5.0, 7.0]).is_none());
}

#[test]
fn further_failures_decide_the_sign_of_the_shape() {
    const Z: f64 = 1.645;
    let law = Weibull {
        shape: 1.6,
        scale: 300.0,
    };
    let ropes = |count: usize| -> Vec<Lifetime> {
        let share = |i: usize| (i as f64 + 0.5) / count as f64;
        (0..count)
            .map(|i| Lifetime {
                age: law.quantile(share(i)),
                broke: true,
            })
            .collect()
    };
    let few = ShapePosterior::new(&ropes(4)).unwrap();
    assert!(few.wear_probability() < 0.95, "{}", few.wear_probability());
    let more = few.further_failures(Z).unwrap();
    let enough = ShapePosterior::new(&ropes(4 + 2 * more)).unwrap();
    assert!(enough.wear_probability() > 0.95, "{more}");
    // Ropes that do not age decide nothing.
    let law = Weibull { shape: 1.0, ..law };
    let constant: Vec<Lifetime> = (0..8)
        .map(|i| Lifetime {
            age: law.quantile((f64::from(i) + 0.5) / 8.0),
            broke: true,
        })
        .collect();
    let undecided = ShapePosterior::new(&constant).unwrap();
    assert!(undecided.further_failures(Z).is_none_or(|n| n > 50));
}
