//! Analysis of creep tests: from measurements to design parameters of ropes and plastics.
//!
//! The crate returns typed results in SI units; messages, tables and plots are made elsewhere. The
//! usual sequence is [`read_specimens`], [`analyze_tests`], then [`fit_tests`], [`hold_out_tests`]
//! or [`compare`]; [`shift`] needs specimens only. The steps for one specimen are [`prepare`],
//! [`analyze`] and [`fit`].

mod analysis_report;
mod analyze;
mod artefacts;
mod bootstrap;
mod comparison;
mod curve;
mod draw;
mod draws;
mod error;
mod fit;
mod fit_report;
mod fixed_parameters;
mod forecast;
mod forecast_request;
mod holdout;
mod isochronous;
mod law;
mod linear;
mod model;
mod noise;
mod options;
mod outlook;
mod parallel;
mod parameter;
mod plan;
mod profile;
mod rank;
mod record;
mod rope_base;
mod rope_entry;
mod rope_law;
mod rope_walk;
mod sample;
mod scatter;
mod solver;
mod span;
mod starts;
mod student;
mod superposition;
mod test_file;

pub use analysis_report::{AnalyzeReport, AnalyzeRequest, OutOfRange, Tests, analyze_tests};
pub use analyze::{
    Analysis, AnalyzeOptions, ISO_READINGS_S, IsoMeasurement, NoSlope, PERCENT_PER_H, Recovery,
    SLOPE_FROM_S, analyze,
};
pub use comparison::{CompareReport, ShiftReport, compare, shift};
pub use curve::{Curve, StepWindow, Tension};
pub use error::{CreepError, Failure, NoEntry, NoForecast, TestFileError, Unusable};
pub use fit::{Fit, fit};
pub use fit_report::{
    FitReport, FitRequest, FitSet, FitStep, HoldOutReport, Joint, fit_tests, hold_out_tests,
};
pub use forecast::{Forecast, akaike_weights};
pub use forecast_request::{ConditionSource, ForecastConditions, ForecastRequest};
pub use holdout::{Coverage, Forecaster, HoldOut, hold_out, hold_out_all};
pub use isochronous::{Isochrone, IsochronePoint, LoadQuantity, isochrones};
pub use law::{Law, REFERENCE_S, Shape, Term, UnknownLaw};
pub use model::REFERENCE_K;
pub use noise::{Noise, SHARE_MAX};
pub use options::{FitOptions, IntervalKind, NoiseKind, Share};
pub use outlook::{ForecastSet, PRIOR_FREEDOM};
pub use parallel::each;
pub use parameter::{NotIdentifiable, Parameter};
pub use plan::{
    BenchTest, Candidate, Plan, PlanCheck, PlanRequest, PlannedTest, check as check_plan, plan,
};
pub use rank::{Rank, SCATTER_GUESS, ScatterSource, rank};
pub use record::{Artefact, PrepareOptions, Prepared, Stage, StrainZero, prepare};
pub use rope_base::{FixedParameter, NotIdentifiableReason, RopeBase};
pub use rope_entry::{EntrySource, rope_entry};
pub use scatter::{Scatter, scatter};
pub use solver::{Ending, Termination};
pub use span::Span;
pub use superposition::{Arrhenius, Isotherm, Shift, Superposition, Wlf, superpose};
pub use test_file::{
    ColumnChoice, Conditions, Source, SourceColumn, Specimen, TestFile, TestFormat, TestOptions,
    TestQuantity, read_specimens, read_test, read_test_bytes, specimens_of,
};
