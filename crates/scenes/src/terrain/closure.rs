//! Closure: wheel 2 rolls over the ground that wheel 1 has drawn.
//!
//! That ties present measurements to past ones, by a delay that depends on the motion itself, and is in no finite set of Lie derivatives. So its rank is *computed*: all measurements of the
//! record drive the motion from the unknowns at its start, each equation that they have to satisfy is differentiated by the unknowns at the true ones, and the
//! singular values of all these rows are counted, once without the rows of the closure and once with them. It holds for this drive, and proves nothing of others.
//!
//! Where forces are measured, the equations are that neither wheel moves along the ground's normal. Where angles alone are measured these give how fast the robot turns for
//! its speed, which is taken to be constant (as the thesis has it), and nothing more.

use super::closure_rank::ComputedRank;
use super::{SimulatedRobot, drive, turned_back};
use nalgebra::SVector;
use num_dual::{Derivative, DualNum, DualSVec64};
use palmistry_bodies::mechanics::terrain::RobotMoment;

/// The most intervals of time whose ends are samples of the closure.
const INTERVALS: usize = 240;

/// A step of the integration is no longer than this fraction of the distance between the wheels.
const STEP: f64 = 0.02;

/// The track of wheel 1 between its samples is a polynomial through this many of them.
const NODES: usize = 8;

/// The unknowns where forces and angles are measured: velocity in the robot's frame, rate, attitude; `1/m` and the square of the radius of gyration; the place; and the rods.
const BY_FORCES: [&str; 12] =
    ["ux", "uy", "omega", "phi0", "one_over_m", "rho2", "x", "y", "l1", "h1", "l2", "h2"];

/// The unknowns where angles alone are measured: the speed of wheel 1, attitude, place; the distance from wheel to wheel and its direction in the robot's frame.
const BY_ANGLES: [&str; 6] = ["v1", "phi0", "x", "y", "base", "lean"];

/// The measurements, the unknowns and the ranks.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureSetting {
    /// The measurements, as text.
    pub read: &'static str,
    /// The names of the unknowns.
    pub unknowns: Vec<&'static str>,
    /// Without the closure.
    pub without: ComputedRank,
    /// With it.
    pub with: ComputedRank,
}

impl ClosureSetting {
    /// The unknowns that are observable with the closure, and not without it.
    pub fn gained(&self) -> Vec<&'static str> {
        let gained = |place: &usize| self.with.observable[*place] && !self.without.observable[*place];
        (0..self.unknowns.len()).filter(gained).map(|place| self.unknowns[place]).collect()
    }

    /// The unknowns that are unobservable with the closure.
    pub fn unobservable(&self) -> Vec<&'static str> {
        let left = |place: &usize| !self.with.observable[*place];
        (0..self.unknowns.len()).filter(left).map(|place| self.unknowns[place]).collect()
    }
}

/// The effect of the closure of a drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Closure {
    /// The time from which on wheel 2 is where wheel 1 has been, in s: none where it never is.
    pub from: Option<f64>,
    /// The number of samples that it constrains, and of all samples.
    pub samples: [usize; 2],
    /// The ranks for each set of measurements.
    pub settings: Vec<ClosureSetting>,
}

/// The drive at all times at which the integration uses the measurements.
struct Looked {
    moments: Vec<RobotMoment>,
    /// The number of moments from one sample to the next.
    stride: usize,
}

impl Looked {
    fn of(simulated: &SimulatedRobot, times: &[f64]) -> Looked {
        let thinned = times.len().saturating_sub(1).div_ceil(INTERVALS).max(1);
        let samples: Vec<f64> = times.iter().copied().step_by(thinned).collect();
        let longest = samples.windows(2).map(|ends| ends[1] - ends[0]).fold(0.0, f64::max);
        let [[l1, h1], [l2, h2]] = simulated.robot.wheels;
        let way = longest * simulated.robot.speed.abs() / (l2 - l1).hypot(h2 - h1);
        // a step of Runge and Kutta has a start, a middle and an end
        let stride = 2 * ((way / STEP).ceil().clamp(1.0, 1e3) as usize);
        let between = samples.windows(2).flat_map(|ends| {
            (0..stride).map(move |part| ends[0] + (ends[1] - ends[0]) * part as f64 / stride as f64)
        });
        let all: Vec<f64> = between.chain(samples.last().copied()).collect();
        let moments = drive(simulated, &all).moments;
        Looked { moments, stride }
    }

    fn samples(&self) -> impl Iterator<Item = &RobotMoment> {
        self.moments.iter().step_by(self.stride)
    }

