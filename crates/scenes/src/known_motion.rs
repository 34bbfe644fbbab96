//! What a simulated motion tells whoever holds answers against it, whether it is a body's or a system's.

use super::scene::{Channel, Sensor};
use super::simulation::Simulation;
use super::system_motion::SystemMotion;
use palmistry_observe::{Record, RecordError};
use std::collections::BTreeMap;

/// What was simulated, as far as studies ask: what is true, and what is read with errors of any size.
pub trait KnownMotion: Sync {
    /// The true values of a state, sample by sample.
    fn truth(&self, name: &str) -> Option<Vec<f64>>;

    /// What is read, with the errors of the outputs that have none of their own, and with those of single columns.
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
