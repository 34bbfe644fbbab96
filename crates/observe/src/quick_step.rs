//! One step from a sample to the next where they are near to each other: the pair of J. R. Dormand and P. J. Prince of orders 5 and 4 (A
//! family of embedded Runge-Kutta formulae, 1980).
//!
//! A method of order eight spends thirteen evaluations where six have no error left that doubles could tell. A step is taken only where the
//! difference of both formulas is below what is tolerated; nothing is refined here.

const NODES: [f64; 7] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];

const STAGES: [[f64; 6]; 7] = [
    [0.0; 6],
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// The formula of order five minus that of order four.
const DIFFERENCE: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// The room of a step, and the rate at the last state, which is the first of the next step.
#[derive(Default)]
pub(super) struct QuickSteps {
    rates: [Vec<f64>; 7],
    there: Vec<f64>,
    /// Whether the first rate is that at the state from which the next step begins.
    is_begun: bool,
    /// So many samples are left to other methods, because the last step was too long.
    rest: usize,
}

/// After a step that was too long for it, so many samples are not tried.
const REST: usize = 16;

impl QuickSteps {
    /// Takes `y` from one time to another; it stays where the step is too long, which is where both formulas differ by more than the tolerance in parts of
    /// one or of a value, and that is said.
    pub fn take(
        &mut self,
        f: &impl Fn(f64, &[f64], &mut [f64]),
        from: f64,
        to: f64,
        y: &mut [f64],
        tolerance: f64,
    ) -> bool {
        if self.rest > 0 {
            self.rest -= 1;
            return false;
        }
        let (n, step) = (y.len(), to - from);
        self.there.resize(n, 0.0);
        self.rates.iter_mut().for_each(|rate| rate.resize(n, 0.0));
        if !self.is_begun {
            f(from, y, &mut self.rates[0]);
        }
        for stage in 1..7 {
            let (done, rest) = self.rates.split_at_mut(stage);
            for (i, there) in self.there.iter_mut().enumerate() {
                let sum: f64 = done.iter().zip(&STAGES[stage]).map(|(rate, part)| part * rate[i]).sum();
                *there = y[i] + step * sum;
            }
            f(from + NODES[stage] * step, &self.there, &mut rest[0]);
        }
        let is_small = (0..n).all(|i| {
            let off: f64 = self.rates.iter().zip(&DIFFERENCE).map(|(rate, part)| part * rate[i]).sum();
            // a number that is none is not small
            (step * off).abs() <= tolerance * (1.0 + y[i].abs().max(self.there[i].abs()))
        });
        self.is_begun = is_small;
        if is_small {
            y.copy_from_slice(&self.there);
            self.rates.swap(0, 6);
        } else {
            self.rest = REST;
        }
        is_small
    }

    /// The state was moved by others.
    pub fn begin_anew(&mut self) {
        self.is_begun = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y' = y` along a hundred short steps is the exponential to rounding; along a long one it is refused, and nothing moves.
    #[test]
    fn short_steps_are_taken_and_long_ones_are_not() {
        let f = |_: f64, y: &[f64], dy: &mut [f64]| dy.copy_from_slice(y);
        let (mut steps, mut y) = (QuickSteps::default(), [1.0]);
        for i in 0..100 {
            let (from, to) = (f64::from(i) * 1e-3, f64::from(i + 1) * 1e-3);
            assert!(steps.take(&f, from, to, &mut y, 1e-14), "{i}");
        }
        assert!((y[0] - 0.1_f64.exp()).abs() < 1e-14, "{}", y[0]);
        let before = y;
        assert!(!steps.take(&f, 0.1, 0.6, &mut y, 1e-14));
        assert_eq!(y, before);
        let nowhere = |_: f64, _: &[f64], dy: &mut [f64]| dy.fill(f64::NAN);
        assert!(!QuickSteps::default().take(&nowhere, 0.0, 1e-6, &mut y, 1e-14));
    }
}
