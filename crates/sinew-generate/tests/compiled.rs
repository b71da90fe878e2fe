//! Comparison of compiled code with the generic code over one motion.

use crate::robots::{REFUSED, Sample, biorob_like, models, motion};
use crate::skipped::skipped;
use sinew_generate::{File, Language, Precision, generate};
use sinew_model::arm::ArmWorkspace;
use sinew_model::offset::{self, OffsetConfig, OffsetObserver, VelocityFilter};
use sinew_model::robot::Robot;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// Tolerance relative to the largest value of the same kind: rounding of several hundred operations in a different
/// order, over 400 steps of a stable observer.
const ROUNDING: f64 = 1e-12;
/// Tolerance in single precision: several hundred rounding errors of 6e-8.
const SINGLE_ROUNDING: f64 = 1e-5;

/// Rounding of a precision: carried along, and of a number.
fn rounding(precision: Precision) -> (f64, f64) {
    match precision {
        Precision::Double => (ROUNDING, f64::EPSILON),
        Precision::Single => (SINGLE_ROUNDING, f64::from(f32::EPSILON)),
    }
}

fn config() -> OffsetConfig {
    let velocity = VelocityFilter::StateVariable {
        cutoff_rad_per_s: 40.0,
    };
    OffsetConfig {
        gain_per_s: 20.0,
        velocity,
        ..OffsetConfig::default()
    }
}

/// Results of a sample: status, settled flag; offset, torque and momentum terms.
struct Answer {
    taken: bool,
    settled: bool,
    values: [Vec<f64>; 5],
}

/// The generic code over a motion.
fn expected(robot: &Robot, samples: &[Sample]) -> Vec<Answer> {
    let mut observer = OffsetObserver::new(&robot.arm, &robot.transmissions, config()).unwrap();
    let mut workspace = ArmWorkspace::new(&robot.arm);
    (samples.iter())
        .map(|s| {
            let sample = offset::Sample {
                q: &s.q,
                theta_measured: &s.theta,
                tau_ext: s.known.then_some(&s.tau_ext[..]),
                ..offset::Sample::default()
            };
            let taken = observer.step(s.dt_s, &sample).is_ok();
            let n = robot.arm.dof();
            let [p, ct_dq, g] = match robot.arm.momentum(&mut workspace, &s.q, &s.dq) {
                Ok(terms) => [terms.p, terms.ct_dq, terms.g].map(<[f64]>::to_vec),
                Err(_) => [(); 3].map(|()| vec![f64::NAN; n]),
            };
            Answer {
                taken,
                settled: observer.is_settled(),
                values: [
                    observer.delta_e().to_vec(),
                    observer.tau_el().to_vec(),
                    p,
                    ct_dq,
                    g,
                ],
            }
        })
        .collect()
}

