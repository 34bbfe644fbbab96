//! The surface of a palm: a plane, or a sphere that is fixed to it and touches it, with the meaning of a contact's two coordinates.

use super::vector::{Vector, along, cross, dot, scaled};
use super::{PalmMeasurement, SolidMeasurements};
use nalgebra::Vector3;

/// A sphere of the curvature `k` that touches the plane where `d` is zero: `z = -k d^2/(1 + r)`, with the normal `(k d1, k d2, r)`, `r = sqrt(1 - k^2 d^2)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PalmSurface {
    /// In 1/m: 0 for a plane, above it where the palm bulges towards the body, below it where it is hollow.
    pub curvature: f64,
    /// Where the sphere touches the plane: along the hinge and up the palm, in m.
    pub touch: [f64; 2],
}

impl PalmSurface {
    fn is_flat(&self) -> bool {
        self.curvature == 0.0
    }

    fn root(&self, place: [f64; 2]) -> (f64, f64, f64) {
        let [a, b] = [0, 1].map(|i: usize| self.curvature * (place[i] - self.touch[i]));
        (a, b, (1.0 - a * a - b * b).sqrt())
    }

    /// Whether a place has a point of the half of the sphere that these coordinates describe.
    pub fn has(&self, place: [f64; 2]) -> bool {
        self.is_flat() || self.root(place).2 > 0.0
    }

    /// How far the surface is above the plane.
    fn height(&self, place: [f64; 2]) -> f64 {
        if self.is_flat() {
            return 0.0;
        }
        let (a, b, root) = self.root(place);
        -(a * a + b * b) / self.curvature / (1.0 + root)
    }

    /// The normal: along the hinge, up the palm, along the plane's own.
    fn normal(&self, place: [f64; 2]) -> [f64; 3] {
        if self.is_flat() {
            return [0.0, 0.0, 1.0];
        }
        let (a, b, root) = self.root(place);
        [a, b, root]
    }

    /// The moment of a force of one along the normal about the hinge.
    pub fn lever(&self, place: [f64; 2]) -> f64 {
        if self.is_flat() {
            return place[1];
        }
        let [_, up, out] = self.normal(place);
        place[1] * out - self.height(place) * up
    }
}

impl SolidMeasurements {
    /// Where palm `i` is touched, in the world.
    pub(super) fn contact(&self, palms: &[PalmMeasurement; 3], i: usize) -> Vector3<f64> {
        let place = palms[i].place;
        let [p, q] = place;
        self.hinges[i] + palms[i].frame * Vector3::new(p, q, self.surfaces[i].height(place))
    }

    /// The palm's normal there.
    pub(super) fn normal(&self, palms: &[PalmMeasurement; 3], i: usize) -> Vector3<f64> {
        if self.surfaces[i].is_flat() {
            return palms[i].frame.column(2).into_owned();
        }
        palms[i].frame * Vector3::from(self.surfaces[i].normal(palms[i].place))
    }

    /// The lever there about the hinge.
    pub(super) fn lever(&self, palms: &[PalmMeasurement; 3], i: usize) -> f64 {
        self.surfaces[i].lever(palms[i].place)
    }
}

/// One palm at one sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct PalmSample {
    pub normal: Vector,
    /// The contact in the world.
    pub contact: Vector,
    pub rate: f64,
    pub force: f64,
    /// That of the force about the hinge.
    pub lever: f64,
    curvature: f64,
    /// The derivatives of the contact by each of its coordinates. Those of the normal are these times the curvature.
    tangents: [Vector; 2],
    /// The derivatives of the lever.
    levers: [f64; 2],
}

impl PalmSample {
    pub fn of(measurements: &SolidMeasurements, row: usize, i: usize) -> PalmSample {
        let (palm, surface) = (&measurements.palms[row][i], &measurements.surfaces[i]);
        let [axis, up, plane] =
            [0, 1, 2].map(|k: usize| -> Vector { palm.frame.column(k).into_owned().into() });
        let place = palm.place;
        let hinge: Vector = measurements.hinges[i].into();
        let on_plane = along(&along(&hinge, place[0], &axis), place[1], &up);
        let lever = surface.lever(place);
        let (rate, force) = (palm.rate, palm.torque / lever);
        if surface.is_flat() {
            let (tangents, levers) = ([axis, up], [0.0, 1.0]);
            return PalmSample {
                normal: plane,
                contact: on_plane,
                rate,
                force,
                lever,
                curvature: 0.0,
                tangents,
                levers,
            };
        }
        let curvature = surface.curvature;
        let [a, b, root] = surface.normal(place);
        let normal = along(&along(&scaled(root, &plane), a, &axis), b, &up);
        let contact = along(&on_plane, surface.height(place), &plane);
        let tangents = [along(&axis, -a / root, &plane), along(&up, -b / root, &plane)];
        let from_hinge = along(&contact, -1.0, &hinge);
        let levers = tangents.map(|tangent| {
            let moved = cross(&tangent, &normal);
            dot(&axis, &along(&moved, curvature, &cross(&from_hinge, &tangent)))
        });
        PalmSample { normal, contact, rate, force, lever, curvature, tangents, levers }
    }

    /// The derivatives of the constraint by the contact's two coordinates, where the body turns at a rate and has a velocity there.
    pub fn slopes(&self, omega: &Vector, velocity: &Vector) -> [f64; 2] {
        let [axis, up] = &self.tangents;
        if self.curvature == 0.0 {
            return [-dot(omega, up), dot(omega, axis) - self.rate];
        }
        [0, 1].map(|k: usize| {
            let tangent = &self.tangents[k];
            self.curvature * dot(tangent, velocity) + dot(&self.normal, &cross(omega, tangent))
                - self.rate * self.levers[k]
        })
    }

    /// The derivatives of the force and its moment about the origin by the contact's two coordinates, and by the torque.
    pub fn wrenches(&self) -> [(Vector, Vector); 3] {
        let lever = cross(&self.contact, &self.normal);
        let by_torque = (scaled(1.0 / self.lever, &self.normal), scaled(1.0 / self.lever, &lever));
        let fall = -self.force / self.lever;
        let [axis, up] = &self.tangents;
        if self.curvature == 0.0 {
            let along_hinge = ([0.0; 3], scaled(-self.force, up));
            let up = (scaled(fall, &self.normal), along(&scaled(fall, &lever), self.force, axis));
            return [along_hinge, up, by_torque];
        }
        let [first, second] = [0, 1].map(|k: usize| {
            let (tangent, fall) = (&self.tangents[k], fall * self.levers[k]);
            let bent = self.curvature * self.force;
            let force = along(&scaled(fall, &self.normal), bent, tangent);
            let moment = along(&scaled(fall, &lever), self.force, &cross(tangent, &self.normal));
            (force, along(&moment, bent, &cross(&self.contact, tangent)))
        });
        [first, second, by_torque]
    }
}
