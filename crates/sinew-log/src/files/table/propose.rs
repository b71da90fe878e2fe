//! Proposal of a mapping for a table whose columns have other names.

use super::columns::{Headers, TIME_WORDS, time_unit_of_rate};
use super::csv_read::CsvRows;
#[cfg(feature = "numpy")]
use super::numpy::{self, NumpyRows};
use crate::frame::Quantity;
use crate::mapping::time_unit_exponent;
use sinew_files::Budget;
use sinew_files::unit::{Dimension as D, Unit};
use std::fs::File;
#[cfg(feature = "numpy")]
use std::io::Read;
use std::path::Path;

/// Rows whose values are considered.
const ROWS: usize = 2000;
/// Correlation from which two columns are the two sides of a joint.
const CORRELATED: f64 = 0.99;
/// Largest position that may be in rad: one turn, with a margin.
const MAX_RAD: f64 = 7.0;

/// Words of a column name and the quantity they name.
const WORDS: [(Quantity, &str); 5] = [
    (
        Quantity::Dq,
        "dq qd vel velocity speed geschwindigkeit drehzahl",
    ),
    (Quantity::TauEl, "tau torque effort moment drehmoment"),
    (Quantity::TauM, "current strom iq"),
    (Quantity::Temperature, "temp temperature temperatur"),
    (
        Quantity::Q,
        "q pos position angle winkel ang actual act encoder enc",
    ),
];
/// Words of the motor side.
const MOTOR_WORDS: &str = "motor mot m theta th actuator drive antrieb";
/// Words of the joint side.
const JOINT_WORDS: &str = "joint gelenk link load abtrieb output j q";

/// Column of a table with its first values.
#[derive(Debug, Clone, PartialEq)]
pub struct TableColumn {
    /// Header of the column; `column 2` if the table has none.
    pub name: String,
    /// Number of the column from 1, if the table has no header.
    pub number: Option<usize>,
    /// Unit in the header or below it.
    pub unit: Option<String>,
    /// Smallest and largest of the first values; `None` without numbers.
    pub range: Option<[f64; 2]>,
    /// Name without its unit.
    label: String,
    is_clock: bool,
    values: Vec<f64>,
}

/// Mapping that the names, units and first values of a table suggest.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MappingProposal {
    /// Columns of the table.
    pub columns: Vec<TableColumn>,
    /// Column of the time, if one rises.
    pub time: Option<ProposedTime>,
    /// Joints, in the order of their columns.
    pub joints: Vec<ProposedJoint>,
}

/// Proposed time column.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedTime {
    /// Index of the column.
    pub column: usize,
    /// Unit; `None` for clock times, and if no unit gives a usual rate.
    pub unit: Option<String>,
    /// Whether the header states the unit.
    pub is_unit_stated: bool,
    /// Whether the name is that of a time.
    pub is_named: bool,
    /// Mean rate of the first rows in this unit, Hz.
    pub rate_hz: Option<f64>,
}

/// Proposed joint with its columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedJoint {
    /// Name of the joint, from those of the columns.
    pub name: String,
    /// Columns of the joint.
    pub sources: Vec<ProposedSource>,
}

/// Proposed column of a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedSource {
    /// Index of the column.
    pub column: usize,
    /// Quantity of the column.
    pub quantity: Quantity,
    /// Whether a word of the name, not only the order of the columns, indicates the quantity.
    pub is_named: bool,
    /// Unit as written in a mapping file.
    pub unit: String,
    /// Whether the header states the unit.
    pub is_unit_stated: bool,
    /// Ratio of the movements of motor and joint over the first rows; `None` if they do not agree.
    pub gear_ratio: Option<f64>,
}

