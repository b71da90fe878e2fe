//! Recordings of creep, recovery and relaxation tests: columns in stated units, from CSV,
//! XLSX or Parquet, one specimen or many in a file.
//!
//! A test file is a table. Above its header may stand lines of names and values (`L0 (mm), 350`),
//! under it a line of units. What a column measures is told by its header, its unit by
//! `time_s`, `Force (N)`, `Strain [%]`, `t / min` or the line of units; both can be said by
//! [`TestOptions`]. A unit is never guessed where a guess would change a number: a force without a
//! unit is refused. A strain without a unit is taken as a ratio, and a note says so.
//!
//! Rows belong to one specimen as long as their text cells and the specimen columns stay the same
//! and time doesn't start anew.

mod cells;
mod columns;
mod header;
#[cfg(feature = "parquet")]
mod parquet;
mod quantity;
mod specimens;
#[cfg(feature = "sheets")]
mod workbook;

pub use quantity::TestQuantity;
pub use specimens::Specimen;

use crate::error::TestFileError;
use cells::Table;
use quantity::parse_unit;
use serde::{Deserialize, Serialize};
use sha2::Digest;
use std::path::{Path, PathBuf};

/// The format of a test file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TestFormat {
    /// Delimited text.
    Csv,
    /// Office Open XML workbook.
    Xlsx,
    /// Apache Parquet.
    Parquet,
}

/// A column named by the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnChoice {
    /// What it measures.
    pub quantity: TestQuantity,
    /// Its header, exactly or without regard to case.
    pub column: String,
    /// Its unit; `None`: as the header says.
    pub unit: Option<String>,
}

impl std::str::FromStr for ColumnChoice {
    type Err = String;

    /// `QUANTITY=COLUMN` or `QUANTITY=COLUMN:UNIT`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (quantity, rest) = text.split_once('=').ok_or_else(|| {
            format!(
                "'{text}' is not QUANTITY=COLUMN or QUANTITY=COLUMN:UNIT, such as force=Kraft:N"
            )
        })?;
        let quantity = quantity.trim().parse()?;
        let (column, unit) = match rest.rsplit_once(':') {
            Some((column, unit)) if !unit.trim().is_empty() => {
                parse_unit(unit.trim())?;
                (column, Some(unit.trim().to_owned()))
            }
            _ => (rest, None),
        };
        Ok(ColumnChoice {
            quantity,
            column: column.trim().to_owned(),
            unit,
        })
    }
}

/// How a test file shall be read.
#[derive(Debug, Clone, Default)]
pub struct TestOptions {
    /// Columns said by the user; the others are told by their headers.
    pub columns: Vec<ColumnChoice>,
    /// Columns that name a specimen; empty: all text columns, and those called `specimen`,
    /// `sample`, `set`, `test` or the like.
    pub specimen_columns: Vec<String>,
    /// Sheet of a workbook; `None`: every sheet that holds a test.
    pub sheet: Option<String>,
}

/// A raw data file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Source {
    /// File as named.
    pub file: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Columns used.
    pub columns: Vec<SourceColumn>,
    /// Assumptions made when reading it.
    pub notes: Vec<String>,
}

/// A column of a file and what it was taken for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SourceColumn {
    /// What it measures.
    pub quantity: TestQuantity,
    /// Its header.
    pub column: String,
    /// Unit the file writes it in.
    pub unit: String,
}

/// What the file can't say, as the laboratory states it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Conditions {
    /// Standard followed.
    pub standard: String,
    /// What was done to the specimens before.
    pub preconditioning: Option<String>,
    /// Atmosphere, conditioning time, grips, how extension was measured.
    pub conditions: Option<String>,
}

/// A test file as read.
#[derive(Debug, Clone)]
pub struct TestFile {
    /// Its name, its checksum, the columns used, and what a reader should know.
    pub source: Source,
    /// Its format.
    pub format: TestFormat,
    /// Specimens in the order of the file.
    pub specimens: Vec<Specimen>,
}

