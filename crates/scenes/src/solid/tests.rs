use super::*;
use crate::space::{SpaceMeasurements, SpaceSensor, drawn_scenes, relative_error, true_entries};
use palmistry_bodies::mechanics::moving::Course;
use palmistry_bodies::mechanics::spatial::*;
use std::f64::consts::{FRAC_PI_3, TAU};

/// Scenes in which all palms hold the body for 1.76 s.
fn held(count: usize, samples: usize) -> Vec<(SpatialScene, Vec<SpatialMoment>)> {
    drawn_scenes(5, count, samples, 1.76)
}

fn measurements(scene: &SpatialScene, moments: &[SpatialMoment], noise: f64, seed: u64) -> SolidMeasurements {
    let sensor = SpaceSensor { noise, ..SpaceSensor::default() };
    SpaceMeasurements::of(moments, &sensor, seed).solid(&scene.palms, scene.gravity, &sensor)
}

fn true_start(truth: &[f64; UNKNOWNS]) -> flow::Start {
    let j = Matrix3::from_fn(|a, b| {
        let place = vector::PLACES.iter().position(|place| *place == (a.min(b), a.max(b)));
        truth[9 + place.unwrap()]
    });
    let k = j.try_inverse().unwrap();
    let part = |from: usize| [truth[from], truth[from + 1], truth[from + 2]];
    let inverse = vector::PLACES.map(|place| k[place]);
    flow::Start::new(part(0), part(3), part(6), inverse, truth[15]).unwrap()
}

/// The constraint and the integrals hold for motions by Newton's laws, which use neither.
#[test]
fn the_true_state_leaves_nothing() {
    for (scene, moments) in held(3, 89) {
        let measurements = measurements(&scene, &moments, 0.0, 1);
        let rules = integrals::Rules::of(&measurements.times, (0..measurements.rows()).collect());
        let all = integrals::Integrals::of(&measurements, &rules);
        let truth = true_entries(&scene, &moments[0]);
        let start = true_start(&truth);
        let samples = constraint::expanded(&start, &all);
        for (sample, moment) in samples.iter().zip(&moments) {
            let error = (Vector3::from(sample.centre) - moment.centre).norm();
            assert!(error < 1e-9, "{error:e} at {}", moment.time);
            let left = sample.value.iter().fold(0.0f64, |most, value| most.max(value.abs()));
            assert!(left < 1e-8, "{left:e} at {}", moment.time);
        }
        // derivatives against differences, the turn among them
        for direction in (0..19).filter(|d| !(9..12).contains(d)) {
            let moved = |by: f64| {
                let mut start = start;
                match direction {
                    0..3 => start.centre[direction] += by,
                    3..6 => start.velocity[direction - 3] += by,
                    6..9 => start.momentum[direction - 6] += by,
                    12..18 => start.inverse[direction - 12] += by,
                    _ => start.mu += by,
                }
                constraint::values(&start, &all)
            };
            let (above, below) = (moved(1e-5), moved(-1e-5));
            for k in [20, 88] {
                for i in 0..3 {
                    let difference = (above[k][i] - below[k][i]) / 2e-5;
                    let by = samples[k].by[i][direction];
                    assert!(
                        (difference - by).abs() < 1e-6 * (1.0 + by.abs()),
                        "{direction} {k}: {by} {difference}"
                    );
                }
            }
        }
    }
}

/// The scene of figure 5.3 of the thesis, balanced at first.
fn figure_5_3(samples: usize, duration: f64) -> (SpatialScene, Vec<SpatialMoment>) {
    figure_5_3_on([0.0; 3], samples, duration)
}

