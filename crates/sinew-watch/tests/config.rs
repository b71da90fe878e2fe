//! A configuration is read completely; errors name file, line, key, value and remedy.

use sinew_watch::config::{Address, Config, MailTls, Receiver, Role};
use sinew_watch_core::alarm::{Condition, Delays};
use std::path::{Path, PathBuf};

fn parse(text: &str) -> Result<Config, String> {
    Config::parse(text, "watch.toml", Path::new("/etc/sinew")).map_err(|e| e.to_string())
}

const ROBOT: &str = "[[robot]]\nname = \"arm-7\"\ndir = \"arm-7\"\n";

#[test]
fn config_defaults_are_safe() {
    let config = parse(&format!("{ROBOT}dds = {{}}\n")).unwrap();
    assert_eq!(config.web.bind, "127.0.0.1:8642".parse().ok());
    assert!(!config.web.needs_token());
    assert_eq!(config.store, PathBuf::from("/var/lib/sinew"));
    let [robot] = &config.robots[..] else {
        panic!()
    };
    assert_eq!(robot.dir, PathBuf::from("/etc/sinew/arm-7"));
    assert_eq!(robot.transport.source(), "dds:0");
    assert!(robot.stamps_are_real && robot.estimate.motor_torque);
    assert!(config.publish.diagnostics && config.publish.tendons && config.receivers.is_empty());
    assert_eq!((config.thin_after_d, config.web.url), (None, None));
}

