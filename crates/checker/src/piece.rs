//! A listing on a box: plain interval arithmetic, outward rounding, with the slopes by the sides of the box.
//!
//! An entry's values lie in its enclosure and, by the mean value theorem, in the value in the middle and the slopes times
//! the distances from there. The rows are multiplied by the inverse of their matrix in the middle, as doubles find it
//! (any matrix would do): where in the product, its columns scaled, the diagonal outweighs the rest of every row, no matrix
//! of the box is singular. Neumaier, Interval Methods for Systems of Equations, 1990, sections 3.7 and 4.1.

use super::listing::{Listing, Step};
use super::witness::{Requirement, RequirementKind};
use palmistry_math::number::{Function, Interval, RealNumber};

/// Where a step's value comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// A side of the box.
    Side(usize),
    /// A symbol that is fixed.
    Held(Interval),
    Operation,
}

/// A listing, ready to be evaluated on boxes.
pub(super) struct Cover<'c> {
    listing: &'c Listing,
    sources: Vec<Source>,
    sides: usize,
}

/// The steps that some others need, in order.
pub(super) struct Needed {
    steps: Vec<usize>,
    sides: usize,
}

impl Needed {
    /// The work of a piece, in operations.
    pub fn cost(&self) -> u64 {
        (self.steps.len() * (2 + self.sides)) as u64
    }
}

/// What has come of a piece.
pub(super) enum Piece {
    Shown,
    /// A requirement is met at none of its states.
    Missing {
        requirement: usize,
    },
    /// Not shown; the side that matters most, where one can be divided.
    Open {
        steepest: Option<usize>,
    },
}

/// Values of the steps, and for each step its slopes by the sides; `None` where a step may have no value.
struct Values {
    values: Vec<Option<Interval>>,
    slopes: Vec<Interval>,
}

/// Whether slopes are wanted.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Order {
    Values,
    Slopes,
}

impl<'c> Cover<'c> {
    /// Prepares a listing; `side` and `held` say what a symbol is. `None` where a symbol is neither.
    pub fn new(
        listing: &'c Listing,
        sides: usize,
        side: impl Fn(&str) -> Option<usize>,
        held: impl Fn(&str) -> Option<Interval>,
    ) -> Option<Cover<'c>> {
        let source = |step: &Step| match step {
            Step::Symbol(name) => side(name).map(Source::Side).or_else(|| held(name).map(Source::Held)),
            _ => Some(Source::Operation),
        };
        let sources = listing.steps().iter().map(source).collect::<Option<Vec<_>>>()?;
        Some(Cover { listing, sources, sides })
    }

    /// All steps that some places need.
    pub fn needed<'p>(&self, places: impl Iterator<Item = &'p usize>) -> Needed {
        let steps = self.listing.steps();
        let mut wanted = vec![false; steps.len()];
        places.for_each(|place| wanted[*place] = true);
        for place in (0..steps.len()).rev().filter(|place| *place < steps.len()) {
            if wanted[place] {
                steps[place].operands().for_each(|operand| wanted[operand] = true);
            }
        }
        Needed { steps: (0..steps.len()).filter(|place| wanted[*place]).collect(), sides: self.sides }
    }

    /// The values of the needed steps on a box.
    fn values(&self, needed: &Needed, sides: &[Interval], order: Order) -> Values {
        let count = self.listing.steps().len();
        let width = if order == Order::Slopes { self.sides } else { 0 };
        let mut found = Values { values: vec![None; count], slopes: vec![Interval::ZERO; count * width] };
        for place in needed.steps.iter().copied() {
            let step = &self.listing.steps()[place];
            let value = match self.sources[place] {
                Source::Side(side) => sides.get(side).copied(),
                Source::Held(value) => Some(value),
                Source::Operation => found.operation(step),
            };
            found.values[place] = value;
            for side in 0..width {
                let slope = match self.sources[place] {
                    Source::Side(own) if own == side => Interval::ONE,
                    Source::Operation => found.slope(step, place, side, width),
                    _ => Interval::ZERO,
                };
                found.slopes[place * width + side] = slope;
            }
        }
        found
    }

    /// Whether requirements are met and a determinant differs from zero all over a piece.
    pub fn piece(
        &self,
        needed: &Needed,
        sides: &[Interval],
        minor: &[&[usize]],
        requirements: &[Requirement],
    ) -> Piece {
        let all = self.values(needed, sides, Order::Slopes);
        let middle: Vec<Interval> = sides.iter().map(|side| Interval::point(side.mid())).collect();
        let distances: Vec<Interval> = sides.iter().zip(&middle).map(|(side, mid)| *side - *mid).collect();
        let centre = self.values(needed, &middle, Order::Values);
        let by_slopes = |place: usize| -> Option<Interval> {
            let change =
                |(side, distance): (usize, &Interval)| all.slopes[place * self.sides + side] * *distance;
            let value = centre.values[place]?;
            Some(distances.iter().enumerate().map(change).fold(value, |sum, part| sum + part))
        };
        for (index, requirement) in requirements.iter().enumerate() {
            let plain = all.values[requirement.step];
            let met = |value: Interval| is_met(requirement.kind, value);
            if plain.and_then(met) == Some(false) {
                return Piece::Missing { requirement: index };
            }
            // the mean value theorem is one about functions that have values on all of the piece
            let shown = plain.and_then(met) == Some(true)
                || plain.is_some() && by_slopes(requirement.step).and_then(met) == Some(true);
            if !shown {
                let influence = |side: usize| {
                    all.slopes[requirement.step * self.sides + side].magnitude() * distances[side].magnitude()
                };
                return Piece::Open { steepest: steepest(sides, influence) };
            }
        }
        let open = |influence: &dyn Fn(usize) -> f64| Piece::Open { steepest: steepest(sides, influence) };
        if minor.iter().copied().flatten().any(|place| all.values[*place].is_none()) {
            return open(&|_| f64::NAN);
        }
        let minor = without_single_entries(minor, &all.values);
        let entry = |place: usize| centre.values[place].map(Interval::mid);
        let doubles: Option<Vec<Vec<f64>>> =
            minor.iter().map(|row| row.iter().map(|place| entry(*place)).collect()).collect();
        let Some(inverse) = doubles.and_then(inverse) else { return open(&|_| f64::NAN) };
        let n = minor.len();
        let mut influences = vec![0.0; self.sides];
        let mut product = vec![vec![Interval::WHOLE; n]; n];
        for (weights, row_of_product) in inverse.iter().zip(&mut product) {
            for (j, entry_of_product) in row_of_product.iter_mut().enumerate() {
                // what the rows have in common cancels in the combination, before anything is widened
                let combined = |value: &dyn Fn(usize) -> Interval| {
                    let parts = weights
                        .iter()
                        .zip(&minor)
                        .map(|(weight, row)| Interval::point(*weight) * value(row[j]));
                    parts.fold(Interval::ZERO, |sum, part| sum + part)
                };
                let known = |value: Option<Interval>| value.unwrap_or(Interval::WHOLE);
                let plain = combined(&|place| known(all.values[place]));
                let mut by_slopes = combined(&|place| known(centre.values[place]));
                for (side, distance) in distances.iter().enumerate() {
                    let change = combined(&|place| all.slopes[place * self.sides + side]) * *distance;
                    influences[side] += change.magnitude();
                    by_slopes += change;
                }
                *entry_of_product = plain.intersection(by_slopes).unwrap_or(Interval::WHOLE);
            }
        }
        let regular = is_regular(&product);
        if regular { Piece::Shown } else { open(&|side| influences[side]) }
    }
}

