//! Checks of a tendon against its rope.

use super::drives::Drive;
use super::finding::{Bounds, Finding, FindingKind, Measure, Severity, Written, check_range};
use crate::strand_duty::{Strand, strand_tension_n};
use sinew_files::names;
use sinew_model::transmission::Tendon;
use sinew_rope::{Catalogue, CatalogueRope};

/// Maximum usual load of a synthetic rope as a share of the breaking load: a safety factor of 5.
const MAX_WORKING_SHARE: f64 = 0.2;

impl Drive<'_> {
    /// Returns the implausible values of the tendon. `effort_nm`: maximum torque of the joint, N·m, if specified.
    pub(super) fn tendon(&self, catalogue: &Catalogue, effort_nm: Option<f64>) -> Vec<Finding> {
        let Some(tendon) = &self.transmission.tendon else {
            return Vec::new();
        };
        let mut out = self.elongation_limit(tendon);
        let Some(name) = &tendon.rope else {
            return out;
        };
        match catalogue.find(name) {
            Ok(rope) => out.extend(self.rope(tendon, rope, effort_nm)),
            Err(_) => out.push(self.unknown_rope(name, catalogue)),
        }
        out
    }

    fn path(&self, key: &str) -> String {
        format!("joints.{}.tendon.{key}", self.joint)
    }

    fn of_tendon(
        &self,
        kind: FindingKind,
        key: &str,
        (value, power): (f64, f64),
        bounds: Bounds,
    ) -> Option<Finding> {
        let path = self.path(key);
        let written = Written {
            value: self.keys.number(&path)?,
            unit: sinew_files::bound::unit_of(&path),
        };
        let measure = Measure {
            value,
            unit: "",
            power,
        };
        let finding = check_range(kind, || self.keys.at(&path), written, measure, bounds);
        finding.map(|finding| self.keys.sensible(finding))
    }

    fn unknown_rope(&self, name: &str, catalogue: &Catalogue) -> Finding {
        let available = catalogue.names();
        let near = names::nearest(name, &available).map(str::to_owned);
        let others = available
            .iter()
            .filter(|n| Some(*n) != near.as_ref())
            .cloned();
        let kind = FindingKind::UnknownRope;
        Finding {
            text: Some(name.to_owned()),
            names: near.iter().cloned().chain(others).collect(),
            ..Finding::new(
                kind,
                Severity::Implausible,
                self.keys.at(&self.path("rope")),
            )
        }
    }

    /// Checks that the elongation limit can be reached: fibres break at 3 to 5 %.
    fn elongation_limit(&self, tendon: &Tendon) -> Vec<Finding> {
        let strain = tendon.retension_at_m.map(|m| m / tendon.length_m);
        let bounds = Bounds::usual(1e-5, 0.1).possible(0.0, 1.0);
        let found = strain.and_then(|strain| {
            let kind = FindingKind::ElongationLimit;
            self.of_tendon(kind, "retension_at_mm", (strain, 1.0), bounds)
        });
        found.into_iter().collect()
    }

    fn rope(&self, tendon: &Tendon, rope: &CatalogueRope, effort_nm: Option<f64>) -> Vec<Finding> {
        let mut out = Vec::new();
        let value = |v: &Option<sinew_rope::law::entry::Value>| v.as_ref().map(|v| v.value);
        let radius_m = tendon.joint_pulley_radius_m;
        let law = rope.entry.parameters();
        let breaking_n = value(&rope.entry.breaking_load_n)
            .or_else(|| law.as_ref().ok().map(|law| law.breaking_load_n));
        if let Some(breaking_n) = breaking_n {
            let pretension_n = tendon.pretension_n.unwrap_or(0.0);
            let share = Bounds::usual(0.0, MAX_WORKING_SHARE).possible(0.0, 1.0);
            let pull = |torque| strand_tension_n(pretension_n, radius_m, torque, Strand::Positive);
            let kind = FindingKind::Pretension;
            let tight = self.of_tendon(
                kind,
                "pretension_n",
                (pretension_n / breaking_n, 1.0),
                share,
            );
            let radius = "joint_pulley_radius_mm";
            let holding = || {
                let pull = pull(self.load.gravity_nm) / breaking_n;
                let share = Bounds::usual(0.0, 0.5).possible(0.0, 1.0);
                self.of_tendon(FindingKind::HoldingPull, radius, (pull, -1.0), share)
            };
            let largest = || {
                let pull = pull(effort_nm?) / breaking_n;
                let kind = FindingKind::LargestPull;
                self.of_tendon(kind, radius, (pull, -1.0), Bounds::usual(0.0, 1.0))
            };
            out.extend(tight.or_else(holding).or_else(largest));
        }
        if let Some(diameter_mm) = value(&rope.entry.diameter_mm) {
            // Below 5 diameters a synthetic rope wears fast; below 1 diameter the path would be inside the rope.
            let bounds = Bounds::usual(5.0, f64::INFINITY).possible(1.0, f64::INFINITY);
            let guides = (0..tendon.guides.len()).map(|i| format!("guides[{i}].radius_mm"));
            for key in std::iter::once("joint_pulley_radius_mm".to_owned()).chain(guides) {
                let radius_mm = self.keys.number(&self.path(&key));
                let Some(ratio) = radius_mm.map(|mm| 2.0 * mm / diameter_mm) else {
                    continue;
                };
                let kind = FindingKind::PulleyDiameter;
                out.extend(self.of_tendon(kind, &key, (ratio, 1.0), bounds));
            }
        }
        if let Ok(law) = law {
            // At most two strands act on the pulley: K = 2 r² E A/L.
            let strand_n_per_m = law.elastic_k * law.breaking_load_n / tendon.length_m;
            let ratio = self.transmission.stiffness_nm_per_rad
                / (2.0 * strand_n_per_m * radius_m * radius_m);
            // The stiffness in the catalogue is approximate; no rope is stiffer by a factor of 10.
            let bounds = Bounds::usual(0.0, 2.0).possible(0.0, 10.0);
            let path = format!("joints.{}.stiffness_nm_per_rad", self.joint);
            let written = Written {
                value: self.transmission.stiffness_nm_per_rad,
                unit: "N·m/rad",
            };
            let measure = Measure {
                value: ratio,
                unit: "",
                power: 1.0,
            };
            let kind = FindingKind::StifferThanRope;
            out.extend(check_range(
                kind,
                || self.keys.at(&path),
                written,
                measure,
                bounds,
            ));
        }
        out
    }
}
