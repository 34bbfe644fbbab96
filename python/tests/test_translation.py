"""Systems from SymPy and CasADi. Oracle: the other program's own evaluation at random points, of every rate and every output."""

import math
import random
import unittest

import palmistry
from palmistry.errors import Error

try:
    import sympy
except ImportError:
    sympy = None
try:
    import casadi
except ImportError:
    casadi = None


def rates_and_outputs(system):
    """Expressions of the language whose values are those of all rates and outputs."""
    rates = [f"L({field}, {state})" for field in system.fields for state in system.states]
    return [*rates, *system.outputs]


@unittest.skipUnless(sympy, "SymPy is not installed: pip install 'palmistry[sympy]'")
class FromSymPy(unittest.TestCase):
    def compare(self, text, symbols, expressions, positive=(), points=5):
        """What the file says and what SymPy says, to 25 digits, at rational points. `symbols`: our name of each symbol."""
        system = palmistry.System.parse(text)
        asked = rates_and_outputs(system)
        self.assertEqual(len(asked), len(expressions), text)
        drawn = random.Random(2)
        for _ in range(points):
            values = {s: sympy.Rational(drawn.randint(1, 40) if s in positive else drawn.randint(-40, 40) or 3, 29) for s in symbols}
            at = {ours: str(values[s]) for s, ours in symbols.items()}
            for mine, theirs in zip(asked, expressions):
                expected = sympy.N(sympy.sympify(theirs).subs(values), 40)
                found = sympy.Float(str(system.eval(mine, at, 30)), 40)
                self.assertLessEqual(abs(found - expected), abs(expected) * sympy.Float("1e-25"), f"{mine} = {theirs} in\n{text}")

    def test_a_pendulum(self):
        phi, omega, k, c = sympy.symbols("phi omega k c")
        rates = [omega, -k * sympy.sin(phi) - c * omega / 3]
        text = palmistry.from_sympy(
            [phi, omega], rates, [phi], parameters={k: 2}, unknown=[c], angles=[phi], sample={phi: (-3, 3), omega: (-2, 2)},
            claims={"motion": "L(f, f, phi) = -k*sin(phi) - c*omega/3"}, title='A "pendulum"',
        )  # fmt: skip
        system = palmistry.System.parse(text)
        self.assertEqual((system.title, system.states[:2], system.fields), ("A 'pendulum'", ["phi", "omega"], {"f": "drift"}))
        self.assertTrue(system.prove().ok)
        self.assertEqual(system.rank(samples=200).histogram, {3: 200})

    def test_every_form(self):
        x, y, z, a, b = sympy.symbols("x y z a b")
        half, third = sympy.Rational(1, 2), sympy.Rational(1, 3)
        tenth = sympy.Float(0.1)
        rates = [
            -(x - y) * (-3) / (x * y**2) + (x + y) ** 3 - (-x) ** 2 - 2 * (-x - y),
            sympy.sqrt(y) + y**third + y ** (-half) + y**-3 + 2**x + x / 7 - tenth * y + sympy.pi * sympy.E,
            sympy.exp(-x / 2) / (1 + sympy.exp(x)) * sympy.log(y) + sympy.tanh(x) - sympy.sinh(x) * sympy.cosh(y),
        ]
        outputs = [
            sympy.atan2(x, y) + sympy.asin(y / 3) - sympy.acos(y / 3) + sympy.atan(x) / sympy.cot(y) + sympy.sec(x) * sympy.csc(y),
            sympy.asinh(x) + sympy.acosh(y + 2) + sympy.atanh(y / 3) + sympy.sech(x) - sympy.coth(y) + sympy.csch(y) + sympy.acot(y),
            abs(x) + sympy.sign(x) + sympy.Min(x, y) - sympy.Max(x, y, z / 2) + a * b * z,
            (x - a * (y - b * (z - 1))) / (a / b / y) - (-1) ** 3 * x,
            sympy.Add(x, sympy.Mul(-1, x - y, evaluate=False), evaluate=False),
        ]
        text = palmistry.from_sympy([x, y, z], rates, outputs)
        names = {s: s.name for s in (x, y, z, a, b)}
        # a Float is the decimal that is printed
        expected = [sympy.sympify(e).subs(tenth, sympy.Rational(1, 10)) for e in [*rates, *outputs]]
        self.compare(text, names, expected, positive=[y])

    def test_random_expressions(self):
        drawn = random.Random(11)
        x, y, k = sympy.symbols("x y k", positive=True)

        def grown(depth):
            if depth == 0:
                return drawn.choice([x, y, k, sympy.Integer(drawn.randint(-3, 3)), sympy.Rational(drawn.randint(-5, 5), 6)])
            one, other = grown(depth - 1), grown(depth - 1)
            make = drawn.randint(0, 7)
            with sympy.evaluate(drawn.random() < 0.7):
                return [
                    lambda: one + other, lambda: one - other, lambda: one * other, lambda: -one, lambda: one / (other**2 + 2),
                    lambda: (one + 1) ** drawn.randint(2, 3), lambda: sympy.sin(one) * other, lambda: sympy.exp(-(one**2)),
                ][make]()  # fmt: skip

        for _ in range(40):
            rates = [grown(4), grown(3)]
            text = palmistry.from_sympy([x, y], rates, [grown(3)])
            system = palmistry.System.parse(text)
            shown = [*rates, None]
            at = {"x": "3/7", "y": "5/4", "k": "2/3"}
            values = {x: sympy.Rational(3, 7), y: sympy.Rational(5, 4), k: sympy.Rational(2, 3)}
            for mine, theirs in zip(rates_and_outputs(system), shown):
                if theirs is None:
                    continue
                known = {name: at[name] for name in at if name in system.states + system.parameters}
                expected = sympy.N(sympy.sympify(theirs).doit().subs(values), 40)
                found = system.eval(mine, known, 30)
                self.assertLessEqual(abs(sympy.Float(str(found), 40) - expected), sympy.Float("1e-24") * (1 + abs(expected)), text)

    def test_fields_and_names(self):
        t = sympy.Symbol("t")
        theta, rank, x1 = sympy.Function("θ")(t), sympy.Symbol("rank"), sympy.Symbol("x_{1}")
        u = sympy.Symbol("u")
        fields = {"drift": {rank: u**2 * x1}, "drive": sympy.Matrix([sympy.cos(theta), sympy.sin(theta), 1])}
        text = palmistry.from_sympy([rank, x1, theta], fields, {"q": rank**2, "rank": rank}, drift="drift", known=[u], angles=[theta])
        system = palmistry.System.parse(text)
        self.assertEqual(list(system.fields.values())[:2], ["drift", "input"])
        # the names of the language, in the order in which the system has them
        ours = dict(zip((rank, x1, theta, u), [*system.states[:3], "u"]))
        self.assertEqual(ours[theta], "theta")
        self.assertNotIn("rank", system.states)
        at = {ours[rank]: 2, ours[x1]: 3, ours[theta]: "1/2", "u": 5}
        drift, drive = list(system.fields)[:2]
        self.assertEqual(float(system.eval(f"L({drift}, {ours[rank]})", at)), 75.0)
        self.assertAlmostEqual(float(system.eval(f"L({drive}, {ours[x1]})", at)), math.sin(0.5), places=15)
        self.assertEqual(float(system.eval(system.outputs[0], at)), 4.0)

    def test_only_inputs(self):
        x, y, theta = sympy.symbols("x y theta")
        fields = {"drive": [sympy.cos(theta), sympy.sin(theta), 0], "turn": {theta: 1}}
        with self.assertRaisesRegex(Error, "no field 'f' to be the drift"):
            palmistry.from_sympy([x, y, theta], fields, [x])
        text = palmistry.from_sympy([x, y, theta], fields, [(x**2 + y**2) / 2], drift=None, angles=[theta], sample={y: (1, 2)})
        self.assertEqual(palmistry.System.parse(text).rank(samples=100).histogram, {2: 100})

    def test_what_has_no_counterpart(self):
        x, y = sympy.symbols("x y")
        t = sympy.Symbol("t")
        z = sympy.Function("z")(t)
        for rates, words in [
            ([sympy.Heaviside(x)], "Heaviside"),
            ([sympy.Piecewise((x, x > 0), (0, True))], "Piecewise"),
            ([sympy.I * x], "ImaginaryUnit"),
            ([sympy.oo], "Infinity"),
            ([sympy.Integral(x, x)], "Integral"),
            ([x, y], "2 rates"),
            ([sympy.Symbol("x", positive=True)], "two symbols are called 'x'"),
            ([z.diff(t)], "Derivative"),
        ]:
            with self.assertRaises(Error) as raised:
                palmistry.from_sympy([x], rates, [x])
            self.assertIn(words, str(raised.exception))
        for wrong in (lambda: palmistry.from_sympy([], [], [x]), lambda: palmistry.from_sympy([x], [x], []), lambda: palmistry.from_sympy([x, x], [x, x], [x])):
            self.assertRaises(Error, wrong)
        with self.assertRaisesRegex(Error, "no symbol of the system"):
            palmistry.from_sympy([x], [x], [x], angles=[y])
        with self.assertRaisesRegex(Error, "is a state"):
            palmistry.from_sympy([x], [x], [x], known=[x])


