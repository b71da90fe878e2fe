//! Units of a test laboratory, as factors to those values are kept in.

use super::TestQuantity;

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Time,
    Force,
    Pressure,
    Length,
    Area,
    /// Ratios: strain, humidity. The factor is to 1.
    Ratio,
    Temperature,
}

/// `kept = raw * factor + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    pub(super) factor: f64,
    pub(super) offset: f64,
    pub(super) kind: Kind,
}

const TABLE: &[(&[&str], f64, f64, Kind)] = &[
    (
        &["s", "sec", "second", "seconds", "Sekunden"],
        1.0,
        0.0,
        Kind::Time,
    ),
    (&["ms"], 1e-3, 0.0, Kind::Time),
    (&["us", "µs", "μs"], 1e-6, 0.0, Kind::Time),
    (&["ns"], 1e-9, 0.0, Kind::Time),
    (&["min", "minute", "minutes"], 60.0, 0.0, Kind::Time),
    (
        &["h", "hr", "hour", "hours", "Std"],
        3600.0,
        0.0,
        Kind::Time,
    ),
    (&["d", "day", "days"], 86_400.0, 0.0, Kind::Time),
    (&["N"], 1.0, 0.0, Kind::Force),
    (&["mN"], 1e-3, 0.0, Kind::Force),
    (&["kN"], 1e3, 0.0, Kind::Force),
    (&["daN"], 10.0, 0.0, Kind::Force),
    (&["cN"], 1e-2, 0.0, Kind::Force),
    // Standard acceleration of free fall, exact by definition.
    (&["kgf", "kp"], 9.806_65, 0.0, Kind::Force),
    (&["gf"], 9.806_65e-3, 0.0, Kind::Force),
    (&["lbf"], 4.448_221_615_260_5, 0.0, Kind::Force),
    (&["Pa"], 1.0, 0.0, Kind::Pressure),
    (&["kPa"], 1e3, 0.0, Kind::Pressure),
    (
        &["MPa", "N/mm2", "N/mm²", "N/mm^2"],
        1e6,
        0.0,
        Kind::Pressure,
    ),
    (&["GPa"], 1e9, 0.0, Kind::Pressure),
    (&["m"], 1.0, 0.0, Kind::Length),
    (&["cm"], 1e-2, 0.0, Kind::Length),
    (&["mm"], 1e-3, 0.0, Kind::Length),
    (&["um", "µm", "μm"], 1e-6, 0.0, Kind::Length),
    (&["in", "inch"], 0.025_4, 0.0, Kind::Length),
    (&["m2", "m²", "m^2"], 1.0, 0.0, Kind::Area),
    (&["cm2", "cm²", "cm^2"], 1e-4, 0.0, Kind::Area),
    (&["mm2", "mm²", "mm^2"], 1e-6, 0.0, Kind::Area),
    (&["1", "-", "m/m", "mm/mm"], 1.0, 0.0, Kind::Ratio),
    (&["%", "pct", "percent", "Prozent"], 1e-2, 0.0, Kind::Ratio),
    (
        &["‰", "permille", "mm/m", "millistrain"],
        1e-3,
        0.0,
        Kind::Ratio,
    ),
    (
        &["microstrain", "µε", "με", "ppm", "µm/m", "um/m"],
        1e-6,
        0.0,
        Kind::Ratio,
    ),
    (
        &["°C", "degC", "C", "deg_C", "℃"],
        1.0,
        0.0,
        Kind::Temperature,
    ),
    (&["K"], 1.0, -273.15, Kind::Temperature),
    (&["°F", "degF"], 5.0 / 9.0, -160.0 / 9.0, Kind::Temperature),
];

/// Finds a unit; the error lists what is known.
pub(super) fn parse(text: &str) -> Result<Unit, String> {
    TABLE
        .iter()
        .find(|(names, ..)| names.contains(&text))
        .map(|&(_, factor, offset, kind)| Unit {
            factor,
            offset,
            kind,
        })
        .ok_or_else(|| {
            let known: Vec<&str> = TABLE.iter().map(|(names, ..)| names[0]).collect();
            format!("unknown unit '{text}'; known are {}", known.join(", "))
        })
}

impl Unit {
    /// Whether a value in this unit can be the quantity.
    pub(super) fn fits(self, quantity: TestQuantity) -> bool {
        let wanted = match quantity {
            TestQuantity::Time => Kind::Time,
            TestQuantity::Force => Kind::Force,
            TestQuantity::Stress | TestQuantity::Modulus => Kind::Pressure,
            TestQuantity::Elongation | TestQuantity::GaugeLength => Kind::Length,
            TestQuantity::Strain | TestQuantity::Humidity => Kind::Ratio,
            TestQuantity::Temperature => Kind::Temperature,
            TestQuantity::Area => Kind::Area,
        };
        self.kind == wanted
    }

    /// A raw value in the unit the quantity is kept in.
    pub(super) fn convert(self, quantity: TestQuantity, raw: f64) -> f64 {
        let value = raw * self.factor + self.offset;
        if quantity == TestQuantity::Humidity {
            100.0 * value
        } else {
            value
        }
    }
}
