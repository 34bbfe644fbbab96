//! Reading whole files, up to a length.

use super::{PATIENCE, PAUSE, Pipe, open};
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::time::Instant;

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadFailure {
    /// An error of the system, in its own words.
    #[error("{0}")]
    System(#[from] std::io::Error),
    /// It is a folder.
    #[error("it is a folder")]
    Folder,
    /// It has more bytes than this.
    #[error("it is longer than {} MiB", .0 >> 20)]
    TooLong(u64),
    /// It is a pipe to which nobody writes.
    #[error("it is a pipe, and nobody writes to it")]
    Silent,
    /// It is no text in UTF-8: the first byte that does not belong, counted from zero, and what it is.
    #[error("it is not a text in UTF-8: byte {at} is 0x{byte:02x}")]
    NotText {
        /// Its place.
        at: usize,
        /// What it is.
        byte: u8,
    },
}

/// All bytes of a file, a pipe or a device, if they are no more than `most`.
///
/// # Errors
/// It cannot be opened or read, is a folder, is longer, or is a pipe without a writer.
pub fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>, ReadFailure> {
    if let Some(packed) = super::packed::bytes(path) {
        let packed = packed?;
        return if packed.len() as u64 > most {
            Err(ReadFailure::TooLong(most))
        } else {
            Ok(packed.to_vec())
        };
    }
    let known = std::fs::metadata(path)?;
    if known.is_dir() {
        return Err(ReadFailure::Folder);
    }
    if known.len() > most {
        return Err(ReadFailure::TooLong(most));
    }
    let pipe = Pipe::of(&known);
    let mut file = open(std::fs::OpenOptions::new().read(true), path, pipe)?;
    let mut bytes = Vec::with_capacity(known.len() as usize);
    let mut chunk = vec![0; 1 << 16];
    let (begin, mut written_to) = (Instant::now(), false);
    loop {
        match file.read(&mut chunk) {
            // a pipe that nobody has opened for writing yet ends at once
            Ok(0) if pipe == Pipe::Yes && !written_to => {
                if begin.elapsed() > PATIENCE {
                    return Err(ReadFailure::Silent);
                }
                std::thread::sleep(PAUSE);
            }
            Ok(0) => return Ok(bytes),
            Ok(count) => {
                written_to = true;
                bytes.extend_from_slice(&chunk[..count]);
                if bytes.len() as u64 > most {
                    return Err(ReadFailure::TooLong(most));
                }
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                written_to = true;
                std::thread::sleep(PAUSE);
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error.into()),
        }
    }
}

/// The first bytes of a file on the disk, however long it is.
///
/// # Errors
/// It cannot be opened or read, or is no plain file.
pub fn read_head(path: &Path, count: u64) -> Result<Vec<u8>, ReadFailure> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(std::io::Error::other("it is no file").into());
    }
    let mut head = Vec::new();
    std::fs::File::open(path)?.take(count).read_to_end(&mut head)?;
    Ok(head)
}

/// The text of a file that another program has written, perhaps before UTF-8: where it is none, each byte is a letter of ISO 8859-1, as
/// MATLAB wrote on many systems. What has bytes that no text has is refused all the same.
///
/// # Errors
/// As [`read_text`].
pub fn read_old_text(path: &Path, most: u64) -> Result<String, ReadFailure> {
    let why = match read_text(path, most) {
        Err(why @ ReadFailure::NotText { .. }) => why,
        found => return found,
    };
    let bytes = read_bytes(path, most)?;
    let is_letter = |byte: &u8| !matches!(byte, 0..=8 | 11 | 14..=31 | 127..=159);
    // the marks of UTF-16 are two letters there, and no text begins with them
    let is_marked = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
    if !is_marked && bytes.iter().all(is_letter) {
        Ok(bytes.into_iter().map(char::from).collect())
    } else {
        Err(why)
    }
}

/// The text of a file, if it is no more than `most` bytes of UTF-8. A byte-order mark in front is no part of it.
///
/// # Errors
/// As `read_bytes`; and where it is no text.
pub fn read_text(path: &Path, most: u64) -> Result<String, ReadFailure> {
    let text = String::from_utf8(read_bytes(path, most)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        ReadFailure::NotText { at, byte: error.as_bytes().get(at).copied().unwrap_or_default() }
    })?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: UTF-8 stays what it is, a letter of ISO 8859-1 is one, and what is no text is none.
    #[test]
    fn old_texts_are_read_letter_by_letter() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.m");
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).expect("written");
            read_old_text(&path, 1000).ok()
        };
        assert_eq!(read("% mod\u{e8}le \u{3b1}\n".as_bytes()).as_deref(), Some("% mod\u{e8}le \u{3b1}\n"));
        assert_eq!(read(b"% mod\xe8le\r\n\tx = 1;").as_deref(), Some("% mod\u{e8}le\r\n\tx = 1;"));
        for bytes in [&b"\xff\xfex\0"[..], b"\xfe\xffx", b"PK\x03\x04\xe8", b"a\x9fb"] {
            assert_eq!(read(bytes), None, "{bytes:?}");
        }
    }
}