    /// The states at all samples, by Runge and Kutta's method of fourth order.
    fn follow<D: DualNum<Primitive = f64> + Copy, const N: usize>(
        &self,
        start: [D; N],
        law: impl Fn(&[D; N], &RobotMoment) -> [D; N],
    ) -> Vec<[D; N]> {
        let mut state = start;
        let mut states = vec![state];
        for (number, at) in self.moments.windows(3).step_by(2).enumerate() {
            let step = at[2].time - at[0].time;
            let moved =
                |rates: &[D; N], part: f64| std::array::from_fn(|i| state[i] + rates[i] * (part * step));
            let first = law(&state, &at[0]);
            let second = law(&moved(&first, 0.5), &at[1]);
            let third = law(&moved(&second, 0.5), &at[1]);
            let fourth = law(&moved(&third, 1.0), &at[2]);
            state = std::array::from_fn(|i| {
                state[i] + (first[i] + (second[i] + third[i]) * 2.0 + fourth[i]) * (step / 6.0)
            });
            if (2 * number + 2) % self.stride == 0 {
                states.push(state);
            }
        }
        states
    }
}

/// The height of the track of wheel 1 until now above wheel 2; none where it has drawn nothing there.
fn gap<D: DualNum<Primitive = f64> + Copy>(drawn: &[[D; 2]], wheel: [D; 2], direction: f64) -> Option<D> {
    let along = |place: &[D; 2]| direction * place[0].re();
    let (first, last) = (drawn.first()?, drawn.last()?);
    let is_between = along(first) <= along(&wheel) && along(&wheel) <= along(last);
    if !is_between || drawn.len() < NODES {
        return None;
    }
    let next = drawn.partition_point(|place| along(place) <= along(&wheel));
    let begin = next.saturating_sub(NODES / 2).min(drawn.len() - NODES);
    let nodes = &drawn[begin..begin + NODES];
    let mut height = wheel[0] * 0.0;
    for (i, [x, y]) in nodes.iter().enumerate() {
        let mut weight = *y;
        for (_, [other, _]) in nodes.iter().enumerate().filter(|(j, _)| *j != i) {
            weight = weight * (wheel[0] - *other) / (*x - *other);
        }
        height += weight;
    }
    Some(height - wheel[1])
}

/// Rows of derivatives, and which samples are on drawn ground.
struct Rows {
    own: Vec<Vec<f64>>,
    closing: Vec<Vec<f64>>,
    closed: Vec<f64>,
}

/// Numbers as unknowns of the derivatives.
fn unknowns<const N: usize>(values: [f64; N]) -> [DualSVec64<N>; N] {
    std::array::from_fn(|i| {
        let slopes = SVector::from_fn(|j, _| if i == j { 1.0 } else { 0.0 });
        DualSVec64::new(values[i], Derivative::some(slopes))
    })
}

fn row<const N: usize>(value: &DualSVec64<N>) -> Vec<f64> {
    value.eps.0.map_or_else(|| vec![0.0; N], |slopes| slopes.iter().copied().collect())
}

/// Both wheels sample by sample, and the closure equations of the second one with the track of the first.
fn closing<const N: usize>(
    looked: &Looked,
    wheels: &[[[DualSVec64<N>; 2]; 2]],
    direction: f64,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let track: Vec<[DualSVec64<N>; 2]> = wheels.iter().map(|pair| pair[0]).collect();
    let met = wheels.iter().zip(looked.samples()).enumerate();
    let met = met.filter_map(|(i, (pair, at))| Some((row(&gap(&track[..=i], pair[1], direction)?), at.time)));
    met.unzip()
}

/// `[l, h]` of the robot's frame in the world.
fn world<D: DualNum<Primitive = f64> + Copy>(angle: D, [l, h]: [D; 2]) -> [D; 2] {
    let (sine, cosine) = angle.sin_cos();
    [cosine * l - sine * h, sine * l + cosine * h]
}

/// The measured angles at a moment: both angles of the ground against the robot.
fn angles(at: &RobotMoment) -> [f64; 2] {
    at.inclinations.map(|inclination| inclination - at.phi0)
}

