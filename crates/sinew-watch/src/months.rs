//! Monthly Parquet files of records next to the database, for fleet trends and other tools, and thinning of old records.

use crate::runtime::{Request, Runtime};
use crate::store::{Place, Reader, StoreError};
use crate::words;
use sinew_files::date::{DAY_S, civil, day_number};
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Interval of the check for completed months.
const CHECK_INTERVAL: Duration = Duration::from_secs(3600);
/// Delay after the end of a month, s, within which its last sessions are stored.
const MONTH_END_DELAY_S: f64 = 2.0 * 3600.0;

/// Writer of the files of completed months.
pub struct Months {
    folder: Option<PathBuf>,
    place: Place,
    /// Age after which records are thinned, days; `None`: all are kept.
    thin_after_d: Option<u32>,
    next: Instant,
    running: Option<JoinHandle<()>>,
}

impl Months {
    /// Creates the writer for the store in this place; an in-memory store writes no files. Records are thinned
    /// `thin_after_d` days after their day; `None`: all are kept.
    pub fn new(place: &Place, thin_after_d: Option<u32>) -> Self {
        Self {
            folder: place.folder().map(|folder| folder.join("records")),
            place: place.clone(),
            thin_after_d,
            next: Instant::now(),
            running: None,
        }
    }

    /// Checks whether it is time, and writes in a separate thread.
    pub fn look(&mut self, runtime: &Runtime) {
        let busy = self
            .running
            .as_ref()
            .is_some_and(|thread| !thread.is_finished());
        let Some(folder) = self
            .folder
            .clone()
            .filter(|_| !busy && Instant::now() >= self.next)
        else {
            return;
        };
        self.next = Instant::now() + CHECK_INTERVAL;
        let (place, store) = (self.place.clone(), runtime.store());
        let health = std::sync::Arc::clone(runtime.health());
        let thin_after_d = self.thin_after_d;
        let thread = std::thread::Builder::new().name("months".into());
        let work = move || {
            let since = SystemTime::now().duration_since(UNIX_EPOCH);
            let now_s = since.map_or(0.0, |since| since.as_secs_f64());
            if let Err(error) = write(&place, &folder, now_s, &store) {
                health.log(&words::log::month_not_exported(&error.in_words()));
            } else if let Some(days) = thin_after_d {
                // A failure to read is reported by the export an hour later.
                let _later = thin(&place, now_s, days, &store);
            }
        };
        // Without a thread the export is repeated an hour later.
        self.running = thread.spawn(work).ok();
    }
}

/// Returns the month of a time in s since 1970 UTC, such as `2026-11`.
fn month_of(utc_s: f64) -> String {
    let (year, month, _) = civil((utc_s / DAY_S).floor() as i64);
    format!("{year:04}-{month:02}")
}

/// Returns start and end of a month, s since 1970 UTC.
fn bounds(month: &str) -> Option<[f64; 2]> {
    let (year, of_year) = month.split_once('-')?;
    let (year, of_year): (i64, i64) = (year.parse().ok()?, of_year.parse().ok()?);
    let (next_year, next) = if of_year == 12 {
        (year + 1, 1)
    } else {
        (year, of_year + 1)
    };
    let start = |year, month| Some(DAY_S * day_number(year, month, 1)? as f64);
    Some([start(year, of_year)?, start(next_year, next)?])
}

/// Writes every completed month with records that are in no file yet; returns the files written.
///
/// # Errors
/// Returns a [`StoreError`] if reading or writing fails; the months before are written.
pub fn write(
    place: &Place,
    folder: &Path,
    now_utc_s: f64,
    store: &Sender<Request>,
) -> Result<Vec<PathBuf>, StoreError> {
    let reader = Reader::open(place)?;
    let over = month_of(now_utc_s - MONTH_END_DELAY_S);
    let mut written = Vec::new();
    for pending in reader.not_exported()? {
        let Some(bounds) = bounds(&pending.month).filter(|_| pending.month < over) else {
            continue;
        };
        let name = format!("{}-{}.parquet", host(), pending.number);
        let month = format!("month={}", pending.month);
        let of_type = format!("robot_type={}", escaped(&pending.robot_type));
        let path = folder.join(of_type).join(month).join(name);
        reader.write_month(&pending, bounds, &path)?;
        let _ended = store.send(Request::Exported(pending));
        written.push(path);
    }
    Ok(written)
}

/// Thins the records of every robot that are older than some days, whole days at a time.
///
/// # Errors
/// Returns a [`StoreError`] if the store cannot be read.
fn thin(
    place: &Place,
    now_utc_s: f64,
    days: u32,
    store: &Sender<Request>,
) -> Result<(), StoreError> {
    let before_utc_s = DAY_S * ((now_utc_s / DAY_S).floor() - f64::from(days));
    for robot in Reader::open(place)?.robots()? {
        let _ended = store.send(Request::Thin {
            robot,
            before_utc_s,
        });
    }
    Ok(())
}

/// Returns the name of the host, reduced to characters allowed in file names.
fn host() -> String {
    let limit = sinew_files::Budget::SETTINGS;
    let name = sinew_files::read_text(Path::new("/etc/hostname"), &limit);
    let name = escaped(name.as_deref().unwrap_or("").trim());
    if name.is_empty() { "host".into() } else { name }
}

/// Replaces characters of a name that are not allowed in a path.
fn escaped(name: &str) -> String {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let text: String = name
        .chars()
        .map(|c| if fits(c) { c } else { '_' })
        .collect();
    text.trim_start_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn month_bounds_are_calendar_months() {
        let [start, end] = bounds("2026-12").unwrap();
        assert_eq!(
            (month_of(start), month_of(end - 1.0)),
            ("2026-12".into(), "2026-12".into())
        );
        assert_eq!(
            (month_of(start - 1.0), month_of(end)),
            ("2026-11".into(), "2027-01".into())
        );
        assert_eq!(bounds("x"), None);
        assert_eq!(escaped("../a b"), "_a_b");
    }
}
