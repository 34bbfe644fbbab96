//! How many threads work.

use super::Unusable;
use super::interrupt::STACK;
use palmistry::system::Code;

/// The variable that says how many.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// No more threads than this are made, whatever is asked for: no result depends on their number, and a system that is
/// asked for millions gives none.
const MOST: usize = 1024;

/// Makes the threads that share the work: as many as there are processors, or as many as are asked for.
pub(crate) fn prepare() -> miette::Result<()> {
    let asked = std::env::var(VARIABLE).ok().and_then(|text| text.trim().parse::<u128>().ok());
    let mut pool = rayon::ThreadPoolBuilder::new().stack_size(STACK);
    if let Some(asked) = asked {
        // none means as many as there are processors
        pool = pool.num_threads(usize::try_from(asked).unwrap_or(MOST).min(MOST));
    }
    pool.build_global().map_err(|error| {
        Unusable::report(
            Code::System,
            format!("the system gives no threads to work on: {error}"),
            format!("end other programs first, or ask for fewer with {VARIABLE}"),
        )
    })
}
