//! A support function as it was modelled: a Fourier polynomial, or that of a closed spline.

use super::{Convexity, SupportSeries, SupportSpline, convexity};
use nalgebra::DVector;
use std::f64::consts::{PI, TAU};

/// A closed support function.
#[derive(Clone, Debug, PartialEq)]
pub enum SupportFunction {
    /// A Fourier polynomial of the normal's angle.
    Series(SupportSeries),
    /// That of a closed cubic spline through a few points.
    Spline(SupportSpline),
}

impl From<SupportSeries> for SupportFunction {
    fn from(series: SupportSeries) -> SupportFunction {
        SupportFunction::Series(series)
    }
}

impl SupportFunction {
    /// The coefficients: of a series `a_0, a_1, b_1, ...`, of a spline the points' coordinates and the logarithms of its steps.
    pub fn coefficients(&self) -> Vec<f64> {
        match self {
            SupportFunction::Series(series) => series.coefficients(),
            SupportFunction::Spline(spline) => spline.coefficients(),
        }
    }

    /// The same kind of function with other coefficients; none where there is none.
    pub fn with(&self, coefficients: &[f64]) -> Option<SupportFunction> {
        match self {
            SupportFunction::Series(_) => Some(SupportSeries::of_coefficients(coefficients).into()),
            SupportFunction::Spline(_) => {
                SupportSpline::of_coefficients(coefficients).map(SupportFunction::Spline)
            }
        }
    }

    /// The harmonics of a series; of a spline none.
    pub fn harmonics(&self) -> &[[f64; 2]] {
        match self {
            SupportFunction::Series(series) => &series.harmonics,
            SupportFunction::Spline(_) => &[],
        }
    }

    /// `k` of the last harmonic of a series; zero for a spline.
    pub fn order(&self) -> usize {
        self.harmonics().len()
    }

    /// The points of a spline, in m; of a series none.
    pub fn points(&self) -> &[[f64; 2]] {
        match self {
            SupportFunction::Series(_) => &[],
            SupportFunction::Spline(spline) => spline.points(),
        }
    }

    /// The mean radius, in m.
    pub fn mean(&self) -> f64 {
        match self {
            SupportFunction::Series(series) => series.mean,
            SupportFunction::Spline(spline) => spline.perimeter() / TAU,
        }
    }

    /// `[r, r', r'', r''']` at an angle, in m.
    pub fn support(&self, angle: f64) -> [f64; 4] {
        match self {
            SupportFunction::Series(series) => series.support(angle),
            SupportFunction::Spline(spline) => spline.support(angle),
        }
    }

    /// The derivatives of `[r, r', r'']` at an angle by the coefficients, in their order.
    pub fn basis(&self, angle: f64) -> Vec<[f64; 4]> {
        match self {
            SupportFunction::Series(series) => SupportSeries::basis(angle, series.order()),
            SupportFunction::Spline(spline) => spline.basis(angle),
        }
    }

    /// The boundary point with the outward normal at this angle, `r u + r' u'`, in m.
    pub fn point(&self, angle: f64) -> [f64; 2] {
        let ([r, slope, ..], (sine, cosine)) = (self.support(angle), angle.sin_cos());
        [r * cosine - slope * sine, r * sine + slope * cosine]
    }

    /// The radius of curvature `r + r''` there, in m.
    pub fn radius_of_curvature(&self, angle: f64) -> f64 {
        let [r, _, second, _] = self.support(angle);
        r + second
    }

    /// In m.
    pub fn perimeter(&self) -> f64 {
        match self {
            SupportFunction::Series(series) => series.perimeter(),
            SupportFunction::Spline(spline) => spline.perimeter(),
        }
    }

    /// In m^2.
    pub fn area(&self) -> f64 {
        match self {
            SupportFunction::Series(series) => series.area(),
            SupportFunction::Spline(spline) => spline.area(),
        }
    }

    /// The derivatives of perimeter and area by the coefficients.
    pub(super) fn sizes_by_coefficients(&self) -> [DVector<f64>; 2] {
        match self {
            SupportFunction::Series(series) => {
                let all = series.coefficients();
                let area = all.iter().enumerate().map(|(i, value)| {
                    let k = i.div_ceil(2) as f64;
                    if i == 0 { TAU * value } else { PI * (1.0 - k * k) * value }
                });
                let area = DVector::from_iterator(all.len(), area);
                let mut perimeter = DVector::zeros(all.len());
                perimeter[0] = TAU;
                [perimeter, area]
            }
            SupportFunction::Spline(spline) => spline.integrated(),
        }
    }

    /// Whether it is that of a convex body: of a series by interval arithmetic; of a spline by the least value of a quadratic polynomial on each piece, the least radius of curvature by a fine grid.
    pub fn convexity(&self) -> Convexity {
        let spline = match self {
            SupportFunction::Series(series) => return convexity(series),
            SupportFunction::Spline(spline) => spline,
        };
        const NORMALS: u32 = 2880;
        // so many roundings are no sign
        const ROUNDED: f64 = 64.0 * f64::EPSILON;
        match spline.least_turning() {
            (least, _) if least > ROUNDED => {
                let at = |i: u32| self.radius_of_curvature(TAU * f64::from(i) / f64::from(NORMALS));
                Convexity::Convex { least: (0..NORMALS).map(at).fold(f64::INFINITY, f64::min) }
            }
            (least, angle) if least < -ROUNDED => Convexity::NotConvex { angle, value: least * self.mean() },
            (_, angle) => Convexity::Undecided { angle },
        }
    }
}
