//! Incidents: one per tendon from the first suspected change to the repair.
//!
//! ```text
//!   suspected change ─▶ suspected ──confirmed──▶ confirmed ──acknowledged──▶ acknowledged
//!                  │ refuted                  │                           │
//!                  ▼        finding: no repair needed, or alarm reset     │ re-tensioned, replaced
//!                closed ◀─────────────────────┴───────────────────────────┤
//!                  ▲ finding                                              ▼
//!                  └──────────────────────────────────────────────── repaired
//! ```
//!
//! A tendon has at most one open incident; further suspected changes, confirmed changes and alarms of its rope join it. An
//! incident that was repaired without a finding ends with the next suspected change, which opens another.

use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;

/// Maximum number of pieces of evidence of an incident: the first half and the last half remain.
const MAX_EVIDENCE: usize = 64;
/// Maximum number of closed incidents of a robot; the oldest are discarded.
const MAX_CLOSED: usize = 50;

/// Incident of a tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Incident {
    /// Name of the joint.
    pub joint: String,
    /// Number of the incident, counted from the robot's first.
    pub number: u64,
    /// Time at which the incident was opened, s since 1970 UTC.
    pub opened_utc_s: f64,
    /// Phase of the incident.
    pub phase: IncidentPhase,
    /// Time at which the incident was closed, s since 1970 UTC; `None`: open.
    pub closed_utc_s: Option<f64>,
    /// Evidence in chronological order: of the suspected change, of each later session, and of confirmed changes.
    pub evidence: Vec<Evidence>,
    /// Probabilities of the causes by all evidence, the most probable first; they sum to 1.
    pub causes: Vec<CauseProbability>,
    /// Finding of the inspection; `None`: not recorded.
    pub finding: Option<Finding>,
    /// Note on the finding.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// Phase of an incident.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum IncidentPhase {
    /// A change is suspected.
    Suspected,
    /// A change was confirmed.
    Confirmed,
    /// An operator acknowledged the alarm.
    Acknowledged,
    /// The tendon was re-tensioned or replaced; the finding is not recorded.
    Repaired,
    /// The suspected change was refuted, or the finding is recorded and the tendon is in order.
    Closed,
}

/// Evidence of an incident.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Evidence {
    /// Time of the suspected change, or end of the session, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Offset since the last tensioning, rad; `None`: inconclusive.
    pub offset_rad: Option<Gaussian>,
    /// Stiffness relative to nominal, minus 1; `None`: inconclusive.
    pub stiffness_ratio: Option<Gaussian>,
    /// Probability of a lasting change by all evidence so far, 0…1.
    pub probability: f64,
}

/// Probability of a cause.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CauseProbability {
    /// Cause of the change.
    pub cause: IncidentCause,
    /// Probability of the cause, 0…1.
    pub probability: f64,
}

/// Cause of an incident.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum IncidentCause {
    /// Strand failure, with a loss of stiffness.
    StrandFailure,
    /// Slip of rope or clamp.
    Slip,
    /// Slip of an encoder.
    Encoder,
    /// Slip of rope, clamp or encoder, which the data do not distinguish.
    SlipOrEncoder,
    /// Loss of the transmission.
    TransmissionLost,
    /// Re-tensioning that was not recorded.
    Retensioned,
    /// No lasting change.
    NoChange,
}

/// Finding of the inspection of a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Finding {
    /// A strand or the rope failed.
    StrandFailure,
    /// The rope slipped.
    Slip,
    /// A clamp slipped.
    ClampSlip,
    /// An encoder moved, or was homed again.
    EncoderMoved,
    /// Nothing was found.
    Nothing,
    /// Other finding, described in the note.
    Other,
}

impl Finding {
    /// Cause that the finding confirms; `None`: the finding is not one of the causes.
    fn cause(self) -> Option<IncidentCause> {
        Some(match self {
            Self::StrandFailure => IncidentCause::StrandFailure,
            Self::Slip | Self::ClampSlip => IncidentCause::Slip,
            Self::EncoderMoved => IncidentCause::Encoder,
            Self::Nothing => IncidentCause::NoChange,
            Self::Other => return None,
        })
    }

