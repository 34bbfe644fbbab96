//! The support function on the sphere that explains touched normals best: weighted least squares for the coefficients of spherical harmonics.
//!
//! # What every convex body obeys
//!
//! The sum of both radii of curvature, `2 h + div grad h` on the sphere, is nowhere negative, so that the mean of it times a harmonic is no larger than its own mean, twice that of `h`, times the
//! largest value of the harmonic, `sqrt(2l + 1)` at most: `|c_lm| <= 2 c_00 sqrt(2l + 1)/((l - 1)(l + 2))`. In degree one, `|c_1m| <= c_00 sqrt 3`, for `h` is not negative about a point inside. As in the plane
//! these bounds are taken for standard deviations about zero, and that is all the regularisation there is.

use super::bounds::{BoundedRegion, SurfaceTouch};
use super::harmonics::SphereSeries;
use nalgebra::{DMatrix, DVector, Vector3};

/// How far a body reaches at one normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidSample {
    /// The outward normal in the body's frame, a unit vector.
    pub normal: Vector3<f64>,
    /// The support radius there, in m.
    pub radius: f64,
    /// The inverse of its variance, in 1/m^2.
    pub weight: f64,
}

impl SolidSample {
    /// The sample of a contact.
    pub fn of(touch: &SurfaceTouch, weight: f64) -> SolidSample {
        SolidSample { normal: touch.normal, radius: touch.normal.dot(&touch.point), weight }
    }
}

/// A support function with the covariance of its coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidEstimate {
    /// The support function.
    pub support: SphereSeries,
    /// Of the coefficients, in m^2.
    pub covariance: DMatrix<f64>,
    /// The sum of the squared residuals, in units of the samples' variances.
    pub chi_square: f64,
    /// Samples less unknowns; at least one.
    pub degrees: usize,
}

/// The last degree that is tried.
const MOST_DEGREE: usize = 12;

/// So many rows are taken into the triangle at once.
const ROWS: usize = 512;

/// The support function that explains samples best; of the degree that is given, or of the one up to 12 with the least criterion of G. Schwarz (1978). Samples without a
/// positive finite weight do not count; none where no other is left, or they determine no positive mean radius.
///
/// ```
/// use nalgebra::Vector3;
/// use palmistry_bodies::shape::sphere::{SolidSample, fit_solid};
/// // a ball of radius 2 about a point 0.3 off its centre, touched along two circles
/// let sample = |i: u32| {
///     let (sine, cosine) = (f64::from(i) / 10.0).sin_cos();
///     let normal = if i % 2 == 0 { Vector3::new(cosine, sine, 0.0) } else { Vector3::new(0.0, sine, cosine) };
///     SolidSample { normal, radius: 2.0 - 0.3 * normal.y, weight: 1e6 }
/// };
/// let shape = fit_solid(&(0..126).map(sample).collect::<Vec<_>>(), None).unwrap();
/// assert_eq!(shape.support.degree, 1);
/// assert!((shape.support.support(&Vector3::y()) - 1.7).abs() < 1e-6);
/// ```
pub fn fit_solid(samples: &[SolidSample], degree: Option<usize>) -> Option<SolidEstimate> {
    let counts = |s: &&SolidSample| {
        s.weight > 0.0
            && s.weight.is_finite()
            && s.radius.is_finite()
            && s.normal.iter().all(|v| v.is_finite())
    };
    let samples: Vec<SolidSample> = samples.iter().filter(counts).copied().collect();
    let total: f64 = samples.iter().map(|s| s.weight).sum();
    let mean = samples.iter().map(|s| s.weight * s.radius).sum::<f64>() / total;
    if !(mean > 0.0 && mean.is_finite()) {
        return None;
    }
    let most = degree.unwrap_or(MOST_DEGREE);
    let columns = (most + 1) * (most + 1);
    let mut triangle = DMatrix::zeros(0, columns + 1);
    for part in samples.chunks(ROWS) {
        let mut rows = DMatrix::zeros(triangle.nrows() + part.len(), columns + 1);
        rows.rows_mut(0, triangle.nrows()).copy_from(&triangle);
        for (k, sample) in part.iter().enumerate() {
            let (row, root) = (triangle.nrows() + k, sample.weight.sqrt());
            for (column, value) in SphereSeries::basis(&sample.normal, most).into_iter().enumerate() {
                rows[(row, column)] = root * value;
            }
            rows[(row, columns)] = root * sample.radius;
        }
        triangle = rows.qr().unpack_r();
    }
    let degrees: Vec<usize> = degree.map_or((0..=MOST_DEGREE).collect(), |degree| vec![degree]);
    let fits =
        degrees.into_iter().filter_map(|degree| solve(&triangle, columns, degree, mean, samples.len()));
    let criterion = |shape: &SolidEstimate| {
        shape.chi_square + shape.support.coefficients.len() as f64 * (samples.len() as f64).ln()
    };
    fits.min_by(|a, b| criterion(a).total_cmp(&criterion(b)))
}

