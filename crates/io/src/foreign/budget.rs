//! What a file may make the program do, counted and not timed: the same file comes to the same end on every machine.

use std::sync::atomic::{AtomicU64, Ordering};

/// So much, of each.
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

/// What all budgets of this process have spent: what tests of growth look at.
static ALL: [AtomicU64; 3] = [const { AtomicU64::new(0) }; 3];

/// Bytes, nodes and steps that all budgets together have spent since the program began.
pub fn spent_in_all() -> Allowance {
    let [bytes, nodes, steps] = ALL.each_ref().map(|count| count.load(Ordering::Relaxed));
    Allowance { bytes, nodes, steps }
}

impl Budget {
    /// Nothing is spent yet.
    pub const fn new(allowed: Allowance) -> Budget {
        Budget { allowed, bytes: AtomicU64::new(0), nodes: AtomicU64::new(0), steps: AtomicU64::new(0) }
    }

    /// Spends bytes.
    ///
    /// # Errors
    /// There are not so many left.
    pub fn bytes(&self, count: usize) -> Result<(), Spent> {
        spend(&self.bytes, 0, count, self.allowed.bytes).map_err(Spent::Bytes)
    }

    /// Spends nodes.
    ///
    /// # Errors
    /// There are not so many left.
    pub fn nodes(&self, count: usize) -> Result<(), Spent> {
        spend(&self.nodes, 1, count, self.allowed.nodes).map_err(Spent::Nodes)
    }

    /// Spends steps.
    ///
    /// # Errors
    /// There are not so many left.
    pub fn steps(&self, count: usize) -> Result<(), Spent> {
        spend(&self.steps, 2, count, self.allowed.steps).map_err(Spent::Steps)
    }

    /// What is spent until now.
    pub fn spent(&self) -> Allowance {
        let [bytes, nodes, steps] =
            [&self.bytes, &self.nodes, &self.steps].map(|count| count.load(Ordering::Relaxed));
        Allowance { bytes, nodes, steps }
    }
}

fn spend(own: &AtomicU64, kind: usize, count: usize, allowed: u64) -> Result<(), u64> {
    let count = count as u64;
    ALL[kind].fetch_add(count, Ordering::Relaxed);
    let before = own.fetch_add(count, Ordering::Relaxed);
    if before.saturating_add(count) > allowed { Err(allowed) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
