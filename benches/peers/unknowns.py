"""How long the rank takes as the unknowns grow: ours, the plain Python test and StrikePy on families of systems and on
published models.

Each runs in a process of its own on one core, and its processor time is taken, so that what else runs there does not matter
much. Ours is that of the whole process; of the two in Python the start of the interpreter and of its libraries is not
counted: they say themselves how long they took from the text of the file to the rank. Ranks are compared.
"""

import argparse
import json
import math
import os
import platform
import re
import resource
import signal
import subprocess
import sys
import tempfile
import tomllib
from importlib.metadata import version
from pathlib import Path

from differential import theirs
from families import family
from model_files import TABLE, model_path
from unknowns_shown import OURS, PLAIN, STRIKEPY, picture, tables

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BOOK = ROOT / "book/src/measurements.md"
PICTURE = ROOT / "book/src/pictures/unknowns.svg"
SIZES = [15, 24, 60, 100, 150, 200, 300]
CURVES = {  # what the families are called in the book
    "ring": "ring of oscillators, one output",
    "chain": "chain of compartments, one input, one output",
    "lotka_volterra": "Lotka-Volterra, all species measured",
    "masses": "masses between springs, one input, one output",
    "goodwin": "feedback loop, one output",
    "two_inputs": "two inputs on every state, one output",
}
MODELS = """c2m cr bolie two_compartments two_compartments_fed mammillary3 michaelis_menten lotka_volterra_fed
predator_logistic sir_scaled seir_known_n seir2 hiv_load hiv_eta integral_feedback dynamical_compensation goodwin sirs_forced siwr siwr_two
pk1 pharm crauste chemical_network phosphorylation hiv_latent raia bachmann""".split()
QUICK = ["c2m", "two_compartments", "sirs_forced"]


def commands(binary):
    """How each is started on a file, and how its rank, and its own time where it tells one, are read from what it prints."""

    def ours(report):
        rank, final, _ = theirs(report)
        return (rank if final else None), None

    itself = lambda report: (report["rank"], report["seconds"])
    return {
        OURS: ([binary, "rank", "--json", "--samples", "0"], ours),
        PLAIN: ([sys.executable, str(HERE / "generic_rank.py"), "--once"], itself),
        STRIKEPY: ([sys.executable, str(HERE / "peer_strikepy.py")], itself),
    }


def run(command, read, path, limit, rounds):
    """Seconds (least of the rounds), MB at most, and the rank, or why there is none."""
    best = {"seconds": math.inf, "rank": None, "megabytes": 0.0}
    for _ in range(rounds):
        with tempfile.TemporaryFile("w+") as out:
            within = lambda: resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit), math.ceil(limit) + 1))
            process = subprocess.Popen(
                [*command, str(path)], stdout=out, stderr=subprocess.DEVNULL, cwd=HERE, preexec_fn=within
            )
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status
            seconds = usage.ru_utime + usage.ru_stime
            if os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL) or seconds >= limit:
                return {"seconds": None, "rank": None, "megabytes": None, "why": f"over {limit:g} s"}
            out.seek(0)
            text = out.read()
        try:
            rank, own = read(json.loads(text))
        except (json.JSONDecodeError, KeyError):
            rank, own = None, None
        if rank is None:
            return {"seconds": None, "rank": None, "megabytes": None, "why": "no final rank" if text else "fails"}
        best = {"seconds": min(best["seconds"], own or seconds), "rank": rank, "megabytes": usage.ru_maxrss / 1024}
        if seconds > 5:
            break
    return best


def arguments():
    parser = argparse.ArgumentParser(prog="benches/unknowns", description=__doc__)
    parser.add_argument("--binary", default=str(ROOT / "target/release/palmistry"), help="built if it is not given")
    parser.add_argument("--quick", action="store_true", help="up to 60 unknowns, three models, 10 s: whether all works")
    parser.add_argument("--limit", type=float, default=60, help="seconds for each (default %(default)g)")
    parser.add_argument("--rounds", type=int, default=3, help="how often each is timed (default %(default)s)")
    parser.add_argument(
        "--results", type=Path, help="a file in which results are kept: what stands there is not measured again"
    )
    parser.add_argument(
        "--again",
        action="append",
        default=[],
        metavar="PROGRAM",
        help="measure this one again (palmistry, plain Python, StrikePy)",
    )
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="PROGRAM",
        help="measure this one alone, with what was kept of the others",
    )
    parser.add_argument("--book", action="store_true", help="write the tables and the picture into the book")
    parser.add_argument("--json", action="store_true", help="everything, for programs")
    options = parser.parse_args()
    options.sizes, options.models = (SIZES[:3], QUICK) if options.quick else (SIZES, MODELS)
    if options.quick:
        options.limit, options.rounds = min(options.limit, 10), 1
    return options


