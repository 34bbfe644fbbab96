"""A system, and what can be asked of it."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

from .answers import Accessibility, Certificate, Claims, Designs, Map, Page, Rank, Recheck, SingularSet, Solutions, Stress, Trade, Value, Verdicts
from .errors import Error
from .tables import Table

try:
    from . import _native
except ImportError as why:  # pragma: no cover
    raise ImportError(
        "the compiled half of palmistry is not there: install the package (pip install ./python), whose source tree alone has only "
        "palmistry.recheck and palmistry.cluster"
    ) from why

if TYPE_CHECKING:
    import numpy

#: Values by name: numbers, fractions, or texts such as '1/3'; or all of it as one text, 'x=1/3, y=.5'.
At = Union[Mapping[str, Any], str, None]


def _number(value: Any) -> str:
    """A number as the language reads it. A float is the decimal that Python prints, not the fraction that its bits are."""
    if isinstance(value, str):
        return value
    item = getattr(value, "item", None)  # numpy's scalars
    if item is not None:
        value = item()
    if isinstance(value, bool):
        raise Error(f"{value} is not a number", "give a number, a fraction, or a text such as '1/3'")
    return repr(value) if isinstance(value, float) else str(value)


def _pairs(values: At) -> list[str]:
    """Values as texts of the form name=value."""
    if values is None:
        return []
    if isinstance(values, str):
        return values.split(",")
    return [f"{name}={_number(value)}" for name, value in values.items()]


def _ranges(ranges: Mapping[str, Any] | str | None) -> list[str]:
    """Ranges as texts of the form name=low..high."""
    if ranges is None:
        return []
    if isinstance(ranges, str):
        return ranges.split(",")
    found = []
    for name, value in ranges.items():
        low, high = value if isinstance(value, (tuple, list)) else (value, value)
        found.append(f"{name}={_number(low)}..{_number(high)}")
    return found


def _several(texts: str | Iterable[str]) -> list[str]:
    return [texts] if isinstance(texts, str) else list(texts)


def _asked(kind: Any, ask: Callable[[], Any]) -> Any:
    """What was asked for, as its kind. Where Ctrl-C ends it, what was found until then is the exception's `found`, where there is something."""
    try:
        return kind(ask())
    except BaseException as raised:
        found = getattr(raised, "found", None)
        if found is not None and not isinstance(found, kind):
            raised.found = kind(found)  # type: ignore[attr-defined]
        raise


def _wanted(verdict: str) -> bool:
    if verdict not in ("certified", "computed"):
        raise Error(f"'{verdict}' is no kind of verdict", "it is 'certified' or 'computed'")
    return verdict == "certified"


