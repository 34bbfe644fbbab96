//! Why a record cannot be read or written.

use super::{Fault, FaultKind, MOST_FAULTS};
use miette::Diagnostic;
use palmistry_io::foreign::{shown, shown_path};
use std::path::PathBuf;

/// How many faults an error lists before it says how many more there are.
const LISTED: usize = 8;

/// A record that could not be used: what, where, and what to do.
#[derive(Debug, Diagnostic, thiserror::Error)]
pub enum RecordError {
    /// The file cannot be opened or read as what its extension says.
    #[error("cannot read {}: {why}", shown_path(path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system or the format's reader says.
        why: String,
        /// What to do.
        #[help]
        help: Option<String>,
    },
    /// The file cannot be written.
    #[error("cannot write {}: {why}", shown_path(path))]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        why: String,
    },
    /// The extension names no format of records.
    #[error("{} is neither a .csv nor a .parquet file", shown_path(path))]
    #[diagnostic(help("a record's format is given by its extension: name it .csv or .parquet"))]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// A Parquet file, where the crate was built without them.
    #[error("{} is a Parquet file, and this build has no Parquet", shown_path(path))]
    #[diagnostic(help("build it with the feature 'parquet', or keep records as .csv"))]
    NoParquet {
        /// The file.
        path: PathBuf,
    },
    /// The header names no columns that can be used.
    #[error("the header of {} cannot be used: {}", shown_path(path), shown(why))]
    Header {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
        /// What to do.
        #[help]
        help: String,
    },
    /// A column that is needed is not there.
    #[error("{} has no column '{}'", shown_path(path), shown(column))]
    Column {
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
        /// The columns that are there.
        #[help]
        help: String,
    },
    /// A header and nothing below it.
    #[error("{} has no rows", shown_path(path))]
    #[diagnostic(help("a record has one row a sample below its header"))]
    NoRows {
        /// The file.
        path: PathBuf,
    },
    /// The file has faulty rows, and the rules say to stop.
    #[error("{}", faulty(path, faults))]
    #[diagnostic(help("{}", what_to_do(faults)))]
    Faulty {
        /// The file.
        path: PathBuf,
        /// All the faults; where there are too many, as many as are looked for.
        faults: Vec<Fault>,
    },
    /// Nothing is left when the faulty rows are skipped.
    #[error("{} has no row without fault\n{}", shown_path(path), listed(faults))]
    #[diagnostic(help("the columns may be in another order than the header says"))]
    NothingLeft {
        /// The file.
        path: PathBuf,
        /// All the faults.
        faults: Vec<Fault>,
    },
    /// Nothing was measured of a column that is needed, while what drives the model is known.
    #[error(
        "{}: nothing was measured of the column '{}', or not while what drives the model is known",
        shown_path(path),
        shown(column)
    )]
    #[diagnostic(help("an empty cell says that nothing was measured then; is it the right column?"))]
    NotMeasured {
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
    },
    /// A column has another length than the times.
    #[error("column '{}' has {found} values, but there are {expected} times", shown(column))]
    #[diagnostic(help("give every column one value for each time"))]
    Length {
        /// The column.
        column: String,
        /// Its length.
        found: usize,
        /// The number of times.
        expected: usize,
    },
    /// A column's name is empty, taken, or that of the times.
    #[error(
        "a column cannot be called '{}': the name is empty, there twice, or that of the times",
        shown(column)
    )]
    #[diagnostic(help("give every column a name of its own other than 'time'"))]
    Name {
        /// The name.
        column: String,
    },
}

fn what_to_do(faults: &[Fault]) -> &'static str {
    let surplus = faults.iter().filter(|fault| matches!(fault.kind, FaultKind::Surplus { .. })).count();
    let disorder = faults.iter().filter(|fault| matches!(fault.kind, FaultKind::OutOfOrder)).count();
    match faults.len() > MOST_FAULTS {
        // of most rows it is no slip
        _ if surplus > 1 && 3 * surplus > faults.len() => {
            "a decimal point is written '.', as in 0.5: commas separate columns; or the header names too few columns"
        }
        _ if disorder > 1 && 2 * disorder > faults.len() => {
            "times increase from row to row: sort the rows by time, or see whether this is the column of times"
        }
        true => "mend the file: of so many faults not all are known, so that no row is skipped",
        false => "mend the rows, or let faulty rows be skipped (on_fault = \"skip\" in the scene)",
    }
}

fn faulty(path: &std::path::Path, faults: &[Fault]) -> String {
    let count = match faults.len() {
        1 => "one fault".to_owned(),
        count if count > MOST_FAULTS => format!("more than {MOST_FAULTS} faults"),
        count => format!("{count} faults"),
    };
    format!("{} has {count}\n{}", shown_path(path), listed(faults))
}

fn listed(faults: &[Fault]) -> String {
    let mut lines: Vec<String> = faults.iter().take(LISTED).map(Fault::to_string).collect();
    if faults.len() > MOST_FAULTS {
        lines.push("and more".to_owned());
    } else if faults.len() > LISTED {
        lines.push(format!("and {} more", faults.len() - LISTED));
    }
    lines.join("\n")
}
