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
mod csv_cells;
mod header;
#[cfg(feature = "parquet")]
mod parquet_cells;
mod specimens;
mod unit;
#[cfg(feature = "sheets")]
mod xlsx_cells;

use std::path::Path;

use sha2::Digest;

pub use columns::ColumnUse;
pub use specimens::Specimen;

use crate::error::LogError;

/// What a column of a test measures.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TestQuantity {
    /// Time, s.
    Time,
    /// Force, N.
    Force,
    /// Stress, Pa.
    Stress,
    /// Elongation of the gauge length or grip travel, m.
    Elongation,
    /// Strain, m/m.
    Strain,
    /// Relaxation or creep modulus, Pa.
    Modulus,
    /// Temperature, °C.
    Temperature,
    /// Relative humidity or moisture, %.
    Humidity,
    /// Cross-section, m².
    Area,
    /// Gauge length, m.
    GaugeLength,
}

impl TestQuantity {
    /// All quantities, in the order of their columns.
    pub const ALL: [TestQuantity; 10] = [
        TestQuantity::Time,
        TestQuantity::Force,
        TestQuantity::Stress,
        TestQuantity::Elongation,
        TestQuantity::Strain,
        TestQuantity::Modulus,
        TestQuantity::Temperature,
        TestQuantity::Humidity,
        TestQuantity::Area,
        TestQuantity::GaugeLength,
    ];

    /// The name used in options and messages.
    pub fn name(self) -> &'static str {
        match self {
            TestQuantity::Time => "time",
            TestQuantity::Force => "force",
            TestQuantity::Stress => "stress",
            TestQuantity::Elongation => "elongation",
            TestQuantity::Strain => "strain",
            TestQuantity::Modulus => "modulus",
            TestQuantity::Temperature => "temperature",
            TestQuantity::Humidity => "humidity",
            TestQuantity::Area => "area",
            TestQuantity::GaugeLength => "gauge-length",
        }
    }

    /// The unit values are kept in.
    pub fn unit(self) -> &'static str {
        match self {
            TestQuantity::Time => "s",
            TestQuantity::Force => "N",
            TestQuantity::Stress | TestQuantity::Modulus => "Pa",
            TestQuantity::Elongation | TestQuantity::GaugeLength => "m",
            TestQuantity::Strain => "m/m",
            TestQuantity::Temperature => "°C",
            TestQuantity::Humidity => "%",
            TestQuantity::Area => "m²",
        }
    }
}

impl std::str::FromStr for TestQuantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        TestQuantity::ALL
            .into_iter()
            .find(|quantity| quantity.name() == text)
            .ok_or_else(|| {
                let known: Vec<&str> = TestQuantity::ALL.iter().map(|q| q.name()).collect();
                format!("unknown quantity '{text}'; known are {}", known.join(", "))
            })
    }
}

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
            Some((column, unit)) if unit::parse(unit.trim()).is_ok() => {
                (column, Some(unit.trim().to_owned()))
            }
            Some((_, unit)) if !unit.trim().is_empty() => {
                return Err(unit::parse(unit.trim()).err().unwrap_or_default());
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

/// A test file as read.
#[derive(Debug, Clone)]
pub struct TestFile {
    /// File as the user named it.
    pub file: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// Its format.
    pub format: TestFormat,
    /// Specimens in the order of the file.
    pub specimens: Vec<Specimen>,
    /// Which column was taken for what, in which unit.
    pub columns: Vec<ColumnUse>,
    /// What a reader should know: assumed units, columns not used, rows left out.
    pub notes: Vec<String>,
}

/// Reads a test file whole.
///
/// # Errors
/// [`LogError`] with line and column: no file, no table, no time or no elongation, strain or
/// modulus, a unit that is missing, unknown or of another dimension, a cell that is no number.
pub fn read_test(path: &Path, options: &TestOptions) -> Result<TestFile, LogError> {
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
) -> Result<TestFile, LogError> {
    let sha256 = sha2::Sha256::digest(&bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    let refuse = |reason: &str| LogError::refused(name, reason);
    if bytes.is_empty() {
        return Err(refuse("the file is empty"));
    }
    let (format, tables) = if bytes.starts_with(b"PAR1") {
        #[cfg(not(feature = "parquet"))]
        return Err(refuse(
            "it is a Parquet file, and this program is built without them (cargo feature parquet)",
        ));
        #[cfg(feature = "parquet")]
        (TestFormat::Parquet, parquet_cells::read(bytes, name)?)
    } else if bytes.starts_with(b"PK\x03\x04") {
        #[cfg(not(feature = "sheets"))]
        return Err(refuse(
            "it is a workbook, and this build reads none; save it as CSV, or build with cargo build --release --features sheets",
        ));
        #[cfg(feature = "sheets")]
        (
            TestFormat::Xlsx,
            xlsx_cells::read(bytes, name, options.sheet.as_deref())?,
        )
    } else if bytes.starts_with(b"\xd0\xcf\x11\xe0") {
        return Err(refuse(
            "it is an old .xls workbook; save it as .xlsx or CSV",
        ));
    } else {
        (TestFormat::Csv, csv_cells::read(&bytes, name)?)
    };
    if options.sheet.is_some() && format != TestFormat::Xlsx {
        return Err(refuse("a sheet is asked for, but it is no workbook"));
    }
    let mut file = TestFile {
        file: name.to_owned(),
        sha256,
        format,
        specimens: Vec::new(),
        columns: Vec::new(),
        notes: Vec::new(),
    };
    // Of several sheets those without a test are named; of one the reason is the error.
    let many = tables.len() > 1;
    let mut last = None;
    for table in tables {
        match specimens::take(&table, name, options, &mut file) {
            Ok(()) => {}
            Err(error) if many => {
                file.notes
                    .push(format!("sheet '{}' is not used: {error}", table.title));
                last = Some(error);
            }
            Err(error) => return Err(error),
        }
    }
    if file.specimens.is_empty() {
        return Err(last.unwrap_or_else(|| refuse("it holds no rows of a test")));
    }
    Ok(file)
}
