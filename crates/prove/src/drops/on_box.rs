//! What interval certificates add where the exact sets are not all known: on how much of the sample box the rank is full.

use crate::certificate::certify_region;
use dashu::rational::RBig;
use palmistry_lang::{Range, System};
use palmistry_math::number::rational_from_f64;
use std::sync::atomic::AtomicBool;

/// So many boxes are looked at.
const BOXES: u64 = 4_000;

/// The share of the sample box on which full rank is proved.
#[derive(Clone, Debug)]
pub struct BoxShare {
    /// The fraction of its volume, rounded down.
    pub proved: f64,
    /// Boxes that were looked at.
    pub boxes: u64,
    /// Its sides, of what the minors depend on.
    pub sides: Vec<(String, Range)>,
    /// Those of them that the file does not give.
    pub by_default: Vec<(String, Range)>,
}

impl BoxShare {
    /// The part in percent, with one digit, rounded down.
    pub fn percent(&self) -> String {
        let tenths = rational_from_f64(self.proved).unwrap_or_default() * RBig::from(1000);
        let tenths = u64::try_from(tenths.floor()).unwrap_or(0);
        format!("{}.{}", tenths / 10, tenths % 10)
    }
}

/// Looks at the sample box.
///
/// # Errors
/// In words, where there is no box or no certificate.
pub(crate) fn share_of_the_box(system: &mut System, interrupt: &AtomicBool) -> Result<BoxShare, String> {
    let answer = certify_region(system, BOXES, interrupt)?;
    if !answer.nowhere.is_empty() {
        return Err(format!("this holds nowhere in the box: {}", answer.nowhere.join(", ")));
    }
    let free = answer.ranges.iter().filter(|(_, matters)| *matters).map(|(side, _)| side);
    let sides =
        free.map(|side| (side.name.clone(), Range { low: side.low.clone(), high: side.high.clone() }));
    Ok(BoxShare {
        proved: answer.proved,
        boxes: answer.boxes,
        sides: sides.collect(),
        by_default: answer.by_default,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_rounded_down() {
        let share =
            |proved: f64| BoxShare { proved, boxes: 1, sides: Vec::new(), by_default: Vec::new() }.percent();
        assert_eq!([share(1.0), share(0.99999), share(0.5), share(0.0004)], ["100.0", "99.9", "50.0", "0.0"]);
    }
}
