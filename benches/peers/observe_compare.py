"""Observers from the middle of the sample box, over several recordings, or from random guesses in it (--random): ours, scipy's least squares by shooting, CasADi with IPOPT by multiple shooting, and
filterpy's unscented filter, on the same recordings.

A method has arrived that is, in all that is sought, within five of the bound's deviations of the truth or one percent of its size (the
larger of the truth and the half of its range); methods by windows at the first sample, filters at the last one.
"""

import argparse
import csv
import json
import math
import os
import random
import re
import resource
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import casadi
import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from observed_systems import SYSTEMS

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples/systems"
BOOK = ROOT / "book/src/measurements.md"
BEGIN, END = "<!-- benches/observe-compare -->", "<!-- end observe-compare -->"
OURS = ["multiple-shooting", "trust-region", "newton", "kalman", "unscented"]
FILTERS = {"kalman", "unscented", "filterpy, unscented"}
SCIPY, CASADI, FILTERPY = "scipy, least squares by shooting", "CasADi, IPOPT, multiple shooting", "filterpy, unscented"


def arguments():
    parser = argparse.ArgumentParser(prog="benches/observe-compare", description=__doc__)
    parser.add_argument("--binary", default=str(ROOT / "target/release/palmistry"), help="built if it is not given")
    parser.add_argument("--quick", action="store_true", help="two guesses: whether all works")
    parser.add_argument("--recordings", type=int, default=20, help="recordings with noise of each system, from the middle of the box (default %(default)s)")
    parser.add_argument("--random", type=int, default=0, metavar="GUESSES", help="random guesses for each system and noise instead, on one recording")
    parser.add_argument("--limit", type=float, default=60, help="seconds of the processor for each (default %(default)g)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", action="append", default=[], metavar="SYSTEM", help="measure this system alone")
    parser.add_argument("--remark", default="", help="what is to be said of the machine besides, as that others used it")
    parser.add_argument("--book", action="store_true", help="write the table into the book")
    parser.add_argument("--json", action="store_true", help="everything, for programs")
    parser.add_argument("--from", dest="runs", action="append", default=[], metavar="FILE", help="measure nothing: the table of what --json wrote, of one or more runs")
    options = parser.parse_args()
    if options.quick:
        options.recordings, options.random = min(options.recordings, 2), min(options.random, 2)
    return options


def scene(system, noisy, guess, method, seed):
    """The system's scene with another method, guess, noise and seed."""
    text = (FOLDER / f"{system.name}.toml").read_text()
    text = re.sub(r'^model = "', f'model = "{FOLDER}/', text, flags=re.M)
    text = re.sub(r"^methods = .*$", f'methods = ["{method}"]', text, flags=re.M)
    if not noisy:
        text = re.sub(r"^noise = .*$", "noise = 0", text, flags=re.M)
    text = re.sub(r"^duration", f"seed = {seed}\nduration", text, flags=re.M)
    values = ", ".join(f"{name} = {value!r}" for name, value in guess.items())
    return re.sub(r"^window = ", f"guess = {{ {values} }}\nwindow = ", text, flags=re.M)


def observe(options, path, more=()):
    most = math.ceil(options.limit)
    run = subprocess.run(
        [options.binary, "observe", str(path), "--json", *more],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (most, most)),
    )
    if run.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        raise TimeoutError
    if run.returncode > 1:
        raise RuntimeError(run.stdout + run.stderr)
    return json.loads(run.stdout)


def recording(options, system, noisy, seed, folder):
    """Times, readings a row a sample, the truth at the first and the last sample, noise, and the bound at the first."""
    text = (FOLDER / f"{system.name}.toml").read_text()
    start = {name: float(value) for name, value in re.findall(r"^(\w+) = (-?[\d.e-]+)$", text.split("[start]")[1].split("[")[0], re.M)}
    path, record, motion = (Path(folder) / name for name in ("scene.toml", "record.csv", "motion.csv"))
    path.write_text(scene(system, noisy, start, "trust-region", seed))
    found = observe(options, path, ["--record", str(record), "--motion", str(motion)])
    rows = list(csv.reader(record.open()))[1:]
    outputs = len(system.read)
    times = np.array([float(row[0]) for row in rows])
    read = np.array([[float(value) for value in row[1 : 1 + outputs]] for row in rows])
    table = list(csv.DictReader(motion.open()))
    truth = [np.array([float(row[name]) for name in system.box]) for row in (table[0], table[-1])]
    states = found["observers"][0]["updates"][0]["states"]
    bound = np.array([states[name]["bound"] or math.inf for name in system.box])
    sigma = found["sensor"]["noise"]
    return {"times": times, "read": read, "truth": truth, "bound": bound, "sigma": sigma or 1e-9}


