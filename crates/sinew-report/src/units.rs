//! Units of a joint: one that slides has mm and N where one that turns has mrad and N·m.

use sinew_estimate::replay::JointEstimate;
use sinew_estimate::session::TendonEstimate;

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

/// A joint's estimate, whose units hang on how it moves.
pub(crate) trait Moves {
    /// Its name.
    fn name(&self) -> &str;
    /// Whether it slides.
    fn slides(&self) -> bool;
    /// Its units.
    fn units(&self) -> Units {
        of_joint(self.slides())
    }
}

impl Moves for TendonEstimate {
    fn name(&self) -> &str {
        &self.name
    }
    fn slides(&self) -> bool {
        self.slides
    }
}

impl Moves for JointEstimate {
    fn name(&self) -> &str {
        &self.name
    }
    fn slides(&self) -> bool {
        self.slides
    }
}

/// Units of a table's heads: of the joints that turn, where there is one.
pub(crate) fn of_heads<'a, M: Moves + 'a>(joints: impl IntoIterator<Item = &'a M>) -> Units {
    let mut joints = joints.into_iter().peekable();
    match joints.peek().is_some() && joints.all(Moves::slides) {
        true => SLIDES,
        false => TURNS,
    }
}

/// A head or a cell in the units of a table's heads, where it names those of a joint that turns.
pub(crate) fn in_units(text: &str, units: Units) -> String {
    text.replace("mrad", units.offset)
        .replace("N·m", units.torque)
}

/// A joint's name in a table: one that slides says its units where the heads have others.
pub(crate) fn name_in_table(joint: &impl Moves, heads: Units) -> String {
    match joint.units() == heads {
        true => joint.name().to_owned(),
        false => format!(
            "{} ({}, {})",
            joint.name(),
            joint.units().offset,
            joint.units().torque
        ),
    }
}
