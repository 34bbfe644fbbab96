//! The pose in which a body lies still on palms at rest: where its centre of mass is lowest among all poses near by.

use super::contact::Contacts;
use super::orientation::Orientation;
use super::scene::{SpatialScene, SpatialSceneError};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use palmistry_math::number::MOST_ITERATIONS;

/// Newton's method takes no more steps than this.
const MOST_STEPS: usize = 200;
/// Half the step of differences, in radians.
const STEP: f64 = 1e-5;

/// The height of the centre of mass, against gravity, times its acceleration; and the moment of the forces that carry the weight, per
/// kilogram: minus the gradient by rotations in the world.
fn potential(scene: &SpatialScene, orientation: &Orientation) -> (f64, Vector3<f64>) {
    let turn = orientation.matrix();
    let angles = scene.start_of_palms().map(|palm| palm[0]);
    // contact forces do no work, and so it does not count that a contact moves on its sphere
    let Contacts { normals, supports, reaches, .. } = Contacts::of(scene, angles, &turn, None);
    let by_columns = Matrix3::from_columns(&normals);
    let back = by_columns.try_inverse().unwrap_or_else(|| Matrix3::repeat(f64::NAN));
    let gravity = Vector3::from(scene.gravity);
    let carrying = -(back * gravity);
    let centre = back.transpose() * Vector3::from(reaches);
    let moment = (0..3).fold(Vector3::zeros(), |sum: Vector3<f64>, i| {
        sum + (turn * supports[i].point).cross(&normals[i]) * carrying[i]
    });
    (-gravity.dot(&centre), moment)
}

/// The orientation of stable balance that a descent from the scene's orientation comes to, with the palms as they are at the start;
/// none where there is none (a body of revolution has a direction in which it does not care, which is fine), or no
/// palm holds it.
///
/// Newton's method with its steps bent downwards: the second derivatives, whose sign is made positive, are differences of moments.
/// What is found is a minimum, to the rounding of moments of the weight times `1e-13` of the body.
///
/// # Errors
/// Where a value of the scene cannot be used.
pub fn balanced_orientation(scene: &SpatialScene) -> Result<Option<Orientation>, SpatialSceneError> {
    scene.check_values()?;
    let mut here = scene.orientation;
    let (mut height, mut moment) = potential(scene, &here);
    if !height.is_finite() {
        return Ok(None);
    }
    let weight = Vector3::from(scene.gravity).norm();
    let size = scene.solid.support(&Vector3::x()).extent;
    for _ in 0..MOST_STEPS {
        let turned = |by: &Vector3<f64>| turned_in_the_world(&here, by);
        let mut curvature = Matrix3::zeros();
        for i in 0..3 {
            let step = Vector3::ith(i, STEP);
            let change = potential(scene, &turned(&-step)).1 - potential(scene, &turned(&step)).1;
            curvature.set_column(i, &(change / (2.0 * STEP)));
        }
        let symmetric = (curvature + curvature.transpose()) / 2.0;
        let Some(SymmetricEigen { eigenvalues, eigenvectors }) =
            SymmetricEigen::try_new(symmetric, f64::EPSILON, MOST_ITERATIONS)
        else {
            return Ok(None);
        };
        if moment.norm() <= 1e-13 * weight * size {
            // a saddle is left by rounding alone; along a symmetry nothing changes
            let stable = eigenvalues.iter().all(|value| *value > -1e-7 * weight * size);
            return Ok(stable.then_some(here));
        }
        let least = 1e-9 * weight * size;
        let along = eigenvectors.transpose() * moment;
        let newton = eigenvectors * along.zip_map(&eigenvalues, |m, value| m / value.abs().max(least));
        let mut step = newton * (1.0f64).min(0.5 / newton.norm());
        let mut moved = false;
        for _ in 0..60 {
            let next = turned(&step);
            let (lower, its_moment) = potential(scene, &next);
            // near the minimum heights are lost in rounding, and moments decide
            if lower < height
                || (lower - height).abs() < 1e-14 * weight * size && its_moment.norm() < moment.norm()
            {
                (here, height, moment, moved) = (next, lower, its_moment, true);
                break;
            }
            step /= 2.0;
        }
        if !moved {
            let stable = eigenvalues.iter().all(|value| *value > -1e-7 * weight * size);
            return Ok((stable && moment.norm() <= 1e-10 * weight * size).then_some(here));
        }
    }
    Ok(None)
}

fn turned_in_the_world(orientation: &Orientation, by: &Vector3<f64>) -> Orientation {
    Orientation::by(by).then(orientation)
}
