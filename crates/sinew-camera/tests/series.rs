//! Folders and videos: times, order, ignored files, errors and output.

use crate::scale_picture::{Camera, Print, draw8, jpeg, png};
use crate::skipped::skipped;
use sinew_camera::{
    CameraError, Outcome, RejectionKind, Request, Summary, Times, VideoTools, html,
};
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

fn camera() -> Camera {
    Camera {
        width: 400,
        height: 160,
        ..Camera::default()
    }
}

fn frame(displacement: f64) -> Vec<u8> {
    png(&camera(), &Print::half_millimetre(), displacement)
}

fn put(folder: &TempDir, name: &str, bytes: &[u8]) {
    std::fs::write(folder.path().join(name), bytes).unwrap();
}

fn run(request: &Request) -> Result<Outcome, CameraError> {
    sinew_camera::run(request, &mut |_| {})
}

fn at_rate(folder: &Path, rate: f64) -> Request {
    let mut request = Request::new(folder);
    request.times = Times::Rate(rate);
    request
}

fn elongations(outcome: &Outcome) -> Vec<(f64, f64)> {
    outcome
        .used()
        .map(|(_, frame, reading)| (frame.time_s, 1e3 * outcome.elongation_m(reading).0))
        .collect()
}

fn assert_close(found: &[(f64, f64)], want: &[(f64, f64)]) {
    assert_eq!(found.len(), want.len(), "{found:?}");
    for (f, w) in found.iter().zip(want) {
        assert!(
            (f.0 - w.0).abs() < 1e-9 && (f.1 - w.1).abs() < 1e-3,
            "{found:?} {want:?}"
        );
    }
}

#[test]
fn folder_of_frames_gives_recording() {
    let folder = TempDir::new().unwrap();
    for (name, at) in [("f_0.0s.png", 0.0), ("f_10.5s.png", 0.8), ("f_9s.png", 0.6)] {
        put(&folder, name, &frame(at));
    }
    put(
        &folder,
        "f_20s.JPG",
        &jpeg(&camera(), &Print::half_millimetre(), 1.4, 85),
    );
    put(&folder, "notes.txt", b"not a frame");
    let mut request = Request::new(folder.path());
    request.elongation_per_movement = -0.5;
    request.conditions.force_n = Some(100.0);
    request.conditions.gauge_length_m = Some(0.7);
    let overlay = folder.path().join("overlay.png");
    request.overlay = Some(overlay.clone());
    let outcome = run(&request).unwrap();
    // Displacement in graduations of 0.5 mm, times −0.5.
    assert_close(
        &elongations(&outcome),
        &[(0.0, 0.0), (9.0, -0.15), (10.5, -0.2), (20.0, -0.35)],
    );
    assert!(
        outcome
            .notes
            .iter()
            .any(|n| n.contains("1 files that are not frames"))
    );
    let csv = outcome.recording_csv();
    let mut lines = csv.lines();
    assert_eq!(
        lines.next().unwrap(),
        "time_s,elongation_mm,elongation_std_mm,quality,contrast,in_sight,residual_mm,lines,frame,force_N,gauge_length_mm"
    );
    assert!(
        lines
            .clone()
            .all(|l| l.split(',').count() == 11 && l.ends_with(",100,700")),
        "{csv}"
    );
    assert_eq!(lines.count(), 4);
    let summary = Summary::of(&outcome);
    assert_eq!((summary.frames, summary.frames_used), (4, 4));
    assert!((1e-3 * summary.px_per_m - 20.0).abs() < 0.01);
    assert!((1e3 * summary.elongation_last_m + 0.35).abs() < 1e-3);
    let json = serde_json::to_value(&summary).unwrap();
    assert_eq!(json["scale"]["pitch_m"], 0.5e-3);
    let page = html(&outcome, "bench <7>", "0");
    assert!(page.contains("bench &lt;7&gt;") && page.contains("<svg"));
    // The overlay has the picture at the top and green lines on the print.
    let file = std::io::BufReader::new(std::fs::File::open(&overlay).unwrap());
    let mut drawn = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; drawn.output_buffer_size().unwrap()];
    let size = drawn.next_frame(&mut pixels).unwrap();
    assert_eq!((size.width, size.color_type), (400, png::ColorType::Rgb));
    assert!(size.height > 160);
    let green = pixels
        .chunks_exact(3)
        .filter(|p| p[1] > p[0].saturating_add(60))
        .count();
    assert!(green > 200, "{green} green pixels");
    // Only complete files remain.
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(left.len(), 6, "{left:?}");
}

