//! A robot with two wheels on uneven ground (section 6.2 of the thesis), whose wheel 1 rolls at a constant speed.
//!
//! The ground is a sum of waves. Both wheels are points of a rigid body and lie on it, so that the body has one degree of freedom: where wheel 1 is.
//! Where it is at a time is an arc length; where wheel 2 is then, how the body stands, and all rates and accelerations follow from the two places by numbers
//! that carry two derivatives by time through the search for wheel 2. Newton's law for the centre of mass and that for the rotation are three linear equations for the motor's pull and both normal forces.
//! No rolling of wheel 2, no curvature and no equation 6.5 to 6.12 is in it: what the thesis says of them can be compared with it.
//!
//! Left out: wheels of a size, slipping, motions of which nobody holds wheel 1's speed. Where a wheel would have to be pulled to the ground the motion ends.

use nalgebra::{Matrix3, Vector3};
use num_dual::{Dual2, Dual2_64, DualNum};
use std::f64::consts::{PI, TAU};

/// A wave of the ground: `amplitude * sin(2 pi x / wavelength + phase)`, in m and rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundWave {
    /// In m.
    pub amplitude: f64,
    /// In m.
    pub wavelength: f64,
    /// In rad.
    pub phase: f64,
}

/// The height of the ground over the horizontal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ground {
    /// They are added.
    pub waves: Vec<GroundWave>,
}

impl Ground {
    /// The height in m, and its slope.
    pub fn at<D: DualNum<Primitive = f64> + Copy>(&self, x: D) -> (D, D) {
        let (mut height, mut slope) = (x * 0.0, x * 0.0);
        for wave in &self.waves {
            let number = TAU / wave.wavelength;
            let (sine, cosine) = (x * number + wave.phase).sin_cos();
            height += sine * wave.amplitude;
            slope += cosine * (wave.amplitude * number);
        }
        (height, slope)
    }

    /// How the slope changes, in 1/m.
    fn bend(&self, x: f64) -> f64 {
        let of = |wave: &GroundWave| {
            let number = TAU / wave.wavelength;
            -wave.amplitude * number * number * (x * number + wave.phase).sin()
        };
        self.waves.iter().map(of).sum()
    }

    /// The place so much farther along the ground than `x`, to rounding: by quadrature of G. Gauss with five points on pieces of a
    /// twentieth of the shortest wave.
    fn along(&self, x: f64, length: f64) -> f64 {
        const NODES: [f64; 5] = [
            0.0,
            -0.538_469_310_105_683_1,
            0.538_469_310_105_683_1,
            -0.906_179_845_938_664,
            0.906_179_845_938_664,
        ];
        const WEIGHTS: [f64; 5] = [
            0.568_888_888_888_888_9,
            0.478_628_670_499_366_47,
            0.478_628_670_499_366_47,
            0.236_926_885_056_189_08,
            0.236_926_885_056_189_08,
        ];
        let speed = |x: f64| self.at(x).1.hypot(1.0);
        let shortest = self.waves.iter().map(|wave| wave.wavelength).fold(f64::INFINITY, f64::min);
        let pieces = (20.0 * length.abs() / shortest).ceil().clamp(1.0, 1e6);
        let piece = length / pieces;
        let mut x = x;
        for _ in 0..pieces as usize {
            let mut step = piece / speed(x);
            for _ in 0..8 {
                let point = |(node, weight): (&f64, &f64)| weight * speed(x + 0.5 * step * (1.0 + node));
                let walked = 0.5 * step * NODES.iter().zip(&WEIGHTS).map(point).sum::<f64>();
                step -= (walked - piece) / speed(x + step);
            }
            x += step;
        }
        x
    }
}

/// The robot: two wheels that are points of a rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robot {
    /// Where wheels 1 and 2 are from the centre of mass, in the body's frame, in m.
    pub wheels: [[f64; 2]; 2],
    /// In kg.
    pub mass: f64,
    /// The radius of gyration about the centre of mass, in m.
    pub gyration: f64,
    /// The acceleration along the Y axis, in m/s^2.
    pub gravity: f64,
}

/// The robot at one time. SI units; the tangents point along the X axis, the normals up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotMoment {
    /// In s.
    pub time: f64,
    /// Of wheels 1 and 2.
    pub places: [[f64; 2]; 2],
    /// Of the centre of mass, its velocity and its acceleration.
    pub centre: [f64; 2],
    pub velocity: [f64; 2],
    pub acceleration: [f64; 2],
    /// The body's angle, its rate and its acceleration.
    pub phi0: f64,
    pub omega: f64,
    pub alpha: f64,
    /// The ground's angle with the X axis at the wheels, and how fast it changes there.
    pub inclinations: [f64; 2],
    pub turning: [f64; 2],
    /// How fast the wheels go along their tangents.
    pub speeds: [f64; 2],
    /// The motor's pull along tangent 1, and the normal forces at both wheels.
    pub forces: [f64; 3],
}

/// How a drive ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotEnd {
    /// At the last time.
    Completed,
    /// A wheel (0 or 1) would have to be pulled to the ground at this time.
    Lifts { time: f64, wheel: usize },
    /// Wheel 2 reaches no ground from where wheel 1 is at this time, or stands on a flank that it cannot pass.
    NoGround { time: f64 },
}

