//! From frames to tendon offsets: replay, session estimate, baseline, trend of records.

pub mod absolute;
pub mod estimate;
pub mod executor;
pub mod feeder;
pub mod robot_dir;
pub mod strand_duty;
pub mod trend;
