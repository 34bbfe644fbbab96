//! Bodies in space through time, in doubles: against the bodies in 320 bits, the constraint of `proofs/`, and the laws that any
//! motion keeps.

use crate::mechanics::drawn::Dice;
use crate::mechanics::sheet::OpenSheet;
use nalgebra::{Matrix3, Vector3};
use palmistry::System;
use palmistry::mechanics::moving::{Course, Oscillation, PushedPalm};
use palmistry::mechanics::spatial::*;
use palmistry::mechanics::*;
use palmistry::number::{rational_from_f64, rational_to_f64};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::path::Path;

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

pub fn resting(angle: f64) -> Course {
    Course { start: angle, ..Course::default() }
}

pub fn thirds() -> [SpatialPalm; 3] {
    [0.0, TAU / 3.0, 2.0 * TAU / 3.0].map(|azimuth| SpatialPalm {
        azimuth,
        inertia: 0.5,
        ..Default::default()
    })
}

/// A uniform body on three palms at 60 degrees, whose hinges are at 60 degrees with each other.
pub fn scene(form: SolidForm, orientation: Orientation, rate: [f64; 3]) -> SpatialScene {
    let solid = ConvexSolid::new(form, None).unwrap();
    SpatialScene {
        mass: 1.0,
        inertia_over_mass: solid.uniform_inertia(),
        solid,
        orientation,
        rate,
        gravity: GRAVITY,
        palms: thirds(),
        drive: SpatialDrive::Prescribed([PI / 3.0; 3].map(resting)),
        tolerance: 1e-13,
    }
}

pub fn balanced(mut scene: SpatialScene) -> SpatialScene {
    scene.orientation = balanced_orientation(&scene).unwrap().expect("a pose of balance");
    scene
}

pub fn every(step: f64, end: f64) -> Vec<f64> {
    (0..=(end / step).round() as usize).map(|i| i as f64 * step).collect()
}

pub fn figure_5_3() -> SpatialScene {
    let form = SolidForm::Ellipsoid { semi_axes: [2.5, 2.0, 1.0] };
    balanced(scene(form, Orientation::by(&Vector3::new(0.2, -0.3, 0.4)), [0.0, 0.3, 0.3]))
}

/// One body of each kind of form.
pub fn forms() -> Vec<SolidForm> {
    let harmonic = |powers, coefficient| Harmonic { powers, coefficient };
    let terms = vec![harmonic([2, 0, 0], 0.1), harmonic([0, 3, 0], 0.03), harmonic([1, 1, 1], -0.05)];
    let harmonics = SolidForm::Harmonics { mean: 1.2, terms };
    let edged = SolidForm::Superellipsoid { semi_axes: [0.8, 0.6, 0.5], exponent: 4, rounding: 0.5 };
    let ellipsoid = SolidForm::Ellipsoid { semi_axes: [1.2, 1.0, 0.9] };
    let blend = SolidForm::Blend(vec![(0.4, harmonics.clone()), (0.6, ellipsoid.clone())]);
    vec![ellipsoid, harmonics, edged, blend]
}

pub fn swinging(start: f64, phase: f64) -> Course {
    let swings = vec![Oscillation { amplitude: 0.05, frequency: 0.8, phase }];
    Course { start, rate: 0.02, swings }
}

#[test]
fn figure_5_3_keeps_contact_where_it_starts_in_balance() {
    let scene = figure_5_3();
    let found = simulate_solid(&scene, &every(0.2, 4.4)).unwrap();
    assert_eq!(found.ended, SpatialEnded::Completed);
    assert_eq!(found.moments.len(), 23);
    assert!(found.energy_drift() < 1e-9 * found.start_energy.abs(), "{}", found.energy_drift());
    let forces = found.moments.iter().flat_map(|moment| moment.palms.map(|palm| palm.force));
    let least = forces.fold(f64::INFINITY, f64::min);
    println!("least force {least} N, energy {:e} of {}", found.energy_drift(), found.start_energy);
    let [first, last] = [&found.moments[0], &found.moments[22]];
    println!(
        "{:?}\n{:?}\n{}",
        first.palms.map(|palm| palm.sensed),
        last.palms.map(|palm| palm.sensed),
        last.rate
    );
    assert!(least > 0.5);
}

