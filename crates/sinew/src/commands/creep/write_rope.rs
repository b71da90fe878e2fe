//! Name of a fitted rope.

use std::path::Path;

/// Returns the rope name, which is the file name without extension.
pub(super) fn rope_name(path: &Path) -> Result<String, String> {
    let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or("");
    let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let toml = path.extension().is_some_and(|e| e == "toml");
    if !toml || stem.is_empty() || !stem.chars().all(good) {
        return Err(format!(
            "{}: invalid rope name; expected lower case letters, digits and -, with extension .toml",
            path.display()
        ));
    }
    Ok(stem.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rope_name_is_file_stem() {
        assert_eq!(
            rope_name(Path::new("a/my-rope-2.toml")).unwrap(),
            "my-rope-2"
        );
        for bad in ["My rope.toml", "rope.txt", ".toml", "rope"] {
            assert!(rope_name(Path::new(bad)).is_err(), "{bad}");
        }
    }
}
