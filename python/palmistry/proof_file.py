"""Proof files, read into functions of an environment: symbols with their values. What is not read is refused by name."""

import os
import re
from fractions import Fraction

from .values import (Dual, NotRead, Row, Turn, apply, determinant, each, inverse, invert, matrix, number, raised, refuse, times,
                     total)

NAME = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*'*")
SPACE = re.compile(r"(?:\s+|#[^\n]*)*")
RELATION = r"!=|<=|>=|=|<|>"
ENTRIES = set("system use state param angle known unknown initial experiments let drift input field output sample claim erratum damaged"
              " scan convention loose definition undecided set pole map line reduction".split())
SIGNALS = 6  # derivatives of a known signal that are told apart


class Environment:
    """Values of symbols, each found when it is asked for; definitions are evaluated once."""

    def __init__(self, values, level=0): self.values, self.level, self.kept = values, level, {}

    def value(self, name):
        if name not in self.values:
            refuse(f"{name} has no value")
        found = self.values[name]
        if callable(found):
            found = self.values[name] = found()
        return found

    def along(self, rates):
        """The point moved along a field: symbols as dual numbers of a level of their own."""
        def moved(name, rate):
            slope = number(rate(self))
            return self.value(name) if isinstance(slope, Fraction) and slope == 0 else Dual(self.level + 1, self.value(name), slope)
        values = {name: lambda name=name: self.value(name) for name in self.values}
        for name, rate in rates.items():
            values[name] = lambda name=name, rate=rate: moved(name, rate)
        return Environment(values, self.level + 1)

    def slope(self, value):
        """The derivative in what was evaluated where `along` has led."""
        if isinstance(value, list):
            return [[self.slope(x) for x in row] for row in value]
        return value.slope if isinstance(value, Dual) and value.level == self.level else Fraction(0)


def lie(rates, of):
    def derivative(at):
        there = at.along(rates)
        return there.slope(of(there))
    return derivative


def slopes(of, columns):
    """The rows of derivatives by some symbols, of a number or of each entry of a column."""
    units = [[Fraction(i == j) for j in range(len(columns))] for i in range(len(columns))]
    rates = {column: lambda at, unit=unit: Row(unit) for column, unit in zip(columns, units)}

    def derivatives(at):
        found = [row[0] for row in matrix(lie(rates, of)(at))]
        return [row.entries if isinstance(row, Row) else [Fraction(0)] * len(columns) for row in found]
    return derivatives


