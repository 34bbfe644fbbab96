"""Expressions as a graph in which what is equal stands once, and maps of it: derivatives, residues, enclosures."""

import random
from fractions import Fraction
from math import floor, isqrt
from operator import add, mul

MOST, LONGEST, FINE = 400_000, 100_000, 1 << 400  # nodes; bits of a fraction; ends of an interval are parts of this
PI = Fraction(3141592653589793238462643383279502884197169399375105820974944592307816406286, 10**75)
SERIES = {"exp": (1, 1, 1, 1), "sin": (0, 1, 0, -1), "cos": (1, 0, -1, 0)}  # times x^k/k!, by k modulo 4


class NotRead(Exception):
    """What this program does not read, or does not tell."""


class Node:
    """A `number`, a `symbol`, `+` or `*` of two nodes, `^` with a whole exponent, or a function such as `sin`."""
    known = {}

    def __new__(cls, kind, *args):
        key = kind, *args
        if key not in cls.known:
            made = cls.known[key] = object.__new__(cls) if len(cls.known) < MOST else refuse("a large graph")
            made.kind, made.args, made.place = kind, args, len(cls.known)
            made.parts = [part for part in args if isinstance(part, Node)]
        return cls.known[key]

    def __add__(self, other):
        a, b = sorted((self, other), key=lambda node: (node.kind != "number", node.place))
        if b.kind == "number":
            return number(a.args[0] + b.args[0])
        return b if a.args == (0,) else Node("+", a, b)

    def __mul__(self, other):
        a, b = sorted((self, other), key=lambda node: (node.kind != "number", node.place))
        if b.kind == "number":
            return number(a.args[0] * b.args[0])
        if a.kind == "number" and b.kind == "*" and b.args[0].kind == "number":
            return a * b.args[0] * b.args[1]
        return a if a.args == (0,) else b if a.args == (1,) else Node("*", a, b)

    def __pow__(self, n):
        if self.kind == "number" and abs(n) < 64 and 0 < abs(self.args[0].numerator * self.args[0].denominator) < FINE:
            return number(self.args[0] ** n)
        return Node("^", self, n) if n not in (0, 1) else self if n else number(1)

    def __neg__(self): return number(-1) * self
    def __sub__(self, other): return self + -other
    def __truediv__(self, other): return self * other**-1

    def below(self, known=()):
        """This node and all that it is made of, what is made behind what it is made of; not what is known."""
        seen, new = set(), {self}
        while new:
            seen |= new
            new = {part for node in new for part in node.parts if part not in known} - seen
        return sorted(seen, key=lambda node: node.place)


def refuse(why): raise NotRead(why)
def number(value): return Node("number", Fraction(value))
def symbol(name): return Node("symbol", name)
def call(kind, x): return turned(x)[kind == "cos"] if kind in ("sin", "cos") else Node(kind, x)


def turned(x):
    """The sine and the cosine: of sums and multiples, by those of the angles that a state tells."""
    factor, of = (x.args[0].args[0], x.args[1]) if x.kind == "*" and x.args[0].kind == "number" else (Fraction(1), x)
    if x.args == (0,) or of is symbol("pi") and (2 * factor).denominator == 1:
        quarter = int(2 * factor) % 4 if x.args != (0,) else 0
        return number((0, 1, 0, -1)[quarter]), number((1, 0, -1, 0)[quarter])
    if factor < 0:
        sine, cosine = turned(-x)
        return -sine, cosine
    if of.kind == "+" or factor in range(2, 20):
        parts = [number(factor) * y for y in of.args] if of.kind == "+" else [of, number(factor - 1) * of]
        (a, b), (c, d) = map(turned, parts)
        return a * d + b * c, b * d - a * c
    return Node("sin", x), Node("cos", x)


RING = {"+": add, "*": mul, "^": pow}
SLOPES = {  # the derivatives of a node by its parts
    "+": lambda a, b: [number(1), number(1)], "*": lambda a, b: [b, a], "^": lambda x, n: [number(n) * x ** (n - 1)],
    "sin": lambda x: [call("cos", x)], "cos": lambda x: [-call("sin", x)], "exp": lambda x: [call("exp", x)],
    "log": lambda x: [x**-1], "sqrt": lambda x: [number("1/2") / call("sqrt", x)],
    "atan": lambda x: [(number(1) + x**2) ** -1]}


class Map(dict):
    """What a rule makes of nodes, from what it makes of their parts; here, expressions with what is given put in."""

    def __missing__(self, root):
        for node in root.below(self):
            self[node] = self.rule(node, *(self[x] if isinstance(x, Node) else x for x in node.args))
        return self[root]

    def rule(self, node, *of):
        return RING[node.kind](*of) if node.kind in RING else call(node.kind, *of) if node.parts else node


