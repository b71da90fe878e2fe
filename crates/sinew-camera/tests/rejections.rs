//! Rejection of unusable frames.

use crate::scale_picture::{Camera, Print, draw8, encode_png, picture, png};
use sinew_camera::{Picture, ReadOptions, Region, Rejection, RejectionKind, ScaleReader, decode};

fn started() -> ScaleReader {
    let mut reader = ScaleReader::new(ReadOptions::default());
    let first = picture(&Camera::default(), &Print::half_millimetre(), 0.0);
    reader.read(&first).unwrap();
    reader
}

fn word(result: &Result<sinew_camera::ScaleMeasurement, Rejection>) -> String {
    let word = |rejection: &Rejection| rejection.kind().to_string();
    result.as_ref().map_or_else(word, |_| "used".into())
}

#[test]
fn rejected_frames_report_kind() {
    let (camera, print) = (Camera::default(), Print::half_millimetre());
    let cases: Vec<(&str, Picture)> = vec![
        (
            "dark",
            picture(
                &Camera {
                    white: 8.0,
                    ..camera.clone()
                },
                &print,
                0.2,
            ),
        ),
        (
            "overexposed",
            picture(
                &Camera {
                    white: 1500.0,
                    ..camera.clone()
                },
                &print,
                0.2,
            ),
        ),
        (
            "blurred",
            picture(
                &Camera {
                    blur_px: 5.0,
                    ..camera.clone()
                },
                &print,
                0.2,
            ),
        ),
        (
            "blurred",
            picture(
                &Camera {
                    smear_px: 14.5,
                    ..camera.clone()
                },
                &print,
                0.2,
            ),
        ),
        (
            "no-scale",
            picture(
                &camera,
                &Print {
                    from: 0.0,
                    to: -1.0,
                    ..print.clone()
                },
                0.2,
            ),
        ),
        (
            "other-size",
            picture(
                &Camera {
                    width: 320,
                    ..camera.clone()
                },
                &print,
                0.2,
            ),
        ),
    ];
    let mut reader = started();
    for (i, (want, picture)) in cases.iter().enumerate() {
        let result = reader.read(picture);
        assert_eq!(word(&result), *want, "case {i}: {result:?}");
        assert!(!result.unwrap_err().to_string().is_empty());
    }
    // Rejected frames have no effect.
    let after = reader.read(&picture(&camera, &print, 1.7)).unwrap();
    assert!((1e3 * after.position_m - 0.85).abs() < 1e-3, "{after:?}");
}

/// A hand: bright skin with a coarse texture over part of the picture.
fn covered(share: f64, displacement: f64) -> Picture {
    let camera = Camera::default();
    let mut levels = draw8(&camera, &Print::half_millimetre(), displacement);
    let until = (share * camera.width as f64) as usize;
    for y in 0..camera.height {
        for x in 0..until {
            let texture =
                30.0 * ((x as f64 / 23.0).sin() + (y as f64 / 17.0 + x as f64 / 41.0).cos());
            levels[y * camera.width + x] = (140.0 + texture) as u8;
        }
    }
    Picture::from_luma8(camera.width, camera.height, levels).unwrap()
}

#[test]
fn scale_covered_by_half_is_used_by_80_percent_rejected() {
    let mut reader = started();
    for (share, at) in [(0.3, 1.2), (0.5, 2.6), (0.2, 9.1)] {
        let reading = reader.read(&covered(share, at)).unwrap();
        assert!(
            (1e3 * reading.position_m - 0.5 * at).abs() < 2e-3,
            "{share}: {reading:?}"
        );
        assert!(reading.visible_share < 1.05 - share, "{share}: {reading:?}");
        assert!(reading.quality < 1.05 - share, "{share}: {reading:?}");
    }
    let result = reader.read(&covered(0.8, 10.0));
    assert_eq!(word(&result), "covered", "{result:?}");
    let result = reader.read(&covered(1.0, 10.0));
    assert_eq!(word(&result), "no-scale", "{result:?}");
}

