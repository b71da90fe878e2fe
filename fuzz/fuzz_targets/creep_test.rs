//! Any bytes as a creep test (CSV, XLSX, Parquet): no panic of ours, and columns of one length.
//!
//! The libraries for workbooks and Parquet may panic on damaged bytes; the reader catches that. The
//! fuzzer would end at the first, so panics in other people's files are left to the reader.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_creep::{TestOptions, TestQuantity, read_test_bytes};

fuzz_target!(
    init: {
        std::panic::set_hook(Box::new(|info| {
            let ours = info
                .location()
                .is_none_or(|at| at.file().contains("sinew") || at.file().contains("fuzz_targets"));
            if ours {
                eprintln!("{info}");
                std::process::abort();
            }
        }));
    },
    |bytes: &[u8]| {
        let Some((&choice, rest)) = bytes.split_first() else {
            return;
        };
        // A header that is understood leaves the fuzzer the rows.
        let header: &[u8] = match choice % 4 {
            0 => b"",
            1 => b"time_s,force_N,elongation_mm\n",
            2 => b"L0;350;mm\nPr\xfcfzeit;Kraft;Dehnung;Probe\nmin;daN;%;\n",
            _ => b"specimen\tt / h\tstrain [%]\tT\n",
        };
        let file = [header, rest].concat();
        let options = TestOptions {
            sheet: (choice >= 128).then(|| "Sheet1".to_owned()),
            ..TestOptions::default()
        };
        let Ok(test) = read_test_bytes(file, "f", &options) else {
            return;
        };
        assert!(!test.specimens.is_empty());
        for specimen in &test.specimens {
            for quantity in TestQuantity::ALL {
                if let Some(column) = specimen.column(quantity) {
                    assert_eq!(column.len(), specimen.lines.len());
                }
            }
        }
    }
);
