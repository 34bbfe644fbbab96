//! The lab, as those meet it who use its page and those who would misuse it.
//!
//! Oracles: the commands, whose verdicts the page has to show; a real browser; the operating system's list of processes.

mod browser;
mod hostile;
mod load;
mod once;
mod page;
mod requests;

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// What is not answered by then is not answered.
const LATE: Duration = Duration::from_secs(120);

/// A lab that listens.
struct Lab {
    child: Child,
    /// As it was printed, with the token.
    url: String,
    /// Host and port.
    host: String,
    token: String,
}

/// What came back.
struct Reply {
    status: u16,
    head: String,
    body: String,
}

impl Lab {
    fn begin(arguments: &[&str]) -> Lab {
        let mut command = Command::new(env!("CARGO_BIN_EXE_palmistry"));
        command.args(["lab", "--no-open", "--json"]).args(arguments);
        let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut child = child.expect("the program runs");
        let mut line = String::new();
        let mut out = BufReader::new(child.stdout.take().expect("a pipe"));
        out.read_line(&mut line).expect("a line");
        let told: Value = serde_json::from_str(&line).expect("it is JSON");
        let text = |key: &str| told[key].as_str().expect("a text").to_owned();
        let (url, host) = (text("url"), text("address"));
        let token = url.split("token=").nth(1).unwrap_or_default().to_owned();
        Lab { child, url, host, token }
    }

    fn open() -> Lab {
        Lab::begin(&["--port", "0"])
    }

    /// Sends bytes as they are, and reads what comes back until the end.
    fn raw(&self, bytes: &[u8]) -> Option<Reply> {
        let mut stream = TcpStream::connect(&self.host).expect("it listens");
        stream.set_read_timeout(Some(LATE)).expect("a time");
        // who refuses need not read to the end
        let _ = stream.write_all(bytes);
        let mut found = Vec::new();
        let _ = stream.read_to_end(&mut found);
        let text = String::from_utf8_lossy(&found).into_owned();
        let (head, body) = text.split_once("\r\n\r\n")?;
        let status = head.split(' ').nth(1)?.parse().ok()?;
        let chunked = head.to_ascii_lowercase().contains("transfer-encoding: chunked");
        let body = if chunked { without_chunks(body) } else { body.to_owned() };
        Some(Reply { status, head: head.to_owned(), body })
    }

    /// The bytes of a question as the page sends it.
    fn request(&self, path: &str, body: &str) -> Vec<u8> {
        let Lab { host, token, .. } = self;
        format!(
            "POST /api/{path} HTTP/1.1\r\nhost: {host}\r\norigin: http://{host}\r\nx-palmistry-token: {token}\r\n\
             content-type: application/json\r\ncontent-length: {}\r\nconnection: close\r\n\r\n{body}",
            body.len()
        )
        .into_bytes()
    }

    /// The lines of an answer.
    fn ask(&self, path: &str, question: &Value) -> Vec<Value> {
        let reply = self.raw(&self.request(path, &question.to_string())).expect("a reply");
        let lines = reply.body.lines().map(|line| serde_json::from_str(line).expect("a line of JSON"));
        lines.collect()
    }

    /// The last line of an answer, but for the name of its page.
    fn last(&self, question: &Value) -> Value {
        let mut lines = self.ask("answer", question);
        lines.retain(|line| line["kind"] != "page");
        lines.pop().expect("a last line")
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        let _ = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
        let _ = self.child.wait();
    }
}

/// A body whose chunks are put together; as far as it came.
fn without_chunks(mut body: &str) -> String {
    let mut found = String::new();
    while let Some((size, rest)) = body.split_once("\r\n") {
        let Ok(size) = usize::from_str_radix(size, 16) else { break };
        let Some(chunk) = rest.get(..size).filter(|_| size > 0) else { break };
        found.push_str(chunk);
        body = rest.get(size + 2..).unwrap_or_default();
    }
    found
}
