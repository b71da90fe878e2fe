//! The list for people, and as a table for other programs.

use super::{Outlier, OutlierList};
use crate::FleetError;
use crate::args::Outliers;
use crate::compare::CreepUnit;
use crate::compare::show::three;
use sinew_files::plain;
use sinew_log::{Cell, CellKind, Column, TableWriter};
use sinew_report::text::{paragraph, table};
use std::path::Path;

/// A small number, or that it is smaller still.
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

/// The list.
pub(super) fn text(list: &OutlierList, asked: &Outliers) -> String {
    let unit = match list.unit {
        CreepUnit::Strain => "µm/m",
        CreepUnit::Offset => "mrad",
    };
    let head = ["robot", "joint", "rope", unit, "times usual", "by chance"];
    let shown = list.outliers.iter().take(asked.rows);
    let mut out = match list.outliers.is_empty() {
        true => String::new(),
        false => table(&head, shown.map(|o| row(o, list.unit)).collect(), 3) + "\n",
    };
    if list.outliers.len() > asked.rows {
        let more = list.outliers.len() - asked.rows;
        out += &format!("… {more} more; --rows N shows more, --csv FILE writes all\n\n");
    }
    out += &paragraph(
        &format!(
            "{} of {} tendons creep unlike others of their kind. {} of them would be listed by chance on average, were all usual.",
            list.outliers.len(),
            list.tendons,
            list.expected_by_chance
        ),
        2,
    );
    out += &paragraph(
        &format!(
            "Creep is growth per decade of time from day {} to day {} of a rope, in {}. Usual is what joint, rope, temperature, \
             site and batch say. By chance: how many of all tendons would depart so far.",
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
            "{} tendons have too few sessions of these ages; --ages names others.",
            list.too_few
        );
        out += &paragraph(&few, 2);
    }
    out
}

/// Writes the list.
pub(super) fn csv(list: &OutlierList, path: &Path) -> Result<(), FleetError> {
    let creep = match list.unit {
        CreepUnit::Strain => [
            "strain_per_decade_ratio",
            "strain_per_decade_deviation_ratio",
        ],
        CreepUnit::Offset => ["offset_per_decade_rad", "offset_per_decade_deviation_rad"],
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
        let known = |text: &Option<String>| text.clone().map_or(Cell::Empty, Cell::Text);
        let mut cells = vec![
            Cell::Text(o.robot.clone()),
            Cell::Text(o.joint.clone()),
            known(&o.site),
            known(&o.fit.rope),
            known(&o.fit.batch),
        ];
        let numbers = o.creep.into_iter().chain(o.ratio).chain([o.by_chance]);
        cells.extend(numbers.map(Cell::from));
        writer.row(&cells)?;
    }
    Ok(writer.finish()?)
}
