//! A scene with friction carried through time, from one pair of modes to the next.

use super::consistent::consistent;
use super::laws::Rubbing;
use super::modes::{ContactMode, ModePair};
use crate::mechanics::moving::integrate::own_steps;
use crate::mechanics::moving::laws::State;
use crate::mechanics::moving::scene::{MovingScene, SceneError};
use crate::mechanics::moving::simulate::{LOCATED, checked_times};
use crate::mechanics::moving::trajectory::{Ended, Moment, Trajectory};
use crate::mechanics::palm::Palm;
use palmistry_io::foreign::{Allowance, Budget};

/// After so many changes of mode a motion is given up.
const MOST_CHANGES: usize = 10_000;

/// What a motion may cost: steps of the integrator, those that look for a change of mode included. A minute of sliding takes thousands.
const ALLOWANCE: Allowance = Allowance { bytes: u64::MAX, nodes: u64::MAX, steps: 300_000 };

/// So many of the longest steps are integrated before the modes are looked at: what lies behind the next change is thrown away.
const AHEAD: f64 = 64.0;

/// By how much a sliding contact may slide the other way, in m/s, and what sticks leave its cone, relative to the forces, before it is
/// noticed: ten times the error of the integration.
const SEEN: f64 = 1e-11;

/// A motion with friction.
#[derive(Clone, Debug)]
pub struct RubbedMotion {
    pub trajectory: Trajectory,
    /// From when on which modes held; the first from time zero on.
    pub modes: Vec<(f64, ModePair)>,
}

impl RubbedMotion {
    /// A motion without friction, which has no modes.
    pub fn smooth(trajectory: Trajectory) -> RubbedMotion {
        RubbedMotion { trajectory, modes: Vec::new() }
    }
}

/// What is integrated: the state, what friction has taken, and the time since the start of the integration.
type Vector = [f64; 9];

#[derive(Clone, Copy, Debug)]
struct Rubbed {
    time: f64,
    state: State,
    dissipated: f64,
}

impl Rubbed {
    fn of(time: f64, y: &Vector) -> Rubbed {
        Rubbed { time, state: std::array::from_fn(|i| y[i]), dissipated: y[7] }
    }
}

/// Why a motion does not go on in its modes.
#[derive(Clone, Debug, PartialEq)]
enum Change {
    /// It has to be another pair of modes.
    Modes,
    /// It ends.
    Ends(Ended),
}

struct Motion<'a> {
    scene: &'a MovingScene,
    coefficient: f64,
    pair: ModePair,
    longest: f64,
    budget: Budget,
}

impl Motion<'_> {
    fn at(&self, rubbed: &Rubbed) -> Rubbing {
        Rubbing::at(self.scene, self.coefficient, self.pair, rubbed.time, &rubbed.state)
    }

    fn moment(&self, rubbed: &Rubbed) -> Moment {
        let here = self.at(rubbed);
        let mut moment = Moment::seen(self.scene, rubbed.time, &rubbed.state, &here.situation);
        for (i, palm) in moment.palms.iter_mut().enumerate() {
            (palm.friction, palm.slip) = (here.friction[i], here.slips[i]);
        }
        moment.dissipated = rubbed.dissipated;
        moment
    }

    /// Why nothing is integrated any more, if the budget is spent.
    fn spent(&self) -> Option<String> {
        let spent = self.budget.steps(0).err()?;
        Some(format!("{spent} of the integrator: is its duration in seconds?"))
    }

    fn steps(&self, from: Rubbed, end: f64) -> (Vec<Rubbed>, Option<String>) {
        if let Some(why) = self.spent() {
            return (vec![from], Some(why));
        }
        let rates = |y: &Vector| {
            let now = Rubbed::of(from.time + y[8], y);
            let here = self.at(&now);
            let lost: f64 = (0..2).map(|i| -here.friction[i] * here.slips[i]).sum();
            let state = here.situation.rates(&now.state, &self.scene.drive);
            std::array::from_fn(|i| state.get(i).copied().unwrap_or(if i == 7 { lost } else { 1.0 }))
        };
        let start = std::array::from_fn(|i| match i {
            7 => from.dissipated,
            _ => from.state.get(i).copied().unwrap_or(0.0),
        });
        let longest = self.longest.min(end - from.time);
        let (all, failure) = own_steps(rates, start, [from.time, end], longest, self.scene.tolerance);
        // what is too much ends the next integration before it begins
        let _ = self.budget.steps(all.len());
        (all.iter().map(|(time, y)| Rubbed::of(*time, y)).collect(), failure)
    }

    /// What ends the modes at a state, if anything does.
    fn change(&self, at: &Rubbed) -> Option<Change> {
        let here = self.at(at);
        let breach = here.situation.breach(self.scene);
        let reversed = |i: usize| self.pair.0[i].sense() * here.slips[i] < -SEEN;
        let slipped = here.slack.is_some_and(|slack| slack.is_nan() || slack < -SEEN * here.largest);
        // without friction no mode is another than the rest
        let changed = self.coefficient > 0.0 && (reversed(0) || reversed(1) || slipped);
        match breach {
            // what a change of modes mends is none
            Some(breach) if !changed => Some(Change::Ends(Ended::by(breach, at.time))),
            _ => changed.then_some(Change::Modes),
        }
    }

    /// Goes on in its modes to a time, or as far as they hold, with what ended them; or part of the way, where it is far.
    fn advance(&self, from: Rubbed, end: f64) -> (Rubbed, Option<Change>) {
        let (all, failure) = self.steps(from, end.min(from.time + AHEAD * self.longest));
        let mut held = from;
        for step in all.into_iter().skip(1) {
            if let Some(first) = self.change(&step) {
                return self.locate(held, step.time, first);
            }
            held = step;
        }
        let why = failure.map(|why| Change::Ends(Ended::Failed { time: held.time, why }));
        (held, why)
    }

    /// Where the modes hold for the last time, by bisection, each state integrated from the last that held.
    fn locate(&self, mut low: Rubbed, mut high: f64, mut by: Change) -> (Rubbed, Option<Change>) {
        while high - low.time > LOCATED {
            let middle = low.time + (high - low.time) / 2.0;
            if middle <= low.time || middle >= high {
                break;
            }
            let (all, failure) = self.steps(low, middle);
            let Some(&state) = all.last().filter(|_| failure.is_none()) else { break };
            match self.change(&state) {
                None => low = Rubbed { time: middle, ..state },
                Some(found) => (high, by) = (middle, found),
            }
        }
        // where nothing is integrated any more the change is not found
        if let Some(why) = self.spent() {
            by = Change::Ends(Ended::Failed { time: low.time, why });
        }
        if let Change::Ends(Ended::ContactLost { time, .. } | Ended::OutOfPalm { time, .. }) = &mut by {
            *time = low.time;
        }
        (low, Some(by))
    }
}

