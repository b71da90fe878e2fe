//! Page and API of a running monitor: responses and access control.

use crate::http::{ask, events, get, post, raw};
use serde_json::{Value, json};
use sinew_watch::config::{PostFormat, Receiver, Role, WebSettings, Webhook};
use sinew_watch::demo::Demo;
use sinew_watch::runtime::{Health, RobotRegistry};
use sinew_watch::store::{Place, Store};
use sinew_watch::token::Token;
use sinew_watch::web::guard::Guard;
use sinew_watch::web::metrics::ABOUT;
use sinew_watch::web::routes::router;
use sinew_watch::web::{App, Ticker};
use sinew_watch::webhooks::Post;
use sinew_watch_core::alarm::{AlarmKey, AlarmState, Condition, Transition, TransitionReason};
use sinew_watch_core::journal::{Entry, Event};
use std::collections::BTreeSet;
use std::io::{BufRead as _, Read as _, Write as _};
use std::net::SocketAddr;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// Demonstration on its own port.
pub(crate) struct Running {
    pub(crate) at: SocketAddr,
    _signals: Sender<sinew_watch::service::Signal>,
}

impl Running {
    pub(crate) fn start() -> Self {
        let (signals, _) = channel();
        let web = WebSettings {
            bind: "127.0.0.1:0".parse().ok(),
            host_names: vec!["cell-3.example.org".into()],
            ..WebSettings::default()
        };
        let demo = Demo::start(web, signals.clone()).unwrap();
        let at = demo.web.address.unwrap();
        let running = Self {
            at,
            _signals: signals,
        };
        // Ends with the process.
        std::mem::forget(demo);
        running.until(|r| {
            let fleet = get(r.at, "/api/v1/fleet").json();
            fleet["robots"]
                .as_array()
                .is_some_and(|robots| robots.len() == 3)
        });
        running
    }