/// Runs a compiled driver over a motion and compares line by line.
fn compare(
    program: &mut Command,
    robot: &Robot,
    samples: &[Sample],
    precision: Precision,
    what: &str,
) {
    let (rounding, epsilon) = rounding(precision);
    let mut input = String::new();
    for s in samples {
        let _ = write!(input, "{:?} {}", s.dt_s, u8::from(s.known));
        for values in [&s.q, &s.theta, &s.tau_ext, &s.dq] {
            values.iter().for_each(|v| {
                let _ = write!(input, " {v:?}");
            });
        }
        input.push('\n');
    }
    let mut child = program
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    let said = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    assert!(said.status.success(), "{what}: {}", said.status);
    let said = String::from_utf8(said.stdout).unwrap();
    let answers = expected(robot, samples);
    assert_eq!(said.lines().count(), answers.len(), "{what}");
    // The size of each kind over the motion; what is no part of it may be larger.
    let largest = |of: &mut dyn Iterator<Item = &f64>| of.fold(1e-3, |m: f64, v| m.max(v.abs()));
    let size: Vec<f64> = (0..5)
        .map(|k| {
            let taken = answers.iter().filter(|a| a.taken);
            let all: Vec<f64> = taken.flat_map(|a| a.values[k].clone()).collect();
            largest(&mut all.iter().filter(|v| v.is_finite()))
        })
        .collect();
    let (mut refused, mut settled) = (0_usize, 0);
    let mut worst = 0.0_f64;
    for (k, (line, (answer, sample))) in said.lines().zip(answers.iter().zip(samples)).enumerate() {
        let mut words = line.split_whitespace();
        let mut flag = || words.next().unwrap().parse::<i32>().unwrap();
        let (status, is_settled) = (flag(), flag() != 0);
        assert_eq!(
            status == 0,
            answer.taken,
            "{what}, sample {k}: status {status}"
        );
        assert_eq!(is_settled, answer.settled, "{what}, sample {k}");
        refused += usize::from(status != 0);
        settled += i32::from(is_settled);
        let numbers: Vec<f64> = words.map(|w| w.parse().unwrap()).collect();
        let theirs = answer.values.iter().flatten();
        assert_eq!(numbers.len(), theirs.clone().count(), "{what}");
        // The pass accepts every input: its results for impossible positions are not compared.
        let far = sample.q.iter().fold(0.0, |m: f64, q| m.max(q.abs()));
        let is_possible = answer.values[2].iter().all(|p| p.is_finite()) && far < 1e30;
        let compared = if is_possible {
            numbers.len()
        } else {
            2 * robot.arm.dof()
        };
        for (i, (ours, theirs)) in numbers.iter().zip(theirs).take(compared).enumerate() {
            let kind = i / robot.arm.dof();
            let size = match answer.taken || kind < 2 {
                true => size[kind],
                false => largest(&mut answer.values[kind].iter()).max(size[kind]),
            };
            // A frame's own angle is added to the position, which rounds that of each joint where it is many turns.
            let least = match answer.taken {
                true => rounding,
                false => rounding + epsilon * far * robot.arm.dof() as f64,
            };
            if ours.is_finite() {
                worst = worst.max((ours - theirs).abs() / size / least);
            }
            let same = ours.is_nan() && theirs.is_nan() || (ours - theirs).abs() <= least * size;
            assert!(
                same,
                "{what}, sample {k}, value {i}: {ours:e} and {theirs:e}"
            );
        }
    }
    println!("{what}: at worst {worst:.2} of what rounding may do");
    assert_eq!(refused, REFUSED, "{what}");
    assert!(settled > 0, "{what}: never settled");
}

fn write_all(folder: &Path, files: &[File]) {
    for file in files {
        std::fs::write(folder.join(&file.name), &file.text).unwrap();
    }
}

/// Returns the type of a real number in the generated language.
fn real(precision: Precision, language: Language) -> &'static str {
    match (precision, language) {
        (Precision::Double, Language::C) => "double",
        (Precision::Single, Language::C) => "float",
        (Precision::Double, Language::Rust) => "f64",
        (Precision::Single, Language::Rust) => "f32",
    }
}

/// Compiles C sources in a folder, with warnings as errors.
fn compile_c(compiler: &str, folder: &Path, sources: &[&str], program: &Path) {
    let done = Command::new(compiler)
        .args(["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic"])
        .args(["-Wshadow", "-Wconversion", "-Werror"])
        .args(sources)
        .arg("-o")
        .arg(program)
        .arg("-lm")
        .current_dir(folder)
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{}: {message}", program.display());
}

const C_DRIVER: &str = r#"
#include "@name@.h"
#include <stdio.h>
enum { N = @upper@_JOINTS };
typedef @real@ real;
static int row(real *v) {
    for (int i = 0; i < N; i++) {
        double read;
        if (scanf("%lf", &read) != 1) return 0;
        v[i] = (real)read;
    }
    return 1;
}
static void say(const real *v) {
    for (int i = 0; i < N; i++) printf(" %.17g", (double)v[i]);
}
int main(void) {
    static @name@_observer o;
    double dt;
    real q[N], theta[N], ext[N], dq[N], p[N], ct_dq[N], g[N];
    int known;
    @name@_reset(&o);
    while (scanf("%lf %d", &dt, &known) == 2 && row(q) && row(theta) && row(ext) && row(dq)) {
        const int status = @name@_step(&o, (real)dt, q, theta, known ? ext : NULL);
        printf("%d %d", status, @name@_is_settled(&o));
        @name@_momentum(q, dq, p, ct_dq, g);
        say(o.delta_e), say(o.tau_el), say(p), say(ct_dq), say(g);
        printf("\n");
    }
    return 0;
}
"#;

