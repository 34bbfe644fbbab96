"""A second checker of verdict files, which shares no line with the program that wrote them.

    python -m palmistry.recheck VERDICTS.json [--proofs FOLDER]

From a verdict file (`palmistry prove proofs/ --verdicts FILE`) only witnesses, minors and boxes are taken; what they
are about is read anew from the proof file (`proof_file`), into a graph of expressions (`graph`). `confirmed` is so;
`consistent`: nothing speaks against it at random points modulo primes; what is not read is `not checked`, and why.
The exit status is 1 where something is not confirmed, and 2 for what is no verdict file.
"""

import contextlib
import json
import os
import sys
from fractions import Fraction
from operator import eq, ge, gt, le, lt, ne

from .graph import MOST, Enclosure, Interval, Map, Modulo, Node, NotRead, call, number, refuse, symbol
from .proof_file import System, determinant, each, entries

PRIMES = (1 << 61) - 1, (1 << 89) - 1, (1 << 107) - 1
POINTS, TRIES, WORDS, PIECES = 4, 40, 200, 500  # points that are compared; draws; words of a rank; pieces of a box
HOLDS = {"=": eq, "!=": ne, "<": lt, "<=": le, ">": gt, ">=": ge}  # of a sign and zero


class Doubt(Exception):
    """What speaks against a verdict."""


def gaps(relation): return entries(each(Node.__sub__, relation[0], relation[2]))
def holds(point, relation): return all(HOLDS[relation[1]](point[gap].sign(), 0) for gap in gaps(relation))
def rank(rows, prime, basis=()): return sum(adds(row, basis, prime) for basis in [list(basis)] for row in rows)


def adds(row, basis, prime):
    """Whether a row is independent of a basis, to which it is added then, with a one in a column."""
    for column, other in basis:
        row = [(x - row[column] * y) % prime for x, y in zip(row, other)]
    column = next((column for column, x in enumerate(row) if x), None)
    if column is not None:
        basis.append((column, [x * pow(row[column], -1, prime) % prime for x in row]))
    return column is not None


def solution(system, gap):
    """A symbol in which a gap is linear, or for which it is zero at a quarter turn, and its value."""
    names, zero = [node for node in gap.below() if node.kind == "symbol"], number(0)
    slopes = [(name, system.unit(name.args[0])[gap]) for name in names]
    for name, slope in sorted(slopes, key=lambda pair: pair[1].kind != "number"):
        if slope is not zero and name not in slope.below():
            return name, -Map({name: zero})[gap] / slope
    turns = [(name, turn) for name in names for turn in (zero, number("1/2") * symbol("pi"))]
    return next((x for x in turns if Map([x])[gap] is zero), None) or refuse("a condition that is not solved")


def points(system, conditions, seed):
    """Random points modulo primes on the set of the equations; inequalities hold somewhere, and do not matter."""
    found = []
    for gap in [gap for relation in conditions if relation[1] == "=" for gap in gaps(relation)]:
        for given in found:
            gap = Map([given])[gap]
        found += [solution(system, gap)] if gap is not number(0) else []
    for draw in range(TRIES):
        point = Modulo(PRIMES[draw % len(PRIMES)], (seed, draw))
        with contextlib.suppress(ZeroDivisionError):
            for name, value in reversed(found):
                turns = {Node(kind, name): call(kind, value) for kind in ("sin", "cos")}
                point.update({node: point[of] for node, of in {name: value, **turns}.items()})
            yield point


def codistribution(system, point, patience):
    """The rows of all words; those behind more words than `patience` that add nothing are not looked at."""
    columns, words, rows, basis = system.states + system.unknown, [(word, 0) for word in system.seen()], [], []
    for word, idle in words:
        row = point.gradient(word, columns)
        rows.append([x for x, name in zip(row, columns) if name not in system.initial])
        idle = 0 if adds(row, basis, point.prime) else idle + 1
        new = [(system.named(field).along[word], idle) for field in system.moving if idle <= patience]
        words += [pair for pair in new if pair not in words]
        if len(words) > WORDS:
            refuse(f"more than {WORDS} words")
    return rows


