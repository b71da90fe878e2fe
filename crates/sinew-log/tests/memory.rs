//! Memory of the readers, measured with a recording allocator: what a file states is never allocated, only what it has.
//!
//! A failed allocation ends a Rust program, so that the test is that no large one is attempted. A binary of its own: the
//! allocator would be that of every other test too, and counts by thread.

// A global allocator is an unsafe trait; this one only records and forwards to the system's.
#![allow(unsafe_code)]

#[path = "../../sinew-files/tests/support/skipped.rs"]
mod skipped;
#[allow(dead_code, reason = "the recordings of the other tests")]
mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::{Path, PathBuf};

use sinew_log::{Budget, OpenOptions, open};
use support::*;

const MIB: usize = 1 << 20;
/// Budget of the memory in these tests.
const MEMORY: usize = 4 * MIB;
/// Permitted memory: a chunk, its compressed form and a margin of their growth by doubling; buffers of readers; and a
/// multiple of the size of the file, whose cells and names are texts of 24 bytes.
const MAX_AT_ONCE_BYTES: usize = 2 * MEMORY + MIB;
const MAX_PEAK_BYTES: usize = 4 * MEMORY + 8 * MIB;
const AT_ONCE_PER_BYTE: usize = 32;
const PER_BYTE: usize = 128;

#[derive(Clone, Copy)]
struct Use {
    now: isize,
    peak: isize,
    largest: usize,
}

thread_local! {
    static USE: Cell<Use> = const { Cell::new(Use { now: 0, peak: 0, largest: 0 }) };
}

fn record(more: usize, less: usize) {
    // Threads that are terminating have no record any more; theirs is not needed.
    let _ = USE.try_with(|cell| {
        let mut used = cell.get();
        used.now += more as isize - less as isize;
        used.peak = used.peak.max(used.now);
        used.largest = used.largest.max(more);
        cell.set(used);
    });
}

struct Recording;

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Recording {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        record(layout.size(), 0);
        // SAFETY: the caller's promise is passed to the system allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        record(layout.size(), 0);
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        record(0, layout.size());
        // SAFETY: as above.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        record(size, layout.size());
        // SAFETY: as above.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Recording = Recording;

/// Reads a file to its end or its error; returns the peak of the memory and the largest allocation.
#[track_caller]
fn bounded(path: &Path) -> (usize, usize) {
    let options = OpenOptions {
        budget: Budget::RECORDING.with_memory(MEMORY as u64),
        ..OpenOptions::default()
    };
    let start = Use {
        peak: 0,
        largest: 0,
        now: 0,
    };
    USE.set(start);
    let message = match open(path, &options) {
        Err(error) => error.to_string(),
        Ok(mut recording) => loop {
            match recording.next_frame() {
                Err(error) => break error.to_string(),
                Ok(None) => break String::new(),
                Ok(Some(_)) => {}
            }
        },
    };
    let used = USE.get();
    let size = std::fs::metadata(path).map_or(0, |file| file.len()) as usize;
    let name = path.display();
    let most = MAX_AT_ONCE_BYTES + AT_ONCE_PER_BYTE * size;
    assert!(
        used.largest <= most,
        "{name}: {} bytes at once",
        used.largest
    );
    let most = MAX_PEAK_BYTES + PER_BYTE * size;
    assert!(
        used.peak <= most as isize,
        "{name}: {} bytes of {most}",
        used.peak
    );
    assert!(
        message.len() < 4000,
        "{name}: a message of {} bytes",
        message.len()
    );
    (used.peak as usize, used.largest)
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        match entry.path() {
            path if path.is_dir() => files(&path, found),
            path => found.push(path),
        }
    }
}

fn bag(compression: Option<mcap::Compression>) -> Vec<u8> {
    let options = mcap::WriteOptions::new().compression(compression);
    let mut bag = Bag::with(options.chunk_size(Some(4 << 10)));
    for step in 0..100 {
        let time = START_NS + 4 * step * MS;
        bag.joint(time, &[("a", step as f64), ("b", 0.5)]);
        bag.motor(time, &[("a", step as f64), ("b", 0.6)]);
    }
    bag.bytes()
}

/// SplitMix64 (Steele, Lea, Flood 2014), with a seed.
struct Random(u64);

impl Random {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % most as u64) as usize
    }
}

fn npy(shape: &str, bytes: usize) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [
        b"\x93NUMPY\x01\x00",
        &length[..],
        header.as_bytes(),
        &vec![0; bytes],
    ]
    .concat()
}

