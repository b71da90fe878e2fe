//! Shipped files are consistent with the program.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-watch ship` regenerates the manual page.

use clap::CommandFactory as _;
use sinew_model::Gaussian;
use sinew_trend::{JointTrend, Limit, LimitForecast, LimitState, PriorBasis, TrendVerdict};
use sinew_watch::args::Args;
use sinew_watch::config::Config;
use sinew_watch::runtime::{Health, RobotRegistry, RobotState, TransportView};
use sinew_watch::store::StoreError;
use sinew_watch::web::metrics::{ABOUT, render};
use sinew_watch_core::RobotSnapshot;
use sinew_watch_core::alarm::{Alarm, AlarmCause, AlarmKey, AlarmState, Condition, Level};
use sinew_watch_core::record::Clock;
use sinew_watch_core::snapshot::{Freshness, Learning, TendonSnapshot, Validity};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("ship")
}

fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(name)).unwrap()
}

#[test]
fn manual_page_matches_program() {
    let mut page = Vec::new();
    clap_mangen::Man::new(Args::command())
        .render(&mut page)
        .unwrap();
    let path = folder().join("sinew-watch.1");
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let found = std::fs::read(&path).unwrap_or_default();
    assert!(found == page, "regenerate it with SINEW_WRITE=1");
}

#[test]
fn dashboard_and_alerts_use_existing_metrics() {
    let known: BTreeSet<&str> = ABOUT.iter().map(|(name, ..)| *name).collect();
    for name in ["grafana.json", "prometheus-alerts.yml"] {
        let text = text(name);
        let is_part = |c: char| c.is_ascii_lowercase() || c == '_';
        let asked: BTreeSet<&str> = text
            .match_indices("sinew_")
            .map(|(at, _)| text[at..].split(|c| !is_part(c)).next().unwrap())
            .collect();
        let unknown: Vec<_> = asked.difference(&known).collect();
        assert!(unknown.is_empty() && asked.len() > 4, "{name}: {unknown:?}");
    }
}

#[test]
fn dashboard_panels_do_not_overlap() {
    let registry: serde_json::Value = serde_json::from_str(&text("grafana.json")).unwrap();
    let mut taken = BTreeSet::new();
    let mut ids = BTreeSet::new();
    for panel in registry["panels"].as_array().unwrap() {
        assert!(ids.insert(panel["id"].as_u64().unwrap()), "{panel}");
        let of = |name: &str| panel["gridPos"][name].as_u64().unwrap();
        assert!(of("x") + of("w") <= 24, "{panel}");
        for x in of("x")..of("x") + of("w") {
            for y in of("y")..of("y") + of("h") {
                assert!(
                    taken.insert((x, y)),
                    "{} overlaps another panel",
                    panel["title"]
                );
            }
        }
    }
}

#[test]
fn shipped_configuration_is_valid() {
    let config = Config::parse(&text("watch.toml"), "watch.toml", Path::new("/etc/sinew")).unwrap();
    assert_eq!(config.robots.len(), 1);
    assert!(!config.web.needs_token());
}

#[test]
fn aggregator_selects_the_statuses_of_the_monitor() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let package = root.join("packaging/ros2/sinew_ros");
    let yaml = std::fs::read_to_string(package.join("config/aggregator.yaml")).unwrap();
    let launch = std::fs::read_to_string(package.join("launch/sinew.launch.py")).unwrap();
    assert!(launch.contains("\"aggregator.yaml\""));
    let value = |key: &str| {
        let line = yaml.lines().find_map(|line| line.trim().strip_prefix(key));
        line.unwrap().trim_start_matches(':').trim().to_owned()
    };
    let prefix = format!("[\"{}\"]", sinew_watch::runtime::STATUS_PREFIX);
    assert_eq!(
        [value("startswith"), value("remove_prefix")],
        [prefix.clone(), prefix]
    );
    // A status may be late, but one missed is not stale.
    assert!(value("timeout").parse::<f64>().unwrap() > 1.0);
}

#[test]
fn debian_package_contains_shipped_files() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    let manifest = std::fs::read_to_string(manifest).unwrap();
    for entry in std::fs::read_dir(folder()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let of_its_own = ["Containerfile", "sinew-watch.service"].contains(&name.as_str());
        assert!(
            of_its_own || manifest.contains(&format!("\"ship/{name}\"")),
            "{name}: missing in the Debian package"
        );
    }
}

