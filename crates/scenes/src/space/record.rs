//! Measurements as a table, for other programs and from them.

use super::measurements::{PalmAtSample, SpaceMeasurements, surface};
use super::scene::SpaceScene;
use crate::slow::derivative;
use crate::solid::FEWEST;
use miette::Diagnostic;
use palmistry_lang::ReadError;
use palmistry_observe::{FaultRules, Record, RecordError};
use std::path::Path;

/// The columns by the names that a scene may change: angle, rate and acceleration of each palm, the place of its contact along the hinge and up the palm, the motor's torque.
pub(super) const COLUMNS: [&str; 18] = [
    "phi1",
    "rate1",
    "acceleration1",
    "p1",
    "q1",
    "torque1",
    "phi2",
    "rate2",
    "acceleration2",
    "p2",
    "q2",
    "torque2",
    "phi3",
    "rate3",
    "acceleration3",
    "p3",
    "q3",
    "torque3",
];

/// Columns of a palm, and those of them that are differentiated where they are missing.
const OF_A_PALM: usize = 6;
const DIFFERENTIATED: [usize; 2] = [1, 2];

/// A palm's angle is differentiated through this many samples.
const POINTS: usize = 9;

impl SpaceMeasurements {
    /// The measurements as a table that this program and others can read.
    ///
    /// # Errors
    /// None that a simulation brings about.
    pub fn record(&self) -> Result<Record, RecordError> {
        let value = |told: &PalmAtSample, k: usize| match k {
            0 => told.angle,
            1 => told.rate,
            2 => told.acceleration,
            3 | 4 => told.place[k - 3],
            _ => told.torque,
        };
        let column = |(place, name): (usize, &&str)| {
            let of = |palms: &[PalmAtSample; 3]| value(&palms[place / OF_A_PALM], place % OF_A_PALM);
            ((*name).to_owned(), self.palms.iter().map(of).collect::<Vec<f64>>())
        };
        Record::new(self.times.clone(), COLUMNS.iter().enumerate().map(column).collect())
    }

    /// The measurements of a file. Missing rates and accelerations of palms are those of the polynomial through nine angles.
    ///
    /// # Errors
    /// The file cannot be read, lacks a column, or has a faulty row or too few.
    pub fn recorded(scene: &SpaceScene, file: &Path) -> Result<SpaceMeasurements, ReadError> {
        let name = |place: usize| scene.columns.get(COLUMNS[place]).map_or(COLUMNS[place], String::as_str);
        let is_needed = |place: &usize| !DIFFERENTIATED.contains(&(place % OF_A_PALM));
        let needed: Vec<&str> = (0..COLUMNS.len()).filter(is_needed).map(name).collect();
        let of_contacts = (0..COLUMNS.len()).filter(|place| [3, 4].contains(&(place % OF_A_PALM)));
        let resolution = of_contacts.map(|place| (name(place).to_owned(), scene.sensor.resolution)).collect();
        let rules = FaultRules { resolution, ..scene.faults.clone() };
        let found = Record::read_checked(file, &needed, &rules).map_err(|error| {
            let help = error.help().map(|help| help.to_string()).unwrap_or_default();
            let also = "columns with other names are named in [data] columns = { p1 = \"...\" }";
            scene.error_at("data", error.to_string(), format!("{help}; {also}"))
        })?;
        let times = found.record.times().to_vec();
        if times.len() < FEWEST {
            let message = format!("there are {} samples", times.len());
            return Err(scene.error_at("data", message, format!("let there be {FEWEST} and more")));
        }
        let mut columns: Vec<Vec<f64>> = Vec::with_capacity(COLUMNS.len());
        for place in 0..COLUMNS.len() {
            let told = found.record.column(name(place));
            let column = match (told, DIFFERENTIATED.contains(&(place % OF_A_PALM))) {
                (Some(told), _) => told.to_vec(),
                (None, true) => derivative(&times, &columns[place - 1], POINTS),
                // it was required
                (None, false) => Vec::new(),
            };
            if let Some(row) = column.iter().position(|value| !value.is_finite()) {
                let message = format!("{} is no finite number at {} s", name(place), times[row]);
                return Err(scene.error_at("data", message, "mend the recording, or leave that column out"));
            }
            columns.push(column);
        }
        let palm = |row: usize, i: usize| {
            let value = |k: usize| columns[OF_A_PALM * i + k][row];
            PalmAtSample {
                angle: value(0),
                rate: value(1),
                acceleration: value(2),
                place: [value(3), value(4)],
                torque: value(5),
            }
        };
        let palms: Vec<[PalmAtSample; 3]> =
            (0..times.len()).map(|row| std::array::from_fn(|i| palm(row, i))).collect();
        for (time, told) in times.iter().zip(&palms) {
            if let Some(i) = (0..3).find(|i| !surface(&scene.palms[*i]).has(told[*i].place)) {
                let message = format!("the contact with palm {} is beyond the sphere at {time} s", i + 1);
                let help = format!(
                    "{} and {} have to be within the radius from touch_point; mend the recording, or curvature and touch_point",
                    name(OF_A_PALM * i + 3),
                    name(OF_A_PALM * i + 4)
                );
                return Err(scene.error_at("data", message, help));
            }
        }
        Ok(SpaceMeasurements { times, palms })
    }
}
