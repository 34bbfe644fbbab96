//! Stable poses at resting palms and on a level table, and the share of orientations that end in each.

use super::body::PoseBody;
use super::potential::{PalmPair, potential};
use super::zeros::{Zero, zeros_over_a_turn};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Samples of a turn between which stable poses are looked for.
const SAMPLES: usize = 360;

/// A local minimum of the height of the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StablePose {
    /// `phi0`, from 0 to a turn, rad.
    pub phi0: f64,
    /// The height of the centre of mass, m.
    pub height: f64,
    /// Its second derivative by `phi0`, m/rad^2.
    pub stiffness: f64,
    /// The part of all orientations from which the body comes down to this pose, each orientation being equally likely and the body
    /// sliding downhill without momentum.
    pub share: f64,
}

fn poses(extrema: &[Zero], at: impl Fn(f64) -> [f64; 3]) -> Vec<StablePose> {
    let hills: Vec<f64> = extrema.iter().filter(|zero| !zero.rises).map(|zero| zero.at).collect();
    let valleys = extrema.iter().filter(|zero| zero.rises);
    let share = |phi0: f64| {
        let behind = hills.iter().map(|hill| (phi0 - hill).rem_euclid(TAU)).fold(TAU, f64::min);
        let ahead = hills.iter().map(|hill| (hill - phi0).rem_euclid(TAU)).fold(TAU, f64::min);
        ((behind + ahead) / TAU).min(1.0)
    };
    valleys
        .map(|zero| {
            let [height, _, stiffness] = at(zero.at);
            StablePose { phi0: zero.at, height, stiffness, share: share(zero.at) }
        })
        .collect()
}

/// All stable poses between palms that rest, by `phi0`. None for a disc about its middle, which is at rest in every pose.
pub fn stable_poses(body: &PoseBody, palms: PalmPair) -> Vec<StablePose> {
    let at = |phi0: f64| potential(body, palms, phi0);
    let slopes = |phi0: f64| {
        let [_, slope, second] = at(phi0);
        [slope, second]
    };
    poses(&zeros_over_a_turn(slopes, SAMPLES), at)
}

