//! Initial values of the search for shape and motion of a whole record.

use super::super::recovered::TouchTrack;
use super::super::run::Experiment;
use super::super::unguided::{PalmMeasurements, palm_measurements};
use super::law::PalmsAt;
use super::record::{Unknowns, WholeRecord};
use palmistry_bodies::shape::{SupportSample, SupportSeries, SupportWeights, fit_support};
use std::collections::HashMap;

/// A record of up to this many samples is not thinned out.
const MOST_SAMPLES: usize = 4000;

/// The fewest samples of a record.
const FEWEST_SAMPLES: usize = 24;

/// The order of the shape in initial values.
const ORDER: usize = 6;

/// The order to which a disc is optimised.
const DISC_ORDER: usize = 3;

/// Rates on the grid, and the fastest of them in units of `sqrt(g/R)`.
const RATES: u32 = 40;
const FASTEST: f64 = 2.0;

/// The second harmonic of a slightly elongated body, relative to its mean radius; and the stride by which a few rates of the grid are taken.
const LONGER: f64 = 0.1;
const FEW_RATES: usize = 10;

impl WholeRecord {
    /// The measurements of an experiment between flat palms; none where one of them is missing. `sigma` is the standard deviation of a contact.
    pub fn of(experiment: &Experiment, sigma: f64) -> Option<WholeRecord> {
        let measurements = measurements(experiment)?;
        let stride = measurements.times.len().div_ceil(MOST_SAMPLES).max(1);
        let thin = |column: &[f64]| column.iter().step_by(stride).copied().collect::<Vec<f64>>();
        let names = ["a1", "a2", "w1", "w2", "b1", "b2"];
        let columns = [&measurements.angles, &measurements.rates, &measurements.accelerations];
        // palms are known at all times, also between the samples that are compared
        let columns = names.iter().zip(columns.into_iter().flatten());
        let columns = columns.map(|(name, column)| ((*name).to_owned(), column.clone())).collect();
        let palms = palmistry_observe::Signals::new(measurements.times.clone(), columns).ok()?;
        let truth = experiment.simulation.as_ref().and_then(|s| s.trajectory.moments.first());
        let mut record = WholeRecord {
            times: thin(&measurements.times),
            contacts: [thin(&measurements.contacts[0]), thin(&measurements.contacts[1])],
            palms,
            known: HashMap::new(),
            gravity: measurements.gravity,
            gyration: measurements.gyration,
            rate: known_rate(experiment),
            sigma,
            stated: sigma > 0.0,
            phi: truth.map_or(0.0, |moment| moment.phi0),
        };
        record.know_palms();
        (record.times.len() >= FEWEST_SAMPLES).then_some(record)
    }

    /// Initial values: the observer's estimate, and estimates by windows without a first guess.
    pub fn starts(&self, experiment: &Experiment, track: &TouchTrack) -> Vec<Unknowns> {
        let names = experiment.names();
        let sought = names.iter().position(|name| *name == "rho");
        let mut starts = Vec::new();
        let samples: Vec<SupportSample> = track.instants.iter().flat_map(|at| at.samples).collect();
        let rate = track
            .instants
            .get(1)
            .zip(track.instants.first())
            .map(|(second, first)| (second.orientation - first.orientation) / (second.time - first.time));
        let guess = sought.and_then(|place| experiment.question.guess.get(place)).map(|(_, value)| *value);
        starts.extend(self.start(&samples, rate, guess));
        if let Some(windows) =
            measurements(experiment).map(|measurements| self.by_windows(&measurements, experiment))
        {
            starts.extend(self.start(&windows.samples, windows.rate, windows.gyration));
        }
        starts
    }

    /// The fastest rate of a grid for a body of a radius, in rad/s, also where the rate is known.
    pub fn fastest(&self, radius: f64) -> f64 {
        let palms = self.palms_at(self.times[0]).rates;
        FASTEST * (self.gravity.abs() / radius).sqrt() + palms[0].abs().max(palms[1].abs())
    }

    /// Discs that turn at rates on a grid, for use without any estimate: a disc between palms touches both at `R/tan(a/2)`, `a` being the angle between them, and bodies
    /// that gravity turns have rates of the size of `sqrt(g/R)`.
    pub fn discs(&self) -> Vec<Unknowns> {
        let radii = self.times.iter().enumerate().map(|(i, time)| {
            let palms = self.palms_at(*time);
            let half = (palms.angles[1] - palms.angles[0]) / 2.0;
            half.tan().abs() * f64::midpoint(self.contacts[0][i], self.contacts[1][i])
        });
        let radius = radii.sum::<f64>() / self.times.len() as f64;
        let most = self.fastest(radius);
        if !(radius > 0.0 && most.is_finite()) {
            return Vec::new();
        }
        let support = SupportSeries { mean: radius, harmonics: vec![[0.0; 2]; DISC_ORDER] };
        let gyration = self.gyration.unwrap_or(radius / 2f64.sqrt());
        let rates = (0..RATES).map(|i| most * (2.0 * f64::from(i) / f64::from(RATES - 1) - 1.0));
        let rates = self.rate.map_or_else(|| rates.collect::<Vec<f64>>(), |rate| vec![rate]);
        let disc = |rate| Unknowns { rate, gyration, support: support.clone().into() };
        rates.into_iter().map(disc).collect()
    }

