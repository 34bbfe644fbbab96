//! Generators of the field of identifiable functions: rational functions of the unknowns that have one value for given outputs, of which
//! every other such function is a rational function.
//!
//! What is looked for has the value of a random point on slices of that point's fibre: linear equations for the coefficients of a polynomial,
//! also of one over a product of unknowns. That a function found so has one value is counted again
//! as for any expression. Functions generate the whole field if they have as many points in common as the outputs have: both fields have the field of all unknowns
//! (over which those that are free are fixed) as an extension, of a degree that is the number of these points, and one contains the other.
//!
//! Reference: A. Ovchinnikov, A. Pillay, G. Pogudin and T. Scanlon, *Computing all identifiable functions of parameters for ODE models*,
//! Systems & Control Letters 157 (2021), for the field and its generators; here they come from fibres and not from input-output equations.

mod polynomials;

use self::polynomials::Sliced;
use super::modular::{Echelon, Residues};
use super::monomial::Monomial;
use super::unobservable_directions;
use crate::observability::fibre::{
    SlicedVariable, Slicer, Solutions, SolutionsAnswer, SolutionsOf, SolutionsQuestion, solutions,
};
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{
    Input, NodeId, Program, Symbol, SymbolFunction, SymbolInput, draw_residues, expand_angles, gradient,
};
use palmistry_math::number::{Function, PrimeField};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// A function of the unknowns that has one value for given outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentifiableFunction {
    /// In the notation of the language.
    pub text: String,
    /// Whether it is an unknown itself.
    pub is_unknown: bool,
    /// That it has one value errs with a probability below two to this power, minus infinity where it is measured; nothing where it was computed at
    /// random points and no more.
    pub log2_error: Option<f64>,
}

/// What was found of the field of identifiable functions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IdentifiableFunctions {
    /// Generators, each of which is needed: the others alone generate less.
    pub functions: Vec<IdentifiableFunction>,
    /// How many further functions, independent of these, are locally identifiable.
    pub missing: usize,
    /// How many states and constants have the same values of these functions, and how many have the same outputs, with those fixed that are not locally
    /// observable: where the two are equal the functions generate all.
    pub common: Option<[usize; 2]>,
    /// Why nothing, or not all, is known.
    pub open: Option<String>,
}

impl IdentifiableFunctions {
    /// Whether every identifiable function is a rational function of these, as computed at random points.
    pub fn generate_all(&self) -> bool {
        self.missing == 0 && self.common.is_some_and(|[common, outputs]| common == outputs)
    }
}

/// Denominators are products of so many unknowns at most.
const HIGHEST_BELOW: usize = 2;
/// No more functions are tried for whether they distinguish points that the others do not.
const MOST_TRIED: usize = 24;
/// Functions with a longer text are left out: nobody would read them.
const LONGEST_TEXT: usize = 400;

/// A candidate, with the functions that stand for it: cosine and sine of an angle, else one.
#[derive(Clone, Debug)]
struct Candidate {
    text: String,
    nodes: Vec<NodeId>,
    is_unknown: bool,
    /// Whether it is an output, or the derivative of one along the motion: nothing is left to be counted.
    is_measured: bool,
}

impl Candidate {
    fn function(text: String, value: NodeId) -> Candidate {
        Candidate { text, nodes: vec![value], is_unknown: false, is_measured: false }
    }
}

/// Generators of the field of identifiable functions, after the values of the unknowns were counted.
pub fn identifiable_functions(
    system: &mut System,
    question: &SolutionsQuestion<'_>,
    counted: &SolutionsAnswer,
) -> IdentifiableFunctions {
    let open = |why: String| IdentifiableFunctions { open: Some(why), ..IdentifiableFunctions::default() };
    let undecided = counted.unknowns.iter().find_map(|of_it| match &of_it.solutions {
        Solutions::Undecided(why) => {
            Some(format!("the number of solutions of {} is undecided: {why}", of_it.name))
        }
        _ => None,
    });
    let (None, Some(points)) = (&undecided, counted.points) else {
        return open(undecided.unwrap_or_else(|| "no values were counted".to_owned()));
    };
    match Slicer::new(system, question) {
        Ok(slicer) => {
            slicer.spend(counted.work);
            Search::new(system, question, counted, slicer, points).run()
        }
        Err(why) => open(why),
    }
}

