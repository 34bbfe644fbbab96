//! The laws of motion against the 320-bit floor, which differentiates positions and knows neither `h''` nor `r' = -d`.

use super::super::fixtures::{common_rate, palms_swing, times};
use super::super::*;
use crate::mechanics::{Inertia, Palm, PalmMotion, PlanarBody, Real, Swing, planar_dynamics_on};
use dashu::rational::RBig;
use palmistry_math::number::rational_from_f64;

fn exact(x: f64) -> RBig {
    rational_from_f64(x).expect("a finite number")
}

fn real(x: f64) -> Real {
    Real::from_rational(&exact(x))
}

/// The body of the fixtures with its support function about its centre of mass.
pub(super) fn body(shape: &Shape) -> PlanarBody {
    let [x, y] = shape.centre_of_mass();
    let listed = [[0.0, 0.0], [0.1, 0.0], [0.03, -0.04]].map(|pair| pair.map(exact));
    let mut harmonics: Vec<(RBig, RBig)> = listed.into_iter().map(|[p, q]| (p, q)).collect();
    harmonics[0] = (-exact(x), -exact(y));
    PlanarBody::new(&exact(1.2), &harmonics).unwrap()
}

/// The greatest difference between a moment and what the 320-bit floor says of it.
pub(super) fn difference(scene: &MovingScene, body: &PlanarBody, moment: &Moment) -> f64 {
    let swing = |i: usize| {
        let palm = &moment.palms[i];
        Swing { value: real(palm.angle), rate: real(palm.rate), acceleration: real(palm.acceleration) }
    };
    let inertia = Inertia {
        mass: real(scene.mass),
        gyration: real(scene.gyration),
        palms: scene.palm_inertia.map(real),
        gravity: real(scene.gravity),
    };
    let palms = PalmMotion { phi1: swing(0), phi2: swing(1) };
    let forms = scene.palms.map(|palm| match palm {
        Palm::Flat => Palm::Flat,
        Palm::Circular { radius } => Palm::Circular { radius: real(radius) },
    });
    let start = [&real(moment.phi0), &real(moment.omega0)];
    let found = planar_dynamics_on(body, &palms, &forms, start, &inertia).unwrap();
    let motion = &found.motion;
    let mut worst = (moment.alpha0 - motion.phi0.second.to_f64()).abs();
    let mut compare = |ours: f64, theirs: &Real| worst = worst.max((ours - theirs.to_f64()).abs());
    for i in 0..2 {
        let palm = &moment.palms[i];
        compare(moment.centre[i], &motion.centre[i].value);
        compare(moment.velocity[i], &motion.centre[i].first);
        compare(palm.s, &motion.s[i].value);
        compare(palm.r, &motion.r[i].value);
        compare(palm.d, &motion.d[i].value);
        compare(palm.force, &found.forces[i]);
        compare(palm.torque, &found.torques[i]);
    }
    worst
}

#[test]
fn prescribed_palms_agree_with_the_witness() {
    let mut worst = 0.0f64;
    for scene in [common_rate(), palms_swing()] {
        let body = body(&scene.shape);
        let path = simulate(&scene, &times()).unwrap();
        for moment in path.moments.iter().step_by(57) {
            worst = worst.max(difference(&scene, &body, moment));
        }
    }
    println!("greatest difference {worst:e}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// Torques that move the palms: what the witness says of the torques needed for the accelerations found are the
/// torques that were applied.
#[test]
fn driven_palms_agree_with_the_witness() {
    let mut scene = palms_swing();
    let body = body(&scene.shape);
    let start = simulate(&scene, &[0.0]).unwrap().moments[0];
    scene.drive = Drive::Torques([0, 1].map(|i: usize| {
        let palm = &start.palms[i];
        let swings = vec![Oscillation { amplitude: 0.7, frequency: 1.1, phase: 0.4 }];
        PushedPalm { angle: palm.angle, rate: palm.rate, torque: palm.torque, swings }
    }));
    let path = simulate(&scene, &(0..8).map(|i| 0.03 * f64::from(i)).collect::<Vec<_>>()).unwrap();
    assert_eq!(path.ended, Ended::Completed);
    let worst = path.moments.iter().map(|moment| difference(&scene, &body, moment)).fold(0.0, f64::max);
    println!("greatest difference {worst:e}");
    assert!(worst < 1e-12, "{worst:e}");
}
