"""Observers beside each other on the same recordings: ours, scipy's least squares by shooting, CasADi with IPOPT by multiple shooting, and
filterpy's unscented filter. Three tables: the systems of examples/systems from the middle of the sample box, over several
recordings; the same from random guesses in it (--random); and bodies between palms, from random guesses (--palms).

A method has arrived that is, in all that is sought, within five of the bound's deviations of the truth or one percent of its size (the
larger of the truth and the half of its range; between palms of the truth); methods by windows at the first sample, filters at the last one.
"""

import argparse
import hashlib
import json
import math
import os
import random
import signal
import statistics
import subprocess
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np

import observed_palms
from observed import FILTERS, ROOT, Observers, recording_of, scene
from observed_systems import SYSTEMS
from observer_peers import FILTERPY, PEERS, alone

BOOK = ROOT / "book/src/measurements.md"
RELEASE = ROOT / "target/release/palmistry"
OURS = ["multiple-shooting", "trust-region", "newton", "kalman", "unscented"]
# what the library is made of: the last commit that touched any of it is the program's
SOURCES = ["src", "crates", "proofs", "Cargo.toml", "Cargo.lock", "build.rs"]


def arguments():
    parser = argparse.ArgumentParser(prog="benches/observe-compare", description=__doc__)
    parser.add_argument("--binary", default=str(RELEASE), help="built if it is not given")
    parser.add_argument("--quick", action="store_true", help="two recordings or guesses: whether all works")
    parser.add_argument("--recordings", type=int, default=20, help="recordings with noise of each system, from the middle of the box (default %(default)s)")
    parser.add_argument("--random", type=int, default=0, metavar="GUESSES", help="random guesses for each system and noise instead, on one recording")
    parser.add_argument("--palms", type=int, default=0, metavar="GUESSES", help="bodies between palms instead, random guesses for each regime and noise")
    parser.add_argument("--limit", type=float, default=60, help="seconds of the processor for each (default %(default)g)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", action="append", default=[], metavar="SYSTEM", help="measure this system alone")
    parser.add_argument("--remark", default="", help="what is to be said of the machine besides, as that others used it")
    parser.add_argument("--book", action="store_true", help="write the table into the book, each of the three in its own place")
    parser.add_argument("--json", action="store_true", help="everything, for programs")
    parser.add_argument("--from", dest="runs", action="append", default=[], metavar="FILE", help="measure nothing: the table of what --json wrote, of one or more runs")
    options = parser.parse_args()
    if options.quick:
        options.recordings, options.random, options.palms = (min(count, 2) for count in (options.recordings, options.random, options.palms))
    return options


def judge(system, data, is_filter, found):
    """Whether it has arrived, and the root of the mean square of the errors in deviations of the bound."""
    if found is None:
        return False, None
    truth = data["truth"][1 if is_filter else 0]
    error = np.abs(np.array(found) - truth)
    for i, name in enumerate(system.box):
        if name in system.angles:
            error[i] = abs((found[i] - truth[i] + math.pi) % (2 * math.pi) - math.pi)
    sought = [i for i, name in enumerate(system.box) if not system.sought or name in system.sought]
    size = np.abs(truth)
    if not system.sought:
        size = np.maximum(size, [(high - low) / 2 for low, high in system.box.values()])
    near = error <= np.fmax(5 * data["bound"], 0.01 * size)
    arrived = bool(np.isfinite(error[sought]).all() and near[sought].all())
    if is_filter or not arrived:
        return arrived, None
    return arrived, float(np.sqrt(np.mean((error[sought] / data["bound"][sought]) ** 2)))