impl MappingProposal {
    /// Proposes a mapping for a file; empty if it cannot be read or is neither delimited text nor arrays of NumPy.
    pub fn of_file(path: &Path) -> Self {
        let Some((headers, has_names, values)) = first_values(path) else {
            return Self::default();
        };
        let mut columns = Vec::new();
        for ((index, name), values) in headers.names.iter().enumerate().zip(values) {
            let (label, unit) = headers.split(index);
            columns.push(TableColumn {
                name: name.clone(),
                number: (!has_names).then_some(index + 1),
                unit: unit.map(str::to_owned),
                range: None,
                label: label.to_owned(),
                is_clock: headers.clocks.contains(&index),
                values,
            });
        }
        for column in &mut columns {
            let finite = column
                .values
                .iter()
                .copied()
                .filter(|value| value.is_finite());
            column.range = finite.fold(None, |range: Option<[f64; 2]>, value| {
                let [low, high] = range.unwrap_or([value; 2]);
                Some([low.min(value), high.max(value)])
            });
        }
        let time = time(&columns);
        let joints = joints(&columns, time.as_ref().map(|time| time.column));
        Self {
            columns,
            time,
            joints,
        }
    }
}

/// Headers of a table, whether it names its columns, and the first values of each.
fn first_values(path: &Path) -> Option<(Headers, bool, Vec<Vec<f64>>)> {
    let name = path.display().to_string();
    #[cfg(feature = "numpy")]
    {
        let mut magic = [0; 6];
        File::open(path).ok()?.read_exact(&mut magic).ok()?;
        if magic.starts_with(numpy::NPY_MAGIC) || magic.starts_with(numpy::NPZ_MAGIC) {
            let file = Box::new(File::open(path).ok()?);
            let (mut rows, headers, has_names) =
                NumpyRows::open(file, &name, &Budget::RECORDING).ok()?;
            return Some((headers, has_names, rows.first_values(ROWS)));
        }
    }
    let file = Box::new(File::open(path).ok()?);
    let (mut rows, headers, has_names) = CsvRows::open(file, &name, &Budget::RECORDING).ok()?;
    let mut values = vec![Vec::new(); headers.names.len()];
    for _ in 0..ROWS {
        let Some(row) = rows.numbers() else { break };
        for (column, value) in values.iter_mut().zip(row) {
            column.push(value);
        }
    }
    Some((headers, has_names, values))
}

impl TableColumn {
    /// Whether each value exceeds the one before.
    fn rises(&self) -> bool {
        self.values.len() > 1 && self.values.windows(2).all(|pair| pair[0] < pair[1])
    }

    /// Whether the values count the rows.
    fn is_index(&self) -> bool {
        self.rises() && self.values.windows(2).all(|pair| pair[1] - pair[0] == 1.0)
    }

    /// Whether the values rise about evenly, as a clock does.
    fn is_steady(&self) -> bool {
        /// Ratio of a step to the mean step, either way: a stalled logger, not a motion.
        const MAX_STEP_RATIO: f64 = 10.0;
        let near =
            |step: f64, mean: f64| (mean / MAX_STEP_RATIO..=mean * MAX_STEP_RATIO).contains(&step);
        self.step()
            .is_some_and(|mean| (self.values.windows(2)).all(|pair| near(pair[1] - pair[0], mean)))
    }

    /// Mean difference of successive values.
    fn step(&self) -> Option<f64> {
        let steps = self
            .values
            .len()
            .checked_sub(1)
            .filter(|steps| *steps > 0)?;
        let step = (self.values.last()? - self.values.first()?) / steps as f64;
        (step.is_finite() && step > 0.0).then_some(step)
    }

    fn is_named_time(&self) -> bool {
        let label = self.label.to_lowercase();
        let is_word = |word: &str| TIME_WORDS.contains(&word);
        is_word(&label) || label.split(|c: char| !c.is_alphanumeric()).any(is_word)
    }

    fn time_unit(&self) -> Option<&str> {
        let unit = self.unit.as_deref();
        let suffix = || self.label.rsplit_once('_').map(|(_, unit)| unit);
        let is_time = |unit: &&str| time_unit_exponent(unit).is_ok();
        unit.filter(is_time).or_else(|| suffix().filter(is_time))
    }

    fn dimension(&self) -> Option<D> {
        let unit = self.unit.as_deref()?;
        Unit::parse(unit, &D::ALL).ok().map(|unit| unit.dimension)
    }
}

