//! Trend of a tendon among those of a fleet: selection of its sessions, and priors shared by tendons of one kind.

use super::analyze::{ResumedTrend, TrendRequest, mean_temperature_c, resume_joint};
use super::clock::{BASELINE_AFTER_S, Stated};
use super::error::AnalyzeError;
use super::inputs::LoadedTrend;
use super::prior::{RopePrior, rope_prior};
use super::records::SessionRecord;
use crate::filter::Prior;
use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_rope::{Catalogue, CatalogueError};
use std::sync::{Arc, Mutex, PoisonError};

/// Forecast horizon, days.
const HORIZON_DAYS: f64 = 365.0;
/// Seed of the draws of ropes and of paths.
const SEED: u64 = 1;
/// Period of the selection of sessions, days. All sessions of the present and of the previous period are used, counted from the
/// first session of a tendon, all of [`FRESH_DAYS`] after each new baseline, and one per week of the others. The selection
/// therefore changes with the period and not daily, and a trend can resume from the previous day.
const PERIOD_DAYS: f64 = 30.0;
const FRESH_DAYS: f64 = 14.0;

/// Slot of a prior, computed once: another thread that needs it waits.
type Slot = Arc<Mutex<Option<Arc<RopePrior>>>>;
/// Tendon, if the joint has a described one, and bits of the rounded mean temperature, °C.
type Key = (Option<Tendon>, u64);

/// Priors of ropes by tendon and mean temperature in whole degrees Celsius, shared by all tendons of a fleet.
///
/// The draws of a rope's curves depend on rope, pretension, routing and temperature only, and take longer than the
/// filters of a tendon with few sessions.
pub struct RopePriors {
    catalogue: Catalogue,
    slots: Mutex<Vec<(Key, Slot)>>,
}

impl RopePriors {
    /// Creates an empty store for the ropes of a catalogue.
    pub fn new(catalogue: Catalogue) -> Self {
        Self {
            catalogue,
            slots: Mutex::default(),
        }
    }

    /// Catalogue of the ropes.
    pub fn catalogue(&self) -> &Catalogue {
        &self.catalogue
    }

    /// Returns the prior of a tendon at a mean temperature, °C, rounded to whole degrees.
    ///
    /// # Errors
    /// Returns a [`CatalogueError`] if the rope is not found or has no complete law.
    pub fn of(
        &self,
        tendon: Option<&Tendon>,
        mean_c: f64,
    ) -> Result<Arc<RopePrior>, CatalogueError> {
        let celsius = mean_c.round();
        let slot = self.slot((tendon.cloned(), celsius.to_bits()));
        let mut prior = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(drawn) = &*prior {
            return Ok(drawn.clone());
        }
        let drawn = Arc::new(rope_prior(tendon, &self.catalogue, None, celsius, SEED)?);
        *prior = Some(drawn.clone());
        Ok(drawn)
    }

    fn slot(&self, kind: Key) -> Slot {
        let mut slots = self.slots.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, slot)) = slots.iter().find(|(own, _)| *own == kind) {
            return slot.clone();
        }
        let slot = Slot::default();
        slots.push((kind, slot.clone()));
        slot
    }
}

/// Tendon of a fleet.
#[derive(Debug, Clone, Copy)]
pub struct FleetTendon<'a> {
    /// Name of the joint.
    pub joint: &'a str,
    /// Robot type with the installed rope; `None` without a description.
    pub robot: Option<&'a Robot>,
    /// Tendon of the joint in this description.
    pub tendon: Option<&'a Tendon>,
    /// Specified tensionings and replacements.
    pub events: &'a [Stated],
}

/// Computes the trend of a tendon from its best session of each day ([`best_of_days`]), as `sinew-fleet` does.
///
/// * `adjust`: changes the prior of the rope, by the creep of the tendon's batch.
/// * `kept`: stored state of an earlier call, from which the trend resumes.
///
/// # Errors
/// Returns an [`AnalyzeError`] as [`resume_joint`] does.
pub fn trend_of_tendon(
    of: FleetTendon<'_>,
    sessions: &[SessionRecord],
    priors: &RopePriors,
    adjust: Option<&dyn Fn(&mut Prior)>,
    kept: Option<LoadedTrend>,
) -> Result<ResumedTrend, AnalyzeError> {
    let mut rows = thinned(sessions);
    // Events after the last session have no session yet.
    let last_utc_s = rows.last().map_or(0.0, |r| r.time_utc_s);
    let stated = of.events.iter().filter(|s| s.time_utc_s <= last_utc_s);
    let stated: Vec<Stated> = stated.cloned().collect();
    date_baselines(&mut rows, &stated);
    let request = TrendRequest {
        robot: of.robot,
        catalogue: &priors.catalogue,
        stated,
        duty: None,
        life: None,
        horizon_days: HORIZON_DAYS,
        seed: SEED,
    };
    let shared = priors.of(of.tendon, mean_temperature_c(sessions))?;
    match adjust {
        None => resume_joint(of.joint, &rows, &shared, &request, kept),
        Some(adjust) => {
            let mut own = RopePrior::clone(&shared);
            adjust(&mut own.prior);
            resume_joint(of.joint, &rows, &own, &request, kept)
        }
    }
}

