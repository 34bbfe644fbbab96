"""A proof file as a straight-line program: what a second program has to know of the language, and no more.

Read are `state`, `param`, `known`, `unknown`, `initial`, `experiments`, `let`, `drift`, `input`, `output` and `sample`;
claims and the like end the reading of an entry and are skipped. A node is (operation, operands); operands come before what
is made of them, and equal nodes are one. A known signal is a node of its own, and its derivatives are; an unknown one is a
polynomial of time.
"""

import re
from fractions import Fraction

TOKEN = re.compile(r'\s+|#[^\n]*|"[^"]*"|(\d+\.\d+|\d+|[A-Za-z_]\w*|<=|>=|!=|.)')
ENTRIES = set(
    "system cite use state param angle let drift input field output sample claim set pole map line "
    "definition undecided erratum reduction known unknown initial experiments".split()
)
FUNCTIONS = set("sqrt exp log sin cos tan asin acos atan sinh cosh tanh abs".split())


class ProofFile:
    def __init__(self, text):
        self.tokens = [match[1] for match in TOKEN.finditer(text) if match[1]] + [None]
        self.at, self.nodes, self.index = 0, [], {}
        self.states, self.unknown, self.names, self.params = [], [], {}, {}
        self.fields, self.outputs, self.ranges = [], [], {}
        self.signals, self.initial, self.constants, self.count = {}, {}, set(), 1
        while self.peek() is not None:
            entry = self.next()
            if entry in ("drift", "input", "field"):
                self.field(entry)
            elif entry in ("state", "param", "let", "output", "sample", "initial", "experiments"):
                getattr(self, {"initial": "initial_of_states"}.get(entry, entry))()
            elif entry in ("known", "unknown"):
                self.signal(entry)
            else:
                self.skip()
        self.repeat()

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
        declared = []
        while True:
            name, value, word = self.next(), None, None
            if self.taken(":"):
                self.dimension()
            if self.taken("="):
                value = self.sum()
                if self.taken(":"):
                    self.dimension()
            if self.peek() in ("known", "unknown") and self.peek(2) != "(":
                word = self.next()
            declared.append([name, value, word])
            if not self.taken(","):
                break
        last = None
        for one in reversed(declared):  # the word holds for the names before it that have neither one nor a value
            last = one[2] or (None if one[1] is not None else last)
            one[2] = last
        for name, value, word in declared:
            if word == "unknown":
                self.coordinate(name, True)
                self.constants.add(len(self.states) - 1)
            else:
                self.names[name] = self.node("constant", name) if value is None else value

    def signal(self, word):
        while True:
            name = self.next()
            self.at += 3  # (t)
            if self.taken(":"):
                self.dimension()
            used = self.highest(name)
            if word == "known":
                for order in range(used + 1):
                    self.names[name + "'" * order] = self.node("signal", name, order)
                self.signals[name] = used
            else:
                order = int(self.next()) if self.taken("order") else max(1, used)
                for place in range(order + 1):
                    self.coordinate(name + "'" * place, True)
                chain = [name + "'" * place for place in range(order + 1)]
                self.fields.append(("drift", {link: self.names[above] for link, above in zip(chain, chain[1:])}))
            if not self.taken(","):
                return

    def highest(self, name):
        """The highest derivative of a signal that the file mentions."""
        found = 0
        for place, token in enumerate(self.tokens):
            primes = 0
            while token == name and self.tokens[place + 1 + primes] == "'":
                primes += 1
            found = max(found, primes)
        return found

    def initial_one(self):
        name = self.next()
        value = self.sum() if self.taken("=") else None
        self.initial[self.states.index(name)] = value

    def initial_of_states(self):
        self.initial_one()
        while self.taken(","):
            self.initial_one()
        self.taken("known")

    def experiments(self):
        self.count = int(self.next())

    def repeat(self):
        """Further experiments: each state, signal, input and output once more, constants only once."""
        states, fields, outputs, signals, initial = (
            kind.copy() for kind in (self.states, self.fields, self.outputs, self.signals, self.initial)
        )
        for experiment in range(2, self.count + 1):
            places = {}
            for place, name in enumerate(states):
                if place not in self.constants:
                    self.coordinate(f"{name}@{experiment}", self.unknown[place])
                    places[place] = len(self.states) - 1
            copies = {}
            for index, (name, *operands) in enumerate(self.nodes[:]):
                if name == "state":
                    copies[index] = self.node("state", places.get(operands[0], operands[0]))
                elif name == "signal":
                    copies[index] = self.node("signal", f"{operands[0]}@{experiment}", operands[1])
                elif name in ("number", "constant"):
                    copies[index] = index
                else:
                    copies[index] = self.node(name, *(copies[operand] for operand in operands))
            for role, rates in fields:
                self.fields.append(
                    (
                        role,
                        {
                            f"{name}@{experiment}": copies[rate]
                            for name, rate in rates.items()
                            if f"{name}@{experiment}" in self.states
                        },
                    )
                )
            self.outputs += [copies[output] for output in outputs]
            self.signals |= {f"{name}@{experiment}": order for name, order in signals.items()}
            self.initial |= {places[place]: None if value is None else copies[value] for place, value in initial.items()}

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
        while self.peek() == "'" and token + "'" in self.names:
            token += self.next()
        return self.names[token]
