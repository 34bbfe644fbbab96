//! Poses against a polygon laid between two lines, derivatives against differences, folds and jumps against a scan of all minima.

use super::poses::slope;
use super::*;
use crate::mechanics::moving::{BodyForm, CentreOfMass, Drive, Ended, Knots, MovingScene, Shape};
use crate::mechanics::{Palm, PlanarBody, Real, lowest_pose};
use palmistry_math::number::parse_decimal;
use std::f64::consts::{PI, TAU};

fn shapes() -> Vec<Shape> {
    let harmonics = vec![[0.0, 0.0], [0.05, -0.02], [0.03, 0.01], [0.0, 0.008]];
    let body = |form: BodyForm, centre: CentreOfMass| Shape::new(&form, centre).unwrap();
    vec![
        body(BodyForm::Harmonics { mean: 1.0, harmonics: harmonics.clone() }, CentreOfMass::Uniform),
        body(BodyForm::Harmonics { mean: 1.0, harmonics }, CentreOfMass::At([0.2, -0.1])),
        body(BodyForm::Spline { radii: [0.7, 1.6, 1.1], knots: Knots::Uniform }, CentreOfMass::Uniform),
        body(BodyForm::Spline { radii: [0.7, 1.6, 1.1], knots: Knots::Centripetal }, CentreOfMass::Uniform),
    ]
}

const PALMS: [[f64; 2]; 4] = [[0.3, 1.2], [1.0, 0.6], [0.2, 2.6], [1.8, 0.9]];

/// The height of the centre of mass of a polygon, its corners given about that centre, that is turned and laid between two half lines from the origin: by sliding it until it
/// touches both, with no support function.
fn height_of_polygon(corners: &[[f64; 2]], phi0: f64, [phi1, phi2]: [f64; 2]) -> f64 {
    let (sine, cosine) = phi0.sin_cos();
    let turned = corners.iter().map(|[x, y]| [cosine * x - sine * y, sine * x + cosine * y]);
    let inward = [[-phi1.sin(), phi1.cos()], [(phi1 + phi2).sin(), -(phi1 + phi2).cos()]];
    let mut lowest = [f64::INFINITY; 2];
    for corner in turned {
        for i in 0..2 {
            lowest[i] = lowest[i].min(corner[0] * inward[i][0] + corner[1] * inward[i][1]);
        }
    }
    // the place at which the lowest corners are on the lines
    let [[a, b], [c, d]] = inward;
    (c * lowest[0] - a * lowest[1]) / (a * d - b * c)
}

#[test]
fn a_polygon_laid_between_the_palms_rests_where_the_potential_says() {
    for shape in shapes() {
        let polygon = shape.outline(6000);
        for palms in PALMS {
            let mut found = stable_poses(&shape, palms);
            // minima of the polygon's height on a grid: of neighbours the lowest
            const GRID: usize = 720;
            let step = TAU / GRID as f64;
            let heights: Vec<f64> =
                (0..GRID).map(|i| height_of_polygon(&polygon, step * i as f64, palms)).collect();
            let at = |i: usize| heights[i % GRID];
            let minima: Vec<f64> = (GRID..2 * GRID)
                .filter(|i| at(*i) < at(i - 1) && at(*i) <= at(i + 1))
                .map(|i| step * (i % GRID) as f64)
                .collect();
            assert_eq!(found.len(), minima.len(), "{found:?} {minima:?}");
            for minimum in minima {
                let off = |phi0: &f64| (phi0 - minimum + PI).rem_euclid(TAU) - PI;
                let nearest = found.iter().position(|phi0| off(phi0).abs() <= step).unwrap();
                let phi0 = found.remove(nearest);
                let height = potential(&shape, phi0, palms).value;
                assert!((height - height_of_polygon(&polygon, phi0, palms)).abs() < 1e-5);
            }
        }
    }
}

