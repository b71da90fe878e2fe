//! Design matrix of a comparison: the columns of each tendon, for its group and for the factors to be adjusted for.

use super::factor::{BAND_K, DesignGroup, Factor, GroupKey, band, level, numbered};
use super::values::{drawn_in, logarithms, spreads};
use super::{CreepUnit, apart};
use crate::args::By;
use crate::gather::CreepingTendon;
use crate::hierarchy::{self, Hierarchy, Unit};
use std::collections::BTreeMap;

/// Prior deviation of kinds of tendon, and of covariates, over the logarithm.
const KIND: f64 = 10.0;
const COVARIATE: f64 = 1.0;
/// Scale of the differences between groups, and of the other factors.
const GROUP_SCALE: f64 = 0.2;

/// The model of a comparison.
pub(crate) struct Design {
    pub(crate) hierarchy: Hierarchy,
    /// Groups, by key; a column each from `first_group` on.
    pub(super) groups: Vec<DesignGroup>,
    pub(super) first_group: usize,
    /// Mean over the tendons of each family of all columns except those of the groups and of factors within groups;
    /// groups are evaluated there.
    pub(super) middles: BTreeMap<Option<String>, Vec<f64>>,
    pub(crate) unit: CreepUnit,
    /// Logarithm of the creep of each tendon.
    pub(crate) logarithms: Vec<f64>,
    pub(super) freed_of: Vec<Factor>,
    pub(super) without_group: usize,
    pub(super) undated: usize,
}

/// The group of a tendon.
fn key(tendon: &CreepingTendon, by: By) -> Option<GroupKey> {
    let (family, name) = match by {
        By::Rope => (None, tendon.fit.rope.clone()?),
        By::Batch => (tendon.fit.rope.clone(), tendon.fit.batch.clone()?),
        By::Site => (None, tendon.site.clone()?),
        By::Temperature => (None, band(tendon)?),
        By::RopeTemperature => (Some(band(tendon)?), tendon.fit.rope.clone()?),
    };
    Some(GroupKey { family, name })
}

/// Factors to be adjusted for besides robots: kinds of tendons, then factors with their own levels.
fn others(by: By) -> (Factor, &'static [Factor]) {
    match by {
        By::Rope => (Factor::Joint, &[Factor::Batch, Factor::Site]),
        By::Batch => (Factor::Kind, &[Factor::SiteOfRope]),
        By::Site | By::Temperature => (Factor::Kind, &[Factor::Batch]),
        By::RopeTemperature => (Factor::Joint, &[Factor::Batch]),
    }
}

impl Design {
    /// Tendons whose group is known.
    pub(super) fn of(all: &[CreepingTendon], by: By) -> Self {
        let keyed = all.iter().filter_map(|t| Some((t, key(t, by)?)));
        Self::keyed(keyed.collect(), all.len(), by)
    }

    /// All tendons grouped by batch; tendons without a specified batch form one group per rope.
    pub(crate) fn by_any_batch(all: &[CreepingTendon]) -> Self {
        let unknown = |t: &CreepingTendon| GroupKey {
            family: t.fit.rope.clone(),
            name: String::new(),
        };
        let keyed = all
            .iter()
            .map(|t| (t, key(t, By::Batch).unwrap_or_else(|| unknown(t))));
        Self::keyed(keyed.collect(), all.len(), By::Batch)
    }