#[test]
fn picture_without_scale_is_not_reference() {
    let noise = picture(
        &Camera {
            noise: 30.0,
            ..Camera::default()
        },
        &Print {
            from: 0.0,
            to: -1.0,
            ..Print::half_millimetre()
        },
        0.0,
    );
    let mut reader = ScaleReader::new(ReadOptions::default());
    let result = reader.read(&noise);
    assert_eq!(word(&result), "no-scale", "{result:?}");
    assert_eq!(reader.scale(), None);
    let flat = Picture::from_luma8(64, 64, vec![128; 64 * 64]).unwrap();
    assert_eq!(word(&reader.read(&flat)), "no-scale");
    let tiny = Picture::from_luma8(3, 2, vec![128; 6]).unwrap();
    assert_eq!(word(&reader.read(&tiny)), "no-scale");
    // The first usable frame is the reference.
    let good = picture(&Camera::default(), &Print::half_millimetre(), 0.0);
    assert_eq!(reader.read(&good).unwrap().position_m, 0.0);
}

#[test]
fn excessive_tilt_is_rejected_as_no_scale() {
    let mut reader = ScaleReader::new(ReadOptions::default());
    let camera = Camera {
        tilt_deg: 17.0,
        height: 400,
        ..Camera::default()
    };
    let error = reader
        .read(&picture(&camera, &Print::half_millimetre(), 0.0))
        .unwrap_err();
    assert_eq!(error.kind(), RejectionKind::NoScale, "{error}");
}

#[test]
fn colour_and_16_bit_give_same_position() {
    let (camera, print) = (Camera::default(), Print::half_millimetre());
    let mut reader = started();
    let grey = draw8(&camera, &print, 1.1);
    let first = reader.read(&picture(&camera, &print, 1.1)).unwrap();
    let want = 1e3 * first.position_m;
    let colour: Vec<u8> = grey.iter().flat_map(|v| [*v, *v, *v]).collect();
    let alpha: Vec<u8> = grey.iter().flat_map(|v| [*v, *v, *v, 255]).collect();
    let deep: Vec<u8> = grey
        .iter()
        .flat_map(|v| (u16::from(*v) * 257).to_be_bytes())
        .collect();
    use png::{BitDepth, ColorType};
    for (bytes, kind, depth) in [
        (&colour, ColorType::Rgb, BitDepth::Eight),
        (&alpha, ColorType::Rgba, BitDepth::Eight),
        (&deep, ColorType::Grayscale, BitDepth::Sixteen),
    ] {
        let file = encode_png(&camera, bytes, kind, depth);
        let reading = reader.read(&decode(&file).unwrap()).unwrap();
        // Only the rounding of luminance to whole levels may differ.
        assert!(
            (1e3 * reading.position_m - want).abs() < 1e-4,
            "{kind:?}: {reading:?}"
        );
    }
}

#[test]
fn specified_region_excludes_second_scale() {
    let (camera, print) = (
        Camera {
            height: 160,
            ..Camera::default()
        },
        Print::half_millimetre(),
    );
    // Two scales, one above the other: the upper one moves, the lower one is stationary.
    let two = |at: f64| {
        let mut levels = draw8(&camera, &print, at);
        levels.extend(draw8(&camera, &print, 0.4));
        Picture::from_luma8(camera.width, 320, levels).unwrap()
    };
    for (y, moves) in [(0, 1.0), (160, 0.0)] {
        let region = Region {
            x: 0,
            y,
            width: 640,
            height: 160,
        };
        let mut reader = ScaleReader::new(ReadOptions {
            region: Some(region),
            ..ReadOptions::default()
        });
        reader.read(&two(0.0)).unwrap();
        let reading = reader.read(&two(3.3)).unwrap();
        assert!(
            (1e3 * reading.position_m - 1.65 * moves).abs() < 1e-3,
            "{y}: {reading:?}"
        );
    }
}

#[test]
fn invalid_files_are_rejected() {
    let file = png(&Camera::default(), &Print::comb(), 0.0);
    assert!(decode(&file).is_ok());
    for bytes in [
        &b""[..],
        b"hello",
        &file[..40],
        &file[..file.len() / 2],
        b"\x89PNG\r\n\x1a\n",
        b"\xff\xd8\xff",
    ] {
        assert!(decode(bytes).is_err(), "{} bytes", bytes.len());
    }
    // A header with a size beyond any camera.
    let mut huge = file.clone();
    huge[16..20].copy_from_slice(&60_000_u32.to_be_bytes());
    assert!(decode(&huge).is_err());
}
