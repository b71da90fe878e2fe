//! Step changes of a tendon: detected, distinguished, withdrawn; few and invalid records.

use crate::random::Random;
use crate::support::biorob_like;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use sinew_model::Gaussian;
use sinew_model::offset::SharedError;
use sinew_model::transmission::Tendon;
use sinew_rope::law::{RopeLoad, State};
use sinew_rope::work::Work;
use sinew_rope::{Catalogue, CatalogueRope, Draws};
use sinew_trend::filter::{
    Event, Paths, Prior, Record, Trend, TrendConfig, TrendError, TrendNow, generic_curves,
};
use sinew_trend::prior::rope_curves;

const DAY_S: f64 = 86_400.0;

fn record(days: f64, offset_rad: f64, std_rad: f64, temperature_c: f64) -> Record {
    Record {
        time_s: days * DAY_S,
        offset_rad: Some(Gaussian::new(offset_rad, std_rad)),
        temperature_c: Some(temperature_c),
        ..Record::default()
    }
}

/// Trend of a creeping tendon over a month and a half; `change(day)` is added to its true offset.
fn monitored(seed: u64, change: impl Fn(usize) -> f64) -> (Trend, Vec<(usize, f64, bool)>) {
    monitored_with_stiffness(seed, change, |_| None)
}

/// The same with a reported stiffness, over nominal less 1.
fn monitored_with_stiffness(
    seed: u64,
    change: impl Fn(usize) -> f64,
    stiffness: impl Fn(usize) -> Option<f64>,
) -> (Trend, Vec<(usize, f64, bool)>) {
    let mut trend =
        Trend::new(Prior::new(generic_curves(0.03)), TrendConfig::default()).expect("a prior");
    let mut random = Random(seed);
    let mut said = Vec::new();
    for day in 1..=45 {
        let t = day as f64;
        let y = 1e-3 * (24.0 * t).ln() + change(day) + 0.3e-3 * random.normal();
        let mut record = record(t, y, 0.3e-3, 23.0);
        // Errors of one fifth of the reported ones, as in sessions with one baseline.
        record.stiffness = stiffness(day).map(|s| Gaussian::new(s + 0.002 * random.normal(), 0.01));
        let added = trend.add(record).expect("in order");
        said.push((day, added.step_probability, added.confirmed.is_some()));
    }
    (trend, said)
}

#[test]
fn step_is_suspected_then_confirmed_by_next_record() {
    for seed in 0..8 {
        let (trend, said) = monitored(seed, |day| if day >= 30 { 3e-3 } else { 0.0 });
        let [event] = trend.events() else {
            panic!("seed {seed}: {:?}", trend.events());
        };
        assert_eq!(event.time_s, 30.0 * DAY_S, "seed {seed}");
        assert!(!event.tensioned);
        assert!(event.confirmed_s <= 32.0 * DAY_S, "seed {seed}: {event:?}");
        assert!(!said[29].2, "one record confirms nothing");
        let off = (event.size_rad.mean - 3e-3).abs();
        assert!(off < 3.0 * event.size_rad.std, "seed {seed}: {event:?}");
        assert!(event.size_rad.std < 0.6e-3, "seed {seed}: {event:?}");
    }
}

