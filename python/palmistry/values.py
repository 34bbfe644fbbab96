"""Values of terms: residues modulo a prime, fractions, and intervals of fractions where there are functions."""

import random
from collections import namedtuple
from fractions import Fraction
from math import isqrt

from .terms import TERMS, operands, reachable, symbols, sub, value as constant


Angle = namedtuple("Angle", "sine cosine")


class NoValue(Exception):
    """A pole, a root of no square, a logarithm of what is not positive."""


class Residues:
    """Numbers modulo a prime. Functions that are met are taken for unknowns: equal ones for one."""

    def __init__(self, prime, rng):
        self.prime, self.rng, self.guessed = prime, rng, False

    def number(self, value):
        return self.divide(value.numerator, value.denominator)

    def divide(self, a, b):
        if b % self.prime == 0:
            raise NoValue("a divisor that is zero")
        return a * pow(b, -1, self.prime) % self.prime

    def plus(self, a, b):
        return (a + b) % self.prime

    def times(self, a, b):
        return a * b % self.prime

    def function(self, name, argument):
        if name == "sqrt":
            root = pow(argument, (self.prime + 1) // 4, self.prime)
            self.guessed = True
            if root * root % self.prime != argument:
                raise NoValue("the root of no square")
            return root
        self.guessed = True
        if name in ("sin", "cos"):
            t = random.Random(f"angle {argument} {self.prime}").randrange(self.prime)
            bottom = self.divide(1, 1 + t * t)
            return (2 * t if name == "sin" else 1 - t * t) * bottom % self.prime
        return random.Random(f"{name} {argument} {self.prime}").randrange(self.prime)


class Fractions:
    """Exact numbers; functions are refused."""

    def number(self, value):
        return value

    def divide(self, a, b):
        if b == 0:
            raise NoValue("a divisor that is zero")
        return a / b

    def plus(self, a, b):
        return a + b

    def times(self, a, b):
        return a * b

    def function(self, name, argument):
        raise NotImplementedError


class Intervals:
    """Pairs of fractions between which a number lies, rounded outward to so many bits."""

    def __init__(self, bits):
        self.unit = 1 << bits
        self.small = Fraction(1, self.unit)

    def outward(self, low, high):
        return Fraction((low * self.unit).__floor__(), self.unit), Fraction((high * self.unit).__ceil__(), self.unit)

    def number(self, value):
        return self.outward(value, value)

    def plus(self, a, b):
        return a[0] + b[0], a[1] + b[1]

    def times(self, a, b):
        products = [x * y for x in a for y in b]
        return self.outward(min(products), max(products))

    def divide(self, a, b):
        if b[0] <= 0 <= b[1]:
            raise NoValue("a divisor that may be zero")
        return self.times(a, self.outward(1 / b[1], 1 / b[0]))

    def function(self, name, a):
        if name == "pi":
            return self.outward(*(4 * bound for bound in self.series_pi()))
        low, high = self.image(name, a[0]), self.image(name, a[1])
        if name in ("exp", "log", "sqrt", "atan", "asin"):
            return low[0], high[1]
        if name == "acos":
            return high[0], low[1]
        # sine and cosine: no further from an end than the width
        width = a[1] - a[0]
        return max(Fraction(-1), low[0] - width), min(Fraction(1), low[1] + width)

    def alternating(self, terms):
        """The sum of a series whose terms fall and change their sign."""
        total = Fraction(0)
        for part in terms:
            total += part
            if abs(part) < self.small:
                return self.outward(total - abs(part), total + abs(part))

    def atan_small(self, x):
        return self.alternating(Fraction((-1) ** k, 2 * k + 1) * x ** (2 * k + 1) for k in range(10**6))

    def series_pi(self):
        fifth, other = self.atan_small(Fraction(1, 5)), self.atan_small(Fraction(1, 239))
        return 4 * fifth[0] - other[1], 4 * fifth[1] - other[0]

    def image(self, name, x):
        if name == "sqrt":
            if x < 0:
                raise NoValue("a root of what may be negative")
            root = isqrt((x * self.unit**2).__floor__())
            return Fraction(root, self.unit), Fraction(root + 1, self.unit)
        if name == "exp":
            if abs(x) > Fraction(1, 2):
                half = self.image("exp", x / 2)
                return self.times(half, half)
            total, part, k = Fraction(1), Fraction(1), 0
            while abs(part) > self.small:
                k += 1
                part = part * x / k
                total += part
            return self.outward(total - 2 * abs(part), total + 2 * abs(part))
        if name == "log":
            if x <= 0:
                raise NoValue("a logarithm of what may not be positive")
            if not Fraction(1, 2) < x < 2:
                root = self.image("sqrt", x)
                return 2 * self.image("log", root[0])[0], 2 * self.image("log", root[1])[1]
            # log x = 2 artanh((x - 1)/(x + 1)), whose terms fall ninefold
            y, total, k = (x - 1) / (x + 1), Fraction(0), 0
            while True:
                part = y ** (2 * k + 1) / (2 * k + 1)
                total, k = total + part, k + 1
                if abs(part) < self.small:
                    return self.outward(2 * total - abs(part), 2 * total + abs(part))
        if name in ("sin", "cos"):
            if abs(x) > 1:
                sine, cosine = self.image("sin", x / 2), self.image("cos", x / 2)
                if name == "sin":
                    return self.times((Fraction(2), Fraction(2)), self.times(sine, cosine))
                square = self.times(sine, sine)
                return 1 - 2 * square[1], 1 - 2 * square[0]
            odd = int(name == "sin")

            def parts():
                part, k = (x if odd else Fraction(1)), odd
                while True:
                    yield part
                    part = -part * x * x / ((k + 1) * (k + 2))
                    k += 2
            return self.alternating(parts())
        if name == "atan":
            if abs(x) <= Fraction(1, 2):
                return self.atan_small(x)
            # atan x = 2 atan(x/(1 + sqrt(1 + x^2)))
            root = self.image("sqrt", 1 + x * x)
            ends = sorted(x / (1 + end) for end in root)
            return 2 * self.image("atan", ends[0])[0], 2 * self.image("atan", ends[1])[1]
        if abs(x) >= 1:
            raise NoValue(f"{name} at an end of its range")
        root = self.image("sqrt", 1 - x * x)
        ends = sorted(x / end for end in root)
        asin = self.image("atan", ends[0])[0], self.image("atan", ends[1])[1]
        if name == "asin":
            return asin
        half = [bound / 2 for bound in self.function("pi", None)]
        return half[0] - asin[1], half[1] - asin[0]


def circle(at, point, field):
    """Sine and cosine of a sum of angles, halves of turns and multiples of these; nothing where it is something else."""
    parts = TERMS[at]
    if parts[0] == "symbol" and isinstance(point.get(parts[1]), Angle):
        return point[parts[1]]
    if parts[0] == "add":
        a, b = (circle(below, point, field) for below in parts[1:])
        if a and b:
            plus, times = field.plus, field.times
            minus = lambda x, y: plus(x, times(field.number(Fraction(-1)), y))
            return plus(times(a[0], b[1]), times(a[1], b[0])), minus(times(a[1], b[1]), times(a[0], b[0]))
        return None
    if constant(at) == 0:
        return field.number(Fraction(0)), field.number(Fraction(1))
    if parts[0] == "mul" and constant(parts[1]) is not None:
        factor, below = constant(parts[1]), parts[2]
    elif parts[0] == "mul" and constant(parts[2]) is not None:
        factor, below = constant(parts[2]), parts[1]
    else:
        factor, below = Fraction(1), at
    if TERMS[below] == ("pi",) and (2 * factor).denominator == 1:
        turn = int(2 * factor) % 4
        return tuple(field.number(Fraction(v)) for v in ((0, 1), (1, 0), (0, -1), (-1, 0))[turn])
    base = None if below == at else circle(below, point, field)
    if base is None or factor.denominator != 1 or abs(factor) > 64:
        return None
    plus, times, minus_one = field.plus, field.times, field.number(Fraction(-1))
    base = base if factor >= 0 else (times(minus_one, base[0]), base[1])
    found = (field.number(Fraction(0)), field.number(Fraction(1)))
    for _ in range(abs(int(factor))):
        found = (plus(times(found[0], base[1]), times(found[1], base[0])),
                 plus(times(found[1], base[1]), times(minus_one, times(found[0], base[0]))))
    return found


def evaluate(roots, point, field):
    """The values of some terms. An angle's value is its sine and its cosine."""
    found = {}
    for at in reachable(roots):
        parts = TERMS[at]
        below = [found.get(operand) for operand in operands(parts)]
        both = circle(parts[2], point, field) if parts[1:2] in (("sin",), ("cos",)) else None
        if both:
            found[at] = both[parts[1] == "cos"]
        elif parts[0] in ("const", "pi"):
            found[at] = field.number(parts[1]) if parts[0] == "const" else field.function("pi", None)
        elif parts[0] == "symbol":
            # an angle has a sine and a cosine, and no value of its own
            found[at] = None if isinstance(point.get(parts[1]), Angle) else point.get(parts[1])
        elif None in below:
            found[at] = None
        elif parts[0] == "power":
            found[at] = raised(below[0], parts[2], field)
        elif parts[0] == "apply":
            found[at] = field.function(parts[1], below[0])
        else:
            found[at] = (field.plus if parts[0] == "add" else field.times)(*below)
    if any(found[root] is None for root in roots):
        raise NoValue("an angle outside of sines and cosines, or a symbol without a value")
    return [found[root] for root in roots]


def raised(base, n, field):
    value, one = base, field.number(Fraction(1))
    found = one
    for bit in bin(abs(n))[2:]:
        found = field.times(found, found)
        if bit == "1":
            found = field.times(found, value)
    return found if n >= 0 else field.divide(one, found)


def sign(root, point):
    """The sign of a number, exactly."""
    try:
        value = evaluate([root], point, Fractions())[0]
        return (value > 0) - (value < 0)
    except NotImplementedError:
        pass
    for bits in (64, 256, 1024):
        field = Intervals(bits)
        enclosed = {name: Angle(*map(field.number, v)) if isinstance(v, Angle) else field.number(v) for name, v in point.items()}
        low, high = evaluate([root], enclosed, field)[0]
        if low > 0 or high < 0:
            return 1 if low > 0 else -1
    raise NoValue("it cannot be told from zero")


def solved(conditions, point, field):
    """The point moved onto the set of some equations: of each some symbol is solved for, or an angle put to a quarter of the turn."""
    free = set(point)
    gap = lambda: [evaluate([sub(left, right)], point, field)[0] for left, _, right in conditions]
    for place, (left, relation, right) in enumerate(conditions):
        if relation != "=":
            raise NoValue("an inequality")
        if TERMS[left][0] == "symbol" and isinstance(point.get(TERMS[left][1]), Angle):
            both = circle(right, point, field)
            if both is None:
                raise NoValue("an angle that is told by a function")
            point[TERMS[left][1]] = Angle(*both)
            free.discard(TERMS[left][1])
            continue
        here = sorted(symbols([left, right]) & free, key=lambda name: (TERMS[left] != ("symbol", name), name))
        if not any(solve_for(name, place, gap, point, field) and not free.discard(name) for name in here):
            raise NoValue("a condition that is not solved")
    if any(gap()):
        raise NoValue("conditions that are not solved together")
    return point


def solve_for(name, place, gap, point, field):
    """Whether an equation is met by another value of a symbol, which it is given."""
    kept, minus = point[name], field.number(Fraction(-1))
    if isinstance(kept, Angle):
        for sine, cosine in ((0, 1), (1, 0), (0, -1), (-1, 0)):
            point[name] = Angle(field.number(Fraction(sine)), field.number(Fraction(cosine)))
            try:
                if gap()[place] == 0:
                    return True
            except NoValue:
                pass
        point[name] = kept
        return False
    # linear in it: its value from those at zero and at one
    try:
        ends = []
        for value in (0, 1):
            point[name] = field.number(Fraction(value))
            ends.append(gap()[place])
        rise = field.plus(ends[1], field.times(minus, ends[0]))
        point[name] = field.divide(field.times(minus, ends[0]), rise)
        if gap()[place] == 0:
            return True
    except NoValue:
        pass
    point[name] = kept
    return False


def rank_modulo(entries, columns, prime):
    """The rank of a matrix of residues, row by row."""
    rows, rank = [entries[i:i + columns] for i in range(0, len(entries), columns)], 0
    for column in range(columns):
        pivot = next((r for r in range(rank, len(rows)) if rows[r][column] % prime), None)
        if pivot is None:
            continue
        rows[rank], rows[pivot] = rows[pivot], rows[rank]
        inverse = pow(rows[rank][column], -1, prime)
        for row in rows[rank + 1:]:
            factor = row[column] * inverse % prime
            if factor:
                row[:] = [(a - factor * b) % prime for a, b in zip(row, rows[rank])]
        rank += 1
    return rank
