//! Budgets: the resources that the reading of an input may take, independent of its content.
//!
//! A reader compares a stated size with its budget before it allocates memory, also in front of the parsers of other
//! crates. The manual shows the budgets as a table.

use std::fmt::{Display, Formatter, Result as FmtResult};
use std::io::{Error as IoError, Read, Result as IoResult};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Factor of the limits of this process; see [`Limit::is_multiplied`].
static FACTOR: AtomicU64 = AtomicU64::new(1);

/// Multiplies every limit of this process except the depth by the environment variable `SINEW_BUDGET`, a whole number from
/// 1 to 1000, for inputs that are larger than any that are known. A library does not call it.
///
/// # Errors
/// Returns a message for another value.
pub fn multiply_budgets() -> Result<(), String> {
    let Some(text) = std::env::var_os("SINEW_BUDGET") else {
        return Ok(());
    };
    let factor = text.to_str().and_then(|text| text.trim().parse().ok());
    let factor = factor.filter(|factor| (1..=1000).contains(factor));
    let factor = factor.ok_or_else(|| {
        let text = text.to_string_lossy().escape_debug().to_string();
        let text = crate::names::shorten(&text, 40);
        format!(
            "the environment variable SINEW_BUDGET is '{text}'; it must be a whole number from 1 to 1000"
        )
    })?;
    FACTOR.store(factor, Ordering::Relaxed);
    Ok(())
}

/// Upper bound of one resource.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limit {
    /// Subject of the limit, as the start of a message.
    pub of: &'static str,
    /// The largest value that is accepted, before the factor of the process.
    pub most: u64,
    /// Unit of the limit.
    pub unit: &'static str,
    /// Reason for the value of the limit.
    pub reason: &'static str,
    /// Whether the factor of the process applies; the stack, which bounds the depth, does not grow with it.
    pub is_multiplied: bool,
}

impl Limit {
    /// A resource that the input does not take, or that another limit bounds.
    pub const NONE: Self = Self::new(u64::MAX, "", "", "");

    const fn new(most: u64, unit: &'static str, of: &'static str, reason: &'static str) -> Self {
        Self {
            of,
            most,
            unit,
            reason,
            is_multiplied: true,
        }
    }

    /// The largest value that is accepted in this process.
    pub fn value(&self) -> u64 {
        match self.is_multiplied {
            true => self.most.saturating_mul(FACTOR.load(Ordering::Relaxed)),
            false => self.most,
        }
    }

    /// [`value`](Self::value) with its unit, bytes in MiB or GiB: "256 MiB".
    pub fn amount(&self) -> String {
        match (self.unit, self.value()) {
            ("bytes", bytes) if bytes >= 1024 * MIB => format!("{} GiB", bytes / (1024 * MIB)),
            ("bytes", bytes) => format!("{} MiB", bytes / MIB),
            (unit, count) => format!("{count} {unit}"),
        }
    }

    /// [`value`](Self::value) as a length.
    pub fn length(&self) -> usize {
        usize::try_from(self.value()).unwrap_or(usize::MAX)
    }

    /// Checks a size against the bound; the error is a message.
    ///
    /// # Errors
    /// Returns the actual and the permitted size.
    pub fn check(&self, found: u64) -> Result<(), String> {
        match found > self.value() {
            true => Err(format!("{found} {}; {self}", self.unit)),
            false => Ok(()),
        }
    }
}

/// "a robot has at most 256 moving joints".
impl Display for Limit {
    fn fmt(&self, f: &mut Formatter<'_>) -> FmtResult {
        write!(f, "{} at most {} {}", self.of, self.value(), self.unit)
    }
}

/// Resources that the reading of an input may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Budget {
    /// The largest part that is in memory at a time: a text file, a chunk, a message, a page.
    pub memory: Limit,
    /// The longest row, cell or element of a text.
    pub text: Limit,
    /// The content after decompression, on disk or in parts.
    pub unpacked: Limit,
    /// Records without a size of their own: elements of XML, steps.
    pub records: Limit,
    /// Cells that are in memory.
    pub cells: Limit,
    /// Signals of a record: columns, joints, pixels of a row.
    pub columns: Limit,
    /// Nested structures of a document or a schema, levels.
    pub depth: Limit,
    /// Processor time beyond 1 s for each MiB of the input; see [`ProcessorTime`].
    pub processor: Limit,
}

const MIB: u64 = 1 << 20;

