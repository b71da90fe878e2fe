//! From a specimen's columns to a curve: zero, preload, ramp, stages, faults.

use sinew_log::{Specimen, TestQuantity};

use super::CreepError;
use super::curve::Curve;
use super::scan::{median, oddities, plateaus, smoothed};

/// What a file may not say.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PrepareOptions {
    /// Gauge length, m; needed for an elongation where the file has none.
    pub gauge_length_m: Option<f64>,
    /// Cross-section, m²; without it there is no creep modulus.
    pub area_m2: Option<f64>,
    /// Temperature, °C, of files that don't record it.
    pub temperature_c: Option<f64>,
    /// Keep jumps (grip slips) and outliers instead of taking them out.
    pub keep_faults: bool,
}

/// What is odd about a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// The strain jumps under constant load.
    Slip,
    /// One reading stands apart.
    Outlier,
    /// The load on a plateau changes by more than ISO 899-1 allows (1 %).
    LoadDrift,
    /// The record starts under load: neither ramp nor zero are in it.
    NoRamp,
    /// The load came on slower than within 5 s.
    SlowRamp,
    /// Several readings with one stamp, or a clock that goes back.
    Clock,
    /// Readings that are missing or no numbers.
    Gap,
    /// Numbers that are possible, but look like another unit.
    Doubtful,
}

/// An oddity with its time.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Fault {
    /// Kind.
    pub kind: FaultKind,
    /// When, s of the record, where it has a time.
    pub time_s: Option<f64>,
    /// What was found and what was done.
    pub text: String,
}

/// A stretch under one load.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Stage {
    /// First reading at the load, s since the load began.
    pub start_s: f64,
    /// Last reading, s.
    pub end_s: f64,
    /// Mean load, N; NaN where none is recorded.
    pub force_n: f64,
    /// How long the load took to come or go before, s.
    pub ramp_s: f64,
}

/// A specimen ready to be analysed.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// Name.
    pub name: String,
    /// Readings under load and after, all of them; strain counts from the zero.
    pub curve: Curve,
    /// Load of the first stage, N.
    pub force_n: Option<f64>,
    /// Load before the first stage, N.
    pub preload_n: Option<f64>,
    /// Stress of the first stage, Pa.
    pub stress_pa: Option<f64>,
    /// Time of the record at which the load begins, s.
    pub load_start_s: f64,
    /// Stages from the first under load.
    pub stages: Vec<Stage>,
    /// What was taken for strain zero.
    pub zero: String,
    /// Mean temperature and range, °C.
    pub temperature_c: Option<(f64, f64, f64)>,
    /// Mean humidity and range, %.
    pub humidity_percent: Option<(f64, f64, f64)>,
    /// Oddities.
    pub faults: Vec<Fault>,
}

/// ISO 899-1: the load stays within this share of its value.
const LOAD_TOLERANCE: f64 = 0.01;
/// ISO 899-1: the load comes on within 1 s to 5 s.
const RAMP_S: f64 = 5.0;
/// Fewest readings of a creep test.
const FEWEST: usize = 5;