/// Samples of a text of metrics: name, labels, value.
fn samples(text: &str) -> Vec<(String, BTreeMap<String, String>, f64)> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| {
            let (series, value) = line.rsplit_once(' ').unwrap();
            let (name, labels) = series.split_once('{').unwrap_or((series, ""));
            let labels = labels.trim_end_matches('}').split("\",");
            let labels = labels.filter_map(|pair| {
                let (label, of) = pair.split_once("=\"")?;
                Some((label.to_owned(), of.trim_end_matches('"').to_owned()))
            });
            (name.to_owned(), labels.collect(), value.parse().unwrap())
        })
        .collect()
}

/// Value of a product of numbers, such as `7 * 86400`.
fn product(text: &str) -> f64 {
    let factors = text.split('*').map(|part| part.trim().parse::<f64>());
    factors.product::<Result<f64, _>>().unwrap()
}

/// Labels of the series for which `SELECTOR [- time()] OPERATOR NUMBER [and on (LABELS) ...]` holds: the part of PromQL that
/// the shipped rules use.
fn holds(expression: &str, text: &str, now_utc_s: f64) -> Vec<BTreeMap<String, String>> {
    if let Some((one, rest)) = expression.split_once(" and on ") {
        let (labels, other) = rest.strip_prefix('(').unwrap().split_once(')').unwrap();
        let labels: Vec<&str> = labels.split(',').map(str::trim).collect();
        let of = |found: &BTreeMap<String, String>| -> Vec<Option<String>> {
            labels.iter().map(|l| found.get(*l).cloned()).collect()
        };
        let others: Vec<_> = holds(other.trim(), text, now_utc_s)
            .iter()
            .map(of)
            .collect();
        let mut found = holds(one, text, now_utc_s);
        found.retain(|labels| others.contains(&of(labels)));
        return found;
    }
    let (operator, at) = ["==", ">=", ">", "<"]
        .iter()
        .find_map(|operator| Some((*operator, expression.find(operator)?)))
        .unwrap();
    let (left, right) = (&expression[..at], &expression[at + operator.len()..]);
    let limit = product(right);
    let (selector, minus) = match left.trim().strip_suffix("- time()") {
        Some(selector) => (selector.trim(), now_utc_s),
        None => (left.trim(), 0.0),
    };
    let (name, wanted) = selector.split_once('{').unwrap_or((selector, ""));
    let wanted = wanted.trim_end_matches('}').split(',');
    let wanted: Vec<(&str, &str)> = wanted.filter_map(|pair| pair.split_once('=')).collect();
    let is_meant = |labels: &BTreeMap<String, String>| {
        let has = |(label, of): &(&str, &str)| {
            labels.get(*label).map(String::as_str) == Some(of.trim_matches('"'))
        };
        wanted.iter().all(has)
    };
    let compare = |value: f64| match operator {
        "==" => value == limit,
        ">=" => value >= limit,
        ">" => value > limit,
        _ => value < limit,
    };
    let all = samples(text).into_iter();
    all.filter(|(found, labels, value)| found == name && is_meant(labels) && compare(value - minus))
        .map(|(_, labels, _)| labels)
        .collect()
}

/// Alarm of the elbow.
fn alarm(condition: Condition, state: AlarmState) -> Alarm {
    Alarm {
        key: AlarmKey {
            joint: Some("elbow".into()),
            condition,
        },
        state,
        acknowledged: false,
        raised_utc_s: NOW_S,
        cause: AlarmCause::Provisional { for_s: 600.0 },
        shelved_until_utc_s: None,
        shelved_for_s: None,
    }
}