#[test]
fn change_beyond_every_error_alarms_immediately() {
    // A rope breaks, or a clamp slips, in either direction.
    for change in [-397e-3, 60e-3, 397e-3] {
        let (trend, said) = monitored(3, |day| if day >= 30 { change } else { 0.0 });
        let [event] = trend.events() else {
            panic!("{change}: {:?}", trend.events());
        };
        assert!(said[29].2, "{change}: confirmed by the session itself");
        assert_eq!(event.confirmed_s, 30.0 * DAY_S);
        assert!(!event.tensioned && event.sessions == 2, "{event:?}");
        assert!((event.size_rad.mean - change).abs() < 1e-3, "{event:?}");
        let now = TrendNow::of(&trend).offset_rad.mean;
        assert!(
            (now - change - 1e-3 * (24.0_f64 * 45.0).ln()).abs() < 1e-3,
            "{now}"
        );
    }
    // The level is updated by the session itself.
    let mut trend =
        Trend::new(Prior::new(generic_curves(0.03)), TrendConfig::default()).expect("a prior");
    for day in 1..=10 {
        let t = f64::from(day);
        trend
            .add(record(t, 1e-3 * (24.0 * t).ln(), 0.3e-3, 23.0))
            .expect("in order");
    }
    let added = trend
        .add(record(11.0, -0.39, 0.3e-3, 23.0))
        .expect("in order");
    assert_eq!(added.confirmed.map(|e| e.sessions), Some(1));
    assert!((TrendNow::of(&trend).offset_rad.mean + 0.39).abs() < 1e-3);
}

#[test]
fn unconfirmed_alarm_is_withdrawn_by_next_session() {
    let mut trend =
        Trend::new(Prior::new(generic_curves(0.03)), TrendConfig::default()).expect("a prior");
    let mut stored = trend.clone();
    for day in 1..=20 {
        let t = f64::from(day);
        let glitch = if day == 12 { 0.25 } else { 0.0 };
        let record = record(t, 1e-3 * (24.0 * t).ln() + glitch, 0.3e-3, 23.0);
        let added = trend.add(record).expect("in order");
        assert_eq!(added.confirmed.is_some(), day == 12, "day {day}: {added:?}");
        assert_eq!(added.withdrawn.is_some(), day == 13, "day {day}: {added:?}");
        let prior = stored.prior().clone();
        stored = Trend::resume(prior, TrendConfig::default(), stored.state()).expect("its own");
        assert_eq!(stored.add(record).expect("in order"), added);
    }
    assert!(trend.events().is_empty(), "{:?}", trend.events());
    let now = TrendNow::of(&trend).offset_rad;
    assert!((now.mean - 1e-3 * 480.0_f64.ln()).abs() < 0.3e-3, "{now:?}");
    assert_eq!(trend, stored);
}

#[test]
fn single_session_within_error_is_not_confirmed() {
    // A step of 15 mrad may be an outlier: 2 in 1000 are, with a standard deviation of 6 mrad.
    let (trend, said) = monitored(3, |day| if day >= 30 { 15e-3 } else { 0.0 });
    assert!(said[29].1 > 0.5 && !said[29].2, "{:?}", said[29]);
    assert_eq!(trend.events().len(), 1);
    // A small step is not confirmed by two sessions either.
    let (trend, said) = monitored(1, |day| if day >= 30 { 0.9e-3 } else { 0.0 });
    let most = said.iter().map(|s| s.1).fold(0.0, f64::max);
    assert!((0.05..0.95).contains(&most), "{most}");
    assert!(trend.events().is_empty(), "{:?}", trend.events());
}

#[test]
fn single_outlier_is_no_step_change() {
    for seed in 0..8 {
        let (trend, said) = monitored(seed, |day| if day == 30 { 5e-3 } else { 0.0 });
        assert!(
            trend.events().is_empty(),
            "seed {seed}: {:?}",
            trend.events()
        );
        assert!(said[31].1 < 0.05, "seed {seed}: withdrawn, {:?}", said[31]);
    }
    for seed in 100..108 {
        let (trend, _) = monitored(seed, |_| 0.0);
        assert!(
            trend.events().is_empty(),
            "seed {seed}: {:?}",
            trend.events()
        );
    }
}

