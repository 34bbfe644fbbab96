//! Floor 6, beside the trade-offs: experiments, simulated or recorded. A [`Scene`] says what is held, how it moves,
//! what the sensors read and which observers are to find out; it is read from a TOML file.
//!
//! A scene holds what the file says, checked value by value. Whether a shape is convex, and whether a model has the
//! states that a scene names, is found out by those who know; [`Scene::error_at`] marks the place for them.

mod scene;

pub use scene::{
    BasinStudy, Body, Data, Drive, Guess, HighGain, Kalman, Method, NoiseStudy, ObserverSettings, Palms,
    PrescribedPalm, Scene, SceneError, Sensor, Shape, Simulated, Study, Swing, TorquedPalm, WhenBlind,
};
