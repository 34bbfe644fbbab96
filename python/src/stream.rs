//! Measurements as they arrive: pieces go in, an answer a window comes out.

use crate::answers::printed;
use crate::errors::{unreadable, unusable};
use crate::work::pool;
use palmistry::ReadError;
use palmistry::experiment::{Scene, StreamPiece, WindowReport, observe_stream};
use palmistry::report::{forget_seconds, stream_end_json, stream_json};
use pyo3::prelude::*;
use serde_json::Value;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// So many pieces may wait: who writes faster than windows are answered is slowed down.
const WAITING: usize = 4;

/// How often signals and the interrupt are looked at.
const PAUSE: Duration = Duration::from_millis(20);

/// What comes out.
enum Report {
    /// A window's answer, or the account of all at the end.
    Line(String),
    Failed(Box<ReadError>),
}

/// A scene whose measurements arrive.
#[pyclass(frozen, module = "palmistry._native")]
pub struct Stream {
    pieces: Mutex<Option<SyncSender<StreamPiece>>>,
    reports: Mutex<Receiver<Report>>,
    told: Arc<AtomicBool>,
}

#[pymethods]
impl Stream {
    /// Begins to wait for measurements of a scene.
    #[new]
    fn new(py: Python<'_>, scene: PathBuf, times: bool) -> PyResult<Stream> {
        let scene = Scene::read(&scene).map_err(|error| unreadable(py, &error))?;
        let (pieces, arriving) = sync_channel(WAITING);
        let (reports, taken) = channel();
        let told = Arc::new(AtomicBool::new(false));
        let (pool, flag) = (pool()?, told.clone());
        let line = move |mut object: Value| {
            if !times {
                forget_seconds(&mut object);
            }
            printed(object)
        };
        let work = move || {
            pool.install(move || {
                let mut next = || match arriving.recv_timeout(PAUSE) {
                    Ok(piece) => piece,
                    Err(RecvTimeoutError::Timeout) => StreamPiece::Nothing,
                    Err(RecvTimeoutError::Disconnected) => StreamPiece::End,
                };
                let mut tell =
                    |report: &WindowReport<'_>| reports.send(Report::Line(line(stream_json(report)))).is_ok();
                let last = match observe_stream(scene, &flag, &mut next, &mut tell) {
                    Ok(end) => Report::Line(line(stream_end_json(&end, flag.load(Ordering::Relaxed)))),
                    Err(error) => Report::Failed(error.into()),
                };
                let _ = reports.send(last);
            });
        };
        let thread = std::thread::Builder::new().spawn(work);
        thread.map_err(|why| unusable(py, &format!("the system gives no thread to work on: {why}"), None))?;
        Ok(Stream { pieces: Mutex::new(Some(pieces)), reports: Mutex::new(taken), told })
    }

    /// Hands over some comma-separated values. What is full is waited for.
    fn put(&self, py: Python<'_>, bytes: &[u8]) -> PyResult<()> {
        let mut piece = StreamPiece::Bytes(bytes.to_vec());
        loop {
            let full = {
                let pieces = self.pieces.lock().unwrap_or_else(PoisonError::into_inner);
                match pieces.as_ref().map(|pieces| pieces.try_send(piece)) {
                    // who has ended takes no more, and has said why
                    None | Some(Ok(()) | Err(std::sync::mpsc::TrySendError::Disconnected(_))) => {
                        return Ok(());
                    }
                    Some(Err(std::sync::mpsc::TrySendError::Full(piece))) => piece,
                }
            };
            piece = full;
            py.check_signals()?;
            py.detach(|| std::thread::sleep(PAUSE));
        }
    }

    /// The next answer that is there already.
    fn ready(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let reports = self.reports.lock().unwrap_or_else(PoisonError::into_inner);
        match reports.try_recv() {
            Ok(report) => line(py, report).map(Some),
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => Ok(None),
        }
    }

    /// Says that no more will come.
    fn close(&self) {
        self.pieces.lock().unwrap_or_else(PoisonError::into_inner).take();
    }

    /// The next answer, waited for; none where all were given.
    fn wait(&self, py: Python<'_>) -> PyResult<Option<String>> {
        loop {
            let found = py.detach(|| {
                let reports = self.reports.lock().unwrap_or_else(PoisonError::into_inner);
                reports.recv_timeout(PAUSE)
            });
            match found {
                Ok(report) => return line(py, report).map(Some),
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
                Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            }
        }
    }

    /// Ends the work, whatever has come.
    fn stop(&self) {
        self.told.store(true, Ordering::Relaxed);
        self.close();
    }
}

fn line(py: Python<'_>, report: Report) -> PyResult<String> {
    match report {
        Report::Line(text) => Ok(text),
        Report::Failed(error) => Err(unreadable(py, &error)),
    }
}
