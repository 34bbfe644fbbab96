//! A scene in space carried through time.

use super::integrate::{TimedState, steps};
use super::orientation::Orientation;
use super::scene::{SpatialPalm, SpatialScene, SpatialSceneError};
use nalgebra::Vector3;
use palmistry_io::foreign::{Allowance, Budget};

/// One palm at one moment. SI units, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialPalmMoment {
    /// The angle from the horizontal.
    pub angle: f64,
    pub rate: f64,
    pub acceleration: f64,
    /// Where the contact is on the palm: along the hinge and up the palm, from the hinge's point. What the sensor measures.
    pub sensed: [f64; 2],
    /// The palm's normal at the contact in the world, towards the body.
    pub normal: Vector3<f64>,
    /// The contact in the world.
    pub contact: Vector3<f64>,
    /// The contact in the body's frame, from the centre of mass.
    pub touched: Vector3<f64>,
    /// The body's outward normal there, in its frame.
    pub outward: Vector3<f64>,
    /// The contact force, positive where the palm pushes.
    pub force: f64,
    /// The motor's torque about the hinge.
    pub torque: f64,
}

/// Body and palms at one moment, in the world. SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct SpatialMoment {
    pub time: f64,
    pub orientation: Orientation,
    /// Angular velocity and its rate.
    pub rate: Vector3<f64>,
    pub turning: Vector3<f64>,
    /// The centre of mass, its velocity and its acceleration.
    pub centre: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub acceleration: Vector3<f64>,
    pub palms: [SpatialPalmMoment; 3],
    /// The kinetic energy of body and palms.
    pub kinetic: f64,
    /// The potential energy of the body, zero at the origin.
    pub potential: f64,
    /// The work that the motors have done since time zero.
    pub work: f64,
}

impl SpatialMoment {
    fn of(scene: &SpatialScene, state: &TimedState) -> SpatialMoment {
        let at = state.situation(scene);
        let back = state.orientation.matrix().transpose();
        let palm = |i: usize| {
            let normal = at.normals[i];
            SpatialPalmMoment {
                angle: at.angles[i],
                rate: at.rates[i],
                acceleration: at.accelerations[i],
                sensed: at.sensed[i],
                normal,
                contact: at.centre + at.arms[i],
                touched: back * at.arms[i],
                outward: -(back * normal),
                force: at.forces[i],
                torque: at.torques[i],
            }
        };
        let palms: f64 = (0..3).map(|i| scene.palms[i].inertia * at.rates[i] * at.rates[i]).sum();
        SpatialMoment {
            time: state.time,
            orientation: state.orientation,
            rate: state.rate,
            turning: at.turning,
            centre: at.centre,
            velocity: at.velocity,
            acceleration: at.acceleration,
            palms: [palm(0), palm(1), palm(2)],
            kinetic: (scene.mass * at.velocity.norm_squared() + state.rate.dot(&at.spin) + palms) / 2.0,
            potential: -scene.mass * at.centre.dot(&Vector3::from(scene.gravity)),
            work: state.work,
        }
    }

