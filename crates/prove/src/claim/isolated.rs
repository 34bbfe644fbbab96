//! What ends a decision from inside costs what was being decided, and nothing else. An unexpected panic: the claim is *undecided*, which no
//! file can expect then, and all others are decided as if nothing had happened. And a budget that is used up: every claim has the same
//! one, from which all engines are paid that are asked about it, so that none takes longer or more memory than that, however they call
//! each other. An engine that gives up earlier, at a share of its own, leaves budget for the others.
//!
//! What was worked on is given away with the work, so that nothing half done is met afterwards.

use super::verdict::{Outcome, Verdict};
use palmistry_budget::{Allowance, Budget};
use palmistry_lang::{Basis, ClaimBody, ClaimSyntax, System, in_one_line};
use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Once};

/// Messages are cut to so many characters.
const LONGEST: usize = 300;

/// How many pieces of work are being done that a panic may end.
static BEING_DONE: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// The same on this thread.
    static HERE: Cell<usize> = const { Cell::new(0) };
    /// Where in this program the last of them has ended.
    static PLACE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Does work that owns what it works on, paid from a budget of its own.
pub(super) fn paid<T>(allowed: Allowance, work: impl FnOnce() -> T) -> Result<T, Lost> {
    let budget = Arc::new(Budget::new(allowed));
    let found = isolated(|| budget.within(work)).map_err(Lost::ByPanic)?;
    found.map_err(|spent| Lost::CutOff(format!("cut off: {spent}, and no claim may take more")))
}

/// Why a claim has no verdict by an engine, in a sentence.
pub(super) enum Lost {
    /// This program has a mistake: that is never as expected.
    ByPanic(String),
    /// It is too dear.
    CutOff(String),
}

/// Does work that owns what it works on.
///
/// # Errors
/// That it has panicked, in a sentence: nothing is printed.
pub fn isolated<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    listen();
    BEING_DONE.fetch_add(1, Ordering::SeqCst);
    HERE.set(HERE.get() + 1);
    let found = catch_unwind(AssertUnwindSafe(work));
    HERE.set(HERE.get() - 1);
    BEING_DONE.fetch_sub(1, Ordering::SeqCst);
    found.map_err(|panic| {
        let place = PLACE.take().map(|place| format!(" ({place})")).unwrap_or_default();
        let message = message(panic.as_ref());
        format!("internal error: {message}{place}; this is a bug in this program: please report it")
    })
}

/// From now on panics in such work are not printed; all others are, as before.
fn listen() {
    static LISTENS: Once = Once::new();
    LISTENS.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            // such work may have given a part of itself to another thread of the pool
            let of_the_pool =
                rayon::current_thread_index().is_some() && BEING_DONE.load(Ordering::SeqCst) > 0;
            match HERE.get() > 0 || of_the_pool {
                true => PLACE.set(place(panic)),
                false => before(panic),
            }
        }));
    });
}

/// The file and the line if they are in this program; `None` for a dependency.
fn place(panic: &PanicHookInfo<'_>) -> Option<String> {
    let location = panic.location()?;
    let is_ours = std::path::Path::new(location.file()).is_relative();
    is_ours.then(|| format!("{}, line {}", location.file(), location.line()))
}

/// What was said, in one line.
fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    let text = text.unwrap_or("no message");
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(LONGEST).collect()
}

/// The outcome of a claim whose decision was ended from inside.
pub(super) fn lost(system: &System, claim: &ClaimSyntax, why: Lost, seconds: f64) -> Outcome {
    let statements = claim.body.statements();
    let statement = statements.last().map(|statement| in_one_line(&system.source, &statement.span));
    let (fault, expected) = match &claim.body {
        ClaimBody::Erratum { fault, .. } | ClaimBody::Scan { fault, .. } => (Some(*fault), None),
        ClaimBody::Claim { expected, .. } => (None, Some(*expected)),
        _ => (None, None),
    };
    let (verdict, ok) = match why {
        Lost::ByPanic(why) => (Verdict::undecided(why), false),
        Lost::CutOff(why) => {
            let verdict = Verdict::undecided(why);
            let ok = expected.is_some_and(|expected| verdict.meets(expected));
            (verdict, ok)
        }
    };
    Outcome {
        file: system.name.clone(),
        place: system.place(claim.span.start),
        id: claim.id.clone(),
        statement: statement.unwrap_or_default(),
        fault,
        printed: None,
        quoted: None,
        basis: Basis::clone(&claim.basis),
        follows: claim.follows.as_ref().map(|reference| reference.text()),
        passage: claim.passage.clone(),
        conclusion: claim.conclusion.clone(),
        looks: system.looks.clone(),
        definitions: Vec::new(),
        differentiated_along: Vec::new(),
        pole_of: None,
        verdict,
        domain: Vec::new(),
        expected,
        ok,
        evidence: Vec::new(),
        remark: claim.remark.clone(),
        at_files_values: None,
        printed_at_files_values: None,
        fields: Vec::new(),
        beside: Vec::new(),
        not_looked_at: Vec::new(),
        seconds,
    }
}

/// A claim of this name panics, in tests.
#[cfg(test)]
pub(super) const PANICS: &str = "this-one-panics";

/// One of this name has next to nothing to spend, in tests.
#[cfg(test)]
pub(super) const IS_POOR: &str = "this-one-is-poor";

#[cfg(test)]
mod tests {
    use super::super::{decide, decide_all};
    use super::*;
    use std::sync::Mutex;
    use std::sync::atomic::AtomicBool;

    fn system(second: &str) -> System {
        format!(
            "system \"s\" state x known u(t) param a unknown drift f x+ = a*x + u output x
             claim first: rank = 2
             claim {second} expect undecided: rank = 1 where u = 0
             claim third: rank = 2 where u = 0
             claim fourth: L(f, f, x) = a*(a*x + u) + u"
        )
        .parse()
        .unwrap()
    }

