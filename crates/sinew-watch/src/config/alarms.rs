//! Settings of the alarms: delays and thresholds.

use sinew_files::date::DAY_S;
use sinew_files::{Bound, Fault, Fields as _, Located, Section};
use sinew_watch_core::AlarmOptions;
use sinew_watch_core::alarm::{Condition, Delays};
use std::collections::BTreeMap;

/// Configuration keys of the conditions.
const KEYS: [(&str, Condition); 11] = [
    ("transmission_lost", Condition::TransmissionLost),
    ("replace_limit", Condition::ReplaceLimit),
    ("strand_failure", Condition::StrandFailure),
    ("step_change", Condition::StepChange),
    ("store", Condition::Store),
    ("transport", Condition::Transport),
    ("retension_limit", Condition::RetensionLimit),
    ("limit_near", Condition::LimitNear),
    ("suspected_step", Condition::SuspectedStep),
    ("data", Condition::Data),
    ("no_data", Condition::NoData),
];

/// Former configuration keys, which are still read; the present key takes precedence.
const FORMER_KEYS: [(&str, Condition); 4] = [
    ("strand_failed", Condition::StrandFailure),
    ("jump", Condition::StepChange),
    ("door", Condition::Transport),
    ("suspicion", Condition::SuspectedStep),
];

/// Longest delay that can be set, s.
const MAX_DELAY_S: f64 = 7.0 * DAY_S;

pub(super) fn read(s: &Section<'_>) -> Result<AlarmOptions, Located> {
    let default = AlarmOptions::default();
    let mut delays = BTreeMap::new();
    for (key, condition) in FORMER_KEYS.into_iter().chain(KEYS) {
        let delays_of_key = s.read(key, |s| {
            let delay = |key| s.number(key, Bound::Within(0.0, MAX_DELAY_S));
            let raise = delay("raise_after_s")?;
            if raise.is_some()
                && matches!(
                    condition,
                    Condition::TransmissionLost | Condition::StepChange | Condition::StrandFailure
                )
            {
                let reason = "raise_after_s conflicts with the confirmation by a second session; remove the key";
                return Err(s.here(Fault::Contradiction, reason));
            }
            let default = Delays::of(condition);
            Ok::<_, Located>(Delays {
                raise_after_s: raise.unwrap_or(default.raise_after_s),
                clear_after_s: delay("clear_after_s")?.unwrap_or(default.clear_after_s),
            })
        })?;
        delays.extend(delays_of_key.map(|read| (condition, read)));
    }
    let near_d = s.number("near_d", Bound::Within(0.0, 3650.0))?;
    Ok(AlarmOptions {
        delays,
        clear_below: s.number_or("clear_below", Bound::Within(0.0, 1.0), default.clear_below)?,
        near_s: near_d.map_or(default.near_s, |days| DAY_S * days),
        provisional_s: provisional_s(s)?.unwrap_or(default.provisional_s),
    })
}

/// Reads the duration of a provisional estimate that raises an alarm, s; `doubt_s` is the former key.
fn provisional_s(s: &Section<'_>) -> Result<Option<f64>, Located> {
    let bound = Bound::Within(0.0, MAX_DELAY_S);
    let former = s.number("doubt_s", bound)?;
    Ok(s.number("provisional_s", bound)?.or(former))
}
