//! `rows`: contents, duplicates and unreadable files of a folder.

use crate::FleetError;
use crate::args::Rows;
use crate::engine::Engine;
use crate::folder::Folder;
use crate::table;
use sinew_files::date::day_of;
use sinew_files::plain;
use std::process::ExitCode;

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(request: &Rows) -> Result<ExitCode, FleetError> {
    let mut engine = match request.verify {
        true => Engine::verified(&request.source)?,
        false => Engine::open(&request.source)?,
    };
    let (files, read) = engine
        .folder
        .files()
        .fold((0, 0), |(n, rows), file| (n + 1, rows + file.rows));
    let distinct = engine.count("every_version")?;
    let sessions = engine.count("records")?;
    let folder = &engine.folder;
    let times = folder
        .files()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], file| {
            [a.min(file.times_utc_s[0]), b.max(file.times_utc_s[1])]
        });
    let lines = [
        ("files", files.to_string()),
        ("rows", read.to_string()),
        ("duplicates", (read - distinct).to_string()),
        ("superseded", (distinct - sessions).to_string()),
        ("records", sessions.to_string()),
        ("robots", folder.robots().len().to_string()),
        ("from", day_of(times[0])),
        ("to", day_of(times[1])),
        ("versions", folder.versions().join(", ")),
    ];
    for (name, value) in lines {
        println!("{name:<20} {}", plain(&value));
    }
    let by_type = "SELECT robot_type, count(DISTINCT robot) AS robots, count(*) AS records, \
                   round(100.0 * count(offset_rad) / count(*), 1) AS \"with offset %\", \
                   round(100.0 * sum(CASE WHEN clock = 'utc' THEN 1 ELSE 0 END) / count(*), 1) AS \"dated %\" \
                   FROM records GROUP BY robot_type ORDER BY robot_type";
    let (text, _) = table::render(&engine.query(by_type)?, usize::MAX)?;
    print!("\n{text}");
    Ok(report_rejected(&engine.folder))
}

/// Reports the rejected files and returns the exit code.
pub(crate) fn report_rejected(folder: &Folder) -> ExitCode {
    for file in &folder.rejected {
        let path = file.path.display().to_string();
        eprintln!(
            "rejected: {}: {}",
            plain(&path),
            plain(&file.error.to_string())
        );
    }
    match folder.rejected.len() {
        0 => ExitCode::SUCCESS,
        n => {
            eprintln!(
                "{n} file(s) rejected; the results above are those of the others. Copy the files again or move them away"
            );
            ExitCode::from(3)
        }
    }
}
