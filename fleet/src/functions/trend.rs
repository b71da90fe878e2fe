//! `sinew_trend` and `sinew_days_until`: the trend of a tendon's records, as in `due`.

use super::{Lazy, external};
use crate::FleetError;
use crate::metadata::FleetMetadata;
use crate::sessions::{self, Sessions};
use datafusion::arrow::array::{
    Array as _, ArrayRef, AsArray as _, Float64Array, Int64Array, RecordBatch, StringArray,
    StructArray, UInt64Array,
};
use datafusion::arrow::compute::{concat_batches, sort_to_indices, take_record_batch};
use datafusion::arrow::datatypes::{
    DataType, Field, FieldRef, Fields, Float64Type, Schema, SchemaRef,
};
use datafusion::common::ScalarValue;
use datafusion::common::utils::SingleRowListArrayBuilder;
use datafusion::error::DataFusionError;
use datafusion::logical_expr::function::{AccumulatorArgs, StateFieldsArgs};
use datafusion::logical_expr::{Accumulator, AggregateUDFImpl, Signature, Volatility};
use sinew_files::date::DAY_S;
use sinew_model::Gaussian;
use sinew_trend::{JointTrend, Passage, TrendEvent};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// Columns of a record required by a trend: those of a session and the kind of clock.
pub(super) const COLUMNS: [&str; 12] = {
    let mut out = ["clock"; 12];
    let mut i = 0;
    while i < sessions::COLUMNS.len() {
        out[i] = sessions::COLUMNS[i];
        i += 1;
    }
    out
};
/// Indices into [`COLUMNS`].
const TIME: usize = 4;
const OFFSET: usize = 6;
const STD: usize = 7;
const CLOCK: usize = 11;

/// Kind of the aggregate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Trend,
    DaysUntil,
}

impl Kind {
    pub(super) const ALL: [Self; 2] = [Self::Trend, Self::DaysUntil];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Trend => "sinew_trend",
            Self::DaysUntil => "sinew_days_until",
        }
    }

    /// Correct form of the call.
    pub(super) fn usage(self) -> &'static str {
        match self {
            Self::Trend => "sinew_trend(*), or sinew_trend(r.*) where records is called r",
            Self::DaysUntil => {
                "sinew_days_until(*) for the limits of robot.toml, or sinew_days_until(0.8, *) for 0.8 mm; r.* \
                 where records is called r"
            }
        }
    }

    /// Fields of the result.
    fn fields(self) -> Fields {
        let number = |name: &str| Field::new(name, DataType::Float64, true);
        let text = |name: &str| Field::new(name, DataType::Utf8, true);
        let count = |name: &str| Field::new(name, DataType::Int64, true);
        let fields = match self {
            Self::Trend => vec![
                text("verdict"),
                number("offset_rad"),
                number("offset_std_rad"),
                number("elongation_m"),
                number("elongation_std_m"),
                number("rate_rad_per_s"),
                number("rate_std_rad_per_s"),
                count("steps"),
                count("sessions"),
                number("tensioned_utc_s"),
                number("last_utc_s"),
                text("rejection"),
            ],
            Self::DaysUntil => vec![
                text("limit"),
                text("state"),
                number("days"),
                number("days_low"),
                number("days_high"),
                text("rejection"),
            ],
        };
        fields.into()
    }

    /// Arguments: a limit in mm, if supported, then the columns.
    fn arguments(self) -> Vec<Field> {
        let limit =
            (self == Self::DaysUntil).then(|| Field::new("limit_mm", DataType::Float64, true));
        let column = |i: usize, name: &str| {
            let is_text = i < TIME || i == CLOCK;
            let kind = if is_text {
                DataType::Utf8
            } else {
                DataType::Float64
            };
            Field::new(name, kind, true)
        };
        let columns = COLUMNS.into_iter().enumerate();
        let columns = columns.map(|(i, name)| column(i, name));
        limit.into_iter().chain(columns).collect()
    }

    fn rows(self) -> SchemaRef {
        Arc::new(Schema::new(self.arguments()))
    }
}

/// An aggregate over the records of a tendon.
#[derive(Debug)]
pub(super) struct OfTendon {
    kind: Kind,
    lazy: Arc<Lazy>,
    signature: Signature,
}

impl OfTendon {
    pub(super) fn new(kind: Kind, lazy: Arc<Lazy>) -> Self {
        let types = kind.arguments();
        let types = types.iter().map(|f| f.data_type().clone()).collect();
        Self {
            kind,
            lazy,
            signature: Signature::exact(types, Volatility::Stable),
        }
    }
}

impl PartialEq for OfTendon {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind && Arc::ptr_eq(&self.lazy, &other.lazy)
    }
}

