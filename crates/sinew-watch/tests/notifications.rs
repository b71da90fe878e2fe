//! Notifications over https and mail, to servers with certificates of a test authority.
//!
//! The certificates are valid for `localhost` until 2126:
//!
//! ```text
//! openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout ca.key -out tls-authority.pem -days 36500 \
//!   -subj "/CN=Test authority" -addext "basicConstraints=critical,CA:TRUE" -addext "keyUsage=critical,keyCertSign"
//! openssl req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout server.key -subj "/CN=localhost" -out server.csr
//! openssl x509 -req -in server.csr -CA tls-authority.pem -CAkey ca.key -days 36500 -extfile ext -out server.pem
//! cat server.pem server.key > tls-server.pem
//! ```
//!
//! with `subjectAltName=DNS:localhost`, `basicConstraints=CA:FALSE` and `extendedKeyUsage=serverAuth` in `ext`.

use crate::web::{served, store_in_memory};
use sinew_watch::config::{Config, Mail, MailTls, Receiver};
use sinew_watch::runtime::{Health, RobotRegistry, RobotState};
use sinew_watch::webhooks;
use sinew_watch_core::alarm::{
    AlarmCause, AlarmKey, AlarmState, Condition, StepKind, Transition, TransitionReason,
};
use sinew_watch_core::journal::{Entry, Event};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver as Received, channel};
use std::time::{Duration, Instant};
use tokio::io::{
    AsyncBufReadExt as _, AsyncRead, AsyncReadExt as _, AsyncWrite, AsyncWriteExt as _, BufReader,
};
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::ServerConfig;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer};

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden")
        .join(name)
}

fn acceptor() -> TlsAcceptor {
    let pem = std::fs::read(golden("tls-server.pem")).unwrap();
    let certificates: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(&pem).collect();
    let key = PrivateKeyDer::from_pem_slice(&pem).unwrap();
    let config = ServerConfig::builder_with_provider(ring::default_provider().into())
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_no_client_auth()
        .with_single_cert(certificates.unwrap(), key)
        .unwrap();
    TlsAcceptor::from(Arc::new(config))
}

trait Stream: AsyncRead + AsyncWrite + Unpin + Send {}
impl<T: AsyncRead + AsyncWrite + Unpin + Send> Stream for T {}

/// Behaviour of the mail server.
#[derive(Clone, Copy)]
struct Server {
    tls: MailTls,
    /// Methods that it offers for a login; `None`: no login.
    auth: Option<&'static str>,
    /// Number of mails that it rejects before it accepts one.
    rejected: usize,
    /// Address that it rejects instead of the mail.
    rejected_address: Option<&'static str>,
    /// Adds a reply behind that to STARTTLS, as an attacker could.
    injects: bool,
}

const STARTTLS: Server = Server {
    tls: MailTls::StartTls,
    auth: None,
    rejected: 0,
    rejected_address: None,
    injects: false,
};