class Derivation(Map):
    """Derivatives along a field, by the rate of each symbol."""

    def __init__(self, rate):
        self.rate = rate

    def rule(self, node, *slopes):
        if all(slope.args == (0,) for slope in slopes[:len(node.parts)]) or not node.parts:
            return self.rate(*node.args) if node.kind == "symbol" else number(0)
        return sum(map(mul, SLOPES[node.kind](*node.args), slopes), number(0))


class Modulo(Map):
    """Residues: of symbols by chance, and of functions, the same of the same argument, which may be `guessed` then."""

    def __init__(self, prime, seed):
        self.prime, self.guessed = prime, False
        self.chance = lambda name: random.Random(f"{seed} {name}").randrange(prime)

    def rule(self, node, x, other=0):
        if node.kind in ("+", "*"):
            return RING[node.kind](x, other) % self.prime
        if node.kind == "^":
            return pow(x, other, self.prime) if x or other > 0 else 1 // x
        if not node.parts:
            return self.chance(x) if node.kind == "symbol" else x.numerator * pow(x.denominator, -1, self.prime)
        self.guessed |= node.parts[0].kind != "symbol" or node.kind not in ("sin", "cos", "exp")
        if node.kind == "sqrt":
            root = pow(x, (self.prime + 1) // 4, self.prime)
            return root if (root * root - x) % self.prime == 0 else 1 // 0
        tangent = self.chance(f"{node.kind.replace('cos', 'sin')} of {x}")  # of half the angle
        over = pow(1 + tangent**2, -1, self.prime)
        return {"sin": 2 * tangent * over, "cos": (1 - tangent**2) * over}.get(node.kind, tangent) % self.prime

    def gradient(self, root, names):
        """The derivatives by symbols, from the root downwards."""
        slopes = {root: 1}
        for node in reversed(root.below()):
            for part, by in zip(node.parts, SLOPES[node.kind](*node.args) if node.parts else ()):
                slopes[part] = (slopes.get(part, 0) + slopes[node] * self[by]) % self.prime
        return [slopes.get(symbol(name), 0) for name in names]


class Interval:
    """Two fractions between which a number lies, rounded outward; or one, exactly, where there is only arithmetic."""

    def __init__(self, *among):
        low, high = self.low, self.high = min(among), max(among)
        if low < high:
            self.low, self.high = Fraction(floor(low * FINE), FINE), Fraction(-floor(-high * FINE), FINE)
        elif (low.numerator * low.denominator).bit_length() > LONGEST:
            refuse("numbers of great length")

    def __add__(self, other): return Interval(self.low + other.low, self.high + other.high)
    def __mul__(self, other): return Interval(*(a * b for a in (self.low, self.high) for b in (other.low, other.high)))

    def __pow__(self, n):
        if abs(n) * max((x.numerator * x.denominator).bit_length() for x in (self.low, self.high)) > LONGEST:
            refuse("numbers of great length")
        turn = [Fraction(0) ** n] if self.low < 0 < self.high else []  # no value if the power is negative
        return Interval(self.low**n, self.high**n, *turn)

    def sign(self):
        is_told = self.low == self.high or not self.low <= 0 <= self.high
        return (self.low > 0) - (self.high < 0) if is_told else refuse("not told from zero")


class Enclosure(Map):
    """Intervals; a symbol that is not given has some value."""

    def rule(self, node, x, *other):
        if node.kind in RING:
            return RING[node.kind](x, *other)
        if not node.parts:
            some = Fraction(random.Random(x).randrange(1, 99), 32) if node.kind == "symbol" else x
            return Interval(PI, PI + Fraction(1, 10**75)) if x == "pi" else Interval(some)
        half = (x.high - x.low) / 2
        if node.kind in ("sin", "cos"):  # no further from the one in the middle than half the width
            return image(node.kind, x.low + half) + Interval(-half, half)
        return Interval(image(node.kind, x.low).low, image(node.kind, x.high).high)


def image(kind, x):
    """A function of a fraction; a root is exact where it is a fraction."""
    if kind == "sqrt":
        exact, root = Fraction(isqrt(x.numerator), isqrt(x.denominator)), isqrt(floor(x * FINE**2))
        return Interval(exact) if exact * exact == x else Interval(Fraction(root, FINE), Fraction(root + 1, FINE))
    k, total, part = 0, Interval(Fraction(0)), Interval(Fraction(1), 1 + Fraction(1, FINE))
    while k < 2 * abs(x) or abs(part.low + part.high) * FINE > 4:
        total, k = total + part * Interval(Fraction(SERIES[kind][k % 4])), k + 1
        part = part * Interval(x / k) if abs(x) < 64 else refuse("large arguments")
    rest = 2 * max(abs(part.low), abs(part.high))  # the parts fall by half at least from here on
    return total + Interval(-rest, rest)
