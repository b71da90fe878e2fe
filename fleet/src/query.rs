//! `query`: SQL on a fleet.

use crate::FleetError;
use crate::args::Query;
use crate::engine::{Answer, Engine};
use crate::rows::report_rejected;
use crate::table;
use datafusion::arrow::csv::WriterBuilder;
use sinew_files::AtomicFile;
use std::path::Path;
use std::process::ExitCode;

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(request: &Query) -> Result<ExitCode, FleetError> {
    let mut engine = Engine::described(&request.source, &request.robots)?;
    let answer = engine.query(&request.sql)?.flat()?;
    match &request.csv {
        Some(path) => {
            let rows = write_csv(&answer, path)?;
            println!("{}: {rows} rows", path.display());
        }
        None => {
            let (text, rows) = table::render(&answer, request.rows)?;
            print!("{text}");
            if rows > request.rows {
                println!(
                    "… {} rows more; --rows N shows more, --csv FILE writes all",
                    rows - request.rows
                );
            }
        }
    }
    Ok(report_rejected(&engine.folder))
}

/// Writes the rows; how many.
fn write_csv(answer: &Answer, path: &Path) -> Result<usize, FleetError> {
    let wrong = |e: &dyn std::fmt::Display| FleetError::Engine(format!("{}: {e}", path.display()));
    let mut file = AtomicFile::create(path).map_err(|e| wrong(&e))?;
    let empty = datafusion::arrow::array::RecordBatch::new_empty(answer.schema.clone());
    let mut writer = WriterBuilder::new().with_header(true).build(&mut file);
    // An answer without rows still has its columns.
    for batch in std::iter::once(&empty).chain(&answer.batches) {
        writer.write(batch).map_err(|e| wrong(&e))?;
    }
    drop(writer);
    file.finish().map_err(|e| wrong(&e))?;
    Ok(answer.batches.iter().map(|b| b.num_rows()).sum())
}