impl Values {
    /// The value of an operation; `None` where it may have none.
    fn operation(&self, step: &Step) -> Option<Interval> {
        let at = |place: usize| self.values[place];
        match *step {
            Step::Constant(ref value) => Some(Interval::from_rational(value)),
            Step::Pi => Some(Interval::PI),
            Step::Symbol(_) => None,
            Step::Add(a, b) => Some(at(a)? + at(b)?),
            Step::Sub(a, b) => Some(at(a)? - at(b)?),
            Step::Mul(a, b) => Some(at(a)? * at(b)?),
            Step::Div(a, b) => Some(at(a)? / at(b).filter(|b| !b.contains_zero())?),
            Step::Neg(a) => Some(-at(a)?),
            Step::Power(a, n) => {
                let power = at(a)?.pow(n.unsigned_abs());
                if n >= 0 {
                    return Some(power);
                }
                at(a).filter(|a| !a.contains_zero())?;
                Some(Interval::ONE / power)
            }
            Step::Apply(function, a) => at(a)?.image(function),
        }
    }

    /// The slope of an operation by a side; the whole line where nothing is known.
    fn slope(&self, step: &Step, place: usize, side: usize, width: usize) -> Interval {
        let of = |place: usize| self.slopes[place * width + side];
        let at = |place: usize| self.values[place].unwrap_or(Interval::WHOLE);
        match *step {
            Step::Constant(_) | Step::Pi | Step::Symbol(_) => Interval::ZERO,
            Step::Add(a, b) => of(a) + of(b),
            Step::Sub(a, b) => of(a) - of(b),
            Step::Mul(a, b) => of(a) * at(b) + at(a) * of(b),
            Step::Div(a, b) => (of(a) - at(place) * of(b)) / at(b),
            Step::Neg(a) => -of(a),
            Step::Power(_, 0) => Interval::ZERO,
            Step::Power(a, n) if n > 0 => {
                Interval::point(f64::from(n)) * at(a).pow(n.unsigned_abs() - 1) * of(a)
            }
            // a^n = 1/a^|n|: its slope is n a^n/a times that of a
            Step::Power(a, n) => Interval::point(f64::from(n)) * at(place) / at(a) * of(a),
            Step::Apply(function, a) => rate(function, at(a), at(place)) * of(a),
        }
    }
}

