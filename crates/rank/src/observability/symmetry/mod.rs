//! The unobservable directions, as vector fields, and what is observable, as functions.
//!
//! At almost all states there are as many unobservable directions as the dimension exceeds the rank of the codistribution. Along
//! vector fields in these directions the state moves and every output stays what it is: turning everything about a beacon, counting
//! in other units. A function whose differential lies in the codistribution is observable: such a motion does not change it.
//!
//! Fields and functions are found by linear equations at random points modulo a prime, in polynomials of low degree, and then
//! [proved](proof). What is not found so is only counted.

mod ansatz;
mod answer;
mod express;
mod functions;
mod generators;
mod kernel;
mod lattice;
mod modular;
mod monomial;
mod proof;
mod reparametrise;
mod section;

pub use self::answer::{FieldComponent, ObservableFunction, UnobservableDirections, UnobservableField};
pub use self::generators::{IdentifiableFunction, IdentifiableFunctions, identifiable_functions};
pub use self::reparametrise::{NotReparametrised, reparametrise};

use self::ansatz::{Component, FieldTerms, fields_of_block};
use self::answer::UnseenBlock;
use self::functions::{FunctionTerms, functions_of_block};
use self::kernel::{Block, Kernel, KernelSource, blocks};
use self::modular::rank;
use self::monomial::{Polynomial, polynomial_node};
use self::proof::{Motion, annihilate, is_unchanged, is_unseen_for_good, together};
use super::Codistribution;
use super::generic::generic_answer;
use super::saturation::Ceiling;
use palmistry_lang::{Assignment, System, Time};
use palmistry_math::expression::{Graph, NodeId, Program, Symbol, SymbolInput, draw_residues, expand_angles};
use palmistry_math::number::PrimeField;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// How often a point is drawn anew because it is a pole.
const ATTEMPTS: usize = 40;

/// The fields and the functions of a system that is partly observable, without conditions on states. `held` are the values of
/// parameters that were put in, `given` those of them that the question gave. If `words`, the Lie derivatives that were taken with
/// them, are final, they give the kernel at a point; otherwise power series do. None where no point could be evaluated.
pub fn unobservable_directions(
    system: &mut System,
    words: Option<&Codistribution>,
    held: &Assignment,
    given: &Assignment,
) -> Option<UnobservableDirections> {
    if system.time == Time::Discrete {
        return None; // what is proved of the fields is proved of rates
    }
    let mut rng = ChaCha8Rng::seed_from_u64(0x0066_6965_6c64); // any fixed seed: what is found is proved
    let words = words.filter(|words| words.is_final());
    let everywhere = Attempt::new(system, words, (given, given.len() == held.len()), &mut rng)
        .filter(|attempt| attempt.is_complete() && attempt.holds_at(system, held, &mut rng));
    match everywhere {
        Some(attempt) => Some(UnobservableDirections { for_all_parameters: true, ..attempt.found }),
        None => Some(Attempt::new(system, words, (held, true), &mut rng)?.found),
    }
}

/// Lie derivatives with longer texts are left out: nobody would read them.
const LONGEST_TEXT: usize = 160;
/// How many points are looked at for the number of unobservable directions.
const POINTS: usize = 3;

struct Attempt {
    found: UnobservableDirections,
    /// The fields, with a component for each state.
    vectors: Vec<Vec<NodeId>>,
}

