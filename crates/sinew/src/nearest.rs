//! The name somebody may have meant.

/// The known name nearest to `word`, if it is near.
pub(crate) fn nearest<'a>(word: &str, known: &'a [String]) -> Option<&'a str> {
    let near = |name: &&'a str| distance(word, name) <= 1 + word.chars().count() / 3;
    known
        .iter()
        .map(String::as_str)
        .filter(near)
        .min_by_key(|name| distance(word, name))
}

/// How many letters must be put in, taken out or changed (Levenshtein), ignoring case.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.to_lowercase().chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let changed = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(row[j + 1] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_finger_is_found_and_a_stranger_is_not() {
        let known = ["shoulder_pitch", "elbow"].map(String::from);
        assert_eq!(nearest("elbo", &known), Some("elbow"));
        assert_eq!(nearest("Shoulder-pitch", &known), Some("shoulder_pitch"));
        assert_eq!(nearest("gripper", &known), None);
        assert_eq!(distance("kitten", "sitting"), 3);
    }
}
