//! Reference creep of the ropes of a robot type, as written by `pool --creep`: prior for the trends of new robots.

use crate::FleetError;
use crate::creep::Ages;
use sinew_files::csv::Table;
use sinew_files::date::DAY_S;
use sinew_files::{Bound, Budget, Fault, Fields as _};
use sinew_log::{Cell, CellKind, Column, TableWriter};
use sinew_trend::filter::{Curve, Prior};
use std::collections::BTreeMap;
use std::path::Path;

/// Plausible creep per decade of time, rad, or m for a prismatic joint; values in mrad or mm would exceed it.
const CREEP_RANGE: Bound = Bound::Within(1e-9, 1.0);
const TEXTS: [&str; 5] = ["robot_type", "joint", "rope", "batch", "site"];
const NUMBERS: [&str; 5] = [
    "creep_rad_per_decade",
    "creep_spread_ln",
    "from_days",
    "to_days",
    "tendons",
];

/// Kind of tendons: type, joint and rope; without a batch or a site, those of any other.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct CreepKind {
    /// Type of the robot.
    pub robot_type: String,
    /// Name of the joint.
    pub joint: String,
    /// Name of the rope, if specified.
    pub rope: Option<String>,
    /// Production batch of the rope, if specific.
    pub batch: Option<String>,
    /// Site of the robots, if specific.
    pub site: Option<String>,
}

impl CreepKind {
    /// Same kind for any batch and site.
    pub(crate) fn widest(&self) -> Self {
        Self {
            batch: None,
            site: None,
            ..self.clone()
        }
    }

    /// The kind itself, without its batch, without its site, and without both, in the order of preference.
    pub(crate) fn and_wider(&self) -> impl Iterator<Item = Self> {
        let with = [(true, true), (false, true), (true, false), (false, false)];
        with.into_iter().map(|(batch, site)| Self {
            batch: self.batch.clone().filter(|_| batch),
            site: self.site.clone().filter(|_| site),
            ..self.clone()
        })
    }
}

/// Creep of a kind of tendons.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceCreep {
    /// Median of the offset per decade of time, rad.
    pub median_rad: f64,
    /// Standard deviation of its logarithm from tendon to tendon.
    pub spread: f64,
    /// Range of rope ages of the estimate.
    pub ages: Ages,
    /// Number of tendons in the estimate.
    pub tendons: usize,
}

/// Reference creep of all kinds.
pub type ReferenceCreeps = BTreeMap<CreepKind, ReferenceCreep>;

/// Returns the reference creep of the most specific kind of a tendon.
pub(crate) fn find(
    reference: &ReferenceCreeps,
    tendon: &CreepKind,
) -> Option<(CreepKind, ReferenceCreep)> {
    tendon.and_wider().find_map(|kind| {
        let creep = *reference.get(&kind)?;
        Some((kind, creep))
    })
}

/// Writes a table of reference creep.
///
/// # Errors
///
/// Returns [`FleetError`] if the file cannot be written.
pub fn write(reference: &ReferenceCreeps, path: &Path) -> Result<(), FleetError> {
    let of = |kind: CellKind| move |name: &&str| ((*name).to_owned(), kind);
    let columns: Vec<Column> = (TEXTS.iter().map(of(CellKind::Text)))
        .chain(NUMBERS.iter().map(of(CellKind::Number)))
        .collect();
    let mut writer = TableWriter::create(path, &columns)?;
    for (kind, creep) in reference {
        let text = |of: &str| Cell::Text(of.to_owned());
        let maybe = |of: &Option<String>| of.as_deref().map_or(Cell::Empty, text);
        writer.row(&[
            text(&kind.robot_type),
            text(&kind.joint),
            maybe(&kind.rope),
            maybe(&kind.batch),
            maybe(&kind.site),
            Cell::Number(creep.median_rad),
            Cell::Number(creep.spread),
            Cell::Number(creep.ages.from_days),
            Cell::Number(creep.ages.to_days),
            Cell::Number(creep.tendons as f64),
        ])?;
    }
    Ok(writer.finish()?)
}

