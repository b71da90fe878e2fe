//! What happened in a recording, in sentences.

use super::answer::{Absolute, AbsoluteJoint, Step};
use sinew_figure::rounded;

impl Absolute {
    /// What happened, a sentence each.
    pub fn sentences(&self) -> Vec<String> {
        let mut out: Vec<String> = self.joints.iter().flat_map(of_joint).collect();
        out.extend(self.payload_changes.iter().map(|change| {
            format!(
                "payload changed by {} ± {} kg {}",
                rounded(change.change_kg, 2),
                rounded(change.interval_95_kg, 2),
                when(change.time_s, change.between_s, change.probability)
            )
        }));
        let steps = self.joints.iter().flat_map(|j| &j.steps);
        let mut stated = (steps.map(|s| s.probability))
            .chain(self.payload_changes.iter().map(|c| c.probability));
        if stated.any(|p| p.is_some()) {
            out.push(
                "probabilities rest on this recording, and on odds of a change that are starting guesses"
                    .into(),
            );
        }
        out.push(format!(
            "payload {} ± {} kg{}; {:.0} % of the time left out as contact or disturbance; {} poses{}",
            rounded(self.payload_kg[0], 2),
            rounded(self.payload_kg[1], 2),
            if self.payload_changes.is_empty() {
                ""
            } else {
                " at the end"
            },
            100.0 * self.left_out_share,
            self.poses,
            match (self.motor_torque, self.motor_current) {
                (true, true) => "; motor current used",
                (true, false) => "; motor torque used",
                (false, _) => "",
            }
        ));
        out
    }
}

/// What happened to a tendon.
fn of_joint(joint: &AbsoluteJoint) -> Vec<String> {
    let mut out = Vec::new();
    if let (Some(true), Some(limit)) = (joint.limit_passed, joint.retension_at_mm) {
        out.push(format!(
            "past the {} mm at which to tension again",
            rounded(limit, 2)
        ));
    }
    out.extend(joint.steps.iter().map(of_step));
    if let Some([slack, unsure]) = joint.slack_mrad {
        out.push(format!(
            "dead zone of ± {} mrad (± {} at 95 %); near zero torque its position is unknown by that",
            rounded(slack, 2),
            rounded(unsure, 2)
        ));
    }
    let named = out
        .into_iter()
        .map(|said| format!("{}: {said}", joint.name));
    named.collect()
}

fn of_step(step: &Step) -> String {
    let stiffness = match step.stiffness_change_percent {
        Some([change, unsure]) => {
            format!(
                "stiffness {} ± {} %",
                rounded(change, 2),
                rounded(unsure, 2)
            )
        }
        None => "no loss of stiffness seen".into(),
    };
    if step.kind.ends_with("since before") {
        // It has no moment in this recording.
        return format!("{stiffness}: {}", step.kind);
    }
    let when = when(step.time_s, step.between_s, step.probability);
    if step.interval_95_mrad == 0.0 {
        return format!("{stiffness} {when} without a slip: {}", step.kind);
    }
    format!(
        "a sudden change of {} ± {} mrad {when}, {stiffness}: {}",
        rounded(step.size_mrad, 3),
        rounded(step.interval_95_mrad, 2),
        step.cause_said
    )
}

/// A change's moment, and how sure it is.
fn when(time_s: f64, between_s: Option<[f64; 2]>, probability: Option<f64>) -> String {
    const SURE: f64 = 0.999;
    let (Some([from_s, to_s]), Some(probability)) = (between_s, probability) else {
        return format!("at {time_s:.1} s");
    };
    let sure = if probability > SURE {
        format!("> {SURE}")
    } else {
        format!("{probability:.2}")
    };
    format!("at {time_s:.1} s ({from_s:.1} to {to_s:.1}; probability {sure})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_happened_is_said_with_its_moment_size_and_how_sure_it_is() {
        let slip = Step {
            time_s: 34.2,
            between_s: Some([33.9, 34.6]),
            probability: Some(0.95),
            size_mrad: 5.125,
            interval_95_mrad: 0.41,
            stiffness_change_percent: None,
            kind: "slip".into(),
            cause: "rope".into(),
            cause_said: "the rope slipped".into(),
        };
        let kind = |kind: &str, stiffness| Step {
            kind: kind.into(),
            cause_said: "a strand has failed".into(),
            stiffness_change_percent: stiffness,
            ..slip.clone()
        };
        let cases = [
            (
                slip.clone(),
                "a sudden change of 5.12 ± 0.41 mrad at 34.2 s (33.9 to 34.6; probability 0.95), no loss of stiffness seen: the rope slipped",
            ),
            (
                kind("strand failure", Some([-4.0, 1.5])),
                "a sudden change of 5.12 ± 0.41 mrad at 34.2 s (33.9 to 34.6; probability 0.95), stiffness −4.0 ± 1.5 %: a strand has failed",
            ),
            (
                kind("softer since before", Some([-4.0, 1.5])),
                "stiffness −4.0 ± 1.5 %: softer since before",
            ),
            (
                Step {
                    size_mrad: 0.0,
                    interval_95_mrad: 0.0,
                    probability: Some(0.99999),
                    ..kind("strand failure", Some([-4.0, 1.5]))
                },
                "stiffness −4.0 ± 1.5 % at 34.2 s (33.9 to 34.6; probability > 0.999) without a slip: strand failure",
            ),
        ];
        for (step, said) in cases {
            assert_eq!(of_step(&step), said);
        }
        assert_eq!(when(3.04, None, None), "at 3.0 s");
    }
}
