//! The bounds of a body's volume from the contacts of simulated motions, and its support function: truth is the body's own.

use nalgebra::Vector3;
use palmistry::mechanics::moving::Course;
use palmistry::mechanics::spatial::*;
use palmistry::shape::sphere::*;
use std::f64::consts::{PI, TAU};

/// Contacts of a body that is laid near a pose and turns at a rate, on three palms at rest.
fn contacts(solid: &ConvexSolid, turn: [f64; 3], rate: [f64; 3]) -> Vec<SurfaceTouch> {
    contacts_on(solid, turn, rate, 0.0, 0.08)
}

/// The same on palms of a curvature, whose spheres touch their planes 2.5 m up, 23 samples a time apart.
fn contacts_on(
    solid: &ConvexSolid,
    turn: [f64; 3],
    rate: [f64; 3],
    curvature: f64,
    apart: f64,
) -> Vec<SurfaceTouch> {
    let touch = [0.0, 2.5];
    let palm = |azimuth: f64| SpatialPalm { azimuth, inertia: 0.5, curvature, touch, ..Default::default() };
    let mut scene = SpatialScene {
        mass: 1.0,
        inertia_over_mass: solid.uniform_inertia(),
        solid: solid.clone(),
        orientation: Orientation::by(&Vector3::from(turn)),
        rate,
        gravity: [0.0, 0.0, -9.81],
        palms: [0.0, TAU / 3.0, 2.0 * TAU / 3.0].map(palm),
        drive: SpatialDrive::Prescribed([PI / 3.0; 3].map(|start| Course { start, ..Course::default() })),
        tolerance: 1e-10,
    };
    scene.orientation = balanced_orientation(&scene).unwrap().expect("a pose of balance");
    let times: Vec<f64> = (0..=22).map(|i| f64::from(i) * apart).collect();
    let found = simulate_solid(&scene, &times).unwrap();
    let palms = found.moments.iter().flat_map(|moment| moment.palms);
    palms.map(|palm| SurfaceTouch { point: palm.touched, normal: palm.outward.normalize() }).collect()
}

/// How it is laid, and its rate.
const RUNS: [([f64; 3], [f64; 3]); 4] = [
    ([0.2, -0.3, 0.4], [0.0, 0.3, 0.3]),
    ([1.2, 0.4, -0.6], [0.3, -0.2, 0.4]),
    ([-0.4, 1.3, 0.8], [-0.3, 0.3, -0.2]),
    ([0.3, -0.8, 2.6], [0.2, 0.4, 0.5]),
];

/// Those that `palmistry advise --runs 4 --trials 64` says for figure 5.3's scene.
const ADVISED: [([f64; 3], [f64; 3]); 4] = [
    ([1.802, 1.145, -0.609], [-0.024, 0.499, -0.016]),
    ([-2.006, -1.905, -0.465], [-0.09, -0.152, -0.467]),
    ([-0.666, -0.083, 1.523], [0.368, -0.289, 0.068]),
    ([-0.377, -2.029, -1.674], [0.47, -0.126, -0.112]),
];

/// Figure 5.3's ellipsoid, four times. One run alone may leave it unbounded, and says so by a direction that no contact looks along.
#[test]
fn bounds_of_figure_5_3_hold_its_volume() {
    let solid = ConvexSolid::new(SolidForm::Ellipsoid { semi_axes: [2.5, 2.0, 1.0] }, None).unwrap();
    let mut touches: Vec<SurfaceTouch> = Vec::new();
    let mut last = 0.0;
    let mut told = Vec::new();
    for (turn, rate) in RUNS {
        touches.extend(contacts(&solid, turn, rate));
        let inner = contact_hull(&touches).unwrap().volume;
        assert!(inner.low() >= last && inner.high() < solid.volume(), "{inner}");
        last = inner.high();
        match half_space_intersection(&touches).unwrap() {
            OuterBound::Bounded(outer) => {
                assert!(outer.volume.low() > solid.volume());
                told.push(outer.volume.high());
            }
            OuterBound::Unbounded { direction } => {
                assert!(touches.iter().all(|touch| touch.normal.dot(&direction) < 1e-14));
                told.push(f64::INFINITY);
            }
        }
    }
    assert!(told.windows(2).all(|pair| pair[1] <= pair[0]), "{told:?}");
    let round = rounded_hull(&touches, 0.4).unwrap().volume;
    assert!(last < round.low() && round.high() < solid.volume(), "{round}");
    let mut least = told[3];
    for radius in [20.0, 6.25] {
        let balls = ball_intersection(&touches, radius).unwrap().volume;
        assert!(solid.volume() < balls.high() && balls.high() < least, "{balls} {least}");
        least = balls.high();
    }
    println!(
        "hull {last}, rounded {}, body {}, half-spaces {told:?}, balls {least}",
        round.low(),
        solid.volume()
    );
    assert!(last > 12.0 && least < 25.0);
}

