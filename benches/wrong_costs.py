"""What a wrong model costs beside a right one: the time of an estimate by multiple shooting from the sample box.

    python3 benches/wrong_costs.py [--program target/release/palmistry] [--method multiple-shooting]

Six systems. Each is observed on a recording of its own equations, and on one of equations with a term that the model has not; noise is
stated, and the classical Runge-Kutta method with 0.01 s a step makes the recordings. The wrong model must not be said to fit.
"""

import argparse
import json
import math
import random
import subprocess
import tempfile
from pathlib import Path
from typing import Callable, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
STEP = 0.01


class System(NamedTuple):
    model: str
    right: Callable
    wrong: Callable
    missing: str
    output: int
    start: list
    every: float
    samples: int
    noise: float
    unknown: str
    known: str = ""


def root(x):
    return math.sqrt(max(x, 0.0))


SYSTEMS = {
    "a spring": System(
        "state x, v param k, c unknown drift f x' = v v' = -k*x - c*v output x "
        "sample x in [-2, 2] v in [-2, 2] k in [0.5, 5] c in [0, 2]",
        lambda s, t: [s[1], -2.3 * s[0] - 0.2 * s[1]],
        lambda s, t: [s[1], -2.3 * s[0] - 0.2 * s[1] - 0.8 * s[0] ** 3],
        "a cubic force", 0, [1.2, 0.0], 0.05, 401, 1e-3, "x v k c",
    ),
    "an epidemic": System(
        "state S, I param beta, gamma unknown drift f S' = -beta*S*I I' = beta*S*I - gamma*I output I "
        "sample S in [0, 1] I in [0, 0.2] beta in [0.1, 4] gamma in [0.05, 2]",
        lambda s, t: [-1.5 * s[0] * s[1], 1.5 * s[0] * s[1] - 0.4 * s[1]],
        lambda s, t: [-1.5 * s[0] * s[1] + 0.05 * (1 - s[0]), 1.5 * s[0] * s[1] - 0.4 * s[1]],
        "loss of immunity", 1, [0.95, 0.02], 0.1, 301, 1e-4, "S I beta gamma",
    ),
    "a pendulum": System(
        "state phi, om param k, c unknown angle phi drift f phi' = om om' = -k*sin(phi) - c*om output phi "
        "sample phi in [-2, 2] om in [-3, 3] k in [2, 20] c in [0, 1]",
        lambda s, t: [s[1], -9 * math.sin(s[0]) - 0.1 * s[1]],
        lambda s, t: [s[1], -9 * math.sin(s[0]) - 0.3 * s[1] * abs(s[1])],
        "drag that is quadratic", 0, [1.5, 0.0], 0.05, 201, 1e-3, "phi om k c",
    ),
    "predator and prey": System(
        "state x, y param a, b, c, d unknown drift f x' = a*x - b*x*y y' = d*x*y - c*y output x "
        "sample x in [0.2, 4] y in [0.2, 4] a in [0.2, 3] b in [0.2, 3] c in [0.2, 3] d in [0.2, 3]",
        lambda s, t: [1.1 * s[0] - 0.7 * s[0] * s[1], 0.5 * s[0] * s[1] - 0.9 * s[1]],
        lambda s, t: [1.1 * s[0] * (1 - s[0] / 6) - 0.7 * s[0] * s[1], 0.5 * s[0] * s[1] - 0.9 * s[1]],
        "a bound of growth", 0, [2.0, 1.0], 0.1, 201, 1e-3, "x y a c d", "known = { b = 0.7 }\n",
    ),
    "two tanks": System(
        "state h, g param k, l unknown drift f h' = 1 - k*h g' = k*h - l*g output g "
        "sample h in [0, 3] g in [0, 3] k in [0.1, 3] l in [0.1, 3]",
        lambda s, t: [1 - 0.8 * s[0], 0.8 * s[0] - 0.5 * s[1]],
        lambda s, t: [1 - 0.8 * root(s[0]), 0.8 * root(s[0]) - 0.5 * root(s[1])],
        "Torricelli's law", 1, [0.2, 1.5], 0.05, 201, 1e-4, "h g k l",
    ),
    "an oscillator": System(
        "state x, v param mu, w unknown drift f x' = v v' = mu*(1 - x^2)*v - w*x output x "
        "sample x in [-3, 3] v in [-3, 3] mu in [0.1, 3] w in [0.2, 3]",
        lambda s, t: [s[1], 1.2 * (1 - s[0] ** 2) * s[1] - s[0]],
        lambda s, t: [s[1], 1.2 * (1 - s[0] ** 2) * s[1] - s[0] + 0.4 * math.cos(1.7 * t)],
        "a periodic force", 0, [1.0, 0.0], 0.1, 201, 1e-3, "x v mu w",
    ),
}


def recording(system, rates, seed=5):
    draws, state, t, lines = random.Random(seed), list(system.start), 0.0, []
    for _ in range(system.samples):
        lines.append(f"{t!r},{state[system.output] + draws.gauss(0, system.noise)!r}")
        for _ in range(round(system.every / STEP)):
            moved = lambda by, part: [x + part * STEP * d for x, d in zip(state, by)]
            a = rates(state, t)
            b = rates(moved(a, 0.5), t + STEP / 2)
            c = rates(moved(b, 0.5), t + STEP / 2)
            d = rates(moved(c, 1.0), t + STEP)
            state = [x + STEP / 6 * (p + 2 * q + 2 * r + s) for x, p, q, r, s in zip(state, a, b, c, d)]
            t += STEP
    return lines


def seconds(program, method, folder, system, rates):
    """How long the search took, and whether it is said to fit."""
    (folder / "model.proof").write_text(f'system "A system" {system.model}\n')
    output = system.model.split(" output ")[1].split()[0]
    (folder / "run.csv").write_text("\n".join([f"time,{output}", *recording(system, rates)]) + "\n")
    (folder / "scene.toml").write_text(
        f'title = "A system"\nmodel = "model.proof"\n[data]\nrecord = "run.csv"\n[sensor]\nnoise = {system.noise!r}\n[observer]\n'
        f'methods = ["{method}"]\nestimate = {json.dumps(system.unknown.split())}\n{system.known}window = {system.samples - 1}\nsteps = 50\n'
    )
    run = subprocess.run([program, "observe", folder / "scene.toml", "--json"], capture_output=True, text=True)
    update = json.loads(run.stdout)["observers"][0]["updates"][0]
    return update["seconds"], run.returncode == 0


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--program", default=ROOT / "target/release/palmistry")
    options.add_argument("--method", default="multiple-shooting")
    options = options.parse_args()
    print("| system | what the model has not | right, s | wrong, s | ratio |\n|---|---|---:|---:|---:|")
    for name, system in SYSTEMS.items():
        with tempfile.TemporaryDirectory() as folder:
            of = lambda rates: seconds(options.program, options.method, Path(folder), system, rates)
            (right, fits), (wrong, deceived) = of(system.right), of(system.wrong)
        assert fits and not deceived, name
        print(f"| {name} | {system.missing} | {right:.2f} | {wrong:.2f} | {wrong / right:.1f} |")


if __name__ == "__main__":
    main()
