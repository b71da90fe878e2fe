//! Cost of `sinew creep fit`: five laws on every test of a file, one thread.
//!
//! `cargo bench -p sinew-creep --bench creep_fits -- FILE [OUT.json]` prints the duration of the
//! searches (no draws for intervals, independent errors) and writes the fitted curves with the sum
//! of squares of each law. `benches/peers/creep_fits.py` passes the same curves to SciPy. It then
//! prints the duration of the command itself: searches with slow errors, and the draws for the
//! intervals.

use sinew_creep::{Curve, FitOptions, Law, NoiseKind, PrepareOptions};
use sinew_creep::{TestOptions, read_test};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    // `cargo test --benches` only checks that it runs.
    let quick = args.iter().any(|a| a == "--test");
    let mut paths = args.iter().filter(|a| !a.starts_with("--"));
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/06-creep-test");
    let file = paths
        .next()
        .map_or_else(|| example.join("rope-A.csv"), PathBuf::from);
    let test = read_test(&file, &TestOptions::default()).expect("a creep test");
    let curves: Vec<Curve> = test
        .specimens
        .iter()
        .filter_map(|s| sinew_creep::prepare(s, &PrepareOptions::default()).ok())
        .map(|p| p.curve.thinned())
        .collect();
    let options = FitOptions {
        noise: NoiseKind::White,
        intervals: false,
        ..FitOptions::default()
    };
    let rounds = if quick { 1 } else { 5 };
    let mut seconds = f64::INFINITY;
    let mut fits = Vec::new();
    for _ in 0..rounds {
        let start = clock_s();
        fits = curves
            .iter()
            .flat_map(|c| {
                Law::ALL.map(|law| sinew_creep::fit(law, std::slice::from_ref(c), &options))
            })
            .collect();
        seconds = seconds.min(clock_s() - start);
    }
    let done = fits.iter().filter(|f| f.is_ok()).count();
    println!(
        "{} curves, {done} fits, {seconds:.3} s of processor (least of {rounds} rounds)",
        curves.len()
    );
    let with_draws = |intervals: bool| {
        let options = FitOptions {
            intervals,
            ..FitOptions::default()
        };
        let start = clock_s();
        let fits = curves.iter().flat_map(|c| {
            Law::ALL.map(|law| sinew_creep::fit(law, std::slice::from_ref(c), &options))
        });
        let done = fits.filter(Result::is_ok).count();
        (clock_s() - start, done)
    };
    let ((search, _), (both, done)) = (with_draws(false), with_draws(true));
    println!(
        "as the command does: {done} fits, searches {search:.3} s, intervals {:.3} s",
        both - search
    );
    if let Some(out) = paths.next() {
        let curves: Vec<serde_json::Value> = curves
            .iter()
            .zip(fits.chunks(Law::ALL.len()))
            .map(|(curve, fits)| measured(curve, fits))
            .collect();
        let text = serde_json::json!({ "seconds": seconds, "curves": curves }).to_string();
        std::fs::write(out, text).expect("the file can be written");
    }
}

/// Processor time of this thread, s, if available (Linux), so that a busy machine does not count;
/// otherwise wall-clock time.
fn clock_s() -> f64 {
    let schedule = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let ns = schedule.and_then(|s| s.split_whitespace().next()?.parse::<f64>().ok());
    ns.map_or_else(
        || EPOCH.get_or_init(Instant::now).elapsed().as_secs_f64(),
        |ns| 1e-9 * ns,
    )
}

static EPOCH: OnceLock<Instant> = OnceLock::new();

fn measured(
    curve: &Curve,
    fits: &[Result<sinew_creep::Fit, sinew_creep::CreepError>],
) -> serde_json::Value {
    let squares = |fit: &sinew_creep::Fit| -> f64 {
        let model = fit.strain(0, &curve.time_s);
        let rows = curve.strain.iter().zip(&model).zip(&curve.count);
        rows.map(|((e, m), n)| n * (e - m) * (e - m)).sum()
    };
    let fits: serde_json::Map<String, serde_json::Value> = Law::ALL
        .iter()
        .zip(fits)
        .filter_map(|(law, fit)| {
            let fit = fit.as_ref().ok()?;
            Some((law.name().to_owned(), squares(fit).into()))
        })
        .collect();
    serde_json::json!({
        "name": curve.name,
        "time_s": curve.time_s,
        "strain": curve.strain,
        "count": curve.count,
        "steps": curve.steps,
        "squares": fits,
    })
}
