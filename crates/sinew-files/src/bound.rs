//! Bounds of numbers, and the units that end their keys.

/// Operating temperatures of robots, °C; a value outside this range indicates another unit or a sensor fault.
pub const WORKS_AT_C: [f64; 2] = [-60.0, 150.0];

/// Permitted range of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// Any finite number.
    Any,
    /// Values above 0.
    Positive,
    /// At least 0.
    NotNegative,
    /// Any finite number but 0.
    NotZero,
    /// Between two ends, which count as inside.
    Within(f64, f64),
}

impl Bound {
    /// Whether `v` is finite and inside.
    pub fn allows(self, v: f64) -> bool {
        v.is_finite()
            && match self {
                Self::Any => true,
                Self::Positive => v > 0.0,
                Self::NotNegative => v >= 0.0,
                Self::NotZero => v != 0.0,
                Self::Within(low, high) => (low..=high).contains(&v),
            }
    }

    /// Returns the requirement for an error message, e.g. `above 0 N·m`.
    #[cfg(any(feature = "toml", feature = "csv"))]
    pub(crate) fn must(self, unit: &str) -> String {
        let text: std::borrow::Cow<'_, str> = match self {
            Self::Any => "a finite number".into(),
            Self::Positive => "above 0".into(),
            Self::NotNegative => "at least 0".into(),
            Self::NotZero => "finite and not zero".into(),
            Self::Within(low, high) => format!("between {low} and {high}").into(),
        };
        match self {
            Self::Any | Self::NotZero => text.into_owned(),
            _ if unit.is_empty() => text.into_owned(),
            _ => format!("{text} {unit}"),
        }
    }
}

/// The unit a key's name ends in, for messages: `motion.pose_rad.elbow` is in rad. Empty: none.
pub fn unit_of(key: &str) -> &'static str {
    // Longer endings first.
    const UNITS: [(&str, &str); 39] = [
        ("_nm_s_per_rad", "N·m·s/rad"),
        ("_mrad_per_k", "mrad/K"),
        ("_nm_per_rad", "N·m/rad"),
        ("_rad_per_k", "rad/K"),
        ("_rad_per_s", "rad/s"),
        ("_nm_per_a", "N·m/A"),
        ("_n_per_mm", "N/mm"),
        ("_per_rad2", "1/rad²"),
        ("_percent", "%"),
        ("_per_rad", "1/rad"),
        ("_g_per_m", "g/m"),
        ("_kg_m2", "kg·m²"),
        ("_per_k", "1/K"),
        ("_per_s", "1/s"),
        ("_m_s2", "m/s²"),
        ("_mrad", "mrad"),
        ("_kpa", "kPa"),
        ("_mpa", "MPa"),
        ("_rad", "rad"),
        ("_deg", "°"),
        ("_min", "min"),
        ("_hz", "Hz"),
        ("_kg", "kg"),
        ("_mm", "mm"),
        ("_ms", "ms"),
        ("_nm", "N·m"),
        ("_ns", "ns"),
        ("_um", "µm"),
        ("_us", "µs"),
        ("_a", "A"),
        ("_c", "°C"),
        ("_d", "d"),
        ("_h", "h"),
        ("_k", "K"),
        ("_m", "m"),
        ("_n", "N"),
        ("_s", "s"),
        ("_j", "J"),
        ("_v", "V"),
    ];
    // `pose_rad.elbow` has its unit before the joint's name, `offsets[0].rad` no word before it.
    let mut parts = key.rsplit('.');
    let last = parts.next().unwrap_or_default();
    let unit = |is: &dyn Fn(&str) -> bool| UNITS.iter().find(|(ending, _)| is(ending));
    unit(&|ending| last.ends_with(ending) || last == &ending[1..])
        .or_else(|| {
            let before = parts.next()?;
            unit(&|ending| before.ends_with(ending))
        })
        .map_or("", |(_, unit)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_those_of_the_names() {
        for (key, unit) in [
            ("joints.elbow.stiffness_nm_per_rad", "N·m/rad"),
            ("joints.elbow.tendon.guides[1].radius_mm", "mm"),
            ("motion.pose_rad.elbow", "rad"),
            ("offsets[0].rad", "rad"),
            ("truth.stiffness_factor", ""),
            ("block[3].duration_min", "min"),
            ("tolerances.drift_mrad_per_k", "mrad/K"),
        ] {
            assert_eq!(unit_of(key), unit, "{key}");
        }
    }
}
