"""Expressions as a graph in which what is equal stands once, and maps of it: derivatives, residues, enclosures."""

import random
from collections import defaultdict
from fractions import Fraction
from functools import cache
from itertools import count
from math import floor, isqrt
from operator import add, attrgetter, mul

# so many nodes are gone through for a verdict, and for all of a file; one that is made counts for some
WORK, RUN, MADE = 6_000_000, 120_000_000, 10
LONGEST, FINE = 100_000, 1 << 400  # bits of a fraction; parts of one to which bounds are rounded
PI = Fraction(3141592653589793238462643383279502884197169399375105820974944592307816406286, 10**75)
SERIES = {"exp": (1, 1, 1, 1), "sin": (0, 1, 0, -1), "cos": (1, 0, -1, 0)}  # times x^k/k!, by k modulo 4
RING = {"+": add, "*": mul, "^": pow}

class Expression:
    """A `number`, a `symbol`, `+` or `*` of two nodes, `^` with a whole exponent, or a function such as `sin`."""
    __slots__ = "kind", "args", "parts", "place"
    places, work, left, began = count(), 0, RUN, RUN  # what a verdict has taken; what is left for all, now and when the graph was begun

    def __init__(self, kind, *args):
        self.kind, self.args, self.place = kind, args, next(self.places)
        self.parts = [part for part in args if isinstance(part, Expression)]
        spend(MADE)

    def joined(self, kind, other):
        a, b = sorted((self, other), key=lambda node: (node.kind != "number", node.place))
        if b.kind == "number":
            return number(RING[kind](a.args[0], b.args[0]))
        if a.kind == "number" and b.kind == kind and b.args[0].kind == "number":
            return a.joined(kind, b.args[0]).joined(kind, b.args[1])
        return {("+", 0): b, ("*", 0): a, ("*", 1): b}.get((kind, a.args[0])) or Node(kind, a, b)

    def __add__(self, other): return self.joined("+", other)
    def __mul__(self, other): return self.joined("*", other)
    def __neg__(self): return number(-1) * self
    def __sub__(self, other): return self + -other
    def __truediv__(self, other): return self * other**-1

    def __pow__(self, n):
        if self.kind == "number" and (self.args[0] or n > 0):
            return number(power(self.args[0], n))
        return {0: number(1), 1: self}.get(n) or Node("^", self, n)

    def lacks(self):
        """Whether there are arguments for which it has no value."""
        return self.kind in ("sqrt", "log") or self.kind == "^" and self.args[1] < 0

    def below(self, known=()):
        """This node and all that it is made of, what is made behind what it is made of; not what is known."""
        seen, new = set(), {self}
        while new:
            seen |= new
            new = {part for node in new for part in node.parts if part not in known} - seen
        spend(len(seen))
        return sorted(seen, key=attrgetter("place"))

class Spent(Exception):
    """That there is too much to do: it ends a verdict, and is no refusal that another way is tried after."""

def spend(work):
    Expression.work, Expression.left = Expression.work + work, Expression.left - min(work, WORK)
    if Expression.left < 0:
        raise Spent("the budget of work is spent")
    if Expression.work > WORK:
        raise Spent(f"too much work: more than {WORK} nodes")

Node = cache(Expression)
def refuse(why): raise NotImplementedError(why)

def forget():
    """Begins a new graph: numbers are nodes, and are not kept without the others."""
    for kept in (Node, number, turned):
        kept.cache_clear()

