//! The support function of a body with corners: a polygon whose sides are arcs of circles that bulge.
//!
//! While a corner touches a palm the outward normal turns and the contact stays where it is in the body: there `h` is that of a point, and `h + h'' = 0`. At both ends of an arc `h` and
//! `h'` are continuous and the radius of curvature is not.

use super::form::{FormError, length};
use super::plane::{Plane, along, difference, dot, left_of, scaled, unit};
use super::quadrature::{Integrals, over_pieces, rates};
use std::f64::consts::TAU;

/// A side of the body, or a corner, which is an arc without a radius.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// The angle of the outward normal where it begins, counted on from the first piece's.
    from: f64,
    centre: Plane,
    radius: f64,
}

/// Corners and the arcs between them, counterclockwise.
#[derive(Clone, Debug)]
pub(super) struct Arcs {
    /// By the angles at which they begin.
    pieces: Vec<Piece>,
}

impl Arcs {
    /// Of corners in their order, counterclockwise, joined by arcs of one radius.
    pub(super) fn new(corners: &[Plane], radius: f64) -> Result<Self, FormError> {
        length("the radius of the sides", radius)?;
        if let Some(value) = corners.iter().flatten().copied().find(|value| !value.is_finite()) {
            return Err(FormError::NotFinite { what: "a corner".into(), value });
        }
        if corners.len() < 2 {
            return Err(FormError::FewCorners(corners.len()));
        }
        let mut pieces: Vec<Piece> = Vec::new();
        let mut ended: Option<f64> = None;
        for (k, corner) in corners.iter().enumerate() {
            let chord = difference(corners[(k + 1) % corners.len()], *corner);
            let half = chord[0].hypot(chord[1]) / 2.0;
            if half == 0.0 || half >= radius {
                return Err(FormError::Side { side: k + 1, chord: 2.0 * half, radius });
            }
            let outward = scaled(-0.5 / half, left_of(chord));
            let (middle, spread) = (outward[1].atan2(outward[0]), (half / radius).asin());
            let away = (radius * radius - half * half).sqrt();
            let centre = along(along(*corner, 0.5, chord), -away, outward);
            // the corner turns the normal on, by less than half a turn, from the side before
            let from = match ended {
                None => middle - spread,
                Some(ended) => {
                    let corner_turns = turned(middle - spread - ended);
                    if corner_turns < 0.0 {
                        return Err(FormError::Bulges { corner: k + 1 });
                    }
                    pieces.push(Piece { from: ended, centre: *corner, radius: 0.0 });
                    ended + corner_turns
                }
            };
            pieces.push(Piece { from, centre, radius });
            ended = Some(from + 2.0 * spread);
        }
        let (first, ended) = (pieces[0].from, ended.unwrap_or(0.0));
        let corner_turns = turned(first - ended);
        if corner_turns < 0.0 {
            return Err(FormError::Bulges { corner: 1 });
        }
        pieces.push(Piece { from: ended, centre: corners[0], radius: 0.0 });
        let turns = (ended + corner_turns - first) / TAU;
        if (turns - 1.0).abs() > 0.5 {
            return Err(FormError::CornersTurn(turns));
        }
        Ok(Arcs { pieces })
    }

    fn piece(&self, angle: f64) -> &Piece {
        let first = self.pieces[0].from;
        let on = first + (angle - first).rem_euclid(TAU);
        let place = self.pieces.partition_point(|piece| piece.from <= on);
        &self.pieces[place.saturating_sub(1)]
    }

    /// `h`, `h'` and `h''`.
    pub(super) fn support(&self, angle: f64) -> [f64; 3] {
        let (normal, Piece { centre, radius, .. }) = (unit(angle), self.piece(angle));
        let core = dot(*centre, normal);
        [core + radius, dot(*centre, left_of(normal)), -core]
    }

    /// No point of the outline is farther from the origin: an arc is less than half of its circle, whose centre is on the corners' side of it.
    pub(super) fn reach(&self) -> f64 {
        self.pieces
            .iter()
            .map(|piece| piece.centre[0].hypot(piece.centre[1]) + piece.radius)
            .fold(0.0, f64::max)
    }

