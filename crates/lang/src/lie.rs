//! Derivatives along fields, and the brackets of fields.
//!
//! A field is named, or it is the Lie bracket of two: `[f, g] = (dg) f - (df) g`, that is in components
//! `[f, g]_i = L_f g_i - L_g f_i`. With this sign the derivative along the bracket is the commutator of the derivatives,
//! `L_[f,g] h = L_f L_g h - L_g L_f h` (Isidori, Nonlinear Control Systems, 3rd edition, 1995, section 1.2, and Nijmeijer
//! and van der Schaft, Nonlinear Dynamical Control Systems, 1990, section 2.2.2, have the same).

use super::codes::Code;
use super::elaborate::{LARGEST_GRAPH, Wanted};
use super::error::Problem;
use super::model::{Matrix, Role, System, Value};
use super::unknowns::{Signal, next_derivative};
use palmistry_math::expression::syntax::{Expr, ExprKind, Span};
use palmistry_math::expression::{Derivation, Guard, NodeId, Symbol};
use std::collections::{BTreeMap, BTreeSet};

/// Brackets of brackets beyond this are refused: each doubles what is written down.
const DEEPEST_BRACKET: usize = 8;

/// The component of a field that moves a symbol, and where it exists.
#[derive(Clone, Debug)]
struct Rate {
    value: NodeId,
    guards: Vec<Guard>,
}

/// A field that was calculated: the symbols that it moves.
type Rates = BTreeMap<Symbol, Rate>;

impl System {
    /// `L(f, e)`, or `L(f, g, e)` for the Lie derivative along `f` of the one along `g`.
    pub(super) fn lie(&mut self, arguments: &[Expr], span: &Span) -> Result<Value, Problem> {
        let [fields @ .., last] = arguments else {
            return Err(Problem::new(Code::Arguments, span, "'L' takes a field and an expression", "here"));
        };
        if fields.is_empty() {
            return Err(Problem::new(Code::Arguments, span, "'L' takes a field and an expression", "here")
                .help("as in L(f, s1)"));
        }
        let steps = fields.iter().any(|field| match &field.kind {
            ExprKind::Name(name) => self.field(name).is_some_and(|field| field.derivation.composes()),
            _ => false,
        });
        if steps {
            return self.after_steps(fields, last, span);
        }
        let mut value = self.elaborate(last)?;
        for field in fields.iter().rev() {
            value = match &field.kind {
                ExprKind::Name(name) => {
                    self.refuse_the_last_derivative(name, &value, span)?;
                    self.along_named(name, value, (&field.span, &last.span))?
                }
                _ => {
                    let rates = self.rates_of(field, 0)?;
                    self.along_rates(&rates, value, &last.span)?
                }
            };
            self.refuse_growth(span)?;
        }
        Ok(value)
    }

    /// The drift leads a signal to its next derivative, and the last one that the file comes to has none: it would count as constant. Of a
    /// known signal what a file says itself never meets this (`driven.rs`), and what is asked of it from outside may; of an unknown one that
    /// is an assumption, which a statement rests on only where the file makes it (`order 1`).
    pub(super) fn refuse_the_last_derivative(
        &self,
        field: &str,
        value: &Value,
        span: &Span,
    ) -> Result<(), Problem> {
        let Some(drift) = self.field(field).filter(|field| field.role == Role::Drift) else { return Ok(()) };
        let steps = drift.derivation.composes();
        let nodes = match value {
            Value::Scalar(node) => vec![*node],
            Value::Matrix(matrix) => matrix.entries.clone(),
            _ => return Ok(()),
        };
        // what a known signal is after a step is a symbol of its own, made where it is met
        let is_open = |signal: &&Signal| if signal.is_known { !steps } else { !signal.has_order };
        let open = self.coordinates.signals.iter().filter(is_open);
        let last: Vec<(Symbol, bool)> =
            open.filter_map(|signal| Some((*signal.chain.last()?, signal.is_known))).collect();
        if last.is_empty() {
            return Ok(());
        }
        let held = self.graph.symbols_of(nodes);
        let Some((symbol, is_known)) = last.into_iter().find(|(symbol, _)| held.contains(symbol)) else {
            return Ok(());
        };
        let name = self.symbol_name(symbol);
        let next = next_derivative(name);
        let told = match steps {
            true => format!("what '{name}' is after a step is given by {next}"),
            false => format!("the derivative of '{name}' is {next}"),
        };
        let (message, help) = match is_known {
            true => (
                format!("{told}, which the file does not come to"),
                format!("name {next} in the file, as in: let further = {next}"),
            ),
            false => (
                format!("{told}, and the file does not say that it is zero"),
                format!(
                    "name {next} in the file, or say how many derivatives the signal has, as in: unknown w(t) order 1"
                ),
            ),
        };
        Err(Problem::new(Code::Signal, span, message, "this holds it").help(help))
    }

