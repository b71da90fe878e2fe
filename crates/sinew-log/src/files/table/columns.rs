//! Assignment of columns to quantities and joints.

use crate::assemble::{Conditioner, Joiner, Signal};
use crate::error::LogError;
use crate::frame::{ABSENT, AxisNames, Channels, Quantities, Quantity, blocks};
use crate::mapping::{ColumnRef, Mapping, Source, Wrap, time_unit_exponent};
use crate::options::OpenOptions;
use crate::options::to_ns;
use crate::sources::SignalSource;
use sinew_files::names::{hint, list};
use sinew_files::{Fault, Located};

/// Addend of a value: `scale · cell + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Addend {
    pub(crate) column: usize,
    pub(crate) scale: f64,
    pub(crate) offset: f64,
}

impl Addend {
    /// A column that is recorded in SI.
    fn si(column: usize) -> Self {
        Self {
            column,
            scale: 1.0,
            offset: 0.0,
        }
    }
}

/// Signal of one joint, motor or tendon: a sum of columns.
#[derive(Debug, Clone)]
struct SignalPlan {
    /// Place among the joints; of a tension, among the tendons.
    owner: usize,
    quantity: Quantity,
    addends: Vec<Addend>,
    period: Option<f64>,
}

/// Column mapping of a table.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    /// Headers, empty where a column cannot be read.
    pub(crate) names: Vec<String>,
    joints: Vec<String>,
    /// Names that a tension is recorded of.
    tendons: Vec<String>,
    channels: Channels,
    signals: Vec<SignalPlan>,
    /// Column of the times; `None` where the rows have a rate.
    pub(crate) time_column: Option<usize>,
    /// Power of ten from the time column's unit to nanoseconds.
    pub(crate) time_exponent: i32,
    /// Rate of rows without times, Hz.
    rate_hz: f64,
    /// Used columns, ascending, with the index of their value in the row of cells.
    pub(crate) used: Vec<usize>,
    /// Signals of the joints selected: place in the wide row, range of `addends`.
    selected: Vec<(usize, usize, usize)>,
    addends: Vec<Addend>,
    /// Values of a wide row.
    pub(super) width: usize,
}

/// A column name of DESIGN.md taken apart: quantity, joint, factor to SI, unwrapped.
fn parse_name(name: &str) -> Option<(Quantity, &str, bool)> {
    let (symbol, rest) = name.split_once('.')?;
    let quantity = Quantity::PER_JOINT
        .into_iter()
        .chain([Quantity::Tension])
        .find(|quantity| quantity.symbol() == symbol)?;
    // Prismatic joints: metres and newtons, which do not wrap.
    let straight = match quantity {
        Quantity::Q | Quantity::Theta => "_m",
        Quantity::Dq => "_m_s",
        _ => "_n",
    };
    let (joint, wraps) = match rest.strip_suffix(quantity.suffix()) {
        Some(joint) => (joint, true),
        None => (rest.strip_suffix(straight)?, false),
    };
    (!joint.is_empty()).then_some((quantity, joint, wraps))
}

impl Columns {
    pub(crate) fn new(
        headers: &Headers,
        options: &OpenOptions,
        file: &str,
    ) -> Result<Self, LogError> {
        let names = &headers.names;
        let header = |reason: String| LogError::from(Located::new(file, Fault::NotAllowed, reason));
        let columns = options.budget.columns.check(names.len() as u64);
        columns.map_err(header)?;
        let mut seen = std::collections::HashSet::new();
        for name in names.iter().filter(|name| !name.is_empty()) {
            if !seen.insert(name.as_str()) {
                return Err(header(format!(
                    "duplicate column '{}'; remove or rename one",
                    sinew_files::names::shorten(name, 80)
                )));
            }
        }
        let mapping = options.mapping.as_ref();
        let rate_hz = mapping.and_then(|mapping| mapping.time.as_ref()?.rate_hz);
        let (time_column, time_exponent) = match rate_hz {
            Some(_) => (None, 0),
            None => time_of(headers, mapping, file).map(|(column, e)| (Some(column), e))?,
        };
        let mut columns = Columns {
            names: names.to_vec(),
            joints: Vec::new(),
            tendons: Vec::new(),
            channels: Channels::default(),
            signals: Vec::new(),
            time_column,
            time_exponent,
            rate_hz: rate_hz.unwrap_or(f64::NAN),
            used: Vec::new(),
            selected: Vec::new(),
            addends: Vec::new(),
            width: 0,
        };
        match mapping {
            Some(mapping) if !mapping.joints.is_empty() => {
                columns.map_joints(names, mapping, file)?;
            }
            _ => columns.find_joints(names),
        }
        if columns.joints.is_empty() {
            let reason = "no column like q.<joint>_rad or theta.<joint>_rad; a mapping can name other columns";
            return Err(LogError::columns(file, reason, names));
        }
        match mapping {
            Some(mapping) if !mapping.tendons.is_empty() => {
                columns.map_tendons(names, mapping, file)?;
            }
            _ => columns.find_tendons(names),
        }
        columns.map_temperature(names, mapping, file)?;
        let all = columns.joints.clone();
        columns.select(&AxisNames::of_joints(&all));
        Ok(columns)
    }

