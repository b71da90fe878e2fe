//! Rope catalogue: ropes that ship with the program, and those of user folders.

use crate::law::entry::CatalogueEntry;
use crate::law::tested_range::TestedRange;
use sinew_files::{Budget, Fault, Located, read_text};
use std::path::{Path, PathBuf};

/// Shipped ropes: file and text of each.
macro_rules! shipped {
    ($($name:literal),+ $(,)?) => {
        [$((
            concat!($name, ".toml"),
            include_str!(concat!("../ropes/", $name, ".toml")),
        )),+]
    };
}

/// The ropes of the paper's Table I, in its order.
const PAPER: [(&str, &str); 9] = shipped![
    "gottifredi-maffioli-sk99-ultra",
    "liros-aramid-braided-cord",
    "liros-dc000-0301",
    "liros-dc000-0701",
    "ockert-climax-combat",
    "teufelberger-fl-32-ng",
    "teufelberger-fl-9-ng",
    "tu-chemnitz-technora-black",
    "tu-chemnitz-vectran",
];

/// Further ropes that ship with the program: thin lines for hands, and metal cables for comparison.
const SHIPPED_EXTRA: [(&str, &str); 6] = shipped![
    "tasline-pe5",
    "tasline-pe8",
    "dyneema-braid-0-9",
    "stainless-7x7-1-0",
    "stainless-7x7-1-6",
    "tungsten-8x19-0-46",
];

/// A rope and the file it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct CatalogueRope {
    /// Entry of the rope: published values and creep law.
    pub entry: CatalogueEntry,
    /// File of the entry; `None` for a rope that ships with the program.
    pub file: Option<PathBuf>,
}

impl CatalogueRope {
    /// Tested range of the rope; [`TestedRange::UNSPECIFIED`] if the entry specifies none.
    pub fn tested_range(&self) -> TestedRange {
        self.entry.tested_range.unwrap_or(TestedRange::UNSPECIFIED)
    }

    /// Published diameter of the rope, m.
    pub fn diameter_m(&self) -> Option<f64> {
        self.entry.diameter_mm.as_ref().map(|d| 1e-3 * d.value)
    }
}

/// Ropes by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Catalogue {
    ropes: Vec<CatalogueRope>,
    namesakes: Vec<Namesake>,
    unreadable: Vec<UnreadableRope>,
}

/// File of a user folder that contains no valid entry, or names its rope as another file of the folder.
#[derive(Debug, Clone, PartialEq)]
pub struct UnreadableRope {
    /// Name of the rope, by its file if the entry is invalid.
    pub name: String,
    /// Error with its location.
    pub error: Located,
}

/// User file that gives its rope the name of an earlier rope.
#[derive(Debug, Clone, PartialEq)]
pub struct Namesake {
    /// Name that both ropes have.
    pub name: String,
    /// File of the later rope.
    pub file: PathBuf,
    /// Whether the ropes differ; the later one then replaces the earlier one.
    pub replaces: bool,
}

/// Error of a rope catalogue.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CatalogueError {
    /// Folder that cannot be read, or invalid entry with its location.
    #[error(transparent)]
    File(#[from] Located),
    /// Two files of one folder name the same rope.
    #[error("{first} and {second} both name their rope '{name}'; rename one", first = first.display(), second = second.display())]
    Twice {
        /// Name of the rope.
        name: String,
        /// File that was read first.
        first: PathBuf,
        /// File that was read second.
        second: PathBuf,
    },
    /// Rope that is not in the catalogue.
    #[error("no rope '{name}' in the catalogue; it has {available}")]
    Unknown {
        /// Requested name of a rope.
        name: String,
        /// Names in the catalogue.
        available: String,
    },
    /// Rope whose creep law is incomplete.
    #[error("rope '{name}' has no complete law; missing in its [law]: {missing}")]
    NoLaw {
        /// Name of the rope.
        name: String,
        /// Missing parameters of its `[law]`.
        missing: String,
    },
}

impl UnreadableRope {
    /// The file of an error; an error without a file is returned.
    fn of(error: CatalogueError) -> Result<Self, CatalogueError> {
        match error {
            CatalogueError::File(error) => {
                let stem = Path::new(&error.file).file_stem();
                Ok(Self {
                    name: stem.map_or_else(String::new, |s| s.to_string_lossy().into_owned()),
                    error,
                })
            }
            CatalogueError::Twice {
                name,
                first,
                second,
            } => {
                let problem = format!("names its rope '{name}', as {} does", first.display());
                let file = second.display().to_string();
                let error = Located::new(&file, Fault::Contradiction, problem);
                Ok(Self {
                    name,
                    error: error.cure("rename one of them"),
                })
            }
            other => Err(other),
        }
    }
}