impl Attempt {
    /// What is found at values of parameters, those with which the Lie derivatives were taken or others.
    fn new(
        system: &mut System,
        words: Option<&Codistribution>,
        (values, has_these_words): (&Assignment, bool),
        rng: &mut ChaCha8Rng,
    ) -> Option<Attempt> {
        let coordinates = system.unknowns();
        let rows = words.map(|words| system.graph.substitute(&words.needed_entries(), values));
        let of_lie_derivatives =
            rows.as_ref().and_then(|rows| KernelSource::of_lie_derivatives(system, rows, &coordinates, rng));
        let source =
            of_lie_derivatives.unwrap_or_else(|| KernelSource::of_series(system, values, &coordinates, rng));
        let points = (0..POINTS).filter_map(|_| source.sample(None, rng));
        let (point, kernel) = points.min_by_key(|(_, kernel)| kernel.basis.len())?;
        let unobservable = kernel.basis.len();
        if words.is_some_and(|words| coordinates.len() - words.generic_rank() != unobservable) {
            return None;
        }
        let blocks = blocks(&point, &kernel);
        let found = UnobservableDirections { values: values.clone(), ..UnobservableDirections::default() };
        let mut attempt = Attempt { found, vectors: Vec::new() };
        let mut of_blocks: Vec<Vec<FieldTerms>> = Vec::new();
        for block in &blocks {
            let found = fields_of_block(&source, block, &kernel.free, rng);
            attempt.found.cut_off |= found.cut_off;
            of_blocks.push(found.fields);
        }
        let motion = motion(system, values);
        let rows = rows.as_deref().filter(|_| has_these_words);
        attempt.prove_fields(system, &source, &motion, rows, &mut of_blocks, rng);
        attempt.found.fields_missing = unobservable - attempt.found.fields.len();
        // the rank at a point modulo a prime bounds the rank from below, if no function was taken for another
        attempt.found.settles_the_rank = attempt.is_complete()
            && (!source.has_functions()
                || generic_answer(system, values, Ceiling::Rests).at_least
                    >= coordinates.len() - unobservable);
        attempt.functions(system, (&source, &kernel), &blocks, &of_blocks, &motion, rng);
        attempt.measured(system, words, &motion, &blocks, rng);
        attempt.found.observable = (0..coordinates.len())
            .filter(|column| blocks.iter().all(|block| !block.columns.contains(column)))
            .map(|column| coordinates[column])
            .collect();
        attempt.found.observable_names =
            attempt.found.observable.iter().map(|symbol| system.symbol_name(*symbol).to_owned()).collect();
        Some(attempt)
    }

    fn is_complete(&self) -> bool {
        self.found.fields_missing == 0
    }

    /// Takes the fields that can be proved: all at once, or each by the Lie derivatives, where these are final.
    fn prove_fields(
        &mut self,
        system: &mut System,
        source: &KernelSource,
        motion: &Motion,
        words: Option<&[NodeId]>,
        of_blocks: &mut [Vec<FieldTerms>],
        rng: &mut ChaCha8Rng,
    ) {
        let all: Vec<Vec<NodeId>> =
            of_blocks.iter().flatten().map(|field| field_nodes(system, source, field)).collect();
        if all.is_empty() {
            return;
        }
        let values = (0..ATTEMPTS).find_map(|_| {
            let point = source.draw(rng);
            let places = places(system, source);
            let at = |field: &FieldTerms| {
                let values = field.at(source, &point, places.len())?;
                let mut vector = vec![0; system.states.len()];
                places.iter().zip(values).for_each(|(place, value)| vector[*place] = value);
                Some(vector)
            };
            of_blocks.iter().flatten().map(at).collect::<Option<Vec<_>>>()
        });
        // brackets are of motions along fields; in discrete time only the Lie derivatives decide
        let values = values.filter(|_| system.time == Time::Continuous);
        let together =
            values.and_then(|values| is_unseen_for_good(system, motion, &all, values, source.residues, rng));
        let mut vectors = all.into_iter();
        for fields in of_blocks {
            fields.retain(|field| {
                let Some(vector) = vectors.next() else { return false };
                let mut by_words = |system: &mut System| {
                    let unknown: Vec<NodeId> =
                        places(system, source).iter().map(|place| vector[*place]).collect();
                    annihilate(system, words?, &unknown, &motion.guards, rng)
                };
                let Some(log2_error) = together.or_else(|| by_words(system)) else { return false };
                self.found.fields.push(unseen_field(system, source, field, &vector, log2_error));
                self.vectors.push(vector);
                true
            });
        }
    }

    /// Takes the functions of all blocks that can be proved.
    fn functions(
        &mut self,
        system: &mut System,
        (source, kernel): (&KernelSource, &Kernel),
        blocks: &[Block],
        of_blocks: &[Vec<FieldTerms>],
        motion: &Motion,
        rng: &mut ChaCha8Rng,
    ) {
        let fields_err = together(self.found.fields.iter().map(|field| field.log2_error));
        for (block, fields) in blocks.iter().zip(of_blocks) {
            let found = functions_of_block(source, block, fields, &kernel.free, rng);
            self.found.cut_off |= found.cut_off;
            self.found.functions_missing += found.missing;
            let begin = self.found.functions.len();
            for function in found.functions {
                let factors = factor_nodes(&mut system.graph, &source.variables, &function);
                let value = product(&mut system.graph, &factors);
                // where no unobservable direction changes it, its differential lies in the codistribution
                let proof = match self.is_complete() && self.found.settles_the_rank {
                    true => is_unchanged(system, motion, &self.vectors, value, rng),
                    false => None,
                };
                match proof {
                    Some(log2_error) => self.found.functions.push(ObservableFunction {
                        value,
                        text: function.text(&system.graph, &source.variables),
                        log2_error: together([log2_error, fields_err]),
                        factors,
                    }),
                    None => self.found.functions_missing += 1,
                }
            }
            self.found.blocks.push(UnseenBlock {
                states: block.columns.iter().map(|column| source.coordinate(*column)).collect(),
                unobservable: block.free.len(),
                functions: begin..self.found.functions.len(),
            });
        }
    }

