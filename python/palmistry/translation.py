"""Systems that are given by SymPy's or CasADi's expressions, as proof files: nobody types twice."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from . import terms
from .errors import Error
from .proof_text import Model
from .terms import Term

#: An expression of the other program as a term of the language.
Reader = Callable[[Any], Term]


class Parts:
    """What both programs hand over, in the same form: the states as they are called, and lists of expressions."""

    def __init__(
        self,
        states: Any,
        fields: Any,
        outputs: Any,
        drift: str | None,
        name_of: Callable[[Any], str],
        entries: Callable[[Any], list[Any]],
    ) -> None:
        self.name_of = name_of
        self.states = entries(states)
        self.foreign_states = [name_of(state) for state in self.states]
        if not self.states:
            raise Error("there are no states")
        repeated = {name for name in self.foreign_states if self.foreign_states.count(name) > 1}
        if repeated:
            raise Error(f"two states are called {', '.join(sorted(repeated))}")
        named = isinstance(fields, Mapping) and all(isinstance(key, str) for key in fields)
        self.fields: dict[str, list[Any]] = {}
        for name, rates in fields.items() if named else [(drift or "f", fields)]:
            self.fields[name] = self._rates(name, rates, entries)
        if drift is not None and drift not in self.fields:
            message = f"there is no field '{drift}' to be the drift, but {', '.join(self.fields)}"
            raise Error(message, "name it with drift='...'; with drift=None all fields are inputs")
        self.output_names = [str(name) for name in outputs] if isinstance(outputs, Mapping) else None
        self.outputs = list(outputs.values()) if isinstance(outputs, Mapping) else entries(outputs)
        if not self.outputs:
            raise Error("there are no outputs")

    def _rates(self, name: str, rates: Any, entries: Callable[[Any], list[Any]]) -> list[Any]:
        """The rates of a field, one a state."""
        if isinstance(rates, Mapping):
            by_name = {key if isinstance(key, str) else self.name_of(key): rate for key, rate in rates.items()}
            beside = [key for key in by_name if key not in self.foreign_states]
            if beside:
                raise Error(f"the field '{name}' moves {', '.join(beside)}, which is no state")
            return [by_name.get(state, 0) for state in self.foreign_states]
        found = entries(rates)
        if len(found) != len(self.foreign_states):
            raise Error(f"the field '{name}' has {len(found)} rates, and there are {len(self.foreign_states)} states")
        return found


class Options:
    """What is said beside states, fields and outputs."""

    def __init__(
        self,
        title: str,
        drift: str | None,
        parameters: Mapping[Any, Any] | None,
        unknown: Iterable[Any],
        known: Iterable[Any],
        angles: Iterable[Any],
        sample: Mapping[Any, Any] | None,
        claims: Mapping[str, str] | None,
    ) -> None:
        self.title = title
        self.drift = drift
        self.parameters = dict(parameters or {})
        self.unknown = list(unknown)
        self.known = list(known)
        self.angles = list(angles)
        self.sample = dict(sample or {})
        self.claims = dict(claims or {})


def assembled(parts: Parts, options: Options, symbols: list[str], reader: Callable[[Callable[[str], str]], Reader], definitions: Callable[[], list[tuple[str, Term]]]) -> str:
    """The proof file. `symbols` are the names of all that expressions mention; `reader` reads an expression, given what a name is called
    in the language; `definitions` are the abbreviations that reading has made."""
    from . import _native

    def called(symbol: Any) -> str:
        return symbol if isinstance(symbol, str) else parts.name_of(symbol)

    signals = [called(symbol) for symbol in options.known]
    values = {called(symbol): value for symbol, value in options.parameters.items()}
    unknown = [called(symbol) for symbol in options.unknown]
    others = [name for name in dict.fromkeys([*symbols, *values, *unknown]) if name not in parts.foreign_states and name not in signals]
    foreign = list(dict.fromkeys([*parts.foreign_states, *others, *signals, *parts.fields, *(parts.output_names or [])]))
    clashes = set(parts.fields) & {*parts.foreign_states, *others, *signals}
    if clashes:
        raise Error(f"a field and a symbol are called {', '.join(sorted(clashes))}", "give the field another name")
    ours = dict(zip(foreign, _native.our_names(foreign)))

    def our(symbol: Any) -> str:
        name = called(symbol)
        if name not in ours or name in parts.fields:
            raise Error(f"'{name}' is no symbol of the system", f"these are {', '.join([*parts.foreign_states, *others, *signals])}")
        return ours[name]

    for name in [*signals, *unknown, *values]:
        if name in parts.foreign_states:
            raise Error(f"'{name}' is a state", "signals and parameters are other symbols")
    read = reader(lambda name: ours[name])
    fields = []
    for name, rates in parts.fields.items():
        role = "drift" if name == options.drift else "input"
        fields.append((role, ours[name], [read(rate) for rate in rates]))
    fields.sort(key=lambda one: one[0] != "drift")
    outputs = [read(output) for output in parts.outputs]
    named: list[tuple[str, Term]] = []
    if parts.output_names is not None:
        for place, name in enumerate(parts.output_names):
            # an output that is called as the state that it is needs no abbreviation
            if outputs[place].text != ours[name]:
                if name in parts.foreign_states or name in others or name in signals:
                    raise Error(f"an output and a symbol are called '{name}'", "give the output another name")
                named.append((ours[name], outputs[place]))
                outputs[place] = terms.name(ours[name])
    return Model(
        title=options.title,
        states=[ours[name] for name in parts.foreign_states],
        parameters={ours[name]: None if values.get(name) is None else terms.number(values[name]) for name in others},
        unknown={ours[name] for name in unknown},
        signals=[ours[name] for name in signals],
        angles=[our(symbol) for symbol in options.angles],
        definitions=[*definitions(), *named],
        fields=fields,
        outputs=outputs,
        sample={our(symbol): (terms.number(low), terms.number(high)) for symbol, (low, high) in options.sample.items()},
        claims=options.claims,
    ).text()


def from_sympy(
    states: Iterable[Any],
    fields: Any,
    outputs: Any,
    *,
    title: str = "A system from SymPy",
    drift: str | None = "f",
    parameters: Mapping[Any, Any] | None = None,
    unknown: Iterable[Any] = (),
    known: Iterable[Any] = (),
    angles: Iterable[Any] = (),
    sample: Mapping[Any, Any] | None = None,
    claims: Mapping[str, str] | None = None,
) -> str:
    """The text of a proof file for a system that is given by SymPy's expressions.

    states: symbols, or functions of time such as `Function("x")(t)`. fields: the rates of the drift, a list or matrix with one a state or a dict by
    state; or a dict of such by name, of which the one called `drift` is the drift and all others are inputs (all of them with `drift=None`). outputs: a list, or a dict by name.
    parameters: values of constants; all symbols that are no states are constants, with a value or without. unknown: constants that are to be
    identified. known: signals that are known, as inputs that enter otherwise than linearly. angles: states in radians that are met inside sines and
    cosines only. sample: ranges, by symbol, as (low, high). claims: statements of the language, by id. A Float is the decimal that SymPy prints.
    Raises Error where an expression has no counterpart in the language.

    >>> import sympy
    >>> x, k = sympy.symbols("x k")
    >>> print(palmistry.from_sympy([x], [-k*x], [x], unknown=[k]).splitlines()[3])
    param k unknown
    """
    from . import sympy_terms

    options = Options(title, drift, parameters, unknown, known, angles, sample, claims)
    parts = Parts(states, fields, outputs, drift, sympy_terms.name_of, sympy_terms.entries)
    symbols = sympy_terms.symbols_of(parts, [*options.known, *options.unknown, *options.parameters])
    return assembled(parts, options, symbols, lambda ours: lambda e: sympy_terms.term(e, ours), lambda: [])


def from_casadi(
    states: Any,
    fields: Any,
    outputs: Any,
    *,
    title: str = "A system from CasADi",
    drift: str | None = "f",
    parameters: Mapping[Any, Any] | None = None,
    unknown: Iterable[Any] = (),
    known: Iterable[Any] = (),
    angles: Iterable[Any] = (),
    sample: Mapping[Any, Any] | None = None,
    claims: Mapping[str, str] | None = None,
) -> str:
    """The text of a proof file for a system that is given by CasADi's expressions, SX or MX.

    The arguments are those of `from_sympy`; lists may be column vectors, and a symbol that is a vector `x` has the components `x_0`, `x_1`, ... What
    an expression uses more than once becomes an abbreviation. Symbols may be named by texts as well.

    >>> import casadi
    >>> x = casadi.SX.sym("x")
    >>> print(palmistry.from_casadi(x, -x, x).splitlines()[2])
    state x
    """
    from . import casadi_terms

    options = Options(title, drift, parameters, unknown, known, angles, sample, claims)
    tape = casadi_terms.Tape(states, fields, outputs)
    parts = Parts(states, tape.fields, tape.outputs, drift, casadi_terms.name_of, tape.entries)
    return assembled(parts, options, tape.symbols, tape.reader, tape.definitions)