    fn find_joints(&mut self, names: &[String]) {
        for (column, name) in names.iter().enumerate() {
            let Some((quantity, joint, wraps)) = parse_name(name) else {
                continue;
            };
            if quantity == Quantity::Tension {
                continue;
            }
            let index = match self.joints.iter().position(|known| known == joint) {
                Some(index) => index,
                None => {
                    self.joints.push(joint.to_owned());
                    self.channels.joints.push(Quantities::default());
                    self.joints.len() - 1
                }
            };
            if self.channels.joints[index].has(quantity) {
                // q.a_rad and q.a_m: the first is taken.
                continue;
            }
            self.channels.joints[index].insert(quantity);
            self.signals.push(SignalPlan {
                owner: index,
                quantity,
                addends: vec![Addend::si(column)],
                period: Signal::si(quantity).period.filter(|_| wraps),
            });
        }
    }

    /// Tensions by the usual names of their columns.
    fn find_tendons(&mut self, names: &[String]) {
        for (column, name) in names.iter().enumerate() {
            if let Some((Quantity::Tension, tendon, _)) = parse_name(name) {
                self.add_tendon(tendon, vec![Addend::si(column)]);
            }
        }
    }

    fn map_tendons(
        &mut self,
        names: &[String],
        mapping: &Mapping,
        file: &str,
    ) -> Result<(), LogError> {
        for tendon in &mapping.tendons {
            if let Some(source) = &tendon.tension {
                let addends = addends_of(source, names, mapping, file)?;
                self.add_tendon(&tendon.name, addends);
            }
        }
        Ok(())
    }

    fn add_tendon(&mut self, name: &str, addends: Vec<Addend>) {
        self.tendons.push(name.to_owned());
        self.signals.push(SignalPlan {
            owner: self.tendons.len() - 1,
            quantity: Quantity::Tension,
            addends,
            period: None,
        });
    }

    fn map_joints(
        &mut self,
        names: &[String],
        mapping: &Mapping,
        file: &str,
    ) -> Result<(), LogError> {
        for joint in &mapping.joints {
            let [q, theta] = [Quantity::Q, Quantity::Theta].map(|q| &joint.sources[q.index()]);
            if let (Some(q), Some(theta)) = (q, theta)
                && q.is_equivalent(theta)
            {
                let problem = "joint side and motor side are the same column";
                return Err(Located::new(&mapping.file, Fault::Contradiction, problem)
                    .line(theta.terms.first().map_or(theta.line, |term| term.line))
                    .value(
                        theta
                            .terms
                            .iter()
                            .find_map(|term| term.column.as_ref())
                            .map_or(String::new(), ColumnRef::to_string),
                    )
                    .cure("the motor's own position is needed")
                    .into());
            }
            let index = self.joints.len();
            self.joints.push(joint.name.clone());
            self.channels.joints.push(Quantities::default());
            for quantity in Quantity::PER_JOINT {
                let Some(source) = &joint.sources[quantity.index()] else {
                    continue;
                };
                let addends = addends_of(source, names, mapping, file)?;
                self.channels.joints[index].insert(quantity);
                self.signals.push(SignalPlan {
                    owner: index,
                    quantity,
                    addends,
                    period: match source.wrap {
                        Wrap::Never => None,
                        Wrap::Period(period) => Some(period),
                    },
                });
            }
        }
        Ok(())
    }