/// All stable poses on a level table: local minima of the support function at the normal that points down. What trimesh's
/// `compute_stable_poses` is asked for of polyhedra, with the share of each.
pub fn level_poses(body: &PoseBody) -> Vec<StablePose> {
    let at = |phi0: f64| {
        let [r, slope, second] = body.support(-FRAC_PI_2 - phi0);
        [r, -slope, second]
    };
    poses(&zeros_over_a_turn(|phi0| [at(phi0)[1], at(phi0)[2]], SAMPLES), at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_surface::body::tests::{egg, off_centre};

    /// Brute force: the body as a polygon of 6000 corners is laid on the palms at 1500 orientations, and where the height of its
    /// centre of mass is less than at both neighbours is a stable pose; from each orientation the downhill walk ends somewhere.
    #[test]
    fn stable_poses_are_minima_of_a_polygon() {
        const TURNS: usize = 1500;
        for (body, phi1, phi2) in
            [(egg(), 0.5, 1.4), (off_centre(), 0.9, 0.4), (egg(), 0.1, 2.8), (off_centre(), 0.3, 1.9)]
        {
            let corners = body.outline(6000);
            let reach = |angle: f64| {
                let (s, c) = angle.sin_cos();
                corners.iter().map(|p| p[0] * c + p[1] * s).fold(f64::MIN, f64::max)
            };
            // the reach at each degree is asked for often: both contacts over all orientations
            let height = |i: usize| {
                let phi0 = TAU * i as f64 / TURNS as f64;
                let [first, second] = PalmPair::new(phi1, phi2).normals(phi0).map(reach);
                (f64::sin(phi1 + phi2) * first + phi1.sin() * second) / phi2.sin()
            };
            let heights: Vec<f64> = (0..TURNS).map(height).collect();
            let around = |i: usize| [heights[(i + TURNS - 1) % TURNS], heights[(i + 1) % TURNS]];
            let mut ends = vec![0_usize; TURNS];
            for start in 0..TURNS {
                let mut i = start;
                loop {
                    let [before, after] = around(i);
                    if before >= heights[i] && after >= heights[i] {
                        break;
                    }
                    i = if before < after { (i + TURNS - 1) % TURNS } else { (i + 1) % TURNS };
                }
                ends[i] += 1;
            }
            let minima: Vec<(usize, usize)> =
                ends.iter().copied().enumerate().filter(|(_, count)| *count > 0).collect();
            let found = stable_poses(&body, PalmPair::new(phi1, phi2));
            assert_eq!(found.len(), minima.len(), "{minima:?} {found:?}");
            for (pose, (place, count)) in found.iter().zip(minima) {
                let step = TAU / TURNS as f64;
                assert!((pose.phi0 - step * place as f64).abs() < 2.0 * step, "{pose:?} {place}");
                assert!((pose.share - count as f64 / TURNS as f64).abs() < 3.0 / TURNS as f64);
                assert!(pose.stiffness > 0.0);
            }
        }
    }

    /// An ellipse lies on its flat side, and half of all orientations end on either; with its mass off centre along the long axis the two
    /// poses have the same share, off along the short axis one of them vanishes in the end.
    #[test]
    fn an_ellipse_on_a_table() {
        let found = level_poses(&PoseBody::parse("ellipse:2,1", None).unwrap());
        assert_eq!(found.len(), 2);
        for (pose, expected) in found.iter().zip([0.0, TAU / 2.0]) {
            assert!((pose.phi0 - expected).abs().min((pose.phi0 - expected - TAU).abs()) < 1e-12);
            assert!((pose.share - 0.5).abs() < 1e-12 && (pose.height - 1.0).abs() < 1e-12);
            // r'' = (a^2 - b^2)/b at the end of the short axis
            assert!((pose.stiffness - 3.0).abs() < 1e-10);
        }
        // r = sqrt(4 c^2 + s^2) + e s about a centre e below the middle: at the top r'' = 3 - e, still a minimum
        let low = level_poses(&PoseBody::parse("ellipse:1.2,1", Some([0.0, -0.6])).unwrap());
        assert_eq!(low.len(), 1, "0.44 - 0.6 < 0: it rights itself");
        assert!((low[0].share - 1.0).abs() < 1e-12);
    }

    /// Any number of stable poses with the same measurements (figure 3.17), without its construction: `h = 1 + e cos k a` with `|e| < 1/(k^2 - 1)` is
    /// convex and comes to itself after the `k`th part of a turn, so that each stable pose is one of `k` with the same palms and the same measurements.
    /// The centre of mass at the centroid is the middle. That `k` parts of a turn bring it to itself is exact: `cos(k a + 2 pi) = cos(k a)`.
    #[test]
    fn any_number_of_poses_has_the_same_measurements() {
        use crate::pose_surface::potential::measurements;
        for k in 2..9_usize {
            let size = 0.9 / (k * k - 1) as f64;
            let zeros = "0,0,".repeat(k - 2);
            let body = PoseBody::parse(&format!("harmonics:1,{zeros}{size},0"), None).unwrap();
            for palms in [PalmPair::new(0.6, 1.6), PalmPair::new(0.2, 0.7), PalmPair::new(1.3, 0.9)] {
                let found = stable_poses(&body, palms);
                assert!(!found.is_empty() && found.len().is_multiple_of(k), "{} poses for {k}", found.len());
                let part = found.len() / k;
                for (i, pose) in found.iter().enumerate() {
                    let next = &found[(i + part) % found.len()];
                    assert!(((next.phi0 - pose.phi0).rem_euclid(TAU) - TAU / k as f64).abs() < 1e-9);
                    let [one, other] = [pose, next].map(|pose| measurements(&body, palms, pose.phi0));
                    assert!((one[0] - other[0]).abs() + (one[1] - other[1]).abs() < 1e-9);
                    assert!(pose.stiffness > 0.0);
                }
            }
            let dented = format!("harmonics:1,{zeros}{},0", 1.01 / (k * k - 1) as f64);
            assert!(PoseBody::parse(&dented, None).is_err(), "beyond the bound it is not convex");
        }
    }

    /// The kernel by which bodies are moved, written independently of this one, finds the same poses.
    #[test]
    fn the_kernel_of_moving_bodies_finds_the_same() {
        use crate::mechanics::resting::stable_poses as by_kernel;
        for body in [egg(), off_centre()] {
            for (phi1, phi2) in [(0.5, 1.4), (0.9, 0.4), (0.1, 2.8), (0.3, 1.9), (1.5, 0.2)] {
                let other = by_kernel(&|angle| body.support(angle), [phi1, phi2]);
                let found = stable_poses(&body, PalmPair::new(phi1, phi2));
                assert_eq!(found.len(), other.len());
                for pose in found {
                    let off = |x: &f64| (x - pose.phi0).rem_euclid(TAU).min((pose.phi0 - x).rem_euclid(TAU));
                    assert!(other.iter().map(off).fold(TAU, f64::min) < 1e-9);
                }
            }
        }
    }

    #[test]
    fn shares_add_up_to_one() {
        for body in [egg(), off_centre()] {
            for palms in [PalmPair::new(0.2, 0.3), PalmPair::new(1.0, 1.0), PalmPair::new(0.4, 2.5)] {
                let sum: f64 = stable_poses(&body, palms).iter().map(|pose| pose.share).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{sum}");
            }
            let sum: f64 = level_poses(&body).iter().map(|pose| pose.share).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}
