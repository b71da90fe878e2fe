//! Any text as a mapping: no panic; what is accepted can be applied.
#![no_main]

use std::io::Cursor;

use libfuzzer_sys::fuzz_target;
use sinew_log::{Mapping, OpenOptions, Recording};

const TABLE: &[u8] = b"time_s,x,y\n0,1,2\n0.1,2,3\n0.2,nan,inf\n";

fuzz_target!(|text: &str| {
    let Ok(mapping) = Mapping::from_toml(text, "m.toml") else {
        return;
    };
    let options = OpenOptions {
        mapping: Some(mapping),
        ..OpenOptions::default()
    };
    let opened = Recording::from_reader(Box::new(Cursor::new(TABLE)), "f.csv", &options);
    if let Ok(mut recording) = opened {
        while let Ok(Some(_)) = recording.next_frame() {}
    }
});
