//! What robots have in common, for people.

use super::{LeftOut, Pooled};
use sinew_files::plain;
use sinew_model::offset::alike::{Alike, Kind};
use sinew_report::tables;
use sinew_report::text::{paragraph, table};
use std::path::Path;

fn name(kind: Kind) -> &'static str {
    match kind {
        Kind::Bodies => "masses and inertias",
        Kind::Stiffness => "stiffness",
        Kind::Friction => "friction of joints",
        Kind::DriveFriction => "friction of drives",
        Kind::MotorTorque => "motor torque",
        Kind::Encoders => "encoders and gears",
        Kind::Drift => "drift with temperature",
        Kind::Viscoelasticity => "viscoelasticity",
    }
}

/// What became surer, and how alike robots are.
pub(super) fn text(pooled: &Pooled, out: &Path) -> String {
    let row = |a: &Alike| vec![name(a.kind).into(), format!("{:.0}", 100.0 * a.ratio)];
    let rows = pooled.alike.iter().map(row).collect();
    let mut text = tables::merged(&pooled.summary, pooled.robots);
    text += &table(&["of one robot", "of its tolerance, %"], rows, 1);
    text += "\n";
    text += &paragraph(
        "The second column says what one robot differs from the next by; the rest of the tolerance is the type's, and known \
         now as far as these robots tell. At 100 a robot says nothing of another.",
        2,
    );
    text + &paragraph(&plain(&format!("written to {}", out.display())), 2)
}

/// Why a file was left out.
pub(super) fn left_out(path: &Path, why: &LeftOut) -> String {
    let why = match why {
        LeftOut::Unreadable(why) => return plain(&format!("refused: {why}")),
        LeftOut::OtherType(name) => format!("is of robot '{name}'"),
        LeftOut::GoesOn(recordings) => format!(
            "rests on {recordings} recordings: one right after tensioning is needed, the first of its chain"
        ),
    };
    plain(&format!("left out: {}: {why}", path.display()))
}
