//! Other states that explain the measurements as well as an estimate does: its mirror images.
//!
//! A robot's heading turned by half a turn with a negative scale moves as the robot does, and two compartments that are measured as a sum exchange their names. A search that begins near one of two such states finds that one, and nothing of the other.
//! The images are those of [`palmistry_rank::observability::mirrors`], exact and of the class that is described there; images outside the stated bounds are excluded.

use super::run::Experiment;
use palmistry_observe::Track;
use palmistry_rank::observability::{Image, mirrors};
use std::collections::HashSet;
use std::f64::consts::{PI, TAU};

/// At most this many images are named.
const MOST: usize = 4;

/// An image that is nearer than this many deviations is the same state.
const APART: f64 = 6.0;

impl Experiment {
    /// Adds the mirror images of the estimate to the remarks of a track.
    pub(super) fn name_mirrors(&self, track: &mut Track) {
        let images = match track.updates.iter().find(|update| update.is_borne_out()) {
            Some(update) => self.images(update.from, &update.estimate, &update.deviations),
            // of a filter, which has no windows, its last estimate
            None if track.updates.is_empty() && track.passes() => {
                let last = track.last().filter(|last| last.deviations.len() == last.state.len());
                last.map_or_else(Vec::new, |last| self.images(last.time, &last.state, &last.deviations))
            }
            None => return,
        };
        track.remarks.extend(images);
    }

    /// Each image of a state with its deviations, as text.
    fn images(&self, time: f64, state: &[f64], deviations: &[f64]) -> Vec<String> {
        let names = self.names();
        let free: HashSet<_> = names.iter().filter_map(|name| self.system.find_symbol(name)).collect();
        let mut system = self.system.clone();
        // an output that ties signals is not measured: it might distinguish the images
        if !system.zero_outputs().is_empty() {
            return Vec::new();
        }
        system.outputs.retain(|(name, _)| self.signals.find(name).is_some());
        let Ok(mirrors) = mirrors(&system, &free) else { return Vec::new() };
        let in_words = |mirror: &palmistry_rank::observability::Mirror| {
            let (mut image, mut excluding) = (Vec::new(), Vec::new());
            let mut is_other = false;
            for (symbol, turned) in &mirror.of {
                let name = system.symbol_name(*symbol);
                let place = names.iter().position(|own| *own == name)?;
                let value = state[place];
                let mut deviation = deviations[place];
                let mut middle = 0.0;
                let turned = match turned {
                    Image::Negative => -value,
                    Image::HalfTurn => value + PI,
                    Image::Supplement => PI - value,
                    Image::Other { symbol, is_negative } => {
                        let name = system.symbol_name(*symbol);
                        let other = names.iter().position(|own| *own == name)?;
                        deviation = deviation.hypot(deviations[other]);
                        let turned = if *is_negative { -state[other] } else { state[other] };
                        middle = f64::midpoint(value, turned);
                        turned
                    }
                };
                let is_angle = system.is_angle(*symbol);
                let near = if is_angle { turned - ((turned - value) / TAU).round() * TAU } else { turned };
                let differs = (near - value).abs() > APART * deviation;
                is_other |= differs;
                // an angle is named between minus and plus a half turn, unless its bounds are elsewhere
                let first = (turned + PI).rem_euclid(TAU) - PI;
                let ways = if is_angle { vec![first, first - TAU, first + TAU] } else { vec![turned] };
                let named = ways.into_iter().find(|way| self.is_within(name, *way))?;
                image.push(format!("{name} = {named:.6}"));
                if !is_angle && differs {
                    let side = if value > middle { ">" } else { "<" };
                    excluding.push(match middle {
                        0.0 => format!("{name} {side} 0"),
                        middle => format!("{name} {side} {middle:.6}"),
                    });
                }
            }
            let exclude = match excluding.as_slice() {
                [] => "no sign of a state distinguishes them".to_owned(),
                all => format!("a bound that says {} excludes it", all.join(" or ")),
            };
            is_other.then(|| {
                format!(
                    "at {time:.3} s {} explains the same measurements, by a symmetry of the equations: {exclude}",
                    image.join(", ")
                )
            })
        };
        let mut images: Vec<String> = mirrors.iter().filter_map(in_words).collect();
        // three unknowns that exchange their values have five
        let more = images.len().saturating_sub(MOST);
        images.truncate(MOST);
        if more > 0 {
            images.push(format!("and {more} more such images, which are not named"));
        }
        images
    }

    /// Whether a value is one that the scene allows.
    fn is_within(&self, name: &str, value: f64) -> bool {
        let bounds = self.scene.observer.bounds.get(name);
        bounds.is_none_or(|[low, high]| (*low..=*high).contains(&value))
    }
}
