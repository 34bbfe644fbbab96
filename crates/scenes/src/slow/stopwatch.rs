//! The time that a method takes: this thread's processor time, so that other load of the machine does not count. Where a system does not provide it, a clock is used.

/// Runs.
pub(super) struct Stopwatch(f64);

impl Stopwatch {
    pub fn begun() -> Stopwatch {
        Stopwatch(now())
    }

    /// In s.
    pub fn seconds(&self) -> f64 {
        now() - self.0
    }
}

#[cfg(unix)]
fn now() -> f64 {
    let at = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    at.tv_sec as f64 + at.tv_nsec as f64 * 1e-9
}

#[cfg(not(unix))]
fn now() -> f64 {
    static BEGUN: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    BEGUN.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::Stopwatch;
    use std::time::{Duration, Instant};

    /// Work takes time, and no more than passes; a thread that sleeps takes none where the system measures processor time.
    #[test]
    fn it_counts_work_and_not_waiting() {
        let (watch, clock) = (Stopwatch::begun(), Instant::now());
        let mut sum = 0.0_f64;
        while watch.seconds() < 0.02 {
            sum += std::hint::black_box(sum).sin() + 1.0;
        }
        assert!(sum > 0.0 && clock.elapsed().as_secs_f64() >= 0.019);
        let watch = Stopwatch::begun();
        std::thread::sleep(Duration::from_millis(200));
        if cfg!(unix) {
            assert!(watch.seconds() < 0.1, "{}", watch.seconds());
        }
    }
}
