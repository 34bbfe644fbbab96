//! Steps of Dormand and Prince's pair without a room of their own.
//!
//! A method of order eight spends thirteen evaluations where six have no error that doubles could show: from one sample to the next a step is
//! taken where the difference of both formulas is below what is tolerated, and nothing is refined ([`QuickSteps::take`]). A search does not
//! need so much: it goes through many samples in steps as long as the tolerance allows ([`QuickSteps::go_through`]).

use super::dormand_prince::{DIFFERENCE, NODES, STAGES, between};

/// A step is this part of the longest one that the error estimate allows, and no shorter or longer than these parts of the one before.
const SAFETY: f64 = 0.9;
const CHANGE: (f64, f64) = (0.1, 5.0);

/// A step shorter than this part of the way is none.
const SHORTEST: f64 = 1e-12;

/// Why a way was not gone to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stopped {
    /// No step is small enough.
    TooShort,
    /// The evaluations that are allowed are spent.
    Spent,
}

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
    /// Takes `y` from one time to another; it stays where the step is too long, which is where both formulas differ by more than the tolerance relative to
    /// one or to a value; returns whether the step was taken.
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
        self.step(f, from, to - from, y);
        // a number that is none is not small
        let is_small = self.error(to - from, y) <= tolerance;
        self.is_begun = is_small;
        if is_small {
            self.arrive(y);
        } else {
            self.rest = REST;
        }
        is_small
    }

    /// Takes `y` through increasing times, from the first to the last, in steps as long as the tolerance allows, and hands the place and the state of each
    /// after the first to `tell`, interpolated between the steps. Where the rates have kinks or jumps there, steps end at each of them: `stops` is called
    /// before the steps towards it.
    ///
    /// # Errors
    /// Where and why it stops.
    pub fn go_through(
        &mut self,
        f: &impl Fn(f64, &[f64], &mut [f64]),
        times: &[f64],
        y: &mut [f64],
        (tolerance, most): (f64, usize),
        stops: Option<&dyn Fn(f64)>,
        mut tell: impl FnMut(usize, &[f64]),
    ) -> Result<(), (f64, Stopped)> {
        let [from, .., end] = *times else { return Ok(()) };
        let (mut time, mut step, mut next, mut steps) = (from, end - from, 1, 0);
        let mut there = Vec::with_capacity(y.len());
        while next < times.len() {
            steps += 1;
            if 6 * steps > most {
                return Err((time, Stopped::Spent));
            }
            let left = match stops {
                Some(towards) => {
                    towards(times[next]);
                    times[next] - time
                }
                None => end - time,
            };
            // two even steps rather than a long one and a rest
            let length = if step >= left { left } else { step.min(left / 2.0) };
            self.step(f, time, length, y);
            let error = self.error(length, y) / tolerance;
            let change = (SAFETY * error.powf(-0.2)).clamp(CHANGE.0, CHANGE.1);
            // of no number there is no part
            step = length * if change.is_nan() { CHANGE.0 } else { change };
            if error.is_nan() || error > 1.0 {
                if step <= SHORTEST * (end - from) {
                    return Err((time, Stopped::TooShort));
                }
                continue;
            }
            let to = match stops {
                _ if length < left => time + length,
                Some(_) => times[next],
                None => end,
            };
            while next < times.len() && times[next] < to {
                self.interpolate((times[next] - time) / length, length, y, &mut there);
                tell(next, &there);
                next += 1;
            }
            self.arrive(y);
            if stops.is_some() && length == left {
                self.begin_anew();
            }
            time = to;
            while next < times.len() && times[next] == to {
                tell(next, y);
                next += 1;
            }
        }
        Ok(())
    }

    /// The rates along a step, and the state at its end.
    fn step(&mut self, f: &impl Fn(f64, &[f64], &mut [f64]), from: f64, length: f64, y: &[f64]) {
        let n = y.len();
        self.there.resize(n, 0.0);
        self.rates.iter_mut().for_each(|rate| rate.resize(n, 0.0));
        if !self.is_begun {
            f(from, y, &mut self.rates[0]);
            self.is_begun = true;
        }
        for stage in 1..7 {
            let (done, rest) = self.rates.split_at_mut(stage);
            for (i, there) in self.there.iter_mut().enumerate() {
                let sum: f64 = done.iter().zip(&STAGES[stage]).map(|(rate, part)| part * rate[i]).sum();
                *there = y[i] + length * sum;
            }
            f(from + NODES[stage] * length, &self.there, &mut rest[0]);
        }
    }

    /// The most that both formulas differ by at the end of a step, relative to one or to a value; no number where the end is none.
    fn error(&self, length: f64, y: &[f64]) -> f64 {
        let one = |i: usize| {
            let off: f64 = self.rates.iter().zip(&DIFFERENCE).map(|(rate, part)| part * rate[i]).sum();
            // of an infinite end any difference would be a small part
            match self.there[i].is_finite() {
                true => (length * off).abs() / (1.0 + y[i].abs().max(self.there[i].abs())),
                false => f64::NAN,
            }
        };
        (0..y.len()).map(one).fold(0.0, |most, off| if off > most || off.is_nan() { off } else { most })
    }

    /// The state at a part of a step that has been made from `y`.
    fn interpolate(&self, part: f64, length: f64, y: &[f64], there: &mut Vec<f64>) {
        there.clear();
        there.extend((0..y.len()).map(|i| {
            let rates = std::array::from_fn(|stage| self.rates[stage][i]);
            between(part, length, [y[i], self.there[i]], rates)
        }));
    }

    /// The step is taken.
    fn arrive(&mut self, y: &mut [f64]) {
        y.copy_from_slice(&self.there);
        self.rates.swap(0, 6);
    }

    /// The state was moved by others.
    pub fn begin_anew(&mut self) {
        self.is_begun = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::advance;
    use std::cell::Cell;

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

    /// A driven, damped pendulum through irregular samples: what is interpolated is where the method of order eight comes to from sample to sample, with
    /// fewer evaluations than three a sample where six digits are asked for.
    #[test]
    fn long_steps_meet_the_samples_between() {
        let f = |time: f64, y: &[f64], dy: &mut [f64]| {
            dy[0] = y[1];
            dy[1] = -y[0].sin() - 0.1 * y[1] + (2.0 * time).cos();
        };
        let times: Vec<f64> =
            (0..60).map(|i| 3.0 + 0.05 * f64::from(i) + 0.01 * f64::from(i * i % 3)).collect();
        for (tolerance, most) in [(1e-6, 3.0), (1e-9, 10.0)] {
            let count = Cell::new(0);
            let counted = |time: f64, y: &[f64], dy: &mut [f64]| {
                count.set(count.get() + 1);
                f(time, y, dy);
            };
            let (mut y, mut found) = (vec![1.0, 0.5], vec![vec![1.0, 0.5]]);
            let tell = |place: usize, state: &[f64]| {
                assert_eq!(place, found.len());
                found.push(state.to_vec());
            };
            QuickSteps::default()
                .go_through(&counted, &times, &mut y, (tolerance, 10_000), None, tell)
                .unwrap();
            assert!(f64::from(count.get()) < most * times.len() as f64, "{} evaluations", count.get());
            assert_eq!(found.len(), times.len());
            assert_eq!(found.last(), Some(&y));
            let mut there = vec![1.0, 0.5];
            for (pair, state) in times.windows(2).zip(&found[1..]) {
                there = advance(&f, pair[0], pair[1], &there, 1e-13).unwrap();
                let off = (0..2).map(|i| (there[i] - state[i]).abs()).fold(0.0, f64::max);
                assert!(off < 20.0 * tolerance, "{pair:?}: {off:e}");
            }
        }
    }

    /// A step to infinity is none, however little both formulas differ there; no way is gone where there is one sample or none.
    #[test]
    fn nothing_is_told_at_infinity_or_of_no_way() {
        let away = |_: f64, _: &[f64], dy: &mut [f64]| dy[0] = 1e300;
        let mut y = [f64::MAX];
        assert!(!QuickSteps::default().take(&away, 0.0, 1e9, &mut y, 1e-6));
        let way =
            QuickSteps::default().go_through(&away, &[0.0, 1e9], &mut y, (1e-6, 10_000), None, |_, _| {
                panic!("nothing is there");
            });
        assert!(way.is_err() && y == [f64::MAX]);
        for times in [&[][..], &[1.0]] {
            let way = QuickSteps::default().go_through(&away, times, &mut y, (1e-6, 10_000), None, |_, _| {
                panic!("no sample follows");
            });
            assert_eq!(way, Ok(()));
        }
    }

    /// Towards a pole steps become shorter until there are none, or no more evaluations are allowed.
    #[test]
    fn nothing_is_told_beyond_a_pole() {
        let pole = |_: f64, y: &[f64], dy: &mut [f64]| dy[0] = y[0] * y[0];
        for (most, why, from) in [(100_000, Stopped::TooShort, 1.0 - 1e-3), (60, Stopped::Spent, 0.0)] {
            let mut told = 0;
            let way = QuickSteps::default().go_through(
                &pole,
                &[0.0, 0.5, 2.0],
                &mut [1.0],
                (1e-7, most),
                None,
                |_, _| told += 1,
            );
            let (time, stopped) = way.unwrap_err();
            // the pole of what is integrated is as far from that of the equation as the tolerance moves it
            let is_there = stopped == why && (from..1.0 + 1e-6).contains(&time);
            assert!(is_there && told == usize::from(time >= 0.5), "{time} {stopped:?} {told}");
        }
    }

    /// Rates with a kink at each sample, and with a jump: steps that stop there come to the integral, and no step is refused for it.
    #[test]
    fn steps_stop_where_rates_have_kinks() {
        let times: Vec<f64> = (0..=40).map(f64::from).collect();
        let until = std::cell::Cell::new(f64::INFINITY);
        let towards = |time: f64| until.set(time.next_down());
        for (jumps, integral) in [(false, 20.0), (true, 20.0)] {
            let count = std::cell::Cell::new(0);
            let rates = |time: f64, _: &[f64], rates: &mut [f64]| {
                count.set(count.get() + 1);
                let time = if jumps { time.min(until.get()) } else { time };
                let whole = time.floor();
                let saw = if whole as i64 % 2 == 0 { time - whole } else { 1.0 - (time - whole) };
                rates[0] = if jumps { f64::from(whole as i64 % 2 == 0) } else { saw };
            };
            let (mut y, mut seen) = (vec![0.0], 0);
            let tell = |place: usize, y: &[f64]| {
                seen += 1;
                assert_eq!(place, seen);
                let half = if jumps { place.div_ceil(2) as f64 } else { place as f64 / 2.0 };
                assert!((y[0] - half).abs() < 1e-12, "{place}: {}", y[0]);
            };
            let way = QuickSteps::default().go_through(
                &rates,
                &times,
                &mut y,
                (1e-9, 10_000),
                Some(&towards),
                tell,
            );
            assert_eq!((way, seen), (Ok(()), 40));
            assert!((y[0] - integral).abs() < 1e-12 && count.get() <= 7 * 41, "{}", count.get());
        }
    }
}
