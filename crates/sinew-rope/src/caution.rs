//! What to be careful about in a prediction.

use crate::law::holds::Holds;
use crate::law::validity::Outside;
use serde::{Deserialize, Serialize};

/// Something to be careful about.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Caution {
    /// Tension below the range the law was made for.
    LowLoad,
    /// Tension above it.
    HighLoad,
    /// HMPE hotter than its flow was measured.
    Hot,
    /// The breaking load is not published.
    BreakingLoadGuessed {
        /// Starting guess taken, N.
        breaking_load_n: f64,
    },
    /// Starting guesses, held against short tests, asked for more than a day.
    Extrapolated {
        /// Length of the longest of those tests, s.
        tests_s: f64,
    },
    /// The rope creeps until it breaks; there is no reading from then on.
    CreepsApart {
        /// When, at the catalogue's values, s.
        time_s: f64,
    },
    /// Bending wears the rope out; there is no reading from then on.
    WornOut {
        /// When, at the catalogue's values, s.
        time_s: f64,
    },
    /// The rope stretches beyond the strain at which its maker says to replace it.
    Replace {
        /// That strain since it was new, m/m.
        strain_ratio: f64,
        /// The first time asked for at which the middle lies beyond it, s; `None`: only draws do.
        time_s: Option<f64>,
        /// Share of the draws that lie beyond it, or are broken, at the last time asked for, 0 to 1.
        share: f64,
    },
    /// A pulley bends the rope closer than makers advise.
    TightBend {
        /// Diameter that the rope is bent to, over its own.
        bend_ratio: f64,
        /// Advised at least.
        least_ratio: f64,
    },
    /// More load than makers advise.
    LoadShare {
        /// Largest tension over the breaking load.
        load_share: f64,
        /// Advised at most.
        most_share: f64,
    },
    /// The ends are taken to be as strong as the rope.
    EndsNotStated {
        /// Share of the strength that a splice keeps.
        splice_share: f64,
        /// Share of the strength that a knot keeps.
        knot_share: f64,
    },
    /// The duty goes beyond the data behind the rope's values; intervals are widened.
    BeyondData {
        /// The data.
        holds: Holds,
        /// Mean and largest tension of the duty over the breaking load.
        load_share: [f64; 2],
        /// Lowest and highest temperature, °C.
        temperature_c: [f64; 2],
        /// Longest time asked for, s.
        duration_s: f64,
        /// Factor up and down that 95 % of the widening reaches at that time.
        factor: f64,
    },
    /// Parameters are starting guesses.
    StartingGuesses {
        /// How many.
        guesses: usize,
        /// Of all.
        parameters: usize,
    },
}

impl Caution {
    /// Limits of the law's validity that a load lies outside of.
    pub(super) fn outside(outside: Outside) -> Vec<Caution> {
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