#[test]
fn c_gives_what_the_generic_code_gives() {
    let folder = tempfile::tempdir().unwrap();
    let mut found = 0;
    for compiler in ["gcc", "clang"] {
        if Command::new(compiler).arg("--version").output().is_err() {
            skipped(format_args!("{compiler} is not there"));
            continue;
        }
        found += 1;
        let robots = || std::iter::once(biorob_like()).chain(models());
        let double = robots().map(|robot| (robot, Precision::Double));
        // The single-precision code is the same text: one compiler suffices.
        let single = robots()
            .filter(|_| found == 1)
            .map(|robot| (robot, Precision::Single));
        for (robot, precision) in double.chain(single) {
            let written = generate(&robot, &config(), Language::C, precision).unwrap();
            write_all(folder.path(), &written.files);
            let header = &written.files[0].name;
            let name = header.trim_end_matches(".h");
            let driver = C_DRIVER
                .replace("@name@", name)
                .replace("@upper@", &name.to_uppercase())
                .replace("@real@", real(precision, Language::C));
            std::fs::write(folder.path().join("driver.c"), driver).unwrap();
            let program = folder.path().join(format!("{name}-{compiler}"));
            let source = format!("{name}.c");
            compile_c(compiler, folder.path(), &["driver.c", &source], &program);
            for known in [false, true] {
                let samples = motion(robot.arm.dof(), known);
                let what = format!("{name}, {compiler}, {precision:?}, external torque {known}");
                let mut program = Command::new(&program);
                compare(&mut program, &robot, &samples, precision, &what);
            }
        }
    }
    if found == 0 {
        skipped("there is no C compiler; generated C is not compiled");
    }
}

/// Two robots whose observers have the same size: each rejects the state of the other, and one that was never reset.
const STATES: &str = r#"
#include "one.h"
#include "other.h"
#include <string.h>
int main(void) {
    static one_observer o;
    static other_observer x, before;
    const double q[ONE_JOINTS] = {0.1}, theta[ONE_JOINTS] = {0.1};
    if (ONE_CHECKSUM == OTHER_CHECKSUM || sizeof o != sizeof x) return 1;
    if (one_step(&o, 0.001, q, theta, NULL) != ONE_OTHER_STATE || one_is_settled(&o)) return 2;
    one_reset(&o);
    for (int i = 0; i < 2000; i++)
        if (one_step(&o, 0.001, q, theta, NULL) != ONE_OK) return 3;
    if (!one_is_settled(&o)) return 4;
    memcpy(&x, &o, sizeof x);
    memcpy(&before, &x, sizeof x);
    if (other_step(&x, 0.001, q, theta, NULL) != OTHER_OTHER_STATE || other_is_settled(&x)) return 5;
    if (memcmp(&x, &before, sizeof x) != 0) return 6;
    return 0;
}
"#;

#[test]
fn c_code_rejects_the_state_of_another_robot() {
    let folder = tempfile::tempdir().unwrap();
    let compiler = "cc";
    if Command::new(compiler).arg("--version").output().is_err() {
        skipped("cc is not there; generated C is not compiled");
        return;
    }
    let mut robot = biorob_like();
    for (name, factor) in [("one", 1.0), ("other", 1.01)] {
        robot.name = name.to_owned();
        let elastic = robot.transmissions[0].as_mut().unwrap();
        elastic.stiffness_nm_per_rad *= factor;
        let written = generate(&robot, &config(), Language::C, Precision::Double).unwrap();
        write_all(folder.path(), &written.files);
    }
    std::fs::write(folder.path().join("states.c"), STATES).unwrap();
    let program = folder.path().join("states");
    let sources = ["states.c", "one.c", "other.c"];
    compile_c(compiler, folder.path(), &sources, &program);
    let status = Command::new(program).status().unwrap();
    assert_eq!(status.code(), Some(0));
}

