//! A motion through time, as sensors and motors would report it, and how it ended.

use super::breach::Breach;
use super::laws::{Situation, State};
use super::scene::MovingScene;

/// One palm at one moment. SI units, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalmMoment {
    /// Palm 1's angle `phi1` is against the X axis, palm 2's `phi2` against palm 1; so are rate and acceleration.
    pub angle: f64,
    pub rate: f64,
    pub acceleration: f64,
    /// The distance of the contact from the origin, which the sensor measures.
    pub s: f64,
    /// The projection of the contact, in the body's frame, on the outward normal there.
    pub r: f64,
    /// Its projection on the tangent a quarter turn clockwise from that normal.
    pub d: f64,
    /// The contact force, positive where the palm pushes.
    pub force: f64,
    /// The motor's torque about the origin, counterclockwise.
    pub torque: f64,
    /// Friction on the body, and how fast the body slides there, both along the palm's tangent as the thesis turns it: away from the
    /// origin on palm 1, towards it on palm 2. Zero in a motion without friction.
    pub friction: f64,
    pub slip: f64,
}

/// Body and palms at one moment. SI units, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    pub time: f64,
    /// The body's orientation, its rate and its acceleration.
    pub phi0: f64,
    pub omega0: f64,
    pub alpha0: f64,
    /// The centre of mass in the world, and its velocity.
    pub centre: [f64; 2],
    pub velocity: [f64; 2],
    pub palms: [PalmMoment; 2],
    /// The kinetic energy of body and palms.
    pub kinetic: f64,
    /// The potential energy of the body, zero at the height of the origin.
    pub potential: f64,
    /// The work that the motors have done since time zero.
    pub work: f64,
    /// What friction has taken since time zero.
    pub dissipated: f64,
}

impl Moment {
    pub(super) fn of(scene: &MovingScene, time: f64, state: &State) -> Moment {
        Moment::seen(scene, time, state, &Situation::at(scene, time, state))
    }

    /// The moment of a state whose forces are known.
    pub(super) fn seen(scene: &MovingScene, time: f64, state: &State, at: &Situation) -> Moment {
        let [phi0, omega0, .., work] = *state;
        let relative = |pair: [f64; 2], i: usize| if i == 0 { pair[0] } else { pair[1] - pair[0] };
        let palm = |i: usize| PalmMoment {
            angle: relative(at.angles, i),
            rate: relative(at.rates, i),
            acceleration: relative(at.accelerations, i),
            s: at.s[i],
            r: at.r[i],
            d: at.d[i],
            force: at.forces[i],
            torque: at.torques[i],
            friction: 0.0,
            slip: 0.0,
        };
        let square = |x: f64| x * x;
        let body = square(at.velocity[0]) + square(at.velocity[1]) + square(scene.gyration * omega0);
        let palms: f64 = (0..2).map(|i| scene.palm_inertia[i] * square(at.rates[i])).sum();
        Moment {
            time,
            phi0,
            omega0,
            alpha0: at.alpha0,
            centre: at.centre,
            velocity: at.velocity,
            palms: [palm(0), palm(1)],
            kinetic: (scene.mass * body + palms) / 2.0,
            potential: -scene.mass * scene.gravity * at.centre[1],
            work,
            dissipated: 0.0,
        }
    }

    /// Kinetic and potential energy.
    pub fn energy(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// How a motion ended. Palms are 1 and 2; the time is the last at which all contacts held.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// At the last sample.
    Completed,
    /// A palm would have had to pull.
    ContactLost { palm: usize, time: f64 },
    /// The palms became parallel, to a ten-thousandth of a radian.
    PalmsParallel { time: f64 },
    /// A contact reached the end of its palm.
    OutOfPalm { palm: usize, time: f64 },
    /// The integrator gave up, for instance because the tolerance cannot be met.
    Failed { time: f64, why: String },
}

impl Ended {
    pub(super) fn by(breach: Breach, time: f64) -> Ended {
        match breach {
            Breach::Parallel => Ended::PalmsParallel { time },
            Breach::Beyond { palm } => Ended::OutOfPalm { palm, time },
            Breach::Contact { palm } => Ended::ContactLost { palm, time },
        }
    }
}

/// As text, after "the motion".
impl std::fmt::Display for Ended {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Ended::Completed => write!(to, "completed"),
            Ended::ContactLost { palm, time } => {
                write!(to, "contact with palm {palm} lost at {time:.6} s: its force is zero")
            }
            Ended::PalmsParallel { time } => write!(to, "palms parallel at {time:.6} s"),
            Ended::OutOfPalm { palm, time } => write!(to, "contact ran off palm {palm} at {time:.6} s"),
            Ended::Failed { time, why } => write!(to, "failed at {time:.6} s: {why}"),
        }
    }
}

/// A sudden turn: the pose in which the body lay has ceased to be stable (3.43), and it falls to the next that is. Angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// When, in seconds.
    pub time: f64,
    /// The palms' angles then: palm 1 against the X axis, palm 2 against palm 1.
    pub palms: [f64; 2],
    /// The body's orientation before.
    pub from: f64,
    /// And after.
    pub to: f64,
    /// By how much the centre of mass came down, in metres.
    pub drop: f64,
}

/// A motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// One a sample time that was reached and, where the motion ended between two of them, one at its end.
    pub moments: Vec<Moment>,
    pub ended: Ended,
    /// Kinetic and potential energy at time zero, in joules.
    pub start_energy: f64,
    /// Sudden turns, in order; only slow motion has them.
    pub jumps: Vec<Jump>,
}

impl Trajectory {
    /// The greatest difference, over all moments, between the energy gained since time zero and the work of the
    /// motors less what friction has taken, in joules: zero but for errors of the integration.
    pub fn energy_drift(&self) -> f64 {
        let drift =
            |moment: &Moment| (moment.energy() - self.start_energy - moment.work + moment.dissipated).abs();
        self.moments.iter().map(drift).fold(0.0, f64::max)
    }
}
