//! Spherical palms in space: against the bodies in 320 bits that touch them by their centres alone, a ball by hand, flat palms in the
//! limit, and the laws that any motion keeps.

use super::drawn::Dice;
use super::spatial::{against_320_bits, balanced, every, figure_5_3, forms, resting, scene, swinging};
use nalgebra::Vector3;
use palmistry::mechanics::moving::{Course, Oscillation, PushedPalm};
use palmistry::mechanics::spatial::*;
use palmistry::mechanics::*;
use std::f64::consts::PI;

/// Bent about where a body of about a metre touches.
fn bent(mut scene: SpatialScene, curvatures: [f64; 3]) -> SpatialScene {
    for (palm, curvature) in scene.palms.iter_mut().zip(curvatures) {
        palm.curvature = curvature;
        palm.touch = if curvature == 0.0 { [0.0; 2] } else { [0.1, 1.8] };
    }
    scene
}

/// Of each palm: where its sphere's centre is, and the normal of its plane.
fn sphere_of(scene: &SpatialScene, moment: &SpatialMoment, i: usize) -> (Vector3<f64>, Vector3<f64>) {
    let (palm, angle) = (&scene.palms[i], moment.palms[i].angle);
    let ((sa, ca), (s, c)) = (palm.azimuth.sin_cos(), angle.sin_cos());
    let (axis, up) = (Vector3::new(sa, -ca, 0.0), Vector3::new(c * ca, c * sa, s));
    let plane = axis.cross(&up);
    let [along, high] = palm.touch;
    (Vector3::from(palm.hinge) + axis * along + up * high - plane / palm.curvature, plane)
}

