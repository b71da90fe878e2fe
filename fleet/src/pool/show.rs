//! Output of `pool`.

use super::{Excluded, Pooled};
use crate::reference_creep::{CreepKind, ReferenceCreeps};
use sinew_files::plain;
use sinew_model::offset::shared_parameters::{Kind, SharedParameters};
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

/// Formats the change of the uncertainties and the similarity of robots.
pub(super) fn text(pooled: &Pooled, out: &Path) -> String {
    let row = |a: &SharedParameters| vec![name(a.kind).into(), format!("{:.0}", 100.0 * a.ratio)];
    let rows = pooled.similarity.iter().map(row).collect();
    let mut text = tables::merged(&pooled.summary, pooled.robots);
    text += &table(
        &["parameter", "differs between robots (% of tolerance)"],
        rows,
        1,
    );
    text += "\n";
    text += &paragraph(
        "The second column is the standard deviation between robots; the remainder of the tolerance is common to the type and \
         is now estimated. At 100 % one robot provides no information about another.",
        2,
    );
    text + &paragraph(&plain(&format!("written to {}", out.display())), 2)
}

/// Formats the creep of ropes and the output path.
pub(super) fn creep(references: &ReferenceCreeps, out: &Path) -> String {
    let any = (references.iter()).filter(|(kind, _)| kind.batch.is_none() && kind.site.is_none());
    let rows = any.map(|(kind, creep)| {
        let its = |other: &&CreepKind| {
            other.batch.is_some() && other.widest() == *kind && other.site.is_none()
        };
        vec![
            plain(&kind.joint),
            plain(kind.rope.as_deref().unwrap_or("–")),
            references.keys().filter(its).count().to_string(),
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
        "creep (mrad per decade)",
        "factor between tendons",
    ];
    let mut text = table(&head, rows.collect(), 2);
    text += "\n";
    text += &paragraph(
        "Median of a tendon of another batch, from day 1 to day 30 of its rope, and the factor between tendons (one standard \
         deviation). The file also contains the values of the batches and sites.",
        2,
    );
    text + &paragraph(
        &plain(&format!(
            "written to {}; use it with sinew-fleet due --creep",
            out.display()
        )),
        2,
    )
}

/// Formats the reason for the exclusion of a file.
pub(super) fn excluded(path: &Path, reason: &Excluded) -> String {
    let reason = match reason {
        Excluded::Unreadable(reason) => return plain(&format!("rejected: {reason}")),
        Excluded::OtherType(name) => format!("baseline of robot '{name}'"),
        Excluded::Chained(recordings) => format!(
            "based on {recordings} recordings; expected the first of its chain, one recording right after tensioning"
        ),
    };
    plain(&format!("excluded: {}: {reason}", path.display()))
}
