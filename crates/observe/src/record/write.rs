//! Writes a record, whole or not at all: see [`palmistry_io::file`].

#[cfg(feature = "parquet")]
use super::parquet_file;
use super::{Record, RecordError, comma_separated};
use palmistry_io::file::write_whole;
use std::path::Path;

/// The name of standard output, which has no extension: there a record is comma-separated values.
const STANDARD_OUTPUT: &str = "-";

pub(super) fn write(record: &Record, path: &Path) -> Result<(), RecordError> {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let written = match extension.as_deref() {
        Some("csv") => write_whole(path, |file| comma_separated::write(record, file)),
        #[cfg(feature = "parquet")]
        Some("parquet") => write_whole(path, |file| parquet_file::write(record, file)),
        #[cfg(not(feature = "parquet"))]
        Some("parquet") => return Err(RecordError::NoParquet { path: path.to_owned() }),
        None if path == Path::new(STANDARD_OUTPUT) => {
            write_whole(path, |file| comma_separated::write(record, file))
        }
        _ => return Err(RecordError::Extension { path: path.to_owned() }),
    };
    written.map_err(|error| RecordError::Unwritable { path: path.to_owned(), why: error.to_string() })
}
