//! Profile likelihoods: how far each parameter could be moved, all others being fitted anew.
//!
//! Reference: A. Raue et al., Structural and practical identifiability analysis of partially observed dynamical models by exploiting the
//! profile likelihood, Bioinformatics 25, 2009.

use super::ends::StartEnd;
use super::likelihood::Likelihood;
use super::search::{ALLOWED, search};
use super::simulate::Exactness;

/// A step along a profile is chosen to change the logarithm of the likelihood by about this.
const WANTED: f64 = 0.3;

/// So many points a side at most.
const POINTS: usize = 40;

/// Steps of a search at a point.
const STEPS: u64 = 50;

/// The profile of a parameter, on its scale.
#[derive(Clone, Debug)]
pub struct ParameterProfile {
    /// The parameter, by its place.
    pub parameter: usize,
    /// Places of the parameter, increasing, with minus the logarithm of the likelihood over the least one known.
    pub points: Vec<[f64; 2]>,
    /// The ends of the interval of 95 %; none where the likelihood does not fall enough before the bound, or where the profile was cut off.
    pub interval: [Option<f64>; 2],
    /// Whether a side was cut off before it came to an end.
    pub cut_off: [bool; 2],
    /// By how much minus the logarithm of the likelihood was lower at a better optimum on the way; zero where none was met.
    pub better: f64,
}

/// The profile of a parameter from the best parameters that are known.
pub fn profile(
    likelihood: &Likelihood,
    best: &[f64],
    objective: f64,
    parameter: usize,
    deviation: f64,
    interrupted: &(dyn Fn() -> bool + Sync),
) -> ParameterProfile {
    let [low, high] = likelihood.problem().parameters[parameter].scaled_bounds();
    let first = match deviation.is_finite() && deviation > 0.0 {
        true => (0.5 * deviation).min((high - low) / 8.0),
        false => (high - low) / 40.0,
    };
    let mut found = ParameterProfile {
        parameter,
        points: vec![[best[parameter], 0.0]],
        interval: [None; 2],
        cut_off: [false; 2],
        better: 0.0,
    };
    for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
        let end = if side == 0 { low } else { high };
        let mut place = best.to_vec();
        let (mut step, mut last) = (first, 0.0);
        let mut own = Vec::new();
        loop {
            let left = (end - place[parameter]).abs();
            if left <= 1e-9 * (high - low) {
                break;
            }
            if own.len() >= POINTS || interrupted() {
                found.cut_off[side] = true;
                break;
            }
            let mut start = place.clone();
            start[parameter] = if step >= left { end } else { place[parameter] + sign * step };
            let reached = likelihood.at(&start, Exactness::Answer, &|| interrupted()).ok().map(|here| {
                search(
                    likelihood,
                    &start,
                    Some(here),
                    &[parameter],
                    (STEPS, Exactness::Answer, None),
                    interrupted,
                )
            });
            let Some(reached) = reached.filter(|reached| reached.end != StartEnd::Interrupted) else {
                step /= 4.0;
                if step < 1e-6 * first {
                    found.cut_off[side] = true;
                    break;
                }
                continue;
            };
            let over = reached.objective - objective;
            // a leap over the end of the interval is made again, shorter
            if over - last > 6.0 * WANTED && step > 1e-6 * first && last < ALLOWED {
                step /= 3.0;
                continue;
            }
            own.push([start[parameter], over]);
            found.better = found.better.max(-over);
            if over >= ALLOWED {
                let [from, to] = [place[parameter], start[parameter]];
                found.interval[side] = Some(from + (to - from) * (ALLOWED - last) / (over - last));
                break;
            }
            let change = (over - last).abs();
            step *= if change < 0.5 * WANTED {
                2.0
            } else if change > 2.0 * WANTED {
                0.6
            } else {
                1.0
            };
            (place, last) = (reached.found, over);
        }
        found.points.extend(own);
    }
    found.points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    found
}
