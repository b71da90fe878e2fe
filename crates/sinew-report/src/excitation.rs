//! Proposed exciting motion as text.

use crate::text::{TerminalText, or_dash, plain};
use sinew_estimate::excitation::{BaselineSource, Proposal};
use sinew_figure::{Columns, rounded};
use sinew_model::Z95;

/// Renders a proposal as text of at most 80 columns.
pub fn render(proposal: &Proposal) -> String {
    let mut out = TerminalText::default();
    let (robot, poses, lists) = (&proposal.robot, proposal.poses.len(), proposal.lists_tried);
    let length = proposal.duration_s;
    out.paragraph(format!(
        "{robot}: {poses} poses, {length:.0} s; {lists} pose lists evaluated"
    ));
    /// Maximum number of joints side by side, so that a table fits 80 columns.
    const MAX_JOINTS: usize = 4;
    let joints: Vec<(usize, &String)> = proposal.joints.iter().enumerate().collect();
    for part in joints.chunks(MAX_JOINTS) {
        let mut table = Columns::of(proposal.poses.iter().zip(1..))
            .words("pose", |(_, number): &(_, usize)| *number)
            .column("motion\n(s)", |(pose, _)| format!("{:.2}", pose.move_s));
        for (joint, name) in part {
            table = table.column(format!("{}\n(rad)", plain(name)), |(pose, _)| {
                format!("{:.3}", pose.pose_rad[*joint]).replace('-', "−")
            });
        }
        out.table(table.table());
        out.add("\n");
    }
    let wide = |std: f64| rounded(1e3 * Z95 * std, 2);
    out.table(
        Columns::of(&proposal.expected)
            .words("expected 95 % CI", |e| &e.name)
            .column("offset\n(± mrad)", |e| wide(e.offset_std_rad))
            .column("elongation\n(± mm)", |e| or_dash(e.elongation_std_m, wide))
            .column("random poses\n(± mrad)", |e| wide(e.random_offset_std_rad))
            .table(),
    );
    out.add("\n");
    let held = match proposal.payload {
        true => "unknown payload",
        false => "empty gripper",
    };
    let (bits, source) = (proposal.joint_bits, source(&proposal.baseline));
    out.paragraph(format!(
        "assumes {held}, joint encoders of {bits} bits, and {source}"
    ));
    for note in proposal.notes() {
        out.paragraph(note);
    }
    out.0
}

fn source(baseline: &BaselineSource) -> String {
    match baseline {
        BaselineSource::Given { file, recordings } => {
            format!("the baseline {file}, recorded as {}", recordings.join(", "))
        }
        BaselineSource::Assumed { poses, duration_s } => format!(
            "a future baseline of {poses} random poses directly after tensioning, {duration_s:.0} s"
        ),
    }
}
