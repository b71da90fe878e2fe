//! The comparison for people, and as a table for other programs.

use super::{Comparison, CreepUnit, Factor, Group, Verdict};
use crate::FleetError;
use crate::args::{By, Compare};
use sinew_files::plain;
use sinew_log::{Cell, CellKind, Column, TableWriter};
use sinew_report::text::{paragraph, table};
use std::path::Path;

/// A number to three digits.
pub(crate) fn three(x: f64) -> String {
    if !x.is_finite() {
        return "–".into();
    }
    let decimals = if x == 0.0 {
        0.0
    } else {
        2.0 - x.abs().log10().floor()
    };
    format!("{x:.*}", decimals.clamp(0.0, 6.0) as usize)
}

/// Formats a ratio as a relative difference, %.
fn more(ratio: f64) -> String {
    match 100.0 * (ratio - 1.0) {
        percent if !percent.is_finite() => "–".into(),
        percent if percent.abs() > 1e4 => "> 10,000".into(),
        percent if percent.abs() < 0.5 => "0".into(),
        percent => format!("{percent:+.0}").replace('-', "−"),
    }
}

/// A band of temperatures by its lower end.
pub(crate) fn band(low: &str) -> String {
    low.parse::<i64>()
        .map_or(low.into(), |low| format!("{low} to {} °C", low + 10))
}

pub(crate) fn name(group: &Group, by: By) -> String {
    match by {
        By::Temperature => band(&group.key.name),
        _ => plain(&group.key.name),
    }
}

pub(crate) fn family(group: &Group, by: By) -> Option<String> {
    let family = group.key.family.as_deref()?;
    Some(match by {
        By::RopeTemperature => band(family),
        _ => plain(family),
    })
}

pub(crate) fn verdict(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Worse => "worse",
        Verdict::Better => "better",
        Verdict::Inconclusive => "inconclusive",
        Verdict::TiedTo(_) => "tied",
        Verdict::Alone => "alone",
    }
}

fn word(factor: Factor) -> &'static str {
    match factor {
        Factor::Joint => "joint",
        Factor::Kind => "joint and rope",
        Factor::Batch => "batch",
        Factor::Site | Factor::SiteOfRope => "site",
        Factor::Robot => "robot",
        Factor::Temperature => "temperature",
    }
}

pub(crate) fn row(group: &Group, found: &Comparison) -> Vec<String> {
    let scale = scale(found.unit);
    let [creep, low, high] = group.creep.map(|c| three(scale * c));
    let [ratio, ratio_low, ratio_high] = group.ratio.map(more);
    vec![
        name(group, found.by),
        group.tendons.to_string(),
        match group.creep[0].is_nan() {
            true => "–".into(),
            false => format!("{creep} ({low} … {high})"),
        },
        match group.ratio[0].is_nan() {
            true => "–".into(),
            false => format!("{ratio} ({ratio_low} … {ratio_high})"),
        },
        verdict(&group.verdict).into(),
    ]
}

/// Unit of the creep, for messages.
pub(crate) fn unit(unit: CreepUnit) -> &'static str {
    match unit {
        CreepUnit::Strain => "µm/m per decade",
        CreepUnit::Offset => "mrad per decade",
    }
}

/// From SI to that.
pub(crate) fn scale(unit: CreepUnit) -> f64 {
    match unit {
        CreepUnit::Strain => 1e6,
        CreepUnit::Offset => 1e3,
    }
}

pub(crate) fn head(found: &Comparison) -> [&'static str; 5] {
    let what = match found.by {
        By::Rope | By::RopeTemperature => "rope",
        By::Batch => "batch",
        By::Site => "site",
        By::Temperature => "temperature",
    };
    [
        what,
        "tendons",
        unit(found.unit),
        "difference (%)",
        "verdict",
    ]
}

/// Formats the comparison as text.
pub(super) fn text(found: &Comparison, request: &Compare) -> String {
    let head = head(found);
    let mut out = String::new();
    for together in found.groups.chunk_by(|a, b| a.key.family == b.key.family) {
        if let Some(family) = together.first().and_then(|g| family(g, found.by)) {
            out += &format!("{family}\n");
        }
        out += &table(&head, together.iter().map(|g| row(g, found)).collect(), 1);
        out.push('\n');
    }
    for note in notes(found, request.least) {
        out += &paragraph(&note, 2);
    }
    out
}

