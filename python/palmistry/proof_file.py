"""Proof files, read into graphs of expressions. Everything is a matrix, a number one of one entry. What is not read is refused by name."""

import os
import re

from .graph import Expressions, Field, Node, NotRead, Point, call, number, refuse, symbol

TOKEN = re.compile(r'#[^\n]*|"[^"]*"|[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*\'*|(?:\d+\.?\d*|\.\d+)(?:e-?\d{1,3}\b)?|!=|<=|>=|\S')
ENTRIES = ("system use state param angle known unknown initial experiments let drift input field output sample claim erratum damaged scan"
           " convention loose definition undecided set pole map line reduction").split()
SEEN = "observable", "unobservable", "identifiable", "unidentifiable"


def tokens_of(text): return tuple(token for token in TOKEN.findall(text) if token[0] != "#")
def squeezed(text): return re.sub(r"#[^\n]*|\s+", "", text)


def split(tokens, mark):
    """The parts between those marks that stand in no brackets."""
    depth, found = 0, [[]]
    for token in tokens:
        depth += (token in ("(", "[", "{")) - (token in (")", "]", "}"))
        found.append([]) if token == mark and depth == 0 else found[-1].append(token)
    return found


def each(operation, a, *more):
    shapes = {tuple(len(row) for row in b) for b in (a, *more)}
    return [[operation(*entries) for entries in zip(*rows)] for rows in zip(a, *more)] if len(shapes) == 1 else refuse("matrices of two shapes")


def single(x):
    return x[0][0] if len(x) == len(x[0]) == 1 else refuse("a matrix where a number is meant")


def entries(x): return [entry for row in x for entry in row]
def dot(a, b): return sum((x * y for x, y in zip(a, b)), number(0))


def times(a, b):
    if len(a[0]) == len(b):
        return [[dot(row, column) for column in zip(*b)] for row in a]
    factor, of = (single(a), b) if len(a) == len(a[0]) == 1 else (single(b), a)
    return each(lambda x: factor * x, of)


def determinant(rows):
    minors = {(): number(1)}  # by their columns, of the rows that were gone through
    for row in rows:
        grown = {}
        for columns, minor in minors.items():
            for column in (c for c in range(len(rows)) if c not in columns and row[c] is not number(0)):
                key, sign = tuple(sorted((*columns, column))), (-1) ** sum(c > column for c in columns)
                grown[key] = grown.get(key, number(0)) + number(sign) * row[column] * minor
        minors = grown
    return minors.get(tuple(range(len(rows))), number(0))


def inverse(rows):
    size, whole = range(len(rows)), determinant(rows)
    minor = lambda i, j: determinant([[rows[k][m] for m in size if m != i] for k in size if k != j])
    return [[number((-1) ** (i + j)) * minor(i, j) / whole for j in size] for i in size]


def cross(a, b):
    turned = [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(len(a))]
    return [[x] for x in turned] if len(a) == 3 else [[a[0] * b[1] - a[1] * b[0]]]


def power(base, exponent):
    half = exponent.args[0] if exponent.kind == "number" else None
    if half is not None and half.denominator <= 2 and abs(half) < 10_000:
        return base ** int(half) if half.denominator == 1 else call("sqrt", base) ** int(2 * half)
    return call("exp", exponent * call("log", base))


OF_MATRICES = {
    "transpose": lambda a: [list(column) for column in zip(*a)], "det": lambda a: [[determinant(a)]], "inverse": inverse,
    "dot": lambda a, b: [[dot(entries(a), entries(b))]], "cross": lambda a, b: cross(entries(a), entries(b))}
OF_NUMBERS = {"tan": lambda x: call("sin", x) / call("cos", x), "cot": lambda x: call("cos", x) / call("sin", x)}
OF_NUMBERS.update({name: lambda x, name=name: call(name, x) for name in ("sqrt", "exp", "log", "sin", "cos", "atan")})
BINDING = {"+": 1, "-": 1, "*": 2, "/": 2, "at": 3, "^": 4}
OPERATIONS = {"+": lambda a, b: each(Node.__add__, a, b), "-": lambda a, b: each(Node.__sub__, a, b), "*": times,
              "/": lambda a, b: times(a, [[single(b) ** -1]]), "^": lambda a, b: [[power(single(a), single(b))]]}


