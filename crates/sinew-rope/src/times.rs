//! Spans of time that predictions are made for.

/// Readings made where nothing else is asked for.
pub const TIMES_DEFAULT_S: [f64; 4] = [HOUR_S, DAY_S, MONTH_S, YEAR_S];
/// s.
pub const HOUR_S: f64 = 3600.0;
/// s.
pub const DAY_S: f64 = 86_400.0;
/// A twelfth of a year, s.
pub const MONTH_S: f64 = YEAR_S / 12.0;
/// 365.25 days, s.
pub const YEAR_S: f64 = 31_557_600.0;
/// Elongation "since tensioned" counts from here, s: what a fitter sees who tensions a rope, lets
/// it sit for a minute and goes.
pub const TENSIONED_AFTER_S: f64 = 60.0;
