//! Why a record could not be read or written.

use super::Fault;
use miette::Diagnostic;
use std::path::PathBuf;

/// How many faults an error lists before it says how many more there are.
const LISTED: usize = 8;

/// A record that could not be used: what, where, and what to do.
#[derive(Debug, Diagnostic, thiserror::Error)]
pub enum RecordError {
    /// The file cannot be opened or read as what its extension says.
    #[error("cannot read {}: {why}", path.display())]
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
    #[error("cannot write {}: {why}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        why: String,
    },
    /// The extension names no format of records.
    #[error("{} is neither a .csv nor a .parquet file", path.display())]
    #[diagnostic(help("a record's format is told by its extension: name it .csv or .parquet"))]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// A Parquet file, where the crate was built without them.
    #[error("{} is a Parquet file, and this build has no Parquet", path.display())]
    #[diagnostic(help("build it with the feature 'parquet', or keep records as .csv"))]
    NoParquet {
        /// The file.
        path: PathBuf,
    },
    /// The header names no columns that can be used.
    #[error("the header of {} cannot be used: {why}", path.display())]
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
    #[error("{} has no column '{column}'", path.display())]
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
    #[error("{} has no rows", path.display())]
    #[diagnostic(help("a record has one row a sample below its header"))]
    NoRows {
        /// The file.
        path: PathBuf,
    },
    /// The file has faulty rows, and the rules say to stop.
    #[error("{}", faulty(path, faults))]
    #[diagnostic(help("mend the rows, or let faulty rows be skipped (on_fault = \"skip\" in the scene)"))]
    Faulty {
        /// The file.
        path: PathBuf,
        /// All the faults.
        faults: Vec<Fault>,
    },
    /// Nothing is left when the faulty rows are skipped.
    #[error("{} has no row without fault\n{}", path.display(), listed(faults))]
    #[diagnostic(help("the columns may be in another order than the header says"))]
    NothingLeft {
        /// The file.
        path: PathBuf,
        /// All the faults.
        faults: Vec<Fault>,
    },
    /// A column has another length than the times.
    #[error("column '{column}' has {found} values, but there are {expected} times")]
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
    #[error("a column cannot be called '{column}': the name is empty, there twice, or that of the times")]
    #[diagnostic(help("give every column a name of its own other than 'time'"))]
    Name {
        /// The name.
        column: String,
    },
}

fn faulty(path: &std::path::Path, faults: &[Fault]) -> String {
    let count = match faults.len() {
        1 => "one fault".to_owned(),
        count => format!("{count} faults"),
    };
    format!("{} has {count}\n{}", path.display(), listed(faults))
}

fn listed(faults: &[Fault]) -> String {
    let mut lines: Vec<String> = faults.iter().take(LISTED).map(Fault::to_string).collect();
    if faults.len() > LISTED {
        lines.push(format!("and {} more", faults.len() - LISTED));
    }
    lines.join("\n")
}
