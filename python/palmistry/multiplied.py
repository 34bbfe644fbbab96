"""Equations by multiplying out, and fields that keep a system: both sides as polynomials with fractions as coefficients, in symbols, sines and cosines, roots, and the inverses of what is divided by.

The only relations are those that hold wherever the terms exist: the squares of sine and cosine add up to one, the square of a root is what it is taken of, and what is
divided by times its inverse is one. So what is zero then is zero at all states."""

from fractions import Fraction

from .graph import Expression, Map, Spent, call, number, put_in, short, spend, symbol

STEPS, BITS = 1_000_000, 16  # products of terms for one equation; bits of an exponent
MOST = 1 << (BITS - 2)  # exponents are smaller, so that none runs over into the next one

class TooLong(Exception):
    """That an equation takes too much work to be multiplied out."""

class Ring:
    """Polynomials as dictionaries from monomials to coefficients; a monomial is one number, with some bits for the exponent of each variable."""

    def __init__(self):
        self.variables, self.squares, self.inverses, self.steps, self.most = {}, {}, {}, 0, 0

    def variable(self, key):
        self.most |= MOST << BITS * len(self.variables) if key not in self.variables else 0
        return self.variables.setdefault(key, BITS * len(self.variables))

    def times(self, a, b):
        # a monomial is as long as there are variables
        self.steps += len(a) * len(b) * (1 + BITS * len(self.variables) // 1024)
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
        if any(m & self.most for m in of):
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

    def cleared(self, of):
        """A polynomial multiplied by all that is divided by, the last inverse first."""
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
        return of

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
    return attempt(lambda: not any(ring.cleared(forms[there[gap]]) for gap in gaps))

def attempt(do):
    """What is found, or nothing where it takes too much work."""
    try:
        return do()
    except (TooLong, ZeroDivisionError, NotImplementedError):
        return None
    except Spent:
        # what is left for all verdicts ends; what is left for this one was spent on it, and says nothing against it
        if Expression.left < 0:
            raise
        return None

class Fields:
    """The affine fields that change no output and commute with all fields of a system: what they move is unobservable, and unidentifiable from any experiment.

    Each component is a number times its own column plus a constant, or, of few columns, a combination of all of them. What has to vanish is linear in the coefficients, which
    are variables of the ring; once divisors are multiplied by, each monomial in the others is an equation for them."""

    def __init__(self, system, columns, seen, moving, is_whole):
        self.columns, self.ring, self.units = columns, Ring(), [system.unit(name) for name in columns]
        self.forms, size = Map(self.ring.rule), range(len(columns))
        self.symbols = [self.forms[symbol(name)] for name in columns]
        self.unknowns = {(i, j): self.ring.variable((i, j)) for i in size for j in (*(size if is_whole else (i,)), None)}
        zero = [self.along(x) for x in seen]
        known = [symbol(name) for name in system.names["state"] if name not in columns]
        for along in moving:
            zero += [self.along(along[z]) for z in known]
            rates = [self.forms[along[symbol(name)]] for name in columns]
            zero += [self.bracket(i, rates, along[symbol(name)]) for i, name in enumerate(columns)]
        self.basis = self.solved([self.ring.cleared(x) for x in zero])

    def plus(self, *of):
        found = {}
        for part in of:
            for m, x in part.items():
                found[m] = found.get(m, 0) + x
        return {m: x for m, x in found.items() if x}

    def component(self, i):
        """That of a column, in unknown coefficients."""
        own = [self.ring.times({1 << at: Fraction(1)}, self.symbols[j] if j is not None else {0: Fraction(1)}) for (k, j), at in self.unknowns.items() if k == i]
        return self.plus(*own)

    def along(self, node):
        """The derivative of an expression along the field."""
        slopes = [unit[node] for unit in self.units]
        return self.plus(*(self.ring.times(self.component(i), self.forms[slope]) for i, slope in enumerate(slopes) if slope is not number(0)))

    def bracket(self, i, rates, rate):
        own = [self.ring.times({1 << at: Fraction(-1)}, rates[j]) for (k, j), at in self.unknowns.items() if k == i and j is not None]
        return self.plus(self.along(rate), *own)

    def solved(self, polynomials):
        """A basis of the coefficients for which all polynomials are zero."""
        places = sorted(self.unknowns.values())
        whole, rows = sum((1 << BITS) - 1 << at for at in places), {}
        for polynomial in polynomials:
            for m, x in polynomial.items():
                rows.setdefault((id(polynomial), m & ~whole), {})[(m & whole).bit_length() - 1] = x
        basis = {}
        for row in rows.values():
            while (common := next((at for at in row if at in basis), None)) is not None:
                self.take(row, basis[common], row[common])
            if row:
                pivot, x = next(iter(row.items()))
                row = {at: y / x for at, y in row.items()}
                for other in basis.values():
                    if pivot in other:
                        self.take(other, row, other[pivot])
                basis[pivot] = row
        free = [at for at in places if at not in basis]
        return [{at: Fraction(1), **{pivot: -row[at] for pivot, row in basis.items() if at in row}} for at in free]

    def take(self, row, other, by):
        spend(len(other))
        for at, x in other.items():
            row[at] = short(row.get(at, 0) - by * x)
            if not row[at]:
                del row[at]

    def values(self, point, field):
        """The components of a field at a point modulo a prime."""
        residue = lambda x: x.numerator * pow(x.denominator, -1, point.prime)
        at = lambda j: 1 if j is None else point[symbol(self.columns[j])]
        return [sum(residue(field[place]) * at(j) for (k, j), place in self.unknowns.items() if k == i and place in field) % point.prime
                for i in range(len(self.columns))]

    def is_kept(self, node):
        """Whether no field moves an expression."""
        moved = self.ring.cleared(self.along(node))
        rows = {}
        for m, x in moved.items():
            at = next(place for place in self.unknowns.values() if m >> place & 1)
            rows.setdefault(m - (1 << at), []).append((at, x))
        return all(sum(x * field.get(at, 0) for at, x in row) == 0 for row in rows.values() for field in self.basis)
