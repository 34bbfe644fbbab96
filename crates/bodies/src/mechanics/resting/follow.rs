//! A resting body carried along by slow palms, through time.

use super::poses::descent;
use super::potential::{RestingContacts, contacts_at_rest, potential};
use crate::mechanics::moving::{
    Course, Drive, Ended, Jump, Moment, MovingScene, PalmMoment, SceneError, Trajectory, checked_times,
};
use crate::mechanics::palm::Palm;

/// The body is carried over at least so many steps: one that jumps and comes back within a step does not jump.
const FEWEST_STEPS: f64 = 1024.0;

/// Folds, and ends of contacts, are bisected to this part of the whole time.
const LOCATED: f64 = 1e-13;

/// In one step the body turns by no more than this, in radians: where it does, the step is halved.
const NEAR: f64 = 0.02;

/// A turn at a fold is a jump from here on, in radians; shorter ones cannot be distinguished from the quick motion at the fold.
const LEAST_JUMP: f64 = 1e-3;

/// Palms count as parallel where the sine of the angle between them is below this.
const PARALLEL: f64 = 1e-4;

/// A pose counts as stable where the potential is curved by more than this part of its value: less is rounding, as for a disc about its middle.
const LEAST_STIFFNESS: f64 = 1e-13;

/// Rates and accelerations are differences over this part of the whole time.
const DIFFERENCE: f64 = 1e-6;

/// A pose at a time.
#[derive(Clone, Copy, Debug)]
struct Posed {
    time: f64,
    phi0: f64,
}

struct Carried<'a> {
    scene: &'a MovingScene,
    courses: &'a [Course; 2],
    last: f64,
    now: Posed,
    jumps: Vec<Jump>,
}

/// Carries the scene's body from time zero and reports its moments at the sample times, which increase. The body lies in a stable pose at every moment: at first in the one
/// to which it falls from the scene's orientation, later in the one that it is led to; where that ends it jumps to the next one downhill. Inertia plays no part: forces and torques are
/// those that carry the weight, the kinetic energy is none, the scene's rate at the start does not matter, and what a jump loses in height is not work of the motors.
///
/// # Errors
/// Where a time or a value of the scene cannot be used, or there is no stable pose at the start: [`SceneError`].
pub fn follow_resting(scene: &MovingScene, times: &[f64]) -> Result<Trajectory, SceneError> {
    let last = checked_times(times)?;
    let Drive::Prescribed(courses) = &scene.drive else {
        return Err(SceneError::NotSlow("the palms' angles have to be given, not their torques"));
    };
    if scene.palms.iter().any(|palm| *palm != Palm::Flat) {
        return Err(SceneError::NotSlow("both palms have to be flat"));
    }
    if !(scene.gravity < 0.0 && scene.gravity.is_finite()) {
        let wanted = "negative: nothing rests where it is not pulled down";
        return Err(SceneError::Value { what: "gravity".into(), value: scene.gravity, wanted });
    }
    if !(scene.mass > 0.0 && scene.mass.is_finite()) {
        return Err(SceneError::Value {
            what: "the mass".into(),
            value: scene.mass,
            wanted: "positive and finite",
        });
    }
    let phi0 = scene.orientation;
    let now = Posed { time: 0.0, phi0 };
    let mut carried = Carried { scene, courses, last, now, jumps: Vec::new() };
    if let Some(ended) = carried.breach(now) {
        return Err(SceneError::NotSlow(match ended {
            Ended::PalmsParallel { .. } => {
                "the palms are parallel at the start, or the body is not between them"
            }
            Ended::ContactLost { palm: 1, .. } => {
                "palm 1 would have to pull at the start: phi1 + phi2 has to be between 0 and pi"
            }
            _ => "palm 2 would have to pull at the start: phi1 has to be between 0 and pi",
        }));
    }
    let none = SceneError::NotSlow(
        "no pose is stable at the start: the height of the centre of mass does not change with the turn",
    );
    let palms = carried.palms(0.0);
    let is_stiff = |phi0: f64| {
        let there = potential(&scene.shape, phi0, palms);
        there.hessian[0][0] > LEAST_STIFFNESS * there.value.abs()
    };
    carried.now.phi0 = descent(&scene.shape, palms, phi0)
        .filter(|found| found.phi0.is_finite() && is_stiff(found.phi0))
        .ok_or(none)?
        .phi0;
    let start = carried.energy(carried.now);
    let mut moments = Vec::with_capacity(times.len());
    let mut ended = carried.off_palm(carried.now);
    for &time in times {
        if ended.is_none() {
            ended = carried.advance(time);
        }
        if ended.is_some() {
            break;
        }
        moments.push(carried.moment(start));
    }
    Ok(Trajectory {
        moments,
        ended: ended.unwrap_or(Ended::Completed),
        start_energy: start,
        jumps: carried.jumps,
    })
}

