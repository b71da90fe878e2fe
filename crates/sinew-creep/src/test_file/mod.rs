//! Recordings of creep, recovery and relaxation tests: columns with units, from CSV, XLSX or
//! Parquet, one or several specimens per file.
//!
//! A test file is a table, optionally with lines of names and values above its header (`L0 (mm),
//! 350`) and a line of units below it. The header determines the quantity of a column; `time_s`,
//! `Force (N)`, `Strain [%]`, `t / min` or the line of units determine its unit; [`TestOptions`]
//! overrides both. A unit is never assumed if it would change a number: a force without a unit is
//! rejected. A strain without a unit is interpreted as a ratio, with a note.
//!
//! Rows belong to one specimen as long as their text cells and the specimen columns are constant
//! and time does not restart. Columns of one quantity whose names differ by a label, such as
//! `elongation A [mm]` and `elongation B [mm]`, belong to one specimen each.

mod cells;
mod columns;
mod header;
mod labels;
mod names;
#[cfg(feature = "parquet")]
mod parquet;
mod quantity;
mod role;
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

/// Format of a test file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TestFormat {
    /// Delimited text (CSV).
    Csv,
    /// Office Open XML workbook.
    Xlsx,
    /// Apache Parquet file.
    Parquet,
}

/// Column specified by the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnChoice {
    /// Quantity of the column.
    pub quantity: TestQuantity,
    /// Header of the column, exactly or without regard to case.
    pub column: String,
    /// Unit of the column; `None` for that of the header.
    pub unit: Option<String>,
}

impl std::str::FromStr for ColumnChoice {
    type Err = String;

    /// Parses `QUANTITY=COLUMN` or `QUANTITY=COLUMN:UNIT`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (quantity, rest) = text.split_once('=').ok_or_else(|| {
            format!(
                "'{text}' is not QUANTITY=COLUMN or QUANTITY=COLUMN:UNIT, for example force=Kraft:N"
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

/// Options for reading a test file.
#[derive(Debug, Clone, Default)]
pub struct TestOptions {
    /// Columns specified by the user; the others are identified by their headers.
    pub columns: Vec<ColumnChoice>,
    /// Columns that name a specimen; empty for all text columns, and those called `specimen`,
    /// `sample`, `set`, `test` or similar.
    pub specimen_columns: Vec<String>,
    /// Sheet of a workbook; `None` for every sheet that contains a test.
    pub sheet: Option<String>,
}

/// Raw data file of a test.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Source {
    /// File name as specified.
    pub file: String,
    /// SHA-256 checksum of its bytes.
    pub sha256: String,
    /// Columns that were used.
    pub columns: Vec<SourceColumn>,
    /// Assumptions made when reading it.
    pub notes: Vec<String>,
}

/// Column of a file and its role.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SourceColumn {
    /// Quantity of the column.
    pub quantity: TestQuantity,
    /// Header of the column.
    pub column: String,
    /// Unit of the column in the file.
    pub unit: String,
}

/// Test conditions stated by the laboratory, which the file does not contain.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Conditions {
    /// Standard of the test.
    pub standard: String,
    /// Treatment of the specimens before the test.
    pub preconditioning: Option<String>,
    /// Atmosphere, conditioning time, grips, and measurement of the extension.
    pub conditions: Option<String>,
}

/// Content of a test file.
#[derive(Debug, Clone)]
pub struct TestFile {
    /// File name, checksum, used columns, and notes for the user.
    pub source: Source,
    /// Format of the file.
    pub format: TestFormat,
    /// Specimens in the order of the file.
    pub specimens: Vec<Specimen>,
}

/// Reads test files: returns the source of each, and all their specimens. `note` is called with
/// each note for the user, file by file.
///
/// # Errors
/// Returns the [`TestFileError`] of the first invalid file.
pub fn read_specimens(
    files: &[PathBuf],
    options: &TestOptions,
    note: &mut dyn FnMut(&str),
) -> Result<(Vec<Source>, Vec<Specimen>), TestFileError> {
    let read = files.iter().map(|path| read_test(path, options));
    Ok(specimens_of(read.collect::<Result<_, _>>()?, note))
}

/// Collects the sources of all files, and all their specimens; `note` as for [`read_specimens`].
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
            // Specimens of the same name in two files are two specimens.
            if specimens.iter().any(|s| s.name == specimen.name) {
                specimen.name = format!("{} ({name})", specimen.name);
            }
            specimens.push(specimen);
        }
        sources.push(file.source);
    }
    (sources, specimens)
}

/// Reads a complete test file.
///
/// # Errors
/// Returns a [`TestFileError`] with line and column: no file, no table, no time or no elongation,
/// strain or modulus, a unit that is missing, unknown or of another dimension, a non-numeric cell.
pub fn read_test(path: &Path, options: &TestOptions) -> Result<TestFile, TestFileError> {
    let name = path.display().to_string();
    let bytes = sinew_files::read_bytes(path, &sinew_files::Budget::TABLE)?;
    read_test_bytes(bytes, &name, options)
}

/// Reads a test file from memory; `name` is used in messages.
///
/// # Errors
/// Returns a [`TestFileError`] as [`read_test`] does.
pub fn read_test_bytes(
    bytes: Vec<u8>,
    name: &str,
    options: &TestOptions,
) -> Result<TestFile, TestFileError> {
    let sha256 = sha2::Sha256::digest(&bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    let invalid = |reason: &str| Err(TestFileError::invalid(name, reason));
    if bytes.is_empty() {
        return invalid("the file is empty");
    }
    let (format, tables) = if bytes.starts_with(b"PAR1") {
        #[cfg(not(feature = "parquet"))]
        return invalid(
            "it is a Parquet file, which this build does not support (cargo feature parquet)",
        );
        #[cfg(feature = "parquet")]
        (TestFormat::Parquet, vec![parquet::read(bytes, name)?])
    } else if bytes.starts_with(b"PK\x03\x04") {
        #[cfg(not(feature = "sheets"))]
        return invalid(
            "it is a workbook, which this build does not support; save it as CSV, or build with cargo build --release --features sheets",
        );
        #[cfg(feature = "sheets")]
        {
            let sheet = options.sheet.as_deref();
            (TestFormat::Xlsx, workbook::read(bytes, name, sheet)?)
        }
    } else if bytes.starts_with(b"\xd0\xcf\x11\xe0") {
        return invalid("it is an old .xls workbook; save it as .xlsx or CSV");
    } else {
        (TestFormat::Csv, vec![Table::of_text(&bytes, name)?])
    };
    if options.sheet.is_some() && format != TestFormat::Xlsx {
        return invalid("a sheet is requested, but the file is not a workbook");
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
    // Of several sheets those without a test are noted; of a single one the reason is the error.
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
        return last.map_or_else(|| invalid("it contains no rows of a test"), Err);
    }
    Ok(file)
}
