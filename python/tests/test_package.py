"""Questions beside ranks and claims, functions as systems, measurements at hand, streams. Oracles: the program's own JSON, equations written down by hand, and what was simulated by other code."""

import json
import os
import signal
import subprocess
import tempfile
import threading
import time
import unittest

import numpy
from common import PROGRAM, ROOT, built

import palmistry
from palmistry.errors import Error, ReadError

SYSTEMS = os.path.join(ROOT, "examples", "systems")


def program(*words, data=None):
    done = subprocess.run([PROGRAM, *words, "--json"], capture_output=True, text=True, check=False, input=data)
    return json.loads(done.stdout)


def timeless(value):
    if isinstance(value, dict):
        return {key: timeless(entry) for key, entry in value.items() if key not in ("seconds", "rows")}
    return [timeless(entry) for entry in value] if isinstance(value, list) else value


def pendulum(states, steps=10, step=0.005):
    """A pendulum with friction, k = 2 and c = 0.1, by Runge and Kutta's rule: samples every `steps` steps."""

    def rate(x):
        return numpy.array([x[1], -2 * numpy.sin(x[0]) - 0.1 * x[1]])

    path = [numpy.array([1.0, 0.0])]
    for _ in range(states - 1):
        x = path[-1]
        for _ in range(steps):
            a = rate(x)
            b = rate(x + step / 2 * a)
            c = rate(x + step / 2 * b)
            d = rate(x + step * c)
            x = x + step / 6 * (a + 2 * b + 2 * c + d)
        path.append(x)
    return numpy.arange(states) * steps * step, numpy.array(path)


def pendulum_system():
    def f(x, p):
        return [x.omega, -p.k * numpy.sin(x.phi) - p.c * x.omega]

    sample = {"phi": (-3, 3), "omega": (-2, 2), "k": (1, 4), "c": (0, 1)}
    return palmistry.System.from_function(f, lambda x: x.phi, states="phi, omega", parameters="k, c", unknown="k, c", angles="phi", sample=sample)


def without_directions(found):
    """What the command adds to an answer: in the package these are methods of their own."""
    return {name: value for name, value in found.items() if name not in ("singular_set", "unobservable_directions")}


