//! One sample of a control loop as a frame.

use sinew_log::Frame;
use sinew_model::StepError;

/// The frame that samples of a loop are put into, whose clock is the sum of their time steps.
#[derive(Debug, Clone)]
pub(crate) struct SampleFrame {
    frame: Frame,
    started: bool,
}

impl SampleFrame {
    /// For an arm of `joints`. Allocates here only.
    pub(crate) fn new(joints: usize) -> Self {
        Self {
            frame: Frame::new(joints),
            started: false,
        }
    }

    /// The frame of a sample, `dt_s` after the one before; of the first that does not matter.
    ///
    /// * `q`, `theta`: `n` each, joint and motor positions, rad.
    /// * `tau_m`: `n` or empty, motor torque, N·m; NaN where it is not known.
    /// * `temperature_c`: °C; NaN where it is not known.
    ///
    /// # Errors
    /// [`StepError::Length`], [`StepError::TimeStep`]; the clock is then unchanged.
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
            stated => self.frame.tau_m.copy_from_slice(stated),
        }
        self.frame.temperature_c = temperature_c;
        Ok(&mut self.frame)
    }

    /// Samples that follow do not go on where the last one was.
    pub(crate) fn interrupt(&mut self) {
        self.frame.segment = self.frame.segment.wrapping_add(1);
    }
}
