"""The second checker: what is so is not doubted, what is not so is, and what is damaged is named."""

import contextlib
import io
import json
import os
import random
import subprocess
import tempfile
import time
import unittest
from fractions import Fraction

from common import PROGRAM, built

from palmistry import graph, proof_file, recheck
from palmistry.graph import Interval, Map, Modulo, Node, call, derivation, enclosed, image, number, symbol
from palmistry.proof_parser import parts
from palmistry.recheck import check, listed_statement

PENDULUM = """
system "A pendulum, its angle and a clock seen"
state phi : angle, omega, x
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
claim 13: L(f, energy) = 1
claim 14: observable(omega, omega^2 + 3)
claim 15: observable(omega, m)
claim 16: unobservable(x, m)
claim 17: rank([x, m; 2*x, 2*m]) = 1
claim 18: rank = 2 everywhere
claim 19: omega*(x + m) = k where x = k/omega - m
"""

STATE = {"phi": {"angle": {"sin": "3/5", "cos": "4/5"}}, "omega": {"number": "2"}, "x": {"number": "2"}, "k": {"number": "7"}}
RANKED = {"columns": ["phi", "omega", "x", "m"], "row_names": ["phi", "Lf phi", "Lf Lf phi"],
          "states": [{"state": STATE, "rank": 2, "minor": {"rows": [0, 1], "columns": [0, 1]}, "kernel": []}]}
BOX = """
system "A pendulum whose angle is measured"
state phi : angle, omega
param k = 2
angle phi
drift f  phi' = omega  omega' = -k*sin(phi)
output phi
claim 1: rank = 2
"""
BOXED = {"columns": ["phi", "omega"], "row_names": ["phi", "Lf phi", "Lf Lf phi"], "volume": "1",
         "ranges": [{"symbol": "phi", "low": "1/10", "high": "3"}, {"symbol": "omega", "low": "-1", "high": "1"},
                    {"symbol": "k", "low": "2", "high": "2"}],
         "boxes": [{"sides": [["1/10", "1"], ["-1", "1"]], "rows": [0, 1]}, {"sides": [["1", "3"], ["-1", "1"]], "rows": [1, 0]}]}
SO, NOT_SO = ("confirmed", "half confirmed", "consistent"), ("not confirmed", "not checked")


LISTED = {"rank": "system_at_states", "full rank": "system_on_boxes"}


def record(statement, kind, evidence):
    """A verdict, bound to its claim but for the digest and the id, which `Folder.answer` finds in the file."""
    if statement in LISTED:
        asked = {"what": LISTED[statement], "claimed": "", "sense": "listed", "where": "", "except": ""}
        return {"file": "pendulum.proof", "id": "rank" if kind == "rank" else "certify", "statement": listed_statement(asked["what"], ""),
                "asked": asked, "verdict": "found", "evidence": {kind: evidence}}
    return {"file": "pendulum.proof", "statement": statement, "asked": parts(statement),
            "verdict": evidence.get("word", "refuted" if kind == "refuted" else "proved"), "evidence": {kind: evidence}}


GOOD = [
    *(record(statement, "proved", {}) for statement in (
        "L(f, energy) = 0", "L(f, f, phi) = -k*sin(phi)", "L(f, omega) = 0 where sin(phi) = 0", "sin(phi + pi/2) = cos(phi)",
        "d(energy, phi, omega) = [m*k*sin(phi), m*omega]", "det([d(phi, phi, omega); d(L(f, phi), phi, omega)]) = 1",
        "omega*(x + m) = k where x = k/omega - m", "rank = 2 everywhere")),
    *(record(statement, "claimed_rank", {"word": "proved"}) for statement in (
        "rank = 2", "rank([x, m; 2*x, 2*m]) = 1", "observable(omega, omega^2 + 3)", "unobservable(x, m)")),
    record("rank = 3", "claimed_rank", {"word": "refuted"}),
    record("L(f, f, phi) = k*sin(phi)", "refuted", {"state": STATE}), record("x <= 1", "refuted", {"state": STATE}),
    record("exp(x) >= 1", "refuted", {"state": {**STATE, "x": {"number": "-1/10"}}}),
    record("rank", "rank", RANKED)]


class Folder(unittest.TestCase):
    """A folder with a proof file, and what the checker says of records about it."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        graph.Expression.left = graph.Expression.began = graph.RUN
        self.write(PENDULUM)

    def write(self, text, name="pendulum.proof"):
        path = os.path.join(self.folder.name, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def bound(self, entry):
        """A record with the digest of its file, and the id of its claim."""
        graph.Expression.work = 0
        with contextlib.suppress(Exception):
            system = proof_file.System(os.path.join(self.folder.name, entry["file"]))
            plain = "".join(entry["statement"].split())
            ids = [name for name, text in system.claims.items() if "".join(text.split()) == plain]
            return {"digest": system.digest, "id": (ids or ["1"])[0], **entry}
        return {"digest": "", "id": "1", **entry}

    def answer(self, entry):
        found = check(self.bound(entry), self.folder.name, {}, 1)
        self.assertIn(found[0], SO + NOT_SO)
        return found[0]

    def word(self, statement, kind, **evidence):
        return self.answer(record(statement, kind, evidence))


class Recheck(Folder):
    def test_a_state_of_its_own_evidence_denies_a_verdict(self):
        """By hand: the determinant is x*y, so the rank is 2 where it is not zero, 1 at (0, 1/3), and random points see nothing of that."""
        matrix = "rank([x, y; 2*x, 3*y]) = 2"
        self.write(f"""system "m"
