//! Why there is no answer.

use crate::address::Address;
use crate::by::By;
use crate::creep::Ages;
use datafusion::arrow::datatypes::DataType;
use datafusion::common::SchemaError;
use datafusion::error::DataFusionError;
use sinew_files::names;
use std::path::PathBuf;
use std::sync::Arc;

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FleetError {
    /// A folder that isn't one, or can't be read or made.
    #[error("{path}: {source}{cure}", path = path.display(), cure = cure(source))]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Records would be mixed with others'.
    #[error("{path} has files in it; name a folder that is new or empty", path = .0.display())]
    NotEmpty(PathBuf),
    /// Nothing to read.
    #[error(
        "{path}: no file of records in it; give the folder that holds the monitors' records/, or make one up with sinew-fleet simulate", path = .0.display()
    )]
    NoRecords(PathBuf),
    /// No tendon can creep.
    #[error(
        "{robot}: no joint has a tendon with a rope, a pretension and retension_at_mm; a simulated fleet needs them"
    )]
    NoTendon {
        /// The robot.
        robot: String,
    },
    /// Nothing to compare.
    #[error("{}", no_groups(*.by, *.groups, *.tendons, *.too_few, *.ages))]
    NoGroups {
        /// What was to be compared.
        by: By,
        /// Groups there are.
        groups: usize,
        /// Tendons whose creep can be told.
        tendons: usize,
        /// Tendons with too few sessions.
        too_few: usize,
        /// Ages asked for.
        ages: Ages,
    },
    /// Too few to say what is usual.
    #[error(
        "{tendons} tendons have 10 sessions over days {} to {} of their rope, {too_few} have not: what is usual needs {needed}; \
         name other ages with --ages",
        ages.from_days, ages.to_days
    )]
    TooFewTendons {
        /// Those whose creep can be told.
        tendons: usize,
        /// How many are needed.
        needed: usize,
        /// Those with too few sessions.
        too_few: usize,
        /// Ages asked for.
        ages: Ages,
    },
    /// Equations without a solution.
    #[error(
        "the comparison's equations have no solution: some tendon's creep isn't a number; please report this with the records"
    )]
    NoDraws,
    /// What is usual can't be told.
    #[error(
        "what is usual can't be told from these tendons: the model's draws have not come together (ratio {ratio:.2}); \
         more tendons of each batch would help, or other ages (--ages)"
    )]
    DrawsApart {
        /// [`disagreement`](crate::hierarchy::Draws::disagreement) of the chains.
        ratio: f64,
    },
    /// A text file, with the place of what is wrong.
    #[error(transparent)]
    File(#[from] sinew_files::Located),
    /// A scenario that can't be made of a robot.
    #[error(transparent)]
    Scenario(#[from] sinew_sim::protocol::PlanError),
    /// A recording that can't be made.
    #[error(transparent)]
    Simulate(#[from] sinew_sim::SimulateError),
    /// A table to write.
    #[error(transparent)]
    Log(#[from] sinew_log::LogError),
    /// A robot.
    #[error(transparent)]
    Robot(#[from] sinew_estimate::robot_dir::RobotDirError),
    /// A rope.
    #[error(transparent)]
    Catalogue(#[from] sinew_rope::CatalogueError),
    /// A question names a column that isn't there.
    #[error("no column '{name}' in the tables of this question{hint} there are {known}", hint = names::hint(name, known), known = names::list(known))]
    NoColumn {
        /// The name.
        name: String,
        /// Columns there are.
        known: Vec<String>,
    },
    /// A question names a table that isn't there.
    #[error("no table '{name}'{hint} there are {known}; robots, tendons and events are there if their .csv file lies in the folder", hint = names::hint(name, known), known = names::list(known))]
    NoTable {
        /// The name.
        name: String,
        /// Tables there are.
        known: Vec<String>,
    },
    /// Too few robots to say what they have in common.
    #[error(
        "{folder}: {found} baselines of '{robot}' can be used; what robots have in common needs two or more, better six: \
         put one of each robot there, made by sinew baseline LOG --out ROBOT.baseline", folder = .folder.display()
    )]
    TooFewBaselines {
        /// The folder.
        folder: PathBuf,
        /// The type.
        robot: String,
        /// How many there are.
        found: usize,
    },
    /// A baseline.
    #[error(transparent)]
    Baseline(#[from] sinew_estimate::session::SessionError),
    /// A file that can't be written.
    #[error(transparent)]
    Output(#[from] sinew_files::OutputError),
    /// A file of trends that is something else.
    #[error(
        "{path}: not written by sinew-fleet due --state, so it stays as it is; name a file that isn't there yet", path = .0.display()
    )]
    NoState(PathBuf),
    /// A file of trends that can't be read.
    #[error("{path}: {source}", path = path.display())]
    StateUnread {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A function of Sinew that was asked in another way.
    #[error("{function} is written {usage}")]
    Usage {
        /// The function.
        function: &'static str,
        /// How it is written.
        usage: &'static str,
    },
    /// A trend of more than one tendon.
    #[error(
        "{function}: one of the groups holds {} and {}; add GROUP BY robot, joint", .tendons[0], .tendons[1]
    )]
    SeveralTendons {
        /// The function.
        function: &'static str,
        /// Two of the tendons.
        tendons: [String; 2],
    },
    /// A limit that is none, or not the same in all rows of a tendon.
    #[error(
        "{function}: the limit must be one number of mm above 0 for a tendon; here it is {found}"
    )]
    NoLimit {
        /// The function.
        function: &'static str,
        /// What it is.
        found: String,
    },
    /// A function that doesn't take the type of a column.
    #[error("{function}({column}): {column} is {}, which {function} doesn't take; name another column", type_name(.data_type))]
    WrongType {
        /// The function.
        function: String,
        /// The column.
        column: String,
        /// What the column holds.
        data_type: DataType,
    },
    /// Nothing says who asks.
    #[error(
        "{0}: no credentials; set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY (those of a profile: aws configure \
         export-credentials --format env), or AWS_SKIP_SIGNATURE=true for a public bucket"
    )]
    NoCredentials(Address),
    /// The keys are wrong or don't allow it.
    #[error(
        "{0}: these credentials may not list or read it; look at AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and what they are \
         allowed: s3:ListBucket and s3:GetObject"
    )]
    Forbidden(Address),
    /// No bucket of that name.
    #[error(
        "{address}: {endpoint} has no bucket '{}'; look at its name, AWS_REGION and AWS_ENDPOINT_URL", .address.bucket
    )]
    NoBucket {
        /// What was asked for.
        address: Address,
        /// Who was asked.
        endpoint: String,
    },
    /// A folder of a bucket without anything.
    #[error("{0}: nothing lies there; give the folder that holds the monitors' records/")]
    EmptyPrefix(Address),
    /// Nobody answers.
    #[error(
        "{address}: {endpoint} doesn't answer; look at the network, AWS_ENDPOINT_URL and AWS_REGION"
    )]
    Unreachable {
        /// What was asked for.
        address: Address,
        /// Who was asked.
        endpoint: String,
    },
    /// A bucket that can't be read, for another reason.
    #[error("{address}: {said}")]
    Bucket {
        /// What was asked for.
        address: Address,
        /// What the store says.
        said: String,
    },
    /// A program that was built without buckets.
    #[cfg(not(feature = "s3"))]
    #[error(
        "{0}: this sinew-fleet was built without buckets; build it with cargo install --path fleet --features s3"
    )]
    NoS3(Address),
    /// SQL, or a query that can't be done.
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
            // Others hold it as well: its words are all that can be had.
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
        let mut known: Vec<String> = valid_fields.iter().map(|f| f.name.clone()).collect();
        known.sort_unstable();
        known.dedup();
        Self::NoColumn {
            name: field.name.clone(),
            known,
        }
    }
}

