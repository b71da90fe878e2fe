//! Golden test: trend of two tendons' sessions, compared exactly.

use crate::answers::Answers;
use crate::random::Random;
use sinew_model::Gaussian;
use sinew_model::offset::SharedError;
use sinew_trend::filter::{
    Paths, Prior, Record, Trend, TrendConfig, TrendNow, first_passage, generic_curves,
};

const DAY_S: f64 = 86_400.0;

/// Session of a rope with constant creep per decade of time and temperature drift, whose strand
/// fails at a day.
fn session(day: f64, fails_at: f64, random: &mut Random) -> Record {
    let celsius = 23.0 + 6.0 * (random.uniform() - 0.5);
    let failed = day >= fails_at;
    let creep = 0.9e-3 * libm::log10(1.0 + 24.0 * day) + if failed { 2.2e-3 } else { 0.0 };
    let error = 0.08e-3 * (random.uniform() + random.uniform() - 1.0);
    // One in nine is inconclusive, one in seven has a large error, and one is an outlier.
    let n = (2.0 * day) as usize;
    let std = if n % 7 == 3 { 0.5e-3 } else { 0.1e-3 };
    let off = if n == 31 { 3e-3 } else { 0.0 };
    let offset = creep + 0.15e-3 * (celsius - 23.0) + error + off;
    Record {
        time_s: (day + 0.2) * DAY_S,
        offset_rad: (n % 9 != 5).then_some(Gaussian::new(offset, std)),
        shared: (n % 5 != 2).then_some(SharedError {
            baseline_rad: 0.05e-3,
            drift_rad: 0.02e-3,
        }),
        temperature_c: (n % 11 != 6).then_some(celsius),
        reference_c: (n % 4 == 1).then_some(22.5),
        stiffness: Some(Gaussian::new(if failed { -0.06 } else { 0.01 }, 0.01)),
    }
}

fn record_answers(trend: &Trend, answers: &mut Answers) {
    let now = TrendNow::of(trend);
    answers.gaussian("offset", now.offset_rad);
    answers.gaussian("whole", now.whole_rad);
    answers.gaussian("rate", now.rate_rad_per_s);
    answers.gaussian("drift", now.drift_rad_per_k);
    answers.gaussian("baseline error", now.baseline_error_rad);
    answers.number("slow", now.slow_std_rad);
    answers.number("white", now.white_scale);
    answers.number("filters", trend.components().len() as f64);
}

#[test]
fn filter_of_two_tendons_matches_golden() {
    let mut answers = Answers::default();
    for (name, fails_at, tensioned_at) in [("calm", f64::INFINITY, 30.0), ("fails", 22.0, 36.0)] {
        let mut random = Random(7);
        let prior = Prior::new(generic_curves(2e-3));
        let mut trend = Trend::new(prior, TrendConfig::default()).expect("a prior");
        for n in 0..100 {
            let day = f64::from(n) / 2.0;
            if day == tensioned_at {
                trend.tensioned((day + 0.1) * DAY_S).expect("in order");
            }
            if day == 42.0 {
                let rebased = trend.rebased((day + 0.15) * DAY_S, 0.03e-3);
                rebased.expect("in order");
            }
            let record = session(day, fails_at, &mut random);
            let added = trend.add(record).expect("in order");
            answers.about(&format!("{name}, day {day},"));
            answers.probability("jump", added.step_probability);
            answers.number("suspected", added.suspected_s.unwrap_or_default());
            answers.number("off", f64::from(u8::from(added.off)));
            for event in [added.confirmed, added.withdrawn].into_iter().flatten() {
                answers.gaussian("size", event.size_rad);
                answers.probability("happened", event.probability);
                answers.number("since", event.after_s);
                answers.number("sessions", f64::from(event.sessions));
            }
            if n % 10 == 9 {
                record_answers(&trend, &mut answers);
            }
        }
        answers.about(&format!("{name}, ahead,"));
        let times: Vec<f64> = (1..=12)
            .map(|k| trend.time_s() + 10.0 * f64::from(k) * DAY_S)
            .collect();
        let paths = Paths::draw(&trend, &times, 64, &mut || random.normal());
        for (k, _) in times.iter().enumerate() {
            let of = |paths: &[Vec<f64>]| paths.iter().map(|p| p[k]).sum::<f64>() / 64.0;
            answers.number(&format!("mean {k}"), of(&paths.offset_rad));
            answers.number(&format!("whole {k}"), of(&paths.whole_rad));
        }
        let passed = first_passage(&times, &paths.offset_rad, 3e-3);
        let soon: Vec<&f64> = passed.iter().filter(|t| t.is_finite()).collect();
        answers.number("passed", soon.len() as f64);
        answers.number("passed at", soon.into_iter().sum());
    }
    answers.hold("golden_filter.csv");
}