#[test]
fn corpus_is_read_within_budget() {
    let mut all = Vec::new();
    files(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds"),
        &mut all,
    );
    assert!(all.len() > 30, "{all:?}");
    if let Some(cases) = skipped::shared("cases") {
        files(&cases, &mut all);
    }
    let most = all.iter().map(|path| bounded(path).0).max().unwrap_or(0);
    println!("{} files, at most {most} bytes", all.len());
}

#[test]
fn statements_of_damaged_files_are_not_allocated() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(1);
    let parquet = std::fs::read(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../sinew-creep/tests/data/creep.parquet"),
    );
    let table = "time_s,q.a_rad,theta.a_rad\n0,1,2\n0.1,1,2\n0.2,2,3\n".as_bytes();
    for (name, whole) in [
        ("none.mcap", bag(None)),
        ("zstd.mcap", bag(Some(mcap::Compression::Zstd))),
        ("lz4.mcap", bag(Some(mcap::Compression::Lz4))),
        ("a.parquet", parquet.unwrap()),
        ("a.npy", npy("40, 3", 960)),
        ("a.csv", table.to_vec()),
        ("a.csv.zst", zstd::encode_all(table, 1).unwrap()),
    ] {
        let path = folder.path().join(name);
        for _ in 0..250 {
            let mut damaged = whole.clone();
            // A length field has one to eight bytes.
            for _ in 0..1 + random.below(3) {
                let at = random.below(damaged.len());
                let end = (at + 1 + random.below(8)).min(damaged.len());
                let value = [0xff, 0x7f, 0x00, random.below(256) as u8][random.below(4)];
                damaged[at..end].fill(value);
            }
            std::fs::write(&path, damaged).unwrap();
            bounded(&path);
        }
    }
}

#[test]
fn hostile_files_are_rejected_within_budget() {
    let folder = tempfile::tempdir().unwrap();
    let zeros = |bytes: usize| zstd::encode_all(&vec![0; bytes][..], 1).unwrap();
    // A chunk of 64 MiB that compresses to a few KB: beyond the budget of this test.
    let chunk = |stated: u64, packed: &[u8]| {
        let fixed = [0, 0, stated].map(u64::to_le_bytes).concat();
        let name = [&4_u32.to_le_bytes()[..], b"zstd"].concat();
        let size = (packed.len() as u64).to_le_bytes();
        let body = [&fixed, &[0; 4][..], &name, &size, packed].concat();
        [&[6][..], &(body.len() as u64).to_le_bytes(), &body].concat()
    };
    let mcap = |records: &[u8]| [mcap::MAGIC, records].concat();
    let long = format!("time_s,q.a_rad\n0,{}", "1".repeat(16 * MIB));
    let names: Vec<String> = (0..70_000).map(|k| format!("q.j{k}")).collect();
    for (name, bytes) in [
        ("chunk.mcap", mcap(&chunk(64 << 20, &zeros(64 * MIB)))),
        (
            "bombs.mcap",
            mcap(&chunk(4 << 20, &zeros(4 * MIB)).repeat(50)),
        ),
        ("claim.mcap", mcap(&chunk(1 << 40, &[0; 30]))),
        (
            "record.mcap",
            mcap(&[&[5, 0xff, 0xff, 0xff, 0xff, 0xff, 0, 0, 0][..], &[0; 40]].concat()),
        ),
        ("shape.npy", npy("1099511627776, 3", 48)),
        ("wide.npy", npy("2, 70000", 48)),
        ("line.csv", long.into_bytes()),
        ("wide.csv", names.join(",").into_bytes()),
        ("empty.csv", b",".repeat(MIB)),
        ("deep.csv.zst", zeros(64 * MIB)),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let (peak, largest) = bounded(&path);
        println!("{name}: {peak} bytes, at most {largest} at once");
    }
}

#[cfg(feature = "db3")]
#[test]
fn long_messages_of_bag_are_kept_one_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db3");
    let bag = rusqlite::Connection::open(&path).unwrap();
    bag.execute_batch(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
         CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
         INSERT INTO topics VALUES (1, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr');",
    )
    .unwrap();
    let packed = |data: &[u8]| zstd::encode_all(data, 1).unwrap();
    let first = packed(&little(&joint_state(START_NS, &[("a", 0.0)])));
    let long = packed(&vec![0; MEMORY]);
    for k in 0..100_i64 {
        let data = if k == 0 { &first } else { &long };
        let text = "INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?1, ?2)";
        bag.execute(text, rusqlite::params![START_NS + k, data])
            .unwrap();
    }
    bounded(&path);
}
