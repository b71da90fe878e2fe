//! Zenoh transport against a router and a robot of the same library. External programs: `scripts/transports`.

use crate::support::{Came, MS, PATIENCE, START_NS, STATE, state};
use sinew_log::decode::{Field, MessageKind, parse};
use sinew_log::encode::{DynamicJointState, Header, InterfaceValue, Message as _, Text};
use sinew_log::live::LiveOptions;
use sinew_transport::zenoh::{self as transport, ZenohOptions};
use sinew_transport::{
    Clock, Durability, FrameAssembler, Inbox, Outgoing, PublisherLoss, Publishing, QueueLimits,
    RobotId, Route, Routes, TransportFault,
};
use std::net::TcpListener;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::{Config, Session, Wait as _};

const STATE_KEY: &str = "arm7/joint_states/sensor_msgs::msg::dds_::JointState_/RIHS01_a1";
const TEXT_KEY: &str = "arm7/robot_description/std_msgs::msg::dds_::String_/RIHS01_d6";

/// Returns an unused endpoint.
fn free() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    format!("tcp/{}", listener.local_addr().unwrap())
}

fn session(mode: &str, connect: Option<&str>, listen: Option<&str>) -> Session {
    let list = |one: Option<&str>| one.map_or("[]".to_owned(), |one| format!("[{one:?}]"));
    let mut config = Config::default();
    for (key, value) in [
        ("mode", format!("{mode:?}")),
        ("connect/endpoints", list(connect)),
        ("listen/endpoints", list(listen)),
        ("scouting/multicast/enabled", "false".to_owned()),
    ] {
        config.insert_json5(key, &value).unwrap();
    }
    zenoh::open(config).wait().unwrap()
}

/// Publisher with its token.
struct Writer<'a> {
    publisher: Publisher<'a>,
    token: LivelinessToken,
}

fn writer<'a>(robot: &Session, domain: u16, entity: u16, key: &str, qos: &str) -> Writer<'a> {
    let whole = format!("{domain}/{key}");
    let [_hash, kind, topic] = key.rsplitn(3, '/').collect::<Vec<_>>()[..] else {
        panic!("{key}")
    };
    let topic = topic.replace('/', "%");
    let zid = robot.zid();
    let token = format!(
        "@ros2_lv/{domain}/{zid}/0/{entity}/MP/%/%arm7/driver/%{topic}/{kind}/RIHS01_a1/{qos}"
    );
    Writer {
        publisher: robot.declare_publisher(whole).wait().unwrap(),
        token: robot.liveliness().declare_token(token).wait().unwrap(),
    }
}

/// Queue for joint `a`, with the routes that fill it.
struct Receiver {
    inbox: Inbox,
    robot: RobotId,
    options: LiveOptions,
    routes: Routes,
}

fn receiver(namespace: &str) -> Receiver {
    let options = LiveOptions {
        namespace: namespace.to_owned(),
        ..LiveOptions::of_joints(&["a".to_owned()])
    };
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let routes = Routes::new(vec![Route::new(sender, &options)]);
    Receiver {
        inbox,
        robot,
        options,
        routes,
    }
}

fn listening(domain: u16, router: &str) -> ZenohOptions {
    ZenohOptions {
        domain,
        connect: vec![router.to_owned()],
        publishing: Publishing::DISABLED,
        ..ZenohOptions::default()
    }
}

