//! The hover of a name: its kind, what is known of it, and the line that declares it.

use super::lookup::Found;
use super::source::Source;
use palmistry_lang::{DeclarationKind, Dimension, Role, System, Value};

/// No more lines of an entry than these are shown.
const MOST_LINES: usize = 8;

/// A declaration, as Markdown. `name` is how it is called in the text that the cursor is in, and `system` what that text
/// means, as far as it could be understood.
pub(super) fn described(found: &Found, name: &str, at_home: &Source, system: Option<&System>) -> String {
    let declaration = &found.declaration;
    let mut facts = match system {
        Some(system) => facts(declaration.kind, name, system),
        None => Vec::new(),
    };
    if found.source.uri != at_home.uri {
        let file = found.source.path.as_deref().and_then(|path| path.file_name()).unwrap_or_default();
        let line = found.source.line_number(declaration.span.start);
        facts.push(format!("declared in `{}`, line {line}", file.to_string_lossy()));
    }
    let head = format!("**{}** `{name}`", declaration.kind.word());
    let head = std::iter::once(head).chain(facts).collect::<Vec<_>>().join("; ");
    // of a long list of states the line on which the name stands
    let shown = match declaration.kind {
        DeclarationKind::State | DeclarationKind::Parameter | DeclarationKind::Signal(_) => &declaration.span,
        _ => &declaration.entry,
    };
    format!("{head}\n\n```palmistry\n{}\n```", found.source.lines_of(shown, MOST_LINES))
}

fn facts(kind: DeclarationKind, name: &str, system: &System) -> Vec<String> {
    let mut facts = Vec::new();
    match kind {
        DeclarationKind::State | DeclarationKind::Parameter | DeclarationKind::Signal(_) => {
            let first = || system.first_component(name);
            let Some((symbol, info)) = system
                .find_symbol(name)
                .or_else(first)
                .and_then(|symbol| Some((symbol, system.symbol_info(symbol)?)))
            else {
                return facts;
            };
            facts.extend(system.stands_for(symbol));
            if info.is_angle {
                facts.push("an angle".to_owned());
            }
            facts.extend(system.dimension_of(symbol).map(Dimension::in_words));
            facts.extend(info.default.as_ref().map(|value| format!("value {value} unless given")));
            facts.extend(
                info.range.as_ref().map(|range| format!("drawn from [{}, {}]", range.low, range.high)),
            );
        }
        DeclarationKind::Definition => {
            let Some(value) = system.definition(name) else { return facts };
            if !matches!(value, Value::Scalar(_)) {
                facts.push(value.describe());
            }
            facts.extend(system.dimension_of_definition(name));
        }
        DeclarationKind::Field(role) => facts.push(
            match role {
                Role::Drift => "the unforced dynamics",
                Role::Input => "the vector field of an input",
                Role::Other => "a vector field that is only differentiated along",
            }
            .to_owned(),
        ),
        _ => {}
    }
    facts
}
