//! What a recording holds, as text.

use crate::text::{paragraph, plain, table};
use crate::warnings::stream_name;
use sinew_figure::rounded;
use sinew_log::{
    Ambiguity, Format, Health, Quantity, RecordingInfo, SignalSource, StreamTiming, TopicInfo,
    TopicUse,
};

/// A format as people call it.
pub(crate) fn format_name(format: Format) -> &'static str {
    match format {
        Format::Mcap => "MCAP",
        Format::Csv => "CSV",
        Format::Parquet => "Parquet",
        Format::Db3 => "SQLite",
        Format::Arrays => "arrays",
        Format::Messages => "messages",
    }
}

/// Every topic with its type, count, rate, and what it is taken for.
fn topics(info: &RecordingInfo) -> String {
    let topics = &info.topics;
    if topics.is_empty() {
        return String::new();
    }
    let rows = topics.iter().map(|topic| {
        vec![
            format!("{}\n{}", plain(&topic.name), plain(&topic.kind)),
            topic.messages.to_string(),
            rounded(topic.rate_hz.unwrap_or(f64::NAN), 4),
            taken_for(info, topic),
        ]
    });
    let head = ["topic and type", "messages", "Hz", "taken for"];
    let mut out = String::from("\n") + &table(&head, rows.collect(), 1);
    for topic in topics.iter().filter(|topic| !topic.interfaces.is_empty()) {
        let interfaces = topic.interfaces.join(", ");
        out += &paragraph(
            &plain(&format!("interfaces of {}: {interfaces}", topic.name)),
            2,
        );
    }
    out
}

/// What a topic is taken for and which quantities it gives, or what it could be.
fn taken_for(info: &RecordingInfo, topic: &TopicInfo) -> String {
    let side = match topic.taken_for {
        Some(TopicUse::JointSide) => "joint side",
        Some(TopicUse::MotorSide) => "motor side",
        Some(TopicUse::ExternalTorque) => "external torque",
        Some(TopicUse::RobotDescription) => return "URDF".into(),
        None => {
            let open = info.ambiguous.iter();
            let sides = open.filter(|a| a.candidates.contains(&topic.name));
            let sides: Vec<&str> = sides.map(|a| a.words().0).collect();
            return match sides[..] {
                [] => "not used".into(),
                _ => format!("could be {}", sides.join(" or ")),
            };
        }
    };
    let own = info.sources.iter();
    let own = own.filter(|source| source.topic.as_ref() == Some(&topic.name));
    let own: Vec<&str> = own.map(|source| source.quantity.symbol()).collect();
    format!("{side}\n{}", own.join(", "))
}

/// What must be chosen, and how.
fn choices(info: &RecordingInfo) -> Vec<String> {
    let choice = |open: &Ambiguity| {
        let (side, key, option) = open.words();
        let options: Vec<String> = (open.candidates.iter())
            .map(|topic| format!("{option} {topic}"))
            .collect();
        let options = options.join(" or ");
        format!("several topics could be the {side}: say {options}, or {key} in a mapping file")
    };
    info.ambiguous.iter().map(choice).collect()
}

