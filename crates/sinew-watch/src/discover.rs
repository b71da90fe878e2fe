//! Discovery without a configuration (`sinew watch`): robots found, and missing files and settings.

use sinew_estimate::init::{Init, InitGap};
use sinew_estimate::robot_toml::robot_toml;
use sinew_files::number::three_digits;
use sinew_files::plain;
use sinew_log::TopicUse;
use sinew_log::live::RobotFound;
use sinew_transport::{DomainFound, TopicFound};
use std::fmt::Write as _;
#[cfg(any(feature = "dds", feature = "zenoh"))]
use std::time::Duration;

/// Duration of the search for DDS domains.
#[cfg(feature = "dds")]
const SEARCH_TIME: Duration = Duration::from_secs(10);
/// Duration of listening to each domain.
#[cfg(any(feature = "dds", feature = "zenoh"))]
const LISTEN_TIME: Duration = Duration::from_secs(5);

/// Listens to every active domain and returns the topics, publishers and robots found.
///
/// # Errors
/// Returns the reason as text if the network cannot be used.
#[cfg(any(feature = "dds", feature = "zenoh"))]
pub fn listen(report: impl Fn(&str)) -> Result<Vec<DomainFound>, String> {
    let listen = LISTEN_TIME;
    let clock = sinew_transport::Clock::start();
    let mut found = Vec::new();
    let listen_to = |domain: u16, over: &str| {
        let length_s = listen.as_secs();
        report(&format!(
            "Listening to domain {domain}{over} for {length_s} s …"
        ));
    };
    #[cfg(feature = "dds")]
    {
        use sinew_transport::dds::{DdsOptions, active_domains, discover};
        report(&format!(
            "Searching ROS 2 domains for {} s …",
            SEARCH_TIME.as_secs()
        ));
        let mut domains = active_domains(&[], SEARCH_TIME);
        if !domains.contains(&0) {
            domains.insert(0, 0);
        }
        for domain in domains {
            listen_to(domain, "");
            let options = DdsOptions {
                domain,
                ..DdsOptions::default()
            };
            found.push(discover(&options, clock, listen).map_err(|e| e.to_string())?);
        }
    }
    // Domains behind the router of this host. Without a router there is no Zenoh network.
    #[cfg(feature = "zenoh")]
    {
        use sinew_transport::zenoh::{ZenohOptions, active_domains, discover};
        for domain in active_domains(&ZenohOptions::default()).unwrap_or_default() {
            listen_to(domain, " over Zenoh");
            let options = ZenohOptions {
                domain,
                ..ZenohOptions::default()
            };
            found.push(discover(&options, clock, listen).map_err(|e| e.to_string())?);
        }
    }
    Ok(found)
}

/// Reports that this build has no network transport.
///
/// # Errors
/// Always returns an error.
#[cfg(not(any(feature = "dds", feature = "zenoh")))]
pub fn listen(_report: impl Fn(&str)) -> Result<Vec<DomainFound>, String> {
    Err("this sinew-watch was built without DDS and Zenoh; set a configuration file, or build it with --features dds".into())
}

/// Formats the robots found and the next steps.
pub fn render(found: &[DomainFound]) -> String {
    let mut out = String::new();
    for domain in found.iter().filter(|d| !d.topics.is_empty()) {
        topics(&mut out, domain);
        for robot in &domain.robots {
            of_robot(&mut out, domain, robot);
        }
        for fault in &domain.faults {
            let _ok = writeln!(out, "  {}", plain(&fault.to_string()));
        }
    }
    let robots: usize = found.iter().map(|domain| domain.robots.len()).sum();
    if robots == 0 {
        out += "\nNo robot found: no namespace with sensor_msgs/msg/JointState.\n\
                Check that the driver runs in this network, that multicast is allowed, and the value of ROS_DOMAIN_ID.\n\
                A growing MCAP file requires no network: set mcap = { path = \"FILE\" } in the configuration.\n\
                sinew watch --demo shows what it would look like.\n";
    } else {
        out += "\nSave the configuration as watch.toml, complete robot.toml, and run: sinew watch watch.toml\n";
    }
    out
}

