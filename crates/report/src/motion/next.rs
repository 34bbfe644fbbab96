//! What to try next where an observer has no plain success: a sentence for each outcome.

use palmistry_observe::{Fit, NoiseFrom, Track, Update, UpdateEnd};

/// An outcome and what to try after it.
type Advice = (&'static str, &'static str);

const UNOBSERVABLE: Advice = (
    "not observable",
    "estimate fewer unknowns, take one of them as 'known', measure more, or use a longer 'window'; 'palmistry rank' of the model says what is unobservable",
);
const STEPS_SPENT: Advice =
    ("all steps spent", "more 'steps', an initial guess that is nearer, or 'bounds' for what is estimated");
const STUCK: Advice =
    ("no step lowers the error", "another initial guess, or 'bounds' for what is estimated");
const LOST: Advice = ("lost", "another initial guess, 'bounds' for what is estimated, or a shorter 'window'");
const UNTESTED: Advice = (
    "residuals not tested",
    "state the 'noise' of the sensors, or use a longer 'window' with more measurements",
);
const SEVERAL: Advice =
    ("another state fits as well", "'bounds' that exclude one of them, a 'known' value, or another output");
const WINDOWS_FAIL: Advice = (
    "the windows together fail",
    "a model in which what changes from window to window is estimated anew (leave out 'inherit'), or more 'noise' of the sensors if they have it",
);
const INNOVATIONS_FAIL: Advice = (
    "innovations fail",
    "more 'process_noise' of the filter, more 'noise' of the sensors if they have it, another model, or a moving-horizon method",
);

/// What to try where residuals are larger than noise, or no noise.
fn after_misfit(fit: &Fit) -> Advice {
    const FAILS: &str = "fails its test";
    match fit.from {
        _ if fit.degrees == 0 => (FAILS, "a longer 'window', or fewer unknowns to estimate"),
        NoiseFrom::Stated if fit.has_outliers() => {
            (FAILS, "'loss = \"huber\"', which gives outliers less weight, or leave their rows out")
        }
        NoiseFrom::Stated if fit.by_drift().is_some() => (
            FAILS,
            "a model in which what drifts is estimated, as a bias or a slow parameter, or a shorter 'window'",
        ),
        NoiseFrom::Stated => (
            FAILS,
            "another model, estimating what is taken for known, or more 'noise' of the sensors if they have it",
        ),
        _ => (
            FAILS,
            "another model, estimating what is taken for known, a shorter 'window', or the 'noise' of each sensor: unless stated, all outputs are taken to have errors of one size",
        ),
    }
}

fn after_update(update: &Update) -> Option<Advice> {
    let misfit = || update.fit.filter(|fit| !fit.fits).map(|fit| after_misfit(&fit));
    match &update.end {
        UpdateEnd::Converged if update.is_untested() => Some(UNTESTED),
        UpdateEnd::Converged => None,
        UpdateEnd::DoesNotFit => misfit(),
        UpdateEnd::StepsSpent => Some(STEPS_SPENT),
        UpdateEnd::Stuck => misfit().or((!update.is_borne_out()).then_some(STUCK)),
        UpdateEnd::Unobservable { .. } => Some(UNOBSERVABLE),
        UpdateEnd::Lost(_) => Some(LOST),
    }
}

/// A sentence for each kind of outcome, once, in the order in which they come.
fn sentences(all: impl Iterator<Item = Advice>) -> Vec<String> {
    let mut kinds: Vec<Advice> = Vec::new();
    for one in all {
        if !kinds.contains(&one) {
            kinds.push(one);
        }
    }
    kinds.into_iter().map(|(outcome, what)| format!("try next ({outcome}): {what}")).collect()
}

/// What to try after the updates of a window, and states that fit as well.
pub(super) fn next_lines(updates: &[Update], others: &[Update]) -> Vec<String> {
    let several = (!others.is_empty()).then_some(SEVERAL);
    sentences(updates.iter().filter_map(after_update).chain(several))
}

/// What to try after all that a method found.
pub(super) fn next_lines_of_track(track: &Track) -> Vec<String> {
    let several = (!track.others.is_empty()).then_some(SEVERAL);
    // each window has its own test; where one of them fails, all together are bound to
    let own = track.updates.iter().all(|update| !update.is_contradicted());
    let together = track.together().filter(|all| own && !all.fits).map(|_| WINDOWS_FAIL);
    let innovations = track.innovations.filter(|own| !own.fits).map(|_| INNOVATIONS_FAIL);
    let held = (track.updates.is_empty() && track.unobserved > 0).then_some(UNOBSERVABLE);
    let updates = track.updates.iter().filter_map(after_update);
    sentences(updates.chain(several).chain(together).chain(innovations).chain(held))
}

/// What to try where the windows of a stream fail together, or the innovations of a filter do.
pub(super) fn next_line_of_tests(windows_fail: bool, innovations_fail: bool) -> Vec<String> {
    sentences(
        windows_fail.then_some(WINDOWS_FAIL).into_iter().chain(innovations_fail.then_some(INNOVATIONS_FAIL)),
    )
}
