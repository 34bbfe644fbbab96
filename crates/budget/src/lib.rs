//! What a file or a claim may make the program do, counted and not timed: the same file comes to the same end on every machine.
//!
//! Readers hold a [`Budget`] and get an error when it is [`Spent`]. Engines are deep in each other, and most of their functions have
//! no way to say that they gave up: they work [within](Budget::within) a budget, and the few places where their work is done
//! (a node is made, a program runs, polynomials are multiplied, rows are reduced) spend from the budget of the thread by
//! [`steps`], [`nodes`] and [`bytes`]. Where it is used up the stack is unwound to [`Budget::within`], as an incremental compiler
//! cancels a query: whatever was half done must not be met again, so that the work owns what it changes.

#![warn(missing_docs)]

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Amounts of bytes, nodes and steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Allowance {
    /// Bytes that are read, kept or written.
    pub bytes: u64,
    /// Nodes of trees and graphs that are made.
    pub nodes: u64,
    /// Steps of work: something looked at, copied or computed once.
    pub steps: u64,
}

/// What is spent of an allowance. Several threads may spend from one budget.
#[derive(Debug)]
pub struct Budget {
    allowed: Allowance,
    bytes: AtomicU64,
    nodes: AtomicU64,
    steps: AtomicU64,
}

/// An allowance is used up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Spent {
    /// More than so many bytes.
    #[error("it would take more than {}", bytes_in_words(*.0))]
    Bytes(u64),
    /// More than so many nodes.
    #[error("its expressions have more than {0} parts in all, once names are put in")]
    Nodes(u64),
    /// More than so many steps.
    #[error("it asks for more than {0} steps of work")]
    Steps(u64),
}

fn bytes_in_words(bytes: u64) -> String {
    match bytes {
        0..0x400 => format!("{bytes} bytes"),
        0x400..0x10_0000 => format!("{} KiB", bytes >> 10),
        _ => format!("{} MiB", bytes >> 20),
    }
}

/// What all readers of this process have spent: what tests of growth look at.
static ALL: [AtomicU64; 3] = [const { AtomicU64::new(0) }; 3];

/// Bytes, nodes and steps that all readers together have spent since the program began.
pub fn spent_in_all() -> Allowance {
    let [bytes, nodes, steps] = ALL.each_ref().map(|count| count.load(Ordering::Relaxed));
    Allowance { bytes, nodes, steps }
}

thread_local! {
    /// The budget from which the work of this thread is paid.
    static HERE: RefCell<Option<Arc<Budget>>> = const { RefCell::new(None) };
}

/// The budget from which the work of this thread is paid, to be [carried](Share::carry) to other threads.
#[derive(Clone, Debug, Default)]
pub struct Share(Option<Arc<Budget>>);

impl Share {
    /// That of this thread; none where nothing is counted.
    pub fn here() -> Share {
        Share(HERE.with_borrow(Option::clone))
    }

    /// Does a part of the work on this thread, paid from the budget that it was taken from.
    pub fn carry<T>(&self, work: impl FnOnce() -> T) -> T {
        let _before = Restored(HERE.replace(self.0.clone()));
        work()
    }
}

/// Whether the work of this thread is paid from a budget.
pub fn is_counted() -> bool {
    HERE.with_borrow(Option::is_some)
}

/// Does work that owns what it changes, paid by whoever asked: from the budget of this thread where it has one, otherwise from a new one.
///
/// # Errors
/// The new one is used up. Where the thread has one, its end is met where that one began.
pub fn paid<T>(allowed: Allowance, work: impl FnOnce() -> T) -> Result<T, Spent> {
    match is_counted() {
        true => Ok(work()),
        false => Arc::new(Budget::new(allowed)).within(work),
    }
}

/// Puts back the budget of before, also when the stack is unwound.
struct Restored(Option<Arc<Budget>>);

impl Drop for Restored {
    fn drop(&mut self) {
        HERE.set(self.0.take());
    }
}

/// Spends steps from the budget of this thread, if it has one; see [`Budget::within`].
pub fn steps(count: usize) {
    here(|budget| add(&budget.steps, count, budget.allowed.steps).map_err(Spent::Steps));
}

/// Spends nodes, likewise.
pub fn nodes(count: usize) {
    here(|budget| add(&budget.nodes, count, budget.allowed.nodes).map_err(Spent::Nodes));
}

/// Spends bytes, likewise.
pub fn bytes(count: usize) {
    here(|budget| add(&budget.bytes, count, budget.allowed.bytes).map_err(Spent::Bytes));
}

fn here(spend: impl FnOnce(&Budget) -> Result<(), Spent>) {
    let spent = HERE.with_borrow(|budget| budget.as_deref().map_or(Ok(()), spend));
    if let Err(spent) = spent {
        // no hook runs and nothing is printed: this is no panic
        resume_unwind(Box::new(spent));
    }
}

/// What one question may take that is put to the engines: a claim, or the set on which a rank drops. The dearest claim that comes with the
/// program takes an eighth of the steps and a sixteenth of the nodes; all of them are some minutes, and a gigabyte or two.
pub const OF_A_QUESTION: Allowance = Allowance { bytes: 1 << 30, nodes: 1 << 24, steps: 1 << 33 };

impl Budget {
    /// Nothing is spent yet.
    pub const fn new(allowed: Allowance) -> Budget {
        Budget { allowed, bytes: AtomicU64::new(0), nodes: AtomicU64::new(0), steps: AtomicU64::new(0) }
    }