    /// Corners enclose nothing by themselves.
    pub(super) fn integrals(&self) -> Result<Integrals, FormError> {
        let ends = self.pieces.iter().skip(1).map(|piece| piece.from);
        let arcs: Vec<(Piece, f64)> =
            self.pieces.iter().copied().zip(ends).filter(|(piece, _)| piece.radius > 0.0).collect();
        over_pieces(arcs.len(), |place, t| {
            let (Piece { from, centre, radius }, to) = arcs[place];
            let normal = unit(from + t * (to - from));
            rates(along(centre, radius, normal), scaled(radius * (to - from), left_of(normal)))
        })
    }
}

/// An angle from minus half a turn to half a turn.
fn turned(angle: f64) -> f64 {
    let half = TAU / 2.0;
    (angle + half).rem_euclid(TAU) - half
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_3, PI};

    fn triangle() -> Vec<Plane> {
        [0.0, 2.0, 4.0].map(|k: f64| scaled(1.0 / 3f64.sqrt(), unit(k * FRAC_PI_3))).to_vec()
    }

    /// Reuleaux's triangle of side 1: all widths are 1, the perimeter is pi (Barbier), the area (pi - sqrt 3)/2.
    #[test]
    fn reuleaux() {
        let body = Arcs::new(&triangle(), 1.0).unwrap();
        for i in 0..360 {
            let angle = TAU * f64::from(i) / 360.0 + 0.01;
            assert!((body.support(angle)[0] + body.support(angle + PI)[0] - 1.0).abs() < 1e-14);
            let [h, slope, second] = body.support(angle);
            let [before, after] = [-1e-5, 1e-5].map(|step| body.support(angle + step));
            assert!((slope - (after[0] - before[0]) / 2e-5).abs() < 1e-9);
            assert!([0.0, 1.0].iter().any(|radius| (h + second - radius).abs() < 1e-14), "{angle}");
        }
        let Integrals { perimeter, area, first, .. } = body.integrals().unwrap();
        assert!((perimeter - PI).abs() < 1e-12 && (area - (PI - 3f64.sqrt()) / 2.0).abs() < 1e-12);
        assert!(first.iter().all(|moment| moment.abs() < 1e-12));
    }

    /// The support function is the greatest projection over corners and points of arcs, wherever the corners lie.
    #[test]
    fn it_is_the_greatest_projection() {
        let corners = [[-0.7, -0.4], [0.9, -0.5], [0.8, 0.4], [-0.2, 0.9]];
        let radius = 2.0;
        let body = Arcs::new(&corners, radius).unwrap();
        let mut points: Vec<Plane> = corners.to_vec();
        for k in 0..4 {
            let (p, q) = (corners[k], corners[(k + 1) % 4]);
            let chord = difference(q, p);
            let half = chord[0].hypot(chord[1]) / 2.0;
            // the sagitta over the chord at each part of it
            for i in 1..2000 {
                let x = half * (f64::from(i) / 1000.0 - 1.0);
                let rise = (radius * radius - x * x).sqrt() - (radius * radius - half * half).sqrt();
                let on = along(p, 0.5 + x / (2.0 * half), chord);
                points.push(along(on, -rise / (2.0 * half), left_of(chord)));
            }
        }
        for i in 0..720 {
            let angle = TAU * f64::from(i) / 720.0;
            let most = points.iter().map(|point| dot(*point, unit(angle))).fold(f64::NEG_INFINITY, f64::max);
            let short = body.support(angle)[0] - most;
            assert!((-1e-14..1e-6).contains(&short), "{angle} {short}");
        }
    }

    #[test]
    fn what_is_no_body_is_refused() {
        let side = Arcs::new(&triangle(), 0.5);
        assert!(matches!(side, Err(FormError::Side { side: 1, .. })), "{side:?}");
        let mut clockwise = triangle();
        clockwise.reverse();
        assert!(Arcs::new(&clockwise, 1.0).is_err());
        assert!(matches!(Arcs::new(&triangle()[..1], 1.0), Err(FormError::FewCorners(1))));
        // the sides of a flat corner bulge over it
        let flat = [[0.0, 0.0], [1.0, -0.05], [2.0, 0.0], [1.0, 1.0]];
        assert!(matches!(Arcs::new(&flat, 1.2), Err(FormError::Bulges { corner: 2 })));
        let star: Vec<Plane> = (0..5).map(|k| unit(2.0 * TAU * f64::from(k) / 5.0)).collect();
        assert!(matches!(Arcs::new(&star, 30.0), Err(FormError::CornersTurn(_))));
    }
}