class ProofFile:
    """A system: its states, fields, outputs and definitions."""

    def __init__(self, path, depth=0):
        if depth > 8:
            refuse("files that use one another")
        with open(path, encoding="utf-8") as file:
            self.text, self.at = file.read(), 0
        self.path, self.depth, self.source = path, depth, re.sub(r"#[^\n]*|\s+", "", self.text)
        self.states, self.unknown, self.known, self.symbols, self.angles = [], [], set(), set(), set()
        self.lets, self.fields, self.moving, self.imports, self.outputs, self.signals = {}, {}, [], {}, [], []
        self.skip()
        while self.at < len(self.text):
            word = self.match(NAME.pattern)
            if word not in ENTRIES or word == "experiments":
                refuse(f"'{word or self.text[self.at:self.at + 20]}'")
            getattr(self, "read_" + word, lambda: None)()
            self.to_next_entry()
        for name, order in self.signals:
            rates = {name + "'" * k: (lambda at, next_=name + "'" * (k + 1): at.value(next_)) for k in range(order)}
            for field in ([f for f, kind in self.moving if kind == "drift"] or [None]):
                if field is None:
                    field = "signals"
                    self.moving.append((field, "drift"))
                    self.fields[field] = {}
                self.fields[field].update(rates)

    # reading

    def skip(self):
        self.at = SPACE.match(self.text, self.at).end()

    def match(self, pattern):
        found = re.compile(pattern).match(self.text, self.at)
        if found is None:
            return None
        self.at = found.end()
        self.skip()
        return found.group()

    def take(self, wanted):
        return self.match(re.escape(wanted) + (r"\b" if wanted.isalpha() else "")) is not None

    def need(self, wanted):
        if not self.take(wanted):
            refuse(f"'{self.text[self.at:self.at + 20]}' where '{wanted}' was awaited")

    def name(self):
        name = self.match(NAME.pattern)
        if name is None or self.text[self.at:self.at + 1] in ("[", "@"):
            refuse("a vector, or an experiment" if name else f"'{self.text[self.at:self.at + 20]}'")
        return name

    def to_next_entry(self):
        depth = 0
        while self.at < len(self.text):
            mark = self.at
            found = self.match(r'"[^"]*"') or self.match(NAME.pattern) or self.match(r"(?s).")
            if depth == 0 and found in ENTRIES:
                self.at = mark
                return
            depth += {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}.get(found, 0)

    def dimension(self):
        if self.take(":"):
            self.match(r"[^,=#\n]*?(?=\s*(?:[,=#\n]|\bunknown\b|\bknown\b|\border\b|$))")

    def commas(self, read):
        while True:
            read()
            if not self.take(","):
                return

    def read_use(self):
        name = self.name()
        self.need("=")
        other = ProofFile(os.path.join(os.path.dirname(self.path), self.match(r'"[^"]*"')[1:-1]), self.depth + 1)
        self.imports[name] = other
        self.angles |= other.angles
        self.symbols |= other.symbols

    def read_state(self):
        def one():
            self.states.append(self.name())
            self.symbols.add(self.states[-1])
            self.dimension()
        self.commas(one)

    def read_param(self):
        waiting = []

        def one():
            waiting.append(self.name())
            self.symbols.add(waiting[-1])
            self.dimension()
            valued = self.take("=") and bool(self.sum())
            self.dimension()
            if self.take("unknown"):
                self.unknown.extend(waiting)
                waiting.clear()
            elif self.take("known") or valued:
                waiting.clear()
        self.commas(one)

    def read_angle(self):
        self.commas(lambda: self.angles.add(self.name()))

    def signal(self, is_known):
        name = self.name()
        if not self.match(r"\(\s*t\s*\)"):
            refuse("a signal that is no function of t")
        self.dimension()
        order = int(self.match(r"\d+")) if self.take("order") else None
        if order is None and not is_known:
            order = max([1] + [len(d) for d in re.findall(rf"\b{name}('+)", self.text)])
        jet = [name + "'" * k for k in range((SIGNALS if is_known else order) + 1)]
        self.symbols.update(jet)
        self.signals.append((name, len(jet) - 1))
        (self.known.update if is_known else self.unknown.extend)(jet)

    def read_known(self):
        self.commas(lambda: self.signal(True))

    def read_unknown(self):
        self.commas(lambda: self.signal(False))

    def read_initial(self):
        def one():
            name = self.name()
            if self.take("="):
                refuse("a value at the beginning")
            if self.take("known"):
                waiting.append(name)
                self.known.update(waiting)
            else:
                waiting.append(name)
        waiting = []
        self.commas(one)

    def read_let(self):
        name = self.name()
        if self.take(":"):
            self.match(r"[^=]*")
        self.need("=")
        value = self.sum()
        self.lets[name] = lambda at: at.kept[name] if name in at.kept else at.kept.setdefault(name, value(at))

    def read_field(self, kind="field"):
        field, rates = self.name(), {}
        while (found := re.compile(r"([A-Za-z_]\w*)\s*('|\+)\s*=").match(self.text, self.at)):
            if found.group(2) == "+":
                refuse("discrete time")
            self.at = found.end()
            self.skip()
            rates[found.group(1)] = self.sum()
        rates.pop("others", None)
        if not set(rates) <= set(self.states):
            refuse("a field of something that is no state")
        self.fields[field] = rates
        if kind != "field":
            self.moving.append((field, kind))

    def read_drift(self):
        self.read_field("drift")

    def read_input(self):
        self.read_field("input")

    def read_output(self):
        def one():
            self.outputs.append(self.sum())
            if self.text[self.at:self.at + 1] == "=":
                refuse("an output that is zero")
            self.dimension()
        self.commas(one)

    # what is asked of a system

    def columns(self):
        return [name for name in self.states + self.unknown if name not in self.known]

    def word(self, text):
        """A word of Lie derivatives by its name: `Lf Lg y`."""
        first, _, rest = text.partition(" ")
        if rest and first[1:] in self.fields and first[0] == "L":
            return lie(self.fields[first[1:]], self.word(rest))
        return self.whole(text, self.sum)

    def whole(self, text, read):
        self.text, self.at = text, 0
        self.skip()
        found = read()
        return found if self.at == len(text) else refuse(f"'{text[self.at:self.at + 20]}'")

    def statement(self, text):
        """A statement that stands in the file: what is asked, its sides and its conditions."""
        if re.sub(r"#[^\n]*|\s+", "", text) not in self.source:
            refuse("the statement does not stand in the file")
        return self.whole(text, self.read_statement)

    def read_statement(self):
        if re.match(r"rank\b", self.text[self.at:]):
            self.take("rank")
            of = self.bracketed() if self.text[self.at:self.at + 1] == "(" else None
            self.need("=")
            found = "rank", of, int(self.match(r"\d+") or refuse("a rank that is no number"))
        else:
            left = self.sum()
            relation = self.match(RELATION) or refuse(f"'{self.text[self.at:self.at + 20]}'")
            found = relation, left, self.sum()
        conditions = []

        def one():
            start, left, middle = self.at, self.sum(), self.at
            relation = self.match(RELATION) or refuse("a condition that is no relation")
            conditions.append((self.text[start:middle].strip(), left, relation, self.sum()))
        if self.take("where"):
            self.commas(one)
        return (*found, conditions)

    # expressions

    def bracketed(self):
        self.need("(")
        found = self.sum()
        self.need(")")
        return found

    def sum(self):
        parts = [("+", self.product())]
        while (sign := self.match(r"[+-]")):
            parts.append((sign, self.product()))
        if len(parts) == 1:
            return parts[0][1]

        def value(at):
            found = parts[0][1](at)
            for sign, part in parts[1:]:
                found = each((lambda x, y: x + y) if sign == "+" else (lambda x, y: x - y), found, part(at))
            return found
        return value

    def product(self):
        signs, factors = self.match(r"[+-](?:\s*[+-])*") or "", [("*", self.factor())]
        while (sign := self.match(r"[*/]")):
            signs += self.match(r"[+-](?:\s*[+-])*") or ""
            factors.append((sign, self.factor()))
        negative = signs.count("-") % 2
        if len(factors) == 1 and not negative:
            return factors[0][1]

        def value(at):
            found = factors[0][1](at)
            for sign, factor in factors[1:]:
                other = factor(at)
                found = times(found, other if sign == "*" else invert(number(other)))
            return times(Fraction(-1), found) if negative else found
        return value

    def factor(self):
        base = self.primary()
        if self.take("^"):
            negative, one, power = self.take("-"), base, self.primary()
            base = lambda at: exponential(number(one(at)), -power(at) if negative else power(at))
        while self.take("at"):
            self.need("{")
            given, of = {}, base

            def one_value():
                name = self.name()
                self.need("=")
                given[name] = self.sum()
            self.commas(one_value)
            self.need("}")
            base = lambda at, of=of, given=given: of(
                Environment({**at.values, **{name: lambda value=value: number(value(at)) for name, value in given.items()}}, at.level))
        return base

    def primary(self):
        if (found := self.match(r"\d+(?:\.\d+)?")):
            value = Fraction(found)
            return lambda at: value
        if self.text[self.at:self.at + 1] == "(":
            return self.bracketed()
        if self.take("["):
            return self.blocks()
        name = self.name()
        if self.text[self.at:self.at + 1] == "(":
            return self.called(name)
        first, _, rest = name.partition(".")
        other = self.imports[first] if first in self.imports else self
        plain = rest if first in self.imports else name
        if other is not self and plain == "output":
            return lambda at: [[number(output(at))] for output in other.outputs]
        if name == "pi":
            return lambda at: Turn(Fraction(1))
        if plain in other.lets:
            return other.lets[plain] if other is self else self.kept_apart(name, other.lets[plain])
        if plain not in other.symbols:
            refuse(f"'{name}'")
        return lambda at: at.value(plain)

    @staticmethod
    def kept_apart(name, value):
        """Definitions of another file have names of their own there."""
        def evaluate(at):
            inner = at.kept.setdefault((name.partition(".")[0],), Environment(at.values, at.level))
            return value(inner)
        return evaluate

    def blocks(self):
        rows, row = [], []
        while True:
            row.append(self.sum())
            if self.take(","):
                continue
            rows.append(row)
            row = []
            if self.take("]"):
                break
            self.need(";")

        def value(at):
            found = []
            for row in rows:
                blocks = [matrix(part(at)) for part in row]
                if len({len(block) for block in blocks}) != 1:
                    refuse("blocks of two heights")
                found.extend([x for part in parts for x in part] for parts in zip(*blocks))
            return found if len({len(row) for row in found}) == 1 else refuse("rows of two lengths")
        return value

    def field(self):
        """A field, or a bracket of two: its rates."""
        name = self.name()
        if name == "bracket":
            self.need("(")
            rates = self.pair()
            self.need(")")
            return rates
        first, _, rest = name.partition(".")
        fields = self.imports[first].fields if first in self.imports else self.fields
        return fields.get(rest if first in self.imports else name) or refuse(f"'{name}' where a field was awaited")

    def pair(self):
        f = self.field()
        self.need(",")
        g, zero = self.field(), lambda at: Fraction(0)
        minus = lambda a, b: lambda at: number(a(at)) - number(b(at))
        return {name: minus(lie(f, g.get(name, zero)), lie(g, f.get(name, zero))) for name in {**f, **g}}

    def called(self, name):
        self.need("(")
        if name == "L":
            fields = []
            while True:
                mark = self.at
                try:
                    fields.append(self.field())
                    self.need(",")
                except NotRead:
                    self.at = mark
                    break
            found = self.sum()
            for rates in reversed(fields):
                found = lie(rates, found)
            self.need(")")
            return found
        if name == "bracket":
            rates = self.pair()
            columns = self.by() or self.columns()
            return lambda at: [[number(rates[column](at)) if column in rates else Fraction(0)] for column in columns]
        arguments = [self.sum()]
        if name == "d":
            return slopes(arguments[0], self.by() or self.columns())
        while self.take(","):
            arguments.append(self.sum())
        self.need(")")
        return lambda at: function(name, [argument(at) for argument in arguments])

    def by(self):
        columns = []
        while self.take(","):
            columns.append(self.name())
        self.need(")")
        return columns


