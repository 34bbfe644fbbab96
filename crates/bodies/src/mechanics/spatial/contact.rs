//! Where a body touches three palms, flat or spherical.
//!
//! A palm's sphere is fixed to the palm and touches its plane at a point `t`; with the curvature `k` its points are
//!
//! ```text
//! t + d1 a + d2 b - k d^2/(1 + r) m,      N = k d1 a + k d2 b + r m,      r = sqrt(1 - k^2 d^2),
//! ```
//!
//! with the palm's axis `a`, the direction `b` up the palm, its normal `m`, and the sphere's normal `N` towards the body. Both hold for
//! spheres that bulge towards the body (`k > 0`), for hollow ones (`k < 0`) and for planes, so that nothing is lost where `k` is small.
//!
//! Contact with all palms, `c + X_i = t_i + ...` with the boundary point `X` whose outward normal is `-N`, are nine equations for the centre
//! of mass `c` and three contacts `d`. Newton's method decouples them: where `H` holds the second derivatives of the support function, changes obey
//!
//! ```text
//! dc + left = (1 + k H) (dd1 a' + dd2 b'),      N . dc = -N . left,
//! ```
//!
//! with the tangents `a'` and `b'` of the sphere, whose parts along `a` and `b` are one. For planes the first step is the solution. It begins where planes touch, and
//! where that leads nowhere spheres are bent step by step. In a motion it begins at the contacts a short time before: spheres have more than one place for a body, and a motion stays at its own.

use super::form::Support;
use super::scene::{SpatialPalm, SpatialScene};
use nalgebra::{Matrix3, Vector3};

/// Newton's method takes no more steps than this.
const MOST_STEPS: usize = 40;
/// It ends at steps of this part of the body, or where they are below the second one and become smaller no more.
const SETTLED: [f64; 2] = [1e-14, 1e-9];
/// In so many steps palms are bent where it does not arrive at once.
const BENDINGS: [u32; 4] = [1, 4, 16, 64];
/// No step goes beyond this part of a sphere's radius from the axis through its point of contact with the plane.
const RIM: f64 = 0.999_9;
/// Where planes have no point in common contacts are searched for first at this part of the radius, towards the middle of the palms.
const LEANING: f64 = 0.7;

/// A volume of three unit normals below which their palms are taken to have a line in common.
pub(super) const FLAT: f64 = 1e-6;

/// What follows from orientation and palms alone.
#[derive(Clone, Debug)]
pub(super) struct Contacts {
    /// Axis, direction up the palm and normal of each palm's plane, as columns.
    pub frames: [Matrix3<f64>; 3],
    /// The palms' normals at the contacts, towards the body.
    pub normals: [Vector3<f64>; 3],
    pub supports: [Support; 3],
    /// From the centre of mass to the contacts.
    pub arms: [Vector3<f64>; 3],
    /// What `N . c` is.
    pub reaches: [f64; 3],
    /// Where the contacts are from where spheres touch their planes, along the hinges and up the palms; zero where all palms are flat. None where no contacts were found, each on the half of its
    /// sphere that the palm's coordinates describe.
    pub places: Option<Places>,
}

/// For each palm along the hinge and up the palm, in metres.
pub(super) type Places = [[f64; 2]; 3];

/// Axis, direction up and normal of a palm, as columns.
pub(super) fn palm_frame(azimuth: f64, angle: f64) -> Matrix3<f64> {
    let ((sa, ca), (s, c)) = (azimuth.sin_cos(), angle.sin_cos());
    Matrix3::new(sa, c * ca, -s * ca, -ca, c * sa, -s * sa, 0.0, s, c)
}

/// A palm's sphere in the world.
struct Sphere {
    frame: Matrix3<f64>,
    /// Where it touches the plane.
    touch: Vector3<f64>,
    curvature: f64,
}

impl Sphere {
    fn of(palm: &SpatialPalm, frame: Matrix3<f64>) -> Sphere {
        let hinge = Vector3::from(palm.hinge);
        let touch = match palm.curvature {
            0.0 => hinge,
            _ => hinge + frame * Vector3::new(palm.touch[0], palm.touch[1], 0.0),
        };
        Sphere { frame, touch, curvature: palm.curvature }
    }

    /// The normal at a place, and how far the surface is above the plane there.
    fn at(&self, [d1, d2]: [f64; 2]) -> (Vector3<f64>, f64) {
        let k = self.curvature;
        let square = d1 * d1 + d2 * d2;
        let root = (1.0 - k * k * square).sqrt();
        (self.frame * Vector3::new(k * d1, k * d2, root), -k * square / (1.0 + root))
    }
}

