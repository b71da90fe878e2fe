//! Numbers of a TOML file with their lines, and the usual range of each key.

use super::finding::{
    Bounds, Finding, FindingKind, Location, Measure, Severity, Written, check_range, check_value,
};
use sinew_files::bound::unit_of;
use sinew_files::{Bound, Located, Section, TomlFile, Value};
use std::f64::consts::TAU;

/// Key of a TOML file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Key {
    /// Section and key, such as `joints.elbow.tendon.length_mm`.
    pub(super) path: String,
    pub(super) line: u64,
    /// Value of the key, if it is a number.
    pub(super) number: Option<f64>,
}

/// Keys of a TOML file.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Keys {
    file: String,
    all: Vec<Key>,
}

impl Keys {
    /// Parses the text of a file.
    pub(super) fn parse(text: &str, file: &str) -> Result<Self, Located> {
        let mut all = Vec::new();
        gather(&TomlFile::parse(text, file)?.root(), "", &mut all);
        Ok(Self {
            file: file.to_owned(),
            all,
        })
    }

    /// Returns the location of a key, without a line for an unknown key.
    pub(super) fn at(&self, path: &str) -> Location {
        let key = self.all.iter().find(|key| key.path == path);
        Location {
            file: self.file.clone(),
            line: key.map(|key| key.line),
            key: path.to_owned(),
        }
    }

    /// Returns the number at a key.
    pub(super) fn number(&self, path: &str) -> Option<f64> {
        self.all.iter().find(|key| key.path == path)?.number
    }

    /// Removes a unit hint with which the value of the key would be implausible.
    pub(super) fn sensible(&self, mut finding: Finding) -> Finding {
        let usual = bounds_of(&finding.at.key).map(|bounds| bounds.usual);
        finding.slip = finding
            .slip
            .filter(|slip| usual.is_none_or(|(low, high)| (low..=high).contains(&slip.value)));
        finding
    }

    /// Returns the numbers outside the usual range of their keys.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let implausible = |key: &Key| {
            let bounds = bounds_of(&key.path)?;
            // `base_rpy_rad[0]` is in rad.
            let unit = unit_of(
                key.path
                    .split_once('[')
                    .filter(|(_, i)| i.ends_with(']'))
                    .map_or(&key.path, |(list, _)| list),
            );
            let value = key.number.filter(|value| *value != 0.0)?;
            let measure = Measure {
                value: value.abs(),
                unit,
                power: 1.0,
            };
            let written = Written { value, unit };
            let at = || self.at(&key.path);
            check_range(FindingKind::Range, at, written, measure, bounds)
        };
        let gravity = self.gravity();
        self.all
            .iter()
            .filter_map(implausible)
            .chain(gravity)
            .collect()
    }

    /// Checks the magnitude and the direction of gravity.
    fn gravity(&self) -> Option<Finding> {
        let path = |i: usize| format!("gravity_m_s2[{i}]");
        let part = |i| self.number(&path(i));
        let g = [part(0)?, part(1)?, part(2)?];
        let at = |i| Location {
            key: "gravity_m_s2".into(),
            ..self.at(&path(i))
        };
        let size = libm::sqrt(g.iter().map(|x| x * x).sum());
        let written = Written {
            value: size,
            unit: "m/s²",
        };
        // Moon 1.6, Jupiter 25; 0 in orbit is allowed.
        let bounds = Bounds::usual(1.5, 26.0).possible(0.0, 275.0);
        let finding = check_value(FindingKind::Gravity, || at(0), written, bounds);
        let up = (g[2] > 0.5 * size && size > 0.0).then(|| Finding {
            value: Some(g[2]),
            unit: "m/s²",
            ..Finding::new(FindingKind::GravityUp, Severity::Implausible, at(2))
        });
        finding.filter(|_| size > 0.0).or(up)
    }
}

fn gather(section: &Section<'_>, before: &str, all: &mut Vec<Key>) {
    for (name, line, value) in section.entries() {
        let path = match before {
            "" => name.to_owned(),
            before => format!("{before}.{name}"),
        };
        push(&value, path, line, all);
    }
}

fn push(value: &Value<'_>, path: String, line: u64, all: &mut Vec<Key>) {
    if let Ok(section) = value.section() {
        gather(&section, &path, all);
    } else if let Ok(list) = value.list("") {
        for (i, item) in list.iter().enumerate() {
            push(item, format!("{path}[{i}]"), line, all);
        }
    } else {
        let number = value.number(Bound::Any).ok();
        all.push(Key { path, line, number });
    }
}

/// Returns the usual range of the absolute value of a key, in the key's unit.
fn bounds_of(path: &str) -> Option<Bounds> {
    let mut parts = path.rsplit('.');
    let last = parts.next()?;
    let parent = parts.next().unwrap_or_default();
    Some(match last {
        // Tendons of fingers have centimetres; except in cranes no strand has 10 m.
        "length_mm" => Bounds::usual(15.0, 10_000.0).possible(2.0, 100_000.0),
        "joint_pulley_radius_mm" => Bounds::usual(2.0, 250.0).possible(0.5, 2_000.0),
        "radius_mm" => Bounds::usual(1.0, 250.0).possible(0.3, 2_000.0),
        "wrap_deg" => Bounds::usual(0.0, 1_080.0),
        // Dry rope on steel 0.1 to 0.3.
        "friction" if parent.starts_with("guides[") => Bounds::usual(0.0, 0.6),
        "retension_at_mm" => Bounds::usual(0.01, 50.0),
        // Fibres break at 3 to 5 %; slow creep reaches 10 %.
        "replace_at_strain_percent" => Bounds::usual(0.05, 10.0).possible(0.0, 100.0),
        "pretension_n" => Bounds::usual(1.0, 20_000.0),
        "motor_inertia_kg_m2" => Bounds::usual(1e-7, 1e3),
        "locked_at_rad" => Bounds::usual(0.0, 4.0 * TAU),
        "gear_ratio" => Bounds::usual(0.05, 5_000.0),
        "scale" => Bounds::usual(1e-7, 1e7),
        // From tiny coreless motors to ring torque motors.
        "torque_constant_nm_per_a" => Bounds::usual(2e-4, 12.0),
        "counts_per_turn" => Bounds::usual(4.0, 1.4e8),
        key if parent == "tolerances" => return tolerance(key),
        _ if last.starts_with("base_rpy_rad[") => Bounds::usual(0.0, TAU),
        _ => return None,
    })
}

/// Returns the usual range of a tolerance: wide enough for fingers and cranes, narrow enough to detect a unit error of
/// a factor of 1000.
fn tolerance(key: &str) -> Option<Bounds> {
    Some(match key {
        key if key.ends_with("_percent") => Bounds::usual(0.05, 100.0),
        "payload_reach_mm" => Bounds::usual(1.0, 1_000.0),
        "payload_kg" | "payload_mean_kg" => Bounds::usual(5e-4, 500.0),
        // 20 bit to a potentiometer.
        "encoder_mrad" => Bounds::usual(2e-3, 20.0),
        "drift_mrad_per_k" => Bounds::usual(1e-3, 5.0),
        "zero_mrad" => Bounds::usual(0.05, 1_000.0),
        // 295 would be a temperature, not a tolerance.
        "temperature_k" => Bounds::usual(0.05, 100.0),
        "external_force_n" => Bounds::usual(0.01, 500.0),
        _ => return None,
    })
}
