//! Samples of a joint for the cable model: means of the frames of short intervals.

/// Length of an interval, s. The motor moves by less than a tenth of a winding-up width in it, up to speeds of
/// 0.2 rad/s at the narrowest width of the grid; the widths enter as a mean over blocks ten times as long.
const SAMPLE_S: f64 = 0.02;

/// Means of the positions and of the joint's torque in one interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CableSample {
    /// Time since the start of the recording, s.
    pub time_s: f64,
    /// Motor position reflected to the joint, rad.
    pub theta_rad: f64,
    /// Joint position, rad.
    pub q_rad: f64,
    /// Torque of the tendon at the joint, N·m; NaN if it is not recorded.
    pub torque_nm: f64,
}

/// Samples of one joint of a recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CableSamples {
    /// Completed intervals in the order of time.
    pub samples: Vec<CableSample>,
    open: Option<(i64, f64, CableSample)>,
}

impl CableSamples {
    /// Adds the values at one time stamp. Values without a finite time and both positions are excluded.
    pub fn push(&mut self, value: CableSample) {
        let required = [value.time_s, value.theta_rad, value.q_rad];
        if required.iter().any(|x| !x.is_finite()) {
            return;
        }
        let interval = (value.time_s / SAMPLE_S).floor() as i64;
        match &mut self.open {
            Some((open, count, sum)) if *open == interval => {
                *count += 1.0;
                sum.time_s += value.time_s;
                sum.theta_rad += value.theta_rad;
                sum.q_rad += value.q_rad;
                sum.torque_nm += value.torque_nm;
            }
            _ => {
                self.finish();
                self.open = Some((interval, 1.0, value));
            }
        }
    }

    /// Completes the last interval.
    pub fn finish(&mut self) {
        if let Some((_, count, sum)) = self.open.take() {
            self.samples.push(CableSample {
                time_s: sum.time_s / count,
                theta_rad: sum.theta_rad / count,
                q_rad: sum.q_rad / count,
                torque_nm: sum.torque_nm / count,
            });
        }
    }
}
