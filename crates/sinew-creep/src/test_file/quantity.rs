//! What a column of a test measures, and in which units.

use sinew_files::unit::{Dimension as D, Unit};

/// What a column of a test measures.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TestQuantity {
    /// Time, s.
    Time,
    /// Force, N.
    Force,
    /// Stress, Pa.
    Stress,
    /// Elongation of the gauge length or grip travel, m.
    Elongation,
    /// Strain, m/m.
    Strain,
    /// Relaxation or creep modulus, Pa.
    Modulus,
    /// Temperature, °C.
    Temperature,
    /// Relative humidity or moisture, %.
    Humidity,
    /// Cross-section, m².
    Area,
    /// Gauge length, m.
    GaugeLength,
}

use TestQuantity as Q;

/// Name in options and messages, unit that values are kept in, unit that a message proposes, dimensions of its units; in the
/// order of [`TestQuantity::ALL`].
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

    /// The name used in options and messages.
    pub fn name(self) -> &'static str {
        TABLE[self as usize].0
    }

    /// The unit values are kept in.
    pub fn unit(self) -> &'static str {
        TABLE[self as usize].1
    }

    /// A customary unit, for messages.
    pub(super) fn customary_unit(self) -> &'static str {
        TABLE[self as usize].2
    }

    /// Whether a value in this unit can be the quantity.
    pub(super) fn may_be_in(self, unit: Unit) -> bool {
        TABLE[self as usize].3.contains(&unit.dimension)
    }

    /// A raw value in the unit the quantity is kept in.
    pub(super) fn convert(self, unit: Unit, raw: f64) -> f64 {
        let percent = if self == Q::Humidity { 100.0 } else { 1.0 };
        percent * (raw * unit.factor + unit.offset)
    }
}

impl std::str::FromStr for TestQuantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Q::ALL.map(TestQuantity::name);
        let found = Q::ALL.into_iter().find(|quantity| quantity.name() == text);
        found.ok_or_else(|| format!("unknown quantity '{text}'; known are {}", known.join(", ")))
    }
}

/// Finds a unit; the error lists what is known.
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
