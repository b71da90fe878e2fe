//! Checks of the masses, inertias and distances of a URDF.

use super::finding::{
    Bounds, Finding, FindingKind, Location, Measure, Severity, Written, check_range, slip,
};
use sinew_model::arm::urdf::{
    JointType, UrdfJoint, UrdfLink, UrdfRobot, is_positive_semidefinite, line_of, obeys_triangle,
};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Maximum density of matter, kg/m³: osmium has 22 590 kg/m³, rounded up.
const MAX_DENSITY_KG_M3: f64 = 23_000.0;
/// Maximum usual density of a link, kg/m³: lead has 11 340 kg/m³.
const MAX_USUAL_DENSITY_KG_M3: f64 = 12_000.0;
/// Density range of links, from thin tubes to solid steel, that the value in another unit must satisfy, kg/m³.
const LINK_DENSITY_KG_M3: std::ops::RangeInclusive<f64> = 5.0..=MAX_USUAL_DENSITY_KG_M3;
/// Maximum mass of an arm per cube of its reach, kg/m³: a ball of osmium with the radius of the reach.
const MAX_MASS_PER_REACH_KG_M3: f64 = 4.0 / 3.0 * PI * MAX_DENSITY_KG_M3;

/// Parsed URDF, its text and the name of its file.
pub(super) struct Outline<'a> {
    pub(super) robot: &'a UrdfRobot,
    pub(super) text: &'a str,
    pub(super) file: &'a str,
}

/// Link that moves.
struct Moving<'a> {
    link: &'a UrdfLink,
    /// Length of the chain from the first moving joint to the joint of the link, m.
    way_m: f64,
    /// Maximum distance of the centre of mass and of the child joints from the joint of the link, m.
    extent_m: f64,
}