state x, y
drift f  x' = y  y' = x
output x
claim 1: {matrix} everywhere
claim 2: {matrix}
claim 3: {matrix} except where x = 0
""", "m.proof")
        path = os.path.join(self.folder.name, "m.proof")
        for place, sense, expected in ((1, "everywhere", "not confirmed"), (2, "generic", None), (3, "except", None)):
            state = {"state": {"x": {"number": "0"}, "y": {"number": "1/3"}}, "rank": 1, "minor": {"rows": [0], "columns": [1]}, "kernel": [["1", "0"]]}
            evidence = {"rank": {"columns": ["column 1", "column 2"], "row_names": ["row 1", "row 2"], "requirements": [], "states": [state]}}
            system = proof_file.System(path)
            text = system.claims[str(place)]
            entry = {"file": "m.proof", "digest": system.digest, "id": str(place), "statement": text, "asked": parts(text),
                     "verdict": "proved", "evidence": evidence}
            self.assertEqual(entry["asked"]["sense"], sense)
            word = check(entry, self.folder.name, {}, 1)[0]
            self.assertEqual(word == "not confirmed", expected == "not confirmed", (sense, word))

    def test_a_witness_gives_no_value_to_pi(self):
        self.write(PENDULUM + "claim 0: pi > 3\n")
        for value in ({"number": "2"}, {"angle": {"sin": "0", "cos": "1"}}):
            self.assertIn(self.word("pi > 3", "refuted", state={"pi": value}), NOT_SO)
        self.write(BOX.replace("omega' = -k*sin(phi)", "omega' = -(pi - 3)*omega"))
        box = {**BOXED, "ranges": [*BOXED["ranges"], {"symbol": "pi", "low": "1", "high": "1"}]}
        self.assertIn(self.word("full rank", "boxes", **box), NOT_SO)

    def test_a_term_without_a_value_refutes_nothing(self):
        """`0/x` is zero, but not at x = 0: what holds wherever both sides exist is not refuted there, through definitions, fields and derivatives too."""
        lost = ("0/x + x^2 > 0", "zero + x^2 > 0", "d(1/x, phi) + x^2 > 0", "L(h, phi) + x^2 > 0", "0*log(x) + x^2 > 0", "x^2 + 0/(x*m) > 0", "(1/x)^0 = 2")
        for statement in lost:
            self.write(PENDULUM + f"let zero = 0/x\nfield h  phi' = 0/x\nclaim 0: {statement}\n")
            self.assertEqual(self.word(statement, "refuted", state={**STATE, "x": {"number": "0"}}), "not checked", statement)
        self.write(PENDULUM + "let zero = 0/x\nclaim 0: zero + x^2 > 5\n")
        self.assertEqual(self.word("zero + x^2 > 5", "refuted", state=STATE), "confirmed")
        statement = "rank([0/x, omega]) = 1 everywhere"
        self.write(PENDULUM + f"claim 0: {statement}\n")
        state = {"state": {**STATE, "x": {"number": "0"}, "omega": {"number": "0"}}, "rank": 0, "minor": {"rows": [], "columns": []}, "kernel": []}
        entry = record(statement, "rank", {"columns": ["column 1", "column 2"], "row_names": ["row 1"], "states": [state]})
        self.assertEqual(self.answer({**entry, "verdict": "refuted"}), "not checked")

    def test_ranks_at_states_that_the_file_excludes(self):
        """What a file assumes holds at the states of a rank; what is about other symbols says nothing of them."""
        for state, word in ((STATE, "half confirmed"), ({**STATE, "k": {"number": "-7"}}, "not confirmed")):
            self.write(PENDULUM + "assume k > 0, m > 0\n")
            entry = record("rank", "rank", {**RANKED, "states": [{**RANKED["states"][0], "state": state}]})
            self.assertEqual(self.answer(entry), word)

    def test_what_is_another_statement_is_not_read_as_one(self):
        """A rank of two matrices, or of none; sets that an equation leaves out; the sample box, wherever it is named; discrete time."""
        for statement in ("rank([x, 0; 0, x], [x]) = 2", "rank() = 2", "observable(omega) = 3"):
            self.write(PENDULUM + f"claim 0: {statement}\n")
            self.assertIn(self.word(statement, "claimed_rank", word="proved"), NOT_SO, statement)
        for statement in ("x*omega = 0 except where x = omega", "x = 0 everywhere", "x < 1 where omega = 2 on sample", "x < 1 on sample"):
            self.write(PENDULUM + f"claim 0: {statement}\n")
            self.assertIn(self.word(statement, "refuted", state=STATE), NOT_SO, statement)
        self.write("system \"s\"\nstate x, y\ndrift f  x+ = y  y+ = x\noutput x\nclaim 1: rank = 2\nclaim 2: rank = 1\n")
        for statement in ("rank = 2", "rank = 1"):
            self.assertEqual(self.word(statement, "claimed_rank", word="proved"), "not checked")

    def test_a_verdict_turned_over_is_not_confirmed(self):
        """Each kind of claim, true and false, with the contrary verdict: without evidence, and with that of the right one."""
        matrix = "rank([x, omega; 2*x, 3*omega])"
        for true, false in (("rank = 2", "rank = 3"), ("rank = 2 everywhere", "rank = 1 everywhere"), (f"{matrix} = 2", f"{matrix} = 1"),
                            (f"{matrix} = 2 except where x*omega = 0", f"{matrix} = 2 everywhere"), ("observable(omega)", "observable(x)"),
                            ("unobservable(x)", "unobservable(omega)"), ("x = x", "x = omega"), ("x^2 >= 0", "x^2 >= 5"), ("pi = 3 within 1", "pi = 3 within 0.1"),
                            ("rank = 2 where x = 0", "rank = 1 where x = 0")):
            for statement, verdict in ((true, "refuted"), (false, "proved")):
                self.write(PENDULUM.replace("claim 4: rank = 2\n", "").replace("claim 18: rank = 2 everywhere\n", "") + f"claim 0: {statement}\n")
                found = {"columns": ["column 1", "column 2"], "row_names": ["row 1", "row 2"], "states": RANKED["states"]} if "([" in statement else RANKED
                for kind, evidence in (("proved", {}), ("refuted", {"state": STATE}), ("claimed_rank", {"word": verdict}), ("claimed_rank", {}), ("rank", found),
                                       ("rank", {**found, "states": []}), ("refuted", {}), ("boxes", BOXED)):
                    entry = {**record(statement, kind, evidence), "verdict": verdict}
                    self.assertNotIn(self.answer(entry), SO[:2], (statement, verdict, kind))

    def test_identities(self):
        for entry in GOOD[:8]:
            # a condition that falls into parts is not solved here
            is_shown = "sin(phi) = 0" not in entry["statement"] and "rank" not in entry["statement"]
            word = "confirmed" if is_shown else "consistent"
            self.assertEqual(self.answer(entry), word, entry["statement"])
        self.assertEqual(self.word("L(f, f, phi) = k*sin(phi)", "proved"), "not confirmed")
        self.assertEqual(self.word("L(f, energy) = 1", "proved"), "not confirmed")
        # equal exponentials of two arguments are not told apart here, and that is no doubt
        self.assertEqual(self.word("L(f, f, x) = exp(2*x)", "proved"), "not checked")
        # a statement that stands in no file
        self.assertEqual(self.word("L(f, phi) = omega", "proved"), "not confirmed")

    def test_multiplied_out(self):
        """Equations that hold are shown, and none that fails somewhere, whatever its random points say."""
        for statement, is_shown in (
                ("(x + m)^3 = x^3 + 3*x^2*m + 3*x*m^2 + m^3", True), ("1/x - 1/(x + 1) = 1/(x*(x + 1))", True), ("(x^2 - m^2)/(x - m) = x + m", True),
                ("1/(1/x + 1/m) = x*m/(x + m)", True), ("tan(phi)*cos(phi) = sin(phi)", True), ("sin(3*phi) = 3*sin(phi) - 4*sin(phi)^3", True),
                ("sqrt(x)^2 = x", True), ("1/(1 + sqrt(x)) = (1 - sqrt(x))/(1 - x)", True), ("x^2 = m^2 where x + m = 0", True),
                ("omega = 1 where x = 1, omega - x = 0", True), ("(x + m)^2 = x^2 + m^2", False), ("sqrt(x^2) = x", False), ("sin(phi) = phi", False),
                ("x = 0 where x*m = 0", False), ("x = m where x^2 = m^2", False), ("phi = 0 where sin(phi) = 0", False), ("1/x = 1/m", False)):
            self.write(PENDULUM + f"claim 0: {statement}\n")
            word, why = check(self.bound(record(statement, "proved", {})), self.folder.name, {}, 1)
            self.assertEqual((word, why) == ("confirmed", "multiplied out"), is_shown, (statement, word, why))

    def test_fields_that_keep_a_system(self):
        """By hand: x, y grow and k, b fall by one factor, and no output changes; a cart's place and speed change with the time alone."""
        scaled = "system \"s\"\nstate x, y\nparam k, b unknown\ndrift f  x' = k*x*y  y' = -k*x*y\noutput b*x\n"
        turned = "system \"t\"\nstate x, y, theta\nangle theta\ndrift f  x' = cos(theta)  y' = sin(theta)  theta' = 0\noutput x^2 + y^2\n"
        for text, statement, is_shown in (
                (scaled, "rank = 3", True), (scaled, "unobservable(b, k, x, y)", True), (scaled, "observable(b*x, k/b)", True), (scaled, "observable(k)", False),
                (scaled, "rank = 2", False), (scaled, "unobservable(k/b)", False), (scaled, "unobservable(k, b*y)", False), (turned, "rank = 2", True),
                (turned, "unobservable(x, theta)", True), (turned, "observable(x^2 + y^2, x*cos(theta) + y*sin(theta))", True), (turned, "observable(x)", False)):
            self.write(text + f"claim 0: {statement}\n")
            word, why = check(self.bound(record(statement, "claimed_rank", {"word": "proved"})), self.folder.name, {}, 1)
            self.assertEqual((word, why) == ("confirmed", "by the fields that keep the system"), is_shown, (statement, word, why))

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
        self.assertEqual(self.word("rank = 2", "claimed_rank", word="proved"), "confirmed")
        self.assertEqual(self.word("rank = 3", "claimed_rank", word="proved"), "not confirmed")
        self.assertEqual(self.word("rank = 3", "claimed_rank", word="refuted"), "consistent")
        self.assertEqual(self.word("observable(omega, omega^2 + 3)", "claimed_rank", word="proved"), "confirmed")
        self.assertEqual(self.word("observable(omega, m)", "claimed_rank", word="proved"), "not confirmed")
        self.assertEqual(self.word("unobservable(x, m)", "claimed_rank", word="proved"), "confirmed")
        # that no other word adds to it is not shown at a state
        self.assertEqual(self.word("rank", "rank", **RANKED), "half confirmed")
        states = [{**RANKED["states"][0], "minor": {"rows": [0, 2], "columns": [0, 1]}}]
        self.assertEqual(self.word("rank", "rank", **{**RANKED, "states": states}), "not confirmed")

    def test_points(self):
        """What is confirmed at random points: with conditions that say what symbols are, and not where they say less, a function has branches, or a field leaves the set."""
        text = "system \"s\"\nstate x, y, z\nparam k\ndrift f  x' = y*z  y' = 0  z' = k*y\noutput x\n"
        for claim, word in (
            ("rank = 3", "confirmed"),
            ("rank = 2 where k = 0", "confirmed"),
            ("rank = 3 where k = 0", "not confirmed"),
            ("rank = 1 where y = 0", "not confirmed"),
            # no field leaves y = 0, and one leaves z = 0
            ("rank = 2 where y = 0, z = 1", "confirmed"),
            ("rank = 3 where z = 0", "confirmed"),
            # of an equation that has two solutions not all is given
            ("rank = 3 where z^2 = y^2", "not checked"),
            ("rank = 2 where y*z = y", "consistent"),
            ("observable(y*z) where k = 0", "confirmed"),
            ("unobservable(x)", "not confirmed"),
            ("rank([exp(x), 1; 1, exp(x)]) = 2", "confirmed"),
            ("rank([exp(x), 1; 1, exp(x)]) = 2 where x = 0", "consistent"),
            ("sin(x)^2 + cos(x)^2 = 1 where x = y*z", "confirmed"),
        ):
            self.write(text + f"claim 0: {claim}\n")
            self.assertEqual(self.word(claim, "claimed_rank", word="proved"), word, claim)

    def test_what_is_false_is_not_confirmed_by_what_is_lost(self):
        """Roots that cancel leave single states; pi is no unknown; an entry behind another one is read by the program; each state has a rate. All of these are false."""
        body = "state x, y\ndrift f  x' = 0  y' = 0\noutput x\n"
        for text, claim in (
            (body, "rank([1 - x, y]) = 1 where y = 0*sqrt(-(x^2 - x)^2)"),
            (body, "rank([1 - x + 0*sqrt(-(x^2 - x)^2)]) = 1"),
            (body, "rank([sin(x)]) = 1 where pi = x"),
            (body, "rank([y]) = 1 where x = 0/(y - 1), y = 1"),
            ("state x, y\nparam p\ndrift f  x' = 0  y' = 0\noutput (1 - p)*x\n", "rank = 1 where y = 0*sqrt(-(p^2 - p)^2)"),
            ("state x, y\ndrift f  x' = 0  y' = 0\nsample x in [0, 1] y in [0, 1] output y\noutput x\n", "rank = 1"),
            ("state x, y\ndrift f  x' = 0  y' = 0\noutput x : m output y : m\n", "rank = 1"),
            ("state x, y initial y known\ndrift f  x' = 0  y' = 0\noutput x, y\n", "rank = 2"),
            ("state x\ndrift f  x' = 0\nsample x in [0, 1] experiments 2\noutput x\n", "rank = 1"),
            ("state x, y\ndrift f  x' = 0  y' = 0\noutput x\nclaim first: x = x \"t\" output y\n", "rank = 1"),
            ("state x, line\ndrift f\n  x' = 0\n  line' = -x\noutput x\n", "L(f, line) = 0"),
            ("state x, set, z\ndrift f\n  x' = set\n  set' = z\n  z' = 0\noutput x\n", "rank = 2"),
        ):
            self.write(f"system \"s\"\n{text}claim 0: {claim}\n")
            kind = "proved" if claim.startswith("L(") else "claimed_rank"
            self.assertNotIn(self.word(claim, kind, word="proved"), ("confirmed", "half confirmed"), claim)

    def test_boxes(self):
        self.write(BOX)
        self.assertEqual(self.word("full rank", "boxes", **BOXED), "confirmed")
        # the minor of phi and Lf Lf phi is zero everywhere; boxes that overlap; one that lies outside; another volume
        first, second = BOXED["boxes"]
        for wrong, word in (({"boxes": [first, {**second, "rows": [0, 2]}]}, "not checked"),
                            ({"boxes": [first, {**second, "sides": [["9/10", "3"], ["-1", "1"]]}]}, "not confirmed"),
                            ({"boxes": [first, {**second, "sides": [["1", "3"], ["-1", "2"]]}]}, "not confirmed"),
                            ({"boxes": [first]}, "not confirmed"), ({"volume": "1/2"}, "not confirmed")):
            self.assertEqual(self.word("full rank", "boxes", **{**BOXED, **wrong}), word)

    def test_a_box_around_a_zero_is_not_shown(self):
        self.write('system "A square"\nstate x, y\ndrift f x\' = 0 y\' = 0\noutput x^3/3 + x*y, y\nclaim 1: x = x')
        box = {"columns": ["x", "y"], "row_names": ["x^3/3 + x*y", "y"], "volume": "1",
               "ranges": [{"symbol": "x", "low": "-1", "high": "2"}, {"symbol": "y", "low": "1/100", "high": "1"}],
               "boxes": [{"sides": [["-1", "2"], ["1/100", "1"]], "rows": [0, 1]}]}
        self.assertEqual(self.word("full rank", "boxes", **box), "confirmed")
        box["ranges"][1]["low"] = box["boxes"][0]["sides"][1][0] = "-1/100"
        self.assertEqual(self.word("full rank", "boxes", **box), "not checked")

    def test_a_box_in_which_an_output_has_no_value_is_not_shown(self):
        """The minor is one everywhere, and has lost the term that is missing at x = 0."""
        self.write("system \"s\"\nstate x, y\ndrift f  x' = 0  y' = 0\noutput x + 0/x, y\n")
        box = {"columns": ["x", "y"], "row_names": ["x + 0/x", "y"], "volume": "1",
               "ranges": [{"symbol": "x", "low": "1/9", "high": "2"}, {"symbol": "y", "low": "0", "high": "1"}],
               "boxes": [{"sides": [["1/9", "2"], ["0", "1"]], "rows": [0, 1]}]}
        self.assertEqual(self.word("full rank", "boxes", **box), "confirmed")
        box["ranges"][0]["low"] = box["boxes"][0]["sides"][0][0] = "-1"
        self.assertEqual(self.word("full rank", "boxes", **box), "not checked")

    def test_intervals_hold_what_they_enclose(self):
        pi = Map(enclosed)[symbol("pi")]
        machin = [[sum(Fraction((-1) ** k, (2 * k + 1) * x ** (2 * k + 1)) for k in range(n)) for n in (70, 71)] for x in (5, 239)]
        self.assertTrue(pi.low <= 16 * machin[0][0] - 4 * machin[1][1] + Fraction(1, 10**90))
        self.assertTrue(pi.high >= 16 * machin[0][1] - 4 * machin[1][0] - Fraction(1, 10**90))
        self.assertLess(pi.high - pi.low, Fraction(1, 10**70))
        for x in (Fraction(1, 3), Fraction(-7, 2), Fraction(9, 10), Fraction(40)):
            sine, cosine = image("sin", x), image("cos", x)
            square = sine * sine + cosine * cosine
            self.assertTrue(square.low <= 1 <= square.high and square.high - square.low < Fraction(1, 10**60))
            one = image("exp", x) * image("exp", -x)
            self.assertTrue(one.low <= 1 <= one.high and one.high - one.low < Fraction(1, 10**60))
            root = image("sqrt", abs(x))
            self.assertTrue((root * root).low <= abs(x) <= (root * root).high)
        wide = Map(enclosed, {symbol("x"): Interval(Fraction(1), Fraction(2))})[Node("sin", symbol("x"))]
        self.assertTrue(wide.low <= image("sin", Fraction(1)).low and wide.high >= 1)
        angle = {Node("sin", symbol("a")): Interval(Fraction(3, 5)), Node("cos", symbol("a")): Interval(Fraction(4, 5))}
        turned = Map(enclosed, angle)[call("sin", number(2) * (symbol("a") + symbol("pi") / number(4)))]
        self.assertEqual((turned.low, turned.high), (Fraction(7, 25), Fraction(7, 25)))

    def test_derivatives_are_those_by_hand(self):
        x, prime = symbol("x"), recheck.PRIMES[0]
        along = derivation(lambda name: number(name == "x"))
        for of, slope in ((x**3, number(3) * x**2), (call("sin", number(2) * x), number(2) * call("cos", number(2) * x)),
                          (call("sqrt", x), number("1/2") / call("sqrt", x)), (call("log", x * x), number(2) / x),
                          (call("atan", x), number(1) / (number(1) + x**2)), (number(1) / x, -(x**-2))):
            point = Modulo(prime, 4)
            point[x] = 25
            self.assertEqual(point[along[of] - slope], 0)
            self.assertEqual(point.gradient(of, ["x"]), [point[slope]])

    def test_what_python_reads_otherwise_is_refused(self):
        """Texts become Python's: chains, words side by side, attributes and Python's own words are no statements, and a power binds first."""
        (self.system,) = [proof_file.System(os.path.join(self.folder.name, "pendulum.proof"))]
        for text in ("0 <= x <= 1", "x x", "2 x", "x.real", "[x][0]", "x if x else x", "lambda: x", "x := 1", "().at", "(x, x)", "__import__(x)",
                     "x ** 2", "x // 2", "x % 2", "x @ x", "~x", "x | x", "'x'", "x and x", "x^omega", "x^(1/2)", "x at {2*x = 1}", "d(x, 2*x)", "a.b"):
            with self.assertRaises(Exception, msg=text):
                of = self.system.read(text)
                entries = [entry for value in of for row in value for entry in row]
                self.assertTrue(entries and all(isinstance(entry, graph.Expression) for entry in entries), text)
                self.assertEqual(len(of), 1)
        value = lambda text: self.system.read(text)[0][0][0]
        x, two = symbol("x"), number(2)
        for text, meant in (("-x^2", -(x**2)), ("2*x^-2", two * x**-2), ("2 - x - x", two - x - x), ("2/x/x", two / x / x), ("-x*x", -(x * x)),
                            ("2*x at {x = 3*x}", number(6) * x), ("x^2 + omega at {omega = 2}", x**2 + two), ("-x at {x = 2}", number(-2)),
                            ("0.1 + 2.50e-1", number("7/20")), ("x - -2", x + two), (".5*x", number("1/2") * x), ("2*(x + 1)", two * (x + number(1)))):
            point = Modulo(recheck.PRIMES[0], 5)
            self.assertEqual(point[value(text) - meant], 0, text)

    def test_half_an_angle_is_not_told(self):
        """A witness tells the sine and the cosine of an angle, from which those of its half do not follow."""
        self.write(PENDULUM + "claim 0: sin(phi/2) = 1\n")
        self.assertEqual(self.word("sin(phi/2) = 1", "refuted", state=STATE), "not checked")


