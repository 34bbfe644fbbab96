//! The outline that recovered states draw: the contacts, sample by sample, in the frame of the body.
//!
//! This is geometry of two palms about the origin, flat or circular; what is true comes only from the simulation.

use crate::experiment::{Answer, Experiment, Method};
use crate::mechanics::Palm;
use crate::mechanics::moving::Shape;
use crate::number::rational_to_f64;
use crate::report::motion::answers::Observed;
use std::f64::consts::TAU;

/// The palms, and what was recovered between them, at one sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instant {
    /// In s.
    pub time: f64,
    /// Directions of the palms in the world, in rad; at the joint.
    pub palms: [f64; 2],
    /// The contacts by what is read: along the palms from the joint, in m.
    pub sensed: [f64; 2],
    /// The contacts in the world, as they are read, in m.
    pub contacts: [[f64; 2]; 2],
    /// The recovered centre of mass in the world, in m.
    pub centre: [f64; 2],
    /// The recovered orientation, in rad.
    pub orientation: f64,
    /// The recovered points of the outline in the frame of the body, in m.
    pub points: [[f64; 2]; 2],
    /// Whether the observer compared its belief with readings here, and did not hold or integrate blindly.
    pub seen: bool,
}

/// What one observer recovered of the outline.
pub(super) struct Outline {
    pub method: Method,
    /// The palms' forms.
    pub forms: [Palm<f64>; 2],
    pub instants: Vec<Instant>,
}

/// The answer whose outline is shown: of the first method by windows, else of the first.
pub(super) fn shown<'a>(observed: &Observed<'a>) -> Option<&'a Answer> {
    let by_windows = |answer: &&Answer| !answer.track.updates.is_empty();
    observed.answers.iter().find(by_windows).or(observed.answers.first())
}

/// The value of a state or constant at a sample, from the readings or from what is told.
fn told(experiment: &Experiment, name: &str, row: usize) -> Option<f64> {
    let signals = &experiment.signals;
    if let Some(place) = signals.find(name) {
        return signals.column(place).get(row).copied();
    }
    experiment.question.known.get(name).copied().or_else(|| {
        let symbol = experiment.system.find_symbol(name)?;
        let info = experiment.system.symbols().find(|(other, _)| *other == symbol)?.1;
        info.default.as_ref().map(rational_to_f64)
    })
}

/// The outline by the best of the answers. None where the model is not one of two palms, or `r1` and `r2` were not sought.
///
/// The contacts as seen from the centre of mass are `R x_i = -(r_i n_i + d_i t_i)`, with `d_i` by 3.18 and 3.19 from the recovered
/// `r_i` and the `s_i` that are read; on curved palms the `r_i` place the centre of mass, and it the contacts. They are turned back by the orientation, the integral of the recovered `omega0` by the
/// trapezoidal rule; it starts at the true one where that is known, and at zero otherwise.
pub(super) fn outline(observed: &Observed<'_>) -> Option<Outline> {
    let experiment = observed.experiment;
    let flat = |name: &str| experiment.system.outputs.iter().any(|(output, _)| output == name);
    if !(flat("s1") && flat("s2")) {
        return None;
    }
    let answer = shown(observed)?;
    let names = experiment.names();
    let place = |name: &str| names.iter().position(|other| *other == name);
    let (first, second) = (place("r1")?, place("r2")?);
    let times = experiment.signals.times();
    let start = experiment.simulation.as_ref().and_then(|s| s.trajectory.moments.first());
    let mut orientation = start.map_or(0.0, |moment| moment.phi0);
    let mut before: Option<(f64, f64)> = None;
    let forms = forms(experiment);
    let mut instants = Vec::new();
    for moment in &answer.track.estimates {
        let row = times.partition_point(|time| *time < moment.time);
        let of = |name: &str| match place(name) {
            Some(place) => Some(moment.state[place]),
            None => told(experiment, name, row),
        };
        let rate = of("omega0")?;
        if let Some((time, last)) = before {
            orientation += (moment.time - time) * (rate + last) / 2.0;
        }
        before = Some((moment.time, rate));
        let (r, s) = ([moment.state[first], moment.state[second]], [of("s1")?, of("s2")?]);
        let (phi1, phi2) = (of("phi1")?, of("phi2")?);
        let palms = [phi1, phi1 + phi2];
        let Seen { contacts, arms } = match forms {
            [Palm::Flat, Palm::Flat] => between_flat(phi2, palms, r, s),
            _ => between_curved(&forms, palms, r, s),
        };
        instants.push(Instant {
            time: moment.time,
            palms,
            sensed: s,
            contacts,
            centre: [contacts[0][0] - arms[0][0], contacts[0][1] - arms[0][1]],
            orientation,
            points: arms.map(|arm| turned(arm, -orientation)),
            seen: answer.track.updates.is_empty() || !moment.residual.is_empty(),
        });
    }
    (!instants.is_empty()).then_some(Outline { method: answer.method, forms, instants })
}

/// The contacts, from the joint and from the centre of mass, in the world.
struct Seen {
    contacts: [[f64; 2]; 2],
    arms: [[f64; 2]; 2],
}

/// The forms of the palms: those of the scene; of a recording those that the model is told.
fn forms(experiment: &Experiment) -> [Palm<f64>; 2] {
    if experiment.simulation.is_some() {
        return experiment.scene.palm_forms;
    }
    ["b1", "b2"].map(|name| match told(experiment, name, 0) {
        Some(radius) if radius.is_finite() && radius != 0.0 => Palm::Circular { radius },
        _ => Palm::Flat,
    })
}