/// What one of our own functions refused, whatever it was wrapped in on the way.
fn own(error: DataFusionError) -> Result<FleetError, DataFusionError> {
    match error {
        DataFusionError::External(inner) => match inner.downcast::<FleetError>() {
            Ok(own) => Ok(*own),
            Err(inner) => Err(DataFusionError::External(inner)),
        },
        DataFusionError::Context(said, inner) => {
            own(*inner).map_err(|inner| DataFusionError::Context(said, Box::new(inner)))
        }
        DataFusionError::Diagnostic(said, inner) => {
            own(*inner).map_err(|inner| DataFusionError::Diagnostic(said, Box::new(inner)))
        }
        DataFusionError::Shared(inner) => match Arc::try_unwrap(inner) {
            Ok(inner) => own(inner),
            Err(inner) => Err(DataFusionError::Shared(inner)),
        },
        other => Err(other),
    }
}

/// What a column holds, for people.
fn type_name(of: &DataType) -> String {
    match of {
        DataType::Utf8 | DataType::Utf8View | DataType::LargeUtf8 => "a text".into(),
        DataType::Boolean => "true or false".into(),
        number if number.is_numeric() => "a number".into(),
        other => other.to_string(),
    }
}

/// What to do about a folder.
fn cure(source: &std::io::Error) -> &'static str {
    match source.kind() {
        std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory => {
            "; give the folder that holds the monitors' records/"
        }
        _ => "",
    }
}

/// Why there is nothing to compare, and what to do.
fn no_groups(by: By, groups: usize, tendons: usize, too_few: usize, ages: Ages) -> String {
    if tendons == 0 {
        return format!(
            "none of {too_few} tendons has 10 sessions over its days {} to {} since it was fitted; name other ages with \
             --ages, or see that events.csv dates new ropes by 'replaced'",
            ages.from_days, ages.to_days
        );
    }
    let cure = match by {
        By::Rope => "name ropes in tendons.csv (robot, joint, rope) or robot.toml",
        By::Batch => "name batches in tendons.csv (robot, joint, rope, batch)",
        By::Site => "name sites in robots.csv (robot, site)",
        By::Temperature | By::RopeTemperature => "records need temperature_c",
    };
    let found = match groups {
        0 => "no group".to_owned(),
        n => format!("{n} group only"),
    };
    format!("{found} among {tendons} tendons: nothing to compare; {cure}")
}
