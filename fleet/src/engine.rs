//! Records as DataFusion tables, with each session once even if files were copied.

use crate::FleetError;
use crate::args::Source;
use crate::columns::{data_type, present_name, version_1_name};
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

/// File URL of a path; characters of the name are not interpreted as patterns.
fn url_of(path: &Path) -> Result<url::Url, FleetError> {
    let wrong = |source| FleetError::Folder {
        path: path.into(),
        source,
    };
    let path = std::fs::canonicalize(path).map_err(wrong)?;
    url::Url::from_file_path(&path).map_err(|()| wrong(std::io::ErrorKind::InvalidFilename.into()))
}

/// Union of the columns of all files: those of a record, then additional ones of some files.
fn columns(folder: &Folder) -> SchemaRef {
    let mut fields: Vec<Field> = (COLUMNS.iter())
        .map(|name| Field::new(*name, data_type(name), true))
        .collect();
    for field in folder.files().flat_map(|file| file.schema.fields()) {
        if !fields.iter().any(|f| f.name() == field.name()) {
            // Columns of version 1 get the type of the present ones, so that both can be combined.
            let mut field = field.as_ref().clone().with_nullable(true);
            if present_name(field.name()) != field.name() {
                field = field
                    .clone()
                    .with_data_type(data_type(present_name(field.name())));
            }
            fields.push(field);
        }
    }
    Arc::new(Schema::new(fields))
}

/// Query engine over the tables of a folder.
pub struct Engine {
    /// Content of the folder.
    pub folder: Folder,
    context: SessionContext,
    runtime: tokio::runtime::Runtime,
    source: Source,
    /// Folders of further robot types, in addition to those in `types/`, for the Sinew functions.
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

    /// Opens a folder and reads every column of every file.
    ///
    /// # Errors
    /// [`FleetError`].
    pub fn verified(source: &Source) -> Result<Self, FleetError> {
        Self::of(source, Folder::verified(&source.folder)?, &[])
    }

    /// Opens a folder with further robot type descriptions.
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
            .map_err(|e| FleetError::Engine(format!("cannot start threads: {e}")))?;
        let pool = FairSpillPool::new(source.memory_mb as usize * 1_000_000);
        let environment = RuntimeEnvBuilder::new()
            .with_memory_pool(Arc::new(pool))
            .build_arc()?;
        let mut config = SessionConfig::new().with_information_schema(true);
        config.options_mut().execution.parquet.pushdown_filters = true;
        // Memory reserved by a sort for its last step; the default is ten times the share of a small pool.
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

    /// Registers the tables.
    async fn register(&self) -> Result<(), FleetError> {
        let schema = columns(&self.folder);
        self.files("_clean", &self.folder.clean, &schema)?;
        self.files("_ambiguous", &self.folder.ambiguous, &schema)?;
        // Value of a column; version 1 of the schema has another name for some.
        let value = |name: &str| {
            let old = version_1_name(name).filter(|old| schema.index_of(old).is_ok());
            match old {
                Some(old) => format!("coalesce(\"{name}\", \"{old}\")"),
                None => format!("\"{name}\""),
            }
        };
        let names: Vec<String> = (schema.fields().iter().map(|f| f.name()))
            .filter(|name| present_name(name) == name.as_str())
            .map(|name| format!("{} AS \"{name}\"", value(name)))
            .collect();
        let names = names.join(", ");
        let session = "robot, joint, time_utc_s";
        // Among different rows with one key: the one with more frames, then a deterministic choice.
        let better = format!(
            "frames DESC NULLS LAST, {} NULLS LAST, offset_rad, source, baseline",
            value("offset_std_rad")
        );
        let view = |name: &str, key: &str, order: &str| {
            let clean = format!("SELECT {names} FROM _clean");
            let once = format!(
                "SELECT {names} FROM (SELECT *, row_number() OVER (PARTITION BY {key} ORDER BY {order}) AS _nth \
                 FROM _ambiguous) WHERE _nth = 1"
            );
            let parts = match (
                self.folder.clean.is_empty(),
                self.folder.ambiguous.is_empty(),
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
                &better,
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
                // In memory, the size of a side table is known, so that a join keeps it in memory instead of the records.
                let frame = self.context.read_csv(&path, options.clone()).await?;
                let schema = Arc::new(frame.schema().as_arrow().clone());
                match frame.collect().await {
                    Ok(rows) => {
                        let table = MemTable::try_new(schema, vec![rows])?;
                        self.context.register_table(name, Arc::new(table))?;
                    }
                    // The query that uses the table gets the error.
                    Err(_) => self.context.register_csv(name, path, options).await?,
                }
            }
        }
        Ok(())
    }

