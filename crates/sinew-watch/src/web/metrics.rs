//! `/metrics` for Prometheus, in base units.

use super::App;
use crate::runtime::{Health, RobotRegistry, RobotState};
use crate::store::word;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse as _, Response};
use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, NoLabelSet, prometheus_text};
use prometheus_client::metrics::MetricType;
use prometheus_client::registry::Registry;
use sinew_model::Gaussian;
use sinew_trend::Limit;
use sinew_watch_core::RobotSnapshot;
use sinew_watch_core::snapshot::{Freshness, LimitNow, TendonSnapshot};
use std::sync::atomic::{AtomicU64, Ordering};

macro_rules! metrics {
    ($($kind:ident $name:ident $about:literal;)*) => {
        /// All metrics in their order, with name, kind and meaning; source of the reference page.
        pub const ABOUT: &[(&str, &str, &str)] = &[$((stringify!($name), stringify!($kind), $about)),*];
    };
}

metrics! {
    gauge sinew_build_info "Always 1; labelled with the version of the program.";
    gauge sinew_uptime_seconds "Time since the start of the monitor.";
    gauge sinew_core_silent_seconds "Time since the last loop of the slowest core thread.";
    gauge sinew_store_works "1: the last transaction was stored; 0: storing failed.";
    counter sinew_store_transactions_total "Transactions stored.";
    counter sinew_store_failures_total "Failed attempts to store.";
    counter sinew_store_commits_total "Commits, each of one or several transactions.";
    counter sinew_store_commit_seconds_total "Total duration of commits.";
    counter sinew_estimates_total "Estimates of motion segments, and trends.";
    counter sinew_estimate_seconds_total "Total duration of estimates.";
    counter sinew_webhooks_total "Notifications delivered.";
    counter sinew_webhooks_lost_total "Notifications discarded after the last attempt.";
    gauge sinew_transport_connected "1: the transport is connected; 0: disconnected, reconnecting.";
    counter sinew_transport_messages_total "Messages received through the transport on topics that a robot requires.";
    gauge sinew_robots "Robots that are monitored.";
    gauge sinew_robots_unmonitored "Robots of the configuration that cannot be monitored.";
    gauge sinew_robot_level "Level of the robot: 0 OK, 1 WARN, 2 ERROR, 3 STALE.";
    gauge sinew_robot_fresh "1: data are received; 0: no data.";
    gauge sinew_robot_rate_hertz "Frames per second.";
    counter sinew_robot_frames_total "Frames received.";
    counter sinew_robot_frames_lost_total "Frames lost, rejected or incomplete.";
    counter sinew_robot_messages_dropped_total "Messages dropped because the robot's queue was full.";
    gauge sinew_robot_temperature_celsius "Temperature.";
    gauge sinew_robot_waiting_transactions "Transactions that wait to be stored.";
    gauge sinew_tendon_level "Level of the tendon: 0 OK, 1 WARN, 2 ERROR, 3 STALE.";
    gauge sinew_tendon_offset_radians "Present offset since the last tensioning; missing if not available.";
    gauge sinew_tendon_offset_std_radians "Standard deviation of the offset.";
    gauge sinew_tendon_elongation_meters "Present elongation since the last tensioning.";
    gauge sinew_tendon_elongation_std_meters "Standard deviation of the elongation.";
    gauge sinew_tendon_strain_ratio "Present total strain since the rope was new.";
    gauge sinew_tendon_record_offset_radians "Offset of the last record.";
    gauge sinew_tendon_record_timestamp_seconds "Start of the session of the last record.";
    gauge sinew_tendon_tensioned_timestamp_seconds "Time of the last tensioning.";
    gauge sinew_tendon_limit_elongation_meters "Elongation limit for re-tensioning.";
    gauge sinew_tendon_limit_strain_ratio "Strain limit for replacement.";
    gauge sinew_tendon_limit_timestamp_seconds "Forecast time at which a limit is exceeded with probability 0.025, 0.5, 0.975.";
    gauge sinew_alarm_active "1: the alarm is active, or latched until repair or reset; 0: cleared, unacknowledged.";
    gauge sinew_alarm_severity "Severity of an alarm that is not normal, 1 to 1000.";
}

type Labels<'a> = [(&'static str, &'a str)];