    /// Shared by all tests; ends with the process.
    pub(crate) fn shared() -> &'static Self {
        static RUNNING: OnceLock<Running> = OnceLock::new();
        RUNNING.get_or_init(Self::start)
    }

    pub(crate) fn until(&self, holds: impl Fn(&Self) -> bool) {
        let begun = Instant::now();
        while !holds(self) {
            assert!(begun.elapsed() < Duration::from_secs(180), "timeout");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

fn command(at: SocketAddr, what: Value, note: &str) -> (u16, Value) {
    let body = json!({ "who": "a test", "note": note, "what": what }).to_string();
    let answer = post(at, "/api/v1/robots/demo-2/commands", &body);
    (answer.status, answer.json())
}

#[test]
fn command_is_answered_after_storing() {
    let running = Running::shared();
    let at = running.at;
    let (status, answer) = command(at, json!({ "kind": "note" }), "oiled the guides");
    assert_eq!((status, answer), (200, json!({ "done": true })));
    let journal = get(at, "/api/v1/journal?robot=demo-2&event=command&most=1").json();
    assert_eq!(journal["entries"][0]["text"], "a test: oiled the guides");
    assert_eq!(journal["entries"][0]["event"]["who"], "a test");
    let tension = json!({ "kind": "tensioned", "joints": ["elbow"] });
    assert_eq!(command(at, tension, "").0, 200);
    running.until(|r| {
        let now = get(r.at, "/api/v1/robots/demo-2").json();
        now["robot"]["learning"]["kind"] == "baseline"
    });
    // The entry can be withdrawn; it remains in the journal with its correction.
    let robot = get(at, "/api/v1/robots/demo-2").json();
    let entry = robot["robot"]["withdrawable"].as_u64().unwrap();
    let withdraw = || json!({ "kind": "withdraw", "entry": entry });
    assert_eq!(command(at, withdraw(), "").0, 200);
    assert_eq!(command(at, withdraw(), "").0, 422);
    let journal = get(at, "/api/v1/journal?robot=demo-2&event=command&most=2").json();
    let [withdrawal, tensioned] = [&journal["entries"][0], &journal["entries"][1]];
    assert_eq!(withdrawal["event"]["what"]["kind"], "withdraw");
    assert_eq!(withdrawal["correction"], Value::Null);
    let correction = &tensioned["correction"];
    assert_eq!(
        (&correction["who"], &correction["withdrawn"]),
        (&json!("a test"), &json!(true))
    );
    let robot = get(at, "/api/v1/robots/demo-2").json();
    assert_ne!(robot["robot"]["learning"]["kind"], "baseline");
    let missing = get(at, "/api/v1/robots/demo-2/incidents/1/recording.mcap");
    assert_eq!(missing.status, 404, "{}", missing.text());
    assert_eq!(get(at, "/api/v1/survival.csv").status, 200);
    for (what, note, words) in [
        (json!({ "kind": "note" }), "", "note is missing"),
        (
            json!({ "kind": "tensioned", "joints": ["knee"] }),
            "",
            "no tendon at 'knee'",
        ),
        (json!({ "kind": "fly" }), "", "unknown variant `fly`"),
        (
            json!({ "kind": "shelve", "alarm": { "joint": null, "condition": "data" }, "for_s": 60.0 }),
            "",
            "alarm not found",
        ),
    ] {
        let (status, answer) = command(at, what, note);
        let error = answer["error"].as_str().unwrap();
        assert!(status == 422 && error.contains(words), "{status} {error}");
    }
    // demo-3 is switched off: its alarm can be acknowledged and shelved for a limited time.
    let key = json!({ "joint": null, "condition": "no-data" });
    let of_3 = |what: Value| {
        let body = json!({ "who": "a test", "what": what }).to_string();
        post(at, "/api/v1/robots/demo-3/commands", &body).status
    };
    running.until(|r| get(r.at, "/api/v1/alarms").text().contains("no-data"));
    assert_eq!(of_3(json!({ "kind": "acknowledge", "alarm": key })), 200);
    assert_eq!(
        of_3(json!({ "kind": "shelve", "alarm": key, "for_s": 8.0 * 86_400.0 })),
        422
    );
    assert_eq!(
        of_3(json!({ "kind": "shelve", "alarm": key, "for_s": 3600.0 })),
        200
    );
    let alarms = get(at, "/api/v1/alarms").json();
    let shelved = alarms["alarms"]
        .as_array()
        .unwrap()
        .iter()
        .find(|a| a["robot"] == "demo-3");
    assert_eq!(shelved.unwrap()["level"], "OK");
}

#[test]
fn foreign_requests_are_rejected() {
    let running = Running::shared();
    let at = running.at;
    let note = json!({ "who": "x", "note": "x", "what": { "kind": "note" } }).to_string();
    let path = "/api/v1/robots/demo-1/commands";
    let json = ("content-type", "application/json");
    let own = ("x-sinew", "1");
    // A foreign name that points to this host: DNS rebinding.
    for host in [
        "evil.example",
        "evil.example:8642",
        "localhost.evil.example",
        "",
    ] {
        let answer = ask(at, "GET", "/api/v1/fleet", &[("host", host)], None);
        assert_eq!(answer.status, 421, "{host}: {}", answer.text());
    }
    for host in [
        "localhost",
        "127.0.0.1:1",
        "[::1]:8642",
        "Cell-3.example.org:8642",
    ] {
        assert_eq!(
            ask(at, "GET", "/api/v1/fleet", &[("host", host)], None).status,
            200,
            "{host}"
        );
    }
    assert_eq!(raw(at, b"GET /api/v1/fleet HTTP/1.0\r\n\r\n").status, 421);
    for (headers, status) in [
        // A form of another site can send neither header.
        (
            vec![("content-type", "application/x-www-form-urlencoded")],
            403,
        ),
        (vec![("content-type", "text/plain"), own], 415),
        (vec![json], 403),
        (vec![json, own, ("origin", "http://evil.example")], 403),
        (vec![json, own, ("sec-fetch-site", "cross-site")], 403),
        (vec![json, own, ("sec-fetch-site", "same-origin")], 200),
    ] {
        let answer = ask(at, "POST", path, &headers, Some(&note));
        assert_eq!(answer.status, status, "{headers:?}: {}", answer.text());
    }
    let fleet = get(at, "/");
    let policy = fleet.header("content-security-policy").unwrap();
    assert!(
        policy.starts_with("default-src 'none'; script-src 'self'"),
        "{policy}"
    );
    assert_eq!(fleet.header("x-frame-options"), Some("DENY"));
    let answer = ask(
        at,
        "OPTIONS",
        path,
        &[("origin", "http://evil.example")],
        None,
    );
    assert!(
        !answer
            .headers
            .iter()
            .any(|(name, _)| name.starts_with("access-control"))
    );
    let long =
        json!({ "who": "x", "note": "x".repeat(70_000), "what": { "kind": "note" } }).to_string();
    assert_eq!(post(at, path, &long).status, 413);
    assert_eq!(post(at, path, "{").status, 422);
    assert_eq!(get(at, "/api/v1/robots/nobody").status, 404);
    assert_eq!(get(at, "/api/v1/robots/demo-1/tendons/knee").status, 404);
    assert_eq!(get(at, "/api/v1/records?robots=demo-1").status, 400);
    assert_eq!(ask(at, "DELETE", path, &[json, own], None).status, 405);
}

#[test]
fn event_stream_sends_changes_every_second() {
    let running = Running::shared();
    let received = events(running.at, "/api/v1/events?robot=demo-1", 5);
    let names: Vec<&str> = received.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["fleet", "robot", "change", "robot", "change"]);
    let all: Value = serde_json::from_str(&received[0].1).unwrap();
    assert_eq!(all["robots"].as_array().unwrap().len(), 3);
    let robot: Value = serde_json::from_str(&received[1].1).unwrap();
    assert_eq!(robot["robot"]["robot"], "demo-1");
    let of = |i: usize| -> Value { serde_json::from_str(&received[i].1).unwrap() };
    let (first, second) = (of(2), of(4));
    assert!(second["time_utc_s"].as_f64() > first["time_utc_s"].as_f64());
    assert!(
        received[2].1.len() < received[0].1.len(),
        "{}",
        received[2].1
    );
}

/// Two subscribers of one tendon; by the test above, a stream without `live` carries no series.
#[test]
fn live_series_is_sent_at_10_hz_to_its_subscribers() {
    let at = Running::shared().at;
    let samples = |count: usize| -> Vec<Value> {
        let received = events(
            at,
            "/api/v1/events?live=demo-1/elbow,demo-1/knee,nobody/elbow",
            count,
        );
        let live = received.iter().filter(|(name, _)| name == "live");
        let each = live.map(|(_, data)| serde_json::from_str::<Value>(data).unwrap());
        let each: Vec<Value> = each.collect();
        let is_own = |e: &Value| e["robot"] == "demo-1" && e["joint"] == "elbow";
        assert!(each.iter().all(is_own), "{each:?}");
        each.iter()
            .flat_map(|e| e["samples"].as_array().unwrap().clone())
            .collect()
    };
    let other = std::thread::spawn(move || events(at, "/api/v1/events?live=demo-1/elbow", 120));
    std::thread::sleep(Duration::from_secs(4));
    let begun = Instant::now();
    let samples = samples(40);
    let took_s = begun.elapsed().as_secs_f64();
    // The other subscriber is the reason for the samples of 4 s before; then ten in a second.
    let expected = 10.0 * (4.0 + took_s);
    assert!(took_s > 2.0, "{took_s} s");
    assert!(
        (samples.len() as f64 - expected).abs() < 25.0,
        "{} of {expected}",
        samples.len()
    );
    let times: Vec<f64> = samples
        .iter()
        .map(|s| s["time_s"].as_f64().unwrap())
        .collect();
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // A slow machine may miss an interval.
    let is_tenth = |s: &&f64| (**s - 0.1).abs() < 1e-6;
    assert!(steps.iter().all(|s| *s > 0.09), "{steps:?}");
    assert!(
        20 * steps.iter().filter(is_tenth).count() > 18 * steps.len(),
        "{steps:?}"
    );
    for sample in &samples {
        let difference_rad = sample["motor_minus_joint_rad"].as_f64().unwrap();
        assert!(difference_rad.abs() < 0.2, "{sample}");
        let is_valid = sample["valid"].as_bool().unwrap();
        assert!(!is_valid || !sample["offset_rad"].is_null(), "{sample}");
    }
    // Its events are those of any stream.
    let _events = other.join();
}

#[test]
fn records_are_served_as_json_csv_parquet() {
    let running = Running::shared();
    let at = running.at;
    let which = "?robot=demo-1&joint=elbow&most=50";
    let records = get(at, &format!("/api/v1/records{which}")).json();
    assert_eq!(records["schema"], "sinew-record/2");
    let records = records["records"].as_array().unwrap().clone();
    assert_eq!(records.len(), 50);
    let csv = get(at, &format!("/api/v1/records.csv{which}"));
    assert_eq!(
        csv.header("content-disposition"),
        Some("attachment; filename=\"records.csv\"")
    );
    let text = csv.text();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(head, sinew_watch::store::COLUMNS);
    assert_eq!(lines.count(), 50);
    let parquet = get(at, &format!("/api/v1/records.parquet{which}"));
    assert!(parquet.body.starts_with(b"PAR1") && parquet.body.ends_with(b"PAR1"));
    let times: Vec<f64> = records
        .iter()
        .map(|r| r["time_utc_s"].as_f64().unwrap())
        .collect();
    assert!(times.is_sorted());
}

#[test]
fn sessions_csv_is_input_of_trend() {
    let running = Running::shared();
    let at = running.at;
    let table = get(at, "/api/v1/robots/demo-1/sessions.csv");
    assert_eq!(table.status, 200, "{}", table.text());
    let rows = sinew_trend::records_from_csv(&table.text(), "sessions.csv").unwrap();
    let records = get(at, "/api/v1/records?robot=demo-1&most=100000").json();
    let records = records["records"].as_array().unwrap();
    assert!(rows.len() > 100, "{}", rows.len());
    // Each row is one of the records, and each day of a tendon occurs once per tensioning.
    let mut days = std::collections::BTreeSet::new();
    for row in &rows {
        let offset = row.offset_rad.unwrap();
        let same = records.iter().any(|r| {
            let near =
                |name: &str, x: f64| (r[name].as_f64().unwrap_or(f64::NAN) - x).abs() < 1e-12;
            r["joint"] == row.joint.as_str()
                && (r["time_utc_s"].as_f64().unwrap() - row.time_utc_s).abs() < 1e-3
                && near("offset_rad", offset.mean)
                && near("offset_std_rad", offset.std)
        });
        assert!(same, "{row:?}");
        assert_eq!(row.robot.as_deref(), Some("biorob-like"));
        let day = (row.time_utc_s / 86_400.0).floor() as i64;
        assert!(
            days.insert((row.joint.clone(), row.baseline.clone(), day)),
            "{row:?}"
        );
    }
    assert_eq!(get(at, "/api/v1/robots/nobody/sessions.csv").status, 404);
}

#[test]
fn due_list_matches_tendon_trends() {
    let running = Running::shared();
    let at = running.at;
    // Another test re-tensions a tendon of demo-2, which is inconclusive then.
    running.until(|r| {
        let list = get(r.at, "/api/v1/due").json();
        list["inconclusive"].as_u64().is_some_and(|n| n <= 1)
    });
    let list = get(at, "/api/v1/due?within_days=200").json();
    let rows = list["due"].as_array().unwrap();
    assert!(!rows.is_empty(), "{list}");
    let count = |key: &str| list[key].as_u64().unwrap();
    let all = rows.len() as u64 + count("not_due") + count("inconclusive") + count("without_limit");
    assert_eq!(all, 12, "{list}");
    let span_s = list["until_utc_s"].as_f64().unwrap() - list["time_utc_s"].as_f64().unwrap();
    assert!((span_s - 200.0 * 86_400.0).abs() < 1.0);
    let is_passed = |row: &Value| row["state"] == "passed";
    let to_come = rows.iter().filter(|row| !is_passed(row));
    let days: Vec<f64> = to_come.filter_map(|row| row["after_s"].as_f64()).collect();
    assert!(rows.is_sorted_by_key(|row| !is_passed(row)) && days.is_sorted());
    for row in rows {
        let low = row["at_low_utc_s"].as_f64().unwrap();
        assert!(is_passed(row) || low <= list["until_utc_s"].as_f64().unwrap());
        // demo-3 is switched off: its trends do not change.
        if row["robot"] != "demo-3" {
            continue;
        }
        let joint = row["joint"].as_str().unwrap();
        let tendon = get(at, &format!("/api/v1/robots/demo-3/tendons/{joint}")).json();
        let limits = tendon["trend"]["limits"].as_array().unwrap().iter();
        let limit = limits
            .clone()
            .find(|l| l["kind"] == row["limit"]["kind"])
            .unwrap();
        for key in [
            "limit_rad",
            "state",
            "at_utc_s",
            "at_low_utc_s",
            "at_high_utc_s",
        ] {
            assert_eq!(row[key], limit[key], "{row}: {limit}");
        }
        assert_eq!(row["offset_rad"], tendon["trend"]["offset_rad"]);
    }
    assert!(rows.iter().any(|row| row["robot"] == "demo-3"), "{list}");
    // A longer horizon contains at least as many.
    let longer = get(at, "/api/v1/due?within_days=1095").json();
    assert!(longer["due"].as_array().unwrap().len() >= rows.len());
    for (asked, status) in [
        ("within_days=0", 422),
        ("within_days=-1", 422),
        ("within_days=NaN", 422),
        ("within_days=1096", 422),
        ("within_days=soon", 400),
        ("days=3", 400),
    ] {
        assert_eq!(
            get(at, &format!("/api/v1/due?{asked}")).status,
            status,
            "{asked}"
        );
    }
}

#[test]
fn metrics_match_list_with_unique_types() {
    let running = Running::shared();
    running.until(|r| {
        get(r.at, "/metrics")
            .text()
            .contains("sinew_tendon_offset_radians{")
    });
    let text = get(running.at, "/metrics").text();
    let known: Vec<&str> = ABOUT.iter().map(|about| about.0).collect();
    let (mut types, mut samples) = (Vec::new(), BTreeSet::new());
    for line in text.lines() {
        if let Some(rest) = line.strip_prefix("# TYPE ") {
            types.push(rest.split(' ').next().unwrap().to_owned());
        } else if !line.starts_with('#') {
            let (series, value) = line.rsplit_once(' ').unwrap();
            assert!(samples.insert(series.to_owned()), "{series} twice");
            assert!(value.parse::<f64>().is_ok(), "{line}");
            let name = series.split('{').next().unwrap();
            assert_eq!(types.last().map(String::as_str), Some(name), "{line}");
        }
    }
    let once: BTreeSet<&String> = types.iter().collect();
    assert_eq!(once.len(), types.len());
    assert!(types.iter().all(|name| known.contains(&name.as_str())));
    assert!(samples.contains("sinew_robots"), "{text}");
    // Base units and suffixes as required by Prometheus.
    for (name, kind, about) in ABOUT {
        assert_eq!(name.ends_with("_total"), *kind == "counter", "{name}");
        assert!(about.ends_with('.') && !name.contains("_mrad"), "{name}");
    }
}

#[test]
fn page_is_compressed_and_complete() {
    let running = Running::shared();
    let mut packed = 0;
    for path in ["/", "/app.js", "/stream.js", "/app.css", "/icon.svg"] {
        let plain = get(running.at, path);
        let small = ask(
            running.at,
            "GET",
            path,
            &[("accept-encoding", "gzip, br")],
            None,
        );
        assert_eq!(
            (plain.status, small.header("content-encoding")),
            (200, Some("gzip"))
        );
        let mut unpacked = Vec::new();
        let mut reader = flate2::read::GzDecoder::new(&small.body[..]);
        std::io::Read::read_to_end(&mut reader, &mut unpacked).unwrap();
        assert_eq!(unpacked, plain.body, "{path}");
        packed += small.body.len();
        let tag = plain.header("etag").unwrap();
        let again = ask(running.at, "GET", path, &[("if-none-match", tag)], None);
        assert_eq!((again.status, again.body.len()), (304, 0));
    }
    assert!(packed < 60_000, "{packed} bytes");
    for path in [
        "/due",
        "/alarms",
        "/journal",
        "/r/demo-1",
        "/r/demo-1/elbow",
    ] {
        assert_eq!(get(running.at, path).text(), get(running.at, "/").text());
    }
    assert_eq!(get(running.at, "/nowhere").status, 404);
}

fn token(name: &str, role: Role, secret: &str) -> Token {
    Token {
        name: name.into(),
        role,
        secret: secret.into(),
    }
}

/// Serves the pages of a store, with tokens and receivers of notifications.
pub(crate) fn served(place: &Place, tokens: Vec<Token>, receivers: Vec<Receiver>) -> SocketAddr {
    let settings = WebSettings::default();
    let (registry, health) = (Arc::new(RobotRegistry::default()), Arc::new(Health::new(1)));
    for n in 0..12 {
        registry.slot(&format!("arm-{n}"));
    }
    let guard = Guard::new(&settings, tokens, place, Arc::clone(&health));
    let mut ticker = Ticker::new(Arc::clone(&registry), Arc::clone(&health), None);
    let (tell, ticks) = tokio::sync::watch::channel(Arc::new(ticker.tick(1.8e9)));
    let (_receivers, receivers) = tokio::sync::watch::channel(receivers);
    let app = App::new((registry, health), guard, ticks, receivers, place.clone());
    let (sender, address) = channel();
    std::thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .unwrap();
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
            sender.send(listener.local_addr().unwrap()).unwrap();
            tokio::spawn(async move {
                loop {
                    tokio::time::sleep(Duration::from_millis(50)).await;
                    tell.send_replace(Arc::new(ticker.tick(1.8e9)));
                }
            });
            let (_ends, ended) = tokio::sync::watch::channel(false);
            sinew_watch::web::serve(listener, router(app), ended).await;
        });
    });
    address.recv().unwrap()
}

