//! Ways that take several states side by side in the vectors of the processor: values with bounds on their errors, and
//! ranks of many small matrices at once.

use super::block::Block;
use super::ranks::{RankVerdict, RankWay};
use palmistry_math::expression::BlockProgram;
use palmistry_math::number::{Bounded, Instructions, Lanes, MOST_LANES, Vectorised};
use palmistry_rank::sweep::{Elimination, Jacobi};

/// The values of a block program and bounds on their errors, from inputs that are the doubles nearest to exact ones:
/// state by state, all results of one after the other; not numbers where a state has none.
pub(super) struct BoundedValues<'a> {
    pub program: &'a BlockProgram,
    pub inputs: &'a [&'a [f64]],
    pub states: usize,
    pub results: &'a mut Vec<Bounded<f64>>,
}

impl Vectorised for BoundedValues<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, zero: L) {
        let BoundedValues { program, inputs, states, results } = self;
        let outputs = program.outputs();
        let nothing = Bounded { value: f64::NAN, units: f64::NAN };
        results.clear();
        results.resize(states * outputs, nothing);
        let mut machine = program.machine(Bounded::exact(zero));
        let (mut values, mut units) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
        let mut start = 0;
        while start < states {
            for (place, input) in inputs.iter().enumerate() {
                let Some(room) = machine.input(place) else { continue };
                for (k, lane) in room.iter_mut().enumerate() {
                    for (i, value) in values.iter_mut().enumerate() {
                        // the last state again, where there are none left
                        *value = input[(start + k * L::COUNT + i).min(states - 1)];
                    }
                    let value = zero.load(&values);
                    // rounded once
                    *lane = Bounded { value, units: value.abs() };
                }
            }
            machine.run();
            for lane in 0..machine.lanes() {
                let first = start + lane * L::COUNT;
                if first >= states {
                    break;
                }
                let here = L::COUNT.min(states - first);
                let health = machine.health(lane);
                let (mut spoiled, mut unknown) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
                health.value.store(&mut spoiled);
                health.error().zero_if_finite().store(&mut unknown);
                for place in 0..outputs {
                    let result = machine.output(place, lane);
                    result.value.store(&mut values);
                    result.units.store(&mut units);
                    for i in (0..here).filter(|i| spoiled[*i] == 0.0 && !program.is_undefined()) {
                        // a divisor that is not known well enough leaves no bound
                        let units = if unknown[i] == 0.0 { units[i] } else { f64::INFINITY };
                        results[(first + i) * outputs + place] = Bounded { value: values[i], units };
                    }
                }
            }
            start += machine.states();
        }
    }
}

/// Brings one entry of as many matrices as there are lanes side by side; not a number where there are fewer.
#[inline(always)]
fn gathered<N, L: Lanes>(zero: L, blocks: &[Option<Vec<N>>], place: usize, of: fn(&N) -> f64) -> L {
    let mut buffer = [f64::NAN; MOST_LANES];
    for (value, block) in buffer.iter_mut().zip(blocks) {
        if let Some(block) = block {
            *value = of(&block[place]);
        }
    }
    zero.load(&buffer)
}

/// One over the largest magnitude, which must not be zero; one over zero is one.
#[inline(always)]
fn inverse<L: Lanes>(largest: L) -> L {
    let (zero, one) = (largest.splat(0.0), largest.splat(1.0));
    one / zero.where_less(largest, largest, one)
}

/// By one-sided Jacobi rotations; rows are scaled to length one, and the threshold is that of the libraries' ways.
pub(super) fn jacobi(block: &Block) -> RankWay<'_, f64> {
    let (rows, columns) = (block.rows, block.columns);
    Box::new(move |blocks, sink| {
        let mut verdicts = Vec::with_capacity(blocks.len());
        Instructions::detect().run(Jacobis { blocks, rows, columns, verdicts: &mut verdicts });
        verdicts.into_iter().for_each(sink);
    })
}

struct Jacobis<'a> {
    blocks: &'a [Option<Vec<f64>>],
    rows: usize,
    columns: usize,
    verdicts: &'a mut Vec<RankVerdict>,
}

