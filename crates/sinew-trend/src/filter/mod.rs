//! How a tendon's offset grows over days and months, and when it will pass a limit.
//!
//! One record per session: an offset since the baseline with its own standard deviation `σ_i`, and
//! the temperature. At time `t` since tensioning
//!
//! ```text
//! offset record = J + R + α (T − T_ref) + u(t) + w σ_i e,   e ~ N(0, 1)
//! J  what the rope really lengthened since the baseline: dJ = a(t) dc(t), and jumps
//! c  creep curve over time since tensioning; a > 0 its amplitude here and now,
//!    da = δ a dW(ln t): no curve is quite right, so the pace may leave it by δ per e-fold of time;
//!    creep comes in steps of some 0.07 mrad, as days of hard work come: Var[dJ] = step a dc
//! R  what re-tensionings have taken out (as a rule below 0)
//! α  drift of the estimate with temperature
//! u  error that sessions share: Ornstein–Uhlenbeck, deviation σ_u, time τ_u
//! w  how much the stated deviations are too narrow or too wide
//! ```
//!
//! Given the curve and `(σ_u, τ_u, w, δ)` this is linear and Gaussian (`δ a` taken at the present mean of
//! `a`), and a Kalman filter of five states is the posterior. The curve and the four numbers aren't known:
//! [`Prior`] holds a list of curves (of a rope's law, or [`generic_curves`]) and of noises, every pair is one
//! filter, and the filters are weighed by how well they predicted each record. So an interval of a
//! forecast holds what isn't known about the law and about the errors as well. That a creep doesn't run
//! backwards (`a > 0`) enters through the share of each filter's posterior that lies above 0.
//!
//! **Jumps.** The last few records are kept apart. For each of them "the level jumped just before it" is
//! held against "it didn't", and "this one record is off" against both. A jump that is likelier than not
//! is a suspicion; it is confirmed when a second record agrees and the odds pass a threshold, and
//! withdrawn by itself when the next record doesn't. After a confirmed jump the level is open. A
//! fall by much of the offset is a re-tensioning nobody wrote down. Where sessions report the stiffness as
//! well ([`Stiffness`]), a loss that comes with the jump makes it likelier, up to a factor of 75; stiffness
//! alone never makes one.
//!
//! **Forecast.** Paths are drawn from the posterior, and where each passes a limit is read off
//! ([`Paths::draw`], [`first_passage`]). Further jumps aren't forecast.
//!
//! Adding one record a day gives what adding all at once gives: there is one way through.
//!
//! Not modelled: two events within the window of the last records, a creep that changes its pace
//! because the robot is used otherwise (but by `δ`), errors correlated over months with anything but
//! temperature.
//!
//! # Realtime
//! None of this is a step of a control loop: it allocates. It doesn't panic on any input.

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
mod softened;
mod state;
mod stiffness;
mod tracker;

pub use baseline_error::{BaselineError, Misread, SharedPart};
pub use component::{Component, STATES};
pub use curve::{Curve, NODES, generic_curves, node_times_s};
pub use fingerprint::Fingerprint;
pub use forecast::{Paths, first_passage};
pub use now::TrendNow;
pub use prior::{Noise, Prior, generic_noises};
pub use record::{Added, Event, Record, TrendConfig, TrendEntry, TrendError};
pub use softened::Softened;
pub use state::TrendState;
pub use stiffness::Stiffness;
pub use tracker::Trend;
