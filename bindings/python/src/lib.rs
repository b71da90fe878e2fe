//! Sinew for Python: this crate converts, and computes nothing.
//!
//! Reading order: [`work`] (Rust works, Python waits and may interrupt), [`failure`] (errors),
//! [`document`] and [`table`] (answers on their way out), [`robot`], [`recording`] (what comes in), then one
//! file per door: [`estimate`], [`live`], [`trend`], [`rope`], [`creep`], [`simulate`], [`command`].
//!
//! What Python sees is `python/pysinew/`: signatures, defaults and words. Nothing here is called by users.
#![deny(missing_docs)]
// Written by hand, nothing here is unsafe. `pyo3`'s macros write unsafe code, which carries its own allowance.
#![deny(unsafe_code)]

mod arrays;
mod catalogue;
mod command;
mod creep;
mod document;
mod estimate;
mod failure;
mod live;
mod recording;
mod robot;
mod rope;
mod simulate;
mod table;
mod trend;
mod work;

use pyo3::prelude::*;

/// What `pysinew` is made of.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::command::run_command;
    #[pymodule_export]
    use crate::creep::CreepTests;
    #[pymodule_export]
    use crate::document::Document;
    #[pymodule_export]
    use crate::estimate::{Baseline, estimate, estimate_each, learn_baseline, merge_baselines};
    #[pymodule_export]
    use crate::live::{LiveOffsets, OffsetObserver};
    #[pymodule_export]
    use crate::recording::Recording;
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::rope::{Catalogue, RopeLaw, plan_pretension, predict_rope, select_rope};
    #[pymodule_export]
    use crate::simulate::{propose_poses, scenario_text, simulate, simulate_to};
    #[pymodule_export]
    use crate::table::Table;
    #[pymodule_export]
    use crate::trend::trend;

    /// Half a 95 % interval, in standard deviations.
    #[pymodule_export]
    const Z95: f64 = sinew_model::Z95;

    /// Version of Sinew.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
