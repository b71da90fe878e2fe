//! All tests of sinew-bench in one binary: one link, one start.

mod command;
mod control;
mod coverage;
mod excitation;
mod forecasts;
mod online;
mod paper_figures;
mod paper_sentences;
mod rope_figures;
mod scenarios;
mod science_figures;
#[path = "../../sinew-creep/tests/support/score.rs"]
mod score;
mod spoiled_bytes;
#[path = "../../sinew-estimate/tests/support/mod.rs"]
mod support;
mod trend_chain;
mod trend_year;
