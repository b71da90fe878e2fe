//! Parser of catalogue text, with the location of each error.

use super::{CatalogueEntry, Correlation, FibreClass, Origin, Uncertainty, Value};
use crate::law::endurance::EnduranceKey;
use crate::law::tested_range::TestedRange;
use crate::law::{Parameter, Polymer};
use sinew_files::{Bound, Fault, Fields as _, Located, Section, TomlFile};
use std::collections::BTreeMap;

/// Keys of `[sources]` and the sources they denote.
type Sources = BTreeMap<String, String>;

pub(super) fn entry(text: &str, file: &str) -> Result<CatalogueEntry, Located> {
    TomlFile::parse(text, file)?.root().whole(root)
}

pub(super) fn fibre(text: &str, file: &str) -> Result<FibreClass, Located> {
    let read = |s: &Section<'_>| -> Result<FibreClass, Located> {
        let sources = sources(s)?;
        let endurance = s.read("endurance", |s| endurance(s, &sources))?;
        Ok(FibreClass {
            endurance: endurance.unwrap_or_default(),
            sources,
        })
    };
    TomlFile::parse(text, file)?.root().whole(read)
}

fn sources(s: &Section<'_>) -> Result<Sources, Located> {
    let sources = s.read("sources", |s| {
        let entries = s.entries().into_iter();
        let read = entries.map(|(key, _, text)| Ok((key.to_owned(), text.text()?.to_owned())));
        read.collect::<Result<Sources, Located>>()
    })?;
    Ok(sources.unwrap_or_default())
}

fn endurance(s: &Section<'_>, sources: &Sources) -> Result<BTreeMap<EnduranceKey, Value>, Located> {
    let mut out = BTreeMap::new();
    for (name, line, entry) in s.entries() {
        let key = EnduranceKey::ALL.iter().copied().find(|k| k.name() == name);
        let key = key.ok_or_else(|| {
            let valid: Vec<&str> = EnduranceKey::ALL.iter().map(|k| k.name()).collect();
            s.unknown(name, line, &valid)
        })?;
        let (low, high) = key.range();
        let read = |s: &Section<'_>| value(s, Bound::Within(low, high), sources);
        out.insert(key, entry.section()?.whole(read)?);
    }
    Ok(out)
}

fn root(s: &Section<'_>) -> Result<CatalogueEntry, Located> {
    let sources = sources(s)?;
    let published = s.read("published", |s| {
        let read = |key| s.read(key, |s| value(s, Bound::Positive, &sources));
        Ok::<_, Located>((
            read("diameter_mm")?,
            read("breaking_load_n")?,
            read("weight_g_per_m")?,
            read("discard_strain_percent")?,
        ))
    })?;
    let (diameter_mm, breaking_load_n, weight_g_per_m, discard_strain_percent) =
        published.unwrap_or_default();
    let law = s.read("law", |s| law(s, &sources))?.unwrap_or_default();
    let name = s.need_text("name", "name of the rope")?;
    let material = s.need_text("material", "HMPE, aramid, LCP, steel, tungsten or other")?;
    let entry = CatalogueEntry {
        manufacturer: s.need_text("manufacturer", "manufacturer of the rope")?,
        product: s.need_text("product", "product name")?,
        fibre: s.need_text("fibre", "load-bearing fibre")?,
        plait: s.text("plait")?,
        note: s.text("note")?,
        correlation: s.read("correlation", |s| correlation(s, &law))?,
        tested_range: s.read("tested_range", tested_range)?,
        endurance: s
            .read("endurance", |s| endurance(s, &sources))?
            .unwrap_or_default(),
        material: match material.to_lowercase().as_str() {
            "hmpe" => Polymer::Hmpe,
            "aramid" => Polymer::Aramid,
            "lcp" => Polymer::Lcp,
            "steel" => Polymer::Steel,
            "tungsten" => Polymer::Tungsten,
            "other" => Polymer::Other,
            _ => return Err(s.invalid("material", "HMPE, aramid, LCP, steel, tungsten or other")),
        },
        name,
        sources,
        diameter_mm,
        breaking_load_n,
        weight_g_per_m,
        discard_strain_percent,
        law,
    };
    let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if entry.name.is_empty() || !entry.name.chars().all(good) {
        return Err(s.invalid("name", "lower case letters, digits and -"));
    }
    Ok(entry)
}

fn law(s: &Section<'_>, sources: &Sources) -> Result<BTreeMap<Parameter, Value>, Located> {
    let mut law = BTreeMap::new();
    for (key, line, entry) in s.entries() {
        let parameter = parameter(key).ok_or_else(|| {
            let valid: Vec<&str> = Parameter::ALL.iter().map(|p| p.name()).collect();
            s.unknown(key, line, &valid)
        })?;
        let (low, high) = parameter.range();
        let read = |s: &Section<'_>| value(s, Bound::Within(low, high), sources);
        law.insert(parameter, entry.section()?.whole(read)?);
    }
    Ok(law)
}