#[test]
fn tensioning_is_distinguished_from_step() {
    let fall = |day: usize| if day >= 30 { -5e-3 } else { 0.0 };
    let (trend, _) = monitored(5, fall);
    let [event] = trend.events() else {
        panic!("{:?}", trend.events());
    };
    assert!(event.tensioned && event.size_rad.mean < -3e-3, "{event:?}");

    // A specified one of a linear viscoelastic rope, `c = 1e-3 ln(1 + t/min)`, that had lost half of its
    // tension: by superposition half of the curve starts again.
    let anew = |t: f64| 0.5e-3 * (1440.0 * (t - 29.5)).max(0.0).ln_1p();
    let mut stated =
        Trend::new(Prior::new(generic_curves(0.03)), TrendConfig::default()).expect("a prior");
    let mut random = Random(5);
    for day in 1..=45 {
        let t = f64::from(day);
        if day == 30 {
            stated.tensioned((t - 0.5) * DAY_S).expect("in order");
        }
        let y = 1e-3 * (24.0 * t).ln() + anew(t) + fall(day as usize) + 0.3e-3 * random.normal();
        stated.add(record(t, y, 0.3e-3, 23.0)).expect("in order");
    }
    assert_eq!(stated.events().len(), 1, "{:?}", stated.events());
    // The rope keeps its elongation; the offset has decreased by 5 mrad.
    let mut now = |trend: &Trend, added: f64| {
        let paths = Paths::draw(trend, &[trend.time_s()], 400, &mut || random.normal());
        let mean = |rows: &[Vec<f64>]| rows.iter().map(|r| r[0]).sum::<f64>() / 400.0;
        let (offset, whole) = (mean(&paths.offset_rad), mean(&paths.whole_rad));
        let true_whole = 1e-3 * (24.0_f64 * 45.0).ln() + added;
        assert!((offset - (true_whole - 5e-3)).abs() < 0.4e-3, "{offset}");
        let square = |r: &Vec<f64>| (r[0] - whole) * (r[0] - whole);
        let std = (paths.whole_rad.iter().map(square).sum::<f64>() / 400.0).sqrt();
        (whole - true_whole, std)
    };
    let (error, std) = now(&trend, 0.0);
    assert!(error.abs() < 0.8e-3, "{error} {std}");
    // The creep before the first session is not distinguished from the removed offset.
    let (error, std) = now(&stated, anew(45.0));
    assert!(error.abs() < 1.96 * std, "{error} {std}");
}

#[test]
fn small_step_with_stiffness_loss_is_more_probable() {
    // Four times a session's independent error.
    let small = |day: usize| if day >= 30 { 1.2e-3 } else { 0.0 };
    let none = |_: usize| 0.0;
    let failed = |day: usize| Some(if day >= 30 { 0.05 } else { 0.1 });
    let kept = |_: usize| Some(0.1);
    let sure = |said: &[(usize, f64, bool)]| {
        // Days 30 to 32: the probability, 1 after confirmation.
        let days = &said[29..32];
        if days.iter().any(|d| d.2) {
            1.0
        } else {
            days[2].1
        }
    };
    let (mut with, mut without, mut slip) = (0.0, 0.0, 0.0);
    // The errors differ, because a stiffness draws random numbers, too.
    const SEEDS: u64 = 24;
    for seed in 0..SEEDS {
        let share = 1.0 / SEEDS as f64;
        with += share * sure(&monitored_with_stiffness(seed, small, failed).1);
        without += share * sure(&monitored(seed, small).1);
        slip += share * sure(&monitored_with_stiffness(seed, small, kept).1);
        // A stiffness loss alone, such as from a wrong model of the gripper, is no step change.
        let (trend, _) = monitored_with_stiffness(seed, none, failed);
        assert!(trend.events().is_empty(), "{:?}", trend.events());
    }
    println!("failed {with:.2}, not told {without:.2}, slip {slip:.2}");
    assert!(with > without + 0.1, "{with} {without}");
    assert!(slip <= without, "{slip} {without}");
}