    fn map_temperature(
        &mut self,
        names: &[String],
        mapping: Option<&Mapping>,
        file: &str,
    ) -> Result<(), LogError> {
        let addends = match mapping.and_then(|m| m.temperature.as_ref().map(|t| (m, t))) {
            Some((mapping, source)) => addends_of(source, names, mapping, file)?,
            None => match names.iter().position(|name| name == "temperature_c") {
                None => return Ok(()),
                Some(column) => vec![Addend::si(column)],
            },
        };
        self.channels.temperature = true;
        for joint in &mut self.channels.joints {
            joint.temperature = true;
        }
        self.signals.push(SignalPlan {
            owner: 0,
            quantity: Quantity::Temperature,
            addends,
            period: None,
        });
        Ok(())
    }

    pub(crate) fn found(&self) -> (Vec<String>, Channels) {
        (self.joints.clone(), self.channels.clone())
    }

    /// Names that a tension is recorded of.
    pub(super) fn tendons(&self) -> &[String] {
        &self.tendons
    }

    /// Name of the joint, motor or tendon that a signal is of.
    fn owner(&self, signal: &SignalPlan) -> Option<&str> {
        let names = match signal.quantity {
            Quantity::Tension => &self.tendons,
            _ => &self.joints,
        };
        names.get(signal.owner).map(String::as_str)
    }

    /// Source of each quantity.
    pub(super) fn sources(&self) -> Vec<SignalSource> {
        let all = Quantity::ALL.into_iter();
        all.filter_map(|quantity| {
            let own = self.signals.iter().filter(|s| s.quantity == quantity);
            let columns = own
                .flat_map(|s| &s.addends)
                .map(|a| self.names[a.column].as_str());
            let source = Vec::from_iter(columns).join(", ");
            (!source.is_empty()).then_some(SignalSource {
                quantity,
                topic: None,
                source,
            })
        })
        .collect()
    }

    /// Columns that are not used.
    pub(super) fn unused(&self) -> Vec<String> {
        let used = |column| {
            let mut read = self.signals.iter().flat_map(|s| &s.addends);
            Some(column) == self.time_column || read.any(|a| a.column == column)
        };
        let names = self.names.iter().enumerate();
        names
            .filter(|(column, name)| !name.is_empty() && !used(*column))
            .map(|(_, name)| name.clone())
            .collect()
    }

    /// Sets the axes of the rows from now on, in this order.
    pub(crate) fn select(&mut self, axes: &[AxisNames]) {
        self.width = blocks(axes).len() * axes.len();
        self.selected.clear();
        self.addends.clear();
        let mut used = Vec::from_iter(self.time_column);
        for signal in &self.signals {
            let place = if signal.quantity == Quantity::Temperature {
                Some(0)
            } else {
                let name = self.owner(signal);
                let mut axes = axes.iter();
                axes.position(|axis| name.is_some() && axis.recorded(signal.quantity) == name)
            };
            // A selection of no axes has no place for a temperature either.
            let Some(place) = place.filter(|place| *place < axes.len()) else {
                continue;
            };
            let from = self.addends.len();
            self.addends.extend_from_slice(&signal.addends);
            used.extend(signal.addends.iter().map(|addend| addend.column));
            self.selected.push((
                signal.quantity.index() * axes.len() + place,
                from,
                self.addends.len(),
            ));
        }
        used.sort_unstable();
        used.dedup();
        // From column numbers to places in the row of used cells.
        for addend in &mut self.addends {
            addend.column = used.binary_search(&addend.column).unwrap_or(0);
        }
        self.used = used;
    }

    /// Place of the time among the used cells.
    #[cfg(feature = "parquet")]
    pub(crate) fn time_place(&self) -> Option<usize> {
        self.used.binary_search(&self.time_column?).ok()
    }

    /// Time of a row without one by the rate of the mapping, ns from the first row.
    pub(crate) fn time_of_row(&self, row: u64) -> Option<i64> {
        let ns = (row as f64 * 1e9 / self.rate_hz).round();
        ns.is_finite().then_some(ns as i64)
    }

    /// Name of the time column, for messages.
    pub(super) fn time_name(&self) -> &str {
        let name = self.time_column.and_then(|column| self.names.get(column));
        name.map_or("time", String::as_str)
    }

