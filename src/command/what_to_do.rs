//! What to do about an error whose own message has no advice: by what the message says, in tables.

/// Parts of messages, and what to do.
const MESSAGES: &[(&str, &str)] = &[
    ("is fixed and solved for in a condition", "leave it out of '--at', or the condition out of '--where'"),
    (
        "no state was found in",
        "states are drawn from the ranges of the file, angles in radians (pi is 3.14159); other ranges stand behind 'sample' in it",
    ),
    ("it has no value at this point", "choose another point"),
    ("is not a text in UTF-8", "save it as UTF-8"),
    ("is no text in UTF-8", "save it as UTF-8"),
    ("it is a folder", "name a file in it"),
    ("declares no states or no outputs", "add, for instance: state x, and output x"),
    (
        "it is no verdict file",
        "a verdict file is written by 'palmistry prove FILE --verdicts OUT', or 'rank' and 'certify'",
    ),
    ("takes two numbers", "two numbers stand with ',' between them, as in 0.2,1.2"),
    ("no drift", "add how the states move, as in drift f, and a rate for each state below it"),
];

/// Parts of a condition, and how it is written.
const CONDITIONS: &[(&str, &str)] = &[
    ("==", "an equation has one '=', as in 'x = 0'"),
    (":=", "an equation has one '=', as in 'x = 0'"),
    (" and ", "conditions stand with ',' between them, as in 'x = 0, y = 0'"),
    ("&&", "conditions stand with ',' between them, as in 'x = 0, y = 0'"),
    (";", "conditions stand with ',' between them, as in 'x = 0, y = 0'"),
    (" or ", "ask for each alternative alone: '--where' takes conditions that hold together"),
    ("||", "ask for each alternative alone: '--where' takes conditions that hold together"),
    ("~=", "that a value is not zero is written 'x != 0'"),
    ("<>", "that a value is not zero is written 'x != 0'"),
    (" in ", "a range is written '0 < x < 1'"),
    ("≤", "write '<='"),
    ("≥", "write '>='"),
    ("**", "a power is written with '^', as in x^2"),
];

/// Advice on a message; may be empty.
pub(super) fn about(message: &str) -> &'static str {
    if let Some((_, rest)) = message.split_once("in the condition '") {
        let condition = rest.rsplit_once("', at column").map_or(rest, |(condition, _)| condition);
        if let Some((_, help)) = CONDITIONS.iter().find(|(part, _)| condition.contains(part)) {
            return help;
        }
        let compares = condition.contains(['=', '<', '>']);
        return if compares {
            "a product is written with '*', a function as in sin(x)"
        } else {
            "as in --where 'x = 0' or --where 'x > 0'"
        };
    }
    MESSAGES.iter().find(|(part, _)| message.contains(part)).map_or("", |(_, help)| *help)
}

#[cfg(test)]
mod tests {
    use super::about;

    #[test]
    fn messages_have_advice() {
        for (message, help) in [
            ("in the condition 'x == 0', at column 4: expected a number", "one '='"),
            ("in the condition 'x=0 and y=0', at column 5: expected", "with ',' between them"),
            ("in the condition 'x', at column 2: expected '='", "as in --where 'x = 0'"),
            ("in the condition '2x = 0', at column 2: expected", "with '*'"),
            ("'x' is fixed and solved for in a condition; choose one", "'--at'"),
            ("no state was found in 2000 draws: the conditions have no solution there", "radians"),
            ("a.json: it is no verdict file: expected value", "--verdicts OUT"),
            ("something else", ""),
        ] {
            assert!(
                about(message).contains(help) && (!help.is_empty() || about(message).is_empty()),
                "{message}"
            );
        }
    }
}
