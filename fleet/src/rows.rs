//! `rows`: what a folder holds, what is twice, what can't be read.

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
pub fn command(asked: &Rows) -> Result<ExitCode, FleetError> {
    let mut engine = match asked.verify {
        true => Engine::verified(&asked.source)?,
        false => Engine::open(&asked.source)?,
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
        ("the same again", (read - distinct).to_string()),
        ("of an older version", (distinct - sessions).to_string()),
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
    let (text, _) = table::render(&engine.ask(by_type)?, usize::MAX)?;
    print!("\n{text}");
    Ok(tell_refused(&engine.folder))
}

/// Says which files were refused, and the exit code.
pub(crate) fn tell_refused(folder: &Folder) -> ExitCode {
    for refused in &folder.refused {
        let path = refused.path.display().to_string();
        eprintln!(
            "refused: {}: {}",
            plain(&path),
            plain(&refused.trouble.to_string())
        );
    }
    match folder.refused.len() {
        0 => ExitCode::SUCCESS,
        n => {
            eprintln!(
                "{n} file(s) refused; what the others hold is above. Copy them again, or move them away"
            );
            ExitCode::from(3)
        }
    }
}
