//! Frames read ahead on another thread are those read one by one.

use crate::support::{open_bytes, read_bytes};
use sinew_log::{Frame, LogError, OpenOptions, Recording};
use std::ops::ControlFlow;

/// 13 batches and a part of one.
const ROWS: usize = 3500;

/// A table of one joint; `cell` of the motor's position in every row.
fn table(cell: impl Fn(usize) -> String) -> Vec<u8> {
    let mut text = String::from("time_s,q.a_rad,theta.a_rad\n");
    for row in 0..ROWS {
        let t = 0.004 * row as f64;
        text.push_str(&format!("{t:.3},{:.6},{}\n", (0.5 * t).sin(), cell(row)));
    }
    text.into_bytes()
}

fn opened(bytes: &[u8]) -> Recording {
    open_bytes(bytes, "a.csv", &OpenOptions::default()).expect("recording")
}

/// Frames received before the closure breaks at `at`, and the result.
fn handed(
    recording: &mut Recording,
    at: usize,
) -> (Vec<Frame>, Result<Option<&'static str>, LogError>) {
    let (mut frames, mut last) = (Vec::new(), 0);
    let end = recording.each_frame(|frame, progress| {
        assert!((last..=progress.bytes_total).contains(&progress.bytes_done));
        last = progress.bytes_done;
        if frames.len() == at {
            return ControlFlow::Break("enough");
        }
        frames.push(frame.clone());
        ControlFlow::Continue(())
    });
    (frames, end)
}

#[test]
fn ahead_returns_frames_in_order_and_complete_health() {
    let bytes = table(|row| match row {
        700 => "nan".into(),
        _ => format!("{:.6}", 1e-3 * row as f64),
    });
    let (one_by_one, health) = read_bytes(&bytes, "a.csv");
    assert_eq!(one_by_one.len(), ROWS);
    let mut recording = opened(&bytes);
    let (frames, end) = handed(&mut recording, usize::MAX);
    assert!(matches!(end, Ok(None)), "{end:?}");
    // NaN is not itself.
    assert_eq!(format!("{frames:?}"), format!("{one_by_one:?}"));
    assert_eq!(format!("{:?}", recording.health()), format!("{health:?}"));
    // A recording that has ended stays so.
    let (none, end) = handed(&mut recording, usize::MAX);
    assert!(none.is_empty() && matches!(end, Ok(None)), "{end:?}");
}

#[test]
fn reading_stops_when_it_is_enough() {
    let bytes = table(|_| "0.1".into());
    for at in [0, 1, 255, 256, 1000] {
        let mut recording = opened(&bytes);
        let (frames, end) = handed(&mut recording, at);
        assert!(matches!(end, Ok(Some("enough"))), "{end:?}");
        let expected = &read_bytes(&bytes, "a.csv").0[..at];
        assert_eq!(format!("{frames:?}"), format!("{expected:?}"));
        // It has not read on to the end: 1024 frames ahead of the batch that was being used.
        assert!(recording.next_frame().expect("frame").is_some(), "{at}");
    }
}

#[test]
fn error_follows_preceding_frames() {
    const BAD: usize = 1000;
    let bytes = table(|row| if row == BAD { "0.1x" } else { "0.1" }.into());
    let mut recording = opened(&bytes);
    let mut one_by_one = 0;
    let expected = loop {
        match recording.next_frame() {
            Ok(Some(_)) => one_by_one += 1,
            Ok(None) => panic!("no error"),
            Err(error) => break error.to_string(),
        }
    };
    assert!(expected.contains("0.1x"), "{expected}");
    let (frames, end) = handed(&mut opened(&bytes), usize::MAX);
    assert_eq!(end.expect_err("refused").to_string(), expected);
    assert_eq!(frames.len(), one_by_one);
}
