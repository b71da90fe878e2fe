//! Coverage of the intervals of predictions and plans: 95 % of ropes drawn by an independent method lie in
//! the 95 % intervals. Intervals of 0.7 and of 1.4 times the width fail that test.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use sinew_model::Bounded;
use sinew_rope::law::entry::{CatalogueEntry, Uncertainty};
use sinew_rope::law::strung::{Strand, StrandAssembly};
use sinew_rope::law::{Law, Parameter, Parameters, RopeLoad, State};
use sinew_rope::predict::{DAY_S, Request, Route, YEAR_S, predict};
use sinew_rope::pretension::{self, Mount, plan};
use sinew_rope::{Catalogue, CatalogueRope, Duty};

/// Number of drawn ropes, by prediction and by test. The share of 95 % of 1500 has a standard error of 0.6 %,
/// and the quantiles of 1500 draws have the same.
const ROPES: usize = 1500;
/// Number of drawn ropes of the relaxation test, which takes a hundred times as long.
const RELAXATION_ROPES: usize = 600;
/// Permitted coverage: 95 % ± 3 standard errors of both.
const BAND: (f64, f64) = (0.926, 0.974);

/// A drawn rope: each value from its own interval, on a log scale for a factor.
fn rope_as_it_might_be(entry: &CatalogueEntry, rng: &mut ChaCha8Rng) -> Law {
    let mut parameters = entry.parameters().expect("complete");
    for (&key, value) in &entry.law {
        let z: f64 = StandardNormal.sample(rng);
        let drawn = match value.uncertainty {
            Uncertainty::NotSpecified => value.value,
            Uncertainty::Factor(f) => value.value * f.powf(z / 1.959_964),
            Uncertainty::PlusMinus(d) => value.value + z * d / 1.959_964,
        };
        set(&mut parameters, key, drawn);
    }
    let law = Law::new(parameters).expect("in range");
    law.giving_back(rng.random())
}

fn set(parameters: &mut Parameters, key: Parameter, drawn: f64) {
    let (low, high) = key.range();
    parameters.set(key, drawn.clamp(low, high));
}

/// Interval widened by a factor on a log scale around its value.
fn scaled(i: Bounded, by: f64) -> (f64, f64) {
    let of = |end: f64| i.value * (end / i.value).powf(by);
    (of(i.low), of(i.high))
}

#[track_caller]
fn covers(what: &str, interval: Bounded, truths: &[f64]) {
    let share = |by: f64| {
        let (low, high) = scaled(interval, by);
        let inside = truths.iter().filter(|t| (low..=high).contains(*t)).count();
        inside as f64 / truths.len() as f64
    };
    let [narrow, own, wide] = [0.7, 1.0, 1.4].map(share);
    println!("{what}: {own:.3} inside, {narrow:.3} of 0.7, {wide:.3} of 1.4 times the interval");
    let holds = |share: f64| (BAND.0..=BAND.1).contains(&share);
    assert!(holds(own), "{what}: {own}");
    assert!(
        !holds(narrow) && !holds(wide),
        "{what} has too few ropes: {narrow} {wide}"
    );
}

fn shipped(name: &str) -> CatalogueRope {
    let catalogue = Catalogue::shipped().expect("shipped");
    catalogue.find(name).expect("there").clone()
}

/// Model error of a law beyond its data, implemented independently, of immediate strain and creep:
/// `s₀² = (0.25 ln λ/λ₀)² + (0.0051 ΔT)²`, `s² = (0.25 ln λ/λ₀)² + (0.035 ΔT)² + 0.3² D`.
fn miss(rope: &CatalogueRope, tension_n: f64, celsius: f64, time_s: f64) -> [f64; 2] {
    let tested_range = rope.entry.tested_range.expect("stated");
    let share = tension_n / rope.entry.parameters().expect("complete").breaking_load_n;
    let load = 0.25 * (share / tested_range.load_share[1]).ln().max(0.0);
    let warm = (celsius - tested_range.temperature_c[1]).max(0.0);
    let decades = (time_s / tested_range.duration_s).log10().max(0.0);
    let creep = load.hypot(2.0_f64.ln() / 19.6 * warm);
    [load.hypot(warm / 196.0), creep.hypot(0.3 * decades.sqrt())]
}

