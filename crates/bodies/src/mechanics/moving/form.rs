//! How a body looks, as a researcher writes it down, and why it may be no body that palms can hold.

use serde::Deserialize;

/// The outline of a body, in a frame of its own. Lengths are in metres, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyForm {
    /// The support function `h(a) = mean + sum_k (p_k cos(k a) + q_k sin(k a))`, `harmonics[k - 1]` being `[p_k,
    /// q_k]`. The first harmonic moves the body without changing its form.
    Harmonics { mean: f64, harmonics: Vec<[f64; 2]> },
    /// `(x/a)^2 + (y/b)^2 <= 1`.
    Ellipse { semi_axes: [f64; 2] },
    /// The support function `(|a cos|^p + |b sin|^p)^(1/p) + rounding`, `p` the even exponent: the body `|x/a|^q +
    /// |y/b|^q <= 1` with `1/p + 1/q = 1`, to which a disc of the radius `rounding` is added (Minkowski). For `p > 2`
    /// the first has corners on its axes, which the disc rounds off.
    Superellipse { semi_axes: [f64; 2], exponent: u32, rounding: f64 },
    /// Corners, counterclockwise, joined by arcs of one radius that bulge; while a corner touches a palm it is the same point of the body that does.
    Arcs { corners: Vec<[f64; 2]>, radius: f64 },
    /// Section 3.4 of the thesis: the closed cubic spline through the points with the polar coordinates `(0, q1)`,
    /// `(2 pi/3, q2)` and `(4 pi/3, q3)`.
    Spline { radii: [f64; 3], knots: Knots },
}

/// By how much the parameter of a closed spline grows from one point to the next; the thesis does not say.
///
/// Splines with the other two are convex as well for all radii on a grid over those of section 3.4, with steps of 0.2 m;
/// that they always are is not proved, so each is checked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Knots {
    /// By the same everywhere. Three points are the affine image of an equilateral triangle's corners, and then so
    /// is the spline: it is convex whatever the radii.
    #[default]
    Uniform,
    /// By the square root of the points' distance (E. T. Y. Lee, "Choosing nodes in parametric curve interpolation",
    /// Computer-Aided Design 21, 1989).
    Centripetal,
    /// By the points' distance.
    Chord,
}

/// Where the centre of mass is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CentreOfMass {
    /// At the centroid, as in a body of one material.
    #[default]
    Uniform,
    /// At a point of the frame in which the form is given, in metres.
    At([f64; 2]),
}

/// Why a form is not that of a body that the palms can hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FormError {
    #[error("{what} is {value}, not a finite number")]
    NotFinite { what: String, value: f64 },
    #[error("{what} is {value}; it has to be positive")]
    NotPositive { what: &'static str, value: f64 },
    #[error("the exponent is {0}; it has to be even, from 2 to {MOST_EXPONENT}")]
    Exponent(u32),
    #[error("for an exponent above 2 the outline has corners: give a rounding above 0 m, not {0}")]
    Corners(f64),
    /// By its support function.
    #[error(
        "the body is not strictly convex: where the outward normal is at {angle:.4} rad the radius of \
         curvature would be {radius:.4e} m; make the harmonics smaller"
    )]
    NotConvex { angle: f64, radius: f64 },
    /// By its outline.
    #[error(
        "the spline is not strictly convex: at ({x:.4}, {y:.4}) m, polar angle {polar:.4} rad, its curvature \
         is {curvature:.4e} 1/m; take radii that differ less, or uniform knots"
    )]
    Dent { x: f64, y: f64, polar: f64, curvature: f64 },
    #[error("a body with corners has at least 2 of them, not {0}")]
    FewCorners(usize),
    #[error(
        "side {side} is {chord:.4} m long: an arc of the radius {radius} m that is less than half of its circle \
         has to join corners that are different and less than twice as far apart"
    )]
    Side { side: usize, chord: f64, radius: f64 },
    #[error("at corner {corner} the outline turns back: give corners counterclockwise, or a greater radius")]
    Bulges { corner: usize },
    #[error(
        "the corners turn {0:.4} times around where once is wanted; give them counterclockwise, in their order"
    )]
    CornersTurn(f64),
    #[error(
        "the body has corners, which is not for this: its radius of curvature has to be positive everywhere"
    )]
    HasCorners,
    #[error("the spline turns {0:.4} times around where once is wanted; take radii that differ less")]
    Loops(f64),
    #[error(
        "the centre of mass ({x:.4}, {y:.4}) m is not inside the body: in the direction {angle:.4} rad the body \
         reaches {support:.4e} m from it"
    )]
    CentreOutside { x: f64, y: f64, angle: f64, support: f64 },
    /// The sign could not be decided in double precision.
    #[error(
        "cannot decide whether {what} is positive near {angle:.4} rad: it is {value:.1e} there, too close to zero"
    )]
    TooClose { what: &'static str, angle: f64, value: f64 },
    #[error("the area or perimeter did not settle: the last two approximations differ by a relative {0:.1e}")]
    Quadrature(f64),
    #[error("none of {0} drawn splines is convex")]
    NoConvexDraw(usize),
}

/// Sharper corners than this exponent makes are not worth their quadrature.
pub const MOST_EXPONENT: u32 = 64;

/// A length that has to be finite and positive.
pub(super) fn length(what: &'static str, value: f64) -> Result<f64, FormError> {
    match value {
        _ if !value.is_finite() => Err(FormError::NotFinite { what: what.to_owned(), value }),
        _ if value <= 0.0 => Err(FormError::NotPositive { what, value }),
        _ => Ok(value),
    }
}