fn between_flat(phi2: f64, palms: [f64; 2], r: [f64; 2], s: [f64; 2]) -> Seen {
    let (sine, cosine) = phi2.sin_cos();
    let d = [(r[0] * cosine + r[1]) / sine - s[0], -(r[1] * cosine + r[0]) / sine + s[1]];
    // t2 points towards the origin, so that n2 points to the body as n1 does
    let along = [unit(palms[0]), unit(palms[1]).map(|x| -x)];
    let arm = |i: usize| -> [f64; 2] {
        let t = along[i];
        let n = [-t[1], t[0]];
        [-(r[i] * n[0] + d[i] * t[0]), -(r[i] * n[1] + d[i] * t[1])]
    };
    let contacts = [unit(palms[0]).map(|x| x * s[0]), unit(palms[1]).map(|x| x * s[1])];
    Seen { contacts, arms: [arm(0), arm(1)] }
}

/// The centre of mass is `r_i` from the tangent at each contact.
fn between_curved(forms: &[Palm<f64>; 2], palms: [f64; 2], r: [f64; 2], s: [f64; 2]) -> Seen {
    let contacts = [0, 1].map(|i: usize| on_palm(&forms[i], i, palms[i], s[i]));
    let normals = [0, 1].map(|i: usize| world(i, palms[i], forms[i].at(&s[i]).normal));
    let heights =
        [0, 1].map(|i: usize| r[i] + normals[i][0] * contacts[i][0] + normals[i][1] * contacts[i][1]);
    let [[a, b], [c, d]] = normals;
    let sine = a * d - b * c;
    let centre = [(heights[0] * d - heights[1] * b) / sine, (a * heights[1] - c * heights[0]) / sine];
    Seen { contacts, arms: contacts.map(|place| [place[0] - centre[0], place[1] - centre[1]]) }
}

/// A vector in the frame of a palm (0 or 1) at an angle, in the world.
fn world(palm: usize, angle: f64, [ahead, across]: [f64; 2]) -> [f64; 2] {
    let [c, s] = unit(angle);
    let across = if palm == 0 { across } else { -across };
    [ahead * c - across * s, ahead * s + across * c]
}

/// The point of a palm (0 or 1) at an angle, so far along it, in the world.
pub(super) fn on_palm(form: &Palm<f64>, palm: usize, angle: f64, s: f64) -> [f64; 2] {
    world(palm, angle, form.at(&s).place)
}

impl Outline {
    /// The largest distance of a recovered point from the true outline, and the root of their mean square, in m; over the
    /// samples at which the observer could see; none where there is no such sample.
    pub fn departure(&self, shape: &Shape) -> Option<(f64, f64)> {
        let points = self.instants.iter().filter(|instant| instant.seen).flat_map(|instant| instant.points);
        let distances: Vec<f64> = points.map(|point| distance(shape, point)).collect();
        let square: f64 = distances.iter().map(|distance| distance * distance).sum();
        let largest = distances.iter().copied().fold(0.0, f64::max);
        (!distances.is_empty()).then(|| (largest, (square / distances.len() as f64).sqrt()))
    }
}

/// The distance of a point from the outline of a convex body: the greatest value of `x · u - h` over all directions, without its
/// sign; the direction is found on a grid and then by Newton's method.
fn distance(shape: &Shape, point: [f64; 2]) -> f64 {
    let beyond = |angle: f64| {
        let ([h, slope, second], [c, s]) = (shape.support(angle), unit(angle));
        let (out, across) = (point[0] * c + point[1] * s, point[1] * c - point[0] * s);
        [out - h, across - slope, -out - second]
    };
    const GRID: usize = 360;
    let grid = (0..GRID).map(|i| TAU * i as f64 / GRID as f64);
    let Some(mut angle) = grid.max_by(|a, b| beyond(*a)[0].total_cmp(&beyond(*b)[0])) else {
        return f64::INFINITY;
    };
    let mut best = beyond(angle)[0];
    for _ in 0..4 {
        let [_, slope, curvature] = beyond(angle);
        if curvature < 0.0 {
            angle -= (slope / curvature).clamp(-TAU / GRID as f64, TAU / GRID as f64);
        }
        best = best.max(beyond(angle)[0]);
    }
    best.abs()
}

fn unit(angle: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [cosine, sine]
}

/// A vector, turned counterclockwise by an angle in rad.
pub(super) fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let [c, s] = unit(angle);
    [c * x - s * y, s * x + c * y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::moving::{BodyForm, CentreOfMass};

    /// A disc of radius 2 about its centre: the distance of a point is that of its radius from 2, inside and outside.
    #[test]
    fn the_distance_from_a_disc_is_known() {
        let form = BodyForm::Harmonics { mean: 2.0, harmonics: Vec::new() };
        let disc = Shape::new(&form, CentreOfMass::Uniform).unwrap();
        assert!((distance(&disc, [3.0, 4.0]) - 3.0).abs() < 1e-14);
        assert!((distance(&disc, [0.3, -0.4]) - 1.5).abs() < 1e-14);
    }

    /// A point of the boundary moved out along its normal by a known length, on a body that is no disc.
    #[test]
    fn a_point_moved_along_its_normal_is_that_far() {
        let form = BodyForm::Harmonics { mean: 1.0, harmonics: vec![[0.0, 0.0], [0.08, 0.03]] };
        let shape = Shape::new(&form, CentreOfMass::Uniform).unwrap();
        for i in 0..50 {
            let angle = 0.1 + f64::from(i);
            let ([x, y], [c, s]) = (shape.point(angle), unit(angle));
            for moved in [1e-6, 0.2, -1e-6] {
                let found = distance(&shape, [x + moved * c, y + moved * s]);
                assert!((found - moved.abs()).abs() < 1e-14, "{angle}: {found} for {moved}");
            }
        }
    }
}
