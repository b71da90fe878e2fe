//! Lock of a file from which stopped runs resume: one run at a time.

use std::fs::{File, TryLockError};

/// Locks a file for as long as it is open. On a file system without locks two runs repeat each
/// other's work.
///
/// # Errors
/// Returns the holder of the lock: `process 4711, since 2026-03-01 08:30:05 UTC`, or `another
/// process` if the system does not report it.
pub fn lock(file: &File) -> Result<(), String> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(holder(file).unwrap_or("another process".into())),
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

#[cfg(not(target_os = "linux"))]
fn holder(_file: &File) -> Option<String> {
    None
}

/// The process that the system lists as holder of a file's lock, and when it was started.
#[cfg(target_os = "linux")]
fn holder(file: &File) -> Option<String> {
    use std::fs::read_to_string;
    use std::os::unix::fs::MetadataExt as _;

    /// Number of times that the list of locks is read.
    const ATTEMPTS: usize = 5;
    // `1: FLOCK  ADVISORY  WRITE 4711 fe:00:131077 0 EOF`
    let end = format!(":{}", file.metadata().ok()?.ino());
    let listed = || {
        let locks = read_to_string("/proc/locks").ok()?;
        locks.lines().find_map(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            let [_, "FLOCK", _, "WRITE", process, place, ..] = words[..] else {
                return None;
            };
            place.ends_with(&end).then(|| process.to_owned())
        })
    };
    // The list is read in parts: where other locks are released meanwhile, it lacks entries.
    let process = (0..ATTEMPTS).find_map(|_| listed())?;
    let since = started_ns(&process).and_then(crate::date::utc_text);
    let since = since.map_or_else(String::new, |since| format!(", since {since}"));
    Some(format!("process {process}{since}"))
}

/// When a process was started, ns since 1970.
#[cfg(target_os = "linux")]
fn started_ns(process: &str) -> Option<i64> {
    use std::fs::read_to_string;

    /// Clock ticks per second in the process times of Linux, identical on all architectures.
    const TICKS_PER_S: i64 = 100;
    /// Number of fields of `stat` between the name, which may contain spaces, and the start time.
    const BEFORE: usize = 19;
    let stat = read_to_string(format!("/proc/{process}/stat")).ok()?;
    let (_, words) = stat.rsplit_once(')')?;
    let ticks: i64 = words.split_whitespace().nth(BEFORE)?.parse().ok()?;
    let system = read_to_string("/proc/stat").ok()?;
    let booted_s = system.lines().find_map(|line| line.strip_prefix("btime "));
    let booted_s: i64 = booted_s?.trim().parse().ok()?;
    (booted_s + ticks / TICKS_PER_S).checked_mul(1_000_000_000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lock_error_names_holder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let first = File::create(&path).unwrap();
        assert_eq!(lock(&first), Ok(()));
        let told = lock(&File::open(&path).unwrap()).unwrap_err();
        if cfg!(target_os = "linux") {
            let this = format!("process {}, since 20", std::process::id());
            assert!(told.starts_with(&this), "{told}");
        }
        drop(first);
        assert_eq!(lock(&File::open(&path).unwrap()), Ok(()));
    }
}
