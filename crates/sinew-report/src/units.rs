//! Units of a joint: one that slides has mm and N where one that turns has mrad and N·m.

use sinew_figure::Table;

/// Units in which a joint's quantities are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Units {
    /// Of an offset, thousandths of the SI unit.
    pub(crate) offset: &'static str,
    /// Of a position.
    pub(crate) position: &'static str,
    /// Of a torque.
    pub(crate) torque: &'static str,
    /// Of a stiffness.
    pub(crate) stiffness: &'static str,
}

/// A joint that turns.
pub(crate) const TURNS: Units = Units {
    offset: "mrad",
    position: "rad",
    torque: "N·m",
    stiffness: "N·m/rad",
};
/// A joint that slides.
pub(crate) const SLIDES: Units = Units {
    offset: "mm",
    position: "m",
    torque: "N",
    stiffness: "N/m",
};

/// Units of a joint by how it moves.
pub(crate) fn of_joint(slides: bool) -> Units {
    if slides { SLIDES } else { TURNS }
}

/// Units of a table's heads: of the joints that turn, where there is one.
pub(crate) fn of_heads(slides: impl Iterator<Item = bool>) -> Units {
    let mut slides = slides.peekable();
    of_joint(slides.peek().is_some() && slides.all(|slides| slides))
}

/// A head or a cell in the units of a table's heads, where it names those of a joint that turns.
pub(crate) fn in_units(text: &str, units: Units) -> String {
    text.replace("mrad", units.offset)
        .replace("N·m", units.torque)
}

/// A table whose heads name the units of joints that turn, in those that the joints have.
pub(crate) fn in_units_of(mut table: Table, units: Units) -> Table {
    for head in &mut table.head {
        *head = in_units(head, units);
    }
    table
}

/// A joint's name in a table: one that slides says its units where the heads have others.
pub(crate) fn name_in_table(name: &str, slides: bool, heads: Units) -> String {
    let own = of_joint(slides);
    match own == heads {
        true => name.to_owned(),
        false => format!("{name} ({}, {})", own.offset, own.torque),
    }
}
