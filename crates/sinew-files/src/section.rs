//! Reader of a TOML table, key by key, whose errors name file, line, key, value and unit.

use crate::bound::{Bound, unit_of};
use crate::located::{Fault, Fields, Located};
use crate::names;
use std::cell::{Cell, RefCell};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A TOML file.
#[derive(Debug)]
pub struct TomlFile<'t> {
    file: &'t str,
    text: &'t str,
    table: Spanned<DeTable<'t>>,
    /// Byte positions of the line ends, for the line number of a byte.
    ends: Vec<usize>,
}

impl<'t> TomlFile<'t> {
    /// Parses a text; `file` is its name for messages.
    ///
    /// # Errors
    /// Returns [`Fault::Syntax`] with the line.
    pub fn parse(text: &'t str, file: &'t str) -> Result<Self, Located> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        let table = DeTable::parse(text).map_err(|error| {
            let words: Vec<&str> = error.message().split_whitespace().collect();
            let located = Located::new(file, Fault::Syntax, words.join(" "));
            match error.span() {
                Some(span) => located.line(line_at(&ends, span.start)),
                None => located,
            }
        })?;
        Ok(Self {
            file,
            text,
            table,
            ends,
        })
    }

    /// The whole file as a section.
    pub fn root(&self) -> Section<'_> {
        Section {
            doc: self,
            path: String::new(),
            table: self.table.get_ref(),
            start: 0,
            read_keys: RefCell::default(),
            named: Cell::new(false),
            lacking: RefCell::default(),
        }
    }

    fn line(&self, byte: usize) -> u64 {
        line_at(&self.ends, byte)
    }
}

/// Line of a byte, from 1.
fn line_at(ends: &[usize], byte: usize) -> u64 {
    1 + ends.partition_point(|end| *end < byte) as u64
}

/// A value and its place.
#[derive(Debug, Clone)]
pub struct Value<'d> {
    doc: &'d TomlFile<'d>,
    path: String,
    value: &'d Spanned<DeValue<'d>>,
}

impl<'d> Value<'d> {
    /// Section and key.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Line, from 1.
    pub fn line(&self) -> u64 {
        self.doc.line(self.value.span().start)
    }

    /// Whether it is a table.
    pub fn is_table(&self) -> bool {
        self.value.get_ref().is_table()
    }

    /// A fault of this value.
    pub fn fault(&self, fault: Fault, problem: impl Into<String>) -> Located {
        let written = self.doc.text.get(self.value.span()).unwrap_or("?");
        let words: Vec<&str> = written.split_whitespace().collect();
        Located::new(self.doc.file, fault, problem)
            .line(self.line())
            .key(&self.path)
            .value(names::shorten(&words.join(" "), 60))
            .unit(unit_of(&self.path))
    }

    /// Returns the error for an invalid value, with the requirement.
    pub fn invalid(&self, must: &str) -> Located {
        self.fault(Fault::NotAllowed, format!("must be {must}"))
    }

    fn not_a(&self, what: &str) -> Located {
        self.fault(Fault::WrongType, format!("must be {what}"))
    }

    /// A number.
    ///
    /// # Errors
    /// No number, or not within the bound.
    pub fn number(&self, bound: Bound) -> Result<f64, Located> {
        let parsed = match self.value.get_ref() {
            DeValue::Float(f) => f.as_str().replace('_', "").parse::<f64>().ok(),
            DeValue::Integer(i) if i.radix() == 10 => i.as_str().replace('_', "").parse().ok(),
            _ => None,
        };
        match parsed {
            Some(v) if bound.allows(v) => Ok(v),
            Some(_) => Err(self.invalid(&bound.must(unit_of(&self.path)))),
            None => Err(self.not_a("a number")),
        }
    }

    /// A whole number from 0 on.
    ///
    /// # Errors
    /// No whole number, or below 0.
    pub fn count(&self) -> Result<u64, Located> {
        let integer = self.value.get_ref().as_integer();
        integer
            .and_then(|i| u64::from_str_radix(&i.as_str().replace('_', ""), i.radix()).ok())
            .ok_or_else(|| self.not_a("a whole number of at least 0"))
    }

    /// Returns the value as a boolean.
    ///
    /// # Errors
    /// Returns an error for any other value.
    pub fn flag(&self) -> Result<bool, Located> {
        let flag = self.value.get_ref().as_bool();
        flag.ok_or_else(|| self.not_a("true or false"))
    }