fn topics(out: &mut String, domain: &DomainFound) {
    let _ok = writeln!(
        out,
        "{}, received for {:.0} s:",
        domain.transport, domain.listened_s
    );
    let name = |topic: &TopicFound| plain(&topic.topic.name);
    let widest =
        |of: &dyn Fn(&TopicFound) -> usize| domain.topics.iter().map(of).max().unwrap_or(0);
    let wide = widest(&|t| name(t).chars().count());
    let kinds = widest(&|t| plain(&t.topic.kind).chars().count());
    for topic in &domain.topics {
        let rate = topic.topic.rate_hz;
        let rate = rate.map_or("–".into(), |hz| format!("{} Hz", three_digits(hz)));
        let used = match topic.topic.role {
            Some(TopicUse::JointSide) => "joint side",
            Some(TopicUse::MotorSide) => "motor side",
            Some(_) => "used",
            None => "",
        };
        let line = format!(
            "  {:wide$}  {:kinds$}  {rate:>8}  {used}",
            name(topic),
            plain(&topic.topic.kind)
        );
        let _ok = writeln!(out, "{}", line.trim_end());
    }
}

/// Derives the name of a robot from its namespace: `/cell/arm7` becomes `cell-arm7`.
fn name_of(robot: &RobotFound, init: Option<&Init>) -> String {
    let of_namespace = robot.namespace.trim_matches('/').replace('/', "-");
    let of_urdf = init.and_then(|init| init.robot.clone()).unwrap_or_default();
    let name = match of_namespace.as_str() {
        "" => of_urdf,
        name => name.to_owned(),
    };
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let name: String = name.chars().filter(|c| fits(*c)).collect();
    if name.is_empty() { "arm".into() } else { name }
}

fn of_robot(out: &mut String, domain: &DomainFound, robot: &RobotFound) {
    let place = match robot.namespace.as_str() {
        "" => "the root".to_owned(),
        namespace => plain(namespace),
    };
    let joints: Vec<&str> = robot.joints.iter().map(|j| j.name.as_str()).collect();
    let joints = plain(&joints.join(", "));
    let _ok = writeln!(out, "\n  Robot in {place} with joints {joints}.");
    for ambiguity in &robot.ambiguous {
        let several = plain(&ambiguity.candidates.join(", "));
        let key = match ambiguity.side {
            TopicUse::MotorSide => "motor_topic",
            _ => "joint_topic",
        };
        let _ok = writeln!(
            out,
            "  Several topics match one side: {several}. Select one with {key}."
        );
    }
    let rate = domain
        .topics
        .iter()
        .find(|t| Some(&t.topic.name) == robot.joint_side.as_ref());
    let rate_hz = rate.and_then(|t| t.topic.rate_hz);
    let urdf = robot.robot_description.as_deref();
    let source = format!("{}{}", domain.transport, robot.namespace);
    let init = Init::of_network(
        &source,
        urdf.map(|text| ("robot.urdf", text)),
        &robot.joints,
        rate_hz,
    );
    let init = match init {
        Ok(init) => init,
        Err(error) => {
            let _ok = writeln!(
                out,
                "  Published URDF is invalid: {}",
                plain(&error.to_string())
            );
            return;
        }
    };
    missing(out, &init);
    let name = name_of(robot, Some(&init));
    // The name of a transport consists of its key and its domain.
    let (transport, number) = domain.transport.split_once(':').unwrap_or(("dds", "0"));
    let _ok = write!(
        out,
        "\n  watch.toml:\n\n    [[robot]]\n    name = \"{name}\"\n    dir = \"{name}\"\n    \
         {transport} = {{ domain = {number}, namespace = \"{}\" }}\n\n  {name}/robot.toml:\n\n",
        plain(&robot.namespace)
    );
    // A published URDF needs no file.
    let text = match urdf {
        Some(_) => robot_toml(&init).replace(
            "urdf = \"robot.urdf\"",
            "# urdf comes as /robot_description",
        ),
        None => robot_toml(&init),
    };
    for line in text.lines() {
        let _ok = writeln!(out, "    {line}");
    }
}