/// Prepares a specimen.
///
/// # Errors
/// [`CreepError::Specimen`] with what was found: too few readings, no gauge length, a strain or
/// force that must be another unit, force and elongation that look swapped.
pub fn prepare(specimen: &Specimen, options: &PrepareOptions) -> Result<Prepared, CreepError> {
    let refuse = |reason: String| CreepError::Specimen {
        specimen: specimen.name.clone(),
        reason,
    };
    let mut faults = Vec::new();
    let (raw_time, raw_strain, raw_force) = columns(specimen, options)?;
    let kept = clean(&raw_time, &raw_strain, raw_force.as_deref(), &mut faults);
    if kept.len() < FEWEST {
        return Err(refuse(format!(
            "{} usable readings; a creep test needs {FEWEST}",
            kept.len()
        )));
    }
    let time: Vec<f64> = kept.iter().map(|&i| raw_time[i]).collect();
    let mut strain: Vec<f64> = kept.iter().map(|&i| raw_strain[i]).collect();
    let force: Option<Vec<f64>> = raw_force
        .as_ref()
        .map(|force| kept.iter().map(|&i| force[i]).collect());
    let most = strain.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
    // No fibre, rope or plastic reaches its own length again; wood and metals far less.
    if most > 2.0 {
        return Err(refuse(format!(
            "strain reaches {most:.3} m/m, {:.0} %: is the column in percent or an elongation? say strain=COLUMN:% or elongation=COLUMN:mm",
            100.0 * most
        )));
    }
    if most > 0.5 {
        faults.push(Fault {
            kind: FaultKind::Doubtful,
            time_s: None,
            text: format!("strain reaches {:.0} %: is its unit right?", 100.0 * most),
        });
    }
    let span = time[time.len() - 1] - time[0];
    if span < 60.0 {
        faults.push(Fault {
            kind: FaultKind::Doubtful,
            time_s: None,
            text: format!("the record lasts {span:.3} s: is the time in minutes or hours?"),
        });
    }
    let load = Load::read(
        &time,
        &strain,
        force.as_deref(),
        &specimen.name,
        &mut faults,
    )?;
    let at_zero = load.first;
    let zero = if load.before > 0 {
        let before = &strain[load.before_from..load.before_from + load.before];
        let zero = before.iter().sum::<f64>() / before.len() as f64;
        strain.iter_mut().for_each(|e| *e -= zero);
        format!("mean of {} readings before the load", load.before)
    } else {
        "as recorded; no reading before the load".to_owned()
    };
    let start = load.start_s;
    let mut curve = Curve {
        name: specimen.name.clone(),
        time_s: time[at_zero..].iter().map(|t| t - start).collect(),
        strain: strain[at_zero..].to_vec(),
        count: vec![1.0; time.len() - at_zero],
        steps: load.steps.clone(),
        temperature_c: None,
    };
    faults.extend(take_out_faults(
        &mut curve,
        &load.stages,
        options.keep_faults,
        start,
    ));
    // Readings while the load changes belong to no stage.
    let in_stage = |t: f64| {
        load.stages
            .iter()
            .any(|s| t >= s.start_s - 1e-9 && t <= s.end_s + 1e-9)
    };
    let keep: Vec<usize> = (0..curve.time_s.len())
        .filter(|&i| in_stage(curve.time_s[i]))
        .collect();
    curve.time_s = keep.iter().map(|&i| curve.time_s[i]).collect();
    curve.strain = keep.iter().map(|&i| curve.strain[i]).collect();
    curve.count = vec![1.0; keep.len()];
    let temperature_c = range(specimen, TestQuantity::Temperature)
        .or_else(|| options.temperature_c.map(|t| (t, t, t)));
    curve.temperature_c = temperature_c.map(|t| t.0);
    let area = specimen
        .constant(TestQuantity::Area)
        .or(options.area_m2)
        .filter(|area| *area > 0.0);
    let force_n = load.reference_n;
    let stress_pa = force_n
        .zip(area)
        .map(|(force, area)| force / area)
        .or_else(|| specimen.constant(TestQuantity::Stress));
    Ok(Prepared {
        name: specimen.name.clone(),
        curve,
        force_n,
        preload_n: load.preload_n,
        stress_pa,
        load_start_s: start,
        stages: load.stages,
        zero,
        temperature_c,
        humidity_percent: range(specimen, TestQuantity::Humidity),
        faults,
    })
}

type Columns = (Vec<f64>, Vec<f64>, Option<Vec<f64>>);

