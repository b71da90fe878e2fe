//! Selection of the reader for a file, or for bytes in memory.

use std::fs::File;
use std::io::{Read, SeekFrom};
use std::path::Path;

use super::lerobot::{ListNames, list_names};
use super::mcap::McapReader;
use super::read_seek::ReadSeek;
use super::reader::Reader;
use super::spool::{SQLITE_MAGIC, Spool, ZSTD_MAGIC};
use super::table::CsvReader;
#[cfg(feature = "parquet")]
use super::table::ParquetReader;
#[cfg(feature = "numpy")]
use super::table::{NPY_MAGIC, NPZ_MAGIC, NumpyReader, is_archive_of_arrays};
use crate::error::LogError;
use crate::options::OpenOptions;
use sinew_files::{Budget, ProcessorTime};

/// Bytes of the start of a file that determine its format.
const MAGIC_BYTES: u64 = 20;

/// Opens one file of any supported format.
pub(super) fn open_file(path: &Path, options: &OpenOptions) -> Result<Box<dyn Reader>, LogError> {
    let name = path.display().to_string();
    sinew_files::note_input(path);
    let file = File::open(path).map_err(|source| LogError::io(&name, "open", source))?;
    let names = list_names(path);
    if is_pipe(&file) {
        let spool = Spool::of(file, options.budget.unpacked.value());
        let spool = spool.map_err(|source| LogError::io(&name, "read", source))?;
        return open_spool(spool, &name, options, &names);
    }
    open_reader(Box::new(file), &name, options, &names, Some(path))
}

/// Whether a file is a named pipe, which cannot be read twice.
#[cfg(unix)]
fn is_pipe(file: &File) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    file.metadata().is_ok_and(|file| file.file_type().is_fifo())
}

#[cfg(not(unix))]
fn is_pipe(_file: &File) -> bool {
    false
}

/// Opens the content of one file in any format; `path` is its location.
pub(super) fn open_reader(
    mut reader: Box<dyn ReadSeek>,
    name: &str,
    options: &OpenOptions,
    names: &ListNames,
    path: Option<&Path>,
) -> Result<Box<dyn Reader>, LogError> {
    let io = |source| LogError::io(name, "read", source);
    let mut start = Vec::new();
    reader
        .by_ref()
        .take(MAGIC_BYTES)
        .read_to_end(&mut start)
        .map_err(io)?;
    reader.seek(SeekFrom::Start(0)).map_err(io)?;
    let to_error = |reason: String| LogError::not_a_recording(name, reason);
    if start.is_empty() {
        return Err(to_error("the file is empty".to_owned()));
    }
    let magic = &start[..start.len().min(mcap::MAGIC.len())];
    if magic.starts_with(ZSTD_MAGIC) {
        let inner = name.strip_suffix(".zst").or(name.strip_suffix(".zstd"));
        let budget = &options.budget;
        let packed_bytes = reader.seek(SeekFrom::End(0)).map_err(io)?;
        reader.seek(SeekFrom::Start(0)).map_err(io)?;
        let mut time = ProcessorTime::new(budget, packed_bytes);
        let spool = zstd::Decoder::new(reader)
            .and_then(|decoder| Spool::of(time.reader(decoder), budget.unpacked.value()));
        let spool = spool.map_err(|e| to_error(format!("zstd: decompression failed: {e}")))?;
        return open_spool(spool, inner.unwrap_or(name), options, names);
    }
    let extension = name.rsplit_once('.').map(|(_, extension)| extension);
    let is_named = |wanted: &str| extension.is_some_and(|e| e.eq_ignore_ascii_case(wanted));
    let reader: Box<dyn Reader> = if magic == mcap::MAGIC {
        Box::new(McapReader::open(reader, name, options)?)
    } else if magic.starts_with(b"PAR1") {
        #[cfg(not(feature = "parquet"))]
        return Err(to_error(
            "it is a Parquet file, which this build does not support (cargo feature parquet)"
                .to_owned(),
        ));
        #[cfg(feature = "parquet")]
        Box::new(ParquetReader::open(reader, name, options, names)?)
    } else if is_named("mcap") || mcap::MAGIC.starts_with(magic) {
        return Err(to_error(
            "it does not start as an MCAP file (89 4D 43 41 50 30 0D 0A)".to_owned(),
        ));
    } else if is_named("parquet") {
        return Err(to_error(
            "it does not start as a Parquet file (PAR1)".to_owned(),
        ));
    } else if magic.starts_with(SQLITE_MAGIC) {
        #[cfg(not(feature = "db3"))]
        {
            let _nothing_is_read = path;
            return Err(to_error(
                "it is an SQLite file, such as a ROS 2 .db3 bag, which this build does not support: convert it to MCAP (ros2 bag convert), or build with cargo build --release --features db3"
                    .to_owned(),
            ));
        }
        #[cfg(feature = "db3")]
        match path {
            Some(path) => Box::new(super::db3::open(reader, path, name, options)?),
            None => {
                let spool = Spool::of(reader, options.budget.unpacked.value()).map_err(io)?;
                return open_spool(spool, name, options, names);
            }
        }
    } else if is_numpy(magic, reader.as_mut(), &options.budget) {
        #[cfg(not(feature = "numpy"))]
        return Err(to_error(format!(
            "it has arrays of NumPy, which this build does not support (cargo feature numpy); python3 -c \"import numpy as np; np.savetxt('{name}.txt', np.load('{name}'))\" writes an .npy array as text"
        )));
        #[cfg(feature = "numpy")]
        Box::new(NumpyReader::open(reader, name, options)?)
    } else if let Some(reason) = other_format(&start, name) {
        return Err(to_error(reason));
    } else {
        Box::new(CsvReader::open(reader, name, options)?)
    };
    Ok(reader)
}