    /// The same along maps: what is after the last step has to exist there, and each step at the state before it.
    fn after_steps(&mut self, fields: &[Expr], last: &Expr, span: &Span) -> Result<Value, Problem> {
        let (mut value, domain) = self.apart(|system| system.elaborate(last))?;
        let mut guards = self.guards_of(&domain);
        for field in fields.iter().rev() {
            let ExprKind::Name(name) = &field.kind else {
                let message =
                    "maps have no bracket: 'L' takes the names of maps, and what is composed with them";
                return Err(Problem::new(Code::Time, &field.span, message, "this"));
            };
            if self.field(name).is_none() {
                return Err(self.unknown(name, &field.span, Wanted::Field));
            }
            (value, guards) = self.after_step(name, (value, guards), span)?;
        }
        self.need_all(guards);
        Ok(value)
    }

    /// A value after a step of a map that the file has, and what it needs to exist.
    pub(super) fn after_step(
        &mut self,
        map: &str,
        (value, guards): (Value, Vec<Guard>),
        span: &Span,
    ) -> Result<(Value, Vec<Guard>), Problem> {
        self.refuse_the_last_derivative(map, &value, span)?;
        let needs = self.field(map).into_iter().flat_map(|found| found.guards.iter().flatten().copied());
        let needs: Vec<Guard> = needs.collect();
        let step = |system: &mut System, id: NodeId| {
            let mut graph = std::mem::take(&mut system.graph);
            let after = system.field_mut(map).map_or(id, |field| field.derivation.apply(&mut graph, id));
            system.graph = graph;
            after
        };
        let moved = guards.into_iter().map(|guard| Guard { node: step(self, guard.node), need: guard.need });
        let guards = moved.chain(needs).collect();
        let value = self.map(value, span, step)?;
        self.refuse_growth(span)?;
        Ok((value, guards))
    }

    pub(super) fn refuse_growth(&self, span: &Span) -> Result<(), Problem> {
        if self.graph.len() > LARGEST_GRAPH {
            let message = format!("this grows beyond {LARGEST_GRAPH} operations");
            return Err(Problem::new(Code::TooLarge, span, message, "here"));
        }
        Ok(())
    }

    /// The derivative along a field of the file, which keeps what it has differentiated; the spans are those of the field
    /// and of what is differentiated.
    pub(super) fn along_named(
        &mut self,
        name: &str,
        value: Value,
        spans: (&Span, &Span),
    ) -> Result<Value, Problem> {
        if self.field_mut(name).is_none() {
            return Err(self.unknown(name, spans.0, Wanted::Field));
        }
        let mentioned = self.mentioned(&value);
        self.need_all(self.rate_guards(name, &mentioned));
        self.map(value, spans.1, |system, id| {
            // the graph goes out of the system for as long as the field, which is a part of it too, is held
            let mut graph = std::mem::take(&mut system.graph);
            let derivative = match system.field_mut(name) {
                Some(field) => field.derivation.apply(&mut graph, id),
                None => id,
            };
            system.graph = graph;
            derivative
        })
    }

    /// The derivative along a field that was calculated.
    fn along_rates(&mut self, rates: &Rates, value: Value, span: &Span) -> Result<Value, Problem> {
        for symbol in self.mentioned(&value) {
            if let Some(rate) = rates.get(&symbol) {
                self.need_all(rate.guards.clone());
            }
        }
        let mut derivation = derivation_along(rates);
        self.map(value, span, |system, id| derivation.apply(&mut system.graph, id))
    }

    /// The symbols that a value depends on.
    fn mentioned(&self, value: &Value) -> Vec<Symbol> {
        let entries = match value {
            Value::Scalar(id) => vec![*id],
            Value::Matrix(matrix) => matrix.entries.clone(),
            _ => Vec::new(),
        };
        self.graph.symbols_of(entries).into_iter().collect()
    }

