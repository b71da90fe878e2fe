//! Units a mapping may name, as factors to SI.

use std::f64::consts::PI;

use crate::frame::Quantity;

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    Angle,
    Length,
    AngularVelocity,
    Velocity,
    Torque,
    Force,
    Current,
    Temperature,
    Count,
    None,
}

/// A unit: `si = raw * factor + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    pub(crate) factor: f64,
    pub(crate) offset: f64,
    pub(crate) dimension: Dimension,
}

const TABLE: &[(&[&str], f64, f64, Dimension)] = &[
    (&["rad"], 1.0, 0.0, Dimension::Angle),
    (&["mrad"], 1e-3, 0.0, Dimension::Angle),
    (&["deg", "°"], PI / 180.0, 0.0, Dimension::Angle),
    (&["turn", "rev"], 2.0 * PI, 0.0, Dimension::Angle),
    (&["count"], 1.0, 0.0, Dimension::Count),
    (&["m"], 1.0, 0.0, Dimension::Length),
    (&["mm"], 1e-3, 0.0, Dimension::Length),
    (&["um", "µm"], 1e-6, 0.0, Dimension::Length),
    (&["rad/s"], 1.0, 0.0, Dimension::AngularVelocity),
    (
        &["deg/s", "°/s"],
        PI / 180.0,
        0.0,
        Dimension::AngularVelocity,
    ),
    (
        &["turn/s", "rev/s"],
        2.0 * PI,
        0.0,
        Dimension::AngularVelocity,
    ),
    (&["rpm"], 2.0 * PI / 60.0, 0.0, Dimension::AngularVelocity),
    (&["m/s"], 1.0, 0.0, Dimension::Velocity),
    (&["mm/s"], 1e-3, 0.0, Dimension::Velocity),
    (&["N·m", "Nm", "N*m", "N m"], 1.0, 0.0, Dimension::Torque),
    (
        &["N·mm", "Nmm", "N*mm", "mN·m", "mNm", "mN*m"],
        1e-3,
        0.0,
        Dimension::Torque,
    ),
    (&["kN·m", "kNm"], 1e3, 0.0, Dimension::Torque),
    (&["N"], 1.0, 0.0, Dimension::Force),
    (&["A"], 1.0, 0.0, Dimension::Current),
    (&["mA"], 1e-3, 0.0, Dimension::Current),
    (&["°C", "degC", "C"], 1.0, 0.0, Dimension::Temperature),
    (&["K"], 1.0, -273.15, Dimension::Temperature),
    (&["1"], 1.0, 0.0, Dimension::None),
];

impl Unit {
    pub(crate) const SI: Unit = Unit {
        factor: 1.0,
        offset: 0.0,
        dimension: Dimension::None,
    };

    /// Finds a unit by its name; the error lists what is known.
    pub(crate) fn parse(text: &str) -> Result<Unit, String> {
        TABLE
            .iter()
            .find(|(names, ..)| names.contains(&text))
            .map(|&(_, factor, offset, dimension)| Unit {
                factor,
                offset,
                dimension,
            })
            .ok_or_else(|| {
                let known: Vec<&str> = TABLE.iter().map(|(names, ..)| names[0]).collect();
                format!("unknown unit '{text}': known are {}", known.join(", "))
            })
    }

    /// Whether a value in this unit can be the quantity without a further `scale`.
    pub(crate) fn fits(&self, quantity: Quantity) -> bool {
        use Dimension as D;
        let wanted: &[D] = match quantity {
            Quantity::Q | Quantity::Theta => &[D::Angle, D::Length, D::Count],
            Quantity::Dq => &[D::AngularVelocity, D::Velocity],
            Quantity::TauM => &[D::Torque, D::Force, D::Current],
            Quantity::TauEl | Quantity::TauExt => &[D::Torque, D::Force],
            Quantity::Temperature => &[D::Temperature],
        };
        self.dimension == D::None || wanted.contains(&self.dimension)
    }
}

/// Power of ten from a time unit to nanoseconds.
pub(crate) fn time_unit_exponent(text: &str) -> Result<i32, String> {
    match text {
        "s" => Ok(9),
        "ms" => Ok(6),
        "us" | "µs" => Ok(3),
        "ns" => Ok(0),
        _ => Err(format!(
            "unknown time unit '{text}': known are s, ms, us, ns"
        )),
    }
}
