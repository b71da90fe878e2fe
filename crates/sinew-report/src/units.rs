//! Display units of revolute joints (mrad, N·m) and prismatic joints (mm, N).

use sinew_figure::Table;

/// Display units of the quantities of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Units {
    /// Unit of an offset, a thousandth of the SI unit.
    pub(crate) offset: &'static str,
    /// Unit of a position.
    pub(crate) position: &'static str,
    /// Unit of a torque or force.
    pub(crate) torque: &'static str,
    /// Unit of a stiffness.
    pub(crate) stiffness: &'static str,
}

/// Units of a revolute joint.
pub(crate) const TURNS: Units = Units {
    offset: "mrad",
    position: "rad",
    torque: "N·m",
    stiffness: "N·m/rad",
};
/// Units of a prismatic joint.
pub(crate) const SLIDES: Units = Units {
    offset: "mm",
    position: "m",
    torque: "N",
    stiffness: "N/m",
};

/// Returns the units of a prismatic (`slides`) or revolute joint.
pub(crate) fn of_joint(slides: bool) -> Units {
    if slides { SLIDES } else { TURNS }
}

/// Returns the units of table headings: those of prismatic joints only if all joints are prismatic.
pub(crate) fn of_heads(slides: impl Iterator<Item = bool>) -> Units {
    let mut slides = slides.peekable();
    of_joint(slides.peek().is_some() && slides.all(|slides| slides))
}

/// Replaces the units of a revolute joint in a text by `units`; the key `zero_mrad` of robot.toml stays.
pub(crate) fn in_units(text: &str, units: Units) -> String {
    const KEY: &str = "zero_mrad";
    let parts = text.split(KEY);
    let parts = parts.map(|part| {
        part.replace("mrad", units.offset)
            .replace("N·m", units.torque)
    });
    parts.collect::<Vec<_>>().join(KEY)
}

/// Replaces the units of revolute joints in the headings of a table by `units`.
pub(crate) fn in_units_of(mut table: Table, units: Units) -> Table {
    for head in &mut table.head {
        *head = in_units(head, units);
    }
    table
}

/// Formats the name of a joint in a table, with its units if they differ from those of the headings.
pub(crate) fn name_in_table(name: &str, slides: bool, heads: Units) -> String {
    let own = of_joint(slides);
    match own == heads {
        true => name.to_owned(),
        false => format!("{name} ({}, {})", own.offset, own.torque),
    }
}
