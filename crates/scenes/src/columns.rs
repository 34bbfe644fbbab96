//! What a simulated motion has at each moment, by the names that files and models give it.

use palmistry_bodies::mechanics::moving::Moment;

/// How a column is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColumnUse {
    /// A sensor or a motor measures it, and models know it by this name.
    Read,
    /// Models know it by this name; nothing measures it.
    State,
    /// It stands in the table only.
    Shown,
}

/// A column of the table of a motion.
pub(super) struct Column {
    pub name: &'static str,
    pub usage: ColumnUse,
    /// In SI units.
    pub value: fn(&Moment) -> f64,
}

/// All columns, in the order of the table.
pub(super) const COLUMNS: [Column; 26] = [
    Column { name: "phi0", usage: ColumnUse::State, value: |m| m.phi0 },
    Column { name: "omega0", usage: ColumnUse::State, value: |m| m.omega0 },
    Column { name: "alpha0", usage: ColumnUse::Shown, value: |m| m.alpha0 },
    Column { name: "x", usage: ColumnUse::State, value: |m| m.centre[0] },
    Column { name: "y", usage: ColumnUse::State, value: |m| m.centre[1] },
    Column { name: "vx", usage: ColumnUse::State, value: |m| m.velocity[0] },
    Column { name: "vy", usage: ColumnUse::State, value: |m| m.velocity[1] },
    Column { name: "phi1", usage: ColumnUse::Read, value: |m| m.palms[0].angle },
    Column { name: "phi2", usage: ColumnUse::Read, value: |m| m.palms[1].angle },
    Column { name: "omega1", usage: ColumnUse::Read, value: |m| m.palms[0].rate },
    Column { name: "omega2", usage: ColumnUse::Read, value: |m| m.palms[1].rate },
    Column { name: "alpha1", usage: ColumnUse::Read, value: |m| m.palms[0].acceleration },
    Column { name: "alpha2", usage: ColumnUse::Read, value: |m| m.palms[1].acceleration },
    Column { name: "s1", usage: ColumnUse::Read, value: |m| m.palms[0].s },
    Column { name: "s2", usage: ColumnUse::Read, value: |m| m.palms[1].s },
    Column { name: "r1", usage: ColumnUse::State, value: |m| m.palms[0].r },
    Column { name: "r2", usage: ColumnUse::State, value: |m| m.palms[1].r },
    Column { name: "d1", usage: ColumnUse::Shown, value: |m| m.palms[0].d },
    Column { name: "d2", usage: ColumnUse::Shown, value: |m| m.palms[1].d },
    Column { name: "force1", usage: ColumnUse::Shown, value: |m| m.palms[0].force },
    Column { name: "force2", usage: ColumnUse::Shown, value: |m| m.palms[1].force },
    Column { name: "tau1", usage: ColumnUse::Read, value: |m| m.palms[0].torque },
    Column { name: "tau2", usage: ColumnUse::Read, value: |m| m.palms[1].torque },
    Column { name: "kinetic", usage: ColumnUse::Shown, value: |m| m.kinetic },
    Column { name: "potential", usage: ColumnUse::Shown, value: |m| m.potential },
    Column { name: "work", usage: ColumnUse::Shown, value: |m| m.work },
];
