"""The systems of examples/systems once more, written by hand for the peers: rates and outputs by numpy or CasADi, inputs as functions
of time, what is sought with its sample box. Readings and truth are the program's own recordings.
"""

import math
from dataclasses import dataclass, field
from typing import Callable


@dataclass
class Observed:
    """Sought are all states, constants among them, in this order."""

    name: str
    box: dict[str, tuple[float, float]]
    rates: Callable  # (functions, state, inputs) to a list
    outputs: Callable  # (functions, state) to a list
    inputs: Callable = field(default=lambda t: ())
    angles: tuple[str, ...] = ()
    # the place of the state that each output is, where it is one
    read: tuple[int | None, ...] = (0,)
    # which of the states do not move
    constants: tuple[str, ...] = ()
    # steps of Runge and Kutta between two samples, for CasADi
    parts: int = 4
    # what a method has to find to have arrived: all, where nothing is said
    sought: tuple[str, ...] = ()


def van_der_pol(f, s, u):
    x, y, mu = s
    return [y, mu * (1 - x * x) * y - x, 0 * x]


def lorenz(f, s, u):
    x, y, z, sigma, r, b = s
    return [sigma * (y - x), x * (r - z) - y, x * y - b * z, 0 * x, 0 * x, 0 * x]


def two_tanks(f, s, u):
    h1, h2, a1, a2 = s
    return [u[0] - a1 * f.sqrt(h1), a1 * f.sqrt(h1) - a2 * f.sqrt(h2), 0 * h1, 0 * h1]


def beacons(f, s, u):
    px, py, theta = s
    return [u[0] * f.cos(theta), u[0] * f.sin(theta), u[1] + 0 * px]


def epidemic(f, s, u):
    sus, e, i, c, beta, gamma = s
    alpha = 0.2
    return [-beta * sus * i, beta * sus * i - alpha * e, alpha * e - gamma * i, alpha * e, 0 * e, 0 * e]


def motor(f, s, u):
    ia, ib, w, th, load = s
    resistance, inductance, flux, inertia, friction = 0.5, 0.005, 0.1, 0.001, 0.001
    return [
        (u[0] - resistance * ia + flux * w * f.sin(th)) / inductance,
        (u[1] - resistance * ib - flux * w * f.cos(th)) / inductance,
        (flux * (ib * f.cos(th) - ia * f.sin(th)) - friction * w - load) / inertia,
        w,
        0 * w,
    ]


BEACONS = ((-4, -3), (5, -2), (1, 6))

SYSTEMS = [
    Observed(
        "van_der_pol", {"x": (-3, 3), "y": (-4, 4), "mu": (0.2, 4)}, van_der_pol, lambda f, s: [s[0]],
        constants=("mu",),
    ),
    Observed(
        "lorenz",
        {"x": (-20, 20), "y": (-25, 25), "z": (1, 50), "sigma": (5, 15), "r": (15, 45), "b": (1, 5)},
        lorenz,
        lambda f, s: [s[0]],
        constants=("sigma", "r", "b"),
    ),
    Observed(
        "two_tanks",
        {"h1": (0.1, 2), "h2": (0.1, 2), "a1": (0.05, 0.5), "a2": (0.05, 0.5)},
        two_tanks,
        lambda f, s: [s[1]],
        lambda t: (0.2 + 0.1 * math.sin(0.5 * t),),
        read=(1,),
        constants=("a1", "a2"),
    ),
    Observed(
        "beacons",
        {"px": (-3, 3), "py": (-2, 4), "theta": (-3, 3)},
        beacons,
        lambda f, s: [f.sqrt((s[0] - x) ** 2 + (s[1] - y) ** 2) for x, y in BEACONS],
        lambda t: (1 + 0.3 * math.sin(t), 0.6 * math.cos(0.8 * t)),
        angles=("theta",),
        read=(None, None, None),
    ),
    Observed(
        "motor",
        {"ia": (-5, 5), "ib": (-5, 5), "w": (-20, 40), "th": (-3, 3), "load": (-0.2, 0.2)},
        motor,
        lambda f, s: [s[0], s[1]],
        lambda t: (-3 * math.sin(20 * t), 3 * math.cos(20 * t)),
        angles=("th",),
        read=(0, 1),
        constants=("load",),
    ),
    Observed(
        "epidemic",
        {"s": (0.6, 1), "e": (0, 0.02), "i": (0, 0.02), "c": (0, 0.05), "beta": (0.1, 1), "gamma": (0.05, 0.5)},
        epidemic,
        lambda f, s: [s[3]],
        read=(3,),
        constants=("beta", "gamma"),
    ),
]
