"""A second checker of verdict files, which shares no line with the program that wrote them.

    python -m palmistry.recheck VERDICTS.json [--proofs FOLDER]

From a verdict file (`palmistry prove proofs/ --verdicts FILE`) only witnesses, minors and boxes are taken; what they
are about is read anew from the proof file (`proof_file`), into a graph of expressions (`graph`). `confirmed` is so;
`consistent`: nothing speaks against it at random points modulo primes; what is not read is `not checked`, and why.
The exit status is 1 where something is not confirmed, and 2 for what is no verdict file.
"""

import json
import os
import sys
from collections import Counter
from contextlib import suppress
from fractions import Fraction
from math import prod
from operator import sub

from .graph import Expression, Interval, Map, Modulo, Node, call, enclosed, number, put_in, refuse, symbol
from .proof_file import HOLDS, System, determinant, each, entries

PRIMES = (1 << 61) - 1, (1 << 89) - 1, (1 << 107) - 1
POINTS, TRIES, WORDS, PIECES, MOST = 4, 40, 200, 500, 100_000  # compared; drawn; words; pieces of a box; nodes kept

def gaps(relation): return entries(each(sub, relation[0], relation[2]))
def holds(point, relation): return all(HOLDS[relation[1]](point[gap].sign(), 0) for gap in gaps(relation))
def doubt(why): raise ArithmeticError(why)

def adds(row, basis, prime):
    """Whether a row is independent of a basis, to which it is added then, with a one in a column."""
    for column, other in basis.items():
        row = [(x - row[column] * y) % prime for x, y in zip(row, other)]
    column = next((column for column, x in enumerate(row) if x), None)
    if column is not None:
        basis[column] = [x * pow(row[column], -1, prime) % prime for x in row]
    return column is not None

def solution(system, gap):
    """A symbol in which a gap is linear, or for which it is zero at a quarter turn, and its value."""
    names, zero = [node for node in gap.below() if node.kind == "symbol"], number(0)
    slopes = [(name, system.unit(name.args[0])[gap]) for name in names]
    for name, slope in sorted(slopes, key=lambda pair: pair[1].kind != "number"):
        if slope is not zero and name not in slope.below():
            return name, -Map(put_in, {name: zero})[gap] / slope
    turns = [(name, turn) for name in names for turn in (zero, number("1/2") * symbol("pi"))]
    return next((x for x in turns if Map(put_in, [x])[gap] is zero), None) or refuse("a condition that is not solved")

def points(system, conditions, seed):
    """Random points modulo primes on the set of the equations; inequalities hold somewhere, and do not matter."""
    found = []
    for gap in [gap for relation in conditions if relation[1] == "=" for gap in gaps(relation)]:
        for given in found:
            gap = Map(put_in, [given])[gap]
        found += [solution(system, gap)] if gap is not number(0) else []
    for draw in range(TRIES):
        point = Modulo(PRIMES[draw % len(PRIMES)], (seed, draw))
        with suppress(ZeroDivisionError):
            for name, value in reversed(found):
                turns = {Node(kind, name): call(kind, value) for kind in ("sin", "cos")}
                point.update({node: point[of] for node, of in {name: value, **turns}.items()})
            yield point

def codistribution(system, point, patience):
    """The rows of all words; those behind more words than `patience` that add nothing are not looked at."""
    columns, words = system.names["state"] + system.names["unknown"], [(word, 0) for word in system.seen()]
    rows, basis = [], {}
    for word, idle in words:
        row = point.gradient(word, columns)
        rows.append([x for x, name in zip(row, columns) if name not in system.names["initial"]])
        idle = 0 if adds(row, basis, point.prime) else idle + 1
        new = [(system[field].along[word], idle) for field in system.names["moving"] if idle <= patience]
        words += [pair for pair in new if pair not in words]
        if len(words) > WORDS:
            refuse(f"more than {WORDS} words")
    return rows

def is_so(system, point, asked, of, claimed, conditions):
    """Whether an identity, a rank at almost all states, or what is observable there is so at a point."""
    if asked == "=":
        return all(point[gap] == 0 for gap in gaps(of)) if of[1] == "=" else refuse("an inequality")
    patience, basis = len(conditions) + 1 if conditions else 0, {}
    rows = each(point.__getitem__, of) if asked == "rank" and of else codistribution(system, point, patience)
    rank = sum(adds(row, basis, point.prime) for row in rows)
    if asked == "rank":
        return rank == claimed
    return all(adds(point.gradient(x, system.columns()), {**basis}, point.prime) == asked.startswith("un") for x in of)

def at_random(system, record, evidence, seed):
    """An identity, or what is claimed of almost all states, at random points."""
    statement, found, is_proved = system.statement(record["statement"]), 0, evidence.get("word", "proved") == "proved"
    for point in points(system, statement[3], seed):
        with suppress(ZeroDivisionError):
            if is_so(system, point, *statement) != is_proved:
                why = "functions that were taken for unknowns"
                refuse(why) if point.guessed else doubt("it is not so at a random point modulo a prime")
            found += 1
        if found == POINTS:
            return "consistent", f"{found} points modulo primes"
    return refuse(f"it has values at {found} of {TRIES} random points")

def witness(state):
    """The point of a state; what it does not name does not matter, and may have any value."""
    point = Map(enclosed)
    for name, value in state.items():
        of = symbol(name)
        if "angle" in value:
            sine, cosine = (Fraction(value["angle"][key]) for key in ("sin", "cos"))
            point[of] = None if sine**2 + cosine**2 == 1 else doubt(f"{name} is no angle")
            point.update({Node("sin", of): Interval(sine), Node("cos", of): Interval(cosine)})
        else:
            point[of] = Interval(Fraction(value["number"])) if "number" in value else refuse("a value by an operation")
    return point