impl Vectorised for Jacobis<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, zero: L) {
        let Jacobis { blocks, rows, columns, verdicts } = self;
        let mut room = Jacobi::new(rows, columns, zero);
        let mut row = vec![zero; columns];
        let one = zero.splat(1.0);
        for blocks in blocks.chunks(L::COUNT) {
            let mut spoiled = zero;
            for i in 0..rows {
                let mut largest = zero;
                for (j, entry) in row.iter_mut().enumerate() {
                    *entry = gathered(zero, blocks, i * columns + j, |x| *x);
                    spoiled = spoiled + entry.zero_if_finite();
                    largest = largest.larger(entry.abs());
                }
                let factor = inverse(largest);
                let mut square = zero;
                for entry in &mut row {
                    *entry = *entry * factor;
                    square = square + *entry * *entry;
                }
                let factor = inverse(square.sqrt());
                for (j, entry) in row.iter().enumerate() {
                    room.set(i, j, *entry * factor);
                }
            }
            let (values, converged) = room.singular_values();
            let mut largest = values[0];
            for value in &values[1..] {
                largest = largest.larger(*value);
            }
            let tolerance = largest * zero.splat(rows.max(columns) as f64 * f64::EPSILON);
            let mut rank = zero;
            for value in values {
                rank = rank + tolerance.where_less(*value, one, zero);
            }
            // a matrix that is given up fails alone
            let failed = zero.where_less(converged, spoiled, one);
            let (mut ranks, mut lost) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
            rank.store(&mut ranks);
            failed.store(&mut lost);
            verdicts.extend((0..blocks.len()).map(|i| {
                if lost[i] == 0.0 { RankVerdict::Rank(ranks[i] as usize) } else { RankVerdict::Failed }
            }));
        }
    }
}

/// A full rank for certain by elimination with bounds, or nothing.
pub(super) fn certain(block: &Block) -> RankWay<'_, Bounded<f64>> {
    let (rows, columns) = (block.rows, block.columns);
    Box::new(move |blocks, sink| {
        let mut verdicts = Vec::with_capacity(blocks.len());
        Instructions::detect().run(Eliminations { blocks, rows, columns, verdicts: &mut verdicts });
        verdicts.into_iter().for_each(sink);
    })
}

struct Eliminations<'a> {
    blocks: &'a [Option<Vec<Bounded<f64>>>],
    rows: usize,
    columns: usize,
    verdicts: &'a mut Vec<RankVerdict>,
}

impl Vectorised for Eliminations<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, zero: L) {
        let Eliminations { blocks, rows, columns, verdicts } = self;
        let mut room = Elimination::new(rows, columns, zero);
        let one = zero.splat(1.0);
        let mut of_columns = vec![zero; columns];
        for blocks in blocks.chunks(L::COUNT) {
            let mut spoiled = zero;
            of_columns.fill(zero);
            for i in 0..rows {
                let mut of_row = zero;
                for (j, of_column) in of_columns.iter_mut().enumerate() {
                    let place = i * columns + j;
                    let value = gathered(zero, blocks, place, |x: &Bounded<f64>| x.value);
                    let units = gathered(zero, blocks, place, |x: &Bounded<f64>| x.units);
                    spoiled = spoiled + value.zero_if_finite();
                    of_row = of_row.larger(value.abs());
                    *of_column = of_column.larger(value.abs());
                    room.set(i, j, Bounded { value, units });
                }
                room.set_row_weight(i, inverse(of_row));
            }
            for (j, of_column) in of_columns.iter().enumerate() {
                room.set_column_weight(j, inverse(*of_column));
            }
            let (mut found, mut lost) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
            room.is_full(one).store(&mut found);
            spoiled.store(&mut lost);
            verdicts.extend((0..blocks.len()).map(|i| match (lost[i] == 0.0, found[i] == 1.0) {
                (false, _) => RankVerdict::Failed,
                (true, true) => RankVerdict::Rank(rows.min(columns)),
                (true, false) => RankVerdict::Undecided,
            }));
        }
    }
}