/// Depth at which the parsers of JSON stop; those of TOML stop at 80.
const DEPTH: Limit = Limit {
    is_multiplied: false,
    ..Limit::new(
        128,
        "levels",
        "nested JSON, TOML or a schema has",
        "parsers call themselves for each level; those of JSON stop there, those of TOML at 80",
    )
};

const PROCESSOR: Limit = Limit::new(
    60,
    "s",
    "decompression and decoding take, beyond 1 s for each MiB of the file,",
    "processor time; assumes 10 MB/s on a slow processor",
);

impl Budget {
    const NONE: Self = Self {
        memory: Limit::NONE,
        text: Limit::NONE,
        unpacked: Limit::NONE,
        records: Limit::NONE,
        cells: Limit::NONE,
        columns: Limit::NONE,
        depth: Limit::NONE,
        processor: Limit::NONE,
    };

    /// A file of settings: a scenario, a bench, a mapping, a rope, `watch.toml`, `metadata.yaml`.
    pub const SETTINGS: Self = Self {
        memory: Limit::new(
            4 * MIB,
            "bytes",
            "a file of settings has",
            "written by hand",
        ),
        depth: DEPTH,
        ..Self::NONE
    };

    /// A description that a person or a program writes: `robot.toml`, a URDF, a duty, `meta/info.json`.
    pub const DESCRIPTION: Self = Self {
        memory: Limit::new(
            64 * MIB,
            "bytes",
            "robot.toml, a URDF, a duty or a table of times has",
            "the largest URDFs have about 10 MB",
        ),
        records: Limit::new(
            1_000_000,
            "nodes",
            "a URDF has",
            "the largest robots have about 10,000; they also bound the depth",
        ),
        columns: Limit::new(
            256,
            "moving joints",
            "a robot has",
            "the time of a check grows with the cube of the number; a humanoid with hands has 100",
        ),
        ..Self::SETTINGS
    };

    /// A table or document of results, in memory as a whole: sessions, a baseline, a study, a creep test.
    pub const TABLE: Self = Self {
        memory: Limit::new(
            256 * MIB,
            "bytes",
            "a table of sessions, a baseline, a study or a creep test has",
            "25,000 sessions of 32 joints; a baseline of 60 joints has 27 MB",
        ),
        text: Limit::new(
            MIB,
            "bytes",
            "a cell or an element of a workbook has",
            "spreadsheet programs allow 32,767 characters",
        ),
        unpacked: Limit::new(
            2048 * MIB,
            "bytes",
            "a workbook has",
            "unpacked; read in parts",
        ),
        cells: Limit::new(
            16_000_000,
            "cells",
            "a creep test has",
            "32 bytes of memory per cell; a day at 10 Hz with ten columns has half as many",
        ),
        depth: DEPTH,
        processor: PROCESSOR,
        ..Self::NONE
    };

    /// A recording. It is read in parts, so that its length has no bound.
    pub const RECORDING: Self = Self {
        memory: Limit::new(
            256 * MIB,
            "bytes",
            "a chunk, message or page of a recording has",
            "recorders write 1 to 8 MB; a stated length is first compared with the remaining bytes",
        ),
        text: Limit::new(
            4 * MIB,
            "bytes",
            "a row or header of a recorded table has",
            "65,536 columns of 64 bytes",
        ),
        unpacked: Limit::new(
            64 << 30,
            "bytes",
            "an unpacked recording has",
            "stored in the folder for temporary files, not in memory",
        ),
        columns: Limit::new(
            65_536,
            "columns",
            "a recording has",
            "a thousand joints with 60 quantities",
        ),
        depth: DEPTH,
        processor: PROCESSOR,
        ..Self::NONE
    };

    /// Budget of a picture: its file, and its pixels after decompression.
    pub const PICTURE: Self = Self {
        memory: Limit::new(
            256 * MIB,
            "bytes",
            "a picture has",
            "100 megapixels without compression",
        ),
        unpacked: Limit::new(
            1024 * MIB,
            "bytes",
            "an unpacked picture has",
            "20,000 px square in grey is 400 MB",
        ),
        columns: Limit::new(
            20_000,
            "px",
            "a side of a picture has",
            "the largest sensors have 15,000",
        ),
        ..Self::NONE
    };

    /// Budget of a simulation, whose length a scenario states.
    pub const SIMULATION: Self = Self {
        records: Limit::new(
            10_000_000_000,
            "integration steps",
            "a simulation takes",
            "58 days at 0.5 ms; a recording has no more samples than steps",
        ),
        ..Self::NONE
    };