/// Snapshot of a robot with an alarm, and a forecast of the re-tensioning of its elbow, days from now.
pub(crate) fn snapshot(alarms: Vec<Alarm>, forecast_d: f64) -> RobotSnapshot {
    let trend = JointTrend {
        name: "elbow".into(),
        verdict: TrendVerdict::Wait,
        sessions: 30,
        without_information: 0,
        first_utc_s: NOW_S - 30.0 * 86_400.0,
        last_utc_s: NOW_S,
        cycles: None,
        tensioned_utc_s: NOW_S - 30.0 * 86_400.0,
        tensioned_specified: true,
        offset_rad: Gaussian::new(0.01, 1e-4),
        elongation_m: None,
        strain_ratio: None,
        rate_rad_per_s: Gaussian::new(1e-9, 1e-10),
        drift_rad_per_k: None,
        reference_c: 23.0,
        baseline_error_rad: Gaussian::new(0.0, 1e-4),
        systematic_error_rad: 1e-4,
        reported_width_ratio: 1.0,
        events: Vec::new(),
        suspected_step: None,
        limits: vec![LimitForecast {
            limit: Limit::Retension { elongation_m: 2e-3 },
            limit_rad: 0.05,
            state: LimitState::Forecast,
            passed_probability: 0.01,
            after_s: Some(86_400.0 * forecast_d),
            after_low_s: Some(0.5 * 86_400.0 * forecast_d),
            after_high_s: None,
            at_utc_s: None,
            at_low_utc_s: None,
            at_high_utc_s: None,
        }],
        life: None,
        basis: PriorBasis::Rope {
            rope: "rope".into(),
            parameters: 4,
            assumed: 0,
            draws: 500,
            duty: None,
        },
        series: Vec::new(),
        forecast: Vec::new(),
    };
    RobotSnapshot {
        robot: "arm-7".into(),
        robot_type: "biorob-like".into(),
        source: "dds:0".into(),
        time_utc_s: NOW_S,
        level: Level::Ok,
        freshness: Freshness::Fresh,
        rate_hz: 250.0,
        frames: 1,
        frames_lost: 0,
        learning: Learning::Following,
        session: None,
        clock: Clock::Utc,
        temperature_c: None,
        incidents: Vec::new(),
        maintenance: Vec::new(),
        withdrawable: None,
        external_force: None,
        tendons: vec![TendonSnapshot {
            joint: "elbow".into(),
            level: Level::Ok,
            offset_rad: None,
            validity: Validity::NotValid { for_s: 0.0 },
            provisional: None,
            unknown_temperature_rad: None,
            elongation_m: None,
            strain_ratio: None,
            reason: None,
            tensioned_utc_s: None,
            last: None,
            limits: Vec::new(),
            rope: None,
            trend: Some(Arc::new(trend)),
            passages: Arc::default(),
        }],
        alarms,
        waiting_to_be_stored: 0,
    }
}

const NOW_S: f64 = 1_793_600_000.0;

/// Metrics of a monitor of one robot, which is in order except for what `spoil` changes.
fn metrics(snapshot: RobotSnapshot, spoil: impl Fn(&RobotRegistry, &Health)) -> String {
    let (registry, health) = (RobotRegistry::default(), Health::new(1));
    health.committed(1, Duration::from_millis(5), None);
    let transport = |disconnected| TransportView {
        transport: "dds:0".into(),
        disconnected,
        messages: 1,
    };
    health.set_transports(vec![transport(None)]);
    let slot = registry.slot("arm-7");
    slot.put(RobotState::Monitored(Arc::new(snapshot)));
    health.beat(0);
    spoil(&registry, &health);
    render(&registry, &health) + "up{job=\"sinew\"} 1\n"
}

/// Name and expression of every shipped rule.
fn rules() -> Vec<(String, String)> {
    let text = text("prometheus-alerts.yml");
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let pairs = lines.windows(2).filter_map(|pair| {
        let name = pair[0].strip_prefix("- alert: ")?;
        Some((name.into(), pair[1].strip_prefix("expr: ")?.into()))
    });
    pairs.collect()
}

