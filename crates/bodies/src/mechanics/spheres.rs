//! Spherical palms in 320 bits: where a body touches them, by their centres alone.
//!
//! A body with the boundary point `X(u)`, whose outward normal is `u`, touches a sphere about `s` with the radius `rho` where
//! `c + R X(u) = s - rho R u`. With a plane instead it is `m . (c + R X(-R^T m)) = 0`. These are solved for the centre of mass and the normals by Newton's method with
//! differences for derivatives, so that no second derivative of the support function is needed.

use super::grip::Grip;
use super::linear::{Square, Vector, apply, cross, difference, dot, scaled, solve, sum, transposed};
use super::{Real, Solid};

/// A sphere that is fixed to a palm and touches its plane.
#[derive(Clone, Debug)]
pub struct PalmSphere {
    /// In metres; above zero where it bulges towards the body, below it where it is hollow.
    pub radius: Real,
    /// Where it touches the plane: along the axis and up the palm.
    pub touch: [Real; 2],
}

/// Half the step of differences, and the residual at the end, as powers of two.
const STEP: isize = -100;
const LEFT: isize = -290;
const MOST_STEPS: usize = 40;

/// A direction as it is, with two tangents.
fn chart(direction: &Vector<3>) -> [Vector<3>; 2] {
    let size = direction.each_ref().map(Real::abs);
    let least = (0..3).fold(0, |best, i| if size[i] < size[best] { i } else { best });
    let axis = std::array::from_fn(|i| Real::whole((i == least) as i64));
    let first = unit(&cross(direction, &axis));
    let second = cross(direction, &first);
    [first, second]
}

fn unit(a: &Vector<3>) -> Vector<3> {
    let long = dot(a, a).sqrt();
    a.each_ref().map(|x| x / &long)
}

/// Lays the body on palms so that it touches all three, in the given orientation; palms without a sphere are planes. Undefined numbers come out where
/// Newton's method, from where planes touch, does not arrive.
pub fn grip_on(
    solid: &Solid,
    turn: &Square<3>,
    palms: &[Square<3>; 3],
    spheres: &[Option<PalmSphere>; 3],
) -> Grip {
    let back = transposed(turn);
    let centres: [Vector<3>; 3] = std::array::from_fn(|i| match &spheres[i] {
        None => [0; 3].map(Real::whole),
        Some(PalmSphere { radius, touch: [along, up] }) => {
            let plane = sum(&scaled(along, &palms[i][0]), &scaled(up, &palms[i][1]));
            difference(&plane, &scaled(radius, &palms[i][2]))
        }
    });
    // how far the contact of palm i with a normal is from where it has to be, without the centre of mass
    let missing = |i: usize, outward: &Vector<3>| -> Vector<3> {
        let own = apply(turn, &solid.point(outward));
        match &spheres[i] {
            None => [dot(&palms[i][2], &own), Real::zero(), Real::zero()],
            Some(sphere) => {
                let away = scaled(&sphere.radius, &apply(turn, outward));
                difference(&sum(&own, &away), &centres[i])
            }
        }
    };
    let mut outward: [Vector<3>; 3] =
        std::array::from_fn(|i| apply(&back, &palms[i][2].each_ref().map(|x| -x)));
    let mut centre: Vector<3> = [0; 3].map(|_| Real::UNDEFINED);
    let mut is_there = false;
    for _ in 0..MOST_STEPS {
        let mut rows: Square<9> = std::array::from_fn(|_| std::array::from_fn(|_| Real::zero()));
        let mut right: Vector<9> = std::array::from_fn(|_| Real::zero());
        let charts = outward.each_ref().map(chart);
        let step = Real::power_of_two(STEP);
        for i in 0..3 {
            let here = missing(i, &outward[i]);
            for k in 0..3 {
                let row = 3 * i + k;
                right[row] = -&here[k];
                match &spheres[i] {
                    None if k == 0 => (0..3).for_each(|j| rows[row][j] = palms[i][2][j].clone()),
                    // a plane's normal stays
                    None => rows[row][3 + 2 * i + k - 1] = Real::one(),
                    Some(_) => rows[row][k] = Real::one(),
                }
            }
            if spheres[i].is_none() {
                continue;
            }
            for (side, tangent) in charts[i].iter().enumerate() {
                let moved = |by: &Real| missing(i, &unit(&sum(&outward[i], &scaled(by, tangent))));
                let (above, below) = (moved(&step), moved(&-&step));
                for k in 0..3 {
                    rows[3 * i + k][3 + 2 * i + side] = (&above[k] - &below[k]) / (&step + &step);
                }
            }
        }
        let found = solve(rows, right);
        centre = std::array::from_fn(|k| found[k].clone());
        let mut largest = Real::zero();
        for i in 0..3 {
            let mut next = outward[i].clone();
            for side in 0..2 {
                let by = &found[3 + 2 * i + side];
                largest = largest.max(&by.abs());
                next = sum(&next, &scaled(by, &charts[i][side]));
            }
            outward[i] = unit(&next);
        }
        if largest < Real::power_of_two(LEFT) {
            is_there = true;
            break;
        }
    }
    if !is_there {
        centre = [0; 3].map(|_| Real::UNDEFINED);
    }
    Grip::about(solid, turn, palms, centre, outward)
}

