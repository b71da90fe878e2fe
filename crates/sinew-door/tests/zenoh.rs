//! The door to Zenoh against a router and a robot of the same library. Other people's programs: `scripts/doors`.

use crate::support::{Came, MS, PATIENCE, START_NS, STATE, state};
use sinew_door::zenoh::{self as door, ZenohOptions};
use sinew_door::{
    Clock, Durability, Inbox, Intake, Lost, Outgoing, Publishing, QueueLimits, RobotId, Route,
    Routes, Trouble,
};
use sinew_log::decode::{Field, MessageKind, parse};
use sinew_log::encode::{DynamicJointState, Header, InterfaceValue, Message as _, Text};
use sinew_log::live::LiveOptions;
use std::net::TcpListener;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::{Config, Session, Wait as _};

const STATE_KEY: &str = "arm7/joint_states/sensor_msgs::msg::dds_::JointState_/RIHS01_a1";
const TEXT_KEY: &str = "arm7/robot_description/std_msgs::msg::dds_::String_/RIHS01_d6";

/// An endpoint at which nobody listens.
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

/// A publisher with its token.
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

/// A queue for joint `a`, and a door of which it gets the messages.
struct Heard {
    inbox: Inbox,
    robot: RobotId,
    options: LiveOptions,
    routes: Routes,
}

fn heard(namespace: &str) -> Heard {
    let options = LiveOptions {
        namespace: namespace.to_owned(),
        ..LiveOptions::of_joints(&["a".to_owned()])
    };
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let routes = Routes::new(vec![Route::new(sender, &options)]);
    Heard {
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
        publishing: Publishing::NOTHING,
        ..ZenohOptions::default()
    }
}

