//! Which body of a library was measured: the search for the motion of each, and the residuals of its contacts.

mod search;

use super::super::recognised::{LibraryAnswer, Recognition};
use super::super::run::Experiment;
use super::super::scene::{Body, LibraryBody, SceneError};
use super::super::simulation::{deviation, outline};
use super::super::unguided::palm_measurements;
use super::record::WholeRecord;
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::mechanics::moving::Shape;
use palmistry_bodies::shape::Measured;
use palmistry_observe::{Noise, explains};
use search::Candidate;
use std::sync::atomic::{AtomicBool, Ordering};

impl Experiment {
    /// Which body of the scene's library was measured: none where the scene has no library, or it was interrupted.
    ///
    /// # Errors
    /// Where the shape of a body is invalid, or a measurement or a constant is missing, with the place in the scene.
    pub fn recognise(&self, interrupt: &AtomicBool) -> Result<Option<Recognition>, SceneError> {
        let library = &self.scene.observer.library;
        if library.is_empty() {
            return Ok(None);
        }
        let record = self.library_record()?;
        let shapes = library.iter().enumerate().map(|(index, body)| self.library_shape(index, body));
        let shapes = shapes.collect::<Result<Vec<Shape>, SceneError>>()?;
        let mut bodies = Vec::new();
        for (body, shape) in library.iter().zip(&shapes) {
            let gyration = body.radius_of_gyration.unwrap_or_else(|| shape.gyration());
            bodies.push(self.library_answer(
                &body.name,
                &Candidate { record: &record, shape, gyration },
                interrupt,
            ));
            if interrupt.load(Ordering::Relaxed) {
                return Ok(None);
            }
        }
        Ok(Some(Recognition::of(bodies)))
    }

    /// All measurements of both contacts and of the palms.
    fn library_record(&self) -> Result<WholeRecord, SceneError> {
        let place = |message: String, help: &str| {
            self.scene.error_at("observer.library", message, "these bodies", help)
        };
        let known = &self.question.known;
        let measurements =
            palm_measurements(&self.scene, &self.system, known, &self.signals, 1).map_err(|name| {
                let help = "give it under `known`, or hand over a column of that name";
                place(format!("without '{name}' no body is recognised"), help)
            })?;
        if measurements.palms.iter().any(|palm| *palm != Palm::Flat) {
            let message = "bodies are recognised between flat palms, and these are circular";
            return Err(place(message.to_owned(), "leave the library out"));
        }
        let sensor = &self.scene.sensor;
        WholeRecord::of(self, deviation(sensor.noise, sensor.resolution)).ok_or_else(|| {
            let message = format!("{} samples are too few to recognise a body", self.signals.times().len());
            place(message, "let there be 24 and more")
        })
    }

    fn library_shape(&self, index: usize, body: &LibraryBody) -> Result<Shape, SceneError> {
        let held = Body {
            shape: body.shape.clone(),
            mass: 1.0,
            radius_of_gyration: body.radius_of_gyration,
            centre_of_mass: body.centre_of_mass,
            orientation: 0.0,
            rate: 0.0,
            gravity: 0.0,
        };
        outline(&held).map(|(shape, _)| shape).map_err(|error| {
            let help = "a body has to be smooth and strictly convex, with its centre of mass inside";
            self.scene.error_at(
                &format!("observer.library[{index}].shape"),
                error.to_string(),
                "this body",
                help,
            )
        })
    }

    fn library_answer(&self, name: &str, candidate: &Candidate<'_>, interrupt: &AtomicBool) -> LibraryAnswer {
        let rows = candidate.record.times.len();
        let unknown = Measured { value: f64::NAN, deviation: f64::NAN };
        let lost = LibraryAnswer {
            name: name.to_owned(),
            orientation: unknown,
            rate: unknown,
            rms_residual: f64::NAN,
            fit: None,
        };
        let Some(end) = candidate.best(interrupt) else { return lost };
        let Some(differences) = candidate.differences(&end.first, rows) else { return lost };
        let sensor = &self.scene.sensor;
        let read = || candidate.record.contacts.iter().flatten();
        let size = (read().map(|s| s * s).sum::<f64>() / (2 * rows) as f64).sqrt();
        let noise = Noise::Stated { normal: sensor.noise, rounding: sensor.resolution };
        let fit = explains(&differences, 2, size, noise);
        let covariance = end.matrix.try_inverse();
        let measured = |place: usize, value: f64| {
            let deviation = covariance.map_or(f64::INFINITY, |all| all[(place, place)].max(0.0).sqrt());
            Measured { value, deviation }
        };
        LibraryAnswer {
            orientation: measured(0, end.first[0].rem_euclid(std::f64::consts::TAU)),
            rate: measured(1, end.first[1]),
            rms_residual: differences.norm() / ((2 * rows) as f64).sqrt(),
            fit: Some(fit),
            ..lost
        }
    }
}