class System:
    """A system `x' = f(x) + u g(x)`, `y = h(x)`, as a proof file declares it, with what the file claims of it.

    A system does not change. While something is asked other Python threads run, and Ctrl-C ends the question within 0.2 s: what `prove`, `rank` and
    `certify` had found until then is the attribute `found` of the KeyboardInterrupt, where there is something. The answers are those of
    the program, to the last bit: they depend neither on the number of threads (RAYON_NUM_THREADS) nor on the machine.
    """

    def __init__(self, native: Any) -> None:
        self._native = native
        self._deciders: dict[Any, Any] = {}

    @staticmethod
    def read(path: str | os.PathLike[str]) -> System:
        """Reads a proof file. Raises ReadError, with the place, where it is none.

        >>> palmistry.System.read("nowhere.proof")
        Traceback (most recent call last):
        palmistry.errors.ReadError: nowhere.proof:1:1: cannot read nowhere.proof: No such file or directory (os error 2)
        """
        return System(_native.System.read(os.fspath(path)))

    @staticmethod
    def parse(text: str, name: str = "the text", folder: str | os.PathLike[str] = "") -> System:
        """Reads a system from a text; what it imports is looked for in `folder`. Raises ReadError, with the place.

        >>> palmistry.System.parse('system "A decay" state x drift f x\\' = -x output x')
        <system 'A decay': 1 state, 1 output, 0 claims>
        """
        return System(_native.System.parse(text, name, os.fspath(folder)))

    @staticmethod
    def from_sympy(states: Iterable[Any], fields: Any, outputs: Any, **options: Any) -> System:
        """The system of SymPy's expressions; the arguments are those of `palmistry.from_sympy`, which returns the text of the proof file.

        >>> import sympy
        >>> x, k = sympy.symbols("x k")
        >>> palmistry.System.from_sympy([x], [-k*x], [x], unknown=[k]).unknowns
        ['x', 'k']
        """
        from .translation import from_sympy

        return System.parse(from_sympy(states, fields, outputs, **options), "SymPy's system")

    @staticmethod
    def from_casadi(states: Any, fields: Any, outputs: Any, **options: Any) -> System:
        """The system of CasADi's expressions; the arguments are those of `palmistry.from_casadi`, which returns the text of the proof file.

        >>> import casadi
        >>> x, k = casadi.SX.sym("x"), casadi.SX.sym("k")
        >>> palmistry.System.from_casadi(x, -k*x, x, unknown=[k]).unknowns
        ['x', 'k']
        """
        from .translation import from_casadi

        return System.parse(from_casadi(states, fields, outputs, **options), "CasADi's system")

    @staticmethod
    def from_function(rates: Callable[..., Any], outputs: Callable[..., Any], **options: Any) -> System:
        """The system of two Python functions, `f(x, p, u)` and `h(x, p, u)`; the arguments are those of `palmistry.from_function`.

        >>> import numpy, palmistry
        >>> def f(x, p):
        ...     return [x.omega, -p.k * numpy.sin(x.phi)]
        >>> palmistry.System.from_function(f, lambda x: x.phi, states="phi, omega", parameters="k", unknown="k").unknowns
        ['phi', 'omega', 'k']
        """
        from .traced import from_function

        return System.parse(from_function(rates, outputs, **options), "the functions' system")

    @property
    def title(self) -> str:
        return self._native.title

    @property
    def name(self) -> str:
        """The name of the file."""
        return self._native.name

    @property
    def source(self) -> str:
        """The text of the file."""
        return self._native.source

    @property
    def states(self) -> list[str]:
        """The names of the states, in the order of the file: the columns of a codistribution, but for those that are known."""
        return self._native.states

    @property
    def parameters(self) -> list[str]:
        """All other symbols."""
        return self._native.parameters

    @property
    def unknowns(self) -> list[str]:
        """What observability and identifiability are asked of: states, and parameters that are to be identified."""
        return self._native.unknowns

    @property
    def fields(self) -> dict[str, str]:
        """The vector fields with their roles: 'drift', 'input', or 'field' for one that moves nothing."""
        return dict(self._native.fields)

    @property
    def outputs(self) -> list[str]:
        """The outputs as they are written."""
        return self._native.outputs

    @property
    def claims(self) -> list[str]:
        """The ids of the claims."""
        return self._native.claims

    def unit(self, name: str) -> str | None:
        """The unit of a symbol; None where the file says nothing of it.

        >>> palmistry.System.parse('system "s" state x : length drift f x\\' = 0 output x').unit("x")
        'm'
        """
        return self._native.unit(name)

    def prove(self, only: str | Iterable[str] = (), seed: int = 1, *, evidence: bool = False) -> Claims:
        """Decides the claims: each is proved, refuted with a witness, or undecided.

        only: ids, parts of ids before a dot, or patterns with '*'. seed: of the random points. evidence: keep what the verdicts rest on, for `Claims.evidence` and `Claims.recheck`.

        >>> [(claim.id, claim.verdict) for claim in rod.prove()]
        [('motion', 'proved'), ('observable', 'proved'), ('sign', 'refuted')]
        """
        return _asked(Claims, lambda: self._native.prove(_several(only), seed, evidence))

    def rank(
        self,
        samples: int | None = None,
        *,
        seed: int = 1,
        at: At = None,
        where: str | Iterable[str] = (),
        order: int | None = None,
        verdict: str = "certified",
        digits: int | None = None,
        table: bool = False,
        coordinates: bool = False,
        times: bool = True,
    ) -> Rank:
        """The rank of the observability codistribution, generically and at sampled states.

        samples: how many states are drawn; by default 1000 where the Lie derivatives are short, else none. seed: of these states.
        at: states and parameters with fixed values, angles in radians. where: conditions, as 'sin(phi) = 0' or '0 < x < 1'.
        order: Lie derivatives of exactly up to this order. verdict: 'certified' or 'computed'. digits: of the worst state's singular values.
        table: a row a state in `.states`; coordinates: these too. times: whether `seconds` are given, which no two runs have alike.

        >>> found = rod.rank(samples=100)
        >>> found.generic, found.histogram, found.certified
        (2, {2: 100}, 100)
        """
        asked = (samples, seed, _pairs(at), _several(where), order, _wanted(verdict), digits, times, table or coordinates, coordinates)
        return _asked(Rank, lambda: self._native.rank(*asked))

    def observability(self, *, globally: bool = False) -> Table:
        """Which states are observable: a row a state, name and verdict, generically; with `globally` also the number of solutions,
        values that give the same outputs (infinite: infinitely many, 0: undecided), and whether that is 'proved' or 'computed'.

        >>> import palmistry
        >>> tanks = palmistry.System.parse('''
        ...     system "Two tanks"
        ...     state a, b
        ...     param k unknown
        ...     drift f  a' = -k*a  b' = k*a
        ...     output a
        ... ''')
        >>> dict(zip(tanks.observability()["name"].tolist(), tanks.observability()["verdict"].tolist()))
        {'a': 'locally observable', 'b': 'unobservable'}
        """
        return self._of_kind("state", globally)

    def identifiability(self, *, globally: bool = False) -> Table:
        """Which unknown parameters are identifiable: a row a parameter, as `observability` of states.

        >>> import palmistry
        >>> system = palmistry.System.parse('system "s" state x param k unknown drift f x\\' = -k^2*x output x')
        >>> print(system.identifiability(globally=True))
        name  verdict               values  values_are
        k     locally identifiable  2       proved
        """
        return self._of_kind("parameter", globally)

    def _of_kind(self, kind: str, globally: bool) -> Table:
        import numpy

        found = self._generically().unknowns
        chosen = found["kind"] == kind
        columns = {name: found[name][chosen] for name in ("name", "verdict")}
        if globally:
            solutions = self.global_().unknowns
            places = [list(solutions["name"]).index(name) for name in columns["name"]]
            values = solutions["values"][places]
            unique = [verdict.replace("locally", "globally") if value == 1 else verdict for verdict, value in zip(columns["verdict"].tolist(), values)]
            columns |= {"verdict": numpy.array(unique), "values": values, "values_are": solutions["verdict"][places]}
        return Table(columns)

    def identifiable_functions(self, *, globally: bool = False, work: int | None = None) -> list[str] | None:
        """Functions of the unobservable unknowns that are locally identifiable, in the language; None where not all were found. Parameters that `rank` holds at the file's values have these values
        here; with what error probability each is proved is in `rank(samples=0).json`.

        globally: generators of all functions of the unknowns that have one value for given outputs, `palmistry rank --functions`; `global_(functions=True)` says how each is known. work: as there.

        >>> import palmistry
        >>> system = palmistry.System.parse('system "s" state x param a unknown, b unknown drift f x\\' = -a*b*x output x')
        >>> system.identifiable_functions(), system.unobservable_directions()
        (['a*b'], [{'a': 'a', 'b': '-b'}])
        >>> system = palmistry.System.parse('system "s" state x param a unknown, b unknown drift f x\\' = -(a + b)*x + a*b output x')
        >>> system.identifiable_functions(globally=True)
        ['x', 'a*b', 'a + b']
        """
        if globally:
            found = self.global_(work, functions=True).json["identifiable_functions"]
            return [function["function"] for function in found["functions"]] if found["generate_all"] else None
        return self._generically().identifiable_functions

    def unobservable_directions(self) -> list[dict[str, str]] | None:
        """Vector fields along which no output changes: of each its components by unknown, in the language; None where not all were found.

        >>> palmistry.System.parse('system "s" state a, b drift f a\\' = -a b\\' = a output a').unobservable_directions()
        [{'b': '1'}]
        """
        return self._generically().unobservable_directions

    def _generically(self) -> Rank:
        """What holds generically, where that is one answer."""
        found = self.rank(samples=0)
        if len(found.branches) > 1:
            raise Error(f"the initial conditions of the file have {len(found.branches)} branches, and each has an answer of its own", "ask rank(samples=0).branches")
        return found

    def singular_set(self, seed: int = 1) -> SingularSet:
        """The singular set: sets of rank-deficient states, each by its equations, with a proof that there are no others: `palmistry rank --singular-set`.

        >>> beacon = palmistry.System.parse('system "s" state x, y drift f others\\' = 0 output x^2 + y^2, x*y')
        >>> print(beacon.singular_set().text.splitlines()[2])
        rank at most 1 where x - y = 0 (error probability below 2^-113)
        """
        return _asked(SingularSet, lambda: _native.drops(self._native, seed))

    def global_(self, work: int | None = None, *, functions: bool = False) -> Solutions:
        """Whether each unknown is globally or locally identifiable (observable) or not: how many solutions it has, one, finitely many over the complex numbers, or infinitely many. For rational systems, generically.

        work: how much may be done, in products of residues; what takes more is undecided. functions: also generators of all identifiable functions.

        >>> square = palmistry.System.parse('system "s" state x param k unknown drift f x\\' = -k^2*x output x')
        >>> square.global_()
        <solutions: x 1, k 2>
        """
        return _asked(Solutions, lambda: _native.solutions(self._native, functions, work))

    def design(
        self, identify: str | Iterable[str] = (), *, globally: bool = False, by: str | Iterable[str] | None = None, measure: str | Iterable[str] | None = None, at_most: int = 3
    ) -> Designs:
        """What to measure or to know besides, so that unknowns become identifiable: all minimal sets of additions, smallest first. `palmistry advise --identify`.

        identify: the unknowns; all of them where none is named. globally: one value for each, and not finitely many. by: what may be added, of 'outputs', 'known', 'initial', 'inputs',
        'experiments'; all but 'initial' unless given. measure: expressions that can be measured; the states unless given. at_most: the largest number of additions in a set.

        >>> scaled = palmistry.System.parse('system "s" state x param k unknown, s unknown drift f x\\' = -k*x output s*x')
        >>> scaled.design("s").sets
        [[('output', 'x')], [('input', 'x')]]
        """
        return _asked(Designs, lambda: _native.design(self._native, _several(identify), globally, None if by is None else _several(by), None if measure is None else _several(measure), at_most))

    def accessible(self, samples: int | None = None, *, seed: int = 1, at: At = None, where: str | Iterable[str] = (), order: int | None = None) -> Accessibility:
        """Whether the drift and the inputs can move the state in every direction, by brackets. The arguments are those of `rank`.

        >>> cart = palmistry.System.parse('system "s" state x, v drift f x\\' = v v\\' = 0 input g x\\' = 0 v\\' = 1 output x')
        >>> print(cart.accessible(10).text.splitlines()[2])
        accessibility: generic rank 2 of 2 (certain)
        """
        return _asked(Accessibility, lambda: _native.accessible(self._native, samples, seed, _pairs(at), _several(where), order))

    def reparametrise(self, path: str | os.PathLike[str] | None = None) -> System:
        """The observable part of the system, as a system whose states are observable functions. Its claims, that it moves so and that the outputs are the same, are for `prove`.

        path: the proof file is written there too. This system has to come from a file, which the new one imports. Raises Error where all is observable already.

        >>> rod.reparametrise()
        Traceback (most recent call last):
        palmistry.errors.Error: 'the text' is no file, which the new system would import
        help: write the source into a file, and read that
        """
        return self._derived(lambda: _native.reparametrised(self._native), "the observable part", path)

    def reduce(
        self,
        fix: str | Iterable[str] = (),
        *,
        known: Mapping[str, Any] | Iterable[str] = (),
        undriven: Iterable[str] = (),
        drive: Mapping[str, str] | None = None,
        signals: Iterable[str] = (),
        tolerance: float | None = None,
        path: str | os.PathLike[str] | None = None,
    ) -> System:
        """The least model under conditions: without states that the conditions give, constants that are known, states on which no output depends, and of each conservation law one state. Its
        claims, that it is this system there, are for `prove`.

        fix: conditions such as `omega1 = 0`; each has to stay met along every field. known: states and unknown constants that are known, with values or without: a constant becomes a parameter, a
        state that moves an output. undriven: inputs that nothing drives. drive: what drives an input; the drift of the new system is f + u g. signals: parameters that are known signals.
        tolerance: terms of a rate go as well that together are at most this part of the median of its absolute values over the ranges of the file; how large they are at most is a claim.
        path: the proof file is written there too. This system has to come from a file, which the new one imports.

        >>> general = palmistry.System.read(pathlib.Path(ROOT, "proofs", "moll2002", "general.proof"))
        >>> fixed = general.reduce("omega1 = 0, omega2 = 0, alpha1 = 0, alpha2 = 0", known=["rho"])
        >>> fixed.states, fixed.prove().ok
        (['r1', 'r2', 'omega0', 's1', 's2'], True)
        """
        given = {name: None for name in known} if not isinstance(known, Mapping) else known
        pairs = [(name, None if value is None else _number(value)) for name, value in given.items()]
        conditions = [fix] if isinstance(fix, str) else list(fix)
        if tolerance is not None and not 0.0 < tolerance < 1.0:
            raise Error(f"the tolerance is {tolerance}", "give a part between 0 and 1, such as 1e-6")
        driven = list((drive or {}).items())
        return self._derived(
            lambda: _native.least_model(self._native, conditions, pairs, list(undriven), driven, list(signals), tolerance), "the least model", path
        )

    def _derived(self, made: Callable[[], str], name: str, path: str | os.PathLike[str] | None) -> System:
        """A system whose text imports this one's file; written, where there is a path, with that file as it is named from there."""
        if not os.path.isfile(self.name):
            raise Error(f"'{self.name}' is no file, which the new system would import", "write the source into a file, and read that")
        text = made()
        found = System.parse(text, name)
        if path is not None:
            here = os.path.relpath(self.name, os.path.dirname(os.path.abspath(path)))
            with open(path, "w", encoding="utf-8") as file:
                file.write(text.replace(f'"{self.name}"', f'"{here}"', 1))
        return found

    def trade(self, samples: int = 1000, *, seed: int = 1) -> Trade:
        """Measures speed against accuracy: number types, methods of differentiation and of deciding a rank, each at the same sampled states and compared with exact arithmetic there.

        samples: how many states are drawn from the sample box, at most 20000. Times are of this machine.

        >>> sorted({str(one) for one in rod.trade(4).table["number"]})[:2]
        ['double-double', 'f32']
        """
        if not 1 <= samples <= 20_000:
            raise Error(f"{samples} samples are not possible", "between 1 and 20000 are")
        return _asked(Trade, lambda: _native.trade(self._native, samples, seed))

    def stress(self, rows: str = "own", *, states: int = 10, samples: int = 200, seed: int = 1) -> Stress:
        """Tests number types at extreme states: how near to a singular set, at which scales, and in which units a rank is reported wrongly, beside the certified one.

        rows: 'own', the file's own matrix `rows` where it defines one, or 'full', the codistribution. states: on each set, from which lines go. samples: states of the sample box at which ranks
        are decided again in other units.

        >>> sorted(rod.stress(states=1, samples=2).pictures)
        ['conditioning', 'scaling']
        """
        if rows not in ("own", "full"):
            raise Error(f"'{rows}' are no rows", "it is 'own' or 'full'")
        if not (1 <= states <= 1000 and 1 <= samples <= 100_000):
            raise Error(f"{states} states and {samples} samples are not possible", "1 to 1000 states and 1 to 100000 samples are")
        return _asked(Stress, lambda: _native.stress(self._native, rows == "own", states, samples, seed))

    @property
    def formatted(self) -> str:
        """The text in its normal form: entries at the left edge and what belongs to them further in. No sign, no comment and no text in quotation marks is touched.

        >>> palmistry.System.parse('system "A decay" state x\\n  drift f\\n x\\' = -x\\noutput x').formatted.splitlines()[1:3]
        ['drift f', "  x' = -x"]
        """
        return _native.formatted(self.name, self.source)

    def eval(self, expression: str, at: At = None, digits: int = 20, verdict: str = "certified") -> Value:
        """The value of an expression of the language at a point, to `digits` significant decimal digits, all of them certain.

        at: values by name, angles in radians; what is left out has the value of the file. A float is taken for the decimal that Python prints.
        Raises EvaluationError where there is no value, ReadError where the expression is none.

        >>> print(rod.eval("L(f, f, phi)", at={"phi": "1/3"}))
        -0.65438939359230448835
        """
        if not 1 <= digits <= 10_000:
            raise Error(f"{digits} digits are not possible", "between 1 and 10000 are")
        return Value(self._native.eval(expression, _pairs(at), digits, _wanted(verdict)))

    def _decider(self, at: At, order: int | None, certified: bool = True) -> Any:
        key = (tuple(_pairs(at)), order, certified)
        if key not in self._deciders:
            self._deciders[key] = self._native.decider(list(key[0]), order, certified)
        return self._deciders[key]

    def coordinates(self, at: At = None, order: int | None = None) -> list[str]:
        """The coordinates that a state has in `verdicts`, in this order: states, and parameters without a value.

        >>> rod.coordinates()
        ['phi', 'omega']
        """
        return self._decider(at, order).coordinates

    def verdicts(
        self,
        states: numpy.ndarray | Mapping[str, Any] | Sequence[Any],
        *,
        at: At = None,
        order: int | None = None,
        verdict: str = "certified",
    ) -> Verdicts:
        """The rank at your own states, a block at a time, with the singular values: shape (states,) each.

        states: an array of shape (states, coordinates) with the columns of `coordinates()`, angles in radians; or arrays of shape (states,)
        by name, as a dict, a pandas.DataFrame or a structured array has them. Columns that are contiguous doubles are not copied: an array in
        Fortran's order, or arrays by name. verdict: what every rank has to be; the cheapest number type that suffices is used; a state
        that it does not decide escalates to a higher precision. A rank that is short is certified where the state is rational, that is where no sine of a double stands in the rows.
        at, order: as in `rank`. Whether a state lies in the sample box is not asked.

        >>> rod.verdicts(numpy.array([[0.1, 0.2], [3.0, -1.0]])).rank
        array([2, 2])
        """
        decider = self._decider(at, order, _wanted(verdict))
        return Verdicts(**decider.verdicts(_arrays(states, decider.coordinates)))

    def standard_deviations(
        self,
        states: numpy.ndarray | Mapping[str, Any] | Sequence[Any],
        *,
        at: At = None,
        order: int | None = None,
    ) -> Table:
        """How well each unknown is observable at your own states: its standard deviation, normalised by its prior one over the sample box.

        A column an unknown, of shape (states,); infinite where it is unobservable, or not distinguishable from it; NaN at a singularity. These are the
        numbers of the maps: every Lie derivative of up to `order` fields is measured up to the standard deviation of its values over the sample
        box. states, at: as in `verdicts`. Computed in doubles, and not certified.

        >>> rod.standard_deviations({"phi": numpy.array([0.1]), "omega": numpy.array([0.2])})["phi"].round(3)
        array([1.024])
        """
        names = self.coordinates(at, order)
        return Table(self._native.standard_deviations(_pairs(at), order, names, _arrays(states, names)))

    def map(self, x: str, y: str, *, ranges: Mapping[str, Any] | None = None, at: At = None, size: int | tuple[int, int] = 60, order: int | None = None) -> Map:
        """How well each unknown is observable over two coordinates, as `standard_deviations` has it.

        x, y: names of coordinates. ranges: of these, as (low, high); those of the file's sample box unless given. at: values of all other coordinates: none is chosen here, since round numbers
        are often where something special happens. size: of the grid, columns and rows.

        >>> rod.map("phi", "omega", size=(8, 5))
        <map over phi and omega: 5 x 8 states>
        """
        import numpy

        columns, rows = (size, size) if isinstance(size, int) else size
        given = dict(ranges or {})
        box = self._native.sample_box()
        grids = []
        for name, count in ((x, columns), (y, rows)):
            low, high = given.get(name, box.get(name, (-1.0, 1.0)))
            grids.append(numpy.linspace(float(low), float(high), count))
        needed = self.coordinates(at, order)
        for name in (x, y):
            if name not in needed:
                raise Error(f"'{name}' is no coordinate", f"these are {', '.join(needed)}")
        others = [name for name in needed if name not in (x, y)]
        if others:
            raise Error(f"{', '.join(others)} {'has' if len(others) == 1 else 'have'} no value", f"give one of each, as in at={{'{others[0]}': ...}}")
        xs, ys = (grid.ravel() for grid in numpy.meshgrid(*grids))
        states = {x: xs, y: ys}
        found = self.standard_deviations({name: states[name] for name in needed}, at=at, order=order)
        return Map(x, y, (grids[0], grids[1]), {name: found[name].reshape(rows, columns) for name in found}, _pairs(at))

    def certify(
        self,
        *,
        box: Mapping[str, Any] | str | None = None,
        boxes: int | None = None,
        budget: float = 10.0,
        rows: str = "codistribution",
        order: int | None = None,
        map: tuple[str, str] | None = None,
    ) -> Certificate:
        """Proves full rank on boxes of states, and says on which part of the sample box.

        box: other ranges by name, as (low, high); one number holds it fixed. boxes: look at so many boxes, which gives the same result everywhere;
        otherwise for `budget` seconds. rows: 'codistribution' or 'own', the file's matrix of that name. order: as in `rank`.
        map: the two coordinates of the picture.

        >>> rod.certify(boxes=10)
        <full rank proved on 1 of the box>
        """
        if rows not in ("codistribution", "own"):
            raise Error(f"'{rows}' are no rows", "these are 'codistribution' and 'own'")
        if rows == "own" and order is not None:
            raise Error("the file's own rows have no order", "leave out order, or rows='own'")
        if not 0 < budget < float("inf"):
            raise Error("the budget is a positive number of seconds")
        asked = (_ranges(box), boxes, float(budget), rows == "own", order, map)
        return _asked(Certificate, lambda: self._native.certify(*asked))

    def __repr__(self) -> str:
        counts = ((len(of), noun) for of, noun in ((self.states, "state"), (self.outputs, "output"), (self.claims, "claim")))
        return f"<system '{self.title}': {', '.join(f'{count} {noun}' + 's' * (count != 1) for count, noun in counts)}>"