impl Catalogue {
    /// The ropes that ship with the program.
    ///
    /// # Errors
    /// Returns [`CatalogueError::File`] if a shipped file is invalid, which a test excludes.
    pub fn shipped() -> Result<Self, CatalogueError> {
        Self::of(PAPER.iter().chain(&SHIPPED_EXTRA))
    }

    /// Ropes of Table I of the paper, in its order.
    ///
    /// # Errors
    /// As [`Catalogue::shipped`].
    pub fn paper() -> Result<Self, CatalogueError> {
        Self::of(PAPER.iter())
    }

    fn of<'a>(texts: impl Iterator<Item = &'a (&'a str, &'a str)>) -> Result<Self, CatalogueError> {
        let parse = |(file, text): &(&str, &str)| {
            Ok::<_, CatalogueError>(CatalogueRope {
                entry: CatalogueEntry::parse(text, file)?,
                file: None,
            })
        };
        Ok(Self {
            ropes: texts.map(parse).collect::<Result<_, CatalogueError>>()?,
            ..Self::default()
        })
    }

    /// The shipped ropes and those of `folders`, each read in order of file names; a rope of a
    /// later folder replaces an earlier one of its name.
    ///
    /// # Errors
    /// [`CatalogueError`].
    pub fn with_folders(folders: &[&Path]) -> Result<Self, CatalogueError> {
        let mut out = Self::shipped()?;
        for folder in folders {
            out.add_folder(folder, Err)?;
        }
        Ok(out)
    }

    /// The shipped ropes, those of `implied` folders such as `./ropes`, and then those of the requested `folders`. A
    /// file without a valid entry in the former is an error only of a command that needs its rope, see
    /// [`Catalogue::find`].
    ///
    /// # Errors
    /// [`CatalogueError`] of `folders`, and of a folder that cannot be listed.
    pub fn with_implied_folders(
        implied: &[&Path],
        folders: &[&Path],
    ) -> Result<Self, CatalogueError> {
        let mut out = Self::shipped()?;
        for folder in implied {
            let mut unreadable = Vec::new();
            out.add_folder(folder, |error| {
                unreadable.push(UnreadableRope::of(error)?);
                Ok(())
            })?;
            out.unreadable.append(&mut unreadable);
        }
        for folder in folders {
            out.add_folder(folder, Err)?;
        }
        Ok(out)
    }

    /// Adds the files of a folder; `reject` decides about a file that is invalid.
    fn add_folder(
        &mut self,
        folder: &Path,
        mut reject: impl FnMut(CatalogueError) -> Result<(), CatalogueError>,
    ) -> Result<(), CatalogueError> {
        let read_error = |error: std::io::Error| {
            let problem = format!("cannot be read: {error}");
            Located::new(&folder.display().to_string(), Fault::Unreadable, problem)
        };
        let mut files = Vec::new();
        for item in std::fs::read_dir(folder).map_err(read_error)? {
            let path = item.map_err(read_error)?.path();
            if path.extension().is_some_and(|e| e == "toml") && path.is_file() {
                files.push(path);
            }
        }
        files.sort();
        let mut fresh: Vec<CatalogueRope> = Vec::new();
        for path in files {
            let text = read_text(&path, &Budget::SETTINGS);
            let parse = |text: String| CatalogueEntry::parse(&text, &path.display().to_string());
            let entry = match text.and_then(parse) {
                Ok(entry) => entry,
                Err(error) => {
                    reject(error.into())?;
                    continue;
                }
            };
            if let Some(twin) = fresh.iter().find(|r| r.entry.name == entry.name) {
                reject(CatalogueError::Twice {
                    name: entry.name,
                    first: twin.file.clone().unwrap_or_default(),
                    second: path,
                })?;
                continue;
            }
            fresh.push(CatalogueRope {
                entry,
                file: Some(path),
            });
        }
        for rope in fresh {
            let named = |r: &&mut CatalogueRope| r.entry.name == rope.entry.name;
            let Some(old) = self.ropes.iter_mut().find(named) else {
                self.ropes.push(rope);
                continue;
            };
            // A copy of a shipped rope is that rope; under another file name it was to be another.
            let replaces = old.entry != rope.entry;
            let file = rope.file.clone().unwrap_or_default();
            if replaces
                || file
                    .file_stem()
                    .is_none_or(|stem| *stem != *rope.entry.name)
            {
                self.namesakes.push(Namesake {
                    name: rope.entry.name.clone(),
                    file,
                    replaces,
                });
            }
            if replaces {
                *old = rope;
            }
        }
        Ok(())
    }

    /// Files that name their rope as one before them.
    pub fn namesakes(&self) -> &[Namesake] {
        &self.namesakes
    }

    /// Files of implied folders that are not used.
    pub fn unreadable(&self) -> &[UnreadableRope] {
        &self.unreadable
    }

    /// Ropes of the catalogue in reading order.
    pub fn ropes(&self) -> &[CatalogueRope] {
        &self.ropes
    }

    /// Names of all ropes.
    pub fn names(&self) -> Vec<String> {
        self.ropes.iter().map(|r| r.entry.name.clone()).collect()
    }

    /// A rope by name.
    ///
    /// # Errors
    /// Returns [`CatalogueError::File`] if the file of the rope is invalid, otherwise [`CatalogueError::Unknown`] with
    /// the names in the catalogue.
    pub fn find(&self, name: &str) -> Result<&CatalogueRope, CatalogueError> {
        if let Some(unreadable) = self.unreadable.iter().find(|rope| rope.name == name) {
            return Err(unreadable.error.clone().into());
        }
        self.ropes
            .iter()
            .find(|r| r.entry.name == name)
            .ok_or_else(|| CatalogueError::Unknown {
                name: name.to_string(),
                available: self.names().join(", "),
            })
    }
}

