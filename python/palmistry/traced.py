"""Systems that are given by Python functions: these are called once with symbols, and what they return is what they calculate."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from . import terms
from .errors import Error
from .terms import Term
from .translation import Options, Parts, assembled

#: Functions that numpy calls on what is no number, by the names of its methods, with those of the language.
FUNCTIONS = {
    "sin": "sin", "cos": "cos", "tan": "tan", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "sinh": "sinh", "cosh": "cosh",
    "tanh": "tanh", "exp": "exp", "log": "log", "sqrt": "sqrt",
}  # fmt: skip


class Traced:
    """A symbol, or what was calculated with symbols.

    Sums, products, quotients, powers, `abs` and the functions of numpy (`numpy.sin(x)`) are written down; so is what SymPy makes of it. A comparison has no value here, and
    neither has what wants a number, such as `math.sin(x)`.
    """

    def __init__(self, term: Term, names: frozenset[str], name: str | None = None) -> None:
        self.term = term
        self.names = names
        self.name = name

    @staticmethod
    def symbol(name: str) -> Traced:
        return Traced(terms.name(name), frozenset([name]), name)

    @staticmethod
    def of(value: Any) -> Traced:
        if isinstance(value, Traced):
            return value
        if hasattr(value, "free_symbols"):
            from . import sympy_terms

            names = frozenset(sympy_terms.name_of(symbol) for symbol in value.free_symbols)
            return Traced(sympy_terms.term(value, lambda name: name), names)
        return Traced(terms.number(value), frozenset())

    def _with(self, make: Callable[..., Term], *others: Any) -> Any:
        try:
            of = [self, *map(Traced.of, others)]
        except Error:
            return NotImplemented
        return Traced(make(*(one.term for one in of)), frozenset().union(*(one.names for one in of)))

    def _sympy_(self) -> Any:
        """What SymPy takes for it: a symbol alone."""
        import sympy

        if self.name is None:
            raise Error(f"'{self.term.text}' is not SymPy's", "calculate with SymPy's functions throughout, or with numpy's")
        return sympy.Symbol(self.name)

    def _foreign(self, other: Any) -> bool:
        """Whether SymPy is to calculate."""
        return hasattr(other, "free_symbols")

    def __add__(self, other: Any) -> Any:
        return NotImplemented if self._foreign(other) and self.name else self._with(lambda a, b: terms.total([a, b]), other)

    def __radd__(self, other: Any) -> Any:
        return self._with(lambda a, b: terms.total([b, a]), other)

    def __sub__(self, other: Any) -> Any:
        return NotImplemented if self._foreign(other) and self.name else self._with(_difference, other)

    def __rsub__(self, other: Any) -> Any:
        return self._with(lambda a, b: _difference(b, a), other)

    def __mul__(self, other: Any) -> Any:
        return NotImplemented if self._foreign(other) and self.name else self._with(lambda a, b: terms.product([a, b]), other)

    def __rmul__(self, other: Any) -> Any:
        return self._with(lambda a, b: terms.product([b, a]), other)

    def __truediv__(self, other: Any) -> Any:
        return NotImplemented if self._foreign(other) and self.name else self._with(lambda a, b: terms.product([a], [b]), other)

    def __rtruediv__(self, other: Any) -> Any:
        return self._with(lambda a, b: terms.product([b], [a]), other)

    def __pow__(self, other: Any) -> Any:
        return NotImplemented if self._foreign(other) and self.name else self._with(_power, other)

    def __rpow__(self, other: Any) -> Any:
        return self._with(lambda a, b: _power(b, a), other)

    def __neg__(self) -> Any:
        return self._with(terms.negative)

    def __pos__(self) -> Any:
        return self

    def __abs__(self) -> Any:
        return self._with(lambda a: terms.call("abs", a))

    def __getattr__(self, name: str) -> Any:
        if name in FUNCTIONS:
            return lambda: self._with(lambda a: terms.call(FUNCTIONS[name], a))
        raise AttributeError(f"'{self.term.text}' is an expression, and has no '{name}'")

    def __float__(self) -> float:
        raise Error(f"'{self.term.text}' is no number here", "use numpy's or SymPy's functions, as in numpy.sin(x), and not those of math")

    def __bool__(self) -> bool:
        raise Error("a function that is traced has no branches: no comparison of states has a value", "use abs, min and max of the language, or one system for each branch")

    def __lt__(self, other: Any) -> Any:
        return bool(self)

    __le__ = __gt__ = __ge__ = __lt__

    def __eq__(self, other: Any) -> Any:
        # an equality that were silently false would take a branch in silence
        return bool(self)

    __ne__ = __eq__
    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return self.term.text


def _difference(a: Term, b: Term) -> Term:
    # of a number below zero its size is added
    return terms.total([a, Term(b.text[1:], terms.PRIMARY) if b.text.startswith("-") and b.text[1:].replace(".", "").isdigit() else terms.negative(b)])


def _power(base: Term, exponent: Term) -> Term:
    if exponent.text in ("0.5", "1/2"):
        return terms.call("sqrt", base)
    if exponent.text.startswith("-") and exponent.text[1:].isdigit():
        below = base if exponent.text == "-1" else terms.power(base, Term(exponent.text[1:], terms.PRIMARY))
        return terms.product([], [below])
    return terms.power(base, exponent)


class Symbols(Sequence):
    """Symbols by their place (`x[0]`), by their name (`x.phi`, `x["phi"]`), or one after the other (`phi, omega = x`)."""

    def __init__(self, names: Iterable[str]) -> None:
        self._all = {name: Traced.symbol(name) for name in names}

    def __getitem__(self, place: Any) -> Any:
        if isinstance(place, str):
            return self._all[place]
        return list(self._all.values())[place]

    def __len__(self) -> int:
        return len(self._all)

    def __getattr__(self, name: str) -> Any:
        found = self.__dict__.get("_all", {}).get(name)
        if found is None:
            raise AttributeError(f"there is no '{name}'; there are {', '.join(self.__dict__.get('_all', {}))}")
        return found


def _called(function: Callable[..., Any], given: Sequence[Symbols]) -> Any:
    """What a function of x, of x and p, or of x, p and u returns."""
    try:
        takes = [p for p in inspect.signature(function).parameters.values() if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
        needed = len([p for p in takes if p.default is p.empty])
    except (TypeError, ValueError):
        needed = len(given)
    if not 1 <= needed <= len(given):
        raise Error(f"the function takes {needed} arguments", "it is a function of x, of x and p, or of x, p and u: states, parameters, inputs")
    return function(*given[:needed])


def _entries(found: Any) -> list[Any]:
    """The expressions of a list, a tuple, an array or a matrix; a single one is one."""
    if hasattr(found, "tolist"):
        found = found.tolist()
    if not isinstance(found, (list, tuple)):
        return [found]
    return [entry for part in found for entry in _entries(part)]


def from_function(
    rates: Callable[..., Any],
    outputs: Callable[..., Any],
    *,
    states: Iterable[str] | str,
    parameters: Mapping[str, Any] | Iterable[str] | str = (),
    inputs: Iterable[str] | str = (),
    unknown: Iterable[str] | str = (),
    title: str = "A system from a Python function",
    angles: Iterable[str] | str = (),
    sample: Mapping[str, Any] | None = None,
    claims: Mapping[str, str] | None = None,
) -> str:
    """The text of a proof file for a system that is given by Python functions of states x, parameters p and inputs u.

    rates: `f(x)`, `f(x, p)` or `f(x, p, u)` returns the rates of the states, in their order, or a dict of them by name. outputs: `h` likewise returns the outputs, a list, or a dict by
    name. Both are called once, with symbols: x, p and u have their symbols by place, by name and as attributes. states, parameters, inputs: names, as a list or a text ("phi, omega");
    parameters may have values, as in {"k": 2}. inputs are signals that are known. unknown: parameters that are to be identified. angles, sample, claims: as in `from_sympy`.

    >>> import numpy, palmistry
    >>> def f(x, p):
    ...     return [x.omega, -p.k * numpy.sin(x.phi)]
    >>> print(palmistry.from_function(f, lambda x: x.phi, states="phi, omega", parameters="k", unknown="k"))
    system "A system from a Python function"
    <BLANKLINE>
    state phi, omega
    param k unknown
    <BLANKLINE>
    drift f
      phi'   = omega
      omega' = -k*sin(phi)
    <BLANKLINE>
    output phi
    <BLANKLINE>
    """
    states, inputs, unknown, angles = map(_names, (states, inputs, unknown, angles))
    if not states:
        raise Error("there are no states", "name them, as in states='phi, omega'")
    values = dict(parameters) if isinstance(parameters, Mapping) else dict.fromkeys(_names(parameters))
    for name in unknown:
        values.setdefault(name, None)
    given = [Symbols(states), Symbols(values), Symbols(inputs)]
    found = _called(rates, given)
    seen = _called(outputs, given)
    # the drift is called as no symbol is
    drift = next(name for name in ("f", *(f"f{number}" for number in range(1, len(states) + len(values) + len(inputs) + 2))) if name not in {*states, *values, *inputs})
    parts = Parts(
        states,
        {drift: found if isinstance(found, Mapping) else _entries(found)},
        seen if isinstance(seen, Mapping) else _entries(seen),
        drift,
        str,
        lambda listed: list(listed),
    )
    traced = [Traced.of(value) for value in [*parts.fields[drift], *parts.outputs]]
    beside = sorted(frozenset().union(*(one.names for one in traced)) - {*states, *values, *inputs})
    if beside:
        raise Error(f"'{beside[0]}' is neither a state nor a parameter nor an input", f"name it among them: states are {', '.join(states)}")
    options = Options(title, drift, values, unknown, inputs, angles, sample, claims)

    def reader(ours: Callable[[str], str]) -> Callable[[Any], Term]:
        changed = [name for name in [*states, *values, *inputs] if ours(name) != name]
        if changed:
            raise Error(f"'{changed[0]}' is no name of the language", f"call it '{ours(changed[0])}'")
        return lambda value: Traced.of(value).term

    return assembled(parts, options, [*values], reader, lambda: [])


def _names(given: Iterable[str] | str) -> list[str]:
    return [name.strip() for name in given.split(",") if name.strip()] if isinstance(given, str) else list(given)
