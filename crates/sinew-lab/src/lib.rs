//! The workshop of Sinew: replay and estimation, simulation, the paper's figures, plots, reports.

pub mod absolute;
pub mod bench;
pub mod camera;
pub mod control;
pub mod creep;
pub mod estimate;
pub mod excitation;
mod hands;
mod journal;
pub mod paper;
pub mod plot;
pub mod report;
pub mod robot_dir;
pub mod rope;
pub mod scenarios;
pub mod simulate;
pub mod trend;