fn columns(specimen: &Specimen, options: &PrepareOptions) -> Result<Columns, CreepError> {
    let refuse = |reason: &str| CreepError::Specimen {
        specimen: specimen.name.clone(),
        reason: reason.to_owned(),
    };
    let time = specimen
        .column(TestQuantity::Time)
        .ok_or_else(|| refuse("no time"))?
        .to_vec();
    let strain = if let Some(strain) = specimen.column(TestQuantity::Strain) {
        strain.to_vec()
    } else if let Some(elongation) = specimen.column(TestQuantity::Elongation) {
        let length = options
            .gauge_length_m
            .or_else(|| specimen.constant(TestQuantity::GaugeLength))
            .ok_or_else(|| {
                refuse("an elongation needs the gauge length: say it (--gauge-length-mm) or write 'L0 (mm)' above the header")
            })?;
        if length <= 0.0 || length.is_nan() {
            return Err(refuse(&format!(
                "gauge length {length} m; it must be positive"
            )));
        }
        elongation.iter().map(|e| e / length).collect()
    } else {
        return Err(refuse("no elongation or strain"));
    };
    Ok((
        time,
        strain,
        specimen.column(TestQuantity::Force).map(<[f64]>::to_vec),
    ))
}

/// Readings with rising stamps; repeated stamps stay, for the fit weighs them.
fn clean(
    time: &[f64],
    strain: &[f64],
    force: Option<&[f64]>,
    faults: &mut Vec<Fault>,
) -> Vec<usize> {
    let (mut kept, mut gaps, mut back, mut repeated) = (Vec::new(), 0, 0, 0);
    let mut latest = f64::NEG_INFINITY;
    for i in 0..time.len() {
        let whole = time[i].is_finite()
            && strain[i].is_finite()
            && force.is_none_or(|force| force[i].is_finite());
        if !whole {
            gaps += 1;
        } else if time[i] < latest {
            back += 1;
        } else {
            repeated += usize::from(time[i] == latest);
            latest = time[i];
            kept.push(i);
        }
    }
    let mut say = |kind, text| {
        faults.push(Fault {
            kind,
            time_s: None,
            text,
        });
    };
    if gaps > 0 {
        say(
            FaultKind::Gap,
            format!("{gaps} readings are missing or no numbers; left out"),
        );
    }
    if back > 0 {
        say(
            FaultKind::Clock,
            format!("{back} readings are older than the one before; left out"),
        );
    }
    if repeated > 0 {
        say(
            FaultKind::Clock,
            format!("{repeated} readings repeat the stamp before; all are used"),
        );
    }
    kept
}

