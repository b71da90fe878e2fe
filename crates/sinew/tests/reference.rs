//! The reference pages name every key that a file may have, and no other.
//!
//! Readers refuse an unknown key and list the keys they know. So each section of each kind of file is
//! given an unknown key, and the keys listed in the error are compared with the page.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A key no reader knows.
const UNKNOWN: &str = "zzz";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Returns the error of a command for invalid input.
fn refusal(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(arguments)
        .current_dir(root())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success(), "{arguments:?} was not refused");
    assert!(said.contains(UNKNOWN), "{arguments:?}: {said}");
    said
}

/// The keys a refusal lists: the names after the last word that begins a list.
fn listed(refusal: &str) -> BTreeSet<String> {
    const BEGIN: [&str; 9] = [
        " available: ",
        "one of ",
        "expected ",
        " takes ",
        " are ",
        " has ",
        " known: ",
        " keys: ",
        " columns: ",
    ];
    let from = BEGIN
        .iter()
        .filter_map(|words| refusal.rfind(words).map(|at| at + words.len()))
        .max()
        .unwrap_or_else(|| panic!("lists no keys: {refusal}"));
    let list = refusal[from..].split("\n\n").next().unwrap_or_default();
    list.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '-'))
        .filter(|word| !word.is_empty() && *word != "or" && *word != "and")
        .map(str::to_string)
        .collect()
}

/// The keys of a page, with their type: rows of the tables whose first column is called "key".
fn documented(page: &str) -> BTreeMap<String, String> {
    let text = std::fs::read_to_string(root().join("docs/src/reference").join(page)).unwrap();
    let mut keys = BTreeMap::new();
    let mut of_keys = false;
    for line in text.lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, first, second, ..] = cells[..] else {
            of_keys = false;
            continue;
        };
        if first == "key" {
            of_keys = true;
        } else if of_keys && let Some(key) = first.strip_prefix('`') {
            keys.insert(key.trim_end_matches('`').to_string(), second.to_string());
        }
    }
    keys
}

/// Holds a page against what its reader lists: pairs of a section's path and a text with an unknown key
/// in that section. `named` are the tables whose names are the user's own.
fn agree(page: &str, named: &[&str], sections: &[(&str, String)], ask: impl Fn(&str) -> String) {
    let mut known: BTreeSet<String> = named.iter().map(|key| (*key).to_string()).collect();
    for (section, text) in sections {
        for key in listed(&ask(text)) {
            known.insert(match *section {
                "" => key,
                section => format!("{section}.{key}"),
            });
        }
    }
    let keys = documented(page);
    let written: BTreeSet<String> = keys.keys().cloned().collect();
    let missing: Vec<_> = known.difference(&written).collect();
    let invented: Vec<_> = written.difference(&known).collect();
    assert!(
        missing.is_empty() && invented.is_empty(),
        "docs/src/reference/{page}: not documented {missing:?}; documented, but unknown to the reader \
         (or its section isn't looked at by this test) {invented:?}"
    );
    for (table, _) in keys
        .iter()
        .filter(|(_, kind)| kind.ends_with("table") || kind.ends_with("tables"))
    {
        let inside = [format!("{table}."), format!("{table}[].")];
        assert!(
            written
                .iter()
                .any(|key| inside.iter().any(|i| key.starts_with(i.as_str()))),
            "docs/src/reference/{page}: `{table}` is a table without keys"
        );
    }
}

/// A file of this name and text in a folder of its own.
fn file(name: &str, text: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let path = path.display().to_string();
    (folder, path)
}

/// Text of a section: required text before and in it, and the unknown key at its end.
fn with(before: &str) -> String {
    format!("{before}{UNKNOWN} = 1\n")
}

