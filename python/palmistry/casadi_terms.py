"""CasADi's expressions, SX or MX, as terms of the language: an expression is expanded into scalar operations, which are read one by one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import casadi

from . import terms
from .errors import Error
from .terms import Term

#: Operations that the language has as functions.
SAME = {
    casadi.OP_EXP: "exp", casadi.OP_LOG: "log", casadi.OP_SQRT: "sqrt", casadi.OP_SIN: "sin", casadi.OP_COS: "cos", casadi.OP_TAN: "tan",
    casadi.OP_ASIN: "asin", casadi.OP_ACOS: "acos", casadi.OP_ATAN: "atan", casadi.OP_SINH: "sinh", casadi.OP_COSH: "cosh",
    casadi.OP_TANH: "tanh", casadi.OP_FABS: "abs", casadi.OP_SIGN: "sign", casadi.OP_FMIN: "min", casadi.OP_FMAX: "max",
    casadi.OP_ATAN2: "atan2",
}  # fmt: skip

ONE, TWO = terms.number(1), terms.number(2)


def _square(x: Term) -> Term:
    return terms.power(x, TWO)


#: Operations that are made of others.
MADE: dict[int, Callable[..., Term]] = {
    casadi.OP_ASSIGN: lambda x: x,
    casadi.OP_ADD: lambda x, y: terms.total([x, y]),
    casadi.OP_SUB: lambda x, y: terms.total([x, terms.negative(y)]),
    casadi.OP_MUL: lambda x, y: terms.product([x, y]),
    casadi.OP_DIV: lambda x, y: terms.product([x], [y]),
    casadi.OP_NEG: terms.negative,
    casadi.OP_INV: lambda x: terms.product([], [x]),
    casadi.OP_SQ: _square,
    casadi.OP_TWICE: lambda x: terms.product([TWO, x]),
    casadi.OP_POW: terms.power,
    casadi.OP_CONSTPOW: terms.power,
    casadi.OP_LOG1P: lambda x: terms.call("log", terms.total([ONE, x])),
    casadi.OP_EXPM1: lambda x: terms.total([terms.call("exp", x), terms.number(-1)]),
    casadi.OP_HYPOT: lambda x, y: terms.call("sqrt", terms.total([_square(x), _square(y)])),
    casadi.OP_ASINH: lambda x: terms.call("log", terms.total([x, terms.call("sqrt", terms.total([_square(x), ONE]))])),
    casadi.OP_ACOSH: lambda x: terms.call("log", terms.total([x, terms.call("sqrt", terms.total([_square(x), terms.number(-1)]))])),
    casadi.OP_ATANH: lambda x: terms.product(
        [terms.call("log", terms.product([terms.total([ONE, x])], [terms.total([ONE, terms.negative(x)])]))], [TWO]
    ),
}

NAMES = {getattr(casadi, name): name[3:].lower() for name in dir(casadi) if name.startswith("OP_")}


class Node(NamedTuple):
    """An operation: its code, the places of its operands, and its number or symbol where it is one."""

    code: int
    operands: tuple[int, ...]
    value: Any


class Entry(NamedTuple):
    """An expression, by the place of its node."""

    place: int


def _columns(listed: Any) -> list[Any]:
    """The scalar expressions of a vector, a list of them, or a number."""
    if isinstance(listed, (casadi.SX, casadi.MX)):
        return [listed[place] for place in range(listed.numel())]
    if isinstance(listed, (list, tuple)):
        return [entry for part in listed for entry in _columns(part)]
    return [casadi.SX(listed)]


def name_of(symbol: Any) -> str:
    """What a symbol is called; of a component of an MX vector, the vector and its place."""
    if isinstance(symbol, str):
        return symbol
    if isinstance(symbol, casadi.SX) and symbol.is_scalar() and symbol.is_symbolic():
        return symbol.name()
    if isinstance(symbol, casadi.MX) and symbol.is_scalar():
        if symbol.is_symbolic():
            return symbol.name()
        whole = casadi.symvar(symbol)
        if len(whole) == 1:
            vector = casadi.SX.sym(whole[0].name(), *whole[0].shape)
            [found] = casadi.Function("component", whole, [symbol]).expand().call([vector])
            if found.is_symbolic():
                return found.name()
    raise Error(f"{symbol} is no symbol")


class Tape:
    """All expressions of a system as one list of operations, in which what is the same is there once."""

    def __init__(self, states: Any, fields: Any, outputs: Any) -> None:
        self.nodes: list[Node] = []
        self._places: dict[Node, int] = {}
        self._uses: Counter[int] = Counter()
        self._abbreviated: list[tuple[str, Term]] = []
        named = isinstance(fields, Mapping) and all(isinstance(key, str) for key in fields)
        read = self._read
        self.fields: Any
        if named:
            self.fields = {name: self._field(rates) for name, rates in fields.items()}
        elif isinstance(fields, Mapping):
            by_name = self._field(fields)
            self.fields = [by_name.pop(name_of(state), self._zero()) for state in _columns(states)]
            if by_name:
                raise Error(f"the drift moves {', '.join(by_name)}, which is no state")
        else:
            self.fields = self._field(fields)
        self.outputs = {name: read([output])[0] for name, output in outputs.items()} if isinstance(outputs, Mapping) else read(_columns(outputs))
        read(_columns(states))
        self.symbols = sorted({node.value for node in self.nodes if node.code == casadi.OP_PARAMETER})

    def _field(self, rates: Any) -> Any:
        if isinstance(rates, Mapping):
            return {key if isinstance(key, str) else name_of(key): self._read(_columns(rate))[0] for key, rate in rates.items()}
        return self._read(_columns(rates))

    def _zero(self) -> Entry:
        return Entry(self._node(Node(casadi.OP_CONST, (), 0.0)))

    @staticmethod
    def entries(listed: Any) -> list[Any]:
        """What `Parts` takes apart: lists of entries are so already."""
        if isinstance(listed, (list, tuple)) and all(isinstance(entry, Entry) for entry in listed):
            return list(listed)
        return _columns(listed)

    def _node(self, node: Node) -> int:
        place = self._places.setdefault(node, len(self.nodes))
        if place == len(self.nodes):
            self.nodes.append(node)
            self._uses.update(node.operands)
        return place

    def _read(self, expressions: list[Any]) -> list[Entry]:
        """The operations of some expressions."""
        found = []
        for expression in expressions:
            symbols = casadi.symvar(expression)
            function = casadi.Function("expression", symbols, [expression])
            if isinstance(expression, casadi.MX):
                function = function.expand()
            place = self._run(function, [self._components(symbol) for symbol in symbols])
            self._uses[place] += 1
            found.append(Entry(place))
        return found

    @staticmethod
    def _components(symbol: Any) -> list[str]:
        if symbol.is_scalar():
            return [symbol.name()]
        vector = casadi.SX.sym(symbol.name(), *symbol.shape)
        return [entry.name() for entry in vector.elements()]

    def _run(self, function: Any, names: list[list[str]]) -> int:
        """The place of what a function of scalar operations gives."""
        work: dict[int, int] = {}
        result = None
        for k in range(function.n_instructions()):
            code, inputs, outputs = function.instruction_id(k), function.instruction_input(k), function.instruction_output(k)
            if code == casadi.OP_OUTPUT:
                result = work[inputs[0]]
            elif code == casadi.OP_INPUT:
                work[outputs[0]] = self._node(Node(casadi.OP_PARAMETER, (), names[inputs[0]][inputs[1]]))
            elif code == casadi.OP_CONST:
                work[outputs[0]] = self._node(Node(casadi.OP_CONST, (), function.instruction_constant(k)))
            else:
                work[outputs[0]] = self._node(Node(code, tuple(work[i] for i in inputs), None))
        # an expression that is zero everywhere has no operations
        return self._node(Node(casadi.OP_CONST, (), 0.0)) if result is None else result

    def reader(self, ours: Callable[[str], str]) -> Callable[[Any], Term]:
        """Reads entries; what is used more than once, and is more than a symbol or a number, gets a name."""
        taken = {ours(name) for name in self.symbols}
        done: list[Term] = []
        for place, node in enumerate(self.nodes):
            term = self._term(node, [done[operand] for operand in node.operands], ours)
            if node.operands and self._uses[place] > 1:
                name = self._free(taken)
                self._abbreviated.append((name, term))
                term = terms.name(name)
            done.append(term)
        return lambda entry: done[entry.place] if isinstance(entry, Entry) else terms.number(entry)

    @staticmethod
    def _free(taken: set[str]) -> str:
        count = 1
        while f"w{count}" in taken:
            count += 1
        taken.add(f"w{count}")
        return f"w{count}"

    @staticmethod
    def _term(node: Node, operands: list[Term], ours: Callable[[str], str]) -> Term:
        if node.code == casadi.OP_PARAMETER:
            return terms.name(ours(node.value))
        if node.code == casadi.OP_CONST:
            return terms.number(float(node.value))
        if node.code in SAME:
            return terms.call(SAME[node.code], *operands)
        if node.code in MADE:
            return MADE[node.code](*operands)
        raise Error(f"'{NAMES.get(node.code, node.code)}' has no counterpart in the language")

    def definitions(self) -> list[tuple[str, Term]]:
        """The abbreviations, each above its use."""
        return self._abbreviated
