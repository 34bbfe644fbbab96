//! The kernel of a codistribution at random points modulo a prime, and the coordinates on which it depends.

use super::modular::{Echelon, Residues};
use crate::observability::generic::Probe;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{
    Input, NodeId, Program, Symbol, SymbolFunction, SymbolInput, expand_angles,
};
use palmistry_math::number::PrimeField;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::rc::Rc;

/// How the kernel is computed at a point.
pub(super) enum Evaluation {
    /// From the differentials of Lie derivatives, row after row.
    Words(Program),
    /// From power series along a trajectory: no Lie derivatives are needed.
    Series(Box<Probe>),
}

/// Where kernels come from: a codistribution that can be evaluated at any point modulo one prime.
pub(super) struct KernelSource {
    pub residues: Residues,
    /// What the rows may depend on: symbols, and sine and cosine of those that are angles, each pair side by side.
    pub variables: Vec<SymbolInput>,
    evaluation: Evaluation,
    /// For each input of the program the variable that it is; none for functions, which are taken for independent.
    feeds: Vec<Option<usize>>,
    /// For each input of the program that is no variable, the symbols that it mentions.
    mentioned: Vec<Vec<Symbol>>,
    coordinates: Vec<Symbol>,
}

/// A random point.
#[derive(Clone)]
pub(super) struct Point {
    /// A residue for each variable.
    pub values: Vec<u64>,
    functions: Vec<u64>,
}

/// The vectors that all rows annihilate at one point: each has a one at a free column of its own, and zeros at the others.
#[derive(Clone)]
pub(super) struct Kernel {
    pub free: Vec<usize>,
    pub basis: Vec<Vec<u64>>,
}

/// How often a point is drawn anew because it is a pole.
const ATTEMPTS: usize = 40;

/// Longer programs cost more than series.
const LONGEST_PROGRAM: usize = 20_000;
/// Of what series are drawn from beside the point; any does.
const SEED: u64 = 0x006b_6572_6e65;

impl Evaluation {
    fn inputs(&self) -> &[Input] {
        match self {
            Evaluation::Words(program) => program.inputs(),
            Evaluation::Series(probe) => probe.inputs(),
        }
    }
}

impl KernelSource {
    /// The kernel of rows with a column for each of `coordinates`; none where they are long, or are of functions of whose values
    /// nothing is known.
    pub fn of_lie_derivatives(
        system: &mut System,
        rows: &[NodeId],
        coordinates: &[Symbol],
        rng: &mut ChaCha8Rng,
    ) -> Option<KernelSource> {
        let is_angle = &system.angle_test();
        let entries = expand_angles(&mut system.graph, rows, is_angle);
        let program = Program::with_unknown_functions(&system.graph, &entries, is_angle);
        let fits = program.bare_angle().is_none()
            && program.unknown_function(&system.graph).is_none()
            && program.len() <= LONGEST_PROGRAM;
        fits.then(|| KernelSource::new(system, Evaluation::Words(program), coordinates, rng))
    }

    /// The kernel of all Lie derivatives, at values of parameters.
    pub fn of_series(
        system: &System,
        values: &Assignment,
        coordinates: &[Symbol],
        rng: &mut ChaCha8Rng,
    ) -> KernelSource {
        KernelSource::new(system, Evaluation::Series(Box::new(Probe::new(system, values))), coordinates, rng)
    }

