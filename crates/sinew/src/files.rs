//! Checks of output paths before long work begins.

use crate::terminal::{Failure, asked, name_output, take_stdout};
use sinew_files::{OutputError, folder_of, is_stdout, write_file};
use sinew_log::{LogError, Table};
use std::path::{Path, PathBuf};

/// A file, if it was asked for, and what it is called on the command line.
pub type Named<'a> = (&'a str, Option<&'a Path>);

/// Writes a text where a file was asked for.
///
/// # Errors
/// [`OutputError`].
pub(crate) fn write_text(
    path: Option<&Path>,
    text: impl FnOnce() -> String,
) -> Result<(), OutputError> {
    path.map_or(Ok(()), |path| write_file(path, text().as_bytes()))
}

/// Writes a table where a file was asked for.
///
/// # Errors
/// [`LogError`].
pub fn write_table(path: Option<&Path>, table: impl FnOnce() -> Table) -> Result<(), LogError> {
    path.map_or(Ok(()), |path| table().write(path))
}

/// Refuses an output that has no folder to lie in or would replace an input or another output; a file that is
/// replaced is named on stderr when the command has ended well, unless `quiet`.
///
/// # Errors
/// [`Failure::Refused`] naming the option and the path.
pub fn check_outputs(
    outputs: &[Named<'_>],
    inputs: &[Named<'_>],
    quiet: bool,
) -> Result<(), Failure> {
    for (i, (option, path)) in outputs.iter().enumerate() {
        let Some(path) = path else { continue };
        let place = |why: String| Failure::Refused(format!("{option} {}: {why}", path.display()));
        if is_stdout(path) {
            let taken = outputs[..i].iter().find(|o| o.1.is_some_and(is_stdout));
            let taken = taken.map(|o| o.0);
            if let Some(other) = taken.or(asked("--json").then_some("--json")) {
                return Err(place(format!("stdout is taken by {other}; name a file")));
            }
            take_stdout();
            continue;
        }
        if path.is_dir() {
            return Err(place("is a folder; name a file".into()));
        }
        let folder = folder_of(path);
        if !folder.is_dir() {
            return Err(place(format!("folder {} does not exist", folder.display())));
        }
        let others = inputs.iter().chain(&outputs[..i]);
        let is_same = |p: Option<&Path>| p.is_some_and(|p| same(p, path));
        if let Some((other, _)) = others.into_iter().find(|(_, p)| is_same(*p)) {
            return Err(place(format!("is the same file as {other}")));
        }
    }
    for (option, path) in outputs {
        if let (Some(path), false) = (path, quiet) {
            name_output(option, path);
        }
    }
    Ok(())
}

/// Whether two paths lead to the same file, also when it doesn't exist yet.
fn same(a: &Path, b: &Path) -> bool {
    let resolved = |p: &Path| -> Option<PathBuf> {
        if let Ok(path) = p.canonicalize() {
            return Some(path);
        }
        Some(folder_of(p).canonicalize().ok()?.join(p.file_name()?))
    };
    matches!((resolved(a), resolved(b)), (Some(a), Some(b)) if a == b)
}
