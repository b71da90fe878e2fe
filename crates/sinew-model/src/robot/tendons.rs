//! `[motors.NAME]` and `[[tendons]]` of `robot.toml`, and the resulting transmissions of the joints.

use super::{EXPANSION, M_PER_MM, friction, guide};
use crate::routing::Routing;
use crate::tendons::{
    Coordinate, Coupling, CouplingDescription, CouplingError, JointDescription, JointSpring,
    MomentArm, PairedTendon, ShorteningTable, TableError, TendonDescription, TendonKind,
};
use crate::transmission::{Friction, Guide, Tendon, Transmission};
use alloc::borrow::ToOwned;
use alloc::boxed::Box;
use alloc::format;
use alloc::string::{String, ToString as _};
use alloc::vec::Vec;
use sinew_files::csv::Table as CsvTable;
use sinew_files::{Bound, Fault, Fields as _, Located, Section};

/// Newtons per metre of 1 N/mm.
const N_PER_M: f64 = 1e3;

/// Motor of the file.
#[derive(Debug, Clone)]
pub(super) struct MotorEntry {
    name: String,
    inertia_kg_m2: Option<f64>,
    friction: Friction,
}

/// Tendon of the file.
#[derive(Debug, Clone)]
pub(super) struct TendonEntry {
    line: u64,
    /// Without the moment arms.
    description: TendonDescription,
    moment_arms: Vec<(String, ArmEntry)>,
    rope: Option<RopeEntry>,
    /// Fault that keeps the tendon from being used: its stiffness is missing.
    gap: Option<Located>,
}

/// Moment arm of the file.
#[derive(Debug, Clone)]
enum ArmEntry {
    /// In the coordinate of the tendon, per rad.
    Constant(f64),
    /// Name of a file with the shortening over the joint position, and its line; read by [`shortenings`].
    Table(String, u64, Option<ShorteningTable>),
}

/// Rope of a tendon of the file.
#[derive(Debug, Clone)]
struct RopeEntry {
    name: Option<String>,
    length_m: f64,
    pretension_n: Option<f64>,
    guides: Vec<Guide>,
    retension_at_m: Option<f64>,
    replace_at_strain: Option<f64>,
    frame_expansion_per_k: Option<f64>,
}

/// Joint, as far as tendons are concerned.
#[derive(Debug)]
pub(super) struct JointOfFile<'a> {
    pub(super) name: &'a str,
    pub(super) is_rigid: bool,
    /// Stiffness where the file states it for the joint itself, N·m/rad.
    pub(super) own_stiffness_nm_per_rad: Option<f64>,
    pub(super) spring: Option<JointSpring>,
    pub(super) friction: Friction,
}

/// Reads the motors of `[motors]`, in the order of the file.
pub(super) fn motors(s: &Section<'_>) -> Result<Vec<MotorEntry>, Located> {
    let entries = s.entries().into_iter();
    let read = entries.map(|(name, _, value)| value.section()?.whole(|s| motor(s, name)));
    read.collect()
}

fn motor(s: &Section<'_>, name: &str) -> Result<MotorEntry, Located> {
    Ok(MotorEntry {
        name: name.to_owned(),
        inertia_kg_m2: s.number("inertia_kg_m2", Bound::NotNegative)?,
        friction: s.read("friction", friction)?.unwrap_or_default(),
    })
}

/// Reads `spring` of a joint.
pub(super) fn spring(s: &Section<'_>) -> Result<JointSpring, Located> {
    Ok(JointSpring {
        stiffness_nm_per_rad: s.need(
            "stiffness_nm_per_rad",
            Bound::Positive,
            "of the passive spring",
        )?,
        rest_rad: s.number_or("rest_rad", Bound::Any, 0.0)?,
    })
}

