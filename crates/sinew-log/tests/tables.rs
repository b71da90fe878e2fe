//! CSV as people and programs write it, and what is wrong with some of it.

use crate::support::*;
use sinew_log::{Axis, Frame, Health, LogError, Mapping, OpenOptions, Quantity, Recording};

fn read(text: &str) -> (Vec<Frame>, Health) {
    read_bytes(text.as_bytes(), "a.csv")
}

fn error(text: &str) -> String {
    error_of(text.as_bytes(), "log.csv", &OpenOptions::default())
}

/// A table of `steps` rows at 100 Hz made by a function of the step.
fn table(header: &str, steps: i64, row: impl Fn(i64) -> String) -> String {
    let mut text = format!("{header}\n");
    for step in 0..steps {
        text.push_str(&format!("{}.{:02},{}\n", step / 100, step % 100, row(step)));
    }
    text
}

#[test]
fn delimiters_line_ends_quotes_and_byte_order_mark() {
    let plain = "time_s,q.a_rad,theta.a_rad\n0.5,1.5,2.5\n0.75,-1e-3,3\n";
    let variants = [
        plain.to_owned(),
        plain.replace(',', ";"),
        plain.replace(',', "\t"),
        plain.replace('\n', "\r\n"),
        format!("\u{feff}{plain}"),
        plain
            .replace("q.a_rad", "\"q.a_rad\"")
            .replace("2.5", "\"2.5\""),
        plain.replace(',', " , "),
        plain.trim_end().to_owned(),
        // A decimal comma where the comma does not separate cells.
        plain
            .replace(',', ";")
            .replace('.', ",")
            .replace("q,a", "q.a")
            .replace("theta,a", "theta.a"),
    ];
    for text in variants {
        let (frames, health) = read(&text);
        assert_eq!(frames.len(), 2, "{text:?}");
        assert_eq!(frames[0].time_ns, 500_000_000);
        assert_eq!((frames[0].q[0], frames[0].theta[0]), (1.5, 2.5), "{text:?}");
        assert_eq!((frames[1].q[0], frames[1].theta[0]), (-1e-3, 3.0));
        assert!(!health.is_lossy(), "{health:?}");
    }
}

#[test]
fn times_of_large_epochs_are_exact() {
    let text = "time_s,q.a_rad\n1530821160.123456789,0\n1530821160.123456790,0\n";
    let (frames, _) = read(text);
    assert_eq!(frames[0].time_ns, 1_530_821_160_123_456_789);
    assert_eq!(frames[1].time_ns, 1_530_821_160_123_456_790);
    let (frames, _) = read("q.a_rad,time_ns\n0,1530821160123456789\n");
    assert_eq!(frames[0].time_ns, 1_530_821_160_123_456_789);
}

#[test]
fn empty_cells_and_nan_are_not_the_same() {
    let (frames, health) = read("time_s,q.a_rad,theta.a_rad\n0,,1\n1,nan,1\n2,inf,1\n3,0.5,1\n");
    assert!(frames[..3].iter().all(|frame| frame.q[0].is_nan()));
    assert_eq!(frames[3].q[0], 0.5);
    // The empty cell was not recorded; NaN and infinity were, and are bad.
    assert_eq!(health.non_finite.iter().map(|s| s.count).sum::<u64>(), 2);
    assert_eq!(health.non_finite[0].quantity, Quantity::Q);
    assert_eq!(health.frames_without_joint_side, 3);
}

#[test]
fn all_nan_and_constant_signals_are_suspicious() {
    let text = table("time_s,q.a_rad,theta.a_rad,tau_el.a_nm", 200, |step| {
        format!("{},0.25,nan", 0.01 * step as f64)
    });
    let (_, health) = read(&text);
    let all = health.implausible_signals.join("\n");
    assert!(
        all.contains("theta.a is constant at 0.25 over 200 samples"),
        "{all}"
    );
    assert!(
        all.contains("tau_el.a has no finite value in 200 samples"),
        "{all}"
    );
}

#[test]
fn implausible_temperature_is_unknown_and_suggests_unit() {
    let of = |celsius: f64| {
        read(&format!(
            "time_s,q.a_rad,theta.a_rad,temperature_c\n0,0.1,0.1,{celsius}\n0.1,0.2,0.2,22\n"
        ))
    };
    let (frames, health) = of(295.15);
    assert!(frames[0].temperature_c.is_nan() && frames[1].temperature_c == 22.0);
    let told = health.implausible_signals.join("\n");
    assert!(
        told.contains("temperature of 295.1") && told.contains("unit = \"K\""),
        "{told}"
    );
    // A sensor that is broken is no kelvin.
    let (_, health) = of(-273.0);
    let told = health.implausible_signals.join("\n");
    assert!(
        told.contains("-273.0 °C") && !told.contains("kelvin"),
        "{told}"
    );
    for works in [-40.0, 120.0] {
        let (frames, health) = of(works);
        assert_eq!(frames[0].temperature_c, works);
        assert!(health.implausible_signals.is_empty(), "{health:?}");
    }
}