def _arrays(states: Any, names: list[str]) -> list[Any]:
    """The columns of some states, as contiguous doubles of one length."""
    import numpy

    if not names:
        raise Error("every coordinate has one value, and there are no states to look at", "ask rank()")
    columns = [numpy.ascontiguousarray(column, dtype=numpy.float64) for column in _columns(states, names)]
    for name, column in zip(names, columns):
        if column.ndim != 1:
            raise Error(f"the values of '{name}' have shape {column.shape}", "one value a state is needed: shape (states,)")
        if column.shape != columns[0].shape:
            raise Error(f"there are {len(column)} values of '{name}' and {len(columns[0])} of '{names[0]}'", "one value a state is needed")
    return columns


def _columns(states: Any, names: list[str]) -> list[Any]:
    """The columns of some states, in the order of names."""
    import numpy

    named = getattr(getattr(states, "dtype", None), "names", None)  # a structured array
    if named is None and isinstance(states, Mapping):
        named = list(states)
    if named is None and hasattr(states, "columns") and hasattr(states, "loc"):
        named = list(states.columns)  # a DataFrame
    if named is not None:
        missing = [name for name in names if name not in named]
        beside = [name for name in named if name not in names]
        if missing:
            raise Error(f"there are no values of {', '.join(missing)}", f"the coordinates are {', '.join(names)}")
        if beside:
            raise Error(
                f"a state has no coordinate {', '.join(map(str, beside))}",
                f"the coordinates are {', '.join(names)}; others have one value, which `at` changes",
            )
        return [numpy.asarray(states[name]) for name in names]
    array = numpy.asarray(states)
    if array.ndim != 2 or array.shape[1] != len(names):
        raise Error(f"the states have shape {array.shape}", f"needed is (states, {len(names)}), with the columns {', '.join(names)}")
    return [array[:, place] for place in range(len(names))]


