//! Number formats and headings that all tables and messages share.

use sinew_estimate::replay::RobotInfo;
use sinew_figure::{interval_cells, with_interval};
use sinew_model::Gaussian;

/// Heading of the half-width of an interval, in the unit of the column to its left.
pub(crate) const CI_HEAD: &str = "95 % CI\n(±)";
/// Legend line below a table with [`CI_HEAD`].
pub(crate) const CI_LEGEND: &str = "95 % CI (±): half-width of the 95 % credible interval";

/// Heading above the names of results: "tendon" if the robot has tendons that are not joints, else "joint".
pub(crate) fn name_head(robot: &RobotInfo) -> &'static str {
    match robot.joints.is_empty() {
        true => "joint",
        false => "tendon",
    }
}

/// Returns NaN for a missing value; tables show NaN as a dash.
pub(crate) fn or_nan(x: Option<f64>) -> f64 {
    x.unwrap_or(f64::NAN)
}

/// Factor from rad per relative error to mrad per percent.
pub(crate) const MRAD_PER_PERCENT: f64 = 1e3 * 0.01;

/// Formats a value with the half-width of its 95 % interval, `12.34 ± 0.42`.
///
/// * `factor`: SI unit over the displayed unit, such as 1e3 for mrad.
pub(crate) fn plus_minus(value: Gaussian, factor: f64) -> String {
    with_interval(factor * value.mean, factor * value.std)
}

/// Formats a value and the half-width of its 95 % interval for two cells of a table; dashes if missing.
pub(crate) fn plus_minus_cells(value: Option<Gaussian>, factor: f64) -> [String; 2] {
    let Gaussian { mean, std } = value.unwrap_or(Gaussian::new(f64::NAN, f64::NAN));
    interval_cells(factor * mean, factor * std)
}

/// Formats a force along three axes with its 95 % intervals, in N.
pub(crate) fn newtons(force_n: [Gaussian; 3]) -> String {
    force_n.map(|f| plus_minus(f, 1.0)).join(", ")
}

/// Formats a number with its noun, `1 gap` or `3 gaps`.
pub(crate) fn counted(number: u64, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}