    /// Does work that is paid from this budget wherever it calls [`steps`], [`nodes`] or [`bytes`]: on this thread, and on others
    /// to which a [`Share`] is carried. A budget inside another one is separate: nothing is spent from the outer one.
    ///
    /// # Errors
    /// It is used up: the work was left where it was, and what it has half done must not be used.
    ///
    /// # Panics
    /// Where the work does.
    pub fn within<T>(self: &Arc<Self>, work: impl FnOnce() -> T) -> Result<T, Spent> {
        let share = Share(Some(self.clone()));
        catch_unwind(AssertUnwindSafe(|| share.carry(work))).map_err(|thrown| {
            match thrown.downcast::<Spent>() {
                Ok(spent) => *spent,
                Err(panic) => resume_unwind(panic),
            }
        })
    }

    /// Spends bytes.
    ///
    /// # Errors
    /// Not so many are left.
    pub fn bytes(&self, count: usize) -> Result<(), Spent> {
        spend(&self.bytes, 0, count, self.allowed.bytes).map_err(Spent::Bytes)
    }

    /// Spends nodes.
    ///
    /// # Errors
    /// Not so many are left.
    pub fn nodes(&self, count: usize) -> Result<(), Spent> {
        spend(&self.nodes, 1, count, self.allowed.nodes).map_err(Spent::Nodes)
    }

    /// Spends steps.
    ///
    /// # Errors
    /// Not so many are left.
    pub fn steps(&self, count: usize) -> Result<(), Spent> {
        spend(&self.steps, 2, count, self.allowed.steps).map_err(Spent::Steps)
    }

    /// What has been spent so far.
    pub fn spent(&self) -> Allowance {
        let [bytes, nodes, steps] =
            [&self.bytes, &self.nodes, &self.steps].map(|count| count.load(Ordering::Relaxed));
        Allowance { bytes, nodes, steps }
    }
}

fn spend(own: &AtomicU64, kind: usize, count: usize, allowed: u64) -> Result<(), u64> {
    ALL[kind].fetch_add(count as u64, Ordering::Relaxed);
    add(own, count, allowed)
}

fn add(own: &AtomicU64, count: usize, allowed: u64) -> Result<(), u64> {
    let count = count as u64;
    let before = own.fetch_add(count, Ordering::Relaxed);
    if before.saturating_add(count) > allowed { Err(allowed) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    const SOME: Allowance = Allowance { bytes: 100, nodes: 10, steps: 1000 };

    #[test]
    fn what_is_spent_is_gone() {
        let budget = Budget::new(Allowance { bytes: 3 << 20, nodes: 10, steps: 0 });
        assert_eq!(budget.nodes(10), Ok(()));
        assert_eq!(budget.nodes(1), Err(Spent::Nodes(10)));
        assert_eq!(budget.bytes(4 << 20).unwrap_err().to_string(), "it would take more than 3 MiB");
        assert_eq!(budget.steps(0), Ok(()));
        assert!(budget.steps(1).is_err());
        assert_eq!(budget.spent(), Allowance { bytes: 4 << 20, nodes: 11, steps: 1 });
    }

    #[test]
    fn work_ends_where_its_budget_does() {
        let budget = Arc::new(Budget::new(SOME));
        let done = Cell::new(0);
        let ended = budget.within(|| {
            loop {
                steps(7);
                done.set(done.get() + 1);
            }
        });
        assert_eq!(ended, Err::<(), _>(Spent::Steps(1000)));
        assert_eq!(done.get(), 142);
        // and nothing is counted where there is none
        steps(usize::MAX);
        assert_eq!(budget.spent().steps, 143 * 7);
    }

    #[test]
    fn a_budget_within_another_is_apart_and_ends_with_its_work() {
        let (outer, inner) = (Arc::new(Budget::new(SOME)), Arc::new(Budget::new(SOME)));
        let both = outer.within(|| {
            nodes(1);
            let ended = inner.within(|| nodes(11));
            assert_eq!(ended, Err(Spent::Nodes(10)));
            bytes(2);
        });
        assert_eq!(both, Ok(()));
        assert_eq!((outer.spent().nodes, outer.spent().bytes, inner.spent().nodes), (1, 2, 11));
    }

    #[test]
    fn who_asks_within_a_budget_pays_from_it() {
        let outer = Arc::new(Budget::new(SOME));
        let ended = outer.within(|| paid(Allowance { bytes: 0, nodes: 0, steps: 0 }, || nodes(3)));
        assert_eq!((ended, outer.spent().nodes), (Ok(Ok(())), 3));
        assert_eq!(outer.within(|| paid(SOME, || nodes(8))), Err(Spent::Nodes(10)));
        assert_eq!(paid(SOME, || nodes(11)), Err(Spent::Nodes(10)));
    }

    #[test]
    fn threads_spend_from_the_budget_that_is_carried_to_them() {
        let budget = Arc::new(Budget::new(SOME));
        let ended = budget.within(|| {
            let share = Share::here();
            std::thread::scope(|scope| {
                for _ in 0..4 {
                    scope.spawn(|| share.carry(|| (0..10).for_each(|_| steps(5))));
                }
                scope.spawn(|| steps(1_000_000));
            });
        });
        assert_eq!(ended, Ok(()));
        assert_eq!(budget.spent().steps, 200);
    }

    #[test]
    #[should_panic(expected = "as a test asks")]
    fn a_panic_is_no_end_of_a_budget() {
        let _ = Arc::new(Budget::new(SOME)).within(|| panic!("as a test asks"));
    }
}