    /// Computes the wide row from the used cells; an absent cell makes its signal absent.
    pub(crate) fn row(&self, cells: &[f64], row: &mut [f64]) {
        for &(place, from, to) in &self.selected {
            let mut sum = 0.0;
            for addend in &self.addends[from..to] {
                let cell = cells[addend.column];
                if crate::frame::is_absent(cell) {
                    sum = ABSENT;
                    break;
                }
                sum += addend.scale * cell + addend.offset;
            }
            row[place] = sum;
        }
    }

    pub(crate) fn joiner(&self, axes: &[AxisNames], options: &OpenOptions) -> Joiner {
        let signal = |axis: &AxisNames, quantity| {
            let name = axis.recorded(quantity);
            let mut plans = self.signals.iter();
            let plan = plans.find(|plan| plan.quantity == quantity && self.owner(plan) == name);
            Signal {
                scale: 1.0,
                offset: 0.0,
                period: plan.and_then(|plan| plan.period),
            }
        };
        Joiner::new(
            axes.len(),
            blocks(axes),
            &[],
            to_ns(options.reorder_s),
            to_ns(options.interpolate_s),
            Conditioner::new(axes, to_ns(options.gap_s), signal),
        )
    }
}

fn addends_of(
    source: &Source,
    names: &[String],
    mapping: &Mapping,
    file: &str,
) -> Result<Vec<Addend>, LogError> {
    source
        .terms
        .iter()
        .map(|term| {
            let error = |reason: String| {
                Located::new(&mapping.file, Fault::UnknownName, reason).line(term.line)
            };
            let wanted = term.column.as_ref().ok_or_else(|| {
                error(format!(
                    "'column' is missing; it is required because {file} is a table"
                ))
            })?;
            let column = wanted.index(names).ok_or_else(|| {
                let hint = near(wanted, names);
                let there = list(names);
                error(format!(
                    "no column {wanted} in {file}{hint} columns are {there}"
                ))
            })?;
            Ok(Addend {
                column,
                scale: term.scale,
                offset: term.offset,
            })
        })
        .collect()
}

/// The nearest name of a column that is not there.
fn near(wanted: &ColumnRef, names: &[String]) -> String {
    match wanted {
        ColumnRef::Name(wanted) => hint(wanted, names),
        ColumnRef::Number(_) => format!(": {} columns;", names.len()),
    }
}

/// Names of time columns with the power of ten from their unit to nanoseconds.
const TIMES: [(&str, i32); 5] = [
    ("time_s", 9),
    ("time_ns", 0),
    ("time_us", 3),
    ("time_ms", 6),
    // LeRobot's, in seconds.
    ("timestamp", 9),
];

/// Time units of a mapping and their powers of ten to nanoseconds.
pub(super) const TIME_UNITS: [(&str, i32); 4] = [("s", 9), ("ms", 6), ("us", 3), ("ns", 0)];

/// The first time unit in which rows with this step have a usual rate, 5 Hz to 20 kHz.
pub(super) fn time_unit_of_rate(step: f64) -> Option<&'static str> {
    const USUAL_HZ: std::ops::Range<f64> = 5.0..20_000.0;
    let rate_hz = |exponent| 10_f64.powi(9 - exponent) / step;
    let mut units = TIME_UNITS.iter();
    let found = units.find(|(_, exponent)| USUAL_HZ.contains(&rate_hz(*exponent)));
    found.map(|(unit, _)| *unit)
}

/// Names of a time, if its unit or its cells determine the conversion.
pub(super) const TIME_WORDS: [&str; 10] = [
    "time",
    "t",
    "zeit",
    "elapsed",
    "elapsed time",
    "timestamp",
    "uhrzeit",
    "zeitstempel",
    "datetime",
    "date/time",
];

/// Whether a column has one of the names that need no mapping.
pub(super) fn has_usual_name(name: &str) -> bool {
    TIMES.iter().any(|(usual, _)| *usual == name) || parse_name(name).is_some()
}

/// Names of the columns, and their units in the table.
#[derive(Debug, Default)]
pub(crate) struct Headers {
    pub(crate) names: Vec<String>,
    /// Units below the names; empty if the table has none there.
    pub(crate) units: Vec<String>,
    /// Columns of clock times or dates.
    pub(crate) clocks: Vec<usize>,
}