def recheck_file(path: str | os.PathLike[str], *, proofs: str | os.PathLike[str] = ".", seed: int = 1) -> Recheck:
    """The verdicts of a file, evaluated again by the small checker that shares nothing with the engines: `palmistry recheck`. Another one, which shares nothing with the program, is
    `python -m palmistry.recheck`.

    proofs: the folder from which the names of proof files are read. seed: of the states at which proofs are tried. `Claims.recheck` does the same of what `prove` has found.

    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "rod.proof")
    ...     _ = file.write_text(rod.source)
    ...     verdicts = pathlib.Path(folder, "verdicts.json")
    ...     _ = verdicts.write_text(palmistry.System.read(file).prove(evidence=True).evidence)
    ...     palmistry.recheck_file(verdicts, proofs="/").ok
    True
    """
    return _asked(Recheck, lambda: _native.recheck_file(os.fspath(path), os.fspath(proofs), seed))


def rechecked(text: str, proofs: str | os.PathLike[str], seed: int) -> Recheck:
    return _asked(Recheck, lambda: _native.recheck(text, os.fspath(proofs), seed))


def threads(count: int | None) -> None:
    """From now on so many threads share the work of each question; None leaves it to RAYON_NUM_THREADS and the machine. No answer depends on it.

    >>> palmistry.threads(1)
    >>> palmistry.threads(None)
    """
    if count is not None and count < 1:
        raise Error(f"{count} threads cannot work", "one or more can; None takes all processors")
    _native.set_threads(count or 0)