/// Notes on the basis of the table, one or two sentences each.
pub(crate) fn notes(found: &Comparison, least: f64) -> Vec<String> {
    let worse = found.worse().count();
    let mut out = vec![format!(
        "{worse} of {} groups are worse: they creep more than the median of the others, by more than {:.0} %. The probability that \
         any verdict of this comparison is wrong is at most 5 %.",
        found.groups.len(),
        100.0 * least
    )];
    let unit = match found.unit {
        CreepUnit::Strain => "in µm per metre of rope",
        CreepUnit::Offset => {
            "in mrad of the joint, because a robot type has no description: set --robot DIR"
        }
    };
    out.push(format!(
        "Creep is growth per decade of time from day {} to day {} of a rope, {unit}, of a typical tendon. Tendons of a \
         group differ by a factor of {:.1} (one standard deviation).",
        found.ages.from_days, found.ages.to_days, found.tendon_factor
    ));
    let words: Vec<&str> = found.freed_of.iter().map(|f| word(*f)).collect();
    out.push(format!(
        "Differences are adjusted for: {}.",
        words.join(", ")
    ));
    if matches!(found.by, By::Temperature | By::RopeTemperature) {
        out.push("Other differences between warm and cold sites are included.".into());
    }
    for group in &found.groups {
        if let Verdict::TiedTo(ties) = &group.verdict {
            let factors: Vec<String> = (ties.iter())
                .map(|(factor, levels)| match levels.is_empty() {
                    true => format!("its {}", word(*factor)),
                    false => format!("its {} ({})", word(*factor), plain(levels)),
                })
                .collect();
            out.push(format!(
                "{} is confounded with {}: no other group shares it.",
                name(group, found.by),
                factors.join(" and ")
            ));
        }
    }
    if found.too_few > 0 {
        out.push(format!(
            "{} tendons have too few sessions at these ages; set other ages with --ages.",
            found.too_few
        ));
    }
    if found.without_group > 0 {
        out.push(format!(
            "{} tendons have no specified group.",
            found.without_group
        ));
    }
    if found.undated > 0 {
        out.push(format!(
            "{} ropes are dated by their first session, because events.csv does not contain their installation.",
            found.undated
        ));
    }
    if let Some(ratio) = found.apart {
        out.push(format!(
            "The chains have not converged (ratio {ratio:.2}); no verdicts are given. Use fewer groups or more tendons.",
        ));
    }
    out
}

/// Writes the groups.
pub(super) fn csv(found: &Comparison, path: &Path) -> Result<(), FleetError> {
    let creep = match found.unit {
        CreepUnit::Strain => [
            "strain_per_decade_ratio",
            "strain_per_decade_low_ratio",
            "strain_per_decade_high_ratio",
        ],
        CreepUnit::Offset => [
            "offset_per_decade_rad",
            "offset_per_decade_low_rad",
            "offset_per_decade_high_rad",
        ],
    };
    let counts = ["tendons", "robots"];
    let ratios = [
        "creep_ratio",
        "creep_ratio_low",
        "creep_ratio_high",
        "probability_worse",
    ];
    let of = |kind: CellKind| move |name: &str| -> Column { (name.to_owned(), kind) };
    let columns: Vec<Column> = (["within", "group", "verdict", "tied_to"].into_iter())
        .map(of(CellKind::Text))
        .chain(counts.into_iter().map(of(CellKind::Integer)))
        .chain(creep.into_iter().chain(ratios).map(of(CellKind::Number)))
        .collect();
    let mut writer = TableWriter::create(path, &columns)?;
    for group in &found.groups {
        let text = |t: Option<String>| t.map_or(Cell::Empty, Cell::Text);
        let ties = match &group.verdict {
            Verdict::TiedTo(ties) => Some(
                ties.iter()
                    .map(|(f, _)| word(*f))
                    .collect::<Vec<_>>()
                    .join("; "),
            ),
            _ => None,
        };
        let mut cells = vec![
            text(family(group, found.by)),
            text(Some(name(group, found.by))),
            text(Some(verdict(&group.verdict).replace(' ', "-"))),
            text(ties),
            Cell::Integer(group.tendons as i64),
            Cell::Integer(group.robots as i64),
        ];
        let numbers = group.creep.into_iter().chain(group.ratio);
        cells.extend(numbers.chain([group.probability_worse]).map(Cell::from));
        writer.row(&cells)?;
    }
    Ok(writer.finish()?)
}
