//! Every recording of a run as rows.

use super::Recording;
use sinew_log::{CellKind, Table};

/// One row per recording and joint. Errors are estimate minus truth at the end of session B.
pub fn rows(recordings: &[Recording]) -> Table {
    let mut table = Table::new(&[
        ("scenario", CellKind::Text),
        ("seed", CellKind::Integer),
        ("joint", CellKind::Text),
        ("truth_rad", CellKind::Number),
        ("error_rad", CellKind::Number),
        ("stated_std_rad", CellKind::Number),
        ("is_conclusive", CellKind::Flag),
        ("bound_rad", CellKind::Number),
        ("paper_error_rad", CellKind::Number),
        ("paper_minus_baseline_error_rad", CellKind::Number),
        ("matched_error_rad", CellKind::Number),
        ("matched_minus_baseline_error_rad", CellKind::Number),
        ("payload_error_kg", CellKind::Number),
        ("rejected_share", CellKind::Number),
        ("poses", CellKind::Integer),
    ]);
    for r in recordings {
        for joint in &r.joints {
            table.push(vec![
                r.scenario.as_str().into(),
                i64::try_from(r.seed).ok().into(),
                joint.name.as_str().into(),
                joint.truth_rad.into(),
                joint.error_rad.mean.into(),
                joint.error_rad.std.into(),
                joint.is_conclusive.into(),
                joint.bound_rad.into(),
                joint.paper_error_rad.into(),
                joint.paper_minus_baseline_error_rad.into(),
                joint.matched_error_rad.into(),
                joint.matched_minus_baseline_error_rad.into(),
                r.payload_error_kg.mean.into(),
                r.rejected_share.into(),
                r.poses.into(),
            ]);
        }
    }
    table
}