#[test]
fn forces_and_accelerations_on_spheres_are_those_in_320_bits() {
    let mut dice = Dice::new(19);
    let of = |dice: &mut Dice, low, high| {
        let touch = [dice.real(-200, 200), dice.real(900, 1600)];
        Some(PalmSphere { radius: dice.real(low, high), touch })
    };
    // half a minute each where 320 bits are not optimised
    let draws = if cfg!(debug_assertions) { 1 } else { 4 };
    let bulging = |dice: &mut Dice| [(); 3].map(|()| of(dice, 800, 3000));
    let hollow = |dice: &mut Dice| [(); 3].map(|()| of(dice, -9000, -4000));
    let mixed = |dice: &mut Dice| [of(dice, 800, 3000), None, of(dice, -9000, -4000)];
    type Drawn<'a> = &'a dyn Fn(&mut Dice) -> [Option<PalmSphere>; 3];
    let mut held = 0;
    for (name, spheres) in
        [("bulging", &bulging as Drawn<'_>), ("hollow", &hollow as Drawn<'_>), ("mixed", &mixed as Drawn<'_>)]
    {
        let found: Vec<f64> = (0..draws).filter_map(|_| against_320_bits(&mut dice, spheres)).collect();
        println!("{name}: {} held, worst {:e}", found.len(), found.iter().copied().fold(0.0, f64::max));
        held += found.len();
    }
    assert!(held > draws, "{held}");
}

/// A ball of the radius `a` has its centre `a + rho` from the centre of each sphere, whatever turns; at rest it is carried along these lines. On level palms that bulge it
/// rests as on three balls: with the centres of four balls at the corners of a tetrahedron each carries a third of the weight over `sqrt(2/3)`.
#[test]
fn a_ball_lies_on_spheres_as_by_hand() {
    let ball = SolidForm::Ellipsoid { semi_axes: [1.0; 3] };
    for curvatures in [[0.4, 0.5, 0.4], [-0.3, -0.2, -0.3], [0.3, 0.0, -0.2]] {
        let scene = bent(scene(ball.clone(), Orientation::upright(), [0.3, -0.2, 0.5]), curvatures);
        let found = simulate_solid(&scene, &[0.0, 0.2]).unwrap();
        assert_eq!(found.ended, SpatialEnded::Completed);
        for moment in &found.moments {
            for i in (0..3).filter(|i| scene.palms[*i].curvature != 0.0) {
                let (middle, _) = sphere_of(&scene, moment, i);
                let away = moment.centre - middle;
                let wanted = 1.0 + 1.0 / scene.palms[i].curvature;
                assert!((away.norm() - wanted.abs()).abs() < 1e-13, "{}", away.norm());
                let along = away / wanted;
                assert!((along - moment.palms[i].normal).norm() < 1e-13);
            }
        }
    }
    let mut scene = scene(ball, Orientation::upright(), [0.0; 3]);
    for palm in &mut scene.palms {
        // balls of the same size as the one they carry, their centres 2 m from each other
        (palm.curvature, palm.touch) = (1.0, [0.0, 2.0 / 3f64.sqrt()]);
    }
    scene.drive = SpatialDrive::Prescribed([0.0; 3].map(resting));
    let found = simulate_solid(&scene, &[0.0]).unwrap();
    let moment = &found.moments[0];
    // the height of a tetrahedron over its base, which is 1 m under the planes
    assert!((moment.centre - Vector3::new(0.0, 0.0, 2.0 * (2.0f64 / 3.0).sqrt() - 1.0)).norm() < 1e-13);
    for palm in &moment.palms {
        assert!((palm.force - 9.81 / 3.0 / (2.0f64 / 3.0).sqrt()).abs() < 1e-12, "{}", palm.force);
        // the contact is half way between both centres: 1/sqrt(3) from the axis, its own sphere's at 2/sqrt(3)
        assert!((palm.sensed[1] - 1.0 / 3f64.sqrt()).abs() < 1e-13, "{:?}", palm.sensed);
    }
    assert!(moment.acceleration.norm() < 1e-12);
}

/// Motions on spheres become those on planes, in proportion to the curvature.
#[test]
fn slightly_bent_palms_are_flat() {
    let start =
        balanced(scene(forms()[1].clone(), Orientation::by(&Vector3::new(0.5, 0.1, -0.4)), [0.1, -0.2, 0.3]));
    let start = SpatialScene {
        drive: SpatialDrive::Prescribed(std::array::from_fn(|i| swinging(PI / 3.0, i as f64))),
        ..start
    };
    let flat = simulate_solid(&start, &[0.0, 0.3]).unwrap();
    let off = |curvature: f64| {
        let bent =
            simulate_solid(&bent(start.clone(), [curvature, -curvature, curvature]), &[0.0, 0.3]).unwrap();
        let both = bent.moments.iter().zip(&flat.moments);
        both.map(|(bent, flat)| {
            let vectors = (bent.centre - flat.centre).norm()
                + (bent.velocity - flat.velocity).norm()
                + (bent.turning - flat.turning).norm();
            (0..3).fold(vectors, |sum, i| sum + (bent.palms[i].force - flat.palms[i].force).abs())
        })
        .fold(0.0, f64::max)
    };
    let [a, b, c] = [1e-4, 1e-6, 1e-8].map(off);
    println!("{a:e} {b:e} {c:e}");
    assert!(a < 0.1 && (a / b - 100.0).abs() < 0.1 && (b / c - 100.0).abs() < 0.1, "{a:e} {b:e} {c:e}");
}

/// Energy, contacts that are on body and sphere, and rates by differences of a motion, on palms that swing about hinges which do not meet.
#[test]
fn motions_on_spheres_keep_energy_and_contact() {
    for (k, form) in forms().into_iter().enumerate() {
        let mut start = scene(form, Orientation::by(&Vector3::new(0.5, 0.1, -0.4)), [0.1, -0.2, 0.3]);
        for (palm, hinge) in start.palms.iter_mut().zip([[0.3, 0.0, 0.1], [0.0, -0.2, 0.0], [0.1, 0.1, -0.1]])
        {
            palm.hinge = hinge;
        }
        let mut scene = balanced(bent(
            start,
            [[0.5, 0.3, 0.4], [-0.1, -0.08, -0.12], [0.4, -0.1, 0.0], [-0.1, 0.3, 0.2]][k],
        ));
        scene.drive = SpatialDrive::Prescribed(std::array::from_fn(|i| swinging(PI / 3.0, i as f64)));
        let step = 1e-4;
        let mut times = every(0.05, 0.5);
        times.extend([0.5 + step, 0.5 + 2.0 * step]);
        let found = simulate_solid(&scene, &times).unwrap();
        assert_eq!(found.ended, SpatialEnded::Completed, "form {k}");
        println!("form {k}: energy {:e} of {}", found.energy_drift(), found.start_energy);
        assert!(found.energy_drift() < 1e-9 * found.start_energy.abs(), "{}", found.energy_drift());
        for moment in &found.moments {
            for (i, palm) in moment.palms.iter().enumerate() {
                let touched = moment.centre + moment.orientation.matrix() * palm.touched;
                assert!((touched - palm.contact).norm() < 1e-13);
                if scene.palms[i].curvature != 0.0 {
                    let (middle, plane) = sphere_of(&scene, moment, i);
                    let away = (palm.contact - middle) * scene.palms[i].curvature;
                    assert!((away - palm.normal).norm() < 1e-12, "{}", (away - palm.normal).norm());
                    assert!(palm.normal.dot(&plane) > 0.5);
                }
            }
        }
        // the third derivatives are some tens: differences are off by a sixth of that times the square of the step
        let [before, here, after] = &found.moments[10..] else { panic!() };
        let close = |what: &str, found: Vector3<f64>, expected: Vector3<f64>| {
            assert!((found - expected).norm() < 2e-6, "{k} {what}: {found} {expected}");
        };
        close("velocity", (after.centre - before.centre) / (2.0 * step), here.velocity);
        close("acceleration", (after.velocity - before.velocity) / (2.0 * step), here.acceleration);
        close("turning", (after.rate - before.rate) / (2.0 * step), here.turning);
    }
}

/// Pushed palms that are spheres keep the balance of energy and work.
#[test]
fn spheres_that_are_pushed_do_work() {
    let form = SolidForm::Ellipsoid { semi_axes: [1.2, 1.0, 0.9] };
    let mut scene = balanced(bent(scene(form, Orientation::upright(), [0.05, 0.1, 0.2]), [-0.1, 0.2, -0.1]));
    let still = simulate_solid(&scene, &[0.0]).unwrap();
    let torques = still.moments[0].palms.map(|palm| palm.torque);
    scene.drive = SpatialDrive::Torques(std::array::from_fn(|i| PushedPalm {
        angle: PI / 3.0,
        rate: 0.0,
        torque: torques[i],
        swings: vec![Oscillation { amplitude: 0.3, frequency: 1.0, phase: i as f64 }],
    }));
    let pushed = simulate_solid(&scene, &every(0.05, 0.4)).unwrap();
    assert_eq!(pushed.ended, SpatialEnded::Completed);
    assert!(pushed.energy_drift() < 1e-9, "{}", pushed.energy_drift());
    assert!(pushed.moments.last().unwrap().work.abs() > 1e-4);
}

/// What balances on spheres is at rest.
#[test]
fn balance_on_spheres_is_rest() {
    for (form, curvatures) in
        forms().into_iter().zip([[0.5, 0.3, 0.4], [-0.1, -0.08, -0.12], [0.0, -0.1, 0.2], [-0.1; 3]])
    {
        let scene =
            balanced(bent(scene(form, Orientation::by(&Vector3::new(0.5, 0.1, -0.4)), [0.0; 3]), curvatures));
        let found = simulate_solid(&scene, &[0.0]).unwrap();
        let start = &found.moments[0];
        assert!(start.turning.norm() < 1e-10 && start.acceleration.norm() < 1e-10, "{}", start.turning);
        let carried = start.palms.iter().fold(Vector3::zeros(), |sum, palm| sum + palm.normal * palm.force);
        assert!((carried - Vector3::new(0.0, 0.0, 9.81)).norm() < 1e-10);
    }
}

/// A palm that swings too fast leaves the body, and is located.
#[test]
fn a_contact_with_a_sphere_that_breaks_is_located() {
    let mut scene = figure_5_3();
    for palm in &mut scene.palms {
        (palm.curvature, palm.touch) = (-0.05, [0.0, 2.0]);
    }
    let mut scene = balanced(scene);
    let swing = Oscillation { amplitude: 0.1, frequency: 1.5, phase: -PI / 2.0 };
    let palm = Course { start: PI / 3.0 + 0.1, rate: 0.0, swings: vec![swing] };
    scene.drive = SpatialDrive::Prescribed([palm, resting(PI / 3.0), resting(PI / 3.0)]);
    let found = simulate_solid(&scene, &every(0.1, 5.0)).unwrap();
    let SpatialEnded::ContactLost { palm, time } = found.ended else { panic!("{:?}", found.ended) };
    println!("palm {palm} at {time} s");
    let last = found.moments.last().unwrap();
    assert!((0.0..1e-8).contains(&last.palms[palm - 1].force), "{}", last.palms[palm - 1].force);
    assert!(found.energy_drift() < 1e-9 * found.start_energy.abs());
}

/// An ellipsoid of the semi-axes 2.5, 2, 1 has radii of curvature up to `2.5^2/1`.
#[test]
fn a_palm_that_is_too_hollow_is_refused() {
    let with = |radius: f64| {
        let mut scene = figure_5_3();
        (scene.palms[1].curvature, scene.palms[1].touch) = (-1.0 / radius, [0.0, 2.0]);
        simulate_solid(&scene, &[0.0]).map(|_| ())
    };
    let Err(SpatialSceneError::Hollow { palm: 2, own, least, .. }) = with(6.24) else {
        panic!("{:?}", with(6.24))
    };
    assert!((own - 6.25).abs() < 1e-9 && (least + 0.16).abs() < 1e-9, "{own} {least}");
    assert!(with(6.26).is_ok(), "{:?}", with(6.26));
    // harmonics: along a meridian 1 + c (2 - 3 z^2), at most 1 + 2 c
    let term = Harmonic { powers: [0, 0, 2], coefficient: 0.2 };
    let solid = ConvexSolid::new(SolidForm::Harmonics { mean: 1.0, terms: vec![term] }, None).unwrap();
    assert!(solid.rolls_in(1.41).is_ok() && solid.rolls_in(1.39).is_err());
    // of a body with rounded edges: greater than all that are met, and of that size
    let edged = SolidForm::Superellipsoid { semi_axes: [0.8, 0.6, 0.5], exponent: 4, rounding: 0.5 };
    let solid = ConvexSolid::new(edged, None).unwrap();
    let (_, bound) = solid.rolls_in(0.5).unwrap_err();
    let met = (0..400).map(|k| {
        let (s, c) = (f64::from(k) * 0.61).sin_cos();
        let n = Vector3::new(s, c, (f64::from(k) * 0.137).sin()).normalize();
        solid.support(&n).bend.try_symmetric_eigen(f64::EPSILON, 1000).unwrap().eigenvalues.max()
    });
    let met = met.fold(0.0, f64::max);
    assert!(met < bound && bound < 5.0 * met, "{met} {bound}");
    // spheres so far apart that nothing touches them all
    let mut scene = figure_5_3();
    for palm in &mut scene.palms {
        (palm.curvature, palm.touch) = (1.0, [0.0, 40.0]);
    }
    assert_eq!(simulate_solid(&scene, &[0.0]).map(|_| ()), Err(SpatialSceneError::NoContact));
}

/// A ball on three small balls that turn under it, until it would touch their other halves. By hand: the centre of the ball of 1 m is over the middle, `s` is `(0.8 + 0.1 sin phi) a - 0.1 cos phi e_z` with
/// the palms' direction `a`, so that the angle of the contact's normal is `sin alpha = (0.8 + 0.1 sin phi)/1.1`; it is at a right angle to the plane's where `phi = alpha + pi/2`.
#[test]
fn a_contact_that_leaves_its_half_of_a_sphere_is_told() {
    let mut scene = scene(SolidForm::Ellipsoid { semi_axes: [1.0; 3] }, Orientation::upright(), [0.0; 3]);
    for palm in &mut scene.palms {
        let (s, c) = palm.azimuth.sin_cos();
        (palm.curvature, palm.hinge) = (10.0, [0.8 * c, 0.8 * s, 0.0]);
    }
    scene.drive = SpatialDrive::Prescribed([(); 3].map(|()| Course { rate: 1.0, ..resting(PI / 3.0) }));
    let found = simulate_solid(&scene, &every(0.1, 2.0)).unwrap();
    let alpha = (0.8 / 1.1f64.hypot(0.1)).asin() + (0.1f64 / 1.1).atan();
    let expected = alpha + PI / 2.0 - PI / 3.0;
    let SpatialEnded::NoContact { time } = found.ended else { panic!("{:?}", found.ended) };
    // contacts are followed to a ten-thousandth of the radius from the rim, 1.4e-2 rad
    assert!((1e-2..2e-2).contains(&(expected - time)), "{time} {expected}");
    assert_eq!(found.moments.len(), 15);
    assert!(found.energy_drift() < 1e-9 * found.start_energy.abs(), "{}", found.energy_drift());
}
