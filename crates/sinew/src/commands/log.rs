//! `sinew log`: what a recording holds.

use crate::args::Opening;
use crate::terminal::{Bar, Failure, Finish, answer};
use crate::text::{paragraph, plain, table};
use clap::{Args, Subcommand};
use sinew_figure::rounded;
use sinew_log::{Format, Health, Quantity, Recording};
use std::path::PathBuf;

/// Look into a recording
#[derive(Debug, Subcommand)]
pub(crate) enum Log {
    Info(Info),
}

impl Log {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::Info(info) => info.run(),
        }
    }
}

/// Read a recording to its end and say what it holds: joints, channels, rate, gaps, damage
///
/// Exit code 3 when data was lost.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew log info monday.mcap")]
pub(crate) struct Info {
    /// Recording: MCAP, CSV or Parquet
    file: PathBuf,
    #[command(flatten)]
    opening: Opening,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
    /// No progress on stderr
    #[arg(long)]
    quiet: bool,
}

/// Time stamps of a recording, counted while reading.
#[derive(Debug, Default)]
struct Pace {
    frames: u64,
    first_ns: Option<i64>,
    last: Option<(i64, u32)>,
    steps: u64,
    within_ns: i64,
    shortest_ns: Option<i64>,
    longest_ns: Option<i64>,
}

impl Pace {
    fn frame(&mut self, time_ns: i64, segment: u32) {
        self.frames += 1;
        self.first_ns.get_or_insert(time_ns);
        if let Some((last_ns, last_segment)) = self.last
            && last_segment == segment
        {
            let step = time_ns.saturating_sub(last_ns);
            self.steps += 1;
            self.within_ns = self.within_ns.saturating_add(step);
            self.shortest_ns = Some(self.shortest_ns.map_or(step, |s| s.min(step)));
            self.longest_ns = Some(self.longest_ns.map_or(step, |s| s.max(step)));
        }
        self.last = Some((time_ns, segment));
    }

    fn duration_s(&self) -> f64 {
        match (self.first_ns, self.last) {
            (Some(first), Some((last, _))) => 1e-9 * last.saturating_sub(first) as f64,
            _ => f64::NAN,
        }
    }

    fn rate_hz(&self) -> f64 {
        self.steps as f64 / (1e-9 * self.within_ns as f64)
    }

    fn segments(&self) -> u32 {
        self.last.map_or(0, |(_, segment)| segment + 1)
    }
}

impl Info {
    fn run(&self) -> Result<Finish, Failure> {
        let mut recording = sinew_log::open(&self.file, &self.opening.options()?)?;
        let mut pace = Pace::default();
        let bar = Bar::new("reading", self.quiet);
        while let Some(frame) = recording.next_frame()? {
            let (time_ns, segment) = (frame.time_ns, frame.segment);
            pace.frame(time_ns, segment);
            if pace.frames.is_multiple_of(8192) {
                let at = recording.progress();
                bar.set(at.bytes_done as f64, at.bytes_total as f64);
            }
        }
        drop(bar);
        let name = self.file.display().to_string();
        if self.json {
            let value = json(&name, &recording, &pace);
            answer(&(serde_json::to_string_pretty(&value)? + "\n"))?;
        } else {
            answer(&told(&name, &recording, &pace))?;
        }
        Ok(Finish::lossy(recording.health().is_lossy()))
    }
}

fn format_name(recording: &Recording) -> &'static str {
    match recording.format() {
        Format::Mcap => "MCAP",
        Format::Csv => "CSV",
        Format::Parquet => "Parquet",
    }
}

fn told(name: &str, recording: &Recording, pace: &Pace) -> String {
    let mut out = paragraph(
        &plain(&format!(
            "{name}: {}, {} frames, {} s at {} Hz (steps of {} to {} ms), {} without a gap",
            format_name(recording),
            pace.frames,
            rounded(pace.duration_s(), 5),
            rounded(pace.rate_hz(), 4),
            rounded(pace.shortest_ns.map_or(f64::NAN, |ns| 1e-6 * ns as f64), 3),
            rounded(pace.longest_ns.map_or(f64::NAN, |ns| 1e-6 * ns as f64), 3),
            match pace.segments() {
                1 => "1 stretch".to_string(),
                n => format!("{n} stretches"),
            }
        )),
        2,
    );
    let channels = recording.channels();
    let mut head = vec!["joint"];
    head.extend(Quantity::PER_JOINT.map(Quantity::symbol));
    let rows = recording
        .joints()
        .iter()
        .zip(&channels.joints)
        .map(|(joint, has)| {
            let mut row = vec![plain(joint)];
            row.extend(Quantity::PER_JOINT.map(|q| if has.has(q) { "yes" } else { "–" }.into()));
            row
        })
        .collect();
    out.push_str(&table(&head, rows, 1));
    let mut line = |text: String| out.push_str(&paragraph(&plain(&text), 2));
    let yes = |b: bool| if b { "yes" } else { "no" };
    line(format!(
        "temperature: {}; robot_description: {}",
        yes(channels.temperature),
        yes(recording.robot_description().is_some())
    ));
    for text in troubles(recording.health()) {
        line(text);
    }
    out
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

fn json(name: &str, recording: &Recording, pace: &Pace) -> serde_json::Value {
    let health = recording.health();
    let joints: Vec<serde_json::Value> = recording
        .joints()
        .iter()
        .zip(&recording.channels().joints)
        .map(|(joint, has)| {
            let channels: Vec<&str> = has.iter().map(Quantity::symbol).collect();
            serde_json::json!({ "name": joint, "channels": channels })
        })
        .collect();
    serde_json::json!({
        "file": name,
        "format": format_name(recording),
        "frames": pace.frames,
        "start_time_ns": pace.first_ns,
        "duration_s": pace.duration_s(),
        "mean_rate_hz": pace.rate_hz(),
        "shortest_step_s": pace.shortest_ns.map(|ns| 1e-9 * ns as f64),
        "longest_step_s": pace.longest_ns.map(|ns| 1e-9 * ns as f64),
        "segments": pace.segments(),
        "joints": joints,
        "temperature": recording.channels().temperature,
        "robot_description": recording.robot_description().is_some(),
        "bytes_lost": health.bytes_lost,
        "gaps": health.gaps,
        "longest_gap_s": health.longest_gap_s,
        "lossy": health.is_lossy(),
        "health": troubles(health),
    })
}