class Mutants(Folder):
    """Each verdict is so; changed in one place, none is confirmed or consistent any more."""

    def test_what_is_right(self):
        for entry in GOOD:
            self.assertIn(self.answer(entry), SO, entry["statement"])

    def test_what_is_changed(self):
        def changed(entry, *path, to):
            """The record with one entry of its evidence replaced."""
            entry = json.loads(json.dumps(entry))
            inner = next(iter(entry["evidence"].values()))
            for key in path[:-1]:
                inner = inner[key]
            inner[path[-1]] = to
            return entry
        claims = [("L(f, energy) = 0", "L(f, energy) = 1"), ("L(f, f, phi) = -k*sin(phi)", "L(f, f, phi) = -2*k*sin(phi)"),
                  ("L(f, f, phi) = -k*sin(phi)", "L(f, f, phi) = -k*cos(phi)"), ("L(f, omega) = 0 where sin(phi) = 0", "L(f, omega) = 0 where cos(phi) = 0"),
                  ("sin(phi + pi/2) = cos(phi)", "sin(phi - pi/2) = cos(phi)"), ("sin(phi + pi/2) = cos(phi)", "sin(phi + pi/2) = sin(phi)"),
                  ("[m*k*sin(phi), m*omega]", "[m*k*sin(phi), -m*omega]"), ("[m*k*sin(phi), m*omega]", "[m*omega, m*k*sin(phi)]"),
                  ("d(L(f, phi), phi, omega)]) = 1", "d(L(f, phi), phi, omega)]) = -1"), ("x = k/omega - m", "x = k/omega + m"),
                  ("omega*(x + m) = k", "omega*(x + m) = k + 1"), ("rank = 2 everywhere", "rank = 3 everywhere"), ("rank = 2", "rank = 1"),
                  ("2*x, 2*m]) = 1", "2*x, 3*m]) = 1"), ("2*x, 2*m]) = 1", "2*x, 2*m]) = 2"), ("observable(omega, omega^2 + 3)", "observable(omega, x)"),
                  ("unobservable(x, m)", "unobservable(x, omega)"), ("unobservable(x, m)", "observable(x, m)")]
        mutants = 0
        for old, new in claims:
            # the claim is changed in the file and in the verdict alike
            for entry in (entry for entry in GOOD if old in entry["statement"] and "refuted" not in json.dumps(entry["evidence"])):
                self.write(PENDULUM.replace(": " + entry["statement"], ": " + entry["statement"].replace(old, new)))
                mutant = {**entry, "statement": entry["statement"].replace(old, new)}
                self.assertIn(self.answer(mutant), NOT_SO, mutant["statement"])
                mutants += 1
        self.write(PENDULUM)
        witness, low = GOOD[13], GOOD[15]
        ranked = GOOD[-1]
        for entry in (changed(GOOD[12], "word", to="proved"), {**GOOD[8], "verdict": "refuted"},
                      {**witness, "statement": "L(f, f, phi) = -k*sin(phi)"}, {**witness, "statement": "L(f, f, phi) = -k*cos(phi)"},
                      changed(witness, "state", "phi", to={"angle": {"sin": "0", "cos": "1"}}), changed(witness, "state", "k", to={"number": "0"}),
                      changed(witness, "state", "phi", to={"angle": {"sin": "3/5", "cos": "2/5"}}), changed(GOOD[14], "state", "x", to={"number": "1"}),
                      changed(low, "state", "x", to={"number": "0"}), changed(low, "state", "x", to={"number": "1/1000000"}),
                      changed(ranked, "states", 0, "rank", to=3), changed(ranked, "states", 0, "minor", "rows", to=[0, 2]),
                      changed(ranked, "states", 0, "minor", "rows", to=[0, 0]), changed(ranked, "states", 0, "minor", "columns", to=[0, 2]),
                      changed(ranked, "states", 0, "minor", "columns", to=[0, -3]), changed(ranked, "row_names", 1, to="Lf Lf phi"),
                      changed(ranked, "row_names", 1, to="omega"), changed(ranked, "columns", 1, to="x")):
            self.assertIn(self.answer(entry), NOT_SO, json.dumps(entry))
            mutants += 1
        self.write(BOX)
        boxed = record("full rank", "boxes", BOXED)
        self.assertEqual(self.answer(boxed), "confirmed")
        for entry in (changed(boxed, "boxes", 0, "rows", to=[0, 2]), changed(boxed, "boxes", 0, "rows", to=[1, 1]),
                      changed(boxed, "boxes", 0, "sides", 0, 1, to="3/2"), changed(boxed, "boxes", 0, "sides", 0, 0, to="0"),
                      changed(boxed, "boxes", 1, "sides", 0, 1, to="2"), changed(boxed, "volume", to="9/10"), changed(boxed, "row_names", 1, to="Lf Lf phi"),
                      changed(boxed, "boxes", to=[]), changed(boxed, "columns", to=["phi"])):
            self.assertIn(self.answer(entry), NOT_SO, json.dumps(entry))
            mutants += 1
        self.assertGreaterEqual(mutants, 43)

    def test_what_is_empty_or_filed_elsewhere(self):
        """The examples of the issue: a witness without values, no states, no boxes, no such kind, a part of another statement."""
        witness = GOOD[13]
        for entry in ({**witness, "evidence": {"refuted": {"state": {}}}}, {**witness, "evidence": {"refuted": {}}}, {**witness, "evidence": {"sworn": {}}},
                      {**witness, "evidence": {}}, {**witness, "statement": "phi) = k*sin(phi)"}, {**witness, "id": "2"}, {**witness, "digest": "0" * 16},
                      {**GOOD[-1], "evidence": {"rank": {**RANKED, "states": []}}}, {**GOOD[-1], "statement": "the rank is 7"},
                      {**witness, "verdict": "found"}, {**GOOD[0], "verdict": "refuted"}, {**GOOD[8], "asked": {**GOOD[8]["asked"], "claimed": "3"}}):
            self.assertIn(self.answer(entry), NOT_SO, json.dumps(entry))