// After a strand failure, a session with unknown load may interpret lost stiffness as elongation.
#[test]
fn scatter_after_strand_failure_raises_no_alarm() {
    const FAILS: usize = 90;
    let mut alarms = 0;
    for seed in 0..24 {
        let mut trend =
            Trend::new(Prior::new(generic_curves(0.03)), TrendConfig::default()).expect("a prior");
        let mut random = Random(seed);
        for day in 1..=240 {
            let t = day as f64;
            let mut y = 1e-3 * (24.0 * t).ln() + 0.3e-3 * random.normal();
            let misread = random.uniform() < 0.2;
            let by = 1.5e-3 + 0.8e-3 * random.normal();
            if day >= FAILS {
                y += 4e-3 + if misread { by } else { 0.0 };
            }
            // Most of the reported error is common.
            let shared = Some(SharedError {
                baseline_rad: 0.8e-3,
                drift_rad: 0.0,
            });
            let record = Record {
                shared,
                ..record(t, y, 0.9e-3, 23.0)
            };
            trend.add(record).expect("in order");
        }
        let Some((event, others)) = trend.events().split_first() else {
            panic!("seed {seed}: nothing found");
        };
        let late_days = event.time_s / DAY_S - FAILS as f64;
        assert!((0.0..3.0).contains(&late_days), "seed {seed}: {event:?}");
        if !others.is_empty() {
            println!("seed {seed}: {} more", others.len());
        }
        alarms += others.len();
    }
    println!("{alarms} false alarms in 24 times 150 days");
    // One pair of sessions in 25 has two equal errors in a row, so that two sessions agree. With
    // errors assumed independent there were 12 alarms.
    assert!(alarms <= 6, "{alarms}");
}

/// Events of half a year after a strand failure on day 60; `late` are additional changes of offset
/// and stiffness from day 120 on.
fn after_a_strand(seed: u64, late: [f64; 2], misread: f64) -> Vec<Event> {
    let mut trend =
        Trend::new(Prior::new(generic_curves(0.03)), TrendConfig::default()).expect("a prior");
    let mut random = Random(seed);
    for day in 1..=150 {
        let t = day as f64;
        let mut y = 1e-3 * (24.0 * t).ln() + 0.2e-3 * random.normal();
        let mut k = 0.002 * random.normal();
        if day >= 60 {
            // Stiffness error of a session, and the correlated offset error: 0.6 mrad per percent.
            let mut off = 0.004 * random.normal();
            if (120..124).contains(&day) {
                off += misread;
            }
            y += 3e-3 + 0.06 * off;
            k += off - 0.06;
        }
        if day >= 120 {
            y += late[0];
            k += late[1];
        }
        let stiffness = Some(Gaussian::new(k, 0.02));
        let record = Record {
            stiffness,
            ..record(t, y, 0.5e-3, 23.0)
        };
        trend.add(record).expect("in order");
    }
    trend.events().to_vec()
}

#[test]
fn correlated_stiffness_errors_are_no_second_failure() {
    for seed in 0..6 {
        // Four days in a row with a stiffness 4 % too high, and an offset 2.4 mrad too large.
        let events = after_a_strand(seed, [0.0; 2], 0.04);
        assert_eq!(events.len(), 1, "seed {seed}: {events:?}");
        assert_eq!(events[0].time_s, 60.0 * DAY_S, "seed {seed}");
        // Steps of that size with unchanged and with reduced stiffness are events.
        for late in [[2.4e-3, 0.0], [2.4e-3, -0.04]] {
            let events = after_a_strand(seed, late, 0.0);
            let [_, event] = events[..] else {
                panic!("seed {seed}: {events:?}");
            };
            let day = event.time_s / DAY_S;
            assert!((120.0..122.0).contains(&day), "seed {seed}: {event:?}");
            // The actual stiffness loss carries no information about the size.
            let off = (event.size_rad.mean - late[0]).abs();
            assert!(off < 3.0 * event.size_rad.std, "seed {seed}: {event:?}");
        }
    }
}

