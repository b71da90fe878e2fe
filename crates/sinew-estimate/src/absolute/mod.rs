//! Absolute offsets: calibrate after tensioning, then watch.
//!
//! [`learn`] takes a recording made right after tensioning, whose offsets are zero by definition,
//! and learns what disguises itself as an offset: stiffness, masses, friction, encoder errors. The
//! [`Baseline`] it returns is a small file. [`watch`] takes a later recording and that file, and
//! gives each tendon's offset since then with a 95 % interval, an unknown payload estimated along,
//! contacts left out, slips found. Without a baseline the data-sheet priors stand in, and the
//! interval is as wide as that makes it.
//!
//! The estimator is [`sinew_model::offset::MapEstimator`]; [`live`] gives its recursive form, for a
//! robot that runs.

mod answer;
mod blocks;
mod doubt;
mod file;
mod jumps;
mod merge;
mod said;
mod sentences;
mod stiffness;
mod warnings;
mod watch;

pub use answer::{
    Absolute, AbsoluteJoint, Course, LeftOut, Moved, PayloadChange, SinceBefore, Step, Stretch,
};
pub use blocks::{AbsoluteError, Recorded, Recorder, Window};
pub use file::Baseline;
pub use jumps::{Cause, Jumps, Why, quickness};
pub use merge::{MergeOptions, Pooled, merge};
pub use sinew_model::offset::Payload;
pub use watch::{
    Learning, WatchOptions, estimator, learn, learn_from, learn_recorded, learn_recorded_from,
    live, live_saved, watch, watch_beside_paper, watch_recorded,
};
