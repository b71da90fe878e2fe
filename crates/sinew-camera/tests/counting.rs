//! Counting of whole graduations: long displacements, large steps, identical lines, wrong pitch.

use crate::scale_picture::{Camera, Print, picture};
use sinew_camera::{ReadOptions, Rejection, ScaleReader};

fn reader() -> ScaleReader {
    ScaleReader::new(ReadOptions::default())
}

#[test]
fn displacement_of_100_mm_and_back_returns_to_zero() {
    let (camera, print) = (Camera::default(), Print::half_millimetre());
    let mut reader = reader();
    let way = |i: i32| 200.0 * (std::f64::consts::PI * f64::from(i) / 120.0).sin();
    for i in 0..=120 {
        let reading = reader.read(&picture(&camera, &print, way(i))).unwrap();
        let error = 1e3 * reading.position_m - 0.5 * way(i);
        assert!(error.abs() < 2e-3, "frame {i}: {error} mm");
    }
}

#[test]
fn large_step_is_resolved_by_numbers() {
    let (camera, print) = (Camera::default(), Print::half_millimetre());
    let mut reader = reader();
    reader.read(&picture(&camera, &print, 0.0)).unwrap();
    for (at, jumped) in [(7.3, true), (7.4, false), (-21.8, true), (-9.3, true)] {
        let reading = reader.read(&picture(&camera, &print, at)).unwrap();
        assert!(
            (1e3 * reading.position_m - 0.5 * at).abs() < 2e-3,
            "{at}: {reading:?}"
        );
        assert_eq!(reading.jumped, jumped, "{at}");
    }
}

#[test]
fn identical_lines_count_small_steps_reject_large_ones() {
    let (camera, print) = (Camera::default(), Print::comb());
    let mut reader = reader();
    reader.read(&picture(&camera, &print, 0.0)).unwrap();
    assert_eq!(reader.scale().unwrap().longer_every, None);
    for at in [0.3, 0.65, 1.0, 1.38] {
        let reading = reader.read(&picture(&camera, &print, at)).unwrap();
        assert!(
            (1e3 * reading.position_m - 0.5 * at).abs() < 2e-3,
            "{at}: {reading:?}"
        );
    }
    match reader.read(&picture(&camera, &print, 1.83)) {
        Err(Rejection::Ambiguous { nearest_m, other_m }) => {
            assert!((1e3 * nearest_m - 0.225).abs() < 2e-3, "{nearest_m}");
            assert!((1e3 * other_m + 0.275).abs() < 2e-3, "{other_m}");
        }
        other => panic!("{other:?}"),
    }
    // A frame is missing, so a step may be twice as long as it appears.
    let twice = reader.read(&picture(&camera, &print, 1.68));
    assert!(
        matches!(twice, Err(Rejection::Ambiguous { .. })),
        "{twice:?}"
    );
    let near = reader.read(&picture(&camera, &print, 1.45)).unwrap();
    assert!((1e3 * near.position_m - 0.725).abs() < 2e-3, "{near:?}");
}

#[test]
fn millimetre_scale_with_default_pitch_returns_error() {
    let (camera, print) = (Camera::default(), Print::millimetre());
    let mut said_nothing = reader();
    said_nothing.read(&picture(&camera, &print, 0.0)).unwrap();
    let error = said_nothing.check_pitch().unwrap_err();
    assert!(error.to_string().contains("every 5th line"), "{error}");
    assert!(error.to_string().contains("--pitch 1mm"), "{error}");
    let mut said = ScaleReader::new(ReadOptions {
        pitch_m: Some(1e-3),
        ..ReadOptions::default()
    });
    said.read(&picture(&camera, &print, 0.0)).unwrap();
    said.check_pitch().unwrap();
    let reading = said.read(&picture(&camera, &print, 2.6)).unwrap();
    assert!((1e3 * reading.position_m - 2.6).abs() < 4e-3, "{reading:?}");
}

#[test]
fn scale_end_passing_through_picture_keeps_position() {
    let camera = Camera {
        zero_px: 0.0,
        ..Camera::default()
    };
    let print = Print {
        from: -40.0,
        to: 10.0,
        ..Print::half_millimetre()
    };
    let mut reader = reader();
    for i in 0..12 {
        let at = 2.3 * f64::from(i);
        let reading = reader.read(&picture(&camera, &print, at)).unwrap();
        assert!(
            (1e3 * reading.position_m - 0.5 * at).abs() < 2e-3,
            "{at}: {reading:?}"
        );
    }
}
