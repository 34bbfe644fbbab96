"""What was found: the very object that the program prints with `--json`, with names for what is asked for most."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple

from .tables import Table

if TYPE_CHECKING:
    import numpy


class Answer:
    """An answer. `json` is the object that the program prints with `--json`, `text` what it prints without."""

    def __init__(self, found: Any) -> None:
        self._found = found

    @cached_property
    def json(self) -> dict[str, Any]:
        """The object that the program prints; the page on JSON in the book lists its fields."""
        return json.loads(self._found.json())

    @cached_property
    def text(self) -> str:
        """What the program prints."""
        return self._found.text()

    def __str__(self) -> str:
        return self.text


class Claim:
    """One claim with its verdict."""

    def __init__(self, fields: dict[str, Any]) -> None:
        self.json = fields

    @property
    def id(self) -> str:
        return self.json["id"]

    @property
    def statement(self) -> str:
        """What is claimed, in the language of proof files."""
        return self.json["statement"]

    @property
    def verdict(self) -> str:
        """'proved', 'refuted', 'undecided', or one of the words for what a file says of a text in print."""
        return self.json["verdict"]

    @property
    def expected(self) -> str:
        return self.json["expected"]

    @property
    def ok(self) -> bool:
        """Whether the verdict is what the file expects."""
        return self.json["ok"]

    @property
    def witness(self) -> dict[str, Any] | None:
        """Of a refuted claim the state at which it fails, in exact numbers, with both sides."""
        return self.json.get("witness")

    @property
    def line(self) -> int:
        return self.json["line"]

    @property
    def latex(self) -> str | None:
        """The statement in LaTeX; None where it is said in words."""
        from .system import latex

        return latex(self.statement)

    def __repr__(self) -> str:
        return f"<claim {self.id}: {self.verdict}>"

    def _repr_latex_(self) -> str | None:
        formula = self.latex
        return None if formula is None else f"${formula}$"


class Claims(Answer, Sequence):
    """The claims of a system, decided, in the order of the file; by place, or by id."""

    @cached_property
    def _claims(self) -> list[Claim]:
        return [Claim(fields) for fields in self.json["claims"]]

    def __getitem__(self, key):
        if isinstance(key, str):
            for claim in self._claims:
                if claim.id == key:
                    return claim
            raise KeyError(key)
        return self._claims[key]

    def __len__(self) -> int:
        return len(self._claims)

    def __iter__(self) -> Iterator[Claim]:
        return iter(self._claims)

    @property
    def ok(self) -> bool:
        """Whether each verdict is what the file expects."""
        return self.json["ok"]

    @property
    def table(self) -> Table:
        """A row a claim: id, verdict, expected, ok, statement, line."""
        import numpy

        names = ("id", "verdict", "expected", "ok", "statement", "line")
        return Table({name: numpy.array([claim.json[name] for claim in self]) for name in names})

    @cached_property
    def evidence(self) -> str:
        """What the verdicts rest on, as a verdict file (JSON): what `palmistry prove --verdicts` writes, for `palmistry recheck`; where `prove(evidence=True)` has kept it."""
        return self._found.verdicts()

    def recheck(self, *, proofs: str = ".", seed: int = 1) -> Recheck:
        """The verdicts, evaluated again by the small checker that shares nothing with the engines. It reads the proof file itself: the system has to come from one.

        proofs: the folder from which the name of that file is read. seed: of the states at which proofs are tried.
        """
        from .system import rechecked

        return rechecked(self.evidence, proofs, seed)

    def to_latex(self) -> str:
        """The claims as a table in LaTeX: a row a claim, id, statement and verdict."""
        return _tabular(
            ("claim", "statement", "verdict"),
            [(_plain(claim.id), f"${claim.latex}$" if claim.latex else _plain(claim.statement), claim.verdict) for claim in self],
        )

    def __repr__(self) -> str:
        wrong = [claim.id for claim in self if not claim.ok]
        return f"<{len(self)} claims, {'all as expected' if not wrong else 'not as expected: ' + ', '.join(wrong)}>"

    def _repr_html_(self) -> str:
        return self._found.html()


def _plain(text: str) -> str:
    """A text as LaTeX prints it, letter by letter."""
    special = {"\\": r"\textbackslash{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", **{sign: f"\\{sign}" for sign in "#$%&_{}"}}
    return "".join(special.get(sign, sign) for sign in text)


def _tabular(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in LaTeX, with the rules of the package booktabs."""
    lines = [f"\\begin{{tabular}}{{{'l' * len(heads)}}}", r"\toprule", " & ".join(heads) + r" \\", r"\midrule"]
    return "\n".join([*lines, *(" & ".join(row) + r" \\" for row in rows), r"\bottomrule", r"\end{tabular}"])


