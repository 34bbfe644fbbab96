//! The support function of a superellipse's dual, rounded by a disc; with the exponent 2, of an ellipse.

use super::form::{FormError, MOST_EXPONENT, length};
use super::plane::unit;

/// `h = (|A cos a|^p + |B sin a|^p)^(1/p) + rounding`.
#[derive(Clone, Debug)]
pub(super) struct Superellipse {
    semi_axes: [f64; 2],
    exponent: i32,
    rounding: f64,
}

impl Superellipse {
    pub(super) fn new(semi_axes: [f64; 2], exponent: u32, rounding: f64) -> Result<Self, FormError> {
        length("the first semi-axis", semi_axes[0])?;
        length("the second semi-axis", semi_axes[1])?;
        if !rounding.is_finite() {
            return Err(FormError::NotFinite { what: "the rounding".into(), value: rounding });
        }
        if !(2..=MOST_EXPONENT).contains(&exponent) || exponent % 2 == 1 {
            return Err(FormError::Exponent(exponent));
        }
        if rounding < 0.0 {
            return Err(FormError::NotPositive { what: "the rounding", value: rounding });
        }
        if exponent > 2 && rounding == 0.0 {
            return Err(FormError::Corners(rounding));
        }
        Ok(Superellipse { semi_axes, exponent: exponent as i32, rounding })
    }

    /// `h`, `h'` and `h''`.
    ///
    /// With `X = A cos a`, `Y = B sin a`, divided by the greater of both, and `T = X^p + Y^p`: by Lagrange's identity
    /// `h + h'' = (p - 1) T^(1/p - 2) (X Y)^(p - 2) (X' Y - X Y')^2` before the rounding, and `X' Y - X Y' = -A B`. So
    /// the radius of curvature is nowhere below the rounding, and for `p = 2` it is `A^2 B^2 / h^3`.
    pub(super) fn support(&self, angle: f64) -> [f64; 3] {
        let ([a, b], [cosine, sine], p) = (self.semi_axes, unit(angle), self.exponent);
        let size = (a * cosine).abs().max((b * sine).abs());
        let (x, y) = (a * cosine / size, b * sine / size);
        let total = x.powi(p) + y.powi(p);
        let root = total.powf(1.0 / f64::from(p));
        let core = size * root;
        let slope = (y.powi(p - 1) * b * cosine - x.powi(p - 1) * a * sine) * root / total;
        let twist = (a / size) * (b / size);
        let radius = size * f64::from(p - 1) * root / (total * total) * (x * y).powi(p - 2) * twist * twist;
        [core + self.rounding, slope, radius - core]
    }

    /// No point of the outline is farther from the origin than this.
    pub(super) fn reach(&self) -> f64 {
        self.semi_axes[0].hypot(self.semi_axes[1]) + self.rounding
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form of the ellipse, and central differences of `h` for the others: with the step `1e-4` they are off
    /// by `1e-8` times a sixth of the third, or a twelfth of the fourth derivative.
    #[test]
    fn derivatives_of_the_support_function() {
        let ellipse = Superellipse::new([1.3, 0.7], 2, 0.0).unwrap();
        let bodies =
            [(4, 0.2), (6, 0.1), (2, 0.3)].map(|(p, r)| Superellipse::new([1.3, 0.7], p, r).unwrap());
        for i in 0..100 {
            let angle = 0.31 + 0.0628 * f64::from(i);
            let [h, slope, second] = ellipse.support(angle);
            let exact = (1.3 * angle.cos()).hypot(0.7 * angle.sin());
            assert!((h - exact).abs() < 1e-15);
            assert!((h + second - (1.3f64 * 0.7).powi(2) / exact.powi(3)).abs() < 1e-14);
            assert!((slope - (0.49 - 1.69) * angle.sin() * angle.cos() / exact).abs() < 1e-15);
            for body in &bodies {
                let [before, [h, slope, second], after] =
                    [-1e-4, 0.0, 1e-4].map(|step| body.support(angle + step));
                assert!((slope - (after[0] - before[0]) / 2e-4).abs() < 1e-6);
                assert!((second - (after[1] - before[1]) / 2e-4).abs() < 1e-5, "{second}");
                assert!(h + second >= body.rounding);
            }
        }
    }

    #[test]
    fn a_superellipse_with_corners_is_refused() {
        let refused = |p, r| Superellipse::new([1.0, 1.0], p, r).err().map(|e| e.to_string());
        assert!(refused(4, 0.0).is_some_and(|text| text.contains("corners")));
        assert!(refused(3, 0.1).is_some_and(|text| text.contains("even")));
        assert!(refused(2, -0.1).is_some() && refused(2, 0.0).is_none());
    }
}