const TOKEN: &str = "0123456789abcdef0123456789abcdef";

fn operators() -> Vec<Token> {
    vec![token("web-token", Role::Operate, TOKEN)]
}

/// Store in memory that exists as long as the process.
pub(crate) fn store_in_memory(number: u64) -> Place {
    let place = Place::Memory(number);
    std::mem::forget(Store::open(place.clone()).unwrap());
    place
}

#[test]
fn logout_ends_the_login_on_the_server() {
    let at = served(&store_in_memory(9_000_001), operators(), Vec::new());
    assert_eq!(get(at, "/api/v1/fleet").status, 401);
    let login = post(at, "/login", &json!({ "token": TOKEN }).to_string());
    assert_eq!(login.status, 200);
    let cookies = login
        .headers
        .iter()
        .filter(|(name, _)| name == "set-cookie");
    let cookies: Vec<&str> = cookies
        .map(|(_, value)| value.split(';').next().unwrap())
        .collect();
    let cookie = cookies.join("; ");
    let fleet = || ask(at, "GET", "/api/v1/fleet", &[("cookie", &cookie)], None).status;
    assert_eq!(fleet(), 200, "{cookie}");
    let headers = [
        ("content-type", "application/json"),
        ("x-sinew", "1"),
        ("cookie", cookie.as_str()),
    ];
    let stream = std::net::TcpStream::connect(at).unwrap();
    let request = format!("GET /api/v1/events HTTP/1.1\r\nhost: {at}\r\ncookie: {cookie}\r\n\r\n");
    (&stream).write_all(request.as_bytes()).unwrap();
    let mut events = std::io::BufReader::new(stream).lines();
    assert!(events.any(|line| line.unwrap().starts_with("event: change")));
    assert_eq!(ask(at, "POST", "/logout", &headers, Some("{}")).status, 200);
    // An open stream of the login ends.
    let ends = events.position(|line| line.unwrap() == "0");
    assert!(ends.is_some());
    // The cookie itself, kept by somebody, opens nothing any more.
    assert_eq!(fleet(), 401);
}

