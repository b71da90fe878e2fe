//! The figures of the paper's evaluation, reproduced: every sentence holds by its own criterion.
//!
//! `SINEW_FIGURES=DIR` also writes the drawings and pages there.

use sinew_eval::paper;
use sinew_eval::paper::PaperFigure;
use sinew_model::robot::{Robot, RobotFile};

fn biorob_like() -> Robot {
    RobotFile::parse(
        include_str!("../../../robots/biorob-like/robot.toml"),
        "robot.toml",
    )
    .and_then(|f| f.build(include_str!("../../../robots/biorob-like/biorob-like.urdf")))
    .expect("the shipped robot is readable")
}

fn judge(mut figure: PaperFigure) {
    for s in &figure.sentences {
        let verdict = if s.holds { "holds" } else { "FAILS" };
        let (value, unit) = s.shown();
        println!(
            "{}: {verdict}: {} {:.4} {} ({})",
            figure.name, s.text, value, unit, s.criterion
        );
    }
    if let Some(folder) = std::env::var_os("SINEW_FIGURES") {
        paper::write(&mut figure, folder.as_ref()).expect("written");
    }
    let failed: Vec<&str> = figure
        .sentences
        .iter()
        .filter(|s| !s.holds)
        .map(|s| s.text.as_str())
        .collect();
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn figure_6_shows_what_the_paper_says() {
    let figure = paper::fig6(&biorob_like()).expect("made");
    assert_eq!(figure.panels.len(), 9);
    assert!(figure.sentences.len() >= 11);
    judge(figure);
}

#[test]
fn figure_7_shows_what_the_paper_says() {
    let figure = paper::fig7(&biorob_like()).expect("made");
    assert_eq!(figure.panels.len(), 3);
    judge(figure);
}

#[test]
fn figures_are_files_that_open_offline() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut figure = paper::fig7(&biorob_like()).expect("made");
    paper::write(&mut figure, folder.path()).expect("written");
    let written = figure.files.expect("named");
    let html = std::fs::read_to_string(&written.html).expect("there");
    assert!(html.contains("<svg") && html.contains("What is assumed"));
    // Nothing is fetched: the only address allowed is the SVG name space.
    let without = html.replace("http://www.w3.org/2000/svg", "");
    assert!(!without.contains("http:") && !without.contains("https:"));
    assert_eq!(without.matches("<script").count(), 1, "the page's own");
    let png = std::fs::read(written.png.expect("drawn")).expect("there");
    assert_eq!(&png[1..4], b"PNG");
    assert!(
        std::fs::read_to_string(&written.svg)
            .expect("there")
            .starts_with("<svg")
    );
}

#[test]
fn a_robot_without_the_joint_is_told_which_is_missing() {
    let mut robot = biorob_like();
    robot.name = "stump".into();
    // The pendulum of one joint, called otherwise.
    let pendulum = RobotFile::parse("[joints.swing]\nstiffness_nm_per_rad = 20.0\nmotor_inertia_kg_m2 = 0.05\n", "p.toml")
        .and_then(|f| f.build(r#"<robot name="stump"><link name="base"/><link name="bob"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link><joint name="swing" type="continuous"><parent link="base"/><child link="bob"/><axis xyz="0 1 0"/></joint></robot>"#))
        .expect("a robot");
    let message = paper::fig6(&pendulum).expect_err("no shoulder").to_string();
    assert!(
        message.contains("shoulder_pitch") && message.contains("swing"),
        "{message}"
    );
}
