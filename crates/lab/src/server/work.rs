//! A question as a process of its own: within its time and its memory, ended when nobody waits for it any more.

use super::QuestionLimits;
use super::pages::Pages;
use crate::answer::PAGE;
use hyper::body::{Bytes, Frame};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::net::IpAddr;
use std::path::PathBuf;
use std::pin::Pin;
use std::process::Stdio;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::process::{Child, Command};
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};

/// Lines of one answer that wait to be sent.
const LINES: usize = 64;
/// A longer answer is cut off.
const MOST_BYTES: u64 = 128 << 20;
/// A last line that is not taken by then is not sent.
const SENDING: Duration = Duration::from_secs(30);
/// So much of what a process says on standard error is looked at.
const MOST_SAID: u64 = 4 << 10;

/// What questions are answered by.
pub(super) struct Workers {
    program: (PathBuf, Vec<String>),
    folder: Option<PathBuf>,
    pub limits: QuestionLimits,
    /// Of all clients, and of each.
    all: Gates,
    clients: Mutex<HashMap<IpAddr, Gates>>,
}

/// Whether somebody waits for an answer while writing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    Cheap,
    Dear,
}

/// How many may work: what is cheap does not wait for what is dear.
#[derive(Clone)]
struct Gates {
    cheap: Arc<Semaphore>,
    dear: Arc<Semaphore>,
    /// One for each question that waits or is answered.
    places: Arc<Semaphore>,
}

impl Gates {
    fn new(at_once: usize, places: usize) -> Gates {
        let gate = |permits| Arc::new(Semaphore::new(permits));
        Gates { cheap: gate(at_once), dear: gate(at_once), places: gate(places) }
    }

    fn of(&self, effort: Effort) -> Arc<Semaphore> {
        match effort {
            Effort::Cheap => self.cheap.clone(),
            Effort::Dear => self.dear.clone(),
        }
    }

    fn is_idle(&self) -> bool {
        [&self.cheap, &self.dear, &self.places].iter().all(|gate| Arc::strong_count(gate) == 1)
    }
}

/// Permission to work.
pub(super) struct Turn {
    _client: OwnedSemaphorePermit,
    _all: OwnedSemaphorePermit,
}

/// A place among the questions that wait.
pub(super) struct QuestionPlace {
    _client: OwnedSemaphorePermit,
    _all: OwnedSemaphorePermit,
}

/// Clients that ask nothing are forgotten when there are more.
const MOST_CLIENTS: usize = 4096;

impl Workers {
    pub fn new(program: (PathBuf, Vec<String>), folder: Option<PathBuf>, limits: QuestionLimits) -> Workers {
        let all = Gates::new(limits.at_once[0], limits.places[0]);
        Workers { program, folder, limits, all, clients: Mutex::default() }
    }

    fn gates(&self, client: IpAddr) -> Gates {
        let mut clients = self.clients.lock().unwrap_or_else(PoisonError::into_inner);
        if clients.len() > MOST_CLIENTS {
            clients.retain(|_, gates| !gates.is_idle());
        }
        let new = || Gates::new(self.limits.at_once[1], self.limits.places[1]);
        clients.entry(client).or_insert_with(new).clone()
    }

    /// A place for a question, which is kept while it waits and is answered; none where too many wait.
    pub fn place(&self, client: IpAddr) -> Option<QuestionPlace> {
        let of_client = self.gates(client).places.try_acquire_owned().ok()?;
        let of_all = self.all.places.clone().try_acquire_owned().ok()?;
        Some(QuestionPlace { _client: of_client, _all: of_all })
    }

    /// Waits for a turn: those of one client first, so that one that asks much waits for itself and not for all.
    async fn turn(&self, client: IpAddr, effort: Effort) -> Option<Turn> {
        let client = self.gates(client).of(effort).acquire_owned().await.ok()?;
        let all = self.all.of(effort).acquire_owned().await.ok()?;
        Some(Turn { _client: client, _all: all })
    }

    fn command(&self, work: &std::path::Path, time: Duration) -> Command {
        let (program, arguments) = &self.program;
        let mut command = Command::new(program);
        command.args(arguments);
        command.arg("--memory").arg(self.limits.memory.to_string());
        // processor time of all threads: a backstop behind the clock
        command.arg("--seconds").arg((8 * time.as_secs()).max(8).to_string());
        command.arg("--work").arg(work);
        if let Some(folder) = &self.folder {
            command.arg("--within").arg(folder);
        }
        command.current_dir(work).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command.kill_on_drop(true);
        #[cfg(unix)]
        command.process_group(0);
        command
    }