impl Headers {
    /// Headers without units.
    pub(crate) fn of_names(names: Vec<String>) -> Self {
        Self {
            names,
            ..Self::default()
        }
    }

    /// Name of a column without its unit, and its unit: `Time [ms]`, `Time (ms)`, `Time / ms`, or in the row below.
    pub(crate) fn split(&self, column: usize) -> (&str, Option<&str>) {
        let name = self.names.get(column).map_or("", |name| name.trim());
        let below = self.units.get(column).map(String::as_str);
        let below = below.filter(|unit| !unit.is_empty());
        // `q[0]` is an element of an array.
        let is_element = |(array, index): &(&str, &str)| {
            let is_index = !index.is_empty() && index.bytes().all(|b| b.is_ascii_digit());
            is_index && name.ends_with(']') && !array.ends_with(char::is_whitespace)
        };
        let parted = [('[', ']'), ('(', ')')]
            .into_iter()
            .find_map(|(open, close)| name.strip_suffix(close)?.rsplit_once(open))
            .filter(|parts| !is_element(parts));
        match parted.or_else(|| name.rsplit_once(" / ")) {
            Some((name, unit)) => (name.trim(), Some(unit.trim())),
            None => (name, below),
        }
    }

    /// Power of ten from the unit of a time column to nanoseconds, by its name, its unit or its cells.
    fn time_exponent(&self, column: usize) -> Option<i32> {
        let (_, unit) = self.split(column);
        let usual = TIMES.iter().find(|(name, _)| *name == self.names[column]);
        let stated = || unit.and_then(|unit| time_unit_exponent(unit).ok());
        let clock = || self.clocks.contains(&column).then_some(9);
        usual
            .map(|(_, exponent)| *exponent)
            .or_else(stated)
            .or_else(clock)
    }
}

fn time_of(
    headers: &Headers,
    mapping: Option<&Mapping>,
    file: &str,
) -> Result<(usize, i32), LogError> {
    let names = &headers.names;
    let map = mapping.and_then(|mapping| mapping.time.as_ref());
    let stated = map.and_then(|map| map.exponent);
    if let Some(wanted) = map.and_then(|map| map.column.as_ref()) {
        let column = wanted.index(names).ok_or_else(|| {
            let (hint, there) = (near(wanted, names), list(names));
            LogError::request(
                file,
                format!("no time column {wanted}{hint} columns are {there}"),
            )
        })?;
        let exponent = stated.or_else(|| headers.time_exponent(column));
        return Ok((column, exponent.unwrap_or(9)));
    }
    let usual = TIMES
        .iter()
        .find_map(|(usual, _)| names.iter().position(|name| name == usual));
    let is_time = |column: &usize| {
        let name = headers.split(*column).0.to_lowercase();
        TIME_WORDS.contains(&name.as_str()) && headers.time_exponent(*column).is_some()
    };
    let column = usual.or_else(|| (0..names.len()).find(is_time));
    let found = column.and_then(|column| Some((column, stated.or(headers.time_exponent(column))?)));
    found.ok_or_else(|| {
        let reason = "no time column: time_s or time_ns, or [time] column in a mapping";
        LogError::columns(file, reason, names)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn column_names_of_the_design_are_taken_apart() {
        assert_eq!(
            parse_name("q.elbow_rad"),
            Some((Quantity::Q, "elbow", true))
        );
        assert_eq!(
            parse_name("tau_el.lwr_0_joint_nm"),
            Some((Quantity::TauEl, "lwr_0_joint", true))
        );
        assert_eq!(
            parse_name("dq.a.b_rad_s"),
            Some((Quantity::Dq, "a.b", true))
        );
        assert_eq!(parse_name("q.slide_m"), Some((Quantity::Q, "slide", false)));
        assert_eq!(
            parse_name("tension.flexor_n"),
            Some((Quantity::Tension, "flexor", true))
        );
        assert_eq!(parse_name("tension.flexor_nm"), None);
        assert_eq!(parse_name("q._rad"), None);
        assert_eq!(parse_name("q.elbow"), None);
        assert_eq!(parse_name("position"), None);
    }
}
