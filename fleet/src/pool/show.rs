//! What robots have in common, for people.

use super::{LeftOut, Pooled};
use crate::known_creep::{CreepKind, KnownCreeps};
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

/// How fast ropes creep, and where that is written.
pub(super) fn creep(known: &KnownCreeps, out: &Path) -> String {
    let any = (known.iter()).filter(|(kind, _)| kind.batch.is_none() && kind.site.is_none());
    let rows = any.map(|(kind, creep)| {
        let its = |other: &&CreepKind| {
            other.batch.is_some() && other.widest() == *kind && other.site.is_none()
        };
        vec![
            plain(&kind.joint),
            plain(kind.rope.as_deref().unwrap_or("–")),
            known.keys().filter(its).count().to_string(),
            creep.tendons.to_string(),
            format!("{:.2}", 1e3 * creep.median_rad),
            format!("{:.2}", creep.spread.exp()),
        ]
    });
    let head = [
        "joint",
        "rope",
        "batches",
        "tendons",
        "mrad per decade",
        "next tendon ×",
    ];
    let mut text = table(&head, rows.collect(), 2);
    text += "\n";
    text += &paragraph(
        "Median of a tendon whose batch isn't among these, from day 1 to day 30 of its rope, and by what factor one differs from the \
         next as a standard deviation. Those of known batches and sites are in the file, too.",
        2,
    );
    text + &paragraph(
        &plain(&format!(
            "written to {}; sinew-fleet due --creep takes it",
            out.display()
        )),
        2,
    )
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
