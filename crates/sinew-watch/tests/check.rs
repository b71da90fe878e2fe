//! `--check` reports every fault of a configuration and creates nothing.

use sinew_watch::check::faults;
use sinew_watch::config::Config;
use std::path::{Path, PathBuf};

fn arm() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/biorob-like")
}

/// Faults of a configuration with one robot behind this transport.
fn of(folder: &Path, head: &str, transport: &str) -> Vec<String> {
    let text = format!(
        "{head}\n[[robot]]\nname = \"arm-7\"\ndir = {:?}\n{transport}\n",
        arm()
    );
    faults(&Config::parse(&text, "watch.toml", folder).unwrap())
}

/// Panics unless there is exactly one fault that contains all these words.
fn one(faults: &[String], words: &[&str]) {
    let [fault] = faults else {
        panic!("not one fault: {faults:?}, wanted {words:?}")
    };
    for word in words {
        assert!(fault.contains(word), "'{word}' is missing: {fault}");
    }
}

const STORE: &str = "[store]\ndir = \"store\"\n";
const MCAP: &str = "mcap = { path = \"run.mcap\" }";

fn recording() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("demo/arm.mcap")
}

/// Folder with a readable recording.
fn whole() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(recording(), folder.path().join("run.mcap")).unwrap();
    folder
}

#[test]
fn check_valid_configuration_has_no_faults() {
    let folder = whole();
    assert_eq!(of(folder.path(), STORE, MCAP), Vec::<String>::new());
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
    // Folder in which the recorder has not started yet, and file that it has just created.
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    let runs = "mcap = { path = \"runs\" }";
    assert_eq!(of(folder.path(), STORE, runs), Vec::<String>::new());
    std::fs::write(folder.path().join("run.mcap"), "").unwrap();
    assert_eq!(of(folder.path(), STORE, MCAP), Vec::<String>::new());
}

#[test]
fn check_missing_or_invalid_recording_suggests_fix() {
    let folder = tempfile::tempdir().unwrap();
    let absent = of(folder.path(), STORE, MCAP);
    let path = folder.path().join("run.mcap").display().to_string();
    one(
        &absent,
        &["arm-7: mcap.path", &path, "start the recorder first"],
    );
    for bytes in [&b"time,q\n0,1\n"[..], &[0x89, b'M', b'C', b'A', b'P', b'1']] {
        std::fs::write(folder.path().join("run.mcap"), bytes).unwrap();
        let other = of(folder.path(), STORE, MCAP);
        one(&other, &["arm-7: mcap.path", "not an MCAP", "set the file"]);
    }
    // Recording with corrupt records right after its header.
    let mut broken = std::fs::read(recording()).unwrap();
    broken.truncate(64);
    broken[8..].fill(0xff);
    std::fs::write(folder.path().join("run.mcap"), broken).unwrap();
    one(&of(folder.path(), STORE, MCAP), &["cannot be read"]);
}

#[test]
fn check_unreachable_network_is_reported_once() {
    let folder = tempfile::tempdir().unwrap();
    // 192.0.2.0/24 is not assigned (RFC 5737).
    let away = "dds = { domain = 7, interfaces = [\"192.0.2.7\"] }";
    let two = format!(
        "{away}\n[[robot]]\nname = \"arm-8\"\ndir = {:?}\n{away}",
        arm()
    );
    one(
        &of(folder.path(), STORE, &two),
        &[
            "arm-7, arm-8: dds",
            "192.0.2.7",
            "set an address of this host in interfaces",
        ],
    );
    one(
        &of(
            folder.path(),
            STORE,
            "zenoh = { connect = [\"tcp/127.0.0.1:1\"] }",
        ),
        &["arm-7: zenoh", crate::WITHOUT_ZENOH],
    );
}