    /// Kinetic and potential energy.
    pub fn energy(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// How a motion in space ended. Palms are 1, 2 and 3; the time is the last at which all contacts held.
#[derive(Clone, Debug, PartialEq)]
pub enum SpatialEnded {
    /// At the last sample.
    Completed,
    /// A palm would have had to pull.
    ContactLost { palm: usize, time: f64 },
    /// The palms' normals came to lie in one plane.
    Flat { time: f64 },
    /// There was no place any more where the body touches all palms, each on the half of its sphere that faces the plane's normal.
    NoContact { time: f64 },
    /// The integrator gave up, for instance because the tolerance cannot be met.
    Failed { time: f64, why: String },
}

/// A motion in space.
#[derive(Clone, Debug, PartialEq)]
pub struct SpatialTrajectory {
    /// One a sample time that was reached and, where the motion ended between two of them, one at its end.
    pub moments: Vec<SpatialMoment>,
    pub ended: SpatialEnded,
    /// Kinetic and potential energy at time zero, in joules.
    pub start_energy: f64,
}

impl SpatialTrajectory {
    /// The greatest difference, over all moments, between the energy gained since time zero and the work of the motors, in joules:
    /// zero but for errors of the integration.
    pub fn energy_drift(&self) -> f64 {
        let drift = |moment: &SpatialMoment| (moment.energy() - self.start_energy - moment.work).abs();
        self.moments.iter().map(drift).fold(0.0, f64::max)
    }
}

/// What a motion may cost: steps of the integrator.
const ALLOWANCE: Allowance = Allowance { bytes: u64::MAX, nodes: u64::MAX, steps: 50_000 };

/// The end of a contact is located to so many seconds.
const LOCATED: f64 = 1e-12;

/// Moves the scene from time zero and reports its moments at the sample times, which increase.
///
/// The motion ends before the last of them where a contact does; see [`SpatialEnded`].
///
/// # Errors
/// Where a value of the scene or a time cannot be used, or a palm would have to pull at the start.
pub fn simulate_solid(scene: &SpatialScene, times: &[f64]) -> Result<SpatialTrajectory, SpatialSceneError> {
    let last = times.last().ok_or(SpatialSceneError::NoTimes)?;
    let mut before = -f64::MIN_POSITIVE;
    for (index, &time) in (1..).zip(times) {
        if !(time > before && time.is_finite()) {
            return Err(SpatialSceneError::Time { index, time });
        }
        before = time;
    }
    scene.check()?;

    let mut now = TimedState {
        time: 0.0,
        orientation: scene.orientation,
        rate: Vector3::from(scene.rate),
        pushed: scene.start_of_palms(),
        work: 0.0,
        near: None,
    };
    let budget = Budget::new(ALLOWANCE);
    let mut moments = Vec::with_capacity(times.len());
    let start_energy = SpatialMoment::of(scene, &now).energy();
    for &time in times {
        if time > now.time {
            match advance(scene, now, time, scene.longest_step(*last), &budget) {
                Ok(held) => now = TimedState { time, ..held },
                Err(end) => {
                    let (at, ended) = *end;
                    // an end at once after a sample is that sample
                    let fresh = at.filter(|at| at.time > now.time);
                    moments.extend(fresh.map(|at| SpatialMoment::of(scene, &at)));
                    return Ok(SpatialTrajectory { moments, ended, start_energy });
                }
            }
        }
        moments.push(SpatialMoment::of(scene, &now));
    }
    Ok(SpatialTrajectory { moments, ended: SpatialEnded::Completed, start_energy })
}

/// What ends a contact.
#[derive(Clone, Copy)]
enum Breach {
    Flat,
    NoContact,
    Pulls(usize),
}

fn breach(at: &TimedState, scene: &SpatialScene) -> Option<Breach> {
    let situation = at.situation(scene);
    if situation.touched.is_none() {
        Some(Breach::NoContact)
    } else if situation.is_flat() {
        Some(Breach::Flat)
    } else {
        situation.pulling().map(Breach::Pulls)
    }
}

/// A contact this part of a radius from the axis of its sphere is about to leave the half that it may be on.
const AT_RIM: f64 = 0.999_8;

fn is_at_rim(at: &TimedState, scene: &SpatialScene) -> bool {
    let places = at.situation(scene).touched.unwrap_or_default();
    let out = |(palm, [along, up]): (&SpatialPalm, [f64; 2])| palm.curvature.abs() * along.hypot(up);
    scene.palms.iter().zip(places).any(|pair| out(pair) > AT_RIM)
}

/// The state at time `end`; or an end before it, with the last state in contact unless the integrator gave up.
fn advance(
    scene: &SpatialScene,
    from: TimedState,
    end: f64,
    longest: f64,
    budget: &Budget,
) -> Result<TimedState, Box<(Option<TimedState>, SpatialEnded)>> {
    let (all, failure) = steps(scene, from, end, longest, budget);
    let mut held = from;
    for step in all {
        if let Some(first) = breach(&step, scene) {
            let (at, last) = locate(scene, held, step.time, first);
            let ended = match last {
                Breach::Flat => SpatialEnded::Flat { time: at.time },
                Breach::NoContact => SpatialEnded::NoContact { time: at.time },
                Breach::Pulls(palm) => SpatialEnded::ContactLost { palm, time: at.time },
            };
            return Err(Box::new((Some(at), ended)));
        }
        held = step;
    }
    match failure {
        None => Ok(held),
        // the integrator cannot step over the rim, and its last steps before it lose digits
        Some(_) if is_at_rim(&held, scene) => {
            Err(Box::new((None, SpatialEnded::NoContact { time: held.time })))
        }
        Some(why) => Err(Box::new((None, SpatialEnded::Failed { time: held.time, why }))),
    }
}

/// Where the contacts hold for the last time between a state in which they do and a time at which they do not, by bisection; each
/// state is integrated from the first one.
fn locate(scene: &SpatialScene, held: TimedState, broken: f64, mut by: Breach) -> (TimedState, Breach) {
    let (mut low, mut high) = (held, broken);
    while high - low.time > LOCATED {
        let middle = low.time + (high - low.time) / 2.0;
        if middle <= low.time || middle >= high {
            break;
        }
        let (all, failure) = steps(scene, held, middle, middle - held.time, &Budget::new(ALLOWANCE));
        let Some(&state) = all.last().filter(|_| failure.is_none()) else { break };
        match breach(&state, scene) {
            None => low = state,
            Some(found) => (high, by) = (middle, found),
        }
    }
    (low, by)
}
