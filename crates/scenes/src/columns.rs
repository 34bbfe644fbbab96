//! What a simulated motion has at each moment, by the names that files and models give it.

use palmistry_bodies::mechanics::moving::Moment;

/// What else a column is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SeenAs {
    /// A sensor or a motor reads it, and models know it by this name.
    Read,
    /// Models know it by this name; nobody reads it.
    State,
    /// It stands in the table only.
    Shown,
}

/// A column of the table of a motion.
pub(super) struct Column {
    pub name: &'static str,
    pub seen_as: SeenAs,
    /// In SI units.
    pub value: fn(&Moment) -> f64,
}

/// All columns, in the order of the table.
pub(super) const COLUMNS: [Column; 26] = [
    Column { name: "phi0", seen_as: SeenAs::State, value: |m| m.phi0 },
    Column { name: "omega0", seen_as: SeenAs::State, value: |m| m.omega0 },
    Column { name: "alpha0", seen_as: SeenAs::Shown, value: |m| m.alpha0 },
    Column { name: "x", seen_as: SeenAs::State, value: |m| m.centre[0] },
    Column { name: "y", seen_as: SeenAs::State, value: |m| m.centre[1] },
    Column { name: "vx", seen_as: SeenAs::State, value: |m| m.velocity[0] },
    Column { name: "vy", seen_as: SeenAs::State, value: |m| m.velocity[1] },
    Column { name: "phi1", seen_as: SeenAs::Read, value: |m| m.palms[0].angle },
    Column { name: "phi2", seen_as: SeenAs::Read, value: |m| m.palms[1].angle },
    Column { name: "omega1", seen_as: SeenAs::Read, value: |m| m.palms[0].rate },
    Column { name: "omega2", seen_as: SeenAs::Read, value: |m| m.palms[1].rate },
    Column { name: "alpha1", seen_as: SeenAs::Read, value: |m| m.palms[0].acceleration },
    Column { name: "alpha2", seen_as: SeenAs::Read, value: |m| m.palms[1].acceleration },
    Column { name: "s1", seen_as: SeenAs::Read, value: |m| m.palms[0].s },
    Column { name: "s2", seen_as: SeenAs::Read, value: |m| m.palms[1].s },
    Column { name: "r1", seen_as: SeenAs::State, value: |m| m.palms[0].r },
    Column { name: "r2", seen_as: SeenAs::State, value: |m| m.palms[1].r },
    Column { name: "d1", seen_as: SeenAs::Shown, value: |m| m.palms[0].d },
    Column { name: "d2", seen_as: SeenAs::Shown, value: |m| m.palms[1].d },
    Column { name: "force1", seen_as: SeenAs::Shown, value: |m| m.palms[0].force },
    Column { name: "force2", seen_as: SeenAs::Shown, value: |m| m.palms[1].force },
    Column { name: "tau1", seen_as: SeenAs::Read, value: |m| m.palms[0].torque },
    Column { name: "tau2", seen_as: SeenAs::Read, value: |m| m.palms[1].torque },
    Column { name: "kinetic", seen_as: SeenAs::Shown, value: |m| m.kinetic },
    Column { name: "potential", seen_as: SeenAs::Shown, value: |m| m.potential },
    Column { name: "work", seen_as: SeenAs::Shown, value: |m| m.work },
];
