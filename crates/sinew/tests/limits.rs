//! Hostile inputs end in a refusal, within 2 GB of memory and a few seconds; the manual lists the bounds.

use sinew_files::Budget;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use zip::write::SimpleFileOptions;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Longer than any of these inputs takes on a slow machine, s.
const PATIENCE_S: f64 = 60.0;

/// Runs `sinew` with 2 GB of address space, and returns its exit code and stderr.
#[track_caller]
fn bounded(dir: &Path, line: &str) -> (i32, String) {
    let begun = Instant::now();
    let output = Command::new("sh")
        .args(["-c", &format!("ulimit -v 2000000; \"$0\" {line}")])
        .arg(env!("CARGO_BIN_EXE_sinew"))
        .current_dir(dir)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let short: String = said.chars().take(600).collect();
    for never in ["panicked", "memory allocation", "overflowed its stack"] {
        assert!(!said.contains(never), "{line}: {short}");
    }
    assert!(begun.elapsed().as_secs_f64() < PATIENCE_S, "{line}");
    let code = output.status.code();
    (
        code.unwrap_or_else(|| panic!("{line}: {:?}: {short}", output.status)),
        said,
    )
}

/// Refused with these words.
#[track_caller]
fn refused(dir: &Path, line: &str, words: &str) {
    let (code, said) = bounded(dir, line);
    let short: String = said.chars().take(600).collect();
    assert_eq!(code, 1, "{line}: {short}");
    assert!(said.contains(words), "{line}: '{words}' is not in: {short}");
}

fn write(dir: &Path, name: &str, text: impl AsRef<[u8]>) {
    std::fs::write(dir.join(name), text).unwrap();
}

/// Makes a sparse file of a given size in bytes.
fn sparse(dir: &Path, name: &str, bytes: u64) {
    let file = std::fs::File::create(dir.join(name)).unwrap();
    file.set_len(bytes).unwrap();
}

/// A chain of joints, each described in `robot.toml`.
fn chain(dir: &Path, joints: usize) {
    let mut urdf = String::from("<robot name='r'><link name='l0'/>");
    let mut toml = String::from("urdf = \"r.urdf\"\n");
    for i in 0..joints {
        let next = i + 1;
        let _ = writeln!(
            urdf,
            "<link name='l{next}'><inertial><mass value='1'/>\
             <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>\
             <joint name='j{i}' type='revolute'><parent link='l{i}'/><child link='l{next}'/>\
             <axis xyz='0 0 1'/></joint>"
        );
        let _ = writeln!(toml, "[joints.j{i}]\nstiffness_nm_per_rad = 100");
    }
    write(dir, "r.urdf", urdf + "</robot>");
    write(dir, "robot.toml", toml);
}

#[test]
fn oversized_robots_are_rejected() {
    let dir = tempfile::tempdir().unwrap();
    let robot = "urdf = \"r.urdf\"\n[joints.j0]\nstiffness_nm_per_rad = 100\n";
    write(dir.path(), "robot.toml", robot);
    for (deep, words) in [
        (16_000, "has no link"),
        (100_000, "has no link"),
        (1_000_000, "nodes limit"),
    ] {
        let urdf = format!(
            "<robot>{}{}</robot>",
            "<a>".repeat(deep),
            "</a>".repeat(deep)
        );
        write(dir.path(), "r.urdf", urdf);
        refused(dir.path(), "robot check .", words);
    }
    let most = Budget::DESCRIPTION.columns.length();
    chain(dir.path(), most);
    // A chain of such links is implausible.
    assert_eq!(bounded(dir.path(), "robot check .").0, 3);
    for joints in [most + 1, 8000] {
        chain(dir.path(), joints);
        refused(
            dir.path(),
            "robot check .",
            "a robot has at most 256 moving joints",
        );
    }
    write(
        dir.path(),
        "robot.toml",
        robot.replace("r.urdf", "/dev/zero"),
    );
    refused(dir.path(), "robot check .", "/dev/zero: is a device");
    sparse(dir.path(), "robot.toml", 1 << 40);
    refused(dir.path(), "robot check .", "1099511627776 bytes");
    refused(dir.path(), "robot check /dev/zero", "is a device");
}