@built
class TheProgram(unittest.TestCase):
    """The same objects as the program's."""

    def test_questions(self):
        for name in ("proofs/benchmarks/siwr.proof", "examples/systems/lorenz.proof", "proofs/benchmarks/car.proof"):
            file = os.path.join(ROOT, name)
            system = palmistry.System.read(file)
            if "siwr" not in name:
                self.assertEqual(timeless(system.global_().json), timeless(without_directions(program("rank", file, "--global"))), name)
                self.assertEqual(timeless(system.singular_set().json), timeless(program("rank", file, "--singular-set")), name)
            self.assertEqual(timeless(system.accessible(50).json), timeless(program("rank", file, "--accessible", "--samples", "50")), name)

    def test_a_page_of_the_singular_set(self):
        found = palmistry.System.read(os.path.join(ROOT, "proofs/benchmarks/car.proof")).singular_set()
        self.assertIn("<html", found.page.html)
        self.assertIn("generic rank", found.text)

    def test_scenes_of_every_kind(self):
        scenes = os.path.join(ROOT, "proofs", "moll2002", "scenes")
        for name in ("slow_spline.toml", "figure_5_3.toml", "touchpad_switch.toml", "same_rate.toml"):
            file = os.path.join(scenes, name)
            found = palmistry.observe(file, times=False)
            self.assertEqual(timeless(found.json), timeless(program("observe", file, "--no-times")), name)
            self.assertGreater(found.measurements.rows, 1)
            if name == "touchpad_switch.toml":
                with self.assertRaisesRegex(Error, "no page"):
                    found.page
            else:
                self.assertIn("<html", found.page.html)

    def test_imports(self):
        text = "x1' = -p1*x1 + p2*x2\nx2' = p3*x1 - p2*x2\n"
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "model.txt")
            with open(file, "w", encoding="utf-8") as written:
                written.write(text)
            words = ["import", file, "--from", "formulas", "--output", "x1", "--unknown", "p1,p2"]
            system = palmistry.import_model(file, format="formulas", outputs="x1", unknown=["p1", "p2"])
            self.assertEqual(system.source, program(*words)["proof"])
            self.assertEqual(system.unknowns, ["x1", "x2", "p1", "p2"])
            with self.assertRaisesRegex(Error, "no format"):
                palmistry.import_model(file, format="fortran")

    def test_verdicts_are_checked(self):
        file = os.path.join(ROOT, "proofs/benchmarks/car.proof")
        claims = palmistry.System.read(file).prove(evidence=True)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "verdicts.json")
            with open(path, "w", encoding="utf-8") as written:
                written.write(claims.evidence)
            checked = palmistry.recheck_file(path, proofs="/")
            self.assertEqual(checked.json, program("recheck", path, "--proofs", "/"))
        self.assertEqual(checked.json, claims.recheck(proofs="/").json)
        self.assertTrue(checked.ok)
        with self.assertRaisesRegex(Error, "evidence=True"):
            palmistry.System.read(file).prove().evidence
        self.assertGreaterEqual(checked.table.rows, len(claims))
        with self.assertRaises(Error):
            palmistry.recheck_file(__file__)
        with self.assertRaisesRegex(Error, "nowhere.json"):
            palmistry.recheck_file("nowhere.json")
        with tempfile.NamedTemporaryFile(suffix=".jl") as file:
            file.write(b"\xff\xfe@ODEmodel")
            file.flush()
            with self.assertRaisesRegex(Error, "cannot read"):
                palmistry.import_model(file.name)

    def test_a_reparametrised_system(self):
        with tempfile.TemporaryDirectory() as folder:
            file, out = os.path.join(folder, "two.proof"), os.path.join(folder, "out", "reduced.proof")
            os.mkdir(os.path.dirname(out))
            with open(file, "w", encoding="utf-8") as written:
                written.write("system \"Two rates\"\nstate x\nparam a unknown, b unknown\ndrift f\n  x' = -a*b*x\noutput x\n")
            system = palmistry.System.read(file)
            reduced = system.reparametrise(out)
            self.assertTrue(reduced.prove().ok)
            self.assertEqual(len(palmistry.System.read(out).prove()), len(reduced.claims))
            with self.assertRaisesRegex(Error, "observable already"):
                palmistry.System.read(os.path.join(SYSTEMS, "lorenz.proof")).reparametrise()
        with self.assertRaisesRegex(Error, "is no file"):
            pendulum_system().reparametrise()

    def test_other_commands(self):
        file = os.path.join(SYSTEMS, "van_der_pol.proof")
        self.assertEqual(palmistry.run("check", file).json, program("check", file))
        self.assertTrue(palmistry.run("trade", file, samples=20).ok)
        with self.assertRaisesRegex(Error, "there is no folder or file nowhere.proof"):
            palmistry.run("prove", "nowhere.proof")
        with self.assertRaises(Error):
            palmistry.run("trade", file, no_such_option=1)

    def test_streams(self):
        scene = os.path.join(SYSTEMS, "van_der_pol.toml")
        with tempfile.TemporaryDirectory() as folder:
            record = os.path.join(folder, "record.csv")
            subprocess.run([PROGRAM, "observe", scene, "--record", record], capture_output=True, check=True)
            with open(record, encoding="utf-8") as file:
                lines = file.readlines()
            short = os.path.join(folder, "scene.toml")
            with open(scene, encoding="utf-8") as file:
                text = file.read().replace('"van_der_pol.proof"', json.dumps(os.path.join(SYSTEMS, "van_der_pol.proof"))).replace("window = 160", "window = 40")
            with open(short, "w", encoding="utf-8") as file:
                file.write(text)
            done = subprocess.run([PROGRAM, "observe", short, "--data", "-", "--json"], input="".join(lines), capture_output=True, text=True, check=False)
            expected = [timeless(json.loads(line)) for line in done.stdout.splitlines()]
            self.assertGreater(len(expected), 3)
            self.assertEqual([timeless(one) for one in palmistry.stream(short, lines)], expected)
            names = lines[0].strip().split(",")
            rows = [dict(zip(names, map(float, line.split(",")))) for line in lines[1:]]
            self.assertEqual([timeless(one) for one in palmistry.stream(short, iter(rows))], expected)
            # an answer is there before the end
            arriving = palmistry.stream(short, self.slowly(lines))
            self.assertEqual(timeless(next(arriving)), expected[0])
            self.assertLess(self.given, len(lines))
            arriving.close()
            with self.assertRaises(ReadError):
                list(palmistry.stream(short, ["time,u\n", "0,1\n"]))
            for pieces, said in (([5], "no int"), ([rows[0], {"time": 1}], "a row has no")):
                with self.assertRaisesRegex(Error, said):
                    list(palmistry.stream(short, pieces))

    def slowly(self, lines):
        for self.given, line in enumerate(lines, 1):
            yield line
            time.sleep(0.02)


