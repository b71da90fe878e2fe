//! What a terminal of 80 columns shows of an estimate: tables and paragraphs.

use super::reading::{differences, headline, losses, readings};
pub use super::session::{doubts, verdict};
use super::session::{estimated_along, told};
use super::text::Told;
use super::words::{or_nan, plus_minus_cells};
use sinew_estimate::EstimateDocument;
use sinew_estimate::baseline::MergeSummary;
use sinew_estimate::replay::{Estimate, JointEstimate};
use sinew_estimate::session::SessionEstimate;
use sinew_figure::{Columns, rounded};
use sinew_log::SignalSource;

/// One answer: the session's, with everything estimated along where `nuisance` asks for it, or the
/// paper's reading.
pub fn document(document: &EstimateDocument, nuisance: bool) -> String {
    let e = &document.reading;
    let (name, path, frames) = (&e.robot.name, &e.recording.path, e.recording.frames);
    let [length, rate] =
        [Some(e.recording.duration_s), e.recording.rate_hz].map(|x| rounded(or_nan(x), 4));
    let mut out = Told::default();
    out.say(format!(
        "{name}: {path}, {length} s, {frames} frames at {rate} Hz"
    ));
    match &document.session {
        Some(answer) => told(&mut out, answer, nuisance),
        None => reading(&mut out, e),
    }
    out.0
}

/// Where everything was taken from, a line each.
pub fn taken(e: &Estimate) -> Vec<String> {
    let robot = format!("robot from {}, URDF from {}", e.robot.file, e.robot.urdf);
    let sources = e.recording.sources.iter();
    let source = |s: &SignalSource| format!("{} from {}", s.quantity.symbol(), s.source);
    [vec![robot], sources.map(source).collect()].concat()
}

/// The paper's reading.
fn reading(out: &mut Told, e: &Estimate) {
    let stretch = |j: &JointEstimate| rounded(1e3 * or_nan(j.elongation_m), 3);
    out.table(readings(e, ("stretch\nmm", stretch)));
    out.add("\n");
    let changes = differences(e);
    let changed = !changes.rows.is_empty();
    if changed {
        out.table(changes);
        out.add("\n");
    }
    for joint in &e.joints {
        out.say(headline(e, joint));
    }
    out.add("\n");
    for loss in losses(e) {
        out.say(loss);
    }
    out.flat(match changed {
        true => "The change is right as far as robot, payload and motion were alike.",
        false => "A reading takes stiffness, masses, payload and contact as known: it is no verdict. --method absolute gives one, --reference LOG2 shows what changed.",
    });
}

/// What a recording right after tensioning taught.
pub fn baseline(learned: &SessionEstimate) -> String {
    let mut out = Told::default();
    let (recording, poses) = (&learned.recording, learned.poses);
    let (length, percent) = (
        rounded(learned.duration_s, 4),
        100.0 * learned.left_out_share,
    );
    out.say(format!(
        "{recording}: {length} s, {poses} poses, {percent:.0} % left out as disturbed"
    ));
    let heads = ["stiffness against robot.toml\n%", "± (95 %)\n%"];
    let change = Columns::of(&learned.joints)
        .words("joint", |j| &j.name)
        .columns(heads, |j| {
            plus_minus_cells(Some(j.stiffness_change_ratio), 100.0)
        });
    out.table(change.table());
    out.add("\n");
    out.0
}

/// What several baselines taught together.
pub fn merged(summary: &MergeSummary, files: usize) -> String {
    let moved = || summary.nuisance.iter().filter(|m| m.moved);
    let mut out = Told::default();
    out.say(format!(
        "{}: {files} files, {} recordings; {} of {} parameters are surer by a fifth or have moved",
        summary.robot,
        summary.recordings.len(),
        moved().count(),
        summary.nuisance.len()
    ));
    let heads = [
        "joint or link",
        "parameter",
        "at the start\n± 95 %",
        "now\n± 95 %",
    ];
    out.table(estimated_along(moved(), heads).table());
    out.add("\n");
    out.0
}
