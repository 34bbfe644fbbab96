//! Scenes of 1.4 s in which both contacts hold all the time, for tests. They were found by a search over random
//! scenes with round numbers; `every_fixture_keeps_what_it_promises` says what holds in them.

use super::*;
use crate::mechanics::Palm;

/// No ellipse, and no symmetry but for the second harmonic's own.
pub(crate) fn shape() -> Shape {
    let harmonics = vec![[0.0, 0.0], [0.1, 0.0], [0.03, -0.04]];
    Shape::new(&BodyForm::Harmonics { mean: 1.2, harmonics }, CentreOfMass::Uniform).unwrap()
}

fn scene(shape: Shape, [orientation, rate]: [f64; 2], palms: [Course; 2]) -> MovingScene {
    MovingScene {
        mass: 1.0,
        gyration: shape.gyration(),
        shape,
        orientation,
        rate,
        gravity: -9.81,
        palm_inertia: [0.5, 0.6],
        palm_lengths: [f64::INFINITY; 2],
        palms: [Palm::Flat; 2],
        drive: Drive::Prescribed(palms),
        tolerance: DEFAULT_TOLERANCE,
    }
}

fn course(start: f64, rate: f64, swings: &[[f64; 3]]) -> Course {
    let swing = |&[amplitude, frequency, phase]: &[f64; 3]| Oscillation { amplitude, frequency, phase };
    Course { start, rate, swings: swings.iter().map(swing).collect() }
}

/// Both palms turn at one constant rate (section 4.3).
pub(crate) fn common_rate() -> MovingScene {
    scene(shape(), [5.3, -0.8], [course(0.4, 0.4, &[]), course(1.8, 0.0, &[])])
}

/// Palm 1 is fixed, palm 2 turns at a constant rate (section 4.4).
pub(crate) fn palm_2_turns() -> MovingScene {
    scene(shape(), [4.3, 1.3], [course(0.8, 0.0, &[]), course(1.8, -0.3, &[])])
}

/// Both palms are fixed (section 4.5).
pub(crate) fn palms_fixed() -> MovingScene {
    scene(shape(), [4.4, 1.4], [course(0.7, 0.0, &[]), course(1.7, 0.0, &[])])
}

/// Both palms swing, with angular accelerations (section 4.2).
pub(crate) fn palms_swing() -> MovingScene {
    let palms = [course(0.6, 0.2, &[[0.1, 0.4, 6.2]]), course(1.6, 0.1, &[[0.2, 0.5, 1.4]])];
    scene(shape(), [3.4, -1.7], palms)
}

/// The palms swing, and the body starts at rest as in section 4.6.
pub(crate) fn from_rest() -> MovingScene {
    let palms = [course(0.8, 0.4, &[[0.2, 0.4, 1.1]]), course(1.4, -0.1, &[[0.2, 0.4, 1.4]])];
    scene(shape(), [3.9, 0.0], palms)
}

/// Both palms turn at one constant rate, and the body starts at rest.
pub(crate) fn common_rate_from_rest() -> MovingScene {
    scene(shape(), [5.6, 0.0], [course(0.5, 0.5, &[]), course(1.5, 0.0, &[])])
}

/// A closed spline as in section 3.4 between palms that swing.
pub(crate) fn spline_swings() -> MovingScene {
    let form = BodyForm::Spline { radii: [1.2, 1.6, 1.3], knots: Knots::Uniform };
    let palms = [course(0.7, 0.1, &[[0.1, 0.4, 2.6]]), course(1.6, 0.2, &[[0.1, 0.5, 0.1]])];
    scene(Shape::new(&form, CentreOfMass::Uniform).unwrap(), [3.6, 1.7], palms)
}

/// Hollow palms that swing (section 4.7).
pub(crate) fn hollow_swing() -> MovingScene {
    MovingScene { palms: [4.0, 5.0].map(|radius| Palm::Circular { radius }), rate: -0.8, ..palms_swing() }
}

/// Palms that bulge, one of them at rest.
pub(crate) fn bulging() -> MovingScene {
    MovingScene { palms: [-5.0, -4.0].map(|radius| Palm::Circular { radius }), ..palm_2_turns() }
}

/// A hollow palm and a flat one, both at rest.
pub(crate) fn hollow_and_flat() -> MovingScene {
    MovingScene { palms: [Palm::Circular { radius: 4.0 }, Palm::Flat], ..palms_fixed() }
}

/// The times of section 4.6: 400 steps in 1.4 s.
pub(crate) fn times() -> Vec<f64> {
    (0..=400).map(|i| 0.0035 * f64::from(i)).collect()
}