    /// Returns the value as a text.
    ///
    /// # Errors
    /// Returns an error for any other value.
    pub fn text(&self) -> Result<&'d str, Located> {
        let text = self.value.get_ref().as_str();
        text.ok_or_else(|| self.not_a("text in quotes"))
    }

    /// Returns the value of one of the permitted words.
    ///
    /// # Errors
    /// Returns an error with the valid words for any other value.
    pub fn one_of<T: Copy>(&self, words: &[(&str, T)]) -> Result<T, Located> {
        let text = self.value.get_ref().as_str();
        let found = text.and_then(|text| words.iter().find(|(word, _)| *word == text));
        found.map(|(_, meaning)| *meaning).ok_or_else(|| {
            let quoted: Vec<String> = words.iter().map(|(w, _)| format!("\"{w}\"")).collect();
            let must = match quoted.split_last() {
                Some((last, [])) => last.clone(),
                Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
                None => String::new(),
            };
            self.invalid(&must)
        })
    }

    /// The entries of a list, each at the list's own key.
    ///
    /// # Errors
    /// Returns an error if the value is not a list; `must` describes the expected list.
    pub fn list(&self, must: &str) -> Result<Vec<Value<'d>>, Located> {
        let array = self.value.get_ref().as_array();
        let array = array.ok_or_else(|| self.not_a(must))?;
        Ok(array.iter().map(|value| self.at(value)).collect())
    }

    fn at(&self, value: &'d Spanned<DeValue<'d>>) -> Value<'d> {
        Value {
            doc: self.doc,
            path: self.path.clone(),
            value,
        }
    }

    /// Reads a list of `N` numbers.
    ///
    /// # Errors
    /// Returns an error if the value is not such a list, or if a number is outside the bound; `must`
    /// describes the expected list.
    pub fn numbers<const N: usize>(&self, bound: Bound, must: &str) -> Result<[f64; N], Located> {
        let list = self.list(must)?;
        let mut out = [0.0; N];
        if list.len() != N {
            return Err(self.not_a(must));
        }
        for (out, value) in out.iter_mut().zip(&list) {
            *out = value.number(bound)?;
        }
        Ok(out)
    }

    /// Returns the value as a table.
    ///
    /// # Errors
    /// Returns an error for any other value.
    pub fn section(&self) -> Result<Section<'d>, Located> {
        let table = self.value.get_ref().as_table();
        Ok(Section {
            doc: self.doc,
            path: self.path.clone(),
            table: table.ok_or_else(|| self.not_a("a table"))?,
            start: self.value.span().start,
            read_keys: RefCell::default(),
            named: Cell::new(false),
            lacking: RefCell::default(),
        })
    }
}

/// One table of the file. It records the keys that were read and reports all others as unknown.
#[derive(Debug)]
pub struct Section<'d> {
    doc: &'d TomlFile<'d>,
    path: String,
    table: &'d DeTable<'d>,
    start: usize,
    read_keys: RefCell<Vec<&'static str>>,
    /// Whether the keys are names, which only the caller can check.
    named: Cell<bool>,
    /// The error of the first required key that is missing.
    lacking: RefCell<Option<Located>>,
}

impl<'d> Section<'d> {
    /// Line of the section, from 1.
    pub fn line(&self) -> u64 {
        self.doc.line(self.start)
    }

    /// Returns the value at a key, if there is one.
    pub fn value(&self, key: &'static str) -> Option<Value<'d>> {
        self.read_keys.borrow_mut().push(key);
        self.table.get(key).map(|value| self.at(key, value))
    }

    fn at(&self, key: &str, value: &'d Spanned<DeValue<'d>>) -> Value<'d> {
        Value {
            doc: self.doc,
            path: match self.path.as_str() {
                "" => key.into(),
                path => format!("{path}.{key}"),
            },
            value,
        }
    }

    /// Every name, its line and value, in the file's order: for a table whose keys are names. None of
    /// them is unknown then.
    pub fn entries(&self) -> Vec<(&'d str, u64, Value<'d>)> {
        self.named.set(true);
        self.sorted()
    }

    fn sorted(&self) -> Vec<(&'d str, u64, Value<'d>)> {
        let mut entries: Vec<_> = self.table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        entries
            .into_iter()
            .map(|(key, value)| {
                let name = key.get_ref().as_ref();
                (name, self.doc.line(key.span().start), self.at(name, value))
            })
            .collect()
    }

    /// Whether a value exists at a key.
    pub fn has(&self, key: &'static str) -> bool {
        self.value(key).is_some()
    }

    /// A whole number from 0 on.
    ///
    /// # Errors
    /// Returns the errors of [`Value::count`].
    pub fn count(&self, key: &'static str) -> Result<Option<u64>, Located> {
        self.value(key).map(|v| v.count()).transpose()
    }

