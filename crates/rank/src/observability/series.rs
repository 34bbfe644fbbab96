//! Repeated Lie derivatives by Taylor series along the flow of a field.
//!
//! Where `x(t)` moves along the field, `x' = f(x)`, the Lie derivatives of `h` are the coefficients of `h(x(t))`:
//! `L_f^k h = k! [t^k] h(x(t))`. The coefficients of all intermediate results are found order by order: those of `f`
//! at order `k` give those of `x` at order `k + 1`, as `x_(k+1) = f_k / (k + 1)`. All derivatives up to order `k` so
//! cost O(k^2) for each operation of `f` and `h`, over any numbers.
//!
//! Over [`Nodes`], whose numbers are expressions, the result is an expression again, of O(k^2) nodes for each node,
//! where differentiating again and again may double from order to order. A Lie derivative along several fields is taken
//! run by run from the inside: `L_f^a L_g^b h` is the series of `h` along `g` in symbols, and then the series of that
//! expression along `f`.
//!
//! Reference: K. Roebenack, *Computation of multiple Lie derivatives by algorithmic differentiation*, J. Comput. Appl.
//! Math. 213 (2008).

use super::flow::{Flow, Operation};
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::{Failure, Input, NodeId, Nodes};
use palmistry_math::number::{Arithmetic, Coefficients, Function, Recurrences, Refusal};
use std::collections::HashMap;

impl Flow {
    /// The Lie derivatives `L_f^k` of each root for `k` from zero to `order`, in the numbers of an arithmetic; `inputs`
    /// are in the order of [`Flow::inputs`].
    ///
    /// # Errors
    /// The first operation that was refused.
    pub fn lie_derivatives<A: Arithmetic>(
        &self,
        arithmetic: &A,
        inputs: &[A::Number],
        order: usize,
    ) -> Result<Vec<Vec<A::Number>>, Failure> {
        let Some(first) = self.roots.first() else { return Ok(Vec::new()) };
        let blame = |place: usize| self.blame(place);
        let general = &blame(*first);
        let signals: Vec<Vec<A::Number>> = inputs.iter().map(|value| vec![value.clone()]).collect();
        let run = self.run(arithmetic, &signals, order)?;
        let zero = arithmetic.rational(&RBig::ZERO).map_err(general)?;
        let mut factorial = RBig::ONE;
        let mut factorials = Vec::new();
        for k in 0..=order {
            factorial *= RBig::from(k.max(1) as u64);
            factorials.push(arithmetic.rational(&factorial).map_err(general)?);
        }
        let scaled = |place: usize| -> Result<Vec<A::Number>, Failure> {
            let terms = run.series[place].iter().zip(&factorials).enumerate();
            terms
                .map(|(k, (term, factorial))| match term {
                    Some(term) if k > 1 => arithmetic.mul(factorial, term).map_err(blame(place)),
                    Some(term) => Ok(term.clone()),
                    None => Ok(zero.clone()),
                })
                .collect()
        };
        self.roots.iter().map(|root| scaled(*root)).collect()
    }

    /// The coefficients of each root along the flow, up to that of `t^order`; `None`, and all beyond the end, are zero. An
    /// input is given by its value, or by the coefficients of a signal that the field does not move.
    ///
    /// # Errors
    /// The first operation that was refused.
    pub(super) fn coefficients<A: Arithmetic>(
        &self,
        arithmetic: &A,
        inputs: &[Vec<A::Number>],
        order: usize,
    ) -> Result<Vec<Coefficients<A::Number>>, Failure> {
        let mut run = self.run(arithmetic, inputs, order)?;
        let mut last: HashMap<usize, usize> = HashMap::new();
        for (index, root) in self.roots.iter().enumerate() {
            last.insert(*root, index);
        }
        let series = |(index, root): (usize, &usize)| match last[root] == index {
            true => std::mem::take(&mut run.series[*root]),
            false => run.series[*root].clone(),
        };
        Ok(self.roots.iter().enumerate().map(series).collect())
    }