    /// A few slightly elongated bodies that turn at rates on the grid, for checking whether samples are near enough to each other. No force turns a disc, whatever the time between them.
    pub fn nearly_round(&self) -> Vec<Unknowns> {
        let longer = |mut disc: Unknowns| {
            let mean = disc.support.mean();
            let harmonics = vec![[0.0; 2], [LONGER * mean, 0.0]];
            disc.support = SupportSeries { mean, harmonics }.into();
            disc
        };
        self.discs().into_iter().step_by(FEW_RATES).map(longer).collect()
    }

    fn start(&self, samples: &[SupportSample], rate: Option<f64>, gyration: Option<f64>) -> Option<Unknowns> {
        let shape = fit_support(samples, SupportWeights::Relative, None)?;
        let shape = match shape.support.order() {
            ..=ORDER => shape,
            _ => fit_support(samples, SupportWeights::Relative, Some(ORDER))?,
        };
        let rate = rate.filter(|rate| rate.is_finite())?;
        // a disc's, where it is unknown
        let gyration =
            gyration.filter(|gyration| *gyration > 0.0).unwrap_or(shape.support.mean() / 2f64.sqrt());
        Some(self.unknowns(&shape, rate, gyration))
    }

    /// Windows one after the other, each estimated without a first guess, and the integrals of the measurements within.
    fn by_windows(&self, measurements: &PalmMeasurements, experiment: &Experiment) -> Windows {
        let mut found = Windows { samples: Vec::new(), rate: None, gyration: None };
        let length = experiment.scene.observer.window.max(FEWEST_SAMPLES);
        let (mut phi, mut gyrations) = (self.phi, Vec::new());
        let mut row = 0;
        while row + FEWEST_SAMPLES / 2 < measurements.times.len() {
            let rows = row..(row + length + 1).min(measurements.times.len());
            let window = measurements.rows(rows.clone());
            let Some(motion) = window.first_state().and_then(|first| {
                gyrations.push(first.gyration);
                window.motion(&first)
            }) else {
                break;
            };
            let turned = self.turned(&window.times, &motion.rates);
            found.rate = found.rate.or(motion.rates.first().copied());
            for (i, turned) in turned.iter().enumerate() {
                let palms =
                    PalmsAt { angles: [window.angles[0][i], window.angles[1][i]], ..PalmsAt::default() };
                let normals = palms.normals(phi + turned);
                let radii = motion.radii[i];
                found.samples.extend([0, 1].map(|palm: usize| SupportSample {
                    angle: normals[palm],
                    radius: radii[palm],
                    weight: 1.0,
                }));
            }
            phi += turned.last().copied().unwrap_or(0.0);
            row = rows.end - 1;
        }
        gyrations.sort_by(f64::total_cmp);
        found.gyration = gyrations.get(gyrations.len() / 2).copied();
        found
    }

    /// The integral of a rate by the trapezoidal rule, which is accurate enough for an initial value.
    fn turned(&self, times: &[f64], rates: &[f64]) -> Vec<f64> {
        let mut sum = 0.0;
        let steps = times.windows(2).zip(rates.windows(2)).map(|(time, rate)| {
            sum += (time[1] - time[0]) * f64::midpoint(rate[0], rate[1]);
            sum
        });
        std::iter::once(0.0).chain(steps).collect()
    }
}

/// The estimates of the windows.
struct Windows {
    samples: Vec<SupportSample>,
    rate: Option<f64>,
    gyration: Option<f64>,
}

/// The rate at the first sample, where the scene fixes it for the observers.
fn known_rate(experiment: &Experiment) -> Option<f64> {
    let question = &experiment.question;
    if !question.clamped.iter().any(|name| name == "omega0") {
        return None;
    }
    question.guess.iter().find(|(name, _)| name == "omega0").map(|(_, value)| *value)
}

fn measurements(experiment: &Experiment) -> Option<PalmMeasurements> {
    let rows = experiment.signals.times().len();
    let (scene, known) = (&experiment.scene, &experiment.question.known);
    palm_measurements(scene, &experiment.system, known, &experiment.signals, rows).ok()
}
