//! Stick and slip against closed forms, the laws of energy and momentum, and the motion without friction.

use super::super::fixtures::*;
use super::super::*;
use std::f64::consts::PI;

fn disc(radius: f64, rate: f64, palms: [Course; 2]) -> MovingScene {
    let form = BodyForm::Harmonics { mean: radius, harmonics: vec![] };
    let shape = Shape::new(&form, CentreOfMass::Uniform).unwrap();
    let gyration = shape.gyration();
    MovingScene { gyration, shape, rate, drive: Drive::Prescribed(palms), ..palms_fixed() }
}

fn steady(start: f64, rate: f64) -> Course {
    Course { start, rate, swings: vec![] }
}

fn swinging(start: f64, amplitude: f64, frequency: f64) -> Course {
    Course { start, rate: 0.0, swings: vec![Oscillation { amplitude, frequency, phase: 0.0 }] }
}

fn sampled(until: f64, steps: u32) -> Vec<f64> {
    (0..=steps).map(|i| until * f64::from(i) / f64::from(steps)).collect()
}

/// Palms that swing by themselves: contacts slide both ways, and roll.
fn apart() -> MovingScene {
    let palms = [swinging(0.6, 0.15, 0.5), swinging(1.7, 0.2, 0.7)];
    MovingScene { rate: 0.0, orientation: 4.0, drive: Drive::Prescribed(palms), ..palms_fixed() }
}

/// Motors of constant torque that swing about it.
fn driven() -> MovingScene {
    let told = simulate(&palms_fixed(), &[0.0]).unwrap().moments[0];
    let palms = [0, 1].map(|i: usize| PushedPalm {
        angle: told.palms[i].angle,
        rate: 0.0,
        torque: told.palms[i].torque,
        swings: vec![Oscillation { amplitude: 0.5, frequency: 0.9, phase: 0.0 }],
    });
    MovingScene { rate: 0.3, drive: Drive::Torques(palms), ..palms_fixed() }
}

/// Without friction it is the motion that `simulate` finds by other equations: the constraint differentiated, and not the support function.
#[test]
fn without_friction_it_is_the_motion_without_friction() {
    for scene in [palms_swing(), common_rate(), palm_2_turns(), palms_fixed(), driven()] {
        let [free, rubbed] = [
            simulate(&scene, &times()).unwrap(),
            simulate_with_friction(&scene, 0.0, &times()).unwrap().trajectory,
        ];
        assert_eq!(free.ended, rubbed.ended);
        assert_eq!(free.moments.len(), rubbed.moments.len());
        let mut worst = 0.0f64;
        for (a, b) in free.moments.iter().zip(&rubbed.moments) {
            worst = worst.max((a.phi0 - b.phi0).abs()).max((a.omega0 - b.omega0).abs());
            worst = worst.max((a.alpha0 - b.alpha0).abs());
            for (p, q) in a.palms.iter().zip(&b.palms) {
                worst = worst.max((p.force - q.force).abs()).max((p.torque - q.torque).abs());
                worst = worst.max((p.s - q.s).abs()).max(q.friction.abs());
            }
        }
        println!("greatest difference {worst:e}");
        assert!(worst < 1e-10, "{worst:e}");
    }
}

/// What motors do and friction takes is the energy, in every mode and through every change of modes; and friction only takes.
#[test]
fn friction_takes_what_is_missing() {
    let scenes = [(driven(), 0.1, 1.0), (driven(), 0.3, 1.0), (apart(), 0.3, 1.0), (apart(), 0.1, 1.05)];
    for (scene, coefficient, until) in scenes {
        let motion = simulate_with_friction(&scene, coefficient, &sampled(until, 400)).unwrap();
        assert_eq!(motion.trajectory.ended, Ended::Completed);
        assert!(motion.modes.len() >= 4);
        println!("drift {:e} J", motion.trajectory.energy_drift());
        assert!(motion.trajectory.energy_drift() < 1e-10);
        let moments = &motion.trajectory.moments;
        assert!(moments.windows(2).all(|pair| pair[1].dissipated >= pair[0].dissipated - 1e-13));
        assert!(moments.last().unwrap().dissipated > 0.02);
        for palm in moments.iter().flat_map(|moment| &moment.palms) {
            assert!(palm.force > 0.0 && palm.friction.abs() <= coefficient * palm.force * (1.0 + 1e-9));
            // what slides has all of its friction against it
            if palm.slip.abs() > 1e-6 {
                let full = -coefficient * palm.force * palm.slip.signum();
                assert!((palm.friction - full).abs() < 1e-9, "{palm:?}");
            }
        }
    }
}

