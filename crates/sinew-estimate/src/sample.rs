//! Conversion of the samples of a control loop to frames.

use sinew_log::Frame;
use sinew_model::StepError;

/// Frame of the latest sample of a control loop; its clock is the sum of the time steps.
#[derive(Debug, Clone)]
pub(crate) struct SampleFrame {
    frame: Frame,
    started: bool,
}

impl SampleFrame {
    /// Creates the frame for a number of axes; no other function allocates.
    pub(crate) fn new(joints: usize) -> Self {
        Self {
            frame: Frame::new(joints),
            started: false,
        }
    }

    /// Converts a sample to the frame. `dt_s`: time since the previous sample, s; ignored for the first sample.
    ///
    /// * `q`, `theta`: `n` each, joint and motor positions, rad.
    /// * `tau_m`: `n` or empty, motor torque, N·m; NaN if unknown.
    /// * `temperature_c`: temperature, °C; NaN if unknown.
    ///
    /// # Errors
    /// Returns [`StepError::Length`] for a slice of wrong length and [`StepError::TimeStep`] for an invalid `dt_s`; the
    /// clock is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub(crate) fn fill(
        &mut self,
        dt_s: f64,
        [q, theta, tau_m]: [&[f64]; 3],
        temperature_c: f64,
    ) -> Result<&mut Frame, StepError> {
        const NS_PER_S: f64 = 1e9;
        let n = self.frame.q.len();
        let torque_fits = tau_m.is_empty() || tau_m.len() == n;
        if q.len() != n || theta.len() != n || !torque_fits {
            return Err(StepError::Length);
        }
        if self.started {
            if !(dt_s > 0.0 && dt_s <= NS_PER_S) {
                return Err(StepError::TimeStep);
            }
            let step_ns = ((dt_s * NS_PER_S).round() as i64).max(1);
            self.frame.time_ns = self.frame.time_ns.saturating_add(step_ns);
        }
        self.started = true;
        self.frame.q.copy_from_slice(q);
        self.frame.theta.copy_from_slice(theta);
        match tau_m {
            [] => self.frame.tau_m.fill(f64::NAN),
            values => self.frame.tau_m.copy_from_slice(values),
        }
        self.frame.temperature_c = temperature_c;
        Ok(&mut self.frame)
    }

    /// Starts a new segment: the next samples do not continue the previous ones.
    pub(crate) fn interrupt(&mut self) {
        self.frame.segment = self.frame.segment.wrapping_add(1);
    }
}
