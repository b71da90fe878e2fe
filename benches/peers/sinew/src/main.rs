//! Times `Arm::momentum`; called by `run.py`, which also compares the values.
//!
//! `peer-sinew ROBOT.urdf GX GY GZ STATES SECONDS DUMP`; prints the least time per pass, ns.

use sinew_model::arm::{ArmWorkspace, urdf};
use std::fmt::Write as _;
use std::hint::black_box;
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let [_, robot, gx, gy, gz, states, seconds, dump] = &args[..] else {
        return Err("seven arguments, see run.py".into());
    };
    let options = urdf::UrdfOptions {
        gravity_m_s2: [gx.parse()?, gy.parse()?, gz.parse()?],
        ..Default::default()
    };
    let arm = urdf::parse(&std::fs::read_to_string(robot)?, &options)?.arm;
    let n = arm.dof();

    // First line: joint names; then q and dq of one state per line, in the order of the names.
    let text = std::fs::read_to_string(states)?;
    let mut lines = text.lines();
    let place: Vec<usize> = lines
        .next()
        .ok_or("no names")?
        .split_whitespace()
        .map(|name| arm.joint_index(name).ok_or_else(|| name.to_string()))
        .collect::<Result<_, _>>()?;
    let mut cases = Vec::new();
    for line in lines {
        let x: Vec<f64> = line
            .split_whitespace()
            .map(str::parse)
            .collect::<Result<_, _>>()?;
        let (mut q, mut dq) = (vec![0.0; n], vec![0.0; n]);
        for (k, &at) in place.iter().enumerate() {
            (q[at], dq[at]) = (x[k], x[n + k]);
        }
        cases.push((q, dq));
    }

    let mut ws = ArmWorkspace::new(&arm);
    let mut out = String::new();
    for (q, dq) in &cases {
        let terms = arm.momentum(&mut ws, q, dq)?;
        for values in [terms.p, terms.ct_dq, terms.g] {
            for &at in &place {
                write!(out, "{:e} ", values[at])?;
            }
        }
        out.push('\n');
    }
    std::fs::write(dump, out)?;

    let end = Instant::now() + Duration::from_secs_f64(seconds.parse()?);
    let mut best = f64::INFINITY;
    // Batches well under a time slice: some are never interrupted, and the least one counts.
    let repeats = 4;
    while Instant::now() < end {
        let start = Instant::now();
        for _ in 0..repeats {
            for (q, dq) in &cases {
                black_box(arm.momentum(&mut ws, black_box(q), black_box(dq))?);
            }
        }
        let passes = (repeats * cases.len()) as f64;
        best = best.min(start.elapsed().as_secs_f64() * 1e9 / passes);
    }
    println!("{best}");
    Ok(())
}
