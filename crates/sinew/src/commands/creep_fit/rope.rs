//! The rope law: the rope it starts from, and the entry it ends in.

use super::super::creep_files::Tests;
use super::super::rope::find;
use super::{Fit, Joint};
use crate::terminal::Failure;
use sinew_creep::{FitOptions, Law, Provenance, RopeBase};
use sinew_files::date::today;
use std::path::Path;
use std::sync::Arc;

impl Fit {
    pub(super) fn base(&self) -> Result<Option<Arc<RopeBase>>, Failure> {
        let Some(name) = &self.rope else {
            if self.law.contains(&Law::Rope) {
                return Err(Failure::Refused(
                    "--law rope needs --rope NAME: a catalogue rope with the breaking load, and \
                     for what the records can't tell; sinew rope list shows them"
                        .into(),
                ));
            }
            return Ok(None);
        };
        let catalogue = self.ropes.catalogue()?;
        let base = RopeBase::new(find(&catalogue, name)?.entry.clone())?;
        Ok(Some(Arc::new(base)))
    }

    /// The fitted rope's entry, where one was asked for.
    pub(super) fn entry(
        &self,
        fits: &[(String, Vec<sinew_creep::Fit>)],
        options: &FitOptions,
        tests: &Tests,
    ) -> Result<Option<String>, Failure> {
        let (Some(path), Some(base)) = (&self.write_rope, &options.rope) else {
            return Ok(None);
        };
        let refuse = |why: String| Failure::Refused(format!("--write-rope: {why}"));
        if self.joint == Joint::Shape {
            return Err(refuse("one rope needs one amplitude: --joint group".into()));
        }
        let [(_, fits)] = fits else {
            return Err(refuse(format!(
                "one file for one rope, but {} were fitted; --joint group fits specimens together",
                fits.len()
            )));
        };
        let fit = fits.iter().find(|f| f.law == Law::Rope);
        let fit = fit.ok_or_else(|| refuse("the rope law was not fitted".into()))?;
        let data: Vec<String> = tests
            .sources
            .iter()
            .map(|s| format!("{} (SHA-256 {})", s.file, s.sha256))
            .collect();
        let from = Provenance {
            name: rope_name(path).map_err(refuse)?,
            data: data.join(", "),
            date: today(),
        };
        let entry = sinew_creep::rope_entry(fit, base, &from)?.to_toml();
        // A folder of one's own ropes begins with the first.
        if let Some(folder) = path.parent() {
            let made = std::fs::create_dir_all(folder);
            made.map_err(|e| refuse(format!("can't make folder {}: {e}", folder.display())))?;
        }
        Ok(Some(entry))
    }
}

/// The file's name without its end.
fn rope_name(path: &Path) -> Result<String, String> {
    let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or("");
    let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let toml = path.extension().is_some_and(|e| e == "toml");
    if !toml || stem.is_empty() || !stem.chars().all(good) {
        return Err(format!(
            "{}: the file's name becomes the rope's: lower case letters, digits and -, then .toml",
            path.display()
        ));
    }
    Ok(stem.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rope_is_named_after_its_file() {
        assert_eq!(
            rope_name(Path::new("a/my-rope-2.toml")).unwrap(),
            "my-rope-2"
        );
        for bad in ["My rope.toml", "rope.txt", ".toml", "rope"] {
            assert!(rope_name(Path::new(bad)).is_err(), "{bad}");
        }
    }
}