fn range(specimen: &Specimen, quantity: TestQuantity) -> Option<(f64, f64, f64)> {
    let values: Vec<f64> = specimen
        .column(quantity)?
        .iter()
        .copied()
        .filter(|v| v.is_finite())
        .collect();
    if values.is_empty() {
        return None;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some((mean, low, high))
}

/// What the force column tells.
struct Load {
    /// First reading that counts.
    first: usize,
    /// Readings before the load that give the zero: where from, how many.
    before_from: usize,
    before: usize,
    start_s: f64,
    steps: Vec<(f64, f64)>,
    stages: Vec<Stage>,
    reference_n: Option<f64>,
    preload_n: Option<f64>,
}

impl Load {
    fn read(
        time: &[f64],
        strain: &[f64],
        force: Option<&[f64]>,
        name: &str,
        faults: &mut Vec<Fault>,
    ) -> Result<Load, CreepError> {
        let refuse = |reason: String| CreepError::Specimen {
            specimen: name.to_owned(),
            reason,
        };
        let last = time.len() - 1;
        let unramped = |reference_n: Option<f64>, faults: &mut Vec<Fault>, text: &str| {
            faults.push(Fault {
                kind: FaultKind::NoRamp,
                time_s: None,
                text: text.to_owned(),
            });
            Load {
                first: 0,
                before_from: 0,
                before: 0,
                start_s: time[0],
                steps: vec![(0.0, 1.0)],
                stages: vec![Stage {
                    start_s: 0.0,
                    end_s: time[last] - time[0],
                    force_n: reference_n.unwrap_or(f64::NAN),
                    ramp_s: 0.0,
                }],
                reference_n,
                preload_n: None,
            }
        };
        let Some(force) = force else {
            return Ok(unramped(
                None,
                faults,
                "no force is recorded: a constant load from the first reading on is assumed",
            ));
        };
        let smooth = smoothed(force);
        let largest = smooth.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return Err(refuse(
                "the force never rises above zero: is its sign right?".to_owned(),
            ));
        }
        let share: Vec<f64> = smooth.iter().map(|f| f / largest).collect();
        let plateaus = plateaus(&share);
        /// A creep load is at least this share of the largest.
        const LOADED: f64 = 0.3;
        let Some(loaded) = plateaus.iter().position(|p| p.level > LOADED) else {
            swapped(time, strain, force).map_err(refuse)?;
            return Err(refuse(
                "the force holds no level: not a creep test, or force and elongation are swapped"
                    .to_owned(),
            ));
        };
        let first = plateaus[loaded];
        swapped(
            &time[first.from..first.to],
            &strain[first.from..first.to],
            &force[first.from..first.to],
        )
        .map_err(refuse)?;
        let reference = first.level * largest;
        if first.from == 0 {
            let constant = force
                .iter()
                .all(|f| (f - reference).abs() < 1e-6 * reference);
            if constant && plateaus.len() == 1 {
                return Ok(unramped(
                    Some(reference),
                    faults,
                    "the record starts under its load: times count from the first reading",
                ));
            }
            faults.push(Fault {
                kind: FaultKind::NoRamp,
                time_s: None,
                text: "the record starts under its load: times count from the first reading"
                    .to_owned(),
            });
        }
        // The ramp begins with the last reading that is still at the level before.
        let before = (loaded > 0).then(|| plateaus[loaded - 1]);
        let base = before.map_or_else(|| share[0].min(0.0), |p| p.level);
        let begin = (0..first.from)
            .rev()
            .find(|&i| share[i] - base < 0.02)
            .unwrap_or(0);
        let start_s = time[begin];
        let ramp_s = if first.from == 0 {
            0.0
        } else {
            time[first.from] - start_s
        };
        if ramp_s > RAMP_S {
            faults.push(Fault {
                kind: FaultKind::SlowRamp,
                time_s: Some(start_s),
                text: format!(
                    "the load came on within {ramp_s:.1} s; ISO 899-1 asks for 1 s to 5 s; the fit uses the ramp as recorded"
                ),
            });
        }
        let preload = before
            .map(|p| p.level * largest)
            .filter(|p| p.abs() > 0.005 * largest);
        let (before_from, before_count) = match before {
            Some(p) => {
                // The last readings before the ramp; the earlier ones may belong to the clamping.
                let count = (begin + 1 - p.from).min(20);
                (begin + 1 - count, count)
            }
            None if first.from > 0 => (begin, 1),
            None => (0, 0),
        };
        let mut stages = Vec::new();
        let mut end_before = begin;
        for p in &plateaus[loaded..] {
            let inside = &force[p.from..p.to];
            let level = median(inside);
            let (low, high) = inside
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), f| {
                    (l.min(*f), h.max(*f))
                });
            let drift = (high - level).max(level - low);
            if level > 0.05 * largest && drift > LOAD_TOLERANCE * level {
                faults.push(Fault {
                    kind: FaultKind::LoadDrift,
                    time_s: Some(time[p.from]),
                    text: format!(
                        "the load of {level:.3} N varies by up to {:.1} %; ISO 899-1 allows 1 %; the fit uses the load as recorded",
                        100.0 * drift / level
                    ),
                });
            }
            stages.push(Stage {
                start_s: time[p.from] - start_s,
                end_s: time[p.to - 1] - start_s,
                force_n: level,
                ramp_s: (time[p.from] - time[end_before]).max(0.0),
            });
            end_before = p.to - 1;
        }
        Ok(Load {
            first: first.from,
            before_from,
            before: before_count,
            start_s,
            steps: steps(
                &time[begin..],
                &smooth[begin..],
                reference,
                start_s,
                preload.unwrap_or(0.0),
            ),
            stages,
            reference_n: Some(reference),
            preload_n: preload,
        })
    }
}

