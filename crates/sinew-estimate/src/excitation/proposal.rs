//! Proposed poses with the expected intervals, and their file formats.

use serde::Serialize;
use sinew_files::{JsonDocument, csv_cell};
use std::fmt::Write as _;

/// Proposed poses and the expected intervals.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Proposal {
    /// Name of the robot.
    pub robot: String,
    /// Names of the joints, in the order of a pose.
    pub joints: Vec<String>,
    /// Poses in the order of the visit.
    pub poses: Vec<Pose>,
    /// Duration of the recording including a rest before the first move, s.
    pub duration_s: f64,
    /// Expected standard deviations, one entry per elastic joint.
    pub expected: Vec<Expected>,
    /// Baseline on which the expectation is based.
    pub baseline: BaselineSource,
    /// Whether the gripper may hold an unknown payload.
    pub payload: bool,
    /// Assumed resolution of the joint encoder, bits per revolution.
    pub joint_bits: u32,
    /// Number of pose lists evaluated.
    pub lists_tried: usize,
    /// Factor by which the intervals of the nominal robot were widened.
    pub inflation_factor: f64,
}

/// Pose of a proposed list.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Pose {
    /// Joint positions in the order of the joints, rad (m).
    pub pose_rad: Vec<f64>,
    /// Duration of the move to the pose, s.
    pub move_s: f64,
    /// Duration of the rest at the pose, s.
    pub pause_s: f64,
}

/// Expected standard deviation of one joint's offset.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Expected {
    /// Name of the joint.
    pub name: String,
    /// Standard deviation of the offset, rad.
    pub offset_std_rad: f64,
    /// Standard deviation of the elongation, m; none without tendon geometry.
    pub elongation_std_m: Option<f64>,
    /// Standard deviation of the offset with random poses, median of the random lists, rad.
    pub random_offset_std_rad: f64,
    /// Whether the poses make the offset identifiable.
    pub identifiable: bool,
}

/// Baseline on which an expectation is based.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum BaselineSource {
    /// Baseline of a specified file.
    Given {
        /// Name of the baseline file.
        file: String,
        /// Recordings from which the baseline was estimated.
        recordings: Vec<String>,
    },
    /// Simulated baseline of random poses directly after tensioning.
    Assumed {
        /// Number of poses.
        poses: usize,
        /// Duration of the simulated recording, s.
        duration_s: f64,
    },
}

impl JsonDocument for Proposal {
    const SCHEMA: &'static str = "sinew/excitation/2";
}

impl Proposal {
    /// Returns notes on assumptions and limits of the proposal, as sentences.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![
            "poses keep a distance of 10 % of the range from the limits and need at most half of the effort limit with an empty gripper; moves stay below half of the speed limits".into(),
            "collisions, cables and people are not checked; Sinew never commands the robot".into(),
            format!("intervals of the nominal robot are widened by a factor of {}, the ratio found with simulated robots of scenario S6 on the BioRob-like arm; another arm may differ", self.inflation_factor),
        ];
        let unobservable = self.expected.iter().filter(|e| !e.identifiable);
        notes.extend(unobservable.map(|e| {
            format!(
                "{}: no poses found that make its offset identifiable; its gravity load or its range is too small",
                e.name
            )
        }));
        notes
    }

    /// Writes a scenario for `sinew simulate` that visits the poses.
    pub fn to_toml(&self) -> String {
        let mut out = String::new();
        for note in self.notes() {
            // Writing to a string cannot fail.
            let _ = writeln!(out, "# {note}");
        }
        let pose = |pose_rad: &[f64]| -> String {
            let entries: Vec<String> = self
                .joints
                .iter()
                .zip(pose_rad)
                .map(|(joint, q)| format!("{} = {q:?}", quoted(joint)))
                .collect();
            format!("{{ {} }}", entries.join(", "))
        };
        let Some((first, rest)) = self.poses.split_first() else {
            return out;
        };
        let _ = writeln!(
            out,
            "name = \"excitation\"\nduration_s = {:.2}",
            self.duration_s
        );
        let _ = writeln!(out, "\n[motion]\nkind = \"waypoints\"");
        let _ = writeln!(out, "start_rad = {}", pose(&first.pose_rad));
        // Rest also at the first pose, so that the filters settle.
        let rest_s = self.duration_s - rest.iter().map(|p| p.move_s + p.pause_s).sum::<f64>();
        let stay = [(first, 0.01, (rest_s - 0.01).max(0.0))];
        let moves = rest.iter().map(|p| (p, p.move_s, p.pause_s));
        for (p, move_s, pause_s) in stay.into_iter().chain(moves) {
            let _ = writeln!(
                out,
                "[[motion.waypoints]]\npose_rad = {}",
                pose(&p.pose_rad)
            );
            let _ = writeln!(out, "move_s = {move_s:.2}\npause_s = {pause_s:.2}");
        }
        out
    }

    /// Writes one row per pose: `move_s`, `pause_s`, then the position of every joint.
    pub fn to_csv(&self) -> String {
        let mut out = String::from("move_s,pause_s");
        for joint in &self.joints {
            let _ = write!(out, ",{}", csv_cell(&format!("{joint}_rad")));
        }
        out.push('\n');
        for pose in &self.poses {
            let _ = write!(out, "{},{}", pose.move_s, pose.pause_s);
            for q in &pose.pose_rad {
                let _ = write!(out, ",{q}");
            }
            out.push('\n');
        }
        out
    }
}

/// Formats a joint's name as a TOML key.
fn quoted(name: &str) -> String {
    let bare = !name.is_empty()
        && name
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if bare {
        name.into()
    } else {
        toml::Value::from(name).to_string()
    }
}
