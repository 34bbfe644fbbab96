"""The published models with their answers and times: how long palmistry takes for all claims of a file and for the rank, and
StrikePy for the rank, each in a process of its own on one core by its processor time; ranks are compared.

Those of proofs/benchmarks have claims; the others are those of tests/models that benches/unknowns measures.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

from differential import is_seen, theirs
from model_files import BENCHMARKS, TABLE, model_path
from unknowns import MODELS, ROOT, Measure, commands, machine
from unknowns_shown import OURS, STRIKEPY, figures, seconds

BOOK = ROOT / "book/src/benchmarks.md"
CLAIMS = "palmistry, claims"
BEGIN, END = "<!-- benches/benchmarks -->", "<!-- end -->"


def programs(binary):
    """As for the unknowns, without the plain test, and with all claims of a file."""

    def claims(report):
        words = [claim["verdict"] for claim in report["claims"]]
        return (len(words) if report["ok"] else None), None

    ranks = commands(binary)
    return {OURS: ranks[OURS], STRIKEPY: ranks[STRIKEPY], CLAIMS: ([binary, "prove", "--json"], claims)}


def arguments():
    parser = argparse.ArgumentParser(prog="benches/benchmarks", description=__doc__)
    parser.add_argument("--binary", default=str(ROOT / "target/release/palmistry"), help="built if it is not given")
    parser.add_argument("--quick", action="store_true", help="three models, 10 s: whether all works")
    parser.add_argument("--limit", type=float, default=60, help="seconds for each (default %(default)g)")
    parser.add_argument("--rounds", type=int, default=3, help="how often each is timed (default %(default)s)")
    parser.add_argument("--results", type=Path, help="a file in which results are kept: what stands there is not measured again")
    parser.add_argument("--again", action="append", default=[], metavar="PROGRAM", help="measure this one again")
    parser.add_argument(
        "--only", action="append", default=[], metavar="PROGRAM", help="measure this one alone, with what was kept of the others"
    )
    parser.add_argument("--remark", default="", help="what is to be said of the machine besides, as that others used it")
    parser.add_argument("--book", action="store_true", help="write the table into the book")
    parser.add_argument("--json", action="store_true", help="everything, for programs")
    options = parser.parse_args()
    options.models = [*MODELS, *sorted(path.stem for path in BENCHMARKS.glob("*.proof") if path.stem not in MODELS)]
    # short files first: a run that is cut off has most of them
    options.models.sort(key=lambda name: len(model_path(name).read_text()))
    if options.quick:
        options.models, options.rounds, options.limit = ["c2m", "sirs_forced", "lorenz"], 1, min(options.limit, 10)
    return options


def without_claims(path, folder):
    """A copy of a file for those who are asked for the rank alone."""
    text = path.read_text()
    end = re.search(r"^(claim|erratum) ", text, re.MULTILINE)
    copy = Path(folder) / path.name
    copy.write_text(text[: end.start()] if end else text)
    return copy


def answer(binary, path):
    """Unknowns, rank, and which unknowns are not seen, as `rank` tells them."""
    run = subprocess.run(
        [binary, "rank", "--json", "--samples", "0", str(path)], capture_output=True, text=True, check=True
    )
    report = json.loads(run.stdout)
    rank, final, words = theirs(report)
    unseen = [name for name, word in words.items() if is_seen(word) is False]
    return {"unknowns": report["dimension"], "rank": rank if final else None, "not_seen": unseen}


def solutions(binary, path, limit):
    """How many values of each unknown that is seen give the same outputs, in words, and the wall time."""
    begin = time.monotonic()
    try:
        run = subprocess.run([binary, "rank", "--global", "--json", str(path)], capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return f"more than {limit:g} s"
    took = f"{figures(time.monotonic() - begin)} s"
    if run.returncode not in (0, 3):
        return "refused"
    seen = [one for one in json.loads(run.stdout)["unknowns"] if is_seen(one["local"])]
    if not seen:
        return "nothing is observable"
    if any(not isinstance(one["values"], int) for one in seen):
        return f"undecided, {took}"
    word = "proved" if all(one["verdict"] == "proved" for one in seen) else "computed"
    several = {}
    for one in seen:
        if one["values"] > 1:
            several.setdefault(one["values"], []).append(one["name"])
    counts = [f"{count} of {', '.join(names)}" for count, names in sorted(several.items())]
    return f"{'; '.join(counts) or 'one'} ({word}), {took}"


def main():
    options = arguments()
    if options.binary == str(ROOT / "target/release/palmistry") and not options.only:
        subprocess.run(["cargo", "build", "--release", "--locked", "--quiet"], cwd=ROOT, check=True)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    os.environ |= dict.fromkeys(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"], "1")
    expected = tomllib.loads(TABLE.read_text())
    told = options.book or options.json  # from what was kept, where one program alone is measured
    with tempfile.TemporaryDirectory() as folder:
        measure = Measure(options, folder)
        measure.programs = programs(options.binary)
        models = []
        for name in options.models:
            path = model_path(name)
            point = {"model": name, "has_claims": path.parent == BENCHMARKS}
            point["claims"] = len(re.findall(r"^(?:claim|erratum) ", path.read_text(), re.MULTILINE))
            bare = without_claims(path, folder)
            if told or not options.only:
                point |= answer(options.binary, bare)
            for program in (OURS, STRIKEPY) + ((CLAIMS,) if point["has_claims"] else ()):
                point[program] = measure(program, name, path if program == CLAIMS else bare)
            if told or not options.only:
                point["global"] = solutions(options.binary, bare, options.limit)
            models.append(point)
    if options.only and not told:
        return 0
    report = {"machine": machine(options.binary), "limit": options.limit, "models": models, "remark": options.remark}
    wrong = [
        f"{point['model']}: {ranks}"
        for point in models
        if len({*(ranks := [p["rank"] for p in (point[OURS], point[STRIKEPY]) if p and p["rank"] is not None]), point["rank"]}) > 1
        or expected.get(point["model"], {"rank": point["rank"]})["rank"] != point["rank"]
    ]
    print(json.dumps(report, indent=2) if options.json else table(report))
    if options.book:
        text = BOOK.read_text()
        before, rest = text.split(BEGIN)
        BOOK.write_text(before + BEGIN + "\n\n" + table(report) + "\n\n" + END + rest.split(END, 1)[1])
    for line in wrong:
        print(f"DISAGREES: {line}", file=sys.stderr)
    return 1 if wrong else 0


def table(report):
    lines = [
        "| model | unknowns | rank | unobservable | claims | all claims, s | rank, s | StrikePy, s | global |",
        "|---|---:|---:|---:|---:|---:|---:|---:|---|",
    ]
    for point in sorted(report["models"], key=lambda point: (not point["has_claims"], point["model"])):
        claims = point["claims"] if point["has_claims"] else ""
        lines.append(
            f"| {point['model']} | {point['unknowns']} | {point['rank']} | {len(point['not_seen']) or ''} | "
            f"{claims} | {seconds(point.get(CLAIMS))} | {seconds(point[OURS])} | {seconds(point[STRIKEPY])} | {point.get('global', '')} |"
        )
    measured = [point for point in report["models"] if point[STRIKEPY]]
    decided = [point for point in measured if point[STRIKEPY]["seconds"] is not None]
    sums = {
        program: sum(point[program]["seconds"] for point in report["models"] if point.get(program) and point[program]["seconds"])
        for program in (OURS, CLAIMS)
    }
    machine = report["machine"]
    claims = f"{figures(sums[CLAIMS])} s for all claims and " if sums[CLAIMS] else ""
    words = (
        f"StrikePy decides {len(decided)} of the {len(measured)} models that it was given within {report['limit']:g} s each; palmistry "
        f"takes {claims}{figures(sums[OURS])} s for all {len(report['models'])} ranks."
    )
    tools = (
        f"{machine['processor']}, one core, processor time; palmistry {machine['palmistry']} as a whole process, least of three; Python "
        f"{machine['python']}, sympy {machine['sympy']}, StrikePy {machine['StrikePy']} without the start of the interpreter."
    )
    return "\n".join([*lines, "", words, "", " ".join(filter(None, [tools, report["remark"]]))])


if __name__ == "__main__":
    sys.exit(main())