impl Outline<'_> {
    /// Returns the location of a property (`what`) of an element such as `link 'forearm'`.
    pub(super) fn at(&self, element: &str, what: &str) -> Location {
        Location {
            file: self.file.to_owned(),
            line: Some(line_of(self.text, element)).filter(|line| *line > 0),
            key: format!("{element}, {what}"),
        }
    }

    fn at_link(&self, link: &UrdfLink, what: &str) -> Location {
        self.at(&format!("link '{}'", link.name), what)
    }

    /// Returns the moving links, starting at the base.
    fn moving(&self) -> Vec<Moving<'_>> {
        let links: BTreeMap<&str, &UrdfLink> = (self.robot.links.iter())
            .map(|link| (link.name.as_str(), link))
            .collect();
        let mut below: BTreeMap<&str, Vec<&UrdfJoint>> = BTreeMap::new();
        for joint in &self.robot.joints {
            below.entry(&joint.parent).or_default().push(joint);
        }
        let is_child = |name: &str| self.robot.joints.iter().any(|j| j.child == name);
        let roots = links.keys().filter(|name| !is_child(name));
        // Link, and the length of the chain to it after the first moving joint.
        let mut open: Vec<(&str, Option<f64>)> = roots.map(|name| (*name, None)).collect();
        let mut out = Vec::new();
        while let Some((name, way)) = open.pop() {
            let on_it = below.get(name).map_or(&[][..], Vec::as_slice);
            let Some(link) = links.get(name) else {
                continue;
            };
            if let Some(way_m) = way {
                let joints = on_it.iter().map(|joint| length(&joint.origin.xyz));
                let com = length(&link.origin.xyz);
                out.push(Moving {
                    link,
                    way_m,
                    extent_m: joints.fold(com, f64::max),
                });
            }
            for joint in on_it {
                let moves = joint.joint_type != JointType::Fixed;
                let further = way.map(|way| way + length(&joint.origin.xyz));
                let way = further.or(moves.then_some(0.0));
                open.push((&joint.child, way));
            }
        }
        out
    }

    /// Returns the implausible distances, masses and inertias.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let mut out = self.distances();
        if !out.is_empty() {
            // Without a plausible reach nothing else can be checked.
            return out;
        }
        let moving = self.moving();
        let reach_m = moving.iter().map(|m| m.way_m + length(&m.link.origin.xyz));
        let reach_m = reach_m.fold(0.0, f64::max);
        let mass_kg: f64 = moving.iter().map(|m| m.link.mass_kg).sum();
        for one in &moving {
            // Links may be wider than the distance of their joints, but not wider than the arm.
            let widest_m = (3.0 * one.extent_m).max(0.5 * reach_m).max(0.05);
            out.extend(self.density(one, widest_m));
            out.extend(self.inertia(one, widest_m));
            out.extend(self.share(one, mass_kg, reach_m, moving.len()));
        }
        // A reach of a few centimetres, with all joints in one place, is not informative.
        if out.is_empty() && reach_m > 0.05 {
            out.extend(self.whole(&moving, mass_kg, reach_m));
        }
        out
    }

    /// Returns the joints and centres of mass that are too far from their links.
    fn distances(&self) -> Vec<Finding> {
        // Arms have links below 5 m; excavators have longer ones.
        let bounds = Bounds::usual(0.0, 5.0).possible(0.0, 50.0);
        let far = |element: String, xyz: &[f64; 3]| {
            let value = xyz
                .iter()
                .copied()
                .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
            let measure = Measure {
                value: length(xyz),
                unit: "m",
                power: 1.0,
            };
            let written = Written { value, unit: "m" };
            let at = || self.at(&element, "origin");
            check_range(FindingKind::Distance, at, written, measure, bounds)
        };
        let joints = self.robot.joints.iter();
        let joints = joints.filter_map(|j| far(format!("joint '{}'", j.name), &j.origin.xyz));
        let links = self.robot.links.iter().filter(|l| l.mass_kg > 0.0);
        let links = links.filter_map(|l| far(format!("link '{}'", l.name), &l.origin.xyz));
        joints.chain(links).collect()
    }

    /// Checks the density: of all bodies of a given mass and density the ball has the smallest inertia,
    /// `tr I = 6/5 m r²`. Zero inertia describes a point mass and is accepted.
    fn density(&self, one: &Moving<'_>, widest_m: f64) -> Option<Finding> {
        let (mass, trace) = (one.link.mass_kg, trace(one.link));
        if mass <= 0.0 || trace <= 0.0 || !is_positive_semidefinite(&matrix(one.link)) {
            return None;
        }
        // Published URDFs contain placeholder inertias, so none is reported as impossible.
        let bounds = Bounds::usual(0.0, MAX_USUAL_DENSITY_KG_M3);
        let density = (density(mass, trace), "kg/m³");
        self.of_either(FindingKind::Density, one, density, bounds, widest_m)
    }

    /// Returns a finding about a link's mass and inertia: for the one that would be plausible in another unit,
    /// for the mass if neither is.
    fn of_either(
        &self,
        kind: FindingKind,
        one: &Moving<'_>,
        (value, unit): (f64, &'static str),
        bounds: Bounds,
        widest_m: f64,
    ) -> Option<Finding> {
        let (mass, trace) = (one.link.mass_kg, trace(one.link));
        let is_body = |mass: f64, trace: f64| {
            LINK_DENSITY_KG_M3.contains(&density(mass, trace))
                && gyration_m(mass, trace) <= widest_m
        };
        let measure = Measure {
            value,
            unit,
            power: 0.0,
        };
        if is_placeholder(one.link) {
            // No unit explains a placeholder.
            let at = || self.at_link(one.link, "inertia");
            let written = Written {
                value: trace / 3.0,
                unit: "kg·m²",
            };
            let kind = FindingKind::InertiaPlaceholder;
            return check_range(kind, at, written, measure, bounds).map(|finding| Finding {
                slip: None,
                ..finding
            });
        }
        let of = |what: &str, written: Written| {
            let at = || self.at_link(one.link, what);
            check_range(kind, at, written, measure, bounds)
        };
        let mass_kg = Written {
            value: mass,
            unit: "kg",
        };
        let mean = Written {
            value: trace / 3.0,
            unit: "kg·m²",
        };
        let of_inertia = Finding {
            slip: slip(mean, |mean| is_body(mass, 3.0 * mean)),
            ..of("inertia (mean of the three)", mean)?
        };
        let of_mass = Finding {
            slip: slip(mass_kg, |mass| is_body(mass, trace)),
            ..of("mass", mass_kg)?
        };
        let inertia_is_wrong = of_mass.slip.is_none()
            && (of_inertia.slip.is_some() || kind == FindingKind::InertiaSize);
        Some(if inertia_is_wrong {
            of_inertia
        } else {
            of_mass
        })
    }

    /// Checks that an inertia is physically possible and suits the size of the link.
    fn inertia(&self, one: &Moving<'_>, widest_m: f64) -> Option<Finding> {
        let (mass, trace) = (one.link.mass_kg, trace(one.link));
        let matrix = matrix(one.link);
        let at = || self.at_link(one.link, "inertia");
        if mass <= 0.0 {
            return None;
        }
        if !is_positive_semidefinite(&matrix) {
            let kind = FindingKind::InertiaNotDefinite;
            return Some(Finding::new(kind, Severity::Implausible, at()));
        }
        if !obeys_triangle(&matrix) {
            let kind = FindingKind::InertiaTriangle;
            return Some(Finding::new(kind, Severity::Implausible, at()));
        }
        // The actual width of a link is in its meshes, so no size is reported as impossible.
        let size = (gyration_m(mass, trace), "m");
        let bounds = Bounds::usual(0.0, widest_m);
        self.of_either(FindingKind::InertiaSize, one, size, bounds, widest_m)
    }

    /// Checks for a link that is heavier than the rest of the arm, or long and nearly massless.
    fn share(&self, one: &Moving<'_>, all_kg: f64, reach_m: f64, count: usize) -> Option<Finding> {
        let mass = one.link.mass_kg;
        let others_kg = all_kg - mass;
        if mass <= 0.0 || others_kg <= 0.0 || count < 3 {
            return None;
        }
        let assessed = |kind, ratio, bounds| {
            let at = || self.at_link(one.link, "mass");
            let written = Written {
                value: mass,
                unit: "kg",
            };
            let measure = Measure {
                value: ratio,
                unit: "",
                power: 1.0,
            };
            check_range(kind, at, written, measure, bounds)
        };
        let heavy = Bounds::usual(0.0, 30.0).possible(0.0, 300.0);
        assessed(FindingKind::HeavyLink, mass / others_kg, heavy).or_else(|| {
            let long = one.extent_m > 0.2 * reach_m;
            let light = Bounds::usual(1e-3, f64::INFINITY);
            long.then(|| assessed(FindingKind::LightLink, mass / all_kg, light))?
        })
    }

    /// Checks the moving mass per cube of the reach: carbon tubes have 1 kg/m³, a press has 500 kg/m³.
    fn whole(&self, moving: &[Moving<'_>], mass_kg: f64, reach_m: f64) -> Option<Finding> {
        let heaviest = moving
            .iter()
            .max_by(|a, b| a.link.mass_kg.total_cmp(&b.link.mass_kg))?;
        if mass_kg <= 0.0 {
            return None;
        }
        let bounds = Bounds::usual(0.1, 5_000.0).possible(0.0, MAX_MASS_PER_REACH_KG_M3);
        let written = Written {
            value: heaviest.link.mass_kg,
            unit: "kg",
        };
        let measure = Measure {
            value: mass_kg / reach_m.powi(3),
            unit: "kg/m³",
            power: 1.0,
        };
        let at = || self.at_link(heaviest.link, "mass");
        check_range(FindingKind::ArmMass, at, written, measure, bounds)
    }
}

/// Returns the density of a ball from its mass and the trace of its inertia, kg/m³.
fn density(mass: f64, trace: f64) -> f64 {
    let radius_m = libm::sqrt(5.0 * trace / (6.0 * mass));
    mass / (4.0 / 3.0 * PI * radius_m.powi(3))
}

fn gyration_m(mass: f64, trace: f64) -> f64 {
    libm::sqrt(trace / (2.0 * mass))
}

/// Whether the inertia looks like a placeholder, without products of inertia: one power of ten about all axes, or numbers
/// of one digit like the mass.
fn is_placeholder(link: &UrdfLink) -> bool {
    let [ixx, ixy, ixz, iyy, iyz, izz] = link.inertia;
    let digit = |value: f64| value / 10_f64.powf(value.abs().log10().floor());
    let is_whole = |value: f64| (value - value.round()).abs() < 1e-9;
    let is_power_of_ten = iyy == ixx && izz == ixx && is_whole(ixx.abs().log10());
    let all = [ixx, iyy, izz, link.mass_kg];
    [ixy, ixz, iyz] == [0.0; 3] && (is_power_of_ten || all.iter().all(|x| is_whole(digit(*x))))
}

fn length(xyz: &[f64; 3]) -> f64 {
    libm::sqrt(xyz.iter().map(|x| x * x).sum())
}

fn trace(link: &UrdfLink) -> f64 {
    let [ixx, _, _, iyy, _, izz] = link.inertia;
    ixx + iyy + izz
}

fn matrix(link: &UrdfLink) -> [[f64; 3]; 3] {
    let [ixx, ixy, ixz, iyy, iyz, izz] = link.inertia;
    [[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]
}
