//! Commands of the program besides monitoring: backup, lifetimes of ropes, disk usage, test notification, and acknowledgement of an alarm.

use crate::args::Acknowledge;
use crate::config::{Config, PostFormat, Webhook};
use crate::store::{Place, Reader, RecordQuery, StoreError, write_lives};
use crate::token;
use crate::webhooks::{Message, exchange, test};
use hyper::body::Bytes;
use sinew_watch_core::alarm::AlarmKey;
use sinew_watch_core::command::{Command, CommandKind};
use std::net::IpAddr;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

/// Maximum time to wait for the monitor: the store may be slow.
const MAX_ANSWER_TIME: Duration = Duration::from_secs(30);
/// Days of a year.
const YEAR_D: f64 = 365.25;

fn read(config: &Path) -> Result<Config, String> {
    Config::read(config).map_err(|e| e.to_string())
}

/// Opens the store of a configuration for reading.
fn reader(config: Config) -> Result<(Reader, Place), String> {
    let place = Place::Folder(config.store);
    let reader = Reader::open(&place).and_then(|reader| reader.check().map(|()| reader));
    let reader = reader.map_err(|e| of_store(&place, &e))?;
    Ok((reader, place))
}

fn of_store(place: &Place, error: &StoreError) -> String {
    format!("{}: {error}", place.file())
}

/// Copies the store into a file.
///
/// # Errors
/// Returns the reason as text.
pub fn backup(config: &Path, target: &Path) -> Result<ExitCode, String> {
    let (reader, place) = reader(read(config)?)?;
    let length = reader.backup(target).map_err(|e| of_store(&place, &e))?;
    println!("{}: {:.1} MB", target.display(), 1e-6 * length as f64);
    Ok(ExitCode::SUCCESS)
}

/// Writes the lifetimes of ropes as a CSV file.
///
/// # Errors
/// Returns the reason as text.
pub fn survival(config: &Path, table: &Path) -> Result<ExitCode, String> {
    let (reader, place) = reader(read(config)?)?;
    let count = write_lives(&reader, &RecordQuery::default(), table);
    let count = count.map_err(|e| of_store(&place, &e))?;
    println!("{}: {count} ropes", table.display());
    Ok(ExitCode::SUCCESS)
}

/// Prints the size of the store: the whole, and for each robot its share and the growth in a year of operation.
///
/// # Errors
/// Returns the reason as text.
pub fn disk(config: &Path) -> Result<ExitCode, String> {
    let (reader, place) = reader(read(config)?)?;
    let usage = reader.usage().map_err(|e| of_store(&place, &e))?;
    let file = place.file();
    let length = |path: &str| std::fs::metadata(path).map_or(0, |of| of.len());
    let length = length(&file) + length(&format!("{file}-wal"));
    println!("{file}: {:.1} MB", 1e-6 * length as f64);
    if let Some(folder) = place.folder() {
        let records = folder.join("records");
        println!(
            "{}: {:.1} MB",
            records.display(),
            1e-6 * below(&records) as f64
        );
    }
    println!("robot records days MB MB_per_year");
    for robot in usage {
        let bytes = robot.history_bytes + robot.state_bytes as f64;
        let per_year = robot.history_bytes / robot.days.max(1) as f64 * YEAR_D;
        println!(
            "{} {} {} {:.2} {:.1}",
            robot.robot,
            robot.records,
            robot.days,
            1e-6 * bytes,
            1e-6 * per_year
        );
    }
    Ok(ExitCode::SUCCESS)
}

/// Returns the length of all files below a folder, bytes; 0: there is none.
fn below(folder: &Path) -> u64 {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let length = |entry: std::fs::DirEntry| match entry.metadata() {
        Ok(of) if of.is_dir() => below(&entry.path()),
        Ok(of) => of.len(),
        Err(_) => 0,
    };
    entries.map(length).sum()
}

/// Runs a task of notifications to its end.
fn wait<T>(task: impl Future<Output = T>) -> Result<T, String> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    Ok(runtime.map_err(|e| e.to_string())?.block_on(task))
}

/// Sends a test notification to every receiver, and prints the results; exit code 1: one failed.
///
/// # Errors
/// Returns the reason as text if the configuration is invalid or has no receiver.
pub fn notify(config: &Path) -> Result<ExitCode, String> {
    let receivers = read(config)?.receivers;
    if receivers.is_empty() {
        return Err(crate::words::response::NO_RECEIVER.into());
    }
    let results = wait(test(&receivers))?;
    for (name, done) in &results {
        println!(
            "{name}: {}",
            done.as_ref().err().map_or("delivered", String::as_str)
        );
    }
    let failed = results.iter().any(|(_, done)| done.is_err());
    Ok(ExitCode::from(u8::from(failed)))
}

/// Acknowledges an alarm of the monitor that runs on this host with this configuration.
///
/// # Errors
/// Returns the reason as text if the monitor cannot be reached or rejects the command.
pub fn acknowledge(alarm: &Acknowledge) -> Result<ExitCode, String> {
    let config = read(&alarm.config)?;
    let Some(bind) = config.web.bind else {
        return Err("the API is disabled by web.off; remove it to send commands".into());
    };
    let host = match bind.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => "127.0.0.1".into(),
        IpAddr::V6(ip) if ip.is_unspecified() => "[::1]".into(),
        IpAddr::V4(ip) => ip.to_string(),
        IpAddr::V6(ip) => format!("[{ip}]"),
    };
    let command = Command {
        who: alarm.who.clone(),
        note: alarm.note.clone(),
        what: CommandKind::Acknowledge {
            alarm: AlarmKey {
                joint: alarm.joint.clone(),
                condition: alarm.condition,
            },
        },
    };
    let files = token::files(&config.web, &config.store);
    let token_file = files.into_iter().next().map(|(.., path)| path);
    let monitor = Webhook {
        tls: false,
        host,
        port: bind.port(),
        path: format!("/api/v1/robots/{}/commands", alarm.robot),
        format: PostFormat::Sinew,
        severity_min: 0,
        token_file: token_file.filter(|_| config.web.needs_token()),
        ca_file: None,
    };
    let body = serde_json::to_vec(&command).map_err(|e| e.to_string())?;
    let message = Message {
        kind: "application/json",
        headers: vec![("x-sinew", "1".into())],
        body: Bytes::from(body),
    };
    let sent = async { tokio::time::timeout(MAX_ANSWER_TIME, exchange(&monitor, message)).await };
    let late = |_| format!("no answer within {MAX_ANSWER_TIME:?}");
    let at = |reason: String| format!("{bind}: {reason}; check that the monitor is running");
    let (status, body) = wait(sent)?.map_err(late).map_err(at)?.map_err(at)?;
    if status.is_success() {
        println!("acknowledged");
        return Ok(ExitCode::SUCCESS);
    }
    let answer: Option<serde_json::Value> = serde_json::from_slice(&body).ok();
    let reason = answer.as_ref().and_then(|a| a.get("error")?.as_str());
    Err(reason.map_or(format!("response {status}"), str::to_owned))
}
