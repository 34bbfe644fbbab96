"""Numbers of the second checker: fractions, residues, intervals, angles by sine and cosine, and dual numbers over all of them."""

import random
from fractions import Fraction

BITS = 400  # of an interval


class NotRead(Exception):
    """What this program does not read, or cannot evaluate."""


class Number:
    """Operations by those of a class, which takes fractions too: `plus`, `times`, `inverse` and `function`."""

    def __add__(self, other): return self.plus(other)
    def __mul__(self, other): return self.times(other)
    def __neg__(self): return self.times(Fraction(-1))
    def __sub__(self, other): return self + -other
    def __rsub__(self, other): return -self + other
    def __truediv__(self, other): return self * invert(other)
    def __rtruediv__(self, other): return invert(self) * other
    __radd__, __rmul__ = __add__, __mul__


class Residue(Number):
    """A number modulo a prime. A function's value is taken for an unknown, equal ones for one, and that is noted."""
    guessed = False

    def __init__(self, value, prime): self.value, self.prime = value % prime, prime

    def of(self, other):
        if isinstance(other, Turn):
            other = other.value(self)
        return other.value if isinstance(other, Residue) else other.numerator * pow(other.denominator, -1, self.prime)

    def plus(self, other):
        return NotImplemented if isinstance(other, Dual) else Residue(self.value + self.of(other), self.prime)

    def times(self, other):
        return NotImplemented if isinstance(other, Dual) else Residue(self.value * self.of(other), self.prime)

    def inverse(self):
        if self.value == 0:
            raise ZeroDivisionError
        return Residue(pow(self.value, -1, self.prime), self.prime)

    def function(self, name):
        Residue.guessed = True
        if name == "sqrt":
            root = pow(self.value, (self.prime + 1) // 4, self.prime)
            if root * root % self.prime != self.value:
                raise ZeroDivisionError
            return Residue(root, self.prime)
        half = Residue(random.Random(f"{name.replace('cos', 'sin')} {self.value} {self.prime}").randrange(self.prime), self.prime)
        return Arc.of_half(half).function(name) if name in ("sin", "cos") else half


class Interval(Number):
    """Two fractions between which a number lies, rounded outward."""

    def __init__(self, low, high):
        self.low, self.high = Fraction((low * (1 << BITS)).__floor__(), 1 << BITS), Fraction((high * (1 << BITS)).__ceil__(), 1 << BITS)

    @staticmethod
    def of(other):
        if isinstance(other, Turn):
            other = other.value(Interval(0, 0))
        return other if isinstance(other, Interval) else Interval(other, other)

    def plus(self, other):
        return NotImplemented if isinstance(other, Dual) else Interval(self.low + self.of(other).low, self.high + self.of(other).high)

    def times(self, other):
        if isinstance(other, Dual):
            return NotImplemented
        products = [a * b for a in (self.low, self.high) for b in (self.of(other).low, self.of(other).high)]
        return Interval(min(products), max(products))

    def inverse(self):
        if self.low <= 0 <= self.high:
            raise ZeroDivisionError
        return Interval(1 / self.high, 1 / self.low)

    def function(self, name):
        if name in ("sin", "cos"):  # no further from its value in the middle than half the width
            middle, width = (self.low + self.high) / 2, (self.high - self.low) / 2
            return image(name, middle) + Interval(-width, width)
        ends = image(name, self.low), image(name, self.high)
        return Interval(min(end.low for end in ends), max(end.high for end in ends))


def series(part, ratio):
    """A sum whose parts fall at least by half from one to the next, from some on."""
    total, k = Fraction(0), 0
    while abs(part) * (1 << BITS) > 1 or k < 8:
        total, part, k = total + part, part * ratio(k), k + 1
        part = Fraction((part * (1 << 2 * BITS)).__floor__(), 1 << 2 * BITS)
    slack = 2 * abs(part) + Fraction(4 * k, 1 << BITS)
    return Interval(total - slack, total + slack)


def image(name, x):
    """The value of a function of a fraction."""
    if name == "sqrt" and x >= 0:
        scaled, root = (x * (1 << 2 * BITS)).__floor__(), 1
        root = 1 << (scaled.bit_length() + 1) // 2
        while (closer := (root + scaled // root) // 2) < root:
            root = closer
        return Interval(Fraction(root, 1 << BITS), Fraction(root + 1, 1 << BITS))
    if name == "exp":
        half = None if abs(x) <= 1 else image("exp", x / 2)
        return half * half if half else series(Fraction(1), lambda k: x / (k + 1))
    if name == "log" and x > 0:
        if not Fraction(1, 2) <= x <= 2:
            root = image("sqrt", x)
            return Fraction(2) * Interval(image("log", root.low).low, image("log", root.high).high)
        y = (x - 1) / (x + 1)
        return series(2 * y, lambda k: y * y * (2 * k + 1) / (2 * k + 3))
    if name in ("sin", "cos"):
        if abs(x) > 1:
            sine, cosine = image("sin", x / 2), image("cos", x / 2)
            return Fraction(2) * sine * cosine if name == "sin" else Fraction(1) - Fraction(2) * sine * sine
        odd = int(name == "sin")
        return series(x if odd else Fraction(1), lambda k: -x * x / ((2 * k + 1 + odd) * (2 * k + 2 + odd)))
    if name == "atan":
        if abs(x) <= Fraction(1, 2):
            return series(x, lambda k: -x * x * (2 * k + 1) / (2 * k + 3))
        root = Fraction(1) + image("sqrt", 1 + x * x)
        return Fraction(2) * (Interval(x, x) / root).function("atan")
    if name in ("asin", "acos") and abs(x) < 1:
        asin = (Interval(x, x) / image("sqrt", 1 - x * x)).function("atan")
        return asin if name == "asin" else Turn(Fraction(1, 2)).value(asin) - asin
    raise ZeroDivisionError


class Turn(Number):
    """A fraction of pi."""

    def __init__(self, part): self.part = part

    def value(self, like):
        if isinstance(like, Residue):
            return Residue(random.Random(f"pi {like.prime}").randrange(like.prime), like.prime) * self.part
        return (Fraction(16) * image("atan", Fraction(1, 5)) - Fraction(4) * image("atan", Fraction(1, 239))) * self.part

    def plus(self, other):
        if isinstance(other, Fraction) and other == 0:
            return self
        return Turn(self.part + other.part) if isinstance(other, Turn) else self.value(Interval(0, 0)) + other if isinstance(
            other, Fraction) else NotImplemented

    def times(self, other):
        return Turn(self.part * other) if isinstance(other, Fraction) else self.value(Interval(0, 0)) * other if isinstance(
            other, (Turn, Interval)) else NotImplemented

    def inverse(self): return self.value(Interval(0, 0)).inverse()

    def function(self, name):
        if name in ("sin", "cos") and (2 * self.part).denominator == 1:
            return Fraction([0, 1, 0, -1][(int(2 * self.part) + (name == "cos")) % 4])
        return self.value(Interval(0, 0)).function(name)


class Arc(Number):
    """An angle by its sine and cosine."""

    def __init__(self, sine, cosine): self.sine, self.cosine = sine, cosine

    @staticmethod
    def of_half(half): return Arc(Fraction(2) * half / (half * half + Fraction(1)), (Fraction(1) - half * half) / (half * half + Fraction(1)))

    def plus(self, other):
        if isinstance(other, Fraction) and other == 0:
            return self
        if isinstance(other, Turn) and (2 * other.part).denominator == 1:
            other = Arc(other.function("sin"), other.function("cos"))
        if not isinstance(other, Arc):
            return NotImplemented if isinstance(other, Dual) else refuse("an angle beside a number")
        return Arc(self.sine * other.cosine + self.cosine * other.sine, self.cosine * other.cosine - self.sine * other.sine)

    def times(self, other):
        if isinstance(other, Dual):
            return NotImplemented
        if not isinstance(other, Fraction) or other.denominator != 1 or abs(other) > 64:
            refuse("a part of an angle")
        found, one = Arc(Fraction(0), Fraction(1)), self if other > 0 else Arc(-self.sine, self.cosine)
        for _ in range(abs(int(other))):
            found = found + one
        return found

    def inverse(self): refuse("one over an angle")
    def function(self, name): return {"sin": self.sine, "cos": self.cosine}.get(name) or (
        Fraction(0) if name in ("sin", "cos") else refuse("a function of an angle"))


class Dual(Number):
    """A number and its derivative, of a level: that of the higher level counts the other one for a constant."""

    def __init__(self, level, value, slope): self.level, self.value, self.slope = level, value, slope

    def parts(self, other):
        if isinstance(other, Dual) and other.level > self.level:
            return other.level, (self, Fraction(0)), (other.value, other.slope)
        same = isinstance(other, Dual) and other.level == self.level
        return self.level, (self.value, self.slope), (other.value, other.slope) if same else (other, Fraction(0))

    def plus(self, other):
        level, a, b = self.parts(other)
        return Dual(level, a[0] + b[0], a[1] + b[1])

    def times(self, other):
        level, a, b = self.parts(other)
        flat = lambda x: x if not (isinstance(x, Fraction) and x == 0) else None
        rest = [y * x for x, y in ((a[0], flat(b[1])), (b[0], flat(a[1]))) if y is not None]
        return Dual(level, a[0] * b[0], sum(rest[1:], rest[0]) if rest else Fraction(0))

    def inverse(self):
        one = invert(self.value)
        return Dual(self.level, one, self.slope * -(one * one))

    def function(self, name):
        x, one = self.value, Fraction(1)
        own = apply(name, x)
        slope = {"sin": lambda: apply("cos", x), "cos": lambda: -apply("sin", x), "exp": lambda: own, "log": lambda: invert(x),
                 "sqrt": lambda: invert(Fraction(2) * own), "atan": lambda: invert(one + x * x),
                 "asin": lambda: invert(apply("sqrt", one - x * x)), "acos": lambda: -invert(apply("sqrt", one - x * x))}[name]
        return Dual(self.level, own, self.slope * slope())


class Row(Number):
    """Derivatives by several symbols: what a dual number has in place of one slope. It stands on the left of what it is multiplied by."""

    def __init__(self, entries): self.entries = entries

    def plus(self, other):
        return Row([x + y for x, y in zip(self.entries, other.entries)]) if isinstance(other, Row) else self

    def times(self, other):
        return Row([x if isinstance(x, Fraction) and x == 0 else x * other for x in self.entries])


def refuse(why):
    raise NotRead(why)


def invert(x):
    return x.inverse() if isinstance(x, Number) else Fraction(1) / x


def apply(name, x):
    """A function; of a fraction exactly where that is simple, else in an interval."""
    if isinstance(x, Number):
        return x.function(name)
    simple = {("exp", 0): 1, ("log", 1): 0, ("sin", 0): 0, ("cos", 0): 1, ("atan", 0): 0, ("asin", 0): 0, ("sqrt", 0): 0, ("sqrt", 1): 1}
    return Fraction(simple[name, x]) if (name, x) in simple else EXACT["function"](name, x)


EXACT = {"function": image}


def total(parts):
    parts = list(parts)
    return sum(parts[1:], parts[0]) if parts else Fraction(0)


def matrix(x):
    return x if isinstance(x, list) else [[x]]


def number(x):
    if isinstance(x, list):
        return x[0][0] if len(x) == len(x[0]) == 1 else refuse("a matrix where a number is meant")
    return x


def each(operation, a, b):
    if not isinstance(a, list) and not isinstance(b, list):
        return operation(a, b)
    a, b = matrix(a), matrix(b)
    if [len(row) for row in a] != [len(row) for row in b]:
        refuse("matrices of two shapes")
    return [[operation(x, y) for x, y in zip(*rows)] for rows in zip(a, b)]


def times(a, b):
    if isinstance(a, list) and isinstance(b, list):
        if len(a[0]) == len(b):
            return [[total(x * row[j] for x, row in zip(line, b)) for j in range(len(b[0]))] for line in a]
        a, b = (number(a), b) if len(a) == len(a[0]) == 1 else (a, number(b))
    if isinstance(b, list):
        a, b = b, a
    return [[x * b for x in row] for row in a] if isinstance(a, list) else a * b


def raised(x, n):
    if n < 0:
        return invert(raised(x, -n))
    found = Fraction(1)
    for bit in bin(n)[2:]:
        found = found * found * x if bit == "1" else found * found
    return found


def determinant(rows):
    minors = {(): Fraction(1)}
    for row in rows:
        grown = {}
        for columns, minor in minors.items():
            for column in (c for c in range(len(rows)) if c not in columns and not (isinstance(row[c], Fraction) and row[c] == 0)):
                part = row[column] * minor if sum(c > column for c in columns) % 2 == 0 else -(row[column] * minor)
                key = tuple(sorted((*columns, column)))
                grown[key] = grown[key] + part if key in grown else part
        minors = grown
    return next(iter(minors.values()), Fraction(0))


def inverse(rows):
    across, size = invert(determinant(rows)), range(len(rows))
    part = lambda i, j: determinant([[rows[k][l] for l in size if l != i] for k in size if k != j]) * across
    return [[part(i, j) if (i + j) % 2 == 0 else -part(i, j) for j in size] for i in size]
