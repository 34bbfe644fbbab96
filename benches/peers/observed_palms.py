"""Bodies between palms for observe_compare.py: the four regimes of the thesis and circular palms, from random guesses.

The scenes are the shipped ones, their contacts read with a noise of NOISE or none. Sought are both radii, the body's rate, and where the
shipped scene seeks it the radius of gyration. A guess draws the radii, and that of gyration, between a half of the truth and one and a
half of it, and the rate between -3 and 3 rad/s, whatever its sign is. Methods by windows get the first 81 samples (0.28 s), filters all 401 (1.4 s).

The peers get the same readings and the equations of motion, written here once more from Newton's and Euler's laws and the velocities at the
contacts (sections 4.2 and 4.7 of the thesis). To them the contacts s1, s2 are states as well, begun at what is read first;
palms and torques are known, by cubics through the four nearest samples.
"""

import functools
import re
from dataclasses import replace

import numpy as np

from observed import ROOT, FILTERS, recorded
from observed_systems import Observed
from observer_peers import FILTERPY, PEERS, alone

SCENES = ROOT / "proofs/moll2002/scenes"
NOISE = 1e-5  # m
WINDOW = 81
UNGUIDED = "trust-region without a guess"
OURS = ["multiple-shooting", "trust-region", "newton", "kalman", "unscented", "high-gain"]
COLUMNS = ["phi1", "phi2", "omega1", "omega2", "alpha1", "alpha2", "tau1", "tau2"]
MASS, INERTIA1, INERTIA2, GRAVITY = 1.0, 0.5, 0.6, -9.81


def between_palms(radii, rho):
    """Rates of r1, r2, omega0, s1, s2 and, where it is sought, the radius of gyration; flat palms where there are no radii."""

    def rates(f, state, known):
        r1, r2, omega0, s1, s2 = state[:5]
        gyration = state[5] if rho is None else rho
        phi1, phi2, omega1, omega2, alpha1, alpha2, tau1, tau2 = known
        turn1, turn2, accel1, accel2 = omega1, omega1 + omega2, alpha1, alpha1 + alpha2
        # where a contact is in its palm's frame, along the tangent and the normal there
        kappa1, p1, q1, psi1 = 0, s1, 0, phi1
        kappa2, p2, q2, psi2 = 0, -s2, 0, phi1 + phi2
        if radii:
            b1, b2 = radii
            kappa1, p1, q1, psi1 = 1 / b1, b1 * f.sin(s1 / b1), b1 * (f.cos(s1 / b1) - 1), phi1 + s1 / b1
            kappa2, p2, q2, psi2 = 1 / b2, -b2 * f.sin(s2 / b2), b2 * (f.cos(s2 / b2) - 1), phi1 + phi2 - s2 / b2
        t1, t2 = (f.cos(psi1), f.sin(psi1)), (-f.cos(psi2), -f.sin(psi2))
        n1, n2 = (-t1[1], t1[0]), (-t2[1], t2[0])
        along = lambda a, b: a[0] * b[0] + a[1] * b[1]
        c1, c2 = ([p * t[k] + q * n[k] for k in range(2)] for p, q, t, n in ((p1, q1, t1, n1), (p2, q2, t2, n2)))
        sine, cosine = f.sin(psi2 - psi1), f.cos(psi2 - psi1)
        apart = [c2[k] - c1[k] for k in range(2)]
        # the contacts as seen from the centre of mass: -(r n + d t)
        d1 = (along(apart, n2) + r1 * cosine + r2) / sine
        d2 = (along(apart, n1) - r2 * cosine - r1) / sine
        force1, force2 = (tau1 - INERTIA1 * accel1) / p1, (tau2 - INERTIA2 * accel2) / p2
        a = [(force1 * n1[k] + force2 * n2[k]) / MASS + (0, GRAVITY)[k] for k in range(2)]
        # the arm's cross product with n is -d
        alpha0 = -(force1 * d1 + force2 * d2) / (MASS * gyration**2)
        slide = [(turn1 - omega0) * c1[k] - (turn2 - omega0) * c2[k] for k in range(2)]
        normal1 = accel1 * p1 - turn1**2 * q1 - omega0**2 * r1 - along(a, n1) + alpha0 * d1
        normal2 = accel2 * p2 - turn2**2 * q2 - omega0**2 * r2 - along(a, n2) + alpha0 * d2
        across1, across2 = along(slide, t2) / sine, along(slide, t1) / sine
        rate1 = ((turn1 + omega0) * across1 - normal1) / (turn1 - omega0 - kappa1 * across1)
        rate2 = -((turn2 + omega0) * across2 - normal2) / (turn2 - omega0 - kappa2 * across2)
        radius1 = -d1 * (turn1 + kappa1 * rate1 - omega0)
        radius2 = -d2 * (turn2 - kappa2 * rate2 - omega0)
        return [radius1, radius2, alpha0, rate1, rate2, *[0 * r1 for _ in state[5:]]]

    return rates