#[test]
fn wrong_tokens_cost_time_and_end_in_exclusion() {
    let at = served(&store_in_memory(9_000_002), operators(), Vec::new());
    let wrong = json!({ "token": "wrong" }).to_string();
    let begun = Instant::now();
    assert_eq!(post(at, "/login", &wrong).status, 401);
    assert!(begun.elapsed() >= Duration::from_millis(500));
    // The same for a token in the header, and for attempts at the same time.
    let header = [("authorization", "Bearer wrong")];
    let attempts: Vec<_> = (0..9)
        .map(|_| std::thread::spawn(move || ask(at, "GET", "/api/v1/fleet", &header, None).status))
        .collect();
    for attempt in attempts {
        assert_eq!(attempt.join().unwrap(), 401);
    }
    assert_eq!(post(at, "/login", &wrong).status, 429);
    let right = format!("Bearer {TOKEN}");
    let right = [("authorization", right.as_str())];
    assert_eq!(ask(at, "GET", "/api/v1/fleet", &right, None).status, 429);
}

#[test]
fn reader_token_reads_but_does_not_operate() {
    const READER: &str = "fedcba9876543210fedcba9876543210";
    let mut tokens = operators();
    tokens.push(token("hall", Role::Read, READER));
    let at = served(&store_in_memory(9_000_004), tokens, Vec::new());
    let note = json!({ "who": "x", "note": "x", "what": { "kind": "note" } }).to_string();
    let commands = "/api/v1/robots/nobody/commands";
    let status = |secret: &str, method: &str, path: &str, body: Option<&str>| {
        let bearer = format!("Bearer {secret}");
        let headers = [
            ("authorization", bearer.as_str()),
            ("content-type", "application/json"),
            ("x-sinew", "1"),
        ];
        let answer = ask(at, method, path, &headers, body);
        (answer.status, answer.text())
    };
    for secret in [TOKEN, READER] {
        assert_eq!(status(secret, "GET", "/api/v1/fleet", None).0, 200);
        assert_eq!(status(secret, "GET", "/metrics", None).0, 200);
    }
    // The operator passes the access control: the robot and the receiver do not exist.
    assert_eq!(status(TOKEN, "POST", commands, Some(&note)).0, 404);
    assert_eq!(
        status(TOKEN, "POST", "/api/v1/notify/test", Some("{}")).0,
        409
    );
    for (path, body) in [(commands, note.as_str()), ("/api/v1/notify/test", "{}")] {
        let (status, text) = status(READER, "POST", path, Some(body));
        assert!(
            status == 403 && text.contains("role operate"),
            "{status} {text}"
        );
    }
    // The same with the cookie of a login, which names the role for the page.
    for (secret, role, expected) in [(TOKEN, "operate", 409), (READER, "read", 403)] {
        let login = post(at, "/login", &json!({ "token": secret }).to_string());
        let cookies = login
            .headers
            .iter()
            .filter(|(name, _)| name == "set-cookie");
        let cookies: Vec<&str> = cookies
            .map(|(_, value)| value.split(';').next().unwrap())
            .collect();
        assert_eq!(cookies[1], format!("sinew_watch_open={role}"));
        let headers = [
            ("content-type", "application/json"),
            ("x-sinew", "1"),
            ("cookie", cookies[0]),
        ];
        let answer = ask(at, "POST", "/api/v1/notify/test", &headers, Some("{}"));
        assert_eq!(answer.status, expected, "{}", answer.text());
    }
}

