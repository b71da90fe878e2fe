//! Load history from the force: preload, ramp, stages, steps.

use super::{Artefact, Stage};
use crate::artefacts::{median, plateaus, smoothed};
use crate::curve::StepWindow;
use crate::error::{CreepError, Unusable};
use crate::span::extremes;

/// Tolerance of a constant load by ISO 899-1, as a share of its value.
const LOAD_TOLERANCE: f64 = 0.01;
/// Maximum duration of the load ramp by ISO 899-1 (1 s to 5 s), s.
const RAMP_S: f64 = 5.0;

/// Load history from the force column.
pub(super) struct Load {
    /// Index of the first measurement that counts.
    pub(super) first: usize,
    /// Start and number of the measurements before the load that determine the zero.
    pub(super) before_from: usize,
    pub(super) before: usize,
    pub(super) start_s: f64,
    pub(super) steps: Vec<(f64, f64)>,
    pub(super) windows: Vec<StepWindow>,
    pub(super) stages: Vec<Stage>,
    pub(super) reference_n: Option<f64>,
    pub(super) preload_n: Option<f64>,
}

impl Load {
    pub(super) fn read(
        time: &[f64],
        strain: &[f64],
        force: Option<&[f64]>,
        name: &str,
        artefacts: &mut Vec<Artefact>,
    ) -> Result<Load, CreepError> {
        let invalid = |reason: Unusable| CreepError::Specimen {
            specimen: name.to_owned(),
            reason,
        };
        let last = time.len() - 1;
        let unramped = |reference_n: Option<f64>| Load {
            first: 0,
            before_from: 0,
            before: 0,
            start_s: time[0],
            steps: vec![(0.0, 1.0)],
            windows: Vec::new(),
            stages: vec![Stage {
                start_s: 0.0,
                end_s: time[last] - time[0],
                force_n: reference_n.unwrap_or(f64::NAN),
                ramp_s: 0.0,
            }],
            reference_n,
            preload_n: None,
        };
        let Some(force) = force else {
            artefacts.push(Artefact::NoForce);
            return Ok(unramped(None));
        };
        let smooth = smoothed(force);
        let largest = smooth.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return Err(invalid(Unusable::ForceNeverPositive));
        }
        let share: Vec<f64> = smooth.iter().map(|f| f / largest).collect();
        let plateaus = plateaus(&share);
        /// Minimum creep load as a share of the largest load.
        const MIN_LOAD_SHARE: f64 = 0.3;
        let Some(loaded) = plateaus.iter().position(|p| p.level > MIN_LOAD_SHARE) else {
            swapped(time, strain, force).map_err(invalid)?;
            return Err(invalid(Unusable::NoLevel));
        };
        let first = plateaus[loaded];
        swapped(
            &time[first.from..first.to],
            &strain[first.from..first.to],
            &force[first.from..first.to],
        )
        .map_err(invalid)?;
        let reference = first.level * largest;
        if first.from == 0 {
            let constant = force
                .iter()
                .all(|f| (f - reference).abs() < 1e-6 * reference);
            artefacts.push(Artefact::NoRamp);
            if constant && plateaus.len() == 1 {
                return Ok(unramped(Some(reference)));
            }
        }
        // The ramp starts with the last measurement that is still at the previous level.
        let before = (loaded > 0).then(|| plateaus[loaded - 1]);
        let base = before.map_or_else(|| share[0].min(0.0), |p| p.level);
        let begin = (0..first.from)
            .rev()
            .find(|&i| share[i] - base < 0.02)
            .unwrap_or(0);
        let start_s = time[begin];
        let ramp_s = if first.from == 0 {
            0.0
        } else {
            time[first.from] - start_s
        };
        if ramp_s > RAMP_S {
            artefacts.push(Artefact::SlowRamp {
                time_s: start_s,
                ramp_s,
            });
        }
        let preload = before
            .map(|p| p.level * largest)
            .filter(|p| p.abs() > 0.005 * largest);
        let (before_from, before_count) = match before {
            Some(p) => {
                // The last measurements before the ramp; earlier ones may belong to the clamping.
                let count = (begin + 1 - p.from).min(20);
                (begin + 1 - count, count)
            }
            None if first.from > 0 => (begin, 1),
            None => (0, 0),
        };
        let mut stages = Vec::new();
        let mut end_before = begin;
        for p in &plateaus[loaded..] {
            let inside = &force[p.from..p.to];
            let level = median(inside);
            let (low, high) = extremes(inside);
            let drift = (high - level).max(level - low);
            if level > 0.05 * largest && drift > LOAD_TOLERANCE * level {
                artefacts.push(Artefact::LoadDrift {
                    time_s: time[p.from],
                    load_n: level,
                    drift_share: drift / level,
                });
            }
            stages.push(Stage {
                start_s: time[p.from] - start_s,
                end_s: time[p.to - 1] - start_s,
                force_n: level,
                ramp_s: (time[p.from] - time[end_before]).max(0.0),
            });
            end_before = p.to - 1;
        }
        let (steps, windows) = steps(
            &time[begin..],
            &smooth[begin..],
            reference,
            start_s,
            preload.unwrap_or(0.0),
        );
        Ok(Load {
            first: first.from,
            before_from,
            before: before_count,
            start_s,
            steps,
            windows,
            stages,
            reference_n: Some(reference),
            preload_n: preload,
        })
    }
}

