//! Whether a system is another one under conditions. What has to hold is written down in the language, as claims of the smaller
//! file, and decided like any other: that the conditions stay met, that states that are left out stay constant, that fields, outputs
//! and the differentials of the Lie derivatives that the rank needs are the same. And the savings are counted.

use super::left_out::LeftOut;
use crate::tradeoff::{ModelComparison, compare_reduction};
use palmistry_io::foreign::name_of;
use palmistry_lang::{Assignment, ReadError, ReductionTo, System};
use palmistry_math::expression::syntax::Relation;
use palmistry_prove::claim::{Outcome, decide_all};
use palmistry_rank::observability::{Codistribution, Length, parse_condition};
use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// What was found of one reduction.
pub struct ReductionFound {
    /// What the file says of it.
    pub reduction: ReductionTo,
    /// The title of the larger system.
    pub of: String,
    /// The states of the larger system that are left out.
    pub left_out: Vec<String>,
    /// What has to hold, each with its verdict.
    pub claims: Vec<Outcome>,
    /// States and time saved, on the same work; why they are not counted, otherwise.
    pub comparison: Result<ModelComparison, String>,
}

impl ReductionFound {
    /// Whether everything that has to hold is proved.
    pub fn proved(&self) -> bool {
        !self.claims.is_empty() && self.claims.iter().all(|outcome| outcome.ok)
    }
}

/// The ids of the claims that are made for a reduction begin so.
const PREFIX: &str = "reduction";

/// Decides one reduction of a system; `folder` is that of its file.
///
/// # Errors
/// In words: the larger file cannot be used, or is not about the same states, fields and outputs.
pub(super) fn reduce(
    system: &System,
    reduction: &ReductionTo,
    folder: &Path,
    seed: u64,
    interrupt: &AtomicBool,
) -> Result<ReductionFound, LeftOut> {
    let what = format!("the reduction of {}", reduction.alias.text);
    let failed = |why: String| LeftOut { what: what.clone(), why };
    let read = |error: ReadError| {
        let (line, column) = error.line_and_column();
        failed(format!("{}:{line}:{column}: {}", error.source_code.name(), error.message))
    };
    let large = System::read_named(&reduction.path).map_err(read)?;
    let (text, left_out) = claims(system, &large, reduction).map_err(failed)?;
    let path = folder.join(&system.name);
    let mut longer = System::parse(&name_of(&path), &text, path.parent().unwrap_or(folder)).map_err(read)?;
    longer.claims.drain(..system.claims.len());
    longer.name.clone_from(&system.name);
    let outcomes = decide_all(&longer, seed, interrupt, &|_| ());
    let comparison = compare_reduction(system, &large, &reduction.written, seed);
    Ok(ReductionFound {
        reduction: reduction.clone(),
        of: large.title,
        left_out,
        claims: outcomes,
        comparison,
    })
}

/// The text of the smaller file with a claim for everything that has to hold, and the states that are left out.
fn claims(small: &System, large: &System, reduction: &ReductionTo) -> Result<(String, Vec<String>), String> {
    let alias = &reduction.alias.text;
    let under = format!("where {}", reduction.written.join(", "));
    let states = small.state_names();
    if let Some(own) = states.iter().find(|state| !large.state_names().contains(state)) {
        return Err(format!("'{own}' is no state of {alias}"));
    }
    let left_out: Vec<String> =
        large.state_names().into_iter().filter(|state| !states.contains(state)).collect();
    let mut text = small.source.clone();
    let mut count = 0;
    let mut claim = |what: &str, statement: String| {
        count += 1;
        // no claim of the file has a name like this: it would be the same number of the same reduction
        let _ = write!(text, "\nclaim {PREFIX}-{alias}-{count}-{what}: {statement}");
    };
    small.require_continuous("reductions are of systems that flow")?;
    large.require_continuous("reductions are of systems that flow")?;
    let mut fields = Vec::new();
    for field in small.moving_fields() {
        let field = &small.fields[field];
        if !large.fields.iter().any(|other| other.name == field.name && other.role == field.role) {
            let role = field.role.name();
            return Err(format!("{alias} has no {role} '{}'", field.name));
        }
        fields.push(&field.name);
    }
    let conditions =
        reduction.written.iter().map(|text| parse_condition(text)).collect::<Result<Vec<_>, _>>()?;
    // an inequality is kept for a while by itself
    let equalities = || {
        let each = conditions.iter().zip(&reduction.written);
        each.flat_map(|(list, written)| list.iter().map(move |condition| (condition, written)))
            .filter(|(condition, _)| condition.relation == Relation::Equal)
    };
    for field in &fields {
        for (condition, written) in equalities() {
            let side = |span: &std::ops::Range<usize>| &written[span.clone()];
            let (left, right) = (side(&condition.left.span), side(&condition.right.span));
            // a number has no rate, and is one in the unit of the other side
            let difference = match (condition.left.is_literal(), condition.right.is_literal()) {
                (_, true) => left.to_owned(),
                (true, _) => right.to_owned(),
                _ => format!("({left}) - ({right})"),
            };
            claim("conditions", format!("L({alias}.{field}, {difference}) = 0 {under}"));
        }
        for state in &states {
            claim("fields", format!("L({field}, {state}) = L({alias}.{field}, {state}) {under}"));
        }
        for state in &left_out {
            claim("left-out", format!("L({alias}.{field}, {state}) = 0 {under}"));
        }
    }
    let words = Codistribution::new(&mut small.clone(), &Assignment::new(), Length::UntilItStops)?;
    let columns = states.join(", ");
    // the larger system's outputs as its own file means them: names may mean other things here
    let of_large = |place: usize| {
        let unit = (0..large.outputs.len()).map(|i| if i == place { "1" } else { "0" });
        format!("det([{}]*{alias}.output)", unit.collect::<Vec<_>>().join(", "))
    };
    let mut pairs = Vec::new();
    for (output, _) in &small.outputs {
        match large.outputs.iter().position(|(other, _)| other == output) {
            Some(place) => pairs.push(of_large(place)),
            None => return Err(format!("{alias} has no output '{output}'")),
        }
    }
    for (place, (output, _)) in large.outputs.iter().enumerate() {
        match small.outputs.iter().position(|(other, _)| other == output) {
            Some(_) => claim("outputs", format!("{output} = {} {under}", of_large(place))),
            // the other outputs are known already
            None => {
                let zeros = vec!["0"; states.len()].join(", ");
                claim("outputs", format!("d({}, {columns}) = [{zeros}] {under}", of_large(place)));
            }
        }
    }
    for word in
        words.needed.iter().map(|index| &words.lie_derivatives[*index]).filter(|word| !word.fields.is_empty())
    {
        let taken = |prefix: &str, output: &str| {
            let along = word.fields.iter().map(|field| format!("{prefix}{}", small.fields[*field].name));
            let along: Vec<String> = along.collect();
            format!("d(L({}, {output}), {columns})", along.join(", "))
        };
        let (own, other) =
            (taken("", &small.outputs[word.output].0), taken(&format!("{alias}."), &pairs[word.output]));
        claim("differentials", format!("{own} = {other} {under}"));
    }
    Ok((text, left_out))
}