/// Reads a file written by `pool --creep`.
///
/// # Errors
/// Returns the location of the invalid value.
pub fn read(path: &Path) -> Result<ReferenceCreeps, FleetError> {
    let table = Table::read(path, &Budget::TABLE)?;
    table.need(&[&TEXTS[..], &NUMBERS[..]].concat())?;
    let mut out = ReferenceCreeps::new();
    for row in table.rows() {
        let text = |column| row.text(column).map(str::to_owned);
        let number = |column: &'static str| {
            let bound = if column == NUMBERS[0] {
                CREEP_RANGE
            } else {
                Bound::Positive
            };
            let found = row.number(column, bound)?;
            found.ok_or_else(|| row.missing(column, "every row has one"))
        };
        let [median_rad, spread, from_days, to_days, tendons] = [
            number(NUMBERS[0])?,
            number(NUMBERS[1])?,
            number(NUMBERS[2])?,
            number(NUMBERS[3])?,
            number(NUMBERS[4])?,
        ];
        if to_days <= from_days {
            let problem = "must be above from_days";
            return Err(row
                .here(Fault::NotAllowed, problem)
                .column("to_days")
                .into());
        }
        let kind = CreepKind {
            robot_type: row.need_text("robot_type")?.to_owned(),
            joint: row.need_text("joint")?.to_owned(),
            rope: text("rope"),
            batch: text("batch"),
            site: text("site"),
        };
        let creep = ReferenceCreep {
            median_rad,
            spread,
            ages: Ages { from_days, to_days },
            tendons: tendons as usize,
        };
        if out.insert(kind, creep).is_some() {
            let problem = "duplicate row of these tendons";
            return Err(row.here(Fault::NotAllowed, problem).cure("keep one").into());
        }
    }
    Ok(out)
}

