"""A second checker of verdict files, which shares no line with the program that wrote them.

    python -m palmistry.recheck VERDICTS.json [--proofs FOLDER]

From a verdict file (`palmistry prove proofs/ --verdicts FILE`) only witnesses, minors and boxes are taken; what they are about is read anew from
the proof file (`proof_file`), into a graph of expressions (`graph`). Refutations are evaluated at their witness, minors at their states, in
fractions and, where there are functions, in intervals; minors of boxes in intervals; identities and ranks at almost all states at points modulo
primes of this program's own choice. `confirmed` is so; `consistent`: nothing speaks against it; what is not read is `not checked`, and why.
The exit status is 1 where something is not confirmed, and 2 for what is no verdict file.
"""

import json
import os
import sys
from fractions import Fraction

from .graph import MOST, Expressions, Interval, Intervals, Modulo, Node, NotRead, Point, below, call, number, refuse, symbol
from .proof_file import ProofFile, determinant, each, entries

PRIMES = [(1 << 61) - 1, (1 << 89) - 1, (1 << 107) - 1]
POINTS, TRIES, WORDS, PIECES = 4, 40, 200, 500  # points that are compared; draws; words of a rank; pieces of a box
HOLDS = {"=": lambda s: s == 0, "!=": lambda s: s != 0, "<": lambda s: s < 0, "<=": lambda s: s <= 0, ">": lambda s: s > 0, ">=": lambda s: s >= 0}


class Doubt(Exception):
    """What speaks against a verdict."""


def gaps(relation): return entries(each(Node.__sub__, relation[0], relation[2]))
def holds(point, relation): return all(HOLDS[relation[1]](point.value(gap).sign()) for gap in gaps(relation))


def adds(row, basis, domain):
    """Whether a row is independent of a basis, to which it is added then: rows with a one in a column, by this column."""
    for column, other in basis:
        factor = row[column] * domain.number(Fraction(-1))
        row = [domain.number(Fraction(0)) if place == column else x + factor * y for place, (x, y) in enumerate(zip(row, other))]
    told = []
    for column, x in enumerate(row):
        try:
            told.append((column, x.sign()))
        except NotRead:
            continue
    pivot = next((column for column, sign in told if sign), None)
    if pivot is None:
        return False if len(told) == len(row) else refuse("a value that is not told from zero")
    basis.append((pivot, [x * row[pivot] ** -1 for x in row]))
    return True


def rank(rows, domain, basis=()):
    basis = list(basis)
    return sum(adds(row, basis, domain) for row in rows)


def put(of, name, value): return Point(Expressions, {name: value}).value(of)


def solved(conditions, unit):
    """Symbols with the values that equations among the conditions give them, one after the other."""
    found = []
    for left, relation, right in conditions:
        for gap in gaps((left, relation, right)) if relation == "=" else ():
            for name, value in found:
                gap = put(gap, name, value)
            if gap is not number(0):
                found.append(solution(gap, left[0][0], unit))
    return found


def solution(gap, first, unit):
    """A symbol in which the gap is linear, or an angle for which it is zero at some quarter turns."""
    names = sorted((node for node in below(gap) if node.kind == "symbol" and node is not symbol("pi")), key=lambda node: (node is not first, node.place))
    slopes = [(name, unit(name.args[0]).along(gap)) for name in names]
    for name, slope in sorted(slopes, key=lambda pair: (pair[0] is not first, pair[1].kind != "number")):
        if slope is not number(0) and name not in below(slope):
            return name, -put(gap, name, number(0)) / slope
    turns = [(name, number(Fraction(quarter, 2)) * symbol("pi")) for name in names for quarter in range(4)]
    zero = [(name, turn) for name, turn in turns if put(gap, name, turn) is number(0)]
    return zero[0] if zero else refuse("a condition that is not solved")


def compared(system, conditions, seed, compare):
    """What is found at random points modulo primes on the set of the conditions; inequalities hold somewhere near, and do not matter."""
    found, guessed, given = [], False, solved(conditions, system.unit)
    for draw in range(TRIES):
        point = Point(Modulo(PRIMES[draw % len(PRIMES)], (seed, draw)), {})
        try:
            for name, value in reversed(given):
                nodes = {name: value, Node("sin", name): call("sin", value), Node("cos", name): call("cos", value)}
                point.values.update({node: point.value(of) for node, of in nodes.items()})
            found.append(compare(point))
        except ZeroDivisionError:
            continue
        guessed |= point.domain.guessed
        if len(found) == POINTS:
            break
    return (found, guessed) if found else refuse("no point was found at which it has values")


