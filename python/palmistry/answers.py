"""What was found: the very object that the program prints with `--json`, with names for what is asked for most."""

from __future__ import annotations

import json
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
        """The object that the program prints; the page on JSON in the book tells its fields."""
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

    def __repr__(self) -> str:
        wrong = [claim.id for claim in self if not claim.ok]
        return f"<{len(self)} claims, {'all as expected' if not wrong else 'not as expected: ' + ', '.join(wrong)}>"

    def _repr_html_(self) -> str:
        return self._found.html()


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

    @cached_property
    def states(self) -> Table | None:
        """A row a sampled state, where `table=True` asked for it: index, rank (-1 at a pole), certified, smallest_singular_value,
        condition (NaN where there is none), and with `coordinates=True` the coordinates, angles in radians; `branch` where there are
        several."""
        columns = self._found.table()
        return None if columns is None else Table(columns)

    def __repr__(self) -> str:
        return f"<rank {self.generic} of {self.dimension}; {self.certified} of {self.samples} states certified>"

    def _repr_html_(self) -> str:
        return self._found.html()


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
        return Decimal(self.value)

    def to_numpy(self) -> numpy.ndarray:
        """The nearest doubles: shape () of a number, (rows, columns) of a matrix."""
        import numpy

        return numpy.array(self.value, dtype=float)

    def __float__(self) -> float:
        return float(self.value)

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

    #: int64. The rank; -1 at a pole, and where something is infinite or not a number.
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


def _framed(page: str, height: int = 600) -> str:
    """A whole page inside another one."""
    return f'<iframe srcdoc="{escape(page)}" style="width:100%;height:{height}px;border:0"></iframe>'


class Observation(Answer):
    """What observers made of a scene."""

    @property
    def observers(self) -> list[dict[str, Any]]:
        """What each method found: updates, end, fit."""
        return self.json["observers"]

    def _table(self, name: str) -> Table | None:
        columns = self._found.table(name)
        return None if columns is None else Table(columns)

    @property
    def readings(self) -> Table:
        """The measurements, a row a sample: time (s), outputs, inputs."""
        found = self._table("readings")
        assert found is not None
        return found

    @property
    def motion(self) -> Table | None:
        """All of the simulated motion, a row a sample; None where the measurements come from a file."""
        return self._table("motion")

    @property
    def track(self) -> Table | None:
        """What was believed sample by sample: each state with its bound there, a standard deviation (NaN where there is none)."""
        return self._table("track")

    @property
    def outline(self) -> Table | None:
        """The outline of a body, a row a normal (rad): support radius, band, point; None where nothing was seen of it."""
        return self._table("outline")

    @cached_property
    def page(self) -> Page:
        """The page with pictures."""
        return Page(self._found.page())

    def __repr__(self) -> str:
        return f"<observation by {', '.join(observer['method'] for observer in self.observers)}>"

    def _repr_html_(self) -> str:
        return self.page._repr_html_()


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
