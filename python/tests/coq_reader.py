"""The theorems that `palmistry prove --coq` writes, read as Coq reads them: what each says, in the terms of the second checker.

It shares nothing with what writes them. Notations and their levels are those of proofs/coq/Lie.v; what it does not know it refuses."""

import re
from functools import reduce

from palmistry.graph import Map, Node, call, derivation, number, put_in, symbol
from palmistry.proof_file import Matrix, determinant, inverse

TOKEN = re.compile(r"(?P<number>\d+)|(?P<name>[^\W\d][\w']*)|(?P<mark>:=|===|==|<>|<=|>=|[-+*/^()\[\];,:.=<>%@])|(?P<space>\s+)|(?P<other>.)")
LEVELS = {"+": 50, "-": 50, "*": 40, "/": 40, "^": 30, "at": 20}  # of what stands between two terms
COMPARED = {"=": "=", "<>": "!=", "<": "<", "<=": "<=", ">": ">", ">=": ">="}


class NotRead(Exception):
    """Something that this reader does not know."""


def refuse(why):
    raise NotRead(why)


def product(a, b):
    return a * b


def over(a, b):
    return a * b**-1


def exponential(x):
    return call("exp", x)


def quotient(above, below):
    return lambda x: over(above(x), below(x))


def absolute(x):
    return call("sqrt", x**2)


SINE, COSINE = (lambda x, kind=kind: call(kind, x) for kind in ("sin", "cos"))
NUMBERS = {  # functions of numbers
    "Sin": SINE, "Cos": COSINE, "Tan": quotient(SINE, COSINE), "Cot": quotient(COSINE, SINE),
    "Sec": lambda x: COSINE(x)**-1, "Csc": lambda x: SINE(x)**-1, "Exp": exponential, "Ln": lambda x: call("log", x),
    "Sqrt": lambda x: call("sqrt", x), "Atan": lambda x: call("atan", x), "Opp": lambda x: -x, "Inv": lambda x: x**-1,
    "Sinh": lambda x: over(exponential(x) - exponential(-x), number(2)),
    "Cosh": lambda x: over(exponential(x) + exponential(-x), number(2)),
    "Tanh": lambda x: over(exponential(x) - exponential(-x), exponential(x) + exponential(-x)),
    "Abs": absolute, "Sign": lambda x: over(x, absolute(x))}


def each(do, *of):
    return [[do(*entries) for entries in zip(*rows, strict=True)] for rows in zip(*of, strict=True)]


def along(field, x):
    return field[x]


def unit(variable):
    return derivation(lambda name: number(name == variable.args[0]))


def field(pairs):
    rates = {variable.args[0]: rate for variable, rate in pairs}
    return derivation(lambda name: rates.get(name, number(0)))


def bracket(f, g):
    return derivation(lambda name: f[g[symbol(name)]] - g[f[symbol(name)]])


def put(pairs):
    return Map(put_in, pairs)


def times(a, b):
    return [[reduce(lambda x, y: x + y, map(product, row, column)) for column in zip(*b, strict=True)] for row in a]


def flat(matrix):
    return [x for row in matrix for x in row]


def cross3(a, b):
    (x, y, z), (p, q, r) = flat(a), flat(b)
    found = [y * r - z * q, z * p - x * r, x * q - y * p]
    return [found] if len(a) == 1 else [[entry] for entry in found]


FUNCTIONS = {  # of a number of arguments
    "Mul": (2, product), "L": (2, along), "d": (2, lambda y, x: unit(y)[x]), "each": (2, each), "field": (1, field),
    "bracket": (2, bracket), "put": (1, put), "subst": (2, along), "differential": (2, lambda by, x: [[unit(y)[x] for y in by]]),
    "column_of": (2, lambda f, of: [[f[y]] for y in of]), "entry": (1, lambda m: m[0][0]),
    "entry_at": (3, lambda i, j, m: m[int(i.args[0])][int(j.args[0])]), "transpose": (1, lambda m: [list(row) for row in zip(*m)]),
    "plus": (2, lambda a, b: each(lambda x, y: x + y, a, b)), "minus": (2, lambda a, b: each(lambda x, y: x - y, a, b)),
    "times": (2, times), "beside": (2, lambda a, b: [x + y for x, y in zip(a, b, strict=True)]), "above": (2, lambda a, b: a + b),
    "dot": (2, lambda a, b: reduce(lambda x, y: x + y, map(product, flat(a), flat(b)))),
    "cross2": (2, lambda a, b: flat(a)[0] * flat(b)[1] - flat(a)[1] * flat(b)[0]), "cross3": (2, cross3),
    "det": (1, lambda m: determinant(tuple(map(tuple, m)))), "inverse": (1, lambda m: [list(row) for row in inverse(Matrix(map(tuple, m)))]),
    "Atan2": (2, lambda y, x: number(2) * call("atan", over(y, call("sqrt", x**2 + y**2) + x))),
    **{name: (1, function) for name, function in NUMBERS.items()}}
