//! What a verdict is about: the parts of a statement, read from its text alone, by which a record is checked against its claim.

use serde::{Deserialize, Serialize};

/// What a statement asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)] // names say it
pub enum ClaimKind {
    Equation,
    Inequality,
    /// Two numbers that are near each other.
    Tolerance,
    /// `rank(M) = n`
    RankOfMatrix,
    /// `rank = n`, of the observability codistribution.
    RankOfSystem,
    /// `observable(...)` and `identifiable(...)`
    Observable,
    /// Their opposites.
    Unobservable,
    Pole,
    Solutions,
    /// Ranks at recorded states: of the codistribution,
    SystemAtStates,
    /// and of the file's own rows.
    RowsAtStates,
    /// Full rank on boxes, of the same two.
    SystemOnBoxes,
    RowsOnBoxes,
}

/// The states at which the claim is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)] // names say it
pub enum ClaimSense {
    /// At all states that meet the conditions and at which both sides exist: equations and inequalities.
    Always,
    /// At almost all of them: ranks.
    Generic,
    Everywhere,
    Except,
    /// At those that are written down.
    Listed,
}

/// What was found of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)] // names say it
pub enum RecordedWord {
    Proved,
    Refuted,
    /// Nothing was claimed: ranks at states, boxes.
    Found,
}

/// The parts of a statement; texts without white space and comments.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClaimParts {
    /// What it asks.
    pub what: ClaimKind,
    /// The number that is claimed: of a rank, a pole, of solutions; the tolerance.
    pub claimed: String,
    /// At which states.
    pub sense: ClaimSense,
    /// `where`, and `on sample`.
    #[serde(rename = "where")]
    pub given: String,
    /// `except where`
    pub except: String,
}

impl ClaimParts {
    /// The parts of a statement as it stands in a proof file. They distinguish claims; the meaning of a claim is left to
    /// whoever reads it.
    pub fn of(text: &str) -> ClaimParts {
        let text = without_comments(text);
        let words = words(&text);
        let at =
            |wanted: &[&str]| words.iter().find(|(_, word)| wanted.contains(word)).map(|(place, _)| *place);
        let end = text.len();
        let except = at(&["except"]).unwrap_or(end);
        let everywhere = at(&["everywhere"]).unwrap_or(end);
        let rest = except.min(everywhere);
        let given = at(&["on", "where"]).unwrap_or(end).min(rest);
        let within = at(&["within"]).filter(|place| *place < given);
        let claim = compact(&text[..within.unwrap_or(given)]);
        let tolerance = within.map(|place| compact(&text[place + "within".len()..given]));
        let (what, claimed) = match tolerance {
            Some(tolerance) => (ClaimKind::Tolerance, tolerance),
            None => asked(&claim),
        };
        let of_rank = matches!(
            what,
            ClaimKind::RankOfMatrix
                | ClaimKind::RankOfSystem
                | ClaimKind::Observable
                | ClaimKind::Unobservable
        );
        let sense = match (except < end, everywhere < end) {
            (true, _) => ClaimSense::Except,
            (_, true) => ClaimSense::Everywhere,
            _ if of_rank => ClaimSense::Generic,
            _ => ClaimSense::Always,
        };
        ClaimParts {
            what,
            claimed,
            sense,
            given: compact(&text[given..rest]),
            except: compact(&text[except..]),
        }
    }

    /// Those of what is found at states or on boxes, where nothing is claimed.
    pub fn listed(what: ClaimKind, given: &str) -> ClaimParts {
        let (claimed, except) = (String::new(), String::new());
        let given = given.split_whitespace().collect::<Vec<_>>().join(" ");
        ClaimParts { what, claimed, sense: ClaimSense::Listed, given, except }
    }
}

/// What is said of ranks at states and on boxes: it follows from the rest of the record, and is no text of its own.
pub fn listed_statement(what: ClaimKind, given: &str) -> String {
    let of = match what {
        ClaimKind::RowsAtStates | ClaimKind::RowsOnBoxes => "the file's own rows",
        _ => "the observability codistribution",
    };
    let place = match given {
        "" => String::new(),
        given => format!(", where {given}"),
    };
    match what {
        ClaimKind::SystemOnBoxes | ClaimKind::RowsOnBoxes => {
            format!("full rank of {of} on these boxes{place}")
        }
        _ => format!("the rank of {of} at these states{place}"),
    }
}