@unittest.skipUnless(casadi, "CasADi is not installed: pip install 'palmistry[casadi]'")
class FromCasADi(unittest.TestCase):
    def compare(self, text, names, symbols, expressions, points=5):
        """What the file says and what CasADi says, to 12 digits, at points of doubles."""
        system = palmistry.System.parse(text)
        asked = rates_and_outputs(system)
        theirs = casadi.Function("all", symbols, [casadi.vertcat(*expressions)])
        drawn = random.Random(5)
        for _ in range(points):
            values = [drawn.uniform(0.1, 2) for _ in names]
            at, sizes = dict(zip(names, values)), iter(values)
            arguments = [casadi.DM([next(sizes) for _ in range(symbol.numel())]) for symbol in symbols]
            expected = numbers = [float(v) for v in theirs(*arguments).elements()]
            self.assertEqual(len(expected), len(asked), text)
            for mine, number in zip(asked, numbers):
                found = float(system.eval(mine, at, 17))
                self.assertLessEqual(abs(found - number), 1e-12 * (1 + abs(number)), f"{mine} in\n{text}")

    def test_every_operation(self):
        x, k = casadi.SX.sym("x", 3), casadi.SX.sym("k")
        a, b, c = x[0], x[1], x[2]
        shared = casadi.tanh(a * b)
        rates = [
            -(a - b) / (a - (b - c)) - (-c) * 2 + casadi.sqrt(a) + a**2 + a**3.5 + a**b + 1 / a,
            shared**2 * casadi.sin(a) - shared + casadi.cos(b) * casadi.tan(c) / k,
            casadi.exp(-a) * casadi.log(b) + casadi.log1p(a) - casadi.expm1(b) + casadi.hypot(a, b),
        ]
        outputs = [
            casadi.asin(a / 3) + casadi.acos(b / 3) * casadi.atan(c) - casadi.atan2(a, b),
            casadi.sinh(a) - casadi.cosh(b) + casadi.asinh(c) + casadi.acosh(a + 2) + casadi.atanh(b / 3),
            casadi.fabs(a - b) + casadi.sign(a - c) - casadi.fmin(a, b) * casadi.fmax(b, c),
            casadi.mtimes(casadi.SX([[1, 2, 3]]), x) / 7,
        ]
        text = palmistry.from_casadi(x, casadi.vertcat(*rates), casadi.vertcat(*outputs))
        self.assertIn("let w1 = ", text)
        self.compare(text, ["x_0", "x_1", "x_2", "k"], [x, k], [*rates, *outputs])

    def test_matrices_of_symbols(self):
        x, p = casadi.MX.sym("x", 2), casadi.MX.sym("p")
        fields = {"f": casadi.vertcat(x[1], -p * casadi.sin(x[0])), "push": [0, 1]}
        text = palmistry.from_casadi(x, fields, {"r": casadi.norm_2(x), "angle": x[0]}, parameters={"p": 0.1}, sample={"x_0": (-1, 1)})
        system = palmistry.System.parse(text)
        self.assertEqual(list(system.fields.values()), ["drift", "input"])
        self.assertEqual(str(system.eval("p")), str(system.eval("1/10")))
        expressions = [x[1], -p * casadi.sin(x[0]), casadi.MX(0), casadi.MX(1), casadi.norm_2(x), x[0]]
        self.compare(text, ["x_0", "x_1", "p"], [x, p], expressions)

    def test_rates_by_state(self):
        a, b, u = casadi.SX.sym("a"), casadi.SX.sym("b"), casadi.SX.sym("u")
        text = palmistry.from_casadi([a, b], {b: -a + u**2}, [a * b], known=[u])
        system = palmistry.System.parse(text)
        self.assertEqual(float(system.eval("L(f, b)", at={"a": 2, "b": 1, "u": 3})), 7.0)
        self.assertEqual(float(system.eval("L(f, a)", at={"a": 2, "b": 1, "u": 3})), 0.0)

    def test_what_has_no_counterpart(self):
        x = casadi.SX.sym("x")
        for rate, words in [(casadi.floor(x), "floor"), (casadi.if_else(x > 0, x, 0), "counterpart"), (casadi.erf(x), "erf")]:
            with self.assertRaises(Error) as raised:
                palmistry.from_casadi(x, rate, x)
            self.assertIn(words, str(raised.exception))
        with self.assertRaises(Error):
            palmistry.from_casadi(x, casadi.vertcat(x, x), x)
        with self.assertRaises(Error):
            palmistry.from_casadi(x * 2, x, x)


if __name__ == "__main__":
    unittest.main()