impl Carried<'_> {
    fn palms(&self, time: f64) -> [f64; 2] {
        [0, 1].map(|i: usize| self.courses[i].at(time)[0])
    }

    fn contacts(&self, at: Posed) -> RestingContacts {
        contacts_at_rest(&self.scene.shape, at.phi0, self.palms(at.time))
    }

    fn energy(&self, at: Posed) -> f64 {
        -self.scene.mass * self.scene.gravity * self.contacts(at).centre[1]
    }

    /// What ends the contacts at any pose.
    fn breach(&self, at: Posed) -> Option<Ended> {
        let ([phi1, phi2], time) = (self.palms(at.time), at.time);
        let positive = |x: f64| x > 0.0;
        if !positive(phi2.sin() - PARALLEL) {
            return Some(Ended::PalmsParallel { time });
        }
        let palm = [(phi1 + phi2).sin(), phi1.sin()].into_iter().position(|force| !positive(force))? + 1;
        Some(Ended::ContactLost { palm, time })
    }

    /// A contact that is beyond its palm's end.
    fn off_palm(&self, at: Posed) -> Option<Ended> {
        let s = self.contacts(at).s;
        let palm = (0..2).find(|&i| s[i] > self.scene.palm_lengths[i])? + 1;
        Some(Ended::OutOfPalm { palm, time: at.time })
    }

    /// Carries the body to a time; says what ended it before.
    fn advance(&mut self, end: f64) -> Option<Ended> {
        let (longest, shortest) = (self.last / FEWEST_STEPS, self.last * LOCATED);
        let mut step = longest;
        while self.now.time < end {
            let time = (self.now.time + step).min(end);
            // a time that does not advance any more is where it stands
            let is_least = time - self.now.time <= shortest || time <= self.now.time;
            let reached = self.breach(Posed { time, ..self.now }).map_or_else(|| self.lowered(time), Err);
            let reached = reached.and_then(|(at, smooth)| match self.off_palm(at) {
                Some(ended) if smooth => Err(ended),
                _ => Ok((at, smooth)),
            });
            match reached {
                Ok((at, smooth)) if smooth || is_least => {
                    if !smooth && (at.phi0 - self.now.phi0).abs() >= LEAST_JUMP {
                        self.jump(at);
                    }
                    self.now = at;
                    let landed_off = if smooth { None } else { self.off_palm(at) };
                    if landed_off.is_some() {
                        return landed_off;
                    }
                    step = (2.0 * step).clamp(2.0 * shortest, longest);
                }
                Err(ended) if is_least => return Some(ended),
                Ok(_) | Err(_) => step = (time - self.now.time) / 2.0,
            }
        }
        None
    }

    fn jump(&mut self, to: Posed) {
        let weight = -self.scene.mass * self.scene.gravity;
        let drop = (self.energy(self.now) - self.energy(to)) / weight;
        let palms = self.palms(to.time);
        self.jumps.push(Jump { time: to.time, palms, from: self.now.phi0, to: to.phi0, drop });
    }

    /// The pose at a later time to which the present one is led downhill, and whether this is the same minimum, moved a little.
    fn lowered(&self, time: f64) -> Result<(Posed, bool), Ended> {
        let why =
            || Ended::Failed { time, why: "there is no way down: the body has no stable pose".to_owned() };
        let found = descent(&self.scene.shape, self.palms(time), self.now.phi0).ok_or_else(why)?;
        if !found.phi0.is_finite() {
            return Err(why());
        }
        let smooth = found.convex && (found.phi0 - self.now.phi0).abs() <= NEAR;
        Ok((Posed { time, phi0: found.phi0 }, smooth))
    }

    /// The rate at which an equilibrium follows the palms.
    fn rate(&self, at: Posed) -> f64 {
        let follows = potential(&self.scene.shape, at.phi0, self.palms(at.time)).following();
        (0..2).map(|i| follows[i] * self.courses[i].at(at.time)[1]).sum()
    }

    fn moment(&self, start: f64) -> Moment {
        let (at, scene) = (self.now, self.scene);
        let here = self.contacts(at);
        let apart = self.last * DIFFERENCE;
        // near a fold one of the two may have fallen: then the rates are those of the side that has not
        let beside = [-apart, apart].map(|by| {
            let time = at.time + by;
            let found = descent(&scene.shape, self.palms(time), at.phi0).filter(|found| found.convex);
            Posed { time, phi0: found.map_or(at.phi0, |found| found.phi0) }
        });
        let difference = |of: &dyn Fn(Posed) -> f64| (of(beside[1]) - of(beside[0])) / (2.0 * apart);
        let weight = -scene.mass * scene.gravity;
        let courses = [0, 1].map(|i: usize| self.courses[i].at(at.time));
        let palm = |i: usize| PalmMoment {
            angle: courses[i][0],
            rate: courses[i][1],
            acceleration: courses[i][2],
            s: here.s[i],
            r: here.r[i],
            d: here.d[i],
            force: weight * here.forces[i],
            torque: weight * here.forces[i] * if i == 0 { here.s[0] } else { -here.s[1] },
            friction: 0.0,
            slip: 0.0,
        };
        let potential = weight * here.centre[1];
        let lost: f64 = self.jumps.iter().map(|jump| weight * jump.drop).sum();
        Moment {
            time: at.time,
            phi0: at.phi0,
            omega0: self.rate(at),
            alpha0: difference(&|at| self.rate(at)),
            centre: here.centre,
            velocity: [0, 1].map(|k: usize| difference(&|at| self.contacts(at).centre[k])),
            palms: [palm(0), palm(1)],
            kinetic: 0.0,
            potential,
            work: potential - start + lost,
            dissipated: 0.0,
        }
    }
}