    /// All operations, up to that order.
    fn run<'f, A: Arithmetic>(
        &'f self,
        arithmetic: &'f A,
        inputs: &'f [Vec<A::Number>],
        order: usize,
    ) -> Result<Run<'f, A>, Failure> {
        let general = |refusal| Failure {
            refusal,
            node: self.origins[self.roots.first().copied().unwrap_or(0)],
            divisor: None,
        };
        let constants = self.constants.iter().map(|c| arithmetic.rational(c));
        let constants: Vec<A::Number> = constants.collect::<Result<_, _>>().map_err(general)?;
        let mut run = Run {
            flow: self,
            recurrences: Recurrences::new(arithmetic, order).map_err(general)?,
            inputs,
            constants,
            series: vec![Vec::with_capacity(order + 1); self.operations.len()],
            inverses: vec![None; self.operations.len()],
        };
        for k in 0..=order {
            for place in 0..self.operations.len() {
                if k < order || self.needed_last[place] {
                    let term = run.term(place, k).map_err(self.blame(place))?;
                    run.series[place].push(term);
                }
            }
        }
        Ok(run)
    }

    fn blame(&self, place: usize) -> impl Fn(Refusal) -> Failure {
        let (node, divisor) = (self.origins[place], self.divisor(place));
        move |refusal| Failure { refusal, node, divisor }
    }

    fn divisor(&self, place: usize) -> Option<NodeId> {
        match self.operations[place] {
            Operation::Div(_, b) => Some(self.origins[b]),
            _ => None,
        }
    }
}

/// The state of a computation: all coefficients so far.
struct Run<'f, A: Arithmetic> {
    flow: &'f Flow,
    recurrences: Recurrences<&'f A>,
    inputs: &'f [Vec<A::Number>],
    constants: Vec<A::Number>,
    series: Vec<Coefficients<A::Number>>,
    /// The reciprocals of leading coefficients that are divided by.
    inverses: Vec<Option<A::Number>>,
}

