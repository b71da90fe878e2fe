//! Mapping files: other names, units, signs and gear ratios to the frame's quantities.
//!
//! ```toml
//! [time]
//! column = "transmit_time"       # default: time_s or time_ns
//! unit = "s"                     # s, ms, us, ns
//! # rate_hz = 100                # instead of both, for a table without times
//!
//! [temperature]
//! column = "board_temperature"
//! unit = "°C"                    # or K
//!
//! [joints.elbow]                 # the name Sinew shall use; order is kept
//! name = "j3"                    # MCAP: name in the recording, default the same
//! motor_name = "m3"              # MCAP: name on the motor side, default `name`
//! q = { column = "position", unit = "deg", sign = -1, offset = 0.1 }
//! theta = { sum = [ { column = "position" }, { column = "deflection", scale = -1.0 } ] }
//! tau_el = { column = "effort", unit = "N·mm" }
//! tau_m = { column = "current", unit = "A", torque_constant_nm_per_a = 0.05, gear_ratio = 100 }
//!
//! [tendons.flexor]               # its tension; "column" is short for { column = "column" }
//! tension = { column = "load_cell_3", unit = "N" }
//!
//! [mcap]
//! joint_state_topic = "/arm/joint_states"
//! motor_topic = "/arm/motor_states"
//! motor_interface = "position"
//! ```
//!
//! A term is `si = sign · scale · unit(raw) / gear_ratio + offset`, for torques and forces
//! `sign · scale · unit(raw) · gear_ratio + offset`: what a gear slows down it makes strong. `offset` is
//! in SI and is added last. `unit = "count"` needs `counts_per_turn`. A motor's current (`A`, `mA`) is its
//! torque by the torque constant of its shaft, N·m/A. Positions
//! in rad, deg, turn or count are unwrapped with the period `wrap_period`
//! (in SI at the joint; default 2π, for counts one turn of the encoder: 2π divided by
//! `gear_ratio`) unless `wrap = false`; lengths are not.
//! `column` is the name of a column or its number from 1, as `column = 2`.
//! In an MCAP recording the terms have no `column` and no `sum`: the topic's own
//! fields are converted.

mod parse;
mod unit;

pub(crate) use unit::time_unit_exponent;

use std::path::Path;

use sinew_files::Located;

use crate::frame::Quantity;

/// Mapping of a recording: names, units, gear ratios, signs and offsets.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mapping {
    pub(crate) file: String,
    pub(crate) time: Option<TimeMap>,
    pub(crate) temperature: Option<Source>,
    pub(crate) joints: Vec<JointMap>,
    pub(crate) tendons: Vec<TendonMap>,
    pub(crate) mcap: McapMap,
}

impl Mapping {
    /// Reads a mapping from the text of a TOML file; `file_name` is for messages only.
    ///
    /// # Errors
    /// With file, line and key: broken TOML, unknown keys, unknown units, a unit that cannot be the
    /// quantity, a zero or infinite factor.
    pub fn from_toml(text: &str, file_name: &str) -> Result<Mapping, Located> {
        parse::from_toml(text, file_name)
    }

    /// Reads a mapping file.
    ///
    /// # Errors
    /// As [`Mapping::from_toml`]; also returns an error for an unreadable file.
    pub fn read(path: &Path) -> Result<Mapping, Located> {
        let text = sinew_files::read_text(path, &sinew_files::Budget::SETTINGS)?;
        Self::from_toml(&text, &path.display().to_string())
    }

    /// Whether the motor torque of a joint is a current times a torque constant.
    pub fn reads_motor_current(&self) -> bool {
        let sources = self.joints.iter().flat_map(|joint| &joint.sources);
        sources.flatten().any(|source| source.is_current)
    }

    /// Name of the file, for messages.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Whether a quantity of a joint or motor is a sum of several columns.
    pub fn sums(&self, name: &str, quantity: Quantity) -> bool {
        let mut named = self.joints.iter().filter(|joint| joint.name == name);
        named.any(|joint| {
            let source = joint.sources.get(quantity.index());
            let source = source.and_then(Option::as_ref);
            source.is_some_and(|source| source.terms.len() > 1)
        })
    }

    /// The tendons the mapping names, in the file's order.
    pub fn tendon_names(&self) -> impl Iterator<Item = &str> {
        self.tendons.iter().map(|tendon| tendon.name.as_str())
    }