/// The derivative of a function, from its argument and its value.
fn rate(function: Function, a: Interval, value: Interval) -> Interval {
    let root = || (Interval::ONE - a.sqr()).image(Function::Sqrt).unwrap_or(Interval::WHOLE);
    match function {
        Function::Sin => a.sin_cos().1,
        Function::Cos => -a.sin_cos().0,
        Function::Exp => value,
        Function::Log => Interval::ONE / a,
        Function::Sqrt => Interval::ONE / (value + value),
        Function::Atan => Interval::ONE / (Interval::ONE + a.sqr()),
        Function::Asin => Interval::ONE / root(),
        Function::Acos => -(Interval::ONE / root()),
    }
}

/// A matrix without the rows that have one entry only which is not zero, and without the columns of these, again and again:
/// the determinant is the product of these entries and of what remains. Empty where nothing remains.
fn without_single_entries(minor: &[&[usize]], values: &[Option<Interval>]) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = minor.iter().map(|row| row.to_vec()).collect();
    let is_zero = |place: &usize| values[*place] == Some(Interval::ZERO);
    let excludes_zero = |place: &usize| values[*place].is_some_and(|value| !value.contains_zero());
    loop {
        let single = rows.iter().enumerate().find_map(|(at, row)| {
            let mut filled = (0..row.len()).filter(|column| !is_zero(&row[*column]));
            match (filled.next(), filled.next()) {
                (Some(column), None) if excludes_zero(&row[column]) => Some((at, column)),
                _ => None,
            }
        });
        let Some((at, column)) = single else { return rows };
        rows.remove(at);
        for row in &mut rows {
            row.remove(column);
        }
    }
}

/// Whether no matrix between the bounds is singular: with its columns multiplied by some positive numbers the diagonal
/// outweighs the rest of every row. The numbers are guessed by doubles, and any would do.
fn is_regular(matrix: &[Vec<Interval>]) -> bool {
    let n = matrix.len();
    let comparison = |i: usize, j: usize| {
        if i == j { matrix[i][j].mignitude() } else { -matrix[i][j].magnitude() }
    };
    let doubles = (0..n).map(|i| (0..n).map(|j| comparison(i, j)).collect()).collect();
    let Some(guess) = inverse(doubles) else { return false };
    let weights: Vec<f64> = guess.iter().map(|row| row.iter().sum()).collect();
    let positive = weights.iter().all(|weight| weight.is_finite() && *weight > 0.0);
    let outweighs = |i: usize| {
        let weighted = |j: usize| Interval::point(comparison(i, j).abs()) * Interval::point(weights[j]);
        let rest = (0..n).filter(|j| *j != i).fold(Interval::ZERO, |sum, j| sum + weighted(j));
        weighted(i).low() > rest.high()
    };
    positive && (0..n).all(outweighs)
}

/// Whether all values of an interval meet a requirement, or none does.
fn is_met(kind: RequirementKind, value: Interval) -> Option<bool> {
    let (low, high) = (value.low(), value.high());
    let (all, none) = match kind {
        RequirementKind::NotZero => (low > 0.0 || high < 0.0, low == 0.0 && high == 0.0),
        RequirementKind::Positive => (low > 0.0, high <= 0.0),
        RequirementKind::NotNegative => (low >= 0.0, high < 0.0),
        RequirementKind::WithinOne => (low >= -1.0 && high <= 1.0, low > 1.0 || high < -1.0),
        RequirementKind::InsideOne => (low > -1.0 && high < 1.0, low >= 1.0 || high <= -1.0),
    };
    if all { Some(true) } else { none.then_some(false) }
}

/// The side that matters most among those that can be divided; the longest where nothing is known of what they matter.
fn steepest(sides: &[Interval], influence: impl Fn(usize) -> f64) -> Option<usize> {
    let divisible = |side: &usize| {
        let (low, high) = sides[*side].split();
        low.high() > low.low() && high.high() > high.low()
    };
    let known = (0..sides.len()).all(|side| influence(side).is_finite());
    let weight = |side: usize| if known { influence(side) } else { sides[side].width() };
    (0..sides.len())
        .filter(divisible)
        .reduce(|best, side| if weight(side) > weight(best) { side } else { best })
}

/// The inverse of a matrix of doubles, row by row, by elimination with the largest pivots; nothing is claimed of how near
/// it is. `None` where a pivot is zero or no number.
fn inverse(mut matrix: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    for (place, row) in matrix.iter_mut().enumerate() {
        row.extend((0..n).map(|column| if column == place { 1.0 } else { 0.0 }));
    }
    for step in 0..n {
        let pivot = (step..n).max_by(|a, b| matrix[*a][step].abs().total_cmp(&matrix[*b][step].abs()))?;
        matrix.swap(step, pivot);
        let scale = matrix[step][step];
        if scale == 0.0 || !scale.is_finite() {
            return None;
        }
        matrix[step].iter_mut().for_each(|entry| *entry /= scale);
        let top = matrix[step].clone();
        for (_, row) in matrix.iter_mut().enumerate().filter(|(place, _)| *place != step) {
            let factor = row[step];
            row.iter_mut().zip(&top).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    Some(matrix.into_iter().map(|row| row[n..].to_vec()).collect())
}
