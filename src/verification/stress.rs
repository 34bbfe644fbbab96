//! The extremes of the thesis's regimes: every singular set and pole of [`REGIMES`], and what that table cannot say.

use super::dimensions::{UNIT_SYSTEMS, dimension};
use super::regimes::{REGIMES, Regime};
use crate::expression::Symbol;
use crate::system::System;
use crate::tradeoff::Rows;
use crate::tradeoff::stress::{Approach, Quantity, Rescaling, Stress, StressOptions, Study, rows_of};
use dashu::rational::RBig;
use std::sync::atomic::AtomicBool;

/// Sets beyond those at which `verify` decides ranks: file, title, condition.
const MORE: [(&str, &str, &str); 6] = [
    ("general.proof", "palm 2 at rest", "omega2 = -omega1"),
    ("general.proof", "contact 2 at the joint", "s2 = 0"),
    ("same_rate.proof", "contact 1 at the joint", "s1 = 0"),
    ("one_palm_fixed.proof", "contact 1 at the joint", "s1 = 0"),
    ("fixed_palms.proof", "contact 2 at the joint", "s2 = 0"),
    ("fixed_palms.proof", "the radius of gyration zero", "rho = 0"),
];

/// Files in which the radius of gyration has an effect.
const WITH_GYRATION: [&str; 2] = ["general.proof", "fixed_palms.proof"];

/// A short version, for the page that `verify` writes: one line a set, a point for every five halvings, and so many
/// states of the box and of each set.
const SHORT: (u64, usize, u64, u64) = (1, 5, 40, 2);

fn approaches(regime: &Regime) -> Vec<Approach> {
    let set = |title: &str, conditions: &[&str]| Approach::Set {
        title: title.to_owned(),
        conditions: conditions.iter().map(|text| (*text).to_owned()).collect(),
    };
    let mut found: Vec<Approach> = regime.sets.iter().map(|s| set(s.title, s.conditions)).collect();
    let more = MORE.iter().filter(|(file, _, _)| *file == regime.file);
    found.extend(more.map(|(_, title, condition)| set(title, &[condition])));
    if WITH_GYRATION.contains(&regime.file) {
        let title = "the radius of gyration infinite".to_owned();
        found.push(Approach::Infinity { title, symbol: "rho".to_owned() });
    }
    found
}

/// The symbols of a system with a dimension, and what becomes of them where a unit changes.
fn dimensioned(system: &System) -> impl Iterator<Item = (Symbol, [i32; 3])> {
    system.symbols().filter_map(|(symbol, _)| Some((symbol, dimension(system.symbol_name(symbol))?)))
}

fn units(system: &System) -> Vec<(String, Rescaling)> {
    let ten = RBig::from(10);
    let other = |exponents: [i32; 3]| {
        let factors = dimensioned(system).map(|(symbol, powers)| {
            let exponent: i32 = powers.iter().zip(exponents).map(|(power, exponent)| power * exponent).sum();
            (symbol, ten.pow(exponent as isize))
        });
        Rescaling::Symbols(factors.collect())
    };
    UNIT_SYSTEMS.iter().map(|(name, exponents)| ((*name).to_owned(), other(*exponents))).collect()
}

fn unit_quantities(system: &System) -> Vec<Quantity> {
    let unit = |(place, name): (usize, &str)| Quantity {
        name: format!("the unit of {name}"),
        powers: dimensioned(system)
            .map(|(symbol, powers)| (symbol, powers[place]))
            .filter(|(_, power)| *power != 0)
            .collect(),
    };
    ["length", "mass", "time"].into_iter().enumerate().map(unit).collect()
}

/// Prepares the regimes, given in the order of [`REGIMES`].
///
/// # Errors
/// In words, with the file.
pub fn prepare_regimes(
    systems: &[System],
    wanted: Rows,
    options: &StressOptions<'_>,
) -> Result<Vec<Stress>, String> {
    let prepare = |(regime, system): (&Regime, &System)| {
        let mut system = system.clone();
        let (name, rows) = rows_of(&mut system, wanted)?;
        let (units, quantities) = (units(&system), unit_quantities(&system));
        let (name, rows) = (name.as_str(), rows.as_slice());
        Stress::prepare(&mut system, (name, rows), &approaches(regime), quantities, units, options)
    };
    let named = |(regime, system)| prepare((regime, system)).map_err(|why| format!("{}: {why}", regime.file));
    REGIMES.iter().zip(systems).map(named).collect()
}

/// The short version of the regimes' extremes, given in the order of [`REGIMES`].
///
/// # Errors
/// As [`prepare_regimes`].
pub fn short_stress(systems: &[System], seed: u64, interrupt: &AtomicBool) -> Result<Vec<Study>, String> {
    let (states, step, samples, samples_on_sets) = SHORT;
    let options = StressOptions { seed, states, step, samples, samples_on_sets, interrupt, progress: &|| () };
    let prepared = prepare_regimes(systems, Rows::Own, &options)?;
    Ok(prepared.iter().map(|stress| stress.run(&options)).collect())
}
