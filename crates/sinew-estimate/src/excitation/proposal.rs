//! A list of poses with what to expect of it, and as a file.

use serde::Serialize;
use sinew_files::{JsonDocument, csv_cell};
use std::fmt::Write as _;

/// Poses to visit, and what to expect from it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Proposal {
    /// The robot.
    pub robot: String,
    /// Its joints, in the order of a pose.
    pub joints: Vec<String>,
    /// The poses, in order.
    pub poses: Vec<Pose>,
    /// Length of the recording, s, with a rest before the first move.
    pub duration_s: f64,
    /// What to expect, per elastic joint.
    pub expected: Vec<Expected>,
    /// What the expectation rests on.
    pub baseline: BaselineSource,
    /// Whether the gripper may hold something unknown.
    pub payload: bool,
    /// Bits of the joint encoder assumed.
    pub joint_bits: u32,
    /// Lists of poses that were looked at.
    pub lists_tried: usize,
    /// What the intervals of a robot exactly as described were multiplied by.
    pub inflation_factor: f64,
}

/// One pose of a list.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Pose {
    /// Positions in the order of the joints, rad (m).
    pub pose_rad: Vec<f64>,
    /// Length of the move to it, s.
    pub move_s: f64,
    /// Rest there, s.
    pub pause_s: f64,
}

/// What to expect of one joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Expected {
    /// Joint.
    pub name: String,
    /// Standard deviation of its offset, rad.
    pub offset_deviation_rad: f64,
    /// The same as elongation, m; `None` without tendon geometry.
    pub elongation_deviation_m: Option<f64>,
    /// The same for random poses, median of the random lists, rad.
    pub random_offset_deviation_rad: f64,
    /// Whether the poses show the offset.
    pub identifiable: bool,
}

/// Which baseline the expectation rests on.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum BaselineSource {
    /// One that was given.
    Given {
        /// Its file.
        file: String,
        /// Recordings it was learned from.
        recordings: Vec<String>,
    },
    /// What random poses right after tensioning would teach.
    Assumed {
        /// How many.
        poses: usize,
        /// Length of their recording, s.
        duration_s: f64,
    },
}

impl JsonDocument for Proposal {
    const SCHEMA: &'static str = "sinew/excitation/1";
}

impl Proposal {
    /// What the reader should know, in sentences.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![
            "poses stay 10 % of the range away from the limits and take at most half of the effort to hold an empty gripper; moves stay below half of the speed limits".into(),
            "collisions, cables and people are not checked; Sinew never commands the robot".into(),
            format!("intervals are {} times those of a robot exactly as described, which is what simulated robots of scenario S6 showed on the BioRob-like arm; another arm may differ", self.inflation_factor),
        ];
        let unseen = self.expected.iter().filter(|e| !e.identifiable);
        notes.extend(unseen.map(|e| {
            format!(
                "{}: no poses found that show its offset; gravity hardly loads it, or its range is too small",
                e.name
            )
        }));
        notes
    }

    /// A motion for `sinew simulate`: a scenario of this robot that visits the poses.
    pub fn to_toml(&self) -> String {
        let mut out = String::new();
        for note in self.notes() {
            // Writing to a string can't fail.
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
        // Rest at the first pose too: the filters settle.
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

    /// A row per pose: `move_s`, `pause_s`, then every joint.
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

/// A joint's name as a TOML key.
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
