//! Receives from a transport for a while and prints the events line by line. `scripts/transports` parses the output.
//!
//! ```text
//! listen zenoh:tcp/127.0.0.1:7447 SECONDS JOINT…
//! listen dds:0 SECONDS JOINT… [--namespace /arm7] [--publish] [--quiet] [--merely]
//! listen mcap:FOLDER_OR_FILE SECONDS JOINT…
//! listen discover:dds:0 SECONDS
//! listen discover:zenoh:tcp/127.0.0.1:7447 SECONDS
//! listen transports
//! ```

use sinew_log::encode::{
    DiagnosticArray, DiagnosticStatus, DynamicJointState, Header, InterfaceValue, KeyValue, Level,
};
use sinew_log::live::LiveOptions;
use sinew_transport::dds::{self, DdsOptions};
use sinew_transport::tail::{self, From, TailOptions};
use sinew_transport::{
    Batch, BatchContent, Clock, FrameAssembler, Inbox, Outgoing, PublishError, Publisher,
    Publishing, QueueLimits, Route, Routes, Transport,
};
use std::error::Error;
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut take = |flag: &str, values: usize| {
        let at = arguments.iter().position(|a| a == flag)?;
        let taken: Vec<String> = arguments.drain(at..=at + values).collect();
        taken.last().cloned()
    };
    let publishes = take("--publish", 0).is_some();
    let is_quiet = take("--quiet", 0).is_some();
    let merely_receives = take("--merely", 0).is_some();
    let namespace = take("--namespace", 1).unwrap_or_default();
    if arguments == ["transports"] {
        println!(
            "dds mcap{}",
            if cfg!(feature = "zenoh") {
                " zenoh"
            } else {
                ""
            }
        );
        return Ok(());
    }
    let [transport, seconds, joints @ ..] = arguments.as_slice() else {
        return Err("listen TRANSPORT SECONDS JOINT…".into());
    };
    let length = Duration::try_from_secs_f64(seconds.parse()?)?;
    let clock = Clock::start();
    if let Some(network) = transport.strip_prefix("discover:") {
        let found = match network.split_once(':') {
            Some(("dds", domain)) => dds::discover(&dds_options(domain, false)?, clock, length)?,
            #[cfg(feature = "zenoh")]
            Some(("zenoh", router)) => {
                sinew_transport::zenoh::discover(&zenoh_options(router, false), clock, length)?
            }
            _ => return Err(format!("{network}: dds:DOMAIN").into()),
        };
        println!("{}", serde_json::to_string_pretty(&found)?);
        return Ok(());
    }

    let live = LiveOptions {
        namespace: namespace.clone(),
        ..LiveOptions::of_joints(joints)
    };
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let routes = Routes::new(vec![Route::new(sender, &live)]);
    let (transport, mut publisher) = open(transport, publishes, &routes, clock)?;
    let mut intake = FrameAssembler::new(&live)?;
    let mut batch = Batch::default();
    let begun = Instant::now();
    let since = |begun: Instant| begun.elapsed().as_secs_f64();
    let (mut frames, mut dropped, mut descriptions, mut next_s) = (0_u64, 0_u64, 0, 1.0);
    let (mut last, mut whole, mut segment) = (f64::NAN, 0_u64, 0);
    while begun.elapsed() < length {
        if inbox.wait(Duration::from_millis(50)).is_some() {
            inbox.take(robot, &mut batch);
            if merely_receives {
                continue;
            }
            intake.feed(&batch, |taken| match taken {
                BatchContent::Frame { frame, .. } => {
                    frames += 1;
                    let is_whole = frame.q.iter().chain(&frame.theta).all(|v| v.is_finite());
                    whole += u64::from(is_whole);
                    (last, segment) = (frame.q[0], frame.segment);
                }
                BatchContent::Fault { fault, .. } => println!("{:.2} {fault}", since(begun)),
                BatchContent::Dropped { messages } => dropped += messages,
            });
            if intake.live().descriptions() > descriptions {
                descriptions = intake.live().descriptions();
                let bytes = intake.live().robot_description().map_or(0, str::len);
                println!("{:.2} description {bytes} bytes", since(begun));
            }
        }
        if since(begun) >= next_s {
            next_s += 1.0;
            let messages = transport.status().messages;
            if !is_quiet {
                println!(
                    "{:.2} messages {messages} frames {frames} whole {whole} segment {segment} dropped {dropped} q {last:.6}",
                    since(begun)
                );
            }
            if publishes {
                publish_once(
                    publisher.as_mut(),
                    &namespace,
                    joints,
                    clock.now().utc_ns,
                    frames,
                )?;
            }
        }
    }
    let health = intake.live().health();
    let streams = health.streams.iter();
    let missing: Vec<_> = streams.map(|s| (s.role, s.samples, s.missing)).collect();
    println!(
        "end messages {} frames {frames} whole {whole} segment {segment} dropped {dropped} late {} undecodable {} streams {missing:?} rss_kb {} cpu_s {:.2}",
        transport.status().messages,
        health.late,
        health.undecodable,
        status_kb("VmRSS:"),
        cpu_s(),
    );
    Ok(())
}

