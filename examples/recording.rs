//! Observers on a recording: a file of a pendulum's angle on a grid of a milliradian, of which they recover the angular velocity
//! and the unknown spring. The high gain observer differentiates what is read, and the grid throws it off. With
//! `cargo run --example recording`:
//!
//! ```text
//! true at the end: omega = 0.8240 rad/s, k = 2.0000 1/s^2
//! moving window: omega = 0.8249 rad/s, k = 1.9943 1/s^2
//! Kalman filter: omega = 0.8236 rad/s, k = 2.0014 1/s^2
//! high gain: omega = -1.0943 rad/s, k = 1.8317 1/s^2
//! ```

use palmistry::System;
use palmistry::observer::{
    EstimateQuestion, FaultRules, HighGain, Kalman, MovingWindow, Observer, Record, Signals, Task,
};
use std::sync::atomic::AtomicBool;

/// Samples of a pendulum's angle, in rad, every hundredth of a second: its equations, integrated by Runge's and Kutta's method.
fn swing(k: f64, samples: usize) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (step, rate) = (0.01, |[phi, omega]: [f64; 2]| [omega, -k * phi.sin()]);
    let (mut state, mut times, mut angles, mut rates) = ([0.8, 0.0], Vec::new(), Vec::new(), Vec::new());
    for sample in 0..samples {
        times.push(step * sample as f64);
        angles.push(state[0]);
        rates.push(state[1]);
        let ahead = |by: f64, slope: [f64; 2]| [state[0] + by * slope[0], state[1] + by * slope[1]];
        let a = rate(state);
        let b = rate(ahead(step / 2.0, a));
        let c = rate(ahead(step / 2.0, b));
        let d = rate(ahead(step, c));
        state = ahead(step / 6.0, [0, 1].map(|i| a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    (times, angles, rates)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // a recording, as an instrument would leave it: a column of times in s, and one of what was read, on a grid of a milliradian
    let (times, angles, rates) = swing(2.0, 400);
    let angles = angles.iter().map(|angle| (angle * 1e3).round() / 1e3).collect();
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("swing.csv");
    Record::new(times, vec![("phi".to_owned(), angles)])?.write(&path)?;

    // the system that the observers believe in; its spring is not known
    let system: System = "
        system \"A pendulum whose angle is measured\"
        state phi, omega, k
        angle phi
        drift f
          phi'   = omega
          omega' = -k*sin(phi)
          k'     = 0
        output phi
    "
    .parse()?;

    // what is sought, with a first guess of each; rows that cannot be used stop it
    let reading = Record::read_checked(&path, &["phi"], &FaultRules::default())?;
    let signals = Signals::of_record(&reading.record)?;
    let question = EstimateQuestion {
        guess: vec![("omega".to_owned(), 0.5), ("k".to_owned(), 1.0)],
        ..EstimateQuestion::default()
    };
    let interrupt = AtomicBool::new(false);
    let mut task = Task::new(&system, &question, &signals, &interrupt)?;
    // the error of a rounded measurement, evenly spread over the grid
    (task.exact, task.sigma) = (false, 1e-3 / f64::sqrt(12.0));
    let observers: [(&str, &dyn Observer); 3] = [
        ("moving window", &MovingWindow::new(40)),
        ("Kalman filter", &Kalman::default()),
        ("high gain", &HighGain::default()),
    ];
    println!("true at the end: omega = {:.4} rad/s, k = 2.0000 1/s^2", rates[rates.len() - 1]);
    for (name, observer) in observers {
        let track = observer.observe(&task);
        match track.last() {
            Some(last) => {
                println!("{name}: omega = {:.4} rad/s, k = {:.4} 1/s^2", last.state[0], last.state[1])
            }
            None => println!("{name}: nothing, {}", track.remarks.join("; ")),
        }
    }
    Ok(())
}
