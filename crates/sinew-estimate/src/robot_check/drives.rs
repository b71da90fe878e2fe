//! Stiffness, motor inertia and friction against what the arm asks of a joint.

use super::finding::{Bounds, Finding, FindingKind, Measure, Written, judge};
use super::keys::Keys;
use super::loads::Load;
use sinew_files::bound::unit_of;
use sinew_model::transmission::Transmission;
use std::f64::consts::TAU;

/// A joint's drive and its place.
pub(super) struct Drive<'a> {
    pub(super) joint: &'a str,
    pub(super) keys: &'a Keys,
    pub(super) transmission: &'a Transmission,
    pub(super) load: &'a Load,
}

impl Drive<'_> {
    /// What is odd of it.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let mut out = Vec::from_iter(self.stiffness());
        out.extend(self.motor());
        out.extend(self.friction(
            "joint_friction",
            self.transmission.joint_friction.coulomb_nm,
        ));
        out.extend(self.friction(
            "motor_friction",
            self.transmission.motor_friction.coulomb_nm,
        ));
        out
    }

    fn judged(
        &self,
        kind: FindingKind,
        key: &str,
        measure: Measure,
        bounds: Bounds,
    ) -> Option<Finding> {
        let path = format!("joints.{}.{key}", self.joint);
        // Friction may be the URDF's, then no key has it.
        let value = self.keys.number(&path)?;
        let written = Written {
            value,
            unit: unit_of(&path),
        };
        let finding = judge(kind, || self.keys.at(&path), written, measure, bounds);
        finding.map(|finding| self.keys.sensible(finding))
    }

    /// The spring under gravity, and the link swinging on it.
    fn stiffness(&self) -> Option<Finding> {
        let (k, load) = (self.transmission.stiffness_nm_per_rad, self.load);
        let key = "stiffness_nm_per_rad";
        let sag_rad = load.gravity_nm / k;
        let sag = Measure {
            value: sag_rad,
            unit: "rad",
            power: -1.0,
        };
        // An arm that hangs by 60 degrees can't be used; by a turn its tendon is off the pulley.
        let bounds = Bounds::usual(0.0, 1.0).possible(0.0, TAU);
        let finding = self.judged(FindingKind::Sag, key, sag, bounds);
        if finding.is_some() || load.inertia_kg_m2 <= 0.0 {
            return finding;
        }
        let frequency = Measure {
            value: libm::sqrt(k / load.inertia_kg_m2) / TAU,
            unit: "Hz",
            power: 0.5,
        };
        let bounds = Bounds::usual(0.5, 500.0);
        let finding = self.judged(FindingKind::Frequency, key, frequency, bounds);
        finding.or_else(|| {
            // Moving briskly, at 10 rad/s².
            let torque = load.gravity_nm.max(10.0 * load.inertia_kg_m2);
            let most = Measure {
                value: 1e3 * torque / k,
                unit: "mrad",
                power: -1.0,
            };
            // A 20-bit encoder has steps of 0.006 mrad.
            let bounds = Bounds::usual(1e-3, f64::INFINITY);
            self.judged(FindingKind::TooStiff, key, most, bounds)
        })
    }

    /// Motor inertia over the link's: a rotor whose gear was forgotten is far below.
    fn motor(&self) -> Option<Finding> {
        let motor = self.transmission.motor_inertia_kg_m2?;
        if self.load.inertia_kg_m2 <= 0.0 || motor == 0.0 {
            return None;
        }
        let ratio = Measure {
            value: motor / self.load.inertia_kg_m2,
            unit: "",
            power: 1.0,
        };
        let bounds = Bounds::usual(1e-3, 1e3);
        self.judged(
            FindingKind::MotorInertia,
            "motor_inertia_kg_m2",
            ratio,
            bounds,
        )
    }

    /// Friction as the deflection of the spring that it takes to overcome it.
    fn friction(&self, section: &str, coulomb_nm: f64) -> Option<Finding> {
        if coulomb_nm == 0.0 {
            return None;
        }
        let over = Measure {
            value: coulomb_nm / self.transmission.stiffness_nm_per_rad,
            unit: "rad",
            power: 1.0,
        };
        let bounds = Bounds::usual(2e-5, 0.3).possible(0.0, TAU);
        let key = format!("{section}.coulomb_nm");
        self.judged(FindingKind::Friction, &key, over, bounds)
    }
}
