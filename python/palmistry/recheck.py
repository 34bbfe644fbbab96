"""A second checker of verdict files, which shares no line with the program that wrote them.

    python -m palmistry.recheck VERDICTS.json [--proofs FOLDER]

From a verdict file (`palmistry prove proofs/ --verdicts FILE`) only witnesses and minors are taken. What they are about is read from the
proof file anew (`proof_file`), by a parser of its own that makes functions of the expressions; derivatives are dual numbers (`values`).
Refutations are evaluated at their witness, in fractions, and in intervals where there are functions; identities and ranks at points
modulo primes of this program's own choice; minors at their states. `confirmed` is so; `consistent`: nothing speaks against it; what is not
read is `not checked`, and why. The exit status is 1 where something is not confirmed.
"""

import json
import os
import random
import sys
from fractions import Fraction

from .proof_file import Environment, ProofFile, lie, slopes
from .values import Arc, NotRead, Residue, apply, determinant, matrix, number, refuse

PRIMES = [(1 << 61) - 1, (1 << 89) - 1, (1 << 107) - 1]
POINTS, TRIES, WORDS = 4, 60, 150  # points that are compared; draws; words of a rank
WORK = 5_000  # evaluations of a word that a derivative of words may take
HOLDS = {"=": lambda s: s == 0, "!=": lambda s: s != 0, "<": lambda s: s < 0, "<=": lambda s: s <= 0, ">": lambda s: s > 0,
         ">=": lambda s: s >= 0}


class Doubt(Exception):
    """What speaks against a verdict."""


def sign(x):
    """The sign of a fraction or of an interval that tells it."""
    low, high = (x.low, x.high) if hasattr(x, "low") else (x, x)
    if low <= 0 <= high and low != high:
        refuse("a value that is not told from zero")
    return (low > 0) - (high < 0)


def value_of(x):
    """A value that is no turn and no angle any more."""
    return x.value(Residue(0, PRIMES[0])) if type(x).__name__ == "Turn" else x


def witness(system, state):
    """The values of a witness; what it does not name does not matter, and may have any."""
    angle = Arc(Fraction(3, 5), Fraction(4, 5))
    values = {name: angle if name in system.angles else Fraction(3 + k, 7) for k, name in enumerate(sorted(system.symbols))}
    for name, value in state.items():
        if "number" in value:
            values[name] = Fraction(value["number"])
        elif "angle" in value:
            sine, cosine = Fraction(value["angle"]["sin"]), Fraction(value["angle"]["cos"])
            if sine**2 + cosine**2 != 1:
                raise Doubt(f"{name} is no angle")
            values[name] = Arc(sine, cosine)
        else:
            refuse("a coordinate that is told by an operation")
    return Environment(values)


def points(system, conditions, seed):
    """Random points modulo primes on the set of the conditions."""
    rng = random.Random(seed)
    for draw in range(TRIES):
        prime, values = PRIMES[draw % len(PRIMES)], {}
        for name in sorted(system.symbols):
            value = Residue(rng.randrange(prime), prime)
            values[name] = Arc.of_half(value) if name in system.angles else value
        try:
            if all(relation == "=" for _, _, relation, _ in conditions) and solved(conditions, values, prime):
                yield Environment(values)
        except ZeroDivisionError:
            continue


def solved(conditions, values, prime):
    """Whether a symbol of each equation could be given a value with which all hold: it is linear in it, or an angle of a quarter turn."""
    gap = lambda condition: value_of(number(condition[1](Environment(values))) - number(condition[3](Environment(values))))
    is_zero = lambda x: (x.value if isinstance(x, Residue) else x) == 0
    free = set(values)
    for condition in conditions:
        names = sorted(free, key=lambda name: (name != condition[0], name not in condition[0], name))
        if isinstance(values.get(condition[0]), Arc):
            turn = number(condition[3](Environment(values)))
            values[condition[0]] = Arc(apply("sin", turn), apply("cos", turn))
            free.discard(condition[0])
            continue
        for name in names:
            kept, tried = values[name], []
            if isinstance(kept, Arc):
                tried = [Arc(Fraction(s), Fraction(c)) for s, c in ((0, 1), (1, 0), (0, -1), (-1, 0))]
            else:
                try:
                    ends = []
                    for end in (0, 1):
                        values[name] = Residue(end, prime)
                        ends.append(gap(condition))
                    tried = [-(Residue(0, prime) + ends[0]) / (ends[1] - ends[0])]
                except (ZeroDivisionError, AttributeError, NotRead):
                    pass
            for value in tried:
                values[name] = value
                try:
                    if is_zero(gap(condition)):
                        break
                except ZeroDivisionError:
                    pass
            else:
                values[name] = kept
                continue
            free.discard(name)
            break
        else:
            return False
    return all(is_zero(gap(condition)) for condition in conditions)


def pairs(left, right, at):
    """Entries of two sides, which are numbers or matrices."""
    a, b = matrix(left(at)), matrix(right(at))
    if [len(row) for row in a] != [len(row) for row in b]:
        refuse("sides of two shapes")
    return [pair for rows in zip(a, b) for pair in zip(*rows)]


def compared(system, conditions, seed, compare):
    """What is found at random points, where there are values."""
    found = []
    for at in points(system, conditions, seed):
        try:
            found.append(compare(at))
        except ZeroDivisionError:
            continue
        if len(found) == POINTS:
            break
    return found or refuse("no point was found at which it has values")


def identity(system, statement, seed):
    relation, left, right, conditions = statement
    if relation != "=":
        refuse("an inequality")
    zero = lambda x: (x.value if isinstance(x, Residue) else x) == 0
    Residue.guessed = False
    same = compared(system, conditions, seed, lambda at: all(zero(value_of(a - b)) for a, b in pairs(left, right, at)))
    if not all(same):
        if Residue.guessed:
            refuse("functions that were taken for unknowns")
        raise Doubt("the two sides differ at a random point modulo a prime")
    return "consistent", f"{len(same)} points modulo primes"


