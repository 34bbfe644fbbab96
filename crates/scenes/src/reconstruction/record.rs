//! A whole record of a body between flat palms: the measurements of both contacts, the palms' motion, and the motion that follows from a shape.

use super::super::recovered::Apart;
use super::law::{PalmsAt, Pose, pose};
use num_dual::{Derivative, DualSVec64};
use palmistry_bodies::shape::{ShapeEstimate, SupportFunction};
use palmistry_observe::Signals;
use palmistry_observe::dormand_prince::NODES;
use std::collections::HashMap;

/// Pose and its consequences are differentiated by `[h, h', h'']` at both contacts, the body's rate and its radius of gyration.
pub(super) const INPUTS: usize = 8;

/// The time of a node.
pub(super) fn node(from: f64, to: f64, place: usize) -> f64 {
    if NODES[place] == 1.0 { to } else { from + NODES[place] * (to - from) }
}

/// A whole record. SI units.
pub(super) struct WholeRecord {
    /// In s.
    pub times: Vec<f64>,
    /// The measured contacts along the palms.
    pub contacts: [Vec<f64>; 2],
    /// The palms' angles, rates and accelerations in the world, two columns each, over the same times.
    pub palms: Signals,
    /// The palms at the times at which a step from one sample to the next needs them, by the bits of the time: every motion that is tried needs the same ones.
    pub known: HashMap<u64, PalmsAt>,
    /// The acceleration along the Y axis.
    pub gravity: f64,
    /// The radius of gyration where it is known.
    pub gyration: Option<f64>,
    /// The body's rate at the first sample where it is known, in rad/s.
    pub rate: Option<f64>,
    /// The standard deviation of a contact, and whether it is stated.
    pub sigma: f64,
    pub stated: bool,
    /// The body's angle at the first sample: any, where the frame of the body is a choice.
    pub phi: f64,
}

/// The unknowns of a whole record: a point from which everything follows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unknowns {
    /// The body's rate at the first sample, in rad/s.
    pub rate: f64,
    /// The radius of gyration, in m.
    pub gyration: f64,
    /// The support function.
    pub support: SupportFunction,
}

/// One sample of a motion that follows from unknowns. Rows are derivatives by the free unknowns: the rate and the logarithm of the radius of
/// gyration where they are free, and the coefficients.
#[derive(Clone, Debug, Default, PartialEq)]
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
pub(super) struct Touched {
    palms: PalmsAt,
    /// `[h, h', h'', h''']`.
    pub support: [[f64; 4]; 2],
    pub bases: [Vec<[f64; 4]>; 2],
}

/// A pose with everything that its derivatives are computed from.
pub(super) struct Local {
    pub pose: Pose<DualSVec64<INPUTS>>,
    pub touched: Touched,
}

/// The value and the derivatives of a dual number.
pub(super) fn parts(number: &DualSVec64<INPUTS>) -> [f64; INPUTS] {
    let mut parts = [0.0; INPUTS];
    if let Some(slopes) = &number.eps.0 {
        parts.copy_from_slice(slopes.as_slice());
    }
    parts
}

impl WholeRecord {
    /// How many unknowns come before the coefficients.
    pub fn head(&self) -> usize {
        usize::from(self.rate.is_none()) + usize::from(self.gyration.is_none())
    }

    /// Where the radius of gyration stands among the unknowns, if it is one.
    pub fn place_of_gyration(&self) -> Option<usize> {
        self.gyration.is_none().then(|| self.head() - 1)
    }

    pub fn palms_at(&self, time: f64) -> PalmsAt {
        self.known.get(&time.to_bits()).copied().unwrap_or_else(|| self.interpolated(time))
    }

    /// Tabulates the palms: at each sample, and where a step from it to the next needs them.
    pub fn know_palms(&mut self) {
        let asked = self.times.windows(2).flat_map(|pair| {
            let [from, to] = [pair[0], pair[1]];
            let nodes = (0..NODES.len()).map(move |stage| node(from, to, stage));
            nodes.chain([f64::midpoint(from, to)])
        });
        self.known = asked.map(|time| (time.to_bits(), self.interpolated(time))).collect();
    }

