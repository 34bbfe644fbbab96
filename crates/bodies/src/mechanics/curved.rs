//! A planar body between two palms of any form, laid so that it touches both, in 320 bits.
//!
//! Where a contact is on a palm says what the palm's normal is there, and with it which point of the body touches. So a
//! sensor's value places the centre of mass, and of two of them both have to place it at the same point: two equations for
//! two values, solved by Newton's method. How a place depends on a sensor's value is found by a difference; no curvature
//! enters. The palms are bent little by little from flat ones, for which there is one solution: of two bent palms a body may
//! touch both near the joint or far from it, and the one near the joint is meant.

use super::contact::{Angles, Contact, Placement};
use super::linear::{Vector, difference, dot, scaled, solve, sum};
use super::palm::{Palm, PalmPoint};
use super::{PlanarBody, Real};

/// From flat to bent in so many steps.
const BENDS: i64 = 4;
/// A step of Newton's method below this size, in metres, ends a search, and one in which all digits count.
const NEAR: isize = -40;
const LAST_STEP: isize = -200;
/// Differences are taken over this.
const STEP: isize = -150;
/// More steps than this are not taken.
const MOST_STEPS: usize = 40;

/// A palm in the world: its form, its angle, and the side on which the body is (1 or -1 for left or right of it).
struct Standing<'a> {
    palm: &'a Palm<Real>,
    along: Vector<2>,
    across: Vector<2>,
    side: Real,
    body: &'a PlanarBody,
    /// The sine and the cosine of the body's orientation.
    turn: &'a (Real, Real),
}

fn turned(v: &Vector<2>, (sine, cosine): &(Real, Real)) -> Vector<2> {
    [cosine * &v[0] - sine * &v[1], sine * &v[0] + cosine * &v[1]]
}

impl Standing<'_> {
    fn world(&self, own: &Vector<2>) -> Vector<2> {
        sum(&scaled(&own[0], &self.along), &scaled(&own[1], &self.across))
    }

    /// The point of the palm at a sensor's value, the outward normal in the body's frame there and the body's point with it.
    fn touched(&self, s: &Real, part: &Real) -> (PalmPoint<Real>, Vector<2>, Vector<2>) {
        let point = self.palm.flattened(part).at(s);
        let inward = self.world(&point.normal);
        let back = (-&self.turn.0, self.turn.1.clone());
        let outward = turned(&[-&inward[0], -&inward[1]], &back);
        let x = self.body.point(&outward);
        (point, outward, x)
    }

    /// Where the centre of mass is if the contact is at a sensor's value.
    fn centre(&self, s: &Real, part: &Real) -> Vector<2> {
        let (point, _, x) = self.touched(s, part);
        difference(&self.world(&point.place), &turned(&x, self.turn))
    }

    fn contact(&self, s: &Real) -> Contact {
        let (point, outward, x) = self.touched(s, &Real::one());
        let clockwise = [outward[1].clone(), -&outward[0]];
        Contact {
            // the thesis turns the tangent of palm 2 towards the joint
            tangent: scaled(&self.side, &self.world(&point.tangent)),
            normal: self.world(&point.normal),
            world: self.world(&point.place),
            s: s.clone(),
            r: dot(&x, &outward),
            d: dot(&x, &clockwise),
            body: x,
            outward,
        }
    }
}

/// The sensor values at which both palms, bent by a part of what they are, place the centre of mass at one point.
fn met(palms: &[Standing<'_>; 2], start: [Real; 2], part: &Real, last: isize) -> [Real; 2] {
    let mut s = start;
    let step = Real::power_of_two(STEP);
    for _ in 0..MOST_STEPS {
        let here = [0, 1].map(|i: usize| palms[i].centre(&s[i], part));
        let slopes = [0, 1].map(|i: usize| {
            let there = palms[i].centre(&(&s[i] + &step), part);
            difference(&there, &here[i]).map(|x| x / &step)
        });
        let rows = [0, 1].map(|k: usize| [slopes[0][k].clone(), -&slopes[1][k]]);
        let by = solve(rows, difference(&here[1], &here[0]));
        s = sum(&s, &by);
        let size = dot(&by, &by).sqrt();
        if !size.is_defined() {
            break;
        }
        if size < Real::power_of_two(last) {
            return s;
        }
    }
    [Real::UNDEFINED, Real::UNDEFINED]
}

/// Lays the body between palms of the given forms so that it touches both, in the given orientation: [`place`](super::place)
/// for palms of any form. Undefined numbers come out where no such place is found.
pub fn place_on(body: &PlanarBody, angles: &Angles, palms: &[Palm<Real>; 2]) -> Placement {
    if palms.iter().all(|palm| *palm == Palm::Flat) {
        return super::place(body, angles);
    }
    let turn = angles.phi0.sin_cos();
    let standing = [0, 1].map(|i: usize| {
        let angle = if i == 0 { angles.phi1.clone() } else { &angles.phi1 + &angles.phi2 };
        let side = Real::whole(if i == 0 { 1 } else { -1 });
        let (sine, cosine) = angle.sin_cos();
        let across = scaled(&side, &[-&sine, cosine.clone()]);
        Standing { palm: &palms[i], along: [cosine, sine], across, side, body, turn: &turn }
    });
    let mut s = [Real::zero(), Real::zero()];
    for bend in 0..=BENDS {
        let part = Real::whole(bend) / Real::whole(BENDS);
        s = met(&standing, s, &part, if bend == BENDS { LAST_STEP } else { NEAR });
    }
    let contacts = [0, 1].map(|i: usize| standing[i].contact(&s[i]));
    Placement { centre: standing[0].centre(&s[0], &Real::one()), contacts }
}