#[test]
fn single_frame_is_reference_with_note() {
    let folder = TempDir::new().unwrap();
    put(&folder, "a.png", &frame(3.0));
    let outcome = run(&at_rate(folder.path(), 1.0)).unwrap();
    assert_close(&elongations(&outcome), &[(0.0, 0.0)]);
    assert!(
        outcome.notes.iter().any(|n| n.contains("one frame only")),
        "{:?}",
        outcome.notes
    );
}

#[test]
fn invalid_frames_are_listed_and_others_read() {
    let folder = TempDir::new().unwrap();
    let good = frame(0.4);
    put(&folder, "1.png", b"");
    put(&folder, "2.png", &frame(0.0));
    put(&folder, "3.png", &good[..good.len() / 2]);
    put(&folder, "4.png", b"%PDF-1.4 not a picture");
    let small = Camera {
        width: 200,
        ..camera()
    };
    put(
        &folder,
        "5.png",
        &png(&small, &Print::half_millimetre(), 0.2),
    );
    put(&folder, "6.png", &good);
    std::fs::create_dir(folder.path().join("7.png")).unwrap();
    let outcome = run(&at_rate(folder.path(), 2.0)).unwrap();
    assert_close(&elongations(&outcome), &[(0.5, 0.0), (2.5, 0.2)]);
    assert_eq!(outcome.reference, "2.png");
    let rejected = outcome.rejected();
    assert_eq!(
        (rejected[0].reason, rejected[0].frames),
        (RejectionKind::Unreadable, 3),
        "{rejected:?}"
    );
    assert!(
        rejected[1]
            .first
            .contains("200 × 160 px, but the reference frame has 400 × 160"),
        "{rejected:?}"
    );
    let frames = outcome.frames_csv();
    assert_eq!(frames.lines().count(), 7);
    assert!(frames.contains("other-size"), "{frames}");
}

#[test]
fn times_from_unsorted_table_are_used() {
    let folder = TempDir::new().unwrap();
    for (name, at) in [
        ("a.png", 0.0),
        ("b.png", 0.3),
        ("c.png", 0.6),
        ("d.png", 0.9),
        ("e.png", 5.0),
    ] {
        put(&folder, name, &frame(at));
    }
    let table = folder.path().join("times.csv");
    let with = |text: &str| {
        std::fs::write(&table, text).unwrap();
        let mut request = Request::new(folder.path());
        request.times = Times::Table(table.clone());
        run(&request)
    };
    // c before b, d at the time of b, gone.png missing, e not listed.
    let outcome =
        with("file,time_s,remark\na.png,0,x\nc.png,20,\nb.png,10,\nd.png,10.0,\ngone.png,30,\n")
            .unwrap();
    assert_close(
        &elongations(&outcome),
        &[(0.0, 0.0), (10.0, 0.15), (20.0, 0.3)],
    );
    let notes = outcome.notes.join("; ");
    assert!(notes.contains("times fall at line 4"), "{notes}");
    assert!(
        notes.contains("1 frames of the folder are not in"),
        "{notes}"
    );
    let kinds: Vec<_> = outcome.rejected().iter().map(|r| r.reason).collect();
    assert!(
        kinds.contains(&RejectionKind::SameTime) && kinds.contains(&RejectionKind::Unreadable),
        "{kinds:?}"
    );
    for (text, want) in [
        ("file,t\na.png,0\n", "no column 'time_s'"),
        (
            "file,time_s\na.png,soon\n",
            "line 2, column 'time_s' = 'soon' (s): is not a finite number",
        ),
        ("file,time_s\na.png,nan\n", "is not a finite number"),
        ("file,time_s\na.png\n", "line 2: 'time_s' is empty"),
        (
            "file,time_s\na.png,0\na.png,1\n",
            "line 3, column 'file' = 'a.png': must be named once; it is named twice",
        ),
        ("file,time_s\n../a.png,0\n", "must be the name of a file"),
        ("file,time_s\n", "no row names a frame"),
        ("", "is empty; it needs a line of column names"),
    ] {
        let error = with(text).unwrap_err().to_string();
        assert!(
            error.contains(want) && error.contains("times.csv"),
            "{text:?}: {error}"
        );
    }
}