#[test]
fn degrees_gear_ratios_and_signs_are_suspected() {
    let text = table("time_s,q.elbow_rad,theta.elbow_rad", 200, |step| {
        let q = 71.5 * (0.05 * step as f64).sin();
        format!("{q},{q}")
    });
    let (_, health) = read(&text);
    assert!(
        health.implausible_signals[0].contains("q.elbow looks like degrees (range 14"),
        "{health:?}"
    );

    for (factor, word) in [
        (57.29578, "[joints.a] theta = { …, unit = \"deg\" }"),
        (1.0 / 57.29578, "[joints.a] q = { …, unit = \"deg\" }"),
        (100.0, "[joints.a] theta = { …, gear_ratio = 100.0000 }"),
        (0.1, "[joints.a] theta = { …, gear_ratio = 0.1000 }"),
        (-1.0, "[joints.a] theta = { …, sign = -1 }"),
    ] {
        // Less than half a turn between two samples, so that nothing is taken for a wrap-around.
        let text = table("time_s,q.a_rad,theta.a_rad", 400, |step| {
            let q = 0.8 * (0.03 * step as f64).sin();
            format!("{q},{}", q * factor)
        });
        let (_, health) = read(&text);
        let all = health.implausible_signals.join("\n");
        assert!(all.contains(word), "{factor}: {all}");
        let [ratio] = &health.motor_ratios[..] else {
            panic!("{health:?}");
        };
        assert!((ratio.slope / factor - 1.0).abs() < 1e-9, "{ratio:?}");
    }
    // What is right is not suspected.
    let text = table("time_s,q.a_rad,theta.a_rad", 400, |step| {
        let q = 1.2 * (0.05 * step as f64).sin();
        format!("{q},{}", q + 0.05 * (0.05 * step as f64).cos())
    });
    assert!(read(&text).1.implausible_signals.is_empty());
}

/// A node that repeats a pose writes rows between those of the driver, or at their times.
#[test]
fn rows_of_second_publisher_are_excluded() {
    let q = |k: i64| 0.8 * (0.005 * k as f64).sin();
    for (after_s, every) in [(0.0, 1), (0.002, 1), (0.002, 3), (0.0004, 50)] {
        let mut text = String::from("time_s,q.a_rad,theta.a_rad\n");
        let mut others = 0;
        for k in 0..1500 {
            let time_s = 0.004 * k as f64;
            text += &format!("{time_s:.4},{},{}\n", q(k), q(k) + 0.01);
            if k % every == 0 {
                text += &format!("{:.4},0.5,0.5\n", time_s + after_s);
                others += 1;
            }
        }
        let (frames, health) = read(&text);
        // Nothing follows the last row of a publisher that shows a step back.
        let last = usize::from(every == 1 && after_s > 0.0);
        assert_eq!(frames.len(), 1500 + last, "{after_s} {every}: {health:?}");
        for (k, frame) in frames.iter().take(1500).enumerate() {
            assert_eq!(frame.q[0], q(k as i64), "{after_s} {every}: {k}");
        }
        let [second] = &health.second_publishers[..] else {
            panic!("{health:?}");
        };
        // Of two first rows at one time the second is a repeated time stamp: nothing precedes them.
        let undecided = u64::from(every == 1);
        assert_eq!(second.samples + undecided, others, "{after_s} {every}");
    }
}

#[test]
fn encodings_of_other_systems() {
    let plain = "time_s;q.ärm_rad;theta.ärm_rad\n0,5;1,5;2,5\n0,75;-1e-3;3\n";
    // As text: a NaN is no other NaN.
    let expected = format!("{:?}", read(plain));
    let wide = |unit: fn(u16) -> [u8; 2], text: &str| -> Vec<u8> {
        let marked = format!("\u{feff}{text}");
        marked.encode_utf16().flat_map(unit).collect()
    };
    for bytes in [
        plain.chars().map(|c| c as u8).collect(),
        wide(u16::to_le_bytes, plain),
        wide(u16::to_be_bytes, plain),
        wide(u16::to_le_bytes, plain.trim_end()),
    ] {
        let options = OpenOptions::default();
        let recording = open_bytes(&bytes, "a.csv", &options).unwrap();
        assert_eq!(recording.joints(), ["ärm"]);
        assert_eq!(format!("{:?}", read_all(recording)), expected);
    }
    // A truncated last line is detected in UTF-16 too.
    let cut = plain.strip_suffix(";3\n").unwrap();
    let (_, health) = read_bytes(&wide(u16::to_le_bytes, cut), "a.csv");
    assert!(health.is_damaged(), "{health:?}");
}