    fn keyed(keyed: Vec<(&CreepingTendon, GroupKey)>, all: usize, by: By) -> Self {
        let tendons: Vec<&CreepingTendon> = keyed.iter().map(|(t, _)| *t).collect();
        let group_numbers = numbered(keyed.iter().map(|(_, key)| key.clone()));
        let group_of: Vec<usize> = keyed.iter().map(|(_, key)| group_numbers[key]).collect();
        let (kind_factor, random) = others(by);
        let levels = |factor: Factor| -> Vec<usize> {
            let names: Vec<String> = tendons.iter().map(|t| level(t, factor)).collect();
            let numbers = numbered(names.iter().cloned());
            names.iter().map(|n| numbers[n]).collect()
        };
        let count = |numbers: &[usize]| numbers.iter().max().map_or(0, |n| n + 1);
        let kinds = levels(kind_factor);
        let robots = levels(Factor::Robot);
        let mut freed_of = vec![kind_factor];

        // Fixed: kinds, then covariates about their means.
        let mut fixed = vec![KIND; count(&kinds)];
        let mut covariates: Vec<Vec<f64>> = Vec::new();
        if matches!(by, By::Rope | By::Batch) {
            let celsius: Vec<Option<f64>> = tendons.iter().map(|t| t.creep.temperature_c).collect();
            if celsius.iter().flatten().count() > 0 {
                // Ropes answer to temperature each in its own way.
                let warmer = centred(&celsius, BAND_K);
                let ropes = numbered(tendons.iter().map(|t| &t.fit.rope));
                for rope in ropes.into_keys() {
                    let own = tendons
                        .iter()
                        .map(|t| f64::from(u8::from(t.fit.rope == *rope)));
                    covariates.push(own.zip(&warmer).map(|(own, k)| own * k).collect());
                }
                freed_of.push(Factor::Temperature);
            }
        }
        let undated = tendons.iter().filter(|t| !t.creep.is_dated).count();
        if undated > 0 && undated < tendons.len() {
            let dated = |t: &&CreepingTendon| Some(f64::from(u8::from(t.creep.is_dated)));
            covariates.push(centred(&tendons.iter().map(dated).collect::<Vec<_>>(), 1.0));
        }
        fixed.extend(covariates.iter().map(|_| COVARIATE));

        // Factors: groups, then what else has levels.
        let first_group = fixed.len();
        let group_count = group_numbers.len();
        let mut factors = vec![hierarchy::Factor {
            first: first_group,
            levels: group_numbers.len(),
            scale: GROUP_SCALE,
            heavy: true,
        }];
        let mut first = first_group + group_numbers.len();
        let mut parts = vec![(first_group, group_of.clone())];
        for &factor in random {
            let numbers = levels(factor);
            let count = count(&numbers);
            if count > 1 {
                factors.push(hierarchy::Factor {
                    first,
                    levels: count,
                    scale: GROUP_SCALE,
                    heavy: factor == Factor::Batch,
                });
                parts.push((first, numbers));
                first += count;
                freed_of.push(factor);
            }
        }
        freed_of.push(Factor::Robot);

        let (values, unit) = logarithms(&tendons, &kinds);
        let ropes_kinds = levels(Factor::Kind);
        let logarithms: Vec<f64> = values.iter().map(|v| v.0).collect();
        let drawn_in = drawn_in(&logarithms, &ropes_kinds);
        let spreads = spreads(&drawn_in, &ropes_kinds, &tendons);
        let units: Vec<Unit> = (0..tendons.len())
            .map(|i| {
                let covariates = covariates.iter().enumerate();
                let mut columns = vec![(kinds[i], 1.0)];
                let covariates = covariates.map(|(k, c)| (count(&kinds) + k, c[i]));
                columns.extend(covariates.filter(|(_, x)| *x != 0.0));
                columns.extend(
                    parts
                        .iter()
                        .map(|(first, numbers)| (first + numbers[i], 1.0)),
                );
                Unit {
                    value: drawn_in[i],
                    variance: values[i].1,
                    spread: spreads[i],
                    robot: robots[i],
                    columns,
                }
            })
            .collect();
        let mut middles: BTreeMap<Option<String>, Vec<f64>> = BTreeMap::new();
        let mut sizes: BTreeMap<Option<String>, f64> = BTreeMap::new();
        for (unit, (_, key)) in units.iter().zip(&keyed) {
            let sums = middles.entry(key.family.clone());
            let sums = sums.or_insert_with(|| vec![0.0; first]);
            for &(column, x) in &unit.columns {
                sums[column] += x;
            }
            *sizes.entry(key.family.clone()).or_default() += 1.0;
        }
        // A rope is shown with a typical batch of it, not with those it happens to have.
        let part_of_group = matches!(by, By::Rope | By::RopeTemperature)
            .then(|| factors.get(1).map(|f| f.first..f.first + f.levels))
            .flatten();
        for (family, sums) in &mut middles {
            let own = first_group..first_group + group_count;
            let excluded = own.chain(part_of_group.clone().unwrap_or(0..0));
            excluded.for_each(|column| sums[column] = 0.0);
            sums.iter_mut().for_each(|x| *x /= sizes[family]);
        }
        let mut groups: Vec<DesignGroup> = (group_numbers.into_keys())
            .map(|key| DesignGroup {
                key,
                tendons: 0,
                robots: 0,
                tied_to: Vec::new(),
            })
            .collect();
        let mut seen = std::collections::BTreeSet::new();
        for (i, &g) in group_of.iter().enumerate() {
            groups[g].tendons += 1;
            groups[g].robots += usize::from(seen.insert((g, robots[i])));
        }
        apart::tie(&mut groups, &tendons, &group_of, by, kind_factor, random);
        Self {
            hierarchy: Hierarchy {
                units,
                fixed,
                factors,
            },
            groups,
            first_group,
            middles,
            unit,
            logarithms,
            freed_of,
            without_group: all - tendons.len(),
            undated,
        }
    }
}

/// Deviations of the values from their mean, in `unit`; 0 for a missing value.
fn centred(values: &[Option<f64>], unit: f64) -> Vec<f64> {
    let finite: Vec<f64> = values.iter().flatten().copied().collect();
    let mean = finite.iter().sum::<f64>() / finite.len().max(1) as f64;
    let of = |v: &Option<f64>| v.map_or(0.0, |v| (v - mean) / unit);
    values.iter().map(of).collect()
}
