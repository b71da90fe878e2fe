//! Records as tables of DataFusion: each session once, whatever was copied twice.

use crate::FleetError;
use crate::args::Source;
use crate::columns::data_type;
use crate::folder::{Folder, RECORDS, RecordFile, SIDES, side};
use crate::functions;
use crate::sessions::{self, Sessions};
use datafusion::arrow::array::{AsArray as _, RecordBatch};
use datafusion::arrow::datatypes::{Field, Int64Type, Schema, SchemaRef};
use datafusion::common::TableReference;
use datafusion::datasource::MemTable;
use datafusion::datasource::file_format::parquet::ParquetFormat;
use datafusion::datasource::listing::{
    ListingOptions, ListingTable, ListingTableConfig, ListingTableUrl,
};
use datafusion::error::DataFusionError;
use datafusion::execution::memory_pool::FairSpillPool;
use datafusion::execution::runtime_env::RuntimeEnvBuilder;
use datafusion::logical_expr::type_coercion::functions::fields_with_udf;
use datafusion::prelude::{CsvReadOptions, DataFrame, SessionConfig, SessionContext};
use sinew_watch_core::table::COLUMNS;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file's address: no character of its name is a pattern.
fn url_of(path: &Path) -> Result<url::Url, FleetError> {
    let wrong = |source| FleetError::Folder {
        path: path.into(),
        source,
    };
    let path = std::fs::canonicalize(path).map_err(wrong)?;
    url::Url::from_file_path(&path).map_err(|()| wrong(std::io::ErrorKind::InvalidFilename.into()))
}

/// Columns of all files: those of a record, then what some file has besides.
fn columns(folder: &Folder) -> SchemaRef {
    let mut fields: Vec<Field> = (COLUMNS.iter())
        .map(|name| Field::new(*name, data_type(name), true))
        .collect();
    for field in folder.files().flat_map(|file| file.schema.fields()) {
        if !fields.iter().any(|f| f.name() == field.name()) {
            fields.push(field.as_ref().clone().with_nullable(true));
        }
    }
    Arc::new(Schema::new(fields))
}

/// Tables of a folder.
pub struct Engine {
    /// What the folder holds.
    pub folder: Folder,
    context: SessionContext,
    runtime: tokio::runtime::Runtime,
    source: Source,
    /// Folders of robot types beside those in `types/`, for the functions of Sinew.
    described: Vec<PathBuf>,
}

impl Engine {
    /// Opens a folder.
    ///
    /// # Errors
    /// [`FleetError`].
    pub fn open(source: &Source) -> Result<Self, FleetError> {
        Self::of(source, Folder::open(&source.folder)?, &[])
    }

    /// Opens a folder and reads all of every file.
    ///
    /// # Errors
    /// [`FleetError`].
    pub fn verified(source: &Source) -> Result<Self, FleetError> {
        Self::of(source, Folder::verified(&source.folder)?, &[])
    }

    /// Opens a folder whose robot types are described elsewhere, too.
    ///
    /// # Errors
    /// [`FleetError`].
    pub fn described(source: &Source, described: &[PathBuf]) -> Result<Self, FleetError> {
        Self::of(source, Folder::open(&source.folder)?, described)
    }

