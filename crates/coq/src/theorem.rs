//! A file of theorems.

use crate::definitions::Definitions;
use crate::foreseen::foreseen;
use crate::names::{Names, in_comment};
use crate::place::{Compared, Coordinate, DEEPEST, State, extent, place};
use crate::printer::{Kind, Printed, Printer, Reason};
use crate::rank_theorem::rank_of;
use dashu::rational::RBig;
use palmistry_lang::{
    Assignment, ClaimBody, ClaimSyntax, Expectation, Statement, System, Value, in_one_line,
};
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Relation};
use palmistry_math::expression::{Guard, NodeId, Symbol};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The theorems of a file.
pub struct Exported {
    /// A file of Coq, which needs the library.
    pub text: String,
    /// The claims whose statement is a theorem in it, by their ids.
    pub claims: Vec<String>,
    /// The claims on a rank of which it is a theorem that the rank is reached at a state, and none that it is not exceeded.
    pub reached: Vec<String>,
    /// The claims with a form that a theorem refutes at a state: what is claimed to be refuted, or a form in print.
    pub refuted: Vec<String>,
    /// The others, and forms in print of which there is no theorem.
    pub left_out: Vec<NoTheorem>,
}

/// A claim that is no theorem.
pub struct NoTheorem {
    /// Its id.
    pub id: String,
    /// Why, in words.
    pub reason: String,
}

/// A theorem before its definitions are known to be printed.
pub(crate) struct Theorem {
    pub text: String,
    pub uses: BTreeSet<String>,
}

/// The theorems of a file, of those of its claims that are `wanted`: that a claim is proved is for others to say. What the library is not
/// expected to prove, or not in time, is left out. Forms that are wrong are refuted at a state in exact numbers, where one is found.
pub fn exported(system: &System, wanted: &dyn Fn(&str) -> Result<(), String>) -> Exported {
    written(system, wanted, true)
}

/// The same without what is said at states, and whether or not it is to be expected that the library proves it.
pub fn stated(system: &System, wanted: &dyn Fn(&str) -> Result<(), String>) -> Exported {
    written(system, wanted, false)
}

fn written(system: &System, wanted: &dyn Fn(&str) -> Result<(), String>, to_be_proved: bool) -> Exported {
    let mut names = Names::default();
    let mut definitions = Definitions::default();
    definitions.add(system, "", &mut names);
    let mut found = Exported {
        text: String::new(),
        claims: Vec::new(),
        reached: Vec::new(),
        refuted: Vec::new(),
        left_out: Vec::new(),
    };
    let mut theorems = Vec::new();
    // one copy for all claims: terms are written into its graph
    let mut scratch = system.clone();
    let symbols = system
        .symbols()
        .map(|(symbol, _)| (names.of("value", system.symbol_name(symbol)), symbol))
        .collect::<BTreeMap<String, Symbol>>();
    for claim in &system.claims {
        let mut of = OfClaim {
            system,
            claim,
            definitions: &definitions,
            names: &mut names,
            scratch: &mut scratch,
            symbols: &symbols,
        };
        let (right, wrong) = statements_of(claim);
        if let Some(statement) = right {
            let proved = wanted(&claim.id).and_then(|()| of.theorems(statement, to_be_proved));
            match proved {
                Ok((proved, is_whole)) => {
                    let list = if is_whole { &mut found.claims } else { &mut found.reached };
                    list.push(claim.id.clone());
                    theorems.extend(proved);
                }
                Err(reason) => found.left_out.push(NoTheorem { id: claim.id.clone(), reason }),
            }
        }
        if let Some(statement) = wrong.filter(|_| to_be_proved) {
            let id = if right.is_some() { format!("{}, in print", claim.id) } else { claim.id.clone() };
            match of.refutation(statement) {
                Ok(refuted) => {
                    found.refuted.push(claim.id.clone());
                    theorems.push(refuted);
                }
                Err(reason) => found.left_out.push(NoTheorem { id, reason }),
            }
        }
        if right.is_none() && wrong.is_none() {
            let reason = match &claim.body {
                ClaimBody::Definition { .. } => "a definition",
                ClaimBody::Open { .. } => "an open question",
                _ => "it is undecided",
            };
            found.left_out.push(NoTheorem { id: claim.id.clone(), reason: reason.to_owned() });
        }
    }
    found.text = file(system, &definitions, &theorems, &found.left_out);
    found
}

