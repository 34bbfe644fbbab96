//! Errors of the library as exceptions of the package, which carry the diagnostic with its place.

use palmistry::claim::EvaluationError;
use palmistry::system::GivenError;
use palmistry::{ReadError, ValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// An exception of the package, by the name of its class.
fn exception(py: Python<'_>, class: &str, fill: impl FnOnce(&Bound<'_, PyDict>) -> PyResult<()>) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let class = py.import("palmistry.errors")?.getattr(class)?;
        let fields = PyDict::new(py);
        fill(&fields)?;
        Ok(PyErr::from_value(class.call((), Some(&fields))?))
    };
    made().unwrap_or_else(|why| why)
}

/// What is wrong, in words, and what to do.
pub fn unusable(py: Python<'_>, message: &str, help: Option<&str>) -> PyErr {
    exception(py, "Error", |fields| {
        fields.set_item("message", message)?;
        fields.set_item("help", help)
    })
}

/// What is wrong with a text, and where in it.
pub fn unreadable(py: Python<'_>, error: &ReadError) -> PyErr {
    let (line, column) = error.line_and_column();
    let source = error.source_code.inner();
    let (begin, length) = (error.span.offset(), error.span.len());
    let marked = source.get(begin..begin + length).unwrap_or_default();
    exception(py, "ReadError", |fields| {
        fields.set_item("message", &error.message)?;
        fields.set_item("help", error.help.as_deref())?;
        fields.set_item("code", error.code.id())?;
        fields.set_item("file", error.source_code.name())?;
        fields.set_item("line", line)?;
        fields.set_item("column", column)?;
        fields.set_item("text", source.lines().nth(line - 1).unwrap_or_default())?;
        fields.set_item("marked", marked)?;
        fields.set_item("label", &error.label)
    })
}

/// What is wrong with a value that was given.
pub fn given(py: Python<'_>, error: &GivenError) -> PyErr {
    unusable(py, &error.message, error.help.as_deref().filter(|help| !help.contains("--")))
}

/// Why an expression has no value.
pub fn no_value(py: Python<'_>, error: &EvaluationError) -> PyErr {
    let help = match error {
        EvaluationError::Read(error) => return unreadable(py, error),
        EvaluationError::Value(ValueError::Missing(name)) => {
            Some(format!("give it one: at={{'{name}': ...}}"))
        }
        EvaluationError::Value(ValueError::Pole(_) | ValueError::NearPole { .. }) => {
            Some("choose another point, or claim the order in the file: pole(e, factor) = n".to_owned())
        }
        EvaluationError::Value(_) => None,
        EvaluationError::NoValue(_) => Some("ask rank(), or claim it in the file".to_owned()),
        EvaluationError::NotRational(_) => {
            Some("a rank at a point is exact: give angles only where sines are rational".to_owned())
        }
    };
    exception(py, "EvaluationError", |fields| {
        fields.set_item("message", error.to_string())?;
        fields.set_item("help", help)
    })
}
