//! Warnings about the validity of a prediction.

use crate::law::tested_range::TestedRange;
use crate::law::validity::LimitViolation;
use serde::{Deserialize, Serialize};

/// Warning about the validity of a prediction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Caution {
    /// Tension below the range of the creep law.
    LowLoad,
    /// Tension above the range of the creep law.
    HighLoad,
    /// HMPE above the temperature range in which its flow was measured.
    Hot,
    /// Breaking load that is not published.
    BreakingLoadAssumed {
        /// Assumed breaking load, N.
        breaking_load_n: f64,
    },
    /// Extrapolation of assumed parameters beyond a day.
    Extrapolated {
        /// Duration of the longest test, s.
        tests_s: f64,
    },
    /// Creep rupture; there are no elongations after it.
    CreepsApart {
        /// Time of the break at the catalogue values, s.
        time_s: f64,
    },
    /// Bending fatigue up to a break; there are no elongations after it.
    WornOut {
        /// Time of the break at the catalogue values, s.
        time_s: f64,
    },
    /// Strain above the manufacturer's discard strain.
    Replace {
        /// Discard strain since new, m/m.
        strain_ratio: f64,
        /// First requested time at which the central estimate exceeds the discard strain, s; `None`: only
        /// draws do.
        time_s: Option<f64>,
        /// Share of the draws that exceed it, or are broken, at the last requested time, 0 to 1.
        share: f64,
    },
    /// Pulley diameter below the manufacturers' advice.
    TightBend {
        /// Ratio of bend diameter to rope diameter.
        bend_ratio: f64,
        /// Smallest advised ratio.
        min_ratio: f64,
    },
    /// Load above the manufacturers' advice.
    LoadShare {
        /// Ratio of largest tension to breaking load, 0 to 1.
        load_share: f64,
        /// Largest advised ratio, 0 to 1.
        max_share: f64,
    },
    /// Termination not specified; assumed as strong as the rope.
    TerminationNotSpecified {
        /// Share of the strength that a splice retains, 0 to 1.
        splice_share: f64,
        /// Share of the strength that a knot retains, 0 to 1.
        knot_share: f64,
    },
    /// Duty outside the tested range of the rope; intervals are widened.
    BeyondData {
        /// Tested range of the rope.
        tested_range: TestedRange,
        /// Mean and largest tension of the duty over the breaking load.
        load_share: [f64; 2],
        /// Lowest and highest temperature of the duty, °C.
        temperature_c: [f64; 2],
        /// Longest requested time, s.
        duration_s: f64,
        /// Factor of the widening at that time, up and down (95 %).
        factor: f64,
    },
    /// Parameters that are assumed, not measured.
    AssumedParameters {
        /// Number of assumed parameters.
        assumed: usize,
        /// Number of creep law parameters.
        parameters: usize,
    },
}

impl Caution {
    /// Warnings for the validity limits that a load violates.
    pub(super) fn outside(outside: LimitViolation) -> Vec<Caution> {
        [
            (outside.low_load, Caution::LowLoad),
            (outside.high_load, Caution::HighLoad),
            (outside.hot, Caution::Hot),
        ]
        .into_iter()
        .filter_map(|(outside, caution)| outside.then_some(caution))
        .collect()
    }
}
