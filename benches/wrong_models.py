"""What an observer says of wrong readings and wrong models, and how often: the table in the book's page on observers.

    python3 benches/wrong_models.py [--program target/release/palmistry] [--seeds 6]

The four regimes of the shipped scenes, one window of 81 samples over 0.28 s, contacts with a noise of 1e-5 m that is stated, the region of trust from
a guess 10 % off. Each wrong thing is done to the recording (or to the body that made it), and the right one is observed beside it with as
many other seeds again. The spring is a system of its own, from the middle of its sample box: 81 samples over 1.6 s, the same noise.

Borne out and wrong is what must not be: an answer that is said to fit and is more than five of its bounds off the truth, where nothing says that
the error cannot be told. Where an error was not noticed the last column says what the program names: the constants, gains and delays from which it cannot be told,
or that an error of this size would not be noticed.
"""

import argparse
import collections
import csv
import json
import math
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Callable, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
SCENES = ROOT / "proofs/moll2002/scenes"
REGIMES = ["same_rate", "one_palm_fixed", "fixed_palms", "general"]
NOISE = 1e-5


def scene(name, sensor="", mass=1.0):
    text = (SCENES / f"{name}.toml").read_text().split("[study.")[0].replace('"../', f'"{SCENES.parent}/')
    ratio = re.search(r"^duration = ([\d.]+).*\nsamples = (\d+)", text, flags=re.M)
    step = float(ratio[1]) / (int(ratio[2]) - 1)
    text = re.sub(r"^duration = [\d.]+", f"duration = {80 * step!r}", text, flags=re.M)
    text = re.sub(r"^samples = \d+", "samples = 81", text, flags=re.M)
    text = re.sub(r"^methods = .*", 'methods = ["trust-region"]', text, flags=re.M)
    text = re.sub(r"^window = .*", "window = 80", text, flags=re.M)
    text = re.sub(r"^steps = .*", "steps = 100", text, flags=re.M)
    text = re.sub(r"^mass = ([\d.]+)", lambda m: f"mass = {float(m[1]) * mass!r}", text, flags=re.M)
    return text.replace("[observer]\n", f"{sensor}[observer]\n")


def swapped(rows):
    for row in rows:
        row["s1"], row["s2"] = row["s2"], row["s1"]


def millimetres(rows):
    for row in rows:
        row["s1"], row["s2"] = 1e3 * row["s1"], 1e3 * row["s2"]


def stuck(rows):
    for row in rows:
        row["s1"] = rows[0]["s1"]


def equal(rows):
    for row in rows:
        row["s2"] = row["s1"]


def scattered(rows):
    for i, row in enumerate(rows):
        row["s1"], row["s2"] = 1 + i * 2**0.5 % 1, 1 + i * 3**0.5 % 1


def negated(rows):
    for row in rows:
        row["s1"], row["s2"] = -row["s1"], -row["s2"]


def gain(rows):
    for row in rows:
        row["tau1"] *= 1.01


def late(rows):
    """A millisecond: the cubic through four neighbours."""
    times = [row["time"] for row in rows]
    for name in ("s1", "s2"):
        read = [row[name] for row in rows]
        for i, row in enumerate(rows):
            first = min(max(i - 2, 0), len(rows) - 4)
            nodes, value = range(first, first + 4), 0.0
            for j in nodes:
                part = read[j]
                for k in nodes:
                    if k != j:
                        part *= (times[i] - 1e-3 - times[k]) / (times[j] - times[k])
                value += part
            row[name] = value


def epoch(rows):
    for row in rows:
        row["time"] += 1.7e9


def one_too_near(rows):
    rows[41]["time"] = rows[40]["time"] + 1e-11


def all_too_near(rows):
    for i, row in enumerate(rows):
        row["time"] = 1.7e9 + i * 1e-11


def noisy(rows, seed):
    draws = random.Random(seed)
    for row in rows:
        for name in ("s1", "s2", "x"):
            if name in row:
                row[name] += draws.gauss(0, NOISE)


STATED = f"[sensor]\nnoise = {NOISE:e}\n"


class Case(NamedTuple):
    """What is done to the rows before their noise, and after it; by what the body's mass exceeds what is believed; and what is wrong then, by the program's names,
    and by how much."""

    before: Callable | None = None
    after: Callable | None = None
    mass: float = 1.0
    names: str = ""
    size: float = 0.0
    is_right: bool = False