#[test]
fn shipped_rules_fire_on_their_condition() {
    let plain = || snapshot(Vec::new(), 100.0);
    let order = metrics(plain(), |_, _| {});
    let raised =
        |condition, state| metrics(snapshot(vec![alarm(condition, state)], 100.0), |_, _| {});
    let full = || StoreError::Lost {
        file: "watch.db".into(),
        what: "is empty",
        remains: "watch.db".into(),
    };
    let faulty: BTreeMap<&str, String> = [
        // Prometheus adds this series itself.
        ("SinewDown", "up{job=\"sinew\"} 0\n".into()),
        (
            "SinewStorageFailure",
            metrics(plain(), |_, health| {
                health.committed(1, Duration::ZERO, Some(&full()));
            }),
        ),
        (
            "SinewThreadStalled",
            metrics(plain(), |_, _| {
                std::thread::sleep(Duration::from_millis(10_100))
            }),
        ),
        (
            "SinewTransportDisconnected",
            metrics(plain(), |_, health| {
                health.set_transports(vec![TransportView {
                    transport: "dds:0".into(),
                    disconnected: Some("no network".into()),
                    messages: 0,
                }]);
            }),
        ),
        (
            "SinewRobotUnmonitored",
            metrics(plain(), |registry, _| {
                let slot = registry.slot("arm-8");
                slot.put(RobotState::NotMonitored("robot.toml not found".into()));
            }),
        ),
        // A slip: raised, and latched immediately, as nothing remains of it to observe.
        (
            "SinewAlarmActive",
            raised(Condition::StepChange, AlarmState::Latched),
        ),
        (
            "SinewWarningActive",
            raised(Condition::LimitNear, AlarmState::Active),
        ),
        (
            "SinewTendonLimitWithinOneWeek",
            metrics(snapshot(Vec::new(), 6.5), |_, _| {}),
        ),
    ]
    .into();
    let rules = rules();
    let names: BTreeSet<&str> = rules.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, faulty.keys().copied().collect());
    for (name, expression) in &rules {
        let fires = |text: &str| holds(expression, text, NOW_S);
        let text = &faulty[name.as_str()];
        assert!(!fires(text).is_empty(), "{name}: {expression}\n{text}");
        assert_eq!(fires(&order), [], "{name} without a fault");
    }
    let strand = raised(Condition::StrandFailure, AlarmState::Latched);
    let fires = holds(&rules[5].1, &strand, NOW_S);
    assert_eq!(fires[0]["condition"], "strand-failure");
    let cleared = raised(Condition::LimitNear, AlarmState::Cleared);
    assert_eq!(holds(&rules[6].1, &cleared, NOW_S), []);
    promtool(&rules, &faulty);
}

/// The same with Prometheus itself, where its program is installed: rules and metrics are valid, and every rule fires.
fn promtool(rules: &[(String, String)], faulty: &BTreeMap<&str, String>) {
    let run = |arguments: &[&str], input: Option<&str>| {
        let mut command = Command::new("promtool");
        let command = command.args(arguments).stdin(Stdio::piped());
        let mut child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .ok()?;
        child
            .stdin
            .take()
            .unwrap()
            .write_all(input.unwrap_or("").as_bytes())
            .unwrap();
        let done = child.wait_with_output().unwrap();
        let said = [done.stdout, done.stderr].concat();
        Some((done.status.success(), String::from_utf8(said).unwrap()))
    };
    let all = faulty["SinewAlarmActive"].replace("up{job=\"sinew\"} 1\n", "");
    let Some((is_valid, said)) = run(&["check", "metrics"], Some(&all)) else {
        eprintln!("SKIPPED: promtool is not installed");
        return;
    };
    assert!(is_valid && said.trim().is_empty(), "{said}");
    let file = folder().join("prometheus-alerts.yml");
    let mut tests = format!(
        "rule_files: [{}]\nevaluation_interval: 1m\ntests:\n",
        file.display()
    );
    for (name, _) in rules {
        // A test of promtool begins in 1970; the date of the limit moves with it.
        let series: String = samples(&faulty[name.as_str()])
            .into_iter()
            .map(|(metric, labels, value)| {
                let labels: Vec<String> =
                    labels.iter().map(|(l, v)| format!("{l}=\"{v}\"")).collect();
                let value = match metric.ends_with("_timestamp_seconds") {
                    true => value - NOW_S,
                    false => value,
                };
                let labels = labels.join(",");
                format!("      - series: '{metric}{{{labels}}}'\n        values: '{value}x20'\n")
            })
            .collect();
        tests += &format!(
            "  - name: {name}\n    interval: 1m\n    input_series:\n{series}    promql_expr_test:\n      - \
             expr: count(ALERTS{{alertname=\"{name}\",alertstate=\"firing\"}}) > bool 0\n        eval_time: 10m\n        \
             exp_samples: [{{ value: 1 }}]\n"
        );
    }
    let written = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(written.path(), tests).unwrap();
    let path = written.path().display().to_string();
    let (passes, said) = run(&["test", "rules", &path], None).unwrap();
    assert!(passes, "{said}");
}
