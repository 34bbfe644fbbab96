"""How near the observer that `observe --accuracy` chooses is to the best that an exhaustive trial finds.

    python3 benches/choice.py [--program target/release/palmistry] [--tasks 50] [--seed 1]

A task is a system with random constants, a recording of random length and noise, a guess or none, and an accuracy between what the
coarsest and what the finest observer reaches there. All observers are tried (`--accuracy` of a part that none reaches); the time of the one that
is chosen for the task's accuracy is compared with the least of those that suffice, in the same trial.
"""

import argparse
import json
import math
import random
import statistics
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

SYSTEMS = {
    "spring": (
        "state x, v param k, c unknown drift f x' = v v' = -k*x - c*v output x sample x in [-2, 2] v in [-2, 2] k in [0.5, 5] c in [0, 2]",
        {"x": (0.5, 1.5), "v": (-1, 1), "k": (1, 4), "c": (0.05, 0.4)}, 20.0,
    ),
    "van der pol": (
        "state x, y param mu unknown drift f x' = y y' = mu*(1 - x^2)*y - x output x sample x in [-3, 3] y in [-4, 4] mu in [0.2, 3]",
        {"x": (0.5, 1.5), "y": (-1, 1), "mu": (0.5, 2)}, 20.0,
    ),
    "epidemic": (
        "state S, I param beta, gamma unknown drift f S' = -beta*S*I I' = beta*S*I - gamma*I output I sample S in [0, 1] I in [0, 0.2] beta in [0.1, 4] gamma in [0.05, 2]",
        {"S": (0.8, 0.98), "I": (0.01, 0.05), "beta": (1, 2), "gamma": (0.2, 0.6)}, 20.0,
    ),
    "pendulum": (
        "state phi, om param k, c unknown angle phi drift f phi' = om om' = -k*sin(phi) - c*om output phi sample phi in [-2, 2] om in [-3, 3] k in [2, 20] c in [0, 1]",
        {"phi": (0.5, 1.5), "om": (-1, 1), "k": (4, 12), "c": (0.02, 0.2)}, 10.0,
    ),
    "lorenz": (
        "state x, y, z param s, r, b unknown drift f x' = s*(y - x) y' = x*(r - z) - y z' = x*y - b*z output x "
        "sample x in [-20, 20] y in [-20, 20] z in [0, 40] s in [5, 15] r in [20, 35] b in [1, 4]",
        {"x": (-5, 5), "y": (-5, 5), "z": (10, 25), "s": (9, 11), "r": (26, 30), "b": (2, 3)}, 2.0,
    ),
}


def task(rng, folder, number):
    name = rng.choice(sorted(SYSTEMS))
    text, ranges, longest = SYSTEMS[name]
    model = folder / f"{number}.proof"
    model.write_text(f'system "{name}" ' + text)
    start = {state: rng.uniform(*ends) for state, ends in ranges.items()}
    samples = rng.randint(80, 600)
    noise = 10 ** rng.uniform(-4, -2) * max(abs(start[next(iter(ranges))]), 0.1)
    guess = ""
    if rng.random() < 0.5:
        off = {state: value * (1 + rng.uniform(-0.1, 0.1)) for state, value in start.items()}
        guess = "guess = { " + ", ".join(f"{state} = {value}" for state, value in off.items()) + " }\n"
    scene = folder / f"{number}.toml"
    scene.write_text(
        f'title = "{name}"\nmodel = "{model.name}"\nduration = {longest * rng.uniform(0.5, 1)}\nsamples = {samples}\n'
        + "[start]\n" + "".join(f"{state} = {value}\n" for state, value in start.items())
        + f"[sensor]\nnoise = {noise}\n[observer]\nestimate = {json.dumps(list(ranges))}\n{guess}"
    )
    return name, scene


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=ROOT / "target/release/palmistry")
    parser.add_argument("--tasks", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    rng = random.Random(asked.seed)
    ratios, none, missed = [], 0, 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        number = 0
        while len(ratios) < asked.tasks:
            number += 1
            system, scene = task(rng, folder, number)

            def tried(accuracy):
                run = subprocess.run(
                    [asked.program, "observe", scene, "--accuracy", repr(accuracy), "--json"], capture_output=True, text=True, check=False
                )
                return json.loads(run.stdout)["choice"]

            everything = tried(1e-15)["tried"]
            reached = [one["accuracy"] for one in everything if one["accuracy"]]
            if not reached:
                none += 1
                continue
            accuracy = math.exp(rng.uniform(math.log(min(reached)), math.log(min(max(reached), 0.9)))) * 1.0000001
            sufficing = {place: one["seconds"] for place, one in enumerate(everything) if one["accuracy"] and one["accuracy"] <= accuracy}
            choice = tried(accuracy)
            if not choice["suffices"] or choice["chosen"] not in sufficing:
                missed += 1
                continue
            ratio = sufficing[choice["chosen"]] / min(sufficing.values())
            own = everything[choice["chosen"]]
            best = everything[min(sufficing, key=sufficing.get)]
            ratios.append(ratio)
            print(f"{system}: accuracy {accuracy:.1e}: {own['method']} {own['window']}, {ratio:.2f} times the time of {best['method']} {best['window']}", flush=True)
    within = sum(ratio <= 1.5 for ratio in ratios)
    print(f"{within} of {len(ratios)} within 1.5 times the best, median {statistics.median(ratios):.2f}, largest {max(ratios):.2f}; no observer passes in {none}; another choice in {missed}")


if __name__ == "__main__":
    main()
