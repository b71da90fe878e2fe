//! A proposal as a file.

use super::Proposal;
use std::fmt::Write as _;

impl Proposal {
    /// A motion for `sinew simulate`: a scenario of this robot that visits the poses.
    pub fn to_toml(&self) -> String {
        let mut out = String::new();
        for note in &self.notes {
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
            let name = if joint.contains([',', '"']) {
                format!("\"{}\"", joint.replace('"', "\"\""))
            } else {
                joint.clone()
            };
            let _ = write!(out, ",{name}_rad");
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