#[test]
fn small_step_is_tracked_without_alarm() {
    // A hundred times a session's independent error, and half of the reported minimum.
    let step = |day: usize| if day >= 30 { 0.5e-3 } else { 0.0 };
    let mut trend =
        Trend::new(Prior::new(generic_curves(0.03)), TrendConfig::default()).expect("a prior");
    let mut random = Random(3);
    for day in 1..=45 {
        let t = f64::from(day);
        let y = 1e-3 * (24.0 * t).ln() + step(day as usize) + 0.005e-3 * random.normal();
        trend.add(record(t, y, 0.025e-3, 23.0)).expect("in order");
    }
    assert!(trend.events().is_empty(), "{:?}", trend.events());
    let expected = 1e-3 * (24.0_f64 * 45.0).ln() + 0.5e-3;
    let Gaussian { mean: offset, std } = TrendNow::of(&trend).offset_rad;
    assert!((offset - expected).abs() < 3.0 * std, "{offset} {std}");
    // Four times that size.
    let mut trend =
        Trend::new(Prior::new(generic_curves(0.03)), TrendConfig::default()).expect("a prior");
    for day in 1..=45 {
        let t = f64::from(day);
        let y = 1e-3 * (24.0 * t).ln() + 4.0 * step(day as usize) + 0.005e-3 * random.normal();
        trend.add(record(t, y, 0.025e-3, 23.0)).expect("in order");
    }
    assert_eq!(trend.events().len(), 1, "{:?}", trend.events());
}

#[test]
fn creep_in_steps_has_step_variance() {
    let mut prior = Prior::new(generic_curves(0.03));
    prior.curves.truncate(1);
    prior.curves[0].amplitude = 10e-3;
    prior.curves[0].amplitude_std = 1e-9;
    prior.noises.truncate(1);
    prior.noises[0].creep_rate_rel_error = 0.0;
    prior.level_std_rad = 1e-9;
    prior.step_rad = 0.2e-3;
    let curve = prior.curves[0].clone();
    let crept = |days: f64| 10e-3 * (curve.at(days * DAY_S) - curve.at(prior.baseline_s));
    let trend = Trend::new(prior.clone(), TrendConfig::default()).expect("a prior");
    let mut random = Random(8);
    const PATHS: usize = 4000;
    let times: Vec<f64> = (1..=100).map(|d| f64::from(d) * DAY_S).collect();
    let paths = Paths::draw(&trend, &times, PATHS, &mut || random.normal());
    for (k, days) in [(9, 10.0), (99, 100.0)] {
        let n = PATHS as f64;
        let mean = paths.offset_rad.iter().map(|p| p[k]).sum::<f64>() / n;
        let square = paths.offset_rad.iter().map(|p| (p[k] - mean).powi(2));
        let ratio = square.sum::<f64>() / n / (0.2e-3 * crept(days));
        // The variance of 4000 draws has a standard error of 2.2 %.
        assert!((ratio - 1.0).abs() < 0.09, "{days}: {ratio}");
        assert!((mean / crept(days) - 1.0).abs() < 0.05, "{days}: {mean}");
    }
}

#[test]
fn few_or_invalid_records_are_handled() {
    let prior = Prior::new(generic_curves(0.03));
    let mut random = Random(2);
    for count in 0..3 {
        let mut trend = Trend::new(prior.clone(), TrendConfig::default()).expect("a prior");
        for i in 0..count {
            trend
                .add(record(1.0 + f64::from(i), 3e-3, 0.3e-3, 20.0))
                .expect("in order");
        }
        let times = [trend.time_s(), 100.0 * DAY_S, 1000.0 * DAY_S];
        let paths = Paths::draw(&trend, &times, 300, &mut || random.normal());
        assert_eq!(paths.offset_rad.len(), 300);
        let mut ends: Vec<f64> = paths.offset_rad.iter().map(|p| p[2]).collect();
        ends.sort_unstable_by(f64::total_cmp);
        let width = ends[285] - ends[15];
        assert!(width > 5e-3 && width < 0.2, "{count} records: {width}");
    }
    let mut trend = Trend::new(prior.clone(), TrendConfig::default()).expect("a prior");
    trend.add(record(2.0, 1e-3, 0.3e-3, 20.0)).expect("good");
    let before = trend.clone();
    for bad in [
        record(f64::NAN, 1e-3, 1e-4, 20.0),
        record(3.0, f64::INFINITY, 1e-4, 20.0),
        record(3.0, 1e-3, 0.0, 20.0),
        record(3.0, 1e-3, 1e-4, f64::NAN),
        Record {
            stiffness: Some(Gaussian::new(0.1, 0.0)),
            ..record(3.0, 1e-3, 1e-4, 20.0)
        },
    ] {
        assert_eq!(trend.add(bad), Err(TrendError::NotFinite));
    }
    assert!(matches!(
        trend.add(record(1.0, 1e-3, 1e-4, 20.0)),
        Err(TrendError::OutOfOrder { .. })
    ));
    assert_eq!(trend, before);
    let mut none = prior;
    none.curves.clear();
    assert_eq!(
        Trend::new(none, TrendConfig::default()),
        Err(TrendError::Prior)
    );
}

