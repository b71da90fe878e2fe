//! Creep tests: from readings to numbers somebody can design with.
//!
//! Requests in, typed results in SI out; words, tables and plots are made elsewhere. In the order
//! of the work: [`read_specimens`], [`analyze_tests`], then [`fit_tests`], [`withhold_tests`] or
//! [`compare`]; [`shift`] needs specimens only. The steps for one specimen are [`prepare`],
//! [`analyze`] and [`fit`].

mod ahead;
mod analyze;
mod bootstrap;
mod curve;
mod draw;
mod draws;
mod error;
mod fit;
mod forecast;
mod held;
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
mod scan;
mod scatter;
mod solver;
mod span;
mod starts;
mod student;
mod superposition;
mod test_file;
mod tests_analyzed;
mod tests_compared;
mod tests_fitted;
mod withhold;

pub use ahead::{ConditionSource, ForecastConditions, ForecastRequest};
pub use analyze::{
    Analysis, AnalyzeOptions, ISO_READINGS_S, NoSlope, PERCENT_PER_H, Reading, Recovery,
    SLOPE_FROM_S, analyze,
};
pub use curve::{Curve, StepWindow, Tension};
pub use error::{CreepError, Failure, NoEntry, NoForecast, TestFileError, Unusable};
pub use fit::{Fit, fit};
pub use forecast::{Forecast, akaike_weights};
pub use isochronous::{Isochrone, IsochronePoint, LoadQuantity, isochrones};
pub use law::{Law, REFERENCE_S, Shape, Term, UnknownLaw};
pub use model::REFERENCE_K;
pub use noise::{Noise, SHARE_MAX};
pub use options::{FitOptions, IntervalKind, NoiseKind, Share};
pub use outlook::{Outlook, PRIOR_FREEDOM};
pub use parallel::each;
pub use parameter::{NotIdentifiable, Parameter};
pub use plan::{
    BenchTest, Candidate, Plan, PlanCheck, PlanRequest, PlannedTest, check as check_plan, plan,
};
pub use rank::{Rank, SCATTER_GUESS, ScatterSource, rank};
pub use record::{Fault, PrepareOptions, Prepared, Stage, StrainZero, prepare};
pub use rope_base::{FixedParameter, RopeBase, WhyFixed};
pub use rope_entry::{EntrySource, rope_entry};
pub use scatter::{Scatter, scatter};
pub use solver::{Ending, Termination};
pub use span::Span;
pub use superposition::{Arrhenius, Isotherm, Shift, Superposition, Wlf, superpose};
pub use test_file::{
    ColumnChoice, Conditions, Source, SourceColumn, Specimen, TestFile, TestFormat, TestOptions,
    TestQuantity, read_specimens, read_test, read_test_bytes, specimens_of,
};
pub use tests_analyzed::{AnalyzeReport, AnalyzeRequest, OutOfRange, Tests, analyze_tests};
pub use tests_compared::{CompareReport, ShiftReport, compare, shift};
pub use tests_fitted::{
    FitReport, FitRequest, FitSet, FitStep, Joint, WithheldReport, fit_tests, withhold_tests,
};
pub use withhold::{Coverage, Forecaster, Withheld, withhold, withhold_all};
