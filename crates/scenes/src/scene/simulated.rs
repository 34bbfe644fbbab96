//! The simulated motion: a body and two palms (lengths in metres, masses in kilograms, angles in radians), or any system.

use palmistry_bodies::mechanics::moving::{Drive, Knots};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A body between palms, and the times of its measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// `duration`: the time of the last sample, in seconds; the first is at zero. (With `rate`, the last sample is at
    /// the last whole period up to the duration, and this is that.)
    pub duration: f64,
    /// `samples`, or what follows from `rate` (in hertz): the number of samples, both ends included.
    pub samples: usize,
    /// `[body]`.
    pub body: Body,
    /// `[palms]`.
    pub palms: Palms,
}

impl Simulated {
    /// The times of the samples in seconds, from zero to the duration: even steps where the jitter is zero.
    ///
    /// With a jitter (the standard deviation of a step, in seconds) every step is drawn from three that are equally
    /// likely, the even one and one on either side: in figure 3.9b of the thesis the times between measurements lie in
    /// three bands. All steps are then scaled by one factor that keeps the duration. A jitter of more than 0.8 steps
    /// counts as that, so that time does not run backwards; a scene cannot ask for more.
    pub fn times(&self, jitter: f64, seed: u64) -> Vec<f64> {
        sample_times(self.duration, self.samples, jitter, seed)
    }
}

/// The times of so many samples, as [`Simulated::times`].
pub(crate) fn sample_times(duration: f64, samples: usize, jitter: f64, seed: u64) -> Vec<f64> {
    let steps = samples.saturating_sub(1);
    let even = duration / steps.max(1) as f64;
    if jitter <= 0.0 {
        return (0..=steps).map(|i| duration * i as f64 / steps.max(1) as f64).collect();
    }
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    // three equally likely values -b, 0, b have the variance 2/3 b^2
    let band = jitter.min(MOST_JITTER * even) * 1.5_f64.sqrt();
    let mut times = vec![0.0];
    let mut time = 0.0;
    for _ in 0..steps {
        time += even + band * f64::from(random.random_range(-1..=1_i8));
        times.push(time);
    }
    let scale = if time > 0.0 { duration / time } else { 1.0 };
    times.iter_mut().for_each(|time| *time *= scale);
    if let Some(last) = times.last_mut() {
        *last = duration;
    }
    times
}

/// A system that moves by the equations of its proof file, from a state that is given.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedSystem {
    /// `duration`: the time of the last sample, in seconds; as of [`Simulated`].
    pub duration: f64,
    /// `samples`, or what follows from `rate`: the number of samples, both ends included.
    pub samples: usize,
    /// `[start]`: the value of each state at the first sample, and of constants that differ from the file's.
    pub start: BTreeMap<String, f64>,
    /// `[inputs]`: functions of the time `t` in seconds, by the names of known signals or of parameters that they stand for.
    pub inputs: BTreeMap<String, String>,
}

impl SimulatedSystem {
    /// The times of the samples, as [`Simulated::times`].
    pub fn times(&self, jitter: f64, seed: u64) -> Vec<f64> {
        sample_times(self.duration, self.samples, jitter, seed)
    }
}

/// The largest jitter, in steps.
pub(super) const MOST_JITTER: f64 = 0.8;

/// The body that is held.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// `shape`: its outline.
    pub shape: SceneOutline,
    /// `mass`, in kg.
    pub mass: f64,
    /// `radius_of_gyration` about the centre of mass, in m; absent: that of a uniform body.
    pub radius_of_gyration: Option<f64>,
    /// `centre_of_mass`, in m in the shape's own frame; absent: that of a uniform body.
    pub centre_of_mass: Option<[f64; 2]>,
    /// `orientation`: phi0 at the start, in rad; 0 unless given.
    #[serde(default)]
    pub orientation: f64,
    /// `rate`: omega0 at the start, in rad/s; 0 unless given.
    #[serde(default)]
    pub rate: f64,
    /// `gravity` along the Y axis, in m/s^2: negative where it points down; -9.81 unless given.
    #[serde(default = "downwards")]
    pub gravity: f64,
}

pub(super) fn downwards() -> f64 {
    -9.81
}

/// A known body that recognition compares with the measurements: `[[observer.library]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LibraryBody {
    /// `name`.
    pub name: String,
    /// `shape`: its outline.
    pub shape: SceneOutline,
    /// `radius_of_gyration` about the centre of mass, in m; absent: that of a uniform body.
    pub radius_of_gyration: Option<f64>,
    /// `centre_of_mass`, in m in the shape's own frame; absent: that of a uniform body.
    pub centre_of_mass: Option<[f64; 2]>,
}

/// An outline, by its `kind`. Lengths are in metres, the angle `a` is that of the outward normal.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SceneOutline {
    /// `harmonics`: the support function `mean + sum_k (p_k cos(k a) + q_k sin(k a))`.
    Harmonics {
        /// The mean.
        mean: f64,
        /// The pairs `[p_k, q_k]`, from `k = 1`; none unless given.
        #[serde(default)]
        harmonics: Vec<[f64; 2]>,
    },
    /// `ellipse`.
    Ellipse {
        /// Along the body's axes.
        semi_axes: [f64; 2],
    },
    /// `superellipse`: the support function `(|A cos a|^p + |B sin a|^p)^(1/p)`, and a disc added to it.
    Superellipse {
        /// `A` and `B`.
        semi_axes: [f64; 2],
        /// `p`.
        exponent: u32,
        /// The radius of the disc that rounds the corners; 0 unless given.
        #[serde(default)]
        rounding: f64,
    },
    /// `arcs`: corners, counterclockwise, joined by arcs of one radius that bulge.
    Arcs {
        /// Their positions.
        corners: Vec<[f64; 2]>,
        /// The radius of all sides.
        radius: f64,
    },
    /// `spline`: the closed cubic spline through three points at even angles, as in section 3.4 of the thesis.
    Spline {
        /// Their distances from the origin.
        radii: [f64; 3],
        /// How the curve's parameter grows from point to point; `uniform` unless given.
        #[serde(default)]
        knots: Knots,
    },
    /// `random-spline`: such a spline with radii drawn as in section 3.4.
    RandomSpline {
        /// The seed of the draw.
        seed: u64,
        /// How the curve's parameter grows from point to point; `uniform` unless given.
        #[serde(default)]
        knots: Knots,
    },
}

/// The two palms; palm 2 is measured from palm 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Palms {
    /// `inertia`: the moments of inertia about the origin, in kg m^2.
    pub inertia: [f64; 2],
    /// `prescribed` or `torques`: how they are moved.
    pub drive: Drive,
    /// `friction`: the coefficient of Coulomb friction at both contacts, which are on flat palms then; 0 unless given.
    pub friction: f64,
}
