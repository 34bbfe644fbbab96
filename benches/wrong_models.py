"""What an observer says of wrong readings and wrong models, and how often: the table in the book's page on observers.

    python3 benches/wrong_models.py [--program target/release/palmistry] [--seeds 6]

The four regimes of the shipped scenes, one window of 81 samples over 0.28 s, contacts with a noise of 1e-5 m that is stated, the region of trust from
a guess 10 % off. Each wrong thing is done to the recording (or to the body that made it), and the right one is observed beside it with as
many other seeds again.
"""

import argparse
import collections
import csv
import json
import random
import re
import subprocess
import tempfile
from pathlib import Path

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


def noisy(rows, seed):
    draws = random.Random(seed)
    for row in rows:
        for name in ("s1", "s2"):
            row[name] += draws.gauss(0, NOISE)


STATED = f"[sensor]\nnoise = {NOISE:e}\n"
# what is wrong: what is done to the rows before their noise, and after it, and to the mass
CASES = {
    "nothing": (None, None, 1.0),
    "contacts swapped": (None, swapped, 1.0),
    "in millimetres": (None, millimetres, 1.0),
    "one stuck": (None, stuck, 1.0),
    "both equal": (None, equal, 1.0),
    "random": (None, scattered, 1.0),
    "negated": (None, negated, 1.0),
    "the torque of palm 1 read 1 % too large": (gain, None, 1.0),
    "contacts 1 ms late": (late, None, 1.0),
    "a mass 1 % larger than believed": (None, None, 1.01),
}


def run(program, folder, text, *words):
    path = folder / "scene.toml"
    path.write_text(text)
    return subprocess.run([program, "observe", str(path), *words], capture_output=True, text=True, cwd=ROOT)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "target/release/palmistry"))
    parser.add_argument("--seeds", type=int, default=6)
    options = parser.parse_args()
    print("| what is wrong | said, in so many runs | noticed |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for what, (before, after, mass) in CASES.items():
            words, noticed, runs = collections.Counter(), 0, 0
            for regime in REGIMES:
                record = folder / "record.csv"
                made = run(options.program, folder, scene(regime, mass=mass), "--record", str(record), "--json")
                states = json.loads(made.stdout)["observers"][0]["updates"][0]["states"]
                guess = ", ".join(f"{name} = {1.1 * state['true']!r}" for name, state in states.items())
                with record.open() as file:
                    whole = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
                if before:
                    before(whole)
                for seed in range(1, options.seeds * (4 if what == "nothing" else 1) + 1):
                    rows = [dict(row) for row in whole]
                    noisy(rows, seed)
                    if after:
                        after(rows)
                    with record.open("w", newline="") as file:
                        writer = csv.DictWriter(file, rows[0].keys())
                        writer.writeheader()
                        writer.writerows(rows)
                    told = scene(regime, STATED).replace("guess_off = 0.1", f"guess = {{ {guess} }}")
                    done = run(options.program, folder, told, "--data", str(record), "--json")
                    answer = json.loads(done.stdout) if done.returncode in (0, 1) else None
                    updates = answer["observers"][0]["updates"] if answer else []
                    words[updates[0]["standing"].split(":")[0] if updates else "refused"] += 1
                    noticed += done.returncode != 0
                    runs += 1
            said = ", ".join(f"{word} {count}" for word, count in words.most_common())
            print(f"| {what} | {said} | {noticed} of {runs} |", flush=True)


if __name__ == "__main__":
    main()