class Reader:
    """Reads expressions and statements with the names of a system."""

    def __init__(self, system, tokens): self.system, self.tokens, self.at = system, [*tokens, ""], 0

    def take(self, *wanted):
        """What comes next, if it is one of these."""
        found = self.tokens[self.at] if self.tokens[self.at] in wanted else ""
        self.at += bool(found)
        return found

    def need(self, *wanted):
        return self.take(*wanted) or refuse(f"'{' '.join(self.tokens[self.at:self.at + 4])}' where '{wanted[0]}' is awaited")

    def name(self):
        found = self.need(self.tokens[self.at] if re.match(r"[A-Za-z_]", self.tokens[self.at]) else "a name")
        return found if self.tokens[self.at] not in ("[", "@") else refuse("a vector, or an experiment")

    def commas(self, read, end=""):
        found = [read()]
        while self.take(","):
            found.append(read())
        if end:
            self.need(end)
        return found

    def whole(self, read):
        found = read()
        return found if self.at == len(self.tokens) - 1 else refuse(f"'{' '.join(self.tokens[self.at:self.at + 4])}'")

    def relation(self):
        left, relation, right = self.sum(), self.need("=", "!=", "<", "<=", ">", ">="), self.sum()
        return left, relation, right

    def statement(self):
        """What is asked, of what, the answer, and the conditions."""
        asked, of, rank = self.take("rank", *SEEN), None, None
        if asked in SEEN:
            self.need("(")
            of = entries(sum(self.commas(self.sum, ")"), []))
        elif asked:
            of = self.commas(self.sum, ")")[0] if self.take("(") else None
            self.need("=")
            rank = int(self.need(self.tokens[self.at]))
        else:
            of = self.relation()
        conditions = self.commas(self.relation) if self.take("where") else []
        if self.take("everywhere", "except"):
            self.at = len(self.tokens) - 1
        return asked, of, rank, conditions

    def sum(self, binding=1):
        sign = self.take("+", "-")
        found = self.sum(3) if sign else self.primary()
        found = each(Node.__neg__, found) if sign == "-" else found
        while BINDING.get(self.tokens[self.at], 0) >= binding:
            operation = self.need(self.tokens[self.at])
            if operation == "at":
                self.need("{")
                found = each(Point(Expressions, self.commas(self.given, "}")).value, found)
            else:
                found = OPERATIONS[operation](found, self.sum(BINDING[operation] + 1))
        return found

    def given(self):
        name = self.symbol()
        self.need("=")
        return symbol(name), single(self.sum())

    def symbol(self): return self.system.home(self.name())[1]

    def primary(self):
        if self.take("("):
            return self.commas(self.sum, ")")[0]
        if self.take("["):
            return self.blocks()
        if re.match(r"\.?\d", self.tokens[self.at]):
            return [[number(self.need(self.tokens[self.at]))]]
        name = self.name()
        return self.called(name) if self.take("(") else self.system.named(name)

    def blocks(self):
        found = []
        while True:
            blocks = self.commas(self.sum)
            found += [sum(parts, []) for parts in zip(*blocks)]
            if len({len(block) for block in blocks}) > 1 or len({len(row) for row in found}) > 1:
                refuse("blocks that do not fit")
            if self.need("]", ";") == "]":
                return found

    def field(self):
        name = self.name()
        if name != "bracket" or not self.take("("):
            return self.system.field(name)
        field = self.bracket()
        self.need(")")
        return field

    def bracket(self):
        f, _, g = self.field(), self.need(","), self.field()
        return Field(lambda name: f.along(g.rate(name)) - g.along(f.rate(name)))

    def lie(self):
        """What stands last, differentiated along the fields before it."""
        mark = self.at
        try:
            field = self.field()
            self.need(",")
        except NotRead:
            self.at = mark
            return self.commas(self.sum, ")")[0]
        return each(field.along, self.lie())

    def called(self, name):
        if name == "L":
            return self.lie()
        if name == "bracket":
            field = self.bracket()
            return [[field.rate(column)] for column in self.by()]
        if name == "d":
            of, columns = entries(self.sum()), self.by()
            return [[self.system.unit(column).along(x) for column in columns] for x in of]
        arguments = self.commas(self.sum, ")")
        if name in OF_NUMBERS:
            return [[OF_NUMBERS[name](*map(single, arguments))]]
        return OF_MATRICES[name](*arguments) if name in OF_MATRICES else refuse(f"'{name}('")

    def by(self):
        return self.commas(self.symbol, ")") if self.need(",", ")") == "," else self.system.columns()