def import_model(
    path: str | os.PathLike[str],
    *,
    format: str | None = None,
    model: str | int | None = None,
    outputs: str | Iterable[str] = (),
    unknown: str | Iterable[str] | None = None,
    inputs: str | Iterable[str] = (),
    unknown_inputs: str | Iterable[str] = (),
    states: str | Iterable[str] = (),
) -> System:
    """The system of a model file of another program: Julia (StructuralIdentifiability.jl, ModelingToolkit.jl), SBML, StrikePy, STRIKE-GOLDD, or formulas that SymPy or CasADi printed.

    Nothing of the file is executed. format: 'julia', 'sbml', 'strikepy', 'strike-goldd' or 'formulas', recognised unless given. model: which of several, by name or number. outputs: in place of
    those of the file. unknown: parameters that are to be identified, 'all', or [] for none; what the file says unless given. inputs, unknown_inputs: parameters that are signals which
    are known, or unknown. states: in the order of a vector of rates. What was renamed and what else is worth knowing stands in comments of `source`.

    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "decay.txt")
    ...     _ = file.write_text("x' = -k*x")
    ...     palmistry.import_model(file, outputs="x", unknown="k").unknowns
    ['x', 'k']
    """
    asked = (format, None if model is None else str(model), _several(outputs), None if unknown is None else _several(unknown), _several(inputs), _several(unknown_inputs), _several(states))
    proof, _, _, _ = _native.imported(os.fspath(path), *asked)
    return System.parse(proof, os.fspath(path))