def signals(times, columns):
    """Known functions of time: at a time the cubic through the four nearest samples of each column."""
    values = np.array([columns[name] for name in COLUMNS]).T
    step = times[1] - times[0]

    def at(t):
        place = (t - times[0]) / step
        first = min(max(int(place) - 1, 0), len(times) - 4)
        x = place - first
        weights = np.array([-(x - 1) * (x - 2) * (x - 3) / 6, x * (x - 2) * (x - 3) / 2, -x * (x - 1) * (x - 3) / 2, x * (x - 1) * (x - 2) / 6])
        return tuple((weights @ values[first : first + 4]).tolist())

    return at


def regime(name, *gyration):
    """A regime whose box, rates and signals are those of a recording."""
    seen = lambda f, s: [s[3], s[4]]
    sought = ("r1", "r2", "omega0", *gyration)
    return Observed(name, {}, between_palms, seen, read=(3, 4), constants=gyration, parts=1, sought=sought)


REGIMES = [regime("general", "rho"), regime("same_rate"), regime("one_palm_fixed"), regime("fixed_palms", "rho"), regime("circular_palms")]
RADII = {"circular_palms": (4.0, 5.0)}
TUNED = {
    "kalman": "kalman = { prior = 0.5, process_noise = 1e-4 }\n",
    "unscented": "unscented = { prior = 0.5, process_noise = 1e-4 }\n",
    "high-gain": "high_gain = { gain = 50.0 }\n",
}


def scene(system, noisy, method, guess, seed):
    """The shipped scene with another method, guess, noise and seed, without its studies."""
    text = (SCENES / f"{system.name}.toml").read_text().split("[study.")[0].replace('"../', f'"{SCENES.parent}/')
    text = re.sub(r"^(methods|guess_off|kalman|high_gain|steps) = .*\n", "", text, flags=re.M)
    text = re.sub(r"^duration", f"seed = {seed}\nduration", text, flags=re.M)
    settings = f'methods = ["{"trust-region" if method == UNGUIDED else method}"]\nsteps = 100\n{guess}\n{TUNED.get(method, "")}'
    return text.replace("[observer]\n", f"[sensor]\nnoise = {NOISE if noisy else 0}\n[observer]\n{settings}")


@functools.cache
def gyration(observers):
    """The radius of gyration: all scenes hold the same body."""
    told, _, _ = observers.observe(scene(REGIMES[0], False, "trust-region", "guess_off = 0.0", 1))
    return told["observers"][0]["updates"][0]["states"]["rho"]["true"]


def recording_of(observers, system, noisy, seed, draws):
    """The system with its signals, a recording with the truth and the bound at it, and a guess."""
    from_truth = scene(system, noisy, "trust-region", "guess_off = 0.0", seed)
    record, motion = (observers.folder / name for name in ("record.csv", "motion.csv"))
    record.write_text(observers.record(from_truth, str(motion)))
    lines = record.read_text().splitlines(keepends=True)
    whole, window = "".join(lines), "".join(lines[: WINDOW + 1])
    answered, _, _ = observers.observe(from_truth, "--data", "-", readings=window)
    names = ["r1", "r2", "omega0", "s1", "s2", *system.constants]
    data = recorded(names, 2, record, motion, answered[0]["observers"][0]["updates"][0], NOISE if noisy else 0)
    data |= {"whole": whole, "window": window}
    rho = gyration(observers)
    if system.constants:
        # no column of a motion; it does not move
        for state in data["truth"]:
            state[-1] = rho
    truth = dict(zip(names, data["truth"][0].tolist()))
    sizes = {name: (0.5 * truth[name], 1.5 * truth[name]) for name in ("r1", "r2", *system.constants)} | {"omega0": (-3, 3)}
    sizes |= {name: (read - 0.5, read + 0.5) for name, read in zip(("s1", "s2"), data["read"][0].tolist())}
    guess = {name: draws.uniform(*sizes[name]) for name in system.sought}
    rates = between_palms(RADII.get(system.name), None if system.constants else rho)
    box = {name: sizes[name] for name in names}
    return replace(system, box=box, rates=rates, inputs=signals(data["times"], data["columns"])), data, guess


def runs(observers, system, data, guess, options):
    """Each method with what it recovered, its seconds and its memory; filters from the whole recording."""
    told = "guess = { " + ", ".join(f"{name} = {value!r}" for name, value in guess.items()) + " }"
    noisy = data["sigma"] == NOISE
    for method in [UNGUIDED, *OURS]:
        start = 'guess = "none"' if method == UNGUIDED else told
        # as a stream, which takes no time for the shape
        readings = data["whole" if method in FILTERS else "window"]
        yield method, *observers.recover(system, method, scene(system, noisy, method, start, 1), "--data", "-", readings=readings)
    from_read = guess | dict(zip(("s1", "s2"), data["read"][0]))
    begin = np.array([from_read[name] for name in system.box])
    for method in PEERS:
        count = None if method == FILTERPY else WINDOW
        part = data | {"times": data["times"][:count], "read": data["read"][:count]}
        yield method, *alone(method, system, part, begin, options.limit)
