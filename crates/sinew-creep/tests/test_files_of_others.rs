//! Creep tests as other programs write them (`data/make_creep_tests.py`), and their bytes damaged.

use sinew_creep::{TestFormat, TestOptions, TestQuantity, read_test, read_test_bytes};
use std::path::{Path, PathBuf};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

#[track_caller]
fn assert_near(found: Option<&[f64]>, want: &[f64]) {
    let found = found.expect("a column");
    assert_eq!(found.len(), want.len(), "{found:?}");
    for (f, w) in found.iter().zip(want) {
        let same = (f.is_nan() && w.is_nan()) || (f - w).abs() <= 1e-12 * w.abs().max(1e-3);
        assert!(same, "{found:?} {want:?}");
    }
}

#[test]
fn workbook_sheets_give_tests() {
    let file = read_test(&data("creep.xlsx"), &TestOptions::default()).unwrap();
    assert_eq!(file.format, TestFormat::Xlsx);
    assert_eq!(file.specimens.len(), 2, "{:?}", file.source.notes);
    assert!(
        file.source
            .notes
            .iter()
            .any(|n| n.starts_with("sheet 'Notes' is not used: ")),
        "{:?}",
        file.source.notes
    );
    let a = &file.specimens[0];
    assert_near(a.column(TestQuantity::Time), &[0.0, 60.0, 180.0]);
    assert_near(a.column(TestQuantity::Force), &[60.0; 3]);
    // The last cell was typed as text, with a decimal comma.
    assert_near(
        a.column(TestQuantity::Elongation),
        &[0.7e-3, 0.875e-3, 0.945e-3],
    );
    assert_near(a.column(TestQuantity::GaugeLength), &[0.35; 3]);
    assert_eq!(a.attribute("Operator"), Some("K. M."));
    let b = &file.specimens[1];
    assert_near(b.column(TestQuantity::Time), &[0.0, 60.0, 180.0, 360.0]);
    let nan = f64::NAN;
    assert_near(b.column(TestQuantity::Force), &[60.0, nan, 60.0, nan]);
    // A cell with #DIV/0! has no value (the formula has not been evaluated yet).
    assert_near(b.column(TestQuantity::Strain), &[2e-3, 2.5e-3, 2.7e-3, nan]);
}

#[test]
fn sheet_is_selected_by_name_and_error_lists_names() {
    let mut options = TestOptions {
        sheet: Some("Rope B".into()),
        ..TestOptions::default()
    };
    let file = read_test(&data("creep.xlsx"), &options).unwrap();
    assert_eq!(file.specimens.len(), 1);
    options.sheet = Some("Rope C".into());
    let error = read_test(&data("creep.xlsx"), &options).unwrap_err();
    assert!(error.to_string().contains("Rope A"), "{error}");
    let error = read_test(&data("creep.parquet"), &options).unwrap_err();
    assert!(error.to_string().contains("not a workbook"), "{error}");
    options.sheet = Some("Notes".into());
    let error = read_test(&data("creep.xlsx"), &options).unwrap_err();
    assert!(error.to_string().contains("no header"), "{error}");
}

#[test]
fn parquet_file_gives_numbers_of_every_kind() {
    let file = read_test(&data("creep.parquet"), &TestOptions::default()).unwrap();
    assert_eq!(file.format, TestFormat::Parquet);
    let names: Vec<&str> = file.specimens.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["A", "B"]);
    let (a, b) = (&file.specimens[0], &file.specimens[1]);
    assert_near(a.column(TestQuantity::Time), &[0.0, 60.0, 180.0]);
    assert_near(a.column(TestQuantity::Force), &[60.0, 60.0, f64::NAN]);
    assert_near(a.column(TestQuantity::Strain), &[2e-3, 2.5e-3, 2.7e-3]);
    assert_near(b.column(TestQuantity::Strain), &[4e-3, 5e-3, f64::NAN]);
    // Decimals are read as numbers, too.
    assert_near(a.column(TestQuantity::Temperature), &[23.0; 3]);
}

/// Deterministic positions of flipped bits.
fn mixed(i: usize) -> usize {
    let mut x = i as u64 + 0x9e37_79b9_7f4a_7c15;
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31)) as usize
}

#[test]
fn damaged_files_are_read_or_rejected_with_reason() {
    // Panics inside the libraries are caught; their output is suppressed.
    std::panic::set_hook(Box::new(|_| {}));
    for name in ["creep.xlsx", "creep.parquet"] {
        let whole = std::fs::read(data(name)).unwrap();
        let options = TestOptions::default();
        let mut refused = 0;
        for cut in (0..whole.len()).step_by(whole.len() / 100) {
            let error = read_test_bytes(whole[..cut].to_vec(), name, &options)
                .expect_err("a cut file has lost its directory");
            assert!(error.to_string().contains(name), "{error}");
        }
        for round in 0..300 {
            let mut bytes = whole.clone();
            let place = mixed(round) % bytes.len();
            bytes[place] ^= 1 << (mixed(round + 1000) % 8);
            if let Err(error) = read_test_bytes(bytes, name, &options) {
                assert!(error.to_string().contains(name), "{error}");
                refused += 1;
            }
        }
        assert!(refused > 50, "{name}: {refused} of 300 refused");
    }
    drop(std::panic::take_hook());
}