    fn new(
        system: &System,
        evaluation: Evaluation,
        coordinates: &[Symbol],
        rng: &mut ChaCha8Rng,
    ) -> KernelSource {
        let is_angle = &system.angle_test();
        let inputs: Vec<Input> = evaluation.inputs().to_vec();
        let mut symbols: Vec<Symbol> = coordinates.to_vec();
        for symbol in inputs.iter().filter_map(|input| input.symbol()) {
            // what drives an input is drawn, and nothing depends on it
            if !symbols.contains(&symbol) && system.symbol_info(symbol).is_some() {
                symbols.push(symbol);
            }
        }
        let variables: Vec<SymbolInput> = symbols
            .into_iter()
            .flat_map(|symbol| {
                let functions: &[SymbolFunction] = match is_angle(symbol) {
                    true => &[SymbolFunction::Sine, SymbolFunction::Cosine],
                    false => &[SymbolFunction::Itself],
                };
                functions.iter().map(move |function| SymbolInput { symbol, function: *function })
            })
            .collect();
        let place = |input: &Input| {
            let wanted = input.of_symbol()?;
            variables.iter().position(|variable| *variable == wanted)
        };
        let feeds = inputs.iter().map(place).collect();
        let mentions = |input: &Input| match input {
            Input::Opaque(node) => system.graph.symbols_of([*node]),
            _ => Vec::new(),
        };
        let mentioned = inputs.iter().map(mentions).collect();
        let residues = Residues(PrimeField::random(rng));
        let coordinates = coordinates.to_vec();
        KernelSource { residues, feeds, mentioned, coordinates, evaluation, variables }
    }

    /// How many columns there are.
    pub fn columns(&self) -> usize {
        self.coordinates.len()
    }

    /// The coordinate of a column.
    pub fn coordinate(&self, column: usize) -> Symbol {
        self.coordinates[column]
    }

    /// Whether functions are met of whose values nothing is known.
    pub fn has_functions(&self) -> bool {
        match &self.evaluation {
            Evaluation::Words(_) => false,
            Evaluation::Series(probe) => probe.has_functions(),
        }
    }

    /// A random point, whether or not it is a pole.
    pub fn draw(&self, rng: &mut ChaCha8Rng) -> Point {
        let mut point = Point { values: vec![0; self.variables.len()], functions: Vec::new() };
        let symbols: BTreeSet<Symbol> = self.variables.iter().map(|variable| variable.symbol).collect();
        symbols.into_iter().for_each(|symbol| self.draw_symbol(&mut point, symbol, rng));
        point.functions = self.feeds.iter().map(|_| self.residues.0.draw(rng)).collect();
        point
    }

    /// Another value for one symbol, and for all functions of it.
    pub fn redraw(&self, point: &Point, symbol: Symbol, rng: &mut ChaCha8Rng) -> Point {
        let mut point = point.clone();
        self.draw_symbol(&mut point, symbol, rng);
        for (value, mentioned) in point.functions.iter_mut().zip(&self.mentioned) {
            if mentioned.contains(&symbol) {
                *value = self.residues.0.draw(rng);
            }
        }
        point
    }

    fn draw_symbol(&self, point: &mut Point, symbol: Symbol, rng: &mut ChaCha8Rng) {
        let r = self.residues;
        // a point of the unit circle, from the tangent of the half angle
        let (half, bottom) = loop {
            let half = r.0.draw(rng);
            if let Some(inverse) = r.0.inverse(r.add(r.one(), r.mul(half, half))) {
                break (half, inverse);
            }
        };
        for (value, variable) in point.values.iter_mut().zip(&self.variables) {
            if variable.symbol == symbol {
                *value = match variable.function {
                    SymbolFunction::Itself => half,
                    SymbolFunction::Sine => r.mul(r.add(half, half), bottom),
                    SymbolFunction::Cosine => r.mul(r.sub(r.one(), r.mul(half, half)), bottom),
                };
            }
        }
    }

    /// The kernel of the rows at a point; none at a pole.
    pub fn kernel(&self, point: &Point) -> Option<Kernel> {
        let inputs: Vec<u64> = self
            .feeds
            .iter()
            .zip(&point.functions)
            .map(|(feed, function)| feed.map_or(*function, |place| point.values[place]))
            .collect();
        let columns = self.coordinates.len();
        let mut echelon = Echelon::new(self.residues, columns);
        match &self.evaluation {
            Evaluation::Words(program) => {
                let loaded = program.load(self.residues.0).ok()?;
                let values = loaded.run(&inputs, &mut Vec::new()).ok()?;
                for row in values.chunks(columns.max(1)) {
                    if echelon.rank() == columns {
                        break;
                    }
                    echelon.add(row.to_vec());
                }
                let (free, basis) = echelon.kernel();
                Some(Kernel { free, basis })
            }
            Evaluation::Series(probe) => {
                let basis = probe.directions_at(self.residues.0, &inputs, SEED).ok()?;
                // the last columns are the free ones, as if rows had been reduced from the first column on
                for vector in basis {
                    echelon.add(vector.into_iter().rev().collect());
                }
                let mut reduced = echelon.reduced();
                reduced.reverse();
                let back = |pivot: usize| columns - 1 - pivot;
                Some(Kernel {
                    free: reduced.iter().map(|(pivot, _)| back(*pivot)).collect(),
                    basis: reduced.into_iter().map(|(_, row)| row.into_iter().rev().collect()).collect(),
                })
            }
        }
    }

