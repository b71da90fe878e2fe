//! Confounded groups: groups that cannot be distinguished from another factor, for example a batch used at one site only.

use super::factor::{DesignGroup, Factor, level};
use crate::args::By;
use crate::gather::CreepingTendon;
use std::collections::{BTreeMap, BTreeSet};

/// Determines the factors with which each group is confounded.
///
/// Groups and levels of another factor are joined where a tendon has both. Two groups of a family are comparable only if
/// a path connects them through common levels and groups.
pub(super) fn tie(
    groups: &mut [DesignGroup],
    tendons: &[&CreepingTendon],
    group_of: &[usize],
    by: By,
    kind: Factor,
    random: &[Factor],
) {
    for factor in std::iter::once(kind).chain(random.iter().copied()) {
        // A batch is of one rope, and so is a kind: that is no tie.
        if matches!(
            (by, factor),
            (By::Rope | By::RopeTemperature, Factor::Batch)
        ) {
            continue;
        }
        let names: Vec<String> = tendons.iter().map(|t| level(t, factor)).collect();
        let component = components(groups.len(), group_of, &names);
        for g in 0..groups.len() {
            let family = &groups[g].key.family;
            let alone = !(0..groups.len()).any(|other| {
                other != g
                    && groups[other].key.family == *family
                    && component[other] == component[g]
            });
            let has_family = groups.iter().filter(|o| o.key.family == *family).count() > 1;
            if alone && has_family {
                let own = names.iter().zip(group_of).filter(|(_, of)| **of == g);
                let levels: BTreeSet<&str> = own.map(|(name, _)| name.as_str()).collect();
                let text = levels.into_iter().collect::<Vec<_>>().join("; ");
                groups[g].tied_to.push((factor, text));
            }
        }
    }
}

/// Connected component of each group in the graph of groups and levels.
fn components(groups: usize, group_of: &[usize], levels: &[String]) -> Vec<usize> {
    let mut component: Vec<usize> = (0..groups).collect();
    let mut of_level: BTreeMap<&str, BTreeSet<usize>> = BTreeMap::new();
    for (level, g) in levels.iter().zip(group_of) {
        of_level.entry(level).or_default().insert(*g);
    }
    for together in of_level.values() {
        let parts: BTreeSet<usize> = together.iter().map(|g| component[*g]).collect();
        let Some(&least) = parts.first() else {
            continue;
        };
        for c in &mut component {
            if parts.contains(c) {
                *c = least;
            }
        }
    }
    component
}

#[cfg(test)]
mod tests {
    use super::components;

    #[test]
    fn groups_are_joined_by_levels_that_they_share() {
        let names = |of: &[&str]| -> Vec<String> { of.iter().map(|n| (*n).to_owned()).collect() };
        // 0 and 1 share hall; 1 and 2 share cold; 3 has a site of its own.
        let levels = names(&["hall", "hall", "cold", "cold", "roof"]);
        assert_eq!(components(4, &[0, 1, 1, 2, 3], &levels), [0, 0, 0, 3]);
        let alone = names(&["a", "b", "c"]);
        assert_eq!(components(3, &[0, 1, 2], &alone), [0, 1, 2]);
    }
}
