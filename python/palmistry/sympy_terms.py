"""SymPy's expressions as terms of the language."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import sympy
from sympy.core.function import AppliedUndef

from . import terms
from .errors import Error
from .terms import Term

#: Functions that the language has, by their names there.
SAME = {
    sympy.sin: "sin", sympy.cos: "cos", sympy.tan: "tan", sympy.cot: "cot", sympy.sec: "sec", sympy.csc: "csc",
    sympy.asin: "asin", sympy.acos: "acos", sympy.atan: "atan", sympy.atan2: "atan2", sympy.sinh: "sinh", sympy.cosh: "cosh",
    sympy.tanh: "tanh", sympy.exp: "exp", sympy.log: "log", sympy.Abs: "abs", sympy.sign: "sign", sympy.Min: "min", sympy.Max: "max",
}  # fmt: skip

#: Functions that are made of others.
MADE: dict[Any, Callable[[Any], Any]] = {
    sympy.sech: lambda x: 1 / sympy.cosh(x),
    sympy.csch: lambda x: 1 / sympy.sinh(x),
    sympy.coth: lambda x: 1 / sympy.tanh(x),
    sympy.asec: lambda x: sympy.acos(1 / x),
    sympy.acsc: lambda x: sympy.asin(1 / x),
    sympy.acot: lambda x: sympy.atan(1 / x),
    sympy.asinh: lambda x: sympy.log(x + sympy.sqrt(x**2 + 1)),
    sympy.acosh: lambda x: sympy.log(x + sympy.sqrt(x**2 - 1)),
    sympy.atanh: lambda x: sympy.log((1 + x) / (1 - x)) / 2,
}


def entries(listed: Any) -> list[Any]:
    """The expressions of a list, a tuple or a matrix; a single one is one."""
    if isinstance(listed, sympy.MatrixBase):
        return list(listed)
    if isinstance(listed, (str, sympy.Basic)) and not isinstance(listed, sympy.Tuple):
        return [listed]
    return [entry for part in listed for entry in (entries(part) if isinstance(part, (list, tuple)) else [part])]


def name_of(symbol: Any) -> str:
    """What a symbol, or a function of time, is called."""
    if isinstance(symbol, sympy.Symbol):
        return symbol.name
    if isinstance(symbol, AppliedUndef) and len(symbol.args) == 1:
        return symbol.func.__name__
    raise Error(f"{symbol} is neither a symbol nor a function of time", "as in Symbol('x') or Function('x')(t)")


def symbols_of(parts: Any, more: Iterable[Any]) -> list[str]:
    """The names of all symbols of a system, in the order of the alphabet; time is none that may be mentioned outside of its functions."""
    named: dict[str, Any] = {}
    expressions = [*parts.states, *(rate for rates in parts.fields.values() for rate in rates), *parts.outputs, *(s for s in more if not isinstance(s, str))]
    for expression in map(sympy.sympify, expressions):
        functions = expression.atoms(AppliedUndef)
        bare = expression.xreplace({function: sympy.Dummy() for function in functions})
        for symbol in [*functions, *(s for s in bare.free_symbols if not isinstance(s, sympy.Dummy))]:
            other = named.setdefault(name_of(symbol), symbol)
            if other != symbol:
                raise Error(f"two symbols are called '{name_of(symbol)}', with other assumptions or another time", "make it once, and use that one")
    return sorted(named)


def term(expression: Any, ours: Callable[[str], str]) -> Term:
    """An expression as a term; `ours` says what a symbol is called in the language."""

    def of(e: Any) -> Term:
        if isinstance(e, (sympy.Symbol, AppliedUndef)):
            return terms.name(ours(name_of(e)))
        if e.is_Rational or e.is_Float:
            return terms.number(e)
        if e is sympy.pi:
            return terms.name("pi")
        if e is sympy.E:
            return terms.call("exp", terms.number(1))
        if e.is_Add:
            return terms.total([of(part) for part in e.as_ordered_terms()])
        if e.is_Mul:
            return quotient(e)
        if e.is_Pow and e.base is sympy.E:
            return terms.call("exp", of(e.exp))
        if e.is_Pow:
            return power(e)
        if e.func in SAME:
            return terms.call(SAME[e.func], *map(of, e.args))
        if e.func in MADE:
            return of(MADE[e.func](*e.args))
        raise Error(f"'{e}' has no counterpart in the language: {type(e).__name__}", "functions are sin, exp, sqrt and those of the book's chapter on the language")

    def quotient(e: Any) -> Term:
        above, below = [], []
        for factor in e.as_ordered_factors():
            if factor.is_Rational and not factor.is_Integer:
                above.append(terms.number(factor.p))
                below.append(terms.number(factor.q))
            elif factor.is_Pow and factor.base is not sympy.E and factor.exp.is_Rational and factor.exp < 0:
                below.append(of(sympy.Pow(factor.base, -factor.exp, evaluate=False)) if factor.exp != -1 else of(factor.base))
            else:
                above.append(of(factor))
        return terms.product(above, below)

    def power(e: Any) -> Term:
        if e.exp == sympy.Rational(1, 2):
            return terms.call("sqrt", of(e.base))
        if e.exp.is_Rational and e.exp < 0:
            under = e.base if e.exp == -1 else sympy.Pow(e.base, -e.exp, evaluate=False)
            return terms.product([], [of(under)])
        return terms.power(of(e.base), of(e.exp))

    found = sympy.sympify(expression)
    if not isinstance(found, sympy.Expr):
        raise Error(f"'{expression}' is no expression")
    return of(found)
