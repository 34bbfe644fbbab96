//! What is done once for a question is paid from a budget, as a claim is: a stranger's file may ask for Lie derivatives without end.
//! States are looked at as often as the user asks, and are paid from none.

use super::question::RankError;
use palmistry_budget::{Allowance, OF_A_QUESTION, is_counted, paid};
use palmistry_lang::System;

/// Does what is done once for a question.
///
/// # Errors
/// Those of the work, and that it takes more than a question may; the system is then as it was before.
pub(super) fn paid_on_a_copy<T>(
    system: &mut System,
    work: impl FnOnce(&mut System) -> Result<T, RankError>,
) -> Result<T, RankError> {
    within(OF_A_QUESTION, system, work)
}

/// The same for work whose amount the user gives: nothing but its memory is counted.
///
/// # Errors
/// As for [`paid_on_a_copy`].
pub(super) fn paid_for_memory<T>(
    system: &mut System,
    work: impl FnOnce(&mut System) -> Result<T, RankError>,
) -> Result<T, RankError> {
    within(Allowance { steps: u64::MAX, ..OF_A_QUESTION }, system, work)
}

fn within<T>(
    allowed: Allowance,
    system: &mut System,
    work: impl FnOnce(&mut System) -> Result<T, RankError>,
) -> Result<T, RankError> {
    if is_counted() {
        return work(system); // who counts meets the end, and has the copy
    }
    let mut copy = system.clone();
    let found = paid(allowed, || work(&mut copy))?;
    *system = copy;
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observability::{Accessibility, Codistribution, Length};
    use palmistry_budget::Spent;
    use palmistry_lang::Assignment;

    type Work = fn(&mut System) -> Result<usize, RankError>;

    fn brackets(system: &mut System) -> Result<usize, RankError> {
        Ok(Accessibility::new(system, &Assignment::new(), None, &mut |_| ())?.names.len())
    }

    fn lie_derivatives(system: &mut System) -> Result<usize, RankError> {
        Ok(Codistribution::new(system, &Assignment::new(), Length::UntilItStops)?.generic_rank())
    }

    #[test]
    fn what_is_too_much_leaves_the_system_as_it_was() {
        let text = r#"
            system "A point that turns"
            state x, y, z
            drift f  x' = y*z  y' = z*x/(1 + y^2)  z' = x*y
            input g  x' = 1  others' = 0
            output x*y
        "#;
        let works: [(Work, usize); 2] = [(brackets, 4), (lie_derivatives, 3)];
        for (work, found) in works {
            let mut system: System = text.parse().expect("a system");
            let before = system.graph.len();
            let few = Allowance { steps: 50, ..OF_A_QUESTION };
            let ended = within(few, &mut system, work);
            assert!(matches!(ended, Err(RankError::CutOff(Spent::Steps(50)))), "{ended:?}");
            assert_eq!(system.graph.len(), before);
            assert_eq!(paid_on_a_copy(&mut system, work).expect("enough"), found);
            assert!(system.graph.len() > before);
        }
    }
}
