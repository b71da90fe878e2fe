//! What a recording holds, as text.

use crate::text::{Told, plain, yes_no};
use crate::warnings::stream_name;
use sinew_figure::{Columns, rounded};
use sinew_log::{
    Ambiguity, Format, Health, Quantity, RecordingInfo, StreamTiming, TopicInfo, TopicUse,
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
fn topics(out: &mut Told, info: &RecordingInfo) {
    let topics = &info.topics;
    if topics.is_empty() {
        return;
    }
    out.add("\n");
    out.table(
        Columns::of(topics)
            .lines("topic and type", |t| {
                format!("{}\n{}", plain(&t.name), plain(&t.kind))
            })
            .left()
            .column("messages", |t| t.messages)
            .column("Hz", |t| rounded(t.rate_hz.unwrap_or(f64::NAN), 4))
            .lines("taken for", |t| taken_for(info, t))
            .table(),
    );
    for topic in topics.iter().filter(|topic| !topic.interfaces.is_empty()) {
        let interfaces = topic.interfaces.join(", ");
        out.say(format!("interfaces of {}: {interfaces}", topic.name));
    }
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
    let number = |value: Option<f64>, digits| rounded(value.unwrap_or(f64::NAN), digits);
    let (file, format, frames) = (&info.file, format_name(info.format), info.frames);
    let (length, rate) = (number(info.duration_s, 5), number(info.mean_rate_hz, 4));
    let [shortest, longest] = [ms(info.shortest_step_s), ms(info.longest_step_s)];
    let segments = match info.segments {
        1 => "1 segment".to_string(),
        n => format!("{n} segments"),
    };
    let mut out = Told::default();
    out.say(format!(
        "{file}: {format}, {frames} frames, {length} s at {rate} Hz (steps of {shortest} to {longest} ms), in {segments}"
    ));
    let mut channels = Columns::of(&info.joints).words("joint", |joint| &joint.name);
    for q in Quantity::PER_JOINT {
        let has = |has: bool| if has { "yes" } else { "–" };
        channels = channels.column(q.symbol(), |joint| has(joint.channels.contains(&q)));
    }
    if !info.joints.is_empty() {
        out.table(channels.table());
    }
    topics(&mut out, info);
    for choice in choices(info) {
        out.say(choice);
    }
    for source in &info.sources {
        out.say(format!(
            "{} from {}",
            source.quantity.symbol(),
            source.source
        ));
    }
    if !info.unused_columns.is_empty() {
        out.say(format!(
            "columns not used: {}",
            info.unused_columns.join(", ")
        ));
    }
    let description = yes_no(info.robot_description);
    out.say(match info.ambiguous.is_empty() {
        true => {
            let temperature = yes_no(info.temperature);
            format!("temperature: {temperature}; robot_description: {description}")
        }
        false => format!("robot_description: {description}"),
    });
    for stream in &info.health.streams {
        out.say(timing(stream));
    }
    for text in troubles(&info.health) {
        out.say(text);
    }
    out.0
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
    let damage = health.damage.iter();
    let mut all: Vec<String> = damage
        .map(|d| {
            format!(
                "damaged at byte {}: {} ({} bytes lost)",
                d.offset, d.reason, d.bytes
            )
        })
        .collect();
    let counts = [
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
    ];
    let counts = counts.into_iter().filter(|(count, _)| *count > 0);
    all.extend(counts.map(|(count, what)| format!("{count} {what}")));
    for stream in health.streams.iter().filter(|s| s.lost_share() > 0.0) {
        let (name, share) = (stream_name(stream.role), 100.0 * stream.lost_share());
        all.push(format!("{name}: {share:.1} % of the samples lost"));
    }
    if health.gaps > 0 {
        let (gaps, longest) = (health.gaps, rounded(health.longest_gap_s, 3));
        all.push(format!("{gaps} gaps, the longest {longest} s"));
    }
    for s in &health.non_finite {
        let (count, symbol, joint) = (s.count, s.quantity.symbol(), &s.joint);
        all.push(format!(
            "{count} samples of {symbol} of '{joint}' are NaN or infinite"
        ));
    }
    for s in &health.unwrapped {
        let (count, symbol, joint) = (s.count, s.quantity.symbol(), &s.joint);
        all.push(format!("{count} turns of {symbol} of '{joint}' unwrapped"));
    }
    all.extend(health.suspicions.iter().map(|s| format!("warning: {s}")));
    if all.is_empty() {
        all.push("nothing lost, nothing odd".into());
    }
    all
}
