//! Errors of the fleet program.

use crate::address::Address;
use crate::by::By;
use crate::creep::Ages;
use datafusion::arrow::datatypes::DataType;
use datafusion::common::SchemaError;
use datafusion::error::DataFusionError;
use sinew_files::names;
use std::path::PathBuf;
use std::sync::Arc;

/// Error of the fleet program.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FleetError {
    /// Folder missing, unreadable or not writable.
    #[error("{path}: {source}{cure}", path = path.display(), cure = cure(source))]
    Folder {
        /// Path of the folder.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// Output folder not empty.
    #[error("{path}: folder is not empty; specify a new or empty folder", path = .0.display())]
    NotEmpty(PathBuf),
    /// Folder without files of records.
    #[error(
        "{path}: no file of records found; specify the folder that contains the monitors' records/, or simulate one with sinew-fleet simulate", path = .0.display()
    )]
    NoRecords(PathBuf),
    /// Robot without a tendon that can creep.
    #[error(
        "{robot}: no joint has a tendon with rope, pretension and retension_at_mm; a simulated fleet requires them"
    )]
    NoTendon {
        /// Name of the robot.
        robot: String,
    },
    /// Too few groups to compare.
    #[error("{}", no_groups(*.by, *.groups, *.tendons, *.too_few, *.ages))]
    NoGroups {
        /// Grouping key of the comparison.
        by: By,
        /// Number of groups.
        groups: usize,
        /// Number of tendons with an estimated creep rate.
        tendons: usize,
        /// Tendons with too few sessions.
        too_few: usize,
        /// Requested range of rope ages.
        ages: Ages,
    },
    /// Too few tendons to determine the usual creep.
    #[error(
        "{tendons} tendons have 10 sessions over days {} to {} of their rope, {too_few} have fewer; the usual creep requires {needed} tendons; \
         set other ages with --ages",
        ages.from_days, ages.to_days
    )]
    TooFewTendons {
        /// Number of tendons with an estimated creep rate.
        tendons: usize,
        /// Required number of tendons.
        needed: usize,
        /// Number of tendons with too few sessions.
        too_few: usize,
        /// Requested range of rope ages.
        ages: Ages,
    },
    /// Singular equations of the comparison.
    #[error(
        "the comparison's equations have no solution: the creep of a tendon is not finite; report this with the records"
    )]
    NoDraws,
    /// Chains that have not converged.
    #[error(
        "the usual creep of these tendons is not determined: the chains have not converged (ratio {ratio:.2}); \
         use more tendons of each batch, or other ages (--ages)"
    )]
    DrawsApart {
        /// [`disagreement`](crate::hierarchy::Draws::disagreement) of the chains.
        ratio: f64,
    },
    /// Invalid text file, with file and line.
    #[error(transparent)]
    File(#[from] sinew_files::Located),
    /// Scenario unsuitable for a robot.
    #[error(transparent)]
    Scenario(#[from] sinew_sim::protocol::PlanError),
    /// Failed simulation of a recording.
    #[error(transparent)]
    Simulate(#[from] sinew_sim::SimulateError),
    /// Failed output of a table.
    #[error(transparent)]
    Log(#[from] sinew_log::LogError),
    /// Invalid robot description.
    #[error(transparent)]
    Robot(#[from] sinew_estimate::robot_dir::RobotDirError),
    /// Unknown rope or invalid catalogue.
    #[error(transparent)]
    Catalogue(#[from] sinew_rope::CatalogueError),
    /// Unknown column in a query.
    #[error("no column '{name}' in the tables of this query{hint} available: {available}", hint = names::hint(name, available), available = names::list(available))]
    NoColumn {
        /// Name of the column.
        name: String,
        /// Available columns.
        available: Vec<String>,
    },
    /// Unknown table in a query.
    #[error("no table '{name}'{hint} available: {available}; robots, tendons and events require their .csv file in the folder", hint = names::hint(name, available), available = names::list(available))]
    NoTable {
        /// Name of the table.
        name: String,
        /// Available tables.
        available: Vec<String>,
    },
    /// Too few baselines to pool.
    #[error(
        "{folder}: {found} usable baselines of '{robot}', at least 2 required, 6 recommended: \
         add one of each robot, recorded by sinew baseline LOG --out ROBOT.baseline", folder = .folder.display()
    )]
    TooFewBaselines {
        /// Path of the folder.
        folder: PathBuf,
        /// Name of the robot type.
        robot: String,
        /// Number of usable baselines.
        found: usize,
    },
    /// Invalid baseline.
    #[error(transparent)]
    Baseline(#[from] sinew_estimate::session::SessionError),
    /// Failed output of a file.
    #[error(transparent)]
    Output(#[from] sinew_files::OutputError),
    /// File that is not a state file of `due`.
    #[error(
        "{path}: not written by sinew-fleet due --state, therefore not overwritten; specify a new file", path = .0.display()
    )]
    NoState(PathBuf),
    /// Unreadable state file.
    #[error("{path}: {source}", path = path.display())]
    StateUnread {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// Invalid call of a Sinew function.
    #[error("invalid call of {function}; write {usage}")]
    Usage {
        /// Name of the function.
        function: &'static str,
        /// Correct form of the call.
        usage: &'static str,
    },
    /// Trend over rows of several tendons.
    #[error(
        "{function}: a group contains {} and {}; add GROUP BY robot, joint", .tendons[0], .tendons[1]
    )]
    SeveralTendons {
        /// Name of the function.
        function: &'static str,
        /// Two of the tendons.
        tendons: [String; 2],
    },
    /// Invalid limit, or limit that differs between the rows of a tendon.
    #[error("{function}: invalid limit {found}, expected one number of mm above 0 per tendon")]
    NoLimit {
        /// Name of the function.
        function: &'static str,
        /// Value found.
        found: String,
    },
    /// Function called with a column of an unsupported type.
    #[error("{function}({column}): unsupported type of {column}: {}; use another column", type_name(.data_type))]
    WrongType {
        /// Name of the function.
        function: String,
        /// Name of the column.
        column: String,
        /// Type of the column.
        data_type: DataType,
    },
    /// Missing credentials.
    #[error(
        "{0}: no credentials; set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY (those of a profile: aws configure \
         export-credentials --format env), or AWS_SKIP_SIGNATURE=true for a public bucket"
    )]
    NoCredentials(Address),
    /// Rejected credentials.
    #[error(
        "{0}: the credentials do not permit listing or reading; check AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and their \
         permissions: s3:ListBucket and s3:GetObject"
    )]
    Forbidden(Address),
    /// Unknown bucket.
    #[error(
        "{address}: {endpoint} has no bucket '{}'; check its name, AWS_REGION and AWS_ENDPOINT_URL", .address.bucket
    )]
    NoBucket {
        /// Address of the folder.
        address: Address,
        /// Endpoint of the store.
        endpoint: String,
    },
    /// Empty folder of a bucket.
    #[error(
        "{0}: folder not found or empty; specify the folder that contains the monitors' records/"
    )]
    EmptyPrefix(Address),
    /// Endpoint that does not respond.
    #[error(
        "{address}: {endpoint} does not respond; check the network, AWS_ENDPOINT_URL and AWS_REGION"
    )]
    Unreachable {
        /// Address of the folder.
        address: Address,
        /// Endpoint of the store.
        endpoint: String,
    },
    /// Other error of a bucket.
    #[error("{address}: {message}")]
    Bucket {
        /// Address of the folder.
        address: Address,
        /// Message of the store.
        message: String,
    },
    /// Program built without S3 support.
    #[cfg(not(feature = "s3"))]
    #[error(
        "{0}: this sinew-fleet was built without S3 support; build it with cargo install --path fleet --features s3"
    )]
    NoS3(Address),
    /// Invalid or failed query.
    #[error("{0}")]
    Engine(String),
}

