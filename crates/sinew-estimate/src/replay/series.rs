//! Time series of the estimate of a joint in bounded memory.

use super::result::Series;

/// Contribution of one frame to the time series of a joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) delta_e: f64,
    pub(super) tau_el: f64,
    pub(super) tau_spring: f64,
    pub(super) q: f64,
    pub(super) usable: bool,
}

/// Sums over the frames of one interval.
#[derive(Debug, Clone, Copy)]
struct Bin {
    frames: u32,
    usable: u32,
    delta_e: f64,
    min: f64,
    max: f64,
    tau_el: f64,
    tau_spring: f64,
    q: f64,
}

impl Bin {
    const EMPTY: Self = Self {
        frames: 0,
        usable: 0,
        delta_e: 0.0,
        min: f64::INFINITY,
        max: f64::NEG_INFINITY,
        tau_el: 0.0,
        tau_spring: 0.0,
        q: 0.0,
    };

    fn merge(&mut self, other: &Self) {
        self.frames += other.frames;
        self.usable += other.usable;
        self.delta_e += other.delta_e;
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.tau_el += other.tau_el;
        self.tau_spring += other.tau_spring;
        self.q += other.q;
    }
}

/// Builder of a time series, averaged over intervals that double in length when their number exceeds the limit.
#[derive(Debug, Clone)]
pub(super) struct SeriesBuilder {
    width_ns: i64,
    bins: Vec<Bin>,
}

impl SeriesBuilder {
    pub(super) fn new() -> Self {
        Self {
            // 10 ms: finer than the resolution of a plot.
            width_ns: 10_000_000,
            bins: Vec::with_capacity(Series::POINTS),
        }
    }

    /// Adds a frame at `since_start_ns` from the start of the recording; a time before the start
    /// (non-monotonic clock) counts as the start.
    pub(super) fn add(&mut self, since_start_ns: i64, point: Point) {
        let since_start_ns = since_start_ns.max(0);
        let mut at = (since_start_ns / self.width_ns) as usize;
        while at >= Series::POINTS {
            self.halve();
            at = (since_start_ns / self.width_ns) as usize;
        }
        if at >= self.bins.len() {
            self.bins.resize(at + 1, Bin::EMPTY);
        }
        let bin = &mut self.bins[at];
        bin.frames += 1;
        bin.q += point.q;
        if point.usable {
            bin.usable += 1;
            bin.delta_e += point.delta_e;
            bin.min = bin.min.min(point.delta_e);
            bin.max = bin.max.max(point.delta_e);
            bin.tau_el += point.tau_el;
            bin.tau_spring += point.tau_spring;
        }
    }

    fn halve(&mut self) {
        let half = self.bins.len().div_ceil(2);
        for i in 0..half {
            let mut bin = self.bins[2 * i];
            if let Some(next) = self.bins.get(2 * i + 1) {
                bin.merge(next);
            }
            self.bins[i] = bin;
        }
        self.bins.truncate(half);
        self.width_ns *= 2;
    }

    pub(super) fn finish(&self) -> Series {
        let mut series = Series::default();
        let width_s = self.width_ns as f64 * 1e-9;
        for (i, bin) in self.bins.iter().enumerate() {
            // Intervals shorter than the frame period are empty between frames: they are not gaps.
            if bin.frames == 0 && !self.is_gap(i) {
                continue;
            }
            let mean = |sum: f64, count: u32| {
                if count == 0 {
                    f64::NAN
                } else {
                    sum / f64::from(count)
                }
            };
            let bound = |x: f64| if bin.usable == 0 { f64::NAN } else { x };
            series.time_s.push((i as f64 + 0.5) * width_s);
            series.offset_rad.push(mean(bin.delta_e, bin.usable));
            series.offset_min_rad.push(bound(bin.min));
            series.offset_max_rad.push(bound(bin.max));
            series.tau_el_nm.push(mean(bin.tau_el, bin.usable));
            series.tau_spring_nm.push(mean(bin.tau_spring, bin.usable));
            series.q_rad.push(mean(bin.q, bin.frames));
            series
                .usable_share
                .push(mean(f64::from(bin.usable), bin.frames));
        }
        series
    }

    /// Whether an empty interval is in a gap that is long enough to be visible in a plot.
    fn is_gap(&self, i: usize) -> bool {
        const GAP_NS: i64 = 500_000_000;
        let reach = (GAP_NS / self.width_ns).max(1) as usize;
        let before = i.saturating_sub(reach);
        self.bins[before..i].iter().all(|b| b.frames == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_halving_preserves_means() {
        let mut builder = SeriesBuilder::new();
        // An hour at 100 Hz: a ramp from 0 to 1 mrad.
        let n = 360_000;
        for k in 0..n {
            let x = f64::from(k) / f64::from(n - 1);
            builder.add(
                i64::from(k) * 10_000_000,
                Point {
                    delta_e: 1e-3 * x,
                    tau_el: x,
                    tau_spring: x,
                    q: x,
                    usable: true,
                },
            );
        }
        let series = builder.finish();
        assert!(series.time_s.len() <= Series::POINTS && series.time_s.len() > Series::POINTS / 2);
        let width = series.time_s[1] - series.time_s[0];
        for (t, d) in series.time_s.iter().zip(&series.offset_rad) {
            // The last interval is not full: its mean is up to half a width early.
            assert!(
                (1e3 * d - t / 3600.0).abs() <= 0.51 * width / 3600.0,
                "{t} {d}"
            );
        }
    }
}