class Rank(Answer):
    """The rank of the observability codistribution: generically, and at the sampled states."""

    @property
    def dimension(self) -> int:
        """How many unknowns there are: the rank where all are locally observable."""
        return self.json["dimension"]

    @property
    def branches(self) -> list[dict[str, Any]]:
        """What was found on each branch of the conditions; a list of one where there are none."""
        return self.json.get("branches", [self.json])

    @property
    def generic(self) -> int | None:
        """The generic rank on the first branch; None where it is not known."""
        return self.branches[0]["generic"]["rank"]

    @property
    def histogram(self) -> dict[int, int]:
        """How many of the sampled states have each rank, on all branches."""
        return {int(rank): count for rank, count in self.json["rank_histogram"].items()}

    @property
    def certified(self) -> int:
        """At how many of them the rank is proved."""
        return self.json["certified"]

    @property
    def samples(self) -> int:
        """How many states were looked at."""
        return self.json["samples"]

    @property
    def unknowns(self) -> Table:
        """A row an unknown of the first branch: name, kind, verdict."""
        import numpy

        rows = self.branches[0]["unknowns"]
        return Table({key: numpy.array([row[key] for row in rows]) for key in ("name", "kind", "verdict")})

    @property
    def identifiable_functions(self) -> list[str] | None:
        """Functions of the unobservable unknowns that are locally identifiable, in the language; None where they were not looked for or not all were found."""
        found = self.branches[0].get("unobservable_directions")
        if found is None or found["cut_off"] or found["functions_missing"]:
            return [] if self.generic == self.dimension else None
        return [function["text"] for function in found["functions"]]

    @property
    def unobservable_directions(self) -> list[dict[str, str]] | None:
        """Vector fields along which no output changes, each as its components by unknown, in the language; None where they were not looked for or not all were
        found."""
        found = self.branches[0].get("unobservable_directions")
        if found is None or found["cut_off"] or found["fields_missing"]:
            return [] if self.generic == self.dimension else None
        return [field["components"] for field in found["fields"]]

    def to_latex(self) -> str:
        """The unknowns with their verdicts as a table in LaTeX."""
        from .system import latex

        rows = self.branches[0]["unknowns"]
        return _tabular(("unknown", "kind", "verdict"), [(f"${latex(row['name'])}$", row["kind"], row["verdict"]) for row in rows])

    def plot(self, ax: Any = None) -> Any:
        """The standard deviation of each unknown, normalised by its prior one: median and worst of the sampled states, on a logarithmic scale, what is unobservable at the
        right edge. `ax`: matplotlib axes, made unless given and returned."""
        import numpy

        found = self.branches[0].get("standard_deviations")
        if not found:
            from .errors import Error

            raise Error("no states were sampled, and there is nothing to draw", "ask rank(samples=1000)")
        ax = ax or _axes()
        rows = found["of"]
        places = numpy.arange(len(rows))[::-1]
        known = [row[key] for row in rows for key in ("median", "worst") if row[key] is not None]
        edge = 10 * max([*known, 1.0])
        for key, marker in (("median", "o"), ("worst", "|")):
            values = [edge if row[key] is None else row[key] for row in rows]
            ax.plot(values, places, marker, label=key)
        ax.set_xscale("log")
        ax.axvline(edge, linestyle=":", color="0.5")
        ax.set_yticks(places, [row["state"] for row in rows])
        ax.set_xlabel("standard deviation over the prior one (dotted: unobservable)")
        ax.legend()
        return ax

    @cached_property
    def states(self) -> Table | None:
        """A row a sampled state, where `table=True` asked for it: index, rank (-1 at a singularity), certified, smallest_singular_value,
        condition (NaN where there is none), and with `coordinates=True` the coordinates, angles in radians; `branch` where there are
        several."""
        columns = self._found.table()
        return None if columns is None else Table(columns)

    def __repr__(self) -> str:
        return f"<rank {self.generic} of {self.dimension}; {self.certified} of {self.samples} states certified>"

    def _repr_html_(self) -> str:
        return self._found.html()