    /// The others have the verdicts that they have in a file in which nothing panics, whether they come before or behind.
    #[test]
    fn a_panic_costs_one_claim() {
        let told = Mutex::new(Vec::new());
        let done = |outcome: &Outcome| told.lock().unwrap().push(outcome.id.clone());
        let outcomes = decide_all(&system(PANICS), 1, &AtomicBool::new(false), &done);
        assert_eq!(told.into_inner().unwrap().len(), 4);
        let others = decide_all(&system("second"), 1, &AtomicBool::new(false), &|_| ());
        for (place, (outcome, other)) in outcomes.iter().zip(&others).enumerate() {
            if place != 1 {
                assert_eq!(outcome.verdict, other.verdict, "{}", outcome.id);
                continue;
            }
            // not even a file that expects no verdict expects this
            assert!(!outcome.ok);
            assert_eq!((outcome.word(), outcome.statement.as_str()), ("undecided", "rank = 1 where u = 0"));
            let Verdict::Undecided { why } = &outcome.verdict else { panic!("{outcome:?}") };
            assert!(
                why.starts_with("internal error: as a test asks (") && why.contains("src/claim/"),
                "{why}"
            );
            assert!(why.ends_with("please report it"), "{why}");
        }
        let claim = &system(PANICS).claims[1].clone();
        assert_eq!(decide(&system(PANICS), claim, 1).verdict, outcomes[1].verdict);
    }

    /// Each engine is paid from the claim's budget: with next to nothing none of them comes to an end, and with what every claim has
    /// all do. What is cut off is undecided, and a file may expect that.
    #[test]
    fn every_engine_is_paid_from_one_budget() {
        let engines = [
            ("an identity", "(x + a)^9*(x - a)^9 = (x^2 - a^2)^9", "proved"),
            ("laws of functions", "exp(x + a)*sqrt(x^2)/exp(a) = exp(x)*abs(x)", "proved"),
            ("a generic rank", "rank = 5", "proved"),
            ("the rank of a matrix", "rank([x, y, a; y, a, x; a, x, y]) = 3", "proved"),
            ("all states", "rank([x^2 + 1, y; a, y^2 + 1]) = 1 everywhere", "refuted"),
            ("a set", "rank = 5 where x = 1", "proved"),
            ("what is observable", "observable(x, y, a, b)", "proved"),
            ("an unobservable field", "unobservable(x + t)", "refuted"),
            ("signs and squares", "x^2 - 2*x*y + 3*y^2 + a^4 - 2*a^2 + 1 >= 0", "proved"),
            ("zeros on a line", "x^6 - 3*x^4 + 5*x^2 - x + 7 > 0", "proved"),
            ("boxes", "x*y*sin(x*y) <= 1 where x in [0, 1], y in [0, 1]", "proved"),
            ("a pole", "pole((x^2 + a)/(x - y)^3, x - y) = 3", "proved"),
            ("a number", "exp(1)*pi = 8.5397342226735670654635508695465745 within 1e-30", "proved"),
        ];
        let file = |id: &str, statement: &str, expected: &str| -> System {
            format!(
                "system \"s\" state x, y, t param a, b unknown drift f x' = a*x*y - b y' = x - a*y t' = 1 output x, t \
                 claim {id} expect {expected}: {statement}"
            )
            .parse()
            .unwrap_or_else(|error| panic!("{statement}: {error}"))
        };
        for (engine, statement, verdict) in engines {
            let system = file("rich", statement, verdict);
            let rich = decide(&system, &system.claims[0], 1);
            assert_eq!(rich.word(), verdict, "{engine}: {:?}", rich.verdict);
            let system = file(IS_POOR, statement, "undecided");
            let poor = decide(&system, &system.claims[0], 1);
            let Verdict::Undecided { why } = &poor.verdict else { panic!("{engine}: {poor:?}") };
            assert_eq!(
                why, "cut off: it asks for more than 500 steps of work, and no claim may take more",
                "{engine}"
            );
            assert!(poor.ok, "{engine}");
        }
    }

    /// Whether a claim is cut off does not depend on how many threads share its work.
    #[test]
    fn a_budget_is_the_same_on_any_number_of_threads() {
        let long: Vec<String> =
            (1..9).map(|k| format!("x{k}' = x{k}*x{}*a + sin(x{k})", k % 8 + 1)).collect();
        let states: Vec<String> = (1..9).map(|k| format!("x{k}")).collect();
        let system: System = format!(
            "system \"s\" state {} param a unknown drift f {} output x1 claim {IS_POOR}: rank = 9 claim other: rank = 9",
            states.join(", "),
            long.join(" ")
        )
        .parse()
        .unwrap();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let outcomes = pool.install(|| decide_all(&system, 1, &AtomicBool::new(false), &|_| ()));
            outcomes.into_iter().map(|outcome| outcome.verdict).collect::<Vec<_>>()
        };
        let one = on(1);
        assert!(matches!(&one[0], Verdict::Undecided { why } if why.starts_with("cut off: ")), "{one:?}");
        assert_eq!(one, on(4));
    }

    /// Also where a part of the work was given to other threads; and text of a file is printed in one line.
    #[test]
    fn panics_of_other_threads_are_told() {
        use rayon::prelude::*;
        let why =
            isolated(|| (0..64).into_par_iter().for_each(|n| assert!(n != 63, "line\nbreak"))).unwrap_err();
        assert!(why.starts_with("internal error: line break"), "{why}");
        assert_eq!(isolated(|| 7), Ok(7));
    }
}
