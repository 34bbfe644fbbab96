//! Generators of the field of identifiable functions: rational functions of the unknowns that have one value for given outputs, of which
//! every other such function is a rational function.
//!
//! What is looked for has the value of a random point on slices of that point's fibre: linear equations for the coefficients of a polynomial,
//! also of one over a product of unknowns. That a function found so has one value is counted again
//! as for any expression. Functions generate the whole field if they have as many points in common as the outputs have: both fields have the field of all unknowns
//! (over which those that are free are held) as an extension, of a degree that is the number of these points, and one contains the other.
//!
//! Reference: A. Ovchinnikov, A. Pillay, G. Pogudin and T. Scanlon, *Computing all identifiable functions of parameters for ODE models*,
//! Systems & Control Letters 157 (2021), for the field and its generators; here they come from fibres and not from input-output equations.

use super::modular::{Echelon, Residues, in_integers, simple_vectors};
use super::monomial::{Monomial, Polynomial, count};
use super::{FunctionTerms, factor_nodes, product, unseen_motions};
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
use std::collections::BTreeMap;

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
    /// Functions without which those that are left generate less.
    pub functions: Vec<IdentifiableFunction>,
    /// So many further functions, independent of these, are identifiable locally.
    pub missing: usize,
    /// How many states and constants have the same values of these functions, and how many have the same outputs, those that are not locally
    /// determined held: where the two are equal the functions generate all.
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

/// No more unknown coefficients are solved for at once.
const MOST_UNKNOWNS: usize = 330;
/// Nor polynomials of a higher degree.
const HIGHEST_DEGREE: usize = 3;
/// Nor powers of one unknown.
const HIGHEST_POWER: usize = 8;
/// Denominators are products of so many unknowns at most.
const HIGHEST_BELOW: usize = 2;
/// Nor more denominators than this.
const MOST_BELOW: usize = 60;
/// No more functions are tried for whether they tell points apart that the others do not.
const MOST_TRIED: usize = 24;
/// A function with a longer text is none that anybody reads.
const LONGEST_TEXT: usize = 400;
/// So many slices that add nothing end the search for equations.
const IDLE: usize = 2;

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
        Solutions::Undecided(why) => Some(format!("how many values {} has is undecided: {why}", of_it.name)),
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

/// What is known of one slice: of each monomial its values on the slice, and its value at the point.
struct Sliced {
    forms: Vec<Vec<u64>>,
    own: Vec<u64>,
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
        let Some(found) = unseen_motions(self.system, None, &values, &values) else { return };
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

    /// The highest degree whose monomials were looked at.
    fn degree(&self) -> usize {
        self.monomials.iter().map(Monomial::degree).max().unwrap_or(0)
    }

    /// Chooses the monomials, by how many there are.
    ///
    /// # Errors
    /// Where the unknowns are too many.
    fn prepare(&mut self) -> Result<(), String> {
        let all: Vec<usize> = (0..self.variables.len()).collect();
        let open: Vec<usize> = all.iter().copied().filter(|place| self.is_open[*place]).collect();
        // what has one value may stand beside what has not, as in x1*p1 + x2*p2
        let degrees = (1..=HIGHEST_DEGREE)
            .rev()
            .flat_map(|of_open| (1..=of_open).rev().map(move |of_all| (of_open, of_all)));
        let fits = |(of_open, of_all): &(usize, usize)| {
            let both = count(all.len(), *of_all) + count(open.len(), *of_open) - count(open.len(), *of_all);
            both <= MOST_UNKNOWNS
        };
        let (of_open, of_all) = degrees
            .into_iter()
            .find(fits)
            .ok_or_else(|| format!("{} variables have too many monomials to be looked at", all.len()))?;
        let mut last = vec![Monomial::default()];
        self.monomials = last.clone();
        for degree in 1..=of_open {
            let mut next = Vec::new();
            for monomial in &last {
                let most = monomial.powers.first().map_or(usize::MAX, |(place, _)| *place);
                let is_all_open = monomial.powers.iter().all(|(place, _)| self.is_open[*place]);
                for place in all.iter().filter(|place| **place <= most) {
                    let is_squared_sine =
                        *place == most && self.variables[*place].function == SymbolFunction::Sine;
                    let is_wanted = degree <= of_all || (is_all_open && self.is_open[*place]);
                    // the square of a sine is one less that of the cosine
                    if is_wanted && !is_squared_sine {
                        next.push(times(monomial, *place));
                    }
                }
            }
            self.monomials.extend(next.iter().cloned());
            last = next;
        }
        // of one unknown as many powers as it has values, as in p^4
        for place in open {
            let values = self.values[place].min(HIGHEST_POWER);
            for power in of_open + 1..=values {
                self.monomials.push(Monomial { powers: vec![(place, power as u8)], angle: None });
            }
        }
        Ok(())
    }