    /// All of them, in the order of the manual's table.
    pub const ALL: [Self; 6] = [
        Self::SETTINGS,
        Self::DESCRIPTION,
        Self::TABLE,
        Self::RECORDING,
        Self::PICTURE,
        Self::SIMULATION,
    ];

    /// The budget with another bound of the memory, bytes.
    #[must_use]
    pub const fn with_memory(mut self, most_bytes: u64) -> Self {
        self.memory.most = most_bytes;
        self
    }

    /// The limits that apply.
    pub fn limits(&self) -> impl Iterator<Item = Limit> {
        let all = [
            self.memory,
            self.text,
            self.unpacked,
            self.records,
            self.cells,
            self.columns,
            self.depth,
            self.processor,
        ];
        all.into_iter().filter(|limit| *limit != Limit::NONE)
    }
}

/// Processor time of this thread that the decompression and decoding of one input has taken.
///
/// The time between two pieces of work does not count: it is the caller's.
#[derive(Debug)]
pub struct ProcessorTime {
    limit: Limit,
    most: Duration,
    spent: Duration,
}

impl ProcessorTime {
    /// Starts at zero for an input of this size in bytes.
    pub fn new(budget: &Budget, input_bytes: u64) -> Self {
        let seconds = budget.processor.value().saturating_add(input_bytes / MIB);
        Self {
            limit: budget.processor,
            most: Duration::from_secs(seconds),
            spent: Duration::ZERO,
        }
    }

    /// Does a piece of work.
    ///
    /// # Errors
    /// Returns a message if this and the former pieces have taken more time than permitted.
    pub fn spend<T>(&mut self, work: impl FnOnce() -> T) -> Result<T, String> {
        let begun = processor_time();
        let done = work();
        self.spent += processor_time().saturating_sub(begun);
        match self.spent > self.most {
            true => Err(format!("its content expands too far; {}", self.limit)),
            false => Ok(done),
        }
    }

    /// Reads from a decompressor; its processor time counts.
    pub fn reader<R: Read>(&mut self, from: R) -> TimedReader<'_, R> {
        TimedReader { from, time: self }
    }
}

/// Reader whose processor time is bounded.
#[derive(Debug)]
pub struct TimedReader<'t, R> {
    from: R,
    time: &'t mut ProcessorTime,
}

impl<R: Read> Read for TimedReader<'_, R> {
    fn read(&mut self, into: &mut [u8]) -> IoResult<usize> {
        let from = &mut self.from;
        self.time
            .spend(|| from.read(into))
            .map_err(IoError::other)?
    }
}

/// Processor time of this thread.
#[cfg(target_os = "linux")]
fn processor_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::try_from(time).unwrap_or_default()
}

/// Time of a clock, where the processor's is not available.
#[cfg(not(target_os = "linux"))]
fn processor_time() -> Duration {
    static BEGUN: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    BEGUN.get_or_init(std::time::Instant::now).elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limit_error_reports_found_and_permitted() {
        let joints = Budget::DESCRIPTION.columns;
        assert_eq!(joints.check(256), Ok(()));
        assert_eq!(
            joints.check(257).unwrap_err(),
            "257 moving joints; a robot has at most 256 moving joints"
        );
        assert_eq!(joints.amount(), "256 moving joints");
        assert_eq!(Budget::RECORDING.memory.amount(), "256 MiB");
        assert_eq!(Budget::RECORDING.unpacked.amount(), "64 GiB");
        assert!(Budget::ALL.iter().all(|b| b.limits().next().is_some()));
        assert_eq!(Limit::NONE.check(u64::MAX), Ok(()));
    }

    #[test]
    fn work_beyond_processor_time_is_error() {
        let none = Budget {
            processor: Limit {
                most: 0,
                ..Budget::RECORDING.processor
            },
            ..Budget::RECORDING
        };
        let work = || (0..2_000_000_u64).fold(1, |a, k| std::hint::black_box(a ^ (a << 1) ^ k));
        assert!(ProcessorTime::new(&none, 0).spend(work).is_err());
        assert!(ProcessorTime::new(&none, 1 << 20).spend(work).is_ok());
        // Waiting is no work.
        let mut time = ProcessorTime::new(&none, 1 << 20);
        let wait = || std::thread::sleep(Duration::from_millis(1100));
        assert!(!cfg!(target_os = "linux") || time.spend(wait).is_ok());
    }
}