fn by_forces(looked: &Looked, simulated: &SimulatedRobot, direction: f64) -> Option<Rows> {
    let first = looked.moments.first()?;
    let robot = &simulated.robot;
    let [ux, uy] = turned_back(first, first.velocity);
    let [[l1, h1], [l2, h2]] = robot.wheels;
    let rho2 = robot.radius_of_gyration.powi(2);
    let [x, y] = first.centre;
    let values = [ux, uy, first.omega, first.phi0, 1.0 / robot.mass, rho2, x, y, l1, h1, l2, h2];
    let [ux, uy, omega, phi0, one_over_m, rho2, x, y, l1, h1, l2, h2] = unknowns(values);
    let law = |state: &[DualSVec64<12>; 6], at: &RobotMoment| {
        let [ux, uy, omega, phi0, ..] = *state;
        let [[s1, c1], [s2, c2]] = angles(at).map(|angle| [angle.sin(), angle.cos()]);
        let [f0, f1, f2] = at.forces;
        let (fx, fy) = (f0 * c1 - f1 * s1, f0 * s1 + f1 * c1);
        let (gx, gy) = (-f2 * s2, f2 * c2);
        let torque = l1 * fy - h1 * fx + l2 * gy - h2 * gx;
        let (sine, cosine) = phi0.sin_cos();
        let [vx, vy] = world(phi0, [ux, uy]);
        [
            one_over_m * (fx + gx) + sine * robot.gravity + omega * uy,
            one_over_m * (fy + gy) + cosine * robot.gravity - omega * ux,
            one_over_m / rho2 * torque,
            omega,
            vx,
            vy,
        ]
    };
    let states = looked.follow([ux, uy, omega, phi0, x, y], law);
    let mut own = Vec::new();
    let mut wheels = Vec::new();
    for ([ux, uy, omega, phi0, x, y], at) in states.iter().zip(looked.samples()) {
        for ([l, h], angle) in [[l1, h1], [l2, h2]].into_iter().zip(angles(at)) {
            let (sine, cosine) = angle.sin_cos();
            own.push(row(&((*uy + *omega * l) * cosine - (*ux - *omega * h) * sine)));
        }
        wheels.push([[l1, h1], [l2, h2]].map(|arm| {
            let [right, up] = world(*phi0, arm);
            [*x + right, *y + up]
        }));
    }
    let (closing, closed) = closing(looked, &wheels, direction);
    Some(Rows { own, closing, closed })
}

fn by_angles(looked: &Looked, simulated: &SimulatedRobot, direction: f64) -> Option<Rows> {
    let first = looked.moments.first()?;
    let [[l1, h1], [l2, h2]] = simulated.robot.wheels;
    let (right, up) = (l2 - l1, h2 - h1);
    let [x, y] = first.places[0];
    let values = [simulated.robot.speed, first.phi0, x, y, right.hypot(up), up.atan2(right)];
    let [v1, phi0, x, y, base, lean] = unknowns(values);
    let base = [base * lean.cos(), base * lean.sin()];
    let law = |state: &[DualSVec64<6>; 3], at: &RobotMoment| {
        let [angle1, angle2] = angles(at);
        let (sine, cosine) = angle2.sin_cos();
        let heading = state[0] + angle1;
        let omega = v1 * (angle2 - angle1).sin() / (base[0] * cosine + base[1] * sine);
        [omega, v1 * heading.cos(), v1 * heading.sin()]
    };
    let states = looked.follow([phi0, x, y], law);
    let wheels = states.iter().map(|[phi0, x, y]| {
        let [right, up] = world(*phi0, base);
        [[*x, *y], [*x + right, *y + up]]
    });
    let wheels: Vec<_> = wheels.collect();
    let (closing, closed) = closing(looked, &wheels, direction);
    Some(Rows { own: Vec::new(), closing, closed })
}

fn setting(read: &'static str, all: &[&'static str], rows: &Rows, sought: usize) -> ClosureSetting {
    let part =
        |rows: &[Vec<f64>]| -> Vec<Vec<f64>> { rows.iter().map(|row| row[..sought].to_vec()).collect() };
    let mut together = part(&rows.own);
    let without = ComputedRank::of(&together, sought);
    together.extend(part(&rows.closing));
    let with = ComputedRank::of(&together, sought);
    ClosureSetting { read, unknowns: all[..sought].to_vec(), without, with }
}

impl Closure {
    /// For the drive of a robot that is measured at these times; none where it has no motion.
    pub(crate) fn of(simulated: &SimulatedRobot, times: &[f64]) -> Option<Closure> {
        let looked = Looked::of(simulated, times);
        let direction = simulated.robot.speed.signum();
        let forces = by_forces(&looked, simulated, direction)?;
        let angles = by_angles(&looked, simulated, direction)?;
        let settings = vec![
            setting("forces and angles; rods known", &BY_FORCES, &forces, 8),
            setting("forces and angles; rods unknown", &BY_FORCES, &forces, 12),
            setting("angles alone; rods known", &BY_ANGLES, &angles, 4),
            setting("angles alone; rods unknown", &BY_ANGLES, &angles, 6),
        ];
        let samples = [forces.closed.len(), looked.samples().count()];
        Some(Closure { from: forces.closed.first().copied(), samples, settings })
    }
}
