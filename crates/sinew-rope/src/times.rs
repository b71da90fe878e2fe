//! Spans of time that predictions are made for.

/// Default times of the predicted elongations, s.
pub const TIMES_DEFAULT_S: [f64; 4] = [HOUR_S, DAY_S, MONTH_S, YEAR_S];
/// One hour, s.
pub const HOUR_S: f64 = 3600.0;
/// One day, s.
pub const DAY_S: f64 = 86_400.0;
/// One month, a twelfth of a year, s.
pub const MONTH_S: f64 = YEAR_S / 12.0;
/// 365.25 days, s.
pub const YEAR_S: f64 = 31_557_600.0;
/// Reference time of the elongation after pretensioning, s: a fitter waits for about one minute after
/// tensioning.
pub const TENSIONED_AFTER_S: f64 = 60.0;
