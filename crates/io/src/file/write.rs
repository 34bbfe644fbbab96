//! Writing whole files.
//!
//! A file is written aside and moved into place, so that it is whole or not there. That holds for files alone: a device
//! or a pipe is written into, or it would be gone afterwards; a link stays, and what it points to is replaced; and what
//! is standard output under another name is written through it, behind what was printed before.

use super::{PATIENCE, PAUSE, Pipe, open, standard};
use std::collections::BTreeSet;
use std::fs::{File, Metadata, OpenOptions, Permissions};
use std::io::{BufWriter, Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// More links than this, one to the next, are not followed.
const MOST_LINKS: usize = 40;

/// Writes a file, or what has its name; `-` is standard output. Its folder is made where it is missing.
///
/// # Errors
/// An error of the system; the file is then as it was, and no temporary file remains beside it.
pub fn write_whole(path: &Path, fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<()>) -> Result<()> {
    if path == Path::new("-") {
        return through(standard::output()?, fill);
    }
    match std::fs::metadata(path) {
        Ok(known) if known.is_dir() => Err(Error::other("it is a folder")),
        Ok(known) if is_standard_output(&known) => through(standard::output()?, fill),
        Ok(known) if Pipe::of(&known) == Pipe::Yes => through(reader_of(path)?, fill),
        Ok(known) if !known.is_file() => through(OpenOptions::new().write(true).open(path)?, fill),
        // a stream of the shell's: its name leads to a file that others hold open
        Ok(_) if ["/dev/fd", "/proc"].iter().any(|place| path.starts_with(place)) => {
            through(OpenOptions::new().write(true).truncate(true).open(path)?, fill)
        }
        Ok(known) => replace(&path.canonicalize()?, known.permissions(), fill),
        Err(error) if error.kind() == ErrorKind::NotFound => replace(&end_of_links(path)?, readable(), fill),
        Err(error) => Err(error),
    }
}

fn through(
    mut file: impl Write + Send,
    fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<()>,
) -> Result<()> {
    let mut buffer = BufWriter::new(&mut file);
    let written = fill(&mut buffer).and_then(|()| buffer.flush());
    // what could not be written must not be tried once more when the buffer goes
    drop(buffer.into_parts());
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

#[cfg(unix)]
fn is_standard_output(known: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    let same = |other: Metadata| (other.dev(), other.ino()) == (known.dev(), known.ino());
    known.is_file() && standard::output().and_then(|file| file.metadata()).is_ok_and(same)
}

#[cfg(not(unix))]
fn is_standard_output(_: &Metadata) -> bool {
    false
}

/// A pipe that somebody reads, written to as it empties.
struct Emptied(File);

impl Write for Emptied {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        loop {
            match self.0.write(bytes) {
                Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(PAUSE),
                result => return result,
            }
        }
    }
    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

fn reader_of(path: &Path) -> Result<Emptied> {
    let begin = Instant::now();
    loop {
        // the system says that there is no such device as long as nobody has opened the pipe for reading
        match open(OpenOptions::new().write(true), path, Pipe::Yes) {
            Ok(file) => return Ok(Emptied(file)),
            Err(_) if begin.elapsed() < PATIENCE => std::thread::sleep(PAUSE),
            Err(_) => return Err(Error::other("it is a pipe, and nobody reads from it")),
        }
    }
}

/// Where links lead that end at nothing yet.
fn end_of_links(path: &Path) -> Result<PathBuf> {
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::read_link(&place) {
            Ok(next) => place = folder_of(&place).join(next),
            Err(_) => return Ok(place),
        }
    }
    Err(Error::other("too many links, one to the next"))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn replace(
    path: &Path,
    permissions: Permissions,
    fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<()>,
) -> Result<()> {
    let folder = folder_of(path);
    std::fs::create_dir_all(folder)?;
    let (file, aside) = {
        // the list is held until the file is in it: who empties it meanwhile would miss the file
        let mut list = unfinished();
        let builder = &mut tempfile::Builder::new();
        let made = builder.prefix(".palmistry-").permissions(permissions).tempfile_in(folder)?;
        let (file, aside) = made.into_parts();
        list.insert(aside.to_path_buf());
        (file, aside)
    };
    let place = aside.to_path_buf();
    let written = into_file(file, fill).and_then(|()| aside.persist(path).map_err(|e| e.error));
    unfinished().remove(&place);
    written
}

fn into_file(file: File, fill: impl FnOnce(&mut (dyn Write + Send)) -> Result<()>) -> Result<()> {
    let mut buffer = BufWriter::new(file);
    let written = fill(&mut buffer).and_then(|()| buffer.flush());
    drop(buffer.into_parts());
    written
}

/// Files that are being written aside.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes away the files that are being written aside, and lets none be begun any more: the program is about to end
/// before they are whole.
pub fn remove_unfinished() {
    let list = unfinished();
    for file in list.iter() {
        let _ = std::fs::remove_file(file);
    }
    // held until the end of the program
    std::mem::forget(list);
}

#[cfg(unix)]
fn readable() -> Permissions {
    use std::os::unix::fs::PermissionsExt;
    // a temporary file is its owner's alone; a result is to be read by others as other files are
    Permissions::from_mode(0o644)
}

#[cfg(not(unix))]
fn readable() -> Permissions {
    std::env::temp_dir()
        .metadata()
        .map(|m| m.permissions())
        .unwrap_or_else(|_| unreachable!("a temporary folder"))
}
