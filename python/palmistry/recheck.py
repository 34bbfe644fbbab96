"""A second checker of verdict files, which shares no line with the program that wrote them.

    python -m palmistry.recheck VERDICTS.json [--proofs FOLDER] [--quiet]

From a verdict file (`palmistry prove proofs/ --verdicts FILE`) only witnesses, minors and boxes are taken; the claims that
they are about are read anew from the proof files (`proof_file`), into a graph of expressions (`graph`). `confirmed`: the
evidence implies the verdict, or both sides of an equation are one once they are multiplied out, or it is so at random points modulo random primes, with a
probability of an error below 2^-100. `half confirmed`: one half of it, such as that a rank is no less. `consistent`: nothing speaks
against it at random points modulo primes. What is not read, or takes too much work, is `not checked`, and why.
The exit status is 1 where something is not confirmed, and 2 for what is no verdict file.
"""

import json
import os
import re
import secrets
import sys
from collections import Counter
from contextlib import suppress
from fractions import Fraction
from math import prod
from operator import sub

from .bounds import Sizes, is_enough, prime
from .graph import (MADE, RUN, Expression, Interval, Map, Modulo, Node, Spent, call, derivation, enclosed, forget, number, put_in, refuse,
                    short, spend, symbol)
from .multiplied import Fields, are_zero, attempt
from .proof_file import BYTES, HOLDS, System, determinant, each, entries, read_text, spelled
from .proof_parser import compact, parts

PRIMES = (1 << 61) - 1, (1 << 89) - 1, (1 << 107) - 1  # by which the same is found each time
SECRET, SALT = [prime() for _ in range(4)], secrets.token_hex(16)  # and those for which no file can be written
POINTS, TRIES, WORDS, PIECES, WIDE = 4, 40, 200, 500, 8  # compared; drawn; words; pieces of a box; columns of fields with all coefficients
MOST, FEE = 1_000_000, 100  # the work on one graph, behind which a new one is begun; of each record, whatever it is
LARGEST, VALUES, DIGITS = 1 << 28, 1 << 25, 40  # bytes of a verdict file; its values, brackets for eight; digits of a number
KINDS = "refuted", "proved", "rank", "claimed_rank", "boxes", "unchecked"
WORDS_OF_FINDINGS = "confirmed", "half confirmed", "consistent", "not checked", "not confirmed"

def fraction(text):
    """A number of a verdict file: digits, and no exponent that a few letters make long."""
    return Fraction(text) if re.fullmatch(r"-?\d{1,4000}(?:/\d{1,4000})?", text) else doubt("no number")

def gaps(relation): return entries(each(sub, relation[0], relation[2]))
def holds(point, relation): return all(HOLDS[relation[1]](point[gap].sign(), 0) for gap in gaps(relation))
class Doubt(Exception):
    """That something is not so."""

def doubt(why): raise Doubt(why)

