//! Creep tests (CSV, XLSX, Parquet) and camera frames as bytes, corrupted in thousands of ways: no panic, and the
//! values read are valid. `fuzz/` does the same with coverage; `SINEW_ROUNDS=100` makes it a hundred times longer
//! here.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sinew_camera::{Picture, ReadOptions, ScaleReader, decode};
use sinew_creep::{TestOptions, TestQuantity, read_test_bytes};

const CSV: &[u8] =
    b"L0 (mm),350\ntime_s,force_N,elongation_mm\n0,2.0,0.0\n5,60.0,1.402\n10,60.1,1.44\n\
    20,60.0,1.51\n40,60.0,1.57\n80,59.9,1.63\n160,60.0,1.70\n320,60.0,1.77\n640,60.0,1.84\n";
const GERMAN: &[u8] =
    b"L0;350;mm\nPr\xfcfzeit;Kraft;Dehnung;Probe\nmin;daN;%;\n0,1;6,0;0,40;a\n1;6,0;0,44;a\n\
    2;6,0;0,46;a\n4;6,1;0,48;a\n0,1;6,0;0,41;b\n1;6,0;0,45;b\n2;6,0;0,47;b\n";
const PARQUET: &[u8] = include_bytes!("../../../fuzz/seeds/creep_test/parquet");
const XLSX: &[u8] = include_bytes!("../../../fuzz/seeds/creep_test/xlsx");

fn rounds(usual: usize) -> usize {
    let factor = std::env::var("SINEW_ROUNDS").ok();
    usual * factor.and_then(|f| f.parse().ok()).unwrap_or(1)
}

/// One to four places: a byte changed, removed, doubled, or a section copied elsewhere.
fn spoiled(bytes: &[u8], random: &mut impl Rng) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for _ in 0..random.random_range(1..5) {
        if out.is_empty() {
            return out;
        }
        let at = random.random_range(0..out.len());
        match random.random_range(0..6) {
            0 => out[at] = random.random(),
            1 => out[at] ^= 1 << random.random_range(0..8),
            2 => {
                out.remove(at);
            }
            3 => out.insert(at, b",;\t\n-.e\"9"[random.random_range(0..9)]),
            4 => out.truncate(at),
            _ => {
                let from = random.random_range(0..out.len());
                let to = (from + random.random_range(1..40)).min(out.len());
                let piece = out[from..to].to_vec();
                out.splice(at..at, piece);
            }
        }
    }
    out
}

#[test]
fn creep_tests() {
    let mut read = [0; 4];
    let rounds = rounds(300);
    for (kind, (seed, sound)) in [(0, CSV), (0, GERMAN), (1, PARQUET), (1, XLSX)]
        .into_iter()
        .enumerate()
    {
        // The first byte of the binary seeds is the fuzzer's.
        let sound = &sound[seed..];
        let mut random = ChaCha8Rng::seed_from_u64(kind as u64);
        for _ in 0..rounds {
            let bytes = spoiled(sound, &mut random);
            let Ok(test) = read_test_bytes(bytes, "f", &TestOptions::default()) else {
                continue;
            };
            read[kind] += 1;
            assert!(!test.specimens.is_empty());
            for specimen in &test.specimens {
                for quantity in TestQuantity::ALL {
                    let column = specimen.column(quantity);
                    assert!(column.is_none_or(|c| c.len() == specimen.lines.len()));
                }
                // Refused or prepared, and then of finite numbers on a rising clock.
                if let Ok(prepared) =
                    sinew_creep::prepare(specimen, &sinew_creep::PrepareOptions::default())
                {
                    let curve = &prepared.curve;
                    assert!(curve.time_s.windows(2).all(|w| w[0] <= w[1]));
                    assert!(curve.strain.iter().all(|e| e.is_finite()), "{curve:?}");
                }
            }
        }
    }
    println!("{read:?} of {rounds} read: CSV, German CSV, Parquet, XLSX");
    assert!(read[0] > rounds / 20 && read[1] > rounds / 20, "{read:?}");
}

#[test]
fn camera_frames() {
    const WIDTH: usize = 160;
    const HEIGHT: usize = 40;
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut found = 0;
    let rounds = rounds(40);
    let mut reader = ScaleReader::new(ReadOptions::default());
    for round in 0..rounds {
        if round % 6 == 0 {
            reader = ScaleReader::new(ReadOptions::default());
        }
        // Lines that the reader finds, with anything drawn over them.
        let drawn: Vec<u8> = (0..64).map(|_| random.random()).collect();
        let strength = random.random_range(0..4_u8);
        let shift = f64::from(drawn[0]) / 8.0;
        let levels = (0..WIDTH * HEIGHT)
            .map(|i| {
                let (x, y) = (i % WIDTH, i / WIDTH);
                let line = (0.63 * (x as f64 - shift)).cos() > 0.7;
                let over = drawn[(x / 8 + 20 * (y / 16)) % drawn.len()] / 4 * strength / 3;
                if line { over } else { 255 - over }
            })
            .collect();
        let picture = Picture::from_luma8(WIDTH, HEIGHT, levels).unwrap();
        if let Ok(reading) = reader.read(&picture) {
            found += 1;
            assert!((1e3 * reading.position_m).is_finite());
            assert!((0.0..=1.0).contains(&reading.quality), "{reading:?}");
        }
        let noise: Vec<u8> = (0..200).map(|_| random.random()).collect();
        let head: &[u8] = [&b"\x89PNG\r\n\x1a\n"[..], &b"\xff\xd8\xff\xe0"[..]][round % 2];
        if let Ok(picture) = decode(&[head, &noise].concat()) {
            let _ = reader.read(&picture);
        }
    }
    println!("{found} of {rounds} frames read");
    assert!(found > 0);
}
