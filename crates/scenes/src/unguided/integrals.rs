//! The integrals of the measurements that the constraint needs.

use super::PalmMeasurements;

/// One palm at one sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PalmSample {
    /// The normal towards the body.
    pub normal: [f64; 2],
    /// `c_i x n_i`, the lever of the contact force about the hinge.
    pub lever: f64,
    /// `c_i . n_i`, zero of a flat palm.
    pub height: f64,
    pub rate: f64,
    /// By how much the normal turns in a metre of contact, counterclockwise; and which way the contact goes round the body, 1 or -1.
    pub bend: f64,
    pub side: f64,
    /// The tangent away from the hinge, the contact, and how fast the palm's own point there moves along the tangent.
    pub tangent: [f64; 2],
    pub contact: [f64; 2],
    pub own: f64,
    /// The derivative of the lever by the contact's place.
    pub lever_slope: f64,
    /// The contact force, along the normal.
    pub force: f64,
}

/// The quantities of the constraint at one sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sample {
    /// Since the first sample.
    pub time: f64,
    pub palms: [PalmSample; 2],
    /// `P` and its rate.
    pub place: [f64; 2],
    pub velocity: [f64; 2],
    pub a: [f64; 2],
    pub b: [f64; 2],
    pub c: f64,
}

/// All samples of a window, and its scales.
pub(super) struct Integrals {
    pub samples: Vec<Sample>,
    pub mass: f64,
    /// The logarithm of `k`, where the radius of gyration is known.
    pub log_k: Option<f64>,
    /// The standard deviation of a contact, where it is known.
    pub sigma: Option<f64>,
    /// A length of the size of the contacts'.
    pub length: f64,
    /// A rate above the likely ones of the body.
    pub rate: f64,
    /// An angular acceleration above the likely ones of the body.
    pub slope: f64,
}

/// Over every interval between two samples, the integrals of Lagrange's polynomials through four neighbours.
struct Rule {
    first: Vec<usize>,
    weights: Vec<[f64; 4]>,
}

impl Rule {
    /// Gauss's rule with two nodes has no error for polynomials of the third degree.
    fn of(times: &[f64]) -> Rule {
        let last = times.len() - 4;
        let first: Vec<usize> = (0..times.len() - 1).map(|i| i.saturating_sub(1).min(last)).collect();
        let mut weights: Vec<[f64; 4]> = Vec::with_capacity(first.len());
        for (i, first_node) in first.iter().enumerate() {
            let nodes = &times[*first_node..first_node + 4];
            if i > 0 && is_alike(times, [i - 1, i], [first[i - 1], *first_node]) {
                weights.push(weights[i - 1]);
                continue;
            }
            let (middle, half) = ((times[i] + times[i + 1]) / 2.0, (times[i + 1] - times[i]) / 2.0);
            let mut own = [0.0; 4];
            for at in [middle - half / 3f64.sqrt(), middle + half / 3f64.sqrt()] {
                for (j, weight) in own.iter_mut().enumerate() {
                    let others = (0..4).filter(|other| *other != j);
                    *weight +=
                        half * others.map(|o| (at - nodes[o]) / (nodes[j] - nodes[o])).product::<f64>();
                }
            }
            weights.push(own);
        }
        Rule { first, weights }
    }

    /// The integrals of some functions from the first sample to each.
    fn integrate<const K: usize>(&self, values: &[[f64; K]]) -> Vec<[f64; K]> {
        let mut sum = [0.0; K];
        let mut all = Vec::with_capacity(values.len());
        all.push(sum);
        for (first, weights) in self.first.iter().zip(&self.weights) {
            for (weight, node) in weights.iter().zip(&values[*first..first + 4]) {
                for (sum, value) in sum.iter_mut().zip(node) {
                    *sum += weight * value;
                }
            }
            all.push(sum);
        }
        all
    }
}

/// Whether the nodes of two intervals lie alike, but for the rounding of times: nearly all recordings are even.
fn is_alike(times: &[f64], [before, here]: [usize; 2], [first_before, first]: [usize; 2]) -> bool {
    let step = times[here + 1] - times[here];
    let off = |k: usize| (times[first + k] - times[here]) - (times[first_before + k] - times[before]);
    here - first == before - first_before && (0..4).all(|k| off(k).abs() < 1e-12 * step)
}