@built
class Functions(unittest.TestCase):
    def test_what_is_written_is_what_is_calculated(self):
        import math

        def f(x, p, u):
            a, b = x
            return {"a": (a + 2 * b) ** 2 / (1 + p["k"]) - a * -b + u.w, "b": numpy.exp(-a) * numpy.sqrt(b) - 3 / b + b**-2 + abs(a - b) - 0.5 * (b - a)}

        system = palmistry.System.from_function(f, lambda x, p: {"y": x[0] * p.k, "z": numpy.tanh(x[1])}, states=["a", "b"], parameters={"k": 2}, inputs="w")
        at = {"a": "0.3", "b": "0.7", "k": 2, "w": "0.11"}
        a, b, k, w = 0.3, 0.7, 2, 0.11
        self.assertAlmostEqual(float(system.eval("L(f, a)", at=at)), (a + 2 * b) ** 2 / (1 + k) + a * b + w, 14)
        expected = math.exp(-a) * math.sqrt(b) - 3 / b + b**-2 + abs(a - b) - 0.5 * (b - a)
        self.assertAlmostEqual(float(system.eval("L(f, b)", at=at)), expected, 14)
        self.assertEqual(system.outputs, ["y", "z"])

    def test_sympy_within(self):
        sympy = __import__("sympy")

        def f(x):
            return [x.v, -2 * sympy.sin(x.q) + x.q * sympy.cos(x.v)]

        system = palmistry.System.from_function(f, lambda x: x.q, states="q, v")
        self.assertAlmostEqual(float(system.eval("L(f, v)", at={"q": "0.4", "v": "0.2"})), -2 * numpy.sin(0.4) + 0.4 * numpy.cos(0.2), 14)

    def test_mistakes(self):
        import math

        cases = [
            (lambda x: [math.sin(x.q), x.q], "numpy's or SymPy's"),
            (lambda x: [x.v if x.q > 0 else x.q, x.v], "no branches"),
            (lambda x: [x.v if x.q == 0 else x.q, x.v], "no branches"),
            (lambda x: [x.v if x.q != 0 else x.q, x.v], "no branches"),
            (lambda x: [x.v if x.q in (1, 2) else x.q, x.v], "no branches"),
            (lambda x: [x.v], "1 rates"),
            (lambda x: [x.v, x.nothing], "there is no 'nothing'"),
            (lambda x: {"q": x.v, "r": x.q}, "moves r"),
            (lambda x, p, u, more: [x.v, x.q], "takes 4 arguments"),
        ]
        for f, said in cases:
            with self.assertRaisesRegex((Error, AttributeError), said):
                palmistry.System.from_function(f, lambda x: x.q, states="q, v")

    def test_numbers_of_numpy_and_a_state_that_is_called_f(self):
        found = palmistry.System.from_function(lambda x, p: [numpy.float64(2.5) * x.f - p.k * x.f**2 * numpy.int64(3)], lambda x: x.f, states="f", parameters={"k": numpy.float64(0.5)})
        self.assertEqual(found.eval("L(f1, f)", at={"f": 2}).exact, 5 - 6)
        with self.assertRaisesRegex(Error, "no states"):
            palmistry.System.from_function(lambda x: [], lambda x: [1], states="")

    def test_sums_and_products_keep_their_brackets(self):
        """Random expressions, evaluated by Python and by the program."""
        random = numpy.random.Generator(numpy.random.PCG64(7))

        def expression(x, depth):
            if depth == 0:
                return [x[0], x[1], 3, 0.25][random.integers(4)]
            a, b = expression(x, depth - 1), expression(x, depth - 1)
            kind = random.integers(6)
            return [lambda: a + b, lambda: a - b, lambda: a * b, lambda: a / (b * b + 2), lambda: -(a + b) * a, lambda: (a - b) ** 3][kind]()

        for _ in range(60):
            seed = random.bit_generator.state
            system = palmistry.System.from_function(lambda x: [expression(x, 3) * x[0] ** 0 if False else expression(x, 3), x[0]], lambda x: x[0], states="q, v")
            random.bit_generator.state = seed
            expected = expression([0.3, -1.7], 3)
            found = float(system.eval("L(f, q)", at={"q": "0.3", "v": "-1.7"}))
            self.assertLess(abs(found - expected), 1e-12 * (1 + abs(expected)), system.source)