def is_so(system, point, asked, of, claimed, conditions):
    """Whether an identity, a rank at almost all states, or what is observable there is so at a point."""
    if asked == "=":
        return all(point[gap] == 0 for gap in gaps(of)) if of[1] == "=" else refuse("an inequality")
    patience = len(conditions) + 1 if conditions else 0
    rows = each(point.__getitem__, of) if asked == "rank" and of else codistribution(system, point, patience)
    found = rank(rows, point.prime)
    if asked == "rank":
        return found == claimed
    more = [rank([*rows, point.gradient(x, system.columns())], point.prime) > found for x in of]
    return all(more) if asked.startswith("un") else not any(more)


def at_random(system, record, evidence, seed):
    """An identity, or what is claimed of almost all states, at random points."""
    statement, found, is_proved = system.statement(record["statement"]), 0, evidence.get("word", "proved") == "proved"
    for point in points(system, statement[3], seed):
        with contextlib.suppress(ZeroDivisionError):
            if is_so(system, point, *statement) != is_proved:
                if point.guessed:
                    refuse("functions that were taken for unknowns")
                raise Doubt("it is not so at a random point modulo a prime")
            found += 1
        if found == POINTS:
            return "consistent", f"{found} points modulo primes"
    return refuse(f"it has values at {found} of {TRIES} random points")


def witness(state):
    """The point of a state; what it does not name does not matter, and may have any value."""
    point = Enclosure()
    for name, value in state.items():
        of = symbol(name)
        if "angle" in value:
            sine, cosine = (Fraction(value["angle"][key]) for key in ("sin", "cos"))
            if sine**2 + cosine**2 != 1:
                raise Doubt(f"{name} is no angle")
            point.update({of: None, Node("sin", of): Interval(sine), Node("cos", of): Interval(cosine)})
        else:
            point[of] = Interval(Fraction(value["number"])) if "number" in value else refuse("a value by an operation")
    return point


def refuted(system, record, evidence):
    asked, of, _, conditions = system.statement(record["statement"])
    point = witness(evidence["state"]) if asked == "=" else refuse("a rank without a minor")
    if not all(holds(point, condition) for condition in conditions) or holds(point, of):
        raise Doubt("a condition does not hold at the witness, or what was refuted does")
    return "confirmed", "at its witness"


def minor(system, record, evidence, rows, columns):
    """The determinant of some rows and columns: of differentials of words, or of a matrix of the file's own."""
    if len(rows) != len(columns) or min([0, *rows, *columns]) < 0:
        raise Doubt("it has no such minor")
    if evidence["columns"][0] == "column 1":
        of = system.statement(record["statement"])[1]
        return determinant([[of[row][column] for column in columns] for row in rows])
    names = [system.unit(evidence["columns"][column]) for column in columns]
    return determinant([[unit[system.word(evidence["words"][row])] for unit in names] for row in rows])


def ranks(system, record, evidence):
    for state in evidence["states"]:
        of = minor(system, record, evidence, state["minor"]["rows"], state["minor"]["columns"])
        if len(state["minor"]["rows"]) != state["rank"] or witness(state["state"])[of].sign() == 0:
            raise Doubt("a minor is zero, or of another size")
    return "confirmed", f"the rank is no less at {len(evidence['states'])} states"


