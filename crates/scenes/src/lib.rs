//! Experiments, simulated or recorded.
//!
//! A [`Scene`] says what is held, how it moves, what the sensors measure and which observers are to estimate what; it is read
//! from a TOML file and checked value by value. A [`Simulation`] moves its body, a [`SystemMotion`] any other system by its own equations; an
//! [`Experiment`] is a scene with its measurements, and runs its observers, once ([`Experiment::run`]) or many times over ([`noise_study`],
//! [`basins`], [`curvature_map`], or stretch by stretch as [`Studies`]); a [`Reconstruction`] is the shape estimated from all of it.
//!
//! Beside `verification` this is the place that knows both palms and observers.

#![warn(missing_docs)]

mod advice;
mod channels;
mod choice;
mod columns;
mod counted;
mod groundwork;
#[doc(hidden)]
pub mod joint;
mod known_motion;
mod least;
mod mirrored;
mod modes;
mod motion_rank;
mod not_identifiable;
mod past_poles;
mod plan;
mod recognised;
mod reconstruction;
mod recovered;
mod run;
mod scene;
mod simulation;
mod since;
#[doc(hidden)]
pub mod slow;
#[doc(hidden)]
pub mod solid;
#[doc(hidden)]
pub mod space;
mod stepped;
mod stream;
mod study;
mod switch;
mod system_motion;
mod terrain;
#[doc(hidden)]
pub mod unguided;

#[doc(hidden)]
pub use advice::{Advice, AdviceLimits, AdviceQuestion, ExpectedBounds, TriedMotion, advise};
pub use choice::{ObserverChoice, Sufficient, TriedObserver};
pub use known_motion::KnownMotion;
pub use modes::{ModeEstimate, ModeWindow};
#[doc(hidden)]
pub use past_poles::EQUATIONS;
pub use plan::{PlanConstant, PlanRank, ScenePlan, SteadyStretch};
pub use recognised::{LibraryAnswer, Recognition, RecognitionVerdict};
#[doc(hidden)]
pub use reconstruction::{on_palm, shown, turned};
pub use recovered::{
    Apart, Contradiction, Reconstruction, TooWide, TouchInstant, TouchTrack, WholeMotion, WholeSample,
};
#[doc(hidden)]
pub use run::error;
pub use run::{Answer, Experiment, Measurements};
#[doc(hidden)]
pub use scene::{BasinStudy, CurvatureStudy, NoiseStudy, SceneOutline};
pub use scene::{
    Channel, Data, Guess, LibraryBody, Method, ModeSettings, ObserverSettings, Scene, SceneColumn,
    SceneError, Sensor, Switch,
};
#[doc(hidden)]
pub use simulation::NOMINAL;
pub use simulation::Simulation;
pub use stream::{StreamAnswer, StreamEnd, StreamPiece, StreamTally, WindowReport, observe_stream};
#[doc(hidden)]
pub use study::{
    ARRIVED, Basin, CurvatureMap, CurvatureRatio, NoiseLevel, Studied, StudiedMotion, Studies,
    StudyMergeError, StudyPart, WindowBound, basins, curvature_map, noise_study,
};
pub use system_motion::SystemMotion;
pub use terrain::{Closure, ClosureSetting, ComputedRank};
