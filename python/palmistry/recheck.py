"""A second checker of verdict files that shares no line with the program that wrote them.

    python -m palmistry.recheck VERDICTS.json [--proofs FOLDER]

Of a verdict file (`palmistry prove --verdicts`, `palmistry rank --verdicts`) only the claim's verdict, witness and minors are
taken. What they are about is read from the proof file anew: its text (`proof_file`), Lie derivatives and differentials
(`terms`), values (`values`). A refutation is evaluated at its witness in fractions, or in intervals of fractions where there are
functions; an identity is tried at primes and points of this program's own choice; a minor is computed at its state.

`confirmed` needs no more to be believed than this program. `consistent` says that nothing was found that speaks against it. What
the program does not read is `not checked`, and why. The exit status is 1 where a verdict is not confirmed.
"""

import json
import os
import random
import sys
from fractions import Fraction

from . import terms, values
from .proof_file import NotRead, ProofFile

PRIMES = [(1 << 61) - 1, (1 << 89) - 1, (1 << 107) - 1]
POINTS = 6  # at which an identity or a rank is tried
TRIES = 60  # points that are poles, or where a root has no residue, are drawn again


class Doubt(Exception):
    """A verdict that is not confirmed."""


def witness(system, state):
    """A state of the file as assignments of this program's symbols."""
    known = {}
    for name, value in state.items():
        if "number" in value:
            known[name] = Fraction(value["number"])
        elif "angle" in value:
            sine, cosine = Fraction(value["angle"]["sin"]), Fraction(value["angle"]["cos"])
            if sine**2 + cosine**2 != 1:
                raise Doubt(f"{name} is no angle")
            known[name] = values.Angle(sine, cosine)
        else:
            raise NotRead("a coordinate that is told by an operation")
    return known


def drawn(symbols, angles, conditions, rng, field):
    """A random point modulo a prime, on the set of the conditions."""
    point = {}
    for name in symbols:
        if name in angles:
            half = rng.randrange(field.prime)
            bottom = field.divide(1, 1 + half * half)
            point[name] = values.Angle(2 * half * bottom % field.prime, (1 - half * half) * bottom % field.prime)
        else:
            point[name] = rng.randrange(field.prime)
    return values.solved(conditions, point, field)


def points(system, nodes, conditions, seed):
    """Random points modulo primes at which some terms have values, and these."""
    rng, found = random.Random(seed), 0
    symbols = sorted(terms.symbols(nodes + [side for a, _, b in conditions for side in (a, b)]))
    for _ in range(TRIES):
        field = values.Residues(PRIMES[found % len(PRIMES)], rng)
        try:
            at = drawn(symbols, system.angles, conditions, rng, field)
            yield field, values.evaluate(nodes, at, field)
        except values.NoValue:
            continue
        found += 1
        if found == POINTS:
            return
    if found == 0:
        raise NotRead("no point was found at which it has values")


def flat(left, right):
    """Pairs of entries of two sides, which are numbers or matrices."""
    if isinstance(left, list) != isinstance(right, list):
        if isinstance(left, list) and len(left) == len(left[0]) == 1:
            left = left[0][0]
        elif isinstance(right, list) and len(right) == len(right[0]) == 1:
            right = right[0][0]
        else:
            raise NotRead("a number beside a matrix")
    if not isinstance(left, list):
        return [(left, right)]
    if [len(row) for row in left] != [len(row) for row in right]:
        raise NotRead("matrices of two shapes")
    return [pair for rows in zip(left, right) for pair in zip(*rows)]


def proved_identity(system, statement, seed):
    """Tries an identity at random points modulo primes."""
    kind, left, right, conditions = statement
    if kind != "=":
        raise NotRead("an inequality")
    pairs = flat(left, right)
    nodes = [side for pair in pairs for side in pair]
    tried = 0
    for field, found in points(system, nodes, conditions, seed):
        tried += 1
        for place in range(0, len(found), 2):
            if (found[place] - found[place + 1]) % field.prime:
                if field.guessed:
                    raise NotRead("functions that were taken for unknowns")
                raise Doubt(f"the two sides differ modulo {field.prime}")
    return "consistent", f"{tried} points modulo primes"


RELATIONS = {
    "=": lambda sign: sign == 0, "!=": lambda sign: sign != 0, "<": lambda sign: sign < 0,
    "<=": lambda sign: sign <= 0, ">": lambda sign: sign > 0, ">=": lambda sign: sign >= 0,
}


def refuted(system, statement, evidence):
    """Evaluates a refutation at its witness."""
    kind, left, right, conditions = statement
    if kind == "rank":
        raise NotRead("a rank without a minor")
    at = witness(system, evidence["state"])
    for a, relation, b in conditions:
        if not RELATIONS[relation](values.sign(terms.sub(a, b), at)):
            raise Doubt("a condition does not hold at the witness")
    for a, b in flat(left, right):
        if not RELATIONS[kind](values.sign(terms.sub(a, b), at)):
            return "confirmed", "at its witness"
    raise Doubt("the two sides stand to each other as was claimed at the witness")


