//! All tests of sinew-bench in one binary: one link, one start.

mod command;
mod control;
mod corrupt_bytes;
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
#[path = "../../sinew-estimate/tests/support/mod.rs"]
mod support;
mod trend_chain;
mod trend_year;
mod validation;