/// Reads an entry of `[[tendons]]`.
pub(super) fn tendon(s: &Section<'_>) -> Result<TendonEntry, Located> {
    const KINDS: [(&str, TendonKind); 2] =
        [("loop", TendonKind::Loop), ("strand", TendonKind::Strand)];
    let name = s.need_text("name", "name of the tendon in results")?;
    let kind = s.one_of("kind", &KINDS)?.unwrap_or(TendonKind::Loop);
    let drums = s.read("drums_mm", |s| factors(s, M_PER_MM))?;
    let arms = s.read("moment_arms_mm", moment_arms)?;
    let motor = s.text("motor")?;
    let ratios = s.read("ratios", |s| factors(s, 1.0))?;
    let drum_m = s.number("drum_mm", Bound::Positive)?.map(|v| v * M_PER_MM);
    let per_mm = s.number("stiffness_n_per_mm", Bound::Positive)?;
    let per_rad = s.number("stiffness_nm_per_rad", Bound::Positive)?;
    let wrong = |fault, problem: String, cure: &str| Err(s.here(fault, problem).cure(cure));
    let missing =
        |key: &str, cure: &str| wrong(Fault::MissingKey, format!("{key} is missing"), cure);
    let both = |a: &str, b: &str, cure: &str| {
        wrong(Fault::Contradiction, format!("has both {a} and {b}"), cure)
    };
    let in_metres = drums.is_some() || arms.is_some();
    let (coordinate, drums, moment_arms, stiffness) = if in_metres {
        if ratios.is_some() || motor.is_some() {
            let keys = "give drums_mm and moment_arms_mm, or motor and ratios";
            return both("lengths in mm", "ratios", keys);
        }
        if per_rad.is_some() || drum_m.is_some() {
            let cure = "give stiffness_n_per_mm, and drop drum_mm and stiffness_nm_per_rad";
            return both("lengths in mm", "keys that belong to ratios", cure);
        }
        let Some(drums) = drums else {
            return missing("drums_mm", "give the rope that each motor takes in per rad");
        };
        let Some(arms) = arms else {
            return missing(
                "moment_arms_mm",
                "give the moment arm at every joint it crosses",
            );
        };
        (Coordinate::Metres, drums, arms, per_mm.map(|k| k * N_PER_M))
    } else {
        if per_mm.is_some() {
            let cure = "give stiffness_nm_per_rad with ratios, or drums_mm and moment_arms_mm";
            return wrong(
                Fault::Contradiction,
                "has stiffness_n_per_mm without lengths in mm".into(),
                cure,
            );
        }
        let Some(motor) = motor else {
            return missing(
                "motor",
                "give motor and ratios, or drums_mm and moment_arms_mm",
            );
        };
        let Some(ratios) = ratios else {
            return missing(
                "ratios",
                "give rad of the motor per rad of every joint the tendon crosses",
            );
        };
        let arms = ratios
            .into_iter()
            .map(|(joint, r)| (joint, ArmEntry::Constant(r)));
        let coordinate = Coordinate::MotorRadians { drum_m };
        (
            coordinate,
            alloc::vec![(motor, 1.0)],
            arms.collect(),
            per_rad,
        )
    };
    let pretension_n = s.number("pretension_n", Bound::NotNegative)?;
    let pretension = match coordinate.metres_per_unit() {
        Some(metres) => pretension_n.map(|f0| f0 * metres),
        None if pretension_n.is_some() => return missing("drum_mm", "pretension_n needs it"),
        None => None,
    };
    let gap = stiffness.is_none().then(|| {
        let (key, where_) = match coordinate {
            Coordinate::Metres => (
                "stiffness_n_per_mm",
                "of a loop that of both strands together",
            ),
            Coordinate::MotorRadians { .. } => ("stiffness_nm_per_rad", "at its motor"),
        };
        s.here(Fault::MissingKey, format!("{key} is missing"))
            .cure(format!("give the stiffness of the tendon, {where_}"))
    });
    Ok(TendonEntry {
        line: s.line(),
        description: TendonDescription {
            name,
            kind,
            coordinate,
            drums,
            moment_arms: Vec::new(),
            stiffness: stiffness.unwrap_or(f64::NAN),
            pretension,
        },
        gap,
        moment_arms,
        rope: rope(s, pretension_n, coordinate)?,
    })
}

