//! Measurements that another program interpolated between the recorded ones.

/// Minimum number of segments: a constant rate between two changes of the load is a single one.
const MIN_SEGMENTS: usize = 3;
/// Minimum number of measurements within a segment: two lie on a line by chance.
const MIN_INSIDE: usize = 3;
/// Minimum bend at the ends of a segment, in roundings: a smooth curve bends gradually.
const MIN_BEND_ROUNDINGS: f64 = 4.0;
/// Minimum change of the strain between two measurements, in roundings: equal values of a sensor are no line.
const MIN_CHANGE_ROUNDINGS: f64 = 2.0;

/// Last digits in which a record is written; 0 if unknown.
#[derive(Debug, Clone, Copy)]
pub(super) struct Digits {
    /// Last digit of the times, s.
    pub(super) time_s: f64,
    /// Last digit of the strains, m/m.
    pub(super) strain_ratio: f64,
}

/// Whether each measurement is linearly interpolated: within the rounding of the file on the straight line of its
/// neighbours, in segments between measurements at which the slope changes suddenly.
///
/// * `time`, `strain`: n each, s and m/m, times not decreasing.
pub(super) fn interpolated(time: &[f64], strain: &[f64], digits: Digits) -> Vec<bool> {
    let n = time.len();
    let mut found = vec![false; n];
    if n < 3 {
        return found;
    }
    let rounding = |i: usize| {
        let (before_s, after_s) = (time[i] - time[i - 1], time[i + 1] - time[i]);
        let rate = (strain[i + 1] - strain[i - 1]) / (before_s + after_s);
        // Equal intervals are exact multiples of the last digit.
        let written_s = digits.time_s.min((after_s - before_s).abs());
        let stored_s = 4.0 * f64::EPSILON * time[i + 1].abs();
        let largest = strain[i - 1]
            .abs()
            .max(strain[i].abs())
            .max(strain[i + 1].abs());
        // Interpolated, written, read, converted and divided by the length.
        let stored = 8.0 * f64::EPSILON * largest;
        digits.strain_ratio + stored + rate.abs() * (written_s + stored_s)
    };
    let bend = |i: usize| {
        let share = (time[i] - time[i - 1]) / (time[i + 1] - time[i - 1]);
        (strain[i] - strain[i - 1] - share * (strain[i + 1] - strain[i - 1])).abs()
    };
    let is_inside = |i: usize| i > 0 && i + 1 < n && bend(i) <= rounding(i);
    let is_end = |i: usize| i == 0 || i + 1 == n || bend(i) > MIN_BEND_ROUNDINGS * rounding(i);
    let mut segments = Vec::new();
    let mut i = 1;
    while i + 1 < n {
        let from = i;
        while is_inside(i) {
            i += 1;
        }
        if i - from >= MIN_INSIDE && is_end(from - 1) && is_end(i) {
            let change = (strain[i] - strain[from - 1]).abs() / (i - from + 1) as f64;
            if change > MIN_CHANGE_ROUNDINGS * rounding(from) {
                segments.push(from..i);
            }
        }
        i += 1;
    }
    if segments.len() >= MIN_SEGMENTS {
        segments
            .into_iter()
            .for_each(|segment| found[segment].fill(true));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creep in logarithmic time at 1 s, rounded to a digit.
    fn creep(digit: f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..3000).map(f64::from).collect();
        let strain = time.iter().map(|t| 1e-3 * (1.0 + t / 10.0).ln());
        let strain = strain.map(|e| (e / digit).round() * digit).collect();
        (time, strain)
    }

    #[test]
    fn interpolated_lines_between_readings_are_found() {
        // Exact lines, and lines written with nine decimals.
        for digit in [0.0, 1e-9] {
            let (time, smooth) = creep(if digit > 0.0 { digit } else { 1e-12 });
            let knots = [0, 10, 30, 60, 120, 300, 600, 1200, 1800, 2400, 2999];
            let mut strain = smooth.clone();
            for pair in knots.windows(2) {
                let [from, to] = [pair[0], pair[1]];
                for i in from + 1..to {
                    let share = (time[i] - time[from]) / (time[to] - time[from]);
                    let line = smooth[from] + share * (smooth[to] - smooth[from]);
                    strain[i] = if digit > 0.0 {
                        (line / digit).round() * digit
                    } else {
                        line
                    };
                }
            }
            let digits = Digits {
                time_s: 1.0,
                strain_ratio: digit,
            };
            let found = interpolated(&time, &strain, digits);
            let kept: Vec<usize> = (0..time.len()).filter(|i| !found[*i]).collect();
            assert_eq!(kept, knots, "{digit}");
        }
    }

    #[test]
    fn measured_and_smooth_curves_are_not_interpolated() {
        for digit in [1e-12, 1e-9, 1e-7, 1e-6, 1e-5] {
            let (time, mut strain) = creep(digit);
            let digits = Digits {
                time_s: 1.0,
                strain_ratio: digit,
            };
            assert!(
                !interpolated(&time, &strain, digits).contains(&true),
                "{digit}"
            );
            // A fixed sequence of errors, in the steps of the sensor.
            for (i, e) in strain.iter_mut().enumerate() {
                let error = 1e-5 * (12.9898 * i as f64).sin();
                *e += (error / digit).round() * digit;
            }
            assert!(
                !interpolated(&time, &strain, digits).contains(&true),
                "{digit}"
            );
        }
    }
}
