//! Machine-readable names of states in tables.

use sinew_trend::{Limit, LimitState, TrendVerdict};

pub(crate) fn limit(limit: Limit) -> &'static str {
    match limit {
        Limit::Retension { .. } => "retension",
        Limit::Replace { .. } => "replace",
    }
}

pub(crate) fn state(state: LimitState) -> &'static str {
    match state {
        LimitState::Passed => "passed",
        LimitState::Forecast => "forecast",
        LimitState::NotBefore => "not-before",
        LimitState::NotWithinHorizon => "not-within-horizon",
        LimitState::TooFewSessions => "too-few-sessions",
    }
}

pub(crate) fn verdict(verdict: TrendVerdict) -> &'static str {
    match verdict {
        TrendVerdict::Retension => "retension",
        TrendVerdict::Replace => "replace",
        TrendVerdict::Inspect => "inspect",
        TrendVerdict::ReplaceByAge => "replace-by-age",
        TrendVerdict::Watch => "watch",
        TrendVerdict::Wait => "wait",
        TrendVerdict::NoLimit => "no-limit",
    }
}