#[test]
fn robot_toml() {
    let whole = std::fs::read_to_string(root().join("robots/biorob-like/robot.toml")).unwrap();
    let unknown = format!("{UNKNOWN} = 1");
    let after = |words: &str, separator: &str| {
        let at = whole.find(words).expect(words) + words.len();
        format!(
            "{}{separator}{unknown}{separator}{}",
            &whole[..at],
            &whole[at..]
        )
    };
    let tendon = "[[tendons]]\nname = \"t\"\ndrums_mm = { m = 1.0 }\nmoment_arms_mm = { elbow = 1.0 }\nstiffness_n_per_mm = 1.0\n";
    let inline = |words: &str| after(words, "").replacen(&unknown, &format!("{unknown}, "), 1);
    agree(
        "robot.md",
        &["joints.NAME", "motors.NAME"],
        &[
            ("", format!("{unknown}\n{whole}")),
            ("joints.NAME", after("[joints.elbow]", "\n")),
            ("joints.NAME.joint_friction", inline("joint_friction = { ")),
            ("joints.NAME.motor_friction", inline("motor_friction = { ")),
            ("joints.NAME.tendon", after("[joints.elbow.tendon]", "\n")),
            ("joints.NAME.tendon.guides[]", inline("guides = [{ ")),
            (
                "joints.NAME.anchors[]",
                format!("{whole}\n[[joints.elbow.anchors]]\n{unknown}\n"),
            ),
            ("tolerances", after("[tolerances]", "\n")),
            (
                "joints.NAME.spring",
                after("[joints.elbow]", "\n")
                    .replace(&unknown, &format!("spring = {{ {unknown} }}")),
            ),
            ("motors.NAME", format!("{whole}\n[motors.m]\n{unknown}\n")),
            (
                "motors.NAME.friction",
                format!("{whole}\n[motors.m]\nfriction = {{ {unknown} }}\n"),
            ),
            ("tendons[]", format!("{whole}\n{tendon}{unknown}\n")),
        ],
        |text| {
            let (folder, path) = file("robot.toml", text);
            let urdf = "biorob-like.urdf";
            let from = root().join("robots/biorob-like").join(urdf);
            std::fs::copy(from, folder.path().join(urdf)).unwrap();
            refusal(&["robot", "check", &path])
        },
    );
}

#[test]
fn mapping_files() {
    let joints = "[joints.tilt]\nq = { column = \"q.tilt_rad\" }\n";
    let mut sections = vec![
        ("", with("") + joints),
        ("time", with("[time]\ncolumn = \"time_s\"\n")),
        ("joints.NAME", with(joints)),
        ("motors.NAME", with(&format!("{joints}[motors.m]\n"))),
        ("tendons.NAME", with(&format!("{joints}[tendons.t]\n"))),
        ("mcap", with("[mcap]\n")),
    ];
    let quantities = ["q", "theta", "dq", "tau_el", "tau_m", "tau_ext"];
    let sources = quantities.map(|quantity| format!("joints.tilt.{quantity}"));
    let others = [
        "motors.m.theta",
        "motors.m.tau_m",
        "tendons.t.tension",
        "temperature",
    ];
    for source in sources.iter().map(String::as_str).chain(others) {
        let column = "column = \"a\"";
        sections.push(("SOURCE", with(&format!("[{source}]\n{column}\n"))));
        let sum = format!("[{source}]\nsum = [{{ {column}, {UNKNOWN} = 1 }}]\n");
        sections.push(("SOURCE.sum[]", sum));
    }
    agree(
        "mapping.md",
        &["joints.NAME", "motors.NAME", "tendons.NAME"],
        &sections,
        |text| {
            let (_folder, path) = file("mapping.toml", text);
            let log = "examples/05-your-own-robot/nod.csv";
            refusal(&["log", "info", log, "--mapping", &path])
        },
    );
}

#[test]
fn duty_files() {
    let block = "[[block]]\nduration_s = 1\ntension_n = 1\n";
    agree(
        "duty.md",
        &[],
        &[("", with("") + block), ("block[]", with(block))],
        |text| {
            let (_folder, path) = file("duty.toml", text);
            refusal(&["rope", "predict", "liros-dc000-0301", "--duty", &path])
        },
    );
}

#[test]
fn bench_files() {
    let bench = "strand_mm = 600\nstroke_mm = 100\nperiod_s = 10\n";
    let guide = "[[guide]]\nstrand = 1\nat_mm = 150\nradius_mm = 8\nwrap_deg = 20\n";
    let phase = "[[phase]]\nforce_n = 200\nduration_min = 240\n";
    agree(
        "bench.md",
        &[],
        &[
            ("", with(bench) + phase),
            ("guide[]", with(&format!("{bench}{phase}{guide}"))),
            ("phase[]", with(&format!("{bench}{phase}"))),
        ],
        |text| {
            let (_folder, path) = file("bench.toml", text);
            refusal(&["bench", "simulate", &path])
        },
    );
}

