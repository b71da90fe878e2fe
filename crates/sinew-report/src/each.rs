//! Many recordings, a row per recording and joint.

use crate::session_sentences::change_kind;
use crate::tables::verdict;
use crate::text::{paragraph, plain, table};
use crate::units::{Moves, TURNS, name_in_table};
use crate::warnings::document_warnings;
use crate::words::{joint_refusal, nothing_estimated, plus_minus_cells};
use sinew_estimate::replay::JointEstimate;
use sinew_estimate::session::{LimitState, SessionEstimate, TendonEstimate, Verdict};
use sinew_estimate::{EachDocument, EstimateDocument, Method, RecordingOutcome};
use sinew_figure::rounded;
use sinew_log::{Cell, CellKind, Table};
use sinew_model::Gaussian;
use std::path::Path;

/// What a row says besides its recording.
struct Row<'a> {
    joint: &'a str,
    /// As the table has it, with its units where they aren't those of the heads.
    name: String,
    /// A reading has no deviation: it is NaN.
    offset_rad: Option<Gaussian>,
    elongation_m: Option<Gaussian>,
    strain_ratio: Option<f64>,
    verdict: Option<Verdict>,
    reason: String,
}

impl<'a> Row<'a> {
    fn of_tendon(joint: &'a TendonEstimate) -> Self {
        Self {
            joint: &joint.name,
            name: name_in_table(joint, TURNS),
            offset_rad: Some(joint.offset_rad),
            elongation_m: joint.elongation_m,
            strain_ratio: joint.strain_ratio.map(|strain| strain.mean),
            verdict: Some(joint.verdict),
            reason: reason(joint),
        }
    }

    fn of_reading(joint: &'a JointEstimate) -> Self {
        let without_interval = |mean| Gaussian::new(mean, f64::NAN);
        Self {
            joint: &joint.name,
            name: name_in_table(joint, TURNS),
            offset_rad: joint.offset_rad.map(without_interval),
            elongation_m: joint.elongation_m.map(without_interval),
            strain_ratio: joint.strain_ratio,
            verdict: None,
            reason: joint.refused.map_or(String::new(), joint_refusal),
        }
    }

    fn all(document: &'a EstimateDocument) -> Vec<Self> {
        match &document.session {
            Some(SessionEstimate { joints, .. }) => joints.iter().map(Self::of_tendon).collect(),
            None => (document.reading.joints.iter())
                .map(Self::of_reading)
                .collect(),
        }
    }
}

/// What else there is to a verdict, in a few words; empty: nothing.
fn reason(joint: &TendonEstimate) -> String {
    let mut out = Vec::new();
    if joint.verdict == Verdict::CannotTell {
        let unit = joint.units().offset;
        let mrad = |rad: f64| rounded(1e3 * rad, 2);
        out.push(match joint.misfit_rad > 0.0 {
            true => format!("{} {unit} fit nothing", mrad(joint.misfit_rad)),
            false => format!(
                "± {} {unit} is too wide",
                mrad(joint.offset_rad.half_width_95())
            ),
        });
    }
    let passed = joint.retension.filter(|r| r.state == LimitState::Passed);
    out.extend(passed.map(|limit| format!("past {} mm", rounded(1e3 * limit.elongation_m, 2))));
    let changes = joint.changes.iter();
    out.extend(changes.map(|c| format!("{} at {:.0} s", change_kind(c.kind), c.time_s)));
    out.join("; ")
}

/// Why a recording has no estimate, without its name.
fn failure(outcome: &RecordingOutcome) -> Option<String> {
    let why = match (&outcome.error, &outcome.estimate) {
        (Some(error), _) => error.clone(),
        (None, Some(document)) if !outcome.is_estimated() => {
            nothing_estimated(&document.reading).unwrap_or_default()
        }
        _ => return None,
    };
    let prefix = format!("{}: ", outcome.recording);
    Some(why.strip_prefix(&prefix).unwrap_or(&why).to_owned())
}

/// Columns of a row per recording and joint.
const COLUMNS: [(&str, CellKind); 13] = [
    ("recording", CellKind::Text),
    ("joint", CellKind::Text),
    ("time_utc_s", CellKind::Number),
    ("duration_s", CellKind::Number),
    ("temperature_c", CellKind::Number),
    ("offset_rad", CellKind::Number),
    ("offset_interval_95_rad", CellKind::Number),
    ("elongation_m", CellKind::Number),
    ("elongation_interval_95_m", CellKind::Number),
    ("strain_ratio", CellKind::Number),
    ("verdict", CellKind::Text),
    ("reason", CellKind::Text),
    ("error", CellKind::Text),
];

