//! The trend of one tendon: what it needs, and what it gives.

use sinew_model::robot::Robot;
use sinew_rope::Catalogue;
use sinew_trend::{JointTrend, PassageTimes, SessionRecord, Stated, TrendRequest, analyze_joint};
use std::sync::Arc;

/// What a tendon's trend needs.
#[derive(Debug)]
pub(super) struct TrendWork {
    /// After how many tensionings it was begun.
    pub(super) of: u32,
    /// Place among the elastic joints.
    pub(super) tendon: usize,
    pub(super) joint: String,
    pub(super) records: Vec<SessionRecord>,
    pub(super) stated: Vec<Stated>,
    pub(super) catalogue: Arc<Catalogue>,
}

/// Days a trend's forecast looks ahead, as that of `sinew trend`.
pub const HORIZON_DAYS: f64 = 1095.0;

/// Seed of its draws: that of `sinew trend`.
const SEED: u64 = 1;

/// A trend without its series, and when it passes its limits.
#[derive(Debug, Clone)]
pub(super) struct Made {
    pub(super) trend: Arc<JointTrend>,
    pub(super) passages: Arc<[PassageTimes]>,
}

/// The trend; `None` where the records make none.
pub(super) fn analyze_tendon(robot: &Robot, work: TrendWork) -> Option<Made> {
    let last_utc_s = work.records.last()?.time_utc_s;
    let request = TrendRequest {
        robot: Some(robot),
        catalogue: &work.catalogue,
        // Of what was done since the last record, the next one will tell.
        stated: (work.stated.into_iter())
            .filter(|stated| stated.time_utc_s <= last_utc_s)
            .collect(),
        duty: None,
        life: None,
        horizon_days: HORIZON_DAYS,
        seed: SEED,
    };
    let (mut trend, passages) = analyze_joint(&work.joint, &work.records, &request).ok()?;
    trend.series = Vec::new();
    Some(Made {
        trend: Arc::new(trend),
        passages: passages.into(),
    })
}
