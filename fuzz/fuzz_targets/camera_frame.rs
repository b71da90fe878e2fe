//! Any grey levels, and any bytes as a picture, to the scale reader: no panic, readings in bounds.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_camera::{Picture, ReadOptions, ScaleReader, decode};

const WIDTH: usize = 160;
const HEIGHT: usize = 40;

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, rest)) = bytes.split_first() else {
        return;
    };
    let mut reader = ScaleReader::new(ReadOptions::default());
    let mut look = |picture: &Picture| {
        if let Ok(reading) = reader.read(picture) {
            assert!(reading.position_m.is_finite());
            assert!((0.0..=1.0).contains(&reading.quality), "{reading:?}");
        }
    };
    if choice % 2 == 0 {
        if let Ok(picture) = decode(rest) {
            look(&picture);
        }
        return;
    }
    // Lines that the reader finds, with whatever the fuzzer draws over them, frame after frame.
    for frame in rest.chunks(64).take(6) {
        let shift = f64::from(frame[0]) / 8.0;
        let levels = (0..WIDTH * HEIGHT)
            .map(|i| {
                let (x, y) = ((i % WIDTH) as f64, i / WIDTH);
                let line = (0.63 * (x - shift)).cos() > 0.7;
                let drawn = frame[(x as usize / 8 + 20 * (y / 16)) % frame.len()];
                if line { drawn / 4 } else { 255 - drawn / 2 }
            })
            .collect();
        look(&Picture::from_luma8(WIDTH, HEIGHT, levels).expect("the sizes fit"));
    }
});
