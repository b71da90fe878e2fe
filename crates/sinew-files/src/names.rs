//! Names: suggestions for misspelt names, lists of existing names, and their order.

/// Maximum number of names compared, and maximum characters of each: they may come from a damaged
/// file.
const NAMES: usize = 1024;
const CHARACTERS: usize = 128;
/// Maximum number of names listed in a message.
const LISTED: usize = 24;

/// Returns the existing name nearest to `wanted` if it is close enough to be a misspelling.
///
/// Distance: characters inserted, removed or replaced (Levenshtein), ignoring case; at most a third
/// of the name, or two.
pub fn nearest<'a, S: AsRef<str>>(wanted: &str, names: &'a [S]) -> Option<&'a str> {
    let plain = |name: &str| -> String {
        let head = name.chars().take(CHARACTERS);
        head.flat_map(char::to_lowercase).collect()
    };
    let limit = (wanted.chars().count() / 3).max(2);
    let wanted = plain(wanted);
    names
        .iter()
        .take(NAMES)
        .map(|name| {
            let name = name.as_ref();
            (strsim::levenshtein(&wanted, &plain(name)), name)
        })
        .filter(|(distance, _)| *distance <= limit)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// Returns `; did you mean 'elbow'?`, or only the semicolon: the text between a missing name and
/// the list of existing names.
pub fn hint<S: AsRef<str>>(wanted: &str, names: &[S]) -> String {
    match did_you_mean(wanted, names) {
        hint if hint.is_empty() => ";".to_owned(),
        hint => hint,
    }
}

/// Returns `; did you mean 'elbow'?`, or an empty text: the end of a message about a missing name.
pub fn did_you_mean<S: AsRef<str>>(wanted: &str, names: &[S]) -> String {
    let meant = nearest(wanted, names);
    meant.map_or(String::new(), |name| format!("; did you mean '{name}'?"))
}

/// Names in quotes, cut where they would flood the terminal.
pub fn list<S: AsRef<str>>(names: &[S]) -> String {
    let shown: Vec<String> = names
        .iter()
        .take(LISTED)
        .map(|name| format!("'{}'", shorten(name.as_ref(), 80)))
        .collect();
    match names.len() {
        0 => "none".to_owned(),
        n if n > LISTED => format!("{} and {} more", shown.join(", "), n - LISTED),
        _ => shown.join(", "),
    }
}

/// Returns at most `limit` characters of a text from a file.
pub fn shorten(text: &str, limit: usize) -> String {
    if text.chars().count() <= limit {
        return text.to_owned();
    }
    let mut short: String = text.chars().take(limit).collect();
    short.push('…');
    short
}

/// Returns a sort key that places `run_9` before `run_10`.
pub fn natural_key(name: &str) -> Vec<(u64, String)> {
    let mut key = vec![(0_u64, String::new())];
    for c in name.chars() {
        let digit = c.to_digit(10).map(u64::from);
        let fresh = key.last().is_some_and(|(_, text)| !text.is_empty());
        if digit.is_some() && fresh {
            key.push((0, String::new()));
        }
        if let Some((number, text)) = key.last_mut() {
            match digit {
                Some(digit) => *number = number.saturating_mul(10).saturating_add(digit),
                None => text.push(c),
            }
        }
    }
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_count_upwards() {
        let mut names = ["b_1", "a_10", "a_9", "a_10b", "a"];
        names.sort_by_key(|name| natural_key(name));
        assert_eq!(names, ["a", "a_9", "a_10", "a_10b", "b_1"]);
    }

    #[test]
    fn nearest_misspelling_matches_other_name_does_not() {
        let known = ["shoulder_pitch", "elbow", "wrist"];
        assert_eq!(nearest("elbwo", &known), Some("elbow"));
        assert_eq!(nearest("elbo", &known), Some("elbow"));
        assert_eq!(nearest("sholder_pitch", &known), Some("shoulder_pitch"));
        assert_eq!(nearest("Shoulder-pitch", &known), Some("shoulder_pitch"));
        assert_eq!(nearest("gripper", &known), None);
    }
}
