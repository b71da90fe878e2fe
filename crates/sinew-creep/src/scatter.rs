//! Scatter between repeats in a group.

use super::analyze::Analysis;
use super::artefacts::median;
use serde::{Deserialize, Serialize};

/// Mean and scatter of repeats.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scatter {
    /// Name of the group; `None` for specimens without a group.
    pub group: Option<String>,
    /// Number of specimens.
    pub specimens: usize,
    /// Mean strain at the end, m/m.
    pub end_strain_ratio: f64,
    /// Standard deviation of the end strain between specimens, m/m; `None` for one.
    pub end_std_ratio: Option<f64>,
    /// Mean slope of the strain, 1/s.
    pub slope_per_s: Option<f64>,
    /// Standard deviation of the slope between specimens, 1/s.
    pub slope_std_per_s: Option<f64>,
    /// Outlying specimens, whose end strain is more than 3.5 robust standard deviations from the
    /// median of their group.
    pub apart: Vec<String>,
}

/// Analyses by group, groups in the order of their first appearance.
pub(super) fn by_group<'a>(
    analyses: impl IntoIterator<Item = &'a Analysis>,
) -> Vec<(Option<&'a str>, Vec<&'a Analysis>)> {
    let mut groups: Vec<(Option<&str>, Vec<&Analysis>)> = Vec::new();
    for analysis in analyses {
        let group = analysis.group.as_deref();
        match groups.iter_mut().find(|(name, _)| *name == group) {
            Some((_, members)) => members.push(analysis),
            None => groups.push((group, vec![analysis])),
        }
    }
    groups
}

/// Scatter of the specimens of each group, in the order of their first appearance.
pub fn scatter<'a>(analyses: impl IntoIterator<Item = &'a Analysis>) -> Vec<Scatter> {
    /// Outlier threshold in robust standard deviations (Iglewicz and Hoaglin, How to Detect and
    /// Handle Outliers, 1993).
    const OUTLIER_THRESHOLD_STDS: f64 = 3.5;
    let moments = |values: &[f64]| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let std = (values.len() > 1)
            .then(|| (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt());
        (mean, std)
    };
    by_group(analyses)
        .into_iter()
        .map(|(group, members)| {
            let ends: Vec<f64> = members.iter().map(|a| a.end_strain_ratio).collect();
            let slopes: Vec<f64> = members
                .iter()
                .filter_map(|a| a.slope_per_s.map(|s| s.value))
                .collect();
            let (end_strain_ratio, end_std_ratio) = moments(&ends);
            let centre = median(&ends);
            let distance: Vec<f64> = ends.iter().map(|e| (e - centre).abs()).collect();
            let robust = 1.482_6 * median(&distance);
            Scatter {
                group: group.map(str::to_owned),
                specimens: members.len(),
                end_strain_ratio,
                end_std_ratio,
                slope_per_s: (!slopes.is_empty()).then(|| moments(&slopes).0),
                slope_std_per_s: moments(&slopes).1.filter(|_| !slopes.is_empty()),
                apart: members
                    .iter()
                    .zip(&distance)
                    .filter(|(_, d)| {
                        members.len() >= 5 && robust > 0.0 && **d > OUTLIER_THRESHOLD_STDS * robust
                    })
                    .map(|(a, _)| a.name.clone())
                    .collect(),
            }
        })
        .collect()
}
