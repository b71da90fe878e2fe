//! What several tests of this crate start from.

// Each test file uses its own part of this.
#![allow(dead_code)]

use sinew_lab::robot_dir;
use sinew_lab::trend::{SessionRecord, date::parse_utc_s};
use sinew_model::robot::Robot;
use std::path::{Path, PathBuf};

pub(crate) const DAY_S: f64 = 86_400.0;

/// The repository's folder.
pub(crate) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Folder of the shipped robot.
pub(crate) fn biorob_like_folder() -> PathBuf {
    repository().join("robots/biorob-like")
}

/// The shipped robot.
pub(crate) fn biorob_like() -> Robot {
    robot_dir::load(&biorob_like_folder(), None).unwrap().robot
}

/// A part of the shared folder beside the checkout (`SINEW_SHARED`), or `None` with a visible word.
pub(crate) fn shared(part: &str) -> Option<PathBuf> {
    let root = std::env::var_os("SINEW_SHARED")
        .map_or_else(|| repository().join("../shared"), PathBuf::from);
    let place = root.join(part);
    if place.exists() {
        return Some(place);
    }
    // Past the capture of a test that passes.
    let _ = std::io::Write::write_fmt(
        &mut std::io::stderr(),
        format_args!("SKIPPED: {} is not there\n", place.display()),
    );
    None
}

/// How many draws a test makes: `SINEW_SEEDS`, or a few.
pub(crate) fn seeds(ordinary: u64) -> u64 {
    asked_seeds().unwrap_or(ordinary)
}

/// `SINEW_SEEDS`.
pub(crate) fn asked_seeds() -> Option<u64> {
    std::env::var("SINEW_SEEDS").ok()?.parse().ok()
}

/// Seconds since 1970 of a date.
pub(crate) fn utc(text: &str) -> f64 {
    parse_utc_s(text).unwrap()
}

/// A session of the elbow, so many days after 2026-03-01.
pub(crate) fn session_record(day: f64, offset_mrad: f64) -> SessionRecord {
    SessionRecord {
        source: format!("day {day}"),
        robot: Some("biorob-like".into()),
        recording: None,
        baseline: Some("march".into()),
        time_utc_s: utc("2026-03-01") + day * DAY_S,
        duration_s: Some(60.0),
        joint: "elbow".into(),
        offset_mrad: Some([offset_mrad, 0.6]),
        temperature_c: Some(21.0),
        stiffness_percent: None,
    }
}