    /// A random point and the kernel there, as large as at almost all points: with these free columns, where they are given.
    pub fn sample(&self, free: Option<&[usize]>, rng: &mut ChaCha8Rng) -> Option<(Point, Kernel)> {
        (0..ATTEMPTS).find_map(|_| {
            let point = self.draw(rng);
            let kernel = self.kernel(&point)?;
            free.is_none_or(|free| kernel.free == free).then_some((point, kernel))
        })
    }
}

/// Columns that no kernel vector couples with others: the kernel is the sum of those of its blocks.
pub(super) struct Block {
    /// The columns, and those of them that are free.
    pub columns: Vec<usize>,
    pub free: Vec<usize>,
    place: usize,
    dependence: Rc<Dependence>,
}

/// On which variables the blocks of a kernel depend. It is looked for when somebody asks: it takes a kernel for every symbol.
struct Dependence {
    point: Point,
    kernel: Kernel,
    /// The free columns of each block.
    free: Vec<Vec<usize>>,
    found: OnceCell<Vec<Vec<usize>>>,
}

impl Block {
    /// The variables that the kernel depends on in this block.
    pub fn variables(&self, source: &KernelSource) -> &[usize] {
        &self.dependence.found.get_or_init(|| self.dependence.find(source))[self.place]
    }
}

impl Dependence {
    /// Changes one symbol at a time.
    fn find(&self, source: &KernelSource) -> Vec<Vec<usize>> {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        let mut found = vec![Vec::new(); self.free.len()];
        let mut at = 0;
        while at < source.variables.len() {
            let symbol = source.variables[at].symbol;
            let pair: Vec<usize> = (at..source.variables.len())
                .take_while(|next| source.variables[*next].symbol == symbol)
                .collect();
            at += pair.len();
            let moved = (0..ATTEMPTS).find_map(|_| {
                let kernel_there = source.kernel(&source.redraw(&self.point, symbol, &mut rng))?;
                (kernel_there.free == self.kernel.free).then_some(kernel_there)
            });
            for (variables, free) in found.iter_mut().zip(&self.free) {
                let of_block = |(column, _): &(&usize, &Vec<u64>)| free.contains(column);
                let same = moved.as_ref().is_some_and(|moved| {
                    let here = self.kernel.free.iter().zip(&self.kernel.basis).filter(of_block);
                    here.eq(moved.free.iter().zip(&moved.basis).filter(of_block))
                });
                if !same {
                    variables.extend(&pair);
                }
            }
        }
        found
    }
}

/// The blocks of the kernel at a point.
pub(super) fn blocks(point: &Point, kernel: &Kernel) -> Vec<Block> {
    // columns and free columns
    let mut blocks: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
    for (free, vector) in kernel.free.iter().zip(&kernel.basis) {
        let mut columns: BTreeSet<usize> = (0..vector.len()).filter(|place| vector[*place] != 0).collect();
        let mut all = vec![*free];
        blocks.retain(|block| {
            let apart = block.0.iter().all(|column| !columns.contains(column));
            if !apart {
                columns.extend(&block.0);
                all.extend(&block.1);
            }
            apart
        });
        all.sort_unstable();
        blocks.push((columns.into_iter().collect(), all));
    }
    blocks.sort();
    let dependence = Rc::new(Dependence {
        point: point.clone(),
        kernel: kernel.clone(),
        free: blocks.iter().map(|(_, free)| free.clone()).collect(),
        found: OnceCell::new(),
    });
    let block = |(place, (columns, free))| Block { columns, free, place, dependence: Rc::clone(&dependence) };
    blocks.into_iter().enumerate().map(block).collect()
}