/// Receives one request, answers with this status, and returns the request.
fn receiver(status: &'static str) -> (u16, std::thread::JoinHandle<String>) {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let thread = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut reader = std::io::BufReader::new(stream.try_clone().unwrap());
        let (mut text, mut length) = (String::new(), 0);
        loop {
            let mut line = String::new();
            reader.read_line(&mut line).unwrap();
            if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                length = value.trim().parse().unwrap();
            }
            text += &line;
            if line.trim().is_empty() {
                break;
            }
        }
        let mut body = vec![0; length];
        reader.read_exact(&mut body).unwrap();
        write!(stream, "HTTP/1.1 {status}\r\ncontent-length: 0\r\n\r\n").unwrap();
        text + &String::from_utf8(body).unwrap()
    });
    (port, thread)
}

fn hook(port: u16, format: PostFormat) -> Receiver {
    Receiver::Webhook(Webhook {
        tls: false,
        host: "127.0.0.1".into(),
        port,
        path: "/alarms".into(),
        format,
        severity_min: 1,
        token_file: None,
        ca_file: None,
    })
}

#[test]
fn test_notifications_are_posted_and_reported() {
    let place = store_in_memory(9_000_003);
    let none = served(&place, Vec::new(), Vec::new());
    assert_eq!(post(none, "/api/v1/notify/test", "{}").status, 409);
    let [ntfy, slack, refused] = ["200 OK", "200 OK", "403 Forbidden"].map(receiver);
    let hooks = vec![
        hook(ntfy.0, PostFormat::Ntfy),
        hook(slack.0, PostFormat::Slack),
        hook(refused.0, PostFormat::Sinew),
    ];
    let at = served(&place, Vec::new(), hooks);
    let answer = post(at, "/api/v1/notify/test", "{}").json();
    let errors: Vec<&Value> = (0..3).map(|k| &answer["results"][k]["error"]).collect();
    assert_eq!(
        errors,
        [&Value::Null, &Value::Null, &json!("response 403 Forbidden")]
    );
    let ntfy = ntfy.1.join().unwrap();
    assert!(
        ntfy.contains("title: Sinew: test") && ntfy.ends_with("no action required"),
        "{ntfy}"
    );
    let slack = slack.1.join().unwrap();
    assert!(
        slack.ends_with("{\"text\":\"Test notification of Sinew watch; no action required\"}"),
        "{slack}"
    );
}

