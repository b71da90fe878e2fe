//! Quantities of test columns, and their units.

use sinew_files::unit::{Dimension as D, Unit};

/// Quantity of a test column.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TestQuantity {
    /// Time since the start, s.
    Time,
    /// Tensile force, N.
    Force,
    /// Tensile stress, Pa.
    Stress,
    /// Elongation of the gauge length or grip travel, m.
    Elongation,
    /// Strain of the specimen, m/m.
    Strain,
    /// Relaxation or creep modulus, Pa.
    Modulus,
    /// Temperature of the test, °C.
    Temperature,
    /// Relative humidity or moisture, %.
    Humidity,
    /// Cross-section of the specimen, m².
    Area,
    /// Gauge length of the specimen, m.
    GaugeLength,
}

use TestQuantity as Q;

/// Name in options and messages, internal unit, unit proposed in messages, dimensions of its units;
/// in the order of [`TestQuantity::ALL`].
const TABLE: [(&str, &str, &str, &[D]); 10] = [
    ("time", "s", "s", &[D::Time]),
    ("force", "N", "N", &[D::Force]),
    ("stress", "Pa", "MPa", &[D::Pressure]),
    ("elongation", "m", "mm", &[D::Length]),
    ("strain", "m/m", "m/m", &[D::Ratio, D::One]),
    ("modulus", "Pa", "MPa", &[D::Pressure]),
    ("temperature", "°C", "°C", &[D::Temperature]),
    ("humidity", "%", "%", &[D::Ratio, D::One]),
    ("area", "m²", "mm2", &[D::Area]),
    ("gauge-length", "m", "mm", &[D::Length]),
];

impl TestQuantity {
    /// All quantities, in the order of their columns.
    pub const ALL: [Q; 10] = [
        Q::Time,
        Q::Force,
        Q::Stress,
        Q::Elongation,
        Q::Strain,
        Q::Modulus,
        Q::Temperature,
        Q::Humidity,
        Q::Area,
        Q::GaugeLength,
    ];

    /// Name in options and messages.
    pub fn name(self) -> &'static str {
        TABLE[self as usize].0
    }

    /// Internal unit of the values.
    pub fn unit(self) -> &'static str {
        TABLE[self as usize].1
    }

    /// Customary unit for messages.
    pub(super) fn customary_unit(self) -> &'static str {
        TABLE[self as usize].2
    }

    /// Whether a unit is possible for the quantity.
    pub(super) fn may_be_in(self, unit: Unit) -> bool {
        TABLE[self as usize].3.contains(&unit.dimension)
    }

    /// Converts a raw value to the internal unit of the quantity.
    pub(super) fn convert(self, unit: Unit, raw: f64) -> f64 {
        let percent = if self == Q::Humidity { 100.0 } else { 1.0 };
        percent * (raw * unit.factor + unit.offset)
    }
}

impl std::str::FromStr for TestQuantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = Q::ALL.map(TestQuantity::name);
        let found = Q::ALL.into_iter().find(|quantity| quantity.name() == text);
        found.ok_or_else(|| format!("unknown quantity '{text}'; available: {}", names.join(", ")))
    }
}

/// Parses a unit; the error lists the available ones.
pub(super) fn parse_unit(text: &str) -> Result<Unit, String> {
    const DIMENSIONS: [D; 8] = [
        D::One,
        D::Time,
        D::Force,
        D::Pressure,
        D::Length,
        D::Area,
        D::Ratio,
        D::Temperature,
    ];
    Unit::parse(text, &DIMENSIONS)
}
