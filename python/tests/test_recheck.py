"""The second checker: what is so is not doubted, and what is not so is."""

import os
import tempfile
import unittest
from fractions import Fraction

from palmistry.recheck import check
from palmistry.values import Arc, Interval, Turn, apply

PENDULUM = """
system "A pendulum, its angle and a clock seen"
state phi, omega, x
param k = 2, m unknown
angle phi
let energy = m*omega^2/2 - m*k*cos(phi)
drift f  phi' = omega  omega' = -k*sin(phi)  x' = exp(x)
output phi
claim 1: L(f, energy) = 0
claim 2: L(f, f, phi) = -k*sin(phi)
claim 3: L(f, f, phi) = k*sin(phi)
claim 4: rank = 2
claim 5: rank = 3
claim 6: L(f, f, x) = exp(2*x)
claim 7: L(f, omega) = 0 where sin(phi) = 0
claim 8: d(energy, phi, omega) = [m*k*sin(phi), m*omega]
claim 9: det([d(phi, phi, omega); d(L(f, phi), phi, omega)]) = 1
claim 10: sin(phi + pi/2) = cos(phi)
claim 11: x <= 1
claim 12: exp(x) >= 1
"""

STATE = {"phi": {"angle": {"sin": "3/5", "cos": "4/5"}}, "omega": {"number": "2"}, "x": {"number": "2"}, "k": {"number": "7"}}


class Recheck(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        with open(os.path.join(self.folder.name, "pendulum.proof"), "w", encoding="utf-8") as file:
            file.write(PENDULUM)

    def tearDown(self):
        self.folder.cleanup()

    def word(self, statement, kind, **evidence):
        record = {"file": "pendulum.proof", "id": "1", "statement": statement, "evidence": {kind: evidence}}
        return check(record, self.folder.name, {}, 1)[0]

    def test_identities(self):
        for statement in ("L(f, energy) = 0", "L(f, f, phi) = -k*sin(phi)", "L(f, omega) = 0 where sin(phi) = 0",
                          "d(energy, phi, omega) = [m*k*sin(phi), m*omega]", "sin(phi + pi/2) = cos(phi)",
                          "det([d(phi, phi, omega); d(L(f, phi), phi, omega)]) = 1"):
            self.assertEqual(self.word(statement, "proved"), "consistent", statement)
        self.assertEqual(self.word("L(f, f, phi) = k*sin(phi)", "proved"), "not confirmed")
        # equal exponentials of two arguments are not told apart here, and that is no doubt
        self.assertEqual(self.word("L(f, f, x) = exp(2*x)", "proved"), "not checked")
        self.assertEqual(self.word("L(f, energy) = 1", "proved"), "not checked")

    def test_refutations(self):
        self.assertEqual(self.word("L(f, f, phi) = k*sin(phi)", "refuted", state=STATE), "confirmed")
        self.assertEqual(self.word("L(f, f, phi) = -k*sin(phi)", "refuted", state=STATE), "not confirmed")
        self.assertEqual(self.word("x <= 1", "refuted", state=STATE), "confirmed")
        self.assertEqual(self.word("exp(x) >= 1", "refuted", state=STATE), "not confirmed")
        low = {**STATE, "x": {"number": "-1/10"}}
        self.assertEqual(self.word("exp(x) >= 1", "refuted", state=low), "confirmed")
        # a witness off the set of the conditions, and one that is no angle
        self.assertEqual(self.word("L(f, omega) = 0 where sin(phi) = 0", "refuted", state=STATE), "not confirmed")
        bent = {**STATE, "phi": {"angle": {"sin": "3/5", "cos": "3/5"}}}
        self.assertEqual(self.word("L(f, f, phi) = k*sin(phi)", "refuted", state=bent), "not confirmed")

    def test_ranks(self):
        self.assertEqual(self.word("rank = 2", "claimed_rank", word="proved"), "consistent")
        self.assertEqual(self.word("rank = 3", "claimed_rank", word="proved"), "not confirmed")
        self.assertEqual(self.word("rank = 3", "claimed_rank", word="refuted"), "consistent")
        minor = {"rows": [0, 1], "columns": [0, 1]}
        ranked = {"columns": ["phi", "omega", "x", "m"], "words": ["phi", "Lf phi", "Lf Lf phi"]}
        states = [{"state": STATE, "rank": 2, "minor": minor, "kernel": []}]
        self.assertEqual(self.word("rank", "rank", states=states, **ranked), "confirmed")
        states[0]["minor"] = {"rows": [0, 2], "columns": [0, 1]}
        self.assertEqual(self.word("rank", "rank", states=states, **ranked), "not confirmed")

    def test_intervals_hold_what_they_enclose(self):
        pi = Turn(Fraction(1)).value(Interval(0, 0))
        self.assertLess(pi.high - pi.low, Fraction(1, 10**100))
        for x in (Fraction(1, 3), Fraction(-7, 2), Fraction(9, 10), Fraction(40)):
            one = apply("sin", Interval(x, x)), apply("cos", Interval(x, x))
            square = one[0] * one[0] + one[1] * one[1]
            self.assertTrue(square.low <= 1 <= square.high and square.high - square.low < Fraction(1, 10**60))
            back = apply("log", apply("exp", Interval(x, x)))
            self.assertTrue(back.low <= x <= back.high)
            tangent = apply("atan", Interval(x, x))
            again = apply("sin", tangent) / apply("cos", tangent)
            self.assertTrue(again.low <= x <= again.high)
            root = apply("sqrt", Interval(abs(x), abs(x)))
            self.assertTrue((root * root).low <= abs(x) <= (root * root).high)
        self.assertEqual(apply("sin", Arc(Fraction(3, 5), Fraction(4, 5)) + Turn(Fraction(1, 2))), Fraction(4, 5))


if __name__ == "__main__":
    unittest.main()
