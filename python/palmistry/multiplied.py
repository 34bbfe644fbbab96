"""Equations by multiplying out: both sides as polynomials with fractions as coefficients, in symbols, sines and cosines, roots, and the inverses of what is divided by.

The only relations are those that hold wherever the terms exist: the squares of sine and cosine add up to one, the square of a root is what it is taken of, and what is
divided by times its inverse is one. So what is zero then is zero at all states."""

from fractions import Fraction

from .graph import Expression, Map, Spent, call, number, put_in, short, spend

STEPS, BITS = 1_000_000, 16  # products of terms for one equation; bits of an exponent
MOST = 1 << (BITS - 2)  # exponents are smaller, so that none runs over into the next one

class TooLong(Exception):
    """That an equation takes too much work to be multiplied out."""

class Ring:
    """Polynomials as dictionaries from monomials to coefficients; a monomial is one number, with some bits for the exponent of each variable."""

    def __init__(self):
        self.variables, self.squares, self.inverses, self.steps = {}, {}, {}, 0

    def variable(self, key):
        return self.variables.setdefault(key, BITS * len(self.variables))

    def times(self, a, b):
        self.steps += len(a) * len(b)
        spend(len(a) * len(b) // 8)
        if self.steps > STEPS:
            raise TooLong
        found = {}
        for m, x in a.items():
            for n, y in b.items():
                found[m + n] = found.get(m + n, 0) + x * y
        return self.reduced(found)

    def reduced(self, of):
        """The same without squares of what has a relation."""
        for shift, square in self.squares.items():
            while high := [m for m in of if m >> shift & (1 << BITS) - 1 > 1]:
                for m in high:
                    x = of.pop(m)
                    self.steps += len(square)
                    for n, y in square.items():
                        of[m - (2 << shift) + n] = of.get(m - (2 << shift) + n, 0) + x * y
                if self.steps > STEPS:
                    raise TooLong
        if any(m >> shift & MOST for m in of for shift in self.variables.values()):
            raise TooLong
        return {m: short(Fraction(x)) for m, x in of.items() if x}

    def rule(self, node, *of):
        """A node from the polynomials of its parts."""
        kind = node.kind
        if kind == "number":
            return {0: node.args[0]} if node.args[0] else {}
        if kind == "+":
            a, b = of
            return {m: x for m in a | b if (x := a.get(m, 0) + b.get(m, 0))}
        if kind == "*":
            return self.times(*of)
        if kind == "^":
            base, n = of
            if n < 0:
                shift = self.variable(("inverse", node.parts[0]))
                self.inverses[shift] = base
                return self.power({1 << shift: Fraction(1)}, -n)
            return self.power(base, n)
        shift = self.variable(node)
        if kind == "sin":
            self.squares[shift] = {0: Fraction(1), 2 << self.variable(call("cos", node.parts[0])): Fraction(-1)}
        if kind == "sqrt":
            self.squares[shift] = of[0]
        return {1 << shift: Fraction(1)}

    def power(self, base, n):
        if n >= MOST:
            raise TooLong
        found = {0: Fraction(1)}
        for _ in range(n):
            found = self.times(found, base)
        return found

    def is_zero(self, of):
        """Whether a polynomial is zero once it is multiplied by all that is divided by, the last inverse first."""
        for shift in sorted(self.inverses, reverse=True):
            by = {}
            for m, x in of.items():
                k = m >> shift & (1 << BITS) - 1
                by.setdefault(k, {})[m - (k << shift)] = x
            most, of = max(by, default=0), {}
            for k, part in by.items():
                for m, x in self.times(part, self.power(self.inverses[shift], most - k)).items():
                    of[m] = of.get(m, 0) + x
            of = {m: x for m, x in of.items() if x}
        return not of

def solved(system, gaps):
    """Symbols by the others, where each gap is linear in one with a number before it: then these are all states; else nothing."""
    found = []
    for gap in gaps:
        for given in found:
            gap = Map(put_in, [given])[gap]
        if gap is number(0):
            continue
        names = [node for node in gap.below() if node.kind == "symbol" and node.args[0] != "pi"]
        slopes = [(name, system.unit(name.args[0])[gap]) for name in names]
        free = [(name, slope) for name, slope in slopes if slope.kind == "number" and slope is not number(0)]
        for name, slope in free:
            value = -Map(put_in, {name: number(0)})[gap] / slope
            if name not in value.below():
                found = [(other, Map(put_in, [(name, value)])[of]) for other, of in found] + [(name, value)]
                break
        else:
            return None
    return found

def are_zero(system, gaps, conditions):
    """Whether expressions are zero wherever they exist and others are; `False` says nothing."""
    given = solved(system, conditions)
    if given is None:
        return False
    ring, there = Ring(), Map(put_in, given)
    forms = Map(ring.rule)
    try:
        return all(ring.is_zero(forms[there[gap]]) for gap in gaps)
    except (TooLong, ZeroDivisionError, NotImplementedError):
        return False
    except Spent:
        # what is left for all verdicts ends; what is left for this one was spent on it, and says nothing against it
        if Expression.left < 0:
            raise
        return False