class Solutions(Answer):
    """The number of solutions of each unknown: values that give the same outputs."""

    @property
    def unknowns(self) -> Table:
        """A row an unknown: name, kind, values (0 where undecided, infinite where there are infinitely many), verdict ('proved', 'computed' or 'undecided')."""
        import numpy

        rows = self.json["unknowns"]
        values = [numpy.inf if row["values"] == "infinity" else row["values"] or 0 for row in rows]
        columns = {key: numpy.array([row[key] for row in rows]) for key in ("name", "kind")}
        return Table({**columns, "values": numpy.array(values, dtype=float), "verdict": numpy.array([row["verdict"] for row in rows])})

    def __repr__(self) -> str:
        values = [f"{row['name']} {row['values'] or '?'}" for row in self.json["unknowns"]]
        return f"<solutions: {', '.join(values)}>"


class Designs(Answer):
    """What to measure or to know besides, so that unknowns become identifiable."""

    @property
    def sets(self) -> list[list[tuple[str, str | None]]]:
        """The minimal sets, smallest first: of each addition its kind ('output', 'known', 'initial', 'input', 'experiment') and of what."""
        return [[(addition["kind"], addition["what"]) for addition in design["additions"]] for design in self.json["designs"]]


class SingularSet(Answer):
    """The singular set: sets of rank-deficient states, each by its equations, with a proof that there are no others where there is one."""

    @cached_property
    def page(self) -> Page:
        """The page with the sets and their proof."""
        return Page(self._found.page())

    def _repr_html_(self) -> str:
        return self.page._repr_html_()


class Accessibility(Answer):
    """Whether the drift and the inputs can move the state in every direction."""


class Recheck(Answer):
    """What a checker has found of verdicts that it evaluated again."""

    @property
    def ok(self) -> bool:
        """Whether nothing was contradicted."""
        return self.json["ok"]

    @property
    def table(self) -> Table:
        """A row a verdict: file, id, kind, finding, reason."""
        import numpy

        names = ("file", "id", "kind", "finding", "reason")
        return Table({name: numpy.array([row[name] for row in self.json["verdicts"]]) for name in names})


class Map:
    """How well unknowns are observable over two coordinates."""

    def __init__(self, x: str, y: str, grids: tuple[Any, Any], deviations: dict[str, Any], at: list[str]) -> None:
        #: The names of the coordinates.
        self.x, self.y = x, y
        #: Their values, of shape (columns,) and (rows,).
        self.grids = grids
        #: By unknown its standard deviation over its prior one, of shape (rows, columns): infinite where it is unobservable, NaN at a singularity.
        self.deviations = deviations
        #: The values that were fixed, as texts of the form name=value.
        self.at = at

    @property
    def worst(self) -> numpy.ndarray:
        """That of the least observable unknown, of shape (rows, columns); NaN at a singularity."""
        import numpy

        return numpy.max(list(self.deviations.values()), axis=0)

    def plot(self, ax: Any = None, of: str | None = None) -> Any:
        """Draws it by matplotlib, on a logarithmic scale; what is unobservable is black. of: an unknown, the least observable one of each state unless given."""
        import numpy

        ax = ax or _axes()
        values = self.worst if of is None else self.deviations[of]
        finite = values[numpy.isfinite(values)]
        shown = numpy.log10(numpy.where(numpy.isfinite(values), values, numpy.nan))
        import matplotlib

        scale = matplotlib.colormaps["viridis"].with_extremes(bad="white", over="black")
        low, high = (numpy.log10(finite.min()), numpy.log10(finite.max())) if finite.size else (0.0, 1.0)
        shown = numpy.where(numpy.isinf(values), high + 1 + abs(high), shown)
        # each state in the middle of its cell
        edges = [end for grid in self.grids for half in [(grid[-1] - grid[0]) / max(len(grid) - 1, 1) / 2] for end in (grid[0] - half, grid[-1] + half)]
        drawn = ax.imshow(shown, origin="lower", extent=edges, aspect="auto", interpolation="nearest", cmap=scale, vmin=low, vmax=max(high, low + 1e-9))
        bar = ax.figure.colorbar(drawn, ax=ax, extend="max")
        bar.set_label(f"log10 of standard deviation / prior one,\n{of or 'least observable unknown'} (black: unobservable)")
        if self.at:
            ax.set_title(textwrap.fill("at " + ", ".join(pair.replace("=", " = ") for pair in self.at), 64), fontsize="small")
        ax.set_xlabel(self.x)
        ax.set_ylabel(self.y)
        return ax

    def __repr__(self) -> str:
        return f"<map over {self.x} and {self.y}: {len(self.grids[1])} x {len(self.grids[0])} states>"


