//! The simulated motion of a scene's body, and the measurements of its sensors and motors.

use super::columns::{COLUMNS, Column, ColumnUse};
use super::scene::{self, Channel, Scene, SceneError, Sensor, Simulated};
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::mechanics::moving::{
    BodyForm, CentreOfMass, DEFAULT_TOLERANCE, DrawnSpline, Ended, FormError, ModePair,
    MovingScene as Bodies, RubbedMotion, SceneError as Refused, Shape, SplineDraws, Trajectory,
    simulate as follow, simulate_with_friction,
};
use palmistry_bodies::pose_surface::PoseBody;
use palmistry_observe::{Record, RecordError, Signals};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// The columns measured by touch; only they have noise by default.
pub const TOUCH: [&str; 2] = ["s1", "s2"];

/// The standard deviation of measurements without error, a nanometre, where a bound needs one.
pub const NOMINAL: f64 = 1e-9;

/// The number of samples of a motion of which only the start is needed.
pub(super) const FIRST_SAMPLES: usize = 2;

/// A scene's body in motion.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// The body's shape.
    pub shape: Shape,
    /// How it moved.
    pub trajectory: Trajectory,
    /// With friction, how the contacts slid, rolled or stuck, and from when on; empty without.
    pub modes: Vec<(f64, ModePair)>,
    /// Constants of the bodies by the names that the thesis gives them: `m`, `rho`, `I1`, `I2`, `g`.
    pub constants: BTreeMap<String, f64>,
    /// How many splines were drawn until one was convex, where the body is random.
    pub draws: Option<usize>,
}

impl Simulation {
    /// Moves the body of a scene.
    ///
    /// # Errors
    /// Where the body is not convex or the palms cannot hold it, with the place in the scene.
    pub fn of(scene: &Scene, simulated: &Simulated) -> Result<Simulation, SceneError> {
        Simulation::of_samples(scene, simulated, usize::MAX)
    }

    /// The start of the same motion: its first sample is that of the whole motion.
    ///
    /// # Errors
    /// As [`Simulation::of`].
    pub(super) fn of_first_samples(scene: &Scene, simulated: &Simulated) -> Result<Simulation, SceneError> {
        Simulation::of_samples(scene, simulated, FIRST_SAMPLES)
    }

    fn of_samples(scene: &Scene, simulated: &Simulated, most: usize) -> Result<Simulation, SceneError> {
        let (shape, draws) = body(scene, simulated)?;
        let constants = constants(scene, simulated, &shape);
        let bodies = Bodies {
            mass: simulated.body.mass,
            gyration: simulated.body.radius_of_gyration.unwrap_or_else(|| shape.gyration()),
            orientation: simulated.body.orientation,
            rate: simulated.body.rate,
            gravity: simulated.body.gravity,
            palm_inertia: simulated.palms.inertia,
            palm_lengths: [f64::INFINITY; 2],
            palms: scene.palm_forms,
            drive: simulated.palms.drive.clone(),
            tolerance: DEFAULT_TOLERANCE,
            shape,
        };
        let mut times = simulated.times(scene.sensor.jitter, scene.seed);
        times.truncate(most);
        let friction = simulated.palms.friction;
        let moved = match friction > 0.0 {
            true => simulate_with_friction(&bodies, friction, &times),
            false => follow(&bodies, &times).map(RubbedMotion::smooth),
        };
        let RubbedMotion { mut trajectory, modes } = moved.map_err(|error| {
            let place = match error {
                Refused::NotHeld { .. } | Refused::Start(_) | Refused::NoModes => "palms",
                _ => "body",
            };
            scene.error_at(
                place,
                error.to_string(),
                "here",
                "the body has to touch both palms at the start, and be pushed by both",
            )
        })?;
        // measurements have their own times: the moment at which a contact ends is none of them, and may lie so near to one
        // that no polynomial can run through both
        let sampled = |time: f64| times.binary_search_by(|other| other.total_cmp(&time)).is_ok();
        trajectory.moments.retain(|moment| sampled(moment.time));
        Ok(Simulation { shape: bodies.shape, trajectory, modes, constants, draws })
    }

    /// How far the motion went.
    pub fn ended(&self) -> &Ended {
        &self.trajectory.ended
    }

    /// The true values of a state of the models, sample by sample: one of the table's, or a constant.
    pub fn truth(&self, name: &str) -> Option<Vec<f64>> {
        match COLUMNS.iter().find(|column| column.name == name && column.usage != ColumnUse::Shown) {
            Some(column) => Some(self.values(column)),
            None => self.constants.get(name).map(|value| vec![*value; self.trajectory.moments.len()]),
        }
    }

