//! Files that grow: for each reader a row of files of sizes n, 2n and 4n, as somebody would write them who means harm. What reading them costs is
//! counted and not timed: bytes that are asked of the allocator, the length of what comes out, and what budgets have spent. Each may grow as the
//! file does, or the file is refused; squares and doublings are found.

mod cases;
mod count;

use cases::{CASES, Case, Outcome};
use count::allocated;
use std::sync::{Mutex, PoisonError};

/// What reading a file of some size has cost.
#[derive(Clone, Copy, Debug)]
struct Cost {
    size: usize,
    bytes: u64,
    written: usize,
    steps: u64,
}

fn cost(case: &Case, n: usize) -> Option<Cost> {
    let file = (case.file)(n);
    // readers read on stacks of their own size
    let read = case.read;
    let (outcome, before, after, steps) = std::thread::Builder::new()
        .stack_size(64 << 20)
        .spawn({
            let file = file.clone();
            move || {
                let spent = palmistry::foreign::spent_in_all();
                let before = allocated();
                let outcome = read(&file);
                let after = allocated();
                let now = palmistry::foreign::spent_in_all();
                (outcome, before, after, now.steps + now.nodes - spent.steps - spent.nodes)
            }
        })
        .unwrap()
        .join()
        .unwrap_or_else(|_| panic!("the reader of {} panics at {n}", case.name));
    match outcome {
        Outcome::Refused => None,
        Outcome::Read { written } => Some(Cost { size: file.len(), bytes: after - before, written, steps }),
    }
}

/// A file four times as long may cost no more than so many times as much: four, what vectors that double need more, and what a logarithm adds. A
/// square would cost sixteen times as much.
const MOST_TIMES: f64 = 7.0;

/// Below this the fixed part of the cost is the larger one.
const NEGLIGIBLE: u64 = 200_000;

/// One file at a time: the counts are those of the process.
static ONE: Mutex<()> = Mutex::new(());

#[test]
fn what_reading_costs_grows_as_the_file_does() {
    let _one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    let (mut read, mut refused) = (0, 0);
    let mut wrong = Vec::new();
    for case in CASES {
        let costs: Vec<Option<Cost>> = [1, 2, 4].map(|times| cost(case, case.n * times)).to_vec();
        let [Some(one), _, Some(four)] = costs.as_slice() else {
            // what is refused at one size is refused at all larger ones
            let first = costs.iter().position(Option::is_none).unwrap();
            assert!(costs[first..].iter().all(Option::is_none), "{}: {costs:?}", case.name);
            assert!(case.may_be_refused, "{} is refused: {costs:?}", case.name);
            refused += 1;
            continue;
        };
        read += 1;
        let times = four.size as f64 / one.size as f64;
        for (what, one, four) in [
            ("bytes allocated", one.bytes, four.bytes),
            ("bytes written", one.written as u64 * 10, four.written as u64 * 10),
            ("steps and nodes", one.steps * 10, four.steps * 10),
        ] {
            let limit = MOST_TIMES / 4.0 * times * one.max(NEGLIGIBLE) as f64;
            if four as f64 >= limit {
                wrong.push(format!("{}: {what} grow from {one} to {four}: {costs:?}", case.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // the counts that book/src/tests.md tells
    let book = include_str!("../../book/src/tests.md");
    let told = format!("{} rows of files", read + refused);
    assert!(book.contains(&told), "the book's page on tests does not say '{told}'");
}

/// Each reader has a file behind 64 kB, where sizes of sixteen bits end.
#[test]
fn files_reach_past_what_sixteen_bits_count() {
    let _one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut short = Vec::new();
    for case in CASES.iter().filter(|case| !case.may_be_refused) {
        let longest = (case.file)(case.n * 4).len();
        if longest <= 1 << 16 && !case.grows_slowly {
            short.push((case.name, longest));
        }
    }
    assert!(short.is_empty(), "{short:?}");
}

/// The harness finds squares and doublings: readers that are made to have them.
#[test]
fn a_square_and_a_doubling_are_found() {
    let _one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    let square = |file: &[u8]| {
        let kept: Vec<Vec<u8>> = (0..file.len()).map(|at| file[..at].to_vec()).collect();
        Outcome::Read { written: kept.len() }
    };
    let case = Case {
        name: "a square",
        n: 2000,
        file: |n| vec![b'a'; n],
        read: square,
        may_be_refused: false,
        grows_slowly: true,
    };
    let [one, four] = [1, 4].map(|times| cost(&case, case.n * times).unwrap().bytes as f64);
    assert!(four / one > 2.0 * MOST_TIMES, "{one} {four}");
}
