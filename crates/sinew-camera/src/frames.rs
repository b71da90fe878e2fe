//! Frames of a folder in chronological order.

use super::error::CameraError;
use super::times::{PATTERNS, natural};
use sinew_files::csv::Table;
use sinew_files::{Bound, Budget, Fault, Fields as _, Located};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Source of the frame times.
#[derive(Debug, Clone, PartialEq)]
pub enum Times {
    /// File names: a number with a unit at the end (`frame_12.5s.png`, also ms, us, ns), a date with time of day
    /// (`20261121_143000_250.png`), or seconds, ms, µs or ns since 1970.
    Names,
    /// Frame rate in Hz; frames are ordered by name.
    Rate(f64),
    /// CSV file with the columns `file` and `time_s`.
    Table(PathBuf),
}

/// Frame of a folder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrameFile {
    pub(crate) path: PathBuf,
    pub(crate) name: String,
    pub(crate) time_s: f64,
}

/// Frames in chronological order.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct FrameList {
    pub(crate) frames: Vec<FrameFile>,
    /// Notes for the user.
    pub(crate) notes: Vec<String>,
}

/// Lists the frames of a folder.
pub(crate) fn list(folder: &Path, times: &Times) -> Result<FrameList, CameraError> {
    let io = |error| CameraError::Io {
        path: folder.to_path_buf(),
        error,
    };
    let mut names: Vec<String> = Vec::new();
    let mut others = 0;
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let entry = entry.map_err(io)?;
        let path = entry.path();
        if path.is_dir() {
            continue;
        }
        let picture = path.extension().is_some_and(|e| {
            ["png", "jpg", "jpeg"]
                .iter()
                .any(|known| e.eq_ignore_ascii_case(known))
        });
        match entry.file_name().into_string() {
            Ok(name) if picture => names.push(name),
            _ => others += 1,
        }
    }
    if names.is_empty() {
        return Err(CameraError::Empty {
            folder: folder.to_path_buf(),
        });
    }
    names.sort_by(|a, b| natural(a, b).then(a.cmp(b)));
    let mut list = FrameList::default();
    if others > 0 {
        list.notes
            .push(format!("{others} files that are not frames are ignored"));
    }
    match times {
        Times::Rate(rate) => {
            for (i, name) in names.into_iter().enumerate() {
                list.frames.push(frame(folder, name, i as f64 / rate));
            }
        }
        Times::Names => by_name(folder, names, &mut list)?,
        Times::Table(path) => by_table(folder, &names, path, &mut list)?,
    }
    Ok(list)
}

fn frame(folder: &Path, name: String, time_s: f64) -> FrameFile {
    FrameFile {
        path: folder.join(&name),
        name,
        time_s,
    }
}

fn by_name(folder: &Path, names: Vec<String>, list: &mut FrameList) -> Result<(), CameraError> {
    let stem = |name: &str| {
        name.rsplit_once('.')
            .map_or("", |(stem, _)| stem)
            .to_owned()
    };
    let first = stem(&names[0]);
    let pattern = PATTERNS.iter().position(|told| told(&first).is_some());
    let mut times = Vec::with_capacity(names.len());
    for name in &names {
        let time = pattern.and_then(|place| PATTERNS[place](&stem(name)));
        times.push(time.ok_or_else(|| CameraError::NoTimes { file: name.clone() })?);
    }
    // Times since 1970 are reduced by the first one; a number with a unit, the first pattern, counts from a zero of the
    // test.
    let zero = match pattern {
        Some(0) => 0,
        _ => times.iter().copied().min().unwrap_or(0),
    };
    let mut frames: Vec<(i128, FrameFile)> = names
        .into_iter()
        .zip(times)
        .map(|(name, t)| (t, frame(folder, name, (t - zero) as f64 / 1e9)))
        .collect();
    frames.sort_by_key(|(t, _)| *t);
    list.frames = frames.into_iter().map(|(_, frame)| frame).collect();
    Ok(())
}

fn by_table(
    folder: &Path,
    names: &[String],
    path: &Path,
    list: &mut FrameList,
) -> Result<(), CameraError> {
    let table = Table::read(path, &Budget::DESCRIPTION)?;
    table.need(&["file", "time_s"])?;
    let mut named = HashSet::new();
    let mut falls: Option<u64> = None;
    let mut last = f64::NEG_INFINITY;
    for row in table.rows() {
        let name = row.need_text("file")?;
        let time_s = row.need("time_s", Bound::Any, "when the frame was taken")?;
        if Path::new(name).components().count() != 1 {
            let must = "the name of a file in the folder of frames";
            return Err(row.invalid("file", must).into());
        }
        if !named.insert(name.to_owned()) {
            return Err(row.invalid("file", "named once; it is named twice").into());
        }
        if time_s < last && falls.is_none() {
            falls = Some(row.line());
        }
        last = time_s;
        list.frames.push(frame(folder, name.to_owned(), time_s));
    }
    if list.frames.is_empty() {
        let file = path.display().to_string();
        return Err(Located::new(&file, Fault::MissingKey, "no row names a frame").into());
    }
    if let Some(line) = falls {
        list.notes.push(format!(
            "times fall at line {line} of {}: frames are sorted by time",
            path.display()
        ));
        list.frames.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    }
    let unnamed = names.iter().filter(|n| !named.contains(*n)).count();
    if unnamed > 0 {
        list.notes.push(format!(
            "{unnamed} frames of the folder are not in {} and are ignored",
            path.display()
        ));
    }
    Ok(())
}