#[test]
fn non_numeric_cell_error_names_location() {
    let message = error("time_s,q.a_rad\n0,1\n1,fault\n2,3\n");
    assert_eq!(
        message,
        "log.csv, line 3, column 'q.a_rad' = 'fault': is not a number; empty or nan means not recorded"
    );
    let message = error("time_s,q.a_rad\nsoon,1\n");
    assert!(
        message.contains("line 2, column 'time_s' = 'soon': is not a time"),
        "{message}"
    );
    let message = error("time_s,q.a_rad\n1e30,1\n");
    assert!(message.contains("1677 to 2262"), "{message}");
}

#[test]
fn columns_that_are_not_read_may_hold_anything() {
    let (frames, _) = read("time_s,note,q.a_rad\n0,\"hello, world\",1\n1,x,2\n");
    assert_eq!(frames.len(), 2);
}

#[test]
fn headers_that_will_not_do() {
    assert!(error("q.a_rad,theta.a_rad\n0,1\n").contains("no time column"));
    assert!(error("time_s,position\n0,1\n").contains("no column like q.<joint>_rad"));
    let message = error("time_s,q.a_rad,q.a_rad\n0,1,2\n");
    assert!(message.contains("duplicate column 'q.a_rad'"), "{message}");
    assert!(error("\n\n\n").contains("no header line"));
    assert!(error("hello").contains("no time column"));
}

#[test]
fn header_without_rows_has_no_frames() {
    let (frames, health) = read("time_s,q.a_rad\n");
    assert!(frames.is_empty() && !health.is_damaged());
    assert!(read("time_s,q.a_rad").0.is_empty());
}

#[test]
fn truncated_last_line_is_damage() {
    let whole = "time_s,q.a_rad,theta.a_rad\n0,1,2\n1,1,2\n";
    for (tail, lost) in [("2,1", 3), ("2", 1), ("2,1,-", 5), ("2,1,1e", 6)] {
        let (frames, health) = read(&format!("{whole}{tail}"));
        assert_eq!(frames.len(), 2, "{tail}");
        assert!(health.is_damaged(), "{tail}");
        assert_eq!(health.bytes_lost, lost);
        assert_eq!(health.damage[0].offset, whole.len() as u64);
        assert_eq!(health.damage[0].after_ns, Some(1_000_000_000));
    }
    // Complete but for its line end.
    let (frames, health) = read(&format!("{whole}2,1,2"));
    assert_eq!(frames.len(), 3);
    assert!(!health.is_damaged());
}

#[test]
fn ragged_rows_are_padded_and_counted() {
    let (frames, health) = read("time_s,q.a_rad,theta.a_rad\n0,1\n1,1,2,9\n2,1,2\n");
    assert_eq!(frames.len(), 3);
    assert!(frames[0].theta[0].is_nan());
    assert_eq!(frames[1].theta[0], 2.0);
    assert_eq!(health.ragged_rows, 2);
}

#[test]
fn rows_without_a_time_are_dropped_and_counted() {
    let (frames, health) = read("time_s,q.a_rad\n0,1\n,1\nnan,1\n1,1\n");
    assert_eq!(frames.len(), 2);
    assert_eq!(health.rows_without_time, 2);
    assert!(health.is_lossy());
}

#[test]
fn time_going_back_duplicates_and_gaps_in_a_table() {
    let mut text = String::from("time_s,q.a_rad\n");
    for time in [0.0, 0.1, 0.1, 0.3, 0.2, 10.4] {
        text.push_str(&format!("{time},0.5\n"));
    }
    for step in 0..20 {
        text.push_str(&format!("{},0.5\n", 0.1 * f64::from(step)));
    }
    let (frames, health) = read(&text);
    assert_eq!((health.duplicates, health.out_of_order), (1, 1));
    assert_eq!((health.gaps, health.clock_steps), (1, 1));
    assert_eq!(frames.len(), 5 + 20);
    let segments: Vec<u32> = frames.iter().map(|frame| frame.segment).collect();
    assert_eq!(segments[..6], [0, 0, 0, 0, 1, 2]);
    assert!(
        frames
            .windows(2)
            .all(|pair| pair[1].time_ns > pair[0].time_ns)
    );
}

