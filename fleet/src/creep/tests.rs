use super::*;
use sinew_model::Gaussian;

const FITTED_UTC_S: f64 = 1.75e9;
const DRIFT: f64 = 0.1e-3;
const AGES: Ages = Ages {
    from_days: 1.0,
    to_days: 300.0,
};

/// Days 1 to `days` of a rope that creeps by 5 mrad per decade; `more`: what a day reads beside, rad.
fn life(days: u32, more: impl Fn(f64) -> f64) -> Vec<SessionRecord> {
    (1..=days)
        .map(|day| {
            let day = f64::from(day);
            // Scatter of 0.14 mrad that follows no bin.
            let scatter = 0.2e-3 * (12.9898 * day * day).sin();
            SessionRecord {
                time_utc_s: FITTED_UTC_S + day * DAY_S,
                offset_rad: Some(Gaussian::new(
                    5e-3 * day.log10() + scatter + more(day),
                    0.3e-3,
                )),
                temperature_c: Some(21.0),
                ..SessionRecord::default()
            }
        })
        .collect()
}

fn found(sessions: &[SessionRecord]) -> Creep {
    creep(sessions, Some(FITTED_UTC_S), AGES, DRIFT).unwrap()
}

/// Within three stated deviations of 5 mrad, and those small.
fn is_five(creep: &Creep) -> bool {
    (creep.per_decade_rad - 5e-3).abs() < 3.0 * creep.deviation_rad && creep.deviation_rad < 0.3e-3
}

#[test]
fn a_rope_that_grows_by_5_mrad_per_decade_reads_so() {
    let creep = found(&life(365, |_| 0.0));
    assert!(is_five(&creep) && creep.steps == 0, "{creep:?}");
    assert!((creep.age_days[1] - 300.0).abs() < 1e-6);
}

#[test]
fn a_failed_strand_is_no_creep() {
    let creep = found(&life(365, |day| if day > 200.0 { 3e-3 } else { 0.0 }));
    assert!(is_five(&creep) && creep.steps == 1, "{creep:?}");
}

#[test]
fn a_tensioning_begins_a_new_zero_and_not_a_new_rope() {
    let mut sessions = life(365, |day| if day > 40.0 { -9e-3 } else { 0.0 });
    for session in &mut sessions[40..] {
        session.baseline = Some("tensioned".into());
    }
    let creep = found(&sessions);
    assert!(is_five(&creep) && creep.steps == 0, "{creep:?}");
}

#[test]
fn a_season_that_the_joint_drifts_with_is_no_creep() {
    let warmer = |day: f64| 7.0 * (day / 58.0).sin();
    let mut sessions = life(365, |day| 0.1e-3 * warmer(day));
    for (session, day) in sessions.iter_mut().zip(1..) {
        session.temperature_c = Some(21.0 + warmer(f64::from(day)));
    }
    assert!(is_five(&found(&sessions)), "{:?}", found(&sessions));
}

#[test]
fn sessions_that_are_off_by_themselves_hardly_count() {
    let creep = found(&life(
        365,
        |day| if day % 30.0 == 0.0 { 20e-3 } else { 0.0 },
    ));
    assert!(is_five(&creep), "{creep:?}");
}

#[test]
fn what_was_before_a_new_rope_is_not_its() {
    let sessions = life(400, |day| if day > 100.0 { -50e-3 } else { 0.0 });
    let fitted = FITTED_UTC_S + 100.5 * DAY_S;
    let creep = creep(&sessions, Some(fitted), AGES, DRIFT).unwrap();
    assert!((creep.age_days[0] - 1.5).abs() < 1e-6, "{creep:?}");
}

#[test]
fn a_few_days_tell_nothing() {
    assert_eq!(
        creep(&life(9, |_| 0.0), Some(FITTED_UTC_S), AGES, DRIFT),
        None
    );
}

#[test]
fn a_rope_that_is_too_young_for_the_ages_is_left_out() {
    assert_eq!(
        creep(&life(120, |_| 0.0), Some(FITTED_UTC_S), AGES, DRIFT),
        None
    );
    assert!(creep(&life(150, |_| 0.0), Some(FITTED_UTC_S), AGES, DRIFT).is_some());
}
