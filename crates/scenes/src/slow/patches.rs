//! Segments as the thesis arranges them (section 3.7): patches of the radius function, and the errors 3.48 and 3.49. For comparison; no estimate uses them.

use super::closure::touched;
use super::measurements::SlowMeasurements;
use super::quadrature::SlowTrack;
use super::segments::FoundJump;
use super::thesis::{ThesisMethod, by_thesis};
use std::f64::consts::TAU;

/// Directions at which patches are compared.
const DIRECTIONS: usize = 720;

/// The errors of an arrangement of segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrangement {
    /// How many patches there are.
    pub patches: usize,
    /// 3.48, in m^2: not an area of the body, since `r` is its support function. It compares pedal curves.
    pub area: f64,
    /// The integral of the square of 3.38, in m^2 s.
    pub force: f64,
    /// The integral of the square of 3.39, in m^2 s.
    pub contact: f64,
}

impl Arrangement {
    /// 3.49. It adds numbers with units, and so depends on them: here on m and s.
    pub fn error(&self) -> f64 {
        (1.0 + self.force) * (1.0 + self.contact) * (1.0 + self.area) - 1.0
    }
}

/// The radius function on a range of directions, linear between touched ones (the thesis takes a spline: at its samples that is the same).
struct Patch {
    /// Directions that increase, and the radii there.
    points: Vec<[f64; 2]>,
}

impl Patch {
    fn at(&self, theta: f64) -> Option<f64> {
        let after = self.points.partition_point(|point| point[0] < theta);
        let (a, b) = (self.points.get(after.checked_sub(1)?)?, self.points.get(after)?);
        Some(a[1] + (b[1] - a[1]) * (theta - a[0]) / (b[0] - a[0]).max(f64::MIN_POSITIVE))
    }
}

/// Patches of a path of directions and radii: cut where the direction turns back.
fn patches(path: &[[f64; 2]]) -> Vec<Patch> {
    let mut all = Vec::new();
    let mut from = 0;
    for end in 1..path.len() {
        let turns = path
            .get(end + 1)
            .is_none_or(|next| (next[0] - path[end][0]) * (path[end][0] - path[end - 1][0]) <= 0.0);
        if turns {
            let mut points = path[from..=end].to_vec();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            all.push(Patch { points });
            from = end;
        }
    }
    all
}

/// 3.48 over a whole turn. Patches are distinguished by directions that go on past a turn.
fn area(patches: &[Patch]) -> f64 {
    let at = |i: usize| TAU * i as f64 / DIRECTIONS as f64;
    let mut total = 0.0;
    for i in 0..DIRECTIONS {
        let radii: Vec<f64> = (patches.iter())
            .filter_map(|patch| {
                let first = patch.points.first()?[0];
                patch.at(first + (at(i) - first).rem_euclid(TAU))
            })
            .collect();
        let mean = radii.iter().sum::<f64>() / radii.len().max(1) as f64;
        total += radii.iter().map(|r| (mean * mean - r * r).abs()).sum::<f64>();
    }
    0.5 * total * TAU / DIRECTIONS as f64
}

/// The integral of a square over the samples.
fn squared(times: &[f64], values: &[f64]) -> f64 {
    let pairs = times.windows(2).zip(values.windows(2));
    pairs.map(|(t, v)| (t[1] - t[0]) * (v[0] * v[0] + v[1] * v[1]) / 2.0).sum()
}

/// A track cut at jumps, and the thesis's way restarted there from the same radii and orientations.
pub(super) fn arrangements(
    measurements: &SlowMeasurements,
    track: &SlowTrack,
    jumps: &[FoundJump],
) -> [Arrangement; 2] {
    let mut ends: Vec<usize> = jumps.iter().map(|jump| jump.row).collect();
    ends.push(measurements.rows());
    let mut of_both = [Vec::new(), Vec::new()];
    let none = Arrangement { patches: 0, area: 0.0, force: 0.0, contact: 0.0 };
    let mut found = [none; 2];
    let mut from = 0;
    for end in ends {
        let rows = from..end;
        from = end;
        if rows.len() < 2 {
            continue;
        }
        let segment = measurements.part(&rows);
        let own = SlowTrack {
            radii: track.radii[rows.clone()].to_vec(),
            phi0: track.phi0[rows.clone()].to_vec(),
            height: track.height[rows.clone()].to_vec(),
        };
        let mut restarted = by_thesis(&segment, own.radii[0], ThesisMethod::PredictorCorrector);
        restarted.track.phi0.iter_mut().for_each(|phi0| *phi0 += own.phi0[0]);
        found[1].force += squared(&segment.times, &restarted.force_error);
        found[1].contact += squared(&segment.times, &restarted.contact_error);
        // 3.38 of the estimate; 3.39 vanishes whatever the radii, since d_i come from the measurements by 3.18 and 3.19
        let force: Vec<f64> = (0..rows.len())
            .map(|row| {
                let at = segment.sampled(row);
                let [d1, _] = at.tangential(own.radii[row]);
                let side = own.radii[row][0] * at.first[0] - d1 * at.first[1];
                side + (at.s[0] * at.opening[1] - at.s[1]) * at.first[0] / at.opening[0]
            })
            .collect();
        found[0].force += squared(&segment.times, &force);
        for (which, track) in [&own, &restarted.track].into_iter().enumerate() {
            let samples = touched(&segment, track);
            for palm in 0..2 {
                let path: Vec<[f64; 2]> =
                    samples.iter().skip(palm).step_by(2).map(|one| [one.angle, one.radius]).collect();
                of_both[which].extend(patches(&path));
            }
        }
    }
    for (which, all) in of_both.iter().enumerate() {
        found[which].patches = all.len();
        found[which].area = area(all);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: two circles of radii 1 and 3 over the same half turn have the mean 2, so that 3.48 is half of (|4 - 1| + |4 - 9|) pi; a patch alone has no error.
    #[test]
    fn areas_are_those_by_hand() {
        let path = |r: f64| (0..=200).map(|i| [0.3 + 3.2 * f64::from(i) / 200.0, r]).collect::<Vec<_>>();
        let mut all = patches(&path(1.0));
        assert_eq!((all.len(), area(&all)), (1, 0.0));
        all.extend(patches(&path(3.0)));
        assert!((area(&all) - 0.5 * 8.0 * 3.2).abs() < 0.05, "{}", area(&all));
        let there_and_back: Vec<[f64; 2]> =
            [0.0, 0.5, 1.0, 0.6, 0.2, 0.7].iter().map(|theta| [*theta, 1.0]).collect();
        assert_eq!(patches(&there_and_back).len(), 3);
        let one = Arrangement { patches: 1, area: 0.2, force: 0.1, contact: 0.5 };
        assert!((one.error() - (1.1 * 1.5 * 1.2 - 1.0)).abs() < 1e-15);
    }
}