#[test]
fn missing_motor_side_is_reported() {
    let text = table("time_s,q.a_rad,q.b_rad", 10, |_| "0,0".to_owned());
    let (frames, health) = read(&text);
    assert!(
        frames
            .iter()
            .all(|frame| frame.theta.iter().all(|v| v.is_nan()))
    );
    assert_eq!(health.frames_without_motor_side, 10);
}

#[test]
fn unclosed_quote_does_not_load_file_into_memory() {
    let mut text = String::from("time_s,q.a_rad\n0,1\n1,\"");
    text.push_str(&"2,3\n".repeat(4 << 20));
    let message = error(&text);
    assert!(message.contains("quote that is not closed"), "{message}");
    let message = error(&format!("time_s,q.a_rad{}", ",x".repeat(8 << 20)));
    assert!(
        message.contains("more than") || message.contains("columns"),
        "{message}"
    );
}

#[test]
fn stamps_without_end_in_one_instant_do_not_fill_the_memory() {
    // All within one reorder window, so nothing would leave it by time alone.
    let mut text = String::from("time_ns,q.a_rad\n");
    for step in 0..100_000 {
        text.push_str(&format!("{step},0.5\n"));
    }
    let (frames, _) = read(&text);
    assert_eq!(frames.len(), 100_000);
}

#[test]
fn prismatic_columns_do_not_wrap() {
    let (frames, health) = read("time_s,q.lift_m,theta.lift_m\n0,0,0\n0.1,3.5,3.5\n0.2,0,0\n");
    assert_eq!(frames[1].q[0], 3.5);
    assert!(health.unwrapped.is_empty());
}

#[test]
fn joints_are_selected_by_name() {
    let text = "time_s,q.a_rad,q.b_rad,theta.b_rad,temperature_c\n0,1,2,3,25\n";
    let mut recording = open_bytes(text.as_bytes(), "a.csv", &OpenOptions::default()).unwrap();
    assert_eq!(recording.joints(), ["a", "b"]);
    assert!(!recording.channels().joints[0].theta && recording.channels().joints[1].theta);
    recording.select(&["b"]).unwrap();
    let frame = recording.next_frame().unwrap().unwrap();
    assert_eq!(
        (frame.q[0], frame.theta[0], frame.temperature_c),
        (2.0, 3.0, 25.0)
    );
}

fn mapped(mapping: &str, text: &str) -> Result<(Vec<Frame>, Health), String> {
    let mapping = Mapping::from_toml(mapping, "map.toml").map_err(|e| e.to_string())?;
    let options = OpenOptions {
        mapping: Some(mapping),
        ..OpenOptions::default()
    };
    let recording =
        open_bytes(text.as_bytes(), "a.csv", &options).map_err(|error| error.to_string())?;
    Ok(read_all(recording))
}

#[test]
fn mapping_converts_units_ratios_signs_counts_sums() {
    let mapping = r#"
        [time]
        column = "t"
        unit = "ms"
        [temperature]
        column = "kelvin"
        unit = "K"
        [joints.z]
        q = { column = "deg", unit = "deg", sign = -1.0, offset = 0.5 }
        theta = { column = "ticks", unit = "count", counts_per_turn = 4096, gear_ratio = 2.0, wrap = false }
        dq = { column = "rpm", unit = "rpm" }
        tau_el = { column = "mnm", unit = "mN·m" }
        tau_m = { column = "ma", unit = "mA", torque_constant_nm_per_a = 0.05, gear_ratio = 100, sign = -1 }
        [joints.a]
        tau_m = { column = "mnm", unit = "mN·m", gear_ratio = 100 }
        q = { sum = [ { column = "deg", unit = "deg" }, { column = "mnm", unit = "Nmm", scale = 0.5 } ] }
    "#;
    let text = "t,deg,ticks,rpm,mnm,kelvin,ma\n1500.25,90,4096,60,250,300,1200\n";
    let (frames, _) = mapped(mapping, text).unwrap();
    let frame = &frames[0];
    let pi = std::f64::consts::PI;
    assert_eq!(frame.time_ns, 1_500_250_000);
    assert!((frame.q[0] - (0.5 - pi / 2.0)).abs() < 1e-15);
    assert!((frame.theta[0] - pi).abs() < 1e-15);
    assert!((frame.dq[0] - 2.0 * pi).abs() < 1e-14);
    assert!((frame.tau_el[0] - 0.25).abs() < 1e-15);
    // 1.2 A · 0.05 N·m/A, a hundred times as strong behind the gear.
    assert!((frame.tau_m[0] + 6.0).abs() < 1e-14);
    assert!((frame.tau_m[1] - 25.0).abs() < 1e-14);
    assert!((frame.q[1] - (pi / 2.0 + 0.125)).abs() < 1e-15);
    assert!((frame.temperature_c - 26.85).abs() < 1e-10);
}

