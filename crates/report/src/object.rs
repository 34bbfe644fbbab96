//! What all JSON objects have in common: their version, and errors with their place.

use palmistry_lang::ReadError;
use palmistry_prove::claim::Outcome;
use serde_json::{Value, json};

/// The version of all objects that are printed and written as JSON: another one where a field goes, or means something else. A
/// field that is added is no other version. `book/src/json.md` lists the fields.
const JSON_VERSION: u32 = 4;

/// An object with its version.
pub fn versioned(mut object: Value) -> Value {
    object["version"] = json!(JSON_VERSION);
    object
}

/// What is wrong with a file, and where, as one object: code, message, file, line and column, both counted from one.
pub fn read_error_json(error: &ReadError) -> Value {
    let (line, column) = error.line_and_column();
    let mut object = json!({
        "code": error.code.id(),
        "message": error.message,
        "file": error.source_code.name(),
        "line": line,
        "column": column,
    });
    if let Some(help) = &error.help {
        object["help"] = json!(help);
    }
    object
}

/// What was decided of some claims, each as an object, and whether all is as expected; `interrupted` where not all were decided.
pub fn claims_json(
    outcomes: &[Outcome],
    claim: impl Fn(&Outcome) -> Value,
    seed: u64,
    seconds: f64,
    interrupted: bool,
) -> Value {
    json!({
        "ok": outcomes.iter().all(|outcome| outcome.ok) && !interrupted,
        "interrupted": interrupted,
        "seed": seed,
        "seconds": seconds,
        "claims": outcomes.iter().map(claim).collect::<Vec<_>>(),
    })
}