CASES = {
    "nothing": Case(is_right=True),
    "contacts swapped": Case(after=swapped),
    "in millimetres": Case(after=millimetres),
    "one stuck": Case(after=stuck),
    "both equal": Case(after=equal),
    "random": Case(after=scattered),
    "negated": Case(after=negated),
    "the torque of palm 1 read 1 % too large": Case(before=gain, names="the gain of tau1", size=0.01),
    "contacts 1 ms late": Case(before=late, names="a delay of s1, s2", size=1e-3),
    "a mass 1 % larger than believed": Case(mass=1.01, names="m", size=0.01),
    "a spring twice as stiff as believed": Case(names="k", size=0.5),
    "times counted from 1.7e9 s ago": Case(after=epoch, is_right=True),
    "one sample 1e-11 s after another": Case(after=one_too_near),
    "all samples 1e-11 s apart, 1.7e9 s from zero": Case(after=all_too_near),
}
SPRING = "a spring twice as stiff as believed"
SPRING_SYSTEM = """system "A mass on a spring"
state x, v
param k = 4
drift f
  x' = v
  v' = -k*x
output x
sample
  x in [-2, 2]
  v in [-2, 2]
"""
SPRING_SCENE = """title = "A mass on a spring"
model = "{model}"
duration = 1.6
samples = 81
{start}[observer]
methods = ["trust-region"]
estimate = ["v"]
known = {{ k = 4 }}
guess = {{ v = 0.1 }}
window = 80
steps = 100
"""


def run(program, folder, text, *words):
    path = folder / "scene.toml"
    path.write_text(text)
    return subprocess.run([program, "observe", str(path), *words], capture_output=True, text=True, cwd=ROOT)


def read(record):
    with record.open() as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def recordings(program, folder, what, case):
    """For each regime: what would be read without noise, the true state, and the scene that observes."""
    record = folder / "record.csv"
    if what == SPRING:
        (folder / "spring.proof").write_text(SPRING_SYSTEM)
        text = SPRING_SCENE.format(model=folder / "spring.proof", start="[start]\nx = 1\nv = 0.5\nk = 8\n").replace("known = { k = 4 }\n", "")
        run(program, folder, text, "--record", str(record), "--json")
        told = SPRING_SCENE.format(model=folder / "spring.proof", start=STATED + '[data]\nrecord = "observed.csv"\n').replace("duration = 1.6\nsamples = 81\n", "")
        yield "spring", read(record), {"v": 0.5}, told
        return
    for regime in REGIMES:
        made = run(program, folder, scene(regime, mass=case.mass), "--record", str(record), "--json")
        states = json.loads(made.stdout)["observers"][0]["updates"][0]["states"]
        truth = {name: state["true"] for name, state in states.items()}
        guess = ", ".join(f"{name} = {1.1 * value!r}" for name, value in truth.items())
        yield regime, read(record), truth, scene(regime, STATED).replace("guess_off = 0.1", f"guess = {{ {guess} }}")


def named(update, case):
    """What the program says of an error of this name that it did not notice; nothing where it says that it would have noticed it."""
    suspect = next((suspect for suspect in update.get("suspects", []) if suspect["what"] == case.names), None)
    if suspect is None:
        return ""
    if suspect["noticed_from"] is None:
        return "leaves no trace"
    if suspect["noticed_from"] > case.size:
        return f"noticed from {suspect['noticed']:.1e} on"
    return ""


def off(update, truth):
    """By how many of its bounds an answer is off."""
    states = update["states"]
    return max(abs(states[name]["recovered"] - value) / states[name]["bound"] if states[name]["bound"] else math.inf for name, value in truth.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "target/release/palmistry"))
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--only", help="rows whose name contains this")
    options = parser.parse_args()
    print("| what is wrong | reported, with the number of runs | status not 0 | borne out and wrong |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for what, case in CASES.items():
            if options.only and options.only not in what:
                continue
            words, noticed, runs, wrong, said = collections.Counter(), 0, 0, 0, collections.Counter()
            for regime, whole, truth, told in recordings(options.program, folder, what, case):
                if case.before:
                    case.before(whole)
                for seed in range(1, options.seeds * (4 if what == "nothing" else 1) + 1):
                    rows = [dict(row) for row in whole]
                    noisy(rows, seed)
                    if case.after:
                        case.after(rows)
                    record = folder / "observed.csv"
                    with record.open("w", newline="") as file:
                        writer = csv.DictWriter(file, rows[0].keys())
                        writer.writeheader()
                        writer.writerows(rows)
                    done = run(options.program, folder, told, "--data", str(record), "--json")
                    answer = json.loads(done.stdout)
                    updates = answer["observers"][0]["updates"] if "observers" in answer else []
                    words[updates[0]["status"].split(":")[0] if updates else "refused"] += 1
                    noticed += done.returncode != 0
                    runs += 1
                    if done.returncode == 0:
                        why = named(updates[0], case) if case.names else ""
                        said[why] += 1
                        is_off = off(updates[0], truth) > 5
                        wrong += is_off and not why
                        if is_off and not why:
                            print(f"# {regime}, seed {seed}: {off(updates[0], truth):.1f} bounds off", file=sys.stderr)
            told = ", ".join(f"{word} {count}" for word, count in words.most_common())
            why = "; ".join(f"{word} {count}" for word, count in said.items() if word)
            print(f"| {what} | {told} | {noticed} of {runs} | {wrong}{'; ' + why if why else ''} |", flush=True)


if __name__ == "__main__":
    main()