#[test]
fn rope_entries() {
    let rope = "name = \"mine\"\nmanufacturer = \"m\"\nproduct = \"p\"\nfibre = \"f\"\nmaterial = \"HMPE\"\n";
    let sources = "[sources]\ns = \"somewhere\"\n";
    let value = "value = 1.0, origin = \"measured\", source = \"s\"";
    let law = format!("[law]\ntoe_percent = {{ {value} }}\n");
    let tested_range = "[tested_range]\nload_share = [0.01, 0.1]\ntemperature_c = [20.0, 30.0]\nduration_s = 1.0\n";
    let correlation = "[correlation]\nparameters = [\"toe_percent\"]\nmatrix = [[1.0]]\n";
    let known = |key: &str| format!("{rope}{sources}{key} = {{ {value}, {UNKNOWN} = 1 }}\n");
    agree(
        "rope.md",
        &[],
        &[
            ("", with(rope) + sources),
            (
                "published",
                format!("{rope}{sources}[published]\n{UNKNOWN} = {{ {value} }}\n"),
            ),
            (
                "law",
                format!("{rope}{sources}[law]\n{UNKNOWN} = {{ {value} }}\n"),
            ),
            (
                "endurance",
                format!("{rope}{sources}[endurance]\n{UNKNOWN} = {{ {value} }}\n"),
            ),
            (
                "tested_range",
                with(&format!("{rope}{sources}{law}{tested_range}")),
            ),
            (
                "correlation",
                with(&format!("{rope}{sources}{law}{correlation}")),
            ),
            ("VALUE", known("[published]\ndiameter_mm")),
            ("VALUE", known("[law]\ntoe_percent")),
            ("VALUE", known("[endurance]\nknot_share")),
        ],
        |text| {
            let (folder, _) = file("mine.toml", text);
            refusal(&[
                "rope",
                "list",
                "--ropes",
                &folder.path().display().to_string(),
            ])
        },
    );
}

#[test]
fn scenario_files() {
    let hold = "[motion]\nkind = \"hold\"\n";
    let section = |text: &str| with(&format!("{hold}{text}\n"));
    let motion = |text: &str| with(&format!("[motion]\n{text}\n"));
    let drawn = |keys: &str| format!("{hold}[truth]\nmass_factor = {{ {keys}, {UNKNOWN} = 1 }}\n");
    let offset = |text: &str| {
        section(&format!(
            "[[offsets]]\njoint = \"elbow\"\nkind = \"physical\"\nrad = 0.01\n{text}"
        ))
    };
    let mut sections = vec![
        ("", with("") + hold),
        ("DRAW", drawn("min = 1, max = 2")),
        ("DRAW", drawn("mean = 1, std = 0.1")),
        ("motion", motion("kind = \"hold\"")),
        ("motion", motion("kind = \"random\"")),
        (
            "motion",
            motion("kind = \"staircase\"\njoint = \"elbow\"\nmove_s = 1\npause_s = 1"),
        ),
        (
            "motion",
            motion("kind = \"waypoints\"\nwaypoints = [{ move_s = 1 }]"),
        ),
        (
            "motion.waypoints[]",
            motion("kind = \"waypoints\"\n[[motion.waypoints]]\nmove_s = 1"),
        ),
        (
            "payloads[]",
            section("[[payloads]]\nlink = \"tool\"\nmass_kg = 1"),
        ),
        (
            "contacts[]",
            section(
                "[[contacts]]\nstart_s = 1\nduration_s = 1\nlink = \"tool\"\nforce_n = [1, 0, 0]",
            ),
        ),
        (
            "random_contacts",
            section(
                "[random_contacts]\nfraction = 0.1\nlink = \"tool\"\nforce_n = 1\nduration_s = 1",
            ),
        ),
        ("co_contraction", section("[co_contraction]\ntension_n = 1")),
        ("offsets[]", offset("shape = \"constant\"")),
        ("offsets[]", offset("shape = \"step\"\nat_s = 1")),
        (
            "offsets[]",
            offset("shape = \"ramp\"\nfrom_s = 1\nto_s = 2"),
        ),
        (
            "offsets[]",
            offset("shape = \"exponential\"\ntime_constant_s = 1"),
        ),
        (
            "offsets[]",
            offset("shape = \"table\"\ntable_s_rad = [[0, 0], [1, 0.1]]"),
        ),
        (
            "jams[]",
            section("[[jams]]\njoint = \"elbow\"\ntorque_nm = 1"),
        ),
        (
            "stops[]",
            section("[[stops]]\njoint = \"elbow\"\nupper_rad = 1"),
        ),
        (
            "sessions[]",
            section("[[sessions]]\nname = \"A\"\nfrom_s = 0\nto_s = 1"),
        ),
        (
            "faults.gaps[]",
            section("[[faults.gaps]]\nstart_s = 1\nduration_s = 1"),
        ),
    ];
    for table in [
        "controller",
        "correction",
        "contact_detection",
        "truth",
        "joint_friction",
        "motor_friction",
        "encoder",
        "motor_torque",
        "torque_sensor",
        "tension_sensor",
        "temperature",
        "record",
        "faults",
    ] {
        sections.push((table, section(&format!("[{table}]"))));
    }
    agree("scenario.md", &[], &sections, |text| {
        let (folder, path) = file("scenario.toml", text);
        let out = folder.path().join("out.mcap").display().to_string();
        refusal(&[
            "simulate",
            &path,
            "--robot",
            "robots/biorob-like",
            "--out",
            &out,
        ])
    });
}

