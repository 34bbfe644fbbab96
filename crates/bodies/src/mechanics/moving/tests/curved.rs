//! Palms that are not flat: the general laws on flat palms, discs by closed forms, energy, the witness in 320 bits, and the
//! limit of large circles.

use super::super::fixtures::*;
use super::super::laws::Situation;
use super::super::*;
use super::witness::{body, difference};
use crate::mechanics::Palm;

fn circular(radii: [f64; 2], scene: MovingScene) -> MovingScene {
    MovingScene { palms: radii.map(|radius| Palm::Circular { radius }), ..scene }
}

/// What two situations say, number by number.
fn numbers(at: &Situation) -> Vec<f64> {
    let pairs = [at.centre, at.velocity, at.accelerations, at.s, at.r, at.d, at.forces, at.torques];
    pairs.concat().into_iter().chain([at.alpha0, at.opening]).collect()
}

/// The laws for palms of any form, on flat ones, against those that were written for flat ones: prescribed angles and torques.
#[test]
fn the_general_laws_agree_with_those_of_flat_palms() {
    let mut worst = 0.0f64;
    let mut torques = palms_swing();
    torques.drive =
        Drive::Torques([(0.6, 0.4, 3.0), (1.6, -0.3, -2.0)].map(|(angle, rate, torque)| PushedPalm {
            angle,
            rate,
            torque,
            swings: vec![Oscillation { amplitude: 0.7, frequency: 1.1, phase: 0.4 }],
        }));
    for scene in [common_rate(), palm_2_turns(), palms_fixed(), palms_swing(), spline_swings(), torques] {
        for k in 0..40 {
            let mut state = scene.start();
            (state[0], state[1]) = (state[0] + 0.13 * f64::from(k), state[1] + 0.05 * f64::from(k));
            let time = 0.02 * f64::from(k);
            let flat = numbers(&Situation::at(&scene, time, &state));
            let general = numbers(&Situation::between_curved(&scene, time, &state));
            for (flat, general) in flat.iter().zip(&general) {
                worst = worst.max((flat - general).abs() / flat.abs().max(1.0));
            }
        }
    }
    println!("greatest difference {worst:e}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// The middle of a disc of radius `q` is `b - q` from the middle of a hollow palm of radius `b`, and `|b| + q` from that of a
/// bulging one; the contact is on the line of both, by arc length; and a palm's force passes through both middles.
#[test]
fn a_disc_between_circles() {
    let q = 0.8;
    let form = BodyForm::Harmonics { mean: q, harmonics: vec![] };
    for (radii, opening) in [([3.0, 4.0], 1.7), ([-3.0, -2.0], 1.3), ([2.5, -6.0], 1.5)] {
        let mut scene = circular(radii, palms_fixed());
        scene.shape = Shape::new(&form, CentreOfMass::Uniform).unwrap();
        scene.gyration = scene.shape.gyration();
        let rest = |start| Course { start, ..Course::default() };
        scene.drive = Drive::Prescribed([rest(0.7), rest(opening)]);
        let moment = simulate(&scene, &[0.0]).unwrap().moments[0];
        for (i, angle) in [0.7, 0.7 + opening].into_iter().enumerate() {
            let up = if i == 0 { [-angle.sin(), angle.cos()] } else { [angle.sin(), -angle.cos()] };
            let spoke = [0, 1].map(|k| moment.centre[k] - radii[i] * up[k]);
            assert!((spoke[0].hypot(spoke[1]) - (radii[i] - q).abs()).abs() < 1e-14);
            // the angle at the palm's middle between the joint and the contact
            let turned = (moment.palms[i].s / radii[i]).abs();
            let cosine =
                -(spoke[0] * up[0] + spoke[1] * up[1]) / spoke[0].hypot(spoke[1]) * radii[i].signum();
            assert!((cosine - turned.cos()).abs() < 1e-14, "{cosine} {turned}");
            assert!((moment.palms[i].r - q).abs() < 1e-15 && moment.palms[i].d.abs() < 1e-15);
        }
        // no moment about the middle, so no acceleration of the rotation
        assert!(moment.alpha0.abs() < 1e-13);
    }
}

#[test]
fn motions_between_circles_keep_energy_and_agree_with_the_witness() {
    let mut worst = 0.0f64;
    for (scene, name) in [(hollow_swing(), "hollow"), (bulging(), "bulging"), (hollow_and_flat(), "both")] {
        let path = simulate(&scene, &times()).unwrap();
        println!("{name}: {:?}, energy kept to {:e}", path.ended, path.energy_drift());
        // bulging palms let go sooner
        let held = if name == "hollow" { path.ended == Ended::Completed } else { path.moments.len() > 40 };
        assert!(held, "{name}: {:?}", path.ended);
        assert!(path.energy_drift() < 1e-12, "{name}: {:e}", path.energy_drift());
        let body = body(&scene.shape);
        for moment in path.moments.iter().step_by(path.moments.len() / 3) {
            worst = worst.max(difference(&scene, &body, moment));
        }
    }
    println!("greatest difference {worst:e}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// Motors that push circular palms as the prescribed motion needs it, and from there on otherwise.
#[test]
fn driven_circular_palms_agree_with_the_witness() {
    let mut scene = hollow_swing();
    let start = simulate(&scene, &[0.0]).unwrap().moments[0];
    scene.drive = Drive::Torques([0, 1].map(|i: usize| {
        let palm = &start.palms[i];
        let swings = vec![Oscillation { amplitude: 0.7, frequency: 1.1, phase: 0.4 }];
        PushedPalm { angle: palm.angle, rate: palm.rate, torque: palm.torque, swings }
    }));
    let path = simulate(&scene, &(0..4).map(|i| 0.03 * f64::from(i)).collect::<Vec<_>>()).unwrap();
    assert_eq!(path.ended, Ended::Completed);
    assert!(path.energy_drift() < 1e-10, "{:e}", path.energy_drift());
    let body = body(&scene.shape);
    let worst = path.moments.iter().map(|moment| difference(&scene, &body, moment)).fold(0.0, f64::max);
    println!("greatest difference {worst:e}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// A whole motion between circles goes over into that between flat palms, as one over the radius.
#[test]
fn flat_palms_are_the_limit_of_large_circles() {
    let flat = simulate(&palms_swing(), &times()).unwrap();
    let distance = |radius: f64| {
        let bent = simulate(&circular([radius, -radius], palms_swing()), &times()).unwrap();
        assert_eq!(bent.moments.len(), flat.moments.len());
        let apart = |(a, b): (&Moment, &Moment)| {
            let s = (0..2).map(|i| (a.palms[i].s - b.palms[i].s).abs()).fold(0.0, f64::max);
            s.max((a.phi0 - b.phi0).abs()).max((a.omega0 - b.omega0).abs())
        };
        bent.moments.iter().zip(&flat.moments).map(apart).fold(0.0, f64::max)
    };
    let [near, nearer, nearest] = [1e3, 1e4, 1e6].map(distance);
    println!("{near:e} {nearer:e} {nearest:e}");
    assert!((9.0..11.0).contains(&(near / nearer)), "{near:e} {nearer:e}");
    assert!((90.0..110.0).contains(&(nearer / nearest)), "{nearer:e} {nearest:e}");
}

#[test]
fn a_palm_as_hollow_as_the_body_is_refused() {
    // the body's radius of curvature is 1.2 - 0.3 cos(2 a) - 0.24 cos(3 a) - ..., nowhere above 1.9
    let refused = |radii| simulate(&circular(radii, palms_fixed()), &[0.0]).err();
    let Some(SceneError::TooHollow { palm: 2, radius, curvature }) = refused([4.0, 1.5]) else { panic!() };
    assert!(radius == 1.5 && curvature > 1.5 && curvature < 1.9);
    assert!(
        refused([0.0, 4.0]).is_some() && refused([4.0, f64::NAN]).is_some() && refused([4.0, 1e7]).is_some()
    );
}

/// An arc that bulges ends where it has turned by half a turn: a body far out on a small one is no longer on it.
#[test]
fn a_contact_beyond_the_arc_is_refused() {
    let error = simulate(&circular([-0.2, -0.2], palms_fixed()), &[0.0]).unwrap_err();
    assert!(matches!(error, SceneError::Start(_)) || matches!(error, SceneError::NotHeld { .. }), "{error}");
}
