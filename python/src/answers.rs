//! What was found, kept until somebody asks for it as JSON, as text or as a page.

use numpy::PyArray1;
use palmistry::certificate::RegionAnswer;
use palmistry::checker::{VerdictFile, VerdictRecord};
use palmistry::observer::Record;
use palmistry::report::{
    ClaimsForm, ClaimsSummary, Layout, Shown, claim_json, claims_html, claims_json, claims_text, rank_html,
    rank_json, rank_text, region_curve, region_json, region_map, region_text, versioned,
};
use palmistry::sweep::StateRow;
use palmistry::{Outcome, RankAnswer};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};

/// An object as the program prints it.
pub fn printed(object: Value) -> String {
    serde_json::to_string_pretty(&versioned(object)).unwrap_or_default()
}

/// Records as a verdict file.
fn verdict_file(py: Python<'_>, seed: u64, records: Vec<VerdictRecord>) -> PyResult<String> {
    let text = VerdictFile::new(seed, records).text();
    text.map_err(|why| crate::errors::unusable(py, &why.to_string(), None))
}

/// The claims of a system, decided.
#[pyclass(frozen, module = "palmistry._native")]
pub struct ClaimsFound {
    pub outcomes: Vec<Outcome>,
    /// How many were asked for.
    pub asked: usize,
    pub seed: u64,
    pub seconds: f64,
    /// Whether what the verdicts rest on was kept.
    pub has_evidence: bool,
}

impl ClaimsFound {
    fn is_cut(&self) -> bool {
        self.outcomes.len() < self.asked
    }
}

#[pymethods]
impl ClaimsFound {
    fn json(&self) -> String {
        printed(claims_json(&self.outcomes, claim_json, self.seed, self.seconds, self.is_cut()))
    }

    fn text(&self) -> String {
        let summary = ClaimsSummary { claims: Some(self.asked), seconds: self.seconds };
        let form = ClaimsForm { shown: Shown::All, latex: false };
        claims_text(&self.outcomes, summary, form, &Layout::default())
    }

    fn html(&self) -> String {
        claims_html(&self.outcomes)
    }

    /// What the verdicts rest on, as a verdict file.
    fn verdicts(&self, py: Python<'_>) -> PyResult<String> {
        if !self.has_evidence {
            let message = "what the verdicts rest on was not kept";
            return Err(crate::errors::unusable(py, message, Some("ask prove(evidence=True)")));
        }
        let records = self.outcomes.iter().flat_map(|outcome| outcome.evidence.iter().cloned());
        verdict_file(py, self.seed, records.collect())
    }
}

/// The answer to a question about a rank, and a row for each state where these were asked for.
#[pyclass(frozen, module = "palmistry._native")]
pub struct RankFound {
    pub answer: RankAnswer,
    pub rows: Option<Vec<(usize, StateRow)>>,
    pub coordinates: Vec<String>,
}

#[pymethods]
impl RankFound {
    fn json(&self) -> String {
        printed(rank_json(&self.answer))
    }

    fn text(&self) -> String {
        rank_text(&self.answer, false)
    }

    fn html(&self) -> String {
        rank_html(&self.answer)
    }

    /// The columns of the table of states; none where it was not asked for.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(rows) = &self.rows else { return Ok(None) };
        let columns = PyDict::new(py);
        let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
        columns.set_item("index", PyArray1::from_iter(py, rows.iter().map(|(_, row)| row.index)))?;
        let ranks = rows.iter().map(|(_, row)| row.rank.map_or(-1, |rank| rank as i64));
        columns.set_item("rank", PyArray1::from_iter(py, ranks))?;
        columns.set_item("certified", PyArray1::from_iter(py, rows.iter().map(|(_, row)| row.certified)))?;
        let smallest = rows.iter().map(|(_, row)| number(row.smallest_singular_value));
        columns.set_item("smallest_singular_value", PyArray1::from_iter(py, smallest))?;
        let conditions = rows.iter().map(|(_, row)| number(row.condition));
        columns.set_item("condition", PyArray1::from_iter(py, conditions))?;
        if self.answer.branches.len() > 1 {
            let branches = rows.iter().map(|(branch, _)| *branch as i64 + 1);
            columns.set_item("branch", PyArray1::from_iter(py, branches))?;
        }
        for (place, name) in self.coordinates.iter().enumerate() {
            let values = rows.iter().map(|(_, row)| row.coordinates.get(place).copied().unwrap_or(f64::NAN));
            columns.set_item(name, PyArray1::from_iter(py, values))?;
        }
        Ok(Some(columns))
    }
}

/// How far full rank was proved.
#[pyclass(frozen, module = "palmistry._native")]
pub struct CertificateFound {
    pub answer: RegionAnswer,
    pub units: [Option<String>; 2],
    pub interrupted: bool,
}

#[pymethods]
impl CertificateFound {
    fn json(&self) -> String {
        let mut object = region_json(&self.answer);
        object["interrupted"] = json!(self.interrupted);
        printed(object)
    }

    fn text(&self) -> String {
        region_text(&self.answer)
    }

    /// The picture of the proved fraction over the boxes, as SVG.
    fn curve(&self) -> String {
        region_curve(&self.answer, &self.answer.title)
    }

    /// The picture of what is proved over two coordinates, as SVG; none where there is no map.
    fn map(&self) -> Option<String> {
        let units = [self.units[0].as_deref(), self.units[1].as_deref()];
        self.answer.map.as_ref().map(|map| region_map(map, &self.answer.title, units))
    }
}

/// A record as columns.
pub fn columns<'py>(py: Python<'py>, record: &Record) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    columns.set_item(record.first_name(), PyArray1::from_slice(py, record.times()))?;
    for name in record.names() {
        columns.set_item(name, PyArray1::from_slice(py, record.column(name).unwrap_or_default()))?;
    }
    Ok(columns)
}