impl Eq for OfTendon {}

impl Hash for OfTendon {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.kind.hash(state);
    }
}

impl AggregateUDFImpl for OfTendon {
    fn name(&self) -> &str {
        self.kind.name()
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType, DataFusionError> {
        Ok(DataType::Struct(self.kind.fields()))
    }

    fn accumulator(&self, _: AccumulatorArgs<'_>) -> Result<Box<dyn Accumulator>, DataFusionError> {
        Ok(Box::new(Rows {
            kind: self.kind,
            lazy: self.lazy.clone(),
            schema: self.kind.rows(),
            parts: Vec::new(),
            bytes: 0,
        }))
    }

    fn state_fields(&self, args: StateFieldsArgs<'_>) -> Result<Vec<FieldRef>, DataFusionError> {
        let row = DataType::Struct(self.kind.arguments().into());
        let name = format!("{}[rows]", args.name);
        Ok(vec![Arc::new(Field::new_list(
            name,
            Field::new_list_field(row, true),
            true,
        ))])
    }
}

/// A tendon's records so far.
#[derive(Debug)]
struct Rows {
    kind: Kind,
    lazy: Arc<Lazy>,
    schema: SchemaRef,
    parts: Vec<RecordBatch>,
    bytes: usize,
}

impl Rows {
    fn push(&mut self, batch: &RecordBatch, rows: Vec<u64>) -> Result<(), DataFusionError> {
        if !rows.is_empty() {
            // A copy: what it is taken from holds the rows of others, too.
            let part = take_record_batch(batch, &UInt64Array::from(rows))?;
            self.bytes += part.get_array_memory_size();
            self.parts.push(part);
        }
        Ok(())
    }

    /// All rows, in the order of time.
    fn sorted(&self) -> Result<RecordBatch, DataFusionError> {
        let all = concat_batches(&self.schema, &self.parts)?;
        let times = all.column(self.place(TIME));
        Ok(take_record_batch(
            &all,
            &sort_to_indices(times, None, None)?,
        )?)
    }

    /// Index of a column in the arguments.
    fn place(&self, column: usize) -> usize {
        column + usize::from(self.kind == Kind::DaysUntil)
    }

    /// Returns the requested limit, m.
    fn limit_m(&self, rows: &RecordBatch) -> Result<Option<f64>, FleetError> {
        if self.kind != Kind::DaysUntil {
            return Ok(None);
        }
        let given = rows.column(0).as_primitive::<Float64Type>();
        let invalid = |found: String| FleetError::NoLimit {
            function: self.kind.name(),
            found,
        };
        let mut limits = given.iter();
        let first = limits.next().flatten();
        if let Some(other) = limits.find(|limit| *limit != first) {
            let text = |limit: Option<f64>| limit.map_or("unknown".to_owned(), |mm| mm.to_string());
            return Err(invalid(format!("{} and {}", text(first), text(other))));
        }
        match first {
            Some(mm) if !(mm > 0.0 && mm.is_finite()) => Err(invalid(mm.to_string())),
            limit => Ok(limit.map(|mm| 1e-3 * mm)),
        }
    }

    fn found(&self, metadata: &FleetMetadata) -> Result<Found, DataFusionError> {
        let rows = self.sorted()?;
        if rows.num_rows() == 0 {
            return Ok(Found::Nothing);
        }
        let limit_m = self.limit_m(&rows).map_err(external)?;
        let first = self.place(0);
        let columns: Vec<usize> = (first..first + sessions::COLUMNS.len()).collect();
        let tendons = sessions::sessions(&[rows.project(&columns)?]).map_err(external)?;
        if let [a, b, ..] = &tendons[..] {
            let text = |s: &Sessions| format!("{} {}", s.tendon.0, s.tendon.1);
            return Err(external(FleetError::SeveralTendons {
                function: self.kind.name(),
                tendons: [text(a), text(b)],
            }));
        }
        let Some(sessions) = tendons.first() else {
            return Ok(Found::Nothing);
        };
        let mut robot = metadata.robot(sessions).cloned();
        if let (Some(robot), Some(limit_m)) = (&mut robot, limit_m) {
            for transmission in robot.transmissions.iter_mut().flatten() {
                if let Some(tendon) = &mut transmission.tendon {
                    (tendon.retension_at_m, tendon.replace_at_strain) = (Some(limit_m), None);
                }
            }
        }
        Ok(match metadata.trend(sessions, robot.as_ref(), None) {
            Ok(followed) => Found::Trend(Box::new(followed.trend), sessions.rows.len()),
            Err(error) => Found::Failed(error.to_string()),
        })
    }
}

/// Result of the records of a tendon.
enum Found {
    Nothing,
    Failed(String),
    /// Trend and number of sessions.
    Trend(Box<JointTrend>, usize),
}

impl Accumulator for Rows {
    fn update_batch(&mut self, values: &[ArrayRef]) -> Result<(), DataFusionError> {
        let batch = RecordBatch::try_new(self.schema.clone(), values.to_vec())?;
        // Sessions without a UTC date or without an interval are not part of a trend.
        let clocks = values[self.place(CLOCK)].as_string::<i32>();
        let offsets = &values[self.place(OFFSET)];
        let stds = values[self.place(STD)].as_primitive::<Float64Type>();
        let counts = |row: &usize| {
            let row = *row;
            clocks.is_valid(row)
                && clocks.value(row) == "utc"
                && offsets.is_valid(row)
                && stds.is_valid(row)
                && stds.value(row) > 0.0
        };
        let rows = (0..batch.num_rows()).filter(counts).map(|row| row as u64);
        self.push(&batch, rows.collect())
    }