def _axes() -> Any:
    """New axes of matplotlib."""
    try:
        import matplotlib.pyplot as pyplot
    except ImportError as why:
        raise ImportError("pictures need matplotlib: pip install 'palmistry[plot]'") from why
    return pyplot.subplots()[1]


class Value:
    """The value of an expression at a point."""

    def __init__(self, text: str) -> None:
        #: The object that the program prints.
        self.json: dict[str, Any] = json.loads(text)

    @property
    def value(self) -> str | list[list[str]]:
        """All digits, as a text; of a matrix a list of rows."""
        found = self.json["value"]
        return found

    @property
    def exact(self) -> Fraction | None:
        """The value itself, where it is rational and known exactly."""
        found = self.json.get("exact")
        return None if found is None else Fraction(found)

    @property
    def how(self) -> str:
        """Why the digits are certain, or that they are not."""
        return self.json["how"]

    @property
    def expression(self) -> str:
        return self.json["expression"]

    @property
    def latex(self) -> str | None:
        """The expression in LaTeX."""
        from .system import latex

        return latex(self.expression)

    @property
    def decimal(self) -> Decimal:
        """The value as a decimal number with all digits; of a matrix there is none."""
        return Decimal(str(self.value))

    def to_numpy(self) -> numpy.ndarray:
        """The nearest doubles: shape () of a number, (rows, columns) of a matrix."""
        import numpy

        return numpy.array(self.value, dtype=float)

    def __float__(self) -> float:
        return float(str(self.value))

    def __str__(self) -> str:
        if isinstance(self.value, str):
            return self.value
        return "\n".join("  ".join(row) for row in self.value)

    def __repr__(self) -> str:
        return f"<{self.expression} = {self}>"

    def _repr_latex_(self) -> str | None:
        left = self.latex
        if left is None:
            return None
        if isinstance(self.value, str):
            return f"${left} = {self.value}$"
        rows = r" \\ ".join(" & ".join(row) for row in self.value)
        return rf"${left} = \begin{{pmatrix}}{rows}\end{{pmatrix}}$"


class Verdicts(NamedTuple):
    """What was decided of some states: arrays of shape (states,)."""

    #: int64. The rank; -1 at a singularity, and where something is infinite or not a number.
    rank: numpy.ndarray
    #: bool. Whether it is proved for this very state.
    certified: numpy.ndarray
    #: float64. Of the matrix that remains without unit rows, after equilibration: how hard the rank is to decide, and not how well a state is
    #: observable (`System.standard_deviations`); NaN where nothing remains.
    smallest_singular_value: numpy.ndarray
    #: float64. The largest singular value over the smallest, good to some percent.
    condition: numpy.ndarray

    @property
    def table(self) -> Table:
        """The same as a table."""
        return Table(self._asdict())


class Certificate(Answer):
    """On which part of the sample box the rank is full, proved."""

    @property
    def proved_fraction(self) -> float:
        """A lower bound on the proved part of the volume, between 0 and 1."""
        return self.json["proved_fraction"]

    @property
    def curve(self) -> Table:
        """The proved fraction over the boxes that were looked at: a row a point."""
        import numpy

        points = self.json["curve"]
        names = list(points[0]) if points else []
        return Table({name: numpy.array([point[name] for point in points]) for name in names})

    @property
    def curve_svg(self) -> str:
        """The same as a picture."""
        return self._found.curve()

    @property
    def map_svg(self) -> str | None:
        """A picture of what is proved over two coordinates; None where there are no two."""
        return self._found.map()

    def __repr__(self) -> str:
        return f"<full rank proved on {self.proved_fraction:.6g} of the box>"

    def _repr_html_(self) -> str:
        picture = self.map_svg or self.curve_svg
        return f"{picture}<pre>{escape(self.text)}</pre>"