/// The statement that is to hold, of a fault the right form; and the one that is not to.
fn statements_of(claim: &ClaimSyntax) -> (Option<&Statement>, Option<&Statement>) {
    match &claim.body {
        ClaimBody::Claim { statement, expected: Expectation::Proved } => (Some(statement), None),
        ClaimBody::Claim { statement, expected: Expectation::Refuted } => (None, Some(statement)),
        ClaimBody::Erratum { printed, corrected, .. } => (Some(corrected), Some(printed)),
        ClaimBody::Scan { repaired, .. } => (Some(repaired), None),
        ClaimBody::Claim { .. } | ClaimBody::Definition { .. } | ClaimBody::Open { .. } => (None, None),
    }
}

fn file(system: &System, definitions: &Definitions, theorems: &[Theorem], left_out: &[NoTheorem]) -> String {
    let used = theorems.iter().flat_map(|theorem| &theorem.uses).cloned().collect();
    let (needed, variables) = definitions.needed(&used);
    let mut text = format!("(* {}", in_comment(&system.title));
    if let Some(cite) = &system.cite {
        let _ = write!(text, "\n   {}", in_comment(cite));
    }
    let _ = write!(
        text,
        "\n   From {}. *)\n\nFrom Palmistry Require Import Lie Check Point Rank.\nOpen Scope term_scope.\n\n",
        in_comment(&system.name)
    );
    for (variable, number) in variables.iter().zip(1..) {
        let _ = writeln!(text, "Definition {variable} := Var {number}.");
    }
    if !variables.is_empty() {
        text.push('\n');
    }
    for defined in &needed {
        text.push_str(&defined.text);
        text.push('\n');
    }
    for theorem in theorems {
        text.push('\n');
        text.push_str(&theorem.text);
    }
    if !left_out.is_empty() {
        text.push_str("\n(* No theorems:\n");
        for one in left_out {
            let _ = writeln!(text, "   {}: {}", in_comment(&one.id), in_comment(&one.reason));
        }
        text.push_str("*)\n");
    }
    text
}

/// A claim, and where its theorems are written.
pub(crate) struct OfClaim<'a> {
    pub system: &'a System,
    pub claim: &'a ClaimSyntax,
    pub definitions: &'a Definitions,
    pub names: &'a mut Names,
    /// A copy of the system.
    pub scratch: &'a mut System,
    /// The variables of Coq.
    pub symbols: &'a BTreeMap<String, Symbol>,
}

/// Both sides of an equation, and what it is claimed under.
struct Said {
    left: Printed,
    right: Printed,
    conditions: String,
}

