//! Singular values over a plane of two coordinates, and along a line into a singularity.

use crate::expression::{NodeId, Program, Symbol};
use crate::number::Floats;
use crate::observability::{Reduction, float_inputs, linear_solution, singular_values};
use crate::system::{CoordinateRange, LineEnd, Point, System};
use dashu::rational::RBig;
use rayon::prelude::*;
use std::collections::HashMap;

/// Rows to look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LandscapeRows {
    /// A paper's own choice.
    Own,
    /// The full codistribution.
    Full,
}

/// The smallest singular value on a grid.
#[derive(Clone, Debug)]
pub struct Map {
    /// The coordinate to the right.
    pub x: CoordinateRange<f64>,
    /// The coordinate upwards.
    pub y: CoordinateRange<f64>,
    /// How many cells it has in a row.
    pub width: usize,
    /// How many rows it has.
    pub height: usize,
    /// By rows from the lowest `y`; `None` at a pole.
    pub smallest: Vec<Option<f64>>,
}

/// All singular values along a line.
#[derive(Clone, Debug)]
pub struct Slope {
    /// Distance from the end, in the coordinate that moves; from infinity, the reciprocal of the coordinate.
    pub distance: Vec<f64>,
    /// The singular values at each distance, in descending order; empty at a pole.
    pub values: Vec<Vec<f64>>,
}

/// Some rows of a system as a function of its symbols, less the unit rows and their columns.
pub struct Landscape<'s> {
    system: &'s mut System,
    program: Program,
    values: HashMap<Symbol, f64>,
    columns: usize,
}

impl<'s> Landscape<'s> {
    /// The rows at the given values; what is not given has the file's value, or the middle of its range.
    ///
    /// # Errors
    /// A name that is not known.
    pub fn new(system: &'s mut System, rows: &[NodeId], at: &Point) -> Result<Self, String> {
        let mut values: HashMap<Symbol, f64> = system
            .symbols()
            .filter_map(|(symbol, info)| {
                let middle = info.range.as_ref().map(|range| (&range.low + &range.high) / RBig::from(2));
                Some((symbol, info.default.clone().or(middle)?.to_f64().value()))
            })
            .collect();
        for (name, value) in at {
            values.insert(known(system, name)?, value.to_f64().value());
        }
        // angles stay plain numbers here: a line into phi = 0 has to be exact in phi, not in its sine
        let reduced = Reduction::new(&system.graph, rows, system.unknown_count());
        let program = Program::plain(&system.graph, &reduced.entries);
        Ok(Landscape { system, program, values, columns: reduced.columns.len() })
    }

    fn spectrum(&self, values: &HashMap<Symbol, f64>) -> Option<Vec<f64>> {
        let inputs = float_inputs(&self.program, |symbol| values.get(&symbol).copied().unwrap_or(f64::NAN));
        let entries = self.program.load(Floats).ok()?.run(&inputs, &mut Vec::new()).ok()?;
        Some(singular_values(&entries, &vec![0.0; entries.len()], self.columns)?.values)
    }

    /// The smallest singular value over two coordinates.
    ///
    /// # Errors
    /// A name that is not known.
    pub fn map(
        &self,
        x: CoordinateRange<f64>,
        y: CoordinateRange<f64>,
        width: usize,
        height: usize,
    ) -> Result<Map, String> {
        let (sx, sy) = (known(self.system, &x.name)?, known(self.system, &y.name)?);
        let at = |axis: &CoordinateRange<f64>, i: usize, n: usize| {
            axis.low + (axis.high - axis.low) * (i as f64 + 0.5) / n as f64
        };
        let smallest = (0..width * height)
            .into_par_iter()
            .map(|cell| {
                let mut values = self.values.clone();
                values.insert(sx, at(&x, cell % width, width));
                values.insert(sy, at(&y, cell / width, height));
                self.spectrum(&values)?.last().copied()
            })
            .collect();
        Ok(Map { x, y, width, height, smallest })
    }

    /// The singular values on a line along one coordinate, from a distance of one down to `least`.
    ///
    /// # Errors
    /// A name that is not known, or an end that does not exist.
    pub fn line(
        &mut self,
        moving: &str,
        target: LineEnd,
        least: f64,
        points: usize,
    ) -> Result<Slope, String> {
        let symbol = known(self.system, moving)?;
        let end = match target {
            LineEnd::Zero(expression) => Some(self.zero(expression, symbol)?),
            LineEnd::Infinity => None,
        };
        let distance: Vec<f64> =
            (0..points).map(|i| least.powf(i as f64 / (points.max(2) - 1) as f64)).collect();
        let values = distance
            .iter()
            .map(|d| {
                let mut values = self.values.clone();
                values.insert(symbol, end.map_or(1.0 / d, |end| end + d));
                self.spectrum(&values).unwrap_or_default()
            })
            .collect();
        Ok(Slope { distance, values })
    }

    /// The value of a symbol at which an expression that is linear in it vanishes.
    fn zero(&mut self, expression: NodeId, symbol: Symbol) -> Result<f64, String> {
        let root = linear_solution(self.system, expression, symbol).ok_or_else(|| {
            let text = self.system.graph.text(expression);
            format!("'{text}' is not linear in {}", self.system.symbol_name(symbol))
        })?;
        let program = Program::plain(&self.system.graph, &[root]);
        let inputs = float_inputs(&program, |s| self.values.get(&s).copied().unwrap_or(f64::NAN));
        let run = program.load(Floats).map_err(|r| r.to_string())?.run(&inputs, &mut Vec::new());
        run.map(|values| values[0]).map_err(|failure| failure.refusal.to_string())
    }
}

fn known(system: &System, name: &str) -> Result<Symbol, String> {
    system.find_symbol(name).ok_or_else(|| format!("'{name}' is no symbol of {}", system.name))
}