    /// Reads a boolean; `false` if the key is missing.
    ///
    /// # Errors
    /// Returns the errors of [`Value::flag`].
    pub fn flag(&self, key: &'static str) -> Result<bool, Located> {
        self.flag_or(key, false)
    }

    /// Reads a boolean; `plain` if the key is missing.
    ///
    /// # Errors
    /// Returns the errors of [`Value::flag`].
    pub fn flag_or(&self, key: &'static str, plain: bool) -> Result<bool, Located> {
        self.value(key).map_or(Ok(plain), |v| v.flag())
    }

    /// Returns the value as a text.
    ///
    /// # Errors
    /// Returns the errors of [`Value::text`].
    pub fn text(&self, key: &'static str) -> Result<Option<String>, Located> {
        let text = self.value(key).map(|v| v.text().map(str::to_owned));
        text.transpose()
    }

    /// Reads a required text, as [`Section::needed`]; `reason` states its purpose.
    ///
    /// # Errors
    /// Returns the errors of [`Value::text`].
    pub fn need_text(&self, key: &'static str, reason: &str) -> Result<String, Located> {
        Ok(self.needed(self.text(key)?, key, reason, String::new()))
    }

    /// Returns the value read at `key`. If there was none, returns `instead`, and [`Section::whole`]
    /// reports the missing key at the end of the section, so that a misspelt key is reported as
    /// misspelt and not as missing.
    pub fn needed<T>(&self, read: Option<T>, key: &'static str, reason: &str, instead: T) -> T {
        read.unwrap_or_else(|| {
            self.missing(key, reason);
            instead
        })
    }

    /// Returns the value of one of the permitted words.
    ///
    /// # Errors
    /// Returns the errors of [`Value::one_of`].
    pub fn one_of<T: Copy>(
        &self,
        key: &'static str,
        words: &[(&str, T)],
    ) -> Result<Option<T>, Located> {
        self.value(key).map(|v| v.one_of(words)).transpose()
    }

    /// `[x, y, z]`.
    ///
    /// # Errors
    /// Returns the errors of [`Value::numbers`].
    pub fn vec3(&self, key: &'static str) -> Result<Option<[f64; 3]>, Located> {
        let must = "three numbers [x, y, z]";
        let vec3 = self.value(key).map(|v| v.numbers(Bound::Any, must));
        vec3.transpose()
    }