struct Search<'a> {
    system: &'a mut System,
    question: &'a SolutionsQuestion<'a>,
    counted: &'a SolutionsAnswer,
    slicer: Slicer<'a>,
    /// How many states and constants give the same outputs.
    points: usize,
    /// How many independent functions there are.
    wanted: usize,
    residues: Residues,
    /// What monomials are made of.
    variables: Vec<SymbolInput>,
    /// Of which of these the unknown has several values, and how many where they are finitely many and it is no angle.
    is_open: Vec<bool>,
    values: Vec<usize>,
    monomials: Vec<Monomial>,
    slices: Vec<Sliced>,
    candidates: Vec<Candidate>,
    rng: ChaCha8Rng,
}

impl<'a> Search<'a> {
    fn new(
        system: &'a mut System,
        question: &'a SolutionsQuestion<'a>,
        counted: &'a SolutionsAnswer,
        slicer: Slicer<'a>,
        points: usize,
    ) -> Search<'a> {
        let input = |variable: &SlicedVariable| match variable.input {
            Input::Cosine(symbol) => Some(SymbolInput { symbol, function: SymbolFunction::Cosine }),
            Input::Sine(symbol) => Some(SymbolInput { symbol, function: SymbolFunction::Sine }),
            Input::Plain(symbol) => Some(SymbolInput { symbol, function: SymbolFunction::Itself }),
            Input::Opaque(_) => None,
        };
        let is_open = |variable: &SlicedVariable| {
            let several = |unknown: usize| counted.unknowns[unknown].solutions != Solutions::Finite(1);
            variable.unknown.is_some_and(several)
        };
        let values = |variable: &SlicedVariable| match (variable.unknown, variable.input) {
            (Some(unknown), Input::Plain(_)) => match counted.unknowns[unknown].solutions {
                Solutions::Finite(values) => values,
                _ => 0,
            },
            _ => 0,
        };
        let of_all = |variable| Some((input(variable)?, (is_open(variable), values(variable))));
        let (variables, (is_open, values)): (Vec<_>, (Vec<_>, Vec<_>)) =
            slicer.variables().iter().map_while(of_all).unzip();
        Search {
            question,
            counted,
            points,
            wanted: system.unknown_count() - slicer.free(),
            residues: Residues(slicer.field()),
            variables,
            is_open,
            values,
            monomials: Vec::new(),
            slices: Vec::new(),
            candidates: Vec::new(),
            rng: ChaCha8Rng::seed_from_u64(0x6765_6e65_7261), // any fixed seed: what is found is counted again
            slicer,
            system,
        }
    }

    fn run(mut self) -> IdentifiableFunctions {
        let unknowns = self.system.unknowns();
        for (symbol, of_it) in unknowns.iter().zip(&self.counted.unknowns) {
            if of_it.solutions == Solutions::Finite(1) {
                let nodes = self.coordinates_of(*symbol);
                let text = of_it.name.clone();
                self.candidates.push(Candidate { text, nodes, is_unknown: true, is_measured: false });
            }
        }
        let mut found = self.chosen();
        if found.generate_all() {
            return self.proved(found);
        }
        if self.counted.unknowns.iter().any(|of_it| of_it.solutions == Solutions::Infinite) {
            self.by_symmetry();
            found = self.chosen();
        }
        let mut open = None;
        if !found.generate_all() {
            open = self.prepare().err();
            'search: for below in 0..=HIGHEST_BELOW {
                for degree in 1..=self.degree() {
                    if open.is_some() {
                        break 'search;
                    }
                    match self.polynomials(degree, below) {
                        Ok(true) => found = self.chosen(),
                        Ok(false) => {}
                        Err(why) => open = Some(why),
                    }
                    if found.generate_all() {
                        break 'search;
                    }
                }
            }
        }
        if found.missing > 0 {
            found = self.by_motion(found);
        }
        if !found.generate_all() && found.open.is_none() {
            found.open = open;
        }
        self.proved(found)
    }

    /// Adds outputs, and derivatives along the motion of what was found: these have one value too. They are longer than what was looked for before.
    fn by_motion(&mut self, mut found: IdentifiableFunctions) -> IdentifiableFunctions {
        let outputs: Vec<NodeId> = self.system.outputs.iter().map(|(_, output)| *output).collect();
        for output in outputs {
            self.measured(output, true);
        }
        let fields = self.system.moving_fields();
        let mut done = 0;
        loop {
            let missing = found.missing;
            found = self.chosen();
            let known = |one: &Candidate| found.functions.iter().any(|of_it| of_it.text == one.text);
            let functions: Vec<(NodeId, bool)> = self
                .candidates
                .iter()
                .filter(|one| known(one) && !one.is_unknown)
                .map(|one| (one.nodes[0], one.is_measured))
                .collect();
            // a derivative that adds nothing may have one that does, but not where all of them add nothing
            if found.missing == 0 || (done > 0 && found.missing == missing) {
                return found;
            }
            for (function, is_measured) in functions {
                for field in &fields {
                    let derivative = self.system.lie_derivative(*field, function);
                    self.measured(derivative, is_measured);
                }
            }
            done += 1;
        }
    }

    /// Takes an expression for a candidate that has one value, where it is short enough to be read.
    fn measured(&mut self, value: NodeId, is_measured: bool) {
        let value = self.system.graph.substitute(&[value], &self.question.conditions)[0];
        let text = self.system.graph.text(value);
        let is_new = self.candidates.iter().all(|known| known.text != text);
        if is_new && text.len() <= LONGEST_TEXT && self.system.graph.constant_value(value).is_none() {
            self.candidates.push(Candidate { is_measured, ..Candidate::function(text, value) });
        }
    }

    /// An unknown itself, or cosine and sine of an angle.
    fn coordinates_of(&mut self, symbol: Symbol) -> Vec<NodeId> {
        let node = self.system.graph.symbol(symbol);
        match self.system.is_angle(symbol) {
            true => [Function::Cos, Function::Sin].map(|of| self.system.graph.apply(of, node)).to_vec(),
            false => vec![node],
        }
    }

    /// What symmetries leave unchanged, where it has one value.
    fn by_symmetry(&mut self) {
        let values: Assignment = self.question.conditions.clone();
        let Some(found) = unobservable_directions(self.system, None, &values, &values) else { return };
        let expressions: Vec<(String, NodeId)> =
            found.functions.into_iter().map(|function| (function.text, function.value)).collect();
        let counted = self.values_of(expressions.clone());
        for ((text, value), of_it) in expressions.into_iter().zip(counted) {
            if of_it.solutions == Solutions::Finite(1) {
                self.candidates.push(Candidate::function(text, value));
            }
        }
    }

    /// How many values some expressions have, by what work is left.
    fn values_of(&mut self, expressions: Vec<(String, NodeId)>) -> Vec<SolutionsOf> {
        let work = self.question.work.saturating_sub(self.slicer.work());
        if expressions.is_empty() || work == 0 {
            return Vec::new();
        }
        let (conditions, interrupt) = (self.question.conditions.clone(), self.question.interrupt);
        let question = SolutionsQuestion { conditions, expressions, work, interrupt };
        let Ok(answer) = solutions(self.system, &question) else { return Vec::new() };
        self.slicer.spend(answer.work);
        answer.unknowns.into_iter().skip(self.counted.unknowns.len()).collect()
    }

    /// The shortest of the candidates that generate as much as all of them do.
    fn chosen(&mut self) -> IdentifiableFunctions {
        // unknowns stay in the order of the file
        let key = |one: &Candidate| match one.is_unknown {
            true => (false, 0, String::new()),
            false => (true, one.text.len(), one.text.clone()),
        };
        self.candidates.sort_by_cached_key(key);
        let mut kept = self.independent();
        let missing = self.wanted - kept.len().min(self.wanted);
        let mut found = IdentifiableFunctions { missing, ..IdentifiableFunctions::default() };
        if missing == 0 {
            match self.common(&kept) {
                Err(why) => found.open = Some(why),
                Ok(common) => found.common = Some([self.told_apart(&mut kept, common), self.points]),
            }
        }
        for place in kept {
            let Candidate { text, is_unknown, .. } = self.candidates[place].clone();
            found.functions.push(IdentifiableFunction { text, is_unknown, log2_error: None });
        }
        found
    }

    /// Adds functions that distinguish points, and leaves out those that distinguish none; returns how many points the rest has in common.
    fn told_apart(&mut self, kept: &mut Vec<usize>, mut common: usize) -> usize {
        let others: Vec<usize> = (0..self.candidates.len()).filter(|place| !kept.contains(place)).collect();
        for place in others.into_iter().take(MOST_TRIED) {
            if common <= self.points {
                break;
            }
            let with_it: Vec<usize> = kept.iter().copied().chain([place]).collect();
            if let Ok(fewer) = self.common(&with_it)
                && fewer < common
            {
                (*kept, common) = (with_it, fewer);
            }
        }
        for place in kept.clone().into_iter().rev() {
            let without: Vec<usize> = kept.iter().copied().filter(|other| *other != place).collect();
            if kept.len() > self.wanted && self.common(&without) == Ok(common) {
                *kept = without;
            }
        }
        kept.sort_unstable();
        common
    }

    fn common(&mut self, kept: &[usize]) -> Result<usize, String> {
        let nodes: Vec<NodeId> =
            kept.iter().flat_map(|place| self.candidates[*place].nodes.iter().copied()).collect();
        self.slicer.common_points(self.system, &nodes)
    }

    /// The first candidates whose differentials are independent at a random point.
    fn independent(&mut self) -> Vec<usize> {
        let unknowns = self.system.unknowns();
        let graph = &mut self.system.graph;
        let nodes: Vec<NodeId> = self.candidates.iter().flat_map(|one| one.nodes.iter().copied()).collect();
        let nodes = graph.substitute(&nodes, &self.question.conditions);
        let entries: Vec<NodeId> = nodes.iter().flat_map(|node| gradient(graph, *node, &unknowns)).collect();
        let is_angle = self.system.angle_test();
        let graph = &mut self.system.graph;
        let entries = expand_angles(graph, &entries, &is_angle);
        let program = Program::with_unknown_functions(graph, &entries, &is_angle);
        let draw = |rng: &mut ChaCha8Rng| {
            let field = PrimeField::random(rng);
            let inputs = draw_residues(&program, &field, rng);
            let values = program.load(field).ok()?.run(&inputs, &mut Vec::new()).ok()?.to_vec();
            Some((field, values))
        };
        let Some((field, values)) = (0..super::ATTEMPTS).find_map(|_| draw(&mut self.rng)) else {
            return Vec::new();
        };
        let mut echelon = Echelon::new(Residues(field), unknowns.len());
        let mut rows = values.chunks(unknowns.len());
        let mut kept = Vec::new();
        for (place, one) in self.candidates.iter().enumerate() {
            let raised = rows.by_ref().take(one.nodes.len()).filter(|row| echelon.add(row.to_vec())).count();
            if raised > 0 {
                kept.push(place);
            }
        }
        kept
    }

    /// With what is proved of each function. One that has several values at other points, which the slices missed, is left out.
    fn proved(&mut self, mut found: IdentifiableFunctions) -> IdentifiableFunctions {
        let of = |text: &String| self.candidates.iter().find(|one| one.text == *text);
        let others = found.functions.iter().filter_map(|function| of(&function.text));
        let expressions: Vec<(String, NodeId)> = others
            .filter(|one| !one.is_unknown && !one.is_measured)
            .map(|one| (one.text.clone(), one.nodes[0]))
            .collect();
        let measured: Vec<String> =
            self.candidates.iter().filter(|one| one.is_measured).map(|one| one.text.clone()).collect();
        let counted = self.values_of(expressions);
        let before = found.functions.len();
        found.functions.retain_mut(|function| {
            let all = if function.is_unknown { &self.counted.unknowns } else { &counted };
            let of_it = all.iter().find(|of_it| of_it.name == function.text);
            let at_most = of_it.and_then(|of_it| of_it.at_most).filter(|(most, _)| *most == 1);
            function.log2_error = at_most.map(|(_, log2_error)| log2_error);
            if measured.contains(&function.text) {
                function.log2_error = Some(f64::NEG_INFINITY);
            }
            let stands = |of_it: &SolutionsOf| {
                matches!(of_it.solutions, Solutions::Finite(1) | Solutions::Undecided(_))
            };
            of_it.is_none_or(stands)
        });
        // at a second point, modulo another prime
        if found.generate_all() {
            let kept: Vec<usize> = (0..self.candidates.len())
                .filter(|place| {
                    found.functions.iter().any(|of_it| of_it.text == self.candidates[*place].text)
                })
                .collect();
            if self.common(&kept) != Ok(self.points) {
                found.common = None;
                found.open = Some(
                    "how many points the functions have in common is another number elsewhere".to_owned(),
                );
            }
        }
        let fallen = before - found.functions.len();
        if fallen > 0 {
            found.missing += fallen;
            found.common = None;
            found.open = Some(format!(
                "{fallen} of the functions that were found have several values at other points"
            ));
        }
        found
    }
}