    fn evaluate(&mut self) -> Result<ScalarValue, DataFusionError> {
        let metadata = self.lazy.get()?;
        let found = self.found(&metadata)?;
        let columns = match self.kind {
            Kind::Trend => trend_columns(&found),
            Kind::DaysUntil => days_columns(&found),
        };
        let row = StructArray::try_new(self.kind.fields(), columns, None)?;
        Ok(ScalarValue::Struct(Arc::new(row)))
    }

    fn size(&self) -> usize {
        size_of_val(self) + self.bytes
    }

    fn state(&mut self) -> Result<Vec<ScalarValue>, DataFusionError> {
        let all = concat_batches(&self.schema, &self.parts)?;
        let rows: ArrayRef = Arc::new(StructArray::from(all));
        Ok(vec![
            SingleRowListArrayBuilder::new(rows).build_list_scalar(),
        ])
    }

    fn merge_batch(&mut self, states: &[ArrayRef]) -> Result<(), DataFusionError> {
        for rows in states[0].as_list::<i32>().iter().flatten() {
            let batch = RecordBatch::from(rows.as_struct());
            let batch = batch.with_schema(self.schema.clone())?;
            let all = (0..batch.num_rows() as u64).collect();
            self.push(&batch, all)?;
        }
        Ok(())
    }
}

fn text(value: Option<&str>) -> ArrayRef {
    Arc::new(StringArray::from(vec![value]))
}

fn number(value: Option<f64>) -> ArrayRef {
    Arc::new(Float64Array::from(vec![value.filter(|x| x.is_finite())]))
}

fn count(value: Option<usize>) -> ArrayRef {
    Arc::new(Int64Array::from(vec![
        value.and_then(|n| i64::try_from(n).ok()),
    ]))
}

fn pair(value: Option<Gaussian>) -> [ArrayRef; 2] {
    [number(value.map(|v| v.mean)), number(value.map(|v| v.std))]
}

fn failure(found: &Found) -> ArrayRef {
    text(match found {
        Found::Failed(reason) => Some(reason),
        _ => None,
    })
}

/// In the order of [`Kind::fields`].
fn trend_columns(found: &Found) -> Vec<ArrayRef> {
    let (trend, sessions) = match found {
        Found::Trend(trend, sessions) => (Some(trend), Some(*sessions)),
        _ => (None, None),
    };
    let steps = trend.map(|t| t.events.iter().filter(|e| TrendEvent::is_jump(e)).count());
    let mut out = vec![text(trend.map(|t| t.verdict.name()))];
    out.extend(pair(trend.map(|t| t.offset_rad)));
    out.extend(pair(trend.and_then(|t| t.elongation_m)));
    out.extend(pair(trend.map(|t| t.rate_rad_per_s)));
    out.extend([count(steps), count(sessions)]);
    out.push(number(trend.map(|t| t.tensioned_utc_s)));
    out.push(number(trend.map(|t| t.last_utc_s)));
    out.push(failure(found));
    out
}

/// In the order of [`Kind::fields`]; days from the tendon's last session.
fn days_columns(found: &Found) -> Vec<ArrayRef> {
    let worst = match found {
        Found::Trend(trend, _) => {
            let passages = Passage::all(trend);
            Passage::first(&passages).map(|p| (*p, trend.last_utc_s))
        }
        _ => None,
    };
    let days = |i: usize| {
        worst.and_then(|(passage, last_utc_s)| Some((passage.at_utc_s[i]? - last_utc_s) / DAY_S))
    };
    vec![
        text(worst.map(|(p, _)| p.limit.name())),
        text(worst.map(|(p, _)| p.state.name())),
        number(days(0)),
        number(days(1)),
        number(days(2)),
        failure(found),
    ]
}
