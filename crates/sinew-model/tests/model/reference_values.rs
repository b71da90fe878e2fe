//! Every pair of URDF and reference values agrees to 1e-9 relative or better.
//!
//! Source: `SINEW_FIXTURES` (a folder holding `models/` and `fixtures/`), otherwise the shared
//! folder next to the checkout. Small models with committed values, in `tests/reference`, are
//! always checked.

use crate::skipped::skipped;
use serde_json::Value;
use sinew_model::arm::{Arm, ArmWorkspace, JointKind, urdf};
use std::path::{Path, PathBuf};

/// Tolerance that the project requires; the passes reach about 1e-14.
const TOLERANCE: f64 = 1e-9;

#[test]
fn committed_models_match_reference() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference");
    assert!(check_folder(&folder) >= 4, "our own models are committed");
}

#[test]
fn shared_models_agree() {
    let folder = std::env::var_os("SINEW_FIXTURES")
        .map(PathBuf::from)
        .unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"));
    if !folder.join("fixtures").is_dir() {
        skipped(format_args!("no reference values at {}", folder.display()));
        return;
    }
    assert!(check_folder(&folder) > 0);
}

/// Checks every `fixtures/NAME.json` of a folder and returns how many.
fn check_folder(folder: &Path) -> usize {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder.join("fixtures"))
        .expect("fixtures")
        .map(|e| e.expect("entry").path())
        .filter(|p| p.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    for file in &files {
        check_robot(folder, file);
    }
    files.len()
}

fn check_robot(folder: &Path, file: &Path) {
    let name = file.file_stem().unwrap().to_str().unwrap();
    let fixture: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let text = std::fs::read_to_string(folder.join("models").join(format!("{name}.urdf")))
        .unwrap_or_else(|e| panic!("{name}.urdf: {e}"));
    let gravity = numbers(&fixture["gravity"]);
    let options = urdf::UrdfOptions {
        gravity_m_s2: [gravity[0], gravity[1], gravity[2]],
        ..Default::default()
    };
    let arm = urdf::parse(&text, &options)
        .unwrap_or_else(|e| panic!("{name}: {e}"))
        .arm;
    // Without gravity the bias torque is `C dq` itself, not a difference of large numbers.
    let weightless = urdf::parse(
        &text,
        &urdf::UrdfOptions {
            gravity_m_s2: [0.0; 3],
            ..Default::default()
        },
    )
    .unwrap()
    .arm;
    let joints: Vec<&str> = fixture["joints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|j| j.as_str().unwrap())
        .collect();
    assert_eq!(joints.len(), arm.dof(), "{name}: joints");
    // place[k]: our index of the fixture's joint k
    let place: Vec<usize> = joints
        .iter()
        .map(|j| arm.joint_index(j).unwrap_or_else(|| panic!("{name}: {j}")))
        .collect();
    for (k, kind) in fixture["kinds"].as_array().unwrap().iter().enumerate() {
        let ours = match arm.joint_kind(place[k]).unwrap() {
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
        };
        assert_eq!(kind.as_str().unwrap(), ours, "{name}: {}", joints[k]);
    }

    let mut ws = ArmWorkspace::new(&arm);
    let mut worst = [
        ("p", 0.0f64),
        ("ct_dq", 0.0),
        ("g", 0.0),
        ("c_dq", 0.0),
        ("T", 0.0),
        ("V", 0.0),
    ];
    let cases = fixture["cases"].as_array().unwrap();
    for case in cases {
        let q = reorder(&numbers(&case["q"]), &place);
        let dq = reorder(&numbers(&case["dq"]), &place);
        let ours = passes(&arm, &weightless, &mut ws, &q, &dq);
        for (slot, (key, ours)) in worst.iter_mut().zip([
            ("p", &ours.p),
            ("ct_dq", &ours.ct_dq),
            ("g", &ours.g),
            ("c_dq", &ours.c_dq),
        ]) {
            let reference = reorder(&numbers(&case[key]), &place);
            slot.1 = slot.1.max(relative(ours, &reference));
        }
        for (slot, key, ours) in [
            (4, "kinetic_energy", ours.kinetic),
            (5, "potential_energy", ours.potential),
        ] {
            let reference = case[key].as_f64().unwrap();
            worst[slot].1 = worst[slot].1.max(relative(&[ours], &[reference]));
        }
    }
    let figures: Vec<String> = worst.iter().map(|(k, v)| format!("{k} {v:.1e}")).collect();
    println!(
        "{name}: {} joints, {} cases, worst relative difference {}",
        arm.dof(),
        cases.len(),
        figures.join(", ")
    );
    for (what, figure) in worst {
        assert!(figure <= TOLERANCE, "{name}: {what} differs by {figure:e}");
    }
}

struct Passes {
    p: Vec<f64>,
    ct_dq: Vec<f64>,
    g: Vec<f64>,
    c_dq: Vec<f64>,
    kinetic: f64,
    potential: f64,
}

fn passes(arm: &Arm, weightless: &Arm, ws: &mut ArmWorkspace, q: &[f64], dq: &[f64]) -> Passes {
    let terms = arm.momentum(ws, q, dq).unwrap();
    let (p, ct_dq, g) = (terms.p.to_vec(), terms.ct_dq.to_vec(), terms.g.to_vec());
    let mut other = ArmWorkspace::new(weightless);
    let c_dq = weightless.bias_torque(&mut other, q, dq).unwrap().to_vec();
    let kinetic = arm.kinetic_energy(ws, q, dq).unwrap();
    let potential = arm.potential_energy(ws, q).unwrap();
    Passes {
        p,
        ct_dq,
        g,
        c_dq,
        kinetic,
        potential,
    }
}

/// Largest difference over the largest reference entry (entries that are zero by symmetry hold
/// rounding noise in the reference too). A quantity below 1e-9 in all entries counts absolutely.
fn relative(ours: &[f64], reference: &[f64]) -> f64 {
    let size = reference.iter().fold(1e-9f64, |m, x| m.max(x.abs()));
    let difference = ours
        .iter()
        .zip(reference)
        .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    difference / size
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn reorder(values: &[f64], place: &[usize]) -> Vec<f64> {
    let mut out = vec![0.0; values.len()];
    for (value, &at) in values.iter().zip(place) {
        out[at] = *value;
    }
    out
}