/// Rate, channels and what was lost, at most 80 columns wide.
pub fn render(info: &RecordingInfo) -> String {
    let ms = |step_s: Option<f64>| rounded(1e3 * step_s.unwrap_or(f64::NAN), 3);
    let mut out = paragraph(
        &plain(&format!(
            "{}: {}, {} frames, {} s at {} Hz (steps of {} to {} ms), in {}",
            info.file,
            format_name(info.format),
            info.frames,
            rounded(info.duration_s.unwrap_or(f64::NAN), 5),
            rounded(info.mean_rate_hz.unwrap_or(f64::NAN), 4),
            ms(info.shortest_step_s),
            ms(info.longest_step_s),
            match info.segments {
                1 => "1 segment".to_string(),
                n => format!("{n} segments"),
            }
        )),
        2,
    );
    let mut head = vec!["joint"];
    head.extend(Quantity::PER_JOINT.map(Quantity::symbol));
    let rows = info.joints.iter().map(|joint| {
        let mut row = vec![plain(&joint.name)];
        let has = |q| {
            if joint.channels.contains(&q) {
                "yes"
            } else {
                "–"
            }
        };
        row.extend(Quantity::PER_JOINT.map(|q| has(q).into()));
        row
    });
    if !info.joints.is_empty() {
        out.push_str(&table(&head, rows.collect(), 1));
    }
    out.push_str(&topics(info));
    let mut line = |text: String| out.push_str(&paragraph(&plain(&text), 2));
    for choice in choices(info) {
        line(choice);
    }
    for SignalSource {
        quantity, source, ..
    } in &info.sources
    {
        line(format!("{} from {source}", quantity.symbol()));
    }
    if !info.unused_columns.is_empty() {
        line(format!(
            "columns not used: {}",
            info.unused_columns.join(", ")
        ));
    }
    let yes = |b: bool| if b { "yes" } else { "no" };
    let description = yes(info.robot_description);
    line(match info.ambiguous.is_empty() {
        true => {
            let temperature = yes(info.temperature);
            format!("temperature: {temperature}; robot_description: {description}")
        }
        false => format!("robot_description: {description}"),
    });
    for stream in &info.health.streams {
        line(timing(stream));
    }
    for text in troubles(&info.health) {
        line(text);
    }
    out
}

/// When a stream's samples came.
fn timing(stream: &StreamTiming) -> String {
    let name = stream_name(stream.role);
    let (Some(step_s), Some(jitter_s)) = (stream.step_s, stream.jitter_s) else {
        return format!("{name}: {} samples, too few for a rate", stream.samples);
    };
    let missing = match stream.missing {
        None => "too uneven to tell whether any is missing".into(),
        Some(0) => "none missing".into(),
        Some(n) => format!("{n} missing"),
    };
    format!(
        "{name}: a sample every {} ms ± {} (one standard deviation), {missing}",
        rounded(1e3 * step_s, 3),
        rounded(1e3 * jitter_s, 2)
    )
}

/// What was lost, repaired or suspicious, one sentence each.
fn troubles(health: &Health) -> Vec<String> {
    let mut all = Vec::new();
    for damage in &health.damage {
        all.push(format!(
            "damaged at byte {}: {} ({} bytes lost)",
            damage.offset, damage.reason, damage.bytes
        ));
    }
    for (count, what) in [
        (health.late, "messages dropped: too late to be sorted in"),
        (
            health.duplicates,
            "messages dropped: time stamp seen before",
        ),
        (health.undecodable, "messages dropped: not decodable"),
        (health.rows_without_time, "rows dropped: without a time"),
        (health.out_of_order, "messages out of order, sorted in"),
        (health.clock_jumps, "times the clock went back"),
        (
            health.short_messages,
            "messages with fewer values than names",
        ),
        (
            health.ragged_rows,
            "rows with more or fewer cells than the header",
        ),
        (
            health.frames_without_motor_side,
            "frames without motor positions",
        ),
        (
            health.frames_without_joint_side,
            "frames without joint positions",
        ),
    ] {
        if count > 0 {
            all.push(format!("{count} {what}"));
        }
    }
    for stream in health.streams.iter().filter(|s| s.lost_share() > 0.0) {
        let (name, share) = (stream_name(stream.role), 100.0 * stream.lost_share());
        all.push(format!("{name}: {share:.1} % of the samples lost"));
    }
    if health.gaps > 0 {
        all.push(format!(
            "{} gaps, the longest {} s",
            health.gaps,
            rounded(health.longest_gap_s, 3)
        ));
    }
    for signal in &health.non_finite {
        all.push(format!(
            "{} samples of {} of '{}' are NaN or infinite",
            signal.count,
            signal.quantity.symbol(),
            signal.joint
        ));
    }
    for signal in &health.unwrapped {
        all.push(format!(
            "{} turns of {} of '{}' unwrapped",
            signal.count,
            signal.quantity.symbol(),
            signal.joint
        ));
    }
    all.extend(health.suspicions.iter().map(|s| format!("warning: {s}")));
    if all.is_empty() {
        all.push("nothing lost, nothing odd".into());
    }
    all
}
