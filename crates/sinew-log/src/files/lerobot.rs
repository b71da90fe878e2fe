//! Metadata of a LeRobot data set, in addition to its tables.

use std::collections::HashMap;
use std::path::Path;

use serde_json::Value;

/// Metadata file of a data set, relative to its folder.
pub(super) const INFO: &str = "meta/info.json";
/// Maximum number of folders between a table and its data set.
const DEPTH: usize = 3;

/// Names of a list's elements, by column.
pub(super) type ListNames = HashMap<String, Vec<String>>;

/// Names of list elements by the data set of `table`; empty if it is part of none.
pub(super) fn list_names(table: &Path) -> ListNames {
    let folders = table.ancestors().skip(1).take(DEPTH);
    let info = folders
        .map(|folder| folder.join(INFO))
        .find(|info| info.is_file());
    let text =
        info.and_then(|info| sinew_files::read_text(&info, &sinew_files::Budget::DESCRIPTION).ok());
    let info: Value = text.map_or(Value::Null, |t| {
        serde_json::from_str(&t).unwrap_or_default()
    });
    let features = info.get("features").and_then(Value::as_object);
    let names = features
        .into_iter()
        .flatten()
        .filter_map(|(column, feature)| {
            let names = feature.get("names")?;
            // A list, or under a word such as "motors".
            let list = names
                .as_array()
                .or_else(|| names.as_object()?.values().next()?.as_array())?;
            let list: Option<Vec<String>> =
                list.iter().map(|n| Some(n.as_str()?.to_owned())).collect();
            Some((column.clone(), list?))
        });
    names.collect()
}