/// Repeats `enough` until it returns true.
#[track_caller]
fn until(what: &str, mut enough: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !enough() {
        assert!(begun.elapsed() < PATIENCE, "timeout: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn zenoh_reconnects_after_router_restart() {
    let endpoint = free();
    let receiver = receiver("/arm7");
    let options = listening(3, &endpoint);
    let (transport, _publisher) =
        transport::open(&options, &receiver.routes, Clock::start()).unwrap();
    let mut came = Came::default();
    let is_disconnected = |t: &TransportFault| matches!(t, TransportFault::Disconnected { reason, .. } if reason.contains(&endpoint));
    let is_connected = |t: &TransportFault| matches!(t, TransportFault::Connected { .. });
    let count = |came: &Came, is: &dyn Fn(&TransportFault) -> bool| {
        came.faults.iter().filter(|t| is(t)).count()
    };
    came.until(&receiver.inbox, receiver.robot, |came| {
        count(came, &is_disconnected) == 1
    });
    assert!(
        transport
            .status()
            .disconnected
            .unwrap()
            .contains("no router or peer")
    );

    let router = session("router", None, Some(&endpoint));
    came.until(&receiver.inbox, receiver.robot, |came| {
        count(came, &is_connected) == 1
    });
    assert_eq!(transport.status().disconnected, None);
    let robot = session("client", Some(&endpoint), None);
    let states = writer(&robot, 3, 1, STATE_KEY, "::,10:,:,:,,");
    let is_found = |t: &TransportFault| matches!(t, TransportFault::PublisherFound { topic, publisher } if topic == "/arm7/joint_states" && publisher.starts_with("/arm7/driver ("));
    came.until(&receiver.inbox, receiver.robot, |came| {
        count(came, &is_found) == 1
    });
    let mut step = 0;
    let mut send = |states: &Writer<'_>| {
        states
            .publisher
            .put(state(START_NS + step * MS, 0.5))
            .wait()
            .unwrap();
        step += 1;
    };
    until("a message", || {
        send(&states);
        transport.status().messages > 20
    });
    came.until(&receiver.inbox, receiver.robot, |came| {
        came.stamps.len() > 20
    });
    assert_eq!(came.topics, ["/arm7/joint_states"]);
    assert!(came.stamps.is_sorted());

    // A message that is no CDR, or too long, is reported and not forwarded.
    states.publisher.put([9_u8, 9, 9, 9, 9]).wait().unwrap();
    let long = vec![0_u8; options.max_message_bytes + 1];
    states.publisher.put(long).wait().unwrap();
    let is_unread =
        |t: &TransportFault| matches!(t, TransportFault::Unreadable { messages: 1, .. });
    let is_long = |t: &TransportFault| matches!(t, TransportFault::TooLong { bytes, .. } if *bytes == (4 << 20) + 1);
    came.until(&receiver.inbox, receiver.robot, |came| {
        count(came, &is_unread) == 1 && count(came, &is_long) == 1
    });

    // A publisher signs off.
    states.token.undeclare().wait().unwrap();
    let is_lost = |t: &TransportFault| {
        matches!(
            t,
            TransportFault::PublisherLost {
                how: PublisherLoss::SignedOff,
                ..
            }
        )
    };
    came.until(&receiver.inbox, receiver.robot, |came| {
        count(came, &is_lost) == 1
    });

    robot.close().wait().unwrap();
    router.close().wait().unwrap();
    came.until(&receiver.inbox, receiver.robot, |came| {
        count(came, &is_disconnected) == 2
    });
    let before = transport.status().messages;
    let _router = session("router", None, Some(&endpoint));
    came.until(&receiver.inbox, receiver.robot, |came| {
        count(came, &is_connected) == 2
    });
    let robot = session("client", Some(&endpoint), None);
    let states = writer(&robot, 3, 1, STATE_KEY, "::,10:,:,:,,");
    until("a message after the router came back", || {
        send(&states);
        transport.status().messages > before + 20
    });
}

#[test]
fn zenoh_earlier_description_is_queried() {
    let endpoint = free();
    let _router = session("router", None, Some(&endpoint));
    let robot = session("client", Some(&endpoint), None);
    let text = format!(
        "<robot name=\"arm7\"><!--{}--></robot>",
        "x".repeat(400_000)
    );
    let mut cdr = Vec::new();
    Text { data: &text }.encode(&mut cdr).unwrap();
    // Kept as by present publishers.
    let kept = format!("0/{TEXT_KEY}");
    let of_query = kept.clone();
    let _keeps = robot
        .declare_queryable(format!("{kept}/@adv/pub/{}/7/_", robot.zid()))
        .callback(move |query| query.reply(of_query.as_str(), cdr.clone()).wait().unwrap())
        .wait()
        .unwrap();
    let _described = writer(&robot, 0, 2, TEXT_KEY, ":1:,1:,:,:,,");
    let states = writer(&robot, 0, 1, STATE_KEY, "::,10:,:,:,,");

    let receiver = receiver("/arm7");
    let options = listening(0, &endpoint);
    let (_transport, _publisher) =
        transport::open(&options, &receiver.routes, Clock::start()).unwrap();
    let mut intake = FrameAssembler::new(&receiver.options).unwrap();
    let mut batch = Default::default();
    until("the description", || {
        states.publisher.put(state(START_NS, 0.0)).wait().unwrap();
        if receiver.inbox.wait(Duration::from_millis(5)).is_some() {
            receiver.inbox.take(receiver.robot, &mut batch);
            intake.feed(&batch, |_| {});
        }
        intake.live().descriptions() > 0
    });
    assert_eq!(intake.live().robot_description(), Some(text.as_str()));
}

#[test]
fn zenoh_discover_finds_robot_and_publishers() {
    let endpoint = free();
    let _router = session("router", None, Some(&endpoint));
    let robot = session("client", Some(&endpoint), None);
    let states = writer(&robot, 12, 1, STATE_KEY, "2::,10:,:,:,,");
    let options = listening(12, &endpoint);
    until("the domain", || {
        transport::active_domains(&options).unwrap() == [12]
    });

    let stop = std::sync::atomic::AtomicBool::new(false);
    let found = std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut step = 0;
            while !stop.load(std::sync::atomic::Ordering::Relaxed) {
                states
                    .publisher
                    .put(state(START_NS + step * MS, 0.0))
                    .wait()
                    .unwrap();
                std::thread::sleep(Duration::from_millis(2));
                step += 2;
            }
        });
        let found = transport::discover(&options, Clock::start(), Duration::from_secs(2));
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
        found.unwrap()
    });
    assert_eq!(found.transport, "zenoh:12");
    let [topic] = &found.topics[..] else {
        panic!("{:?}", found.topics)
    };
    assert_eq!(
        (topic.topic.name.as_str(), topic.topic.kind.as_str()),
        ("/arm7/joint_states", STATE)
    );
    assert!(topic.topic.messages > 10, "{topic:?}");
    let [publisher] = &topic.publishers[..] else {
        panic!("{topic:?}")
    };
    assert_eq!(publisher.name.as_deref(), Some("/arm7/driver"));
    assert_eq!(publisher.durability, Some(Durability::Volatile));
    assert_eq!(found.robots[0].namespace, "/arm7");
}