fn value(s: &Section<'_>, bound: Bound, sources: &Sources) -> Result<Value, Located> {
    let value = s.need("value", bound, "a number")?;
    let factor = s.number("factor", Bound::Within(1.0, 1e6))?;
    let plus_minus = s.number("plus_minus", Bound::Within(0.0, 1e12))?;
    let older = |v: &sinew_files::Value<'_>| v.text().is_ok_and(|t| t == Origin::OLDER_ASSUMED);
    let origin = match s.value("origin").filter(older) {
        Some(_) => Some(Origin::Assumed),
        None => s.one_of("origin", &Origin::NAMES)?,
    };
    let origin = s.needed(origin, "origin", "origin of the value", Origin::Published);
    let source = s.need_text("source", "a key of [sources]")?;
    let date = s.text("date")?;
    let uncertainty = match (factor, plus_minus) {
        (None, None) => Uncertainty::NotSpecified,
        (Some(f), None) if f > 1.0 && f < 1e6 => Uncertainty::Factor(f),
        (None, Some(d)) if d > 0.0 && d < 1e12 => Uncertainty::PlusMinus(d),
        (Some(_), None) => return Err(s.invalid("factor", "above 1")),
        (None, Some(_)) => return Err(s.invalid("plus_minus", "above 0")),
        (Some(_), Some(_)) => {
            let problem = "specify factor or plus_minus, not both";
            return Err(s.here(Fault::Contradiction, problem));
        }
    };
    if s.has("source") && !sources.contains_key(&source) {
        return Err(s.invalid("source", "a key of [sources]; add it there"));
    }
    if origin == Origin::Fitted && date.is_none() {
        return Err(s.missing("date", "a fitted value needs the date of its fit"));
    }
    Ok(Value {
        value,
        uncertainty,
        origin,
        source,
        date,
    })
}

fn tested_range(s: &Section<'_>) -> Result<TestedRange, Located> {
    let range = |key, bound, must: &str| {
        let value = s.value(key).ok_or_else(|| s.missing(key, must))?;
        let [low, high] = value.numbers(bound, must)?;
        if low > high {
            return Err(value.invalid(must));
        }
        Ok([low, high])
    };
    Ok(TestedRange {
        load_share: range(
            "load_share",
            Bound::Within(1e-6, 1.0),
            "the lowest and the highest tension over breaking load of the data",
        )?,
        temperature_c: range(
            "temperature_c",
            Bound::Within(-100.0, 200.0),
            "the lowest and the highest temperature of the data",
        )?,
        duration_s: s.need(
            "duration_s",
            Bound::Positive,
            "duration of the longest test",
        )?,
    })
}

fn correlation(s: &Section<'_>, law: &BTreeMap<Parameter, Value>) -> Result<Correlation, Located> {
    let reason = "parameters of [law] and the correlations of their errors";
    let (names, matrix) = (s.value("parameters"), s.value("matrix"));
    let (Some(names), Some(matrix)) = (names, matrix) else {
        let key = ["parameters", "matrix"].into_iter().find(|key| !s.has(key));
        return Err(s.missing(key.unwrap_or_default(), reason));
    };
    let mut parameters = Vec::new();
    for name in names.list("a list of names")? {
        let specified = parameter(name.text()?).filter(|p| law.contains_key(p));
        let p = specified.filter(|p| !parameters.contains(p));
        parameters.push(p.ok_or_else(|| name.invalid("parameters of [law], each once"))?);
    }
    let mut m: Vec<Vec<f64>> = Vec::new();
    let must = "a list of rows of numbers";
    for row in matrix.list(must)? {
        let row = row.list(must)?.into_iter();
        m.push(
            row.map(|v| v.number(Bound::Any))
                .collect::<Result<_, _>>()?,
        );
    }
    let n = parameters.len();
    let square = m.len() == n && m.iter().all(|row| row.len() == n);
    let symmetric = square
        && (0..n).all(|i| {
            (m[i][i] - 1.0).abs() < 1e-9 && (0..i).all(|j| (m[i][j] - m[j][i]).abs() < 1e-9)
        });
    if !symmetric {
        let must = format!("{n} by {n}, symmetric, with ones on the diagonal");
        return Err(matrix.invalid(&must));
    }
    Correlation::new(parameters, m).ok_or_else(|| matrix.invalid("positive definite"))
}

fn parameter(name: &str) -> Option<Parameter> {
    Parameter::ALL.iter().copied().find(|p| p.name() == name)
}
