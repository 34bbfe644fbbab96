"""Proof files as matrices of expressions. What is not read is refused."""

import os
import re
import stat
from collections import defaultdict
from functools import cache, reduce
from operator import add, attrgetter, neg, sub

from .graph import Map, call, derivation, number, put_in, refuse, spend, symbol
from .proof_parser import HOLDS, NAME, Parser, texts, without_comments

LETTERS = ("alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma tau upsilon phi chi psi omega".split())
GREEK = {chr(base + at + (at > 16)): x for at, name in enumerate(LETTERS) for base, x in ((0x3b1, name), (0x391, name.capitalize()))}
GREEK |= zip("\u03c2\u03d0\u03d1\u03d5\u03d6\u03f0\u03f1\u03f5\u00b5\u2126\u2206", "sigma beta theta phi pi kappa rho epsilon mu Omega Delta".split())
ENTRY = re.compile(r"^[ \t]*(?=(?:system|use|state|param|angle|assume|latex|known|unknown|initial|experiments|let|drift|input|field"
                   r"|output|sample|claim|erratum|damaged|scan|convention|loose|definition|undecided|set|singularity|pole|map|line"
                   r"|reduction)\b(?!'))", re.M)
# words that begin what a system is made of, and do not stand within another entry
WITHIN = re.compile(r"(?<![\w.])(?:system|state|param|assume|initial|experiments|let|drift|input|field|output)\b(?!')")
NAMED = "claim", "erratum", "damaged", "scan", "convention", "loose"
LARGEST, MOST_CLAIMS, MOST_NAMES = 16 << 20, 100_000, 2000  # bytes of a proof file; its entries; symbols of one kind
READ, BYTES = 1000, 8  # what a file takes as work, and what as many bytes take as one node

def each(do, *of): return Matrix(tuple(do(*x) for x in zip(*rows, strict=True)) for rows in zip(*of, strict=True))
def spelled(text): return re.sub(r'"[^"]*"|[^\x00-\x7f]', lambda x: GREEK.get(x[0], x[0]), text)
def entries(x): return [entry for row in x for entry in row]
def one(x): return Matrix([(x,)])
def single(x): return x[0][0] if len(x) == len(x[0]) == 1 else refuse("a matrix where a number is meant")
def named(x): return single(x) if single(x).kind == "symbol" else refuse("an expression where a symbol is meant")
def dot(a, b): return sum((x * y for x, y in zip(a, b, strict=True)), number(0))

class Relation(tuple):
    """Two sides, and what stands between them."""

class Matrix(tuple):
    """Rows of expressions; a number is one of a single entry."""
    def __new__(cls, rows):
        found = super().__new__(cls, rows)
        spend(sum(map(len, found)))
        return found

    def __neg__(self): return each(neg, self)
    def __add__(self, other): return each(add, self, other)
    def __sub__(self, other): return each(sub, self, other)
    def __truediv__(self, other): return self * one(single(other) ** -1)

    def __mul__(self, other):
        if len(self[0]) == len(other):
            spend(len(self) * len(other) * len(other[0]))
            return Matrix(tuple(dot(row, column) for column in zip(*other)) for row in self)
        factor, of = (self, other) if len(entries(self)) == 1 else (other, self)
        return each(lambda x: single(factor) * x, of)

    def __pow__(self, n):
        n = single(n).args[0]
        return one(single(self) ** int(n)) if n in range(-99, 100) else refuse("a power")

@cache
def determinant(rows):
    """By the first of the rows, and the minors of the others."""
    spend(len(rows) ** 3)
    terms = (number((-1) ** i) * x * determinant(tuple(row[:i] + row[i + 1:] for row in rows[1:]))
             for row in rows[:1] for i, x in enumerate(row) if x is not number(0))
    return sum(terms, number(0)) if rows else number(1)

def inverse(rows):
    size, whole = range(len(rows)), determinant((*rows,))
    rest = lambda i, j: tuple(row[:i] + row[i + 1:] for row in rows[:j] + rows[j + 1:])
    return Matrix(tuple(number((-1) ** (i + j)) * determinant(rest(i, j)) / whole for j in size) for i in size)

def cross(a, b):
    pairs = [(1, 2), (2, 0), (0, 1)] if len(a) == 3 else [(0, 1)]
    return Matrix((a[i] * b[j] - a[j] * b[i],) for i, j in pairs)

def blocks(rows):
    spend(sum(len(x) * len(x[0]) for row in rows for x in row))
    found = Matrix(sum(parts, ()) for row in rows for parts in zip(*row, strict=True))
    return found if len({len(row) for row in found}) == 1 else refuse("blocks that do not fit")

FUNCTIONS = {
    "transpose": lambda a: Matrix(zip(*a)), "det": lambda a: one(determinant((*a,))), "inverse": inverse,
    "dot": lambda a, b: one(dot(entries(a), entries(b))), "cross": lambda a, b: cross(entries(a), entries(b)),
    "tan": lambda x: one(call("sin", single(x)) / call("cos", single(x))),
    "cot": lambda x: one(call("cos", single(x)) / call("sin", single(x))),
    "L": lambda *of: reduce(lambda x, field: each(field.along.__getitem__, x), reversed(of)),
    **{name: lambda x, name=name: one(call(name, single(x))) for name in ("sin", "cos", "exp", "log", "sqrt", "atan")}}