    /// The components of a field: of a name, or of a bracket.
    fn rates_of(&mut self, field: &Expr, depth: usize) -> Result<Rates, Problem> {
        match &field.kind {
            ExprKind::Name(name) => match self.field(name) {
                Some(found) if found.derivation.composes() => {
                    let message = format!("'{name}' is a map, and maps have no bracket");
                    Err(Problem::new(Code::Time, &field.span, message, "this one"))
                }
                Some(found) => {
                    let parts = found.components.iter().zip(&found.guards);
                    let rate = |((symbol, value), guards): (&(Symbol, NodeId), &Vec<Guard>)| {
                        (*symbol, Rate { value: *value, guards: guards.clone() })
                    };
                    Ok(parts.map(rate).collect())
                }
                None => Err(self.unknown(name, &field.span, Wanted::Field)),
            },
            ExprKind::Call(name, arguments) if name == "bracket" => match arguments.as_slice() {
                [first, second] if depth < DEEPEST_BRACKET => {
                    self.bracket([first, second], depth + 1, &field.span)
                }
                [_, _] => {
                    let message = format!("brackets within brackets, more than {DEEPEST_BRACKET} deep");
                    Err(Problem::new(Code::TooLarge, &field.span, message, "this one"))
                }
                _ => Err(Problem::new(Code::Arguments, &field.span, "'bracket' takes two fields", "here")
                    .help("as in L(bracket(f, g), x)")),
            },
            _ => Err(Problem::new(
                Code::OtherKind,
                &field.span,
                "expected the name of a field",
                "this is none",
            )
            .help("or the bracket of two, as in bracket(f, g)")),
        }
    }

    /// `[f, g]_i = L_f g_i - L_g f_i`, where both fields have derivatives.
    fn bracket(&mut self, fields: [&Expr; 2], depth: usize, span: &Span) -> Result<Rates, Problem> {
        let (first, second) = (&self.rates_of(fields[0], depth)?, &self.rates_of(fields[1], depth)?);
        for (field, other) in fields.into_iter().zip([second, first]) {
            let entries: Vec<NodeId> = other.values().map(|rate| rate.value).collect();
            let components = Value::Matrix(Matrix { rows: entries.len(), columns: 1, entries });
            if let ExprKind::Name(name) = &field.kind {
                self.refuse_the_last_derivative(name, &components, span)?;
            }
        }
        let (mut along_first, mut along_second) = (derivation_along(first), derivation_along(second));
        let moved: BTreeSet<Symbol> = first.keys().chain(second.keys()).copied().collect();
        let mut found = Rates::new();
        for symbol in moved {
            let mut guards = Vec::new();
            let zero = self.graph.integer(0);
            let mut part = |along: &mut Derivation, by: &Rates, of: &Rates| {
                let Some(rate) = of.get(&symbol) else { return zero };
                let smooth = |guard: &Guard| Guard { node: guard.node, need: guard.need.smooth() };
                guards.extend(rate.guards.iter().map(smooth));
                for mentioned in self.graph.symbols_of([rate.value]) {
                    guards.extend(by.get(&mentioned).iter().flat_map(|rate| rate.guards.iter().copied()));
                }
                along.apply(&mut self.graph, rate.value)
            };
            let forth = part(&mut along_first, first, second);
            let back = part(&mut along_second, second, first);
            let value = self.graph.sub(forth, back);
            guards.sort_unstable();
            guards.dedup();
            found.insert(symbol, Rate { value, guards });
        }
        self.refuse_growth(span)?;
        Ok(found)
    }

    /// `bracket(f, g)` as a column of as many entries as there are states; or `bracket(f, g, x, y)`, only those of `x` and `y`.
    pub(super) fn bracket_column(&mut self, arguments: &[Expr], span: &Span) -> Result<Value, Problem> {
        let [first, second, names @ ..] = arguments else {
            return Err(Problem::new(Code::Arguments, span, "'bracket' takes two fields", "here")
                .help("as in bracket(f, g)"));
        };
        let rates = self.bracket([first, second], 1, span)?;
        let states = self.states_of(names, span)?;
        let mut entries = Vec::with_capacity(states.len());
        for state in states {
            match rates.get(&state) {
                Some(rate) => {
                    self.need_all(rate.guards.clone());
                    entries.push(rate.value);
                }
                None => entries.push(self.graph.integer(0)),
            }
        }
        Ok(Value::Matrix(Matrix { rows: entries.len(), columns: 1, entries }))
    }
}

fn derivation_along(rates: &Rates) -> Derivation {
    Derivation::new(rates.iter().map(|(symbol, rate)| (*symbol, rate.value)).collect())
}
