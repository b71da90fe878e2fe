//! What is odd about a record, and what is done about it.

use super::super::curve::Curve;
use super::super::scan::oddities;
use super::Stage;

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

/// Readings with rising stamps; repeated stamps stay, for the fit weighs them.
pub(super) fn clean(
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

/// Takes jumps and outliers out of every stage, and says so.
pub(super) fn take_out_faults(
    curve: &mut Curve,
    stages: &[Stage],
    keep: bool,
    start: f64,
) -> Vec<Fault> {
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
