//! States that are handed over as arrays of doubles, and what is decided of each.

use crate::errors::unusable;
use crate::work::interruptible_here;
use numpy::{PyArray1, PyReadonlyArray1};
use palmistry::System;
use palmistry::sweep::{GivenStates, StateRow, StatesError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Rows that are made ready, and the names of the coordinates that a state has.
#[pyclass(frozen, module = "palmistry._native")]
pub struct StatesDecider {
    states: GivenStates,
    names: Vec<String>,
}

/// What is told of some states, a column each.
#[derive(Default)]
struct Columns {
    rank: Vec<i64>,
    certified: Vec<bool>,
    smallest: Vec<f64>,
    condition: Vec<f64>,
}

impl Columns {
    fn of(rows: Vec<StateRow>) -> Columns {
        let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Columns {
            rank: rows.iter().map(|row| row.rank.map_or(-1, |rank| rank as i64)).collect(),
            certified: rows.iter().map(|row| row.certified).collect(),
            smallest: rows.iter().map(|row| number(row.smallest_singular_value)).collect(),
            condition: rows.iter().map(|row| number(row.condition)).collect(),
        }
    }

    fn joined(chunks: Vec<Columns>) -> Columns {
        let mut all = Columns::default();
        for chunk in chunks {
            all.rank.extend(chunk.rank);
            all.certified.extend(chunk.certified);
            all.smallest.extend(chunk.smallest);
            all.condition.extend(chunk.condition);
        }
        all
    }
}

impl StatesDecider {
    pub fn new(system: &System, states: GivenStates) -> StatesDecider {
        let names = states.coordinates().iter().map(|symbol| system.symbol_name(*symbol).to_owned());
        StatesDecider { names: names.collect(), states }
    }
}

#[pymethods]
impl StatesDecider {
    /// The names of the coordinates, in the order in which their arrays are handed over.
    #[getter]
    fn coordinates(&self) -> Vec<String> {
        self.names.clone()
    }

    /// Decides states: an array a coordinate, contiguous doubles, which are not copied.
    fn verdicts<'py>(
        &self,
        py: Python<'py>,
        states: Vec<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let slices: Vec<&[f64]> = states.iter().map(|array| array.as_slice()).collect::<Result<_, _>>()?;
        let found = interruptible_here(py, |interrupt| {
            let chunks = self.states.decide_by_chunks(&slices, interrupt, Columns::of)?;
            Ok::<_, StatesError>(chunks.map(Columns::joined))
        })?;
        let found = found.map_err(|why| unusable(py, &why.to_string(), None))?;
        // who was interrupted has been told so above
        let found = found.unwrap_or_default();
        let columns = PyDict::new(py);
        columns.set_item("rank", PyArray1::from_vec(py, found.rank))?;
        columns.set_item("certified", PyArray1::from_vec(py, found.certified))?;
        columns.set_item("smallest_singular_value", PyArray1::from_vec(py, found.smallest))?;
        columns.set_item("condition", PyArray1::from_vec(py, found.condition))?;
        Ok(columns)
    }
}
