"""Proof files, read by a parser of their own: what is not read is refused by name."""

import os
import re
from fractions import Fraction

from . import terms
from .terms import add, apply, const, div, mul, neg, power, sub, value

NAME = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")
SPACE = re.compile(r"(?:\s+|#[^\n]*)*")
ENTRIES = set("system use state param angle known unknown initial experiments let drift input field output sample claim erratum "
              "damaged scan convention loose definition undecided set pole map line reduction".split())
PLAIN = {"sqrt", "exp", "log", "sin", "cos", "asin", "acos", "atan"}
RELATION = re.compile(r"!=|<=|>=|=|<|>")


class NotRead(Exception):
    """Something that this program does not read."""


class Text:
    """A text, and how far it was read."""

    def __init__(self, text):
        self.text, self.at = text, 0
        self.skip()

    def skip(self):
        self.at = SPACE.match(self.text, self.at).end()

    def word(self):
        """The name that comes next, or an empty text."""
        found = NAME.match(self.text, self.at)
        return found.group() if found else ""

    def take(self, wanted):
        """Whether this sign or word comes next; it is read."""
        end = self.at + len(wanted)
        here = self.text.startswith(wanted, self.at)
        if here and not (wanted[-1].isalnum() and re.match(r"\w", self.text[end:end + 1])):
            self.at = end
            self.skip()
            return True
        return False

    def need(self, wanted):
        if not self.take(wanted):
            raise NotRead(f"'{self.text[self.at:self.at + 20]}' where '{wanted}' was awaited")

    def match(self, pattern):
        found = re.compile(pattern).match(self.text, self.at)
        if found is None:
            return None
        self.at = found.end()
        self.skip()
        return found.group()

    def string(self):
        return self.match(r'"[^"]*"')

    def to_next_entry(self):
        """Reads over what belongs to an entry."""
        depth = 0
        while self.at < len(self.text):
            word = self.word()
            if depth == 0 and word in ENTRIES:
                return
            found = self.string() or self.match(r"[\[{(\]})]") or (word and self.match(re.escape(word))) or self.match(r".")
            depth += {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}.get(found, 0)


