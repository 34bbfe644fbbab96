//! Do generators satisfy any equation beside the known ones?
//!
//! *Ax's theorem* (the functional case of Schanuel's conjecture): let `y_1, ..., y_N` be analytic functions on a connected open set
//! such that no sum of rational multiples of them is constant, unless all multiples are zero. Then of `y_1, ..., y_N, exp(y_1), ...,
//! exp(y_N)` at least `N` plus the rank of the derivatives of the `y` are algebraically independent over the constants.
//!
//! Take for the `y` the exponents of the exponentials; the logarithms, whose exponentials are algebraic; `i` times the angles of
//! sines and cosines; `2 i` times inverse tangents and `i` times inverse sines, whose exponentials are algebraic too; and as many
//! of the symbols as are not yet sums of these and constants. All that was named lies in a field that is made, up to algebraic
//! functions, of the symbols and of one function for each of the others. So there are as many independent functions as there are
//! generators: these satisfy no equation on any component of the domain. To be shown is that no sum of rational multiples of the
//! `y` is constant: separately for real and imaginary ones, that no combination of their differentials vanishes. Differentials are
//! rational in generators that come before, so that it may be shown over generators, at random points modulo one prime: what is
//! independent there is independent.
//!
//! *Roots* of functions that are not squares of one another: if no product of some radicands is a constant times a square, then
//! each root doubles the degree. Were one, the product of their quadratic characters modulo a prime would be the same at all
//! points; so it suffices that the characters at some points are independent, together with the constant one, over two elements.
//!
//! Reference: J. Ax, *On Schanuel's conjectures*, Ann. of Math. 93 (1971).

use super::Adjunction;
use super::form::Form;
use super::generators::Key;
use crate::expression::{Input, NodeId, Program};
use crate::number::{Arithmetic, Function, PrimeField};
use dashu::rational::RBig;
use std::collections::BTreeSet;

/// What is known of the generators of some expressions.
pub(super) struct Standing {
    /// Those that are no constants satisfy no equation but the known ones.
    pub independent: bool,
    /// At most one constant is no algebraic number.
    pub constants_known: bool,
    /// Arguments of absolute values whose signs are not known, and other forms whose signs distinguish roots.
    pub open: Vec<Form>,
}

/// Points at which characters are looked at.
const CHARACTERS: usize = 96;
/// No more functions are looked at.
const MOST: usize = 60;