class Field(Matrix):
    """The column of its rates, or what else has its name; and what is differentiated `along`."""
    along = None

def read_text(path, most):
    """The text of a plain file, of at most so many bytes: no pipe, and nothing without an end."""
    if not stat.S_ISREG(os.stat(path).st_mode):
        raise ValueError("it is no plain file")
    with open(path, encoding="utf-8") as file:
        text = file.read(most + 1)
    if len(text) > most:
        raise ValueError(f"it is longer than {most} bytes")
    return text

def digest(text):
    """That of Fowler, Noll and Vo (variant 1a, 64 bits): it notices that a file was changed, and is no signature."""
    found = 0xcbf29ce484222325
    for byte in text.encode():
        found = (found ^ byte) * 0x100000001b3 & 0xffffffffffffffff
    return f"{found:016x}"

class System:
    """A proof file: its states, fields, outputs and definitions, which are computed when they are asked for."""

    def __init__(self, path, depth=0):
        whole = read_text(path, LARGEST)
        spend(READ + len(whole) // BYTES)
        text = re.sub(r'"[^"]*"|#[^\n]*', lambda x: " ".join(x[0].split()) * (x[0][0] == '"'), whole)
        text = spelled(text)
        self.digest, self.names, self.claims = digest(whole) if depth == 0 else "", defaultdict(list), {}
        self.lets, self.rates, self.known, self.assumed = {}, {}, {}, []
        self.functions = {**FUNCTIONS, "d": self.differentials, "bracket": self.bracket,
                          "codistribution": self.codistribution}
        found = ENTRY.split(text if re.search(r"^[ \t]*drift\b", text, re.M) else text + "\ndrift signals")
        if len(found) > MOST_CLAIMS:
            refuse(f"more than {MOST_CLAIMS} entries")
        for entry in found:
            kind, rest = (*entry.split(None, 1), "", "")[:2]
            bare = without_comments(rest)
            bare = bare.partition(":")[2] if ":" in bare and kind in NAMED else bare  # a claim may have any name
            if WITHIN.search(bare) or kind not in ("param", "known", "unknown", "initial") and re.search(r"\b(?:un)?known\b(?!')", bare):
                refuse("entries that share a line")
            if kind == "use":
                name, other = re.fullmatch(r'(\w+)\s*=\s*"(.*)"\s*', rest).groups()
                other = os.path.join(os.path.dirname(path), other) if depth < 8 else refuse("deep imports")
                self.known[name] = System(other, depth + 1)
                self.names["param"] += self.known[name].names["state"] + self.known[name].names["param"]
            elif kind == "let" and (found := re.fullmatch(r"(\w+)\s*(?::[^=]*)?=(.*)", rest, re.S)):
                self.lets[found[1]] = found[2]
            elif kind in ("drift", "input", "field"):
                if re.search(r"\+\s*=", rest):
                    refuse("discrete time")
                name, *bodies = re.split(r"\b(\w+)'\s*=", rest)
                self.rates[name.strip()] = kind, dict(zip(bodies[::2], bodies[1::2]))
                self.names["moving"] += [name.strip()] * (kind != "field")
            elif kind == "assume":
                self.assumed.append(rest)
            elif kind == "output":
                self.names["output"].append(re.sub(":[^,]*", "", rest))
            elif kind in NAMED:
                for name, said in texts(without_comments(entry)).items():
                    self.claims.setdefault(name, said)
            elif kind in ("state", "param", "known", "initial", "unknown", "experiments"):
                self.declare(kind, rest)
            if max(map(len, self.names.values()), default=0) > MOST_NAMES:
                refuse(f"more than {MOST_NAMES} symbols")

    def declare(self, kind, text):
        words = r"[\[@]|\b(?:state|param|let|drift|input|field|output)\b"
        if kind in ("unknown", "experiments") or re.search(words + "|=" * (kind == "initial"), text):
            refuse("a vector, an experiment, an unknown signal, an initial value, or entries that share a line")
        waiting = []
        for name, *rest in (re.findall(NAME + r"|\S", part) for part in text.split(",")):
            waiting.append(name)
            self.names[kind].append(name)
            self.names["unknown"] += waiting if rest[-1:] == ["unknown"] else []
            waiting = [] if "=" in rest or rest[-1:] in (["known"], ["unknown"]) else waiting

    def read(self, text): return Parser(text, self).whole()
    def number(self, text): return one(number(text))
    def matrix(self, rows): return blocks(rows)
    def relation(self, left, sign, right): return Relation((left, sign, right))
    def call(self, name, of): return (self.functions.get(name) or refuse(f"'{name}'"))(*of)
    def at(self, of, given): return each(Map(put_in, [(named(self[x]), single(y)) for x, y in given]).__getitem__, of)

    def __getitem__(self, name):
        first, _, rest = name.partition(".")
        if rest:
            return self.known[first][rest]
        if name not in self.known:
            symbols = ["pi", *self.names["state"], *self.names["param"], *[name] * self.is_signal(name)]
            found = self.read(self.lets[name])[0] if name in self.lets else one(symbol(name)) if name in symbols else ()
            if name in self.rates:
                found = Field(found)
                found.along = derivation(lambda state: self.rate(state, *self.rates[name]))
            self.known[name] = found if found or name in self.rates else refuse(f"'{name}'")
        return self.known[name]

    def is_signal(self, name): return name.rstrip("'") in self.names["known"]

    def rate(self, name, kind, bodies):
        moves = kind == "drift" and self.is_signal(name)
        if name in self.names["state"] and not {name, "others"} & {*bodies} and bodies:
            refuse("a state without a rate")
        return symbol(name + "'") if moves else single(*self.read(bodies.get(name, "0")))

    def bracket(self, *fields):
        f, g = (field.along for field in fields)
        along = derivation(lambda name: f[g[symbol(name)]] - g[f[symbol(name)]])
        found = Field((along[symbol(column)],) for column in self.columns())
        found.along = along
        return found

    def differentials(self, of, *columns):
        units = [self.unit(column) for column in [named(x).args[0] for x in columns] or self.columns()]
        return Matrix(tuple(unit[x] for unit in units) for x in entries(of))

    def codistribution(self, order):
        """The differentials of the outputs, and of what they are along at most so many fields that move the system."""
        words = [self.seen()]
        for _ in range(int(single(order).args[0])):
            words.append([self[name].along[x] for name in self.names["moving"] for x in words[-1]])
        return self.differentials(Matrix((x,) for of_one_length in words for x in of_one_length))

    def unit(self, column):
        return self.known.setdefault((column, "unit"), derivation(lambda name: number(name == column)))

    def columns(self):
        return [name for name in self.names["state"] + self.names["unknown"] if name not in self.names["initial"]]

    def seen(self):
        texts = self.names["output"] if "=" not in "".join(self.names["output"]) else []
        return [x for text in texts or refuse("an output that is zero") for of in self.read(text) for x in entries(of)]

    def word(self, text):
        """A word by its name, as `Lf Lg y`: an output, differentiated along what moves the system."""
        first, _, rest = spelled(text).partition(" ")
        if rest and first[1:] in self.names["moving"]:
            return self[first[1:]].along[self.word(rest)]
        found = single(*self.read(spelled(text)))
        return found if found in self.seen() else refuse(f"'{text}' is no output")

    def statement(self, text):
        """What a claim asks, of what, the answer, and the conditions."""
        self.parts, (claim, *where) = None, re.split(r"\bwhere\b", re.split(r"\b(?:everywhere|except|on)\b", text)[0])
        where += self.assumed
        self.said = [claim, *where]
        conditions = [x for text in where for x in self.read(text)]
        moving = [*self.names["output"], *(text for name in self.names["moving"] for text in self.rates[name][1].values())]
        if re.fullmatch(r"\s*rank\s*=\s*\d{1,4}\s*", claim):
            self.said = [*moving, *where]
            return "rank", None, int(claim.split("=")[1]), conditions
        if found := re.fullmatch(r"\s*(rank|(un)?(?:observable|identifiable))\s*\((.*)\)\s*(?:=\s*(\d{1,4})\s*)?", claim, re.S):
            asked, un, inside, claimed = found.groups()
            of, self.said = self.read(inside), [inside, *moving * ("codistribution" in inside), *where]
            if (asked == "rank") != (claimed is not None) or asked == "rank" and len(of) > 1:
                refuse("a statement with more or less than it needs")
            if asked == "rank":
                return asked, of[0], int(claimed), conditions
            return f"{un or ''}observable", [x for one in of for x in entries(one)], None, conditions
        of = self.read(claim)
        return "=", of[0] if len(of) == 1 else refuse("several statements"), None, conditions

    def partial(self):
        """The roots, logarithms and powers below nothing that stand in the statement, or in what it names: `0/x` is zero and has lost one."""
        if self.parts is not None:
            return self.parts
        seen, found, waiting = set(), set(), [(self, text) for text in self.said]
        for system, text in waiting:
            parser = Parser(text, system)
            parser.whole()
            found |= {node for value in parser.met for x in entries(value) for node in x.below(found) if node.lacks()}
            for name in {*re.findall(NAME, text)}:
                owner, rest = system, name.split(".")
                while len(rest) > 1:
                    owner = owner.known[rest.pop(0)]
                if (owner, rest[0]) not in seen:
                    seen.add((owner, rest[0]))
                    bodies = [owner.lets[rest[0]]] if rest[0] in owner.lets else owner.rates.get(rest[0], ("", {}))[1].values()
                    waiting += [(owner, body) for body in bodies]
        self.parts = sorted(found, key=attrgetter("place"))
        return self.parts

    def left_out(self, text):
        """The sets behind `except where`, each as its relations."""
        sets = re.split(r"\bor\b", re.split(r"\bexcept\s+where\b", text)[1]) if re.search(r"\bexcept\b", text) else []
        return [self.read(one) for one in sets]