STATEMENTS = {"refuted": 3, "is_about_something": 3, "matrices_are_about_something": 3, "greatest_rank": 3, "rank_reaches": 3,
              "greatest_observability_rank": 5, "observability_rank_reaches": 5}


class Reader:
    """A file: `theorems` is a list of what stands before each, its name, and what it says."""

    def __init__(self, text, symbol_of):
        self.symbol_of, self.known, self.theorems = symbol_of, {}, []
        before = ""
        for part in re.split(r"(\(\*.*?\*\))", text, flags=re.S):
            if part.startswith("(*"):
                before = part[2:-2].strip()
                continue
            for command in re.split(r"\.(?:\s|$)", part):
                self.command(command.strip(), before)

    def command(self, text, before):
        word, _, rest = text.partition(" ")
        if word == "Definition":
            name, said = re.fullmatch(r"(\S+)(?: : (?:term|matrix))? := (.*)", rest, re.S).groups()
            if said.startswith("Var "):
                self.known[name] = symbol(self.symbol_of(name))
            else:
                self.known[name] = self.whole(said, self.term)
        elif word == "Theorem":
            name, said = re.fullmatch(r"(\S+) : (.*)", rest, re.S).groups()
            self.theorems.append((before, name, self.whole(said, self.statement)))

    def whole(self, text, read):
        self.tokens = [(x.lastgroup, x[0]) for x in TOKEN.finditer(text) if x.lastgroup != "space"] + [("end", "")]
        self.place = 0
        found = read()
        return found if self.tokens[self.place][0] == "end" else refuse(f"{self.tokens[self.place][1]!r}")

    def taken(self, *marks):
        if self.tokens[self.place][1] in marks and self.tokens[self.place][0] != "end":
            self.place += 1
            return self.tokens[self.place - 1][1]
        return None

    def wanted(self, mark):
        return self.taken(mark) or refuse(f"{self.tokens[self.place][1]!r} instead of {mark!r}")

    def statement(self):
        """What is said: its kind, and its parts, the conditions first."""
        word = self.tokens[self.place][1]
        if word in STATEMENTS:
            self.place += 1
            conditions = self.argument(self.conditions)
            parts = [self.atom() for _ in range(STATEMENTS[word] - 1)]
            return word, conditions, parts
        left = self.term()
        self.taken("==", "===") or refuse("no equation")
        right = self.term()
        return "equal", self.conditions() if self.taken("where") else [], [left, right]

    def argument(self, read):
        """In brackets with a scope, or as it is."""
        if self.taken("("):
            found = read()
            self.wanted(")")
            if self.taken("%"):
                self.place += 1
            return found
        return read()

    def conditions(self):
        def one():
            left = self.term()
            sign = self.taken(*COMPARED) or refuse("no condition")
            return left, COMPARED[sign], self.term()
        return self.listed(one)

    def listed(self, one):
        self.wanted("[")
        found = []
        while not self.taken("]"):
            found.append(one())
            if not self.taken(";"):
                self.wanted("]")
                break
        return found

    def term(self, most=50):
        """A term that holds at least so tightly: of the level of what stands between its parts, or a smaller one."""
        if self.taken("-"):
            left = -self.term(35)
        else:
            left = self.applied()
        while (sign := self.tokens[self.place][1]) in LEVELS and LEVELS[sign] <= most:
            level = LEVELS[sign]
            self.place += 1
            if sign == "at":
                left = put(self.listed(self.pair))[left]
            elif sign == "^":  # from the right
                exponent = self.term(level)
                left = left**int(exponent.args[0])
            else:
                right = self.term(level - 1)
                left = {"+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": product, "/": over}[sign](left, right)
        return left

    def pair(self):
        self.wanted("(")
        first = self.term()
        self.wanted(",")
        second = self.term()
        self.wanted(")")
        return first, second

    def applied(self):
        """A function with its arguments, or what stands for itself."""
        name = self.tokens[self.place][1]
        if name not in FUNCTIONS or name in self.known:
            return self.atom()
        self.place += 1
        arity, function = FUNCTIONS[name]
        given = []
        while len(given) < arity and (self.tokens[self.place][0] in ("number", "name") and self.tokens[self.place][1] not in ("at", "where")
                                      or self.tokens[self.place][1] in ("(", "[")):
            given.append(self.atom())
        return function(*given) if len(given) == arity else lambda *more: function(*given, *more)

    def atom(self):
        kind, text = self.tokens[self.place]
        if text == "(":
            self.place += 1
            found = self.term()
            if self.taken(","):
                found = found, self.term()
            self.wanted(")")
            return found
        if text == "[":
            return self.listed(self.term)
        self.place += 1
        if kind == "number":
            return number(text)
        if kind == "name" and text in self.known:
            return self.known[text]
        if kind == "name" and text in FUNCTIONS:
            arity, function = FUNCTIONS[text]
            return function if arity else function()
        return symbol("pi") if text == "Pi" else refuse(f"{text!r}")