    fn of(source: &Source, folder: Folder, described: &[PathBuf]) -> Result<Self, FleetError> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .enable_all()
            .build()
            .map_err(|e| FleetError::Engine(format!("can't start threads: {e}")))?;
        let pool = FairSpillPool::new(source.memory_mb as usize * 1_000_000);
        let environment = RuntimeEnvBuilder::new()
            .with_memory_pool(Arc::new(pool))
            .build_arc()?;
        let mut config = SessionConfig::new().with_information_schema(true);
        config.options_mut().execution.parquet.pushdown_filters = true;
        // A sort keeps so much back for its last step; the default is ten times a small pool's share.
        config.options_mut().execution.sort_spill_reservation_bytes = 2_000_000;
        let context = SessionContext::new_with_config_rt(config, environment);
        let engine = Self {
            folder,
            context,
            runtime,
            source: source.clone(),
            described: described.to_vec(),
        };
        functions::register(&engine.context, &engine.folder.path, described);
        engine.runtime.block_on(engine.register())?;
        Ok(engine)
    }

    /// Makes the tables.
    async fn register(&self) -> Result<(), FleetError> {
        let schema = columns(&self.folder);
        self.files("_clean", &self.folder.clean, &schema)?;
        self.files("_doubtful", &self.folder.doubtful, &schema)?;
        let names: Vec<String> = (schema.fields().iter())
            .map(|f| format!("\"{}\"", f.name()))
            .collect();
        let names = names.join(", ");
        let session = "robot, joint, time_utc_s";
        // Of what differs under one key the better founded, and then whichever, but always the same.
        let better =
            "frames DESC NULLS LAST, offset_deviation_rad NULLS LAST, offset_rad, source, baseline";
        let view = |name: &str, key: &str, order: &str| {
            let clean = format!("SELECT {names} FROM _clean");
            let once = format!(
                "SELECT {names} FROM (SELECT *, row_number() OVER (PARTITION BY {key} ORDER BY {order}) AS _nth \
                 FROM _doubtful) WHERE _nth = 1"
            );
            let parts = match (
                self.folder.clean.is_empty(),
                self.folder.doubtful.is_empty(),
            ) {
                (_, true) => clean,
                (true, false) => once,
                (false, false) => format!("{clean} UNION ALL {once}"),
            };
            format!("CREATE VIEW {name} AS {parts}")
        };
        let version = self.version_order();
        let views = [
            view(
                "every_version",
                &format!("{session}, sinew_version"),
                better,
            ),
            view("records", session, &format!("{version} DESC, {better}")),
        ];
        for sql in views {
            self.context.sql(&sql).await?;
        }
        for name in SIDES {
            if let Some(path) = side(&self.folder.path, name) {
                let path = url_of(&path)?.to_string();
                let options = CsvReadOptions::new()
                    .comment(b'#')
                    .schema_infer_max_records(10_000);
                // In memory a join knows how few they are, and keeps them there instead of the records, whichever comes first.
                let frame = self.context.read_csv(&path, options.clone()).await?;
                let schema = Arc::new(frame.schema().as_arrow().clone());
                match frame.collect().await {
                    Ok(rows) => {
                        let table = MemTable::try_new(schema, vec![rows])?;
                        self.context.register_table(name, Arc::new(table))?;
                    }
                    // Whoever asks for it is told what is wrong with it.
                    Err(_) => self.context.register_csv(name, path, options).await?,
                }
            }
        }
        Ok(())
    }

    /// Order of versions as SQL: larger is newer.
    fn version_order(&self) -> String {
        let known = self.folder.versions();
        if known.is_empty() {
            return "1".into();
        }
        let whens: Vec<String> = (known.iter().enumerate())
            .map(|(i, v)| format!("WHEN '{}' THEN {}", v.replace('\'', "''"), i + 1))
            .collect();
        format!("CASE sinew_version {} ELSE 0 END", whens.join(" "))
    }

    fn files(
        &self,
        name: &str,
        files: &[RecordFile],
        schema: &SchemaRef,
    ) -> Result<(), FleetError> {
        if files.is_empty() {
            let none = datafusion::datasource::empty::EmptyTable::new(schema.clone());
            self.context.register_table(name, Arc::new(none))?;
            return Ok(());
        }
        let urls: Vec<ListingTableUrl> = (files.iter())
            .map(|file| Ok(ListingTableUrl::try_new(url_of(&file.path)?, None)?))
            .collect::<Result<_, FleetError>>()?;
        let options =
            ListingOptions::new(Arc::new(ParquetFormat::default())).with_file_extension(RECORDS);
        let config = ListingTableConfig::new_with_multi_paths(urls)
            .with_listing_options(options)
            .with_schema(schema.clone());
        self.context
            .register_table(name, Arc::new(ListingTable::try_new(config)?))?;
        Ok(())
    }

    /// Rows of a question. Where a file turns out to be damaged, all are read through, it is refused, and the
    /// question is asked again.
    ///
    /// # Errors
    /// [`FleetError::Engine`].
    pub fn ask(&mut self, sql: &str) -> Result<Answer, FleetError> {
        match self.try_ask(sql) {
            // What one of our own functions refused is no damage.
            Err(Wrong::Question(error) | Wrong::Reading(error)) if is_ours(&error) => {
                Err(error.into())
            }
            Err(Wrong::Reading(error)) => {
                let before = self.folder.refused.len();
                let verified = Folder::verified(&self.source.folder)?;
                if verified.refused.len() == before {
                    return Err(error.into());
                }
                *self = Self::of(&self.source, verified, &self.described)?;
                self.try_ask(sql).map_err(FleetError::from)
            }
            Err(Wrong::Question(error)) => Err((self.missing_table(sql))
                .or_else(|| self.wrong_type(sql))
                .unwrap_or(error.into())),
            other => other.map_err(FleetError::from),
        }
    }

    /// The first table of a question that isn't there.
    fn missing_table(&self, sql: &str) -> Option<FleetError> {
        let state = self.context.state();
        let dialect = state.config_options().sql_parser.dialect;
        let statement = state.sql_to_statement(sql, &dialect).ok()?;
        let named = state.resolve_table_references(&statement).ok()?;
        let exists = |name: &TableReference| self.context.table_exist(name.clone()).unwrap_or(true);
        let missing = named.into_iter().find(|name| !exists(name))?;
        let sides = SIDES
            .into_iter()
            .filter(|name| side(&self.folder.path, name).is_some());
        Some(FleetError::NoTable {
            name: missing.table().to_owned(),
            known: ["records", "every_version"]
                .into_iter()
                .chain(sides)
                .map(str::to_owned)
                .collect(),
        })
    }

    /// The first function of a question that doesn't take the column of a record it is given.
    fn wrong_type(&self, sql: &str) -> Option<FleetError> {
        let state = self.context.state();
        let dialect = state.config_options().sql_parser.dialect;
        let statement = state.sql_to_statement(sql, &dialect).ok()?;
        let fields = columns(&self.folder);
        functions::calls_of_columns(&statement)
            .into_iter()
            .find_map(|(function, column)| {
                let field = Arc::new(fields.field_with_name(&column).ok()?.clone());
                let given = std::slice::from_ref(&field);
                let aggregate = state.aggregate_functions().get(&function);
                let scalar = state.scalar_functions().get(&function);
                let refused = aggregate
                    .is_some_and(|f| fields_with_udf(given, f.as_ref()).is_err())
                    || scalar.is_some_and(|f| fields_with_udf(given, f.as_ref()).is_err());
                refused.then(|| FleetError::WrongType {
                    function,
                    column,
                    data_type: field.data_type().clone(),
                })
            })
    }

    /// Rows of a table.
    ///
    /// # Errors
    /// [`FleetError::Engine`].
    pub fn count(&mut self, table: &str) -> Result<u64, FleetError> {
        let answer = self.ask(&format!("SELECT count(*) FROM {table}"))?;
        let counts = answer.batches.iter().filter(|batch| batch.num_rows() > 0);
        let mut counts = counts.map(|batch| batch.column(0).as_primitive::<Int64Type>().value(0));
        Ok(counts.next().map_or(0, |n| n.unsigned_abs()))
    }

    /// The plan of a question, with the functions of Sinew written out.
    async fn plan(&self, sql: &str) -> Result<DataFrame, DataFusionError> {
        let state = self.context.state();
        let dialect = state.config_options().sql_parser.dialect;
        let mut statement = state.sql_to_statement(sql, &dialect)?;
        functions::write_out(&mut statement)?;
        let plan = state.statement_to_plan(statement).await?;
        self.context.execute_logical_plan(plan).await
    }

    fn try_ask(&self, sql: &str) -> Result<Answer, Wrong> {
        self.runtime.block_on(async {
            let frame = self.plan(sql).await.map_err(Wrong::Question)?;
            let schema = Arc::new(frame.schema().as_arrow().clone());
            let batches = frame.collect().await.map_err(Wrong::Reading)?;
            Ok(Answer { schema, batches })
        })
    }

    /// Reads the sessions of robots whose names follow each other.
    pub(crate) fn sessions(&mut self, robots: &[String]) -> Result<Vec<Sessions>, FleetError> {
        let (Some(first), Some(last)) = (robots.first(), robots.last()) else {
            return Ok(Vec::new());
        };
        let quoted = |name: &str| format!("'{}'", name.replace('\'', "''"));
        // What a civil clock didn't date is no part of a trend.
        let sql = format!(
            "SELECT {} FROM records WHERE robot >= {} AND robot <= {} AND clock = 'utc' AND offset_rad IS NOT NULL \
             AND offset_deviation_rad > 0",
            sessions::COLUMNS.join(", "),
            quoted(first),
            quoted(last)
        );
        sessions::sessions(&self.ask(&sql)?.batches)
    }
}

