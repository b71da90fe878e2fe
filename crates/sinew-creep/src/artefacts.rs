//! Detection of load stages, strain steps and outliers.

use super::span::extremes;
use sinew_model::statistics::quantile;

/// Minimum change of the load for a new stage, as a share of the largest load.
pub(super) const MIN_STAGE_CHANGE: f64 = 0.05;
/// Minimum number of measurements of a plateau.
const MIN_PLATEAU: usize = 3;

/// Segment under one load; indices of measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plateau {
    /// First measurement at the level.
    pub(super) from: usize,
    /// Index after the last measurement.
    pub(super) to: usize,
    pub(super) level: f64,
}

/// Median of five neighbours, so that a spike of the load cell is no step.
pub(super) fn smoothed(values: &[f64]) -> Vec<f64> {
    (0..values.len())
        .map(|i| {
            let reach = 2.min(i).min(values.len() - 1 - i);
            median(&values[i - reach..=i + reach])
        })
        .collect()
}

pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, 0.5)
}

/// Plateaus of a load given as a share of its largest; the segments between are ramps.
pub(super) fn plateaus(load: &[f64]) -> Vec<Plateau> {
    let n = load.len();
    let mut found: Vec<Plateau> = Vec::new();
    let mut i = 0;
    while i < n {
        let end = (i + MIN_PLATEAU).min(n);
        let level = median(&load[i..end]);
        // A ramp changes by a large part of a stage within a few measurements.
        let still = load[i..end]
            .iter()
            .all(|l| (l - level).abs() < 0.2 * MIN_STAGE_CHANGE);
        if !still || end - i < MIN_PLATEAU.min(n) {
            i += 1;
            continue;
        }
        let mut to = end;
        let mut sum: f64 = load[i..end].iter().sum();
        while to < n && (load[to] - sum / (to - i) as f64).abs() < MIN_STAGE_CHANGE {
            sum += load[to];
            to += 1;
        }
        let plateau = Plateau {
            from: i,
            to,
            level: sum / (to - i) as f64,
        };
        match found.last_mut() {
            Some(last) if (last.level - plateau.level).abs() < MIN_STAGE_CHANGE => last.to = to,
            _ => found.push(plateau),
        }
        i = to;
    }
    found
}

/// Outliers from both neighbours' curve, and permanent steps.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Artefacts {
    pub(super) outliers: Vec<usize>,
    /// Measurement after the step, and its height.
    pub(super) jumps: Vec<(usize, f64)>,
}