/// Adapts the curves of a prior to the reference creep.
///
/// The curves of a creep law keep their shapes and order: the logarithms of their creep per decade are shifted and
/// scaled to the median and the spread. Generic shapes get three sizes each; a fraction of 0.02 of them stays unchanged.
pub(crate) fn apply(prior: &mut Prior, reference: &ReferenceCreep) {
    /// Share of the spread within each curve of a law; the curves differ by the remainder.
    const WITHIN_CURVE_SHARE: f64 = 0.8;
    /// Sizes of a shape, in spreads, and their probabilities; with the standard deviation of each, an approximate log-normal.
    const SIZES: [(f64, f64); 3] = [(-1.2, 0.3), (0.0, 0.4), (1.2, 0.3)];
    const SIZE_STD: f64 = 0.37;
    /// Share of generic shapes that stay unchanged.
    const UNMOVED: f64 = 0.02;
    let decades = (reference.ages.to_days / reference.ages.from_days).log10();
    let per_decade = |curve: &Curve| {
        let [from, to] =
            [reference.ages.from_days, reference.ages.to_days].map(|days| curve.at(days * DAY_S));
        Some((to - from) / decades).filter(|s| *s > 0.0)
    };
    let middle = reference.median_rad.ln();
    // Curves of a law have an amplitude of about 1, generic shapes one around 0.
    let is_law = |curve: &Curve| curve.amplitude > 0.0;
    let laws: Vec<f64> = (prior.curves.iter().filter(|c| is_law(c)))
        .filter_map(|c| per_decade(c).map(f64::ln))
        .collect();
    let count = laws.len().max(1) as f64;
    let mean = laws.iter().sum::<f64>() / count;
    let width = (laws.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / count).sqrt();
    let own = WITHIN_CURVE_SHARE * reference.spread;
    let stretch = match width > 0.0 {
        true => (reference.spread.powi(2) - own * own).sqrt() / width,
        false => 0.0,
    };
    let mut curves = Vec::with_capacity(2 * prior.curves.len());
    for curve in std::mem::take(&mut prior.curves) {
        let Some(s) = per_decade(&curve) else {
            curves.push(curve);
            continue;
        };
        if is_law(&curve) {
            let amplitude = (middle + stretch * (s.ln() - mean)).exp() / s;
            curves.push(Curve {
                amplitude,
                amplitude_std: amplitude * own,
                ..curve
            });
            continue;
        }
        for (size, share) in SIZES {
            let amplitude = (middle + reference.spread * size).exp() / s;
            curves.push(Curve {
                amplitude,
                amplitude_std: amplitude * SIZE_STD * reference.spread,
                log_weight: curve.log_weight + (share * (1.0 - UNMOVED)).ln(),
                values: curve.values.clone(),
                retensioned: curve.retensioned.clone(),
            });
        }
        curves.push(Curve {
            log_weight: curve.log_weight + UNMOVED.ln(),
            ..curve
        });
    }
    prior.curves = curves;
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_trend::filter::{generic_curves, node_times_s};

    /// Straight lines over the logarithm of time with the given creep per decade.
    fn law(per_decade_rad: &[f64]) -> Vec<Curve> {
        let times = node_times_s();
        let of = |s: &f64| Curve {
            values: times.iter().map(|t| s * (t / times[0]).log10()).collect(),
            retensioned: None,
            amplitude: 1.0,
            amplitude_std: 0.4,
            log_weight: 0.0,
        };
        per_decade_rad.iter().map(of).collect()
    }

    fn reference_of(median_rad: f64, spread: f64) -> ReferenceCreep {
        ReferenceCreep {
            median_rad,
            spread,
            ages: Ages {
                from_days: 1.0,
                to_days: 30.0,
            },
            tendons: 100,
        }
    }

    #[test]
    fn apply_scales_curves_and_keeps_order() {
        let mut prior = Prior::new(law(&[1e-3, 2e-3, 4e-3]));
        apply(&mut prior, &reference_of(1e-3, 0.5));
        let fast: Vec<f64> = (prior.curves.iter())
            .zip([1e-3, 2e-3, 4e-3])
            .map(|(c, s)| (c.amplitude * s).ln())
            .collect();
        // Median 1 mrad; of a spread of 0.5 each holds 0.4, and they differ by 0.3.
        assert!((fast[1] - 1e-3_f64.ln()).abs() < 1e-9, "{fast:?}");
        let width = ((fast[0] - fast[1]).powi(2) + (fast[2] - fast[1]).powi(2)) / 3.0;
        assert!((width.sqrt() - 0.3).abs() < 1e-9, "{fast:?}");
        assert!(fast.is_sorted());
        let own = prior.curves[0].amplitude_std / prior.curves[0].amplitude;
        assert!((own - 0.4).abs() < 1e-9, "{own}");
        assert!(prior.is_possible());
    }

    #[test]
    fn shapes_without_a_law_get_sizes_and_lose_no_probability() {
        let before = generic_curves(30e-3);
        let mut prior = Prior::new(before.clone());
        apply(&mut prior, &reference_of(1e-3, 0.5));
        assert!(prior.is_possible());
        let weight = |curves: &[Curve]| curves.iter().map(|c| c.log_weight.exp()).sum::<f64>();
        assert!((weight(&prior.curves) / weight(&before) - 1.0).abs() < 1e-9);
        // The mean of a log-normal is above its median, e^(0.5²/2) times.
        let decades = 30.0_f64.log10();
        let mean: f64 = (prior.curves.iter().filter(|c| c.amplitude > 0.0))
            .map(|c| {
                let s = (c.at(30.0 * DAY_S) - c.at(DAY_S)) / decades;
                c.log_weight.exp() * c.amplitude * s
            })
            .sum::<f64>()
            / (0.98 * weight(&before));
        assert!((1.05e-3..1.2e-3).contains(&mean), "{mean}");
    }
}