fn open(
    transport: &str,
    publishes: bool,
    routes: &Routes,
    clock: Clock,
) -> Result<(Transport, Box<dyn Publisher>), Box<dyn Error>> {
    Ok(match transport.split_once(':') {
        Some(("dds", domain)) => dds::open(&dds_options(domain, publishes)?, routes, clock)?,
        #[cfg(feature = "zenoh")]
        Some(("zenoh", router)) => {
            sinew_transport::zenoh::open(&zenoh_options(router, publishes), routes, clock)?
        }
        Some(("mcap", path)) => {
            let options = TailOptions {
                from: From::Start,
                ..TailOptions::of(path.into())
            };
            (
                tail::open(&options, routes, clock)?,
                Box::new(NullPublisher),
            )
        }
        _ => return Err(format!("{transport}: dds:DOMAIN or mcap:PATH").into()),
    })
}

/// Publisher of a recording: publishes nothing.
struct NullPublisher;

impl Publisher for NullPublisher {
    fn publish(&mut self, _: &Outgoing<'_>) -> Result<(), PublishError> {
        Ok(())
    }
}

fn dds_options(domain: &str, publishes: bool) -> Result<DdsOptions, Box<dyn Error>> {
    Ok(DdsOptions {
        domain: domain.parse()?,
        publishing: publishing(publishes),
        ..DdsOptions::default()
    })
}

#[cfg(feature = "zenoh")]
fn zenoh_options(router: &str, publishes: bool) -> sinew_transport::zenoh::ZenohOptions {
    sinew_transport::zenoh::ZenohOptions {
        connect: vec![router.to_owned()],
        publishing: publishing(publishes),
        ..Default::default()
    }
}

fn publishing(publishes: bool) -> Publishing {
    match publishes {
        true => Publishing::default(),
        false => Publishing::DISABLED,
    }
}

/// Publishes both kinds of messages once.
fn publish_once(
    publisher: &mut dyn Publisher,
    namespace: &str,
    joints: &[String],
    utc_ns: i64,
    frames: u64,
) -> Result<(), Box<dyn Error>> {
    let header = Header::at(utc_ns, "").ok_or("after 2038")?;
    let status = joints.iter().map(|joint| DiagnosticStatus {
        level: Level::Ok,
        name: format!("sinew: robot/{joint}"),
        message: "taut".to_owned(),
        hardware_id: "robot".to_owned(),
        values: vec![KeyValue {
            key: "frames".to_owned(),
            value: frames.to_string(),
        }],
    });
    let status: Vec<DiagnosticStatus> = status.collect();
    let array = DiagnosticArray {
        header,
        status: &status,
    };
    publisher.publish(&Outgoing::Diagnostics(array))?;
    let values = vec![
        InterfaceValue {
            interface_names: &["offset", "offset_std"],
            values: &[0.0127, 0.0031],
        };
        joints.len()
    ];
    let state = DynamicJointState {
        header,
        joint_names: joints,
        interface_values: &values,
    };
    publisher.publish(&Outgoing::Tendons { namespace, state })?;
    Ok(())
}

/// Value of a line of `/proc/self/status`, kB.
fn status_kb(key: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(key));
    let number = line.and_then(|line| line.split_whitespace().next());
    number.and_then(|n| n.parse().ok()).unwrap_or(0)
}

/// CPU time of all threads so far, s.
fn cpu_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit_once(')').map_or("", |(_, after)| after);
    let ticks = after.split_whitespace().skip(11).take(2);
    // A tick is 10 ms on Linux.
    ticks.filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() / 100.0
}