class Trade(Answer):
    """What accuracy costs: number types, ways to a derivative and ways to a rank, on the same states."""

    @property
    def table(self) -> Table:
        """A row a combination: number, derivative and rank by name, seconds_a_state, the median of the digits, wrong and undecided verdicts, and whether it is on the Pareto front."""
        import numpy

        rows = self.json["combinations"]
        names = ("number", "derivative", "rank", "seconds_a_state", "wrong", "undecided", "seconds_on_front")
        found = {name: numpy.array([row[name] for row in rows]) for name in names}
        return Table({**found, "digits": numpy.array([row["digits"].get("median", numpy.nan) for row in rows], dtype=float)})

    @property
    def svg(self) -> str:
        """The front as a picture."""
        return self._found.page()

    def _repr_html_(self) -> str:
        return f"{self.svg}<pre>{escape(self.text)}</pre>"


class Stress(Answer):
    """How near to a singular set, how large, and in which units number types misreport a rank."""

    def __init__(self, found: Any) -> None:
        answer, pictures = found
        super().__init__(answer)
        self._pictures = pictures

    @property
    def pictures(self) -> dict[str, str]:
        """Pictures (SVG) by name."""
        return dict(self._pictures)

    def _repr_html_(self) -> str:
        return "".join(self.pictures.values()) + f"<pre>{escape(self.text)}</pre>"


class Motions(Answer):
    """Motions of palms, or runs of a body in space, that touch most of a body."""


class Poses(Answer):
    """Where a body lies between two slow palms, and how they can move it."""

    @cached_property
    def page(self) -> Page:
        """The page with its pictures."""
        return Page(self._found.page())

    def _repr_html_(self) -> str:
        return self.page._repr_html_()


def _framed(page: str, height: int = 600) -> str:
    """A whole page inside another one."""
    return f'<iframe srcdoc="{escape(page)}" style="width:100%;height:{height}px;border:0"></iframe>'