class MutatedVerdicts(unittest.TestCase):
    """The mutants of `tests/claims/mutated_verdicts.rs`, which writes what may be said of each by hand-made rules."""

    def test_none_that_turned_false_is_confirmed(self):
        root = os.path.join(os.path.dirname(__file__), "..", "..")
        path = os.path.join(root, "target", "mutated_verdicts", "mutants.json")
        if not os.path.exists(path):
            self.skipTest("cargo test --test claims -- mutated_verdicts writes them")
        with open(path, encoding="utf-8") as file:
            mutants = json.load(file)
        systems, counts = {}, {}
        graph.Expression.left = graph.Expression.began = graph.RUN
        for mutant in mutants:
            word, why = check(mutant["record"], root, systems, 1)
            count = counts.setdefault(mutant["kind"], [0, 0, 0])
            count[0] += 1
            count[1] += not mutant["whole"]
            count[2] += word in ("confirmed", "half confirmed")
            wrong = word == "confirmed" and not mutant["whole"] or word == "half confirmed" and not mutant["half"]
            self.assertFalse(wrong, f"{mutant['kind']}: {word}, {why}\n{json.dumps(mutant['record'])}")
        for kind, count in sorted(counts.items()):
            print("|", kind, "|", " | ".join(map(str, count)), "|")
        self.assertGreater(sum(count[1] for count in counts.values()), 2000)


