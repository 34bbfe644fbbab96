"""The two systems and the work that is measured, written down once for all peers.

Every function takes the states as a list and a namespace with `sin` and `cos`, so that it can be handed symbols of any
library, or numbers. The formulas are those of `proofs/moll2002/general.proof` and `same_rate.proof`; parameters have
the values that these files give them.
"""

import math
from dataclasses import dataclass


def distances(r1, r2, s1, s2, sine, cosine):
    """d1 and d2, equations 3.18 and 3.19."""
    return (r1 * cosine + r2) / sine - s1, s2 - (r2 * cosine + r1) / sine


class TenStates:
    """The general regime: all of the planar dynamics of section 4.2, torques as inputs."""

    states = ["r1", "r2", "omega0", "s1", "s2", "phi1", "omega1", "phi2", "omega2", "rho"]
    low = [0.5, 0.5, -3, 0.5, 0.5, 0.2, -3, 0.8, -3, 0.3]
    high = [3, 3, 3, 3, 3, 1.2, 3, 2.4, 3, 2]
    m = 1.0

    @staticmethod
    def avoid(x):
        """What sampled states keep away from being zero; sin(phi2) has no zero in the box."""
        return [x[6] - x[2], x[6] + x[8] - x[2]]

    @classmethod
    def fields(cls, x, functions):
        """The input fields g1 and g2 of equation 4.34: the states that they move, and how."""
        r1, r2, omega0, s1, s2, _, omega1, phi2, omega2, rho = x
        sine, cosine = functions.sin(phi2), functions.cos(phi2)
        d1, d2 = distances(r1, r2, s1, s2, sine, cosine)
        slip1, slip2 = omega1 - omega0, omega1 + omega2 - omega0
        inertia = cls.m * rho * rho
        g1 = {
            "omega0": -d1 / (inertia * s1),
            "s1": (rho * rho + d1 * d1) / (inertia * s1 * slip1),
            "s2": (rho * rho * cosine - d1 * d2) / (inertia * s1 * slip2),
        }
        g2 = {
            "omega0": d2 / (inertia * s2),
            "s1": (rho * rho * cosine - d1 * d2) / (inertia * s2 * slip1),
            "s2": (rho * rho + d2 * d2) / (inertia * s2 * slip2),
        }
        return {"g1": g1, "g2": g2}


class SameRate:
    """Both palms at one constant rate, section 4.3: the drift alone."""

    states = ["r1", "r2", "omega0", "s1", "s2", "phi1"]
    low = [0.5, 0.5, -3, 0.5, 0.5, 0.2]
    high = [3, 3, 3, 3, 3, 1.2]
    phi2, omega1, g = 2.0, 2.0, -9.81

    @classmethod
    def avoid(cls, x):
        return [cls.omega1 - x[2]]

    @classmethod
    def fields(cls, x, functions):
        """The drift f of equation 4.44."""
        r1, r2, omega0, s1, s2, phi1 = x
        sine, cosine = math.sin(cls.phi2), math.cos(cls.phi2)
        d1, d2 = distances(r1, r2, s1, s2, sine, cosine)
        slip, total = cls.omega1 - omega0, cls.omega1 + omega0
        weight1, weight2 = cls.g * functions.cos(phi1), cls.g * functions.cos(phi1 + cls.phi2)
        f = {
            "r1": -d1 * slip,
            "r2": -d2 * slip,
            "s1": (omega0 * omega0 * r1 + weight1) / slip - total * (s1 * cosine - s2) / sine,
            "s2": (weight2 - omega0 * omega0 * r2) / slip + total * (s2 * cosine - s1) / sine,
            "phi1": cls.omega1,
        }
        return {"f": f}


@dataclass(frozen=True)
class Job:
    """Gradients of repeated Lie derivatives, and for a verdict their singular values.

    A row is an output and the fields along which it is differentiated, first to last; its gradient is taken by the
    states of `columns`. The outputs are states themselves, so that their gradients are unit rows, which are constant
    and are not computed. `singular`: None, "block" (of the given rows and columns, which is what the unit rows leave) or
    "whole" (of the square matrix with the unit rows; ours finds and eliminates them by itself, in its preparation, so that
    for us both are one job).
    """

    title: str
    model: type
    rows: tuple
    columns: tuple
    singular: str | None = None
    outputs: tuple = ()


def indices(model, names):
    return tuple(model.states.index(name) for name in names.split())


TEN_ROWS = (("s1", ("g1",)), ("s2", ("g2",)), ("s1", ("g1", "g1")), ("s2", ("g2", "g2")))
SAME_ROWS = (("s1", ("f",)), ("s2", ("f",)), ("s1", ("f", "f")))
UNSEEN = indices(TenStates, "r1 r2 omega0 rho")
SEEN = indices(TenStates, "s1 s2 phi1 omega1 phi2 omega2")

JOBS = {
    "matrix": Job("ten states: matrix", TenStates, TEN_ROWS, tuple(range(10))),
    "block": Job("verdict, peers given the 4x4 block", TenStates, TEN_ROWS, UNSEEN, "block"),
    "whole": Job("verdict, all ten rows given", TenStates, TEN_ROWS, tuple(range(10)), "whole", SEEN),
    "same_rate": Job("same rate: matrix", SameRate, SAME_ROWS, tuple(range(6))),
    "order8": Job("gradient of Lg1^8 s1", TenStates, (("s1", ("g1",) * 8),), tuple(range(10))),
}


def symbolic_rows(job, x, functions, derivative):
    """The rows of a job for a library of symbols, by Lie derivatives in the plain way: the sum of the field's
    components times the partial derivatives. `derivative(h, x)` is the library's own."""
    fields = job.model.fields(x, functions)
    rows = []
    for output, word in job.rows:
        value = x[job.model.states.index(output)]
        for name in word:
            moved = [(x[job.model.states.index(state)], rate) for state, rate in fields[name].items()]
            value = sum(rate * derivative(value, state) for state, rate in moved)
        rows.append([derivative(value, x[column]) for column in job.columns])
    return rows
