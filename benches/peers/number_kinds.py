"""What the plain test counts in: residues modulo a prime, small or large, or real numbers in many digits."""

import random

import numpy as np

PRIMES = (134217487, 134217467, 134217439, 134217403)  # the largest below 2^27 that are 3 modulo 4: roots are powers there


class NoSuchState(Exception):
    """A division by zero, or a root of what is no square: another state has to be drawn."""


class Prime:
    """Integers modulo a prime. Below 2^27, 512 products are summed in 64 bits; larger ones are Python's own integers."""

    def __init__(self, seed, prime=None):
        prime = prime or PRIMES[seed % len(PRIMES)]
        self.prime, self.random, self.memory = prime, random.Random(seed), {}
        self.dtype = np.int64 if prime < 2**27 else object

    def reduce(self, value):
        return value % self.prime

    def invert(self, value):
        if value % self.prime == 0:
            raise NoSuchState
        return pow(int(value), -1, self.prime)

    def number(self, fraction):
        return fraction.numerator % self.prime * self.invert(fraction.denominator) % self.prime

    def draw(self, name=None, span=None):
        return self.random.randrange(1, self.prime)

    def function(self, name, argument):
        """A value at a state: some number, the same for the same argument; sines and cosines on the circle."""
        argument, prime = int(argument), self.prime
        if name == "sqrt":
            root = pow(argument, (prime + 1) // 4, prime)  # the prime is 3 modulo 4
            if argument == 0 or root * root % prime != argument:
                raise NoSuchState
            return root
        kind = "sin" if name == "cos" else "sinh" if name == "cosh" else name
        if (kind, argument) not in self.memory:
            tangent = self.draw()
            square = tangent * tangent % prime * (-1 if kind == "sinh" else 1)
            scale = self.invert(1 + square)
            self.memory[kind, argument] = (2 * tangent * scale % prime, (1 - square) * scale % prime)
        return (
            self.memory[kind, argument][name in ("cos", "cosh")]
            if kind in ("sin", "sinh")
            else self.memory[kind, argument][0]
        )

    def pivot(self, row):
        places = np.flatnonzero(row)
        return places[0] if len(places) else None


class Reals:
    """True states, in three hundred digits: slower, and nothing is taken for independent. What is below 10^-250 of its row is noise."""

    dtype = object

    def __init__(self, seed, digits=300):
        import mpmath

        self.mp, self.random = mpmath.mp.clone(), random.Random(seed)
        self.mp.dps, self.small = digits, self.mp.mpf(10) ** (50 - digits)

    def reduce(self, value):
        return value

    def invert(self, value):
        if abs(value) < self.small:
            raise NoSuchState
        return 1 / self.mp.mpf(value)

    def number(self, fraction):
        return self.mp.mpf(fraction.numerator) / fraction.denominator

    def draw(self, name=None, span=None):
        if name == "pi":
            return +self.mp.pi
        low, high = span or (self.mp.mpf(1) / 2, self.mp.mpf(2))
        return low + (high - low) * self.mp.mpf(self.random.randrange(1, 10**9)) / 10**9

    def function(self, name, argument):
        value = getattr(self.mp, name)(argument)
        if not self.mp.isfinite(value) or isinstance(value, self.mp.mpc) or name == "sqrt" and value < self.small:
            raise NoSuchState
        return value

    def pivot(self, row):
        place = max(range(len(row)), key=lambda column: abs(row[column]), default=None)
        if place is None:
            return None
        return place if abs(row[place]) > self.small else None