impl Contacts {
    /// Contacts next to those at some places, or where none are given those that are found from flat palms.
    pub fn of(scene: &SpatialScene, angles: [f64; 3], turn: &Matrix3<f64>, near: Option<Places>) -> Contacts {
        let frames: [Matrix3<f64>; 3] =
            std::array::from_fn(|i| palm_frame(scene.palms[i].azimuth, angles[i]));
        let spheres: [Sphere; 3] = std::array::from_fn(|i| Sphere::of(&scene.palms[i], frames[i]));
        let is_flat = spheres.iter().all(|sphere| sphere.curvature == 0.0);
        let places = match (is_flat, near) {
            (true, _) => Some([[0.0; 2]; 3]),
            (false, Some(near)) => newton(scene, &spheres, turn, 1.0, near),
            (false, None) => touched(scene, &spheres, turn),
        };
        let normals: [Vector3<f64>; 3] = std::array::from_fn(|i| match (&places, scene.palms[i].is_flat()) {
            (None, _) => Vector3::repeat(f64::NAN),
            (_, true) => frames[i].column(2).into_owned(),
            (Some(places), false) => spheres[i].at(places[i]).0.normalize(),
        });
        let supports = normals.map(|n| scene.solid.support(&-(turn.transpose() * n)));
        let arms = supports.map(|support| turn * support.point);
        let reaches = std::array::from_fn(|i| {
            let plane = supports[i].extent + normals[i].dot(&spheres[i].touch);
            match (&places, scene.palms[i].is_flat()) {
                // the distance of the tangent plane from where the sphere touches its plane: (1 - N . m)/k
                (Some(places), false) => {
                    let (_, height) = spheres[i].at(places[i]);
                    plane - height
                }
                _ => plane,
            }
        });
        Contacts { frames, normals, supports, arms, reaches, places }
    }
}

/// Where the body touches the spheres, from where these touch their planes; none where it does not.
fn touched(scene: &SpatialScene, spheres: &[Sphere; 3], turn: &Matrix3<f64>) -> Option<Places> {
    let volume = |normals: &[Vector3<f64>; 3]| Matrix3::from_columns(normals).determinant();
    let flat = volume(&spheres.each_ref().map(|sphere| sphere.frame.column(2).into_owned()));
    // spheres have a second place, from the other side of the plane through their centres
    let is_near = |places: &Places| {
        let bent = std::array::from_fn(|i| spheres[i].at(places[i]).0);
        flat.abs() <= FLAT || volume(&bent) * flat > 0.0
    };
    for steps in BENDINGS {
        let mut places = Some([[0.0; 2]; 3]);
        for step in 1..=steps {
            let bent = f64::from(step) / f64::from(steps);
            places = places.and_then(|from| newton(scene, spheres, turn, bent, from));
        }
        if places.is_some_and(|places| is_near(&places)) {
            return places;
        }
    }
    let middle = spheres.iter().map(|sphere| sphere.touch).sum::<Vector3<f64>>() / 3.0;
    let leaning = spheres.each_ref().map(|sphere| {
        let towards = sphere.frame.transpose() * (middle - sphere.touch);
        let long = towards[0].hypot(towards[1]);
        match sphere.curvature == 0.0 || long == 0.0 {
            true => [0.0; 2],
            false => [0, 1].map(|i: usize| LEANING / sphere.curvature * towards[i] / long),
        }
    });
    newton(scene, spheres, turn, 1.0, leaning).filter(is_near)
}

/// Newton's method on spheres whose curvatures are a part of their own.
fn newton(
    scene: &SpatialScene,
    spheres: &[Sphere; 3],
    turn: &Matrix3<f64>,
    bent: f64,
    from: Places,
) -> Option<Places> {
    let spheres = spheres.each_ref().map(|s| Sphere { curvature: bent * s.curvature, ..*s });
    let mut places = from;
    let mut centre = Vector3::zeros();
    let mut last = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let here: [(Vector3<f64>, f64); 3] = std::array::from_fn(|i| spheres[i].at(places[i]));
        let normals = here.map(|(normal, _)| normal.normalize());
        let supports = normals.map(|n| scene.solid.support(&-(turn.transpose() * n)));
        let left: [Vector3<f64>; 3] = std::array::from_fn(|i| {
            let [d1, d2] = places[i];
            let contact = spheres[i].touch + spheres[i].frame * Vector3::new(d1, d2, here[i].1);
            centre + turn * supports[i].point - contact
        });
        let by_normals = Matrix3::from_columns(&normals).transpose();
        let step = by_normals.try_inverse()? * Vector3::from_fn(|i, _| -normals[i].dot(&left[i]));
        centre += step;
        // the first one brings the centre from nowhere
        let mut moved: f64 = if last.is_finite() { step.norm() } else { 0.0 };
        let mut size = 0.0f64;
        for (i, sphere) in spheres.iter().enumerate() {
            let bend = turn * supports[i].bend * turn.transpose();
            let back = (Matrix3::identity() + bend * sphere.curvature).try_inverse()?;
            let across = sphere.frame.transpose() * (back * (step + left[i]));
            let [d1, d2] = places[i];
            let reach = |t: f64| (d1 + t * across[0]).hypot(d2 + t * across[1]) * sphere.curvature.abs();
            let mut part = 1.0;
            while reach(part) > RIM && part > 1e-6 {
                part /= 2.0;
            }
            places[i] = [d1 + part * across[0], d2 + part * across[1]];
            moved = moved.max(across[0].hypot(across[1]));
            size = size.max(supports[i].extent.abs()).max(supports[i].point.norm());
        }
        if !places.iter().flatten().all(|place| place.is_finite()) {
            return None;
        }
        if moved <= SETTLED[0] * size || (moved <= SETTLED[1] * size && moved >= last / 2.0) {
            return Some(places);
        }
        last = moved;
    }
    None
}
