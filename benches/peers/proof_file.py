"""A proof file as a straight-line program: what a second program has to know of the language, and no more.

Read are `state`, `param`, `angle`, `let`, `drift`, `input`, `output` and `sample`; claims and the like end the reading of an entry
and are skipped. A node is (operation, operands); operands come before what is made of them, and equal nodes are one.
"""

import re
from fractions import Fraction

TOKEN = re.compile(r'\s+|#[^\n]*|"[^"]*"|(\d+\.\d+|\d+|[A-Za-z_]\w*|<=|>=|!=|.)')
ENTRIES = set("system cite use state param angle let drift input field output sample claim set pole map line "
              "definition undecided erratum reduction".split())
FUNCTIONS = set("sqrt exp log sin cos tan asin acos atan sinh cosh tanh abs".split())


class ProofFile:
    def __init__(self, text):
        self.tokens = [match[1] for match in TOKEN.finditer(text) if match[1]] + [None]
        self.at, self.nodes, self.index = 0, [], {}
        self.states, self.unknown, self.names, self.params = [], [], {}, {}
        self.fields, self.outputs, self.ranges = [], [], {}
        while self.peek() is not None:
            entry = self.next()
            if entry in ("drift", "input", "field"):
                self.field(entry)
            elif entry in ("state", "param", "let", "output", "sample"):
                getattr(self, entry)()
            else:
                self.skip()

    # the program
    def node(self, *key):
        if key not in self.index:
            self.index[key] = len(self.nodes)
            self.nodes.append(key)
        return self.index[key]

    def power(self, base, exponent):
        if exponent < 0:
            return self.node("/", self.node("number", Fraction(1)), self.power(base, -exponent))
        result, square = self.node("number", Fraction(1)), base
        while exponent:
            result = self.node("*", result, square) if exponent & 1 else result
            exponent >>= 1
            square = self.node("*", square, square) if exponent else square
        return result

    # the text
    def peek(self, ahead=0):
        return self.tokens[self.at + ahead] if self.at + ahead < len(self.tokens) else None

    def next(self, wanted=None):
        token = self.tokens[self.at]
        assert wanted in (None, token), f"{wanted} expected, {token} found"
        self.at += 1
        return token

    def taken(self, token):
        if self.peek() == token:
            self.at += 1
            return True
        return False

    def skip(self):
        while self.peek() is not None and not (self.peek() in ENTRIES and self.tokens[self.at - 1] not in ("=", ",", "(")):
            self.at += 1

    def dimension(self):
        """Behind a colon, until the next comma outside brackets, equals sign or entry; it is not looked at."""
        while self.peek() not in (",", "=", None) and self.peek() not in ENTRIES:
            self.at += 1

    def coordinate(self, name, unknown):
        self.names[name] = self.node("state", len(self.states))
        self.states.append(name)
        self.unknown.append(unknown)

    def state(self):
        while True:
            self.coordinate(self.next(), True)
            if self.taken(":"):
                self.dimension()
            if not self.taken(","):
                return

    def param(self):
        while True:
            name, value = self.next(), None
            if self.taken(":"):
                self.dimension()
            if self.taken("="):
                value = self.sum()
            if self.taken("unknown"):
                self.coordinate(name, True)
            else:
                self.taken("known")
                self.names[name] = self.node("constant", name) if value is None else value
            if not self.taken(","):
                return

    def let(self):
        name = self.next()
        if self.taken(":"):
            self.dimension()
        self.next("=")
        self.names[name] = self.sum()

    def field(self, role):
        self.next()
        rates = {}
        while self.peek(1) == "'":
            name = self.next()
            self.next("'")
            self.next("=")
            rates[name] = self.sum()
        rates.pop("others", None)
        if role != "field":
            self.fields.append((role, rates))

    def output(self):
        while True:
            self.outputs.append(self.sum())
            if self.taken(":"):
                self.dimension()
            if not self.taken(","):
                return

    def sample(self):
        while self.peek(1) == "in":
            name = self.next()
            self.at += 2
            low = self.sum()
            self.next(",")
            self.ranges[name] = (low, self.sum())
            self.next("]")
            self.taken(",")
        if self.taken("avoid"):
            self.sum()
            while self.taken(","):
                self.sum()

    def sum(self):
        value = self.product()
        while self.peek() in ("+", "-"):
            value = self.node(self.next(), value, self.product())
        return value

    def product(self):
        negative = False
        while self.peek() in ("+", "-"):
            negative ^= self.next() == "-"
        value = self.factor()
        while self.peek() in ("*", "/"):
            operation, sign = self.next(), False
            while self.peek() in ("+", "-"):
                sign ^= self.next() == "-"
            value, negative = self.node(operation, value, self.factor()), negative ^ sign
        return self.node("-", self.node("number", Fraction(0)), value) if negative else value

    def factor(self):
        base = self.primary()
        if not self.taken("^"):
            return base
        sign, bracket = 1, self.taken("(")
        if self.taken("-"):
            sign = -1
        exponent = self.next()
        if exponent.isdigit() and not (bracket and self.peek() != ")"):
            value = self.power(base, sign * int(exponent))
        else:  # a real exponent
            self.at -= 1
            exponent = self.sum() if bracket else self.primary()
            exponent = exponent if sign > 0 else self.node("-", self.node("number", Fraction(0)), exponent)
            value = self.node("^", base, exponent)
        if bracket:
            self.next(")")
        return value

    def primary(self):
        token = self.next()
        if token == "(":
            value = self.sum()
            self.next(")")
            return value
        if token[0].isdigit():
            return self.node("number", Fraction(token))
        if token in FUNCTIONS and self.peek() == "(":
            self.next("(")
            argument = self.sum()
            self.next(")")
            return self.node(token, argument)
        if token == "pi" and token not in self.names:
            return self.node("constant", "pi")
        return self.names[token]