/// Opens a stream that has been stored in a temporary file.
fn open_spool(
    spool: Spool,
    name: &str,
    options: &OpenOptions,
    names: &ListNames,
) -> Result<Box<dyn Reader>, LogError> {
    let path = spool.path().map(Path::to_path_buf);
    open_reader(Box::new(spool), name, options, names, path.as_deref())
}

/// Whether a file has an array of NumPy, or is an archive with one.
#[cfg(feature = "numpy")]
fn is_numpy(magic: &[u8], reader: &mut dyn ReadSeek, budget: &Budget) -> bool {
    magic.starts_with(NPY_MAGIC)
        || magic.starts_with(NPZ_MAGIC) && is_archive_of_arrays(reader, budget)
}

/// Whether a file has an array of NumPy.
#[cfg(not(feature = "numpy"))]
fn is_numpy(magic: &[u8], _reader: &mut dyn ReadSeek, _budget: &Budget) -> bool {
    magic.starts_with(b"\x93NUMPY")
}

/// Content of a file of another format, and the command that converts it.
fn other_format(start: &[u8], name: &str) -> Option<String> {
    /// Format by its first bytes, and the file name extension of the converted file.
    const FORMATS: [(&[u8], &str, &str); 7] = [
        (b"#ROSBAG", "a ROS 1 bag", "mcap"),
        (b"MATLAB 5.0 MAT-file", "a MATLAB file of level 5", "npz"),
        (
            b"MATLAB 7.3 MAT-file",
            "a MATLAB file of level 7.3 (HDF5)",
            "npz",
        ),
        (b"\x89HDF", "an HDF5 file", "npz"),
        (b"\x1f\x8b", "a gzip file", ""),
        (
            b"PK\x03\x04",
            "a zip file without arrays of NumPy, such as an XLSX workbook",
            "",
        ),
        (b"%PDF", "a PDF file", ""),
    ];
    let (magic, what, extension) = FORMATS
        .into_iter()
        .find(|(magic, ..)| start.starts_with(magic))?;
    let converted = Path::new(name).with_extension(extension);
    let converted = converted.display();
    let python = |imports: &str, arrays: &str| {
        format!(
            "python3 -c \"import numpy, {imports}; numpy.savez('{converted}', **{{{arrays}}})\""
        )
    };
    let cure = match magic {
        b"#ROSBAG" => format!("convert it: mcap convert {name} {converted}"),
        b"MATLAB 5.0 MAT-file" => {
            let arrays = format!(
                "k: v for k, v in scipy.io.loadmat('{name}', squeeze_me=True).items() if k[0] != '_'"
            );
            format!("convert it: {}", python("scipy.io", &arrays))
        }
        b"MATLAB 7.3 MAT-file" | b"\x89HDF" => {
            let arrays = format!(
                "k: v[()].squeeze() for k, v in h5py.File('{name}').items() if hasattr(v, 'shape')"
            );
            format!("convert it: {}", python("h5py", &arrays))
        }
        b"\x1f\x8b" => format!("unpack it: gunzip -k {name}"),
        b"PK\x03\x04" => "save a workbook as CSV, or unpack the file".to_owned(),
        _ => return Some(format!("it is {what}")),
    };
    Some(format!("it is {what}; {cure}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_format_is_named_with_a_command_that_converts_it() {
        let cases: [(&[u8], &str); 6] = [
            (
                b"#ROSBAG V2.0\n",
                "ROS 1 bag; convert it: mcap convert runs/a.x runs/a.mcap",
            ),
            (
                b"MATLAB 5.0 MAT-file, Platform",
                "scipy.io; numpy.savez('runs/a.npz', **{k: v for k, v in scipy.io.loadmat('runs/a.x'",
            ),
            (b"MATLAB 7.3 MAT-file, Pla", "h5py.File('runs/a.x')"),
            (b"\x89HDF\r\n", "an HDF5 file; convert it: python3"),
            (b"PK\x03\x04....", "XLSX"),
            (b"\x1f\x8b......", "gunzip -k runs/a.x"),
        ];
        for (start, words) in cases {
            let reason = other_format(start, "runs/a.x").expect("another format");
            assert!(reason.contains(words), "{reason}");
        }
        assert_eq!(other_format(b"MATLAB 5 export\n0,1\n", "a.csv"), None);
    }
}