def ours(options, system, noisy, guess, method, seed, folder):
    path = Path(folder) / "guess.toml"
    path.write_text(scene(system, noisy, guess, method, seed))
    observer = observe(options, path)["observers"][0]
    told = observer["end"] if method in FILTERS else observer["updates"][0]
    states = told["states"] if told else {}
    values = [states[name]["recovered"] for name in system.box]
    return np.array([math.nan if value is None else value for value in values], dtype=float)


def by_scipy(system, data, guess, limit):
    times, read = data["times"], data["read"]
    end = time.process_time() + limit

    def residual(state):
        if time.process_time() > end:
            raise TimeoutError
        def rates(t, s):
            if time.process_time() > end:
                raise TimeoutError
            found = np.array(system.rates(np, s, system.inputs(t)), dtype=float)
            if not np.isfinite(found).all():
                # scipy shortens a step that is no number for ever
                raise FloatingPointError
            return found

        try:
            path = solve_ivp(rates, (times[0], times[-1]), state, t_eval=times, rtol=1e-8, atol=1e-10, method="DOP853")
        except (ValueError, FloatingPointError):
            return np.full(read.size, 1e6)
        if path.y.shape[1] != len(times) or not np.isfinite(path.y).all():
            return np.full(read.size, 1e6)
        seen = np.array(system.outputs(np, path.y)).T
        return ((seen - read) / data["spread"]).ravel()

    scale = [(high - low) / 2 for low, high in system.box.values()]
    return least_squares(residual, guess, x_scale=scale, xtol=1e-12, ftol=1e-12, gtol=1e-12, max_nfev=200).x


def by_casadi(system, data, guess, limit):
    """A node at every sample, four steps of Runge and Kutta between two, constants once; nodes begin at the guess, and at what is read."""
    times, read = data["times"], data["read"]
    names = list(system.box)
    constants = [i for i, name in enumerate(names) if name in {"mu", "sigma", "r", "b", "a1", "a2", "beta", "gamma", "load"}]
    moving = [i for i in range(len(names)) if i not in constants]
    scale = np.array([max(abs(low), abs(high)) for low, high in system.box.values()])
    problem = casadi.Opti()
    nodes = problem.variable(len(moving), len(times))
    values = problem.variable(max(len(constants), 1))

    def whole(column):
        state = [None] * len(names)
        for k, i in enumerate(moving):
            state[i] = column[k] * scale[i]
        for k, i in enumerate(constants):
            state[i] = values[k] * scale[i]
        return state

    def step(state, t, h):
        add = lambda a, b, k: [x + k * y for x, y in zip(a, b)]
        k1 = system.rates(casadi, state, system.inputs(t))
        k2 = system.rates(casadi, add(state, k1, h / 2), system.inputs(t + h / 2))
        k3 = system.rates(casadi, add(state, k2, h / 2), system.inputs(t + h / 2))
        k4 = system.rates(casadi, add(state, k3, h), system.inputs(t + h))
        return [s + h / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4)]

    cost = 0
    for k, t in enumerate(times):
        state = whole(nodes[:, k])
        for seen, value, spread in zip(system.outputs(casadi, state), read[k], data["spread"]):
            cost += ((seen - value) / spread) ** 2
        if k + 1 < len(times):
            h = (times[k + 1] - t) / 4
            for part in range(4):
                state = step(state, t + part * h, h)
            problem.subject_to(nodes[:, k + 1] == casadi.vertcat(*[state[i] / scale[i] for i in moving]))
    # what has one sign in the sample box keeps it, so that roots exist
    for k, i in enumerate(moving):
        if system.box[names[i]][0] >= 0:
            problem.subject_to(nodes[k, :] >= 1e-6)
    for k, i in enumerate(constants):
        low, high = system.box[names[i]]
        problem.subject_to(problem.bounded(low / 100 / scale[i], values[k], (2 * high - low) / scale[i]))
    first = np.array([[guess[i] / scale[i]] * len(times) for i in moving])
    for output, place in enumerate(system.read):
        if place is not None:
            first[moving.index(place)] = read[:, output] / scale[place]
    problem.set_initial(nodes, first)
    problem.set_initial(values, [guess[i] / scale[i] for i in constants] or [0])
    if not constants:
        problem.subject_to(values == 0)
    problem.minimize(cost)
    quiet = {"print_level": 0, "max_cpu_time": limit, "max_iter": 500, "tol": 1e-10, "sb": "yes"}
    problem.solver("ipopt", {"print_time": False}, quiet)
    try:
        problem.solve()
    except RuntimeError:
        pass
    found = np.empty(len(names))
    found[moving] = problem.debug.value(nodes[:, 0]) * scale[moving]
    if constants:
        found[constants] = problem.debug.value(values) * scale[constants]
    return found


