//! A coupling matrix as a table: joints in the header, a motor and its ratios in each row.

use super::{MappedTendon, Relation};
use sinew_files::csv::Table;
use sinew_files::{Budget, Fault, Located};

pub(super) fn read(text: &str, file: &str) -> Result<Vec<MappedTendon>, Located> {
    let table = Table::parse(text, file)?;
    let joints = table.headers().get(1..).unwrap_or_default();
    let fault = |fault, problem: String| {
        let located = Located::new(file, fault, problem);
        located
            .cure("expected a header 'motor,JOINT,JOINT…', then a motor and its ratios in each row")
    };
    if joints.is_empty() || joints.iter().any(String::is_empty) {
        let problem = "the header must name at least one joint, and every column".to_owned();
        return Err(fault(Fault::Syntax, problem));
    }
    if let Err(problem) = Budget::DESCRIPTION.columns.check(joints.len() as u64) {
        return Err(fault(Fault::TooLarge, problem));
    }
    let mut tendons = Vec::new();
    for row in table.rows() {
        let motor = row.text_at(0);
        if motor.is_empty() {
            return Err(row.here(Fault::MissingKey, "the first cell must name the motor"));
        }
        let mut ratios = Vec::new();
        for (column, joint) in joints.iter().enumerate() {
            let ratio = row.number_at(column + 1)?.unwrap_or(0.0);
            if ratio != 0.0 {
                ratios.push((joint.clone(), ratio));
            }
        }
        tendons.push(MappedTendon {
            name: motor.to_owned(),
            line: row.line(),
            relation: Relation::Ratios {
                motor: motor.to_owned(),
                ratios,
                motor_at_zero_rad: 0.0,
            },
        });
    }
    match tendons.is_empty() {
        false => Ok(tendons),
        true => Err(fault(Fault::MissingKey, "has no motor".to_owned())),
    }
}
