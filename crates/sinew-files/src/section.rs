//! A TOML table read key by key, so that every refusal names file, line, key, value and unit.

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
    /// Where the lines end, so that the line of a byte is looked up and not counted.
    ends: Vec<usize>,
}

impl<'t> TomlFile<'t> {
    /// Parses a text; `file` is its name for messages.
    ///
    /// # Errors
    /// [`Fault::Syntax`] with the line.
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
            asked: RefCell::default(),
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

    /// Refuses the value, with what it must be.
    pub fn refuse(&self, must: &str) -> Located {
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
            Some(_) => Err(self.refuse(&bound.must(unit_of(&self.path)))),
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

    /// `true` or `false`.
    ///
    /// # Errors
    /// Anything else.
    pub fn flag(&self) -> Result<bool, Located> {
        let flag = self.value.get_ref().as_bool();
        flag.ok_or_else(|| self.not_a("true or false"))
    }

    /// A text.
    ///
    /// # Errors
    /// Anything else.
    pub fn text(&self) -> Result<&'d str, Located> {
        let text = self.value.get_ref().as_str();
        text.ok_or_else(|| self.not_a("text in quotes"))
    }

    /// One of the words there are, and what it stands for.
    ///
    /// # Errors
    /// Anything else, with the words.
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
            self.refuse(&must)
        })
    }

    /// The entries of a list, each at the list's own key.
    ///
    /// # Errors
    /// No list; `must` says of what.
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

    /// So many numbers in a list.
    ///
    /// # Errors
    /// No such list, or a number that is not within the bound; `must` says what it holds.
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

    /// The table it is.
    ///
    /// # Errors
    /// Anything else.
    pub fn section(&self) -> Result<Section<'d>, Located> {
        let table = self.value.get_ref().as_table();
        Ok(Section {
            doc: self.doc,
            path: self.path.clone(),
            table: table.ok_or_else(|| self.not_a("a table"))?,
            start: self.value.span().start,
            asked: RefCell::default(),
            named: Cell::new(false),
            lacking: RefCell::default(),
        })
    }
}

/// One table of the file; remembers which keys were asked for, and refuses the others.
#[derive(Debug)]
pub struct Section<'d> {
    doc: &'d TomlFile<'d>,
    path: String,
    table: &'d DeTable<'d>,
    start: usize,
    asked: RefCell<Vec<&'static str>>,
    /// Keys are names, known to the reader.
    named: Cell<bool>,
    /// The first key that is needed and not there.
    lacking: RefCell<Option<Located>>,
}

impl<'d> Section<'d> {
    /// Line of the section, from 1.
    pub fn line(&self) -> u64 {
        self.doc.line(self.start)
    }

