//! Work beside the interpreter: on a thread of its own, without the lock of the interpreter, and with an eye on Ctrl-C.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::{PyClass, PyClassInitializer};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How often signals are looked at.
const PAUSE: Duration = Duration::from_millis(20);

/// The stack of each thread that works: that of a main thread on most systems, twice.
const STACK: usize = 16 << 20;

/// No more threads than this are made, whatever is asked for: no result depends on their number.
const MOST_THREADS: usize = 1024;

/// The threads that share the work, and the process that made them: a process that was forked has none of its parent's.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// These threads.
pub fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let here = std::process::id();
    if let Some((process, pool)) = held.as_ref().filter(|(process, _)| *process == here) {
        let _ = process;
        return Ok(pool.clone());
    }
    if let Some((_, of_the_parent)) = held.take() {
        // its threads are not here, and to wait for them would last for ever
        std::mem::forget(of_the_parent);
    }
    let said = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.trim().parse::<u128>().ok());
    let asked = match THREADS.load(Ordering::Relaxed) {
        0 => said,
        threads => Some(threads as u128),
    };
    let mut builder = ThreadPoolBuilder::new().stack_size(STACK);
    if let Some(asked) = asked {
        builder = builder.num_threads(usize::try_from(asked).unwrap_or(MOST_THREADS).min(MOST_THREADS));
    }
    let built = builder.build();
    let built = built
        .map_err(|why| PyRuntimeError::new_err(format!("the system gives no threads to work on: {why}")))?;
    let built = Arc::new(built);
    *held = Some((here, built.clone()));
    Ok(built)
}

/// How many threads are asked for; 0 where nobody did.
static THREADS: AtomicUsize = AtomicUsize::new(0);

/// From now on so many threads share the work; 0 leaves it to the environment and the machine.
#[pyfunction]
pub fn set_threads(threads: usize) {
    THREADS.store(threads.min(MOST_THREADS), Ordering::Relaxed);
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match held.take() {
        Some((process, pool)) if process != std::process::id() => std::mem::forget(pool),
        _ => {}
    }
}

/// New threads for what comes next: some of these are still busy with work that was left.
fn leave(pool: Arc<ThreadPool>) {
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if held.as_ref().is_some_and(|(_, current)| Arc::ptr_eq(current, &pool)) {
        *held = None;
    }
    // what drops a pool does not wait for its threads, which end when their work does
    drop(pool);
}

/// How long work that was told to end is waited for: what it had is worth that, and Ctrl-C is heeded within 0.2 s.
const GRACE: Duration = Duration::from_millis(120);

/// What a signal's handler raised (or what else went wrong), and what the work had found until then, where it ended in time.
pub struct Cut<T> {
    pub raised: PyErr,
    pub found: Option<T>,
}

impl<T> From<PyErr> for Cut<T> {
    fn from(raised: PyErr) -> Cut<T> {
        Cut { raised, found: None }
    }
}

impl<T: PyClass + Into<PyClassInitializer<T>>> Cut<T> {
    /// The exception, with what was found as its attribute `found`.
    pub fn with_found(self, py: Python<'_>) -> PyErr {
        if let Some(object) = self.found.and_then(|found| Py::new(py, found).ok()) {
            let _ = self.raised.value(py).setattr("found", object);
        }
        self.raised
    }
}

impl<T> Cut<T> {
    /// The same with something else made of what was found.
    pub fn map<U>(self, make: impl FnOnce(T) -> Option<U>) -> Cut<U> {
        Cut { raised: self.raised, found: self.found.and_then(make) }
    }
}

/// Does work without the lock of the interpreter. Where Ctrl-C (or another signal whose handler raises) comes meanwhile, its exception is
/// raised at once; the work is told so by the flag that it gets, and is left to find its end.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    keeping(py, work).map_err(|cut| cut.raised)
}

/// The same, and what the work has found when it is told to end is kept.
pub fn keeping<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> Result<T, Cut<T>> {
    let pool = pool()?;
    let flag = Arc::new(AtomicBool::new(false));
    let (done, result) = channel();
    let thread = {
        let (pool, flag) = (pool.clone(), flag.clone());
        let run = move || {
            let _ = done.send(pool.install(|| work(&flag)));
        };
        std::thread::Builder::new().stack_size(STACK).spawn(run)
    };
    let thread = thread
        .map_err(|why| PyRuntimeError::new_err(format!("the system gives no thread to work on: {why}")))?;
    let told = flag.clone();
    let found = py.detach(move || {
        loop {
            match result.recv_timeout(PAUSE) {
                Ok(found) => return Ok(found),
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(raised) = Python::attach(|py| py.check_signals()) {
                        told.store(true, Ordering::Relaxed);
                        return Err(Cut { raised, found: result.recv_timeout(GRACE).ok() });
                    }
                }
                Err(RecvTimeoutError::Disconnected) => {
                    let why = thread.join().err().map_or("it ended without a result".to_owned(), |panic| {
                        let text = panic.downcast_ref::<String>().cloned();
                        text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()))
                            .unwrap_or_default()
                    });
                    let message = format!("a mistake in palmistry itself: {why}");
                    return Err(PyRuntimeError::new_err(message).into());
                }
            }
        }
    });
    if matches!(&found, Err(Cut { found: None, .. })) {
        flag.store(true, Ordering::Relaxed);
        leave(pool);
    }
    found
}

/// The same of work on what is borrowed: it is waited for, so that it has to look at its flag often.
pub fn interruptible_here<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    let pool = pool()?;
    let flag = AtomicBool::new(false);
    py.detach(|| {
        std::thread::scope(|scope| {
            let (done, result) = channel();
            let flag = &flag;
            let worker = scope.spawn(move || {
                let _ = done.send(pool.install(|| work(flag)));
            });
            let mut raised = None;
            loop {
                match result.recv_timeout(PAUSE) {
                    Ok(found) => return raised.map_or(Ok(found), Err),
                    Err(RecvTimeoutError::Timeout) if raised.is_none() => {
                        raised = Python::attach(|py| py.check_signals()).err();
                        flag.store(raised.is_some(), Ordering::Relaxed);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => {
                        let _ = worker.join();
                        let message = "a mistake in palmistry itself: the work ended without a result";
                        return Err(PyRuntimeError::new_err(message));
                    }
                }
            }
        })
    })
}
