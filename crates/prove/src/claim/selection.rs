//! Claims that are asked for by their ids.

use palmistry_lang::nearest;

/// Some claims, by patterns: an id; the part of ids before a dot, so that `4.44` is `4.44.r1` and `4.44.r2` too, but not
/// `4.445`; and `*` for any characters, as in `reduce.*1`. No pattern means all claims.
///
/// ```
/// use palmistry_prove::claim::Selection;
/// let some = Selection::new(["4.44", "reduce.*1"]);
/// let ids = ["4.44", "4.44.r1", "4.445", "reduce.r1", "reduce.r2"];
/// let kept: Vec<&str> = ids.into_iter().filter(|id| some.keeps(id)).collect();
/// assert_eq!(kept, ["4.44", "4.44.r1", "reduce.r1"]);
/// assert_eq!(Selection::new(["4.54"]).unmet(["4.44"]).unwrap().nearest.as_deref(), Some("4.44"));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    patterns: Vec<String>,
}

/// A pattern that no claim meets.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no claim '{pattern}'")]
pub struct UnmetPattern {
    /// As it was given.
    pub pattern: String,
    /// The id that it may have been meant for.
    pub nearest: Option<String>,
}

impl Selection {
    /// The claims that meet any of the patterns.
    pub fn new(patterns: impl IntoIterator<Item = impl Into<String>>) -> Selection {
        Selection { patterns: patterns.into_iter().map(Into::into).collect() }
    }

    /// Whether a claim is one of them.
    pub fn keeps(&self, id: &str) -> bool {
        self.patterns.is_empty() || self.patterns.iter().any(|pattern| meets(pattern, id))
    }

    /// The first pattern that none of these ids meets.
    pub fn unmet<'a>(&self, ids: impl IntoIterator<Item = &'a str> + Clone) -> Option<UnmetPattern> {
        let none_meets = |pattern: &&String| !ids.clone().into_iter().any(|id| meets(pattern, id));
        self.patterns.iter().find(none_meets).map(|pattern| UnmetPattern {
            pattern: pattern.clone(),
            nearest: nearest(pattern, ids.clone()).map(str::to_owned),
        })
    }
}

fn meets(pattern: &str, id: &str) -> bool {
    let begins = |rest: &str| rest.is_empty() || rest.starts_with('.');
    let Some((first, rest)) = pattern.split_once('*') else {
        return id.strip_prefix(pattern).is_some_and(begins);
    };
    let Some(mut id) = id.strip_prefix(first) else { return false };
    let parts: Vec<&str> = rest.split('*').collect();
    let Some((last, middle)) = parts.split_last() else { return true };
    for part in middle {
        // the earliest place leaves the most for the parts behind it
        match id.find(part) {
            Some(at) => id = &id[at + part.len()..],
            None => return false,
        }
    }
    id.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_stand_for_any_characters_and_nothing_else_does() {
        for (pattern, id, expected) in [
            ("*", "", true),
            ("a*", "a", true),
            ("a*a", "a", false),
            ("a*a", "aa", true),
            ("*b*", "abc", true),
            ("*b*c*d", "bxcxd", true),
            ("*b*c*d", "bxdxc", false),
            ("a**c", "abc", true),
            ("4.4", "4.44", false),
            ("4.4", "4.4.x", true),
            ("4?4", "4.4", false),
            ("", "", true),
            ("", "a", false),
            ("é*", "éa", true),
        ] {
            assert_eq!(meets(pattern, id), expected, "{pattern} {id}");
        }
    }
}