/// The standard deviation that convexity gives coefficients of a degree.
fn convex_deviation(mean: f64, degree: usize) -> f64 {
    let l = degree as f64;
    match degree {
        0 => f64::INFINITY,
        1 => mean * 3f64.sqrt(),
        _ => 2.0 * mean * (2.0 * l + 1.0).sqrt() / ((l - 1.0) * (l + 2.0)),
    }
}

fn solve(
    triangle: &DMatrix<f64>,
    columns: usize,
    degree: usize,
    mean: f64,
    samples: usize,
) -> Option<SolidEstimate> {
    let unknowns = (degree + 1) * (degree + 1);
    let held = triangle.nrows();
    let mut rows = DMatrix::zeros(held + unknowns, unknowns);
    rows.view_mut((0, 0), (held, unknowns)).copy_from(&triangle.columns(0, unknowns));
    for k in 0..unknowns {
        let deviation = convex_deviation(mean, k.isqrt());
        rows[(held + k, k)] = 1.0 / deviation;
    }
    let mut right = DVector::zeros(held + unknowns);
    right.rows_mut(0, held).copy_from(&triangle.column(columns));
    let r = rows.clone().qr();
    let mut turned = right.clone();
    r.q_tr_mul(&mut turned);
    let upper = r.unpack_r();
    let coefficients = upper.solve_upper_triangular(&turned.rows(0, unknowns).into_owned())?;
    let inverse = upper.solve_upper_triangular(&DMatrix::identity(unknowns, unknowns))?;
    let left = rows.rows(0, held) * &coefficients - right.rows(0, held);
    let chi_square = left.norm_squared();
    let degrees = samples.saturating_sub(unknowns).max(1);
    let widened = (chi_square / degrees as f64).max(1.0);
    let finite = coefficients.iter().all(|value| value.is_finite());
    finite.then(|| SolidEstimate {
        support: SphereSeries { coefficients: coefficients.as_slice().to_vec(), degree },
        covariance: &inverse * inverse.transpose() * widened,
        chi_square,
        degrees,
    })
}

impl SolidEstimate {
    /// The standard deviation of the support radius at a unit vector, in m, if the body has no harmonics beyond those of the series.
    pub fn deviation(&self, n: &Vector3<f64>) -> f64 {
        let basis = DVector::from_vec(SphereSeries::basis(n, self.support.degree));
        (&self.covariance * &basis).dot(&basis).max(0.0).sqrt()
    }

    /// From where to where the support radius can be at a unit vector, in m: no less than the body's inner bound reaches, no more than its outer bound, where there is one, and two
    /// standard deviations about those. Where the body was touched both are near, and elsewhere no sample says more than they do.
    pub fn band(&self, n: &Vector3<f64>, inner: &BoundedRegion, outer: Option<&BoundedRegion>) -> [f64; 2] {
        let reach = |region: &BoundedRegion| {
            region.surface.corners.iter().map(|corner| corner.dot(n)).fold(f64::NEG_INFINITY, f64::max)
        };
        let deviation = 2.0 * self.deviation(n);
        [reach(inner) - deviation, outer.map_or(f64::INFINITY, |outer| reach(outer) + deviation)]
    }
}
