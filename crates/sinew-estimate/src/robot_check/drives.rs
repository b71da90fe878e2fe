//! Checks of stiffness, motor inertia and friction against the load of the arm.

use super::finding::{Bounds, Finding, FindingKind, Measure, Written, check_range};
use super::keys::Keys;
use super::loads::Load;
use sinew_files::bound::unit_of;
use sinew_model::transmission::Transmission;
use std::f64::consts::TAU;

/// Drive of a joint, with the keys that describe it.
pub(super) struct Drive<'a> {
    pub(super) joint: &'a str,
    pub(super) keys: &'a Keys,
    pub(super) transmission: &'a Transmission,
    pub(super) load: &'a Load,
}

impl Drive<'_> {
    /// Returns the implausible values of the drive.
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

    fn assessed(
        &self,
        kind: FindingKind,
        key: &str,
        measure: Measure,
        bounds: Bounds,
    ) -> Option<Finding> {
        let path = format!("joints.{}.{key}", self.joint);
        // Friction may be specified in the URDF; then there is no key.
        let value = self.keys.number(&path)?;
        let written = Written {
            value,
            unit: unit_of(&path),
        };
        let finding = check_range(kind, || self.keys.at(&path), written, measure, bounds);
        finding.map(|finding| self.keys.sensible(finding))
    }

    /// Checks the deflection of the spring by gravity, and the natural frequency of the link.
    fn stiffness(&self) -> Option<Finding> {
        let (k, load) = (self.transmission.stiffness_nm_per_rad, self.load);
        let key = "stiffness_nm_per_rad";
        let sag_rad = load.gravity_nm / k;
        let sag = Measure {
            value: sag_rad,
            unit: "rad",
            power: -1.0,
        };
        // A deflection of 60° makes an arm unusable; at one revolution the tendon leaves the pulley.
        let bounds = Bounds::usual(0.0, 1.0).possible(0.0, TAU);
        let finding = self.assessed(FindingKind::Sag, key, sag, bounds);
        if finding.is_some() || load.inertia_kg_m2 <= 0.0 {
            return finding;
        }
        let frequency = Measure {
            value: libm::sqrt(k / load.inertia_kg_m2) / TAU,
            unit: "Hz",
            power: 0.5,
        };
        let bounds = Bounds::usual(0.5, 500.0);
        let finding = self.assessed(FindingKind::Frequency, key, frequency, bounds);
        finding.or_else(|| {
            // Fast motion, at 10 rad/s².
            let torque = load.gravity_nm.max(10.0 * load.inertia_kg_m2);
            let deflection = Measure {
                value: 1e3 * torque / k,
                unit: "mrad",
                power: -1.0,
            };
            // A 20-bit encoder has steps of 0.006 mrad.
            let bounds = Bounds::usual(1e-3, f64::INFINITY);
            self.assessed(FindingKind::TooStiff, key, deflection, bounds)
        })
    }

    /// Checks the ratio of motor inertia to link inertia; it is far too small if the gear ratio is missing.
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
        self.assessed(
            FindingKind::MotorInertia,
            "motor_inertia_kg_m2",
            ratio,
            bounds,
        )
    }

    /// Checks friction as the deflection of the spring that overcomes it.
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
        self.assessed(FindingKind::Friction, &key, over, bounds)
    }
}
