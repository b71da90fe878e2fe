//! A proposal as text.

use crate::text::{paragraph, plain, table};
use sinew_estimate::excitation::{BaselineSource, Proposal};
use sinew_figure::rounded;
use sinew_model::Z95;

/// The proposal as text of at most 80 columns.
pub fn render(proposal: &Proposal) -> String {
    let mut text = paragraph(
        &plain(&format!(
            "{}: {} poses, {:.0} s; {} lists tried",
            proposal.robot,
            proposal.poses.len(),
            proposal.duration_s,
            proposal.lists_tried
        )),
        2,
    );
    // As many joints side by side as a terminal holds.
    const SIDE_BY_SIDE: usize = 4;
    for (part, names) in proposal.joints.chunks(SIDE_BY_SIDE).enumerate() {
        let mut head = vec!["pose".to_string(), "move, s".into()];
        head.extend(names.iter().map(|n| format!("{}\nrad", plain(n))));
        let rows = proposal
            .poses
            .iter()
            .enumerate()
            .map(|(k, pose)| {
                let from = part * SIDE_BY_SIDE;
                let mut row = vec![(k + 1).to_string(), format!("{:.2}", pose.move_s)];
                row.extend(
                    pose.pose_rad[from..from + names.len()]
                        .iter()
                        .map(|q| format!("{q:.3}").replace('-', "−")),
                );
                row
            })
            .collect();
        let head: Vec<&str> = head.iter().map(String::as_str).collect();
        text.push_str(&table(&head, rows, 1));
        text.push('\n');
    }
    let rows = proposal
        .expected
        .iter()
        .map(|e| {
            vec![
                plain(&e.name),
                rounded(1e3 * Z95 * e.offset_deviation_rad, 2),
                e.elongation_deviation_m
                    .map_or("–".into(), |m| rounded(1e3 * Z95 * m, 2)),
                rounded(1e3 * Z95 * e.random_offset_deviation_rad, 2),
            ]
        })
        .collect();
    let head = [
        "expected",
        "± (95 %)\nmrad",
        "± (95 %)\nmm",
        "random poses\nmrad",
    ];
    text.push_str(&table(&head, rows, 1));
    text.push('\n');
    let held = if proposal.payload {
        "something unknown"
    } else {
        "nothing"
    };
    text.push_str(&paragraph(
        &plain(&format!(
            "with {held} in the gripper and joint encoders of {} bits; rests on {}",
            proposal.joint_bits,
            source(&proposal.baseline)
        )),
        2,
    ));
    for note in proposal.notes() {
        text.push_str(&paragraph(&plain(&note), 2));
    }
    text
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
