//! SQL functions of Sinew: a tendon's elongation, its trend, and the days until its limit.
//!
//! | function | of | gives |
//! |---|---|---|
//! | `sinew_elongation_mm(offset_rad, robot_type, joint)` | a row | mm |
//! | `sinew_trend(*)` | a tendon's records | offset, creep, elongation, steps, verdict |
//! | `sinew_days_until(*)`, `sinew_days_until(limit_mm, *)` | a tendon's records | days until a limit |
//!
//! `*` and `table.*` stand for the columns of a record ([`write_out`]). Types, ropes and events are read when the first
//! of these functions is used; other queries do not need them ([`Lazy`]).

mod elongation;
mod trend;

use crate::FleetError;
use crate::metadata::FleetMetadata;
use datafusion::error::DataFusionError;
use datafusion::logical_expr::{AggregateUDF, ScalarUDF};
use datafusion::prelude::SessionContext;
use datafusion::sql::parser::Statement;
use datafusion::sql::sqlparser::ast::{
    Expr, Function, FunctionArg, FunctionArgExpr, FunctionArguments, Ident, Value,
    visit_expressions, visit_expressions_mut,
};
use elongation::Elongation;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use trend::{COLUMNS, Kind, OfTendon};

/// Fleet metadata, read on first use.
pub(super) struct Lazy {
    folder: PathBuf,
    described: Vec<PathBuf>,
    read: Mutex<Option<Arc<FleetMetadata>>>,
}

impl Lazy {
    fn get(&self) -> Result<Arc<FleetMetadata>, DataFusionError> {
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(metadata) = &*read {
            return Ok(metadata.clone());
        }
        let metadata = FleetMetadata::read(&self.folder, &self.described).map(Arc::new);
        let metadata = metadata.map_err(external)?;
        *read = Some(metadata.clone());
        Ok(metadata)
    }
}

impl std::fmt::Debug for Lazy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Lazy")
    }
}

/// Wraps an error of this crate for the engine.
fn external(error: FleetError) -> DataFusionError {
    DataFusionError::External(Box::new(error))
}

/// Registers the functions.
pub(crate) fn register(context: &SessionContext, folder: &Path, described: &[PathBuf]) {
    let lazy = Arc::new(Lazy {
        folder: folder.into(),
        described: described.to_vec(),
        read: Mutex::new(None),
    });
    context.register_udf(ScalarUDF::from(Elongation::new(lazy.clone())));
    for kind in Kind::ALL {
        context.register_udaf(AggregateUDF::from(OfTendon::new(kind, lazy.clone())));
    }
}

/// Writes `sinew_trend(*)` out as `sinew_trend(robot, joint, …)`, `sinew_trend(r.*)` as `sinew_trend(r.robot, …)`.
pub(crate) fn write_out(statement: &mut Statement) -> Result<(), DataFusionError> {
    let Statement::Statement(statement) = statement else {
        return Ok(());
    };
    let done = visit_expressions_mut(statement.as_mut(), |expression| {
        let Expr::Function(function) = expression else {
            return ControlFlow::Continue(());
        };
        match write_out_call(function) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => ControlFlow::Break(error),
        }
    });
    match done {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(error) => Err(external(error)),
    }
}

/// Functions of one argument whose argument is a column: their names, and its.
pub(crate) fn calls_of_columns(statement: &Statement) -> Vec<(String, String)> {
    let mut out = Vec::new();
    if let Statement::Statement(statement) = statement {
        let _ = visit_expressions(statement.as_ref(), |expression| {
            if let Expr::Function(function) = expression {
                out.extend(call_of_column(function));
            }
            ControlFlow::<()>::Continue(())
        });
    }
    out
}

fn call_of_column(function: &Function) -> Option<(String, String)> {
    let FunctionArguments::List(list) = &function.args else {
        return None;
    };
    let [FunctionArg::Unnamed(FunctionArgExpr::Expr(argument))] = &list.args[..] else {
        return None;
    };
    let column = match argument {
        Expr::Identifier(column) => column,
        Expr::CompoundIdentifier(parts) => parts.last()?,
        _ => return None,
    };
    Some((
        function.name.to_string().to_lowercase(),
        column.value.clone(),
    ))
}

fn write_out_call(function: &mut Function) -> Result<(), FleetError> {
    let name = function.name.to_string().to_lowercase();
    let Some(kind) = Kind::ALL.into_iter().find(|kind| kind.name() == name) else {
        return Ok(());
    };
    let usage = || FleetError::Usage {
        function: kind.name(),
        usage: kind.usage(),
    };
    let FunctionArguments::List(list) = &mut function.args else {
        return Err(usage());
    };
    let (star, before) = list.args.split_last().ok_or_else(usage)?;
    let table: Vec<Ident> = match star {
        FunctionArg::Unnamed(FunctionArgExpr::Wildcard) => Vec::new(),
        FunctionArg::Unnamed(FunctionArgExpr::QualifiedWildcard(table)) => {
            let parts = table.0.iter();
            parts.filter_map(|p| p.as_ident().cloned()).collect()
        }
        _ => return Err(usage()),
    };
    let mut args = before.to_vec();
    match (kind, args.len()) {
        (Kind::Trend, 0) | (Kind::DaysUntil, 1) => {}
        (Kind::DaysUntil, 0) => args.push(argument(Expr::value(Value::Null))),
        _ => return Err(usage()),
    }
    for column in COLUMNS {
        let mut parts = table.clone();
        parts.push(Ident::new(column));
        args.push(argument(match parts.len() {
            1 => Expr::Identifier(Ident::new(column)),
            _ => Expr::CompoundIdentifier(parts),
        }));
    }
    list.args = args;
    Ok(())
}

fn argument(expression: Expr) -> FunctionArg {
    FunctionArg::Unnamed(FunctionArgExpr::Expr(expression))
}
