//! One file per study.

pub(crate) mod paper;
pub(crate) mod scenarios;
pub(crate) mod trend_simulate;
pub(crate) mod validation;
