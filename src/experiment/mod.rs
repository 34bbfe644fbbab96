//! Experiments, simulated or recorded.
//!
//! A [`Scene`] says what is held, how it moves, what the sensors read and which observers are to find out what; it is read
//! from a TOML file and checked value by value. A [`Simulation`] moves its body; an [`Experiment`] is a scene with its readings, and
//! runs its observers, once ([`Experiment::run`]) or many times over ([`noise_study`], [`basins`]).
//!
//! Beside `verification` this is the place that knows both palms and observers.

mod run;
mod scene;
mod simulation;
mod study;

pub use run::{Answer, Experiment, NOMINAL, error};
pub use scene::{
    BasinStudy, Body, Data, Guess, Method, NoiseStudy, ObserverSettings, Palms, Scene, SceneError,
    SceneOutline, Sensor, Simulated, Study,
};
pub use simulation::{Simulation, TOUCH, deviation};
pub use study::{ARRIVED, Basin, NoiseLevel, basins, noise_study};