def by_filterpy(system, data, guess, limit):
    times, read = data["times"], data["read"]
    n = len(guess)
    size = np.array([max((high - low) / 2, abs(value)) for (low, high), value in zip(system.box.values(), guess)])

    def follow(state, dt, t):
        h = dt / 8
        for part in range(8):
            now = t + part * h
            rate = lambda s, at: np.array(system.rates(np, s, system.inputs(at)), dtype=float)
            k1 = rate(state, now)
            k2 = rate(state + h / 2 * k1, now + h / 2)
            k3 = rate(state + h / 2 * k2, now + h / 2)
            k4 = rate(state + h * k3, now + h)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return state

    points = MerweScaledSigmaPoints(n, alpha=0.1, beta=2.0, kappa=3.0 - n)
    estimate = UnscentedKalmanFilter(n, read.shape[1], times[1] - times[0], hx=lambda s: np.array(system.outputs(np, s)), fx=follow, points=points)
    estimate.x = np.array(guess, dtype=float)
    estimate.P = np.diag((0.5 * size) ** 2)
    estimate.R = np.eye(read.shape[1]) * max(data["sigma"], 1e-6) ** 2
    estimate.update(read[0])
    for k in range(1, len(times)):
        dt = times[k] - times[k - 1]
        estimate.Q = np.diag((0.01 * size) ** 2 * dt)
        estimate.predict(dt=dt, t=times[k - 1])
        estimate.update(read[k])
    return estimate.x


PEERS = {SCIPY: by_scipy, CASADI: by_casadi, FILTERPY: by_filterpy}


def judge(system, data, method, found):
    """Whether it has arrived, and the root of the mean square of the errors in deviations of the bound."""
    truth = data["truth"][1 if method in FILTERS else 0]
    error = np.abs(found - truth)
    for i, name in enumerate(system.box):
        if name in system.angles:
            error[i] = abs((found[i] - truth[i] + math.pi) % (2 * math.pi) - math.pi)
    size = np.maximum(np.abs(truth), [(high - low) / 2 for low, high in system.box.values()])
    arrived = bool(np.isfinite(error).all() and (error <= np.maximum(5 * data["bound"], 0.01 * size)).all())
    ratio = None if method in FILTERS else float(np.sqrt(np.mean((error / data["bound"]) ** 2)))
    return arrived, ratio


def processor():
    """Seconds of the processor so far, of this process and those that it waited for: what others do on the machine is not in it."""
    spent = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(own.ru_utime + own.ru_stime for own in spent)


