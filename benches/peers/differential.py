"""`palmistry rank` against the plain test on random systems: differential.py BINARY [--from SEED] [--count N] [--edges]
[--declared] [--related] [--accessible] [--fields] [--models] [--out FOLDER]

Each system is decided by both. Rational ones modulo a prime, twice; those with functions at true states in three hundred
digits. What differs is written to FOLDER with its seed, one line each to its FINDINGS.txt. Exit status 1 where a final
answer differs.
"""

import argparse
import collections
import json
import math
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

from generic_rank import NoSuchState, Prime, Reals, Series, accessible_rank, constant, decide, insert
from model_files import TABLE, model_paths
from proof_file import TOKEN, ProofFile
from random_systems import declared_system, edge_systems, random_system, related_system

FUNCTION = re.compile(r"\b(exp|log|sqrt|sin|cos|tan|atan|asin|acos|sinh|cosh|tanh|abs)\(|\bpi\b")


def truth(text):
    """Rank and unknowns that are seen. A short rank modulo 2^27 is looked at once more modulo 2^127 - 1."""
    if FUNCTION.search(text):
        return decide(text, numbers=Reals, tries=2)
    answer = decide(text)
    if answer["rank"] < answer["dimension"]:
        answer = decide(text, tries=1, numbers=lambda seed: Prime(seed, 2**127 - 1))
    return answer


def branch_of(report, text):
    """The part of an answer, given for each choice of signs, that the middle of the sample box is in."""
    if "branches" not in report:
        return report
    model, middle = ProofFile(text), {name: getattr(math, name) for name in ("exp", "log", "sqrt", "sin", "cos", "tan", "atan")}
    reals = Reals(1)
    for name, (low, high) in model.ranges.items():
        middle[name] = float(constant(model, low, reals) + constant(model, high, reals)) / 2
    for branch in report["branches"]:
        if all(eval(condition.replace("^", "**"), {"__builtins__": {}}, middle) for condition in branch["conditions"]):
            return branch
    raise LookupError(f"the sample box is in none of {[branch['conditions'] for branch in report['branches']]}")


def theirs(report):
    """Rank, whether it is said to be final, and the unknowns that are said (not) to be seen, from the JSON of `rank`."""
    generic = report["generic"]
    words = {entry["name"]: entry["verdict"] for entry in report["unknowns"]}
    return (generic["at_least"] if generic["rank"] is None else generic["rank"]), generic["rank"] is not None, words


def compare(binary, text, folder, limit=20, samples=0):
    """What they say beside what is so: a word, and a line."""
    path = Path(folder) / "system.proof"
    path.write_text(text)
    try:
        expected = truth(text)
    except NoSuchState:
        return "no state", ""
    began = time.perf_counter()
    try:
        run = subprocess.run(
            [binary, "rank", str(path), "--json", "--samples", str(samples)], capture_output=True, text=True, timeout=limit
        )
    except subprocess.TimeoutExpired:
        return "time", f"nothing within {limit} s; rank {expected['rank']} of {expected['dimension']}"
    took = time.perf_counter() - began
    try:
        report = json.loads(run.stdout)
    except json.JSONDecodeError:
        word = "panic" if "panicked" in run.stderr or run.returncode not in (0, 1, 2, 3) else "refused"
        return word, f"status {run.returncode}: {' '.join(run.stderr.split())[:300]}"
    try:
        report = branch_of(report, text)
    except LookupError as error:
        return "BRANCH", str(error)
    rank, final, words = theirs(report)
    of = f"{expected['rank']} of {expected['dimension']}"
    ranks = {int(rank) for rank in (report.get("rank_histogram") or {})}
    if ranks and max(ranks) > expected["rank"]:
        return "HIGH", f"certified rank {max(ranks)} at a state, and it is {of}"
    if rank is not None and rank != expected["rank"] and final:
        return "RANK", f"rank {rank} is said to be final, and it is {of}"
    if not final and not report["generic"]["at_least"] <= expected["rank"] <= report["generic"]["at_most"]:
        return "BOUNDS", f"at least {report['generic']['at_least']}, at most {report['generic']['at_most']}, and it is {of}"
    if words:
        wrong = [
            f"{name} {word}"
            for name, word in words.items()
            if (is_seen(word), name in expected["seen"]) in ((True, False), (False, True))
        ]
        if wrong:
            return "SEEN", f"{', '.join(wrong)}; rank {of}; not seen are {expected['not_seen']}"
        if set(words) != {*expected["seen"], *expected["not_seen"]}:
            return "NAMES", f"{sorted(words)}, and unknown are {sorted([*expected['seen'], *expected['not_seen']])}"
        if final and any(is_seen(word) is None for word in words.values()):
            return "open", f"the rank is known and an unknown is not decided; rank {of}"
    if ranks and max(ranks) < expected["rank"] and final:
        return "low", f"sampled {sorted(ranks)}, generic {rank}, and it is {of}"
    if not final:
        return "undecided", f"says {rank}, and it is {of}; {report['generic']['open']}"
    return ("slow" if took > 2 else "agrees"), f"{took:.1f} s"


