"""Proof files, read by a parser of their own into matrices of expressions. What is not read is refused."""

import os
import re

from .graph import Derivation, Map, Node, call, number, refuse, symbol

NAME = r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*'*"
TOKEN = re.compile(NAME + r"|(?:\d+\.?\d*|\.\d+)(?:e-?\d{1,3}\b)?|!=|<=|>=|\S")
ENTRY = re.compile(r"^\s*(?=(?:system|use|state|param|angle|known|unknown|initial|experiments|let|drift|input|field"
                   r"|output|sample|claim|erratum|damaged|scan|convention|loose|definition|undecided|set|pole|map|line"
                   r"|reduction)\b)", re.M)


def each(do, *of): return [[do(*x) for x in zip(*rows, strict=True)] for rows in zip(*of, strict=True)]
def entries(x): return [entry for row in x for entry in row]
def single(x): return x[0][0] if len(x) == len(x[0]) == 1 else refuse("a matrix where a number is meant")
def named(x): return x.args[0] if x.kind == "symbol" else refuse("an expression where a symbol is meant")
def dot(a, b): return sum((x * y for x, y in zip(a, b, strict=True)), number(0))


def times(a, b):
    if len(a[0]) == len(b):
        return [[dot(row, column) for column in zip(*b)] for row in a]
    return each(lambda x: single(a) * x, b) if len(entries(a)) == 1 else each(lambda x: x * single(b), a)


def determinant(rows):
    minors = {(): number(1)}  # by their columns, of the rows that were gone through
    for row in rows:
        grown = {}
        for columns, minor in minors.items():
            for column in (c for c in range(len(rows)) if c not in columns and row[c].args != (0,)):
                key, sign = tuple(sorted((*columns, column))), (-1) ** sum(c > column for c in columns)
                grown[key] = grown.get(key, number(0)) + number(sign) * row[column] * minor
        minors = grown
    return minors.get(tuple(range(len(rows))), number(0))


def inverse(rows):
    size, whole = range(len(rows)), determinant(rows)
    rest = lambda i, j: [row[:i] + row[i + 1:] for row in rows[:j] + rows[j + 1:]]
    return [[number((-1) ** (i + j)) * determinant(rest(i, j)) / whole for j in size] for i in size]


def cross(a, b):
    pairs = [(1, 2), (2, 0), (0, 1)] if len(a) == 3 else [(0, 1)]
    return [[a[i] * b[j] - a[j] * b[i]] for i, j in pairs]


def blocks(rows):
    found = [sum(parts, []) for row in rows for parts in zip(*row, strict=True)]
    return found if len({len(row) for row in found}) == 1 else refuse("blocks that do not fit")


def power(x, n):
    return x ** int(n.args[0]) if n.kind == "number" and n.args[0].denominator == 1 else refuse("a power")


OPERATIONS = {  # how they bind, and what they do
    "+": (1, lambda a, b: each(Node.__add__, a, b)), "-": (1, lambda a, b: each(Node.__sub__, a, b)), "*": (2, times),
    "/": (2, lambda a, b: times(a, [[single(b) ** -1]])), "^": (4, lambda a, b: [[power(single(a), single(b))]]),
    "at": (3, lambda a, b: each(Map({symbol(named(single(x))): single(y) for x, _, y in b}).__getitem__, a)),
    **{mark: (0, lambda a, b, mark=mark: (a, mark, b)) for mark in ("=", "!=", "<", "<=", ">", ">=")}}
FUNCTIONS = {
    "transpose": lambda a: [list(row) for row in zip(*a)], "det": lambda a: [[determinant(a)]], "inverse": inverse,
    "dot": lambda a, b: [[dot(entries(a), entries(b))]], "cross": lambda a, b: cross(entries(a), entries(b)),
    "tan": lambda x: [[call("sin", single(x)) / call("cos", single(x))]],
    "cot": lambda x: [[call("cos", single(x)) / call("sin", single(x))]],
    **{name: lambda x, name=name: [[call(name, single(x))]] for name in ("sin", "cos", "exp", "log", "sqrt", "atan")}}


