//! A simulated motion, of a body or of a system, as studies use it: true values and measurements.

use super::scene::{Channel, Sensor};
use super::simulation::Simulation;
use super::system_motion::SystemMotion;
use palmistry_observe::{Record, RecordError};
use std::collections::BTreeMap;

/// A simulated motion as far as studies need it: true values, and measurements with errors of any size.
pub trait KnownMotion: Sync {
    /// The true values of a state, sample by sample.
    fn truth(&self, name: &str) -> Option<Vec<f64>>;

    /// The measurements, with the errors of the outputs that have none of their own, and with those of single columns.
    ///
    /// # Errors
    /// None that a simulation could bring about.
    fn read(
        &self,
        sensor: &Sensor,
        channels: &BTreeMap<String, Channel>,
        seed: u64,
    ) -> Result<Record, RecordError>;
}

impl KnownMotion for Simulation {
    fn truth(&self, name: &str) -> Option<Vec<f64>> {
        self.truth(name)
    }

    fn read(
        &self,
        sensor: &Sensor,
        channels: &BTreeMap<String, Channel>,
        seed: u64,
    ) -> Result<Record, RecordError> {
        self.read(sensor, channels, seed)
    }
}

impl KnownMotion for SystemMotion {
    fn truth(&self, name: &str) -> Option<Vec<f64>> {
        self.truth(name)
    }

    fn read(
        &self,
        sensor: &Sensor,
        channels: &BTreeMap<String, Channel>,
        seed: u64,
    ) -> Result<Record, RecordError> {
        self.read(sensor, channels, seed)
    }
}