def compare_accessible(binary, text, folder, limit=60):
    """The same for `rank --accessible`."""
    path = Path(folder) / "system.proof"
    path.write_text(text)
    try:
        expected = decide(text, numbers=Reals if FUNCTION.search(text) else Prime, question=accessible_rank)
    except NoSuchState:
        return "no state", ""
    command = [binary, "rank", str(path), "--accessible", "--json", "--samples", "2"]
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=limit)
        branch = json.loads(run.stdout)["branches"][0]
    except subprocess.TimeoutExpired:
        return "time", f"nothing within {limit} s; {expected}"
    except json.JSONDecodeError:
        return "refused", f"status {run.returncode}: {' '.join(run.stderr.split())[:300]}"
    told = {"rank": branch["accessibility"], "strong": branch["strong_accessibility"]}
    if any(not answer["at_least"] <= expected[key] <= answer["at_most"] for key, answer in told.items()):
        return "RANK", f"{told}, and it is {expected}"
    ranks = [int(rank) for rank in branch["sampled"]["rank_histogram"]]
    if ranks and max(ranks) > expected["rank"]:
        return "HIGH", f"certified rank {max(ranks)} at a state, and it is {expected}"
    return ("undecided" if any(answer["rank"] is None for answer in told.values()) else "agrees"), str(expected)


def compare_fields(binary, text, folder, limit=60):
    """The unseen fields and the seen functions that `rank` names: each has to be one, and they have to be independent."""
    path = Path(folder) / "system.proof"
    path.write_text(text)
    numbers = Reals if FUNCTION.search(text) else Prime
    try:
        expected = decide(text, numbers=numbers, tries=1)
        run = subprocess.run(
            [binary, "rank", str(path), "--json", "--samples", "2"], capture_output=True, text=True, timeout=limit
        )
        found = json.loads(run.stdout).get("unobservable_directions")
    except NoSuchState:
        return "no state", ""
    except subprocess.TimeoutExpired:
        return "time", f"nothing within {limit} s"
    except json.JSONDecodeError:
        return "refused", f"status {run.returncode}: {' '.join(run.stderr.split())[:300]}"
    if not found:
        return (
            "agrees" if expected["rank"] == expected["dimension"] else "nothing told"
        ), f"rank {expected['rank']} of {expected['dimension']}"
    fields, functions = (
        [field["components"] for field in found["fields"]],
        [function["text"] for function in found["functions"]],
    )
    try:
        moved, seen = directions(text, fields, numbers)
        told = decide(text + "".join(f"\noutput {function}" for function in functions), numbers=numbers, tries=1)
    except NoSuchState:
        return "no state", ""
    if moved:
        return "FIELD", f"seen is what is said to be unseen: {moved}"
    if seen != len(fields):
        return "FIELD", f"{len(fields)} fields, of which {seen} are independent"
    if len(fields) + found["fields_missing"] != expected["dimension"] - expected["rank"]:
        return (
            "FIELD",
            f"{len(fields)} fields and {found['fields_missing']} missing, and it is {expected['rank']} of {expected['dimension']}",
        )
    if told["rank"] != expected["rank"]:
        return "FUNCTION", f"one of {functions} is not seen"
    if set(found["seen"]) != set(expected["seen"]):
        return "SEEN", f"{found['seen']}, and it is {expected['seen']}"
    return ("missing" if found["fields_missing"] or found["functions_missing"] else "agrees"), (
        f"{found['fields_missing']} fields and {found['functions_missing']} functions missing of rank {expected['rank']} of {expected['dimension']}"
    )