/// Dialogue of one connection; returns the lines of the client, those under TLS with the mark `TLS: `.
async fn dialogue(server: Server, stream: tokio::net::TcpStream, rejects: bool) -> Vec<String> {
    let mut secure = false;
    let mut stream: BufReader<Box<dyn Stream>> = BufReader::new(Box::new(stream));
    if server.tls == MailTls::Implicit {
        let Ok(tls) = acceptor().accept(stream.into_inner()).await else {
            return vec!["no TLS".into()];
        };
        stream = BufReader::new(Box::new(tls));
        secure = true;
    }
    let is_rejected = |line: &str| server.rejected_address.is_some_and(|to| line.contains(to));
    let mut lines = Vec::new();
    let mut is_data = false;
    let mut reply = String::from("220-mail.example.org\r\n220 ready\r\n");
    loop {
        if stream.write_all(reply.as_bytes()).await.is_err() || stream.flush().await.is_err() {
            return lines;
        }
        if lines
            .last()
            .is_some_and(|line: &String| line.ends_with("QUIT"))
        {
            return lines;
        }
        if !secure && lines.last().is_some_and(|line: &String| line == "STARTTLS") {
            let Ok(tls) = acceptor().accept(stream.into_inner()).await else {
                lines.push("no TLS".into());
                return lines;
            };
            stream = BufReader::new(Box::new(tls));
            secure = true;
        }
        let mut line = String::new();
        if !matches!(stream.read_line(&mut line).await, Ok(1..)) {
            return lines;
        }
        let line = line.trim_end_matches(['\r', '\n']).to_owned();
        let word = line.split([' ', ':']).next().unwrap_or_default().to_owned();
        let mark = if secure { "TLS: " } else { "" };
        lines.push(format!("{mark}{line}"));
        reply = match (is_data, word.as_str()) {
            (true, ".") => {
                is_data = false;
                "250 queued\r\n".into()
            }
            (true, _) => String::new(),
            (false, "EHLO") => {
                let tls = match (server.tls, secure) {
                    (MailTls::StartTls, false) => "250-STARTTLS\r\n",
                    _ => "",
                };
                let auth = server.auth.filter(|_| secure);
                let auth = auth.map_or(String::new(), |auth| format!("250-AUTH {auth}\r\n"));
                format!("250-mail.example.org\r\n{tls}{auth}250 8BITMIME\r\n")
            }
            (false, "STARTTLS") if server.injects => "220 go\r\n250 injected\r\n".into(),
            (false, "STARTTLS") => "220 go\r\n".into(),
            (false, "AUTH") if line.contains("LOGIN") => "334 VXNlcm5hbWU6\r\n".into(),
            (false, "AUTH") => "235 logged in\r\n".into(),
            // printf Ada | base64, printf 'pass word' | base64
            (false, "QWRh") => "334 UGFzc3dvcmQ6\r\n".into(),
            (false, "cGFzcyB3b3Jk") => "235 logged in\r\n".into(),
            (false, "MAIL") if rejects && server.rejected_address.is_none() => {
                "451 try later\r\n".into()
            }
            (false, "RCPT") if rejects && is_rejected(line.as_str()) => "450 try later\r\n".into(),
            (false, "MAIL" | "RCPT") => "250 ok\r\n".into(),
            (false, "DATA") => {
                is_data = true;
                "354 go\r\n".into()
            }
            (false, "QUIT") => "221 bye\r\n".into(),
            _ => "500 unknown\r\n".into(),
        };
    }
}

/// Serves mail; returns the port and the lines of every connection.
fn mail_server(server: Server) -> (u16, Received<Vec<String>>) {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    listener.set_nonblocking(true).unwrap();
    let (sender, received) = channel();
    std::thread::spawn(move || {
        block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener).unwrap();
            let mut count = 0;
            while let Ok((stream, _)) = listener.accept().await {
                let lines = dialogue(server, stream, count < server.rejected).await;
                count += 1;
                if sender.send(lines).is_err() {
                    return;
                }
            }
        });
    });
    (port, received)
}

fn block_on<T>(task: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    runtime.block_on(task)
}

/// Configuration with one mail, and further keys of it.
fn mail(port: u16, keys: &str) -> Mail {
    let text = format!(
        "[web]\nurl = \"https://cell-3.example.org/\"\n\
         [[mail]]\nserver = \"localhost:{port}\"\nfrom = \"sinew@example.org\"\n\
         to = [\"ada@example.org\", \"shift@example.org\"]\nca_file = {:?}\n{keys}\n\
         [[robot]]\nname = \"arm-7\"\ndir = \"arm-7\"\ndds = {{}}\n",
        golden("tls-authority.pem")
    );
    let config = Config::parse(&text, "watch.toml", &golden("")).unwrap();
    match config.receivers.into_iter().next() {
        Some(Receiver::Mail(mail)) => mail,
        other => panic!("{other:?}"),
    }
}

fn step_change(to: AlarmState) -> Entry {
    Entry {
        time_utc_s: 1_795_564_809.0,
        event: Event::Alarm {
            transition: Transition {
                key: AlarmKey {
                    joint: Some("elbow é".into()),
                    condition: Condition::StepChange,
                },
                from: AlarmState::Normal,
                to,
                time_utc_s: 1_795_564_809.0,
                reason: TransitionReason::Condition {
                    cause: AlarmCause::StepChange {
                        time_utc_s: 1_795_560_000.0,
                        size_rad: 0.005,
                        std_rad: 0.0002,
                        what: StepKind::Slip,
                        cause: None,
                        stiffness_ratio: None,
                    },
                },
            },
        },
    }
}

fn decoded(base64: &str) -> Vec<u8> {
    const DIGITS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = base64.chars().filter_map(|c| DIGITS.find(c));
    let digits: Vec<u32> = digits.map(|d| d as u32).collect();
    let mut bytes = Vec::new();
    for four in digits.chunks(4) {
        let bits = four.iter().fold(0, |bits, d| bits << 6 | d) << (6 * (4 - four.len()));
        bytes.extend((1..four.len()).map(|k| (bits >> (24 - 8 * k)) as u8));
    }
    bytes
}