#[test]
fn creep_tests() {
    let column = format!("{UNKNOWN}=a:N");
    agree("creep-test.md", &[], &[("", String::new())], |_| {
        let log = "examples/06-creep-test/rope-A.csv";
        refusal(&["creep", "analyze", log, "--column", &column])
    });
}

/// Names in the first column of the tables whose first column is called "column", with a cell of theirs.
fn columns(page: &str, cell: usize) -> Vec<(String, String)> {
    let text = std::fs::read_to_string(root().join("docs/src/reference").join(page)).unwrap();
    let mut of_columns = false;
    let mut columns = Vec::new();
    for line in text.lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let Some(first) = cells.get(1) else {
            of_columns = false;
            continue;
        };
        if *first == "column" {
            of_columns = true;
        } else if of_columns && !first.starts_with('-') {
            for name in first.split(", ") {
                columns.push((name.trim_matches('`').to_string(), cells[cell].to_string()));
            }
        }
    }
    columns
}

#[test]
fn columns_of_a_recording() {
    let all = columns("recordings.md", 2);
    let names = all.iter().map(|(name, _)| name.replace("JOINT", "tilt"));
    let names: Vec<String> = names.filter(|name| !name.starts_with("time_")).collect();
    assert_eq!(names.len(), 8, "{names:?}");
    for time in ["time_s", "time_ms", "time_us", "time_ns"] {
        assert!(all.iter().any(|(name, _)| name == time), "{time}");
        let row = |t: u32| format!("{t}{}\n", ",0.5".repeat(names.len()));
        let text = format!("{time},{}\n{}{}", names.join(","), row(1), row(2));
        let (_folder, path) = file("log.csv", &text);
        let output = Command::new(env!("CARGO_BIN_EXE_sinew"))
            .args(["log", "info", &path, "--quiet"])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let joint = said.lines().find(|l| l.starts_with("tilt")).expect(&said);
        assert_eq!(joint.matches("yes").count(), 6, "{said}");
        assert!(said.contains("temperature: yes"), "{said}");
        assert!(said.contains("tension recorded: TENDON\n"), "{said}");
    }
}

#[test]
fn columns_of_a_table_of_sessions() {
    let all = columns("sessions.md", 3);
    let needed: Vec<&str> = all
        .iter()
        .filter(|c| c.1 == "yes")
        .map(|c| c.0.as_str())
        .collect();
    let cell = |name: &str| match name {
        "time" => "2026-03-02",
        "baseline_time" => "2026-03-01",
        "joint" => "elbow",
        "robot" | "recording" | "baseline" => "x",
        _ => "1",
    };
    let trend = |names: &[&str]| {
        let cells: Vec<&str> = names.iter().map(|name| cell(name)).collect();
        let (_folder, path) = file(
            "sessions.csv",
            &format!("{}\n{}\n", names.join(","), cells.join(",")),
        );
        Command::new(env!("CARGO_BIN_EXE_sinew"))
            .args(["trend", &path, "--quiet"])
            .output()
            .unwrap()
    };
    let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    let output = trend(&names);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(trend(&needed).status.success(), "{needed:?} are not enough");
    for missing in &needed {
        let others: Vec<&str> = needed.iter().filter(|n| *n != missing).copied().collect();
        assert!(!trend(&others).status.success(), "{missing} is not needed");
    }
}
