//! The figures of the paper's evaluation, reproduced: every statement holds by its own criterion.
//!
//! `SINEW_FIGURES=DIR` also writes the drawings and pages there.

use crate::paper_figures::{biorob_like, fig6, fig7};
use crate::paper_sentences::EXTERNAL_FORCES;
use sinew_bench::paper::{self, ClaimedBy, PaperFigure};
use sinew_model::robot::RobotFile;

/// Checks a figure: everything holds except these statements of the paper.
fn check_figure(mut figure: PaperFigure, contradicted: &[&str]) {
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
    let failed = figure.sentences.iter().filter(|s| !s.holds);
    let failed: Vec<(ClaimedBy, &str)> = failed.map(|s| (s.claimed_by, s.text.as_str())).collect();
    let expected: Vec<(ClaimedBy, &str)> = contradicted
        .iter()
        .map(|t| (ClaimedBy::Paper, *t))
        .collect();
    assert_eq!(failed, expected);
}

#[test]
fn figure_6_matches_paper() {
    let figure = fig6();
    assert_eq!(figure.panels.len(), 9);
    // A force that pushes the joint on is underestimated.
    check_figure(figure.clone(), &[EXTERNAL_FORCES]);
}

#[test]
fn figure_7_matches_paper() {
    let figure = fig7();
    assert_eq!(figure.panels.len(), 4);
    check_figure(figure.clone(), &[]);
}

#[test]
fn analytic_values_match_robot() {
    let mut robot = biorob_like();
    for t in robot.transmissions.iter_mut().flatten() {
        t.stiffness_nm_per_rad *= 2.0;
    }
    robot.arm = robot.arm.with_scaled_masses(1.3).expect("heavier");
    let figure = paper::fig6(&robot).expect("made");
    // 3.635 N·m · 1.3/80 N·m/rad, a sixth and a tenth of it.
    let added = |text: &str| {
        let found = figure.sentences.iter().find(|s| s.text.contains(text));
        found.expect("there").shown().0
    };
    let deflection_mrad = 3635.0 * 1.3 / 80.0;
    assert!((added("K overestimated") - deflection_mrad / 6.0).abs() < 0.1);
    assert!((added("underestimated by 10 %") - deflection_mrad / 10.0).abs() < 0.1);
    check_figure(figure, &[EXTERNAL_FORCES]);
    check_figure(paper::fig7(&robot).expect("made"), &[]);
}

#[test]
fn figures_are_files_that_open_offline() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut figure = fig7().clone();
    paper::write(&mut figure, folder.path()).expect("written");
    let written = figure.files.expect("named");
    let html = std::fs::read_to_string(&written.html).expect("there");
    assert!(html.contains("<svg") && html.contains("Assumptions"));
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
fn missing_joint_error_names_joint() {
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
