//! A strictly convex body by its support function about its centre of mass.

use super::arcs::Arcs;
use super::form::{BodyForm, CentreOfMass, FormError};
use super::plane::{Plane, along, dot, left_of, scaled, unit};
use super::positive::{Doubt, positive_everywhere};
use super::quadrature::{Integrals, over_a_turn, rates};
use super::series::Series;
use super::spline::ClosedSpline;
use super::superellipse::Superellipse;
use std::f64::consts::TAU;

/// A support function in the frame of its form.
#[derive(Clone, Debug)]
enum Curve {
    Harmonics(Series),
    Superellipse(Superellipse),
    Spline(ClosedSpline),
    Arcs(Arcs),
}

impl Curve {
    fn new(form: &BodyForm) -> Result<Self, FormError> {
        Ok(match form {
            BodyForm::Harmonics { mean, harmonics } => Curve::Harmonics(Series::new(*mean, harmonics)?),
            BodyForm::Ellipse { semi_axes } => Curve::Superellipse(Superellipse::new(*semi_axes, 2, 0.0)?),
            BodyForm::Superellipse { semi_axes, exponent, rounding } => {
                Curve::Superellipse(Superellipse::new(*semi_axes, *exponent, *rounding)?)
            }
            BodyForm::Arcs { corners, radius } => Curve::Arcs(Arcs::new(corners, *radius)?),
            BodyForm::Spline { radii, knots } => Curve::Spline(ClosedSpline::new(*radii, *knots)?),
        })
    }

    fn support(&self, angle: f64) -> [f64; 3] {
        match self {
            Curve::Harmonics(curve) => curve.support(angle),
            Curve::Superellipse(curve) => curve.support(angle),
            Curve::Spline(curve) => curve.support(angle),
            Curve::Arcs(curve) => curve.support(angle),
        }
    }

    fn reach(&self) -> f64 {
        match self {
            Curve::Harmonics(curve) => curve.reach(),
            Curve::Superellipse(curve) => curve.reach(),
            Curve::Spline(curve) => curve.reach(),
            Curve::Arcs(curve) => curve.reach(),
        }
    }

    fn integrals(&self) -> Result<Integrals, FormError> {
        match self {
            Curve::Spline(curve) => return curve.integrals(),
            Curve::Arcs(curve) => return curve.integrals(),
            Curve::Harmonics(_) | Curve::Superellipse(_) => (),
        }
        over_a_turn(|angle| {
            let (normal, [h, slope, second]) = (unit(angle), self.support(angle));
            let tangent = left_of(normal);
            rates(along(scaled(h, normal), slope, tangent), scaled(h + second, tangent))
        })
    }
}

/// A strictly convex body, smooth but for corners where its form has some. Its frame has the origin at the centre of mass and the axes of its form.
#[derive(Clone, Debug)]
pub struct Shape {
    curve: Curve,
    /// In the frame of the form.
    centre: Plane,
    integrals: Integrals,
}

impl Shape {
    /// The body of a form, with its centre of mass.
    ///
    /// # Errors
    /// Where a number is not one, the outline is not strictly convex (decided up to rounding, not sampled), or the
    /// centre of mass is not inside.
    pub fn new(form: &BodyForm, centre: CentreOfMass) -> Result<Self, FormError> {
        let curve = Curve::new(form)?;
        let integrals = curve.integrals()?;
        let centre = match centre {
            CentreOfMass::Uniform => scaled(1.0 / integrals.area, integrals.first),
            CentreOfMass::At(place) => place,
        };
        let [x, y] = centre;
        if let Some(value) = centre.into_iter().find(|value| !value.is_finite()) {
            return Err(FormError::NotFinite { what: "the centre of mass".into(), value });
        }
        let shape = Shape { curve, centre, integrals };
        // |h'| is at most the greatest distance of the outline from the centre
        let slope = shape.curve.reach() + x.hypot(y);
        positive_everywhere(|angle| shape.support(angle)[0], slope, 64.0 * f64::EPSILON * slope).map_err(
            |doubt| match doubt {
                Doubt::Negative { angle, value } => FormError::CentreOutside { x, y, angle, support: value },
                Doubt::Undecided { angle, value } => FormError::TooClose {
                    what: "the reach of the body from its centre of mass",
                    angle,
                    value,
                },
            },
        )?;
        Ok(shape)
    }

    /// The same, where the body has no corners.
    ///
    /// # Errors
    /// [`FormError::HasCorners`].
    pub fn without_corners(self) -> Result<Self, FormError> {
        match self.curve {
            Curve::Arcs(_) => Err(FormError::HasCorners),
            _ => Ok(self),
        }
    }

    /// The support function about the centre of mass and its first two derivatives, `[h, h', h'']` in metres, at the
    /// outward normal with this angle in the body's frame (radians): how far the body reaches in that direction.
    pub fn support(&self, angle: f64) -> [f64; 3] {
        let ([h, slope, second], normal) = (self.curve.support(angle), unit(angle));
        let (radial, tangential) = (dot(self.centre, normal), dot(self.centre, left_of(normal)));
        [h - radial, slope - tangential, second + radial]
    }

    /// The boundary point with the outward normal at this angle, in the body's frame: `h u + h' u'`.
    pub fn point(&self, angle: f64) -> [f64; 2] {
        let (normal, [h, slope, _]) = (unit(angle), self.support(angle));
        along(scaled(h, normal), slope, left_of(normal))
    }

    /// The radius of curvature `h + h''` there, in metres.
    pub fn radius_of_curvature(&self, angle: f64) -> f64 {
        let [h, _, second] = self.curve.support(angle);
        h + second
    }

    /// The greatest radius of curvature, in metres, over so many points that it is good to a thousandth and better.
    pub fn greatest_radius_of_curvature(&self) -> f64 {
        const DIRECTIONS: u32 = 8192;
        let at = |i: u32| self.radius_of_curvature(TAU * f64::from(i) / f64::from(DIRECTIONS));
        (0..DIRECTIONS).map(at).fold(0.0, f64::max)
    }

    /// Points of the outline in the body's frame, counterclockwise, at equal steps of the normal's angle.
    pub fn outline(&self, count: usize) -> Vec<[f64; 2]> {
        (0..count).map(|i| self.point(TAU * i as f64 / count as f64)).collect()
    }

    /// In square metres.
    pub fn area(&self) -> f64 {
        self.integrals.area
    }

    /// In metres.
    pub fn perimeter(&self) -> f64 {
        self.integrals.perimeter
    }

    /// The centroid in the frame of the form, in metres; with [`CentreOfMass::Uniform`] the centre of mass.
    pub fn centroid(&self) -> [f64; 2] {
        scaled(1.0 / self.integrals.area, self.integrals.first)
    }

    /// The centre of mass in the frame of the form, in metres: the origin of the body's frame.
    pub fn centre_of_mass(&self) -> [f64; 2] {
        self.centre
    }

    /// The radius of gyration about its centroid of the uniform body with this outline, in metres. A body whose
    /// centre of mass is elsewhere is not uniform and has another one.
    pub fn gyration(&self) -> f64 {
        let centroid = self.centroid();
        (self.integrals.second / self.integrals.area - dot(centroid, centroid)).sqrt()
    }

    /// How far area, perimeter, centroid and radius of gyration changed at the last refinement of their quadrature,
    /// relative to the power of the perimeter that has the same unit.
    pub fn quadrature_error(&self) -> f64 {
        self.integrals.change
    }
}