/// Reads test files: what was read of each, and all their specimens. `note` hears what a reader
/// should know, file by file.
///
/// # Errors
/// [`TestFileError`] of the first file that is refused.
pub fn read_specimens(
    files: &[PathBuf],
    options: &TestOptions,
    note: &mut dyn FnMut(&str),
) -> Result<(Vec<Source>, Vec<Specimen>), TestFileError> {
    let read = files.iter().map(|path| read_test(path, options));
    Ok(specimens_of(read.collect::<Result<_, _>>()?, note))
}

/// What was read of each file, and all their specimens; `note` as for [`read_specimens`].
pub fn specimens_of(
    files: Vec<TestFile>,
    note: &mut dyn FnMut(&str),
) -> (Vec<Source>, Vec<Specimen>) {
    let mut sources = Vec::new();
    let mut specimens: Vec<Specimen> = Vec::new();
    for file in files {
        let name = &file.source.file;
        for text in &file.source.notes {
            note(&format!("{name}: {text}"));
        }
        for mut specimen in file.specimens {
            // The same name in two files is two specimens.
            if specimens.iter().any(|s| s.name == specimen.name) {
                specimen.name = format!("{} ({name})", specimen.name);
            }
            specimens.push(specimen);
        }
        sources.push(file.source);
    }
    (sources, specimens)
}

/// Reads a test file whole.
///
/// # Errors
/// [`TestFileError`] with line and column: no file, no table, no time or no elongation, strain or
/// modulus, a unit that is missing, unknown or of another dimension, a cell that is no number.
pub fn read_test(path: &Path, options: &TestOptions) -> Result<TestFile, TestFileError> {
    let name = path.display().to_string();
    let bytes = sinew_files::read_bytes(path, &sinew_files::limits::TEST_FILE)?;
    read_test_bytes(bytes, &name, options)
}

/// Reads a test file from memory; `name` stands in messages.
///
/// # Errors
/// As [`read_test`].
pub fn read_test_bytes(
    bytes: Vec<u8>,
    name: &str,
    options: &TestOptions,
) -> Result<TestFile, TestFileError> {
    let sha256 = sha2::Sha256::digest(&bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    let refuse = |reason: &str| Err(TestFileError::refused(name, reason));
    if bytes.is_empty() {
        return refuse("the file is empty");
    }
    let (format, tables) = if bytes.starts_with(b"PAR1") {
        #[cfg(not(feature = "parquet"))]
        return refuse(
            "it is a Parquet file, and this program is built without them (cargo feature parquet)",
        );
        #[cfg(feature = "parquet")]
        (TestFormat::Parquet, vec![parquet::read(bytes, name)?])
    } else if bytes.starts_with(b"PK\x03\x04") {
        #[cfg(not(feature = "sheets"))]
        return refuse(
            "it is a workbook, and this build reads none; save it as CSV, or build with cargo build --release --features sheets",
        );
        #[cfg(feature = "sheets")]
        {
            let sheet = options.sheet.as_deref();
            (TestFormat::Xlsx, workbook::read(bytes, name, sheet)?)
        }
    } else if bytes.starts_with(b"\xd0\xcf\x11\xe0") {
        return refuse("it is an old .xls workbook; save it as .xlsx or CSV");
    } else {
        (TestFormat::Csv, vec![Table::of_text(&bytes, name)?])
    };
    if options.sheet.is_some() && format != TestFormat::Xlsx {
        return refuse("a sheet is asked for, but it is no workbook");
    }
    let mut file = TestFile {
        source: Source {
            file: name.to_owned(),
            sha256,
            ..Source::default()
        },
        format,
        specimens: Vec::new(),
    };
    // Of several sheets those without a test are named; of one the reason is the error.
    let many = tables.len() > 1;
    let mut last = None;
    for table in tables {
        match file.add(&table, options) {
            Err(error) if many => {
                let note = format!("sheet '{}' is not used: {error}", table.title);
                file.source.notes.push(note);
                last = Some(error);
            }
            other => other?,
        }
    }
    if file.specimens.is_empty() {
        return last.map_or_else(|| refuse("it holds no rows of a test"), Err);
    }
    Ok(file)
}