/// The same on palms of these curvatures.
fn figure_5_3_on(curvatures: [f64; 3], samples: usize, duration: f64) -> (SpatialScene, Vec<SpatialMoment>) {
    let solid = ConvexSolid::new(SolidForm::Ellipsoid { semi_axes: [2.5, 2.0, 1.0] }, None).unwrap();
    let mut scene = SpatialScene {
        mass: 1.0,
        inertia_over_mass: solid.uniform_inertia(),
        solid,
        orientation: Orientation::by(&Vector3::new(0.2, -0.3, 0.4)),
        rate: [0.0, 0.3, 0.3],
        gravity: [0.0, 0.0, -9.81],
        palms: std::array::from_fn(|k| SpatialPalm {
            azimuth: k as f64 * TAU / 3.0,
            inertia: 0.5,
            curvature: curvatures[k],
            touch: [0.1, 2.5],
            ..SpatialPalm::default()
        }),
        drive: SpatialDrive::Prescribed([(); 3].map(|()| Course { start: FRAC_PI_3, ..Course::default() })),
        tolerance: 1e-13,
    };
    scene.orientation = balanced_orientation(&scene).unwrap().unwrap();
    let times: Vec<f64> = (0..samples).map(|k| duration * k as f64 / (samples - 1) as f64).collect();
    let moments = simulate_solid(&scene, &times).unwrap().moments;
    assert_eq!(moments.len(), samples);
    (scene, moments)
}

/// Errors over Cramér-Rao bounds, entry by entry, of so many seeds; and the mean of chi-square over its degrees.
fn ratios(scene: &SpatialScene, moments: &[SpatialMoment], noise: f64, seeds: u64) -> ([f64; UNKNOWNS], f64) {
    let exact = measurements(scene, moments, 0.0, 0);
    let truth = true_entries(scene, &moments[0]);
    let begin = true_start(&truth);
    let rules = integrals::Rules::of(&exact.times, (0..exact.rows()).collect());
    let scale = change::Scale { length: 1.0, rate: 1.0 };
    let deviations = whiten::Deviations { contact: noise, torque: 0.0, softened: 1e-3 };
    let bound =
        refine::refine(&exact, &rules, begin, &scale, &deviations).unwrap().state().unwrap().covariance;
    let mut squares = [0.0; UNKNOWNS];
    let mut chi = 0.0;
    for seed in 1..=seeds {
        let noisy = measurements(scene, moments, noise, seed);
        let found = refine::refine(&noisy, &rules, begin, &scale, &deviations).unwrap().state().unwrap();
        chi += found.chi_square / found.degrees as f64;
        for ((sum, found), truth) in squares.iter_mut().zip(found.entries()).zip(truth) {
            *sum += (found - truth).powi(2);
        }
    }
    let over_bound = |i: usize| (squares[i] / seeds as f64).sqrt() / bound[(i, i)].sqrt();
    (std::array::from_fn(over_bound), chi / seeds as f64)
}

/// How many, where the tests are optimised and where they are not.
fn many(full: usize, quick: usize) -> usize {
    if cfg!(debug_assertions) { quick } else { full }
}

/// Centre, velocity, rate, inertia and mass of bodies of three kinds, on palms at rest, at constant rates and swinging, without
/// noise, and of scenes of another seed than that by which the search was chosen.
#[test]
fn bodies_are_found_without_a_guess() {
    let scenes = held(many(9, 3), 177).into_iter().chain(drawn_scenes(6, many(9, 3), 177, 1.76));
    for (place, (scene, moments)) in scenes.enumerate() {
        let state = measurements(&scene, &moments, 0.0, 1).first_state().unwrap();
        let error = relative_error(&state.entries(), &true_entries(&scene, &moments[0]));
        assert!(error < 1e-8 && state.fits(), "{place}: {error:e}");
    }
}

/// The prior's rows have the derivatives that differences give.
#[test]
fn the_prior_changes_as_it_says() {
    let (scene, moments) = held(1, 89).remove(0);
    let here = true_start(&true_entries(&scene, &moments[0]));
    let at = flow::Start { centre: [0.1, 0.2, 1.7], mu: 1.2 * here.mu, ..here };
    let prior = regular::Prior { at, ball: 1.3, length: 1.5, fall: 2.5 };
    let rows = prior.rows(&here).unwrap();
    for place in 0..UNKNOWNS {
        let off = |by: f64| {
            let mut change = [0.0; UNKNOWNS];
            change[place] = by;
            prior.rows(&here.changed(&change).unwrap()).unwrap().map(|(off, _)| off)
        };
        let (above, below) = (off(1e-5), off(-1e-5));
        for (i, (_, row)) in rows.iter().enumerate() {
            let difference = (above[i] - below[i]) / 2e-5;
            assert!((difference - row[place]).abs() < 1e-7, "{i} {place}: {} {difference}", row[place]);
        }
    }
}

