//! Messages of tests in every crate that skip because a prerequisite is missing.

// Each crate uses its own part of this.
#![allow(dead_code)]

use std::fmt::Display;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Reports the skip past the output capture of a passing test. `.ci/tests` counts these words and rejects those that
/// `.ci/skips` does not list.
pub(crate) fn skipped(what: impl Display) {
    // At once, so that nothing comes between.
    let line = format!("SKIPPED: {what}\n");
    let _ = std::io::stderr().write_all(line.as_bytes());
}

/// Returns a part of the shared folder next to the checkout (`SINEW_SHARED`), or `None` with a visible message.
pub(crate) fn shared(part: &str) -> Option<PathBuf> {
    let root = std::env::var_os("SINEW_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let place = root.join(part);
    if place.exists() {
        return Some(place);
    }
    skipped(format_args!("{} is not there", place.display()));
    None
}