/// Whether one of our own functions said so.
fn is_ours(error: &DataFusionError) -> bool {
    match error.find_root() {
        DataFusionError::External(inner) => inner.is::<FleetError>(),
        _ => false,
    }
}

/// What a question found.
#[derive(Debug, Clone)]
pub struct Answer {
    /// Its columns.
    pub schema: SchemaRef,
    /// Its rows.
    pub batches: Vec<RecordBatch>,
}

impl Answer {
    /// Every part of a column that has several as a column of its own: `days.low` of `days`.
    pub(crate) fn flat(self) -> Result<Self, FleetError> {
        let wrong = |e: datafusion::arrow::error::ArrowError| FleetError::Engine(e.to_string());
        let flat = |batch: &RecordBatch| batch.normalize(".", None).map_err(wrong);
        let schema = flat(&RecordBatch::new_empty(self.schema))?.schema();
        let batches = self.batches.iter().map(flat).collect::<Result<_, _>>()?;
        Ok(Self { schema, batches })
    }
}

enum Wrong {
    /// The question.
    Question(DataFusionError),
    /// While it was answered.
    Reading(DataFusionError),
}

impl From<Wrong> for FleetError {
    fn from(wrong: Wrong) -> Self {
        match wrong {
            Wrong::Question(error) | Wrong::Reading(error) => error.into(),
        }
    }
}