    /// Answers a question in lines; who does not take them any more ends it.
    pub async fn answer(
        self: Arc<Self>,
        question: Bytes,
        (client, effort): (IpAddr, Effort),
        lines: mpsc::Sender<Bytes>,
        pages: &Pages,
    ) {
        let turn = tokio::select! {
            turn = self.turn(client, effort) => turn,
            () = lines.closed() => None,
        };
        let Some(turn) = turn else { return };
        let time = match effort {
            Effort::Cheap => self.limits.cheap,
            Effort::Dear => self.limits.dear,
        };
        let end = tokio::select! {
            end = tokio::time::timeout(time, self.run(&question, time, &lines, pages)) => match end {
                Ok(end) => end,
                Err(_) => Some(error(&format!("no answer within {} s, the time that a question has here", time.as_secs_f64()), "what was found until then is above")),
            },
            // nobody waits any more
            () = lines.closed() => None,
        };
        drop(turn);
        if let Some(end) = end {
            // who takes no line any more gets no last one
            let _ = tokio::time::timeout(SENDING, lines.send(line(&end))).await;
        }
    }

    /// Passes on the lines of a process; what there is to say where it has not come to its end.
    async fn run(
        &self,
        question: &[u8],
        time: Duration,
        lines: &mpsc::Sender<Bytes>,
        pages: &Pages,
    ) -> Option<Value> {
        let cannot =
            |why: std::io::Error| Some(error(&format!("a question cannot be answered now: {why}"), ""));
        let work = match tempfile::tempdir() {
            Ok(work) => work,
            Err(why) => return cannot(why),
        };
        let mut child = match self.command(work.path(), time).spawn() {
            Ok(child) => Group::new(child),
            Err(why) => return cannot(why),
        };
        let (input, output, said) =
            (child.own.stdin.take(), child.own.stdout.take(), child.own.stderr.take());
        let (Some(mut input), Some(output), Some(said)) = (input, output, said) else {
            return Some(error("a question cannot be answered now", ""));
        };
        let write = async {
            // a process that does not read has ended
            let _ = input.write_all(question).await;
            drop(input);
        };
        let mut tail = String::new();
        let listen = async {
            let mut bytes = Vec::new();
            let _ = said.take(MOST_SAID).read_to_end(&mut bytes).await;
            tail = String::from_utf8_lossy(&bytes).into_owned();
        };
        let mut last = Bytes::new();
        let read = async {
            let mut reader = BufReader::new(output.take(MOST_BYTES));
            loop {
                let mut next = Vec::new();
                match reader.read_until(b'\n', &mut next).await {
                    Ok(0) | Err(_) => break,
                    Ok(_) if next.last() != Some(&b'\n') => break,
                    Ok(_) => {
                        last = Bytes::from(next);
                        if lines.send(last.clone()).await.is_err() {
                            break;
                        }
                    }
                }
            }
        };
        tokio::join!(write, listen, read);
        let status = child.own.wait().await;
        let last = serde_json::from_slice::<Value>(&last).unwrap_or_default();
        if ["done", "error"].iter().any(|end| last["kind"] == *end) {
            if last["has_page"] != true {
                return None;
            }
            // a page comes from the program alone, and not over the page that asks
            let page = tokio::fs::read_to_string(work.path().join(PAGE)).await.ok();
            return page.map(|page| json!({ "kind": "page", "page": pages.keep(page) }));
        }
        let why = match status {
            Ok(status) if status.code().is_none() => {
                "it took more memory or time than a question may".to_owned()
            }
            _ => format!(
                "the process has ended without an answer: {}",
                tail.lines().next().unwrap_or("it said nothing")
            ),
        };
        Some(error(&why, "ask something smaller"))
    }
}

/// A process with all that it has started, which may outlive it.
struct Group {
    own: Child,
    #[cfg(unix)]
    id: Option<rustix::process::Pid>,
}

impl Group {
    fn new(own: Child) -> Group {
        #[cfg(unix)]
        let id = own.id().and_then(|id| rustix::process::Pid::from_raw(i32::try_from(id).ok()?));
        Group {
            own,
            #[cfg(unix)]
            id,
        }
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        #[cfg(unix)]
        if let Some(id) = self.id {
            // a group without processes is killed by nobody
            let _ = rustix::process::kill_process_group(id, rustix::process::Signal::KILL);
        }
    }
}

pub(super) fn error(message: &str, help: &str) -> Value {
    json!({ "kind": "error", "message": message, "help": (!help.is_empty()).then_some(help) })
}

pub(super) fn line(value: &Value) -> Bytes {
    format!("{value}\n").into()
}

/// The lines of an answer as they come.
pub(super) struct Lines(pub mpsc::Receiver<Bytes>);

impl Lines {
    pub fn new() -> (mpsc::Sender<Bytes>, Lines) {
        let (sender, receiver) = mpsc::channel(LINES);
        (sender, Lines(receiver))
    }
}

impl hyper::body::Body for Lines {
    type Data = Bytes;
    type Error = std::convert::Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        self.0.poll_recv(context).map(|line| line.map(|line| Ok(Frame::data(line))))
    }
}