/// Checks for swapped columns: in a creep test the force is constant and the strain grows.
fn swapped(time: &[f64], strain: &[f64], force: &[f64]) -> Result<(), Unusable> {
    let third = time.len() / 3;
    if third < 3 {
        return Ok(());
    }
    let change = |v: &[f64]| {
        let (early, late) = (median(&v[third / 2..third]), median(&v[v.len() - third..]));
        (late - early).abs() / late.abs().max(1e-300)
    };
    // A column constant to 1e-4 next to one that creeps is the force, not the strain.
    if change(strain) < 1e-4 && change(force) > 0.01 {
        return Err(Unusable::Swapped {
            force_change_share: change(force),
            strain_change_share: change(strain),
        });
    }
    Ok(())
}

/// Load as steps, a new one after a deviation from the last by more than a dead band, and the
/// measurements between which immediate steps occurred.
fn steps(
    time: &[f64],
    force: &[f64],
    reference: f64,
    start_s: f64,
    preload: f64,
) -> (Vec<(f64, f64)>, Vec<StepWindow>) {
    /// Maximum number of steps; a finer band changes nothing noticeable.
    const MAX_STEPS: usize = 60;
    let mut band = 0.005;
    loop {
        let mut steps: Vec<(f64, f64)> = Vec::new();
        // Measurement at which each step is first observed, and its height.
        let mut seen: Vec<(usize, f64)> = Vec::new();
        let mut level = 0.0;
        for i in 0..time.len() {
            // The strain counts from the preload, so the load does too.
            let now = (force[i] - preload) / (reference - preload);
            if (now - level).abs() > band {
                // The middle of the interval, until a fit determines the time.
                let at = if i > 0 {
                    0.5 * (time[i] + time[i - 1])
                } else {
                    time[0]
                };
                steps.push((at - start_s, now));
                seen.push((i, now - level));
                level = now;
            }
        }
        if steps.len() <= MAX_STEPS || band > 0.3 {
            if steps.is_empty() {
                return (vec![(0.0, 1.0)], Vec::new());
            }
            let windows = (0..steps.len())
                .filter(|&k| at_once(&seen, k))
                .map(|k| StepWindow {
                    step: k,
                    from_s: time[seen[k].0 - 1] - start_s,
                    to_s: time[seen[k].0] - start_s,
                })
                .collect();
            return (steps, windows);
        }
        band *= 1.5;
    }
}

/// Whether a step is isolated: neighbouring measurements are not parts of the same ramp.
fn at_once(seen: &[(usize, f64)], k: usize) -> bool {
    /// Minimum height; smaller steps follow a drift of the load.
    const MIN_STEP: f64 = 0.05;
    /// Minimum share of its height for a neighbour to be part of a ramp.
    const MIN_RAMP_SHARE: f64 = 0.2;
    let (at, height) = seen[k];
    let same_ramp = |other: Option<&(usize, f64)>| {
        other.is_some_and(|(i, h)| i.abs_diff(at) == 1 && h.abs() > MIN_RAMP_SHARE * height.abs())
    };
    let before = k.checked_sub(1).and_then(|k| seen.get(k));
    at > 0 && height.abs() > MIN_STEP && !same_ramp(before) && !same_ramp(seen.get(k + 1))
}
