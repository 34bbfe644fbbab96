//! Answers that are kept as they are told.

use crate::answers::printed;
use pyo3::prelude::*;
use serde_json::Value;

/// An answer: the object that the program prints, its text, and where there is one its page.
#[pyclass(frozen, module = "palmistry._native")]
pub struct Told {
    json: String,
    text: String,
    page: Option<String>,
}

impl Told {
    pub fn new(object: Value, text: String) -> Told {
        Told { json: printed(object), text, page: None }
    }

    pub fn with_page(self, page: String) -> Told {
        Told { page: Some(page), ..self }
    }
}

#[pymethods]
impl Told {
    fn json(&self) -> &str {
        &self.json
    }

    fn text(&self) -> &str {
        &self.text
    }

    /// The whole page; none where there is none.
    fn page(&self) -> Option<&str> {
        self.page.as_deref()
    }
}