/// Lists the missing inputs of an estimate.
fn missing(out: &mut String, init: &Init) {
    let mut stiffness = Vec::new();
    for gap in &init.missing {
        let line = match gap {
            InitGap::Urdf => "No URDF published: add one next to robot.toml.".to_owned(),
            InitGap::MotorSide => {
                "No motor positions published: tendons cannot be monitored without them.".into()
            }
            InitGap::LockedAt(joint) => {
                format!(
                    "{} is not published: set its position (locked_at_rad).",
                    plain(joint)
                )
            }
            InitGap::Stiffness(joint) => {
                stiffness.push(plain(joint));
                continue;
            }
            InitGap::Choice | InitGap::Drums(_) | InitGap::TendonStiffness(_) => continue,
        };
        let _ok = writeln!(out, "  {line}");
    }
    if !stiffness.is_empty() {
        let _ok = writeln!(
            out,
            "  Stiffness missing: set stiffness_nm_per_rad of {}.",
            stiffness.join(", ")
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_log::{JointInfo, Quantity, TopicInfo};
    use sinew_model::robot::RobotFile;

    fn found(robots: Vec<RobotFound>) -> DomainFound {
        let topic = |name: &str, kind: &str, role| TopicFound {
            topic: TopicInfo {
                name: name.into(),
                kind: kind.into(),
                messages: 500,
                rate_hz: Some(100.0),
                interfaces: Vec::new(),
                role,
            },
            publishers: Vec::new(),
        };
        DomainFound {
            transport: "dds:3".into(),
            listened_s: 5.0,
            topics: vec![
                topic(
                    "/arm7/joint_states",
                    "sensor_msgs/msg/JointState",
                    Some(TopicUse::JointSide),
                ),
                topic("/tf\u{1b}[2J", "tf2_msgs/msg/TFMessage", None),
            ],
            robots,
            faults: Vec::new(),
        }
    }

    #[test]
    fn render_robot_lists_missing_inputs() {
        let robot = RobotFound {
            namespace: "/arm7".into(),
            joint_side: Some("/arm7/joint_states".into()),
            motor_side: None,
            ambiguous: Vec::new(),
            joints: vec![JointInfo {
                name: "elbow".into(),
                channels: vec![Quantity::Q, Quantity::Theta],
            }],
            robot_description: None,
        };
        let text = render(&[found(vec![robot])]);
        for words in [
            "/arm7/joint_states  sensor_msgs/msg/JointState    100 Hz  joint side",
            "Robot in /arm7 with joints elbow.",
            "No URDF published",
            "stiffness_nm_per_rad of elbow",
            "dds = { domain = 3, namespace = \"/arm7\" }",
            "[joints.elbow]",
        ] {
            assert!(text.contains(words), "{words}\n{text}");
        }
        assert!(
            !text.contains('\u{1b}'),
            "terminal control characters are removed"
        );
        // The output is a valid robot.toml.
        let toml: String = text
            .lines()
            .skip_while(|line| !line.contains("arm7/robot.toml"))
            .skip(1)
            .take_while(|line| line.is_empty() || line.starts_with("    "))
            .map(|line| format!("{}\n", line.trim()))
            .collect();
        assert!(
            RobotFile::parse(&toml, "robot.toml").is_ok() || toml.contains("# stiffness"),
            "{toml}"
        );
    }

    #[test]
    fn render_without_robot_suggests_checks() {
        let text = render(&[found(Vec::new())]);
        assert!(
            text.contains("No robot found") && text.contains("ROS_DOMAIN_ID"),
            "{text}"
        );
        assert!(render(&[]).contains("sinew watch --demo"));
    }
}
