//! The regressors times the parameters are the momentum pass.

use sinew_model::arm::{ArmWorkspace, MomentumRegressor, urdf};
use std::path::Path;

#[test]
fn regressor_times_parameters_is_the_pass() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/models");
    let mut robots = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        let arm = urdf::parse(&text, &urdf::UrdfOptions::default())
            .unwrap()
            .arm;
        let n = arm.dof();
        let mut ws = ArmWorkspace::new(&arm);
        let mut regressor = MomentumRegressor::new(&arm);
        let pi = arm.inertial_parameters();
        for case in 0..5 {
            let q: Vec<f64> = (0..n).map(|i| ((i * 7 + case * 3) as f64).sin()).collect();
            let dq: Vec<f64> = (0..n)
                .map(|i| 2.0 * ((i * 5 + case) as f64).cos())
                .collect();
            arm.momentum_regressor(&mut ws, &q, &dq, &mut regressor)
                .unwrap();
            let terms = arm.momentum(&mut ws, &q, &dq).unwrap();
            for i in 0..n {
                let row = |m: &[f64]| -> (f64, f64) {
                    let row = &m[i * regressor.columns()..(i + 1) * regressor.columns()];
                    let terms = row.iter().zip(&pi).map(|(a, b)| a * b);
                    (terms.clone().sum(), terms.map(f64::abs).sum::<f64>())
                };
                let bias = terms.ct_dq[i] - terms.g[i];
                for ((value, size), expected) in
                    [(row(&regressor.p), terms.p[i]), (row(&regressor.a), bias)]
                {
                    // Rounding of a sum of 10 n terms carried over up to n joints.
                    let tolerance = 100.0 * n as f64 * f64::EPSILON * (size + 1.0);
                    assert!((value - expected).abs() < tolerance, "{value} {expected}");
                }
            }
        }
        robots += 1;
    }
    assert!(robots >= 4);
}