#[test]
fn unusable_input_error_suggests_fix() {
    let folder = TempDir::new().unwrap();
    let assert_error = |request: &Request, want: &str| {
        let error = run(request).unwrap_err().to_string();
        assert!(error.contains(want), "{error}");
    };
    put(&folder, "readme.md", b"");
    assert_error(&at_rate(folder.path(), 1.0), "no PNG or JPEG frames");
    assert_error(&at_rate(&folder.path().join("nowhere"), 1.0), "nowhere");
    put(&folder, "frame_0001.png", &frame(0.0));
    assert_error(
        &Request::new(folder.path()),
        "--frame-rate HZ or --times FILE.csv",
    );
    assert_error(&at_rate(folder.path(), 0.0), "a frame rate of 0 1/s");
    let mut request = at_rate(folder.path(), 1.0);
    request.read.pitch_m = Some(-1e-3);
    assert_error(&request, "a line every -1 mm");
    let mut request = at_rate(folder.path(), 1.0);
    request.elongation_per_movement = 0.0;
    assert_error(&request, "an elongation of 0 mm per mm");
    let mut request = at_rate(folder.path(), 1.0);
    request.read.region = Some(sinew_camera::Region {
        x: 300,
        y: 0,
        width: 200,
        height: 100,
    });
    assert_error(&request, "outside the picture of 400 × 160 px");
    let blank = TempDir::new().unwrap();
    let nothing = Print {
        from: 0.0,
        to: -1.0,
        ..Print::half_millimetre()
    };
    put(&blank, "1.png", &png(&camera(), &nothing, 0.0));
    assert_error(
        &at_rate(blank.path(), 1.0),
        "none of 1 frames could be used; the first: 1.png: no scale",
    );
    let wrong = TempDir::new().unwrap();
    put(
        &wrong,
        "1.png",
        &png(&Camera::default(), &Print::millimetre(), 0.0),
    );
    assert_error(
        &at_rate(wrong.path(), 1.0),
        "1.png: every 5th line is longer",
    );
}

#[test]
fn video_without_ffmpeg_error_suggests_installation() {
    let folder = TempDir::new().unwrap();
    put(&folder, "bench.mp4", b"not a video");
    let mut request = Request::new(folder.path().join("bench.mp4"));
    request.tools = VideoTools {
        ffmpeg: "no-such-ffmpeg".into(),
        ffprobe: "no-such-ffprobe".into(),
    };
    let error = run(&request).unwrap_err().to_string();
    assert!(
        error.contains("'no-such-ffprobe', which is not installed; install ffmpeg"),
        "{error}"
    );
    request.input = folder.path().join("gone.mp4");
    assert!(run(&request).unwrap_err().to_string().contains("gone.mp4"));
}

#[test]
fn video_is_decoded_by_ffmpeg() {
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        skipped("ffmpeg is not installed");
        return;
    }
    let folder = TempDir::new().unwrap();
    let mut raw = Vec::new();
    for i in 0..8 {
        raw.extend(draw8(
            &camera(),
            &Print::half_millimetre(),
            0.3 * f64::from(i),
        ));
    }
    put(&folder, "raw", &raw);
    let video = folder.path().join("bench.avi");
    let made = Command::new("ffmpeg")
        .args([
            "-v", "error", "-f", "rawvideo", "-pix_fmt", "gray", "-s", "400x160", "-r", "4", "-i",
        ])
        .arg(folder.path().join("raw"))
        .args(["-c:v", "mjpeg", "-q:v", "3", "-pix_fmt", "yuvj420p"])
        .arg(&video)
        .output()
        .unwrap();
    assert!(
        made.status.success(),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    let want: Vec<(f64, f64)> = (0..8)
        .map(|i| (0.25 * f64::from(i), 0.15 * f64::from(i)))
        .collect();
    assert_close(&elongations(&run(&Request::new(&video)).unwrap()), &want);
    let error = run(&Request::new(folder.path().join("raw")))
        .unwrap_err()
        .to_string();
    assert!(error.contains("no video stream"), "{error}");
}