def main():
    options = arguments()
    if options.binary == str(ROOT / "target/release/palmistry"):
        subprocess.run(["cargo", "build", "--release", "--locked", "--quiet"], cwd=ROOT, check=True)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    os.environ |= dict.fromkeys(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"], "1")
    with tempfile.TemporaryDirectory() as folder:
        measure = Measure(options, folder)
        models = measure_models(options, measure)
        curves = [measure_family(name, options, measure, folder) for name in CURVES]
    report = {"machine": machine(options.binary), "limit": options.limit, "families": curves, "models": models}
    wrong = disagreements(report)
    if options.json:
        print(json.dumps(report, indent=2))
    else:
        print(tables(report))
    if options.book:
        write_book(report)
    for line in wrong:
        print(f"DISAGREES: {line}", file=sys.stderr)
    return 1 if wrong else 0


class Measure:
    """Runs a program on a file, unless its result is kept."""

    def __init__(self, options, folder):
        self.options, self.programs = options, commands(options.binary)
        self.kept = json.loads(options.results.read_text()) if options.results and options.results.exists() else {}
        self.kept = {key: result for key, result in self.kept.items() if key.split(": ")[0] not in options.again}

    def __call__(self, program, name, path):
        key = f"{program}: {name}"
        if key not in self.kept:
            if self.options.only and program not in self.options.only:
                return None
            note(key)
            self.kept[key] = run(*self.programs[program], path, self.options.limit, self.options.rounds)
            if self.options.results:
                whole = self.options.results.with_suffix(".new")  # in one step: another run may read it
                whole.write_text(json.dumps(self.kept, indent=1))
                whole.replace(self.options.results)
        return self.kept[key]


def measure_family(name, options, measure, folder):
    points, tired = [], set()
    for size in options.sizes:
        text = family(name, size)
        path = Path(folder) / f"{name}_{size}.proof"
        path.write_text(text)
        states = text.split("state ", 1)[1].split("\n", 1)[0].count(",") + 1
        point = {"unknowns": states}
        for program in measure.programs:
            point[program] = None if program in tired else measure(program, f"{name} {states}", path)
            if point[program] and point[program]["seconds"] is None:
                tired.add(program)
        points.append(point)
    return {"family": name, "title": CURVES[name], "points": points}


def measure_models(options, measure):
    expected = tomllib.loads(TABLE.read_text())
    found = []
    for name in options.models:
        point = {"model": name, "unknowns": expected[name]["dimension"], "rank": expected[name]["rank"]}
        for program in measure.programs:
            point[program] = measure(program, name, model_path(name))
        found.append(point)
    return found


def disagreements(report):
    points = [
        (f"{curve['family']}, {point['unknowns']} unknowns", point)
        for curve in report["families"]
        for point in curve["points"]
    ]
    points += [(point["model"], point) for point in report["models"]]
    wrong = []
    for name, point in points:
        ranks = {
            program: point[program]["rank"]
            for program in (OURS, PLAIN, STRIKEPY)
            if point[program] and point[program]["rank"] is not None
        }
        if len({*ranks.values(), *([point["rank"]] if "rank" in point else [])}) > 1:
            wrong.append(f"{name}: {ranks}" + (f", expected {point['rank']}" if "rank" in point else ""))
    return wrong


def machine(binary):
    information = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    processor = re.search(r"model name\s*: (.*)", information)
    commit = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return {
        "processor": processor[1] if processor else platform.machine(),
        "palmistry": commit.stdout.strip(),
        "python": platform.python_version(),
    } | {name: version(name) for name in ("numpy", "sympy", "StrikePy", "symbtools")}


def write_book(report):
    """Between the two marks of the chapter."""
    PICTURE.write_text(picture(report))
    text = BOOK.read_text()
    begin, end = "<!-- benches/unknowns -->", "<!-- end -->"
    before, rest = text.split(begin)
    shown = f"![Seconds over unknowns: ours, the plain test, StrikePy](pictures/{PICTURE.name})"
    BOOK.write_text(before + begin + "\n\n" + shown + "\n\n" + tables(report) + "\n\n" + end + rest.split(end, 1)[1])


def note(words):
    if sys.stderr.isatty():
        print(f"\r\033[K{words}", end="", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
