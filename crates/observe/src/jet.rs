//! A number with its derivatives by the unknowns, as the integrator stores it.

use nalgebra::{Const, SMatrix};
use num_dual::{Derivative, Dual2SVec64, DualNum, DualSVec64};
use palmistry_math::number::Differentiable;

/// A number with the derivatives of some order by `P` unknowns, and its places in a row of doubles: the value, the
/// gradient, the lower triangle of the Hessian.
pub(super) trait Jet: Differentiable<Base = f64> + DualNum<Primitive = f64> + Copy {
    /// How many doubles.
    const LENGTH: usize;
    fn unpack(places: &[f64]) -> Self;
    fn pack(&self, places: &mut [f64]);
}

impl Jet for f64 {
    const LENGTH: usize = 1;
    fn unpack(places: &[f64]) -> f64 {
        places[0]
    }
    fn pack(&self, places: &mut [f64]) {
        places[0] = *self;
    }
}

impl<const P: usize> Jet for DualSVec64<P> {
    const LENGTH: usize = 1 + P;
    fn unpack(places: &[f64]) -> Self {
        let slopes = SMatrix::<f64, P, 1>::from_fn(|i, _| places[1 + i]);
        DualSVec64::new(places[0], Derivative::some(slopes))
    }
    fn pack(&self, places: &mut [f64]) {
        places[0] = self.re;
        match &self.eps.0 {
            Some(slopes) => places[1..=P].copy_from_slice(slopes.as_slice()),
            None => places[1..=P].fill(0.0),
        }
    }
}

impl<const P: usize> Jet for Dual2SVec64<P> {
    const LENGTH: usize = 1 + P + P * (P + 1) / 2;
    fn unpack(places: &[f64]) -> Self {
        let slopes = SMatrix::<f64, 1, P>::from_fn(|_, i| places[1 + i]);
        let bends = &places[1 + P..];
        let bends = SMatrix::<f64, P, P>::from_fn(|i, j| bends[triangle(i.max(j), i.min(j))]);
        Dual2SVec64::new(places[0], Derivative::some(slopes), Derivative::some(bends))
    }
    fn pack(&self, places: &mut [f64]) {
        places[0] = self.re;
        let slopes = self.v1.unwrap_generic(Const::<1>, Const::<P>);
        let bends = self.v2.unwrap_generic(Const::<P>, Const::<P>);
        places[1..=P].copy_from_slice(slopes.as_slice());
        for i in 0..P {
            for j in 0..=i {
                places[1 + P + triangle(i, j)] = bends[(i, j)];
            }
        }
    }
}

/// The place of an entry in the rows of a lower triangle.
pub(super) fn triangle(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}
