//! `sinew_elongation_mm`: an offset as length of rope.

use super::Lazy;
use crate::metadata::tendon_of;
use datafusion::arrow::array::{Array as _, AsArray as _, Float64Array};
use datafusion::arrow::datatypes::{DataType, Float64Type};
use datafusion::error::DataFusionError;
use datafusion::logical_expr::{
    ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility,
};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// Offset times pulley radius of the joint; null without a description of the robot type or without a tendon.
#[derive(Debug)]
pub(super) struct Elongation {
    lazy: Arc<Lazy>,
    signature: Signature,
}

impl Elongation {
    pub(super) fn new(lazy: Arc<Lazy>) -> Self {
        let types = vec![DataType::Float64, DataType::Utf8, DataType::Utf8];
        Self {
            lazy,
            signature: Signature::exact(types, Volatility::Stable),
        }
    }
}

// One of it is known to an engine.
impl PartialEq for Elongation {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.lazy, &other.lazy)
    }
}

impl Eq for Elongation {}

impl Hash for Elongation {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name().hash(state);
    }
}

impl ScalarUDFImpl for Elongation {
    fn name(&self) -> &str {
        "sinew_elongation_mm"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType, DataFusionError> {
        Ok(DataType::Float64)
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue, DataFusionError> {
        let metadata = self.lazy.get()?;
        let columns = ColumnarValue::values_to_arrays(&args.args)?;
        let offsets = columns[0].as_primitive::<Float64Type>();
        let (types, joints) = (columns[1].as_string::<i32>(), columns[2].as_string::<i32>());
        let radius_m = |row: usize| {
            if types.is_null(row) || joints.is_null(row) {
                return None;
            }
            let robot = metadata.robot_type(types.value(row))?;
            Some(tendon_of(robot, joints.value(row))?.joint_pulley_radius_m)
        };
        // Rows of a tendon follow each other, mostly.
        let mut last: Option<(usize, Option<f64>)> = None;
        let mut out = Vec::with_capacity(offsets.len());
        for row in 0..offsets.len() {
            let same = last.filter(|(at, _)| {
                types.is_valid(*at)
                    && types.is_valid(row)
                    && joints.is_valid(*at)
                    && joints.is_valid(row)
                    && types.value(*at) == types.value(row)
                    && joints.value(*at) == joints.value(row)
            });
            let radius = same.map_or_else(|| radius_m(row), |(_, radius)| radius);
            last = Some((row, radius));
            let offset = offsets.is_valid(row).then(|| offsets.value(row));
            out.push(offset.zip(radius).map(|(rad, m)| 1e3 * rad * m));
        }
        Ok(ColumnarValue::Array(Arc::new(Float64Array::from(out))))
    }
}