/// The column that rises or holds clock times, by its name, its unit and its place.
fn time(columns: &[TableColumn]) -> Option<ProposedTime> {
    let may_be = |column: &TableColumn| {
        let is_time = column
            .dimension()
            .is_none_or(|dimension| dimension == D::Time);
        is_time && (column.is_clock || column.rises())
    };
    // A column that counts the rows is the time only if no column is a clock.
    let has_clock = columns.iter().any(|c| c.is_steady() && !c.is_index());
    let weight = |column: &TableColumn| {
        4 * u8::from(column.is_named_time())
            + 2 * u8::from(column.time_unit().is_some())
            + u8::from(has_clock && column.is_steady() && !column.is_index())
    };
    // Of equal columns the first.
    let candidates = columns
        .iter()
        .enumerate()
        .rev()
        .filter(|(_, column)| may_be(column));
    let (index, column) = candidates.max_by_key(|(_, column)| weight(column))?;
    let stated = column.time_unit().map(str::to_owned);
    let step = column.step().filter(|_| !column.is_clock);
    let by_rate = || step.and_then(time_unit_of_rate).map(str::to_owned);
    let is_unit_stated = stated.is_some();
    let unit = stated.or_else(by_rate).filter(|_| !column.is_clock);
    let seconds = |unit: &String| Unit::parse(unit, &[D::Time]).ok().map(|unit| unit.factor);
    let rate_hz = unit
        .as_ref()
        .and_then(seconds)
        .zip(step)
        .map(|(s, step)| 1.0 / (s * step));
    Some(ProposedTime {
        column: index,
        unit,
        is_unit_stated,
        is_named: column.is_named_time(),
        rate_hz,
    })
}

/// A column with the side and quantity that its name suggests.
struct Candidate {
    column: usize,
    quantity: Quantity,
    is_named: bool,
    joint: String,
}

fn joints(columns: &[TableColumn], time: Option<usize>) -> Vec<ProposedJoint> {
    let others = columns.iter().enumerate().filter(|(index, column)| {
        let is_time = Some(*index) == time || column.is_named_time() || column.is_index();
        !is_time && column.range.is_some()
    });
    let mut candidates: Vec<Candidate> = others.filter_map(candidate).collect();
    // Two positions without a name: the first is the joint side.
    let unnamed: Vec<usize> = (0..candidates.len())
        .filter(|i| !candidates[*i].is_named)
        .collect();
    if let [_, motor] = unnamed[..] {
        candidates[motor].quantity = Quantity::Theta;
    }
    let mut joints: Vec<ProposedJoint> = Vec::new();
    for candidate in &candidates {
        let name = match candidate.joint.as_str() {
            "" => "NAME".to_owned(),
            digits if digits.bytes().all(|b| b.is_ascii_digit()) => format!("joint{digits}"),
            name => name.to_owned(),
        };
        let at = joints.iter().position(|joint| joint.name == name);
        let at = at.unwrap_or_else(|| {
            joints.push(ProposedJoint {
                name,
                sources: Vec::new(),
            });
            joints.len() - 1
        });
        let column = &columns[candidate.column];
        if !joints[at]
            .sources
            .iter()
            .any(|s| s.quantity == candidate.quantity)
        {
            joints[at].sources.push(ProposedSource {
                column: candidate.column,
                quantity: candidate.quantity,
                is_named: candidate.is_named,
                unit: column
                    .unit
                    .clone()
                    .unwrap_or_else(|| usual_unit(column, candidate.quantity)),
                is_unit_stated: column.unit.is_some(),
                gear_ratio: None,
            });
        }
    }
    for joint in &mut joints {
        let column = |quantity| {
            let source = joint.sources.iter().find(|s| s.quantity == quantity)?;
            let factor = Unit::parse(&source.unit, &D::ALL).map_or(1.0, |unit| unit.factor);
            Some((&columns[source.column].values, factor))
        };
        let sides = column(Quantity::Q).zip(column(Quantity::Theta));
        let ratio = sides.and_then(|((q, of_q), (theta, of_theta))| {
            slope(q, theta).map(|ratio| ratio * of_theta / of_q)
        });
        let motor = joint
            .sources
            .iter_mut()
            .find(|s| s.quantity == Quantity::Theta);
        if let Some(motor) = motor {
            motor.gear_ratio = ratio.map(rounded);
        }
    }
    joints
}

