//! Any bytes as a table, with and without a mapping: no panic, no hang, frames in order.
#![no_main]

use std::io::Cursor;

use libfuzzer_sys::fuzz_target;
use sinew_log::{Mapping, OpenOptions, Recording};

const MAPPING: &str = r#"
[time]
column = "t"
unit = "ms"
[joints.a]
q = { column = "x", unit = "deg" }
theta = { sum = [{ column = "x" }, { column = "y", scale = -0.5 }] }
"#;

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, rest)) = bytes.split_first() else {
        return;
    };
    // A header that is understood leaves the fuzzer the rows.
    let header: &[u8] = match choice % 4 {
        0 => b"",
        1 => b"time_s,q.a_rad,theta.a_rad,tau_el.b_nm,temperature_c\n",
        2 => b"time_ns;q.a_rad;theta.a_rad\r\n",
        _ => b"t,x,y\n",
    };
    let file = [header, rest].concat();
    let mapping = (choice % 4 == 3).then(|| Mapping::from_toml(MAPPING, "m.toml").expect("sound"));
    let options = OpenOptions {
        mapping,
        ..OpenOptions::default()
    };
    let Ok(mut recording) = Recording::from_reader(Box::new(Cursor::new(file)), "f.csv", &options)
    else {
        return;
    };
    let mut last = None;
    while let Ok(Some(frame)) = recording.next_frame() {
        let now = (frame.segment, frame.time_ns);
        assert!(last.is_none_or(|last| now > last));
        last = Some(now);
    }
    assert!(recording.next_frame().expect("ended").is_none());
});