#[test]
fn oversized_simulations_are_rejected() {
    let dir = tempfile::tempdir().unwrap();
    let scenario = repository().join("examples/scenarios/stretched-arm.toml");
    let robot = repository()
        .join("robots/biorob-like")
        .display()
        .to_string();
    let text = std::fs::read_to_string(&scenario).unwrap();
    let without: Vec<&str> = text
        .lines()
        .filter(|l| !l.starts_with("duration_s"))
        .collect();
    for (name, first) in [
        ("long", "duration_s = 1e300"),
        ("settle", "duration_s = 1\nsettle_s = 1e300"),
    ] {
        let rest = without
            .iter()
            .filter(|l| name != "settle" || !l.starts_with("settle_s"));
        let rest: Vec<&str> = rest.copied().collect();
        write(
            dir.path(),
            "a.toml",
            format!("{first}\n{}", rest.join("\n")),
        );
        let line = format!("simulate a.toml --robot {robot} --out a.csv");
        refused(dir.path(), &line, "at most 10000000000 integration steps");
    }
    let scenario = scenario.display();
    for duration in ["1e300", "1e8"] {
        let line = format!("simulate {scenario} --robot {robot} --out a.csv --duration {duration}");
        refused(dir.path(), &line, "at most 10000000000 integration steps");
    }
    refused(
        dir.path(),
        &format!("simulate /dev/zero --robot {robot} --out a.csv"),
        "is a device",
    );
    sparse(dir.path(), "big.toml", 1 << 40);
    refused(
        dir.path(),
        "simulate big.toml --out a.csv",
        "at most 4194304 bytes",
    );
    refused(
        dir.path(),
        "bench simulate big.toml --rope dyneema-dm20",
        "at most 4194304 bytes",
    );
    refused(
        dir.path(),
        "bench simulate /dev/zero --rope dyneema-dm20",
        "is a device",
    );
}

#[test]
fn oversized_baseline_is_rejected() {
    let dir = tempfile::tempdir().unwrap();
    let robot = repository()
        .join("robots/biorob-like")
        .display()
        .to_string();
    sparse(dir.path(), "b.json", Budget::TABLE.memory.most + 1);
    write(dir.path(), "a.csv", "time_s,q.a\n0,0\n1,1\n");
    for baseline in ["b.json", "/dev/zero"] {
        let line = format!("estimate a.csv --robot {robot} --baseline {baseline}");
        let words = if baseline == "b.json" {
            "at most 268435456 bytes"
        } else {
            "is a device"
        };
        refused(dir.path(), &line, words);
    }
}

