//! One file of records: whose it is, whether it ascends, whether it can be read.

use datafusion::arrow::array::{Array, AsArray as _, RecordBatch};
use datafusion::arrow::compute::cast;
use datafusion::arrow::datatypes::{DataType, Float64Type, SchemaRef};
use datafusion::parquet::arrow::ProjectionMask;
use datafusion::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::collections::BTreeSet;
use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Columns without which a row is no record.
const KEYS: [&str; 3] = ["robot", "joint", "time_utc_s"];
const VERSION: &str = "sinew_version";

/// A file of records.
#[derive(Debug, Clone)]
pub struct RecordFile {
    /// The file.
    pub path: PathBuf,
    /// Rows.
    pub rows: u64,
    /// Whether robot, joint and time ascend strictly: no session is in it twice.
    pub ascends: bool,
    /// Robots.
    pub robots: BTreeSet<String>,
    /// First and last time, s since 1970.
    pub times_utc_s: [f64; 2],
    /// Versions of the program.
    pub versions: BTreeSet<String>,
    /// Its columns.
    pub schema: SchemaRef,
}

/// A file that was refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub trouble: Trouble,
}

/// Why a file was refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Trouble {
    /// It isn't Parquet, is cut off or damaged: what the reader says.
    Damaged(String),
    /// It is no table of records: a column that is missing.
    NoColumn(&'static str),
    /// A column that can't be what it is called.
    WrongType(String),
    /// A row without robot, joint or time.
    NoKey,
}

impl std::fmt::Display for Trouble {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Damaged(why) => write!(f, "damaged: {why}"),
            Self::NoColumn(name) => write!(f, "no records: it has no column '{name}'"),
            Self::WrongType(why) => write!(f, "column {why}"),
            Self::NoKey => write!(f, "a row without robot, joint or time"),
        }
    }
}

/// Looks at a file: its keys, or all of it.
pub(super) fn scan(path: &Path, whole: bool) -> Result<RecordFile, Refused> {
    // A damaged file may lead the reader to a panic; it loses only itself.
    let looked = catch_unwind(AssertUnwindSafe(|| read(path, whole)));
    let damaged = || Err(Trouble::Damaged("the reader gave up".into()));
    looked
        .unwrap_or_else(|_| damaged())
        .map_err(|trouble| Refused {
            path: path.into(),
            trouble,
        })
}

fn damaged(error: impl std::fmt::Display) -> Trouble {
    Trouble::Damaged(error.to_string())
}

fn read(path: &Path, whole: bool) -> Result<RecordFile, Trouble> {
    let file = File::open(path).map_err(damaged)?;
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(damaged)?;
    let schema = builder.schema().clone();
    if let Some(missing) = KEYS.iter().find(|k| schema.index_of(k).is_err()) {
        return Err(Trouble::NoColumn(missing));
    }
    crate::columns::check_types(&schema).map_err(Trouble::WrongType)?;
    let mask = match whole {
        true => ProjectionMask::all(),
        false => {
            let names = KEYS.iter().copied().chain([VERSION]);
            ProjectionMask::columns(builder.parquet_schema(), names)
        }
    };
    let rows = builder.with_projection(mask).build().map_err(damaged)?;
    let mut out = RecordFile {
        path: path.into(),
        rows: 0,
        ascends: true,
        robots: BTreeSet::new(),
        times_utc_s: [f64::INFINITY, f64::NEG_INFINITY],
        versions: BTreeSet::new(),
        schema,
    };
    let mut last: Option<(String, String, f64)> = None;
    for batch in rows {
        take(&batch.map_err(damaged)?, &mut out, &mut last)?;
    }
    Ok(out)
}

/// Takes the keys of some rows.
fn take(
    batch: &RecordBatch,
    out: &mut RecordFile,
    last: &mut Option<(String, String, f64)>,
) -> Result<(), Trouble> {
    let column = |name: &str, to: &DataType| {
        let column = batch.column_by_name(name);
        column.map(|c| cast(c, to).map_err(damaged)).transpose()
    };
    let need = |name: &'static str, to: &DataType| column(name, to)?.ok_or(Trouble::NoColumn(name));
    let robots = need("robot", &DataType::Utf8)?;
    let joints = need("joint", &DataType::Utf8)?;
    let times = need("time_utc_s", &DataType::Float64)?;
    let versions = column(VERSION, &DataType::Utf8)?;
    if robots.null_count() + joints.null_count() + times.null_count() > 0 {
        return Err(Trouble::NoKey);
    }
    let (robots, joints) = (robots.as_string::<i32>(), joints.as_string::<i32>());
    let times = times.as_primitive::<Float64Type>();
    let mut before = last.as_ref().map(|(r, j, t)| (r.as_str(), j.as_str(), *t));
    for i in 0..batch.num_rows() {
        let key = (robots.value(i), joints.value(i), times.value(i));
        if !key.2.is_finite() {
            return Err(Trouble::NoKey);
        }
        if before.is_none_or(|b| b.0 != key.0) && !out.robots.contains(key.0) {
            out.robots.insert(key.0.to_owned());
        }
        // Written so that a time that is no number ends the order too.
        let ascends = before.is_none_or(|b| {
            (b.0, b.1) < (key.0, key.1) || (b.0, b.1) == (key.0, key.1) && b.2 < key.2
        });
        out.ascends &= ascends;
        let [first, end] = &mut out.times_utc_s;
        (*first, *end) = (first.min(key.2), end.max(key.2));
        before = Some(key);
    }
    if let Some(versions) = versions {
        let mut seen: Option<&str> = None;
        for version in versions.as_string::<i32>().iter().flatten() {
            if seen != Some(version) {
                out.versions.insert(version.to_owned());
                seen = Some(version);
            }
        }
    }
    out.rows += batch.num_rows() as u64;
    let kept = before.map(|(r, j, t)| (r.to_owned(), j.to_owned(), t));
    *last = kept;
    Ok(())
}
