//! Shared fixtures of the tests of this crate.

use sinew_estimate::robot_dir;
use sinew_files::date::parse_utc_s;
use sinew_model::robot::Robot;
use sinew_model::{Gaussian, Z95};
use sinew_trend::SessionRecord;
use std::path::{Path, PathBuf};

pub(crate) const DAY_S: f64 = 86_400.0;

/// The repository's folder.
pub(crate) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The shipped robot.
pub(crate) fn biorob_like() -> Robot {
    let place = repository().join("robots/biorob-like");
    robot_dir::load(&place, None).unwrap().robot
}

/// Seconds since 1970 of a date.
pub(crate) fn utc(text: &str) -> f64 {
    parse_utc_s(text).unwrap()
}

/// Session of the elbow, a number of days after 2026-03-01.
pub(crate) fn session_record(day: f64, offset_mrad: f64) -> SessionRecord {
    SessionRecord {
        source: format!("day {day}"),
        robot: Some("biorob-like".into()),
        recording: None,
        baseline: Some("march".into()),
        time_utc_s: utc("2026-03-01") + day * DAY_S,
        duration_s: Some(60.0),
        joint: "elbow".into(),
        offset_rad: Some(Gaussian::new(1e-3 * offset_mrad, 0.6e-3 / Z95)),
        temperature_c: Some(21.0),
        ..SessionRecord::default()
    }
}