#[test]
fn series_reaches_every_year_of_the_demonstration() {
    let at = Running::shared().at;
    let path = "/api/v1/robots/demo-1/tendons/elbow/series";
    let series = get(at, &format!("{path}?intervals=20")).json();
    let points = series["points"].as_array().unwrap();
    assert!(
        points.len() <= 60 && series["records"].as_u64().unwrap() > 60,
        "{series}"
    );
    let first = series["first_utc_s"].as_f64().unwrap();
    let month = get(
        at,
        &format!(
            "{path}?from_utc_s={first}&to_utc_s={}",
            first + 30.0 * 86_400.0
        ),
    );
    let month = month.json();
    assert!(month["interval_s"].is_null(), "{month}");
    assert_eq!(
        month["points"].as_array().unwrap().len() as u64,
        month["records"].as_u64().unwrap()
    );
    assert_eq!(month["points"][0]["time_utc_s"], first);
    assert_eq!(
        get(at, "/api/v1/robots/nobody/tendons/elbow/series").status,
        404
    );
    // Pages of records lead to the first one.
    let records = |query: &str| {
        get(
            at,
            &format!("/api/v1/records?robot=demo-1&joint=elbow{query}"),
        )
        .json()
    };
    let (mut before, mut times) = (String::new(), Vec::new());
    loop {
        let page = records(&format!("&most=50{before}"));
        let page_times = page["records"].as_array().unwrap().iter();
        times.extend(page_times.map(|r| r["time_utc_s"].as_f64().unwrap()));
        let Some(older) = page["older"].as_i64() else {
            break;
        };
        before = format!("&before={older}");
    }
    assert!(
        times.contains(&first) && times.len() > 100,
        "{}",
        times.len()
    );
    assert_eq!(records("&most=0")["records"], json!([]));
    assert_eq!(get(at, "/api/v1/records?before=999999999").status, 422);
}

