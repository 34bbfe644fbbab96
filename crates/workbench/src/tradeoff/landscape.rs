//! How well the states of a system are observable: over a plane of two coordinates, and along a line into a singularity. What that
//! means is said where the [`Scales`] are.

use dashu::rational::RBig;
use nalgebra::DMatrix;
use palmistry_lang::{Assignment, CoordinateRange, LineEnd, Point, System};
use palmistry_math::expression::{Input, NodeId, Program, Symbol};
use palmistry_math::number::{
    Arithmetic, Enclosure, Enclosures, Floats, Interval, RealNumber, rational_from_f64,
};
use palmistry_rank::observability::{
    Branch, Codistribution, Coordinate, Defined, Length, Locus, State, float_inputs, linear_solution,
};
use palmistry_rank::sweep::{DrawnStates, MeasuredRows, Scales};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Rows to look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LandscapeRows {
    /// A paper's own choice.
    Own,
    /// The full codistribution.
    Full,
}

/// Rows with their names.
pub struct PictureRows {
    /// What is measured.
    pub measured: MeasuredRows,
    /// How each is called.
    pub names: Vec<String>,
}

impl PictureRows {
    /// All Lie derivatives up to an order, or where none is given until the rank stops growing. Those that suffice at almost all states are not
    /// enough for a picture: where their rank drops others may raise it.
    ///
    /// # Errors
    /// Where there is no codistribution.
    pub fn full(system: &mut System, order: Option<usize>) -> Result<PictureRows, String> {
        let length = order.map_or(Length::UntilItStops, Length::Exactly);
        let found = Codistribution::new(system, &Assignment::new(), length)?;
        Ok(PictureRows {
            names: found.lie_derivatives.iter().map(|word| word.text(system)).collect(),
            measured: MeasuredRows { entries: found.entries(), values: Some(found.values) },
        })
    }

    /// A matrix that a paper writes down.
    pub fn own(rows: &[NodeId], columns: usize) -> PictureRows {
        PictureRows {
            names: (1..=rows.len() / columns.max(1)).map(|row| format!("row {row}")).collect(),
            measured: MeasuredRows { entries: rows.to_vec(), values: None },
        }
    }
}

/// By which scales a picture is drawn.
#[derive(Clone, Debug)]
pub struct PictureScales {
    /// The prior standard deviation of each unknown.
    pub priors: Vec<(String, f64)>,
    /// The standard deviation of the noise of each row.
    pub noise: Vec<(String, f64)>,
}

/// The standard deviations of the unknowns over their prior ones at one point, infinite where one is not observable; nothing where
/// something does not exist.
pub type Deviations = Option<Vec<f64>>;

/// How well an unknown is observable, on a grid.
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
    /// By rows from the lowest `y`: the standard deviation over the prior one, of the unknown that is shown or of the worst; infinite
    /// where it is not observable or where that cannot be decided, `None` at a pole.
    pub deviations: Vec<Option<f64>>,
    /// Of each cell which unknown is shown, by its place among all: the one that was asked for, or the worst; `None` at a pole.
    pub worst: Vec<Option<usize>>,
    /// In how many cells which unknown is shown: the one that was asked for, or the worst.
    pub shown: Vec<(String, usize)>,
    /// The scales of the numbers.
    pub scales: PictureScales,
}

/// How well unknowns are observable, along a line.
#[derive(Clone, Debug)]
pub struct Slope {
    /// Distance from the end, in the coordinate that moves; from infinity, the reciprocal of the coordinate.
    pub distance: Vec<f64>,
    /// Those that are shown: the one that was asked for, or all.
    pub names: Vec<String>,
    /// The standard deviations of these over their prior ones at each distance.
    pub values: Vec<Deviations>,
    /// The scales of the numbers.
    pub scales: PictureScales,
}

/// How well each unknown is observable as a function of a system's symbols, by some rows.
pub struct Landscape<'s> {
    system: &'s mut System,
    program: Program,
    defined: Defined,
    values: HashMap<Symbol, f64>,
    names: Vec<String>,
    rows: Vec<String>,
    scales: Scales,
}