#[test]
fn config_reads_every_key() {
    let config = parse(
        "[web]\nbind = \"0.0.0.0:80\"\nhost_names = [\"Cell-3.example.org\"]\ntoken_file = \"token\"\n\
         url = \"https://cell-3.example.org/\"\ntoken = [{ name = \"hall\", role = \"read\", file = \"hall\" }]\n\
         [store]\ndir = \"store\"\nthin_after_d = 400\n[publish]\ntendons = false\n\
         [[webhook]]\nurl = \"http://[::1]:9000/hook?a=1\"\nseverity_min = 600\nformat = \"ntfy\"\n\
         [[webhook]]\nurl = \"https://hooks.example.org/x\"\nca_file = \"ca.pem\"\n\
         [[mail]]\nserver = \"mail.example.org\"\ntls = \"implicit\"\nfrom = \"a@b.org\"\nto = [\"c@d.org\"]\n\
         user = \"a\"\npassword_file = \"p\"\nca_file = \"ca.pem\"\nseverity_min = 700\n\
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
    assert_eq!(config.thin_after_d, Some(400));
    let token = &config.web.tokens[0];
    assert_eq!((token.name.as_str(), token.role), ("hall", Role::Read));
    assert_eq!(token.file, Some("/etc/sinew/hall".into()));
    let [
        Receiver::Webhook(hook),
        Receiver::Webhook(https),
        Receiver::Mail(mail),
    ] = &config.receivers[..]
    else {
        panic!("{:?}", config.receivers)
    };
    assert_eq!(https.url(), "https://hooks.example.org:443/x");
    // Address and query of ntfy may be secret, and do not appear in the log.
    let names = config.receivers.iter().map(Receiver::name);
    let names: Vec<String> = names.take(2).collect();
    assert_eq!(
        names,
        ["http://[::1]:9000", "https://hooks.example.org:443/x"]
    );
    assert_eq!(https.ca_file, Some("/etc/sinew/ca.pem".into()));
    assert_eq!((mail.host.as_str(), mail.port), ("mail.example.org", 465));
    assert_eq!((mail.tls, mail.severity_min), (MailTls::Implicit, 700));
    assert_eq!(mail.page.as_deref(), Some("https://cell-3.example.org"));
    assert_eq!(hook.format, sinew_watch::config::PostFormat::Ntfy);
    assert_eq!(
        (hook.host.as_str(), hook.port, hook.path.as_str()),
        ("[::1]", 9000, "/hook?a=1")
    );
    assert_eq!(hook.url(), "http://[::1]:9000/hook?a=1");
    let robot = &config.robots[0];
    assert_eq!(
        (
            robot.transport.source().as_str(),
            robot.transport.namespace.as_str()
        ),
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
        matches!(&config.robots[1].transport.address, Address::Mcap { from_start: true, path, .. } if path == Path::new("/etc/sinew/runs"))
    );
}

#[test]
fn config_former_alarm_keys_are_read() {
    let delays = |alarm: &str| {
        let config = parse(&format!("{ROBOT}dds = {{}}\n{alarm}\n")).unwrap();
        config.robots[0].alarms.delays.clone()
    };
    let former = "alarm.door.raise_after_s = 9\nalarm.suspicion.raise_after_s = 8";
    let present = "alarm.transport.raise_after_s = 9\nalarm.suspected_step.raise_after_s = 8";
    assert_eq!(delays(former), delays(present));
    assert_eq!(delays(former).len(), 2);
}

#[test]
fn config_errors_name_place_and_fix() {
    for (text, words) in [
        ("", "watch.toml, line 1: robot is missing: add [[robot]]"),
        (
            "[[robots]]\nname = \"a\"\n",
            "unknown key 'robots'; did you mean 'robot'?",
        ),
        (
            ROBOT,
            "line 1: robot[0]: dds is missing: set dds, zenoh or mcap",
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
            "dds, zenoh and mcap conflict",
        ),
        (
            &format!("{ROBOT}dds = {{}}\n{ROBOT}dds = {{}}\n"),
            "duplicate robot name 'arm-7'",
        ),
        (
            &format!("{ROBOT}dds = {{}}\nalarm.jump.raise_after = 3\n"),
            "unknown key 'raise_after'; did you mean 'raise_after_s'",
        ),
        (
            &format!("{ROBOT}dds = {{}}\nalarm.jump.raise_after_s = 3\n"),
            "conflicts with the confirmation by a second session",
        ),
        (
            &format!("{ROBOT}dds = {{}}\ntemperature_std_k = 3\n"),
            "temperature_std_k requires temperature_c",
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
            "must be a name of this host",
        ),
        (
            &format!(
                "[[mail]]\nserver = \"a\"\nfrom = \"a@b\"\nto = [\"c@d\\r\\nBcc: e@f\"]\n{ROBOT}dds = {{}}\n"
            ),
            "must be a mail address",
        ),
        (
            &format!(
                "[[mail]]\nserver = \"a\"\nfrom = \"a@b\"\nto = [\"c@d\"]\ntls = \"off\"\nuser = \"u\"\npassword_file = \"p\"\n{ROBOT}dds = {{}}\n"
            ),
            "a password is not sent unencrypted",
        ),
        (
            &format!("[[webhook]]\nurl = \"http://a b/\"\n{ROBOT}dds = {{}}\n"),
            "must be http://HOST",
        ),
        (
            &format!("[[webhook]]\nurl = \"http://a/\"\nseverity_min = 1001\n{ROBOT}dds = {{}}\n"),
            "between 0 and 1000",
        ),
        (
            &format!("[mqtt]\nbroker = \"a\"\nca_file = \"ca.pem\"\n{ROBOT}dds = {{}}\n"),
            "mqtt.ca_file = \"ca.pem\": must be used with tls = true",
        ),
        (
            &format!("[[webhook]]\nurl = \"http://a/\"\nca_file = \"ca.pem\"\n{ROBOT}dds = {{}}\n"),
            "must be used with https://",
        ),
        (
            &format!(
                "[web]\ntoken = [{{ name = \"hall\", role = \"read\" }}]\n{ROBOT}dds = {{}}\n"
            ),
            "no token is required at a loopback address; set token_on_loopback = true",
        ),
        (
            &format!("[recording]\nmax_files = 2.5\n{ROBOT}dds = {{}}\n"),
            "recording.max_files = 2.5: must be a whole number",
        ),
        (&format!("{ROBOT}mcap = {{}}\n"), "path is missing"),
    ] {
        let error = parse(text).unwrap_err();
        assert!(error.contains(words), "{text}\n{error}\n{words}");
    }
}
