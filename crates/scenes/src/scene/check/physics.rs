//! The body, the palms, the sensors and the times.

use super::super::keys::PalmsKeys;
use super::super::simulated::MOST_JITTER;
use super::super::{Body, Channel, Palms, SceneOutline, Sensor, SimulatedSystem};
use super::{Checks, MOST_SAMPLES, Problem, Simulated};
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::mechanics::moving::{Drive, Oscillation};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// The largest delay, in steps of time: eight samples extrapolate a curve this far before the first.
pub(super) const MOST_DELAY: f64 = 4.0;

impl Checks<'_> {
    pub(super) fn sensor(&self, sensor: &Sensor) -> Result<(), Problem> {
        self.deviation("sensor.noise", sensor.noise, "m")?;
        self.deviation("sensor.resolution", sensor.resolution, "m")?;
        self.not_negative("sensor.jitter", sensor.jitter, "s")
    }

    pub(super) fn channels(
        &self,
        channels: &BTreeMap<String, Channel>,
        recorded: bool,
    ) -> Result<(), Problem> {
        for (name, channel) in channels {
            let place = |key: &str| format!("sensor.{name}.{key}");
            let unit = "the unit of the column";
            self.deviation(&place("noise"), channel.noise.unwrap_or(0.0), unit)?;
            self.deviation(&place("resolution"), channel.resolution.unwrap_or(0.0), unit)?;
            self.finite(&place("bias"), channel.bias)?;
            self.finite(&place("gain"), channel.gain)?;
            self.not_negative(&place("delay"), channel.delay, "s")?;
            if channel.gain == 0.0 {
                let help = "give a number that is not zero, 1 for a sensor that is right";
                return Err(self.wrong(&place("gain"), "a gain of zero reads nothing", help));
            }
            let given =
                [("bias", channel.bias, 0.0), ("gain", channel.gain, 1.0), ("delay", channel.delay, 0.0)];
            if let Some((key, value, _)) = given.iter().find(|(_, value, none)| recorded && value != none) {
                let message = format!("the {key} of a recorded column is not simulated");
                let help = format!(
                    "give what is known of it to the observers, known = {{ \"{name}.{key}\" = {value} }}, or let them seek it"
                );
                return Err(self.wrong(&place(key), message, help));
            }
        }
        Ok(())
    }

    /// The value of a late sensor at the first sample lies before the simulation: it is extrapolated, and not far.
    pub(super) fn delays(
        &self,
        channels: &BTreeMap<String, Channel>,
        (duration, samples): (f64, usize),
    ) -> Result<(), Problem> {
        let step = duration / samples.saturating_sub(1).max(1) as f64;
        for (name, channel) in channels {
            if channel.delay > MOST_DELAY * step {
                let message =
                    format!("a delay of {} s is too much for samples {step:.3e} s apart", channel.delay);
                let help = format!(
                    "give at most {MOST_DELAY} steps: what was before the first sample is not simulated"
                );
                return Err(self.wrong(&format!("sensor.{name}.delay"), message, help));
            }
        }
        Ok(())
    }

    pub(super) fn jitter(&self, jitter: f64, (duration, samples): (f64, usize)) -> Result<(), Problem> {
        let step = duration / samples.saturating_sub(1).max(1) as f64;
        if jitter <= MOST_JITTER * step {
            return Ok(());
        }
        let message = format!("a jitter of {jitter} s is too much for samples {step:.3e} s apart");
        let help = format!("give at most {MOST_JITTER} of the time between samples, or take fewer");
        Err(self.wrong("sensor.jitter", message, help))
    }

    /// Duration and samples, if anything is simulated: then both have to be there.
    pub(super) fn span(
        &self,
        duration: Option<f64>,
        samples: Option<usize>,
        rate: Option<f64>,
        described: [(&'static str, bool); 3],
    ) -> Result<Option<(f64, usize)>, Problem> {
        let given =
            [("duration", duration.is_some()), ("samples", samples.is_some()), ("rate", rate.is_some())];
        let mut given = given.into_iter().chain(described);
        let Some((first, _)) = given.find(|(_, there)| *there) else { return Ok(None) };
        let beside = |missing: &str, example: &str| {
            self.wrong_key(
                first,
                format!("'{first}' is given without {missing}"),
                format!("add, for instance: {example}"),
            )
        };
        let duration = duration.ok_or_else(|| beside("'duration'", "duration = 1.4, in s"))?;
        self.positive("duration", duration, "s")?;
        let (duration, samples) = match (samples, rate) {
            (Some(_), Some(_)) => {
                let message = "both 'samples' and 'rate' are given";
                return Err(self.wrong_key(
                    "rate",
                    message,
                    "leave one out: the duration and the other fix it",
                ));
            }
            (None, None) => return Err(beside("'samples' or 'rate'", "samples = 400")),
            (Some(samples), None) => {
                self.count("samples", samples, 2..=MOST_SAMPLES)?;
                (duration, samples)
            }
            (None, Some(rate)) => {
                self.positive("rate", rate, "Hz")?;
                // a whole number of periods may come out a rounding too short
                let periods = (duration * rate * (1.0 + 4.0 * f64::EPSILON)).floor();
                if !(1.0..MOST_SAMPLES as f64).contains(&periods) {
                    let message = format!("at {rate} Hz, {duration} s have {periods} periods");
                    let help = format!("let there be 2 to {MOST_SAMPLES} samples");
                    return Err(self.wrong("rate", message, help));
                }
                (periods / rate, periods as usize + 1)
            }
        };
        Ok(Some((duration, samples)))
    }

    /// A body between palms: both have to be there.
    pub(super) fn held(
        &self,
        (duration, samples): (f64, usize),
        body: Option<Body>,
        palms: Option<PalmsKeys>,
    ) -> Result<Simulated, Problem> {
        let beside = |missing: &str, example: &str| {
            self.wrong_key(
                "duration",
                format!("'duration' is given without {missing}"),
                format!(
                    "add, for instance: {example}; or [start], for a system that moves by its own equations"
                ),
            )
        };
        let body = body.ok_or_else(|| beside("[body]", "[body] with shape and mass"))?;
        self.body(&body)?;
        let palms = palms.ok_or_else(|| beside("[palms]", "[palms] with inertia and prescribed"))?;
        Ok(Simulated { duration, samples, body, palms: self.palms(palms)? })
    }

    /// A system that moves by its own equations, if one is described.
    pub(super) fn system(
        &self,
        span: Option<(f64, usize)>,
        start: Option<BTreeMap<String, f64>>,
        inputs: Option<BTreeMap<String, String>>,
        has_palms: bool,
    ) -> Result<Option<SimulatedSystem>, Problem> {
        let Some(start) = start else {
            let Some(inputs) = inputs else { return Ok(None) };
            let help = match inputs.is_empty() {
                true => "leave it out",
                false => {
                    "add [start] with a value for each state; or leave it out, and name the columns of the inputs under [observer]"
                }
            };
            return Err(self.wrong_key("inputs", "'inputs' is given without [start]", help));
        };
        if has_palms {
            let message = "both a body between palms and a system with [start] are described";
            return Err(self.wrong_key("start", message, "leave one out"));
        }
        let Some((duration, samples)) = span else {
            let message = "'start' is given without 'duration'";
            return Err(self.wrong_key(
                "start",
                message,
                "add, for instance: duration = 10 and samples = 201",
            ));
        };
        for (name, value) in &start {
            self.finite(&format!("start.{name}"), *value)?;
        }
        let inputs = inputs.unwrap_or_default();
        if let Some(name) = start.keys().find(|name| inputs.contains_key(*name)) {
            let message = format!("'{name}' has a value and a function of time");
            return Err(self.wrong_key(&format!("inputs.{name}"), message, "leave one out"));
        }
        Ok(Some(SimulatedSystem { duration, samples, start, inputs }))
    }

    fn body(&self, body: &Body) -> Result<(), Problem> {
        self.shape("body.shape", &body.shape)?;
        self.positive("body.mass", body.mass, "kg")?;
        if let Some(radius) = body.radius_of_gyration {
            self.positive("body.radius_of_gyration", radius, "m")?;
        }
        self.all_finite("body.centre_of_mass", body.centre_of_mass.iter().flatten())?;
        self.finite("body.orientation", body.orientation)?;
        self.finite("body.rate", body.rate)?;
        self.finite("body.gravity", body.gravity)
    }

    pub(super) fn shape(&self, place: &str, shape: &SceneOutline) -> Result<(), Problem> {
        let within = |key: &str| format!("{place}.{key}");
        match shape {
            SceneOutline::Harmonics { mean, harmonics } => {
                self.positive(&within("mean"), *mean, "m")?;
                if harmonics.len() > 64 {
                    let message = format!("{} harmonics are too many", harmonics.len());
                    return Err(self.wrong(&within("harmonics"), message, "give at most 64"));
                }
                for (index, pair) in harmonics.iter().enumerate() {
                    self.all_finite(&format!("{place}.harmonics[{index}]"), pair)?;
                }
                Ok(())
            }
            SceneOutline::Ellipse { semi_axes } => self.all_positive(&within("semi_axes"), semi_axes, "m"),
            SceneOutline::Superellipse { semi_axes, exponent, rounding } => {
                self.all_positive(&within("semi_axes"), semi_axes, "m")?;
                if !(2..=64).contains(exponent) || exponent % 2 == 1 {
                    let message = format!("an exponent of {exponent} gives no smooth body");
                    return Err(self.wrong(&within("exponent"), message, "give an even number from 2 to 64"));
                }
                self.not_negative(&within("rounding"), *rounding, "m")
            }
            SceneOutline::Arcs { corners, radius } => {
                if corners.len() > 64 {
                    let message = format!("{} corners are too many", corners.len());
                    return Err(self.wrong(&within("corners"), message, "give at most 64"));
                }
                for (index, corner) in corners.iter().enumerate() {
                    self.all_finite(&format!("{place}.corners[{index}]"), corner)?;
                }
                self.positive(&within("radius"), *radius, "m")
            }
            SceneOutline::Spline { radii, .. } => self.all_positive(&within("radii"), radii, "m"),
            SceneOutline::RandomSpline { .. } => Ok(()),
        }
    }

    fn palms(&self, keys: PalmsKeys) -> Result<Palms, Problem> {
        self.all_positive("palms.inertia", &keys.inertia, "kg m^2")?;
        let drive = match (keys.prescribed, keys.torques) {
            (Some(_), Some(_)) => {
                let message = "both 'prescribed' and 'torques' are given";
                let help = "leave one out: either the motion follows from the torques or they from it";
                return Err(self.wrong_key("palms.torques", message, help));
            }
            (None, None) => {
                let help = "add, for instance: prescribed = [{ start = 0.8, rate = 0.5 }, { start = 1.6 }]";
                return Err(self.wrong_key("palms", "nothing is said of how the palms move", help));
            }
            (Some(palms), None) => {
                for (index, palm) in palms.iter().enumerate() {
                    let place = format!("palms.prescribed[{index}]");
                    self.finite(&format!("{place}.start"), palm.start)?;
                    self.finite(&format!("{place}.rate"), palm.rate)?;
                    self.swings(&place, &palm.swings)?;
                }
                self.opening("palms.prescribed[1].start", palms[1].start)?;
                Drive::Prescribed(palms)
            }
            (None, Some(palms)) => {
                for (index, palm) in palms.iter().enumerate() {
                    let place = format!("palms.torques[{index}]");
                    self.finite(&format!("{place}.angle"), palm.angle)?;
                    self.finite(&format!("{place}.rate"), palm.rate)?;
                    self.finite(&format!("{place}.torque"), palm.torque)?;
                    self.swings(&place, &palm.swings)?;
                }
                self.opening("palms.torques[1].angle", palms[1].angle)?;
                Drive::Torques(palms)
            }
        };
        self.not_negative("palms.friction", keys.friction, "")?;
        if keys.friction > 0.0
            && keys.radii.is_some_and(|radii| radii.iter().any(|radius| radius.is_finite()))
        {
            let help = "leave out 'radii', or the friction";
            return Err(self.wrong("palms.friction", "friction is simulated on flat palms only", help));
        }
        Ok(Palms { inertia: keys.inertia, drive, friction: keys.friction })
    }

    /// The forms of palms with these radii.
    pub(super) fn forms(&self, radii: Option<[f64; 2]>) -> Result<[Palm<f64>; 2], Problem> {
        let mut forms = [Palm::Flat; 2];
        for (index, radius) in radii.into_iter().flatten().enumerate() {
            if radius.is_nan() || radius == 0.0 {
                let message = format!("a palm cannot have the radius {radius}");
                let help = "give it in m: above zero for a hollow palm, below zero for a bulging one, inf for a flat one";
                return Err(self.wrong(&format!("palms.radii[{index}]"), message, help));
            }
            if radius.is_finite() {
                forms[index] = Palm::Circular { radius };
            }
        }
        Ok(forms)
    }

    /// The angle between the palms.
    fn opening(&self, place: &str, angle: f64) -> Result<(), Problem> {
        if angle > 0.0 && angle < PI {
            return Ok(());
        }
        let message = format!("the palms do not form a V: palm 2 stands at {angle} rad from palm 1");
        Err(self.wrong(place, message, "give an angle between 0 and pi, measured from palm 1"))
    }

    fn swings(&self, place: &str, swings: &[Oscillation]) -> Result<(), Problem> {
        for (index, swing) in swings.iter().enumerate() {
            let place = format!("{place}.swings[{index}]");
            self.finite(&format!("{place}.amplitude"), swing.amplitude)?;
            self.positive(&format!("{place}.frequency"), swing.frequency, "Hz")?;
            self.finite(&format!("{place}.phase"), swing.phase)?;
        }
        Ok(())
    }

    pub(super) fn all_finite<'a>(
        &self,
        place: &str,
        values: impl IntoIterator<Item = &'a f64>,
    ) -> Result<(), Problem> {
        values
            .into_iter()
            .enumerate()
            .try_for_each(|(index, v)| self.finite(&format!("{place}[{index}]"), *v))
    }

    fn all_positive(&self, place: &str, values: &[f64], unit: &str) -> Result<(), Problem> {
        let place = |index: usize| format!("{place}[{index}]");
        values.iter().enumerate().try_for_each(|(index, v)| self.positive(&place(index), *v, unit))
    }
}