@built
class Measurements(unittest.TestCase):
    def setUp(self):
        self.times, self.path = pendulum(101)
        noise = numpy.random.Generator(numpy.random.PCG64(3)).normal(0, 1e-3, 101)
        self.phi = self.path[:, 0] + noise
        self.system = pendulum_system()

    def test_a_dict_a_frame_and_a_file_are_one(self):
        first = palmistry.observe(self.system, {"time": self.times, "phi": self.phi}, noise=1e-3, times=False)
        estimates = dict(zip(first.estimates["name"].tolist(), zip(first.estimates["estimate"], first.estimates["deviation"])))
        for name, truth in {"phi": 1.0, "omega": 0.0, "k": 2.0, "c": 0.1}.items():
            value, deviation = estimates[name]
            self.assertLess(abs(value - truth), 4 * deviation, name)
        self.assertTrue(first.fits)
        covariance = first.covariance()
        self.assertEqual(covariance.shape, (4, 4))
        numpy.testing.assert_allclose(numpy.sqrt(numpy.diag(covariance)), first.estimates["deviation"], rtol=1e-9)
        # the residuals are those of the truth but for what four unknowns take
        self.assertLess(numpy.abs(first.residuals["phi"] + self.phi - self.path[:, 0]).max(), 3e-3)
        self.assertEqual(first.track.rows, 101)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "record.csv")
            with open(file, "w", encoding="utf-8") as written:
                written.write("time,phi\n" + "".join(f"{t!r},{p!r}\n" for t, p in zip(self.times.tolist(), self.phi.tolist())))
            self.assertEqual(palmistry.observe(self.system, file, noise=1e-3, times=False).estimates["estimate"].tolist(), first.estimates["estimate"].tolist())
        try:
            import pandas
        except ImportError:
            return
        frame = pandas.DataFrame({"t": self.times, "angle": self.phi, "remark": "none"})
        found = palmistry.observe(self.system, frame, noise={"phi": 1e-3}, time="t", columns={"phi": "angle"}, times=False)
        self.assertEqual(found.estimates["estimate"].tolist(), first.estimates["estimate"].tolist())
        indexed = pandas.DataFrame({"phi": self.phi}, index=self.times)
        self.assertEqual(palmistry.observe(self.system, indexed, noise=1e-3, times=False).estimates["estimate"].tolist(), first.estimates["estimate"].tolist())

    def test_what_is_known_bounded_or_guessed(self):
        data = {"time": self.times, "phi": self.phi}
        found = palmistry.observe(self.system, data, noise=1e-3, unknowns="phi, omega".split(", "), known={"k": 2, "c": 0.1}, guess={"phi": 0.9}, window=50)
        self.assertEqual(found.estimates["name"].tolist(), ["phi", "omega"])
        self.assertEqual([observer["method"] for observer in found.observers], ["trust-region"])
        bounded = palmistry.observe(self.system, data, noise=1e-3, bounds={"k": (2.5, 4)})
        self.assertFalse(bounded.fits)

    def test_what_has_no_answer_has_no_deviation(self):
        """A search that stops early, one that cannot see, and two methods of which one is shown."""
        data = {"time": self.times, "phi": self.phi}
        stopped = palmistry.observe(self.system, data, noise=1e-3, guess={"phi": 2.5, "omega": -1.5, "k": 4, "c": 0.9}, method="newton", steps=1)
        if not stopped.updates[0]["status"].startswith("converged"):
            self.assertTrue(numpy.isnan(stopped.estimates["deviation"]).all())
            self.assertIsNone(stopped.covariance())
        self.assertFalse(stopped.fits)
        both = palmistry.System.parse(self.system.source.replace("-k*sin(phi)", "-k*m*sin(phi)").replace("param c", "param m unknown\nparam c").replace("sample", "sample\n  m in [1, 2]"))
        blind = palmistry.observe(both, data, noise=1e-3)
        self.assertEqual(blind.updates[0]["status"], "not observable")
        self.assertTrue(numpy.isinf(blind.estimates["deviation"]).all())
        self.assertIsNone(blind.covariance())
        two = palmistry.observe(self.system, data, noise=1e-3, method=["kalman", "trust-region"])
        numpy.testing.assert_allclose(numpy.sqrt(numpy.diag(two.covariance())), two.estimates["deviation"], rtol=1e-9)
        alone = palmistry.observe(self.system, data, noise=1e-3, method="kalman")
        self.assertEqual((alone.updates, alone.estimates.rows, alone.covariance(), alone.fits), ([], 0, None, False))

    def test_any_title(self):
        title = 'A "decay" \\ \u00e9 \U0001f600 \x7f'
        system = palmistry.System.from_function(lambda x: [-x[0]], lambda x: x[0], states="x", title=title.replace('"', ""), sample={"x": (0, 2)})
        found = palmistry.observe(system, {"time": self.times, "x": numpy.exp(-self.times)}, noise=1e-6)
        self.assertTrue(found.fits)

    def test_mistakes(self):
        good = {"time": self.times, "phi": self.phi}
        cases = [
            (lambda: palmistry.observe(self.system), "no measurements"),
            (lambda: palmistry.observe(self.system, {"phi": self.phi}), "no column 'time'"),
            (lambda: palmistry.observe(self.system, {"time": self.times, "angle": self.phi}), "'phi'"),
            (lambda: palmistry.observe(self.system, {"time": self.times, "phi": self.phi[:-1]}), "100 values|101 times|has 10"),
            (lambda: palmistry.observe(self.system, {"time": self.times, "phi": numpy.where(self.times == 1.0, numpy.inf, self.phi)}), "fault"),
            (lambda: palmistry.observe(self.system, {"time": numpy.where(self.times == 1.0, numpy.nan, self.times), "phi": self.phi}), "fault"),
            (lambda: palmistry.observe(self.system, {"time": self.times, "phi": numpy.full(101, numpy.nan)}), "nothing was measured"),
            (lambda: palmistry.observe(self.system, good, interpolation="magic"), "magic|interpolation"),
            (lambda: palmistry.observe(self.system, good, method="magic"), "magic"),
            (lambda: palmistry.observe(self.system, good, unknowns=["psi"]), "psi"),
            (lambda: palmistry.observe(self.system, 3.0), "no float"),
            (lambda: palmistry.observe(self.system, {"time": [], "phi": []}), "no row|no sample|empty"),
            (lambda: palmistry.observe(self.system, {"time": numpy.array([], "datetime64[s]"), "phi": []}), "does not hold numbers|no row"),
            (lambda: palmistry.observe(self.system, good, studies=True), "true states"),
        ]
        for ask, said in cases:
            with self.assertRaisesRegex(Error, said):
                ask()
        skipped = palmistry.observe(self.system, {"time": self.times, "phi": numpy.where(self.times == 1.0, numpy.inf, self.phi)}, noise=1e-3, on_fault="skip")
        self.assertTrue(skipped.fits)

    def test_dates_are_seconds(self):
        first = palmistry.observe(self.system, {"time": self.times, "phi": self.phi}, noise=1e-3, times=False).estimates["estimate"]
        stamps = numpy.datetime64("2026-11-28T10:00:00") + (self.times * 1e9).round().astype("timedelta64[ns]")
        for times in (stamps, [str(one) for one in stamps], [f"{one}Z" for one in stamps]):
            found = palmistry.observe(self.system, {"time": times, "phi": self.phi}, noise=1e-3, times=False).estimates["estimate"]
            numpy.testing.assert_allclose(found, first, rtol=1e-6)
        mixed = [f"{one}{'Z' if place else ''}" for place, one in enumerate(stamps)]
        self.assertRaisesRegex(Error, "does not hold numbers", palmistry.observe, self.system, {"time": mixed, "phi": self.phi})
        try:
            import pandas
        except ImportError:
            return
        frame = pandas.DataFrame({"phi": self.phi}, index=pandas.to_datetime(stamps).tz_localize("UTC"))
        found = palmistry.observe(self.system, frame, noise=1e-3, times=False).estimates["estimate"]
        numpy.testing.assert_allclose(found, first, rtol=1e-6)

    def test_what_was_not_measured_is_no_fault(self):
        sparse = numpy.where(numpy.arange(101) % 3 == 0, self.phi, numpy.nan)
        found = palmistry.observe(self.system, {"time": self.times, "phi": sparse}, noise=1e-3, times=False)
        self.assertTrue(found.fits)
        self.assertEqual(found.json["sparse"], [{"column": "phi", "measured": 34, "interpolated": False}])
        kept = ~numpy.isnan(sparse)
        alone = palmistry.observe(self.system, {"time": self.times[kept], "phi": sparse[kept]}, noise=1e-3, times=False)
        off = (found.estimates["estimate"][: 4] - alone.estimates["estimate"][: 4]) / alone.estimates["deviation"]
        # the last two rows measure nothing, and only they are integrated farther
        self.assertLess(numpy.abs(off).max(), 1e-4)
        self.assertEqual(int(numpy.isnan(found.residuals["phi"]).sum()), 67)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "record.csv")
            with open(file, "w", encoding="utf-8") as written:
                written.write("time,phi\n" + "".join(f"{t!r},{'' if p != p else repr(p)}\n" for t, p in zip(self.times.tolist(), sparse.tolist())))
            self.assertEqual(palmistry.observe(self.system, file, noise=1e-3, times=False).estimates["estimate"].tolist(), found.estimates["estimate"].tolist())
        try:
            import pandas
        except ImportError:
            return
        frame = pandas.DataFrame({"phi": pandas.array(sparse, dtype="Float64")}, index=self.times)
        self.assertEqual(palmistry.observe(self.system, frame, noise=1e-3, times=False).estimates["estimate"].tolist(), found.estimates["estimate"].tolist())

    def test_ctrl_c_is_heeded(self):
        times = numpy.linspace(0, 100, 4001)
        data = {"time": times, "phi": numpy.sin(17 * times) * numpy.cos(times**2)}
        threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            palmistry.observe(self.system, data, noise=1e-6)
            time.sleep(5)
        self.assertLess(time.monotonic() - begin, 1.5)

    def test_threads_change_nothing(self):
        data = {"time": self.times, "phi": self.phi}
        found = []
        for count in (1, 2, None):
            palmistry.threads(count)
            found.append(palmistry.observe(self.system, data, noise=1e-3, times=False).json)
        self.assertEqual(found[0], found[1])
        self.assertEqual(found[0], found[2])
        with self.assertRaises(Error):
            palmistry.threads(0)


