//! Estimates and baselines as tables and paragraphs for a terminal.

use super::format::{CI_HEAD, CI_LEGEND, counted, name_head, or_nan, plus_minus_cells};
use super::session::{nuisance_columns, render};
pub use super::session::{provisional_intervals, verdict};
use super::text::TerminalText;
use super::uncorrected::{differences, headline, losses, offsets};
use sinew_estimate::EstimateDocument;
use sinew_estimate::baseline::MergeSummary;
use sinew_estimate::cable::CableBaseline;
use sinew_estimate::replay::{Estimate, JointEstimate};
use sinew_estimate::session::SessionEstimate;
use sinew_figure::{Columns, rounded};
use sinew_log::SignalSource;

/// Renders an estimate: of the session if there is one, else uncorrected.
///
/// * `nuisance`: whether to list the nuisance parameters.
pub fn document(document: &EstimateDocument, nuisance: bool) -> String {
    let e = &document.reading;
    let (name, path, frames) = (&e.robot.name, &e.recording.path, e.recording.frames);
    let [length, rate] =
        [Some(e.recording.duration_s), e.recording.rate_hz].map(|x| rounded(or_nan(x), 4));
    let mut out = TerminalText::default();
    out.paragraph(format!(
        "{name}: {path}, {length} s, {frames} frames at {rate} Hz"
    ));
    match &document.session {
        Some(session) => render(&mut out, session, nuisance, name_head(&e.robot)),
        None => uncorrected(&mut out, e),
    }
    out.0
}

/// Lists the files of the robot description and the source of each quantity.
pub fn sources(e: &Estimate) -> Vec<String> {
    let robot = format!("robot description {}, URDF {}", e.robot.file, e.robot.urdf);
    let sources = e.recording.sources.iter();
    let source = |s: &SignalSource| format!("{} from {}", s.quantity.symbol(), s.source);
    [vec![robot], sources.map(source).collect()].concat()
}

/// Renders the uncorrected estimate.
fn uncorrected(out: &mut TerminalText, e: &Estimate) {
    let elongation = |j: &JointEstimate| rounded(1e3 * or_nan(j.elongation_m), 3);
    out.table(offsets(e, ("elongation\n(mm)", elongation)));
    out.add("\n");
    let changes = differences(e);
    let changed = !changes.rows.is_empty();
    if changed {
        out.table(changes);
        out.add("\n");
    }
    for joint in &e.joints {
        out.paragraph(headline(e, joint));
    }
    out.add("\n");
    for loss in losses(e) {
        out.paragraph(loss);
    }
    out.flat(match changed {
        true => "The change is valid if robot, payload and motion of both recordings were comparable.",
        false => "Uncorrected estimate: errors of stiffness, masses, payload and contact bias it. Use --method absolute for a verdict, --reference LOG2 for the change between two recordings.",
    });
}

/// Renders the summary of a recorded baseline.
///
/// * `joints`: names of the joints of the robot.
pub fn baseline(learned: &SessionEstimate, joints: &[String]) -> String {
    let mut out = TerminalText::default();
    let (recording, poses) = (&learned.recording, learned.poses);
    let (length, percent) = (
        rounded(learned.duration_s, 4),
        100.0 * learned.rejected_share,
    );
    out.paragraph(format!(
        "{recording}: {length} s, {poses} poses, {percent:.0} % rejected as disturbance"
    ));
    let are_joints = learned.joints.iter().all(|j| joints.contains(&j.name));
    let head = if are_joints { "joint" } else { "tendon" };
    let heads = ["stiffness vs. robot.toml\n(%)", CI_HEAD];
    let change = Columns::of(&learned.joints)
        .words(head, |j| &j.name)
        .columns(heads, |j| {
            plus_minus_cells(Some(j.stiffness_change_ratio), 100.0)
        });
    out.table(change.table());
    out.paragraph(CI_LEGEND);
    out.add("\n");
    out.0
}

/// Renders the loads and positions that a baseline contains for tendons with friction along their path.
pub fn cables(cables: &[CableBaseline]) -> String {
    let mut out = TerminalText::default();
    for cable in cables {
        let ([least, most], [low, high]) = (cable.loads_nm(), cable.range_rad());
        let loads = counted(cable.loads.len() as u64, "recording");
        let compliance = match cable.has_two_loads() {
            true => "",
            false => {
                "; one load does not determine the compliance: sessions at other loads are inconclusive; add a recording with at least twice the load"
            }
        };
        out.paragraph(format!(
            "{}: friction along the path from {loads}, {} to {} N·m, {} to {} rad{compliance}",
            cable.joint,
            rounded(least, 3),
            rounded(most, 3),
            rounded(low, 3),
            rounded(high, 3)
        ));
    }
    out.0
}

/// Renders the summary of merged baselines.
pub fn merged(summary: &MergeSummary, files: usize) -> String {
    let moved = || summary.nuisance.iter().filter(|m| m.moved);
    let mut out = TerminalText::default();
    out.paragraph(format!(
        "{}: {files} files, {} recordings; {} of {} parameters updated (interval narrower by at least 20 %, or value changed)",
        summary.robot,
        summary.recordings.len(),
        moved().count(),
        summary.nuisance.len()
    ));
    let heads = [
        "joint or link",
        "parameter",
        "prior\n± 95 %",
        "posterior\n± 95 %",
    ];
    out.table(nuisance_columns(moved(), heads).table());
    out.add("\n");
    out.0
}