def refuted(system, record, evidence, _):
    asked, of, _, conditions = system.statement(record["statement"])
    point = witness(evidence["state"]) if asked == "=" else refuse("a rank without a minor")
    if not all(holds(point, condition) for condition in conditions) or holds(point, of):
        doubt("a condition does not hold at the witness, or what was refuted does")
    return "confirmed", "at its witness"

def minor(system, record, evidence, rows, columns):
    """The determinant of some rows and columns: of differentials of words, or of a matrix of the file's own."""
    if len(rows) != len(columns) or min([0, *rows, *columns]) < 0:
        doubt("it has no such minor")
    if evidence["columns"][0] == "column 1":
        of = system.statement(record["statement"])[1]
        return determinant(tuple(tuple(of[row][column] for column in columns) for row in rows))
    names = [system.unit(evidence["columns"][column]) for column in columns]
    return determinant(tuple(tuple(unit[system.word(evidence["words"][row])] for unit in names) for row in rows))

def ranks(system, record, evidence, _):
    for state in evidence["states"]:
        of = minor(system, record, evidence, state["minor"]["rows"], state["minor"]["columns"])
        if len(state["minor"]["rows"]) != state["rank"] or witness(state["state"])[of].sign() == 0:
            doubt("a minor is zero, or of another size")
    return "confirmed", f"the rank is no less at {len(evidence['states'])} states"

def boxes(system, record, evidence, _):
    whole = {symbol(side["symbol"]): (Fraction(side["low"]), Fraction(side["high"])) for side in evidence["ranges"]}
    free, volume, seen = {name: ends for name, ends in whole.items() if ends[0] < ends[1]}, Fraction(0), []
    for box in evidence["boxes"]:
        sides = [(Fraction(low), Fraction(high)) for low, high in box["sides"]]
        if any(all(a < d and c < b for (a, b), (c, d) in zip(sides, other)) for other in seen):
            doubt("boxes have a part in common")
        parts = [(high - low) / (most - least) if least <= low < high <= most else doubt("a box lies outside")
                 for (least, most), (low, high) in zip(free.values(), sides, strict=True)]
        volume, seen = volume + prod(parts), [*seen, sides]
        of = minor(system, record, evidence, box["rows"], range(len(evidence["columns"])))
        if any(node.kind == "symbol" and node not in (*whole, symbol("pi")) for node in of.below()):
            refuse("a symbol without a range")
        if not is_nowhere_zero(system, of, {**whole, **dict(zip(free, sides))}):
            refuse(f"a box that is not shown by {PIECES} pieces")
    return ("confirmed", f"{len(seen)} boxes") if volume == Fraction(evidence["volume"]) else doubt("another volume")

def is_nowhere_zero(system, of, box):
    """Whether an expression is so in a box: from the middle by slopes, on pieces, halved where it varies most."""
    waiting = [box]
    for _ in range(PIECES):
        sides, parts, is_told = waiting.pop(), {}, False
        middle = {name: (low + high) / 2 for name, (low, high) in sides.items()}
        inside = Map(enclosed, {name: Interval(*ends) for name, ends in sides.items()})
        with suppress(NotImplementedError, ZeroDivisionError):
            for name, (low, high) in sides.items():
                parts[name] = inside[system.unit(name.args[0])[of]] * Interval(low - middle[name], high - middle[name])
            there = Map(enclosed, {name: Interval(x) for name, x in middle.items()})[of]
            is_told = sum(parts.values(), there).sign() != 0
        if not is_told:
            most = max(sides, key=lambda name: parts[name].high - parts[name].low if name in parts else 0)
            ends = sides[most][0], middle[most], sides[most][1]
            waiting += [{**sides, most: ends[:2]}, {**sides, most: ends[1:]}]
        if not waiting:
            return True
    return False

def check(record, folder, systems, seed):
    """What comes of one verdict: a word, and why."""
    try:
        ((kind, evidence),), Expression.work = record["evidence"].items(), 0
        if kind == "unchecked":
            return "not checked", str(evidence)
        path = os.path.join(folder, record["file"])
        if path not in systems or Node.cache_info().currsize > MOST:
            systems.clear()
            Node.cache_clear()
            determinant.cache_clear()
            systems[path] = System(path)
        checks = {"refuted": refuted, "rank": ranks, "boxes": boxes}
        return checks.get(kind, at_random)(systems[path], record, evidence, seed)
    except Exception as why:  # whatever a damaged record or file leads to
        word = "not confirmed" if isinstance(why, ArithmeticError) else "not checked"
        return word, str(why) if type(why) in (NotImplementedError, ArithmeticError) else repr(why)

def main(arguments):
    """The command; returns its exit status."""
    if not arguments or arguments[0].startswith("-"):
        print(__doc__)
        return 0 if arguments[:1] in (["-h"], ["--help"]) else 2
    (path, _, folder), counts, systems = [*arguments, "--proofs", "."][:3], Counter(), {}
    try:
        with open(path, encoding="utf-8") as file:
            verdicts = json.load(file)
        if verdicts["schema"] != "palmistry-verdicts" or verdicts["version"] not in (1, 2):
            raise ValueError("another schema")
        records = [(f"{record['file']} {record['id']}", record) for record in verdicts["verdicts"]]
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as why:
        print(f"{path} is no verdict file: {why!r}\n{__doc__}", file=sys.stderr)
        return 2
    for seed, (name, record) in enumerate(records):
        word, why = check(record, folder, systems, seed)
        counts[word] += 1
        print(f"{word:14}{name}: {why}", flush=True)
    print(", ".join(f"{count} {word}" for word, count in sorted(counts.items())))
    return 1 if counts["not confirmed"] else 0

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
