//! What tests of every crate say where something they need isn't there.

// Each crate uses its own part of this.
#![allow(dead_code)]

use std::fmt::Display;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Says so past the capture of a test that passes. `.ci/tests` counts these words and refuses those that `.ci/skips` doesn't
/// hold.
pub(crate) fn skipped(what: impl Display) {
    // At once, so that nothing comes between.
    let line = format!("SKIPPED: {what}\n");
    let _ = std::io::stderr().write_all(line.as_bytes());
}

/// A part of the shared folder beside the checkout (`SINEW_SHARED`), or `None` with a visible word.
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