impl Adjunction<'_> {
    pub(super) fn standing(&mut self, nodes: &[NodeId]) -> Standing {
        let variables = self.variables_below(nodes);
        let varying: BTreeSet<u32> = variables.iter().copied().filter(|v| self.varies(*v)).collect();
        let constants: Vec<u32> = variables.iter().copied().filter(|v| !varying.contains(v)).collect();
        let is_transcendental = |v: &u32| {
            !matches!(self.generators.key(*v), Key::Root(_) | Key::Turn | Key::Part(_) | Key::Inverse(_))
        };
        let transcendental: Vec<u32> = constants.iter().copied().filter(is_transcendental).collect();
        // sines and cosines of one constant are one
        let transcendental =
            transcendental.iter().filter(|v| !matches!(self.generators.key(**v), Key::Cosine(_))).count();
        let nested = constants.iter().any(|v| match self.generators.key(*v) {
            Key::Root(form) => !form.variables().is_empty(),
            Key::Exp(monomial) | Key::Sine(monomial) | Key::Cosine(monomial) => !monomial.is_empty(),
            Key::Log(form) | Key::Value(_, form) => form.as_constant().is_none(),
            Key::Pi | Key::Turn => false,
            _ => true,
        });
        let divided = self.generators.turn.minimal.len() > 1;
        let has_root = constants.iter().any(|v| matches!(self.generators.key(*v), Key::Root(_)));
        let constants_known = transcendental <= 1 && !nested && !(divided && has_root);
        let mut open = Vec::new();
        for variable in &varying {
            if let Key::Abs(form) = self.generators.key(*variable) {
                open.push(form.clone());
            }
        }
        if !open.is_empty() {
            return Standing { independent: false, constants_known, open };
        }
        let radicands: Vec<Form> = varying
            .iter()
            .filter_map(|v| match self.generators.key(*v) {
                Key::Root(form) => Some(form.clone()),
                _ => None,
            })
            .collect();
        // the constants within arguments have to be known; as factors of entries they need not
        let within = self.constants_within(&varying);
        let known = match within {
            0 => !(divided && has_root),
            _ => constants_known,
        };
        let apart = self.are_no_squares(&radicands);
        if !apart {
            open = self.undecided_factors(&radicands);
        }
        // the principal value of an inverse function of functions is another one from part to part, and asin(2 t/(1 + t^2)) is 2 atan(t) on one
        let has_parts = varying.iter().any(|v| match self.generators.key(*v) {
            Key::Value(Function::Asin | Function::Acos, _) => true,
            Key::Value(_, form) => {
                form.variables().iter().any(|inner| !matches!(self.generators.key(*inner), Key::Symbol(_)))
            }
            _ => false,
        });
        let independent =
            known && apart && !has_parts && self.differentials_are_independent(&varying) == Some(true);
        Standing { independent, constants_known, open }
    }

    /// All generators of which expressions are made.
    fn variables_below(&self, nodes: &[NodeId]) -> BTreeSet<u32> {
        let mut open: Vec<u32> = Vec::new();
        for symbol in self.graph.symbols_of(nodes.iter().copied()) {
            match self.generators.circles.get(&symbol) {
                Some(circle) => open.push(*circle),
                None => open.extend(self.generators.of_symbol(symbol)),
            }
        }
        let mut found = BTreeSet::new();
        while let Some(variable) = open.pop() {
            if found.insert(variable) {
                open.extend(self.parts_of(variable));
            }
        }
        found
    }

    /// The generators in the definition of one.
    fn parts_of(&self, variable: u32) -> Vec<u32> {
        match self.generators.key(variable) {
            Key::Symbol(_) | Key::Pi | Key::Turn | Key::Opaque(..) => Vec::new(),
            Key::Exp(monomial) | Key::Sine(monomial) | Key::Cosine(monomial) => {
                monomial.iter().map(|(variable, _)| *variable).collect()
            }
            Key::Root(form)
            | Key::Abs(form)
            | Key::Log(form)
            | Key::Power(form, _)
            | Key::Value(_, form)
            | Key::Inverse(form) => form.variables(),
            Key::Part(whole) => vec![*whole],
        }
    }

    /// Whether a symbol stands in it; what is not known is taken to vary.
    fn varies(&self, variable: u32) -> bool {
        let (mut open, mut seen) = (vec![variable], BTreeSet::new());
        while let Some(next) = open.pop() {
            if matches!(self.generators.key(next), Key::Symbol(_) | Key::Opaque(..)) {
                return true;
            }
            if seen.insert(next) {
                open.extend(self.parts_of(next));
            }
        }
        false
    }

    /// How many constants stand in the arguments of functions that vary.
    fn constants_within(&self, varying: &BTreeSet<u32>) -> usize {
        let inner: BTreeSet<u32> = varying.iter().flat_map(|v| self.parts_of(*v)).collect();
        inner.iter().filter(|v| !varying.contains(v)).count()
    }

    /// The differentials of the `y`, separately for real and imaginary ones; whether these are shown to be independent.
    fn differentials_are_independent(&mut self, varying: &BTreeSet<u32>) -> Option<bool> {
        let symbols: Vec<u32> = varying.iter().copied().filter(|v| self.given_symbol(*v).is_some()).collect();
        let (mut real, mut imaginary) = (Vec::new(), Vec::new());
        for variable in varying {
            match self.generators.key(*variable).clone() {
                Key::Symbol(_) | Key::Part(_) | Key::Root(_) | Key::Inverse(_) | Key::Pi | Key::Turn => {}
                Key::Exp(monomial) => real.push(Form::term(monomial, RBig::ONE)),
                Key::Log(_) => real.push(Form::variable(*variable)),
                Key::Sine(monomial) => imaginary.push(Form::term(monomial, RBig::ONE)),
                // it comes with its sine
                Key::Cosine(monomial) => {
                    let form = Form::term(monomial, RBig::ONE);
                    if !imaginary.contains(&form) {
                        imaginary.push(form);
                    }
                }
                Key::Value(..) => imaginary.push(Form::variable(*variable)),
                Key::Abs(_) | Key::Power(..) | Key::Opaque(..) => return None,
            }
        }
        if real.len() + imaginary.len() > MOST || symbols.len() > MOST {
            return None;
        }
        imaginary.dedup();
        for list in [real, imaginary] {
            if !list.is_empty() && !self.are_independent(&list, &symbols)? {
                return Some(false);
            }
        }
        Some(true)
    }

    /// Whether no product of some of the radicands is shown to be a constant times a square.
    fn are_no_squares(&mut self, radicands: &[Form]) -> bool {
        if radicands.is_empty() {
            return true;
        }
        if radicands.len() > MOST {
            return false;
        }
        let nodes: Vec<NodeId> = radicands.iter().map(|form| self.node_of_form(form)).collect();
        // roots within roots have no characters here
        if !self.roots_below(&nodes).is_empty() || self.generators.turn.minimal.len() > 1 {
            return false;
        }
        // a constant that is drawn anew at each point would distinguish what differs by its root alone
        if radicands.iter().flat_map(Form::variables).any(|variable| !self.varies(variable)) {
            return false;
        }
        let program = self.program(&nodes);
        let field = PrimeField::random(&mut self.rng);
        let mut rows: Vec<Vec<bool>> = vec![Vec::new(); radicands.len() + 1];
        for _ in 0..2 * CHARACTERS {
            let Some(values) = self.plain_point(&program, &field) else { continue };
            let characters: Option<Vec<bool>> =
                values.iter().map(|value| is_square(&field, *value)).collect();
            let Some(characters) = characters else { continue };
            rows[0].push(true);
            rows.iter_mut().skip(1).zip(characters).for_each(|(row, square)| row.push(!square));
            if rows[0].len() == CHARACTERS {
                break;
            }
        }
        rank_of_bits(rows) == radicands.len() + 1
    }

    /// The values of a program that needs no roots at a random point.
    fn plain_point(&mut self, program: &Program, field: &PrimeField) -> Option<Vec<u64>> {
        if program.inputs().iter().any(|input| matches!(input, Input::Opaque(_))) {
            return None;
        }
        let inputs = crate::expression::draw_residues(program, field, &mut self.rng);
        program.load(*field).ok()?.run(&inputs, &mut Vec::new()).ok()
    }

    /// The factors of radicands that belong together whose signs are not known.
    fn undecided_factors(&mut self, radicands: &[Form]) -> Vec<Form> {
        let mut found = Vec::new();
        for radicand in radicands {
            let Some(factored) = self.factored(radicand) else { continue };
            if factored.bases.len() < 2 {
                continue;
            }
            for (base, _) in factored.bases {
                if self.sign(&base).is_none() && !found.contains(&base) {
                    found.push(base);
                }
            }
        }
        found
    }
}

/// The rank of some rows over two elements.
fn rank_of_bits(mut rows: Vec<Vec<bool>>) -> usize {
    let (mut rank, columns) = (0, rows.first().map_or(0, Vec::len));
    for column in 0..columns {
        let Some(found) = (rank..rows.len()).find(|row| rows[*row][column]) else { continue };
        rows.swap(rank, found);
        let (above, below) = rows.split_at_mut(rank + 1);
        for row in below.iter_mut().filter(|row| row[column]) {
            row.iter_mut().zip(&above[rank]).for_each(|(entry, p)| *entry ^= p);
        }
        rank += 1;
    }
    rank
}

/// Whether a residue is a square; nothing for zero.
fn is_square(field: &PrimeField, value: u64) -> Option<bool> {
    if value == 0 {
        return None;
    }
    let (mut power, mut base, mut exponent) = (field.integer(&1.into()), value, (field.modulus() - 1) / 2);
    while exponent > 0 {
        if exponent & 1 == 1 {
            power = field.mul(&power, &base).ok()?;
        }
        base = field.mul(&base, &base).ok()?;
        exponent >>= 1;
    }
    Some(power == field.integer(&1.into()))
}
