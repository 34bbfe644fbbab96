//! A file of theorems.

use crate::definitions::Definitions;
use crate::names::{Names, in_comment};
use crate::of_claim::{OfClaim, Theorem};
use crate::printer::Reason;
use crate::rank_theorem::rank_of;
use palmistry_lang::{ClaimBody, ClaimSyntax, Expectation, Statement, System};
use palmistry_math::expression::Symbol;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The theorems of a file.
pub struct Exported {
    /// A file of Coq, which needs the library.
    pub text: String,
    /// The claims whose statement is a theorem in it, by their ids.
    pub claims: Vec<String>,
    /// The claims on a rank for which a theorem says that a state reaches the rank, but none that no state exceeds it.
    pub reached: Vec<String>,
    /// The claims with a form that a theorem refutes at a state: what is claimed to be refuted, or a form in print.
    pub refuted: Vec<String>,
    /// The others, and forms in print of which there is no theorem.
    pub left_out: Vec<NoTheorem>,
}

/// A claim without a theorem.
pub struct NoTheorem {
    /// Its id.
    pub id: String,
    /// Why, in words.
    pub reason: String,
}

/// The theorems for those claims of a file that are `wanted`; whether a claim is proved is decided elsewhere. What the library is not
/// expected to prove, or not in time, is left out. Wrong forms are refuted at a state in exact numbers, where one is found.
pub fn exported(system: &System, wanted: &dyn Fn(&str) -> Result<(), String>) -> Exported {
    written(system, wanted, true)
}

/// The same without statements at states, and whether or not the library is expected to prove them.
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

    /// That a statement is not so, by a state.
    fn refutation(&mut self, statement: &Statement) -> Result<Theorem, Reason> {
        match rank_of(statement) {
            // a rank that is larger at some state
            Some(asked) => self.rank(statement, &asked, 1).map(|(theorem, _)| theorem),
            None => self.difference(statement),
        }
    }
}
