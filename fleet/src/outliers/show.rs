//! Output of `outliers`: text and table.

use super::{Outlier, OutlierList};
use crate::FleetError;
use crate::args::Outliers;
use crate::compare::CreepUnit;
use crate::compare::show::three;
use sinew_files::plain;
use sinew_log::{Cell, CellKind, Column, TableWriter};
use sinew_report::text::{paragraph, table};
use std::path::Path;

/// Formats an expected number, with `< 0.0001` as the smallest.
fn chance(by_chance: f64) -> String {
    match by_chance {
        x if x < 1e-4 => "< 0.0001".into(),
        x => format!("{x:.*}", (1.0 - x.log10().floor()).clamp(0.0, 4.0) as usize),
    }
}

fn row(outlier: &Outlier, unit: CreepUnit) -> Vec<String> {
    let scale = match unit {
        CreepUnit::Strain => 1e6,
        CreepUnit::Offset => 1e3,
    };
    let two = |x: f64| {
        let text = match x.abs() {
            size if size < 1.0 => format!("{x:.2}"),
            size if size < 10.0 => format!("{x:.1}"),
            _ => format!("{x:.0}"),
        };
        text.replace('-', "−")
    };
    let [ratio, low, high] = outlier.ratio.map(two);
    vec![
        plain(&outlier.robot),
        plain(&outlier.joint),
        plain(outlier.fit.rope.as_deref().unwrap_or("–")),
        three(scale * outlier.creep[0]).replace('-', "−"),
        format!("{ratio} ({low} … {high})"),
        chance(outlier.by_chance),
    ]
}

/// Formats the list as text.
pub(super) fn text(list: &OutlierList, request: &Outliers) -> String {
    let unit = match list.unit {
        CreepUnit::Strain => "µm/m",
        CreepUnit::Offset => "mrad",
    };
    let head = [
        "robot",
        "joint",
        "rope",
        unit,
        "ratio to usual",
        "expected by chance",
    ];
    let shown = list.outliers.iter().take(request.rows);
    let mut out = match list.outliers.is_empty() {
        true => String::new(),
        false => table(&head, shown.map(|o| row(o, list.unit)).collect(), 3) + "\n",
    };
    if list.outliers.len() > request.rows {
        let more = list.outliers.len() - request.rows;
        out += &format!("… {more} more; --rows N shows more, --csv FILE writes all\n\n");
    }
    out += &paragraph(
        &format!(
            "{} of {} tendons deviate from the creep of their kind. Expected number listed by chance: {}.",
            list.outliers.len(),
            list.tendons,
            list.expected_by_chance
        ),
        2,
    );
    out += &paragraph(
        &format!(
            "Creep is growth per decade of time from day {} to day {} of a rope, in {}. The usual creep depends on joint, rope, temperature, \
             site and batch. By chance: expected number of all tendons with such a deviation.",
            list.ages.from_days,
            list.ages.to_days,
            match list.unit {
                CreepUnit::Strain => "µm per metre of rope",
                CreepUnit::Offset => "mrad of the joint",
            }
        ),
        2,
    );
    if list.too_few > 0 {
        let few = format!(
            "{} tendons have too few sessions at these ages; set other ages with --ages.",
            list.too_few
        );
        out += &paragraph(&few, 2);
    }
    out
}

/// Writes the list.
pub(super) fn csv(list: &OutlierList, path: &Path) -> Result<(), FleetError> {
    let creep = match list.unit {
        CreepUnit::Strain => ["strain_per_decade_ratio", "strain_per_decade_std_ratio"],
        CreepUnit::Offset => ["offset_per_decade_rad", "offset_per_decade_std_rad"],
    };
    let texts = ["robot", "joint", "site", "rope", "batch"];
    let ratios = [
        "creep_ratio",
        "creep_ratio_low",
        "creep_ratio_high",
        "expected_by_chance",
    ];
    let of = |kind: CellKind| move |name: &str| -> Column { (name.to_owned(), kind) };
    let columns: Vec<Column> = (texts.into_iter().map(of(CellKind::Text)))
        .chain(creep.into_iter().chain(ratios).map(of(CellKind::Number)))
        .collect();
    let mut writer = TableWriter::create(path, &columns)?;
    for o in &list.outliers {
        let maybe = |text: &Option<String>| text.clone().map_or(Cell::Empty, Cell::Text);
        let mut cells = vec![
            Cell::Text(o.robot.clone()),
            Cell::Text(o.joint.clone()),
            maybe(&o.site),
            maybe(&o.fit.rope),
            maybe(&o.fit.batch),
        ];
        let numbers = o.creep.into_iter().chain(o.ratio).chain([o.by_chance]);
        cells.extend(numbers.map(Cell::from));
        writer.row(&cells)?;
    }
    Ok(writer.finish()?)
}