def measured(options, folder):
    """A line for each system, noise, recording or guess, and method, and what there is to say of their number: the first trial of all, then the second,
    so that an interrupt leaves even counts."""
    observers = Observers(options.binary, math.ceil(options.limit), Path(folder))
    systems = [system for system in (observed_palms.REGIMES if options.palms else SYSTEMS) if not options.only or system.name in options.only]
    draws = {(system.name, noisy): random.Random(options.seed) for system in systems for noisy in (False, True)}
    found = []
    try:
        for trial in range(options.palms or options.random or options.recordings):
            for system in systems:
                for noisy in (False, True):
                    # without noise all recordings are one
                    seed = options.seed + (trial if noisy and not options.random else 0)
                    if noisy or trial == 0 or options.palms or options.random:
                        found += tried(options, observers, system, noisy, seed, draws[system.name, noisy])
            print(f"{trial + 1} of each", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        print("interrupted: the table of what was measured", file=sys.stderr)
        return found, " (interrupted: so many as each cell says)"
    return found, ""


def tried(options, observers, system, noisy, seed, draws):
    """One recording and one guess, by all methods."""
    if options.palms:
        system, data, guess = observed_palms.recording_of(observers, system, noisy, seed, draws)
        runs = observed_palms.runs(observers, system, data, guess, options)
    else:
        data = recording_of(observers, system, noisy, seed)
        guess = {name: draws.uniform(low, high) if options.random else (low + high) / 2 for name, (low, high) in system.box.items()}
        runs = [(method, *observers.recover(system, method, scene(system, noisy, guess, method, seed))) for method in OURS]
        runs += [(method, *alone(method, system, data, np.array(list(guess.values())), options.limit)) for method in PEERS]
    for method, state, seconds, memory in runs:
        arrived, ratio = judge(system, data, method in FILTERS or method == FILTERPY, state)
        told = {"system": system.name, "noisy": noisy, "seed": seed, "method": method, "arrived": arrived}
        yield told | {"error_over_bound": ratio, "seconds": seconds, "memory": memory}


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
    names, methods = (list(dict.fromkeys(run[of] for run in runs)) for of in ("system", "method"))
    head = "arrived, error over bound, time" if noisy else "arrived, time"
    lines = [f"| {'with noise' if noisy else 'without noise'}: {head} | " + " | ".join(name.replace("_", " ") for name in names) + " | memory |"]
    lines.append("|---|" + "---:|" * (len(names) + 1))
    for method in methods:
        own = [run for run in runs if run["method"] == method and run["noisy"] == noisy]
        cells = [cell([run for run in own if run["system"] == name], noisy) for name in names]
        label = method if method in PEERS else f"palmistry, {method}"
        most = f"{max(run['memory'] for run in own) / 1e6:.0f} MB" if own else ""
        lines.append(f"| {label} | " + " | ".join(cells) + f" | {most} |")
    return "\n".join(lines)


def machine(binary):
    """The processor, the program by its digest and the commit that it was built from, and the peers."""
    cpu = "a processor"
    if os.path.exists("/proc/cpuinfo"):
        cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), cpu)
    git = lambda *words: subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True).stdout.strip()
    program = Path(binary)
    # of a program that was built elsewhere: the last commit of its sources before it was written
    since = [] if program == RELEASE else [f"--before={int(program.stat().st_mtime)}"]
    commit = git("log", "-1", "--format=%h", *since, "--", *SOURCES)
    if program == RELEASE and git("status", "--porcelain", "--", *SOURCES):
        commit += " with changes"
    digest = hashlib.sha256(program.read_bytes()).hexdigest()[:12]
    peers = ", ".join(f"{name} {version(name)}" for name in ("scipy", "casadi", "filterpy", "numpy"))
    return f"{cpu}, one core; palmistry {commit} (SHA-256 of the program {digest}...); Python {sys.version.split()[0]}, {peers}"


def how(options):
    if options.palms:
        kind = f"{options.palms} random guesses for each regime, with noise of {observed_palms.NOISE:g} m each on a recording of its own"
    elif options.random:
        kind = f"{options.random} random guesses each, all on one recording"
    else:
        kind = f"from the middle of the box, {options.recordings} recordings with noise"
    return f"{kind}, seeds from {options.seed} on, {options.limit:g} s at most"


def main():
    options = arguments()
    if options.runs:
        told = [json.loads(Path(file).read_text()) for file in options.runs]
        together = {of: "; ".join(dict.fromkeys(part[of] for part in told)) for of in ("machine", "how", "block", "remark")}
        tell(options, together | {"runs": [run for part in told for run in part["runs"]]})
        return
    if options.binary == str(RELEASE):
        subprocess.run(["cargo", "build", "--release", "--locked", "--quiet"], cwd=ROOT, check=True)
    os.environ |= dict.fromkeys(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"], "1")
    # a shell's background job ignores interrupts unless it is told
    for stop in (signal.SIGINT, signal.SIGTERM):
        signal.signal(stop, signal.default_int_handler)
    # before anything is measured: the program may be another one afterwards
    head = {"machine": machine(options.binary), "how": how(options), "remark": options.remark}
    head["block"] = "palms" if options.palms else "random" if options.random else "middle"
    with tempfile.TemporaryDirectory() as folder:
        runs, remark = measured(options, folder)
        tell(options, head | {"runs": runs, "how": head["how"] + remark})


def tell(options, told):
    runs = told["runs"]
    text = f"{table(runs, False)}\n\n{table(runs, True)}\n\n{told['machine']}; {told['how']}. Times are medians, of the processor, ours of the whole process, the others' without loading their libraries; memory is the most that any run's process held, of the others with Python and the libraries."
    text += f" {told['remark']}\n" if told["remark"] else "\n"
    print(json.dumps(told, indent=1) if options.json else text)
    if options.book:
        begin, end = (f"<!-- {word}observe-compare, {told['block']} -->" for word in ("", "end "))
        book = BOOK.read_text()
        if begin not in book:
            raise SystemExit(f"{BOOK}: {begin} is missing, where the table is to stand")
        before, rest = book.split(begin)
        _, after = rest.split(end)
        BOOK.write_text(f"{before}{begin}\n\n{text}\n{end}{after}")


if __name__ == "__main__":
    main()