def adds(row, basis, prime):
    """Whether a row is independent of a basis, to which it is added then, with a one in a column."""
    spend(len(basis) * len(row) // 16)
    for column, other in basis.items():
        row = [(x - row[column] * y) % prime for x, y in zip(row, other)]
    column = next((column for column, x in enumerate(row) if x), None)
    if column is not None:
        basis[column] = [x * pow(row[column], -1, prime) % prime for x in row]
    return column is not None

def unknown_in(gap): return [node for node in gap.below() if node.kind == "symbol" and node is not symbol("pi")]

def solution(system, gap):
    """A symbol in which a gap is linear, or for which it is zero at a quarter turn, and its value."""
    names, zero = unknown_in(gap), number(0)
    slopes = [(name, system.unit(name.args[0])[gap]) for name in names]
    for name, slope in sorted(slopes, key=lambda pair: pair[1].kind != "number"):
        if slope is not zero and name not in slope.below():
            return name, -Map(put_in, {name: zero})[gap] / slope
    turns = [(name, turn) for name in names for turn in (zero, number("1/2") * symbol("pi"))]
    return next((x for x in turns if Map(put_in, [x])[gap] is zero), None) or refuse("a condition that is not solved")

def is_solved_wholly(system, conditions):
    """Whether the equations among some conditions each give a symbol on all of their set: with a slope that is a number."""
    given = []
    for gap in [gap for relation in conditions if relation[1] == "=" for gap in gaps(relation)]:
        for one in given:
            gap = Map(put_in, [one])[gap]
        if gap is not number(0):
            if not any((slope := system.unit(name.args[0])[gap]).kind == "number" and slope is not number(0) for name in unknown_in(gap)):
                return False
            given.append(solution(system, gap))
    return True

def solved(system, conditions):
    """What the equations among some conditions say of symbols: none is met in its own value or in a later one."""
    found = []
    for gap in [gap for relation in conditions if relation[1] == "=" for gap in gaps(relation)]:
        for given in found:
            gap = Map(put_in, [given])[gap]
        found += [solution(system, gap)] if gap is not number(0) else []
    return found

def points(given, seed, primes=PRIMES):
    """Random points modulo primes on the set of the equations; inequalities hold somewhere, and do not matter."""
    orders = {}
    for draw in range(TRIES):
        point = Modulo(primes[draw % len(primes)], (seed, draw), orders)
        with suppress(ZeroDivisionError):
            for name, value in reversed(given):
                turns = {Node(kind, name): call(kind, value) for kind in ("sin", "cos")}
                point.update({node: point[of] for node, of in {name: value, **turns}.items()})
            yield point

def motion(system, given):
    """The outputs, and what differentiates it: with the values of constants put in, which commutes with that and is shorter."""
    names, fixed = {*system.names["param"], "pi"} - {*system.names["state"], *system.names["unknown"]}, Map(put_in)
    for name, value in reversed(given):
        if all(node.args[0] in names for node in (name, *value.below()) if node.kind == "symbol"):
            fixed[name] = fixed[value]
    fields = [system[field].along for field in system.names["moving"]]
    if not fixed:
        return system.seen(), fields
    return [fixed[x] for x in system.seen()], [derivation(lambda name, f=f: fixed[f[symbol(name)]]) for f in fields]

def codistribution(system, point, moving, patience):
    """The rows of all Lie derivatives; those behind more of them than `patience` that add nothing are not looked at."""
    columns, (seen, fields) = system.names["state"] + system.names["unknown"], moving
    words, rows, basis = dict.fromkeys((word, 0) for word in seen), [], {}
    waiting = [*words]
    for word, idle in waiting:
        row = point.gradient(word, columns)
        rows.append([x for x, name in zip(row, columns) if name not in system.names["initial"]])
        idle = 0 if adds(row, basis, point.prime) else idle + 1
        new = dict.fromkeys((along[word], idle) for along in fields if idle <= patience)
        waiting += [pair for pair in new if pair not in words]
        words.update(new)
        if len(words) > WORDS:
            refuse(f"more than {WORDS} Lie derivatives")
    return [word for word, _ in waiting], rows

def is_so(system, point, asked, of, claimed, moving, patience):
    """Whether an identity, a generic rank, or what is observable generically is so at a point; and the rank."""
    if asked == "=":
        return all(point[gap] == 0 for gap in gaps(of)) if of[1] == "=" else refuse("an inequality"), 0
    basis, rows = {}, each(point.__getitem__, of) if asked == "rank" and of else codistribution(system, point, moving, patience)[1]
    rank = sum(adds(row, basis, point.prime) for row in rows)
    if asked == "rank":
        return rank == claimed, rank
    return all(adds(point.gradient(x, system.columns()), {**basis}, point.prime) == asked.startswith("un") for x in of), rank

def at_random(system, record, _, seed):
    """An identity, or what is claimed generically, at random points."""
    (asked, of, claimed, conditions), found, least = system.statement(system.claims[record["id"]]), 0, None
    is_proved, sense = record["verdict"] == "proved", record["asked"]["sense"]
    given, patience = solved(system, conditions), len(conditions) + 1 if conditions else 0
    moving = None if asked == "=" or asked == "rank" and of else motion(system, given)
    for point in points(given, seed):
        with suppress(ZeroDivisionError):
            so, rank = is_so(system, point, asked, of, claimed, moving, patience)
            if asked == "rank" and sense != "generic" and so and not is_proved:
                refuse("a rank that is another at some states alone")
            if so != is_proved:
                why = "functions that were taken for unknowns"
                refuse(why) if point.guessed else doubt("it is not so at a random point modulo a prime")
            found, least = found + 1, rank if least is None else min(least, rank)
            if point.guessed or conditions or asked != "rank" or sense != "generic" or not exists(system, point):
                least = 0
        if found == POINTS:
            return of_a_rank(system, of, claimed, least, is_proved, f"{found} points modulo primes")
    return refuse(f"it has values at {found} of {TRIES} random points")

def proved(system, record, evidence, seed):
    """What is so at random points, and is shown for all states where it is an equation that can be multiplied out, or generically where fields that keep the system show the rest."""
    found = at_random(system, record, evidence, seed)
    asked, of, _, conditions = system.statement(system.claims[record["id"]])
    if found[0] not in ("consistent", "half confirmed") or record["verdict"] != "proved":
        return found
    if asked == "=":
        given = [gap for relation in conditions if relation[1] == "=" for gap in gaps(relation)]
        if are_zero(system, gaps(of), given):
            return "confirmed", "multiplied out"
    is_meant = record["asked"]["sense"] == "generic" and not conditions and not (asked == "rank" and of)
    if is_meant and any(by_fields(system, asked, of, seed, is_whole) for is_whole in (False, True)):
        return "confirmed", "by the fields that keep the system"
    is_meant = asked == "=" or record["asked"]["sense"] == "generic"
    word = attempt(lambda: with_bounds(system, record, evidence, seed)) if is_meant else None
    return {"all": ("confirmed", f"{POINTS} points modulo random primes, probability of an error below 2^-100"),
            "half": ("half confirmed", f"the rank is no less; no greater at {POINTS} points modulo primes")}.get(word, found)

def is_met(system, evidence, conditions):
    """Whether inequalities hold strictly at a state of the evidence, which meets all conditions: near it they leave an open part of the set."""
    if all(relation[1] == "=" for relation in conditions):
        return True
    states = [evidence["state"]] if "state" in evidence else [one["state"] for one in evidence["matrix"]["states"][:1]]
    for state in states:
        point = witness(system, state, *all_gaps(*conditions))
        strict = all(point[gap].sign() != 0 for relation in conditions if relation[1] != "=" for gap in gaps(relation))
        return strict and all(holds(point, relation) for relation in conditions)
    return False

def with_bounds(system, record, evidence, seed):
    """`all` where what is claimed is so at as many points as the sizes of its numerators ask for, `half` where a rank is no less, or nothing. A minor that
    is not zero at one point is generically not zero, since the functions that are met are algebraically independent."""
    asked, of, claimed, conditions = system.statement(system.claims[record["id"]])
    if system.names["initial"] or not is_solved_wholly(system, conditions) or not is_met(system, evidence, conditions):
        return None
    given, columns = solved(system, conditions), system.names["state"] + system.names["unknown"]
    sizes, found, is_whole, least = Sizes(), 0, True, None
    is_system = asked != "=" and not (asked == "rank" and of)
    moving = motion(system, given) if is_system else None
    if is_system and columns != system.columns():
        return None
    rates = [along[symbol(name)] for along in moving[1] for name in columns] if moving else []
    roots = [*rates, *moving[0], *(of or [])] if moving else gaps(of) if asked == "=" else [x for row in of for x in row]
    names, met = {name for name, _ in given}, {(node.kind, node.parts[0]) for root in roots for node in root.below() if node.parts}
    if any(("exp", name) in met for name in names):
        return None  # what is given has no exponential that is a variable of its own
    for name, value in reversed(given):
        sizes[name] = sizes[value]
        if {("sin", name), ("cos", name)} & met:
            sizes.update({Node(kind, name): sizes[call(kind, value)] for kind in ("sin", "cos")})
    is_plain = all(value.kind == "number" and not {("sin", name), ("cos", name)} & met for name, value in given)
    for point in points(given, (SALT, seed), SECRET):
        point.guessed &= not is_plain  # sines of numbers that nothing asks for
        with suppress(ZeroDivisionError):
            if not exists(system, point):
                return None
            if asked == "=":
                if any(point[gap] or point.guessed or not is_enough(sizes[gap].own, POINTS) for gap in gaps(of)):
                    return None
                found += 1
            else:
                part = of_rows_at(system, point, asked, of, claimed, moving, sizes)
                if part is None or point.guessed:
                    return None
                found, (rank, is_told), least = found + 1, part, part[0]
                is_whole = is_whole and is_told
        if found == POINTS:
            break
    if found < POINTS:
        return None
    if asked == "=" or is_whole and (asked == "observable" or is_kept(system, moving, given, conditions) or asked == "rank" and of):
        return "all"
    full = asked == "rank" and least == (min(len(of), len(of[0])) if of else len(columns))
    return "all" if full else "half" if asked == "rank" and least else None

def of_rows_at(system, point, asked, of, claimed, moving, sizes):
    """The rank at a point, where all is as claimed there, and whether sizes make it sure that it is no greater; or nothing."""
    basis, (words, rows) = {}, (None, each(point.__getitem__, of)) if moving is None else codistribution(system, point, moving, 0)
    rank = sum(adds(row, basis, point.prime) for row in rows)
    inside, large = (of or []) if asked == "observable" else [], []
    if asked == "rank" and rank != claimed:
        return None
    if asked != "rank" and not all(adds(point.gradient(x, system.columns()), {**basis}, point.prime) == (asked != "observable") for x in of):
        return None
    with suppress(NotImplementedError):
        large = [sizes.of_row(row) for row in of] if words is None else [sizes.of_differential(x) for x in (*words, *inside)]
        return rank, is_enough(sizes.of_minors(large, rank + 1), POINTS)
    return rank, False

def is_kept(system, moving, given, conditions):
    """Whether no field leaves the set of the equations among some conditions."""
    for gap in [gap for relation in conditions if relation[1] == "=" for gap in gaps(relation)]:
        for along in moving[1] if moving else []:
            rate = along[gap]
            for one in given:
                rate = Map(put_in, [one])[rate]
            if rate is not number(0):
                return False
    return True

def by_fields(system, asked, of, seed, is_whole):
    """Whether a rank is no more than was found, or functions are observable or not, by fields that keep the system; a rank that is no less at one point modulo a prime is generically no less."""
    columns, moving = system.names["state"] + system.names["unknown"], motion(system, [])
    if is_whole and len(columns) > WIDE or columns != system.columns():
        return False
    fields = attempt(lambda: Fields(system, columns, *moving, is_whole))
    if not fields or not fields.basis:
        return False
    for point in points([], seed):
        with suppress(ZeroDivisionError):
            basis = {}
            if not exists(system, point):
                return False
            dimension = sum(adds(fields.values(point, field), basis, point.prime) for field in fields.basis)
            if asked == "unobservable":
                moved = [point.gradient(x, columns) for x in of]
                return not point.guessed and all(any(dot(row, fields.values(point, field), point.prime) for field in fields.basis) for row in moved)
            basis = {}
            rank = sum(adds(row, basis, point.prime) for row in codistribution(system, point, moving, 0)[1])
            if point.guessed or rank + dimension != len(columns):
                return False
            return asked == "rank" or bool(attempt(lambda: all(fields.is_kept(x) for x in of)))
    return False

def dot(row, other, prime): return sum(x * y for x, y in zip(row, other)) % prime

def exists(system, point):
    """Whether all that the statement names, what cancels there too, has a value at a point and near it; a root may have one at single states alone."""
    return all(node.kind == "^" and point[node] is not None for node in system.partial())

def of_a_rank(system, of, claimed, least, is_proved, where):
    """What a minor that is not zero at a point implies: generically the rank is no less."""
    if not least:
        return "consistent", where
    if not is_proved:
        return ("confirmed", f"the rank is no less than {least}") if least > claimed else ("consistent", where)
    most = min(len(of), len(of[0])) if of else len(system.columns())
    return ("confirmed", "the rank is full") if least == most else ("half confirmed", f"the rank is no less; no greater at {where}")

def witness(system, state, *nodes):
    """The point of a state, which gives a value to all that some nodes mention, and to all that a statement is made of."""
    point, named, parts = Map(enclosed), {symbol("pi")}, system.partial()
    for name, value in state.items():
        of = symbol(name) if name != "pi" else doubt("a value for pi")
        named.add(of)
        if "angle" in value:
            sine, cosine = (fraction(value["angle"][key]) for key in ("sin", "cos"))
            point[of] = None if sine**2 + cosine**2 == 1 else doubt(f"{name} is no angle")
            point.update({Node("sin", of): Interval(sine), Node("cos", of): Interval(cosine)})
        else:
            point[of] = Interval(fraction(value["number"])) if "number" in value else refuse("a value by an operation")
    if any(node.kind == "symbol" and node not in named for root in nodes for node in root.below()):
        refuse("a state that does not give all values")
    for node in parts:  # what they alone mention may have any value
        sign = point[node.args[0]].sign()
        if sign == 0 and node.kind != "sqrt" or sign < 0 and node.kind != "^":
            refuse("a state at which a term has no value")
    return point

def all_gaps(*relations): return [gap for relation in relations for gap in gaps(relation)]

def refuted(system, record, evidence, _):
    asked, of, _, conditions = system.statement(system.claims[record["id"]])
    if asked != "=" or record["verdict"] != "refuted":
        doubt("a witness for what is no equation, or is proved")
    point = witness(system, evidence["state"], *all_gaps(of, *conditions))
    if not all(holds(point, condition) for condition in conditions) or holds(point, of):
        doubt("a condition does not hold at the witness, or what was refuted does")
    return "confirmed", "at its witness"

def chosen(rows, columns, height, width):
    """Whether these are as many different rows as columns, all of which there are."""
    fits = len(rows) == len(columns) == len({*rows}) == len({*columns})
    if not fits or not all(type(x) is int and 0 <= x < most for of, most in ((rows, height), (columns, width)) for x in of):
        doubt("it has no such minor")

def named_rows(system, words, of=None):
    """Rows by their names: those of a matrix, or the differentials of Lie derivatives."""
    if of:
        places = [int(re.fullmatch(r"row (\d{1,6})", word)[1]) - 1 for word in words]
        return [of[place] if place >= 0 else doubt("no such row") for place in places]
    units = [system.unit(name) for name in system.columns()]
    return [tuple(unit[word] for unit in units) for word in map(system.word, words)]

def minor(rows, evidence, places, columns):
    chosen(places, columns, len(rows), len(evidence["columns"]))
    return determinant(tuple(tuple(rows[row][column] for column in columns) for row in places))

def exact_rank(rows, point):
    """The rank at a state of a matrix that has exact values there."""
    found, basis = [[point[x] for x in row] for row in rows], []
    if any(x.low != x.high for row in found for x in row):
        refuse("a rank of values that are not exact")
    for row in ([x.low for x in row] for row in found):
        for column, other in basis:
            spend(len(row))
            row = [short(x - row[column] * y) for x, y in zip(row, other)]
        column = next((column for column, x in enumerate(row) if x), None)
        if column is not None:
            basis.append((column, [x / row[column] for x in row]))
    return len(basis)

def further_rows(system, words):
    """The differentials of all Lie derivatives of one order more than some."""
    last, found = system.seen(), []
    for _ in range(2 + max((len(word.split(" L")) - (not word.startswith("L")) for word in words), default=0)):
        found, last = found + last, [system[field].along[x] for field in system.names["moving"] for x in last]
        if len(found) > WORDS:
            refuse(f"more than {WORDS} Lie derivatives")
    units = [system.unit(name) for name in system.columns()]
    return [tuple(unit[x] for unit in units) for x in found]

def not_denied(system, record, states, of, claimed, conditions, sets):
    """That no state of a verdict's own evidence is one at which the rank is another than what was proved."""
    for state in states:
        with suppress(NotImplementedError):
            given = all_gaps(*conditions, *(x for one in sets for x in one))
            point = witness(system, state["state"], *(x for row in of for x in row), *given)
            is_meant = all(holds(point, x) for x in conditions) and not any(all(holds(point, x) for x in one) for one in sets)
            rank = exact_rank(of, point) if is_meant else claimed
            if rank > claimed or rank < claimed and record["asked"]["sense"] != "generic":
                doubt("at a state of its own evidence the rank is another")

def at_states(system, record, evidence, seed):
    """Ranks at states: of a claim, or of nothing that is claimed."""
    states, is_listed = evidence["states"] or refuse("no states"), record["verdict"] == "found"
    if is_listed:
        of = system["rows"] if record["asked"]["what"] == "rows_at_states" else None
        where = record["asked"]["where"]
        *_, said = system.statement(("rank = 0" if of is None else "rank(rows) = 0") + f" where {where}" * bool(where))
        given, named = system.read(where) if where else [], {symbol(name) for name in states[0]["state"]}
        # of what the file assumes, what is about symbols of the states
        about = {x: {node for gap in all_gaps(x) for node in gap.below() if node.kind == "symbol"} - {symbol("pi")} for x in said}
        conditions, sets, claimed = [x for x in said if x in given or about[x] <= named], [], None
    else:
        text = system.claims[record["id"]]
        asked, of, claimed, conditions = system.statement(text)
        sets = system.left_out(text) if asked == "rank" else []
        if asked != "rank" or record["verdict"] == "proved":
            return asked == "rank" and of and not_denied(system, record, states, of, claimed, conditions, sets) or at_random(system, record, evidence, seed)
    if not of and list(evidence["columns"]) != system.columns():
        doubt("columns that are others")
    if of and len(evidence["columns"]) != len(of[0]):
        doubt("columns that are others")
    rows, ranks = named_rows(system, evidence["row_names"], of), []
    for state in states:
        root = minor(rows, evidence, state["minor"]["rows"], state["minor"]["columns"])
        mentioned = [x for row in of or [] for x in row]
        point = witness(system, state["state"], root, *mentioned, *all_gaps(*conditions, *(x for one in sets for x in one)))
        rank = len(state["minor"]["rows"])
        if not all(holds(point, condition) for condition in conditions):
            doubt("a condition does not hold at the state")
        if any(all(holds(point, relation) for relation in one) for one in sets):
            doubt("a state that the claim leaves out")
        if type(state["rank"]) is not int or rank != state["rank"] or rank and point[root].sign() == 0:
            doubt("a minor is zero, or of another size")
        is_whole = bool(of) and (is_listed or record["asked"]["sense"] != "generic") and rank < len(of[0])
        if is_whole and exact_rank(of, point) != rank:
            doubt("the rank is greater")
        if not is_listed and (rank > claimed or is_whole and rank < claimed):
            return "confirmed", "at its state"
        if rank == claimed:
            doubt("it is the rank that is claimed")
        if not of and rank < len(evidence["columns"]):
            with suppress(NotImplementedError):
                further = further_rows(system, evidence["row_names"])
                if exact_rank(further, witness(system, state["state"], *(x for row in further for x in row))) > rank:
                    doubt("a Lie derivative was left out, with which the rank is greater")
        ranks.append((rank, is_whole or rank == len(evidence["columns"])))
    if not is_listed or not any(rank for rank, _ in ranks):
        return "consistent", "the rank of what was written down"
    word = "confirmed" if all(is_known for _, is_known in ranks) else "half confirmed"
    return word, f"the rank is {'' if word == 'confirmed' else 'no less '}at {len(ranks)} states"

def boxes(system, record, evidence, _):
    ranges = evidence["ranges"]
    whole = {symbol(side["symbol"]): (fraction(side["low"]), fraction(side["high"])) for side in ranges}
    if len(whole) != len(ranges) or symbol("pi") in whole or any(low > high for low, high in whole.values()):
        doubt("a symbol with two ranges, an empty one, or one of pi")
    of = system["rows"] if record["asked"]["what"] == "rows_on_boxes" else None
    if list(evidence["columns"]) != system.columns() or not evidence["boxes"]:
        doubt("other columns, or no boxes")
    rows = named_rows(system, evidence["row_names"], of)
    system.statement("rank = 0" if of is None else "rank(rows) = 0")
    free, volume, seen = {name: ends for name, ends in whole.items() if ends[0] < ends[1]}, Fraction(0), []
    for given in evidence["boxes"]:
        spend(MADE * len(seen))
        sides = [(fraction(low), fraction(high)) for low, high in given["sides"]]
        if any(all(a < d and c < b for (a, b), (c, d) in zip(sides, other)) for other in seen):
            doubt("boxes have a part in common")
        parts = [(high - low) / (most - least) if least <= low < high <= most else doubt("a box lies outside")
                 for (least, most), (low, high) in zip(free.values(), sides, strict=True)]
        volume, seen = volume + prod(parts), [*seen, sides]
        root = minor(rows, evidence, given["rows"], [*range(len(evidence["columns"]))])
        box, there = {**whole, **dict(zip(free, sides))}, root.below()
        lost = {*system.partial()}.difference(there)  # terms that the minor does not tell of
        if any(node.kind == "symbol" and node not in (*whole, symbol("pi")) for of in (root, *lost) for node in of.below()):
            refuse("a symbol without a range")
        if not all(x.kind == "^" and is_nowhere_zero(system, x.args[0], box) for x in lost) or not is_nowhere_zero(system, root, box):
            refuse(f"a box that is not shown by {PIECES} pieces")
    return ("confirmed", f"{len(seen)} boxes") if volume == fraction(evidence["volume"]) else doubt("another volume")

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

def listed_statement(what, given):
    of = "the file's own rows" if what.startswith("rows") else "the observability codistribution"
    begin, end = ("full rank of ", " on these boxes") if what.endswith("boxes") else ("the rank of ", " at these states")
    return begin + of + end + (f", where {given}" if given else "")

def bound(system, record, kind):
    """Whether a verdict is on a claim of its file, in the words of that claim, with evidence of a kind that may be."""
    asked, word = record["asked"], record["verdict"]
    if not all(isinstance(text, str) for text in asked.values()):
        doubt("parts of a claim that are no texts")
    if record["digest"] != system.digest:
        refuse("the proof file is another one than when the verdict was found")
    if word == "found":
        ids = {"system_at_states": "rank", "rows_at_states": "rows", "system_on_boxes": "certify", "rows_on_boxes": "certify"}
        own = {**asked, "claimed": "", "sense": "listed", "except": ""}
        said = listed_statement(asked["what"], asked["where"]) if asked["what"] in ids else None
        fits = asked["what"].endswith("boxes") == (kind == "boxes") and kind in ("boxes", "rank") and asked == own
        if record["id"] != ids.get(asked["what"]) or record["statement"] != said or not fits:
            doubt("it is filed under another name")
        return
    text = system.claims.get(record["id"]) or doubt("the proof file has no such claim")
    spend(len(text) // BYTES)
    asked = {key: spelled(value) for key, value in asked.items()}
    if compact(text) != "".join(spelled(record["statement"]).split()) or parts(text) != asked:
        doubt("the claim of this id says something else")
    if re.search(r"\bon\b", text) or asked["sense"] in ("everywhere", "except") and not asked["what"].startswith("rank"):
        refuse("a claim on the sample box, or at all states and of no rank")
    fits = {"refuted": word == "refuted", "proved": word == "proved", "boxes": False, "rank": True}
    if word not in ("proved", "refuted") or not fits.get(kind, True):
        doubt("evidence of another kind than the verdict")

def check(record, folder, systems, seed):
    """What comes of one verdict: a word, and why."""
    try:
        Expression.work = 0
        spend(FEE)
        ((kind, evidence),) = record["evidence"].items()
        if kind not in KINDS:
            refuse("evidence of a kind that does not exist")
        if kind == "unchecked":
            return "not checked", str(evidence)
        path = os.path.join(folder, record["file"])
        determinant.cache_clear()
        if path not in systems or Expression.began - Expression.left > MOST:
            systems.clear()
            forget()
            Expression.began = Expression.left
            systems[path] = System(path)
        system = systems[path]
        bound(system, record, kind)
        if kind == "claimed_rank" and evidence["word"] != record["verdict"]:
            doubt("evidence of another verdict")
        checks = {"refuted": refuted, "rank": at_states, "boxes": boxes, "proved": proved, "claimed_rank": proved}
        return checks.get(kind, at_random)(system, record, evidence, seed)
    except Exception as why:  # whatever a damaged record or file leads to
        word = "not confirmed" if isinstance(why, Doubt) else "not checked"
        return word, str(why) if type(why) in (NotImplementedError, Doubt, Spent) else repr(why)

def plain(text):
    """A text of a stranger's file in one line: what cannot be printed is written as an escape, so that no line is forged."""
    return "".join(x if x.isprintable() else x.encode("unicode_escape", "surrogatepass").decode() for x in str(text))

def unique(pairs):
    """An object in which nothing is said twice: two readers may hold to another one of them."""
    found = dict(pairs)
    return found if len(found) == len(pairs) else wrong("a key that stands twice")

def wrong(why): raise ValueError(why)

def numeral(of):
    """A reader of numbers that are short, and finite."""
    return lambda text: of(text) if len(text) <= DIGITS and of(text) - of(text) == 0 else wrong("a number that is long or infinite")

def verdict_file(path):
    """The records of a verdict file, and their names."""
    text = read_text(path, LARGEST)
    if 8 * (text.count("{") + text.count("[")) + text.count(",") > VALUES:
        wrong("too many values")
    verdicts = json.loads(text, object_pairs_hook=unique, parse_int=numeral(int), parse_float=numeral(float), parse_constant=wrong)
    if verdicts["schema"] != "palmistry-verdicts":
        wrong("another schema")
    if type(verdicts["version"]) is not int or verdicts["version"] != 4:
        wrong(f"version {verdicts['version']!r} and not 4: write it anew")
    return [(f"{record['file']} {record['id']}", record) for record in verdicts["verdicts"]]

def main(arguments):
    """The command; returns its exit status."""
    is_quiet = "--quiet" in arguments
    arguments = [x for x in arguments if x != "--quiet"]
    if not arguments or arguments[0].startswith("-"):
        print(__doc__)
        return 0 if arguments[:1] in (["-h"], ["--help"]) else 2
    (path, _, folder), counts, systems = [*arguments, "--proofs", "."][:3], Counter(), {}
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        records, Expression.left, Expression.began = verdict_file(path), RUN, RUN
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as why:
        print(f"{plain(path)} is no verdict file: {plain(repr(why))}\n{__doc__}", file=sys.stderr)
        return 2
    for seed, (name, record) in enumerate(records):
        word, reason = check(record, folder, systems, seed)
        counts[word] += 1
        if not is_quiet or word == "not confirmed":
            print(f"{word:15}{plain(name)}: {plain(reason)}", flush=True)
    print(f"{len(records)} verdicts: " + ", ".join(f"{counts[word]} {word}" for word in WORDS_OF_FINDINGS if counts[word]))
    return 1 if counts["not confirmed"] else 0

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
