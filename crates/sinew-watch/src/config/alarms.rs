//! When alarms are raised and cleared, where the owner wants it otherwise.

use sinew_files::date::DAY_S;
use sinew_files::{Bound, Fault, Fields as _, Located, Section};
use sinew_watch_core::alarm::{Condition, Delays};
use std::collections::BTreeMap;

/// What the owner says of alarms; `None` and missing conditions: as usual.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AlarmSettings {
    /// Delays before raising and clearing, s; `None`: the usual one.
    pub delays: BTreeMap<Condition, [Option<f64>; 2]>,
    /// A limit's alarm is cleared below this share of the limit.
    pub clear_below: Option<f64>,
    /// A limit is near if it may be passed within this time, s.
    pub near_s: Option<f64>,
    /// Doubt is worth an alarm after so much motion, s.
    pub doubt_s: Option<f64>,
}

impl AlarmSettings {
    /// Delays of a condition, where `usual` are the usual ones.
    pub fn delays(&self, condition: Condition, usual: Delays) -> Delays {
        let [raise, clear] = self.delays.get(&condition).copied().unwrap_or_default();
        Delays {
            raise_after_s: raise.unwrap_or(usual.raise_after_s),
            clear_after_s: clear.unwrap_or(usual.clear_after_s),
        }
    }
}

/// Keys of the conditions.
const KEYS: [(&str, Condition); 10] = [
    ("replace_limit", Condition::ReplaceLimit),
    ("strand_failed", Condition::StrandFailed),
    ("jump", Condition::Jump),
    ("store", Condition::Store),
    ("door", Condition::Door),
    ("retension_limit", Condition::RetensionLimit),
    ("limit_near", Condition::LimitNear),
    ("suspicion", Condition::Suspicion),
    ("data", Condition::Data),
    ("no_data", Condition::NoData),
];

/// Nothing waits longer, s.
const LONGEST_S: f64 = 7.0 * DAY_S;

pub(super) fn read(s: &Section<'_>) -> Result<AlarmSettings, Located> {
    let mut delays = BTreeMap::new();
    for (key, condition) in KEYS {
        let own = s.read(key, |s| {
            let delay = |key| s.number(key, Bound::Within(0.0, LONGEST_S));
            let raise = delay("raise_after_s")?;
            if raise.is_some() && matches!(condition, Condition::Jump | Condition::StrandFailed) {
                let why = format!(
                    "{key}.raise_after_s: a jump has waited for a second session already, and waits no longer; leave it out"
                );
                return Err(s.here(Fault::Contradiction, why));
            }
            Ok::<_, Located>([raise, delay("clear_after_s")?])
        })?;
        if let Some(own) = own {
            delays.insert(condition, own);
        }
    }
    let near_d = s.number("near_d", Bound::Within(0.0, 3650.0))?;
    Ok(AlarmSettings {
        delays,
        clear_below: s.number("clear_below", Bound::Within(0.0, 1.0))?,
        near_s: near_d.map(|days| DAY_S * days),
        doubt_s: s.number("doubt_s", Bound::Within(0.0, LONGEST_S))?,
    })
}