/// A text without white space and comments.
fn compact(text: &str) -> String {
    without_comments(text).split_whitespace().collect()
}

fn without_comments(text: &str) -> String {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// The words of a text, with their places.
fn words(text: &str) -> Vec<(usize, &str)> {
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '\'');
    let mut found = Vec::new();
    let mut begin = None;
    for (place, sign) in text.char_indices().chain([(text.len(), ' ')]) {
        match (begin, is_part(sign)) {
            (None, true) => begin = Some(place),
            (Some(first), false) => {
                found.push((first, &text[first..place]));
                begin = None;
            }
            _ => {}
        }
    }
    found
}

/// What a statement without its conditions asks, and the number that it claims.
fn asked(claim: &str) -> (ClaimKind, String) {
    let none = String::new;
    for (name, what) in [
        ("observable(", ClaimKind::Observable),
        ("identifiable(", ClaimKind::Observable),
        ("unobservable(", ClaimKind::Unobservable),
        ("unidentifiable(", ClaimKind::Unobservable),
    ] {
        if claim.starts_with(name) {
            return (what, none());
        }
    }
    let Some((left, right)) = equation(claim) else { return (ClaimKind::Inequality, none()) };
    let of = |side: &str| match side {
        "rank" => Some(ClaimKind::RankOfSystem),
        _ if side.starts_with("rank(") => Some(ClaimKind::RankOfMatrix),
        _ if side.starts_with("pole(") => Some(ClaimKind::Pole),
        _ if side.starts_with("solutions(") => Some(ClaimKind::Solutions),
        _ => None,
    };
    match (of(left), of(right)) {
        (Some(what), _) => (what, right.to_owned()),
        (None, Some(what)) => (what, left.to_owned()),
        (None, None) => (ClaimKind::Equation, none()),
    }
}

/// The sides of an equation; none of what has another sign outside of brackets.
fn equation(claim: &str) -> Option<(&str, &str)> {
    let (mut depth, mut found) = (0i32, None);
    for (place, sign) in claim.char_indices() {
        match sign {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            '<' | '>' | '!' if depth == 0 => return None,
            '=' if depth == 0 && found.is_none() => found = Some(place),
            _ => {}
        }
    }
    found.map(|place| (&claim[..place], &claim[place + 1..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_statements_are_those_by_eye() {
        use ClaimKind::*;
        use ClaimSense::*;
        for (text, what, claimed, sense, given, except) in [
            ("L(f, x) = v", Equation, "", Always, "", ""),
            ("x at {y = 1} = 2 where a = b, c > 0", Equation, "", Always, "wherea=b,c>0", ""),
            ("0 <= x*x on sample", Inequality, "", Always, "onsample", ""),
            ("x != 7 where y = 0", Inequality, "", Always, "wherey=0", ""),
            ("a = 3.1 within 0.05", Tolerance, "0.05", Always, "", ""),
            ("rank = 3", RankOfSystem, "3", Generic, "", ""),
            ("rank([x, y; 1, 2] at {x = 3}) = 1", RankOfMatrix, "1", Generic, "", ""),
            ("3 = rank where x = 0 # never\n everywhere", RankOfSystem, "3", Everywhere, "wherex=0", ""),
            (
                "rank = 6 where y > 0 except where g = 0 or x = 1",
                RankOfSystem,
                "6",
                Except,
                "wherey>0",
                "exceptwhereg=0orx=1",
            ),
            ("unobservable(m, x)", Unobservable, "", Generic, "", ""),
            ("pole(a/b, b) = 1 where b = 0", Pole, "1", Always, "whereb=0", ""),
            ("solutions(k) = infinity", Solutions, "infinity", Always, "", ""),
            ("where_ever = on_x", Equation, "", Always, "", ""),
        ] {
            let parts = ClaimParts::of(text);
            let (claimed, given, except) = (claimed.to_owned(), given.to_owned(), except.to_owned());
            assert_eq!(parts, ClaimParts { what, claimed, sense, given, except }, "{text}");
        }
    }
}