/// Publishes until `enough`.
#[track_caller]
fn until(what: &str, mut enough: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !enough() {
        assert!(begun.elapsed() < PATIENCE, "{what} never came");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_robot_is_heard_through_a_router_that_goes_and_comes_back() {
    let endpoint = free();
    let heard = heard("/arm7");
    let options = listening(3, &endpoint);
    let (door, _silent) = door::open(&options, &heard.routes, Clock::start()).unwrap();
    let mut came = Came::default();
    let is_shut = |t: &Trouble| matches!(t, Trouble::Shut { why, .. } if why.contains(&endpoint));
    let is_open = |t: &Trouble| matches!(t, Trouble::Open { .. });
    let count =
        |came: &Came, is: &dyn Fn(&Trouble) -> bool| came.troubles.iter().filter(|t| is(t)).count();
    came.until(&heard.inbox, heard.robot, |came| count(came, &is_shut) == 1);
    assert!(door.status().shut.unwrap().contains("no router or peer"));

    let router = session("router", None, Some(&endpoint));
    came.until(&heard.inbox, heard.robot, |came| count(came, &is_open) == 1);
    assert_eq!(door.status().shut, None);
    let robot = session("client", Some(&endpoint), None);
    let states = writer(&robot, 3, 1, STATE_KEY, "::,10:,:,:,,");
    let is_there = |t: &Trouble| matches!(t, Trouble::PublisherFound { topic, publisher } if topic == "/arm7/joint_states" && publisher.starts_with("/arm7/driver ("));
    came.until(&heard.inbox, heard.robot, |came| {
        count(came, &is_there) == 1
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
        door.status().messages > 20
    });
    came.until(&heard.inbox, heard.robot, |came| came.stamps.len() > 20);
    assert_eq!(came.topics, ["/arm7/joint_states"]);
    assert!(came.stamps.is_sorted());

    // What is no CDR, and what is too long, is said and goes nowhere.
    states.publisher.put([9_u8, 9, 9, 9, 9]).wait().unwrap();
    let long = vec![0_u8; options.message_most_bytes + 1];
    states.publisher.put(long).wait().unwrap();
    let is_unread = |t: &Trouble| matches!(t, Trouble::Unreadable { messages: 1, .. });
    let is_long =
        |t: &Trouble| matches!(t, Trouble::TooLong { bytes, .. } if *bytes == (4 << 20) + 1);
    came.until(&heard.inbox, heard.robot, |came| {
        count(came, &is_unread) == 1 && count(came, &is_long) == 1
    });

    // A publisher that leaves.
    states.token.undeclare().wait().unwrap();
    let is_gone = |t: &Trouble| {
        matches!(
            t,
            Trouble::PublisherLost {
                how: Lost::Left,
                ..
            }
        )
    };
    came.until(&heard.inbox, heard.robot, |came| count(came, &is_gone) == 1);

    robot.close().wait().unwrap();
    router.close().wait().unwrap();
    came.until(&heard.inbox, heard.robot, |came| count(came, &is_shut) == 2);
    let before = door.status().messages;
    let _router = session("router", None, Some(&endpoint));
    came.until(&heard.inbox, heard.robot, |came| count(came, &is_open) == 2);
    let robot = session("client", Some(&endpoint), None);
    let states = writer(&robot, 3, 1, STATE_KEY, "::,10:,:,:,,");
    until("a message after the router came back", || {
        send(&states);
        door.status().messages > before + 20
    });
}

#[test]
fn a_description_that_was_published_before_is_asked_for() {
    let endpoint = free();
    let _router = session("router", None, Some(&endpoint));
    let robot = session("client", Some(&endpoint), None);
    let text = format!(
        "<robot name=\"arm7\"><!--{}--></robot>",
        "x".repeat(400_000)
    );
    let mut cdr = Vec::new();
    Text { data: &text }.encode(&mut cdr).unwrap();
    // As publishers of today keep what they published.
    let kept = format!("0/{TEXT_KEY}");
    let of_query = kept.clone();
    let _keeps = robot
        .declare_queryable(format!("{kept}/@adv/pub/{}/7/_", robot.zid()))
        .callback(move |query| query.reply(of_query.as_str(), cdr.clone()).wait().unwrap())
        .wait()
        .unwrap();
    let _described = writer(&robot, 0, 2, TEXT_KEY, ":1:,1:,:,:,,");
    let states = writer(&robot, 0, 1, STATE_KEY, "::,10:,:,:,,");

    let heard = heard("/arm7");
    let options = listening(0, &endpoint);
    let (_door, _silent) = door::open(&options, &heard.routes, Clock::start()).unwrap();
    let mut intake = Intake::new(&heard.options).unwrap();
    let mut batch = Default::default();
    until("the description", || {
        states.publisher.put(state(START_NS, 0.0)).wait().unwrap();
        if heard.inbox.wait(Duration::from_millis(5)).is_some() {
            heard.inbox.take(heard.robot, &mut batch);
            intake.feed(&batch, |_| {});
        }
        intake.live().descriptions() > 0
    });
    assert_eq!(intake.live().robot_description(), Some(text.as_str()));
}

#[test]
fn a_robot_is_found_with_its_topics_and_publishers() {
    let endpoint = free();
    let _router = session("router", None, Some(&endpoint));
    let robot = session("client", Some(&endpoint), None);
    let states = writer(&robot, 12, 1, STATE_KEY, "2::,10:,:,:,,");
    let options = listening(12, &endpoint);
    until("the domain", || {
        door::active_domains(&options).unwrap() == [12]
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
        let found = door::discover(&options, Clock::start(), Duration::from_secs(2));
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
        found.unwrap()
    });
    assert_eq!(found.door, "zenoh:12");
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
fn what_is_published_has_key_token_and_attachment_of_rmw_zenoh() {
    let endpoint = free();
    let _router = session("router", None, Some(&endpoint));
    let reader = session("client", Some(&endpoint), None);
    let (send, messages) = channel();
    let _reads = reader
        .declare_subscriber("0/**")
        .callback(move |sample| drop(send.send(sample)))
        .wait()
        .unwrap();
    let (say, tokens) = channel();
    let _tokens = reader
        .liveliness()
        .declare_subscriber("@ros2_lv/0/**")
        .history(true)
        .callback(move |sample| drop(say.send(sample.key_expr().to_string())))
        .wait()
        .unwrap();

    let heard = heard("/arm7");
    let options = ZenohOptions {
        publishing: Publishing {
            diagnostics: false,
            tendons: true,
        },
        ..listening(0, &endpoint)
    };
    let (_door, mut publisher) = door::open(&options, &heard.routes, Clock::start()).unwrap();
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
    // Numbered, dated, and by one publisher.
    let attached: Vec<Vec<u8>> = samples
        .iter()
        .map(|s| s.attachment().unwrap().to_bytes().to_vec())
        .collect();
    let number = |bytes: &[u8]| i64::from_le_bytes(bytes[..8].try_into().unwrap());
    assert_eq!(attached[0].len(), 33);
    assert_eq!(number(&attached[1]), number(&attached[0]) + 1);
    assert_eq!(attached[0][16..], attached[1][16..]);
    let mut known = Vec::new();
    until("both tokens", || {
        known.extend(tokens.try_iter());
        known.len() == 2
    });
    assert!(
        known.iter().any(|key| key.ends_with("/NN/%/%/sinew")),
        "{known:?}"
    );
    assert!(
        known
            .iter()
            .any(|key| key.contains("/MP/%/%/sinew/%arm7%sinew%tendons/")),
        "{known:?}"
    );
}

#[test]
fn an_endpoint_without_a_router_is_refused_with_its_name() {
    let endpoint = free();
    let error = door::check(&listening(0, &endpoint))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains(&endpoint) && error.contains("no router or peer"),
        "{error}"
    );
    let _router = session("router", None, Some(&endpoint));
    door::check(&listening(0, &endpoint)).unwrap();
}
