//! Standard output and standard error.
//!
//! Rust's own `print!` and `eprint!` panic where a stream cannot be written, and its standard output takes a closed one
//! for an empty one. A program whose results are lost has to say so: here a write to standard output that fails is an
//! error, and one to standard error is not, since nowhere is left to report it.

use crate::foreign::terminal;
use std::fs::File;
use std::io::{Error, ErrorKind, Result, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether standard output was closed when the program was started.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// Looks whether standard output is open. It has to be called before Rust's runtime begins, which puts the null device
/// in the place of a stream that is closed: what is written to that is lost without a message.
pub fn look_at_standard_output() {
    #[cfg(unix)]
    if rustix::io::fcntl_getfd(rustix::stdio::stdout()).is_err() {
        CLOSED.store(true, Ordering::Relaxed);
    }
}

/// Standard output as a file without a buffer.
pub(super) fn output() -> Result<File> {
    if CLOSED.load(Ordering::Relaxed) {
        return Err(Error::other("it is closed"));
    }
    #[cfg(unix)]
    {
        use std::os::fd::AsFd;
        Ok(File::from(std::io::stdout().as_fd().try_clone_to_owned()?))
    }
    #[cfg(windows)]
    {
        use std::os::windows::io::AsHandle;
        Ok(File::from(std::io::stdout().as_handle().try_clone_to_owned()?))
    }
}

/// Clears the terminal, together with what has left it.
pub fn clear_terminal() {
    let _ = output().and_then(|mut output| output.write_all(b"\x1b[2J\x1b[3J\x1b[H"));
}

/// Prints a text to standard output; nothing in it acts on a terminal but colours and ends of lines.
///
/// # Errors
/// It cannot be written: the disk is full, or the stream is closed. A pipe whose reader has gone away is no error.
pub fn print(text: &str) -> Result<()> {
    match output()?.write_all(terminal(text).as_bytes()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

/// The same, and whether anybody still reads.
///
/// # Errors
/// As [`print`].
pub fn print_heard(text: &str) -> Result<bool> {
    match output()?.write_all(terminal(text).as_bytes()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        result => result.map(|()| true),
    }
}

/// Writes a line to standard error, if that can be written.
pub fn note(line: &str) {
    let _ = std::io::stderr().write_all(format!("{}\n", terminal(line)).as_bytes());
}