    /// The joints the mapping names, in the file's order.
    pub fn joint_names(&self) -> impl Iterator<Item = &str> {
        self.joints.iter().map(|joint| joint.name.as_str())
    }
}

/// Column of a table as a mapping specifies it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ColumnRef {
    /// Name in the header.
    Name(String),
    /// Number of the column, from 1.
    Number(usize),
}

impl ColumnRef {
    /// Index of the column among these; `None` if there is none.
    pub(crate) fn index(&self, names: &[String]) -> Option<usize> {
        match self {
            Self::Name(wanted) => names.iter().position(|name| name == wanted),
            Self::Number(number) => number.checked_sub(1).filter(|index| *index < names.len()),
        }
    }
}

impl std::fmt::Display for ColumnRef {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Name(name) => write!(f, "'{name}'"),
            Self::Number(number) => write!(f, "{number}"),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TimeMap {
    pub(crate) column: Option<ColumnRef>,
    /// Power of ten to nanoseconds; `None`: by the column's suffix.
    pub(crate) exponent: Option<i32>,
    /// Rate of the rows of a table without times, Hz.
    pub(crate) rate_hz: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointMap {
    pub(crate) name: String,
    pub(crate) recorded: Option<String>,
    pub(crate) motor_recorded: Option<String>,
    /// Sources, one per quantity of [`Quantity::PER_JOINT`].
    pub(crate) sources: [Option<Source>; 6],
}

impl JointMap {
    pub(crate) fn recorded_name(&self) -> &str {
        self.recorded.as_deref().unwrap_or(&self.name)
    }

    pub(crate) fn motor_recorded_name(&self) -> &str {
        self.motor_recorded
            .as_deref()
            .unwrap_or(self.recorded_name())
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TendonMap {
    pub(crate) name: String,
    pub(crate) recorded: Option<String>,
    pub(crate) tension: Option<Source>,
    pub(crate) line: u64,
}

impl TendonMap {
    pub(crate) fn recorded_name(&self) -> &str {
        self.recorded.as_deref().unwrap_or(&self.name)
    }
}

/// Quantity in the `effort` of the joint-side `JointState`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum JointEffort {
    /// Elastic joint torque from a sensor (the default).
    #[default]
    TauEl,
    /// Motor torque reflected to the joint, as many drivers publish it.
    TauM,
    /// Effort is not used.
    Ignore,
}

/// Source of one quantity: a sum of terms.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Source {
    pub(crate) terms: Vec<Term>,
    pub(crate) wrap: Wrap,
    /// A current times a torque constant.
    pub(crate) is_current: bool,
    pub(crate) line: u64,
}

impl Source {
    /// A column that is recorded in SI and does not wrap.
    pub(crate) fn of_column(column: ColumnRef, line: u64) -> Self {
        let term = Term {
            column: Some(column),
            scale: 1.0,
            offset: 0.0,
            line,
        };
        Self {
            terms: vec![term],
            wrap: Wrap::Never,
            is_current: false,
            line,
        }
    }

    /// Whether both sources use the same columns in the same way.
    pub(crate) fn is_equivalent(&self, other: &Source) -> bool {
        let same = |(a, b): (&Term, &Term)| {
            (&a.column, a.scale, a.offset) == (&b.column, b.scale, b.offset)
        };
        self.terms.len() == other.terms.len() && self.terms.iter().zip(&other.terms).all(same)
    }
}

/// `si = scale · raw + offset`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Term {
    pub(crate) column: Option<ColumnRef>,
    pub(crate) scale: f64,
    pub(crate) offset: f64,
    pub(crate) line: u64,
}

/// Period of the encoder as seen at the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Wrap {
    Never,
    Period(f64),
}

impl Wrap {
    /// Default of a position without further information: one turn.
    pub(crate) fn default_for(quantity: Quantity) -> Wrap {
        match quantity {
            Quantity::Q | Quantity::Theta => Wrap::Period(2.0 * std::f64::consts::PI),
            _ => Wrap::Never,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct McapMap {
    pub(crate) joint_state_topic: Option<String>,
    pub(crate) motor_topic: Option<String>,
    pub(crate) motor_interface: Option<String>,
    pub(crate) motor_effort_interface: Option<String>,
    pub(crate) temperature_interface: Option<String>,
    pub(crate) external_torque_topic: Option<String>,
    pub(crate) tension_topic: Option<String>,
    pub(crate) joint_effort: Option<JointEffort>,
}
