//! The channel to an editor over standard input and output. A message is as long as its header says, and what a header says is looked at before
//! room is made for it: `lsp-server` by itself makes any.

use lsp_server::{Connection, Message};
use std::io::{BufRead, Error, ErrorKind, Read, Result};
use std::thread::{Builder, JoinHandle};

/// A message of more bytes is refused: a text of 16 MiB, the longest that is read, has at most six for each of its own.
const LONGEST_MESSAGE: u64 = 128 << 20;

/// A header is no longer than this.
const LONGEST_HEADER: u64 = 4096;

/// The threads that read and write.
pub struct EditorStreams {
    reader: JoinHandle<Result<()>>,
    writer: JoinHandle<Result<()>>,
}

/// A connection over standard input and output.
///
/// # Errors
/// The system gives no threads.
pub fn standard_streams() -> Result<(Connection, EditorStreams)> {
    let (server, client) = Connection::memory();
    let Connection { sender, receiver } = client;
    let reader = Builder::new().spawn(move || {
        let mut input = std::io::stdin().lock();
        while let Some(message) = read(&mut input)? {
            let is_exit = matches!(&message, Message::Notification(told) if told.method == "exit");
            if sender.send(message).is_err() || is_exit {
                break;
            }
        }
        Ok(())
    })?;
    let writer = Builder::new().spawn(move || {
        let mut output = std::io::stdout().lock();
        receiver.into_iter().try_for_each(|message| message.write(&mut output))
    })?;
    Ok((server, EditorStreams { reader, writer }))
}

impl EditorStreams {
    /// Waits until all is read and written.
    ///
    /// # Errors
    /// The channel broke, or what came over it is no message.
    pub fn join(self) -> Result<()> {
        let ended = |thread: JoinHandle<Result<()>>| {
            thread.join().unwrap_or_else(|_| Err(Error::other("it was lost in the middle of a message")))
        };
        ended(self.reader).and(ended(self.writer))
    }
}

fn refused(why: String) -> Error {
    Error::new(ErrorKind::InvalidData, why)
}

/// The next message; none at the end.
fn read(input: &mut impl BufRead) -> Result<Option<Message>> {
    let mut header = Vec::new();
    loop {
        let begin = header.len();
        let left = LONGEST_HEADER.saturating_sub(begin as u64);
        if input.by_ref().take(left).read_until(b'\n', &mut header)? == 0 {
            return match (begin, left) {
                (0, _) => Ok(None),
                (_, 0) => Err(refused(format!("a header of more than {LONGEST_HEADER} bytes"))),
                _ => Err(ErrorKind::UnexpectedEof.into()),
            };
        }
        if header[begin..].trim_ascii().is_empty() {
            break;
        }
    }
    let text = String::from_utf8_lossy(&header);
    let length = text.lines().find_map(|line| {
        let (name, value) = line.split_once(':')?;
        name.trim().eq_ignore_ascii_case("Content-Length").then(|| value.trim().parse::<u64>().ok())?
    });
    match length {
        None => Err(refused("a message without its length".to_owned())),
        Some(length) if length > LONGEST_MESSAGE => Err(refused(format!(
            "a message of {length} bytes: no more than {} MiB are read",
            LONGEST_MESSAGE >> 20
        ))),
        Some(length) => Message::read(&mut header.as_slice().chain(input.take(length))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Result<Vec<Message>> {
        let mut input = text.as_bytes();
        let mut found = Vec::new();
        while let Some(message) = read(&mut input)? {
            found.push(message);
        }
        Ok(found)
    }

    #[test]
    fn messages_follow_one_another() {
        let one = r#"{"jsonrpc":"2.0","method":"exit"}"#;
        let framed = format!("Content-Length: {}\r\n\r\n{one}", one.len());
        assert_eq!(all(&framed.repeat(3)).unwrap().len(), 3);
        assert_eq!(all("").unwrap().len(), 0);
    }

    /// A length that lies costs no memory, nor does a header without an end.
    #[test]
    fn what_is_too_long_is_refused_before_it_is_read() {
        for text in [
            "Content-Length: 100000000000\r\n\r\n".to_owned(),
            "Content-Length: 18446744073709551615\r\n\r\n{}".to_owned(),
            "Content-Length: -1\r\n\r\n{}".to_owned(),
            "Content-Length: 99999999999999999999999999\r\n\r\n{}".to_owned(),
            "no length at all\r\n\r\n{}".to_owned(),
            "x".repeat(100_000),
            "a: b\r\n".repeat(100_000),
        ] {
            assert!(all(&text).is_err(), "{}", &text[..20]);
        }
    }
}
