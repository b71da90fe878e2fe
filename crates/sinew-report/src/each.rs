//! Many recordings, a row per recording and joint.

use crate::data::Data;
use crate::session::{change_kind, passed_mm, verdict};
use crate::text::Told;
use crate::units::{TURNS, name_in_table, of_joint};
use crate::warnings::document_warnings;
use crate::words::{joint_refusal, nothing_estimated, plus_minus_cells};
use sinew_estimate::replay::JointEstimate;
use sinew_estimate::session::{SessionEstimate, TendonEstimate, Verdict};
use sinew_estimate::{EachDocument, EstimateDocument, Method, RecordingOutcome};
use sinew_figure::{Columns, rounded};
use sinew_log::Table;
use sinew_model::Gaussian;
use std::path::Path;

/// A joint of a recording, or why there is none.
#[derive(Default)]
struct Row<'a> {
    recording: &'a str,
    document: Option<&'a EstimateDocument>,
    /// Of a recording the first row.
    first: bool,
    joint: Option<&'a str>,
    /// As the table has it, with its units where they aren't those of the heads.
    name: String,
    /// A reading has no deviation: it is NaN.
    offset_rad: Option<Gaussian>,
    elongation_m: Option<Gaussian>,
    strain_ratio: Option<f64>,
    verdict: Option<Verdict>,
    reason: String,
    error: Option<String>,
}

impl<'a> Row<'a> {
    fn of_tendon(joint: &'a TendonEstimate) -> Self {
        Self {
            joint: Some(&joint.name),
            name: name_in_table(&joint.name, joint.slides, TURNS),
            offset_rad: Some(joint.offset_rad),
            elongation_m: joint.elongation_m,
            strain_ratio: joint.strain_ratio.map(|strain| strain.mean),
            verdict: Some(joint.verdict),
            reason: reason(joint),
            ..Self::default()
        }
    }

    fn of_reading(joint: &'a JointEstimate) -> Self {
        let without_interval = |mean| Gaussian::new(mean, f64::NAN);
        Self {
            joint: Some(&joint.name),
            name: name_in_table(&joint.name, joint.slides, TURNS),
            offset_rad: joint.offset_rad.map(without_interval),
            elongation_m: joint.elongation_m.map(without_interval),
            strain_ratio: joint.strain_ratio,
            reason: joint.refused.map_or(String::new(), joint_refusal),
            ..Self::default()
        }
    }

    /// A recording that was estimated, a row a joint.
    fn of_document(recording: &'a str, document: &'a EstimateDocument) -> Vec<Self> {
        let mut rows: Vec<Self> = match &document.session {
            Some(session) => session.joints.iter().map(Self::of_tendon).collect(),
            None => (document.reading.joints.iter())
                .map(Self::of_reading)
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

/// What else there is to a verdict, in a few words; empty: nothing.
fn reason(joint: &TendonEstimate) -> String {
    let mut out = Vec::new();
    if joint.verdict == Verdict::CannotTell {
        let unit = of_joint(joint.slides).offset;
        let mrad = |rad: f64| rounded(1e3 * rad, 2);
        let half = mrad(joint.offset_rad.half_width_95());
        out.push(match joint.misfit_rad > 0.0 {
            true => format!("{} {unit} fit nothing", mrad(joint.misfit_rad)),
            false => format!("± {half} {unit} is too wide"),
        });
    }
    out.extend(passed_mm(joint).map(|mm| format!("past {mm} mm")));
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

/// A row per recording and joint, in SI; a recording that couldn't be estimated is one row with its `error`.
///
/// Intervals are half a 95 % interval; the paper's reading has none, and no verdict.
pub fn each_table(each: &EachDocument) -> Table {
    table_of(Row::all(each))
}

/// A row per joint of one recording, as in [`each_table`].
pub fn estimate_rows(document: &EstimateDocument) -> Table {
    table_of(Row::of_document(&document.reading.recording.path, document))
}

fn table_of(rows: Vec<Row<'_>>) -> Table {
    let mean = |x: Option<Gaussian>| x.map(|x| x.mean);
    let half = |x: Option<Gaussian>| x.map(Gaussian::half_width_95).filter(|h| h.is_finite());
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
        .number("offset_interval_95_rad", |r| half(r.offset_rad))
        .number("elongation_m", |r| mean(r.elongation_m))
        .number("elongation_interval_95_m", |r| half(r.elongation_m))
        .number("strain_ratio", |r| r.strain_ratio)
        .text("verdict", |r| r.verdict.map(verdict))
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

/// The same for a terminal, and why recordings couldn't be estimated.
pub fn each_summary(each: &EachDocument) -> String {
    let folder = folder(each);
    let short = |name: &str| {
        let within = folder.and_then(|folder| Path::new(name).strip_prefix(folder).ok());
        within.map_or(name.into(), |within| within.display().to_string())
    };
    let (offset, last) = match each.method {
        Method::Absolute => ("offset\nmrad", "verdict"),
        Method::Paper => ("reading\nmrad", "why not"),
    };
    let mut out = Told::default();
    if let Some(folder) = folder.filter(|folder| !folder.as_os_str().is_empty()) {
        out.say(format!("in {}", folder.display()));
    }
    let rows = Row::all(each);
    out.table(
        Columns::of(&rows)
            // The name once: its rows stand below it.
            .words("recording", |r| match r.first {
                true => short(r.recording),
                false => String::new(),
            })
            .words("joint", |r| &r.name)
            .columns([offset, "± (95 %)\nmrad"], |r| {
                plus_minus_cells(r.offset_rad, 1e3)
            })
            .column("stretch\nmm", |r| {
                let [elongation, _] = plus_minus_cells(r.elongation_m, 1e3);
                elongation
            })
            .column(last, |r| match r.verdict {
                _ if r.error.is_some() => "failed".into(),
                Some(v) if r.reason.is_empty() => verdict(v).to_owned(),
                Some(v) => format!("{}: {}", verdict(v), r.reason),
                None => r.reason.clone(),
            })
            .table(),
    );
    out.add("\n");
    for (recording, why) in rows
        .iter()
        .filter_map(|r| Some((r.recording, r.error.as_ref()?)))
    {
        out.say(format!("{}: {why}", short(recording)));
    }
    let all = each.recordings.len();
    let estimated = all - each.failed();
    out.say(format!(
        "{estimated} of {all} recordings estimated, each on its own"
    ));
    let documents = rows.iter().filter(|r| r.first).filter_map(|r| r.document);
    let about: Vec<usize> = documents.map(|d| document_warnings(d).len()).collect();
    let (warnings, warned) = (
        about.iter().sum::<usize>(),
        about.iter().filter(|n| **n > 0).count(),
    );
    if warnings > 0 {
        out.say(format!(
            "{warnings} warnings about {warned} of them; sinew estimate of one recording shows them, --json has all"
        ));
    }
    out.0
}