impl OfClaim<'_> {
    /// What a statement says; whether that is all of it.
    fn theorems(
        &mut self,
        statement: &Statement,
        to_be_proved: bool,
    ) -> Result<(Vec<Theorem>, bool), Reason> {
        match rank_of(statement) {
            // what is shown at a state is not stated without it
            Some(_) if !to_be_proved => Err("a rank".to_owned()),
            Some(asked) => {
                let (theorem, is_whole) = self.rank(statement, &asked, 0)?;
                Ok((vec![theorem], is_whole))
            }
            None => Ok((self.identities(statement, to_be_proved)?, true)),
        }
    }

    /// That the sides are equal, and that there is a state at which they have values, where one is found.
    fn identities(&mut self, statement: &Statement, to_be_proved: bool) -> Result<Vec<Theorem>, Reason> {
        refuse(statement)?;
        let count = 1 + statement.further.len();
        let mut found = Vec::new();
        for (equation, number) in statement.relations().zip(1..) {
            let name = match count {
                1 => self.claim.id.clone(),
                _ => format!("{} part {number}", self.claim.id),
            };
            let ident = self.names.of("claim", &name);
            let (said, uses) = self.said(equation, &statement.conditions)?;
            let sign = if said.left.kind == Kind::Number { "==" } else { "===" };
            let under = if said.conditions.is_empty() {
                String::new()
            } else {
                format!("\n  where {}", said.conditions)
            };
            let text = format!(
                "{}Theorem {ident} : {}\n  {sign} {}{under}.\nProof. identity. Qed.\n",
                self.comment(statement),
                said.left.text,
                said.right.text
            );
            found.push(Theorem { text, uses: uses.clone() });
            if !to_be_proved {
                continue;
            }
            let compared = compared(self.scratch, equation, &statement.conditions)?;
            for (left, right) in with_given(self.scratch, &compared) {
                refuse_depth(self.scratch, &[left, right])?;
                foreseen(&self.scratch.graph, left, right)?;
            }
            if let Some(place) = place(self.scratch, &compared, &self.variables(&uses), false) {
                let ident = self.names.of("claim", &format!("{name} somewhere"));
                let word = match said.left.kind {
                    Kind::Number => "is_about_something",
                    Kind::Matrix(..) => "matrices_are_about_something",
                };
                let text = format!(
                    "Theorem {ident} : {word} {} {} {}.\nProof. defined_at {}. Qed.\n",
                    said.listed(),
                    said.left.argument(),
                    said.right.argument(),
                    self.state(&place.state)
                );
                found.push(Theorem { text, uses: uses_with(uses, &place.state, self) });
            }
        }
        Ok(found)
    }

    /// That the sides differ at a state.
    fn refutation(&mut self, statement: &Statement) -> Result<Theorem, Reason> {
        if let Some(asked) = rank_of(statement) {
            // one that is larger at some state
            return self.rank(statement, &asked, 1).map(|(theorem, _)| theorem);
        }
        refuse(statement)?;
        if !statement.further.is_empty() {
            return Err("several equations in one".to_owned());
        }
        let (said, uses) = self.said(&statement.equation, &statement.conditions)?;
        let compared = compared(self.scratch, &statement.equation, &statement.conditions)?;
        let found = place(self.scratch, &compared, &self.variables(&uses), true);
        let Some((found, entry)) = found.and_then(|found| found.differs.map(|entry| (found, entry))) else {
            return Err("it is refuted, and no state in rational numbers was found".to_owned());
        };
        let side = |side: &Printed| match side.kind {
            Kind::Number => side.argument(),
            Kind::Matrix(_, columns) => {
                format!("(entry_at {} {} {})", entry / columns, entry % columns, side.argument())
            }
        };
        let ident = self.names.of("claim", &format!("{} refuted", self.claim.id));
        let text = format!(
            "{}Theorem {ident} : refuted {}\n  {}\n  {}.\nProof. differs_at {}. Qed.\n",
            self.comment(statement),
            said.listed(),
            side(&said.left),
            side(&said.right),
            self.state(&found.state)
        );
        Ok(Theorem { text, uses: uses_with(uses, &found.state, self) })
    }

    /// The variables that these names rest on.
    pub fn variables(&self, uses: &BTreeSet<String>) -> BTreeSet<Symbol> {
        let (_, variables) = self.definitions.needed(uses);
        variables.iter().filter_map(|ident| self.symbols.get(ident).copied()).collect()
    }

    pub fn comment(&self, statement: &Statement) -> String {
        let text = in_comment(&in_one_line(&self.system.source, &statement.span));
        format!("(* {}: {text} *)\n", in_comment(&self.claim.id))
    }

    fn said(
        &mut self,
        equation: &Equation,
        conditions: &[Equation],
    ) -> Result<(Said, BTreeSet<String>), Reason> {
        if equation.relation != Relation::Equal {
            return Err("an inequality".to_owned());
        }
        if equation.within.is_some() {
            return Err("a number with a tolerance".to_owned());
        }
        let mut printer = self.definitions.outermost(self.system, self.names);
        let (left, right) = (printer.print(&equation.left)?, printer.print(&equation.right)?);
        if left.kind != right.kind {
            return Err("sides of two shapes".to_owned());
        }
        if !conditions.iter().all(|condition| is_solved(self.system, condition)) {
            return Err("a condition that is not solved for a variable".to_owned());
        }
        let conditions = conditions_in(&mut printer, conditions)?;
        Ok((Said { left, right, conditions }, printer.used))
    }

    /// A state, by its coordinates.
    pub fn state(&mut self, state: &State) -> String {
        let number = |value: &RBig| match *value < RBig::ZERO {
            true => format!("({}) {}", value.numerator(), value.denominator()),
            false => format!("{} {}", value.numerator(), value.denominator()),
        };
        let coordinate = |(symbol, coordinate): &(Symbol, Coordinate)| {
            let name = self.names.of("value", self.system.symbol_name(*symbol));
            match coordinate {
                Coordinate::Number(value) => format!("({name}, Number {})", number(value)),
                Coordinate::Angle(half) => format!("({name}, Angle {})", number(half)),
            }
        };
        match state.is_empty() {
            true => "anywhere".to_owned(),
            false => format!("[{}]", state.iter().map(coordinate).collect::<Vec<_>>().join("; ")),
        }
    }
}

impl Said {
    /// The conditions as an argument.
    fn listed(&self) -> String {
        as_argument(&self.conditions)
    }
}

/// Conditions as an argument.
pub(crate) fn as_argument(conditions: &str) -> String {
    if conditions.is_empty() { "[]".to_owned() } else { format!("({conditions})%condition") }
}

/// What a theorem mentions, with the variables of a state.
pub(crate) fn uses_with(mut uses: BTreeSet<String>, state: &State, of: &mut OfClaim<'_>) -> BTreeSet<String> {
    for (symbol, _) in state {
        uses.insert(of.names.of("value", of.system.symbol_name(*symbol)));
    }
    uses
}

