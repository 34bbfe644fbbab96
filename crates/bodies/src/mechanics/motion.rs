//! A planar body that is carried along by given angles, with derivatives by differences.

use super::contact::{Angles, Placement};
use super::curved::place_on;
use super::linear::Vector;
use super::{Derivatives, Moving, Palm, PlanarBody, Real, differentiate};

/// An angle as a function of time near time zero: radians, per second, per second squared.
#[derive(Clone, Debug)]
pub struct Swing {
    pub value: Real,
    pub rate: Real,
    pub acceleration: Real,
}

impl Swing {
    /// The angle at a time.
    pub fn at(&self, time: &Real) -> Real {
        &self.value + time * (&self.rate + time * &self.acceleration * Real::power_of_two(-1))
    }
}

/// The two palms' angles as functions of time: palm 1 against the X axis, palm 2 against palm 1.
#[derive(Clone, Debug)]
pub struct PalmMotion {
    pub phi1: Swing,
    pub phi2: Swing,
}

impl PalmMotion {
    /// The angles of palms and body at a time.
    pub fn angles(&self, phi0: Real, time: &Real) -> Angles {
        Angles { phi0, phi1: self.phi1.at(time), phi2: self.phi2.at(time) }
    }
}

/// What moves, at time zero.
#[derive(Clone, Debug)]
pub struct PlanarMotion {
    /// Sensor values.
    pub s: [Moving; 2],
    /// Projections of the contacts on their normals.
    pub r: [Moving; 2],
    /// Projections of the contacts on their tangents.
    pub d: [Moving; 2],
    /// The centre of mass in the world.
    pub centre: [Moving; 2],
    /// The body's orientation.
    pub phi0: Moving,
    /// The contacts in the body's frame.
    pub body: [[Moving; 2]; 2],
    /// How far the derivatives are to be trusted.
    pub error: Real,
}

/// Two things at a time, out of a list of things that come in order.
fn pairs(found: Derivatives) -> (impl Iterator<Item = [Moving; 2]>, Real) {
    let mut rest = found.all.into_iter();
    let next = move || -> Option<[Moving; 2]> { Some([rest.next()?, rest.next()?]) };
    (std::iter::from_fn(next), found.error)
}

/// Differentiates the motion of a body between palms of the given forms, whose orientation is a function of time and of the
/// palms' angles then.
///
/// `None` only where the list of quantities does not come back whole, which does not happen.
pub fn observe(
    body: &PlanarBody,
    palms: &PalmMotion,
    forms: &[Palm<Real>; 2],
    orientation: impl Fn(&Real) -> Real,
) -> Option<(Placement, PlanarMotion)> {
    let placement = |time: &Real| {
        let phi0 = orientation(time);
        (place_on(body, &palms.angles(phi0.clone(), time), forms), phi0)
    };
    let quantities = |time: &Real| {
        let (Placement { centre, contacts: [a, b] }, phi0) = placement(time);
        let lists = [[a.s, b.s], [a.r, b.r], [a.d, b.d], centre, a.body, b.body, [phi0, Real::zero()]];
        lists.into_iter().flatten().collect()
    };
    let (mut next, error) = pairs(differentiate(quantities, &Real::zero()));
    let (s, r, d, centre) = (next.next()?, next.next()?, next.next()?, next.next()?);
    let body = [next.next()?, next.next()?];
    let [phi0, _] = next.next()?;
    Some((placement(&Real::zero()).0, PlanarMotion { s, r, d, centre, phi0, body, error }))
}

/// The radius of curvature of the body's outline at the boundary point with a given outward normal, in
/// metres.
///
/// The outline is differentiated as a curve in the plane, by the angle through which the normal is turned;
/// that this angle is a special parameter of the curve is not used.
pub fn radius_of_curvature(body: &PlanarBody, normal: &Vector<2>) -> Real {
    let outline = |angle: &Real| {
        let (sine, cosine) = angle.sin_cos();
        let [x, y] = normal;
        body.point(&[x * &cosine - y * &sine, x * &sine + y * &cosine]).to_vec()
    };
    let [_, first, second] = differentiate(outline, &Real::zero()).vector::<2>(0);
    let square = super::linear::dot(&first, &first);
    &square * square.sqrt() / super::linear::cross_planar(&first, &second)
}
