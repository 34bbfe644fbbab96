"""How long the rank takes as the unknowns grow: ours, the plain Python test and StrikePy on families of systems and on published models.

Each runs in a process of its own on one core, and its processor time is taken, so that what else runs there does not matter much. Ours is
that of the whole process; of the two in Python the start of the interpreter and of its libraries is not counted: they say themselves how
long they took from the text of the file to the rank. Ranks are compared.
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

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BOOK = ROOT / "book/src/measurements.md"
PICTURE = ROOT / "book/src/pictures/unknowns.svg"
SIZES = [15, 24, 60, 100, 150, 200, 300]
CURVES = {  # what the families are called in the book
    "ring": "ring of oscillators, one output",
    "chain": "chain of compartments, one input, one output",
    "two_inputs": "two inputs on every state, one output",
    "lotka_volterra": "Lotka-Volterra, all species seen",
    "masses": "masses between springs, one input, one output",
    "goodwin": "feedback loop, one output",
}
MODELS = """c2m cr bolie two_compartments two_compartments_fed mammillary3 michaelis_menten lotka_volterra_fed
predator_logistic sir_scaled seir_known_n seir2 hiv_load hiv_eta integral_feedback dynamical_compensation goodwin sirs_forced siwr siwr_two
pk1 pharm crauste chemical_network phosphorylation hiv_latent raia bachmann""".split()
QUICK = ["c2m", "two_compartments", "sirs_forced"]
OURS, PLAIN, STRIKEPY = "palmistry", "plain Python", "StrikePy"
COLORS = ["#1668a8", "#c8501e", "#2c8a4b", "#8a4bb0", "#a8871a", "#5a5a5a"]


def commands(binary):
    """How each is started on a file, and how its rank, and its own time where it tells one, are read from what it prints."""

    def ours(report):
        rank, final, _ = theirs(report)
        return (rank if final else None), None

    itself = lambda report: (report["rank"], report["seconds"])
    return {
        OURS: ([binary, "rank", "--json"], ours),
        PLAIN: ([sys.executable, str(HERE / "generic_rank.py"), "--once"], itself),
        STRIKEPY: ([sys.executable, str(HERE / "peer_strikepy.py")], itself),
    }


def run(command, read, path, limit, rounds):
    """Seconds (least of the rounds), MB at most, and the rank, or why there is none."""
    best = {"seconds": math.inf, "rank": None, "megabytes": 0.0}
    for _ in range(rounds):
        with tempfile.TemporaryFile("w+") as out:
            within = lambda: resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit), math.ceil(limit) + 1))
            process = subprocess.Popen([*command, str(path)], stdout=out, stderr=subprocess.DEVNULL, cwd=HERE, preexec_fn=within)
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
    parser.add_argument("--results", type=Path, help="a file in which results are kept: what stands there is not measured again")
    parser.add_argument("--again", action="append", default=[], metavar="PROGRAM", help="measure this one again (palmistry, plain Python, StrikePy)")
    parser.add_argument("--only", action="append", default=[], metavar="PROGRAM", help="measure this one alone, with what was kept of the others")
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
                self.options.results.write_text(json.dumps(self.kept, indent=1))
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
    expected = tomllib.loads((ROOT / "tests/models/expected.toml").read_text())
    found = []
    for name in options.models:
        point = {"model": name, "unknowns": expected[name]["dimension"], "rank": expected[name]["rank"]}
        for program in measure.programs:
            point[program] = measure(program, name, ROOT / f"tests/models/{name}.proof")
        found.append(point)
    return found


def disagreements(report):
    points = [(f"{curve['family']}, {point['unknowns']} unknowns", point) for curve in report["families"] for point in curve["points"]]
    points += [(point["model"], point) for point in report["models"]]
    wrong = []
    for name, point in points:
        ranks = {program: point[program]["rank"] for program in (OURS, PLAIN, STRIKEPY) if point[program] and point[program]["rank"] is not None}
        if len({*ranks.values(), *([point["rank"]] if "rank" in point else [])}) > 1:
            wrong.append(f"{name}: {ranks}" + (f", expected {point['rank']}" if "rank" in point else ""))
    return wrong


def machine(binary):
    information = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    processor = re.search(r"model name\s*: (.*)", information)
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True, check=False)
    return {
        "processor": processor[1] if processor else platform.machine(), "palmistry": commit.stdout.strip(), "python": platform.python_version(),
    } | {name: version(name) for name in ("numpy", "sympy", "StrikePy", "symbtools")}


def seconds(result, reference=None):
    if result is None:
        return ""
    if result["seconds"] is None:
        return result["why"]
    ratio = f" ({figures(result['seconds'] / reference['seconds'])})" if reference and reference["seconds"] else ""
    return f"{figures(result['seconds'])}{ratio}"


def figures(value):
    """Two digits, and no decimals from ten on."""
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}" if value >= 1 else f"{value:.2g}"


def tables(report):
    lines = ["| seconds of the processor (ratio to ours) | unknowns | palmistry | its memory, MB | plain Python | StrikePy |", "|---|---:|---:|---:|---:|---:|"]
    for curve in report["families"]:
        for point in curve["points"]:
            ours = point.get(OURS)
            memory = "" if not ours or ours["megabytes"] is None else f"{ours['megabytes']:.0f}"
            lines.append(f"| {curve['title']} | {point['unknowns']} | {seconds(ours)} | {memory} | {seconds(point.get(PLAIN), ours)} | "
                         f"{seconds(point.get(STRIKEPY), ours)} |")
    done = [point for point in report["models"] if point[STRIKEPY] and point[STRIKEPY]["seconds"] is not None]
    lines += ["", f"Of {len(report['models'])} published models (`tests/models`) with {min(p['unknowns'] for p in report['models'])} to "
              f"{max(p['unknowns'] for p in report['models'])} unknowns StrikePy decides {len(done)} within {report['limit']:g} s; "
              f"{summary(report, OURS)}, {summary(report, PLAIN)}.", "",
              "| model | unknowns | rank | palmistry | plain Python | StrikePy |", "|---|---:|---:|---:|---:|---:|"]
    for point in report["models"]:
        ours = point[OURS]
        lines.append(f"| {point['model']} | {point['unknowns']} | {point['rank']} | {seconds(ours)} | {seconds(point[PLAIN], ours)} | "
                     f"{seconds(point[STRIKEPY], ours)} |")
    return "\n".join([*lines, "", headline(report)])


def summary(report, program):
    times = [point[program]["seconds"] for point in report["models"] if point[program] and point[program]["seconds"] is not None]
    return f"{program} {len(times)} in {figures(sum(times))} s altogether"


def headline(report):
    machine = report["machine"]
    return (f"{machine['processor']}, one core; palmistry {machine['palmistry']}; Python {machine['python']}, numpy {machine['numpy']}, "
            f"sympy {machine['sympy']}, StrikePy {machine['StrikePy']}, symbtools {machine['symbtools']}; ours as a whole process, "
            "the two in Python without the start of their interpreter; least of three.")


def picture(report):
    """Seconds over unknowns, both on logarithmic axes: ours drawn through, the plain test dashed, StrikePy as dots."""
    width, height, left, bottom, top, right = 720, 400, 60, 50, 20, 230
    points = [(point["unknowns"], result["seconds"]) for curve in report["families"] for point in curve["points"]
              for result in (point.get(OURS), point.get(PLAIN), point.get(STRIKEPY)) if result and result["seconds"]]
    low, high = math.floor(math.log10(min(y for _, y in points))), math.ceil(math.log10(max(y for _, y in points)))
    first, last = math.log10(min(x for x, _ in points)), math.log10(max(x for x, _ in points))
    across = lambda x: left + (math.log10(x) - first) / (last - first) * (width - left - right)
    up = lambda y: height - bottom - (math.log10(y) - low) / (high - low) * (height - bottom - top)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" aria-label="seconds over unknowns" '
           'font-family="system-ui,sans-serif" font-size="12">', '<rect width="100%" height="100%" rx="8" fill="#fff"/>']
    for power in range(low, high + 1):
        y = up(10.0**power)
        out.append(f'<path d="M{left} {y:.1f}H{width - right}" stroke="#ddd"/><text x="{left - 6}" y="{y + 4:.1f}" '
                   f'text-anchor="end">{10.0**power:g} s</text>')
    for x in sorted({point["unknowns"] for point in report["families"][0]["points"]}):
        out.append(f'<text x="{across(x):.1f}" y="{height - bottom + 18}" text-anchor="middle">{x}</text>')
    out.append(f'<text x="{(left + width - right) / 2:.0f}" y="{height - 12}" text-anchor="middle">unknowns</text>')
    for color, curve in zip(COLORS, report["families"]):
        for program, dash in ((OURS, ""), (PLAIN, ' stroke-dasharray="5 4"')):
            line = " ".join(f"{across(p['unknowns']):.1f},{up(p[program]['seconds']):.1f}" for p in curve["points"]
                            if p.get(program) and p[program]["seconds"])
            if line:
                out.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="2"{dash}/>')
        for point in curve["points"]:
            if point.get(STRIKEPY) and point[STRIKEPY]["seconds"]:
                out.append(f'<circle cx="{across(point["unknowns"]):.1f}" cy="{up(point[STRIKEPY]["seconds"]):.1f}" r="4" fill="{color}"/>')
    for row, (color, curve) in enumerate(zip(COLORS, report["families"])):
        y = top + 20 + 20 * row
        out.append(f'<path d="M{width - right + 14} {y}h20" stroke="{color}" stroke-width="3"/>'
                   f'<text x="{width - right + 40}" y="{y + 4}">{curve["title"].split(",")[0]}</text>')
    y = top + 30 + 20 * len(report["families"])
    for row, words in enumerate(["through: palmistry", "dashed: plain Python, numpy", f"dots: StrikePy, within {report['limit']:g} s"]):
        out.append(f'<text x="{width - right + 14}" y="{y + 18 * row}">{words}</text>')
    return "\n".join([*out, "</svg>"]) + "\n"


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
