//! The integrals of the measurements that the laws need, at samples and between them.

use super::SolidMeasurements;
use super::rule::{POINTS, Piece, piece};
use super::surface::PalmSample;
use super::vector::{Vector, along, cross};

/// The integrals that determine the motion at a time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    /// Since the first sample.
    pub time: f64,
    /// The integrals of `F`, `t F`, `t^2 F`, of the moments about the origin, and of `S x F`.
    pub force: Vector,
    pub first: Vector,
    pub second: Vector,
    pub moment: Vector,
    pub moved: Vector,
}

impl Node {
    /// `S`: the double integral of the force.
    pub fn place(&self) -> Vector {
        let [x, y, z] = self.force.map(|value| value * self.time);
        [x - self.first[0], y - self.first[1], z - self.first[2]]
    }
}

/// The interval between two samples that are used: its length in s, and the nodes of the integrator, of which the last is the end.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub length: f64,
    pub nodes: [Node; 4],
}

/// The integrator's nodes as fractions of a step.
const PARTS: [f64; 4] = [1.0 / 3.0, 0.5, 2.0 / 3.0, 1.0];

/// The samples that are used, with all that follows from measurements alone.
#[derive(Clone, Debug)]
pub(super) struct Integrals {
    pub nodes: Vec<Node>,
    pub palms: Vec<[PalmSample; 3]>,
    pub steps: Vec<Step>,
    pub gravity: Vector,
}

/// The rules of integration for a choice of samples; they do not change where measurements are corrected.
pub(super) struct Rules {
    pub whole: Vec<Piece>,
    chosen: Vec<usize>,
    between: Vec<[Piece; 4]>,
    times: Vec<f64>,
}

impl Rules {
    /// For the samples at these places, which increase.
    pub fn of(times: &[f64], chosen: Vec<usize>) -> Rules {
        let start = times[0];
        let times: Vec<f64> = times.iter().map(|time| time - start).collect();
        let last = times.len() - 2;
        let whole = (0..=last).map(|k| piece(&times, k, times[k + 1])).collect();
        let between = chosen
            .windows(2)
            .map(|pair| {
                let (begin, end) = (times[pair[0]], times[pair[1]]);
                PARTS.map(|part| {
                    let t = if part == 1.0 { end } else { begin + part * (end - begin) };
                    let within = times[pair[0]..=pair[1]].partition_point(|time| *time < t);
                    piece(&times, (pair[0] + within.max(1) - 1).min(last), t)
                })
            })
            .collect();
        Rules { whole, chosen, between, times }
    }

    /// The time that each chosen sample represents.
    pub fn spacing(&self) -> Vec<f64> {
        let at = |k: usize| self.times[self.chosen[k]];
        let last = self.chosen.len() - 1;
        (0..=last).map(|k| (at((k + 1).min(last)) - at(k.saturating_sub(1))) / 2.0).collect()
    }

    /// The trapezoidal rule over each interval.
    pub fn trapezoids(&self) -> Vec<Piece> {
        let of = |(own, times): (&Piece, &[f64])| {
            let mut weights = [0.0; POINTS];
            weights[own.interval - own.first] = (times[1] - times[0]) / 2.0;
            weights[own.interval + 1 - own.first] = (times[1] - times[0]) / 2.0;
            Piece { weights, ..*own }
        };
        self.whole.iter().zip(self.times.windows(2)).map(of).collect()
    }
}

impl Integrals {
    pub fn of(measurements: &SolidMeasurements, rules: &Rules) -> Integrals {
        let samples: Vec<[PalmSample; 3]> =
            (0..measurements.rows()).map(|k| palms_at(measurements, k)).collect();
        let sums: Vec<[Vector; 2]> = samples
            .iter()
            .map(|palms| {
                palms.iter().fold([[0.0; 3]; 2], |[force, moment], palm| {
                    let lever = cross(&palm.contact, &palm.normal);
                    [along(&force, palm.force, &palm.normal), along(&moment, palm.force, &lever)]
                })
            })
            .collect();
        let times = &rules.times;
        let by_power = |power: i32| -> Vec<Vector> {
            times.iter().zip(&sums).map(|(t, [f, _])| f.map(|value| value * t.powi(power))).collect()
        };
        let powers = [by_power(0), by_power(1), by_power(2)];
        let moments: Vec<Vector> = sums.iter().map(|[_, moment]| *moment).collect();
        let total = |values: &[Vector]| -> Vec<Vector> {
            let mut sum = [0.0; 3];
            let mut all = vec![sum];
            for piece in &rules.whole {
                sum = along(&sum, 1.0, &piece.of(values));
                all.push(sum);
            }
            all
        };
        let [force, first, second] = [&powers[0], &powers[1], &powers[2]].map(|values| total(values));
        let moment = total(&moments);
        let mut nodes: Vec<Node> = (0..times.len())
            .map(|k| Node {
                time: times[k],
                force: force[k],
                first: first[k],
                second: second[k],
                moment: moment[k],
                moved: [0.0; 3],
            })
            .collect();
        let moving: Vec<Vector> = nodes.iter().zip(&powers[0]).map(|(n, f)| cross(&n.place(), f)).collect();
        for (node, moved) in nodes.iter_mut().zip(total(&moving)) {
            node.moved = moved;
        }
        let node_at = |piece: &Piece, time: f64| {
            let begin = &nodes[piece.interval];
            let after = |sum: &Vector, values: &[Vector]| along(sum, 1.0, &piece.of(values));
            Node {
                time,
                force: after(&begin.force, &powers[0]),
                first: after(&begin.first, &powers[1]),
                second: after(&begin.second, &powers[2]),
                moment: after(&begin.moment, &moments),
                moved: after(&begin.moved, &moving),
            }
        };
        let steps = rules.chosen.windows(2).zip(&rules.between).map(|(pair, pieces)| {
            let (begin, length) = (times[pair[0]], times[pair[1]] - times[pair[0]]);
            let nodes = std::array::from_fn(|i| node_at(&pieces[i], begin + PARTS[i] * length));
            Step { length, nodes }
        });
        Integrals {
            steps: steps.collect(),
            nodes: rules.chosen.iter().map(|k| nodes[*k]).collect(),
            palms: rules.chosen.iter().map(|k| samples[*k]).collect(),
            gravity: measurements.gravity.into(),
        }
    }
}

fn palms_at(measurements: &SolidMeasurements, row: usize) -> [PalmSample; 3] {
    std::array::from_fn(|i| PalmSample::of(measurements, row, i))
}
