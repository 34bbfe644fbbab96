//! Writes a file aside and moves it into place, so that it is whole or not there.

use super::{Record, RecordError, comma_separated, parquet_file};
use std::io::{BufWriter, Write};
use std::path::Path;

pub(super) fn write(record: &Record, path: &Path) -> Result<(), RecordError> {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let complain = |why: String| RecordError::Unwritable { path: path.to_owned(), why };
    match extension.as_deref() {
        Some("csv") => aside(path, |file| comma_separated::write(record, file)).map_err(complain),
        Some("parquet") => aside(path, |file| parquet_file::write(record, file)).map_err(complain),
        _ => Err(RecordError::Extension { path: path.to_owned() }),
    }
}

/// What a format's writer writes to.
pub(super) type File<'a> = BufWriter<&'a mut tempfile::NamedTempFile>;

fn aside(path: &Path, fill: impl FnOnce(&mut File) -> Result<(), String>) -> Result<(), String> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(|e| e.to_string())?;
    let mut file = builder().tempfile_in(folder).map_err(|e| e.to_string())?;
    let mut writer = BufWriter::new(&mut file);
    fill(&mut writer)?;
    writer.flush().map_err(|e| e.to_string())?;
    drop(writer);
    file.persist(path).map_err(|e| e.error.to_string())?;
    Ok(())
}

fn builder() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".palmistry-");
    // a temporary file is its owner's alone; a record is to be read by others as other files are
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    builder
}