fn candidate((index, column): (usize, &TableColumn)) -> Option<Candidate> {
    let of_unit = match column.dimension() {
        None | Some(D::One) => None,
        Some(D::Angle | D::Count) => Some(Quantity::Q),
        Some(D::AngularVelocity) => Some(Quantity::Dq),
        Some(D::Torque) => Some(Quantity::TauEl),
        Some(D::Current) => Some(Quantity::TauM),
        Some(_) => return None,
    };
    // A column that has only a number has no name of a joint.
    let lower = match column.number {
        Some(_) => String::new(),
        None => column.label.to_lowercase(),
    };
    let (mut of_word, mut is_motor, mut is_joint) = (None, false, false);
    let mut joint: Vec<String> = Vec::new();
    for word in lower
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
    {
        let bare = word.trim_end_matches(|c: char| c.is_ascii_digit());
        let number = &word[bare.len()..];
        let is_among = |list: &str| list.split(' ').any(|listed| listed == bare);
        let named = WORDS
            .iter()
            .find(|(_, words)| is_among(words))
            .map(|(quantity, _)| *quantity);
        let (motor, of_joint) = (is_among(MOTOR_WORDS), is_among(JOINT_WORDS));
        is_motor |= motor;
        is_joint |= of_joint;
        of_word = of_word.or(named);
        let rest = match named.is_some() || motor || of_joint {
            true => number,
            false => word,
        };
        let is_number = !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_digit());
        if is_number || !rest.is_empty() && Unit::parse(rest, &D::ALL).is_err() {
            joint.push(rest.to_owned());
        }
    }
    let quantity = match of_unit.or(of_word).unwrap_or(Quantity::Q) {
        Quantity::Q if is_motor => Quantity::Theta,
        Quantity::TauEl if is_motor => Quantity::TauM,
        // The velocity of a motor and temperatures of single motors are not read.
        Quantity::Dq if is_motor => return None,
        Quantity::Temperature => return None,
        quantity => quantity,
    };
    Some(Candidate {
        column: index,
        quantity,
        is_named: is_motor || is_joint || of_word.is_some(),
        joint: joint.join("_"),
    })
}

/// Unit of a column whose header states none: degrees for positions beyond a turn.
fn usual_unit(column: &TableColumn, quantity: Quantity) -> String {
    let most = column.range.map_or(0.0, |[low, high]| high.max(-low));
    let unit = match quantity {
        Quantity::Q | Quantity::Theta if most > MAX_RAD => "deg",
        Quantity::Q | Quantity::Theta => "rad",
        Quantity::Dq => "rad/s",
        _ => "N·m",
    };
    unit.to_owned()
}

/// Slope of `y` over `x`, if both are correlated.
fn slope(x: &[f64], y: &[f64]) -> Option<f64> {
    let pairs: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    let pairs: Vec<_> = pairs
        .into_iter()
        .filter(|(x, y)| (x * y).is_finite())
        .collect();
    let n = pairs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let sum =
        |of: &dyn Fn(f64, f64) -> f64| pairs.iter().map(|p| of(p.0 - x, p.1 - y)).sum::<f64>();
    let (xx, yy, xy) = (sum(&|x, _| x * x), sum(&|_, y| y * y), sum(&|x, y| x * y));
    let correlation = xy / (xx * yy).sqrt();
    (correlation.abs() >= CORRELATED).then_some(xy / xx)
}