/// The thesis's search, with known rate, inertia and mass, finds centre and turn from some seeds; others end in a wrong minimum.
#[test]
fn two_stages_are_a_base_line() {
    let (scene, moments) = figure_5_3(177, 4.4);
    let exact = measurements(&scene, &moments, 0.0, 1);
    let truth = true_entries(&scene, &moments[0]);
    let known = KnownSolid {
        rate: Vector3::new(truth[6], truth[7], truth[8]),
        inertia_over_mass: scene.inertia_over_mass,
        mass: scene.mass,
        radii: [0.5, 3.0],
    };
    let turn = moments[0].orientation.matrix();
    let inertia = turn * scene.inertia_over_mass * turn.transpose();
    let (mut found, seeds) = (0, many(12, 5));
    for seed in 1..=seeds as u64 {
        let end = exact.two_stages(&known, 5000, seed).unwrap();
        let (centre, turned) =
            ((end.centre - moments[0].centre).norm(), (end.inertia_over_mass - inertia).norm());
        let is_near = centre < 1e-6 && turned < 1e-5;
        // the residual distinguishes them
        assert_eq!(is_near, end.left < 1e-6, "{seed}: {centre:e} m, {turned:e} m^2, {:e} m/s left", end.left);
        found += usize::from(is_near);
    }
    assert!(found > 0 && found < seeds, "{found} of {seeds}");
    let mut short = exact;
    short.times.truncate(5);
    assert!(short.two_stages(&known, 10, 1).is_none());
}

/// A wrong state with a residual below a millionth of the body does not fit: of the first scenes at half the samples, one ends so.
#[test]
fn a_wrong_state_that_leaves_little_says_so() {
    for (scene, moments) in held(3, 89) {
        let Some(state) = measurements(&scene, &moments, 0.0, 1).first_state() else { continue };
        let error = relative_error(&state.entries(), &true_entries(&scene, &moments[0]));
        assert!(error < 1e-6 || !state.fits(), "{error:e}, {:e} m left", state.rms_residual);
    }
    // noise that is not stated is recognised by the residuals, which look like noise
    let (scene, moments) = figure_5_3(89, 3.52);
    let mut unstated = measurements(&scene, &moments, 1e-4, 1);
    unstated.contact_deviation = 0.0;
    let begin = true_start(&true_entries(&scene, &moments[0]));
    let rules = integrals::Rules::of(&unstated.times, (0..unstated.rows()).collect());
    let scale = change::Scale { length: 1.0, rate: 1.0 };
    let deviations = whiten::Deviations { contact: 1e-6, torque: 0.0, softened: 1e-3 };
    let state = refine::refine(&unstated, &rules, begin, &scale, &deviations).unwrap().state().unwrap();
    assert!(!state.is_stated && state.fits(), "{}", state.ratio);
    // residuals of a wrong state are correlated from sample to sample; stated errors of torques do not excuse it
    let alike = SolidState { ratio: 0.5, rms_residual: 0.5 * state.weighed, chi_square: 1.0, ..state };
    for is_stated in [false, true] {
        assert!(!SolidState { is_stated, ..alike.clone() }.fits(), "{is_stated}");
    }
    assert!(SolidState { is_stated: true, contacts_are_stated: true, ..alike }.fits());
    assert!(state.rms_residual > 2e-5 && state.rms_residual < 1e-4, "{:e}", state.rms_residual);
}

