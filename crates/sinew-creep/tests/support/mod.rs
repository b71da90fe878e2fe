//! What several tests of this crate, and the study, start from.

pub(crate) mod bench;
pub(crate) mod laws;
pub(crate) mod outside;
pub(crate) mod score;

/// How many draws a test makes: `SINEW_SEEDS`, or a few.
pub(crate) fn seeds(ordinary: u64) -> u64 {
    let asked = std::env::var("SINEW_SEEDS").ok();
    asked.and_then(|s| s.parse().ok()).unwrap_or(ordinary)
}
