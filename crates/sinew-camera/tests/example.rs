//! Frames of `examples/07-camera`: measurement against their truth, and regeneration on request.

use crate::scale_picture::{Camera, Print, png};
use sinew_camera::{Request, Summary};
use std::path::PathBuf;

/// Times of the frames, s, as in a creep standard.
const TIMES_S: [u32; 8] = [0, 60, 180, 360, 720, 1800, 3600, 5400];

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples/07-camera/frames")
}

/// Displacement of the scale, mm: a rope with bedding-in within minutes and continuing creep.
fn movement_mm(time_s: f64) -> f64 {
    0.6 * (1.0 - (-time_s / 400.0).exp()) + 0.35 * (1.0 + time_s / 60.0).log10()
}

fn seen(time_s: u32) -> Vec<u8> {
    let camera = Camera {
        width: 420,
        height: 130,
        tilt_deg: 0.8,
        noise: 2.0,
        blur_px: 1.0,
        uneven: 0.6,
        zero_px: -1000.0,
        across_px: 45.0,
        seed: u64::from(time_s),
        ..Camera::default()
    };
    png(
        &camera,
        &Print::half_millimetre(),
        movement_mm(f64::from(time_s)) / 0.5,
    )
}

#[test]
fn example_frames_match_truth() {
    let outcome = sinew_camera::run(&Request::new(folder()), &mut |_| {}).unwrap();
    assert_eq!(Summary::of(&outcome).frames_used, TIMES_S.len());
    for (_, frame, reading) in outcome.used() {
        let error = 1e3 * reading.position_m - movement_mm(frame.time_s);
        assert!(error.abs() < 1e-3, "{}: {error} mm", frame.name);
    }
    let bytes: u64 = std::fs::read_dir(folder())
        .unwrap()
        .map(|e| e.unwrap().metadata().unwrap().len())
        .sum();
    assert!(bytes < 300_000, "{bytes} bytes");
}

/// `cargo test -p sinew-camera --test all -- --ignored draw_the_example`
#[test]
#[ignore = "writes the example's frames anew"]
fn draw_the_example() {
    std::fs::create_dir_all(folder()).unwrap();
    for time_s in TIMES_S {
        let path = folder().join(format!("bench_{time_s:04}s.png"));
        std::fs::write(path, seen(time_s)).unwrap();
    }
}
