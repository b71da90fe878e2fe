//! Throughput of the camera measurement at full HD on one core, without decoding.
//!
//! `cargo bench -p sinew-camera --bench camera` prints, for 1920 × 1080 frames of a half-millimetre scale at 10 px per
//! line: the first frame (detection of the scale), measurement (horizontal and upright), and decoding of PNG and JPEG.
//! Everything runs in the calling thread.

#[path = "../tests/scale_picture.rs"]
mod scale_picture;

use scale_picture::{Camera, Print, jpeg, picture, png};
use sinew_camera::{Picture, ReadOptions, ScaleReader, decode};
use std::hint::black_box;
use std::time::Instant;

const FRAMES: u32 = 8;

fn main() {
    // `cargo test --benches` only checks that the benchmark runs.
    let quick = std::env::args().any(|a| a == "--test");
    let rounds = if quick { 1 } else { 25 };
    let print = Print::half_millimetre();
    for (name, width, height) in [("lying", 1920, 1080), ("upright", 1080, 1920)] {
        let camera = Camera {
            width,
            height,
            upright: name == "upright",
            tilt_deg: 1.0,
            noise: 4.0,
            blur_px: 1.2,
            uneven: 0.6,
            ..Camera::default()
        };
        let pictures: Vec<Picture> = (0..FRAMES)
            .map(|i| {
                let camera = Camera {
                    seed: u64::from(i),
                    ..camera.clone()
                };
                picture(&camera, &print, 0.7 * f64::from(i))
            })
            .collect();
        let mut first = Vec::new();
        let mut all = Vec::new();
        for _ in 0..rounds {
            let mut reader = ScaleReader::new(ReadOptions::default());
            first.push(time(|| {
                black_box(reader.read(&pictures[0]).expect("a scale"));
            }));
            // Alternating displacement, so that all steps have the same length.
            for picture in pictures.iter().chain(pictures.iter().rev()) {
                all.push(time(|| {
                    black_box(reader.read(picture).expect("a scale"));
                }));
            }
        }
        say(&format!("{name}: first frame"), &mut first);
        say(&format!("{name}: reading"), &mut all);
        if name == "lying" {
            let files = [
                ("PNG, 8-bit grey", png(&camera, &print, 0.0)),
                ("JPEG, quality 90", jpeg(&camera, &print, 0.0, 90)),
            ];
            for (kind, file) in files {
                let mut decode: Vec<f64> = (0..rounds)
                    .map(|_| time(|| drop(black_box(decode(&file).expect("a picture")))))
                    .collect();
                say(
                    &format!("decoding {kind} ({:.1} MB)", file.len() as f64 * 1e-6),
                    &mut decode,
                );
            }
        }
    }
}

fn time(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64()
}

fn say(what: &str, times: &mut [f64]) {
    times.sort_unstable_by(f64::total_cmp);
    let median = times[times.len() / 2];
    let slow = times[times.len() * 95 / 100];
    println!(
        "{what:36} {:7.2} ms median, {:7.2} ms 95 %: {:6.0} frames/s",
        1e3 * median,
        1e3 * slow,
        1.0 / median
    );
}
