//! Any bytes as an MCAP recording: no panic, no hang, frames in order and finite or NaN.
#![no_main]

use std::io::Cursor;

use libfuzzer_sys::fuzz_target;
use sinew_log::{OpenOptions, Quantity, Recording};

/// Most memory a chunk may take here: fuzzers stop at 2 GB.
const MEMORY_BYTES: u64 = 16 << 20;

fuzz_target!(|bytes: &[u8]| {
    // The magic is not worth searching for.
    let mut file = Vec::with_capacity(bytes.len() + 8);
    if !bytes.starts_with(b"\x89MCAP0\r\n") {
        file.extend_from_slice(b"\x89MCAP0\r\n");
    }
    file.extend_from_slice(bytes);
    let options = OpenOptions {
        budget: sinew_log::Budget::RECORDING.with_memory(MEMORY_BYTES),
        ..OpenOptions::default()
    };
    let length = file.len() as u64;
    let Ok(mut recording) = Recording::from_reader(Box::new(Cursor::new(file)), "f.mcap", &options)
    else {
        return;
    };
    let joints = recording.joints().len();
    let mut last = None;
    while let Some(frame) = recording.next_frame().expect("memory does not fail") {
        let now = (frame.segment, frame.time_ns);
        assert!(last.is_none_or(|last| now > last));
        last = Some(now);
        for quantity in Quantity::PER_JOINT {
            assert_eq!(frame.get(quantity).len(), joints);
            assert!(frame.get(quantity).iter().all(|value| !value.is_infinite()));
        }
    }
    assert!(recording.progress().bytes_done <= length);
});
