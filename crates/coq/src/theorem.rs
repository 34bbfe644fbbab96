//! A file of theorems.

use crate::definitions::Definitions;
use crate::foreseen::foreseen;
use crate::names::{Names, in_comment};
use crate::printer::{Kind, Printer, Reason};
use palmistry_lang::{
    Assignment, ClaimBody, ClaimSyntax, Expectation, Statement, System, Value, in_one_line,
};
use palmistry_math::expression::NodeId;
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Relation};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The theorems of a file.
pub struct Exported {
    /// A file of Coq, which needs the library.
    pub text: String,
    /// The claims that are theorems in it, by their ids.
    pub claims: Vec<String>,
    /// The others.
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
struct Theorem {
    text: String,
    uses: BTreeSet<String>,
}

/// The theorems of a file, of those of its claims that are `wanted`: that a claim is proved is for others to say. What the library is not
/// expected to prove, or not in time, is left out.
pub fn exported(system: &System, wanted: &dyn Fn(&str) -> Result<(), String>) -> Exported {
    written(system, wanted, true)
}

/// The same, whether or not it is to be expected that the library proves them.
pub fn stated(system: &System, wanted: &dyn Fn(&str) -> Result<(), String>) -> Exported {
    written(system, wanted, false)
}

fn written(system: &System, wanted: &dyn Fn(&str) -> Result<(), String>, to_be_proved: bool) -> Exported {
    let mut names = Names::default();
    let mut definitions = Definitions::default();
    definitions.add(system, "", &mut names);
    let (mut theorems, mut claims, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    for claim in &system.claims {
        let found = statement_of(claim)
            .and_then(|statement| wanted(&claim.id).map(|()| statement))
            .and_then(|statement| theorems_of(system, claim, statement, &definitions, &mut names))
            .and_then(|theorems| {
                let expected = if to_be_proved { is_expected(system, claim) } else { Ok(()) };
                expected.map(|()| theorems)
            });
        match found {
            Ok(found) => {
                claims.push(claim.id.clone());
                theorems.extend(found);
            }
            Err(reason) => left_out.push(NoTheorem { id: claim.id.clone(), reason }),
        }
    }
    let used = theorems.iter().flat_map(|theorem| &theorem.uses).cloned().collect();
    let (needed, variables) = definitions.needed(&used);
    let mut text = format!("(* {}", in_comment(&system.title));
    if let Some(cite) = &system.cite {
        let _ = write!(text, "\n   {}", in_comment(cite));
    }
    let _ = write!(
        text,
        "\n   From {}. *)\n\nFrom Palmistry Require Import Lie Check.\nOpen Scope term_scope.\n\n",
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
    for theorem in &theorems {
        text.push('\n');
        text.push_str(&theorem.text);
    }
    if !left_out.is_empty() {
        text.push_str("\n(* No theorems:\n");
        for one in &left_out {
            let _ = writeln!(text, "   {}: {}", in_comment(&one.id), in_comment(&one.reason));
        }
        text.push_str("*)\n");
    }
    Exported { text, claims, left_out }
}

/// The statement that is to hold: of a fault the right form.
fn statement_of(claim: &ClaimSyntax) -> Result<&Statement, Reason> {
    match &claim.body {
        ClaimBody::Claim { statement, expected: Expectation::Proved } => Ok(statement),
        ClaimBody::Claim { expected: Expectation::Refuted, .. } => Err("it is refuted".to_owned()),
        ClaimBody::Claim { .. } => Err("it is undecided".to_owned()),
        ClaimBody::Erratum { corrected, .. } => Ok(corrected),
        ClaimBody::Scan { repaired, .. } => Ok(repaired),
        ClaimBody::Definition { .. } => Err("a definition".to_owned()),
        ClaimBody::Open { .. } => Err("an open question".to_owned()),
    }
}

fn theorems_of(
    system: &System,
    claim: &ClaimSyntax,
    statement: &Statement,
    definitions: &Definitions,
    names: &mut Names,
) -> Result<Vec<Theorem>, Reason> {
    if statement.carried.is_some() {
        return Err("a number in print".to_owned());
    }
    if statement.except.is_some() {
        return Err("a rank at all states".to_owned());
    }
    let ident = names.of("claim", &claim.id);
    let count = 1 + statement.further.len();
    let mut found = Vec::new();
    for (equation, number) in statement.relations().zip(1..) {
        let mut printer = definitions.outermost(system, names);
        let said = said(&mut printer, equation, &statement.conditions)?;
        let uses = printer.used;
        let ident = match count {
            1 => ident.clone(),
            _ => names.of("claim", &format!("{} part {number}", claim.id)),
        };
        let comment = in_comment(&in_one_line(&system.source, &statement.span));
        let text = format!(
            "(* {}: {comment} *)\nTheorem {ident} : {said}.\nProof. identity. Qed.\n",
            in_comment(&claim.id)
        );
        found.push(Theorem { text, uses });
    }
    Ok(found)
}

/// Whether the library is expected to prove all that a claim says.
fn is_expected(system: &System, claim: &ClaimSyntax) -> Result<(), Reason> {
    let statement = statement_of(claim)?;
    let mut system = system.clone();
    for equation in statement.relations() {
        for difference in differences(&mut system, equation, &statement.conditions)? {
            foreseen(&system.graph, difference)?;
        }
    }
    Ok(())
}

/// An equation, and what it is claimed under.
fn said(printer: &mut Printer<'_>, equation: &Equation, conditions: &[Equation]) -> Result<String, Reason> {
    if equation.relation != Relation::Equal {
        return Err("an inequality".to_owned());
    }
    if equation.within.is_some() {
        return Err("a number with a tolerance".to_owned());
    }
    let (left, right) = (printer.print(&equation.left)?, printer.print(&equation.right)?);
    let sign = match (left.kind, right.kind) {
        (Kind::Number, Kind::Number) => "==",
        (Kind::Matrix(..), right) if left.kind == right => "===",
        _ => return Err("sides of two shapes".to_owned()),
    };
    let list: Vec<String> =
        conditions.iter().map(|condition| condition_of(printer, condition)).collect::<Result<_, _>>()?;
    let under = if list.is_empty() { String::new() } else { format!("\n  where [{}]", list.join("; ")) };
    Ok(format!("{}\n  {sign} {}{under}", left.text, right.text))
}

fn condition_of(printer: &mut Printer<'_>, condition: &Equation) -> Result<String, Reason> {
    if condition.within.is_some() {
        return Err("a condition with a tolerance".to_owned());
    }
    let is_symbol = |expr: &Expr| match &expr.kind {
        ExprKind::Name(name) => printer.system.find_symbol(name).is_some(),
        _ => false,
    };
    if condition.relation == Relation::Equal && !is_symbol(&condition.left) && !is_symbol(&condition.right) {
        return Err("a condition that is not solved for a variable".to_owned());
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

/// Left sides less right sides, entry by entry, with what conditions give put in.
fn differences(
    system: &mut System,
    equation: &Equation,
    conditions: &[Equation],
) -> Result<Vec<NodeId>, Reason> {
    let mut given = Assignment::new();
    for condition in conditions.iter().rev().filter(|condition| condition.relation == Relation::Equal) {
        let sides = [(&condition.left, &condition.right), (&condition.right, &condition.left)];
        let symbol = |side: &Expr| match &side.kind {
            ExprKind::Name(name) => system.find_symbol(name),
            _ => None,
        };
        // the first of two that can be given is, as in the library
        let found = sides.into_iter().find_map(|(name, value)| Some((symbol(name)?, value)));
        if let Some((symbol, value)) = found {
            let value = system.scalar(value).map_err(|problem| problem.message)?;
            given.insert(symbol, value);
        }
    }
    let mut entries = |side: &Expr| match system.elaborate(side).map_err(|problem| problem.message)? {
        Value::Scalar(one) => Ok(vec![one]),
        Value::Matrix(matrix) => Ok(matrix.entries),
        other => Err(other.describe()),
    };
    let (left, right) = (entries(&equation.left)?, entries(&equation.right)?);
    let mut found: Vec<NodeId> =
        left.into_iter().zip(right).map(|(left, right)| system.graph.sub(left, right)).collect();
    for _ in 0..given.len() {
        found = system.graph.substitute(&found, &given);
    }
    Ok(found)
}
