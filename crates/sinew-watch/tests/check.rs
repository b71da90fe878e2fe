//! `--check` says of everything a configuration names what would go wrong, and leaves nothing behind.

use sinew_watch::check::faults;
use sinew_watch::config::Config;
use std::path::{Path, PathBuf};

fn arm() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/biorob-like")
}

/// What is wrong with a robot that is heard there.
fn of(folder: &Path, head: &str, door: &str) -> Vec<String> {
    let text = format!(
        "{head}\n[[robot]]\nname = \"arm-7\"\ndir = {:?}\n{door}\n",
        arm()
    );
    faults(&Config::parse(&text, "watch.toml", folder).unwrap())
}

/// One fault, which holds all these words.
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

/// A folder with a recording that can be read.
fn whole() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(recording(), folder.path().join("run.mcap")).unwrap();
    folder
}

#[test]
fn a_configuration_that_works_has_no_fault_and_nothing_is_made() {
    let folder = whole();
    assert_eq!(of(folder.path(), STORE, MCAP), Vec::<String>::new());
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
    // A folder in which the recorder has not begun yet, and a file it has just made.
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    let runs = "mcap = { path = \"runs\" }";
    assert_eq!(of(folder.path(), STORE, runs), Vec::<String>::new());
    std::fs::write(folder.path().join("run.mcap"), "").unwrap();
    assert_eq!(of(folder.path(), STORE, MCAP), Vec::<String>::new());
}

#[test]
fn a_recording_that_is_not_there_or_is_none_is_named_with_what_to_do() {
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
        one(&other, &["arm-7: mcap.path", "is no MCAP", "name the file"]);
    }
    // A recording whose records break right after its head.
    let mut broken = std::fs::read(recording()).unwrap();
    broken.truncate(64);
    broken[8..].fill(0xff);
    std::fs::write(folder.path().join("run.mcap"), broken).unwrap();
    one(&of(folder.path(), STORE, MCAP), &["can't be read"]);
}

#[test]
fn a_network_that_can_not_be_joined_is_named_once_for_all_its_robots() {
    let folder = tempfile::tempdir().unwrap();
    // 192.0.2.0/24 belongs to nobody (RFC 5737).
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
            "name an address of this computer in interfaces",
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
fn a_store_that_can_not_be_written_is_a_fault() {
    let folder = whole();
    // Nobody, root neither, makes a folder below a file.
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
    // One that another monitor has is that of the configuration checked before a reload.
    let held = sinew_watch::store::Store::open(sinew_watch::store::Place::Folder(
        folder.path().join("store"),
    ));
    assert_eq!(of(folder.path(), STORE, MCAP), Vec::<String>::new());
    drop(held);
}

#[test]
fn a_page_for_other_computers_needs_a_token_that_can_be_read() {
    let folder = whole();
    let open = |more: &str| format!("[web]\nbind = \"0.0.0.0:0\"\n{more}\n{STORE}");
    // Without a file of the owner's, one is made in the store.
    assert_eq!(of(folder.path(), &open(""), MCAP), Vec::<String>::new());
    let own = open("token_file = \"token\"");
    one(
        &of(folder.path(), &own, MCAP),
        &["web.token_file", "isn't there", "or leave token_file out"],
    );
    for text in ["", "short\n"] {
        std::fs::write(folder.path().join("token"), text).unwrap();
        one(
            &of(folder.path(), &own, MCAP),
            &["web.token_file", "it needs 16 at least"],
        );
    }
    std::fs::write(folder.path().join("token"), "0123456789abcdef\n").unwrap();
    assert_eq!(of(folder.path(), &own, MCAP), Vec::<String>::new());
    // This computer alone needs none.
    std::fs::remove_file(folder.path().join("token")).unwrap();
    let here = format!("[web]\nbind = \"127.0.0.1:0\"\ntoken_file = \"token\"\n{STORE}");
    assert_eq!(of(folder.path(), &here, MCAP), Vec::<String>::new());
    // A token that stands in the store already is read, too.
    std::fs::create_dir(folder.path().join("store")).unwrap();
    std::fs::write(folder.path().join("store/web-token"), "x").unwrap();
    one(&of(folder.path(), &open(""), MCAP), &["web-token"]);
}

#[test]
fn an_address_of_another_computer_and_a_webhook_without_its_token_are_faults() {
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
    // One that is taken may be that of the monitor which runs.
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let at = taken.local_addr().unwrap();
    let taken = format!("[web]\nbind = \"{at}\"\n{STORE}");
    assert_eq!(of(folder.path(), &taken, MCAP), Vec::<String>::new());
}