@built
class Pictures(unittest.TestCase):
    def test_a_map_has_the_values_of_its_states(self):
        system = palmistry.System.read(os.path.join(SYSTEMS, "beacons.proof"))
        drawn = system.map("px", "py", size=(7, 5), ranges={"px": (-2, 2), "py": (-1, 1)}, at={"theta": "0.3", "v": 1, "w": "0.2"})
        self.assertEqual(drawn.worst.shape, (5, 7))
        states = {"px": numpy.array([drawn.grids[0][2]]), "py": numpy.array([drawn.grids[1][3]])}
        alone = system.standard_deviations(states, at={"theta": "0.3", "v": 1, "w": "0.2"})
        for name in alone:
            self.assertEqual(drawn.deviations[name][3, 2], alone[name][0])
        with self.assertRaisesRegex(Error, "v, w have no value"):
            system.map("px", "py", at={"theta": 0})
        with self.assertRaisesRegex(Error, "no coordinate"):
            system.map("px", "nothing")

    def test_what_is_drawn(self):
        try:
            import matplotlib

            matplotlib.use("Agg")
        except ImportError:
            self.skipTest("pip install 'palmistry[plot]'")
        system = pendulum_system()
        times, path = pendulum(101)
        found = palmistry.observe(system, {"time": times, "phi": path[:, 0]}, times=False)
        axes = found.plot()
        self.assertEqual([ax.get_ylabel() for ax in axes], ["phi", "omega", "k", "c"])
        numpy.testing.assert_array_equal(axes[1].lines[0].get_ydata(), found.track["omega"])
        ax = system.rank(samples=200).plot()
        self.assertEqual([label.get_text() for label in ax.get_yticklabels()], ["phi", "omega", "k", "c"])
        self.assertEqual(system.map("phi", "omega", size=6, at={"k": 2, "c": 0}).plot().get_xlabel(), "phi")

    def test_tables_in_latex(self):
        found = pendulum_system().rank(samples=0).to_latex()
        self.assertEqual(found.count(r"\\"), 5)
        self.assertIn(r"$\varphi$ & state & locally observable", found)


@built
class Sweeps(unittest.TestCase):
    def test_three_lines(self):
        try:
            from dask.distributed import Client, LocalCluster
        except ImportError:
            self.skipTest("pip install 'palmistry[dask]'")
        os.environ.setdefault("PALMISTRY", PROGRAM)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "van_der_pol.proof")
            with open(os.path.join(SYSTEMS, "van_der_pol.proof"), encoding="utf-8") as source, open(file, "w", encoding="utf-8") as copy:
                copy.write(source.read())
            with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster, Client(cluster) as client:
                system = palmistry.System.read(file)
                found = palmistry.sweep(system, samples=3e3, client=client, at={"mu": "1.5"}, progress=False)
            alone = system.rank(samples=3000, at={"mu": "1.5"}, times=False)
            self.assertEqual(timeless(without_directions(found.json)), timeless(without_directions(alone.json)))
            self.assertEqual(found.histogram, alone.histogram)
            self.assertIn("rank", found.text)
            with open(file, "a", encoding="utf-8") as copy:
                copy.write("# changed\n")
            with self.assertRaisesRegex(palmistry.cluster.Failed, "has changed"):
                palmistry.sweep(system, samples=10, client=None)


if __name__ == "__main__":
    unittest.main()