    /// One more slice, with all monomials on it.
    fn slice(&mut self) -> Result<(), String> {
        let mut slice = self.slicer.next()?;
        let place: BTreeMap<&Monomial, usize> = self.monomials.iter().zip(0..).collect();
        let mut sliced = Sliced { forms: Vec::new(), own: Vec::new() };
        for monomial in &self.monomials {
            let (form, own) = match monomial.powers.first() {
                None => (slice.one(), self.residues.one()),
                Some((variable, power)) => {
                    let mut rest = monomial.clone();
                    match power {
                        1 => drop(rest.powers.remove(0)),
                        _ => rest.powers[0].1 -= 1,
                    }
                    let known = place[&rest];
                    let form = slice.times(*variable, &sliced.forms[known]);
                    (form, self.residues.mul(slice.own[*variable], sliced.own[known]))
                }
            };
            sliced.forms.push(form);
            sliced.own.push(own);
        }
        self.slices.push(sliced);
        Ok(())
    }

    /// Polynomials up to a degree that have one value, over all products of so many unknowns; whether there are new ones.
    ///
    /// # Errors
    /// In words, where slices take too much work.
    fn polynomials(&mut self, degree: usize, below: usize) -> Result<bool, String> {
        let is_below = |monomial: &Monomial| {
            monomial.degree() == below
                && monomial.powers.iter().all(|(place, _)| {
                    self.is_open[*place] && self.variables[*place].function == SymbolFunction::Itself
                })
        };
        let bottoms: Vec<usize> = (0..self.monomials.len())
            .filter(|place| is_below(&self.monomials[*place]))
            .take(MOST_BELOW)
            .collect();
        let before = self.candidates.len();
        for bottom in bottoms {
            let has_open =
                |monomial: &Monomial| monomial.powers.iter().any(|(place, _)| self.is_open[*place]);
            let is_above = |place: &usize| {
                let monomial = &self.monomials[*place];
                let changes = below > 0 || has_open(monomial);
                *place != bottom && monomial.degree() <= degree && changes
            };
            let tops: Vec<usize> = (0..self.monomials.len()).filter(is_above).collect();
            for vector in self.solved(&tops, bottom)? {
                self.candidate(&tops, &vector, bottom);
            }
        }
        Ok(self.candidates.len() > before)
    }

    /// The combinations of monomials that are a multiple of another one by what the point has: a basis with few terms.
    fn solved(&mut self, tops: &[usize], bottom: usize) -> Result<Vec<Vec<u64>>, String> {
        let r = self.residues;
        let mut echelon = Echelon::new(r, tops.len());
        let (mut idle, mut next) = (0, 0);
        while idle < IDLE && echelon.rank() < tops.len() {
            if next == self.slices.len() {
                self.slice()?;
            }
            let (slice, before) = (&self.slices[next], echelon.rank());
            next += 1;
            for point in 0..slice.forms[bottom].len() {
                let entry = |top: &usize| {
                    let here = r.mul(slice.forms[*top][point], slice.own[bottom]);
                    r.sub(here, r.mul(slice.forms[bottom][point], slice.own[*top]))
                };
                echelon.add(tops.iter().map(entry).collect());
            }
            idle = if echelon.rank() == before { idle + 1 } else { 0 };
        }
        let cost = |place: usize| self.monomials[tops[place]].degree() as u64;
        let mut emptied: Vec<usize> = (0..tops.len()).collect();
        emptied.sort_by_key(|place| std::cmp::Reverse(cost(*place)));
        Ok(simple_vectors(r, &echelon.kernel().1, &cost, &emptied))
    }

    /// Takes a combination of monomials over one for a candidate, unless it is one already or an unknown divides both.
    fn candidate(&mut self, tops: &[usize], vector: &[u64], bottom: usize) {
        let Some(vector) = in_integers(self.residues, vector) else { return };
        let terms = tops.iter().zip(&vector).filter(|(_, coefficient)| **coefficient != 0);
        let polynomial: Polynomial = terms.map(|(top, c)| (self.monomials[*top].clone(), *c)).collect();
        let bottom = self.monomials[bottom].clone();
        let divides = |place: usize| {
            let has_it = |(monomial, _): &(Monomial, i64)| monomial.powers.iter().any(|(of, _)| *of == place);
            polynomial.iter().all(has_it)
        };
        if polynomial.is_empty() || bottom.powers.iter().any(|(place, _)| divides(*place)) {
            return;
        }
        let mut factors = vec![(polynomial, 1)];
        for (place, power) in bottom.powers {
            factors.push((vec![(Monomial::variable(place), 1)], -i64::from(power)));
        }
        let function = FunctionTerms { factors };
        let text = function.text(&self.system.graph, &self.variables);
        if self.candidates.iter().any(|known| known.text == text) {
            return;
        }
        let graph = &mut self.system.graph;
        let factors = factor_nodes(graph, &self.variables, &function);
        let value = product(graph, &factors);
        self.candidates.push(Candidate::function(text, value));
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

    /// Adds functions that tell points apart, and leaves out those that tell none apart; how many points the rest has in common.
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

/// A monomial times a variable that stands before all of its own, or is the first of them.
fn times(monomial: &Monomial, place: usize) -> Monomial {
    let mut powers = monomial.powers.clone();
    match powers.first_mut() {
        Some((first, power)) if *first == place => *power += 1,
        _ => powers.insert(0, (place, 1)),
    }
    Monomial { powers, angle: None }
}
