//! What is odd about a record, and what is done about it.

use super::Stage;
use crate::curve::Curve;
use crate::scan::oddities;
use serde::{Deserialize, Serialize};

/// What is odd about a record. Times are those of the record, s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Fault {
    /// The strain jumps under constant load: a grip slips.
    Slip {
        /// When.
        time_s: f64,
        /// Height of the jump, m/m.
        strain_ratio: f64,
        /// Whether it was left in the readings.
        kept: bool,
    },
    /// One reading stands apart.
    Outlier {
        /// When.
        time_s: f64,
        /// Whether it was left in the readings.
        kept: bool,
    },
    /// The load on a plateau changes by more than ISO 899-1 allows (1 %).
    LoadDrift {
        /// Start of the plateau.
        time_s: f64,
        /// Median of the load, N.
        load_n: f64,
        /// Largest distance from there, as a share of it.
        drift_share: f64,
    },
    /// No force is recorded: a constant load from the first reading on is assumed.
    NoForce,
    /// The record starts under load: neither ramp nor zero are in it.
    NoRamp,
    /// The load came on slower than within 5 s.
    SlowRamp {
        /// When.
        time_s: f64,
        /// How long it took, s.
        ramp_s: f64,
    },
    /// Readings that repeat the stamp before; all are used.
    RepeatedStamps {
        /// How many.
        readings: usize,
    },
    /// Readings that are older than the one before; left out.
    ClockGoesBack {
        /// How many.
        readings: usize,
    },
    /// Readings that are missing or no numbers; left out.
    Gap {
        /// How many.
        readings: usize,
    },
    /// A strain that is possible, but looks like another unit.
    DoubtfulStrain {
        /// Largest strain, m/m.
        strain_ratio: f64,
    },
    /// The rope is shorter under load than before it.
    Shortens {
        /// Strain at the end of the first stage, m/m.
        strain_ratio: f64,
    },
    /// A length of the record that is possible, but looks like another unit.
    DoubtfulTime {
        /// Length, s.
        duration_s: f64,
    },
}

impl Fault {
    /// When, s of the record, where it has a time.
    pub fn time_s(&self) -> Option<f64> {
        match *self {
            Fault::Slip { time_s, .. }
            | Fault::Outlier { time_s, .. }
            | Fault::LoadDrift { time_s, .. }
            | Fault::SlowRamp { time_s, .. } => Some(time_s),
            _ => None,
        }
    }
}

/// Readings with rising stamps; repeated stamps stay, for the fit weighs them.
pub(super) fn clean(
    time: &[f64],
    strain: &[f64],
    force: Option<&[f64]>,
    faults: &mut Vec<Fault>,
) -> Vec<usize> {
    let (mut kept, mut gaps, mut back, mut repeated) = (Vec::new(), 0, 0, 0);
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
            repeated += usize::from(time[i] == latest);
            latest = time[i];
            kept.push(i);
        }
    }
    let found = [
        (gaps, Fault::Gap { readings: gaps }),
        (back, Fault::ClockGoesBack { readings: back }),
        (repeated, Fault::RepeatedStamps { readings: repeated }),
    ];
    faults.extend(
        found
            .iter()
            .filter(|(n, _)| *n > 0)
            .map(|(_, fault)| *fault),
    );
    kept
}

/// Takes jumps and outliers out of every stage, and says so.
pub(super) fn take_out_faults(
    curve: &mut Curve,
    stages: &[Stage],
    keep: bool,
    start: f64,
) -> Vec<Fault> {
    let mut faults = Vec::new();
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
        let odd = oddities(&place, &curve.strain[from..to]);
        for (index, height) in odd.jumps {
            let time_s = curve.time_s[from + index] + start;
            faults.push(Fault::Slip {
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
        for index in odd.outliers {
            let time_s = curve.time_s[from + index] + start;
            faults.push(Fault::Outlier { time_s, kept: keep });
            drop.push(from + index);
        }
    }
    if !keep {
        let mut i = 0;
        let mut keep_reading = || {
            i += 1;
            !drop.contains(&(i - 1))
        };
        let kept: Vec<bool> = curve.time_s.iter().map(|_| keep_reading()).collect();
        let filter = |v: &[f64]| -> Vec<f64> {
            v.iter()
                .zip(&kept)
                .filter(|(_, k)| **k)
                .map(|(v, _)| *v)
                .collect()
        };
        curve.time_s = filter(&curve.time_s);
        curve.strain = filter(&curve.strain);
        curve.count = filter(&curve.count);
    }
    faults
}