/// Reduces sessions in order of time to the one with the narrowest interval of each day, as in the trend of the
/// monitor. A new baseline divides a day in two; of sessions at one time the first counts.
pub fn best_of_days(sessions: impl IntoIterator<Item = SessionRecord>) -> Vec<SessionRecord> {
    let day = |r: &SessionRecord| (r.time_utc_s / DAY_S).floor();
    let width = |r: &SessionRecord| r.offset_rad.map_or(f64::INFINITY, |o| o.std);
    let mut out: Vec<SessionRecord> = Vec::new();
    for row in sessions {
        match out.last_mut() {
            Some(last) if day(last) == day(&row) && last.baseline == row.baseline => {
                if width(&row) < width(last) {
                    *last = row;
                }
            }
            Some(last) if row.time_utc_s <= last.time_utc_s => {}
            _ => out.push(row),
        }
    }
    out
}

/// Selects all recent sessions, those after a new baseline, and one per week of the others, because a single day contributes little
/// to the creep months ago.
fn thinned(rows: &[SessionRecord]) -> Vec<SessionRecord> {
    let [first_utc_s, last_utc_s] =
        [rows.first(), rows.last()].map(|row| row.map_or(0.0, |r| r.time_utc_s));
    let period_s = PERIOD_DAYS * DAY_S;
    let period = ((last_utc_s - first_utc_s) / period_s).floor();
    let recent_utc_s = first_utc_s + (period - 1.0) * period_s;
    let mut out: Vec<SessionRecord> = Vec::new();
    let (mut since_utc_s, mut week) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    let mut baseline: Option<&Option<String>> = None;
    for row in rows {
        if baseline != Some(&row.baseline) {
            (baseline, since_utc_s) = (Some(&row.baseline), row.time_utc_s);
        }
        let recent = row.time_utc_s >= recent_utc_s;
        let fresh = row.time_utc_s - since_utc_s <= FRESH_DAYS * DAY_S;
        let number = (row.time_utc_s / (7.0 * DAY_S)).floor();
        if recent || fresh || number != week {
            out.push(row.clone());
        }
        week = number;
    }
    out
}

/// Sets the baseline times from the tensionings specified between the first session of a baseline and the session before it.
fn date_baselines(rows: &mut [SessionRecord], stated: &[Stated]) {
    let mut before: Option<(Option<String>, f64)> = None;
    let mut time_utc_s = None;
    for row in rows {
        let changed = before
            .as_ref()
            .is_none_or(|(name, _)| *name != row.baseline);
        if changed {
            let from = before.as_ref().map_or(f64::NEG_INFINITY, |(_, t)| *t);
            let times = stated.iter().map(|s| s.time_utc_s);
            let between = times.filter(|t| *t > from && *t <= row.time_utc_s);
            let latest = between.fold(f64::NEG_INFINITY, f64::max);
            time_utc_s = latest
                .is_finite()
                .then_some((latest + BASELINE_AFTER_S).min(row.time_utc_s));
        }
        row.baseline_time_utc_s = time_utc_s;
        before = Some((row.baseline.clone(), row.time_utc_s));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinned_selection_changes_with_period_only() {
        let days = |count: u32| -> Vec<SessionRecord> {
            let session = |day: u32| SessionRecord {
                time_utc_s: 1.75e9 + f64::from(day) * DAY_S,
                ..SessionRecord::default()
            };
            (0..count).map(session).collect()
        };
        let [day_99, day_119, day_120] = [100, 120, 121].map(|count| thinned(&days(count)));
        // Two weeks, seven weeks until day 60, and all since; twenty days later the same and all since.
        assert!(day_99.len() < 14 + 7 + 40 + 2, "{}", day_99.len());
        assert!(day_119.starts_with(&day_99));
        assert_eq!(day_119.len(), day_99.len() + 20);
        assert!(!day_120.starts_with(&day_99));
        assert!(day_120.len() < day_119.len());
    }
}
