//! Which frames there are, in order of time.

use super::error::CameraError;
use super::times::{NamePattern, natural};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// What tells when the frames were taken.
#[derive(Debug, Clone, PartialEq)]
pub enum Times {
    /// File names: a number with a unit at the end (`frame_12.5s.png`, also ms, us, ns), a date
    /// with time of day (`20261121_143000_250.png`), or seconds, ms, µs or ns since 1970.
    Names,
    /// Frames per second, in the order of the names.
    Rate(f64),
    /// CSV with the columns `file` and `time_s`.
    Table(PathBuf),
}

/// One frame of a folder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrameFile {
    pub(crate) path: PathBuf,
    pub(crate) name: String,
    pub(crate) time_s: f64,
}

/// Frames in order of time.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct FrameList {
    pub(crate) frames: Vec<FrameFile>,
    /// What a person should know.
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
            .push(format!("{others} files that are not frames are left out"));
    }
    match times {
        Times::Rate(rate) => {
            if !(*rate > 0.0 && rate.is_finite()) {
                return Err(CameraError::Option(format!(
                    "a frame rate of {rate} 1/s can't be; say frames per second above 0"
                )));
            }
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
    let pattern = NamePattern::of(&stem(&names[0]));
    let mut times = Vec::with_capacity(names.len());
    for name in &names {
        let time = pattern.and_then(|p| p.nanoseconds(&stem(name)));
        times.push(time.ok_or_else(|| CameraError::NoTimes { file: name.clone() })?);
    }
    // Seconds since 1970 would drown in the first columns of a table; a test has its own zero.
    let zero = match pattern {
        Some(NamePattern::Suffix) => 0,
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
    let refuse = |line: u64, reason: String| CameraError::Times {
        path: path.to_path_buf(),
        line,
        reason,
    };
    let text = std::fs::read(path).map_err(|error| CameraError::Io {
        path: path.to_path_buf(),
        error,
    })?;
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text);
    let header = reader
        .headers()
        .map_err(|e| refuse(1, format!("not a CSV: {e}")))?
        .clone();
    let column = |name: &str| {
        header
            .iter()
            .position(|h| h.eq_ignore_ascii_case(name))
            .ok_or_else(|| {
                refuse(
                    1,
                    format!(
                        "no column '{name}'; the columns must be file,time_s, but are {}",
                        header.iter().take(8).collect::<Vec<_>>().join(",")
                    ),
                )
            })
    };
    let (file, time) = (column("file")?, column("time_s")?);
    let mut named = HashSet::new();
    let mut falls: Option<u64> = None;
    let mut last = f64::NEG_INFINITY;
    for record in reader.records() {
        let record = record.map_err(|e| {
            let line = e.position().map_or(0, csv::Position::line);
            refuse(line, format!("not a CSV: {e}"))
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let (Some(name), Some(text)) = (record.get(file), record.get(time)) else {
            return Err(refuse(line, "a row needs a file and a time_s".into()));
        };
        let time_s: f64 = text
            .parse()
            .ok()
            .filter(|t: &f64| t.is_finite())
            .ok_or_else(|| refuse(line, format!("time_s '{text}' is not a number of seconds")))?;
        if name.is_empty() || Path::new(name).components().count() != 1 {
            return Err(refuse(
                line,
                format!("file '{name}' is not the name of a file in the folder of frames"),
            ));
        }
        if !named.insert(name.to_owned()) {
            return Err(refuse(line, format!("file '{name}' is named twice")));
        }
        if time_s < last && falls.is_none() {
            falls = Some(line);
        }
        last = time_s;
        list.frames.push(frame(folder, name.to_owned(), time_s));
    }
    if list.frames.is_empty() {
        return Err(refuse(1, "no row names a frame".into()));
    }
    if let Some(line) = falls {
        list.notes.push(format!(
            "times fall at line {line} of {}: frames are read in order of time",
            path.display()
        ));
        list.frames.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    }
    let unnamed = names.iter().filter(|n| !named.contains(*n)).count();
    if unnamed > 0 {
        list.notes.push(format!(
            "{unnamed} frames of the folder are not in {} and left out",
            path.display()
        ));
    }
    Ok(())
}