#[test]
fn mapping_sets_period_of_geared_motor_turn() {
    // One motor turn is 0.1 turns of the joint: the encoder wraps at 0.2 pi.
    let mapping = r#"
        [joints.a]
        theta = { column = "turns", unit = "turn", gear_ratio = 10.0, wrap_period = 0.6283185307179586 }
    "#;
    let mut text = String::from("time_s,turns\n");
    for step in 0..50 {
        let turned = 0.13 * f64::from(step);
        text.push_str(&format!("{},{}\n", 0.01 * f64::from(step), turned.fract()));
    }
    let (frames, health) = mapped(mapping, &text).unwrap();
    for (step, frame) in frames.iter().enumerate() {
        let expected = 0.013 * step as f64 * std::f64::consts::TAU;
        assert!((frame.theta[0] - expected).abs() < 1e-12);
    }
    assert_eq!(health.unwrapped[0].count, 6);
}

#[test]
fn mapping_without_matching_column_is_error() {
    let text = "time_s,position\n0,1\n";
    let message = mapped("[joints.a]\nq = { column = \"positoin\" }\n", text).unwrap_err();
    assert!(
        message
            .contains("map.toml, line 2: no column 'positoin' in a.csv; did you mean 'position'?"),
        "{message}"
    );
    let message = mapped("[joints.a]\nq = { unit = \"deg\" }\n", text).unwrap_err();
    assert!(message.contains("'column' is missing"), "{message}");
    let message = mapped("[time]\ncolumn = \"clock\"\n", text).unwrap_err();
    assert!(
        message.contains("no time column 'clock'; columns are"),
        "{message}"
    );
    // Nothing like it.
    let message = mapped("[joints.a]\nq = { column = \"xyz\" }\n", text).unwrap_err();
    assert!(
        message.contains("no column 'xyz' in a.csv; columns are 'time_s'"),
        "{message}"
    );
}

#[test]
fn lines_that_begin_with_a_hash_are_comments_or_the_header() {
    let rows = "0,1,2\n# the robot was touched here\n0.01,1,2\n";
    for head in [
        "# logged on Monday\ntime_s,q.a_rad,theta.a_rad\n",
        "# logged on Monday\n# by hand; 3 V\n\ntime_s,q.a_rad,theta.a_rad\n",
        // As numpy.savetxt writes it.
        "# time_s,q.a_rad,theta.a_rad\n",
        "# logged on Monday\n#time_s,q.a_rad,theta.a_rad\n",
    ] {
        let (frames, health) = read_bytes(format!("{head}{rows}").as_bytes(), "a.csv");
        assert_eq!(frames.len(), 2, "{head}");
        assert_eq!((frames[1].q[0], frames[1].theta[0]), (1.0, 2.0));
        assert!(!health.is_lossy() && health.ragged_rows == 0, "{health:?}");
    }
    let wide: Vec<u8> = "\u{feff}# Montag\ntime_s;q.a_rad\n0,5;1\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    assert_eq!(read_bytes(&wide, "a.csv").0[0].time_ns, 500_000_000);
    // Places are those of the file.
    let error = error_of(
        b"# a\n# b\ntime_s,q.a_rad\n0,1\n0.01,one\n",
        "a.csv",
        &OpenOptions::default(),
    );
    assert!(
        error.contains("a.csv, line 5") && error.contains("'one'"),
        "{error}"
    );
    let error = error_of(b"# nothing\n", "a.csv", &OpenOptions::default());
    assert!(error.contains("no header line"), "{error}");
}

/// Three columns of one joint: time, q and theta, which differ by 6 mrad.
fn rows_of(steps: i64, separator: &str) -> String {
    let row = |k: i64| {
        let q = (0.05 * k as f64).sin();
        let cells = [
            format!("{:.2}", 0.01 * k as f64),
            format!("{q:.6}"),
            format!("{:.6}", q + 0.006),
        ];
        cells.join(separator) + "\n"
    };
    (0..steps).map(row).collect()
}

#[track_caller]
fn is_whole(recording: Result<Recording, LogError>, steps: usize) -> Health {
    let (frames, health) = read_all(recording.expect("opened"));
    assert_eq!(frames.len(), steps);
    let span_ns = frames[steps - 1].time_ns - frames[0].time_ns;
    assert_eq!(span_ns, 10_000_000 * (steps as i64 - 1));
    for frame in &frames {
        assert!((frame.theta[0] - frame.q[0] - 0.006).abs() < 2e-6);
    }
    assert!(
        !health.is_damaged() && health.ragged_rows == 0,
        "{health:?}"
    );
    health
}