    fn values(&self, column: &Column) -> Vec<f64> {
        self.trajectory.moments.iter().map(column.value).collect()
    }

    fn times(&self) -> Vec<f64> {
        self.trajectory.moments.iter().map(|moment| moment.time).collect()
    }

    /// All of the motion, as a table: the body's pose, rates and accelerations, the contacts, the contact forces, the motors'
    /// torques, the energies and the motors' work, in SI units.
    ///
    /// # Errors
    /// None that a simulation could bring about.
    pub fn table(&self) -> Result<Record, RecordError> {
        let columns = COLUMNS.iter().map(|column| (column.name.to_owned(), self.values(column)));
        Record::new(self.times(), columns.collect())
    }

    /// The measurements: the contacts along the palms with normal errors of the standard deviation `noise`,
    /// rounded to multiples of `resolution` (both in m), and the palms' angles, rates, accelerations and torques without error.
    /// The same seed gives the same errors, whatever their size.
    ///
    /// # Errors
    /// None that a simulation could bring about.
    pub fn measurements(&self, noise: f64, resolution: f64, seed: u64) -> Result<Record, RecordError> {
        self.read(&Sensor { noise, resolution, jitter: 0.0 }, &BTreeMap::new(), seed)
    }

    /// The measurements, each column with its own errors: `gain * x(t - delay) + bias`, normal errors, rounding. What lies
    /// before the first sample is extrapolated. The same seed gives each column the same errors, whatever their size and those of the
    /// other columns.
    ///
    /// # Errors
    /// None that a simulation could bring about.
    pub fn read(
        &self,
        sensor: &Sensor,
        channels: &BTreeMap<String, Channel>,
        seed: u64,
    ) -> Result<Record, RecordError> {
        let is_read = |column: &&Column| column.usage == ColumnUse::Read;
        let mut read: Vec<&Column> = COLUMNS.iter().filter(is_read).collect();
        read.sort_by_key(|column| !TOUCH.contains(&column.name)); // stable: touch first
        let mut columns: Vec<(String, Vec<f64>)> =
            read.iter().map(|column| (column.name.to_owned(), self.values(column))).collect();
        let is_touch = |name: &str| TOUCH.contains(&name);
        read_with_errors(&self.times(), &mut columns, &is_touch, sensor, channels, seed);
        Record::new(self.times(), columns)
    }
}

/// Adds the sensors' errors to some columns: `gain * x(t - delay) + bias`, normal errors, rounding. What lies before the first
/// sample is extrapolated. Outputs have the common errors where they have none of their own; the same seed gives each column the same errors,
/// whatever their size and those of the other columns.
pub(super) fn read_with_errors(
    times: &[f64],
    columns: &mut [(String, Vec<f64>)],
    is_output: &dyn Fn(&str) -> bool,
    sensor: &Sensor,
    channels: &BTreeMap<String, Channel>,
    seed: u64,
) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for (place, (name, values)) in columns.iter_mut().enumerate() {
        let is_output = is_output(name);
        if !is_output && !channels.contains_key(name) {
            continue;
        }
        let channel = channels.get(name).copied().unwrap_or_default();
        let common = if is_output { *sensor } else { Sensor::default() };
        let noise = channel.noise.unwrap_or(common.noise);
        let resolution = channel.resolution.unwrap_or(common.resolution);
        if channel.delay > 0.0 {
            *values = late(times, values, channel.delay);
        }
        // one stream for all outputs, and one for each other column
        let mut own = ChaCha8Rng::seed_from_u64(seed);
        own.set_stream(place as u64);
        let random = if is_output { &mut random } else { &mut own };
        for value in values {
            *value = channel.gain * *value + channel.bias + noise * normal(random);
            if resolution > 0.0 {
                *value = (*value / resolution).round() * resolution;
            }
        }
    }
}

/// The values at the time of each sample less the delay, by the curves through the samples.
fn late(times: &[f64], values: &[f64], delay: f64) -> Vec<f64> {
    let named = vec![(String::new(), values.to_vec())];
    let Ok(curve) = Signals::new(times.to_vec(), named) else { return values.to_vec() };
    let before = |time: &f64| {
        let mut value = [0.0];
        curve.at(&[0], time - delay, &mut value);
        value[0]
    };
    curve.times().iter().map(before).collect()
}

/// The standard deviation of a measurement's error: noise, and the rounding to multiples of the resolution, which is even
/// over a width of one resolution.
pub fn deviation(noise: f64, resolution: f64) -> f64 {
    (noise * noise + resolution * resolution / 12.0).sqrt()
}

/// A number from the normal distribution with mean zero and standard deviation one, by G. Box and M. Muller's method.
pub(super) fn normal(random: &mut ChaCha8Rng) -> f64 {
    use rand::RngExt;
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}

