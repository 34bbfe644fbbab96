//! Interrupts. The first one asks long work to stop and to keep what it has; where the work does not come to its end
//! soon, because it is in the middle of something that cannot be divided, it is left there, and what was found so far
//! is printed without it. The second one ends the program at once.

use super::output::{Form, print_json, print_text};
use super::{Status, Unusable};
use palmistry::file;
use palmistry::system::Code;
use serde_json::json;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Set when the user, or the system, asks to stop.
pub(crate) static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Whether somebody has asked to stop.
pub(crate) fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// How long work may go on after an interrupt before it is left. Results have to be out within a second.
const GRACE: Duration = Duration::from_millis(600);

/// How often the interrupt is looked at.
const PAUSE: Duration = Duration::from_millis(20);

/// The stack of each thread that works: that of a main thread on most systems, twice.
pub(super) const STACK: usize = 16 << 20;

/// From now on an interrupt (and the system's request to end, and the end of the terminal) asks long work to stop and
/// keep what it has; a second one ends the program.
pub(crate) fn stop_on_interrupt() {
    // without a handler such a signal simply ends the program: nothing worth failing for
    let _ = listen();
}

fn asked_to_stop(status: i32) {
    if INTERRUPTED.swap(true, Ordering::Relaxed) {
        file::remove_unfinished();
        std::process::exit(status);
    }
    file::note("stopping; what is done so far is kept (interrupt again to leave at once)");
}

#[cfg(unix)]
fn listen() -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXCPU, SIGXFSZ};
    // a file that becomes too long is then a write that fails, and is cleaned up after like any other
    let mut signals = vec![SIGINT, SIGTERM, SIGXCPU, SIGXFSZ];
    if !is_ignored(SIGHUP) {
        signals.push(SIGHUP); // who starts a program with 'nohup' wants it to outlive the terminal
    }
    let mut signals = signal_hook::iterator::Signals::new(signals)?;
    std::thread::Builder::new().spawn(move || {
        for signal in signals.forever().filter(|signal| *signal != SIGXFSZ) {
            asked_to_stop(128 + signal);
        }
    })?;
    Ok(())
}

/// Whether the program was started with a signal ignored, as far as the system tells.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

#[cfg(not(unix))]
fn listen() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(|| asked_to_stop(130))
}

/// Who tells the user what was found: nobody yet, the thread that works, or the one that waits for it.
static TELLER: AtomicU8 = AtomicU8::new(NOBODY);
const NOBODY: u8 = 0;
const WORKER: u8 = 1;
const WAITING: u8 = 2;

fn becomes_teller(who: u8) -> bool {
    TELLER.compare_exchange(NOBODY, who, Ordering::SeqCst, Ordering::SeqCst).is_ok()
}

/// To be called by the thread that works before it prints or writes its results: from here on it is waited for. Where
/// it has been left, it goes no further.
pub(crate) fn begin_to_tell() {
    if !becomes_teller(WORKER) {
        loop {
            std::thread::park(); // the program is about to end
        }
    }
}

/// Does work on a thread of its own, and tells `left` instead where the user asks to stop and the work does not.
pub(crate) fn watched(
    work: impl FnOnce() -> miette::Result<Status> + Send + 'static,
    left: impl FnOnce() -> miette::Result<Status>,
) -> miette::Result<Status> {
    let (done, result) = channel();
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(move || {
        let _ = done.send(work());
    });
    let thread = thread.map_err(|error| {
        Unusable::report(
            Code::System,
            format!("the system gives no thread to work on: {error}"),
            "end other programs first",
        )
    })?;
    let mut asked: Option<Instant> = None;
    loop {
        match result.recv_timeout(PAUSE) {
            // what fails after an interrupt fails because of it
            Ok(Err(_)) if interrupted() && becomes_teller(WAITING) => return left(),
            Ok(found) => return found,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(()) => {
                    return Err(Unusable::report(Code::Question, "the work has ended without a result", ""));
                }
            },
        }
        if asked.is_none() && interrupted() {
            asked = Some(Instant::now());
        }
        if asked.is_some_and(|asked| asked.elapsed() > GRACE) && becomes_teller(WAITING) {
            let status = left();
            file::remove_unfinished();
            return status;
        }
    }
}

/// What there is to tell where nothing was found before the interrupt.
pub(crate) fn nothing_found(form: Form) -> miette::Result<Status> {
    match form {
        Form::Json => print_json(&json!({ "interrupted": true, "found": null }))?,
        Form::Text => print_text("interrupted before anything was found")?,
    }
    Ok(Status::CutOff)
}
