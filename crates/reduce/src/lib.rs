//! The least model under conditions: what a system is where some of its states and parameters have known values.
//!
//! [`reduce`] puts conditions into a system, and leaves out what they make superfluous: states that the conditions give, constants that are known, states on
//! which no output depends, signals that nothing needs, and of each conservation law one state. What comes out is the text of a proof file that imports the
//! larger one, and claims all that makes the two equal under the conditions. Nothing here decides these claims: they are proved like those of any other file.
//! Where a tolerance is given, summands of rates that are small over the ranges go too (`small_terms`), and the claims bound what they are.
//!
//! Where every field keeps the conditions, the states that meet them are a system of their own, and the smaller one is that system: its ranks are those of the larger
//! one for someone who knows that the conditions hold. A known constant is a parameter, whose differential no rank counts. What was left out because no output
//! depends on it is unobservable.

#![warn(missing_docs)]

mod differences;
mod flows;
mod laws;
mod names;
mod question;
mod remaining;
mod small_terms;
mod text;

pub use question::{NotReduced, ReduceQuestion};
pub use remaining::{LeftOutState, WhyLeftOut};
pub use small_terms::SmallTerms;

use palmistry_lang::System;
use palmistry_math::expression::Program;
use remaining::Remaining;
use small_terms::leave_out_small_terms;

/// A system under conditions, as a proof file, and what was left out of it.
#[derive(Clone, Debug)]
pub struct LeastModel {
    /// The proof file: it imports the larger one, and its claims say that the two are the same under the conditions.
    pub text: String,
    /// The conditions, solved: `omega1 = 0`.
    pub conditions: Vec<String>,
    /// What the larger system has and the smaller one has not, in the larger one's order.
    pub left_out: Vec<LeftOutState>,
    /// The terms that were left out of rates because they are small, and how large they are at most.
    pub small_terms: Vec<SmallTerms>,
    /// The states that move and the unknown constants of the larger system, and of the smaller one.
    pub unknowns: [usize; 2],
    /// Those of them that move.
    pub moving: [usize; 2],
    /// The operations that all rates and outputs take, in the larger system (without inputs that nothing drives) and in the smaller one.
    pub operations: [usize; 2],
    /// What is worth knowing beside it, in sentences.
    pub remarks: Vec<String>,
}

/// A system under the conditions of a question; `import` is the path of its file as the new file names it.
///
/// # Errors
/// [`NotReduced`]: a condition that cannot be solved or does not stay met, a name that the system does not have, or a kind of system that is not written anew.
pub fn reduce(system: &System, question: &ReduceQuestion, import: &str) -> Result<LeastModel, NotReduced> {
    if import.chars().any(|c| c.is_control() || c == '"') {
        return Err(NotReduced::Kind {
            why: "a path with quotation marks or line breaks cannot be named in a proof file".to_owned(),
        });
    }
    let mut remaining = Remaining::new(system, question)?;
    let (before, before_operations) = (remaining.counts(), operations(&remaining));
    remaining.put_in_conditions(question)?;
    remaining.take_constants_as_known(question)?;
    remaining.leave_out_what_no_output_needs();
    remaining.use_conservation_laws();
    let small_terms = match question.tolerance {
        Some(tolerance) => leave_out_small_terms(&mut remaining, tolerance),
        None => Vec::new(),
    };
    remaining.put_in_order();
    let after = remaining.counts();
    let text = text::text(&mut remaining, import)?;
    Ok(LeastModel {
        text,
        conditions: remaining.conditions(),
        left_out: remaining.left_out.clone(),
        small_terms,
        unknowns: [before.0, after.0],
        moving: [before.1, after.1],
        operations: [before_operations, operations(&remaining)],
        remarks: remaining.remarks.clone(),
    })
}

/// How many operations the rates and outputs take together.
fn operations(remaining: &Remaining) -> usize {
    let nodes: Vec<_> = remaining.rates.iter().flatten().copied().chain(remaining.output_nodes()).collect();
    Program::plain(&remaining.system.graph, &nodes).len()
}
