//! Invalid scenarios and their error messages.

use super::{biorob_like, pendulum, repository};
use crate::{Scenario, Simulation};

const GOOD: &str = "duration_s = 1.0\n[motion]\nkind = \"hold\"\n";

fn refused(text: &str) -> String {
    match Scenario::from_toml(text, "bad.toml") {
        Ok(scenario) => Simulation::new(&biorob_like(), &scenario)
            .err()
            .map(|e| e.to_string())
            .unwrap_or_else(|| panic!("accepted: {text}")),
        Err(e) => e.to_string(),
    }
}

#[test]
fn valid_scenario_is_accepted() {
    assert!(Scenario::from_toml(GOOD, "good.toml").is_ok());
}

#[test]
fn errors_name_file_line_key_value_unit() {
    let cases: [(&str, &[&str]); 25] = [
        ("", &["bad.toml", "[motion]"]),
        ("duration_s = ", &["bad.toml"]),
        ("duration_s = nan", &["motion"]),
        (
            "duration_s = nan\n[motion]\nkind = \"hold\"",
            &["line 1", "duration_s = nan (s)", "above 0"],
        ),
        (
            "duration_s = -3\n[motion]\nkind = \"hold\"",
            &["line 1", "duration_s = -3 (s)", "above 0"],
        ),
        (
            "duration_s = \"3\"\n[motion]\nkind = \"hold\"",
            &["line 1", "a number"],
        ),
        (
            "seed = -1\n[motion]\nkind = \"hold\"",
            &["seed = -1", "whole number"],
        ),
        (
            "sample_rate_hz = 300\n[motion]\nkind = \"hold\"",
            &["sample_rate_hz = 300 (Hz)", "integration_step_s"],
        ),
        (
            "integration_step_s = 0.1\n[motion]\nkind = \"hold\"",
            &["integration_step_s = 0.1 (s)", "between"],
        ),
        (
            "[motion]\nkind = \"dance\"",
            &["line 2", "motion.kind = \"dance\"", "\"random\""],
        ),
        ("[motion]\nkind = \"hold\"", &["duration_s", "has no end"]),
        (
            "[motion]\nkind = \"hold\"\nspeed = 3",
            &["line 3", "'speed'", "pose_rad"],
        ),
        (
            "colour = 1\n[motion]\nkind = \"hold\"",
            &["line 1", "'colour'", "sample_rate_hz"],
        ),
        (
            "duration_s = 1\n[motion]\nkind = \"hold\"\npose_rad = { ellbow = 1.0 }",
            &["line 4", "joint 'ellbow'", "elbow"],
        ),
        (
            "[motion]\nkind = \"hold\"\npose_rad = { elbow = 90.0 }",
            &["line 3", "motion.pose_rad.elbow = 90.0 (rad)"],
        ),
        (
            "[motion]\nkind = \"staircase\"\njoint = \"elbow\"\nmove_s = 0\npause_s = 1",
            &["line 4", "motion.move_s = 0 (s)"],
        ),
        (
            "[motion]\nkind = \"random\"\nmove_s = { min = 2, max = 1 }",
            &["motion.move_s.max", "at least min"],
        ),
        (
            "[motion]\nkind = \"hold\"\n[truth]\nstiffness_factor = -1",
            &["line 4", "truth.stiffness_factor = -1"],
        ),
        (
            "[motion]\nkind = \"hold\"\n[joint_friction]\ncoulomb_nm = { elbow = -0.1 }",
            &["joint_friction.coulomb_nm.elbow = -0.1", "at least 0"],
        ),
        (
            "[motion]\nkind = \"hold\"\n[encoder]\njoint_bits = 99",
            &["encoder.joint_bits = 99", "between 4 and 40"],
        ),
        (
            "[motion]\nkind = \"hold\"\n[[offsets]]\njoint = \"elbow\"\nkind = \"physical\"\nrad = inf",
            &["line 6", "offsets[0].rad = inf (rad)"],
        ),
        (
            "duration_s = 1\n[motion]\nkind = \"hold\"\n[[payloads]]\nlink = \"gripper\"\nmass_kg = 0.1",
            &["link 'gripper'", "tool"],
        ),
        (
            "[motion]\nkind = \"hold\"\n[[payloads]]\nlink = \"tool\"\nmass_kg = -0.1",
            &["payloads[0].mass_kg = -0.1 (kg)"],
        ),
        (
            "[motion]\nkind = \"hold\"\n[[payloads]]\nlink = \"tool\"\nmass_kg = 0.1\ncom_spread_m = [0, -0.1, 0]",
            &["payloads[0].com_spread_m", "0 or more in every direction"],
        ),
        (
            "[motion]\nkind = \"hold\"\n[[contacts]]\nlink = \"tool\"\nstart_s = 1\nduration_s = 1\nforce_n = [1, 2]",
            &["contacts[0].force_n", "three numbers"],
        ),
    ];
    for (text, parts) in cases {
        let message = refused(text);
        for part in parts {
            assert!(message.contains(part), "'{part}' missing in: {message}");
        }
        assert!(!message.ends_with('.'), "{message}");
    }
}

#[test]
fn reader_arbitrary_text_does_not_panic() {
    // Every prefix and every single-byte deletion of a file that uses most keys.
    let Some(root) = repository() else { return };
    let path = root.join("examples/scenarios/work-session.toml");
    let text = std::fs::read_to_string(path).expect("readable");
    for (cut, _) in text.char_indices() {
        let _ = Scenario::from_toml(&text[..cut], "cut.toml");
        let mut without: String = text[..cut].into();
        without.extend(text[cut..].chars().skip(1));
        let _ = Scenario::from_toml(&without, "cut.toml");
    }
}

#[test]
fn rigid_joint_error_suggests_fix() {
    let mut robot = pendulum();
    let scenario = Scenario::from_toml(GOOD, "good.toml").expect("good");
    robot.transmissions[0] = None;
    let message = Simulation::new(&robot, &scenario)
        .expect_err("rigid")
        .to_string();
    assert!(
        message.contains("swing") && message.contains("locked_at_rad"),
        "{message}"
    );
}
