//! What a whole record tells of a body between flat palms: the readings of both contacts, the palms as they move, and what follows from a shape.

use super::law::{PalmsAt, Pose, pose};
use crate::observer::{Signals, advance};
use crate::shape::{ShapeEstimate, SupportSeries};
use num_dual::{Derivative, DualSVec64};

/// Pose and its consequences are differentiated by `[h, h', h'']` at both contacts, the body's rate and its radius of gyration.
const INPUTS: usize = 8;

/// The tolerance of the integration.
const TOLERANCE: f64 = 1e-12;

/// A whole record. SI units.
pub(super) struct WholeRecord {
    /// In s.
    pub times: Vec<f64>,
    /// What was read along the palms.
    pub contacts: [Vec<f64>; 2],
    /// The palms' angles, rates and accelerations in the world, two columns each, over the same times.
    pub palms: Signals,
    /// The acceleration along the Y axis.
    pub gravity: f64,
    /// The radius of gyration where it is known.
    pub gyration: Option<f64>,
    /// The standard deviation of a contact.
    pub sigma: f64,
    /// The body's angle at the first sample: any, where the frame of the body is a choice.
    pub phi: f64,
}

/// What is sought of a whole record: a point from which everything follows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unknowns {
    /// The body's rate at the first sample, in rad/s.
    pub rate: f64,
    /// The radius of gyration, in m.
    pub gyration: f64,
    /// The coefficients of the support function, in the order of [`SupportSeries::coefficients`].
    pub support: Vec<f64>,
}

/// One sample of a motion that follows from unknowns. Rows are derivatives by the free unknowns: rate, where it is free the logarithm of the radius of
/// gyration, and the coefficients.
#[derive(Clone, Debug, Default)]
pub(super) struct Followed {
    pub phi: f64,
    pub rate: f64,
    pub radii: [f64; 2],
    pub centre: [f64; 2],
    pub contacts: [f64; 2],
    pub phi_row: Vec<f64>,
    pub rate_row: Vec<f64>,
    pub radius_rows: [Vec<f64>; 2],
    pub contact_rows: [Vec<f64>; 2],
}

/// The support function at both contacts.
struct Touched {
    palms: PalmsAt,
    /// `[h, h', h'', h''']`.
    support: [[f64; 4]; 2],
    bases: [Vec<[f64; 4]>; 2],
}

/// A pose with all that its derivatives are made of.
struct Local {
    pose: Pose<DualSVec64<INPUTS>>,
    touched: Touched,
}

/// The value and the derivatives of a dual number.
fn parts(number: &DualSVec64<INPUTS>) -> [f64; INPUTS] {
    let mut parts = [0.0; INPUTS];
    if let Some(slopes) = &number.eps.0 {
        parts.copy_from_slice(slopes.as_slice());
    }
    parts
}

impl WholeRecord {
    /// How many unknowns come before the coefficients.
    pub fn head(&self) -> usize {
        if self.gyration.is_some() { 1 } else { 2 }
    }

    pub fn palms_at(&self, time: f64) -> PalmsAt {
        let mut values = [0.0; 6];
        self.palms.at(&[0, 1, 2, 3, 4, 5], time, &mut values);
        let [a, b, c, d, e, f] = values;
        PalmsAt { angles: [a, b], rates: [c, d], accelerations: [e, f] }
    }

    fn touched(&self, time: f64, phi: f64, x: &Unknowns) -> Touched {
        let palms = self.palms_at(time);
        let order = x.support.len() / 2;
        let bases = palms.normals(phi).map(|angle| SupportSeries::basis(angle, order));
        let support = [0, 1].map(|i: usize| {
            let mut sum = [0.0; 4];
            for (coefficient, basis) in x.support.iter().zip(&bases[i]) {
                sum.iter_mut().zip(basis).for_each(|(sum, basis)| *sum += coefficient * basis);
            }
            sum
        });
        Touched { palms, support, bases }
    }

    /// The pose without its derivatives.
    fn pose(&self, time: f64, phi: f64, rate: f64, x: &Unknowns) -> Pose<f64> {
        let Touched { palms, support, .. } = self.touched(time, phi, x);
        pose(&palms, &support.map(|[r, slope, second, _]| [r, slope, second]), rate, x.gyration, self.gravity)
    }

