//! Work beside the interpreter: on a thread of its own, without the lock of the interpreter, and with an eye on Ctrl-C.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicBool, Ordering};
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

fn pool() -> PyResult<Arc<ThreadPool>> {
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
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.trim().parse::<u128>().ok());
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

/// New threads for what comes next: some of these are still busy with work that was left.
fn leave(pool: Arc<ThreadPool>) {
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if held.as_ref().is_some_and(|(_, current)| Arc::ptr_eq(current, &pool)) {
        *held = None;
    }
    // what drops a pool does not wait for its threads, which end when their work does
    drop(pool);
}

/// Does work without the lock of the interpreter. Where Ctrl-C (or another signal whose handler raises) comes meanwhile, its exception is
/// raised at once; the work is told so by the flag that it gets, and is left to find its end.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
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
    let found = py.detach(move || {
        loop {
            match result.recv_timeout(PAUSE) {
                Ok(found) => return Ok(found),
                Err(RecvTimeoutError::Timeout) => Python::attach(|py| py.check_signals())?,
                Err(RecvTimeoutError::Disconnected) => {
                    let why = thread.join().err().map_or("it ended without a result".to_owned(), |panic| {
                        let text = panic.downcast_ref::<String>().cloned();
                        text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()))
                            .unwrap_or_default()
                    });
                    return Err(PyRuntimeError::new_err(format!("a mistake in palmistry itself: {why}")));
                }
            }
        }
    });
    if found.is_err() {
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