/// Newton's and Euler's laws by central differences of fourth order of the path, within a mode: centre and angle are accelerated by the two
/// contact forces and gravity. Between palms with prescribed motion and driven ones.
#[test]
fn momentum_is_what_the_contacts_give() {
    for (scene, coefficient) in [(driven(), 0.1), (apart(), 0.3)] {
        let step = 1e-3;
        let motion = simulate_with_friction(&scene, coefficient, &sampled(0.95, 950)).unwrap();
        let moments = &motion.trajectory.moments;
        let mut looked = 0;
        for at in moments.windows(5) {
            let crossed = |change: &(f64, ModePair)| at[0].time < change.0 && change.0 < at[4].time;
            if motion.modes.iter().any(crossed) {
                continue;
            }
            let slope = |of: &dyn Fn(&Moment) -> f64| {
                (of(&at[0]) - 8.0 * of(&at[1]) + 8.0 * of(&at[3]) - of(&at[4])) / (12.0 * step)
            };
            let here = &at[2];
            let (mut force, mut moment) = ([0.0, scene.mass * scene.gravity], 0.0);
            let mut angle = 0.0;
            for (i, palm) in here.palms.iter().enumerate() {
                angle += palm.angle;
                let away = [angle.cos(), angle.sin()];
                let side = if i == 0 { 1.0 } else { -1.0 };
                let normal = [-side * away[1], side * away[0]];
                for k in 0..2 {
                    force[k] += palm.force * normal[k] + palm.friction * side * away[k];
                }
                let arm = [0, 1].map(|k: usize| palm.s * away[k] - here.centre[k]);
                let own = [0, 1].map(|k: usize| palm.force * normal[k] + palm.friction * side * away[k]);
                moment += arm[0] * own[1] - arm[1] * own[0];
                // the velocity of the body's point at the contact, relative to the palm
                let rate = here.palms[0].rate + if i == 0 { 0.0 } else { palm.rate };
                let point = [
                    here.velocity[0] - here.omega0 * arm[1] + rate * palm.s * away[1],
                    here.velocity[1] + here.omega0 * arm[0] - rate * palm.s * away[0],
                ];
                assert!((side * (point[0] * away[0] + point[1] * away[1]) - palm.slip).abs() < 1e-11);
                assert!((point[0] * normal[0] + point[1] * normal[1]).abs() < 1e-11);
            }
            for (k, force) in force.iter().enumerate() {
                assert!((slope(&|m| m.centre[k]) - here.velocity[k]).abs() < 1e-7);
                let off = (scene.mass * slope(&|m| m.velocity[k]) - force).abs();
                assert!(off < 1e-7, "{off:e} at {}", here.time);
            }
            let inertia = scene.mass * scene.gyration * scene.gyration;
            let off = (inertia * slope(&|m| m.omega0) - moment).abs();
            assert!(off < 1e-7, "{off:e} at {}", here.time);
            looked += 1;
        }
        assert!(looked > 900, "{looked}");
    }
}