def codistribution(system, point, conditions):
    """The rows of words, until further ones add nothing; where there are no conditions, words that add nothing are not followed."""
    columns, words, rows, basis, idle = system.states + system.unknown, system.seen(), [], [], 0
    while words and idle <= (len(conditions) + 1 if conditions else 0):
        before, followed = len(basis), []
        for word in dict.fromkeys(words):
            row = point.slopes(word, columns)
            if adds(row, basis, point.domain) or conditions:
                followed.append(word)
                rows.append([x for x, name in zip(row, columns) if name not in system.known])
        idle = 0 if len(basis) > before else idle + 1
        words = [system.fields[field].along(word) for word in followed for field in system.moving]
        if len(rows) + len(words) > WORDS:
            refuse(f"more than {WORDS} words")
    return rows


def at_random(system, statement, is_proved, seed):
    """An identity, a rank at almost all states, or what is observable at almost all states."""
    asked, of, claimed, conditions = statement

    def measured(point):
        if not asked:
            return all(point.value(gap).sign() == 0 for gap in gaps(of))
        rows = each(point.value, of) if asked == "rank" and of else codistribution(system, point, conditions)
        found = rank(rows, point.domain)
        further = [] if asked == "rank" else [rank([*rows, point.slopes(x, system.columns())], point.domain) > found for x in of]
        return found if asked == "rank" else all(more == asked.startswith("un") for more in further)
    if not asked and of[1] != "=":
        refuse("an inequality")
    found, guessed = compared(system, conditions, seed, measured)
    if (max(found) == claimed if asked == "rank" else all(found)) != is_proved:
        if guessed:
            refuse("functions that were taken for unknowns")
        raise Doubt(f"the rank is {max(found)} at random points" if asked == "rank" else "it is not so at a random point modulo a prime")
    return "consistent", f"{len(found)} points modulo primes"


def witness(state):
    """The point of a witness; what it does not name does not matter, and may have any value."""
    point = Point(Intervals(), {})
    for name, value in state.items():
        told, of = [Fraction(value[key]) for key in ("number",) if key in value], symbol(name)
        if "angle" in value:
            sine, cosine = Fraction(value["angle"]["sin"]), Fraction(value["angle"]["cos"])
            if sine**2 + cosine**2 != 1:
                raise Doubt(f"{name} is no angle")
            point.values.update({Node("sin", of): Interval(sine, sine), Node("cos", of): Interval(cosine, cosine)})
        else:
            point.values[of] = Interval(told[0], told[0]) if told else refuse("a coordinate that is told by an operation")
    return point


def refuted(relation, conditions, state):
    point = witness(state)
    if not all(holds(point, condition) for condition in conditions):
        raise Doubt("a condition does not hold at the witness")
    if holds(point, relation):
        raise Doubt("what was refuted holds at the witness")
    return "confirmed", "at its witness"


def matrix_of(system, record, evidence):
    """What a record names by rows and columns: differentials of words, or a matrix of the file's own."""
    if evidence["columns"][0] == "column 1":
        of = system.statement(record["statement"])[1]
        return [of[int(word.split()[1]) - 1] for word in evidence["words"]]
    return [[system.unit(column).along(system.word(word)) for column in evidence["columns"]] for word in evidence["words"]]


def minor(matrix, rows, columns, size):
    if not len(set(rows)) == len(rows) == len(set(columns)) == len(columns) == size or min([0, *rows, *columns]) < 0:
        raise Doubt("it has no minor of its rank")
    return [[matrix[row][column] for column in columns] for row in rows]


def ranks(matrix, states):
    for state in states:
        point, of = witness(state["state"]), minor(matrix, state["minor"]["rows"], state["minor"]["columns"], state["rank"])
        if rank(each(point.value, of) if of else [], point.domain) != state["rank"]:
            raise Doubt("a minor is zero")
    return "confirmed", f"the rank is no less at {len(states)} states"