/// Sends one alarm to the receivers as the monitor does, until all are delivered or lost.
fn deliver(receivers: Vec<Receiver>, entry: Entry) -> Arc<Health> {
    let health = Arc::new(Health::new(1));
    let count = receivers.len() as u64;
    let (steps, alarms) = tokio::sync::mpsc::channel(1);
    let (_wanted, wanted) = tokio::sync::watch::channel(receivers);
    block_on(async {
        let running = tokio::spawn(webhooks::run(alarms, wanted, Arc::clone(&health)));
        steps.send(("arm-7".into(), entry)).await.unwrap();
        let begun = Instant::now();
        let counts = &health.counts;
        let done = || {
            counts.webhooks.load(Ordering::Relaxed) + counts.webhooks_lost.load(Ordering::Relaxed)
        };
        while done() < count && begun.elapsed() < Duration::from_secs(90) {
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        running.abort();
    });
    health
}

#[test]
fn alarm_is_mailed_over_starttls_with_text_and_link() {
    let (port, received) = mail_server(STARTTLS);
    let to = mail(port, "");
    let health = deliver(vec![Receiver::Mail(to)], step_change(AlarmState::Active));
    assert_eq!(health.counts.webhooks.load(Ordering::Relaxed), 1);
    let lines = received.recv().unwrap();
    let (plain, tls): (Vec<&String>, Vec<&String>) =
        lines.iter().partition(|line| !line.starts_with("TLS: "));
    assert_eq!(plain, ["EHLO example.org", "STARTTLS"]);
    let text: Vec<&str> = tls.iter().map(|line| &line[5..]).collect();
    assert_eq!(
        text[..5],
        [
            "EHLO example.org",
            "MAIL FROM:<sinew@example.org>",
            "RCPT TO:<ada@example.org>",
            "RCPT TO:<shift@example.org>",
            "DATA",
        ]
    );
    assert_eq!(text[text.len() - 2..], [".", "QUIT"]);
    let message = &text[5..text.len() - 2];
    assert!(
        message
            .iter()
            .all(|line| line.is_ascii() && line.len() <= 78),
        "{message:?}"
    );
    let (head, body) = message.split_at(message.iter().position(|l| l.is_empty()).unwrap());
    let unfolded = head.join("\r\n").replace("\r\n ", " ");
    let header = |name: &str| {
        let line = unfolded.split("\r\n").find(|line| line.starts_with(name));
        line.unwrap()[name.len()..]
            .trim_start_matches(": ")
            .to_owned()
    };
    let words = header("Subject");
    let words = words.split(' ').map(|word| {
        let inner = word.strip_prefix("=?UTF-8?B?").unwrap();
        decoded(inner.strip_suffix("?=").unwrap())
    });
    let subject = String::from_utf8(words.flatten().collect()).unwrap();
    assert_eq!(subject, "arm-7: elbow é: Step change");
    assert_eq!(header("To"), "ada@example.org, shift@example.org");
    assert_eq!(header("Auto-Submitted"), "auto-generated");
    let body = String::from_utf8(decoded(&body.concat())).unwrap();
    assert_eq!(
        body,
        "Step change of 5.00 ± 0.39 mrad at 2026-11-24 22:40 UTC; probable cause: slip of rope, clamp or encoder without \
         stiffness loss.\nInspect rope, clamps and encoders.\n\n\
         arm-7: Alarm “Step change” of elbow é: raised, 2026-11-25 00:00 UTC\n\
         https://cell-3.example.org/r/arm-7/elbow%20%C3%A9\n"
    );
    // An alarm below the minimum severity is not sent.
    let (port, received) = mail_server(STARTTLS);
    let to = mail(port, "severity_min = 701");
    let health = Arc::new(Health::new(1));
    let (steps, alarms) = tokio::sync::mpsc::channel(1);
    let (_wanted, wanted) = tokio::sync::watch::channel(vec![Receiver::Mail(to)]);
    block_on(async {
        let running = webhooks::run(alarms, wanted, health);
        steps
            .send(("arm-7".into(), step_change(AlarmState::Active)))
            .await
            .unwrap();
        drop(steps);
        running.await;
    });
    assert!(received.recv_timeout(Duration::from_millis(300)).is_err());
}

/// A suspected strand failure has severity 610 when it begins, and its end does not contain the cause.
#[test]
fn end_of_alarm_reaches_receiver_of_its_beginning() {
    let (port, received) = mail_server(STARTTLS);
    let mut end = step_change(AlarmState::Normal);
    let Event::Alarm { transition } = &mut end.event else {
        panic!("{end:?}");
    };
    transition.key.condition = Condition::SuspectedStep;
    transition.from = AlarmState::Active;
    let health = deliver(vec![Receiver::Mail(mail(port, "severity_min = 610"))], end);
    assert_eq!(health.counts.webhooks.load(Ordering::Relaxed), 1);
    received.recv().unwrap();
}

/// Lines of the two attempts after which a server has accepted a mail.
fn two_attempts(server: Server) -> [Vec<String>; 2] {
    let (port, received) = mail_server(server);
    let health = deliver(
        vec![Receiver::Mail(mail(port, ""))],
        step_change(AlarmState::Active),
    );
    assert_eq!(health.counts.webhooks.load(Ordering::Relaxed), 1);
    [received.recv().unwrap(), received.recv().unwrap()]
}

#[test]
fn rejected_mail_is_repeated_until_accepted() {
    let server = Server {
        rejected: 1,
        ..STARTTLS
    };
    let all = two_attempts(server);
    let has_data: Vec<bool> = all
        .iter()
        .map(|l| l.iter().any(|l| l == "TLS: DATA"))
        .collect();
    assert_eq!(has_data, [false, true]);
}

#[test]
fn mail_is_repeated_for_rejected_addresses_only() {
    let server = Server {
        rejected: 1,
        rejected_address: Some("ada@example.org"),
        ..STARTTLS
    };
    let all = two_attempts(server);
    let addresses = all.each_ref().map(|lines| {
        assert!(lines.iter().any(|l| l == "TLS: DATA"), "{lines:?}");
        let of = lines.iter().filter(|l| l.starts_with("TLS: RCPT"));
        of.map(String::as_str).collect::<Vec<&str>>()
    });
    assert_eq!(
        addresses,
        [
            vec![
                "TLS: RCPT TO:<ada@example.org>",
                "TLS: RCPT TO:<shift@example.org>"
            ],
            vec!["TLS: RCPT TO:<ada@example.org>"],
        ]
    );
    // The test button reports the address.
    let (port, _received) = mail_server(server);
    let results = block_on(webhooks::test(&[Receiver::Mail(mail(port, ""))]));
    let reason = "ada@example.org: reply 450 try later";
    assert_eq!(results[0].1, Err(reason.into()));
}

#[test]
fn mail_password_is_sent_under_tls_only() {
    // printf '\0Ada\0pass word' | base64
    for (server, keys, expected) in [
        (
            Server {
                auth: Some("LOGIN PLAIN"),
                ..STARTTLS
            },
            "",
            vec!["TLS: AUTH PLAIN AEFkYQBwYXNzIHdvcmQ="],
        ),
        (
            Server {
                auth: Some("LOGIN XOAUTH2"),
                tls: MailTls::Implicit,
                ..STARTTLS
            },
            "tls = \"implicit\"",
            vec!["TLS: AUTH LOGIN", "TLS: QWRh", "TLS: cGFzcyB3b3Jk"],
        ),
    ] {
        let (port, received) = mail_server(server);
        let login = format!("user = \"Ada\"\npassword_file = \"mail-password\"\n{keys}");
        let results = block_on(webhooks::test(&[Receiver::Mail(mail(port, &login))]));
        assert_eq!(results[0].1, Ok(()));
        let lines = received.recv().unwrap();
        let at = lines
            .iter()
            .position(|l| l.starts_with("TLS: AUTH"))
            .unwrap();
        assert_eq!(lines[at..at + expected.len()], expected, "{lines:?}");
    }
    for (server, keys, words) in [
        (
            STARTTLS,
            "user = \"Ada\"\npassword_file = \"mail-password\"",
            "neither AUTH PLAIN nor",
        ),
        (
            Server {
                tls: MailTls::Off,
                ..STARTTLS
            },
            "",
            "does not offer STARTTLS",
        ),
        (
            Server {
                injects: true,
                ..STARTTLS
            },
            "",
            "unexpected data before TLS",
        ),
        // An authority of the operating system did not issue the certificate.
        (STARTTLS, "ca_file_of_host", "TLS: "),
    ] {
        let (port, received) = mail_server(server);
        let mut to = mail(port, keys.trim_end_matches("ca_file_of_host"));
        if keys.ends_with("ca_file_of_host") {
            to.ca_file = Some(golden("tls-server.pem"));
        }
        let results = block_on(webhooks::test(&[Receiver::Mail(to)]));
        let error = results[0].1.clone().unwrap_err();
        assert!(error.contains(words), "{error}");
        let lines = received.recv().unwrap();
        assert!(
            lines
                .iter()
                .all(|l| !l.contains("MAIL") && !l.contains("AUTH ")),
            "{lines:?}"
        );
    }
    // Without encryption there is no login, but mail to a relay in the same network.
    let (port, received) = mail_server(Server {
        tls: MailTls::Off,
        ..STARTTLS
    });
    let results = block_on(webhooks::test(&[Receiver::Mail(mail(
        port,
        "tls = \"off\"",
    ))]));
    assert_eq!(results[0].1, Ok(()));
    assert!(received.recv().unwrap().iter().any(|l| l == "DATA"));
}

/// Receives one request over TLS and accepts it; returns the request.
fn https_server() -> (u16, Received<String>) {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    listener.set_nonblocking(true).unwrap();
    let (sender, received) = channel();
    std::thread::spawn(move || {
        block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener).unwrap();
            while let Ok((stream, _)) = listener.accept().await {
                let Ok(tls) = acceptor().accept(stream).await else {
                    continue;
                };
                let mut stream = BufReader::new(tls);
                let mut text = String::new();
                while !text.ends_with("\r\n\r\n") {
                    if stream.read_line(&mut text).await.unwrap_or(0) == 0 {
                        break;
                    }
                }
                let answer = b"HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n";
                stream.write_all(answer).await.unwrap();
                stream.flush().await.unwrap();
                sender.send(text).unwrap();
            }
        });
    });
    (port, received)
}