/// FNV-1a: spreads names over seeds, the same on every machine.
pub(crate) fn name_hash(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| {
        (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn namesake_copy_reports_replacement() {
        let folder = tempfile::tempdir().expect("a folder");
        let shipped = Catalogue::shipped().expect("shipped");
        let rope = shipped.find("liros-dc000-0301").expect("there");
        let told = |file: &str, text: &str| {
            let folder = tempfile::tempdir_in(folder.path()).expect("a folder");
            std::fs::write(folder.path().join(file), text).expect("written");
            let read = Catalogue::with_folders(&[folder.path()]).expect("read");
            read.namesakes()
                .iter()
                .map(|n| n.replaces)
                .collect::<Vec<_>>()
        };
        let text = rope.entry.to_toml();
        assert_eq!(told("mine.toml", &text), [false]);
        assert_eq!(told("liros-dc000-0301.toml", &text), [false; 0]);
        let changed = text.replace("jamming = { value = 3.0", "jamming = { value = 4.0");
        assert_eq!(told("liros-dc000-0301.toml", &changed), [true]);
        let renamed = text.replacen("liros-dc000-0301", "mine", 1);
        assert_eq!(told("mine.toml", &renamed), [false; 0]);
    }

    #[test]
    fn shipped_ropes_are_table_1_as_published() {
        // Manufacturer, product, fibre, diameter (mm), breaking load (daN), plait, weight (g/m):
        // copied from the paper's Table I, not from the catalogue.
        type Row = (
            &'static str,
            &'static str,
            f64,
            Option<f64>,
            Option<&'static str>,
            Option<f64>,
        );
        let table: [Row; 9] = [
            (
                "Gottifredi Maffioli",
                "SK99 Ultra",
                2.00,
                Some(560.0),
                None,
                Some(2.50),
            ),
            (
                "Liros",
                "Aramid Braided Cord",
                2.00,
                Some(250.0),
                Some("16-plaited"),
                None,
            ),
            (
                "Liros",
                "DC000-0301",
                1.50,
                Some(445.0),
                Some("12-plaited"),
                Some(1.45),
            ),
            (
                "Liros",
                "DC000-0701",
                2.00,
                Some(700.0),
                Some("12-plaited"),
                Some(3.05),
            ),
            ("Ockert", "Climax Combat", 1.22, Some(210.0), None, None),
            (
                "Teufelberger",
                "FL-32.NG",
                1.50,
                Some(350.0),
                Some("8-plaited"),
                Some(1.80),
            ),
            (
                "Teufelberger",
                "FL-9.NG",
                2.05,
                Some(650.0),
                Some("12-plaited"),
                Some(3.30),
            ),
            ("TU Chemnitz", "Technora Black", 1.80, None, None, None),
            ("TU Chemnitz", "Vectran", 1.80, None, None, None),
        ];
        let catalogue = Catalogue::paper().expect("shipped ropes parse");
        assert_eq!(catalogue.ropes().len(), 9);
        let all = Catalogue::shipped().expect("shipped ropes parse");
        assert_eq!(&all.ropes()[..9], catalogue.ropes());
        assert!(
            all.ropes()
                .iter()
                .all(|r| r.entry.parameters().is_ok_and(|p| p.check().is_ok()))
        );
        for (rope, row) in catalogue.ropes().iter().zip(table) {
            let e = &rope.entry;
            let (maker, product, diameter_mm, load_dan, plait, weight) = row;
            assert_eq!(
                (e.manufacturer.as_str(), e.product.as_str()),
                (maker, product)
            );
            assert_eq!(e.diameter_mm.as_ref().map(|v| v.value), Some(diameter_mm));
            let load = e.breaking_load_n.as_ref().map(|v| v.value);
            assert_eq!(load, load_dan.map(|v| 10.0 * v), "{product}");
            assert_eq!(e.plait.as_deref(), plait, "{product}");
            assert_eq!(
                e.weight_g_per_m.as_ref().map(|v| v.value),
                weight,
                "{product}"
            );
            assert!(e.parameters().is_ok_and(|p| p.check().is_ok()), "{product}");
        }
    }

    #[test]
    fn shipped_ropes_survive_being_written() {
        for rope in Catalogue::shipped().expect("shipped ropes parse").ropes() {
            let text = rope.entry.to_toml();
            let again = CatalogueEntry::parse(&text, "again").expect("own text parses");
            assert_eq!(again, rope.entry);
        }
    }

    #[test]
    fn user_rope_extends_and_replaces_catalogue() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut own = Catalogue::shipped().expect("shipped").ropes()[0]
            .entry
            .clone();
        own.note = Some("mine".into());
        std::fs::write(folder.path().join("a.toml"), own.to_toml()).expect("written");
        own.name = "new-rope".into();
        std::fs::write(folder.path().join("b.toml"), own.to_toml()).expect("written");
        std::fs::write(folder.path().join("notes.txt"), "no rope").expect("written");
        let all = Catalogue::with_folders(&[folder.path()]).expect("read");
        assert_eq!(all.ropes().len(), 16);
        assert_eq!(all.ropes()[0].entry.note.as_deref(), Some("mine"));
        assert!(all.find("new-rope").is_ok());
        let error = all.find("no-rope").expect_err("unknown").to_string();
        assert!(
            error.contains("no-rope") && error.contains("new-rope"),
            "{error}"
        );
        std::fs::write(folder.path().join("c.toml"), own.to_toml()).expect("written");
        let error = Catalogue::with_folders(&[folder.path()]).expect_err("twice");
        assert!(error.to_string().contains("b.toml"), "{error}");
    }

    #[test]
    fn broken_file_of_implied_folder_is_error_of_its_rope_only() {
        let folder = tempfile::tempdir().expect("a folder");
        let shipped = Catalogue::shipped().expect("shipped");
        let entry = &shipped.ropes()[1].entry;
        let renamed = |name: &str| {
            let mut entry = entry.clone();
            entry.name = name.into();
            entry.to_toml()
        };
        let taken = shipped.ropes()[0].entry.name.clone();
        for (file, text) in [
            ("good.toml", renamed("good")),
            ("bad.toml", "name = \"bad".to_owned()),
            ("one.toml", renamed("same")),
            ("two.toml", renamed("same")),
            // A broken replacement of a shipped rope.
            (&*format!("{taken}.toml"), "diameter".to_owned()),
        ] {
            std::fs::write(folder.path().join(file), text).expect("written");
        }
        assert!(Catalogue::with_folders(&[folder.path()]).is_err());
        let all = Catalogue::with_implied_folders(&[folder.path()], &[]).expect("read");
        assert_eq!(all.unreadable().len(), 3);
        assert!(all.find("good").is_ok());
        let names = [
            ("bad", "bad.toml"),
            ("same", "two.toml"),
            (&*taken, &*taken),
        ];
        for (name, file) in names {
            let error = all.find(name).expect_err("broken").to_string();
            assert!(error.contains(file), "{error}");
        }
        assert!(Catalogue::with_implied_folders(&[], &[folder.path()]).is_err());
    }
}
