//! Grouping key of a comparison.

use clap::ValueEnum;

/// Grouping key of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum By {
    /// Ropes, freed of joint, batch, site and temperature
    Rope,
    /// Batches of a rope, freed of joint, site and temperature
    Batch,
    /// Sites, freed of joint, rope and batch
    Site,
    /// Bands of 10 K, freed of joint, rope and batch
    Temperature,
    /// Ropes within each band of 10 K, freed of joint and batch
    RopeTemperature,
}
