//! Stretches of work that together are all of it, each piece once.

use std::ops::Range;

/// Why stretches are no whole, by the names that they were given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoCover {
    Gap(Range<u64>),
    Overlap { one: String, other: String, both: Range<u64> },
}

/// Parts in the order of their stretches, which together are `0..whole`, each piece in one of them. An empty one may lie anywhere.
///
/// # Errors
/// The first gap, or the first two that overlap.
pub fn in_order<T>(
    mut parts: Vec<(String, T)>,
    stretch: impl Fn(&T) -> Range<u64>,
    whole: u64,
) -> Result<Vec<(String, T)>, NoCover> {
    let ends = |part: &T| {
        let Range { start, end } = stretch(part);
        (start, end)
    };
    parts.sort_by_key(|(_, part)| ends(part));
    // up to where all is there, and who had the last of it
    let (mut done, mut last): (u64, Option<&str>) = (0, None);
    for (name, part) in &parts {
        let Range { start, end } = stretch(part);
        if start < done
            && start < end
            && let Some(one) = last
        {
            let both = start..done.min(end);
            return Err(NoCover::Overlap { one: one.to_owned(), other: name.clone(), both });
        }
        if start > done {
            return Err(NoCover::Gap(done..start));
        }
        if end > done {
            (done, last) = (end, Some(name.as_str()));
        }
    }
    if done < whole { Err(NoCover::Gap(done..whole)) } else { Ok(parts) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(ranges: &[Range<u64>], whole: u64) -> Result<Vec<usize>, NoCover> {
        let parts =
            ranges.iter().enumerate().map(|(place, range)| (place.to_string(), range.clone())).collect();
        let found = in_order(parts, Range::clone, whole)?;
        Ok(found.iter().map(|(name, _)| name.parse().unwrap()).collect())
    }

    /// Each case can be checked by eye.
    #[test]
    fn gaps_and_overlaps_are_named() {
        assert_eq!(order(&[4..6, 0..4, 6..9], 9), Ok(vec![1, 0, 2]));
        assert_eq!(order(&[0..4, 2..2, 9..9, 4..9], 9), Ok(vec![0, 1, 3, 2]));
        assert_eq!(order(&[], 0), Ok(vec![]));
        assert_eq!(order(&[], 3), Err(NoCover::Gap(0..3)));
        assert_eq!(order(std::slice::from_ref(&(1..3)), 3), Err(NoCover::Gap(0..1)));
        assert_eq!(order(&[0..2, 3..4], 4), Err(NoCover::Gap(2..3)));
        assert_eq!(order(std::slice::from_ref(&(0..2)), 4), Err(NoCover::Gap(2..4)));
        let overlap = |one: &str, other: &str, both| {
            Err(NoCover::Overlap { one: one.to_owned(), other: other.to_owned(), both })
        };
        assert_eq!(order(&[0..3, 2..5], 5), overlap("0", "1", 2..3));
        assert_eq!(order(&[0..5, 2..3], 5), overlap("0", "1", 2..3));
        assert_eq!(order(&[0..2, 0..2, 2..5], 5), overlap("0", "1", 0..2));
    }
}
