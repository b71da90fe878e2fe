//! Trend estimator: growth of a tendon's offset over days and months, and the first passage of a
//! limit.
//!
//! One record per session: an offset since the baseline with its own standard deviation `σ_i`, and
//! the temperature. At time `t` since tensioning
//!
//! ```text
//! offset record = J + R + α (T − T_ref) + u(t) + w σ_i e,   e ~ N(0, 1)
//! J  true elongation since the baseline: dJ = a(t) dc(t) + b(t) dg(t − t_r), and step changes
//! c  creep curve over time since tensioning; a > 0 its present amplitude,
//!    da = δ a dW(ln t): the creep rate may deviate from its curve by δ per e-fold of time;
//!    creep comes in steps of some 0.07 mrad, as on days of hard work: Var[dJ] = step a dc
//! b  amplitude of the additional creep g since the last re-tensioning at t_r: b = q a there, with q
//!    the lost share of the pretension, uniform from 0 to 1; db = δ b dW(ln(t − t_r))
//! R  offset removed by re-tensioning (usually below 0)
//! α  drift of the estimate with temperature
//! u  slow error of neighbouring sessions: Ornstein–Uhlenbeck, standard deviation σ_u, time τ_u
//! w  ratio of actual to reported standard deviation
//! ```
//!
//! Given the curve and `(σ_u, τ_u, w, δ)` this is linear and Gaussian (`δ a` evaluated at the
//! present mean of `a`), and a Kalman filter computes the posterior. The curve and the four numbers
//! are unknown: [`Prior`] contains a list of curves (of a rope creep law, or [`generic_curves`])
//! and of noises, every pair is one filter, and the filters are weighted by their evidence. The
//! interval of a forecast therefore includes the uncertainty of the law and of the errors. Creep
//! does not run backwards: the share of each filter's posterior with `a > 0` accounts for it.
//!
//! **Re-tensioning.** The rope keeps its memory: `c` continues. The restored tension creeps again, by
//! Boltzmann's superposition principle with `g = c` for a linear viscoelastic rope; a rope creep law
//! states its own `g`, because its bedding-in is not linear ([`Curve::retensioned`]).
//!
//! **Step changes.** The last few records are kept separately. For each of them the hypothesis of a
//! step change just before it is compared with none, and both with the hypothesis that this record
//! is an outlier. A step change with a probability above one half is suspected; it is confirmed
//! when a second record agrees and the odds pass a threshold, and withdrawn automatically when the
//! next record contradicts it. After a confirmed step change the variance of the level is inflated.
//! A decrease by a large part of the offset is an unrecorded re-tensioning. If sessions report the
//! stiffness ([`Stiffness`]), a simultaneous loss makes a step change more probable, by a factor of
//! up to 75; stiffness alone never creates one.
//!
//! **Forecast.** Paths are drawn from the posterior, and the first passage of each through a limit
//! is determined ([`Paths::draw`], [`first_passage`]). Further step changes are not forecast.
//!
//! Adding one record a day gives the same result as adding all at once: the code path is the same.
//!
//! Not modelled: two events within the window of the last records, a change of the creep rate
//! because the robot is used differently (except by `δ`), errors correlated over months with
//! anything but temperature.
//!
//! # Realtime
//! This module allocates and is not part of a control loop. It does not panic on any input.

mod bank;
mod baseline_error;
mod component;
mod curve;
mod detector;
mod fingerprint;
mod forecast;
mod gauss;
mod jump;
mod now;
mod prior;
mod record;
mod screen;
mod state;
mod stiffness;
mod stiffness_loss;
mod tracker;

pub use baseline_error::{BaselineError, BaselineShift, SharedPart};
pub use component::{Component, STATES};
pub use curve::{Curve, NODES, generic_curves, node_times_s};
pub use fingerprint::Fingerprint;
pub use forecast::{Paths, first_passage};
pub use now::TrendNow;
pub use prior::{Noise, Prior, generic_noises};
pub use record::{Added, Event, Record, TrendConfig, TrendEntry, TrendError};
pub use state::TrendState;
pub use stiffness::Stiffness;
pub use stiffness_loss::StiffnessLossStats;
pub use tracker::Trend;
