//! The explicit pair of J. R. Dormand and P. J. Prince of orders 5 and 4 (A family of embedded Runge-Kutta formulae, 1980), with its interpolation of order 4
//! (E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, 1993, section II.6), for integrators that allocate nothing in a step.

/// Where in a step the rates are taken, relative to its length.
pub const NODES: [f64; 7] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];

/// The weights with which the state at each node takes the rates before it; the last row gives the end of the step.
pub const STAGES: [[f64; 6]; 7] = [
    [0.0; 6],
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// The formula of order five minus that of order four.
pub const DIFFERENCE: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// What the rates give to the last term of the interpolation.
const BETWEEN: [f64; 7] = [
    -12715105075.0 / 11282082432.0,
    0.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

/// A coordinate within a step, at `part` of its length, from what it is at both ends, and its rates at the nodes.
pub fn between(part: f64, length: f64, [first, last]: [f64; 2], rates: [f64; 7]) -> f64 {
    let rest = 1.0 - part;
    let whole = last - first;
    let begin = length * rates[0] - whole;
    let end = whole - length * rates[6] - begin;
    let bend: f64 = rates.iter().zip(&BETWEEN).map(|(rate, part)| part * rate).sum();
    first + part * (whole + rest * (begin + part * (end + rest * length * bend)))
}
