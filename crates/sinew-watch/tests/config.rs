//! A configuration is read as a whole; what is wrong is told with file, line, key, value and cure.

use sinew_watch::config::{Address, Config};
use sinew_watch_core::alarm::{Condition, Delays};
use std::path::{Path, PathBuf};

fn parse(text: &str) -> Result<Config, String> {
    Config::parse(text, "watch.toml", Path::new("/etc/sinew")).map_err(|e| e.to_string())
}

const ROBOT: &str = "[[robot]]\nname = \"arm-7\"\ndir = \"arm-7\"\n";

#[test]
fn what_is_left_out_is_safe_and_usual() {
    let config = parse(&format!("{ROBOT}dds = {{}}\n")).unwrap();
    assert_eq!(config.web.bind, "127.0.0.1:8642".parse().ok());
    assert!(!config.web.needs_token());
    assert_eq!(config.store, PathBuf::from("/var/lib/sinew"));
    let [robot] = &config.robots[..] else {
        panic!()
    };
    assert_eq!(robot.dir, PathBuf::from("/etc/sinew/arm-7"));
    assert_eq!(robot.door.source(), "dds:0");
    assert!(robot.stamps_are_real && robot.estimate.motor_torque);
    assert!(config.publish.diagnostics && config.publish.tendons && config.webhooks.is_empty());
}

#[test]
fn every_key_is_read() {
    let config = parse(
        "[web]\nbind = \"0.0.0.0:80\"\nhost_names = [\"Cell-3.example.org\"]\ntoken_file = \"token\"\n\
         [store]\ndir = \"store\"\n[publish]\ntendons = false\n\
         [[webhook]]\nurl = \"http://[::1]:9000/hook?a=1\"\nseverity_min = 600\n\
         [[robot]]\nname = \"arm-7\"\ndir = \"/robots/arm\"\nbaseline = \"arm.baseline\"\nmapping = \"names.toml\"\n\
         joint_topic = \"js\"\nmotor_topic = \"ms\"\nmotor_interface = \"position\"\njoint_effort = \"tau-m\"\n\
         stamps = \"simulated\"\nmotor_torque = false\nempty_gripper = true\ntemperature_c = 21\n\
         dds = { domain = 3, namespace = \"arm7/\", interfaces = [\"192.168.1.5\"] }\n\
         alarm = { clear_below = 0.7, near_d = 7, limit_near = { raise_after_s = 3 } }\n\
         times = { stale_after_s = 3 }\n\
         [[robot]]\nname = \"b\"\ndir = \"b\"\nmcap = { path = \"runs\", from = \"start\" }\n",
    )
    .unwrap();
    assert!(config.web.needs_token());
    assert_eq!(config.web.host_names, ["cell-3.example.org"]);
    assert_eq!(config.web.token_file, Some("/etc/sinew/token".into()));
    assert!(config.publish.diagnostics && !config.publish.tendons);
    let hook = &config.webhooks[0];
    assert_eq!(
        (hook.host.as_str(), hook.port, hook.path.as_str()),
        ("[::1]", 9000, "/hook?a=1")
    );
    assert_eq!(hook.url(), "http://[::1]:9000/hook?a=1");
    let robot = &config.robots[0];
    assert_eq!(
        (robot.door.source().as_str(), robot.door.namespace.as_str()),
        ("dds:3/arm7", "/arm7")
    );
    assert_eq!(robot.times.stale_after_s, 3.0);
    let usual = Delays::of(Condition::LimitNear);
    assert_eq!(
        robot.alarms.delays(Condition::LimitNear),
        Delays {
            raise_after_s: 3.0,
            ..usual
        }
    );
    let data = Delays::of(Condition::Data);
    assert_eq!(robot.alarms.delays(Condition::Data), data);
    assert_eq!(robot.alarms.near_s, 7.0 * 86_400.0);
    assert!(
        matches!(&config.robots[1].door.address, Address::Mcap { from_start: true, path, .. } if path == Path::new("/etc/sinew/runs"))
    );
}

#[test]
fn what_is_wrong_is_told_with_its_place_and_its_cure() {
    for (text, words) in [
        ("", "watch.toml, line 1: robot is missing: add [[robot]]"),
        (
            "[[robots]]\nname = \"a\"\n",
            "unknown key 'robots'; did you mean 'robot'?",
        ),
        (
            ROBOT,
            "line 1: robot[0]: dds is missing: where the robot is heard",
        ),
        (
            "[[robot]]\ndir = \"a\"\ndds = {}\n",
            "robot[0]: name is missing",
        ),
        (
            "[[robot]]\nname = \"a b\"\ndir = \"a\"\ndds = {}\n",
            "line 2: robot[0].name = \"a b\": must be at most 64",
        ),
        (
            &format!("{ROBOT}dds = {{ domain = 233 }}\n"),
            "robot[0].dds.domain = 233: must be 0 to 232",
        ),
        (
            &format!("{ROBOT}dds = {{ namespace = \"a b\" }}\n"),
            "must be a ROS namespace",
        ),
        (
            &format!("{ROBOT}dds = {{}}\nzenoh = {{}}\n"),
            "it is heard at two places",
        ),
        (
            &format!("{ROBOT}dds = {{}}\n{ROBOT}dds = {{}}\n"),
            "two robots are called 'arm-7'",
        ),
        (
            &format!("{ROBOT}dds = {{}}\nalarm.jump.raise_after = 3\n"),
            "unknown key 'raise_after'; did you mean 'raise_after_s'",
        ),
        (
            &format!("{ROBOT}dds = {{}}\nalarm.jump.raise_after_s = 3\n"),
            "a jump has waited for a second session already",
        ),
        (
            &format!("{ROBOT}dds = {{}}\ntemperature_deviation_k = 3\n"),
            "temperature_deviation_k says how sure temperature_c is",
        ),
        (
            &format!("{ROBOT}dds = {{}}\nalarm.clear_below = 1.5\n"),
            "must be between 0 and 1",
        ),
        (
            &format!("{ROBOT}dds = {{}}\ntimes.stale_after_s = 0\n"),
            "(s): must be between 1 and 3600 s",
        ),
        (
            &format!("[web]\nbind = \"localhost\"\n{ROBOT}dds = {{}}\n"),
            "line 2: web.bind = \"localhost\": must be an address and a port",
        ),
        (
            &format!("[web]\nhost_names = [\"a/b\"]\n{ROBOT}dds = {{}}\n"),
            "must be a name of this computer",
        ),
        (
            &format!("[[webhook]]\nurl = \"https://a/b\"\n{ROBOT}dds = {{}}\n"),
            "for https put a proxy on this computer",
        ),
        (
            &format!("[[webhook]]\nurl = \"http://a b/\"\n{ROBOT}dds = {{}}\n"),
            "must be http://HOST",
        ),
        (
            &format!("[[webhook]]\nurl = \"http://a/\"\nseverity_min = 1001\n{ROBOT}dds = {{}}\n"),
            "between 0 and 1000",
        ),
        (&format!("{ROBOT}mcap = {{}}\n"), "path is missing"),
    ] {
        let error = parse(text).unwrap_err();
        assert!(error.contains(words), "{text}\n{error}\n{words}");
    }
}