/// In a creep test the force stays and the strain grows; the other way round, columns are swapped.
fn swapped(time: &[f64], strain: &[f64], force: &[f64]) -> Result<(), String> {
    let third = time.len() / 3;
    if third < 3 {
        return Ok(());
    }
    let change = |v: &[f64]| {
        let (early, late) = (median(&v[third / 2..third]), median(&v[v.len() - third..]));
        (late - early).abs() / late.abs().max(1e-300)
    };
    // A load held to a part in ten thousand that "creeps" is a strain, and the reverse.
    if change(strain) < 1e-4 && change(force) > 0.01 {
        return Err(format!(
            "the force changes by {:.1} % and the strain by {:.4} %: force and elongation look swapped",
            100.0 * change(force),
            100.0 * change(strain)
        ));
    }
    Ok(())
}

/// The load as steps: a new one where it has left the last by more than a dead band.
fn steps(
    time: &[f64],
    force: &[f64],
    reference: f64,
    start_s: f64,
    preload: f64,
) -> Vec<(f64, f64)> {
    /// Steps beyond which a finer band changes nothing that can be seen.
    const MOST: usize = 60;
    let mut band = 0.005;
    loop {
        let mut steps: Vec<(f64, f64)> = Vec::new();
        let mut level = 0.0;
        for i in 0..time.len() {
            // The strain counts from the preload, so the load does too.
            let now = (force[i] - preload) / (reference - preload);
            if (now - level).abs() > band {
                // A change between two readings happened half way.
                let at = if i > 0 {
                    0.5 * (time[i] + time[i - 1])
                } else {
                    time[0]
                };
                steps.push((at - start_s, now));
                level = now;
            }
        }
        if steps.len() <= MOST || band > 0.3 {
            return if steps.is_empty() {
                vec![(0.0, 1.0)]
            } else {
                steps
            };
        }
        band *= 1.5;
    }
}

/// Takes jumps and outliers out of every stage, and says so.
fn take_out_faults(curve: &mut Curve, stages: &[Stage], keep: bool, start: f64) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut drop = Vec::new();
    for stage in stages {
        let from = curve.time_s.partition_point(|t| *t < stage.start_s);
        let to = curve.time_s.partition_point(|t| *t <= stage.end_s);
        if to <= from {
            continue;
        }
        let short = (1e-3 * (stage.end_s - stage.start_s)).max(1e-9);
        let place: Vec<f64> = curve.time_s[from..to]
            .iter()
            .map(|t| (t - stage.start_s + short).ln())
            .collect();
        let odd = oddities(&place, &curve.strain[from..to]);
        for (index, height) in odd.jumps {
            let time_s = curve.time_s[from + index] + start;
            let done = if keep {
                "kept"
            } else {
                "taken out of all later readings"
            };
            faults.push(Fault {
                kind: FaultKind::Slip,
                time_s: Some(time_s),
                text: format!(
                    "strain jumps by {:+.4} % at {time_s:.1} s: a grip slip, not creep; {done}",
                    100.0 * height
                ),
            });
            if !keep {
                curve.strain[from + index..]
                    .iter_mut()
                    .for_each(|e| *e -= height);
            }
        }
        for index in odd.outliers {
            let time_s = curve.time_s[from + index] + start;
            faults.push(Fault {
                kind: FaultKind::Outlier,
                time_s: Some(time_s),
                text: format!(
                    "the reading at {time_s:.1} s stands apart; {}",
                    if keep { "kept" } else { "left out" }
                ),
            });
            drop.push(from + index);
        }
    }
    if !keep {
        let mut i = 0;
        let mut keep_reading = || {
            i += 1;
            !drop.contains(&(i - 1))
        };
        let kept: Vec<bool> = curve.time_s.iter().map(|_| keep_reading()).collect();
        let filter = |v: &[f64]| -> Vec<f64> {
            v.iter()
                .zip(&kept)
                .filter(|(_, k)| **k)
                .map(|(v, _)| *v)
                .collect()
        };
        curve.time_s = filter(&curve.time_s);
        curve.strain = filter(&curve.strain);
        curve.count = filter(&curve.count);
    }
    faults
}
