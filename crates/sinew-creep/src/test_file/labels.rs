//! Columns of several specimens next to each other: `elongation A [mm]`, `elongation B [mm]`.

use super::TestQuantity::{self, Elongation, Modulus, Strain};
use super::names::{SPECIMEN_WORDS, split};
use super::role::Role;

/// Quantities of which each specimen has its own column.
pub(super) const MEASURED: [TestQuantity; 3] = [Elongation, Strain, Modulus];

/// Labels of columns whose names differ by one label, in the order of the names; `None` for names that differ
/// otherwise, such as those of two gauges on one specimen.
pub(super) fn labels(names: &[String]) -> Option<Vec<String>> {
    let (_, labels) = parts(names)?;
    labels
        .iter()
        .all(|label| is_letter(label) || label.contains(|c: char| c.is_ascii_digit()))
        .then_some(labels)
}

/// Labels as [`labels`], of names that contain no word but those of a specimen: `A`, `B` or `rope 1`, `rope 2`.
pub(super) fn labels_alone(names: &[String]) -> Option<Vec<String>> {
    let (common, labels) = parts(names)?;
    let is_specimen = |word: &String| SPECIMEN_WORDS.contains(&word.as_str());
    let is_number = |label: &String| label.bytes().all(|b| b.is_ascii_digit());
    let is_counted = |label: &String| {
        let word = label.trim_end_matches(|c: char| c.is_ascii_digit());
        word.len() < label.len() && SPECIMEN_WORDS.contains(&word.to_lowercase().as_str())
    };
    let mut letters: Vec<char> = labels.iter().filter_map(|l| l.chars().next()).collect();
    letters.sort_unstable();
    // Letters in sequence count specimens; others are symbols, such as those of a length and a diameter.
    let is_sequence = labels.iter().all(|label| is_letter(label))
        && letters
            .windows(2)
            .all(|pair| u32::from(pair[1]) == u32::from(pair[0]) + 1);
    let is_label = is_sequence || labels.iter().all(is_number) || labels.iter().all(is_counted);
    (common.iter().all(is_specimen) && is_label).then_some(labels)
}

/// Words that all names share, and the single word by which each differs from all others.
fn parts(names: &[String]) -> Option<(Vec<String>, Vec<String>)> {
    let words_of = |name: &String| -> Vec<String> {
        let words = name.split(|c: char| !c.is_alphanumeric());
        words.filter(|w| !w.is_empty()).map(str::to_owned).collect()
    };
    let names: Vec<Vec<String>> = names.iter().map(words_of).collect();
    let holds = |words: &[String], word: &str| words.iter().any(|w| w.eq_ignore_ascii_case(word));
    let is_common = |word: &String| names.iter().all(|words| holds(words, word));
    let mut labels: Vec<String> = Vec::new();
    for words in &names {
        let mut rest = words.iter().filter(|word| !is_common(word));
        let (Some(label), None) = (rest.next(), rest.next()) else {
            return None;
        };
        if labels.iter().any(|other| other.eq_ignore_ascii_case(label)) {
            return None;
        }
        labels.push(label.clone());
    }
    let common = names.first()?.iter().filter(|word| is_common(word));
    let common = common.map(|word| word.to_lowercase()).collect();
    Some((common, labels))
}

/// Whether a label is a letter that names no axis.
fn is_letter(label: &str) -> bool {
    let mut letters = label.chars();
    matches!((letters.next(), letters.next()), (Some(c), None)
        if c.is_alphabetic() && !"xyz".contains(c.to_ascii_lowercase()))
}

/// Assigns columns of a quantity that has one already to specimens; returns those that have no specimen.
pub(super) fn assign(
    roles: &mut Vec<Role>,
    mut others: Vec<Role>,
    headers: &[String],
) -> Vec<Role> {
    let name = |role: &Role| split(&headers[role.index]).0;
    let mut held: Option<Vec<String>> = specimens_of(roles).into_iter().collect();
    // Measured quantities first: they determine the specimens.
    let mut order = TestQuantity::ALL.to_vec();
    order.sort_by_key(|quantity| !MEASURED.contains(quantity));
    for quantity in order {
        let of = |role: &&Role| role.quantity == quantity;
        let names: Vec<String> = roles.iter().chain(&others).filter(of).map(name).collect();
        if names.len() < 2 || !others.iter().any(|role| role.quantity == quantity) {
            continue;
        }
        let Some(found) = labels(&names) else {
            continue;
        };
        let is_held = |label: &String| {
            let held = held.as_deref().unwrap_or_default();
            held.iter().any(|other| other.eq_ignore_ascii_case(label))
        };
        if !(found.iter().all(is_held) || held.is_none() && MEASURED.contains(&quantity)) {
            continue;
        }
        let (more, rest) = others.into_iter().partition(|r| r.quantity == quantity);
        others = rest;
        roles.extend::<Vec<Role>>(more);
        label(roles, quantity, &found);
        held.get_or_insert(found);
    }
    others
}

/// Labels the columns of a quantity, in their order.
pub(super) fn label(roles: &mut [Role], quantity: TestQuantity, labels: &[String]) {
    let of = roles.iter_mut().filter(|role| role.quantity == quantity);
    for (role, label) in of.zip(labels) {
        role.label = Some(label.clone());
    }
}

/// Removes measured quantities without a specimen where another one belongs to specimens, and notes how specimens are
/// selected; does nothing for columns of one specimen.
pub(super) fn leave_shared(roles: &mut Vec<Role>, headers: &[String], notes: &mut Vec<String>) {
    if roles.iter().all(|role| role.label.is_none()) {
        return;
    }
    let is_measured = |role: &Role| MEASURED.contains(&role.quantity);
    roles.retain(|role| {
        let is_shared = is_measured(role) && role.label.is_none();
        if is_shared {
            notes.push(format!(
                "column '{}' is not used: other columns belong to one specimen each",
                headers[role.index]
            ));
        }
        !is_shared
    });
    let columns: Vec<String> = roles
        .iter()
        .filter(|role| is_measured(role))
        .map(|role| format!("'{}'", headers[role.index]))
        .collect();
    if let Some(first) = roles.iter().find(|role| is_measured(role)) {
        notes.push(format!(
            "columns {} belong to one specimen each; select one with --column {}={}:{}",
            columns.join(", "),
            first.quantity.name(),
            headers[first.index],
            first.unit_name
        ));
    }
}

/// Labels of the specimens, in the order of their columns; a single `None` for columns of one specimen.
pub(super) fn specimens_of(roles: &[Role]) -> Vec<Option<String>> {
    let measured = roles
        .iter()
        .filter(|role| MEASURED.contains(&role.quantity));
    let mut labels: Vec<Option<String>> = Vec::new();
    for label in measured.filter_map(|role| role.label.clone()) {
        let is_same =
            |l: &Option<String>| l.as_ref().is_some_and(|l| l.eq_ignore_ascii_case(&label));
        if !labels.iter().any(is_same) {
            labels.push(Some(label));
        }
    }
    if labels.is_empty() {
        labels.push(None);
    }
    labels
}

/// Columns of one specimen, with the columns that all share.
pub(super) fn of_specimen(roles: &[Role], label: Option<&str>) -> Vec<Role> {
    let is_of = |role: &&Role| match (&role.label, label) {
        (Some(own), Some(label)) => own.eq_ignore_ascii_case(label),
        (own, _) => own.is_none(),
    };
    roles.iter().filter(is_of).cloned().collect()
}