impl Integrals {
    /// Of a window with at least four samples; none where a contact lies on the hinge or palms are parallel.
    pub fn of(measurements: &PalmMeasurements) -> Option<Integrals> {
        let PalmMeasurements { times, contacts, angles, mass, palms, .. } = measurements;
        let n = times.len();
        let rule = Rule::of(times);
        let mut samples = vec![Sample::default(); n];
        for (i, sample) in samples.iter_mut().enumerate() {
            sample.time = times[i] - times[0];
            for p in 0..2 {
                let (sine, cosine) = angles[p][i].sin_cos();
                // palm 2 is palm 1 in a mirror
                let side = if p == 0 { 1.0 } else { -1.0 };
                let point = palms[p].at(&contacts[p][i]);
                let ([along, above], [nx, ny]) = (point.place, point.normal);
                let bend = side * point.curvature;
                let height = along * nx + above * ny;
                let normal = [nx * cosine - side * ny * sine, nx * sine + side * ny * cosine];
                let [cx, cy] = [along * cosine - side * above * sine, along * sine + side * above * cosine];
                let tangent = [side * normal[1], -side * normal[0]];
                let rate = measurements.rates[p][i];
                let mut palm = PalmSample {
                    normal,
                    tangent,
                    contact: [cx, cy],
                    own: rate * (tangent[1] * cx - tangent[0] * cy),
                    lever: side * (along * ny - above * nx),
                    height,
                    rate,
                    bend,
                    side,
                    lever_slope: side + bend * height,
                    force: 0.0,
                };
                let torque =
                    measurements.torques[p][i] - measurements.inertia[p] * measurements.accelerations[p][i];
                palm.force = torque / palm.lever;
                sample.palms[p] = palm;
            }
        }
        let gravity = [0.0, measurements.gravity];
        let pushes: Vec<[f64; 2]> = samples
            .iter()
            .map(|sample| [0, 1].map(|axis| sample.palms.iter().map(|p| p.force * p.normal[axis]).sum()))
            .collect();
        let known = samples.iter().zip(&pushes).map(|(sample, [x, y])| {
            // A' = sum f (n_y, -n_x)
            [x / mass, y / mass + gravity[1], *y, -x, sample.time * y, -sample.time * x]
        });
        let known = rule.integrate(&known.collect::<Vec<_>>());
        for (sample, [vx, vy, ax, ay, bx, by]) in samples.iter_mut().zip(known) {
            (sample.velocity, sample.a, sample.b) = ([vx, vy], [ax, ay], [bx, by]);
        }
        let places = rule.integrate(&samples.iter().map(|sample| sample.velocity).collect::<Vec<_>>());
        samples.iter_mut().zip(places).for_each(|(sample, place)| sample.place = place);
        let turns = samples.iter().zip(&pushes).map(|(sample, [x, y])| {
            let levers: f64 = sample.palms.iter().map(|palm| palm.force * palm.lever).sum();
            [levers - y * sample.place[0] + x * sample.place[1]]
        });
        let turns = rule.integrate(&turns.collect::<Vec<_>>());
        samples.iter_mut().zip(turns).for_each(|(sample, [c])| sample.c = c);

        let mean = |values: &[f64]| values.iter().sum::<f64>() / n as f64;
        let length = contacts.iter().map(|contacts| mean(contacts).abs()).sum::<f64>() / 2.0;
        let turned = measurements.rates.iter().flatten().fold(0.0, |most: f64, rate| most.max(rate.abs()));
        let fastest = contacts.iter().map(|contacts| fastest(times, contacts)).fold(0.0, f64::max);
        let pushed = pushes.iter().map(|[x, y]| x.hypot(y + mass * gravity[1]));
        let acceleration = pushed.fold(0.0, f64::max) / mass;
        let rate = 1.5 * (fastest / length + turned + (acceleration / length).sqrt());
        let slope = 3.0 * acceleration / length;
        meeting(&samples[0])?;
        let log_k = measurements.gyration.map(|gyration| -(mass * gyration * gyration).ln());
        let sigma = measurements.sigma;
        let all = Integrals { samples, mass: *mass, log_k, sigma, length, rate, slope };
        let ends = all.samples.last().map_or(f64::NAN, |end| end.c + end.place[0] + end.place[1]);
        (ends.is_finite() && rate.is_finite() && length > 0.0).then_some(all)
    }

    /// The likely `k` of a body with its centre at a distance from the palms, that of a disc whose squared radius is the mean of the distances'
    /// squares; its logarithm.
    pub fn likely_log_k(&self, centre: [f64; 2]) -> f64 {
        self.log_k.unwrap_or_else(|| {
            let square = self.radii(centre).iter().map(|r| r * r).sum::<f64>() / 2.0;
            (2.0 / (self.mass * square.max((0.3 * self.length).powi(2)))).ln()
        })
    }

    /// The largest accepted rate: with a larger one the errors of a spinning body explain everything.
    pub fn fastest(&self) -> f64 {
        2.0 * self.rate
    }

    /// The distances of a point from the palms' tangents at the first contacts.
    pub fn radii(&self, centre: [f64; 2]) -> [f64; 2] {
        self.samples[0]
            .palms
            .map(|palm| palm.normal[0] * centre[0] + palm.normal[1] * centre[1] - palm.height)
    }

    /// A velocity at the first sample along the palms' normals.
    pub fn receding(&self, velocity: [f64; 2]) -> [f64; 2] {
        self.samples[0].palms.map(|palm| palm.normal[0] * velocity[0] + palm.normal[1] * velocity[1])
    }
}

/// The largest rate of change over an eighth of a window.
fn fastest(times: &[f64], values: &[f64]) -> f64 {
    let step = (times.len() / 8).max(1);
    let ends = (step..times.len()).step_by(step);
    ends.map(|i| ((values[i] - values[i - step]) / (times[i] - times[i - step])).abs()).fold(0.0, f64::max)
}

/// Where the normals through the contacts meet: `t_i · c = t_i · c_i`.
fn meeting(sample: &Sample) -> Option<[f64; 2]> {
    // the tangent is the normal turned clockwise, and the lever is the contact along it
    let [first, second] = sample.palms.map(|palm| [palm.normal[1], -palm.normal[0], palm.lever]);
    let determinant = first[0] * second[1] - first[1] * second[0];
    let x = (first[2] * second[1] - first[1] * second[2]) / determinant;
    let y = (first[0] * second[2] - first[2] * second[0]) / determinant;
    (x.is_finite() && y.is_finite()).then_some([x, y])
}