/// The contact, the body's own point and the palm have one place, and the body is above all palms.
#[test]
fn motions_of_all_forms_keep_energy_contact_and_laws() {
    for (k, form) in forms().into_iter().enumerate() {
        let mut scene =
            balanced(scene(form, Orientation::by(&Vector3::new(0.5, 0.1, -0.4)), [0.1, -0.2, 0.3]));
        for driven in [false, true] {
            let start = scene.clone();
            if driven {
                scene.drive = SpatialDrive::Prescribed(std::array::from_fn(|i| swinging(PI / 3.0, i as f64)));
                scene.orientation = start.orientation;
            }
            let found = simulate_solid(&scene, &every(0.05, 0.5)).unwrap();
            assert_eq!(found.ended, SpatialEnded::Completed, "form {k}, {driven}");
            assert!(found.energy_drift() < 1e-9 * found.start_energy.abs(), "{}", found.energy_drift());
            for moment in &found.moments {
                let turn = moment.orientation.matrix();
                for palm in &moment.palms {
                    let touched = moment.centre + turn * palm.touched;
                    assert!((touched - palm.contact).norm() < 1e-13);
                    // no other point of the body is below the palm
                    assert!(palm.normal.dot(&palm.contact).abs() < 1e-12);
                    for other in &moment.palms {
                        let room = palm.normal.dot(&other.contact);
                        assert!(room > -1e-12, "{room}");
                    }
                }
            }
        }
    }
}

/// The constraint of `proofs/moll2002/space/constraint.proof` along simulated motions, and its laws: the rates of velocity and
/// angular velocity, which were derived there from momenta.
#[test]
fn the_constraint_of_the_proofs_vanishes_along_motions() {
    let mut worst: f64 = 0.0;
    for form in forms() {
        let mut scene =
            balanced(scene(form, Orientation::by(&Vector3::new(0.5, 0.1, -0.4)), [0.1, -0.2, 0.3]));
        scene.mass = 1.7;
        scene.drive = SpatialDrive::Prescribed(std::array::from_fn(|i| swinging(PI / 3.0, i as f64)));
        let found = simulate_solid(&scene, &every(0.4, 0.4)).unwrap();
        assert_eq!(found.ended, SpatialEnded::Completed);
        for moment in &found.moments {
            let turn = moment.orientation.matrix();
            let inertia = turn * scene.inertia_over_mass * turn.transpose();
            let (inverse, momentum) = (inertia.try_inverse().unwrap(), inertia * moment.rate);
            let mut point: HashMap<String, f64> = HashMap::new();
            for i in 0..3 {
                let palm = &moment.palms[i];
                let numbers = [
                    ("x", moment.centre[i]),
                    ("v", moment.velocity[i]),
                    ("l", momentum[i]),
                    ("tilt", palm.angle),
                    ("around", scene.palms[i].azimuth),
                    ("w", palm.rate),
                    ("p", palm.sensed[0]),
                    ("q", palm.sensed[1]),
                    ("force", palm.force),
                ];
                point.extend(numbers.map(|(name, value)| (format!("{name}[{}]", i + 1), value)));
            }
            for (name, i, j) in
                [("k11", 0, 0), ("k12", 0, 1), ("k13", 0, 2), ("k22", 1, 1), ("k23", 1, 2), ("k33", 2, 2)]
            {
                point.insert(name.to_owned(), inverse[(i, j)]);
            }
            point.insert("over_m".to_owned(), 1.0 / scene.mass);
            point.insert("g".to_owned(), GRAVITY[2]);
            let point =
                point.into_iter().map(|(name, value)| (name, rational_from_f64(value).unwrap())).collect();
            let system = System::read(Path::new("proofs/moll2002/space/constraint.proof")).unwrap();
            let mut sheet = OpenSheet::new(system, &point);
            let mut vanishes = |text: &str, expected: [f64; 3]| {
                for (found, expected) in sheet.value(text).iter().zip(expected) {
                    let apart = (rational_to_f64(found) - expected).abs();
                    worst = worst.max(apart);
                    assert!(apart < 1e-11, "{text}: {apart:e}");
                }
            };
            vanishes("[y[1..3]]", [0.0; 3]);
            vanishes("[L(time, v[1]), L(time, v[2]), L(time, v[3])]", moment.acceleration.into());
            vanishes("L(time, omega)", moment.turning.into());
        }
    }
    println!("worst {worst:e}");
}

fn double(value: &Real) -> f64 {
    value.to_f64()
}

fn doubles(values: &[Real; 3]) -> Vector3<f64> {
    Vector3::from(values.each_ref().map(double))
}

