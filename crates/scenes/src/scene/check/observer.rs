//! The observer's settings, and the studies.

use super::super::keys::{GuessKeys, ModeKeys, ObserverKeys};
use super::super::{CurvatureStudy, Guess, Method, ModeSettings, ObserverSettings, Study};
use super::{Checks, MOST_SAMPLES, Problem, Source};
use palmistry_observe::{CalibrationKind, Loss};
use std::collections::BTreeMap;

/// The most bounds that a map over curvatures may hold.
const MOST_BOUNDS: usize = 1_000_000;

/// The most first guesses that a study may try.
const MOST_GUESSES: usize = 10_000_000;

/// The method where none is named: the shortest search from a guess; without one, the method that converges most often (the book's comparison of observers).
fn default_method(guess: &Guess) -> Method {
    match guess {
        Guess::Sample => Method::MultipleShooting,
        Guess::Values(_) | Guess::Off(_) | Guess::None => Method::TrustRegion,
    }
}

impl Checks<'_> {
    pub(super) fn observer(&self, keys: ObserverKeys, source: Source) -> Result<ObserverSettings, Problem> {
        if keys.estimate.is_empty() {
            let help = "name the states that are estimated";
            return Err(self.wrong("observer.estimate", "there is nothing to estimate", help));
        }
        self.names("observer.estimate", &keys.estimate, |name| format!("'{name}'"))?;
        for (name, value) in &keys.known {
            let place = format!("observer.known.{name}");
            self.finite(&place, *value)?;
            if keys.estimate.contains(name) {
                let message = format!("'{name}' is both known and estimated");
                return Err(self.wrong_key(&place, message, "leave it out here or in 'estimate'"));
            }
        }
        self.estimation(&keys, source)?;
        let guess = self.guess(keys.guess, keys.guess_off, &keys.estimate, source)?;
        let methods = keys.methods.unwrap_or_else(|| vec![default_method(&guess)]);
        if methods.is_empty() {
            let help = "name one or more: newton, trust-region, multiple-shooting, integration, kalman, unscented, smoother, high-gain";
            return Err(self.wrong("observer.methods", "there is no method", help));
        }
        self.names("observer.methods", &methods, |method| format!("'{}'", method.name()))?;
        self.names("observer.clamp", &keys.clamp, |name| format!("'{name}'"))?;
        for (index, name) in keys.clamp.iter().enumerate() {
            self.sought(&format!("observer.clamp[{index}]"), name, &keys.estimate)?;
        }
        if keys.clamp.len() == keys.estimate.len() {
            let message = "all estimated states are clamped: the first window has nothing to change";
            return Err(self.wrong("observer.clamp", message, "leave at least one state free"));
        }
        let samples = source.samples.unwrap_or(MOST_SAMPLES);
        let window = keys.window.unwrap_or(samples.min(80));
        self.count("observer.window", window, 2..=samples)?;
        self.count("observer.steps", keys.steps, 1..=1000)?;
        self.positive("observer.unobservable_above", keys.unobservable_above, "")?;
        self.count("observer.shooting.segments", keys.shooting.segments, 1..=1000)?;
        self.count("observer.shooting.starts", keys.shooting.starts, 1..=1000)?;
        self.not_negative("observer.kalman.process_noise", keys.kalman.process_noise, "")?;
        self.positive("observer.kalman.prior", keys.kalman.prior, "")?;
        self.positive("observer.kalman.least_sigma", keys.kalman.least_sigma, "m")?;
        self.not_negative("observer.unscented.process_noise", keys.unscented.process_noise, "")?;
        self.positive("observer.unscented.prior", keys.unscented.prior, "")?;
        self.positive("observer.unscented.least_sigma", keys.unscented.least_sigma, "")?;
        self.not_negative("observer.unscented.kappa", keys.unscented.kappa, "")?;
        self.positive("observer.high_gain.gain", keys.high_gain.gain, "1/s")?;
        if !keys.modes.is_empty() && !methods.first().is_some_and(|method| method.is_by_windows()) {
            let help = "let the first method be newton, trust-region or multiple-shooting";
            return Err(self.wrong(
                "observer.methods",
                "modes are distinguished by moving-horizon windows",
                help,
            ));
        }
        if let Some(switch) = keys.switch {
            self.positive("observer.switch.condition", switch.condition, "")?;
            if keys.modes.is_empty() {
                let help = "give the other observers, each in its own [[observer.modes]], or leave it out";
                return Err(self.wrong(
                    "observer.switch",
                    "there is one observer, and nothing to switch to",
                    help,
                ));
            }
        }
        let modes = keys.modes.into_iter().enumerate();
        let modes = modes.map(|(index, own)| self.mode(index, own)).collect::<Result<Vec<_>, _>>()?;
        let mode = if keys.mode.is_empty() { "the scene's own model".to_owned() } else { keys.mode };
        let names: Vec<&String> = std::iter::once(&mode).chain(modes.iter().map(|own| &own.name)).collect();
        self.names("observer.modes", &names, |name| format!("'{name}'"))?;
        Ok(ObserverSettings {
            mode,
            modes,
            library: keys.library,
            switch: keys.switch,
            inherit: keys.inherit,
            whole: keys.whole,
            bounds: keys.bounds,
            loss: keys.loss,
            methods,
            estimate: keys.estimate,
            known: keys.known,
            inputs: keys.inputs,
            guess,
            clamp: keys.clamp,
            window,
            steps: keys.steps,
            when_unobservable: keys.when_unobservable,
            unobservable_above: keys.unobservable_above,
            shooting: keys.shooting,
            kalman: keys.kalman,
            unscented: keys.unscented,
            high_gain: keys.high_gain,
        })
    }

    fn mode(&self, index: usize, keys: ModeKeys) -> Result<ModeSettings, Problem> {
        let place = |key: &str| format!("observer.modes[{index}].{key}");
        if keys.estimate.is_empty() {
            return Err(self.wrong(
                &place("estimate"),
                "there is nothing to estimate",
                "name the states that are estimated",
            ));
        }
        self.names(&place("estimate"), &keys.estimate, |name| format!("'{name}'"))?;
        for (name, value) in &keys.known {
            self.finite(&place(&format!("known.{name}")), *value)?;
        }
        for (name, [low, high]) in &keys.bounds {
            let own = place(&format!("bounds.{name}"));
            self.sought(&own, name, &keys.estimate)?;
            if low.is_nan() || high.is_nan() || low >= high {
                let message = format!("no number of '{name}' lies from {low} to {high}");
                return Err(self.wrong(&own, message, "give the least value first; inf is none"));
            }
        }
        let guess = match keys.guess {
            Some(GuessKeys::Values(values)) => values,
            None => BTreeMap::new(),
            // a mode without a value starts in the middle of the sample box
            Some(GuessKeys::Word(word)) if word == "sample" => BTreeMap::new(),
            Some(GuessKeys::Word(word)) => {
                let help = "write guess = \"sample\" (the middle of the sample box), or a table of values";
                return Err(self.wrong(
                    &place("guess"),
                    format!("'{word}' is no first guess of a mode"),
                    help,
                ));
            }
        };
        for (name, value) in &guess {
            self.sought(&place(&format!("guess.{name}")), name, &keys.estimate)?;
            self.finite(&place(&format!("guess.{name}")), *value)?;
        }
        let ModeKeys { name, model, estimate, known, inputs, bounds, .. } = keys;
        Ok(ModeSettings { name, model, estimate, known, inputs, bounds, guess })
    }

    /// The settings of the estimates by windows.
    fn estimation(&self, keys: &ObserverKeys, source: Source) -> Result<(), Problem> {
        for (name, [low, high]) in &keys.bounds {
            let place = format!("observer.bounds.{name}");
            self.sought(&place, name, &keys.estimate)?;
            if low.is_nan() || high.is_nan() || low >= high {
                let message = format!("no number of '{name}' lies from {low} to {high}");
                return Err(self.wrong(&place, message, "give the least value first; inf is none"));
            }
        }
        if let Loss::Huber(corner) = keys.loss {
            if !(corner.is_finite() && corner >= 1.0) {
                let help = "give the number of standard deviations from which on a measurement counts less: 1 or more, 1.345 by custom";
                return Err(self.wrong("observer.loss", format!("a corner at {corner} is none"), help));
            }
            if !source.is_noisy {
                let help = "add noise = ... under [sensor]: the corner is a multiple of it";
                return Err(self.wrong(
                    "observer.loss",
                    "a robust loss needs the noise of the measurements",
                    help,
                ));
            }
        }
        Ok(())
    }

    fn guess(
        &self,
        values: Option<GuessKeys>,
        off: Option<f64>,
        estimate: &[String],
        source: Source,
    ) -> Result<Guess, Problem> {
        match (values, off) {
            (Some(_), Some(_)) => {
                let message = "both 'guess' and 'guess_off' are given";
                Err(self.wrong_key("observer.guess_off", message, "leave one out"))
            }
            (Some(GuessKeys::Word(word)), None) if word == "none" => Ok(Guess::None),
            (Some(GuessKeys::Word(word)), None) if word == "sample" => Ok(Guess::Sample),
            (Some(GuessKeys::Word(word)), None) => {
                let help = "write guess = \"none\", guess = \"sample\" (the middle of the sample box), or a table of values";
                Err(self.wrong("observer.guess", format!("'{word}' is no first guess"), help))
            }
            // a body between palms needs no guess
            (None, None) if source.has_palms => Ok(Guess::None),
            (None, None) => Ok(Guess::Sample),
            (None, Some(off)) => {
                self.finite("observer.guess_off", off)?;
                // a percentage would start far from everything, without a word
                if off.abs() > 1.0 {
                    let message = format!(
                        "'guess_off' is a fraction, and with {off} the guess is {} times the true value",
                        1.0 + off
                    );
                    let help = format!(
                        "{off} % is guess_off = {}; farther off, give the values: guess = {{ ... }}",
                        off / 100.0
                    );
                    return Err(self.wrong("observer.guess_off", message, help));
                }
                if source.samples.is_none() {
                    let message = "recorded data has no truth from which a guess could be off";
                    let help = "give the first guess itself: guess = { r1 = 2.0, ... }";
                    return Err(self.wrong_key("observer.guess_off", message, help));
                }
                Ok(Guess::Off(off))
            }
            (Some(GuessKeys::Values(values)), None) => {
                for (name, value) in &values {
                    let place = format!("observer.guess.{name}");
                    self.sought(&place, name, estimate)?;
                    self.finite(&place, *value)?;
                }
                // gains and biases have a default guess
                let is_missing =
                    |name: &&String| !values.contains_key(*name) && CalibrationKind::of(name).is_none();
                if let Some(name) = estimate.iter().find(is_missing) {
                    let message = format!("there is no first guess of '{name}'");
                    let help = format!("add {name} = ... to it");
                    return Err(self.wrong("observer.guess", message, help));
                }
                Ok(Guess::Values(values))
            }
        }
    }

    /// A name that has to be among the estimated ones.
    fn sought(&self, place: &str, name: &str, estimate: &[String]) -> Result<(), Problem> {
        if estimate.iter().any(|sought| sought == name) {
            return Ok(());
        }
        let help = match palmistry_lang::nearest(name, estimate.iter().map(String::as_str)) {
            Some(near) => format!("perhaps you meant '{near}'"),
            None => format!("estimated: {}", estimate.join(", ")),
        };
        Err(self.wrong_key(place, format!("'{name}' is not in 'estimate'"), help))
    }

    pub(super) fn study(
        &self,
        study: &Study,
        observer: &ObserverSettings,
        simulated: bool,
    ) -> Result<(), Problem> {
        let asked = [
            ("study.noise", study.noise.is_some()),
            ("study.basin", study.basin.is_some()),
            ("study.curvature", study.curvature.is_some()),
        ];
        for (place, asked) in asked {
            if asked && !simulated {
                let message = "a study needs the truth, and recorded data has none";
                return Err(self.wrong_key(place, message, "leave it out, or simulate"));
            }
        }
        if let Some(noise) = &study.noise {
            if noise.levels.is_empty() {
                let help = "give one or more standard deviations, in m";
                return Err(self.wrong("study.noise.levels", "there is no level of noise", help));
            }
            for (index, level) in noise.levels.iter().enumerate() {
                self.deviation(&format!("study.noise.levels[{index}]"), *level, "m")?;
            }
            self.count("study.noise.seeds", noise.seeds, 1..=1_000_000)?;
        }
        study.curvature.as_ref().map_or(Ok(()), |curvature| self.curvature(curvature))?;
        let Some(basin) = &study.basin else { return Ok(()) };
        if basin.ranges.is_empty() {
            let help = "add, for instance: r1 = [0.5, 3.0]";
            return Err(self.wrong_key("study.basin", "the grid spans no state", help));
        }
        for (name, [low, high]) in &basin.ranges {
            let place = format!("study.basin.{name}");
            self.sought(&place, name, &observer.estimate)?;
            self.finite(&place, *low)?;
            self.finite(&place, *high)?;
            if low >= high {
                let message = format!("the range of '{name}' is empty: {low} to {high}");
                return Err(self.wrong(&place, message, "give the least value first"));
            }
        }
        self.count("study.basin.points", basin.points, 2..=10_001)?;
        let guesses = u32::try_from(basin.ranges.len()).ok().and_then(|n| basin.points.checked_pow(n));
        if guesses.is_none_or(|guesses| guesses > MOST_GUESSES) {
            let message = format!("{} points along {} axes are too many", basin.points, basin.ranges.len());
            let help = format!("let the grid have at most {MOST_GUESSES} points");
            return Err(self.wrong("study.basin.points", message, help));
        }
        Ok(())
    }

    /// The values of `[study.curvature]`.
    fn curvature(&self, study: &CurvatureStudy) -> Result<(), Problem> {
        let place = |key: &str| format!("study.curvature.{key}");
        let [low, high] = study.range;
        self.finite(&place("range"), low)?;
        self.finite(&place("range"), high)?;
        if low >= high {
            let message = format!("the range of curvatures is empty: {low} to {high}");
            return Err(self.wrong(&place("range"), message, "give the least value first, in 1/m"));
        }
        for (key, values, help) in [
            ("orientations", &study.orientations, "give one or more angles of the body at the start, in rad"),
            ("rates", &study.rates, "give one or more rates of the body at the start, in rad/s"),
        ] {
            if values.is_empty() {
                return Err(self.wrong(&place(key), format!("there are no {key}"), help));
            }
            for (index, value) in values.iter().enumerate() {
                self.finite(&format!("{}[{index}]", place(key)), *value)?;
            }
        }
        self.positive(&place("noise"), study.noise, "m")?;
        self.deviation(&place("noise"), study.noise, "m")?;
        self.count(&place("points"), study.points, 2..=1001)?;
        let motions = study.orientations.len() * study.rates.len();
        if motions * study.points * study.points > MOST_BOUNDS {
            let message = format!("{} by {0} palms in {motions} motions are too many", study.points);
            let help = format!("let there be at most {MOST_BOUNDS} bounds");
            return Err(self.wrong(&place("points"), message, help));
        }
        Ok(())
    }
}