/// Reads the keys of a tendon's rope; `None` where its length is not stated.
fn rope(
    s: &Section<'_>,
    pretension_n: Option<f64>,
    coordinate: Coordinate,
) -> Result<Option<RopeEntry>, Located> {
    let length_mm = s.number("length_mm", Bound::Positive)?;
    let name = s.text("rope")?;
    let guides = s.each("guides", guide)?;
    let retension_at_mm = s.number("retension_at_mm", Bound::Positive)?;
    let replace_at_percent = s.number("replace_at_strain_percent", Bound::Positive)?;
    let frame_expansion_per_k = s.number("frame_expansion_per_k", EXPANSION)?;
    let is_described = name.is_some()
        || !guides.is_empty()
        || retension_at_mm.is_some()
        || replace_at_percent.is_some();
    let Some(length_mm) = length_mm else {
        if is_described {
            return Err(s.here(Fault::MissingKey, "length_mm is missing").cure(
                "give the free rope between its ends; strain and thermal expansion follow from it",
            ));
        }
        return Ok(None);
    };
    if coordinate.metres_per_unit().is_none() {
        return Err(s.here(Fault::MissingKey, "drum_mm is missing").cure("with ratios, give the radius that turns rad of the motor into mm of rope, or drop length_mm"));
    }
    Ok(Some(RopeEntry {
        name,
        length_m: length_mm * M_PER_MM,
        pretension_n,
        guides,
        retension_at_m: retension_at_mm.map(|v| v * M_PER_MM),
        replace_at_strain: replace_at_percent.map(|v| v / 100.0),
        frame_expansion_per_k,
    }))
}

/// Reads a table of names and numbers that are not 0.
fn factors(s: &Section<'_>, unit: f64) -> Result<Vec<(String, f64)>, Located> {
    let entries = s.entries().into_iter();
    let read = entries.map(|(name, _, value)| match value.number(Bound::Any)? {
        0.0 => Err(value.invalid("a number that is not 0: drop the entry")),
        number => Ok((name.to_owned(), unit * number)),
    });
    read.collect()
}

/// Reads a table of joints and moment arms in mm, or files of them.
fn moment_arms(s: &Section<'_>) -> Result<Vec<(String, ArmEntry)>, Located> {
    let entries = s.entries().into_iter();
    let read = entries.map(|(name, line, value)| {
        let arm = match value.text() {
            Ok(file) => ArmEntry::Table(file.to_owned(), line, None),
            Err(_) => match value.number(Bound::Any)? {
                0.0 => return Err(value.invalid("a number that is not 0: drop the entry")),
                arm => ArmEntry::Constant(M_PER_MM * arm),
            },
        };
        Ok((name.to_owned(), arm))
    });
    read.collect()
}

/// Files with moment arms over a joint's position, each once, in the order of the file.
pub(super) fn tables(tendons: &[TendonEntry]) -> Vec<&str> {
    let arms = tendons.iter().flat_map(|tendon| &tendon.moment_arms);
    let mut names: Vec<&str> = Vec::new();
    for (_, arm) in arms {
        if let ArmEntry::Table(name, ..) = arm
            && !names.contains(&name.as_str())
        {
            names.push(name);
        }
    }
    names
}

/// Takes the text of a file with moment arms.
///
/// # Errors
/// With file, line, value and unit.
pub(super) fn take_table(
    tendons: &mut [TendonEntry],
    name: &str,
    (file, text): (&str, &str),
) -> Result<(), Located> {
    let (q_rad, shortening_m) = shortenings(file, text)?;
    let located = |error: TableError| {
        let row = match error {
            TableError::Value { row, .. } | TableError::Order { row, .. } => row + 2,
            _ => 0,
        };
        Located::new(file, Fault::NotAllowed, error.to_string()).line(row as u64)
    };
    let table = ShorteningTable::new(&q_rad, &shortening_m).map_err(located)?;
    for tendon in tendons {
        for (_, arm) in &mut tendon.moment_arms {
            match arm {
                ArmEntry::Table(own, _, to) if own == name => *to = Some(table.clone()),
                ArmEntry::Table(..) | ArmEntry::Constant(_) => {}
            }
        }
    }
    Ok(())
}