    /// Where functions are missing, takes what stands in the file: observable parts of rates and outputs, the outputs
    /// themselves, and their Lie derivatives.
    fn measured(
        &mut self,
        system: &mut System,
        words: Option<&Codistribution>,
        motion: &Motion,
        blocks: &[Block],
        rng: &mut ChaCha8Rng,
    ) {
        if self.found.functions_missing == 0 {
            return;
        }
        // a part of a rate or an output that no field changes is observable, if there are no other unobservable directions
        let mut candidates: Vec<(NodeId, String, Option<f64>)> = Vec::new();
        if self.is_complete() && self.found.settles_the_rank {
            let fields_err = together(self.found.fields.iter().map(|field| field.log2_error));
            for (value, text) in parts(system, motion) {
                if let Some(log2_error) = is_unchanged(system, motion, &self.vectors, value, rng) {
                    candidates.push((value, text, Some(together([log2_error, fields_err]))));
                }
            }
        }
        let mut measured = motion.outputs.clone();
        if let Some(words) = words {
            let values: Vec<NodeId> = words.needed.iter().map(|word| words.values[*word]).collect();
            measured.extend(system.graph.substitute(&values, &self.found.values));
        }
        candidates.extend(measured.into_iter().map(|value| (value, system.graph.text(value), None)));
        let unknowns = system.unknowns();
        let coupled = |column: &usize| blocks.iter().any(|block| block.columns.contains(column));
        let columns: Vec<usize> = (0..unknowns.len()).filter(coupled).collect();
        // observable coordinates are left out of the differentials
        let row = |system: &mut System, value: NodeId| -> Vec<NodeId> {
            let row = system.differential(value);
            columns.iter().map(|column| row[*column]).collect()
        };
        let mut rows: Vec<NodeId> = Vec::new();
        for function in &self.found.functions {
            rows.extend(row(system, function.value));
        }
        for (value, text, log2_error) in candidates {
            if self.found.functions_missing == 0 || text.len() > LONGEST_TEXT {
                continue;
            }
            let longer = [rows.as_slice(), &row(system, value)].concat();
            let rank = self.found.functions.len();
            if rank_somewhere(system, &longer, columns.len(), rng) == Some(rank + 1) {
                rows = longer;
                let (log2_error, factors) = (log2_error.unwrap_or(f64::NEG_INFINITY), vec![(value, 1)]);
                self.found.functions.push(ObservableFunction { value, text, log2_error, factors });
                self.found.functions_missing -= 1;
                // it may be one of several blocks
                self.found.blocks = vec![UnseenBlock {
                    states: columns.iter().map(|column| unknowns[*column]).collect(),
                    unobservable: self.found.directions(),
                    functions: 0..self.found.functions.len(),
                }];
            }
        }
    }

    /// Whether the fields, and the differentials of the functions, are independent at these values of parameters too.
    fn holds_at(&self, system: &mut System, values: &Assignment, rng: &mut ChaCha8Rng) -> bool {
        let fields: Vec<NodeId> = self.vectors.iter().flatten().copied().collect();
        let functions: Vec<NodeId> =
            self.found.functions.iter().flat_map(|function| system.differential(function.value)).collect();
        let states = system.states.len();
        let of_fields = (fields, states, self.vectors.len());
        let of_functions = (functions, system.unknown_count(), self.found.functions.len());
        [of_fields, of_functions].into_iter().all(|(entries, columns, wanted)| {
            let entries = system.graph.substitute(&entries, values);
            rank_somewhere(system, &entries, columns, rng) == Some(wanted)
        })
    }
}

/// No more parts of rates and outputs are looked at.
const MOST_PARTS: usize = 200;