/// Of enclosures along a line, which comes near to singular sets.
const BITS: usize = 1024;

/// Larger systems have their lines from doubles: elimination in so many bits takes a cube of the unknowns at each point.
const MOST_UNKNOWNS: usize = 24;
const MOST_OPERATIONS: usize = 200_000;

/// Of states that are drawn for the scales.
const SAMPLES: u64 = 1000;
/// The seed of these where none is given, that of all commands.
const SEED: u64 = 1;

impl<'s> Landscape<'s> {
    /// The rows at the given values; a symbol without one has the file's value, or the middle of its range, which may be a default range.
    /// The scales are those of the file's sample box, wherever the rows are evaluated.
    ///
    /// # Errors
    /// A name that is not known, or a sample box in which no state is found.
    pub fn new(system: &'s mut System, rows: PictureRows, at: &Point, seed: u64) -> Result<Self, String> {
        let mut values: HashMap<Symbol, f64> = system
            .symbols()
            .filter_map(|(symbol, info)| {
                let range = info.range.clone().or_else(|| system.default_range(symbol));
                let middle = range.map(|range| (&range.low + &range.high) / RBig::from(2));
                Some((symbol, info.default.clone().or(middle)?.to_f64().value()))
            })
            .collect();
        for (name, value) in at {
            values.insert(known(system, name)?, value.to_f64().value());
        }
        let guards = system.smooth_guards(&system.moving_fields());
        let mut mentioned = rows.measured.entries.clone();
        mentioned.extend(rows.measured.values.iter().flatten());
        mentioned.extend(guards.iter().map(|guard| guard.node));
        let locus = Locus::new(system, &Branch::default(), &BTreeMap::new(), &mentioned);
        let locus = locus.map_err(|why| why.to_string())?;
        let drawn =
            DrawnStates::new(system, &locus, &rows.measured, seed, SAMPLES).map_err(|why| why.to_string())?;
        if drawn.states.is_empty() {
            return Err("there is no state of the sample box by which it could be scaled".to_owned());
        }
        let scales = Scales::new(system, &drawn);
        let names = system.unknowns().iter().map(|symbol| system.symbol_name(*symbol).to_owned()).collect();
        // angles stay plain numbers here: a line into phi = 0 has to be exact in phi, not in its sine
        let program = Program::plain(&system.graph, &rows.measured.entries);
        let defined = Defined::new(system, &guards);
        Ok(Landscape { system, program, defined, values, names, rows: rows.names, scales })
    }

    /// The unknowns, in the order of all numbers.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The scales of all numbers.
    pub fn scales(&self) -> PictureScales {
        let with =
            |names: &[String], values: &[f64]| names.iter().cloned().zip(values.iter().copied()).collect();
        PictureScales {
            priors: with(&self.names, &self.scales.priors),
            noise: with(&self.rows, &self.scales.noise),
        }
    }

    /// The entries of the rows at some values, and how far each may be off.
    fn entries(&self, values: &HashMap<Symbol, f64>) -> Option<[DMatrix<f64>; 2]> {
        let columns = self.names.len();
        let matrix =
            |entries: &[f64]| DMatrix::from_row_slice(entries.len() / columns.max(1), columns, entries);
        let at = |symbol: Symbol| values.get(&symbol).copied().unwrap_or(f64::NAN);
        let exact = float_inputs(&self.program, at);
        let found = self.program.load(Floats).ok()?.run(&exact, &mut Vec::new()).ok()?;
        if !found.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let inputs = float_inputs(&self.program, |symbol| Interval::from_f64(at(symbol)));
        let enclosed = self.program.load(Floats::<Interval>::default()).ok();
        let enclosed = enclosed.and_then(|program| program.run(&inputs, &mut Vec::new()).ok());
        match enclosed
            .filter(|all| all.iter().all(|entry| entry.mid().is_finite() && entry.rad().is_finite()))
        {
            Some(all) => {
                let (middles, errors): (Vec<f64>, Vec<f64>) = all.iter().map(|v| (v.mid(), v.rad())).unzip();
                Some([matrix(&middles), matrix(&errors)])
            }
            // next to a pole no bound on the errors is known, so that nothing is observable for certain
            None => Some([matrix(&found), matrix(&vec![f64::INFINITY; found.len()])]),
        }
    }