class Damage(Folder):
    """Whatever a file holds, there is an answer and an exit status, and no traceback."""

    def run_on(self, text):
        path, told = self.write(text, "verdicts.json"), io.StringIO()
        with contextlib.redirect_stdout(told), contextlib.redirect_stderr(told):
            status = recheck.main([path, "--proofs", self.folder.name])
        return status, told.getvalue()

    def test_verdict_files(self):
        whole = json.dumps({"schema": "palmistry-verdicts", "version": 4, "verdicts": [self.bound(entry) for entry in GOOD]})
        status, told = self.run_on(whole)
        self.assertEqual(status, 0, told)
        self.assertIn("13 confirmed, 1 half confirmed, 3 consistent", told)
        for text in ("", "[]", "{}", "nul", whole[:200], "[" * 100_000, whole.replace("palmistry-verdicts", "x"), whole.replace('"version": 4', '"version": 3'), '{"schema": 1}'):
            self.assertEqual(self.run_on(text)[0], 2)
        rng = random.Random(7)
        values = [None, 0, -1, 10**9, "", "1/0", "9" * 5000, [], {}, [[]], True, 1.5, "x'" * 50]
        for _ in range(150):
            entry = json.loads(json.dumps(self.bound(rng.choice(GOOD))))
            inner = entry
            while isinstance(inner, (dict, list)) and len(inner):
                key = rng.choice(list(inner)) if isinstance(inner, dict) else rng.randrange(len(inner))
                if rng.random() < 0.3 or not isinstance(inner[key], (dict, list)):
                    inner[key] = rng.choice(values)
                    break
                inner = inner[key]
            self.assertIn(self.run_on(json.dumps({"schema": "palmistry-verdicts", "version": 4, "verdicts": [entry]}))[0], (0, 1, 2))

    def test_proof_files(self):
        rng = random.Random(8)
        texts = [PENDULUM.replace("k*sin(phi)", text) for text in (
            "(" * 5000 + "x" + ")" * 5000, "2^" * 300 + "2", "x^1e99", "x^999999999999", "((((x^9999)^9999)^9999)^9999)", "exp(exp(exp(99)))", "1e999*x",
            "9" * 6000, "[1, 2; 3]", "det([x])", "inverse([0, 0; 0, 0])", "-" * 4000 + "x", "min(x)", "L(f)", "d()", "energy.energy", "sqrt(-1)", "1/0")]
        texts += [PENDULUM.replace("cos(phi)\n", "energy\n"), 'use p = "pendulum.proof"\n' + PENDULUM, "\0" + PENDULUM, ""]
        texts += [PENDULUM[:rng.randrange(len(PENDULUM))] for _ in range(20)]
        for _ in range(30):
            letters = list(PENDULUM)
            for _ in range(3):
                letters[rng.randrange(len(letters))] = rng.choice("()[]{}^*/=;,'\"#.1x\0")
            texts.append("".join(letters))
        for text in texts:
            self.write(text)
            for entry in (GOOD[1], GOOD[8], GOOD[13]):
                self.answer(entry)
        with open(os.path.join(self.folder.name, "pendulum.proof"), "wb") as file:
            file.write(bytes(rng.randrange(256) for _ in range(500)))
        self.assertEqual(self.answer(GOOD[0]), "not checked")
        self.assertEqual(self.answer({**GOOD[0], "file": "nowhere.proof"}), "not checked")

    def test_work_is_bounded(self):
        """By a count that is the same on every machine: what takes more is given up, and says so."""
        most, graph.WORK = graph.WORK, 30_000
        self.addCleanup(setattr, graph, "WORK", most)
        long = "L(" + "f, " * 100 + "exp(phi*x*omega)) = 0"
        self.write(PENDULUM + f"claim 0: {long}\n")
        for entry, word, told in ((record(long, "proved", {}), "not checked", "too much work: more than 30000 nodes"), (GOOD[0], "confirmed", "multiplied out")):
            found = check(self.bound(entry), self.folder.name, {}, 1)
            self.assertEqual(found[0], word)
            self.assertIn(told, found[1])

    def test_files_that_mean_harm(self):
        """Numbers, names and files that end in time, with a word and without a traceback or a forged line."""
        begin = time.monotonic()
        witness = self.bound(GOOD[13])
        for value in ({"number": "1e10000000"}, {"number": "9" * 10_000_000}, {"number": "1/" + "7" * 3999}, {"number": "\ud800"}):
            entry = {**witness, "evidence": {"refuted": {"state": {**STATE, "x": value}}}}
            self.assertIn(self.answer(entry), SO + NOT_SO)
        size = 22
        names = ", ".join(f"a{i}_{j}" for i in range(size) for j in range(size))
        matrix = "; ".join(", ".join(f"a{i}_{j}" for j in range(size)) for i in range(size))
        self.write(f"system \"s\"\nstate x\nparam {names}\nlet A = [{matrix}]\nclaim 1: det(A) = 0\n")
        self.assertEqual(check(self.bound(record("det(A) = 0", "proved", {})), self.folder.name, {}, 1)[0], "not checked")
        self.write("\n" * 100_000 + PENDULUM)
        self.assertEqual(self.answer(GOOD[0]), "confirmed")
        self.write(PENDULUM)
        os.mkfifo(os.path.join(self.folder.name, "pipe.proof"))
        for name in ("pipe.proof", "/dev/zero", "."):
            self.assertEqual(check({**witness, "file": name}, self.folder.name, {}, 1)[0], "not checked")
        for path in (os.path.join(self.folder.name, "pipe.proof"), "/dev/zero"):
            with contextlib.redirect_stderr(io.StringIO()):
                self.assertEqual(recheck.main([path]), 2)
        forged = {**witness, "id": "1\nconfirmed     pendulum.proof 1: \ud800\u001b[2J\u202e", "file": "x\rconfirmed"}
        status, told = self.run_on(json.dumps({"schema": "palmistry-verdicts", "version": 4, "verdicts": [forged]}))
        self.assertEqual(len(told.splitlines()), 2, told)
        self.assertTrue(told.startswith("not checked") and told.isascii() and "\x1b" not in told, told)
        self.assertLess(time.monotonic() - begin, 60)

    def test_files_that_grow_in_the_checker(self):
        """What is short in a file and long behind it: doublings, powers, blanks, words, imports. Each of these ran for hours, or into all memory."""
        begin, claim = time.monotonic(), "\nclaim 0: {}\n"
        double = lambda first, more: PENDULUM + f"let s0 = {first}\n" + "".join(f"let s{i + 1} = {more.replace('s', f's{i}')}\n" for i in range(60))
        for text, statement in (
                (double("x", "s + s"), "sin(s60) = 0"), (double("[x]", "[s, s; s, s]"), "s60 = s60"), (double("9", "s^99"), "s60 = x"),
                (PENDULUM.replace("-k*sin(phi)", "a" * 200_000, 1), "x = x"), (PENDULUM + "erratum 0: printed" + " " * 20_000 + "x\n", "x = x"),
                (PENDULUM + "".join(f"param p{i}\n" for i in range(50_000)), "x = x"), (PENDULUM, "x + " * 300_000 + "x = x")):
            self.write(text + claim.format(statement))
            # what is equal to itself is so however long it is
            is_short = statement in ("x = x", "s60 = s60")
            self.assertIn(self.word(statement, "proved"), ("consistent", *NOT_SO, *["confirmed"] * is_short))
        for level in range(8):
            uses = "".join(f'use a{i} = "{level + 1}.proof"\n' for i in range(12 * (level < 7)))
            self.write(uses + PENDULUM, f"{level}.proof")
        self.assertEqual(self.answer({**GOOD[0], "file": "0.proof"}), "not checked")
        self.assertLess(time.monotonic() - begin, 60)

    def test_one_budget_for_a_file(self):
        """Each record draws from it, whatever it is; behind its end nothing is checked, and nothing hangs."""
        most, recheck.RUN = recheck.RUN, 20_000
        self.addCleanup(setattr, recheck, "RUN", most)
        entry = {**self.bound(GOOD[0]), "evidence": {"proved": {}}}
        status, told = self.run_on(json.dumps({"schema": "palmistry-verdicts", "version": 4, "verdicts": [entry] * 1000}))
        self.assertEqual((status, told.count("the budget of work is spent") > 800, "multiplied out" in told), (0, True, True), told[-200:])
        box = {**BOXED, "boxes": [BOXED["boxes"][0]] * 100_000}
        self.write(BOX)
        self.assertIn(self.word("full rank", "boxes", **box), NOT_SO)

    def test_numbers_and_keys(self):
        """What two readers of JSON may read as two things is no verdict file; a count is a whole number."""
        whole = json.dumps({"schema": "palmistry-verdicts", "version": 4, "verdicts": [self.bound(GOOD[0])]})
        self.assertEqual(self.run_on(whole)[0], 0)
        for number_ in ("NaN", "Infinity", "-Infinity", "1e999", "-1e999", "9" * 1_000_000, "0." + "9" * 1_000_000):
            self.assertEqual(self.run_on(whole[:-1] + f', "seed": {number_}}}')[0], 2, number_[:9])
        for old, new in (('"version": 4', '"version": 4.0'), ('"version": 4', '"version": 4, "version": 4'), ('"id": "1"', '"id": "2", "id": "1"')):
            self.assertIn(old, whole)
            self.assertEqual(self.run_on(whole.replace(old, new))[0], 2, new)
        self.assertEqual(self.run_on("[" + "[]," * 5_000_000 + "[]]")[0], 2)
        for rank in (2.0, "2", None):
            self.assertIn(self.word("rank", "rank", **{**RANKED, "states": [{**RANKED["states"][0], "rank": rank}]}), NOT_SO, rank)
        one = {**RANKED["states"][0], "rank": True, "minor": {"rows": [0], "columns": [0]}}
        self.assertIn(self.word("rank", "rank", **{**RANKED, "states": [one]}), NOT_SO)

    @built
    def test_names_and_assumptions(self):
        """Greek letters are names here as they are to the program, and a claim is made under what its file assumes."""
        head = 'system "s"\nstate \u03c6, \u03c9\nparam m, k\nangle phi\n'
        rest = "drift f\n  \u03c6' = omega\n  omega' = -k/m*sin(phi)\noutput \u03c6\n"
        claims = "claim a: L(f, \u03c6) = \u03c9\nclaim b: rank = 2\nclaim c expect refuted: k/m < 0\nclaim d: observable(\u03c6, \u03c9)\n"
        with tempfile.TemporaryDirectory() as folder:
            file, verdicts = os.path.join(folder, "s.proof"), os.path.join(folder, "v.json")
            for assumed, confirmed in (("assume m > 0, k > 0\n", True), ("", False)):
                with open(file, "w", encoding="utf-8") as proof:
                    proof.write(head + assumed + rest + claims)
                if confirmed:
                    subprocess.run([PROGRAM, "prove", file, "--verdicts", verdicts, "-q"], check=True, capture_output=True)
                out = io.StringIO()
                with contextlib.redirect_stdout(out):
                    status = recheck.main([verdicts])
                self.assertEqual((status, out.getvalue().count("not checked") > 3), (0, not confirmed), out.getvalue())
            self.assertIn("another one than when", out.getvalue())

    def test_size(self):
        """It is meant to be read in one sitting."""
        lines = 0
        for module in ("recheck", "bounds", "proof_parser", "proof_file", "graph", "multiplied"):
            with open(os.path.join(os.path.dirname(recheck.__file__), module + ".py"), encoding="utf-8") as file:
                lines += sum(1 for _ in file)
        self.assertLessEqual(lines, 1650)


if __name__ == "__main__":
    unittest.main()