/// The parts of rates and outputs, shortest first, but symbols and numbers.
fn parts(system: &System, motion: &Motion) -> Vec<(NodeId, String)> {
    let nodes = system.graph.reachable(motion.fields.iter().flatten().chain(&motion.outputs).copied());
    let is_part = |node: &NodeId| {
        system.graph.as_symbol(*node).is_none() && !system.graph.symbols_of([*node]).is_empty()
    };
    let with_text = |node: NodeId| (node, system.graph.text(node));
    let mut found: Vec<(NodeId, String)> = nodes.into_iter().filter(is_part).map(with_text).collect();
    found.retain(|(_, text)| text.len() <= LONGEST_TEXT && !text.starts_with('-'));
    found.sort_by_key(|(_, text)| text.len());
    found.truncate(MOST_PARTS);
    found
}

/// The rank of rows of so many columns at a random point modulo a prime, which it is at least at almost all states.
fn rank_somewhere(
    system: &mut System,
    entries: &[NodeId],
    columns: usize,
    rng: &mut ChaCha8Rng,
) -> Option<usize> {
    let is_angle = &system.angle_test();
    let entries = expand_angles(&mut system.graph, entries, is_angle);
    let program = Program::with_unknown_functions(&system.graph, &entries, is_angle);
    (0..ATTEMPTS).find_map(|_| {
        let field = PrimeField::random(rng);
        let loaded = program.load(field).ok()?;
        let inputs = draw_residues(&program, &field, rng);
        let values = loaded.run(&inputs, &mut Vec::new()).ok()?;
        let rows: Vec<Vec<u64>> = values.chunks(columns.max(1)).map(<[u64]>::to_vec).collect();
        Some(rank(modular::Residues(field), &rows))
    })
}

/// What moves the states and what is measured of them, with values of parameters.
fn motion(system: &mut System, values: &Assignment) -> Motion {
    let states = system.states.clone();
    let zero = system.graph.integer(0);
    let mut fields = Vec::new();
    for field in system.moving_fields() {
        let components = &system.fields[field].components;
        let rate =
            |state: &Symbol| components.iter().find(|(moved, _)| moved == state).map_or(zero, |(_, r)| *r);
        let rates: Vec<NodeId> = states.iter().map(rate).collect();
        fields.push(system.graph.substitute(&rates, values));
    }
    let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, output)| *output).collect();
    let outputs = system.graph.substitute(&outputs, values);
    let guards = system.smooth_guards(&system.moving_fields());
    Motion { states, fields, outputs, guards }
}

/// The place of each column's coordinate among the states.
fn places(system: &System, source: &KernelSource) -> Vec<usize> {
    let place = |column: usize| system.states.iter().position(|state| *state == source.coordinate(column));
    (0..system.unknown_count()).filter_map(place).collect()
}

fn field_nodes(system: &mut System, source: &KernelSource, field: &FieldTerms) -> Vec<NodeId> {
    let places = places(system, source);
    let mut vector = vec![system.graph.integer(0); system.states.len()];
    for part in &field.components {
        let top = polynomial_node(&mut system.graph, &source.variables, &part.top);
        vector[places[part.column]] = match &part.bottom {
            None => top,
            Some(bottom) => {
                let bottom = polynomial_node(&mut system.graph, &source.variables, bottom);
                system.graph.div(top, bottom)
            }
        };
    }
    vector
}

fn unseen_field(
    system: &System,
    source: &KernelSource,
    field: &FieldTerms,
    vector: &[NodeId],
    log2_error: f64,
) -> UnobservableField {
    let places = places(system, source);
    let component = |part: &Component| FieldComponent {
        state: source.coordinate(part.column),
        name: system.symbol_name(source.coordinate(part.column)).to_owned(),
        rate: vector[places[part.column]],
        text: part.text(&system.graph, &source.variables),
    };
    UnobservableField { components: field.components.iter().map(component).collect(), log2_error }
}

fn factor_nodes(
    graph: &mut Graph,
    variables: &[SymbolInput],
    function: &FunctionTerms,
) -> Vec<(NodeId, i32)> {
    let factor = |(polynomial, exponent): &(Polynomial, i64)| {
        let power = i32::try_from(*exponent).unwrap_or(i32::MAX);
        (polynomial_node(graph, variables, polynomial), power)
    };
    function.factors.iter().map(factor).collect()
}

/// The product of powers, with a numerator and a denominator.
fn product(graph: &mut Graph, factors: &[(NodeId, i32)]) -> NodeId {
    let (mut top, mut bottom) = (graph.integer(1), graph.integer(1));
    for (factor, exponent) in factors {
        let power = graph.power(*factor, exponent.saturating_abs());
        let side = if *exponent > 0 { &mut top } else { &mut bottom };
        *side = graph.mul(*side, power);
    }
    graph.div(top, bottom)
}
