//! Side tables: ropes, sites and maintenance events of the tendons.

use super::side;
use crate::FleetError;
use sinew_files::csv::Table;
use sinew_files::date::parse_utc_s;
use sinew_files::{Budget, Fault};
use sinew_trend::Stated;
use std::collections::BTreeMap;
use std::path::Path;

/// Robot and joint of a tendon.
pub type Tendon = (String, String);

/// Rope and batch of a tendon, if specified in `tendons.csv`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Fitted {
    /// Name of the rope in the catalogue.
    pub rope: Option<String>,
    /// Production batch of the rope.
    pub batch: Option<String>,
}

/// Reads `tendons.csv`: robot, joint, rope, batch.
///
/// # Errors
/// Returns the location of the invalid value.
pub fn fitted(folder: &Path) -> Result<BTreeMap<Tendon, Fitted>, FleetError> {
    let mut out = BTreeMap::new();
    let Some(path) = side(folder, "tendons") else {
        return Ok(out);
    };
    let table = Table::read(&path, &Budget::TABLE)?;
    table.need(&["robot", "joint"])?;
    for row in table.rows() {
        let key = (
            row.need_text("robot")?.to_owned(),
            row.need_text("joint")?.to_owned(),
        );
        let text = |column| row.text(column).map(str::to_owned);
        let fitted = Fitted {
            rope: text("rope"),
            batch: text("batch"),
        };
        if out.insert(key, fitted).is_some() {
            let problem = "duplicate row of this tendon; one rope at a time";
            return Err(row
                .here(Fault::NotAllowed, problem)
                .cure("keep the present one")
                .into());
        }
    }
    Ok(out)
}

/// Site of each robot that `robots.csv` names one for.
///
/// # Errors
/// Returns the location of the invalid value.
pub fn sites(folder: &Path) -> Result<BTreeMap<String, String>, FleetError> {
    let Some(path) = side(folder, "robots") else {
        return Ok(BTreeMap::new());
    };
    let table = Table::read(&path, &Budget::TABLE)?;
    table.need(&["robot"])?;
    let mut out = BTreeMap::new();
    for row in table.rows() {
        if let Some(site) = row.text("site") {
            out.insert(row.need_text("robot")?.to_owned(), site.to_owned());
        }
    }
    Ok(out)
}

/// Reads `events.csv`: robot, joint, time_utc_s, event (`tensioned`, `replaced`, `broken` or `installed`).
///
/// # Errors
/// Returns the location of the invalid value.
pub fn events(folder: &Path) -> Result<BTreeMap<Tendon, Vec<Stated>>, FleetError> {
    let mut out: BTreeMap<Tendon, Vec<Stated>> = BTreeMap::new();
    let Some(path) = side(folder, "events") else {
        return Ok(out);
    };
    let table = Table::read(&path, &Budget::TABLE)?;
    table.need(&["robot", "joint", "time_utc_s", "event"])?;
    for row in table.rows() {
        let key = (
            row.need_text("robot")?.to_owned(),
            row.need_text("joint")?.to_owned(),
        );
        let wrong = |column: &str, problem: &str| {
            row.here(Fault::NotAllowed, problem.to_owned())
                .column(column)
        };
        let time_utc_s = parse_utc_s(row.need_text("time_utc_s")?).ok_or_else(|| {
            wrong(
                "time_utc_s",
                "is no date; write 2026-03-01 or seconds since 1970",
            )
        })?;
        let replaced = match row.need_text("event")? {
            "tensioned" => false,
            // After a break a rope is put in, and none replaced: until then `sinew trend survival` counts none.
            "replaced" | "installed" => true,
            // A broken rope matters to `sinew trend survival` only; here the trend begins again with its replacement.
            "broken" => continue,
            _ => {
                return Err(
                    wrong("event", "must be tensioned, replaced, broken or installed").into(),
                );
            }
        };
        let joint = Some(key.1.clone());
        out.entry(key).or_default().push(Stated {
            joint,
            time_utc_s,
            replaced,
        });
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_broken_rope_is_ignored_unknown_is_invalid() {
        let folder = tempfile::tempdir().unwrap();
        let write = |last: &str| {
            let rows = format!(
                "robot,joint,time_utc_s,event\na,elbow,2026-03-01,tensioned\na,elbow,2026-04-01,broken\na,elbow,2026-04-02,{last}\n"
            );
            std::fs::write(folder.path().join("events.csv"), rows).unwrap();
        };
        write("replaced");
        let read = events(folder.path()).unwrap();
        let stated: Vec<bool> = read.values().flatten().map(|s| s.replaced).collect();
        assert_eq!(stated, [false, true]);
        write("installed");
        assert_eq!(events(folder.path()).unwrap(), read);
        write("snapped");
        let error = events(folder.path()).unwrap_err().to_string();
        assert!(
            error.contains("tensioned, replaced, broken or installed"),
            "{error}"
        );
    }
}