/// Times from a minute to `time_s`, evenly over the logarithm.
fn steps(time_s: f64, count: u32) -> Vec<f64> {
    let ratio = time_s / 60.0;
    let at = |i: u32| 60.0 * ratio.powf(f64::from(i) / f64::from(count));
    (0..=count).map(at).collect()
}

/// Creep from a minute to the last of several times, with the model error `doubt`: in whole where the error adds,
/// otherwise by the midpoint rule, as creep does not recede.
fn crept(strains: &[f64], times_s: &[f64], doubt: f64, error: impl Fn(f64) -> f64) -> f64 {
    let (first, last) = (strains[0], strains[strains.len() - 1]);
    if doubt > 0.0 {
        return (doubt * error(times_s[times_s.len() - 1])).exp() * (last - first);
    }
    let part = |(strain, time_s): (&[f64], &[f64])| {
        let middle_s = (time_s[0] * time_s[1]).sqrt();
        (doubt * error(middle_s)).exp() * (strain[1] - strain[0])
    };
    strains.windows(2).zip(times_s.windows(2)).map(part).sum()
}

#[test]
fn prediction_intervals_cover_drawn_ropes() {
    for (name, tension_n, celsius, time_s) in [
        ("liros-dc000-0301", 60.0, 23.0, 3600.0),
        ("liros-dc000-0301", 300.0, 23.0, DAY_S),
        ("ockert-climax-combat", 60.0, 33.0, YEAR_S),
        ("tu-chemnitz-technora-black", 60.0, 23.0, YEAR_S),
    ] {
        let rope = shipped(name);
        let asked = Request {
            duty: Duty::constant(tension_n, celsius),
            route: Route::straight(0.7),
            times_s: vec![time_s],
            read_at: None,
            draws: ROPES,
            seed: 1,
        };
        let found = predict(&rope, &asked).expect("a prediction").readings[0];
        let load = RopeLoad::celsius(tension_n, celsius);
        let [at_once, _] = miss(&rope, tension_n, celsius, time_s);
        let times_s = steps(time_s, 60);
        let mut rng = ChaCha8Rng::seed_from_u64(77);
        let (mut grown, mut all) = (Vec::new(), Vec::new());
        for _ in 0..ROPES {
            let law = rope_as_it_might_be(&rope.entry, &mut rng);
            let mut state = State::default();
            let (mut strains, mut from_s) = (Vec::new(), 0.0);
            for time_s in &times_s {
                law.hold(&mut state, load, time_s - from_s).expect("load");
                strains.push(law.strain(&state, load).expect("load").total_percent());
                from_s = *time_s;
            }
            let doubt: f64 = StandardNormal.sample(&mut rng);
            let error = |time_s: f64| miss(&rope, tension_n, celsius, time_s)[1];
            let more = crept(&strains, &times_s, doubt, error);
            grown.push(7e-3 * more);
            all.push(7e-3 * ((doubt * at_once).exp() * strains[0] + more));
        }
        let label = format!("{name}, {tension_n} N, {celsius} °C, {time_s:.0} s");
        covers(
            &format!("{label}, since tensioned"),
            found.since_tensioned_m,
            &grown,
        );
        covers(&format!("{label}, from slack"), found.elongation_m, &all);
    }
}

