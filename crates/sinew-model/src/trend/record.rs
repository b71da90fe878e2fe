//! What goes into a trend and what comes out.

use super::bank::Component;
use super::softened::Softened;
use super::stiffness::Stiffness;
use alloc::vec::Vec;

/// What one session said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// When, s since tensioning.
    pub time_s: f64,
    /// Offset since the baseline and its own standard deviation, rad; `None`: it couldn't tell.
    pub offset_rad: Option<[f64; 2]>,
    /// Temperature, °C; `None`: not known.
    pub temperature_c: Option<f64>,
    /// Stiffness over nominal less 1 and its own standard deviation; `None`: not known.
    pub stiffness: Option<[f64; 2]>,
}

/// What happened, in the order of time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Entry {
    /// A session.
    Record(Record),
    /// The level jumped; it is open by `deviation_rad`.
    Jump {
        /// When at the latest, s.
        time_s: f64,
        /// Standard deviation the level is opened by, rad.
        deviation_rad: f64,
    },
    /// The tendon was tensioned again.
    Tensioned {
        /// When, s.
        time_s: f64,
    },
}

/// A sudden change that was confirmed, or a re-tensioning that was stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Time of the first record after it (or the stated time), s.
    pub time_s: f64,
    /// Time of the last record before it, s.
    pub after_s: f64,
    /// By how much the offset changed, rad; NaN for a stated re-tensioning.
    pub size_rad: f64,
    /// Its standard deviation, rad.
    pub deviation_rad: f64,
    /// Time of the record that confirmed it, s.
    pub confirmed_s: f64,
    /// Posterior probability when it was confirmed; 1 for a stated one.
    pub probability: f64,
    /// Whether it is a re-tensioning.
    pub tensioned: bool,
}

/// What adding a record showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Added {
    /// Probability that the level jumped within the last records and isn't confirmed yet.
    pub jump_probability: f64,
    /// Where that is above one half: time of the first record after the suspected jump, s.
    pub suspected_s: Option<f64>,
    /// Whether this record, for now, looks off by itself.
    pub off: bool,
    /// A change that this record confirmed.
    pub confirmed: Option<Event>,
}

/// Rates and sizes the detector reckons with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrendConfig {
    /// Sessions within which jumps are looked for.
    pub window: usize,
    /// Jumps per day.
    pub jumps_per_day: f64,
    /// Large falls and rises (re-tensioning, slipping) per day.
    pub falls_per_day: f64,
    /// Standard deviation of a jump, rad.
    pub jump_deviation_rad: f64,
    /// Standard deviation of a large one, rad.
    pub fall_deviation_rad: f64,
    /// Share of records that are off by themselves.
    pub off_share: f64,
    /// By how much they are, rad.
    pub off_deviation_rad: f64,
    /// Probability from which a jump is confirmed.
    pub confirm: f64,
    /// A jump below this is taken into account and not reported: nobody's failed strand, rad.
    pub least_jump_rad: f64,
}

impl Default for TrendConfig {
    fn default() -> Self {
        Self {
            window: 7,
            jumps_per_day: 4e-3,
            falls_per_day: 5e-4,
            jump_deviation_rad: 4e-3,
            fall_deviation_rad: 30e-3,
            off_share: 2e-3,
            off_deviation_rad: 6e-3,
            confirm: 0.95,
            least_jump_rad: 1e-3,
        }
    }
}

/// Why a record or a state was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrendError {
    /// NaN, infinite, or a deviation that isn't above 0.
    #[error(
        "a record's time, offset, stiffness, deviations and temperature must be finite numbers, deviations above 0"
    )]
    NotFinite,
    /// Earlier than the last.
    #[error(
        "a record at {time_s} s comes after one at {last_s} s; records come in the order of time"
    )]
    OutOfOrder {
        /// Time of the record, s.
        time_s: f64,
        /// Time of the last, s.
        last_s: f64,
    },
    /// The prior is none.
    #[error("the prior of a trend needs curves and noises of finite, positive numbers")]
    Prior,
    /// The state belongs to another prior or is damaged.
    #[error("the stored trend belongs to another rope, routing or program, or is damaged")]
    State,
}

/// What a trend remembers: the filters before the last records, and those.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// [`super::Prior::fingerprint`].
    pub fingerprint: u64,
    /// Time of the filters, s.
    pub time_s: f64,
    /// The filters.
    pub components: Vec<Component>,
    /// The stiffness since the last jump before the last entries, if there was one.
    pub softened: Option<Softened>,
    /// The stiffness before the last entries.
    pub stiffness: Stiffness,
    /// Last entries.
    pub entries: Vec<Entry>,
    /// Events so far.
    pub events: Vec<Event>,
    /// Records with an offset so far.
    pub records: u64,
}

pub(super) fn informative(entry: &Entry) -> bool {
    matches!(
        entry,
        Entry::Record(Record {
            offset_rad: Some(_),
            ..
        })
    )
}

pub(super) fn time_of(entry: &Entry) -> f64 {
    match entry {
        Entry::Record(r) => r.time_s,
        Entry::Jump { time_s, .. } | Entry::Tensioned { time_s } => *time_s,
    }
}
