//! Any text as a URDF: no panic, and an arm that is accepted can be stepped.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_model::arm::{ArmWorkspace, urdf};

fuzz_target!(|text: &str| {
    let Ok(read) = urdf::parse(text, &urdf::UrdfOptions::default()) else {
        return;
    };
    let arm = read.arm;
    let n = arm.dof();
    assert!(n > 0);
    let mut ws = ArmWorkspace::new(&arm);
    let q: Vec<f64> = (0..n).map(|i| 0.1 + i as f64).collect();
    let _ = arm.momentum(&mut ws, &q, &q);
    let _ = arm.inverse_dynamics(&mut ws, &q, &q, &q);
    let mut ddq = vec![0.0; n];
    let _ = arm.forward_dynamics(&mut ws, &q, &q, &q, &mut ddq);
});
