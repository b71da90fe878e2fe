//! The table, as text, on the page and as CSV.

use super::super::row::{Range, Row, RowJoint};
use sinew_figure::Table;
use sinew_model::Gaussian;
use std::fmt::Write as _;

/// Headings of [`table`]; the last line contains the units.
const HEAD: [&str; 9] = [
    "robot",
    "correction",
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
                r.robot.name().into(),
                r.knowledge.name().into(),
                number(r.rest_mrad(0), 1),
                number(r.rest_mrad(1), 1),
                number(r.overall_mrad(0), 1),
                number(r.joints[0].false_torque_nm, 2),
                number(r.false_percent(), 1),
                number(r.missed_percent(), 0),
                number(r.delay_median_ms(), 0),
            ]
        })
        .collect();
    (HEAD.to_vec(), cells)
}

/// Formats a value with this number of decimals, without a minus before zeros; a dash for a missing value.
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

/// The table of the page: with spreads, thresholds and rates.
pub(super) fn full_table(rows: &[Row], seeds: u64) -> Table {
    let head = [
        "robot",
        "correction",
        "at rest, mrad",
        "overall, mrad",
        "false torque, N·m",
        "threshold, N·m",
        "false alarm, % of contact-free time",
        "false alarms per min",
        "missed, %",
        "delay, ms",
    ];
    let contacts = rows.first().map_or(0, |r| r.contacts.contacts);
    let spread = |r: &Row, of: fn(&RowJoint) -> Gaussian| {
        let [a, b] = [0, 1].map(|i| {
            let g = of(&r.joints[i]);
            format!("{:.1} (σ {:.1})", 1e3 * g.mean, 1e3 * g.std)
        });
        format!("{a}; {b}")
    };
    let pair = |r: &Row, of: fn(&RowJoint) -> f64| {
        let [a, b] = [0, 1].map(|i| number(of(&r.joints[i]), 2));
        format!("{a}; {b}")
    };
    let range = |share: f64, r: &Range, decimals: usize| {
        let percent = |share: f64| format!("{:.decimals$}", 100.0 * share);
        let (low, high) = (percent(r.lowest), percent(r.highest));
        format!("{} ({low}–{high})", percent(share))
    };
    Table::new(&head, rows
            .iter()
            .map(|r| {
                let c = &r.contacts;
                vec![
                    r.robot.name().into(),
                    r.knowledge.name().into(),
                    spread(r, |j| j.rest_rad),
                    spread(r, |j| j.overall_rad),
                    pair(r, |j| j.false_torque_nm),
                    pair(r, |j| j.threshold_nm),
                    range(c.false_share(), &r.false_share, 1),
                    number(c.false_per_minute(), 1),
                    range(c.missed_share(), &r.missed_share, 0),
                    number(r.delay_median_ms(), 0),
                ]
            })).worded(&["correction"]).captioned(format!(
            "Before and after correction. Two numbers in a cell: shoulder pitch; elbow. RMS of q − q_d; σ: standard deviation over {seeds} sessions; {contacts} contacts in each row; brackets: lowest and highest session."
        ))
}

/// The rows as CSV.
pub(in super::super) fn csv(rows: &[Row]) -> String {
    let mut out = String::from(
        "robot,known,rest_shoulder_pitch_mrad,rest_shoulder_pitch_spread_mrad,rest_elbow_mrad,rest_elbow_spread_mrad,overall_shoulder_pitch_mrad,overall_elbow_mrad,false_torque_shoulder_pitch_nm,false_torque_elbow_nm,threshold_shoulder_pitch_nm,threshold_elbow_nm,free_s,false_s,false_alarms,contacts,missed,delay_median_ms\n",
    );
    for r in rows {
        let c = &r.contacts;
        let _ = writeln!(
            out,
            "{},\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            r.robot.name(),
            r.knowledge.name(),
            r.rest_mrad(0),
            1e3 * r.joints[0].rest_rad.std,
            r.rest_mrad(1),
            1e3 * r.joints[1].rest_rad.std,
            r.overall_mrad(0),
            r.overall_mrad(1),
            r.joints[0].false_torque_nm,
            r.joints[1].false_torque_nm,
            r.joints[0].threshold_nm,
            r.joints[1].threshold_nm,
            c.free_s,
            c.false_s,
            c.false_alarms,
            c.contacts,
            c.missed,
            r.delay_median_ms()
        );
    }
    out
}