    /// Returns the probabilities of the causes given the finding, by Bayes' theorem with the assumption that the inspection
    /// is right: causes that it excludes are omitted, and the probabilities of the others are normalised. If the data
    /// exclude all others, the finding is the only cause.
    fn condition(self, causes: &[CauseProbability]) -> Vec<CauseProbability> {
        let Some(found) = self.cause() else {
            return causes.to_vec();
        };
        let remaining = causes.iter().filter_map(|one| {
            let cause = match one.cause {
                IncidentCause::SlipOrEncoder
                    if matches!(found, IncidentCause::Slip | IncidentCause::Encoder) =>
                {
                    found
                }
                // A torn rope or a detached clamp transmits nothing.
                IncidentCause::TransmissionLost if self.needs_repair() => one.cause,
                cause if cause == found => cause,
                _ => return None,
            };
            Some(CauseProbability { cause, ..*one })
        });
        let mut remaining: Vec<CauseProbability> = remaining.collect();
        let sum: f64 = remaining.iter().map(|one| one.probability).sum();
        if !(sum > 0.0) {
            return vec![CauseProbability {
                cause: found,
                probability: 1.0,
            }];
        }
        for one in &mut remaining {
            one.probability /= sum;
        }
        remaining
    }

    /// Whether the tendon remains faulty until it is re-tensioned or replaced.
    pub fn needs_repair(self) -> bool {
        matches!(self, Self::StrandFailure | Self::Slip | Self::ClampSlip)
    }
}

impl Incident {
    /// Whether the incident is open.
    pub fn is_open(&self) -> bool {
        self.phase != IncidentPhase::Closed
    }

    /// Whether the transmission is lost by the evidence, and the tendon not repaired.
    pub(crate) fn is_transmission_lost(&self) -> bool {
        let cause = self.causes.first().map(|one| one.cause);
        let is_open = matches!(
            self.phase,
            IncidentPhase::Confirmed | IncidentPhase::Acknowledged
        );
        is_open && cause == Some(IncidentCause::TransmissionLost)
    }

    fn add(&mut self, evidence: Evidence) {
        self.evidence.push(evidence);
        if self.evidence.len() > MAX_EVIDENCE {
            self.evidence.remove(MAX_EVIDENCE / 2);
        }
    }

    fn close(&mut self, utc_s: f64) {
        (self.phase, self.closed_utc_s) = (IncidentPhase::Closed, Some(utc_s));
    }
}

/// Incidents of the tendons of a robot.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Incidents {
    /// Incidents in the order of their numbers.
    list: Vec<Incident>,
    /// Number of incidents so far.
    count: u64,
}

