//! The regressors times the parameters are the momentum pass, and their base all of it.

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

/// Numbers without a pattern.
fn motion(n: usize, case: usize) -> [Vec<f64>; 2] {
    let values = |a: f64, b: f64| (0..n).map(move |i| a * (b * (case * n + i + 1) as f64).sin());
    [values(3.0, 12.9).collect(), values(1.5, 78.2).collect()]
}

#[test]
fn base_parameters_are_all_that_motion_depends_on() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/models");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let arm = urdf::parse(&text, &urdf::UrdfOptions::default())
            .unwrap()
            .arm;
        let n = arm.dof();
        let base = arm.base_parameters();
        let all = n * 10;
        println!("{}: {n} joints, {} of {all}", path.display(), base.count());
        // The first joint's axis alone hides three moments and mass or more.
        assert!(base.count() <= all - 3, "{}", base.count());
        let mut ws = ArmWorkspace::new(&arm);
        let mut regressor = MomentumRegressor::new(&arm);
        let pi: Vec<f64> = (0..all).map(|k| (3.7 * k as f64).cos()).collect();
        let z = base.of(&pi);
        let mut seen = vec![0.0_f64; base.count()];
        for case in 0..20 {
            let [q, dq] = motion(n, case);
            arm.momentum_regressor(&mut ws, &q, &dq, &mut regressor)
                .unwrap();
            for matrix in [&regressor.p, &regressor.a] {
                for row in matrix.chunks_exact(all) {
                    let whole: f64 = row.iter().zip(&pi).map(|(x, pi)| x * pi).sum();
                    let own = base.columns.iter().map(|&c| row[c]);
                    let part: f64 = own.clone().zip(&z).map(|(x, z)| x * z).sum();
                    let size: f64 = row.iter().map(|x| x.abs()).sum();
                    assert!((whole - part).abs() < 1e-9 * (1.0 + size), "{whole} {part}");
                    for (seen, x) in seen.iter_mut().zip(own) {
                        *seen = seen.max(x.abs());
                    }
                }
            }
        }
        assert!(seen.iter().all(|x| *x > 1e-9), "a column says nothing");
    }
}
