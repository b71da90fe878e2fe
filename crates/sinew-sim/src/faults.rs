//! Transmission faults between robot and file.

use super::scenario::{Faults, Stream, rng};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use sinew_log::{Frame, LogError};

/// Loses, repeats and delays frames on their way to a file.
#[derive(Debug)]
pub struct FaultyLine {
    spec: Faults,
    rng: ChaCha8Rng,
    start_ns: i64,
    /// Frame to be written after its successor.
    late: Option<Frame>,
    counts: FaultCounts,
}

/// Number of frames with faults, and number of frames written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FaultCounts {
    /// Number of frames written, duplicates included.
    pub written: u64,
    /// Number of frames lost, in gaps and singly.
    pub lost: u64,
    /// Number of duplicate frames.
    pub duplicated: u64,
    /// Number of frames written after their successor.
    pub late: u64,
}

impl FaultyLine {
    /// Creates a transmission line with the faults of a scenario.
    pub fn new(spec: &Faults, seed: u64, start_ns: i64) -> Self {
        Self {
            spec: spec.clone(),
            rng: rng(seed, Stream::Faults),
            start_ns,
            late: None,
            counts: FaultCounts::default(),
        }
    }

    /// Returns the number of frames with faults.
    pub fn counts(&self) -> FaultCounts {
        self.counts
    }

    /// Processes a frame and passes on the frames that result.
    pub fn pass(
        &mut self,
        frame: &Frame,
        write: &mut dyn FnMut(&Frame) -> Result<(), LogError>,
    ) -> Result<(), LogError> {
        let t = (frame.time_ns - self.start_ns) as f64 * 1e-9;
        let mut chance = |share: f64| share > 0.0 && self.rng.random::<f64>() < share;
        let (drop, repeat, delay) = (
            chance(self.spec.dropout_fraction),
            chance(self.spec.duplicate_fraction),
            chance(self.spec.late_fraction),
        );
        let in_gap = self
            .spec
            .gaps_s
            .iter()
            .any(|&(from, length)| t >= from && t < from + length);
        if in_gap || drop {
            self.counts.lost += 1;
        } else if delay && self.late.is_none() {
            self.late = Some(frame.clone());
            self.counts.late += 1;
            return Ok(());
        } else {
            write(frame)?;
            self.counts.written += 1;
            if repeat {
                write(frame)?;
                self.counts.written += 1;
                self.counts.duplicated += 1;
            }
        }
        self.flush(write)
    }

    /// Writes a frame that is still on its way.
    pub fn flush(
        &mut self,
        write: &mut dyn FnMut(&Frame) -> Result<(), LogError>,
    ) -> Result<(), LogError> {
        if let Some(late) = self.late.take() {
            write(&late)?;
            self.counts.written += 1;
        }
        Ok(())
    }
}
