//! External torque and contact detection, computed along with a simulation.

use crate::SimulateError;
use crate::scenario::ContactDetection;
use sinew_model::StepError;
use sinew_model::correction::{
    ContactConfig, ContactDetector, ContactTolerances, ExternalTorqueConfig,
    ExternalTorqueObserver, JointCorrection,
};
use sinew_model::offset::VelocityFilter;
use sinew_model::robot::Robot;

/// One detector with a factor on the threshold.
#[derive(Debug, Clone)]
struct Alarm {
    factor: f64,
    detector: ContactDetector,
    since_s: Option<f64>,
    /// Start and end of each alarm, s.
    intervals: Vec<(f64, f64)>,
}

/// External torque observer with detectors of several sensitivities.
#[derive(Debug, Clone)]
pub(super) struct Detection {
    observer: ExternalTorqueObserver,
    alarms: Vec<Alarm>,
    scaled: Vec<f64>,
    last_s: Option<f64>,
}

/// Observer and first detector after one sample.
#[derive(Debug, Clone, Copy)]
pub struct DetectionSample<'a> {
    /// External torque, N·m, one per joint.
    pub tau_ext: &'a [f64],
    /// Detection threshold of each joint, N·m.
    pub threshold: &'a [f64],
    /// Whether the first detector sees a contact.
    pub touching: bool,
}

impl Detection {
    pub(super) fn new(
        robot: &Robot,
        corrections: &[JointCorrection],
        detection: &ContactDetection,
        noise_nm: &[f64],
        factors: &[f64],
    ) -> Result<Self, SimulateError> {
        let tolerances = ContactTolerances {
            sigmas: detection.sigmas,
            noise_nm: noise_nm.to_vec(),
            mass_std: detection.mass_std,
            friction_share: detection.friction_share,
        };
        let config = ExternalTorqueConfig {
            gain_per_s: detection.gain_per_s,
            velocity: VelocityFilter::StateVariable {
                cutoff_rad_per_s: detection.cutoff_rad_per_s,
            },
        };
        let contact = ContactConfig {
            release_share: detection.release_share,
            confirm_s: detection.confirm_s,
        };
        let n = robot.arm.dof();
        let alarms = factors
            .iter()
            .map(|&factor| {
                Ok(Alarm {
                    factor,
                    detector: ContactDetector::new(n, contact)?,
                    since_s: None,
                    intervals: Vec::new(),
                })
            })
            .collect::<Result<_, SimulateError>>()?;
        Ok(Self {
            observer: ExternalTorqueObserver::new(
                &robot.arm,
                &robot.transmissions,
                corrections,
                config,
                tolerances,
            )?,
            alarms,
            scaled: vec![0.0; n],
            last_s: None,
        })
    }

    /// Sets the correction of joint `i` from the present sample on.
    pub(super) fn set_correction(
        &mut self,
        i: usize,
        correction: &JointCorrection,
    ) -> Result<(), SimulateError> {
        Ok(self.observer.set(i, correction)?)
    }

    /// Takes a sample at `t`, s.
    pub(super) fn step(&mut self, t: f64, q: &[f64], theta: &[f64]) -> Result<(), StepError> {
        let dt = self.last_s.map_or(1.0, |last| t - last);
        self.observer.step(dt, q, theta, None)?;
        self.last_s = Some(t);
        for alarm in &mut self.alarms {
            for (scaled, threshold) in self.scaled.iter_mut().zip(self.observer.threshold()) {
                *scaled = alarm.factor * threshold;
            }
            if !self.observer.is_settled() {
                continue;
            }
            let touching = alarm
                .detector
                .step(dt, self.observer.tau_ext(), &self.scaled)?;
            match (touching, alarm.since_s) {
                (true, None) => alarm.since_s = Some(t),
                (false, Some(since)) => {
                    alarm.intervals.push((since, t));
                    alarm.since_s = None;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Start of detection, s after the first sample.
    pub(super) fn settling_time_s(&self) -> f64 {
        self.observer.settling_time_s()
    }

    pub(super) fn sample(&self) -> DetectionSample<'_> {
        DetectionSample {
            tau_ext: self.observer.tau_ext(),
            threshold: self.observer.threshold(),
            touching: self
                .alarms
                .first()
                .is_some_and(|a| a.detector.is_touching()),
        }
    }

    /// Ends ongoing alarms at `end_s` and returns factor and alarms of each detector.
    pub(super) fn finish(self, end_s: f64) -> impl Iterator<Item = (f64, Vec<(f64, f64)>)> {
        self.alarms.into_iter().map(move |mut alarm| {
            alarm.intervals.extend(alarm.since_s.map(|s| (s, end_s)));
            (alarm.factor, alarm.intervals)
        })
    }
}
