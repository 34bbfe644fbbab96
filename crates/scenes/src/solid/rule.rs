//! Integrals of quantities known at samples: of the polynomial through the eight samples about each interval.

/// Samples that a polynomial goes through.
pub(super) const POINTS: usize = 8;

/// Nodes and weights of Gauss's rule with four points on (-1, 1): no error up to the seventh degree.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// The weights of an integral from the start of an interval to a time in it, or its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// The interval, by the sample at its start.
    pub interval: usize,
    /// The first of the samples that are used.
    pub first: usize,
    /// Their weights, in s.
    pub weights: [f64; POINTS],
}

/// The integral over whole intervals, and to a time within one. There have to be eight times.
pub(super) fn piece(times: &[f64], interval: usize, end: f64) -> Piece {
    let first = interval.saturating_sub(POINTS / 2 - 1).min(times.len() - POINTS);
    let nodes = &times[first..first + POINTS];
    let begin = times[interval];
    let mut weights = [0.0; POINTS];
    for (place, weight) in GAUSS {
        let t = begin + (end - begin) * (1.0 + place) / 2.0;
        for (k, slot) in weights.iter_mut().enumerate() {
            let mut basis = 1.0;
            for (j, node) in nodes.iter().enumerate() {
                if j != k {
                    basis *= (t - node) / (nodes[k] - node);
                }
            }
            *slot += basis * weight * (end - begin) / 2.0;
        }
    }
    Piece { interval, first, weights }
}

impl Piece {
    /// The integral of a quantity with these values at the samples.
    pub fn of(&self, values: &[[f64; 3]]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (weight, value) in self.weights.iter().zip(&values[self.first..]) {
            for i in 0..3 {
                sum[i] += weight * value[i];
            }
        }
        sum
    }
}