impl From<DataFusionError> for FleetError {
    fn from(error: DataFusionError) -> Self {
        let error = match own(error) {
            Ok(own) => return own,
            Err(error) => error,
        };
        let schema = match error.find_root() {
            DataFusionError::SchemaError(schema, _) => schema,
            // The error is shared; only its message is available.
            DataFusionError::External(inner) if inner.is::<Self>() => {
                return Self::Engine(inner.to_string());
            }
            _ => return Self::Engine(error.strip_backtrace()),
        };
        let SchemaError::FieldNotFound {
            field,
            valid_fields,
        } = schema.as_ref()
        else {
            return Self::Engine(error.strip_backtrace());
        };
        let mut available: Vec<String> = valid_fields.iter().map(|f| f.name.clone()).collect();
        available.sort_unstable();
        available.dedup();
        Self::NoColumn {
            name: field.name.clone(),
            available,
        }
    }
}

/// Extracts an error of this crate from the engine's wrapping.
fn own(error: DataFusionError) -> Result<FleetError, DataFusionError> {
    match error {
        DataFusionError::External(inner) => match inner.downcast::<FleetError>() {
            Ok(own) => Ok(*own),
            Err(inner) => Err(DataFusionError::External(inner)),
        },
        DataFusionError::Context(context, inner) => {
            own(*inner).map_err(|inner| DataFusionError::Context(context, Box::new(inner)))
        }
        DataFusionError::Diagnostic(diagnostic, inner) => {
            own(*inner).map_err(|inner| DataFusionError::Diagnostic(diagnostic, Box::new(inner)))
        }
        DataFusionError::Shared(inner) => match Arc::try_unwrap(inner) {
            Ok(inner) => own(inner),
            Err(inner) => Err(DataFusionError::Shared(inner)),
        },
        other => Err(other),
    }
}

/// Describes a column type for messages.
fn type_name(of: &DataType) -> String {
    match of {
        DataType::Utf8 | DataType::Utf8View | DataType::LargeUtf8 => "a text".into(),
        DataType::Boolean => "true or false".into(),
        number if number.is_numeric() => "a number".into(),
        other => other.to_string(),
    }
}

/// Returns the remedy for a folder error.
fn cure(source: &std::io::Error) -> &'static str {
    match source.kind() {
        std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory => {
            "; specify the folder that contains the monitors' records/"
        }
        _ => "",
    }
}

/// Message for a comparison without groups.
fn no_groups(by: By, groups: usize, tendons: usize, too_few: usize, ages: Ages) -> String {
    if tendons == 0 {
        return format!(
            "none of {too_few} tendons has 10 sessions over its days {} to {} since installation; set other ages with \
             --ages, or add the installation dates to events.csv as 'replaced'",
            ages.from_days, ages.to_days
        );
    }
    let cure = match by {
        By::Rope => "specify ropes in tendons.csv (robot, joint, rope) or robot.toml",
        By::Batch => "specify batches in tendons.csv (robot, joint, rope, batch)",
        By::Site => "specify sites in robots.csv (robot, site)",
        By::Temperature | By::RopeTemperature => "records require temperature_c",
    };
    let found = match groups {
        0 => "no group".to_owned(),
        n => format!("{n} group only"),
    };
    format!("{found} among {tendons} tendons: nothing to compare; {cure}")
}