    fn local(&self, time: f64, phi: f64, rate: f64, x: &Unknowns) -> Local {
        let touched = self.touched(time, phi, x);
        let input = |value: f64, place: usize| -> DualSVec64<INPUTS> {
            DualSVec64::new(value, Derivative::derivative_generic(nalgebra::Const, nalgebra::Const, place))
        };
        let duals = [0, 1].map(|i: usize| [0, 1, 2].map(|k: usize| input(touched.support[i][k], 3 * i + k)));
        let pose = pose(&touched.palms, &duals, input(rate, 6), input(x.gyration, 7), self.gravity);
        Local { pose, touched }
    }

    /// The derivatives by the free unknowns of a quantity with derivatives by the inputs, where those of angle and rate are known.
    fn row(&self, local: &Local, by: &[f64; INPUTS], x: &Unknowns, phi: &[f64], rate: &[f64]) -> Vec<f64> {
        let by_phi: f64 = (0..2)
            .map(|i| (0..3).map(|k| -by[3 * i + k] * local.touched.support[i][k + 1]).sum::<f64>())
            .sum();
        let mut row: Vec<f64> = phi.iter().zip(rate).map(|(phi, rate)| by_phi * phi + by[6] * rate).collect();
        let head = self.head();
        if head == 2 {
            row[1] += by[7] * x.gyration;
        }
        for (i, bases) in local.touched.bases.iter().enumerate() {
            for (own, basis) in row[head..].iter_mut().zip(bases) {
                *own += by[3 * i] * basis[0] + by[3 * i + 1] * basis[1] + by[3 * i + 2] * basis[2];
            }
        }
        row
    }

    /// The motion from the first sample over so many; with its derivatives, if wanted. None where it cannot be followed.
    pub fn follow(&self, x: &Unknowns, rows: usize, derivatives: bool) -> Option<Vec<Followed>> {
        let p = if derivatives { self.head() + x.support.len() } else { 0 };
        let mut y = vec![0.0; 2 + 2 * p];
        (y[0], y[1]) = (self.phi, x.rate);
        if p > 0 {
            y[2 + p] = 1.0;
        }
        let law = |time: f64, y: &[f64], dy: &mut [f64]| {
            if p == 0 {
                (dy[0], dy[1]) = (y[1], self.pose(time, y[0], y[1], x).acceleration);
            } else {
                let local = self.local(time, y[0], y[1], x);
                (dy[0], dy[1]) = (y[1], local.pose.acceleration.re);
                let (phi, rate) = y[2..].split_at(p);
                dy[2..2 + p].copy_from_slice(rate);
                let row = self.row(&local, &parts(&local.pose.acceleration), x, phi, rate);
                dy[2 + p..].copy_from_slice(&row);
            }
        };
        let mut followed = Vec::with_capacity(rows);
        for i in 0..rows.min(self.times.len()) {
            if i > 0 {
                y = advance(&law, self.times[i - 1], self.times[i], &y, TOLERANCE).ok()?;
            }
            followed.push(self.sample(i, &y, p, x));
        }
        Some(followed)
    }

    fn sample(&self, i: usize, y: &[f64], p: usize, x: &Unknowns) -> Followed {
        let local = self.local(self.times[i], y[0], y[1], x);
        let (phi, rate) = y[2..].split_at(p);
        let contact = |i: usize| self.row(&local, &parts(&local.pose.contacts[i]), x, phi, rate);
        let radius = |i: usize| {
            let mut by = [0.0; INPUTS];
            by[3 * i] = 1.0;
            self.row(&local, &by, x, phi, rate)
        };
        Followed {
            phi: y[0],
            rate: y[1],
            radii: local.touched.support.map(|support| support[0]),
            centre: local.pose.centre.map(|x| x.re),
            contacts: local.pose.contacts.map(|x| x.re),
            contact_rows: if p > 0 { [contact(0), contact(1)] } else { Default::default() },
            radius_rows: if p > 0 { [radius(0), radius(1)] } else { Default::default() },
            phi_row: phi.to_vec(),
            rate_row: rate.to_vec(),
        }
    }

    /// The unknowns that a shape and a rate give.
    pub fn unknowns(&self, shape: &ShapeEstimate, rate: f64, gyration: f64) -> Unknowns {
        Unknowns { rate, gyration: self.gyration.unwrap_or(gyration), support: shape.support.coefficients() }
    }
}
