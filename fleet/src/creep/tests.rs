use super::*;
use sinew_model::Gaussian;

const FITTED_UTC_S: f64 = 1.75e9;
const DRIFT: f64 = 0.1e-3;
const AGES: Ages = Ages {
    from_days: 1.0,
    to_days: 300.0,
};

/// Days 1 to `days` of a rope that creeps by 5 mrad per decade, with an additional offset `more` in rad per day.
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
    (creep.per_decade_rad - 5e-3).abs() < 3.0 * creep.std_rad && creep.std_rad < 0.3e-3
}

#[test]
fn creep_5_mrad_per_decade_is_estimated() {
    let creep = found(&life(365, |_| 0.0));
    assert!(is_five(&creep) && creep.steps == 0, "{creep:?}");
    assert!((creep.age_days[1] - 300.0).abs() < 1e-6);
}

#[test]
fn creep_excludes_strand_failure() {
    let creep = found(&life(365, |day| if day > 200.0 { 3e-3 } else { 0.0 }));
    assert!(is_five(&creep) && creep.steps == 1, "{creep:?}");
}

#[test]
fn creep_tensioning_resets_zero_not_age() {
    let mut sessions = life(365, |day| if day > 40.0 { -9e-3 } else { 0.0 });
    for session in &mut sessions[40..] {
        session.baseline = Some("tensioned".into());
    }
    let creep = found(&sessions);
    assert!(is_five(&creep) && creep.steps == 0, "{creep:?}");
}

#[test]
fn creep_excludes_seasonal_drift() {
    let warmer = |day: f64| 7.0 * (day / 58.0).sin();
    let mut sessions = life(365, |day| 0.1e-3 * warmer(day));
    for (session, day) in sessions.iter_mut().zip(1..) {
        session.temperature_c = Some(21.0 + warmer(f64::from(day)));
    }
    assert!(is_five(&found(&sessions)), "{:?}", found(&sessions));
}

#[test]
fn creep_is_robust_to_outliers() {
    let creep = found(&life(
        365,
        |day| if day % 30.0 == 0.0 { 20e-3 } else { 0.0 },
    ));
    assert!(is_five(&creep), "{creep:?}");
}

#[test]
fn creep_ignores_sessions_before_replacement() {
    let sessions = life(400, |day| if day > 100.0 { -50e-3 } else { 0.0 });
    let fitted = FITTED_UTC_S + 100.5 * DAY_S;
    let creep = creep(&sessions, Some(fitted), AGES, DRIFT).unwrap();
    assert!((creep.age_days[0] - 1.5).abs() < 1e-6, "{creep:?}");
}

#[test]
fn creep_few_days_returns_none() {
    assert_eq!(
        creep(&life(9, |_| 0.0), Some(FITTED_UTC_S), AGES, DRIFT),
        None
    );
}

#[test]
fn creep_recently_installed_rope_returns_none() {
    assert_eq!(
        creep(&life(120, |_| 0.0), Some(FITTED_UTC_S), AGES, DRIFT),
        None
    );
    assert!(creep(&life(150, |_| 0.0), Some(FITTED_UTC_S), AGES, DRIFT).is_some());
}
