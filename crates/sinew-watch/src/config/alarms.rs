//! When alarms are raised and cleared, where the owner wants it otherwise.

use sinew_files::date::DAY_S;
use sinew_files::{Bound, Fault, Fields as _, Located, Section};
use sinew_watch_core::AlarmOptions;
use sinew_watch_core::alarm::{Condition, Delays};
use std::collections::BTreeMap;

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

pub(super) fn read(s: &Section<'_>) -> Result<AlarmOptions, Located> {
    let usual = AlarmOptions::default();
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
            let usual = Delays::of(condition);
            Ok::<_, Located>(Delays {
                raise_after_s: raise.unwrap_or(usual.raise_after_s),
                clear_after_s: delay("clear_after_s")?.unwrap_or(usual.clear_after_s),
            })
        })?;
        delays.extend(own.map(|own| (condition, own)));
    }
    let near_d = s.number("near_d", Bound::Within(0.0, 3650.0))?;
    Ok(AlarmOptions {
        delays,
        clear_below: s.number_or("clear_below", Bound::Within(0.0, 1.0), usual.clear_below)?,
        near_s: near_d.map_or(usual.near_s, |days| DAY_S * days),
        doubt_s: s.number_or("doubt_s", Bound::Within(0.0, LONGEST_S), usual.doubt_s)?,
    })
}