/// Figure 5.3's ellipsoid, whose radii of curvature are up to 6.25 m, four times on hollow palms of 20 m: each contact tells the ball of its palm, which leaves less than the tangent
/// planes, and all of what a body has that rolls in it.
#[test]
fn hollow_palms_tell_balls() {
    let solid = ConvexSolid::new(SolidForm::Ellipsoid { semi_axes: [2.5, 2.0, 1.0] }, None).unwrap();
    let mut touches: Vec<SurfaceTouch> = Vec::new();
    let mut told = Vec::new();
    for (k, (turn, rate)) in ADVISED.into_iter().enumerate() {
        let run = contacts_on(&solid, turn, rate, -1.0 / 20.0, 0.2);
        assert_eq!(run.len(), 69);
        for touch in &run {
            // the palm's sphere holds all of the body, and touches it at one point
            let centre = touch.point - touch.normal * 20.0;
            for other in &run {
                assert!((other.point - centre).norm() < 20.0 + 1e-12);
            }
        }
        touches.extend(run);
        let half_spaces = match half_space_intersection(&touches).unwrap() {
            OuterBound::Bounded(outer) => outer.volume.high(),
            OuterBound::Unbounded { .. } => f64::INFINITY,
        };
        if [0, 3].contains(&k) {
            let balls = ball_intersection(&touches, 20.0).unwrap().volume;
            assert!(solid.volume() < balls.low() && balls.high() < half_spaces, "{balls} {half_spaces}");
            told.push((half_spaces, balls.high()));
        }
        if k == 0 {
            // one palm of three: its balls and the half-spaces of the others
            let radius = |k: usize| [20.0, f64::INFINITY, f64::INFINITY][k % 3];
            let radii: Vec<f64> = (0..touches.len()).map(radius).collect();
            let some = balls_and_half_spaces(&touches, &radii).unwrap().volume;
            assert!(told[0].1 < some.high() && some.high() < half_spaces, "{some} {told:?}");
        }
    }
    let [(one_run, some), (half_spaces, balls)] = told[..] else { panic!("{told:?}") };
    println!(
        "half-spaces and balls after one run and all {told:?}, hull {}",
        contact_hull(&touches).unwrap().volume
    );
    assert!(one_run.is_infinite() && some < 210.0, "{told:?}");
    assert!(half_spaces > 26.0 && balls < 25.4, "{told:?}");
}

/// A body made of harmonics is found where it was touched, from curves on it alone.
#[test]
fn the_support_function_is_found_from_curves() {
    let harmonic = |powers, coefficient| Harmonic { powers, coefficient };
    let terms = vec![harmonic([2, 0, 0], 0.1), harmonic([0, 3, 0], 0.03), harmonic([1, 1, 1], -0.05)];
    let solid = ConvexSolid::new(SolidForm::Harmonics { mean: 1.2, terms }, None).unwrap();
    let mut touches = contacts(&solid, [0.5, 0.1, -0.4], [0.4, -0.5, 0.6]);
    touches.extend(contacts(&solid, [-1.0, 0.9, 0.7], [-0.5, 0.4, 0.8]));
    let samples: Vec<SolidSample> = touches.iter().map(|touch| SolidSample::of(touch, 1e22)).collect();
    let found = fit_solid(&samples, Some(3)).unwrap();
    // no body has more degrees than three here, so that curves tell all of it
    for direction in [[0.3, -0.5, 0.8], [1.0, 0.2, 0.1], [-0.6, 0.6, -0.5], [0.0, 0.0, 1.0]] {
        let n = Vector3::from(direction).normalize();
        let off = found.support.support(&n) - solid.support(&n).extent;
        assert!(
            off.abs() < 1e-7 && off.abs() < 6.0 * found.deviation(&n) + 1e-12,
            "{off} {}",
            found.deviation(&n)
        );
        let (point, _) = found.support.point_and_bend(&n);
        assert!((point - solid.support(&n).point).norm() < 1e-6);
        assert!(found.support.least_radius(&n) > 0.1);
    }
}
