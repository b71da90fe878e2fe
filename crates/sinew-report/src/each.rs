//! Estimates of several recordings, one row per recording and joint.

use crate::data::Data;
use crate::format::{CI_HEAD, CI_LEGEND, plus_minus_cells};
use crate::session::{at_least, change_kind, passed_mm, verdict};
use crate::text::TerminalText;
use crate::uncorrected::{joint_error, nothing_estimated};
use crate::units::{TURNS, name_in_table, of_joint};
use crate::warnings::document_warnings;
use sinew_estimate::replay::JointEstimate;
use sinew_estimate::session::{SessionEstimate, TendonEstimate, Verdict};
use sinew_estimate::{EachDocument, EstimateDocument, Method, RecordingOutcome};
use sinew_figure::{Columns, rounded};
use sinew_log::Table;
use sinew_model::Gaussian;
use std::path::Path;

/// Result of a joint of a recording, or the reason for its absence.
#[derive(Default)]
struct Row<'a> {
    recording: &'a str,
    document: Option<&'a EstimateDocument>,
    /// Whether it is the first row of its recording.
    first: bool,
    joint: Option<&'a str>,
    /// Name in the table, with units if they differ from those of the headings.
    name: String,
    /// Offset; the standard deviation of an uncorrected estimate is NaN.
    offset_rad: Option<Gaussian>,
    elongation_m: Option<Gaussian>,
    strain_ratio: Option<f64>,
    verdict: Option<Verdict>,
    reason: String,
    error: Option<String>,
}

impl<'a> Row<'a> {
    fn of_tendon(session: &SessionEstimate, joint: &'a TendonEstimate) -> Self {
        Self {
            joint: Some(&joint.name),
            name: name_in_table(&joint.name, joint.slides, TURNS),
            offset_rad: Some(joint.offset_rad),
            elongation_m: joint.elongation_m,
            strain_ratio: joint.strain_ratio.map(|strain| strain.mean),
            verdict: Some(joint.verdict),
            reason: reason(session, joint),
            ..Self::default()
        }
    }

    fn of_uncorrected(joint: &'a JointEstimate) -> Self {
        let without_interval = |mean| Gaussian::new(mean, f64::NAN);
        Self {
            joint: Some(&joint.name),
            name: name_in_table(&joint.name, joint.slides, TURNS),
            offset_rad: joint.offset_rad.map(without_interval),
            elongation_m: joint.elongation_m.map(without_interval),
            strain_ratio: joint.strain_ratio,
            reason: joint.reason.map_or(String::new(), joint_error),
            ..Self::default()
        }
    }

    /// Makes one row per joint of an estimated recording.
    fn of_document(recording: &'a str, document: &'a EstimateDocument) -> Vec<Self> {
        let mut rows: Vec<Self> = match &document.session {
            Some(session) => (session.joints.iter())
                .map(|joint| Self::of_tendon(session, joint))
                .collect(),
            None => (document.reading.joints.iter())
                .map(Self::of_uncorrected)
                .collect(),
        };
        for (k, row) in rows.iter_mut().enumerate() {
            (row.recording, row.document, row.first) = (recording, Some(document), k == 0);
        }
        rows
    }

    fn all(each: &'a EachDocument) -> Vec<Self> {
        let mut rows = Vec::new();
        for outcome in &each.recordings {
            let (recording, error) = (outcome.recording.as_str(), failure(outcome));
            match outcome.estimate.as_ref().filter(|_| error.is_none()) {
                Some(document) => rows.extend(Self::of_document(recording, document)),
                None => rows.push(Self {
                    recording,
                    first: true,
                    name: "–".into(),
                    error,
                    ..Self::default()
                }),
            }
        }
        rows
    }

    fn session(&self) -> Option<&'a SessionEstimate> {
        self.document?.session.as_ref()
    }
}

/// Qualifies a verdict in a few words: reason for an inconclusive one, exceeded limit, changes; may be empty.
fn reason(session: &SessionEstimate, joint: &TendonEstimate) -> String {
    let mut out = Vec::new();
    if joint.verdict == Verdict::Inconclusive {
        let unit = of_joint(joint.slides).offset;
        let mrad = |rad: f64| rounded(1e3 * rad, 2);
        let half = mrad(joint.offset_rad.half_width_95());
        let mut unobservable = session.unobservable.iter().flat_map(|u| &u.tendons);
        out.push(if let Some(least) = at_least(joint) {
            format!("slack, elongation at least {least}")
        } else if joint.slack_share.is_some() {
            "partly slack".into()
        } else if unobservable.any(|tendon| tendon.name == joint.name) {
            "not separable".into()
        } else if joint.excess_residual_rad > 0.0 {
            format!(
                "residual {} {unit} unexplained",
                mrad(joint.excess_residual_rad)
            )
        } else {
            format!("interval ± {half} {unit} too wide")
        });
    }
    out.extend(passed_mm(joint).map(|mm| format!("exceeds limit {mm} mm")));
    let changes = joint.changes.iter();
    out.extend(changes.map(|c| format!("{} at {:.0} s", change_kind(c.kind), c.time_s)));
    out.join("; ")
}