def refuted(system, statement, evidence):
    relation, left, right, conditions = statement
    if relation == "rank":
        refuse("a rank without a minor")
    at = witness(system, evidence["state"])
    for _, a, stands, b in conditions:
        if not HOLDS[stands](sign(number(a(at)) - number(b(at)))):
            raise Doubt("a condition does not hold at the witness")
    if all(HOLDS[relation](sign(a - b)) for a, b in pairs(left, right, at)):
        raise Doubt("what was refuted holds at the witness")
    return "confirmed", "at its witness"


def rank_of(rows):
    """The rank of a matrix of residues."""
    rows, rank = [[x if isinstance(x, Residue) else x for x in row] for row in rows], 0
    is_zero = lambda x: (x.value if isinstance(x, Residue) else x) == 0
    for column in range(len(rows[0])):
        pivot = next((r for r in range(rank, len(rows)) if not is_zero(rows[r][column])), None)
        if pivot is not None:
            rows[rank], rows[pivot] = rows[pivot], rows[rank]
            for row in rows[rank + 1:]:
                if not is_zero(row[column]):
                    factor = row[column] / rows[rank][column]
                    row[:] = [a - factor * b for a, b in zip(row, rows[rank])]
            rank += 1
    return rank


def claimed_rank(system, statement, evidence, seed):
    kind, of, claimed, conditions = statement
    if kind != "rank":
        refuse("no rank")

    def rank_here(at):
        if of is not None:
            return rank_of(of(at))
        rows, words, rank, columns = [], list(system.outputs), -1, system.columns()
        for order in range(len(columns) + 1):
            rows += [slopes(word, columns)(at)[0] for word in words]
            before, rank = rank, rank_of(rows)
            if rank == len(columns) or rank == before and (order > len(conditions) + 1 or not conditions):
                return rank
            words = [lie(system.fields[field], word) for word in words for field, _ in system.moving]
            if len(words) + len(rows) > WORDS:
                refuse(f"more than {WORDS} words")
            # a derivative along a field is taken of the one before anew
            if len(words) * 2 ** order * len(columns) > WORK:
                refuse(f"derivatives of order {order + 1} take too long here")
        return rank
    ranks = compared(system, conditions, seed, rank_here)
    if (max(ranks) == claimed) != (evidence["word"] == "proved"):
        raise Doubt(f"the rank is {max(ranks)} at random points")
    return "consistent", f"rank {max(ranks)} at {len(ranks)} points modulo primes"


def certified_rank(system, evidence):
    words = [system.word(text) for text in evidence["words"]]
    for place, state in enumerate(evidence["states"]):
        at, rows, columns = witness(system, state["state"]), state["minor"]["rows"], state["minor"]["columns"]
        if len(set(rows)) != state["rank"] or len(set(columns)) != state["rank"]:
            raise Doubt(f"state {place} has no minor of its rank")
        names = [evidence["columns"][column] for column in columns]
        if rows and sign(determinant([slopes(words[row], names)(at)[0] for row in rows])) == 0:
            raise Doubt(f"the minor of state {place} is zero")
    return "confirmed", f"the rank is no less at {len(evidence['states'])} states"


def check(record, folder, systems, seed):
    """What comes of one verdict: a word, and why."""
    (kind, evidence), = record["evidence"].items()
    if kind in ("unchecked", "boxes"):
        return "not checked", str(evidence) if kind == "unchecked" else "boxes"
    try:
        path = os.path.join(folder, record["file"])
        if path not in systems:
            systems[path] = ProofFile(path)
        system = systems[path]
        if kind == "rank":
            return certified_rank(system, evidence)
        statement = system.statement(record["statement"])
        if kind == "refuted":
            return refuted(system, statement, evidence)
        return claimed_rank(system, statement, evidence, seed) if kind == "claimed_rank" else identity(system, statement, seed)
    except (NotRead, RecursionError, OSError) as why:
        return "not checked", str(why) or "it is nested too deeply"
    except ZeroDivisionError:
        return "not confirmed", "it has no value at the witness"
    except Doubt as why:
        return "not confirmed", str(why)


def main(arguments):
    """The command; returns its exit status."""
    folder, files = ".", []
    while arguments:
        first = arguments.pop(0)
        if first == "--proofs" and arguments:
            folder = arguments.pop(0)
        elif first.startswith("-"):
            print(__doc__)
            return 0 if first in ("-h", "--help") else 2
        else:
            files.append(first)
    if not files:
        print("which verdict file? 'palmistry prove proofs/ --verdicts FILE' writes one", file=sys.stderr)
        return 2
    sys.setrecursionlimit(20_000)
    counts, systems, number_of = {}, {}, 0
    for path in files:
        try:
            with open(path, encoding="utf-8") as file:
                verdicts = json.load(file)
            if verdicts["schema"] != "palmistry-verdicts" or verdicts["version"] not in (1, 2):
                raise ValueError("another schema")
            records = verdicts["verdicts"]
        except (OSError, ValueError, KeyError, TypeError) as why:
            print(f"{path} is no verdict file: {why!r}", file=sys.stderr)
            return 2
        for record in records:
            number_of += 1
            word, why = check(record, folder, systems, number_of)
            counts[word] = counts.get(word, 0) + 1
            print(f"{word:14}{record['file']} {record['id']}: {why}")
    print(", ".join(f"{count} {word}" for word, count in sorted(counts.items())))
    return 1 if counts.get("not confirmed") else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
