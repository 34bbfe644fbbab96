//! The measurements of three palms, with the errors of their sensors: angles of the palms, places of the contacts, torques.

use crate::simulation::normal;
use crate::solid::{PalmMeasurement, PalmSurface, SolidMeasurements};
use nalgebra::{Matrix3, Vector3};
use palmistry_bodies::mechanics::spatial::{SpatialMoment, SpatialPalm};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The errors of sensors: standard deviations and a rounding step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpaceSensor {
    /// Of a coordinate of a contact, in m.
    pub noise: f64,
    /// The step to which contacts are rounded, in m; zero where they are not.
    pub resolution: f64,
    /// Of a torque, in N m.
    pub torque_noise: f64,
}

/// One palm at one sample. SI units, angles in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PalmAtSample {
    /// The angle from the horizontal, its rate and its acceleration.
    pub angle: f64,
    pub rate: f64,
    pub acceleration: f64,
    /// The contact: along the hinge and up the palm, from the hinge's point.
    pub place: [f64; 2],
    /// The motor's torque about the hinge.
    pub torque: f64,
}

/// The measurements, sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpaceMeasurements {
    /// The times, increasing.
    pub times: Vec<f64>,
    pub palms: Vec<[PalmAtSample; 3]>,
}

impl SpaceMeasurements {
    /// The measurements of a motion: contacts and torques with normal errors, contacts rounded; the palms' motion without error.
    pub fn of(moments: &[SpatialMoment], sensor: &SpaceSensor, seed: u64) -> SpaceMeasurements {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let rounded = |place: f64| match sensor.resolution {
            step if step > 0.0 => (place / step).round() * step,
            _ => place,
        };
        let mut told = |moment: &SpatialMoment| {
            moment.palms.map(|palm| {
                let place = palm.sensed.map(|place| rounded(place + sensor.noise * normal(&mut random)));
                let torque = match sensor.torque_noise {
                    noise if noise > 0.0 => palm.torque + noise * normal(&mut random),
                    _ => palm.torque,
                };
                let (angle, rate, acceleration) = (palm.angle, palm.rate, palm.acceleration);
                PalmAtSample { angle, rate, acceleration, place, torque }
            })
        };
        SpaceMeasurements {
            times: moments.iter().map(|moment| moment.time).collect(),
            palms: moments.iter().map(&mut told).collect(),
        }
    }

    /// The same with the places and inertias of the palms, for the estimator.
    pub fn solid(
        &self,
        palms: &[SpatialPalm; 3],
        gravity: [f64; 3],
        sensor: &SpaceSensor,
    ) -> SolidMeasurements {
        let read = |palm: &SpatialPalm, told: &PalmAtSample| {
            let ((sa, ca), (s, c)) = (palm.azimuth.sin_cos(), told.angle.sin_cos());
            let axis = Vector3::new(sa, -ca, 0.0);
            let up = Vector3::new(c * ca, c * sa, s);
            PalmMeasurement {
                place: told.place,
                frame: Matrix3::from_columns(&[axis, up, axis.cross(&up)]),
                rate: told.rate,
                torque: told.torque - palm.inertia * told.acceleration,
            }
        };
        SolidMeasurements {
            times: self.times.clone(),
            palms: self.palms.iter().map(|told| std::array::from_fn(|i| read(&palms[i], &told[i]))).collect(),
            hinges: palms.map(|palm| Vector3::from(palm.hinge)),
            surfaces: palms.map(|palm| surface(&palm)),
            gravity: Vector3::from(gravity),
            contact_deviation: crate::simulation::deviation(sensor.noise, sensor.resolution),
            torque_deviation: sensor.torque_noise,
        }
    }
}

/// A palm's surface in the estimator's form.
pub(super) fn surface(palm: &SpatialPalm) -> PalmSurface {
    PalmSurface { curvature: palm.curvature, touch: palm.touch }
}