fn with_mapping(text: &str, mapping: &str) -> Result<Recording, LogError> {
    let options = OpenOptions {
        mapping: Some(Mapping::from_toml(mapping, "mapping.toml").expect("a mapping")),
        ..OpenOptions::default()
    };
    open_bytes(text.as_bytes(), "a.csv", &options)
}

#[test]
fn heads_of_other_programs_are_skipped() {
    let names = "time_s,q.a_rad,theta.a_rad\n";
    for head in [
        format!("% rec of monday\n% {names}"),
        format!("% rec of monday, second\n%{names}% s,rad,rad\n"),
        format!("// rec of monday\n//\n{names}"),
        format!("; rec of monday\n; \n{names}"),
        format!("robot,head-07\noperator,X\ndate,2024-03-01\n\n{names}"),
        format!("Recording\nrate,100\nmass,1.5,kg\n,,\n{names}"),
        format!("{names}(s),(rad),(rad)\n"),
        format!("{names}[s],[rad],[rad]\n"),
        format!("robot,head-07\n\n{names}\"(sec)\",\"(rad)\",\"\"\n"),
        format!("\u{feff}\r\n# Montag\r\n{}", names.replace('\n', "\r\n")),
    ] {
        let text = head + &rows_of(200, ",");
        is_whole(
            open_bytes(text.as_bytes(), "a.csv", &OpenOptions::default()),
            200,
        );
        let wide: Vec<u8> = format!("\u{feff}{}", text.trim_start_matches('\u{feff}'))
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        is_whole(open_bytes(&wide, "a.csv", &OpenOptions::default()), 200);
        // Places are those of the file.
        let line = 1 + text.matches('\n').count();
        let error = error(&format!("{text}2.0,1,one\n"));
        assert!(error.contains(&format!("log.csv, line {line},")), "{error}");
    }
    // Comments between rows, whatever their mark.
    let rows = rows_of(200, ",").replacen("\n1.00,", "\n% pause, \"here\n// and\n1.00,", 1);
    let options = OpenOptions::default();
    is_whole(
        open_bytes(format!("# a\n{names}{rows}").as_bytes(), "a.csv", &options),
        200,
    );
}