#[test]
fn calendar_has_an_event_for_every_due_tendon() {
    let at = Running::shared().at;
    let calendar = get(at, "/api/v1/due.ics?within_days=1095");
    assert!(
        calendar
            .header("content-type")
            .unwrap()
            .starts_with("text/calendar")
    );
    let text = calendar.text();
    assert!(
        text.starts_with("BEGIN:VCALENDAR\r\nVERSION:2.0\r\n")
            && text.ends_with("END:VCALENDAR\r\n")
    );
    let due = get(at, "/api/v1/due?within_days=1095").json();
    let count = |line: &str| text.lines().filter(|l| l.starts_with(line)).count();
    assert_eq!(
        count("DTSTART;VALUE=DATE:2"),
        due["due"].as_array().unwrap().len()
    );
    assert_eq!(count("BEGIN:VEVENT"), count("END:VEVENT"));
}

#[test]
fn latched_alarm_is_posted_as_active() {
    let entry = |from, to| Entry {
        time_utc_s: 1.8e9,
        event: Event::Alarm {
            transition: Transition {
                key: AlarmKey {
                    joint: Some("elbow".into()),
                    condition: Condition::StepChange,
                },
                from,
                to,
                time_utc_s: 1.8e9,
                reason: TransitionReason::ShelfEnded,
            },
        },
    };
    use AlarmState::{Acknowledged, Active, Latched, Normal};
    let active = |from, to| Post::of("arm", &entry(from, to)).map(|post| post.active);
    assert_eq!(active(Normal, Active), Some(true));
    // Raised and latched within milliseconds: one message, not one that seems to end the alarm.
    assert_eq!(active(Active, Latched), None);
    assert_eq!(active(Acknowledged, Latched), None);
    // Acknowledged while latched: still active.
    assert_eq!(active(Latched, Latched), Some(true));
    assert_eq!(active(Latched, Normal), Some(false));
}