/// The body of a scene, and how many splines were drawn until one was convex.
pub(super) fn body(scene: &Scene, simulated: &Simulated) -> Result<(Shape, Option<usize>), SceneError> {
    outline(&simulated.body).map_err(|error| {
        let help = "a body has to be smooth and strictly convex, with its centre of mass inside";
        scene.error_at("body.shape", error.to_string(), "this body", help)
    })
}

/// The radius of a flat palm to a model of circular ones, in m. An arc of this radius departs from its tangent by `s^2/b/2`, and doubles
/// give `b (cos(s/b) - 1)` to an eighth of `b eps`: both are about a hundred-millionth of a metre here.
const FLAT: f64 = 1e8;

/// Constants of the bodies by the names that the thesis gives them: `m`, `rho`, `I1`, `I2`, `g`, and `b1`, `b2` of models of circular
/// palms.
pub(super) fn constants(scene: &Scene, simulated: &Simulated, shape: &Shape) -> BTreeMap<String, f64> {
    let (body, inertia) = (&simulated.body, simulated.palms.inertia);
    let constants = [
        ("m", body.mass),
        ("rho", body.radius_of_gyration.unwrap_or_else(|| shape.gyration())),
        ("I1", inertia[0]),
        ("I2", inertia[1]),
        ("g", body.gravity),
    ];
    let gyration = constants[1].1;
    // the unknowns of friction_sliding.proof and its like
    let inverse =
        [("one_over_m", 1.0 / body.mass), ("rho2", gyration * gyration), ("mu", simulated.palms.friction)];
    let radii = ["b1", "b2"].into_iter().zip(scene.palm_forms).map(|(name, form)| match form {
        Palm::Circular { radius } => (name, radius),
        Palm::Flat => (name, FLAT),
    });
    constants.into_iter().chain(inverse).chain(radii).map(|(name, value)| (name.to_owned(), value)).collect()
}

/// The outline, where the centre of mass is, and the random body where it is one.
fn form(body: &scene::Body) -> Result<(BodyForm, CentreOfMass, Option<DrawnSpline>), FormError> {
    let centre = body.centre_of_mass.map_or(CentreOfMass::Uniform, CentreOfMass::At);
    let form = match &body.shape {
        scene::SceneOutline::Harmonics { mean, harmonics } => {
            BodyForm::Harmonics { mean: *mean, harmonics: harmonics.clone() }
        }
        scene::SceneOutline::Ellipse { semi_axes } => BodyForm::Ellipse { semi_axes: *semi_axes },
        scene::SceneOutline::Superellipse { semi_axes, exponent, rounding } => {
            BodyForm::Superellipse { semi_axes: *semi_axes, exponent: *exponent, rounding: *rounding }
        }
        scene::SceneOutline::Arcs { corners, radius } => {
            BodyForm::Arcs { corners: corners.clone(), radius: *radius }
        }
        scene::SceneOutline::Spline { radii, knots } => BodyForm::Spline { radii: *radii, knots: *knots },
        scene::SceneOutline::RandomSpline { seed, knots } => {
            let drawn = SplineDraws::new(*seed, *knots).until_convex()?;
            return Ok((drawn.form.clone(), centre, Some(drawn)));
        }
    };
    Ok((form, centre, None))
}

/// The shape of a body, and how many splines were drawn until one was convex.
pub(super) fn outline(body: &scene::Body) -> Result<(Shape, Option<usize>), FormError> {
    Ok(match form(body)? {
        (_, CentreOfMass::Uniform, Some(drawn)) => (drawn.shape, Some(drawn.draws)),
        (form, centre, drawn) => (Shape::new(&form, centre)?, drawn.map(|drawn| drawn.draws)),
    })
}

fn pose_body(scene: &Scene) -> Result<PoseBody, SceneError> {
    let Some(simulated) = &scene.simulated else {
        let help = "stable poses are those of a simulated body: give [body] and [palms]";
        return Err(scene.error_at("model", "the scene has no body", "no body beside this", help));
    };
    let found = form(&simulated.body).and_then(|(form, centre, _)| PoseBody::new(form, centre));
    found.map_err(|error| {
        let help = "a body has to be smooth and strictly convex, with its centre of mass inside";
        scene.error_at("body.shape", error.to_string(), "this body", help)
    })
}

impl Scene {
    /// The body of the scene, for its stable poses.
    ///
    /// # Errors
    /// Where the scene has no body, or one that is not convex, with the place in the scene.
    pub fn pose_body(&self) -> Result<PoseBody, SceneError> {
        pose_body(self)
    }
}
