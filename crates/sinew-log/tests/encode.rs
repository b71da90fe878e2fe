//! Encoded messages, compared with reference bytes.

use sinew_log::encode::{
    DiagnosticArray, DiagnosticStatus, Header, KeyValue, Level, Message as _, Stamp,
};

/// A length, the text and a closing zero; then filled up to a multiple of four.
fn string(text: &str) -> Vec<u8> {
    let mut bytes = (text.len() as u32 + 1).to_le_bytes().to_vec();
    bytes.extend(text.as_bytes());
    bytes.push(0);
    bytes
}

#[test]
fn diagnostic_array_matches_ros_bytes() {
    // The second begins where the first ends, at no multiple of four: a level is one byte.
    let one = |level| DiagnosticStatus {
        level,
        name: "elbow".into(),
        message: "longer".into(),
        hardware_id: "arm".into(),
        values: vec![KeyValue {
            key: "k".into(),
            value: "v".into(),
        }],
    };
    let status = [Level::Error, Level::Warn].map(one);
    let message = DiagnosticArray {
        header: Header::at(-1, "b").unwrap(),
        status: &status,
    };
    let mut bytes = vec![9; 3];
    message.encode(&mut bytes).unwrap();

    let mut body: Vec<u8> = Vec::new();
    let pad = |body: &mut Vec<u8>| body.resize(body.len().next_multiple_of(4), 0);
    // One nanosecond before 1970: seconds are floored.
    body.extend((-1_i32).to_le_bytes());
    body.extend(999_999_999_u32.to_le_bytes());
    body.extend(string("b"));
    pad(&mut body);
    body.extend(2_u32.to_le_bytes());
    for level in [2, 1] {
        body.push(level);
        for text in ["elbow", "longer", "arm"] {
            pad(&mut body);
            body.extend(string(text));
        }
        pad(&mut body);
        body.extend(1_u32.to_le_bytes());
        for text in ["k", "v"] {
            pad(&mut body);
            body.extend(string(text));
        }
    }
    assert_eq!(bytes[..4], [0, 1, 0, 0]);
    assert_eq!(bytes[4..], body);
    let text = DiagnosticArray::SCHEMA.text;
    for part in [
        "MSG: std_msgs/Header",
        "MSG: diagnostic_msgs/KeyValue",
        "byte level",
    ] {
        assert!(text.contains(part), "{part}");
    }
}

#[test]
fn stamp_range_is_1901_to_2038() {
    assert!(Stamp::new(i64::from(i32::MAX) * 1_000_000_000).is_some());
    assert!(Stamp::new((i64::from(i32::MAX) + 1) * 1_000_000_000).is_none());
    assert!(Stamp::new(i64::MIN).is_none());
}
