//! Files. What is read is bounded, and a pipe that nobody writes to is an error; what is written is whole or not
//! there; and standard output is a file like others, so that a write to it that fails is an error.
//!
//! This floor knows nothing of what stands in a file.

mod checksum;
mod packed;
mod read;
mod standard;
mod write;

#[doc(hidden)]
pub use checksum::Checksum;
#[doc(hidden)]
pub use packed::{PACKED, PackedFile, files_in, identity, is_file, is_folder, pack, packed_folders};
#[doc(hidden)]
pub use read::{ReadFailure, read_bytes, read_head, read_old_text, read_text};
#[doc(hidden)]
pub use standard::{clear_terminal, look_at_standard_output, note, print, print_heard};
#[doc(hidden)]
pub use write::{remove_unfinished, write_whole};

use std::time::Duration;

/// How long a pipe may be without anybody at its other end.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long to wait until a pipe is looked at again.
const PAUSE: Duration = Duration::from_millis(5);

/// Opens a file; a pipe without waiting for its other end.
fn open(
    options: &mut std::fs::OpenOptions,
    path: &std::path::Path,
    pipe: Pipe,
) -> std::io::Result<std::fs::File> {
    #[cfg(unix)]
    if pipe == Pipe::Yes {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    }
    #[cfg(not(unix))]
    let _ = pipe;
    options.open(path)
}

/// Whether a file is a pipe with a name, or one of the shell's `<(...)` and `>(...)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pipe {
    Yes,
    No,
}

impl Pipe {
    fn of(known: &std::fs::Metadata) -> Pipe {
        #[cfg(unix)]
        if std::os::unix::fs::FileTypeExt::is_fifo(&known.file_type()) {
            return Pipe::Yes;
        }
        let _ = known;
        Pipe::No
    }
}

#[cfg(test)]
mod tests;
