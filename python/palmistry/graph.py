"""Expressions as a graph in which what is equal stands once; their derivatives; their values modulo primes and in intervals of fractions."""

import random
from fractions import Fraction
from math import isqrt

MOST, WORK = 400_000, 1_000_000  # nodes of a graph; nodes that may be gone through for a verdict
LONGEST, ONE = 100_000, 1 << 300  # bits of a fraction; an interval's ends are parts of this


class NotRead(Exception):
    """What this program does not read, or does not tell."""


def refuse(why):
    raise NotRead(why)


class Node:
    """A `number`, a `symbol`, `+` or `*` of two nodes, `^` with a whole exponent, or a function such as `sin` of a node."""
    known, work = {}, 0

    def __new__(cls, *key):
        if key not in cls.known:
            made = cls.known[key] = object.__new__(cls) if len(cls.known) < MOST else refuse(f"more than {MOST} parts of expressions")
            made.kind, made.args, made.place = key[0], key[1:], len(cls.known)
            made.parts = [part for part in key if isinstance(part, Node)]
        return cls.known[key]

    def __add__(self, other):
        first, second = sorted((self, other), key=lambda node: (node.kind != "number", node.place))
        if second.kind == "number":
            return number(first.args[0] + second.args[0])
        return second if first is number(0) else Node("+", first, second)

    def __mul__(self, other):
        first, second = sorted((self, other), key=lambda node: (node.kind != "number", node.place))
        if second.kind == "number":
            return number(first.args[0] * second.args[0])
        if first.kind == "number" and second.kind == "*" and second.args[0].kind == "number":
            return number(first.args[0] * second.args[0].args[0]) * second.args[1]
        return first if first is number(0) else second if first is number(1) else Node("*", first, second)

    def __pow__(self, n):
        if n in (0, 1) or self is number(1):
            return self if n else number(1)
        is_small = self.kind == "number" and abs(n) < 64 and 0 < abs(self.args[0].numerator * self.args[0].denominator) < ONE
        return number(self.args[0] ** n) if is_small else Node("^", self, n)

    def __neg__(self): return number(-1) * self
    def __sub__(self, other): return self + -other
    def __truediv__(self, other): return self * other**-1


def number(value): return Node("number", Fraction(value))
def symbol(name): return Node("symbol", name)


def call(kind, x):
    """A function of a node. Sines and cosines of sums are made of those of their parts: an angle is met by these alone."""
    known = {("exp", 0): 1, ("log", 1): 0, ("sqrt", 0): 0, ("sqrt", 1): 1, ("atan", 0): 0}
    if x.kind == "number" and (kind, x.args[0]) in known:
        return number(known[kind, x.args[0]])
    return turned(x)[kind == "cos"] if kind in ("sin", "cos") else Node(kind, x)


def turned(x):
    """The sine and the cosine."""
    factor, of = (x.args[0].args[0], x.args[1]) if x.kind == "*" and x.args[0].kind == "number" else (Fraction(1), x)
    if x is number(0) or of is symbol("pi") and (2 * factor).denominator == 1:
        quarter = int(2 * factor) % 4 if x is not number(0) else 0
        return number((0, 1, 0, -1)[quarter]), number((1, 0, -1, 0)[quarter])
    if factor < 0:
        sine, cosine = turned(-x)
        return -sine, cosine
    if of.kind == "+" or factor in range(2, 20):
        parts = [number(factor) * part for part in of.args] if of.kind == "+" else [of, number(factor - 1) * of]
        (a, b), (c, d) = map(turned, parts)
        return a * d + b * c, b * d - a * c
    return Node("sin", x), Node("cos", x)


SLOPES = {"sin": lambda x: call("cos", x), "cos": lambda x: -call("sin", x), "exp": lambda x: call("exp", x), "log": lambda x: x**-1,
          "sqrt": lambda x: (number(2) * call("sqrt", x)) ** -1, "atan": lambda x: (number(1) + x * x) ** -1}


def partials(node):
    """What a node is made of, each with the derivative of the node by it."""
    if node.kind == "^":
        return [(node.args[0], number(node.args[1]) * node.args[0] ** (node.args[1] - 1))]
    if node.kind == "*":
        return [node.args, node.args[::-1]]
    return [(part, SLOPES.get(node.kind, lambda x: number(1))(part)) for part in node.parts]


def below(root, known=()):
    """A node and all that it is made of, what is made behind what it is made of; not what is known."""
    seen, waiting = set(), [root]
    while waiting:
        node = waiting.pop()
        if node not in seen and node not in known:
            seen.add(node)
            waiting += node.parts
    Node.work += len(seen)
    return refuse("it takes too long here") if Node.work > WORK else sorted(seen, key=lambda node: node.place)


class Field:
    """A way to move, by the rate of each symbol."""

    def __init__(self, rate): self.rate, self.kept = rate, {}

    def along(self, of):
        """The derivative along the field."""
        for node in below(of, self.kept):
            slope = self.rate(node.args[0]) if node.kind == "symbol" else number(0)
            if any(self.kept[part] is not number(0) for part in node.parts):
                for part, by in partials(node):
                    slope = slope + by * self.kept[part]
            self.kept[node] = slope
        return self.kept[of]


