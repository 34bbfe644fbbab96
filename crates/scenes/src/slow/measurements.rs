//! The measurements of slow palms, and what follows from them without any shape.

use super::local::{Stencil, derivative};
use std::ops::Range;

/// Measurements of both palms at sample times. SI units, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowMeasurements {
    /// The times, increasing.
    pub times: Vec<f64>,
    /// `phi1` and `phi2`, sample by sample: palm 1 against the X axis, palm 2 against palm 1.
    pub palms: Vec<[f64; 2]>,
    /// Their rates.
    pub rates: Vec<[f64; 2]>,
    /// `s1` and `s2`, the distances of the contacts from the joint.
    pub contacts: Vec<[f64; 2]>,
    /// The standard deviation of a contact; zero where they are exact.
    pub sigma: f64,
}

/// The geometry of one sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sampled {
    /// Sine and cosine of `phi1`, `phi2` and `phi1 + phi2`.
    pub first: [f64; 2],
    pub opening: [f64; 2],
    pub second: [f64; 2],
    pub s: [f64; 2],
    /// The palms' rates in the world.
    pub w: [f64; 2],
}

impl Sampled {
    pub fn of(palms: [f64; 2], rates: [f64; 2], s: [f64; 2]) -> Sampled {
        let pair = |angle: f64| -> [f64; 2] { angle.sin_cos().into() };
        Sampled {
            first: pair(palms[0]),
            opening: pair(palms[1]),
            second: pair(palms[0] + palms[1]),
            s,
            w: [rates[0], rates[0] + rates[1]],
        }
    }

    /// The centre of rotation, in which the contact normals meet (3.22, 3.23).
    pub fn rotation_centre(&self) -> [f64; 2] {
        let q = (self.s[1] - self.s[0] * self.opening[1]) / self.opening[0];
        [self.s[0] * self.first[1] - q * self.first[0], self.s[0] * self.first[0] + q * self.first[1]]
    }

    /// Both radii where the centre of mass has a height: it lies above or below the centre of rotation (3.27).
    pub fn radii(&self, height: f64) -> [f64; 2] {
        let x = self.rotation_centre()[0];
        [-self.first[0] * x + self.first[1] * height, self.second[0] * x - self.second[1] * height]
    }

    /// The height of the centre of mass, both radii given.
    pub fn height(&self, [r1, r2]: [f64; 2]) -> f64 {
        (self.second[0] * r1 + self.first[0] * r2) / self.opening[0]
    }

    /// `d_1` and `d_2` by 3.18 and 3.19.
    pub fn tangential(&self, [r1, r2]: [f64; 2]) -> [f64; 2] {
        let [sine, cosine] = self.opening;
        [(r1 * cosine + r2) / sine - self.s[0], self.s[1] - (r2 * cosine + r1) / sine]
    }

    /// The rate of the height of the centre of mass: the contact forces' virtual work relative to the weight.
    pub fn lift(&self) -> f64 {
        (self.second[0] * self.s[0] * self.w[0] - self.first[0] * self.s[1] * self.w[1]) / self.opening[0]
    }

    /// Numerator and denominator of 3.37, `r_i` and the rates of the measurements given.
    pub fn turning(&self, radii: [f64; 2], rates: [f64; 2]) -> [f64; 2] {
        let ([s1, s2], opening_rate) = (self.s, self.w[1] - self.w[0]);
        let [sine, cosine] = self.opening;
        let (r2_tilde, d2_tilde) = (-s1 * sine, s1 * cosine - s2);
        let r2_rate = -rates[0] * sine - s1 * cosine * opening_rate;
        let d2_rate = rates[0] * cosine - s1 * sine * opening_rate - rates[1];
        let numerator = r2_rate * self.first[1] - d2_rate * self.first[0]
            + d2_tilde * opening_rate * self.second[0] / sine;
        let denominator =
            radii[0] * self.second[0] + (radii[1] + r2_tilde) * self.first[0] + d2_tilde * self.first[1];
        [numerator, denominator]
    }
}

impl SlowMeasurements {
    pub fn rows(&self) -> usize {
        self.times.len()
    }

    /// The samples of a stretch.
    pub(super) fn part(&self, rows: &Range<usize>) -> SlowMeasurements {
        SlowMeasurements {
            times: self.times[rows.clone()].to_vec(),
            palms: self.palms[rows.clone()].to_vec(),
            rates: self.rates[rows.clone()].to_vec(),
            contacts: self.contacts[rows.clone()].to_vec(),
            sigma: self.sigma,
        }
    }

    pub(super) fn sampled(&self, row: usize) -> Sampled {
        Sampled::of(self.palms[row], self.rates[row], self.contacts[row])
    }

    /// The eight measured quantities at any time, by the polynomial through the samples about it: the palms' angles, their rates, the contacts, the contacts' rates.
    pub(super) fn between(&self, time: f64, points: usize) -> (Sampled, [f64; 2]) {
        let stencil = Stencil::about(&self.times, time, points);
        let values = stencil.value_weights(time);
        let slopes = stencil.slope_weights(time);
        let sum = |weights: &[f64], of: &[[f64; 2]]| -> [f64; 2] {
            let mut total = [0.0; 2];
            for (w, value) in weights.iter().zip(&of[stencil.range()]) {
                (0..2).for_each(|i| total[i] += w * value[i]);
            }
            total
        };
        let sampled =
            Sampled::of(sum(&values, &self.palms), sum(&values, &self.rates), sum(&values, &self.contacts));
        (sampled, sum(&slopes, &self.contacts))
    }

    /// The rates of the contacts at the samples, by the polynomial through so many.
    pub(super) fn contact_rates(&self, points: usize) -> Vec<[f64; 2]> {
        let columns = [0, 1].map(|i: usize| {
            let column: Vec<f64> = self.contacts.iter().map(|s| s[i]).collect();
            derivative(&self.times, &column, points)
        });
        columns[0].iter().zip(&columns[1]).map(|(a, b)| [*a, *b]).collect()
    }

    /// The mean of all contacts: a length scale.
    pub(super) fn scale(&self) -> f64 {
        self.contacts.iter().flatten().map(|s| s.abs()).sum::<f64>() / (2 * self.rows()).max(1) as f64
    }
}