impl<A: Arithmetic> Run<'_, A> {
    /// The coefficient of `t^k` of an operation. All operands have theirs.
    fn term(&mut self, place: usize, k: usize) -> Result<Option<A::Number>, Refusal> {
        let operation = self.flow.operations[place];
        if k == 0 {
            return self.first(operation, place);
        }
        // what has not moved so far and whose operands have not either does not move now
        let still = |operand: usize| self.series[operand][1..].iter().all(Option::is_none);
        let moves = matches!(operation, Operation::Input(_) | Operation::Angle);
        if !moves && operation.operands().all(still) {
            return Ok(None);
        }
        let divisor = match operation {
            Operation::Root(_) => {
                let root = self.leading(place);
                root.map(|root| self.recurrences.base().add(&root, &root)).transpose()?
            }
            Operation::Integral(_, _, b) => self.leading(b),
            _ => None,
        };
        if let (Some(divisor), None) = (divisor, &self.inverses[place]) {
            self.inverses[place] = Some(self.reciprocal(&divisor)?);
        }
        let recurrences = &self.recurrences;
        let series = |index: usize| self.series[index].as_slice();
        let at = |index: usize| self.series[index][k].as_ref();
        let inverse = self.inverses[place].as_ref().ok_or(Refusal::DivisionByZero);
        match operation {
            Operation::Constant(_) | Operation::Pi => Ok(None),
            Operation::Input(_) | Operation::Angle => match self.flow.rates.get(&place) {
                Some(rate) => recurrences.over(k, self.series[*rate][k - 1].clone()),
                None => match operation {
                    Operation::Input(input) => Ok(self.inputs[input].get(k).cloned()),
                    _ => Ok(None),
                },
            },
            Operation::Add(a, b) => recurrences.sum(at(a), at(b)),
            Operation::Sub(a, b) => recurrences.difference(at(a), at(b)),
            Operation::Neg(a) => recurrences.negative(at(a)),
            Operation::Mul(a, b) => recurrences.product(k, series(a), series(b)),
            Operation::Square(a) => recurrences.square(k, series(a)),
            Operation::Div(a, b) => recurrences.quotient(k, series(a), series(b), series(place), inverse?),
            Operation::Sine(a, _) => recurrences.driven(k, series(a), series(place + 1)),
            Operation::Cosine(a, _) => {
                let slope = recurrences.driven(k, series(a), series(place - 1))?;
                recurrences.negative(slope.as_ref())
            }
            Operation::Exp(a) => recurrences.driven(k, series(a), series(place)),
            Operation::Root(a) => recurrences.root(k, series(a), series(place), inverse?),
            Operation::Integral(_, a, b) => {
                recurrences.integral(k, series(a), series(b), series(place), inverse?)
            }
        }
    }

    /// The value, at `t = 0`.
    fn first(&mut self, operation: Operation, place: usize) -> Result<Option<A::Number>, Refusal> {
        let base = *self.recurrences.base();
        let apply = |function, a: usize| match self.leading(a) {
            Some(a) => base.apply(function, &a),
            None => base.apply(function, &base.rational(&RBig::ZERO)?),
        };
        let at = |index: usize| self.series[index][0].as_ref();
        match operation {
            Operation::Constant(index) => {
                Ok((!self.flow.constants[index].is_zero()).then(|| self.constants[index].clone()))
            }
            Operation::Pi => base.pi().map(Some),
            Operation::Input(input) => Ok(Some(self.inputs[input][0].clone())),
            Operation::Angle => Ok(None),
            Operation::Add(a, b) => self.recurrences.sum(at(a), at(b)),
            Operation::Sub(a, b) => self.recurrences.difference(at(a), at(b)),
            Operation::Neg(a) => self.recurrences.negative(at(a)),
            Operation::Mul(a, b) => self.recurrences.product(0, &self.series[a], &self.series[b]),
            Operation::Square(a) => self.recurrences.square(0, &self.series[a]),
            Operation::Div(a, b) => {
                let divisor = self.leading(b).ok_or(Refusal::DivisionByZero)?;
                let inverse = self.reciprocal(&divisor)?;
                let value = self.leading(a).map(|a| base.mul(&a, &inverse)).transpose()?;
                self.inverses[place] = Some(inverse);
                Ok(value)
            }
            Operation::Sine(_, Some(input)) | Operation::Cosine(_, Some(input)) => {
                Ok(Some(self.inputs[input][0].clone()))
            }
            Operation::Sine(a, None) => apply(Function::Sin, a).map(Some),
            Operation::Cosine(a, None) => apply(Function::Cos, a).map(Some),
            Operation::Exp(a) => apply(Function::Exp, a).map(Some),
            Operation::Root(a) => apply(Function::Sqrt, a).map(Some),
            Operation::Integral(function, a, _) => apply(function, a).map(Some),
        }
    }

    fn leading(&self, place: usize) -> Option<A::Number> {
        self.series[place][0].clone()
    }

    fn reciprocal(&self, value: &A::Number) -> Result<A::Number, Refusal> {
        let base = *self.recurrences.base();
        base.div(&base.rational(&RBig::ONE)?, value)
    }
}

/// `L_{X1} L_{X2} ... h` as an expression, run by run by series; `word` holds the fields' places in the system,
/// outermost first. It equals what repeated derivation gives, in other and, for long runs, far fewer operations.
///
/// # Errors
/// Where the expression divides by the constant zero.
pub fn lie_derivative_by_series(system: &mut System, word: &[usize], h: NodeId) -> Result<NodeId, Failure> {
    let mut value = h;
    let mut rest = word;
    while let Some(field) = rest.last() {
        let run = rest.iter().rev().take_while(|other| *other == field).count();
        let components = system.fields[*field].components.clone();
        let flow = Flow::new(&system.graph, &components, &[value], |_| false);
        let inputs: Vec<NodeId> = flow
            .inputs()
            .iter()
            .map(|input| match input {
                Input::Plain(symbol) | Input::Sine(symbol) | Input::Cosine(symbol) => {
                    system.graph.symbol(*symbol)
                }
                Input::Opaque(node) => *node,
            })
            .collect();
        let nodes = Nodes::new(&mut system.graph);
        let derivatives = flow.lie_derivatives(&nodes, &inputs, run)?;
        value = derivatives[0][run];
        rest = &rest[..rest.len() - run];
    }
    Ok(value)
}