class Point:
    """Values of nodes: what a domain gives to numbers, symbols and functions, or what they are given here."""

    def __init__(self, domain, given): self.domain, self.values = domain, dict(given)

    def value(self, root):
        for node in below(root, self.values):
            parts = [self.values[part] for part in node.parts]
            if node.kind in ("number", "symbol"):
                self.values[node] = getattr(self.domain, node.kind)(node.args[0])
            elif node.kind in ("+", "*"):
                self.values[node] = parts[0] + parts[1] if node.kind == "+" else parts[0] * parts[1]
            else:
                self.values[node] = parts[0] ** node.args[1] if node.kind == "^" else self.domain.function(node, parts[0])
        return self.values[root]

    def slopes(self, root, names):
        """The derivatives by symbols, from the root downwards."""
        slopes = {root: self.domain.number(Fraction(1))}
        for node in reversed(below(root)):
            for part, by in partials(node) if node in slopes else ():
                more = slopes[node] * self.value(by)
                slopes[part] = slopes[part] + more if part in slopes else more
        return [slopes.get(symbol(name), self.domain.number(Fraction(0))) for name in names]


class Expressions:
    """The domain of nodes: other expressions are put in the place of symbols."""
    number, symbol, function = staticmethod(number), staticmethod(symbol), staticmethod(lambda node, x: call(node.kind, x))


class Residue:
    def __init__(self, value, prime): self.value, self.prime = value % prime, prime
    def __add__(self, other): return Residue(self.value + other.value, self.prime)
    def __mul__(self, other): return Residue(self.value * other.value, self.prime)
    def sign(self): return int(self.value != 0)

    def __pow__(self, n):
        if self.value == 0 and n < 0:
            raise ZeroDivisionError
        return Residue(pow(self.value, n, self.prime), self.prime)


class Modulo:
    """Residues: of symbols by chance, and of functions, the same of the same argument; `guessed` tells whether these may depend on others."""

    def __init__(self, prime, seed): self.prime, self.seed, self.guessed = prime, seed, False
    def number(self, x): return Residue(x.numerator * pow(x.denominator, -1, self.prime), self.prime)
    def symbol(self, name): return Residue(random.Random(f"{self.seed} {name}").randrange(self.prime), self.prime)

    def function(self, node, x):
        self.guessed |= node.parts[0].kind != "symbol" or node.kind not in ("sin", "cos", "exp")
        if node.kind == "sqrt":
            root = x ** ((self.prime + 1) // 4)
            return root if (root * root).value == x.value else Residue(0, self.prime) ** -1
        chance, one = self.symbol(f"{node.kind.replace('cos', 'sin')} of {x.value}"), Residue(1, self.prime)
        over = (one + chance * chance) ** -1  # by the tangent of half the angle
        return {"sin": (chance + chance) * over, "cos": over + over + Residue(-1, self.prime)}.get(node.kind, chance)


class Interval:
    """Two fractions between which a number lies, rounded outward; or one, exactly, as long as there is only arithmetic."""

    def __init__(self, low, high):
        self.low, self.high = (low, high) if low == high else (Fraction((low * ONE).__floor__(), ONE), Fraction((high * ONE).__ceil__(), ONE))
        if (low.numerator * low.denominator).bit_length() > LONGEST:
            refuse("numbers of great length")

    def __add__(self, other): return Interval(self.low + other.low, self.high + other.high)

    def __mul__(self, other):
        products = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return Interval(min(products), max(products))

    def __pow__(self, n):
        if n < 0 and self.low <= 0 <= self.high:
            raise ZeroDivisionError
        if abs(n) * max((end.numerator * end.denominator).bit_length() for end in (self.low, self.high)) > LONGEST:
            refuse("numbers of great length")
        ends = sorted((self.low**n, self.high**n))
        return Interval(Fraction(0) if n % 2 == 0 and self.low < 0 < self.high else ends[0], ends[1])

    def sign(self):
        return (self.low > 0) - (self.high < 0) if self.low == self.high or not self.low <= 0 <= self.high else refuse("not told from zero")


class Intervals:
    """The domain of intervals; a symbol that is not given has any value."""

    def number(self, x): return Interval(x, x)

    def symbol(self, name):
        pi = Fraction(3141592653589793238462643383279502884197169399375105820974944592307816406286, 10**75)
        return Interval(pi, pi + Fraction(1, 10**75)) if name == "pi" else self.number(Fraction(random.Random(name).randrange(1, 99), 32))

    def function(self, node, x):
        if node.kind in ("sin", "cos"):  # no further from the one in the middle than half the width
            half = (x.high - x.low) / 2
            return image(node.kind, x.low + half) + Interval(-half, half)
        return Interval(image(node.kind, x.low).low, image(node.kind, x.high).high)


def image(kind, x):
    """A function of a fraction; a root is exact where it is a fraction."""
    if kind == "sqrt" and x >= 0:
        exact, root = Fraction(isqrt(x.numerator), isqrt(x.denominator)), Fraction(isqrt((x * ONE**2).__floor__()), ONE)
        return Interval(exact, exact) if exact * exact == x else Interval(root, root + Fraction(1, ONE))
    if kind not in ("exp", "sin", "cos") or abs(x) > 64:
        return refuse(f"a value of {kind}") if kind != "sqrt" else Interval(Fraction(0), Fraction(0)) ** -1
    k, step, fine = int(kind == "sin"), 1 if kind == "exp" else 2, ONE**2 << 128  # what is rounded on the way grows by no more than exp(64)
    part, total = (x**k * fine).__floor__(), 0
    while k < 2 * abs(x) or abs(part) * ONE > fine:
        total, k = total + part, k + step
        ratio = x / k if step == 1 else -x * x / (k * (k - 1))
        part = part * ratio.numerator // ratio.denominator
    slack = Fraction(2 * abs(part), fine) + Fraction(k, ONE)  # the parts fall by half at least from here on
    return Interval(Fraction(total, fine) - slack, Fraction(total, fine) + slack)