/// The driver of one robot, in Rust.
const RUST_DRIVER: &str = r#"
fn @name@() {
    use drivers::@name@::*;
    let mut o = Observer::new();
    for line in std::io::stdin().lines() {
        let line = line.unwrap();
        let v: Vec<f64> = line.split_whitespace().map(|w| w.parse().unwrap()).collect();
        let row = |k: usize| <[f64; JOINTS]>::try_from(&v[2 + k * JOINTS..][..JOINTS]).unwrap();
        let (q, theta, ext, dq) = (row(0), row(1), row(2), row(3));
        let stepped = o.step(v[0], &q, &theta, (v[1] != 0.0).then_some(&ext));
        let m = momentum(&q, &dq);
        print!("{} {}", i32::from(stepped.is_err()), i32::from(o.is_settled()));
        for values in [o.delta_e(), o.tau_el(), &m.p, &m.ct_dq, &m.g] {
            values.iter().for_each(|v| print!(" {v:?}"));
        }
        println!();
    }
}
"#;

#[test]
fn generated_no_std_rust_matches_generic_code() {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("src");
    std::fs::create_dir(&source).unwrap();
    // libm as the workspace has it, from its lock file; nothing is fetched.
    let manifest = "[package]\nname = \"drivers\"\nversion = \"0.0.0\"\nedition = \"2024\"\n[dependencies]\nlibm = \"0.2\"\n[workspace]\n[profile.dev]\nopt-level = 1\n";
    std::fs::write(folder.path().join("Cargo.toml"), manifest).unwrap();
    let lock = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../Cargo.lock");
    std::fs::copy(lock, folder.path().join("Cargo.lock")).unwrap();
    let mut modules = "#![no_std]\n#![deny(warnings)]\n".to_owned();
    let (mut main, mut arms) = (String::new(), String::new());
    let robots: Vec<Robot> = std::iter::once(biorob_like()).chain(models()).collect();
    let mut names = Vec::new();
    let precisions = [Precision::Double, Precision::Single];
    let cases = || (robots.iter()).flat_map(|robot| precisions.map(|p| (robot, p)));
    for (robot, precision) in cases() {
        let mut written = generate(robot, &config(), Language::Rust, precision).unwrap();
        let name = written.files[0].name.trim_end_matches(".rs").to_owned();
        let real = real(precision, Language::Rust);
        let name = format!("{name}_{real}");
        written.files[0].name = format!("{name}.rs");
        write_all(&source, &written.files);
        let _ = writeln!(modules, "pub mod {name};");
        let _ = writeln!(arms, "        {name:?} => {name}(),");
        main += &RUST_DRIVER.replace("@name@", &name).replace("f64", real);
        names.push(name);
    }
    let _ = write!(
        main,
        "fn main() {{\n    match std::env::args().nth(1).unwrap().as_str() {{\n{arms}        other => panic!(\"{{other}}\"),\n    }}\n}}\n"
    );
    std::fs::write(source.join("lib.rs"), modules).unwrap();
    std::fs::write(source.join("main.rs"), main).unwrap();
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("drivers");
    let done = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--offline"])
        .env("CARGO_TARGET_DIR", &target)
        .env_remove("RUSTFLAGS")
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    for ((robot, precision), name) in cases().zip(&names) {
        for known in [false, true] {
            let samples = motion(robot.arm.dof(), known);
            let what = format!("{name}, rustc, external torque {known}");
            let mut program = Command::new(target.join("debug/drivers"));
            compare(program.arg(name), robot, &samples, precision, &what);
        }
    }
}