/// In 320 bits, by differences of heights.
#[test]
fn the_lowest_pose_is_that_of_the_long_numbers() {
    let q = |text: &str| parse_decimal(text).unwrap();
    let harmonics = [(q("0.1"), q("-0.07")), (q("0.08"), q("0.03")), (q("0.02"), q("0.01"))];
    let body = PlanarBody::new(&q("1"), &harmonics).unwrap();
    let [phi1, phi2] = ["0.6", "1.7"].map(|text| Real::from_rational(&q(text)));
    let lowest = lowest_pose(&body, &phi1, &phi2).unwrap().to_f64();
    let form = BodyForm::Harmonics { mean: 1.0, harmonics: vec![[0.1, -0.07], [0.08, 0.03], [0.02, 0.01]] };
    let shape = Shape::new(&form, CentreOfMass::At([0.0; 2])).unwrap();
    let palms = [0.6, 1.7];
    let height = |phi0: f64| potential(&shape, phi0, palms).value;
    let found =
        stable_poses(&shape, palms).into_iter().min_by(|a, b| height(*a).total_cmp(&height(*b))).unwrap();
    assert!(((found - lowest + PI).rem_euclid(TAU) - PI).abs() < 1e-14, "{found} {lowest}");
}

/// Central differences with two steps and Richardson's extrapolation: errors below 1e-9 of values of size one. Splines' second derivatives have kinks.
#[test]
fn gradient_and_hessian_are_those_of_the_value() {
    for shape in &shapes()[..2] {
        for palms in PALMS {
            for phi0 in [0.1, 2.0, 4.4] {
                let at = |by: [f64; 3]| potential(shape, phi0 + by[0], [palms[0] + by[1], palms[1] + by[2]]);
                let here = at([0.0; 3]);
                for i in 0..3 {
                    let moved = |by: f64| at(std::array::from_fn(|k| if k == i { by } else { 0.0 }));
                    let difference = |of: &dyn Fn(Potential) -> f64| {
                        let by = |h: f64| (of(moved(h)) - of(moved(-h))) / (2.0 * h);
                        (4.0 * by(5e-4) - by(1e-3)) / 3.0
                    };
                    let size = 1.0 + here.hessian[i][i].abs();
                    assert!((difference(&|u| u.value) - here.gradient[i]).abs() < 1e-9 * size);
                    for j in 0..3 {
                        let off = difference(&|u| u.gradient[j]) - here.hessian[i][j];
                        assert!(off.abs() < 3e-8 * size, "{i} {j} {off}");
                        assert_eq!(here.hessian[i][j], here.hessian[j][i]);
                    }
                }
                let [first, second] = slope(shape, phi0, palms);
                assert!((first - here.gradient[0]).abs() + (second - here.hessian[0][0]).abs() < 1e-12);
            }
        }
    }
}

/// `1 + e cos k a` has k equal minima by its symmetry whatever the palms, where both wells add up; a disc has none.
#[test]
fn as_many_poses_as_the_symmetry_says() {
    for k in [2u8, 3, 5, 8] {
        let k = f64::from(k);
        let e = 0.5 / (k * k - 1.0);
        let body =
            move |a: f64| [1.0 + e * (k * a).cos(), -e * k * (k * a).sin(), -e * k * k * (k * a).cos()];
        let found = stable_poses(&body, [0.5, 1.3]);
        assert_eq!(found.len(), k as usize);
        for pair in found.windows(2) {
            assert!((pair[1] - pair[0] - TAU / k).abs() < 1e-13);
        }
        let all = stationary_poses(&body, [0.5, 1.3]);
        assert_eq!(all.len(), 2 * found.len());
    }
    let disc = |_: f64| [1.0, 0.0, 0.0];
    assert!(stable_poses(&disc, [0.5, 1.3]).is_empty());
    assert_eq!(descend(&disc, [0.5, 1.3], 0.3), None);
    assert_eq!(descend(&disc, [f64::NAN, 1.3], 0.3), None);
}

/// From anywhere a body falls to the next minimum downhill: the one of the two beside the pose that no crest parts from it.
#[test]
fn a_body_falls_to_the_next_minimum() {
    for shape in shapes() {
        for palms in PALMS {
            let all = stationary_poses(&shape, palms);
            for k in 0..50 {
                let from = 0.011 + TAU * f64::from(k) / 50.0;
                let to = descend(&shape, palms, from).unwrap();
                let downhill = if slope(&shape, from, palms)[0] > 0.0 { -1.0 } else { 1.0 };
                let ahead = |at: &&BalancedPose| (downhill * (at.phi0 - from)).rem_euclid(TAU);
                let next = all.iter().min_by(|a, b| ahead(a).total_cmp(&ahead(b))).unwrap();
                assert!(next.stiffness > 0.0);
                assert!((downhill * (to - from) - ahead(&next)).abs() < 1e-9, "{from} {to} {next:?}");
            }
        }
    }
}

