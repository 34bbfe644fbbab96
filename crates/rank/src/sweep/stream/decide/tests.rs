//! What a lane finds is what its matrix gets alone: the oracle is one lane, which has no neighbours.

use super::*;
use palmistry_math::number::{Instructions, MOST_LANES, Vectorised};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Entries by rows with the bounds on their errors, in units of `2^-53`.
type Matrix = Vec<Bounded<f64>>;

/// Everything that is found for one matrix, in bits; all that is not a number has the same.
type Bits = Vec<u64>;

/// Matrices of one shape, some at a time.
struct Groups<'a> {
    shape: (usize, usize),
    groups: &'a [Vec<&'a Matrix>],
    /// What stands in the lanes that are left over.
    padding: &'a Matrix,
    certify: bool,
}

impl Vectorised for Groups<'_> {
    type Output = Vec<Bits>;

    #[inline(always)]
    fn run<L: Lanes>(self, zero: L) -> Vec<Bits> {
        let (rows, columns) = self.shape;
        let mut decider = Decider::new(rows, columns, zero);
        let mut all = Vec::new();
        for group in self.groups.iter().flat_map(|group| group.chunks(L::COUNT)) {
            for place in 0..rows * columns {
                let (mut values, mut units) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
                for lane in 0..L::COUNT {
                    let entry = group.get(lane).map_or(self.padding, |matrix| matrix)[place];
                    (values[lane], units[lane]) = (entry.value, entry.units);
                }
                decider.set(place, Bounded { value: zero.load(&values), units: zero.load(&units) });
            }
            let found = decider.decide(self.certify);
            let mut numbers =
                vec![found.rank, found.ratio, found.gap, found.separated, found.finite, found.certain];
            let lanes: Vec<L> = [
                decider.row_factors().to_vec(),
                decider.column_factors().to_vec(),
                decider.singular_values().to_vec(),
            ]
            .concat();
            for value in lanes {
                let mut room = [0.0; MOST_LANES];
                value.store(&mut room);
                numbers.push(room);
            }
            let bits = |x: f64| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() };
            all.extend((0..group.len()).map(|lane| numbers.iter().map(|found| bits(found[lane])).collect()));
        }
        all
    }
}

/// Ordinary matrices, nearly singular ones, those whose scaling takes all rounds and ends nowhere, and those that are
/// nothing: zero, infinite, not a number, or known to no digit.
fn matrices(rng: &mut ChaCha8Rng, (rows, columns): (usize, usize), count: usize) -> Vec<Matrix> {
    let size = rows * columns;
    (0..count)
        .map(|case| {
            let spread = f64::from(rng.random_range(0..9));
            let mut values: Vec<f64> = (0..size)
                .map(|_| rng.random_range(-1.0..1.0) * 10f64.powf(rng.random_range(-spread..=spread)))
                .collect();
            let mut units = rng.random_range(0.0..100.0);
            let place = rng.random_range(0..size);
            match case % 12 {
                1 => (0..size).filter(|k| k / columns > k % columns).for_each(|k| values[k] = 0.0),
                2 if rows > 1 => (0..columns).for_each(|j| values[columns + j] = values[j] * (1.0 + 1e-12)),
                3 => values[place] = 0.0,
                4 => values[place] = f64::NAN,
                5 => values[place] = f64::INFINITY,
                6 => values.fill(0.0),
                7 => units = f64::NAN,
                8 => values.iter_mut().for_each(|value| *value *= 1e-300),
                9 => (0..size).filter(|k| k % columns > 0).for_each(|k| values[k] *= 1e-9),
                _ => {}
            }
            values.iter().map(|value| Bounded { value: *value, units: units * value.abs() }).collect()
        })
        .collect()
}

#[test]
fn a_matrix_gets_in_any_company_the_bits_that_it_gets_alone() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (mut compared, mut separated, mut certain) = (0, 0, 0);
    for shape in [(1, 1), (2, 2), (3, 3), (4, 4), (2, 5), (5, 3)] {
        let matrices = matrices(&mut rng, shape, 180);
        for certify in [false, true] {
            let single: Vec<Vec<&Matrix>> = matrices.iter().map(|matrix| vec![matrix]).collect();
            let alone = Groups { shape, groups: &single, padding: &matrices[0], certify }.run(0.0f64);
            separated += alone.iter().filter(|found| found[3] == 1f64.to_bits()).count();
            certain += alone.iter().filter(|found| found[5] == 1f64.to_bits()).count();
            for trial in 0..12 {
                let mut order: Vec<usize> = (0..matrices.len()).collect();
                for k in (1..order.len()).rev() {
                    order.swap(k, rng.random_range(0..=k));
                }
                let mut groups = Vec::new();
                let mut rest = &order[..];
                while !rest.is_empty() {
                    let (some, later) = rest.split_at(rng.random_range(1..=rest.len().min(21)));
                    groups.push(some.iter().map(|place| &matrices[*place]).collect());
                    rest = later;
                }
                // every kind of matrix stands in the lanes that are left over
                let padding = &matrices[trial];
                for instructions in Instructions::ALL {
                    let found = instructions.run(Groups { shape, groups: &groups, padding, certify });
                    assert_eq!(found.len(), order.len());
                    for (place, found) in order.iter().zip(&found) {
                        assert_eq!(
                            found, &alone[*place],
                            "{shape:?}, {instructions:?}, trial {trial}, {:?}",
                            matrices[*place]
                        );
                    }
                    compared += found.len();
                }
            }
        }
    }
    assert!(compared == 6 * 2 * 12 * 3 * 180 && separated > 800 && certain > 300, "{separated}, {certain}");
}