    /// SQL expression for the order of versions; larger is newer.
    fn version_order(&self) -> String {
        let versions = self.folder.versions();
        if versions.is_empty() {
            return "1".into();
        }
        let whens: Vec<String> = (versions.iter().enumerate())
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

    /// Executes a query. If a file turns out to be damaged, all files are read completely, the damaged one is rejected, and the
    /// query is repeated.
    ///
    /// # Errors
    ///
    /// Returns [`FleetError::Engine`] for an invalid query, and more specific variants for unknown columns, tables and types.
    pub fn query(&mut self, sql: &str) -> Result<Answer, FleetError> {
        match self.try_query(sql) {
            // An error of a Sinew function is not a damaged file.
            Err(QueryError::Plan(error) | QueryError::Execution(error))
                if is_sinew_error(&error) =>
            {
                Err(error.into())
            }
            Err(QueryError::Execution(error)) => {
                let before = self.folder.rejected.len();
                let verified = Folder::verified(&self.source.folder)?;
                if verified.rejected.len() == before {
                    return Err(error.into());
                }
                *self = Self::of(&self.source, verified, &self.described)?;
                self.try_query(sql).map_err(FleetError::from)
            }
            Err(QueryError::Plan(error)) => Err((self.missing_table(sql))
                .or_else(|| self.wrong_type(sql))
                .unwrap_or(error.into())),
            other => other.map_err(FleetError::from),
        }
    }

    /// Returns the error for the first unknown table of a query.
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
            available: ["records", "every_version"]
                .into_iter()
                .chain(sides)
                .map(str::to_owned)
                .collect(),
        })
    }

    /// Returns the error for the first function of a query that does not accept the type of its column.
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
                let is_rejected = aggregate
                    .is_some_and(|f| fields_with_udf(given, f.as_ref()).is_err())
                    || scalar.is_some_and(|f| fields_with_udf(given, f.as_ref()).is_err());
                is_rejected.then(|| FleetError::WrongType {
                    function,
                    column,
                    data_type: field.data_type().clone(),
                })
            })
    }

    /// Returns the number of rows of a table.
    ///
    /// # Errors
    /// [`FleetError::Engine`].
    pub fn count(&mut self, table: &str) -> Result<u64, FleetError> {
        let answer = self.query(&format!("SELECT count(*) FROM {table}"))?;
        let counts = answer.batches.iter().filter(|batch| batch.num_rows() > 0);
        let mut counts = counts.map(|batch| batch.column(0).as_primitive::<Int64Type>().value(0));
        Ok(counts.next().map_or(0, |n| n.unsigned_abs()))
    }

    /// Plans a query after expansion of the Sinew functions.
    async fn plan(&self, sql: &str) -> Result<DataFrame, DataFusionError> {
        let state = self.context.state();
        let dialect = state.config_options().sql_parser.dialect;
        let mut statement = state.sql_to_statement(sql, &dialect)?;
        functions::write_out(&mut statement)?;
        let plan = state.statement_to_plan(statement).await?;
        self.context.execute_logical_plan(plan).await
    }

    fn try_query(&self, sql: &str) -> Result<Answer, QueryError> {
        self.runtime.block_on(async {
            let frame = self.plan(sql).await.map_err(QueryError::Plan)?;
            let schema = Arc::new(frame.schema().as_arrow().clone());
            let batches = frame.collect().await.map_err(QueryError::Execution)?;
            Ok(Answer { schema, batches })
        })
    }

    /// Reads the sessions of robots with consecutive names.
    pub(crate) fn sessions(&mut self, robots: &[String]) -> Result<Vec<Sessions>, FleetError> {
        let (Some(first), Some(last)) = (robots.first(), robots.last()) else {
            return Ok(Vec::new());
        };
        let quoted = |name: &str| format!("'{}'", name.replace('\'', "''"));
        // Sessions without a UTC date are not part of a trend.
        let sql = format!(
            "SELECT {} FROM records WHERE robot >= {} AND robot <= {} AND clock = 'utc' AND offset_rad IS NOT NULL \
             AND offset_std_rad > 0",
            sessions::COLUMNS.join(", "),
            quoted(first),
            quoted(last)
        );
        sessions::sessions(&self.query(&sql)?.batches)
    }
}

/// Whether the error comes from a Sinew function.
fn is_sinew_error(error: &DataFusionError) -> bool {
    match error.find_root() {
        DataFusionError::External(inner) => inner.is::<FleetError>(),
        _ => false,
    }
}

/// Result of a query.
#[derive(Debug, Clone)]
pub struct Answer {
    /// Schema of the rows.
    pub schema: SchemaRef,
    /// Batches of rows.
    pub batches: Vec<RecordBatch>,
}

impl Answer {
    /// Splits struct columns into one column per field: `days.low` of `days`.
    pub(crate) fn flat(self) -> Result<Self, FleetError> {
        let wrong = |e: datafusion::arrow::error::ArrowError| FleetError::Engine(e.to_string());
        let flat = |batch: &RecordBatch| batch.normalize(".", None).map_err(wrong);
        let schema = flat(&RecordBatch::new_empty(self.schema))?.schema();
        let batches = self.batches.iter().map(flat).collect::<Result<_, _>>()?;
        Ok(Self { schema, batches })
    }
}

enum QueryError {
    /// Invalid query or failed planning.
    Plan(DataFusionError),
    /// Failure while reading or executing.
    Execution(DataFusionError),
}

impl From<QueryError> for FleetError {
    fn from(wrong: QueryError) -> Self {
        match wrong {
            QueryError::Plan(error) | QueryError::Execution(error) => error.into(),
        }
    }
}
