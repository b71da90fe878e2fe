//! What goes wrong between robot and file.

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
    /// A frame that comes after its successor.
    late: Option<Frame>,
    counts: FaultCounts,
}

/// How many frames went wrong, and how many were written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FaultCounts {
    /// Written, repetitions included.
    pub written: u64,
    /// Lost, in gaps and singly.
    pub lost: u64,
    /// Written twice.
    pub duplicated: u64,
    /// Written after their successor.
    pub late: u64,
}

impl FaultyLine {
    /// A line with the faults of a scenario.
    pub fn new(spec: &Faults, seed: u64, start_ns: i64) -> Self {
        Self {
            spec: spec.clone(),
            rng: rng(seed, Stream::Faults),
            start_ns,
            late: None,
            counts: FaultCounts::default(),
        }
    }

    /// How many frames went wrong.
    pub fn counts(&self) -> FaultCounts {
        self.counts
    }

    /// Takes a frame in, and hands on what comes out.
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
