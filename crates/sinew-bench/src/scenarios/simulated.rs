//! Recording in memory with its truth.

use super::bound::BoundRecorder;
use super::paper::PaperMeans;
use super::{ScenarioError, Sessions, estimator};
use sinew_estimate::session::{Recorded, Recorder};
use sinew_log::Frame;
use sinew_model::offset::Comparison;
use sinew_sim::protocol::Plan;
use sinew_sim::{FaultyLine, SimulateError, Simulation};

/// Blocks of the sessions, and their true values.
pub(super) struct Simulated {
    pub(super) sessions: Vec<Recorded>,
    /// Per joint at the end of B, and at the end of the last session: since the end of A, whose baseline calls
    /// it zero.
    pub(super) truth_rad: Vec<f64>,
    pub(super) truth_at_end_rad: Vec<f64>,
    /// Joint, time and size (rad) of every slip after B.
    pub(super) slips: Vec<(usize, f64, f64)>,
    pub(super) payload_kg: f64,
    /// Bound per joint, rad.
    pub(super) bound_rad: Option<Vec<f64>>,
    /// Estimates with the lag of the paper, and matched.
    pub(super) means: [PaperMeans; 2],
    /// Offset of every joint since the end of A, for every block of the last session, rad.
    pub(super) truth_of_blocks_rad: Vec<Vec<f64>>,
}

/// Receivers of the frames of a recording, session by session.
struct Takers {
    spans: Vec<(f64, f64)>,
    start_ns: i64,
    recorders: Vec<Recorder>,
    means: [PaperMeans; 2],
}

impl Takers {
    fn session(&self, t: f64) -> Option<usize> {
        self.spans.iter().position(|s| (s.0..s.1).contains(&t))
    }

    fn take(&mut self, frame: &Frame) {
        let t = (frame.time_ns - self.start_ns) as f64 * 1e-9;
        if let Some(k) = self.session(t) {
            self.recorders[k].push(frame, t);
            for mean in &mut self.means {
                mean.push(frame, k);
            }
        }
    }
}

impl Simulated {
    /// Simulates `plan` with `seed`, for the sessions in `assessed`.
    pub(super) fn new(plan: &Plan, seed: u64, assessed: Sessions) -> Result<Self, ScenarioError> {
        let sessions = if assessed == Sessions::B { 2 } else { 3 };
        let spans = plan.scenario.sessions[..sessions].iter();
        let spans = spans.map(|s| (s.from_s, s.to_s)).collect();
        Self::of_spans(plan, seed, spans)
    }

    /// Simulates `plan` with `seed`; B and C are one session.
    pub(super) fn as_one(plan: &Plan, seed: u64) -> Result<Self, ScenarioError> {
        let [a, b, c] = [0, 1, 2].map(|k| &plan.scenario.sessions[k]);
        Self::of_spans(plan, seed, vec![(a.from_s, a.to_s), (b.from_s, c.to_s)])
    }

    fn of_spans(plan: &Plan, seed: u64, spans: Vec<(f64, f64)>) -> Result<Self, ScenarioError> {
        let mut scenario = plan.scenario.clone();
        scenario.seed = seed;
        let sessions = spans.len();
        scenario.duration_s = spans.last().map(|s| s.1);
        let mut takers = Takers {
            spans,
            start_ns: scenario.start_time_ns,
            recorders: vec![estimator::recorder(&plan.robot); sessions],
            means: [
                PaperMeans::new(&plan.robot, Comparison::Paper, sessions)?,
                PaperMeans::new(&plan.robot, Comparison::Matched, sessions)?,
            ],
        };
        let mut simulation = Simulation::new(&plan.simulated, &scenario)?;
        let mut line = FaultyLine::new(&scenario.faults, seed, scenario.start_time_ns);
        let mut bound = BoundRecorder::new(plan);
        while let Some(frame) = simulation.next_frame()? {
            let time_ns = frame.time_ns;
            line.pass(frame, &mut |f| {
                takers.take(f);
                Ok(())
            })
            .map_err(SimulateError::from)?;
            if let Some(k) = takers.session(simulation.true_state().time_s) {
                bound.push(k, &simulation, time_ns);
            }
        }
        line.flush(&mut |f| {
            takers.take(f);
            Ok(())
        })
        .map_err(SimulateError::from)?;
        Ok(Self::of(plan, &simulation, takers, bound))
    }

    fn of(plan: &Plan, simulation: &Simulation, takers: Takers, bound: BoundRecorder) -> Self {
        let end_of_b_s = plan.scenario.sessions[1].to_s;
        let sessions: Vec<Recorded> = takers
            .recorders
            .into_iter()
            .zip(&takers.spans)
            .map(|(recorder, span)| {
                let mut recorded = recorder.finish();
                recorded.duration_s = span.1 - span.0;
                recorded
            })
            .collect();
        // Effects outside the model have no bound within it.
        let bound_rad = match plan.about {
            None => bound.finish(plan, simulation, &sessions),
            Some(_) => None,
        };
        // Just before the end: a step at the start of C is not part of B.
        let before = |end_s: f64| end_s - 1.0 / plan.scenario.sample_rate_hz;
        let at_s = before(end_of_b_s);
        let ends_s: Vec<f64> = takers.spans.iter().map(|span| before(span.1)).collect();
        let since_a = |end_s: f64| -> Vec<f64> {
            let offset = |i, at_s| simulation.offset_at(i, at_s).sum();
            (0..plan.robot.arm.dof())
                .map(|i| offset(i, end_s) - offset(i, ends_s[0]))
                .collect()
        };
        let last = sessions.last().map_or(&[][..], |session| &session.blocks);
        Self {
            truth_of_blocks_rad: last.iter().map(|b| since_a(b.time_s)).collect(),
            truth_rad: since_a(at_s),
            truth_at_end_rad: since_a(ends_s[ends_s.len() - 1]),
            slips: simulation
                .offsets()
                .iter()
                .filter_map(|o| Some((o.joint, o.shape.step_s()?, o.size_rad)))
                .filter(|slip| slip.1 >= end_of_b_s)
                .collect(),
            payload_kg: simulation
                .payloads()
                .iter()
                .filter(|p| p.attach_s <= at_s && at_s < p.release_s)
                .map(|p| p.mass_kg)
                .sum(),
            sessions,
            bound_rad,
            means: takers.means,
        }
    }
}
