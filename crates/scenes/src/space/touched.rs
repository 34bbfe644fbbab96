//! The contacts of the body in one frame, and the shape and its bounds that follow from them.

use super::answers::{SpaceUpdate, SpaceVerdict};
use super::scene::SpaceObserver;
use nalgebra::{Matrix3, Vector3};
use palmistry_bodies::shape::sphere::{
    BoundedRegion, OuterBound, SolidEstimate, SolidSample, SurfaceTouch, TouchError, ball_intersection,
    balls_and_half_spaces, contact_hull, fit_solid, half_space_intersection, rounded_hull,
};

/// Where no errors are stated, a contact counts as exact to this fraction of the body at best.
const EXACT: f64 = 1e-12;

/// The contacts, and the shape that follows from them. The frame is the world's at the first sample, about the centre of mass.
#[derive(Clone, Debug)]
pub struct SpaceShape {
    /// The contacts.
    pub touches: Vec<SurfaceTouch>,
    /// The standard deviation of a contact, in m.
    pub deviation: f64,
    /// The support function.
    pub estimate: Option<SolidEstimate>,
    /// A region that the body contains.
    pub hull: Result<BoundedRegion, TouchError>,
    /// A region that contains the body.
    pub outer: Result<OuterBound, TouchError>,
    /// A region that it contains where no radius of curvature is below the one given in the scene.
    pub rounded: Option<Result<BoundedRegion, TouchError>>,
    /// A region that contains it where none is above the one given in the scene.
    pub balls: Option<Result<BoundedRegion, TouchError>>,
    /// A region that contains it where palms are hollow: the body lies in the ball of each contact with one.
    pub hollow: Option<Result<BoundedRegion, TouchError>>,
}

/// The contacts of windows up to the first that does not fit, in the frame of the first, and their deviation. Each window begins with the last sample of the one before.
pub(super) fn chained(updates: &[SpaceUpdate], stated: f64) -> Option<(Vec<SurfaceTouch>, f64)> {
    let mut turn = Matrix3::identity();
    let mut all: Vec<SurfaceTouch> = Vec::new();
    let mut left = 0.0f64;
    for (place, update) in
        updates.iter().take_while(|update| update.verdict == SpaceVerdict::Fits).enumerate()
    {
        // the sample that two windows share counts once
        for pose in update.poses.iter().skip(usize::from(place > 0)) {
            let moved = pose.touches.map(|touch| SurfaceTouch {
                point: turn * touch.point,
                normal: (turn * touch.normal).normalize(),
            });
            all.extend(moved);
        }
        left = left.max(update.state.as_ref().map_or(0.0, |state| state.rms_residual));
        if let Some(last) = update.poses.last() {
            turn *= last.turn.transpose();
        }
    }
    let size = all.iter().map(|touch| touch.point.norm()).fold(0.0, f64::max);
    let deviation = if stated > 0.0 { stated } else { left.max(EXACT * size) };
    (!all.is_empty()).then_some((all, deviation))
}

impl SpaceShape {
    /// `radii` are those of hollow palms in m, infinite for others.
    pub(super) fn of(
        (touches, deviation): (Vec<SurfaceTouch>, f64),
        asked: &SpaceObserver,
        radii: [f64; 3],
    ) -> SpaceShape {
        let weight = 1.0 / (deviation * deviation);
        let samples: Vec<SolidSample> = touches.iter().map(|touch| SolidSample::of(touch, weight)).collect();
        let [least, greatest] = asked.radii;
        // contacts come by threes, a palm each
        let by_contact: Vec<f64> = radii.into_iter().cycle().take(touches.len()).collect();
        let is_hollow = radii.iter().any(|radius| radius.is_finite());
        SpaceShape {
            estimate: fit_solid(&samples, asked.degree),
            hull: contact_hull(&touches),
            outer: half_space_intersection(&touches),
            rounded: least.map(|radius| rounded_hull(&touches, radius)),
            balls: greatest.map(|radius| ball_intersection(&touches, radius)),
            hollow: is_hollow.then(|| balls_and_half_spaces(&touches, &by_contact)),
            deviation,
            touches,
        }
    }

    /// The largest error of the estimated support radius in m, where `truth` is the true one at a normal: where the body was touched, and over all directions.
    pub fn errors(&self, truth: &dyn Fn(&Vector3<f64>) -> f64) -> Option<[f64; 2]> {
        let support = &self.estimate.as_ref()?.support;
        let off = |normal: &Vector3<f64>| (support.support(normal) - truth(normal)).abs();
        let touched = self.touches.iter().map(|touch| off(&touch.normal)).fold(0.0, f64::max);
        let everywhere = directions(24).iter().flatten().map(off).fold(touched, f64::max);
        Some([touched, everywhere])
    }
}

/// Directions by rings from one pole to the other, with twice as many directions in each as there are rings.
pub fn directions(rings: usize) -> Vec<Vec<Vector3<f64>>> {
    use std::f64::consts::{PI, TAU};
    let ring = |i: usize| {
        let (across, along) = (PI * (i as f64 + 0.5) / rings as f64).sin_cos();
        let one = |k: usize| {
            let (s, c) = (TAU * k as f64 / (2 * rings) as f64).sin_cos();
            Vector3::new(across * c, across * s, along)
        };
        (0..2 * rings).map(one).collect()
    };
    (0..rings).map(ring).collect()
}