/// With noise the errors of all entries are within the Cramér-Rao bound, and chi-square is that of its degrees.
#[test]
fn errors_are_those_of_the_bound() {
    let seeds = many(200, 20);
    let (scene, moments) = figure_5_3(89, 3.52);
    let (ratios, chi) = ratios(&scene, &moments, 1e-3, seeds as u64);
    // a standard deviation from so many has an error of one in the root of twice as many
    let slack = 0.1 + 1.42 / (seeds as f64).sqrt();
    assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < slack.max(0.2)), "{ratios:.2?}");
    assert!((chi - 1.0).abs() < 0.05, "{chi}");
}

/// On spheres errors of a contact move its normal, its height and its lever as well.
#[test]
fn errors_on_spheres_are_those_of_the_bound() {
    let seeds = many(200, 20);
    let slack = 0.1 + 1.42 / (seeds as f64).sqrt();
    for curvatures in [[-0.05, -0.1, -0.05], [0.4, -0.1, 0.0]] {
        let (scene, moments) = figure_5_3_on(curvatures, 89, 3.52);
        let (ratios, chi) = ratios(&scene, &moments, 1e-3, seeds as u64);
        assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < slack.max(0.2)), "{ratios:.2?}");
        assert!((chi - 1.0).abs() < 0.05, "{chi}");
    }
}

/// Constraint, force and moment by the coordinates of a contact and by the torque, against differences.
#[test]
fn what_a_contact_changes_on_a_sphere_is_what_differences_say() {
    let (scene, moments) = figure_5_3_on([-0.05, 0.3, 0.0], 89, 1.76);
    let mut exact = measurements(&scene, &moments, 0.0, 1);
    for (k, palm) in exact.palms[40].iter_mut().enumerate() {
        palm.rate = 0.3 - 0.2 * k as f64;
    }
    let (omega, speed, centre) = ([0.3, -0.5, 0.7], [0.2, 0.1, -0.4], [-0.4, -0.7, 3.5]);
    let of = |measurements: &SolidMeasurements, i: usize| {
        let palm = surface::PalmSample::of(measurements, 40, i);
        let velocity =
            vector::along(&speed, 1.0, &vector::cross(&omega, &vector::along(&palm.contact, -1.0, &centre)));
        let constraint = vector::dot(&palm.normal, &velocity) - palm.rate * palm.lever;
        let force = vector::scaled(palm.force, &palm.normal);
        let all = [vec![constraint], force.to_vec(), vector::cross(&palm.contact, &force).to_vec()];
        (all.concat(), palm.slopes(&omega, &velocity), palm.wrenches())
    };
    for i in 0..3 {
        let (_, slopes, wrenches) = of(&exact, i);
        for error in 0..3 {
            let moved = |by: f64| {
                let mut measurements = exact.clone();
                match error {
                    2 => measurements.palms[40][i].torque += by,
                    side => measurements.palms[40][i].place[side] += by,
                }
                of(&measurements, i).0
            };
            let (above, below) = (moved(1e-5), moved(-1e-5));
            let slope = if error < 2 { slopes[error] } else { 0.0 };
            let (force, moment) = wrenches[error];
            let told = [vec![slope], force.to_vec(), moment.to_vec()].concat();
            for (k, told) in told.iter().enumerate() {
                let difference = (above[k] - below[k]) / 2e-5;
                assert!((difference - told).abs() < 1e-8, "{i} {error} {k}: {told} {difference}");
            }
        }
    }
}

/// Bodies of the three kinds on palms that bulge, are hollow and are flat, without a guess.
#[test]
fn bodies_on_spheres_are_found_without_a_guess() {
    for (place, (mut scene, _)) in held(many(9, 3), 177).into_iter().enumerate() {
        for (palm, curvature) in scene.palms.iter_mut().zip([0.2, -0.1, [0.0, -0.08, 0.3][place % 3]]) {
            (palm.curvature, palm.touch) = (curvature, [0.0, 2.0]);
        }
        scene.orientation = balanced_orientation(&scene).unwrap().unwrap();
        let times: Vec<f64> = (0..177).map(|k| 0.01 * f64::from(k)).collect();
        let found = simulate_solid(&scene, &times).unwrap();
        assert_eq!(found.ended, SpatialEnded::Completed);
        let state = measurements(&scene, &found.moments, 0.0, 1).first_state().unwrap();
        let error = relative_error(&state.entries(), &true_entries(&scene, &found.moments[0]));
        assert!(error < 1e-8 && state.fits(), "{place}: {error:e}");
    }
}