#[test]
fn webhook_over_https_checks_the_certificate() {
    let (port, received) = https_server();
    let hooks = |host: &str, keys: &str| {
        let text = format!(
            "[[webhook]]\nurl = \"https://{host}:{port}/hook\"\n{keys}\n\
             [[robot]]\nname = \"arm-7\"\ndir = \"arm-7\"\ndds = {{}}\n"
        );
        let config = Config::parse(&text, "watch.toml", Path::new("/")).unwrap();
        config.receivers
    };
    let trusted = format!("ca_file = {:?}", golden("tls-authority.pem"));
    let health = deliver(
        hooks("localhost", &trusted),
        step_change(AlarmState::Active),
    );
    assert_eq!(health.counts.webhooks.load(Ordering::Relaxed), 1);
    let request = received.recv().unwrap();
    assert!(request.starts_with("POST /hook HTTP/1.1\r\n"), "{request}");
    // A certificate for another name, and one of an unknown authority.
    let other = format!("ca_file = {:?}", golden("tls-server.pem"));
    for (host, keys) in [("127.0.0.1", &trusted), ("localhost", &other)] {
        let results = block_on(webhooks::test(&hooks(host, keys)));
        let error = results[0].1.clone().unwrap_err();
        assert!(error.contains("TLS: invalid peer certificate"), "{error}");
    }
    assert!(received.try_recv().is_err());
}