def claimed_rank(system, statement, evidence, seed):
    """Compares a rank at almost all states with that of this program's own words or matrix."""
    kind, matrix, claimed, conditions = statement
    if kind != "rank":
        raise NotRead("no rank")
    ranks = []
    if matrix is None:
        columns = system.unknowns()
        rows, tried = [], [(output, ()) for output in system.outputs]
        for order in range(len(columns) + 1):
            kept = []
            for word, fields in tried:
                rows.append([terms.derivative(word, column) for column in columns])
                if len(rows) > 400:
                    raise NotRead("more than 400 words")
                kept.append((word, fields))
            before, ranks = max(ranks, default=-1), []
            nodes = [entry for row in rows for entry in row]
            for field, found in points(system, nodes, conditions, seed):
                ranks.append(values.rank_modulo(found, len(columns), field.prime))
            if max(ranks) == len(columns) or (max(ranks) == before and not conditions):
                break
            tried = [(system.along(name, word), (name, *fields)) for word, fields in kept for name in system.moving()]
    else:
        nodes = [entry for row in matrix for entry in row]
        ranks = [values.rank_modulo(found, len(matrix[0]), field.prime)
                 for field, found in points(system, nodes, conditions, seed)]
    rank = max(ranks)
    if (rank == claimed) != (evidence["word"] == "proved"):
        raise Doubt(f"the rank is {rank} at random points, and {claimed} was claimed")
    return "consistent", f"rank {rank} at {len(ranks)} points modulo primes"


def certified_rank(system, evidence):
    """Computes the minors of a certified rank at their states."""
    columns = [terms.symbol(name) for name in evidence["columns"]]
    words = [system.word(text) for text in evidence["words"]]
    for number, state in enumerate(evidence["states"]):
        at, minor = witness(system, state["state"]), state["minor"]
        if len(set(minor["rows"])) != state["rank"] or len(set(minor["columns"])) != state["rank"]:
            raise Doubt(f"state {number} has no minor of its rank")
        entries = [[terms.derivative(words[row], columns[column]) for column in minor["columns"]] for row in minor["rows"]]
        if entries and values.sign(terms.determinant(entries), at) == 0:
            raise Doubt(f"the minor of state {number} is zero")
    return "confirmed", f"minors at {len(evidence['states'])} states: the rank is no less"


def check(record, folder, systems, seed):
    """What comes of one verdict: a word, and why."""
    (kind, evidence), = record["evidence"].items()
    if kind in ("unchecked", "boxes"):
        return "not checked", evidence if kind == "unchecked" else "boxes"
    try:
        path = os.path.join(folder, record["file"])
        if path not in systems:
            systems[path] = ProofFile.read(path)
        system = systems[path]
        if kind == "rank":
            return certified_rank(system, evidence)
        statement = system.statement(record["id"], record["statement"])
        if kind == "refuted":
            return refuted(system, statement, evidence)
        if kind == "claimed_rank":
            return claimed_rank(system, statement, evidence, seed)
        return proved_identity(system, statement, seed)
    except NotRead as why:
        return "not checked", str(why)
    except values.NoValue as why:
        return "not confirmed", f"no value: {why}"
    except Doubt as why:
        return "not confirmed", str(why)


def main(arguments):
    """The command; returns its exit status."""
    folder, files = ".", []
    while arguments:
        first = arguments.pop(0)
        if first == "--proofs" and arguments:
            folder = arguments.pop(0)
        elif first in ("-h", "--help") or first.startswith("-"):
            print(__doc__)
            return 0 if first in ("-h", "--help") else 2
        else:
            files.append(first)
    if not files:
        print("which verdict file? palmistry prove proofs/ --verdicts verdicts.json writes one", file=sys.stderr)
        return 2
    sys.setrecursionlimit(100_000)
    counts, systems = {}, {}
    for path in files:
        try:
            with open(path, encoding="utf-8") as file:
                verdicts = json.load(file)
            records = verdicts["verdicts"]
            assert verdicts["schema"] == "palmistry-verdicts" and verdicts["version"] in (1, 2)
        except (OSError, ValueError, KeyError, TypeError, AssertionError) as why:
            print(f"{path}: no verdict file: {why!r}", file=sys.stderr)
            return 2
        for number, record in enumerate(records):
            word, why = check(record, folder, systems, number)
            counts[word] = counts.get(word, 0) + 1
            print(f"{word:14}{record['file']} {record['id']}: {why}")
    print(", ".join(f"{count} {word}" for word, count in sorted(counts.items())))
    return 1 if counts.get("not confirmed") else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