const NONE_CONSISTENT: &str = "no way to slide, roll or stick is consistent with friction and contact (Painleve's paradox, or a contact \
                               that would have to pull)";

/// Moves the scene from time zero with Coulomb friction of one coefficient at both contacts, and reports its moments at the sample times,
/// which increase. The motion ends before the last of them where a contact does, or no modes are consistent; see [`Ended`].
///
/// # Errors
/// Where a value of the scene, the coefficient or a time cannot be used, a palm is curved, or no modes are consistent at the start.
pub fn simulate_with_friction(
    scene: &MovingScene,
    coefficient: f64,
    times: &[f64],
) -> Result<RubbedMotion, SceneError> {
    let last = checked_times(times)?;
    scene.check_values()?;
    let wrong =
        |what: &str, value: f64, wanted| Err(SceneError::Value { what: what.to_owned(), value, wanted });
    if !(coefficient >= 0.0 && coefficient.is_finite()) {
        return wrong("the coefficient of friction", coefficient, "finite and not negative");
    }
    for (i, palm) in scene.palms.iter().enumerate() {
        if let Palm::Circular { radius } = palm {
            return wrong(
                &format!("palm {}'s radius", i + 1),
                *radius,
                "infinite: friction knows flat palms",
            );
        }
    }
    let mut now = Rubbed { time: 0.0, state: scene.start(), dissipated: 0.0 };
    let sliding = ModePair([ContactMode::Along; 2]);
    let mut motion = Motion {
        scene,
        coefficient,
        pair: sliding,
        longest: scene.longest_step(last),
        budget: Budget::new(ALLOWANCE),
    };
    if let Some(breach) = motion.at(&now).situation.breach(scene).filter(|_| coefficient == 0.0) {
        return Err(SceneError::Start(breach));
    }
    let mut modes = Vec::new();
    // the pair of modes with which a state goes on
    let mut next = |motion: &mut Motion<'_>, at: &Rubbed, left: Option<ModePair>| {
        let others = consistent(scene, coefficient, at.time, &at.state, left);
        motion.pair = *others.first()?;
        modes.push((at.time, motion.pair));
        Some(())
    };
    next(&mut motion, &now, None).ok_or(SceneError::NoModes)?;
    let start_energy = motion.moment(&now).energy();
    let mut moments = Vec::with_capacity(times.len());
    let (mut ended, mut changes) = (Ended::Completed, 0);
    'samples: for &time in times {
        while now.time < time {
            let (reached, change) = motion.advance(now, time);
            now = reached;
            let failed = |why: &str| Ended::Failed { time: reached.time, why: why.to_owned() };
            match change {
                None => (),
                Some(Change::Modes) if changes < MOST_CHANGES => {
                    changes += 1;
                    let left = Some(motion.pair);
                    if next(&mut motion, &now, left).is_none() {
                        ended = failed(NONE_CONSISTENT);
                        break 'samples;
                    }
                }
                Some(Change::Modes) => {
                    ended = failed("the modes of friction change without end");
                    break 'samples;
                }
                Some(Change::Ends(end)) => {
                    ended = end;
                    break 'samples;
                }
            }
        }
        moments.push(motion.moment(&now));
    }
    let trajectory = Trajectory { moments, ended, start_energy, jumps: Vec::new() };
    Ok(RubbedMotion { trajectory, modes })
}
