//! What every format of a recording can do.

use crate::assemble::Joiner;
use crate::error::LogError;
use crate::frame::{Channels, DrivenJoint};
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
    /// Apache Parquet.
    Parquet,
    /// SQLite as ROS 2 writes it.
    Db3,
    /// Arrays in memory.
    Arrays,
    /// Messages in memory.
    Messages,
}

/// How far a recording has been read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Bytes of the file used so far.
    pub bytes_done: u64,
    /// Bytes of the file.
    pub bytes_total: u64,
}

/// One format's way from bytes to samples.
pub(super) trait Reader: Send {
    fn format(&self) -> Format;

    /// What samples are made of: files with the same can follow each other.
    fn layout(&self) -> String;

    /// When it begins, ns; may use up what is read first.
    fn starts_ns(&mut self) -> Result<Option<i64>, LogError>;

    /// The joints found, and what is recorded of each.
    fn found(&self) -> (Vec<String>, Channels);

    /// Which joints the samples hold from now on, in which order.
    fn select(&mut self, joints: &[DrivenJoint]);

    /// A joiner for the samples of these joints.
    fn joiner(&self, joints: &[DrivenJoint], options: &OpenOptions) -> Joiner;

    /// Reads a sample into the joiner; `false` at the end.
    fn pull(&mut self, joiner: &mut Joiner, health: &mut Health) -> Result<bool, LogError>;

    fn progress(&self) -> Progress;

    /// Where each quantity found is read from.
    fn sources(&self) -> Vec<SignalSource>;

    /// The topics there are, by name; complete at the end.
    fn topics(&self) -> Vec<TopicInfo> {
        Vec::new()
    }

    /// Columns that nothing is read from.
    fn unused_columns(&self) -> Vec<String> {
        Vec::new()
    }

    /// The robot's URDF, where it is recorded.
    fn robot_description(&self) -> Option<&str> {
        None
    }
}