/// A disc that spins in a symmetric V at `p` from the level: its middle stays where it is, and the friction `mu S` of both contacts, with the sum of normal forces
/// `S = m g / (cos p (1 + mu^2))`, brakes it evenly until it stands; then it stays.
#[test]
fn a_spinning_disc_comes_to_rest() {
    let (p, mu, rate) = (0.7f64, 0.25, 3.0);
    let scene = disc(1.25, rate, [steady(p, 0.0), steady(PI - 2.0 * p, 0.0)]);
    let motion = simulate_with_friction(&scene, mu, &sampled(1.5, 300)).unwrap();
    let sum = 9.81 / (p.cos() * (1.0 + mu * mu));
    let braked = mu * 1.25 * sum / (1.25 * 1.25 / 2.0);
    let stops = rate / braked;
    assert_eq!(motion.modes.len(), 2);
    assert_eq!(motion.modes[0].1, ModePair([ContactMode::Along; 2]));
    assert_eq!(motion.modes[1].1, ModePair([ContactMode::Sticks; 2]));
    assert!((motion.modes[1].0 - stops).abs() < 1e-10, "{} {stops}", motion.modes[1].0);
    for moment in &motion.trajectory.moments {
        let time = moment.time.min(stops);
        assert!((moment.phi0 - 4.4 - rate * time + braked * time * time / 2.0).abs() < 1e-11);
        if moment.time < stops {
            let carried: f64 = moment.palms.iter().map(|palm| palm.force).sum();
            assert!((carried - sum).abs() < 1e-11);
        }
    }
    let taken = motion.trajectory.moments.last().unwrap().dissipated;
    assert!((taken - 1.25 * 1.25 / 2.0 * rate * rate / 2.0).abs() < 1e-11);
}

/// A disc in a closing pair of palms: once it rolls on palm 1, which rests, its angle is the way of the contact, `s_1 = R cot(phi_2/2)`.
#[test]
fn a_disc_rolls() {
    let scene = disc(1.0, 0.0, [steady(0.2, 0.0), steady(1.9, -0.3)]);
    let motion = simulate_with_friction(&scene, 0.3, &sampled(1.0, 400)).unwrap();
    let (from, pair) = *motion.modes.last().unwrap();
    assert_eq!(pair, ModePair([ContactMode::Sticks, ContactMode::Against]));
    assert!(from < 0.1 && motion.trajectory.ended == Ended::Completed);
    let rolling: Vec<&Moment> =
        motion.trajectory.moments.iter().filter(|moment| moment.time > from).collect();
    let first = rolling[0];
    for moment in &rolling {
        let s = 1.0 / ((1.9 - 0.3 * moment.time) / 2.0).tan();
        assert!((moment.palms[0].s - s).abs() < 1e-13);
        assert!((moment.phi0 - first.phi0 + (s - first.palms[0].s)).abs() < 1e-11);
        assert!(moment.palms[0].slip.abs() < 1e-10);
    }
}

/// A body that is stuck turns with the palms, and is let go where its friction reaches the edge of the cone.
#[test]
fn what_is_stuck_turns_with_the_palms() {
    let motion = simulate_with_friction(&driven(), 0.3, &sampled(1.0, 400)).unwrap();
    let place = motion.modes.iter().position(|mode| mode.1 == ModePair([ContactMode::Sticks; 2])).unwrap();
    let (from, to) = (motion.modes[place].0, motion.modes[place + 1].0);
    let stuck: Vec<&Moment> =
        motion.trajectory.moments.iter().filter(|moment| from < moment.time && moment.time < to).collect();
    assert!(stuck.len() > 200);
    let first = stuck[0];
    for moment in &stuck {
        assert!((moment.phi0 - first.phi0 - (moment.palms[0].angle - first.palms[0].angle)).abs() < 1e-9);
        assert!(moment.palms[1].rate.abs() < 1e-9);
        assert!((0..2).all(|i| (moment.palms[i].s - first.palms[i].s).abs() < 1e-9));
    }
    let edge = |moment: &Moment| {
        let left = |palm: &PalmMoment| 0.3 - (palm.friction / palm.force).abs();
        left(&moment.palms[0]).min(left(&moment.palms[1]))
    };
    assert!(edge(stuck[stuck.len() - 1]) < 0.01 && edge(stuck[stuck.len() / 2]) > 0.01);
}

