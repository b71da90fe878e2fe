//! Why there is no answer.

use crate::args::By;
use crate::creep::Ages;
use datafusion::common::SchemaError;
use datafusion::error::DataFusionError;
use sinew_files::names;
use std::path::PathBuf;

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
    /// SQL, or a query that can't be done.
    #[error("{0}")]
    Engine(String),
}

impl From<DataFusionError> for FleetError {
    fn from(error: DataFusionError) -> Self {
        let DataFusionError::SchemaError(schema, _) = error.find_root() else {
            return Self::Engine(error.strip_backtrace());
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