def short(x):
    """A fraction, and the work of an operation on it: as the square of its length."""
    length = x.numerator.bit_length() + x.denominator.bit_length()
    spend((length // 64) ** 2 // 64)
    return x if length < LONGEST else refuse("numbers of great length")
def power(x, n):
    """That of a fraction, whose length is known before it is made."""
    return x**n if (x.numerator.bit_length() + x.denominator.bit_length()) * abs(n) < LONGEST else refuse("numbers of great length")

@cache
def number(value): return Node("number", short(Fraction(value)))
def symbol(name): return Node("symbol", name)
def call(kind, x): return turned(x)[kind == "cos"] if kind in ("sin", "cos") else Node(kind, x)

@cache
def turned(x):
    """The sine and the cosine: of sums and multiples, by those of the angles that a state has."""
    spend(MADE)
    n, of = (x.args[0].args[0], x.args[1]) if x.kind == "*" and x.args[0].kind == "number" else (Fraction(1), x)
    quarters = 2 * n if of is symbol("pi") else Fraction(0 if x is number(0) else 1, 2)
    if quarters.denominator == 1:
        return [number((0, 1, 0, -1)[int(quarters + more) % 4]) for more in (0, 1)]
    if n < 0:
        sine, cosine = turned(-x)
        return -sine, cosine
    if of.kind == "+" or n in range(2, 20):
        (a, b), (c, d) = map(turned, [number(n) * y for y in of.args] if of.kind == "+" else [of, number(n - 1) * of])
        return a * d + b * c, b * d - a * c
    return Node("sin", x), Node("cos", x)

SLOPES = {  # the derivatives of a node by its parts
    "+": lambda a, b: [number(1), number(1)], "*": lambda a, b: [b, a], "^": lambda x, n: [number(n) * x ** (n - 1)],
    "sin": lambda x: [call("cos", x)], "cos": lambda x: [-call("sin", x)], "exp": lambda x: [call("exp", x)],
    "log": lambda x: [x**-1], "sqrt": lambda x: [number("1/2") / call("sqrt", x)],
    "atan": lambda x: [(number(1) + x**2) ** -1], "number": lambda x: [], "symbol": lambda x: []}

class Map(dict):
    """What a rule makes of nodes, from what it makes of their parts."""

    def __init__(self, rule, given=()):
        super().__init__(given)
        self.rule = rule

    def __missing__(self, root):
        for node in root.below(self):
            self[node] = self.rule(node, *(self[x] if isinstance(x, Expression) else x for x in node.args))
        return self[root]

def put_in(node, *of):
    """The rule of expressions in which something given is put in."""
    return RING[node.kind](*of) if node.kind in RING else call(node.kind, *of) if node.parts else node

def derivation(rate):
    """Derivatives along a field, by the rate of each symbol."""
    def rule(node, *slopes):
        terms = [by * slope for by, slope in zip(SLOPES[node.kind](*node.args), slopes) if slope is not number(0)]
        return rate(*node.args) if node.kind == "symbol" else sum(terms, number(0))
    return Map(rule)

class Modulo(Map):
    """Residues: of symbols by chance, and of functions, the same of the same argument, which may be `guessed` then."""

    def __init__(self, prime, seed, orders=None):
        super().__init__(self.residue)
        self.prime, self.guessed, self.orders = prime, False, {} if orders is None else orders
        self.chance = lambda name: random.Random(f"{seed} {name}").randrange(prime)

    def residue(self, node, x, other=0):
        if node.kind in RING:
            return pow(x, other, self.prime) if node.kind == "^" and x else RING[node.kind](x, other) % self.prime
        if not node.parts:
            return self.chance(x) if node.kind == "symbol" else x.numerator * pow(x.denominator, -1, self.prime)
        self.guessed |= node.parts[0].kind != "symbol" or node.kind not in SERIES
        if node.kind == "sqrt":
            root = pow(x, (self.prime + 1) // 4, self.prime)
            return root if (root * root - x) % self.prime == 0 else 1 // 0
        tangent = self.chance(f"{node.kind.replace('cos', 'sin')} of {x}")  # of half the angle
        over = pow(1 + tangent**2, -1, self.prime)
        return {"sin": 2 * tangent * over, "cos": (1 - tangent**2) * over}.get(node.kind, tangent) % self.prime

    def gradient(self, root, names):
        """The derivatives by symbols, from the root downwards; the order is the same at all points."""
        if root not in self.orders:
            self.orders[root] = [node for node in reversed(root.below()) if node.parts]
        slopes, prime = defaultdict(int, {root: 1 + 0 * self[root]}), self.prime  # so that all below has a value
        for node in self.orders[root]:
            kind, slope = node.kind, slopes[node] % prime
            if kind == "+":
                a, b = node.parts
                slopes[a] += slope
                slopes[b] += slope
            elif kind == "*":
                a, b = node.parts
                slopes[b] += slope * self[a]
                if a.kind != "number":
                    slopes[a] += slope * self[b]
            else:
                x, *n = node.args
                slopes[x] += slope * (n[0] * pow(self[x], n[0] - 1, prime) if n else self[SLOPES[kind](x)[0]])
        return [slopes[symbol(name)] % prime for name in names]

class Interval:
    """Two fractions between which a number lies, rounded outward; or one, exactly, where there is only arithmetic."""

    def __init__(self, *among):
        self.low, self.high = short(min(among)), short(max(among))
        if self.low < self.high:
            self.low, self.high = Fraction(floor(self.low * FINE), FINE), Fraction(-floor(-self.high * FINE), FINE)

    def __add__(self, other): return Interval(self.low + other.low, self.high + other.high)
    def __mul__(self, other): return Interval(*(a * b for a in (self.low, self.high) for b in (other.low, other.high)))

    def __pow__(self, n):  # without a value where it holds zero and the power is negative
        return Interval(power(self.low, n), power(self.high, n), *([Fraction(0) ** n] if self.low < 0 < self.high else []))

    def sign(self):
        is_told = self.low == self.high or not self.low <= 0 <= self.high
        return (self.low > 0) - (self.high < 0) if is_told else refuse("not distinguished from zero")

def enclosed(node, x, *other):
    """The rule of intervals; a symbol that is not given has some value."""
    if node.kind in RING:
        return RING[node.kind](x, *other)
    if node.kind == "symbol":
        some = Fraction(random.Random(x).randrange(1, 99), 32)
        return Interval(PI, PI + Fraction(1, 10**75)) if x == "pi" else Interval(some)
    if node.kind == "number":
        return Interval(x)
    if node.kind in ("exp", "sqrt"):
        return Interval(image(node.kind, x.low).low, image(node.kind, x.high).high)
    half = (x.high - x.low) / 2  # a sine is no further from the one in the middle than that
    return image(node.kind, x.low + half) + Interval(-half, half)

def image(kind, x):
    """A function of a fraction, by its series; a root between its next parts of one."""
    if kind == "sqrt":
        return Interval(*(Fraction(isqrt(floor(x * FINE**2)) + more, FINE) for more in (0, 1)))
    k, total, part = 0, Interval(Fraction(0)), Interval(Fraction(1), 1 + Fraction(1, FINE))
    while k < 2 * abs(x) or abs(part.low + part.high) * FINE > 4:
        total, k = total + part * Interval(Fraction(SERIES[kind][k % 4])), k + 1
        part = part * Interval(x / k) if abs(x) < 64 else refuse("large arguments")
    rest = 2 * max(abs(part.low), abs(part.high))  # the parts fall by half at least from here on
    return total + Interval(-rest, rest)
