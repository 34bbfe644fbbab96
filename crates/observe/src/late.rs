//! Outputs whose measurements are late by an unknown time: their expected value is what the model had that much earlier.
//!
//! A measurement at `t` is `h(x(t - d))`, with `d` a constant state. The state at `t - d` is that of the flow, followed back from the sample by the classical
//! method of Runge and Kutta, in numbers that carry the derivatives by all unknowns, `d` among them; columns are their curves at
//! times that carry them too. A delay is a few steps between samples, in which the method errs by less than the curves do.

use super::jet::Jet;
use palmistry_math::number::Refusal;

/// A delay goes back by no more steps between samples than this.
pub const MOST_STEPS: f64 = 16.0;

/// So many steps of the method lie between two samples, at least.
const PARTS: f64 = 2.0;

/// The rates of the states at a time.
type RatesAt<'f, J> = dyn Fn(J, &[J]) -> Result<Vec<J>, Refusal> + 'f;

/// The states a delay before a sample, from those at it: `rates` gives theirs at a time, `between` is the time between two samples.
///
/// # Errors
/// A message where the delay is longer than [`MOST_STEPS`], or the equations have no value.
pub(super) fn states_before<J: Jet>(
    rates: &RatesAt<'_, J>,
    time: f64,
    states: &[J],
    delay: J,
    between: f64,
) -> Result<Vec<J>, String> {
    let back = delay.base().abs() / between;
    if back.is_nan() || back > MOST_STEPS {
        return Err(format!(
            "a delay of {:.1e} s is more than {MOST_STEPS} times the time between samples",
            delay.base()
        ));
    }
    let steps = (PARTS * back).ceil().max(1.0);
    let step = -delay / J::constant(steps);
    let half = step / J::constant(2.0);
    let along = |states: &[J], rates: &[J], length: J| -> Vec<J> {
        states.iter().zip(rates).map(|(state, rate)| *state + *rate * length).collect()
    };
    let mut now = J::constant(time);
    let mut states = states.to_vec();
    for _ in 0..steps as usize {
        let next = (|| {
            let a = rates(now, &states)?;
            let b = rates(now + half, &along(&states, &a, half))?;
            let c = rates(now + half, &along(&states, &b, half))?;
            let d = rates(now + step, &along(&states, &c, step))?;
            let sum = |i: usize| a[i] + (b[i] + c[i]) * J::constant(2.0) + d[i];
            let sixth = step / J::constant(6.0);
            Ok((0..states.len()).map(|i| states[i] + sum(i) * sixth).collect::<Vec<J>>())
        })();
        states = next.map_err(|refusal: Refusal| format!("the model has no value: {refusal}"))?;
        now += step;
    }
    Ok(states)
}
