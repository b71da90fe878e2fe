//! What a trend says, as data: table, JSON, CSV and report are made from this alone.

use serde::Serialize;

/// The trend of a robot's tendons.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrendReport {
    /// Version of the program that made it.
    pub sinew_version: String,
    /// Robot, where it is known.
    pub robot: Option<String>,
    /// One entry per joint with records.
    pub joints: Vec<JointTrend>,
    /// Whether a limit is passed or a sudden change was confirmed (exit code 3).
    pub attention: bool,
    /// How far forecasts look, days from the last session.
    pub horizon_days: f64,
    /// What was dropped or assumed, in sentences.
    pub notes: Vec<String>,
}

/// A mean and half of its 95 % interval.
pub type With95 = [f64; 2];

/// One tendon.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointTrend {
    /// Joint.
    pub name: String,
    /// Sessions.
    pub sessions: usize,
    /// Sessions that couldn't tell.
    pub without_information: usize,
    /// Day of the first and of the last session.
    pub first_day: String,
    /// Day of the last session.
    pub last_day: String,
    /// Start of the last session, s since 1970.
    pub last_utc_s: f64,
    /// Start of the creep's clock: tensioning or replacement.
    pub tensioned_day: String,
    /// Whether somebody stated that day; else it is the first session's.
    pub tensioned_stated: bool,
    /// Offset at the reference temperature since the last tensioning, mrad, and half its 95 %
    /// interval.
    pub offset_mrad: With95,
    /// The same as elongation, mm; `None` without tendon geometry.
    pub elongation_mm: Option<With95>,
    /// Strain since the first tensioning, %; `None` without tendon geometry.
    pub strain_percent: Option<With95>,
    /// Creep per 30 days now, mrad.
    pub rate_mrad_per_month: With95,
    /// Drift of the records with temperature, mrad/K; `None` without temperatures.
    pub drift_mrad_per_k: Option<With95>,
    /// Reference temperature, °C.
    pub reference_c: f64,
    /// Deviation of the error that sessions share, mrad.
    pub shared_error_mrad: f64,
    /// True over stated width of the sessions' intervals.
    pub stated_width_factor: f64,
    /// Sudden changes and re-tensionings.
    pub events: Vec<EventSaid>,
    /// A sudden change that waits for another session.
    pub suspicion: Option<Suspicion>,
    /// Limits of robot.toml.
    pub limits: Vec<LimitSaid>,
    /// What the forecast rests on.
    pub basis: String,
    /// The tendon in one sentence.
    pub verdict: String,
    /// Records and curves for plots and the CSV.
    pub series: Series,
}

/// A sudden change or a re-tensioning.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EventSaid {
    /// Day of the first session after it.
    pub day: String,
    /// The same, s since 1970.
    pub time_utc_s: f64,
    /// "jump" or "tensioned".
    pub kind: String,
    /// Whether somebody stated it.
    pub stated: bool,
    /// Change of the offset, mrad, and half its 95 % interval; `None` for a stated one.
    pub size_mrad: Option<With95>,
    /// Day of the session that confirmed it.
    pub confirmed_day: String,
    /// Posterior probability when it was confirmed.
    pub probability: f64,
    /// Change of the stiffness over it, %, and half its 95 % interval, where sessions state it.
    pub stiffness_change_percent: Option<With95>,
    /// What it may be, in words.
    pub meaning: String,
}

/// A sudden change that isn't confirmed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suspicion {
    /// Day of the first session after it.
    pub day: String,
    /// Its probability.
    pub probability: f64,
}

/// A limit and when it is passed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitSaid {
    /// "re-tension" or "replace".
    pub kind: String,
    /// Limit, mrad.
    pub limit_mrad: f64,
    /// Limit in the unit of robot.toml.
    pub stated: String,
    /// Probability that it is passed already.
    pub passed_probability: f64,
    /// "passed", "forecast" or "unknown".
    pub state: String,
    /// Median of the days from the last session; `None`: beyond the horizon, or unknown.
    pub days: Option<f64>,
    /// 95 % interval of the days; `None`: beyond the horizon.
    pub interval_95_days: [Option<f64>; 2],
    /// Day of the median.
    pub day: Option<String>,
    /// In words.
    pub said: String,
}

/// Columns for plots.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Series {
    /// Sessions, s since 1970.
    pub time_utc_s: Vec<f64>,
    /// As recorded, mrad; NaN (`null`) where it couldn't tell.
    pub offset_mrad: Vec<f64>,
    /// Half of the stated 95 % interval, mrad.
    pub interval_95_mrad: Vec<f64>,
    /// At the reference temperature, with the drift found in the end, mrad.
    pub at_reference_mrad: Vec<f64>,
    /// Temperature, °C.
    pub temperature_c: Vec<f64>,
    /// What the trend knew after that session: offset and half its 95 % interval, mrad.
    pub tracked_mrad: Vec<With95>,
    /// Probability of an unconfirmed jump after that session.
    pub jump_probability: Vec<f64>,
    /// Whether the record looked off by itself.
    pub off: Vec<bool>,
    /// Forecast, s since 1970.
    pub forecast_utc_s: Vec<f64>,
    /// Quantiles of 2.5, 50 and 97.5 % of the offset, mrad.
    pub forecast_mrad: Vec<[f64; 3]>,
}