def measured(options, folder):
    found = []
    for system in SYSTEMS:
        if options.only and system.name not in options.only:
            continue
        for noisy in (False, True):
            draws = random.Random(options.seed)
            middle = {name: (low + high) / 2 for name, (low, high) in system.box.items()}
            if options.random:
                one = lambda: {name: draws.uniform(low, high) for name, (low, high) in system.box.items()}
                trials = [(options.seed, one()) for _ in range(options.random)]
            else:
                # without noise all recordings are one
                trials = [(options.seed + k, middle) for k in range(options.recordings if noisy else 1)]
            data, of = None, None
            for seed, guess in trials:
                if of != seed:
                    data, of = recording(options, system, noisy, seed, folder), seed
                    data["spread"] = np.maximum((data["read"].max(0) - data["read"].min(0)) / 2, 1e-9)
                for method in [*OURS, *PEERS]:
                    begin = processor()
                    try:
                        if method in OURS:
                            state = ours(options, system, noisy, guess, method, seed, folder)
                        else:
                            with warnings.catch_warnings(), np.errstate(all="ignore"):
                                warnings.simplefilter("ignore")
                                state = PEERS[method](system, data, np.array(list(guess.values())), options.limit)
                        arrived, ratio = judge(system, data, method, state)
                    except (TimeoutError, np.linalg.LinAlgError, ValueError):
                        arrived, ratio = False, None
                    took = processor() - begin
                    found.append({"system": system.name, "noisy": noisy, "method": method, "arrived": arrived, "error_over_bound": ratio, "seconds": took, "seed": seed})
            print(f"{system.name}, {'noise' if noisy else 'no noise'}: done", file=sys.stderr, flush=True)
    return found


def duration(seconds):
    return f"{1e3 * seconds:.0f} ms" if seconds < 1 else f"{seconds:.1f} s"


def cell(runs, noisy):
    if not runs:
        return ""
    arrived = [run for run in runs if run["arrived"]]
    parts = [f"{len(arrived)} of {len(runs)}"]
    ratios = [run["error_over_bound"] for run in arrived if run["error_over_bound"] is not None]
    if noisy and ratios:
        # of recordings with errors of their own the root of the mean square, which is one of who is as good as can be
        parts.append(f"{math.sqrt(statistics.fmean(ratio**2 for ratio in ratios)):.2f}")
    parts.append(duration(statistics.median(run["seconds"] for run in runs)))
    return ", ".join(parts)


def table(runs, noisy):
    names = list(dict.fromkeys(run["system"] for run in runs))
    head = "arrived, error over bound, time" if noisy else "arrived, time"
    lines = [f"| {'with noise' if noisy else 'without noise'}: {head} | " + " | ".join(name.replace("_", " ") for name in names) + " |"]
    lines.append("|---|" + "---:|" * len(names))
    for method in [*OURS, *PEERS]:
        own = [run for run in runs if run["method"] == method and run["noisy"] == noisy]
        cells = [cell([run for run in own if run["system"] == name], noisy) for name in names]
        label = f"palmistry, {method}" if method in OURS else method
        lines.append(f"| {label} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def machine():
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "a processor") if os.path.exists("/proc/cpuinfo") else "a processor"
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True).stdout.strip()
    from importlib.metadata import version

    peers = ", ".join(f"{name} {version(name)}" for name in ("scipy", "casadi", "filterpy", "numpy"))
    return f"{cpu}, one core; palmistry {commit}; Python {sys.version.split()[0]}, {peers}"


def main():
    options = arguments()
    if options.runs:
        tell(options, [run for file in options.runs for run in json.loads(Path(file).read_text())])
        return
    if options.binary == str(ROOT / "target/release/palmistry"):
        subprocess.run(["cargo", "build", "--release", "--locked", "--quiet"], cwd=ROOT, check=True)
    os.environ |= dict.fromkeys(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"], "1")
    with tempfile.TemporaryDirectory() as folder:
        runs = measured(options, folder)
    tell(options, runs)


def tell(options, runs):
    if options.json:
        print(json.dumps(runs, indent=1))
        return
    how = f"{options.random} random guesses each" if options.random else "from the middle of the box, on so many recordings as each cell says"
    remark = f" {options.remark}" if options.remark else ""
    text = f"{table(runs, False)}\n\n{table(runs, True)}\n\n{machine()}; {how}, seeds from {options.seed} on, {options.limit:g} s at most; times are medians, of the processor, ours of the whole process.{remark}\n"
    print(text)
    if options.book:
        book = BOOK.read_text()
        before, rest = book.split(BEGIN)
        _, after = rest.split(END)
        BOOK.write_text(f"{before}{BEGIN}\n\n{text}\n{END}{after}")


if __name__ == "__main__":
    main()
