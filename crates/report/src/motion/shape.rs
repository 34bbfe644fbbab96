//! How far what was recovered of an outline is from the true one.
//!
//! What is true comes only from the simulation.

use palmistry_bodies::mechanics::moving::Shape;
use palmistry_bodies::shape::ShapeEstimate;
use palmistry_scenes::{Answer, Experiment, TouchTrack, shown};
use std::borrow::Cow;
use std::f64::consts::TAU;

/// What the observer shown recovered of the outline, as it was found out before or else now.
pub(super) fn outline<'a>(experiment: &Experiment, answers: &'a [Answer]) -> Option<Cow<'a, TouchTrack>> {
    let answer = shown(answers)?;
    match &answer.reconstruction {
        Some(reconstruction) => Some(Cow::Borrowed(&reconstruction.track)),
        None => experiment.touch_track(answer).map(Cow::Owned),
    }
}

/// The largest distance of a recovered point from the true outline, and the root of their mean square, in m; over the
/// samples at which the state was observable; none where there is no such sample.
pub(super) fn departure(track: &TouchTrack, shape: &Shape) -> Option<(f64, f64)> {
    let points =
        track.instants.iter().filter(|instant| instant.is_observed).flat_map(|instant| instant.points);
    largest_and_mean(points.map(|point| distance(shape, point)))
}

/// The largest error of an estimated support function, and the root of the mean square, in m, over all normals or those that count. The frames are one.
pub(super) fn support_error(
    estimate: &ShapeEstimate,
    shape: &Shape,
    counts: impl Fn(f64) -> bool,
) -> Option<(f64, f64)> {
    const NORMALS: usize = 1440;
    let angles = (0..NORMALS).map(|i| TAU * i as f64 / NORMALS as f64).filter(|angle| counts(*angle));
    largest_and_mean(angles.map(|angle| (estimate.support.support(angle)[0] - shape.support(angle)[0]).abs()))
}

fn largest_and_mean(distances: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let distances: Vec<f64> = distances.collect();
    let square: f64 = distances.iter().map(|distance| distance * distance).sum();
    let largest = distances.iter().copied().fold(0.0, f64::max);
    (!distances.is_empty()).then(|| (largest, (square / distances.len() as f64).sqrt()))
}

/// The distance of a point from the outline of a convex body: the greatest value of `x · u - h` over all directions, without its
/// sign; the direction is found on a grid and then by Newton's method.
fn distance(shape: &Shape, point: [f64; 2]) -> f64 {
    let beyond = |angle: f64| {
        let ([h, slope, second], [c, s]) = (shape.support(angle), unit(angle));
        let (out, across) = (point[0] * c + point[1] * s, point[1] * c - point[0] * s);
        [out - h, across - slope, -out - second]
    };
    const GRID: usize = 360;
    let grid = (0..GRID).map(|i| TAU * i as f64 / GRID as f64);
    let Some(mut angle) = grid.max_by(|a, b| beyond(*a)[0].total_cmp(&beyond(*b)[0])) else {
        return f64::INFINITY;
    };
    let mut best = beyond(angle)[0];
    for _ in 0..4 {
        let [_, slope, curvature] = beyond(angle);
        if curvature < 0.0 {
            angle -= (slope / curvature).clamp(-TAU / GRID as f64, TAU / GRID as f64);
        }
        best = best.max(beyond(angle)[0]);
    }
    best.abs()
}

fn unit(angle: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [cosine, sine]
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_bodies::mechanics::moving::{BodyForm, CentreOfMass};

    /// A disc of radius 2 about its centre: the distance of a point is that of its radius from 2, inside and outside.
    #[test]
    fn the_distance_from_a_disc_is_known() {
        let form = BodyForm::Harmonics { mean: 2.0, harmonics: Vec::new() };
        let disc = Shape::new(&form, CentreOfMass::Uniform).unwrap();
        assert!((distance(&disc, [3.0, 4.0]) - 3.0).abs() < 1e-14);
        assert!((distance(&disc, [0.3, -0.4]) - 1.5).abs() < 1e-14);
    }

    /// A point of the boundary moved out along its normal by a known length, on a body that is no disc.
    #[test]
    fn a_point_moved_along_its_normal_is_that_far() {
        let form = BodyForm::Harmonics { mean: 1.0, harmonics: vec![[0.0, 0.0], [0.08, 0.03]] };
        let shape = Shape::new(&form, CentreOfMass::Uniform).unwrap();
        for i in 0..50 {
            let angle = 0.1 + f64::from(i);
            let ([x, y], [c, s]) = (shape.point(angle), unit(angle));
            for moved in [1e-6, 0.2, -1e-6] {
                let found = distance(&shape, [x + moved * c, y + moved * s]);
                assert!((found - moved.abs()).abs() < 1e-14, "{angle}: {found} for {moved}");
            }
        }
    }
}
