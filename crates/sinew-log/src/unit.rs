//! Units that a file may name, as factors to SI.

use std::f64::consts::PI;

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    Time,
    Angle,
    Length,
    Area,
    AngularVelocity,
    Velocity,
    Torque,
    Force,
    Pressure,
    Current,
    /// The factor is to °C.
    Temperature,
    Count,
    /// Strain, humidity. The factor is to 1.
    Ratio,
    /// A number that is in SI as it stands.
    One,
}

/// A unit: `si = raw * factor + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    pub(crate) factor: f64,
    pub(crate) offset: f64,
    pub(crate) dimension: Dimension,
}

use Dimension as D;

const TABLE: &[(&[&str], f64, f64, Dimension)] = &[
    (&["1"], 1.0, 0.0, D::One),
    (&["rad"], 1.0, 0.0, D::Angle),
    (&["mrad"], 1e-3, 0.0, D::Angle),
    (&["deg", "°"], PI / 180.0, 0.0, D::Angle),
    (&["turn", "rev"], 2.0 * PI, 0.0, D::Angle),
    (&["count"], 1.0, 0.0, D::Count),
    (&["rad/s"], 1.0, 0.0, D::AngularVelocity),
    (&["deg/s", "°/s"], PI / 180.0, 0.0, D::AngularVelocity),
    (&["turn/s", "rev/s"], 2.0 * PI, 0.0, D::AngularVelocity),
    (&["rpm"], 2.0 * PI / 60.0, 0.0, D::AngularVelocity),
    (&["m/s"], 1.0, 0.0, D::Velocity),
    (&["mm/s"], 1e-3, 0.0, D::Velocity),
    (
        &["s", "sec", "second", "seconds", "Sekunden"],
        1.0,
        0.0,
        D::Time,
    ),
    (&["ms"], 1e-3, 0.0, D::Time),
    (&["us", "µs", "μs"], 1e-6, 0.0, D::Time),
    (&["ns"], 1e-9, 0.0, D::Time),
    (&["min", "minute", "minutes"], 60.0, 0.0, D::Time),
    (&["h", "hr", "hour", "hours", "Std"], 3600.0, 0.0, D::Time),
    (&["d", "day", "days"], 86_400.0, 0.0, D::Time),
    (&["m"], 1.0, 0.0, D::Length),
    (&["mm"], 1e-3, 0.0, D::Length),
    (&["um", "µm", "μm"], 1e-6, 0.0, D::Length),
    (&["cm"], 1e-2, 0.0, D::Length),
    (&["in", "inch"], 0.025_4, 0.0, D::Length),
    (&["m2", "m²", "m^2"], 1.0, 0.0, D::Area),
    (&["cm2", "cm²", "cm^2"], 1e-4, 0.0, D::Area),
    (&["mm2", "mm²", "mm^2"], 1e-6, 0.0, D::Area),
    (&["N·m", "Nm", "N*m", "N m"], 1.0, 0.0, D::Torque),
    (
        &["N·mm", "Nmm", "N*mm", "mN·m", "mNm", "mN*m"],
        1e-3,
        0.0,
        D::Torque,
    ),
    (&["kN·m", "kNm"], 1e3, 0.0, D::Torque),
    (&["N"], 1.0, 0.0, D::Force),
    (&["mN"], 1e-3, 0.0, D::Force),
    (&["kN"], 1e3, 0.0, D::Force),
    (&["daN"], 10.0, 0.0, D::Force),
    (&["cN"], 1e-2, 0.0, D::Force),
    // Standard acceleration of free fall, exact by definition.
    (&["kgf", "kp"], 9.806_65, 0.0, D::Force),
    (&["gf"], 9.806_65e-3, 0.0, D::Force),
    (&["lbf"], 4.448_221_615_260_5, 0.0, D::Force),
    (&["Pa"], 1.0, 0.0, D::Pressure),
    (&["kPa"], 1e3, 0.0, D::Pressure),
    (&["MPa", "N/mm2", "N/mm²", "N/mm^2"], 1e6, 0.0, D::Pressure),
    (&["GPa"], 1e9, 0.0, D::Pressure),
    (&["A"], 1.0, 0.0, D::Current),
    (&["mA"], 1e-3, 0.0, D::Current),
    (&["°C", "degC", "C", "deg_C", "℃"], 1.0, 0.0, D::Temperature),
    (&["K"], 1.0, -273.15, D::Temperature),
    (&["°F", "degF"], 5.0 / 9.0, -160.0 / 9.0, D::Temperature),
    (&["-", "m/m", "mm/mm"], 1.0, 0.0, D::Ratio),
    (&["%", "pct", "percent", "Prozent"], 1e-2, 0.0, D::Ratio),
    (
        &["‰", "permille", "mm/m", "millistrain"],
        1e-3,
        0.0,
        D::Ratio,
    ),
    (
        &["microstrain", "µε", "με", "ppm", "µm/m", "um/m"],
        1e-6,
        0.0,
        D::Ratio,
    ),
];

impl Unit {
    pub(crate) const SI: Unit = Unit {
        factor: 1.0,
        offset: 0.0,
        dimension: D::One,
    };

    /// Finds a unit of one of these dimensions by its name; the error lists what is known.
    pub(crate) fn parse(text: &str, dimensions: &[Dimension]) -> Result<Unit, String> {
        let mut known = TABLE.iter().filter(|unit| dimensions.contains(&unit.3));
        let found = known.clone().find(|(names, ..)| names.contains(&text));
        let unit = found.map(|&(_, factor, offset, dimension)| Unit {
            factor,
            offset,
            dimension,
        });
        unit.ok_or_else(|| {
            let first = |(names, ..): &(&[&'static str], f64, f64, Dimension)| names[0];
            let known: Vec<&str> = known.by_ref().map(first).collect();
            format!("unknown unit '{text}'; known are {}", known.join(", "))
        })
    }
}