    /// Reads a sub-table completely.
    ///
    /// # Errors
    /// Returns an error if the value is not a table, the errors of `read`, or an error for a key that
    /// `read` does not use.
    pub fn read<T, E: From<Located>>(
        &self,
        key: &'static str,
        read: impl FnOnce(&Section<'d>) -> Result<T, E>,
    ) -> Result<Option<T>, E> {
        match self.value(key) {
            Some(value) => value.section()?.whole(read).map(Some),
            None => Ok(None),
        }
    }

    /// A list of sub-tables, each read to its end.
    ///
    /// # Errors
    /// Returns the errors of [`Section::read`].
    pub fn each<T, E: From<Located>>(
        &self,
        key: &'static str,
        read: impl Fn(&Section<'d>) -> Result<T, E>,
    ) -> Result<Vec<T>, E> {
        let Some(value) = self.value(key) else {
            return Ok(Vec::new());
        };
        let list = value.list("a list of tables ([[…]])")?;
        let entries = list.into_iter().enumerate();
        entries
            .map(|(i, entry)| {
                let path = format!("{}[{i}]", value.path);
                Value { path, ..entry }.section()?.whole(&read)
            })
            .collect()
    }

    /// Reads the section; reports keys that `read` did not use, then required keys that are missing.
    ///
    /// # Errors
    /// Returns the errors of [`Section::read`]; [`Fault::UnknownKey`] with the nearest key and the list
    /// of permitted keys; [`Fault::MissingKey`].
    pub fn whole<T, E: From<Located>>(
        &self,
        read: impl FnOnce(&Section<'d>) -> Result<T, E>,
    ) -> Result<T, E> {
        let value = read(self);
        let lacking = self.lacking.take();
        if value.is_err() && lacking.is_none() {
            return value;
        }
        let mut permitted = self.read_keys.borrow().clone();
        permitted.sort_unstable();
        permitted.dedup();
        let named = self.named.get();
        let strangers = self.table.keys().filter(|key| {
            let name: &str = key.get_ref();
            !named && !permitted.contains(&name)
        });
        match strangers.min_by_key(|key| key.span().start) {
            Some(key) => {
                let line = self.doc.line(key.span().start);
                Err(self.unknown(key.get_ref(), line, &permitted).into())
            }
            None => match lacking {
                Some(lacking) => Err(lacking.into()),
                None => value,
            },
        }
    }

    /// Returns the error for a name of [`Section::entries`] that is not one of `permitted`.
    pub fn unknown(&self, name: &str, line: u64, permitted: &[&str]) -> Located {
        let near = names::nearest(name, permitted);
        let near = near.map_or(String::new(), |near| format!("did you mean '{near}'? "));
        let permitted = permitted.join(", ");
        self.here(Fault::UnknownKey, format!("unknown key '{name}'"))
            .line(line)
            .cure(format!("{near}valid keys: {permitted}"))
    }

    /// A fault of the section.
    pub fn here(&self, fault: Fault, problem: impl Into<String>) -> Located {
        let located = Located::new(self.doc.file, fault, problem).line(self.line());
        match self.path.as_str() {
            "" => located,
            path => located.key(path),
        }
    }
}

impl Fields for Section<'_> {
    fn number(&self, key: &'static str, bound: Bound) -> Result<Option<f64>, Located> {
        self.value(key).map(|v| v.number(bound)).transpose()
    }

    /// Reads a required number, as [`Section::needed`], with NaN as the substitute.
    fn need(&self, key: &'static str, bound: Bound, reason: &str) -> Result<f64, Located> {
        Ok(self.needed(self.number(key, bound)?, key, reason, f64::NAN))
    }

    fn invalid(&self, key: &'static str, must: &str) -> Located {
        match self.value(key) {
            Some(value) => value.invalid(must),
            None => self.missing(key, must),
        }
    }

    /// [`Section::whole`] reports a misspelt key instead.
    fn missing(&self, key: &'static str, reason: &str) -> Located {
        let located = self.here(Fault::MissingKey, format!("{key} is missing: {reason}"));
        let mut lacking = self.lacking.borrow_mut();
        lacking.get_or_insert_with(|| located.clone());
        located
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "mod = \"a\"\nmode = \"fast\"\n[arm]\nlength_mm = -3\nlist = [1, 2]\n\n[[arm.joint]]\nq_rad = nan\n";

    #[test]
    fn line_of_byte_matches_counted_lines() {
        let text = "a = 1\r\n\n[b]\nc = 2\n";
        let doc = TomlFile::parse(text, "t.toml").expect("TOML");
        for byte in 0..=text.len() {
            assert_eq!(
                doc.line(byte),
                1 + text[..byte].matches('\n').count() as u64
            );
        }
    }

    #[test]
    fn section_fault_has_location_value_unit_remedy() {
        let doc = TomlFile::parse(TEXT, "a.toml").unwrap();
        let root = doc.root();
        let said = |error: Located| error.to_string();
        let mode = root
            .one_of("mode", &[("slow", 1), ("quick", 2)])
            .unwrap_err();
        assert_eq!(
            said(mode),
            "a.toml, line 2: mode = \"fast\": must be \"slow\" or \"quick\""
        );
        let arm = root.value("arm").unwrap().section().unwrap();
        assert_eq!(
            said(arm.number("length_mm", Bound::Positive).unwrap_err()),
            "a.toml, line 4: arm.length_mm = -3 (mm): must be above 0 mm"
        );
        assert_eq!(
            said(arm.vec3("list").unwrap_err()),
            "a.toml, line 5: arm.list = [1, 2]: must be three numbers [x, y, z]"
        );
        let joints = arm.each("joint", |s| s.number("q_rad", Bound::Any));
        assert_eq!(
            said(joints.unwrap_err()),
            "a.toml, line 8: arm.joint[0].q_rad = nan (rad): must be a finite number"
        );
        assert_eq!(
            said(arm.missing("mass_kg", "how heavy it is")),
            "a.toml, line 3: arm: mass_kg is missing: how heavy it is"
        );
        let whole = root.whole(|s| s.need("length_m", Bound::Any, "how long it is"));
        assert_eq!(
            said(whole.unwrap_err()),
            "a.toml, line 1: unknown key 'mod'; did you mean 'mode'? valid keys: arm, length_m, mode"
        );
        let joint = arm.each("joint", |s| {
            s.value("q_rad");
            s.need("length_m", Bound::Any, "how long it is")
        });
        assert_eq!(
            said(joint.unwrap_err()),
            "a.toml, line 7: arm.joint[0]: length_m is missing: how long it is"
        );
        let error = TomlFile::parse("a = \n", "b.toml").unwrap_err();
        assert_eq!((error.line, error.fault), (Some(1), Fault::Syntax));
    }
}