impl Incidents {
    /// Iterates over the incidents, the oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &Incident> {
        self.list.iter()
    }

    /// Continues the numbers of other incidents, so that no number of the robot is used twice: recordings and journal
    /// entries refer to it.
    pub(crate) fn continue_numbers(&mut self, other: &Self) {
        self.count = self.count.max(other.count);
    }

    /// Returns the open incident of a joint.
    pub fn open(&self, joint: &str) -> Option<&Incident> {
        (self.list.iter()).find(|incident| incident.joint == joint && incident.is_open())
    }

    fn open_mut(&mut self, joint: &str) -> Option<&mut Incident> {
        (self.list.iter_mut()).find(|incident| incident.joint == joint && incident.is_open())
    }

    /// Returns the open incident of a joint; opens one if there is none, or if the last one is repaired.
    fn opened(&mut self, joint: &str, utc_s: f64) -> &mut Incident {
        if let Some(repaired) = self.open_mut(joint)
            && repaired.phase == IncidentPhase::Repaired
        {
            repaired.close(utc_s);
        }
        let found = self
            .list
            .iter()
            .position(|i| i.joint == joint && i.is_open());
        let at = found.unwrap_or_else(|| {
            let closed = self.list.iter().filter(|i| !i.is_open()).count();
            if closed >= MAX_CLOSED
                && let Some(oldest) = self.list.iter().position(|i| !i.is_open())
            {
                self.list.remove(oldest);
            }
            self.count += 1;
            self.list.push(Incident {
                joint: joint.into(),
                number: self.count,
                opened_utc_s: utc_s,
                phase: IncidentPhase::Suspected,
                closed_utc_s: None,
                evidence: Vec::new(),
                causes: Vec::new(),
                finding: None,
                note: String::new(),
            });
            self.list.len() - 1
        });
        &mut self.list[at]
    }

    /// Adds evidence for or against a suspected change; opens an incident if there is none.
    pub fn suspect(
        &mut self,
        joint: &str,
        evidence: Evidence,
        causes: Vec<CauseProbability>,
        utc_s: f64,
    ) -> &Incident {
        let incident = self.opened(joint, utc_s);
        incident.add(evidence);
        // A second suspected change leaves the causes of a confirmed change.
        if incident.phase == IncidentPhase::Suspected {
            incident.causes = causes;
        }
        incident
    }

    /// Adds a confirmed change; opens an incident if there is none.
    pub fn confirm(
        &mut self,
        joint: &str,
        evidence: Evidence,
        causes: Vec<CauseProbability>,
        utc_s: f64,
    ) -> &Incident {
        let incident = self.opened(joint, utc_s);
        incident.add(evidence);
        (incident.causes, incident.phase) = (causes, IncidentPhase::Confirmed);
        incident
    }

    /// Adds the evidence that refutes a suspected change. Closes the incident unless a change was confirmed before.
    pub fn refute(
        &mut self,
        joint: &str,
        evidence: Evidence,
        causes: Vec<CauseProbability>,
        utc_s: f64,
    ) -> Option<&Incident> {
        let incident = self.open_mut(joint)?;
        incident.add(evidence);
        if incident.phase == IncidentPhase::Suspected {
            incident.causes = causes;
            incident.close(utc_s);
        }
        Some(incident)
    }

    /// Notes that an operator acknowledged an alarm of the tendon.
    pub fn acknowledge(&mut self, joint: &str) -> Option<&Incident> {
        let incident = self.open_mut(joint)?;
        if incident.phase != IncidentPhase::Confirmed {
            return None;
        }
        incident.phase = IncidentPhase::Acknowledged;
        Some(incident)
    }

    /// Notes that the tendon was re-tensioned or replaced; closes the incident if its finding is recorded.
    pub fn repair(&mut self, joint: &str, utc_s: f64) -> Option<&Incident> {
        let incident = self.open_mut(joint)?;
        match incident.finding {
            Some(_) => incident.close(utc_s),
            None => incident.phase = IncidentPhase::Repaired,
        }
        Some(incident)
    }

    /// Records the finding of an inspection; closes the incident if the tendon is repaired or needs no repair.
    pub fn find(
        &mut self,
        joint: &str,
        finding: Finding,
        note: &str,
        utc_s: f64,
    ) -> Option<&Incident> {
        let incident = self.open_mut(joint)?;
        (incident.finding, incident.note) = (Some(finding), note.into());
        incident.causes = finding.condition(&incident.causes);
        if incident.phase == IncidentPhase::Repaired || !finding.needs_repair() {
            incident.close(utc_s);
        } else {
            incident.phase = IncidentPhase::Acknowledged;
        }
        Some(incident)
    }

    /// Closes the incident of a tendon whose alarm was reset with a note.
    pub fn reset(&mut self, joint: &str, note: &str, utc_s: f64) -> Option<&Incident> {
        let incident = self.open_mut(joint)?;
        incident.note = note.into();
        incident.close(utc_s);
        Some(incident)
    }
}