class ProofFile:
    """A system: its states, fields, outputs and definitions, which are read when they are asked for."""

    def __init__(self, path, depth=0):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        self.path, self.depth, self.source, self.tokens = path, depth, squeezed(text), tokens_of(text)
        self.states, self.unknown, self.known, self.symbols, self.outputs, self.moving = [], [], set(), {"pi"}, [], []
        self.lets, self.fields, self.imports, self.signals, self.units, self.drifts = {}, {}, {}, {}, {}, False
        entry, nesting, before = [], 0, ""
        for token, *ahead in zip(self.tokens, (*self.tokens[1:], ""), (*self.tokens[2:], "", "")):
            is_entry = ahead[0].startswith('"') if token in ("set", "pole", "map", "line") else token not in ("known", "unknown") or ahead[1] == "("
            if token in ENTRIES and nesting == 0 and len(entry) != 1 and before != ":" and is_entry:
                self.read(*(entry or ["system"]))
                entry = []
            nesting += (token in ("(", "[", "{")) - (token in (")", "]", "}"))
            entry, before = [*entry, token], token
        self.read(*entry)
        if self.signals and not self.drifts:
            self.read("drift", "signals")

    def read(self, kind, *words):
        """One entry."""
        parts = split(words, ",") if kind in ENTRIES and kind != "experiments" else refuse(f"'{kind}' where an entry is awaited")
        if kind in ("state", "param", "known", "unknown", "initial") and ("[" in words or "@" in words):
            refuse("a vector, or an experiment")
        if kind == "use":
            other = ProofFile(os.path.join(os.path.dirname(self.path), words[2][1:-1]), self.depth + 1) if self.depth < 8 else refuse("deep imports")
            self.imports[words[0]], self.symbols = other, self.symbols | other.symbols
        elif kind == "let" and words[1] not in ("[", "@"):
            self.lets[words[0]] = words[words.index("=") + 1:]
        elif kind in ("drift", "input", "field"):
            self.read_field(kind, words[0], split(words[1:], "="))
        elif kind == "output":
            self.outputs += parts
        elif kind in ("state", "param"):
            waiting = []
            for name, *rest in parts:
                waiting.append(name)
                if kind == "state" or rest[-1:] == ["unknown"]:
                    (self.states if kind == "state" else self.unknown).extend(waiting)
                waiting = [] if kind == "state" or "=" in rest or rest[-1:] in (["known"], ["unknown"]) else waiting
                self.symbols.add(name)
        elif kind == "initial":
            self.known |= {part[0] for part in parts} if words[-1] == "known" and "=" not in words else refuse("a value at the beginning")
        elif kind in ("known", "unknown"):
            for name, *rest in parts:
                told = [len(token) - len(name) for token in self.tokens if token.rstrip("'") == name]
                self.signals[name] = int(rest[rest.index("order") + 1]) if "order" in rest else max(1, *told) if kind == "unknown" else 1 << 20
                self.unknown += [name + "'" * k for k in range(self.signals[name] + 1)] if kind == "unknown" else []

    def read_field(self, kind, field, parts):
        names = [part[-1] for part in parts[:-1]]
        bodies = dict(zip(names, [part[:-1] for part in parts[1:-1]] + parts[-1:]))

        def rate(name):
            order = self.signals.get(name.rstrip("'"))
            if kind == "drift" and order is not None:
                return symbol(name + "'") if name.count("'") < order else number(0)
            reader = Reader(self, bodies.get(name + "'", ["0"]))
            return single(reader.whole(reader.sum))
        self.fields[field] = Field(rate) if all(re.fullmatch(r"\w.*'", name) for name in names) else refuse("discrete time, or a vector")
        self.moving, self.drifts = self.moving + [field] * (kind != "field"), self.drifts or kind == "drift"

    # what is asked of a system

    def home(self, name):
        """The system in which a name is declared, and its name there."""
        first, _, rest = name.partition(".")
        return self.imports[first].home(rest) if first in self.imports and rest else (self, name)

    def named(self, name):
        home, plain = self.home(name)
        if plain in home.lets:
            if isinstance(home.lets[plain], tuple):
                reader = Reader(home, home.lets[plain])
                home.lets[plain] = reader.whole(reader.sum)
            return home.lets[plain]
        if plain == "output" and home is not self:
            return [[x] for x in home.seen()]
        return [[symbol(plain)]] if plain in home.symbols or plain.rstrip("'") in home.signals else refuse(f"'{name}'")

    def field(self, name):
        home, plain = self.home(name)
        if plain.endswith("'") and plain.rstrip("'") in home.signals:
            return self.unit(plain[:-1])
        return home.fields.get(plain) or refuse(f"'{name}' where a field is awaited")

    def unit(self, column):
        """The field that moves one symbol."""
        return self.units.setdefault(column, Field(lambda name: number(name == column)))

    def columns(self):
        return [name for name in self.states + self.unknown if name not in self.known]

    def seen(self):
        """The outputs."""
        readers = [Reader(self, output) for output in self.outputs]
        found = [(reader.sum(), reader.tokens[reader.at] in ("", ":") or refuse("an output that is zero")) for reader in readers]
        return [x for of, _ in found for x in entries(of)]

    def word(self, text):
        """A word by its name, as `Lf Lg y`: an output, differentiated along what moves the system."""
        first, _, rest = text.partition(" ")
        if rest and first[1:] in self.moving:
            return self.fields[first[1:]].along(self.word(rest))
        reader = Reader(self, tokens_of(text))
        found = single(reader.whole(reader.sum))
        return found if found in self.seen() else refuse(f"'{text}' is no output")

    def statement(self, text):
        """A statement that stands in the file."""
        reader = Reader(self, tokens_of(text) if squeezed(text) in self.source else refuse("the statement does not stand in the file"))
        return reader.whole(reader.statement)