def nowhere_zero(of, sides):
    """Whether an expression has one sign in a box, by intervals and the mean value theorem on pieces of the box."""
    waiting, names = [sides], [name.args[0] for name in sides]
    for _ in range(PIECES):
        sides = waiting.pop()
        middle = {name: (side.low + side.high) / 2 for name, side in sides.items()}
        parts = {name: side.high - side.low for name, side in sides.items()}
        try:
            near = Point(Intervals(), {name: Interval(x, x) for name, x in middle.items()}).value(of)
            for (name, side), slope in zip(sides.items(), Point(Intervals(), sides).slopes(of, names)):
                part = slope * Interval(side.low - middle[name], side.high - middle[name])
                near, parts[name] = near + part, part.high - part.low
            is_told = near.sign() != 0
        except (NotRead, ZeroDivisionError):
            is_told = False
        if not is_told:
            most = max(sides, key=lambda name: parts[name])
            ends = sides[most].low, middle[most], sides[most].high
            waiting += [{**sides, most: Interval(*half)} for half in (ends[:2], ends[1:])]
        if not waiting:
            return True
    return False


def boxes(matrix, evidence):
    whole = {symbol(side["symbol"]): (Fraction(side["low"]), Fraction(side["high"])) for side in evidence["ranges"]}
    free, volume, seen = {name: ends for name, ends in whole.items() if ends[0] < ends[1]}, Fraction(0), []
    for box in evidence["boxes"]:
        sides, part = [(Fraction(low), Fraction(high)) for low, high in box["sides"]], Fraction(1)
        for (least, most), (low, high) in zip(free.values(), sides):
            part *= (high - low) / (most - least) if least <= low < high <= most else 0
        if not part or len(sides) != len(free) or any(all(a < d and c < b for (a, b), (c, d) in zip(sides, other)) for other in seen):
            raise Doubt("a box is no part of the whole, or has a part in common with another one")
        volume, seen = volume + part, [*seen, sides]
        of = determinant(minor(matrix, box["rows"], range(len(matrix[0])), len(matrix[0])))
        if any(node.kind == "symbol" and node not in {**whole, symbol("pi"): 0} for node in below(of)):
            refuse("a symbol without a range")
        if not nowhere_zero(of, {name: Interval(*ends) for name, ends in {**whole, **dict(zip(free, sides))}.items()}):
            refuse(f"a box that is not shown by {PIECES} pieces")
    if volume != Fraction(evidence["volume"]):
        raise Doubt("the boxes have another volume")
    return "confirmed", f"{len(seen)} boxes"


def check(record, folder, systems, seed):
    """What comes of one verdict: a word, and why."""
    try:
        (kind, evidence), = record["evidence"].items()
        Node.work = 0
        if kind == "unchecked":
            return "not checked", str(evidence)
        path = os.path.join(folder, record["file"])
        if path not in systems:
            systems.clear()
            Node.known.clear()
            systems[path] = ProofFile(path)
        system = systems[path]
        if kind in ("rank", "boxes"):
            matrix = matrix_of(system, record, evidence)
            return ranks(matrix, evidence["states"]) if kind == "rank" else boxes(matrix, evidence)
        statement = system.statement(record["statement"])
        if kind == "refuted":
            return refuted(statement[1], statement[3], evidence["state"]) if not statement[0] else refuse("a rank without a minor")
        return at_random(system, statement, evidence.get("word", "proved") == "proved", seed)
    except (NotRead, RecursionError, OSError) as why:
        if len(Node.known) > MOST // 4:
            systems.clear()
        return "not checked", str(why) or "it is nested too deeply"
    except (ValueError, KeyError, TypeError, AttributeError, IndexError) as why:
        return "not checked", f"the record or its file is not as it should be: {why!r}"
    except ZeroDivisionError:
        return "not confirmed", "it has no value at the witness"
    except Doubt as why:
        return "not confirmed", str(why)


def main(arguments):
    """The command; returns its exit status."""
    folder = arguments[arguments.index("--proofs") + 1] if "--proofs" in arguments[:-1] else "."
    files = [x for x in arguments if x != "--proofs" and x != folder]
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
