//! Vectors in the plane, in double precision.

/// A vector, metres where it is a place.
pub(super) type Plane = [f64; 2];

/// `a + factor * b`
pub(super) fn along(a: Plane, factor: f64, b: Plane) -> Plane {
    [a[0] + factor * b[0], a[1] + factor * b[1]]
}

/// `a - b`
pub(super) fn difference(a: Plane, b: Plane) -> Plane {
    along(a, -1.0, b)
}

/// `factor * a`
pub(super) fn scaled(factor: f64, a: Plane) -> Plane {
    [factor * a[0], factor * a[1]]
}

/// The scalar product.
pub(super) fn dot(a: Plane, b: Plane) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The cross product, a number: positive where `b` lies to the left of `a`.
pub(super) fn cross(a: Plane, b: Plane) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// A quarter turn counterclockwise.
pub(super) fn left_of(a: Plane) -> Plane {
    [-a[1], a[0]]
}

/// The unit vector at an angle.
pub(super) fn unit(angle: f64) -> Plane {
    let (sine, cosine) = angle.sin_cos();
    [cosine, sine]
}

/// The solution of `a · x = p`, `b · x = q` (Cramer); not finite where `a` and `b` are parallel.
pub(super) fn meet(a: Plane, p: f64, b: Plane, q: f64) -> Plane {
    let determinant = cross(a, b);
    [(p * b[1] - q * a[1]) / determinant, (a[0] * q - b[0] * p) / determinant]
}
