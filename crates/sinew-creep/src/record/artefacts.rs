//! Artefacts of a record and their removal.

use super::Stage;
use crate::artefacts::find_artefacts;
use crate::curve::Curve;
use serde::{Deserialize, Serialize};

/// Artefact of a record; times are those of the record, s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Artefact {
    /// Strain step under constant load: grip slip.
    Slip {
        /// Time of the step, s.
        time_s: f64,
        /// Height of the step, m/m.
        strain_ratio: f64,
        /// Whether it was kept in the measurements.
        kept: bool,
    },
    /// Single outlier of the strain.
    Outlier {
        /// Time of the outlier, s.
        time_s: f64,
        /// Whether it was kept in the measurements.
        kept: bool,
    },
    /// Load drift on a plateau beyond the limit of ISO 899-1 (1 %).
    LoadDrift {
        /// Start of the plateau, s.
        time_s: f64,
        /// Median of the load, N.
        load_n: f64,
        /// Largest deviation from the median, as a share of it.
        drift_share: f64,
    },
    /// Missing force: a constant load from the first measurement on is assumed.
    NoForce,
    /// Record that starts under load, without ramp and zero.
    NoRamp,
    /// Load ramp slower than 5 s.
    SlowRamp {
        /// Start of the ramp, s.
        time_s: f64,
        /// Duration of the ramp, s.
        ramp_s: f64,
    },
    /// Measurements with duplicate time stamps under one load; all are used.
    DuplicateTimestamps {
        /// Number of such measurements.
        readings: usize,
    },
    /// Measurements older than the previous one; rejected.
    NonMonotonicTime {
        /// Number of such measurements.
        readings: usize,
    },
    /// Missing or non-finite measurements; rejected.
    Gap {
        /// Number of such measurements.
        readings: usize,
    },
    /// Measurements on straight lines between others, to the rounding of the file: interpolated, not measured.
    Interpolated {
        /// Number of such measurements.
        readings: usize,
        /// Number of the other measurements.
        recorded: usize,
        /// Whether they were kept in the measurements.
        kept: bool,
    },
    /// Possible strain that suggests another unit.
    ImplausibleStrain {
        /// Largest strain, m/m.
        strain_ratio: f64,
    },
    /// Rope that is shorter under load than before it.
    Shortens {
        /// Strain at the end of the first stage, m/m.
        strain_ratio: f64,
    },
    /// Possible duration that suggests another unit of time.
    ImplausibleTime {
        /// Duration of the record, s.
        duration_s: f64,
    },
}

impl Artefact {
    /// Time of the artefact, s of the record, if it has one.
    pub fn time_s(&self) -> Option<f64> {
        match *self {
            Artefact::Slip { time_s, .. }
            | Artefact::Outlier { time_s, .. }
            | Artefact::LoadDrift { time_s, .. }
            | Artefact::SlowRamp { time_s, .. } => Some(time_s),
            _ => None,
        }
    }
}

/// Indices of measurements with non-decreasing time stamps; duplicates are kept, because the fit
/// weights them.
pub(super) fn clean(
    time: &[f64],
    strain: &[f64],
    force: Option<&[f64]>,
    artefacts: &mut Vec<Artefact>,
) -> Vec<usize> {
    let (mut kept, mut gaps, mut back) = (Vec::new(), 0, 0);
    let mut latest = f64::NEG_INFINITY;
    for i in 0..time.len() {
        let whole = time[i].is_finite()
            && strain[i].is_finite()
            && force.is_none_or(|force| force[i].is_finite());
        if !whole {
            gaps += 1;
        } else if time[i] < latest {
            back += 1;
        } else {
            latest = time[i];
            kept.push(i);
        }
    }
    let found = [
        (gaps, Artefact::Gap { readings: gaps }),
        (back, Artefact::NonMonotonicTime { readings: back }),
    ];
    artefacts.extend(
        found
            .iter()
            .filter(|(n, _)| *n > 0)
            .map(|(_, artefact)| *artefact),
    );
    kept
}

/// Removes steps and outliers from every stage, and returns them.
pub(super) fn remove_artefacts(
    curve: &mut Curve,
    stages: &[Stage],
    keep: bool,
    start: f64,
) -> Vec<Artefact> {
    let mut artefacts = Vec::new();
    let mut drop = Vec::new();
    for stage in stages {
        let from = curve.time_s.partition_point(|t| *t < stage.start_s);
        let to = curve.time_s.partition_point(|t| *t <= stage.end_s);
        if to <= from {
            continue;
        }
        let short = (1e-3 * (stage.end_s - stage.start_s)).max(1e-9);
        let place: Vec<f64> = curve.time_s[from..to]
            .iter()
            .map(|t| (t - stage.start_s + short).ln())
            .collect();
        let found_artefacts = find_artefacts(&place, &curve.strain[from..to]);
        for (index, height) in found_artefacts.jumps {
            let time_s = curve.time_s[from + index] + start;
            artefacts.push(Artefact::Slip {
                time_s,
                strain_ratio: height,
                kept: keep,
            });
            if !keep {
                curve.strain[from + index..]
                    .iter_mut()
                    .for_each(|e| *e -= height);
            }
        }
        for index in found_artefacts.outliers {
            let time_s = curve.time_s[from + index] + start;
            artefacts.push(Artefact::Outlier { time_s, kept: keep });
            drop.push(from + index);
        }
    }
    if !keep {
        curve.select(|i| !drop.contains(&i));
    }
    artefacts
}