#[test]
fn test_button_reports_the_reply_of_the_mail_server() {
    let server = Server {
        rejected: 1,
        ..STARTTLS
    };
    let (port, _received) = mail_server(server);
    let receivers = vec![Receiver::Mail(mail(port, ""))];
    let at = served(&store_in_memory(9_000_005), Vec::new(), receivers);
    let test = || crate::http::post(at, "/api/v1/notify/test", "{}").json();
    let [first, second] = [test(), test()];
    assert_eq!(first["results"][0]["error"], "reply 451 try later");
    assert_eq!(second["results"][0]["error"], serde_json::Value::Null);
    let name = second["results"][0]["url"].as_str().unwrap();
    assert_eq!(
        name,
        format!("mail to ada@example.org, shift@example.org by localhost:{port}")
    );
}

/// Packets of an MQTT client until it pings: their first bytes and bodies. The broker accepts the connection.
async fn packets(stream: &mut tokio::net::TcpStream) -> Vec<(u8, Vec<u8>)> {
    let mut all = Vec::new();
    loop {
        let first = stream.read_u8().await.unwrap();
        let (mut length, mut shift) = (0, 0);
        loop {
            let byte = stream.read_u8().await.unwrap();
            length |= usize::from(byte & 127) << shift;
            shift += 7;
            if byte < 128 {
                break;
            }
        }
        let mut body = vec![0; length];
        stream.read_exact(&mut body).await.unwrap();
        match first {
            0x10 => stream.write_all(&[0x20, 2, 0, 0]).await.unwrap(),
            0xc0 => return all,
            _ => {}
        }
        all.push((first, body));
    }
}

