//! From one file, or its bytes, to a reader of its format.

use std::fs::File;
use std::io::{Read, SeekFrom};
use std::path::Path;

use super::lerobot::{ListNames, list_names};
use super::mcap::McapReader;
use super::read_seek::ReadSeek;
use super::reader::Reader;
use super::spool::{Spool, ZSTD_MAGIC};
use super::table::CsvReader;
#[cfg(feature = "parquet")]
use super::table::ParquetReader;
use crate::error::LogError;
use crate::options::OpenOptions;

/// What an SQLite file begins with.
const SQLITE_MAGIC: &[u8] = b"SQLite f";
/// Most that is unpacked, or read from standard input, bytes.
pub(super) const UNPACKED_LIMIT_BYTES: u64 = sinew_files::limits::UNPACKED.most;

/// Opens one file, whatever its format.
pub(super) fn open_file(path: &Path, options: &OpenOptions) -> Result<Box<dyn Reader>, LogError> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|source| LogError::io(&name, "open", source))?;
    let (names, path) = (list_names(path), Some(path));
    open_reader(Box::new(file), &name, options, &names, path)
}

/// Opens what is in one file, whatever its format; `path` is where it lies.
pub(super) fn open_reader(
    mut reader: Box<dyn ReadSeek>,
    name: &str,
    options: &OpenOptions,
    names: &ListNames,
    path: Option<&Path>,
) -> Result<Box<dyn Reader>, LogError> {
    let io = |source| LogError::io(name, "read", source);
    let mut magic = Vec::new();
    reader
        .by_ref()
        .take(8)
        .read_to_end(&mut magic)
        .map_err(io)?;
    reader.seek(SeekFrom::Start(0)).map_err(io)?;
    let refuse = |reason: String| LogError::refused(name, reason);
    if magic.is_empty() {
        return Err(refuse("the file is empty".to_owned()));
    }
    let magic = &magic[..];
    if magic.starts_with(ZSTD_MAGIC) {
        let inner = name.strip_suffix(".zst").or(name.strip_suffix(".zstd"));
        let spool = zstd::Decoder::new(reader).and_then(|d| Spool::of(d, UNPACKED_LIMIT_BYTES));
        let spool = spool.map_err(|e| refuse(format!("zstd: it cannot be unpacked: {e}")))?;
        return open_spool(spool, inner.unwrap_or(name), options, names);
    }
    let extension = name.rsplit_once('.').map(|(_, extension)| extension);
    let is_named = |wanted: &str| extension.is_some_and(|e| e.eq_ignore_ascii_case(wanted));
    let opened: Box<dyn Reader> = if magic == mcap::MAGIC {
        Box::new(McapReader::open(reader, name, options)?)
    } else if magic.starts_with(b"PAR1") {
        #[cfg(not(feature = "parquet"))]
        return Err(refuse(
            "it is a Parquet file, and this program is built without them (cargo feature parquet)"
                .to_owned(),
        ));
        #[cfg(feature = "parquet")]
        Box::new(ParquetReader::open(reader, name, options, names)?)
    } else if is_named("mcap") || mcap::MAGIC.starts_with(magic) {
        return Err(refuse(
            "it does not start as an MCAP file (89 4D 43 41 50 30 0D 0A)".to_owned(),
        ));
    } else if is_named("parquet") {
        return Err(refuse(
            "it does not start as a Parquet file (PAR1)".to_owned(),
        ));
    } else if magic.starts_with(SQLITE_MAGIC) {
        #[cfg(not(feature = "db3"))]
        {
            let _nothing_is_read = path;
            return Err(refuse(
                "it is an SQLite file, such as a ROS 2 .db3 bag, and this build reads none: convert it to MCAP (ros2 bag convert), or build with cargo build --release --features db3"
                    .to_owned(),
            ));
        }
        #[cfg(feature = "db3")]
        match path {
            Some(path) => Box::new(super::db3::open(reader, path, name, options)?),
            None => {
                let spool = Spool::of(reader, UNPACKED_LIMIT_BYTES).map_err(io)?;
                return open_spool(spool, name, options, names);
            }
        }
    } else if let Some(what) = known_stranger(magic) {
        return Err(refuse(what.to_owned()));
    } else {
        Box::new(CsvReader::open(reader, name, options)?)
    };
    Ok(opened)
}

/// Opens what came once and is kept now.
fn open_spool(
    spool: Spool,
    name: &str,
    options: &OpenOptions,
    names: &ListNames,
) -> Result<Box<dyn Reader>, LogError> {
    let path = spool.path().map(Path::to_path_buf);
    open_reader(Box::new(spool), name, options, names, path.as_deref())
}

/// Formats a user may take for a recording.
fn known_stranger(magic: &[u8]) -> Option<&'static str> {
    let strangers: [(&[u8], &str); 5] = [
        (b"\x1f\x8b", "it is a gzip file; unpack it first"),
        (
            b"PK\x03\x04",
            "it is a zip file, as an XLSX workbook is; save a workbook as CSV, unpack anything else",
        ),
        (
            b"#ROSBAG",
            "it is a ROS 1 bag; convert it to MCAP (mcap convert)",
        ),
        (
            b"\x89HDF",
            "it is an HDF5 file; export it as Parquet or CSV",
        ),
        (b"%PDF", "it is a PDF file"),
    ];
    strangers
        .into_iter()
        .find(|(start, _)| magic.starts_with(start))
        .map(|(_, what)| what)
}