class Field(list):
    """What is differentiated `along`; as a matrix, the column of its rates, or what else has its name."""

    def __init__(self, along, rows):
        super().__init__(rows)
        self.along = along


class Reader:
    """Reads and computes a text with the names of a system: a matrix, a field, or a relation of matrices."""

    def __init__(self, system, text):
        self.system, self.tokens = system, ["", *reversed(TOKEN.findall(text))]

    def listed(self, end):
        """What stands between commas, in rows between semicolons."""
        rows, mark = [[]], ","
        while mark != end:
            rows += [[]] if mark == ";" else []
            rows[-1].append(self.value(0))
            mark = self.tokens.pop()
            if mark not in (",", ";", end):
                refuse(f"'{' '.join([mark, *self.tokens[:0:-1]][:4])}' where '{end}' is awaited")
        return rows

    def value(self, least):
        """As far as operations bind as much as that."""
        token = self.tokens.pop()
        if token in ("+", "-"):
            found = times([[number(token + "1")]], self.value(max(least, 3)))
        elif token == "[":
            found = blocks(self.listed("]"))
        elif token in ("(", "{"):
            (found,) = self.listed(")" if token == "(" else "}")
            (found,) = found if token == "(" else [found]
        elif not re.match(NAME, token):
            found = [[number(token)]]
        elif self.tokens[-1] == "(" and self.tokens.pop():
            found = self.called(token, *self.listed(")")[0])
        else:
            found = self.system.named(token)
        while OPERATIONS.get(self.tokens[-1], (-1,))[0] >= least:
            binding, operation = OPERATIONS[self.tokens.pop()]
            found = operation(found, self.value(binding + 1))
        return found

    def called(self, name, *of):
        if name == "L":
            *fields, found = of
            for field in reversed(fields):
                found = each(field.along.__getitem__, found)
            return found
        if name == "bracket":
            f, g = (field.along for field in of)
            along = Derivation(lambda name: f[g[symbol(name)]] - g[f[symbol(name)]])
            return Field(along, [[along[symbol(column)]] for column in self.system.columns()])
        if name == "d":
            columns = [named(single(x)) for x in of[1:]] or self.system.columns()
            return [[self.system.unit(column)[x] for column in columns] for x in entries(of[0])]
        return FUNCTIONS[name](*of) if name in FUNCTIONS else refuse(f"'{name}('")