    fn interpolated(&self, time: f64) -> PalmsAt {
        let mut values = [0.0; 6];
        self.palms.at(&[0, 1, 2, 3, 4, 5], time, &mut values);
        let [a, b, c, d, e, f] = values;
        PalmsAt { angles: [a, b], rates: [c, d], accelerations: [e, f] }
    }

    fn touched(&self, time: f64, phi: f64, x: &Unknowns) -> Touched {
        let palms = self.palms_at(time);
        let normals = palms.normals(phi);
        let bases = normals.map(|angle| x.support.basis(angle));
        Touched { palms, support: normals.map(|angle| x.support.support(angle)), bases }
    }

    /// The pose without its derivatives.
    pub(super) fn pose(&self, time: f64, phi: f64, rate: f64, x: &Unknowns) -> Pose<f64> {
        let palms = self.palms_at(time);
        let support = palms.normals(phi).map(|angle| x.support.support(angle));
        pose(&palms, &support.map(|[r, slope, second, _]| [r, slope, second]), rate, x.gyration, self.gravity)
    }

    pub(super) fn local(&self, time: f64, phi: f64, rate: f64, x: &Unknowns) -> Local {
        let touched = self.touched(time, phi, x);
        let input = |value: f64, place: usize| -> DualSVec64<INPUTS> {
            DualSVec64::new(value, Derivative::derivative_generic(nalgebra::Const, nalgebra::Const, place))
        };
        let duals = [0, 1].map(|i: usize| [0, 1, 2].map(|k: usize| input(touched.support[i][k], 3 * i + k)));
        let pose = pose(&touched.palms, &duals, input(rate, 6), input(x.gyration, 7), self.gravity);
        Local { pose, touched }
    }

    /// The derivatives of the body's acceleration by its angle and its rate, and by the free unknowns where these two are fixed.
    pub fn linear(&self, time: f64, [phi, rate]: [f64; 2], x: &Unknowns) -> ([f64; 2], Vec<f64>) {
        let local = self.local(time, phi, rate, x);
        let by = parts(&local.pose.acceleration);
        let none = vec![0.0; self.head() + local.touched.bases[0].len()];
        let by_phi: f64 = (0..2)
            .map(|i| (0..3).map(|k| -by[3 * i + k] * local.touched.support[i][k + 1]).sum::<f64>())
            .sum();
        ([by_phi, by[6]], self.row(&local, &by, x, &none, &none))
    }

    /// The derivatives by the free unknowns of a quantity with derivatives by the inputs, where those of angle and rate are known.
    pub(super) fn row(
        &self,
        local: &Local,
        by: &[f64; INPUTS],
        x: &Unknowns,
        phi: &[f64],
        rate: &[f64],
    ) -> Vec<f64> {
        let by_phi: f64 = (0..2)
            .map(|i| (0..3).map(|k| -by[3 * i + k] * local.touched.support[i][k + 1]).sum::<f64>())
            .sum();
        let mut row: Vec<f64> = phi.iter().zip(rate).map(|(phi, rate)| by_phi * phi + by[6] * rate).collect();
        let head = self.head();
        if let Some(place) = self.place_of_gyration() {
            row[place] += by[7] * x.gyration;
        }
        for (i, bases) in local.touched.bases.iter().enumerate() {
            for (own, basis) in row[head..].iter_mut().zip(bases) {
                *own += by[3 * i] * basis[0] + by[3 * i + 1] * basis[1] + by[3 * i + 2] * basis[2];
            }
        }
        row
    }

    /// The time between samples, and the time scale on which a body of such a size moves.
    pub fn apart(&self, x: &Unknowns) -> Apart {
        let whole = self.times.last().zip(self.times.first()).map_or(0.0, |(last, first)| last - first);
        let between = whole / (self.times.len().max(2) - 1) as f64;
        Apart { between, scale: (x.support.mean() / self.gravity).abs().sqrt() }
    }

    /// The unknowns that a shape and a rate give.
    pub fn unknowns(&self, shape: &ShapeEstimate, rate: f64, gyration: f64) -> Unknowns {
        Unknowns {
            rate: self.rate.unwrap_or(rate),
            gyration: self.gyration.unwrap_or(gyration),
            support: shape.support.clone(),
        }
    }
}
