//! Coverage of a recording by one signal.

/// Samples of one signal, frame by frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Coverage {
    /// Number of frames with a finite value.
    pub(crate) samples: u64,
    /// Number of samples with the value of the sample before.
    pub(crate) repeated: u64,
    /// Time of the first sample, ns.
    pub(crate) start_ns: Option<i64>,
    /// Time of the last sample, ns.
    pub(crate) last_ns: i64,
    /// Longest interval between two samples, ns.
    pub(crate) hole_ns: i64,
    last: f64,
}

impl Default for Coverage {
    fn default() -> Self {
        Self {
            samples: 0,
            repeated: 0,
            start_ns: None,
            last_ns: 0,
            hole_ns: 0,
            last: f64::NAN,
        }
    }
}

impl Coverage {
    /// Takes the value of the next frame.
    #[inline]
    pub(crate) fn frame(&mut self, time_ns: i64, value: f64) {
        if !value.is_finite() {
            return;
        }
        if self.start_ns.is_none() {
            self.start_ns = Some(time_ns);
        } else {
            self.hole_ns = self.hole_ns.max(time_ns.saturating_sub(self.last_ns));
        }
        self.samples += 1;
        self.repeated += u64::from(value == self.last);
        self.last = value;
        self.last_ns = time_ns;
    }
}
