//! Creep tests: from readings to numbers somebody can design with.

mod analyze;
mod curve;
mod error;
mod fit;
mod forecast;
mod law;
mod linear;
mod model;
mod noise;
mod page;
mod parallel;
mod picture;
mod rank;
mod record;
mod sample;
mod scan;
mod solver;
mod superposition;
mod withhold;

pub use analyze::{
    Analysis, AnalyzeOptions, ISO_READINGS_S, Interval, Reading, Recovery, SLOPE_FROM_S, Scatter,
    analyze, scatter,
};
pub use curve::Curve;
pub use error::CreepError;
pub use fit::{Fit, FitOptions, Parameter, fit};
pub use forecast::{Forecast, akaike_weights, combined_forecast};
pub use law::{Law, REFERENCE_S, Shape, Term};
pub use model::{NoiseKind, REFERENCE_K, Share};
pub use noise::{Noise, SHARE_MAX};
pub use page::{Conditions, Contents, Source, page};
pub use parallel::each;
pub use picture::{Plotted, figure};
pub use rank::{Rank, rank};
pub use record::{Fault, FaultKind, PrepareOptions, Prepared, Stage, prepare};
pub use solver::{LeastSquares, Minimum, Residuals, TrustRegion};
pub use superposition::{Isotherm, Shift, Superposition, superpose};
pub use withhold::{Coverage, Withheld, withhold, withhold_all};