class Observation(Answer):
    """What observers made of measurements."""

    @property
    def observers(self) -> list[dict[str, Any]]:
        """What each method found: updates, end, fit. Of slow motion, in space and of several experiments there are none."""
        return self.json.get("observers", [])

    def _table(self, name: str) -> Table | None:
        columns = self._found.table(name)
        return None if columns is None else Table(columns)

    @property
    def measurements(self) -> Table:
        """The measurements, a row a sample: time (s), outputs, inputs. Of several experiments a row a measurement: experiment, output, time, value, and where something was simulated what is
        expected, the deviation of the error and the residual over it."""
        if self.json.get("kind") == "experiments":
            import numpy

            shown = self.json["best"] or self.json["nominal"] or {}
            rows = shown.get("measurements", [])
            names = ("experiment", "output", "time", "value", "expected", "deviation", "residual")
            # at rest there is no time
            return Table({name: numpy.array([numpy.inf if row[name] is None else row[name] for row in rows]) for name in names})
        found = self._table("measurements")
        assert found is not None
        return found

    @property
    def readings(self) -> Table:
        """Deprecated: the former name of `measurements`."""
        import warnings

        warnings.warn("use Observation.measurements, which is the same", DeprecationWarning, stacklevel=2)
        return self.measurements

    @property
    def motion(self) -> Table | None:
        """All of the simulated motion, a row a sample; None where the measurements come from a file."""
        return self._table("motion")

    @property
    def track(self) -> Table | None:
        """The estimates sample by sample: each state with its bound there, a standard deviation (NaN where there is none)."""
        return self._table("track")

    @property
    def outline(self) -> Table | None:
        """The outline of a body, a row a normal (rad): support radius, band, point; None where none was estimated."""
        return self._table("outline")

    @property
    def residuals(self) -> Table | None:
        """What the model expects minus what was measured, a row a sample: time (s), and each output in its unit."""
        columns = self._found.residuals()
        return None if columns is None else Table(columns)

    @property
    def updates(self) -> list[dict[str, Any]]:
        """The windows of the method that is shown, each with its estimate, its standard deviations, how it ended and its test of fit."""
        name = self._found.shown()
        return next((observer["updates"] for observer in self.observers if observer["method"] == name), [])

    @property
    def estimates(self) -> Table:
        """What is estimated, at the first sample of the first window of the method that is shown: name, estimate, deviation.

        deviation: a standard deviation; infinite where it is unobservable or what is estimated was fixed; NaN where the search came to no end, and the estimate is where it stopped.
        Of several experiments the best parameters; NaN too of one that lies at a bound.
        """
        import numpy

        if self.json.get("kind") == "experiments":
            found = self.json["parameters"]
            slopes = {"linear": lambda value: 1.0, "log": lambda value: value, "log10": lambda value: value * numpy.log(10)}
            unknown = [one["status"] in ("at a bound", "search not ended") for one in found]
            spread = [numpy.nan if held else numpy.inf if one["deviation"] is None else one["deviation"] * slopes[one["scale"]](one["value"]) for one, held in zip(found, unknown)]
            return Table({"name": numpy.array([one["name"] for one in found]), "estimate": numpy.array([one["value"] for one in found], dtype=float), "deviation": numpy.array(spread, dtype=float)})

        states = self.updates[0]["states"] if self.updates else {}
        names = [name for name in self._found.sought() if name in states]
        # what was held is not off by what measurements could tell at best
        is_held = bool(self.updates) and self.updates[0].get("held", False)
        ends = bool(self.updates) and self.updates[0]["status"].startswith("converged")
        bounds = [numpy.inf if is_held or states[name]["bound"] is None else states[name]["bound"] if ends else numpy.nan for name in names]
        values = [numpy.nan if states[name]["recovered"] is None else states[name]["recovered"] for name in names]
        return Table({"name": numpy.array(names), "estimate": numpy.array(values, dtype=float), "deviation": numpy.array(bounds, dtype=float)})

    def covariance(self, window: int = 0) -> numpy.ndarray | None:
        """The covariance of the estimates at the first sample of a window, of shape (estimates, estimates), in their order; None where there is no such window, where its search came to no end,
        or where something is unobservable in it."""
        if not 0 <= window < len(self.updates) or not self.updates[window]["status"].startswith("converged"):
            return None
        return self._found.covariance(window)

    @property
    def fits(self) -> bool:
        """Whether each window of the method that is shown converged and its residuals are what the noise explains; False of methods without windows, whose test is in `text`.
        Of several experiments whether they pass their chi-square test; False where there is none."""
        if self.json.get("kind") == "experiments":
            test = self.json["goodness_of_fit"]
            return test is not None and test["fits"]
        def passes(update: dict[str, Any]) -> bool:
            return update["status"] == "converged" and bool(update["fit"]) and update["fit"]["fits"]

        return bool(self.updates) and all(map(passes, self.updates))

    @cached_property
    def page(self) -> Page:
        """The page with pictures."""
        page = self._found.page()
        if page is None:
            from .errors import Error

            raise Error("a scene with a system for each mode has no page", "text and json say all there is")
        return Page(page)

    def plot(self, axes: Any = None) -> Any:
        """Draws what was estimated over time, an axis a state with a band of two standard deviations, by matplotlib. axes: as many as there are estimates, made unless given and returned."""
        from .errors import Error

        track, names = self.track, self._found.sought()
        if track is None or not names:
            raise Error("there is no track to draw", "of slow motion and in space the page has the pictures: .page")
        if axes is None:
            import matplotlib.pyplot as pyplot

            axes = pyplot.subplots(len(names), 1, sharex=True, squeeze=False, figsize=(6.4, 1.8 * len(names) + 0.6))[1][:, 0]
        for ax, name in zip(axes, names):
            value, bound = track[name], track[f"{name}_bound"]
            ax.fill_between(track["time"], value - 2 * bound, value + 2 * bound, alpha=0.3)
            ax.plot(track["time"], value)
            ax.set_ylabel(name)
        axes[-1].set_xlabel("time, s")
        return axes

    def __repr__(self) -> str:
        methods = ", ".join(observer["method"] for observer in self.observers)
        return f"<observation by {methods}>" if methods else "<observation>"

    def _repr_html_(self) -> str:
        return self.page._repr_html_() if self._found.page() is not None else f"<pre>{escape(self.text)}</pre>"


class Page:
    """A page in one piece: HTML with its pictures, and nothing from elsewhere."""

    def __init__(self, html: str, found: dict[str, Any] | None = None) -> None:
        self.html = html
        #: What the page was made from, where it is one of `palmistry.verify`.
        self.json = found

    def save(self, path) -> None:
        """Writes the page to a file."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.html)

    def __repr__(self) -> str:
        return f"<page of {len(self.html)} characters>"

    def _repr_html_(self) -> str:
        return _framed(self.html)
