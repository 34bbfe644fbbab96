//! A reconstruction as tables for other programs.

use super::super::recovered::{Reconstruction, WholeSample};
use super::super::run::{Answer, Experiment};
use palmistry_observe::{Record, RecordError};
use std::f64::consts::TAU;

/// The first column of an outline's table, in rad.
const ANGLE: &str = "angle";

/// Normals in the table of an outline: every half of a degree.
const NORMALS: usize = 720;

impl Reconstruction {
    /// The outline, a row a normal: its `angle` (rad, in the body's frame), the support radius `r`, `band` (two standard deviations where it was touched; in a gap the width that convexity leaves, infinite in one of half a turn and more), the point `x`, `y` of the outline in the
    /// frame of the body, its `radius_of_curvature`, and whether the normal was `touched` (1 or 0). SI units. None where no shape was estimated.
    pub fn outline_table(&self) -> Option<Result<Record, RecordError>> {
        let shape = self.shape.as_ref()?;
        let angles: Vec<f64> = (0..NORMALS).map(|i| TAU * i as f64 / NORMALS as f64).collect();
        let column = |name: &str, value: &dyn Fn(f64) -> f64| {
            (name.to_owned(), angles.iter().map(|angle| value(*angle)).collect())
        };
        let columns = vec![
            column("r", &|angle| shape.support.support(angle)[0]),
            column("band", &|angle| shape.band(&self.coverage, angle)),
            column("x", &|angle| shape.support.point(angle)[0]),
            column("y", &|angle| shape.support.point(angle)[1]),
            column("radius_of_curvature", &|angle| shape.support.radius_of_curvature(angle)),
            column("touched", &|angle| f64::from(u8::from(self.coverage.contains(angle)))),
        ];
        Some(Record::over(ANGLE, angles.clone(), columns))
    }
}

impl Experiment {
    /// The estimates sample by sample: each estimated state of an answer with its bound (`r1`, `r1_bound`, ...), whether the body was observed (`seen`, 1 or 0), and, where there is a batch
    /// estimate of all measurements, that motion with its bounds (`whole_phi0`, `whole_omega0`, `whole_r1`, `whole_r2`) and centre of mass. A bound is a standard deviation. Those of an
    /// answer are its window's, carried along the flow to each sample, or a filter's own; where there is none they are not a number.
    ///
    /// # Errors
    /// None that an experiment could bring about.
    pub fn track_table(
        &self,
        answer: &Answer,
        reconstruction: Option<&Reconstruction>,
    ) -> Result<Record, RecordError> {
        let (track, names) = (&answer.track, self.names());
        let times: Vec<f64> = track.estimates.iter().map(|moment| moment.time).collect();
        let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
        for (place, name) in names.iter().enumerate() {
            let bounds =
                track.estimates.iter().map(|at| at.deviations.get(place).copied().unwrap_or(f64::NAN));
            columns.push(((*name).to_owned(), track.estimates.iter().map(|at| at.state[place]).collect()));
            columns.push((format!("{name}_bound"), bounds.collect()));
        }
        let seen = track.estimates.iter();
        let seen = seen.map(|at| f64::from(u8::from(track.updates.is_empty() || !at.residual.is_empty())));
        columns.push(("observed".to_owned(), seen.collect()));
        if let Some(reconstruction) = reconstruction {
            let orientation =
                reconstruction.track.instants.iter().map(|at| at.orientation).collect::<Vec<f64>>();
            if orientation.len() == times.len() && reconstruction.track.method == answer.method {
                columns.push(("orientation".to_owned(), orientation));
            }
            if let Some(whole) = &reconstruction.whole {
                // a long record is thinned out: there are no values at the samples between
                let at = |time: f64| {
                    let place = whole.samples.binary_search_by(|sample| sample.time.total_cmp(&time)).ok()?;
                    whole.samples.get(place)
                };
                let mut add = |name: &str, value: &dyn Fn(&WholeSample) -> f64| {
                    let values = times.iter().map(|time| at(*time).map_or(f64::NAN, value));
                    columns.push((format!("whole_{name}"), values.collect()));
                };
                add("phi0", &|at| at.phi0.value);
                add("phi0_bound", &|at| at.phi0.deviation);
                add("omega0", &|at| at.omega0.value);
                add("omega0_bound", &|at| at.omega0.deviation);
                add("r1", &|at| at.radii[0].value);
                add("r1_bound", &|at| at.radii[0].deviation);
                add("r2", &|at| at.radii[1].value);
                add("r2_bound", &|at| at.radii[1].deviation);
                add("x", &|at| at.centre[0]);
                add("y", &|at| at.centre[1]);
            }
        }
        Record::new(times, columns)
    }
}
