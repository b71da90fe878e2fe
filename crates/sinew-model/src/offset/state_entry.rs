//! The entries of a state in words.

use super::layout::Layout;
use super::parameter::{PAYLOAD, PER_JOINT};
use crate::arm::PARAMETERS_PER_BODY;

/// One entry of the state in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StateEntry {
    /// Joint or body it belongs to; `None` for the payload.
    pub joint: Option<usize>,
    /// What it is.
    pub name: &'static str,
    /// Its unit; empty for a ratio.
    pub unit: &'static str,
}

impl StateEntry {
    /// Entry `k` of a state in which every body has all its parameters.
    pub(crate) fn of(layout: Layout, k: usize) -> Option<Self> {
        const JOINT: [(&str, &str); PER_JOINT] = [
            ("offset", "rad"),
            ("compliance over nominal", ""),
            ("stiffening", "1/rad²"),
            ("Coulomb friction", "N·m"),
            ("viscous friction", "N·m·s/rad"),
            ("load-dependent friction", ""),
            ("zero drift", "rad/K"),
            ("compliance per kelvin", "1/K"),
            ("encoder error, sine once", "rad"),
            ("encoder error, cosine once", "rad"),
            ("encoder error, sine twice", "rad"),
            ("encoder error, cosine twice", "rad"),
            ("motor torque scale", ""),
            ("motor torque zero", "N·m"),
            ("drive Coulomb friction", "N·m"),
            ("drive viscous friction", "N·m·s/rad"),
            ("drive load-dependent friction", ""),
            ("slack, half the dead zone", "rad"),
            ("friction at the start, −1…1", ""),
            ("viscoelastic share", ""),
            ("gear ratio error", ""),
            ("encoders' zero", "rad"),
        ];
        const BODY: [(&str, &str); PARAMETERS_PER_BODY] = [
            ("mass error", "kg"),
            ("first moment error x", "kg·m"),
            ("first moment error y", "kg·m"),
            ("first moment error z", "kg·m"),
            ("inertia error xx", "kg·m²"),
            ("inertia error xy", "kg·m²"),
            ("inertia error xz", "kg·m²"),
            ("inertia error yy", "kg·m²"),
            ("inertia error yz", "kg·m²"),
            ("inertia error zz", "kg·m²"),
        ];
        const LOAD: [(&str, &str); PAYLOAD] = [
            ("payload mass", "kg"),
            ("payload moment x", "kg·m"),
            ("payload moment y", "kg·m"),
            ("payload moment z", "kg·m"),
        ];
        let entry =
            |joint, (name, unit): (&'static str, &'static str)| Some(Self { joint, name, unit });
        if k < layout.body_start() {
            entry(Some(k / PER_JOINT), JOINT[k % PER_JOINT])
        } else if k < layout.payload_place() {
            let b = k - layout.body_start();
            entry(Some(b / PARAMETERS_PER_BODY), BODY[b % PARAMETERS_PER_BODY])
        } else {
            LOAD.get(k - layout.payload_place())
                .and_then(|e| entry(None, *e))
        }
    }
}