/// Service of a tendon whose tension relaxes, by the creep law of its rope.
struct Relaxing {
    tensioned_s: f64,
    /// Times and true offsets since the last tensioning: every morning after a night of rest, and
    /// half-hourly in the night of rest after the re-tensioning.
    offsets: Vec<(f64, f64)>,
}

impl Relaxing {
    /// Tension falls by `lost` of the pretension in proportion to `ln(1 + t/d)` until it is restored
    /// after two months; eight hours of work a day with peaks of that day.
    fn new(rope: &CatalogueRope, tendon: &Tendon, lost: f64, seed: u64) -> Option<Self> {
        const HOUR_S: f64 = 3600.0;
        const RETENSIONED_DAY: usize = 60;
        const LAST_DAY: usize = 80;
        let law = Draws::new(rope, 1, seed).expect("complete").laws[0];
        let work = Work::unknown(23.0, &mut ChaCha8Rng::seed_from_u64(seed));
        let pretension_n = tendon.pretension_n.expect("known");
        let read = RopeLoad::at_reference(pretension_n);
        let working = 1.0 + 3.0 * (work.mean_factor - 1.0);
        let load = |factor: f64| RopeLoad::celsius(pretension_n * factor, work.temperature_c);
        let rad_per_percent = 0.01 * tendon.length_m / tendon.joint_pulley_radius_m;
        let offset = |state: &State| {
            let strain = law.strain(state, read).expect("within range");
            rad_per_percent * strain.total_percent()
        };
        let mut random = Random(seed + 100);
        let mut state = State::default();
        law.hold(&mut state, load(1.0), HOUR_S).ok()?;
        let mut zero = offset(&state);
        let mut offsets = Vec::new();
        for day in 0..=LAST_DAY {
            let now_s = HOUR_S + day as f64 * DAY_S;
            if day > 0 {
                offsets.push((now_s, offset(&state) - zero));
            }
            let share = (1.0 + day as f64).ln() / (1.0 + RETENSIONED_DAY as f64).ln();
            let factor = match day <= RETENSIONED_DAY {
                true => 1.0 - lost * share,
                false => 1.0,
            };
            let peak_s = DAY_S * work.peak_share * (0.5 * random.normal()).exp();
            let peak_s = peak_s.min(4.0 * HOUR_S);
            let peak = work.peak_factor * (1.0 + 0.05 * random.normal()).max(0.7);
            let work_s = 8.0 * HOUR_S - peak_s;
            law.hold(&mut state, load(factor * working), work_s).ok()?;
            let peak = load(factor * peak.max(working));
            law.hold(&mut state, peak, peak_s).ok()?;
            if day != RETENSIONED_DAY {
                law.hold(&mut state, load(factor), 16.0 * HOUR_S).ok()?;
                continue;
            }
            zero = offset(&state);
            for half_hour in 1..=32 {
                law.hold(&mut state, load(1.0), 0.5 * HOUR_S).ok()?;
                let time_s = now_s + (8.0 + 0.5 * f64::from(half_hour)) * HOUR_S;
                if half_hour < 32 {
                    offsets.push((time_s, offset(&state) - zero));
                }
            }
        }
        Some(Self {
            tensioned_s: HOUR_S + RETENSIONED_DAY as f64 * DAY_S + 8.0 * HOUR_S,
            offsets,
        })
    }