#[test]
fn check_read_only_store_is_a_fault() {
    let folder = whole();
    // Not even root can create a folder below a file.
    std::fs::write(folder.path().join("file"), "").unwrap();
    one(
        &of(folder.path(), "[store]\ndir = \"file/store\"\n", MCAP),
        &["store.dir", "file/store", "a folder that"],
    );
    std::fs::create_dir(folder.path().join("store")).unwrap();
    let database = folder.path().join("store/watch.db");
    std::fs::write(&database, "a list of things\n".repeat(100)).unwrap();
    one(&of(folder.path(), STORE, MCAP), &["store.dir", "watch.db"]);
    std::fs::remove_file(&database).unwrap();
    // A store in use may belong to the running monitor before a reload.
    let held = sinew_watch::store::Store::open(sinew_watch::store::Place::Folder(
        folder.path().join("store"),
    ));
    assert_eq!(of(folder.path(), STORE, MCAP), Vec::<String>::new());
    drop(held);
}

#[test]
fn check_public_page_requires_readable_token() {
    let folder = whole();
    let open = |more: &str| format!("[web]\nbind = \"0.0.0.0:0\"\n{more}\n{STORE}");
    // Without a specified file, a token is created in the store.
    assert_eq!(of(folder.path(), &open(""), MCAP), Vec::<String>::new());
    let own = open("token_file = \"token\"");
    one(
        &of(folder.path(), &own, MCAP),
        &["web.token_file", "file not found", "or remove token_file"],
    );
    for text in ["", "short\n"] {
        std::fs::write(folder.path().join("token"), text).unwrap();
        one(
            &of(folder.path(), &own, MCAP),
            &["web.token_file", "expected at least 16"],
        );
    }
    std::fs::write(folder.path().join("token"), "0123456789abcdef\n").unwrap();
    assert_eq!(of(folder.path(), &own, MCAP), Vec::<String>::new());
    // Access from this host only requires no token.
    std::fs::remove_file(folder.path().join("token")).unwrap();
    let here = format!("[web]\nbind = \"127.0.0.1:0\"\ntoken_file = \"token\"\n{STORE}");
    assert_eq!(of(folder.path(), &here, MCAP), Vec::<String>::new());
    // An existing token in the store is also checked.
    std::fs::create_dir(folder.path().join("store")).unwrap();
    std::fs::write(folder.path().join("store/web-token"), "x").unwrap();
    one(&of(folder.path(), &open(""), MCAP), &["web-token"]);
}

#[test]
fn check_foreign_address_and_missing_token_are_faults() {
    let folder = whole();
    let away = format!(
        "[web]\nbind = \"192.0.2.7:8642\"\ntoken_file = \"token\"\n{STORE}\
         [[webhook]]\nurl = \"http://a/\"\ntoken_file = \"hook\"\n"
    );
    std::fs::write(folder.path().join("token"), "0123456789abcdef\n").unwrap();
    let faults = of(folder.path(), &away, MCAP);
    let [bind, hook] = &faults[..] else {
        panic!("{faults:?}")
    };
    assert!(bind.contains("web.bind = 192.0.2.7:8642"), "{bind}");
    assert!(hook.contains("webhook[0].token_file"), "{hook}");
    std::fs::write(folder.path().join("hook"), " \n").unwrap();
    let faults = of(folder.path(), &away, MCAP);
    assert!(faults[1].contains("is empty"), "{faults:?}");
    let mail = format!(
        "[web]\nbind = \"127.0.0.1:0\"\n{STORE}[[mail]]\nserver = \"a\"\nfrom = \"a@b\"\nto = [\"a@b\"]\n\
         user = \"a\"\npassword_file = \"hook\"\nca_file = \"token\"\n"
    );
    let faults = of(folder.path(), &mail, MCAP);
    assert!(faults[0].contains("mail[0].password_file"), "{faults:?}");
    if cfg!(feature = "tls") {
        assert!(faults[1].contains("no PEM certificate"), "{faults:?}");
    }
    // An address in use may belong to the running monitor.
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let at = taken.local_addr().unwrap();
    let taken = format!("[web]\nbind = \"{at}\"\n{STORE}");
    assert_eq!(of(folder.path(), &taken, MCAP), Vec::<String>::new());
}