/// A row per recording and joint, in SI; a recording that couldn't be estimated is one row with its `error`.
///
/// Intervals are half a 95 % interval; the paper's reading has none, and no verdict.
pub fn each_table(each: &EachDocument) -> Table {
    let mut out = Table::new(&COLUMNS);
    for outcome in &each.recordings {
        let failed = failure(outcome);
        match outcome.estimate.as_ref().filter(|_| failed.is_none()) {
            Some(document) => push_rows(&mut out, &outcome.recording, document),
            None => {
                let mut row: Vec<Cell> = vec![outcome.recording.as_str().into()];
                row.resize(COLUMNS.len() - 1, Cell::Empty);
                row.push(failed.into());
                out.push(row);
            }
        }
    }
    out
}

/// A row per joint of one recording, as in [`each_table`].
pub fn estimate_rows(document: &EstimateDocument) -> Table {
    let mut out = Table::new(&COLUMNS);
    push_rows(&mut out, &document.reading.recording.path, document);
    out
}

fn push_rows(out: &mut Table, recording: &str, document: &EstimateDocument) {
    let session = document.session.as_ref();
    let duration_s = document.reading.recording.duration_s;
    let mean = |x: Option<Gaussian>| x.map(|x| x.mean);
    let half = |x: Option<Gaussian>| x.map(Gaussian::half_width_95).filter(|h| h.is_finite());
    for row in Row::all(document) {
        out.push(vec![
            recording.into(),
            row.joint.into(),
            session.and_then(|s| s.start_time_utc_s).into(),
            session.map_or(duration_s, |s| s.duration_s).into(),
            session.and_then(|s| s.temperature_c).into(),
            mean(row.offset_rad).into(),
            half(row.offset_rad).into(),
            mean(row.elongation_m).into(),
            half(row.elongation_m).into(),
            row.strain_ratio.into(),
            row.verdict.map(verdict).into(),
            Some(row.reason).filter(|text| !text.is_empty()).into(),
            Cell::Empty,
        ]);
    }
}

/// The folder that all recordings lie in, where it is one: names are shown without it.
fn folder(each: &EachDocument) -> Option<&Path> {
    let names = each.recordings.iter().map(|r| Path::new(&r.recording));
    let mut folders = names.map(Path::parent);
    let first = folders.next()??;
    folders.all(|other| other == Some(first)).then_some(first)
}

/// The same for a terminal, and why recordings couldn't be estimated.
pub fn each_summary(each: &EachDocument) -> String {
    let said = |text: &str| paragraph(&plain(text), 2);
    let folder = folder(each);
    let short = |name: &str| {
        let within = folder.and_then(|folder| Path::new(name).strip_prefix(folder).ok());
        plain(&within.map_or(name.into(), |within| within.display().to_string()))
    };
    let mut rows = Vec::new();
    let mut failures = Vec::new();
    let (mut warnings, mut warned) = (0, 0);
    for outcome in &each.recordings {
        let name = short(&outcome.recording);
        if let Some(why) = failure(outcome) {
            failures.push(said(&format!("{name}: {why}")));
            let nothing = std::iter::repeat_n("–".to_owned(), 4);
            rows.push([vec![name], nothing.collect(), vec!["failed".into()]].concat());
            continue;
        }
        let Some(document) = &outcome.estimate else {
            continue;
        };
        let about = document_warnings(document).len();
        (warnings, warned) = (warnings + about, warned + usize::from(about > 0));
        for (k, row) in Row::all(document).into_iter().enumerate() {
            let last = match row.verdict {
                Some(v) if row.reason.is_empty() => verdict(v).to_owned(),
                Some(v) => format!("{}: {}", verdict(v), row.reason),
                None => row.reason,
            };
            let [offset, half] = plus_minus_cells(row.offset_rad, 1e3);
            let [elongation, _] = plus_minus_cells(row.elongation_m, 1e3);
            rows.push(vec![
                // The name once: its rows stand below it.
                if k == 0 { name.clone() } else { String::new() },
                plain(&row.name),
                offset,
                half,
                elongation,
                plain(&last),
            ]);
        }
    }
    let (offset, last) = match each.method {
        Method::Absolute => ("offset\nmrad", "verdict"),
        Method::Paper => ("reading\nmrad", "why not"),
    };
    let head = [
        "recording",
        "joint",
        offset,
        "± (95 %)\nmrad",
        "stretch\nmm",
        last,
    ];
    let within = folder.filter(|folder| !folder.as_os_str().is_empty());
    let mut out = within.map_or(String::new(), |f| said(&format!("in {}", f.display())));
    out += &table(&head, rows, 2);
    out += "\n";
    out += &failures.concat();
    let all = each.recordings.len();
    let estimated = all - each.failed();
    out += &said(&format!(
        "{estimated} of {all} recordings estimated, each on its own"
    ));
    if warnings > 0 {
        out += &said(&format!(
            "{warnings} warnings about {warned} of them; sinew estimate of one recording shows them, --json has all"
        ));
    }
    out
}
