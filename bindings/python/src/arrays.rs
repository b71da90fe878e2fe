//! NumPy arrays as a recording: rows are copied block by block, never all together.

use crate::failure::Failure;
use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew_log::{Arrays, Quantities, Quantity};
use std::sync::Arc;

/// Arrays owned by Python, one row per sample.
pub(crate) struct Held {
    joints: Vec<String>,
    rows: usize,
    time_ns: Py<PyArray1<i64>>,
    /// `(rows, joints)` each.
    by_joint: Vec<(Quantity, Py<PyArray2<f64>>)>,
    temperature_c: Option<Py<PyArray1<f64>>>,
}

impl Held {
    /// Combines arrays of equal number of rows.
    pub(crate) fn new<'py>(
        joints: Vec<String>,
        time_ns: &Bound<'py, PyArray1<i64>>,
        by_joint: Vec<(Quantity, Bound<'py, PyArray2<f64>>)>,
        temperature_c: Option<Bound<'py, PyArray1<f64>>>,
    ) -> Result<Self, Failure> {
        let rows = time_ns.len();
        for (quantity, array) in &by_joint {
            let (found, symbol) = (array.shape(), quantity.symbol());
            let needed = [rows, joints.len()];
            if found != needed {
                return Err(Failure::new(format!(
                    "{symbol} has the shape {found:?}; {needed:?} is needed: a row per time, a column per joint ({})",
                    joints.join(", ")
                )));
            }
        }
        if let Some(found) = temperature_c
            .as_ref()
            .map(|t| t.len())
            .filter(|n| *n != rows)
        {
            return Err(Failure::new(format!(
                "temperature_c has {found} values, expected {rows} (one per time)"
            )));
        }
        Ok(Self {
            joints,
            rows,
            time_ns: time_ns.clone().unbind(),
            by_joint: (by_joint.into_iter())
                .map(|(quantity, array)| (quantity, array.unbind()))
                .collect(),
            temperature_c: temperature_c.map(Bound::unbind),
        })
    }

    /// The arrays by the keywords of `from_arrays`.
    pub(crate) fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let out = PyDict::new(py);
        out.set_item("joints", &self.joints)?;
        out.set_item("time_ns", &self.time_ns)?;
        for (quantity, array) in &self.by_joint {
            out.set_item(quantity.symbol(), array)?;
        }
        if let Some(array) = &self.temperature_c {
            out.set_item("temperature_c", array)?;
        }
        Ok(out)
    }
}

/// Reader of arrays in memory.
pub(crate) struct Reader(pub(crate) Arc<Held>);

/// Error message for an array that is being written from Rust.
fn busy(what: &str) -> String {
    format!("{what} is modified by another call; wait until it has finished")
}

/// Number of available rows of an array, which a resize may have reduced.
fn rows<'a>(
    array: &'a PyReadonlyArray2<'_, f64>,
    from: usize,
    count: usize,
) -> Option<impl Iterator<Item = f64> + 'a> {
    let view = array.as_array();
    (view.nrows() >= from + count).then(|| {
        let width = view.ncols();
        (from..from + count).flat_map(move |row| (0..width).map(move |column| view[[row, column]]))
    })
}

fn items<'a, T: numpy::Element + Copy>(
    array: &'a PyReadonlyArray1<'_, T>,
    from: usize,
    count: usize,
) -> Option<impl Iterator<Item = T> + 'a> {
    let view = array.as_array();
    (view.len() >= from + count).then(|| (from..from + count).map(move |row| view[row]))
}

fn fill<T>(into: &mut [T], values: Option<impl Iterator<Item = T>>) -> Result<(), String> {
    let values = values.ok_or("an array has been shortened since the recording was created")?;
    into.iter_mut()
        .zip(values)
        .for_each(|(into, value)| *into = value);
    Ok(())
}

impl Arrays for Reader {
    fn joints(&self) -> &[String] {
        &self.0.joints
    }

    fn quantities(&self) -> Quantities {
        let mut all = Quantities::default();
        self.0
            .by_joint
            .iter()
            .for_each(|(quantity, _)| all.insert(*quantity));
        all.temperature = self.0.temperature_c.is_some();
        all
    }

    fn rows(&self) -> u64 {
        self.0.rows as u64
    }

    fn times_ns(&mut self, from: u64, into: &mut [i64]) -> Result<(), String> {
        Python::attach(|py| {
            let array = self.0.time_ns.bind(py).try_readonly();
            let array = array.map_err(|_| busy("time_ns"))?;
            let count = into.len();
            fill(into, items(&array, from as usize, count))
        })
    }

    fn values(&mut self, quantity: Quantity, from: u64, into: &mut [f64]) -> Result<(), String> {
        Python::attach(|py| {
            let (from, n) = (from as usize, self.0.joints.len().max(1));
            if quantity == Quantity::Temperature {
                let Some(array) = &self.0.temperature_c else {
                    return Err("the recording has no temperature".into());
                };
                let array = array.bind(py).try_readonly();
                let array = array.map_err(|_| busy("temperature_c"))?;
                let count = into.len();
                return fill(into, items(&array, from, count));
            }
            let found = self.0.by_joint.iter().find(|(known, _)| *known == quantity);
            let Some((_, array)) = found else {
                return Err(format!("there is no {}", quantity.symbol()));
            };
            let array = array.bind(py).try_readonly();
            let array = array.map_err(|_| busy(quantity.symbol()))?;
            let count = into.len() / n;
            fill(into, rows(&array, from, count))
        })
    }
}