/// Finds artefacts within a plateau. `place` increases and makes creep approximately a straight
/// line (logarithm of time).
pub(super) fn find_artefacts(place: &[f64], strain: &[f64]) -> Artefacts {
    /// Minimum number of measurements to distinguish a step from creep.
    const MIN_MEASUREMENTS: usize = 16;
    /// Threshold in robust standard deviations: one false alarm in a few million normal
    /// measurements.
    const THRESHOLD_STDS: f64 = 8.0;
    /// Number of measurements on either side.
    const SIDE_MEASUREMENTS: usize = 5;
    /// Minimum height of a reportable step as a share of the whole creep.
    const MIN_STEP_SHARE: f64 = 0.02;
    /// Maximum pause, in the logarithm of time, within which a step is distinguishable from creep.
    const MAX_PAUSE: f64 = 0.15;
    let n = strain.len();
    let mut found = Artefacts::default();
    if n < MIN_MEASUREMENTS {
        return found;
    }
    let spread = |values: &[f64]| {
        let centre = median(values);
        let apart: Vec<f64> = values.iter().map(|v| (v - centre).abs()).collect();
        // The factor 1.4826 converts the median deviation to a standard deviation of a normal
        // distribution.
        (centre, 1.482_6 * median(&apart))
    };
    let (low, high) = extremes(strain);
    let range = high - low;
    // Outliers: deviation from the neighbours' straight line.
    let bent: Vec<f64> = (1..n - 1)
        .map(|i| {
            let share = (place[i] - place[i - 1]) / (place[i + 1] - place[i - 1]).max(1e-300);
            strain[i] - strain[i - 1] - share * (strain[i + 1] - strain[i - 1])
        })
        .collect();
    let (centre, std) = spread(&bent);
    for (k, value) in bent.iter().enumerate() {
        let apart = value - centre;
        let opposite = |other: Option<&f64>| {
            other.is_some_and(|o| {
                (o - centre) * apart < 0.0 && (o - centre).abs() > 0.3 * apart.abs()
            })
        };
        // A single wrong measurement bends the curve the other way at both neighbours.
        if apart.abs() > THRESHOLD_STDS * std
            && apart.abs() > MIN_STEP_SHARE * range
            && k > 0
            && opposite(bent.get(k - 1))
            && opposite(bent.get(k + 1))
        {
            found.outliers.push(k + 1);
        }
    }
    let kept: Vec<usize> = (0..n).filter(|i| !found.outliers.contains(i)).collect();
    let (place, strain): (Vec<f64>, Vec<f64>) = kept.iter().map(|&i| (place[i], strain[i])).unzip();
    let n = strain.len();
    // A straight line through the measurements on each side, extrapolated to the gap between.
    let line = |from: usize, to: usize, at: f64| {
        let k = (to - from) as f64;
        let mx = place[from..to].iter().sum::<f64>() / k;
        let my = strain[from..to].iter().sum::<f64>() / k;
        let (mut xx, mut xy) = (0.0, 0.0);
        for i in from..to {
            xx += (place[i] - mx) * (place[i] - mx);
            xy += (place[i] - mx) * (strain[i] - my);
        }
        if xx > 0.0 {
            my + xy / xx * (at - mx)
        } else {
            my
        }
    };
    let gaps: Vec<f64> = (SIDE_MEASUREMENTS..=n.saturating_sub(SIDE_MEASUREMENTS))
        .map(|i| {
            let middle = 0.5 * (place[i - 1] + place[i.min(n - 1)]);
            line(i, i + SIDE_MEASUREMENTS.min(n - i), middle)
                - line(i - SIDE_MEASUREMENTS, i, middle)
        })
        .collect();
    let (centre, std) = spread(&gaps);
    let mut k = 0;
    while k < gaps.len() {
        let height = |k: usize| (gaps[k] - centre).abs();
        if height(k) > THRESHOLD_STDS * std && height(k) > MIN_STEP_SHARE * range {
            // The largest of the neighbours that observe the same step.
            let end = (k + SIDE_MEASUREMENTS).min(gaps.len());
            let top = (k..end)
                .max_by(|a, b| height(*a).total_cmp(&height(*b)))
                .unwrap_or(k);
            let i = top + SIDE_MEASUREMENTS;
            // The step between the two measurements decides, not the extrapolated lines.
            let step = strain[i] - strain[i - 1];
            // During a pause as long as the test so far, creep itself may be as large.
            let pause = place[i] - place[i - 1];
            if (step - gaps[top]).abs() < 0.5 * gaps[top].abs() && pause < MAX_PAUSE {
                found.jumps.push((kept[i], gaps[top] - centre));
            }
            k = top + SIDE_MEASUREMENTS;
        } else {
            k += 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn creep(n: usize) -> (Vec<f64>, Vec<f64>) {
        // A fixed sequence of errors of about 1e-5.
        let place: Vec<f64> = (0..n).map(|i| (1.0 + i as f64).ln()).collect();
        let strain = place
            .iter()
            .enumerate()
            .map(|(i, u)| 1e-3 * u + 1e-5 * (12.9898 * i as f64).sin())
            .collect();
        (place, strain)
    }

    #[test]
    fn slip_is_step_and_creep_is_not() {
        let (place, mut strain) = creep(200);
        assert_eq!(find_artefacts(&place, &strain), Artefacts::default());
        strain.iter_mut().skip(120).for_each(|e| *e += 5e-4);
        let found = find_artefacts(&place, &strain);
        assert_eq!(found.jumps.len(), 1);
        assert_eq!(found.jumps[0].0, 120);
        assert!((found.jumps[0].1 - 5e-4).abs() < 5e-5, "{found:?}");
    }

    #[test]
    fn wrong_measurement_is_outlier_not_step() {
        let (place, mut strain) = creep(200);
        strain[77] += 6e-4;
        let found = find_artefacts(&place, &strain);
        assert_eq!(
            (found.outliers.as_slice(), found.jumps.len()),
            (&[77][..], 0)
        );
    }

    #[test]
    fn plateaus_are_found_between_ramps() {
        let mut load = vec![0.02; 5];
        load.extend((1..=10).map(|i| 0.1 * f64::from(i)));
        load.extend(vec![1.0; 20]);
        load.extend(vec![0.6; 20]);
        let found = plateaus(&load);
        let levels: Vec<f64> = found.iter().map(|p| p.level).collect();
        assert_eq!(found.len(), 3, "{found:?}");
        assert!((levels[0] - 0.02).abs() < 1e-12 && (levels[2] - 0.6).abs() < 1e-12);
        assert_eq!((found[1].from, found[1].to), (14, 35));
    }
}