fn matrix(rows: &[[Real; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| double(&rows[i][j]))
}

/// Forces, torques and accelerations of bodies in 320 bits, whose motion is differenced and which know neither Euler's equation
/// nor second derivatives of a support function.
#[test]
fn forces_and_accelerations_are_those_of_the_bodies_in_320_bits() {
    let mut dice = Dice::new(73);
    let found: Vec<f64> =
        (0..4).filter_map(|_| against_320_bits(&mut dice, &|_| [None, None, None])).collect();
    println!("{} held, worst {:e}", found.len(), found.iter().copied().fold(0.0, f64::max));
    assert!(found.len() >= 2, "{}", found.len());
}

/// The greatest relative difference of a drawn motion from that in 320 bits, on palms with these spheres; none where a palm would have to pull, which has to be by as much in both.
pub fn against_320_bits(
    dice: &mut Dice,
    spheres: &dyn Fn(&mut Dice) -> [Option<PalmSphere>; 3],
) -> Option<f64> {
    let mut worst: f64 = 0.0;
    let shape = dice.bumpy();
    let motion = dice.solid_motion(&shape);
    let motion = SolidMotion { spheres: spheres(dice), ..motion };
    let inertia = SolidInertia {
        mass: dice.real(500, 2000),
        second_moments: [dice.real(200, 400), dice.real(200, 400), dice.real(200, 400)],
        palms: [0; 3].map(|_| dice.real(200, 800)),
        gravity: dice.real(-9810, -9810),
    };
    let exact = solid_dynamics(&motion, &inertia);
    let number = rational_to_f64;
    let term = |powers, coefficient| Harmonic { powers, coefficient };
    let mut terms = vec![term([1, 1, 1], number(&shape.cubic))];
    for i in 0..3 {
        let power = |by: u32| std::array::from_fn(|j| if i == j { by } else { 0 });
        terms.push(term(power(1), number(&shape.centre[i])));
        terms.push(term(power(4), number(&shape.quartic[i])));
    }
    let axes = shape.axes.each_ref().map(number);
    let form = SolidForm::Blend(vec![
        (1.0, SolidForm::Ellipsoid { semi_axes: axes }),
        (1.0, SolidForm::Harmonics { mean: 0.0, terms }),
    ]);
    let mass = double(&inertia.mass);
    let second = Matrix3::from_diagonal(&doubles(&inertia.second_moments)) / mass;
    let turn = matrix(&exact.tumbling.turn[0]);
    let vector = nalgebra::Rotation3::from_matrix_unchecked(turn).scaled_axis();
    let course = |swing: &Swing| Course {
        // an acceleration as that of an oscillation a quarter of a turn on: -a (2 pi f)^2 sin(pi/2)
        start: double(&swing.value) + double(&swing.acceleration) / (TAU * TAU),
        rate: double(&swing.rate),
        swings: vec![Oscillation {
            amplitude: -double(&swing.acceleration) / (TAU * TAU),
            frequency: 1.0,
            phase: PI / 2.0,
        }],
    };
    let scene = SpatialScene {
        solid: ConvexSolid::new(form, Some([0.0; 3])).unwrap(),
        mass,
        inertia_over_mass: Matrix3::identity() * second.trace() - second,
        orientation: Orientation::by(&vector),
        rate: doubles(&angular_velocity(&exact.tumbling.turn)).into(),
        gravity: [0.0, 0.0, double(&inertia.gravity)],
        palms: std::array::from_fn(|i| SpatialPalm {
            azimuth: double(&motion.azimuths[i]),
            inertia: double(&inertia.palms[i]),
            curvature: motion.spheres[i].as_ref().map_or(0.0, |sphere| 1.0 / double(&sphere.radius)),
            touch: motion.spheres[i].as_ref().map_or([0.0; 2], |sphere| sphere.touch.each_ref().map(double)),
            ..SpatialPalm::default()
        }),
        drive: SpatialDrive::Prescribed(motion.palms.each_ref().map(course)),
        tolerance: 1e-12,
    };
    let found = match simulate_solid(&scene, &[0.0]) {
        Ok(found) => found,
        Err(SpatialSceneError::NotHeld { palm, force }) => {
            let expected = double(&exact.forces[palm - 1]);
            assert!((force - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{force} {expected}");
            return None;
        }
        Err(other) => panic!("{other}"),
    };
    let moment = &found.moments[0];
    let mut same = |what: &str, found: f64, expected: f64| {
        let apart = (found - expected).abs() / (1.0 + expected.abs());
        worst = worst.max(apart);
        assert!(apart < 1e-10, "{what}: {found} {expected}");
    };
    let [centre, velocity, acceleration] = exact.tumbling.centre.each_ref().map(doubles);
    let turning = doubles(&angular_acceleration(&exact.tumbling.turn));
    for i in 0..3 {
        same("centre", moment.centre[i], centre[i]);
        same("velocity", moment.velocity[i], velocity[i]);
        same("acceleration", moment.acceleration[i], acceleration[i]);
        same("turning", moment.turning[i], turning[i]);
        same("force", moment.palms[i].force, double(&exact.forces[i]));
        same("torque", moment.palms[i].torque, double(&exact.torques[i]));
        let sensed = doubles(&exact.tumbling.contacts[i].sensed[0]);
        same("sensed", moment.palms[i].sensed[0], sensed[0]);
        same("sensed", moment.palms[i].sensed[1], sensed[1]);
    }
    Some(worst)
}

/// The energy of body and pushed palms changes by the work of the torques, and palms that are told to accelerate as pushed ones do
/// need their torques.
#[test]
fn palms_that_are_pushed_move_as_the_laws_ask() {
    let form = SolidForm::Ellipsoid { semi_axes: [1.2, 1.0, 0.9] };
    let mut scene = balanced(scene(form, Orientation::upright(), [0.05, 0.1, 0.2]));
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
    let last = pushed.moments.last().unwrap();
    assert!(last.work.abs() > 1e-4 && last.palms[0].rate != 0.0);
    // at the start the swings add their torque over the inertia, less what the body takes
    let first = &pushed.moments[0];
    let scene_of = |accelerations: [f64; 3]| {
        let courses = accelerations.map(|a| Course {
            start: PI / 3.0 + a / (TAU * TAU),
            rate: 0.0,
            swings: vec![Oscillation { amplitude: -a / (TAU * TAU), frequency: 1.0, phase: PI / 2.0 }],
        });
        SpatialScene { drive: SpatialDrive::Prescribed(courses), ..scene.clone() }
    };
    let told = simulate_solid(&scene_of(first.palms.map(|palm| palm.acceleration)), &[0.0]).unwrap();
    for i in 0..3 {
        let (told, pushed) = (&told.moments[0].palms[i], &first.palms[i]);
        assert!((told.force - pushed.force).abs() < 1e-11, "{} {}", told.force, pushed.force);
        assert!((told.torque - pushed.torque).abs() < 1e-11);
    }
}

/// Velocities and angular velocities are those of places and orientations, by central differences of a motion on palms that swing
/// about hinges which do not meet.
#[test]
fn rates_are_those_of_the_motion() {
    let [form, ..] = &forms()[..] else { panic!() };
    let mut scene = scene(form.clone(), Orientation::by(&Vector3::new(0.5, 0.1, -0.4)), [0.1, -0.2, 0.3]);
    for (palm, hinge) in scene.palms.iter_mut().zip([[0.3, 0.0, 0.1], [0.0, -0.2, 0.0], [0.1, 0.1, -0.1]]) {
        palm.hinge = hinge;
    }
    let mut scene = balanced(scene);
    scene.drive = SpatialDrive::Prescribed(std::array::from_fn(|i| swinging(PI / 3.0, i as f64)));
    // the third derivatives are about 60: differences are off by a sixth of that times the square of the step
    let step = 1e-4;
    let found = simulate_solid(&scene, &[0.3 - step, 0.3, 0.3 + step]).unwrap();
    assert_eq!(found.ended, SpatialEnded::Completed);
    let [before, here, after] = &found.moments[..] else { panic!() };
    let close = |what: &str, found: Vector3<f64>, expected: Vector3<f64>| {
        assert!((found - expected).norm() < 1e-6, "{what}: {found} {expected}");
    };
    close("velocity", (after.centre - before.centre) / (2.0 * step), here.velocity);
    close("acceleration", (after.velocity - before.velocity) / (2.0 * step), here.acceleration);
    close("turning", (after.rate - before.rate) / (2.0 * step), here.turning);
    let change = (after.orientation.matrix() - before.orientation.matrix()) / (2.0 * step);
    let hat = change * here.orientation.matrix().transpose();
    close("rate", Vector3::new(hat[(2, 1)], hat[(0, 2)], hat[(1, 0)]), here.rate);
    for i in 0..3 {
        let [before, here, after] = [before, here, after].map(|moment| &moment.palms[i]);
        let [a, b, c] = [before, here, after].map(|palm| palm.contact);
        // the contact stays on the palm: along the normal it moves as the palm does
        let hinge = Vector3::from(scene.palms[i].hinge);
        assert!(here.normal.dot(&(b - hinge)).abs() < 1e-13);
        let turned = (after.normal - before.normal) / (2.0 * step);
        assert!((turned.dot(&(b - hinge)) + here.normal.dot(&((c - a) / (2.0 * step)))).abs() < 1e-6);
    }
}

/// A palm that swings too fast leaves the body on its way down: at that moment, and not before, its force is zero.
#[test]
fn a_contact_that_breaks_is_located() {
    let mut scene = figure_5_3();
    let swing = Oscillation { amplitude: 0.1, frequency: 1.5, phase: -PI / 2.0 };
    let palm = Course { start: PI / 3.0 + 0.1, rate: 0.0, swings: vec![swing] };
    scene.drive = SpatialDrive::Prescribed([palm, resting(PI / 3.0), resting(PI / 3.0)]);
    let found = simulate_solid(&scene, &every(0.1, 5.0)).unwrap();
    let SpatialEnded::ContactLost { palm, time } = found.ended else { panic!("{:?}", found.ended) };
    println!("palm {palm} at {time} s");
    let last = found.moments.last().unwrap();
    assert_eq!(last.time, time);
    assert!((0.0..1e-8).contains(&last.palms[palm - 1].force), "{}", last.palms[palm - 1].force);
    assert!(found.energy_drift() < 1e-9 * found.start_energy.abs());
    let finer = simulate_solid(&SpatialScene { tolerance: 1e-11, ..scene }, &every(0.07, 5.0)).unwrap();
    let SpatialEnded::ContactLost { time: again, .. } = finer.ended else { panic!("{:?}", finer.ended) };
    assert!((time - again).abs() < 1e-8, "{time} {again}");
}

/// What balances has no acceleration, stays where it is and is carried; where gravity leans it does not balance.
#[test]
fn balance_is_rest() {
    for form in forms() {
        let scene = balanced(scene(form, Orientation::by(&Vector3::new(0.5, 0.1, -0.4)), [0.0; 3]));
        let found = simulate_solid(&scene, &[0.0, 1.0]).unwrap();
        let [start, end] = [&found.moments[0], &found.moments[1]];
        assert!(start.turning.norm() < 1e-10 && start.acceleration.norm() < 1e-10, "{}", start.turning);
        assert!((start.centre - end.centre).norm() < 1e-9);
        // the weight is carried
        let carried = start.palms.iter().fold(Vector3::zeros(), |sum, palm| sum + palm.normal * palm.force);
        assert!((carried - Vector3::new(0.0, 0.0, 9.81)).norm() < 1e-10);
        let leaning = SpatialScene { gravity: [0.3, 0.0, -9.8], ..scene.clone() };
        assert!(simulate_solid(&leaning, &[0.0]).unwrap().moments[0].turning.norm() > 1e-4);
    }
}

#[test]
fn scenes_that_cannot_be_followed_say_why() {
    let good = figure_5_3();
    let refused = |change: &dyn Fn(&mut SpatialScene)| {
        let mut scene = good.clone();
        change(&mut scene);
        simulate_solid(&scene, &[0.0, 0.1]).unwrap_err()
    };
    assert!(matches!(refused(&|scene| scene.mass = -1.0), SpatialSceneError::Value { .. }));
    assert!(matches!(refused(&|scene| scene.rate[1] = f64::NAN), SpatialSceneError::Value { .. }));
    assert!(matches!(refused(&|scene| scene.tolerance = 1.0), SpatialSceneError::Value { .. }));
    assert!(matches!(refused(&|scene| scene.gravity = [0.0, 0.0, 9.81]), SpatialSceneError::NotHeld { .. }));
    let long = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0));
    assert_eq!(refused(&|scene| scene.inertia_over_mass = long), SpatialSceneError::Inertia);
    let skew = Matrix3::new(1.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    assert_eq!(refused(&|scene| scene.inertia_over_mass = skew), SpatialSceneError::Inertia);
    let row = |scene: &mut SpatialScene| {
        scene.palms = [0.0; 3].map(|azimuth| SpatialPalm { azimuth, ..Default::default() })
    };
    assert_eq!(refused(&row), SpatialSceneError::Flat);
    assert_eq!(simulate_solid(&good, &[]).unwrap_err(), SpatialSceneError::NoTimes);
    assert!(matches!(simulate_solid(&good, &[0.1, 0.1]), Err(SpatialSceneError::Time { index: 2, .. })));
    // level palms have no pose of balance of their own
    let mut level = good.clone();
    level.drive = SpatialDrive::Prescribed([0.0; 3].map(resting));
    assert_eq!(balanced_orientation(&level), Ok(None));
}
