//! All tests of sinew-trend in one binary: one link, one start.

#[path = "../../sinew-model/tests/model/answers.rs"]
mod answers;
mod filter;
mod filter_baseline;
mod filter_jumps;
mod golden;
mod golden_filter;
#[path = "../../sinew-model/tests/model/random.rs"]
mod random;
#[path = "../../sinew-creep/tests/support/score.rs"]
mod score;
mod support;
mod survival;
mod trend;
mod trend_records;
