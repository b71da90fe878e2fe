//! Files of a path: a file, a folder or a pattern, in the order of the parts.

use super::lerobot::INFO;
use crate::error::LogError;
use sinew_files::names::natural_key;
use sinew_files::{Budget, Fault, Located, read_text};
use std::path::{Path, PathBuf};

/// File name extensions of recordings in a folder.
const ENDINGS: [&str; 6] = [
    ".mcap",
    ".mcap.zst",
    ".mcap.zstd",
    ".db3",
    ".db3.zst",
    ".db3.zstd",
];

/// Files of `path`; the path itself if it is a file.
pub(super) fn files(path: &Path) -> Result<Vec<PathBuf>, LogError> {
    if path.is_dir() {
        return folder(path);
    }
    let name = path.file_name().map(|name| name.to_string_lossy());
    let pattern = name.filter(|name| name.contains(['*', '?']) && !path.exists());
    let Some(pattern) = pattern else {
        return Ok(vec![path.to_path_buf()]);
    };
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
    let parent = parent.unwrap_or(Path::new("."));
    let found = named(parent, |name| matches(&pattern, name))?;
    some(found, || {
        LogError::request(&path.display().to_string(), "no file matches the name")
    })
}

/// Files found, or an error if there are none.
fn some(found: Vec<PathBuf>, or: impl FnOnce() -> LogError) -> Result<Vec<PathBuf>, LogError> {
    match found.is_empty() {
        true => Err(or()),
        false => Ok(found),
    }
}

/// Returns the error for a folder without a recording.
fn no_recording(folder: &Path) -> LogError {
    let reason = format!("no recording in this folder: no {}", ENDINGS.join(", "));
    LogError::not_a_recording(&folder.display().to_string(), reason)
}

fn is_recording(name: &str) -> bool {
    ENDINGS.iter().any(|ending| name.ends_with(ending))
}

/// Recordings of `path` if each is a separate recording: the files that match a pattern, or those of a folder
/// that is not a bag; otherwise `path` itself.
///
/// # Errors
/// Returns [`LogError`] if no file matches a pattern, or a folder has no recording or cannot be read.
pub fn recordings_of(path: &Path) -> Result<Vec<PathBuf>, LogError> {
    let is_bag = |path: &Path| path.join(INFO).is_file() || path.join("metadata.yaml").is_file();
    if !path.is_dir() {
        let found = files(path)?.into_iter();
        let without_dot = |p: PathBuf| p.strip_prefix("./").map_or(p.clone(), Path::to_path_buf);
        return Ok(found.map(without_dot).collect());
    }
    if is_bag(path) {
        return Ok(vec![path.to_path_buf()]);
    }
    let found = entries(path, |path, name| {
        is_bag(path) || path.is_file() && is_recording(name)
    })?;
    some(found, || no_recording(path))
}

/// Recordings of a folder: those listed in its `metadata.yaml` (a ROS 2 bag), otherwise all.
fn folder(path: &Path) -> Result<Vec<PathBuf>, LogError> {
    if path.join(INFO).is_file() {
        return data_set(path);
    }
    if let Ok(metadata) = read_text(&path.join("metadata.yaml"), &Budget::SETTINGS) {
        let listed = bag_files(&metadata);
        if !listed.is_empty() {
            return listed.iter().map(|file| bag_file(path, file)).collect();
        }
    }
    some(named(path, is_recording)?, || no_recording(path))
}

/// The episodes of a LeRobot data set: `data/*/*.parquet`.
fn data_set(path: &Path) -> Result<Vec<PathBuf>, LogError> {
    let data = path.join("data");
    let mut chunks = entries(&data, |path, _| path.is_dir())?;
    chunks.sort();
    let mut found = Vec::new();
    for chunk in &chunks {
        found.extend(named(chunk, |name| name.ends_with(".parquet"))?);
    }
    some(found, || {
        LogError::not_a_recording(
            &data.display().to_string(),
            "a LeRobot data set without an episode: no .parquet",
        )
    })
}

/// Entries of `relative_file_paths` in the metadata of a bag.
fn bag_files(metadata: &str) -> Vec<String> {
    let lines = metadata.lines().map(str::trim);
    let mut listed = lines.skip_while(|line| !line.starts_with("relative_file_paths:"));
    listed.next();
    listed
        .map_while(|line| line.strip_prefix("- "))
        .map(|file| file.trim().trim_matches(['"', '\'']).to_owned())
        .collect()
}

/// File that the metadata of a bag list. Up to version 3 its path starts at the folder above, which may have been
/// renamed since; the file may have been compressed.
fn bag_file(folder: &Path, listed: &str) -> Result<PathBuf, LogError> {
    let name = Path::new(listed)
        .file_name()
        .map_or(Path::new(listed), Path::new);
    let mut candidates = vec![folder.join(listed), folder.join(name)];
    for ending in [".zst", ".zstd"] {
        candidates.push(folder.join(format!("{}{ending}", name.display())));
    }
    if let Some(found) = candidates.into_iter().find(|file| file.is_file()) {
        return Ok(found);
    }
    let present = named(folder, is_recording)?;
    let file = folder.join("metadata.yaml").display().to_string();
    let cure = match &present[..] {
        [] => "no recording is in the folder".to_owned(),
        [only] => format!(
            "read {} instead, or correct relative_file_paths",
            only.display()
        ),
        [first, ..] => format!(
            "the folder has {} recordings such as {}; read them by their names, or correct relative_file_paths",
            present.len(),
            first.display()
        ),
    };
    let problem = format!("names '{listed}', which is not in the folder");
    Err(Located::new(&file, Fault::UnknownName, problem)
        .cure(cure)
        .into())
}

/// Files of a folder by their names, numbers in order.
fn named(folder: &Path, is: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>, LogError> {
    entries(folder, |path, name| path.is_file() && is(name))
}

/// Entries of a folder for which `is` holds by path and name; numbers in numerical order.
fn entries(folder: &Path, is: impl Fn(&Path, &str) -> bool) -> Result<Vec<PathBuf>, LogError> {
    let entries = std::fs::read_dir(folder)
        .map_err(|source| LogError::io(&folder.display().to_string(), "read", source))?;
    let mut found: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| {
            let name = path.file_name().map(|name| name.to_string_lossy());
            name.is_some_and(|name| is(path, &name))
        })
        .collect();
    found.sort_by_cached_key(|path| natural_key(&path.to_string_lossy()));
    Ok(found)
}

/// Whether a name matches a pattern with `*` (any characters) and `?` (one character).
fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name) = (
        Vec::from_iter(pattern.chars()),
        Vec::from_iter(name.chars()),
    );
    let (mut p, mut n) = (0, 0);
    // Position of the last star, and the length it has matched so far.
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, n));
                p += 1;
            }
            Some(c) if *c == '?' || *c == name[n] => {
                p += 1;
                n += 1;
            }
            _ => match &mut star {
                Some((at, taken)) => {
                    *taken += 1;
                    (p, n) = (*at + 1, *taken);
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_fit_patterns() {
        for (pattern, name, fits) in [
            ("*.mcap", "a.mcap", true),
            ("*.mcap", "a.mcap.zst", false),
            ("run_?.mcap", "run_1.mcap", true),
            ("run_?.mcap", "run_12.mcap", false),
            ("*a*b*", "xxaxxbaxb", true),
            ("*a*b", "xxaxxba", false),
            ("*", "", true),
        ] {
            assert_eq!(matches(pattern, name), fits, "{pattern} {name}");
        }
    }
}
