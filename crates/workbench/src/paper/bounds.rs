//! How much is done of a system with many unknowns: every rank at a state is an elimination, whose work grows with the cube of
//! their number. The bounds are on work and not on time, so that two runs find the same.

use super::left_out::LeftOut;
use palmistry_lang::System;

/// States of the sample box, and of each set, at which ranks are decided.
const SAMPLES: u64 = 20_000;
const SAMPLES_ON_A_SET: u64 = 200;

/// Of the largest system at least so many.
const FEWEST_SAMPLES: u64 = 100;

/// Times the cube of the number of unknowns: about ten seconds on one core.
const MOST_WORK_OF_A_SWEEP: u64 = 400_000_000;

/// Of larger systems the extremes and speed against accuracy are left to the commands that do nothing else.
const MOST_UNKNOWNS: usize = 40;

/// At how many states ranks are decided, on a set or in the sample box.
pub(super) fn samples(system: &System, on_a_set: bool) -> u64 {
    let unknowns = system.unknown_count() as u64;
    let affordable = MOST_WORK_OF_A_SWEEP / unknowns.pow(3).max(1);
    let wanted = if on_a_set { SAMPLES_ON_A_SET } else { SAMPLES };
    wanted.min(affordable.max(FEWEST_SAMPLES))
}

/// That ranks are decided at fewer states than of a small system.
pub(super) fn fewer_samples(system: &System) -> Option<LeftOut> {
    let samples = samples(system, false);
    let why = || {
        format!(
            "{samples} states of the sample box and not {SAMPLES}, as there are {} unknowns; 'palmistry rank {} --samples {SAMPLES}' takes them all",
            system.unknown_count(),
            system.name
        )
    };
    (samples < SAMPLES).then(|| LeftOut { what: "the rank".to_owned(), why: why() })
}

/// Why something is left to a command of its own, where the system is too large for it here.
pub(super) fn left_to_a_command(system: &System, what: &str, command: &str) -> Option<LeftOut> {
    let unknowns = system.unknown_count();
    let why = || {
        format!(
            "there are {unknowns} unknowns, and at most {MOST_UNKNOWNS} are taken here; 'palmistry {command} {}' does it",
            system.name
        )
    };
    (unknowns > MOST_UNKNOWNS).then(|| LeftOut { what: what.to_owned(), why: why() })
}