def boxes(system, record, evidence):
    whole = {symbol(side["symbol"]): (Fraction(side["low"]), Fraction(side["high"])) for side in evidence["ranges"]}
    free, volume, seen = {name: ends for name, ends in whole.items() if ends[0] < ends[1]}, Fraction(0), []
    for box in evidence["boxes"]:
        sides, part = [(Fraction(low), Fraction(high)) for low, high in box["sides"]], Fraction(1)
        for (least, most), (low, high) in zip(free.values(), sides, strict=True):
            part *= (high - low) / (most - least) if least <= low < high <= most else 0
        if not part or any(all(a < d and c < b for (a, b), (c, d) in zip(sides, other)) for other in seen):
            raise Doubt("a box is no part of the whole, or has a part in common with another one")
        volume, seen = volume + part, [*seen, sides]
        of = minor(system, record, evidence, box["rows"], range(len(evidence["columns"])))
        if any(node.kind == "symbol" and node not in (*whole, symbol("pi")) for node in of.below()):
            refuse("a symbol without a range")
        if not has_one_sign(system, of, {**whole, **dict(zip(free, sides))}):
            refuse(f"a box that is not shown by {PIECES} pieces")
    if volume != Fraction(evidence["volume"]):
        raise Doubt("the boxes have another volume")
    return "confirmed", f"{len(seen)} boxes"


def has_one_sign(system, of, box):
    """Whether an expression has it in a box: from the middle by slopes, on pieces, halved where it varies most."""
    waiting = [box]
    for _ in range(PIECES):
        sides, parts, is_told = waiting.pop(), {}, False
        middle = {name: (low + high) / 2 for name, (low, high) in sides.items()}
        inside, found = Enclosure({name: Interval(*ends) for name, ends in sides.items()}), None
        with contextlib.suppress(NotRead, ZeroDivisionError):
            for name, (low, high) in sides.items():
                parts[name] = inside[system.unit(name.args[0])[of]] * Interval(low - middle[name], high - middle[name])
            found = Enclosure({name: Interval(x) for name, x in middle.items()})[of]
            is_told = sum(parts.values(), found).sign() != 0
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
        (kind, evidence), = record["evidence"].items()
        if kind == "unchecked":
            return "not checked", str(evidence)
        path = os.path.join(folder, record["file"])
        if path not in systems or len(Node.known) > MOST // 4:
            systems.clear()
            Node.known.clear()
            systems[path] = System(path)
        if kind in ("refuted", "rank", "boxes"):
            return {"refuted": refuted, "rank": ranks, "boxes": boxes}[kind](systems[path], record, evidence)
        return at_random(systems[path], record, evidence, seed)
    except Doubt as why:
        return "not confirmed", str(why)
    except ZeroDivisionError:
        return "not confirmed", "it has no value at the witness"
    except NotRead as why:
        return "not checked", str(why)
    except Exception as why:  # whatever a damaged record or file leads to
        return "not checked", f"the record or its file is not as it should be: {why!r}"


def main(arguments):
    """The command; returns its exit status."""
    folder = arguments[arguments.index("--proofs") + 1] if "--proofs" in arguments[:-1] else "."
    files = [x for x in arguments if x not in ("--proofs", folder)]
    if not files or files[0].startswith("-"):
        print(__doc__)
        return 0 if files and files[0] in ("-h", "--help") else 2
    counts, systems = {}, {}
    for path in files:
        try:
            with open(path, encoding="utf-8") as file:
                verdicts = json.load(file)
            if verdicts["schema"] != "palmistry-verdicts" or verdicts["version"] not in (1, 2):
                raise ValueError("another schema")
            records = [(f"{record['file']} {record['id']}", record) for record in verdicts["verdicts"]]
        except (OSError, ValueError, KeyError, TypeError, RecursionError) as why:
            print(f"{path} is no verdict file: {why!r}", file=sys.stderr)
            return 2
        for seed, (name, record) in enumerate(records):
            word, why = check(record, folder, systems, seed)
            counts[word] = counts.get(word, 0) + 1
            print(f"{word:14}{name}: {why}", flush=True)
    print(", ".join(f"{count} {word}" for word, count in sorted(counts.items())))
    return 1 if counts.get("not confirmed") else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
