"""How large the numerator of an expression can be, from which the error probability follows where it vanishes at random points modulo random primes.

A polynomial that is not zero vanishes at a random point with a probability of at most its degree over the prime (Schwartz 1980), and all its coefficients
modulo a random prime with one of at most their bits over the number of primes. A size here is a degree plus bits.
"""

import secrets
from math import log2

from .graph import Map, refuse

BITS, LARGEST, MOST = 126, 2.0**80, 200  # primes are drawn between two powers of two; of anything larger, or with more divisors, nothing is known

def is_prime(n):
    """Miller and Rabin's test with random bases: what it lets through is composite with a probability below 2^-128."""
    twos = ((n - 1) & -(n - 1)).bit_length() - 1
    for base in [2, *(2 + secrets.randbelow(n - 3) for _ in range(64))]:
        power = pow(base, (n - 1) >> twos, n)
        if power in (1, n - 1):
            continue
        if not any((power := power * power % n) == n - 1 for _ in range(twos - 1)):
            return False
    return True

def prime():
    """A prime that nobody could foresee, with three as its remainder by four, so that roots of squares are powers."""
    while True:
        n = (1 << BITS) + 4 * secrets.randbits(BITS - 2) + 3
        if all(n % small for small in (3, 5, 7, 11, 13, 17, 19, 23)) and is_prime(n):
            return n

class Size:
    """The size of a numerator, of what stands below it with its powers, and of what each of those is."""
    __slots__ = "own", "below"

    def __init__(self, own, below=()):
        self.own, self.below = own if own < LARGEST and len(below) <= MOST else refuse("an expression without a bound"), dict(below)

    def over(self, common, sizes):
        """The size over a larger denominator."""
        return self.own + sum((n - self.below.get(x, 0)) * sizes[x] for x, n in common.items())

def common(*sizes):
    found = {}
    for size in sizes:
        for x, n in size.below.items():
            found[x] = max(found.get(x, 0), n)
    return found

class Sizes(Map):
    """The sizes of expressions in symbols, sines, cosines and exponentials of symbols."""

    def __init__(self):
        super().__init__(self.rule_of)
        self.of_below = {}

    def rule_of(self, node, a=None, b=None):
        if node.kind == "number":
            return Size(1 + float(max(abs(a.numerator), a.denominator).bit_length()), self.named(("number", a.denominator), float(a.denominator.bit_length())) if a.denominator > 1 else ())
        if node.kind == "symbol" or node.kind == "exp" and node.parts[0].kind == "symbol":
            return Size(1.0)
        if node.kind in ("sin", "cos") and node.parts[0].kind == "symbol":
            return Size(5.0, self.named(("circle", node.parts[0]), 3.0))
        if node.kind == "+":
            below = common(a, b)
            return Size(1 + max(a.over(below, self.of_below), b.over(below, self.of_below)), below)
        if node.kind == "*":
            return Size(a.own + b.own, {x: a.below.get(x, 0) + b.below.get(x, 0) for x in {**a.below, **b.below}})
        if node.kind == "^" and b > 0:
            return Size(a.own * b, {x: n * b for x, n in a.below.items()})
        if node.kind == "^":
            below = self.named(("divisor", node.parts[0]), a.own)
            return Size(-b * sum(n * self.of_below[x] for x, n in a.below.items()), {x: -b for x in below})
        return refuse("a function without a bound")

    def named(self, what, size):
        self.of_below[what] = max(size, self.of_below.get(what, 0))
        return {what: 1}

    def of_row(self, entries):
        """Of entries over one denominator."""
        sizes = [self[x] for x in entries]
        below = common(*sizes)
        return max((size.over(below, self.of_below) for size in sizes), default=0)

    def of_differential(self, x):
        """Of all slopes of an expression: each divisor once more below, and the square and one of a tangent above."""
        size = self[x]
        return 2 * (size.own + sum(self.of_below[y] for y in size.below)) + 64

    @staticmethod
    def of_minors(rows, count):
        return sum(sorted(rows, reverse=True)[:count]) + count * log2(count + 1)

def is_enough(size, points, wanted=100):
    """Whether as many points make the probability of an error less than two to minus what is wanted."""
    return points * (BITS - 9 - log2(1 + size)) > wanted
