//! The lab: a page in a browser on this machine, in which you write a system and see what can be computed of it.
//!
//! Its two halves exchange lines of JSON alone. The server ([`LabServer`]) hands out the page and passes questions on; it reads
//! no proof file and decides nothing. Each question goes to a process of its own ([`answer`]), with a limit of time and of memory: what
//! a text can do to that process it does to no other, and to stop a question is to end its process.

#![warn(missing_docs)]

mod answer;
mod server;

pub use answer::answer;
pub use server::{Access, LabError, LabOptions, LabServer, QuestionLimits};

/// Opens an address in the user's browser.
///
/// # Errors
/// There is no browser, or it cannot be started.
pub fn open_in_browser(url: &str) -> std::io::Result<()> {
    open::that_detached(url)
}

/// Limits this process, and each that it starts, to so much memory (bytes) and processor time (s). What the system does not limit stays
/// unlimited; the server's clock is there all the same.
#[cfg(unix)]
pub fn limit_this_process(memory: Option<u64>, seconds: Option<u64>) {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    // nor does it outlive the server, however that ends
    #[cfg(target_os = "linux")]
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL));
    for (resource, most) in [(Resource::As, memory), (Resource::Cpu, seconds), (Resource::Core, Some(0))] {
        if let Some(most) = most {
            let most = getrlimit(resource).maximum.map_or(most, |allowed| most.min(allowed));
            let _ = setrlimit(resource, Rlimit { current: Some(most), maximum: Some(most) });
        }
    }
}