/// The roundest number near a ratio. The deflection of the tendon follows the position, so that the slope of the motor
/// over the joint differs from the gear ratio by some percent.
fn rounded(ratio: f64) -> f64 {
    /// Largest relative effect of the deflection on the slope.
    const MAX_DEFLECTION_RATIO: f64 = 0.02;
    /// Steps between the numbers that are tried, from round to less round, relative to the power of ten of the ratio.
    const STEPS: [f64; 7] = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];
    let size = 10_f64.powf(ratio.abs().log10().floor());
    let near = |step: f64| {
        let number = (ratio / (size * step)).round() * (size * step);
        ((number - ratio).abs() <= MAX_DEFLECTION_RATIO * ratio.abs()).then_some(number)
    };
    let number = STEPS.into_iter().find_map(near).unwrap_or(ratio);
    (1000.0 * number).round() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write as _;

    fn propose(header: &str, row: impl Fn(f64) -> String) -> MappingProposal {
        let file = tempfile::NamedTempFile::new().expect("a file");
        let mut text = header.to_owned();
        for step in 0..100 {
            let _ = writeln!(text, "{}", row(f64::from(step)));
        }
        std::fs::write(file.path(), text).expect("written");
        MappingProposal::of_file(file.path())
    }

    fn q(step: f64) -> f64 {
        (0.1 * step).sin()
    }

    #[test]
    fn units_and_sides_come_from_headers() {
        let header = "tilt_joint [°],tilt_motor [°],Time [ms]\n";
        let found = propose(header, |k| {
            format!("{},{},{}", q(k), 50.0 * q(k) + 0.3, 10.0 * k)
        });
        let time = found.time.expect("a time");
        assert_eq!(
            (time.column, time.unit.as_deref(), time.is_unit_stated),
            (2, Some("ms"), true)
        );
        assert!((time.rate_hz.expect("a rate") - 100.0).abs() < 1e-9);
        let [joint] = &found.joints[..] else {
            panic!("{:?}", found.joints);
        };
        assert_eq!(joint.name, "tilt");
        let [q, theta] = &joint.sources[..] else {
            panic!("{joint:?}");
        };
        assert_eq!((q.quantity, q.unit.as_str()), (Quantity::Q, "°"));
        assert_eq!(
            (theta.quantity, theta.gear_ratio),
            (Quantity::Theta, Some(50.0))
        );
    }

    #[test]
    fn time_is_named_column_that_rises() {
        // A column of a joint that rises precedes the time.
        let found = propose("q1,theta1,timestamp\n", |k| {
            format!("{},{},{}", 0.01 * k, 0.01 * k, 1e6 * k)
        });
        let time = found.time.expect("a time");
        assert_eq!((time.column, time.unit.as_deref()), (2, Some("ns")));
        assert!(time.is_named && !time.is_unit_stated);
        assert_eq!(found.joints[0].name, "joint1");
        // Seconds by name, which do not rise, are no time.
        let found = propose("time,pos,mot\n", |k| format!("1,{},{}", q(k), 0.01 * k));
        assert_eq!(found.time.expect("rises").column, 2);
    }

    #[test]
    fn columns_without_names_are_proposed_by_their_order() {
        let found = propose("", |k| {
            format!("{},{},{}", 0.01 * k, 100.0 * q(k), 100.0 * q(k))
        });
        assert_eq!(found.columns[1].number, Some(2));
        assert_eq!(found.time.expect("rises").unit.as_deref(), Some("s"));
        let sources = &found.joints[0].sources;
        let quantities: Vec<Quantity> = sources.iter().map(|s| s.quantity).collect();
        assert_eq!(quantities, [Quantity::Q, Quantity::Theta]);
        assert!(sources.iter().all(|s| !s.is_named && s.unit == "deg"));
    }

    #[test]
    fn clock_is_time_where_rows_are_counted() {
        let found = propose("", |k| {
            let late = if k > 50.0 { 0.03 } else { 0.0 };
            let time = 1_634_500_000.0 + 0.01 * k + late;
            format!("{k} {time:.6} {:.6} {:.6}", q(k), 2.0 * q(k))
        });
        let time = found.time.expect("rises");
        assert_eq!((time.column, time.unit.as_deref()), (1, Some("s")));
        let columns: Vec<usize> = found.joints[0].sources.iter().map(|s| s.column).collect();
        assert_eq!(columns, [2, 3]);
        // Without a clock the number of the row is the only time.
        let found = propose("", |k| format!("{k} {:.6} {:.6}", q(k), q(k)));
        assert_eq!(found.time.expect("rises").column, 0);
    }

    #[test]
    fn gear_ratio_is_round_number_near_slope() {
        // The deflection of the tendon adds 1.8 % to the slope.
        for (slope, ratio) in [
            (50.9, 50.0),
            (1.012, 1.0),
            (-102.0, -100.0),
            (6.0, 6.0),
            (0.0, 0.0),
        ] {
            assert!(
                (rounded(slope) - ratio).abs() < 1e-9,
                "{slope}: {}",
                rounded(slope)
            );
        }
    }

    #[test]
    fn clock_times_are_the_time_without_a_unit() {
        let found = propose("Zeit;Gelenk;Motor\n", |k| {
            format!("10:00:{:02};{};{}", k % 60.0, q(k), q(k))
        });
        let time = found.time.expect("a clock");
        assert_eq!((time.column, time.unit, time.rate_hz), (0, None, None));
    }
}
