//! Text in, files out: functions shared by all readers and writers of Sinew. Contains no physics
//! and no format of Sinew.
//!
//! * [`located`]: the common error of text files: file, line, key or column, value, unit, cure;
//! * [`text`]: bytes as text, in the encodings instruments and spreadsheets write;
//! * [`section`]: a TOML table read key by key (feature `toml`);
//! * [`csv`]: delimited text with a header, in every common dialect (feature `csv`);
//! * [`bound`]: permitted ranges of numbers, and the units that end their keys;
//! * [`budget`]: the resources that the reading of an input may take;
//! * [`mod@unit`]: units that a file may name, as factors to SI;
//! * [`parquet`]: Parquet files within a budget (feature `parquet`);
//! * [`names`]: suggestions for misspelt names;
//! * [`number`]: formatting of numbers;
//! * [`JsonDocument`]: a result as JSON that names its schema;
//! * [`date`]: days and times of day, UTC;
//! * [`interrupt`]: interruption of long computations;
//! * [`atomic`]: output files that are complete or absent;
//! * [`temporary`]: temporary files with an exclusive writer, deleted unless they are given a name.

pub mod atomic;
pub mod bound;
pub mod budget;
#[cfg(feature = "csv")]
pub mod csv;
pub mod date;
pub mod interrupt;
#[cfg(feature = "json")]
mod json;
pub mod located;
pub mod lock;
pub mod names;
mod new_file;
pub mod number;
#[cfg(feature = "parquet")]
pub mod parquet;
#[cfg(feature = "toml")]
pub mod section;
pub mod temporary;
pub mod text;
pub mod unit;
mod utf16;

pub use atomic::{
    AtomicFile, OutputError, folder_of, is_stdout, note_input, protect_inputs, take_replaced,
    write_file,
};
pub use bound::{Bound, WORKS_AT_C};
pub use budget::{Budget, Limit, ProcessorTime, multiply_budgets};
#[cfg(feature = "json")]
pub use json::{JsonDocument, json_kind};
pub use located::{Fault, Fields, Located, Place};
#[cfg(feature = "toml")]
pub use new_file::NewFile;
pub use section::{Section, TomlFile, Value};
pub use temporary::Temporary;
pub use text::{csv_cell, plain, read_bytes, read_text};
pub use utf16::Utf16Reader;