/// The changes of modes in the first second are the same, however long the motion is asked to go on.
#[test]
fn how_long_a_motion_may_go_on_does_not_change_its_beginning() {
    let changes = |scene: &MovingScene, until: f64| {
        let times = [0.9, until];
        let motion = simulate_with_friction(scene, 0.1, &times).unwrap();
        let early = motion.modes.into_iter().filter(|(time, _)| *time < 1.0);
        (early.collect::<Vec<_>>(), motion.trajectory.moments[0].phi0)
    };
    for scene in [driven(), apart()] {
        let (modes, phi0) = changes(&scene, 1.0);
        assert!(modes.len() >= 3, "{modes:?}");
        for until in [1e2, 1e6] {
            let (others, other) = changes(&scene, until);
            assert!((phi0 - other).abs() < 1e-9, "{until}: {phi0} {other}");
            assert_eq!(modes.len(), others.len(), "{until}: {modes:?} {others:?}");
            for ((time, pair), (other_time, other_pair)) in modes.iter().zip(&others) {
                assert!(
                    pair == other_pair && (time - other_time).abs() < 1e-7,
                    "{until}: {time} {other_time}"
                );
            }
        }
    }
}

/// Where no modes are consistent there is a message, at the start and on the way; and what cannot be used is refused.
#[test]
fn no_modes_are_told() {
    let motion = simulate_with_friction(&apart(), 0.3, &sampled(4.0, 400)).unwrap();
    let Ended::Failed { time, why } = &motion.trajectory.ended else {
        panic!("{:?}", motion.trajectory.ended)
    };
    assert!(why.contains("Painleve") && (1.0..1.1).contains(time), "{why} {time}");
    let scene = disc(1.0, 0.0, [steady(0.2, 0.0), steady(1.9, 0.3)]);
    assert_eq!(simulate_with_friction(&scene, 0.3, &[1.0]).unwrap_err(), SceneError::NoModes);
    for coefficient in [-0.1, f64::NAN, f64::INFINITY] {
        let error = simulate_with_friction(&apart(), coefficient, &[1.0]).unwrap_err();
        assert!(error.to_string().contains("the coefficient of friction"), "{error}");
    }
    let error = simulate_with_friction(&hollow_swing(), 0.1, &[1.0]).unwrap_err();
    assert!(error.to_string().contains("friction knows flat palms"), "{error}");
}

/// A motion with fifty changes of modes in twenty seconds: what was integrated beyond a change is not paid for, and where the budget is spent the motion ends
/// for this reason and not with a paradox.
#[test]
fn what_a_motion_costs_is_not_taken_for_its_end() {
    let form = BodyForm::Harmonics { mean: 1.2, harmonics: vec![[0.0, 0.0], [0.1, 0.0], [0.03, -0.04]] };
    let shape = Shape::new(&form, CentreOfMass::Uniform).unwrap();
    let scene = MovingScene {
        gyration: shape.gyration(),
        shape,
        mass: 1.0,
        rate: 0.0,
        orientation: 4.95,
        drive: Drive::Prescribed([swinging(0.82, 0.057, 0.25), swinging(1.605, 0.163, 0.33)]),
        ..palms_fixed()
    };
    let motion = |times: &[f64]| simulate_with_friction(&scene, 0.135, times).unwrap();
    let fine = motion(&sampled(20.0, 2000));
    let early = fine.modes.len();
    assert!(fine.trajectory.ended == Ended::Completed && early > 40, "{early} {:?}", fine.trajectory.ended);
    let far = motion(&[1e6]);
    assert!(far.modes.len() > early, "{}", far.modes.len());
    for ((time, pair), (other, other_pair)) in fine.modes.iter().zip(&far.modes) {
        assert!(pair == other_pair && (time - other).abs() < 1e-6, "{time} {other}");
    }
    let Ended::Failed { time, why } = &far.trajectory.ended else { panic!("{:?}", far.trajectory.ended) };
    assert!(why.contains("is its duration in seconds") && *time > 100.0, "{time} {why}");
}