    /// What stands at a key.
    pub fn value(&self, key: &'static str) -> Option<Value<'d>> {
        self.asked.borrow_mut().push(key);
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

    /// Whether anything stands at a key.
    pub fn has(&self, key: &'static str) -> bool {
        self.value(key).is_some()
    }

    /// A whole number from 0 on.
    ///
    /// # Errors
    /// As [`Value::count`].
    pub fn count(&self, key: &'static str) -> Result<Option<u64>, Located> {
        self.value(key).map(|v| v.count()).transpose()
    }

    /// `true` or `false`; `false` when left out.
    ///
    /// # Errors
    /// As [`Value::flag`].
    pub fn flag(&self, key: &'static str) -> Result<bool, Located> {
        self.flag_or(key, false)
    }

    /// `true` or `false`; `plain` when left out.
    ///
    /// # Errors
    /// As [`Value::flag`].
    pub fn flag_or(&self, key: &'static str, plain: bool) -> Result<bool, Located> {
        self.value(key).map_or(Ok(plain), |v| v.flag())
    }

    /// A text.
    ///
    /// # Errors
    /// As [`Value::text`].
    pub fn text(&self, key: &'static str) -> Result<Option<String>, Located> {
        let text = self.value(key).map(|v| v.text().map(str::to_owned));
        text.transpose()
    }

    /// A text that has to be there, as [`Section::needed`]; `why` says what it is for.
    ///
    /// # Errors
    /// As [`Value::text`].
    pub fn need_text(&self, key: &'static str, why: &str) -> Result<String, Located> {
        Ok(self.needed(self.text(key)?, key, why, String::new()))
    }

    /// What was read at `key`; where nothing was, `instead`, and [`Section::whole`] refuses the section
    /// at its end. So a key that is misspelt is told as such, not as missing.
    pub fn needed<T>(&self, read: Option<T>, key: &'static str, why: &str, instead: T) -> T {
        read.unwrap_or_else(|| {
            self.missing(key, why);
            instead
        })
    }

    /// One of the words there are, and what it stands for.
    ///
    /// # Errors
    /// As [`Value::one_of`].
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
    /// As [`Value::numbers`].
    pub fn vec3(&self, key: &'static str) -> Result<Option<[f64; 3]>, Located> {
        let must = "three numbers [x, y, z]";
        let vec3 = self.value(key).map(|v| v.numbers(Bound::Any, must));
        vec3.transpose()
    }

    /// A sub-table, read to its end.
    ///
    /// # Errors
    /// No table, what `read` refuses, or a key it doesn't ask for.
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
    /// As [`Section::read`].
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

    /// Reads the section; refuses what `read` didn't ask for, then what it needed and is not there.
    ///
    /// # Errors
    /// As [`Section::read`]; [`Fault::UnknownKey`] with the nearest key and all there are;
    /// [`Fault::MissingKey`].
    pub fn whole<T, E: From<Located>>(
        &self,
        read: impl FnOnce(&Section<'d>) -> Result<T, E>,
    ) -> Result<T, E> {
        let value = read(self);
        let lacking = self.lacking.take();
        if value.is_err() && lacking.is_none() {
            return value;
        }
        let mut known = self.asked.borrow().clone();
        known.sort_unstable();
        known.dedup();
        let named = self.named.get();
        let strangers = self.table.keys().filter(|key| {
            let name: &str = key.get_ref();
            !named && !known.contains(&name)
        });
        match strangers.min_by_key(|key| key.span().start) {
            Some(key) => {
                let line = self.doc.line(key.span().start);
                Err(self.unknown(key.get_ref(), line, &known).into())
            }
            None => match lacking {
                Some(lacking) => Err(lacking.into()),
                None => value,
            },
        }
    }

    /// Refuses a name of [`Section::entries`] that isn't one of the names known.
    pub fn unknown(&self, name: &str, line: u64, known: &[&str]) -> Located {
        let near = names::nearest(name, known);
        let near = near.map_or(String::new(), |near| format!("did you mean '{near}'? "));
        let known = known.join(", ");
        self.here(Fault::UnknownKey, format!("unknown key '{name}'"))
            .line(line)
            .cure(format!("{near}known are {known}"))
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

    /// As [`Section::needed`], with NaN instead.
    fn need(&self, key: &'static str, bound: Bound, why: &str) -> Result<f64, Located> {
        Ok(self.needed(self.number(key, bound)?, key, why, f64::NAN))
    }

    fn refuse(&self, key: &'static str, must: &str) -> Located {
        match self.value(key) {
            Some(value) => value.refuse(must),
            None => self.missing(key, must),
        }
    }

    /// [`Section::whole`] tells a misspelt key in its place.
    fn missing(&self, key: &'static str, why: &str) -> Located {
        let located = self.here(Fault::MissingKey, format!("{key} is missing: {why}"));
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
    fn a_byte_is_on_the_line_that_counting_gives() {
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
    fn every_fault_has_its_place_value_unit_and_cure() {
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
            "a.toml, line 1: unknown key 'mod'; did you mean 'mode'? known are arm, length_m, mode"
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