class ProofFile:
    """A system: its states, fields, outputs and definitions, as terms."""

    def __init__(self, text, path, depth=0):
        self.path, self.source, self.depth = path, text, depth
        self.states, self.unknown, self.angles, self.outputs = [], [], set(), []
        self.symbols, self.lets, self.fields, self.imports, self.kinds = {}, {}, {}, {}, {}
        self.indices, self.vectors = {}, set()
        self.reader = Text(text)
        while self.reader.at < len(text):
            word = self.reader.word()
            if word not in ENTRIES:
                raise NotRead(f"'{text[self.reader.at:self.reader.at + 20]}' where an entry was awaited")
            self.reader.need(word)
            entry = getattr(self, "read_" + word, None)
            if word in ("known", "unknown", "initial", "experiments"):
                raise NotRead(f"a file with '{word}'")
            if entry:
                entry()
            self.reader.to_next_entry()

    @staticmethod
    def read(path, depth=0):
        if depth > 8:
            raise NotRead("files that use one another")
        with open(path, encoding="utf-8") as file:
            return ProofFile(file.read(), path, depth)

    # entries

    def read_use(self):
        name = self.reader.match(NAME.pattern)
        self.reader.need("=")
        other = ProofFile.read(os.path.join(os.path.dirname(self.path), self.reader.string()[1:-1]), self.depth + 1)
        self.imports[name] = other
        self.angles |= other.angles
        for known in other.symbols:
            self.symbols.setdefault(known, other.symbols[known])

    def names(self):
        """Names up to a word or sign that is no comma, each with what follows it up to the next comma."""
        while True:
            name = self.reader.match(NAME.pattern)
            if name is None or self.reader.text[self.reader.at:self.reader.at + 1] == "[":
                raise NotRead("a vector")
            yield name
            if self.reader.take(":"):
                self.reader.match(r"[^,=#\n]*")
            if not self.reader.take(","):
                return

    def read_state(self):
        for name in self.names():
            self.symbols[name] = terms.symbol(name)
            self.states.append(name)

    def read_param(self):
        waiting = []
        for name in self.names_of_parameters():
            self.symbols[name] = terms.symbol(name)
            waiting.append(name)
            if self.last == "unknown":
                self.unknown.extend(waiting)
            if self.last:
                waiting = []

    def names_of_parameters(self):
        while True:
            name, self.last = self.reader.match(NAME.pattern), ""
            if name is None or self.reader.text[self.reader.at:self.reader.at + 1] == "[":
                raise NotRead("a vector")
            for _ in range(2):
                if self.reader.take(":"):
                    self.reader.match(r"[^,=#\n]*?(?=\s*(?:[,=#\n]|unknown|known))")
                if self.reader.take("="):
                    self.sum()
                    self.last = "known"
            for word in ("known", "unknown"):
                self.last = word if self.reader.take(word) else self.last
            yield name
            if not self.reader.take(","):
                return

    def read_angle(self):
        self.angles |= set(self.names())

    def read_let(self):
        name = self.reader.match(NAME.pattern)
        if self.reader.take(":"):
            self.reader.match(r"[^=]*")
        if not self.reader.take("="):
            raise NotRead("a vector")
        self.lets[name] = self.sum()

    def read_field(self, kind="field"):
        field, rates = self.reader.match(NAME.pattern), {}
        while (found := re.compile(r"([A-Za-z_]\w*)\s*('|\+)\s*=").match(self.reader.text, self.reader.at)):
            if found.group(2) == "+":
                raise NotRead("discrete time")
            self.reader.at = found.end()
            self.reader.skip()
            rates[found.group(1)] = self.number(self.sum())
        if rates.pop("others", const(0)) != const(0) or not set(rates) <= set(self.states):
            raise NotRead("a field of something that is no state")
        self.fields[field] = {name: rates.get(name, const(0)) for name in self.states}
        self.kinds[field] = kind

    def read_drift(self):
        self.read_field("drift")

    def read_input(self):
        self.read_field("input")

    def read_output(self):
        while True:
            output = self.number(self.sum())
            if self.reader.take("="):
                raise NotRead("an output that is zero")
            self.outputs.append(output)
            if self.reader.take(":"):
                self.reader.match(r"[^,#\n]*")
            if not self.reader.take(","):
                return

    # what is asked of a system

    def unknowns(self):
        return [terms.symbol(name) for name in self.states + self.unknown]

    def moving(self):
        return [name for name, kind in self.kinds.items() if kind != "field"]

    def along(self, field, of):
        """A Lie derivative; the field by name or by its rates."""
        rates = self.fields[field] if isinstance(field, str) else field
        total = const(0)
        for name, rate in rates.items():
            slope = terms.derivative(of, terms.symbol(name))
            if const(0) not in (rate, slope):
                total = add(total, mul(rate, slope))
        return total

    def word(self, text):
        """A word of Lie derivatives by its name: `Lf Lg y`."""
        first, _, rest = text.partition(" ")
        if rest and first[0] == "L" and first[1:] in self.fields:
            return self.along(first[1:], self.word(rest))
        self.reader = Text(text)
        return self.number(self.whole(self.sum))

    def whole(self, read):
        found = read()
        if self.reader.at < len(self.reader.text):
            raise NotRead(f"'{self.reader.text[self.reader.at:][:20]}'")
        return found

    def statement(self, name, text):
        """A statement that stands in the file: its kind, two sides and conditions; of a rank the matrix and the number."""
        plain = lambda text: re.sub(r"#[^\n]*|\s+", "", text)
        if plain(text) not in plain(self.source):
            raise NotRead(f"'{name}' does not stand in the file in these words")
        self.reader = Text(text)
        return self.whole(self.read_statement)

    def read_statement(self):
        if self.reader.word() == "rank":
            self.reader.take("rank")
            matrix = None
            if self.reader.take("("):
                matrix = self.matrix(self.sum())
                self.reader.need(")")
            self.reader.need("=")
            found = ["rank", matrix, int(self.reader.match(r"\d+") or -1)]
        else:
            left = self.sum()
            relation = self.reader.match(RELATION.pattern)
            if relation is None:
                raise NotRead(f"'{self.reader.text[self.reader.at:][:20]}'")
            found = [relation, left, self.sum()]
        conditions = []
        if self.reader.take("where"):
            while True:
                left = self.number(self.sum())
                conditions.append((left, self.reader.match(RELATION.pattern), self.number(self.sum())))
                if not self.reader.take(","):
                    break
        return (*found, conditions)

    # expressions

    def number(self, found):
        if isinstance(found, list):
            if len(found) == len(found[0]) == 1:
                return found[0][0]
            raise NotRead("a matrix where a number is meant")
        return found

    def matrix(self, found):
        return found if isinstance(found, list) else [[found]]

    def sum(self):
        total = self.product()
        while (sign := self.reader.match(r"[+-]")):
            total = self.both(add if sign == "+" else sub, total, self.product())
        return total

    def both(self, operation, a, b):
        if not isinstance(a, list) and not isinstance(b, list):
            return operation(a, b)
        a, b = self.matrix(a), self.matrix(b)
        if [len(row) for row in a] != [len(row) for row in b]:
            raise NotRead("a sum of matrices of two shapes")
        return [[operation(x, y) for x, y in zip(*rows)] for rows in zip(a, b)]

    def times(self, a, b):
        if isinstance(a, list) and isinstance(b, list) and len(a[0]) == len(b):
            return [[self.total(mul(x, row[j]) for x, row in zip(line, b)) for j in range(len(b[0]))] for line in a]
        if isinstance(a, list) and isinstance(b, list):
            raise NotRead("a product of matrices of these shapes")
        if isinstance(a, list) or isinstance(b, list):
            one, other = (b, a) if isinstance(a, list) else (a, b)
            return [[mul(one, entry) for entry in row] for row in other]
        return mul(a, b)

    @staticmethod
    def total(parts):
        found = const(0)
        for part in parts:
            found = add(found, part)
        return found

    def product(self):
        signs = self.reader.match(r"[+-](?:\s*[+-])*") or ""
        found = self.factor()
        while (sign := self.reader.match(r"[*/]")):
            turned = self.reader.match(r"[+-](?:\s*[+-])*") or ""
            other = self.factor()
            other = other if sign == "*" else power(self.number(other), -1)
            found = self.times(found, other)
            signs += turned
        return self.times(const(-1), found) if signs.count("-") % 2 else found

    def factor(self):
        base = self.primary()
        if self.reader.take("^"):
            turned = self.reader.take("-")
            exponent = self.number(self.primary())
            base = self.raised(self.number(base), neg(exponent) if turned else exponent)
        while self.reader.take("at"):
            self.reader.need("{")
            given = {}
            while not self.reader.take("}"):
                name = self.reader.match(NAME.pattern)
                self.reader.need("=")
                given[name] = self.number(self.sum())
                self.reader.take(",")
            replace = lambda entry: terms.replaced(entry, given)
            base = [[replace(x) for x in row] for row in base] if isinstance(base, list) else replace(base)
        return base

    @staticmethod
    def raised(base, exponent):
        n = value(exponent)
        if n is None:
            return apply("exp", mul(exponent, apply("log", base)))
        if n.denominator == 1:
            return power(base, int(n))
        if n.denominator == 2:
            return power(apply("sqrt", base), int(2 * n))
        return apply("exp", mul(exponent, apply("log", base)))

    def primary(self):
        reader = self.reader
        if (number := reader.match(r"\d+(?:\.\d+)?")):
            return const(Fraction(number))
        if reader.take("("):
            found = self.sum()
            reader.need(")")
            return found
        if reader.take("["):
            return self.blocks()
        name = reader.match(NAME.pattern)
        if name is None:
            raise NotRead(f"'{reader.text[reader.at:][:20]}'")
        if reader.text[reader.at:reader.at + 1] in ("[", "'", "@"):
            raise NotRead("a vector or a signal")
        if reader.take("("):
            return self.called(name)
        if name == "pi":
            return terms.term("pi")
        first, _, rest = name.partition(".")
        if first in self.imports and rest:
            other = self.imports[first]
            if rest == "output":
                return [[output] for output in other.outputs]
            found = other.lets.get(rest, other.symbols.get(rest))
        else:
            found = self.lets.get(name, self.symbols.get(name))
        if found is None:
            raise NotRead(f"'{name}'")
        return found

    def blocks(self):
        """A matrix whose entries may be matrices."""
        rows, row = [], []
        while True:
            row.append(self.matrix(self.sum()))
            if self.reader.take(","):
                continue
            if len({len(block) for block in row}) != 1:
                raise NotRead("blocks of two heights")
            rows.extend([entry for part in parts for entry in part] for parts in zip(*row))
            row = []
            if self.reader.take("]"):
                break
            self.reader.need(";")
        if len({len(row) for row in rows}) != 1:
            raise NotRead("rows of two lengths")
        return rows

    def field_named(self):
        """A field by its name, or a bracket of two: its rates."""
        if self.reader.take("bracket"):
            self.reader.need("(")
            found = self.bracket()
            self.reader.need(")")
            return found
        name = self.reader.match(NAME.pattern)
        first, _, rest = (name or "").partition(".")
        fields = self.imports[first].fields if first in self.imports else self.fields
        name = rest if first in self.imports else name
        if name not in fields:
            raise NotRead(f"'{name}' where a field was awaited")
        return fields[name]

    def bracket(self):
        f = self.field_named()
        self.reader.need(",")
        g = self.field_named()
        return {name: sub(self.along(f, g.get(name, const(0))), self.along(g, f.get(name, const(0)))) for name in {**f, **g}}

    def called(self, name):
        reader = self.reader
        if name == "L":
            fields = []
            while True:
                mark = reader.at
                try:
                    fields.append(self.field_named())
                    reader.need(",")
                except NotRead:
                    reader.at = mark
                    break
            found = self.sum()
            reader.need(")")
            for field in reversed(fields):
                take = lambda entry: self.along(field, entry)
                found = [[take(x) for x in row] for row in found] if isinstance(found, list) else take(found)
            return found
        if name == "bracket":
            rates, columns = self.bracket(), self.rest_of_names()
            return [[rates[TERM_NAME(column)]] for column in (columns or self.unknowns())]
        if name == "d":
            of = self.matrix(self.sum())
            columns = self.rest_of_names() or self.unknowns()
            if any(len(row) != 1 for row in of):
                raise NotRead("a differential of a matrix")
            return [[terms.derivative(row[0], column) for column in columns] for row in of]
        arguments = [self.sum()]
        while reader.take(","):
            arguments.append(self.sum())
        reader.need(")")
        return self.function(name, arguments)

    def rest_of_names(self):
        columns = []
        while self.reader.take(","):
            columns.append(self.number(self.sum()))
        self.reader.need(")")
        if any(terms.TERMS[column][0] != "symbol" for column in columns):
            raise NotRead("a differential by something that is no symbol")
        return columns

    def function(self, name, arguments):
        a, b = arguments[0], arguments[-1]
        if name == "transpose":
            return [list(column) for column in zip(*self.matrix(a))]
        if name == "det":
            return terms.determinant(self.matrix(a))
        if name == "dot":
            return self.total(mul(x, y) for x, y in zip(sum(self.matrix(a), []), sum(self.matrix(b), [])))
        if name == "cross":
            first, second = sum(self.matrix(a), []), sum(self.matrix(b), [])
            if len(first) == len(second) == 2:
                return sub(mul(first[0], second[1]), mul(first[1], second[0]))
            (a, b, c), (x, y, z) = first, second
            return [[sub(mul(b, z), mul(c, y))], [sub(mul(c, x), mul(a, z))], [sub(mul(a, y), mul(b, x))]]
        if name == "inverse":
            return terms.inverse(self.matrix(a))
        if name == "rank":
            raise NotRead(f"'{name}'")
        arguments = [self.number(argument) for argument in arguments]
        a, b = arguments[0], arguments[-1]
        root = lambda x: apply("sqrt", power(x, 2))
        exp = lambda x: apply("exp", x)
        made = {
            "tan": lambda: div(apply("sin", a), apply("cos", a)), "cot": lambda: div(apply("cos", a), apply("sin", a)),
            "sec": lambda: power(apply("cos", a), -1), "csc": lambda: power(apply("sin", a), -1),
            "sinh": lambda: mul(const(Fraction(1, 2)), sub(exp(a), exp(neg(a)))),
            "cosh": lambda: mul(const(Fraction(1, 2)), add(exp(a), exp(neg(a)))),
            "tanh": lambda: sub(const(1), div(const(2), add(exp(mul(const(2), a)), const(1)))),
            "abs": lambda: root(a), "sign": lambda: div(a, root(a)),
            "min": lambda: mul(const(Fraction(1, 2)), sub(add(a, b), root(sub(a, b)))),
            "max": lambda: mul(const(Fraction(1, 2)), add(add(a, b), root(sub(a, b)))),
            "atan2": lambda: mul(const(2), apply("atan", div(a, add(apply("sqrt", add(power(a, 2), power(b, 2))), b)))),
        }
        if name in PLAIN and len(arguments) == 1:
            return apply(name, a)
        if name not in made or len(arguments) > 2:
            raise NotRead(f"'{name}'")
        return made[name]()


def TERM_NAME(at):
    """The name of a symbol."""
    return terms.TERMS[at][1]
