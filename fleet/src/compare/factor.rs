//! Factors by which tendons may differ, and their groups.

use crate::gather::CreepingTendon;
use std::collections::BTreeMap;

/// Width of a band of temperatures, K.
pub(super) const BAND_K: f64 = 10.0;

/// Factor by which tendons may differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Factor {
    /// Type of the robot and joint: load, length, pulleys, guides.
    Joint,
    /// Type, joint and rope.
    Kind,
    /// Batch of the rope.
    Batch,
    /// Site of the robot.
    Site,
    /// Site, for each rope apart: ropes answer to a site each in its own way.
    SiteOfRope,
    /// Robot of the tendon.
    Robot,
    /// Mean temperature of the tendon.
    Temperature,
}

/// Group, with the set within which it is compared, and its name. Either may be unknown.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct GroupKey {
    /// Groups are compared with others of this: a batch with those of its rope.
    pub family: Option<String>,
    /// Name of the group, or the lower limit of its temperature band, °C.
    pub name: String,
}

/// A group of tendons as the model has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DesignGroup {
    pub(super) key: GroupKey,
    pub(super) tendons: usize,
    pub(super) robots: usize,
    /// Factors and levels with which the group is confounded.
    pub(super) tied_to: Vec<(Factor, String)>,
}

/// Lower end of a tendon's band of temperatures.
pub(super) fn band(tendon: &CreepingTendon) -> Option<String> {
    let celsius = tendon.creep.temperature_c?;
    Some(format!("{:.0}", (celsius / BAND_K).floor() * BAND_K))
}

/// Returns the level of a factor for a tendon; "unknown" is a level, too.
pub(super) fn level(tendon: &CreepingTendon, factor: Factor) -> String {
    let text_of = |text: &Option<String>| text.clone().unwrap_or_default();
    let joint = || format!("{}, {}", tendon.robot_type, tendon.joint);
    match factor {
        Factor::Joint => joint(),
        Factor::Kind => format!("{}, {}", joint(), text_of(&tendon.fit.rope)),
        Factor::Batch => format!(
            "{}, {}",
            text_of(&tendon.fit.rope),
            text_of(&tendon.fit.batch)
        ),
        Factor::Site => text_of(&tendon.site),
        Factor::SiteOfRope => format!("{}, {}", text_of(&tendon.site), text_of(&tendon.fit.rope)),
        Factor::Robot => tendon.robot.clone(),
        Factor::Temperature => band(tendon).unwrap_or_default(),
    }
}

/// Numbers of names, in their order.
pub(super) fn numbered<T: Ord>(names: impl Iterator<Item = T>) -> BTreeMap<T, usize> {
    let mut out: BTreeMap<T, usize> = names.map(|name| (name, 0)).collect();
    out.values_mut().enumerate().for_each(|(i, n)| *n = i);
    out
}