#[test]
fn tendons_are_published_for_home_assistant() {
    let all = block_on(async {
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let port = listener.local_addr().unwrap().port();
        let text = format!(
            "[mqtt]\nbroker = \"127.0.0.1:{port}\"\nuser = \"Ada\"\npassword_file = \"mail-password\"\n\
             [[robot]]\nname = \"arm-7\"\ndir = \"arm-7\"\ndds = {{}}\n"
        );
        let config = Config::parse(&text, "watch.toml", &golden("")).unwrap();
        let registry = Arc::new(RobotRegistry::default());
        let mut snapshot = crate::ship::snapshot(Vec::new(), 30.0);
        snapshot.tendons[0].offset_rad = Some(sinew_model::Gaussian::new(0.0125, 0.0005));
        let slot = registry.slot("arm-7");
        slot.put(RobotState::Monitored(Arc::new(snapshot)));
        let health = Arc::new(Health::new(1));
        tokio::spawn(sinew_watch::mqtt::run(
            config.mqtt.unwrap(),
            registry,
            health,
        ));
        let (mut stream, _) = listener.accept().await.unwrap();
        packets(&mut stream).await
    });
    // MQTT 3.1.1, section 3.1: protocol, level 4, flags (user, password, retained will, clean session), keep-alive; then
    // identifier, topic and message of the will, user and password.
    let (first, connect) = &all[0];
    assert_eq!(*first, 0x10);
    assert_eq!(
        connect[..10],
        [0, 4, b'M', b'Q', b'T', b'T', 4, 0b1110_0110, 0, 60]
    );
    let fields = String::from_utf8_lossy(&connect[12..]).into_owned();
    assert!(
        fields.ends_with("\0\u{c}sinew/status\0\u{7}offline\0\u{3}Ada\0\u{9}pass word"),
        "{fields:?}"
    );
    let messages: Vec<(u8, String, String)> = all[1..]
        .iter()
        .map(|(first, body)| {
            let length = usize::from(body[0]) << 8 | usize::from(body[1]);
            let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
            (
                *first,
                text(&body[2..2 + length]),
                text(&body[2 + length..]),
            )
        })
        .collect();
    let of = |topic: &str| {
        let found = messages.iter().find(|(_, name, _)| name == topic);
        found.map(|(first, _, payload)| (*first, payload.as_str()))
    };
    assert_eq!(of("sinew/status"), Some((0x31, "online")));
    assert_eq!(of("sinew/arm-7/status"), Some((0x31, "online")));
    let (first, state) = of("sinew/arm-7/tendon/elbow").unwrap();
    assert_eq!(first, 0x30, "a state is not retained");
    let state: serde_json::Value = serde_json::from_str(state).unwrap();
    let near = |key: &str, value: f64| (state[key].as_f64().unwrap() - value).abs() < 1e-9;
    // 1.959964 standard deviations.
    assert!(
        near("offset_mrad", 12.5)
            && (state["offset_interval_95_mrad"].as_f64().unwrap() - 0.98).abs() < 1e-3
    );
    assert_eq!(
        (&state["limit_used_percent"], &state["alarm"]),
        (&serde_json::Value::Null, &"OK".into())
    );
    for key in ["offset_mrad", "limit_used_percent", "alarm"] {
        let topic = format!("homeassistant/sensor/sinew_arm-7/elbow_{key}/config");
        let (first, config) = of(&topic).unwrap();
        assert_eq!(first, 0x31, "a description is retained");
        let config: serde_json::Value = serde_json::from_str(config).unwrap();
        assert_eq!(config["state_topic"], "sinew/arm-7/tendon/elbow");
        assert_eq!(
            config["value_template"],
            format!("{{{{ value_json.{key} }}}}")
        );
        assert!(state.get(key).is_some());
        assert_eq!(config["availability"][0]["topic"], "sinew/status");
        let of_robot = &config["availability"][1]["topic"];
        assert_eq!(of_robot == "sinew/arm-7/status", key != "alarm");
        assert_eq!(config["device"]["name"], "arm-7");
        // A state that is no longer published, every 10 s, is not shown as current.
        assert_eq!(config["expire_after"], 60);
        let options = config["options"].as_array();
        assert_eq!(
            options.is_some_and(|o| o.contains(&state["alarm"])),
            key == "alarm"
        );
    }
}
