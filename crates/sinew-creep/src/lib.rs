//! Creep tests: from readings to numbers somebody can design with.

mod analyze;
mod bootstrap;
mod curve;
mod draws;
mod error;
mod evaluate;
mod fit;
mod forecast;
mod isochronous;
mod law;
mod linear;
mod model;
mod noise;
mod outlook;
mod page;
mod page_tables;
mod parallel;
mod parameter;
mod picture;
mod profile;
mod rank;
mod record;
mod records;
mod rope_entry;
mod rope_law;
mod rope_walk;
mod sample;
mod scan;
mod slopes;
mod solver;
mod starts;
mod student;
mod superposition;
mod withhold;

pub use analyze::{
    Analysis, AnalyzeOptions, ISO_READINGS_S, Interval, Reading, Recovery, SLOPE_FROM_S, Scatter,
    analyze, reading_time, scatter,
};
pub use curve::{Curve, Tension};
pub use error::CreepError;
pub use fit::{Fit, FitOptions, IntervalKind, fit};
pub use forecast::{Forecast, akaike_weights, combined_forecast};
pub use isochronous::{Isochrone, isochrones, isochronous_figure};
pub use law::{Law, REFERENCE_S, Shape, Term};
pub use model::{NoiseKind, REFERENCE_K, Share};
pub use noise::{Noise, SHARE_MAX};
pub use outlook::{Outlook, PRIOR_FREEDOM};
pub use page::{Conditions, Contents, Source, page};
pub use parallel::each;
pub use parameter::Parameter;
pub use picture::{Plotted, figure};
pub use rank::{Rank, SCATTER_GUESS, ScatterSource, rank};
pub use record::{Fault, FaultKind, PrepareOptions, Prepared, Stage, prepare};
pub use rope_entry::{Provenance, rope_entry};
pub use rope_law::{Held, RopeBase};
pub use solver::{LeastSquares, Minimum, Residuals, TrustRegion};
pub use superposition::{Isotherm, Shift, Superposition, superpose};
pub use withhold::{Coverage, Withheld, withhold, withhold_all};
