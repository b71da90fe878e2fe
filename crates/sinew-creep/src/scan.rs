//! Stages of the load, jumps and outliers of the strain.

use super::span::extremes;
use sinew_model::statistics::quantile;

/// From this share of the largest load on, a change is a change of stage.
const STAGE: f64 = 0.05;
/// Readings a new level must hold to count as a plateau.
const HOLD: usize = 3;

/// A stretch under one load; indices of readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plateau {
    /// First reading at the level.
    pub(super) from: usize,
    /// One past the last.
    pub(super) to: usize,
    pub(super) level: f64,
}

/// Median of five neighbours: a spike of the load cell is no step.
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

/// Plateaus of a load given as a share of its largest; what lies between is ramp.
pub(super) fn plateaus(load: &[f64]) -> Vec<Plateau> {
    let n = load.len();
    let mut found: Vec<Plateau> = Vec::new();
    let mut i = 0;
    while i < n {
        let end = (i + HOLD).min(n);
        let level = median(&load[i..end]);
        // A ramp changes by a good part of a stage within a few readings.
        let still = load[i..end].iter().all(|l| (l - level).abs() < 0.2 * STAGE);
        if !still || end - i < HOLD.min(n) {
            i += 1;
            continue;
        }
        let mut to = end;
        let mut sum: f64 = load[i..end].iter().sum();
        while to < n && (load[to] - sum / (to - i) as f64).abs() < STAGE {
            sum += load[to];
            to += 1;
        }
        let plateau = Plateau {
            from: i,
            to,
            level: sum / (to - i) as f64,
        };
        match found.last_mut() {
            Some(last) if (last.level - plateau.level).abs() < STAGE => last.to = to,
            _ => found.push(plateau),
        }
        i = to;
    }
    found
}

/// Readings that stand apart from both neighbours' curve, and jumps that stay.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Oddities {
    pub(super) outliers: Vec<usize>,
    /// Reading after the jump, and its height.
    pub(super) jumps: Vec<(usize, f64)>,
}

/// Looks for oddities within a plateau. `place` rises and makes creep about a straight line
/// (logarithm of time).
pub(super) fn oddities(place: &[f64], strain: &[f64]) -> Oddities {
    /// Fewer readings can't tell a jump from creep.
    const FEWEST: usize = 16;
    /// Robust standard deviations: one false alarm in a few million normal readings.
    const SIGMAS: f64 = 8.0;
    /// Readings on either side.
    const SIDE: usize = 5;
    /// Part of the whole creep below which a jump is not worth a word.
    const WORTH: f64 = 0.02;
    /// Longest pause, in the logarithm of time, within which a jump can be told from creep.
    const SHORT_PAUSE: f64 = 0.15;
    let n = strain.len();
    let mut odd = Oddities::default();
    if n < FEWEST {
        return odd;
    }
    let spread = |values: &[f64]| {
        let centre = median(values);
        let apart: Vec<f64> = values.iter().map(|v| (v - centre).abs()).collect();
        // 1.4826 makes the median deviation that of a normal distribution.
        (centre, 1.482_6 * median(&apart))
    };
    let (low, high) = extremes(strain);
    let range = high - low;
    // Outliers: the difference to the neighbours' straight line.
    let bent: Vec<f64> = (1..n - 1)
        .map(|i| {
            let share = (place[i] - place[i - 1]) / (place[i + 1] - place[i - 1]).max(1e-300);
            strain[i] - strain[i - 1] - share * (strain[i + 1] - strain[i - 1])
        })
        .collect();
    let (centre, std) = spread(&bent);
    for (k, value) in bent.iter().enumerate() {
        let apart = value - centre;
        let beside = |other: Option<&f64>| {
            other.is_some_and(|o| {
                (o - centre) * apart < 0.0 && (o - centre).abs() > 0.3 * apart.abs()
            })
        };
        // A single wrong reading bends the curve the other way at both neighbours.
        if apart.abs() > SIGMAS * std
            && apart.abs() > WORTH * range
            && k > 0
            && beside(bent.get(k - 1))
            && beside(bent.get(k + 1))
        {
            odd.outliers.push(k + 1);
        }
    }
    let kept: Vec<usize> = (0..n).filter(|i| !odd.outliers.contains(i)).collect();
    let (place, strain): (Vec<f64>, Vec<f64>) = kept.iter().map(|&i| (place[i], strain[i])).unzip();
    let n = strain.len();
    // A straight line through the readings on each side, extrapolated to the gap between.
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
    let gaps: Vec<f64> = (SIDE..=n.saturating_sub(SIDE))
        .map(|i| {
            let middle = 0.5 * (place[i - 1] + place[i.min(n - 1)]);
            line(i, i + SIDE.min(n - i), middle) - line(i - SIDE, i, middle)
        })
        .collect();
    let (centre, std) = spread(&gaps);
    let mut k = 0;
    while k < gaps.len() {
        let height = |k: usize| (gaps[k] - centre).abs();
        if height(k) > SIGMAS * std && height(k) > WORTH * range {
            // The largest of the neighbours that see the same jump.
            let end = (k + SIDE).min(gaps.len());
            let top = (k..end)
                .max_by(|a, b| height(*a).total_cmp(&height(*b)))
                .unwrap_or(k);
            let i = top + SIDE;
            // The jump is between two readings: what they differ by, not what lines say.
            let step = strain[i] - strain[i - 1];
            // Over a pause as long as the test so far creep itself may rise as far.
            let pause = place[i] - place[i - 1];
            if (step - gaps[top]).abs() < 0.5 * gaps[top].abs() && pause < SHORT_PAUSE {
                odd.jumps.push((kept[i], gaps[top] - centre));
            }
            k = top + SIDE;
        } else {
            k += 1;
        }
    }
    odd
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
    fn a_slip_is_a_jump_and_creep_is_not() {
        let (place, mut strain) = creep(200);
        assert_eq!(oddities(&place, &strain), Oddities::default());
        strain.iter_mut().skip(120).for_each(|e| *e += 5e-4);
        let odd = oddities(&place, &strain);
        assert_eq!(odd.jumps.len(), 1);
        assert_eq!(odd.jumps[0].0, 120);
        assert!((odd.jumps[0].1 - 5e-4).abs() < 5e-5, "{odd:?}");
    }

    #[test]
    fn a_wrong_reading_is_an_outlier_and_no_jump() {
        let (place, mut strain) = creep(200);
        strain[77] += 6e-4;
        let odd = oddities(&place, &strain);
        assert_eq!((odd.outliers.as_slice(), odd.jumps.len()), (&[77][..], 0));
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