    /// Whether everything exists at some values.
    fn exists(&self, values: &HashMap<Symbol, f64>) -> bool {
        if self.defined.is_always_met() {
            return true;
        }
        let coordinate = |value: &f64| rational_from_f64(*value).map(Coordinate::Number);
        let values = values.iter().filter_map(|(symbol, value)| Some((*symbol, coordinate(value)?)));
        self.defined.holds(&State { values: values.collect() })
    }

    fn deviations(&self, values: &HashMap<Symbol, f64>) -> Deviations {
        let [entries, errors] = self.entries(values).filter(|_| self.exists(values))?;
        Some(self.scales.deviations(&entries, Some(&errors)))
    }

    /// The same with enclosures, which keep their digits next to singular sets and poles, where doubles may lose theirs unnoticed.
    /// An unknown with an infinite result is not observable there, or the enclosures cannot decide it either.
    fn precise_deviations(&self, values: &HashMap<Symbol, f64>) -> Deviations {
        let mut found = self.deviations(values)?;
        if let Some(enclosed) = self.enclosed_deviations(values) {
            let told = found.iter_mut().zip(enclosed);
            told.for_each(|(own, enclosed)| *own = enclosed.unwrap_or(*own));
        }
        Some(found)
    }

    fn enclosed_deviations(&self, values: &HashMap<Symbol, f64>) -> Option<Vec<Option<f64>>> {
        if self.names.len() > MOST_UNKNOWNS || self.program.len() > MOST_OPERATIONS {
            return None;
        }
        let on = Enclosures::new(BITS);
        let mut inputs = Vec::new();
        for input in self.program.inputs() {
            // a plain program has no other inputs
            let Input::Plain(symbol) = input else { return None };
            inputs.push(on.rational(&rational_from_f64(*values.get(symbol)?)?).ok()?);
        }
        let entries = self.program.load(on).ok()?.run(&inputs, &mut Vec::new()).ok()?;
        let rows: Vec<Vec<Enclosure>> = entries.chunks(self.names.len().max(1)).map(<[_]>::to_vec).collect();
        self.scales.enclosed_deviations(&on, &rows).ok()
    }

    /// How well the unknowns are observable at points of one's own: `points` are values of the coordinates by name.
    ///
    /// # Errors
    /// A name that is not known.
    pub fn at(&self, names: &[&str], points: &[&[f64]]) -> Result<Vec<Deviations>, String> {
        self.at_each(names, points, |values| self.deviations(values))
    }

    fn at_each(
        &self,
        names: &[&str],
        points: &[&[f64]],
        deviations: impl Fn(&HashMap<Symbol, f64>) -> Deviations + Sync,
    ) -> Result<Vec<Deviations>, String> {
        let symbols: Vec<Symbol> =
            names.iter().map(|name| known(self.system, name)).collect::<Result<_, String>>()?;
        let one = |point: &&[f64]| {
            let mut values = self.values.clone();
            values.extend(symbols.iter().copied().zip(point.iter().copied()));
            deviations(&values)
        };
        Ok(points.par_iter().map(one).collect())
    }

