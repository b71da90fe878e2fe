//! Folder of records: its files, duplicate sessions and unreadable files.

mod scan;
pub mod sides;

pub use scan::{FileError, RecordFile, RejectedFile};

use crate::FleetError;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Names of the optional side tables (CSV) in the folder of the records.
pub const SIDES: [&str; 3] = ["robots", "tendons", "events"];

/// Ending of a file of records.
pub(crate) const RECORDS: &str = "parquet";
/// Ending of a baseline.
pub(crate) const BASELINES: &str = "baseline";
/// Folder of the robot types, in the folder of the records.
pub(crate) const TYPES: &str = "types";

/// Content of a folder of records.
#[derive(Debug, Clone, Default)]
pub struct Folder {
    /// Path of the folder.
    pub path: PathBuf,
    /// Files without overlap with another file, whose rows ascend strictly by robot, joint and time: no duplicates.
    pub clean: Vec<RecordFile>,
    /// Files that may contain duplicate sessions, within the file or with another file.
    pub ambiguous: Vec<RecordFile>,
    /// Files that were rejected.
    pub rejected: Vec<RejectedFile>,
}

impl Folder {
    /// Reads the keys of every file. An unreadable file does not affect the others.
    ///
    /// # Errors
    /// Returns [`FleetError`] if the folder cannot be read or contains no file of records.
    pub fn open(path: &Path) -> Result<Self, FleetError> {
        Self::look(path, false)
    }

    /// Reads every column of every file, which also detects damage outside the keys.
    ///
    /// # Errors
    /// As [`Folder::open`].
    pub fn verified(path: &Path) -> Result<Self, FleetError> {
        Self::look(path, true)
    }

    fn look(path: &Path, whole: bool) -> Result<Self, FleetError> {
        let mut found = Vec::new();
        find(path, RECORDS, &mut found)?;
        found.sort_unstable();
        let scanned: Vec<Result<RecordFile, RejectedFile>> = (found.into_par_iter())
            .map(|file| scan::scan(&file, whole))
            .collect();
        let mut out = Self {
            path: path.into(),
            ..Self::default()
        };
        let mut files = Vec::new();
        for file in scanned {
            match file {
                Ok(file) if file.rows == 0 => {}
                Ok(file) => files.push(file),
                Err(rejected) => out.rejected.push(rejected),
            }
        }
        if files.is_empty() && out.rejected.is_empty() {
            return Err(FleetError::NoRecords(path.into()));
        }
        let overlaps = overlapping(&files);
        for (file, overlaps) in files.into_iter().zip(overlaps) {
            match overlaps || !file.ascends {
                true => out.ambiguous.push(file),
                false => out.clean.push(file),
            }
        }
        Ok(out)
    }

    /// All files that can be read.
    pub fn files(&self) -> impl Iterator<Item = &RecordFile> {
        self.clean.iter().chain(&self.ambiguous)
    }

    /// Names of the robots.
    pub fn robots(&self) -> BTreeSet<&str> {
        let names = self.files().flat_map(|file| &file.robots);
        names.map(String::as_str).collect()
    }

    /// Versions of the program that wrote records, oldest first.
    pub fn versions(&self) -> Vec<&str> {
        let all: BTreeSet<&str> = self
            .files()
            .flat_map(|file| &file.versions)
            .map(String::as_str)
            .collect();
        let mut all: Vec<&str> = all.into_iter().collect();
        all.sort_by_key(|version| order_of(version));
        all
    }
}

/// Path of a side table, if present.
pub(crate) fn side(folder: &Path, name: &str) -> Option<PathBuf> {
    let path = folder.join(format!("{name}.csv"));
    path.is_file().then_some(path)
}

/// Sort key of a version: `0.10.0` is later than `0.9.2` and than its own `0.10.0-rc.1`.
fn order_of(version: &str) -> (Vec<u64>, bool, String) {
    let (numbers, rest) = match version.split_once('-') {
        Some((numbers, rest)) => (numbers, rest),
        None => (version, ""),
    };
    let numbers = numbers.split('.').map(|n| n.parse().unwrap_or(0));
    (numbers.collect(), rest.is_empty(), rest.to_owned())
}

/// Finds the files with an extension in a folder and its subfolders, without hidden ones.
pub(crate) fn find(
    folder: &Path,
    ending: &str,
    found: &mut Vec<PathBuf>,
) -> Result<(), FleetError> {
    let wrong = |source| FleetError::Folder {
        path: folder.into(),
        source,
    };
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        let entry = entry.map_err(wrong)?;
        let path = entry.path();
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        // Links to folders are not followed; one to a parent folder would never end.
        if entry.file_type().map_err(wrong)?.is_dir() {
            find(&path, ending, found)?;
        } else if path.extension().is_some_and(|e| e == ending) && path.is_file() {
            found.push(path);
        }
    }
    Ok(())
}

/// Whether another file may contain the same session, for each file: common robots and overlapping times.
fn overlapping(files: &[RecordFile]) -> Vec<bool> {
    let mut out = vec![false; files.len()];
    let mut order: Vec<usize> = (0..files.len()).collect();
    order.sort_by(|a, b| files[*a].times_utc_s[0].total_cmp(&files[*b].times_utc_s[0]));
    for (at, &i) in order.iter().enumerate() {
        let end = files[i].times_utc_s[1];
        for &j in &order[at + 1..] {
            if files[j].times_utc_s[0] > end {
                break;
            }
            if !files[i].robots.is_disjoint(&files[j].robots) {
                (out[i], out[j]) = (true, true);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::order_of;

    #[test]
    fn versions_are_ordered_by_their_numbers() {
        let sorted = ["0.9.2", "0.10.0-rc.1", "0.10.0", "1.0.0"];
        assert!(sorted.is_sorted_by_key(|v| order_of(v)));
    }
}