def exponential(base, power):
    power = number(power)
    if isinstance(power, Fraction) and power.denominator == 1:
        return raised(base, int(power))
    if isinstance(power, Fraction) and power.denominator == 2:
        return raised(apply("sqrt", base), int(2 * power))
    return apply("exp", power * apply("log", base))


def function(name, arguments):
    a, b = arguments[0], arguments[-1]
    if name in ("transpose", "det", "inverse", "dot", "cross"):
        a, b = matrix(a), matrix(b)
        if name == "transpose":
            return [list(column) for column in zip(*a)]
        if name in ("det", "inverse"):
            return determinant(a) if name == "det" else inverse(a)
        a, b = sum(a, []), sum(b, [])
        if name == "dot":
            return total(x * y for x, y in zip(a, b))
        if len(a) == 2:
            return a[0] * b[1] - a[1] * b[0]
        return [[a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]] for i in range(3)]
    a, b = number(a), number(b)
    one, half = Fraction(1), Fraction(1, 2)
    exp, root = lambda x: apply("exp", x), lambda x: apply("sqrt", x * x)
    made = {
        "tan": lambda: apply("sin", a) * invert(apply("cos", a)), "cot": lambda: apply("cos", a) * invert(apply("sin", a)),
        "sec": lambda: invert(apply("cos", a)), "csc": lambda: invert(apply("sin", a)),
        "sinh": lambda: half * (exp(a) - exp(-a)), "cosh": lambda: half * (exp(a) + exp(-a)),
        "tanh": lambda: one - Fraction(2) * invert(exp(a + a) + one), "abs": lambda: root(a), "sign": lambda: a * invert(root(a)),
        "min": lambda: half * (a + b - root(a - b)), "max": lambda: half * (a + b + root(a - b)),
        "atan2": lambda: Fraction(2) * apply("atan", a * invert(apply("sqrt", a * a + b * b) + b)),
    }
    if name in ("sqrt", "exp", "log", "sin", "cos", "asin", "acos", "atan"):
        return apply(name, a)
    return made[name]() if name in made and len(arguments) <= 2 else refuse(f"'{name}'")