/// A drive, as far as it went.
#[derive(Clone, Debug)]
pub struct RobotDrive {
    /// At the times that were asked for.
    pub moments: Vec<RobotMoment>,
    /// Where and why it ended.
    pub end: RobotEnd,
}

impl Robot {
    /// Wheel 1 rolls from over `start` at this speed (negative: towards smaller `x`); times in s, from the first on.
    pub fn drive(&self, ground: &Ground, speed: f64, start: f64, times: &[f64]) -> RobotDrive {
        let mut moments = Vec::new();
        let mut x = start;
        let mut last = times.first().copied().unwrap_or(0.0);
        let mut ahead = self.wheels[1][0] - self.wheels[0][0];
        for &time in times {
            x = ground.along(x, speed * (time - last));
            last = time;
            let Some(moment) = self.moment(ground, speed, time, x, &mut ahead) else {
                return RobotDrive { moments, end: RobotEnd::NoGround { time } };
            };
            if let Some(wheel) = (0..2).find(|wheel| moment.forces[1 + wheel] <= 0.0) {
                return RobotDrive { moments, end: RobotEnd::Lifts { time, wheel } };
            }
            moments.push(moment);
        }
        RobotDrive { moments, end: RobotEnd::Completed }
    }

    /// With wheel 1 over `x`; wheel 2 is searched for near `ahead` of it, and `ahead` becomes what was found.
    fn moment(&self, ground: &Ground, speed: f64, time: f64, x: f64, ahead: &mut f64) -> Option<RobotMoment> {
        let slope = ground.at(x).1;
        let rate = speed / slope.hypot(1.0);
        // by time, from x'^2 (1 + slope^2) = speed^2
        let x1: Dual2_64 = Dual2::new(x, rate, -rate * rate * slope * ground.bend(x) / (1.0 + slope * slope));
        let (y1, _) = ground.at(x1);
        let [base_x, base_y] = [0, 1].map(|i| self.wheels[1][i] - self.wheels[0][i]);
        let length = base_x.hypot(base_y);
        let off = |x2: Dual2_64| {
            let (y2, slope) = ground.at(x2);
            let (dx, dy) = (x2 - x1, y2 - y1);
            (dx * dx + dy * dy - length * length, (dx + dy * slope) * 2.0)
        };
        let mut x2: Dual2_64 = Dual2::from_re(x + *ahead);
        for _ in 0..60 {
            let (value, slope) = off(x2);
            let step = value / slope;
            x2 -= step;
            // the derivatives settle two steps after the value
            let settled = [(step.re, length, 1e-15), (step.v1, x2.v1, 1e-14), (step.v2, x2.v2, 1e-13)];
            if settled.iter().all(|(step, size, part)| step.abs() <= part * (1.0 + size.abs())) {
                break;
            }
        }
        let (left, slope) = off(x2);
        let is_there = left.re.abs() < 1e-12 * length * length && slope.re * (x2.re - x) > 0.0;
        if !is_there || (x2.re - x) * *ahead <= 0.0 || !x2.v2.is_finite() {
            return None;
        }
        *ahead = x2.re - x;
        let (y2, _) = ground.at(x2);
        let mut phi0 = (y2 - y1).atan2(x2 - x1) - base_y.atan2(base_x);
        phi0 -= (phi0.re / TAU).round() * TAU;
        debug_assert!(phi0.re.abs() <= PI);
        let (sine, cosine) = phi0.sin_cos();
        let arm =
            |wheel: [f64; 2]| [cosine * wheel[0] - sine * wheel[1], sine * wheel[0] + cosine * wheel[1]];
        let [arm1, arm2] = self.wheels.map(arm);
        let centre = [x1 - arm1[0], y1 - arm1[1]];
        let inclined = [x1, x2].map(|x| ground.at(x).1.atan());
        let along = inclined.map(|angle| [angle.re.cos(), angle.re.sin()]);
        let acceleration = [centre[0].v2, centre[1].v2];
        let directions = [along[0], [-along[0][1], along[0][0]], [-along[1][1], along[1][0]]];
        let arms = [&arm1, &arm1, &arm2].map(|arm| [arm[0].re, arm[1].re]);
        let torque = |i: usize| arms[i][0] * directions[i][1] - arms[i][1] * directions[i][0];
        let laws = Matrix3::from_fn(|row, i| if row < 2 { directions[i][row] } else { torque(i) });
        let [ax, ay] = acceleration;
        let right = Vector3::new(ax, ay - self.gravity, self.gyration * self.gyration * phi0.v2) * self.mass;
        let forces = laws.lu().solve(&right).filter(|forces| forces.iter().all(|force| force.is_finite()))?;
        Some(RobotMoment {
            time,
            places: [[x1.re, y1.re], [x2.re, y2.re]],
            centre: centre.map(|axis| axis.re),
            velocity: centre.map(|axis| axis.v1),
            acceleration,
            phi0: phi0.re,
            omega: phi0.v1,
            alpha: phi0.v2,
            inclinations: inclined.map(|angle| angle.re),
            turning: inclined.map(|angle| angle.v1),
            speeds: [speed, x2.v1 * along[1][0] + y2.v1 * along[1][1]],
            forces: forces.into(),
        })
    }
}