/// Reads positions of a joint, rad, and shortenings of a path, m.
fn shortenings(file: &str, text: &str) -> Result<(Vec<f64>, Vec<f64>), Located> {
    const COLUMNS: [&str; 2] = ["q_rad", "shortening_mm"];
    let table = CsvTable::parse(text, file)?;
    table.need(&COLUMNS)?;
    table.only(&COLUMNS)?;
    let (mut q_rad, mut shortening_m) = (Vec::new(), Vec::new());
    for row in table.rows() {
        q_rad.push(row.need("q_rad", Bound::Any, "required in every row")?);
        shortening_m
            .push(M_PER_MM * row.need("shortening_mm", Bound::Any, "required in every row")?);
    }
    Ok((q_rad, shortening_m))
}

/// Names of the joints that tendons cross.
pub(super) fn crossed(tendons: &[TendonEntry]) -> impl Iterator<Item = &str> {
    let arms = tendons.iter().flat_map(|tendon| &tendon.moment_arms);
    arms.map(|(joint, _)| joint.as_str())
}

/// Faults of tendons that are independent of the arm.
pub(super) fn gaps(tendons: &[TendonEntry]) -> impl Iterator<Item = Located> {
    tendons.iter().filter_map(|tendon| tendon.gap.clone())
}

/// Joints of an arm, coupled by its tendons.
pub(super) struct Coupled {
    pub(super) coupling: Coupling,
    /// Transmission of each axis in the coupled robot.
    pub(super) drives: Vec<CoupledDrive>,
    /// Reason why the robot cannot be estimated.
    pub(super) gap: Option<Located>,
}

/// Transmission of an axis in a coupled robot.
pub(super) enum CoupledDrive {
    /// Transmission that the file describes for the joint.
    Own,
    /// The joint has a tendon of its own, and others cross it.
    Crossed(Routing),
    /// Transmission by a tendon of the file.
    Tendon(Box<Transmission>),
}

