use super::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// Tendons of groups: how many each has, and what each differs by; two a robot, `tendon` apart.
fn groups(of: &[(usize, f64)], tendon: f64, robot: f64, seed: u64) -> Hierarchy {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut units: Vec<Unit> = Vec::new();
    let mut robots = 0;
    for (group, &(count, effect)) in of.iter().enumerate() {
        let mut of_robot = 0.0;
        for i in 0..count {
            if i % 2 == 0 {
                robots += 1;
                of_robot = robot * normal();
            }
            units.push(Unit {
                value: 1.0 + effect + of_robot + tendon * normal(),
                variance: 1e-4,
                spread: 1.0,
                robot: robots,
                columns: vec![(0, 1.0), (1 + group, 1.0)],
            });
        }
    }
    Hierarchy {
        units,
        fixed: vec![10.0],
        factors: vec![Factor {
            first: 1,
            levels: of.len(),
            scale: 0.2,
            heavy: true,
        }],
    }
}

/// Difference of a group to the mean of the others.
fn against_others(draws: &Draws, group: usize, groups: usize) -> [f64; 3] {
    let of = |b: &Vec<f64>| {
        let others = (0..groups).filter(|g| *g != group).map(|g| b[1 + g]);
        b[1 + group] - others.sum::<f64>() / (groups as f64 - 1.0)
    };
    median_and_95(draws.coefficients.iter().map(of).collect())
}

#[test]
fn draws_many_tendons_match_closed_form() {
    // Groups of 400 differ by much more than their means are uncertain: hardly anything is drawn in.
    let of = [(400, 0.0), (400, 0.5), (400, -0.4), (400, 0.1)];
    let model = groups(&of, 0.3, 0.0, 1);
    let draws = sample(&model, 1).unwrap();
    assert!(draws.disagreement < 1.05, "{}", draws.disagreement);
    let mean = |g: usize| {
        let own = model.units.iter().filter(|u| u.columns[1].0 == 1 + g);
        own.map(|u| u.value).sum::<f64>() / 400.0
    };
    let exact = mean(1) - (mean(0) + mean(2) + mean(3)) / 3.0;
    let [median, low, high] = against_others(&draws, 1, 4);
    let width = 2.0 * 1.96 * 0.3 * (1.0_f64 / 400.0 * (1.0 + 1.0 / 3.0)).sqrt();
    assert!((median - exact).abs() < 0.02, "{median} {exact}");
    assert!(
        (high - low - width).abs() < 0.15 * width,
        "{low} {high} {width}"
    );
}

#[test]
fn draws_group_of_two_is_shrunk_and_wide() {
    let mut of = vec![(60, 0.0); 8];
    of.push((2, 0.5));
    let model = groups(&of, 0.5, 0.0, 2);
    let draws = sample(&model, 1).unwrap();
    let [_, low, high] = against_others(&draws, 8, 9);
    let [_, narrow_low, narrow_high] = against_others(&draws, 0, 9);
    assert!(low < 0.0 && high > 0.0, "{low} {high}");
    assert!(high - low > 1.2 * (narrow_high - narrow_low));
}

#[test]
fn one_bad_group_among_equal_ones_keeps_its_size() {
    let mut of = vec![(100, 0.0); 8];
    of.push((100, 0.6));
    let draws = sample(&groups(&of, 0.5, 0.0, 3), 1).unwrap();
    let [median, low, high] = against_others(&draws, 8, 9);
    assert!((0.45..0.75).contains(&median), "{median}");
    assert!(low > 0.2 && high < 0.9, "{low} {high}");
}

#[test]
fn robots_that_differ_widen_the_intervals_of_their_groups() {
    let width = |robot: f64| {
        let draws = sample(
            &groups(&[(80, 0.3), (80, 0.0), (80, -0.3)], 0.2, robot, 4),
            1,
        )
        .unwrap();
        let [_, low, high] = against_others(&draws, 0, 3);
        high - low
    };
    // By closed form √((0.2² + 2 · 0.5²) / 0.2²) = 3.7 times.
    let ratio = width(0.5) / width(0.0);
    assert!((2.5..5.0).contains(&ratio), "{ratio}");
}

/// How many true differences between a group and the mean of the others lie in their intervals, of `fleets` times 18.
fn held(fleets: u64, effect: impl Fn(usize, f64) -> f64) -> usize {
    let one = |seed: u64| {
        let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
        let effects: Vec<f64> = (0..18)
            .map(|group| effect(group, StandardNormal.sample(&mut rng)))
            .collect();
        let of: Vec<(usize, f64)> = effects.iter().map(|e| (8, *e)).collect();
        let draws = sample(&groups(&of, 0.25, 0.0, seed), 1).unwrap();
        let sum: f64 = effects.iter().sum();
        let is_held = |g: &usize| {
            let truth = effects[*g] - (sum - effects[*g]) / 17.0;
            let [_, low, high] = against_others(&draws, *g, 18);
            low <= truth && truth <= high
        };
        (0..18).filter(is_held).count()
    };
    (0..fleets).map(one).sum()
}

#[test]
fn draws_normal_groups_have_nominal_coverage() {
    // A mean of 8 tendons scatters by 0.09. 95 % are 1026, by chance ± 7 were all apart, and the 18 of a fleet share their τ.
    let held = held(60, |_, normal| 0.08 * normal);
    assert!((1010..=1060).contains(&held), "{held} of 1080");
}

#[test]
fn draws_equal_seed_is_reproducible() {
    let model = groups(&[(10, 0.0), (10, 0.1)], 0.2, 0.1, 5);
    assert_eq!(sample(&model, 7), sample(&model, 7));
}
