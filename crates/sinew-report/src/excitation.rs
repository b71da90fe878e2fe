//! A proposal as text.

use crate::text::{Told, or_dash, plain};
use sinew_estimate::excitation::{BaselineSource, Proposal};
use sinew_figure::{Columns, rounded};
use sinew_model::Z95;

/// The proposal as text of at most 80 columns.
pub fn render(proposal: &Proposal) -> String {
    let mut out = Told::default();
    let (robot, poses, lists) = (&proposal.robot, proposal.poses.len(), proposal.lists_tried);
    let length = proposal.duration_s;
    out.say(format!(
        "{robot}: {poses} poses, {length:.0} s; {lists} lists tried"
    ));
    // As many joints side by side as a terminal holds.
    const SIDE_BY_SIDE: usize = 4;
    let joints: Vec<(usize, &String)> = proposal.joints.iter().enumerate().collect();
    for part in joints.chunks(SIDE_BY_SIDE) {
        let mut table = Columns::of(proposal.poses.iter().zip(1..))
            .words("pose", |(_, number): &(_, usize)| *number)
            .column("move, s", |(pose, _)| format!("{:.2}", pose.move_s));
        for (joint, name) in part {
            table = table.column(format!("{}\nrad", plain(name)), |(pose, _)| {
                format!("{:.3}", pose.pose_rad[*joint]).replace('-', "−")
            });
        }
        out.table(table.table());
        out.add("\n");
    }
    let wide = |deviation: f64| rounded(1e3 * Z95 * deviation, 2);
    out.table(
        Columns::of(&proposal.expected)
            .words("expected", |e| &e.name)
            .column("± (95 %)\nmrad", |e| wide(e.offset_deviation_rad))
            .column("± (95 %)\nmm", |e| or_dash(e.elongation_deviation_m, wide))
            .column("random poses\nmrad", |e| {
                wide(e.random_offset_deviation_rad)
            })
            .table(),
    );
    out.add("\n");
    let held = match proposal.payload {
        true => "something unknown",
        false => "nothing",
    };
    let (bits, source) = (proposal.joint_bits, source(&proposal.baseline));
    out.say(format!(
        "with {held} in the gripper and joint encoders of {bits} bits; rests on {source}"
    ));
    for note in proposal.notes() {
        out.say(note);
    }
    out.0
}

fn source(baseline: &BaselineSource) -> String {
    match baseline {
        BaselineSource::Given { file, recordings } => {
            format!("the baseline {file}, recorded as {}", recordings.join(", "))
        }
        BaselineSource::Assumed { poses, duration_s } => format!(
            "a baseline of {poses} random poses right after tensioning, {duration_s:.0} s, not recorded yet"
        ),
    }
}
