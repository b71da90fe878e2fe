//! Settings of the recordings around incidents.

use sinew_files::{Bound, Fields as _, Located, Section};

/// Settings of the recordings around incidents: the frames of each robot are kept in memory for a limited time, and
/// written as MCAP when an incident begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordingSettings {
    /// Whether recordings are written.
    pub is_on: bool,
    /// Time before a change that is recorded, s.
    pub before_s: f64,
    /// Time after a change that is recorded, s.
    pub after_s: f64,
    /// Memory for the frames of a robot, bytes; beyond it, the oldest are discarded.
    pub memory_bytes: usize,
    /// Maximum number of recordings of a robot; beyond it, the oldest are removed.
    pub max_files: usize,
    /// Maximum length of all recordings of a robot, bytes; beyond it, the oldest are removed.
    pub max_bytes: u64,
}

impl Default for RecordingSettings {
    fn default() -> Self {
        Self {
            is_on: true,
            before_s: 60.0,
            after_s: 10.0,
            memory_bytes: 8 << 20,
            max_files: 20,
            max_bytes: 256 << 20,
        }
    }
}

pub(super) fn read(s: &Section<'_>) -> Result<RecordingSettings, Located> {
    let usual = RecordingSettings::default();
    let mib = |bytes: f64| bytes / f64::from(1 << 20);
    let number = |key, low, high, usual| s.number_or(key, Bound::Within(low, high), usual);
    let bytes = |mib: f64| (mib * f64::from(1 << 20)) as u64;
    let memory = number("memory_mib", 1.0, 1024.0, mib(usual.memory_bytes as f64))?;
    let files = s.count("max_files")?.unwrap_or(usual.max_files as u64);
    if !(1..=10_000).contains(&files) {
        return Err(s.invalid("max_files", "between 1 and 10000"));
    }
    let stored = number("max_mib", 1.0, 1e6, mib(usual.max_bytes as f64))?;
    Ok(RecordingSettings {
        is_on: !s.flag("off")?,
        before_s: number("before_s", 1.0, 600.0, usual.before_s)?,
        after_s: number("after_s", 0.0, 600.0, usual.after_s)?,
        memory_bytes: bytes(memory) as usize,
        max_files: files as usize,
        max_bytes: bytes(stored),
    })
}
