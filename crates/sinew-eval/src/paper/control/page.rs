//! The table, as text and as a page.

use super::super::PaperError;
use super::super::page::{Written, write};
use super::{Control, Row};
use sinew_figure::Table;
use sinew_files::write_file;
use std::fmt::Write as _;
use std::path::Path;

/// Headings of [`table`]; units stand in the last line.
const HEAD: [&str; 9] = [
    "robot",
    "known",
    "pitch\nat rest\nmrad",
    "elbow\nat rest\nmrad",
    "pitch\noverall\nmrad",
    "false\ntorque\nN·m",
    "false\nalarm\n%",
    "missed\n\n%",
    "delay\n\nms",
];

/// The table as headings and cells; torque is the shoulder pitch's.
pub fn table(rows: &[Row]) -> (Vec<&'static str>, Vec<Vec<String>>) {
    let cells = rows
        .iter()
        .map(|r| {
            vec![
                r.robot.into(),
                r.knows.into(),
                number(r.rest_mrad[0], 1),
                number(r.rest_mrad[1], 1),
                number(r.motion_mrad[0], 1),
                number(r.false_torque_nm[0], 2),
                number(r.contacts.false_percent(), 1),
                number(r.contacts.missed_percent(), 0),
                number(r.contacts.delay_median_ms(), 0),
            ]
        })
        .collect();
    (HEAD.to_vec(), cells)
}

/// With so many decimals, without a minus before zeros; a dash for nothing.
fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let text = format!("{value:.decimals$}");
    let zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    if zero {
        text.replace('-', "")
    } else {
        text.replace('-', "−")
    }
}

/// Writes `control.svg`, `.png`, `.html` and `.csv` into `folder`, which must exist.
///
/// # Errors
/// [`PaperError`]; each file is whole or not there.
pub fn write_control(control: &Control, folder: &Path) -> Result<Written, PaperError> {
    write_file(&folder.join("control.csv"), csv(&control.rows).as_bytes())?;
    write(&control.figure, folder)
}

/// The table of the page: with spreads, thresholds and rates.
pub(super) fn full_table(rows: &[Row], seeds: u64) -> Table {
    let head = [
        "robot",
        "known",
        "at rest, mrad",
        "overall, mrad",
        "false torque, N·m",
        "threshold, N·m",
        "false alarm, % of free time",
        "false alarms per min",
        "missed, %",
        "delay, ms",
    ];
    let contacts = rows.first().map_or(0, |r| r.contacts.contacts);
    let spread =
        |v: [f64; 2], s: [f64; 2]| format!("{:.1} ± {:.1}; {:.1} ± {:.1}", v[0], s[0], v[1], s[1]);
    let pair = |v: [f64; 2]| format!("{}; {}", number(v[0], 2), number(v[1], 2));
    let range = |v: f64, r: [f64; 2], decimals: usize| {
        format!("{v:.decimals$} ({:.decimals$}–{:.decimals$})", r[0], r[1])
    };
    Table {
        caption: format!(
            "Before and after. Two numbers in a cell: shoulder pitch; elbow. RMS of q − q_d; ± standard deviation over {seeds} sessions; {contacts} contacts in each row; brackets: lowest and highest session."
        ),
        head: head.map(String::from).to_vec(),
        rows: rows
            .iter()
            .map(|r| {
                let c = &r.contacts;
                vec![
                    r.robot.into(),
                    r.knows.into(),
                    spread(r.rest_mrad, r.rest_spread_mrad),
                    spread(r.motion_mrad, r.motion_spread_mrad),
                    pair(r.false_torque_nm),
                    pair(r.threshold_nm),
                    range(c.false_percent(), r.false_percent_range, 1),
                    number(c.false_per_minute(), 1),
                    range(c.missed_percent(), r.missed_percent_range, 0),
                    number(c.delay_median_ms(), 0),
                ]
            })
            .collect(),
    }
}

fn csv(rows: &[Row]) -> String {
    let mut out = String::from(
        "robot,known,rest_shoulder_pitch_mrad,rest_shoulder_pitch_spread_mrad,rest_elbow_mrad,rest_elbow_spread_mrad,overall_shoulder_pitch_mrad,overall_elbow_mrad,false_torque_shoulder_pitch_nm,false_torque_elbow_nm,threshold_shoulder_pitch_nm,threshold_elbow_nm,free_s,false_s,false_alarms,contacts,missed,delay_median_ms\n",
    );
    for r in rows {
        let c = &r.contacts;
        let _ = writeln!(
            out,
            "{},\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            r.robot,
            r.knows,
            r.rest_mrad[0],
            r.rest_spread_mrad[0],
            r.rest_mrad[1],
            r.rest_spread_mrad[1],
            r.motion_mrad[0],
            r.motion_mrad[1],
            r.false_torque_nm[0],
            r.false_torque_nm[1],
            r.threshold_nm[0],
            r.threshold_nm[1],
            c.free_s,
            c.false_s,
            c.false_alarms,
            c.contacts,
            c.missed,
            c.delay_median_ms()
        );
    }
    out
}