    /// How well one unknown, or the worst, is observable over two coordinates.
    ///
    /// # Errors
    /// A name that is not known.
    pub fn map(
        &self,
        [x, y]: [CoordinateRange<f64>; 2],
        (width, height): (usize, usize),
        of: Option<&str>,
    ) -> Result<Map, String> {
        let at = |axis: &CoordinateRange<f64>, i: usize, n: usize| {
            axis.low + (axis.high - axis.low) * (i as f64 + 0.5) / n as f64
        };
        let points: Vec<[f64; 2]> = (0..width * height)
            .map(|cell| [at(&x, cell % width, width), at(&y, cell / width, height)])
            .collect();
        let points: Vec<&[f64]> = points.iter().map(|point| &point[..]).collect();
        let found = self.at(&[&x.name, &y.name], &points)?;
        let only = of.map(|name| self.place(name)).transpose()?;
        let of_cells = found.iter().map(|found| shown(found.as_ref()?, only));
        let (worst, deviations): (Vec<_>, Vec<_>) = of_cells.map(Option::unzip).unzip();
        let mut counts = vec![0; self.names.len()];
        worst.iter().flatten().for_each(|place: &usize| counts[*place] += 1);
        let shown = self.names.iter().cloned().zip(counts).filter(|(_, count)| *count > 0).collect();
        Ok(Map { x, y, width, height, deviations, worst, shown, scales: self.scales() })
    }

    fn place(&self, name: &str) -> Result<usize, String> {
        let place = self.names.iter().position(|known| known == name);
        place.ok_or_else(|| format!("'{name}' is no unknown of {}", self.system.name))
    }

    /// How well one unknown, or each of them, is observable along one coordinate, from a distance of one down to `least`.
    ///
    /// # Errors
    /// A name that is not known, or an end that does not exist.
    pub fn line(
        &mut self,
        moving: &str,
        target: LineEnd,
        (least, points): (f64, usize),
        of: Option<&str>,
    ) -> Result<Slope, String> {
        let symbol = known(self.system, moving)?;
        let only = of.map(|name| self.place(name)).transpose()?;
        let end = match target {
            LineEnd::Zero(expression) => Some(self.zero(expression, symbol)?),
            LineEnd::Infinity => None,
        };
        let distance: Vec<f64> =
            (0..points).map(|i| least.powf(i as f64 / (points.max(2) - 1) as f64)).collect();
        let places: Vec<f64> = distance.iter().map(|d| end.map_or(1.0 / d, |end| end + d)).collect();
        let points: Vec<&[f64]> = places.chunks(1).collect();
        let chosen = |all: Vec<f64>| only.map_or(all.clone(), |place| vec![all[place]]);
        let found = self.at_each(&[moving], &points, |values| self.precise_deviations(values))?;
        let values = found.into_iter().map(|found| found.map(chosen)).collect();
        let names = only.map_or(self.names.clone(), |place| vec![self.names[place].clone()]);
        Ok(Slope { distance, names, values, scales: self.scales() })
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

/// How well each unknown of a system is observable at states of one's own, by all its Lie derivatives up to `order`: the numbers of
/// its maps. A state is the values of `names`; `at` fixes other symbols. Also returns the names of the unknowns, in the order of the numbers.
///
/// # Errors
/// A name that is not known, no codistribution, or a sample box in which no state is found.
pub fn standard_deviations_at(
    system: &System,
    order: Option<usize>,
    at: &[(String, RBig)],
    names: &[&str],
    states: &[&[f64]],
) -> Result<(Vec<String>, Vec<Deviations>), String> {
    let mut system = system.clone();
    let rows = PictureRows::full(&mut system, order)?;
    let landscape = Landscape::new(&mut system, rows, &at.to_vec(), SEED)?;
    let found = landscape.at(names, states)?;
    Ok((landscape.names, found))
}

/// The unknown that is shown of all, the worst unless one is asked for, and its standard deviation.
fn shown(deviations: &[f64], only: Option<usize>) -> Option<(usize, f64)> {
    let worse = |worst: (usize, f64), next: (usize, f64)| if next.1 > worst.1 { next } else { worst };
    match only {
        Some(place) => Some((place, deviations[place])),
        None => deviations.iter().copied().enumerate().reduce(worse),
    }
}

fn known(system: &System, name: &str) -> Result<Symbol, String> {
    system.find_symbol(name).ok_or_else(|| format!("'{name}' is no symbol of {}", system.name))
}