class System:
    """A proof file: its states, fields, outputs and definitions, which are computed when they are asked for."""

    def __init__(self, path, depth=0):
        with open(path, encoding="utf-8") as file:
            text = re.sub(r'"[^"]*"|#[^\n]*', lambda x: " ".join(x[0].split()) * (x[0][0] == '"'), file.read())
        self.path, self.depth, self.source = path, depth, "".join(text.split())
        self.lets, self.rates, self.known = {}, {}, {}
        self.states, self.unknown, self.initial, self.outputs, self.moving, self.signals = [], [], [], [], [], []
        self.symbols = {"pi"}
        for entry in ENTRY.split(text if re.search(r"^\s*drift\b", text, re.M) else text + "\ndrift signals"):
            self.read_entry(*(*entry.split(None, 1), "", "")[:2])

    def read_entry(self, kind, text):
        names = [TOKEN.findall(part) for part in text.split(",")]
        is_list = kind in ("state", "param", "known", "initial")
        if is_list and re.search(r"[\[@]|\b(?:state|param|let|drift|input|field|output)\b", text):
            refuse("a vector, an experiment, or entries that share a line")
        if kind == "use":
            name, other = re.fullmatch(r'(\w+) = "(.*)"\s*', text).groups()
            path = os.path.join(os.path.dirname(self.path), other) if self.depth < 8 else refuse("deep imports")
            self.known[name] = System(path, self.depth + 1)
            self.symbols |= self.known[name].symbols
        elif kind == "let" and (found := re.fullmatch(r"(\w+)\s*(?::[^=]*)?=(.*)", text, re.S)):
            self.lets[found[1]] = found[2]
        elif kind in ("drift", "input", "field"):
            name, *bodies = re.split(r"(\w+)'\s*=", text)
            self.rates[name.strip()] = kind, dict(zip(bodies[::2], bodies[1::2]))
            self.moving += [name.strip()] * (kind != "field")
        elif kind == "output":
            self.outputs.append(re.sub(":[^,]*", "", text))
        elif kind == "initial":
            self.initial += [name for name, *_ in names] if "=" not in text else refuse("a value at the beginning")
        elif kind in ("unknown", "experiments"):
            refuse("an unknown signal, or experiments")
        elif kind == "known":
            self.signals += [name for name, *_ in names]
        elif kind in ("state", "param"):
            waiting = []
            for name, *rest in names:
                waiting.append(name)
                self.unknown += waiting if rest[-1:] == ["unknown"] else []
                self.states += [name] if kind == "state" else []
                self.symbols.add(name)
                waiting = [] if "=" in rest or rest[-1:] in (["known"], ["unknown"]) else waiting

    def read(self, text):
        """The values that stand between the commas of a text."""
        reader = Reader(self, text + ")")
        (found,) = reader.listed(")")
        return found if reader.tokens == [""] else refuse(f"what stands behind '{text}'")

    def named(self, name):
        first, _, rest = name.partition(".")
        if rest:
            return self.known[first].named(rest)
        if name not in self.known:
            found = [[symbol(name)]] if name in self.symbols or name.rstrip("'") in self.signals else []
            if name in self.lets:
                (found,) = self.read(self.lets[name])
            if name in self.rates:
                found = Field(Derivation(lambda symbol: self.rate(symbol, *self.rates[name])), found)
            elif name == "output":
                found = [[x] for x in self.seen()]
            self.known[name] = found if found or name in self.rates else refuse(f"'{name}'")
        return self.known[name]

    def rate(self, name, kind, bodies):
        if kind == "drift" and name.rstrip("'") in self.signals:
            return symbol(name + "'")
        (found,) = self.read(bodies.get(name, "0"))
        return single(found)

    def unit(self, column):
        return self.known.setdefault((column, "unit"), Derivation(lambda name: number(name == column)))

    def columns(self):
        return [name for name in self.states + self.unknown if name not in self.initial]

    def seen(self):
        texts = [] if "=" in "".join(self.outputs) else self.outputs
        return [x for text in texts or refuse("an output that is zero") for of in self.read(text) for x in entries(of)]

    def word(self, text):
        """A word by its name, as `Lf Lg y`: an output, differentiated along what moves the system."""
        first, _, rest = text.partition(" ")
        if rest and first[1:] in self.moving:
            return self.named(first[1:]).along[self.word(rest)]
        ((found,),) = self.read(text)[0]
        return found if found in self.seen() else refuse(f"'{text}' is no output")

    def statement(self, text):
        """What is asked, of what, the answer, and the conditions, of a statement that stands in the file."""
        if "".join(text.split()) not in self.source:
            refuse("the statement does not stand in the file")
        claim, *where = re.split(r"\bwhere\b", re.split(r"\b(?:everywhere|except)\b", text)[0])
        conditions = [x for text in where for x in self.read(text)]
        if found := re.fullmatch(r"\s*rank\s*(?:\((.*)\)\s*)?=\s*(\d+)\s*", claim, re.S):
            return "rank", found[1] and self.read(found[1])[0], int(found[2]), conditions
        if found := re.fullmatch(r"\s*((?:un)?(?:observable|identifiable))\s*\((.*)\)\s*", claim, re.S):
            return found[1], entries(sum(self.read(found[2]), [])), None, conditions
        (of,) = self.read(claim)
        return "=", of, None, conditions