#[test]
fn zenoh_publish_matches_rmw_zenoh_format() {
    let endpoint = free();
    let _router = session("router", None, Some(&endpoint));
    let reader = session("client", Some(&endpoint), None);
    let (send, messages) = channel();
    let _reads = reader
        .declare_subscriber("0/**")
        .callback(move |sample| drop(send.send(sample)))
        .wait()
        .unwrap();
    let (token_sender, tokens) = channel();
    let _tokens = reader
        .liveliness()
        .declare_subscriber("@ros2_lv/0/**")
        .history(true)
        .callback(move |sample| drop(token_sender.send(sample.key_expr().to_string())))
        .wait()
        .unwrap();

    let receiver = receiver("/arm7");
    let options = ZenohOptions {
        publishing: Publishing {
            diagnostics: false,
            tendons: true,
        },
        ..listening(0, &endpoint)
    };
    let (_transport, mut publisher) =
        transport::open(&options, &receiver.routes, Clock::start()).unwrap();
    let names = ["a".to_owned()];
    let values = [InterfaceValue {
        interface_names: &["offset"],
        values: &[0.0127],
    }];
    let state = DynamicJointState {
        header: Header::at(START_NS, "").unwrap(),
        joint_names: &names,
        interface_values: &values,
    };
    let namespace = "/arm7";
    let tendons = Outgoing::Tendons { namespace, state };
    let mut samples = Vec::new();
    until("what is published", || {
        publisher.publish(&tendons).unwrap();
        samples.extend(messages.try_iter());
        samples.len() >= 2
    });
    let key = samples[0].key_expr().to_string();
    assert!(
        key.starts_with(
            "0/arm7/sinew/tendons/control_msgs::msg::dds_::DynamicJointState_/RIHS01_18024c"
        ),
        "{key}"
    );
    let cdr = samples[0].payload().to_bytes();
    let parsed = parse(MessageKind::DynamicJointState, &cdr).unwrap();
    assert_eq!(parsed.entries[0].field, Field::Interface(b"offset"));
    // Numbered, time-stamped, and with one identity.
    let attached: Vec<Vec<u8>> = samples
        .iter()
        .map(|s| s.attachment().unwrap().to_bytes().to_vec())
        .collect();
    let number = |bytes: &[u8]| i64::from_le_bytes(bytes[..8].try_into().unwrap());
    assert_eq!(attached[0].len(), 33);
    assert_eq!(number(&attached[1]), number(&attached[0]) + 1);
    assert_eq!(attached[0][16..], attached[1][16..]);
    let mut declared = Vec::new();
    until("both tokens", || {
        declared.extend(tokens.try_iter());
        declared.len() == 2
    });
    assert!(
        declared.iter().any(|key| key.ends_with("/NN/%/%/sinew")),
        "{declared:?}"
    );
    assert!(
        declared
            .iter()
            .any(|key| key.contains("/MP/%/%/sinew/%arm7%sinew%tendons/")),
        "{declared:?}"
    );
}

#[test]
fn zenoh_check_without_router_names_endpoint() {
    let endpoint = free();
    let error = transport::check(&listening(0, &endpoint))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains(&endpoint) && error.contains("no router or peer"),
        "{error}"
    );
    let _router = session("router", None, Some(&endpoint));
    transport::check(&listening(0, &endpoint)).unwrap();
}
