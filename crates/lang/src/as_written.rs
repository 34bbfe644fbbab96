//! A system as its file has it, for those who read it: rates and outputs with their abbreviations, and not what these come to.

use super::model::{Role, System, Time};
use super::syntax::ClaimBody;
use super::written::{Insert, Mention, Place, Scope, places_in_equation};
use std::collections::{HashSet, VecDeque};

/// A vector field as it is written, or a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldAsWritten {
    /// Its name.
    pub name: String,
    /// What it does to the states.
    pub role: Role,
    /// Each state that it names, and its rate or its next value. `others` stand still.
    pub rates: Vec<(String, String)>,
}

/// A system as it is written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SystemAsWritten {
    /// Its fields, in the order of the file.
    pub fields: Vec<FieldAsWritten>,
    /// Its outputs.
    pub outputs: Vec<String>,
    /// What the names in them stand for that are no symbols, in the order in which they are met: name and text.
    pub definitions: Vec<(String, String)>,
}

/// What names stand for, as it is written: name and text of each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Explanations {
    /// Definitions: `name = text`.
    pub definitions: Vec<(String, String)>,
    /// Fields along which something is differentiated; the text is a list of `x' = rate`.
    pub fields: Vec<(String, String)>,
}

impl System {
    /// What the names in the statements of a claim stand for: definitions and fields, and those that they mention in turn,
    /// in the order in which they are met; imported ones under the names that they have here.
    pub fn explanations(&self, body: &ClaimBody) -> Explanations {
        let states = || self.column_names();
        let is_definition = |name: &str| self.definitions.contains_key(name);
        let scope = Scope { source: &self.source, is_definition: &is_definition, states: &states };
        let mut places = Vec::new();
        for statement in body.statements() {
            for equation in statement.all_equations() {
                places_in_equation(&scope, equation, &mut places);
            }
        }
        places.sort_by_key(|(span, _)| span.start);
        let mention = |(_, insert): Place| match insert {
            Insert::Mention(mention) => Some(mention),
            Insert::States(_) => None,
        };
        let mut waiting: VecDeque<Mention> = places.into_iter().filter_map(mention).collect();
        let mut found = Explanations::default();
        let mut met = HashSet::new();
        while let Some(mention) = waiting.pop_front() {
            if !met.insert(mention.clone()) {
                continue;
            }
            let (list, name, written) = match mention {
                Mention::Definition(name) => (&mut found.definitions, name.clone(), self.written.get(&name)),
                Mention::Field(name) => {
                    let field = self.field(&name);
                    (&mut found.fields, name, field.map(|field| &field.written))
                }
            };
            if let Some(written) = written {
                list.push((name, written.text()));
                waiting.extend(written.mentions());
            }
        }
        found
    }

    /// The system as its file has it.
    pub fn as_written(&self) -> SystemAsWritten {
        let outputs: Vec<String> = self.outputs.iter().map(|(text, _)| text.clone()).collect();
        let fields = self.fields.iter().map(|field| FieldAsWritten {
            name: field.name.clone(),
            role: field.role,
            rates: rates(&field.written.text(), if self.time == Time::Discrete { '+' } else { '\'' }),
        });
        // the drift that is made for signals stands in no file
        let fields: Vec<FieldAsWritten> = fields.filter(|field| !field.rates.is_empty()).collect();
        let of_fields = self.fields.iter().flat_map(|field| field.written.mentions());
        let of_outputs = outputs.iter().flat_map(|text| names(text));
        let of_outputs = of_outputs
            .filter(|name| self.written.contains_key(*name))
            .map(|name| Mention::Definition(name.to_owned()));
        let mut waiting: VecDeque<Mention> = of_fields.chain(of_outputs).collect();
        let (mut definitions, mut met) = (Vec::new(), HashSet::new());
        while let Some(mention) = waiting.pop_front() {
            let Mention::Definition(name) = mention else { continue };
            if let Some(written) = self.written.get(&name)
                && met.insert(name.clone())
            {
                definitions.push((name, written.text()));
                waiting.extend(written.mentions());
            }
        }
        SystemAsWritten { fields, outputs, definitions }
    }
}

/// The names in an expression.
fn names(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.'))).filter(|name| !name.is_empty())
}

/// `x' = y  y' = -x` taken apart; `mark` is what stands behind the name of a state.
fn rates(text: &str, mark: char) -> Vec<(String, String)> {
    // where a name, its mark and a sign of equality stand outside of all brackets a rate begins
    let mut begins: Vec<(usize, usize, usize)> = Vec::new();
    let mut depth = 0usize;
    let all: Vec<(usize, char)> = text.char_indices().collect();
    for (place, (at, c)) in all.iter().enumerate() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            _ if *c == mark && depth == 0 => {
                let rest = text[at + mark.len_utf8()..].trim_start();
                let name = all[..place]
                    .iter()
                    .rev()
                    .take_while(|(_, c)| c.is_alphanumeric() || "_.[]@' ".contains(*c));
                let name: Vec<usize> = name.map(|(at, _)| *at).collect();
                let from = name.last().copied().unwrap_or(*at);
                let own = text[from..*at].trim_start();
                let own = own.rsplit_once(' ').map_or(own, |(_, last)| last);
                if let (Some(rest), false) = (rest.strip_prefix('='), own.is_empty()) {
                    begins.push((at - own.len(), *at, text.len() - rest.len()));
                }
            }
            _ => {}
        }
    }
    let ends = begins.iter().skip(1).map(|(from, ..)| *from).chain([text.len()]);
    let rate = |((from, to, begin), end): (&(usize, usize, usize), usize)| {
        (text[*from..*to].to_owned(), text[*begin..end].trim().to_owned())
    };
    begins.iter().zip(ends).map(rate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_taken_apart() {
        let of = |text: &str, mark: char| rates(text, mark);
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        assert_eq!(of("x' = y  y' = -x + u'", '\''), [pair("x", "y"), pair("y", "-x + u'")]);
        assert_eq!(
            of("x[i]' = x[i + 1] for i in 1..2  x[3]' = 0", '\''),
            [pair("x[i]", "x[i + 1] for i in 1..2"), pair("x[3]", "0")]
        );
        assert_eq!(of("x+ = x + y  y+ = y", '+'), [pair("x", "x + y"), pair("y", "y")]);
        assert_eq!(
            of("x' = (y at {u' = 2})  others' = 0", '\''),
            [pair("x", "(y at {u' = 2})"), pair("others", "0")]
        );
        assert_eq!(of("", '\''), []);
    }

    /// Names are those of the file, and abbreviations are listed as they are met.
    #[test]
    fn a_system_is_what_its_file_says() {
        let text = "system \"s\" state phi, omega param k known u(t) angle phi let accel = u - drag let drag = k*sin(phi)
                    drift f phi' = omega omega' = accel output accel*phi, omega";
        let text = text.replace(
            "let accel = u - drag let drag = k*sin(phi)",
            "let drag = k*sin(phi) let accel = u - drag",
        );
        let system: System = text.parse().unwrap();
        let found = system.as_written();
        assert_eq!(found.fields.len(), 1);
        assert_eq!(
            found.fields[0].rates,
            [("phi".to_owned(), "omega".to_owned()), ("omega".to_owned(), "accel".to_owned())]
        );
        assert_eq!(found.outputs, ["accel*phi", "omega"]);
        let names: Vec<&str> = found.definitions.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["accel", "drag"]);
    }
}
