//! Checks of output paths before a computation starts.

use crate::terminal::{Failure, inputs_on_command_line, is_specified, name_output, take_stdout};
use sinew_files::{OutputError, folder_of, is_stdout, write_file};
use sinew_log::{LogError, Table};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Name of an option and its file, if one is specified.
pub type Named<'a> = (&'a str, Option<&'a Path>);

/// Writes a text if a file is specified.
///
/// # Errors
///
/// Returns [`OutputError`] if the file cannot be written.
pub(crate) fn write_text(
    path: Option<&Path>,
    text: impl FnOnce() -> String,
) -> Result<(), OutputError> {
    path.map_or(Ok(()), |path| write_file(path, text().as_bytes()))
}

/// Writes a table if a file is specified.
///
/// # Errors
///
/// Returns [`LogError`] if the file cannot be written.
pub fn write_table(path: Option<&Path>, table: impl FnOnce() -> Table) -> Result<(), LogError> {
    path.map_or(Ok(()), |path| table().write(path))
}

/// Checks that no output replaces an input or another output, and creates missing folders of all outputs.
///
/// Replaced files are listed on stderr at the end of the command.
///
/// # Errors
///
/// Returns [`Failure::Error`] with the option and the path.
pub fn check_outputs(outputs: &[Named<'_>], inputs: &[Named<'_>]) -> Result<(), Failure> {
    for (i, (option, path)) in outputs.iter().enumerate() {
        let Some(path) = path else { continue };
        let place =
            |reason: String| Failure::Error(format!("{option} {}: {reason}", path.display()));
        if is_stdout(path) {
            let taken = outputs[..i].iter().find(|o| o.1.is_some_and(is_stdout));
            let taken = taken.map(|o| o.0);
            if let Some(other) = taken.or(is_specified("--json").then_some("--json")) {
                return Err(place(format!(
                    "stdout is already used by {other}; specify a file"
                )));
            }
            take_stdout();
            continue;
        }
        if path.is_dir() {
            return Err(place("is a folder; specify a file".into()));
        }
        create_folder(option, folder_of(path))?;
        let others = inputs.iter().chain(&outputs[..i]);
        let is_same = |p: Option<&Path>| p.is_some_and(|p| same(p, path));
        if let Some((other, _)) = others.into_iter().find(|(_, p)| is_same(*p)) {
            return Err(place(format!("is the same file as {other}")));
        }
        if let Some(argument) = input_that_holds(path, outputs) {
            let argument = argument.display();
            return Err(place(format!(
                "is an input of this command ({argument}); specify another file"
            )));
        }
    }
    for (option, path) in outputs {
        if let Some(path) = path {
            name_output(option, path);
        }
    }
    Ok(())
}

/// Argument of the command line that is the existing file `output`, or a folder that a command reads it from: the folder of a
/// robot or of recordings. The arguments of output options do not count.
fn input_that_holds(output: &Path, outputs: &[Named<'_>]) -> Option<PathBuf> {
    let output = output.canonicalize().ok()?;
    let is_read = |folder: &Path| {
        let extensions: &[&str] = match folder.join("robot.toml").is_file() {
            true => &["toml", "urdf", "xml"],
            false => &["db3", "mcap", "yaml", "zst", "zstd"],
        };
        let extension = output.extension().map(OsStr::to_ascii_lowercase);
        extension.is_some_and(|e| extensions.iter().any(|read| e == *read))
    };
    let holds = |argument: &PathBuf| match argument.canonicalize() {
        Ok(folder) if folder.is_dir() => output.parent() == Some(&folder) && is_read(&folder),
        Ok(file) => file == output,
        Err(_) => false,
    };
    inputs_on_command_line(outputs).into_iter().find(holds)
}

/// Creates a folder and its parents if they are missing.
///
/// * `option`: option that names the folder or a file in it.
///
/// # Errors
///
/// Returns [`Failure::Error`] with the option and the folder.
pub(crate) fn create_folder(option: &str, folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|e| {
        let folder = folder.display();
        Failure::Error(format!("{option}: cannot create the folder {folder}: {e}"))
    })
}

/// Whether two paths refer to the same file, which need not exist.
fn same(a: &Path, b: &Path) -> bool {
    let resolved = |p: &Path| -> Option<PathBuf> {
        if let Ok(path) = p.canonicalize() {
            return Some(path);
        }
        Some(folder_of(p).canonicalize().ok()?.join(p.file_name()?))
    };
    matches!((resolved(a), resolved(b)), (Some(a), Some(b)) if a == b)
}
