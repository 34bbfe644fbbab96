//! The first guess of a scene that gives none.

use super::{FirstState, PalmMeasurements};
use crate::scene::{Scene, SceneError};
use crate::simulation::{TOUCH, deviation};
use palmistry_bodies::mechanics::Palm;
use palmistry_lang::System;
use palmistry_math::number::rational_to_f64;
use palmistry_observe::Signals;
use std::collections::BTreeMap;

/// The first state estimated from the measurements of a scene's first window.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Unguided {
    found: Option<FirstState>,
}

impl Unguided {
    /// From the measurements of a first window and the known constants.
    ///
    /// # Errors
    /// Where a measurement or a constant is missing that the laws of motion need, or nothing explains the measurements.
    pub fn of(
        scene: &Scene,
        system: &System,
        known: &BTreeMap<String, f64>,
        signals: &Signals,
    ) -> Result<Unguided, SceneError> {
        let rows = (scene.observer.window + 1).min(signals.times().len());
        let measurements = palm_measurements(scene, system, known, signals, rows).map_err(|name| {
            let help = "give it under `known`, hand over a column of that name, or give a first guess";
            refuse(scene, format!("without '{name}' no state is found without a first guess"), help)
        })?;
        let found = measurements.first_state().ok_or_else(|| {
            let help = "give a first guess, or a longer window";
            refuse(
                scene,
                "no body between the palms explains the measurements of the first window".to_owned(),
                help,
            )
        })?;
        Ok(Unguided { found: Some(found) })
    }

    /// The estimate of a state of the model.
    ///
    /// # Errors
    /// Where it is not among the estimated ones.
    pub fn value(&self, scene: &Scene, name: &str) -> Result<f64, SceneError> {
        let value = self.found.and_then(|found| match name {
            "r1" => Some(found.radii[0]),
            "r2" => Some(found.radii[1]),
            "omega0" => Some(found.rate),
            "rho" => Some(found.gyration),
            "v1" => Some(found.receding[0]),
            "v2" => Some(found.receding[1]),
            _ => None,
        });
        value.ok_or_else(|| {
            let help = "r1, r2, omega0, rho, v1 and v2 are found without one";
            refuse(scene, format!("there is no first guess of '{name}'"), help)
        })
    }
}

fn refuse(scene: &Scene, message: String, help: &str) -> SceneError {
    scene.error_at("observer.guess", message, "asked for here", help)
}

/// The first rows of a scene's measurements, with the known constants; or the name of a missing one.
pub(crate) fn palm_measurements(
    scene: &Scene,
    system: &System,
    known: &BTreeMap<String, f64>,
    signals: &Signals,
    rows: usize,
) -> Result<PalmMeasurements, &'static str> {
    let constant = |name: &str| {
        let default = || {
            let info = system.symbol_info(system.find_symbol(name)?)?;
            info.default.as_ref().map(rational_to_f64)
        };
        known.get(name).copied().or_else(default)
    };
    let column = |name: &'static str| match signals.find(name) {
        Some(place) => Ok(signals.column(place)[..rows].to_vec()),
        None => constant(name).map(|value| vec![value; rows]).ok_or(name),
    };
    let number = |name: &'static str| constant(name).ok_or(name);
    // palm 2 is measured from palm 1
    let world = |first: &'static str, second: &'static str| -> Result<[Vec<f64>; 2], &'static str> {
        let (first, second) = (column(first)?, column(second)?);
        let sum = first.iter().zip(&second).map(|(first, second)| first + second).collect();
        Ok([first, sum])
    };
    let sensor = &scene.sensor;
    // a recording's palms are those that the model knows
    let form = |form: Palm<f64>, name: &str| match (form, constant(name)) {
        (Palm::Flat, Some(radius)) if radius.is_finite() => Palm::Circular { radius },
        (form, _) => form,
    };
    let is_sought = |name: &str| scene.observer.estimate.iter().any(|other| other == name);
    Ok(PalmMeasurements {
        times: signals.times()[..rows].to_vec(),
        palms: [form(scene.palm_forms[0], "b1"), form(scene.palm_forms[1], "b2")],
        contacts: [column(TOUCH[0])?, column(TOUCH[1])?],
        angles: world("phi1", "phi2")?,
        rates: world("omega1", "omega2")?,
        accelerations: world("alpha1", "alpha2")?,
        torques: [column("tau1")?, column("tau2")?],
        inertia: [number("I1")?, number("I2")?],
        mass: number("m")?,
        gravity: number("g")?,
        gyration: if is_sought("rho") { None } else { Some(number("rho")?) },
        sigma: Some(deviation(sensor.noise, sensor.resolution)).filter(|sigma| *sigma > 0.0),
    })
}