/// Peak memory of requests for all records of the store in `SINEW_MILLION` (tests/store.rs writes it): 12 at the same time.
#[test]
#[cfg(target_os = "linux")]
fn million_records_take_little_memory() {
    let Some(folder) = std::env::var_os("SINEW_MILLION") else {
        return;
    };
    let at = served(&Place::Folder(folder.into()), Vec::new(), Vec::new());
    let peak_mb = || {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status
            .lines()
            .find(|line| line.starts_with("VmHWM"))
            .unwrap();
        1e-3 * line
            .split_whitespace()
            .nth(1)
            .unwrap()
            .parse::<f64>()
            .unwrap()
    };
    let before = peak_mb();
    let read = |path: String| {
        std::thread::spawn(move || {
            // Read without being kept.
            let mut stream = std::net::TcpStream::connect(at).unwrap();
            write!(
                stream,
                "GET {path} HTTP/1.1\r\nhost: {at}\r\nconnection: close\r\n\r\n"
            )
            .unwrap();
            std::io::copy(&mut stream, &mut std::io::sink()).unwrap()
        })
    };
    for (name, paths) in [
        (
            "json",
            (0..12)
                .map(|_| "/api/v1/records?most=100000".to_owned())
                .collect(),
        ),
        (
            "robot",
            (0..12)
                .map(|n| format!("/api/v1/records?robot=arm-{n}&joint=elbow&most=100000"))
                .collect(),
        ),
        (
            "csv",
            (0..12).map(|_| "/api/v1/records.csv".to_owned()).collect(),
        ),
        (
            "parquet",
            (0..12)
                .map(|_| "/api/v1/records.parquet".to_owned())
                .collect(),
        ),
        (
            "series",
            (0..12)
                .map(|n| format!("/api/v1/robots/arm-{n}/tendons/elbow/series"))
                .collect::<Vec<_>>(),
        ),
    ] {
        let begun = Instant::now();
        let reading: Vec<_> = paths.into_iter().map(read).collect();
        let bytes: u64 = reading.into_iter().map(|r| r.join().unwrap()).sum();
        let took = begun.elapsed();
        eprintln!(
            "{name}: {:.0} MB in {took:.1?}, peak {:.0} MB (before {before:.0} MB)",
            1e-6 * bytes as f64,
            peak_mb()
        );
    }
    assert!(peak_mb() < 512.0);
}