#[test]
fn recordings_with_wrong_lengths_terminate() {
    let dir = tempfile::tempdir().unwrap();
    let robot = repository()
        .join("robots/biorob-like")
        .display()
        .to_string();
    let scenario = repository().join("examples/scenarios/stretched-arm.toml");
    let scenario = scenario.display();
    let line =
        format!("simulate {scenario} --robot {robot} --out a.mcap --duration 2 --compression none");
    assert_eq!(bounded(dir.path(), &line).0, 0);
    let whole = std::fs::read(dir.path().join("a.mcap")).unwrap();
    let u64_at = |at: usize| u64::from_le_bytes(whole[at..at + 8].try_into().unwrap());
    // Records of the file: an operation code, a length, the content.
    let mut at = 8;
    let mut chunk = None;
    while at + 9 < whole.len() && chunk.is_none() {
        if whole[at] == 0x06 {
            chunk = Some(at);
        }
        at += 9 + u64_at(at + 1) as usize;
    }
    let chunk = chunk.expect("a chunk");
    // In a chunk: two times, the size, its checksum, the name of the packing, the length, records.
    let mut at = chunk + 9 + 8 + 8 + 8 + 4 + 4 + 8;
    while whole[at] != 0x05 || whole[at + 9..at + 11] == [1, 0] {
        at += 9 + u64_at(at + 1) as usize;
    }
    // A message: channel, number, two times; its payload: CDR's four bytes, a stamp, a text, a list.
    let message = at + 9;
    let text = message + 22 + 4 + 8;
    let list = text + 4 + 4;
    for (name, place, bytes) in [
        ("text", text, &[0xff; 4][..]),
        ("text2", text, &[0xff, 0xff, 0xff, 0x7f]),
        ("list", list, &[0xff; 4]),
        ("message", at + 1, &[0xff; 8]),
        (
            "chunk",
            chunk + 1,
            &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x0f],
        ),
        ("size", chunk + 9 + 16, &[0, 0, 0, 0, 0, 1, 0, 0]),
    ] {
        let mut lies = whole.clone();
        lies[place..place + bytes.len()].copy_from_slice(bytes);
        // Without checksum the wrong length is used until it is checked.
        lies[chunk + 9 + 24..][..4].fill(0);
        write(dir.path(), "b.mcap", &lies);
        for command in [
            "log info b.mcap".to_owned(),
            format!("estimate b.mcap --robot {robot}"),
        ] {
            let (code, said) = bounded(dir.path(), &command);
            assert!((0..=3).contains(&code), "{name}: {command}: {said}");
        }
    }
    write(dir.path(), "line.csv", vec![b'1'; 100 << 20]);
    refused(dir.path(), "log info line.csv", "line.csv");
    let mut long = b"time_s,q.a\n0,0\n1,".to_vec();
    long.resize(100 << 20, b'1');
    write(dir.path(), "line.csv", long);
    refused(
        dir.path(),
        &format!("estimate line.csv --robot {robot}"),
        "line.csv",
    );
    for device in ["/dev/zero", "/dev/null"] {
        refused(dir.path(), &format!("log info {device}"), device);
    }
}

/// A workbook whose one sheet has these rows, and these shared texts.
fn workbook(rows: &str, texts: &str) -> Vec<u8> {
    const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>";
    const MAIN: &str = "xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\"";
    const REL: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006";
    let parts = [
        (
            "[Content_Types].xml",
            format!("{HEAD}<Types xmlns=\"{PACKAGE}/content-types\"></Types>"),
        ),
        (
            "_rels/.rels",
            format!(
                "{HEAD}<Relationships xmlns=\"{PACKAGE}/relationships\"><Relationship Id=\"a\" \
                 Type=\"{REL}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
            ),
        ),
        (
            "xl/workbook.xml",
            format!(
                "{HEAD}<workbook {MAIN} xmlns:r=\"{REL}\"><sheets><sheet name=\"s\" sheetId=\"1\" \
                 r:id=\"b\"/></sheets></workbook>"
            ),
        ),
        (
            "xl/_rels/workbook.xml.rels",
            format!(
                "{HEAD}<Relationships xmlns=\"{PACKAGE}/relationships\"><Relationship Id=\"b\" \
                 Type=\"{REL}/worksheet\" Target=\"worksheets/sheet1.xml\"/></Relationships>"
            ),
        ),
        (
            "xl/sharedStrings.xml",
            format!("{HEAD}<sst {MAIN}>{texts}</sst>"),
        ),
        (
            "xl/worksheets/sheet1.xml",
            format!("{HEAD}<worksheet {MAIN}><sheetData>{rows}</sheetData></worksheet>"),
        ),
    ];
    let mut out = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in parts {
        out.start_file(name, SimpleFileOptions::default()).unwrap();
        out.write_all(text.as_bytes()).unwrap();
    }
    out.finish().unwrap().into_inner()
}