#[test]
fn lifetime_intervals_cover_drawn_ropes() {
    let name = "teufelberger-fl-9-ng";
    let rope = shipped(name);
    // Days of life, so that the limit of 300 years lies far outside the interval.
    let asked = Request {
        duty: Duty::constant(1950.0, 60.0),
        route: Route::straight(1.0),
        times_s: vec![DAY_S],
        read_at: None,
        draws: ROPES,
        seed: 1,
    };
    let found = predict(&rope, &asked).expect("a prediction");
    let found = found.lifetime.breaks_after_s.expect("some day");
    let load = RopeLoad::celsius(1950.0, 60.0);
    let mut rng = ChaCha8Rng::seed_from_u64(78);
    let truths: Vec<f64> = (0..ROPES)
        .map(|_| {
            let law = rope_as_it_might_be(&rope.entry, &mut rng);
            let z: f64 = StandardNormal.sample(&mut rng);
            // It parts at 10 % of flow, known to a factor of 1.5.
            let parts_at = 10.0 * 1.5_f64.powf(z / 1.959_964);
            let life_s = parts_at / law.rates(load).expect("load").flow_percent_per_s;
            let doubt: f64 = StandardNormal.sample(&mut rng);
            let [_, later] = miss(&rope, 1950.0, 60.0, life_s);
            (life_s * (-doubt * later).exp()).min(1e10)
        })
        .collect();
    covers("life", found, &truths);
}

/// State with its creep times a factor.
fn times(state: State, factor: f64) -> State {
    State {
        bedding_percent: factor * state.bedding_percent,
        delayed_percent: state.delayed_percent.map(|v| factor * v),
        flow_percent: factor * state.flow_percent,
        ..state
    }
}

#[test]
fn plan_intervals_cover_drawn_ropes() {
    let name = "liros-dc000-0301";
    let rope = shipped(name);
    let request = pretension::Request {
        tension_n: 60.0,
        temperature_c: 23.0,
        length_m: 0.7,
        mount: Mount {
            series_compliance_m_per_n: 2e-5,
            ..Mount::default()
        },
        horizon_s: 30.0 * DAY_S,
        lowest_n: 20.0,
        remove: 0.8,
        draws: RELAXATION_ROPES,
        seed: 1,
    };
    let found = plan(&rope, &request).expect("a plan");
    let mut rng = ChaCha8Rng::seed_from_u64(79);
    let truths: Vec<f64> = (0..RELAXATION_ROPES)
        .map(|_| {
            let law = rope_as_it_might_be(&rope.entry, &mut rng);
            let doubt: f64 = StandardNormal.sample(&mut rng);
            let factor = |time_s: f64| (doubt * miss(&rope, 60.0, 23.0, time_s)[1]).exp();
            let times_s = steps(30.0 * DAY_S, 24);
            let mut state = State::default();
            let load = RopeLoad::at_reference(60.0);
            law.hold(&mut state, load, 60.0).expect("load");
            let mut tension_n = 60.0;
            for step in times_s.windows(2) {
                // Every creep of the law is proportional to these. Where the error adds, it is that of the horizon.
                let factor = match doubt > 0.0 {
                    true => factor(30.0 * DAY_S),
                    false => factor((step[0] * step[1]).sqrt()),
                };
                let mut parameters = *law.parameters();
                parameters.bedding_percent *= factor;
                parameters.delayed_percent *= factor;
                parameters.flow_rate_per_s *= factor;
                let scaled = Law::new(parameters).expect("in range");
                let strand = Strand {
                    series_compliance_m_per_n: 2e-5,
                    ..Strand::straight(scaled, 0.7, times(state, factor))
                };
                // The rope keeps its length, so that it may be tied off again at any time.
                let strung = StrandAssembly::new(vec![strand], tension_n, 296.15, 0.0);
                let mut strung = strung.expect("load");
                let left = strung.leave(step[1] - step[0], None, 1e-6, |_, _| ());
                left.expect("load");
                tension_n = strung.tension_n();
                state = times(strung.strands()[0].pieces[0].state, 1.0 / factor);
            }
            tension_n
        })
        .collect();
    covers(
        "tension",
        found.schedule_as_delivered.tension_at_end_n,
        &truths,
    );
}
