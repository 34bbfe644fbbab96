//! The dimensions of the thesis's quantities, and some systems of units to write them in.

/// The powers of length, mass and time in the dimension of a symbol of the planar files. The moments of inertia of the
/// palms and the torques are those of section 4.2; an angle has none.
pub const DIMENSIONS: [(&str, [i32; 3]); 19] = [
    ("r1", [1, 0, 0]),
    ("r2", [1, 0, 0]),
    ("s1", [1, 0, 0]),
    ("s2", [1, 0, 0]),
    ("rho", [1, 0, 0]),
    ("phi1", [0, 0, 0]),
    ("phi2", [0, 0, 0]),
    ("omega0", [0, 0, -1]),
    ("omega1", [0, 0, -1]),
    ("omega2", [0, 0, -1]),
    ("alpha1", [0, 0, -2]),
    ("alpha2", [0, 0, -2]),
    ("g", [1, 0, -2]),
    ("m", [0, 1, 0]),
    ("m_o", [0, 1, 0]),
    ("I1", [2, 1, 0]),
    ("I2", [2, 1, 0]),
    ("tau1", [2, 1, -2]),
    ("tau2", [2, 1, -2]),
];

/// The dimension of a symbol, if it is in the table.
pub fn dimension(name: &str) -> Option<[i32; 3]> {
    DIMENSIONS.iter().find(|(known, _)| *known == name).map(|(_, powers)| *powers)
}

/// Other units: how many of them make a metre, a kilogram and a second, as powers of ten.
pub const UNIT_SYSTEMS: [(&str, [i32; 3]); 6] = [
    ("millimetre, gram, millisecond", [3, 3, 3]),
    ("millimetre, kilogram, second", [3, 0, 0]),
    ("metre, kilogram, microsecond", [0, 0, 6]),
    ("micrometre, milligram, second", [6, 6, 0]),
    ("picometre, kilogram, second", [12, 0, 0]),
    ("megametre, tonne, megasecond", [-6, -3, -6]),
];
