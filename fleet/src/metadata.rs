//! Metadata of a fleet besides its records: robot types with their ropes, batches, sites and maintenance events.

use crate::FleetError;
use crate::folder::TYPES;
use crate::folder::sides::{self, Fitted, Tendon};
use crate::reference_creep::{self, CreepKind, ReferenceCreeps};
use crate::sessions::Sessions;
use sinew_estimate::robot_dir;
use sinew_model::robot::Robot;
use sinew_model::transmission;
use sinew_rope::Catalogue;
use sinew_trend::filter::Prior;
use sinew_trend::fleet::{FleetTendon, RopePriors, trend_of_tendon};
use sinew_trend::{AnalyzeError, LoadedTrend, ResumedTrend, Stated};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Metadata of a fleet: robot types, installed ropes, events, sites and reference creep.
pub(crate) struct FleetMetadata {
    /// Robot types by name, each with the ropes of robot.toml and with every installed rope.
    robots: BTreeMap<(String, Option<String>), Robot>,
    pub(crate) fitted: BTreeMap<Tendon, Fitted>,
    pub(crate) events: BTreeMap<Tendon, Vec<Stated>>,
    pub(crate) sites: BTreeMap<String, String>,
    priors: RopePriors,
    /// Reference creep of ropes, estimated from a fleet.
    creep: ReferenceCreeps,
}

impl FleetMetadata {
    /// Reads the metadata of a folder.
    ///
    /// * `described`: folders of further robot types, in addition to those in `types/`.
    pub(crate) fn read(folder: &Path, described: &[PathBuf]) -> Result<Self, FleetError> {
        let fitted = sides::fitted(folder)?;
        let catalogue = Catalogue::shipped()?;
        let ropes: BTreeSet<&String> = fitted.values().filter_map(|f| f.rope.as_ref()).collect();
        let mut robots = BTreeMap::new();
        for robot in types(folder, described)? {
            for rope in &ropes {
                catalogue.find(rope)?;
                let mut roped = robot.clone();
                for transmission in roped.transmissions.iter_mut().flatten() {
                    if let Some(tendon) = &mut transmission.tendon {
                        tendon.rope = Some((*rope).clone());
                    }
                }
                robots.insert((robot.name.clone(), Some((*rope).clone())), roped);
            }
            robots.insert((robot.name.clone(), None), robot);
        }
        Ok(Self {
            robots,
            events: sides::events(folder)?,
            sites: sides::sites(folder)?,
            fitted,
            priors: RopePriors::new(catalogue),
            creep: ReferenceCreeps::new(),
        })
    }

    /// With how fast ropes creep by `pool --creep`.
    pub(crate) fn with_creep(mut self, file: Option<&Path>) -> Result<Self, FleetError> {
        if let Some(file) = file {
            self.creep = reference_creep::read(file)?;
        }
        Ok(self)
    }

    /// Rope and batch of a tendon, as far as they are known.
    pub(crate) fn fit(&self, tendon: &Tendon) -> Fitted {
        self.fitted.get(tendon).cloned().unwrap_or_default()
    }

    /// A type as it is described.
    pub(crate) fn robot_type(&self, name: &str) -> Option<&Robot> {
        self.robots.get(&(name.to_owned(), None))
    }

    /// Robot type of a tendon with its installed rope; `None` without a description.
    pub(crate) fn robot(&self, sessions: &Sessions) -> Option<&Robot> {
        let rope = self
            .fitted
            .get(&sessions.tendon)
            .and_then(|f| f.rope.clone());
        self.robots.get(&(sessions.robot_type.clone(), rope))
    }

    /// Estimates the trend of a tendon.
    ///
    /// * `robot`: type with the installed rope.
    /// * `kept`: stored state of an earlier query.
    pub(crate) fn trend(
        &self,
        sessions: &Sessions,
        robot: Option<&Robot>,
        kept: Option<LoadedTrend>,
    ) -> Result<ResumedTrend, AnalyzeError> {
        let joint = &sessions.tendon.1;
        let tendon = robot.and_then(|robot| tendon_of(robot, joint));
        let of = FleetTendon {
            joint,
            robot,
            tendon,
            events: self
                .events
                .get(&sessions.tendon)
                .map_or(&[][..], Vec::as_slice),
        };
        let reference = reference_creep::find(&self.creep, &self.kind(sessions, tendon));
        let apply = reference
            .map(|(_, creep)| move |prior: &mut Prior| reference_creep::apply(prior, &creep));
        let adjust = apply.as_ref().map(|apply| apply as &dyn Fn(&mut Prior));
        trend_of_tendon(of, &sessions.rows, &self.priors, adjust, kept)
    }

    /// Returns the kind of a tendon.
    fn kind(&self, sessions: &Sessions, tendon: Option<&transmission::Tendon>) -> CreepKind {
        CreepKind {
            robot_type: sessions.robot_type.clone(),
            joint: sessions.tendon.1.clone(),
            rope: tendon.and_then(|t| t.rope.clone()),
            batch: self.fit(&sessions.tendon).batch,
            site: self.sites.get(&sessions.tendon.0).cloned(),
        }
    }

    /// Whether a fleet provides a reference creep for the rope.
    pub(crate) fn has_reference_creep(&self, sessions: &Sessions, robot: &Robot) -> bool {
        let kind = self.kind(sessions, tendon_of(robot, &sessions.tendon.1));
        reference_creep::find(&self.creep, &kind).is_some()
    }
}

/// The tendon of a robot's joint.
pub(crate) fn tendon_of<'a>(robot: &'a Robot, joint: &str) -> Option<&'a transmission::Tendon> {
    let index = robot.arm.joint_index(joint)?;
    robot.transmissions[index].as_ref()?.tendon.as_ref()
}

/// Loads robot types: those in the folder of the records and those named.
fn types(folder: &Path, named: &[PathBuf]) -> Result<Vec<Robot>, FleetError> {
    let entries = std::fs::read_dir(folder.join(TYPES)).into_iter().flatten();
    let mut places: Vec<PathBuf> = (entries.flatten().map(|entry| entry.path()))
        .filter(|path| path.join("robot.toml").is_file())
        .collect();
    places.sort_unstable();
    places.extend(named.iter().cloned());
    let load = |place: &PathBuf| Ok(robot_dir::load(place, None)?.robot);
    places.iter().map(load).collect()
}
