//! The singular set beside an answer about ranks: in a few lines, and as JSON.

use super::drops::set_json;
use crate::claims::outcomes::error_bound;
use crate::layout::{counted, item, prose};
use palmistry_io::foreign::shown;
use palmistry_prove::drops::{DropAnswer, DropSet};
use serde_json::{Value, json};

/// Where the rank drops, as far as a small budget decides it.
#[derive(Clone, Debug)]
pub enum SingularSet {
    /// The search came to its end.
    Found(Box<DropAnswer>),
    /// The budget does not suffice.
    TooMuchWork,
    /// It was not looked for: what is quick without it stays so.
    NotSearched,
    /// It is not asked of this system; in words, why.
    NotAsked(String),
}

/// More sets than these are counted.
const MOST_SETS: usize = 6;
/// Longer equations are counted by their characters.
const LONGEST: usize = 240;

/// The states of a set in words.
fn place(set: &DropSet) -> String {
    let all: Vec<&str> = set.equations.iter().chain(&set.unless).map(String::as_str).collect();
    let text = all.join(", ");
    match text.chars().count() {
        0 => "at all states".to_owned(),
        length if length > LONGEST => {
            format!("where {} of {length} characters hold (--json has them)", counted(all.len(), "condition"))
        }
        _ => format!("where {text}"),
    }
}

fn set_line(set: &DropSet) -> String {
    let most = if set.exactly { "" } else { "at most " };
    let sure = match error_bound(set.log2_error).as_str() {
        "0" => String::new(),
        bound => format!(" (error probability below {bound})"),
    };
    let exists = if set.state.is_some() || set.exists { "" } else { "; no state of it was found" };
    format!("rank {most}{} {}{sure}{exists}", set.rank, place(set))
}

/// The singular set in a few lines.
pub(super) fn singular_set_text(found: &SingularSet, file: &str, out: &mut String) {
    let command = format!("palmistry rank {} --singular-set", shown(file));
    let answer = match found {
        SingularSet::Found(answer) => answer,
        SingularSet::TooMuchWork => {
            return prose(&format!("singular set: not found at once; {command} searches on"), out);
        }
        SingularSet::NotSearched => return prose(&format!("singular set: {command} looks for it"), out),
        SingularSet::NotAsked(why) => return prose(&format!("singular set: not decided: {why}"), out),
    };
    let is_exact = answer.is_exact();
    let domain = if answer.domain.is_empty() { "" } else { " at which all Lie derivatives exist" };
    let what = match (is_exact, answer.sets.is_empty()) {
        (true, true) => {
            let rank = answer.rank;
            return prose(
                &format!("singular set: empty; the rank is {rank} at every state{domain} (proved)"),
                out,
            );
        }
        (false, true) => {
            return prose(&format!("singular set: not decided at once; {command} says what is open"), out);
        }
        (true, false) => format!(
            "singular set, at any values of the parameters; the rank is {} at all other states{domain} (proved):",
            answer.rank
        ),
        (false, false) => {
            "singular set, at any values of the parameters, and there may be more of it:".to_owned()
        }
    };
    prose(&what, out);
    for set in answer.sets.iter().take(MOST_SETS) {
        item(&set_line(set), out);
    }
    match answer.sets.len().saturating_sub(MOST_SETS) {
        0 if is_exact => {}
        0 => item(&format!("{command} says what is open"), out),
        more => item(&format!("{}: {command}", counted(more, "more set")), out),
    }
}

/// The same as JSON: null where nobody asked.
pub fn singular_set_json(found: Option<&SingularSet>) -> Value {
    let Some(found) = found else { return Value::Null };
    let (answer, why) = match found {
        SingularSet::Found(answer) => (Some(answer), answer.out_of_reach.clone()),
        SingularSet::TooMuchWork => (None, Some("more work than is done at once".to_owned())),
        SingularSet::NotSearched => (None, Some("not looked for without sampled states".to_owned())),
        SingularSet::NotAsked(why) => (None, Some(why.clone())),
    };
    json!({
        "exact": answer.is_some_and(|answer| answer.is_exact()),
        "rank": answer.map(|answer| answer.rank),
        "sets": answer.map(|answer| answer.sets.iter().map(set_json).collect::<Vec<_>>()),
        "open": answer.map(|answer| answer.open.len()),
        "why": why,
    })
}
