//! Raw data files of creep tests, and what the laboratory states about them.

use serde::{Deserialize, Serialize};
use sinew_log::{LogError, Specimen, TestFile, TestOptions, TestQuantity, read_test};
use std::path::PathBuf;

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

/// A raw data file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// Reads test files: what was read of each, and all their specimens. `note` hears what a reader
/// should know, file by file.
///
/// # Errors
/// [`LogError`] of the first file that is refused.
pub fn read_specimens(
    files: &[PathBuf],
    options: &TestOptions,
    note: &mut dyn FnMut(&str),
) -> Result<(Vec<Source>, Vec<Specimen>), LogError> {
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
        for text in &file.notes {
            note(&format!("{}: {text}", file.file));
        }
        let columns = file.columns.into_iter().map(|c| SourceColumn {
            quantity: c.quantity,
            column: c.column,
            unit: c.unit,
        });
        sources.push(Source {
            file: file.file.clone(),
            sha256: file.sha256,
            columns: columns.collect(),
            notes: file.notes,
        });
        for mut specimen in file.specimens {
            // The same name in two files is two specimens.
            if specimens.iter().any(|s| s.name == specimen.name) {
                specimen.name = format!("{} ({})", specimen.name, file.file);
            }
            specimens.push(specimen);
        }
    }
    (sources, specimens)
}
