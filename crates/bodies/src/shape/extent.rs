//! What the normals that were touched say of perimeter and area, whatever lies in the gaps.

use super::{Coverage, ShapeEstimate};
use std::f64::consts::PI;

/// Steps of an arc that was touched, for a whole turn.
const STEPS: f64 = 2880.0;

/// The nodes of Gauss and Legendre's rule with two of them, about the middle of a step, relative to it; the error of a sum, relative to it.
const NODE: f64 = 0.288_675_134_594_812_9;
const ROUNDED: f64 = 1e-11;

/// Bounds of a convex body: it has all points in it that touched, and lies within the tangents there. Two standard deviations of what was touched are counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// From the hull of the contacts to the tangents, in m; infinite where the tangents at the ends of a gap do not meet.
    pub perimeter: [f64; 2],
    /// The same, in m^2.
    pub area: [f64; 2],
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

impl ShapeEstimate {
    /// Bounds of perimeter and area by what was touched; none where nothing was, or the contacts are not those of a convex body about them.
    pub fn extent(&self, coverage: &Coverage) -> Option<Extent> {
        if coverage.touched.is_empty() {
            return None;
        }
        let (mut perimeter, mut area, mut off) = (0.0, 0.0, [0.0; 2]);
        for [from, to] in &coverage.touched {
            let steps = ((to - from) / std::f64::consts::TAU * STEPS).ceil().max(1.0);
            let step = (to - from) / steps;
            for i in 0..steps as u32 {
                for node in [-NODE, NODE] {
                    let angle = from + step * (f64::from(i) + 0.5 + node);
                    let [reach, slope, second, _] = self.support.support(angle);
                    let (radius, deviation) = (reach + second, 2.0 * self.deviation(angle));
                    if radius < -2.0 * self.curvature_deviation(angle) {
                        return None;
                    }
                    perimeter += 0.5 * step * reach;
                    area += 0.25 * step * (reach * reach - slope * slope);
                    // of a function that is off by no more than this everywhere
                    off[0] += 0.5 * step * deviation;
                    off[1] += 0.5 * step * deviation * radius.abs();
                }
            }
            // by parts: the curvature may have kinks
            let [first, last] = [*from, *to].map(|end| self.support.support(end));
            perimeter += last[1] - first[1];
            area += 0.5 * (last[0] * last[1] - first[0] * first[1]);
        }
        off = [off[0] + ROUNDED * perimeter.abs(), off[1] + ROUNDED * area.abs()];
        let (mut inner, mut outer) = ([perimeter, area], [perimeter, area]);
        for [from, to] in coverage.gaps() {
            let [first, last] = [from, to].map(|end| self.support.point(end));
            inner[0] += distance(first, last);
            inner[1] += 0.5 * cross(first, last);
            let deviation = 2.0 * self.deviation(from).max(self.deviation(to));
            off[0] += deviation * (to - from).max(1.0);
            off[1] += deviation * distance(first, last);
            match self.corner(from, to) {
                Some(corner) => {
                    outer[0] += distance(first, corner) + distance(corner, last);
                    outer[1] += 0.5 * (cross(first, corner) + cross(corner, last));
                }
                None => outer = [f64::INFINITY; 2],
            }
        }
        let bounds = |at: usize| [inner[at] - off[at], outer[at] + off[at]];
        let found = Extent { perimeter: bounds(0), area: bounds(1) };
        let is_body = |[least, most]: [f64; 2]| least > 0.0 && least <= most;
        (is_body(found.perimeter) && is_body(found.area)).then_some(found)
    }

    /// Where the tangents at the ends of a gap meet; none in one of half a turn and more.
    fn corner(&self, from: f64, to: f64) -> Option<[f64; 2]> {
        let sine = (to - from).sin();
        if to - from >= PI || sine <= 0.0 {
            return None;
        }
        let [first, last] = [from, to].map(|end| self.support.support(end)[0]);
        let ([s, c], [t, d]) = ([from.sin(), from.cos()], [to.sin(), to.cos()]);
        Some([(first * t - last * s) / sine, (last * c - first * d) / sine])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::SupportSeries;
    use nalgebra::DMatrix;
    use std::f64::consts::TAU;

    fn disc(deviation: f64) -> ShapeEstimate {
        ShapeEstimate {
            support: SupportSeries { mean: 1.0, harmonics: Vec::new() }.into(),
            covariance: DMatrix::identity(1, 1) * deviation * deviation,
            others: Vec::new(),
            samples: 100,
            chi_square: 99.0,
            degrees: 99,
            widened: 1.0,
        }
    }

    /// By hand of a disc of radius one that was not touched over a right angle: three quarters of it, and a chord of `sqrt 2` or two sides of a unit square.
    #[test]
    fn a_gap_lies_between_its_chord_and_its_corner() {
        let three_quarters = Coverage::of_paths([&[PI / 2.0, TAU][..]]);
        let found = disc(0.0).extent(&three_quarters).unwrap();
        let arc = 1.5 * PI;
        let expected =
            Extent { perimeter: [arc + 2f64.sqrt(), arc + 2.0], area: [0.75 * PI + 0.5, 0.75 * PI + 1.0] };
        for (found, expected) in [(found.perimeter, expected.perimeter), (found.area, expected.area)] {
            assert!((found[0] - expected[0]).abs() < 1e-9 && (found[1] - expected[1]).abs() < 1e-9);
        }
        // a radius that is 0.01 off with two deviations
        let off = disc(0.005).extent(&three_quarters).unwrap();
        assert!(off.area[0] < expected.area[0] - 0.01 * arc && off.area[1] > expected.area[1] + 0.01 * arc);
    }

    #[test]
    fn what_is_not_bounded_is_not() {
        let half = disc(0.0).extent(&Coverage::of_paths([&[0.0, 3.0][..]])).unwrap();
        assert!(half.area[0] > 1.4 && half.area[1].is_infinite() && half.perimeter[1].is_infinite());
        assert_eq!(disc(0.0).extent(&Coverage::default()), None);
        // no body: turned inside out
        let mut inside_out = disc(1e-3);
        inside_out.support = SupportSeries { mean: -1.0, harmonics: Vec::new() }.into();
        assert_eq!(inside_out.extent(&Coverage::of_paths([&[0.0, 7.0][..]])), None);
    }
}
