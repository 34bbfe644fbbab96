//! The library of known bodies for recognition.

use super::super::robot::SimulatedRobot;
use super::super::simulated::LibraryBody;
use super::super::{Channel, Sensor};
use super::{Checks, Problem};
use std::collections::BTreeMap;

/// Bodies of a library at most.
const MOST_BODIES: usize = 1000;

impl Checks<'_> {
    pub(super) fn library(
        &self,
        bodies: &[LibraryBody],
        sensor: &Sensor,
        channels: &BTreeMap<String, Channel>,
        robot: Option<&SimulatedRobot>,
    ) -> Result<(), Problem> {
        if bodies.is_empty() {
            return Ok(());
        }
        let library = "observer.library";
        if bodies.len() > MOST_BODIES {
            let message = format!("{} bodies are too many", bodies.len());
            return Err(self.wrong(library, message, format!("give at most {MOST_BODIES}")));
        }
        if robot.is_some() {
            let help = "leave the library out";
            return Err(self.wrong(library, "a robot drives, and no body is touched", help));
        }
        if sensor.noise == 0.0 && sensor.resolution == 0.0 {
            let message =
                "a body is recognised by what the errors of the measurements explain, and none are stated";
            return Err(self.wrong(library, message, "add noise or resolution under [sensor], in m"));
        }
        if let Some(name) = channels.keys().next() {
            let help = "state one noise and one resolution of both contacts under [sensor]; all else is taken as it is read";
            let message = format!("a library does not heed the errors of single columns, as of '{name}'");
            return Err(self.wrong_key(&format!("sensor.{name}"), message, help));
        }
        let names: Vec<&String> = bodies.iter().map(|body| &body.name).collect();
        self.names(library, &names, |name| format!("'{name}'"))?;
        for (index, body) in bodies.iter().enumerate() {
            let place = |key: &str| format!("{library}[{index}].{key}");
            if body.name.trim().is_empty() {
                return Err(self.wrong(&place("name"), "a name is empty", "name the body"));
            }
            self.shape(&place("shape"), &body.shape)?;
            if let Some(radius) = body.radius_of_gyration {
                self.positive(&place("radius_of_gyration"), radius, "m")?;
            }
            self.all_finite(&place("centre_of_mass"), body.centre_of_mass.iter().flatten())?;
        }
        Ok(())
    }
}