/// Returns the reason for which a recording has no estimate, without the name of the recording.
fn failure(outcome: &RecordingOutcome) -> Option<String> {
    let reason = match (&outcome.error, &outcome.estimate) {
        (Some(error), _) => error.clone(),
        (None, Some(document)) if !outcome.is_estimated() => {
            nothing_estimated(&document.reading).unwrap_or_default()
        }
        _ => return None,
    };
    let prefix = format!("{}: ", outcome.recording);
    Some(reason.strip_prefix(&prefix).unwrap_or(&reason).to_owned())
}

/// Tabulates estimates in SI units, one row per recording and joint; a failed recording is one row with its `error`.
///
/// The uncorrected estimate has neither standard deviation nor verdict.
pub fn each_table(each: &EachDocument) -> Table {
    table_of(Row::all(each))
}

/// Tabulates the estimate of one recording as [`each_table`] does.
pub fn estimate_rows(document: &EstimateDocument) -> Table {
    table_of(Row::of_document(&document.reading.recording.path, document))
}

fn table_of(rows: Vec<Row<'_>>) -> Table {
    let mean = |x: Option<Gaussian>| x.map(|x| x.mean);
    let std = |x: Option<Gaussian>| x.map(|x| x.std).filter(|std| std.is_finite());
    let duration_s = |r: &Row<'_>| match r.session() {
        Some(session) => Some(session.duration_s),
        None => Some(r.document?.reading.recording.duration_s),
    };
    let reason = |r: &Row<'_>| Some(r.reason.clone()).filter(|text| !text.is_empty());
    Data::of(rows)
        .text("recording", |r| r.recording)
        .text("joint", |r| r.joint)
        .number("time_utc_s", |r| r.session()?.start_time_utc_s)
        .number("duration_s", duration_s)
        .number("temperature_c", |r| r.session()?.temperature_c)
        .number("offset_rad", |r| mean(r.offset_rad))
        .number("offset_std_rad", |r| std(r.offset_rad))
        .number("elongation_m", |r| mean(r.elongation_m))
        .number("elongation_std_m", |r| std(r.elongation_m))
        .number("strain_ratio", |r| r.strain_ratio)
        .text("verdict", |r| r.verdict.map(Verdict::name))
        .text("reason", reason)
        .text("error", |r| r.error.clone())
        .table()
}

/// The folder that all recordings lie in, where it is one: names are shown without it.
fn folder(each: &EachDocument) -> Option<&Path> {
    let names = each.recordings.iter().map(|r| Path::new(&r.recording));
    let mut folders = names.map(Path::parent);
    let first = folders.next()??;
    folders.all(|other| other == Some(first)).then_some(first)
}

/// Renders the estimates for a terminal, and the reasons for failed recordings.
pub fn each_summary(each: &EachDocument) -> String {
    let folder = folder(each);
    let short = |name: &str| {
        let within = folder.and_then(|folder| Path::new(name).strip_prefix(folder).ok());
        within.map_or(name.into(), |within| within.display().to_string())
    };
    let (offset, last) = match each.method {
        Method::Absolute => ("offset\n(mrad)", "result"),
        Method::Paper => ("uncorrected offset\n(mrad)", "no estimate because"),
    };
    let mut out = TerminalText::default();
    if let Some(folder) = folder.filter(|folder| !folder.as_os_str().is_empty()) {
        out.paragraph(format!("folder {}", folder.display()));
    }
    let rows = Row::all(each);
    let mut robots = rows.iter().filter_map(|r| Some(&r.document?.reading.robot));
    let head = match robots.any(|robot| !robot.joints.is_empty()) {
        true => "tendon",
        false => "joint",
    };
    out.table(
        Columns::of(&rows)
            // The name is shown in the first of its rows only.
            .words("recording", |r| match r.first {
                true => short(r.recording),
                false => String::new(),
            })
            .words(head, |r| &r.name)
            .columns([offset, CI_HEAD], |r| plus_minus_cells(r.offset_rad, 1e3))
            .column("elongation\n(mm)", |r| {
                let [elongation, _] = plus_minus_cells(r.elongation_m, 1e3);
                elongation
            })
            .column(last, |r| match r.verdict {
                _ if r.error.is_some() => "failed".into(),
                Some(v) if r.reason.is_empty() => verdict(v),
                Some(v) => format!("{}: {}", verdict(v), r.reason),
                None => r.reason.clone(),
            })
            .table(),
    );
    if each.method == Method::Absolute {
        out.paragraph(CI_LEGEND);
    }
    out.add("\n");
    for (recording, reason) in rows
        .iter()
        .filter_map(|r| Some((r.recording, r.error.as_ref()?)))
    {
        out.paragraph(format!("{}: {reason}", short(recording)));
    }
    let all = each.recordings.len();
    let estimated = all - each.failed();
    out.paragraph(format!(
        "{estimated} of {all} recordings estimated independently"
    ));
    let documents = rows.iter().filter(|r| r.first).filter_map(|r| r.document);
    let about: Vec<usize> = documents.map(|d| document_warnings(d).len()).collect();
    let (warnings, warned) = (
        about.iter().sum::<usize>(),
        about.iter().filter(|n| **n > 0).count(),
    );
    if warnings > 0 {
        out.paragraph(format!(
            "{warnings} warnings in {warned} recordings; list them with sinew estimate LOG or --json"
        ));
    }
    out.0
}