/// The contacts in the body's frame are on the body's surface.
#[test]
fn the_body_was_touched_there() {
    let (scene, moments) = held(1, 177).remove(0);
    let (_, poses) = measurements(&scene, &moments, 0.0, 1).explained(&|| false).unwrap();
    let turn = moments[0].orientation.matrix();
    for (pose, moment) in poses.iter().zip(&moments) {
        assert!((pose.centre - moment.centre).norm() < 1e-7);
        assert!((pose.turn * turn - moment.orientation.matrix()).norm() < 1e-7);
        for touch in pose.touches {
            let extent = scene.solid.support(&(turn.transpose() * touch.normal)).extent;
            assert!((touch.point.dot(&touch.normal) - extent).abs() < 1e-7);
        }
    }
}

#[test]
fn what_is_no_record_gives_no_state() {
    let (scene, moments) = held(1, 89).remove(0);
    let changed = |change: fn(&mut SolidMeasurements)| {
        let mut measurements = measurements(&scene, &moments, 0.0, 1);
        change(&mut measurements);
        measurements.first_state()
    };
    assert!(changed(|measurements| measurements.palms[3][0].place[0] = f64::NAN).is_none());
    assert!(changed(|measurements| measurements.palms[3][0].place[1] = 0.0).is_none());
    assert!(changed(|measurements| measurements.times[4] = measurements.times[3]).is_none());
    assert!(changed(|measurements| measurements.times.truncate(5)).is_none());
    assert!(changed(|measurements| measurements.palms.clear()).is_none());
}

/// Contacts measured to 1 mm over 1.76 s: for a barely observable scene, a state that explains the measurements and is 40 % off once had bounds of a few percent. Now its bound is reported as invalid; where the scene
/// is observable, the state is within five deviations. Oracle: the bodies that were simulated.
#[test]
fn no_bound_is_told_that_noise_makes_up() {
    let wrong = [
        0.0618, -0.1682, 3.4569, 0.0763, -0.3808, -0.0541, 0.3252, -0.2128, -0.4516, 1.9964, 2.5139, 1.3947,
        -1.1387, -0.4126, -0.7994, 0.8705,
    ];
    let scenes = drawn_scenes(6, many(9, 6), 177, 1.76);
    for (place, begin) in [(5, Some(wrong)), (8, None)].into_iter().take(many(2, 1)) {
        let (scene, moments) = &scenes[place];
        let noisy = measurements(scene, moments, 1e-3, 1);
        let truth = true_entries(scene, &moments[0]);
        let rules = integrals::Rules::of(&noisy.times, (0..noisy.rows()).collect());
        let scale = change::Scale { length: 1.85, rate: 2.3 };
        let deviations = whiten::Deviations { contact: 1e-3, torque: 0.0, softened: 7e-4 };
        let begin = true_start(&begin.unwrap_or(truth));
        let state = refine::refine(&noisy, &rules, begin, &scale, &deviations).unwrap().state().unwrap();
        let error = relative_error(&state.entries(), &truth);
        assert!(state.fits(), "{place}: {}", state.chi_square);
        if place == 5 {
            assert!(error > 0.3 && state.is_unobservable(), "{error:e} {}", state.bent);
            continue;
        }
        assert!(!state.is_unobservable() && error < 0.03, "{error:e} {} {}", state.bent, state.curved);
        for ((found, truth), deviation) in state.entries().iter().zip(truth).zip(state.deviations()) {
            assert!((found - truth).abs() < 5.0 * deviation, "{found} {truth} {deviation}");
        }
    }
}
