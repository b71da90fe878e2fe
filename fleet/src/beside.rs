//! What lies beside the records of a fleet: types of robots with the ropes they have, batches, sites, and what was done.

use crate::FleetError;
use crate::folder::TYPES;
use crate::folder::sides::{self, Fitted, Tendon};
use crate::known_creep::{self, CreepKind, KnownCreeps};
use crate::sessions::Sessions;
use sinew_estimate::robot_dir;
use sinew_model::robot::Robot;
use sinew_model::transmission;
use sinew_rope::{Catalogue, CatalogueError};
use sinew_trend::prior::{RopePrior, rope_prior};
use sinew_trend::{
    AnalyzeError, GoneOn, KeptTrend, SessionRecord, Stated, TrendRequest, go_on, mean_temperature_c,
};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Days forecasts look ahead: intervals that end later are open.
const HORIZON_DAYS: f64 = 365.0;
/// A baseline is learned so long after a tensioning, s.
const BASELINE_AFTER_S: f64 = 3600.0;

/// What is known beside the records.
pub(crate) struct Beside {
    /// Types by name, with the ropes robot.toml names and with every rope that some tendon has.
    robots: BTreeMap<(String, Option<String>), Robot>,
    pub(crate) fitted: BTreeMap<Tendon, Fitted>,
    pub(crate) events: BTreeMap<Tendon, Vec<Stated>>,
    pub(crate) sites: BTreeMap<String, String>,
    catalogue: Catalogue,
    /// What ropes say of tendons at whole degrees of their mean temperature: tendons have few such kinds.
    priors: Mutex<BTreeMap<Kind, Arc<RopePrior>>>,
    /// How fast ropes creep, by a fleet.
    creep: KnownCreeps,
}

/// Tendons of which the same is known, at one whole degree Celsius.
type Kind = (CreepKind, i64);

impl Beside {
    /// Reads it.
    ///
    /// * `described`: folders of robot types beside those in `types/`.
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
            creep: KnownCreeps::new(),
        })
    }

    /// With how fast ropes creep by `pool --creep`.
    pub(crate) fn with_creep(mut self, file: Option<&Path>) -> Result<Self, FleetError> {
        if let Some(file) = file {
            self.creep = known_creep::read(file)?;
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

    /// The type of a tendon's robot with the rope that it has; `None`: nobody described it.
    pub(crate) fn robot(&self, sessions: &Sessions) -> Option<&Robot> {
        let rope = self
            .fitted
            .get(&sessions.tendon)
            .and_then(|f| f.rope.clone());
        self.robots.get(&(sessions.robot_type.clone(), rope))
    }

    /// The trend of a tendon, by `sinew trend`.
    ///
    /// * `robot`: with the rope that the tendon has.
    /// * `rows`: of its sessions those that are taken.
    /// * `kept`: where an earlier question left it.
    pub(crate) fn trend(
        &self,
        sessions: &Sessions,
        robot: Option<&Robot>,
        mut rows: Vec<SessionRecord>,
        kept: Option<KeptTrend>,
    ) -> Result<GoneOn, AnalyzeError> {
        // What was done after the last session has no session yet.
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
        go_on(joint, &rows, &rope, &request, kept)
    }

    /// Which kind of tendon it is.
    fn kind(&self, sessions: &Sessions, tendon: Option<&transmission::Tendon>) -> CreepKind {
        CreepKind {
            robot_type: sessions.robot_type.clone(),
            joint: sessions.tendon.1.clone(),
            rope: tendon.and_then(|t| t.rope.clone()),
            batch: self.fit(&sessions.tendon).batch,
            site: self.sites.get(&sessions.tendon.0).cloned(),
        }
    }

    /// Whether a fleet says how fast its rope creeps.
    pub(crate) fn is_creep_known(&self, sessions: &Sessions, robot: &Robot) -> bool {
        let kind = self.kind(sessions, tendon_of(robot, &sessions.tendon.1));
        known_creep::find(&self.creep, &kind).is_some()
    }

    /// What its rope says of a tendon.
    fn prior(
        &self,
        sessions: &Sessions,
        robot: Option<&Robot>,
        request: &TrendRequest<'_>,
    ) -> Result<Arc<RopePrior>, CatalogueError> {
        let tendon = robot.and_then(|robot| tendon_of(robot, &sessions.tendon.1));
        let celsius = mean_temperature_c(&sessions.rows).round();
        let own = self.kind(sessions, tendon);
        let (kind, known) = match known_creep::find(&self.creep, &own) {
            Some((kind, known)) => (kind, Some(known)),
            None => (own.widest(), None),
        };
        let kind = (kind, celsius as i64);
        let priors = || self.priors.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = priors().get(&kind) {
            return Ok(known.clone());
        }
        let mut found = rope_prior(tendon, request.catalogue, None, celsius, request.seed)?;
        if let Some(known) = known {
            known_creep::apply(&mut found.prior, &known);
        }
        Ok(priors().entry(kind).or_insert(Arc::new(found)).clone())
    }
}

/// The tendon of a robot's joint.
pub(crate) fn tendon_of<'a>(robot: &'a Robot, joint: &str) -> Option<&'a transmission::Tendon> {
    let index = robot.arm.joint_index(joint)?;
    robot.transmissions[index].as_ref()?.tendon.as_ref()
}

/// Types of robots: those beside the records, and those named.
fn types(folder: &Path, named: &[PathBuf]) -> Result<Vec<Robot>, FleetError> {
    let beside = std::fs::read_dir(folder.join(TYPES)).into_iter().flatten();
    let mut places: Vec<PathBuf> = (beside.flatten().map(|entry| entry.path()))
        .filter(|path| path.join("robot.toml").is_file())
        .collect();
    places.sort_unstable();
    places.extend(named.iter().cloned());
    let load = |place: &PathBuf| Ok(robot_dir::load(place, None)?.robot);
    places.iter().map(load).collect()
}

/// Dates baselines by the tensionings that were stated between a baseline's first session and the session before.
fn date_baselines(rows: &mut [SessionRecord], stated: &[Stated]) {
    let mut before: Option<(Option<String>, f64)> = None;
    let mut known = None;
    for row in rows {
        let changed = before
            .as_ref()
            .is_none_or(|(name, _)| *name != row.baseline);
        if changed {
            let from = before.as_ref().map_or(f64::NEG_INFINITY, |(_, t)| *t);
            let times = stated.iter().map(|s| s.time_utc_s);
            let between = times.filter(|t| *t > from && *t <= row.time_utc_s);
            let latest = between.fold(f64::NEG_INFINITY, f64::max);
            known = latest
                .is_finite()
                .then_some((latest + BASELINE_AFTER_S).min(row.time_utc_s));
        }
        row.baseline_time_utc_s = known;
        before = Some((row.baseline.clone(), row.time_utc_s));
    }
}