def directions(text, fields, numbers):
    """Fields along which an output changes, at a random state, and how many of all are independent there."""
    model = ProofFile(text)
    outputs = model.outputs[:]
    nodes = []
    for field in fields:
        parts = {}
        for name, part in field.items():
            model.tokens, model.at = [match[1] for match in TOKEN.finditer(part) if match[1]] + [None], 0
            parts[model.states.index(name)] = model.sum()
        nodes.append(parts)
        model.outputs += parts.values()
    field_of_numbers = numbers(77)
    series, vectors, moved, basis = Series(model, field_of_numbers, len(model.states) + 1), [], set(), []
    for order in range(len(model.states) + 1):
        series.step(order)
        if order == 0:
            for parts in nodes:
                vector = series.slope[outputs[0]][0] * 0
                for place, node in parts.items():
                    vector[place] = series.value[node][0]
                vectors.append(vector)
        for output in outputs:
            row = series.slope[output][order]
            for index, vector in enumerate(vectors):
                change = field_of_numbers.reduce(
                    sum(int(a) * int(b) if numbers is Prime else a * b for a, b in zip(row, vector))
                )
                scale = 1 if numbers is Prime else 1 + sum(abs(a * b) for a, b in zip(row, vector))
                if abs(change) > getattr(field_of_numbers, "small", 0) * scale:
                    moved.add(index)
    for vector in vectors:
        insert(basis, vector.copy(), field_of_numbers)
    return [fields[index] for index in sorted(moved)], len(basis)


def is_seen(word):
    return None if word == "undecided" else word not in ("unobservable", "non-identifiable")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("binary")
    parser.add_argument("--from", dest="first", type=int, default=1)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--samples", type=int, default=0, help="states at which the rank is decided as well (default %(default)s)")
    parser.add_argument("--edges", action="store_true")
    parser.add_argument(
        "--declared", action="store_true", help="constants, signals and experiments as the language declares them"
    )
    parser.add_argument("--related", action="store_true", help="functions that satisfy relations, or nearly do")
    parser.add_argument("--accessible", action="store_true", help="the dual question, on the same systems")
    parser.add_argument(
        "--fields", action="store_true", help="the unseen fields and the seen functions that are named, on the same systems"
    )
    parser.add_argument("--models", action="store_true", help="the published models in the place of random systems")
    parser.add_argument("--out", type=Path, default=Path("mismatches"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    make = declared_system if options.declared else related_system if options.related else random_system
    systems = (
        edge_systems().items()
        if options.edges
        else ((seed, make(seed)) for seed in range(options.first, options.first + options.count))
    )
    if options.models:
        systems = ((name, path.read_text()) for name, path in model_paths(tomllib.loads(TABLE.read_text())).items())
    counts, findings = collections.Counter(), options.out.parent / "FINDINGS.txt"
    with tempfile.TemporaryDirectory() as folder:
        for name, text in systems:
            decider = compare_accessible if options.accessible else compare_fields if options.fields else compare
            more = {"samples": options.samples} if decider is compare else {}
            word, line = decider(options.binary, text, folder, **more)
            counts[word] += 1
            if word not in ("agrees", "no state"):
                name = re.sub(r"\W+", "_", str(name))
                (options.out / f"{word.replace(' ', '_')}_{name}.proof").write_text(f"# {word}: {line}\n{text}")
                with findings.open("a") as out:
                    out.write(f"{word:<10} {name}: {line}\n")
                print(f"{word:<10} {name}: {line}", flush=True)
    print(dict(counts))
    return 1 if any(word.isupper() for word in counts) else 0


if __name__ == "__main__":
    sys.exit(main())