/// Coq goes down into terms, and so does what foresees it.
fn refuse_depth(system: &System, nodes: &[NodeId]) -> Result<(), Reason> {
    match extent(&system.graph, nodes).depth > DEEPEST {
        true => Err(format!("it is nested more than {DEEPEST} deep")),
        false => Ok(()),
    }
}

/// What no equation of the library says.
pub(crate) fn refuse(statement: &Statement) -> Result<(), Reason> {
    if statement.carried.is_some() {
        return Err("a number in print".to_owned());
    }
    if statement.except.is_some() {
        return Err("a rank at all states".to_owned());
    }
    Ok(())
}

/// Whether a condition gives a variable, or takes away no dimension.
pub(crate) fn is_solved(system: &System, condition: &Equation) -> bool {
    let is_symbol = |expr: &Expr| match &expr.kind {
        ExprKind::Name(name) => system.find_symbol(name).is_some(),
        _ => false,
    };
    condition.relation != Relation::Equal || is_symbol(&condition.left) || is_symbol(&condition.right)
}

/// The list of some conditions; nothing where there are none.
pub(crate) fn conditions_in(printer: &mut Printer<'_>, conditions: &[Equation]) -> Result<String, Reason> {
    let list: Vec<String> =
        conditions.iter().map(|condition| condition_of(printer, condition)).collect::<Result<_, _>>()?;
    Ok(if list.is_empty() { String::new() } else { format!("[{}]", list.join("; ")) })
}

fn condition_of(printer: &mut Printer<'_>, condition: &Equation) -> Result<String, Reason> {
    if condition.within.is_some() {
        return Err("a condition with a tolerance".to_owned());
    }
    let (left, right) = (printer.scalar(&condition.left)?, printer.scalar(&condition.right)?);
    let sign = match condition.relation {
        Relation::Equal => "=",
        Relation::NotEqual => "<>",
        Relation::Less => "<",
        Relation::AtMost => "<=",
        Relation::Greater => ">",
        Relation::AtLeast => ">=",
    };
    Ok(format!("{} {sign} {}", left.text, right.text))
}

/// Both sides, entry by entry, and the conditions.
fn compared(system: &mut System, equation: &Equation, conditions: &[Equation]) -> Result<Compared, Reason> {
    let mut found = under(system, conditions)?;
    found.left = entries(system, &equation.left, &mut found.guards)?;
    found.right = entries(system, &equation.right, &mut found.guards)?;
    Ok(found)
}

/// The conditions, and nothing that is compared.
pub(crate) fn under(system: &mut System, conditions: &[Equation]) -> Result<Compared, Reason> {
    let mut found =
        Compared { left: Vec::new(), right: Vec::new(), conditions: Vec::new(), guards: Vec::new() };
    for condition in conditions {
        let mut side = |side: &Expr| match entries(system, side, &mut found.guards)?.as_slice() {
            [one] => Ok::<_, Reason>(*one),
            _ => Err("a condition of matrices".to_owned()),
        };
        let given = (side(&condition.left)?, condition.relation, side(&condition.right)?);
        found.conditions.push(given);
    }
    Ok(found)
}

/// The entries of a number or a matrix, by rows; and what has to hold for all of it to have values.
pub(crate) fn entries(
    system: &mut System,
    side: &Expr,
    guards: &mut Vec<Guard>,
) -> Result<Vec<NodeId>, Reason> {
    let (value, needs) = system.elaborate_guarded(side).map_err(|problem| problem.message)?;
    guards.extend(needs);
    match value {
        Value::Scalar(one) => Ok(vec![one]),
        Value::Matrix(matrix) => Ok(matrix.entries),
        other => Err(other.describe()),
    }
}

/// Left and right sides with what conditions give put in, as often as the library does: of two variables the first is given.
fn with_given(system: &mut System, compared: &Compared) -> Vec<(NodeId, NodeId)> {
    let graph = &mut system.graph;
    let mut given = Assignment::new();
    for (left, relation, right) in compared.conditions.iter().rev() {
        let sides = [(*left, *right), (*right, *left)];
        let found = sides.into_iter().find_map(|(name, value)| Some((graph.as_symbol(name)?, value)));
        if let Some((symbol, value)) = found.filter(|_| *relation == Relation::Equal) {
            given.insert(symbol, value);
        }
    }
    let (mut left, mut right) = (compared.left.clone(), compared.right.clone());
    for _ in 0..given.len() {
        left = graph.substitute(&left, &given);
        right = graph.substitute(&right, &given);
    }
    left.into_iter().zip(right).collect()
}