#[test]
fn table_without_header_needs_numbers_of_columns() {
    let text = rows_of(200, ",");
    let message = error(&text);
    for words in ["no header", "line 1", "column = 2", "rate_hz", "column 3"] {
        assert!(message.contains(words), "{words}: {message}");
    }
    let joints = "[joints.a]\nq = { column = 2 }\ntheta = { column = 3 }\n";
    let timed = format!("[time]\ncolumn = 1\nunit = \"s\"\n{joints}");
    is_whole(with_mapping(&text, &timed), 200);
    is_whole(with_mapping(&format!("# of monday\n{text}"), &timed), 200);
    let german = text.replace(',', ";").replace('.', ",");
    is_whole(with_mapping(&german, &timed), 200);
    // Without the times, by their rate.
    let without: String = text
        .lines()
        .map(|row| row[row.find(',').unwrap() + 1..].to_owned() + "\n")
        .collect();
    let by_rate = "[time]\nrate_hz = 100\n[joints.a]\nq = { column = 1 }\ntheta = { column = 2 }\n";
    is_whole(with_mapping(&without, by_rate), 200);
    // Numbers count columns with names too.
    is_whole(with_mapping(&format!("a,b,c\n{text}"), &timed), 200);
    let error = with_mapping(
        &text,
        "[joints.a]\nq = { column = 4 }\n[time]\ncolumn = 1\n",
    )
    .unwrap_err();
    assert!(
        error
            .to_string()
            .contains("no column 4 in a.csv: 3 columns"),
        "{error}"
    );
    for (mapping, words) in [
        (
            "[time]\nrate_hz = 100\ncolumn = 1\n",
            "rate_hz is for a table without times",
        ),
        ("[time]\nrate_hz = 0\n", "above 0"),
        ("[time]\ncolumn = 0\n", "its number from 1"),
        ("[time]\ncolumn = 1.5\n", "its number from 1"),
    ] {
        let error = Mapping::from_toml(mapping, "m.toml")
            .unwrap_err()
            .to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn cells_separated_by_blanks_are_read() {
    let names = "time_s q.a_rad theta.a_rad\n";
    for separator in [" ", "   ", "\t", " \t "] {
        let (rows, named) = (rows_of(200, separator), names.replace(' ', separator));
        for head in [
            named.clone(),
            format!("# rec of monday\n# {named}"),
            format!("% rec of monday\n{}", names.replace(' ', "\t  ")),
            "# time_s, q.a_rad, theta.a_rad\n".to_owned(),
        ] {
            let text = head + &rows;
            let options = OpenOptions::default();
            is_whole(open_bytes(text.as_bytes(), "a.txt", &options), 200);
            // Fixed width: blanks at both ends of a line, and lines of blanks alone.
            let padded = text.replace('\n', "  \r\n  ");
            is_whole(
                open_bytes(padded.trim_start().as_bytes(), "a.txt", &options),
                200,
            );
            let wide: Vec<u8> = format!("\u{feff}{text}")
                .encode_utf16()
                .flat_map(u16::to_le_bytes)
                .collect();
            is_whole(open_bytes(&wide, "a.txt", &options), 200);
            // Places are those of the file.
            let line = 1 + text.matches('\n').count();
            let error = error(&(text + &["2.0", "1", "one\n"].join(separator)));
            assert!(error.contains(&format!("log.csv, line {line},")), "{error}");
            assert!(error.contains("'one'"), "{error}");
        }
    }
    let comments = rows_of(200, " ").replacen("\n1.00 ", "\n % pause here\n# and\n1.00 ", 1);
    let text = format!("{names}{comments}");
    is_whole(
        open_bytes(text.as_bytes(), "a.txt", &OpenOptions::default()),
        200,
    );
    // The last line, cut within a number, is lost.
    let (frames, health) = read(&format!("{names}0 1 2\n1 2 3\n2 3"));
    assert_eq!(frames.len(), 2);
    assert!(health.is_damaged(), "{health:?}");
}

#[test]
fn log_with_index_and_time_stamp_needs_numbers_of_columns() {
    let rows: String = (rows_of(200, " ").lines().enumerate())
        .map(|(index, row)| format!("{index} {row} \n"))
        .collect();
    let message = error(&rows);
    for words in ["no header", "line 1", "column = 2", "column 4"] {
        assert!(message.contains(words), "{words}: {message}");
    }
    let mapping = "[time]\ncolumn = 2\n[joints.a]\nq = { column = 3 }\ntheta = { column = 4 }\n";
    is_whole(with_mapping(&rows, mapping), 200);
    let german = rows.replace('.', ",");
    is_whole(with_mapping(&german, mapping), 200);
}

#[test]
fn clock_times_dates_and_units_of_header_are_read() {
    let rows = |stamp: &dyn Fn(i64) -> String| -> String {
        let row = |k: i64| {
            format!(
                "{};{};{}\n",
                stamp(k),
                0.001 * k as f64,
                0.001 * k as f64 + 0.006
            )
        };
        (0..200).map(row).collect()
    };
    let clock = |k: i64| format!("23:59:{:02}.{:02}", 59 + k / 100, k % 100);
    let across = |k: i64| match k {
        0..100 => clock(k),
        _ => format!("00:00:00,{:02}", k - 100),
    };
    let stamps: [(&str, &dyn Fn(i64) -> String); 6] = [
        ("Zeit", &across),
        ("Time (hh:mm:ss)", &across),
        ("timestamp", &|k| {
            format!("2024-03-01T10:00:{:02}.{:02}Z", k / 100, k % 100)
        }),
        ("Zeit", &|k| {
            format!("01.03.2024 10:00:{:02},{:02}", k / 100, k % 100)
        }),
        ("Time [ms]", &|k| format!("{}", 10 * k)),
        ("time_s", &|k| format!("{},{:02}", 1000 + k / 100, k % 100)),
    ];
    for (name, stamp) in stamps {
        let text = format!("{name};q.a_rad;theta.a_rad\n{}", rows(stamp));
        is_whole(
            open_bytes(text.as_bytes(), "a.csv", &OpenOptions::default()),
            200,
        );
        // By a mapping too, which need not repeat the unit.
        let mapping = format!("[time]\ncolumn = \"{name}\"\n");
        is_whole(with_mapping(&text, &mapping), 200);
    }
    let text = format!(
        "Time;q.a_rad;theta.a_rad\n(ms);(rad);(rad)\n{}",
        rows(&|k| format!("{}", 10 * k))
    );
    is_whole(
        open_bytes(text.as_bytes(), "a.csv", &OpenOptions::default()),
        200,
    );
    // Thousands of seconds with a point, and those without a fraction.
    let grouped = |k: i64| match k % 100 {
        0 => format!("1.00{}", k / 100),
        _ => format!("1.00{},{:02}", k / 100, k % 100),
    };
    let text = format!("time_s;q.a_rad;theta.a_rad\n{}", rows(&grouped));
    is_whole(
        open_bytes(text.as_bytes(), "a.csv", &OpenOptions::default()),
        200,
    );
    let message = error("Zeit;q.a_rad\n10:00:00;1\n10:00;2\n");
    assert!(
        message.contains("'10:00'") && message.contains("line 3"),
        "{message}"
    );
}

#[test]
fn times_in_other_unit_are_reported() {
    let text = "t,q.a_rad,theta.a_rad\n".to_owned()
        + &(0..100)
            .map(|k| format!("{},{k}e-3,{k}e-3\n", 10 * k))
            .collect::<String>();
    let suspected = |mapping: &str| {
        let (_, health) = read_all(with_mapping(&text, mapping).unwrap());
        health.implausible_signals.join("\n")
    };
    let said = suspected("[time]\ncolumn = \"t\"\nunit = \"s\"\n");
    assert!(
        said.contains("unit = \"ms\"") && said.contains("100 Hz"),
        "{said}"
    );
    let said = suspected("[time]\ncolumn = \"t\"\nunit = \"ns\"\n");
    assert!(said.contains("unit = \"ms\""), "{said}");
    let said = suspected("[time]\ncolumn = \"t\"\nunit = \"ms\"\n");
    assert!(!said.contains("unit ="), "{said}");
}

#[test]
fn scope_export_is_a_table_of_its_channels() {
    let block = "Name\thead_07\nFile\tC:\\scope\\head_07.csv\nStarttime of export\t133000000000000000\tFriday, 1 March 2024\t10:00:00.000\n\n\nName\ttilt_joint\tName\ttilt_motor\nSymbolComment\t\tSymbolComment\t\nData-Type\tREAL64\tData-Type\tREAL64\nSampleTime[ms]\t10\tSampleTime[ms]\t10\nUnit\tdeg\tUnit\tdeg\n\n";
    let row = |k: i64, shift: i64| {
        let q = (0.05 * k as f64).sin();
        let (joint, motor) = (q.to_degrees(), 50.0 * (q + 0.006).to_degrees());
        format!("{}\t{joint}\t{}\t{motor}\n", 10 * k, 10 * k + shift)
    };
    let rows = |shift| (0..200).map(|k| row(k, shift)).collect::<String>();
    let mapping = "[joints.tilt]\nq = { column = \"tilt_joint\", unit = \"deg\" }\ntheta = { column = \"tilt_motor\", unit = \"deg\", gear_ratio = 50 }\n";
    is_whole(with_mapping(&format!("{block}{}", rows(0)), mapping), 200);
    let message = error(&format!("{block}{}", rows(0)));
    for words in ["time_ms", "tilt_joint", "tilt_motor"] {
        assert!(message.contains(words), "{message}");
    }
    // Channels at other instants are not taken for one row.
    let mut recording = with_mapping(&format!("{block}{}", rows(2)), mapping).unwrap();
    let message = recording.next_frame().unwrap_err().to_string();
    assert!(
        message.contains("time_ms of tilt_motor") && message.contains("common time column"),
        "{message}"
    );
}

/// A motor at its shaft is not taken to the turn of a joint, nor compared with it; its own turns are counted.
#[test]
fn motor_at_shaft_keeps_turn() {
    use std::f64::consts::{PI, TAU};
    // Four times the joint's position, and 5 rad off.
    let q = |k: i64| 0.01 * k as f64;
    let counting = |k: i64| 4.0 * q(k) + 5.0;
    let wrapping = |k: i64| (counting(k) + PI).rem_euclid(TAU) - PI;
    let encoders: [(&dyn Fn(i64) -> f64, usize); 2] = [(&counting, 0), (&wrapping, 1)];
    for (shown, wraps) in encoders {
        let text = table("time_s,q.a_rad,theta.m_rad", 200, |k| {
            format!("{},{}", q(k), shown(k))
        });
        let reader = Box::new(std::io::Cursor::new(text.into_bytes()));
        let mut recording =
            sinew_log::Recording::from_reader(reader, "a.csv", &OpenOptions::default()).unwrap();
        let axis = Axis {
            motor: Some("m"),
            ..Axis::of_joint("a")
        };
        recording.select_axes(&[axis]).unwrap();
        for k in 0..200 {
            let theta = recording.next_frame().unwrap().unwrap().theta[0];
            let expected = shown(0) + 4.0 * q(k);
            assert!((theta - expected).abs() < 1e-9, "{k}: {theta} {expected}");
        }
        assert!(recording.next_frame().unwrap().is_none());
        let health = recording.health();
        assert_eq!(health.implausible_signals, [""; 0]);
        assert_eq!(health.unwrapped.len(), wraps, "{:?}", health.unwrapped);
        assert!(health.unwrapped.iter().all(|count| count.joint == "m"));
    }
}