/// Value with its labels.
type Sample = (Vec<(&'static str, String)>, f64);

/// Samples of every metric of [`ABOUT`].
#[derive(Debug)]
struct Samples(Vec<Vec<Sample>>);

impl Samples {
    /// Adds a sample if the value exists and the metric is in the list.
    fn put(&mut self, name: &str, labels: &Labels<'_>, value: impl Into<Option<f64>>) {
        let at = ABOUT.iter().position(|about| about.0 == name);
        if let (Some(at), Some(value)) = (at, value.into()) {
            let labels = labels.iter().map(|(label, of)| (*label, (*of).to_owned()));
            self.0[at].push((labels.collect(), value));
        }
    }
}

impl Collector for Samples {
    fn encode(&self, mut encoder: DescriptorEncoder<'_>) -> std::fmt::Result {
        for ((name, kind, about), samples) in ABOUT.iter().zip(&self.0) {
            if samples.is_empty() {
                continue;
            }
            // The encoder appends the suffix of a counter itself.
            let (name, kind) = match *kind {
                "counter" => (name.trim_end_matches("_total"), MetricType::Counter),
                _ => (*name, MetricType::Gauge),
            };
            let mut metric = encoder.encode_descriptor(name, about, None, kind)?;
            for (labels, value) in samples {
                let mut sample = metric.encode_family(labels)?;
                // A whole number is written without a decimal point.
                let whole = value.fract() == 0.0 && value.abs() < 2_f64.powi(53);
                let (count, number) = (*value as u64, *value as i64);
                match (kind, whole) {
                    (MetricType::Counter, true) => {
                        sample.encode_counter::<NoLabelSet, _, f64>(&count, None)
                    }
                    (MetricType::Counter, false) => {
                        sample.encode_counter::<NoLabelSet, _, f64>(value, None)
                    }
                    (_, true) => sample.encode_gauge(&number),
                    (_, false) => sample.encode_gauge(value),
                }?;
            }
        }
        Ok(())
    }
}

/// Returns the text of `/metrics`.
pub fn render(registry: &RobotRegistry, health: &Health) -> String {
    let mut out = Samples(vec![Vec::new(); ABOUT.len()]);
    of_monitor(&mut out, health);
    for transport in health.transports() {
        let labels = [("transport", transport.transport.as_str())];
        out.put(
            "sinew_transport_connected",
            &labels,
            f64::from(transport.disconnected.is_none()),
        );
        out.put(
            "sinew_transport_messages_total",
            &labels,
            transport.messages as f64,
        );
    }
    let (mut monitored, mut unmonitored) = (0, 0);
    for (name, slot) in registry.all() {
        match slot.state() {
            RobotState::Starting => {}
            RobotState::NotMonitored(_) => unmonitored += 1,
            RobotState::Monitored(robot) => {
                monitored += 1;
                of_robot(&mut out, &robot);
                let labels = [("robot", name.as_str())];
                let dropped = slot.dropped.load(Ordering::Relaxed) as f64;
                out.put("sinew_robot_messages_dropped_total", &labels, dropped);
            }
        }
    }
    out.put("sinew_robots", &[], f64::from(monitored));
    out.put("sinew_robots_unmonitored", &[], f64::from(unmonitored));
    let mut registry = Registry::default();
    registry.register_collector(Box::new(out));
    let mut text = String::new();
    // Writing into memory does not fail.
    let _ok = prometheus_text::encode(&mut text, &registry);
    text
}

fn of_monitor(out: &mut Samples, health: &Health) {
    let version = [("version", env!("CARGO_PKG_VERSION"))];
    out.put("sinew_build_info", &version, 1.0);
    let count = |of: &AtomicU64| of.load(Ordering::Relaxed) as f64;
    let seconds = |of: &AtomicU64| 1e-6 * count(of);
    let counts = &health.counts;
    let works = f64::from(health.store_fails().is_none());
    let mut put = |name, value: f64| out.put(name, &[], value);
    put("sinew_uptime_seconds", health.up().as_secs_f64());
    put(
        "sinew_core_silent_seconds",
        health.silent_for().as_secs_f64(),
    );
    put("sinew_store_works", works);
    put(
        "sinew_store_transactions_total",
        count(&counts.transactions),
    );
    put("sinew_store_failures_total", count(&counts.failures));
    put("sinew_store_commits_total", count(&counts.commits));
    put(
        "sinew_store_commit_seconds_total",
        seconds(&counts.commit_us),
    );
    put("sinew_estimates_total", count(&counts.jobs));
    put("sinew_estimate_seconds_total", seconds(&counts.job_us));
    put("sinew_webhooks_total", count(&counts.webhooks));
    put("sinew_webhooks_lost_total", count(&counts.webhooks_lost));
}

fn of_robot(out: &mut Samples, robot: &RobotSnapshot) {
    let name = robot.robot.as_str();
    let labels = [("robot", name)];
    let fresh = robot.freshness == Freshness::Fresh;
    let waiting = robot.waiting_to_be_stored as f64;
    out.put(
        "sinew_robot_level",
        &labels,
        f64::from(robot.level.number()),
    );
    out.put("sinew_robot_fresh", &labels, f64::from(fresh));
    out.put("sinew_robot_rate_hertz", &labels, robot.rate_hz);
    out.put("sinew_robot_frames_total", &labels, robot.frames as f64);
    out.put(
        "sinew_robot_frames_lost_total",
        &labels,
        robot.frames_lost as f64,
    );
    out.put("sinew_robot_waiting_transactions", &labels, waiting);
    out.put(
        "sinew_robot_temperature_celsius",
        &labels,
        robot.temperature_c,
    );
    for tendon in &robot.tendons {
        of_tendon(out, name, tendon);
    }
    for alarm in &robot.alarms {
        let condition = word(&alarm.key.condition);
        let joint = alarm.key.joint.as_deref().unwrap_or("");
        let labels = [
            ("robot", name),
            ("joint", joint),
            ("condition", condition.as_str()),
        ];
        let severity = f64::from(alarm.severity());
        out.put("sinew_alarm_active", &labels, f64::from(alarm.is_active()));
        out.put("sinew_alarm_severity", &labels, severity);
    }
}

fn of_tendon(out: &mut Samples, robot: &str, tendon: &TendonSnapshot) {
    let labels = [("robot", robot), ("joint", tendon.joint.as_str())];
    let mut put = |name, value: Option<f64>| out.put(name, &labels, value);
    let mean = |of: Option<Gaussian>| of.map(|x| x.mean);
    let std = |of: Option<Gaussian>| of.map(|x| x.std);
    let (offset, elongation) = (tendon.offset_rad, tendon.elongation_m);
    let last = tendon.last.as_ref();
    put("sinew_tendon_level", Some(f64::from(tendon.level.number())));
    put("sinew_tendon_offset_radians", mean(offset));
    put("sinew_tendon_offset_std_radians", std(offset));
    put("sinew_tendon_elongation_meters", mean(elongation));
    put("sinew_tendon_elongation_std_meters", std(elongation));
    put("sinew_tendon_strain_ratio", mean(tendon.strain_ratio));
    put(
        "sinew_tendon_record_offset_radians",
        last.and_then(|r| r.offset_rad),
    );
    put(
        "sinew_tendon_record_timestamp_seconds",
        last.map(|r| r.time_utc_s),
    );
    put(
        "sinew_tendon_tensioned_timestamp_seconds",
        tendon.tensioned_utc_s,
    );
    for limit in &tendon.limits {
        match limit {
            LimitNow::Retension { elongation_m, .. } => {
                put("sinew_tendon_limit_elongation_meters", Some(*elongation_m));
            }
            LimitNow::Replace { strain_ratio, .. } => {
                put("sinew_tendon_limit_strain_ratio", Some(*strain_ratio));
            }
        }
    }
    let Some(trend) = &tendon.trend else { return };
    for forecast in &trend.limits {
        let limit = match forecast.limit {
            Limit::Retension { .. } => "retension",
            Limit::Replace { .. } => "replace",
        };
        for (probability, after_s) in [
            ("0.025", forecast.after_low_s),
            ("0.5", forecast.after_s),
            ("0.975", forecast.after_high_s),
        ] {
            let with_probability = [
                labels[0],
                labels[1],
                ("limit", limit),
                ("probability", probability),
            ];
            let at_utc_s = after_s.map(|after_s| trend.last_utc_s + after_s);
            out.put(
                "sinew_tendon_limit_timestamp_seconds",
                &with_probability,
                at_utc_s,
            );
        }
    }
}

pub(super) async fn metrics(State(app): State<App>) -> Response {
    let kind = [(header::CONTENT_TYPE, prometheus_text::CONTENT_TYPE)];
    (kind, render(&app.registry, &app.health)).into_response()
}