/// Every moment lies in a stable pose, found by the scan of all; at a jump the pose before it is one until just before and none after, the landing is the next one downhill, and between
/// jumps the pose moves a little at a time. Over bodies with jumps of many sizes.
#[test]
fn jumps_are_at_folds_and_land_downhill() {
    let plan = plan_3_14(0.1, 1.0, 1.0).unwrap();
    let (mut jumps, mut least) = (0, f64::INFINITY);
    // a spline of section 3.4 whose jumps are small, and bodies whose centre of mass is off their centroid
    let small = BodyForm::Spline { radii: [2.1648, 2.06095, 1.1325], knots: Knots::Uniform };
    let mut bodies = vec![(Shape::new(&small, CentreOfMass::Uniform).unwrap(), 0.0)];
    for body in 0..12u8 {
        let part = f64::from(body) / 12.0;
        let harmonics =
            vec![[0.0, 0.0], [0.12 - 0.06 * part, 0.02], [0.02 * part, 0.03], [0.0, 0.012 * part]];
        let form = BodyForm::Harmonics { mean: 1.0, harmonics };
        let centre = [0.2 * (TAU * part).cos(), 0.2 * (TAU * part).sin()];
        bodies.push((Shape::new(&form, CentreOfMass::At(centre)).unwrap(), 1.0));
    }
    for (shape, orientation) in bodies {
        let scene = MovingScene {
            gyration: shape.gyration(),
            shape,
            mass: 2.0,
            orientation,
            rate: 0.0,
            gravity: -10.0,
            palm_inertia: [1.0; 2],
            palm_lengths: [f64::INFINITY; 2],
            palms: [Palm::Flat; 2],
            drive: Drive::Prescribed(plan.clone()),
            tolerance: 1e-12,
        };
        let times: Vec<f64> = (0..=400).map(|i| f64::from(i) / 400.0).collect();
        let found = follow_resting(&scene, &times).unwrap();
        assert_eq!((found.ended.clone(), found.moments.len()), (Ended::Completed, 401));
        let off = |a: f64, b: f64| ((a - b + PI).rem_euclid(TAU) - PI).abs();
        let nearest = |palms: [f64; 2], phi0: f64| {
            stable_poses(&scene.shape, palms).into_iter().map(|pose| off(pose, phi0)).fold(f64::MAX, f64::min)
        };
        let at = |time: f64| [0, 1].map(|i: usize| plan[i].at(time)[0]);
        for moment in &found.moments {
            assert!(nearest(at(moment.time), moment.phi0) < 1e-9);
            // forces and torques: what carries the weight, whose torque about the centre of mass is none
            let forces = moment.palms.map(|palm| palm.force);
            let (phi1, phi12) = (moment.palms[0].angle, moment.palms[0].angle + moment.palms[1].angle);
            let up = forces[0] * phi1.cos() - forces[1] * phi12.cos();
            let side = -forces[0] * phi1.sin() + forces[1] * phi12.sin();
            assert!((up - 20.0).abs() < 1e-9 && side.abs() < 1e-9);
            let torque = forces[0] * moment.palms[0].d - -forces[1] * moment.palms[1].d;
            assert!(torque.abs() < 1e-8, "{torque}");
        }
        for jump in &found.jumps {
            assert!(nearest(at(jump.time - 1e-7), jump.from) < 1e-2, "{jump:?}");
            assert!(nearest(at(jump.time + 1e-7), jump.from) > 0.5 * (jump.to - jump.from).abs(), "{jump:?}");
            assert!(nearest(jump.palms, jump.to) < 1e-6 && jump.drop > 0.0);
            assert!(slope(&scene.shape, jump.from, jump.palms)[1].abs() < 1e-3, "3.43");
            least = least.min((jump.to - jump.from).abs());
        }
        jumps += found.jumps.len();
        for pair in found.moments.windows(2) {
            let fell = found.jumps.iter().any(|jump| (pair[0].time..=pair[1].time).contains(&jump.time));
            assert!(fell || (pair[1].phi0 - pair[0].phi0).abs() < 0.5);
        }
    }
    assert!(jumps >= 4, "{jumps}");
    // the least of the spline's
    assert!(least < 0.1 && least > 0.05, "{least}");
}