    /// Trend of its sessions with a new baseline half an hour after the re-tensioning; `step_rad` is
    /// added ten days after it. Returns it with the error of its offset, in standard deviations.
    fn trend(&self, prior: Prior, step_rad: f64, seed: u64) -> (Trend, f64) {
        let mut trend = Trend::new(prior, TrendConfig::default()).expect("a prior");
        let mut random = Random(seed + 7);
        let mut bias = 0.15e-3 * random.normal();
        let (mut zero, mut truth) = (0.0, 0.0);
        let mut is_tensioned = false;
        for &(time_s, offset) in &self.offsets {
            if time_s > self.tensioned_s && !is_tensioned {
                is_tensioned = true;
                trend.tensioned(self.tensioned_s).expect("in order");
                trend.rebased(time_s, 1e-5).expect("in order");
                (zero, bias) = (offset, 0.15e-3 * random.normal());
                continue;
            }
            let is_late = time_s > self.tensioned_s + 10.0 * DAY_S;
            truth = offset - zero + if is_late { step_rad } else { 0.0 };
            let y = truth + bias + 0.06e-3 * random.normal();
            let shared = SharedError {
                baseline_rad: 0.15e-3,
                drift_rad: 0.0,
            };
            let session = Record {
                shared: Some(shared),
                ..record(time_s / DAY_S, y, 0.18e-3, 23.0)
            };
            trend.add(session).expect("in order");
        }
        let now = TrendNow::of(&trend).offset_rad;
        (trend, (truth - now.mean) / now.std)
    }
}

// The restored tension lets the rope creep by some mrad in the first days. Without that term five of
// these eight tendons have false step changes, and one offset of eight is covered.
#[test]
fn creep_after_tensioning_is_no_step_change() {
    const TENDONS: u64 = 8;
    let catalogue = Catalogue::shipped().expect("shipped");
    let rope = catalogue.find("liros-dc000-0301").expect("there");
    let robot = biorob_like();
    let mut tendons = robot.transmissions.iter().flatten();
    let tendon = tendons.find_map(|t| t.tendon.clone()).expect("one");
    let tendon = Tendon {
        guides: Vec::new(),
        ..tendon
    };
    let pretension_n = tendon.pretension_n.expect("known");
    let curves = rope_curves(rope, &tendon, pretension_n, None, 23.0, 7).expect("a law");
    let prior = Prior::new(curves);
    let steps = |trend: &Trend| -> Vec<f64> {
        let steps = trend.events().iter().filter(|e| !e.tensioned);
        steps.map(|e| e.time_s).collect()
    };
    let (mut stepped, mut covered) = (0, 0);
    for seed in 0..TENDONS {
        // Evenly over 0.1 to 0.9 in another order.
        let lost = 0.1 + 0.8 * ((0.618 * seed as f64) % 1.0);
        let service = Relaxing::new(rope, &tendon, lost, seed).expect("does not break");
        let (trend, z) = service.trend(prior.clone(), 0.0, seed);
        stepped += u64::from(!steps(&trend).is_empty());
        covered += u64::from(z.abs() < 1.96);
        if seed == 0 {
            let (trend, _) = service.trend(prior.clone(), 3e-3, seed);
            let days = steps(&trend);
            let mut days = days.iter().map(|s| (s - service.tensioned_s) / DAY_S);
            assert!(days.any(|d| (d - 10.7).abs() < 1.0), "{:?}", trend.events());
        }
    }
    // Of 40 such services 4 have false step changes. Of eight correct 95 % intervals fewer than six cover
    // the truth once in 170 times.
    assert!(stepped <= 1, "{stepped} of {TENDONS}");
    assert!(covered >= 6, "{covered} of {TENDONS}");
}