def import_problem(path: str | os.PathLike[str], out: str | os.PathLike[str]) -> pathlib.Path:
    """Writes a problem of parameter estimation, in the format PEtab (version 1), as a proof file, a scene and measurements; the path of the scene, for `observe`.

    path: the problem (.yaml); the files that it names lie beside or below it. Nothing of them is executed. out: NAME.toml; beside it NAME.proof and NAME.csv are written.

    >>> with tempfile.TemporaryDirectory() as folder:
    ...     scene = palmistry.import_problem(problem, pathlib.Path(folder, "hiv.toml"))
    ...     found = palmistry.observe(scene)
    >>> found.estimates["name"].tolist(), found.estimates["estimate"].round(2).tolist()
    (['c', 'delta', 'sd_task0_model0_perelson1_V'], [1.86, 0.55, 0.12])
    """
    scene = pathlib.Path(out).with_suffix(".toml")
    proof, text, measurements, _, _ = _native.imported_problem(os.fspath(path), scene.stem)
    for end, content in ((".proof", proof), (".csv", measurements), (".toml", text)):
        scene.with_suffix(end).write_text(content, encoding="utf-8")
    return scene


def verify(folder: str | os.PathLike[str], *, seed: int = 1, times: bool = True) -> Page:
    """Checks a whole paper, a folder or one proof file, and makes a page; `.json` is what was found.

    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "rod.proof")
    ...     _ = file.write_text(rod.source)
    ...     page = palmistry.verify(file)
    >>> page.html.startswith("<!DOCTYPE html>")
    True
    """
    import json

    found, page = _native.verify(os.fspath(folder), seed, times)
    return Page(page, json.loads(found))


def latex(text: str) -> str | None:
    """An expression or a statement of the language in LaTeX; None where the text is neither.

    >>> palmistry.latex("sin(phi)^2/2")
    '\\\\frac{\\\\sin^{2}\\\\left(\\\\varphi\\\\right)}{2}'
    """
    return _native.latex(text)