/// Couples joints by the motors and tendons of the file.
///
/// * `joints`: those of the arm, in its order. `locked`: joints that are welded, whose moment arms are ignored.
///
/// # Errors
/// With tendon, value and unit.
pub(super) fn couple(
    file: &str,
    (motors, tendons): (&[MotorEntry], &[TendonEntry]),
    joints: &[JointOfFile<'_>],
    locked: &[&str],
) -> Result<Coupled, Located> {
    let mut description = CouplingDescription::default();
    for joint in joints {
        description.joints.push(JointDescription {
            name: joint.name.to_owned(),
            is_rigid: joint.is_rigid,
            spring: joint.spring,
        });
        if let Some(stiffness) = joint.own_stiffness_nm_per_rad {
            description.motors.push(joint.name.to_owned());
            description.tendons.push(TendonDescription {
                name: joint.name.to_owned(),
                kind: TendonKind::Loop,
                coordinate: Coordinate::MotorRadians { drum_m: None },
                drums: alloc::vec![(joint.name.to_owned(), 1.0)],
                moment_arms: alloc::vec![(joint.name.to_owned(), MomentArm::Constant(1.0))],
                stiffness,
                pretension: None,
            });
        }
    }
    let shorthand = description.tendons.len();
    description
        .motors
        .extend(motors.iter().map(|m| m.name.clone()));
    for tendon in tendons {
        let mut own = tendon.description.clone();
        for (joint, arm) in &tendon.moment_arms {
            match arm {
                _ if locked.contains(&joint.as_str()) => {}
                ArmEntry::Constant(arm) => {
                    own.moment_arms
                        .push((joint.clone(), MomentArm::Constant(*arm)));
                }
                ArmEntry::Table(.., Some(table)) => {
                    own.moment_arms
                        .push((joint.clone(), MomentArm::Table(table.clone())));
                }
                ArmEntry::Table(table, line, None) => {
                    let problem = format!(
                        "moment arm of tendon '{}' at joint '{joint}' is the table '{table}', which has not been read",
                        own.name
                    );
                    return Err(Located::new(file, Fault::NotAllowed, problem)
                        .line(*line)
                        .cure("load the robot from its folder"));
                }
            }
        }
        description.tendons.push(own);
    }
    let line_of = |tendon: Option<&str>| {
        let named = tendons
            .iter()
            .find(|t| Some(t.description.name.as_str()) == tendon);
        named.or(tendons.first()).map_or(0, |t| t.line)
    };
    let coupling = Coupling::new(description).map_err(|error| {
        let line = line_of(tendon_of(&error));
        Located::new(file, Fault::NotAllowed, error.to_string()).line(line)
    })?;
    let mut drives = Vec::with_capacity(joints.len());
    let gap = match coupling.paired() {
        Err(error) => {
            let located = Located::new(file, Fault::NotAllowed, error.to_string());
            Some(located.line(line_of(error.tendon())))
        }
        Ok(paired) => {
            drives.extend(paired.into_iter().enumerate().map(|(axis, paired)| {
                let Some(mut paired) = paired else {
                    return CoupledDrive::Own;
                };
                for pulled in paired
                    .routing
                    .pull
                    .iter_mut()
                    .flat_map(|pull| &mut pull.joints)
                {
                    pulled.friction = joints[pulled.joint].friction;
                }
                let entry = paired.tendon.checked_sub(shorthand);
                match entry.and_then(|i| tendons.get(i)) {
                    Some(entry) => {
                        let friction = joints.get(axis).map(|joint| joint.friction);
                        let tendon =
                            transmission(entry, paired, friction.unwrap_or_default(), motors);
                        CoupledDrive::Tendon(Box::new(tendon))
                    }
                    None if is_single(&paired.routing) => CoupledDrive::Own,
                    None => CoupledDrive::Crossed(paired.routing),
                }
            }));
            None
        }
    };
    Ok(Coupled {
        coupling,
        drives,
        gap,
    })
}

/// Whether a tendon crosses only its joint, and no other tendon crosses that joint.
fn is_single(routing: &Routing) -> bool {
    let is_one = |row: &[f64]| row.iter().filter(|x| **x != 0.0).count() == 1;
    is_one(&routing.moment_arms) && is_one(&routing.torque_shares)
}

/// Transmission by a tendon in the coordinate of its joint.
fn transmission(
    entry: &TendonEntry,
    paired: PairedTendon,
    joint_friction: Friction,
    motors: &[MotorEntry],
) -> Transmission {
    let PairedTendon {
        units_per_rad,
        routing,
        ..
    } = paired;
    let motor = motors.iter().find(|m| m.name == routing.motor);
    let (ratio, friction) = (routing.drive_ratio, motor.map(|m| m.friction));
    let friction = friction.unwrap_or_default();
    let metres_per_unit = entry.description.coordinate.metres_per_unit();
    let rope = entry.rope.as_ref().zip(metres_per_unit);
    Transmission {
        stiffness_nm_per_rad: entry.description.stiffness * units_per_rad * units_per_rad,
        motor_inertia_kg_m2: motor
            .and_then(|m| m.inertia_kg_m2)
            .map(|inertia| inertia / (ratio * ratio)),
        joint_friction,
        motor_friction: Friction {
            coulomb_nm: friction.coulomb_nm / ratio.abs(),
            viscous_nm_s_per_rad: friction.viscous_nm_s_per_rad / (ratio * ratio),
        },
        tendon: rope.map(|(rope, metres_per_unit)| Tendon {
            rope: rope.name.clone(),
            length_m: rope.length_m,
            joint_pulley_radius_m: metres_per_unit * units_per_rad,
            pretension_n: rope.pretension_n,
            antagonistic: false,
            guides: rope.guides.clone(),
            retension_at_m: rope.retension_at_m,
            replace_at_strain: rope.replace_at_strain,
            frame_expansion_per_k: rope.frame_expansion_per_k,
        }),
        temperature_effect: None,
        anchors: Vec::new(),
        routing: Some(routing),
    }
}

/// Tendon that an error names.
fn tendon_of(error: &CouplingError) -> Option<&str> {
    match error {
        CouplingError::Unknown { tendon, .. }
        | CouplingError::Twice { tendon, .. }
        | CouplingError::NoJoint { tendon }
        | CouplingError::NoPretension { tendon, .. } => Some(tendon),
        CouplingError::Name { of, name } | CouplingError::Value { of, name, .. } => {
            (*of == "tendon").then_some(name.as_str())
        }
        CouplingError::Transmissions { .. }
        | CouplingError::NotDriven { .. }
        | CouplingError::OneSided { .. } => None,
    }
}
