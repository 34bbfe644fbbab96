//! A robot that draws the ground it rolls over (section 6.2): the measurements of its gauges, and the closure, that wheel 2 rolls where wheel 1 has been.

mod closure;
mod closure_rank;

pub use closure::{Closure, ClosureSetting};
pub use closure_rank::ComputedRank;

use super::scene::{Scene, SceneError, SimulatedRobot};
use super::simulation::FIRST_SAMPLES;
use super::system_motion::SystemMotion;
use palmistry_bodies::mechanics::terrain::{Ground, GroundWave, Robot, RobotDrive, RobotEnd, RobotMoment};
use palmistry_observe::{Lost, Response};
use std::collections::BTreeMap;

/// The robot and its ground in the form of the mechanics crate.
fn bodies(simulated: &SimulatedRobot) -> (Robot, Ground) {
    let robot = &simulated.robot;
    let waves = simulated.ground.waves.iter().map(|wave| GroundWave {
        amplitude: wave.amplitude,
        wavelength: wave.wavelength,
        phase: wave.phase,
    });
    let ground = Ground { waves: waves.collect() };
    let robot = Robot {
        wheels: robot.wheels,
        mass: robot.mass,
        gyration: robot.radius_of_gyration,
        gravity: robot.gravity,
    };
    (robot, ground)
}

/// The drive of a scene's robot at some times.
fn drive(simulated: &SimulatedRobot, times: &[f64]) -> RobotDrive {
    let (robot, ground) = bodies(simulated);
    robot.drive(&ground, simulated.robot.speed, simulated.robot.start, times)
}

/// A vector of the world in the robot's frame.
fn turned_back(moment: &RobotMoment, [x, y]: [f64; 2]) -> [f64; 2] {
    let (sine, cosine) = moment.phi0.sin_cos();
    [cosine * x + sine * y, cosine * y - sine * x]
}

/// The states of a motion by the models' names: those of the proof files of section 6.2.
fn states(moment: &RobotMoment) -> [(&'static str, f64); 13] {
    let [ux, uy] = turned_back(moment, moment.velocity);
    [
        ("ux", ux),
        ("uy", uy),
        ("omega", moment.omega),
        ("phi0", moment.phi0),
        ("x", moment.places[0][0]),
        ("y", moment.places[0][1]),
        ("x2", moment.places[1][0]),
        ("y2", moment.places[1][1]),
        ("phi1", moment.inclinations[0]),
        ("phi2", moment.inclinations[1]),
        ("v1", moment.speeds[0]),
        ("v2", moment.speeds[1]),
        ("alpha", moment.alpha),
    ]
}

/// The measurements of the gauges: the directions of the forces against the robot, how fast these turn, and the forces.
fn read(moment: &RobotMoment) -> [(&'static str, f64); 7] {
    [
        ("beta1", moment.inclinations[0] - moment.phi0),
        ("beta2", moment.inclinations[1] - moment.phi0),
        ("rate1", moment.turning[0] - moment.omega),
        ("rate2", moment.turning[1] - moment.omega),
        ("f0", moment.forces[0]),
        ("f1", moment.forces[1]),
        ("f2", moment.forces[2]),
    ]
}

fn columns<const N: usize>(
    moments: &[RobotMoment],
    of: fn(&RobotMoment) -> [(&'static str, f64); N],
) -> Vec<(String, Vec<f64>)> {
    let names = moments.first().map(|first| of(first).map(|(name, _)| name.to_owned()));
    let column =
        |(place, name): (usize, String)| (name, moments.iter().map(|moment| of(moment)[place].1).collect());
    names.into_iter().flatten().enumerate().map(column).collect()
}

impl SystemMotion {
    /// The drive of the robot of a scene: all of it, or its start.
    ///
    /// # Errors
    /// Where the robot does not get through two samples, with the place in the scene.
    pub(super) fn of_robot(
        scene: &Scene,
        simulated: &SimulatedRobot,
        all: bool,
    ) -> Result<SystemMotion, SceneError> {
        let mut times = simulated.times(scene.sensor.jitter, scene.seed);
        times.truncate(if all { usize::MAX } else { FIRST_SAMPLES });
        let RobotDrive { moments, end } = drive(simulated, &times);
        let ended = match end {
            RobotEnd::Completed => None,
            RobotEnd::Lifts { time, wheel } => {
                Some(Lost { time, why: format!("wheel {} would have to be pulled to the ground", wheel + 1) })
            }
            RobotEnd::NoGround { time } => {
                Some(Lost { time, why: "wheel 2 finds no ground beside wheel 1".to_owned() })
            }
        };
        if let (true, Some(lost)) = (moments.len() < 2, &ended) {
            let help = "let it be slower, the ground flatter, or the wheels farther apart";
            return Err(scene.error_at("robot", format!("there is no motion: {lost}"), "this robot", help));
        }
        let robot = &simulated.robot;
        let [[l1, h1], [l2, h2]] = robot.wheels;
        let rho = robot.radius_of_gyration;
        let constants = [
            ("m", robot.mass),
            ("one_over_m", 1.0 / robot.mass),
            ("rho", rho),
            ("rho2", rho * rho),
            ("g", robot.gravity),
            ("l1", l1),
            ("h1", h1),
            ("l2", l2),
            ("h2", h2),
        ];
        let constants: BTreeMap<String, f64> =
            constants.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        let response = Response {
            times: moments.iter().map(|moment| moment.time).collect(),
            states: columns(&moments, states),
            outputs: Vec::new(),
            inputs: columns(&moments, read),
            constants,
            ended,
        };
        Ok(SystemMotion { response })
    }
}
