//! How often a motion is looked at.

/// Contacts are looked at after each step of the integrator, of which there are at least so many: a contact force
/// that is negative for a shorter time than a step may go unnoticed.
const FEWEST_STEPS: f64 = 256.0;

/// And there are at least so many in the time in which a body turns by one radian, or in which gravity moves it by its own size, however long the
/// motion is asked to go on.
const STEPS_A_TIME: f64 = 16.0;

/// The longest step, in s, of a motion that goes on until `last`, of a body of a size in m that turns at a rate in rad/s.
pub(super) fn longest_step(last: f64, size: f64, rate: f64, gravity: f64) -> f64 {
    let fastest = (gravity.abs() / size).sqrt().max(rate.abs());
    (last / FEWEST_STEPS).min(1.0 / (STEPS_A_TIME * fastest))
}

#[cfg(test)]
mod tests {
    use super::longest_step;

    /// By hand: in sqrt(0.1/10) = 0.1 s gravity moves a body by half its size; without it and at rest nothing bounds a step but the end.
    #[test]
    fn a_step_is_bounded_by_the_motion_and_by_its_end() {
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        close(longest_step(1e9, 0.1, 0.0, -10.0), 0.1 / 16.0);
        close(longest_step(1e9, 0.1, -40.0, 10.0), 0.025 / 16.0);
        close(longest_step(0.256, 0.1, 0.0, 10.0), 0.001);
        close(longest_step(256.0, 0.1, 0.0, 0.0), 1.0);
        close(longest_step(256.0, 0.0, 0.0, 0.0), 1.0);
    }
}
