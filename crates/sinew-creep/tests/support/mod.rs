//! Shared fixtures of the tests of this crate and of the study.

pub(crate) mod bench;
pub(crate) mod laws;
pub(crate) mod outside;
pub(crate) mod score;

/// Number of draws of a test: `SINEW_SEEDS`, or the default.
pub(crate) fn seeds(ordinary: u64) -> u64 {
    let asked = std::env::var("SINEW_SEEDS").ok();
    asked.and_then(|s| s.parse().ok()).unwrap_or(ordinary)
}
