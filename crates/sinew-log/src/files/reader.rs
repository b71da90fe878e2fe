//! Interface that every format of a recording implements.

use crate::assemble::Joiner;
use crate::error::LogError;
use crate::frame::{AxisNames, Channels};
use crate::health::Health;
use crate::options::OpenOptions;
use crate::sources::{SignalSource, TopicInfo};
use serde::{Deserialize, Serialize};

/// The format of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// MCAP as ROS 2 writes it.
    Mcap,
    /// Delimited text with a header line.
    Csv,
    /// Apache Parquet file.
    Parquet,
    /// SQLite file of ROS 2.
    Db3,
    /// Arrays of NumPy, `.npy` or `.npz`.
    Numpy,
    /// Arrays in memory.
    Arrays,
    /// Messages in memory.
    Messages,
}

/// Progress of reading a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Bytes of the file used so far.
    pub bytes_done: u64,
    /// Bytes of the file.
    pub bytes_total: u64,
}

/// Reader of one format, from bytes to samples.
pub(super) trait Reader: Send {
    fn format(&self) -> Format;

    /// Layout of the samples: files with equal layouts can follow each other.
    fn layout(&self) -> String;

    /// Start time, ns; may consume the first samples.
    fn starts_ns(&mut self) -> Result<Option<i64>, LogError>;

    /// Joints of the file, and the recorded quantities of each.
    fn found(&self) -> (Vec<String>, Channels);

    /// Tendons with a recorded tension.
    fn tendons(&self) -> &[String];

    /// Sets the axes of the samples from now on, in this order.
    fn select(&mut self, axes: &[AxisNames]);

    /// A joiner for the samples of these axes.
    fn joiner(&self, axes: &[AxisNames], options: &OpenOptions) -> Joiner;

    /// Reads a sample into the joiner; `false` at the end.
    fn pull(&mut self, joiner: &mut Joiner, health: &mut Health) -> Result<bool, LogError>;

    fn progress(&self) -> Progress;

    /// Source of each quantity.
    fn sources(&self) -> Vec<SignalSource>;

    /// Topics by name; complete at the end.
    fn topics(&self) -> Vec<TopicInfo> {
        Vec::new()
    }

    /// Columns that are not used.
    fn unused_columns(&self) -> Vec<String> {
        Vec::new()
    }

    /// Recorded robot description (URDF), if there is one.
    fn robot_description(&self) -> Option<&str> {
        None
    }
}
