//! Metadata of a fleet besides its records: robot types with their ropes, batches, sites and maintenance events.

use crate::FleetError;
use crate::folder::TYPES;
use crate::folder::sides::{self, Fitted, Tendon};
use crate::reference_creep::{self, CreepKind, ReferenceCreeps};
use crate::sessions::Sessions;
use sinew_estimate::robot_dir;
use sinew_model::robot::Robot;
use sinew_model::transmission;
use sinew_rope::{Catalogue, CatalogueError};
use sinew_trend::prior::{RopePrior, rope_prior};
use sinew_trend::{
    AnalyzeError, LoadedTrend, ResumedTrend, SessionRecord, Stated, TrendRequest,
    mean_temperature_c, resume_joint,
};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Forecast horizon of a trend, days; intervals that end later are open.
const HORIZON_DAYS: f64 = 365.0;
/// Assumed time between a tensioning and its baseline, s.
const BASELINE_AFTER_S: f64 = 3600.0;

/// Metadata of a fleet: robot types, installed ropes, events, sites and reference creep.
pub(crate) struct FleetMetadata {
    /// Robot types by name, each with the ropes of robot.toml and with every installed rope.
    robots: BTreeMap<(String, Option<String>), Robot>,
    pub(crate) fitted: BTreeMap<Tendon, Fitted>,
    pub(crate) events: BTreeMap<Tendon, Vec<Stated>>,
    pub(crate) sites: BTreeMap<String, String>,
    catalogue: Catalogue,
    /// Priors of the ropes by kind of tendon and rounded mean temperature; few such kinds exist.
    priors: Mutex<BTreeMap<Kind, Arc<RopePrior>>>,
    /// Reference creep of ropes, estimated from a fleet.
    creep: ReferenceCreeps,
}

/// Kind of tendon and mean temperature in whole degrees Celsius.
type Kind = (CreepKind, i64);

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
            catalogue,
            priors: Mutex::default(),
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

    /// Estimates the trend of a tendon, as `sinew trend` does.
    ///
    /// * `robot`: type with the installed rope.
    /// * `rows`: selected sessions of the tendon.
    /// * `kept`: stored state of an earlier query.
    pub(crate) fn trend(
        &self,
        sessions: &Sessions,
        robot: Option<&Robot>,
        mut rows: Vec<SessionRecord>,
        kept: Option<LoadedTrend>,
    ) -> Result<ResumedTrend, AnalyzeError> {
        // Events after the last session have no session yet.
        let last_utc_s = rows.last().map_or(0.0, |r| r.time_utc_s);
        let stated = self.events.get(&sessions.tendon).into_iter().flatten();
        let stated: Vec<Stated> = stated
            .filter(|s| s.time_utc_s <= last_utc_s)
            .cloned()
            .collect();
        date_baselines(&mut rows, &stated);
        let request = TrendRequest {
            robot,
            catalogue: &self.catalogue,
            stated,
            duty: None,
            life: None,
            horizon_days: HORIZON_DAYS,
            seed: 1,
        };
        let joint = &sessions.tendon.1;
        let rope = self.prior(sessions, robot, &request)?;
        resume_joint(joint, &rows, &rope, &request, kept)
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

    /// Returns the prior of a tendon from its rope.
    fn prior(
        &self,
        sessions: &Sessions,
        robot: Option<&Robot>,
        request: &TrendRequest<'_>,
    ) -> Result<Arc<RopePrior>, CatalogueError> {
        let tendon = robot.and_then(|robot| tendon_of(robot, &sessions.tendon.1));
        let celsius = mean_temperature_c(&sessions.rows).round();
        let own = self.kind(sessions, tendon);
        let (kind, reference) = match reference_creep::find(&self.creep, &own) {
            Some((kind, reference)) => (kind, Some(reference)),
            None => (own.widest(), None),
        };
        let kind = (kind, celsius as i64);
        let priors = || self.priors.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(reference) = priors().get(&kind) {
            return Ok(reference.clone());
        }
        let mut found = rope_prior(tendon, request.catalogue, None, celsius, request.seed)?;
        if let Some(reference) = reference {
            reference_creep::apply(&mut found.prior, &reference);
        }
        Ok(priors().entry(kind).or_insert(Arc::new(found)).clone())
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

/// Sets the baseline times from the tensionings specified between the first session of a baseline and the session before it.
fn date_baselines(rows: &mut [SessionRecord], stated: &[Stated]) {
    let mut before: Option<(Option<String>, f64)> = None;
    let mut time_utc_s = None;
    for row in rows {
        let changed = before
            .as_ref()
            .is_none_or(|(name, _)| *name != row.baseline);
        if changed {
            let from = before.as_ref().map_or(f64::NEG_INFINITY, |(_, t)| *t);
            let times = stated.iter().map(|s| s.time_utc_s);
            let between = times.filter(|t| *t > from && *t <= row.time_utc_s);
            let latest = between.fold(f64::NEG_INFINITY, f64::max);
            time_utc_s = latest
                .is_finite()
                .then_some((latest + BASELINE_AFTER_S).min(row.time_utc_s));
        }
        row.baseline_time_utc_s = time_utc_s;
        before = Some((row.baseline.clone(), row.time_utc_s));
    }
}
