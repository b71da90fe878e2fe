//! Units that a file may name, as factors to SI.

use std::f64::consts::PI;

/// Physical dimension of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Time, in SI units s.
    Time,
    /// Angle, in SI units rad.
    Angle,
    /// Length, in SI units m.
    Length,
    /// Area, in SI units m².
    Area,
    /// Speeds of rotation, rad/s.
    AngularVelocity,
    /// Velocity, in SI units m/s.
    Velocity,
    /// Torque, in SI units N·m.
    Torque,
    /// Force, in SI units N.
    Force,
    /// Pressures and stresses, Pa.
    Pressure,
    /// Electric currents, A.
    Current,
    /// Temperatures; the factor is to °C.
    Temperature,
    /// Counts of an encoder.
    Count,
    /// Strain, humidity. The factor is to 1.
    Ratio,
    /// Number that needs no conversion.
    One,
}

/// A unit: `si = raw * factor + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Factor to SI.
    pub factor: f64,
    /// Offset added after the factor, in SI units.
    pub offset: f64,
    /// Physical dimension of the unit.
    pub dimension: Dimension,
}

use Dimension as D;

const TABLE: &[(&[&str], f64, f64, Dimension)] = &[
    (&["1"], 1.0, 0.0, D::One),
    (&["rad"], 1.0, 0.0, D::Angle),
    (&["mrad"], 1e-3, 0.0, D::Angle),
    (
        &["deg", "°", "degree", "degrees", "Grad"],
        PI / 180.0,
        0.0,
        D::Angle,
    ),
    (&["turn", "rev"], 2.0 * PI, 0.0, D::Angle),
    (&["count"], 1.0, 0.0, D::Count),
    (&["rad/s"], 1.0, 0.0, D::AngularVelocity),
    (&["deg/s", "°/s"], PI / 180.0, 0.0, D::AngularVelocity),
    (&["turn/s", "rev/s"], 2.0 * PI, 0.0, D::AngularVelocity),
    (&["rpm"], 2.0 * PI / 60.0, 0.0, D::AngularVelocity),
    (&["m/s"], 1.0, 0.0, D::Velocity),
    (&["mm/s"], 1e-3, 0.0, D::Velocity),
    (
        &[
            "s", "sec", "secs", "second", "seconds", "Sek", "Sek.", "Sekunden",
        ],
        1.0,
        0.0,
        D::Time,
    ),
    (&["ms", "msec"], 1e-3, 0.0, D::Time),
    (&["us", "µs", "μs", "usec"], 1e-6, 0.0, D::Time),
    (&["ns", "nsec"], 1e-9, 0.0, D::Time),
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

/// Name of a unit without brackets around it: `s` of `(s)` and of `[s]`.
pub fn bare(text: &str) -> &str {
    let text = text.trim();
    let pairs = [('(', ')'), ('[', ']'), ('<', '>')];
    let inner = pairs
        .iter()
        .find_map(|(open, close)| text.strip_prefix(*open)?.strip_suffix(*close));
    inner.map_or(text, str::trim)
}

impl Dimension {
    /// Dimensions of all units.
    pub const ALL: [Dimension; 14] = [
        D::Time,
        D::Angle,
        D::Length,
        D::Area,
        D::AngularVelocity,
        D::Velocity,
        D::Torque,
        D::Force,
        D::Pressure,
        D::Current,
        D::Temperature,
        D::Count,
        D::Ratio,
        D::One,
    ];
}

impl Unit {
    /// Unit of numbers that need no conversion.
    pub const SI: Unit = Unit {
        factor: 1.0,
        offset: 0.0,
        dimension: D::One,
    };

    /// Finds a unit of one of these dimensions by its name.
    ///
    /// # Errors
    /// Returns a sentence that lists the valid units.
    pub fn parse(text: &str, dimensions: &[Dimension]) -> Result<Unit, String> {
        let mut candidates = TABLE.iter().filter(|unit| dimensions.contains(&unit.3));
        let found = candidates.clone().find(|(names, ..)| names.contains(&text));
        let unit = found.map(|&(_, factor, offset, dimension)| Unit {
            factor,
            offset,
            dimension,
        });
        unit.ok_or_else(|| {
            let first = |(names, ..): &(&[&'static str], f64, f64, Dimension)| names[0];
            let names: Vec<&str> = candidates.by_ref().map(first).collect();
            format!("unknown unit '{text}'; valid units: {}", names.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Definition of each unit, written independently of the table: dimension, SI values of 0 and of 1 (degrees Celsius
    /// for temperatures), names.
    const BY_DEFINITION: &[(Dimension, f64, f64, &str)] = &[
        (D::One, 0.0, 1.0, "1"),
        (D::Angle, 0.0, 1.0, "rad"),
        (D::Angle, 0.0, 0.001, "mrad"),
        (
            D::Angle,
            0.0,
            0.017_453_292_519_943_295,
            "deg, °, degree, degrees, Grad",
        ),
        (
            D::Angle,
            0.0,
            360.0 * 0.017_453_292_519_943_295,
            "turn, rev",
        ),
        (D::Count, 0.0, 1.0, "count"),
        (D::AngularVelocity, 0.0, 1.0, "rad/s"),
        (
            D::AngularVelocity,
            0.0,
            0.017_453_292_519_943_295,
            "deg/s, °/s",
        ),
        (
            D::AngularVelocity,
            0.0,
            360.0 * 0.017_453_292_519_943_295,
            "turn/s, rev/s",
        ),
        (D::AngularVelocity, 0.0, 0.104_719_755_119_659_77, "rpm"),
        (D::Velocity, 0.0, 1.0, "m/s"),
        (D::Velocity, 0.0, 0.001, "mm/s"),
        (
            D::Time,
            0.0,
            1.0,
            "s, sec, secs, second, seconds, Sek, Sek., Sekunden",
        ),
        (D::Time, 0.0, 0.001, "ms, msec"),
        // The sign of micro and the Greek letter.
        (D::Time, 0.0, 0.000_001, "us, \u{b5}s, \u{3bc}s, usec"),
        (D::Time, 0.0, 0.000_000_001, "ns, nsec"),
        (D::Time, 0.0, 60.0, "min, minute, minutes"),
        (D::Time, 0.0, 3600.0, "h, hr, hour, hours, Std"),
        (D::Time, 0.0, 86_400.0, "d, day, days"),
        (D::Length, 0.0, 1.0, "m"),
        (D::Length, 0.0, 0.01, "cm"),
        (D::Length, 0.0, 0.001, "mm"),
        (D::Length, 0.0, 0.000_001, "um, \u{b5}m, \u{3bc}m"),
        (D::Length, 0.0, 0.025_4, "in, inch"),
        (D::Area, 0.0, 1.0, "m2, m², m^2"),
        (D::Area, 0.0, 0.000_1, "cm2, cm², cm^2"),
        (D::Area, 0.0, 0.000_001, "mm2, mm², mm^2"),
        (D::Torque, 0.0, 1.0, "N·m, Nm, N*m, N m"),
        (D::Torque, 0.0, 0.001, "N·mm, Nmm, N*mm, mN·m, mNm, mN*m"),
        (D::Torque, 0.0, 1000.0, "kN·m, kNm"),
        (D::Force, 0.0, 1.0, "N"),
        (D::Force, 0.0, 0.001, "mN"),
        (D::Force, 0.0, 0.01, "cN"),
        (D::Force, 0.0, 10.0, "daN"),
        (D::Force, 0.0, 1000.0, "kN"),
        (D::Force, 0.0, 9.806_65, "kgf, kp"),
        (D::Force, 0.0, 0.009_806_65, "gf"),
        (D::Force, 0.0, 4.448_221_615_260_5, "lbf"),
        (D::Pressure, 0.0, 1.0, "Pa"),
        (D::Pressure, 0.0, 1000.0, "kPa"),
        (D::Pressure, 0.0, 1_000_000.0, "MPa, N/mm2, N/mm², N/mm^2"),
        (D::Pressure, 0.0, 1_000_000_000.0, "GPa"),
        (D::Current, 0.0, 1.0, "A"),
        (D::Current, 0.0, 0.001, "mA"),
        (D::Temperature, 0.0, 1.0, "°C, degC, C, deg_C, ℃"),
        (D::Temperature, -273.15, -272.15, "K"),
        // Freezing is 32 °F, boiling 212 °F.
        (
            D::Temperature,
            -17.777_777_777_777_78,
            -17.222_222_222_222_22,
            "°F, degF",
        ),
        (D::Ratio, 0.0, 1.0, "-, m/m, mm/mm"),
        (D::Ratio, 0.0, 0.01, "%, pct, percent, Prozent"),
        (D::Ratio, 0.0, 0.001, "‰, permille, mm/m, millistrain"),
        (
            D::Ratio,
            0.0,
            0.000_001,
            "microstrain, \u{b5}ε, \u{3bc}ε, ppm, \u{b5}m/m, um/m",
        ),
    ];

    #[test]
    fn parsed_units_match_definitions() {
        let mut expected = Vec::new();
        for &(dimension, zero, one, names) in BY_DEFINITION {
            for name in names.split(", ") {
                let unit = Unit::parse(name, &[dimension]).expect("read");
                let si = |raw: f64| raw * unit.factor + unit.offset;
                for (raw, value) in [(0.0, zero), (1.0, one)] {
                    // A factor and an offset, each rounded to 1e-16 of at most 300 K.
                    let off = (si(raw) - value).abs();
                    assert!(
                        off <= 1e-14 * value.abs(),
                        "{name}: {raw} is {} {value}",
                        si(raw)
                    );
                }
                expected.push((name, dimension as usize));
            }
        }
        let names = |(names, _, _, dimension): &(&[&'static str], f64, f64, Dimension)| {
            let dimension = *dimension as usize;
            names
                .iter()
                .map(|name| (*name, dimension))
                .collect::<Vec<_>>()
        };
        let mut read: Vec<(&str, usize)> = TABLE.iter().flat_map(names).collect();
        read.sort();
        expected.sort();
        assert_eq!(read, expected, "each unit that is read stands here once");
    }
}