#[cfg(test)]
mod tests {
    use super::super::grip::{grip, palm_frame, rotation};
    use super::super::solid::SolidShape;
    use super::*;
    use dashu::rational::RBig;

    fn real(thousandths: i64) -> Real {
        Real::whole(thousandths) / Real::whole(1000)
    }

    fn palms() -> [Square<3>; 3] {
        [0, 2100, 4200].map(|azimuth| palm_frame(&real(azimuth), &real(1000)))
    }

    fn body(axes: [i64; 3]) -> Solid {
        let part = |n: i64| RBig::from(n) / RBig::from(1000);
        let none = || [0; 3].map(part);
        let shape = SolidShape { axes: axes.map(part), centre: none(), quartic: none(), cubic: part(0) };
        Solid::new(&shape).unwrap()
    }

    fn sphere(radius: i64) -> Option<PalmSphere> {
        Some(PalmSphere { radius: real(radius), touch: [real(100), real(900)] })
    }

    /// A ball of the radius `a` has its centre `a + rho` from the centres of all spheres, by Pythagoras.
    #[test]
    fn a_ball_on_spheres() {
        let (ball, palms) = (body([800, 800, 800]), palms());
        let turn = rotation(&[300, 700, -200].map(real));
        for radius in [2000, -3000] {
            let spheres = [sphere(radius), sphere(radius), sphere(2 * radius)];
            let found = grip_on(&ball, &turn, &palms, &spheres);
            for (i, sphere) in spheres.iter().flatten().enumerate() {
                let [p, q] = &sphere.touch;
                let plane = sum(&scaled(p, &palms[i][0]), &scaled(q, &palms[i][1]));
                let middle = difference(&plane, &scaled(&sphere.radius, &palms[i][2]));
                let away = difference(&found.centre, &middle);
                let wanted = real(800) + &sphere.radius;
                let off = dot(&away, &away) - &wanted * &wanted;
                assert!(off.abs() < Real::power_of_two(-290), "{}", off.to_f64());
                // the contact is on the sphere and on the ball
                let from = difference(&found.contacts[i].world, &middle);
                let off = dot(&from, &from) - &sphere.radius * &sphere.radius;
                assert!(off.abs() < Real::power_of_two(-290), "{}", off.to_f64());
            }
        }
    }

    /// Without spheres it is the linear problem.
    #[test]
    fn planes_are_planes() {
        let (solid, palms) = (body([1200, 1000, 900]), palms());
        let turn = rotation(&[300, 700, -200].map(real));
        let (flat, found) =
            (grip(&solid, &turn, &palms), grip_on(&solid, &turn, &palms, &[None, None, None]));
        for i in 0..3 {
            assert!((&flat.centre[i] - &found.centre[i]).abs() < Real::power_of_two(-300));
        }
    }
}
