//! `/metrics` for Prometheus, in base units.

use super::App;
use crate::runtime::{Board, Health, Seen};
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse as _, Response};
use sinew_model::Gaussian;
use sinew_trend::Limit;
use sinew_watch_core::RobotSnapshot;
use sinew_watch_core::alarm::AlarmState;
use sinew_watch_core::snapshot::{Freshness, LimitNow};
use std::fmt::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};

/// A metric: its name, kind and what it is.
type About = (&'static str, &'static str, &'static str);

/// All metrics, in their order; the reference is made of this.
pub const ABOUT: [About; 38] = [
    (
        "sinew_build_info",
        "gauge",
        "Always 1; the version of the program.",
    ),
    (
        "sinew_uptime_seconds",
        "gauge",
        "Time since the monitor began.",
    ),
    (
        "sinew_core_silent_seconds",
        "gauge",
        "Time since the slowest core thread went round.",
    ),
    (
        "sinew_store_works",
        "gauge",
        "1: the last try to store succeeded; 0: it failed.",
    ),
    (
        "sinew_store_transactions_total",
        "counter",
        "Transactions stored.",
    ),
    (
        "sinew_store_failures_total",
        "counter",
        "Tries to store that failed.",
    ),
    (
        "sinew_store_commits_total",
        "counter",
        "Commits: each stores one transaction or several.",
    ),
    (
        "sinew_store_commit_seconds_total",
        "counter",
        "Time that commits took.",
    ),
    (
        "sinew_estimates_total",
        "counter",
        "Estimates of stretches of motion, and trends.",
    ),
    (
        "sinew_estimate_seconds_total",
        "counter",
        "Time that estimates took.",
    ),
    ("sinew_webhooks_total", "counter", "Webhooks delivered."),
    ("sinew_webhooks_lost_total", "counter", "Webhooks given up."),
    (
        "sinew_door_open",
        "gauge",
        "1: messages can come through this door; 0: it is shut, and is tried again.",
    ),
    (
        "sinew_door_messages_total",
        "counter",
        "Messages received through this door of topics that some robot wants.",
    ),
    ("sinew_robots", "gauge", "Robots that are watched."),
    (
        "sinew_robots_not_watched",
        "gauge",
        "Robots of the configuration that can't be watched.",
    ),
    (
        "sinew_robot_level",
        "gauge",
        "How a robot is: 0 OK, 1 WARN, 2 ERROR, 3 STALE.",
    ),
    ("sinew_robot_fresh", "gauge", "1: data come; 0: they don't."),
    ("sinew_robot_rate_hertz", "gauge", "Frames of a second."),
    ("sinew_robot_frames_total", "counter", "Frames received."),
    (
        "sinew_robot_frames_lost_total",
        "counter",
        "Frames lost, refused or incomplete.",
    ),
    (
        "sinew_robot_messages_dropped_total",
        "counter",
        "Messages dropped, since the robot's queue was full.",
    ),
    ("sinew_robot_temperature_celsius", "gauge", "Temperature."),
    (
        "sinew_robot_waiting_transactions",
        "gauge",
        "Transactions that wait for the store.",
    ),
    (
        "sinew_tendon_level",
        "gauge",
        "How a tendon is: 0 OK, 1 WARN, 2 ERROR, 3 STALE.",
    ),
    (
        "sinew_tendon_offset_radians",
        "gauge",
        "Offset now, since the tendon was tensioned; missing where it isn't known.",
    ),
    (
        "sinew_tendon_offset_deviation_radians",
        "gauge",
        "Its standard deviation.",
    ),
    (
        "sinew_tendon_elongation_meters",
        "gauge",
        "Elongation now, since the tendon was tensioned.",
    ),
    (
        "sinew_tendon_elongation_deviation_meters",
        "gauge",
        "Its standard deviation.",
    ),
    (
        "sinew_tendon_strain_ratio",
        "gauge",
        "Strain now, since the rope was new.",
    ),
    (
        "sinew_tendon_record_offset_radians",
        "gauge",
        "Offset of the last record.",
    ),
    (
        "sinew_tendon_record_timestamp_seconds",
        "gauge",
        "When the session of the last record began.",
    ),
    (
        "sinew_tendon_tensioned_timestamp_seconds",
        "gauge",
        "When the tendon was last tensioned.",
    ),
    (
        "sinew_tendon_limit_elongation_meters",
        "gauge",
        "Elongation at which to tension again.",
    ),
    (
        "sinew_tendon_limit_strain_ratio",
        "gauge",
        "Strain at which to replace.",
    ),
    (
        "sinew_tendon_limit_timestamp_seconds",
        "gauge",
        "When a limit is passed, by the forecast: quantile 0.025, 0.5, 0.975.",
    ),
    (
        "sinew_alarm_active",
        "gauge",
        "1: an alarm's condition holds; 0: it is over, and the alarm isn't normal yet.",
    ),
    (
        "sinew_alarm_severity",
        "gauge",
        "Severity of an alarm that isn't normal, 1 to 1000.",
    ),
];

/// Samples by metric.
struct Samples {
    lines: Vec<String>,
}

impl Samples {
    fn new() -> Self {
        Self {
            lines: vec![String::new(); ABOUT.len()],
        }
    }

    /// A sample; of a name that isn't in the list, none.
    fn put(&mut self, name: &str, labels: &[(&str, &str)], value: f64) {
        let Some(at) = ABOUT.iter().position(|about| about.0 == name) else {
            return;
        };
        let line = &mut self.lines[at];
        line.push_str(name);
        for (i, (label, value)) in labels.iter().enumerate() {
            line.push(if i == 0 { '{' } else { ',' });
            let value = value
                .replace('\\', "\\\\")
                .replace('"', "\\\"")
                .replace('\n', "\\n");
            // Writing into a string doesn't fail.
            let _ok = write!(line, "{label}=\"{value}\"");
        }
        if !labels.is_empty() {
            line.push('}');
        }
        let _ok = writeln!(line, " {value}");
    }

    fn text(self) -> String {
        let mut out = String::new();
        for ((name, kind, help), lines) in ABOUT.iter().zip(self.lines) {
            if !lines.is_empty() {
                let _ok = write!(out, "# HELP {name} {help}\n# TYPE {name} {kind}\n{lines}");
            }
        }
        out
    }
}

/// The text of `/metrics`.
pub fn render(board: &Board, health: &Health) -> String {
    let mut out = Samples::new();
    own(&mut out, health);
    for door in health.doors() {
        let labels = [("door", door.door.as_str())];
        let open = f64::from(u8::from(door.shut.is_none()));
        out.put("sinew_door_open", &labels, open);
        out.put("sinew_door_messages_total", &labels, door.messages as f64);
    }
    let (mut watched, mut not_watched) = (0, 0);
    for (name, slot) in board.all() {
        match slot.seen() {
            Seen::Nothing => {}
            Seen::NotWatched(_) => not_watched += 1,
            Seen::Watched(robot) => {
                watched += 1;
                of_robot(&mut out, &robot);
                let dropped = slot.dropped.load(Ordering::Relaxed) as f64;
                out.put(
                    "sinew_robot_messages_dropped_total",
                    &[("robot", &name)],
                    dropped,
                );
            }
        }
    }
    out.put("sinew_robots", &[], f64::from(watched));
    out.put("sinew_robots_not_watched", &[], f64::from(not_watched));
    out.text()
}

fn own(out: &mut Samples, health: &Health) {
    let count = |of: &AtomicU64| of.load(Ordering::Relaxed) as f64;
    out.put(
        "sinew_build_info",
        &[("version", env!("CARGO_PKG_VERSION"))],
        1.0,
    );
    let store = health.store();
    for (name, value) in [
        ("sinew_uptime_seconds", health.up().as_secs_f64()),
        (
            "sinew_core_silent_seconds",
            health.silent_for().as_secs_f64(),
        ),
        (
            "sinew_store_works",
            f64::from(u8::from(store.fails.is_none())),
        ),
        (
            "sinew_store_transactions_total",
            count(&health.transactions),
        ),
        ("sinew_store_failures_total", count(&health.failures)),
        ("sinew_store_commits_total", count(&health.commits)),
        (
            "sinew_store_commit_seconds_total",
            1e-6 * count(&health.commit_us),
        ),
        ("sinew_estimates_total", count(&health.jobs)),
        ("sinew_estimate_seconds_total", 1e-6 * count(&health.job_us)),
        ("sinew_webhooks_total", count(&health.webhooks)),
        ("sinew_webhooks_lost_total", count(&health.webhooks_lost)),
    ] {
        out.put(name, &[], value);
    }
}

fn of_robot(out: &mut Samples, robot: &RobotSnapshot) {
    let name = robot.robot.as_str();
    let fresh = robot.freshness == Freshness::Fresh;
    for (metric, value) in [
        ("sinew_robot_level", f64::from(robot.level.number())),
        ("sinew_robot_fresh", f64::from(u8::from(fresh))),
        ("sinew_robot_rate_hertz", robot.rate_hz),
        ("sinew_robot_frames_total", robot.frames as f64),
        ("sinew_robot_frames_lost_total", robot.frames_lost as f64),
        (
            "sinew_robot_waiting_transactions",
            robot.waiting_to_be_stored as f64,
        ),
    ] {
        out.put(metric, &[("robot", name)], value);
    }
    if let Some(celsius) = robot.temperature_c {
        out.put(
            "sinew_robot_temperature_celsius",
            &[("robot", name)],
            celsius,
        );
    }
    for tendon in &robot.tendons {
        of_tendon(out, name, tendon);
    }
    for alarm in &robot.alarms {
        let condition = crate::words::condition_key(alarm.key.condition);
        let joint = alarm.key.joint.as_deref().unwrap_or("");
        let labels = [
            ("robot", name),
            ("joint", joint),
            ("condition", condition.as_str()),
        ];
        let active = matches!(alarm.state, AlarmState::Active | AlarmState::Acknowledged);
        out.put("sinew_alarm_active", &labels, f64::from(u8::from(active)));
        out.put(
            "sinew_alarm_severity",
            &labels,
            f64::from(alarm.key.condition.severity()),
        );
    }
}

fn of_tendon(out: &mut Samples, robot: &str, tendon: &sinew_watch_core::snapshot::TendonSnapshot) {
    let labels = [("robot", robot), ("joint", tendon.joint.as_str())];
    let mut both = |names: [&str; 2], value: Option<Gaussian>| {
        if let Some(value) = value {
            out.put(names[0], &labels, value.mean);
            out.put(names[1], &labels, value.deviation);
        }
    };
    both(
        [
            "sinew_tendon_offset_radians",
            "sinew_tendon_offset_deviation_radians",
        ],
        tendon.offset_rad,
    );
    both(
        [
            "sinew_tendon_elongation_meters",
            "sinew_tendon_elongation_deviation_meters",
        ],
        tendon.elongation_m,
    );
    let last = tendon.last.as_ref();
    for (metric, value) in [
        ("sinew_tendon_level", Some(f64::from(tendon.level.number()))),
        (
            "sinew_tendon_strain_ratio",
            tendon.strain_ratio.map(|x| x.mean),
        ),
        (
            "sinew_tendon_record_offset_radians",
            last.and_then(|r| r.offset_rad),
        ),
        (
            "sinew_tendon_record_timestamp_seconds",
            last.map(|r| r.time_utc_s),
        ),
        (
            "sinew_tendon_tensioned_timestamp_seconds",
            tendon.tensioned_utc_s,
        ),
    ] {
        if let Some(value) = value {
            out.put(metric, &labels, value);
        }
    }
    for limit in &tendon.limits {
        match limit {
            LimitNow::Retension { elongation_m, .. } => {
                out.put(
                    "sinew_tendon_limit_elongation_meters",
                    &labels,
                    *elongation_m,
                );
            }
            LimitNow::Replace { strain_ratio, .. } => {
                out.put("sinew_tendon_limit_strain_ratio", &labels, *strain_ratio);
            }
        }
    }
    let Some(trend) = &tendon.trend else { return };
    for forecast in &trend.limits {
        let limit = match forecast.limit {
            Limit::Retension { .. } => "retension",
            Limit::Replace { .. } => "replace",
        };
        let times = [
            ("0.025", forecast.after_low_s),
            ("0.5", forecast.after_s),
            ("0.975", forecast.after_high_s),
        ];
        for (quantile, after_s) in times {
            if let Some(after_s) = after_s {
                let own = [
                    labels[0],
                    labels[1],
                    ("limit", limit),
                    ("quantile", quantile),
                ];
                out.put(
                    "sinew_tendon_limit_timestamp_seconds",
                    &own,
                    trend.last_utc_s + after_s,
                );
            }
        }
    }
}

pub(super) async fn metrics(State(app): State<App>) -> Response {
    let kind = [(
        header::CONTENT_TYPE,
        "text/plain; version=0.0.4; charset=utf-8",
    )];
    (kind, render(&app.board, &app.health)).into_response()
}
