//! Content of a recording as text.

use crate::format::counted;
use crate::text::{TerminalText, plain, yes_no};
use crate::warnings::stream_name;
use sinew_figure::{Columns, rounded};
use sinew_log::{
    Ambiguity, Format, Health, Quantity, RecordingInfo, StreamTiming, TopicInfo, TopicUse,
};

/// Name of a file format.
pub(crate) fn format_name(format: Format) -> &'static str {
    match format {
        Format::Mcap => "MCAP",
        Format::Csv => "CSV",
        Format::Parquet => "Parquet",
        Format::Db3 => "SQLite",
        Format::Numpy => "NumPy",
        Format::Arrays => "arrays",
        Format::Messages => "messages",
    }
}

/// Tabulates all topics with type, number of messages, rate and role.
fn topics(out: &mut TerminalText, info: &RecordingInfo) {
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
            .column("rate\n(Hz)", |t| rounded(t.rate_hz.unwrap_or(f64::NAN), 4))
            .lines("role", |t| role(info, t))
            .table(),
    );
    for topic in topics.iter().filter(|topic| !topic.interfaces.is_empty()) {
        let interfaces = topic.interfaces.join(", ");
        out.paragraph(format!("interfaces of {}: {interfaces}", topic.name));
    }
}

/// Formats the role and the quantities of a topic, or its possible roles.
fn role(info: &RecordingInfo, topic: &TopicInfo) -> String {
    let side = match topic.role {
        Some(TopicUse::JointSide) => "joint side",
        Some(TopicUse::MotorSide) => "motor side",
        Some(TopicUse::ExternalTorque) => "external torque",
        Some(TopicUse::Tension) => "tensions",
        Some(TopicUse::RobotDescription) => return "URDF".into(),
        None => {
            let ambiguous = info.ambiguous.iter();
            let sides = ambiguous.filter(|a| a.candidates.contains(&topic.name));
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

/// Lists ambiguous topics with the options that select one.
fn choices(info: &RecordingInfo) -> Vec<String> {
    let choice = |open: &Ambiguity| {
        let (side, key, option) = open.words();
        let options: Vec<String> = (open.candidates.iter())
            .map(|topic| format!("{option} {topic}"))
            .collect();
        let options = options.join(" or ");
        format!("several topics match the {side}: specify {options}, or {key} in a mapping file")
    };
    info.ambiguous.iter().map(choice).collect()
}

/// Renders rate, channels, topics and data losses as text of at most 80 columns.
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
    let mut out = TerminalText::default();
    out.paragraph(format!(
        "{file}: {format}, {frames} frames, {length} s at {rate} Hz (sample period {shortest} to {longest} ms), {segments}"
    ));
    for text in health_messages(&info.health) {
        out.paragraph(text);
    }
    let mut channels = Columns::of(&info.joints).words("joint", |joint| &joint.name);
    for q in Quantity::PER_JOINT {
        let has = |has: bool| if has { "yes" } else { "–" };
        channels = channels.column(q.symbol(), |joint| has(joint.channels.contains(&q)));
    }
    if !info.joints.is_empty() {
        out.table(channels.table());
    }
    if !info.tendons.is_empty() {
        let tendons = info.tendons.join(", ");
        out.paragraph(format!("tension recorded: {tendons}"));
    }
    topics(&mut out, info);
    for choice in choices(info) {
        out.paragraph(choice);
    }
    for source in &info.sources {
        out.paragraph(format!(
            "{} from {}",
            source.quantity.symbol(),
            source.source
        ));
    }
    if !info.unused_columns.is_empty() {
        out.paragraph(format!(
            "unused columns: {}",
            info.unused_columns.join(", ")
        ));
    }
    let description = yes_no(info.robot_description);
    out.paragraph(match info.ambiguous.is_empty() {
        true => {
            let temperature = yes_no(info.temperature);
            format!("temperature: {temperature}; robot_description: {description}")
        }
        false => format!("robot_description: {description}"),
    });
    for stream in &info.health.streams {
        out.paragraph(timing(stream));
    }
    coverage(&mut out, &info.health);
    out.0
}

/// Tabulates the share of frames, the longest interval, the repeated values and the wrap-arounds of each position.
fn coverage(out: &mut TerminalText, health: &Health) {
    if health.signals.is_empty() {
        return;
    }
    out.add("\n");
    out.table(
        Columns::of(&health.signals)
            .words("position", |s| {
                format!("{} of {}", s.quantity.symbol(), s.joint)
            })
            .column("frames\n(%)", |s| rounded(100.0 * s.share, 4))
            .column("longest\ninterval (s)", |s| {
                rounded(s.longest_interval_s, 3)
            })
            .column("repeated\nvalues (%)", |s| {
                rounded(100.0 * s.repeated_share, 2)
            })
            .column("wrap-arounds\ncorrected", |s| s.unwrapped)
            .table(),
    );
}

/// Formats the sample period of a stream, its jitter and its missing samples.
fn timing(stream: &StreamTiming) -> String {
    let name = stream_name(stream.role);
    let (Some(step_s), Some(jitter_s)) = (stream.step_s, stream.jitter_s) else {
        return format!(
            "{name}: {} samples, too few to estimate a rate",
            stream.samples
        );
    };
    let missing = match stream.missing {
        None => "period too irregular to count missing samples".into(),
        Some(0) => "none missing".into(),
        Some(n) => format!("{n} missing"),
    };
    format!(
        "{name}: sample period {} ms, jitter {} ms (standard deviation), {missing}",
        rounded(1e3 * step_s, 3),
        rounded(1e3 * jitter_s, 2)
    )
}

/// Lists lost, repaired and implausible data, one sentence each.
fn health_messages(health: &Health) -> Vec<String> {
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
        (health.late, "messages discarded: too late to be reordered"),
        (
            health.duplicates,
            "messages discarded: duplicate time stamp",
        ),
        (health.undecodable, "messages discarded: not decodable"),
        (health.rows_without_time, "rows discarded: no time stamp"),
        (health.out_of_order, "messages reordered by time stamp"),
        (
            health.unstamped,
            "messages without a time stamp: timed by the recorder's clock",
        ),
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
    if health.clock_steps > 0 {
        let steps = counted(health.clock_steps, "step");
        all.push(format!("{steps} of the clock; time continued over each"));
    }
    all.extend(health.second_publishers.iter().map(|second| {
        let (name, samples) = (
            stream_name(second.stream),
            counted(second.samples, "sample"),
        );
        format!("{name}: {samples} of a second publisher excluded")
    }));
    for stream in health.streams.iter().filter(|s| s.lost_share() > 0.0) {
        let (name, share) = (stream_name(stream.role), 100.0 * stream.lost_share());
        all.push(format!("{name}: {share:.1} % of the samples lost"));
    }
    if health.gaps > 0 {
        let (gaps, longest) = (health.gaps, rounded(health.longest_gap_s, 3));
        all.push(format!("{gaps} gaps, longest {longest} s"));
    }
    for late in &health.late_starts {
        let (symbol, joint) = (late.quantity.symbol(), &late.joint);
        all.push(format!(
            "{symbol} of '{joint}' from {:.1} s on",
            late.after_s
        ));
    }
    for s in &health.non_finite {
        let (count, symbol, joint) = (s.count, s.quantity.symbol(), &s.joint);
        all.push(format!(
            "{count} samples of {symbol} of '{joint}' are NaN or infinite"
        ));
    }
    for s in &health.unwrapped {
        let (count, symbol, joint) = (s.count, s.quantity.symbol(), &s.joint);
        all.push(format!(
            "{count} encoder wrap-arounds of {symbol} of '{joint}' corrected"
        ));
    }
    all.extend(
        health
            .implausible_signals
            .iter()
            .map(|s| format!("warning: {s}")),
    );
    if all.is_empty() {
        all.push("no data lost, no implausible signals".into());
    }
    all
}