#[cfg(feature = "sheets")]
#[test]
fn workbook_memory_is_bounded_by_cells() {
    let dir = tempfile::tempdir().unwrap();
    let text = |place: &str, text: &str| {
        format!("<c r=\"{place}\" t=\"inlineStr\"><is><t>{text}</t></is></c>")
    };
    let mut test = format!(
        "<row r=\"3\">{}{}</row>",
        text("B3", "time (h)"),
        text("C3", "Strain [%]")
    );
    for k in 0..60 {
        let (row, hours, strain) = (
            k + 4,
            10.0_f64.powf(f64::from(k) / 20.0),
            1.0 + 0.01 * f64::from(k),
        );
        let _ = write!(
            test,
            "<row r=\"{row}\"><c r=\"B{row}\"><v>{hours}</v></c><c r=\"C{row}\"><v>{strain}</v></c></row>"
        );
    }
    let analyze = "creep analyze a.xlsx";
    write(dir.path(), "a.xlsx", workbook(&test, ""));
    let (code, said) = bounded(dir.path(), analyze);
    assert_eq!(code, 0, "{said}");
    let stray = format!("{test}<row r=\"1048576\">{}</row>", text("XFD1048576", "x"));
    write(dir.path(), "a.xlsx", workbook(&stray, ""));
    let (code, said) = bounded(dir.path(), analyze);
    assert_eq!(code, 0, "a stray cell far off: {said}");
    let mut far = test.clone();
    for row in 100..3000 {
        let _ = write!(far, "<row r=\"{row}\"><c r=\"XFD{row}\"><v>1</v></c></row>");
    }
    write(dir.path(), "a.xlsx", workbook(&far, ""));
    refused(dir.path(), analyze, "at most 16000000 cells");
    let long = format!("<row r=\"1\">{}</row>", text("A1", &"x".repeat(2 << 20)));
    write(dir.path(), "a.xlsx", workbook(&(long + &test), ""));
    refused(dir.path(), analyze, "at most 1048576 bytes");
    let texts = "<si><t>a</t></si>".repeat(8_000_000);
    write(dir.path(), "a.xlsx", workbook(&test, &texts));
    refused(dir.path(), analyze, "at most 16000000 cells");
}

#[test]
fn oversized_creep_tests_are_rejected() {
    let dir = tempfile::tempdir().unwrap();
    write(
        dir.path(),
        "a.csv",
        format!("time_s,strain\n{}", "1,1\n".repeat(3_000_000)),
    );
    refused(dir.path(), "creep analyze a.csv", "at most 16000000 cells");
    sparse(dir.path(), "a.csv", Budget::TABLE.memory.most + 1);
    refused(dir.path(), "creep analyze a.csv", "at most 268435456 bytes");
    refused(dir.path(), "creep analyze /dev/zero", "is a device");
}

#[test]
fn manual_lists_every_limit() {
    let path = repository().join("docs/src/reference/limits.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let mut table = String::from("| what | most | why |\n|---|---|---|\n");
    let mut listed = Vec::new();
    for limit in Budget::ALL.iter().flat_map(Budget::limits) {
        if listed.contains(&limit) {
            continue;
        }
        listed.push(limit);
        let (of, has) = limit.of.rsplit_once(' ').unwrap_or((limit.of, ""));
        let most = match (limit.unit, limit.most) {
            ("bytes", most) if most >= 1 << 30 => format!("{} GiB", most >> 30),
            ("bytes", most) => format!("{} MiB", most >> 20),
            (unit, most) => format!("{} {unit}", thousands(most)),
        };
        let _ = writeln!(table, "| {of} {has} at most | {most} | {} |", limit.reason);
    }
    let (before, after) = page.split_once("| what |").expect("a table");
    let after = after.split_once("\n\n").expect("text after the table").1;
    let wanted = format!("{before}{table}\n{after}");
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::write(&path, wanted).unwrap();
    } else {
        assert!(
            page == wanted,
            "SINEW_WRITE=1 writes the table anew:\n{table}"
        );
    }
}

fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let groups = digits.as_bytes().rchunks(3).rev();
    let groups: Vec<&str> = groups.map(|g| std::str::from_utf8(g).unwrap()).collect();
    groups.join(",")
}
