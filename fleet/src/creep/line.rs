//! A line over the logarithm of age, with a zero for each piece and a drift with temperature.

/// Sessions of about one age.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bin {
    pub(super) log_age: f64,
    pub(super) offset_rad: f64,
    pub(super) temperature_difference_k: f64,
    pub(super) variance: f64,
    pub(super) piece: usize,
}

/// Fitted straight line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    /// Offset per decade, rad.
    pub(super) slope: f64,
    /// Standard deviation of the slope, rad.
    pub(super) slope_std: f64,
}

/// Fits the line by weighted least squares after elimination of the zeros of the pieces; `None` if the slope is not determined.
pub(super) fn fit(bins: &[Bin], drift_rad_per_k: f64) -> Option<Line> {
    let pieces = 1 + bins.iter().map(|b| b.piece).max()?;
    let mut middles = vec![[0.0; 3]; pieces];
    let mut weights = vec![0.0; pieces];
    for bin in bins {
        let w = 1.0 / bin.variance;
        weights[bin.piece] += w;
        let values = [bin.log_age, bin.temperature_difference_k, bin.offset_rad];
        for (sum, value) in middles[bin.piece].iter_mut().zip(values) {
            *sum += w * value;
        }
    }
    for (middle, w) in middles.iter_mut().zip(&weights) {
        middle.iter_mut().for_each(|x| *x /= w);
    }
    // Normal equations of slope and drift.
    let (mut aa, mut ab, mut ay, mut by) = (0.0, 0.0, 0.0, 0.0);
    let mut bb = 1.0 / (drift_rad_per_k * drift_rad_per_k);
    let from_middle = |bin: &Bin| {
        let [age, warmer, offset] = middles[bin.piece];
        [
            bin.log_age - age,
            bin.temperature_difference_k - warmer,
            bin.offset_rad - offset,
        ]
    };
    for bin in bins {
        let [a, b, y] = from_middle(bin);
        let w = 1.0 / bin.variance;
        aa += w * a * a;
        ab += w * a * b;
        bb += w * b * b;
        ay += w * a * y;
        by += w * b * y;
    }
    let determinant = aa * bb - ab * ab;
    let slope = (ay * bb - by * ab) / determinant;
    let drift = (by * aa - ay * ab) / determinant;
    let residual = |bin: &Bin| {
        let [a, b, y] = from_middle(bin);
        y - slope * a - drift * b
    };
    let chi: f64 = bins.iter().map(|b| residual(b).powi(2) / b.variance).sum();
    let occupied = weights.iter().filter(|w| **w > 0.0).count();
    let freedom = bins.len().checked_sub(occupied + 1).filter(|n| *n >= 2)?;
    let scatter = (chi / freedom as f64).max(1.0);
    let slope_std = (scatter * bb / determinant).sqrt();
    let is_determined = slope.is_finite() && slope_std > 0.0 && slope_std.is_finite();
    is_determined.then_some(Line { slope, slope_std })
}
